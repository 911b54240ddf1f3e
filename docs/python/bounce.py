"""Bouncing balls: callbacks of events change the momenta, and the run goes on."""
import matplotlib.pyplot as plt
import numpy as np
import tvi

g, mass = 9.8, np.array([0.3, 0.1, 0.03])  # m/s^2, kg: three balls on one line, the heavy one below
balls = tvi.potential(3, lambda q: g * mass @ q, mass=mass)


def floor(t, q, p):  # the lowest ball keeps 0.9 of its speed
    return [-0.9 * p[0], p[1], p[2]]


def meeting(i):  # the balls i and i + 1 meet without loss: what they have of their centre of mass turns round
    def meet(t, q, p):
        p, pair = p.copy(), slice(i, i + 2)
        p[pair] = 2 * mass[pair] * p[pair].sum() / mass[pair].sum() - p[pair]
        return p
    return tvi.event(lambda q, p: q[i + 1] - q[i], direction=-1, callback=meet)


events = [tvi.event(lambda q, p: q[0], direction=-1, callback=floor), meeting(0), meeting(1)]
run = tvi.solve(balls, (0, 5), q0=[1, 1.1, 1.2], p0=0, h=0.05, events=events, dense_output=True)

figure, (height, energy) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained", width_ratios=[1.7, 1])
t = np.union1d(np.linspace(0, 5, 2000), run.t)
for y, m in zip(run.sol(t)[0].T, mass):
    height.plot(t, y, linewidth=0.8, label=f"{1000 * m:.0f} g")
height.set(title=f"{sum(len(found.t) for found in run.events)} collisions", xlabel="t / s", ylabel="height / m")
height.legend()
energy.plot(run.t, run.energy / run.energy[0], linewidth=1)
energy.set(title="energy: lost at the floor alone", xlabel="t / s", ylim=(0, 1.05))
figure.savefig("bounce.png", dpi=90)
