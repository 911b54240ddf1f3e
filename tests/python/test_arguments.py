"""Every function that makes a run refuses every argument that is wrong before anything is done, and the text names the
argument as that function calls it."""

import copy
import math
import pickle
import unittest
from unittest import mock

import numpy as np

import tvi
from problems import kepler, python, spring
from tvi import _solve

NAN, INF = math.nan, math.inf


def system_of_two():
    """Two coordinates, two parameters."""
    return tvi.potential(2, power, a=1.0, b=2.0)


def power(q, a, b):
    return a * (q @ q)**(b / 2)


def run_of(function):
    return lambda s, q, p=None, v=None, **more: function(s, (0, 1), q, p0=p, v0=v, **{"h": 0.1, **more})


# What begins with a start: called with (system, q, p=, v=, and others); and its names of these.
STARTS = {"solve": (run_of(tvi.solve), "q0 p0 v0"), "ensemble": (run_of(tvi.ensemble), "q0 p0 v0"),
          "megno": (run_of(tvi.megno), "q0 p0 v0"), "lyapunov": (run_of(tvi.lyapunov), "q0 p0 v0"),
          "Integrator": (tvi.Integrator, "q p v"), "Ensemble": (tvi.Ensemble, "q p v")}
OF_MANY = ("ensemble", "megno", "lyapunov", "Ensemble")


def runs(**end):
    """What takes a step size h on its way to t = 1, or as many steps."""
    it, orbits = tvi.Integrator(kepler(), [1, 0], [0, 1]), tvi.Ensemble(kepler(), [[1, 0]] * 2, [0, 1])
    return {
        "solve": lambda h: tvi.solve(kepler(), (0, 1), [1, 0], [0, 1], h=h),
        "ensemble": lambda h: tvi.ensemble(kepler(), (0, 1), [1, 0], [0, 1], h=h),
        "megno": lambda h: tvi.megno(kepler(), (0, 1), [1, 0], [0, 1], h=h),
        "lyapunov": lambda h: tvi.lyapunov(kepler(), (0, 1), [1, 0], [0, 1], h=h),
        "integrate_to": lambda h: it.integrate_to(h, 1), "integrate_at": lambda h: it.integrate_at(h, [0.5, 1]),
        "run": lambda h: it.run(h=h, t_end=1), "Ensemble.run": lambda h: orbits.run(h=h, t_end=1),
        "Ensemble.integrate_to": lambda h: orbits.integrate_to(h, 1),
        "step": lambda h: it.step(h), "integrate": lambda h: it.integrate(h, 3),
        "Ensemble.integrate": lambda h: orbits.integrate(h, 3),
    }


class Arguments(unittest.TestCase):
    def refused(self, kind, texts, call, *arguments, **named):
        with self.assertRaises(kind) as raised:
            call(*arguments, **named)
        for text in texts if isinstance(texts, tuple) else (texts,):
            self.assertIn(text, str(raised.exception))
        return str(raised.exception)

    # ---- The start ---------------------------------------------------------------------------------------------------

    def test_rest(self):
        """p or v is needed, one of them; 0 stands for rest."""
        system = tvi.potential(2, lambda q: q @ q, mass=[1, 3])
        for name, (call, names) in STARTS.items():
            q, p, v = names.split()
            with self.subTest(name):
                self.refused(TypeError, (f"{p} is missing: {p}=0 for rest", f"{v}=..."), call, system, [1, 0])
                self.refused(TypeError, f"momenta {p} or velocities {v}", call, system, [1, 0], p=[0, 1], v=[0, 1])
                for zero in (0, 0.0, np.float64(0), np.int64(0)):
                    call(system, [1, 0], p=zero), call(system, [1, 0], v=zero)
                self.refused(ValueError, f"{p} has the shape (1,), not", call, system, [1, 0], p=[0])
        self.assertEqual(tvi.Integrator(system, [1, 0], p=0).p.tolist(), [0, 0])
        self.assertEqual(tvi.Ensemble(system, [[1, 0]] * 3, v=0).p.tolist(), [[0, 0]] * 3)
        self.refused(ValueError, "p has the shape ()", tvi.Integrator, system, [1, 0], 0.5)
        turning = tvi.lagrangian(2, lambda q, v: v @ v / 2 + q[0] * v[1])
        self.assertEqual(tvi.Integrator(turning, [1, 0], v=0).p.tolist(), [0, 1])

    def test_vectors(self):
        """Each of q, p and v with each wrong value, by its name and its index."""
        right = {"q": [1, 0], "p": [0, 1]}
        for name, (call, names) in STARTS.items():
            for place, called in zip("qpv", names.split()):
                for value, kind, text in (([1, 2, 3], ValueError, "has the shape (3,), not ("),
                                          ([1, NAN], ValueError, "[1] = nan is not finite"),
                                          ([INF, 0], ValueError, "[0] = inf is not finite"),
                                          ("12", TypeError, " has real numbers"),
                                          ([1, 2j], TypeError, " has real numbers"),
                                          ([[1, 2], [3]], ValueError, " has rows of different lengths"),
                                          ({1, 2}, TypeError, " has real numbers, not set")):
                    given = {**right, place: value}
                    given.pop("p" if place == "v" else "", None)
                    with self.subTest(name, place=place, value=str(value)):
                        self.assertTrue(self.refused(kind, text, call, kepler(), **given).startswith(called))
        for name in OF_MANY:
            call, names = STARTS[name]
            self.refused(ValueError, f"{names.split()[0]}[1, 0] = nan is not finite", call, kepler(),
                         [[1, 0], [NAN, 0]], p=0)
            self.refused(ValueError, f"{names.split()[1]} has the shape (2, 2), not (3, 2)", call, kepler(),
                         [[1, 0]] * 3, p=[[0, 1]] * 2)
        for name in ("solve", "Integrator"):
            call, names = STARTS[name]
            self.refused(ValueError, (f"{names.split()[0]} has the shape (3, 2), not (2,)", "tvi.ensemble"), call,
                         kepler(), [[1, 0]] * 3, p=[0, 1])

    def test_order(self):
        """The system comes first, then t_span."""
        for call in (tvi.solve, tvi.ensemble, tvi.megno, tvi.lyapunov):
            more = {} if call in (tvi.solve, tvi.ensemble) else {"h": 0.1}
            self.refused(TypeError, ("system is what tvi.potential", "not tuple"), call, (0, 1), kepler(), [1, 0],
                         **more)
            self.refused(TypeError, "not function", call, lambda t, y: y, (0, 1), [1, 0], **more)
            for t_span in ([1, 0, 0], 5, [[0, 1]]):
                self.refused(ValueError, ("t_span has the shape", "(t, t_end)"), call, kepler(), t_span, [1, 0],
                             **more)
            self.refused(TypeError, "t_span has real numbers, not Event", call, kepler(), tvi.event(lambda q, p: q[0]),
                         [1, 0], **more)
            self.refused(ValueError, "t_span[1] = inf is not finite", call, kepler(), (0, INF), [1, 0], 0, **more)
        for call in (tvi.Integrator, tvi.Ensemble):
            self.refused(TypeError, "system is what tvi.potential", call, [1, 0], kepler())

    # ---- Steps, errors, tolerances -----------------------------------------------------------------------------------

    def test_h(self):
        """A step with which a run does not end is refused before a compiler is started."""
        with mock.patch.object(_solve, "compile", side_effect=AssertionError("compiled")):
            for name, call in runs().items():
                for h, text in ((0, "h is 0"), (-0.0, "h is 0"), (NAN, "h = nan"), (INF, "h = inf"), (-INF, "h = -inf"),
                                (5e-324, "h = 5e-324 is below 2.2e-308"), (-1e-310, "h = -1e-310 is below"),
                                ([0.1, 0.2], "h is one number")):
                    with self.subTest(name, h=h):
                        self.refused(ValueError, text, call, h)
                with self.subTest(name, h="1"):
                    self.refused(TypeError, "h has real numbers", call, "1")
                if name not in ("step", "integrate", "Ensemble.integrate"):
                    with self.subTest(name, h=1e-300):
                        self.refused(ValueError, ("h = 1e-300 is too small", "2^63"), call, 1e-300)

    def test_fractions(self):
        """Errors and tolerances below roundoff, and from 1 on."""
        it = tvi.Integrator(kepler(), [1, 0], [0, 1], method="taylor")
        orbits = tvi.Ensemble(kepler(), [[1, 0]] * 2, [0, 1], method="taylor")
        calls = {
            "error": [lambda x: tvi.solve(kepler(), (0, 1), [1, 0], [0, 1], error=x),
                      lambda x: tvi.ensemble(kepler(), (0, 1), [1, 0], [0, 1], error=x),
                      lambda x: tvi.solve(kepler(), (0, 0), [1, 0], [0, 1], error=x),
                      lambda x: tvi.suggest_step(kepler(), 0, [1, 0], [0, 1], 1, x)],
            "tolerance": [lambda x: tvi.solve(kepler(), (0, 1), [1, 0], [0, 1], tolerance=x),
                          lambda x: tvi.solve(kepler(), (0, 1), [1, 0], [0, 1], tolerance=x, method="taylor"),
                          lambda x: tvi.ensemble(kepler(), (0, 1), [1, 0], [0, 1], tolerance=x),
                          lambda x: it.integrate_tolerance(x, 1), lambda x: it.run(tolerance=x, t_end=1),
                          lambda x: orbits.run(tolerance=x, t_end=1), tvi.taylor_order]}
        for name, several in calls.items():
            for number, call in enumerate(several):
                for x in (0, -1e-9, 1e-20, 2.2e-16, 1, 2.5):
                    with self.subTest(name, number=number, x=x):
                        text = self.refused(ValueError, f"{name} = {float(x)} is not from 2.2e-16 to below 1", call, x)
                        self.assertNotIn("DBL_EPSILON", text)
                self.refused(ValueError, f"{name} = nan is not finite", call, NAN)

    def test_methods(self):
        """A method and an order that contradict each other, and a tolerance that the method has not."""
        for call in (tvi.solve, tvi.ensemble):
            for method, order in (("galerkin", 12), ("midpoint", 16), (tvi.Method("galerkin", 8), 16)):
                self.refused(ValueError, ("tolerance", "give h or error"), call, kepler(), (0, 1), [1, 0], [0, 1],
                             tolerance=1e-9, method=method, order=order)
            self.refused(ValueError, ("tolerance", "rescaled"), call, kepler().rescaled(), (0, 1), [1, 0], [0, 1],
                         tolerance=1e-9)
            call(kepler(), (0, 1), [1, 0], [0, 1], tolerance=1e-9, method="taylor", order=10)
        for call, _ in STARTS.values():
            self.refused(TypeError, "order = 8 beside Method('galerkin', 4)", call, kepler(), [1, 0], p=0,
                         method=tvi.Method("galerkin", 4), order=8)
            call(kepler(), [1, 0], p=[0, 1], method=tvi.Method("galerkin", 4), order=4)

    # ---- Arguments that are called otherwise elsewhere ---------------------------------------------------------------

    def test_other_names(self):
        """The text says what serves instead, whatever else is missing."""
        it, orbits = tvi.Integrator(kepler(), [1, 0], [0, 1]), tvi.Ensemble(kepler(), [[1, 0]] * 2, [0, 1])
        calls = [tvi.solve, tvi.ensemble, tvi.megno, tvi.lyapunov, tvi.Integrator, tvi.Ensemble, it.run, it.integrate,
                 it.integrate_to, it.integrate_at, it.integrate_tolerance, orbits.run, orbits.integrate_to]
        for name, text in (("rtol", "error="), ("atol", "tolerance="), ("y0", "q0= and p0="), ("fun", "tvi.potential"),
                           ("max_step", "largest_step="), ("first_step", "h="), ("dt", "h="), ("args", "k=2.0"),
                           ("jac", "recorded"), ("saveat", "t_eval="), ("callback", "events=")):
            for number, call in enumerate(calls):
                with self.subTest(name, number=number):
                    given = (0.1, 1) if number in (7, 8, 9, 10, 12) else ()
                    self.refused(TypeError, (f"has no argument {name}: ", text), call, *given, **{name: 1})
        for call, name in ((tvi.solve, "q"), (tvi.solve, "members"), (tvi.Integrator, "q0"), (tvi.megno, "tolerance"),
                           (tvi.ensemble, "dense_output"), (it.run, "progress")):
            self.refused(TypeError, f"has no argument {name}: it has ", call, **{name: 1})

    def test_parameters_of_such_names(self):
        """Parameters of the system may be called like arguments of other libraries."""
        system = tvi.potential(1, lambda q, tol, dt: tol * dt * q[0]**2, tol=1.0, dt=0.5)
        run = tvi.solve(system, (0, 1), [1], p0=0, h=0.1, tol=2.0, dt=0.25)
        self.assertEqual((run.parameters["tol"], run.parameters["dt"]), (2.0, 0.25))
        self.assertEqual(tvi.Integrator(system, [1], 0, tol=3.0).parameters["tol"], 3)
        self.refused(TypeError, "the system has no parameter c: its parameters are tol, dt", tvi.solve, system, (0, 1),
                     [1], 0, c=1)

    # ---- Events, tangents --------------------------------------------------------------------------------------------

    def test_events(self):
        it, orbits = tvi.Integrator(spring(), [1], 0), tvi.Ensemble(spring(), [[1]] * 2, 0)
        calls = [lambda events: tvi.solve(spring(), (0, 1), [1], 0, h=0.1, events=events),
                 lambda events: tvi.ensemble(spring(), (0, 1), [1], 0, h=0.1, events=events),
                 lambda events: it.run(h=0.1, steps=1, events=events),
                 lambda events: orbits.run(h=0.1, steps=1, events=events)]

        def g(q, p):
            return q[0]

        for call in calls:
            for events in (3, None, 1.5):
                self.refused(TypeError, "events is a function of (q, p) or (q, p, t), or a list of them, not "
                             + type(events).__name__, call, events)
            for events, number in (([3], 0), ([g, 3], 1), ("x", 0)):
                self.refused(TypeError, f"event {number} is a function of (q, p) or (q, p, t), not", call, events)
            for attribute, value in (("direction", 2), ("direction", "up"), ("terminal", 3), ("terminal", "yes")):
                g.direction, g.terminal = 0, False
                setattr(g, attribute, value)
                self.refused(ValueError, f"{attribute} is ", call, g)
            g.direction, g.terminal = 0, False
            call([g, tvi.event(g)])
        self.refused(TypeError, "an event is a function of (q, p) or (q, p, t), not int", tvi.event, 3)

    def test_tangents(self):
        """The text says of what the rows are."""
        it, orbits = tvi.Integrator(system_of_two(), [1, 0], 0), tvi.Ensemble(system_of_two(), [[1, 0]] * 3, 0)
        for thing in (it, orbits):
            for rows in (4, 5, 8):
                text = self.refused(ValueError, "2n + parameters = 6 rows", setattr, thing, "tangent",
                                    np.ones((rows, 2)))
                self.assertTrue(text.startswith("tangent has the shape"))
            thing.tangent = np.eye(6)
        it, orbits = tvi.Integrator(kepler(), [1, 0], 0), tvi.Ensemble(kepler(), [[1, 0]] * 3, 0)
        for thing in (it, orbits):
            self.refused(ValueError, "2n = 4 rows", setattr, thing, "tangent", np.eye(3))

    # ---- Messages, copies, the environment ---------------------------------------------------------------------------

    def test_steps_that_are_too_large(self):
        """What refuses a step because it is too large says what to do."""
        steep = tvi.potential(1, lambda q: np.cosh(30 * q[0]))
        fixed = steep.driven(lambda q, v: [-v[0]])
        for system, what in ((steep, "give a smaller h or error, or system.rescaled()"),
                             (fixed, "give a smaller h or error"), (steep.rescaled(), "give a smaller h or error")):
            h = 3.0 if system.is_rescaled else 0.7
            run = tvi.solve(system, (0, 100), [1], 0, h=h)
            self.assertEqual(run.status, -1)
            self.assertTrue(run.message.endswith(f": {what}."), run.message)
            it = tvi.Integrator(system, [1], 0)
            self.assertTrue(self.refused(tvi.Error, "", it.step, h).endswith(": " + what))
            self.assertTrue(self.refused(tvi.Error, "", it.integrate_to, h, 100).endswith(": " + what))
            many = tvi.ensemble(system, (0, 100), [[1], [1e-9]], 0, h=h)
            self.assertRegex(many.message, r"^2 members, [12] failed: ")
            self.assertTrue(many.message.endswith(f": {what}."), many.message)
        fall = tvi.solve(tvi.potential(1, lambda q: -1 / q[0]), (0, 2), [1], 0, tolerance=1e-10)
        self.assertTrue(fall.message.endswith(": end the run before that by a terminal event."), fall.message)

    def test_error_that_was_measured(self):
        """A run that is refused says it as one that reaches its end does."""
        steep = tvi.potential(1, lambda q: np.cosh(30 * q[0]))
        for h, status in ((0.01, 0), (0.7, -1)):
            with mock.patch.object(_solve, "measured_step", return_value=(h, 0.012, None)):
                run = tvi.solve(steep, (0, 10), [0.01], 0, error=1e-6)
            self.assertEqual(run.status, status)
            self.assertTrue(run.message.endswith(" The error at the end was measured: 1.2e-02."), run.message)

    def test_not_finite_where_it_begins(self):
        bad = tvi.force(1, lambda q, t: [np.log(np.cosh(1000 * (1 - t)))])
        for way in ({"h": 0.1}, {"tolerance": 1e-9}):
            self.assertIn("a value is not finite", tvi.solve(bad, (0, 2), [0], 0, **way).message)

    def test_driven_and_rescaled(self):
        driven = spring().driven(lambda q, v: -v)
        self.refused(tvi.Error, "take fixed steps, or a tolerance", driven.rescaled)
        self.assertTrue(tvi.solve(driven, (0, 1), [1], 0, tolerance=1e-9).success)

    def test_copies(self):
        """Integrators and ensembles of compiled systems, by methods with options, pickle and are copied."""
        system, method = system_of_two(), tvi.Method("galerkin", 8, max_tail=0.5)
        for compiled in (True, tvi.compile(system, method)):
            for kind in (tvi.Integrator, tvi.Ensemble):
                orbit = kind(system, [1, 0], [0, 1], method=method, compiled=compiled, a=2.0)
                orbit.integrate(0.1, 5)
                for again in (copy.deepcopy(orbit), pickle.loads(pickle.dumps(orbit))):
                    self.assertTrue(again.stats.is_compiled)
                    self.assertEqual(again.method.options, {"max_tail": 0.5})
                    again.integrate(0.1, 5)
                orbit.integrate(0.1, 5)
                self.assertEqual(again.q.tobytes(), orbit.q.tobytes())

    def test_blank_compiler(self):
        """CC of blanks names no compiler, as a CC that is not set."""
        code = ("import tvi; s = tvi.potential(1, lambda q: q[0]**2 / 2)\n"
                "print(tvi.compile(s)); print(tvi.solve(s, (0, 1e8), [1], 0, h=0.5, "
                "events=tvi.event(lambda q, p: q[0], terminal=True)).status)")
        for blank in ("", " ", " \t "):
            self.assertEqual(python(code, CC=blank), "<tvi compiled system>\n1\n")

    def test_printed(self):
        """What is printed says what it is, and no address."""
        system = spring()
        run = tvi.solve(system, (0, 1), [1], 0, h=0.1, dense_output=True)
        many = tvi.ensemble(system, (0, 1), [[1]] * 2, 0, h=0.1)
        for thing in (system, run, run.sol, run.integrator, many, many.orbits, run.method, tvi.compile(system),
                      run.stats, tvi.event(len)):
            self.assertNotIn("object at 0x", repr(thing))
        self.assertEqual(repr(run.sol), "<tvi solution: sol(t) is q and p at t from 0.0 to 1.0>")


if __name__ == "__main__":
    unittest.main()
