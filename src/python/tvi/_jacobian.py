"""The derivatives of a run by its start and by parameters: the tangent vectors that tvi.solve moves with it."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._integrator import Integrator
from ._library import Error

_START = ("q0", "p0", "v0")


class Derivatives:
    """What Result.by is: for each name that was asked for, the derivatives [time, 2n, ...] of q and p by it, with the
    shape of its value behind."""

    def __init__(self, by_name: dict[str, np.ndarray]):
        self.__dict__.update(by_name)

    def __repr__(self) -> str:
        return "<tvi derivatives by " + ", ".join(f"{name} {x.shape}" for name, x in self.__dict__.items()) + ">"


class Columns:
    """The tangent vectors of one run, a column for each number that it is differentiated by."""

    def __init__(self, integrator: Integrator, names: Any, by_velocities: bool):
        self._it, self._told = integrator, []
        self._parts: list[tuple[str, tuple, int]] = []
        system, n = integrator.system, integrator.system.n
        first, rows = 2 * n, {}
        for name, value in system.parameters.items():
            rows[name], first = (np.shape(value), first), first + np.size(value)
        columns: list[np.ndarray] = []
        for name in _checked(names, system, by_velocities):
            shape, row = rows[name] if name in rows else ((n,), 0 if name == "q0" else n)
            part = np.zeros((system.tangent_rows, int(np.prod(shape))))
            part[row:row + part.shape[1]] = np.diag(system.masses) if name == "v0" else np.eye(part.shape[1])
            self._parts.append((name, shape, part.shape[1]))
            columns.append(part)
        integrator.tangent = np.concatenate(columns, axis=1)
        integrator._at_once = True

    def keep(self) -> None:
        """Those at the time that is told."""
        self._told.append(self._it.tangent[:2 * self._it.system.n].copy())

    def alone(self, error: Error) -> bool:
        """Whether the run is made again, with each column by itself, as its system or its method is not served by
        others: it has not begun."""
        refused = self._it._at_once and error.status == "EUNSUPPORTED" and "columns_at_once" in str(error)
        self._it._at_once = self._it._at_once and not refused
        return refused

    def end(self) -> Derivatives:
        it, rows = self._it, 2 * self._it.system.n
        told = np.array(self._told).reshape(len(self._told), rows, -1)
        it.tangent, it._at_once = None, False
        found, first = {}, 0
        for name, shape, count in self._parts:
            found[name] = told[:, :, first:first + count].reshape(len(told), rows, *shape)
            first += count
        return Derivatives(found)


def require_steps(names: Any, h: Any, t_eval: Any) -> None:
    """Refuses a jacobian without h or times."""
    if names is not None and h is None:
        raise TypeError("jacobian is that of the steps that are made, and needs h: take run.h of a first run")
    if names is not None and t_eval is None:
        raise TypeError("jacobian is that of the states at t_eval: give the times")


def _checked(names: Any, system: Any, by_velocities: bool) -> list[str]:
    names = [names] if isinstance(names, str) else list(names)
    if not names:
        raise TypeError("jacobian has no names: it is a list of parameters, q0, and p0 or v0")
    if len(set(names)) < len(names):
        raise TypeError("jacobian has a name twice")
    for name in names:
        if name not in system.parameters and name not in _START:
            known = ", ".join([*system.parameters, "q0", "v0" if by_velocities else "p0"])
            raise TypeError(f"jacobian: {name!r} is none of {known}")
    for name, other in (("p0", "v0"), ("v0", "p0")):
        if name in names and by_velocities == (name == "p0"):
            raise TypeError(f"jacobian: the start is {other}, and so the run has no derivative by {name}")
    if by_velocities and not system.has_constant_mass:
        raise TypeError("jacobian: the momenta of a Lagrangian and a Hamiltonian depend on q0, v0 and parameters in "
                        "their own way: give p0, as system.momentum(t, q0, v0)")
    return names
