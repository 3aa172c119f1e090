"""The types of the catalogue.  Written by python/generate.py from the library's own table.

docs/surfaces.md and surfaces.h say more of each.  Lengths have any one unit.  A parameter that is not given
has its default, 0 or none.  `semi_diameter` is the radius of the rim; 0: none.
"""
from __future__ import annotations

from typing import Literal, Optional, Sequence

from numpy.typing import ArrayLike

from ._tables import Floats
from .surface import CLASSES, Catalogue


class Plane(Catalogue):
    """s = 0; everywhere.

    semi_diameter  length
    """
    type = "plane"
    semi_diameter: float

    def __init__(self, *, semi_diameter: Optional[float] = None) -> None:
        self._make(dict(semi_diameter=semi_diameter))


class Sphere(Catalogue):
    """s = c r^2 / (1 + sqrt(1 - c^2 r^2)); r <= |R|, the half at the vertex.

    radius         length; 1 / curvature, math.inf is flat.  Or give the curvature
    curvature      length^-1
    semi_diameter  length
    """
    type = "sphere"
    radius: float
    curvature: float
    semi_diameter: float

    def __init__(self, radius: Optional[float] = None, *, curvature: Optional[float] = None,
                 semi_diameter: Optional[float] = None) -> None:
        self._make(dict(radius=radius, curvature=curvature, semi_diameter=semi_diameter))


class Conic(Catalogue):
    """s = c r^2 / (1 + sqrt(1 - (1+k) c^2 r^2)); (1+k) c^2 r^2 <= 1: all r for k <= -1.

    radius         length; 1 / curvature, math.inf is flat.  Or give the curvature
    curvature      length^-1
    conic          a number
    semi_diameter  length
    """
    type = "conic"
    radius: float
    curvature: float
    conic: float
    semi_diameter: float

    def __init__(self, radius: Optional[float] = None, conic: Optional[float] = None, *,
                 curvature: Optional[float] = None, semi_diameter: Optional[float] = None) -> None:
        self._make(dict(radius=radius, curvature=curvature, conic=conic, semi_diameter=semi_diameter))


class EvenAsphere(Catalogue):
    """P = sum of a[i] r^(2i+2), i = 0 ... 7; everywhere.

    radius         length; 1 / curvature, math.inf is flat.  Or give the curvature
    curvature      length^-1
    conic          a number
    semi_diameter  length
    coefficients   up to 8 numbers; length^(-1 - 2 i)
    """
    type = "even_asphere"
    radius: float
    curvature: float
    conic: float
    semi_diameter: float
    coefficients: Floats

    def __init__(self, radius: Optional[float] = None, conic: Optional[float] = None,
                 coefficients: Optional[ArrayLike] = None, *, curvature: Optional[float] = None,
                 semi_diameter: Optional[float] = None) -> None:
        self._make(dict(radius=radius, curvature=curvature, conic=conic, semi_diameter=semi_diameter,
                        coefficients=coefficients))


class Julia(Catalogue):
    """Q_0 = X, Q_{j+1} = Q_j^p + c; everywhere.

    c           4 numbers
    at          4 numbers
    slice       -1e+06 to 1e+06
    ex          4 numbers; length^-1
    ey          4 numbers; length^-1
    ez          4 numbers; length^-1
    escape      1 to 1e+06
    iterations  a whole number from 1 to 10000
    power       a whole number from 2 to 8
    """
    type = "julia"
    c: Floats
    at: Floats
    slice: float
    ex: Floats
    ey: Floats
    ez: Floats
    escape: float
    iterations: int
    power: int

    def __init__(self, *, c: Optional[ArrayLike] = None, at: Optional[ArrayLike] = None,
                 slice: Optional[float] = None, ex: Optional[ArrayLike] = None,
                 ey: Optional[ArrayLike] = None, ez: Optional[ArrayLike] = None,
                 escape: Optional[float] = None, iterations: Optional[int] = None,
                 power: Optional[int] = None) -> None:
        self._make(dict(c=c, at=at, slice=slice, ex=ex, ey=ey, ez=ez, escape=escape, iterations=iterations,
                        power=power))


class Mandelbrot(Catalogue):
    """Q_0 = 0, Q_{j+1} = Q_j^p + X; everywhere.

    at          4 numbers
    slice       -1e+06 to 1e+06
    ex          4 numbers; length^-1
    ey          4 numbers; length^-1
    ez          4 numbers; length^-1
    escape      1 to 1e+06
    iterations  a whole number from 1 to 10000
    power       a whole number from 2 to 8
    """
    type = "mandelbrot"
    at: Floats
    slice: float
    ex: Floats
    ey: Floats
    ez: Floats
    escape: float
    iterations: int
    power: int

    def __init__(self, *, at: Optional[ArrayLike] = None, slice: Optional[float] = None,
                 ex: Optional[ArrayLike] = None, ey: Optional[ArrayLike] = None,
                 ez: Optional[ArrayLike] = None, escape: Optional[float] = None,
                 iterations: Optional[int] = None, power: Optional[int] = None) -> None:
        self._make(dict(at=at, slice=slice, ex=ex, ey=ey, ez=ez, escape=escape, iterations=iterations,
                        power=power))


class OddAsphere(Catalogue):
    """P = sum of a[i] r^(i+1), i = 0 ... 15; everywhere; with a[0] there is the tip of a cone.

    radius         length; 1 / curvature, math.inf is flat.  Or give the curvature
    curvature      length^-1
    conic          a number
    semi_diameter  length
    coefficients   up to 16 numbers; length^(-i)
    """
    type = "odd_asphere"
    radius: float
    curvature: float
    conic: float
    semi_diameter: float
    coefficients: Floats

    def __init__(self, radius: Optional[float] = None, conic: Optional[float] = None,
                 coefficients: Optional[ArrayLike] = None, *, curvature: Optional[float] = None,
                 semi_diameter: Optional[float] = None) -> None:
        self._make(dict(radius=radius, curvature=curvature, conic=conic, semi_diameter=semi_diameter,
                        coefficients=coefficients))


class PolynomialXy(Catalogue):
    """P = sum of a[i][j] x^i y^j; everywhere.

    radius         length; 1 / curvature, math.inf is flat.  Or give the curvature
    curvature      length^-1
    conic          a number
    semi_diameter  length
    coefficients   a table of up to 32 rows and columns; length^(1 - i - j)
    """
    type = "polynomial_xy"
    radius: float
    curvature: float
    conic: float
    semi_diameter: float
    coefficients: Floats

    def __init__(self, *, radius: Optional[float] = None, curvature: Optional[float] = None,
                 conic: Optional[float] = None, semi_diameter: Optional[float] = None,
                 coefficients: Optional[ArrayLike] = None) -> None:
        self._make(dict(radius=radius, curvature=curvature, conic=conic, semi_diameter=semi_diameter,
                        coefficients=coefficients))


class Toroidal(Catalogue):
    """s: the profile z_p(y) of an even asphere, swept about z = 1 / c_x, parallel to y; as the profile, and
    to where the sweep turns over: |c_x x| <= 1 - c_x z_p.

    radius         length; 1 / curvature, math.inf is flat.  Or give the curvature
    curvature      length^-1
    conic          a number
    radius_x       length; 1 / curvature_x, math.inf is flat.  Or give the curvature_x
    curvature_x    length^-1
    semi_diameter  length
    coefficients   up to 8 numbers; length^(-1 - 2 i)
    """
    type = "toroidal"
    radius: float
    curvature: float
    conic: float
    radius_x: float
    curvature_x: float
    semi_diameter: float
    coefficients: Floats

    def __init__(self, *, radius: Optional[float] = None, curvature: Optional[float] = None,
                 conic: Optional[float] = None, radius_x: Optional[float] = None,
                 curvature_x: Optional[float] = None, semi_diameter: Optional[float] = None,
                 coefficients: Optional[ArrayLike] = None) -> None:
        self._make(dict(radius=radius, curvature=curvature, conic=conic, radius_x=radius_x,
                        curvature_x=curvature_x, semi_diameter=semi_diameter, coefficients=coefficients))


class Biconic(Catalogue):
    """s = (c_x x^2 + c_y y^2) / (1 + sqrt(1 - (1+k_x) c_x^2 x^2 - (1+k_y) c_y^2 y^2)); where the root is.

    radius_x       length; 1 / curvature_x, math.inf is flat.  Or give the curvature_x
    curvature_x    length^-1
    conic_x        a number
    radius_y       length; 1 / curvature_y, math.inf is flat.  Or give the curvature_y
    curvature_y    length^-1
    conic_y        a number
    semi_diameter  length
    """
    type = "biconic"
    radius_x: float
    curvature_x: float
    conic_x: float
    radius_y: float
    curvature_y: float
    conic_y: float
    semi_diameter: float

    def __init__(self, *, radius_x: Optional[float] = None, curvature_x: Optional[float] = None,
                 conic_x: Optional[float] = None, radius_y: Optional[float] = None,
                 curvature_y: Optional[float] = None, conic_y: Optional[float] = None,
                 semi_diameter: Optional[float] = None) -> None:
        self._make(dict(radius_x=radius_x, curvature_x=curvature_x, conic_x=conic_x, radius_y=radius_y,
                        curvature_y=curvature_y, conic_y=conic_y, semi_diameter=semi_diameter))


class Cylinder(Catalogue):
    """s: the biconic with c_x = 0; as the conic, in y.

    radius         length; 1 / curvature, math.inf is flat.  Or give the curvature
    curvature      length^-1
    conic          a number
    semi_diameter  length
    """
    type = "cylinder"
    radius: float
    curvature: float
    conic: float
    semi_diameter: float

    def __init__(self, radius: Optional[float] = None, conic: Optional[float] = None, *,
                 curvature: Optional[float] = None, semi_diameter: Optional[float] = None) -> None:
        self._make(dict(radius=radius, curvature=curvature, conic=conic, semi_diameter=semi_diameter))


class Zernike(Catalogue):
    """P = sum of a[j-1] Z_j(r / norm, theta); everywhere.

    radius         length; 1 / curvature, math.inf is flat.  Or give the curvature
    curvature      length^-1
    conic          a number
    semi_diameter  length
    norm           length
    order          one of "noll", "fringe"
    normalised     True or False
    coefficients   up to 5151 numbers; length
    """
    type = "zernike"
    radius: float
    curvature: float
    conic: float
    semi_diameter: float
    norm: float
    order: Optional[Literal["noll", "fringe"]]
    normalised: bool
    coefficients: Floats

    def __init__(self, *, radius: Optional[float] = None, curvature: Optional[float] = None,
                 conic: Optional[float] = None, semi_diameter: Optional[float] = None,
                 norm: Optional[float] = None, order: Optional[Literal["noll", "fringe"]] = None,
                 normalised: bool = False, coefficients: Optional[ArrayLike] = None) -> None:
        self._make(dict(radius=radius, curvature=curvature, conic=conic, semi_diameter=semi_diameter,
                        norm=norm, order=order, normalised=normalised, coefficients=coefficients))


class Chebyshev(Catalogue):
    """P = sum of a[i][j] T_i(x / norm_x) T_j(y / norm_y); everywhere.

    radius         length; 1 / curvature, math.inf is flat.  Or give the curvature
    curvature      length^-1
    conic          a number
    semi_diameter  length
    norm_x         length
    norm_y         length
    coefficients   a table of up to 64 rows and columns; length
    """
    type = "chebyshev"
    radius: float
    curvature: float
    conic: float
    semi_diameter: float
    norm_x: float
    norm_y: float
    coefficients: Floats

    def __init__(self, *, radius: Optional[float] = None, curvature: Optional[float] = None,
                 conic: Optional[float] = None, semi_diameter: Optional[float] = None,
                 norm_x: Optional[float] = None, norm_y: Optional[float] = None,
                 coefficients: Optional[ArrayLike] = None) -> None:
        self._make(dict(radius=radius, curvature=curvature, conic=conic, semi_diameter=semi_diameter,
                        norm_x=norm_x, norm_y=norm_y, coefficients=coefficients))


class QCon(Catalogue):
    """P = u^4 sum of a[m] Qcon_m(u^2), u = r / norm; everywhere.

    radius         length; 1 / curvature, math.inf is flat.  Or give the curvature
    curvature      length^-1
    conic          a number
    semi_diameter  length
    norm           length
    coefficients   up to 64 numbers; length
    """
    type = "q_con"
    radius: float
    curvature: float
    conic: float
    semi_diameter: float
    norm: float
    coefficients: Floats

    def __init__(self, *, radius: Optional[float] = None, curvature: Optional[float] = None,
                 conic: Optional[float] = None, semi_diameter: Optional[float] = None,
                 norm: Optional[float] = None, coefficients: Optional[ArrayLike] = None) -> None:
        self._make(dict(radius=radius, curvature=curvature, conic=conic, semi_diameter=semi_diameter,
                        norm=norm, coefficients=coefficients))


class QBfs(Catalogue):
    """P = u^2 (1 - u^2) / sqrt(1 - c^2 r^2) sum of a[m] Qbfs_m(u^2), u = r / norm, on a sphere; |c| r < 1.

    radius         length; 1 / curvature, math.inf is flat.  Or give the curvature
    curvature      length^-1
    semi_diameter  length
    norm           length
    coefficients   up to 64 numbers; length
    """
    type = "q_bfs"
    radius: float
    curvature: float
    semi_diameter: float
    norm: float
    coefficients: Floats

    def __init__(self, *, radius: Optional[float] = None, curvature: Optional[float] = None,
                 semi_diameter: Optional[float] = None, norm: Optional[float] = None,
                 coefficients: Optional[ArrayLike] = None) -> None:
        self._make(dict(radius=radius, curvature=curvature, semi_diameter=semi_diameter, norm=norm,
                        coefficients=coefficients))


class Grid(Catalogue):
    """P: bicubic convolution of heights, 4 x 4 of them or more; on the grid.

    radius         length; 1 / curvature, math.inf is flat.  Or give the curvature
    curvature      length^-1
    conic          a number
    semi_diameter  length
    step_x         length
    step_y         length
    sag            a table of up to 4096 rows and columns; length
    """
    type = "grid"
    radius: float
    curvature: float
    conic: float
    semi_diameter: float
    step_x: float
    step_y: float

    def __init__(self, *, radius: Optional[float] = None, curvature: Optional[float] = None,
                 conic: Optional[float] = None, semi_diameter: Optional[float] = None,
                 step_x: Optional[float] = None, step_y: Optional[float] = None,
                 sag: Optional[ArrayLike] = None) -> None:
        self._make(dict(radius=radius, curvature=curvature, conic=conic, semi_diameter=semi_diameter,
                        step_x=step_x, step_y=step_y, sag=sag))


class Sum(Catalogue):
    """P: those of its terms: any of these, an even asphere, a toroid or a biconic; where all are.

    radius         length; 1 / curvature, math.inf is flat.  Or give the curvature
    curvature      length^-1
    conic          a number
    semi_diameter  length
    terms          up to 16 surfaces, whose departures are added
    """
    type = "sum"
    radius: float
    curvature: float
    conic: float
    semi_diameter: float
    terms: tuple[Catalogue, ...]

    def __init__(self, *, radius: Optional[float] = None, curvature: Optional[float] = None,
                 conic: Optional[float] = None, semi_diameter: Optional[float] = None,
                 terms: Sequence[Catalogue] = ()) -> None:
        self._make(dict(radius=radius, curvature=curvature, conic=conic, semi_diameter=semi_diameter,
                        terms=terms))


class Quadric(Catalogue):
    """F = squares . (x^2, y^2, z^2) + products . (x y, y z, x z) + linear . (x, y, z) + constant;
    everywhere.

    squares   3 numbers
    products  3 numbers
    linear    3 numbers; length
    constant  length^2
    """
    type = "quadric"
    squares: Floats
    products: Floats
    linear: Floats
    constant: float

    def __init__(self, *, squares: Optional[ArrayLike] = None, products: Optional[ArrayLike] = None,
                 linear: Optional[ArrayLike] = None, constant: Optional[float] = None) -> None:
        self._make(dict(squares=squares, products=products, linear=linear, constant=constant))


class Torus(Catalogue):
    """F = (x^2 + y^2 + z^2 + R^2 - r^2)^2 - 4 R^2 (x^2 + y^2), in a form that is a distance near it;
    everywhere.

    major  length
    minor  length
    """
    type = "torus"
    major: float
    minor: float

    def __init__(self, major: Optional[float] = None, minor: Optional[float] = None) -> None:
        self._make(dict(major=major, minor=minor))


class Ellipsoid(Catalogue):
    """F = ((x^2 + y^2) / a^2 + z^2 / b^2 - 1) a / 2, b = a (1 - f); everywhere.

    a  length
    f  a number
    """
    type = "ellipsoid"
    a: float
    f: float

    def __init__(self, a: Optional[float] = None, f: Optional[float] = None) -> None:
        self._make(dict(a=a, f=f))


_ALL: tuple[type[Catalogue], ...] = (
    Plane, Sphere, Conic, EvenAsphere, Julia, Mandelbrot, OddAsphere, PolynomialXy, Toroidal, Biconic,
    Cylinder, Zernike, Chebyshev, QCon, QBfs, Grid, Sum, Quadric, Torus, Ellipsoid)
CLASSES.update((c.type, c) for c in _ALL)

__all__ = [
    "Plane", "Sphere", "Conic", "EvenAsphere", "Julia", "Mandelbrot", "OddAsphere", "PolynomialXy",
    "Toroidal", "Biconic", "Cylinder", "Zernike", "Chebyshev", "QCon", "QBfs", "Grid", "Sum", "Quadric",
    "Torus", "Ellipsoid",
]
