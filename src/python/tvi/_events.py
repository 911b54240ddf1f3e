"""Events: functions of the state that reach 0 or change their sign."""

from __future__ import annotations

from typing import Any, Callable, Iterable, NamedTuple

import numpy as np

from ._functions import Function, scalar
from ._library import Guard, Handle, ffi, lib, make
from ._systems import System

FALLING, EITHER, RISING = -1, 0, 1


class Event:
    """What tvi.event makes: a function of the state with its direction, whether it ends a run, and what it calls."""

    def __init__(self, g: Callable, direction: int, terminal: bool, callback: Callable | None = None):
        self.g, self.direction, self.terminal, self.callback = g, direction, terminal, callback

    def __repr__(self) -> str:
        called = "" if self.callback is None else f", callback={self.callback!r}"
        return f"tvi.event({self.g!r}, direction={self.direction}, terminal={self.terminal}{called})"


def event(g: Callable, direction: int = 0, terminal: bool = False, callback: Callable | None = None) -> Event:
    """An event: where g(q, p) or g(q, p, t), in jets, reaches 0 or changes its sign along a run.

    direction: 1 where g rises along the run, -1 where it falls, 0 both. terminal: the run ends there. g may take
    parameters of the system by keyword. A plain function with the attributes `direction` and `terminal`, as those of
    SciPy's solve_ivp, serves wherever an event does. Raises ValueError for what is no direction.

    callback(t, q, p): called by tvi.solve at each event with copies of the state. It returns the momenta p [n] with
    which the run goes on, such as those after a bounce or a kick; None leaves p as it is. If the event is terminal, the
    run ends with them, and where it raises StopIteration without them. A sign that g changes by a callback is not seen:
    it did not change along the orbit. Such a run takes h or a tolerance, and no error=.

    >>> import numpy as np, tvi
    >>> kepler = tvi.potential(2, lambda q: -1 / np.sqrt(q @ q))
    >>> closest = tvi.event(lambda q, p: q @ p, direction=1)
    >>> found = tvi.solve(kepler, (0, 10), [1, 0], [0, 0.8], h=0.1, events=closest).events[0]
    >>> found.t.round(6)
    array([1.980804, 5.942412, 9.90402 ])
    >>> fall = tvi.potential(1, lambda q: 9.8 * q[0])
    >>> floor = tvi.event(lambda q, p: q[0], direction=-1, callback=lambda t, q, p: -0.5 * p)
    >>> tvi.solve(fall, (0, 0.8), [1], p0=0, h=0.1, events=floor).events[0].t.round(6)
    array([0.451754])
    """
    return _event("an event", g, direction, terminal, callback)


def _event(what: str, g: Any, direction: Any, terminal: Any, callback: Any = None) -> Event:
    if not callable(g):
        raise TypeError(f"{what} is a function of (q, p) or (q, p, t), not {type(g).__name__}")
    if direction not in (FALLING, EITHER, RISING):
        raise ValueError(f"direction is -1, 0 or 1, not {direction!r}")
    if terminal not in (False, True):
        raise ValueError(f"terminal is True or False, not {terminal!r}: a run ends at the first event")
    if callback is not None and not callable(callback):
        raise TypeError(f"callback is a function of (t, q, p) that returns p, not {type(callback).__name__}")
    return Event(g, int(direction), bool(terminal), callback)


def events_of(given: Any, may_call: bool = False) -> list[Event]:
    """One event or several, each as tvi.event makes it or a function with attributes; with callbacks, if they may
    have some."""
    if not isinstance(given, Event) and not callable(given) and not isinstance(given, Iterable):
        raise TypeError(f"events is a function of (q, p) or (q, p, t), or a list of them, not {type(given).__name__}")
    several = list(given) if isinstance(given, Iterable) else [given]
    events = [x if isinstance(x, Event) else
              _event(f"event {i}", x, getattr(x, "direction", 0), getattr(x, "terminal", False))
              for i, x in enumerate(several)]
    if not may_call and any(x.callback for x in events):
        raise TypeError("callbacks are for tvi.solve: here let a terminal event end the run, change p, and go on")
    return events


class Recorded:
    """The events of one run, recorded for the system."""

    def __init__(self, system: System, events: list[Event]):
        self._handles = []
        self.count = len(events)
        for index, one in enumerate(events):
            guard = Guard()
            function = Function(f"event {index}", one.g, "q p", system.parameters, takes_all=False)
            callback = scalar(function, guard, "tvi_event_fn *", system.n)
            stops = one.terminal or one.callback is not None  # The run goes on when p has changed.
            made = make("tvi_event", lambda out: lib.tvi_event_create(out, system.n, one.direction, stops, callback,
                                                                      ffi.NULL), guard)
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
