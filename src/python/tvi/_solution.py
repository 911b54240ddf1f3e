"""The states of a run between its steps."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._arrays import numbers
from ._integrator import Integrator
from ._shown import as_html


class Solution:
    """The run between its steps: sol(t) is q and p at t, [n] each, or [k, n] for times [k]. Each is a step of the
    method from the last kept state before t, as accurate as the run. Raises ValueError outside of the run."""

    def __init__(self, integrator: Integrator, way: dict[str, Any], states: tuple, t_end: float):
        self._arguments = integrator.system, integrator.method, integrator.parameters
        self._way, self._t_end = way, t_end
        self._t, self._q, self._p = states

    def __repr__(self) -> str:
        return f"<tvi solution: sol(t) is q and p at t from {self._t[0]} to {self._t_end}>"

    def _repr_html_(self) -> str:
        system, method, _ = self._arguments
        return as_html("tvi solution: sol(t) is q and p at t", {
            "t": f"from {self._t[0]} to {self._t_end}", "system": system, "method": repr(method),
            "kept": f"{len(self._t)} states, between which it makes steps"})

    def __call__(self, t: Any) -> tuple[np.ndarray, np.ndarray]:
        times = np.atleast_1d(numbers("t", t, *[None] * np.ndim(t)))
        sign = 1.0 if self._t[-1] >= self._t[0] else -1.0
        if np.any(sign * times < sign * self._t[0]) or np.any(sign * times > sign * self._t_end):
            raise ValueError(f"t is not between {self._t[0]} and {self._t_end}, the ends of the run")
        n = self._q.shape[1]
        q, p = np.empty((len(times), n)), np.empty((len(times), n))
        before = np.searchsorted(sign * self._t, sign * times, side="right") - 1
        system, method, parameters = self._arguments
        integrator = Integrator(system, self._q[0], self._p[0], method=method, **parameters)
        for row in np.unique(before):
            here = np.flatnonzero(before == row)
            here = here[np.argsort(sign * times[here], kind="stable")]
            integrator.t, integrator.q, integrator.p = self._t[row], self._q[row], self._p[row]
            q[here], p[here] = states_at(integrator, self._way, times[here])
        return (q, p) if np.ndim(t) else (q[0], p[0])


def states_at(integrator: Integrator, way: dict[str, Any], times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The states at the times, in order, and not before that of the integrator."""
    if "h" in way:
        return integrator.integrate_at(way["h"], times)
    dense = Dense(integrator, times)
    dense.start()
    if len(times) and times[-1] != integrator.t:
        integrator.run(**way, t_end=times[-1], at_step=dense.at_step)
    return dense.arrays()


class Dense:
    """The states of a run to a tolerance at given times, on the curves of its steps, whose series they are."""

    def __init__(self, integrator: Integrator, times: np.ndarray):
        self._integrator, self._times = integrator, times
        self._t, self._state = integrator.t, (integrator.q.copy(), integrator.p.copy())
        self.rows: list[tuple] = []

    def start(self) -> None:
        """Those at the start itself."""
        while len(self.rows) < len(self._times) and self._times[len(self.rows)] == self._t:
            self.rows.append((self._t, self._integrator.q.copy(), self._integrator.p.copy()))

    def at_step(self, step: int, t: float, *state: Any) -> None:
        while len(self.rows) < len(self._times):
            wanted = self._times[len(self.rows)]
            theta = (wanted - self._t) / (t - self._t)
            if theta > 1:
                break
            self.rows.append((wanted, *self._integrator.dense(theta)))
        self._t, self._state = t, state

    def at_event(self, way: dict[str, Any]) -> None:
        """Those between the last step and the event that stopped the run, which is no step and has no curve."""
        it, left = self._integrator, self._times[len(self.rows):]
        sign = 1.0 if it.t >= self._t else -1.0
        here = left[sign * left <= sign * it.t]
        if len(here):
            other = Integrator(it.system, *self._state, t=self._t, method=it.method, **it.parameters)
            self.rows += zip(here, *states_at(other, way, here))

    def go_on(self) -> None:
        """The run goes on from the state of its integrator, which is not that of a step."""
        self._t, self._state = self._integrator.t, (self._integrator.q.copy(), self._integrator.p.copy())

    def arrays(self) -> tuple[np.ndarray, np.ndarray]:
        n = self._integrator.system.n
        return tuple(np.array([row[i] for row in self.rows]).reshape(-1, n) for i in (1, 2))
