"""A charge in a magnetic mirror: a Hamiltonian with a vector potential, and the adiabatic invariant that turns it."""
import matplotlib.pyplot as plt
import numpy as np
import tvi

L = 30  # the field along the axis is 1 + (z / L)^2; units: charge, mass and the field in the middle are 1


def A(q):  # its vector potential, whose curl is the field
    return np.array([-q[1], q[0], 0 * q[2]]) * (1 + (q[2] / L)**2) / 2


def H(q, p):  # p is the canonical momentum v + A(q): give velocities as v0
    v = p - A(q)
    return v @ v / 2


mirror = tvi.hamiltonian(3, H)
t = np.r_[np.linspace(0, 95, 950), 100:20000:40]
run = tvi.solve(mirror, (0, 20000), q0=[1, 0, 0], v0=[0, -1, 1], error=1e-9, t_eval=t)
x, y, z = run.q.T
B = np.array([-x * z / L**2, -y * z / L**2, 1 + (z / L)**2])
along = (run.v.T * B).sum(axis=0)
mu = ((run.v**2).sum(axis=1) - along**2 / (B**2).sum(axis=0)) / (2 * np.sqrt((B**2).sum(axis=0)))

figure, (path, kept) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained", width_ratios=[1.3, 1])
path.plot(z[:950], x[:950], linewidth=0.8)
path.set(title="into the mirror and back, t to 95", xlabel="z", ylabel="x")
kept.plot(t[950:], mu[950:] / mu.mean() - 1, ".", markersize=2, label="magnetic moment")
kept.plot(t, run.energy / run.energy[0] - 1, linewidth=1.5, label="energy")
kept.set(title="relative change", xlabel="t")
kept.legend()
figure.savefig("mirror.png", dpi=80)
