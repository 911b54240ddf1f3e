"""What functions of jets compute is what numpy computes of numbers, and what cannot be recorded is refused."""

import math
import threading
import unittest

import numpy as np

import tvi

M = np.array([[1.0, 2.0, -1.0], [0.5, 0.0, 3.0], [2.0, 1.0, 1.0]])

# Functions of three coordinates x and of t, each to be computed of jets and of numbers.
COMPUTED = {
    "sums": lambda x, t: x[0] + 2 - x[1] + (3 - x[2]) + sum(x) + np.sum(x) + x.sum() + (-x[0]) + (+x[1]),
    "products": lambda x, t: 2 * x[0] * x[1] / x[2] + 1 / x[1] + x[0] / 3 + np.prod(x),
    "dots": lambda x, t: x @ x + np.dot(M, x) @ x + np.inner(x, x) + x.dot(M[0]) + M[1] @ x,
    "slices": lambda x, t: x[:2] @ x[1:] + (x[::-1] * [1, 2, 3]).sum() + np.roll(x, 1)[0],
    "cross, norm, mean": lambda x, t: np.cross(x, [1, 2, 3])[0] + np.linalg.norm(x) + np.mean(x) + np.outer(x, x)[0, 2],
    "powers": lambda x, t: x[0]**2 + x[1]**-1.5 + 2**x[2] + x[0]**x[1] + np.power(x[2], 3) + (x**2).sum(),
    "numpy numbers": lambda x, t: np.float64(2.5) * x[0] + x[1] * np.int64(3) + np.array(2.0) * x[2] - np.float32(0.5),
    "arrays of numbers": lambda x, t: (np.arange(3) * x + np.ones(3) / x - x / [2, 4, 8]).sum(),
    "time": lambda x, t: np.cos(2 * np.pi * t) * x[0] + t,
    "roots": lambda x, t: np.sqrt(x[0]) + np.square(x[1]) + np.sqrt(x).sum() + np.reciprocal(x[2]),
    "exp, log": lambda x, t: np.exp(x[0]) + np.log(x[1]) + np.exp2(x[0]) + np.expm1(x[1]) + np.log2(x[0])
    + np.log10(x[1]) + np.log1p(x[2]),
    "angles": lambda x, t: np.sin(x[0]) + np.cos(x[1]) + np.tan(x[2]) + np.sin(x) @ np.cos(x)
    + np.sin(np.radians(x[0])) + np.cos(np.deg2rad(x[1])) + np.degrees(x[2]) + np.rad2deg(x[0]),
    "inverse angles": lambda x, t: np.arcsin(x[0] / 9) + np.arccos(x[1] / 9) + np.arctan(x[2]),
    "hyperbolic": lambda x, t: np.sinh(x[0]) + np.cosh(x[1]) + np.tanh(x[2]),
    "inverse hyperbolic": lambda x, t: np.arcsinh(x[0]) + np.arccosh(x[1] + 1) + np.arctanh(x[2] / 9),
    "of two": lambda x, t: np.arctan2(x[0], x[1]) + np.arctan2(2.0, x[1]) + np.arctan2(x[0], 3) + np.hypot(x[0], x[1])
    + np.hypot(1, x[2]) + np.arctan2(x, x[0])[1] + np.hypot(x[1:], x[:2])[1] + np.hypot([1.0, 2.0], x[1])[1],
    "erf": lambda x, t: tvi.erf(x[0]) + tvi.erf(x[:2])[1] + tvi.erf(0.5),
    "in place": lambda x, t: _in_place(x),
    "number alone": lambda x, t: 2.5,
    "array of no dimension": lambda x, t: np.array(x.sum()),
}


def _in_place(x):
    y = x.copy()
    y *= 2
    y[0] += x[1]
    return y.sum()


BRANCH, VALUE, WHOLE = "a branch on the value of a jet", "a jet has no value", "rounding, // and %"
POWER, KEPT, MIXED = "abs\\(\\) of a jet", "was kept after its function", "jets of two functions are mixed"

# Functions of one coordinate that are refused: the exception, and a part of its text.
REFUSED = [
    (lambda q: q[0] if q[0] > 0 else -q[0], TypeError, BRANCH),
    (lambda q: max(q[0], 1), TypeError, BRANCH),
    (lambda q: np.maximum(q[0], 1.0), TypeError, BRANCH),
    (lambda q: np.where(q < 0, q, 1)[0], TypeError, BRANCH),
    (lambda q: q[0] if q[0] else 1, TypeError, BRANCH),
    (lambda q: q[0] if q[0] == 1 else 1, TypeError, BRANCH),
    (lambda q: q[0] if q[0] != 1 else 1, TypeError, BRANCH),
    (lambda q: q[0] if (q == 0) else 1, TypeError, BRANCH),
    (lambda q: q[0] if np.all(q != 0) else 1, TypeError, BRANCH),
    (lambda q: np.sinc(q[0]), TypeError, BRANCH),
    (lambda q: np.clip(q[0], 0, 1), TypeError, BRANCH),
    (lambda q: sorted([q[0], q[0] * 2])[0], TypeError, BRANCH),
    (lambda q: math.sin(q[0]), TypeError, VALUE),
    (lambda q: int(q[0]), TypeError, VALUE),
    (lambda q: [1.0, 2.0][q[0]], TypeError, "list indices"),
    (lambda q: q.astype(float)[0], TypeError, VALUE),
    (lambda q: q[0] // 2, TypeError, WHOLE),
    (lambda q: np.floor(q[0]), TypeError, WHOLE),
    (lambda q: q[0] % 2, TypeError, WHOLE),
    (lambda q: abs(q[0]), TypeError, POWER),
    (lambda q: np.abs(q)[0], TypeError, POWER),
    (lambda q: q[0] - "x", TypeError, "unsupported operand"),
    (lambda q: q[0] * 1j, TypeError, "unsupported operand"),
    (lambda q: q[0] + None, TypeError, "unsupported operand"),
    (lambda q: q[0] ** [1], TypeError, "unsupported operand|returned"),
    (lambda q: q[0] * math.nan, ValueError, "nan, which is not finite"),
    (lambda q: q[0] + math.inf, ValueError, "inf, which is not finite"),
    (lambda q: q[0] * 10 ** 400, OverflowError, ""),
    (lambda q: (-2) ** q[0], ValueError, "the base is to be positive"),
    (lambda q: q[0] / 0, tvi.Error, "jet_div"),
    (lambda q: q, TypeError, "shape \\(1,\\), not one jet"),
    (lambda q: [q[0]], TypeError, "returned list"),
    (lambda q: None, TypeError, "returned NoneType"),
    (lambda q: "x", TypeError, "returned str"),
    (lambda q: q[0]._value, TypeError, "not one jet"),
    (lambda q: math.nan, ValueError, "not finite"),
    (lambda q: q[1], IndexError, "out of bounds"),
    (lambda q, t, x: q[0], TypeError, "is called with \\(q\\) or \\(q, t\\)"),
    (lambda: 0, TypeError, "is called with"),
    (lambda t, q: q[0], TypeError, "t comes last"),
    (lambda q, *, k: q[0], TypeError, "argument k"),
    (lambda q: [][0], IndexError, ""),
    (lambda q: exit(3), SystemExit, "3"),
]


class Jets(unittest.TestCase):
    def test_computed(self):
        for name, function in COMPUTED.items():
            with self.subTest(name):
                system = tvi.hamiltonian(3, lambda q, p, t: function(q, t))
                for q in ([0.7, 1.3, 2.1], [3.0, 0.25, 1.5]):
                    wanted = float(function(np.array(q), 0.3))
                    self.assertAlmostEqual(system.energy(0.3, q, [0, 0, 0]), wanted, delta=4e-14 * (1 + abs(wanted)))

    def test_small_arguments(self):
        """expm1 and log1p keep their digits near 0."""
        system = tvi.hamiltonian(1, lambda q, p: np.expm1(q[0]) + np.log1p(p[0]))
        self.assertAlmostEqual(system.energy(0, [1e-12], [0]) / math.expm1(1e-12), 1, delta=1e-14)
        self.assertAlmostEqual(system.energy(0, [0], [1e-12]) / math.log1p(1e-12), 1, delta=1e-14)

    def test_refused(self):
        for number, (function, kind, text) in enumerate(REFUSED):
            with self.subTest(number):
                with self.assertRaisesRegex(kind, text):
                    tvi.potential(1, function)
                self.assertEqual(tvi.potential(1, lambda q: q[0]**2).energy(0, [2], [0]), 4)

    def test_kept(self):
        """A jet is of use neither after its function nor in another one, nor on another thread."""
        kept = []
        tvi.potential(1, lambda q, t: kept.extend([q[0], t]) or q[0])
        for use in (lambda: kept[0] + 1, lambda: np.sin(kept[0]), lambda: kept[0] * kept[1], lambda: 2 ** kept[1]):
            with self.assertRaisesRegex(ValueError, KEPT):
                use()
        with self.assertRaisesRegex(ValueError, KEPT):
            tvi.potential(1, lambda q: kept[0])
        with self.assertRaisesRegex(ValueError, KEPT):
            tvi.potential(1, lambda q: q[0] + kept[0])
        with self.assertRaisesRegex(ValueError, MIXED):
            tvi.potential(1, lambda q: tvi.potential(1, lambda x: x[0] + q[0]) and q[0])
        self.assertIn("returned", repr(kept[0]))

    def test_other_thread(self):
        raised = []

        def use(x):
            try:
                x + 1
            except ValueError as error:
                raised.append(str(error))

        def function(q):
            thread = threading.Thread(target=use, args=(q[0],))
            thread.start()
            thread.join()
            return q[0]

        tvi.potential(1, function)
        self.assertIn("another thread", raised[0])

    def test_nested(self):
        """A function may make systems of its own."""
        def outer(q):
            inner = tvi.potential(1, lambda x: 3 * x[0])
            return inner.energy(0, [2], [0]) * q[0]

        self.assertEqual(tvi.potential(1, outer).energy(0, [1], [0]), 6)

    def test_vectors(self):
        """Functions that return as many jets as coordinates."""
        for value in ([1], (1,), np.ones(1), lambda q: -q, lambda q: iter([q[0]]), lambda q: [np.array(q[0])]):
            tvi.force(1, value if callable(value) else lambda q: value)
        for value, kind, text in (([], ValueError, "0 components, not 1"), ([1, 2], ValueError, "2 components"),
                                  ([1.0] * 100000, ValueError, "100000 components"), (None, TypeError, "NoneType"),
                                  (1.0, TypeError, "float"), (["x"], TypeError, "component 0 of what force returned"),
                                  ([[1]], TypeError, "list"), ([math.inf], ValueError, "not finite")):
            with self.subTest(value=str(value)[:20]), self.assertRaisesRegex(kind, text):
                tvi.force(1, lambda q: value)
        with self.assertRaisesRegex(ValueError, "1 components, not 2"):
            tvi.potential(2, lambda q: q @ q).driven(lambda q, v: [-v[0]])

    def test_traceback(self):
        """What a function raises is the exception itself, with the line of the function."""
        error = KeyError("mine")

        def function(q):
            raise error

        try:
            tvi.potential(1, function)
        except KeyError as raised:
            self.assertIs(raised, error)
            names, frame = [], raised.__traceback__
            while frame:
                names.append(frame.tb_frame.f_code.co_name)
                frame = frame.tb_next
            self.assertEqual(names[-1], "function")
        else:
            self.fail("nothing was raised")


if __name__ == "__main__":
    unittest.main()
