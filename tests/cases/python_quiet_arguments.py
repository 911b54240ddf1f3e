# Arguments of tvi.gravity that are accepted and do nothing, or are refused in words that point elsewhere: J2
# without a radius is no J2; "mass[3] = -0.001" has the number of a coordinate; five conditions for orbital
# elements, and not which of them failed; "a driven system has no Hamiltonian flow" does not say what serves; a
# value that is not finite is a step that is too large to a tolerance; a run that is refused does not say that 1.3 %
# of it were looked at to choose the step.
# Right: the texts name the argument: radius; mass[1] of the user's list; the element with the condition that
# failed, and no other; h or tolerance for a driven system; "not finite"; the part that was looked at. The node of
# an orbit about a planet with J2 moves by -3/2 J2 (R/p)^2 n cos i t = -0.27 in 5 days, to 2 % (the next order of
# the theory).
import numpy as np

import tvi
from tvi import gravity
from verdict import attempt, refuses, row, told, verdict

mu, J2, radius = 398600.4418, 1.08263e-3, 6378.137


def node(**oblateness):
    """The longitude of the node after 5 days."""
    x, v = gravity.Orbit(a=7500, e=0.08, i=1).state(mu)
    b = gravity.Bodies([mu, 0], **oblateness)
    q0, v0 = np.r_[0, 0, 0, x], np.r_[0, 0, 0, v]
    run = tvi.solve(b.system(), (0, 432000), q0, v0=v0, h=300)
    moved, speed = run.q_end, b.velocities(run.p_end)
    return gravity.Orbit.of(mu, moved[3:] - moved[:3], speed[3:] - speed[:3]).node


answer = attempt(lambda: node(J2=J2))
row(refuses(answer, "radius"), "J2 without a radius:", told(answer))
secular = -1.5 * J2 * (radius / 7500 / (1 - 0.08**2))**2 * np.sqrt(mu / 7500**3) * np.cos(1) * 432000
answer = attempt(lambda: node(J2=J2, radius=radius))
row(not isinstance(answer, Exception) and abs(answer / secular - 1) < 0.02, f"J2: {told(answer)}, right {secular:.4f}")

for mass, word in ([1, -1e-3], r"mass\[1\]"), ([1, 1e-3, -1e-9], r"mass\[2\]"):
    answer = attempt(lambda: gravity.Bodies(mass).system())
    row(refuses(answer, word), mass, told(answer))

inclination = r"\bi\b|inclination"
for elements, word, other in (dict(a=1, e=1), r"\b[aqe]\b", inclination), (dict(e=0.1), r"\b[aq]\b", inclination), \
        (dict(a=-1, e=0.5), r"\ba\b", inclination), (dict(a=1, i=-1e-17), inclination, r"\b(mu|e|q)\b"):
    answer = attempt(lambda: gravity.Orbit(**elements).state(1))
    row(refuses(answer, word, without=(other,)), elements, told(answer))

answer = attempt(lambda: gravity.Bodies([1, 0]).system().driven(lambda q, v: -1e-3 * v).rescaled(lambda q, p: q @ q))
row(refuses(answer, r"tolerance|\bh\b|fixed steps"), "rescaled of driven:", told(answer))

bad = tvi.force(1, lambda q, t: [np.log(np.cosh(1000 * (1 - t)))])  # infinite at t = 0
for way in dict(h=0.1), dict(tolerance=1e-9):
    run = attempt(lambda: tvi.solve(bad, (0, 2), [0], [0], **way))
    text = told(run) if isinstance(run, Exception) else run.message
    row("not finite" in text, way, text)

kozai = gravity.Bodies([1, 1e-3, 1])
y, w = gravity.Orbit(a=[1, 15], e=[0.001, 0], i=[1.4, 0]).state([1.001, 2.001])
q, p = kozai.to_centre(np.r_[0, 0, 0, y.ravel()], kozai.momenta(np.r_[0, 0, 0, w.ravel()]))
run = attempt(lambda: tvi.solve(kozai.system(), (0, 30000), q, p, error=1e-6))
if isinstance(run, Exception):
    row(refuses(run), told(run))
else:
    row(run.success or "looked at" in run.message, "refused run:", run.message)
verdict()
