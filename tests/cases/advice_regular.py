# One degree of freedom, a smooth V of size 1, a periodic orbit, t = 20, tvi.solve(error=...). README: "On a regular
# orbit the error of the state at the end is at most the wanted one". V1: wanted 1e-10, found 9e-6 (h = 0.39; 1e-8:
# 5e-5); V2: wanted 1e-10, found 4e-6; success, seen 1.0, no doubt in the message, tail 0.007.
# Right: at most the wanted error of q and of p, each relative to its largest, or a refusal before there is a run.
# Reference: Bulirsch-Stoer of order 20 in 30 digits (mpmath), 400 and 800 steps, which agree to 18 digits;
# tolerance=1e-14 agrees to 1e-13.
# Kind: tvi_suggest_step. The run has 30 to 50 steps, but where the scout has used up its budget of 60 steps no
# trial of the whole run is made, and h is extrapolated from a part of the orbit. end_error() shows it each time.
import numpy as np

import tvi
from verdict import attempt, refuses, row, told, verdict


def tanhs(a, b, c, d):
    return tvi.potential(1, lambda q: a * q[0]**2 + np.array(b) @ np.tanh(np.array(c) * q[0] + d))


# system, start (q, p), end (q, p), largest |q| and |p|
V1 = tanhs(0.0905, [-1.05727587, 0.12839329, -0.42599352], [3.27100951, 3.38065719, 4.23555636],
           [-0.42249883, 0.06931524, 1.03525933]), (-1.22048258, -1.21009482), \
    (-1.3660460828825436, 1.1813504185979073), (6.286, 2.643)
V2 = tanhs(0.051883699, [-0.32979634, 0.11860416, 0.09529158], [4.22407932, 4.89042752, 4.13400024],
           [-0.88774407, 0.58598322, -0.39159296]), (2.75738283, 0.85636008), \
    (2.9611941779467503, 0.7825666455953771), (3.830, 1.2056)
for system, (q0, p0), right, size in V1, V2:
    for error in 1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12:
        run = attempt(lambda: tvi.solve(system, (0, 20), [q0], [p0], error=error))
        if isinstance(run, Exception):
            row(refuses(run), f"wanted {error:.0e}:", told(run))
            continue
        found = np.max(np.abs([run.q_end[0] - right[0], run.p_end[0] - right[1]]) / size)
        row(run.success and found <= error, f"wanted {error:.0e}, found {found:.1e} ({found / error:.1g} times), "
            f"h {run.h:.3f}, {run.stats.steps} steps, tail {run.stats.largest_tail:.0e}: {run.message}")
verdict()
