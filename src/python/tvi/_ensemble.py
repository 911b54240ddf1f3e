"""Ensembles: many orbits of one system at once."""

from __future__ import annotations

import re
from typing import Any, Callable

import numpy as np

from ._alike import Busy, Made, Stats, encoded, looked_at, read, stats_of, written
from ._arguments import answered, starts_of_many
from ._arrays import MOST_STEPS, Array, Doubles, integer, pointer, spread
from ._events import Recorded, events_of
from ._library import ESTOPPED, Error, Guard, Handle, Interrupted, STATUSES, apart, check, ffi, lib, make
from ._methods import Compiled, Method, code_for
from ._runs import Course, Observers, Way, ended, new_plan
from ._systems import System, energies, transforms


class Ensemble(Made):
    """Many orbits (members) of one system, that go on together.

    q, and p or v: [member, n], or [n] for all, 0 for rest; t: a number or [member]. parameters: values of those of the
    system, one for all or [member, ...]. threads: 0 for all cores. method, order, compiled: as for tvi.Integrator. `t`
    [member], `q` and `p` [member, n] are the states, and may be changed between runs. `status` [member] has names:
    "OK", or that of tvi.Error.status for a member that failed: it keeps its last good state, and the others go on;
    "ESTOPPED" where an event or an observer ended its run. `tangent`: None, or [member, 2n + parameters, columns].

    >>> import numpy as np, tvi
    >>> kepler = tvi.potential(2, lambda q: -1 / np.sqrt(q @ q))
    >>> orbits = tvi.Ensemble(kepler, np.linspace([1, 0], [2, 0], 100), [0, 0.8])
    >>> orbits.integrate(0.25, 400)
    True
    >>> orbits.q.shape, set(orbits.status)
    ((100, 2), {'OK'})
    """

    @answered
    def __init__(self, system: System, q: Array, p: Array = None, *, v: Array = None, t: Array = 0.0,
                 method: "str | Method" = "galerkin", order: int = 16, threads: int = 0,
                 compiled: "bool | Compiled" = False, members: int | None = None, **parameters: Any):
        self._make_of(system, method, order)
        n = system.n
        members = None if members is None else integer("members", members, 1)
        others = [(t, 1)] + [(value, 1 + np.ndim(system.parameters.get(name, 0))) for name, value in parameters.items()]
        count, q, p, v = starts_of_many("q p v", system, members, q, p, v, others)
        self._members = count
        self._t, self._q, self._p = Doubles(count), Doubles(n, count), Doubles(n, count)
        self._status = ffi.new("tvi_status[]", count)
        self._codes = np.frombuffer(ffi.buffer(self._status), dtype=np.int32)
        self._tangent: Doubles | None = None
        self._busy = Busy("ensemble")
        self._t.array[:] = spread("t", t, count)
        self._q.array[:] = q.T
        values = system.values(parameters, count)
        options = ffi.new("tvi_options *", self.method._options[0])
        code = code_for(compiled, system, self.method)
        options.compiled = code._handle.pointer if code else ffi.NULL
        threads = integer("threads", threads, 0)
        self._made_with: dict[str, Any] = {"threads": threads, "compiled": code is not None}
        made = make("tvi_ensemble", lambda out: lib.tvi_ensemble_create(out, system._handle.pointer, options, count,
                                                                        threads))
        self._system = system._handle.own(self)
        self._handle = Handle(made, lib.tvi_ensemble_free).own(self)
        self._values = np.tile(system.values({}), (1, count)).copy()
        if parameters:
            self._set(values)
        self._p.array[:] = (p if v is None else self._each(lib.tvi_momentum, v, "v")).T

    # ---- The states --------------------------------------------------------------------------------------------------

    @property
    def members(self) -> int:
        return self._members

    @property
    def t(self) -> np.ndarray:
        return self._t.array

    @t.setter
    def t(self, value: Any) -> None:
        self._t.array[:] = spread("t", value, self.members)

    @property
    def q(self) -> np.ndarray:
        return self._q.array.T

    @q.setter
    def q(self, value: Any) -> None:
        self._q.array[:] = spread("q", value, self.members, self.system.n).T

    @property
    def p(self) -> np.ndarray:
        return self._p.array.T

    @p.setter
    def p(self, value: Any) -> None:
        self._p.array[:] = spread("p", value, self.members, self.system.n).T

    @property
    def v(self) -> np.ndarray:
        """The velocities [member, n] of the momenta, a copy."""
        return self._each(lib.tvi_velocity, self.p, "p")

    @property
    def status(self) -> np.ndarray:
        return np.array(STATUSES)[self._codes]

    @property
    def tangent(self) -> np.ndarray | None:
        return None if self._tangent is None else self._tangent.array.transpose(2, 0, 1)

    @tangent.setter
    def tangent(self, value: Any) -> None:
        with self._busy.running():
            if value is None:
                self._tangent = None
                return
            rows = self.system.tangent_rows
            columns = np.shape(value)[-1] if np.ndim(value) > 1 else 0
            given = spread("tangent", value, self.members, rows, columns, hint=self.system.tangent_hint)
            if columns < 1:
                raise ValueError("tangent has no columns")
            self._tangent = Doubles(rows, columns, self.members)
            self._tangent.array[:] = given.transpose(1, 2, 0)

    def set_parameters(self, **parameters: Any) -> None:
        """Other values for parameters, one for all or [member, ...], from the next step on."""
        given = self.system.values(parameters, self.members)
        with self._busy.asked():
            names = list(self.system.parameters)
            rows = np.repeat([name in parameters for name in names],
                             [np.size(self.system.parameters[name]) for name in names])[:len(given)]
            values = np.where(rows[:, np.newaxis], given, self._values) if len(given) else given
            self._set(values)

    def _set(self, values: np.ndarray) -> None:
        with self._busy.asked():
            values = np.ascontiguousarray(values)
            check(lib.tvi_ensemble_set_parameters(self._handle.pointer, pointer(values)))
            self._values = values

    def energy(self) -> np.ndarray:
        """The energies [member], with the members' own parameters. Raises tvi.Error (EUNSUPPORTED) for a force."""
        return self._each(lib.tvi_energy, self.p, "p")

    def _each(self, function: Any, x: np.ndarray, name: str) -> np.ndarray:
        """The function for each member; where parameters differ from the recorded ones, by an integrator with them."""
        system, t, q = self.system, self.t, self.q
        is_energy = function == lib.tvi_energy
        if not system._count:
            call = (lambda *state: energies(function, system._handle.pointer, system.n, *state)) if is_energy else \
                (lambda *state: transforms(function, system._handle.pointer, system.n, *state, name))
            return call(t, q, x)
        from_own = {lib.tvi_energy: lib.tvi_integrator_energy, lib.tvi_momentum: lib.tvi_integrator_momentum,
                    lib.tvi_velocity: lib.tvi_integrator_velocity}[function]
        made = Handle(make("tvi_integrator", lambda out: lib.tvi_integrator_create(
            out, system._handle.pointer, self.method._options)), lib.tvi_integrator_free).own(self)
        try:
            rows = []
            for m in range(self.members):
                values = self._values[:, m].copy()
                check(lib.tvi_integrator_set_parameters(made.pointer, pointer(values)))
                state = made.pointer, system.n, t[m], q[m], x[m]
                rows.append(energies(from_own, *state) if is_energy else transforms(from_own, *state, name))
            return np.array(rows)
        finally:
            made.release(self)

    @property
    def stats(self) -> Stats:
        """Counts of all members together."""
        stats = ffi.new("tvi_stats *")
        with self._busy.asked():
            check(lib.tvi_ensemble_stats(self._handle.pointer, stats))
        return stats_of(stats)

    # ---- Runs --------------------------------------------------------------------------------------------------------

    def integrate(self, h: float, steps: int, **observers: Any) -> bool:
        """So many steps of size h of each member; observers and the result as of run()."""
        return self.run(h=h, steps=steps, **observers)

    def integrate_to(self, h: float, t_end: float, **observers: Any) -> bool:
        """All members to t_end exactly; observers and the result as of run()."""
        return self.run(h=h, t_end=t_end, **observers)

    @answered
    def run(self, *, h: float | None = None, steps: int | None = None, t_end: float | None = None, times: Array = None,
            tolerance: float | None = None, largest_step: float | None = None, events: Any = (),
            at_step: Callable | None = None, at_time: Callable | None = None, on_event: Callable | None = None,
            observer: Callable | None = None) -> bool:
        """A run of all members, as Integrator.run. at_step, at_time and on_event(member, which, t, q, p) are called
        for one member, on any thread, one call at a time, in order of time for each member; a true value ends the run
        of that member. observer(step) is called between the steps of all members, with steps alone; there the states
        and `tangent` may be read and changed, and a true value ends the run. Returns whether all members went to the
        end. Members that fail are told by `status`. On Ctrl-C tvi.Interrupted.

        >>> import numpy as np, tvi
        >>> spring = tvi.potential(1, lambda q, k: k * q[0]**2 / 2, k=1.0)
        >>> springs = tvi.Ensemble(spring, [1], p=0, k=[1, 4])
        >>> springs.run(h=0.1, t_end=np.pi)
        True
        >>> springs.q.round(9)
        array([[-1.],
               [ 1.]])
        """
        several = events_of(events)
        functions = {"at_step": at_step, "at_time": at_time, "on_event": on_event}
        if observer is not None and (steps is None or several or any(functions.values())):
            raise TypeError("observer goes with steps alone")
        return self._go(Way(h, steps, t_end, times, tolerance, largest_step), several, functions,
                        may_end=any(functions.values()), after=observer, every=1 if observer else MOST_STEPS)

    def _go(self, way: Way, events: list, functions: dict[str, Any], may_end: bool = False, **cuts: Any) -> bool:
        """A run. Where events or observers may end that of a member, it is one call, as it would go on in the next."""
        recorded, guard, tangent = Recorded(self.system, events), Guard(), self._tangent
        plan = new_plan(way, recorded, tangent)
        observers = Observers(self.system.n, plan, guard, **functions)
        is_counted = not (may_end or any(one.terminal for one in events)) and \
            (way.steps is not None or way.tolerance is None and not self.system.is_rescaled)
        if not is_counted:
            observers.hear(plan)
        is_apart = not is_counted and self._made_with["threads"] != 1
        call = (lambda: apart(lambda: self._checked_call(plan), guard)) if is_apart else lambda: self._call(plan)
        course = Course(way, plan, lambda: ESTOPPED if guard.thrown else call(), self._going_times, is_counted, **cuts)
        with self._busy.running():
            try:
                return ended(course.run(), guard, self.system, way) and not self._codes.any()
            except KeyboardInterrupt:
                raise Interrupted(f"interrupted at t from {self.t.min()} to {self.t.max()}", self) from None

    def _state(self) -> tuple:
        return self._t.pointer, self._q.pointer, self._p.pointer, self._status

    def _call(self, plan: Any) -> int:
        return lib.tvi_ensemble_run(self._handle.pointer, plan, *self._state())

    def _checked_call(self, plan: Any) -> int:
        """A call on another thread, as the main one would hear nothing while it waits for others to end their members.
        What is refused is raised there, where its text is."""
        status = self._call(plan)
        if status != ESTOPPED:
            check(status)
        return status

    def _going_times(self) -> np.ndarray:
        """The times of the members that go on."""
        return self.t[self._codes == 0]

    def reset(self) -> None:
        """Forgets the last steps; members that have failed are tried again."""
        with self._busy.running():
            lib.tvi_ensemble_reset(self._handle.pointer)
            self._codes[:] = 0

    def save(self) -> bytes:
        """The texts of all members, one after the other, as Integrator.save."""
        with self._busy.asked():
            state = self._state()[:3]
            return b"".join(written(lib.tvi_ensemble_member_to_text, self._handle.pointer, member, *state)
                            for member in range(self.members))

    def load(self, texts: "str | bytes") -> None:
        """Goes on from what save() returned, with as many members. Those that have failed are tried again. Raises
        tvi.Error (EINVAL) as Integrator.load."""
        characters = encoded(texts)
        starts = [at.start() for at in re.finditer(rb"tvi state ", characters)] or [0]
        each = [characters[a:b] for a, b in zip(starts, starts[1:] + [None])]
        for text in each:
            looked_at(text)
        if len(each) != self.members or starts[0] != 0:
            raise Error(f"the texts are of {len(each)} members, not {self.members}")
        for member, text in enumerate(each):
            self.member_from_text(member, text)

    def member_to_text(self, member: int) -> str:
        """The state of one member as Integrator.to_text; either reads it.

        >>> import tvi
        >>> spring = tvi.potential(1, lambda q: q[0]**2 / 2)
        >>> springs, one = tvi.Ensemble(spring, [[1], [2]], p=0), tvi.Integrator(spring, [0], p=0)
        >>> one.from_text(springs.member_to_text(1))
        >>> springs.member_from_text(0, one.to_text())
        >>> springs.q.tolist()
        [[2.0], [2.0]]
        """
        member = integer("member", member, 0, self.members - 1)
        with self._busy.asked():
            return written(lib.tvi_ensemble_member_to_text, self._handle.pointer, member, *self._state()[:3]).decode()

    def member_from_text(self, member: int, text: "str | bytes") -> None:
        """One member goes on from the text, as Integrator.from_text, and its status is "OK"."""
        member, characters = integer("member", member, 0, self.members - 1), encoded(text)
        with self._busy.running():
            status = lib.tvi_ensemble_member_from_text(self._handle.pointer, member, characters, len(characters),
                                                       *self._state()[:3])
            self._values[:, member] = read(status, characters)
            self._codes[member] = 0

    def __reduce__(self) -> tuple:
        state = (self.save(), self.t.copy(), self.q.copy(), self.p.copy(),
                 None if self._tangent is None else self.tangent.copy(), self._values, self._codes.copy())
        return _again, (self.system, self.method, self.members, self._made_with, state)

    def __repr__(self) -> str:
        return f"<tvi ensemble: {self.members} members, {self.method!r} for {self.system!r}>"


def _again(system: System, method: Method, members: int, made_with: dict[str, Any], state: tuple) -> Ensemble:
    """The ensemble of a pickle."""
    texts, t, q, p, tangent, values, status = state
    ensemble = Ensemble(system, q, p, t=t, method=method, members=members, **made_with)
    ensemble._values = values
    ensemble.load(texts)
    ensemble.t, ensemble.q, ensemble.p, ensemble.tangent = t, q, p, tangent
    ensemble._codes[:] = status
    return ensemble


