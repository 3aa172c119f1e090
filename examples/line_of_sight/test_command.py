#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The command from outside: what it prints, its picture, its errors and exit statuses.

    python3 test_command.py LINE_OF_SIGHT [--without-pictures]
"""
import csv
import io
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile

PROGRAM = os.path.abspath(sys.argv[1])
PICTURES = '--without-pictures' not in sys.argv[2:]
FOLDER = tempfile.TemporaryDirectory()
LEAKS = pathlib.Path(FOLDER.name, 'leaks.supp')
LEAKS.write_text('leak:libfontconfig\n')  # it keeps its configuration until the program ends
ENVIRONMENT = dict(os.environ, LSAN_OPTIONS=f'suppressions={LEAKS}:print_suppressions=0')
DECIDED, USAGE, BAD_INPUT = 0, 2, 3


def run(*words, exit=DECIDED, environment=ENVIRONMENT):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, env=environment, cwd=FOLDER.name, timeout=60)
    if done.returncode != exit:
        raise AssertionError(f'exit {done.returncode}, not {exit}: {words}\n{done.stderr[-1500:]}')
    return done


def rows(*words):
    return list(csv.DictReader(io.StringIO(run('--format', 'csv', *words).stdout)))


def prints_rows():
    wide = rows('--field', 140, '--pixels', 7, '--lines', 2)
    assert [(r['line'], r['pixel']) for r in wide] == [(str(i), str(j)) for i in range(2) for j in range(7)]
    assert [r['status'] for r in wide[:7]] == ['hit'] * 7, wide
    wide = rows('--field', 160, '--pixels', 7, '--lines', 1)
    assert [r['status'] for r in wide] == ['miss'] + ['hit'] * 5 + ['miss'], wide
    assert wide[0]['latitude'] == 'nan' and math.isnan(float(wide[6]['incidence'])), wide
    assert float(wide[3]['incidence']) < 0.2 and abs(float(wide[3]['height'])) < 2e-8, wide[3]
    assert [r['seconds'] for r in rows('--pixels', 1, '--lines', 3, '--duration', 5)] == ['0', '2.5', '5']


def text_is_the_same():
    options = ('--field', 160, '--pixels', 5, '--lines', 2, '--height', 500)
    lines = run(*options).stdout.splitlines()
    for line, row in zip(lines[1:], rows(*options), strict=True):
        text = dict(zip(lines[0].split(), line.split(), strict=True))
        for key, word in text.items():
            assert word == row[key] or (word == '-' and row[key] == 'nan') or abs(float(word) - float(row[key])) <= 5.1e-4, (key, word, row[key])


def looks_where_told():
    right, = rows('--pixels', 1, '--lines', 1, '--roll', 30, '--start', 0, '--node', 0)
    left, = rows('--pixels', 1, '--lines', 1, '--roll', -30, '--start', 0, '--node', 0)
    ahead, = rows('--pixels', 1, '--lines', 1, '--pitch', 30, '--start', 0, '--node', 0)
    assert float(right['longitude']) > 3 and float(left['longitude']) < -3, (right, left)  # northward, so right is east
    assert float(ahead['latitude']) > 3 and abs(float(ahead['longitude'])) < 1, ahead
    high, = rows('--pixels', 1, '--lines', 1, '--height', 1000)
    assert abs(float(high['height']) - 1000) < 2e-8, high
    level, = rows('--pixels', 1, '--lines', 1, '--surface', 'level_gravity', '--height', 10000, '--start', 82, '--inclination', 90)
    assert -60 < float(level['height']) - 10000 < -40, level  # gravity is stronger at the pole, and a level nearer


def writes_files():
    out = pathlib.Path(FOLDER.name, 'out.csv')
    done = run('--pixels', 3, '--lines', 1, '--format', 'csv', '--output', out)
    assert done.stdout == '' and out.read_text() == run('--pixels', 3, '--lines', 1, '--format', 'csv').stdout
    assert run('--pixels', 3, '--lines', 1, '--format', 'none').stdout == ''
    assert 'million rays a second' in run('--pixels', 3, '--lines', 1, '--time').stderr
    assert run('--help').stdout.startswith('line_of_sight [options]')
    if pathlib.Path('/dev/full').exists():
        few = '--pixels 3 --lines 1'
        for words in ('--help', f'{few} --format csv', f'{few} --format text'):
            for closed in ('>/dev/full', '>&-'):
                done = subprocess.run(['sh', '-c', f'"$0" {words} {closed}', PROGRAM], stderr=subprocess.PIPE, text=True, timeout=60)
                assert done.returncode == BAD_INPUT and 'standard output: ' in done.stderr, (words, closed, done)
        run(*few.split(), '--output', '/dev/full', exit=BAD_INPUT)


def draws():
    if not PICTURES:
        assert 'without cairo' in run('--picture', 'a.png', exit=USAGE).stderr
        return
    file = pathlib.Path(FOLDER.name, 'swath.png')
    seen = set()
    # A swath in patches; past the limb; over a pole; a line, dots; one pixel; none on the Earth; halfway round it.
    for options in ([], ['--field', 150], ['--inclination', 90, '--start', 80, '--field', 120], ['--lines', 1], ['--pixels', 1, '--lines', 1],
                    ['--pitch', 120], ['--duration', 3000, '--colour', 'height']):
        run('--pixels', 60, '--lines', 50, '--format', 'none', '--picture', file, *options)
        assert not os.path.exists(f'{file}.part')
        data = file.read_bytes()
        assert data[:8] == b'\x89PNG\r\n\x1a\n' and struct.unpack('>II', data[16:24])[0] == 1060, options
        assert data not in seen, options
        seen.add(data)


def refuses():
    for words, said in ((['--altitude', 'high'], '--altitude wants a number from 1 to 1000000, not "high"'), (['--altitude', '-1'], '--altitude'), (['--field', 'nan'], '--field'),
                        (['--pixels', '0'], '--pixels'), (['--lines', '2x'], '--lines'), (['--pixels', '20000000', '--lines', '2'], 'at most 20000000'),
                        (['--surface', 'moon'], 'geodetic_height, level_gravity, geoid'), (['--height', '699999'], '--height'), (['--format', 'xml'], 'text, csv, none'),
                        (['--colour', 'red'], 'incidence, height'), (['--geoid', 'a.gtx'], '--surface geoid'), (['more'], '"more"'), (['--format', 'none', '--output', 'a'], '--output'),
                        (['--no-such'], 'no-such')) + (((['--picture', 'a.jpg'], '.png'),) if PICTURES else ()):
        done = run(*words, exit=USAGE)
        assert said in done.stderr and 'Try: line_of_sight --help' in done.stderr and done.stdout == '', (words, done.stderr)
    small = ('--pixels', 2, '--lines', 2)
    cut = pathlib.Path(FOLDER.name, 'cut.gtx')
    cut.write_bytes(b'\0' * 39)
    for words, said in ((['--height', '-7e6'], '--height -7000000, on the surface geodetic_height: '), (['--height', '-2e5', '--surface', 'level_gravity'], 'level_gravity'),
                        (['--output', 'no/where'], 'no/where: '), (['--surface', 'geoid', '--geoid', 'none.gtx'], 'none.gtx'), (['--surface', 'geoid', '--geoid', cut], 'cut.gtx')):
        done = run(*small, *words, exit=BAD_INPUT)
        assert said in done.stderr and done.stdout == '', (words, done.stderr)
    with open('/dev/full', 'w') as full:
        done = subprocess.run([PROGRAM, *map(str, small)], stdout=full, stderr=subprocess.PIPE, text=True)
        assert done.returncode == BAD_INPUT and 'standard output: ' in done.stderr, done.stderr


for check in (prints_rows, text_is_the_same, looks_where_told, writes_files, draws, refuses):
    check()
    print(check.__name__.replace('_', ' '))
