# Sun, Jupiter, Saturn and an asteroid of m = 1e-10 (Vesta), 4.7e-10 (Ceres), 1e-8 (the Moon has 3.7e-8) in rescaled
# steps. (1) tvi_suggest_step accepts error = 1e-6, and its step is refused in the run: Ceres at t = 249 of 2000.
# (2) Steps that are accepted have an asteroid whose error is 1e5 times that of the planets, and tail (4e-10) and
# energy show nothing: 1.2e-6 at m = 1e-8, h = 0.3. (3) error = 1e-9 is refused as "below roundoff"; fixed steps
# reach 4e-11 with a quarter of the steps.
# Right: the wanted error of all bodies, 1e-8 with h = 0.3 in s, or a refusal with a word on the mass. Reference:
# float128 Taylor series; here fixed steps of 1, which agree with it to 1e-12.
# Kind: docs/adaptive.md says "lighter by ten powers of ten ... may not converge": it begins at nine, and accuracy
# goes at eight.
import numpy as np

import tvi
from tvi import gravity
from verdict import attempt, refuses, row, told, verdict


def start(b):
    x, v = gravity.Orbit(a=[5.2, 9.5, 2.77], e=[0.048, 0.054, 0.08], i=[0.02, 0.04, 0.2], node=[1.75, 1.98, 0.5],
                         pericentre=[4.8, 5.9, 1], time=[0, 0, 2]).state(1 + b.mass[1:])
    q, v = (np.r_[0, 0, 0, y.ravel()] for y in (x, v))
    return b.to_centre(q, b.momenta(v))


for m in 1e-10, 4.7e-10, 1e-8:
    b = gravity.Bodies([1, 9.5e-4, 2.9e-4, m])
    q, p = start(b)
    right = tvi.solve(b.system(), (0, 2000), q, p, h=1).q_end
    S = b.system()
    for name, system in ("fixed", lambda: S), ("rescaled", lambda: S.rescaled(b.scale)), ("automatic", S.rescaled):
        for way in dict(error=1e-6), dict(error=1e-9), dict(h=0.3):
            run = attempt(lambda: tvi.solve(system(), (0, 2000), q, p, **way))
            label = f"m = {m:g}, {name}, {way}:"
            if isinstance(run, Exception):
                row(refuses(run, r"\bmass"), label, told(run))
                continue
            d = abs(run.q_end - right)
            is_right = d.max() <= way.get("error", 1e-8) * abs(right).max() if run.success else "mass" in run.message
            row(is_right, label,
                f"h = {run.h:.3g}, asteroid {d[9:].max():.0e}, planets {d[:9].max():.0e}:", run.message)
verdict()
