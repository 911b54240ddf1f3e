"""What integrators and ensembles have alike: what they are made of, counts, texts of states, and who may use them."""

from __future__ import annotations

import threading
import warnings
from contextlib import contextmanager
from typing import Any, Callable, Iterator, NamedTuple

import numpy as np

from ._arrays import Doubles
from ._library import Handle, check, ffi, lib
from ._methods import Method, method_of
from ._systems import System, required_system


class Made:
    """What is made of a system and a method: it keeps both, and lets go of what the library has of them."""

    _handle: Handle
    _system: Handle

    def _make_of(self, system: System, method: "str | Method", order: int) -> None:
        self._made_of = required_system(system), method_of(method, order)

    def __del__(self) -> None:
        for name in ("_handle", "_system"):  # Where making it failed, one of them is not there.
            if handle := self.__dict__.get(name):
                handle.release(self)

    @property
    def system(self) -> System:
        return self._made_of[0]

    @property
    def method(self) -> Method:
        return self._made_of[1]


class Stats(NamedTuple):
    """Counts since an integrator or an ensemble was made; include/tvi.h says what each is."""

    steps: int
    passes: int
    expansions: int
    force_evaluations: int
    factorisations: int
    residual: float
    tail: float
    largest_tail: float
    largest_defect: float
    bytes: int
    is_compiled: bool


def stats_of(stats: Any) -> Stats:
    return Stats(*(getattr(stats, name) for name in Stats._fields))


class Busy:
    """Lets one thread at a time use an object, and no run begin inside of a run's observers."""

    def __init__(self, what: str):
        self._what = what
        self._lock = threading.RLock()
        self._is_running = False

    @contextmanager
    def asked(self) -> Iterator[None]:
        if not self._lock.acquire(blocking=False):
            raise RuntimeError(f"the {self._what} is in use by another thread")
        try:
            yield
        finally:
            self._lock.release()

    @contextmanager
    def running(self) -> Iterator[None]:
        with self.asked():
            if self._is_running:
                raise RuntimeError(f"the {self._what} is in a run, and its observers may not change its state")
            self._is_running = True
            try:
                yield
            finally:
                self._is_running = False


def written(write: Callable, *of: Any) -> bytes:
    """The text of a state."""
    size = ffi.new("size_t *")
    check(write(*of, ffi.NULL, size))
    buffer = ffi.new("char[]", size[0])
    check(write(*of, buffer, size))
    return ffi.buffer(buffer, size[0])[:]


def encoded(text: Any) -> bytes:
    """The characters of a state as text."""
    if isinstance(text, str):
        return text.encode()
    if not isinstance(text, (bytes, bytearray, memoryview, np.ndarray)):
        raise TypeError(f"text is a string or bytes, not {type(text).__name__}")
    return memoryview(text).tobytes()


def looked_at(characters: bytes) -> tuple[float, np.ndarray, np.ndarray]:
    """t, q [n] and p [n] of a text."""
    n, size = ffi.new("int *"), len(characters)
    check(lib.tvi_state_peek(characters, size, n, ffi.NULL, ffi.NULL, ffi.NULL))
    t, q, p = Doubles(1), Doubles(n[0]), Doubles(n[0])
    check(lib.tvi_state_peek(characters, size, n, t.pointer, q.pointer, p.pointer))
    return float(t.array[0]), q.array.copy(), p.array.copy()


def read(status: int, characters: bytes) -> np.ndarray:
    """The values of parameters in a text that the library has just read. Warns if it dropped the history."""
    check(status)
    if dropped := ffi.string(lib.tvi_last_error()).decode():
        warnings.warn(dropped, stacklevel=3)
    words = characters.split()
    return np.array([float.fromhex(x.decode()) for name, x in zip(words, words[1:]) if name == b"value"])
