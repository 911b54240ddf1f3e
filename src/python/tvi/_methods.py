"""Methods by name and order, compiled systems, and the step that an error asks for."""

from __future__ import annotations

import os
from typing import Any

from ._arrays import Array, fraction, integer, number, numbers, pointer
from ._events import Recorded, events_of
from ._library import Error, Guard, Handle, apart, check, ffi, lib, make
from ._systems import System

# The names of what tvi_options has as numbers.
_WORDS = {
    "nodes": ("on-curve", "truncated"),
    "expansion": ("start", "midpoint", "end", "both-ends", "nodes"),
    "method": ("type-1", "type-2", "type-3", "poincare", "taylor", "stormer-verlet"),
    "quadrature": ("auto", "gauss", "lobatto", "trapezoid", "rectangle-start", "rectangle-end"),
}
DEFAULT_ORDER = 16  # where a function has the argument order, and none is given
_NUMBERS = ("degree", "quadrature_points", "passes", "max_passes", "tolerance", "max_tail", "compose_adjoint")


class Method:
    """A method of the library by its name and order, with the further options of tvi_options by keyword.

    Names: "galerkin", for any system; "taylor"; "stormer-verlet" (order 2); "start", "midpoint", "end", "both-ends",
    "right", "left", "poincare"; the paper's "tvi", "htvi-right", "htvi-left", "svhd", "symmetric-tvi". Options: degree,
    quadrature_points, passes, max_passes (whole numbers), tolerance, max_tail (numbers), compose_adjoint (bool),
    quadrature, nodes, expansion, method (words). Raises tvi.Error (EINVAL) for a name or an order that there is not.

    >>> import tvi
    >>> tvi.Method("galerkin", 8, max_tail=0.1)
    Method('galerkin', 8, max_tail=0.1)
    """

    def __init__(self, name: "str | Method" = "galerkin", order: int = 16, **options: Any):
        if not isinstance(name, str):
            raise TypeError(f"the name of a method is text, not {type(name).__name__}")
        self.name, self.order, self.options = name, integer("order", order, -2**31), options
        self._options = ffi.new("tvi_options *")
        check(lib.tvi_options_named(name.encode(), self.order, self._options))
        for option, value in options.items():
            setattr(self._options, option, _option(option, value))

    def __repr__(self) -> str:
        return f"Method({self.name!r}, {self.order}{''.join(f', {k}={v!r}' for k, v in self.options.items())})"

    def __reduce__(self) -> tuple:
        return _method_again, (self.name, self.order, self.options)

    def check(self, system: System) -> None:
        """Raises tvi.Error (EINVAL, EUNSUPPORTED) where this makes no method for the system.

        >>> import tvi
        >>> tvi.Method("midpoint", 8).check(tvi.potential(1, lambda q: q[0]**2))
        """
        check(lib.tvi_options_check(system._handle.pointer, self._options, ffi.NULL))


def _option(name: str, value: Any) -> Any:
    if words := _WORDS.get(name):
        if value not in words:
            raise ValueError(f"{name} is one of {', '.join(words)}, not {value!r}")
        return words.index(value)
    if name not in _NUMBERS:
        raise TypeError(f"a method has no option {name}: {', '.join([*_WORDS, *_NUMBERS])}")
    if name == "compose_adjoint":
        return bool(value)
    return number(name, value) if name in ("tolerance", "max_tail") else integer(name, value, -1)


def resolved(options: Any) -> dict[str, Any]:
    """The members of tvi_options by name, as Method takes them."""
    words = {name: known[getattr(options, name)] for name, known in _WORDS.items()}
    return {**words, "order": options.order, **{name: getattr(options, name) for name in _NUMBERS}}


def _method_again(name: str, order: int, options: dict[str, Any]) -> Method:
    return Method(name, order, **options)


def method_of(method: "str | Method", order: int) -> Method:
    if not isinstance(method, Method):
        return Method(method, order)
    if order not in (DEFAULT_ORDER, method.order):
        raise TypeError(f"order = {order} beside {method!r}, which has its own")
    return method


def method_to(tolerance: float | None, system: System, method: "str | Method", order: int) -> Method:
    """The method of a run, which to a tolerance is "taylor", of the order that suits it where none is named."""
    if tolerance is None:
        return method_of(method, order)
    if system.is_rescaled:
        raise ValueError("a tolerance is for systems that are not rescaled: give h or error")
    if (method, order) == ("galerkin", DEFAULT_ORDER):
        return Method("taylor", max(2, taylor_order(tolerance)))
    found = method_of(method, order)
    if found.name != "taylor":
        raise ValueError(f"a tolerance is for method=\"taylor\", not for {found!r}: give h or error")
    return found


def taylor_order(tolerance: float) -> int:
    """The order of "taylor" that suits a tolerance: 8 for 1e-6, 19 for 1e-15.

    >>> taylor_order(1e-10)
    13
    """
    return lib.tvi_taylor_order(fraction("tolerance", tolerance))


def suggest_step(system: System, t: float, q: Array, p: Array, duration: float, error: float,
                 method: "str | Method" = "galerkin", order: int = 16, events: Any = (),
                 largest_step: float | None = None) -> tuple[float, float]:
    """The step of a run of that duration whose error at its end is at most the wanted one, and that error, measured.

    The error is the largest one of a coordinate (a momentum) relative to the largest coordinate (momentum) of the
    orbit. It is measured by whole runs, which cost 3 to 6 of the final one. q, p: [n]. events: the terminal ones end
    the runs. largest_step: no step is larger. The step is in the unit of t, of a rescaled system in s, and has the sign
    of the duration. Raises tvi.Error: EROUNDOFF where roundoff makes more of the run, others as a step does.

    >>> import numpy as np, tvi
    >>> kepler = tvi.potential(2, lambda q: -1 / np.sqrt(q @ q))
    >>> h, measured = tvi.suggest_step(kepler, 0, [1, 0], [0, 0.8], 100, 1e-9)
    >>> 0.1 < h < 0.4, measured < 1e-9
    (True, True)
    """
    h, measured, refusal = measured_step(system, t, q, p, duration, error, method_of(method, order),
                                         Recorded(system, events_of(events)), largest_step)
    if refusal:
        raise refusal
    return h, measured


def measured_step(system: System, t: float, q: Array, p: Array, duration: float, error: float, method: Method,
                  events: Recorded, largest_step: float | None) -> tuple[float, float, Error | None]:
    """What tvi_measure_step finds: h, the measured error, and what it says where that is above the wanted one for
    roundoff alone."""
    q, p = numbers("q", q, system.n), numbers("p", p, system.n)
    t, duration, error = number("t", t), number("duration", duration), fraction("error", error)
    h, measured = ffi.new("double *"), ffi.new("double *")
    guard = Guard()
    plan = ffi.new("tvi_run_plan *")
    plan.size, plan.t_end = ffi.sizeof("tvi_run_plan"), t + duration
    plan.largest_step = 0.0 if largest_step is None else number("largest_step", largest_step)
    if events.count:
        plan.events, plan.event_count = events.pointer, events.count
    heard = guard.callback("tvi_member_observer *", lambda *_: 1 if guard.thrown is not None else 0, 1)
    plan.at_step = heard

    def call() -> Error | None:  # The text of a refusal belongs to the thread.
        try:
            check(lib.tvi_measure_step(system._handle.pointer, method._options, plan, t, pointer(q), pointer(p), error,
                                       h, measured))
        except Error as refusal:
            if refusal.status != "EROUNDOFF" and guard.thrown is None:
                raise
            return refusal
        return None

    refusal = apart(call, guard)
    return h[0], measured[0], refusal


# ---- Compiled systems ------------------------------------------------------------------------------------------------


class Compiled:
    """A system as machine code, for the steps of one method: what tvi.compile makes, for `compiled=` of integrators,
    ensembles and tvi.solve."""

    def __init__(self, pointer: Any):
        self._handle = Handle(pointer, lib.tvi_compiled_free).own(self)

    def __del__(self) -> None:
        if handle := self.__dict__.get("_handle"):
            handle.release(self)

    def __repr__(self) -> str:
        return "<tvi compiled system>"


def compile(system: System, method: "str | Method" = "galerkin", order: int = 16, *, compiler: str | None = None,
            flags: str | None = None, cache: str | os.PathLike | None = None) -> Compiled:
    """The system as machine code for steps of the method: some seconds, or milliseconds where the cache has it.

    compiler: a command, None: that of CC, or cc. flags: for it, None: the library's own. cache: a folder, None: tvi
    below ~/.cache, "": nothing is kept. Raises tvi.Error (ECOMPILE) with the first error of the compiler. Ctrl-C is
    heard at once.

    >>> import tvi
    >>> spring = tvi.potential(1, lambda q: q[0]**2 / 2)
    >>> code = tvi.compile(spring)
    >>> tvi.Integrator(spring, [1], [0], compiled=code).stats.is_compiled
    True
    """
    options = method_of(method, order)._options
    texts = [ffi.NULL if x is None else ffi.new("char[]", os.fsencode(x)) for x in (compiler, flags, cache)]
    how = ffi.new("tvi_compiler *", texts)

    def call() -> Compiled:
        kept = texts, how  # The call goes on after Ctrl-C, and reads them.
        pointer = make("tvi_compiled", lambda out: lib.tvi_compile(out, system._handle.pointer, options, kept[1]))
        return Compiled(pointer)

    return apart(call)


def write_compiled(system: System, name: str, path: str | os.PathLike, method: "str | Method" = "galerkin",
                   order: int = 16) -> None:
    """Writes the C of tvi.compile as a file for programs in C: it defines `const tvi_compiled *name(void)`.
    Raises tvi.Error: EINVAL for a name that is none of C, ECOMPILE where the file cannot be written.

    >>> import os, tempfile, tvi
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     tvi.write_compiled(tvi.potential(1, lambda q: q[0]**2), "spring", folder + "/spring.c")
    ...     os.listdir(folder)
    ['spring.c']
    """
    check(lib.tvi_compiled_write(system._handle.pointer, method_of(method, order)._options, name.encode(),
                                 os.fsencode(path)))


def code_for(compiled: "bool | Compiled", system: System, method: Method) -> Compiled | None:
    """What compiled= asks for."""
    if isinstance(compiled, Compiled):
        return compiled
    if not isinstance(compiled, bool):
        raise TypeError(f"compiled is True, False or what tvi.compile made, not {compiled!r}")
    return compile(system, method) if compiled else None
