# A burn of 100 s (edges of 5 s) in a day of a circular orbit, 10 N on 100 kg, as a smooth pulse of time in
# `driven`. tvi.solve with error=1e-9 (the default) and 1e-6 chooses steps of 225 s, gets the burn wrong by 9 and 15
# %, and reports success, tail 1e-3 (docs/choosing.md: "below 0.01 no run was wrong"). end_error() would show it.
# Right: the end to the wanted error, or a refusal; to a tolerance (largest_step=20, since docs/limits.md says that
# a force that is 0 in doubles is not seen) the end to 1000 tolerances; h=20: the end to 1e-9. Reference: DOP853 of
# 3e-14 with steps of at most 5 s, which agrees with 10 s to 1e-11 of the radius.
import numpy as np

import tvi
from verdict import attempt, refuses, row, told, verdict

mu, F, t1, t2, w, T = 398600.4418, 1e-4, 3000.0, 3100.0, 5.0, 86400.0
v0 = np.sqrt(mu / 6778)
right = np.array([-6778.72344502, 46.51131388])


def push(q, v, t):
    on = (np.tanh((t - t1) / w) - np.tanh((t - t2) / w)) / 2
    return F * on * v / np.sqrt(v @ v)


S = tvi.potential(2, lambda q: -mu / np.sqrt(q @ q)).driven(push)


def distance(q):
    return np.abs(q - right).max() / 6778


for way, bound in (({}, 1e-9), ({"error": 1e-6}, 1e-6), ({"h": 20}, 1e-9)):
    run = attempt(lambda: tvi.solve(S, (0, T), [6778, 0], [0, v0], **way))
    if isinstance(run, Exception):
        row(refuses(run), way, told(run))
    else:
        row(not run.success or distance(run.q_end) <= bound, way,
            f"error {distance(run.q_end):.1e}, h {run.h:.3g}:", run.message)
for tolerance in 1e-9, 1e-12:
    orbit = tvi.Integrator(S, [6778, 0], [0, v0], method="taylor", order=tvi.taylor_order(tolerance))
    attempt(lambda: orbit.run(tolerance=tolerance, t_end=T, largest_step=20))
    row(orbit.t == T and distance(orbit.q) <= 1000 * tolerance,
        f"tolerance {tolerance:.0e}: error {distance(orbit.q):.1e}")
verdict()
