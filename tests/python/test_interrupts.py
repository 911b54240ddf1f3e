"""Ctrl-C ends runs, callbacks and compilations as KeyboardInterrupt, and gives the state that was reached."""

import faulthandler
import os
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy as np

import tvi
from problems import kepler, same_bits, spring

SOON = 15  # seconds within which Ctrl-C is heard on a busy machine; what is interrupted would take 20 and more


def setUpModule():
    """Programs in the background of a shell ignore SIGINT, and so would Python; what does not hear it is ended, and
    where it stands is told."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    faulthandler.dump_traceback_later(400, exit=True)


def tearDownModule():
    faulthandler.cancel_dump_traceback_later()


class Pressed:
    """Sends SIGINT to this process after a while, and says how long it took to be heard."""

    def __init__(self, after=0.3):
        self.after = after

    def __enter__(self):
        self.timer = threading.Timer(self.after, lambda: os.kill(os.getpid(), signal.SIGINT))
        self.start = time.perf_counter()
        self.timer.start()
        return self

    def __exit__(self, *raised):
        self.timer.join()
        self.heard = time.perf_counter() - self.start - self.after


class Interrupts(unittest.TestCase):
    def test_runs(self):
        """All ways of a run, the steps of which would take minutes."""
        system = kepler()
        far, slow = 1e9, tvi.Ensemble(system, [[1, 0]] * 50, [0, 0.8])
        times = np.linspace(0, 1e7, 10**6)
        end = tvi.event(lambda q, p: q[0] - 100, terminal=True)
        ways = {
            "steps": lambda it: it.integrate(0.25, 10**12),
            "to": lambda it: it.integrate_to(0.25, far),
            "at": lambda it: it.integrate_at(0.25, [1, far]),
            "many times": lambda it: it.run(h=0.25, times=times, at_time=lambda *told: None),
            "events": lambda it: it.integrate_to(0.25, far, events=lambda q, p: q @ p, on_event=lambda *told: None),
            "terminal": lambda it: it.integrate(0.25, 10**12, events=end),
            "observer": lambda it: it.integrate(0.25, 10**12, at_step=lambda *told: None),
        }
        for name, way in ways.items():
            with self.subTest(name):
                it = tvi.Integrator(system, [1, 0], [0, 0.8])
                pressed = Pressed()
                with self.assertRaises(tvi.Interrupted) as raised, pressed:
                    way(it)
                self.assertLess(pressed.heard, SOON)
                self.assertIs(raised.exception.result, it)
                self.assertIsInstance(raised.exception, KeyboardInterrupt)
                self.assertGreater(it.t, 10)
                self.assertAlmostEqual(it.energy(), -0.68, delta=1e-11)
                if name != "events":  # There the state is that of an event, where it was heard in on_event.
                    again = tvi.Integrator(system, [1, 0], [0, 0.8])
                    again.integrate(0.25, it.stats.steps)
                    self.assertTrue(same_bits(it.q, again.q), "the state is that of a run of as many steps")
                it.step(0.25)
        for name, system, method, plan in (
                ("tolerance", system, "taylor", {"tolerance": 1e-10, "t_end": far}),
                ("rescaled", system.rescaled(), "galerkin", {"h": 0.25, "t_end": far})):
            with self.subTest(name):
                it = tvi.Integrator(system, [1, 0], [0, 0.8], method=method)
                with self.assertRaises(tvi.Interrupted), Pressed():
                    it.run(**plan)
                self.assertGreater(it.t, 10)
                if name == "rescaled":
                    again = tvi.Integrator(system, [1, 0], [0, 0.8])
                    again.integrate(0.25, it.stats.steps)
                    self.assertTrue(same_bits([it.t, *it.q, *it.p], [again.t, *again.q, *again.p]))
        for plan in ({"h": 0.25, "steps": 10**12}, {"h": 0.25, "t_end": far},
                     {"h": 0.25, "t_end": far, "events": end}):
            with self.subTest(f"ensemble {plan}"):
                with self.assertRaises(tvi.Interrupted) as raised, Pressed():
                    slow.run(**plan)
                self.assertIs(raised.exception.result, slow)
                self.assertGreater(slow.t.min(), 1)

    def test_ensembles(self):
        """All ways of a run of many, by threads that end their members at different times: the run does not go on."""
        far, end = 1e9, tvi.event(lambda q, p: q[0] - 100, terminal=True)
        ways = {"tolerance": {"tolerance": 1e-10}, "h": {"h": 0.25}, "terminal": {"h": 0.25, "events": end},
                "events": {"h": 0.25, "events": lambda q, p: q @ p},
                "times": {"h": 0.25, "t_eval": np.linspace(0, far, 10**5)},
                "close times": {"h": 0.25, "t_eval": np.linspace(0, 1e5, 2 * 10**5)}}
        for threads in 1, 2, 8:
            for name, way in ways.items():
                with self.subTest(f"{name}, {threads} threads"):
                    pressed = Pressed()
                    with self.assertRaises(tvi.Interrupted) as raised, pressed:
                        tvi.ensemble(kepler(), (0, way.get("t_eval", [far])[-1]), [[1, 0]] * 3, [0, 0.8],
                                     threads=threads, **way)
                    self.assertLess(pressed.heard, SOON)
                    orbits = raised.exception.result.orbits
                    self.assertLess(orbits.t.max(), 9e4 if name == "close times" else far / 10)
                    self.assertTrue(orbits.integrate(0.25, 1) or "OK" in orbits.status)

    def test_solve(self):
        with self.assertRaises(tvi.Interrupted) as raised, Pressed():
            tvi.solve(kepler(), (0, 1e9), [1, 0], [0, 0.8], h=0.25, dense_output=True, compiled=False)
        result = raised.exception.result
        self.assertEqual((result.status, result.success), (-2, False))
        self.assertIn("interrupted at t", result.message)
        self.assertGreater(result.t_end, 10)
        self.assertAlmostEqual(result.energy[-1], -0.68, delta=1e-11)
        with self.assertRaises(tvi.Interrupted) as raised, Pressed():
            tvi.ensemble(kepler(), (0, 1e9), [[1, 0]] * 50, [0, 0.8], h=0.25)
        self.assertGreater(raised.exception.result.orbits.t.min(), 1)
        with self.assertRaises(tvi.Interrupted) as raised, Pressed():
            tvi.megno(spring(), (0, 1e9), [[1]] * 50, p0=0, h=0.25)
        self.assertEqual(raised.exception.result.shape, (50,))
        with self.assertRaises(tvi.Interrupted) as raised, Pressed():
            tvi.megno(spring(), (0, 1e9), [1], p0=0, h=0.25)
        self.assertIsInstance(raised.exception.result, float)

    def test_callbacks(self):
        """In a function that is recorded, in an event, and in observers: nothing is made, and the next call works."""
        def wait(*arguments):
            deadline = time.monotonic() + 20
            while time.monotonic() < deadline:
                pass
            return 0

        system, it = kepler(), tvi.Integrator(kepler(), [1, 0], [0, 0.8])
        for name, call in {
                "potential": lambda: tvi.potential(1, wait), "force": lambda: tvi.force(1, lambda q: [wait()]),
                "event": lambda: it.integrate(0.1, 1, events=lambda q, p: wait()),
                "at_step": lambda: it.integrate(0.1, 5, at_step=wait),
                "on_event": lambda: it.integrate(0.1, 500, events=lambda q, p: q @ p, on_event=wait),
                "at_time": lambda: it.integrate_to(0.1, 1000) and it.run(h=0.1, times=[2000], at_time=wait),
                "drive": lambda: system.driven(lambda q, v: [wait(), 0]), "g": lambda: system.rescaled(wait)}.items():
            with self.subTest(name):
                pressed = Pressed()
                with self.assertRaises(KeyboardInterrupt), pressed:
                    call()
                self.assertLess(pressed.heard, SOON)
                it.step(0.1)

    def test_raised_in_callbacks(self):
        """KeyboardInterrupt and SystemExit that a callback raises itself."""
        for kind in (KeyboardInterrupt, SystemExit, GeneratorExit, MemoryError, tvi.Error):
            def function(*arguments):
                raise kind("mine")

            it = tvi.Integrator(kepler(), [1, 0], [0, 0.8])
            orbits = tvi.Ensemble(kepler(), [[1, 0]] * 9, [0, 0.8], threads=2)
            for call in (lambda: tvi.potential(1, function), lambda: tvi.force(2, function),
                         lambda: tvi.lagrangian(1, function), lambda: tvi.hamiltonian(1, function),
                         lambda: kepler().rescaled(function), lambda: kepler().driven(function),
                         lambda: tvi.constrained(kepler(), function),
                         lambda: it.integrate(0.1, 5, at_step=function),
                         lambda: it.integrate(0.1, 500, events=lambda q, p: q @ p, on_event=function),
                         lambda: it.run(h=0.1, times=[it.t + 1], at_time=function),
                         lambda: it.integrate(0.1, 1, events=function),
                         lambda: orbits.run(h=0.1, steps=3, at_step=function),
                         lambda: orbits.run(h=0.1, steps=3, observer=function)):
                with self.assertRaises(kind):
                    call()

    def test_compilation(self):
        """It is heard at once, while the compiler goes on; that of a shell stops the compiler, too."""
        system = tvi.potential(12, lambda q: sum(np.sin(q[i] * q[j]) for i in range(12) for j in range(i)))
        pressed = Pressed(0.3)
        with self.assertRaises(KeyboardInterrupt), pressed:
            tvi.compile(system, cache="")
        self.assertLess(pressed.heard, SOON)
        self.assertTrue([thread for thread in threading.enumerate() if thread.name == "tvi"], "it had ended already")
        for thread in threading.enumerate():
            if thread.name == "tvi":
                thread.join()
        self.assertEqual(tvi.Integrator(system, np.ones(12), p=0).integrate(0.01, 3), True)

    def test_other_threads(self):
        """A run on another thread goes on when the main one is interrupted."""
        it = tvi.Integrator(kepler(), [1, 0], [0, 0.8])
        thread = threading.Thread(target=it.integrate, args=(0.25, 10**6))
        thread.start()
        with self.assertRaises(KeyboardInterrupt), Pressed():
            time.sleep(20)
        thread.join()
        self.assertEqual(it.stats.steps, 10**6)

    def test_program(self):
        """A program that nobody catches anything in ends as others do, and prints nothing of the library's."""
        code = ("import tvi\nprint('begins', flush=True)\n"
                "it = tvi.Integrator(tvi.potential(1, lambda q: q[0]**2), [1], [0])\nit.integrate(0.1, 10**12)")
        with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as program:
            program.stdout.readline()
            time.sleep(0.5)
            program.send_signal(signal.SIGINT)
            errors = program.communicate(timeout=20)[1].decode()
        self.assertNotEqual(program.returncode, 0)
        self.assertIn("tvi.Interrupted: interrupted at t =", errors)
        self.assertNotIn("From cffi callback", errors)


if __name__ == "__main__":
    unittest.main()
