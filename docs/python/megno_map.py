"""Order and chaos of Henon and Heiles' problem over the plane of the section, H = 1/8: 2 is regular."""
import matplotlib.pyplot as plt
import numpy as np
import tvi

system = tvi.potential(2, lambda q: q @ q / 2 + q[0]**2 * q[1] - q[1]**3 / 3)
y, p_y = np.meshgrid(np.linspace(-0.45, 0.7, 100), np.linspace(-0.5, 0.5, 100))
square = 1 / 4 - p_y**2 - y**2 + 2 / 3 * y**3  # of p_x, where H = 1/8
inside = square > 0
q0 = np.stack([0 * y[inside], y[inside]], axis=1)
p0 = np.stack([np.sqrt(square[inside]), p_y[inside]], axis=1)
value = np.full(y.shape, np.nan)
value[inside] = tvi.megno(system, (0, 300), q0, p0, h=0.5)

figure, axes = plt.subplots(figsize=(6, 4.4), layout="constrained")
image = axes.pcolormesh(y, p_y, value, vmin=1, vmax=6, cmap="cividis", rasterized=True)
figure.colorbar(image, label="MEGNO after t = 300", extend="both")
axes.set(title=f"{inside.sum()} orbits", xlabel="y", ylabel="p$_y$")
figure.savefig("megno_map.png", dpi=90)
