"""Checks the numbers that go to the library, and keeps them in memory that no one can resize."""

from __future__ import annotations

import math
import operator
import sys
from typing import Any

import numpy as np

from ._library import ffi

MOST_STEPS = 2**63 - 1
Array = Any  # a number, or what numpy takes for an array of real numbers: arrays, lists, tuples


def integer(name: str, value: Any, least: int, most: int = 2**31 - 1) -> int:
    """The value as an int from least to most."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is a whole number, not {type(value).__name__}") from None
    if not least <= number <= most:
        raise ValueError(f"{name} = {number} is not from {least} to {most}")
    return number


def number(name: str, value: Any) -> float:
    """The value as a finite float; strings and arrays of several numbers are none."""
    array = _floats(name, value)
    if array.size != 1:
        raise ValueError(f"{name} is one number, and has the shape {array.shape}")
    return array.item()


def step_size(name: str, value: Any, duration: float = 0.0) -> float:
    """The value as a step with which a run of this duration can end: neither 0 nor far below it."""
    h = number(name, value)
    if h == 0:
        raise ValueError(f"{name} is 0")
    if abs(h) < sys.float_info.min:
        raise ValueError(f"{name} = {h} is below {sys.float_info.min:.2g}, the least number with all digits")
    if abs(duration) > MOST_STEPS * abs(h):
        raise ValueError(f"{name} = {h} is too small: a run of {abs(duration):.6g} takes more than 2^63 steps of it")
    return h


def fraction(name: str, value: Any) -> float:
    """The value as a relative error or tolerance."""
    x = number(name, value)
    if not sys.float_info.epsilon <= x < 1:
        raise ValueError(f"{name} = {x} is not from 2.2e-16 to below 1")
    return x


def _floats(name: str, value: Any, may_be_infinite: bool = False) -> np.ndarray:
    try:
        array = np.asarray(value)
    except ValueError:
        raise ValueError(f"{name} has rows of different lengths") from None
    if array.dtype.kind not in "fiub":
        try:  # Python's integers of any size, fractions, decimals, but no text and no complex number
            if array.dtype.kind != "O" or any(x is None or isinstance(x, (str, bytes)) for x in array.flat):
                raise TypeError
            array = array.astype(float)
        except (TypeError, ValueError, OverflowError):
            kind = array.dtype if array.dtype.kind != "O" else type(value).__name__
            raise TypeError(f"{name} has real numbers, not {kind}") from None
    array = np.array(array, dtype=np.float64, order="C")
    bad = np.argwhere(np.isnan(array) if may_be_infinite else ~np.isfinite(array))
    if len(bad):
        place = ", ".join(map(str, bad[0]))
        raise ValueError(f"{name}{place and f'[{place}]'} = {array[tuple(bad[0])]} is not finite")
    return array


def numbers(name: str, value: Any, *shape: "int | None", hint: str = "") -> np.ndarray:
    """A copy of the value as finite doubles in C order, of this shape; None stands for any length. The text for another
    shape ends with the hint."""
    array = _floats(name, value)
    if len(array.shape) != len(shape) or any(want not in (None, have) for want, have in zip(shape, array.shape)):
        _refuse_shape(name, array.shape, shape, hint)
    return array


def spread(name: str, value: Any, *shape: int, hint: str = "") -> np.ndarray:
    """As numbers(), where a single number, or one row for all, stands for all of them."""
    array = _floats(name, value)
    if array.shape != shape[len(shape) - array.ndim:]:
        _refuse_shape(name, array.shape, shape, hint)
    return np.array(np.broadcast_to(array, shape), order="C")


def _refuse_shape(name: str, shape: tuple, wanted: tuple, hint: str) -> None:
    words = ["any" if length is None else str(length) for length in wanted]
    text = f"({', '.join(words)}{',' if len(words) == 1 else ''})"
    raise ValueError(f"{name} has the shape {shape}, not {text}{hint and ': ' + hint}")


def pointer(array: np.ndarray) -> Any:
    """Where the library reads the doubles of a C-contiguous array, which lives at least as long as this."""
    return ffi.from_buffer("double[]", array, require_writable=False)


class Doubles:
    """Zeros that the library writes to: `pointer` for it, `array` for Python, which does not own its memory and so
    cannot be resized."""

    def __init__(self, *shape: int):
        size = math.prod(shape)
        self.pointer = ffi.new("double[]", max(size, 1))
        self.array = np.frombuffer(ffi.buffer(self.pointer), dtype=np.float64, count=size).reshape(shape)


def copied(pointer: Any, count: int) -> np.ndarray:
    """A copy of doubles that the library shows to an observer."""
    return np.frombuffer(ffi.buffer(pointer, 8 * count), dtype=np.float64).copy()
