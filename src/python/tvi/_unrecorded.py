"""Says what to write in the place of functions of numpy and SciPy that take no jets, and that end in texts of their own
about types."""

from __future__ import annotations

import re
from types import TracebackType

import numpy as np

_TABLE = ": a table has no power series at its points. Fit a smooth function, such as p = " \
    "np.polynomial.Polynomial.fit(x, y, 8), and write p(q[0])"
_JUMP = ": a jump has no power series. Write a smooth step, such as (1 + np.tanh(x / width)) / 2, or let a terminal " \
    "tvi.event end the run there"
_FOURIER = ": write its sums, as a matrix of numbers: np.cos(np.outer(k, x)) @ q"
_SOLVE = ": write the solution out (Cramer's rule), or state the Lagrangian, whose mass matrix the library inverts"
_PAIRS = " in an array after a number: write np.array([np.{}(a, x) for x in b])"
_OTHER = ": tvi.Jet lists the functions that do. Write it with these"

# What to write, by the name of a function, or by that of its package, which has a dot.
_INSTEAD = {
    "interp": _TABLE, "scipy.interpolate": _TABLE,
    "einsum": ": write @, np.tensordot, or sums of products",
    "scipy.sparse": ": write A.toarray() @ q, or a loop over the entries of A.tocoo()",
    "gradient": ": write np.diff, or differences of slices",
    "numpy.fft": _FOURIER, "scipy.fft": _FOURIER,
    "det": ": write it out, as q[0] * q[3] - q[1] * q[2]",
    "numpy.linalg": _SOLVE, "scipy.linalg": _SOLVE,
    "logaddexp": ": write a + np.log1p(np.exp(b - a)), with the larger one for a",
    "logsumexp": ": write np.log(np.exp(q).sum())",
    "expit": ": write 1 / (1 + np.exp(-x))",
    "cbrt": ": write x**(1 / 3) where x is positive",
    "float_power": ": write **",
    "erf": ": write tvi.erf",
    "heaviside": _JUMP, "copysign": _JUMP,
    "hypot": _PAIRS, "arctan2": _PAIRS,
    "angle": ": write np.arctan2(y, x)",
}

# What numpy and SciPy say of arrays of objects. A group is the name of a function.
_OF_OBJECTS = re.compile(r"ufunc '(\w+)'|callable (\w+) method|^'\w+' object has no attribute '(\w+)'$"
                         r"|data type for (einsum)|no supported conversion for types|object arrays are not supported"
                         r"|Cannot cast array data from dtype\('O'\)|^a jet has no value yet")


def unrecorded(error: Exception) -> str | None:
    """The text for what a user's function has raised, or None where that is not about a function that takes no jets."""
    told = _OF_OBJECTS.search(str(error))
    if not told:
        return None
    named = next((name for name in told.groups() if name), "")
    package, name = _called(error.__traceback__)
    if not package and named not in _INSTEAD and not str(error).startswith(("ufunc", "loop of ufunc")):
        return None
    name = name or named
    instead = _INSTEAD.get(name) or _INSTEAD.get(named) or _INSTEAD.get(package, _OTHER)
    is_of_scipy = package.startswith("scipy") and name not in _INSTEAD
    folder = package[len("numpy."):] + "." if package in ("numpy.linalg", "numpy.fft") else ""
    of_numpy = f"np.{folder}{name}" if folder or hasattr(np, name) else name
    return f"{package if is_of_scipy else of_numpy} takes no jets{instead.format(name)}"


def _called(traceback: TracebackType | None) -> tuple[str, str]:
    """The package and the name of the first function of numpy or SciPy in a traceback; empty where there is none."""
    while traceback:
        frame = traceback.tb_frame
        package = str(frame.f_globals.get("__name__")).split(".")
        if package[0] in ("numpy", "scipy") and package[-1] != "overrides":  # which only passes arguments on
            return ".".join(package[:2]), frame.f_code.co_name
        traceback = traceback.tb_next
    return "", ""
