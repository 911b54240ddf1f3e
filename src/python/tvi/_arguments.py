"""Answers to arguments that are called otherwise elsewhere, such as SciPy's rtol and y0, and to starts that are missing
or have another shape."""

from __future__ import annotations

import functools
import inspect
from typing import Any, Callable, TypeVar

import numpy as np

from ._arrays import numbers, spread
from ._functions import RESERVED
from ._systems import System

_Call = TypeVar("_Call", bound=Callable[..., Any])

# What serves instead of the arguments of SciPy, DifferentialEquations.jl, REBOUND and heyoka.
_COUNTERPARTS = {name: text for names, text in {
    "rtol atol reltol abstol tol eps": "error= of tvi.solve is the wanted error at the end, tolerance= that of each "
                                       "step of \"taylor\"",
    "y0 x0 u0 z0 state": "the start is q0= and p0= or v0= of tvi.solve, q= and p= or v= of tvi.Integrator",
    "fun func f rhs": "the first argument is a system, as tvi.potential and its like make it of a function",
    "tspan t0 t1 tf tmax tfinal": "t_span=(t, t_end) of tvi.solve, t= of tvi.Integrator and t_end= of its runs",
    "max_step dtmax hmax": "h= is the step itself, and largest_step= bounds those of error= and tolerance=",
    "min_step first_step dt dtmin hmin step stepsize step_size": "h= is the step",
    "args params": "parameters are given by their names, as k=2.0",
    "jac jacobian Dfun": "derivatives are recorded with the function, and none are given",
    "solver integrator alg": "method= is the method",
    "saveat": "t_eval= of tvi.solve, times= of runs",
    "callback callbacks": "events= and the observers of run()",
    "dense": "dense_output=True of tvi.solve",
    "workers n_jobs processes": "threads= of ensembles",
}.items() for name in names.split()}


def answered(function: _Call) -> _Call:
    """The function, which refuses arguments of other libraries, and of other functions of this one, by saying what
    serves instead. Parameters of the system may have any of these names."""
    own = [name for name in inspect.signature(function).parameters if name not in ("self", "parameters", "observers")]
    called = function.__qualname__.replace(".__init__", "")

    @functools.wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        systems = [x for x in (*arguments, named.get("system")) if isinstance(x, System)]
        for name in named:
            if name in own or systems and name in systems[0].parameters:
                continue
            if name in _COUNTERPARTS:
                raise TypeError(f"{called} has no argument {name}: {_COUNTERPARTS[name]}")
            if name in RESERVED:
                raise TypeError(f"{called} has no argument {name}: it has {', '.join(own)}")
        return function(*arguments, **named)

    return call  # type: ignore[return-value]


def _require_one(names: list[str], p: Any, v: Any) -> None:
    if p is None and v is None:
        raise TypeError(f"{names[1]} is missing: {names[1]}=0 for rest, or {names[2]}=... where you have velocities")
    if p is not None and v is not None:
        raise TypeError(f"give momenta {names[1]} or velocities {names[2]}, not both")


def start_of_one(names: str, system: System, q: Any, p: Any, v: Any) -> tuple:
    """The start of one orbit as arrays [n], and None for p or v. 0 stands for rest."""
    called, n = names.split(), system.n
    _require_one(called, p, v)
    hint = "tvi.ensemble and tvi.Ensemble have one row for each of many orbits" if _dimensions(q) == 2 else ""
    q = numbers(called[0], q, n, hint=hint)
    return (q, *(None if x is None else np.zeros(n) if np.isscalar(x) and x == 0 else numbers(name, x, n)
                 for name, x in zip(called[1:], (p, v))))


def _dimensions(x: Any) -> int:
    try:
        return np.ndim(x)
    except ValueError:  # of rows of different lengths
        return 0


def starts_of_many(names: str, system: System, members: "int | None", q: Any, p: Any, v: Any, others: list) -> tuple:
    """The number of members, and their starts as arrays [member, n], None for p or v. A number, or one row, stands for
    all. `others` are further values of members, each with the number of its dimensions."""
    called = names.split()
    _require_one(called, p, v)
    given = [(q, 2), (p, 2), (v, 2), *others]
    counts = {len(x) for x, dimensions in given if x is not None and _dimensions(x) == dimensions}
    count = members or max(counts, default=1)
    return (count, *(None if x is None and name != called[0] else spread(name, x, count, system.n)
                     for name, x in zip(called, (q, p, v))))
