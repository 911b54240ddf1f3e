"""Keeps the states of a run, after every step or every k-th, and draws how far it is."""

from __future__ import annotations

import sys
import time
from typing import Any, Callable

import numpy as np

from ._library import ffi

ROWS = 10000  # of the steps of a result, which has at most twice as many


class Recorder:
    """Rows (t, q, p) of some of the steps. Where they become too many, every other one is dropped."""

    def __init__(self, n: int, t: float, q: np.ndarray, p: np.ndarray, every: int = 1):
        self._n, self.every, self._count = n, every, 0
        self._rows: list[tuple[float, bytes, bytes]] = []
        self._starts: set[tuple] = set()  # rows from which the run went on with other momenta: none of them is dropped
        self.add(t, q, p)

    def add(self, t: float, q: Any, p: Any) -> None:
        self._rows.append((t, q.tobytes(), p.tobytes()))

    def start(self, t: float, q: Any, p: Any) -> None:
        self.keep(t, q, p)
        self._starts.add(self._rows[-1])

    def after_step(self, t: float, q: Any, p: Any) -> None:
        """Told of each step by the library, with its pointers."""
        self._count += 1
        if self._count % self.every == 0:
            size = 8 * self._n
            self._rows.append((t, ffi.buffer(q, size)[:], ffi.buffer(p, size)[:]))
            if len(self._rows) > 2 * ROWS + len(self._starts):
                self._rows = [row for k, row in enumerate(self._rows) if k % 2 == 0 or row in self._starts]
                self.every *= 2

    def keep(self, t: float, q: np.ndarray, p: np.ndarray) -> None:
        """The state at hand, unless it is the last one that was kept."""
        if self._rows[-1] != (t, q.tobytes(), p.tobytes()):
            self.add(t, q, p)

    def arrays(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        t = np.array([row[0] for row in self._rows])
        q, p = (np.frombuffer(b"".join(row[i] for row in self._rows), dtype=np.float64).reshape(-1, self._n).copy()
                for i in (1, 2))
        return t, q, p


class Progress:
    """Draws a bar on a terminal, or calls a function with t and the part that is done, ten times a second at most."""

    def __init__(self, wanted: "bool | Callable", t: float, t_end: float):
        self._tell = wanted if callable(wanted) else self._draw if wanted and sys.stderr.isatty() else None
        self.start, self._t_end, self._next = t, t_end, 0.0

    def at(self, t: float) -> None:
        if self._tell is not None and (now := time.monotonic()) >= self._next:
            self._next = now + 0.1
            self._tell(t, min(1.0, (t - self.start) / (self._t_end - self.start)))

    def end(self, t: float) -> None:
        self._next = 0.0
        if self._t_end != self.start:
            self.at(t)
        if self._tell == self._draw:
            sys.stderr.write("\n")

    @staticmethod
    def _draw(t: float, done: float) -> None:
        sys.stderr.write(f"\r[{'#' * int(50 * done):50s}] {int(100 * done):3d} %  t = {t:<12.6g}")
        sys.stderr.flush()
