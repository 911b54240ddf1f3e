"""tvi.lyapunov and tvi.megno: order and chaos of one orbit, by tvi_run_chaos, or of many."""

from __future__ import annotations

import math
from typing import Any, Callable, Iterator

import numpy as np

from ._arguments import answered
from ._arrays import Array, integer, spread
from ._ensemble import Ensemble
from ._events import Recorded
from ._integrator import Integrator
from ._library import Error, Interrupted, check, ffi
from ._many import _orbits, _smallest_step
from ._methods import Method, method_to
from ._runs import Course, Way, new_plan
from ._solve import span_of, steps_of
from ._systems import System

_FAILURES = ("EDOMAIN", "ENOCONV", "ESINGULAR", "ENONFINITE", "ETOOLARGE")  # of a step: the orbit has no value


def _vectors(orbits: Ensemble, w0: Array) -> tuple[np.ndarray, np.ndarray]:
    """The tangent vectors [member, rows, 1], and the units [rows, 1] of their length: those of (dq, dv). None: those of
    tvi_run_chaos."""
    n, rows = orbits.system.n, orbits.system.tangent_rows
    unit = np.ones((rows, 1))
    unit[n:2 * n, 0] = orbits.system.masses
    w = np.zeros((orbits.members, rows, 1))
    if w0 is None:
        component = 2 * (np.arange(1, n + 1) * 2 / (1 + math.sqrt(5)) % 1) - 1
        is_at_rest = ~orbits.p.any(axis=1)
        w[is_at_rest, :n, 0], w[~is_at_rest, n:2 * n, 0] = component, orbits.system.masses * component
    else:
        w[:, :2 * n, 0] = spread("w0", w0, orbits.members, 2 * n)
    if not w.any(axis=(1, 2)).all():
        raise ValueError("w0 is 0")
    return w, unit


def _growth(orbits: Ensemble, h: float, t_end: float, every: int, w0: Array) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """The times of the members since the start, and ln of the growth of their tangent vectors in the steps between. At
    the start, where a vector grows most, these are few: as many as were made before."""
    start, made = orbits.t.copy(), 0
    w, unit = _vectors(orbits, w0)
    orbits.tangent = w / np.sqrt(((w / unit)**2).sum(axis=1, keepdims=True))
    tangent = orbits._tangent.array
    way = Way(h, every, None, None, None)
    plan = new_plan(way, None, orbits._tangent)
    course = Course(way, plan, lambda: orbits._call(plan), orbits._going_times, True)
    while (going := (orbits._codes == 0) & ((t_end - orbits.t) / h > 1e-9)).any():
        steps = min(every, max(1, made))
        if not orbits.system.is_rescaled:
            steps = min(steps, max(1, math.ceil(float(np.max((t_end - orbits.t[going]) / h)) - 1e-9)))
        check(course.make_steps(steps))
        made += steps
        length = np.sqrt(((tangent / unit[..., None])**2).sum(axis=(0, 1)))
        tangent /= length
        yield orbits.t - start, np.where(orbits._codes == 0, np.log(length), 0.0)


def _of_one(orbits: Ensemble, method: Method, h: float, t_end: float, w0: Array, parameters: dict[str, Any],
            name: str) -> float:
    """That member of a tvi_chaos, of an ensemble of one."""
    system = orbits.system
    values = {key: spread(key, value, 1, *np.shape(system.parameters[key]))[0] for key, value in parameters.items()}
    it = Integrator(system, orbits.q[0], orbits.p[0], t=orbits.t[0], method=method, **values)
    it.tangent = _vectors(orbits, w0)[0][0]
    it._chaos = ffi.new("tvi_chaos *")
    it._chaos.size = ffi.sizeof("tvi_chaos")
    try:
        it._go(Way(h, None, t_end, None, None), Recorded(system, []), {})
    except Error as error:
        if error.status not in _FAILURES or system.constraints and it.stats.steps == 0:
            raise
        return math.nan
    except Interrupted:
        raise Interrupted(f"interrupted at t = {it.t}", getattr(it._chaos, name)) from None
    return getattr(it._chaos, name)


def _of_many(orbits: Ensemble, h: float, t_end: float, every: int, w0: Array, add: Callable) -> np.ndarray:
    """The value of each member after add(t, ln) was called for all steps."""
    value = np.full(orbits.members, np.nan)
    try:
        for times, logarithms in _growth(orbits, h, t_end, every, w0):
            with np.errstate(all="ignore"):  # of members that fail in their first step
                value = add(times, logarithms)
    except KeyboardInterrupt:
        raise Interrupted(f"interrupted at t = {float(orbits.t.max())}", value) from None
    return np.where(orbits.status == "OK", value, np.nan)


def _chaos(system: System, t_span: Array, q0: Array, p0: Array, v0: Array, h: float | None, error: float | None,
           method: Any, order: int, every: int, w0: Array, threads: int, parameters: dict[str, Any], add: Callable,
           name: str) -> Any:
    """A number where q0 is one state, and otherwise the value of each member."""
    t, t_end = span_of(system, t_span)
    is_default = h is None and error is None
    h, error, _ = steps_of(system, t_end - t, h, error, None, None)
    if t == t_end:
        raise ValueError("t_span has no length")
    method, every = method_to(None, system, method, order), integer("every", every, 1)
    orbits = _orbits(system, q0, p0, v0, parameters, t=t, method=method, threads=threads)
    if h is None:
        h = math.copysign(_smallest_step(orbits, parameters, t_end - t, error, method, [], is_default, None)[0],
                          t_end - t)
    if np.ndim(q0) == 1 and orbits.members == 1:
        return _of_one(orbits, method, h, t_end, w0, parameters, name)
    return _of_many(orbits, h, t_end, every, w0, add)


@answered
def lyapunov(system: System, t_span: Array, q0: Array, p0: Array = None, v0: Array = None, *, h: float | None = None,
             error: float | None = None, method: "str | Method" = "galerkin", order: int = 16, every: int = 1,
             w0: Array = None, threads: int = 0, **parameters: Any) -> Any:
    """The largest Lyapunov exponent over t_span, ln(d / d_0) / t of a tangent vector: falls like ln(t) / t on regular
    orbits.

    q0, and p0 or v0: [n] for a number, [member, n] for [member], 0 for rest; nan where an orbit failed. h, error: as
    for tvi.solve and tvi.ensemble. The length d of the vector is that of (dq, dv), dv = dp / m. It starts along w0
    [2n], (dq, dp); None: along that of tvi_run_chaos, dp = m times numbers that all differ. Of many orbits d is asked
    for, and brought back to 1, after every so many steps, more often at the start; of one orbit after each step.

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

    return _chaos(system, t_span, q0, p0, v0, h, error, method, order, every, w0, threads, parameters, add, "lyapunov")


@answered
def megno(system: System, t_span: Array, q0: Array, p0: Array = None, v0: Array = None, *, h: float | None = None,
          error: float | None = None, method: "str | Method" = "galerkin", order: int = 16, every: int = 1,
          w0: Array = None, threads: int = 0, **parameters: Any) -> Any:
    """MEGNO over t_span: tends to 2 on regular orbits, and grows like lambda t / 2 on chaotic ones (docs/chaos.md).
    All else as for lyapunov().

    >>> import numpy as np, tvi
    >>> pendulum = tvi.potential(1, lambda q: -np.cos(q[0]))
    >>> 1.5 < tvi.megno(pendulum, (0, 1000), [1], p0=0, h=0.5) < 2.2
    True
    """
    before, sums, y_before, mean = 0.0, 0.0, 0.0, 0.0

    def add(t: np.ndarray, logarithms: np.ndarray) -> np.ndarray:
        nonlocal before, sums, y_before, mean
        sums = sums + (before + t) / 2 * logarithms
        y = 2 * sums / t
        mean = mean + (t - before) * (y_before + y) / 2
        before, y_before = t.copy(), y
        return mean / t

    return _chaos(system, t_span, q0, p0, v0, h, error, method, order, every, w0, threads, parameters, add, "megno")
