# SPDX-License-Identifier: MIT
"""What the tests of the command share: run it, read what it says, count what fails.

Each test is a script, `python3 test_NAME.py SAGITTA`, of functions whose names begin
with `test_`; `main` runs them all and says which failed.
"""
import csv
import datetime
import io
import itertools
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import traceback

HERE = pathlib.Path(__file__).resolve().parent
LENSES = HERE.parent.parent / 'examples' / 'lenses'
SAGITTA = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else 'sagitta'
# 0.05 under sanitizers, where the start of a command takes ten times as long.
SCALE = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))
SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'), 0)

# clang 14 takes what stands before the thread's memory of a library for its size, and the leak checker then reads
# anywhere: of a few pictures, cairo's threads' memory (sheet 349762166 of test_chart.py).
os.environ.setdefault('ASAN_OPTIONS', 'intercept_tls_get_addr=0')
os.environ['LSAN_OPTIONS'] = f'suppressions={HERE / "leaks.supp"}:print_suppressions=0'

DECIDED, UNDECIDED, USAGE, BAD_INPUT = 0, 1, 2, 3

INTERSECT = 'ray,root,status,t,t_err,x,y,z,nx,ny,nz,evals'
TRACE = 'ray,element,fate,status,x,y,z,l,m,n,t,t_err,opl,evals'
TRACE_ALL = TRACE + ',field,wavelength,px,py'   # csv and json
DIAGNOSE = 'ray,element,eval,move,t,f,slope,lo,hi,f_lo,f_hi,slope_lo,slope_hi'


def commands(page=''):
    """The subcommands that --help lists; those only whose own help names a page."""
    names = re.findall(r'^  sagitta ([a-z]+) ', run('--help').stdout, re.MULTILINE)
    return [name for name in names if page in run(name, '--help', 'all').stdout]


calls = itertools.count()


def run(*arguments, stdin='', exit=DECIDED, binary=False):
    """Runs the command; what it printed.  A status other than `exit` is a failure (None: 0 or 1)."""
    # Under sanitizers every third run looks for leaks, which takes a quarter of a short run.
    leaks = '' if next(calls) % 3 == 0 else ':detect_leaks=0'
    if isinstance(stdin, str):
        stdin = stdin.encode()
    done = subprocess.run([SAGITTA, *map(str, arguments)], input=stdin, capture_output=True, timeout=100,
                          env={**os.environ, 'ASAN_OPTIONS': os.environ['ASAN_OPTIONS'] + leaks})
    if done.returncode not in ((DECIDED, UNDECIDED) if exit is None else (exit,)):
        raise AssertionError(f'exit {done.returncode}, not {exit}: {arguments}\n{done.stderr.decode()[-1500:]}')
    if not binary:
        done.stdout, done.stderr = done.stdout.decode(), done.stderr.decode()
    return done


def rows(*arguments, **how):
    """The rows of `--format csv` as dictionaries."""
    return list(csv.DictReader(io.StringIO(run(*arguments, '--format', 'csv', **how).stdout)))


def written(text, name='input.yaml'):
    """A file with this text, in a folder of its own; its path."""
    path = pathlib.Path(tempfile.mkdtemp(dir=folder.name)) / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def rays(*several, header='ox,oy,oz,dx,dy,dz'):
    return '\n'.join([header, *(','.join(map(str, ray)) for ray in several)]) + '\n'


def equal(got, wanted, what=''):
    if got != wanted:
        raise AssertionError(f'{what}: {got!r}, not {wanted!r}')


def close(got, wanted, within, what=''):
    if not abs(float(got) - float(wanted)) <= within:
        raise AssertionError(f'{what}: {got} is not within {within} of {wanted}')


folder = tempfile.TemporaryDirectory()


def main(names, halved=True):
    """halved=False: its functions hang together, by the random numbers that they draw."""
    failed = 0
    tests = [(name, test) for name, test in names.items() if name.startswith('test_')]
    # Under sanitizers the start of a command takes ten times as long: every other function, by day the others.
    if halved and SCALE < 0.1 and len(tests) > 3:
        half = int(os.environ.get('SAGITTA_TEST_HALF', datetime.date.today().toordinal())) % 2
        print(f'SAGITTA_TEST_HALF={half}: {len(tests[half::2])} of {len(tests)} functions')
        tests = tests[half::2]
    for name, test in tests:
        try:
            test()
        except Exception:
            failed += 1
            print(f'FAILED {name}: {test.__doc__ or ""}\n{traceback.format_exc()}')
        else:
            print(f'ok     {name}')
    sys.exit(1 if failed else 0)
