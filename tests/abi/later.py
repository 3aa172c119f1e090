#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Programs and libraries of two versions: each program with each library.

    python3 later.py BUILD

The later version is made here, from a copy of the headers and sources: every struct that has room has a
member more in it (planted_), the library has a type more, and writes the new member of each hit.  It is
compiled without optimisation, without inlining, and for one set of instructions, by the compile commands of
BUILD.

    program compiled against   with the library   has to
    the headers of this one    of this one        give answers
                               that has grown     give the same answers, and list the type more
    the headers of the later   that has grown     give the same answers; the new members are taken
                               of this one        give the same answers; where it sets a member, be told
                                                  at the call which one of which struct it lacks
"""
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
MEMBER = 'unsigned long long planted_;'
# What the program asks for, and what it is told: by a library that has it, and by one that has not.
ASKED = {'sgt_options': ('hit', 'invalid', 'opt.reserved_[0]'),
         'sgt_hits': ('hit', 'invalid', 'hits.reserved_[0]'),
         'sgt_traced': ('passed', 'lost', 'out.reserved_[0]'),
         'sgt_passages': ('passed', 'lost', 'passages[0].passage.reserved_[0]'),
         'sgt_element': ('passed', 'lost', 'e[0].element.reserved_[0]'),
         'sgt_aim_options': ('met', 'invalid', 'opt.reserved_[0]'),
         'sgt_beam': ('met', 'invalid', 'beam.reserved_[0]'), 'sgt_jacobian': ('lacks 0', 'lacks 4', None),
         'sgt_ray_changes': ('lacks 0', 'lacks 4', None), 'sgt_end_errors': ('known', 'none', None)}
ASKED_OF_LENSES = {'sgt_lens_options': ('read', 'refused', 'sgt_lens_options'),
                   'sgt_launcher_options': ('made', 'refused', 'sgt_launcher_options.reserved_[0]'),
                   'sgt_lens_field': ('launched', 'refused', 'sgt_lens_field.reserved_[0]'),
                   'sgt_study_options': ('made', 'refused', 'sgt_study_options.reserved_[0]'),
                   'sgt_sink': ('run', 'refused', 'sgt_sink.reserved_[0]'),
                   'sgt_spot_options': ('run', 'refused', 'options.reserved_[0]'),
                   'sgt_glass': ('an index', 'none', '')}


def run(command, **more):
    done = subprocess.run([str(word) for word in command], text=True, capture_output=True, **more)
    if done.returncode:
        sys.exit(f'{shlex.join(map(str, command))}\n{done.stdout}{done.stderr}exit status {done.returncode}')
    return done


def replaced(file, old, new):
    text = file.read_text()
    if text.count(old) != 1:
        sys.exit(f'"{old}" is not in {file} once')
    file.write_text(text.replace(old, new))


def grow(tree):
    """One more member in every struct that has room, one more type; hits have the member set."""
    grown = 0
    for header in sorted((tree / 'include/sagitta').glob('*.h')):
        def more(found):
            left = int(found[1]) - 1
            return MEMBER + (f' unsigned long long reserved_[{left}];' if left else '')
        text, count = re.subn(r'unsigned long long reserved_\[(\d+)\];', more, header.read_text())
        header.write_text(text)
        grown += count
    if grown < 30:
        sys.exit(f'{grown} structs have room')
    last = '.p = h->p, .n = h->n, .p_err = h->p_err,'
    replaced(tree / 'src/solve/entries.h', last + '\n                     .reserved_ = {0, 0}};',
             last + ' .planted_ = 7};')
    replaced(tree / 'src/num/exact.h', 'always_inline, ', '')  # inlined code takes longer to compile
    types = tree / 'src/types.def'
    row = re.search(r'^TYPE\(CONIC, sphere,.*?\n(?=TYPE)', types.read_text(), re.MULTILINE | re.DOTALL)[0]
    types.write_text(types.read_text() + row.replace('sphere', 'planted', 1))
    return grown


def library(build, tree, name, where, names, folder, links=()):
    """The library anew, of the sources and headers in `tree`.  names: the map of those that go out."""
    jobs = []
    for entry in json.loads((build / 'compile_commands.json').read_text()):
        if not re.match(where, entry['output']):
            continue
        words, given = [], iter(shlex.split(entry['command']))
        for word in given:
            if word in ('-MQ', '-MF', '-o', '-c'):
                next(given)
            elif word.startswith('-I') or word.endswith('names.h'):
                of = re.match('(-I)?(.*)', word)
                words.append((of[1] or '') + moved(of[2], entry['directory'], tree))
            elif word != '-MD' and not word.startswith('-O'):
                words.append(re.sub(r'^-DSGT_SETS=.*', '-DSGT_SETS=1', word))
        source = moved(entry['file'], entry['directory'], tree)
        target = folder / f'{len(jobs)}.o'
        jobs.append([*words, '-O0', '-w', '-fPIC', '-c', source, '-o', str(target)])
    folder.mkdir(exist_ok=True)
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda job: run(job, cwd=build), jobs))
    linker = next(i for i, word in enumerate(jobs[0]) if word.startswith('-'))
    run([*jobs[0][:linker], '-shared', *(job[-1] for job in jobs), '-o', folder / f'lib{name}.so',
         f'-Wl,-soname,lib{name}.so.2', f'-Wl,--version-script={names}', f'-L{folder}', *links, '-lm'])
    shutil.copy(folder / f'lib{name}.so', folder / f'lib{name}.so.2')
    return jobs[0][:linker]


def moved(path, directory, tree):
    """The path in `tree` of what lies in this source tree, but for the build folder."""
    full = pathlib.Path(os.path.normpath(os.path.join(directory, path)))
    inside = full == ROOT or ROOT in full.parents
    of_build = full == pathlib.Path(directory) or pathlib.Path(directory) in full.parents
    return str(tree / full.relative_to(ROOT)) if inside and not of_build else path


def main(build):
    build = pathlib.Path(build).resolve()
    if not sys.platform.startswith('linux') or not (build / 'src/libsagitta.so').exists():
        print('skipped: there is no shared library')
        return 77
    with_lens = (build / 'src/lens/libsagitta_lens.so').exists() and 'yaml_missing' not in ''.join(
        entry['output'] for entry in json.loads((build / 'compile_commands.json').read_text()))
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        tree = folder / 'tree'
        for part in ('include', 'src'):
            shutil.copytree(ROOT / part, tree / part)
        print(f'{grow(tree)} structs have a member more')
        of_core = r'src/libsagitta_base\.a\.p/|src/libsagitta\.so\.[^/]*\.p/'
        compiler = library(build, tree, 'sagitta', of_core, build / 'src/sagitta.map', folder)
        if with_lens:
            library(build, tree, 'sagitta_lens', r'src/lens/libsagitta_lens\.so\.[^/]*\.p/',
                    ROOT / 'src/lens/sagitta_lens.map', folder,
                    ('-lsagitta', '-lyaml'))
        programs = {}
        for which, include in (('this', ROOT / 'include'), ('later', tree / 'include')):
            programs[which] = folder / f'program_{which}'
            run([*compiler, '-std=c11', '-O1', HERE / 'later.c', '-I', include, '-o', programs[which],
                 *(['-DLATER'] if which == 'later' else []), *(['-DWITH_LENS'] if with_lens else []),
                 f'-L{build}/src', f'-L{build}/src/lens', *(['-lsagitta_lens'] if with_lens else []),
                 '-lsagitta', '-lm', f'-Wl,-rpath-link,{build}/src'])
        paths = {'this': f'{build}/src:{build}/src/lens', 'later': str(folder)}

        def said(program, of, *words):
            return run([programs[program], *words], env={**os.environ, 'LD_LIBRARY_PATH': paths[of]})

        faults = 0
        answers = said('this', 'this').stdout
        print(f'{len(answers.splitlines())} lines of answers')
        for program, of in (('this', 'later'), ('later', 'later'), ('later', 'this')):
            got = said(program, of)
            more = [line for line in got.stdout.splitlines() if line.startswith('planted')]
            rest = ''.join(line for line in got.stdout.splitlines(True) if not line.startswith('planted'))
            bad = (rest != answers) + (bool(more) != (of == 'later'))
            members = set(got.stderr.split()) - {'planted'}
            bad += program == 'later' and members != {'7' if of == 'later' else '0'}
            print(f'program of {program} version, library of {of}:',
                  'DIFFERENT' if bad else 'the same answers')
            if bad:
                faults += 1
                for a, b in zip(answers.splitlines(), rest.splitlines()):
                    if a != b:
                        print(f'    {a}\n    {b}')
                        break
                print(f'    members {members}, {len(more)} lines of the type more')
        asked = {**ASKED, **(ASKED_OF_LENSES if with_lens else {})}
        for of in ('later', 'this'):
            told = dict(line.split(': ', 1) for line in said('later', of, 'asks').stdout.splitlines())
            for struct, (taken, refused, key) in asked.items():
                want = taken if of == 'later' else refused
                if key is not None:
                    want += '; sound' if of == 'later' else f'; {key}'
                fine = told.get(struct) == want
                faults += not fine
                print(f'a member of {struct}, library of {of}: {told.get(struct)}',
                      '' if fine else f'not {want}')
            faults += told.keys() != asked.keys()
    print(f'{faults} faults')
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
