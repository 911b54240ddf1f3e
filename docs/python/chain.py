"""A chain of ten links that falls from level rest, and whips."""
import matplotlib.pyplot as plt
import numpy as np
import tvi

links, length, g = 10, 0.1, 9.8  # m, m/s^2; masses of 1 kg at the ends of the links


def lengths(q):
    x = [np.zeros(2), *(q[2 * k:2 * k + 2] for k in range(links))]
    return [((b - a) @ (b - a) - length**2) / 2 for a, b in zip(x, x[1:])]


chain = tvi.constrained(tvi.potential(2 * links, lambda q: g * sum(q[1::2])), lengths)
level = np.stack([length * np.arange(1, links + 1), np.zeros(links)], axis=1).ravel()
run = tvi.solve(chain, (0, 1.5), q0=level, v0=0, h=0.0025)

figure, (shapes, pivot) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
for k in range(0, len(run.t), 40):
    x = np.vstack([[0, 0], run.q[k].reshape(links, 2)])
    shapes.plot(*x.T, ".-", color=plt.cm.viridis(run.t[k] / 1.5), linewidth=1, markersize=4)
shapes.set(aspect="equal", title="every 0.1 s", xticks=[-1, -0.5, 0, 0.5, 1], xlabel="x / m", ylabel="y / m")
pivot.plot(run.t, run.multipliers[:, 0] * length, linewidth=1)
pivot.axhline(links * g, color="k", linestyle=":", linewidth=0.8)
pivot.set(title="force at the pivot, and the weight", xlabel="t / s", ylabel="N")
figure.savefig("chain.png", dpi=90)
unit = g * length * links * (links + 1) / 2
print("energy kept to %.0e, lengths to %.0e" % (np.ptp(run.energy) / unit, abs(run.phi).max() / length**2))
