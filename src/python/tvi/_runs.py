"""Runs by a plan, cut into calls of some hundredths of a second, between which Python hears Ctrl-C.

The library's runs have the same bits however they are cut (include/tvi_runs.h), as long as each cut lies at the end of
a step of size h: so a run to a time is cut into numbers of steps that do not reach it. Steps that adapt have no such
numbers. Those runs are one call, with an observer that does nothing but come back to Python."""

from __future__ import annotations

import math
import threading
import time
from typing import Any, Callable

import numpy as np

from ._arrays import MOST_STEPS, copied, fraction, integer, number, numbers, pointer, step_size
from ._library import ESTOPPED, OK, Guard, check, ffi, text_of
from ._systems import System

PIECE = 0.05  # seconds of a call


class Way:
    """How far a run goes: h and steps, h and t_end or times or both, or tolerance and t_end."""

    def __init__(self, h: Any, steps: Any, t_end: Any, times: Any, tolerance: Any, largest_step: Any = None):
        ends = [name for name, value in (("steps", steps), ("t_end", t_end), ("times", times)) if value is not None]
        if (h is None) == (tolerance is None):
            raise TypeError("a run takes h or a tolerance, and one of them")
        if len(ends) != 1 and ends != ["t_end", "times"] or tolerance is not None and ends != ["t_end"]:
            raise TypeError("a run takes steps, t_end or times, one of them, or t_end and times" if tolerance is None
                            else "a run to a tolerance takes t_end")
        if largest_step is not None and tolerance is None:
            raise TypeError("largest_step is for runs to a tolerance")
        self.h = 0.0 if h is None else step_size("h", h)
        self.steps = None if steps is None else integer("steps", steps, 0, MOST_STEPS)
        self.t_end = None if t_end is None else number("t_end", t_end)
        self.times = None if times is None else numbers("times", times, None)
        if self.times is not None and len(self.times) > 2**31 - 1:
            raise ValueError("a list has at most 2147483647 times")
        self.tolerance = None if tolerance is None else fraction("tolerance", tolerance)
        self.largest_step = 0.0 if largest_step is None else number("largest_step", largest_step)


class Pace:
    """How many steps a call makes, so that it takes some hundredths of a second."""

    def __init__(self) -> None:
        self.steps = 1  # An ensemble's may take as long as that.

    def timed(self, call: Callable[[], int], steps: int) -> int:
        start = time.perf_counter()
        status = call()
        spent = time.perf_counter() - start
        if steps >= self.steps:
            self.steps = max(1, int(self.steps * min(8.0, PIECE / max(spent, 1e-9))))
        return status


class Observers:
    """The callbacks of a plan. Each function is called as function(member, which, t, q, p) with copies of the state,
    and a true value that it returns ends the run."""

    def __init__(self, n: int, plan: Any, guard: Guard, **functions: Callable | None):
        self._callbacks = []
        self._n, self._guard = n, guard
        for name, function in functions.items():
            if function is not None:
                if not callable(function):
                    raise TypeError(f"{name} is a function, not {type(function).__name__}")
                observer = self._observer(function, counts=name != "on_event")
                callback = guard.callback("tvi_member_observer *", observer, 1)
                self._callbacks.append(callback)
                setattr(plan, name, callback)

    def _observer(self, function: Callable, counts: bool) -> Callable:
        """Times and steps are counted here, as the library counts them from 1 in each call of a run."""
        n, guard = self._n, self._guard
        told: dict[int, int] = {}

        def call(member: int, which: int, t: float, q: Any, p: Any, _: Any) -> int:
            if guard.thrown is not None:
                return 1
            if counts:
                which = told[member] = told.get(member, 0) + 1
            return 1 if function(member, which, t, copied(q, n), copied(p, n)) else 0

        return call

    def hear(self, plan: Any, after_step: Callable | None = None) -> None:
        """Comes back to Python after each step, where Ctrl-C is heard, and calls after_step(t, q, p) with the library's
        own pointers. Threads other than the main one hear nothing."""
        is_main = threading.current_thread() is threading.main_thread()
        if plan.at_step or after_step is None and not is_main:
            return
        guard = self._guard

        def call(member: int, which: int, t: float, q: Any, p: Any, _: Any) -> int:
            if after_step is not None and guard.thrown is None:
                after_step(t, q, p)
            return 1 if guard.thrown is not None else 0

        callback = guard.callback("tvi_member_observer *", call, 1)
        self._callbacks.append(callback)
        plan.at_step = callback


def new_plan(way: Way, events: Any = None, tangent: Any = None) -> Any:
    """The plan without the end of its way."""
    plan = ffi.new("tvi_run_plan *")
    plan.size = ffi.sizeof("tvi_run_plan")
    plan.h, plan.tolerance, plan.largest_step = way.h, way.tolerance or 0.0, way.largest_step
    if events is not None and events.count:
        plan.events, plan.event_count = events.pointer, events.count
    if tangent is not None:
        plan.D, plan.columns = tangent.pointer, tangent.array.shape[1]
    return plan


def given_times(times: np.ndarray) -> dict[str, Any]:
    """The members of a plan that are given times."""
    return {"times": pointer(times) if len(times) else ffi.NULL, "time_count": len(times)}


class Course:
    """A run, call by call. `call()` makes what the plan says, `now()` are the times of its members, and is_cut says
    whether its steps can be counted. Calls end at multiples of `every` steps, and `after(steps)` is called after each
    of them with the steps that were counted; a true value ends the run."""

    def __init__(self, way: Way, plan: Any, call: Callable[[], int], now: Callable[[], np.ndarray], is_cut: bool,
                 after: Callable[[int], Any] | None = None, every: int = MOST_STEPS):
        self._way, self._plan, self._call, self._now = way, plan, call, now
        self._is_cut, self._after, self._every, self._made = is_cut, after or (lambda steps: False), every, 0
        self._pace = Pace()
        self._at_time = plan.at_time

    def run(self) -> int:
        """Makes the run; its last status."""
        way = self._way
        if way.steps is not None:
            return self.make_steps(way.steps) if self._is_cut else self._whole(steps=way.steps)
        if way.t_end is None:
            return self._go_through(way.times)
        return self._go_to(way.t_end, np.empty(0) if way.times is None else way.times)

    def _go_to(self, t_end: float, times: np.ndarray) -> int:
        """To t_end, and through times. Those that a step past t_end may contain are left to the last call."""
        status = OK
        if self._is_cut:
            early = int(np.sum((t_end - times) * np.sign(self._way.h) > 2 * abs(self._way.h)))
            if early:
                status, times = self._go_through(times[:early]), times[early:]
            if status == OK:
                status = self._approach(times[0] if len(times) else t_end)
        return self._whole(t_end=t_end, **given_times(times)) if status == OK else status

    def _set_end(self, steps: int = 0, t_end: float | None = None, times: Any = ffi.NULL, time_count: int = 0) -> None:
        """The library takes an observer of times only beside times."""
        plan = self._plan
        plan.steps, plan.times, plan.time_count = steps, times, time_count
        plan.has_t_end, plan.t_end = t_end is not None, t_end or 0.0
        plan.at_time = self._at_time if time_count else ffi.NULL

    def _ended(self, status: int) -> int:
        return ESTOPPED if status == OK and self._after(self._made) else status

    def _whole(self, **end: Any) -> int:
        if end.get("steps") == 0 or end == given_times(np.empty(0)):
            return OK
        self._set_end(**end)
        return self._ended(self._call())

    def make_steps(self, steps: int) -> int:
        """So many steps, in calls."""
        status, left = OK, steps
        while left > 0 and status == OK:
            few = min(left, self._pace.steps, self._every - self._made % self._every)
            self._set_end(steps=few)
            status = self._pace.timed(self._call, few)
            left -= few
            self._made += few
            status = self._ended(status)
        return status

    def _steps_before(self, t: float) -> int:
        """How many steps of each member surely end before t: all but the last ones, of which roundoff decides."""
        left = t - self._now()
        step_size("h", self._way.h, float(np.max(np.abs(left), initial=0.0)))
        rest = float(np.min(left / self._way.h, initial=np.inf))
        if rest == np.inf:  # No member goes on.
            return 0
        return int(min(math.floor(rest) - 1, 2**53)) if rest > 2 else 0

    def _approach(self, t: float) -> int:
        status = OK
        while status == OK and (steps := self._steps_before(t)) > 0:
            status = self.make_steps(steps)
        return status

    def _go_through(self, times: np.ndarray) -> int:
        """All times, in lists of those that a call reaches."""
        given, count, first, status = pointer(times), len(times), 0, OK
        if not self._is_cut or count == 0 or np.any(np.diff(times) * self._way.h < 0):
            return self._whole(**given_times(times))
        while first < count and status == OK:
            status = self._approach(times[first])
            if status != OK:
                break
            sign, piece = np.sign(self._way.h), self._pace.steps * abs(self._way.h)
            reach = float(np.min(self._now() * sign, initial=np.inf)) + piece
            last = max(first + 1, int(np.searchsorted(times * sign, reach)))
            last = min(last, first + max(1, self._pace.steps))
            self._set_end(times=given + first, time_count=last - first)
            status = self._ended(self._pace.timed(self._call, self._pace.steps))
            first = last
        return status


def advice(system: System, way: "Way | None" = None) -> str:
    """What to do where a step was too large, as the end of a text."""
    if way is not None and way.tolerance is not None:
        return ": end the run before that by a terminal event"
    return ": give a smaller h or error" + (", or system.rescaled()" if system.can_be_rescaled else "")


def ended(status: int, guard: Guard, system: System, way: Way) -> bool:
    """Whether a run went to its end; what observers have raised, and what the library refused, is raised."""
    guard.reraise()
    if status == ESTOPPED:
        return False
    is_at_rest = "before the time moves" in text_of(status)
    check(status, ": end the run before that by a terminal event" if is_at_rest else advice(system, way))
    return True
