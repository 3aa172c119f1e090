# SPDX-License-Identifier: MIT
"""One call of the library, in one thread or several, and what is raised afterwards."""
from __future__ import annotations

import ctypes
import functools
import inspect
import math
import threading
from typing import Any, Callable, Generic, Literal, Optional, Sequence, TypedDict, TypeVar, Union

from . import _library as C
from ._arrays import Columns, RayArrays

Pick = Literal["default", "first", "near-seed"]
Proof = Literal["estimate", "root", "first"]
PICKS: dict[Optional[str], int] = {None: 0, "default": 0, "first": 1, "near-seed": 2}
PROOFS: dict[Optional[str], int] = {None: 0, "estimate": 0, "root": 1, "first": 2}

# A block is 64 rays.  So many of them are under way at once if Python is asked for F.  More of them are more
# points a call, and more than the processor's caches hold: of a gyroid by numpy 64, 128 and 256 blocks cost 50,
# 42 and 51 ns an evaluation, of which numpy takes 15.
BLOCKS = 128


def of_words(value: Optional[str], words: dict[Optional[str], int], name: str) -> int:
    try:
        return words[value]
    except (KeyError, TypeError):
        known = ", ".join(repr(w) for w in words if w is not None)
        raise ValueError(f"{name}: must be one of {known}, not {value!r}") from None


class Proofs(TypedDict, total=False):
    """The options of the solver (sgt_options of sagitta.h), of a call that takes no root rather than another.

    proof       "estimate", "root" (exactly one root within t_err) or "first" (and none before it)
    t_tol, f_tol, dt_min, max_evals     as in sgt_options
    """

    proof: Optional[Proof]
    t_tol: float
    f_tol: float
    dt_min: float
    max_evals: int


class Options(Proofs, total=False):
    """All of them.

    pick        "first", or "near-seed": the root that the surface's own guess leads to
    """

    pick: Optional[Pick]


DEFAULTS: dict[str, Any] = {
    "pick": None, "proof": None, "t_tol": 0.0, "f_tol": 0.0, "dt_min": 0.0, "max_evals": 0
}
F = TypeVar("F", bound=Callable[..., Any])


def takes(options: Any) -> Callable[[F], F]:
    """The signature of such a call with all options by their names, for help() and for editors."""

    def shown(f: F) -> F:
        own = inspect.signature(f)
        parameters = [x for x in own.parameters.values() if x.kind is not inspect.Parameter.VAR_KEYWORD]
        for name, hint in options.__annotations__.items():
            hint = getattr(hint, "__forward_arg__", hint)
            kind = inspect.Parameter.KEYWORD_ONLY
            parameters.append(inspect.Parameter(name, kind, default=DEFAULTS[name], annotation=hint))
        f.__signature__ = own.replace(parameters=parameters)  # type: ignore[attr-defined]
        return f

    return shown


@functools.lru_cache(maxsize=256)
def _options(
    pick: Optional[str], proof: Optional[str], t_tol: float, f_tol: float, dt_min: float, max_evals: int
) -> Optional[C.Options]:
    for name, x in (("t_tol", t_tol), ("f_tol", f_tol), ("dt_min", dt_min)):
        if not isinstance(x, (int, float)) or isinstance(x, bool):
            raise TypeError(f"{name}: must be a number, not {type(x).__name__}")
        if not (x >= 0 and math.isfinite(x)):
            raise ValueError(f"{name}: must be a finite number that is not negative, not {x}")
    if not isinstance(max_evals, int):
        raise TypeError(f"max_evals: must be a whole number, not {type(max_evals).__name__}")
    if not 0 <= max_evals < 2**31:
        raise ValueError(f"max_evals: must be from 0 to 2147483647, not {max_evals}")
    return C.Options(
        t_tol=t_tol,
        f_tol=f_tol,
        dt_min=dt_min,
        max_evals=max_evals,
        pick=of_words(pick, PICKS, "pick"),
        proof=of_words(proof, PROOFS, "proof"),
    )


def options(given: Any, of: Any = Options) -> Optional[C.Options]:
    """The options of a call, by their names; None: all are the defaults."""
    for name in given:
        if name not in of.__annotations__:
            raise TypeError(f"there is no option {name!r}; there are {', '.join(of.__annotations__)}")
    chosen = {**DEFAULTS, **given}
    if chosen == DEFAULTS:
        return None
    try:
        return _options(**chosen)
    except TypeError as error:
        if "unhashable" in str(error):
            raise TypeError("an option is neither a number nor a word") from None
        raise


Raised = list[BaseException]


def _run_part(call: C.Call, functions: Sequence[Any], raised: Raised, said: list[int]) -> None:
    bad = C.library.sagitta_run(ctypes.byref(call))
    said.append(bad)
    if bad == -1:
        thread = threading.get_ident()
        raised += [error for f in functions for error in [f._raised.pop(thread, None)] if error]


def check_threads(threads: int) -> None:
    if not isinstance(threads, int) or isinstance(threads, bool):
        raise TypeError(f"threads: must be a whole number, not {type(threads).__name__}")
    if not 1 <= threads <= 1024:
        raise ValueError(f"threads: must be from 1 to 1024, not {threads}")


def run(call: C.Call, n: int, threads: int, functions: Sequence[Any], void: Any = None) -> Union[int, Any]:
    """Does all n rays; returns the number that were met.  `void` is called if Python has raised."""
    check_threads(threads)
    call.begin, call.end = 0, n
    call.python, call.blocks = bool(functions), BLOCKS
    raised: Raised = []
    said: list[int] = []
    parts = min(threads, (n + 63) // 64)
    if parts <= 1:
        _run_part(call, functions, raised, said)
        met = call.met
    else:
        size = -(-n // (64 * parts)) * 64
        calls = []
        for begin in range(0, n, size):
            part = C.Call.from_buffer_copy(call)
            part.begin, part.end = begin, min(n, begin + size)
            calls.append(part)
        others = [
            threading.Thread(target=_run_part, args=(part, functions, raised, said)) for part in calls[1:]
        ]
        for thread in others:
            thread.start()
        try:
            _run_part(calls[0], functions, raised, said)
        finally:
            for thread in others:
                thread.join()
        met = sum(part.met for part in calls)
        for part in calls:
            call.lacks |= part.lacks
    bad = next((b for b in said if b), 0)
    if bad:
        if void is not None:
            void()
        if raised:
            raise raised[0]
        C.refuse(bad)
    return met


_run = C.library.sagitta_run
Out = TypeVar("Out", bound="Columns[Any]")


class Prepared(Generic[Out]):
    """A call that is ready to be made, again and again: see Surface.prepare and Lens.prepare.

    It has one set of arrays.  So it is refused in a second thread while it is under way in a first one: that
    would write over what the first has not read yet.  Prepare one for each thread; or let it use several
    (threads=).
    """

    __slots__ = ("out", "rays", "_call", "_ref", "_functions", "_threads", "_void", "_lock")

    def __init__(
        self,
        call: C.Call,
        rays: RayArrays,
        out: Out,
        functions: Sequence[Any],
        threads: int,
        void: Callable[[], None],
    ) -> None:
        check_threads(threads)
        self.out, self.rays, self._functions, self._threads, self._void = out, rays, functions, threads, void
        self._call, self._ref, self._lock = call, ctypes.byref(call), threading.Lock()
        call.begin, call.end, call.python, call.blocks = 0, rays.n, bool(functions), BLOCKS

    def __call__(self) -> int:
        if not self._lock.acquire(False):
            raise RuntimeError(
                "this prepared call is under way in another thread, or in a function of Python that it has "
                "called.  It has one set of arrays: prepare one call for each thread"
            )
        try:
            if self._threads > 1:
                return int(run(self._call, self.rays.n, self._threads, self._functions, self._void))
            bad = _run(self._ref)
            if bad:
                self._void()
                raise_bad(bad, self._functions)
            met: int = self._call.met
            return met
        finally:
            self._lock.release()


def raise_bad(bad: int, functions: Sequence[Any]) -> None:
    """Raises what sagitta_run has returned."""
    if bad == -1:
        raise raised_here(functions)
    C.refuse(bad)


def raised_here(functions: Sequence[Any]) -> BaseException:
    """What a function has raised in this thread."""
    thread = threading.get_ident()
    for f in functions:
        error = f._raised.pop(thread, None)
        if error is not None:
            return error  # type: ignore[no-any-return]
    return RuntimeError("sagitta: a function has failed and has not said why")
