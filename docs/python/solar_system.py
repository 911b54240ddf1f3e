"""The outer Solar System for 500 years, with the perihelia of Pluto as events. Data: solar.h of the examples."""
import re
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import tvi

text = (Path(__file__).parent / "../examples/solar.h").read_text()
found = (re.search(rf"\b{name}(\[\w+\])? = ([^;]*);", text).group(2) for name in ("G", "mass", "place", "speed"))
G, mass, place, speed = (np.array(eval(numbers.translate(str.maketrans("{}", "[]")))) for numbers in found)


def pluto(q, p):  # r . v of Pluto as the Sun sees it
    return (q[15:] - q[:3]) @ (p[15:] / mass[5] - p[:3] / mass[0])


system = tvi.gravity.Bodies(mass, G=G).system()
days = 500 * 365.25
run = tvi.solve(system, (0, days), q0=place, v0=speed, h=500, t_eval=np.linspace(0, days, 2001),
                events=tvi.event(pluto, direction=1))

figure, (orbits, energy) = plt.subplots(1, 2, figsize=(9, 4.2), layout="constrained")
r = run.q.reshape(-1, 6, 3) - run.q.reshape(-1, 6, 3)[:, :1]
for body, name in enumerate("Jupiter Saturn Uranus Neptune Pluto".split(), start=1):
    orbits.plot(*r[:, body, :2].T, linewidth=0.6)
    top = r[np.argmax(r[:, body, 1]), body]
    orbits.text(top[0], top[1] + 0.5, name, fontsize=7, ha="center")
closest = run.events[0].q[:, 15:17] - run.events[0].q[:, :2]
orbits.plot(*closest.T, "k.")
orbits.annotate("Pluto's perihelia", closest[0], (-5, -14), fontsize=7, arrowprops={"arrowstyle": "-"})
orbits.set(aspect="equal", ylim=(-35, 55), title="500 years", xlabel="x / AU", ylabel="y / AU")
energy.plot(run.t / 365.25, run.energy / run.energy[0] - 1, ".", markersize=1)
energy.set(title="relative energy error", xlabel="t / years")
figure.savefig("solar_system.png", dpi=90)
