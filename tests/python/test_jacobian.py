"""The derivatives of tvi.solve(jacobian=...) are those of the run, by differences of runs; least squares take them."""

import unittest

import numpy as np

import tvi
from problems import same_bits

N = 6
TIMES = np.linspace(0, 12, 25)
MASS = np.linspace(1, 2, N)
Q0, V0 = np.sin(np.pi * np.arange(1, N + 1) / (N + 1)), 0.1 * np.cos(np.arange(N))
STIFFNESS, BENT = 1 + 0.05 * np.arange(N + 1), np.array([0.25, 0.5])


def chain():
    def potential(q, k, ab):
        ends = [0, *q, 0]
        stretched = [ends[i + 1] - ends[i] for i in range(N + 1)]
        return sum(k[i] * (r**2 / 2 + ab[0] * r**3 / 3 + ab[1] * r**4 / 4) for i, r in enumerate(stretched))

    return tvi.potential(N, potential, mass=MASS, k=STIFFNESS, ab=BENT)


def pendulum(kind="driven"):
    if kind == "hamiltonian":
        return tvi.hamiltonian(1, lambda q, p, k: (1 + q[0]**2) * p[0]**2 / 2 - k * np.cos(q[0]), k=1.3)
    plain = tvi.potential(1, lambda q, k: -k * np.cos(q[0]), k=1.3)
    return plain.driven(lambda q, v, t, c: [0.3 * np.cos(0.6 * t) - c * v[0]], c=0.05)


def states(run):
    return np.concatenate([run.q, run.p], axis=1)


class Jacobian(unittest.TestCase):
    def differences(self, system, by, given, **run):
        """All derivatives beside quotients of the fourth order, whose own error is some 1e-12."""
        step = 1e-3

        def states_from(name, x):
            return states(tvi.solve(system, (0, 12), t_eval=TIMES, **{**given, name: x}, **run))

        for name, derivative in vars(by).items():
            value = np.array(given[name], dtype=float)
            self.assertEqual(derivative.shape, (len(TIMES), 2 * system.n, *value.shape))
            for i in np.ndindex(value.shape):
                d = np.zeros(value.shape)
                d[i] = step
                near, far = (states_from(name, value + m * d) - states_from(name, value - m * d) for m in (1, 2))
                with self.subTest(f"{system} {name} {i} {run}"):
                    quotient = (8 * near - far) / (12 * step)
                    size = np.abs(quotient).max()
                    self.assertLess(np.abs(derivative[(..., *i)] - quotient).max(), 1e-8 * size)

    def right(self, system, names, given, **run):
        result = tvi.solve(system, (0, 12), t_eval=TIMES, jacobian=names, **given, **run)
        self.assertEqual(set(vars(result.by)), set(np.atleast_1d(names)))
        self.differences(system, result.by, given, **run)
        plain = tvi.solve(system, (0, 12), t_eval=TIMES, **given, **run)
        self.assertTrue(same_bits(states(result), states(plain)))
        self.assertIsNone(result.integrator.tangent)

    def test_differences(self):
        start = {"q0": Q0, "v0": V0, "k": STIFFNESS, "ab": BENT}
        self.right(chain(), ["k", "ab", "q0", "v0"], start, h=0.4)
        self.right(chain(), ["ab", "v0"], start, h=0.05, method="stormer-verlet", order=2)
        self.right(pendulum(), ["c", "q0", "v0", "k"], {"q0": [0.4], "v0": [0.1], "k": 1.3, "c": 0.05}, h=0.3)
        self.right(pendulum("hamiltonian"), ["k", "q0", "p0"], {"q0": [0.4], "p0": [0.1], "k": 1.3}, h=0.2)

    def test_alone(self):
        """What is not moved at once is moved alone: a generating function, K = g (H + e), constraints."""
        start = {"q0": [0.4], "p0": [0.1], "k": 1.3}
        self.right(pendulum("hamiltonian"), "k", start, h=0.2, method="midpoint", order=12)
        self.right(pendulum("hamiltonian").rescaled(lambda q, p: 1 / (2 + q[0])), ["p0", "k"], start, h=0.2)
        rod = tvi.constrained(tvi.potential(2, lambda q, a: a * q[1], a=1.0), lambda q: [(q @ q - 1) / 2])
        self.right(rod, ["a"], {"q0": [1, 0], "v0": [0, 0], "a": 1.0}, h=0.2)

    def test_initial(self):
        """At the start: the identity, masses by velocities, 0 by parameters."""
        by = tvi.solve(chain(), (0, 1), Q0, v0=V0, h=0.5, t_eval=[0, 1], jacobian=["q0", "v0", "k"]).by
        np.testing.assert_array_equal(by.q0[0], np.eye(2 * N)[:, :N])
        np.testing.assert_array_equal(by.v0[0], np.concatenate([np.zeros((N, N)), np.diag(MASS)]))
        np.testing.assert_array_equal(by.k[0], np.zeros((2 * N, N + 1)))
        self.assertIn("k (2, 12, 7)", repr(by))

    def test_least_squares(self):
        """Gauss and Newton find the parameters of a run, from 10 % beside them."""
        system = chain()
        data = tvi.solve(system, (0, 12), Q0, v0=V0, h=0.4, t_eval=TIMES).q
        x = np.concatenate([STIFFNESS, BENT]) * (1 + 0.1 * np.sin(np.arange(N + 3)))
        for _ in range(8):
            run = tvi.solve(system, (0, 12), Q0, v0=V0, h=0.4, t_eval=TIMES, jacobian=["k", "ab"], k=x[:-2], ab=x[-2:])
            derivative = np.concatenate([run.by.k, run.by.ab], axis=2)[:, :N].reshape(-1, len(x))
            x = x + np.linalg.lstsq(derivative, (data - run.q).reshape(-1), rcond=None)[0]
        self.assertLess(np.abs(x - np.concatenate([STIFFNESS, BENT])).max(), 1e-11)

    def test_end(self):
        """A terminal event, and a step that is refused: as many rows as times were reached."""
        event = tvi.event(lambda q, p: q[0], terminal=True)
        run = tvi.solve(chain(), (0, 12), Q0, v0=V0, h=0.4, t_eval=TIMES, events=event, jacobian="k")
        self.assertEqual((run.status, len(run.by.k)), (1, len(run.t)))
        self.assertLess(len(run.t), len(TIMES))
        fall = tvi.potential(1, lambda q, k: -k / q[0], k=1.0)
        run = tvi.solve(fall, (0, 12), [1], p0=0, h=0.05, t_eval=TIMES, jacobian="k")
        self.assertEqual((run.status, len(run.t), len(run.by.k)), (-1, 3, 3))  # It falls to 0 at 1.11.

    def test_refusals(self):
        given = {"h": 0.4, "t_eval": TIMES}
        for text, options in (("needs h: take run.h", {"h": None, "jacobian": "k"}),
                              ("give the times", {"t_eval": None, "jacobian": "k"}),
                              ("'x' is none of k, ab, q0, v0", {"jacobian": ["k", "x"]}),
                              ("no derivative by p0", {"jacobian": "p0"}),
                              ("a name twice", {"jacobian": ["k", "k"]}), ("no names", {"jacobian": []})):
            with self.subTest(text), self.assertRaisesRegex(TypeError, text):
                tvi.solve(chain(), (0, 12), Q0, v0=V0, **{**given, **options})
        with self.assertRaisesRegex(TypeError, "no derivative by v0"):
            tvi.solve(chain(), (0, 12), Q0, p0=V0, jacobian="v0", **given)
        with self.assertRaisesRegex(TypeError, "give p0"):
            tvi.solve(pendulum("hamiltonian"), (0, 12), [1], v0=[1], jacobian="k", **given)


if __name__ == "__main__":
    unittest.main()
