#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the library is made of: only sgt_ names go out, only copies of memory
and what the compiler itself asks for come in, and nothing in it can be written to but one number.

    python3 symbols.py INCLUDE_FOLDER SHARED_LIBRARY STATIC_LIBRARY [OTHER_SHARED_LIBRARY ...]

Of the libraries of geo.h and of lens.h, edit.h, analysis.h, figure.h, shape.h, study.h, tolerance.h and why.h, which allocate, only the names are looked at.
"""
import pathlib
import re
import subprocess
import sys

# All that an object may ask of others, each with its reason.  Not here, for it must not be: log, pow, sin,
# hypot and all else that computes, whose bits differ from one C library to the next (src/num has our own);
# malloc, free, printf, abort, exit and errno.
MEMORY = {  # what compilers make of copies and comparisons, and asks nothing of the system
    'memcpy': 'copies of structures, and of the bits of a double',
    'memmove': 'the same where source and target may be one',
    'memset': 'structures that begin as zeros',
    'memcmp': 'equal surfaces and arrays',
    'bcmp': 'what clang makes of memcmp(...) == 0',
}
ENVIRONMENT = {'getenv': 'SAGITTA_SET, once (src/dispatch/choose.c)', 'strcmp': 'its value'}
COMPILER = {  # what its own runtime and the linker answer
    '_GLOBAL_OFFSET_TABLE_': 'position-independent code',
    '__stack_chk_fail': '-fstack-protector of a distribution',
}
OTHERS = {'libsagitta_geo': ['geo.h'], 'libsagitta_lens': ['lens.h', 'edit.h', 'analysis.h', 'figure.h', 'shape.h',
                                  'study.h', 'tolerance.h', 'why.h', 'prove.h']}
ALLOWED = MEMORY.keys() | ENVIRONMENT.keys() | COMPILER.keys()
LIBRARIES = re.compile(r'^(libm|libc|ld-linux[\w-]*)\.so')


def output(*command):
    return subprocess.run(command, text=True, check=True, capture_output=True).stdout


def symbols(*arguments):
    """(type, name) of each symbol that nm lists."""
    for line in output('nm', '--format=posix', *arguments).splitlines():
        word = line.split()
        if len(word) >= 2 and len(word[1]) == 1:
            yield word[1], word[0].split('@')[0]


def declared(include, headers=None):
    """The names that the public headers of the core declare, or that those given declare."""
    names = set()
    for header in sorted(pathlib.Path(include, 'sagitta').glob('*.h')):
        if header.name not in headers if headers else any(header.name in others for others in OTHERS.values()):
            continue
        text = re.sub(r'/\*.*?\*/|//[^\n]*', '', header.read_text(), flags=re.DOTALL)
        for statement in re.findall(r'\bSGT_API\b([^;{]*);', text):
            before = statement.split('(')[0]
            names.update(re.findall(r'\bsgt_\w+(?=\s*(?:\[\]|,|$))', before))
    return names


def faults_of_names(exported, promised):
    return ([f'{name}: exported without the prefix sgt_' for name in exported if not name.startswith('sgt_')]
            + [f'{name}: declared in a public header and not exported' for name in promised - exported]
            + [f'{name}: exported and in no public header' for name in exported - promised
               if name.startswith('sgt_')])


def exported_of(shared):
    """The names, but for those of the version nodes themselves, which are absolute."""
    return {name for kind, name in symbols('-D', '--defined-only', shared) if kind != 'A'}


def faults_of_versions(shared):
    """Each name is of the interface that the soname says, or of a later node of it (SAGITTA_2_1), so that a
    program asks for it by version."""
    [soname] = re.findall(r'\(SONAME\).*\.so\.(\d+)\]', output('readelf', '-dW', shared)) or ['?']
    faults = []
    for line in output('nm', '-D', '--defined-only', '--with-symbol-versions', '--format=posix',
                       shared).splitlines():
        name, kind = line.split()[:2]
        if kind != 'A' and not re.search(rf'@@SAGITTA_{soname}(_\d+)?$', name):
            faults.append(f'{name}: is not of version SAGITTA_{soname}')
    return faults


def main(include, shared, static, *others):
    exported, promised = exported_of(shared), declared(include)
    faults = faults_of_names(exported, promised) + faults_of_versions(shared)
    for other in others:
        header = OTHERS[pathlib.Path(other).name.split('.')[0]]
        faults += faults_of_names(exported_of(other), declared(include, header)) + faults_of_versions(other)

    needed = re.findall(r'\(NEEDED\).*\[(.*)\]', output('readelf', '-dW', shared))
    faults += [f'{name}: needed by the shared library' for name in needed if not LIBRARIES.match(name)]
    soname = re.findall(r'\(SONAME\).*\[(.*)\]', output('readelf', '-dW', shared))
    if not (len(soname) == 1 and re.fullmatch(r'libsagitta\.so\.\d+', soname[0])):
        faults.append(f'the soname is {soname}')

    asked, objects = set(), 0
    for kind, name in symbols(static):
        if kind == 'U':
            asked.add(name)
        elif kind.isupper() and not name.startswith('sgt_'):
            faults.append(f'{name}: an external name of the static library without the prefix sgt_')
        elif kind in 'Cc':
            faults.append(f'{name}: a common variable')
    faults += [f'{name}: asked for by the library' for name in asked
               if not name.startswith('sgt_') and name not in ALLOWED]

    # The set of instructions that was chosen is the one number that is written to (src/dispatch/choose.c).
    # Tables of constant pointers are in .data.rel.ro: written by the loader, then sealed.
    written = ''
    for line in output('readelf', '-SW', static).splitlines():
        if line.startswith('File:'):
            written, objects = line, objects + 1
        section = re.match(r'\s*\[\s*\d+\]\s+(\.(?:t?data|t?bss)\S*)\s+\S+\s+\S+\s+\S+\s+([0-9a-f]+)', line)
        if section and not section[1].startswith('.data.rel.ro') and int(section[2], 16):
            if 'dispatch_choose' in written and int(section[2], 16) == 4:
                continue
            faults.append(f'{section[1]}: {int(section[2], 16)} bytes that can be written to')

    print('\n'.join(sorted(faults) + [
        f'{objects} objects, {len(exported)} names exported, {len(promised)} promised, '
        f'asked of others: {" ".join(sorted(n for n in asked if not n.startswith("sgt_")))}',
        f'{len(faults)} faults']))
    return 1 if faults or not objects or not promised else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
