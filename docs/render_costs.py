#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the scenes of the renderer cost: the table of render.md, and whether the page still tells it.

    python3 docs/render_costs.py build/examples/render/render          prints the table, timed
    python3 docs/render_costs.py --check build/examples/render/render  compares rays and evaluations with it

Each scene is drawn at 192 x 128 with 4 samples.  Rays and evaluations do not depend on the machine, except
that a few rays see the last bits of the libm that the renderer makes them with.  The time is that of the
processor, of one thread, the least of five runs.
"""
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

PAGE = pathlib.Path(__file__).with_name('render.md')
SCENES = PAGE.parent.parent / 'examples' / 'render' / 'scenes'
ROW = re.compile(r'^\| `([\w.]+)` \| ([\d,]+) \| ([\d.]+) \| ', re.M)
RUNS = 5
RAYS_OFF, EVALUATIONS_OFF = 1e-3, 0.15               # of rays a part; of evaluations a ray


def draw(render, scene, folder, *words):
    """(rays, evaluations each) of one picture, as the program tells them."""
    command = [os.path.abspath(render), *words, '--size', '192x128', '--samples', '4', '--output',
               f'{folder}/small.png', scene]
    said = subprocess.run(command, check=True, capture_output=True, text=True).stderr
    rays, evaluations = re.search(r'(\d+) rays, ([\d.]+) evaluations each', said).groups()
    return int(rays), float(evaluations)


def seconds(render, scene, folder):
    best = float('inf')
    for _ in range(RUNS):
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        draw(render, scene, folder, '--threads', '1')
        best = min(best, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before)
    return best


def table(render, folder):
    rows = []
    for scene in SCENES.glob('*.yaml'):
        rays, evaluations = draw(render, scene, folder)
        took = seconds(render, scene, folder)
        ns = 1e9 * took / rays
        rows.append((ns, f'| `{scene.name}` | {rays:,} | {evaluations:.1f} | {took:.2f} | '
                         f'{float(f"{ns:.3g}"):,.0f} |'))
    print('| scene | rays | evaluations each | seconds | ns a ray |\n|---|---|---|---|---|')
    print('\n'.join(row for _, row in sorted(rows)))


def check(render, folder):
    told = {name: (int(rays.replace(',', '')), float(evaluations))
            for name, rays, evaluations in ROW.findall(PAGE.read_text())}
    scenes = {path.name for path in SCENES.glob('*.yaml')}
    faults = [f'no row of {name}' for name in sorted(scenes - set(told))]
    for name, (rays, evaluations) in told.items():
        now = draw(render, SCENES / name, folder)
        print(f'{name}: {now[0]} rays, {now[1]} evaluations each; on the page {rays}, {evaluations}')
        if abs(now[0] - rays) > RAYS_OFF * rays or abs(now[1] - evaluations) > EVALUATIONS_OFF:
            faults.append(f'{name} costs something else than {PAGE.name} tells')
    print('\n'.join(faults + [f'{len(faults)} faults']))
    return 1 if faults else 0


if __name__ == '__main__':
    with tempfile.TemporaryDirectory() as folder:
        sys.exit((check if '--check' in sys.argv else table)(sys.argv[-1], folder))
