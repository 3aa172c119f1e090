#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The manual pages: each command, option and public function is on its page, and mandoc has no warning.

    python3 test_man.py SAGITTA TREE NAME...

NAME: the pages that meson.build makes of commands.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import help as helps  # noqa: E402
import man  # noqa: E402

program, tree, names = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3:]
faults = []
with tempfile.TemporaryDirectory() as folder:
    pages = pathlib.Path(folder)
    commands = [name for name, _ in helps.commands(program)]
    if sorted([*commands, 'sagitta']) != sorted(names):
        faults.append(f'meson.build makes pages of {sorted(names)}, the command has {sorted(commands)}')
    for name in ['sagitta', *commands]:
        page = pages / f'{name}.1'
        man.main('command', program, name, page)
        text = page.read_text().replace('\\-', '-')
        if name == 'sagitta':
            faults += [f'sagitta.1 has no {c}' for c in commands if f'.BR sagitta-{c} (1)' not in text]
            continue
        for row in helps.text_of(program, name, '--help', 'options').splitlines():
            if not re.search(rf'^\.B {row.split()[0]}( |$)', text, re.M):
                faults.append(f'sagitta-{name}.1 has no {row.split()[0]}')
    headers = sorted((tree / 'include' / 'sagitta').glob('*.h'))
    functions = 0
    for header in headers:
        page = pages / f'{header.stem}.3'
        man.main('header', header, page)
        text = page.read_text()
        above = re.sub(r'[,\s]+', ' ', text.split('.SH NAME')[1].split('.SH SYNOPSIS')[0])
        plain = re.sub(r'/\*.*?\*/', '', header.read_text(), flags=re.S)
        there = set(re.findall(r'SGT_API[^;]*?\b(sgt_\w+)\(', plain))
        functions += len(there)
        faults += [f'{page.name} has no {f}' for f in there if f' {f} ' not in above]
    if functions < 150 or len(headers) < 15:
        faults.append(f'only {functions} functions in {len(headers)} headers')
    man.main('page', tree / 'docs' / 'man' / 'sagitta-mpi.1.in', pages / 'sagitta-mpi.1')
    if shutil.which('lowdown'):
        docs = [tree / 'docs' / name for name in ('lens_file.md', 'lens_file_surfaces.md', 'lens_file_phases.md', 'import.md')]
        man.main('file', *docs, pages / 'sagitta-lens.5')
    if shutil.which('mandoc'):
        done = subprocess.run(['mandoc', '-T', 'lint', '-W', 'warning', *sorted(map(str, pages.iterdir()))],
                              capture_output=True, text=True)
        faults += done.stdout.splitlines()
    print(f'{len(list(pages.iterdir()))} pages, {functions} functions' +
          ('' if shutil.which('mandoc') else '; mandoc was not found'))
print('\n'.join(faults))
sys.exit(bool(faults))
