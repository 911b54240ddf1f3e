# Smooth (analytic) contact and friction beside a spring, to a tolerance. All functions are analytic on the real
# line. Success with errors of 1e-3 to 2 at every tolerance (the energy is off by up to 100 %, and it is a
# potential's), or a body deep in the wall and then a refusal.
# Right: success, and the end to 1000 tolerances (DOP853 has 1e-7 and less from rtol 1e-8 on).
# Reference (galerkin of order 16, h = 0.002 and 0.001 agree to 1e-15; DOP853 of 1e-12 agrees to 1e-9 and better):
# the numbers in `cases`, at t = 20, friction at t = 6.
# Kind: the size of a Taylor step comes from the last coefficients alone (src/generating/taylor.c). A force that
# is exponentially small where the step begins (exp, tanh, erf, softplus, Gauss) is below roundoff of the
# coefficients that the spring makes. The force at the end of a step is tried only before a first step, and where
# the coefficients allow more than 1.5 times four steps before, and only in separable systems; the energy is not
# looked at.
import numpy as np

import tvi
from verdict import attempt, row, told, verdict


def spring(V):
    return tvi.potential(1, lambda q: q[0]**2 / 2 + V(q[0]))


rub = tvi.potential(1, lambda q: 5 * q[0]**2).driven(lambda q, v: [-1.96 * np.tanh(v[0] / 0.01)])
cases = {
    "wall": (spring(lambda x: np.exp(200 * (x - 0.5))), 20, -1.0, -0.567833576),
    "contact": (spring(lambda x: 500 * (0.01 * np.log1p(np.exp((x - 0.5) / 0.01)))**2), 20, -1.0, -0.121300376),
    "step": (spring(lambda x: 0.1 * tvi.erf(50 * x)), 20, -1.0, -0.403204741),
    "bump": (spring(lambda x: 0.1 * np.exp(-(50 * x)**2)), 20, -1.0, -0.429778296),
    "friction": (rub, 6, 2.0, -0.0379765460),
}
for name, (system, t_end, q0, right) in cases.items():
    for tolerance in 1e-4, 1e-6, 1e-8, 1e-10, 1e-12:
        run = attempt(lambda: tvi.solve(system, (0, t_end), [q0], [0], tolerance=tolerance))
        if isinstance(run, Exception):
            row(False, f"{name} {tolerance:.0e}:", told(run))
            continue
        error = abs(run.q_end[0] - right)
        row(run.success and error <= 1000 * tolerance + 1e-9,
            f"{name} {tolerance:.0e}: status {run.status}, error {error:.1e}, {run.stats.steps} steps")
verdict()
