"""Gradients of runs in Python: against differences, in shapes and names, and refusals."""

import pickle
import unittest

import numpy as np
import tvi


def spring(q, k):
    return k * q[0]**2 / 2


def harmonic(q, k):
    return k[0] * q[0]**2 / 2 + 3 * k[1] * q[1]**2 / 2


SPRING = tvi.potential(1, spring, k=4.0)


def chain(n):
    def potential(q, k, ab):
        r = np.concatenate([[q[0]], q[1:] - q[:-1], [-q[-1]]])
        return sum(k[i] * r[i]**2 * (0.5 + ab[0] * r[i] / 3 + ab[1] * r[i]**2 / 4) for i in range(n + 1))

    return tvi.potential(n, potential, k=1 + 0.05 * np.sin(np.arange(n + 1)**2), ab=[0.25, 0.5])


def differences(function, x, d=1e-3):
    """Central differences of eighth order."""
    by, factors = np.empty(len(x)), (4 / 5, -1 / 5, 4 / 105, -1 / 280)
    for i in range(len(x)):
        e = np.zeros(len(x))
        e[i] = d
        by[i] = sum(f * (function(x + (k + 1) * e) - function(x - (k + 1) * e)) for k, f in enumerate(factors)) / d
    return by


class Gradients(unittest.TestCase):
    def test_data_at_times(self):
        n, times = 4, np.linspace(0, 10, 21)
        system, data = chain(n), np.random.default_rng(1).normal(size=(21, n))

        def run(x, **more):
            return tvi.solve(system, (0, 11), x[:n], v0=x[n:2 * n], h=0.5, t_eval=times, k=x[2 * n:3 * n + 1],
                             ab=x[3 * n + 1:], **more)

        x = np.concatenate([np.sin(np.arange(n)), np.cos(np.arange(n)), system.parameters["k"], [0.25, 0.5]])
        orbit = run(x, gradient=True)
        g = orbit.gradient(q=orbit.q - data, p_end=np.ones(n))
        by = np.concatenate([g.q0, g.v0, g.k, g.ab])
        loss = lambda x: (lambda r: ((r.q - data)**2).sum() / 2 + r.p_end.sum())(run(x))
        expected = differences(loss, x)
        np.testing.assert_allclose(by, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
        self.assertEqual((g.k.shape, g.ab.shape, np.shape(g.t0)), ((n + 1,), (2,), ()))
        self.assertIs(g.parameters["k"], g.k)
        self.assertIn("k, ab", repr(g))

    def test_runs_in_pieces_are_one_record(self):
        kepler = tvi.potential(2, lambda q, mu: -mu / np.sqrt(q @ q), mu=1.0)
        run = tvi.solve(kepler, (0, 3000), [1, 0], [0, 0.8], h=0.1, gradient=True)
        g = run.gradient(q_end=[1, 0], p_end=[0, 1])
        it = tvi.Integrator(kepler, [1, 0], [0, 0.8])
        it.tangent = np.eye(5)
        it.integrate_to(0.1, 3000)
        by = np.array([1, 0, 0, 1]) @ it.tangent[:4]
        np.testing.assert_allclose([*g.q0, *g.p0, g.mu], by, rtol=0, atol=1e-9 * np.abs(by).max())

    def test_events(self):
        kepler = tvi.potential(2, lambda q, mu: -mu / np.sqrt(q @ q), mu=1.0)
        closest = tvi.event(lambda q, p: q @ p, direction=1)
        axis = tvi.event(lambda q, p: q[1])

        def run(x, **more):
            return tvi.solve(kepler, (x[5], x[5] + 20), x[:2], x[2:4], h=0.1, events=[closest, axis], mu=x[4], **more)

        def loss(x):
            one, two = run(x).events
            return one.t.sum() + (two.q[:, 0]**2).sum() / 2 + two.p[1, 0]

        x = np.array([1, 0.1, 0.05, 0.8, 1, 0.3])
        orbit = run(x, gradient=True)
        one, two = orbit.events
        by_q, by_p = np.zeros_like(two.q), np.zeros_like(two.p)
        by_q[:, 0], by_p[1, 0] = two.q[:, 0], 1
        g = orbit.gradient(events=[{"t": np.ones(len(one.t))}, {"q": by_q, "p": by_p}])
        expected = differences(loss, x, 1e-4)
        np.testing.assert_allclose([*g.q0, *g.p0, g.mu, g.t0], expected, rtol=0, atol=1e-8 * np.abs(expected).max())

    def test_a_run_that_an_event_ends(self):
        spring = tvi.potential(1, lambda q, k: k * q[0]**2 / 2, k=4.0)
        zero = tvi.event(lambda q, p: q[0], terminal=True)
        run = tvi.solve(spring, (0, 10), [1], p0=0, h=0.1, events=zero, gradient=True)
        g = run.gradient(t_end=1)  # pi / (2 sqrt k)
        self.assertAlmostEqual(g.k, -np.pi / 4 * 4.0**-1.5, places=12)
        self.assertAlmostEqual(g.q0[0], 0, places=12)
        self.assertAlmostEqual(g.t0, 1, places=12)
        self.assertAlmostEqual(run.gradient(events={"t": [1]}).k, g.k, places=14)

    def test_integrals(self):
        spring = tvi.potential(1, lambda q, k: k * q[0]**2 / 2, k=4.0)
        work = [lambda q, p: p[0]**2, lambda q, p, t, k: k * t * q[0]]
        run = tvi.solve(spring, (0, 3), [1], p0=0, h=0.1, integrals=work, gradient=True)
        w = np.sqrt(4.0)
        self.assertAlmostEqual(run.integrals[0], w * (6 * w - np.sin(6 * w)) / 4, places=12)
        self.assertAlmostEqual(run.integrals[1], 3 * w * np.sin(3 * w) + np.cos(3 * w) - 1, places=12)
        g = run.gradient(integrals=[1, 0])
        by_w = (12 * w - np.sin(6 * w) - 6 * w * np.cos(6 * w)) / 4
        self.assertAlmostEqual(g.k, by_w / (2 * w), places=11)
        self.assertAlmostEqual(g.q0[0], 2 * run.integrals[0], places=11)
        g = run.gradient(integrals=[0, 1])
        self.assertAlmostEqual(g.k, 9 * np.cos(3 * w) / 2, places=11)

    def test_a_record_that_is_full(self):
        kepler = tvi.potential(2, lambda q, mu: -mu / np.sqrt(q @ q), mu=1.0)
        run = tvi.solve(kepler, (0, 1e5), [1, 0], [0, 0.8], h=0.1, gradient=40000)
        self.assertEqual((run.status, 0 < run.t_end < 1e5), (-1, True))
        self.assertIn("the record is full", run.message)
        whole = tvi.solve(kepler, (0, run.t_end), [1, 0], [0, 0.8], h=0.1, gradient=True)
        self.assertAlmostEqual(run.gradient(q_end=[1, 0]).mu / whole.gradient(q_end=[1, 0]).mu, 1, places=6)

    def test_second_derivatives(self):
        kepler = tvi.potential(2, lambda q, mu: -mu / np.sqrt(q @ q), mu=1.0)
        lifted, times = kepler.tangent(), np.linspace(0, 10, 11)

        def run(system, x, dx=np.zeros(0), **more):
            parts = [np.concatenate([x[i:i + 2], dx[i:i + 2]]) for i in (0, 2)]
            if len(dx):
                more["dmu"] = dx[4]
            return tvi.solve(system, (0, 10), parts[0], v0=parts[1], h=0.1, t_eval=times, gradient=True, mu=x[4],
                             **more)

        def gradient(x):  # of |q|^2 / 2
            orbit = run(kepler, x)
            g = orbit.gradient(q=orbit.q)
            return np.array([*g.q0, *g.v0, g.mu])

        x = np.array([1, 0.1, 0.05, 0.8, 1])
        H = np.empty((5, 5))
        for i, w in enumerate(np.eye(5)):
            orbit = run(lifted, x, w)
            g = orbit.gradient(q=np.roll(orbit.q, 2, axis=1))
            H[i] = *g.q0[:2], *g.v0[:2], g.mu
            np.testing.assert_allclose([*g.q0[2:], *g.v0[2:], g.dmu], gradient(x), rtol=1e-11)
        size = np.abs(H).max()
        np.testing.assert_allclose(H, H.T, rtol=0, atol=1e-11 * size)
        expected = [differences(lambda y, i=i: gradient(y)[i], x) for i in range(5)]
        np.testing.assert_allclose(H, expected, rtol=0, atol=1e-8 * size)

    def test_tangent_systems(self):
        system = tvi.potential(2, harmonic, mass=[1, 3], k=[2.0, 3.0]).tangent()
        self.assertEqual((system.n, list(system.parameters), system.has_energy), (4, ["k", "dk"], False))
        np.testing.assert_array_equal(system.masses, [1, 3, 1, 3])
        again = pickle.loads(pickle.dumps(system))
        start = (0, 3), [1, 2, 0, 0], [0, 0, 0, 0]
        for one in (system, again):
            q = tvi.solve(one, *start, h=0.1, k=[4, 9], dk=[1, 0]).q_end
            np.testing.assert_allclose(q, [np.cos(6), 2 * np.cos(9), -3 * np.sin(6) / 4, 0], rtol=0, atol=1e-13)
        self.assertIn("tangent, n = 4, k=[2. 3.], dk=[0. 0.]", repr(system))
        bent = tvi.lagrangian(1, lambda q, v, c: (1 + c * q[0]**2) * v[0]**2 / 2 - q[0]**2 / 2, c=0.3).tangent()
        run = tvi.solve(bent, (0, 1), [0.5, 0], [0.2, 0.4], h=0.1, dc=1)  # p is (dp, p)
        q, dp, p = run.q_end, *run.p_end
        mass, dmass = 1 + 0.3 * q[0]**2, q[0]**2 + 0.6 * q[0] * q[1]
        np.testing.assert_allclose(run.v[-1], [p / mass, dp / mass - p * dmass / mass**2], rtol=1e-13)
        driven = tvi.potential(1, lambda q: q[0]**2 / 2, mass=4).driven(lambda q, v: [-v[0]]).tangent()
        run = tvi.solve(driven, (0, 1), [1, 0], v0=[1, 2], h=0.1)
        np.testing.assert_allclose([*run.p[0], *run.v[0]], [4, 8, 1, 2], rtol=1e-14)
        for made in (lambda: bent.rescaled(lambda q, p: 1 + q[0]**2), lambda: bent.driven(lambda q, v: -v),
                     lambda: tvi.constrained(system, lambda q: [q[0]]), lambda: system.energy(0, [1] * 4, [0] * 4)):
            with self.assertRaisesRegex(tvi.Error, "a tangent system"):
                made()
        with self.assertRaisesRegex(tvi.Error, "a rescaled system has no tangent system"):
            SPRING.rescaled(lambda q, p: 1 + q[0]**2).tangent()
        with self.assertRaisesRegex(tvi.Error, "a constrained system has no tangent system"):
            tvi.constrained(tvi.potential(2, lambda q: q[1]), lambda q: [q @ q - 1]).tangent()
        with self.assertRaisesRegex(ValueError, "the system has a parameter dk"):
            tvi.potential(1, lambda q, k, dk: k * dk * q[0], k=1, dk=2).tangent()

    def test_pickles(self):
        run = tvi.solve(SPRING, (0, 1), [1], p0=0, h=0.1, gradient=True)
        again = pickle.loads(pickle.dumps(run))
        np.testing.assert_array_equal(again.q, run.q)
        with self.assertRaisesRegex(TypeError, "gradient=True"):
            again.gradient(q_end=[1])

    def test_refusals(self):
        spring = tvi.potential(1, lambda q, k: k * q[0]**2 / 2, k=4.0)
        general = tvi.hamiltonian(1, lambda q, p: p[0]**2 / 2 + q[0] * p[0] + q[0]**2)
        start = (0, 1), [1]
        with self.assertRaisesRegex(TypeError, "take run.h of a first run"):
            tvi.solve(spring, *start, p0=0, gradient=True)
        with self.assertRaisesRegex(TypeError, "take run.h of a first run"):
            tvi.solve(spring, *start, p0=0, tolerance=1e-9, gradient=True)
        with self.assertRaisesRegex(TypeError, "for constant masses: give p0="):
            tvi.solve(general, *start, v0=[0], h=0.1, gradient=True)
        with self.assertRaisesRegex(tvi.Error, "for the methods galerkin and stormer-verlet"):
            tvi.solve(spring, *start, p0=0, h=0.1, method="poincare", order=8, gradient=True)
        plain = tvi.solve(spring, *start, p0=0, h=0.1)
        with self.assertRaisesRegex(TypeError, "gradient=True"):
            plain.gradient(q_end=[1])
        run = tvi.solve(spring, *start, p0=0, h=0.1, gradient=True)
        with self.assertRaisesRegex(TypeError, "give t_eval"):
            run.gradient(q=[[1]])
        with self.assertRaisesRegex(TypeError, "integrals is a function of"):
            tvi.solve(spring, *start, p0=0, h=0.1, integrals=3)
        with self.assertRaisesRegex(TypeError, "gradient is a whole number, not str"):
            tvi.solve(spring, *start, p0=0, h=0.1, gradient="yes")
        with self.assertRaisesRegex(TypeError, "t_end= is for a run that an event ended"):
            run.gradient(t_end=1)
        with self.assertRaisesRegex(ValueError, "events has 1 entries, and the run has 0 functions"):
            run.gradient(events={"t": [1]})
        with self.assertRaisesRegex(ValueError, "q_end"):
            run.gradient(q_end=[1, 2])
        with self.assertRaises(ValueError):
            run.gradient(q_end=[np.nan])


if __name__ == "__main__":
    unittest.main()
