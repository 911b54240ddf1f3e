"""Makes common mistakes, and writes the texts that they get to mistakes.md (make mistakes), beside those of 0.2.0.

`mistakes.py` prints the texts of the module and library that it finds, as JSON. `mistakes.py write` writes the page:
the texts of 0.2.0 are those of the page, or with BEFORE=DIR those of a built checkout there."""

import json
import math
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import warnings
from pathlib import Path

import numpy as np

import tvi
from tvi import gravity
from tvi._library import NAME

PAGE = Path(__file__).with_name("mistakes.md")
LIBRARY = Path(os.environ["TVI_LIBRARY"]).resolve()
INCLUDE = Path(tvi.__file__).resolve().parents[3] / "include"
HEAD = """# Common mistakes

The text that each of them gets, in 0.2.0 and now. `make mistakes` writes this page, and `make check-python`
compares it.

| mistake | 0.2.0 | now |
|---|---|---|
"""


# ---- What the mistakes are made with ---------------------------------------------------------------------------------

def filled(q):
    f = np.zeros(2)
    f[0] = -q[0]
    return f


def interrupted():
    """A run that Ctrl-C ends."""
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    try:
        tvi.solve(spring, (0, 1e9), [1], p0=[0], h=0.1, compiled=False)
    finally:
        signal.signal(signal.SIGINT, handler)


kepler = tvi.potential(2, lambda q: -(q @ q) ** -0.5)
spring = tvi.potential(1, lambda q: q[0] ** 2 / 2)
heavy = tvi.potential(1, lambda q: q[0] ** 2, mass=4)
steep = tvi.potential(1, lambda q: np.cosh(30 * q[0]))
SCOPE = dict(np=np, math=math, tvi=tvi, gravity=gravity, kepler=kepler, spring=spring, heavy=heavy, steep=steep,
             filled=filled, interrupted=interrupted)

# ---- The mistakes: a heading, and programs in Python, C or C++ -------------------------------------------------------

KEPLER = "[1, 0], p0=[0, 0.8], h=0.1"
MISTAKES = [
    ("a wrong shape", [f"tvi.solve(kepler, (0, 1), {q}, p0=[0, 1], h=0.1)" for q in ("[1, 0, 0]", "[[1, 0]]", "1.0")]),
    ("a branch", [f"tvi.potential(1, lambda q: {x})" for x in ("q[0] if q[0] > 0 else 0", "max(q[0], 0)",
                                                                "np.where(q > 0, q, 0)[0]", "np.maximum(q[0], 0)")]),
    ("a function of numbers", [f"tvi.potential(1, lambda q: {x})" for x in ("math.sin(q[0])", "float(q[0])")]),
    ("f = np.zeros(2); f[0] = -q[0]", ["tvi.force(2, filled)"]),
    ("a mass that is not positive", ["tvi.potential(2, lambda q: q @ q, mass=[1, -2])",
                                     "tvi.potential(1, lambda q: q[0]**2, mass=0)",
                                     "gravity.Bodies([1, -1]).system()"]),
    ("a run backwards", ["tvi.solve(spring, (1, 0), [1], p0=[0], h=0.1)"]),
    ("nan and inf", ["tvi.solve(kepler, (0, 1), [1, math.nan], p0=[0, 1], h=0.1)",
                     "tvi.solve(kepler, (0, 1), [1, 0], p0=[math.inf, 1], h=0.1)",
                     "tvi.solve(kepler, (0, math.inf), [1, 0], p0=[0, 1], h=0.1)"]),
    ("no momenta", ["tvi.solve(spring, (0, 1), [1], h=0.1)", "tvi.Integrator(spring, [1])"]),
    ("velocities for momenta", ["tvi.solve(heavy, (0, 1), [1], p0=[1], h=0.1)"]),
    ("an event that returns no number", [f"tvi.solve(kepler, (0, 1), {KEPLER}, events=lambda q, p: {x})"
                                         for x in ("q", "None")]),
    ("an event of SciPy", [f"tvi.solve(kepler, (0, 1), {KEPLER}, events=lambda t, y: y[0])"]),
    ("an event that is none", [f"tvi.solve(kepler, (0, 1), {KEPLER}, events={x})" for x in ("3", "[3]")]
     + ["tvi.event(3)"]),
    ("too many arguments", ["tvi.potential(2, lambda q, t, mu: -mu / np.sqrt(q @ q))"]),
    ("a parameter without a value", ["tvi.potential(1, lambda q, k: k * q[0]**2 / 2)",
                                     "tvi.solve(tvi.potential(1, lambda q, k: k * q[0]), (0, 1), [1], p0=[0], k=3)"]),
    ("arguments in another place", ["tvi.potential(2, lambda q, p: q @ q + p @ p)", "tvi.force(1, lambda q, v: -q - v)",
                                    "tvi.hamiltonian(1, lambda p, q: p[0]**2 / 2 + 9.8 * q[0])",
                                    "spring.driven(lambda q, t: [np.cos(t)])"]),
    ("whole numbers, single precision", ["tvi.solve(kepler, (0, 1), np.array([1, 0]), p0=[0, 1], h=np.float32(1))"]),
    ("an error below roundoff", ["tvi.solve(kepler, (0, 1), [1, 0], p0=[0, 0.8], error=1e-20)"]),
    ("a step of 0", ["tvi.solve(kepler, (0, 1), [1, 0], p0=[0, 1], h=0)",
                     "tvi.Integrator(kepler, [1, 0], [0, 1]).step(0)"]),
    ("names of SciPy", [f"tvi.solve(kepler, (0, 1), {KEPLER}, {x})" for x in ("rtol=1e-9", "max_step=0.1")]
     + ["tvi.solve(fun=lambda t, y: y, t_span=(0, 1), y0=[1])"]),
    ("a method of SciPy", [f'tvi.solve(kepler, (0, 1), {KEPLER}, method="DOP853")']),
    ("arguments in another order", ["tvi.solve((0, 1), kepler, [1, 0], p0=[0, 0.8], h=0.1)",
                                    "tvi.solve(kepler, [1, 0, 0], (0, 1), h=0.1)"]),
    ("another anomaly", ["gravity.Orbit(a=1, e=0.1, M=1.0).state(1.0)", "gravity.Orbit(a=1, e=0.1, f=1.0).state(1.0)"]),
    ("degrees", ["gravity.Orbit(a=1, i=20).state(1.0)", "gravity.Orbit(a=1, node=100).state(1.0)"]),
    ("a step that is too large", ["tvi.solve(steep, (0, 1), [1], p0=[0], h=0.7)",
                                  "tvi.solve(steep.rescaled(), (0, 1), [1], p0=[0], h=3)"]),
    ("Ctrl-C", ["interrupted()"]),
    ("C: what the compiler says", ["C, in V: jet x = q[0] * q[0];", "C, in V: jet x = sin(q[0]);",
                                   "C: tvi_step(it, h, &t, q, p);"]),
    ("C: a component beyond the end", ["C, in V: return jet_mul(q[0], q[2]);", "C, in F: force[2] = q[0];"]),
    ("C: what was not set, as memory may have it", ["C, in V: jet s = {0, calloc(1, 256)}; return jet_add(s, q[0]);",
                                                    "C, in F: force[1] = q[0];"]),
    ("C: wrong values", ["C: q[1] = NAN;", "C: h = 0;", "C: mass[1] = -1;", "C: it = NULL;"]),
    ("C++", ["C++, in V: std::sin(q[0])", "C++: q.resize(3);"]),
]

# ---- What each of them gets ------------------------------------------------------------------------------------------

PROGRAMS = {
    "c": """#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <tvi.h>
static jet V(const jet q[], jet t, void *ctx) {
    (void)q, (void)t, (void)ctx;
    %(V)s
    return jet_neg(jet_pow(jet_dot(q, q, 2), -0.5)); }
static void F(const jet q[], jet t, jet force[], void *ctx) {
    (void)q, (void)t, (void)ctx;
    %(F)s
    (void)force; }
int main(void) {
    double mass[] = {1, 1}, t = 0, q[] = {1, 0}, p[] = {0, 0.8}, h = 0.1;
    tvi_system *system, *forced;
    tvi_integrator *it;
    TVI_OR_EXIT(tvi_system_potential(&system, 2, NULL, V, NULL));
    TVI_OR_EXIT(tvi_integrator_create(&it, system, NULL));
    %(main)s
    TVI_OR_EXIT(tvi_system_potential(&system, 2, mass, V, NULL));
    if (%(has_F)d) TVI_OR_EXIT(tvi_system_force(&forced, 2, NULL, F, NULL));
    TVI_OR_EXIT(tvi_step(it, h, &t, q, p));
    printf("runs: q = %%.9f %%.9f", q[0], q[1]); }
""",
    "cpp": """#include <cmath>
#include <iostream>
#include <vector>
#include <tvi.hpp>
int main() {
    try {
        const auto system = tvi::potential(1, [](const jet *q, jet) { return %(V)s; });
        tvi::integrator it(system);
        double t = 0;
        std::vector<double> q{1}, p{0};
        %(main)s
        it.step(0.1, t, q, p);
        std::cout << "runs";
    } catch (const tvi::error &error) { std::cout << error.what(); } }
"""}


def of_compiler(printed):
    """What a compiler says, in words that all of them share, and the library's own words."""
    own = re.search(r'static.assert\w* failed.*?(of a jet[^\n"]*)', printed)
    return ("an error of the compiler" if "error" in printed else "a warning of the compiler") \
        + (f": {own.group(1)}" if own else "")


def compiled(language, where, code):
    """What a program in C or C++ prints, or what its compiler says."""
    places = {"V": "" if language == "c" else "q[0] * q[0]", "F": "", "main": "", "has_F": where == "F", where: code}
    compiler = os.environ.get("CC", "cc").split() if language == "c" else os.environ.get("CXX", "c++").split()
    with tempfile.TemporaryDirectory() as folder:
        source = f"mistake.{language}"
        (Path(folder) / source).write_text(PROGRAMS[language] % places)
        (Path(folder) / NAME).symlink_to(LIBRARY)
        standard = "-std=c11" if language == "c" else "-std=c++11"
        done = subprocess.run([*compiler, "-O1", "-Wall", standard, f"-I{INCLUDE}", "-o", "mistake", source,
                               str(LIBRARY), "-lm"], cwd=folder, capture_output=True, text=True)
        if done.stderr:
            return of_compiler(done.stderr)
        done = subprocess.run(["./mistake"], cwd=folder, capture_output=True, text=True,
                              env={**os.environ, "LD_LIBRARY_PATH": folder})
        return done.stdout + done.stderr + (f"signal {-done.returncode}" if done.returncode < 0 else "")


def in_python(code):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            value = eval(code, SCOPE)
        except BaseException as error:
            return f"{type(error).__name__}: {error}"
    if isinstance(value, tvi.Result):
        return f"{value.message} q = {value.q_end.round(6)}"
    return f"{value}"


def text_of(code):
    """The text for a mistake. Numbers of many digits, which may differ by roundoff, are cut, as are signs of 0."""
    found = re.match(r"(C|C\+\+)(?:, in (\w))?: (.*)", code)
    text = compiled("c" if found[1] == "C" else "cpp", found[2] or "main", found[3]) if found else in_python(code)
    text = re.sub(r"mistake.c:\d+: ", "", " ".join(text.split()))
    text = re.sub(r"(?<=interrupted at t = ).*", "...", re.sub(r"-0\.(?!\d)", "0.", text))
    return re.sub(r"-?\d+\.\d{4,}(e[-+]\d+)?", lambda x: f"{float(x[0]):.3g}", text)


def texts():
    return {code: text_of(code) for _, codes in MISTAKES for code in codes}


# ---- The page --------------------------------------------------------------------------------------------------------

def cell(text):
    return text.replace("|", "\\|")


def rows():
    """The rows of the page by their mistakes."""
    found = {}
    for line in PAGE.read_text().splitlines() if PAGE.exists() else ():
        if match := re.match(r"\| \d+\. [^`]*`` (.*) `` \| (.*) \| (.*) \|$", line):
            found[match[1]] = match[2], match[3]
    return found


def page(before, now):
    """The page, with what each mistake got before and gets now."""
    lines = [f"| {number}. {heading}: `` {cell(code)} `` | {cell(before[code])} | {cell(now[code])} |"
             for number, (heading, codes) in enumerate(MISTAKES, 1) for code in codes]
    return HEAD + "\n".join(lines) + "\n"


def texts_of_checkout(folder):
    """Those of a built checkout."""
    done = subprocess.run([sys.executable, __file__], check=True, capture_output=True, text=True,
                          env={**os.environ, "TVI_LIBRARY": f"{folder}/build/libtvi.so",
                               "PYTHONPATH": f"{folder}/src/python"})
    return json.loads(done.stdout)


if __name__ == "__main__":
    if sys.argv[1:] == ["write"]:
        kept = {code: old.replace("\\|", "|") for code, (old, _) in rows().items()}
        PAGE.write_text(page(texts_of_checkout(os.environ["BEFORE"]) if "BEFORE" in os.environ else kept, texts()))
    else:
        print(json.dumps(texts()))
