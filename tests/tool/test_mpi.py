#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sagitta-mpi: the bytes of one process, for any number of ranks; ranks that die, disks that are full.

    python3 test_mpi.py SAGITTA SAGITTA-MPI [--without-cairo] [--without-openmp] [--night]

Runs as root, with more ranks than processors, on a machine that has no network but lo, no ssh, and no right to
read another process's memory: MPI is told so below.
"""
import os
import random
import resource
import shutil
import signal
import struct
import time

from command import *

SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'))
DRAW = random.Random(SEED)
NIGHT = '--night' in sys.argv
CAIRO = '--without-cairo' not in sys.argv
THREADS = ('1',) if '--without-openmp' in sys.argv else ('1', '2')
if sys.argv[2] == 'none':
    print('skipped: there is no sagitta-mpi (meson setup finds no MPI, or -Dmpi=disabled)')
    sys.exit(77)
MPI = os.path.abspath(sys.argv[2])
TRIPLET, GAUSS = LENSES / 'cooke_triplet.yaml', LENSES / 'double_gauss.yaml'
SPHERE = '{type: sphere, radius: 3, semi_diameter: 2}'
PLAIN = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT='1', OMPI_ALLOW_RUN_AS_ROOT_CONFIRM='1', OMPI_MCA_plm='isolated',
             OMPI_MCA_rmaps_base_oversubscribe='1', OMPI_MCA_hwloc_base_binding_policy='none',
             OMPI_MCA_mpi_yield_when_idle='1', OMPI_MCA_btl='self,vader',
             OMPI_MCA_btl_vader_single_copy_mechanism='none', OMPI_MCA_oob_tcp_if_include='lo',
             ASAN_OPTIONS=os.environ['ASAN_OPTIONS'] + ':detect_leaks=0')  # MPI's own
# Nothing that takes room in files before the run does.
SMALL_FILES = dict(PLAIN, OMPI_MCA_btl='self,tcp', OMPI_MCA_btl_tcp_if_include='lo', OMPI_MCA_osc='pt2pt',
                   PMIX_MCA_gds='hash')
print(f'seed {SEED}')


def place(*names):
    """A folder of its own; paths in it."""
    path = pathlib.Path(tempfile.mkdtemp(dir=folder.name))
    return [path / name for name in names] if names else path


def command(ranks, *arguments):
    return ['mpirun', '-n', str(ranks), MPI, *map(str, arguments)]


def mpi(ranks, *arguments, exit=DECIDED, stdin=b'', env=PLAIN, **how):
    """Runs it; mpirun says nothing of ranks that end in good order with another status than 0."""
    here = how.pop('cwd', None) or place()
    line = command(ranks, *arguments)
    done = subprocess.run(line[:1] + ['-q'] + line[1:], capture_output=True, timeout=200, env=env, cwd=here,
                          input=stdin, **how)
    if done.returncode != exit:
        raise AssertionError(f'exit {done.returncode}, not {exit}: {ranks} {arguments}\n'
                             f'{done.stderr.decode()[-1500:]}')
    if exit in (DECIDED, UNDECIDED):
        equal([name for name in os.listdir(here) if 'parts' in name or 'unfinished' in name], [], 'left behind')
    return done


def same(ranks, *arguments, stdin=b''):
    """One process and so many ranks print the same, say the same, and end alike."""
    whole = run(*arguments, exit=None, binary=True, stdin=stdin)
    threads = ('--threads', DRAW.choice(THREADS)) if arguments[0] != 'info' else ()
    done = mpi(ranks, *arguments, *threads, exit=whole.returncode, stdin=stdin)
    equal((done.stdout, done.stderr), (whole.stdout, whole.stderr), (ranks, arguments))


def some_rays(count, bad=()):
    lines = [[DRAW.uniform(-3, 3), DRAW.uniform(-3, 3), -5.0, DRAW.uniform(-.2, .2), DRAW.uniform(-.2, .2), 1.0]
             for _ in range(count)]
    for i in bad:
        lines[i][3] = float('nan')
    text = 'id,ox,oy,oz,dx,dy,dz\n' + ''.join(f'r{i},' + ','.join(map(repr, r)) + '\n' for i, r in enumerate(lines))
    head = "{'descr': '<f8', 'fortran_order': False, 'shape': (%d, 6), }" % count
    head += ' ' * (117 - len(head)) + '\n'
    return written(text, 'rays.csv'), written(
        b'\x93NUMPY\x01\x00' + struct.pack('<H', len(head)) + head.encode() +
        b''.join(struct.pack('<6d', *line) for line in lines), 'rays.npy')


CSV, NPY = some_rays(5300)
JULIA = '{type: julia, c: [-0.2, 0.8, 0, 0], iterations: 6}'
ASKED = [  # lost and clipped rays, several fields and wavelengths, proofs, sums by a tree, rays of files
    ('spot', GAUSS, '--hexapolar', 9, '--wavelength', 'all', '--proof', 'first'),
    ('trace', GAUSS, '--hexapolar', 16, '--wavelength', 'all', '--format', 'csv'),
    ('intersect', '--surface', JULIA, '--rays', NPY, '--max-evals', 20, '--proof', 'first'),
    ('opd', TRIPLET, '--zernike', 11, '--cells', 70, '--format', 'json'),
    ('energy', TRIPLET, '--format', 'csv'),
    ('trace', LENSES / 'ftheta.yaml', '--rays', CSV, '--last', '--proof', 'first', '--format', 'json'),
    ('spot', GAUSS, '--reference', 'centroid', '--cells', 30, '--aim', 'real'),
    ('intersect', '--surface', SPHERE, '--rays', NPY, '--all', '--proof', 'first', '--format', 'csv'),
]
MORE = [
    ('spot', TRIPLET, '--reference', 'centroid', '--sobol', 30000), ('fan', GAUSS), ('opd', TRIPLET),
    ('opd', TRIPLET, '--summary', '--sobol', 700), ('opd', TRIPLET, '--zernike', 11),
    ('field', GAUSS, '--steps', 5), ('map', GAUSS, '--random', 500, '--field', 40),
    ('map', GAUSS, '--over', 'field', '--steps', 4),
    ('sweep', GAUSS, '--to', 40, '--steps', 4, '--aim', 'real', '--hexapolar', 3),
    ('sweep', TRIPLET, '--over', 'surfaces[6].thickness', '--from', 42, '--to', 43, '--steps', 2),
    ('illumination', GAUSS), ('ends', GAUSS, '--hexapolar', 4), ('info', TRIPLET),
    ('intersect', '--surface', SPHERE, '--rays', CSV), ('trace', GAUSS, '--hexapolar', 9, '--aim', 'real'),
    ('trace', GAUSS, '--random', 6000, '--aim', 'real', '--field', 40, '--last', '--format', 'json'),
    ('intersect', '--surface', SPHERE, '--ray', '0 0 -9 0 0 1')]


def test_bytes():
    for i, arguments in enumerate(ASKED):
        for ranks in (1, 2, 3, 4) if NIGHT else (2 + i % 3,):
            same(ranks, *arguments)
    for i, arguments in enumerate(MORE if NIGHT else ()):
        for ranks in (2, 3):
            same(ranks, *arguments, *(('--format', ('text', 'csv', 'json')[i % 3]) if '--format' not in arguments and
                                      arguments[0] != 'info' else ()))


def test_standard_input():
    same(2, 'intersect', '--surface', SPHERE, '--rays', '-', '--format', 'csv', stdin=CSV.read_bytes())


def test_arrays():
    """In one file or one for each column: rows in place, and rows whose number is known when they are traced."""
    _, bad = some_rays(5000, bad=(17, 4100))
    asked = [('intersect', '--surface', SPHERE, '--rays', NPY),
             ('trace', GAUSS, '--hexapolar', 26, '--wavelength', 'all', '--last')]
    more = [('trace', GAUSS, '--hexapolar', 16), ('intersect', '--surface', SPHERE, '--rays', bad, '--skip-bad'),
            ('intersect', '--surface', SPHERE, '--rays', CSV, '--columns', 'id,t,status'),
            ('intersect', '--surface', SPHERE, '--rays', NPY, '--all'),
            ('trace', LENSES / 'ftheta.yaml', '--rays', NPY, '--last', '--proof', 'first'),
            ('trace', GAUSS, '--random', 6000, '--aim', 'real', '--field', 40, '--last')]
    for i, arguments in enumerate(asked + more if NIGHT else asked):
        one, several = place('rows.npy'), place('rows.npy')
        if i % 2:
            one, several = [place() / 'rows'], [place() / 'rows']
        run(*arguments, '--format', 'npy', '--output', one[0], exit=None)
        said = mpi(2 + i % 3, *arguments, '--format', 'npy', '--output', several[0], cwd=several[0].parent,
                   exit=run(*arguments, '--format', 'npy', '--output', one[0], exit=None).returncode)
        files = sorted(p.relative_to(one[0].parent) for p in one[0].parent.rglob('*'))
        equal(sorted(p.relative_to(several[0].parent) for p in several[0].parent.rglob('*')), files, arguments)
        for name in files:
            if (one[0].parent / name).is_file():
                equal((several[0].parent / name).read_bytes() == (one[0].parent / name).read_bytes(), True,
                      (arguments, name, said.stderr))


def test_pictures():
    """Those of sums, which need the rays once more, are for rank 0 alone."""
    asked = [('trace', GAUSS, '--fan', 5), ('opd', TRIPLET, '--summary')]
    asked += [('spot', GAUSS, '--hexapolar', 6), ('spot', GAUSS, '--hexapolar', 82, '--fields', 1)]
    for arguments in asked if NIGHT else asked[:1] if CAIRO else ():
        picture, = place('picture.svg')
        run(*arguments, '--picture', picture)
        once = picture.read_bytes()
        picture.unlink()
        mpi(3, *arguments, '--picture', picture, cwd=picture.parent)
        equal(picture.read_bytes(), once, arguments)


def refused(words, status, ranks, *arguments, **how):
    done = mpi(ranks, *arguments, exit=status, **how)
    for word in words:
        equal(done.stderr.decode().count(str(word)), 1, (word, done.stderr))
    equal(done.stdout, b'', arguments)


def test_refused():
    """Said once, by one rank."""
    refused(['no-such.yaml'], BAD_INPUT, 3, 'spot', 'no-such.yaml')
    if NIGHT:
        refused(["--hexapolr'", 'Try: sagitta spot'], USAGE, 3, 'spot', GAUSS, '--hexapolr', 3)
        refused(['--shard'], USAGE, 2, 'spot', GAUSS, '--shard', '1/2', '--output', 'x')
        refused(['--output FILE'], USAGE, 2, 'spot', GAUSS, '--resume')
        if CAIRO:
            both = place() / 'x.svg'
            refused(['would be written over'], USAGE, 2, 'spot', GAUSS, '--picture', both, '--output', both)
        refused(['row 4100'], BAD_INPUT, 2, 'intersect', '--surface', SPHERE, '--rays', some_rays(5000, bad=[4100])[1])


def test_progress():
    said = mpi(2, 'spot', GAUSS, '--random', 3000, '--progress').stderr.decode()
    assert re.search(r'sagitta: \d+ rays, \d+\.\d s, \S+ rays a second\n', said), said


# ------------------------------------------------------------------- runs that end

LONG = ('spot', TRIPLET, '--random', 300000, '--threads', 1)
ROWS = ('intersect', '--surface', SPHERE, '--rays', some_rays(150000)[1], '--format', 'npy', '--threads', 1)


def start(ranks, output, *arguments, **how):
    return subprocess.Popen(command(ranks, *arguments, '--output', output), stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, env=PLAIN, cwd=output.parent, **how)


def ranks_of(running):
    """The processes that it has started."""
    try:
        tasks = pathlib.Path(f'/proc/{running.pid}/task')
        return [int(pid) for task in tasks.iterdir() for pid in (task / 'children').read_text().split()]
    except OSError:
        return []


def parts(output):
    try:
        return [pathlib.Path(f'{output}.parts') / name for name in os.listdir(f'{output}.parts')
                if name.endswith('.part')]
    except OSError:
        return []


def until(found, running):
    for _ in range(5000):
        if running.poll() is not None or found():
            return
        time.sleep(0.002)


def ended(running, output, words):
    """It failed, said why, and left nothing that looks whole."""
    said = running.communicate(timeout=100)[1].decode()
    assert running.returncode not in (DECIDED, UNDECIDED), said
    for word in words:
        assert str(word) in said, (word, said)
    assert not output.exists(), output


def resumed(ranks, output, arguments, wanted, word=''):
    said = mpi(ranks, *arguments, '--output', output, '--resume', cwd=output.parent).stderr.decode()
    assert word in said, (word, said)
    equal(output.read_bytes() == wanted, True, arguments)
    output.unlink()


def wanted_of(arguments):
    output, = place('one.npy')
    run(*arguments, '--output', output, exit=None)
    return output.read_bytes()


def test_kills():
    """A rank is killed at any time; the others end, and --resume, with any number of ranks, gives the same bytes."""
    asked = [(arguments, wanted_of(arguments)) for arguments in (LONG, ROWS)]
    for kill in range(20 if NIGHT else 3):
        arguments, wanted = asked[kill % 2]
        output, = place('out.npy')
        ranks = DRAW.randint(2, 4)
        running = start(ranks, output, *arguments)
        some = DRAW.choice((0, 1, 3, 20, 100))
        until(lambda: len(parts(output)) >= some and len(ranks_of(running)) == ranks, running)
        pids = ranks_of(running)
        begun = bool(parts(output))
        if running.poll() is None and pids:
            os.kill(DRAW.choice(pids), signal.SIGKILL)
        said = running.communicate(timeout=100)[1].decode()
        if output.exists():  # it was done
            equal(output.read_bytes() == wanted, True, said)
        else:
            assert running.returncode and said, said
            assert not begun or ('rank' in said and 'signal 9' in said), said  # before, mpirun knows no rank
        resumed(DRAW.randint(1, 4), output, arguments, wanted)


def test_half_a_part():
    """A part that was cut in half is named, and made anew."""
    output, = place('out.txt')
    running = start(2, output, *LONG)
    until(lambda: len(parts(output)) > 3, running)
    for pid in ranks_of(running):
        os.kill(pid, signal.SIGKILL)
    running.communicate()
    some = parts(output)
    if some:
        cut = some[0]
        cut.write_bytes(cut.read_bytes()[:cut.stat().st_size // 2])
        resumed(3, output, LONG, wanted_of(LONG), f'{cut}: ')


def test_no_room():
    """Files that may not grow, as on a full disk: named, and nothing is left but parts."""
    for arguments in (LONG, ROWS) if NIGHT else (LONG,):
        output, = place('out.npy')
        said = mpi(2, *arguments, '--output', output, exit=BAD_INPUT, cwd=output.parent, env=SMALL_FILES,
                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))).stderr.decode()
        assert f'--output {output}' in said and 'could not be written' in said, said  # by one rank, or by each
        assert not output.exists()
        resumed(2, output, arguments, wanted_of(arguments))


def test_folder_gone():
    output, = place('out.txt')
    running = start(2, output, *LONG)
    until(lambda: len(parts(output)) > 3, running)
    for _ in range(100):
        shutil.rmtree(output.parent, ignore_errors=True)
    ended(running, output, [f'{output}'])
    output.parent.mkdir(exist_ok=True)
    resumed(2, output, LONG, wanted_of(LONG))


main(globals())
