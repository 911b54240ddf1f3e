# Plane oscillator V = r^2/2 in polar coordinates, r = 1, phi = 0, p = (0, L): the ellipse x = cos t, y = L sin t.
# With L = 1e-6 and 1e-8 the steps that error=1e-8 chooses go through the centrifugal wall to r = -1 and back:
# success, error 0.1 and 4e-3, tail 0.005 and 3e-6, no doubt in the message. L = 1e-4 is refused in the run, L =
# 1e-3 is right (79,000 steps).
# Right at t = 40.3: x = cos 40.3, y = L sin 40.3 to the wanted error, or a refusal before there is a run; to
# tolerance=1e-10 within 1e-7.
# Kind: as advice_collision.py. A feature that is narrow beside a step is crossed by tunnelling, the energy changes
# by less than 5 % of a step, and tvi_suggest_step does not look between.
import numpy as np

import tvi
from verdict import attempt, refuses, row, told, verdict

polar = tvi.hamiltonian(2, lambda q, p: (p[0]**2 + (p[1] / q[0])**2) / 2 + q[0]**2 / 2)
for L in 1e-8, 1e-6, 1e-4, 1e-3:
    for way, bound in (dict(error=1e-8), 1e-8), (dict(tolerance=1e-10), 1e-7):
        run = attempt(lambda: tvi.solve(polar, (0, 40.3), q0=[1, 0], p0=[0, L], **way))
        if isinstance(run, Exception):
            row(refuses(run), L, way, told(run))
            continue
        r, phi = run.q_end
        found = np.hypot(r * np.cos(phi) - np.cos(40.3), r * np.sin(phi) - L * np.sin(40.3))
        row(run.success and found <= bound, L, way,
            f"error {found:.1e}, tail {run.stats.largest_tail:.0e}, {run.message}")
verdict()
