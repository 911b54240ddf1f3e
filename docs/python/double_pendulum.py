"""A double pendulum, and one beside it that starts 1e-10 rad away: chaos in thirty seconds."""
import matplotlib.pyplot as plt
import numpy as np
import tvi

g = 9.8  # m/s^2; both rods are 1 m long, both masses 1 kg, q are their angles from below, in rad
system = tvi.lagrangian(2, lambda q, v: v[0]**2 + v[1]**2 / 2 + v[0] * v[1] * np.cos(q[0] - q[1])
                        + g * (2 * np.cos(q[0]) + np.cos(q[1])))
t = np.linspace(0, 30, 3001)
one, other = (tvi.solve(system, (0, 30), q0=[2, 2.5 + d], p0=0, h=0.02, t_eval=t) for d in (0, 1e-10))

figure, (path, distance) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
x, y = np.sin(one.q).sum(axis=1), -np.cos(one.q).sum(axis=1)
path.plot(x[:1000], y[:1000], linewidth=0.8)
path.plot([0, np.sin(2), x[0]], [0, -np.cos(2), y[0]], "ko-", markersize=4)
path.set(aspect="equal", title="the lower mass, 10 s", xlabel="x / m", ylabel="y / m")
distance.semilogy(t, np.linalg.norm(one.q - other.q, axis=1), linewidth=0.8)
distance.set(title="distance of the two", xlabel="t / s", ylabel="angle / rad")
figure.savefig("double_pendulum.png", dpi=90)
print("energy kept to %.0e" % np.ptp(one.energy / one.energy[0]))
