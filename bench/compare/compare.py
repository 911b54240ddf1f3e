"""compare.py FOLDER NAME FOLDER NAME PATTERN COUNT_ISA: what the rows cost with two libraries.

Each folder has a program `compare` (compare.c), linked with one of the two. Both are open at the same time and take turns
of milliseconds on one core, so that what else the machine does meets both. They are started several times for each row,
as the memory that they get decides, too, and go from core to core. A row's times are the medians of the quarter of its
pairs of turns in which both are fastest. Its scatter is half of the distance between the quartiles of all pairs' ratios.
Instructions are counted by callgrind with
TVI_ISA=COUNT_ISA, where valgrind is. `make compare-with COMMIT=hash` calls it.
"""
import concurrent.futures
import glob
import math
import os
import re
import shutil
import statistics
import subprocess
import sys
import time

STARTS, MOST_TURNS, LEAST_TURNS, LONGEST = 4, 25, 6, 0.12  # of a row; turns and s of a start
ENVIRONMENT = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
WIDTH, CELL = 41, 13

# The same addresses in both programs, where the system allows that.
FIXED = ["setarch", "-R"]
if not shutil.which("setarch") or subprocess.run([*FIXED, "true"], capture_output=True).returncode:
    FIXED = []

CORES = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else [0]


class Side:
    """One of the two programs. It is started by the same name in the same environment as the other, so that their
    stacks are alike."""

    def __init__(self, folder, name):
        self.folder, self.name = folder, name
        self.counts, self.refused = {}, {}
        self.process = None

    def run(self, arguments, isa, before=()):
        environment = {**ENVIRONMENT, "TVI_ISA": isa} if isa else ENVIRONMENT
        done = subprocess.run([*before, "./compare", *arguments], cwd=self.folder, env=environment, text=True,
                              stdout=subprocess.PIPE)
        if done.returncode:
            sys.exit(f"compare-with: the program of {self.name} ended with status {done.returncode}")
        return done.stdout

    def rows(self, pattern):
        return [Row(*line.split("\t")) for line in self.run(["list", pattern], "").splitlines()]

    def compile(self, pattern, isas):
        """Runs each row once: generated code is then in the cache of the folder."""
        for isa in isas:
            self.run(["count", pattern], isa)

    def count(self, pattern, isa):
        """Sets counts[row] to the instructions of a step."""
        parts = os.path.join(self.folder, "callgrind")
        shutil.rmtree(parts, ignore_errors=True)
        os.mkdir(parts)
        callgrind = ["valgrind", "-q", "--tool=callgrind", "--callgrind-out-file=callgrind/part",
                     "--toggle-collect=measured_run", "--dump-after=measured_run"]
        lines = self.run(["count", pattern], isa, callgrind).splitlines()
        counted = [line.split() for line in lines if "refused" not in line]
        for place, (row, steps) in enumerate(counted, 1):
            with open(os.path.join(parts, f"part.{place}"), encoding="utf-8") as part:
                totals = re.search(r"^(?:totals|summary): (\d+)", part.read(), re.M)
            self.counts[int(row)] = int(totals[1]) / int(steps)

    def start(self, core):
        self.process = subprocess.Popen([*FIXED, "./compare", "serve"], cwd=self.folder, env=ENVIRONMENT, text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        if hasattr(os, "sched_setaffinity"):
            os.sched_setaffinity(self.process.pid, {core})

    def stop(self):
        self.process.stdin.close()
        self.process.stdout.close()
        self.process.wait()

    def ask(self, verb, row):
        self.process.stdin.write(f"{verb} {row}\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline().strip()
        if not answer:
            sys.exit(f"compare-with: the program of {self.name} ended at row {row}")
        return answer

    def open(self, row):
        answer = self.ask("open", row)
        if answer != "ok":
            self.refused[row] = answer.removeprefix("refused ")


class Row:
    def __init__(self, number, of_set, group, title):
        self.number, self.set, self.group, self.title = int(number), int(of_set), group, title
        self.turns = []  # pairs of ns
        self.instructions = None

    def time(self, side):
        fastest = sorted(self.turns, key=math.prod)[:len(self.turns) // 4]
        return statistics.median(pair[side] for pair in fastest)

    def ratio(self):
        return self.time(1) / self.time(0)

    def scatter(self):
        first, _, third = statistics.quantiles([b / a for a, b in self.turns])
        return (third - first) / 2


def take_turns(sides, rows):
    begin, turns = time.monotonic(), 0
    while turns < MOST_TURNS and (turns < LEAST_TURNS or time.monotonic() - begin < LONGEST * len(rows)):
        for row in rows:
            pair = [0, 0]
            for place in (0, 1) if turns % 2 else (1, 0):
                pair[place] = float(sides[place].ask("time", row.number))
            row.turns.append(pair)
        turns += 1


def time_set(sides, rows):
    """Sets the turns of the rows that no side refuses."""
    for start in range(STARTS):
        for side in sides:
            side.start(CORES[start % len(CORES)])
            for row in rows:
                side.open(row.number)
        served = [row for row in rows if not any(row.number in side.refused for side in sides)]
        if served:
            take_turns(sides, served)
        for side in sides:
            side.stop()


def duration(ns):
    return f"{ns:.0f} ns" if ns < 1e4 else f"{ns / 1e3:.1f} us" if ns < 1e6 else f"{ns / 1e3:.0f} us"


def mean(values):
    values = list(values)
    return math.exp(sum(map(math.log, values)) / len(values)) if values else math.nan


def number(value):
    return "-" if value is None or math.isnan(value) else f"{value:.3f}"


def say(what):
    print(f"compare-with: {what}", file=sys.stderr, flush=True)


def line(*cells):
    title, *others = cells
    print(f"{title:<{WIDTH}}" + "".join(f"{cell:>{CELL}}" for cell in others), flush=True)


def print_row(sides, row):
    refusals = [f"{side.name}: {side.refused[row.number]}" for side in sides if row.number in side.refused]
    for refusal in refusals:
        print(f"  {row.title:<{WIDTH - 2}}  refused by {refusal}", flush=True)
    if refusals:
        return
    counts = [side.counts.get(row.number) for side in sides]
    row.instructions = counts[1] / counts[0] if None not in counts else None
    line("  " + row.title, duration(row.time(0)), duration(row.time(1)), number(row.ratio()),
         f"{100 * row.scatter():.1f} %", number(row.instructions))


def print_mean(rows):
    timed = [row for row in rows if row.turns]
    if timed:
        line("  geometric mean", "", "", number(mean(row.ratio() for row in timed)),
             f"{100 * statistics.median(row.scatter() for row in timed):.1f} %",
             number(mean(row.instructions for row in timed if row.instructions)))


def print_ensembles(sides, rows):
    """Prints what an ensemble costs beside as many integrators, on each side."""
    sets = {}
    for row in rows:
        sets.setdefault(row.set, []).append(row)
    sets = [of_set for of_set in sets.values() if len(of_set) > 1 and of_set[0].turns]
    if not sets:
        return
    print("\nTime of an ensemble of 1000 members in one thread over that of 1000 integrators")
    line("", *(side.name for side in sides))
    for alone, *together in sets:
        for row in together:
            if row.turns:
                line("  " + row.title, *(number(row.time(side) / alone.time(side)) for side in (0, 1)))


def print_end(rows):
    timed = [row for row in rows if row.turns]
    counted = [row for row in timed if row.instructions]
    print()
    if timed:
        print(f"Times scatter by {100 * statistics.median(row.scatter() for row in timed):.1f} %, "
              f"at most {100 * max(row.scatter() for row in timed):.1f} %.")
    if counted:
        equal = sum(row.instructions == 1 for row in counted)
        print(f"Instructions are equal in {equal} of {len(counted)} rows.")
    if len(timed) < len(rows):
        print(f"{len(rows) - len(timed)} of {len(rows)} rows were refused.")


def main():
    sides = [Side(*sys.argv[1:3]), Side(*sys.argv[3:5])]
    pattern, isa = sys.argv[5:7]
    rows = sides[1].rows(pattern)
    if not rows:
        sys.exit(f"compare-with: no row is called {pattern}")
    counts = bool(shutil.which("valgrind"))
    with concurrent.futures.ThreadPoolExecutor() as pool:
        say("compiling systems")
        list(pool.map(lambda side: side.compile(pattern, {"", isa} if counts else {""}), sides))
        if counts:
            say("counting instructions")
            list(pool.map(lambda side: side.count(pattern, isa), sides))
        else:
            print("Without valgrind no instructions are counted.")
    line("a step", *(side.name for side in sides), "ratio", "scatter", "instructions")
    for group in dict.fromkeys(row.group for row in rows):
        print(group)
        of_group = [row for row in rows if row.group == group]
        for of_set in dict.fromkeys(row.set for row in of_group):
            in_set = [row for row in of_group if row.set == of_set]
            time_set(sides, in_set)
            for row in in_set:
                print_row(sides, row)
        print_mean(of_group)
    print_ensembles(sides, rows)
    print_end(rows)


main()
