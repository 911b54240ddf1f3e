# An oscillator at rest at 0 and a smooth pulse of force exp(-(t-50)^2) at t = 50. At t = 22.5 .. 22.9 the force is
# a denormal number (5e-324 .. 2e-308), 1/momentum_size is inf, the tail is inf, and a right step is refused: "its
# tail inf is above max_tail = 1".
# Right: q(100) = sqrt(pi) exp(-1/4) sin(50) = -0.362180474 to 1e-11, and with error=1e-8 to that; midpoint serves
# no driven system, and is refused by name.
# Kind: reciprocals of sizes below 5.6e-309 (one_over_momentum_size and its like in src/algebra/tail.h). Also driven
# systems, every method with a tail, ensembles. q0 != 0 hides it (inf - inf = NaN counts as 0).
import numpy as np

import tvi
from verdict import attempt, refuses, row, told, verdict

right = np.sqrt(np.pi) * np.exp(-1 / 4) * np.sin(50)
pulse = tvi.potential(1, lambda q, t: q[0]**2 / 2 - q[0] * np.exp(-(t - 50)**2))
driven = tvi.potential(1, lambda q: q[0]**2 / 2).driven(lambda q, v, t: [np.exp(-(t - 50)**2)])
for name, system in ("potential", pulse), ("driven", driven):
    for t0, way in (0, dict(h=0.1)), (0, dict(h=0.25)), (25, dict(h=0.25)), (0, dict(error=1e-8)), \
            (0, dict(h=0.25, method="midpoint", order=12)), (0, dict(h=0.1, method="taylor", order=12)):
        run = attempt(lambda: tvi.solve(system, (t0, 100), q0=[0], p0=[0], **way))
        if isinstance(run, Exception):
            is_right = system is driven and way.get("method") == "midpoint" and refuses(run, "midpoint")
            row(is_right, name, t0, way, told(run))
        else:
            error = abs(run.q_end[0] - right)
            row(run.success and error <= way.get("error", 1e-11), name, t0, way, f"error {error:.1e}", run.message)
verdict()
