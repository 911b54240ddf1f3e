# What users of numpy write into functions, and texts that do not help: np.zeros and an assignment, the commonest
# way to write a force of many bodies, has a text that speaks of math.sin.
# Right: the value that the function has for numbers; or a refusal whose text names the function or argument, and
# says what to write instead, as that of abs() does. The objects of SciPy are those of SciPy where it can be
# imported, and else stand-ins that meet a jet as they do.
import numpy as np

import tvi
from verdict import attempt, refuses, row, told, verdict

try:
    from scipy.interpolate import CubicSpline
    from scipy.sparse import diags
    from scipy.special import expit
    spline, band = CubicSpline([0, 1, 2, 3], [0, 1, 4, 9]), diags([-1, 2, -1], [-1, 0, 1], shape=(3, 3)).tocsr()
except ImportError:
    def spline(x):
        """x^2, of an array of doubles."""
        return np.asarray(x).astype(float)**2

    class Band:
        """A sparse matrix, which multiplies arrays of numbers only."""
        __array_priority__ = 10.1

        def __matmul__(self, q):
            if np.asarray(q).dtype == object:
                raise TypeError("no supported conversion for types: (dtype('float64'), dtype('O'))")
            return np.array([[2, -1, 0], [-1, 2, -1], [0, -1, 2]]) @ q

    band = Band()

    def expit(x):
        return np.logaddexp(0, x) if isinstance(x, tvi.Jet) else 1 / (1 + np.exp(-x))


def pairs(q):
    F = np.zeros(len(q))
    F[0] = q[1] - q[0]
    F[1] = -F[0]
    return F


HELP = r"(?i)\binstead\b|\bwrite\b|\buse\b"
AGAIN = r"without numbers\. Write np\.sin, not math\.sin$"  # the hint for another mistake, alone
for name, n, f, *words in (
    ("np.interp", 1, lambda q: np.interp(q[0], [0, 1], [0, 1]), r"np\.interp", HELP),
    ("CubicSpline", 1, lambda q: spline(q[0]), HELP),
    ("np.gradient", 3, lambda q: np.sum(np.gradient(q)**2), "gradient", HELP),
    ("np.fft", 4, lambda q: np.sum(np.abs(np.fft.rfft(q))**2), "fft", HELP),
    ("sparse matrix @ q", 3, lambda q: q @ (band @ q), HELP),
    ("np.linalg.det", 4, lambda q: np.linalg.det(q.reshape(2, 2)), "det", HELP),
    ("np.einsum", 3, lambda q: np.einsum("i,i->", q, q), "einsum", HELP),
    ("np.logaddexp", 1, lambda q: np.logaddexp(0, q[0]), "logaddexp", HELP),
    ("expit", 1, lambda q: expit(q[0]), HELP),
    ("np.cbrt", 1, lambda q: np.cbrt(q[0]), "cbrt", HELP),
    ("np.heaviside", 1, lambda q: np.heaviside(q[0], 0), "heaviside", HELP),
    ("np.maximum", 1, lambda q: np.maximum(q[0], 0)**2, HELP),
    ("complex numbers", 1, lambda q: np.real(np.exp(1j * q[0])), "complex", HELP),
):
    point = np.linspace(0.3, 0.9, n)
    answer = attempt(lambda: tvi.potential(n, f).energy(0, point, np.zeros(n)))
    if isinstance(answer, Exception):
        row(refuses(answer, *words, without=(AGAIN,)), name, told(answer))
    else:
        row(abs(answer - f(point)) < 1e-13, name, answer)



def kinetic(q, p):
    return p @ np.linalg.solve(np.eye(2) + np.outer(q, q), p)


power = tvi.potential(1, lambda q, a, b: a * q[0]**b, a=1.0, b=2.0)
for name, make, *words in (
    ("np.zeros, then F[i] = ...", lambda: tvi.force(2, pairs), r"np\.empty", "object"),
    ("np.linalg.solve", lambda: tvi.hamiltonian(2, kinetic), "solve", HELP),
    ("arccos at -1", lambda: tvi.solve(tvi.potential(1, lambda q: np.arccos(q[0])), (0, 1), [-1], [0]), "arccos|acos"),
    ("tangent of 2n rows, 2 parameters", lambda: setattr(tvi.Integrator(power, [1], [0]), "tangent", np.eye(2)),
     "4", "parameter"),
):
    answer = attempt(make)
    row(refuses(answer, *words, without=(AGAIN,)), name, told(answer))
verdict()
