#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The examples as a user has them: copied out of the project, made against the installed library, and run.

    python3 copied.py BUILD EXAMPLES FOLDER...      FOLDER: . or one below it, with a Makefile
"""
import pathlib
import shutil
import sys
import tempfile

from prefix import Prefix, run

# What is run in each folder, and a word that it prints.  An example that ends with another status than 0 has failed.
RUNS = {
    '.': [('./conic', 'hit'), ('./own_surface', 'sound'), ('./torus', 'one root within'), ('./watch', 'quadratic'), ('./trace', 'crosses the axis'),
          ('./batch', '1000'), ('./formula', 'hit'), ('./leave', ' 0 lost, 0 undecided'), ('./spots lenses/cooke_triplet.yaml', 'field 3')],
    'render': [('./render --size 60x40 --samples 1 scenes/torus.yaml', ' 0 undecided')],
    'line_of_sight': [('./line_of_sight --lines 1 --pixels 3', '3 on the Earth')],
    'optimise': [('./optimise ../lenses/double_gauss.yaml 1', 'come back')],
}


def main(build, examples, *folders):
    with tempfile.TemporaryDirectory() as name:
        prefix = Prefix(build, name)
        there = pathlib.Path(name) / 'mine'
        shutil.copytree(examples, there)
        page = (there / 'README.md').read_text()
        for item in pathlib.Path(examples).iterdir():
            if item.name not in ('README.md', 'Makefile', 'meson.build', 'start.sh') and f'`{item.name}' not in page:
                sys.exit(f'README.md of the examples does not list {item.name}')
        for folder in folders:
            run('make', '-s', '-C', there / folder, env=prefix.environment)
            for line, word in RUNS[folder]:
                said = run(*line.split(), cwd=there / folder, env=prefix.environment)
                if word not in said:
                    sys.exit(f'{folder}: {line}: no "{word}" in\n{said}')
                print(f'{folder}: {line}')
    return 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
