# An ensemble whose t_eval has several times in one step: with 100 times all members fail with EINVAL, and with 1000
# the result has nan and says OK.
# Right: cos t at all times, to 1e-12, as tvi.solve has it, and the status OK of each member, for 10, 100 and 1000
# times.
import numpy as np

import tvi
from verdict import row, verdict

spring = tvi.potential(1, lambda q: q[0]**2 / 2)
for k in 10, 100, 1000:
    times = np.linspace(0, 10, k)
    many = tvi.ensemble(spring, (0, 10), [[1.0], [2.0]], [[0.0], [0.0]], h=0.5, t_eval=times, threads=1)
    one = tvi.solve(spring, (0, 10), [1.0], [0.0], h=0.5, t_eval=times)
    error = np.abs(many.q[:, :, 0] - np.outer([1, 2], np.cos(times))).max()
    row(np.all(many.status == "OK") and error < 1e-12, f"{k} times: {many}, error {error:.1e}")
    row(np.abs(one.q[:, 0] - np.cos(times)).max() < 1e-12, f"{k} times by tvi.solve")
verdict()
