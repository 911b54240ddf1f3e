"""tvi.ensemble: a run of many orbits, and all that it gives."""

from __future__ import annotations

import math
from typing import Any, Callable

import numpy as np

from ._alike import Stats
from ._arguments import answered, starts_of_many
from ._arrays import Array, spread
from ._ensemble import Ensemble
from ._events import Found, Recorded, events_of, found
from ._library import Interrupted
from ._methods import Compiled, Method, measured_step, method_to
from ._recorder import Progress
from ._runs import Way, advice
from ._shown import as_html, as_text
from ._solve import _times, span_of, steps_of
from ._systems import System


class EnsembleResult:
    """What tvi.ensemble returns.

    t [k], q and p [member, k, n] at the times of t_eval; without it t is the end, and q and p are [member, n]. Where a
    member did not come to a time, its numbers there are nan. events: for each function its t, q, p and member, member
    after member. status [member]: "OK", "ESTOPPED" by a terminal event, or as tvi.Error.status. success: whether none
    failed. message, stats: as of tvi.Result. h: the step; error: the largest that was measured to choose
    it. orbits: the tvi.Ensemble at the end, which may go on from there; its t, q and p are the last good states."""

    def __init__(self, orbits: Ensemble, t: np.ndarray, h: float, error: float | None):
        self.orbits, self.t, self.h, self.error = orbits, t, h, error
        self.q = self.p = np.empty(0)
        self.events: list[Found] = []
        self.status, self.message = orbits.status, ""
        self.stats: Stats = orbits.stats

    @property
    def success(self) -> bool:
        return bool(np.isin(self.status, ("OK", "ESTOPPED")).all())

    def __repr__(self) -> str:
        return as_text(f"tvi ensemble result: {self.message}", self._rows())

    def _repr_html_(self) -> str:
        return as_html(f"tvi ensemble result: {self.message}", self._rows())

    def _rows(self) -> dict[str, Any]:
        names, counts = np.unique(self.status, return_counts=True)
        return {"system": self.orbits.system, "method": f"{self.orbits.method!r}, h = {self.h:.6g}",
                "members": ", ".join(f"{count} {name}" for name, count in zip(names, counts)),
                "q, p": f"of the shape {self.q.shape}",
                "error": None if self.error is None else f"{self.error:.1e} at the end, measured",
                "events": ", ".join(str(len(found.t)) for found in self.events) or None}


@answered
def ensemble(system: System, t_span: Array, q0: Array, p0: Array = None, v0: Array = None, h: float | None = None,
             error: float | None = None, tolerance: float | None = None, largest_step: float | None = None,
             method: "str | Method" = "galerkin", order: int = 16, t_eval: Array = None, events: Any = (),
             threads: int = 0, compiled: "bool | Compiled" = False, progress: "bool | Callable" = False,
             **parameters: Any) -> EnsembleResult:
    """Many orbits of one system from t_span[0] to t_span[1], on all cores.

    q0, and p0 or v0: [member, n], or [n] for all; 0: at rest. parameters: one value for all, or [member]. h, error,
    tolerance, largest_step: as for tvi.solve; of error the smallest step that tvi.suggest_step has for a member. A
    member has the same bits in every ensemble and for every number of threads; one that fails keeps its last good
    state, and the others go on. Raises as tvi.solve.

    >>> import numpy as np, tvi
    >>> kepler = tvi.potential(2, lambda q: -1 / np.sqrt(q @ q))
    >>> closest = tvi.event(lambda q, p: q @ p, direction=1)
    >>> orbits = tvi.ensemble(kepler, (0, 20), np.linspace([1, 0], [2, 0], 5), [0, 0.6], h=0.1, events=closest)
    >>> orbits.q.shape, np.bincount(orbits.events[0].member)
    ((5, 2), array([7, 4, 3, 2, 2]))
    """
    t, t_end = span_of(system, t_span)
    is_default = h is None and error is None and tolerance is None
    h, error, tolerance = steps_of(system, t_end - t, h, error, tolerance, largest_step)
    times, several = _times(t_eval, t, t_end), events_of(events)
    method = method_to(tolerance, system, method, order)
    if tolerance is not None and times is not None:
        raise ValueError("a run to a tolerance has no t_eval in an ensemble: give h or error")
    orbits = _orbits(system, q0, p0, v0, parameters, t=t, method=method, threads=threads, compiled=compiled)
    measured = None
    if tolerance is None:
        if h is None:
            h, measured = _smallest_step(orbits, parameters, t_end - t, error, method, several, is_default,
                                         largest_step)
            h = math.copysign(h, t_end - t)
    result = EnsembleResult(orbits, np.array([t_end]) if times is None else times, h or math.nan, measured)
    _run(orbits, result, times, t_end, tolerance, largest_step, several, Progress(progress, t, t_end))
    return result


def _orbits(system: System, q0: Array, p0: Array, v0: Array, parameters: dict[str, Any], **options: Any) -> Ensemble:
    """The ensemble of a start, whose arguments are called as those of the functions here."""
    others = [(value, 1 + np.ndim(system.parameters.get(name, 0))) for name, value in parameters.items()]
    members, q0, p0, v0 = starts_of_many("q0 p0 v0", system, None, q0, p0, v0, others)
    return Ensemble(system, q0, p0, v=v0, members=members, **options, **parameters)


def _smallest_step(orbits: Ensemble, parameters: dict[str, Any], duration: float, error: float, method: Method,
                   events: list, is_default: bool, largest_step: float | None) -> tuple[float, float]:
    """The smallest step of a member, and the largest error that was measured. For parameters that differ each member
    has a system of its own."""
    if duration == 0:
        return 1.0, 0.0
    shapes = {name: np.shape(value) for name, value in orbits.system.parameters.items()}
    each = {name: spread(name, value, orbits.members, *shapes[name]) for name, value in parameters.items()}
    steps = []
    for m in range(orbits.members):
        system = orbits.system.recorded_with({name: value[m] for name, value in each.items()})
        h, measured, refusal = measured_step(system, orbits.t[m], orbits.q[m], orbits.p[m], duration, error, method,
                                             Recorded(system, events), largest_step)
        if refusal and not is_default:
            raise refusal
        steps.append((abs(h), measured))
    return min(h for h, _ in steps), max(measured for _, measured in steps)


def _run(orbits: Ensemble, result: EnsembleResult, times: np.ndarray | None, t_end: float, tolerance: float | None,
         largest_step: float | None, events: list, progress: Progress) -> None:
    members, n = orbits.members, orbits.system.n
    told: list[tuple] = []
    functions: dict[str, Any] = {}
    if events:
        functions["on_event"] = lambda member, which, t, q, p: told.append((which, member, t, q, p))
    if times is not None:
        q, p = np.full((members, len(times), n), np.nan), np.full((members, len(times), n), np.nan)

        def at_time(member: int, which: int, t: float, q_there: np.ndarray, p_there: np.ndarray) -> None:
            q[member, which - 1], p[member, which - 1] = q_there, p_there

        functions["at_time"] = at_time
    way = Way(result.h if tolerance is None else None, None, t_end, times, tolerance,
              largest_step if tolerance is not None else None)
    try:
        orbits._go(way, events, functions, after=lambda steps: progress.at(float(np.mean(orbits.t))))
        failed = int(np.sum(~np.isin(orbits.status, ("OK", "ESTOPPED"))))
        result.message = f"{members} members, {failed} failed{_why(orbits, way)}."
    except Interrupted:
        result.message = f"interrupted at t from {orbits.t.min()} to {orbits.t.max()}"
        raise Interrupted(result.message, result) from None
    finally:
        progress.end(float(np.mean(orbits.t)))
        told.sort(key=lambda row: row[1])  # Members are told of in any order, the events of one in order of time.
        result.events = found(told, n, len(events))
        result.q, result.p = (orbits.q.copy(), orbits.p.copy()) if times is None else (q, p)
        result.status, result.stats = orbits.status, orbits.stats


def _why(orbits: Ensemble, way: Way) -> str:
    """What to do about members whose steps were too large."""
    is_too_large = np.isin(orbits.status, ("ENOCONV", "ETOOLARGE")).any()
    return advice(orbits.system, way) if is_too_large else ""
