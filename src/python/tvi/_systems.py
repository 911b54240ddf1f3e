"""Systems: a potential, a force, a Lagrangian or a Hamiltonian, recorded once."""

from __future__ import annotations

from types import MappingProxyType
from typing import Any, Callable, Mapping

import numpy as np

from ._arrays import Array, Doubles, integer, numbers, pointer, spread
from ._functions import Function, checked_parameters, scalar, vector
from ._jets import Miscounted
from ._library import Guard, Handle, check, ffi, lib, make
from ._shown import as_html

MAX_DIMENSION = 10000
_NO_ENERGY = {"tangent": "none, as it moves a tangent vector"}


class System:
    """A mechanical system of n degrees of freedom, made by tvi.potential, force, lagrangian or hamiltonian.

    It is read-only once made, and may be shared between threads. It pickles where its function does (a function of a
    module, no lambda). `n` is its dimension, `parameters` has the recorded values of its parameters by name."""

    def __init__(self, kind: str, n: int, arguments: tuple, parameters: dict[str, Any], pointer: Any):
        self._stated = kind, n, MappingProxyType(parameters)
        self._arguments = arguments
        self._handle = Handle(pointer, lib.tvi_system_free).own(self)
        self._count = lib.tvi_system_parameters(pointer)

    def __del__(self) -> None:
        if handle := self.__dict__.get("_handle"):
            handle.release(self)

    def __reduce__(self) -> tuple:
        return _again, (self.kind, self._arguments, dict(self.parameters))

    def __repr__(self) -> str:
        constraints = f", {self.constraints} constraint{'s' * (self.constraints > 1)}" if self.constraints else ""
        named = "".join(f", {name}={value}" for name, value in self.parameters.items())
        return f"<tvi system: {self.kind.replace('_', ', ')}, n = {self.n}{constraints}{named}>"

    def _repr_html_(self) -> str:
        masses = np.unique(self.masses)
        rows = {"n": self.n, "mass": masses[0] if len(masses) == 1 else f"from {masses[0]:.6g} to {masses[-1]:.6g}",
                "function": getattr(self._arguments[1], "__qualname__", self._arguments[1]),
                "energy": None if self.has_energy else _NO_ENERGY.get(self.kind, "none, as it is made from a force"),
                "constraints": self.constraints or None, "made of": None, **self.parameters}
        if self.kind not in _CALLS:
            rows["made of"] = self._arguments[0]
        return as_html(f"tvi system: {self.kind.replace('_', ', ')}", rows)

    @property
    def kind(self) -> str:
        return self._stated[0]

    @property
    def n(self) -> int:
        return self._stated[1]

    @property
    def parameters(self) -> Mapping[str, Any]:
        return self._stated[2]

    @property
    def constraints(self) -> int:
        """How many constraints it has, m; 0: none."""
        return lib.tvi_system_constraints(self._handle.pointer)

    @property
    def is_rescaled(self) -> bool:
        """Whether its steps are in s, dt = g ds."""
        return self.kind in ("rescaled", "rescaled_reversible")

    @property
    def can_be_rescaled(self) -> bool:
        """Whether rescaled() may make steps of it that adapt."""
        return self.kind in ("potential", "hamiltonian")

    @property
    def masses(self) -> np.ndarray:
        """The masses [n] of the coordinates; 1 for a Lagrangian and a Hamiltonian, which state none."""
        if self.kind not in _CALLS:
            return np.tile(self._arguments[0].masses, self.n // self._arguments[0].n)
        mass = self._arguments[2] if self.kind in ("potential", "force") else None
        return spread("mass", 1.0 if mass is None else mass, self.n).copy()

    @property
    def has_constant_mass(self) -> bool:
        """Whether it is made of a potential or a force, so that p = mass v."""
        return self.kind in ("potential", "force") if self.kind in _CALLS else self._arguments[0].has_constant_mass

    @property
    def has_energy(self) -> bool:
        """Whether it has a Hamiltonian: all but a force, a tangent system, and what is made of one."""
        return self.kind not in ("force", "tangent") and (self.kind in _CALLS or self._arguments[0].has_energy)

    @property
    def tangent_rows(self) -> int:
        """How many rows tangent vectors have: 2n + parameters."""
        return 2 * self.n + self._count

    @property
    def tangent_hint(self) -> str:
        rows = f"{self.tangent_rows} rows are those of dq and dp, {self.n} each"
        return f"2n + parameters = {rows}, and {self._count} of the parameters" if self._count else f"2n = {rows}"

    def values(self, given: dict[str, Any], members: int = 1) -> np.ndarray:
        """The values of its parameters for so many members, [count][members] as the library takes them: those that
        are given, one for all or one for each member, and the recorded ones of the others."""
        for name in given:
            if name not in self.parameters:
                known = f": its parameters are {', '.join(self.parameters)}" if self.parameters else ", and no other"
                raise TypeError(f"there is no argument {name}, and the system has no parameter {name}{known}")
        rows = [spread(name, given.get(name, value), members, *np.shape(value)).reshape(members, -1).T
                for name, value in self.parameters.items()]
        values = np.concatenate([np.empty((0, members)), *rows])[:self._count].copy()
        assert len(values) == self._count
        return values

    def named(self, values: np.ndarray) -> dict[str, Any]:
        """The values [count] of its parameters by name, as values() lists them."""
        found, first = {}, 0
        for name, value in self.parameters.items():
            part = values[first:first + np.size(value)].reshape(np.shape(value))
            found[name], first = part.copy() if part.ndim else float(part), first + part.size
        return found

    def recorded_with(self, given: dict[str, Any]) -> "System":
        """The same system, recorded anew with these values of its parameters."""
        self.values(given)
        return _again(self.kind, self._arguments, {**self.parameters, **given}, given) if given else self

    def energy(self, t: Array, q: Array, p: Array) -> Any:
        """The energy H(q, p, t): sum p^2 / (2 m) + V, p.v - L, or the Hamiltonian itself.

        q and p: [n], or [k, n] for k states, then t is a number or [k], and the result is [k]. With the recorded
        values of the parameters; Integrator.energy takes its own. Raises tvi.Error: a system made from a force has
        none (EUNSUPPORTED), or H has no value there (EDOMAIN, ENONFINITE).

        >>> import tvi
        >>> tvi.potential(1, lambda q: q[0]**2 / 2).energy(0, [1], [2])
        2.5
        """
        return energies(lib.tvi_energy, self._handle.pointer, self.n, t, q, p)

    def momentum(self, t: Array, q: Array, v: Array) -> np.ndarray:
        """The momenta p = L_v(q, v, t) of velocities; M v where the mass is constant. Shapes as of energy().
        Raises tvi.Error (ESINGULAR, ENOCONV) where there are none.

        >>> import tvi
        >>> tvi.potential(2, lambda q: q @ q, mass=[1, 3]).momentum(0, [0, 0], [1, 1])
        array([1., 3.])
        """
        return transforms(lib.tvi_momentum, self._handle.pointer, self.n, t, q, v, "v")

    def velocity(self, t: Array, q: Array, p: Array) -> np.ndarray:
        """The velocities v = H_p(q, p, t) of momenta; shapes and errors as of momentum().

        >>> import tvi
        >>> tvi.potential(2, lambda q: q @ q, mass=[1, 4]).velocity(0, [0, 0], [1, 1])
        array([1.  , 0.25])
        """
        return transforms(lib.tvi_velocity, self._handle.pointer, self.n, t, q, p, "p")

    def rescaled(self, g: Callable | None = None, reversible: bool | None = None) -> "System":
        """The same system with steps that adapt and stay symplectic: dt = g(q, p, t) ds, and h is in s.

        g(q, p) or g(q, p, t) > 0 is the local time scale, in jets, with the system's parameters by keyword where it
        names them; None: the automatic one, with which h is a phase. reversible=True: steps of q' = g dq/dt,
        p' = g dp/dt, t' = g by "galerkin", which are symmetric and not symplectic, and serve forces, driven systems and
        light bodies; None: where g is the scale of gravity.Bodies with test particles. Raises tvi.Error: EUNSUPPORTED
        for a force, a driven system and a general Lagrangian that are not reversible, a rescaled system, and a mass
        that is too light for the symplectic form; EDOMAIN where g is not positive.

        >>> import numpy as np, tvi
        >>> kepler = tvi.potential(2, lambda q: -1 / np.sqrt(q @ q)).rescaled(lambda q, p: (q @ q)**0.75)
        >>> len(tvi.solve(kepler, (0, 6.28), [0.01, 0], [0, 14.1], h=0.5).t) < 60
        True
        """
        if reversible is None:
            bodies = getattr(g, "__self__", None)
            reversible = getattr(bodies, "has_test_particles", False)
        return _derived("rescaled_reversible" if reversible else "rescaled", self, g, "q p", {})

    def driven(self, drive: Callable, **parameters: Any) -> "System":
        """The same system with forces added to dp/dt that no potential gives: friction, drag, control.

        drive(q, v) or drive(q, v, t) returns n jets, with parameters by keyword: those of the system that it names,
        and new ones, with their values. For "galerkin" and "taylor". The energy stays that of the system without it.
        Raises tvi.Error: EUNSUPPORTED for a force, a rescaled system and one that is driven already.

        >>> import tvi
        >>> spring = tvi.potential(1, lambda q: q[0]**2 / 2).driven(lambda q, v, k: [-k * v[0]], k=0.1)
        >>> dict(spring.parameters)
        {'k': 0.1}
        """
        return _derived("driven", self, drive, "q v", parameters)

    def tangent(self) -> "System":
        """The tangent system, which moves a state and a tangent vector of it, for second derivatives (docs/fits.md).

        q is (q, dq), and p is (p, dp); of a Lagrangian that is not separable p is (dp, p). Each parameter k has a dk
        beside it, recorded as 0. A gradient of its runs gives second derivatives times the vector. Raises tvi.Error
        (EUNSUPPORTED) for a rescaled or constrained system; ValueError where dk is a parameter already.

        >>> import tvi
        >>> fall = tvi.potential(1, lambda q, weight: weight * q[0], weight=9.8).tangent()
        >>> run = tvi.solve(fall, (0, 1), [0, 1], [0, 0], h=0.5, dweight=3)
        >>> print(run.q_end)  # the place after a second, and its derivative: 1 - 3 / 2
        [-4.9 -0.5]
        """
        return _tangent(self, {})

    # ---- Of a constrained system -------------------------------------------------------------------------------------

    def project(self, q: Array, p: Array = None, *, v: Array = None, t: Array = 0.0,
                **parameters: Any) -> tuple[np.ndarray, np.ndarray]:
        """q and p on the constraints, phi = 0 and dphi/dt = 0: the nearest ones, by the masses, if they are near.

        q, and p or v: [n], or [k, n] for k states, then t is a number or [k]; 0: at rest. parameters: values of those
        of the system. Raises tvi.Error: EUNSUPPORTED for a system without constraints; ESINGULAR, with the constraint,
        where one depends on the others or has no gradient; ENOCONV where no state is found.

        >>> import tvi
        >>> pendulum = tvi.constrained(tvi.potential(2, lambda q: 9.8 * q[1]), lambda q: [(q @ q - 1) / 2])
        >>> print(*pendulum.project([1.1, 0], v=[0.1, 2]))
        [1. 0.] [0. 2.]
        """
        system = self.recorded_with(parameters)
        if (p is None) == (v is None):
            raise TypeError("give momenta p or velocities v, one of them; 0 for rest")
        if v is not None:  # Masses may depend on q: p is that of v on the constraints.
            v = np.zeros(np.shape(q)) if _is_zero(v) else v
            q, _ = system._projected(t, q, system.momentum(t, q, v))
            p = system.momentum(t, q, v)
        return system._projected(t, q, np.zeros(np.shape(q)) if _is_zero(p) else p)

    def _projected(self, t: Array, q: Array, p: Array) -> tuple[np.ndarray, np.ndarray]:
        t, q, p, single = _states(self.n, t, q, p, "p")
        for k in range(len(q)):
            at, there = Doubles(self.n), Doubles(self.n)
            at.array[:], there.array[:] = q[k], p[k]
            check(lib.tvi_project(self._handle.pointer, t[k], at.pointer, there.pointer))
            q[k], p[k] = at.array, there.array
        return (q[0], p[0]) if single else (q, p)

    def constraint_values(self, t: Array, q: Array, p: Array) -> tuple[np.ndarray, np.ndarray]:
        """phi and dphi/dt of a state, [m] each, or [k, m] for k states, as of energy(). Raises tvi.Error (EUNSUPPORTED)
        for a system without constraints.

        >>> import tvi
        >>> pendulum = tvi.constrained(tvi.potential(2, lambda q: 9.8 * q[1]), lambda q: [(q @ q - 1) / 2])
        >>> pendulum.constraint_values(0, [2, 0], [3, 4])
        (array([1.5]), array([6.]))
        """
        m = self.constraints
        return constraint_numbers(lib.tvi_constraint_values, self._handle.pointer, self.n, (m, m), t, q, p)

    def multipliers(self, t: Array, q: Array, p: Array) -> tuple[np.ndarray, np.ndarray]:
        """The multipliers lambda [m] of a state on the constraints, and the force of constraint [n], which is
        -sum lambda_k dphi_k/dq; [k, m] and [k, n] for k states, as of energy(). Raises tvi.Error: EUNSUPPORTED for a
        system without constraints, ESINGULAR where a constraint depends on the others.

        >>> import tvi
        >>> pendulum = tvi.constrained(tvi.potential(2, lambda q: 9.8 * q[1]), lambda q: [(q @ q - 1) / 2])
        >>> print(*pendulum.multipliers(0, [0, -1], [1, 0]))
        [10.8] [-0.  10.8]
        """
        widths = self.constraints, self.n
        return constraint_numbers(lib.tvi_multipliers, self._handle.pointer, self.n, widths, t, q, p)


def required_system(system: Any) -> System:
    if not isinstance(system, System):
        raise TypeError(f"system is what tvi.potential and its like make, not {type(system).__name__}, and the first "
                        "argument")
    return system


def energies(function: Callable, owner: Any, n: int, t: Array, q: Array, p: Array) -> Any:
    t, q, p, single = _states(n, t, q, p, "p")
    H, values = ffi.new("double *"), np.empty(len(q))
    for k in range(len(q)):
        check(function(owner, t[k], pointer(q[k]), pointer(p[k]), H))
        values[k] = H[0]
    return float(values[0]) if single else values


def transforms(function: Callable, owner: Any, n: int, t: Array, q: Array, x: Any, name: str) -> np.ndarray:
    t, q, x, single = _states(n, t, q, x, name)
    y = Doubles(n)
    values = np.empty((len(q), n))
    for k in range(len(q)):
        check(function(owner, t[k], pointer(q[k]), pointer(x[k]), y.pointer))
        values[k] = y.array
    return values[0] if single else values


def constraint_numbers(function: Callable, owner: Any, n: int, widths: tuple[int, int], t: Array, q: Array,
                       p: Array) -> tuple[np.ndarray, np.ndarray]:
    """The two vectors that the function computes of each state, of these widths."""
    t, q, p, single = _states(n, t, q, p, "p")
    one, other = (Doubles(width) for width in widths)
    values, others = (np.empty((len(q), width)) for width in widths)
    for k in range(len(q)):
        check(function(owner, t[k], pointer(q[k]), pointer(p[k]), one.pointer, other.pointer))
        values[k], others[k] = one.array, other.array
    return (values[0], others[0]) if single else (values, others)


def _states(n: int, t: Array, q: Array, x: Any, name: str) -> tuple:
    """Some states, and whether one was given."""
    single = np.ndim(q) == 1
    shape = (n,) if single else (None, n)
    q, x = numbers("q", q, *shape).reshape(-1, n), numbers(name, x, *shape).reshape(-1, n)
    if len(q) != len(x):
        raise ValueError(f"q has {len(q)} states, and {name} has {len(x)}")
    return spread("t", t, len(q)), q, x, single


# ---- The ways to state one -------------------------------------------------------------------------------------------

_CALLS = {"potential": "q", "force": "q", "lagrangian": "q v", "hamiltonian": "q p"}


def _stated(kind: str, n: Any, function: Callable, mass: Array, parameters: dict[str, Any]) -> System:
    n, values = integer("n", n, 1, MAX_DIMENSION), checked_parameters(parameters)
    masses = () if kind in ("lagrangian", "hamiltonian") else \
        (ffi.NULL if mass is None else pointer(spread("mass", mass, n)),)
    guard, recorded = Guard(), Function(kind, function, _CALLS[kind], values)
    if kind == "force":
        callback = vector(recorded, guard, "tvi_force_fn *", n)
    else:
        callback = scalar(recorded, guard, f"tvi_{kind}_fn *", n)
    create = getattr(lib, "tvi_system_" + kind)
    made = make("tvi_system", lambda out: create(out, n, *masses, callback, ffi.NULL), guard)
    return System(kind, n, (n, function, mass), values, made)


def _added(kind: str, system: System, function: Callable, vectors: str, parameters: dict[str, Any]) -> Function:
    """A function that is added to a system, with the parameters of the system and new ones."""
    new = checked_parameters(parameters)
    if twice := set(new) & set(system.parameters):
        raise ValueError(f"the system has a parameter {min(twice)} already")
    recorded = Function(kind, function, vectors, {**system.parameters, **new}, takes_all=False)
    if missing := set(new) - set(recorded.named):
        raise TypeError(f"{kind} takes no parameter {min(missing)}")
    return recorded


def _derived(kind: str, system: System, function: Callable | None, vectors: str, parameters: dict[str, Any]) -> System:
    guard, callback, values = Guard(), ffi.NULL, system.parameters
    if function is not None:
        recorded = _added(kind, system, function, vectors, parameters)
        values = recorded.values
        callback = vector(recorded, guard, "tvi_drive_fn *", system.n) if kind == "driven" else \
            scalar(recorded, guard, "tvi_rescale_fn *", system.n)
    elif kind == "driven":
        raise TypeError("drive is a function of (q, v) or (q, v, t), not NoneType")
    create = getattr(lib, "tvi_system_" + kind)
    made = make("tvi_system", lambda out: create(out, system._handle.pointer, callback, ffi.NULL), guard)
    return System(kind, system.n, (system, function), dict(values), made)


def _tangent(system: System, given: Mapping[str, Any]) -> System:
    """The tangent system, with these recorded values of dk and so on; those of others are 0."""
    rates = {}
    for name, value in system.parameters.items():
        if "d" + name in system.parameters:
            raise ValueError(f"the tangent system has d{name} for {name}, and the system has a parameter d{name}")
        zero = np.zeros(np.shape(value)) if np.ndim(value) else 0.0
        rates["d" + name] = given.get("d" + name, zero)
    values = np.concatenate([np.zeros(0), *(np.ravel(rate) for rate in rates.values())]).astype(float)
    at = pointer(values) if len(values) else ffi.NULL
    made = make("tvi_system", lambda out: lib.tvi_system_tangent(out, system._handle.pointer, at))
    return System("tangent", 2 * system.n, (system, None), {**system.parameters, **rates}, made)


def _is_zero(x: Any) -> bool:
    return np.isscalar(x) and x == 0


def _again(kind: str, arguments: tuple, parameters: dict[str, Any], others: dict[str, Any] = {}) -> System:
    """The system of a pickle, or with other values of its parameters."""
    if kind in _CALLS:
        return _stated(kind, *arguments, parameters)
    base, function = arguments
    inherited = base.recorded_with({name: value for name, value in others.items() if name in base.parameters})
    new = {name: value for name, value in parameters.items() if name not in base.parameters}
    if kind == "constrained":
        return constrained(inherited, function, **new)
    if kind == "tangent":
        return _tangent(inherited, {**parameters, **others})
    return inherited.driven(function, **new) if kind == "driven" else \
        inherited.rescaled(function, kind == "rescaled_reversible")


def potential(n: int, V: Callable, mass: Array = None, **parameters: Any) -> System:
    """The system M q'' = -dV/dq of a potential energy V(q) or V(q, t), with p = M v.

    n: degrees of freedom, 1 to 10000. V: a function of an array of n jets, called once, that returns one jet; loops,
    sums, slices, @ and numpy's functions are recorded (tvi.Jet). It takes the time if it has an argument t or time; any
    other further argument is a parameter, and arguments called v, p or t in the place of q are refused. mass: a number,
    or [n], positive; None: all 1. parameters: numbers, or arrays of numbers, that V takes by keyword, and that runs may
    have other values of. Units are any that fit together. Raises what V raises; tvi.Error with what the library
    refuses; TypeError and ValueError for arguments of another kind, shape or range.

    >>> import numpy as np, tvi
    >>> kepler = tvi.potential(2, lambda q, mu: -mu / np.sqrt(q @ q), mu=1.0)
    >>> kepler.energy(0, [1, 0], [0, 1])
    -0.5
    """
    return _stated("potential", n, V, mass, parameters)


def force(n: int, F: Callable, mass: Array = None, **parameters: Any) -> System:
    """The system M q'' = F(q, t): F(q) or F(q, t) returns n jets, dp/dt. It must not contain the masses. Such a system
    has no energy. All else as for potential().

    >>> import numpy as np, tvi
    >>> pendulum = tvi.force(1, lambda q: [-9.8 * np.sin(q[0])])
    """
    return _stated("force", n, F, mass, parameters)


def lagrangian(n: int, L: Callable, **parameters: Any) -> System:
    """The system of a Lagrangian L(q, v) or L(q, v, t), with p = L_v. L_vv must be regular where steps are made:
    tvi.Error (ESINGULAR) where it is nowhere. All else as for potential().

    >>> import numpy as np, tvi
    >>> pendulum = tvi.lagrangian(1, lambda q, v: v[0]**2 / 2 + 9.8 * np.cos(q[0]))
    """
    return _stated("lagrangian", n, L, None, parameters)


def hamiltonian(n: int, H: Callable, **parameters: Any) -> System:
    """The system of a Hamiltonian H(q, p) or H(q, p, t): dq/dt = H_p, dp/dt = -H_q. All else as for potential().

    >>> import tvi
    >>> tvi.hamiltonian(1, lambda q, p: (q[0]**2 + 1) * (p[0]**2 + 1) / 2).energy(0, [1], [1])
    2.0
    """
    return _stated("hamiltonian", n, H, None, parameters)


def constrained(system: System, function: Callable, **parameters: Any) -> System:
    """The same system on the constraints phi = 0: pendulums, rods, chains, linkages (docs/constraints.md).

    function(q) or function(q, t) returns a list of m jets phi, 0 < m < n, in any units; if m > 1 it is called once
    to count them, and once to record them. parameters by keyword: those of the system that it names, and new ones,
    with their values. Steps find the forces of constraint, -sum lambda_k dphi_k/dq. q and p keep their n numbers,
    and p stays M v. A run begins on the constraints, to half of the digits; System.project moves other states onto
    them. Results have phi, multipliers and constraint_force. Rescaled steps do not serve. Raises tvi.Error: EINVAL
    for m out of range and a phi_k that is a number or depends on t alone, EUNSUPPORTED for a system that is rescaled,
    or constrained already.

    >>> import tvi
    >>> pendulum = tvi.constrained(tvi.potential(2, lambda q: 9.8 * q[1]), lambda q: [(q @ q - 1) / 2])
    >>> run = tvi.solve(pendulum, (0, 10), q0=[1, 0], v0=0, h=0.1)
    >>> abs(run.phi).max() < 1e-15, abs(run.energy).max() < 1e-13, run.multipliers.shape
    (True, True, (101, 1))
    """
    recorded = _added("constrained", required_system(system), function, "q", parameters)

    def make_of(m: int) -> Any:
        guard = Guard()
        callback = vector(recorded, guard, "tvi_constraint_fn *", system.n, m)
        return make("tvi_system", lambda out: lib.tvi_system_constrained(out, system._handle.pointer, m, callback,
                                                                         ffi.NULL), guard)

    count = 1
    try:
        made = make_of(count)
    except Miscounted as counted:  # The library is told the number before it calls the function.
        count = counted.count
    if count != 1:
        made = make_of(count)
    return System("constrained", system.n, (system, function), dict(recorded.values), made)
