"""A comet (e = 0.97) that Jupiter disturbs: steps that adapt, and what each passage changes."""
import matplotlib.pyplot as plt
import numpy as np
import tvi

GM, year = 0.01720209895**2, 365.25  # AU^3 / day^2; the Sun stays at 0, Jupiter goes round it on a circle
a_jupiter, m_jupiter = 5.2, 1 / 1047.35
n = np.sqrt(GM / a_jupiter**3)


def V(q, t):
    jupiter = a_jupiter * np.array([np.cos(n * t), np.sin(n * t)])
    return -GM / np.sqrt(q @ q) - GM * m_jupiter / np.sqrt((q - jupiter) @ (q - jupiter))


def g(q, p, t):  # the time scale of a fall towards the Sun, and towards Jupiter where that is the shorter one
    jupiter = a_jupiter * np.array([np.cos(n * t), np.sin(n * t)])
    d = q - jupiter
    return (GM**2 / (q @ q)**3 + (GM * m_jupiter)**2 / (d @ d)**3)**-0.25


comet = tvi.potential(2, V).rescaled(g)
a, e = 17.8, 0.97
run = tvi.solve(comet, (0, 6000 * year), q0=[-a * (1 + e), 0], p0=[0, -np.sqrt(GM / a * (1 - e) / (1 + e))], h=0.3,
                events=tvi.event(lambda q, p: q @ p, direction=-1))  # aphelia

far = run.events[0]
kepler = (far.p**2).sum(axis=1) / 2 - GM / np.linalg.norm(far.q, axis=1)
figure, (orbit, size) = plt.subplots(2, 1, figsize=(8, 5), layout="constrained", height_ratios=[1, 1.1])
orbit.plot(*run.q[:70].T, ".-", markersize=4, linewidth=0.5)
orbit.plot(0, 0, "o", color="orange")
orbit.plot(*a_jupiter * np.array([np.cos(np.linspace(0, 7, 100)), np.sin(np.linspace(0, 7, 100))]), "k:", linewidth=0.8)
orbit.set(aspect="equal", xlabel="x / AU", ylabel="y / AU",
          title=f"the first 70 of {run.stats.steps} steps, and Jupiter's orbit")
size.plot(far.t / year, -GM / (2 * kepler), ".-", markersize=3, linewidth=0.5)
size.set(title=f"semi-major axis at {len(far.t)} aphelia", xlabel="t / years", ylabel="a / AU")
figure.savefig("comet.png", dpi=90)
