#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A page of docs/ is followed to the letter, by someone who has nothing but the installed library.

    python3 page.py PAGE BUILD PROGRAM_NEEDED...     skipped (77) if one of the programs is not there

Each block with a language and a name, `cmake CMakeLists.txt`, is a file of that name.  Each line `$ ...` of
a block marked `console` is run by the shell, from top to bottom, in the folder of these files.  What
follows it is compared with what it prints as readme.py does, and its status has to be 0.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
import prefix  # noqa: E402
import readme  # noqa: E402


def main(page, build, *needed):
    missing = [program for program in needed if not shutil.which(program)]
    if missing:
        print(f'skipped: no {", ".join(missing)}')
        return 77
    text = pathlib.Path(page).read_text()
    ran, bad = 0, 0
    with tempfile.TemporaryDirectory() as name:
        there = prefix.Prefix(build, name)
        folder = pathlib.Path(name) / 'work'
        for file, block in re.findall(r'^```\w+ (\S+)\n(.*?)^```', text, re.MULTILINE | re.DOTALL):
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
            (folder / file).write_text(block)
        for block in re.findall(r'^```console\n(.*?)^```', text, re.MULTILINE | re.DOTALL):
            for command, quoted in re.findall(r'^\$ (.*)\n((?:(?!\$ ).*\n)*)', block.replace('\\\n', ' '),
                                              re.MULTILINE):
                done = subprocess.run(command, shell=True, text=True, cwd=folder, env=there.environment,
                                      stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
                ran += 1
                if done.returncode or not readme.matches(quoted.splitlines(), done.stdout.splitlines()):
                    bad += 1
                    print(f'$ {command}\nthe page says:\n{quoted}\nit says, with status {done.returncode}:\n'
                          f'{done.stdout}')
    print(f'{pathlib.Path(page).name}: {ran} commands, {bad} differ')
    return 1 if bad or not ran else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
