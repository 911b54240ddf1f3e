"""Jets: what a user's function computes with while it is recorded, and the recording itself."""

from __future__ import annotations

import math
import threading
from typing import Any, Callable, Mapping

import numpy as np

from ._library import ffi, lib

_KEPT = "a jet lives as long as the call that received it: this one was kept after its function had returned"
BRANCH = ("a branch on the value of a jet cannot be recorded: the function is called once, without numbers. Write a "
          "smooth function, or let a terminal tvi.event end the run where the branch changes. Loops and branches on "
          "ordinary numbers are fine")
_NUMBER = ("a jet has no value yet: the function is called once, without numbers. Write np.sin, not math.sin. Where "
           "an array is filled, return a list, or fill np.empty(n, object) and not np.zeros(n)")
_COMPLEX = ("jets are real, not complex: write real and imaginary parts, such as np.cos(x) and np.sin(x) for "
            "np.exp(1j * x)")


class Miscounted(ValueError):
    """Carries how many components a function has returned, where another number was expected."""

    def __init__(self, text: str, count: int):
        super().__init__(text)
        self.count = count


class Recording:
    """One call of a user's function. Its jets can be used while it is open, by the thread that is called."""

    def __init__(self) -> None:
        self.is_open = True
        self.has_branched = False
        self.thread = threading.get_ident()

    def jet(self, value: Any) -> "Jet":
        """The structure is copied, as that of the library does not outlive the call."""
        return Jet(ffi.new("jet *", (value.number, value.node))[0], self)

    def jets(self, pointer: Any, count: int) -> np.ndarray:
        array = np.empty(count, dtype=object).view(Jets)
        for i in range(count):
            array[i] = self.jet(pointer[i])
        return array

    def operand(self, value: Any) -> Any:
        """A jet of this recording, or a finite number, as the library takes it; None where the value is neither."""
        if isinstance(value, Jet):
            if not value._recording.is_open:
                raise ValueError(_KEPT)
            if value._recording is not self:
                raise ValueError("jets of two functions are mixed: each call has jets of its own")
            if threading.get_ident() != self.thread:
                raise ValueError("a jet is used on another thread than the one that its function was called on")
            return value._value
        if isinstance(value, (int, float, np.integer, np.floating)):
            x = float(value)
            if not math.isfinite(x):
                raise ValueError(f"a jet is combined with {x}, which is not finite")
            return (x, ffi.NULL)
        if isinstance(value, (complex, np.complexfloating)):
            raise TypeError(_COMPLEX)
        if isinstance(value, np.ndarray) and value.ndim == 0:
            return self.operand(value[()])
        return None

    def result(self, value: Any, what: str) -> Any:
        """What the function has returned as one jet."""
        operand = self.operand(value)
        if operand is None:
            kind = f"an array of shape {value.shape}" if isinstance(value, np.ndarray) else type(value).__name__
            raise TypeError(f"{what} returned {kind}, not one jet or number")
        return operand

    def results(self, values: Any, count: int, what: str) -> list:
        """What the function has returned as so many jets."""
        try:
            items = list(values)
        except TypeError:
            raise TypeError(f"{what} returned {type(values).__name__}, not a list of jets or numbers") from None
        if len(items) != count:
            raise Miscounted(f"{what} returned {len(items)} components, not {count}", len(items))
        return [self.result(item, f"component {i} of what {what}") for i, item in enumerate(items)]


def _binary(function: Callable, is_reversed: bool = False) -> Callable:
    def operation(self: "Jet", other: Any) -> Any:
        recording = self._recording
        a, b = recording.operand(self), recording.operand(other)
        if b is None:
            return NotImplemented
        return Jet(function(b, a) if is_reversed else function(a, b), recording)

    return operation


def _unary(code: int) -> Callable:
    def operation(self: "Jet") -> "Jet":
        return Jet(lib.jet_record_function(code, self._recording.operand(self)), self._recording)

    return operation


def _branch(self: "Jet", *others: Any) -> Any:
    """numpy takes what == raises for False (up to 1.24): so it is remembered, too."""
    self._recording.has_branched = True
    raise TypeError(BRANCH)


def _refuse(kind: type, text: str) -> Callable:
    def operation(self: "Jet", *others: Any) -> Any:
        raise kind(text)

    return operation


class Jet:
    """A quantity that depends on the state: what functions of the state receive, compute with and return.

    It has + - * / **, and numpy's functions: sqrt, square, exp, log, sin, cos, tan, arcsin, arccos, arctan, arctan2,
    hypot, sinh, cosh, tanh, arcsinh, arccosh, arctanh, exp2, expm1, log2, log10, log1p; tvi.erf is one more. Arrays of
    jets are numpy's arrays of objects: sums, slices, @ and np.dot, np.cross, np.linalg.norm record what they compute.
    A jet lives as long as the call that received it, and has no value: a comparison, float() and bool() raise.

    >>> import numpy as np, tvi
    >>> pendulum = tvi.potential(1, lambda q: -9.8 * np.cos(q[0]))
    >>> tvi.potential(1, lambda q: q[0] if q[0] > 0 else -q[0])
    Traceback (most recent call last):
    TypeError: a branch on the value of a jet cannot be recorded: the function is called once, without numbers. Write \
a smooth function, or let a terminal tvi.event end the run where the branch changes. Loops and branches on ordinary \
numbers are fine
    """

    __slots__ = ("_value", "_recording")

    def __init__(self, value: Any, recording: Recording):
        self._value = value
        self._recording = recording

    __add__ = _binary(lib.jet_record_add)
    __radd__ = _binary(lib.jet_record_add, True)
    __sub__ = _binary(lib.jet_record_sub)
    __rsub__ = _binary(lib.jet_record_sub, True)
    __mul__ = _binary(lib.jet_record_mul)
    __rmul__ = _binary(lib.jet_record_mul, True)
    __truediv__ = _binary(lib.jet_record_div)
    __rtruediv__ = _binary(lib.jet_record_div, True)
    __neg__ = _unary(0)

    def __pos__(self) -> "Jet":
        return self

    def __pow__(self, exponent: Any) -> Any:
        """x ** c for a number c; of two jets exp(exponent log x), x > 0."""
        if isinstance(exponent, Jet):
            return (exponent * self.log()).exp()
        c = self._recording.operand(exponent)
        if c is None:
            return NotImplemented
        return Jet(lib.jet_record_pow(self._recording.operand(self), c[0]), self._recording)

    def __rpow__(self, base: Any) -> Any:
        """b ** x for a number b > 0."""
        b = self._recording.operand(base)
        if b is None:
            return NotImplemented
        if b[0] <= 0:
            raise ValueError(f"{b[0]} ** jet has no power series: the base is to be positive")
        return (self * math.log(b[0])).exp()

    # numpy calls these by their names for the elements of an array of objects.
    square = _unary(1)
    sqrt, exp, log, sin, cos, tan = map(_unary, range(2, 8))
    arcsin, arccos, arctan, sinh, cosh, tanh, arcsinh, arccosh, arctanh = map(_unary, range(8, 17))
    _erf = _unary(17)

    def arctan2(self, x: Any) -> "Jet":
        return _of_two(0, self, x)

    def hypot(self, other: Any) -> "Jet":
        return _of_two(1, self, other)

    def radians(self) -> "Jet":
        return self * (math.pi / 180)

    def degrees(self) -> "Jet":
        return self * (180 / math.pi)

    deg2rad, rad2deg = radians, degrees

    def exp2(self) -> "Jet":
        return (self * math.log(2)).exp()

    def expm1(self) -> "Jet":
        return 2 * (self / 2).exp() * (self / 2).sinh()

    def log2(self) -> "Jet":
        return self.log() / math.log(2)

    def log10(self) -> "Jet":
        return self.log() / math.log(10)

    def log1p(self) -> "Jet":
        return 2 * (self / (self + 2)).arctanh()

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        """numpy's functions where a jet is an argument by itself, not in an array."""
        return _of_arrays(ufunc, method, inputs, options)

    __bool__ = __lt__ = __le__ = __gt__ = __ge__ = __eq__ = __ne__ = _branch
    __float__ = __int__ = _refuse(TypeError, _NUMBER)
    __complex__ = _refuse(TypeError, _COMPLEX)
    __floordiv__ = __rfloordiv__ = __mod__ = __rmod__ = __divmod__ = __round__ = __floor__ = __ceil__ = __trunc__ = \
        floor = ceil = trunc = rint = fmod = _refuse(TypeError, "rounding, // and % have no power series to record")
    __abs__ = fabs = absolute = \
        _refuse(TypeError, "abs() of a jet has no power series at 0: write np.sqrt(x**2) where it never is 0")
    __reduce__ = _refuse(TypeError, _KEPT)
    __hash__ = object.__hash__

    def conjugate(self) -> "Jet":
        return self

    def __repr__(self) -> str:
        return "<jet>" if self._recording.is_open else "<jet whose function has returned>"


def _of_two(code: int, a: Any, b: Any) -> Jet:
    recording = next(x for x in (a, b) if isinstance(x, Jet))._recording
    first, second = recording.operand(a), recording.operand(b)
    if first is None or second is None:
        raise TypeError(f"a jet is combined with {type(b if second is None else a).__name__}")
    return Jet(lib.jet_record_function2(code, first, second), recording)


class Jets(np.ndarray):
    """An array of jets that a function receives: one of numpy's, whose arctan2 and hypot take numbers, too. What is
    computed of it is one, too."""

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        return _of_arrays(ufunc, method, inputs, options)


def _of_arrays(ufunc: Any, method: str, inputs: tuple, options: dict[str, Any]) -> Any:
    """A function of numpy by numpy's own loop over arrays of objects."""
    out = options.get("out")
    if out:
        options["out"] = tuple(_as_array(x) for x in out)
    value = getattr(_OF_TWO.get(ufunc, ufunc), method)(*(_as_array(x) for x in inputs), **options)
    if out:
        return out[0]
    return value.view(Jets) if isinstance(value, np.ndarray) and value.dtype == object else value


def _as_array(x: Any) -> Any:
    """The same, and where it is a jet or jets an array of numpy's own class."""
    if isinstance(x, Jet):
        array = np.empty((), dtype=object)
        array[()] = x
        return array
    return x.view(np.ndarray) if isinstance(x, Jets) else x


def _each(code: int, function: Callable) -> Callable:
    """The function of two, element by element, where either may be a number."""
    return np.frompyfunc(lambda a, b: _of_two(code, a, b) if isinstance(a, Jet) or isinstance(b, Jet)
                         else function(a, b), 2, 1)


_OF_TWO = {np.arctan2: _each(0, math.atan2), np.hypot: _each(1, math.hypot)}


def erf(x: Any) -> Any:
    """The error function 2/sqrt(pi) integral_0^x exp(-s^2) ds of a jet, a number, or an array of these.

    >>> round(erf(0.5), 12)
    0.520499877813
    """
    if isinstance(x, Jet):
        return x._erf()
    return np.frompyfunc(erf, 1, 1)(x) if np.ndim(x) else math.erf(x)


def parameters(recording: Recording, of: Jet, values: Mapping[str, Any]) -> dict[str, Any]:
    """The parameters by name as jets: one for a number, an array of jets for an array. Their indices count on."""
    named, index = {}, 0
    for name, value in values.items():
        array = np.empty(np.shape(value), dtype=object).view(Jets)
        for place in np.ndindex(array.shape):
            jet = lib.jet_parameter(of._value, index, float(np.asarray(value)[place]))
            array[place] = Jet(jet, recording)
            index += 1
        named[name] = array[()]
    return named
