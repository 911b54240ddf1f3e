"""What functions of jets compute is what numpy computes of numbers, and what cannot be recorded is refused."""

import math
import threading
import traceback
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
    **{f"{function.__name__} in arrays": lambda x, t, f=function: f(2.0, x).sum() + f(x, 2.0) @ x + f(2, x[1])
       + f(x, [1.0, 2.0, 3.0]).sum() + f([1.0, 2.0, 3.0], x)[2] + f(np.arange(1, 4), x[0]).sum() + f(x, x[1]).prod()
       + f(x[:, np.newaxis], x).sum() + f(x[:, np.newaxis], [1.0, 2.0]).sum() + f([[1.0], [2.0]], x)[1, 2]
       + f(np.float32(2), 2 * x + 1).sum() + f(x.reshape(3, 1), x[:2])[2, 1] for function in (np.hypot, np.arctan2)},
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
    (lambda q: q[0] * 1j, TypeError, "jets are real"),
    (lambda q: 1j, TypeError, "jets are real"),
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
    (lambda q, *, k: q[0], TypeError, "k has no value"),
    (lambda q: [][0], IndexError, ""),
    (lambda q: exit(3), SystemExit, "3"),
]


# Functions of numpy and SciPy of three coordinates that take no jets, and a part of what the text says to write.
X, Y = [0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 4.0, 9.0]
UNRECORDED = [
    (lambda q: np.interp(q[0], X, Y), "interp takes no jets: a table .* np.polynomial.Polynomial.fit"),
    (lambda q: np.interp(q, X, Y)[0], "interp takes no jets: a table"),
    (lambda q: np.gradient(q)[0], "gradient takes no jets: write np.diff"),
    (lambda q: np.abs(np.fft.rfft(q))[0], "rfft takes no jets: write its sums"),
    (lambda q: np.linalg.solve(np.eye(3), q)[0], "solve takes no jets: write the solution out .* Lagrangian"),
    (lambda q: np.linalg.inv(np.outer(q, q))[0, 0], "inv takes no jets: write the solution out"),
    (lambda q: np.linalg.det(np.array([[q[0], 1], [1, q[1]]])), "det takes no jets: write it out"),
    (lambda q: np.linalg.eigvalsh(np.outer(q, q))[0], "eigvalsh takes no jets"),
    (lambda q: np.logaddexp(0, q[0]), "logaddexp takes no jets: write a \\+ np.log1p"),
    (lambda q: np.logaddexp(0, q).sum(), "logaddexp takes no jets: write a \\+ np.log1p"),
    (lambda q: np.cbrt(q[0]), "cbrt takes no jets: write x\\*\\*\\(1 / 3\\)"),
    (lambda q: np.cbrt(np.array([q[0], q[1]]))[1], "cbrt takes no jets"),
    (lambda q: np.heaviside(q[0], 0), "heaviside takes no jets: .* np.tanh.*event"),
    (lambda q: np.copysign(1, q[0]), "copysign takes no jets: .* np.tanh.*event"),
    (lambda q: np.float_power(q[0], 2), "float_power takes no jets: write \\*\\*"),
    (lambda q: np.ldexp(q[0], 2), "ldexp takes no jets: tvi.Jet lists"),
    (lambda q: np.isnan(q[0]), "isnan takes no jets"),
    (lambda q: np.hypot(1.0, np.array([q[0], q[1]])).sum(), "hypot takes no jets in an array after a number: write"),
    (lambda q: np.angle(q[0]), "angle takes no jets: write np.arctan2"),
    (lambda q: np.maximum(q[0], 0), "a branch .* smooth function, .* tvi.event"),
    (lambda q: max(q[0], 0), "a branch .* smooth function, .* tvi.event"),
    (lambda q: filled(np.zeros(3), q), "return a list, or fill np.empty\\(n, object\\)"),
    (lambda q: filled(np.empty(3), q[:3]), "return a list, or fill np.empty\\(n, object\\)"),
    (lambda q: math.exp(q[0]), "Write np.sin, not math.sin"),
    (lambda q: np.real(np.exp(1j * q[0])), "jets are real, not complex: write real and imaginary parts"),
    (lambda q: complex(q[0], q[1]), "jets are real"),
    (lambda q: (q * np.complex128(1j)).sum(), "jets are real"),
    (lambda q: np.fmod(q[0], 2), "rounding, // and %"),
]


def filled(array, q):
    array[0] = q[0]
    array[1:] = -q[1:]
    return array[0]


def of_scipy():
    """The same of SciPy, where it is there."""
    try:
        from scipy import fft, interpolate, linalg, sparse, special
    except ImportError:
        return []
    band = sparse.diags([-1, 2, -1], [-1, 0, 1], shape=(3, 3)).tocsr()
    return [
        (lambda q: interpolate.CubicSpline(X, Y)(q[0]), "scipy.interpolate takes no jets: a table"),
        (lambda q: interpolate.interp1d(X, Y)(q[0]), "scipy.interpolate takes no jets: a table"),
        (lambda q: interpolate.UnivariateSpline(X, Y)(q[0]), "scipy.interpolate takes no jets: a table"),
        (lambda q: q @ (band @ q), "scipy.sparse takes no jets: write A.toarray"),
        (lambda q: q @ band.dot(q), "scipy.sparse takes no jets: write A.toarray"),
        (lambda q: fft.rfft(q)[0], "takes no jets: write its sums"),
        (lambda q: linalg.solve(np.eye(3), q)[0], "scipy.linalg takes no jets: write the solution out"),
        (lambda q: special.expit(q[0]), "expit takes no jets: write 1 / "),
        (lambda q: special.expit(q).sum(), "expit takes no jets: write 1 / "),
        (lambda q: special.erf(q[0]), "erf takes no jets: write tvi.erf"),
        (lambda q: special.jv(1, q[0]), "jv takes no jets: tvi.Jet lists"),
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

    def test_unrecorded(self):
        """What numpy and SciPy do not do with jets: the text says what to write, the traceback has the user's line."""
        for number, (function, text) in enumerate(UNRECORDED + of_scipy()):
            with self.subTest(number), self.assertRaisesRegex(TypeError, text):
                try:
                    tvi.potential(3, function)
                except TypeError as error:
                    names = [frame.name for frame in traceback.extract_tb(error.__traceback__)]
                    self.assertIn("<lambda>", names)
                    raise

    def test_einsum(self):
        """numpy takes objects there from 1.25 on."""
        try:
            system = tvi.potential(3, lambda q: np.einsum("i,i->", q, q))
        except TypeError as error:
            self.assertEqual(str(error), "np.einsum takes no jets: write @, np.tensordot, or sums of products")
        else:
            self.assertEqual(system.energy(0, [1, 2, 3], [0, 0, 0]), 14)

    def test_other_errors(self):
        """What a function raises for reasons of its own comes out as it is."""
        for error in (TypeError("ufunc: mine"), ValueError("a table takes no jets"), AttributeError("no attribute")):
            def function(q):
                raise error
            with self.assertRaises(type(error)) as raised:
                tvi.potential(1, function)
            self.assertIs(raised.exception, error)
        for function in (lambda q: q @ np.ones(4), lambda q: q[0].wrong, lambda q: np.dot(q, np.ones(2))):
            with self.assertRaises((ValueError, AttributeError)) as raised:
                tvi.potential(3, function)
            self.assertNotIn("takes no jets", str(raised.exception))

    def test_arrays(self):
        """What is computed of an array of jets is one of numpy, also in place, as an output and of several results."""
        def function(q):
            y = np.empty(3, object)
            np.multiply(q, 2, out=y)
            y += q
            y[1:] -= 1
            z = np.add.accumulate(q)
            np.add(q, z, out=z)
            return y.sum() + np.add.reduce(z) + np.hypot.outer(q, [3.0, 4.0])[0, 1]

        self.assertAlmostEqual(tvi.potential(3, function).energy(0, [3, 1, 2], [0, 0, 0]),
                               18 - 2 + 6 + 13 + 5, delta=1e-14)

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
