"""What tvi.solve returns."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from ._alike import Stats
from ._arrays import Array
from ._events import Event, Found
from ._gradient import Gradient, Record, gradient_of
from ._integrator import Integrator
from ._jacobian import Derivatives
from ._library import Error
from ._shown import as_html, as_text
from ._solution import Solution
from ._systems import System


class Result:
    """What tvi.solve returns.

    t [k]: the times, all of t_eval, or those of the steps; q, p, v [k, n]; energy [k], None for a force. phi and
    multipliers [k, m], constraint_force [k, n]: of m constraints, else None. events: for each function its t [e], q and
    p [e, n]. status: 0 the end was reached, 1 a terminal event ended the run, -1 a step was refused, -2 Ctrl-C;
    success: whether it is 0 or 1; message: the same in words. stats: tvi.Stats. h: the step; error: what
    tvi.suggest_step measured, None where the step was given. sol: see tvi.solve. by: the derivatives by the names of
    jacobian=, as by.k [time, 2n, ...].
    t_end, q_end, p_end: the state at the end; integrator: the tvi.Integrator, which may go on from there."""

    def __init__(self, integrator: Integrator, way: dict[str, Any], h: float, error: float | None):
        self.integrator = integrator  # at the end of the run, which may go on from there
        self.system, self.method, self.parameters = integrator.system, integrator.method, integrator.parameters
        self.h, self.error = h, error
        self.t = self.q = self.p = np.empty(0)
        self.events: list[Found] = []
        self.t_end, self.q_end, self.p_end = integrator.t, integrator.q.copy(), integrator.p.copy()
        self.status, self.message = 0, ""
        self.sol: Solution | None = None
        self.by: Derivatives | None = None
        self.stats: Stats = integrator.stats
        self._record: Record | None = None
        self._event_order: list[int] = []
        self._is_at_times = False
        self._start, self._way = (integrator.t, integrator.q.copy(), integrator.p.copy()), way
        self._callbacks: list[Event] = []  # the events that have one

    @property
    def success(self) -> bool:
        return self.status >= 0

    @cached_property
    def energy(self) -> np.ndarray | None:
        return self._recorded.energy(self.t, self.q, self.p) if self.system.has_energy else None

    @cached_property
    def v(self) -> np.ndarray:
        return self._recorded.velocity(self.t, self.q, self.p)

    @cached_property
    def phi(self) -> np.ndarray | None:
        return self._recorded.constraint_values(self.t, self.q, self.p)[0] if self.system.constraints else None

    @property
    def integrals(self) -> np.ndarray:
        """The running integrals [count] of the run."""
        return np.empty(0) if self._record is None else self._record.integrals()

    @property
    def multipliers(self) -> np.ndarray | None:
        return self._multipliers[0]

    @property
    def constraint_force(self) -> np.ndarray | None:
        return self._multipliers[1]

    @cached_property
    def _multipliers(self) -> tuple:
        return self._recorded.multipliers(self.t, self.q, self.p) if self.system.constraints else (None, None)

    def orbits(self, about: "int | str" = 0, bodies: Any = None) -> Any:
        """The orbital elements of all bodies at all times, a gravity.Orbit of arrays [k, bodies - 1]: relative to the
        body number `about`, or with about="inner" each to the centre of mass of those before it
        (gravity.Bodies.orbits). bodies: a gravity.Bodies; that of the system, where it was made by Bodies.system().

        >>> from tvi import gravity
        >>> sun = gravity.Bodies([1, 1e-3, 1e-4], axes=2)
        >>> q0, v0 = [0, 0, 1, 0, 2, 0], [0, 0, 0, 1.0005, 0, 0.7]
        >>> run = tvi.solve(sun.system(), (0, 100), q0, v0=v0, h=0.5)
        >>> orbits = run.orbits()
        >>> print(orbits.a.shape, orbits.e.max(axis=0).round(3))
        (201, 2) [0.002 0.022]
        """
        from .gravity import Bodies, bodies_of  # which are made of systems

        bodies = bodies_of(self.system) if bodies is None else bodies
        if not isinstance(bodies, Bodies):
            raise TypeError("the system is not that of gravity.Bodies: give bodies=gravity.Bodies(...)")
        return bodies.orbits(self.q, self.p, about)

    @cached_property
    def _recorded(self) -> System:
        given = {name: value for name, value in self.parameters.items()
                 if not np.array_equal(value, self.system.parameters[name])}
        return self.system.recorded_with(given)

    def gradient(self, q: Array = None, p: Array = None, q_end: Array = None, p_end: Array = None,
                 t_end: float | None = None, events: Any = None, integrals: Array = None) -> Gradient:
        """The derivatives of a loss by q0, p0, v0, t0 and the parameters of a run that was made with gradient=True,
        from its derivatives by what the run told: q and p [k, n] at t_eval, q_end and p_end [n], t_end where an event
        ended the run, for each function of events a dictionary with t [e], q and p [e, n] (or None), and integrals.
        They are exact derivatives of the computed steps, to roundoff, and take the time of some 2 to 5 runs, whatever
        the number of parameters. Raises tvi.Error: ESINGULAR for an event that touches 0.

        >>> import numpy as np, tvi
        >>> spring = tvi.potential(1, lambda q, k: k * q[0]**2 / 2, k=4.0)
        >>> run = tvi.solve(spring, (0, 1), [1], p0=0, h=0.05, gradient=True)
        >>> g = run.gradient(q_end=[1])
        >>> bool(np.isclose(g.q0[0], np.cos(2))), bool(np.isclose(g.k, -np.sin(2) / 4))
        (True, True)
        """
        return gradient_of(self, {"q": q, "p": p, "q_end": q_end, "p_end": p_end, "t_end": t_end, "events": events,
                                  "integrals": integrals})

    def end_error(self) -> float:
        """How far the end is from that of the same run with half the step, or a tolerance 100 times smaller: the error
        of a coordinate relative to the largest coordinate, or of a momentum to the largest momentum. It costs twice
        the run. Raises tvi.Error where a step is refused.

        >>> import numpy as np, tvi
        >>> kepler = tvi.potential(2, lambda q: -1 / np.sqrt(q @ q))
        >>> 1e-12 < tvi.solve(kepler, (0, 100), [1, 0], [0, 0.8], h=0.5).end_error() < 1e-6
        True
        """
        t, q, p = self._start
        if self._callbacks:
            return self._end_error_with_callbacks()
        it = Integrator(self.system, q, p, t=t, method=self.method, **self.parameters)
        if "h" in self._way:
            it.integrate_to(self._way["h"] / 2, self.t_end)
        else:
            it.run(tolerance=max(self._way["tolerance"] / 100, 2.3e-16), t_end=self.t_end,
                   largest_step=self._way["largest_step"])
        return max(_relative(self.q_end - it.q, self.q, it.q), _relative(self.p_end - it.p, self.p, it.p))

    def _end_error_with_callbacks(self) -> float:
        from ._solve import solve  # which makes results

        t, q, p = self._start
        finer = {"h": self._way["h"] / 2} if "h" in self._way else \
            {**self._way, "tolerance": max(self._way["tolerance"] / 100, 2.3e-16)}
        again = solve(self.system, (t, self.t_end), q, p, method=self.method, events=self._callbacks, **finer,
                      **self.parameters)
        if not again.success:
            raise Error(again.message, "ESTOPPED")
        return max(_relative(self.q_end - again.q_end, self.q, again.q),
                   _relative(self.p_end - again.p_end, self.p, again.p))

    def __getstate__(self) -> dict[str, Any]:
        """A pickle has no record: it keeps what the run told, and no gradient()."""
        return {**self.__dict__, "_record": None}

    def __repr__(self) -> str:
        return as_text(f"tvi result: {self.message}", self._rows())

    def _repr_html_(self) -> str:
        return as_html(f"tvi result: {self.message}", self._rows())

    def _rows(self) -> dict[str, Any]:
        it = self.integrator
        way = ", ".join(f"{name} = {value:.6g}" for name, value in self._way.items() if value is not None)
        rows = {"system": self.system, "method": f"{self.method!r}, {way}",
                "steps": f"{self.stats.steps}, {self.stats.passes / max(self.stats.steps, 1):.1f} passes each, "
                         f"largest tail {self.stats.largest_tail:.1g}",
                "t, q, p": f"{len(self.t)} states of n = {self.system.n}, to t = {self.t_end:.6g}"}
        if self.system.has_energy and len(self.t) and not self._callbacks:
            rows["energy"] = f"{self.energy[0]:.12g}, within {np.ptp(self.energy):.1g}"
        if self.error is not None:
            rows["error"] = f"{self.error:.1e} at the end, measured"
        if self.events:
            rows["events"] = ", ".join(str(len(found.t)) for found in self.events)
        if it.system.parameters:
            rows["parameters"] = ", ".join(f"{name} = {value}" for name, value in self.parameters.items())
        return rows


def _relative(difference: np.ndarray, *sizes: np.ndarray) -> float:
    largest = max(float(np.max(np.abs(size), initial=0.0)) for size in sizes)
    return float(np.max(np.abs(difference))) / largest if largest > 0 else 0.0
