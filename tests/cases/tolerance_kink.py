# |x| as sqrt(x^2), as the text of the error for abs() and docs/limits.md say ("fails at x = 0"). It does not fail
# at 0 but crosses it, as nodes do not lie on 0: taylor 12, h = 0.1: the energy grows by 490 %, success, tail 9e-10;
# drag, tolerance 1e-7: error 3e-2, 1e-14: 6e-4, success. An angle by arctan2 across its cut: success, energy from
# 0.1 to 380 (error=1e-8).
# Right: what was wanted, or a refusal: V = |x| from x = 1 at rest: arcs of parabolas of period 4 sqrt 2 (closed
# form below), to the wanted error, 1000 tolerances, or the energy to 1 % in fixed steps. A throw upward with 40
# m/s, drag 0.05 v |v|: x(4) in closed form (arctan and log cosh, below; DOP853 of 1e-8: error 1e-7), to 1000
# tolerances. arctan2: the energy to 1e-4.
# Kind: nothing compares the series of a step with the function at its end (tolerance: only first steps and steps
# that grow 1.5 x 4 times, separable systems); functions with branches (sqrt of a square, pow, arctan2, hypot) go on
# analytically.
import numpy as np

import tvi
from verdict import attempt, refuses, row, told, verdict


def arcs(t):
    s, r2 = t % (4 * np.sqrt(2)), np.sqrt(2)
    return 1 - s * s / 2 if s < r2 else -1 + (s - 2 * r2)**2 / 2 if s < 3 * r2 else 1 - (s - 4 * r2)**2 / 2


def test(name, is_right, *arguments, **way):
    run = attempt(lambda: tvi.solve(*arguments, **way))
    if isinstance(run, Exception):
        row(refuses(run), name, way, told(run))
    else:
        row(not run.success or is_right(run), name, way,
            f"q {run.q_end}, tail {run.stats.largest_tail:.0e}: {run.message}")


wedge = tvi.potential(1, lambda q: np.sqrt(q[0]**2))
for way in dict(h=0.1), dict(h=0.1, method="taylor", order=12):
    test("wedge", lambda run: np.ptp(run.energy) < 0.01, wedge, (0, 100.3), [1], [0], **way)
for way, bound in (dict(tolerance=1e-6), 1e-3), (dict(error=1e-4), 1e-4):
    test("wedge", lambda run: abs(run.q_end[0] - arcs(100.3)) < bound, wedge, (0, 100.3), [1], [0], **way)
vt, ta = np.sqrt(9.8 / 0.05), np.arctan(40 / np.sqrt(196)) * np.sqrt(196) / 9.8
top = vt**2 / 19.6 * np.log(1 + 1600 / vt**2)
right = top - vt**2 / 9.8 * np.log(np.cosh(9.8 * (4 - ta) / vt))
throw = tvi.potential(1, lambda q: 9.8 * q[0]).driven(lambda q, v: [-0.05 * v[0] * np.sqrt(v[0]**2)])
for tolerance in 1e-4, 1e-7, 1e-8, 1e-10, 1e-12, 1e-14:
    test(f"drag (right {right:.9f})", lambda run: abs(run.q_end[0] - right) < 1000 * tolerance + 1e-13, throw, (0, 4),
         [0], [40], tolerance=tolerance)
spiral = tvi.potential(2, lambda q: (np.arctan2(q[1], q[0]) - 3)**2 / 2 + 50 * (np.sqrt(q @ q) - 1)**2)
for t_end in 8, 10:
    test("arctan2", lambda run: np.ptp(run.energy) < 1e-4, spiral, (0, t_end), [np.cos(2.5), np.sin(2.5)], [0, 0],
         error=1e-8)
verdict()
