"""Callbacks of events, which change the momenta and let the run go on: by solutions in closed form."""

import unittest

import numpy as np

import tvi
from problems import spring
from tvi import _recorder

G = 9.8
FALL = tvi.potential(1, lambda q: 2 * G * q[0], mass=2)


def floor(part):
    """A ball that keeps this part of its momentum when it bounces."""
    return tvi.event(lambda q, p: q[0], direction=-1, callback=lambda t, q, p: -part * p)


def height(t, part):
    """Of the ball that fell from 1, and bounced."""
    start, v = np.sqrt(2 / G), np.sqrt(2 * G)
    if t <= start:
        return 1 - G * t**2 / 2
    while True:
        v *= part
        if t <= start + 2 * v / G:
            return v * (t - start) - G * (t - start)**2 / 2
        start += 2 * v / G


class Callbacks(unittest.TestCase):
    def test_a_callback_that_ends_the_run(self):
        def bounce(t, q, p):
            if abs(p[0]) < 0.1:
                raise StopIteration
            return -0.5 * p

        fall = tvi.potential(1, lambda q: 9.8 * q[0])
        floor = tvi.event(lambda q, p: q[0], direction=-1, callback=bounce)
        for way in ({"h": 0.1}, {"tolerance": 1e-12}):
            run = tvi.solve(fall, (0, 10), [1], p0=0, events=floor, **way)
            speeds = np.abs(run.events[0].p[:, 0])
            self.assertEqual((run.status, run.t_end), (1, run.events[0].t[-1]))
            self.assertTrue(speeds[-1] < 0.1 <= speeds[-2])
            self.assertIn("event 0 ended the run", run.message)
            self.assertEqual(run.p_end[0], run.events[0].p[-1, 0])

    def test_bounces(self):
        """Each way to say the step, with and without times, forwards and back, between the steps and at impacts."""
        impacts = np.sqrt(2 / G) * np.array([1, 2, 2.5, 2.75, 2.875])
        times = np.union1d(np.linspace(0, 1.3, 53), np.add.outer(impacts, [1e-9, 1e-6, 1e-3]).ravel()[:-1])
        for step in ({"h": 0.1}, {"tolerance": 1e-13}):
            for t_eval in (None, times):
                with self.subTest(f"{step} {t_eval is None}"):
                    run = tvi.solve(FALL, (0, 1.3), [1], p0=0, events=floor(0.5), t_eval=t_eval, dense_output=True,
                                    **step)
                    self.assertEqual((run.status, run.t_end, run.message), (0, 1.3, "the end was reached, t = 1.3."))
                    self.assertLess(np.abs(run.events[0].t - impacts).max(), 1e-14)
                    self.assertLess(np.max([abs(q[0] - height(t, 0.5)) for t, q in zip(run.t, run.q)]), 1e-14)
                    self.assertLess(np.max([abs(run.sol(t)[0][0] - height(t, 0.5)) for t in times]), 1e-14)
                    if t_eval is not None:
                        self.assertEqual(run.t.tolist(), times.tolist())
                    else:  # The states before and after an impact are rows of their own.
                        here = np.flatnonzero(np.diff(run.t) == 0)
                        self.assertEqual(run.t[here].tolist(), run.events[0].t.tolist())
                        self.assertTrue(np.allclose(run.p[here + 1], -0.5 * run.p[here], rtol=1e-14, atol=0))
                    self.assertLess(run.end_error(), 1e-13)
                    back = tvi.solve(FALL, (run.t_end, 0), run.q_end, run.p_end, events=floor(2), **step)
                    self.assertLess(abs(back.q_end[0] - 1) + abs(back.p_end[0]), 1e-12)

    def test_two_events(self):
        """Two masses that meet without loss and a wall behind: both momenta change, and the energy is kept."""
        def meet(t, q, p, m=np.array([1.0, 3.0])):
            v = p / m
            return m * (2 * p.sum() / m.sum() - v)

        free = tvi.potential(2, lambda q: 1e-3 * (q @ q), mass=[1, 3])
        events = [tvi.event(lambda q, p: q[1] - q[0], callback=meet),
                  tvi.event(lambda q, p: q[0] + 1, callback=lambda t, q, p: [-p[0], p[1]])]
        run = tvi.solve(free, (0, 40), [0, 1], [1, -3], h=0.5, events=events)
        self.assertGreater(min(len(found.t) for found in run.events), 1)
        self.assertLess(np.ptp(run.energy), 1e-14)
        self.assertTrue((run.q[:, 0] > -1 - 1e-14).all() and (run.q[:, 1] - run.q[:, 0] > -1e-14).all())

    def test_kicks(self):
        """At times, of a rescaled system, too; None leaves the momenta; a terminal event ends the run with them."""
        kick = tvi.event(lambda q, p, t: t - 1, callback=lambda t, q, p: p + 1)
        for system in spring(), tvi.potential(1, lambda q: q[0]**2 / 2).rescaled(lambda q, p: 1 + q[0]**2 / 2):
            run = tvi.solve(system, (0, 3), [1], p0=0, h=0.3, events=kick)
            self.assertAlmostEqual(run.q_end[0], np.cos(3) + np.sin(2), delta=1e-12)
        told = []
        watch = tvi.event(lambda q, p: q[0], callback=lambda *state: told.append(state))
        run = tvi.solve(spring(), (0, 7), [1], p0=0, h=0.3, events=watch)
        self.assertLess(np.abs([t for t, _, _ in told] - np.pi * np.array([0.5, 1.5])).max(), 1e-14)
        self.assertAlmostEqual(run.q_end[0], np.cos(7), delta=1e-13)
        last = tvi.event(lambda q, p: q[0], terminal=True, callback=lambda t, q, p: 2 * p)
        run = tvi.solve(spring(), (0, 7), [1], p0=0, h=0.3, events=last)
        self.assertEqual(run.status, 1)
        self.assertLess(abs(run.p_end[0] + 2) + abs(run.t_end - np.pi / 2), 1e-14)

    def test_end(self):
        """An event at the end of the run is the last thing in it."""
        kick = tvi.event(lambda q, p, t: t - 3, callback=lambda t, q, p: p + 1)
        for step in ({"h": 0.3}, {"tolerance": 1e-12}):
            run = tvi.solve(spring(), (0, 3), [1], p0=0, events=kick, t_eval=[1, 3], **step)
            self.assertEqual((run.status, run.t.tolist(), run.t_end), (0, [1, 3], 3))
            self.assertAlmostEqual(run.p_end[0], 1 - np.sin(3), delta=1e-10)
            self.assertAlmostEqual(run.p[-1, 0], -np.sin(3), delta=1e-10)

    def test_times_before_an_end(self):
        """All times before a terminal event are in the result, those in its step, too."""
        zero = tvi.event(lambda q, p: q[0], terminal=True)
        for step in ({"h": 0.3}, {"tolerance": 1e-12}):
            run = tvi.solve(spring(), (0, 3), [1], p0=0, events=zero, t_eval=np.linspace(0, 3, 301), **step)
            self.assertEqual((run.status, len(run.t)), (1, 158))
            self.assertLess(np.abs(run.q[:, 0] - np.cos(run.t)).max(), 1e-10)

    def test_many_steps(self):
        """Where not all states are kept, those after an impact are."""
        kept, _recorder.ROWS = _recorder.ROWS, 20
        try:
            for step in ({"h": 0.001}, {"tolerance": 1e-6, "largest_step": 0.001}):
                run = tvi.solve(FALL, (0, 1.3), [1], p0=0, events=floor(0.5), dense_output=True, **step)
                self.assertLess(len(run.t), 100)
                times = np.linspace(0, 1.3, 501)
                self.assertLess(np.max([abs(run.sol(t)[0][0] - height(t, 0.5)) for t in times]), 1e-12)
        finally:
            _recorder.ROWS = kept

    def test_rest(self):
        run = tvi.solve(FALL, (0, 3), [1], p0=0, h=0.1, events=floor(0.5))
        self.assertEqual(run.status, -1)
        self.assertRegex(run.message, "as of a ball at rest: end the run before that by a terminal event")
        self.assertAlmostEqual(run.t_end, 3 * np.sqrt(2 / G), delta=1e-12)

    def test_refusals(self):
        for given in ({}, {"error": 1e-9}):
            with self.assertRaisesRegex(TypeError, "give h or a tolerance"):
                tvi.solve(FALL, (0, 1), [1], p0=0, events=floor(0.5), **given)
        with self.assertRaisesRegex(TypeError, "callbacks are for tvi.solve"):
            tvi.ensemble(FALL, (0, 1), [[1]], p0=0, h=0.1, events=floor(0.5))
        with self.assertRaisesRegex(TypeError, "callbacks are for tvi.solve"):
            tvi.Integrator(FALL, [1], p=0).run(h=0.1, steps=1, events=[floor(0.5)])
        with self.assertRaisesRegex(TypeError, "callback is a function of"):
            tvi.event(lambda q, p: q[0], callback=3)
        for returned, text in ((lambda t, q, p: [1, 2], r"event 0 returned has the shape \(2,\)"),
                               (lambda t, q, p: np.nan * p, r"event 0 returned\[0\] = nan"),
                               (lambda t, q, p: 1 / 0, "division")):
            with self.assertRaisesRegex((ValueError, ZeroDivisionError), text):
                tvi.solve(FALL, (0, 1), [1], p0=0, h=0.1, events=tvi.event(lambda q, p: q[0], callback=returned))


if __name__ == "__main__":
    unittest.main()
