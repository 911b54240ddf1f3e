"""tvi.gravity: the same bits as tvi_bodies.h in C (test_bits.py), numpy's shapes, and what is refused."""

import math
import pickle
import pydoc
import unittest

import numpy as np

import tvi
from problems import same_bits
from tvi import gravity

RANDOM = np.random.default_rng(5)
MASS = np.array([3, 0.5, 0, 2e-3])


def with_field(q, t):
    """A planet in the field of two suns that go round each other."""
    x, y = np.cos(t) / 2, np.sin(t) / 2
    return gravity.Bodies([0.5, 0.5], axes=2).field([x, y, -x, -y], q)


class Potentials(unittest.TestCase):
    def test_values(self):
        """As written with numpy, in 1 to 3 axes."""
        for axes in (1, 2, 3):
            bodies = gravity.Bodies(MASS, axes, G=2.5, softening=0.1)
            r = RANDOM.normal(size=(4, axes))
            d = np.sqrt(((r[:, None] - r[None])**2).sum(axis=-1) + 0.01)
            own = np.where(MASS > 0, MASS, 1e-30 * 3)
            V = sum(-2.5 * own[i] * own[j] / d[i, j] for i in range(4) for j in range(i))
            S = sum((2.5 * (own[i] + own[j]))**(1 / 3) / d[i, j] for i in range(4) for j in range(i))
            self.assertAlmostEqual(bodies.potential(r.ravel()) / V, 1, delta=1e-14)
            self.assertAlmostEqual(bodies.system().energy(0, r.ravel(), 0 * r.ravel()) / V, 1, delta=1e-14)
            self.assertAlmostEqual(bodies.scale(r.ravel()) / S**-1.5, 1, delta=1e-14)
            x = RANDOM.normal(size=axes)
            to = np.sqrt(((r - x)**2).sum(axis=1) + 0.01)
            self.assertAlmostEqual(bodies.field(r.ravel(), x) / -(2.5 * MASS / to).sum(), 1, delta=1e-14)
            self.assertAlmostEqual(bodies.field_scale(r.ravel(), x) / (2.5 * MASS / to**3).sum()**-0.5, 1, delta=1e-14)

    def test_an_oblate_body(self):
        """The second one of three: two pairs have a term more."""
        q, mass, pole = RANDOM.normal(size=(3, 3)), np.array([2, 3, 4]), np.array([2, -3, 6])
        wanted = 0.0
        for i, j in ((0, 1), (0, 2), (1, 2)):
            d = q[j] - q[i]
            r, z = np.linalg.norm(d), pole @ d / 7
            J2 = 0.01 * (1 in (i, j))
            wanted -= mass[i] * mass[j] / r * (1 - J2 * 0.16 * (3 * z**2 / r**2 - 1) / (2 * r**2))
        bodies = gravity.Bodies(mass, J2=0.01, radius=0.4, pole=pole, oblate=1)
        self.assertAlmostEqual(bodies.potential(q.ravel()) / wanted, 1, delta=1e-14)
        upright = gravity.Bodies(mass, J2=0.01, radius=0.4, oblate=1).potential(q.ravel())
        self.assertGreater(abs(upright / wanted - 1), 1e-6)

    def test_steps_that_adapt(self):
        """Of an eccentric pair, and of a particle between suns that move by functions of time."""
        pair = gravity.Bodies([1, 0.5], axes=2)
        system = pair.system()
        q, p = pair.to_centre([0, 0, 1.99, 0], pair.momenta([0, 0, 0, math.sqrt(1.5 * (2 / 1.99 - 1))]))
        run = tvi.solve(system.rescaled(pair.scale), (0, 50), q, p, h=0.5)
        self.assertLess(np.ptp(run.energy), 1e-12)
        self.assertGreater(np.max(np.diff(run.t)) / np.min(np.diff(run.t)), 50)
        x, v = pair.centre(run.q, run.p)
        self.assertEqual(x.shape, (len(run.t), 2))
        self.assertLess(max(abs(x).max(), abs(v).max()), 1e-13)
        self.assertLess(np.ptp(pair.angular_momentum(run.q, run.p)[:, 2]), 1e-14)
        system = tvi.potential(2, with_field)
        self.assertAlmostEqual(system.energy(0, [2, 0], [0, 0]), -0.5 / 1.5 - 0.5 / 2.5, delta=1e-15)
        self.assertAlmostEqual(system.energy(math.pi / 2, [2, 0], [0, 0]), -1 / math.hypot(2, 0.5), delta=1e-15)

    def test_copies(self):
        """Of bodies and of their systems, by pickle, in which all is kept."""
        bodies = gravity.Bodies(MASS, G=2, softening=0.3, J2=0.1, radius=0.2, pole=[0, 1, 1], oblate=1, sharpness=2)
        q = RANDOM.normal(size=12)
        other = pickle.loads(pickle.dumps(bodies))
        self.assertEqual((bodies.potential(q), bodies.scale(q)), (other.potential(q), other.scale(q)))
        orbit = tvi.Integrator(bodies.system().rescaled(bodies.scale), q, bodies.momenta(np.ones(12)))
        again = pickle.loads(pickle.dumps(orbit))
        for it in (orbit, again):
            it.integrate(0.01, 20)
        self.assertTrue(same_bits(orbit.q, again.q))
        for name, value in (("mass", 1), ("n", 1), ("axes", 1)):
            with self.assertRaises(AttributeError):
                setattr(bodies, name, value)
        with self.assertRaises(ValueError):
            bodies.mass[0] = 1

    def test_refused(self):
        bodies = gravity.Bodies([1, 2], axes=1)
        for kind, text, call in (
                (TypeError, "q has jets or real numbers, not str", lambda: bodies.potential([0, "a"])),
                (ValueError, r"q has the shape \(1,\), not \(2,\)", lambda: bodies.potential([0])),
                (ValueError, "nan, which is not finite", lambda: bodies.potential([0, math.nan])),
                (ValueError, "axes = 4 is not from 1 to 3", lambda: gravity.Bodies([1], axes=4)),
                (ValueError, r"bodies \* axes = 0 is not from 1", lambda: gravity.Bodies([])),
                (ValueError, r"bodies \* axes = 10002 is not from 1", lambda: gravity.Bodies([1] * 5001, axes=2)),
                (ValueError, "oblate = 1 is not from 0 to 0", lambda: gravity.Bodies([1], oblate=1)),
                (ValueError, r"pole has the shape \(2,\)", lambda: gravity.Bodies([1], pole=[1, 2])),
                (ValueError, r"^mass\[1\] = nan is not finite", lambda: gravity.Bodies([1, math.nan])),
                (ValueError, "^G = inf is not finite", lambda: gravity.Bodies([1], G=math.inf)),
                (TypeError, "mass has real numbers, not", lambda: gravity.Bodies(["a"])),
                (ValueError, r"mass has the shape \(\)", lambda: gravity.Bodies(1)),
                (ValueError, r"v has the shape \(3,\)", lambda: bodies.momenta([1, 2, 3])),
                (ValueError, r"v has the shape \(\)", lambda: bodies.momenta(1)),
                (ValueError, r"q and p have the shapes \(2,\) and \(1, 2\)",
                 lambda: bodies.centre([1, 2], [[1, 2]]))):
            self.assertRaisesRegex(kind, text, call)
        for call, status, text in (
                (lambda: bodies.potential([1, 1]), "EDOMAIN", "where bodies meet"),
                (lambda: gravity.Bodies([1, -1e-3]), "EINVAL", r"^mass\[1\] = -0.001 is negative"),
                (lambda: gravity.Bodies([0, 0]), "EINVAL", "^all masses are 0"),
                (lambda: gravity.Bodies([1, 0], J2=1e-3), "EINVAL", "^J2 = 0.001 needs the radius .* radius = 0"),
                (lambda: gravity.Bodies([1, 2], sharpness=-1), "EINVAL", "^sharpness = -1 is negative")):
            with self.assertRaisesRegex(tvi.Error, text) as refused:
                call()
            self.assertEqual(refused.exception.status, status)
        kept = []
        tvi.potential(2, lambda q: kept.extend(q) or bodies.potential(q))
        self.assertRaisesRegex(ValueError, "was kept", bodies.potential, kept)
        with self.assertRaisesRegex(ValueError, "jets of two functions"):
            tvi.potential(2, lambda q: tvi.potential(2, lambda x: bodies.potential([q[0], x[1]])) and q[0])


class States(unittest.TestCase):
    def test_shapes(self):
        """Of any number of states, each as numpy has it."""
        for axes in (1, 2, 3):
            bodies, n = gravity.Bodies(MASS, axes), 4 * axes
            own = np.where(MASS > 0, MASS, 1e-30 * 3)
            self.assertTrue(same_bits(bodies.coordinate_masses, np.repeat(own, axes)))
            for shape in ((), (5,), (2, 3), (0,)):
                q, v = RANDOM.normal(size=(2, *shape, n))
                p = bodies.momenta(v)
                self.assertTrue(same_bits(p, np.repeat(own, axes) * v) and p.shape == (*shape, n))
                self.assertTrue(np.allclose(bodies.velocities(p), v, rtol=1e-15, atol=0))
                x, u = bodies.centre(q, p)
                r, s = q.reshape(*shape, 4, axes), p.reshape(*shape, 4, axes)
                self.assertEqual((x.shape, u.shape), ((*shape, axes),) * 2)
                self.assertTrue(np.allclose(x, (own[:, None] * r).sum(axis=-2) / own.sum(), atol=1e-15))
                self.assertTrue(np.allclose(u, s.sum(axis=-2) / own.sum(), atol=1e-15))
                kept = q.copy()
                moved = bodies.to_centre(q, p)
                self.assertTrue(same_bits(q, kept))
                self.assertLess(max([0, *abs(np.ravel(bodies.centre(*moved)))]), 2e-15)
                L = np.zeros((*shape, 3))
                for k in range(4):
                    wide = [np.concatenate([y[..., k, :], np.zeros((*shape, 3 - axes))], axis=-1) for y in (r, s)]
                    L += np.cross(*wide)
                self.assertTrue(np.allclose(bodies.angular_momentum(q, p), L, atol=1e-14))
                self.assertEqual(bodies.angular_momentum(q, p).shape, (*shape, 3))


class Orbits(unittest.TestCase):
    def test_there_and_back(self):
        """Elements of every conic, in arrays that go together."""
        e, i, mu = np.array([0, 0.5, 1, 1.5, 9])[:, None], np.linspace(0, math.pi, 4), np.array([1.5, 1, 2, 3])
        orbit = gravity.Orbit(q=0.7, e=e, i=i, node=0.3, pericentre=-0.2, time=-2.5)
        x, v = orbit.state(mu)
        self.assertEqual(x.shape, (5, 4, 3))
        found = gravity.Orbit.of(mu, x, v)
        for name in ("q", "e", "i"):
            self.assertLess(abs(getattr(found, name) - getattr(orbit, name)).max(), 1e-13, name)
        turn = 2 * math.pi * np.sqrt(1.4**3 / mu)
        self.assertLess(abs(found.time[1] - np.round(-2.5 / turn) * -turn + 2.5).max(), 1e-13)
        self.assertLess(abs(found.time[2:] + 2.5).max(), 1e-13)
        again = found.state(mu)
        self.assertLess(max(abs(again[0] - x).max(), abs(again[1] - v).max()), 1e-13)
        energy = (v**2).sum(axis=-1) / 2 - mu / np.linalg.norm(x, axis=-1)
        self.assertLess(abs(energy - mu * (e - 1) / (2 * 0.7)).max(), 1e-13)
        one = gravity.Orbit(a=2, e=0.5).state(1)
        self.assertTrue(np.allclose(one, [[1, 0, 0], [0, math.sqrt(1.5), 0]], rtol=1e-15, atol=0))
        self.assertIsInstance(gravity.Orbit.of(1, *one).e, float)
        parabola = gravity.Orbit(a=math.inf, q=1, e=1).state(2.0)
        self.assertTrue(np.allclose(parabola, [[1, 0, 0], [0, 2, 0]], rtol=1e-15, atol=0))
        self.assertEqual(gravity.Orbit(a=1, e=np.zeros((0, 2))).state(1)[0].shape, (0, 2, 3))

    def test_places(self):
        """One of time, f, M and mean_longitude says the place, and one of two angles the pericentre; what is None is
        not given, and a 0 that is given is one."""
        e, M = np.array([0, 0.1, 0.9])[:, None], np.linspace(-3, 3, 7)
        orbit = gravity.Orbit(a=2, e=e, i=0.5, node=1, pericentre=-2, time=M * math.sqrt(8 / 1.5))
        x, v = orbit.state(1.5)
        all_of_them = gravity.Orbit.of(1.5, x, v)
        self.assertEqual([name for name, value in zip(orbit._fields, all_of_them) if value.shape != (3, 7)], [])
        again = all_of_them.state(1.5)
        f = all_of_them.f + all_of_them.pericentre + 2
        ways = [orbit.at(M=M), orbit.at(f=f), orbit.at(mean_longitude=M - 1),
                orbit._replace(pericentre=None, longitude_of_pericentre=-1), orbit._replace(M=M, mean_longitude=M - 1)]
        for y, w in [again, *(way.state(1.5) for way in ways)]:
            self.assertLess(max(abs(y - x).max(), abs(w - v).max()), 1e-13)
        still = gravity.Orbit(a=2, e=e, i=0.5, node=1, pericentre=-2)
        self.assertTrue(same_bits(orbit.at().state(1.5), still.state(1.5)))
        self.assertTrue(same_bits(orbit.at(M=M * 0).state(1.5)[0], orbit.at(f=M * 0).state(1.5)[0]))
        for conic in ({"q": 1, "e": 1}, {"q": 1, "e": 2}):
            y, w = gravity.Orbit(**conic, node=0.5, time=[-1, 0, 2]).state(1)
            self.assertLess(abs(gravity.Orbit.of(1, y, w).state(1)[0] - y).max(), 1e-14)
        later, wanted = (y.at(time=7).state(1.5)[0][1:] for y in (all_of_them, orbit))  # a circle has no pericentre
        self.assertLess(abs(later - wanted).max(), 1e-13)

    def test_descriptions(self):
        """help() says what each element is, and shows types that can be read."""
        text = pydoc.render_doc(gravity.Orbit)
        self.assertNotIn("Alias for field", text)
        self.assertNotIn("ForwardRef", text)
        for name in gravity.Orbit._fields:
            self.assertGreater(len(getattr(gravity.Orbit, name).__doc__), 10)

    def test_refused(self):
        orbit, an_array = gravity.Orbit, np.array([[0.1, 0.2], [0.3, 1.4]])
        for kind, status, text, call in (
                (tvi.Error, "EINVAL", r"orbit\[1\]: a = 1, e = 2: q = .* = -1 is not", lambda: orbit(a=1, e=[0.5, 2])),
                (tvi.Error, "EINVAL", r"orbit\[1\]\[1\]: a = 1, e = 1.4: q = ", lambda: orbit(a=1, e=an_array)),
                (tvi.Error, "EINVAL", "orbit: a = 1, e = 1: .* a parabola needs q", lambda: orbit(a=1, e=1)),
                (tvi.Error, "EINVAL", "orbit: a = -1, e = 0.5: q = .* an ellipse", lambda: orbit(a=-1, e=0.5)),
                (tvi.Error, "EINVAL", "orbit: neither a nor q is given", lambda: orbit(e=0.1)),
                (tvi.Error, "EINVAL", "orbit: a = 1, q = 0.6 and e = 0.5 disagree", lambda: orbit(a=1, q=0.6, e=0.5)),
                (tvi.Error, "EINVAL", "orbit: a = 0.5, q = 3 and e = 0 disagree", lambda: orbit(a=0.5, q=3)),
                (tvi.Error, "EINVAL", r"orbit: i = -1e-17 is not within \[0, pi\]", lambda: orbit(a=1, i=-1e-17)),
                (tvi.Error, "EINVAL", r"orbit\[2\]: i = 4 is not", lambda: orbit(a=1, i=[0, 1, 4])),
                (tvi.Error, "EINVAL", "orbit: e = -0.5 is negative", lambda: orbit(q=1, e=-0.5)),
                (tvi.Error, "EINVAL", "orbit: time = 0 and M = 1 disagree", lambda: orbit(a=1, time=0, M=1)),
                (tvi.Error, "EINVAL", r"orbit\[1\]: f = 1 and M = 0 disagree", lambda: orbit(a=1, f=[0, 1], M=0)),
                (tvi.Error, "EINVAL", "orbit: M = 1 and mean_longitude = 1 disagree",
                 lambda: orbit(a=1, node=1, M=1, mean_longitude=1)),
                (tvi.Error, "EINVAL", "orbit: pericentre = 0 and longitude_of_pericentre = 2 disagree",
                 lambda: orbit(a=1, node=1, pericentre=0, longitude_of_pericentre=2)),
                (tvi.Error, "EINVAL", "orbit: time = 3 and f = .* disagree",
                 lambda: orbit.of(1, [1, 0, 0], [0.1, 1, 0])._replace(time=3)),
                (tvi.Error, "EINVAL", "orbit: M = 1, e = 1: M of a parabola is 0", lambda: orbit(q=1, e=1, M=1)),
                (tvi.Error, "EINVAL", "orbit: f = 2.2 is not within the asymptotes", lambda: orbit(q=1, e=2, f=2.2)),
                (tvi.Error, "ENONFINITE", "orbit: time = .* too large", lambda: orbit(q=1e-300, e=1, time=1e300)),
                (ValueError, None, "^q = inf is not finite", lambda: orbit(q=math.inf)),
                (ValueError, None, r"^a\[1, 0\] = nan is not", lambda: orbit(a=[[1], [math.nan]])),
                (ValueError, None, "^M = nan is not finite", lambda: orbit(a=1, M=math.nan)),
                (ValueError, None, "shape mismatch", lambda: orbit(q=[1, 2], e=[1, 2, 3])),
                (TypeError, None, "f has real numbers", lambda: orbit(q=1, f=[None, 1])),
                (TypeError, None, "real numbers", lambda: orbit(q="1"))):
            with self.assertRaisesRegex(kind, text) as refused:
                call().state(1)
            self.assertEqual(getattr(refused.exception, "status", None), status)
        for kind, status, text, call in (
                (tvi.Error, "EINVAL", r"orbit\[1\]: mu = 0 is not positive", lambda: orbit(a=1).state([1, 0])),
                (tvi.Error, "EDOMAIN", r"state\[0\]\[1\]: x and v are on one line",
                 lambda: orbit.of(1, [1, 0, 0], [[[0, 1, 0], [1, 0, 0]]])),
                (tvi.Error, "EINVAL", "state: mu = -1 is not positive", lambda: orbit.of(-1, [1, 0, 0], [0, 1, 0])),
                (ValueError, None, r"not \(..., 3\)", lambda: orbit.of(1, [1, 0], [0, 1])),
                (TypeError, None, "unexpected keyword", lambda: orbit(a=1).at(tim=1))):
            with self.assertRaisesRegex(kind, text) as refused:
                call()
            self.assertEqual(getattr(refused.exception, "status", None), status)


if __name__ == "__main__":
    unittest.main()
