"""tvi.rigid: motions against closed forms and other ways to state them (the bits of C are in test_bits.py), states
there and back, joints, forces, and what is refused. Bounds have a control beside them: what is almost the same misses
it."""

import math
import pickle
import unittest

import numpy as np

import tvi
from problems import same_bits
from tvi import rigid

RANDOM = np.random.default_rng(11)
X, Y, Z = np.eye(3)
BODIES = {12: rigid.box(2, 1, 2, 3), 9: rigid.disc(2, 0.5), 6: rigid.rod(3, 2), 3: rigid.Body(2, 0)}


def spring(q, k):
    """In a module, so that it pickles."""
    return k / 2 * q[:3] @ q[:3]


class Motions(unittest.TestCase):
    def free_top(self, inertia):
        """How far a symmetric top is from its closed form, and how far its invariants move."""
        top = rigid.Bodies(rigid.Body(2, inertia))
        q, p = top.state(rigid.Motion(velocity=[1, 2, 3], quaternion=[1, 2, 3, 4], omega=[0.3, 0, 2]))
        run = tvi.solve(top.system(), (0, 20), q, p, h=0.1)
        motion, L = top.motion(run.q, run.p), top.angular_momentum(run.q, run.p)
        angle = (3 - 2) / 2 * 2 * run.t
        wanted = np.stack([0.3 * np.cos(angle), 0.3 * np.sin(angle), 2 + 0 * angle], axis=1)
        moved = [np.ptp(run.energy), np.ptp(L, axis=0).max(), abs(motion.place - run.t[:, None] * [1, 2, 3]).max()]
        turned = (motion.rotation @ (np.array([2, 2, 3]) * motion.omega)[..., None])[..., 0]
        spin = L - 2 * np.cross(motion.place, motion.velocity)
        return abs(motion.omega - wanted).max(), max(moved), abs(turned - spin).max()

    def test_a_free_top(self):
        error, moved, momentum = self.free_top([2, 2, 3])
        self.assertLess(error, 3e-14)
        self.assertLess(moved, 1e-12)
        self.assertLess(momentum, 1e-12)
        self.assertGreater(self.free_top([2, 2, 3 + 1e-12])[0], 3e-14)

    def hinged(self, axes, length=1.2):
        """The angle of a rod on a hinge, in space or in the plane, and what the hinge bears."""
        hinge = rigid.Joint("hinge", 0, point=-length / 2 * X[:axes], axis=Z[:axes], other_axis=Z[:axes])
        if axes == 2:
            hinge = hinge._replace(axis=[0, 0], other_axis=[0, 0])
        bodies = rigid.Bodies(rigid.box(3, length, 0.1, 0.2), hinge, axes, -9.8 * Y[:axes])
        q, p = bodies.state(rigid.Motion(point=hinge.point, omega=[0, 0, 0.5]))
        run = tvi.solve(bodies.system(), (0, 5), q, p, h=0.02)
        u = run.q[:, axes:axes + 2]
        k = bodies.multiplier(0)
        return np.unwrap(np.arctan2(u[:, 1], u[:, 0])), -run.multipliers[:, k:k + 2]

    def test_a_hinge(self):
        """A pendulum, as its angle alone states it; the hinge bears the weight and turns the rod."""
        inertia = 3 * (1.2**2 / 3 + 0.1**2 / 12)
        one = tvi.lagrangian(1, lambda q, v: inertia / 2 * v[0]**2 - 3 * 9.8 * 0.6 * np.sin(q[0]))
        run = tvi.solve(one, (0, 5), [0], v0=[0.5], h=0.02)
        a, w = run.q[:, 0], run.v[:, 0]
        turning = -3 * 9.8 * 0.6 * np.cos(a) / inertia
        wanted = 3 * np.stack([-0.6 * (turning * np.sin(a) + w**2 * np.cos(a)),
                               9.8 + 0.6 * (turning * np.cos(a) - w**2 * np.sin(a))], axis=1)
        for axes in (2, 3):
            angle, pushed = self.hinged(axes)
            self.assertLess(abs(angle - a).max(), 2e-13)
            self.assertLess(abs(pushed - wanted).max(), 1e-10)
        self.assertGreater(abs(self.hinged(3, 1.2 + 1e-11)[0] - a).max(), 2e-13)

    def test_forces(self):
        """A constant torque turns a wheel, and a force at its rim does as much; friction slows it."""
        wheel = rigid.Bodies(rigid.disc(2, 0.5), rigid.Joint("hinge", 0, axis=Z, other_axis=Z))
        free = tvi.potential(wheel.n, wheel.potential, mass=wheel.coordinate_masses)
        moment = 2 * 0.5**2 / 2

        def at_the_rim(q):
            y = wheel.point(q, Y)
            return wheel.force(q, [2 * y[1], -2 * y[0], 0], point=[0, 0.25, 0])

        def friction(q, v):
            return wheel.torque(q, [0, 0, -0.1 * (q[3] * v[4] - q[4] * v[3])])

        for system, wanted in (
                (free.driven(lambda q, v: wheel.torque(q, [0, 0, -0.5])), 1 - 0.5 / moment * 2),
                (tvi.force(wheel.n, at_the_rim, wheel.coordinate_masses), 1 - 0.5 / moment * 2),
                (free.driven(friction), math.exp(-0.1 / moment * 2))):
            system = tvi.constrained(system, wheel.constraint)
            run = tvi.solve(system, (0, 2), *wheel.state(rigid.Motion(omega=Z)), h=0.05)
            self.assertLess(abs(wheel.motion(run.q, run.p).omega[-1] - wanted * Z).max(), 1e-13)
        q, _ = wheel.state(rigid.Motion(quaternion=rigid.turn(X, 0.3)))
        self.assertEqual(wheel.force(q, [1, 2, 3], point=[0, 4, 0]).tolist(), [1, 2, 3, 0, 0, 0, 4, 8, 12])
        ball = rigid.Bodies([BODIES[12]] * 2)
        q, _ = ball.state(rigid.Motion(), rigid.Motion())
        self.assertEqual(ball.force(q, [1, 2, 3], 1)[ball.first(1):].tolist(), [1, 2, 3] + [0] * 9)

    def test_a_potential(self):
        """That of the user, with parameters, beside that of gravity."""
        body = rigid.Bodies(BODIES[12], gravity=[0, 0, -9.8])
        system = body.system(spring, k=3.0)
        q, p = body.state(rigid.Motion(place=[1, 2, 3]))
        self.assertEqual(dict(system.parameters), {"k": 3.0})
        self.assertAlmostEqual(system.energy(0, q, p), 21 + 2 * 9.8 * 3, delta=1e-13)
        self.assertAlmostEqual(body.potential(q), 2 * 9.8 * 3, delta=1e-13)
        timed = body.system(lambda q, t: spring(body.point(q, Z) - np.r_[0.0, 0, 1] + t, 2))
        self.assertAlmostEqual(timed.energy(1, q, p), 4 + 9 + 16 + 2 * 9.8 * 3, delta=1e-13)
        again = pickle.loads(pickle.dumps(tvi.Integrator(system, q, p)))
        it = tvi.Integrator(system, q, p)
        for one in (it, again):
            one.integrate(0.01, 10)
        self.assertTrue(same_bits(it.q, again.q))

    def test_a_point_without_constraints(self):
        """Is a system without constraints."""
        system = rigid.Bodies(BODIES[3]).system()
        self.assertEqual((system.kind, system.n, system.constraints), ("potential", 3, 0))


class States(unittest.TestCase):
    def test_round_trips(self):
        """Of arrays of states, of all kinds of bodies at once; of a line what it knows."""
        bodies = rigid.Bodies(BODIES.values())
        self.assertEqual(bodies.n, sum(BODIES))
        for shape in ((), (5,), (2, 3)):
            given = []
            for n in BODIES:
                place, velocity, omega = RANDOM.normal(size=(3, *shape, 3))
                point = {12: [1, 2, 3], 9: [1, 2, 3], 6: [2, 0, 0], 3: [0, 0, 0]}[n]
                quaternion = RANDOM.normal(size=(*shape, 4)) if n > 6 else [1, 0, 0, 0]
                omega = omega * (1 if n > 6 else [0, 1, 1] if n == 6 else 0)
                given.append(rigid.Motion(place, velocity, quaternion, omega, point))
            q, p = bodies.state(*given)
            self.assertEqual(q.shape, (*shape, bodies.n))
            found = [bodies.motion(q, p, b, one.point) for b, one in enumerate(given)]
            for b, (one, other) in enumerate(zip(given, found)):
                for name in ("place", "velocity", "omega", "point"):
                    self.assertEqual(getattr(other, name).shape, (*shape, 3))
                    self.assertLess(abs(getattr(other, name) - getattr(one, name)).max(), 1e-13)
                self.assertLess(abs(one.rotation - other.rotation).max(), 1e-14)
                self.assertLess(abs(bodies.point(q, one.point, b) - one.place).max(), 1e-14)
                place = bodies.motion(q, p, b).place + (one.rotation @ np.array(one.point, dtype=float))
                self.assertLess(abs(place - one.place).max(), 1e-14)
            again = bodies.state(*found)
            self.assertLess(max(abs(again[0] - q).max(), abs(again[1] - p).max()), 1e-13)

    def test_one_for_all(self):
        """Of many states of one body, and one of another."""
        pair, x = rigid.Bodies([BODIES[12], BODIES[9]]), RANDOM.normal(size=(4, 1, 3))
        q, p = pair.state(rigid.Motion(place=x, omega=RANDOM.normal(size=(5, 3))), rigid.Motion([1, 2, 3]))
        self.assertTrue(same_bits(pair.point(q, [0, 0, 0]), np.broadcast_to(x, (4, 5, 3))))
        self.assertTrue(same_bits(pair.point(q, [0, 0, 0], 1), np.broadcast_to([1.0, 2, 3], (4, 5, 3))))
        self.assertEqual(pair.state(rigid.Motion(place=np.zeros((0, 3))), rigid.Motion())[0].shape, (0, 21))

    def test_the_plane(self):
        body = rigid.Bodies(rigid.Body(2, [0, 0, 3]), axes=2)
        given = rigid.Motion([1, 2], [3, 4], rigid.turn(Z, 0.7), [0, 0, 5], [6, 7])
        q, p = body.state(given)
        self.assertEqual((body.n, body.axes, body.first(0)), (4, 2, 0))
        found = body.motion(q, p, point=[6, 7])
        for one, other in zip(found, ([1, 2, 0], [3, 4, 0], given.quaternion, [0, 0, 5], [6, 7, 0])):
            self.assertLess(abs(one - other).max(), 1e-13)
        self.assertLess(abs(body.point(q, [6, 7]) - [1, 2]).max(), 1e-14)
        v = p[:2] / 2
        self.assertAlmostEqual(body.angular_momentum(q, p)[2], 2 * (q[0] * v[1] - q[1] * v[0]) + 3 * 5, delta=1e-13)
        turned = body.torque(q, [0, 0, 3])
        self.assertAlmostEqual(q[2] * turned[3] - q[3] * turned[2], 3, delta=1e-14)

    def test_turns(self):
        """A quaternion and its matrix turn the same way, as right hands do."""
        quarter = rigid.Motion(quaternion=2 * rigid.turn([0, 0, 5], math.pi / 2))
        self.assertLess(abs(quarter.rotation @ X - Y).max(), 1e-15)
        self.assertLess(abs(rigid.Motion(quaternion=[0, 0, 0, 0]).rotation - np.eye(3)).max(), 1e-15)
        body = rigid.Bodies(BODIES[12])
        q, p = body.state(rigid.Motion(quaternion=rigid.turn([1, 2, 3], 4)))
        self.assertLess(abs(body.motion(q, p).rotation - q[3:].reshape(3, 3).T).max(), 1e-15)

    def test_shapes_of_bodies(self):
        for body, inertia in ((rigid.sphere(5, 2), [8, 8, 8]), (rigid.box(12, 1, 2, 3), [13, 10, 5]),
                              (rigid.cylinder(12, 2, 3), [21, 21, 24]), (rigid.disc(4, 2), [4, 4, 8]),
                              (rigid.rod(12, 2), [0, 4, 4])):
            self.assertLess(abs(np.array(body.inertia) - inertia).max(), 1e-14)
        self.assertEqual(rigid.Bodies(rigid.Body(1, 2)).coordinate_masses.tolist(), [1] * 3 + [1] * 9)


class Joints(unittest.TestCase):
    def test_kinds(self):
        """Each has its number of constraints, which are 0 where it holds, and not where it does not."""
        places = {"point": [1, 0, 0], "other_point": [0, 2, 0]}
        held = rigid.Motion([0, 2, 0], point=[1, 0, 0])
        beside = held._replace(place=[0, 2, 1e-6])
        turned = held._replace(quaternion=rigid.turn(X, 1e-6))
        for kind, count, named, misses in (
                ("ball", 3, places, [beside]),
                ("hinge", 5, {**places, "axis": 2 * Z, "other_axis": Z}, [beside, turned]),
                ("guide", 2, {**places, "other_axis": X}, [beside]),
                ("slider", 4, {**places, "axis": Y, "other_axis": Y}, [beside, turned]),
                ("rod", 1, {**places, "other_point": [0, 2, 1], "length": 1}, [beside]),
                ("cross", 1, {"axis": Y, "other_axis": Z}, [turned])):
            for other in (rigid.WORLD, 1):
                joint = rigid.Joint(kind, 0, other, **named)
                bodies = rigid.Bodies([BODIES[12]] * 2, [joint])
                first = bodies.multiplier(0)
                self.assertEqual(first, 6 if other == rigid.WORLD else 12)
                self.assertEqual(bodies.system().constraints, 12 + count)
                for motion in (held, *misses):
                    q, p = bodies.state(motion, rigid.Motion())
                    off = abs(bodies.constraint(q)[first:first + count]).max()
                    self.assertEqual(off > 5e-7, motion is not held, (kind, other, off))

    def test_two_bodies(self):
        """A double pendulum in the plane, and one in space on hinges, are that of two angles."""
        L = lambda q, v: (v[0]**2 * (1 / 3 + 1) + v[1]**2 / 3) / 2 + v[0] * v[1] * np.cos(q[0] - q[1]) / 2 + \
            9.8 * (1.5 * np.cos(q[0]) + 0.5 * np.cos(q[1]))
        angles = tvi.solve(tvi.lagrangian(2, L), (0, 3), [0.5, 1], v0=[0, 0], h=0.02).q
        end, start = [0.5, 0, 0], [-0.5, 0, 0]
        hinges = [rigid.Joint("hinge", 0, point=start, axis=Z, other_axis=Z),
                  rigid.Joint("hinge", 1, 0, start, end, Z, Z)]
        for axes in (2, 3):
            bodies = rigid.Bodies([rigid.Body(1, [0.01, 1 / 12, 1 / 12])] * 2, hinges, axes, [0, -9.8, 0])
            turns = [rigid.turn(Z, a - math.pi / 2) for a in (0.5, 1)]
            first = rigid.Motion(quaternion=turns[0], point=start)
            at = first.rotation @ X
            q, p = bodies.state(first, rigid.Motion(at, quaternion=turns[1], point=start))
            run = tvi.solve(bodies.system(), (0, 3), q, p, h=0.02)
            found = [bodies.motion(run.q, run.p, b).rotation[:, :, 0] for b in (0, 1)]
            for k in (0, 1):
                wanted = np.stack([np.sin(angles[:, k]), -np.cos(angles[:, k])], axis=1)
                self.assertLess(abs(found[k][:, :2] - wanted).max(), 1e-12)
            self.assertLess(np.ptp(run.energy), 1e-13)
        self.assertEqual([bodies.multiplier(k) for k in (0, 1)], [6, 6 + 5 + 6])


class Refusals(unittest.TestCase):
    def test_refused(self):
        box, line = rigid.Bodies(BODIES[12]), rigid.Bodies(BODIES[6])
        plane = rigid.Bodies(BODIES[12], axes=2)
        q, p = box.state(rigid.Motion())
        joint, motion = rigid.Joint, rigid.Motion

        def hung(*arguments, **named):
            return rigid.Bodies(BODIES[12], joint(*arguments, **named))

        for status, text, call in (
                ("EINVAL", r"^body\[0\].mass = -1 is not positive", lambda: rigid.Bodies(rigid.Body(-1, 1))),
                ("EINVAL", r"^body\[1\].inertia\[2\] = 3 is more than the sum",
                 lambda: rigid.Bodies([BODIES[12], rigid.Body(1, [1, 1, 3])])),
                ("EINVAL", r"^body\[0\].inertia\[1\] = -1 is negative",
                 lambda: rigid.Bodies(rigid.Body(1, [0, -1, 1]))),
                ("EINVAL", "^bodies = 0 is not from 1", lambda: rigid.Bodies([])),
                ("EINVAL", r"^joint\[0\] is of body 0 with itself", lambda: hung("ball", 0, 0)),
                ("EINVAL", r"^joint\[0\].body = 1 is not from 0 to 0", lambda: hung("ball", 1)),
                ("EINVAL", r"^joint\[0\].axis has the length 0", lambda: hung("hinge", 0)),
                ("EINVAL", r"^joint\[0\].length = 0 is not positive", lambda: hung("rod", 0)),
                ("EINVAL", r"^motion 0: point\[1\] = 1 is off body 0", lambda: line.state(motion(point=Y))),
                ("EINVAL", r"^point\[1\] = 1 is off body 0", lambda: line.point(np.zeros(6), Y)),
                ("EINVAL", r"^point\[2\] = 1 is off body 0",
                 lambda: tvi.force(6, lambda q: line.force(q, X, point=Z))),
                ("EINVAL", r"^motion 0\[1\]: omega\[0\] = 1 is not in the plane",
                 lambda: plane.state(motion(omega=[Z, X]))),
                ("EINVAL", r"^state\[1\]: the directors 0 and 0 of body 0 have the product 4",
                 lambda: box.motion(np.stack([q, 2 * q]), np.stack([p, p]))),
                ("EINVAL", "^state: the directors of body 0 are left-handed", lambda: box.motion(-q, p))):
            with self.assertRaisesRegex(tvi.Error, text) as refused:
                call()
            self.assertEqual(refused.exception.status, status)
        for kind, text, call in (
                (TypeError, r"joint\[0\] is a Joint of the kind ball, .* or cross, not bal", lambda: hung("bal", 0)),
                (TypeError, r"joint\[0\] is a Joint .*, not str", lambda: rigid.Bodies(BODIES[12], "ball")),
                (TypeError, r"body\[1\] is a Body, not int", lambda: rigid.Bodies([BODIES[12], 3])),
                (TypeError, "one Motion for each body, 1", lambda: box.state()),
                (TypeError, "one Motion for each body, 1", lambda: box.state([0, 0, 0])),
                (TypeError, r"potential is a function of \(q\) .*, not int", lambda: box.system(3)),
                (TypeError, "potential returned NoneType, not one jet", lambda: box.system(lambda q: None)),
                (TypeError, r"potential returned an array of shape \(2,\)", lambda: box.system(lambda q: q[:2])),
                (TypeError, "k has no value: give k=", lambda: box.system(lambda q, k: k * q[0])),
                (ValueError, "joint = 0 is not from 0 to -1", lambda: box.multiplier(0)),
                (TypeError, r"joint\[0\].body is a whole number", lambda: hung("ball", 0.5)),
                (ValueError, "axes = 4 is not from 2 to 3", lambda: rigid.Bodies(BODIES[12], axes=4)),
                (ValueError, r"gravity has the shape \(\), not", lambda: rigid.Bodies(BODIES[12], gravity=9.8)),
                (ValueError, r"^gravity has the shape \(2,\)", lambda: rigid.Bodies(BODIES[12], gravity=[0, 1])),
                (ValueError, r"joint\[0\].point has the shape \(2,\)", lambda: hung("ball", 0, point=[0, 1])),
                (ValueError, r"joint\[0\].other = -2 is not from -1", lambda: hung("ball", 0, -2)),
                (ValueError, r"body\[0\].mass = nan is not finite", lambda: rigid.Bodies(rigid.Body(math.nan, 1))),
                (ValueError, "radius = inf is not finite", lambda: rigid.sphere(1, math.inf)),
                (ValueError, r"omega\[0\] = nan is not finite", lambda: box.state(motion(omega=[math.nan, 0, 0]))),
                (ValueError, r"quaternion has the shape \(3,\)", lambda: box.state(motion(quaternion=[1, 0, 0]))),
                (ValueError, "axis has the length 0", lambda: rigid.turn([0, 0, 0], 1)),
                (ValueError, "body = 1 is not from 0 to 0", lambda: box.point(q, X, 1)),
                (ValueError, r"q and p have the shapes", lambda: box.motion(q, p[None])),
                (ValueError, r"q has the shape \(11,\), not", lambda: box.angular_momentum(q[1:], p[1:])),
                (TypeError, "F has jets or real numbers, not str", lambda: box.force(q, [1, 2, "a"]))):
            self.assertRaisesRegex(kind, text, call)

    def test_read_only(self):
        inertia = [1.0, 2, 3]
        box = rigid.Bodies(rigid.Body(2, inertia), gravity=[0, 0, -1])
        inertia[0] = 9  # Later, and not of what was made.
        for name in ("n", "axes", "coordinate_masses"):
            with self.assertRaises(AttributeError):
                setattr(box, name, 1)
        other = pickle.loads(pickle.dumps(box))
        self.assertEqual(other.potential(np.ones(9)), box.potential(np.ones(9)))
        self.assertTrue(same_bits(other.coordinate_masses, box.coordinate_masses))
        self.assertEqual(repr(other), "<tvi rigid bodies: 1, joints: 0, axes = 3>")


if __name__ == "__main__":
    unittest.main()
