"""Orbits of all bodies of a run, and what systems, runs and solutions show of themselves."""

import html.parser
import unittest

import numpy as np

import tvi
from problems import kepler, spring
from tvi import gravity

SUN = gravity.Bodies([1, 1e-3, 0, 2e-3], axes=2, G=2)


def start():
    """Three planets on ellipses, each about the centre of mass of those before it."""
    x = v = np.zeros((1, 3))
    for k, (a, e, f) in enumerate(((1, 0.1, 1), (2, 0.2, 2), (4, 0.3, 3)), 1):
        inside = SUN.mass[:k]
        there, speed = gravity.Orbit(a=a, e=e, f=f).state(2 * SUN.mass[:k + 1].sum())
        x, v = (np.vstack([y, inside @ y / inside.sum() + z]) for y, z in ((x, there), (v, speed)))
    return x[:, :2].ravel(), v[:, :2].ravel()


class Orbits(unittest.TestCase):
    def test_elements(self):
        """About the inner ones those that were given; about a body those of Orbit.of, pair by pair."""
        q, v = start()
        p = SUN.momenta(v)
        inner = SUN.orbits(q, p, about="inner")
        self.assertLess(np.abs([inner.a - [1, 2, 4], inner.e - [0.1, 0.2, 0.3], inner.f - [1, 2, 3]]).max(), 1e-14)
        for about in range(4):
            orbits = SUN.orbits(q, p, about)
            for k, j in enumerate(np.delete(np.arange(4), about)):
                x, speed = (np.append(y.reshape(4, 2)[j] - y.reshape(4, 2)[about], 0) for y in (q, v))
                one = gravity.Orbit.of(2 * (SUN.mass[about] + SUN.mass[j]), x, speed)
                self.assertLess(np.max([abs(a[k] - b) for a, b in zip(orbits, one)]), 1e-10)

    def test_runs(self):
        """Of all times, of systems that are made of those of bodies, and of others with their bodies."""
        q, v = start()
        own = tvi.potential(SUN.n, lambda q: SUN.potential(q), mass=SUN.coordinate_masses)
        plain = tvi.solve(SUN.system(), (0, 20), q, v0=v, h=0.2)
        for system in SUN.system().rescaled(SUN.scale), SUN.system().driven(lambda q, v: 0 * v):
            run = tvi.solve(system, (0, 20), q, v0=v, h=0.2)
            self.assertEqual(run.orbits().a.shape, (len(run.t), 3))
            self.assertLess(np.abs(run.orbits().a[-1] - plain.orbits().a[-1]).max(), 1e-8)
        run = tvi.solve(own, (0, 20), q, v0=v, h=0.2)
        with self.assertRaisesRegex(TypeError, "not that of gravity.Bodies: give bodies="):
            run.orbits()
        self.assertTrue(np.array_equal(run.orbits(bodies=SUN, about="inner").e, plain.orbits("inner").e))
        for about in (4, -1):
            with self.assertRaisesRegex(ValueError, "about = "):
                plain.orbits(about)


class Text(html.parser.HTMLParser):
    """The text of what is well formed."""

    def __init__(self, text):
        super().__init__()
        self.open, self.text = [], ""
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attributes):
        self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data + "\n"


class Shown(unittest.TestCase):
    def test_both(self):
        """Text and HTML say the same."""
        system = tvi.potential(2, lambda q, mu: -mu / np.sqrt(q @ q), mu=1.0)
        events = [lambda q, p: q[0], lambda q, p: q[1]]
        run = tvi.solve(system, (0, 20), [1, 0], [0, 1], h=0.5, events=events, dense_output=True, mu=1.5)
        many = tvi.ensemble(kepler(), (0, 1), [[1, 0], [1, 0]], [0, 1], h=0.5)
        for shown, words in ((run, ["n = 2, mu=1.0", "galerkin", "h = 0.5", "40, ", "41 states", "12, 12", "mu = 1.5",
                                    f"{run.energy[0]:.12g}"]),
                             (many, ["2 OK", "(2, 2)", "h = 0.5"])):
            for text in repr(shown), Text(shown._repr_html_()).text:
                for word in words:
                    self.assertIn(word, text)
        self.assertEqual(len(repr(run).splitlines()), 8)
        self.assertIn("from 0.0 to 20.0", Text(run.sol._repr_html_()).text)

    def test_systems(self):
        planets = SUN.system()
        for system, words in ((planets, ["potential", "from 1e-30 to 1", "Bodies.potential"]),
                              (spring(), ["potential", "1.0"]),
                              (tvi.force(1, lambda q: -q), ["none, as it is made from a force", "<lambda>"]),
                              (tvi.constrained(tvi.potential(2, lambda q: q[1]), lambda q: [q @ q - 1]),
                               ["constrained", "made of", "<tvi system: potential, n = 2>"])):
            text = Text(system._repr_html_()).text
            for word in words:
                self.assertIn(word, text)

    def test_no_energy(self):
        self.assertIn("energy", repr(tvi.solve(spring(), (0, 1), [1], p0=0, h=0.1)))
        self.assertNotIn("energy", repr(tvi.solve(tvi.force(1, lambda q: -q), (0, 1), [1], p0=0, h=0.1)))
        self.assertIn("tolerance = 1e-10", repr(tvi.solve(spring(), (0, 1), [1], p0=0, tolerance=1e-10)))


if __name__ == "__main__":
    unittest.main()
