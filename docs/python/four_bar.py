"""A four-bar linkage: a crank, a rocker, the rod between their ends, and a point that the rod carries."""
import matplotlib.pyplot as plt
import numpy as np
import tvi

pivot = np.array([2.2, 0.0])  # of the rocker; that of the crank is the origin. q: the ends of both


def rods(q):
    crank, rocker, coupler = q[:2], q[2:] - pivot, q[2:] - q[:2]
    return [(d @ d - length**2) / 2 for d, length in ((crank, 1), (rocker, 1.5), (coupler, 2))]


weight = tvi.potential(4, lambda q: 9.8 * (q[1] + 2 * q[3]), mass=[1, 1, 2, 2])
linkage = tvi.constrained(weight, rods)
q0, p0 = linkage.project([0, 1, 2, 1.5], v=[7, 0, 0, 0])  # near a sketch, with a push
run = tvi.solve(linkage, (0, 3), q0, p0, h=0.01)

figure, (path, tension) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
crank, rocker = run.q[:, :2], run.q[:, 2:]
along = rocker - crank
carried = crank + along / 2 + 0.5 * np.stack([-along[:, 1], along[:, 0]], axis=1)
for line in (crank, rocker, carried):
    path.plot(*line.T, linewidth=1)
path.plot(*np.array([[0, 0], crank[0], carried[0], rocker[0], crank[0], rocker[0], pivot]).T, "ko-", markersize=4)
path.set(aspect="equal", title="paths of both ends and of a point between", xlabel="x / m", ylabel="y / m")
tension.plot(run.t, run.multipliers * [1, 1.5, 2], linewidth=1, label=["crank", "rocker", "coupler"])
tension.set(title="tension of the rods", xlabel="t / s", ylabel="N")
tension.legend(loc="upper center")
figure.savefig("four_bar.png", dpi=90)
print("energy kept to %.0e, lengths to %.0e" % (np.ptp(run.energy / run.energy[0]), abs(run.phi).max()))
