# SPDX-License-Identifier: MIT
"""Lenses: as the command has them, bit for bit; and what a designer asks."""
import dataclasses
import json
import math
import pickle
import subprocess

import numpy as np
import pytest
from bits import rays, same

import sagitta
from sagitta import Beam, Element, Fate, Lens, LensError, Plane, Sphere, Traced

FILES = [
    "double_gauss.yaml",
    "cooke_triplet.yaml",
    "cassegrain.yaml",
    "aspheric_singlet.yaml",
    "toroidal_lens.yaml",
    "newtonian.yaml",
    "figured_mirror.yaml",
    "ftheta.yaml",
]


def singlet(**more):
    return Lens(
        [
            Element(Plane(), thickness=10, stop=True, semi_diameter=6),
            Element(Sphere(radius=51.68), thickness=4, index=1.5168, semi_diameter=8),
            Element(sagitta.Conic(radius=-700, conic=-0.5), thickness=93.5, index=1, semi_diameter=8),
            Element(Plane(), semi_diameter=12),
        ],
        **{"pupil": {"semi_diameter": 6}, "fields": [0, 5], "units": "mm", **more},
    )


def same_data(a, b):
    return same(dataclasses.astuple(a.first_order()), dataclasses.astuple(b.first_order()))


def test_first_order_has_the_members_of_the_struct():
    from sagitta import _library as C

    names = [f.name for f in dataclasses.fields(sagitta.FirstOrder)]
    known = [name for name, _ in C.FirstOrder._fields_]
    assert [*names, "without_seidel", "reserved_"] == known  # the first of these is Seidel.why_not


@pytest.mark.parametrize("name", FILES)
def test_traces_are_the_command_s(name, command, tree, tmp_path, rng):
    path = tree / "examples" / "lenses" / name
    lens = Lens.read(path)
    launched = lens.launch(1, "grid", 15)
    np.save(tmp_path / "rays.npy", np.ascontiguousarray(np.vstack([launched.o, launched.d]).T))
    said = subprocess.run(
        [
            command,
            "trace",
            str(path),
            "--rays",
            str(tmp_path / "rays.npy"),
            "--format",
            "npy",
            "--output",
            str(tmp_path / "out.npy"),
        ],
        capture_output=True,
        text=True,
    )
    assert said.returncode == 0, said.stderr
    theirs = np.load(tmp_path / "out.npy")
    mine = lens.trace(launched.o, launched.d, passages=True)
    for i, passage in enumerate(mine.passages):
        rows = theirs[theirs["element"] == i + 1]
        at = rows["ray"]
        assert len(at) == (mine.passed >= i).sum()
        p, d = passage.p[:, at], passage.direction[:, at]
        passed = mine.passed[at] > i
        assert same(passage.t[at], rows["t"]) and same(passage.t_err[at], rows["t_err"])
        for k, (xyz, lmn) in enumerate((("x", "l"), ("y", "m"), ("z", "n"))):
            assert same(p[k], rows[xyz]) and same(d[k][passed], rows[lmn][passed])
        assert same(passage.opl[at][passed], rows["opl"][passed])
    last = theirs[np.r_[np.diff(theirs["ray"]) > 0, True]]
    assert (last["fate"] == mine.fate).all() and mine.through.sum() > 20


def test_afocal_but_for_rounding(tmp_path):
    """A telescope of foci 0.7 and 0.1, whose sum is no double."""
    ideal = "{type: ideal, focal_length: %r, thickness: %r, index: 1}"
    rows = ["pupil: {semi_diameter: 1}\nsurfaces:", ideal % (0.7, 0.7 + 0.1), ideal % (0.1, 1.0), "type: plane"]
    (tmp_path / "telescope.yaml").write_text("\n- ".join(rows))
    data = Lens.read(tmp_path / "telescope.yaml").first_order()
    assert data.power == 0 and math.isnan(data.efl) and math.isnan(data.focus) and math.isnan(data.f_number_working)


@pytest.mark.parametrize("name", FILES)
def test_first_order_data_are_the_command_s(name, command, tree):
    path = tree / "examples" / "lenses" / name
    said = json.loads(
        subprocess.run(
            [command, "info", str(path), "--format", "json"], capture_output=True, text=True, check=True
        ).stdout
    )
    mine = Lens.read(path).first_order()
    for theirs, value in (
        (said["efl"], mine.efl),
        (said["bfd"], mine.bfd),
        (said["f_number"], mine.f_number),
        (said["petzval_radius"], mine.petzval_radius),
        (said["stop_radius"], mine.stop_radius),
    ):
        assert theirs == value or (theirs is None and math.isnan(value))


def asked(command, *arguments):
    """The rows that the command prints."""
    done = subprocess.run(
        [command, *map(str, arguments), "--format", "json"], capture_output=True, text=True, check=True
    )
    return json.loads(done.stdout)


def test_spots_are_the_command_s(command, tree):
    """(tests/lens/test_doors.py has every analysis of every lens.)"""
    path = tree / "examples" / "lenses" / "double_gauss.yaml"
    said, spot = asked(command, "spot", path, "--hexapolar", 6), Lens.read(path).spot(rays=6)
    assert len(said) == len(spot) == 2 * len(Lens.read(path).fields) == 6
    for row, mine in zip(said, spot):
        for key, value in row.items():
            assert mine[key] == (0 if value == "all" else value), key


def test_spots_of_an_afocal_lens_are_angles(tree):
    """Those of the directions that trace() gives."""
    lens = Lens.read(tree / "tests" / "data" / "lenses" / "afocal_expander.yaml")
    assert lens.afocal and not singlet().afocal and singlet(afocal=True).afocal
    first = lens.first_order(0.55)
    assert math.isnan(first.efl) and first.angular_magnification == -0.5
    for i in range(1, len(lens.fields) + 1):
        spot = lens.spot(i, rays=6)
        assert spot.units["rms_mrad"] == "mrad" and not hasattr(spot, "rms")
        traced = lens.trace(lens.launch(i, "hexapolar", 6)), lens.trace(lens.launch(i, "fan", 1))
        d, chief = (t.d / np.linalg.norm(t.d, axis=0) for t in traced)
        apart = 1000 * np.arcsin(np.linalg.norm(np.cross(d, chief, axis=0), axis=0))
        w = lens.launch(i, "hexapolar", 6).weight
        # An angle toward x and one toward y: beside their hypotenuse, `apart` differs by third orders.
        rms = math.sqrt((w * apart**2).sum() / w.sum())
        assert abs(rms - spot.rms_mrad[0]) < 1e-10 + 1e-6 * apart.max() ** 3
        about = lens.spot(i, rays=6, reference="centroid")
        assert 0 < about.rms_mrad[0] <= spot.rms_mrad[0] * (1 + 1e-14)


def test_made_in_python_is_as_read(tree):
    """The same lens from text and from elements."""
    text = """
units: mm
pupil: {semi_diameter: 6}
fields: [0, 5]
surfaces:
  - {type: plane, thickness: 10, stop: true, semi_diameter: 6}
  - {type: sphere, radius: 51.68, thickness: 4, index: 1.5168, semi_diameter: 8}
  - {type: conic, radius: -700, conic: -0.5, thickness: 93.5, index: 1, semi_diameter: 8}
  - {type: plane, semi_diameter: 12}
"""
    a, b = singlet(), Lens.text(text)
    assert same_data(a, b) and a.fields == b.fields == [(0, 0), (0, 5)]
    there, here = a.launch(2), b.launch(2)
    assert same(there.o, here.o) and same(there.d, here.d) and same(there.weight, here.weight)
    x, y = a.trace(there.o, there.d, passages=True), b.trace(there.o, there.d, passages=True)
    assert same(x.o, y.o) and same(x.opl, y.opl) and x.through.all()
    assert repr(a) == "<Lens of 4 elements>" and len(a) == 4 and a.units == "mm"


def test_all_that_an_element_may_have():
    """Tilts, apertures, glass, an ideal lens, a mirror: each does what the lens file says."""
    lens = Lens(
        [
            Element(Plane(), thickness=5, apertures=[{"type": "circle", "radius": 1, "obscures": True}]),
            Element(focal_length=50, thickness=50),
            Element(Plane(), mirror=True, tilt=(45, 0, 0), name="fold"),
            Element(Plane(), origin=None),
        ]
    )
    traced = lens.trace([[0, 2], [0, 0], [-5, -5]], (0, 0, 1), passages=True)
    assert traced.fate[0] == Fate.CLIPPED and traced.passed[1] >= 3
    assert abs(traced.passages[2].p[0, 1]) < 1e-13  # the focus
    glass = Lens(
        [Element(Sphere(radius=50), glass="SCHOTT N-BK7", thickness=5), Element(Plane())],
        wavelengths=[0.5876, 0.4861],
        makers=["SCHOTT"],
    )
    d, f = (glass.sensitivity((0, 5, -5), (0, 0, 1), "y", wavelength=w).value[0, 0] for w in (0.5876, 0.4861))
    assert f < d and glass.wavelengths == (0.5876, 0.4861)
    tilted = Lens([Element(Plane(), origin=(0, 1, 2), tilt=(0, 0, 90)), Element(Plane(), origin=(0, 0, 3))])
    at, axes = tilted.vertex(0)
    assert at.tolist() == [0, 1, 2] and axes.tolist() == [[0, -1, 0], [1, 0, 0], [0, 0, 1]]


@pytest.mark.parametrize("name", FILES)
def test_again_from_a_pickle(name, tree):
    lens = Lens.read(tree / "examples" / "lenses" / name)
    other = pickle.loads(pickle.dumps(lens))
    launched = lens.launch(1, "grid", 11)
    a, b = lens.trace(launched.o, launched.d), other.trace(launched.o, launched.d)
    assert same(a.o, b.o) and same(a.opl, b.opl) and same(a.fate, b.fate)
    made = pickle.loads(pickle.dumps(singlet()))
    assert same_data(made, singlet()) and made.elements == singlet().elements


@pytest.mark.parametrize("name", FILES)
def test_surfaces_of_a_file(name, tree, rng):
    """Each is what the trace meets, and the derivative by a radius is that of the curvature."""
    lens = Lens.read(tree / "examples" / "lenses" / name)
    o, d = rays(rng, 40, 0.5)
    for i in range(len(lens)):
        surface, there = lens.surface(i), lens._elements(None)[0][i].surface
        assert len(surface.parameters) == sagitta._library.library.sgt_parameters(there)
        if i == 0:  # (all of them have their first vertex at the origin, and no tilt there)
            met = lens.trace(o, d, passages=True).passages[0]
            mine = surface.intersect(o, d, tmin=-math.inf, pick="near-seed").p
            assert np.isfinite(mine).all() and np.abs(mine - met.p).max() < 1e-13
    there = lens.sensitivity(o, d)
    for i, c in ((i, getattr(lens.surface(i), "curvature", None)) for i in range(len(lens))):
        if c is not None and "curvature" in lens.surface(i).parameters:
            assert same(there.by(i, "radius"), -c * c * there.by(i, "curvature"))
    with pytest.raises(IndexError):
        lens.surface(len(lens))


@pytest.mark.parametrize("name", ["optiland__lens1__ad519c.zmx", "poke__Hubble_Test__dc4dcb.zmx"])
def test_zmx(name, tree):
    lens = Lens.read(tree / "tests" / "data" / "zmx" / name)
    assert len(lens) > 1 and all(r.kind in ("note", "turned", "left out") and r.words for r in lens.remarks)
    assert Lens.text(lens.yaml()).launch().o.shape[0] == 3
    with pytest.raises(AttributeError, match="yaml"):
        lens.elements


@pytest.mark.parametrize(
    "make, says",
    [
        (lambda: Lens([]), "surfaces"),
        (lambda: Lens([Plane()]), "element 0 must be an Element, not Plane"),
        (lambda: Lens([Element()]), "needs a surface"),
        (lambda: Lens([Element(3)]), "must be a Surface"),
        (lambda: Lens([Element(Plane(), index=-1)]), "index"),
        (lambda: Lens([Element(Plane(), index=math.nan)]), "index"),
        (lambda: Lens([Element(Plane(), glass="N-BK8")]), "N-BK8"),
        (lambda: Lens([Element(Plane(), apertures=[{"type": "hole"}])]), "hole"),
        (lambda: Lens([Element(Plane())], pupils={}), "pupils"),
        (lambda: Lens([Element(Plane(), name=Plane())]), "a lens file has no Plane"),
        (lambda: Lens.text("surfaces: ["), "lens.yaml"),
        (lambda: Lens.read("/nowhere/lens.yaml"), "/nowhere/lens.yaml"),
        (lambda: singlet().trace((0, 0, 0), (0, 0, 1), wavelength=math.nan), "wavelength"),
        (lambda: singlet().trace((0, 0, 0), (0, 0, 1), out=sagitta.Hits.empty(1)), "out: must be Traced"),
        (
            lambda: singlet().trace((0, 0, 0), (0, 0, 1), out=Traced.empty(1, passages=2)),
            "passages for 2 elements",
        ),
        (lambda: singlet().sensitivity((0, 0, 0), (0, 0, 1), "q"), "unknown 'q'"),
        (lambda: singlet().launch(7), "fields 1 to 2"),
        (lambda: singlet().launch(0), "fields count from 1, as in the lens file"),
        (lambda: singlet().spot(field=0), "fields count from 1, as in the lens file"),
        (lambda: singlet().spot(wavelength=0), "wavelength 0: a whole number is that of the lens"),
        (lambda: singlet().spot(colour=1), "no setting 'colour'; its settings: reference, defocus"),
        (lambda: singlet().spot(reference="middle"), "reference: must be one of 'chief', 'centroid'"),
        (lambda: singlet().sweep(from_=1), "no setting"),
        (lambda: singlet().sweep(to=95), "to: angles must be between"),
        (lambda: singlet().field(pattern="grid"), "takes no rays"),
        (lambda: singlet(units="").opd(wavelength=0.55), "units: must be mm"),
        (lambda: singlet().launch(1, "star"), "pattern"),
        (lambda: singlet().launch(1, "grid", 0), "rays"),
        (lambda: singlet(pupil={}).launch(), "pupil"),
        (lambda: singlet().aim(9, (0, 0), Beam((0, 0, 0), (0, 0, 1))), "element 9"),
        (lambda: singlet().aim(1, (0, 0, 0), Beam((0, 0, 0), (0, 0, 1))), "points"),
        (lambda: Lens.text("{surfaces: [{type: plane}]}").replace([]), "use set()"),
    ],
)
def test_what_is_wrong_is_told(make, says):
    with pytest.raises((ValueError, TypeError, IndexError, AttributeError)) as error:
        make()
    assert says in str(error.value)


def test_an_error_knows_its_place(tmp_path):
    (tmp_path / "bad.yaml").write_text("surfaces:\n  - {type: plane, thickness: 1}\n  - {type: plain}\n")
    with pytest.raises(LensError) as error:
        Lens.read(tmp_path / "bad.yaml")
    assert error.value.line == 3 and error.value.key == "type" and error.value.file.endswith("bad.yaml")
    again = pickle.loads(pickle.dumps(error.value))
    assert (str(again), again.line) == (str(error.value), 3)


def test_sensitivities_by_differences(rng):
    """Each derivative against a difference of two traces: of another lens, or of another ray."""
    lens = Lens(
        [
            Element(
                sagitta.EvenAsphere(radius=40, conic=-0.5, coefficients=[0, 1e-6]), thickness=6, index=1.5
            ),
            Element(Sphere(radius=-60), thickness=50, index=1, tilt=(1, 2, 0)),
            Element(Plane()),
        ]
    )
    o, d = rays(rng, 20, 5, 0.05)
    of = ("x", "y", "opl", "m")
    there = lens.sensitivity(o, d, of)
    assert (there.fate == 1).all() and len(lens.parameters) == there.gradient.shape[2]

    def value(other, o=o, d=d):
        return other.sensitivity(o, d, of).value

    def agree(pair, h, said):
        found = (pair[0] - pair[1]) / (2 * h)
        assert np.allclose(found, said, rtol=2e-5, atol=1e-6 * max(1, np.abs(found).max()))

    e = lens.elements
    for h, name, i, change in (
        (1e-6, "curvature", 0, lambda x: e[0].replace(surface=e[0].surface.replace(curvature=1 / 40 + x))),
        (1e-3, "radius", 0, lambda x: e[0].replace(surface=e[0].surface.replace(radius=40 + x))),
        (1e-4, "conic", 0, lambda x: e[0].replace(surface=e[0].surface.replace(conic=-0.5 + x))),
        (
            1e-9,
            "coefficients[1]",
            0,
            lambda x: e[0].replace(surface=e[0].surface.replace(coefficients=[0, 1e-6 + x])),
        ),
        (1e-6, "index", 0, lambda x: e[0].replace(index=1.5 + x)),
        (1e-5, "thickness", 0, lambda x: e[0].replace(thickness=6 + x)),
        (1e-5, "thickness", 1, lambda x: e[1].replace(thickness=50 + x)),
        (1e-5, "curvature", 1, lambda x: e[1].replace(surface=Sphere(curvature=-1 / 60 + x))),
        (1e-5, "x", 1, lambda x: e[1].replace(decenter=(x, 0, 0))),
        (1e-5, "z", 1, lambda x: e[1].replace(decenter=(0, 0, x))),
    ):
        pair = [value(lens.replace([*e[:i], change(x), *e[i + 1 :]])) for x in (h, -h)]
        agree(pair, h, there.by(i, name))
    for j in range(3):
        step = np.zeros((3, 1))
        step[j] = h = 1e-5
        agree([value(lens, o + step), value(lens, o - step)], h, there.gradient[:, :, j].T)
        agree([value(lens, o, d + step), value(lens, o, d - step)], h, there.gradient[:, :, 3 + j].T)
    with pytest.raises(ValueError, match="element 1 has no 'conics'"):
        there.by(1, "conics")
    two = lens.sensitivity(o, d, of, threads=2)
    assert same(two.gradient, there.gradient) and same(two.value, there.value)


PHASES = """
units: mm
wavelengths: [0.55]
surfaces:
  - {type: ideal, focal_length: 80, focal_length_y: 95, thickness: 3}
  - {type: sphere, radius: 60, thickness: 3, index: 1.5, phase: {waves: "a*r^2 + 3*x*y", a: -2, order: 2}}
  - {type: plane, thickness: 5, index: 1, phase: {lines: 20, order: -1}}
  - {type: plane, thickness: 5, facets: {type: even_asphere, radius: 50, coefficients: [0, 1e-6]}, index: 1.5}
  - {type: plane}
"""


def test_numbers_of_phases(rng):
    """Against differences of lenses with other numbers."""
    lens, (o, d), of = sagitta.Lens.text(PHASES), rays(rng, 20, 3, 0.02), ("x", "y", "m")
    there = lens.sensitivity(o, d, of)
    assert (there.fate == 1).all() and len(lens.phase_parameters) == there.phases.shape[2]
    for element, name, old, x, h in (
        (0, "focal_length", "focal_length: 80", 80, 1e-3),
        (0, "focal_length_y", "focal_length_y: 95", 95, 1e-3),
        (1, "waves[0]", "a: -2", -2, 1e-4),
        (2, "waves[3]", "lines: 20", 20, 1e-3),
        (3, "waves[3]", "1e-6", 1e-6, 1e-8),
    ):
        word = old[: old.rindex(" ") + 1] if " " in old else ""
        assert PHASES.count(old) == 1
        pair = [sagitta.Lens.text(PHASES.replace(old, f"{word}{x + s * h!r}")).sensitivity(o, d, of).value for s in (1, -1)]
        found = (pair[0] - pair[1]) / (2 * h)
        assert np.abs(found).max() > 0
        assert np.allclose(found, there.by(element, name), rtol=1e-5, atol=1e-7 * np.abs(found).max()), name
    assert np.isnan(lens.sensitivity([0, 400, 0], (0, 0, 1)).by(1, "per_wave")).all()


def test_aims(rng):
    lens = singlet()
    beam = Beam(o=(0, 0, -20), d=(0, 0.05, 1), ou=(1, 0, 0), ov=(0, 1, 0), u=(-9, 9), v=(-9, 9))
    wanted = rng.uniform(-3, 3, (2, 30))
    found = lens.aim(2, wanted, beam)
    assert (found.aimed == 1).all()
    there = lens.trace(found.o, found.d, passages=True).passages[2]
    assert (
        np.hypot(*(there.p[:2] - wanted)) <= found.miss * 1.0001 + 1e-15
    ).all() and found.miss.max() < 1e-12
    assert same(np.array(beam.rays(found.u, found.v)[0]), found.o) or np.allclose(
        beam.rays(found.u, found.v)[0], found.o
    )
    none = lens.aim(2, (50, 50), beam)
    assert none.aimed[0] <= 0 and np.isnan(none.u[0]) and none.clipped[0] == -1
    assert same(lens.aim(2, wanted, beam, threads=2).u, found.u)


def test_fields_and_spots():
    lens = singlet(wavelengths=[0.5876, 0.4861])
    spot = lens.spot(2, 1, rays=8, reference="centroid")
    assert (spot.rays == 217).all() and (spot.passed == spot.rays).all() and (spot.digits > 9).all()
    ends = lens.ends(2, 1, rays=8)
    w, x, y = ends.weight, ends.x, ends.y
    mean = np.array([(w * x).sum(), (w * y).sum()]) / w.sum()
    assert np.allclose(mean, [spot.x[0], spot.y[0]], atol=1e-12)
    rms = math.sqrt((w * ((x - mean[0]) ** 2 + (y - mean[1]) ** 2)).sum() / w.sum())
    assert abs(rms - spot.rms[0]) < 1e-12 * rms + ends.xy_err.max()
    launched = lens.launch(2, "hexapolar", 8)
    traced = lens.trace(launched.o, launched.d, passages=True)
    assert same(traced.passages[3].p[1], y) and (launched.aimed == 1).all()
    assert same(lens.launch((0, 5)).d, lens.launch(2).d)
    three = lens.launch(1, "fan", 3)
    assert same(lens.trace(three).o, lens.trace(three.o, three.d, axis=0).o)
    for bad in (lambda: lens.trace(three, three.d), lambda: lens.trace(three.o)):
        with pytest.raises((TypeError, ValueError), match="d: is"):
            bad()
    assert lens.spot(1, pattern=np.array([[0, 0, 0], [0, 0.5, 1]])).rays[0] == 3
    both = lens.spot(2)
    assert both.of(wavelength=0).rays[0] == 2 * lens.spot(2, 1).rays[0] and len(both) == 3
    for one, other in ((1, 0.5876), (2, 0.4861), ("F", 0.4861327)):
        assert same(lens.ends(1, one).y, lens.ends(1, other).y)
        assert same(lens.trace(three, wavelength=one).o, lens.trace(three, wavelength=other).o)
    assert lens.map(1).wavelength[0] == 0.5876 and len(lens.map(1, "all", rays=5)) == 2 * len(lens.map(1, rays=5))
    assert [len(lens.spot(fields=f, wavelength=1)) for f in ([1], [1, 2], [2, (0, 1)])] == [2, 4, 4]
    assert same(lens.ends(rays=12, threads=3).y, lens.ends(rays=12).y)
    sums = lens.seidel()
    assert len(sums.spherical) == 4 and sums.why_not == "" and abs(sums.spherical.sum()) > 0


def test_formulas_in_a_lens():
    """A sphere by its formula: nearly the same rays, and first-order data too."""

    def lens(front):
        return Lens(
            [
                Element(front, index=1.5, thickness=5, semi_diameter=20),
                Element(Plane(), index=1, thickness=90),
                Element(Plane()),
            ],
            pupil={"semi_diameter": 5},
        )

    formula = sagitta.Sag("c*r^2/(1 + sqrt(1 - c^2*r^2))", c=0.02)
    a, b = lens(formula), lens(Sphere(radius=50))
    o = [[0, 1, 2, 5], [0, 3, -2, 4], [-5] * 4]
    x, y = a.trace(o, (0, 0, 1)), b.trace(o, (0, 0, 1))
    assert x.through.all() and np.abs(x.o - y.o).max() < 1e-11
    assert "c" in a.parameters[7] and np.allclose(
        a.sensitivity(o, (0, 0, 1)).by(0, "c"), b.sensitivity(o, (0, 0, 1)).by(0, "curvature")
    )
    assert abs(a.first_order().efl - 100) < 1e-9 or math.isnan(a.first_order().efl)


def test_phases():
    """The grating equation, at wavelengths of the lens and others; the phase is read and set by its path."""
    lens = Lens(
        [Element(Plane(), thickness=5, phase={"lines": 300, "order": -1}), Element(Plane(), phase="-2*r^2")],
        units="mm",
        wavelengths=[0.55, 0.65],
        primary=1,
    )
    for um in (0.55, 0.65, 0.4321):
        traced = lens.trace((0, 0, -1), (0, 0, 1), wavelength=um, passages=True)
        assert abs(traced.passages[0].direction[1, 0] + 300 * um * 1e-3) < 1e-14
    assert lens.get("surfaces[1].phase.order") == -1 and lens.get("surfaces[2].phase") == "-2*r^2"
    assert "surfaces[1].phase.lines" in lens.paths()
    far = lens.set("surfaces[1].phase.order", 7).trace((0, 0, -1), (0, 0, 1))
    assert far.fate[0] == Fate.EVANESCENT


def test_a_million_rays_reuse_their_room(rng):
    lens = singlet()
    o, _ = rays(rng, 10**5, 4)
    out = Traced.empty(10**5, passages=4)
    first = lens.trace(o, (0, 0, 1), out=out)
    assert first is out
    want = lens.trace(o, (0, 0, 1), passages=True)
    for name in Traced.FIELDS:
        assert same(out._rows[name], want._rows[name])
    for a, b in zip(out.passages, want.passages):
        assert all(same(a._rows[k], b._rows[k]) for k in a._rows)
    # The rays may be traced in place: what comes out is where they are.
    p, v = o.copy(), np.tile([[0.0], [0], [1]], 10**5)
    lens.trace(p, v, out=Traced(o=p, d=v))
    assert same(p, want.o) and same(v, want.d)
    by_rows = lens.trace(o.T.copy(), (0, 0, 1))
    assert by_rows.o.shape == (10**5, 3) and same(by_rows.o, want.o.T)


@pytest.mark.parametrize("rim, none", [("", False), ("semi_diameter: 4, ", True)])
def test_rays_that_are_not_there(tmp_path, rim, none):
    """A stop that no ray reaches: with a rim in front that is proven; without one it is told how far."""
    path = tmp_path / "stop.yaml"
    path.write_text(
        "units: mm\naim: stop\npupil: {semi_diameter: 1, distance: 0}\nfields: [0]\nsurfaces:\n"
        f"  - {{type: plane, {rim}thickness: 5, index: 1.5}}\n"
        "  - {type: plane, decenter: [0, 5000, 0], thickness: 50, stop: true, index: 1}\n  - {type: plane, index: 1}\n"
    )
    lens = Lens.read(path)
    rays = lens.launch(1, "fan", 3)
    assert (rays.aimed == (sagitta.Aimed.NO_SUCH_RAY if none else sagitta.Aimed.UNDECIDED)).all()
    assert np.allclose(rays.wanted, [[0, 0, 0], [-1, 0, 1]]) and np.isnan(rays.o).all()
    assert (rays.within == 600).all() or none
    assert len(rays.missing()) == 3 and all(
        ("as is proven" if none else "none within 600") in words for words in rays.missing()
    )
    fates = lens.ends(1, pattern="fan", rays=3).fates
    assert (fates.none, fates.lost, fates.unfound) == ((3, 0, 0) if none else (0, 3, 3))


def test_another_lens_by_paths(tree):
    """Edits make other lenses; the one that was asked stays, and equality is by value."""
    lens = Lens.read(tree / "examples" / "lenses" / "cooke_triplet.yaml")
    was, paths = lens.yaml(), lens.paths()
    assert paths["surfaces[1].radius"] == lens.get("surfaces[1].radius") == 22.01359
    assert lens.get("surfaces[4].stop") is True and lens.get("name") == "Cooke triplet"
    assert lens.set(paths) == lens and hash(lens.set(paths)) == hash(lens) and lens.copy() == lens
    other = lens.set("surfaces[6].thickness", np.float64(40))
    assert other != lens and other.get("surfaces[6].thickness") == 40.0 and lens.yaml() == was
    assert Lens.text(other.yaml()) == other and pickle.loads(pickle.dumps(other)) == other
    solved = lens.set("surfaces[6].thickness", {"solve": "paraxial_focus"})
    assert abs(solved.first_order().image) < 1e-12
    assert solved.scale(2).scale(0.5) == solved.scale(4).scale(0.25)
    both = lens.insert("surfaces[1]", Element(Plane(), thickness=1, index=1))
    assert len(both) == 8 and both.remove("surfaces[1]") == lens
    turned = lens.reverse("surfaces[1]", "surfaces[6]")
    assert turned.first_order().efl == pytest.approx(lens.first_order().efl, rel=1e-12)
    assert turned.reverse("surfaces[1]", "surfaces[6]").paths() == paths
    with pytest.raises(LensError) as error:
        lens.set({"surfaces[1].radius": 20, "surfaces[2].glass": "N-BK8"})
    assert error.value.key == "surfaces[2].glass" and "N-BK7" in str(error.value)
    with pytest.raises(LensError, match="there is no surface 9"):
        lens.remove("surfaces[9]")
    with pytest.raises(TypeError, match="Function"):
        Lens([Element(sagitta.Function(lambda x, y, z: z), thickness=1, index=1), Element(Plane())]).copy()
