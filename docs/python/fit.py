"""A fit: stiffness, friction and drive of an oscillator from noisy positions, by the derivatives of its steps."""
import matplotlib.pyplot as plt
import numpy as np
import tvi

truth, noise = dict(k=4.0, c=0.15, F=0.6), 0.02
spring = tvi.potential(1, lambda q, k, w: k * (1 - np.cos(q[0])), k=1.0, w=1.3)
system = spring.driven(lambda q, v, t, w, c, F: [F * np.cos(w * t) - c * v[0]], c=0.1, F=0.1)
names, times = ["k", "c", "F"], np.linspace(0.5, 40, 80)
rows = [2 + list(system.parameters).index(name) for name in names]  # of the tangent vectors: dq, dp, parameters


def model(values):
    """The positions at the times, and their derivatives by the three parameters."""
    orbit = tvi.Integrator(system, q=[0.5], p=0, **dict(zip(names, values)))
    orbit.tangent = np.eye(system.tangent_rows)[:, rows]
    seen = []
    orbit.run(h=0.25, times=times, at_time=lambda k, t, q, p: seen.append((q[0], *orbit.tangent[0])))
    return np.array(seen)


data = model(truth.values())[:, 0] + noise * np.random.default_rng(1).normal(size=len(times))
start = [3.6, 0.3, 0.3]
x = np.array(start)
for _ in range(8):  # Gauss-Newton; scipy.optimize.least_squares takes the same derivatives as jac=
    q, *columns = model(x).T
    jacobian = np.transpose(columns) / noise
    x += np.linalg.lstsq(jacobian, (data - q) / noise, rcond=None)[0]
sigma = np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))
for name, value, one in zip(names, x, sigma):
    print(f"{name} = {value:.4f} +- {one:.4f}, and is {truth[name]}")

figure, (seen, rest) = plt.subplots(2, 1, figsize=(8, 4.2), layout="constrained", height_ratios=[2, 1], sharex=True)
seen.plot(times, model(start)[:, 0], ":", label="start")
seen.plot(times, model(x)[:, 0], label="fit")
seen.plot(times, data, "k.", markersize=4, label="data")
seen.legend(ncols=3)
rest.plot(times, data - model(x)[:, 0], "k.", markersize=4)
rest.set(title="residuals", xlabel="t")
figure.savefig("fit.png", dpi=90)
