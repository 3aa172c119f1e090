#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The library on other systems: the same bits, and how fast.

    python3 tests/platforms/run.py [NAME ...]

builds the library for each system (all of them, or those named) in build/platforms/NAME, compares the sums of
batch/checksum.c with batch/checksum.txt, measures batches, and prints a table.

    --quick     compiled with little optimisation (but by clang, whose optimiser is asked), which changes no
                bit; sums of a tenth of the rays, and no times
    --oracles   and the tests in plain C or C++ that need no other library (the batches, the oracles in 113
                bits, the catalogue, the extremes), at a tenth of their scale, s390x at a fiftieth;
                tests/nightly.sh
    --write     puts the table into docs/platforms.md
    --known     ends with status 0 where sums differ: they are in the table

What is not installed is skipped, and the line says what.  Under qemu it is always a tenth of the rays, and
nothing is timed.  Times are medians of runs of platforms/speed.c that take turns, all systems in each
round; a ratio is the median of the ratios to `gcc` of the same round.
"""
import concurrent.futures
import os
import pathlib
import shlex
import shutil
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
TREE = HERE.parents[1]
sys.path.insert(0, str(HERE.parent / 'batch'))
sys.dont_write_bytecode = True
import sums  # noqa: E402

ROUNDS = 9
BEGIN, END = '<!-- tests/platforms/run.py --write -->', '<!-- end -->'
WINE = '/usr/lib/wine'  # where Debian has wine64, which is not in the PATH

GCC_MINGW = 'x86_64-w64-mingw32-gcc-posix'
# Name: (system, compiler, machine file or None, more for meson, how it runs: '', 'wine' or 'qemu').
SYSTEMS = {
    'gcc': ('Linux, glibc', 'gcc', None, [], ''),
    'clang': ('Linux, glibc', 'clang', None, [], ''),
    'musl': ('Linux, musl', 'musl-gcc', 'musl.ini', [], ''),
    'musl-static': ('Linux, musl, static', 'musl-gcc', 'musl-static.ini', [], ''),
    'mingw-gcc': ('Windows, DLL', GCC_MINGW, 'mingw-gcc.ini', [], 'wine'),
    'mingw-gcc-static': ('Windows, static', GCC_MINGW, 'mingw-gcc.ini', ['-Ddefault_library=static'], 'wine'),
    'mingw-clang': ('Windows, DLL', 'clang', 'mingw-clang.ini', [], 'wine'),
    'aarch64': ('Linux, aarch64', 'aarch64-linux-gnu-gcc', 'aarch64.ini', [], 'qemu'),
    's390x': ('Linux, s390x (big-endian)', 's390x-linux-gnu-gcc', 's390x.ini', [], 'qemu'),
}
ORACLES = ['batch', 'oracle', 'catalogue', 'extremes', 'sensitivity']
# SAGITTA_TEST_SCALE of the oracles.  s390x works out 113 bits by instructions that qemu imitates one by one.
SCALES = {'s390x': '0.02'}


def environment():
    """wine64 in the PATH, in a folder of its own and quiet; no options of a caller's build."""
    of_a_build = ('CC', 'CXX', 'CFLAGS', 'CXXFLAGS', 'LDFLAGS')
    words = {name: value for name, value in os.environ.items() if name not in of_a_build}
    words['PATH'] = words.get('PATH', '') + os.pathsep + WINE
    words.setdefault('WINEPREFIX', str(TREE / 'build' / 'platforms' / 'wine'))
    words.setdefault('WINEDEBUG', '-all')
    return words


class Failed(Exception):
    pass


class Platform:
    def __init__(self, name, quick):
        self.name, (self.system, self.compiler, self.machine, self.more, self.by) = name, SYSTEMS[name]
        self.folder = TREE / 'build' / 'platforms' / (name + ('-quick' if quick else ''))
        if quick and name != 'clang':  # half the time to compile, and the same bits
            self.more = self.more + ['-Doptimization=1']
        self.words = environment()
        self.note = self.ran = self.bits = ''
        self.times, self.differ, self.wrong = [], [], False

    def missing(self):
        """What it needs and is not there, or ''."""
        needed = [self.compiler] + {'': [], 'wine': ['wine64'], 'qemu': [f'qemu-{self.name}']}[self.by]
        if self.name == 'mingw-clang':
            needed.append(GCC_MINGW)  # whose headers and libraries it takes
        return ', '.join(word for word in needed if not shutil.which(word, path=self.words['PATH']))

    def run(self, *command, **more):
        done = subprocess.run(command, text=True, capture_output=True, env={**self.words, **more}, cwd=TREE)
        if done.returncode:
            raise Failed(f'{shlex.join(map(str, command))}\n{done.stdout[-4000:]}{done.stderr[-4000:]}')
        return done.stdout

    def overlay(self, oracles):
        """A machine file more: ccache where it is, and where clang finds the libgcc of mingw-w64."""
        cached = ['ccache'] if shutil.which('ccache') else []
        target = ['--target=x86_64-w64-mingw32'] if self.name == 'mingw-clang' else []
        lines = ['[binaries]', f'c = {cached + [self.compiler] + target}']
        if not oracles or self.name in ('musl', 'musl-static', 'mingw-clang'):
            lines.append("cpp = 'false'")
        elif self.name == 'clang':
            lines.append(f"cpp = {cached + ['clang++']}")
        if self.name == 'mingw-clang':
            libgcc = self.run(GCC_MINGW, '-print-libgcc-file-name').strip()
            lines += ['[built-in options]', f"c_link_args = ['-L{pathlib.Path(libgcc).parent}']"]
        return '\n'.join(lines) + '\n'

    def build(self, oracles):
        self.folder.parent.mkdir(parents=True, exist_ok=True)
        kind = '--cross-file' if self.by else '--native-file'
        overlay, text = pathlib.Path(f'{self.folder}.ini'), self.overlay(oracles)
        same = overlay.exists() and overlay.read_text() == text
        if not same or not (self.folder / 'build.ninja').exists():
            overlay.write_text(text)
            shutil.rmtree(self.folder, ignore_errors=True)
            files = ([f'{kind}={HERE / self.machine}'] if self.machine else []) + [f'{kind}={overlay}']
            self.run('meson', 'setup', self.folder, *files, '-Dexamples=false', '-Dauto_features=disabled',
                     *self.more)
        targets = [f'tests/{name}' + ('.exe' if self.by == 'wine' else '')
                   for name in ('batch/checksum', 'platforms/speed')]
        self.run('ninja', '-C', self.folder, *targets, *(['all'] if oracles else []))

    def program(self, path):
        """The command that runs a program of the build."""
        program = str(self.folder / 'tests' / path)
        if self.by == 'wine':
            self.words['WINEPATH'] = 'Z:' + str(self.folder / 'src')
            return ['wine64', program + '.exe']
        if self.by == 'qemu':
            return [f'qemu-{self.name}', '-L', f'/usr/{self.name}-linux-gnu', program]
        return [program]

    def compare(self, quick):
        scale = 'tenth' if quick or self.by == 'qemu' else 'full'
        said = sums.asked(self.program('batch/checksum'), scale, self.words)
        self.differ = sums.others(said, scale)
        self.bits = f'differ in {len(self.differ)} of {len(said)}' if self.differ else 'the same'
        self.ran = f'checksums, {"all" if scale == "full" else "a tenth"}'

    def test(self):
        suites = [word for suite in ORACLES for word in ('--suite', suite)]
        command = ['meson', 'test', '-C', self.folder, '--no-rebuild', '--print-errorlogs']
        command += ['--timeout-multiplier', '20']
        done = subprocess.run(command + suites, text=True, capture_output=True, cwd=TREE,
                              env={**self.words, 'SAGITTA_TEST_SCALE': SCALES.get(self.name, '0.1')})
        count = {line.split(':')[0]: int(line.split()[-1]) for line in done.stdout.splitlines()
                 if line.startswith(('Ok:', 'Fail:', 'Timeout:'))}
        failed = count.get('Fail', 0) + count.get('Timeout', 0)
        self.ran += f', {count.get("Ok", 0)} tests' + (f' ({failed} FAILED)' if failed else '')
        self.wrong = done.returncode != 0
        if self.wrong:
            print(f'{self.name}: tests\n{done.stdout[-8000:]}{done.stderr[-2000:]}')

    def measure(self):
        said = self.run(*self.program('platforms/speed'))
        self.times.append({family: float(ns) for family, ns in (line.split() for line in said.splitlines())})


def guarded(platform, step, *words):
    if platform.note:
        return
    try:
        step(*words)
    except (Failed, RuntimeError, OSError, ValueError) as fault:
        platform.note = f'FAILED: {step.__name__}'
        print(f'{platform.name}: {platform.note}\n{fault}', flush=True)


def table(platforms):
    timed = [p for p in platforms if p.times]
    families = list(timed[0].times[0]) if timed else []
    reference = next((p for p in timed if p.name == 'gcc'), None)
    lines = ['| name | system | compiler | ran | bits |' + ''.join(f' {family} |' for family in families),
             '|---|---|---|---|---|' + '---|' * len(families)]
    for p in platforms:
        cells = []
        for family in families:
            if not p.times or p.note:
                cells.append('-')
                continue
            cell = f'{statistics.median(one[family] for one in p.times):.3g}'
            if reference and p is not reference:
                pairs = zip(p.times, reference.times)
                ratio = statistics.median(one[family] / its[family] for one, its in pairs)
                cell += f' ({ratio:.2f})'
            cells.append(cell)
        how = {'': '', 'wine': ', wine', 'qemu': ', qemu'}[p.by]
        ran, bits = (p.note, '-') if p.note else (p.ran + how, p.bits)
        lines.append('| ' + ' | '.join([p.name, p.system, p.compiler, ran, bits] + cells) + ' |')
    if families:
        lines += ['', 'Times: nanoseconds a ray, in brackets the ratio to gcc.']
    return '\n'.join(lines)


def main(*words):
    options = {word for word in words if word.startswith('--')}
    names = [word for word in words if word not in options] or list(SYSTEMS)
    unknown = [word for word in names if word not in SYSTEMS] + sorted(
        options - {'--quick', '--oracles', '--write', '--known'})
    if unknown:
        sys.exit(f'{", ".join(unknown)}: unknown.  Systems: {", ".join(SYSTEMS)}\n\n{__doc__}')
    quick = '--quick' in options
    timed_names = names if quick or 'gcc' in names else ['gcc'] + names
    platforms = [Platform(name, quick) for name in timed_names]

    def tried(p):
        if p.missing():
            p.note = f'skipped: {p.missing()} not installed'
        guarded(p, p.build, '--oracles' in options)
        guarded(p, p.compare, quick)
        if '--oracles' in options:
            guarded(p, p.test)
        return p
    # Two at a time: one is configured, or answers by one process, while the other compiles.
    with concurrent.futures.ThreadPoolExecutor(2) as two:
        for p in two.map(tried, platforms):
            print(f'{p.name}: {p.note or p.bits}' + (f': {", ".join(p.differ)}' if p.differ else ''), flush=True)
    for _ in range(0 if quick else ROUNDS):
        for p in platforms:
            if p.by != 'qemu':
                guarded(p, p.measure)
    text = table(platforms)
    print(text)
    if '--write' in options:
        page = TREE / 'docs' / 'platforms.md'
        before, rest = page.read_text().split(BEGIN)
        page.write_text(f'{before}{BEGIN}\n{text}\n{END}{rest.split(END, 1)[1]}')
    failed = any(p.note.startswith('FAILED') or p.wrong for p in platforms)
    return 1 if failed or any(p.differ for p in platforms) and '--known' not in options else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
