# SPDX-License-Identifier: MIT
"""The library as ctypes sees it: the structs of the headers, and the functions.

Each struct has the name and the members of its C struct; tests/test_layouts.py compares every offset with
what the compiler says.  A vector of C is an array of three doubles here.  Nothing of this file is for users.
"""
from __future__ import annotations

import ctypes
import os
import pathlib
import struct
from ctypes import POINTER, Structure, c_bool, c_char, c_char_p, c_double, c_int, c_size_t, c_uint, c_uint64, c_void_p
from typing import Any, Callable

Vector = c_double * 3
Pair = c_double * 2
Doubles = c_void_p  # the address of an array
Addresses = c_void_p * 3
Words = ctypes.c_ulonglong  # of what is reserved for later versions
NAN = float("nan")


class ArithmeticFault(RuntimeError):
    """The processor has been told to compute otherwise than the library needs."""


def _load() -> ctypes.CDLL:
    given = os.environ.get("SAGITTA_PYTHON_LIBRARY")
    folder = pathlib.Path(__file__).parent
    path = pathlib.Path(given) if given else folder / "libsagitta_python.so"
    if not path.exists():
        raise ImportError(
            f"sagitta: {path} is not there.  Install the package (pip install .), or name the "
            "library of a build folder in the environment: SAGITTA_PYTHON_LIBRARY"
        )
    return ctypes.CDLL(str(path))


library = _load()


class Ray(Structure):
    _fields_ = [("o", Vector), ("d", Vector), ("tmin", c_double), ("tmax", c_double)]


class Rays(Structure):
    _fields_ = [("o", Addresses), ("d", Addresses), ("tmin", Doubles), ("tmax", Doubles)]


class RaysF(Structure):
    _fields_ = [("o", Addresses), ("d", Addresses), ("tmin", c_void_p), ("tmax", c_void_p)]


class Starts(Structure):
    _fields_ = [
        ("p", Addresses),
        ("n", Addresses),
        ("p_err", Doubles),
        ("d", Addresses),
        ("tmax", Doubles),
        ("reserved_", Words * 2),
    ]


class Surface(Structure):
    _fields_ = [("ops", c_void_p), ("self", c_void_p)]


class Hit(Structure):
    _fields_ = [
        ("status", ctypes.c_byte),
        ("evals", c_int),
        ("t", c_double),
        ("t_err", c_double),
        ("t_lo", c_double),
        ("lo", c_double),
        ("hi", c_double),
        ("f", c_double),
        ("p", Vector),
        ("n", Vector),
        ("p_err", c_double),
        ("reserved_", Words * 2),
    ]


class Hits(Structure):
    _fields_ = [
        ("status", c_void_p),
        ("evals", c_void_p),
        ("t", Doubles),
        ("t_err", Doubles),
        ("t_lo", Doubles),
        ("p", Addresses),
        ("n", Addresses),
        ("p_err", Doubles),
        ("reserved_", Words * 2),
    ]


class HitsF(Structure):
    _fields_ = [
        ("status", c_void_p),
        ("t", c_void_p),
        ("t_err", c_void_p),
        ("p", Addresses),
        ("n", Addresses),
        ("p_err", c_void_p),
        ("reserved_", Words * 2),
    ]


class Options(Structure):
    _fields_ = [
        ("t_tol", c_double),
        ("f_tol", c_double),
        ("dt_min", c_double),
        ("max_evals", c_int),
        ("pick", c_int),
        ("proof", c_int),
        ("watch", c_void_p),
        ("watch_data", c_void_p),
        ("reserved_", Words * 2),
    ]


class Step(Structure):
    _fields_ = [
        ("ray", c_size_t),
        ("eval", c_int),
        ("move", c_int),
        ("kind", c_int),
        ("t", c_double),
        ("f", c_double),
        ("slope", c_double),
        ("lo", c_double),
        ("hi", c_double),
        ("f_lo", c_double),
        ("f_hi", c_double),
        ("slope_lo", c_double),
        ("slope_hi", c_double),
        ("reserved_", Words * 4),
    ]


class Log(Structure):
    _fields_ = [("step", c_void_p), ("cap", c_int), ("n", c_int)]


class Diagnosis(Structure):
    _fields_ = [
        ("verdict", c_int),
        ("order", c_double),
        ("rate", c_double),
        ("condition", c_double),
        ("newton", c_int),
        ("bisect", c_int),
        ("march", c_int),
        ("retreat", c_int),
        ("before", c_int),
        ("reserved_", Words * 4),
    ]


class Jacobian(Structure):
    _fields_ = [
        ("t_by_o", c_void_p * 3),
        ("p_by_o", c_void_p * 9),
        ("n_by_o", c_void_p * 9),
        ("t_by_a", c_void_p),
        ("p_by_a", c_void_p * 3),
        ("n_by_a", c_void_p * 3),
        ("reserved_", Words * 4),
    ]


class Numbers(Structure):
    _fields_ = [("x", c_void_p), ("rows", c_size_t), ("columns", c_size_t)]


class ParamUnit(Structure):
    _fields_ = [("length", c_int), ("by_i", c_int), ("by_j", c_int), ("time", c_int)]


class Param(Structure):
    _fields_ = [
        ("name", c_char_p),
        ("unit", ParamUnit),
        ("offset", c_size_t),
        ("count", c_int),
        ("lo", c_double),
        ("hi", c_double),
        ("kind", c_int),
        ("words", c_char_p),
        ("reserved_", Words * 2),
    ]


class Objection(Structure):
    _fields_ = [("param", c_char_p), ("reason", c_char_p)]


class Builtin(Structure):
    _fields_ = [
        ("type", c_char_p),
        ("ops", c_void_p),
        ("size", c_size_t),
        ("params", POINTER(Param)),
        ("object", ctypes.CFUNCTYPE(Objection, c_void_p)),
        ("prepare", ctypes.CFUNCTYPE(None, c_void_p)),
        ("family", c_int),
        ("specimen", c_void_p),
        ("reserved_", Words * 4),
    ]


REAL, VECTOR, WHOLE, LIST, TABLE, WORD, TRUTH, TERMS = range(8)


class Pose(Structure):
    _fields_ = [("origin", Vector), ("ex", Vector), ("ey", Vector), ("ez", Vector)]


class Element(Structure):
    _fields_ = [
        ("surface", Surface),
        ("pose", Pose),
        ("index", c_double),
        ("semi_diameter", c_double),
        ("aperture", c_void_p),
        ("phase", c_void_p),
        ("reserved_", Words * 6),
    ]


class Traced(Structure):
    _fields_ = [
        ("fate", c_void_p),
        ("passed", c_void_p),
        ("o", Addresses),
        ("d", Addresses),
        ("opl", Doubles),
        ("reserved_", Words * 2),
    ]


class Passages(Structure):
    _fields_ = [("hits", Hits), ("direction", Addresses), ("opl", Doubles), ("reserved_", Words * 2)]


class RayChange(Structure):
    _fields_ = [("p", Vector), ("d", Vector), ("opl", c_double)]


class Beam(Structure):
    _fields_ = [
        ("o", Vector),
        ("ou", Vector),
        ("ov", Vector),
        ("d", Vector),
        ("du", Vector),
        ("dv", Vector),
        ("u", Pair),
        ("v", Pair),
        ("reserved_", Words * 2),
    ]


class AimOptions(Structure):
    _fields_ = [
        ("tol", c_double),
        ("starts", c_size_t),
        ("start", c_void_p),
        ("max_traces", c_int),
        ("max_boxes", c_int),
        ("room", c_size_t),
        ("attempt", c_void_p),
        ("reserved_", Words * 4),
    ]


class Aiming(Structure):
    _fields_ = [
        ("status", c_int),
        ("u", c_double),
        ("v", c_double),
        ("ray", Ray),
        ("point", Pair),
        ("miss", c_double),
        ("clipped", c_size_t),
        ("attempts", c_size_t),
        ("traces", c_int),
        ("boxes", c_int),
        ("reserved_", Words * 2),
    ]


class Error(Structure):
    _fields_ = [
        ("file", c_char * 256),
        ("line", c_size_t),
        ("column", c_size_t),
        ("key", c_char * 128),
        ("words", c_char * 1400),
        ("reserved_", Words * 4),
    ]


class LensRemark(Structure):
    _fields_ = [
        ("kind", c_int),
        ("line", c_size_t),
        ("key", c_char_p),
        ("words", c_char_p),
        ("reserved_", Words * 2),
    ]


class Edit(Structure):
    _fields_ = [
        ("kind", c_int),
        ("path", c_char_p),
        ("number", c_double),
        ("text", c_char_p),
        ("reserved_", Words * 4),
    ]


EDIT_SET, EDIT_SET_TEXT, EDIT_INSERT, EDIT_REMOVE, EDIT_REVERSE, EDIT_SCALE = range(6)


class LensPath(Structure):
    _fields_ = [("path", ctypes.c_char * 128), ("value", c_double), ("reserved_", Words * 4)]


class LensField(Structure):
    _fields_ = [(name, c_double) for name in ("x", "y", "weight", "dx", "dy", "cx", "cy", "angle")] + [
        ("reserved_", Words * 2)
    ]


class LensSurface(Structure):
    _fields_ = [
        ("type", c_char_p),
        ("name", c_char_p),
        ("line", c_size_t),
        ("z", c_double),
        ("mirror", c_bool),
        ("off_axis", c_bool),
        ("folded", c_bool),
        ("size", c_double),
        ("focal_length", c_double),
        ("reserved_", Words * 4),
    ]


class Lens(Structure):
    _fields_ = [
        ("file", c_char_p),
        ("line", c_size_t),
        ("name", c_char_p),
        ("units", c_char_p),
        ("wavelengths", c_size_t),
        ("wavelength", POINTER(c_double)),
        ("wavelength_weight", POINTER(c_double)),
        ("primary", c_size_t),
        ("object_distance", c_double),
        ("object_slope", c_double * 2),
        ("telecentric", c_bool),
        ("afocal", c_bool),
        ("pupil", c_int),
        ("pupil_size", c_double),
        ("pupil_distance", c_double),
        ("aim", c_int),
        ("stop", c_size_t),
        ("stop_marked", c_bool),
        ("field_kind", c_int),
        ("fields", c_size_t),
        ("field", POINTER(LensField)),
        ("count", c_size_t),
        ("element", POINTER(Element)),
        ("surface", POINTER(LensSurface)),
        ("index_before", c_double),
        ("remarks", c_size_t),
        ("remark", POINTER(LensRemark)),
        ("reserved_", Words * 8),
    ]


class LensOptions(Structure):
    _fields_ = [
        ("allocator", c_void_p),
        ("glasses", c_void_p),
        ("types", c_void_p),
        ("file_ops", c_void_p),
        ("complete", c_void_p),
        ("read", c_void_p),
        ("forget", c_void_p),
        ("context", c_void_p),
        ("configuration", c_int),
        ("reserved_", Words * 4),
    ]


class FirstOrder(Structure):
    _fields_ = [
        (name, c_double)
        for name in (
            "wavelength",
            "power",
            "efl",
            "efl_image",
            "ffd",
            "bfd",
            "focus",
            "image",
            "front_principal",
            "rear_principal",
            "front_nodal",
            "rear_nodal",
            "magnification",
            "entrance_pupil",
            "entrance_radius",
            "exit_pupil",
            "exit_radius",
            "stop_radius",
            "f_number",
            "f_number_working",
            "image_height",
            "lagrange",
            "petzval_radius",
        )
    ] + [
        ("without_vertex", c_size_t),
        ("angular_magnification", c_double),
        ("without_seidel", c_char_p),
        ("reserved_", Words * 8),
    ]


class Parabasal(Structure):
    _fields_ = [
        ("power", Pair * 2),
        ("efl", Pair),
        ("focus", Pair),
        ("image", Pair),
        ("magnification", Pair),
        ("power_xy", c_double),
        ("reserved_", Words * 3),
    ]


class Seidel(Structure):
    _fields_ = [
        (name, c_double) for name in ("spherical", "coma", "astigmatism", "petzval", "distortion")
    ] + [("chromatic", Pair), ("reserved_", Words * 2)]


class LauncherOptions(Structure):
    _fields_ = [
        ("allocator", c_void_p),
        ("aim", c_void_p),
        ("wavelength", c_double),
        ("reserved_", Words * 4),
    ]


class FieldBeam(Structure):
    _fields_ = [
        ("finite", c_bool),
        ("object", Vector),
        ("direction", Vector),
        ("pupil", c_double),
        ("radius", c_double),
        ("cone", c_double),
        ("front", c_double),
        ("wave", c_double),
        ("shift", Pair),
        ("scale", Pair),
        ("turn", Pair),
        ("reserved_", Words * 4),
    ]


class PupilPoint(Structure):
    _fields_ = [("x", c_double), ("y", c_double), ("weight", c_double)]


class Attempt(Structure):
    _fields_ = [
        ("from", Pair),
        ("to", Pair),
        ("miss", c_double),
        ("reason", c_int),
        ("fate", ctypes.c_byte),
        ("element", c_size_t),
        ("traces", c_int),
        ("reserved_", Words * 2),
    ]


class Launched(Structure):
    _fields_ = [
        ("ray", Ray),
        ("status", c_int),
        ("folded", c_bool),
        ("wanted", Pair),
        ("within", c_double),
        ("nearest", Attempt),
        ("reserved_", Words * 4),
    ]


class Wavelength(Structure):
    _fields_ = [("number", c_size_t), ("um", c_double)]


class StudyOptions(Structure):
    _fields_ = [
        ("allocator", c_void_p),
        ("aim", c_void_p),
        ("solver", c_void_p),
        ("open", c_bool),
        ("fields", c_size_t),
        ("field", c_void_p),
        ("field_at", c_void_p),
        ("field_kind", c_void_p),
        ("wavelengths", c_size_t),
        ("wavelength", c_void_p),
        ("every_wavelength", c_bool),
        ("pattern", c_void_p),
        ("rays", c_size_t),
        ("across", c_size_t),
        ("seed", c_uint64),
        ("points", c_size_t),
        ("point", c_void_p),
        ("run", c_void_p),
        ("context", c_void_p),
        ("equal_weights", c_bool),
        ("shard", c_void_p),
        ("reserved_", Words * 2),
    ]


class List(Structure):
    _fields_ = [("count", c_size_t), ("at", c_void_p)]


class Column(Structure):
    _fields_ = [
        ("name", c_char_p),
        ("kind", c_int),
        ("dimension", c_int),
        ("flags", c_uint),
        ("offset", c_size_t),
        ("error", c_size_t),
        ("help", c_char_p),
        ("reserved_", Words * 4),
    ]


class Setting(Structure):
    _fields_ = [
        ("name", c_char_p),
        ("kind", c_int),
        ("offset", c_size_t),
        ("words", c_char_p),
        ("least", c_size_t),
        ("most", c_size_t),
        ("help", c_char_p),
        ("reserved_", Words * 4),
    ]


class Analysis(Structure):
    _fields_ = [
        ("name", c_char_p),
        ("title", c_char_p),
        ("help", c_char_p),
        ("primary_alone", c_bool),
        ("no_fields", c_bool),
        ("no_rays", c_bool),
        ("pattern", c_int),
        ("rays", c_size_t),
        ("part_of", c_char_p),
        ("draw_x", c_char_p),
        ("draw_y", c_char_p),
        ("row_size", c_size_t),
        ("columns", c_size_t),
        ("column", POINTER(Column)),
        ("options_size", c_size_t),
        ("settings", c_size_t),
        ("options_room", c_size_t),
        ("setting", POINTER(Setting)),
        ("ask", c_void_p),
        ("reserved_", Words * 4),
    ]


class Fates(Structure):
    _fields_ = [
        ("rays", c_size_t),
        ("passed", c_size_t),
        ("missed", c_size_t),
        ("clipped", c_size_t),
        ("tir", c_size_t),
        ("lost", c_size_t),
        ("none", c_size_t),
        ("unfound", c_size_t),
        ("within", c_double),
        ("folded", c_size_t),
        ("proven", c_size_t),
        ("evanescent", c_size_t),
        ("reserved_", Words * 3),
    ]


class Part(Structure):
    _fields_ = [("at", c_char_p), ("size", c_size_t), ("taken", c_size_t)]


class Summands(Structure):
    _fields_ = [
        ("n", c_size_t),
        ("x", Doubles),
        ("y", Doubles),
        ("opd", Doubles),
        ("error", Doubles),
        ("weight", Doubles),
        ("passed", c_void_p),
    ]


class Spot(Structure):
    _fields_ = [
        ("rays", c_size_t),
        ("passed", c_size_t),
        ("reference", Pair),
        ("rms", c_double),
        ("rms_x", c_double),
        ("rms_y", c_double),
        ("geometric", c_double),
        ("error", c_double),
        ("reserved_", Words * 4),
    ]


class Wavefront(Structure):
    _fields_ = [
        ("rays", c_size_t),
        ("passed", c_size_t),
        ("mean", c_double),
        ("rms", c_double),
        ("least", c_double),
        ("most", c_double),
        ("error", c_double),
        ("reserved_", Words * 4),
    ]


class Answer(Structure):
    _fields_ = [
        ("row", c_void_p),
        ("rows", c_size_t),
        ("room", c_size_t),
        ("size", c_size_t),
        ("words", c_void_p),
        ("length", c_size_t),
        ("words_room", c_size_t),
        ("threads", c_int),
        ("no_memory", c_bool),
        ("fates", Fates),
        ("number", c_size_t),
        ("of", c_size_t),
        ("shard", c_void_p),
        ("part", c_void_p),
        ("part_size", c_size_t),
        ("part_room", c_size_t),
        ("given", c_void_p),
    ]


class Tolerance(Structure):
    _fields_ = [
        ("kind", c_int),
        ("distribution", c_int),
        ("compensator", c_int),
        ("first", c_size_t),
        ("last", c_size_t),
        ("lower", c_double),
        ("upper", c_double),
        ("wavelength", c_double),
        ("over", c_double),
        ("pivot", c_double),
        ("term", c_size_t),
        ("line", c_size_t),
        ("name", c_char_p),
        ("reserved_", Words * 4),
    ]


class TolerancingOptions(Structure):
    _fields_ = [
        ("figure", c_int),
        ("study", c_void_p),
        ("reference", c_int),
        ("reserved_", Words * 4),
    ]


class Sensitivity(Structure):
    _fields_ = [
        ("entry", c_size_t),
        ("figure_lower", c_double),
        ("figure_upper", c_double),
        ("change_lower", c_double),
        ("change_upper", c_double),
        ("worse", c_double),
        ("compensator_lower", c_double),
        ("compensator_upper", c_double),
        ("derivative", c_double),
        ("linear_lower", c_double),
        ("linear_upper", c_double),
        ("compensator_derivative", c_double),
        ("reserved_", Words * 4),
    ]


class SensitivitySum(Structure):
    _fields_ = [
        ("nominal", c_double),
        ("compensated", c_double),
        ("estimate", c_double),
        ("reserved_", Words * 4),
    ]


class WorstOptions(Structure):
    _fields_ = [("limit", List), ("boxes", c_size_t), ("reserved_", Words * 4)]


class WorstCase(Structure):
    _fields_ = [
        ("bound", c_double),
        ("seen", c_double),
        ("verdict", c_int),
        ("boxes", c_size_t),
        ("lenses", c_size_t),
        ("element", c_size_t),
        ("why", c_char_p),
        ("reserved_", Words * 8),
    ]


class Confidence(Structure):
    _fields_ = [
        ("estimate", c_double),
        ("lower", c_double),
        ("upper", c_double),
    ]


class FigureOptions(Structure):
    _fields_ = [("kind", c_int), ("reference", c_int), ("reserved_", Words * 6)]


class FigureCount(Structure):
    _fields_ = [("paths", c_size_t), ("residuals", c_size_t), ("values", c_size_t), ("reserved_", Words * 4)]


class FigureOut(Structure):
    _fields_ = [
        ("residual", Doubles),
        ("jacobian", Doubles),
        ("value", Doubles),
        ("value_err", Doubles),
        ("gradient", Doubles),
        ("gradient_err", Doubles),
        ("rays", c_size_t),
        ("clipped", c_size_t),
        ("lost", c_size_t),
        ("backward", c_size_t),
        ("reserved_", Words * 6),
    ]


class Named(Structure):
    _fields_ = [("name", c_char_p), ("value", c_double)]


class Formula(Structure):
    _fields_ = [("tape", c_void_p), ("ball", c_double), ("lo", Vector), ("hi", Vector)]


class FormulaSag(Structure):
    _fields_ = [("tape", c_void_p), ("semi_diameter", c_double)]


INTERSECT, ALL, TRACE, GRADIENT, AIM, CHECK, LEAVE, VALUES, SINGLE = range(9)


class Call(Structure):
    """sagitta_call of bridge.c."""

    _fields_ = [
        ("task", c_int),
        ("python", c_int),
        ("begin", c_size_t),
        ("end", c_size_t),
        ("met", c_size_t),
        ("blocks", c_size_t),
        ("opt", POINTER(Options)),
        ("surface", Surface),
        ("rays", Rays),
        ("hits", Hits),
        ("cap", c_int),
        ("count", c_void_p),
        ("hit", c_void_p),
        ("elements", c_size_t),
        ("element", c_void_p),
        ("index_before", c_double),
        ("traced", Traced),
        ("passages", c_void_p),
        ("rows", c_size_t),
        ("parameters", c_size_t),
        ("weight", c_void_p),
        ("gradient", c_void_p),
        ("ends", c_void_p),
        ("lacks", c_int),
        ("phases", c_size_t),
        ("phase_gradient", c_void_p),
        ("beam", c_void_p),
        ("point", c_void_p),
        ("aim", c_void_p),
        ("aiming", c_void_p),
        ("ray", c_void_p),
        ("where", c_void_p),
        ("fault", c_int),
        ("starts", Starts),
        ("side", c_void_p),
        ("rays_f", RaysF),
        ("hits_f", HitsF),
    ]


class Meeting(Structure):
    """sagitta_meeting of bridge.c."""

    _fields_ = [
        ("surface", c_void_p),
        ("opt", c_void_p),
        ("n", c_size_t),
        ("hits", c_void_p),
        ("names", c_size_t),
        ("rays", Rays),
    ]


class Passing(Structure):
    """sagitta_passing of bridge.c."""

    _fields_ = [
        ("elements", c_size_t),
        ("element", c_void_p),
        ("index_before", c_double),
        ("opt", c_void_p),
        ("n", c_size_t),
        ("traced", c_void_p),
        ("names", c_size_t),
        ("passages", c_void_p),
        ("pitch", c_size_t),
        ("told", c_size_t),
        ("rays", Rays),
    ]


class Layout(Structure):
    _fields_ = [("type", c_char_p), ("member", c_char_p), ("at", c_size_t), ("size", c_size_t)]


# Of bridge.c: what (a question), n, stride, in, out.
Asker = ctypes.CFUNCTYPE(c_int, c_int, c_size_t, c_size_t, c_void_p, c_void_p)
VALUE, VALUE_GRAD, ROUNDING, CLEARANCE, ESTIMATE, ENCLOSE = range(6)
ROWS = {
    VALUE: (3, 1),
    VALUE_GRAD: (3, 4),
    ROUNDING: (3, 1),
    CLEARANCE: (3, 1),
    ESTIMATE: (3, 1),
    ENCLOSE: (8, 4),
}

_PROTOTYPES: dict[str, tuple[Any, list[Any]]] = {
    "sgt_arithmetic": (c_int, []),
    "sgt_arithmetic_text": (c_char_p, [c_int]),
    "sagitta_function_size": (c_size_t, []),
    "sagitta_function_begin": (None, [c_void_p, Asker, c_double, Vector, Vector, c_double, c_int]),
    "sagitta_run": (c_int, [c_void_p]),
    "sagitta_one": (c_int, [c_void_p, c_void_p, c_void_p, c_void_p]),
    "sagitta_meet": (c_int, [c_char_p]),
    "sagitta_pass": (c_int, [c_char_p]),
    "sagitta_nothing": (c_int, [c_void_p, c_void_p, c_void_p, c_void_p]),
    "sagitta_layouts": (POINTER(Layout), []),
    "sgt_version": (c_char_p, []),
    "sgt_builtins": (c_void_p, []),
    "sgt_status_text": (c_char_p, [ctypes.c_byte]),
    "sgt_fate_text": (c_char_p, [ctypes.c_byte]),
    "sgt_aimed_text": (c_char_p, [c_int]),
    "sgt_move_text": (c_char_p, [c_int]),
    "sgt_verdict_text": (c_char_p, [c_int]),
    "sgt_fault_text": (c_char_p, [c_int]),
    "sgt_diagnose": (Diagnosis, [POINTER(Log)]),
    "sgt_parameters": (c_size_t, [Surface]),
    "sgt_is_sag": (c_bool, [Surface]),
    "sgt_differentiate_batch": (c_int, [Surface, c_size_t, Rays, Hits, Jacobian]),
    "sgt_trace_parameters": (c_size_t, [c_size_t, c_void_p]),
    "sgt_phase_parameters": (c_size_t, [c_size_t, c_void_p]),
    "sgt_lens_read": (POINTER(Lens), [c_char_p, POINTER(LensOptions), POINTER(Error)]),
    "sgt_lens_read_text": (
        POINTER(Lens),
        [c_char_p, c_char_p, c_size_t, POINTER(LensOptions), POINTER(Error)],
    ),
    "sgt_lens_free": (None, [POINTER(Lens)]),
    "sgt_lens_copy": (POINTER(Lens), [POINTER(Lens), POINTER(Error)]),
    "sgt_lens_edit": (c_bool, [POINTER(Lens), c_size_t, POINTER(Edit), POINTER(Error)]),
    "sgt_lens_get": (c_bool, [POINTER(Lens), c_char_p, POINTER(c_double), POINTER(Error)]),
    "sgt_lens_get_text": (c_size_t, [POINTER(Lens), c_char_p, c_size_t, c_char_p, POINTER(Error)]),
    "sgt_lens_paths": (c_size_t, [POINTER(Lens), c_size_t, POINTER(LensPath)]),
    "sgt_lens_configurations": (c_size_t, [POINTER(Lens)]),
    "sgt_lens_configuration_name": (c_char_p, [POINTER(Lens), c_size_t]),
    "sgt_lens_configuration_named": (c_size_t, [POINTER(Lens), c_char_p, POINTER(Error)]),
    "sgt_lens_configured": (POINTER(Lens), [POINTER(Lens), c_size_t, POINTER(Error)]),
    "sgt_lens_at": (c_bool, [POINTER(Lens), c_double, c_void_p, POINTER(c_double), POINTER(Error)]),
    "sgt_lens_yaml": (c_void_p, [POINTER(Lens), POINTER(c_size_t)]),
    "sgt_lens_first_order": (
        c_bool,
        [POINTER(Lens), c_double, POINTER(FirstOrder), c_void_p, POINTER(Error)],
    ),
    "sgt_field_parabasal": (
        c_bool,
        [POINTER(Lens), c_double, c_size_t, POINTER(Parabasal), POINTER(Error)],
    ),
    "sgt_pupil_points": (c_size_t, [c_int, c_size_t, ctypes.c_uint64, c_size_t, c_void_p]),
    "sgt_catalogue_new": (c_void_p, [c_void_p]),
    "sgt_catalogue_free": (None, [c_void_p]),
    "sgt_catalogue_add": (c_bool, [c_void_p, c_char_p, POINTER(Error)]),
    "sgt_launcher_new": (c_void_p, [POINTER(Lens), POINTER(LauncherOptions), POINTER(Error)]),
    "sgt_launcher_free": (None, [c_void_p]),
    "sgt_launch_field": (
        c_bool,
        [c_void_p, c_int, POINTER(LensField), POINTER(FieldBeam), POINTER(Error)],
    ),
    "sgt_launch_rays": (
        c_bool,
        [c_void_p, POINTER(FieldBeam), c_void_p, c_double, c_size_t, c_void_p, c_void_p, POINTER(Error)],
    ),
    "sgt_spectral_line": (c_double, [c_char_p]),
    # study.h
    "sgt_analysis_at": (POINTER(Analysis), [c_size_t]),
    "sgt_analysis_named": (POINTER(Analysis), [c_char_p]),
    "sgt_study_new": (c_void_p, [POINTER(Lens), POINTER(StudyOptions), POINTER(Error)]),
    "sgt_study_free": (None, [c_void_p]),
    "sgt_study_column": (c_bool, [c_void_p, POINTER(Analysis), c_void_p, c_size_t, c_char * 32, c_char * 32]),
    "sgt_study_fate_text": (c_char_p, [c_int]),
    "sagitta_ask": (
        c_bool,
        [c_void_p, POINTER(Analysis), c_void_p, POINTER(Answer), POINTER(Error)],
    ),
    "sagitta_study": (
        c_void_p,
        [POINTER(Lens), POINTER(StudyOptions), POINTER(Answer), POINTER(Error)],
    ),
    "sagitta_forget": (None, [POINTER(Answer)]),
    # analysis.h
    "sgt_sums_new": (c_void_p, [c_int, Pair, c_void_p]),
    "sgt_sums_free": (None, [c_void_p]),
    "sagitta_sums_add": (None, [c_void_p, POINTER(Summands)]),
    "sgt_sums_merge": (c_bool, [c_void_p, c_void_p]),
    "sgt_sums_spot": (Spot, [c_void_p, c_bool]),
    "sgt_sums_wavefront": (Wavefront, [c_void_p]),
    "sgt_sums_write": (c_size_t, [c_void_p, c_size_t, c_char_p]),
    "sgt_sums_read": (c_void_p, [c_char_p, c_size_t, c_char_p, c_void_p, POINTER(Error)]),
    # tolerance.h
    "sgt_lens_tolerances": (c_size_t, [POINTER(Lens), POINTER(POINTER(Tolerance))]),
    "sgt_tolerance_text": (None, [POINTER(Tolerance), c_char * 80]),
    "sgt_tolerance_unit": (c_char_p, [POINTER(Lens), POINTER(Tolerance)]),
    "sagitta_tolerancing": (
        c_void_p,
        [POINTER(Lens), POINTER(TolerancingOptions), POINTER(StudyOptions), POINTER(Answer), POINTER(Error)],
    ),
    "sgt_tolerancing_free": (None, [c_void_p]),
    "sgt_tolerancing_nominal": (c_double, [c_void_p]),
    "sgt_tolerancing_at": (c_bool, [c_void_p, c_void_p, POINTER(c_double), POINTER(Error)]),
    "sgt_tolerancing_lens": (POINTER(Lens), [c_void_p, c_void_p, POINTER(Error)]),
    "sgt_tolerancing_sensitivity": (
        c_bool,
        [c_void_p, POINTER(c_size_t), c_void_p, POINTER(SensitivitySum), POINTER(Error)],
    ),
    "sgt_tolerancing_worst": (
        c_bool,
        [c_void_p, POINTER(WorstOptions), POINTER(WorstCase), c_void_p, c_void_p, POINTER(Error)],
    ),
    "sgt_tolerancing_draw": (None, [c_void_p, c_uint64, c_uint64, c_void_p]),
    "sagitta_trials": (
        c_bool,
        [c_void_p, c_size_t, c_uint64, c_uint64, c_uint64, c_void_p, c_void_p, POINTER(Error)],
    ),
    "sgt_quantile": (Confidence, [c_size_t, c_void_p, c_double, c_double]),
    "sgt_share": (Confidence, [c_size_t, c_size_t, c_double]),
    # figure.h
    "sgt_figure_new": (
        c_void_p,
        [POINTER(Lens), POINTER(StudyOptions), POINTER(FigureOptions), c_size_t, POINTER(c_char_p), POINTER(Error)],
    ),
    "sgt_figure_free": (None, [c_void_p]),
    "sgt_figure_size": (FigureCount, [c_void_p]),
    "sgt_figure_start": (None, [c_void_p, Doubles]),
    "sgt_figure_eval": (c_bool, [c_void_p, Doubles, POINTER(FigureOut), POINTER(Error)]),
    "sgt_figure_lens": (POINTER(Lens), [c_void_p]),
    # formula.h
    "sgt_formula_room": (c_size_t, [c_char_p, c_size_t]),
    "sgt_formula_read": (
        c_void_p,
        [c_char_p, c_int, c_size_t, c_void_p, c_void_p, c_size_t, POINTER(Error)],
    ),
}

for _name, (_result, _arguments) in _PROTOTYPES.items():
    _function = getattr(library, _name)
    _function.restype, _function.argtypes = _result, _arguments


def packer(of: type[Structure]) -> Callable[..., bytes]:
    """What puts numbers and addresses into the bytes of a struct: in a tenth of the time of ctypes."""

    def letters(kind: Any) -> str:
        if issubclass(kind, Structure):
            return "".join(letters(member) for _, member in kind._fields_)
        if issubclass(kind, ctypes.Array):
            return letters(kind._type_) * int(kind._length_)
        return str(kind._type_)

    made = struct.Struct("@" + letters(of))
    assert made.size == ctypes.sizeof(of)
    return made.pack


def address_of(name: str) -> int:
    """Where a table or a function of the library is."""
    return ctypes.addressof((c_char * 1).in_dll(library, name))


def text(of: bytes | None) -> str:
    return of.decode("utf-8", "replace") if of else ""


def refuse(bad: int) -> None:
    """Raises what sagitta_run and its kin have returned."""
    if bad == -2:
        raise MemoryError("sagitta: no memory")
    raise ArithmeticFault(
        "sagitta: the arithmetic of this thread has been changed: "
        + text(library.sgt_arithmetic_text(bad))
        + ".  No bound of the library would hold.  A library compiled with -ffast-math, "
        "loaded into this process, is the usual cause"
    )


def check_arithmetic() -> None:
    bad = library.sgt_arithmetic()
    if bad:
        refuse(bad)
