# SPDX-License-Identifier: MIT
"""Lenses as sequence files of CODE V, a group of commands each, and what they mean, said by hand.

A surface of the second half is (curvature, thickness, index behind it or MIRROR) and what else it has: k, powers
{exponent: factor}, moves (XDE YDE ZDE ADE BDE CDE) with their kind, waves {exponent: factor} of a phase.  The
thickness of the last one before the image has the defocus of SI in it.
"""
MIRROR = 'mirror'


def s(c, t, n=1, k=0, powers=None, moves=(0,) * 6, kind='plain', waves=None):
    return {'c': c, 't': t, 'n': n, 'k': k, 'powers': powers or {}, 'moves': moves, 'kind': kind, 'waves': waves or {}}


HEAD = 'EPD 4\nWL 587.5618\nREF 1\nYAN 0\nDIM M\nSO 0 1e13\n'
PRV = '''PRV
  PWL 656.2725 587.5618&
    486.1327
  'P5' 1.49 1.5 1.51
  'P6' 1.59 1.6 1.61
  'P7' 1.69 1.7 1.71
END
'''
RADII, CURVATURES = PRV + 'RDM\nLEN\n' + HEAD, PRV + 'RDM N\nLEN\n' + HEAD

LENSES = {
    'radii': (RADII + "S 50 4 'P5'; STO; S -40 3; S 0 2 'P6'\nS 30 20\nSI 0 0\nGO\n",
              [s('1/50', 4, 1.5), s('-1/40', 3), s(0, 2, 1.6), s('1/30', 20), s(0, 0)]),
    'curvatures, conics, comments, & and case': (
        CURVATURES + "! s 1 1 1\n  s .02 &\n 4.0 & ! goes on\n 'p5' ! refl\n  con;k -1.5\nS -1.0E-2 5D0\n  sto\n"
        "  Con ; K 0.5\nsi -.001 0\ngo\n",
        [s('0.02', 4, 1.5, k='-1.5'), s('-0.01', 5, k='0.5'), s('-0.001', 0)]),
    'an asphere up to r^16': (
        RADII + "S 40 5 'P6'\nASP\nK -.5\nIC Y\nCUF 0.0\nA 1e-5; B -2e-7; C 3e-9; D 1e-11\nE 2e-13; F -1e-15; G 1e-17\nAC 100; BC 0\n"
        "S 0 30; STO\nSI 0 0\nGO\n",
        [s('1/40', 5, 1.6, k='-0.5', powers={4: '1e-5', 6: '-2e-7', 8: '3e-9', 10: '1e-11', 12: '2e-13', 14: '-1e-15',
                                             16: '1e-17'}), s(0, 30), s(0, 0)]),
    'an asphere up to r^20, without ASP': (
        CURVATURES + "S 0.025 5 'P6'\nK -.5\nA 1e-5\nH 3e-18; J -2e-20\nS 0 30; STO\nSI 0 0\nGO\n",
        [s('0.025', 5, 1.6, k='-0.5', powers={4: '1e-5', 18: '3e-18', 20: '-2e-20'}), s(0, 30), s(0, 0)]),
    'plain moves about three axes': (
        RADII + "S 50 4 'P5'\nCDE 30; ADE 3; XDE .1; BDE -2; YDE -.2; ZDE .3\nS -60 30; STO\nBDE 4; XDE -.3\nSI 0 0\nGO\n",
        [s('1/50', 4, 1.5, moves=('.1', '-.2', '.3', 3, -2, 30)), s('-1/60', 30, moves=('-.3', 0, 0, 0, 4, 0)), s(0, 0)]),
    'moves that return, DAR': (
        RADII + "S 50 4 'P5'\nDAR\nADE 3; BDE -2; CDE 30; XDE .1; YDE -.2; ZDE .3\nS -60 30; STO\nYDE .4; BDE 4; DAR\nSI 0 0\nGO\n",
        [s('1/50', 4, 1.5, moves=('.1', '-.2', '.3', 3, -2, 30), kind='DAR'),
         s('-1/60', 30, moves=(0, '.4', 0, 0, 4, 0), kind='DAR'), s(0, 0)]),
    'mirrors that bend the axis, BEN': (
        RADII + "S 0 30; STO\nS 0 -20 REFL\nADE 40; BDE 5; CDE 3; YDE 1; BEN\nS 100 15 REFL\nBDE -30; BEN\nSI 0 0\nGO\n",
        [s(0, 30), s(0, -20, MIRROR, moves=(0, 1, 0, 40, 5, 3), kind='BEN'),
         s('1/100', 15, MIRROR, moves=(0, 0, 0, 0, -30, 0), kind='BEN'), s(0, 0)]),
    'moves that are undone, REV': (
        RADII + "S 50 4 'P5'\nADE 3; BDE -2; CDE 30; XDE .1; YDE -.2\nS 0 2 'P5'\nSTO\nS 0 0 'P5'\nS 0 0\n"
        "S 0 7\nADE 3; BDE -2; CDE 30; XDE .1; YDE -.2; REV\nS -60 20\nSI 0 0\nGO\n",
        [s('1/50', 4, 1.5, moves=('.1', '-.2', 0, 3, -2, 30)), s(0, 2, 1.5), s(0, 0, 1.5), s(0, 0),
         s(0, 7, moves=('.1', '-.2', 0, 3, -2, 30), kind='REV'), s('-1/60', 20), s(0, 0)]),
    'a mirror behind glass, a moved image with a defocus': (
        RADII + "S -60 5 'P5'\nSTO\nS -80 -5 REFL\nS -60 -40\nSI -200 1.5\nADE 4; YDE .2\nGO\n",
        [s('-1/60', 5, 1.5), s('-1/80', -5, MIRROR), s('-1/60', '-38.5'), s('-1/200', 0, moves=(0, '.2', 0, 4, 0, 0))]),
    'a series of a private glass': (
        RADII.replace('END', "'P8' LAU 2.2 -0.01 0.012 2e-4 -1e-5 1e-6\nEND") + "S 50 4 'P8'\nSTO\nS -60 30\nSI 0 0\nGO\n",
        [s('1/50', 4, 'series'), s('-1/60', 30), s(0, 0)]),
    'a diffractive surface': (
        RADII + "S 50 4 'P5'\nSTO\nDIF DOE\nHOR 1; HWL 587.5618; HCT R\nHCO C1 -1.5e-3; HCO C2 2e-6; HCC C1 100\nS -60 30\nSI 0 0\nGO\n",
        [s('1/50', 4, 1.5, waves={2: '-1.5e-3', 4: '2e-6'}), s('-1/60', 30), s(0, 0)]),
    'commands with qualifiers, and numbers of surfaces': (
        RADII + "S1 0 9 'P7'\nS 0 9\nS3 0 9\nSI 0 0\nTHI S1 4; RDY S1 50; CUY S2 -.02; THI S2..3 10; GLA S1 'P5'\nGLA S3 'P6' ; GLA S3 AIR\n"
        "K S1 -1; YDE S3 .1; ADE S3 2; DAR S3; STO S2; RDY S3 -70; K SS .3\nEPD 5\nS3 -70 12\nGO\n",
        [s('1/50', 4, 1.5, k=-1), s('-0.02', 10, k='0.3'), s('-1/70', 12, moves=(0, '.1', 0, 2, 0, 0), kind='DAR'),
         s(0, 0)]),
    'the second position of a zoom': (
        RADII + "S 50 4 'P5'\nSTO\nS -60 10\nS 40 3 'P6'\nYDE .1\nS 0 30\nSI 0 0\nZOO 3\nZOO THI S2 10 12 14\nZOO RDY S3 40 45 50\n"
        "ZOO YDE S3 .1 .2 .3\nTHI S4 Z2 25\nTHI S4 Z3 26\nZOO GLA S1 'P5' 'P6' 'P7'\nGO\n",
        [s('1/50', 4, 1.6), s('-1/60', 12), s('1/45', 3, 1.6, moves=(0, '.2', 0, 0, 0, 0)), s(0, 25), s(0, 0)]),
}
