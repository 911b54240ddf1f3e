"""tolerance.py FILE: errors of runs to a tolerance that meet forces of all widths, beside those of SciPy's DOP853.

A mass on a spring, from x = -1 at rest to t = 20, meets a force of a width from 1 to a thousandth of its motion. Of
each row FILE has the largest error of the end, in tolerances, over the forms of the system; 'refused' where a run ends
with a status. The right end is that of "galerkin" with steps of a twentieth of the width. Exits with 1 where a run has
more than 100 tolerances with success (or 2e-12, which the right end may be wrong by).
"""
import sys

import numpy as np
from scipy.integrate import solve_ivp

import tvi

TOLERANCES = 1e-4, 1e-7, 1e-10, 1e-13
WIDTHS = 1.0, 0.1, 0.01, 0.001
END, FLOOR = 20, 2e-12


def soft(x):
    """log(1 + e^x)."""
    return np.log(1 + np.exp(x))


# V beside the spring, and -dV/dq in numbers.
POTENTIALS = {
    "wall": (lambda x, w: 0.5 * w * np.exp((x - 0.5) / w), lambda x, w: -0.5 * np.exp((x - 0.5) / w)),
    "contact": (lambda x, w: 500 * (w * soft((x - 0.5) / w))**2 / 10,
                lambda x, w: -100 * w * np.logaddexp(0, (x - 0.5) / w) / (1 + np.exp(-(x - 0.5) / w))),
    "step": (lambda x, w: 0.1 * np.tanh((x - 0.31) / w),
             lambda x, w: -0.1 / w / np.cosh(min(abs(x - 0.31) / w, 300))**2),
    "hill": (lambda x, w: 0.1 * np.exp(-((x - 0.31) / w)**2),
             lambda x, w: 0.2 * (x - 0.31) / w**2 * np.exp(-((x - 0.31) / w)**2)),
    "kink": (lambda x, w: 0.5 * np.sqrt(x * x + w * w), lambda x, w: -0.5 * x / np.sqrt(x * x + w * w)),
}
BOUNDED = {"hill", "pulse"}  # what leaves the energy as it was, or has none: runs get largest_step


def forms(name, w):
    """The systems of the row by their forms, and the rates of the first of them for SciPy."""
    if name in POTENTIALS:
        V, F = POTENTIALS[name]
        all_of = lambda q: q[0]**2 / 2 + V(q[0], w)
        yield "potential", tvi.potential(1, all_of), lambda t, y: [y[1], F(y[0], w) - y[0]]
        yield "Hamiltonian", tvi.hamiltonian(1, lambda q, p: p[0]**2 / (2 + 1e-3 * q[0]**2) + all_of(q)), None
        yield "Lagrangian", tvi.lagrangian(1, lambda q, v: v[0]**2 * (0.5 + 1e-3 * q[0]**2) - all_of(q)), None
        return
    spring = tvi.potential(1, lambda q: q[0]**2 / 2)
    if name == "friction":
        yield "driven", spring.driven(lambda q, v: [-0.5 * v[0] * (1 + np.tanh((q[0] - 0.3) / w))]), \
            lambda t, y: [y[1], -y[0] - 0.5 * y[1] * (1 + np.tanh((y[0] - 0.3) / w))]
    else:
        yield "driven", spring.driven(lambda q, v, t: [0.5 * np.exp(-((t - 7.3) / w)**2)]), \
            lambda t, y: [y[1], -y[0] + 0.5 * np.exp(-((t - 7.3) / w)**2)]
        yield "force", tvi.force(1, lambda q, t: [-q[0] + 0.5 * np.exp(-((t - 7.3) / w)**2)]), None


def row(name, w):
    """The errors in tolerances, of tvi and of DOP853, and whether all are right."""
    largest = {"largest_step": 2 * w} if name in BOUNDED else {}
    own, peers, good = [0.0] * 4, [0.0] * 4, True
    for form, system, rates in forms(name, w):
        right = tvi.solve(system, (0, END), [-1], 0, h=min(w / 20, 0.02), t_eval=[END])
        for i, tolerance in enumerate(TOLERANCES):
            run = tvi.solve(system, (0, END), [-1], 0, tolerance=tolerance, t_eval=[END], **largest)
            error = abs(run.q_end - right.q_end)[0] if run.success else np.nan
            own[i] = max(own[i], error / tolerance)
            if error > 100 * tolerance + FLOOR:
                print(f"{name} {w} {form} {tolerance}: {error / tolerance} tolerances")
                good = False
            if rates is not None:
                bounded = {"max_step": 2 * w} if largest else {}
                there = solve_ivp(rates, (0, END), [-1, 0], method="DOP853", rtol=tolerance, atol=tolerance, **bounded)
                peers[i] = abs(there.y[0, -1] - right.q_end[0]) / tolerance if there.success else np.nan
    return own, peers, good


def cells(errors):
    return " | ".join("refused" if np.isnan(e) else f"{e:.2g}" for e in errors)


all_good = True
with open(sys.argv[1], "w", encoding="utf-8") as out:
    print("| force | width |", " | ".join(f"{t:.0e} (chaotic)" for t in TOLERANCES), "|",
          " | ".join(f"DOP853 {t:.0e} (chaotic)" for t in TOLERANCES), "|\n|---|---|" + "---|" * 8, file=out)
    with np.errstate(over="ignore"):
        for name in [*POTENTIALS, "friction", "pulse"]:
            for w in WIDTHS:
                own, peers, good = row(name, w)
                all_good &= good
                print(f"| {name} | {w} | {cells(own)} | {cells(peers)} |", file=out)
sys.exit(0 if all_good else 1)
