#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Does a program that was compiled against the saved interface still run?  abidiff against tests/abi/*.abi.

    python3 abi.py BUILD             compares this build with the saved interface.  Skipped (77) without abidiff,
                                     or not on x86-64.
    python3 abi.py BUILD --planted   then plants breaks, each of which has to be found
    python3 abi.py BUILD --save      writes *.abi anew.  Refused if a program that exists would break and the
                                     soname is the same.
    python3 abi.py BUILD --save --unreleased   is not refused: what breaks has been in no release.

Two things are saved.

1. libsagitta*.abi: the soname of each library, and its names with their versions, as abidw reads them from
   the build itself.
2. headers.abi: what the names mean.  A C file is written that defines every public function with no content.
   It is compiled with debug information and read by abidw.  The libraries are compiled from the same headers,
   so this is true of them too, and no second build is needed.

abidiff compares what a function can reach.  Surfaces are given their parameters as `const void *`, so no
function reaches sgt_conic.  Therefore the C file has a function type_NAME for each public type, constant_NAME
for each constant, and member_STRUCT_NAME for each member of a struct that may grow.  So what is new is always
a new function, and all else that abidiff reports is a break.  Names of members and `const` count: they break
programs that are compiled anew.

ROOM.  A struct with a last member reserved_ may grow into it, and keeps its size.  So in the copy of the
headers that is compiled, what is reserved has no name (bit-fields without one), a member that takes room is a
member at the end, and a function size_STRUCT has the size.

COPIES.  A program copies exported data as long as they were when it was linked.  The tables of operations may
grow, as who reads one asks its size.  Other data must not be exported; sizes are those of the symbols.
"""
import os
import pathlib
import platform
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
INCLUDE = HERE.parents[1] / 'include'
LIBRARIES = {'libsagitta': 'src', 'libsagitta_lens': 'src/lens', 'libsagitta_geo': 'src/geo'}
CC = shlex.split(os.environ.get('CC', 'cc'))
GROWS = ['sgt_surface_ops']  # who reads it asks its first member how long it is
COPIED = re.compile(r'extern const sgt_surface_ops [\w, \n]*$')
ROOM = re.compile(r'unsigned long long reserved_\[(\d+)\];')
READ = ('abidw --no-corpus-path --no-comp-dir-path --no-show-locs --short-locs --no-elf-needed '
        '--no-parameter-names --no-write-default-sizes --drop-undefined-syms --type-id-style hash').split()
COMPARE = 'abidiff --harmless --no-corpus-path --no-show-locs'.split()


def with_room(include):
    """The structs that have room to grow."""
    text = ''.join(header.read_text() for header in sorted((include / 'sagitta').glob('*.h')))
    text = re.sub(r'/\*.*?\*/|//[^\n]*', '', text, flags=re.DOTALL)
    return [name for name, body in re.findall(r'typedef struct (\w+) \{(.*?)\n\} \1;', text, re.DOTALL)
            if ROOM.search(body)]


def had_room():
    """The structs that had room when they were saved."""
    saved = HERE / 'headers.abi'
    return re.findall(r"elf-symbol name='size_(\w+)'", saved.read_text()) if saved.exists() else []


def may_grow():
    """A struct that grew at its end, and an enumeration, whose members and constants are functions, too."""
    return '[suppress_type]\ntype_kind = enum\nname_not_regexp = ^value_of_\n' + ''.join(
        f'[suppress_type]\ntype_kind = struct\nname = {name}\nhas_data_member_inserted_at = end\n'
        for name in sorted({*GROWS, *with_room(INCLUDE), *had_room()}))


def run(*command, status=None):
    """What it prints; its status has to be 0, or is added to the list `status`."""
    words = [str(word) for word in command]
    done = subprocess.run(words, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if status is not None:
        status.append(done.returncode)
    elif done.returncode:
        sys.exit(f'{shlex.join(words)}\n{done.stdout}exit status {done.returncode}')
    return done.stdout


# ------------------------------------------------------------------------ what the headers say

def split(text):
    """The parts between commas outside of brackets."""
    depth, parts = 0, ['']
    for c in text:
        depth += (c in '([{') - (c in ')]}')
        if c == ',' and not depth:
            parts.append('')
        else:
            parts[-1] += c
    return [part for part in parts if part.strip()]


def name_of(declaration):
    """`int (*name)(int)`, `double *name[3]` -> name."""
    return (re.search(r'\(\*(\w+)\)', declaration)
            or re.search(r'(\w+)\s*(?:\[[^]]*\]\s*)*$', declaration))[1]


def statements(text):
    """The declarations at the floor of a header, one after the other."""
    text = re.sub(r'/\*.*?\*/|//[^\n]*', '', text, flags=re.DOTALL)
    text = re.sub(r'^ *#(?:[^\n]*\\\n)*[^\n]*', '', text, flags=re.MULTILINE)
    text = re.sub(r'extern "C" \{', '', text)
    depth, statement = 0, ''
    for c in text:
        depth += (c == '{') - (c == '}')
        statement += c
        # An inline function ends with its brace.
        if depth <= 0 and (c == ';' or c == '}' and not re.match(r'\s*(typedef|enum|struct)\b', statement)):
            yield statement.strip()
            depth, statement = 0, ''


def content(include, room=()):
    """The C file, and the functions and tables of it that are the libraries' own.  room: the structs that had
    a reserved_ before it lost its name."""
    headers = sorted((include / 'sagitta').glob('*.h'))
    lines = [f'#include <sagitta/{header.name}>' for header in headers]
    lines.append('#define FUNCTION(name, ...) void name(__VA_ARGS__); void name(__VA_ARGS__) {}')
    public, types = set(), 0
    for statement in (s for header in headers for s in statements(header.read_text())):
        if statement.startswith('typedef'):
            name = re.search(r'(\w+)(?:\([^()]*\))?;$', statement)[1]
            lines.append(f'FUNCTION(type_{name}, {name} *p)')
            types += 1
            if name in room:
                lines.append(f'FUNCTION(size_{name}, char (*size)[sizeof({name})])')
            if name in GROWS or name in room:
                for member in statement[statement.index('{') + 1:statement.rindex('}')].split(';'):
                    for declared in () if re.search(r'\s:\s', member) else split(member):
                        m = name_of(declared)
                        lines.append(f'FUNCTION(member_{name}_{m}, __typeof__((({name} *)0)->{m}) *p, '
                                     f'char (*at)[1 + __builtin_offsetof({name}, {m})])')
        for body in re.findall(r'\benum\b[^{;]*\{(.*?)\}', statement, re.DOTALL):
            for constant in re.findall(r'\w+', ' '.join(part.split('=')[0] for part in split(body))):
                lines.append(f'enum value_of_{constant} {{ value_{constant} = {constant} }};\n'
                             f'FUNCTION(constant_{constant}, enum value_of_{constant} e)')
        if 'SGT_API' in statement:
            declared = statement.replace('SGT_API', '').rstrip(';').strip()
            if declared.startswith('extern'):
                for name in map(name_of, split(declared)):
                    public.add(name)
                    lines.append(f'FUNCTION(table_{name}, __typeof__({name}) *p)')
            else:
                public.add(re.search(r'(\w+)\(', declared)[1])
                lines.append(declared + ' { __builtin_trap(); }')
    if types < 100 or len(public) < 80:
        sys.exit('the headers are not understood')
    return '\n'.join(lines) + '\n', public


def copied(include):
    """The exported data that a program copies, and that are no table of operations."""
    return [s for header in sorted((include / 'sagitta').glob('*.h')) for s in statements(header.read_text())
            if 'SGT_API' in s and 'extern' in s
            and not COPIED.match(re.sub(r'SGT_API *', '', s.replace('SGT_API extern', 'extern')).rstrip(';'))]


def compiled(include, folder):
    """A library of the C file, as abidiff reads it."""
    room, nameless = {*with_room(include), *had_room()}, folder / 'nameless'
    shutil.rmtree(nameless, ignore_errors=True)
    shutil.copytree(include, nameless)
    for header in (nameless / 'sagitta').glob('*.h'):
        header.write_text(ROOM.sub(lambda found: 'unsigned long long : 64; ' * int(found[1]),
                                   header.read_text()))
    (folder / 'headers.c').write_text(content(nameless, room)[0])
    run(*CC, '-std=gnu11', '-w', '-g', '-O0', '-fPIC', '-shared', '-I', nameless, folder / 'headers.c',
        '-o', folder / 'headers.so', '-Wl,-soname,headers')
    return folder / 'headers.so'


# ------------------------------------------------------------------------ the comparison

def sizes_of(library):
    """Exported data and their sizes, of a library or of what abidw has saved of one."""
    if library.suffix == '.abi':
        return {name: int(size) for name, size in
                re.findall(r"elf-symbol name='(\w+)' size='(\d+)'[^>]*type='object-type'",
                           library.read_text())}
    return {name: int(size) for size, name in
            re.findall(r'^ *\d+: \w+ +(\d+) OBJECT +GLOBAL +DEFAULT +\d+ (sgt_\w+)',
                       run('readelf', '--dyn-syms', '--wide', library), re.MULTILINE)}


def difference(saved, library, folder):
    """'' (the same), 'grown' or 'broken', and the report."""
    verdict, report = of_types(saved, library, folder)
    before, now = sizes_of(saved), sizes_of(library)
    for name in sorted(before.keys() & now.keys()):
        if before[name] != now[name]:
            report += f'{name} has {now[name]} bytes, and had {before[name]}: a program copies those\n'
            grown = name.endswith('_ops') and now[name] > before[name]
            verdict = (verdict or 'grown') if grown else 'broken'
    return verdict, report


def of_types(saved, library, folder):
    status = []
    report = run(*COMPARE, saved, library, status=status)
    if status[-1] == 0:
        return '', report
    if status[-1] & 3:
        sys.exit(f'abidiff {saved} {library}\n{report}')
    rules = folder / 'grows'
    rules.write_text(may_grow())
    broken = run(*COMPARE, '--no-added-syms', '--suppressions', rules, saved, library, status=status)
    return ('broken', broken) if status[-1] else ('grown', report)


def planted_in_headers(folder):
    """(what, header, the old text, the new text, what has to come out)."""
    hit, conic = '    double     f;       /* F at p', '    double c;              /* curvature'
    member = ('    void (*by_parameter)(const void *self, size_t j, size_t n, sgt_points p,\n'
              '                         sgt_values out);\n')
    version = 'SGT_API const char *sgt_version(void);'
    room = '    unsigned long long reserved_[2];\n} sgt_hit;'
    builtins = 'SGT_API const sgt_builtin *sgt_builtins(void);'
    for what, header, old, new, verdict in [
            ('nothing', 'sagitta.h', hit, hit, ''),
            ('a comment', 'sagitta.h', hit, hit + ' (planted)', ''),
            ('a function is added', 'sagitta.h', version, version + 'SGT_API int sgt_planted(void);',
             'grown'),
            ('a type is added', 'surfaces.h', '} sgt_conic;',
             '} sgt_conic;\ntypedef struct sgt_planted { double c; } sgt_planted;', 'grown'),
            ('a constant is added', 'system.h', '} sgt_fate;', ', SGT_PLANTED = 77 } sgt_fate;', 'grown'),
            ('sgt_surface_ops grows', 'sagitta.h', '} sgt_surface_ops;',
             'void (*planted)(int);\n} sgt_surface_ops;', 'grown'),
            ('a member at the end', 'sagitta.h', '} sgt_hit;', 'double planted;\n} sgt_hit;', 'broken'),
            ('a member before others', 'sagitta.h', hit, '    double planted;\n' + hit, 'broken'),
            ('a member of another name', 'sagitta.h', hit, hit.replace('f;', 'g;'), 'broken'),
            ('a member that no function reaches', 'surfaces.h', conic, conic.replace('double', 'float'),
             'broken'),
            ('a constant of another value', 'sagitta.h', 'SGT_INVALID   = -5', 'SGT_INVALID   = -6',
             'broken'),
            ('a constant before others', 'diagnose.h', '    SGT_WRONG_FIRSTS',
             '    SGT_PLANTED, SGT_WRONG_FIRSTS', 'broken'),
            ('a constant without a type', 'formula.h', 'SGT_MOST_FORMULA_PARAMETERS =',
             'SGT_MOST_FORMULA_PARAMETERS = 1 +', 'broken'),
            ('a result', 'sagitta.h', 'SGT_API int         sgt_version_number',
             'SGT_API long sgt_version_number', 'broken'),
            ('a parameter', 'sagitta.h', 'sgt_ray ray, int cap,', 'sgt_ray ray, size_t cap,', 'broken'),
            ('const', 'sagitta.h', version, version.replace('const', ''), 'broken'),
            ('a function is gone', 'sagitta.h', version, '', 'broken'),
            ('sgt_surface_ops shrinks', 'sagitta.h', member, '', 'broken'),
            ('it grows inside', 'sagitta.h', member, 'void (*planted)(int);\n' + member, 'broken'),
            ('a member becomes another one', 'sagitta.h', member, 'void (*planted)(int);\n', 'broken'),
            ('it grows, and a member changes', 'sagitta.h', member,
             member.replace('size_t n', 'int n') + 'void (*planted)(int);\n', 'broken'),
            ('a member takes room', 'sagitta.h', room, 'double planted;\n' + room.replace('2', '1'), 'grown'),
            ('a member takes all the room', 'sagitta.h', room, 'double planted[2];\n} sgt_hit;', 'grown'),
            ('a member takes no room', 'sagitta.h', room, 'double planted;\n' + room, 'broken'),
            ('room is gone', 'sagitta.h', room, room.replace('2', '1'), 'broken'),
            ('a member takes room, and another one changes', 'sagitta.h', hit,
             hit.replace('double', 'float ').replace('f;', 'f, planted;'), 'broken'),
            ('an array is exported', 'surfaces.h', builtins,
             builtins + 'extern SGT_API const int sgt_planted[];', 'broken')]:
        include = folder / 'include'
        shutil.rmtree(include, ignore_errors=True)
        shutil.copytree(INCLUDE, include)
        text = (include / 'sagitta' / header).read_text()
        if text.count(old) != 1:
            sys.exit(f'planted, {what}: "{old}" is not in {header} once')
        (include / 'sagitta' / header).write_text(text.replace(old, new))
        yield what, compiled(include, folder), verdict, copied(include)


def planted_in_library(build, folder):
    """libsagitta, linked anew with another map or soname."""
    map_text = (build / 'src/sagitta.map').read_text()
    soname = re.search(r"soname='([^']*)'", (HERE / 'libsagitta.abi').read_text())[1]
    for what, old, new, flag, verdict in [
            ('linked as it is', '', '', f'-soname,{soname}', ''),
            ('a name is new', 'sgt_check;', 'sgt_check; sgt_planted;', '--defsym,sgt_planted=sgt_check',
             'grown'),
            ('a name is gone', 'sgt_intersect_all;', '', f'-soname,{soname}', 'broken'),
            ('a table is gone', 'sgt_conic_ops;', '', f'-soname,{soname}', 'broken'),
            ('another version', r'SAGITTA_2\b', 'SAGITTA_2_0', f'-soname,{soname}', 'broken'),
            ('another soname', '', '', f'-soname,{soname}0', 'broken')]:
        (folder / 'map').write_text(re.sub(rf'\b{old}', new, map_text) if old else map_text)
        run(*CC, '-shared', '-Wl,--whole-archive', build / 'src/libsagitta.a', '-Wl,--no-whole-archive',
            '-lm', f'-Wl,--version-script={folder}/map', f'-Wl,-soname,{soname}', f'-Wl,{flag}',
            '-o', folder / 'planted.so')
        yield what, folder / 'planted.so', verdict, []


def array_that_grows(folder):
    """The verdict on a library that exports an array of 3, and is saved with one of 2."""
    for count in (2, 3):
        (folder / 'array.c').write_text(f'const int sgt_planted[{count}] = {{1}};')
        run(*CC, '-shared', '-fPIC', '-g', folder / 'array.c', '-o', folder / f'array{count}.so')
    run(*READ, '--out-file', folder / 'array.abi', folder / 'array2.so')
    return difference(folder / 'array.abi', folder / 'array3.so', folder)[0]


def misjudged(build, folder):
    """How many of what is planted are not judged as they should be."""
    faults = 0
    for saved, planted in (('headers', planted_in_headers(folder)),
                           ('libsagitta', planted_in_library(build, folder))):
        for what, library, wanted, copies in planted:
            verdict, report = difference(HERE / f'{saved}.abi', library, folder)
            verdict = 'broken' if copies else verdict
            print(f'planted in {saved}, {what}: {verdict or "as saved"}')
            if verdict != wanted:
                faults += 1
                print(f'it should be "{wanted}"\n{report}')
    verdict = array_that_grows(folder)
    print(f'planted in a library of its own, an exported array that grows: {verdict}')
    return faults + (verdict != 'broken')


def main(build, *options):
    if not (shutil.which('abidiff') and shutil.which('abidw')):
        print('skipped: no abidiff (package abigail-tools)')
        return 77
    if platform.machine() != 'x86_64' or sys.platform != 'linux':
        print('skipped: what is saved is of x86-64 and Linux')
        return 77
    build = pathlib.Path(build)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        now = {library: build / where / f'{library}.so' for library, where in LIBRARIES.items()}
        missing = [library for library, file in now.items() if not file.exists()]
        if missing and missing != ['libsagitta_geo'] or missing and '--save' in options:
            sys.exit(f'not built: {", ".join(missing)}')
        for library in missing:
            print(f'{library} is not built, and not looked at')
            del now[library]
        now['headers'] = compiled(INCLUDE, folder)
        if copied(INCLUDE):
            sys.exit(f'a program would copy what may grow: {copied(INCLUDE)}')

        verdicts, renamed = set(), False
        for saved, library in now.items():
            if (HERE / f'{saved}.abi').exists():
                verdict, report = difference(HERE / f'{saved}.abi', library, folder)
                print(f'{saved}: {verdict or "as saved"}\n{report}' if verdict else f'{saved}: as saved')
                verdicts.add(verdict)
                renamed |= saved == 'libsagitta' and 'SONAME changed' in report
        if '--save' in options:
            if 'broken' in verdicts and not renamed and '--unreleased' not in options:
                sys.exit('Not saved: a program that exists would break.  '
                         'See CONTRIBUTING.md, "The saved interface".')
            for saved, library in now.items():
                run(*READ, '--out-file', HERE / f'{saved}.abi', library)
            print('saved')
            return 0
        if verdicts != {''}:
            sys.exit('The interface is not the saved one.' + (
                '  See CONTRIBUTING.md, "The saved interface".' if 'broken' in verdicts else
                f'  It has only grown.  Save it: python3 tests/abi/abi.py {build} --save'))

        faults = 0
        text, public = content(INCLUDE)
        for library in now.keys() - {'headers'}:  # no function is left out, by one side or the other
            exported = set(re.findall(r"elf-symbol name='(\w+)'", (HERE / f'{library}.abi').read_text()))
            faults += not exported or bool(exported - public)
            public -= exported
        if public and not missing:
            faults += 1
            print('in headers.abi, but of no library:', *public)
        if '--planted' in options:
            faults += misjudged(build, folder)
        print(f'{faults} faults')
        return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
