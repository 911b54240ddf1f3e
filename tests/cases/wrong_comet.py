# Sun, Jupiter, Saturn and a comet (a = 6, e = 0.95) of mass m, to t = 200. m = 0 with bodies.scale: wrong with
# success for h = 0.05 (0.07 AU, no warning) and 0.1 (3 AU, warned); 1e-20 to 1e-11: every rescaled step is refused
# ("its passes overflow: the step is too large", for any h); 1e-10: success with errors of 4e-8 to 4e-6 beside tails
# of 1e-9, planets right to 1e-13; the advice of tvi_suggest_step (1e-6 and 1e-9) is a step that is refused at t = 9
# and 17; automatic g the same; 1e-8 and more: right. Fixed h = 0.5: 7e-3 to 2e-2 AU with success, tail 0.07, no
# warning.
# Right: the wanted error, of the largest coordinate; h: 1e-6 AU, 1e-5 AU in fixed steps, a warning in the message, or,
# of fixed steps, a refusal; a refusal of rescaled steps is right with a word on the mass. Reference: |x| of the comet
# by a float128 Taylor series; here fixed steps of 0.02, which agree to 1e-14.
import numpy as np

import tvi
from tvi import gravity
from verdict import attempt, refuses, row, told, verdict


def start(b):
    x, v = gravity.Orbit(a=[5.2, 9.5, 6], e=[0.048, 0.054, 0.95], i=[0.02, 0.04, 0.3], node=[1.75, 1.98, 0.5],
                         pericentre=[4.8, 5.9, 1], time=[0, 0, 20]).state(1 + b.mass[1:])
    q, v = (np.r_[0, 0, 0, y.ravel()] for y in (x, v))
    return b.to_centre(q, b.momenta(v))


def is_right(run, name, way, error):
    if not run.success:
        return "mass" in run.message or name == "fixed" and "h" in way
    return error <= way.get("error", 1e-5 if name == "fixed" else 1e-6) or "h" in way and "too large" in run.message


for m in 0, 1e-20, 1e-15, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4:
    b = gravity.Bodies([1, 9.5e-4, 2.9e-4, m])
    q, p = start(b)
    S = b.system()
    right = tvi.solve(S, (0, 200), q, p, h=0.02, t_eval=[200]).q_end
    fixed, rescaled, automatic = lambda: S, lambda: S.rescaled(b.scale), S.rescaled
    for name, system, way in (("fixed", fixed, dict(h=0.2)), ("fixed", fixed, dict(h=0.5)),
                              ("fixed", fixed, dict(error=1e-9)),
                              ("rescaled", rescaled, dict(h=0.05)), ("rescaled", rescaled, dict(h=0.1)),
                              ("rescaled", rescaled, dict(error=1e-6)), ("rescaled", rescaled, dict(error=1e-9)),
                              ("automatic", automatic, dict(h=0.3)), ("taylor", fixed, dict(tolerance=1e-12))):
        run = attempt(lambda: tvi.solve(system(), (0, 200), q, p, **way))
        label = f"m = {m:g}, {name}, {way}:"
        if isinstance(run, Exception):
            row(refuses(run, r"\bmass"), label, told(run))
            continue
        d = abs(run.q_end - right)
        row(is_right(run, name, way, d.max() / (abs(right).max() if "error" in way else 1)), label,
            f"comet {d[9:].max():.0e}, planets {d[:9].max():.0e}:", run.message)
verdict()
