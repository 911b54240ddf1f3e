# Functions whose arguments are others than tvi takes them for, and arguments of other libraries. The functions are
# recorded without a word, and each runs with success: v is the time, t is the velocity, mass is the time, p is q.
# Right: the right number, or a refusal that names the wrong argument and what stands for it here. Reference: a
# damped oscillator q'' = -q - 0.2 q', q(10) = e^-1 (cos 10 w + 0.1/w sin 10 w), w = sqrt .99; an oscillator driven
# by 0.3 cos(1.2 t) from rest, q(10) = 0.3/(1.44 - 1) (cos 10 - cos 12); H = p^2/2 + 9.8 q stated as H(p, q), the
# order of DifferentialEquations.jl, q(1) = -4.9.
# Kind: _signature (src/python/tvi/_functions.py) takes any further required argument for the time, whatever its
# name, and looks for a misplaced t only in the first place.
import numpy as np

import tvi
from verdict import attempt, refuses, row, told, verdict

w = np.sqrt(0.99)
damped = np.exp(-1) * (np.cos(10 * w) + 0.1 / w * np.sin(10 * w))
driven = 0.3 / 0.44 * (np.cos(10) - np.cos(12))
spring = tvi.potential(1, lambda q: q[0]**2 / 2)
kepler = tvi.potential(2, lambda q: -1 / np.sqrt(q @ q))
for name, make, q0, t_end, right, *words in (
    ("force(q, v)", lambda: tvi.force(1, lambda q, v: -q - 0.2 * v), 1, 10, damped, r"\bv\b"),
    ("potential(q, p)", lambda: tvi.potential(1, lambda q, p: q[0]**2 / 2 + 0.2 * p * q[0]), 1, 10, damped, r"\bp\b"),
    ("drive(q, t)", lambda: spring.driven(lambda q, t: 0.3 * np.cos(1.2 * t)), 0, 10, driven, r"\bt\b"),
    ("hamiltonian(p, q)", lambda: tvi.hamiltonian(1, lambda p, q: p[0]**2 / 2 + 9.8 * q[0]), 0, 1, -4.9,
     r"\bq\b", r"\bp\b"),
    ("potential(q, mass)", lambda: tvi.potential(1, lambda q, mass: mass * q[0]**2 / 2), 1, 1, np.nan, r"\bmass\b"),
    ("mass=2", lambda: tvi.potential(1, lambda q, mass: mass * q[0]**2 / 2, mass=2.0), 1, 1, np.cos(1), r"\bmass\b"),
):
    run = attempt(lambda: tvi.solve(make(), (0, t_end), [q0], [0]))
    if isinstance(run, Exception):
        row(refuses(run, *words), name, told(run))
    else:
        row(run.success and abs(run.q_end[0] - right) < 1e-6, f"{name}: right {right:.6f}, {run.q_end[0]:.6f}")

for name, make, words in (
    ("rtol=", lambda: tvi.solve(spring, (0, 1), [1], [0], rtol=1e-6), ["rtol", "tolerance"]),
    ("atol=", lambda: tvi.solve(spring, (0, 1), [1], [0], atol=1e-6), ["atol", "tolerance"]),
    ("y0=", lambda: tvi.solve(spring, (0, 1), y0=[1, 0]), ["y0", "q0", "p0"]),
    ("events=3", lambda: tvi.solve(spring, (0, 1), [1], [0], events=3), ["events", r"tvi\.event|function"]),
    ("max_step=", lambda: tvi.solve(spring, (0, 1), [1], [0], max_step=0.1), ["max_step", "largest_step"]),
    ("no p0", lambda: tvi.solve(kepler, (0, 1), [1, 0]), ["p0=0 for rest"]),
    ("h=0", lambda: tvi.solve(spring, (0, 1), [1], [0], h=0), [r"\bh\b"]),
):
    answer = attempt(make)
    row(refuses(answer, *words), name, told(answer))
verdict()
