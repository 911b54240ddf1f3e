"""cost.py PROGRAM: what runs cost in Python beside C, whose runs PROGRAM makes (cost.c); least CPU times, in turns."""

import subprocess
import sys
import time

import numpy as np

import tvi

TURNS = 9
KEPLER = tvi.potential(2, lambda q: -(q @ q)**-0.5)
STATE = {"q": [1, 0], "p": [0, 0.8]}
START = {"q0": [1, 0], "p0": [0, 0.8]}


def least(run, repetitions=1):
    times = []
    for _ in range(repetitions):
        begin = time.process_time()
        run()
        times.append(time.process_time() - begin)
    return min(times)


def in_c(steps, repetitions=1):
    return float(subprocess.run([sys.argv[1], str(steps), str(repetitions)], capture_output=True, check=True).stdout)


def integrate():
    tvi.Integrator(KEPLER, **STATE).integrate(0.25, 10**6)


def in_turns(run, steps, repetitions=1):
    """The least times of the run in Python and of so many steps in C."""
    pairs = [(least(run, repetitions), in_c(steps, repetitions)) for _ in range(TURNS)]
    return np.min(pairs, axis=0)


python, c = in_turns(integrate, 10**6)
print("| run | Python, ms | C, ms | |")
print("|---|---|---|---|")
print(f"| 10^6 steps in one `integrate` | {python * 1e3:.0f} | {c * 1e3:.0f} | {python / c:.3f} of C |")
for name, more in (("states kept", {}), ("with an event", {"events": lambda q, p: q @ p})):
    python, c = in_turns(lambda: tvi.solve(KEPLER, (0, 25), **START, h=0.25, **more), 100, 100)
    print(f"| `solve`, 100 steps, {name} | {python * 1e3:.2f} | {c * 1e3:.2f} | {(python - c) * 1e3:.2f} ms more |")
