"""Events: functions of the state that reach 0 or change their sign."""

from __future__ import annotations

from typing import Any, Callable, Iterable, NamedTuple

import numpy as np

from ._functions import Function, scalar
from ._library import Guard, Handle, ffi, lib, make
from ._systems import System

FALLING, EITHER, RISING = -1, 0, 1


class Event:
    """What tvi.event makes: a function of the state with its direction, and whether it ends a run."""

    def __init__(self, g: Callable, direction: int, terminal: bool):
        self.g, self.direction, self.terminal = g, direction, terminal

    def __repr__(self) -> str:
        return f"tvi.event({self.g!r}, direction={self.direction}, terminal={self.terminal})"


def event(g: Callable, direction: int = 0, terminal: bool = False) -> Event:
    """An event: where g(q, p) or g(q, p, t), in jets, reaches 0 or changes its sign along a run.

    direction: 1 where g rises along the run, -1 where it falls, 0 both. terminal: the run ends there. g may take
    parameters of the system by keyword. A plain function with the attributes `direction` and `terminal`, as those of
    SciPy's solve_ivp, serves wherever an event does. Raises ValueError for what is no direction.

    >>> import numpy as np, tvi
    >>> kepler = tvi.potential(2, lambda q: -1 / np.sqrt(q @ q))
    >>> closest = tvi.event(lambda q, p: q @ p, direction=1)
    >>> found = tvi.solve(kepler, (0, 10), [1, 0], [0, 0.8], h=0.1, events=closest).events[0]
    >>> found.t.round(6)
    array([1.980804, 5.942412, 9.90402 ])
    """
    return _event("an event", g, direction, terminal)


def _event(what: str, g: Any, direction: Any, terminal: Any) -> Event:
    if not callable(g):
        raise TypeError(f"{what} is a function of (q, p) or (q, p, t), not {type(g).__name__}")
    if direction not in (FALLING, EITHER, RISING):
        raise ValueError(f"direction is -1, 0 or 1, not {direction!r}")
    if terminal not in (False, True):
        raise ValueError(f"terminal is True or False, not {terminal!r}: a run ends at the first event")
    return Event(g, int(direction), bool(terminal))


def events_of(given: Any) -> list[Event]:
    """One event or several, each as tvi.event makes it or a function with attributes."""
    if not isinstance(given, Event) and not callable(given) and not isinstance(given, Iterable):
        raise TypeError(f"events is a function of (q, p) or (q, p, t), or a list of them, not {type(given).__name__}")
    several = list(given) if isinstance(given, Iterable) else [given]
    return [x if isinstance(x, Event) else
            _event(f"event {i}", x, getattr(x, "direction", 0), getattr(x, "terminal", False))
            for i, x in enumerate(several)]


class Recorded:
    """The events of one run, recorded for the system."""

    def __init__(self, system: System, events: list[Event]):
        self._handles = []
        self.count = len(events)
        for index, one in enumerate(events):
            guard = Guard()
            function = Function(f"event {index}", one.g, "q p", system.parameters, takes_all=False)
            callback = scalar(function, guard, "tvi_event_fn *", system.n)
            made = make("tvi_event", lambda out: lib.tvi_event_create(out, system.n, one.direction, one.terminal,
                                                                      callback, ffi.NULL), guard)
            self._handles.append(Handle(made, lib.tvi_event_free).own(self))
        self.pointer = ffi.new("const tvi_event *[]", [handle.pointer for handle in self._handles]) \
            if events else ffi.NULL

    def __del__(self) -> None:
        for handle in self._handles:
            handle.release(self)


class Found(NamedTuple):
    """The events of one function: their times t[k], states q[k, n] and p[k, n], and of an ensemble the member[k]."""

    t: np.ndarray
    q: np.ndarray
    p: np.ndarray
    member: np.ndarray


def found(told: list[tuple], n: int, count: int) -> list[Found]:
    """What was told, (which, member, t, q, p), by function."""
    several = []
    for which in range(count):
        rows = [row for row in told if row[0] == which]
        several.append(Found(np.array([row[2] for row in rows], dtype=float),
                             np.array([row[3] for row in rows], dtype=float).reshape(-1, n),
                             np.array([row[4] for row in rows], dtype=float).reshape(-1, n),
                             np.array([row[1] for row in rows], dtype=int)))
    return several
