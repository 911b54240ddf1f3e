"""Integrators: one orbit, step by step or in runs, saved and resumed, with its tangent map."""

from __future__ import annotations

from typing import Any, Callable

import numpy as np

from ._alike import Busy, Made, Stats, encoded, looked_at, read, stats_of, written
from ._arguments import answered, start_of_one
from ._arrays import Array, Doubles, number, numbers, pointer, step_size
from ._events import Recorded, events_of
from ._library import Guard, Handle, Interrupted, check, ffi, lib, make
from ._methods import Compiled, Method, code_for, resolved
from ._runs import Course, Observers, Way, advice, ended, new_plan
from ._systems import System, constraint_numbers, energies, transforms


class Integrator(Made):
    """One orbit of a system, that goes on from step to step.

    q, and p or v: [n], the momenta or the velocities, one of them; p=0 or v=0: at rest. method, order: tvi.Method.
    compiled: True, or what tvi.compile made. parameters: values of those of the system. `t`, `q` and `p` are the state,
    and may be changed between steps; q and p are arrays [n] that its steps write to, so copy what you keep. `tangent`:
    None, or tangent vectors [2n + parameters, columns], rows (dq, dp), that its steps move. An integrator is used by
    one thread at a time, and pickles where its system does. Raises tvi.Error where the method does not serve the
    system.

    >>> import numpy as np, tvi
    >>> kepler = tvi.potential(2, lambda q: -1 / np.sqrt(q @ q))
    >>> orbit = tvi.Integrator(kepler, [1, 0], [0, 0.8])
    >>> orbit.integrate(0.25, 16000)
    True
    >>> print(orbit.t, orbit.q.round(6), abs(orbit.energy() + 0.68) < 1e-13)
    4000.0 [ 0.256821 -0.685955] True
    """

    @answered
    def __init__(self, system: System, q: Array, p: Array = None, *, v: Array = None, t: float = 0.0,
                 method: "str | Method" = "galerkin", order: int = 16, compiled: "bool | Compiled" = False,
                 **parameters: Any):
        self._make_of(system, method, order)
        q, p, v = start_of_one("q p v", system, q, p, v)
        self._t, self._q, self._p = Doubles(1), Doubles(system.n), Doubles(system.n)
        self._tangent: Doubles | None = None
        self._at_once = False  # Runs move all columns of the tangent at once.
        self._busy = Busy("integrator")
        self._record: Any = None  # of a run whose gradient is wanted (_gradient.py)
        self._chaos: Any = None  # of runs with the exponent and MEGNO of `tangent`, one column (_chaos.py)
        self.t, self.q = t, q
        values = system.values(parameters)
        options = ffi.new("tvi_options *", self.method._options[0])
        code = code_for(compiled, system, self.method)
        self._is_compiled = code is not None
        options.compiled = code._handle.pointer if code else ffi.NULL
        made = make("tvi_integrator", lambda out: lib.tvi_integrator_create(out, system._handle.pointer, options))
        self._system = system._handle.own(self)
        self._handle = Handle(made, lib.tvi_integrator_free).own(self)
        self._parameters = dict(system.parameters)
        if parameters:
            self._set(values, parameters)
        if v is not None:
            p = self.momentum(q, v)
        self.p = p

    # ---- The state ---------------------------------------------------------------------------------------------------

    @property
    def t(self) -> float:
        return float(self._t.array[0])

    @t.setter
    def t(self, value: float) -> None:
        self._t.array[0] = number("t", value)

    @property
    def q(self) -> np.ndarray:
        return self._q.array

    @q.setter
    def q(self, value: Any) -> None:
        self._q.array[:] = numbers("q", value, self.system.n)

    @property
    def p(self) -> np.ndarray:
        return self._p.array

    @p.setter
    def p(self, value: Any) -> None:
        self._p.array[:] = numbers("p", value, self.system.n)

    @property
    def v(self) -> np.ndarray:
        """The velocities [n] of the momenta, a copy."""
        return self._transform(lib.tvi_integrator_velocity, self.q, self.p, "p")

    @property
    def tangent(self) -> np.ndarray | None:
        return None if self._tangent is None else self._tangent.array

    @tangent.setter
    def tangent(self, value: Any) -> None:
        with self._busy.running():
            if value is None:
                self._tangent = None
                return
            given = numbers("tangent", value, self.system.tangent_rows, None, hint=self.system.tangent_hint)
            if given.shape[1] < 1:
                raise ValueError("tangent has no columns")
            self._tangent = Doubles(*given.shape)
            self._tangent.array[:] = given

    @property
    def parameters(self) -> dict[str, Any]:
        """The values of its parameters by name."""
        return dict(self._parameters)

    def set_parameters(self, **parameters: Any) -> None:
        """Other values for parameters of the system, from the next step on; also inside of an observer.

        >>> import tvi
        >>> spring = tvi.potential(1, lambda q, k: k * q[0]**2 / 2, k=1.0)
        >>> orbit = tvi.Integrator(spring, [1], p=0)
        >>> orbit.set_parameters(k=4.0)
        >>> orbit.energy()
        2.0
        """
        self._set(self.system.values({**self._parameters, **parameters}), parameters)

    def _set(self, values: np.ndarray, parameters: dict[str, Any]) -> None:
        with self._busy.asked():
            check(lib.tvi_integrator_set_parameters(self._handle.pointer, pointer(values)))
            self._parameters.update(parameters)

    def energy(self) -> float:
        """The energy of its state, with its parameters. Raises tvi.Error (EUNSUPPORTED) for a force."""
        with self._busy.asked():
            return energies(lib.tvi_integrator_energy, self._handle.pointer, self.system.n, self.t, self.q, self.p)

    def momentum(self, q: Array, v: Array) -> np.ndarray:
        """The momenta of velocities at its time and with its parameters; as System.momentum."""
        return self._transform(lib.tvi_integrator_momentum, q, v, "v")

    def project(self) -> None:
        """Moves its state onto the constraints, with its parameters; as System.project.

        >>> import tvi
        >>> pendulum = tvi.constrained(tvi.potential(2, lambda q: 9.8 * q[1]), lambda q: [(q @ q - 1) / 2])
        >>> orbit = tvi.Integrator(pendulum, [1.1, 0], v=[0.1, 2])
        >>> orbit.project()
        >>> print(orbit.q, orbit.p)
        [1. 0.] [0. 2.]
        """
        with self._busy.running():
            check(lib.tvi_integrator_project(self._handle.pointer, self.t, self._q.pointer, self._p.pointer))

    def constraint_values(self) -> tuple[np.ndarray, np.ndarray]:
        """phi and dphi/dt [m] of its state, with its parameters; as System.constraint_values."""
        return self._of_constraints(lib.tvi_integrator_constraint_values, self.system.constraints)

    def multipliers(self) -> tuple[np.ndarray, np.ndarray]:
        """The multipliers [m] and the force of constraint [n] of its state, with its parameters; as
        System.multipliers."""
        return self._of_constraints(lib.tvi_integrator_multipliers, self.system.n)

    def _of_constraints(self, function: Any, width: int) -> tuple[np.ndarray, np.ndarray]:
        with self._busy.asked():
            return constraint_numbers(function, self._handle.pointer, self.system.n, (self.system.constraints, width),
                                      self.t, self.q, self.p)

    def _transform(self, function: Any, q: Array, x: Any, name: str) -> np.ndarray:
        with self._busy.asked():
            return transforms(function, self._handle.pointer, self.system.n, self.t, q, x, name)

    @property
    def stats(self) -> Stats:
        with self._busy.asked():
            return stats_of(lib.tvi_integrator_stats(self._handle.pointer)[0])

    @property
    def options(self) -> dict[str, Any]:
        """The options of its method as they were resolved, such as the degree and the quadrature.

        >>> import tvi
        >>> options = tvi.Integrator(tvi.potential(1, lambda q: q[0]**2), [1], p=0).options
        >>> options["degree"], options["quadrature_points"], options["nodes"]
        (8, 8, 'on-curve')
        """
        return resolved(lib.tvi_integrator_options(self._handle.pointer))

    # ---- Steps -------------------------------------------------------------------------------------------------------

    def step(self, h: float) -> None:
        """One step of size h; h < 0 goes back. Moves `tangent`, too, where it is set: D <- M D with the Jacobian M of
        the step. Raises tvi.Error, with the state as it was: EDOMAIN, ENOCONV, ESINGULAR, ENONFINITE, ETOOLARGE.

        >>> import numpy as np, tvi
        >>> orbit = tvi.Integrator(tvi.potential(1, lambda q: q[0]**2 / 2), [1], p=0)
        >>> orbit.tangent = np.eye(2)
        >>> orbit.step(0.1)
        >>> print(orbit.q.round(9), orbit.tangent.round(6).tolist())
        [0.995004165] [[0.995004, 0.099833], [-0.099833, 0.995004]]
        """
        h = step_size("h", h)
        with self._busy.running():
            state = self._t.pointer, self._q.pointer, self._p.pointer
            if self._tangent is None:
                status = lib.tvi_step(self._handle.pointer, h, *state)
            else:
                status = lib.tvi_step_tangent(self._handle.pointer, h, *state, self._tangent.pointer,
                                              self._tangent.array.shape[1])
            check(status, advice(self.system))

    def integrate(self, h: float, steps: int, **observers: Any) -> bool:
        """So many steps of size h; observers and the result as of run()."""
        return self.run(h=h, steps=steps, **observers)

    def integrate_to(self, h: float, t_end: float, **observers: Any) -> bool:
        """Steps of size h to t_end exactly, by a last shorter step; observers and the result as of run()."""
        return self.run(h=h, t_end=t_end, **observers)

    def integrate_at(self, h: float, times: Array, **observers: Any) -> tuple[np.ndarray, np.ndarray]:
        """Steps of size h until the last of the times [k]; q and p at the times, [k, n] each. Fewer rows where an
        event or an observer stopped the run.

        >>> import tvi
        >>> orbit = tvi.Integrator(tvi.potential(1, lambda q: q[0]**2 / 2), [1], p=0)
        >>> orbit.integrate_at(0.5, [0, 1, 2])[0].round(6)
        array([[ 1.      ],
               [ 0.540302],
               [-0.416147]])
        """
        rows: list[tuple] = []
        self.run(h=h, times=times, at_time=lambda which, t, q, p: rows.append((q, p)), **observers)
        shape = (-1, self.system.n)
        return np.array([q for q, _ in rows]).reshape(shape), np.array([p for _, p in rows]).reshape(shape)

    def integrate_tolerance(self, tolerance: float, t_end: float, **observers: Any) -> bool:
        """Steps of "taylor" to t_end exactly, as large as a relative tolerance allows; as run()."""
        return self.run(tolerance=tolerance, t_end=t_end, **observers)

    @answered
    def run(self, *, h: float | None = None, steps: int | None = None, t_end: float | None = None, times: Array = None,
            tolerance: float | None = None, largest_step: float | None = None, events: Any = (),
            at_step: Callable | None = None, at_time: Callable | None = None,
            on_event: Callable | None = None) -> bool:
        """A run: h and steps; h and t_end or times [k], or both; or tolerance and t_end (perhaps with largest_step).

        events: tvi.event, or several. at_step(step, t, q, p) is called after each step, at_time(which, t, q, p) at
        each time, both from 1, and on_event(which, t, q, p) at each event, from 0; q and p are copies, and a true
        value ends the run. `tangent` is moved, too, and while at_time and on_event are called it is that of the state
        that they are told. Returns whether the run went to its end, False where an observer or a terminal event
        stopped it. Whatever happens, the state is that after the last good step. Raises tvi.Error as step() does, what
        the observers raise, and on Ctrl-C tvi.Interrupted: the run may go on from there. What on_event raises ends
        the run at the event.

        >>> import tvi
        >>> orbit = tvi.Integrator(tvi.potential(1, lambda q: q[0]**2 / 2), [1], p=0)
        >>> orbit.run(h=0.5, t_end=10, events=tvi.event(lambda q, p: q[0], terminal=True))
        False
        >>> round(orbit.t, 9)
        1.570796327
        """
        observers = {name: _of_one(function) for name, function in
                     (("at_step", at_step), ("at_time", at_time), ("on_event", on_event))}
        return self._go(Way(h, steps, t_end, times, tolerance, largest_step),
                        Recorded(self.system, events_of(events)), observers)

    def _is_counted(self, way: Way) -> bool:
        """Whether the steps of a run can be counted before they are made."""
        return way.steps is not None or way.tolerance is None and not self.system.is_rescaled

    def _go(self, way: Way, recorded: Recorded, functions: dict[str, Any], after_step: Callable | None = None,
            **cuts: Any) -> bool:
        """A run; what Observers.hear and Course say of the last arguments."""
        guard, tangent = Guard(), self._tangent  # which another thread may replace until the run begins
        plan = new_plan(way, recorded, tangent)
        if self._record is not None:
            plan.record = self._record.handle.pointer
        plan.columns_at_once = self._at_once and tangent is not None
        observers = Observers(self.system.n, plan, guard, **functions)
        is_counted = self._is_counted(way)
        if after_step is not None or not is_counted or functions.get("on_event"):
            observers.hear(plan, after_step)
        course = Course(way, plan, lambda: self._call(plan), lambda: self._t.array, is_counted, **cuts)
        with self._busy.running():
            try:
                return ended(course.run(), guard, self.system, way)
            except KeyboardInterrupt:
                raise Interrupted(f"interrupted at t = {self.t}", self) from None

    def _call(self, plan: Any) -> int:
        state = self._t.pointer, self._q.pointer, self._p.pointer
        if self._chaos is not None:
            return lib.tvi_run_chaos(self._handle.pointer, plan, self._chaos, *state)
        return lib.tvi_run(self._handle.pointer, plan, *state)

    def dense(self, theta: float) -> tuple[np.ndarray, np.ndarray]:
        """q and p at the part theta, 0 to 1, of the last step, on the step's own curve; of lower order than the step
        between 0 and 1. Raises tvi.Error (EINVAL) before a step.

        >>> import tvi
        >>> orbit = tvi.Integrator(tvi.potential(1, lambda q: q[0]**2 / 2), [1], p=0)
        >>> orbit.step(1)
        >>> orbit.dense(0.5)[0].round(9)
        array([0.877582562])
        """
        q, p = Doubles(self.system.n), Doubles(self.system.n)
        with self._busy.asked():
            check(lib.tvi_dense(self._handle.pointer, number("theta", theta), q.pointer, p.pointer))
        return q.array.copy(), p.array.copy()

    def reset(self) -> None:
        """Forgets the last step, and the low-order parts of its sums."""
        with self._busy.asked():
            lib.tvi_integrator_reset(self._handle.pointer)

    # ---- Saved states ------------------------------------------------------------------------------------------------

    def save(self) -> bytes:
        """Its state as text, as tvi_state_to_text writes it: t, q and p with their low-order parts, the values of
        parameters, and the history of its steps. A run that goes on from there, in an integrator of the same system and
        method, has the bits of the run that was not interrupted; all others go on to roundoff.

        >>> import tvi
        >>> spring = tvi.potential(1, lambda q: q[0]**2 / 2)
        >>> one, other = tvi.Integrator(spring, [1], p=0), tvi.Integrator(spring, [0], p=0)
        >>> one.step(0.1)
        >>> other.load(one.save())
        >>> other.t, bool(other.q == one.q)
        (0.1, True)
        """
        with self._busy.asked():
            state = self.t, self._q.pointer, self._p.pointer
            return written(lib.tvi_state_to_text, self._handle.pointer, *state)

    def load(self, text: "str | bytes") -> None:
        """Goes on from what save() or to_text() returned, perhaps of another version or method: then the history is
        dropped, with a warning. Raises tvi.Error (EINVAL) for a text that is damaged, or of another n or number of
        parameters, with the state as it was."""
        characters = encoded(text)
        with self._busy.running():
            status = lib.tvi_state_from_text(self._handle.pointer, characters, len(characters), self._t.pointer,
                                             self._q.pointer, self._p.pointer)
            self._parameters.update(self.system.named(read(status, characters)))

    def to_text(self) -> str:
        """What save() returns, as a string.

        >>> import tvi
        >>> spring = tvi.Integrator(tvi.potential(1, lambda q: q[0]**2 / 2), [1], p=0)
        >>> print(spring.to_text()[:196])
        tvi state 2
        n 1
        parameters 0
        from_step 0
        t +0x0.0000000000000p+0000 +0x0.0000000000000p+0000
        q +0x1.0000000000000p+0000 +0x0.0000000000000p+0000
        p +0x0.0000000000000p+0000 +0x0.0000000000000p+0000
        """
        return self.save().decode()

    def from_text(self, text: "str | bytes") -> None:
        """Does what load() does.

        >>> import tvi, warnings
        >>> spring = tvi.potential(1, lambda q: q[0]**2 / 2)
        >>> one, other = tvi.Integrator(spring, [1], p=0, method="taylor", order=12), tvi.Integrator(spring, [0], p=0)
        >>> one.step(0.1)
        >>> with warnings.catch_warnings(record=True) as told:
        ...     other.from_text(one.to_text())
        >>> other.t, bool(other.q == one.q), len(told)
        (0.1, True, 1)
        """
        self.load(text)

    def __reduce__(self) -> tuple:
        state = (self.save(), self.t, self.q.copy(), self.p.copy(), None if self._tangent is None
                 else self._tangent.array.copy(), self._parameters)
        return _again, (self.system, self.method, self._is_compiled, state)

    def __repr__(self) -> str:
        return f"<tvi integrator: {self.method!r} for {self.system!r}, t = {self.t}>"


def _of_one(function: Callable | None) -> Callable | None:
    """An observer of an integrator, which is told of no member."""
    return function if function is None or not callable(function) else lambda member, *told: function(*told)


def _again(system: System, method: Method, is_compiled: bool, state: tuple) -> Integrator:
    """The integrator of a pickle."""
    text, t, q, p, tangent, parameters = state
    integrator = Integrator(system, q, p, t=t, method=method, compiled=is_compiled)
    integrator.load(text)
    integrator.t, integrator.q, integrator.p, integrator.tangent = t, q, p, tangent
    integrator._parameters = dict(parameters)
    return integrator


def peek(text: "str | bytes") -> tuple[float, np.ndarray, np.ndarray]:
    """What the text of a state holds, without an integrator: t, q [n] and p [n]. Raises tvi.Error (EINVAL) for a text
    that is damaged.

    >>> import tvi
    >>> orbit = tvi.Integrator(tvi.potential(1, lambda q: q[0]**2 / 2), [1], p=0)
    >>> orbit.step(0.5)
    >>> t, q, p = tvi.peek(orbit.save())
    >>> t, bool(q == orbit.q)
    (0.5, True)
    """
    return looked_at(encoded(text))
