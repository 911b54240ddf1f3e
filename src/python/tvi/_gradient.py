"""Gradients of runs: what is made of the results of tvi.solve, differentiated by its start and its parameters."""

from __future__ import annotations

from typing import Any, Callable, Iterable

import numpy as np

from ._arrays import integer, number, numbers, pointer
from ._functions import Function, scalar
from ._library import Guard, Handle, check, ffi, lib, make
from ._systems import System


def integrands_of(given: Any) -> list:
    """The functions of running integrals: one or several."""
    if not callable(given) and not isinstance(given, (list, tuple)):
        kind = type(given).__name__
        raise TypeError(f"integrals is a function of (q, p) or (q, p, t), or a list of them, not {kind}")
    return [given] if callable(given) else list(given)


def record_size(gradient: Any) -> int:
    """The bytes of a record by the argument gradient=: 0 stands for the library's own number."""
    return 0 if gradient is True or gradient is False else integer("gradient", gradient, 1, 2**62)


class Record:
    """What the runs of an integrator leave behind for their gradients; integrands: l(q, p) or l(q, p, t)."""

    def __init__(self, integrator: Any, size: int, integrands: "Callable | Iterable[Callable]"):
        made = make("tvi_record", lambda out: lib.tvi_record_create(out, integrator._handle.pointer, size))
        self.handle = Handle(made, lib.tvi_record_free).own(self)
        self._system = integrator.system  # outlives the record
        several = integrands_of(integrands)
        self.integral_count = len(several)
        for index, l in enumerate(several):
            guard = Guard()
            function = Function(f"integral {index}", l, "q p", self._system.parameters, takes_all=False)
            callback = scalar(function, guard, "tvi_event_fn *", self._system.n)
            status = lib.tvi_record_integral(made, callback, ffi.NULL)
            guard.reraise()
            check(status)

    def __del__(self) -> None:
        if handle := self.__dict__.get("handle"):
            handle.release(self)

    def counts(self) -> tuple[int, int]:
        """How many times and events were told."""
        told = ffi.new("int [2]")
        lib.tvi_record_counts(self.handle.pointer, told, told + 1)
        return told[0], told[1]


    def integrals(self) -> np.ndarray:
        values = np.empty(self.integral_count)
        if self.integral_count:
            lib.tvi_record_integrals(self.handle.pointer, pointer(values))
        return values


class Gradient:
    """The derivatives of a loss by what began a run: q0, p0, v0 [n] (v0 is None where the mass is not constant), t0,
    and each parameter of the system by its name, in the shape of its value."""

    def __init__(self, n: int, by_start: np.ndarray, v0: "np.ndarray | None", parameters: dict[str, Any]):
        self.q0, self.p0, self.t0, self.v0 = by_start[:n], by_start[n:2 * n], float(by_start[2 * n]), v0
        self.parameters = parameters
        for name, value in parameters.items():
            if name not in self.__dict__:
                setattr(self, name, value)

    def __repr__(self) -> str:
        named = "".join(f", {name}" for name in self.parameters)
        return f"<tvi gradient: by q0, p0, v0, t0{named}>"


def check_arguments(system: System, is_by_h: bool, v0: Any, callbacks: bool) -> None:
    """Refuses runs that have no gradient, before they are made."""
    if not is_by_h:
        raise TypeError("gradient=True and integrals take h, and not what is chosen anew: take run.h of a first run")
    if callbacks:
        raise TypeError("gradient=True does not go with callbacks that change p: make a run to each of the events, "
                        "with a gradient of its own")
    if v0 is not None and not system.has_constant_mass:
        raise TypeError("gradient=True with v0= is for constant masses: give p0=, as system.momentum makes it of v0")


def gradient_of(result: Any, given: dict[str, Any]) -> Gradient:
    """The gradient of a loss, whose derivatives by what the run told are given."""
    run, record = result.system, result._record
    if record is None:
        raise TypeError("the run has no gradient: give gradient=True to tvi.solve")
    n, times = run.n, record.counts()[0]
    if given["t_end"] is not None and result.status != 1:
        raise TypeError("t_end= is for a run that an event ended: the end of this one is at a time that was given")
    loss = ffi.new("tvi_loss *")
    end = np.concatenate([_row("q_end", given["q_end"], n), _row("p_end", given["p_end"], n),
                          [0.0 if given["t_end"] is None else number("t_end", given["t_end"])]])
    kept = [end]
    loss.end, loss.size = pointer(end), ffi.sizeof("tvi_loss")
    if given["q"] is not None or given["p"] is not None:
        if not result._is_at_times:
            raise TypeError("q= and p= are derivatives by the states at t_eval: give t_eval to tvi.solve")
        at = np.concatenate([_rows(name, given[name], times, n) for name in "qp"], axis=1).copy()
        kept.append(at)
        loss.at_times = pointer(at)
    if given["integrals"] is not None:
        by = numbers("integrals", given["integrals"], record.integral_count)
        kept.append(by)
        loss.integrals = pointer(by)
    if given["events"] is not None:
        at = _by_events(given["events"], len(result.events), result._event_order, n)
        kept.append(at)
        loss.at_events = pointer(at)
    by_start, values = np.empty(2 * n + 1), np.empty(max(1, lib.tvi_system_parameters(run._handle.pointer)))
    check(lib.tvi_gradient(record.handle.pointer, loss, pointer(by_start), pointer(values)))
    del kept
    v0 = run.masses * by_start[n:2 * n] if run.has_constant_mass else None
    return Gradient(n, by_start, v0, run.named(values))


def _row(name: str, value: Any, n: int) -> np.ndarray:
    return np.zeros(n) if value is None else numbers(name, value, n)


def _rows(name: str, value: Any, count: int, n: int) -> np.ndarray:
    return np.zeros((count, n)) if value is None else numbers(name, value, count, n)


def _by_events(given: Any, functions: int, order: list[int], n: int) -> np.ndarray:
    """The derivatives by all events in the order of the run, `order` of which function each was. given: for each
    function a dictionary with t [e], q and p [e, n], those that are not 0, or None; of one function it alone."""
    rows, several = np.zeros((len(order), 2 * n + 1)), [given] if isinstance(given, dict) else list(given)
    if len(several) != functions:
        raise ValueError(f"events has {len(several)} entries, and the run has {functions} functions")
    for index, one in enumerate(several):
        where = [i for i, which in enumerate(order) if which == index]
        for name, value in (one or {}).items():
            if name not in ("t", "q", "p"):
                raise TypeError(f"events[{index}] has derivatives by t, q and p, not by {name}")
            if name == "t":
                rows[where, 2 * n] = numbers(f"events[{index}]['t']", value, len(where))
            else:
                columns = slice(0, n) if name == "q" else slice(n, 2 * n)
                rows[where, columns] = numbers(f"events[{index}]['{name}']", value, len(where), n)
    return rows
