"""Arguments that are wrong in kind, number, shape or range are refused with a text that names them, and nothing is read
or written outside of an array: in each case the objects go on working."""

import fractions
import gc
import math
import pickle
import unittest

import numpy as np

import tvi
from problems import kepler, spring

NAN, INF = math.nan, math.inf

# What is refused as two numbers, and how.
VECTORS = [
    ([1], ValueError, r"shape \(1,\), not \(2,\)"),
    ([1, 2, 3], ValueError, r"shape \(3,\), not \(2,\)"),
    ([[1, 2]], ValueError, "shape"),
    (1.0, ValueError, r"shape \(\), not \(2,\)"),
    ([], ValueError, "shape"),
    ([1, NAN], ValueError, "not finite"),
    ([INF, 1], ValueError, "not finite"),
    (["1", "2"], TypeError, "real numbers"),
    ("12", TypeError, "real numbers"),
    (b"12", TypeError, "real numbers"),
    (None, TypeError, "real numbers"),
    ([None, 1], TypeError, "real numbers"),
    ([1, 2j], TypeError, "real numbers"),
    (np.array([1, 2], dtype=object) * 1j, TypeError, "real numbers"),
    ([1, 10**400], TypeError, "real numbers"),
    ({1, 2}, TypeError, "real numbers"),
    (np.array(["2020", "2021"], dtype="datetime64"), TypeError, "real numbers"),
]

# What is taken for the numbers 1 and 2.
TAKEN = [[1, 2], (1, 2), np.array([1, 2]), np.array([1, 2], dtype=np.float32), np.array([1, 2], dtype=">f8"),
         np.array([1, 2], dtype=np.int8), np.array([2.0, 1.0])[::-1], np.array([[1, 5], [2, 5]])[:, 0],
         [fractions.Fraction(1), 2], np.ma.array([1, 2]), np.longdouble([1, 2]), memoryview(np.array([1.0, 2.0]))]

SCALARS = [(NAN, ValueError, "finite"), (INF, ValueError, "finite"), ("1", TypeError, "real"), (None, TypeError, ""),
           (1j, TypeError, "real"), ([1, 2], ValueError, "one number")]
WHOLE = [(1.5, TypeError, "whole number"), ("1", TypeError, "whole number"), (2**70, ValueError, "not from"),
         (-1, ValueError, "not from"), (NAN, TypeError, "whole number")]


class Refusals(unittest.TestCase):
    def refused(self, kind, text, call, *arguments, **named):
        with self.assertRaisesRegex(kind, text):
            call(*arguments, **named)

    def test_vectors(self):
        system = kepler()
        it, orbits = tvi.Integrator(system, [1, 0], [0, 1]), tvi.Ensemble(system, [[1, 0]] * 3, [0, 1])
        calls = [lambda x: tvi.Integrator(system, x, [0, 1]), lambda x: setattr(it, "q", x),
                 lambda x: setattr(it, "p", x), lambda x: system.energy(0, [1, 0], x),
                 lambda x: tvi.solve(system, (0, 1), x, [0, 1], h=0.1),
                 lambda x: tvi.suggest_step(system, 0, x, [0, 1], 10, 1e-6)]
        for x, kind, text in VECTORS:
            for number, call in enumerate(calls):
                if x is None and number == 4:
                    continue
                with self.subTest(x=str(x)[:30], call=number):
                    self.refused(kind, "" if kind is ValueError else text, call, x)
        for x in TAKEN:
            with self.subTest(taken=repr(x)[:40]):
                it.q = x
                self.assertEqual(it.q.tolist(), [1, 2])
        for x in ([[1, 0]] * 2, [[1, 0, 0]] * 3, [1, 0, 0], [[1], [0], [1]], [[NAN, 0]] * 3):
            self.refused(ValueError, "q", setattr, orbits, "q", x)
            self.refused(ValueError, "p", setattr, orbits, "p", x)
        self.assertTrue(it.integrate(0.1, 3) and orbits.integrate(0.1, 3))

    def test_numbers(self):
        system, it = kepler(), tvi.Integrator(kepler(), [1, 0], [0, 1])
        for x, kind, text in SCALARS:
            with self.subTest(x=str(x)):
                self.refused(kind, text, it.step, x)
                self.refused(kind, text, setattr, it, "t", x)
                self.refused(kind, text, it.dense, x)
                self.refused((TypeError, ValueError), "", system.energy, x, [1, 0], [0, 1])
                self.refused((TypeError, ValueError), "", it.integrate, x, 5)
                self.refused((TypeError, ValueError), "", it.integrate_to, 0.1, x)
                self.refused((TypeError, ValueError), "", it.integrate_tolerance, x, 5)
                self.refused((TypeError, ValueError), "", tvi.taylor_order, x)
                self.refused((TypeError, ValueError), "", tvi.solve, system, (0, x), [1, 0], [0, 1], h=0.1)
        for x, kind, text in WHOLE:
            with self.subTest(x=str(x)):
                self.refused(kind, text, it.integrate, 0.1, x)
                self.refused(kind, text, tvi.potential, x, lambda q: q[0])
                self.refused((TypeError, ValueError, tvi.Error), "", tvi.Method, "galerkin", x)
                self.refused(kind, text, tvi.Ensemble, system, [1, 0], p=0, threads=x)
                self.refused(kind, text, tvi.megno, spring(), (0, 1), [1], p0=0, h=0.1, every=x)
        self.refused(ValueError, "n = 0 is not from 1 to 10000", tvi.potential, 0, lambda q: 0)
        self.refused(ValueError, "n = 10001", tvi.potential, 10001, lambda q: 0)
        self.refused(ValueError, "h is 0", it.integrate, 0, 5)
        self.refused(ValueError, "h is 0", it.step, 0.0)
        self.assertTrue(it.integrate(0.1, 0))
        self.assertEqual(it.t, 0)

    def test_masses(self):
        for mass, kind in (([1, 2, 3], ValueError), ([1], ValueError), ([1, -2], tvi.Error), ([1, NAN], ValueError),
                           ([1, 0], tvi.Error), (["a", "b"], TypeError), (2, None), ([[1, 2]], ValueError)):
            with self.subTest(mass=str(mass)):
                if kind is None:
                    tvi.potential(2, lambda q: q @ q, mass=mass)
                else:
                    self.refused(kind, "mass", tvi.potential, 2, lambda q: q @ q, mass=mass)

    def test_parameters(self):
        system = tvi.potential(2, lambda q, k, a: k * (q @ q) + a @ q, k=1, a=[1, 2])
        self.assertEqual(system.energy(0, [1, 1], [0, 0]), 5)
        it = tvi.Integrator(system, [1, 1], p=0, k=2, a=[0, 0])
        self.assertEqual(it.energy(), 4)
        it.set_parameters(a=[1, 0])
        self.assertEqual((it.energy(), it.parameters["k"]), (5, 2))
        self.refused(TypeError, "no parameter b", it.set_parameters, b=1)
        self.refused(ValueError, "a has the shape", it.set_parameters, a=[1, 2, 3])
        self.refused(ValueError, "finite", it.set_parameters, k=NAN)
        self.refused(TypeError, "real", it.set_parameters, k="1")
        self.refused(TypeError, "no parameter b", tvi.Integrator, system, [1, 1], p=0, b=1)
        self.refused(TypeError, "takes no parameter k", tvi.potential, 1, lambda q: q[0], k=1)
        self.refused(ValueError, "cannot be called h", tvi.potential, 1, lambda q, h: q[0], h=1)
        self.refused(ValueError, "at most 1000", tvi.potential, 1, lambda q, k: q[0], k=np.zeros(1001))
        self.refused(ValueError, "finite", tvi.potential, 1, lambda q, k: q[0], k=INF)
        self.refused(ValueError, "a parameter k already", system.driven, lambda q, v, k: -k * v, k=1)
        self.refused(TypeError, "takes no parameter c", system.driven, lambda q, v: -v, c=1)
        self.assertEqual(it.energy(), 5)
        several = tvi.Ensemble(system, [[1, 1]] * 3, p=0, k=[1, 2, 3], a=[[0, 0], [1, 0], [0, 0]])
        self.assertEqual(several.energy().tolist(), [2, 5, 6])
        several.set_parameters(k=0)
        self.assertEqual(several.energy().tolist(), [0, 1, 0])
        self.refused(ValueError, "k has the shape", several.set_parameters, k=[1, 2])
        self.refused(ValueError, "a has the shape", several.set_parameters, a=[[1, 2]] * 2)
        driven = system.driven(lambda q, v, k, c: -k * c * v, c=0.5)
        self.assertEqual(list(driven.parameters), ["k", "a", "c"])
        self.assertEqual(driven.energy(0, [1, 1], [0, 0]), 5)

    def test_methods(self):
        system = kepler()
        self.refused(tvi.Error, "galerkn", tvi.Method, "galerkn", 4)
        self.refused(tvi.Error, "even orders from 2 to 20, not 7", tvi.Method, "galerkin", 7)
        self.refused(TypeError, "name of a method", tvi.Method, 5)
        self.refused(TypeError, "no option nodez", tvi.Method, "galerkin", 8, nodez=4)
        self.refused(ValueError, "quadrature is one of", tvi.Method, "galerkin", 8, quadrature="gaus")
        self.refused(tvi.Error, "", tvi.Method("galerkin", 8, degree=1000).check, system)
        self.refused(tvi.Error, "", tvi.Integrator, system, [1, 0], p=0, method=tvi.Method("galerkin", 8, degree=99))
        self.refused(tvi.Error, "constant diagonal mass", tvi.Integrator, tvi.lagrangian(1, lambda q, v: (1 + q[0]**2)
                     * v[0]**2 / 2), [1], p=0, method="stormer-verlet", order=2)
        self.refused(TypeError, "compiled is", tvi.Integrator, system, [1, 0], p=0, compiled="yes")
        self.refused(TypeError, "system is what", tvi.Integrator, "system", [1, 0], p=0)
        self.refused(TypeError, "system is what", tvi.Ensemble, None, [1, 0], p=0)
        self.refused(TypeError, "momenta p or velocities v", tvi.Integrator, system, [1, 0], [0, 1], v=[0, 1])
        self.refused(tvi.Error, "force", tvi.force(1, lambda q: -q).energy, 0, [1], [1])
        self.assertEqual(tvi.Error("text", "EDOMAIN").status, "EDOMAIN")
        again = pickle.loads(pickle.dumps(tvi.Error("text", "EDOMAIN")))
        self.assertEqual((again.status, str(again)), ("EDOMAIN", "text"))

    def test_ways(self):
        it = tvi.Integrator(kepler(), [1, 0], [0, 1])
        for plan, kind in (({}, TypeError), ({"h": 1}, TypeError), ({"h": 0.1, "steps": 1, "t_end": 1}, TypeError),
                           ({"h": 0.1, "tolerance": 1e-9, "t_end": 1}, TypeError),
                           ({"tolerance": 1e-9, "steps": 1}, TypeError), ({"h": 0.1, "t_end": -1}, tvi.Error),
                           ({"h": 0.1, "times": [[1]]}, ValueError), ({"h": 0.1, "times": [2, 1]}, tvi.Error),
                           ({"h": 0.1, "times": [-1]}, tvi.Error), ({"h": 0.1, "times": [1, NAN]}, ValueError),
                           ({"tolerance": 1e-9, "t_end": 1}, tvi.Error), ({"tolerance": 0, "t_end": 1}, ValueError),
                           ({"h": 0.1, "t_end": 1, "largest_step": 1}, TypeError),
                           ({"h": 0.1, "steps": 1, "events": [1]}, TypeError),
                           ({"h": 0.1, "steps": 1, "events": 1}, TypeError),
                           ({"h": 0.1, "steps": 1, "at_step": 1}, TypeError),
                           ({"h": 0.1, "steps": 1, "on_event": "x", "events": lambda q, p: q[0]}, TypeError)):
            with self.subTest(plan=str(plan)):
                self.refused(kind, "", it.run, **plan)
                self.assertEqual((it.t, it.q.tolist()), (0, [1, 0]))
        self.refused(ValueError, "direction", tvi.event, lambda q, p: q[0], 2)
        self.refused(TypeError, "function", tvi.event, 5)
        self.refused(ZeroDivisionError, "", it.run, h=0.1, steps=1, events=lambda q, p: 1 / 0)
        self.refused(TypeError, "event 0 returned", it.run, h=0.1, steps=1, events=lambda q, p: q)
        self.refused(TypeError, "one of them", tvi.solve, kepler(), (0, 1), [1, 0], p0=0, h=0.1, error=1e-3)
        for times in ([0, 2], [1, 0], [-1], [[0]], ["x"], [NAN]):
            self.refused((ValueError, TypeError), "", tvi.solve, kepler(), (0, 1), [1, 0], [0, 1], h=0.1, t_eval=times)
        self.refused((ValueError, TypeError), "", tvi.solve, kepler(), 5, [1, 0], p0=0, h=0.1)
        self.refused((ValueError, TypeError), "", tvi.solve, kepler(), (0, 1, 2), [1, 0], p0=0, h=0.1)
        self.refused(ValueError, "error = 1e-30", tvi.solve, kepler(), (0, 10), [1, 0], [0, 1], error=1e-30)
        self.refused(TypeError, "observer goes", tvi.Ensemble(kepler(), [1, 0], [0, 1]).run, h=0.1, t_end=1,
                     observer=lambda step: None)

    def test_memory_cannot_be_moved(self):
        """The arrays that steps write to cannot be resized or replaced, and live as long as they are referred to."""
        it = tvi.Integrator(kepler(), [1, 0], [0, 1])
        orbits = tvi.Ensemble(kepler(), [[1, 0]] * 5, [0, 1])
        it.tangent = np.eye(4)
        for array in (it.q, it.p, it.tangent, orbits.q.base, orbits.t):
            self.refused(ValueError, "", array.resize, (100000,), refcheck=False)
        for name in ("q", "p", "tangent"):
            given = np.array(getattr(it, name))
            setattr(it, name, given)
            given.resize((100000,), refcheck=False)
        q, all_q, D = it.q, orbits.q, it.tangent
        del it, orbits
        gc.collect()
        q[:], all_q[:], D[:] = 5, 6, 7
        self.assertEqual((q.sum(), all_q.sum(), D.sum()), (10, 60, 112))

    def test_sizes_cannot_be_changed(self):
        """What arrays are measured by is not to be written."""
        system = tvi.potential(2, lambda q, k: k * (q @ q), k=1.0)
        it, orbits = tvi.Integrator(system, [1, 0], p=0), tvi.Ensemble(system, [[1, 0]] * 3, p=0)
        for thing, names in ((system, ("n", "parameters", "kind")), (it, ("system", "method", "v", "stats")),
                             (orbits, ("system", "members", "method", "status"))):
            for name in names:
                self.refused(AttributeError, "", setattr, thing, name, 1)
        with self.assertRaises(TypeError):
            system.parameters["k"] = [1, 2]

    def test_tangents(self):
        it = tvi.Integrator(kepler(), [1, 0], [0, 1])
        for D in (np.eye(3), np.eye(5), np.ones(4), np.ones((4, 0)), np.full((4, 1), NAN), "x", np.ones((4, 2, 2))):
            with self.assertRaises((ValueError, TypeError)):
                it.tangent = D
        it.tangent = np.asfortranarray(np.arange(8.0).reshape(4, 2))
        self.assertEqual(it.tangent[1].tolist(), [2, 3])
        orbits = tvi.Ensemble(kepler(), [[1, 0]] * 3, [0, 1])
        for D in (np.eye(3), np.ones(4), np.ones((2, 4, 1)), np.ones((3, 4, 0))):
            with self.assertRaises((ValueError, TypeError)):
                orbits.tangent = D
        orbits.tangent = np.eye(4)
        self.assertEqual(orbits.tangent.shape, (3, 4, 4))

    def test_states(self):
        it = tvi.Integrator(kepler(), [1, 0], [0, 1])
        it.integrate(0.1, 5)
        state = it.save()
        old = b"tvistate" + bytes(8)  # as version 0.2.0 wrote
        for bad in (b"", b"x", state[:-2], state + b"0", bytes(len(state)), state[:50] + b"?" + state[51:], old):
            self.refused(tvi.Error, "", it.load, bad)
            self.refused(tvi.Error, "", tvi.peek, bad)
        orbits = tvi.Ensemble(kepler(), [[1, 0]] * 3, [0, 1])
        for one in (it, orbits):
            self.refused(tvi.Error, "write them with tvi_state_to_text", one.load, old)
            remake, (*made_of, kept) = one.__reduce__()
            self.refused(tvi.Error, "write them with tvi_state_to_text", remake, *made_of, (old, *kept[1:]))
        orbits.integrate(0.1, 3)
        states = orbits.save()
        for bad in (state, states + state, states[:-5], states[:len(states) // 3], b" " + states, 2 * states[:200]):
            self.refused(tvi.Error, "", orbits.load, bad)
        self.assertEqual(orbits.save(), states)
        for bad in ("text", None, 5, np.zeros(len(state), dtype="V0"), np.frombuffer(state, dtype=np.uint8)[::2]):
            self.refused((TypeError, ValueError, BufferError, tvi.Error), "", it.load, bad)
            self.refused((TypeError, ValueError, BufferError, tvi.Error), "", tvi.peek, bad)
        self.refused(tvi.Error, "", tvi.Integrator(spring(), [1], p=0).load, state)
        alone = tvi.Ensemble(kepler(), [1, 0], p=0)
        alone.load(state)  # An ensemble of one member has its text.
        self.assertEqual((alone.t[0], alone.save()), (it.t, state))
        self.refused(tvi.Error, "", it.dense, 2)
        self.refused(tvi.Error, "no last step", tvi.Integrator(kepler(), [1, 0], p=0).dense, 0.5)
        it.step(0.1)
        self.assertEqual(tvi.peek(it.save())[0], it.t)
        it.reset()
        self.assertEqual(tvi.peek(it.save())[0], it.t)
        it.load(np.frombuffer(state + b"\n" * (-len(state) % 8), dtype=float))  # as many bytes in fewer elements
        self.assertEqual(it.t, 0.5)
        it.load(state.decode())

    def test_texts(self):
        it, orbits = tvi.Integrator(kepler(), [1, 0], [0, 1]), tvi.Ensemble(kepler(), [[1, 0]] * 3, p=0)
        text = it.to_text()
        for bad in ("", "x", text[:-20], text + "0", text.replace("0x1.", "0x2."), text + "\0", "\u00e4" + text):
            self.refused(tvi.Error, "text", it.from_text, bad)
            self.refused(tvi.Error, "text", orbits.member_from_text, 1, bad)
        for bad in (None, 5):
            self.refused(TypeError, "a string or bytes", it.from_text, bad)
            self.refused(TypeError, "a string or bytes", orbits.member_from_text, 1, bad)
        self.refused(tvi.Error, "another dimension", tvi.Integrator(spring(), [1], p=0).from_text, text)
        self.refused(ValueError, "member = 3", orbits.member_to_text, 3)
        self.refused(ValueError, "member = -1", orbits.member_from_text, -1, text)
        self.assertEqual((it.to_text(), orbits.q.tolist()), (text, [[1, 0]] * 3))
        it.q[0] = np.nan
        self.refused(tvi.Error, "not finite", it.to_text)


if __name__ == "__main__":
    unittest.main()
