"""orbit.py DIR: an eccentric orbit over many revolutions, by tvi and by SciPy's DOP853 with as many evaluations.

Writes DIR/orbit.csv: for each method its energy error along the run, and its steps in the last revolution; and
DIR/orbit.txt: evaluations of the force, CPU seconds and errors at the end. Both choose their steps: tvi those of a
rescaled system, h in s; DOP853 by the largest of a list of tolerances with which it has at least as many evaluations.
Exits with 1 where the energy error of tvi is above 1e-13, or that of DOP853 below 1e-4.
"""
import sys
import time

import numpy as np
from scipy.integrate import solve_ivp

import tvi

ECCENTRICITY, REVOLUTIONS, ROWS = 0.6, 3000, 400
END = 2 * np.pi * REVOLUTIONS
START = [1 + ECCENTRICITY, 0], [0, np.sqrt((1 - ECCENTRICITY) / (1 + ECCENTRICITY))]  # the apocentre, a = 1


def rates(t, y):
    r3 = (y[0] * y[0] + y[1] * y[1])**1.5
    return [y[2], y[3], -y[0] / r3, -y[1] / r3]


def by_tvi():
    """Times, states [k, 4] and evaluations."""
    kepler = tvi.potential(2, lambda q: -1 / np.sqrt(q @ q))
    orbit = tvi.Integrator(kepler.rescaled(lambda q, p: (q @ q)**0.75), *START)
    kept = []
    orbit.run(h=0.6, t_end=END, at_step=lambda step, t, q, p: kept.append((t, *q, *p)))
    rows = np.array([(0, *START[0], *START[1]), *kept])
    return rows[:, 0], rows[:, 1:], orbit.stats.force_evaluations


def by_dop853(tolerance):
    run = solve_ivp(rates, (0, END), np.concatenate(START), method="DOP853", rtol=tolerance, atol=tolerance)
    return run.t, run.y.T, run.nfev


def seconds(run):
    start = time.process_time()
    run()
    return time.process_time() - start


def main(folder):
    ours, tolerance = by_tvi(), 1e-5
    while (theirs := by_dop853(tolerance))[2] < ours[2]:
        tolerance /= 2
    lines, largest = [], []
    with open(f"{folder}/orbit.csv", "w") as file:
        file.write("method,what,x,y\n")
        for method, (t, y, evaluations) in (("tvi", ours), ("DOP853", theirs)):
            error = np.abs(((y[:, 2]**2 + y[:, 3]**2) / 2 - 1 / np.hypot(y[:, 0], y[:, 1])) / -0.5 - 1)
            here = np.unique(np.searchsorted(t, np.linspace(0, t[-1], ROWS)).clip(0, len(t) - 1))
            for first, last in zip(here[:-1], here[1:]):  # the largest since the row before
                file.write(f"{method},energy,{t[last] / (2 * np.pi)},{max(error[first + 1:last + 1].max(), 1e-17)}\n")
            for state in y[t > END - 2 * np.pi]:
                file.write(f"{method},orbit,{state[0]},{state[1]}\n")
            largest.append(error.max())
            lines.append(f"{method}: {evaluations / REVOLUTIONS:.0f} evaluations and {(len(t) - 1) / REVOLUTIONS:.1f} "
                         f"steps a revolution, largest energy error {error.max():.1e}")
    lines.append(f"{REVOLUTIONS} revolutions, e = {ECCENTRICITY}, tolerance {tolerance:.1e}: {seconds(by_tvi):.2f} s and "
                 f"{seconds(lambda: by_dop853(tolerance)):.2f} s")
    with open(f"{folder}/orbit.txt", "w") as file:
        file.write("\n".join(lines) + "\n")
    return 0 if largest[0] < 1e-13 and largest[1] > 1e-4 else 1


sys.exit(main(sys.argv[1]))
