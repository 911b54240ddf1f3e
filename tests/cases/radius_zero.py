# Runs to a tolerance of smooth systems whose series have zeros before their last terms: TVI_ENOCONV "the corrector
# did not converge", h = 4e-16 and the like, though nothing is large; 364 of 1197 starts of the first one are
# refused so at 1e-8. DOP853 and every other method of tvi are right.
# Right: success, and the end to 1000 tolerances: V = 0.01 log cosh(100 x), a smooth |x|, from x = 1 at rest: the
# force is -1 to 87 digits, x(1) = 0.5; q'' = t^7 + t^8 from rest: q(1) = 1/72 + 1/90 = 0.025. No start is refused.
# Kind: coefficient_ratio (src/generating/taylor.c) divides coefficient k - 4 by coefficient k. If the
# lower one is exactly 0 and the higher one is not, as roundoff of log cosh, tanh, logistic functions in their flat
# parts, the radius of convergence is taken as 0, the usable step is 0 for every time unit, and the search for a
# time unit ends after all its tries (expand_with_suitable_tau, taylor.c).
import numpy as np

import tvi
from verdict import attempt, row, told, verdict

smooth = tvi.potential(1, lambda q: 0.01 * np.log(np.cosh(q[0] / 0.01)))
power = tvi.force(1, lambda q, t: [t**7 + t**8])
for name, system, q0, right in ("log cosh", smooth, 1.0, 0.5), ("t^7 + t^8", power, 0.0, 0.025):
    for tolerance in 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14:
        run = attempt(lambda: tvi.solve(system, (0, 1), [q0], [0], tolerance=tolerance))
        if isinstance(run, Exception):
            row(False, name, tolerance, told(run))
            continue
        error = abs(run.q_end[0] - right)
        row(run.success and error <= 1000 * tolerance + 1e-13, name, tolerance,
            f"t = {run.t_end:.3g}, error {error:.1e}", run.message)
order = tvi.taylor_order(1e-8)
refused = 0
for x in np.linspace(0.2, 3, 57):
    for v in np.linspace(-1, 1, 21):
        try:
            tvi.Integrator(smooth, [x], [v], method="taylor", order=order).run(tolerance=1e-8, t_end=0.1)
        except tvi.Error:
            refused += 1
row(refused == 0, refused, "of 1197 refused")
verdict()
