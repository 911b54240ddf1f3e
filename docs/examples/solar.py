"""The Sun and the outer planets of solar.h for 200,000 days, masses beside the function: by ctypes and by cffi.
   python3 solar.py"""
import re

import tvi_cffi
import tvi_ctypes

text = open("solar.h").read()

def numbers(name):
    found = re.search(r"\b%s(\[\w+\])? = ([^;]*);" % name, text).group(2)
    return eval(found.replace("{", "[").replace("}", "]"))


G, mass, place, speed = map(numbers, ("G", "mass", "place", "speed"))
bodies, n = range(len(mass)), len(place)


def distance2(q, i, j):
    return sum((q[3 * i + k] - q[3 * j + k]) ** 2 for k in range(3))


def potential(q, t):
    return -sum(G * mass[i] * mass[j] * distance2(q, i, j) ** -0.5 for i in bodies for j in range(i))


def force(q, t):
    F = [0] * n
    for i in bodies:
        for j in range(i):
            pull = G * mass[i] * mass[j] * distance2(q, i, j) ** -1.5
            for k in range(3):
                d = pull * (q[3 * i + k] - q[3 * j + k])
                F[3 * i + k], F[3 * j + k] = F[3 * i + k] - d, F[3 * j + k] + d
    return F


masses = [mass[i // 3] for i in range(n)]
p0 = [m * v for m, v in zip(masses, speed)]  # p = M v
for name, run in ("ctypes", tvi_ctypes.Run(n, force, masses)), ("cffi", tvi_cffi.Run(n, potential, masses)):
    t, q, p = run.integrate(500, 400, 0, place, p0)
    jupiter = [a - b for a, b in zip(q[3:6], q)]
    print("%s: after %.0f days Jupiter is at (%.4f, %.4f, %.4f) AU" % (name, t, *jupiter))
    if name == "cffi":
        print("energy error %.0e" % abs(run.energy(t, q, p) / run.energy(0, place, p0) - 1))
