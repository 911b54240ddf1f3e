# An integrator (or ensemble) with compiled code and a method with options pickles, and cannot be read again:
# "compiled=True is for methods by name; give compiled=tvi.compile(system, method)".
# Right: what is read again, or copied, makes the next step with the same bits.
import copy
import pickle

import tvi
from verdict import attempt, row, told, verdict


def V(q):
    return q[0]**2 / 2


def again(kept, read):
    """Whether what read() returns makes the next step of kept."""
    copied = attempt(read)
    if isinstance(copied, Exception):
        return row(False, told(copied))
    for orbit in kept, copied:
        orbit.integrate(0.1, 1)
    row(kept.q.tobytes() == copied.q.tobytes(), f"{type(copied).__name__}: q = {copied.q}")


system, method = tvi.potential(1, V), tvi.Method("galerkin", 8, max_tail=0.5)
code = tvi.compile(system, method)
for make in (lambda: tvi.Integrator(system, [1], [0], method=method, compiled=code),
             lambda: tvi.Ensemble(system, [[1]], [[0]], method=method, compiled=code)):
    orbit = make()
    again(orbit, lambda: pickle.loads(pickle.dumps(orbit)))
    orbit = make()
    again(orbit, lambda: copy.deepcopy(orbit))
verdict()
