"""Problems that several tests take, in Python's own words, and the paths that the tests are given."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np

import tvi

ROOT = Path(__file__).resolve().parents[2]
LIBRARY = Path(os.environ["TVI_LIBRARY"])
CC = os.environ.get("CC", "cc").split()


def kepler(**options):
    return tvi.potential(2, lambda q: -(q @ q) ** -0.5, **options)


def spring(**options):
    return tvi.potential(1, lambda q: q[0] ** 2 / 2, **options)


def python(code, **environment):
    """What a program prints, and its standard error, in a process of its own."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120,
                          env={**os.environ, **environment})
    return done.stdout + done.stderr


def same_bits(a, b):
    return np.asarray(a, dtype=float).tobytes() == np.asarray(b, dtype=float).tobytes()
