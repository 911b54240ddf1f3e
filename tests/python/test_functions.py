"""Arguments of a user's function are told apart by their names: for every kind of function, what is neither a vector in
its place nor the time nor a parameter with a value is refused, and the text names it."""

import functools
import unittest

import numpy as np

import tvi

SPRING = tvi.potential(2, lambda q, w: w * (q @ q) / 2, w=1.0)


def event(g, **none):
    tvi.Integrator(SPRING, [1, 2], p=0).run(h=0.1, steps=1, events=g)


# How functions of each kind are recorded with parameters of their own, and the vectors that they are called with.
KINDS = {
    "potential": (functools.partial(tvi.potential, 2), "q"),
    "force": (functools.partial(tvi.force, 2), "q"),
    "lagrangian": (functools.partial(tvi.lagrangian, 2), "q v"),
    "hamiltonian": (functools.partial(tvi.hamiltonian, 2), "q p"),
    "driven": (SPRING.driven, "q v"),
    "constrained": (functools.partial(tvi.constrained, SPRING), "q"),
    "rescaled": (SPRING.rescaled, "q p"),
    "event 0": (event, "q p"),
}
VECTOR_VALUED = {"force": "[-q_[0], -q_[1]]", "driven": "[-q_[0], -q_[1]]", "constrained": "[q_[0]]"}
ROLES = {"q": "q position", "v": "v qd qdot velocity", "p": "p momentum", "t": "t time"}


class Functions(unittest.TestCase):
    def function(self, kind, arguments):
        """A function with these arguments, which keeps what it gets."""
        names = [a.strip(" *").split("=")[0] for a in arguments.split(",")]
        names = [name for name in names if name not in ("/", "")]
        self.got = {}
        value = VECTOR_VALUED.get(kind, "2 + q_ @ q_ + (s_ @ s_ if s_ is not None else 0)")
        code = f"lambda {arguments}: (got.update({', '.join(f'{n}={n}' for n in names)}), value(got))[1]"
        scope = {"got": self.got}
        scope["value"] = lambda got: eval(value, {"q_": vectors_in(got)[0], "s_": vectors_in(got)[1]})
        return eval(code, scope)

    def refused(self, kind, arguments, *texts, **parameters):
        make, _ = KINDS[kind]
        with self.subTest(kind=kind, arguments=arguments), self.assertRaises(TypeError) as raised:
            make(self.function(kind, arguments), **parameters)
        for text in texts:
            self.assertIn(text, str(raised.exception))

    def taken(self, kind, arguments, **parameters):
        with self.subTest(kind=kind, arguments=arguments):
            KINDS[kind][0](self.function(kind, arguments), **parameters)
        return self.got

    def test_without_value(self):
        """A further argument has a value, or is t or time."""
        for kind, (_, vectors) in KINDS.items():
            before = vectors.replace(" ", ", ")
            for name in ("k", "a", "x", "mu", "dt", "T", "params"):
                self.refused(kind, f"{before}, {name}", f"{name} has no value: give {name}=...", "call it t")
                self.refused(kind, f"{before}, t, {name}", f"{name} has no value: give {name}=...")
                self.refused(kind, f"{before}, *, {name}", f"{name} has no value: give {name}=...")
            for name in ("mass", "h", "g"):  # arguments of tvi's own functions
                self.refused(kind, f"{before}, {name}", f"{name} has no value: a parameter cannot be called {name}")
            for role in set("vp") - set(vectors):
                for name in ROLES[role].split():
                    self.refused(kind, f"{before}, {name}", {"v": "system.driven", "p": "tvi.hamiltonian"}[role])

    def test_misplaced(self):
        """q, v, p and t in the place of another one."""
        for kind, (_, vectors) in KINDS.items():
            places = vectors.split()
            for i, vector in enumerate(places):
                for role in set(ROLES) - {vector}:
                    for name in ROLES[role].split():
                        arguments = [*"xy"[:i], name, *"ab"[:len(places) - i - 1]]
                        text = (f"{name} stands in the place of {vector}" if role != "t" else f"{name} comes last"
                                if i < len(places) - 1 else f"{vector} is missing before {name}")
                        self.refused(kind, ", ".join(arguments), text, f"{kind} is called with ({', '.join(places)})")
            if len(places) == 2:
                self.refused(kind, ", ".join(reversed(places)), f"{places[1]} stands in the place of {places[0]}")

    def test_number(self):
        for kind, (_, vectors) in KINDS.items():
            count = len(vectors.split())
            self.refused(kind, "", f"{kind} is called with ({vectors.replace(' ', ', ')})", "takes ()")
            if count == 2:
                self.refused(kind, "x", "takes (x)")
                self.refused(kind, "x, k=2.0", "k stands in the place of " + vectors[-1])

    def test_taken(self):
        """Names that say nothing stand for any vector, the time stands anywhere after the vectors, and what has a value
        of its own keeps it."""
        for kind, (_, vectors) in KINDS.items():
            names = vectors.split()
            for before in (names, ["x", "y"][:len(names)], [f"{name}=None" for name in names]):
                for after in ("t", "time", "*, t", "t, /") if "=" not in before[0] else ("t=0", "time=1", "*, t"):
                    got = self.taken(kind, ", ".join(before + [after]))
                    self.assertIsInstance(got.get("t", got.get("time")), tvi.Jet, after)
                    self.assertTrue(all(np.shape(got[name.split("=")[0]]) == (2,) for name in before))
                self.assertEqual(self.taken(kind, ", ".join(before + ["k=2.5"]))["k"], 2.5)
            got = self.taken(kind, "*vectors")
            self.assertEqual(len(got["vectors"]), len(names), "the time is not among them")

    def test_parameters(self):
        for kind, (_, vectors) in KINDS.items():
            if kind in ("rescaled", "event 0"):
                name, values = "w", {}
            else:
                name, values = "k", {"k": 3.0}
            for after in (f"{name}, t", f"t, {name}", f"*, {name}, t", f"{name}"):
                got = self.taken(kind, f"{vectors.replace(' ', ', ')}, {after}", **values)
                self.assertTrue(all(isinstance(got[x], tvi.Jet) for x in after.strip("*, ").split(", ")))
            self.assertIsInstance(self.taken(kind, f"{vectors.replace(' ', ', ')}, **more", **values)["more"][name],
                                  tvi.Jet)
            self.refused(kind, f"{name}, {vectors.replace(' ', ', ')}", f"{name} stands in the place of q", **values)

    def test_values(self):
        """The time and the parameters are those that are meant."""
        for V in (lambda q, k, t: q[0] * k + 10 * t, lambda q, time, k: q[0] * k + 10 * time,
                  lambda q, *, t, k: q[0] * k + 10 * t):
            self.assertEqual(tvi.potential(1, V, k=3.0).energy(7, [2], [0]), 76)
        self.assertEqual(tvi.potential(1, lambda q, time: q[0] * time, time=3.0).energy(7, [2], [0]), 6)

    def test_without_keyword(self):
        """The time without a keyword stands behind the vectors, and nowhere else."""
        for kind, (_, vectors) in KINDS.items():
            arguments = f"{vectors.replace(' ', ', ')}, k=2.0, t=0.0, /"
            self.refused(kind, arguments, "t, which has no keyword, stands after")

    def test_not_functions(self):
        for kind, (make, vectors) in KINDS.items():
            for given in (3, "x", None, [1.0]):
                if given is None and kind == "rescaled":
                    continue
                with self.subTest(kind=kind, given=given), self.assertRaisesRegex(TypeError, "function of \\(q"):
                    make(given)


def vectors_in(got):
    several = [x for value in got.values() for x in (value if isinstance(value, tuple) else [value])]
    vectors = [x for x in several if isinstance(x, np.ndarray)]
    return vectors[0], vectors[1] if len(vectors) > 1 else None


if __name__ == "__main__":
    unittest.main()
