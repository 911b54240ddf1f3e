#!/usr/bin/env python3
"""Light bodies beside heavy ones, in every kind of steps, from far too large to fine: whether what ends with success is
right. Writes a table (light.md) and exits with 1 where a place is wrong by more than 5 % of the distance to the nearest
body, no step was refused and no tail warned, or where a step of the recommended size of the reversible form is refused
or not right to 1e-6.

light.py FILE"""
import sys

import numpy as np
import tvi
from tvi import gravity

MASSES = (0, 1e-20, 1e-15, 1e-12, 1e-10, 1e-8, 1e-6)
FACTORS = (8, 4, 2, 1, 0.5, 0.25)  # of the recommended step, 1
RECOMMENDED = 0.3  # in s, a phase (docs/adaptive.md)


def place(mu, **elements):
    x, v = gravity.Orbit(**elements).state(mu)
    return np.array(x), np.array(v)


def scenes():
    """Name, heavy masses, places and velocities [body, axis] with the light body last, duration, shortest period."""
    sun, jupiter = np.zeros((2, 3)), place(1.00095, a=5.2, e=0.048, i=0.02)
    saturn = place(1.000286, a=9.55, e=0.054, i=0.04)
    for e in 0.2, 0.5, 0.8, 0.95, 0.99:
        body = place(1, a=6, e=e, i=0.1, M=-2.5)
        yield f"comet, e = {e}", (1, 9.5e-4, 2.86e-4), (sun, jupiter, saturn, body), 90, 2 * np.pi * (6 * (1 - e))**1.5
    earth = place(1.000003, a=1, e=0.0167)
    x, v = place(3.003e-6, a=0.00257, e=0.0)
    yield "moon", (1, 3.003e-6), (sun, earth, (earth[0] + x, earth[1] + v)), 5, 0.47
    for e in 0.0, 0.9:
        yield (f"planet of a pair, e = {e}", (1, 1), (sun, place(2, a=15), place(1, a=1, e=e, M=3)), 60,
               2 * np.pi * (1 - e)**1.5)
    moon = place(1.0123, a=60, e=0.05)
    yield "debris", (1, 0.0123), (sun, moon, place(1, a=8, e=0.3, i=0.5)), 2000, 2 * np.pi * (8 * 0.7)**1.5
    x, v = place(1.00095, a=5.2, M=np.pi / 3 + 0.1)
    yield "Trojan", (1, 9.5e-4), (sun, place(1.00095, a=5.2), (x, v)), 200, 74
    e0 = place(1.000003, a=1, M=-1.0)
    near = place(1.000003, a=1)
    yield "flyby", (1, 3.003e-6), (sun, e0, _before((1, 3.003e-6), near, 1e-3, 0.3)), 2, 0.1


def _before(mass, near, distance, speed):
    """A body that passes the second one of a pair at this distance after 1: from there back."""
    b = gravity.Bodies([*mass, 0])
    q = np.r_[0, 0, 0, near[0], near[0] + [0, 0, distance]]
    v = np.r_[0, 0, 0, near[1], near[1] + [speed, 0, 0]]
    r = tvi.solve(b.system(), (0, -1), q, v0=v, tolerance=1e-13)
    return r.q_end[6:9], b.velocities(r.p_end)[6:9]


def start(mass, bodies):
    b = gravity.Bodies(mass)
    q, v = (np.concatenate([np.asarray(body[k], dtype=float).ravel() for body in bodies]) for k in (0, 1))
    return b, *b.to_centre(q, b.momenta(v))


def last_place(q):
    return q[-3:] - q[:3]


def distance_to_nearest(q):
    x = q.reshape(-1, 3)
    return np.sqrt(((x[:-1] - x[-1])**2).sum(axis=1)).min()


def outcome(make, right, nearest):
    """The error of the last body and whether the message warns, or the text of a refusal."""
    try:
        run = make()
    except (tvi.Error, ValueError) as error:
        return str(error)
    if not run.success:
        return run.message
    return np.abs(last_place(run.q_end) - last_place(right)).max() / nearest, "too large" in run.message


def rows():
    for name, heavy, bodies, duration, period in scenes():
        for m in MASSES:
            b, q, p = start([*heavy, m], bodies)
            system = b.system()
            reversible = system.rescaled(b.scale, reversible=True)
            right = tvi.solve(reversible, (0, duration), q, p, h=0.1).q_end
            nearest = distance_to_nearest(right)
            ways = {"fixed": (lambda: system, period / 20),
                    "K": (lambda: system.rescaled(lambda q, p: b.scale(q), False), 0.3),
                    "reversible": (lambda: reversible, RECOMMENDED), "automatic": (system.rescaled, 0.3)}
            for way, (stepped, h) in ways.items():
                for factor in FACTORS:
                    yield name, m, way, factor, outcome(
                        lambda: tvi.solve(stepped(), (0, duration), q, p, h=h * factor), right, nearest)
            for tolerance in 1e-4, 1e-8, 1e-12:
                yield name, m, "tolerance", tolerance, outcome(
                    lambda: tvi.solve(system, (0, duration), q, p, tolerance=tolerance), right, nearest)


def drifts(periods, ways):
    """The change of energy and angular momentum over so many periods of eight orbits with e = 0.9, in a potential that
    turns the ellipse: mean, its standard error, root mean square. Ways are names with a step, in t or s."""
    base = tvi.potential(2, lambda q: -(q @ q)**-0.5 - 1e-4 / 3 * (q @ q)**-1.5)
    for name, h in ways:
        stepped = base if name == "fixed" else base.rescaled(lambda q, p: (q @ q)**0.75, name == "reversible")
        changes = []
        for k in range(8):
            q, p = np.array([0.1, 0]), np.array([0, np.sqrt(19) * (1 + k / 1000)])
            it = tvi.Integrator(stepped, q, p)
            it.integrate(h, int(2 * np.pi * periods / h))
            changes.append([base.energy(0, it.q, it.p) - base.energy(0, q, p),
                            it.q[0] * it.p[1] - it.q[1] * it.p[0] - q[0] * p[1]])
        for what, change in zip(("energy", "angular momentum"), np.array(changes).T):
            print(f"{periods:g} periods, {name}, h = {h:.3g}, {what}: mean {change.mean():.1e} +- "
                  f"{change.std() / 7**0.5:.1e}, rms {np.sqrt((change**2).mean()):.1e}")


def main():
    table, bad, allowed = {}, 0, 1e-6
    for name, m, way, size, result in rows():
        cell = table.setdefault((name, way), dict(runs=0, refused=0, wrong=0, silent=0, most=0.0, recommended=0.0))
        error, is_warned = (1.0, True) if isinstance(result, str) else result
        is_refused, is_recommended = isinstance(result, str), way == "reversible" and size == 1
        cell["runs"] += 1
        cell["refused"] += is_refused
        cell["wrong"] += not is_refused and error > 0.05
        cell["silent"] += error > 0.05 and not is_warned
        if not is_refused:
            cell["most"] = max(cell["most"], error)
        if is_recommended:
            cell["recommended"] = max(cell["recommended"], error)
        if error > 0.05 and not is_warned or is_recommended and error > allowed:
            bad += 1
        if error > 0.05 and not is_refused or is_recommended and error > allowed:
            print(f"{name}, m = {m:g}, {way}, {size:g}: {result if is_refused else f'{error:.1e}'}")
    with open(sys.argv[1], "w") as out:
        out.write("| scene | steps | runs | refused | wrong by 5 % | of these without a warning | largest error | "
                  "at the recommended h |\n|---|---|---|---|---|---|---|---|\n")
        for (name, way), cell in table.items():
            last = f"{cell['recommended']:.1e}" if way == "reversible" else ""
            out.write(f"| {name} | {way} | {cell['runs']} | {cell['refused']} | {cell['wrong']} | {cell['silent']} | "
                      f"{cell['most']:.0e} | {last} |\n")
    drifts(1e5, [("reversible", 0.6), ("K", 0.6)])
    drifts(1e4, [("reversible", 0.6), ("reversible", 0.06), ("fixed", 2 * np.pi / 400)])
    print(f"{sum(cell['runs'] for cell in table.values())} runs, {bad} bad")
    return bad > 0


sys.exit(main())
