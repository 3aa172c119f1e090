#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Formulas beside POV-Ray's isosurface, in one run: the table of docs/formula.md.

    python3 tests/bench/povray_formula.py build            (--quick: one turn, not five)

Four implicit surfaces in a ball of 1.6, a picture of 640 x 480, one thread, one ray for each pixel, without
light.  POV-Ray is given two values of max_gradient each: about what others use, and about what the surface
needs.  Its time is the processor time of its trace phase, as it tells it, less that of an empty scene.

sagitta's time is that of `bench_cells`, the column *formula*: first hits in batches, each proven.  The
programs take turns, and medians are told.

Which pixels are wrong?  POV-Ray paints its hits with their distance (povray/formula.pov).  The command
`sagitta intersect --proof first` answers for the same rays.  A pixel is wrong if one of the two hits and
the other does not, or if their distances differ by more than 1e-3.  The share is of the pixels where sagitta
hits.  Roots that sagitta might have missed are told once more: pixels where POV-Ray alone hits, or hits
nearer to the camera.
"""
import array
import math
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent / 'povray'
WIDTH, HEIGHT = 640, 480
RAYS = WIDTH * HEIGHT
OFF = 1e-3
AT, LOOK = (1.2, 0.9, -3.2), (-0.47536594, -0.35652446, 1.26764251)    # camera.inc
RIGHT, ABOVE = (1.24843890, 0, 0.46816459), (-0.08941721, 0.96703057, 0.23844589)

# The name in bench_cells, the text, and max_gradient.
SURFACES = [
    ('Barth sextic',
     '4*(2.618033988749895*x^2 - y^2)*(2.618033988749895*y^2 - z^2)*(2.618033988749895*z^2 - x^2)'
     ' - 4.23606797749979*(x^2 + y^2 + z^2 - 1)^2', (10, 100)),
    ('Clebsch',
     '81*(x^3 + y^3 + z^3) - 189*(x^2*(y + z) + y^2*(x + z) + z^2*(x + y)) + 54*x*y*z'
     ' + 126*(x*y + x*z + y*z) - 9*(x^2 + y^2 + z^2) - 9*(x + y + z) + 1', (100, 700)),
    ('Chmutov 8', '2*(2*(2*x^2-1)^2-1)^2 + 2*(2*(2*y^2-1)^2-1)^2 + 2*(2*(2*z^2-1)^2-1)^2 - 2', (100, 400)),
    ('gyroid', 'sin(6*x)*cos(6*y) + sin(6*y)*cos(6*z) + sin(6*z)*cos(6*x)', (6, 22)),
]


def rays():
    """The rays, row by row: origin and direction of length 1."""
    out = array.array('d')
    for row in range(HEIGHT):
        v = (HEIGHT - 1 - row + 0.5) / HEIGHT - 0.5
        for column in range(WIDTH):
            u = (column + 0.5) / WIDTH - 0.5
            d = [a + u * b + v * c for a, b, c in zip(LOOK, RIGHT, ABOVE)]
            length = math.sqrt(sum(x * x for x in d))
            out.extend(AT)
            out.extend(x / length for x in d)
    return out


def write_rays(path):
    head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({RAYS}, 6), }}"
    head += ' ' * (-(len(head) + 11) % 64) + '\n'
    numbers = rays()
    if sys.byteorder == 'big':
        numbers.byteswap()
    path.write_bytes(b'\x93NUMPY\x01\x00' + len(head).to_bytes(2, 'little') + head.encode() +
                     numbers.tobytes())


def column(path, kind):
    raw = path.read_bytes()
    numbers = array.array(kind, raw[10 + int.from_bytes(raw[8:10], 'little'):])
    if sys.byteorder == 'big':
        numbers.byteswap()
    return numbers


def sagitta_hits(command, text, where, folder):
    """(t for each ray, NaN where nothing is hit; which rays are undecided)."""
    out = folder / 'out'
    surface = f'{{type: formula, f: "{text}", inside: {{ball: 1.6}}}}'
    subprocess.run([command, 'intersect', '--surface', surface, '--rays', where, '--proof', 'first', '--format',
                    'npy', '--columns', 'status,t', '--output', out], check=False, capture_output=True)
    status, t = column(out / 'status.npy', 'b'), column(out / 't.npy', 'd')
    for path in out.iterdir():
        path.unlink()
    out.rmdir()
    return [x if s > 0 else math.nan for s, x in zip(status, t)], [s < 0 for s in status]


def povray(scene, folder, *words):
    """Seconds of the processor in its trace phase; the picture is in the folder.  None: it did not run."""
    try:
        done = subprocess.run(['povray', f'+I{HERE / scene}', f'+L{HERE}', f'+O{folder / "image"}',
                               f'+W{WIDTH}', f'+H{HEIGHT}', '+WT1', '-D', '-A', '-J', *words], text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    except FileNotFoundError:
        return None
    told = re.search(r'Trace Time:.*?with ([\d.]+) CPU', done.stdout, re.DOTALL)
    return float(told[1]) if done.returncode == 0 and told else None


def declared(which, gradient, depth):
    return [f'Declare=WHICH={which}', f'Declare=GRADIENT={gradient}', f'Declare=DEPTH={depth}']


def povray_depths(which, gradient, folder):
    povray('formula.pov', folder, '+FP16', 'File_Gamma=1', *declared(which, gradient, 1))
    raw = (folder / 'image.ppm').read_bytes()
    pixels = array.array('H', raw[raw.index(b'65535\n') + 6:])
    if sys.byteorder == 'little':
        pixels.byteswap()
    return [(pixels[i] + pixels[i + 1] / 65535) / 4096 if pixels[i + 2] else math.nan
            for i in range(0, 3 * RAYS, 3)]


def compare(ours, theirs):
    """Pixels that are wrong; of them those where POV-Ray misses, and where it hits before sagitta."""
    wrong = missed = nearer = 0
    for a, b in zip(ours, theirs):
        if math.isnan(a) and math.isnan(b) or abs(a - b) <= OFF:
            continue
        wrong += 1
        missed += math.isnan(b)
        nearer += math.isnan(a) or b < a
    return wrong, missed, nearer


def percent(n, of):
    return f'{float(f"{100 * n / of:.2g}" if n < 0.99 * of else f"{100 * n / of:.1f}"):g} %'


def bench(build, name):
    """ns a ray of the formula, and how many answers `bench_cells` found undecided and unlike."""
    said = subprocess.run([build / 'tests/bench/bench_cells', '--quick', '--only', name], check=True, text=True,
                          capture_output=True).stdout.splitlines()[-1]
    words = said[len(name):].split()
    return float(words[0]), int(words[-2]), int(words[-1])


def main(build, turns):
    build = pathlib.Path(build)
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        if povray('empty.pov', folder, '+FN8') is None:
            print('POV-Ray was not found: nothing is compared')
            return 77
        write_rays(folder / 'rays.npy')
        print('| surface | hits | sagitta: ns a ray | undecided | POV-Ray by max_gradient: ns a ray | wrong | '
              'of it missed | before sagitta |\n|---|---|---|---|---|---|---|---|')
        for which, (name, text, gradients) in enumerate(SURFACES, 1):
            t, undecided = sagitta_hits(build / 'src/tool/sagitta', text, folder / 'rays.npy', folder)
            hits = sum(not math.isnan(x) for x in t)
            empty, ours, theirs = [], [], {g: [] for g in gradients}
            for _ in range(turns):
                empty.append(povray('empty.pov', folder, '+FN8'))
                for g in gradients:
                    ours.append(bench(build, name))
                    theirs[g].append(povray('formula.pov', folder, '+FN8', *declared(which, g, 0)))
            told = []
            for g in gradients:
                wrong, missed, nearer = compare(t, povray_depths(which, g, folder))
                ns = 1e9 * (statistics.median(theirs[g]) - statistics.median(empty)) / RAYS
                told.append((f'{g}: {float(f"{ns:.3g}"):,.0f}', percent(wrong, hits), percent(missed, hits),
                             nearer))
            first = (f'| {name} | {hits:,} | {statistics.median(x for x, _, _ in ours):,.0f} '
                     f'| {sum(undecided)} ')
            for ns, wrong, missed, nearer in told:
                print(f'{first}| {ns} | {wrong} | {missed} | {nearer} |', flush=True)
                first = '| | | | '
    return 0


if __name__ == '__main__':
    where = [word for word in sys.argv[1:] if word != '--quick']
    if len(where) != 1:
        sys.exit(__doc__)
    sys.exit(main(where[0], 1 if '--quick' in sys.argv else 5))
