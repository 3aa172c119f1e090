#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Sequence files of CODE V: what the command reads, where its rays go, what it says of what it leaves out.

    python3 test_seq.py SAGITTA

Each lens of seq_lenses.py has a group of commands, and its meaning beside it; seq_oracle.py traces that at 50
digits.  tests/data/seq has files with their first-order numbers, and a telescope of three tilted mirrors whose
sharp image proves the signs.  SAGITTA_TEST_SEED (1) draws the rays.
"""
import json
import os
import pathlib
import random
import re
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / 'tool'))
from command import *  # noqa: E402
import seq_lenses  # noqa: E402
import seq_oracle  # noqa: E402

SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'), 0)
DATA = HERE.parent / 'data' / 'seq'
os.environ['SAGITTA_GLASS'] = str(HERE.parents[1] / 'data' / 'glass')
ORDERS = json.loads((DATA / 'first_order.json').read_text())
REMARK = re.compile(r'^(?!sagitta: )\S*?:(\d+): (\S+): (.+)$', re.MULTILINE)
PLAIN = '''RDM
LEN
DIM M
EPD 4
WL 587.5618
REF 1
YAN 0
SO 0 1e13
S 50 4 NBK7_SCHOTT
STO
S -60 40
SI 0 0
GO
'''


def imported(text, *more, name='a.seq'):
    """The lens file, and the remarks without the file: (line, key, words)."""
    done = run('import', written(text, name), *more)
    return done.stdout, [(int(a), b, c) for a, b, c in REMARK.findall(done.stderr)]


def refused(text, *more, name='a.seq'):
    return run('import', written(text, name), *more, exit=BAD_INPUT).stderr


def plain(old='', new='', behind=''):
    """PLAIN with a change, or with commands behind its first surface."""
    if old and old not in PLAIN:
        raise AssertionError(old)
    return PLAIN.replace(old, new, 1).replace('STO\n', 'STO\n' + behind, 1)


def test_rays():
    rng = random.Random(SEED)
    print(f'SAGITTA_TEST_SEED={SEED}')
    worst = 0
    for name, (text, surfaces) in seq_lenses.LENSES.items():
        starts = [(rng.uniform(-2, 2), rng.uniform(-2, 2), -10, rng.uniform(-.03, .03), rng.uniform(-.03, .03), 1)
                  for _ in range(4)]
        file = written(text, 'a.seq')
        if 'zoom' in name:
            yaml = file.with_name('b.yaml')
            run('import', file, '--configuration', 2, '-o', yaml)
            file = yaml
        got = rows('trace', file, '--rays', written(rays(*starts), 'rays.csv'), '--frame', 'global', '-q',
                   '--no-apertures')
        equal(len(got), len(starts) * len(surfaces), name)
        for i, start in enumerate(starts):
            norm = seq_oracle.sqrt(sum(seq_oracle.mpf(x) ** 2 for x in start[3:]))
            wanted = seq_oracle.trace(surfaces, start[:3], start[3:])
            for row, (p, d, path) in zip(got[i * len(surfaces):], wanted):
                for key, x in zip(('x', 'y', 'z', 'l', 'm', 'n', 'opl'), (*p, *d, path)):
                    apart = abs(seq_oracle.mpf(float(row[key])) - x)
                    worst = max(worst, float(apart))
                    if not apart <= 1e-12 * max(1, abs(x)):
                        raise AssertionError(f'{name}: ray {i}, element {row["element"]}: {key} {row[key]}, not '
                                             f'{float(x)!r}: {float(apart):.3g} off')
    print(f'rays: at most {worst:.2g} off')


def test_first_order():
    for name, wanted in ORDERS.items():
        got = json.loads(run('info', DATA / name, '-q', '--format', 'json', exit=None).stdout)
        close(got['efl'], wanted['efl'], 1e-12 * abs(wanted['efl']), name)
        if 'bfd' in wanted and 'finite' not in wanted:
            close(got['bfd'], wanted['bfd'], 2e-12 * abs(wanted['bfd']), name)
        if 'finite' in wanted:
            close(got['magnification'], wanted['finite']['magnification'], 1e-12, name)
        if 'frames' in wanted:
            centres = rows('trace', DATA / name, '--rays', written(rays((0, 0, -500, 0, 0, 1))), '--frame', 'global', '-q')
            for row, frame in zip(centres, wanted['frames']):
                close(sum((float(row[k]) - v) * z for k, v, z in zip('xyz', frame['vertex'], frame['z_axis'])), 0,
                      1e-12, 'a point on a plane, or on the axis')
        for i, zoom in enumerate(wanted.get('zoom', ())):
            yaml = run('import', DATA / name, '-q', '--configuration', i + 1).stdout
            got = json.loads(run('info', written(yaml), '-q', '--format', 'json').stdout)
            close(got['efl'], zoom['efl'], 1e-12 * zoom['efl'], f'{name}, position {i + 1}')
            close(got['bfd'], zoom['bfd'], 1e-12 * zoom['bfd'], f'{name}, position {i + 1}')


def test_telescope_proves_the_signs():
    """Of the five beams every one is sharp, and the middle ray meets the image in its vertex; with the other hand of
    ADE they are not."""
    text = (DATA / 'ray-optics__threemir.seq').read_text()
    spots = [row for row in rows('spot', DATA / 'ray-optics__threemir.seq', '-q') if row['wavelength'] != 'all']
    equal(len(spots), 5)
    for spot in spots:
        equal(spot['passed'], spot['rays'])
        if not float(spot['geometric']) < 5e-3:
            raise AssertionError(f'a blurred beam: {spot}')
    close(spots[1]['x'], 0, 1e-5)
    close(spots[1]['y'], 0, 1e-5)
    wrong = rows('spot', written(text.replace('ADE ', 'ADE -'), 'a.seq'), '-q', exit=None)
    if any(row['geometric'] and float(row['geometric']) < 0.1 for row in wrong):
        raise AssertionError('the signs make no difference')


TWINS = [
    ('''VERS 130614 0
MODE SEQ
UNIT MM X W X CM MR CPMM
ENPD 8
GCAT SCHOTT
FTYP 0 0 2 3 0 0 0
XFLN 0 0
YFLN 0 5
WAVM 1 0.4861327 1
WAVM 2 0.5875618 2
WAVM 3 0.6562725 1
PWAV 2
SURF 0
  TYPE STANDARD
  DISZ INFINITY
SURF 1
  STOP
  TYPE STANDARD
  CURV %r
  DISZ 4.5
  GLAS N-BK7 0 0
SURF 2
  TYPE STANDARD
  CURV %r
  DISZ 2
  GLAS N-SF5 0 0
SURF 3
  TYPE STANDARD
  CURV %r
  DISZ 93.7
SURF 4
  TYPE STANDARD
  DISZ 0
TOL TOFF 0
''' % (1 / 61.47, 1 / -44.64, 1 / -129.94),
     '''RDM;LEN
EPD 8; DIM M
WL 486.1327 587.5618 656.2725
REF 2
WTW 1 2 1
XAN 0 0
YAN 0 5
SO 0 .1e14
S 61.47 4.5 NBK7_SCHOTT
STO
S -44.64 2 NSF5_SCHOTT
S -129.94 93.7
SI 0 0
GO
'''),
    ('''VERS 130614 0
MODE SEQ
UNIT CM X W X CM MR CPMM
OBNA 0.05 0
FTYP 1 0 1 1 0 0 0
XFLN 0
YFLN 0.25
WAVM 1 0.55 1
PWAV 1
SURF 0
  TYPE STANDARD
  DISZ 20
SURF 1
  TYPE EVENASPH
  CURV 0.125
  CONI -0.7
  PARM 2 1e-4
  PARM 3 -2e-6
  DISZ 1.5
  GLAS S-LAH64 0 0
SURF 2
  STOP
  TYPE STANDARD
  CURV -0.0625
  CONI -2
  DISZ 15
SURF 3
  TYPE STANDARD
  CURV -0.01
  DISZ 0
TOL TOFF 0
''',
     '''rdm n;len
nao .05; dim c
wl 550
xob 0;yob .25
so 0 20
s .125 1.5 slah64_ohara
asp;k -.7;a 1e-4;b -2e-6
s -.0625 15
sto
con;k -2
si -.01 0
go
'''),
    ('''VERS 130614 0
MODE SEQ
UNIT MM X W X CM MR CPMM
FNUM 5 0
FTYP 0 0 1 1 0 0 0
XFLN 0
YFLN 0.5
WAVM 1 0.55 1
PWAV 1
SURF 0
  TYPE STANDARD
  DISZ INFINITY
SURF 1
  STOP
  TYPE STANDARD
  CURV -0.0025
  CONI -1
  GLAS MIRROR 0 0
  DISZ -120
SURF 2
  TYPE COORDBRK
  PARM 2 1.5
  PARM 3 -45
  DISZ 0
SURF 3
  TYPE STANDARD
  CURV 0
  GLAS MIRROR 0 0
  DISZ 0
SURF 4
  TYPE COORDBRK
  PARM 3 -45
  DISZ 80
SURF 5
  TYPE STANDARD
  DISZ 0
TOL TOFF 0
''',
     '''RDM
LEN
DIM M
FNO 5
WL 550
YAN .5
SO 0 1e10
S -400 -120 REFL
STO
K -1
S 0 80 REFL
YDE 1.5;ADE 45;BEN
SI 0 0
GO
''')]


def test_twins_of_zmx():
    for zmx, seq in TWINS:
        got = [rows('trace', written(text, name), '-q', '--fan', 7, '--wavelength', 1, '--frame', 'global')
               for text, name in ((zmx, 'a.zmx'), (seq, 'a.seq'))]
        equal(got[1], got[0])
        elements = [imported(text, name=name)[0] for text, name in ((zmx, 'a.zmx'), (seq, 'a.seq'))]
        equal(len(re.findall('^  - ', elements[1], re.MULTILINE)), len(re.findall('^  - ', elements[0], re.MULTILINE)))


def test_system():
    for old, new, wanted in (
            ('EPD 4', 'EPD 4', 'pupil: {semi_diameter: 2}'), ('EPD 4', 'FNO 8', 'pupil: {f_number: 8}'),
            ('EPD 4', 'NA .1', 'pupil: {image_na: 0.1}'), ('EPD 4', 'EPD 4;FNO 8', 'pupil: {f_number: 8}'),
            ('DIM M', 'DIM C', 'units: cm'), ('DIM M', 'dim i', 'units: in'), ('DIM M', 'DIM MM', 'units: mm'),
            ('DIM M', 'DIM M\nTITLE "a; b & c ! d"', 'name: "a; b & c ! d"'),
            ('DIM M', "DIM M; tit 'One' ! two", 'name: "One"'),
            ('WL 587.5618\nREF 1', 'WL 656.2725 587.5618 486.1327\nREF 3\nWTW 1 2', 'wavelengths: [0.6562725, 0.5875618, 0.4861327]\n'
             'wavelength_weights: [1, 2, 1]\nprimary: 3'),
            ('WL 587.5618\nREF 1', 'WL 656 588 486\nWL W2 550', 'wavelengths: [0.656, 0.55, 0.486]\nprimary: 2'),
            ('YAN 0', 'YAN 0 7 10', 'fields: [0, 7, 10]'), ('YAN 0', 'YAN 0 7 10;YAN F2 8', 'fields: [0, 8, 10]'),
            ('YAN 0', 'XAN 0 1; YAN 0 2', 'fields: [[0, 0], [1, 2]]'), ('YAN 0', 'XAN 3', 'fields: [[3, 0]]'),
            ('YAN 0', 'YAN 0 1;YIM 0 2 3', 'field_type: paraxial_image_height\nfields: [0, 2, 3]'),
            ('YAN 0', 'XRI 1;YRI 2', 'field_type: real_image_height\nfields: [[1, 2]]'),
            ('YAN 0', 'YAN 0 1; WTF 1 .5', 'field_weights: [1, 0.5]'),
            ('YAN 0', 'YAN 0 1; WTF F2 .5', 'field_weights: [1, 0.5]'), ('YAN 0', 'YAN 0 1; XAN F2 3', 'fields: [[0, 0], [3, 1]]'),
            ('YAN 0', 'YAN 0; YAN F2 3', 'fields: [0, 3]'), ('YAN 0', 'YAN 0 1; VUY F2 .5; VLY F2 .5', '- {}\n  - {cy: 0.5}'),
            ('YAN 0', 'ZOO 1; YAN 0 1; ZOO YAN F2 5', 'fields: [0, 5]'),
            ('YAN 0', 'YAN 0 1; VUX 0 .25; VLX 0 .25; VUY 0 -.5; VLY 0 0', 'vignetting:\n  - {}\n'
             '  - {cx: 0.25, dy: 0.25, cy: -0.25}'),
            ('SO 0 1e13', 'SO 0 9.9E11', 'surfaces:'), ('SO 0 1e13', 'SO 0 1e9', 'object: {distance: 1000000000}'),
            ('SO 0 1e13', 'SO 0 200 NBK7_SCHOTT', 'object: {distance: 200, glass: schott N-BK7}'),
            ('YAN 0\nSO 0 1e13', 'YOB 0 3\nSO 0 100', 'field_type: object_height\nfields: [0, 3]\nobject: {distance: 100}'),
            ('STO\n', '', '')):
        text = imported(plain(old, new))[0]
        if wanted not in text:
            raise AssertionError(f'{new}: no {wanted} in\n{text}')


def test_surfaces():
    for behind, wanted in (
            ('CIR 3', 'semi_diameter: 3'), ('CIR EDG 3', 'draw_to: 3'), ('CIR 3; CIR EDG 4', 'semi_diameter: 3, draw_to: 4'),
            ('CIR 3; CIR EDG 3', 'semi_diameter: 3}'), ('CIR 2; CIR 3', 'semi_diameter: 3}'),
            ('CIR OBS 1', 'apertures: [{type: circle, radius: 1, obscures: true}]'),
            ('CIR 3; ADY .5', 'apertures: [{type: circle, radius: 3, offset: [0, 0.5]}]'),
            ('REX 2; REY 3; ADX .5', 'apertures: [{type: rectangle, half_width: 2, half_height: 3, offset: [0.5, 0]}]'),
            ('ELY 2; ELX 3; ARO 20', 'apertures: [{type: ellipse, half_width: 3, half_height: 2, turn: 20}]'),
            ("CIR 3; REX L'a' 2; REY L'a' 1; REX OBS .2; REY OBS .1; ADY L'a' .3", 'semi_diameter: 3, apertures: ['
             '{type: rectangle, half_width: 2, half_height: 1, offset: [0, 0.3]}, '
             '{type: rectangle, half_width: 0.2, half_height: 0.1, obscures: true}]'),
            ('SLB "the front"', 'name: "the front"'), ('DAR; ADE 3', 'tilt: [-3, 0, 0]'),
            ('THI HMY 0', 'thickness: 4,'), ('SPH', 'type: sphere'), ('THC 0; CCY 100; GLC 100; KC 0; XDC 100', 'sphere')):
        text = imported(plain(behind=behind + '\n'))[0]
        if wanted not in text:
            raise AssertionError(f'{behind}: no {wanted} in\n{text}')


def test_glasses():
    for glass, wanted in (
            ('NBK7_SCHOTT', 'glass: schott N-BK7'), ('nbk7_schott', 'glass: schott N-BK7'), ('SLAL8_OHARA', 'glass: ohara S-LAL8'),
            ('NBK7', 'glass: N-BK7'), ('517642', 'glass: {nd: 1.517, vd: 64.2}'), ('517.642', 'glass: {nd: 1.517, vd: 64.2}'),
            ('500.700', 'glass: {nd: 1.5, vd: 70}'), ('517000.520000', 'glass: {nd: 1.517, vd: 52}'),
            ('51680.6417', 'glass: {nd: 1.5168, vd: 64.17}'), ('1.5168:64.17', 'glass: {nd: 1.5168, vd: 64.17}'),
            ('NBK7_SCHOTT REFR', 'glass: schott N-BK7'), ('AIR', 'glass: air')):
        text = imported(plain('NBK7_SCHOTT', glass))[0]
        if wanted not in text:
            raise AssertionError(f'{glass}: no {wanted} in\n{text}')
    for glass in ('1.5168', '1.62', '1.5', '5', '51.64', '517.6', '517.64', '51.642', '.517', '517.', '1e3', '-517.642', '5176421',
                  '51764'):
        if 'no code of a glass' not in refused(plain('NBK7_SCHOTT', glass)):
            raise AssertionError(f'{glass}: {refused(plain("NBK7_SCHOTT", glass))}')
    for glass in ('517:642', '517:64.2', '.5:60', '1.5:0', '1.5:-3', '1.517:642'):
        if 'is none' not in refused(plain('NBK7_SCHOTT', glass)):
            raise AssertionError(f'{glass}: {refused(plain("NBK7_SCHOTT", glass))}')
    for glass, wanted in (('NBK77_SCHOTT', 'no glass'), ('CAF2_DAIMON-20', 'no glass'), ("'MINE'", 'PRV block'),
                          ('517000', 'Vd 0'), ('NBK7_SCHOTT TIR', 'TIR'),
                          ('NBK7_SCHOTT 3', 'neither REFL nor REFR')):
        if wanted not in refused(plain('NBK7_SCHOTT', glass)):
            raise AssertionError(f'{glass}: {refused(plain("NBK7_SCHOTT", glass))}')


PRIVATE = """PRV
 PWL 587.5618
 'NBK7' 1.6
 'A-1' 1.7
 'A1' 1.8
 '517642' 1.9
 'MINE_OWN' 1.55
END
DIM M"""


def test_private_names():
    """Compared as they are spelled; and quotes say that a glass is private."""
    for glass, wanted in (("'A-1'", 'index: 1.7,'), ("'A1'", 'index: 1.8,'), ("'a-1'", 'index: 1.7,'), ("'nbk7'", 'index: 1.6,'),
                          ("'517642'", 'index: 1.9,'), ('N-BK7', 'glass: N-BK7'), ('NBK7_SCHOTT', 'glass: schott N-BK7'),
                          ('517.642', 'nd: 1.517'), ('mine_own', 'index: 1.55,')):
        text, got = imported(plain('DIM M', PRIVATE).replace('NBK7_SCHOTT', glass))
        if wanted not in text.replace('}', ','):
            raise AssertionError(f'{glass}: no {wanted} in\n{text}')
        equal(any('without quotes' in words for _, _, words in got), glass == 'mine_own')
    for glass, words in (('NBK7', 'private glass of line 5, and a glass of the catalogue'), ('517642', 'private glass of line 8, and a code'),
                         ("'A_1'", "no glass 'A_1'"), ("'N-BK7'", "no glass 'N-BK7'"), ('MINEOWN', 'no glass'), ('A_1', 'no glass')):
        got = refused(plain('DIM M', PRIVATE).replace('NBK7_SCHOTT', glass))
        if words not in got or 'a.seq:17: ' not in got:
            raise AssertionError(f'{glass}: {got}')
    for second, line in (("'A1' 1.81", 7), ("'a1' 1.8", 7), ("'a-1' 1.7", 6), ("'A1' LAU 1 0 0 0 0 0", 7)):
        got = refused(plain('DIM M', PRIVATE.replace('END', second + '\nEND')))
        if 'a.seq:10: ' not in got or f'the first stands in line {line}' not in got:
            raise AssertionError(got)


def test_names_of_the_same_letters():
    own = written('maker,glass,formula,from_um,to_um,coefficients\nx,Q-77,1,.4,1,1.25\nx,Q7-7,1,.4,1,1.56\ny,Q.77,1,.4,1,2\n',
                  'own.csv')
    for glass, wanted in (('Q-77_X', 'glass: x Q-77'), ('Q7-7_X', 'glass: x Q7-7'), ('Q77_Y', 'glass: y Q.77'), ('q-77', 'glass: Q-77')):
        text = imported(plain('NBK7_SCHOTT', glass), '--glass', own)[0]
        if wanted not in text:
            raise AssertionError(f'{glass}: no {wanted} in\n{text}')
    for glass in ('Q77_X', 'Q77'):
        if 'may be Q-77 or Q' not in refused(plain('NBK7_SCHOTT', glass), '--glass', own):
            raise AssertionError(refused(plain('NBK7_SCHOTT', glass), '--glass', own))


# With a blank in front of its first line it is the text of a key.
LURE = 'VERS 130614 0\n  MODE SEQ\n  SURF 1\n  RDM\n  LEN\n  SO 0 1e13\n  RDM;LEN\n'


def test_a_lens_file_by_another_name():
    """No lens file of the examples and tests, and none with lines of the other formats in a text, is taken for one of
    those, whatever its name."""
    root = HERE.parents[1]
    lenses = [p for at in ('examples', 'tests') for p in sorted((root / at).rglob('*.yaml')) if '\nsurfaces:' in p.read_text()]
    if len(lenses) < 30:
        raise AssertionError(lenses)
    for lens in lenses:
        text, at = lens.read_text(), written('').parent
        for beside in lens.parent.iterdir():
            (at / beside.name).symlink_to(beside)
        heads = ('', '\ufeff', f'name: |\n  {LURE}', f'"name"  : |\n  {LURE}', f'---\nname: >\n  {LURE}', f'# a\n\n\'name\': |\n  {LURE}',
                 f'%YAML 1.2\n---\nname: |\n  {LURE}')
        for head in heads if lens == lenses[0] else heads[:1]:
            got = []
            for name in ('one.yaml', 'lens', 'lens.txt'):
                (at / name).write_text(head + (re.sub('(?m)^name:.*\n', '', text) if 'name' in head else text))
                got.append(run('info', at / name, '-q', exit=None).stdout.replace(str(at / name), ''))
            for other in got[1:]:
                equal(other, got[0], f'{lens} behind {head}')


def test_forms_of_text():
    wanted = imported(PLAIN)[0]
    for text in (PLAIN.replace('\n', '\r\n'), PLAIN.replace('\n', '\r'), PLAIN.lower(), '\ufeff' + PLAIN, PLAIN[:-1],
                 PLAIN.replace('\n', ';\n'), PLAIN.replace('\n', '\n\n  ! &\n\t'), PLAIN.replace(' ', ' &\n  '),
                 PLAIN.replace('STO', 'STOP'), PLAIN.replace('EPD', 'epdiameter'), PLAIN.encode('utf-16')):
        equal(imported(text)[0], wanted, repr(text[:40]))
    equal(imported(plain('LEN', 'LEN\nTIT "M\xfcller"').encode('latin-1'))[0], 'name: "Müller"\n' + wanted)
    equal(imported(PLAIN, name='a.txt')[0], wanted, 'by its content')
    equal(imported(PLAIN, name='a.zmx')[0], wanted, 'by its content')
    equal(imported(TWINS[1][0], name='a.seq')[0], imported(TWINS[1][0], name='a.zmx')[0], 'by its content')
    for text in ('hello\n', '', 'x: 1\n', 'EPD 4\n'):
        if 'no sequence file of CODE V' not in refused(text):
            raise AssertionError(f'{text!r}: {refused(text)}')


def zoomed(command, fields='0', waves='587.5618'):
    """The command behind ZOO, in line 15 of PLAIN."""
    return plain('GO', f'ZOO 2\n\nZOO {command}\nGO').replace('YAN 0', 'YAN ' + fields).replace('WL 587.5618', 'WL ' + waves)


def test_refused():
    for text, line, words in (
            (plain(behind='RET S1\n'), 11, 'RET: is not read'), (plain(behind='GLB S1\n'), 11, 'GLB'),
            (plain(behind='XTO\n'), 11, 'XTO: is not read'), (plain(behind='SPS ODD\n'), 11, 'SPS'),
            (plain(behind='QQQ 3\n'), 11, 'QQQ: this command of a surface is not known'),
            (plain(behind='S3X 3\n'), 11, 'is not known'), (plain('GO', 'QQQ S1 3\nGO'), 13, 'QQQ'),
            (plain(behind='ADE x\n'), 11, '"x" is not a finite number'), (plain(behind='ADE\n'), 11, 'a value is missing'),
            (plain(behind='CUF .1\n'), 11, 'Fresnel'), (plain(behind='CUX .1\n'), 11, 'two curvatures'),
            (plain(behind='CON;A 1e-5\n'), 11, 'it is a conic'), (plain(behind='REV;ADE 1\n'), 11, 'whether REV moves'),
            (plain(behind='DIF HOE\n'), 11, 'DOE'), (plain(behind='DIF DOE;HCT XY\n'), 11, 'HCT'),
            (plain(behind='K S7 1\n'), 11, 'no surface 7'), (plain(behind='K S1..0 1\n'), 11, 'backwards'),
            (plain('SO 0 1e13\n', ''), 8, 'before the object'), (plain('SI 0 0\n', ''), 12, 'without an image'),
            (plain('SI 0 0\nGO\n', ''), 11, 'no image surface'), (plain('RDM\n', '').replace('EPD', 'FNO'), 8, 'RDM: is missing'),
            (plain('SI 0 0', 'SI 0 0\nS 0 1'), 13, 'there is no surface 4'), (plain('GO', 'LEN\nGO'), 13, 'second lens'),
            (plain('REF 1', 'REF 2'), 6, 'no wavelength 2'), (plain('EPD 4', 'EPD 0'), 4, 'none'),
            (plain('WL 587.5618', 'WL -3'), 5, 'no wavelength'), (plain('DIM M', 'DIM Q'), 3, 'no known unit'),
            (plain('SO 0 1e13', 'SO 0 -5'), 8, 'behind the first surface'), (plain('S -60 40', 'S -60 1e10'), 11, 'infinitely far'),
            (plain('LEN', 'RES a.len'), 2, 'another file'), (plain('GO', 'ZOO THI S1 1 2\nGO'), 13, 'number of positions'),
            (plain('GO', 'ZOO 2\nZOO THI S1 1\nGO'), 14, 'THI has 1 values behind it, and not 2'), (plain('GO', 'ZOO 2\nZOO S 1 2\nGO'), 14, 'how "S" is zoomed'),
            (plain('S -60 40', 'S -60'), 11, 'a value is missing'), (PLAIN[:PLAIN.index(' 0\nGO')], 12, 'cut off'),
            (zoomed('YAN 5 7', fields='0 5'), 15, '1 value for 2 fields'), (zoomed('WTF 1 .5', fields='0 5'), 15, '1 value for 2 fields'),
            (zoomed('VUY 0 .1', fields='0 5'), 15, '1 value for 2 fields'), (zoomed('XAN 0 1', fields='0 5'), 15, '1 value for 2 fields'),
            (zoomed('WL 500 600', waves='500 600'), 15, '1 value for 2 wavelengths'), (zoomed('WTW 1 2', waves='500 600'), 15, 'wavelengths'),
            (zoomed('THI 4 5'), 15, 'THI needs the number of its surface'), (zoomed('GLA NBK7 NSF5'), 15, 'number of its surface'),
            (zoomed('STO 1 2'), 15, 'how "STO" is zoomed'), (zoomed('YAN F3 5 7'), 15, 'no field 3'),
            (plain('GO', 'YAN Z1 0 3\nGO'), 13, '2 values for 1 fields'), (plain('YAN 0', 'YAN F2 3'), 7, 'no field 2'),
            (plain('YAN 0', 'YAN 0 5\nXAN F4 1'), 8, 'no field 4'), (plain('EPD 4', 'EPD F1 4'), 4, 'qualifier of a field'),
            (plain(behind='K W1 1\n'), 11, 'qualifier of a wavelength'), (plain(behind='K C1 1\n'), 11, 'qualifier of a wavelength or term'),
            (plain(behind='THI F1 3\n'), 11, 'qualifier of a field'), (plain(behind='K EDG 1\n'), 11, 'qualifier of an aperture'),
            (plain(behind="K L'a' 1\n"), 11, 'qualifier of an aperture'), (plain('GO', 'EPD S1 4\nGO'), 13, 'qualifier of a surface'),
            (plain('S -60', 'S S1 -60'), 11, 'qualifier of a surface'), (plain('WL 587.5618', 'WL F1 587.5618'), 5, 'qualifier of a field'),
            (plain('GO', 'ZOO 2\nZOO THI S1 4 5\nTHI S1 6\nGO'), 15, 'behind line 14, which zooms it'),
            (plain('GO', 'THI S1 Z2 5\nTHI S1 6\nGO'), 14, 'behind line 13, which zooms it'),
            (plain('WL 587.5618', 'WL .5876'), 5, 'nanometres'), (plain('LEN', 'PRV\nPWL .5 .6\nEND'), 3, 'nanometres'),
            (plain(behind='DIF DOE\nHWL .5\n'), 12, 'nanometres'),
            (plain(behind='DIF DOE\nHX1 0;HX2 1\n'), 11, 'two beams'), (plain(behind='DIF DOE\nHV1 REA;HV2 VIR\n'), 11, 'two beams'),
            (plain(behind='HZ1 3\n'), 11, 'without a DIF DOE'), (plain(behind='DIF DOE\nHV1 Q\n'), 12, 'REA or VIR is'), (plain(behind='IC N\n'), 11, 'other point'), (plain(behind='IC\n'), 11, 'a value is missing'),
            (plain('GO', 'PRV\n'), 13, 'no END'), (plain('STO', 'STO S0'), 10, 'object cannot be the stop')):
        try:
            got = refused(text)
        except AssertionError as accepted:
            raise AssertionError(f'{words!r} in line {line}: {accepted}\n{text}')
        if f'a.seq:{line}: ' not in got or words not in got or got.count('\n') != 1:
            raise AssertionError(f'{words!r} in line {line}: {got}\n{text}')
    for number, words in ((2, 'no number 2'),):
        if words not in refused(PLAIN, '--configuration', number):
            raise AssertionError(refused(PLAIN, '--configuration', number))


def test_remarks():
    for text, line, key, words in (
            (plain('LEN', 'LEN\nQQQ 3'), 3, 'QQQ', 'left out: an unknown command'),
            (plain('YAN 0', 'WID Y\nYAN 0'), 7, 'WID', 'left out'), (plain('YAN 0', 'POL Y\nYAN 0'), 7, 'POL', 'left out'),
            (plain('YAN 0', 'TEM 30\nYAN 0'), 7, 'TEM', 'left out: indices are those at 20'),
            (plain('YAN 0', 'PRE 700\nYAN 0'), 7, 'PRE', 'left out'), (plain('GO', 'AUT; EFL 50; S1 = 3\nGO\nGO'), 13, 'AUT', 'left out'),
            (PLAIN + 'K S1 3\n', 14, 'GO', 'left out: 1 command behind'), (plain(behind='PIK\n'), 11, 'PIK', 'taken as the number'),
            (plain(behind='CUY UMY -.1\n'), 11, 'CUY', 'taken as the number'), (plain('SI', 'PIM\nSI'), 12, 'PIM', 'which its solve gives'),
            (plain(behind='SPH;K 2\n'), 11, 'K', 'left out'), (plain(behind='CIR HOL 3\n'), 11, 'CIR', 'left out'),
            (plain(behind='REX 3\n'), 11, 'REX', 'left out'), (plain(behind='CIR 3\n'), 11, 'CIR', 'CA'),
            (plain('STO\n'), 1, 'STO', 'first surface'), (plain('GO\n'), 12, 'GO', 'cut off'),
            (plain('RDM\nLEN', 'LEN').replace('EPD 4', 'EPD 20'), 8, 'RDM', 'taken as radii'),
            (plain('RDM\nLEN', 'LEN').replace('EPD 4', 'EPD 20').replace('S 50', 'S .02').replace('S -60', 'S -.01'), 8, 'RDM',
             'taken as curvatures'),
            (plain('YAN 0', 'YAN 0 1\nWTF 1'), 8, 'WTF', '1 where it lacks'), (plain('YAN 0', 'XAN 1\nYAN 0 1'), 7, 'XAN', '0 where it lacks'),
            (plain('EPD 4', 'EPD 4 5'), 4, 'EPD', 'left out: what stands behind'), (plain('DIM M\n'), 1, 'DIM', 'millimetres'),
            (plain(behind='ADE 1\n'), 11, 'STO', 'aimed at the stop'),
            *((plain(behind=f'{word} 100\n'), 11, word, 'left out: by its name a code') for word in 'XDC YDC ZDC ADC BDC CDC'.split()),
            (plain(behind='IC Y\n'), 11, 'IC', 'ordinary one of two points'), (plain('SI', 'PIM 3\nSI'), 12, 'PIM', 'left out: what stands behind'),
            (plain('NBK7_SCHOTT', '517.642'), 9, 'S', 'nd 1.517 and Vd 64.2: the fictitious glass 517.642 of 1 surface,'),
            (plain('NBK7_SCHOTT', '1.5168:64.17'), 9, 'S', 'nd 1.5168 and Vd 64.17: the fictitious glass 1.5168:64.17 '),
            (plain(behind='S 9 1 517642\nS 8 1\nS 9 1 517642\nS 9 1 620.364\n'), 11, 'S', 'nd 1.517 and Vd 64.2: the fictitious glass 517642 of 2 '
             'surfaces'),
            (plain(behind=''.join(f'S 9 1 6{i}0.364\n' for i in range(10, 60))), 27, 'S', 'other fictitious glasses of 34 surfaces'),
            (plain(behind='CIR 3\nCA N\n'), 11, 'CIR', 'CODE V asks for CA'),
            (plain(behind="CIR L'front side' 3\nREX L'front side' 3\n"), 12, 'REX', 'left out'),
            (plain('GO', "ZOO 2\nZOO TIT 'a b' 'c'\nGO"), 14, 'ZOO', 'left out: a TIT of each position'),
            (plain('GO', 'ZOO 2\nZOO THI S1 4 5\nGO'), 13, 'configurations', 'the file has 2')):
        got = imported(text)[1]
        if not any(g[:2] == (line, key) and words in g[2] for g in got):
            raise AssertionError(f'{line}: {key}: {words}: {got}\n{text}')
        if any(g[2].startswith('left out') for g in got):
            refused(text, '--strict')
        else:
            equal(imported(text, '--strict'), imported(text))
    if 'aim: stop' not in imported(plain(behind='ADE 1\n'))[0]:
        raise AssertionError('rays are not aimed')
    equal(imported(PLAIN)[1], [])


def test_commands_without_effect():
    """Those of the table of docs/import.md are silent and change nothing."""
    wanted = imported(PLAIN)
    page = (HERE.parents[1] / 'docs' / 'import.md').read_text()
    table = page[page.index('<!-- commands without effect -->'):]
    table = table[:table.index('<!-- end -->')]
    words = [w for row in re.findall(r'^\| (`.*?) \|', table, re.MULTILINE) for w in re.findall('`([A-Z]+)`', row)]
    sources = ''.join(p.read_text() for p in (HERE.parents[1] / 'src' / 'lens' / 'read').glob('seq_*.c'))
    equal(sorted(words), sorted(re.findall(r'{"([A-Z]+)", SEQ_IDLE', sources) + ['INI']), 'the table of the page')
    for word in words:
        equal(imported(plain(behind=f'{word} 100\n')), wanted, word)
    equal(imported(plain(behind=''.join(f'{word} 100\n' for word in words)))[0], wanted[0])


def test_many_surfaces():
    """Time and memory grow with the file."""
    def seconds(count):
        body = 'S 50 .01 517642\nCIR 3;K -1\nYDE .001; DAR\nS -60 .01\n' * (count // 2)
        file = written('RDM\nDIM M\nEPD 4\nWL 500\nYAN 0\nSO 0 1e11\n' + body + 'SI 0 0\nGO\n', 'a.seq')
        begin = time.perf_counter()
        run('import', file, '-q', '-o', file.with_name('b.yaml'))
        return time.perf_counter() - begin
    few, many = min(seconds(5000) for _ in range(2)), seconds(50000)
    if not many < 20 * few + 0.2:
        raise AssertionError(f'5000 surfaces in {few:.2f} s, 50000 in {many:.2f} s')


main(globals())
