"""fit.py DIR: what fits cost in Python with derivatives of runs, beside differences of runs.

Writes DIR/least_squares.md, a fit of the 19 parameters of a chain of 16 masses (FPUT) to noisy places at 60 times, by
SciPy's least_squares and L-BFGS-B; and DIR/one_gradient.md, one loss of a chain of 64 with its derivatives by 195
values. Times are CPU times, each the least of several, which take turns.
"""
import sys
import time
from functools import partial

import numpy as np
from scipy.optimize import least_squares, minimize

import tvi

NOISE, TIMES = 0.01, np.linspace(1, 60, 60)
TRUTH = 0.25, 0.5  # a and b


def chain(n):
    def V(q, k, ab):
        ends = [0, *q, 0]
        r = [ends[i + 1] - ends[i] for i in range(n + 1)]
        return sum(k[i] * (r[i]**2 / 2 + ab[0] * r[i]**3 / 3 + ab[1] * r[i]**4 / 4) for i in range(n + 1))

    return tvi.potential(n, V, k=np.ones(n + 1), ab=TRUTH)


class Problem:
    """Places of a chain at the times, by its parameters x, or by its start and its parameters."""

    def __init__(self, n, has_start):
        self.n, self.system, self.has_start = n, chain(n), has_start
        self.q0 = np.sin(np.pi * np.arange(1, n + 1) / (n + 1))
        start = [self.q0, np.zeros(n)] if has_start else []
        self.begin = np.concatenate([*start, np.ones(n + 1), [0.2, 0.4]])
        truth = np.concatenate([*start, 1 + 0.1 * np.sin(np.arange(n + 1)**2), TRUTH])
        self.data = self.run(truth).q + NOISE * np.random.default_rng(1).normal(size=(len(TIMES), n))

    def run(self, x, **more):
        start, k, ab = x[:-self.n - 3], x[-self.n - 3:-2], x[-2:]
        q0, v0 = np.split(start, 2) if self.has_start else (self.q0, 0)
        return tvi.solve(self.system, (0, 60), q0, v0=v0, h=0.5, t_eval=TIMES, k=k, ab=ab, **more)

    def residuals(self, x):
        return ((self.run(x).q - self.data) / NOISE).ravel()

    def jacobian(self, x):
        by = self.run(x, jacobian=["k", "ab"]).by
        return np.concatenate([by.k, by.ab], axis=2)[:, :self.n].reshape(-1, len(x)) / NOISE

    def columns(self, x):
        return self.run(x, jacobian=["q0", "v0", "k", "ab"])

    def loss(self, x):
        r = self.residuals(x)
        return r @ r / 2

    def gradient(self, x):
        """The loss and its gradient."""
        run = self.run(x, gradient=True)
        r = (run.q - self.data) / NOISE
        g = run.gradient(q=r / NOISE)
        return (r**2).sum() / 2, np.concatenate([g.q0, g.v0, g.k, g.ab] if self.has_start else [g.k, g.ab])

    def differences(self, x):
        """The gradient by central differences."""
        d = 1e-6
        return np.array([(self.loss(x + d * e) - self.loss(x - d * e)) / (2 * d) for e in np.eye(len(x))])


def timed(ways, turns):
    """For each of the ways the least CPU time, and what it returned."""
    least, returned = [np.inf] * len(ways), [None] * len(ways)
    for _ in range(turns):
        for i, way in enumerate(ways):
            begin = time.process_time()
            returned[i] = way()
            least[i] = min(least[i], time.process_time() - begin)
    return least, returned


def table(name, head, rows):
    with open(f"{sys.argv[1]}/{name}.md", "w") as file:
        for row in (head, ["---"] * len(head), *rows):
            print("|" + "|".join(f" {cell} " for cell in row) + "|", file=file)


def compare_fits():
    at = Problem(16, False)
    lbfgs = partial(minimize, method="L-BFGS-B", options={"maxcor": 20, "maxiter": 1000, "ftol": 1e-9})
    ways = {"least_squares, `jacobian=`": lambda: least_squares(at.residuals, at.begin, jac=at.jacobian),
            "least_squares, its own differences": lambda: least_squares(at.residuals, at.begin),
            "L-BFGS-B, `gradient=`": lambda: lbfgs(at.gradient, at.begin, jac=True),
            "L-BFGS-B, its own differences": lambda: lbfgs(at.loss, at.begin)}
    seconds, fits = timed(list(ways.values()), 5)
    rows = [(name, f"{s:.3f}", fit.nfev, f"{2 * getattr(fit, 'cost', fit.fun) / at.data.size:.4f}")
            for name, s, fit in zip(ways, seconds, fits)]
    table("least_squares", ["FPUT 16, 19 parameters", "CPU, s (time)", "losses (chaotic)", "chi^2 / N"], rows)


def compare_gradients():
    at = Problem(64, True)
    x = at.begin
    ways = {"the loss alone": lambda: at.loss(x), "loss and gradient, `gradient=`": lambda: at.gradient(x)}
    seconds, (_, (_, exact)) = timed(list(ways.values()), 20)
    others = {"central differences": lambda: at.differences(x), "columns, `jacobian=`": lambda: at.columns(x)}
    more, (quotients, run) = timed(list(others.values()), 2)
    r = (run.q - at.data) / NOISE**2
    from_columns = np.einsum("ti,tij->j", r, np.concatenate([*vars(run.by).values()], axis=2)[:, :at.n])
    size = np.abs(exact).max()
    apart = ["", "", *(f"{np.abs(one - exact).max() / size:.0e}" for one in (quotients, from_columns))]
    rows = [(name, f"{1e3 * s:.3g}", f"{s / seconds[0]:.1f}", error)
            for name, s, error in zip([*ways, *others], seconds + more, apart)]
    head = ["FPUT 64, 195 values", "CPU, ms (time)", "in losses (time)", "apart from `gradient=` (chaotic)"]
    table("one_gradient", head, rows)


if __name__ == "__main__":
    compare_fits()
    compare_gradients()
