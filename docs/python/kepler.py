import matplotlib.pyplot as plt
import numpy as np
import tvi

kepler = tvi.potential(2, lambda q: -1 / np.sqrt(q @ q))
run = tvi.solve(kepler, (0, 40000), q0=[1, 0], p0=[0, 0.6], error=1e-7, dense_output=True)
figure, (orbit, energy) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
orbit.plot(*run.sol(np.linspace(39900, 40000, 2000))[0].T, 0, 0, "o")
orbit.set(aspect="equal", title="t = 39,900 to 40,000", xlabel="x", ylabel="y")
energy.plot(run.t / 1000, run.energy / run.energy[0] - 1, ".", markersize=2)
energy.set(title="relative energy error", xlabel="t / 1000")
figure.savefig("kepler.png", dpi=90)
