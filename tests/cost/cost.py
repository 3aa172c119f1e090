#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the library costs: the instructions of fixed cases (cases.c), counted by callgrind.

    python3 tests/cost/cost.py BUILD             compares with cost.csv: a fault where a case differs by more than 2 %
    python3 tests/cost/cost.py BUILD --write     writes cost.csv anew
    python3 tests/cost/cost.py BUILD --all       prints every case, and how it differs
    python3 tests/cost/cost.py BUILD --where CASE   prints the functions that the case spends most in

BUILD is a folder of meson (ninja -C BUILD tests/cost/cost_cases).  Whoever makes a case dearer or cheaper by more
than 2 % writes the table anew and says why in the commit message.  A case with a t_tol that is dearer than the one without,
by more than 1 %, is a fault whatever the table says; so is a batch of 1 that is dearer than the ray by itself and its arrays.

Counted is what runs between the call of `measured` and its return, of the library, the program and libm; not of libc
and the dynamic linker, which differ from machine to machine.  An instruction of a vector counts as one.  The counts are
exact and the same in each run, but belong to one compiler and its flags: the first line of the table names them, and
where the build has others nothing is compared.  Valgrind has no AVX-512, so what runs is the library for x86-64-v3.
The dearest kernels of that for x86-64-v4 (KERNELS) are counted by llvm-mca, without being run: the
micro-operations of a pass through each innermost loop with 512-bit registers, summed, on a Skylake server.
"""
import collections
import csv
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

TABLE = pathlib.Path(__file__).with_name('cost.csv')
LIMIT = 0.02
ARRAYS = 180  # instructions that read a ray from arrays and write its hit to others
SKIPPED = 77
NOT_COUNTED = re.compile(r'/(libc|ld-linux)[-.\w]*$')
PROCESSOR = 'skylake-avx512'
KERNELS = re.compile(r'((conic|asphere)_lanes|newton_step|march_step)\w*|(look_near|meet|advance|floats)_julia|(launch|return)_all')


def run(*command, **more):
    return subprocess.run(command, text=True, check=True, capture_output=True, **more).stdout


# ------------------------------------------------------------------- callgrind


def functions_of(profile):
    """{function: instructions of its own} of one file of callgrind's, without those of libc."""
    names, counts, here, counted, called = {}, collections.Counter(), '', True, False
    for line in profile.splitlines():
        name = re.match(r'(c?)(ob|fn)=\((\d+)\)(?: (.*))?$', line)
        if name:
            callee, kind, number, text = name.groups()
            if text:
                names[kind, number] = text
            if not callee:
                if kind == 'ob':
                    counted = not NOT_COUNTED.search(names[kind, number])
                else:
                    here = names[kind, number]
        elif line.startswith('calls='):
            called = True  # the next line is what the callee cost: counted there
        elif line[:1].isdigit():
            if not called and counted:
                counts[here] += sum(map(int, line.split()[1:]))  # the place, and a count that is left away where it is 0
            called = False
    return counts


def cases_of(build):
    """[(case, rays, {function: instructions})], by running all cases under callgrind."""
    with tempfile.TemporaryDirectory() as folder:
        said = run('valgrind', '--quiet', '--tool=callgrind', f'--callgrind-out-file={folder}/out', '--toggle-collect=measured',
                   '--dump-after=measured', '--compress-pos=no', str(build / 'tests/cost/cost_cases'))
        cases = [line.rsplit(',', 1) for line in said.splitlines()]
        # Where a dump has the number of its part behind its name.
        profiles = sorted(pathlib.Path(folder).glob('out.*'), key=lambda path: int(path.name.split('.')[-1]))
        if len(profiles) != len(cases):
            sys.exit(f'{len(profiles)} profiles of {len(cases)} cases')
        return [(name, int(rays), functions_of(path.read_text())) for (name, rays), path in zip(cases, profiles)]


# -------------------------------------------------------------------- llvm-mca


def loops(lines):
    """The innermost loops of a function's listing: runs of instructions closed by a jump back."""
    code = [match.groups() for match in (re.match(r'\s*([0-9a-f]+):\s+(\S.*)', line) for line in lines) if match]
    places, found = {place: i for i, (place, _) in enumerate(code)}, []
    for i, (_, text) in enumerate(code):
        jump = re.match(r'j\w+\s+([0-9a-f]+)\b', text)
        if jump and places.get(jump[1], i) < i:
            found.append((places[jump[1]], i))
    inner = [a for a in found if not any(b != a and a[0] <= b[0] and b[1] <= a[1] for b in found)]
    return [[text for _, text in code[first:last]] for first, last in inner]


def wide_kernels(build):
    """{function: micro-operations of its loops} of the kernels for x86-64-v4."""
    listing, name = run('objdump', '-d', '--no-show-raw-insn', *map(str, sorted(build.glob('src/libsagitta_v4*.a')))), None
    lines = collections.defaultdict(list)
    for line in listing.splitlines():
        start = re.match(r'[0-9a-f]+ <([A-Za-z_]\w*)[\w.]*>:$', line)
        if start:
            name = KERNELS.fullmatch(start[1]) and start[1]
        elif name:
            lines[name].append(line)
    counts = {}
    for name, listed in sorted(lines.items()):
        total = 0
        for loop in loops(listed):
            if not any('zmm' in text for text in loop):
                continue
            # Of jumps and calls only the instruction matters; objdump's <name> is no operand for the assembler.
            text = '\n'.join(re.sub(r'\s*(#.*|<.*>)$', '', one) for one in loop if not re.match(r'j|call', one))
            said = run('llvm-mca', f'-mcpu={PROCESSOR}', '-mtriple=x86_64', '-iterations=100', '-', input=text)
            total += int(re.search(r'^Total uOps:\s+(\d+)', said, re.M)[1]) / 100
        if total:
            counts[name] = total
    return counts


def mca_version():
    if not shutil.which('llvm-mca') or not shutil.which('objdump'):
        return None
    return 'llvm-mca ' + re.search(r'LLVM version (\S+)', run('llvm-mca', '--version'))[1]


# ------------------------------------------------------------------- the table


def read_table():
    lines = TABLE.read_text().splitlines()
    heads = [line[2:] for line in lines if line.startswith('#')]
    rows = csv.reader(line for line in lines if not line.startswith('#'))
    next(rows)
    return heads, {case: float(cost) for case, cost in rows}


def compare(table, costs, show_all):
    """Prints what differs; the number of faults."""
    faults = 0
    for case in dict.fromkeys([*table, *costs]):
        was, now = table.get(case), costs.get(case)
        if was is None or now is None:
            print(f'{case}: ' + ('not in the table' if was is None else 'in the table, and no such case'))
            faults += 1
            continue
        off = now / was - 1
        if abs(off) > LIMIT or show_all:
            print(f'{case}: {now:.6g}, in the table {was:.6g}: {100 * off:+.2f} %' + (' FAULT' if abs(off) > LIMIT else ''))
        faults += abs(off) > LIMIT
    return faults


def dearer_with_tolerance(costs):
    """Prints the cases with a t_tol that cost more than without, by more than 1 %; their number.  (Of a user's own
    surface the rounding at the last step is asked for once more.)"""
    faults = 0
    for case, cost in costs.items():
        strict = costs.get(case.partition(' with t_tol')[0])
        if strict is not None and cost > 1.01 * strict:
            print(f'{case}: {cost:.6g}, without {strict:.6g}')
            faults += 1
    return faults


def dearer_alone(costs):
    """Prints the cases where a batch of 1 costs more than a tenth more than the ray by itself, and more than what
    reads and writes the arrays; their number."""
    faults = 0
    for case, cost in costs.items():
        one = costs.get(case.replace(': a batch of 1', ': one ray')) if case.endswith(': a batch of 1') else None
        if one is not None and cost > max(1.1 * one, one + ARRAYS):
            print(f'{case}: {cost:.6g}, one ray {one:.6g}')
            faults += 1
    return faults


def main(build, *words):
    build = pathlib.Path(build)
    if not shutil.which('valgrind'):
        print('skipped: there is no valgrind')
        return SKIPPED
    # As valgrind shows the processor to the program.
    head = run('valgrind', '--quiet', '--tool=none', str(build / 'tests/cost/cost_cases'), '--build').strip()
    mca = mca_version()
    heads, table = read_table() if TABLE.exists() else ([], {})
    same, same_mca = head in heads, mca in heads
    if '--write' not in words and not same and '--where' not in words:
        print(f'skipped: the table is of\n    {heads[0] if heads else "nothing"}\nand this build is\n    {head}')
        return SKIPPED
    counted = cases_of(build)
    if '--where' in words:
        wanted = words[words.index('--where') + 1]
        for case, rays, functions in counted:
            if case == wanted:
                for function, count in functions.most_common(25):
                    print(f'{count / rays:12.1f}  {function}')
                return 0
        sys.exit(f'no case {wanted}')
    costs = {case: sum(functions.values()) / rays for case, rays, functions in counted}
    if 'kernels for x86-64-v3' in head and not any(f.endswith('_v3') for _, _, functions in counted for f in functions):
        sys.exit('nothing for x86-64-v3 has run')
    if mca and (same_mca or '--write' in words):
        costs.update((f'{name} of x86-64-v4: micro-operations', count) for name, count in wide_kernels(build).items())
    elif not mca or not same_mca:
        print(f'the kernels for x86-64-v4 are not counted: {mca or "there is no llvm-mca"}')
        table = {case: cost for case, cost in table.items() if 'x86-64-v4' not in case}
    if '--write' in words:
        with TABLE.open('w') as file:
            file.write(f'# {head}\n' + (f'# {mca}\n' if mca else '') + 'case,instructions\n')
            file.writelines(f'{case},{cost:.6g}\n' for case, cost in costs.items())
        print(f'{len(costs)} cases written')
        return 0
    faults = compare(table, costs, '--all' in words) + dearer_with_tolerance(costs) + dearer_alone(costs)
    print(f'{len(costs)} cases, {faults} faults (more than {LIMIT:.0%} from {TABLE.name})')
    return 1 if faults else 0


if __name__ == '__main__':
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
