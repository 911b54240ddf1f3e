# CC=' ', blanks alone: tvi.solve of a run that is long enough to be compiled ends in IndexError.
# Right: the run ends at its event, t = pi/2, or is refused with a text that names CC; h=5e-324, with which the
# number of steps overflows, is refused with a text that names h.
import os

os.environ["CC"] = " "

import numpy as np  # noqa: E402

import tvi  # noqa: E402
from verdict import attempt, refuses, row, told, verdict  # noqa: E402

stop = tvi.event(lambda q, p: q[0], terminal=True)
spring = tvi.potential(1, lambda q: q[0]**2 / 2)
for t_end, h, word in (1e8, 0.5, r"\bCC\b"), (1, 5e-324, r"\bh\b"):
    run = attempt(lambda: tvi.solve(spring, (0, t_end), [1], [0], h=h, events=stop))
    if isinstance(run, Exception):
        row(refuses(run, word), f"h = {h}:", told(run))
    else:
        row(abs(run.t_end - np.pi / 2) < 1e-9 if h == 0.5 else run.status < 0, f"h = {h}:", run)
verdict()
