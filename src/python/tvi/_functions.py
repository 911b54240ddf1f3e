"""Calls a user's function while the library records it: what it is given, and what it may return."""

from __future__ import annotations

import inspect
from typing import Any, Callable, Mapping

import numpy as np

from ._arrays import _floats, number
from ._jets import BRANCH, Recording, parameters
from ._library import Guard, ffi

# Names that are arguments of the module's functions, and so cannot be those of parameters.
RESERVED = frozenset("n V mass system t_span q0 p0 v0 h error tolerance method order t_eval events dense_output "
                     "compiled progress threads members q p v t self every w0 function g drive".split())

_REFUSED = (float("nan"), ffi.NULL)  # What the library gets where the function raised, and refuses.


class Function:
    """A user's function of so many vectors of the state, perhaps of t, and of parameters by keyword."""

    def __init__(self, what: str, function: Callable, vectors: str, values: Mapping[str, Any], takes_all: bool = True):
        if not callable(function):
            raise TypeError(f"{what} is a function of {vectors} and t, not {type(function).__name__}")
        self.what, self.function, self.values = what, function, values
        self.with_time, self.named = _signature(what, function, vectors.split(), values, takes_all)

    def __call__(self, recording: Recording, vectors: list[np.ndarray], t: Any) -> Any:
        time = recording.jet(t)
        named = parameters(recording, time, self.values)
        taken = {name: named[name] for name in self.named}
        value = self.function(*vectors, *([time] if self.with_time else []), **taken)
        if recording.has_branched:
            raise TypeError(BRANCH)
        return value


def _signature(what: str, function: Callable, vectors: list[str], values: Mapping[str, Any],
               takes_all: bool) -> tuple[bool, list[str]]:
    """Whether the function takes t after its vectors, and which of the parameters."""
    try:
        arguments = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):  # Some callables that are written in C do not say.
        return True, list(values)
    open_ended = any(a.kind is a.VAR_KEYWORD for a in arguments)
    by_name = {a.name for a in arguments if a.kind in (a.POSITIONAL_OR_KEYWORD, a.KEYWORD_ONLY)}
    named = [name for name in values if name in by_name or open_ended]
    missing = [name for name in values if name not in named]
    if takes_all and missing:
        raise TypeError(f"{what} takes no parameter {missing[0]}: its function is to have an argument of that name")
    places = [a for a in arguments if a.kind in (a.POSITIONAL_ONLY, a.POSITIONAL_OR_KEYWORD) and a.name not in named]
    needed = [a for a in places if a.default is a.empty]
    if places and places[0].name == "t":
        raise TypeError(f"{what} is called with ({', '.join(vectors)}, t): t comes last")
    count, is_open = len(vectors), any(a.kind is a.VAR_POSITIONAL for a in arguments)
    with_time = is_open or len(needed) > count or len(places) > count and places[count].name == "t"
    if len(needed) > count + 1 or len(places) < count and not is_open:
        raise TypeError(f"{what} is called with ({', '.join(vectors)}) or ({', '.join(vectors)}, t)"
                        f"{' and ' + ', '.join(named) if named else ''}, and its function takes "
                        f"({', '.join(a.name for a in arguments)})")
    for a in arguments:
        if a.kind is a.KEYWORD_ONLY and a.default is a.empty and a.name not in named:
            raise TypeError(f"{what} has an argument {a.name}, and no parameter of that name is given")
    return with_time, named


def checked_parameters(given: dict[str, Any]) -> dict[str, Any]:
    """The values of parameters by name: finite floats, or arrays of them."""
    values: dict[str, Any] = {}
    for name, value in given.items():
        if name in RESERVED:
            raise ValueError(f"a parameter cannot be called {name}, which is an argument of tvi's functions")
        array = _floats(name, value)
        array.flags.writeable = False
        values[name] = array if array.ndim else number(name, value)
    if sum(np.size(value) for value in values.values()) > 1000:
        raise ValueError("a system has at most 1000 parameters")
    return values


def scalar(function: Function, guard: Guard, kind: str, n: int) -> Any:
    """The callback of a function that returns one jet."""

    def call(*arguments: Any) -> Any:
        *vectors, t, _ = arguments
        recording = Recording()
        try:
            jets = [recording.jets(pointer, n) for pointer in vectors]
            value = recording.result(function(recording, jets, t), function.what)
            return value if isinstance(value, tuple) else (value.number, value.node)
        finally:
            recording.is_open = False

    return guard.callback(kind, call, _REFUSED)


def vector(function: Function, guard: Guard, kind: str, n: int) -> Any:
    """The callback of a function that returns n jets, which are written when all of them are known to be right."""

    def call(*arguments: Any) -> None:
        *vectors, t, out, _ = arguments
        recording = Recording()
        try:
            jets = [recording.jets(pointer, n) for pointer in vectors]
            values = recording.results(function(recording, jets, t), n, function.what)
            for i, value in enumerate(values):
                out[i] = value
        finally:
            recording.is_open = False

    return guard.callback(kind, call, None)
