#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Zemax .zmx files: no field of a record is dropped without a word.

    python3 test_zmx_fields.py SAGITTA

Each field of each record is changed to another value that such a field may have, one at a time.  Then the
imported lens differs, or a remark names the record, or the reading is refused by its name, or the field is
in the table "Fields without effect" of docs/import.md.  The table is held to it, too: what stands there
changes nothing and makes no remark.

The files are those of tests/data/zmx, one with shapes that they lack, and some written here in which every field of every kind of record
matters.  In these each field must show; in the others each record that the former lack.
"""
import collections
import os
import pathlib
import random
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / 'tool'))
from command import *  # noqa: E402
import zmx_oracle  # noqa: E402

SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'), 0)
SCALE = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))
DATA = HERE.parent / 'data' / 'zmx'
DOCS = HERE.parent.parent / 'docs' / 'import.md'
os.environ['SAGITTA_GLASS'] = str(zmx_oracle.GLASSES)

# What may stand in place of a word.
WORDS = {'SEQ': ['NSC'], 'MM': ['CM', 'IN'], 'IN': ['MM'], 'METER': ['MM'],
         'STANDARD': ['TILTSURF', 'COORDBRK'], 'INFINITY': ['300'], 'SCHOTT': ['OHARA'],
         'N-BK7': ['N-SF6'], '""': ['"A"']}
# A remark that says of a whole record what becomes of it.
WHOLE = re.compile('left out: |taken as the number that is stored|taken as the numbers that are stored')

SURFACES = '''SURF 0
  TYPE STANDARD
  CURV 0 0 0 0 0 ""
  DISZ 200
  GLAS N-BK7 0 0 1.5 40 0 0 0 0 0 0
SURF 1
  TYPE STANDARD
  COMM the first
  CURV 0.02 2 0.5 0.5 3 ""
  CONI -0.5
  DISZ 4
  GLAS N-BK7 0 0 1.5 40 0 0 0 0 0 0
  DIAM 6 0 0 0 1 ""
  CLAP 0.5 5 0
  OBDC 0.1 0.2
  SCBD 1 0 1 0.1 0.2 3 4 5
  SCBD 2 1 2 0.1 0.2 3 4 5
  COAT AR
  MIRR 2 0
  MEMA 6 0 0 0 1 ""
  HIDE 0 0 0 0 0 0 0 0 0 0
  SLAB 11
  SSID 0
  FIMP 
  POPS 0 0 0 0 0 0 0 0 1 1 1 1 0 0 0 0
  VPAR 1 0 0
  VDSZ -1e+10 1e+10
  TCED 1.5
SURF 2
  TYPE EVENASPH
  CURV 0.01 0 0 0 0 ""
PARMS 8
  DISZ 3
  GLAS ___BLANK 1 0 1.6 50 0.01 1 1 1 0 0
  OBSC 0.1 2 0
  STOP
  DIAM 5 0 0 0 1 ""
  MAZH 0 0.5
  CHZH 0.5 0
  EDGE 0.5 0.5
  PZUP 1 2 3 0
  PKUP 1 2 3 0
  PPAR 1 3 -1 0 2
SURF 3
  TYPE ODDASPHE
  CURV 0.01 0 0 0 0 ""
PARMS 8
  DISZ 3
  GLAS ___BLANK 2 2 1.6 50 0.01 0 0 0 0 0
  SQAP 3 2 0
  SPID 0.1 3
SURF 4
  TYPE TOROIDAL
  CURV 0.01 0 0 0 0 ""
  CONI 0.5
PARMS 8
  DISZ 3
  GLAS N-BK7 3 0 1.5 40 0 0 0 0 0 0
  ELAP 3 2 0
  SQOB 1 2
SURF 5
  TYPE BICONICX
  CURV 0.01 0 0 0 0 ""
  CONI 0.5
PARMS 2
  DISZ 3
  FLAP 0 4 0
  DIAM 4 0 0 0 1 ""
  ELOB 1 2
SURF 6
  TYPE XPOLYNOM
  CURV 0.01 0 0 0 0 ""
  XDAT 1 2 0 0 1 0 0 ""
  XDAT 2 10 0 0 1 0 0 ""
  XDAT 3 0.01 0 0 1 0 0 ""
  XDAT 4 0.02 0 0 1 0 0 ""
  DISZ 3
  UDAD 1 x.uda
SURF 7
  TYPE TILTSURF
PARMS 2
  DISZ 3
SURF 8
  TYPE COORDBRK
PARMS 5
  PARM 6 1
  DISZ 2
SURF 9
  TYPE PARAXIAL
  PARM 1 100
  PARM 2 1
  DISZ 5
SURF 10
  TYPE STANDARD
  SCBD 3 0 0 0.1 0.2 3 4 5
  DISZ 40
SURF 11
  TYPE STANDARD
  DISZ 0
'''

def terms(kind, first, count, more=()):
    """A surface with XDAT `first` ...: as many terms, their radius, themselves."""
    numbers = [count, 8, *(0.01 * (i + 1) for i in range(count))]
    return [f'TYPE {kind}', 'CURV 0.01 0 0 0 0 ""', *more,
            *(f'XDAT {first + i} {x!r} 0 0 1 0 0 ""' for i, x in enumerate(numbers)), 'DISZ 3']


# Those whose shape is in XDAT or in records of its own.
SHAPES = [
    ['TYPE STANDARD', 'DISZ 100'],
    terms('XASPHERE', 1, 2, ['STOP']),
    terms('XODDASPH', 1, 3),
    terms('QED_TYPE', 2, 2, ['CONI -0.5', 'XDAT 1 1 0 0 1 0 0 ""']),
    terms('FZERNSAG', 1, 5, ['PARM 0 1', 'PARM 2 1e-5']),
    terms('SZERNSAG', 1, 5, ['PARM 0 1']),
    ['TYPE IRREGULA', 'CURV 0.01 0 0 0 0 ""', *(f'PARM {i} {0.1 * i!r}' for i in range(1, 9)), 'DIAM 5 0 0 0 1 ""',
     'DISZ 3'],
    ['TYPE QED_TYPE', 'CURV 0.01 0 0 0 0 ""', 'CONI -0.5', *(f'XDAT {i} {x} 0 0 1 0 0 ""' for i, x in
     enumerate((0, 2, 8, 0.01, 0.02), 1)), 'DISZ 3'],
    ['TYPE DGRATING', 'CURV 0.01 0 0 0 0 ""', 'CONI 0.5', 'PARM 1 0.1', 'PARM 2 1', 'DISZ 3'],
    terms('BINARY_1', 1, 5, ['CONI 0.5', 'PARM 0 1', 'PARM 2 1e-5']),
    terms('BINARY_2', 1, 3, ['PARM 0 1', 'PARM 2 1e-5']),
    ['TYPE BINARY_3', 'CURV 0.01 0 0 0 0 ""', 'CONI 0.5', *(f'PARM {i} {x}' for i, x in
     enumerate((50, -0.5, 2, 5, 1, 2, 0, 0), 1)), 'XDAT 1 1', *(f'XDAT {i} {x}' for i, x in
     enumerate((0.001, 100, 0.002, 200), 2)), 'DISZ 3'],
    terms('FZERNPHA', 1, 5, ['CONI 0.5', 'PARM 0 1', 'PARM 1 1']),
    terms('SZERNPHA', 1, 5, ['PARM 0 1', 'PARM 1 1']),
    *([f'TYPE HOLOGRM{kind}', 'CURV 0.01 0 0 0 0 ""', *(f'PARM {i} {x}' for i, x in
       enumerate((1, 2, -50, 3, 4, 60, 0.55, 1), 1)), 'DISZ 3'] for kind in (1, 2)),
    terms('GRID_SAG', 1, 3, ['GDAT 4 4 3.5 3.5 0 0', *(f'GARR {i} {0.01 * i * i!r} 0.1 0.2 0.3 0' for i in range(16))]),
    ['TYPE STANDARD', 'DISZ 0']]


SYSTEM = '''VERS 140730 73 26155
MODE SEQ
NAME a name
AUTH none
IWDP 0
NOTE 0 a note
PFIL 0 0 0
LANG 0
UNIT MM X W X CM MR CPMM
ENPD 4
ENVD 30 1.5 1
GFAC 1 1
GCAT SCHOTT OHARA
RAIM 0 1 1 1 0 0 0 0 0 1
PUSH 0 0 0 0 0 0
SDMA 0 1 0
OMMA 1 1
FTYP 1 0 2 2 0 0 0 3
ROPD 2
HYPR 0
PICB 1
XFLN 0 1
YFLN 2 3
FWGN 1 2
VDXN 0.1 0.2
VDYN 0.1 0.2
VCXN 0.1 0.2
VCYN 0.1 0.2
VANN 10 20
ZVDX 0.1 0.2
ZVDY 0.1 0.2
ZVCX 0.1 0.2
ZVCY 0.1 0.2
ZVAN 10 20
WAVM 1 0.55 1
WAVM 2 0.6 2
PWAV 2
POLS 1 0 1 0 0 1 0
GLRS 1 0
GSTD 0 100 100 100 100 100 100 0 1 1 0 0 1 1 1 1 1 1
NSCD 100 500 0 1e-6 5 1e-6 0 0 0 0 0 1 1000000 0 2
COFN QF COATING.DAT SCATTER_PROFILE.DAT ABG_DATA.DAT PROFILE.GRD
LUID 23
EERA 0 0 0 10 10
CSUM 12345
'''

AFTER = '''TOL TOFF 0 0 0 0 0 0 0 0
MNUM 3 2
MOFF 0 1 "" 0 0 0 1 1 0 0.0 "" 0
EFFL 1 12 0 0 0 0
'''


def surfaces():
    """With a line for each PARM, none of them 0; those of an asphere are not alike."""
    return re.sub('PARMS (.)', lambda m: '\n'.join(f'  PARM {i} {0.5 + i / 8!r}' for i in
                                                    range(1, int(m[1]) + 1)), SURFACES)


def written_here():
    """The files, by name: one of nearly every record, and those for records that it cannot have besides."""
    whole = SYSTEM + surfaces() + AFTER
    simple = 'SURF 0\n DISZ 200\nSURF 1\n STOP\n CURV 0.01\n DIAM 3 1\n DISZ 90\nSURF 2\n DISZ 0\nMNUM 1 1\n'
    head = 'MODE SEQ\nUNIT MM\n'
    out = {'whole': whole, 'plain air': f'{head}ENPD 4\nENVD 30 1.5 0\n{simple}'}
    for name, pupil in (('f-number', 'FNUM 8 0'), ('aperture', 'OBNA 0.1 0'), ('cone', 'OBNA 5 1'),
                        ('float', 'FLOA')):
        out[name] = f'{head}{pupil}\nFTYP 1 0 1 1 0 0 0\nYFLN 1\nWAVM 1 0.55 1\n{simple}'
    out['old'] = (f'{head}ENPD 4\nFTYP 1 0 2 2\nXFLD 0 1\nYFLD 2 3\nFWGT 1 2\nWAVL 0.55 0.6\nWWGT 1 2\n'
                  f'PWAV 1\nTEMP 30\nPRES 2\n{simple}')
    out['middle-aged'] = f'{head}ENPD 4\nFTYP 1 0 2 2\nYFLN 2 3\nWAVN 0.55 0.6\nWWGN 1 2\nPWAV 1\n{simple}'
    return out


def files():
    yield 'shapes', ('MODE SEQ\nUNIT MM\nENPD 4\nFTYP 1 0 1 1 0 0 0\nYFLN 1\nWAVM 1 0.55 1\n' +
                     ''.join('\n  '.join([f'SURF {i}', *records]) + '\n' for i, records in enumerate(SHAPES)) +
                     'MNUM 1 1\n')
    for path in sorted(DATA.glob('*.zmx')):
        data = path.read_bytes()
        utf16 = data[:2] in (b'\xff\xfe', b'\xfe\xff')
        yield path.name, data.decode('utf-16' if utf16 else 'latin-1')


IN_USE = {**dict.fromkeys('XFLN YFLN FWGN XFLD YFLD FWGT VDXN VDYN VCXN VCYN VANN ZVDX ZVDY ZVCX ZVCY '
                         'ZVAN'.split(), 3), **dict.fromkeys('WAVM WAVN WWGN WAVL WWGT'.split(), 4)}


def place(record, words, field, system):
    """The record, as the table names it, where its number counts: in lists FTYP says how many are in use."""
    if words[0] in IN_USE:
        number = int(words[1]) if words[0] == 'WAVM' else field
        if number > int(system['FTYP'][IN_USE[words[0]]]):
            return f'{words[0]} beyond those in use'
    return record


def kinds(text):
    """Of each line: its record, as the table names it, or None.  What one record's fields mean may hang on
    another field, or on the type of the surface."""
    out, surface, type_ = [], -1, ''
    last = len(re.findall(r'^\s*SURF ', text, re.M)) - 1
    for line in text.splitlines():
        words = line.split()
        key = words[0] if words else None
        if key == 'SURF':
            surface, type_ = int(words[1]), 'STANDARD'
        if key == 'TYPE':
            type_ = words[1]
        if key == 'GLAS':
            # A name may have blanks in it; those of these files have none.
            key = f'GLAS with status {words[2] if len(words) > 2 else 0}'.replace('status 3', 'status 0')
        elif key == 'ENVD' and words[3] == '0':
            key = 'ENVD with field 3 = 0'
        elif (key, words[1:2]) in (('GFAC', ['0']), ('MNUM', ['1'])):
            key = f'{key} with field 1 = {words[1]}'
        elif key == 'DISZ' and surface == last:
            key = 'DISZ of the last surface'
        elif key == 'SCBD' and words[1] == '3':
            key = 'SCBD with field 1 = 3'
        elif key == 'PARM' and type_ == 'PARAXIAL' and words[1] == '2':
            key = 'PARM 2 of PARAXIAL'
        out.append(key)
    return out


def others(word):
    """Other values that may stand there."""
    if word in WORDS:
        return WORDS[word]
    try:
        x = float(word)
    except ValueError:
        return [word + 'X']
    if abs(x) > 1e6:
        return ['300']
    if x in (0, 1):
        return [str(1 - int(x)), '2']
    if x == int(x):
        return [str(int(x) + 1), str(int(x) - 1)]
    return [repr(x * 1.25)]


def imported(text):
    """The lens and the remarks, or the error: (exit status, YAML, lines of stderr without the file)."""
    path = written(text, 'a.zmx')
    done = subprocess.run([SAGITTA, 'import', str(path)], capture_output=True, timeout=100)
    assert done.returncode in (DECIDED, BAD_INPUT), done.stderr.decode()[-1000:]
    stderr = done.stderr.decode().replace('sagitta: ', '').replace(str(path) + ':', '').splitlines()
    return done.returncode, done.stdout.decode(), stderr


def named(key, told):
    """Whether a remark says what becomes of all of such a record."""
    return any(re.match(rf'\d+: {re.escape(key)}: ', words) and WHOLE.search(words) for words in told)


def shows(text, at, field, value, before):
    """Whether this value in place of that of the record in line `at` shows."""
    lines = text.splitlines()
    words = list(re.finditer(r'\S+', lines[at]))  # what stands between them stays: a text may count its blanks
    key, word = words[0][0], words[field]
    changed = lines[at][:word.start()] + value + lines[at][word.end():]
    status, lens, told = imported('\n'.join([*lines[:at], changed, *lines[at + 1:]]) + '\n')
    if status == BAD_INPUT:
        return True  # by the name of the record, or of another that contradicts it now
    return (lens, told) != before[1:] or named(key, told)


def without_effect():
    """The table of docs/import.md: {record: function of a field}."""
    table = DOCS.read_text().split('<!-- fields without effect -->')[1].split('<!-- end -->')[0]
    out = {}
    for row in re.findall(r'^\| (`.*?) \| (.*?) \|', table, re.M):
        fields = set()
        for part in row[1].split(', '):
            m = re.fullmatch(r'(all)|(\d+)( on)?|(\d+) to (\d+)', part)
            assert m, f'docs/import.md: fields {part!r}'
            if m[1]:
                fields |= set(range(1, 100))
            elif m[4]:
                fields |= set(range(int(m[4]), int(m[5]) + 1))
            else:
                fields |= set(range(int(m[2]), 100 if m[3] else int(m[2]) + 1))
        for record in row[0].replace('`', '').split(', '):
            assert record not in out, f'docs/import.md: {record} twice'
            out[record] = fields
    return out


def test_fields():
    """Each field of each record shows, or is in the table; what is there does not show."""
    generator, listed = random.Random(f'{SEED} fields'), without_effect()
    faults, seen, count = [], collections.defaultdict(set), 0
    for here, (name, text) in [*((True, f) for f in written_here().items()), *((False, f) for f in files())]:
        before, places = imported(text), collections.defaultdict(list)
        assert before[0] == DECIDED, f'{name}: {before[2]}'
        lines = text.splitlines()
        system = {words[0]: words for words in map(str.split, lines) if words}
        for at, record in enumerate(kinds(text)):
            words = lines[at].split()
            for field in range(1, len(words)):
                places[place(record, words, field, system), field].append(at)
        for (record, field), lines_of_it in places.items():
            idle = field in listed.get(record, ())
            # What has no effect has none anywhere: a part of such places, as many as SCALE says, is tried.
            if idle and generator.random() > (2 if here else 0.3) * SCALE:
                continue
            if not here:
                if field in seen[record]:  # what shows where it matters need not show here
                    continue
                lines_of_it = [generator.choice(lines_of_it)] if idle else lines_of_it
            for at in lines_of_it:
                count += 1
                word = lines[at].split()[field]
                told = any(shows(text, at, field, value, before) for value in others(word))
                if not idle and told:
                    seen[record].add(field)
                if idle and told:
                    faults.append(f'{name}:{at + 1}: {record}, field {field}, is listed as without effect, '
                                  f'and has one: {lines[at].strip()}')
                if not idle and not told and (here or field not in seen[record]):
                    faults.append(f'{name}:{at + 1}: {record}, field {field}, is dropped without a word: '
                                  f'{lines[at].strip()}')
                    if not here:
                        break
    assert not faults, f'{len(faults)} of {count}\n' + '\n'.join(faults)
    print(f'{count} fields changed')


def test_table():
    """The table names records that the files have."""
    there = {kind for _, text in [*written_here().items(), *files()] for kind in kinds(text)}
    table = {record for record in without_effect() if 'beyond' not in record}
    equal(sorted(table - there), [], 'records in the table that no file has')


if __name__ == '__main__':
    print(f'SAGITTA_TEST_SEED={SEED}')
    main(globals())
