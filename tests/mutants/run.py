#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""run.py - single edits of src, one at a time, and whether a test notices.

    python3 tests/mutants/run.py               every edit of *.txt here
    python3 tests/mutants/run.py n03 m12       these
    python3 tests/mutants/run.py --share K/N   each N-th, beginning with number K from 0: N runs try all
    python3 tests/mutants/run.py --check       only: does each old text still occur once?

--work DIR      holds one copy of the tree for each job, its build, results.txt and times.txt (build/mutants); it may be used again
--jobs N        copies that work side by side (1)
--threads N     of the compiler in each (2)
--only-nearest  the tests nearest to the file, not the rest of the suite
--resume        not those again that results.txt has; and the copies are not brought up to date
--timeout S     of one test (600): a hang is a kill
--limit S       of one edit (3600): then it counts as a survivor, and the line says so

The nearest tests are those of the table below, in its order; the rest follow, short ones first, by the time that each took
last (times.txt).  Those whose programs are not built of the file's library are left out.

An edit is killed by the first test that fails, is stopped by a signal or runs out of time, and passes without the edit.  What does not compile is no
edit: mend it.  The line of an edit has its id, what became of it, seconds, and its note.

Edits are kept as text, not by line numbers.  In *.txt an edit is

    == id file
    wrong answer: what it does           or  margin only: ...
    -old text, that must occur once in the file
    +new text; without a line of + the old text goes

`margin only`: a bound is too small, and no ray is known that then gets a wrong answer.  `survives: why` instead of either:
it is known that no test notices, and why none can; that is no failure of the run.  Several lines of - or + are joined
by newlines; they need not be whole lines of the file.

A copy is built for one kind of processor (-Dclones=x86-64-v3 where this machine has it), the tests once and for all: they
are linked to libsagitta.so, and an edit costs its objects and one link, and the few tests that include a
file of src.  Where ccache is there the way back is free.
"""
import argparse, concurrent.futures, json, os, re, shutil, signal, subprocess, sys, time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))

# The tests nearest to a file of src: the first row whose pattern matches.  Names are those of `meson test --list`.
NEAREST = [
    (r'src/num/decimal', ['unit decimal', 'fuzz formula', 'tool lens_files']),
    (r'src/num/', ['unit exact', 'unit table', 'catalogue climb', 'proof']),
    (r'src/lens/(.*/)?(agf|csv|rii|catalogue|glass|medium|reader|arena)', ['lens glass', 'fuzz glass', 'tool glass', 'tool media', 'tool info', 'numbers']),
    (r'src/lens/tolerance/worst', ['tool worst', 'tolerances']),
    (r'src/lens/prove/wide', ['wide numbers', 'tool worst']),
    (r'src/lens/prove/', ['edges of a pupil', 'rays in boxes', 'lens prove']),
    (r'src/lens/(tolerance/|read/tolerance)', ['tolerances', 'tool tolerance', 'python tolerance']),
    (r'src/lens/(edit/|open/resolve|read/path)', ['edits', 'tolerances', 'fuzz edit', 'tool lens_files', 'zmx']),
    (r'src/lens/(.*/)?seq', ['seq', 'mutated seq', 'fuzz seq']),
    (r'src/lens/(.*/)?zmx', ['fuzz zmx', 'zmx fields', 'zmx', 'tool lens_files']),
    (r'src/lens/(.*/)?(pattern)', ['patterns', 'tool spot', 'analysis']),
    (r'src/lens/(.*/)?(matrix|tree|yaml|read|write|text|lens|surface|formula|aperture|frame)', ['fuzz lens', 'tool lens_files', 'tool formula', 'tool trace', 'tool info', 'tool media', 'tool all', 'zmx fields', 'tool errors', 'edits', 'numbers']),
    (r'src/lens/(.*/)?(launch|aim)', ['tool aim', 'analysis units', 'numbers', 'analysis', 'tool aim_family', 'zmx fields']),
    (r'src/lens/', ['tool info', 'analysis units', 'numbers', 'analysis', 'tool aim', 'zmx fields', 'zmx']),
    (r'src/check/diagnose', ['unit diagnose', 'tool diagnose']),
    (r'src/check/', ['unit check']),
    (r'src/surface/orbit/', ['unit levels', 'climb', 'oracle levels', 'tool level', 'batch']),
    (r'src/surface/.*/second|src/ray/sensitivity', ['sensitivity', 'catalogue values']),
    (r'src/surface/(sag|conic|asphere)/|src/solve/accept', ['climb', 'edges', 'unit rows', 'unit all', 'unit check', 'unit table', 'oracle quad', 'oracle random', 'oracle hard', 'oracle equator', 'oracle only', 'batch', 'proof']),
    (r'src/surface/body/', ['climb', 'enclosures', 'clearances', 'edges', 'catalogue roots', 'catalogue laws', 'catalogue batch', 'catalogue']),
    (r'src/surface/builtin', ['unit general', 'unit all', 'batch']),
    (r'src/surface/formula/enclose_lanes', ['fuzz formula', 'enclose lanes', 'formula roots by hand', 'formula random roots', 'unit formula', 'formula']),
    (r'src/surface/formula/(decimal|scan|read|grammar|fault)', ['fuzz formula', 'formula text', 'unit decimal', 'unit formula', 'formula']),
    (r'src/surface/formula/', ['fuzz formula', 'formula operations singly', 'unit formula', 'formula random roots', 'formula catalogue', 'formula']),
    (r'src/surface/departure/', ['fuzz surface', 'catalogue formulas', 'checksums', 'catalogue values', 'differences', 'catalogue laws', 'catalogue enclosures', 'catalogue wings', 'catalogue rim', 'catalogue climb', 'catalogue roots', 'edges', 'catalogue']),
    (r'src/surface/', ['climb', 'enclosures', 'edges', 'catalogue', 'sensitivity']),
    (r'src/ray/cells_batch', ['unit general', 'checksums', 'oracle cells', 'formula random roots', 'batch user_batch', 'batch']),
    (r'src/ray/glance', ['catalogue roots', 'catalogue rim', 'catalogue wings', 'edges', 'unit rows', 'batch']),
    (r'src/ray/wings', ['catalogue wings', 'catalogue rim', 'edges', 'unit rows', 'catalogue roots', 'batch']),
    (r'src/ray/(proof|enclosed)', ['unit prove', 'unit general', 'oracle only', 'oracle proof', 'tool proof', 'catalogue clearances', 'edges', 'rays that are not there', 'catalogue twice']),
    (r'src/ray/(lanes|batch)', ['batch', 'catalogue batch']),
    (r'src/ray/(cells|walk|general)|src/solve/step', ['unit general', 'unit intersect', 'unit all', 'catalogue twice', 'edges', 'unit rows', 'oracle brute', 'catalogue roots', 'batch']),
    (r'src/solve/entries', ['unit quick', 'unit all', 'unit prove', 'oracle all', 'catalogue twice', 'unit root', 'unit rows', 'catalogue roots', 'climb', 'batch']),
    (r'src/solve/', ['unit root', 'unit intersect', 'unit rows', 'oracle brute']),
    (r'src/ray/(prove|unique)', ['unit prove', 'edges', 'unit trace', 'proof', 'catalogue roots', 'catalogue laws']),
    (r'src/system/(aim|error|gradient)_batch', ['derivatives and aims of many rays', 'errors of many ends', 'doors']),
    (r'src/system/(beam|model)', ['unit beam', 'unit aperture', 'rays in boxes']),
    (r'src/system/aperture', ['unit aperture', 'unit beam', 'edges']),
    (r'src/surface/(conic/side|asphere/unique)', ['leave', 'batch', 'catalogue batch']),
    (r'src/system/(aim|bundle|form)', ['unit form', 'tool aim', 'sensitivity aim', 'rays that are not there', 'tool aim_family', 'analysis units', 'ideal lenses', 'tool look']),
    (r'src/system/gradient', ['sensitivities of traces', 'differences', 'ideal lenses', 'sensitivity']),
    (r'src/system/', ['unit trace', 'unit aperture', 'unit pose', 'edges', 'unit refract', 'batch trace', 'oracle reference']),
    (r'src/geo/', ['earth']),
    (r'src/tool/', ['tool']),
]
# What an edit of src cannot change, what builds the library anew, and what has a library of its own (Python).
NEVER = (r'^(sets|installed|floors|rooms|names|tags|tables of the types|headers|symbols|saved interface|readme|vectorised|fast math'
         r'|one surface|builds|found by CMake|page |example in |examples in |python |cost|no allocation|stack|version)')
SECONDS = 5.0 # of a test whose time is not known yet


def fail(text):
    sys.exit(f'run.py: {text}')


def read_edits():
    edits = {}
    for name in sorted(os.listdir(HERE)):
        if not name.endswith('.txt'):
            continue
        edit = None
        for number, line in enumerate(open(os.path.join(HERE, name)), 1):
            line = line.rstrip('\n')
            if line.startswith('== '):
                _, key, path = line.split()
                if key in edits:
                    fail(f'{name}:{number}: {key} is there twice')
                edit = edits[key] = {'id': key, 'file': path, 'note': '', 'old': [], 'new': []}
            elif edit and line.startswith('-'):
                edit['old'].append(line[1:])
            elif edit and line.startswith('+'):
                edit['new'].append(line[1:])
            elif edit and line and not line.startswith('#') and not edit['note']:
                edit['note'] = line
            elif line and not line.startswith('#'):
                fail(f'{name}:{number}: what is this?')
    for edit in edits.values():
        edit['old'], edit['new'] = '\n'.join(edit['old']), '\n'.join(edit['new'])
        if not edit['old'] or not re.match('(wrong answer|margin only|survives): ', edit['note']):
            fail(f'{edit["id"]}: no old text, or no note')
    return edits


def places(text, old):
    """Where the old text stands, as (begin, end); how its lines are broken is of no account."""
    kept = [i for i, c in enumerate(text) if not c.isspace()]
    joined, wanted = ''.join(text[i] for i in kept), ''.join(old.split())
    found, at = [], joined.find(wanted)
    while at >= 0:
        found.append((kept[at], kept[at + len(wanted) - 1] + 1))
        at = joined.find(wanted, at + 1)
    return found


def occurrences(edit, root):
    try:
        return len(places(open(os.path.join(root, edit['file'])).read(), edit['old']))
    except FileNotFoundError:
        return 0


def run(command, log, timeout, **more):
    """The exit code, or what stopped it."""
    with open(log, 'wb') as out:
        process = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, start_new_session=True, **more)
        try:
            return process.wait(timeout)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            return 'timeout'


class Copy:
    """A copy of the tree and its build."""

    def __init__(self, work, index, arguments):
        self.root, self.build, self.arguments = os.path.join(work, f'tree{index}'), os.path.join(work, f'tree{index}', 'build', 'm'), arguments
        self.log = os.path.join(work, f'log{index}')
        os.environ.setdefault('CCACHE_BASEDIR', work), os.environ.setdefault('CCACHE_NOHASHDIR', '1')
        self.trusted = set() # tests that failed with an edit and pass without
        self.times_file, self.times = os.path.join(work, 'times.txt'), {}
        if os.path.exists(self.times_file):
            for line in open(self.times_file):
                seconds, name = line.rstrip('\n').split('\t')
                self.times[name] = float(seconds)
        if not os.path.isdir(self.root):
            os.makedirs(self.root)
            self.bring()
        elif not arguments.resume:
            self.bring()
        if not os.path.isfile(os.path.join(self.build, 'build.ninja')):
            flags = ['-Dexamples=false', '-Dbenchmark=disabled']
            if os.path.exists('/proc/cpuinfo') and ' avx2 ' in open('/proc/cpuinfo').read():
                flags.append('-Dclones=x86-64-v3')
            cached = shutil.which('ccache')
            own = dict(os.environ)
            if cached:
                own.update({'CC': os.environ.get('CC', 'ccache gcc'), 'CXX': os.environ.get('CXX', 'ccache g++')})
            if run(['meson', 'setup', self.build, self.root] + flags, self.log, 600, env=own) != 0:
                fail(f'meson setup: see {self.log}')
        if run(['nice', 'ninja', '-C', self.build, '-j', str(arguments.threads)], self.log, 7200) != 0:
            fail(f'the build of the copy: see {self.log}')
        listed = subprocess.run(['meson', 'introspect', '--tests', self.build], capture_output=True, check=True).stdout
        self.tests = [t for t in json.loads(listed) if not re.match(NEVER, t['name'])
                      and not any(s.split(':')[-1] == 'nightly' for s in t['suite'])]
        listed = json.loads(subprocess.run(['meson', 'introspect', '--targets', self.build], capture_output=True, check=True).stdout)
        self.programs = {t['id']: t['filename'][0] for t in listed if t['type'] == 'executable'}
        self.own = {t['filename'][0] for t in listed if t['type'] == 'executable' and self.has_src(t)}
        self.targets = [os.path.relpath(f, self.build)
                        for f in [t['filename'][0] for t in listed if t['type'] == 'shared library'] + sorted(self.own)]

    def has_src(self, target):
        """Whether the program has a part of src in itself: the command, what includes a file of src, or is linked statically."""
        sources = [f for group in target['target_sources'] for f in group.get('sources', []) if f.endswith('.c')]
        included = target['name'].startswith('test_') and any('#include "../../src/' in open(f).read() for f in sources)
        return target['name'] in ('sagitta', 'test_enclose_lanes') or included

    def may_notice(self, test, path):
        """Whether a program of the test has in it, or is linked to, what is built of the file."""
        room = path.split('/')[1]
        library = f'libsagitta_{room}.so' if room in ('lens', 'geo') else 'libsagitta.so'
        programs = [self.programs[i] for i in test['depends'] if i in self.programs]
        return any(library.encode() in open(p, 'rb').read() or p in self.own and room not in ('lens', 'geo') for p in programs)

    def bring(self):
        listed = subprocess.run(['git', '-C', ROOT, 'ls-files', '-z', '--cached', '--others', '--exclude-standard'], capture_output=True, check=True).stdout
        for name in listed.decode().split('\0'):
            source, target = os.path.join(ROOT, name), os.path.join(self.root, name)
            if not name or not os.path.isfile(source):
                continue
            if os.path.isfile(target) and open(source, 'rb').read() == open(target, 'rb').read():
                continue
            os.makedirs(os.path.dirname(target), exist_ok=True)
            shutil.copy(source, target)

    def order(self, path):
        """The tests, the nearest first; a name in the table stands for all tests whose name has it."""
        nearest = next((names for pattern, names in NEAREST if re.match(pattern, path)), [])
        first = []
        tests = sorted((t for t in self.tests if self.may_notice(t, path)), key=lambda t: self.times.get(t['name'], SECONDS))
        for name in nearest:
            first += [t for t in tests if name in f'{t["suite"][0].split(":")[-1]} {t["name"]}' and t not in first]
        return first, [t for t in tests if t not in first]

    def make(self):
        return run(['nice', 'ninja', '-C', self.build, '-j', str(self.arguments.threads)] + self.targets, self.log, 1800)

    def passes(self, test):
        """'' or how it failed."""
        environment = dict(os.environ, **test['env'])
        environment.pop('SAGITTA_TEST_SEED', None), environment.pop('SAGITTA_TEST_SCALE', None)
        began = time.time()
        result = run(['nice'] + test['cmd'], self.log, self.arguments.timeout, env=environment, cwd=test['workdir'] or self.build)
        if result == 0:
            self.times[test['name']] = time.time() - began
            with open(self.times_file, 'w') as out:
                out.writelines(f'{seconds:.2f}\t{name}\n' for name, seconds in sorted(self.times.items(), key=lambda t: t[1]))
        return '' if result in (0, 77) else ' (time)' if result == 'timeout' else f' (signal {-result})' if result < 0 else ' '

    def judge(self, edit):
        path = os.path.join(self.root, edit['file'])
        text = open(path).read()
        found = places(text, edit['old'])
        if len(found) != 1:
            return 'NOT THERE', f'the old text occurs {len(found)} times', 0
        began = time.time()
        edited = text[:found[0][0]] + edit['new'].strip() + text[found[0][1]:]
        try:
            open(path, 'w').write(edited)
            if self.make() != 0:
                errors = [l.strip() for l in open(self.log, errors='replace') if 'error' in l]
                return 'NO BUILD', errors[0] if errors else self.log, time.time() - began
            first, rest = self.order(edit['file'])
            for test in first + ([] if self.arguments.only_nearest else rest):
                if time.time() - began > self.arguments.limit:
                    return 'SURVIVED', 'the time for it was up', time.time() - began
                failed = self.passes(test)
                if failed and test['name'] not in self.trusted: # does it pass without the edit?
                    open(path, 'w').write(text)
                    self.make()
                    if self.passes(test):
                        print(f'the test "{test["name"]}" fails without any edit: left out', flush=True)
                        self.tests.remove(test)
                        failed = ''
                    else:
                        self.trusted.add(test['name'])
                    if not failed:
                        open(path, 'w').write(edited)
                        self.make()
                if failed:
                    return 'killed', test['name'] + failed.rstrip(), time.time() - began
            return 'SURVIVED', 'the nearest tests' if self.arguments.only_nearest else 'all tests', time.time() - began
        finally:
            open(path, 'w').write(text)


def main():
    parser = argparse.ArgumentParser(usage=__doc__, add_help=True)
    parser.add_argument('ids', nargs='*')
    parser.add_argument('--work', default=os.path.join(ROOT, 'build', 'mutants'))
    parser.add_argument('--jobs', type=int, default=1)
    parser.add_argument('--threads', type=int, default=2)
    parser.add_argument('--timeout', type=float, default=600)
    parser.add_argument('--limit', type=float, default=3600)
    parser.add_argument('--share')
    for name in ('only-nearest', 'resume', 'check'):
        parser.add_argument('--' + name, action='store_true')
    arguments = parser.parse_args()
    edits = read_edits()
    for key in arguments.ids:
        if key not in edits:
            fail(f'there is no edit {key}')
    chosen = [edits[key] for key in arguments.ids or edits]
    if arguments.share:
        words = re.fullmatch(r'(\d+)/([1-9]\d*)', arguments.share)
        if not words:
            fail(f'--share must be K/N, as 0/7, not {arguments.share}')
        share, shares = int(words[1]), int(words[2])
        chosen = chosen[share % shares::shares]
    gone = [e for e in chosen if occurrences(e, ROOT) != 1]
    for edit in gone:
        print(f'{edit["id"]:5} {edit["file"]}: the old text occurs {occurrences(edit, ROOT)} times')
    if arguments.check:
        return len(gone) > 0
    arguments.work = os.path.abspath(arguments.work)
    os.makedirs(arguments.work, exist_ok=True)
    results = os.path.join(arguments.work, 'results.txt')
    known = {}
    if os.path.exists(results) and (arguments.resume or arguments.ids):
        for line in open(results):
            key, verdict, rest = line.rstrip('\n').split('\t', 2)
            known[key] = verdict, rest
    waiting = [e for e in chosen if not (arguments.resume and e['id'] in known)]

    copies = [Copy(arguments.work, i, arguments) for i in range(arguments.jobs)]
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        def work(edit):
            copy = copies.pop()
            try:
                return edit, copy.judge(edit)
            finally:
                copies.append(copy)
        for done in concurrent.futures.as_completed([pool.submit(work, e) for e in waiting]):
            edit, (verdict, by, seconds) = done.result()
            known[edit['id']] = verdict, f'{by}\t{seconds:.0f}\t{edit["note"]}'
            print(f'{edit["id"]:5} {verdict:9} {by}, {seconds:.0f} s   ({edit["note"]})', flush=True)
            with open(results, 'w') as out:
                for key, (what, rest) in known.items():
                    out.write(f'{key}\t{what}\t{rest}\n')
    told = [known[e['id']][0] for e in chosen if e['id'] in known]
    killed, lived = told.count('killed'), told.count('SURVIVED')
    print(f'{killed} of {killed + lived} killed' + (f' ({100 * killed / (killed + lived):.0f} %)' if killed + lived else '') + f', {len(told) - killed - lived} not run')
    return any(known.get(e['id'], ('',))[0] != 'killed' and not e['note'].startswith('survives') for e in chosen)


if __name__ == '__main__':
    sys.exit(main())
