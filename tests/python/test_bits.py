"""Runs from Python have the bits of the same runs in C (runs.c), in one call and however they are cut into calls."""

import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

import tvi
from problems import CC, LIBRARY, ROOT, kepler
from tvi import _runs, gravity, rigid
from tvi._library import NAME

TIMES = [0, 0.3, 10, 10.01, 10.02, 499.9]


def in_c():
    """The lines of runs.c by name."""
    with tempfile.TemporaryDirectory() as folder:
        program = str(Path(folder) / "runs")
        subprocess.run([*CC, "-std=c11", f"-I{ROOT}/include", "-o", program, f"{ROOT}/tests/python/runs.c",
                        str(LIBRARY), "-lm", f"-Wl,-rpath,{LIBRARY.parent}"], check=True)
        # The program is linked with the soname, which the folder of the build does not have.
        (Path(folder) / NAME).symlink_to(LIBRARY)
        printed = subprocess.run([program], check=True, capture_output=True, text=True,
                                 env={**__import__("os").environ, "LD_LIBRARY_PATH": folder}).stdout
    lines = {}
    for line in printed.splitlines():
        name = " ".join(word for word in line.split() if "0x" not in word)
        lines[name] = [float.fromhex(word) for word in line.split() if "0x" in word]
    return lines


def run(system, *, q=(1, 0), p=(0, 0.8), method="galerkin", order=16, compiled=False, tangent=None, values=None,
        events=(), **plan):
    """What run() of runs.c prints."""
    told = []

    def tell(which, t, q, p):
        told.extend([t, *q, *p])

    n = system.n
    it = tvi.Integrator(system, q[:n], p[:n] if n > 1 else [0], method=method, order=order, compiled=compiled,
                        **(values or {}))
    it.tangent = tangent
    if events:
        plan.update(events=events, on_event=tell)
    if "times" in plan:
        plan["at_time"] = tell
    it.run(**plan)
    return [*told, it.t, *it.q, *it.p, *([] if tangent is None else it.tangent.ravel())]


def runs():
    """All runs of runs.c by name."""
    system = kepler()
    radial = tvi.event(lambda q, p: q @ p, direction=1)
    order = tvi.taylor_order(1e-12)
    lines = {
        "steps": run(system, h=0.25, steps=5000),
        "verlet": run(system, method="stormer-verlet", order=2, h=0.01, steps=5000),
        "back": run(system, h=-0.25, t_end=-500.1),
        "to": run(system, h=0.25, t_end=500.1),
        "at": run(system, h=0.25, times=TIMES),
        "at and to": run(system, h=0.25, times=TIMES, t_end=500.1),
        "events": run(system, h=0.25, steps=2000, events=[radial]),
        "events to": run(system, h=0.25, t_end=99, events=[radial]),
        "tolerance": run(system, method="taylor", order=order, tolerance=1e-12, t_end=30),
        "tangent": run(system, h=0.25, t_end=20.1, tangent=np.eye(4)),
        "suggested": [tvi.suggest_step(system, 0, [1, 0], [0, 0.8], 4000, 1e-8)[0]],
        "compiled": run(system, h=0.25, t_end=500.1, compiled=tvi.compile(system)),
        "rescaled": run(system.rescaled(), h=0.5, t_end=100.1),
        "rescaled at": run(system.rescaled(lambda q, p: (q @ q) ** 0.75), h=0.5, times=TIMES),
        "driven": run(system.driven(lambda q, v: -0.01 * v), h=0.25, steps=200),
        "force": run(tvi.force(2, lambda q, t: [0.3 * np.cos(t) - np.sin(q[0]), -2 * (q[1] - q[0])], mass=[1, 2.5]),
                     h=0.25, steps=200),
        "constrained": run(tvi.constrained(system, lambda q, t: [q[0] + q[1] - 1 - 0.8 * np.sin(t)]), h=0.02,
                           steps=200),
    }
    product = tvi.hamiltonian(1, lambda q, p, k: (k * np.square(q[0]) + 1) * (np.square(p[0]) + 1) / 2, k=1.5)
    lines["hamiltonian"] = run(product, h=0.1, steps=200)
    lines["parameter"] = run(product, h=0.1, steps=200, values={"k": 2.25})
    pendulum = tvi.lagrangian(2, lambda q, v: v[0] ** 2 + v[1] ** 2 / 2 + v[0] * v[1] * np.cos(q[0] - q[1])
                              + 9.8 * (2 * np.cos(q[0]) + np.cos(q[1])))
    it = tvi.Integrator(pendulum, [1, 0.5], v=[0.2, 0.1])
    it.integrate(0.02, 500)
    lines["lagrangian"] = [it.t, *it.q, *it.p]
    orbits = tvi.Ensemble(system, [[1 + m / 64, 0] for m in range(37)], [0, 0.8], threads=2)
    orbits.integrate(0.25, 2000)
    lines["ensemble"] = [*orbits.q.T.ravel(), *orbits.p.T.ravel()]
    lines["bodies"] = run_bodies()
    lines["rigid"] = run_rigid()
    return lines


def run_bodies():
    """What run_bodies() of runs.c prints."""
    mass, k = np.array([3, 0.5, 0, 2e-3]), np.arange(1, 4)
    bodies = gravity.Bodies(mass, G=2, softening=0.01, J2=1e-3, radius=0.5, pole=[0, 0.2, 1], sharpness=2)
    orbit = gravity.Orbit(a=2 * k, e=0.25 * k, i=0.5, node=1, pericentre=2, time=k)
    q, v = (np.concatenate([np.zeros(3), x.ravel()]) for x in orbit.state(2 * (mass[0] + mass[1:])))
    it = tvi.Integrator(bodies.system().rescaled(bodies.scale), *bodies.to_centre(q, bodies.momenta(v)))
    it.integrate(0.1, 200)
    v = bodies.velocities(it.p)
    centre = np.concatenate(bodies.centre(it.q, it.p))
    found = gravity.Orbit.of(6, it.q[6:9], v[6:9])
    return [it.t, *it.q, *it.p, *bodies.angular_momentum(it.q, it.p), *v, *centre, *found]


def run_rigid():
    """What run_rigid() of runs.c prints."""
    joints = [rigid.Joint("ball", 0, point=[0, 0, -0.5]), rigid.Joint("ball", 1, 0, [-0.5, 0, 0], [0.25, 0, 0]),
              rigid.Joint("cross", 1, 0, axis=[1, 0, 0], other_axis=[0, 0, 1])]
    bodies = rigid.Bodies([rigid.cylinder(2, 0.5, 0.75), rigid.rod(0.5, 1)], joints, gravity=[0, 0, -9.8])

    def spring(q):
        x = bodies.point(q, [0.5, 0, 0], 1)
        return 5 * (x @ x)

    system, turned = bodies.system(spring), rigid.turn([1, 2, 0], 0.5)
    top = rigid.Motion(quaternion=turned, omega=[0.5, 0.25, 20], point=[0, 0, -0.5])
    q, _ = bodies.state(top, rigid.Motion())
    end = rigid.Motion(bodies.point(q, [0.25, 0, 0]), quaternion=turned, point=[-0.5, 0, 0])
    it = tvi.Integrator(system, *system.project(*bodies.state(top, end)))
    it.integrate(0.01, 200)
    motion = bodies.motion(it.q, it.p, point=top.point)
    return np.concatenate([it.q, it.p, bodies.angular_momentum(it.q, it.p), *motion[:4]])


class Bits(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.wanted = in_c()

    def compare(self, got):
        self.assertEqual(sorted(got), sorted(self.wanted))
        for name, numbers in got.items():
            with self.subTest(name):
                self.assertGreater(len(numbers), 0)
                self.assertEqual([x.hex() for x in map(float, numbers)], [x.hex() for x in self.wanted[name]])

    def test_one_call(self):
        self.compare(runs())

    def test_cut_into_many_calls(self):
        """Calls of a few steps each, of other numbers of them in every run."""
        calls = []

        class Short(_runs.Pace):
            def timed(self, call, steps):
                calls.append(steps)
                self.steps = 1 + len(calls) * 7 % 13
                return call()

        whole, _runs.Pace = _runs.Pace, Short
        try:
            self.compare(runs())
        finally:
            _runs.Pace = whole
        self.assertGreater(len(calls), 1000)


if __name__ == "__main__":
    unittest.main()
