#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What is behind a surface that does not say it: `glass: air`, `glass: same`, what may be left out, what is refused.

    python3 test_media.py SAGITTA

The oracle is `media` below, a reading of its own of what docs/lens_file.md promises.  It says for each random lens
whether it is refused, and where; and else a lens that says each medium as a number has to have the same bits.
SAGITTA_TEST_SEED (1) and SAGITTA_TEST_SCALE (0.5) choose the lenses.
"""
import json
import os
import random
import re

from command import *

SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'), 0)
SCALE = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))
MODEL = {'sellmeier': [1.2, 0.01]}  # n^2 = 1 + 1.2 w^2 / (w^2 - 0.01)
UM = 0.5
MODEL_INDEX = (1 + 1.2 * UM * UM / (UM * UM - 0.01)) ** 0.5


def said(draw, choices):
    """Keys of a medium, drawn."""
    word = draw.choice(choices)
    return {'': {}, 'air': {'glass': draw.choice(('air', 'Air', 'AIR'))},
            'same': {'glass': draw.choice(('same', 'Same', 'SAME'))},
            'one': {'index': 1}, 'list': {'index': [1, 1]}, 'index': {'index': 1.7},
            'model': {'glass': MODEL}}[word]


def index_said(s):
    """The index that a surface says, a word in lower case, or None."""
    if 'index' in s:
        return s['index'][0] if isinstance(s['index'], list) else s['index']
    glass = s.get('glass')
    if isinstance(glass, dict):
        return MODEL_INDEX
    return {'air': 1, 'same': 'same', None: None}[glass and glass.lower()]


def media(lens):
    """The index behind each surface; or the place in `surfaces` of the one that is refused."""
    first = now = index_said(lens.get('object', {})) or 1
    elements = [i for i, s in enumerate(lens['surfaces']) if s['type'] != 'break']
    out = []
    for i in elements:
        s = lens['surfaces'][i]
        own = index_said(s)
        if own is None and now != first and not s.get('mirror') and i != elements[-1]:
            return i
        if own not in (None, 'same'):
            now = own
        out.append(now)
    return out


def drawn(draw):
    lens = {'wavelengths': [UM, 0.6], 'primary': 1, 'pupil': {'semi_diameter': 1}, 'surfaces': []}
    if draw.random() < 0.3:
        lens['object'] = said(draw, ('air', 'one', 'index', 'model'))
    count, stop = draw.randrange(1, 7), draw.random()
    for i in range(count):
        if draw.random() < 0.2:
            lens['surfaces'].append({'type': 'break', 'decenter': [0.01, 0], 'thickness': 0})
        kind = draw.choice(('sphere', 'sphere', 'plane', 'ideal'))
        s = {'type': kind, 'thickness': draw.uniform(0.5, 2),
             **said(draw, ('', '', '', '', '', 'air', 'same', 'one', 'list', 'index', 'index', 'model', 'model'))}
        if kind == 'sphere':
            s['radius'] = draw.choice((-1, 1)) * draw.uniform(40, 90)
        if kind == 'ideal':
            s['focal_length'] = draw.choice((-1, 1)) * draw.uniform(40, 90)
        if draw.random() < 0.15 and kind != 'ideal':
            s['mirror'] = True
            if s.get('glass', 'same') != 'same' or 'index' in s:
                s.pop('glass', None), s.pop('index', None)
        lens['surfaces'].append(s)
    lens['surfaces'][draw.choice([i for i, s in enumerate(lens['surfaces']) if s['type'] != 'break'])]['stop'] = True
    if draw.random() < 0.2:
        lens['surfaces'].append({'type': 'break', 'decenter': [0.01, 0]})
    return lens


def lines(lens):
    """As YAML with a line for each surface, from line 2."""
    head = {k: v for k, v in lens.items() if k != 'surfaces'}
    text = ''.join(f'{k}: {json.dumps(v)}\n' for k, v in head.items())
    return text + 'surfaces:\n' + ''.join(f'  - {json.dumps(s)}\n' for s in lens['surfaces']), len(head) + 2


def test_random_lenses():
    draw = random.Random(SEED)
    print(f'       seed {SEED}')
    refused = 0
    for case in range(int(300 * SCALE)):
        lens = drawn(draw)
        wanted = media(lens)
        text, first_line = lines(lens)
        where = f'seed {SEED}, case {case}:\n{text}'
        launch = rays((0.1, 0.2, -1, 0.01, -0.02, 1))
        arguments = ('--rays', '-', '--format', 'csv')
        if isinstance(wanted, int):
            refused += 1
            error = run('trace', written(text), *arguments, stdin=launch, exit=BAD_INPUT).stderr
            assert re.search(rf':{first_line + wanted}: glass: missing', error), where + error
            assert 'glass: air' in error and 'glass: same' in error, where + error
            continue
        done = run('trace', written(text), *arguments, stdin=launch, exit=None)
        got = done.stdout
        for s, index in zip((s for s in lens['surfaces'] if s['type'] != 'break'), wanted):
            s.pop('glass', None), s.pop('index', None)
            if not s.get('mirror'):
                s.update({'glass': MODEL} if index == MODEL_INDEX else {'index': index})
        equal(run('trace', written(lines(lens)[0]), *arguments, stdin=launch, exit=None).stdout, got)
    print(f'       {refused} refused')
    assert refused > 0, refused


BOOK = '''wavelengths: [0.5876]
pupil: {{semi_diameter: 5}}
surfaces:
  - {{type: sphere, radius: 50, thickness: 5, index: 1.6}}
  - {{type: sphere, radius: -50, thickness: 40{}}}
  - {{type: plane}}
'''


def test_a_table_of_a_book():
    """A glass behind one surface and nothing behind the next, as books print it: it was the glass, and is refused."""
    error = run('info', written(BOOK.format('')), exit=BAD_INPUT).stderr
    assert ':5: glass: missing' in error and 'index 1.6' in error, error
    texts = {run('info', written(BOOK.format(f', {medium}')), '--format', 'csv').stdout
             for medium in ('glass: air', 'glass: AIR', 'index: 1', 'index: [1]', 'glass: "air"')}
    equal(len(texts), 1)
    equal(run('info', written(BOOK.format(', glass: same')), '--format', 'csv').stdout,
          run('info', written(BOOK.format(', index: 1.6')), '--format', 'csv').stdout)


def test_same_where_nothing_is_in_front():
    lens = 'object: {glass: same}\nsurfaces: [{type: plane}]\n'
    error = run('info', written(lens), exit=BAD_INPUT).stderr
    assert ':1: object.glass: ' in error, error


def test_import_writes_media_out():
    """Each surface of a .zmx file, but mirrors, says what is behind it; and what was written reads as the same lens."""
    for path in sorted((HERE.parent / 'data' / 'zmx').glob('*.zmx')):
        text = run('import', path).stdout
        equal(run('info', written(text), '--format', 'csv').stdout, run('info', path, '--format', 'csv').stdout)
        for entry in text.split('\nsurfaces:\n')[1].split('  - ')[1:]:
            assert re.search('type: break|glass: |index: |mirror: true', entry), (path.name, entry)


# ------------------------------------------------------------------ a name of several makers

USUAL = ['schott', 'ohara', 'hoya', 'cdgm', 'hikari', 'sumita']  # docs/glass.md
FORMULAS = {  # n at w micrometres, of those formulas that the names have
    1: lambda c, w: (1 + c[0] + sum(a * w * w / (w * w - b * b) for a, b in zip(c[1::2], c[2::2]))) ** 0.5,
    2: lambda c, w: (1 + c[0] + sum(a * w * w / (w * w - b) for a, b in zip(c[1::2], c[2::2]))) ** 0.5,
    3: lambda c, w: (c[0] + sum(a * w ** b for a, b in zip(c[1::2], c[2::2]))) ** 0.5,
}


def names_of_several():
    """{name: {maker: nd}} of names that several makers have, by the files that ship."""
    nd = {}
    for file in ('glasses.csv', 'older.csv'):
        text = (HERE.parent.parent / 'data' / 'glass' / file).read_text()
        for row in csv.DictReader(s for s in text.splitlines() if not s.startswith('#')):
            c = [float(x) for x in row['coefficients'].split()]
            formula = FORMULAS.get(int(row['formula']))
            nd.setdefault(row['glass'].lower(), {}).setdefault(row['maker'], formula and formula(c, 0.5875618))
    return {name: makers for name, makers in nd.items() if len(makers) > 1}


def test_names_of_several_makers():
    """Each such name, without a word on makers: that of the first usual maker; the note has all, and their nd."""
    several = names_of_several()
    print(f'       {len(several)} names')
    assert len(several) >= 44, len(several)
    for name, makers in several.items():
        usual = [maker for maker in USUAL if maker in makers]
        lens = ('wavelengths: [d]\npupil: {semi_diameter: 1}\nobject: {glass: "%s"}\n'
                'surfaces: [{type: sphere, radius: 10, thickness: 1, index: 1}, {type: plane}]\n')
        done = run('info', written(lens % name), '--format', 'csv')
        first = usual[0] if usual else None
        if first:
            own = run('info', written(lens % f'{first} {name}'), '--format', 'csv')
            equal(done.stdout, own.stdout, name)
            equal(own.stderr, '', name)
        for maker, nd in makers.items():
            assert maker in done.stderr, (name, maker, done.stderr)
            if first and maker != first and nd and makers[first]:
                told, = re.findall(rf'{maker} \(nd ([-+.0-9]+|the same)\)', done.stderr)
                close(0 if told == 'the same' else told, nd - makers[first], 0.6e-5, (name, maker))
        for maker in makers:
            said = written('makers: [%s]\n' % maker + lens % name)
            equal(run('info', said).stderr.count('also of'), 0, (name, maker))


def test_a_catalogue_goes_before_the_usual_makers():
    own = written('maker,glass,formula,from_um,to_um,coefficients\nmine,F2,5,0.3,2.5,1.9\n', 'mine.csv')
    lens = written('wavelengths: [d]\npupil: {semi_diameter: 1}\n'
                   'surfaces: [{type: sphere, radius: 9, thickness: 1, glass: F2}, {type: plane, glass: air}]\n')
    row, = rows('info', lens, '--glass', own)
    close(row['efl'], 9 / 0.9, 1e-12)


# ------------------------------------------------------------------ the primary wavelength

COLOURS = ('wavelengths: [F, d, C]\n{}units: mm\npupil: {{semi_diameter: 3}}\nfields: [0, 2]\n'
           'surfaces:\n  - {{type: sphere, radius: 50, thickness: 4, glass: N-BK7}}\n'
           '  - {{type: sphere, radius: -50, thickness: 47, glass: air}}\n  - {{type: plane}}\n')


def test_primary_wavelength():
    """Several wavelengths and no primary: a note says that it is the first.  Each table names the primary one."""
    tables = (('info',), ('spot',), ('fan',), ('opd', '--summary'), ('field',), ('map', '--field', '0'),
              ('sweep', '--from', '0', '--to', '2'), ('trace',))
    for primary, um in ((None, '0.4861327'), (1, '0.4861327'), (2, '0.5875618'), (3, '0.6562725')):
        lens = written(COLOURS.format(f'primary: {primary}\n' if primary else ''))
        for command, *more in tables:
            done = run(command, lens, *more, exit=None)
            told = f':1: primary: missing: the first of 3 wavelengths, {um}' in done.stderr
            equal(told, primary is None, (command, done.stderr))
            line, = re.findall('Primary wavelength: (.*)\\.', done.stdout)
            equal(line, f'{um}, number {primary or 1} of the lens', command)
    for one in ('wavelengths: [F]\n', ''):
        lens = COLOURS.format('').replace('wavelengths: [F, d, C]\n', one).replace('glass: N-BK7', 'index: 1.5')
        done = run('info', written(lens))
        assert 'primary' not in done.stderr and 'Primary' not in done.stdout, done


main(globals())
