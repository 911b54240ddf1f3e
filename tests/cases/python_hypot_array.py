# np.hypot and np.arctan2 of a number and an array of jets: "'float' object has no attribute 'hypot'".
# Right: the potential that the function has for numbers, or a refusal whose text names the function.
import numpy as np

import tvi
from verdict import attempt, refuses, row, told, verdict

point = np.array([0.3, -0.7])
for name, f in (
    ("hypot", lambda q: np.hypot(q, 1.0).sum()),
    ("hypot", lambda q: np.hypot(1.0, q).sum()),
    ("hypot", lambda q: np.hypot(1.0, q[0])),
    ("arctan2", lambda q: np.arctan2(1.0, q).sum()),
    ("arctan2", lambda q: np.arctan2(q, 1.0).sum()),
):
    answer = attempt(lambda: tvi.potential(2, f).energy(0, point, np.zeros(2)))
    is_right = refuses(answer, rf"np\.{name}") if isinstance(answer, Exception) else abs(answer - f(point)) < 1e-14
    row(is_right, name, told(answer))
verdict()
