"""A Poincare section of the problem of Henon and Heiles, H = 1/8: where orbits cross x = 0 upwards."""
import matplotlib.pyplot as plt
import numpy as np
import tvi

system = tvi.potential(2, lambda q: q @ q / 2 + q[0]**2 * q[1] - q[1]**3 / 3)
starts = [(-0.15, 0)] + [(y, 0) for y in (0.03, 0.1, 0.17, 0.24, 0.29, 0.59, -0.3, -0.34)] \
    + [(0, s * p) for p in (0.24, 0.27) for s in (1, -1)]
y, p_y = np.array(starts).T
p_x = np.sqrt(1 / 4 - p_y**2 - y**2 + 2 / 3 * y**3)  # H = 1/8
crossing = tvi.event(lambda q, p: q[0], direction=1)
run = tvi.ensemble(system, (0, 6000), q0=np.stack([0 * y, y], axis=1), p0=np.stack([p_x, p_y], axis=1), h=0.5,
                   events=crossing)

points = run.events[0]
figure, section = plt.subplots(figsize=(6, 4.6), layout="constrained")
is_chaotic = points.member == 0
for some, color in (is_chaotic, "black"), (~is_chaotic, "tab:red"):
    section.plot(points.q[some, 1], points.p[some, 1], ",", color=color)
section.set(title=f"{len(points.t)} crossings: one chaotic orbit, black, and {len(y) - 1} others",
            xlabel="y", ylabel="p$_y$")
figure.savefig("henon_heiles.png", dpi=90)
