"""tvi.ensemble: a run of many orbits, and all that it gives; lyapunov and megno: order and chaos of one or many."""

from __future__ import annotations

import math
from typing import Any, Callable, Iterator

import numpy as np

from ._alike import Stats
from ._arguments import answered, starts_of_many
from ._arrays import Array, integer, spread
from ._ensemble import Ensemble
from ._events import Found, Recorded, events_of, found
from ._library import Interrupted, check
from ._methods import Compiled, Method, measured_step, method_to
from ._recorder import Progress
from ._runs import Course, Way, advice, new_plan
from ._shown import as_html, as_text
from ._solve import _times, span_of, step_of, steps_of
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


# ---- Order and chaos -------------------------------------------------------------------------------------------------


def _growth(orbits: Ensemble, h: float, t_end: float, every: int, w0: Array) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """The times of the members since the start, and ln of the growth of their tangent vectors in the steps between."""
    n, start = orbits.system.n, orbits.t.copy()
    rows = 2 * n + orbits.system._count
    unit = np.ones((rows, 1))  # of dq, and of the momenta dp of velocities of 1
    unit[n:2 * n, 0] = orbits.system.masses
    w = np.zeros((orbits.members, rows, 1))
    w[:, :2 * n, 0] = spread("w0", unit[:2 * n, 0] if w0 is None else w0, orbits.members, 2 * n)
    length = np.sqrt(((w / unit)**2).sum(axis=1, keepdims=True))
    if not (length > 0).all():
        raise ValueError("w0 is 0")
    orbits.tangent = w / length
    tangent = orbits._tangent.array
    way = Way(h, every, None, None, None)
    plan = new_plan(way, None, orbits._tangent)
    course = Course(way, plan, lambda: orbits._call(plan), orbits._going_times, True)
    while (going := (orbits._codes == 0) & ((t_end - orbits.t) / h > 1e-9)).any():
        steps = every
        if not orbits.system.is_rescaled:
            steps = min(every, max(1, math.ceil(float(np.max((t_end - orbits.t[going]) / h)) - 1e-9)))
        check(course.make_steps(steps))
        length = np.sqrt(((tangent / unit[..., None])**2).sum(axis=(0, 1)))
        tangent /= length
        yield orbits.t - start, np.where(orbits._codes == 0, np.log(length), 0.0)


def _chaos(system: System, t_span: Array, q0: Array, p0: Array, v0: Array, h: float, method: Any, order: int,
           every: int, w0: Array, threads: int, parameters: dict[str, Any], add: Callable) -> Any:
    """The value of each member after add(t, ln) was called for all steps; a number where q0 is one state."""
    t, t_end = span_of(system, t_span)
    h = step_of(system, t_end - t, h)
    if t == t_end:
        raise ValueError("t_span has no length")
    orbits = _orbits(system, q0, p0, v0, parameters, t=t, method=method, order=order, threads=threads)
    value = np.full(orbits.members, np.nan)
    try:
        for times, logarithms in _growth(orbits, h, t_end, integer("every", every, 1), w0):
            with np.errstate(all="ignore"):  # of members that fail in their first step
                value = add(times, logarithms)
    except KeyboardInterrupt:
        raise Interrupted(f"interrupted at t = {float(orbits.t.max())}", value) from None
    value = np.where(orbits.status == "OK", value, np.nan)
    is_one = np.ndim(q0) == 1 and orbits.members == 1
    return float(value[0]) if is_one else value


@answered
def lyapunov(system: System, t_span: Array, q0: Array, p0: Array = None, v0: Array = None, *, h: float,
             method: "str | Method" = "galerkin", order: int = 16, every: int = 1, w0: Array = None, threads: int = 0,
             **parameters: Any) -> Any:
    """The largest Lyapunov exponent over t_span, ln(d / d_0) / t of a tangent vector: falls like ln(t) / t on regular
    orbits.

    q0, and p0 or v0: [n] for a number, [member, n] for [member], 0 for rest; nan where a member failed. h: the step.
    The vector starts along w0 [2n], (dq, dp), and is brought back to length 1 after every so many steps; its length is
    that of (dq, dv), dv = dp / m. None: all of these are 1.

    >>> import tvi
    >>> spring = tvi.potential(1, lambda q: q[0]**2 / 2)
    >>> abs(tvi.lyapunov(spring, (0, 100), [1], p0=0, h=0.5)) < 0.01
    True
    """
    total = 0.0

    def add(t: np.ndarray, logarithms: np.ndarray) -> np.ndarray:
        nonlocal total
        total = total + logarithms
        return total / t

    return _chaos(system, t_span, q0, p0, v0, h, method, order, every, w0, threads, parameters, add)


@answered
def megno(system: System, t_span: Array, q0: Array, p0: Array = None, v0: Array = None, *, h: float,
          method: "str | Method" = "galerkin", order: int = 16, every: int = 1, w0: Array = None, threads: int = 0,
          **parameters: Any) -> Any:
    """MEGNO over t_span: tends to 2 on regular orbits, and grows like lambda t / 2 on chaotic ones (docs/chaos.md).
    All else as for lyapunov().

    >>> import numpy as np, tvi
    >>> pendulum = tvi.potential(1, lambda q: -np.cos(q[0]))
    >>> 1.5 < tvi.megno(pendulum, (0, 1000), [1], p0=0, h=0.5) < 2.2
    True
    """
    before, sums, mean = 0.0, 0.0, 0.0

    def add(t: np.ndarray, logarithms: np.ndarray) -> np.ndarray:
        nonlocal before, sums, mean
        sums = sums + t * logarithms
        mean = mean + (t - before) * 2 * sums / t
        before = t.copy()
        return mean / t

    return _chaos(system, t_span, q0, p0, v0, h, method, order, every, w0, threads, parameters, add)
