#!/usr/bin/env python3
"""sagitta diagnose: the published iterations, and what is said of them.

    python3 test_diagnose.py SAGITTA
"""
import math

from command import *

SPHERE = '{type: sphere, radius: -2.2136}'
RAY = '0 0.5 -5 0 0.3420201433256687 0.9396926207859084'
GOLDEN = ('--surface', SPHERE, '--ray', RAY)
ROOT = 4.143085073464611924

# The first surface of a scan lens (M. Laikin, Lens Design, 4th edition, page 251) met at 20
# degrees; published as the debugging record of a ray tracer whose gradient was scaled to unit length.
NORMALISED = [4.775443550511577, 2.8626356840250526, 4.7418998688939, 2.997895475725084, 4.714415826981489]
NEWTON = [4.290929334615741, 4.146508589123462, 4.1430866948353255, 4.143085073464975]


def diagnose(*arguments, **how):
    return rows('diagnose', *arguments, **how)


def test_columns():
    for method in ('safeguarded', 'newton', 'bisection'):
        done = run('diagnose', *GOLDEN, '--method', method, '--format', 'csv')
        equal(done.stdout.splitlines()[0], DIAGNOSE)


def test_newton_as_published():
    got = diagnose(*GOLDEN, '--method', 'newton')
    equal([r['move'] for r in got], ['seed', 'retreat'] + ['newton'] * (len(got) - 2))
    equal([int(r['eval']) for r in got], list(range(1, len(got) + 1)))
    close(got[0]['t'], 5 / 0.9396926207859084, 1e-15)
    equal(float(got[1]['t']), float(got[0]['t']) / 2)
    equal(got[0]['f'], 'nan')
    for row, t in zip(got[2:], NEWTON):
        close(row['t'], t, 1e-14)
    close(got[-1]['t'], ROOT, 1e-15)
    assert len(got) <= 8, got


def test_normalised_as_published():
    got = diagnose(*GOLDEN, '--method', 'newton-normalised', exit=UNDECIDED)
    equal(len(got), 100)
    for row, t in zip(got[2:], NORMALISED):
        close(row['t'], t, 1e-14)
    # it is still to and fro at the end, and its slope is the cosine of an angle
    assert (float(got[-1]['t']) - ROOT) * (float(got[-2]['t']) - ROOT) < 0
    assert all(abs(float(r['slope'])) <= 1 for r in got[1:])
    equal(len(diagnose(*GOLDEN, '--method', 'newton-normalised', '--max-evals', '7', exit=UNDECIDED)), 7)


def test_normalised_explained():
    text = run('diagnose', *GOLDEN, '--method', 'newton-normalised', exit=UNDECIDED).stdout
    assert 'oscillating' in text and '|grad F|' in text and 'Not settled after 100 evaluations' in text, text[-900:]
    assert '-0.99995' in text, text[-900:]  # 1 - |grad F| = 1 - 1/sqrt(1 - (y/R)^2) at the root
    y = 0.5 + ROOT * 0.3420201433256687
    close(1 - 1 / math.sqrt(1 - (y / 2.2136) ** 2), -0.99995, 1e-5)


def test_safeguarded():
    got = diagnose(*GOLDEN)
    assert len(got) <= 4
    close(got[-1]['t'], ROOT, 1e-15)
    equal(got, diagnose(*GOLDEN, '--method', 'safeguarded'))
    text = run('diagnose', *GOLDEN).stdout
    assert 'hit at t = 4.143085073464612' in text, text


def test_bisection():
    got = diagnose(*GOLDEN, '--method', 'bisection')
    halved = [r for r in got if r['move'] == 'bisect']
    assert 45 < len(halved) < 70
    close(halved[-1]['t'], ROOT, 2e-15)
    widths = [float(r['hi']) - float(r['lo']) for r in halved]
    for wide, narrow in zip(widths[:40], widths[1:40]):
        close(narrow, wide / 2, 1e-14)
    for row in halved:
        assert float(row['lo']) <= ROOT + 1e-14 and ROOT - 1e-14 <= float(row['hi'])


def test_bisection_without_ends():
    shown = ('--surface', '{type: plane}', '--method', 'bisection')
    done = run('diagnose', *shown, '--ray', '0 0 -5 0 0 1', exit=UNDECIDED)
    assert 'infinite' in done.stdout, done.stdout
    assert len(diagnose(*shown, '--ray', '0 0 -5 0 0 1 0 7.3')) > 40
    done = run('diagnose', *shown, '--ray', '0 0 -5 0 0 1 6 8', exit=UNDECIDED)
    assert 'same sign at both ends' in done.stdout, done.stdout


def test_bare_newton_that_finds_nothing():
    """A ray beside the sphere: halving toward the origin ends nowhere, and says so."""
    got = diagnose('--surface', SPHERE, '--ray', '0 5 -5 0 0 1', '--method', 'newton', exit=UNDECIDED)
    assert len(got) == 100 and all(r['f'] == 'nan' for r in got)
    text = run('diagnose', '--surface', SPHERE, '--ray', '0 5 -5 0 0 1', '--method', 'newton', exit=UNDECIDED).stdout
    assert 'the ray certainly does not meet the surface' in text
    # parallel to the vertex plane of a plane: no slope at all
    text = run('diagnose', '--surface', '{type: plane}', '--ray', '0 0 -5 0 1 0', '--method', 'newton', exit=UNDECIDED).stdout
    assert 'the slope is 0 there' in text, text


def test_a_miss_is_decided():
    done = run('diagnose', '--surface', SPHERE, '--ray', '0 5 -5 0 0 1')
    assert 'miss' in done.stdout


def test_lens():
    lens = LENSES / 'ftheta.yaml'
    got = diagnose(lens)
    equal(sorted({r['element'] for r in got}), [str(i) for i in range(1, 9)])
    equal(len({r['ray'] for r in got}), 1)
    got = diagnose(lens, '--field', '20', '--fan', '5', '--ray', '4', '--element', '2')
    equal({(r['ray'], r['element']) for r in got}, {('4', '2')})
    # what it ends on is what the trace says, and the trace's t is from the element before
    hit = [r for r in rows('trace', lens, '--field', '20', '--fan', '5') if (r['ray'], r['element']) == ('4', '2')][0]
    close(got[-1]['t'], hit['t'], 1e-14)
    close(hit['t'], ROOT, 1e-6)  # the very ray of the record above, up to how its start was written


def test_bare_methods_in_a_lens():
    lens = LENSES / 'ftheta.yaml'
    one = ('--field', '20', '--fan', '5', '--ray', '4', '--element', '2')
    got = diagnose(lens, *one, '--method', 'newton')
    for row, t in zip(got[2:], NEWTON):
        close(row['t'], t, 1e-6)
    got = diagnose(lens, *one, '--method', 'newton-normalised', exit=UNDECIDED)
    for row, t in zip(got[2:], NORMALISED):
        close(row['t'], t, 1e-6)
    text = run('diagnose', lens, *one, '--method', 'newton-normalised', exit=UNDECIDED).stdout
    assert 'f-theta scan lens: ray 4.' in text and 'Element 2 (sphere)' in text, text[:300]


def test_ray_that_took_most():
    """The default is the ray with most evaluations in all, or at the element asked for."""
    lens = LENSES / 'aspheric_singlet.yaml'
    spent = {}
    for row in rows('trace', lens, '--fan', '9'):
        spent[row['ray']] = spent.get(row['ray'], 0) + int(row['evals'])
    chosen = diagnose(lens, '--fan', '9')[0]['ray']
    equal(spent[chosen], max(spent.values()))


def test_bisection_within_an_aperture():
    text = 'pupil: {semi_diameter: 1}\nsurfaces:\n  - {type: plane, thickness: 3, semi_diameter: 2}\n  - {type: even_asphere, radius: 20, coefficients: [1e-5], semi_diameter: 3}\n'
    for field in (0, 20):
        done = run('diagnose', written(text), '--method', 'bisection', '--field', field)
        equal(done.stdout.count('Settled at'), 2)
        equal(done.stdout.count(': the same'), 2)
        assert 'refused' not in done.stdout and 'as this method does' in done.stdout, done.stdout


def test_words_for_people_at_the_command():
    lens = ('diagnose', LENSES / 'aspheric_singlet.yaml')
    for shown in ((*lens,), (*lens, '--method', 'newton'), ('diagnose', *GOLDEN)):
        said = run(*shown).stdout
        assert 'sgt_' not in said and 'a seed' not in said, said
    assert 'polynomial form' in run(*lens, '--element', '1').stdout
    assert 'polynomial form' not in run(*lens, '--element', '2').stdout
    assert 'polynomial form' not in run(*lens, '--element', '1', '--format', 'csv').stdout
    said = run('diagnose', '--surface', SPHERE, '--ray', '0 5 -5 0 0 1', '--method', 'newton', exit=UNDECIDED).stdout
    assert 'halving t leads from one point where F is NaN to the next' in said, said
    plane = written('pupil: {semi_diameter: 1}\nsurfaces:\n  - {type: plane}\n')
    assert 'each took as many' in run('diagnose', plane).stdout
    assert 'took' not in run('diagnose', plane, '--fan', '1').stdout


def test_element_that_is_not_reached():
    lens = written('surfaces:\n  - {type: plane, semi_diameter: 1, thickness: 1}\n  - {type: plane}\n')
    one = ('diagnose', lens, '--rays', '-')
    done = run(*one, '--element', '2', stdin=rays((0, 2, -1, 0, 0, 1)), exit=USAGE)
    assert 'clipped at element 1' in done.stderr, done.stderr
    run(*one, '--element', '3', stdin=rays((0, 0, -1, 0, 0, 1)), exit=USAGE)


main(globals())
