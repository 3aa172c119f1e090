#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""--columns, --last, arrays of NumPy out and in, --progress, and text that does not fit into memory.

Arrays are read here by the words of the format (NEP 1); if NumPy is there it must read them alike.

    python3 test_npy.py SAGITTA
"""
import ast
import json
import math
import os
import random
import re
import resource
import shutil
import signal
import stat
import struct
import subprocess
import time

from command import *

try:
    import numpy
except ImportError:
    numpy = None

SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'))
print(f'seed {SEED}, {"with" if numpy else "without"} NumPy')
TRIPLET, FTHETA = LENSES / 'cooke_triplet.yaml', LENSES / 'ftheta.yaml'
SPHERE = '{type: sphere, radius: 3, semi_diameter: 2}'
LETTERS = {'f8': 'd', 'f4': 'f', 'i8': 'q', 'i4': 'i', 'i1': 'b'}
NAMES = ('ox', 'oy', 'oz', 'dx', 'dy', 'dz')


def read(path):
    """The fields of an array and its rows, as tuples."""
    data = pathlib.Path(path).read_bytes()
    equal(data[:8], b'\x93NUMPY\x01\x00')
    length = struct.unpack('<H', data[8:10])[0]
    equal((10 + length) % 64, 0, 'rows begin at a multiple of 64')
    header = ast.literal_eval(data[10:10 + length].decode())
    equal(sorted(header), ['descr', 'fortran_order', 'shape'])
    equal(header['fortran_order'], False)
    fields = header['descr'] if isinstance(header['descr'], list) else [('', header['descr'])]
    form = '<' + ''.join(t[2:] + 's' if t[1] == 'S' else LETTERS[t[1:]] for _, t in fields)
    found = list(struct.iter_unpack(form, data[10 + length:]))
    equal(header['shape'], (len(found),))
    if numpy:
        array = numpy.load(path, mmap_mode='r')
        equal(len(array), len(found))
        equal(array.tobytes(), data[10 + length:])
    return fields, found


def array(path, rows, descr, form, shape=None, version=1, order='False', more=''):
    """Writes an array as NumPy does."""
    shape = shape if shape is not None else f'({len(rows)},)'
    text = f"{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, {more}}}"
    start = 10 if version == 1 else 12
    text = text.encode() + b' ' * (-(start + len(text) + 1) % 64) + b'\n'
    size = struct.pack('<H' if version == 1 else '<I', len(text))
    path.write_bytes(b'\x93NUMPY' + bytes((version, 0)) + size + text + b''.join(struct.pack(form, *r) for r in rows))
    return path


def some_rays(count, seed):
    draw = random.Random(f'{SEED} {seed}')
    return [(draw.uniform(-2.5, 2.5), draw.uniform(-2.5, 2.5), -5.0,
             draw.uniform(-.2, .2), draw.uniform(-.2, .2), draw.uniform(.5, 1.5)) for _ in range(count)]


def out(name='out.npy'):
    return written('').parent / name


def codes(header, prefix):
    """The numbers of an enumeration, as the public header has them."""
    text = (HERE.parent.parent / 'include' / 'sagitta' / header).read_text()
    return {name: int(n) for name, n in re.findall(r'^    SGT_(\w+) *= *(-?\d+)', text, re.MULTILINE) if name in prefix}


FATES = codes('system.h', ('PASSED', 'CLIPPED', 'TIR', 'MISSED', 'LOST'))
STATUS = codes('sagitta.h', ('HIT', 'GRAZE', 'MISS', 'UNPROVEN', 'UNDEFINED', 'EXHAUSTED', 'STOPPED', 'INVALID'))


def same_as_csv(fields, found, table):
    equal(len(found), len(table))
    for name, type in fields:
        place = [n for n, _ in fields].index(name)
        for row, cells in zip(found, table):
            got, text = row[place], cells[name]
            if name == 'fate':
                equal(got, FATES[text.upper()])
            elif name == 'status':
                equal(got, STATUS[text.upper()])
            elif type[1] == 'S':
                equal(got.rstrip(b'\0').decode(), text)
            elif text == '':
                assert got == 0 or math.isnan(got), (name, got)
            elif name == 't_err' and float(text) > 0:   # csv raises it to hold for the decimal
                assert got <= float(text) <= got * 1.02 + 1e-15 * abs(float(cells['t'])), (got, text)
            else:
                assert got == float(text) or (math.isnan(got) and text == 'nan'), (name, got, text)


def test_codes():
    equal((len(FATES), len(STATUS)), (5, 8), 'enumerators found in the headers')


def test_trace():
    """The types of the columns, and the values of csv: rays of each fate, and undecided ones."""
    for more in (('--grid', 9), ('--grid', 9, '--field', 35), ('--fan', 3, '--proof', 'first'),
                 ('--field', 0, '--random', 700, '--frame', 'global', '--max-evals', 1)):
        for lens in (TRIPLET, LENSES / 'cassegrain.yaml', FTHETA):
            table = rows('trace', lens, *more, exit=None)
            run('trace', lens, *more, '--format', 'npy', '-o', path := out(), exit=None)
            fields, found = read(path)
            equal([n for n, _ in fields], list(table[0]))
            equal(dict(fields)['ray'], '<i8' if sys.byteorder == 'little' else '>i8')
            equal([t[1:] for n, t in fields if n in ('element', 'evals', 'field')], ['i4'] * 3)
            equal([t for n, t in fields if n in ('fate', 'status')], ['|i1'] * 2)
            same_as_csv(fields, found, table)


def test_intersect():
    """Misses, all roots, and ids of several lengths."""
    text = ''.join(f'{",".join(map(repr, r))},{"x" * (i % 7)}\n' for i, r in enumerate(some_rays(600, 'ids')))
    text = 'ox,oy,oz,dx,dy,dz,id\n' + text
    for more in ((), ('--all',), ('--proof', 'first')):
        table = rows('intersect', '--surface', SPHERE, '--rays', '-', *more, stdin=text, exit=None)
        run('intersect', '--surface', SPHERE, '--rays', '-', *more, '--format', 'npy', '--output', path := out(),
            stdin=text, exit=None)
        fields, found = read(path)
        equal(dict(fields)['id'], '|S6')
        same_as_csv(fields, found, table)


def test_folder():
    """An array for each column has the bytes of the field of the structured one; and a second run replaces them."""
    run('trace', TRIPLET, '--grid', 21, '--format', 'npy', '-o', path := out())
    fields, found = read(path)
    folder = out('columns')
    for _ in range(2):
        run('trace', TRIPLET, '--grid', 21, '--format', 'npy', '-o', folder)
    equal(sorted(p.name for p in folder.iterdir()), sorted(f'{n}.npy' for n, _ in fields))
    for i, (name, type) in enumerate(fields):
        own, values = read(folder / f'{name}.npy')
        equal(own, [('', type)])
        equal([struct.pack('d', v[0]) for v in values], [struct.pack('d', r[i]) for r in found], name)


def test_threads():
    """From 1 to 7, so in tiles of several sizes; with rays that end at each element, and roots of several rays."""
    path = array_of(some_rays(9001, 'threads'))
    for shown in (('trace', TRIPLET, '--random', 9001, '--field', 14), ('trace', FTHETA, '--grid', 99, '--last'),
                  ('trace', TRIPLET, '--random', 9001, '--field', 25, '--last', '--frame', 'global'),
                  ('intersect', '--surface', SPHERE, '--rays', path),
                  ('intersect', '--surface', SPHERE, '--rays', path, '--all')):
        for name in ('rows.npy', 'columns'):
            several = []
            for n in range(1, 8):
                run(*shown, '--threads', n, '--format', 'npy', '-o', path_out := out(name), exit=None)
                files = sorted(path_out.iterdir()) if path_out.is_dir() else [path_out]
                several.append([f.read_bytes() for f in files])
            assert all(s == several[0] for s in several), shown


def test_columns():
    table = rows('trace', TRIPLET, '--fan', 3)
    for names in ('ray', 'py,fate,x', 't_err,element', 'opl,t,t_err', 'wavelength,n,m,l'):
        wanted = [{n: row[n] for n in names.split(',')} for row in table]
        done = run('trace', TRIPLET, '--fan', 3, '--columns', names, '--format', 'csv').stdout
        equal(done.splitlines()[0], names)
        equal(list(csv.DictReader(io.StringIO(done))), wanted)
        objects = json.loads(run('trace', TRIPLET, '--fan', 3, '--columns', names, '--format', 'json').stdout)
        equal([list(o) for o in objects], [names.split(',')] * len(table))
        equal([str(o['t_err']) for o in objects if 't_err' in o], [r['t_err'] for r in wanted if 't_err' in r])
        text = run('trace', TRIPLET, '--fan', 3, '--columns', names).stdout
        equal(text.split('\n')[0].split(), names.split(','))
        run('trace', TRIPLET, '--fan', 3, '--columns', names, '--format', 'npy', '-o', path := out())
        equal([n for n, _ in read(path)[0]], names.split(','))
    for wrong in ('nonsense', 'x,', ',x', '', 'x,y,x', 'X', 'x y', 'lo', 'x' * 2000):
        for command in (('trace', TRIPLET), ('intersect', '--surface', SPHERE, '--ray', '0 0 -5 0 0 1')):
            done = run(*command, '--columns', wrong, exit=USAGE)
            assert '--columns' in done.stderr and 't_err' in done.stderr, done.stderr
            equal(done.stdout, '')


def test_last():
    """Whatever element a ray ends at, its last row is that among all rows; also in npy."""
    for more in (('--grid', 15), ('--grid', 15, '--field', 40), ('--grid', 9, '--frame', 'global', '--proof', 'first'),
                 ('--random', 1500, '--max-evals', 2), ('--rays', array_of(some_rays(500, 'last')))):
        for lens in (FTHETA, TRIPLET):
            last = {}
            for row in rows('trace', lens, *more, exit=None):
                last[row['ray']] = row
            equal(rows('trace', lens, *more, '--last', exit=None), list(last.values()))
            run('trace', lens, *more, '--last', '--format', 'npy', '-o', path := out(), exit=None)
            same_as_csv(*read(path), list(last.values()))
    text = run('trace', FTHETA, '--fan', 7, '--field', 0, '--last').stdout
    equal(len(text.split('\n\n')[0].splitlines()), 8, 'a header and seven rows, without gaps')


# ----------------------------------------------------------------------- rays

def array_of(several, name='rays.npy'):
    return array(out(name), several, "'<f8'", '<6d', shape=f'({len(several)}, 6)')


def test_rays():
    """The rows of csv, from each kind of array, in threads, with bad rows skipped."""
    several = some_rays(3000, 'rays')
    several[700] = (*several[700][:3], 0.0, 0.0, 0.0)
    several[2999] = (math.nan, *several[2999][1:])
    text = rays(*(map(repr, r) for r in several))
    names = [f'r{i}' for i in range(3000)]
    folder = out('columns')
    folder.mkdir()
    for i, name in enumerate(NAMES):
        array(folder / f'{name}.npy', [(r[i],) for r in several], "'<f8'", '<d')
    descr = str([(n, '<f8') for n in NAMES])
    turned = str([('dz', '<f8'), ('', '|V4'), ('id', '|S5')] + [(n, '<f8') for n in NAMES[:5]])
    sources = [array_of(several), folder, array(out(), several, descr, '<6d'),
               array(out(), several, descr, '<6d', version=2), array(out(), several, descr, '<6d', version=3)]
    with_id = array(out(), [(r[5], b'pad!', n.encode(), *r[:5]) for r, n in zip(several, names)], turned, '<d4s5s5d')
    for command in (('intersect', '--surface', SPHERE), ('trace', FTHETA)):
        wanted = run(*command, '--rays', '-', '--skip-bad', '--format', 'csv', stdin=text, exit=None).stdout
        for source in sources:
            for n in (1, 3):
                done = run(*command, '--rays', source, '--skip-bad', '--format', 'csv', '--threads', n, exit=None)
                equal(done.stdout, wanted, source)
            assert '2 bad rows skipped, the first is row 700' in done.stderr, done.stderr
            done = run(*command, '--rays', source, exit=BAD_INPUT)
            assert 'row 700' in done.stderr and done.stdout == '', done.stderr
        table = rows(*command, '--rays', with_id, '--skip-bad', exit=None)
        assert all(r['id'] == names[int(r['ray'])] for r in table)
        equal([dict(r, id=None) for r in table],
              [dict(r, id=None) for r in csv.DictReader(io.StringIO(wanted))])
    words = run('intersect', '--surface', SPHERE, '--rays', sources[0], '--skip-bad').stdout
    assert '\n2998 rays: ' in words, words[-200:]
    run('diagnose', FTHETA, '--rays', sources[0], '--skip-bad', exit=None)


def floats_of(several):
    """The rays rounded to floats, as doubles."""
    return [tuple(struct.unpack('<f', struct.pack('<f', x))[0] for x in r) for r in several]


def test_arrays_of_floats():
    """The rows of the doubles that the floats are: of a plain array, with fields, and in a folder."""
    several = floats_of(some_rays(500, 'floats'))
    wanted = run('trace', FTHETA, '--rays', array_of(several), '--format', 'csv', exit=None).stdout
    folder = out('columns')
    folder.mkdir()
    for i, name in enumerate(NAMES):
        array(folder / f'{name}.npy', [(r[i],) for r in several], "'<f4'", '<f')
    fields = str([(n, '<f4') for n in NAMES])
    for source in (array(out(), several, "'<f4'", '<6f', shape='(500, 6)'), folder, array(out(), several, fields, '<6f')):
        equal(run('trace', FTHETA, '--rays', source, '--format', 'csv', exit=None).stdout, wanted, source)
    bad = several[:3] + [(math.nan, *several[3][1:])] + several[4:]
    done = run('trace', FTHETA, '--rays', array(out(), bad, fields, '<6f'), exit=BAD_INPUT)
    assert 'row 3, counted from 0' in done.stderr and done.stdout == '', done.stderr
    mixed = fields.replace("('dz', '<f4')", "('dz', '<f8')")
    done = run('trace', FTHETA, '--rays', array(out(), several, mixed, '<5fd'), exit=BAD_INPUT)
    assert "dz: of the type '<f8', but ox is '<f4'; the numbers must be of one type" in done.stderr, done.stderr


def test_single():
    """--single: the statuses of the doubles of the same rays, t within its bound of theirs, arrays of floats."""
    several = floats_of(some_rays(3000, 'single'))
    source = array(out(), several, "'<f4'", '<6f', shape='(3000, 6)')
    for surface in (SPHERE, '{type: torus, major: 2, minor: 0.5}'):
        of = ('intersect', '--surface', surface, '--rays', source)
        double, single = (rows(*of, *more, exit=None) for more in ((), ('--single',)))
        equal([r['status'] for r in double], [r['status'] for r in single])
        apart = 0
        for a, b in zip(double, single):
            equal(b['evals'], '')
            if a['status'] != 'hit':
                equal([b[k] for k in ('x', 'nz')], [a[k] for k in ('x', 'nz')])
                assert a['status'] != 'miss' or b['t'] == 'nan', b
                continue
            gap = abs(float(a['t']) - float(b['t']))
            assert gap <= float(a['t_err']) + float(b['t_err']), (a, b)
            equal(floats_of([(float(b[k]),) for k in ('t', 'x', 'y', 'z', 'nx')]), [(float(b[k]),) for k in ('t', 'x', 'y', 'z', 'nx')])
            apart = max(apart, gap)
        assert 1e-9 < apart < 1e-4, apart
        text = run(*of, '--single', '--format', 'csv', exit=None).stdout
        doubles = array_of(several)
        for more in (('--threads', 3), ('--rays', doubles)):
            equal(run(*of, '--single', '--format', 'csv', *more, exit=None).stdout, text, more)
        to, shares = out('single.npy'), [out(f'share{k}') for k in (1, 2)]
        run(*of, '--single', '--format', 'npy', '--output', to, exit=None)
        fields, found = read(to)
        equal(dict(fields)['t'], '<f4')
        equal(dict(fields)['ray'], '<i8')
        equal([r[3] for r in found if r[2] == 1], [float(r['t']) for r in single if r['status'] == 'hit'])
        for k, share in enumerate(shares, 1):
            run(*of, '--single', '--format', 'csv', '--shard', f'{k}/2', '--output', share)
        equal(run('join', *shares, exit=None).stdout, text)
    one = ('intersect', '--surface', SPHERE, '--single')
    assert 'rounded to single precision' in run(*one, '--ray', '0 0 -5 0 0 1').stdout
    for more, words in ((('--ray', '0 0 -1e39 0 0 1'), 'oz: -1e+39 does not fit in single precision'),
                        (('--ray', '0 0 -5 0 0 1e-50'), 'its direction is 0 in single precision')):
        assert words in run(*one, *more, exit=BAD_INPUT).stderr
    several[2500], several[2700] = (*several[0][:3], 0, 0, 1e-60), (1e60, *several[0][1:])
    text = rays(*(map(repr, r) for r in several))
    for source in (array_of(several), '-'):
        done = run(*one, '--rays', source, '--format', 'csv', stdin=text, exit=BAD_INPUT)
        assert 'ray 2500: its direction' in done.stderr, done.stderr
        equal(done.stdout, '')
    assert 'not with --single' in run(*one, '--rays', '-', '--skip-bad', stdin=text, exit=USAGE).stderr
    for more in (('--all',), ('--watch', out('w.csv'))):
        assert 'not both' in run(*one, '--ray', '0 0 -5 0 0 1', *more, exit=USAGE).stderr


def test_ends_and_numbers_as_ids():
    descr = str([(n, '<f8') for n in (*NAMES, 'tmin', 'tmax')] + [('id', '<i4')])
    path = array(out(), [(0, 0, -5, 0, 0, 1, 0, math.inf, -7), (0, 0, -5, 0, 0, 1, 6, 7, 12)], descr, '<8di')
    equal([(r['status'], r['id']) for r in rows('intersect', '--surface', SPHERE, '--rays', path)],
          [('hit', '-7'), ('miss', '12')])
    done = run('trace', FTHETA, '--rays', path, exit=None)
    assert 'tmin, tmax: not used' in done.stderr


def test_hostile_arrays():
    """Each is refused with the file's name, and before anything is printed."""
    several, plain, one = some_rays(50, 'hostile'), "'<f8'", str([(n, '<f8') for n in NAMES])
    good = array_of(several).read_bytes()
    half = "'<f2'"

    def raw(data):
        path = out()
        path.write_bytes(data)
        return path
    cases = [
        (raw(b''), 'not an npy file'), (raw(good[:7]), 'not an npy file'), (raw(b'ox,oy\n1,2\n'), 'not an npy file'),
        (raw(good[:40]), 'header'), (raw(good[:-1]), 'cut off: 49 rows, but the header says 50'),
        (raw(good + b'!'), '1 bytes behind'), (raw(good[:6] + b'\x09' + good[7:]), 'version 9'),
        (array(out(), several, plain, '<6d', shape='(50, 6)', order='True'), 'C order'),
        (array(out(), several, "'>f8'", '>6d', shape='(50, 6)'), 'lower byte first'),
        (array(out(), several, half, '<6e', shape='(50, 6)'), "'<f2'"),
        (array(out(), several, plain, '<6d', shape='(60, 5)'), 'N x 6'),
        (array(out(), several, plain, '<6d', shape='(300,)'), 'N x 6'),
        (array(out(), [], plain, '<6d', shape='(0, 6)'), 'no rays'),
        (array(out(), several, plain, '<6d', shape='(50, 3, 2)'), 'expected'),
        (array(out(), several, plain, '<6d', shape='()'), 'expected'),
        (array(out(), several, plain, '<6d', shape='(99999999999999999999, 6)'), 'whole number'),
        (array(out(), several, plain, '<6d', shape='(999999999999999, 6)'), 'cut off'),
        (array(out(), several, plain, '<6d', shape='(-50, 6)'), 'whole number'),
        (array(out(), several, "'|O'", '<6d'), 'whole number'), (array(out(), several, '[]', '<6d'), 'without a byte'),
        (array(out(), several, one.replace('dz', 'ez'), '<6d'), 'ez: unknown column'),
        (array(out(), several, one.replace('dz', 'lat'), '<6d'), 'lat: unknown column; places are read from csv'),
        (array(out(), several, one.replace('dz', 'dy'), '<6d'), 'dy: this column is given twice'),
        (array(out(), several, one[:-len(", ('dz', '<f8')]")] + ']', '<6d', shape='(60,)'), 'dz: this column is missing'),
        (array(out(), several, "[('ox', '<f8', (6,))]", '<6d'), 'itself an array'),
        (array(out(), several, one.replace('<f8', '<i8', 1), '<6d'), "ox: of the type '<i8'"),
        (array(out(), several, plain, '<6d', shape='(50, 6)', more="'shape': (50, 6)"), 'given twice'),
        (array(out(), several, plain, '<6d', shape='(50, 6)', more="'other': 1"), 'unknown key'),
        (out('nothing.npy'), 'No such file'), (written('', 'empty').parent, 'this column is missing'),
    ]
    folder = out('columns')
    folder.mkdir()
    for i, name in enumerate(NAMES):
        array(folder / f'{name}.npy', [(r[i],) for r in several[:50 - (i == 4)]], plain, '<d')
    cases.append((folder, 'rows, and'))
    for path, words in cases:
        for command in (('intersect', '--surface', SPHERE), ('trace', FTHETA)):
            done = run(*command, '--rays', path, exit=BAD_INPUT)
            assert words in done.stderr and str(path) in done.stderr, (words, path, done.stderr)
            equal(done.stdout, '')


def test_numpy():
    """What numpy.save writes is read, and numpy.load reads what is written."""
    if not numpy:
        return
    for count in (1, 64, 1025, 3000):
        several = some_rays(count, f'numpy {count}')
        plain = numpy.array(several)
        fields = numpy.dtype([('id', 'S3'), *((n, '<f8') for n in reversed(NAMES)), ('tmax', '<f8')], align=True)
        own = numpy.zeros(count, fields)
        for i, name in enumerate(NAMES):
            own[name] = plain[:, i]
        own['id'], own['tmax'] = b'a', numpy.inf
        numpy.save(first := out('plain.npy'), plain)
        numpy.save(second := out('own.npy'), own)
        found = []
        for path in (first, second):
            run('intersect', '--surface', SPHERE, '--rays', path, '--format', 'npy', '-o', to := out())
            found.append(numpy.load(to))
        for name in found[0].dtype.names:
            assert found[0][name].tobytes() == found[1][name].tobytes(), (count, name)
        for bad, words in ((numpy.asfortranarray(plain), 'C order'), (plain.astype('>f8'), 'lower byte first'),
                           (plain.astype('<f2'), "'<f2'"), (plain[:, :5], 'N x 6'), (plain[:0], 'no rays')):
            if count == 1 and words == 'C order':
                continue                                   # NumPy calls one row both
            numpy.save(path := out(), bad)
            assert words in run('intersect', '--surface', SPHERE, '--rays', path, exit=BAD_INPUT).stderr, words


def test_pipe():
    """An array that comes through a pipe is read as one in a file."""
    path = array_of(some_rays(30000, 'pipe'))
    wanted = run('intersect', '--surface', SPHERE, '--rays', path, '--format', 'csv').stdout
    os.mkfifo(pipe := out('pipe.npy'))
    with subprocess.Popen(['sh', '-c', 'exec cat "$0" > "$1"', path, pipe]):
        equal(run('intersect', '--surface', SPHERE, '--rays', pipe, '--format', 'csv').stdout, wanted)


def limited(*arguments):
    """The command where no file may have more than 100,000 bytes: as on a disk that is full."""
    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (100000, 100000))
    return subprocess.run([SAGITTA, *map(str, arguments)], capture_output=True, text=True, preexec_fn=limit)


def test_a_file_that_changes():
    """Cut within its last page or far before, or written to, while it is read: an error that names the file.

    The command waits with its rows for who reads them, and the file is changed then."""
    unchanged = written('').parent / 'unchanged'
    unchanged.mkdir()
    for name, x in zip(NAMES, (0, 0, -5, 0, 0, 1)):
        array(unchanged / f'{name}.npy', [(x,)] * 100000, "'<f8'", '<d')
    for command, of in (('intersect', ('--surface', SPHERE)), ('trace', (TRIPLET,))):
        for change in ('cut a little', 'cut to half', 'written', 'longer', 'another'):
            folder = written('').parent / 'rays'
            shutil.copytree(unchanged, folder)
            path = folder / 'oz.npy'
            time.sleep(0.02)  # so that the time of the change is another one
            running = subprocess.Popen([SAGITTA, command, *map(str, of), '--rays', folder, '--format', 'csv', '--threads', '2'],
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            running.stdout.read(100)
            size = path.stat().st_size
            if change == 'another':
                path.rename(folder.parent / 'kept')
                path.write_bytes(b'')
            elif change.startswith('cut'):
                os.truncate(path, size - 80 if change == 'cut a little' else size // 2)
            else:
                with open(path, 'r+b') as file:
                    file.seek(size if change == 'longer' else size - 8)
                    file.write(struct.pack('<d', 7))
            said = running.communicate()[1].decode()
            whole = change in ('longer', 'another')
            equal(running.returncode, DECIDED if whole else BAD_INPUT, (command, change, said))
            assert whole or str(path) in said and 'while it was read' in said, (command, change, said)


def test_full_disk():
    few, many = array_of(some_rays(1000, 'fits'), 'few.npy'), array_of(some_rays(20000, 'full'))
    for name, form in (('full.npy', 'npy'), ('columns', 'npy'), ('full.csv', 'csv'), ('full.json', 'json')):
        for threads in (1, 2):
            for path, more in ((few, ('--columns', 'x')), (many, ())):
                done = limited('intersect', '--surface', SPHERE, '--rays', path, '--format', form, '-o', out(name),
                               '--threads', threads, *more)
                equal(done.returncode, BAD_INPUT if path == many else DECIDED, (name, done.stderr))
            assert name in done.stderr and 'could not be written' in done.stderr, done.stderr


def test_memory():
    """It does not grow with the rays of an array, and little with the surfaces of a lens."""
    if b'__asan_init' in pathlib.Path(SAGITTA).read_bytes():
        return                                             # what is freed is kept for a while

    def most(*arguments):
        child = subprocess.Popen([SAGITTA, *map(str, arguments), '--threads', '1'], stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        equal(child.returncode, DECIDED)
        return usage.ru_maxrss                             # kB
    count, ray = 2000000, struct.pack('<6d', 0, 0, -5, 0, 0, 1)
    path = array(out(), [], "'<f8'", '<6d', shape=f'({count}, 6)')
    with open(path, 'ab') as file:
        file.write(ray * count)
    few = array_of(some_rays(9, 'few'), 'few.npy')
    more = (most('intersect', '--surface', SPHERE, '--rays', path, '--columns', 'x', '--format', 'npy', '-o', out('o.npy'))
            - most('intersect', '--surface', SPHERE, '--rays', few, '--columns', 'x', '--format', 'npy', '-o', out('p.npy')))
    assert more < 50000, f'{more} kB more for 96 MB of rays'

    def long(surfaces):
        return written('pupil: {semi_diameter: 1}\nsurfaces:\n' + ''.join(
            f'  - {{type: plane, thickness: 0.001, index: {2 - i % 2}}}\n' for i in range(surfaces)))
    few, many = (most('trace', long(n), '--chief', '--last', '--format', 'csv') for n in (1000, 41000))
    assert (many - few) / 40 < 1100, f'{(many - few) / 40} bytes a surface'


def test_mutated_headers():
    draw = random.Random(f'{SEED} mutants')
    good = array(out(), some_rays(5, 'm'), str([(n, '<f8') for n in NAMES]), '<6d').read_bytes()
    length = good.index(b'\n')
    for _ in range(60):
        data = bytearray(good)
        for _ in range(draw.randint(1, 4)):
            data[draw.randrange(length)] = draw.choice(b"()[]{}',:<>|0123456789SUVf \0\xff")
        path = out()
        path.write_bytes(data)
        done = subprocess.run([SAGITTA, 'intersect', '--surface', SPHERE, '--rays', path], capture_output=True)
        assert done.returncode in (DECIDED, UNDECIDED, BAD_INPUT), (bytes(data), done)


# ------------------------------------------------------------------- refusals

def test_refusals():
    command = ('trace', TRIPLET, '--format', 'npy')
    assert '--output' in run(*command, exit=USAGE).stderr
    assert '--output' in run(*command, '-o', '-', exit=USAGE).stderr
    assert '--hex' in run(*command, '--hex', '-o', out(), exit=USAGE).stderr
    pipe = out('pipe.npy')
    os.mkfifo(pipe)
    assert 'not a file' in run(*command, '-o', pipe, exit=BAD_INPUT).stderr
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert 'No such file' in run(*command, '-o', out() / 'x' / 'y.npy', exit=BAD_INPUT).stderr
    other = out('full')
    other.mkdir()
    (other / 'notes.txt').write_text('mine')
    done = run(*command, '-o', other, exit=BAD_INPUT)
    assert 'notes.txt' in done.stderr and [p.name for p in other.iterdir()] == ['notes.txt'], done.stderr
    less = out('less')
    run(*command, '-o', less)
    assert '.npy, which is no column' in run(*command, '-o', less, '--columns', 'ray,x', exit=BAD_INPUT).stderr
    assert 'a folder' in run(*command, '-o', written('a file', 'file'), exit=BAD_INPUT).stderr
    source = array_of(some_rays(3, 'own'))
    done = run('trace', FTHETA, '--rays', source, '--format', 'npy', '-o', source, exit=USAGE)
    assert 'which is in use' in done.stderr
    for name in ('diagnose', 'info'):
        assert 'text, csv or json' in run(name, TRIPLET, '--format', 'npy', exit=USAGE).stderr


# ------------------------------------------------------------- text, progress

def test_long_text():
    """More rows than memory is given to: as the same rows in columns, whose widths are those of all."""
    several = some_rays(80000, 'text')
    several[-1] = (1e-300, 1e300, -5.0, 0.0, 0.0, 1.0)
    path = array_of(several)
    text = run('intersect', '--surface', '{type: plane}', '--rays', path, binary=True).stdout.decode()
    lines = text.split('\n\n')[0].splitlines()
    table = rows('intersect', '--surface', '{type: plane}', '--rays', path)
    assert len(text) > 6000000
    equal(len(lines), 80001)
    ends = [m.end() for m in re.finditer(r' \S+', lines[0])]
    assert len({len(line.rstrip()) for line in lines[1:]} & {len(lines[0])}) <= 1
    for line, row in zip(lines[1:], table):
        cells = line.split()
        equal(cells[0], row['ray'])
        for i in (5, 6):
            equal(cells[i], '%.9g' % float(row['xyz'[i - 5]]))
        assert line[ends[1] - 1] != ' ' or line[ends[1]] == ' ', line


def test_progress():
    """Only if it is asked for, since standard error is no terminal here."""
    command = ('trace', FTHETA, '--grid', 5, '--format', 'csv')
    quiet, told = run(*command), run(*command, '--progress')
    equal(quiet.stderr, '')
    equal(quiet.stdout, told.stdout)
    assert re.fullmatch(r'sagitta: \d+ rays, \d+\.\d s, \S+ rays a second\n', told.stderr), told.stderr
    assert '\x1b' not in told.stderr


main(globals())
