"""Calls a user's function while the library records it: what it is given, and what it may return."""

from __future__ import annotations

import inspect
from typing import Any, Callable, Mapping

import numpy as np

from ._arrays import _floats, number
from ._jets import BRANCH, Recording, parameters
from ._library import Guard, ffi
from ._unrecorded import unrecorded

# Names that are arguments of the module's functions, and so cannot be those of parameters.
RESERVED = frozenset("n V mass system t_span q0 p0 v0 h error tolerance largest_step method order t_eval events "
                     "dense_output compiled progress gradient jacobian integrals threads members q p v t self every w0 "
                     "function g drive".split())

_REFUSED = (float("nan"), ffi.NULL)  # What the library gets where the function raised, and refuses.


# The vector, or the time, that an argument of a user's function is by its name. Others, such as x, say nothing.
_ROLES = {name: role for role, names in {
    "q": "q Q position positions coordinates", "v": "v qd qdot q_dot dq dqdt xdot velocity velocities",
    "p": "p P momentum momenta", "t": "t time"}.items() for name in names.split()}

NOT_A_PARAMETER = "a parameter cannot be called {0}, which is an argument of tvi's functions"
_STATED_ELSEWHERE = {"v": "velocities are arguments of tvi.lagrangian and of system.driven",
                     "p": "momenta are arguments of tvi.hamiltonian"}


class Function:
    """A user's function of so many vectors of the state, perhaps of t, and of parameters by keyword."""

    def __init__(self, what: str, function: Callable, vectors: str, values: Mapping[str, Any], takes_all: bool = True):
        self.what, self.function, self.values = what, function, values
        if not callable(function):
            raise TypeError(f"{what} is a function of {_calls(vectors.split())}, not {type(function).__name__}")
        self.time, self.named = _Signature(what, function, vectors.split()).read(values, takes_all)

    def __call__(self, recording: Recording, vectors: list[np.ndarray], t: Any) -> Any:
        time = recording.jet(t)
        named = parameters(recording, time, self.values)
        taken = {name: named[name] for name in self.named}
        places = list(vectors)
        if self.time is not None and self.time.kind is self.time.POSITIONAL_ONLY:
            places.append(time)
        elif self.time is not None:
            taken[self.time.name] = time
        try:
            value = self.function(*places, **taken)
        except (TypeError, AttributeError, ValueError) as error:
            if text := unrecorded(error):
                raise TypeError(text).with_traceback(error.__traceback__) from error
            raise
        if recording.has_branched:
            raise TypeError(BRANCH)
        return value


def _calls(vectors: list[str]) -> str:
    return f"({', '.join(vectors)}) or ({', '.join([*vectors, 't'])})"


class _Signature:
    """Reads which of its arguments a user's function takes the vectors, the time and parameters by."""

    def __init__(self, what: str, function: Callable, vectors: list[str]):
        self.what, self.vectors = what, vectors
        self.calls = f"{what} is called with {_calls(vectors)}"
        try:
            self.signature = inspect.signature(function)
        except (TypeError, ValueError):  # Some callables that are written in C do not say.
            self.signature = inspect.Signature([
                inspect.Parameter("vectors", inspect.Parameter.VAR_POSITIONAL),
                inspect.Parameter("parameters", inspect.Parameter.VAR_KEYWORD)])
        self.arguments = list(self.signature.parameters.values())

    def read(self, values: Mapping[str, Any], takes_all: bool) -> tuple[Any, list[str]]:
        """The argument that is the time, or None, and the names of the parameters that the function takes."""
        open_ended = any(a.kind is a.VAR_KEYWORD for a in self.arguments)
        by_name = {a.name for a in self.arguments if a.kind in (a.POSITIONAL_OR_KEYWORD, a.KEYWORD_ONLY)}
        named = [name for name in values if name in by_name or open_ended]
        missing = [name for name in values if name not in named]
        if takes_all and missing:
            raise TypeError(f"{self.what} takes no parameter {missing[0]}: its function is to have an argument of that "
                            "name")
        places = [a for a in self.arguments if a.kind in (a.POSITIONAL_ONLY, a.POSITIONAL_OR_KEYWORD)]
        count = len(self.vectors)
        self._check_places(places[:count], named)
        others = [a for a in self.arguments if a not in places[:count] and a.name not in named
                  and a.kind not in (a.VAR_POSITIONAL, a.VAR_KEYWORD)]
        time = next((a for a in others if _ROLES.get(a.name) == "t"), None)
        if time is not None and time.kind is time.POSITIONAL_ONLY and time is not places[count]:
            raise TypeError(f"{self.calls}: {time.name}, which has no keyword, stands after {self.vectors[-1]}")
        for a in others:
            if a is not time and a.default is a.empty:
                self._refuse_without_value(a.name, time is not None, takes_all)
        return time, named

    def _check_places(self, places: list, named: list[str]) -> None:
        """Refuses arguments that stand where a vector is given and are something else, by their names."""
        for a, vector in zip(places, self.vectors):
            role = _ROLES.get(a.name, vector)
            if role == "t":
                if a is not self.arguments[-1]:
                    raise TypeError(f"{self.calls}: {a.name} comes last")
                raise TypeError(f"{self.calls}, and its function takes {self.signature}: {vector} is missing before "
                                f"{a.name}")
            if role != vector or a.name in named or a.default is not a.empty and a.name not in _ROLES:
                raise TypeError(f"{self.calls}, and its function takes {self.signature}: {a.name} stands in the place "
                                f"of {vector}")
        if len(places) < len(self.vectors) and not any(a.kind is a.VAR_POSITIONAL for a in self.arguments):
            raise TypeError(f"{self.calls}, and its function takes {self.signature}")

    def _refuse_without_value(self, name: str, has_time: bool, takes_all: bool) -> None:
        role = _ROLES.get(name)
        if role in _STATED_ELSEWHERE and role not in self.vectors:
            raise TypeError(f"{self.calls}, and its function takes {self.signature}: {_STATED_ELSEWHERE[role]}")
        where = f"where {self.what} is made" if takes_all else "as a parameter of the system"
        value = f"give {name}=... {where}" if name not in RESERVED else NOT_A_PARAMETER.format(name)
        raise TypeError(f"{self.calls}, and {name} has no value: {value}"
                        f"{'' if has_time else ', or call it t if it is the time'}")


def checked_parameters(given: dict[str, Any]) -> dict[str, Any]:
    """The values of parameters by name: finite floats, or arrays of them."""
    values: dict[str, Any] = {}
    for name, value in given.items():
        if name in RESERVED:
            raise ValueError(NOT_A_PARAMETER.format(name))
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


def vector(function: Function, guard: Guard, kind: str, n: int, count: int | None = None) -> Any:
    """The callback of a function that returns n jets, or so many, which are written when all of them are known to be
    right."""

    def call(*arguments: Any) -> None:
        *vectors, t, out, _ = arguments
        recording = Recording()
        try:
            jets = [recording.jets(pointer, n) for pointer in vectors]
            values = recording.results(function(recording, jets, t), n if count is None else count, function.what)
            for i, value in enumerate(values):
                out[i] = value
        finally:
            recording.is_open = False

    return guard.callback(kind, call, None)
