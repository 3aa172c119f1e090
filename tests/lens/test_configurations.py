#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Configurations of a lens: by the command, from a lens file, a .zmx and a .seq file.

    python3 test_configurations.py SAGITTA

The oracle is a file for each configuration, written by hand without any: what is asked of all configurations has
the same bytes as what is asked of these files one by one.  SAGITTA_TEST_SEED (1) draws the mutations.
"""
import json
import os
import pathlib
import random
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / 'tool'))
from command import *  # noqa: E402

SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'), 0)
SCALE = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))
os.environ['SAGITTA_GLASS'] = str(HERE.parents[1] / 'data' / 'glass')
ZOOM = LENSES / 'zoom.yaml'
SEQ = HERE.parent / 'data' / 'seq' / 'zoom2.seq'
BASE, REST = ZOOM.read_text().split('configurations:')
NAMES = ('wide', 'middle', 'tele')


def singles():
    """The three positions of ZOOM, each a file of its own."""
    texts = [BASE]
    for gap, fields, pupil in (('27', '[0, 2.1, 3.2]', '10'), ('24.3', '[0, 1.5, 2.25]', '16')):
        text = BASE.replace('thickness: 31.3', f'thickness: {gap}').replace('[0, 3, 4.5]', fields)
        texts.append(text.replace('f_number: 10', f'f_number: {pupil}'))
    return [written(text, 'single.yaml') for text in texts]


def all_of(files, *arguments, exit=None):
    """The rows of files as one table, with the column."""
    out = []
    for number, file in enumerate(files):
        head, *lines = run(arguments[0], file, *arguments[1:], '--format', 'csv', exit=exit).stdout.splitlines()
        out += [f'configuration,{head}'] * (not out) + [f'{number + 1},{line}' for line in lines]
    return '\n'.join(out) + '\n'


QUESTIONS = (('info',), ('info', '--seidel'), ('info', '--parabasal'), ('info', '--wavelength', 'all'), ('spot',),
             ('spot', '--hex'), ('fan',), ('field',), ('opd', '--summary'), ('trace',), ('trace', '--last', '--grid', '9'),
             ('prove', '--boxes', '4'), ('spot', '--threads', '2'),
             ('trace', '--set', 'surfaces[1].radius=28'))


def test_same_as_files():
    files = singles()
    for question in QUESTIONS:
        asked = run(question[0], ZOOM, *question[1:], '--configuration', 'all', '--format', 'csv', exit=None)
        equal(asked.stdout, all_of(files, *question), question)
    for command in ('info', 'spot', 'trace'):
        one = [run(command, ZOOM, '--configuration', name, exit=None).stdout for name in NAMES]
        equal(one, [run(command, ZOOM, '--configuration', i, exit=None).stdout for i in (1, 2, 3)], command)
        equal(one, [run(command, file, exit=None).stdout for file in files], command)
    assert 'takes one configuration' in run('diagnose', ZOOM, '--configuration', 'all', exit=USAGE).stderr
    off = 'tolerances:\n  - {surface: gap, thickness: 0.1}\n  - {surface: 1, radius: 0.1}\n'
    equal(run('tolerance', written(BASE + off + 'configurations:' + REST), '--configuration', 'all', '--format', 'csv').stdout,
          all_of([written(file.read_text() + off) for file in files], 'tolerance'))
    rays = written('ox,oy,oz,dx,dy,dz\n0,1,-5,0,0,1\n0,-2,-5,0,0.01,1\n', 'rays.csv')
    equal(run('trace', ZOOM, '--configuration', 'all', '--rays', rays, '--format', 'csv').stdout,
          all_of(files, 'trace', '--rays', rays))


def test_formats():
    """json and npy have the column, and --columns takes it; text names all of them."""
    whole = json.loads(run('info', ZOOM, '--configuration', 'all', '--format', 'json').stdout)
    equal([(one['configuration'], one['configuration_name']) for one in whole],
          [(i + 1, name) for i, name in enumerate(NAMES)])
    equal(json.loads(run('info', ZOOM, '--format', 'json').stdout)['configurations'], list(NAMES))
    spots = json.loads(run('spot', ZOOM, '--configuration', 'all', '--format', 'json').stdout)
    equal(sorted({row['configuration'] for row in spots}), [1, 2, 3])
    text = run('trace', ZOOM, '--configuration', 'all', '--columns', 'y,configuration', '--last', '--format',
               'csv').stdout.splitlines()
    equal((text[0], {line.split(',')[1] for line in text[1:]}), ('y,configuration', {'1', '2', '3'}))
    for command in ('info', 'spot', 'trace'):
        assert 'Configurations: 1 wide, 2 middle, 3 tele.' in \
            run(command, ZOOM, '--configuration', 'all').stdout, command
    out = pathlib.Path(folder.name) / 'rows.npy'
    for command in ('trace', 'spot'):
        run(command, ZOOM, '--configuration', 'all', '--format', 'npy', '-o', out)
        assert b"'configuration', '<i8'" in out.read_bytes()[:400], command


def shapes(picture):
    """The lines."""
    return re.findall(r'<path[^>]*fill(?::|=")none[^>]* d="([^"]+)"', picture)


def test_picture():
    """Three configurations that are the base draw its lines three times, at the same places."""
    path = pathlib.Path(folder.name) / 'lens.svg'

    def drawn(file, *arguments):
        done = run('trace', file, '--picture', path, '-o', '/dev/null', *arguments, exit=None)
        if 'without cairo' in done.stderr:
            return None
        return path.read_text()
    try:
        alone = drawn(written(BASE))
    except AssertionError as missing:
        if 'cairo' not in str(missing):
            raise
        return
    together = shapes(drawn(written(BASE + 'configurations: [{}, {}, {}]\n'), '--configuration', 'all'))
    lines = [d for d in shapes(alone) if d.count('L') + d.count('C') > 1 and together.count(d) > 1]
    for d in lines:
        assert together.count(d) >= 3, d
    assert len(lines) > 15, len(lines)
    grey = drawn(ZOOM, '--configuration', 'all')
    assert grey.count('70%') > 20 or grey.count('0.7') > 20, 'nothing is grey'
    assert len(shapes(grey)) > len(shapes(alone)) + 20
    assert 'one configuration' in run('spot', ZOOM, '--configuration', 'all', '--picture', path, exit=USAGE).stderr


# What is wrong, the line of the fault (from that of `configurations:`) and words of it.
FAULTS = (
    (' []', 0, 'configurations: must be a list'), (' 3', 0, 'configurations: must be a list'),
    (' {a: 1}', 0, 'configurations: must be a list'), (' [3]', 0, 'configurations[1]: must be a map'),
    ('\n  - surfaces[9].radius: 3', 1, 'configurations[1]: surfaces[9].radius: there is no surface 9'),
    ('\n  - {}\n  - surfaces[2].radius: x', 2, 'configurations[2]: surfaces[2].radius: must be a number'),
    ('\n  - surfaces[2].nothing: 3', 1, 'configurations[1]: surfaces[2].nothing: unknown key'),
    ('\n  - nothing: 3', 1, 'configurations[1]: nothing: unknown key'),
    ('\n  - {name: a}\n  - {name: a}', 2, 'configurations[2].name: configuration 1 is called "a", too'),
    ('\n  - {name: 3}', 1, 'configurations[1].name: "3" would be read as a number'),
    ('\n  - {name: all}', 1, 'configurations[1].name: "all" would be read'),
    ('\n  - {name: ""}', 1, 'configurations[1].name: empty'), ('\n  - {name: [a]}', 1, 'configurations[1].name: must be'),
    ('\n  - surfaces[2].radius: 4\n    surfaces[2].curvature: 0.1', 2, 'another path of this configuration'),
    ('\n  - surfaces[2].radius: 4\n    surfaces[2].radius: 5', 2, 'surfaces[2].radius: given twice'),
    ('\n  - {"surfaces[1].radius": 4, "surfaces[1]": {type: plane}}', 1, 'another path of this configuration'),
    ('\n  - surfaces[2].glass: N-BK99', 1, 'configurations[1]: surfaces[2].glass: no glass "N-BK99"'),
    ('\n  - surfaces[2].thickness: [1, 2]', 1, 'configurations[1]: surfaces[2].thickness: must be a number'),
    ('\n  - fields: [0]\n  - fields[4]: 3', 2, 'configurations[2]: fields[4]: there is no entry 4'),
    ('\n  - configurations: []', 1, 'a configuration has none of its own'),
    ('\n  - surfaces: []', 1, 'configurations[1]: surfaces: must be a list'),
    ('\n  - surfaces[2]: null', 1, 'a place in a list cannot be left out'),
    (' [{name: a, name: b}]', 0, 'name: given twice'),
    ('\n  - surfaces[2].thickness: null\n    surfaces[2].thickness: 3', 2, 'given twice'),
    ('\n  - pupil: {f_number: 3}\n    pupil.f_number: 4', 2, 'of which this is a part'),
    ('\n  - object: {distance: 50}\n    object.distance: null', 2, 'of which this is a part'),
    ('\n  - {name: -1}', 1, 'would be read'), ('\n  - {name: 0x10}', 1, 'would be read'),
    ('\n  - {name: null}', 1, 'would be read'), ('\n  - {name: .inf}', 1, 'would be read'),
    ('\n  - name.x: 4', 1, 'configurations[1]: name.x'), ('\n  - surfaces: null', 1, 'configurations[1]: surfaces'),
    ('\n  - surfaces[: 3', 1, 'configurations[1]: surfaces[: no path'),
    ('\n  - object.distance: 90\n    field_type: object_height\n  - field_type: object_height', 3,
     'configurations[2]: field_type: object_height, but the object is at infinity'),
    ('\n  - wavelengths: [0.5]', None, 'configurations[1]: primary: must be a whole number from 1 to 1'),
    ('\n  - surfaces[2].type: plane', None, 'configurations[1]: radius: unknown key'),
)


def test_faults():
    first = BASE.count('\n') + 1
    for text, line, words in FAULTS:
        file = written(BASE + 'configurations:' + text + '\n')
        said = run('info', file, exit=BAD_INPUT).stderr
        assert words in said and said.count('\n') == 1, (text, said)
        if line is not None:
            assert said.startswith(f'sagitta: {file}:{first + line}: '), (text, said)
    for asked, words in (('4', 'there are 3; there is no configuration 4'), ('zoom', '1 wide, 2 middle, 3 tele')):
        assert words in run('info', ZOOM, '--configuration', asked, exit=BAD_INPUT).stderr, asked
    for asked in ('0', '99999999999999999999'):
        run('info', ZOOM, '--configuration', asked, exit=USAGE)
    plain = written(BASE)
    equal(run('info', plain, '--configuration', 1).stdout, run('info', plain).stdout)
    for asked in ('2', 'wide', 'all'):
        assert 'configurations: not given' in run('info', plain, '--configuration', asked, exit=BAD_INPUT).stderr


def require_honest(text, name, *arguments):
    """A lens, or one error that names the file."""
    file = written(text, name)
    done = subprocess.run([SAGITTA, 'info', file, *arguments], capture_output=True, timeout=60)
    said = done.stderr.decode(errors='replace')
    errors = [line for line in said.splitlines() if line.startswith('sagitta: ')]
    if done.returncode == DECIDED:
        equal(errors, [], text[-300:])
    else:
        equal(done.returncode, BAD_INPUT, (said, text[-300:]))
        assert len(errors) == 1 and errors[0].startswith(f'sagitta: {file}:'), (said, text[-300:])


def test_mutations():
    """Of each file, cut off or with some bytes changed: a lens, or one error with its file."""
    g = random.Random(SEED)
    print(f'SAGITTA_TEST_SEED={SEED}')
    words = (': ', '\n', ' ', '3', '-', '[', ']', '{', '}', 'name', 'surfaces[2]', '.radius', 'null', 'fields', '"', '~')
    for text, mark, name in ((ZOOM.read_text(), 'configurations:', 'm.yaml'), (ZMX_FILE, 'MNUM', 'm.zmx'),
                             (SEQ.read_text(), 'ZOO 2', 'm.seq')):
        begin = text.index(mark)
        for k in range(int(80 * SCALE)):
            at = g.randrange(begin, len(text))
            changed = text[:at] if k % 3 == 0 else text[:at] + g.choice(words) + text[at + g.randrange(3):]
            require_honest(changed, name, *((), ('--configuration', 'all'), ('--configuration', '2'))[k // 3 % 3])


# ------------------------------------------------------------------ other formats

ZMX = '''VERS 140124 258 36214
MODE SEQ
NAME zoom
UNIT MM X W X CM MR CPMM
ENPD 8
FTYP 0 0 3 3 0 0 0
XFLN 0 0 0
YFLN 0 5 {field}
WAVM 1 0.4861327 1
WAVM 2 {wave} 1
WAVM 3 0.6562725 1
PWAV 2
GCAT SCHOTT
SURF 0
  DISZ INFINITY
SURF 1
  CURV {curvature}
  DISZ 3
  GLAS N-BK7 0 0 1.5 40
SURF 2
  TYPE EVENASPH
  CURV -0.025
  CONI {conic}
  PARM 2 {parameter}
  DISZ {gap}
SURF 3
  STOP
  DISZ 2
SURF 4
  CURV -0.025
  DISZ 2
  GLAS {glass} 0 0 1.5 40
  DIAM {size} 0
SURF 5
  CURV 0.0125
  DISZ {back}
SURF 6
  DISZ 0
TOL TOFF   0   0              0              0   0 0 0
'''
VALUES = {'field': ('YFIE 3', 8, 8, 4), 'wave': ('WAVE 2', 0.5875618, 0.55, 0.5875618),
          'curvature': ('CRVT 1', 0.015, 0.016, 0.017), 'conic': ('CONN 2', -0.1, 0.2, 0),
          'parameter': ('PRAM 2', 1e-6, 2e-6, 3e-6), 'gap': ('THIC 2', 8, 12, 16),
          'glass': ('GLSS 4', '"N-SF6"', '"N-SF6"', '"N-SF5"'), 'size': ('SDIA 4', 6, 5, 4),
          'back': ('THIC 5', 60, 50.5, 44)}
TAIL = ' 0 0 1 1 0 0.0 "" 0\n'


def zmx_of(k):
    return ZMX.format(**{name: str(row[k]).strip('"') for name, row in VALUES.items()})


def zmx_rows(leave=()):
    return 'MNUM 3 2\n' + ''.join(
        f'{row[0]} {k} {row[k]}' + (' 0 2' if row[0].startswith('PRAM') else ' 0 0') + TAIL
        for name, row in VALUES.items() if name not in leave for k in (1, 2, 3))


ZMX_FILE = zmx_of(2) + zmx_rows()


def test_zmx():
    """Each operand gives what a file of that configuration alone has; the active one is the base."""
    files = [written(zmx_of(k) + 'MNUM 1 1\n', 'single.zmx') for k in (1, 2, 3)]
    file = written(ZMX_FILE, 'zoom.zmx')
    yaml = written(run('import', file, '-q').stdout)
    for question in (('info',), ('spot',), ('trace',), ('info', '--seidel')):
        wanted = all_of(files, *question)
        for of in (file, yaml):
            equal(run(question[0], of, *question[1:], '--configuration', 'all', '--format', 'csv',
                      exit=None).stdout, wanted, question)
    equal(run('spot', file, '--format', 'csv').stdout, run('spot', files[1], '--format', 'csv').stdout)
    for k in (1, 2, 3):
        text = run('import', file, '-q', '--configuration', k).stdout
        equal(text, run('import', yaml, '-q', '--configuration', k).stdout)
        if k == 2:
            equal(text, run('import', files[1], '-q').stdout)
    said = run('import', file).stderr
    assert 'left out' not in said and 'number 2 of 3 is the active one' in said, said


def test_zmx_left_out():
    """What is not certain is told with its operand, and the rest is read."""
    cases = (('CRVT 1 1 0.3 0 0', 'curvature', 'CRVT'),          # no row of the active one
             ('TEMP 0 1 20\nTEMP 0 2 20\nTEMP 0 3 60', None, 'TEMP'),
             ('CRVT 1 1 0.3\nCRVT 1 2 0.4\nCRVT 1 3 0.5', 'curvature', 'CRVT'),  # another than the lens has
             ('PRAM 2 1 1 0 9\nPRAM 2 2 2 0 9\nPRAM 2 3 3 0 9', 'parameter', 'PRAM'),
             ('THIC 2 1 3\nTHIC 2 2 12\nTHIC 2 3 4\nTHIC 2 3 5', 'gap', 'THIC'),
             ('THIC 99 1 3\nTHIC 99 2 12', None, 'THIC'), ('THIC 2 x 3', 'gap', 'THIC'),
             ('GLSS 4 1 "N-SF5"\nGLSS 4 2 "N-BK7"', 'glass', 'GLSS'))
    for rows, leave, key in cases:
        file = written(zmx_of(2) + zmx_rows((leave,)) + rows + '\n', 'zoom.zmx')
        said = run('import', file).stderr
        assert re.search(rf':\d+: {key}: left out: what it gives the other configurations', said), (rows, said)
        assert 'left out' in run('info', file, '--strict', exit=BAD_INPUT).stderr
        one = run('info', file, '-q', '--configuration', 3, '--format', 'csv').stdout
        assert one != run('info', file, '-q', '--format', 'csv').stdout, rows
    quiet = zmx_of(2) + zmx_rows() + 'TEMP 0 1 20\nTEMP 0 2 20\nMOFF 0 1 "" 0\nMCOM 0 1 "wide"\nCWGT 0 1 1\n'
    assert 'left out' not in run('import', written(quiet, 'zoom.zmx')).stderr
    alone = written(zmx_of(2) + 'MNUM 3 2\nTEMP 0 1 20\nTEMP 0 2 30\n', 'zoom.zmx')
    assert 'all of the 3 configurations but the active one' in run('import', alone).stderr
    assert 'configurations' not in run('import', alone, '-q').stdout
    assert 'cannot be made' in run('info', alone, '--configuration', 1, exit=BAD_INPUT).stderr
    run('info', alone, '--configuration', 2)
    for active in ('3 4', '3 0'):
        assert 'is said to be active' in run('info', written(zmx_of(2) + f'MNUM {active}\n', 'a.zmx'),
                                             exit=BAD_INPUT).stderr


def test_seq():
    """Positions that the reader makes one by one are those of the configurations."""
    several = SEQ.read_text().replace('ZOO THI S2 10.0 16.0', '''ZOO THI S2 10.0 16.0
ZOO CUY S3 -0.033333333333333333 -0.04
ADE S6 Z2 1.5''')
    for file in (SEQ, written(several, 'zoom.seq')):
        done = run('import', file)
        assert 'left out' not in done.stderr, done.stderr
        yaml = written(run('import', file, '-q').stdout)
        for k in (1, 2):
            for question in ('info', 'spot', 'trace'):
                alone = run(question, file, '--configuration', k, '--format', 'csv', exit=None).stdout
                equal(run(question, yaml, '--configuration', k, '--format', 'csv', exit=None).stdout, alone,
                      (file, k, question))
        equal(run('trace', file, '--format', 'csv').stdout,
              run('trace', file, '--configuration', 1, '--format', 'csv').stdout)


def test_written():
    """edit and import keep the configurations, or make the file of one."""
    whole = run('import', ZOOM, '-q').stdout
    equal(run('import', written(whole), '-q').stdout, whole)
    equal(run('edit', ZOOM, '-q', '--configuration', 'all').stdout, whole)
    moved = run('edit', ZOOM, '-q', '--insert', 'surfaces[1]={type: plane, thickness: 1, glass: air}',
                '--set', 'configurations[3].name=far').stdout
    assert 'surfaces[gap].thickness' in moved and 'name: far' in moved, moved
    one = run('edit', ZOOM, '-q', '--configuration', 'tele', '--set', 'surfaces[gap].thickness=25').stdout
    assert 'configurations' not in one and 'thickness: 25' in one and 'f_number: 16' in one, one


main(globals())
