# Runs that end at a terminal event, with a t_span longer than needed, as users of solve_ivp write them. tvi.solve
# with its default error=1e-9: "error = 1e-09 is below roundoff, which makes about 5e-09 of such a run", no run;
# with error=1e-6 h = 3.8e-5 and 4.9e-6 where 20 and 0.01 serve (t_span (0, 50): h = 40, (0, 67): 6e-5).
# Right: the event ends the run, at its time to 10 wanted errors (10 tolerances), after at most 2000 steps;
# tolerance=1e-10 needs 40.
# Reference: a rocket m = 100 - 1.5 t burns out (m = 40) at t = 40. A fall from r = 1 with L = p0 reaches r = 0.1 at
# t = a^(3/2) (pi - E + e sin E), e cos E = 1 - 0.1 / a, a = 1 / (2 - L^2), e = 1 / a - 1 (Kepler's equation); from
# rest (acos(sqrt .1) + sqrt(.09)) / sqrt 2 = 1.095340770.
# Kind: tvi_suggest_step looks at all of t_span and knows no events: what is behind the terminal event (m = 0 at t =
# 66.7, the centre of the planet) decides h, or refuses the run with a text that speaks of roundoff.
import numpy as np

import tvi
from verdict import attempt, row, told, verdict


def mass(t):
    return 100 - 1.5 * t


def fall_time(L):
    a = 1 / (2 - L * L)
    e = 1 / a - 1
    E = np.arccos((1 - 0.1 / a) / e)
    return a**1.5 * (np.pi - E + e * np.sin(E))


rocket = tvi.force(1, lambda q, t: [3000 / mass(t) - 9.81])
burnt = tvi.event(lambda q, p, t: mass(t) - 40, terminal=True)
planet = tvi.potential(2, lambda q: -1 / np.sqrt(q @ q))
ground = tvi.event(lambda q, p: q @ q - 0.01, direction=-1, terminal=True)
for name, t_end, arguments, event, right in (
        ("rocket", 50, (rocket, [0], [0]), burnt, 40), ("rocket", 67, (rocket, [0], [0]), burnt, 40),
        ("rocket", 100, (rocket, [0], [0]), burnt, 40), ("fall", 100, (planet, [1, 0], [0, 0]), ground, fall_time(0)),
        ("fall beside", 100, (planet, [1, 0], [0, 0.1]), ground, fall_time(0.1))):
    for way, bound in ({}, 1e-9), (dict(error=1e-6), 1e-6), (dict(tolerance=1e-10), 1e-10):
        run = attempt(lambda: tvi.solve(arguments[0], (0, t_end), *arguments[1:], events=event, **way))
        if isinstance(run, Exception):
            row(False, name, t_end, way, told(run))
            continue
        is_right = run.status == 1 and abs(run.t_end - right) <= 10 * bound * right and run.stats.steps <= 2000
        row(is_right, name, t_end, way, f"h {run.h:.2g}, ended at {run.t_end:.9f} (right {right:.9f}),"
            f" {run.stats.steps} steps: {run.message}")
verdict()
