# A body flies freely, meets something short, flies on. tvi.solve(error=...) chooses h. With 1e-10 wanted the hill
# ends with success and an error of 2.3e-4, "seen" 1.0 and no doubt in the message; with 1e-6 wanted, and in both
# others with any error, the suggested h is refused in the middle of the run.
# Right: success, and the end to the wanted error. Reference (tolerance 1e-14 and h = 0.002 agree to 1e-15): hill
# from -40, t = 80: q = -40.278152886804; Lennard-Jones from 100, t = 150: q = 52.43693891; Yukawa in the plane from
# (-50, 0.5), t = 100: (-47.85690408, -17.46133438).
# Kind: the scout of tvi_suggest_step (src/run/scout.c) checks the energy of its first step only; later steps in
# free flight may be as long as the obstacle is away, and hop over it or through it; no trial of the whole run
# decides, although it has 10 to 40 steps. end_error() shows it each time.
import numpy as np

import tvi
from verdict import attempt, row, told, verdict

cases = {
    "hill": (tvi.potential(1, lambda q: np.exp(-q[0]**2)), 80, [-40], [1], [-40.278152886804]),
    "Lennard-Jones": (tvi.potential(1, lambda q: 4 * (q[0]**-12 - q[0]**-6)), 150, [100], [-1], [52.43693891]),
    "Yukawa": (tvi.potential(2, lambda q: -np.exp(-np.sqrt(q @ q)) / np.sqrt(q @ q)), 100, [-50, 0.5], [1, 0],
               [-47.85690408, -17.46133438]),
}
for name, (system, t_end, q0, p0, right) in cases.items():
    for error in 1e-6, 1e-8, 1e-10:
        run = attempt(lambda: tvi.solve(system, (0, t_end), q0, p0, error=error))
        if isinstance(run, Exception):
            row(False, name, told(run))
            continue
        found = np.max(np.abs(run.q_end - right)) / np.max(np.abs(run.q))
        row(run.success and found <= error + 1e-10,  # the references have 10 digits
            f"{name}: wanted {error:.0e}, found {found:.1e}, h {run.h:.3g}, {run.stats.steps} steps: {run.message}")
verdict()
