#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The examples in other languages, from an installed prefix: they say what the command says, to the last bit.

    python3 languages.py rust|fortran|octave BUILD C_COMPILER     skipped (77) if its compiler is not there

The folder examples/LANGUAGE is copied, and the command in the head of its main file is run there.  The nine
rays of the example are then given to the command `sagitta`, and every number has to be the same double.

Declarations that a language needs besides the headers are compared with C: a program in that language and
one in C print the size of each struct and the offset and size of each member.  Functions are declared once
more in C, from the other language's types, or called with them.  Then faults are planted in the
declarations, and each has to be found.
"""
import pathlib
import re
import shutil
import sys
import tempfile

sys.dont_write_bytecode = True
import prefix  # noqa: E402

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / 'examples'
MAIN = {'rust': 'main.rs', 'fortran': 'main.f90', 'octave': 'sagitta_batch.c'}
NEEDED = {'rust': ['rustc'], 'fortran': ['gfortran'], 'octave': ['mkoctfile', 'octave-cli']}
AFTER = {'octave': 'octave-cli --no-init-file nine_rays.m'}
LENS = """
surfaces:
  - {type: sphere, radius: 51.68, thickness: 4, index: 1.5168, semi_diameter: 8}
  - {type: conic, radius: -700, conic: -0.5, thickness: 93.5, index: 1, semi_diameter: 8}
  - {type: plane, semi_diameter: 12}
"""
CODES = {'hit': 1, 'miss': 0, 'passed': 1, 'clipped': 2}


# ------------------------------------------------------------------ against the command

def by_command(there, folder):
    """The rows that the example has to print, as numbers."""
    rows = ['ox,oy,oz,dx,dy,dz'] + [f'{(i - 4) / 2},{i / 8},-10,{i / 256},{-i / 128},1' for i in range(9)]
    (folder / 'rays.csv').write_text('\n'.join(rows) + '\n')
    (folder / 'lens.yaml').write_text(LENS)

    def table(*arguments):
        said = prefix.run(there.command, *arguments, '--rays', 'rays.csv', '--format', 'csv', '--hex',
                          cwd=folder, env=there.environment).splitlines()
        head = said[0].split(',')
        return [dict(zip(head, row.split(','))) for row in said[1:]]

    met = table('intersect', '--surface', '{type: conic, radius: 51.68, conic: -0.5, semi_diameter: 8}')
    ended = table('trace', 'lens.yaml', '--last', '--frame', 'global')

    def numbers(row, code, columns):
        return [CODES[row[code]]] + [float.fromhex(row[column]) for column in columns.split()]

    return ([numbers(row, 'status', 't t_err x y z') for row in met],
            [numbers(row, 'fate', 'x y z l m n opl') for row in ended])


def compared(language, said, there, folder):
    met, ended = by_command(there, folder)
    lines = [line.split() for line in said.splitlines()]
    wanted = [['conic', str(sum(r[0] == 1 for r in met))], *met,
              ['lens', str(sum(r[0] == 1 for r in ended))], *ended]
    faults = abs(len(lines) - len(wanted))
    for line, row in zip(lines, wanted):
        numbers = line if isinstance(row[0], str) else [float(word) for word in line]
        if numbers != row:
            faults += 1
            print(f'{language}: {line}\nthe command: {row}')
    if len({len(met), len(ended), 9}) != 1 or sum(r[0] == 1 for r in ended) < 5:
        sys.exit('the example shows nothing')
    print(f'{language}: {len(wanted)} lines, {faults} differ from the command')
    return faults


# ------------------------------------------------------------------------ declarations

def layout_in_c(structs, compiler, there, folder):
    """Lines `struct.member offset size`, and `struct size`."""
    prints = ''
    for name, members in structs.items():
        prints += f'printf("{name} %zu\\n", sizeof({name}));\n'
        for member in members:
            of = 'self' if member == 'self_' else member
            prints += (f'printf("{name}.{member} %zu %zu\\n", offsetof({name}, {of}), '
                       f'sizeof((({name} *)0)->{of}));\n')
    (folder / 'layout.c').write_text('#include <sagitta/surfaces.h>\n#include <sagitta/system.h>\n'
                                     f'#include <stdio.h>\nint main(void)\n{{\n{prints}return 0;\n}}\n')
    prefix.run(*compiler.split(), '-std=c11', 'layout.c', '-I', there.path / 'include', '-o', 'layout_c',
               cwd=folder)
    return prefix.run(folder / 'layout_c').splitlines()


def compiles(text, compiler, there, folder):
    """What the C compiler says against it."""
    (folder / 'functions.c').write_text('#include <sagitta/surfaces.h>\n#include <sagitta/system.h>\n' + text)
    try:
        prefix.run(*compiler.split(), '-std=c11', '-Wall', '-Wconversion', '-Werror', '-c', 'functions.c',
                   '-I', there.path / 'include', '-o', 'functions.o', cwd=folder)
    except SystemExit as bad:
        return [str(bad)]
    return []


def rust_type(text):
    """A type of Rust as C has it, with % in place of the name."""
    text = text.strip()
    plain = {'f64': 'double', 'usize': 'size_t', 'c_int': 'int', 'c_schar': 'signed char', 'c_char': 'char',
             'c_void': 'void', 'c_ulonglong': 'unsigned long long'}
    for rust, c in (('*const ', 'const '), ('*mut ', '')):
        if text.startswith(rust):
            return c + rust_type(text[len(rust):]).replace('%', '*%')
    return plain.get(text, text) + ' %'


def rust_faults(text, compiler, there, folder):
    (folder / 'sagitta.rs').write_text(text)
    structs = {name: re.findall(r'pub (\w+):', body)
               for name, body in re.findall(r'pub struct (\w+) \{\n(.*?)^\}', text, re.MULTILINE | re.DOTALL)}
    structs = {name: members for name, members in structs.items() if members}  # others are only pointed to
    shown = ''
    for name, members in structs.items():
        shown += f'println!("{name} {{}}", std::mem::size_of::<sagitta::{name}>());\n'
        shown += (f'let v: sagitta::{name} = unsafe {{ std::mem::zeroed() }};\n'
                  'let at = &v as *const _ as usize;\n')
        for m in members:
            shown += (f'println!("{name}.{m} {{}} {{}}", &v.{m} as *const _ as usize - at, '
                      f'std::mem::size_of_val(&v.{m}));\n')
    (folder / 'layout.rs').write_text(f'#[allow(dead_code)]\nmod sagitta;\nfn main() {{\n{shown}}}\n')
    prefix.run('rustc', 'layout.rs', '-o', 'layout', cwd=folder, env=there.environment)
    there_said = prefix.run(folder / 'layout').splitlines()
    c = ''
    for name, value in re.findall(r'pub const (\w+): c_int = (-?\d+);', text):
        c += f'_Static_assert({name} == {value}, "{name}");\n'
    functions = re.findall(r'pub fn (\w+)\((.*?)\)(?: -> ([^;]+))?;', text, re.DOTALL)
    for name, parameters, result in functions:
        types = [rust_type(p.split(':')[1]).replace('%', '') for p in parameters.split(',') if ':' in p]
        # Asks the compiler: two declarations of one function have to agree.
        c += rust_type(result or 'c_void').replace('%', f'{name}({", ".join(types) or "void"})') + ';\n'
    if len(structs) < 5 or len(functions) < 3:
        sys.exit('nothing to compare')
    said = layout_in_c(structs, compiler, there, folder)
    return ([f'{a}, in C {b}' for a, b in zip(there_said, said) if a != b] +
            compiles(c, compiler, there, folder))


def fortran_faults(text, compiler, there, folder):
    (folder / 'sagitta.f90').write_text(text)
    structs = {}
    for name, body in re.findall(r'type, bind\(C\) :: (\w+)\n(.*?)end type', text, re.DOTALL):
        structs[name] = [re.split(r'[ (=]', m.strip())[0] for line in body.splitlines() if '::' in line
                         for m in line.split('::')[1].split(',')]
    shown = declared = ''
    for name, members in structs.items():
        declared += f'type({name}), target :: v_{name}\n'
        shown += f"print '(a, 1x, i0)', '{name}', c_sizeof(v_{name})\n"
        for m in members:
            shown += (f"print '(a, 2(1x, i0))', '{name}.{m}', &\n"
                      f'transfer(c_loc(v_{name}%{m}), 0_c_intptr_t) - &\n'
                      f'transfer(c_loc(v_{name}), 0_c_intptr_t), &\n'
                      f'c_sizeof(v_{name}%{m})\n')
    (folder / 'layout.f90').write_text('program layout\nuse sagitta\nimplicit none\n'
                                       f'{declared}{shown}end program\n')
    prefix.run('gfortran', 'sagitta.f90', 'layout.f90', '-o', 'layout', '-L', there.libraries, '-lsagitta',
               cwd=folder, env=there.environment)
    there_said = prefix.run(folder / 'layout', env=there.environment).splitlines()
    plain = {'integer(c_size_t)': 'size_t', 'real(c_double)': 'double', 'type(c_ptr)': 'void *'}
    functions = re.findall(r'function (\w+)\((.*?)\) bind\(C\) result\((\w+)\)\n(.*?)end function', text,
                           re.DOTALL)
    c = ''
    for name, arguments, result, body in functions:
        types = {}
        for line in body.splitlines():
            if '::' in line:
                of, names = line.split('::')
                kind = re.match(r'\s*(\w+\(\w+\))', of)[1]
                c_type = plain.get(kind) or re.fullmatch(r'type\((\w+)\)', kind)[1]
                for variable in (v.strip().split('(')[0] for v in names.split(',')):
                    types[variable] = c_type + ('' if 'value' in of or variable == result else ' *')
        listed = [a.strip() for a in arguments.split(',')]
        # Called with these types: structures fit exactly or not at all, and numbers must not be converted.
        typed = ', '.join(f'{types[a]} {a}' for a in listed)
        c += (f'{types[result]} call_{name}({typed});\n{types[result]} call_{name}({typed})\n'
              f'{{\nreturn {name}({", ".join(listed)});\n}}\n')
    if len(structs) < 5 or len(functions) < 2:
        sys.exit('nothing to compare')
    said = layout_in_c(structs, compiler, there, folder)
    return ([f'{a}, in C {b}' for a, b in zip(there_said, said) if a != b] +
            compiles(c, compiler, there, folder))


# What is written over what.
PLANTED = {
    'rust': [('    pub c: f64,\n    pub k: f64,\n', '    pub k: f64,\n    pub c: f64,\n'),
             ('    pub max_evals: c_int,\n', '    pub max_evals: f64,\n'),
             ('    pub reserved_: [c_ulonglong; 6],', '    pub reserved_: [c_ulonglong; 5],'),
             ('SGT_PROVE_FIRST: c_int = 2', 'SGT_PROVE_FIRST: c_int = 1'),
             ('        n: usize,\n        rays', '        n: c_int,\n        rays'),
             ('index_before: f64,', ''),
             ('opt: *const sgt_options,', 'opt: *mut sgt_options,')],
    'fortran': [('c = 0, k = 0', 'k = 0, c = 0'),
                ('real(c_double)    :: index = 0', 'integer(c_int)    :: index = 0'),
                ('reserved_(6) = 0', 'reserved_(5) = 0'),
                ('integer(c_size_t), value :: n\n', 'real(c_double), value :: n\n'),
                ('type(sgt_traced), value       :: out', 'type(sgt_hits), value       :: out')],
}
FAULTS = {'rust': rust_faults, 'fortran': fortran_faults}
DECLARED = {'rust': 'sagitta.rs', 'fortran': 'sagitta.f90'}


def declarations(language, compiler, there, folder):
    text = (EXAMPLES / language / DECLARED[language]).read_text()
    found = FAULTS[language](text, compiler, there, folder)
    bad = len(found)
    print(*found, f'{DECLARED[language]}: {bad} faults', sep='\n')
    for was, becomes in PLANTED[language]:
        if text.count(was) < 1:
            sys.exit(f'nothing to plant a fault in: {was}')
        if not FAULTS[language](text.replace(was, becomes, 1), compiler, there, folder):
            bad += 1
            print(f'planted and not found: {becomes}')
    print(f'{len(PLANTED[language])} faults planted')
    return bad


def main(language, build, compiler):
    missing = [program for program in NEEDED[language] if not shutil.which(program)]
    if missing:
        print(f'skipped: no {", ".join(missing)}')
        return 77
    with tempfile.TemporaryDirectory() as name:
        there = prefix.Prefix(build, name)
        folder = pathlib.Path(name) / language
        shutil.copytree(EXAMPLES / language, folder)
        head = (folder / MAIN[language]).read_text()
        [command] = re.findall(r'^\W*(\w[\w-]* .*\$\(pkg-config .*)$', head, re.MULTILINE)[:1]
        said = prefix.run('sh', '-c', command, cwd=folder, env=there.environment)
        if language in AFTER:
            said = prefix.run('sh', '-c', AFTER[language], cwd=folder, env=there.environment)
        bad = compared(language, said, there, folder)
        if language in FAULTS:
            checks = pathlib.Path(name) / 'declarations'
            checks.mkdir()
            bad += declarations(language, compiler, there, checks)
    return 1 if bad else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
