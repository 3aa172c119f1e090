#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Zemax .zmx files: what the command reads, where its rays go, what it says of what it leaves out.

    python3 test_zmx.py SAGITTA

The oracle is zmx_oracle.py, which reads the same files and traces them at 50 digits.  The examples of
tests/data/zmx are real files; their rays.json was worked out by another tracer at 50 digits, and holds the
oracle, too.  All other lenses are written here, from SAGITTA_TEST_SEED (1); SAGITTA_TEST_SCALE (0.5) multiplies
how many.  Each lens is traced as .zmx and as the YAML that `sagitta import` makes of it: the same bytes.
"""
import csv
import hashlib
import io
import json
import math
import os
import pathlib
import random
import re
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / 'tool'))
from command import *  # noqa: E402
import zmx_oracle  # noqa: E402

SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'), 0)
SCALE = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))
DATA = HERE.parent / 'data' / 'zmx'
os.environ['SAGITTA_GLASS'] = str(zmx_oracle.GLASSES)
EXAMPLES = json.loads((DATA / 'rays.json').read_text(), parse_float=zmx_oracle.D, parse_int=int)
PARAXIAL = 'DeepLens__zemax_double_gaussian__e5f0f7.zmx'
REMARK = re.compile(r'(?!sagitta: )(?P<file>[^\n]*?):(?P<line>\d+): (?P<key>\S+): (?P<words>.+)')
ERROR_AT = re.compile(r'sagitta: (?P<file>[^\n]*?):(?P<line>\d+): (?P<key>\S+): (?P<words>.+)')
# A whole file may be at fault, and then there is no line.
ERROR = re.compile(r'sagitta: (?P<file>[^\n]*?)(?::(?P<line>\d+))?: (?P<words>.+)')
# Apertures that an importer may leave out, if it says so of each.
MAY_BE_LEFT_OUT = ('SQOB', 'ELOB', 'SPID')
left_out = set()
worst = {}  # the largest difference over its tolerance, of each test


def several(count):
    return max(1, round(count * SCALE))


def some(cases):
    """All, but for a sanitized command every third."""
    return cases if SCALE >= 0.1 else cases[SEED % 3::3]


# ------------------------------------------------------------------ lenses of our own

def glas(name, code=0, pickup=0, nd=1.5, vd=40, more=0):
    """A record of glass; the nd and vd of the default are those that OpticStudio writes beside any name."""
    return f'{name} {code} {pickup} {nd!r} {vd!r} {more!r} 0 0 0 0 0 '


def surf(kind='STANDARD', c=0.0, t=0.0, k=0.0, glass=None, parm=(), xdat=(), more=(), diam='3 0'):
    """The records of one surface; kind None writes no TYPE."""
    out = [f'TYPE {kind}'] if kind else []
    out += [f'CURV {c!r} 0 0 0 0 ""', 'MIRR 2 0']
    parm = parm.items() if isinstance(parm, dict) else enumerate(parm, 1)
    out += [f'PARM {i} {v!r}' for i, v in parm]
    out += [f'XDAT {i} {v!r} 0 0 1.0 0.0 0 ""' for i, v in enumerate(xdat, 1)]
    out.append(f'DISZ {"INFINITY" if t == math.inf else repr(t)}')
    if glass:
        out.append(f'GLAS {glass}')
    if k:
        out.append(f'CONI {k!r}')
    return out + [f'DIAM {diam} 0 0 1 ""', *more]


MIRROR = glas('MIRROR')
FAR = surf(t=math.inf)
IMAGE = surf()


def zmx(*surfaces, system=(), after=(), unit='MM', waves=(0.5875618,), primary=1, gcat='SCHOTT', indent='  ',
        end='\n'):
    """A file: the object first, the image last."""
    lines = ['VERS 140730 73 26155', 'MODE SEQ', 'NAME written by test_zmx.py',
             f'UNIT {unit} X W X CM MR CPMM', 'ENPD 4', 'ENVD 2.0E+1 1 0', f'GCAT {gcat}',
             'RAIM 0 0 1 1 0 0 0 0 0',
             f'FTYP 0 0 1 {len(waves)} 0 0 0', 'XFLN 0 0 0 0', 'YFLN 0 0 0 0', 'FWGN 1 1 1 1',
             *(f'WAVM {i} {w!r} 1' for i, w in enumerate(waves, 1)),
             f'WAVM {len(waves) + 1} 0.55 1', f'PWAV {primary}', *system]
    for i, records in enumerate(surfaces):
        lines += [f'SURF {i}'] + [indent + r for r in records]
    return end.join([*lines, *after, 'MNUM 1 1', ''])


def launches(generator, count, half=3.0, slope=0.06, z=-2.0, centre=(0.0, 0.0)):
    """Rays as six doubles."""
    def u(a):
        return generator.uniform(-a, a)
    return [(centre[0] + u(half), centre[1] + u(half), z, u(slope), u(slope), 1.0) for _ in range(count)]


# ------------------------------------------------------------------ the comparison

def table_of(output):
    out = {}
    for row in csv.DictReader(io.StringIO(output)):
        out.setdefault(int(row['ray']), []).append(row)
    return out


def differences(what, frame, rows, steps, length, tolerance, local_of=lambda step: True):
    """What differs between the rows of one ray and the oracle's steps, each as a line of words."""
    if len(rows) != len(steps):
        told = f"{rows[-1]['fate']} at element {rows[-1]['element']}" if rows else 'no rows'
        return [f'{what}: {told}; the oracle: {steps[-1].fate} at element {steps[-1].element} '
                f'(surface {steps[-1].surface}, {steps[-1].type})']
    out = []
    for row, step in zip(rows, steps):
        at = f'{what}, element {step.element} (surface {step.surface}, {step.type}), {frame}'
        if (int(row['element']), row['fate']) != (step.element, step.fate):
            out.append(f"{at}: {row['fate']} at element {row['element']}, not {step.fate}")
            continue
        if step.fate == 'missed':
            continue
        wanted = {'t': step.t} if step.opl is None else {'t': step.t, 'opl': step.opl}
        if frame == 'global' or local_of(step):
            wanted.update(zip('xyz', step.local if frame == 'local' else step.everywhere))
            if step.fate == 'passed':
                wanted.update(zip('lmn', step.local_direction if frame == 'local' else step.direction))
        for column, value in wanted.items():
            scale = tolerance * (1 if column in 'lmn' else length)
            apart = abs(float(zmx_oracle.D(row[column]) - value)) if row[column] != 'nan' else math.inf
            test = sys._getframe(2).f_code.co_name
            worst[test] = max(worst.get(test, 0), apart / scale)
            if not apart <= scale:
                out.append(f'{at}: {column} = {row[column]}, not {float(value)!r}: {apart:.3g} apart, '
                           f'{scale:.1g} allowed')
    return out


def remarks(stderr, path):
    """The remarks: each line names the file, a line and a keyword."""
    out = []
    for line in stderr.splitlines():
        m = REMARK.fullmatch(line)
        assert m and m['file'] == str(path), f'not a remark of {path}: {line!r}'
        out.append((int(m['line']), m['key'], m['words']))
    return out


def imported(path, *more):
    """The YAML of a file beside it, and the remarks."""
    lens = path.with_suffix('.yaml')
    done = run('import', path, '-o', lens, *more)
    equal(done.stdout, '', 'standard output beside -o')
    return lens, remarks(done.stderr, path)


def compare(what, data, launch, um=None, more=(), tolerance=1e-11, apertures=True, name='lens.zmx'):
    """Every row of every ray against the oracle, in both frames, and the YAML's bytes against the .zmx's."""
    compare.count += 1
    path, beam = written(data, name), written(rays(*launch), 'rays.csv')
    lens, traces, faults = zmx_oracle.Lens(path.read_bytes()), [], []
    more = (*more, *(() if apertures else ('--no-apertures',)))
    try:
        i = more.index('--glass') if '--glass' in more else len(more)
        other, said = imported(path, *more[i:i + 2])
        for keyword in MAY_BE_LEFT_OUT:
            count = sum(int((re.search(r'\((\d+) times\)', words) or [0, 1])[1])
                        for _, key, words in said if key == keyword)
            if count:
                equal(count, sum(s.without(keyword) for s in lens.surfaces), f'{what}: remarks on {keyword}')
                left_out.add(keyword)
        traces = [lens.trace(r[:3], r[3:], um, apertures) for r in launch]
        for frame in ('local', 'global'):
            how = ('--rays', beam, '--format', 'csv', '--frame', frame, *more)
            plain = run('trace', path, *how).stdout
            # The YAML of one lens in its local frames, of the next in the global one.
            turn = frame == ('local', 'global')[compare.count % 2]
            yaml = run('trace', other, *how).stdout if turn else plain
            if plain != yaml:
                both = zip(plain.splitlines() + [''], yaml.splitlines() + [''])
                pair = next((p for p in both if p[0] != p[1]), 'their ends')
                faults.append(f'{what}: as .zmx and as YAML ({frame}): {pair[0]!r}, {pair[1]!r}')
            got = table_of(plain)
            for i, steps in enumerate(traces):
                if any(step.hair for step in steps):
                    continue
                # A plane that is tilted has a frame of its own, turned: only the global one is the same.
                faults += differences(f'{what}, ray {i} {launch[i]}', frame, got.get(i, []), steps,
                                      lens.length, tolerance, lambda step: step.type != 'TILTSURF')
    except AssertionError as error:
        faults.append(f'{what}: {error}')
    if faults:
        text = data if isinstance(data, str) else '(an example, or bytes)'
        raise AssertionError('\n'.join(faults[:12] + [f'... {len(faults)} in all, seed {SEED}', text]))
    return traces


compare.count = 0


def passed(traces, share):
    """A test of rays that do not arrive is none."""
    through = sum(steps[-1].fate == 'passed' for steps in traces)
    assert through >= share * len(traces), f'only {through} of {len(traces)} rays pass'


# ------------------------------------------------------------------ examples

def example_rays(name):
    """(field, wavelength, aim, launch, what is expected) of an example."""
    lens = EXAMPLES[name]
    for field, wave, aim, px, py, sx, sy, *wanted in lens['rays']:
        launch = tuple(map(float, (px, py, lens['pupil_z'], sx, sy, 1)))
        exactly = zmx_oracle.D(px), zmx_oracle.D(py), lens['pupil_z'], sx, sy, 1
        yield field, wave, aim, launch, exactly, wanted


def test_examples_are_unchanged():
    for name, lens in EXAMPLES.items():
        equal(hashlib.sha256((DATA / name).read_bytes()).hexdigest(), lens['sha256'], name)
    equal(sorted(p.name for p in DATA.glob('*.zmx')), sorted(EXAMPLES))


def test_oracle_against_examples():
    """The oracle agrees with rays.json, to the digits printed there."""
    for name in EXAMPLES:
        lens = zmx_oracle.Lens((DATA / name).read_bytes())
        for field, wave, aim, _, exactly, wanted in example_rays(name):
            last = lens.trace(exactly[:3], exactly[3:], lens.wavelengths[wave - 1], apertures=False)[-1]
            if wanted[0] == 'tir':
                equal((last.fate, last.surface), tuple(wanted), f'{name} {field} {wave} {aim}')
                continue
            equal((last.fate, last.surface), ('passed', EXAMPLES[name]['image']))
            got = [*last.local, *last.local_direction, *last.everywhere, *last.direction]
            for a, b in zip(got, wanted):
                close(a - b, 0, 1e-17 * lens.length, f'{name} {field} {wave} {aim}')


def test_examples_against_references():
    """Chief rays and the four at the stop's edge: at the image, in its frame and in that of surface 1."""
    faults = []
    for name in EXAMPLES:
        length = zmx_oracle.Lens((DATA / name).read_bytes()).length
        for wave in sorted({r[1] for r in example_rays(name)}):
            these = [r for r in example_rays(name) if r[1] == wave]
            beam = written(rays(*(r[3] for r in these)), 'rays.csv')
            for frame, columns in (('local', slice(0, 6)), ('global', slice(6, 12))):
                got = table_of(run('trace', DATA / name, '--rays', beam, '--no-apertures', '--format', 'csv',
                                   '--frame', frame, '--wavelength', wave).stdout)
                for i, (field, _, aim, launch, _, wanted) in enumerate(these):
                    last = got[i][-1]
                    what = f'{name}, field {field}, wavelength {wave}, {aim}, {frame}'
                    if wanted[0] == 'tir':
                        equal((last['fate'], last['element']), ('tir', str(wanted[1])), what)
                        continue
                    if last['fate'] != 'passed':
                        faults.append(f"{what}: {last['fate']} at element {last['element']}")
                        continue
                    for column, value in zip('xyzlmn', wanted[columns]):
                        apart = abs(float(zmx_oracle.D(last[column]) - value))
                        scale = 1e-10 * (1 if column in 'lmn' else length)
                        worst['examples'] = max(worst.get('examples', 0), apart / scale)
                        if not apart <= scale:
                            faults.append(f'{what}: {column} = {last[column]}, not {float(value)!r}')
    assert not faults, '\n'.join(faults[:20])


def test_examples_at_each_surface():
    """The same rays at every surface, with the apertures of the files and without; as YAML the same bytes."""
    faults = []
    for name in EXAMPLES:
        data = (DATA / name).read_bytes()
        for wave in sorted({r[1] for r in example_rays(name)}):
            launch = [r[3] for r in example_rays(name) if r[1] == wave]
            um = float(EXAMPLES[name]['wavelengths'][wave - 1])
            clips = any(s.apertures for s in zmx_oracle.Lens(data).surfaces)
            for apertures in (True, False) if clips else (True,):
                try:
                    compare(f'{name}, wavelength {wave}', data, launch, um, ('--wavelength', wave), name=name,
                            apertures=apertures)
                except AssertionError as error:
                    faults.append(str(error))
    assert not faults, '\n'.join(faults[:20])


def test_primary_wavelength():
    """Without --wavelength the primary one; `2` is the second of the file, `0.6` micrometres."""
    waves = (0.4861327, 0.5875618, 0.6562725)
    launch = launches(random.Random(SEED), 4)
    for primary in (1, 2, 3):
        data = zmx(FAR, surf(c=0.03, t=4.0, glass=glas('N-BK7')), surf(c=-0.02, t=40.0), IMAGE, waves=waves,
                   primary=primary)
        compare(f'primary {primary}', data, launch)
        for wave in (1, 2, 3):
            compare(f'wavelength {wave}', data, launch, waves[wave - 1], ('--wavelength', wave))
        compare('0.6 um', data, launch, 0.6, ('--wavelength', '0.6'))


def test_a_lens_of_powers():
    """PARAX_XY of one power is PARAXIAL of its reciprocal; of none, a plane."""
    launch = written(rays(*launches(random.Random(SEED), 5)))
    for power, other in ((0.0125, surf('PARAXIAL', parm=[80.0, 1], t=4.0)), (0.0, surf(t=4.0))):
        got = [run('trace', written(zmx(FAR, surf(t=1.0), s, IMAGE), 'lens.zmx'), '--rays', launch, '--format', 'csv').stdout
               for s in (surf('PARAX_XY', parm=[power, power], t=4.0), other)]
        equal(*got)
    text = imported(written(zmx(FAR, surf('PARAX_XY', parm=[0.0, -0.02], t=4.0), IMAGE), 'lens.zmx'))[0].read_text()
    assert 'type: ideal, focal_length: .inf, focal_length_y: -50,' in text, text


def test_facets():
    """A FRESNELS is a plane with facets.  Rays bend as at the sag that is described; behind it there is no path."""
    facets = dict(c=-0.04, k=-0.6, parm=[0.0, 1e-6])
    path = written(zmx(FAR, surf('FRESNELS', t=50.0, glass=glas('N-BK7'), **facets), IMAGE), 'lens.zmx')
    text = imported(path)[0].read_text()
    assert re.search(r'type: plane,[^\n]* facets: \{type: even_asphere, radius: -25, conic: -0.6, '
                     r'coefficients: \[0, 1e-06\]\}', text), text
    row = [r for r in rows('trace', path, '--rays', written(rays((0, 3, -1, 0, 0, 1)))) if r['element'] == '1'][0]
    equal((float(row['y']), float(row['z']), row['opl']), (3.0, 0.0, 'nan'))
    no, said = ended('opd', path)
    assert no.returncode == 3 and 'facets' in said, said
    # a slope of 2 at the rim: light along the surface comes to a facet from behind, and is lost
    steep = written(zmx(FAR, surf('FRESNELS', t=50.0, glass=glas('N-BK7'), parm=[0.5]), IMAGE), 'lens.zmx')
    both = written(rays((0, 2, -0.1, 0, 1, 0.1), (0, 2, -0.1, 0, -1, 0.1)))
    fates = [r['fate'] for r in rows('trace', steep, '--rays', both, exit=1) if r['element'] == '1']
    equal(fates, ['lost', 'passed'])


def test_an_ideal_lens():
    """PARAXIAL is read as an ideal lens; traced it is compared above."""
    path = written((DATA / PARAXIAL).read_bytes(), PARAXIAL)
    lens, _ = imported(path)
    assert re.search(r'type: ideal\b[^\n]*focal_length: 100(\.0*)?\b', lens.read_text()), lens.read_text()
    equal(run('trace', path, '--fan', 3, '--format', 'csv').stdout, run('trace', lens, '--fan', 3, '--format', 'csv').stdout)


# ------------------------------------------------------------------ surface types

def sign(generator):
    return generator.choice((-1, 1))


def of_type(kind, generator):
    """Random keywords of a surface of this type that rays within 5 of the axis meet once."""
    u, c = generator.uniform, sign(generator) * generator.uniform(0.01, 0.04)
    k = generator.choice((0.0, -1.0, u(-3, 1)))
    if kind == 'STANDARD':
        return dict(c=generator.choice((c, c, c, 0.0, 6.3e-18)), k=k)
    if kind == 'EVENASPH':
        powers = [u(-1, 1) * 10.0 ** -(1 + 2 * i) for i in range(1, 9)]
        return dict(c=generator.choice((c, 0.0)), k=k, parm=powers)
    if kind == 'ODDASPHE':
        return dict(c=c, k=k, parm=[u(-1, 1) * 10.0 ** -(1 + i) for i in range(1, 9)])
    if kind == 'TOROIDAL':
        radius = generator.choice((0.0, sign(generator) * u(25, 60)))
        return dict(c=c, k=k, parm=[radius] + [u(-1, 1) * 10.0 ** -(1 + 2 * i) for i in range(1, 8)])
    if kind == 'BICONICX':
        radius = generator.choice((0.0, sign(generator) * u(25, 60)))
        return dict(c=generator.choice((c, 0.0)), k=k, parm=[radius, u(-2, 1)])
    if kind == 'XPOLYNOM':
        count = generator.choice((2, 5, 9, 14, 20))
        return dict(c=c, k=k, xdat=[count, u(5, 20)] + [u(-0.1, 0.1) for _ in range(count)])
    if kind == 'PARAXIAL':
        return dict(parm=[sign(generator) * u(25, 60), 1])
    if kind == 'PARAX_XY':
        return dict(parm=[generator.choice((0.0, sign(generator) / u(25, 60))), sign(generator) / u(25, 60)])
    if kind == 'FRESNELS':
        powers = [u(-1, 1) * 10.0 ** -(2 + 2 * i) for i in range(1, 9)] if generator.random() < 0.5 else []
        return dict(c=c / 2, k=k, parm=powers)
    if kind == 'TILTSURF':
        return dict(parm=[u(-0.15, 0.15), u(-0.15, 0.15)])
    if kind == 'IRREGULA':
        moved = [u(-1, 1), u(-1, 1), u(-8, 8), u(-8, 8)] if generator.random() < 0.5 else [0.0] * 4
        return dict(c=c, k=k, parm=[*moved, *(u(-0.05, 0.05) for _ in range(3)), generator.choice((0.0, u(-90, 90)))])
    if kind in ('XASPHERE', 'XODDASPH'):
        count = generator.randint(1, 8 if kind == 'XASPHERE' else 16)
        return dict(c=c, k=k, xdat=[count, u(6, 12)] + [u(-0.05, 0.05) for _ in range(count)])
    if kind == 'QED_TYPE':
        which, count = generator.randint(0, 1), generator.randint(1, 8)
        return dict(c=c, k=k, xdat=[which, count, u(6, 9)] + [u(-0.05, 0.05) for _ in range(count)])
    if kind in ('FZERNSAG', 'SZERNSAG'):
        count = generator.randint(1, 37)
        evens = [u(-1, 1) * 10.0 ** -(2 + 2 * i) for i in range(1, 9)] if generator.random() < 0.5 else []
        return dict(c=c, k=k, parm={0: 1.0, **dict(enumerate(evens, 1))},
                    xdat=[count, u(6, 9)] + [u(-0.01, 0.01) for _ in range(count)])
    if kind == 'DGRATING':
        return dict(c=generator.choice((c, 0.0)), k=k, parm=[u(-0.3, 0.3), generator.choice((-2, -1, 0, 1, 2, 3))])
    if kind in ('BINARY_1', 'BINARY_2'):
        count = generator.choice((2, 5, 9)) if kind == 'BINARY_1' else generator.randint(1, 11)
        evens = [u(-1, 1) * 10.0 ** -(2 + 2 * i) for i in range(1, 9)] if generator.random() < 0.5 else []
        return dict(c=c, k=k, parm={0: generator.choice((1.0, -1.0, 2.0)), **dict(enumerate(evens, 1))},
                    xdat=[count, u(6, 9)] + [u(-900, 900) for _ in range(count)])
    if kind == 'BINARY_3':
        count, same = generator.randint(0, 3), generator.random() < 0.3
        inner = u(1.2, 2.5)
        terms = [u(-1, 1) * (900 if i % 2 else 10.0 ** -(2 + 2 * (i // 4))) for i in range(4 * count)]
        if same:
            terms[2::4] = terms[0::4]
        return dict(c=c, k=k, parm=[1 / c if same else sign(generator) * u(25, 60), k if same else u(-2, 0.5), inner,
                                    u(4, 6), 1, 2], xdat=[count, *terms])
    if kind in ('FZERNPHA', 'SZERNPHA'):
        count = generator.randint(1, 37)
        return dict(c=generator.choice((c, 0.0)), k=k, parm={0: 1.0, 1: 1.0},
                    xdat=[count, u(6, 9)] + [u(-30, 30) for _ in range(count)])
    if kind in ('HOLOGRM1', 'HOLOGRM2'):
        far = generator.choice((1, 1, 1e7))
        return dict(c=generator.choice((c, 0.0)), k=k,
                    parm=[u(-9, 9) * far, u(-9, 9) * far, sign(generator) * u(30, 90) * far, u(-9, 9), u(-9, 9),
                          sign(generator) * u(30, 90), u(0.4, 0.7), generator.choice((-1, 1, 1, 2))])
    raise ValueError(kind)


TYPES = ('STANDARD', 'EVENASPH', 'ODDASPHE', 'TOROIDAL', 'BICONICX', 'XPOLYNOM', 'TILTSURF', 'PARAXIAL', 'PARAX_XY', 'IRREGULA',
         'XASPHERE', 'XODDASPH', 'QED_TYPE', 'FZERNSAG', 'SZERNSAG', 'FRESNELS', *zmx_oracle.PHASES)


def lens_of(kind, generator):
    """Behind a plane: a lens of this type on both sides, a mirror of it, a curved image in front of it."""
    u = generator.uniform
    def one(t, glass=None):
        return surf(kind, t=t, glass=glass, **of_type(kind, generator))
    return zmx(FAR, surf(t=u(1, 3)), one(u(2, 4), glas('N-BK7')), one(u(5, 9)), one(-u(4, 8), MIRROR),
               surf(c=u(-0.01, 0.01)))


def test_each_type():
    faults = []
    for kind in some(TYPES):
        generator = random.Random(f'{SEED} {kind}')
        through = []
        for trial in range(several(4)):
            data, launch = lens_of(kind, generator), launches(generator, 10)
            try:
                through += compare(f'{kind}, lens {trial}', data, launch)
            except AssertionError as error:
                faults.append(str(error))
        if not faults:
            passed(through, 0.8)
    assert not faults, '\n'.join(faults[:5])


def test_terms_that_are_zero():
    """Types without terms are what is left of them; terms beyond those counted, and zeros behind the last, go."""
    generator = random.Random(f'{SEED} zero terms')
    for kind, how in (('IRREGULA', dict(parm=[0.0] * 8)), ('XASPHERE', dict(xdat=[0, 0.0])),
                      ('QED_TYPE', dict(xdat=[0, 0, 0.0], k=-0.5)), ('FZERNSAG', dict(xdat=[0, 0.0])),
                      ('SZERNSAG', dict(xdat=[3, 5.0, 0.0, 0.0, 0.0])), ('XODDASPH', dict(xdat=[1, 5.0, 0.0, 7.0]))):
        data = zmx(FAR, surf(t=2.0), surf(kind, c=0.02, t=4.0, glass=glas('N-BK7'), **how), IMAGE)
        compare(kind, data, launches(generator, 5))
        yaml = imported(written(data, 'lens.zmx'))[0].read_text()
        assert re.search('type: (sphere|conic), radius: 50', yaml), yaml


def test_numbers_that_a_type_has_no_use_for():
    """They are told, each by its record."""
    for kind, how, key in (('EVENASPH', dict(parm={0: 3.0}), 'PARM'), ('STANDARD', dict(parm={0: 1.0}), 'PARM'),
                           ('XASPHERE', dict(xdat=[1, 5.0, 0.1, 0.2]), 'XDAT'), ('TOROIDAL', dict(xdat=[0, 5.0, 0.1]), 'XDAT'),
                           ('QED_TYPE', dict(xdat=[1, 1, 5.0, 0.1, 0.2]), 'XDAT'),
                           ('STANDARD', dict(more=['GDAT 4 4 1 1 0 0']), 'GDAT')):
        data = zmx(FAR, surf(kind, c=0.02, t=4.0, **how), IMAGE)
        _, said = imported(written(data, 'lens.zmx'))
        assert [word for _, word, words in said if 'left out: a number' in words] == [key], (kind, key, said)


def test_grid():
    """At its heights: of the grid, of the conic and the powers beside it, of the Zernike terms.  Rows run to -y."""
    generator, faults = random.Random(f'{SEED} grid'), []
    for trial in range(several(8)):
        u = generator.uniform
        nx, ny, dx, dy = generator.randint(5, 9), generator.randint(5, 9), u(0.5, 1.5), u(0.5, 1.5)
        heights = [[u(-0.01, 0.01) for _ in range(nx)] for _ in range(ny)]  # the first row is that of the largest y
        c, k, norm = u(-0.03, 0.03), u(-2, 0.5), u(8, 12)
        evens = [u(-1e-4, 1e-4), u(-1e-6, 1e-6)] if trial % 2 else []
        terms = [u(-0.01, 0.01) for _ in range(generator.choice((0, 3, 15)))]
        flat = [z for row in heights for z in row]
        more = [f'GDAT {nx} {ny} {dx!r} {dy!r} 0 0', *(f'GARR {i} {z!r} 0 0 0 0' for i, z in enumerate(flat))]
        data = zmx(FAR, surf(t=5.0), surf('GRID_SAG', c=c, k=k, t=9.0, parm=evens, xdat=[len(terms), norm, *terms],
                                          more=more), IMAGE)
        points = [((j - (nx - 1) / 2) * dx, ((ny - 1) / 2 - i) * dy, z) for i, row in enumerate(heights)
                  for j, z in enumerate(row)]
        beam = written(rays(*((x, y, -1, 0, 0, 1) for x, y, _ in points)))
        path = written(data, 'lens.zmx')
        out = [row for row in csv.DictReader(run('trace', path, '--rays', beam, '--format', 'csv').stdout.splitlines())
               if row['element'] == '2']
        assert len(out) == len(points)
        for row, (x, y, z) in zip(out, points):
            r2 = x * x + y * y
            wanted = z + zmx_oracle.conic(c, k, r2, math.sqrt)[0] + sum(a * r2 ** (i + 1) for i, a in enumerate(evens))
            wanted += sum(a * zmx_oracle.zernike(j, False, x / norm, y / norm, 0.0)[0] for j, a in enumerate(terms, 1))
            inside = abs(x) < (nx - 1) / 2 * dx and abs(y) < (ny - 1) / 2 * dy  # its edge may be missed
            if row['fate'] != 'passed' and not inside:
                continue
            if row['fate'] != 'passed' or abs(float(row['z']) - wanted) > 1e-12:
                faults.append(f'{trial}: {row} and not {wanted}')
    assert not faults, '\n'.join(faults[:4])
    short = data.replace(f'GARR {len(flat) - 1} ', 'COMM GARR ')
    refused(short, 'GDAT', [line_of(short, 'GDAT')], f'{len(flat) - 1} of the {len(flat)}')
    hole = data.replace('GARR 3 ', 'GARR 4 ')
    refused(hole, 'GARR', [line_of(hole, 'GARR 4 ')], 'height 4 is where height 3 should be')


def test_types_mixed():
    """Many surfaces of all types one after another, with breaks between them."""
    generator = random.Random(f'{SEED} mixed')
    for trial in range(several(4)):
        surfaces, glass = [FAR, surf(t=1.0)], False
        for _ in range(12):
            if generator.random() < 0.3:
                surfaces.append(coordinate_break(generator, 0.02))
            kind = generator.choice(TYPES)
            glass = not glass
            surfaces.append(surf(kind, t=generator.uniform(0.5, 2), glass=glas('N-SF6') if glass else None,
                                 **{**of_type(kind, generator)}))
        compare(f'lens {trial}', zmx(*surfaces, IMAGE), launches(generator, 8, 1.5, 0.02))


# ------------------------------------------------------------------ breaks

def coordinate_break(generator, amount=1.0, order=None, tilt=25):
    u = generator.uniform
    order = generator.choice((0, 1)) if order is None else order
    return surf('COORDBRK', t=u(-2, 2) * amount,
                parm=[u(-1, 1) * amount, u(-1, 1) * amount, *(u(-tilt, tilt) * amount for _ in range(3)), order])


def test_breaks():
    """Both orders, large tilts, their thicknesses, several in a row, in glass and in front of all."""
    generator = random.Random(f'{SEED} breaks')
    for order in (0, 1, 2, -1):
        for trial in range(several(2)):
            def b(tilt=12):  # five of 25 degrees would leave rays along the surfaces
                return coordinate_break(generator, order=order, tilt=tilt)
            data = zmx(FAR, surf(t=3.0), b(), surf(c=0.02, t=4.0, glass=glas('N-BK7')), b(),
                       surf(c=-0.02, t=5.0), b(), b(), surf(c=-0.01, t=-6.0, glass=MIRROR), b(), IMAGE)
            compare(f'order {order}, lens {trial}', data, launches(generator, 8, 1.0))
            data = zmx(FAR, b(25), b(25), surf(t=3.0), surf(c=0.01, t=2.0), IMAGE)
            compare(f'order {order}, a break in front of all, {trial}', data, launches(generator, 8, 1.0))


def test_a_break_undone():
    """Order 1 with all signs changed undoes order 0: the image is where it was."""
    v = [0.7, -0.4, 12.0, -8.0, 25.0]
    generator = random.Random(f'{SEED} undone')
    launch = launches(generator, 5, 1.0)
    ends = []
    for orders in ((0, 1), (1, 0)):
        path = written(zmx(FAR, surf(t=3.0), surf('COORDBRK', parm=[*v, orders[0]]),
                           surf('COORDBRK', parm=[*(-x for x in v), orders[1]], t=5.0), IMAGE), 'lens.zmx')
        out = run('trace', path, '--rays', written(rays(*launch)), '--format', 'csv').stdout
        ends.append([r[-1] for r in table_of(out).values()])
    for launched, a, b in zip(launch, *ends):
        for row in (a, b):
            close(row['x'], launched[0] + 10 * launched[3], 1e-13)
            close(row['y'], launched[1] + 10 * launched[4], 1e-13)


def test_tilts_are_right_handed():
    """A break of +45 about x, a mirror, +45 again: light from +z goes to +y, whatever writes it."""
    folds = {
        'breaks': [surf('COORDBRK', parm=[0, 0, 45.0]), surf(glass=MIRROR),
                   surf('COORDBRK', parm=[0, 0, 45.0], t=-20.0)],
        'SCBD': [surf(glass=MIRROR, t=-20.0, more=['SCBD 1 0 0 0 0 4.5E+1 0 0', 'SCBD 2 0 0 0 0 45 0 0'])]}
    for name, fold in folds.items():
        data = zmx(FAR, surf(t=10.0), *fold, IMAGE)
        [steps] = compare(name, data, [(0.0, 0.0, -1.0, 0.0, 0.0, 1.0)])
        for got, wanted in zip(steps[-1].everywhere, (0, 20, 10)):
            close(got, wanted, 1e-40, name)


def test_breaks_of_a_surface():
    """SCBD 1 before, SCBD 2 behind, in both orders, on sags, mirrors, the first surface and the image."""
    generator = random.Random(f'{SEED} SCBD')
    u = generator.uniform

    def scbd(which, mode=0):
        return (f'SCBD {which} {generator.choice((0, 1))} {mode} {u(-1, 1)!r} {u(-1, 1)!r} '
                f'{u(-20, 20)!r} {u(-20, 20)!r} {u(-20, 20):.12E}')
    for trial in range(several(4)):
        data = zmx(FAR, surf(t=3.0, more=[scbd(1)] if trial % 2 else []),
                   surf(c=0.02, t=4.0, glass=glas('N-BK7'), more=[scbd(1)]),
                   surf('EVENASPH', t=5.0, more=[scbd(1), scbd(2)], **of_type('EVENASPH', generator)),
                   surf(c=-0.01, t=-6.0, glass=MIRROR, more=[scbd(2, 2)]), surf(more=[scbd(1)]))
        compare(f'lens {trial}', data, launches(generator, 8, 1.0))


# ------------------------------------------------------------------ apertures

def aperture(name, generator):
    """Records, and the semi-diameter beside them, of which only FLAP takes notice."""
    u = generator.uniform
    a, b, x, y = u(0.3, 1), u(1.5, 2.5), u(0.8, 2), u(0.8, 2)
    record = {'CLAP': f'CLAP 0 {b!r} 0', 'CLAP with a hole': f'CLAP {a!r} {b!r} 0', 'FLAP': f'FLAP 0 {b!r} 0',
              'OBSC': f'OBSC 0 {a!r} 0', 'OBSC of a ring': f'OBSC {a!r} {b!r} 0',
              'SQAP': f'SQAP {x!r} {y!r} 0', 'SQOB': f'SQOB {x!r} {y!r} 0',
              'ELAP': f'ELAP {x!r} {y!r} 0', 'ELOB': f'ELOB {x!r} {y!r} 0'}[name]
    return record, f'{b!r} 1' if name == 'FLAP' else '0.7 1'


def test_apertures():
    """Which rays are clipped, on a plane, a sag, a mirror; centred and moved by OBDC.  DIAM never clips."""
    faults = []
    for name in ('CLAP', 'CLAP with a hole', 'FLAP', 'OBSC', 'OBSC of a ring', 'SQAP', 'SQOB', 'ELAP',
                 'ELOB'):
        generator = random.Random(f'{SEED} {name}')
        u = generator.uniform
        fates = set()
        for moved in (False, True) * several(1):
            def with_aperture(*where, **how):
                record, diam = aperture(name, generator)
                offset = [f'OBDC {u(-0.7, 0.7)!r} {u(-0.7, 0.7):.12E}'] if moved else []
                return surf(*where, **how, diam=diam, more=[record, *offset])
            data = zmx(FAR, surf(t=2.0), with_aperture(t=1.0),
                       with_aperture('EVENASPH', c=0.05, t=1.0, parm=[1e-3, 1e-4], glass=glas('N-BK7')),
                       with_aperture(c=-0.02, t=-1.0, glass=MIRROR), IMAGE)
            try:
                for steps in compare(f'{name}, moved {moved}', data, launches(generator, 60, 2.2, 0.1)):
                    fates.add((steps[-1].fate, steps[-1].element))
            except AssertionError as error:
                faults.append(str(error))
        if name not in left_out and (len(fates) < 3 or ('passed', 5) not in fates):
            faults.append(f'{name}: not tested by these rays, seed {SEED}: {fates}')
    assert not faults, '\n'.join(faults[:5])


def test_diam_never_clips():
    """A flag of 0, 1 or 2, the stop, a surface of glass: a semi-diameter alone stops no ray."""
    data = zmx(FAR, surf(t=2.0, diam='0.5 0'), surf(t=2.0, diam='0.5 1', more=['STOP']),
               surf(c=0.02, t=2.0, glass=glas('N-BK7'), diam='0.5 2'), surf(t=4.0, diam='0.5 1'),
               surf(diam='0.5 1'))
    passed(compare('DIAM', data, launches(random.Random(SEED), 20)), 1)


def test_a_spider():
    """SPID: its width, then how many arms, the first along +x."""
    generator = random.Random(f'{SEED} spider')
    for arms in (1, 3, 4):
        data = zmx(FAR, surf(t=2.0), surf(t=2.0, more=[f'SPID 0.8 {arms} 0']), IMAGE)
        fates = {s[-1].fate for s in compare(f'{arms} arms', data, launches(generator, 60))}
        assert 'SPID' in left_out or fates == {'passed', 'clipped'}, fates


def test_an_aperture_of_a_file():
    """UDAD has its outline in another file: never without a remark."""
    said = of_line('UDAD', zmx(FAR, surf(t=2.0), surf(t=2.0, more=['UDAD 0 0 "outline.uda"']), IMAGE))
    assert said, 'UDAD: no remark'


# ------------------------------------------------------------------ media

def test_glass_codes():
    """0 the catalogue, 1 a model, 2 a pickup, 3 a substitute: the name; what else the line has is junk."""
    launch = launches(random.Random(f'{SEED} codes'), 6)
    curved = dict(c=0.05, t=4.0)
    for what, glass in [
            ('catalogue', glas('N-SF6', 0, 0, 1.5, 40)), ('catalogue, no values', 'N-SF6'),
            ('catalogue, zeros', glas('N-SF6', 0, 0, 0, 0)), ('small letters', glas('n-sf6')),
            ('an old name', glas('SK16')), ('model', glas('___BLANK', 1, 0, 1.6207, 60.28, 0.0)),
            ('model with a name', glas('N-SF6', 1, 0, 1.6207, 60.28, 0.0)),
            ('model with dPgF', glas('___BLANK', 1, 0, 1.78472, 25.68, 0.0156)),
            ('model without dispersion', glas('___BLANK', 1, 0, 1.7, 0, 0)),
            ('model in six fields', 'N-SK16 1 0 1.6207046508789062 60.27947998046875'),
            ('substitute', glas('N-LAK34', 3, 0, 1.62041, 60.32)), ('MIL', glas('517642')),
            ('MIL', '805254')]:
        for um in (0.4861327, 0.6328):
            data = zmx(FAR, surf(t=1.0), surf(glass=glass, **curved), surf(c=-0.03, t=20.0), IMAGE,
                       waves=(um,))
            compare(f'{what}: GLAS {glass} at {um}', data, launch)
    # Pickups: of a surface in front and behind, of a model, along a chain, over mirrors.
    data = zmx(FAR, surf(glass=glas('N-BK7'), **curved), surf(t=1.0),
               surf(glass=glas('___BLANK', 2, 1), **curved), surf(t=1.0),
               surf(glass=glas('F2', 2, 7), **curved),
               surf(t=1.0),
               surf(glass=glas('___BLANK', 1, 0, 1.65, 33.8), **curved), surf(t=1.0),
               surf(glass=glas('STALE', 2, 5), c=-0.01, t=1.0), surf(t=3.0), IMAGE)
    compare('pickups', data, launch)
    data = zmx(FAR, surf(glass=glas('___BLANK', 2, 3), **curved), surf(t=1.0),
               surf(glass=glas('SF1'), **curved), IMAGE)
    compare('a pickup of a surface behind', data, launch)


def test_makers():
    """GCAT decides between makers of one name."""
    several_makers = [name for name, glasses in zmx_oracle.table().items() if len(glasses) > 1]
    assert 'BAF10' in several_makers
    launch = launches(random.Random(f'{SEED} makers'), 3)
    seen = set()
    for name in ('BAF10', 'F2', 'SF1'):
        for maker, _, _ in zmx_oracle.table()[name]:
            data = zmx(FAR, surf(c=0.05, t=4.0, glass=glas(name)), surf(c=-0.05, t=30.0), IMAGE,
                       gcat=f'NOBODY {maker} INFRARED')
            steps = compare(f'{maker} {name}', data, launch)
            seen.add((name, steps[0][-1].local[0]))
    assert len(seen) > 3, 'the makers of these names do not differ'


def test_a_catalogue_of_ones_own():
    """--glass of import and of trace: a name that the table has not."""
    c = [1.03961212, 0.00600069867, 0.231792344, 0.0200179144, 1.01046945, 103.560653]
    folder_ = written(f'CC of a test\nNM TRIAL 2 0 1.5168 64.17 0 1 1\nED 7.1 8.3 2.51 -0.0009 0\n'
                      f'CD {" ".join(map(repr, c))}\nTD 0 0 0 0 0 0 20\nLD 0.3 2.5\nIT 0.4 0.9 10\n',
                      'own.agf').parent
    data = zmx(FAR, surf(c=0.05, t=4.0, glass=glas('TRIAL')), surf(t=20.0), IMAGE)
    path = written(data, 'lens.zmx')
    done = run('import', path, exit=BAD_INPUT)
    assert re.search(rf':{line_of(data, "GLAS")}: (GLAS|glass): .*TRIAL', done.stderr), done.stderr
    zmx_oracle.table()['TRIAL'] = [('OWN', 102, c)]
    compare('--glass', data, launches(random.Random(SEED), 4), more=('--glass', folder_))


def test_mirrors_in_glass():
    """A Mangin mirror, a prism: the medium stays behind a mirror and over breaks; air follows no GLAS."""
    launch = launches(random.Random(f'{SEED} mirrors'), 8)
    data = zmx(FAR, surf(t=2.0), surf(c=-0.005, t=4.0, glass=glas('N-BK7')),
               surf(c=-0.01, t=-4.0, glass=MIRROR, k=-0.5), surf(c=-0.005, t=-15.0),
               surf(c=-0.03, t=-2.0, glass=glas('F2')), surf(c=0.02, t=2.0, glass=MIRROR),
               surf(c=-0.03, t=25.0), IMAGE)
    passed(compare('Mangin', data, launch), 0.9)
    data = zmx(FAR, surf(t=2.0), surf(t=10.0, glass=glas('N-BK7')), surf('COORDBRK', parm=[0, 0, 45.0]),
               surf(glass=MIRROR), surf('COORDBRK', parm=[0, 0, 45.0], t=-10.0), surf(t=-5.0), IMAGE)
    passed(compare('prism', data, launch), 0.9)
    data = zmx(FAR, surf(t=2.0), surf(c=0.03, t=1.0, glass=glas('N-BK7')),
               surf('COORDBRK', parm=[0.2, 0.1, 3.0, 2.0, 1.0], t=3.0), surf('COORDBRK', parm=[0, 0, -4.0]),
               surf(c=-0.02, t=20.0), IMAGE)
    passed(compare('breaks in glass', data, launch), 0.9)
    data = zmx(FAR, surf(t=2.0, glass=glas('N-BK7')), surf(t=-2.0, glass=MIRROR),
               surf(c=-0.02, t=3.0, glass=MIRROR), surf(t=2.0, c=0.01), IMAGE)
    passed(compare('two mirrors in glass', data, launch), 0.9)


def test_in_front():
    """An object in glass, at a distance; a virtual propagation; an image in glass."""
    launch = launches(random.Random(f'{SEED} front'), 6, 1.0, z=-30.0)
    data = zmx(surf(t=30.0, glass=glas('N-BK7')), surf(c=0.02, t=-3.0),
               surf(c=-0.01, t=4.0, glass=glas('F2')), surf(c=0.01, glass=glas('N-SF6'), t=77.0))
    compare('glass in front', data, launch)
    lens, _ = imported(written(data, 'lens.zmx'))
    assert re.search(r'distance: 30(\.0*)?\b', lens.read_text()), lens.read_text()
    lens, _ = imported(written(zmx(surf(t=1e10), surf(t=1.0), IMAGE), 'lens.zmx'))
    assert not re.search(r'distance: (?!\.inf)', lens.read_text()), lens.read_text()


def test_units():
    """Lengths stay in the unit of the file; the label says which."""
    launch = launches(random.Random(f'{SEED} units'), 4)
    outputs = set()
    for unit, label in (('MM', 'mm'), ('CM', 'cm'), ('IN', 'in'), ('METER', 'm')):
        data = zmx(FAR, surf(t=2.0), surf('EVENASPH', c=0.02, parm=[0.0, 1e-5], t=4.0, glass=glas('N-BK7')),
                   surf(c=-0.02, t=20.0), IMAGE, unit=unit)
        compare(unit, data, launch)
        lens, _ = imported(written(data, 'lens.zmx'))
        out = lens.read_text()
        assert re.search(rf'^units: ["\']?{label}["\']?\s*$', out, re.MULTILINE), f'{unit}: {out}'
        outputs.add(run('trace', lens, '--rays', written(rays(*launch)), '--format', 'csv').stdout)
    equal(len(outputs), 1)


# ------------------------------------------------------------------ text

def plain_lens(**how):
    return zmx(FAR, surf(t=2.0), surf('EVENASPH', c=0.02, parm=[0.0, 1e-5], t=4.0, glass=glas('N-BK7'),
                                      more=['COMM \u00d818 lens, f=15 mm']),
               surf(c=-0.02, t=20.0, more=['CLAP 0 2.5']), IMAGE, **how)


def test_encodings():
    launch = launches(random.Random(f'{SEED} encodings'), 20)
    beam = written(rays(*launch))
    text = plain_lens()
    compare('UTF-8', text, launch)
    wanted = run('trace', written(text, 'lens.zmx'), '--rays', beam, '--format', 'csv').stdout
    title = run('import', written(text, 'lens.zmx'), binary=True).stdout
    assert '\u00d818 lens, f=15 mm' in title.decode() or r'\xD818 lens, f=15 mm' in title.decode(), title
    for what, data in [
            ('UTF-8 with a mark', text.encode('utf-8-sig')),
            ('UTF-16, little endian, with a mark', b'\xff\xfe' + text.encode('utf-16-le')),
            ('UTF-16, big endian, with a mark', b'\xfe\xff' + text.encode('utf-16-be')),
            ('Latin-1', text.encode('latin-1')),
            ('CR LF', text.replace('\n', '\r\n').encode()),
            ('UTF-16, CR LF', b'\xff\xfe' + text.replace('\n', '\r\n').encode('utf-16-le')),
            ('not indented', plain_lens(indent='').encode()),
            ('by tabs', plain_lens(indent='\t').encode()),
            ('Latin-1, CR LF, not indented', plain_lens(indent='', end='\r\n').encode('latin-1')),
            ('trailing blanks', plain_lens(end='  \n').encode()),
            ('blank lines', plain_lens(end='\n\n').encode())]:
        path = written(data, 'lens.zmx')
        equal(run('trace', path, '--rays', beam, '--format', 'csv').stdout, wanted, what)
        equal(run('import', path, binary=True).stdout, title, what)
    path = written(text, 'LENS.ZMX')  # the ending in capitals
    equal(run('trace', path, '--rays', beam, '--format', 'csv').stdout, wanted, '.ZMX')


def test_numbers():
    """2.0E+1, .5, -0.0, -4.E-1; the rest of a line is not looked at."""
    launch = launches(random.Random(f'{SEED} numbers'), 5)
    def at(c, t, glass=None, k='0'):
        return ['TYPE STANDARD', f'CURV {c}', f'DISZ {t}', *([f'GLAS {glass}'] if glass else []), f'CONI {k}']
    data = zmx(FAR, at('-0.0', '2.0E+0'),
               at('2.E-2 1 2 3 "" x', '.5E1', 'N-BK7 0 0 1.5E+000 4.0E+001', '-4.E-1'),
               at('-.02', '2E+01', None, '-1'), at('0.', '0'))
    compare('numbers', data, launch)


def test_old_and_disordered_records():
    """No TYPE; WAVL and XFLD before FTYP; WAVM wins; free text in NOTE, NAME, COMM."""
    launch = launches(random.Random(f'{SEED} old'), 4)
    body = [FAR, surf(None, t=2.0), surf(None, c=0.03, t=4.0, glass=glas('N-SF6')),
            surf(c=-0.02, t=20.0, more=['COMM GLAS N-BK7']), IMAGE]
    text = zmx(*body, waves=(0.4861327, 0.6562725), primary=2)
    old = re.sub(r'^WAVM .*\n', '', text, flags=re.MULTILINE)
    old = old.replace('UNIT', 'XFLD 0 0\nYFLD 0 5\nWAVL 0.4861327 0.6562725 0.55\nWWGT 1 1 1\nUNIT')
    for what, data in [('plain', text), ('old', old), ('both', text.replace('UNIT', 'WAVL 0.5 0.51\nUNIT')),
                       ('notes', re.sub('^NAME.*', 'NOTE 0 SURF 1\nNOTE 0 MODE NSC\nNAME UNIT IN', text,
                                         flags=re.MULTILINE))]:
        for wave, um in ((1, 0.4861327), (2, 0.6562725)):
            compare(f'{what}, wavelength {wave}', data, launch, um, ('--wavelength', wave))
        compare(f'{what}, the primary one', data, launch, 0.6562725)


def has(where, *patterns, replace=()):
    """The YAML of a lens has these words; its object is 'near' or 'far', its records are replaced first."""
    data = zmx(surf(t=50.0) if where == 'near' else FAR, surf(t=2.0, more=['STOP']),
               surf(c=0.02, t=4.0, glass=glas('N-BK7'), more=['COMM front']), surf(c=-0.02, t=20.0), IMAGE)
    for old, new in replace:
        assert re.search(old, data, re.MULTILINE), old
        data = re.sub(old, new, data, flags=re.MULTILINE)
    lens, _ = imported(written(data, 'lens.zmx'))
    out = lens.read_text()
    for pattern in patterns:
        assert re.search(pattern, out, re.MULTILINE), f'{where}, {replace}: no {pattern!r} in\n{out}'
    run('trace', lens, '--rays', written(rays((0, 0, -1, 0, 0, 1))))  # and the command reads it
    return out


def test_system_records():
    """Pupils, fields, wavelengths and the object, as keys of the YAML."""
    def pupil(record, pattern, where='far'):
        has(where, pattern, replace=[('^ENPD 4$', record)])
    pupil('ENPD 4', r'semi_diameter: 2(\.0*)?\b')
    pupil('FNUM 7.5 0', r'f_number: 7\.5\b')
    pupil('FNUM 7.5 1', r'working_f_number: 7\.5\b')
    pupil('OBNA 0.25 0', r'object_na: 0\.25\b', 'near')
    pupil('OBNA 12.5 1', r'object_angle: 12\.5\b', 'near')
    pupil('FLOA', r'stop_size: true')
    for kind, name in ((1, 'object_height'), (2, 'paraxial_image_height'), (3, 'real_image_height')):
        has('near', rf'field_type: {name}\b', replace=[('^FTYP 0', f'FTYP {kind}')])
    assert not re.search('field_type: (?!angle)', has('far'))
    # Fields keep their order, and are not thinned out; beyond the count there are none.
    three = [('^FTYP 0 0 1 ', 'FTYP 0 0 3 '), ('^YFLN .*$', 'YFLN 5 -3 5 0 0'),
             ('^XFLN .*$', 'XFLN 0 0 0 0 0')]
    out = has('far', replace=three)
    assert re.search(r'fields:\s*\[\s*5(\.0*)?,\s*-3(\.0*)?,\s*5(\.0*)?\s*\]', out), out
    out = has('far', replace=[('^FTYP 0 0 1 ', 'FTYP 0 0 2 '), ('^YFLN .*$', 'YFLN 5 -3 0'),
                              ('^XFLN .*$', 'XFLN 1 2 0')])
    assert re.search(r'fields:\s*\[\s*\[1(\.0*)?, *5(\.0*)?\],\s*\[2(\.0*)?, *-3(\.0*)?\]\s*\]', out), out
    out = has('far', r'primary: 2\b', r'wavelengths:\s*\[\s*0\.4,\s*0\.7\s*\]',
              replace=[('^WAVM 1 .*$', 'WAVM 1 0.4 1'), ('^WAVM 2 .*$', 'WAVM 2 0.7 1'),
                       ('^PWAV 1', 'PWAV 2'), ('^FTYP 0 0 1 1', 'FTYP 0 0 1 2')])
    assert 'wavelength_weights' not in out, out
    has('far', r'wavelength_weights:\s*\[\s*1(\.0*)?,\s*0\.5\s*\]', replace=[
        ('^WAVM 2 .*$', 'WAVM 2 0.7 0.5'), ('^FTYP 0 0 1 1', 'FTYP 0 0 1 2')])
    has('far', r'stop: true', r'front', r'\bSCHOTT\b')


def test_fields_that_are_not_there():
    """Fewer fields than FTYP says, and angles of 90 degrees and more: the others are read, and it is said."""
    text = zmx(FAR, surf(t=2.0, more=['STOP']), surf(c=0.02, t=4.0, glass=glas('N-BK7')), surf(c=-0.02, t=20.0),
               IMAGE)
    def case(count, x, y, weights, *wanted, said, factors=None):
        data = text.replace('FTYP 0 0 1', f'FTYP 0 0 {count}')
        for key, values in (('XFLN', x), ('YFLN', y), ('FWGN', weights)):
            data = re.sub(f'^{key} .*\n', f'{key} {values}\n' if values else '', data, flags=re.MULTILINE)
        if factors:
            data = data.replace('PWAV', f'VCYN {factors}\nPWAV')
        lens, remarks_ = imported(written(data, 'lens.zmx'))
        out = lens.read_text()
        for words in wanted:
            assert words in out, f'{count}, {x}, {y}: no {words} in\n{out}'
        told = [f'{key}: {words}' for _, key, words in remarks_]
        for words in said:
            assert any(words in line for line in told), f'{count}, {x}, {y}: {words} is not in {told}'
        run('spot', lens, '--hexapolar', 2)
        if any('left out' in line for line in told):
            run('import', written(data, 'lens.zmx'), '--strict', exit=BAD_INPUT)
    case(3, '', '1 2', '1 1 1', 'fields: [1, 2]', said=['YFLN: left out: 1 of the 3 fields'])
    case(14, ' '.join('0' * 12), ' '.join(map(str, range(12))), ' '.join('1' * 12),
         'fields: [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]', said=['left out: 2 of the 14 fields'])
    case(2, '3', '1 2', '', 'fields: [[3, 1], [0, 2]]', said=['XFLN: taken as 0 where it lacks a number'])
    case(3, '', '1 2 3', '2', 'field_weights: [2, 1, 1]', said=['FWGN: taken as 1 where it lacks a number'])
    case(2, '', '', '', said=['FTYP: left out: 2 of the 2 fields', 'FTYP: no field is left'])
    case(3, '', '1 95 10', '1 2 3', 'fields: [1, 10]', 'field_weights: [1, 3]', 'cy: 0.2', factors='0 0.1 0.2',
         said=['YFLN: left out: field 2, an angle of 95 degrees'])
    case(2, '-90 0', '0 5', '1 1', 'fields: [5]', said=['XFLN: left out: field 1, an angle of -90 degrees'])
    case(1, '', '90', '', said=['YFLN: left out: field 1', 'FTYP: no field is left'])


def test_objects():
    """A tilted object, and one that touches the first surface.  The stop is a plane in air and comes first, so
    a ray goes straight from the object's point to that of the pupil."""
    generator, radius, faults = random.Random(f'{SEED} objects'), 2.0, []
    for distance, tilted in ((60.0, True), (60.0, False), (0.0, False)):
        slope = [round(generator.uniform(-0.5, 0.5), 3) for _ in 'xy'] if tilted else [0.0, 0.0]
        heights = [(round(generator.uniform(-4, 4), 2), round(generator.uniform(-4, 4), 2)) for _ in range(3)]
        front = 12.5  # from the object, where that is at distance 0, to the stop
        between = [] if distance else [surf(t=front)]
        data = zmx(surf('TILTSURF' if tilted else 'STANDARD', t=distance, parm=slope if tilted else ()),
                   *between, surf(t=2.0, more=['STOP']), surf(c=0.02, t=4.0, glass=glas('N-BK7')),
                   surf(c=-0.02, t=20.0), IMAGE)
        data = data.replace('FTYP 0 0 1', 'FTYP 1 0 3')
        for key, k in (('XFLN', 0), ('YFLN', 1)):
            data = re.sub(f'^{key} .*$', f'{key} ' + ' '.join(str(h[k]) for h in heights), data, flags=re.MULTILINE)
        data = re.sub('^FWGN .*$', 'FWGN 1 1 1', data, flags=re.MULTILINE)
        lens, _ = imported(written(data, 'lens.zmx'))
        stop = 1 + len(between)
        rows = [row for row in csv.DictReader(run('trace', lens, '--grid', 5, '--format', 'csv').stdout.splitlines())
                if int(row['element']) == stop]
        assert len(rows) >= 3 * 12, len(rows)
        for row in rows:
            x, y = heights[int(row['field']) - 1]
            start = (x, y, -(distance or front) + slope[0] * x + slope[1] * y)
            end = (radius * float(row['px']), radius * float(row['py']), 0.0)
            way = [b - a for a, b in zip(start, end)]
            length = math.sqrt(sum(w * w for w in way))
            wanted = [*end[:2], *(w / length for w in way)]
            got = [float(row[key]) for key in ('x', 'y', 'l', 'm', 'n')]
            if max(abs(a - b) for a, b in zip(got, wanted)) > 1e-12:
                faults.append(f'{distance}, {slope}: {got} and not {wanted}')
        run('spot', lens)
        real = re.sub('^FTYP 1', 'FTYP 3', data, flags=re.MULTILINE)
        ends = csv.DictReader(run('trace', written(real, 'lens.zmx'), '--chief', '--format', 'csv').stdout.splitlines())
        for row in ends:
            if int(row['element']) == stop + 3:
                wanted = heights[int(row['field']) - 1]
                if math.dist((float(row['x']), float(row['y'])), wanted) > 1e-8:
                    faults.append(f'{distance}, {slope}: the chief ray of {wanted} ends at {row}')
    assert not faults, '\n'.join(faults[:5])
    # A break in front of all that is the stop: the object is as far from the plane behind it as without the break.
    turn = surf('COORDBRK', t=3.0, parm=[0, 0, 5.0])
    data = zmx(surf(t=10.0), [r for r in turn if not r.startswith('DIAM')] + ['STOP'], surf(t=2.0), IMAGE)
    assert 'object: {distance: 10}' in imported(written(data, 'lens.zmx'))[0].read_text()
    # A point of a tilted object behind the first vertex has no rays.
    behind = zmx(surf('TILTSURF', t=30.0, parm=[0.0, 5.0]), surf(t=2.0, more=['STOP']), surf(t=5.0), IMAGE)
    behind = behind.replace('FTYP 0 0 1', 'FTYP 1 0 1').replace('YFLN 0 ', 'YFLN 10 ')
    done = run('spot', written(behind, 'lens.zmx'), exit=BAD_INPUT)
    assert 'lies behind the first vertex' in done.stderr, done.stderr
    far = zmx(surf('TILTSURF', t=math.inf, parm=[0.1, 0.2]), surf(t=2.0, more=['STOP']), IMAGE)
    _, said = imported(written(far, 'lens.zmx'))
    assert any('the tilt of the object, which is at infinity' in words for _, _, words in said), said


def test_a_break_as_stop():
    """The plane behind it is the stop; rays go on as if there were none."""
    generator = random.Random(f'{SEED} stop')
    launch = written(rays(*launches(generator, 20)))
    for order, glass in ((0, None), (1, None), (0, glas('N-SF6')), (1, MIRROR)):
        turn = coordinate_break(generator, order=order)
        def lens(stop):
            return zmx(FAR, surf(t=2.0, glass=glass), [r for r in turn if not r.startswith('DIAM')] + (['STOP', 'DIAM 1.5'] if stop else []),
                       surf(c=0.02, t=4.0, glass=glas('N-BK7'), more=[] if stop else ['STOP']),
                       surf(c=-0.02, t=20.0), IMAGE)
        rows = [run('trace', written(lens(stop), 'lens.zmx'), '--rays', launch, '--last', '--format', 'csv').stdout
                for stop in (True, False)]
        got, wanted = ([[float(x) for x in (row['x'], row['y'], row['l'], row['m'], row['opl'])]
                        for row in csv.DictReader(text.splitlines())] for text in rows)
        worst = max(abs(a - b) for g, w in zip(got, wanted) for a, b in zip(g, w))
        assert len(got) == len(wanted) == 20 and worst < 1e-11, worst
        yaml, said = imported(written(lens(True), 'lens.zmx'))
        assert any(key == 'STOP' and 'a plane behind the break' in words for _, key, words in said), said
        assert re.search('type: plane, thickness: .*, glass: same, stop: true, draw_to: 1.5', yaml.read_text()), yaml.read_text()


# ------------------------------------------------------------------ what is left out, and bad files

def line_of(text, record):
    return next(i for i, line in enumerate(text.splitlines(), 1) if line.strip().startswith(record))


def of_line(keyword, data):
    """Remarks on the record of this keyword, at its own line."""
    path = written(data, 'lens.zmx')
    lens, said = imported(path)
    return [words for line, key, words in said if (line, key) == (line_of(data, keyword), keyword)]


def test_remarks_and_strict():
    """What is left out is said, by keyword and line; with --strict it is an error."""
    clean = zmx(FAR, surf(t=2.0, more=['STOP']), surf(c=0.02, t=4.0, glass=glas('N-BK7')),
                surf(c=-0.02, t=20.0), IMAGE)
    path = written(clean, 'lens.zmx')
    _, said = imported(path)
    equal(said, [], 'remarks on a lens that is read whole')
    _, said = imported(path, '--strict')
    equal(said, [])
    for data, words in ((clean.replace('PWAV', 'VDYN 0.1 0 0\nVCXN 0.2 0 0\nPWAV'), '- {dy: 0.1, cx: 0.2}'),
                        (clean.replace('FTYP 0 0 1', 'FTYP 1 1 1').replace('INFINITY', '40.0'), 'telecentric: true'),
                        (re.sub('(FTYP( [0-9]+){6}) 0', r'\1 1', clean), 'afocal: true'),
                        (clean.replace('RAIM 0 0', 'RAIM 0 2'), 'aim: real_stop')):
        path = written(data, 'lens.zmx')
        assert words in run('import', path).stdout, (words, run('import', path).stdout)
    faults = []
    for keyword, data in [
            ('ZZQX', clean.replace('GCAT', 'ZZQX 1 2 3\nGCAT')),
            ('ZZQX', clean.replace('  CURV 0.02', '  ZZQX 1\n  CURV 0.02')),
            ('GLAS', clean.replace('N-BK7 0 0', '___BLANK 1 0')),
            ('ENVD', clean.replace('ENVD 2.0E+1 1 0', 'ENVD 35 0.5 1')),
            ('MNUM', clean.replace('MNUM 1 1', 'MNUM 3 2')),
            ('UDAD', clean.replace('  CURV 0.02', '  UDAD 0 0 "a.uda"\n  CURV 0.02'))]:
        try:
            if not of_line(keyword, data):
                faults.append(f'{keyword}: no remark on line {line_of(data, keyword)}')
                continue
            if keyword == 'GLAS':
                continue  # a model glass is approximate, but not left out
            path = written(data, 'lens.zmx')
            done = run('import', path, '--strict', exit=BAD_INPUT)
            if f'{path}:{line_of(data, keyword)}: {keyword}: ' not in done.stderr:
                faults.append(f'{keyword} with --strict: {done.stderr!r}')
            equal(done.stdout, '', f'{keyword}: standard output of a file that is refused')
        except AssertionError as error:
            faults.append(f'{keyword}: {error}')
    assert not faults, '\n'.join(faults)


def test_solves_and_pickups():
    """One that gives the number which is stored is kept, and follows what it says; another is told, and its
    number is kept."""
    front = surf(c=0.02, t=4.0, glass=glas('N-BK7'), more=['STOP'])
    middle = surf(c=-0.02, t=4.0, glass=glas('N-BK7', 2, 1), more=['PZUP 1 1 0 0'])
    middle[1] = 'CURV -0.02 4 1 -1 0 0 ""'
    plain = zmx(FAR, front, middle, surf(c=-0.01, t=40.0), IMAGE)
    info = json.loads(run('info', written(plain, 'lens.zmx'), '--format', 'json').stdout)
    distance = 40.0 + info['data'][0]['image'] if 'data' in info else 40.0 + float(
        rows('info', written(plain, 'lens.zmx'))[0]['image'])
    solved = surf(c=-0.01, t=distance, more=['MAZH 0 0'])
    lens, said = imported(written(zmx(FAR, front, middle, solved, IMAGE), 'lens.zmx'))
    equal(said, [], 'remarks on pickups that are kept')
    text = lens.read_text()
    for words in ('radius: {pickup: "surfaces[1].radius", scale: -1}', 'thickness: {pickup: "surfaces[1].thickness"}',
                  'glass: {pickup: "surfaces[1].glass"}', 'thickness: {solve: paraxial_focus}'):
        assert words in text, (words, text)
    moved = rows('info', lens, '--set', 'surfaces[1].radius=45')[0]
    assert abs(float(moved['image'])) < 1e-12, moved
    # what gives another number
    for wrong, key, kept in (
            (plain.replace('PZUP 1 1 0 0', 'PZUP 1 2 0 0'), 'PZUP', 'thickness: 4'),
            (plain.replace('PZUP 1 1 0 0', 'PZUP 1 1 0 3'), 'PZUP', 'thickness: 4'),
            (plain.replace('PZUP 1 1 0 0', 'PZUP 9 1 0 0'), 'PZUP', 'thickness: 4'),
            (plain.replace('CURV -0.02 4 1 -1', 'CURV -0.02 4 1 1'), 'CURV', 'radius: -50'),
            (plain.replace('CURV -0.02 4 1 -1', 'CURV -0.02 9 1 -1'), 'CURV', 'radius: -50'),
            (zmx(FAR, front, middle, surf(c=-0.01, t=30.0, more=['MAZH 0 0']), IMAGE), 'MAZH', 'thickness: 30'),
            (zmx(FAR, front, middle, surf(c=-0.01, t=distance, more=['MAZH 0 0.7']), IMAGE), 'MAZH', 'thickness: '),
            (plain.replace('GLAS N-BK7 2 1', 'GLAS N-BK7 2 3'), 'GLAS', 'glass: ')):
        lens, said = imported(written(wrong, 'lens.zmx'))
        assert [words for _, k, words in said if k == key and words.startswith('taken as the ')] or key == 'GLAS', \
            (key, said)
        assert kept in lens.read_text(), (kept, lens.read_text())
        equal(run('import', lens).stdout, lens.read_text(), 'written again')
    # breaks that pick each other up keep what is zero
    broken = zmx(FAR, front, surf('COORDBRK', t=1.0, parm=[0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
                 surf(c=-0.02, t=1.0), surf('COORDBRK', t=1.0, parm=[0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
                                            more=['PPAR 1 2 -1 0 0', 'PPAR 3 2 -1 0 0']), IMAGE)
    lens, _ = imported(written(broken, 'lens.zmx'))
    moved = run('import', lens, '--set', 'breaks[1].decenter=[1, 0]', '--set', 'breaks[1].tilt=[3, 0, 0]')
    there, plain_there = (rows('trace', written(text), '--fan', 3, '--last') for text in (
        moved.stdout, moved.stdout.replace('{pickup: "breaks[1].decenter[1]", scale: -1}', '-1')
        .replace('{pickup: "breaks[1].tilt[1]", scale: -1}', '-3')))
    equal(there, plain_there)
    assert 'pickup' in moved.stdout


def test_quiet():
    """Remarks that change the lens come first; -q silences them at each command, and nothing else."""
    near = zmx(FAR, surf(t=2.0, more=['STOP']), surf(c=0.02, t=4.0, glass=glas('N-BK7')),
               surf(c=-0.02, t=20.0), IMAGE).replace('GCAT', 'ZZQX 1\nGCAT').replace('MNUM 1 1', 'MNUM 3 1')
    path = written(near, 'lens.zmx')
    kinds = [line for line in run('import', path).stderr.splitlines()]
    left = [': left out: ' in line for line in kinds]
    equal(left, sorted(left, reverse=True), 'what is left out comes first')
    assert any(left), kinds
    for how in (['import'], ['info'], ['trace', '--chief'], ['spot'], ['fan'], ['opd'], ['field'],
                ['map'], ['diagnose', '--fan', '1', '--ray', '0'], ['trade', '--fan', '3', '--seconds', '0']):
        loud = run(how[0], path, *how[1:], exit=None)
        assert 'ZZQX' in loud.stderr, (how, loud.stderr)
        for word in ('-q', '--quiet'):
            still = run(how[0], path, *how[1:], word, exit=None)
            assert 'ZZQX' not in still.stderr and 'MNUM' not in still.stderr, (how, still.stderr)
            if how[0] != 'trade':  # which prints times
                equal(still.stdout, loud.stdout, str(how))
    assert 'ZZQX' not in run('import', path, '-q', '--strict', exit=3).stdout
    idle = zmx(FAR, surf(t=2.0, more=['STOP']), IMAGE)
    idle = idle.replace('GCAT', 'CSUM 123\nZVAN 0 0 0\nWAVN 9 9\nWWGN 1 1\nGCAT')
    equal(run('import', written(idle, 'lens.zmx')).stderr, '', 'records that change nothing')
    alone = re.sub('(?m)^WAVM', 'ZZQX', idle).replace('WAVN 9 9', 'WAVN 0.7 0.8').replace('WWGN 1 1', 'WWGN 3 1')
    assert 'wavelengths: [0.7]\nwavelength_weights: [3]' in run('import', written(alone, 'lens.zmx')).stdout
    turned = idle.replace('ZVAN 0', 'ZVAN 5')
    assert 'vignetting' in run('import', written(turned, 'lens.zmx')).stderr


def refused(data, keyword, lines, *words):
    """exit 3, nothing written, one message that has file, line, keyword and these words."""
    path = written(data, 'lens.zmx')
    out = path.with_suffix('.yaml')
    done = run('import', path, '-o', out, exit=BAD_INPUT)
    last = done.stderr.rstrip('\n').splitlines()[-1]
    m = ERROR_AT.fullmatch(last)
    assert m and m['file'] == str(path), f'{keyword}: {last!r}'
    assert m['key'] in ((keyword, 'glass') if keyword == 'GLAS' else (keyword,)), f'{keyword}: {last!r}'
    assert int(m['line']) in lines, f'{keyword}: not line {lines}: {last!r}'
    for word in words:
        assert word in last, f'{word} is not in {last!r}'
    assert not out.exists(), f'{keyword}: a file is left behind'
    traced = run('trace', path, '--rays', written(rays((0, 0, -1, 0, 0, 1))), exit=BAD_INPUT)
    equal(traced.stdout, '')
    assert traced.stderr.endswith(last + '\n'), traced.stderr


def test_what_is_refused():
    """Types and glasses that have no rule are errors by name; a file without surfaces is none."""
    glass = surf(c=0.02, t=4.0, glass=glas('N-BK7'))
    clean = zmx(FAR, surf('EVENASPH', t=2.0), glass, surf(c=-0.02, t=20.0), IMAGE)
    faults = []
    cases = [(clean.replace('EVENASPH', kind), 'TYPE', (kind,), line_of(clean, 'TYPE EVENASPH')) for kind in
             ('GRINSUR5', 'BIRE__IN', 'USERSURF', 'JONESMAT',
              'CHEBYSHE', 'NONSEQCO', 'NOSUCH', 'standard2')]
    def extended(kind, *xdat, **how):
        return zmx(FAR, surf(kind, c=0.02, t=4.0, xdat=xdat, **how), IMAGE)
    for kind, where in (('XASPHERE', 1), ('FZERNSAG', 1), ('QED_TYPE', 2)):
        before = [1] * (where - 1)
        cases += [(extended(kind, *before, 1, 0.0, 0.1), 'XDAT', (), None),       # a radius that is none
                  (extended(kind, *before, 1.5, 5.0, 0.1), 'XDAT', (), None),     # a number of terms that is none
                  (extended(kind, *before, 999, 5.0, 0.1), 'XDAT', (), None)]
    cases += [(extended('QED_TYPE', 0, 21, 5.0, *[0.1] * 21, k=-1.0), 'XDAT', (), None),
              (extended('QED_TYPE', 2, 1, 5.0, 0.1), 'XDAT', (), None),
              (extended('SZERNSAG', 1, 5.0, 0.1, parm={9: 0.5}), 'PARM', (), None),
              (extended('GRID_SAG', 0), 'GDAT', (), line_of(extended('GRID_SAG', 0), 'SURF 1')),
              (zmx(FAR, surf('IRREGULA', parm=[0, 0, 0, 0, 0.1], diam='0 0'), IMAGE), 'DIAM', (), None)]
    zones = {1: 60.0, 3: 1.0, 4: 2.0, 5: 1, 6: 1}
    cases += [(extended('BINARY_2', 1, 0.0, 0.1, parm={0: 1}), 'XDAT', (), None),
              (extended('BINARY_2', 101, 1.0, 0.1, parm={0: 1}), 'XDAT', (), None),
              (extended('BINARY_3', 0, parm={**zones, 4: 0.5}), 'PARM', (), None),   # zones that do not rise
              (extended('BINARY_3', 0, parm={**zones, 7: 0.5}), 'PARM', (), None),
              (extended('BINARY_3', 0, parm={**zones, 8: 1}), 'PARM', ('PARM 8',), None),
              (extended('BINARY_3', 41, parm=zones), 'XDAT', (), None),
              (extended('FZERNPHA', 38, 5.0, 0.1, parm={0: 1}), 'XDAT', (), None),
              (extended('HOLOGRM2', parm=[0, 0, 1, 0, 0, 2, -0.5, 1]), 'PARM', (), None),
              (extended('HOLOGRM1', parm=[0, 0, 1, 0, 0, 2, 0, 1]), 'PARM', (), None)]
    cases += [
        (clean.replace('N-BK7', 'N-BK77'), 'GLAS', ('N-BK77',), None),
        (clean.replace('N-BK7 0', 'N-BK77 3'), 'GLAS', ('N-BK77',), None),
        (clean.replace('MODE SEQ', 'MODE NSC'), 'MODE', ('NSC',), None),
        (clean.replace('N-BK7 0 0', '___BLANK 2 2'), 'GLAS', (), None),   # of itself
        (clean.replace('N-BK7 0 0', '___BLANK 2 99'), 'GLAS', ('99',), None),
        (clean.replace('N-BK7 0 0', '___BLANK 2 -1'), 'GLAS', (), None),
        (clean.replace('CURV 0.02', 'CURV abc'), 'CURV', ('abc',), None),
        (clean.replace('CURV 0.02', 'CURV nan'), 'CURV', ('nan',), line_of(clean, 'CURV 0.02')),
        (clean.replace('CURV 0.02', 'CURV inf'), 'CURV', ('inf',), line_of(clean, 'CURV 0.02')),
        (clean.replace('CURV 0.02', 'CURV 1e999'), 'CURV', ('1e999',), line_of(clean, 'CURV 0.02')),
        (clean.replace('DISZ 4.0', 'DISZ 4,0'), 'DISZ', ('4,0',), line_of(clean, 'DISZ 4.0')),
        (clean.replace('DISZ 4.0', 'DISZ'), 'DISZ', (), line_of(clean, 'DISZ 4.0')),
        (clean.replace('DISZ 4.0', 'DISZ INFINITY'), 'DISZ', (), line_of(clean, 'DISZ 4.0')),
        (clean.replace('PWAV 1', 'PWAV 7'), 'PWAV', ('7',), None)]
    cycle = zmx(FAR, surf(t=1.0, glass=glas('___BLANK', 2, 2)), surf(t=1.0, glass=glas('___BLANK', 2, 1)),
                IMAGE)
    cases.append((cycle, 'GLAS', (), None))
    for data, keyword, words, line in some(cases):
        lines = [line] if line else [i for i, row in enumerate(data.splitlines(), 1)
                                     if row.split()[0] == keyword and all(w in row for w in words)]
        try:
            refused(data, keyword, lines, *words)
        except AssertionError as error:
            faults.append(f'{keyword} {words}: {error}')
    assert not faults, '\n'.join(faults)


def test_files_that_are_none():
    for what, data in [('nothing', b''), ('a mark', b'\xff\xfe'), ('zeros', bytes(100)),
                       ('no surface', b'MODE SEQ\n'), ('half a unit', b'\xff\xfeM'),
                       ('an ELF file', b'\x7fELF\x02\x01\x01' + bytes(range(256))),
                       ('an open surrogate', b'\xff\xfe\x00\xd8'), ('one surface', zmx(FAR).encode()),
                       ('a million blanks', b' ' * 10**6), ('a long word', b'SURF ' + b'9' * 10**5)]:
        path = written(data, 'lens.zmx')
        for arguments in (('import', path), ('trace', path, '--rays', written(rays((0, 0, -1, 0, 0, 1))))):
            done = run(*arguments, exit=BAD_INPUT)
            last = done.stderr.rstrip('\n').splitlines()[-1]
            m = ERROR.fullmatch(last)
            assert m and m['file'] == str(path), f'{what}: {last[:300]!r}'
            assert len(last) < 2000 and last.isprintable(), f'{what}: {last[:300]!r}'
    done = run('import', '/nowhere/lens.zmx', exit=BAD_INPUT)
    assert '/nowhere/lens.zmx' in done.stderr, done.stderr


def test_other_formats():
    """Files of other programs are refused by name, and not as bad YAML."""
    for name, words in (('lens.len', 'an OSLO or CODE V file (.len)'), ('lens.zar', 'an OpticStudio archive'),
                        ('lens.zos', 'an OpticStudio session')):
        path = written('a lens\nEPD 10\n', name)
        done = run('import', path, exit=BAD_INPUT)
        assert words in done.stderr and done.stderr.count('\n') == 1, done.stderr


def test_usage():
    path = written(plain_lens(), 'lens.zmx')
    for arguments in ((), (path, path), ('--nonsense', path), (path, '--configuration'),
                      (path, '--configuration', '0')):
        done = run('import', *arguments, exit=USAGE)
        equal(done.stdout, '', arguments)
        assert done.stderr, arguments
    plain = run('import', path).stdout
    equal(run('import', path, '--configuration', '1').stdout, plain)
    lens, _ = imported(path)
    equal(lens.read_text(), plain, '-o')


def ended(*arguments):
    """What a command did that may be refused, and its standard error."""
    done = subprocess.run([SAGITTA, *map(str, arguments)], capture_output=True, timeout=100)
    return done, done.stderr.decode(errors='backslashreplace')


def prefixes(what, data, cuts, name):
    """Each prefix is read, or refused by one message that has file and line."""
    folder_ = written(b'', name).parent
    read = 0
    for cut in cuts:
        path = folder_ / name
        path.write_bytes(data[:cut])
        done, stderr = ended('import', path)
        at = f'{what}, the first {cut} bytes'
        assert done.returncode in (DECIDED, BAD_INPUT), f'{at}: exit {done.returncode}: {stderr[-500:]}'
        lines = stderr.splitlines()
        if done.returncode == DECIDED:
            remarks(stderr, path)
            read += 1
            assert done.stdout, at
            continue
        assert lines, f'{at}: exit 3 and no message'
        equal(done.stdout, b'', f'{at}: standard output')
        m = ERROR.fullmatch(lines[-1])
        assert m and m['file'] == str(path) and (m['line'] or cut < 8), f'{at}: {lines[-1]!r}'
        remarks('\n'.join(lines[:-1]), path)
    return read


def test_prefixes():
    """A file cut off at each line, a small one at each byte: exit 0 or 3, never a signal."""
    small = '''MODE SEQ
UNIT MM
ENPD 4
FTYP 0 0 1 1
YFLN 0
WAVM 1 0.55 1
SURF 0
 TYPE STANDARD
 DISZ INFINITY
SURF 1
 STOP
 CURV 0.02
 DISZ 4
 GLAS N-BK7 0 0
SURF 2
 TYPE EVENASPH
 PARM 2 1E-5
 DISZ 40
 CLAP 0 3
SURF 3
 DISZ 0
'''
    stride = max(1, round(1 / SCALE))
    for what, data, step in (('UTF-8', small.encode(), 1),
                             ('UTF-16', b'\xff\xfe' + small.encode('utf-16-le'), 9)):
        assert prefixes(what, data, [*range(0, len(data), step * stride), len(data)], 'small.zmx') > 0
    for name, step in (('optiland__lens1__ad519c.zmx', 1), ('optiland__thorlabs_lj1598l1__b68ae1.zmx', 3),
                       ('optiland__simple_fold_mirror_up__8136ed.zmx', 4)):
        data = (DATA / name).read_bytes()
        ends = [m.end() for m in re.finditer(rb'\n\0?', data)]
        read = prefixes(name, data, sorted({*ends[::step * stride], len(data)}), name)
        assert read > 0, f'{name}: no prefix is read'


def test_noise():
    """Records with fields that are missing, too many, of another kind: exit 0 or 3."""
    generator = random.Random(f'{SEED} noise')
    text = zmx(
        FAR, surf('COORDBRK', parm=[0.1, 0.2, 3.0, 4.0, 5.0, 1], t=1.0),
        surf('EVENASPH', c=0.02, parm=[0.0, 1e-5], t=4.0, glass=glas('N-BK7'),
             more=['CLAP 0.1 3 0', 'OBDC 0.1 0.2']),
        surf('XPOLYNOM', xdat=[2, 10.0, 0.01, 0.02], t=2.0,
             more=['SQAP 2 3', 'SCBD 1 0 0 0.1 0.1 3 3 3', 'SCBD 2 1 2 -0.1 -0.1 -3 -3 -3']),
        surf('TOROIDAL', c=0.02, parm=[30.0, 0.0, 1e-5], t=2.0, glass=glas('___BLANK', 1, 0, 1.6, 50)),
        surf('BICONICX', c=0.02, parm=[40.0, -1.0], t=2.0, more=['SPID 0.1 3', 'STOP']),
        surf('ODDASPHE', parm=[0.01, 0.002], t=-2.0, glass=MIRROR, more=['ELAP 2 3']),
        surf('TILTSURF', parm=[0.1, 0.2], t=-2.0, glass=glas('___BLANK', 2, 2)),
        surf('DGRATING', parm=[0.1, 1], t=1.0), surf('BINARY_1', parm={0: 1}, xdat=[5, 3.0, 1.0, 2.0, 3.0, 4.0, 5.0], t=1.0),
        surf('BINARY_2', parm={0: 1, 2: 1e-5}, xdat=[2, 3.0, -50.0, 2.0], t=1.0),
        surf('BINARY_3', c=0.01, parm=[70.0, -1.0, 1.0, 3.0, 1, 2], xdat=[1, 1e-3, 50.0, 2e-3, 60.0], t=1.0),
        surf('FZERNPHA', parm={0: 1}, xdat=[4, 3.0, 1.0, 0.0, 0.0, -5.0], t=1.0),
        surf('HOLOGRM2', parm=[0.0, 0.0, -50.0, 0.0, 3.0, 60.0, 0.5, 1], t=1.0),
        surf('PARAX_XY', parm=[0.01, -0.02], t=1.0), surf('FRESNELS', c=0.02, parm=[0.0, 1e-5], t=1.0),
        surf('HOLOGRM1', parm=[0.0, 0.0, -50.0, 0.0, 3.0, 60.0, 0.5, 1], t=1.0),
        surf('SZERNPHA', parm={0: 1}, xdat=[3, 3.0, 1.0, 0.0, 2.0], t=1.0),
        surf('QED_TYPE', c=0.02, k=-1.0, xdat=[0, 2, 5.0, 0.1, 0.2], t=1.0), surf('IRREGULA', parm=[0.1, 0, 1, 0, 0.1, 0, 0, 3], t=1.0),
        surf('PARAXIAL', parm=[100.0, 1]), IMAGE).splitlines()
    path = written(b'', 'noise.zmx')
    path.write_text('\n'.join(text) + '\n')
    run('import', path)
    for old, several_new in [
            ('XDAT 1 2', ('XDAT 1 1e9', 'XDAT 1 -5', 'XDAT 1 2.5', 'XDAT 1 400', 'XDAT 1 1e30')),
            ('XDAT 2 10.0', ('XDAT 2 0', 'XDAT 2 1e-200', 'XDAT 2 -3', 'XDAT 999999999 1', 'XDAT -1 1')),
            ('PARM 1 100.0', ('PARM 1 0', 'PARM 1 1e-320', 'PARM 999999999 1', 'PARM -1 1', 'PARM 1.5 1'))]:
        for new in several_new:
            assert any(old in row for row in text), old
            path.write_text('\n'.join(text).replace(old, new) + '\n')
            done, stderr = ended('import', path)
            assert done.returncode in (DECIDED, BAD_INPUT), f'{new}: exit {done.returncode}: {stderr[-500:]}'
    junk = ['', 'x', 'nan', '-1', '1e999', '0', '99999999999999999999', '-2147483649', '"', '%s%n',
            '\u00d8' * 50, 'INFINITY', '1e-320', '2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20']
    for _ in range(several(150)):
        lines = list(text)
        for _ in range(generator.choice((1, 1, 3))):
            i = generator.randrange(len(lines))
            words = lines[i].split()
            if words and generator.random() < 0.8:
                words[generator.randrange(len(words))] = generator.choice(junk)
                lines[i] = ' '.join(words)
            elif generator.random() < 0.5:
                del lines[i]
            else:
                lines.insert(i, lines[generator.randrange(len(lines))])
        data = '\n'.join(lines) + '\n'
        path.write_text(data)
        done, stderr = ended('import', path)
        assert done.returncode in (DECIDED, BAD_INPUT), f'exit {done.returncode}: {stderr[-500:]}\n{data}'
        if done.returncode == BAD_INPUT:
            last = stderr.splitlines()[-1]
            assert re.match(rf'sagitta: {re.escape(str(path))}(:\d+)?: ', last), f'{last!r}\n{data}'


def test_many_surfaces():
    """A hundred thousand surfaces take some four times as long as a quarter of them."""
    def timed(count):
        # A glass at every second surface: a name, or a pickup of the glass four surfaces before.
        glass = [f'GLAS ___BLANK 2 {i - 3}' if i % 4 == 0 and i else 'GLAS N-BK7 0 0' for i in range(count)]
        records = [f'SURF {i + 1}\n CURV 1e-6\n DISZ 0.01\n' + (glass[i] + '\n' if i % 2 == 0 else '')
                   for i in range(count)]
        path = written('MODE SEQ\nENPD 1\nSURF 0\n DISZ INFINITY\n' + ''.join(records) +
                       f'SURF {count + 1}\n DISZ 0\n', 'many.zmx')
        best = math.inf
        for _ in range(2):
            start = time.monotonic()
            run('import', path, '-o', path.with_suffix('.yaml'))
            best = min(best, time.monotonic() - start)
        return best
    few, many = timed(10000), timed(40000)
    print(f'10,000 surfaces {few:.2f} s, 40,000 {many:.2f} s')
    assert many < 10 * few + 0.5, f'10,000 surfaces take {few:.2f} s, 40,000 {many:.2f} s'
    # A chain of pickups through all of them.
    chain = ''.join(f'SURF {i}\nDISZ 0.1\nGLAS ___BLANK 2 {i + 1}\n' for i in range(1, 30000))
    data = 'MODE SEQ\nENPD 1\nSURF 0\nDISZ INFINITY\n' + chain
    data += 'SURF 30000\nDISZ 0.1\nGLAS N-BK7 0 0\nSURF 30001\nDISZ 0\n'
    done, stderr = ended('import', written(data, 'chain.zmx'))
    assert done.returncode in (DECIDED, BAD_INPUT), f'exit {done.returncode}: {stderr[-500:]}'


if __name__ == '__main__':
    print(f'SAGITTA_TEST_SEED={SEED}')
    try:
        main(globals())
    finally:
        print('left out, and said so:', ', '.join(sorted(left_out)) or 'nothing')
        print('largest difference over its tolerance: ' +
              ', '.join(f'{k} {v:.2g}' for k, v in sorted(worst.items())))
