#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Lenses a second of a Monte Carlo: tolerances of the Cooke triplet in three ways.

    python3 tests/bench/tolerance_trials.py build [--trials N]

    sagitta    Lens.tolerance().trials, one thread
    edits      the same loop in Python: an edit of the lens and its spots, lens by lens
    numpy      the same loop, with a sequential trace in numpy of all rays of a lens at once, written here
               from the books: spheres by the quadratic formula, a figured one by Newton's method

All three build the same lenses (sagitta.Tolerancing.draw) and find the same figures: to 1e-12 the edits, to 1e-9
numpy.  Printed is the median of five runs of each, one after the other in turn.
"""
import argparse
import os
import pathlib
import statistics
import sys
import time

import numpy as np

TREE = pathlib.Path(__file__).resolve().parents[2]
LENS = TREE / 'examples/lenses/triplet_tolerances.yaml'
GREEN = 0.5461e-3  # of fringes, in mm
RINGS = 6


# ------------------------------------------------------------------------------- edits

def edit(lens, tolerancing, value):
    """The lens of a point, by what the entries say; the last one, the back focus, is set."""
    v = dict(zip((e.text for e in tolerancing.entries), value))
    changes = {
        'surfaces[1].radius': 22.01359 + v['surface 1 radius'],
        'surfaces[2].thickness': 6.00755 + v['surface 2 thickness'],
        'surfaces[3].thickness': 0.99997 + v['surface 3 thickness'],
        'surfaces[4].thickness': 4.75041 + v['surface 4 thickness'],
        'surfaces[3].index': 1.6236551229276037 + v['surface 3 index'],
        'surfaces[5].type': 'zernike', 'surfaces[5].norm': 7.5, 'surfaces[5].order': 'fringe',
        'surfaces[5].coefficients': [0, 0, 0, 0, v['surface 5 irregularity 5'] * GREEN / 2],
        'surfaces[6].tilt': [0, v['surface 6 tilt_y'], 0]}
    for i, r, h in ((2, -435.76044, 8.5), (3, -22.21328, 5), (4, 20.29192, 4)):
        changes[f'surfaces[{i}].curvature'] = 1 / r + v[f'surface {i} fringes'] * GREEN / h ** 2
    turn, places = placed(v)
    for i, at in zip((3, 4), places):
        changes[f'surfaces[{i}].decenter'] = [float(x) for x in at]
        changes[f'surfaces[{i}].tilt'] = [v['negative element tilted'], 0, 0]
    built = lens.set(changes)
    way = built.first_order().image
    return built.set('surfaces[6].thickness', 42.20778 + min(max(way - edit.image, -0.5), 0.5))


def placed(v):
    """The turn of the negative element, and how far its two vertices are off."""
    a = np.radians(v['negative element tilted'])
    turn = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    off = np.array([0, v['negative element decentred'], 0])
    pivot, places = np.array([0, 0, 0.5]), []
    for z in (0, 0.99997):
        at = np.array([0, 0, z])
        places.append(pivot + turn @ (at + off - pivot) - at)
    return turn, places


# ------------------------------------------------------------------------------- numpy

def vertex_rays(c, n, t, y, nu, first, last):
    """y and n u from surface to surface (Welford 1986, 3.2)."""
    for i in range(first, last):
        nu = nu - y * (n[i + 1] - n[i]) * c[i]
        y = y + t[i] * nu / n[i + 1]
    return y, nu


def by_numpy(v, points, weight, focus):
    """The root of the mean square of the spots' radii of the built lens; focus: the image as designed."""
    n = [1, 1.6226085614386923, 1, 1.6236551229276037 + v['surface 3 index'], 1, 1.6226085614386923, 1]
    t = [3.25896, 6.00755 + v['surface 2 thickness'], 0.99997 + v['surface 3 thickness'],
         4.75041 + v['surface 4 thickness'], 2.95208, 42.20778]
    c = [1 / (22.01359 + v['surface 1 radius']), 1 / -435.76044 + v['surface 2 fringes'] * GREEN / 8.5 ** 2,
         1 / -22.21328 + v['surface 3 fringes'] * GREEN / 25, 1 / 20.29192 + v['surface 4 fringes'] * GREEN / 16,
         1 / 79.6836, 1 / -18.39533]
    rim = [9.5, 8.5, 5, 4, 7.5, 7.5, 19]
    wave = v['surface 5 irregularity 5'] * GREEN / 2 / 7.5 ** 2   # times x^2 - y^2
    flat = c[:4] + [c[4] - 2 * wave] + c[5:]                      # in the y-z plane
    y, nu = vertex_rays(flat, n, t, 1.0, 0.0, 0, 6)
    way = -y / nu
    t[5] += min(max(way - focus, -0.5), 0.5)
    y, nu = 0.0, 1.0                                              # the stop seen from the front
    for i in (2, 1, 0):
        y = y - t[i] * nu / n[i + 1]
        nu = nu + y * (n[i + 1] - n[i]) * flat[i]
    pupil = -y / nu
    turn, places = placed(v)
    b = np.radians(v['surface 6 tilt_y'])
    turns = {2: turn, 3: turn, 5: np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])}
    offs = {2: places[0], 3: places[1]}
    sum_of_fields = 0.0
    for angle in (0, 14, 20):
        d = np.tile(np.array([[0], [np.sin(np.radians(angle))], [np.cos(np.radians(angle))]]), points.shape[1])
        o = np.vstack([5 * points, np.full(points.shape[1], pupil)])
        passed, z = np.full(points.shape[1], True), 0.0
        for i in range(7):
            off = offs.get(i, np.zeros(3)) + np.array([0, 0, z])
            r = turns.get(i, np.eye(3))
            p, l = r.T @ (o - off[:, None]), r.T @ d
            if i == 6:
                p = p - l * (p[2] / l[2])
            else:
                p, normal = meet(p, l, c[i], wave if i == 4 else 0.0)
                l = bend(l, normal, n[i] / n[i + 1])
            passed &= p[0] ** 2 + p[1] ** 2 <= rim[i] ** 2
            o, d = r @ p + off[:, None], r @ l
            z += t[i] if i < 6 else 0
        w = np.where(passed, weight, 0)
        square = (o[0] - o[0, -1]) ** 2 + (o[1] - o[1, -1]) ** 2  # the last one is the chief ray
        sum_of_fields += np.sum(w * square) / np.sum(w)
    return np.sqrt(sum_of_fields / 3)


def meet(p, d, c, wave):
    """The point, and the normal, of a sphere with the sag wave (x^2 - y^2) on it."""
    b = d[2] - c * np.sum(p * d, 0)
    f = c * np.sum(p * p, 0) - 2 * p[2]
    q = p + d * (f / (b + np.sqrt(b * b - c * f)))
    for _ in range(3 if wave else 0):
        root = np.sqrt(1 - c * c * (q[0] ** 2 + q[1] ** 2))
        level = q[2] - c * (q[0] ** 2 + q[1] ** 2) / (1 + root) - wave * (q[0] ** 2 - q[1] ** 2)
        slope = d[2] - (c / root + 2 * wave) * q[0] * d[0] - (c / root - 2 * wave) * q[1] * d[1]
        q = q - d * (level / slope)
    root = np.sqrt(1 - c * c * (q[0] ** 2 + q[1] ** 2))
    normal = np.vstack([-(c / root + 2 * wave) * q[0], -(c / root - 2 * wave) * q[1], np.ones_like(root)])
    return q, normal / np.sqrt(np.sum(normal * normal, 0))


def bend(d, normal, mu):
    cosine = np.sum(d * normal, 0)
    return mu * d + (np.sqrt(1 - mu * mu * (1 - cosine * cosine)) - mu * cosine) * normal


# ----------------------------------------------------------------------------- the race

def main():
    options = argparse.ArgumentParser()
    options.add_argument('build')
    options.add_argument('--trials', type=int, default=20000)
    given = options.parse_args()
    os.environ['SAGITTA_PYTHON_LIBRARY'] = os.path.abspath(f'{given.build}/python/libsagitta_python.so')
    sys.path.insert(0, str(TREE / 'python'))
    import sagitta

    designed = sagitta.Lens.read(LENS)
    tolerancing, lens = designed.tolerance(pattern='hexapolar', rays=RINGS), designed.remove('tolerances')
    edit.image = lens.first_order().image
    rays = lens.launch(1, 'hexapolar', RINGS)
    points = np.append(np.vstack([rays.px, rays.py]), [[0], [0]], 1)
    weight = np.append(rays.weight, 0)
    y, nu = vertex_rays([1 / 22.01359, 1 / -435.76044, 1 / -22.21328, 1 / 20.29192, 1 / 79.6836, 1 / -18.39533],
                        [1, 1.6226085614386923, 1, 1.6236551229276037, 1, 1.6226085614386923, 1],
                        [3.25896, 6.00755, 0.99997, 4.75041, 2.95208, 42.20778], 1.0, 0.0, 0, 6)
    names = [e.text for e in tolerancing.entries]

    def sagitta_trials(count):
        return tolerancing.trials(count).figure

    def edit_trials(count):
        out = np.empty(count)
        for i in range(count):
            spots = edit(lens, tolerancing, tolerancing.draw(i)).spot(pattern='hexapolar', rays=RINGS)
            out[i] = np.sqrt(np.mean(spots.of(wavelength=0).rms ** 2))
        return out

    def numpy_trials(count):
        return np.array([by_numpy(dict(zip(names, tolerancing.draw(i))), points, weight, -y / nu)
                         for i in range(count)])

    ways = {'sagitta': (sagitta_trials, given.trials), 'edits': (edit_trials, given.trials // 20),
            'numpy': (numpy_trials, given.trials // 40)}
    few = sagitta_trials(50)
    assert np.max(np.abs(edit_trials(50) - few)) <= 1e-12, edit_trials(50) - few
    assert np.max(np.abs(numpy_trials(50) - few)) <= 1e-9, numpy_trials(50) - few
    times = {name: [] for name in ways}
    for _ in range(5):
        for name, (run, count) in ways.items():
            begun = time.perf_counter()
            run(count)
            times[name].append((time.perf_counter() - begun) / count)
    first = statistics.median(times['sagitta'])
    print('| way | lenses a second | sagitta is |\n|---|---|---|')
    for name in ways:
        each = statistics.median(times[name])
        print(f'| {name} | {1 / each:.3g} | {each / first:.3g} times as fast |')


main()
