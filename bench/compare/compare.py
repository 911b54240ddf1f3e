"""compare.py FOLDER NAME FOLDER NAME PATTERN COUNT_ISA: what the rows cost with two libraries.

Each folder has a program `compare` (compare.c), linked with one of the two. Both are open at the same time and take turns
of milliseconds on one core, so that what else the machine does meets both. They are started several times for each row,
since times also depend on the memory that a process gets, and on all cores in turn. A row's times are the least of its
turns, its scatter is half of the distance between the quartiles of the ratios of the pairs of turns. Instructions are
counted by callgrind with TVI_ISA=COUNT_ISA, in a process for each row. `make compare-with COMMIT=hash` calls it.
"""
import concurrent.futures
import itertools
import math
import os
import re
import shutil
import statistics
import subprocess
import sys

STARTS, TURNS = 4, 25  # of a row; of a start: with half as many the least still differ by some per cent
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

    def compile(self, row, isa):
        """Runs the row: generated code is then in the cache of the folder."""
        self.run(["count", str(row.number)], isa)

    def count(self, row, isa):
        """Sets counts[row] to the instructions of a step, unless the row is refused. What was counted with the same
        program is kept."""
        found = f"callgrind/{isa}-{row.number}"
        kept = os.path.join(self.folder, found + ".count")
        program = os.path.join(self.folder, "compare")
        if not os.path.exists(kept) or os.path.getmtime(kept) < os.path.getmtime(program):
            os.makedirs(os.path.join(self.folder, "callgrind"), exist_ok=True)
            steps = self.run(["count", str(row.number)], isa,
                             ["valgrind", "-q", "--tool=callgrind", f"--callgrind-out-file={found}",
                              "--toggle-collect=measured_run"])
            with open(os.path.join(self.folder, found), encoding="utf-8") as file:
                total = re.search(r"^totals: (\d+)", file.read(), re.M)[1]
            with open(kept, "w", encoding="utf-8") as file:
                file.write("" if "refused" in steps else f"{total} {steps}")
        with open(kept, encoding="utf-8") as file:
            counted = file.read().split()
        if counted:
            self.counts[row.number] = int(counted[0]) / int(counted[1])

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
        return min(pair[side] for pair in self.turns)

    def ratio(self):
        return self.time(1) / self.time(0)

    def scatter(self):
        first, _, third = statistics.quantiles([b / a for a, b in self.turns])
        return (third - first) / 2


def on_all_cores(work, *arguments):
    """Calls the function with all combinations of the arguments."""
    with concurrent.futures.ThreadPoolExecutor(len(CORES)) as pool:
        list(pool.map(lambda combination: work(*combination), itertools.product(*arguments)))


def by(rows, attribute):
    """Returns the rows for each value of an attribute, in their order."""
    found = {}
    for row in rows:
        found.setdefault(getattr(row, attribute), []).append(row)
    return found


def take_turns(sides, rows):
    for turn in range(TURNS):
        for row in rows:
            pair = [0, 0]
            for place in (0, 1) if turn % 2 else (1, 0):
                pair[place] = float(sides[place].ask("time", row.number))
            row.turns.append(pair)


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


def print_means(groups):
    print("\nGeometric means")
    for group, rows in groups.items():
        timed = [row for row in rows if row.turns]
        if timed:
            line("  " + group, "", "", number(mean(row.ratio() for row in timed)),
                 f"{100 * statistics.median(row.scatter() for row in timed):.1f} %",
                 number(mean(row.instructions for row in timed if row.instructions)))


def print_ensembles(sides, rows):
    """Prints what an ensemble costs beside as many integrators, on each side."""
    sets = [of_set for of_set in by(rows, "set").values() if len(of_set) > 1 and of_set[0].turns]
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
    say("compiling systems")
    on_all_cores(Side.compile, sides, rows, dict.fromkeys([os.environ.get("TVI_ISA", ""), isa]))
    say("counting instructions")
    on_all_cores(Side.count, sides, rows, [isa])
    line("a step", *(side.name for side in sides), "ratio", "scatter", "instructions")
    groups = by(rows, "group")
    for group, of_group in groups.items():
        print(group)
        for of_set in by(of_group, "set").values():
            time_set(sides, of_set)
            for row in of_set:
                print_row(sides, row)
    print_means(groups)
    print_ensembles(sides, rows)
    print_end(rows)


main()
