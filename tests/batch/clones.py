#!/usr/bin/env python3
"""The same bits from every build: the kernels for each kind of processor alone, by gcc and by clang.

The library's sources are compiled anew with the flags that the build under test has (from its
compile_commands.json), but for one kind of processor at a time, as the option `clones` of meson
does: for each kind by the compiler of the build, for the widest by the other.  Each is linked with
one and the same checksum.o (checksum.c) and must give the sums that the build under test gives,
whose kernels the loader has chosen; and so must the surfaces about the Earth (checksum_earth.c),
where they are built.  Where a sum differs the first ray that differs is shown.

    python3 clones.py BUILD           all of it, some minutes: tests/nightly.sh
    python3 clones.py BUILD --quick   the build against one for any processor, of a tenth of the rays;
                                      that one is compiled with little optimisation, which changes no bit
"""
import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

# What a kind asks of the processor beyond those before it (System V ABI, x86-64 psABI 1.0, 3.1.1).
KINDS = {
    'none': set(),
    'x86-64-v3': set('cx16 lahf_lm popcnt pni sse4_1 sse4_2 ssse3 avx avx2 bmi1 bmi2 f16c fma abm movbe xsave'.split()),
    'x86-64-v4': set('avx512f avx512bw avx512cd avx512dq avx512vl'.split()),
}


def processor():
    """Its features, or None where it is no x86-64 or does not tell."""
    about = pathlib.Path('/proc/cpuinfo')
    if os.uname().machine != 'x86_64' or not about.exists():
        return None
    flags = re.search(r'^flags\s*:(.*)$', about.read_text(errors='replace'), re.MULTILINE)
    return set(flags[1].split()) if flags else None


def run(*command, **more):
    done = subprocess.run(command, text=True, capture_output=True, **more)
    if done.returncode:
        sys.exit(f'{shlex.join(map(str, command))}\n{done.stdout}{done.stderr}exit status {done.returncode}')
    return done.stdout


def family(compiler):
    said = run(*compiler, '--version')
    return 'clang' if 'clang' in said else 'gcc' if 'Free Software Foundation' in said else 'other'


def flags_of(entry):
    """(compiler, flags) of a compile command: what decides the answers, without warnings, files and tools."""
    words, compiler, flags = shlex.split(entry['command']), [], []
    while words and not words[0].startswith('-'):
        compiler.append(words.pop(0))
    while words:
        word = words.pop(0)
        if word in ('-MQ', '-MF', '-MT', '-o', '-c'):
            words.pop(0)
        elif not word.startswith(('-W', '-MD', '-flto', '-fsanitize', '-fno-sanitize', '--coverage', '-march', '-mtune',
                                  '-DSGT_HAVE_CLONES', '-g', '-fcolor-', '-fdiagnostics-')):
            flags.append(word)
    return compiler, flags


def plus_plus(compiler):
    """The C++ compiler that belongs to a C compiler: g++ to gcc, clang++-14 to clang-14."""
    return compiler[:-1] + [re.sub(r'(gcc|clang|cc)(?=(-[\d.]+)?$)', lambda name: {'gcc': 'g++', 'clang': 'clang++', 'cc': 'c++'}[name[1]], compiler[-1])]


def compile_to(entry, compiler, more, target):
    run(*compiler, *flags_of(entry)[1], *more, '-w', '-c', entry['file'], '-o', str(target), cwd=entry['directory'])
    return str(target)


def first_difference(part, ours, theirs):
    """The lines that tell of the first ray whose answers differ."""
    about = []
    a, b = (iter(run(str(program), part).splitlines()) for program in (ours, theirs))
    for line, other in zip(a, b):
        if line != other:
            return '\n'.join(about + [f'  {line}', f'  {other}', f'  {next(a, "")}', f'  {next(b, "")}'])
        if line.startswith(' ') and not line.lstrip().startswith('ray'):
            about = (about + [line])[-2:]
    return 'no ray differs: one listing is longer'


def once(entries):
    """The sources of a library; those compiled twice, for its static and its shared form, once."""
    if len({entry['file'] for entry in entries}) < len(entries):
        entries = [entry for entry in entries if '.so' in entry['output']]
    return entries


def main(build, *words):
    quick = '--quick' in words
    if quick:
        os.environ['SAGITTA_TEST_SCALE'] = str(0.1 * float(os.environ.get('SAGITTA_TEST_SCALE', 1)))
    commands = json.loads(pathlib.Path(build, 'compile_commands.json').read_text())
    library = once([c for c in commands if '/libsagitta.' in c['output'] and c['file'].endswith('.c')])
    earth = once([c for c in commands if '/libsagitta_geo.' in c['output']])
    if len(library) < 10:
        sys.exit(f'{len(library)} sources of the library found')
    programs = {c['output'].split('/')[-2][:-2]: c for c in commands if '/batch/checksum' in c['file']}

    own = flags_of(library[0])[0]
    compilers = {family(own): own}
    for name in () if quick else ('gcc', 'clang'):
        if name in compilers:
            continue
        if shutil.which(name) and (not earth or shutil.which(plus_plus([name])[-1])):
            compilers[name] = [name]
        else:
            print(f'{name}: skipped, it is not installed')
    features, kinds, needed = processor(), [], set()
    for kind, more in KINDS.items():
        needed |= more
        if quick and kind != 'none':
            continue
        if kind != 'none' and (features is None or not needed <= features):
            print(f'{kind}: skipped, this processor is not of its kind')
        else:
            kinds.append(kind)

    here = pathlib.Path(build, 'tests', 'batch')
    geographic = re.search(r'=> (\S*libGeographic\S*)', run('ldd', str(here / 'checksum_earth')))[1] if earth else None
    wanted = {name: run(str(here / name)) for name in programs}
    print('the build under test:\n' + ''.join(wanted.values()), end='')
    faults, shown = 0, set()
    with tempfile.TemporaryDirectory() as name, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        there = pathlib.Path(name)
        main_objects = {name: compile_to(entry, own, [], there / f'{name}.o') for name, entry in programs.items()}
        waiting = {}
        for by, compiler in compilers.items():
            for kind in kinds if compiler is own else kinds[-1:]:
                folder = there / f'{by}-{kind}'
                folder.mkdir()
                more = (['-O1'] if quick else []) + ([] if kind == 'none' else [f'-march={kind}', '-mtune=generic'])
                waiting[by, kind] = [pool.submit(compile_to, entry, plus_plus(compiler) if entry in earth else compiler, more, folder / f'{i}.o')
                                     for i, entry in enumerate(library + earth)]
        for (by, kind), objects in waiting.items():
            said = {}
            for name in programs:
                objects_of = [o.result() for o in (objects if 'earth' in name else objects[:len(library)])]
                more = [geographic, '-lstdc++'] if 'earth' in name else []
                run(*compilers[by], main_objects[name], *objects_of, '-o', str(there / f'{name}-{by}-{kind}'), *more, '-lm')
                said[name] = run(str(there / f'{name}-{by}-{kind}'))
            print(f'by {by}, {kind}: {"the same" if said == wanted else "OTHERS"}')
            faults += said != wanted
            for name in programs:
                for line, its in zip(wanted[name].splitlines(), said[name].splitlines()):
                    part = line[:16].strip()
                    if line != its:
                        first = first_difference(part, here / name, there / f'{name}-{by}-{kind}') if its not in shown else ''
                        print(f'{its}   of {part}' + (f', first:\n{first}' if first else ''))
                        shown.add(its)
    print(f'{len(waiting)} builds, {faults} with other answers')
    return 1 if faults or not waiting else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
