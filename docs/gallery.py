#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The pictures of docs/gallery.md, and the page.

    python3 docs/gallery.py BUILD             all of them, some ten minutes of one core
    python3 docs/gallery.py BUILD NAME ...    these, and the page

Each picture is made by the command that stands beside it, run in the tree's folder.  BUILD is a build folder with the
examples.
"""
import os
import pathlib
import shlex
import subprocess
import sys

TREE = pathlib.Path(__file__).resolve().parent.parent
PROGRAMS = {'sagitta': 'src/tool/sagitta', 'render': 'examples/render/render', 'line_of_sight': 'examples/line_of_sight/line_of_sight'}
SCENES, LENSES = 'examples/render/scenes', 'examples/lenses'
SMALL = 'render --size 240x160 --samples'

# A title of a part, or (name with its ending, what it shows, the command without the name of the picture).
PICTURES = [
    'Level sets',
    ('julia.png', 'A quaternion Julia set', f'{SMALL} 16 --output @ {SCENES}/julia.yaml'),
    ('ridges.png', 'Another, by the normals of its potential', f'{SMALL} 16 --output @ {SCENES}/julia_ridges.yaml'),
    ('slice.png', 'A slice that is tilted out of the first three components', f'{SMALL} 16 --output @ {SCENES}/slice.yaml'),
    ('mandelbrot.png', 'The Mandelbrot set of quaternions', f'{SMALL} 16 --output @ {SCENES}/mandelbrot.yaml'),
    ('trap.png', 'The first frame of a film: colours by an orbit trap, levels as many as a pixel resolves', f'{SMALL} 32 --output @ {SCENES}/film.yaml'),
    ('evaluations.png', 'What each ray of a Julia set cost', f'render --paint evaluations --size 440x160 --output @ {SCENES}/julia.yaml'),
    'Surfaces of a program of one\'s own, proven',
    ('mandelbulb.png', 'The Mandelbulb', f'{SMALL} 8 --output @ {SCENES}/mandelbulb.yaml'),
    ('menger.png', 'Menger\'s sponge after three steps, cut', f'{SMALL} 8 --output @ {SCENES}/menger.yaml'),
    ('mandelbox.png', 'The Mandelbox, level 7', f'{SMALL} 4 --output @ {SCENES}/mandelbox.yaml'),
    ('sierpinski.png', 'Sierpinski\'s tetrahedron after five steps', f'{SMALL} 8 --output @ {SCENES}/sierpinski.yaml'),
    'Formulas',
    ('barth.png', 'Barth\'s sextic, with 65 nodes', f'{SMALL} 16 --output @ {SCENES}/barth.yaml'),
    ('formulas.png', 'Ten formulas', f'render --size 360x140 --samples 16 --output @ {SCENES}/formulas.yaml'),
    'Solids and glass',
    ('solids.png', 'Unions, intersections, differences, clips', f'{SMALL} 16 --output @ {SCENES}/solids.yaml'),
    ('lens.png', 'A lens of glass over checks', f'{SMALL} 16 --output @ {SCENES}/lens.yaml'),
    ('torus.png', 'A torus: every status is certain', f'{SMALL} 16 --output @ {SCENES}/torus.yaml'),
    'Lenses',
    ('triplet.svg', 'A Cooke triplet', f'sagitta trace {LENSES}/cooke_triplet.yaml --fan 7 --picture @'),
    ('newtonian.svg', 'A Newtonian telescope', f'sagitta trace {LENSES}/newtonian.yaml --fan 7 --picture @'),
    'Analyses',
    ('spots.svg', 'Spots', f'sagitta spot {LENSES}/cooke_triplet.yaml --picture @'),
    ('fans.svg', 'Ray fans', f'sagitta fan {LENSES}/cooke_triplet.yaml --picture @'),
    ('wavefront.svg', 'Optical path differences', f'sagitta opd {LENSES}/cooke_triplet.yaml --picture @'),
    ('field.svg', 'Field curvature, astigmatism, distortion', f'sagitta field {LENSES}/double_gauss.yaml --picture @'),
    ('energy.svg', 'Encircled energy', f'sagitta energy {LENSES}/cooke_triplet.yaml --picture @'),
    ('illumination.svg', 'Vignetting and relative illumination', f'sagitta illumination {LENSES}/double_gauss.yaml --picture @'),
    'The Earth',
    ('geoid.png', 'The geoid from the Indian Ocean to the Himalaya, seen from orbit',
     'line_of_sight --node 85 --start -8 --duration 840 --field 140 --lines 300 --pixels 300 --surface geoid --colour height --format none --picture @'),
    ('swath.png', 'A swath on the ellipsoid, by incidence', 'line_of_sight --lines 300 --pixels 300 --pitch 20 --format none --picture @'),
]
HEAD = '''# Gallery

Every picture is what the command under it makes, in the folder of the source tree; `python3 docs/gallery.py BUILD` makes
them all, and this page. [render.md](render.md) describes scenes, [analysis.md](analysis.md) the analyses,
[line_of_sight.md](line_of_sight.md) the Earth.
'''


def make(build, name, command):
    program, *words = shlex.split(command.replace('@', f'docs/gallery/{name}'))
    done = subprocess.run([build / PROGRAMS[program], *words], cwd=TREE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if not (TREE / 'docs/gallery' / name).exists() or done.returncode > 1:
        sys.exit(f'{command}: {done.stderr}')


def page():
    lines = [HEAD]
    for entry in PICTURES:
        if isinstance(entry, str):
            lines.append(f'## {entry}\n')
        elif (TREE / 'docs/gallery' / entry[0]).exists():
            name, title, command = entry
            lines += [f'**{title}**\n', f'![{title}](gallery/{name})\n', f"    {command.replace('@', 'docs/gallery/' + name)}\n"]
    return '\n'.join(lines)


def main(build, *names):
    (TREE / 'docs/gallery').mkdir(exist_ok=True)
    for entry in PICTURES:
        if not isinstance(entry, str) and (not names or entry[0] in names):
            make(pathlib.Path(os.path.abspath(build)), entry[0], entry[2])
            print(entry[0], (TREE / 'docs/gallery' / entry[0]).stat().st_size, flush=True)
    (TREE / 'docs/gallery.md').write_text(page())


if __name__ == '__main__':
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(*sys.argv[1:])
