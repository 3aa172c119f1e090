# SPDX-License-Identifier: MIT
"""What a program sees of the types: mypy --strict says at each line what stands behind its reveal_type.
(test_types.py runs it.  `array[float64]` stands for an array of numpy of them.)"""
import numpy as np
from numpy.typing import NDArray

import sagitta
import sagitta.dask

ball, cone = sagitta.Sphere(50), sagitta.Conic(50, -1)
o: NDArray[np.float64] = np.zeros((3, 4, 5))
x: NDArray[np.float64] = np.zeros((4, 5))
along = (0.0, 0.0, 1.0)

# One ray is a Hit, many are Hits, and what is given as out= comes back.
one = ball.intersect((0, 0, -5), (0, 0, 1), tmax=9, proof="root", threads=2)
many = ball.intersect(o, along, tmin=x, pick="near-seed")
room = sagitta.Crossings.empty((4, 5), "t")
reveal_type(one)  # Hit
reveal_type(many)  # Hits
reveal_type(ball.intersect([0, 0, -5], along))  # Hit
reveal_type(ball.intersect((0, 0, -5), o))  # Hits
reveal_type(ball.intersect([[0, 1], [0.5, 1.5], [1, 1]], along))  # Hits
reveal_type(ball.intersect((x, x, x), along))  # Hits
reveal_type(ball.intersect((x, x, -5.0), along))  # Union[Hit, Hits]
reveal_type(ball.intersect(o, along, out=room))  # Crossings
reveal_type(ball.prepare(o, o))  # Prepared[Hits]
reveal_type(ball.prepare(o, o).out)  # Hits
reveal_type(ball.prepare(o, o)())  # int
reveal_type(ball.leave(many, along))  # Crossings
reveal_type(ball.intersect_all(o, along))  # AllHits

# Numbers of a hit, of hits; by name, by ray, some of the rays.
reveal_type(one.t)  # float
reveal_type(one.met)  # bool
reveal_type(one.p)  # array[float64]
reveal_type(many.t)  # array[float64]
reveal_type(many.status)  # array[int8]
reveal_type(many["t"])  # array[float64]
reveal_type(many["status"])  # array[int8]
reveal_type(many["evals"])  # array[int32]
reveal_type(many[3])  # Hit
reveal_type(many[3, 4])  # Hit
reveal_type(many[3:])  # Hits
reveal_type(many[0, ...])  # Hits
reveal_type(many[many.met])  # Hits
reveal_type([hit.t for hit in many])  # list[float]
reveal_type(many.keys())  # tuple[str, ...]
reveal_type([crossing.side for crossing in room])  # list[int]
reveal_type(many == many)  # bool
reveal_type(many.shape)  # tuple[int, ...]

# Surfaces.
reveal_type(cone.conic)  # float
reveal_type(cone.radius)  # float
reveal_type(cone.replace(radius=20))  # Conic
reveal_type(sagitta.EvenAsphere(50, -1, [0, 1e-6]).coefficients)  # array[float64]
reveal_type(sagitta.Sum(radius=50, terms=[cone]).terms)  # tuple[Catalogue, ...]
reveal_type(sagitta.Zernike(norm=1, order="noll", coefficients=[1]).normalised)  # bool
reveal_type(sagitta.Formula("x - a", a=1).a)  # float
reveal_type(cone.sag(0, 1))  # float
reveal_type(cone.sag(x, 1))  # array[float64]
reveal_type(cone.value(0, 1, 2))  # float
reveal_type(cone.value(0, x, 2))  # array[float64]
reveal_type(cone.normal(0, 1))  # array[float64]
reveal_type(hash(cone))  # int

# Lenses.
lens = sagitta.Lens([sagitta.Element(ball, index=1.5, thickness=5), sagitta.Element(sagitta.Plane())])
traced = lens.trace(o, along, passages=("p", "opl"))
reveal_type(traced)  # Traced
reveal_type(traced.opl)  # array[float64]
reveal_type(traced["fate"])  # array[int8]
reveal_type(traced[0, 0].through)  # bool
reveal_type(traced.passages[0].direction)  # array[float64]
reveal_type([p.opl for p in traced.passages[1]])  # list[float]
reveal_type(lens.prepare(o, along))  # Prepared[Traced]
reveal_type(lens.launch(1))  # Rays
reveal_type(lens.launch(1).px)  # array[float64]
reveal_type(lens.first_order().efl)  # float
reveal_type(lens.sensitivity(o, along).by(0, "radius"))  # array[float64]
reveal_type(lens.aim(1, (0, 0), sagitta.Beam((0, 0, -9), along)))  # Aims

# Analyses.
spot = lens.spot(1, pattern="grid", rays=9, reference="centroid", defocus=[0, 0.1])
reveal_type(spot.rms)  # array[float64]
reveal_type(spot.of(wavelength=0).rms)  # array[float64]
reveal_type(spot[1:].field)  # array[uint]
reveal_type(spot["rms"])  # array[float64]
reveal_type(spot["rays"])  # array[uint]
reveal_type(spot.fates.passed)  # int
reveal_type(spot.units["rms"])  # str
reveal_type(lens.zernike(terms=9).coefficient)  # array[float64]
reveal_type(lens.ends().fate)  # array[intc]

# Parts and sums.
part = lens.part("spot", 1, 2, rays=9)
reveal_type(part)  # Part
reveal_type(sagitta.join([part]))  # Answer
sums = sagitta.SpotSums((0, 1)).add(x, x, weight=1)
reveal_type(sums)  # SpotSums
reveal_type(sums + sums)  # SpotSums
reveal_type(sums.merge(sums).spot().rms)  # float
reveal_type(sagitta.WavefrontSums().add(x).wavefront().mean)  # float
reveal_type(sagitta.SpotSums.of_bytes(bytes(sums)))  # SpotSums

reveal_type(sagitta.dask.intersect(ball, o, along))  # Lazy
reveal_type(sagitta.dask.trace(lens, o, along, passages="p").passages[0])  # Lazy

# What is wrong, and that mypy says so.
ball.intersect(o, along, pick="last")  # error
ball.intersect(o, along, colour="red")  # error
ball.leave(many, along, pick="first")  # error
cone.colour  # error
sagitta.Sphere(50, -1)  # error
sagitta.Zernike(norm=1, order="nol", coefficients=[1])  # error
lens.spot(1, reference="cheif")  # error
lens.spot(1, colour="red")  # error
lens.spott()  # error
sums.merge(sagitta.WavefrontSums())  # error
spot.colour  # error
