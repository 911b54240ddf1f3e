"""Dzhanibekov's wing nut: what spins about its middle axis turns over, again and again."""
import matplotlib.pyplot as plt
import numpy as np
import tvi
from tvi import rigid

nut = rigid.Bodies(rigid.box(0.01, 0.02, 0.03, 0.05))  # kg, m: axis 1 is the middle one
q, p = nut.state(rigid.Motion(omega=[0.01, 10, 0.01]))  # rad/s
run = tvi.solve(nut.system(), (0, 12), q, p, h=0.02)
motion, L = nut.motion(run.q, run.p), nut.angular_momentum(run.q, run.p)

figure = plt.figure(figsize=(9, 3.8), layout="constrained")
spin, ball = figure.add_subplot(121), figure.add_subplot(122, projection="3d")
for k, omega in enumerate(motion.omega.T):
    spin.plot(run.t, omega, label=f"about axis {k}", linewidth=1.2)
spin.set(title="angular velocity about the nut's own axes", xlabel="t / s", ylabel="rad/s", ylim=(-11, 14))
spin.legend(loc="upper center", ncols=3, fontsize=8)

x, y, z = motion.rotation[run.t < 4, :, 1].T  # the middle axis in space; y is up in the picture
u, v = np.mgrid[0:2 * np.pi:17j, 0:np.pi:9j]
ball.plot_wireframe(np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v), color="0.85", linewidth=0.5)
ball.plot(z, x, y, color="C1", linewidth=1.2)
ball.set_box_aspect((1, 1, 1), zoom=1.4)
ball.set_axis_off()
ball.set_title("the middle axis in space, 0 to 4 s")
figure.savefig("wing_nut.png", dpi=80)
moved = np.linalg.norm(L - L[0], axis=1).max() / np.linalg.norm(L[0])
print("energy kept to %.0e, angular momentum to %.0e" % (np.ptp(run.energy) / run.energy[0], moved))
