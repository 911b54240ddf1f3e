"""What tvi.solve, tvi.ensemble, tvi.lyapunov and tvi.megno give is right, by solutions in closed form."""

import math
import os
import unittest
import warnings

import numpy as np

import tvi
from problems import kepler, same_bits, spring
from tvi import _solve

RADIAL = tvi.event(lambda q, p: q @ p, direction=1)


def moved(t):
    """The spring of frequency 1 from q = 1, p = 0."""
    return np.cos(t), -np.sin(t)


class Solve(unittest.TestCase):
    def right(self, result, delta=1e-9):
        q, p = moved(result.t)
        self.assertLess(np.abs(result.q[:, 0] - q).max(), delta)
        self.assertLess(np.abs(result.p[:, 0] - p).max(), delta)
        self.assertEqual((result.status, result.success), (0, True))

    def test_ways(self):
        """Each way to say the step, to both sides, with and without times, of plain and rescaled systems."""
        scaled = tvi.hamiltonian(1, lambda q, p: (q[0]**2 + p[0]**2) / 2).rescaled(lambda q, p: 1 + q[0]**2 / 2)
        times = [0, 0.01, 1, 7, 7.5, 20]
        for system in spring(), scaled:
            for step in ({"h": 0.3}, {"error": 1e-10}, {}, {"tolerance": 1e-12}):
                if system is scaled and "tolerance" in step:
                    continue
                for sign in 1, -1:
                    with self.subTest(f"{system} {step} {sign}"):
                        whole = tvi.solve(system, (0, 20 * sign), [1], p0=0, dense_output=True, **step)
                        self.right(whole)
                        self.assertEqual((whole.t[0], whole.t[-1], whole.t_end), (0, 20 * sign, 20 * sign))
                        self.assertTrue((np.diff(whole.t) * sign > 0).all())
                        at = tvi.solve(system, (0, 20 * sign), [1], p0=0, t_eval=np.multiply(sign, times),
                                       dense_output=True, **step)
                        self.right(at)
                        self.assertEqual(at.t.tolist(), [sign * t for t in times])
                        for result in whole, at:
                            q, p = result.sol(np.multiply(sign, [20, 0, 3.3, 3.2, 19.99]))
                            t = np.multiply(sign, [20, 0, 3.3, 3.2, 19.99])
                            self.assertLess(np.abs(q[:, 0] - np.cos(t)).max() + np.abs(p[:, 0] + np.sin(t)).max(), 1e-9)
                            self.assertEqual(result.sol(sign * 1.0)[0].shape, (1,))
                            for outside in (-0.1 * sign, 20.1 * sign, [0, 21 * sign]):
                                with self.assertRaisesRegex(ValueError, "ends of the run"):
                                    result.sol(outside)
                        self.assertLess(np.ptp(whole.energy), 1e-13 if "h" in step else 1e-9)
                        self.assertTrue(same_bits(whole.v, whole.p))
                        self.assertLess(whole.end_error(), 1e-8)
        self.assertIsNone(tvi.solve(spring(), (0, 1), [1], p0=0, h=0.1).sol)

    def test_starts(self):
        system = tvi.potential(2, lambda q: q @ q, mass=[1, 4])
        by_v = tvi.solve(system, (0, 1), [1, 0], v0=[1, 1], h=0.1)
        self.assertEqual(by_v.p[0].tolist(), [1, 4])
        self.assertEqual(by_v.v[0].tolist(), [1, 1])
        self.assertEqual(tvi.solve(system, (0, 1), [1, 0], p0=0, h=0.1).p[0].tolist(), [0, 0])
        nothing = tvi.solve(system, (2, 2), [1, 0], [1, 1])
        self.assertEqual((nothing.t.tolist(), nothing.q[0].tolist(), nothing.status), ([2], [1, 0], 0))
        self.assertEqual(tvi.solve(system, (0, 1), [0, 0], p0=0, h=0.1).end_error(), 0)
        force = tvi.force(1, lambda q: -q)
        for made in force, force.rescaled(lambda q, p: 1 + q[0]**2, reversible=True):
            self.assertIsNone(tvi.solve(made, (0, 1), [1], p0=0, h=0.1).energy)
        self.assertEqual(len(tvi.solve(system, (0, 1), [1, 0], p0=0, h=0.1, t_eval=[]).t), 0)

    def test_suggested(self):
        """The error is that which was asked for, and is seen by end_error."""
        exact = tvi.solve(kepler(), (0, 300), [1, 0], [0, 0.8], h=0.1, t_eval=[300]).q_end
        for error in (1e-4, 1e-8):
            result = tvi.solve(kepler(), (0, 300), [1, 0], [0, 0.8], error=error)
            found = np.abs(result.q_end - exact).max() / np.abs(result.q).max()
            self.assertLess(found, error)
            self.assertTrue(0.5 * found < result.end_error() + 1e-12 and result.end_error() < error)
            self.assertTrue(found / 2 < result.error <= error and "was measured" in result.message)

    def test_smallest_error(self):
        """Without an error a run takes 1e-9 or what roundoff allows; with one it is refused."""
        long = tvi.solve(kepler(), (0, 1e5), [1, 0], [0, 0.8])
        self.assertTrue(long.success and 1e-9 < long.error < 1e-8, long.error)
        with self.assertRaises(tvi.Error) as raised:
            tvi.solve(kepler(), (0, 1e5), [1, 0], [0, 0.8], error=1e-11)
        self.assertEqual(raised.exception.status, "EROUNDOFF")

    def test_largest_step(self):
        """What is too short to be seen between steps; and h is the step itself."""
        pulse = spring().driven(lambda q, v, t: [20 * np.exp(-((t - 30.123) / 0.01) ** 2)])
        right = tvi.solve(pulse, (0, 50), [1], 0, h=0.002).q_end
        for way in ({"error": 1e-8}, {"tolerance": 1e-10}):
            bounded = tvi.solve(pulse, (0, 50), [1], 0, largest_step=0.02, **way)
            self.assertLess(np.abs(bounded.q_end - right).max(), 1e-7)
            self.assertLess(bounded.end_error(), 1e-7)
            many = tvi.ensemble(pulse, (0, 50), [[1], [1.1]], 0, largest_step=0.02, **way)
            self.assertLess(np.abs(many.q[0] - right).max(), 1e-7)
        for run in tvi.solve, tvi.ensemble:
            with self.assertRaises(TypeError):
                run(pulse, (0, 50), [1], 0, h=0.1, largest_step=0.02)

    def test_many_steps(self):
        """After 10,000 steps every k-th is kept, at even distances, and sol knows all between."""
        result = tvi.solve(spring(), (0, 10000.05), [1], p0=0, h=0.3, dense_output=True, compiled=False)
        self.assertTrue(5000 < len(result.t) <= 10002)
        self.assertLess(np.ptp(np.diff(result.t)[:-1]), 1e-9)
        self.right(result, 1e-8)
        self.assertEqual((result.t[-1], result.t_end), (10000.05, 10000.05))
        t = np.linspace(0, 10000, 777)
        self.assertLess(np.abs(result.sol(t)[0][:, 0] - np.cos(t)).max(), 1e-8)
        rows, _solve.ROWS = _solve.ROWS, 10
        try:
            few = tvi.solve(spring(), (0, 1000), [1], p0=0, h=0.3, compiled=False)
        finally:
            _solve.ROWS = rows
        self.assertEqual(few.t.round(6).tolist(), [*(np.arange(10) * 100.2).round(6), 1000])
        adapted = tvi.solve(kepler().rescaled(), (0, 20000), [1, 0], [0, 1], h=0.5, dense_output=True)
        self.assertTrue(10000 < len(adapted.t) <= 20001)
        t = np.linspace(0, 20000, 777)
        self.assertLess(np.abs(adapted.sol(t)[0][:, 0] - np.cos(t)).max(), 1e-7)

    def test_events(self):
        """Events with each way; those of SciPy's kind; a terminal one; none after the end."""
        zero = lambda q, p: q[0]
        wanted = np.pi / 2 + np.pi * np.arange(6)
        for step in ({"h": 0.3}, {"tolerance": 1e-12}, {"error": 1e-12}):
            for more in ({}, {"t_eval": [1, 2]}, {"dense_output": True}):
                with self.subTest(f"{step} {more}"):
                    result = tvi.solve(spring(), (0, 18), [1], p0=0, events=[zero, tvi.event(zero, -1)], **step, **more)
                    self.assertEqual([len(found.t) for found in result.events], [6, 3])
                    self.assertLess(np.abs(result.events[0].t - wanted).max(), 1e-10)
                    self.assertLess(np.abs(result.events[0].q).max(), 1e-10)
                    self.assertLess(np.abs(np.abs(result.events[0].p) - 1).max(), 1e-10)
                    last = tvi.event(zero, 1, terminal=True)
                    ended = tvi.solve(spring(), (0, 18), [1], p0=0, events=last, **step, **more)
                    self.assertEqual((ended.status, ended.success, len(ended.events[0].t)), (1, True, 1))
                    self.assertAlmostEqual(ended.t_end, 1.5 * np.pi, delta=1e-10)
                    self.assertIn("event 0 ended the run", ended.message)
        soon = tvi.solve(spring(), (0, 1.55), [1], p0=0, h=0.3, t_eval=[1], events=zero)
        self.assertEqual(len(soon.events[0].t), 0, "that at 1.57 is past the end, in the last step")
        zero.terminal, zero.direction = True, -1
        soon = tvi.solve(spring(), (0, 18), [1], p0=0, h=0.3, events=zero)
        self.assertAlmostEqual(soon.t_end, np.pi / 2, delta=1e-10)
        moving = tvi.event(lambda q, p, t, k: q[0] - k * t, terminal=True)
        system = tvi.potential(1, lambda q, k: q[0]**2 / 2, k=1.0)
        for k in (0.5, 1.0):
            t = tvi.solve(system, (0, 18), [1], p0=0, h=0.3, events=moving, k=k).t_end
            self.assertAlmostEqual(math.cos(t), k * t, delta=1e-10)

    def test_parameters(self):
        """Runs, steps and energies take the values of the run, not those of the recording."""
        system = tvi.potential(1, lambda q, w: w**2 * q[0]**2 / 2, w=1.0)
        for step in ({"h": 0.1}, {"error": 1e-10}, {"tolerance": 1e-12}):
            result = tvi.solve(system, (0, 5), [1], p0=0, w=2.0, dense_output=True, **step)
            self.assertLess(np.abs(result.q[:, 0] - np.cos(2 * result.t)).max(), 1e-9)
            self.assertAlmostEqual(result.energy[-1], 2.0, delta=1e-10)
            self.assertAlmostEqual(result.sol(3.21)[0][0], math.cos(6.42), delta=1e-9)
            self.assertLess(result.end_error(), 1e-8)
        scaled = tvi.solve(system.rescaled(lambda q, p, w: (1 + q[0]**2) / w), (0, 5), [1], p0=0, w=2.0, h=0.1)
        self.assertAlmostEqual(scaled.energy[-1], 2.0, delta=1e-10)
        self.assertAlmostEqual(scaled.q_end[0], math.cos(10), delta=1e-9)
        slow = tvi.solve(system, (0, 1000), [1], p0=0, error=1e-8).h
        self.assertTrue(1.8 < slow / tvi.solve(system, (0, 500), [1], p0=0, error=1e-8, w=2.0).h < 2.2)
        damped = system.driven(lambda q, v, c: -c * v, c=0.0)
        end = tvi.solve(damped, (0, 5), [1], p0=0, h=0.1, c=0.2, w=1.5).q_end[0]
        w = math.sqrt(1.5**2 - 0.01)
        self.assertAlmostEqual(end, math.exp(-0.5) * (math.cos(5 * w) + 0.1 / w * math.sin(5 * w)), delta=1e-10)

    def test_refused_step(self):
        """What was reached is given, with the text of the library."""
        for more in ({}, {"t_eval": [1, 9]}):
            result = tvi.solve(kepler(), (0, 40), [1, 0], [0, 0.8], h=2.5, **more)
            self.assertEqual((result.status, result.success), (-1, False))
            self.assertIn("did not converge", result.message)
            self.assertTrue(0 < result.t_end < 40)
        ball = tvi.solve(tvi.potential(1, lambda q: -1 / np.sqrt(q[0])), (0, 40), [1], p0=0, tolerance=1e-10)
        self.assertEqual(ball.status, -1)
        self.assertGreater(len(ball.t), 3)

    def test_compiled(self):
        """auto compiles long runs and no others, without asking the clock."""
        method = tvi.Method("stormer-verlet", 2)  # which is compiled fast
        self.assertFalse(_solve.code_of("auto", spring(), method, 1e7))
        self.assertIsInstance(_solve.code_of("auto", spring(), method, 1e10), tvi.Compiled)
        self.assertFalse(_solve.code_of("auto", spring(), method, math.nan))
        kept = os.environ.get("CC")
        os.environ["CC"] = "no-such-compiler"
        try:
            self.assertFalse(_solve.code_of("auto", spring(), method, 1e10))
            with self.assertRaises(tvi.Error) as raised:
                tvi.solve(spring(), (0, 1), [1], p0=0, h=0.1, compiled=True)
            self.assertEqual(raised.exception.status, "ECOMPILE")
        finally:
            os.environ.pop("CC") if kept is None else os.environ.update(CC=kept)
        result = tvi.solve(spring(), (0, 5), [1], p0=0, h=0.001, compiled=True, method=method)
        self.assertTrue(result.stats.is_compiled)
        self.right(result, 1e-5)

    def test_progress(self):
        told = []
        tvi.solve(kepler(), (0, 200000), [1, 0], [0, 0.8], h=0.25, t_eval=[200000],
                  progress=lambda t, done: told.append((t, done)))
        self.assertEqual(told[-1][1], 1.0)
        self.assertEqual(told, sorted(told))


class Many(unittest.TestCase):
    def test_ways(self):
        q0 = np.linspace([1], [2], 20)
        for step in ({"h": 0.3}, {"error": 1e-10}, {"tolerance": 1e-12}):
            with self.subTest(str(step)):
                result = tvi.ensemble(spring(), (0, 10), q0, p0=0, events=lambda q, p: q[0], threads=2, **step)
                self.assertLess(np.abs(result.q - q0 * math.cos(10)).max(), 1e-9)
                self.assertEqual((result.success, set(result.status)), (True, {"OK"}))
                self.assertEqual(np.bincount(result.events[0].member).tolist(), [3] * 20)
                self.assertLess(np.abs(result.events[0].q).max(), 1e-9)
        at = tvi.ensemble(spring(), (0, -10), q0, p0=0, h=0.3, t_eval=[-1, -9.5], threads=2)
        self.assertEqual(at.q.shape, (20, 2, 1))
        self.assertLess(np.abs(at.p[:, :, 0] - q0 * np.sin([1, 9.5])).max(), 1e-9)
        system = tvi.potential(1, lambda q, w: w**2 * q[0]**2 / 2, w=1.0)
        w = np.linspace(1, 3, 7)
        many = tvi.ensemble(system, (0, 10), [1], p0=0, w=w, error=1e-10)
        self.assertLess(np.abs(many.q[:, 0] - np.cos(10 * w)).max(), 1e-9)
        self.assertLess(np.abs(many.orbits.energy() - w**2 / 2).max(), 1e-12)
        self.assertLess(np.abs(many.orbits.v - many.p).max(), 1e-15)

    def test_times_closer_than_steps(self):
        """Lists of times are cut into calls, between which times lie in the last step. The bits are those of solve."""
        for system in spring(), spring().rescaled():
            for count in 10, 100, 1000:
                times = np.linspace(0, 10, count)
                with self.subTest(f"{system!r}, {count}"):
                    many = tvi.ensemble(system, (0, 10), [[1.0], [2.0]], 0, h=0.5, t_eval=times, threads=2)
                    alone = tvi.solve(system, (0, 10), [2.0], 0, h=0.5, t_eval=times, compiled=False)
                    self.assertEqual(set(many.status), {"OK"})
                    self.assertTrue(same_bits(many.q[1], alone.q) and same_bits(many.p[1], alone.p))

    def test_alone_and_together(self):
        """A member has the bits of an ensemble of one, however many threads there are."""
        q0 = np.linspace([1, 0], [1.5, 0.3], 33)
        runs = [tvi.ensemble(kepler(), (0, 50), q0[members], [0, 0.8], h=0.1, threads=threads,
                             events=events) for events in ((), RADIAL)
                for members, threads in ((slice(None), 1), (slice(None), 2), (slice(7, 8), 1))]
        for first in 0, 3:
            self.assertTrue(same_bits(runs[first].q, runs[first + 1].q))
            self.assertTrue(same_bits(runs[first].q[7], runs[first + 2].q[0]))
        one, other, alone = (run.events[0] for run in runs[3:])
        self.assertTrue(same_bits(one.t, other.t) and same_bits(one.member, other.member))
        self.assertTrue(same_bits(one.t[one.member == 7], alone.t))

    def test_failing_members(self):
        """Members that fail, or that an event ends, leave the others alone; others go on after them."""
        system = tvi.potential(1, lambda q: -1 / np.sqrt(q[0]) + q[0]**2 / 2)
        result = tvi.ensemble(system, (0, 30), [[2], [1.4], [1e-3]], p0=0, h=0.1)
        self.assertFalse(result.success)
        self.assertTrue(0 < (result.status != "OK").sum() < 4)
        end = tvi.event(lambda q, p: q[0], terminal=True)
        ended = tvi.ensemble(spring(), (0, 3), [[1], [2]], [[0], [5]], h=0.1, events=end)
        self.assertEqual((set(ended.status), ended.success), ({"ESTOPPED"}, True))
        self.assertTrue((ended.orbits.t < 3).all() and len(ended.events[0].t) == 2)
        orbits = tvi.Ensemble(spring(), [[1], [2]], p=0)
        self.assertFalse(orbits.run(h=0.1, steps=50, at_step=lambda member, step, *state: member == 1 and step == 3))
        self.assertEqual(orbits.status.tolist(), ["OK", "ESTOPPED"])
        self.assertAlmostEqual(orbits.t[1], 0.3)
        self.assertTrue(orbits.integrate(0.1, 5))
        orbits.q[0] = np.nan
        self.assertFalse(orbits.integrate(0.1, 5))
        self.assertEqual(orbits.status[0], "ENONFINITE")
        orbits.q[0] = 1
        orbits.reset()
        self.assertTrue(orbits.integrate(0.1, 5))

    def test_saved(self):
        one, other = (tvi.Ensemble(kepler(), [[1, 0], [2, 0]], [0, 0.5]) for _ in range(2))
        one.integrate(0.1, 100)
        other.load(one.save())
        one.integrate(0.1, 100), other.integrate(0.1, 100)
        self.assertTrue(same_bits(one.q, other.q))
        self.assertEqual(one.stats, other.stats)

    def test_histories_of_others(self):
        """The history of another method is dropped, with a warning."""
        one, other = (tvi.Integrator(kepler(), [1, 0], [0, 1], order=order) for order in (8, 12))
        one.integrate(0.1, 5)
        with self.assertWarnsRegex(UserWarning, "history of the steps is of another .* and was dropped"):
            other.load(one.save())
        self.assertEqual((other.t, other.q.tolist(), other.stats.steps), (0.5, one.q.tolist(), 0))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            one.load(one.save())

    def test_texts(self):
        """Values of parameters travel, too, by their names."""
        system = tvi.potential(1, lambda q, k, c: (k * q[0]**2 + c[0] * q[0]**4 + c[1] * q[0]**6) / 2, k=1.0,
                               c=[0, 0.5])
        one, other = tvi.Integrator(system, [1], p=0, k=2.0, c=[0.25, 0]), tvi.Integrator(system, [0], p=0)
        orbits = tvi.Ensemble(system, [[1], [2]], p=0)
        one.integrate(0.1, 7)
        other.from_text(one.to_text())
        orbits.member_from_text(1, one.to_text())
        self.assertEqual((other.parameters["k"], other.parameters["c"].tolist()), (2.0, [0.25, 0]))
        self.assertEqual((other.t, other.energy()), (one.t, one.energy()))
        self.assertEqual((orbits.t.tolist(), orbits.energy()[1]), ([0, one.t], one.energy()))
        self.assertEqual(orbits.member_to_text(1), one.to_text())
        for it in (one, other, orbits):
            it.integrate(0.1, 20)
        self.assertLess(max(abs(other.q - one.q), abs(orbits.q[1] - one.q)), 1e-14)
        self.assertGreater(abs(orbits.q[0] - one.q), 1e-3)

    def test_tangents(self):
        """The tangent map of the spring is its rotation, for an integrator and for members, and at events."""
        rotation = [[math.cos(1), math.sin(1)], [-math.sin(1), math.cos(1)]]
        it, orbits = tvi.Integrator(spring(), [1], p=0), tvi.Ensemble(spring(), [[1], [2]], p=0)
        it.tangent = orbits.tangent = np.eye(2)
        it.integrate_to(0.3, 1), orbits.integrate_to(0.3, 1)
        self.assertLess(np.abs(it.tangent - rotation).max(), 1e-13)
        self.assertLess(np.abs(orbits.tangent - rotation).max(), 1e-13)
        there = []
        it = tvi.Integrator(spring(), [1], p=0)
        it.tangent = np.eye(2)
        it.run(h=0.3, t_end=3, events=lambda q, p: q[0], on_event=lambda *told: there.append(it.tangent.copy()))
        self.assertLess(np.abs(there[0] - [[0, 1], [-1, 0]]).max(), 1e-12)
        system = tvi.potential(1, lambda q, k: k * q[0]**2 / 2, k=1.0)
        it = tvi.Integrator(system, [1], p=0)
        it.tangent = [[0], [0], [1]]
        it.integrate_to(0.3, 2)
        self.assertAlmostEqual(it.tangent[0, 0], -math.sin(2), delta=1e-12)

    def test_chaos(self):
        """Exponents of what is known: a pendulum upside down, a spring, and orbits of Henon and Heiles."""
        hill = tvi.potential(1, lambda q, w: -w**2 * q[0]**2 / 2, w=1.0)
        self.assertAlmostEqual(tvi.lyapunov(hill, (0, 50), [0], p0=0, h=0.1), 1, delta=0.01)
        self.assertAlmostEqual(tvi.lyapunov(hill, (0, 50), [0], p0=0, h=0.1, w=2.0, every=7), 2, delta=0.02)
        self.assertAlmostEqual(tvi.lyapunov(hill, (0, 10), [0], p0=0, h=0.1, w0=[1, -1]), -1, delta=0.01)
        bowl = tvi.potential(2, lambda q: q @ q / 2 + q[0]**2 * q[1] - q[1]**3 / 3)
        q0, p0 = [[0.25, -0.25], [0.25, 0.375]], [[0.25, 0], [0.1875, 0]]
        values = tvi.megno(bowl, (0, 2000), q0, p0, h=0.5, threads=1)
        self.assertTrue(1.8 < values[0] < 2.2 and values[1] > 10)
        exponents = tvi.lyapunov(bowl, (0, 2000), q0, p0, h=0.5, threads=1, every=5)
        self.assertTrue(exponents[0] < 0.01 < 0.03 < exponents[1])
        scaled = tvi.megno(kepler().rescaled(lambda q, p: (q @ q)**0.75), (0, 1000), [1, 0], [0, 0.8], h=0.3, threads=1)
        self.assertTrue(1.8 < scaled < 2.2)
        light = tvi.potential(2, lambda q: 2.0**-100 * -1 / np.sqrt(q @ q), mass=2.0**-100)
        heavy = tvi.potential(2, lambda q: -1 / np.sqrt(q @ q))
        self.assertEqual(tvi.megno(light, (0, 100), [1, 0], v0=[0, 0.8], h=0.25),
                         tvi.megno(heavy, (0, 100), [1, 0], v0=[0, 0.8], h=0.25))
        self.assertTrue(np.isnan(tvi.megno(kepler(), (0, 50), [[1, 0], [1e-9, 0]], [0, 1], h=0.1)[1]))
        for wrong in ({"w0": [0, 0]}, {"w0": [1]}, {"h": 0.1, "every": 0}):
            with self.assertRaises(ValueError):
                tvi.lyapunov(hill, (0, 50), [0], p0=0, **{"h": 0.1, **wrong})
        self.assertTrue(math.isnan(tvi.megno(kepler(), (0, 50), [1e-9, 0], [0, 1], h=0.1)))
        with self.assertRaisesRegex(ValueError, "t_span has no length"):
            tvi.megno(hill, (1, 1), [0], p0=0)

    def test_chaos_of_one_and_many(self):
        """One orbit and many have the same sums, and `every` changes MEGNO of a regular orbit by little."""
        bowl = tvi.potential(2, lambda q, k: q @ q / 2 + k * (q[0]**2 * q[1] - q[1]**3 / 3), mass=[1.0, 1.0], k=1.0)
        start = (0, 400), [0.25, 0.375], [0.1875, 0]
        for function in (tvi.lyapunov, tvi.megno):
            for more in ({}, {"w0": [1, 0, 0, 0]}, {"k": 0.9}, {"method": "midpoint", "order": 8}):
                one = function(bowl, *start, h=0.5, **more)
                many = function(bowl, start[0], [start[1]] * 2, start[2], h=0.5, **more)
                self.assertIsInstance(one, float)
                self.assertLess(np.abs(many / one - 1).max(), 1e-8)
            back = function(bowl, (0, -400), *start[1:], h=0.5)
            self.assertGreater(back, 0)
            self.assertLess(abs(function(bowl, (0, 100), *start[1:], error=1e-6) /
                                function(bowl, (0, 100), *start[1:], h=0.05) - 1), 0.02)
        stack = function(bowl, (0, 100), [[0.25, -0.25]] * 2, [0.25, 0], error=1e-6)
        self.assertTrue((stack > 1).all() and (stack < 2).all())
        pendulum = tvi.potential(1, lambda q: -np.cos(q[0]))
        each = [tvi.megno(pendulum, (0, 20000), [[1]] * 2, p0=0, h=0.5, every=every)[0] for every in (1, 10, 50, 100)]
        self.assertTrue(1.97 < min(each) < max(each) < 2.005, each)
        self.assertLess(max(each) - min(each), 0.01)
        self.assertEqual(tvi.megno(pendulum, (0, 2000), [1], p0=0, h=0.5, every=100),
                         tvi.megno(pendulum, (0, 2000), [1], p0=0, h=0.5))


if __name__ == "__main__":
    unittest.main()
