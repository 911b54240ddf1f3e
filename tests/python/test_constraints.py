"""Constrained systems: what a run gives of constraints, by solutions in closed form, and what is refused."""

import math
import pickle
import re
import unittest

import numpy as np

import tvi
from problems import ROOT, same_bits

G = 9.8


def fall(n=2, mass=None):
    return tvi.potential(n, lambda q: G * sum(q[1::2]), mass=mass)


def rod(q):
    return [(q @ q - 1) / 2]


def pendulum():
    return tvi.constrained(fall(), rod)


def rods(q):
    """Of a double pendulum, whose second rod has a unit of its own."""
    a, b = q[:2], q[2:] - q[:2]
    return [(a @ a - 1) / 2, 3 * (b @ b - 0.25)]


def of_length(q, l):
    return [(q @ q - l**2) / 2]


def free(q, w):
    return w * 0 * q[0]


class Runs(unittest.TestCase):
    def test_pendulum(self):
        """Multipliers and forces of constraint in closed form at all times, by each way of a run."""
        system = pendulum()
        angle = tvi.potential(1, lambda q: -G * np.cos(q[0]))
        for more in ({"h": 0.05}, {"error": 1e-11}, {"h": 0.05, "t_eval": [0, 0.1, 2, 4.9]}):
            with self.subTest(str(more)):
                run = tvi.solve(system, (0, 5), [1, 0], v0=[0, 0.5], dense_output=True, **more)
                self.assertEqual((run.status, run.t_end), (0, 5.0))
                q, v = run.q, run.v
                self.assertEqual((run.phi.shape, run.multipliers.shape, run.constraint_force.shape),
                                 ((len(run.t), 1), (len(run.t), 1), (len(run.t), 2)))
                wanted = (v * v).sum(axis=1) - G * q[:, 1]
                self.assertLess(np.abs(run.multipliers[:, 0] - wanted).max(), 1e-12)
                self.assertLess(np.abs(run.constraint_force + run.multipliers * q).max(), 1e-13)
                self.assertLess(np.abs(run.phi).max(), 1e-15)
                self.assertLess(np.ptp(run.energy), 1e-12 if "h" in more else 1e-9)
                turned = tvi.solve(angle, (0, 5), [math.pi / 2], v0=[0.5], h=0.05, t_eval=run.t).q[:, 0]
                self.assertLess(np.abs(q - np.stack([np.sin(turned), -np.cos(turned)], axis=1)).max(), 1e-9)
                at, _ = run.sol(np.linspace(0, 5, 33))
                self.assertLess(np.abs((at * at).sum(axis=1) - 1).max(), 1e-15)
        self.assertLess(tvi.solve(system, (0, 5), [1, 0], v0=[0, 0.5], h=0.05).end_error(), 1e-12)

    def test_forms(self):
        """Of a force, a Lagrangian, a Hamiltonian and a driven potential, of one motion."""
        systems = [tvi.force(2, lambda q: [0, -G]), tvi.lagrangian(2, lambda q, v: v @ v / 2 - G * q[1]),
                   tvi.hamiltonian(2, lambda q, p: p @ p / 2 + G * q[1]),
                   tvi.potential(2, lambda q: 0 * q[0]).driven(lambda q, v: [0, -G])]
        wanted = tvi.solve(pendulum(), (0, 3), [1, 0], v0=0, h=0.05)
        for base in systems:
            with self.subTest(base.kind):
                run = tvi.solve(tvi.constrained(base, rod), (0, 3), [1, 0], v0=0, h=0.05)
                self.assertLess(np.abs(run.q - wanted.q).max(), 1e-13)
                self.assertLess(np.abs(run.multipliers - wanted.multipliers).max(), 1e-12)
                self.assertEqual(run.energy is None, base.kind == "force")
        masses = tvi.constrained(fall(4, mass=[1, 1, 3, 3]), rods)
        self.assertEqual((masses.n, masses.constraints, masses.masses.tolist()), (4, 2, [1, 1, 3, 3]))
        self.assertEqual(tvi.constrained(fall().driven(lambda q, v: -v), rod).masses.tolist(), [1, 1])
        run = tvi.solve(masses, (0, 3), [1, 0, 1, 0.5], v0=0, h=0.01)
        self.assertLess(max(np.abs(run.phi).max(), np.ptp(run.energy)), 2e-13)

    def test_time(self):
        """A pivot that moves to the side with constant acceleration: gravity has another direction there."""
        a = 3.0
        moved = tvi.constrained(fall(), lambda q, t: [((q[0] - a * t**2 / 2)**2 + q[1]**2 - 1) / 2])
        run = tvi.solve(moved, (0, 3), [0, -1], v0=0, h=0.05)
        tilted = tvi.constrained(tvi.potential(2, lambda q: G * q[1] + a * q[0]), rod)
        wanted = tvi.solve(tilted, (0, 3), [0, -1], v0=0, h=0.05)
        self.assertLess(np.abs(run.q - wanted.q - np.stack([a * run.t**2 / 2, 0 * run.t], axis=1)).max(), 1e-12)
        self.assertLess(np.abs(run.multipliers - wanted.multipliers).max(), 1e-11)
        self.assertLess(np.abs(run.phi).max(), 1e-14)
        self.assertLess(abs(moved.constraint_values(2.0, [6, 1], [6, 0])[1][0]), 1e-15)

    def test_parameters(self):
        """Values of a run are those of its results; the function takes those of the system that it names."""
        system = tvi.constrained(tvi.potential(2, lambda q, a: a * q[1], a=G), of_length, l=1.0)
        self.assertEqual(dict(system.parameters), {"a": G, "l": 1.0})
        run = tvi.solve(system, (0, 4), [2, 0], v0=0, h=0.05, l=2.0, a=4 * G)
        again = tvi.solve(pendulum(), (0, 4 * math.sqrt(2)), [1, 0], v0=0, h=0.05 * math.sqrt(2))
        self.assertLess(np.abs(run.q_end - 2 * again.q_end).max(), 1e-12)
        self.assertLess(np.abs(run.phi).max(), 4e-15)
        self.assertLess(np.abs(run.multipliers[:, 0] - ((run.v**2).sum(axis=1) - 4 * G * run.q[:, 1]) / 4).max(), 1e-12)
        shared = tvi.constrained(tvi.potential(2, free, w=2.0), lambda q, w: [(q @ q - w**2) / 2])
        self.assertEqual(dict(shared.parameters), {"w": 2.0})
        self.assertEqual(shared.constraint_values(0, [2, 0], [0, 1])[0].tolist(), [0])
        q, p = system.project([[3, 0], [0, 5]], p=[[1, 1], [1, 1]], l=2.0)
        self.assertEqual((q.tolist(), p.tolist()), ([[2, 0], [0, 2]], [[0, 1], [1, 0]]))
        self.assertEqual(system.project([3, 0], v=0)[0].tolist(), [1, 0])
        it = tvi.Integrator(system, [3, 0], [1, 1], l=2.0, a=0.0)
        self.assertEqual([x.tolist() for x in it.constraint_values()], [[2.5], [3]])
        it.project()
        self.assertEqual((it.q.tolist(), it.p.tolist(), it.t), ([2, 0], [0, 1], 0))
        self.assertEqual([x.tolist() for x in it.multipliers()], [[0.25], [-0.5, 0]])
        it.integrate(0.05, 10)
        self.assertLess(abs(it.constraint_values()[0][0]), 2e-15)

    def test_state(self):
        """Events, saved states, pickles, ensembles: to the bit, or as of any system."""
        system = tvi.constrained(tvi.potential(2, free, w=1.0), of_length, l=1.0)  # turns by t
        run = tvi.solve(system, (0, 10), [1, 0], [0, 1], h=0.3, events=tvi.event(lambda q, p: q[0], direction=-1))
        self.assertLess(np.abs(run.events[0].t - math.pi / 2 - 2 * math.pi * np.arange(2)).max(), 1e-13)
        self.assertLess(np.abs(system.constraint_values(0, run.events[0].q, run.events[0].p)).max(), 1e-15)
        again = pickle.loads(pickle.dumps(system))
        self.assertTrue(same_bits(tvi.solve(again, (0, 10), [1, 0], [0, 1], h=0.3).q_end, run.q_end))
        one, other = tvi.Integrator(system, [1, 0], [0, 1]), tvi.Integrator(again, [0, 1], [1, 0])
        one.integrate(0.3, 7)
        other.load(one.save())
        one.integrate(0.3, 7), other.integrate(0.3, 7)
        self.assertTrue(same_bits(one.q, other.q))
        many = tvi.ensemble(system, (0, 10), [[1, 0], [0, 2], [3, 0]], [[0, 1], [1, 0], [0, 1]], h=0.3, l=[1, 2, 2])
        self.assertTrue(same_bits(many.q[0], run.q_end))
        self.assertEqual(many.status.tolist(), ["OK", "OK", "EINVAL"])
        self.assertEqual(many.q[2].tolist(), [3, 0])
        self.assertEqual(repr(system), "<tvi system: constrained, n = 2, 1 constraint, w=1.0, l=1.0>")

    def test_project(self):
        """p of velocities is that on the constraints; shapes as of momentum()."""
        bent = tvi.constrained(tvi.lagrangian(2, lambda q, v: (1 + q[0]**2) * v @ v / 2), rod)
        q, p = bent.project([2, 0], v=[1, 3])
        self.assertLess(np.abs([q - [1, 0], p - [0, 6]]).max(), 1e-14)
        moving = tvi.constrained(fall(), lambda q, t: [q[0] - t])
        q, p = moving.project([[0, 1], [0, 2]], v=0, t=[3, 4])
        self.assertEqual((q.tolist(), p.tolist()), ([[3, 1], [4, 2]], [[1, 0], [1, 0]]))
        given = np.array([1.1, 0.0])
        pendulum().project(given, p=given)
        self.assertEqual(given.tolist(), [1.1, 0.0])
        two = tvi.constrained(fall(4, mass=[1, 1, 3, 3]), rods)
        q, p = two.project([1.01, 0, 1, 0.52], v=[1, 1, 0, 0])
        self.assertLess(np.abs(two.constraint_values(0, q, p)).max(), 2e-15)
        values, forces = two.multipliers(0, np.stack([q, q]), np.stack([p, p]))
        self.assertEqual((values.shape, forces.shape), ((2, 2), (2, 4)))
        between = 6 * (q[2:] - q[:2])
        slope = np.array([[*q[:2], 0, 0], [*-between, *between]])
        self.assertLess(np.abs(forces[1] + values[1] @ slope).max(), 1e-13)

    def test_without_constraints(self):
        run = tvi.solve(fall(), (0, 1), [1, 0], p0=0, h=0.1)
        self.assertEqual((run.phi, run.multipliers, run.constraint_force, fall().constraints), (None, None, None, 0))
        for call in (lambda: fall().project([1, 0], p=0), lambda: fall().multipliers(0, [1, 0], [0, 0]),
                     lambda: fall().constraint_values(0, [1, 0], [0, 0]), tvi.Integrator(fall(), [1, 0], 0).project,
                     tvi.Integrator(fall(), [1, 0], 0).multipliers):
            with self.assertRaisesRegex(tvi.Error, "the system has no constraints") as raised:
                call()
            self.assertEqual(raised.exception.status, "EUNSUPPORTED")


class Refused(unittest.TestCase):
    def refused(self, kind, text, call, status=None):
        with self.assertRaisesRegex(kind, text) as raised:
            call()
        if status:
            self.assertEqual(raised.exception.status, status)

    def test_starts(self):
        """Near is not on: refused by each way of a run, and what tvi_project gives is taken."""
        system = pendulum()
        ways = [dict(h=0.1), dict(error=1e-8), {}, dict(h=0.1, t_eval=[1]), dict(h=0.1, events=lambda q, p: q[1])]
        for way in ways:
            with self.subTest(str(way)):
                for q, v, text in (([1.001, 0], 0, r"phi\[0\] = 0.0010005: the state is not on the constraints: t"),
                                   ([1, 0], [1e-3, 1], r"dphi\[0\]/dt = 0.001: the velocity is not along the constr"),
                                   ([1 + 1e-7, 0], 0, r"phi\[0\] = 1e-07: the state is not on")):
                    self.refused(tvi.Error, text, lambda: tvi.solve(system, (0, 1), q, v0=v, **way), "EINVAL")
                    q, p = system.project(q, v=v)
                    self.assertTrue(tvi.solve(system, (0, 1), q, p, **way).success)
                run = tvi.solve(system, (0, 1), [1 + 1e-12, 0], v0=0, **way)
                self.assertLess(np.abs(run.phi[-1]).max(), 1e-15)
        it = tvi.Integrator(system, [1.001, 0], 0)
        self.refused(tvi.Error, "not on the constraints", lambda: it.step(0.1), "EINVAL")
        self.assertEqual((it.t, it.q.tolist()), (0, [1.001, 0]))
        self.refused(tvi.Error, "no coordinates are found|singular", lambda: system.project([0, 0], p=0))

    def test_dependent(self):
        """A constraint that follows from the others, or contradicts them, by its number."""
        twice = tvi.constrained(fall(3), lambda q: [*rod(q), 3 * rod(q)[0]])
        other = tvi.constrained(fall(3), lambda q: [*rod(q), (q @ q - 2) / 2])
        for system in (twice, other):
            for way in (dict(h=0.1), dict(error=1e-8)):
                self.refused(tvi.Error, r"phi\[1\]", lambda: tvi.solve(system, (0, 1), [1, 0, 0], v0=0, **way))
        for call in lambda: tvi.solve(twice, (0, 1), [1, 0, 0], 0, h=0.1), lambda: other.project([1, 0, 0], 0):
            self.refused(tvi.Error, r"phi\[1\] depends on the others", call, "ESINGULAR")

    def test_statements(self):
        base, scaled = fall(), tvi.potential(2, lambda q: -1 / np.sqrt(q @ q)).rescaled()
        for function, kind, text, status in (
                (lambda q: [], tvi.Error, "m = 0", "EINVAL"), (lambda q: list(q), tvi.Error, "m = n = 2: so", "EINVAL"),
                (lambda q: [q[0], q[1], q[0]], tvi.Error, "m = 3", "EINVAL"),
                (lambda q: [1.0], tvi.Error, r"phi\[0\] is a number", "EINVAL"),
                (lambda q, t: [t], tvi.Error, r"phi\[0\] is a function of t alone", "EINVAL"),
                (lambda q: q @ q - 1, TypeError, "constrained returned Jet, not a list of jets or numbers", None),
                (lambda q: None, TypeError, "constrained returned NoneType, not a list", None),
                (lambda q: [q], TypeError, "component 0 of what constrained returned an array", None),
                (lambda q: [q[0] if q[0] > 0 else 0], TypeError, "a branch on the value of a jet", None),
                (lambda q: [1 / 0], ZeroDivisionError, "", None),
                (lambda q, v: [v[0]], TypeError, "constrained is called with .q. or .q, t., and .* velocities", None),
                (lambda q, l: [q[0] - l], TypeError, "l has no value: give l=... as a parameter", None),
                (3, TypeError, "constrained is a function of", None)):
            with self.subTest(text):
                self.refused(kind, text, lambda: tvi.constrained(base, function), status)
        self.refused(TypeError, "system is what tvi.potential", lambda: tvi.constrained(rod, base))
        self.refused(TypeError, "takes no parameter l", lambda: tvi.constrained(base, rod, l=1.0))
        self.refused(ValueError, "a parameter l already",
                     lambda: tvi.constrained(tvi.constrained(base, of_length, l=1.0), of_length, l=2.0))
        self.refused(tvi.Error, "m = n = 1", lambda: tvi.constrained(tvi.potential(1, lambda q: q[0]), rod), "EINVAL")
        counts = iter([2, 3])
        self.refused(ValueError, "constrained returned 3 components, not 2",
                     lambda: tvi.constrained(fall(4), lambda q: list(q[:next(counts)])))
        for call in (lambda: tvi.constrained(pendulum(), rod), lambda: tvi.constrained(scaled, rod),
                     lambda: pendulum().rescaled(), lambda: pendulum().driven(lambda q, v: -v),
                     lambda: pendulum().rescaled(lambda q, p: 1 + q[0]**2, reversible=True)):
            self.refused(tvi.Error, "constrained|rescaled", call, "EUNSUPPORTED")

    def test_page(self):
        """The table of docs/constraints.md: each row is refused with its status and text, and the state stays."""
        system, here, there = pendulum(), [1.001, 0], [0, 0]
        calls = {"m = n": lambda: tvi.constrained(fall(), lambda q: list(q)),
                 "a number, or a function of t alone": lambda: tvi.constrained(fall(), lambda q: [1.0]),
                 "a start off the constraints": lambda: tvi.solve(system, (0, 1), here, 0, h=0.1),
                 "velocities across them": lambda: tvi.solve(system, (0, 1), [1, 0], [1e-3, 1], h=0.1),
                 "redundant or contradictory ones": lambda: tvi.solve(tvi.constrained(
                     fall(3), lambda q: [*rod(q), 3 * rod(q)[0]]), (0, 1), [1, 0, 0], 0, h=0.1),
                 "a gradient that is 0": lambda: system.project(there, 0),
                 "no place is found": lambda: tvi.constrained(fall(), lambda q: [q @ q + 1]).project([0.5, 0.2], 0),
                 'another method than "galerkin" and "stormer-verlet"':
                     lambda: tvi.Integrator(system, [1, 0], 0, method="midpoint"),
                 "constraints of a constrained system": lambda: tvi.constrained(system, rod)}
        page = (ROOT / "docs/constraints.md").read_text()
        rows = re.findall(r"^\| (.*) \| TVI_(\w+) \| (.*) \|$", page, re.M)
        self.assertEqual([what for what, _, _ in rows], list(calls))
        for what, status, text in rows:
            with self.subTest(what), self.assertRaises(tvi.Error) as raised:
                calls[what]()
            self.assertEqual((raised.exception.status, text in str(raised.exception)), (status, True),
                             str(raised.exception))

    def test_arguments(self):
        system = pendulum()
        for more, kind in ((dict(), TypeError), (dict(p=0, v=0), TypeError), (dict(p=[1, 2, 3]), ValueError),
                           (dict(p=0, t=math.nan), ValueError), (dict(p=[0, math.inf]), ValueError),
                           (dict(v="x"), TypeError), (dict(p=0, l=2.0), TypeError)):
            self.refused(kind, "", lambda: system.project([1, 0], **more))
        for q in ([1, 0, 0], 1.0, [[1, 0, 0]], "x", [math.nan, 0]):
            self.refused((ValueError, TypeError), "q", lambda: system.project(q, p=0))
            self.refused((ValueError, TypeError), "q", lambda: system.multipliers(0, q, [0, 1]))

    def test_rattle(self):
        """Order 2: half the step, a quarter of the error, always on the rod."""
        system = pendulum()
        end = tvi.solve(system, (0, 1), [1, 0], 0, h=0.02).q[-1]
        errors = []
        for h in 0.01, 0.005:
            run = tvi.solve(system, (0, 1), [1, 0], 0, h=h, method="stormer-verlet", order=2)
            self.assertLess(abs(run.phi).max(), 1e-14)
            errors.append(abs(run.q[-1] - end).max())
        self.assertLess(abs(math.log2(errors[0] / errors[1]) - 2), 0.1)

    def test_not_served(self):
        """By the text of the library, and nothing runs."""
        system = pendulum()
        for method, order in (("taylor", 8), ("midpoint", 8), ("svhd", 2)):
            for call in (lambda: tvi.solve(system, (0, 1), [1, 0], 0, h=0.1, method=method, order=order),
                         lambda: tvi.Integrator(system, [1, 0], 0, method=method, order=order)):
                self.refused(tvi.Error, "a constrained system is for galerkin", call, "EUNSUPPORTED")
        self.refused(tvi.Error, "galerkin", lambda: tvi.solve(system, (0, 1), [1, 0], 0, tolerance=1e-8),
                     "EUNSUPPORTED")

    def test_compiled(self):
        plain, compiled = (tvi.solve(pendulum(), (0, 1), [1, 0], 0, h=0.05, compiled=how) for how in (False, True))
        self.assertEqual((plain.stats.is_compiled, compiled.stats.is_compiled), (False, True))
        np.testing.assert_allclose(compiled.q, plain.q, rtol=0, atol=1e-13)

    def test_tangents(self):
        """A motion on a circle is regular: its megno is 2."""
        bent = tvi.constrained(tvi.hamiltonian(2, lambda q, p: (p @ p) / (2 + q[0] ** 2) + 9.8 * q[1]), rod)
        for system in (pendulum(), bent):
            self.assertAlmostEqual(float(tvi.megno(system, (0, 2000), [1, 0], 0, h=0.05)), 2, delta=0.1)
        orbits, it = tvi.Ensemble(bent, [[1, 0]] * 2, 0), tvi.Integrator(bent, [1, 0], 0)
        orbits.tangent = it.tangent = np.eye(4)
        orbits.integrate(0.1, 2), it.integrate(0.1, 2)
        np.testing.assert_array_equal(orbits.tangent[0], it.tangent)


if __name__ == "__main__":
    unittest.main()
