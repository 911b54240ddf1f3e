# A Jupiter (1e-3) on a = 1, e = 0.9 about a star, with steps of P / 10, as docs/choosing.md advises to begin. Alone
# the step is refused ("it changes the energy by what no step does"). With a second star 15 AU away (circle) the
# same run is TVI_OK, and the planet is thrown out (a from -10.5 to 1.04, e up to 32): the guard compares the change
# with 5 % of the energy of ALL bodies, which is 3 times the energy of the planet's orbit. Only the tail, 0.12,
# shows it.
# Right: a stays within 0.9978..1.0003, e within 0.883..0.903 (float128 series); or a refusal as for the planet
# alone.
import numpy as np

import tvi
from tvi import gravity
from verdict import attempt, refuses, row, told, verdict

for companions in 0, 1:
    b = gravity.Bodies([1, 1e-3, 1][:2 + companions], axes=2)
    x, v = gravity.Orbit(a=1, e=0.9, time=np.pi).state(1.001)
    X, V = gravity.Orbit(a=15).state(2.001)
    q, p = b.to_centre(np.r_[0, 0, x[:2], X[:2]][:b.n], b.momenta(np.r_[0, 0, v[:2], V[:2]][:b.n]))
    run = attempt(lambda: tvi.solve(b.system(), (0, 200 * np.pi), q, p, h=0.2 * np.pi))
    if isinstance(run, Exception):
        row(refuses(run), companions, told(run))
        continue
    d, w = ((y[:, 2:4] - y[:, :2]) for y in (run.q, b.velocities(run.p)))
    o = gravity.Orbit.of(1.001, np.c_[d, 0 * run.t], np.c_[w, 0 * run.t])
    row(not run.success or o.a.min() > 0.99 and o.a.max() < 1.01 and o.e.min() > 0.87 and o.e.max() < 0.91,
        f"{companions} companions: a {o.a.min():.3f}..{o.a.max():.3f}, e up to {o.e.max():.3g}:", run.message)
verdict()
