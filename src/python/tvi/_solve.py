"""tvi.solve: a run of one orbit, and all that it gives."""

from __future__ import annotations

import math
import os
import shutil
from typing import Any, Callable

import numpy as np

from ._arguments import answered, start_of_one
from ._arrays import Array, copied, fraction, numbers, step_size
from ._events import Recorded, events_of, found
from ._gradient import Record, check_arguments, integrands_of, record_size
from ._integrator import Integrator
from ._jacobian import Columns, require_steps
from ._library import Error, Interrupted
from ._methods import Compiled, Method, compile, measured_step, method_to
from ._recorder import ROWS, Progress, Recorder
from ._result import Result
from ._runs import Way
from ._solution import Dense, Solution
from ._systems import System, required_system

GAINS_FROM = 1e8  # steps times n, of "galerkin": some ten seconds, of which compiling takes five and saves half
WEIGHT = {"galerkin": 1, "stormer-verlet": 0.3, "taylor": 2}  # of a step, relative to "galerkin"; others: 10


class Run:
    """One call of tvi.solve, in its parts."""

    def __init__(self, integrator: Integrator, result: Result, way: dict[str, Any], t_end: float, progress: Any):
        self.integrator, self.result, self.way, self.t_end = integrator, result, way, t_end
        self.progress = Progress(progress, integrator.t, t_end)
        self.told: list[tuple] = []
        self.recorder: Recorder | None = None
        self.columns: Columns | None = None

    def record(self, steps: float) -> None:
        it = self.integrator
        self.recorder = Recorder(it.system.n, it.t, it.q, it.p, max(1, math.ceil(steps / ROWS)))

    def go(self, events: list, t_eval: np.ndarray | None) -> None:
        it, recorder = self.integrator, self.recorder
        recorded = Recorded(it.system, events)
        functions: dict[str, Any] = {}
        if events:
            functions["on_event"] = lambda member, which, t, q, p: self.told.append((which, member, t, q, p))
        times = dense = None
        if t_eval is not None and "h" in self.way:
            times, rows = t_eval, []
            functions["at_time"] = lambda member, which, t, q, p: self._tell(rows, t, q, p)
        elif t_eval is not None:
            dense = Dense(it, t_eval)
            dense.start()
            rows = dense.rows
        way = Way(self.way.get("h"), None, self.t_end, times, self.way.get("tolerance"), self.way.get("largest_step"))
        in_pieces = recorder is not None and it._is_counted(way) and times is None and not events
        after_step = self._after_step(None if in_pieces else recorder, dense)
        cuts = {"every": recorder.every} if in_pieces else {}
        try:
            first = 0
            cuts["after"] = self._after(recorder if in_pieces else None)
            while not self._went(way, recorded, functions, after_step, cuts, rows if t_eval is not None else []):
                if dense:
                    dense.at_event(self.way)
                if self._call_back(events, first):
                    self.result.status = 1
                    break
                first = len(self.told)
                if dense:
                    dense.go_on()
                if times is not None:
                    way.times = times[len(rows):]
        except Error as error:
            if it.system.constraints and it.stats.steps == 0 and error.status in ("EINVAL", "ESINGULAR"):
                raise  # The constraints refuse the start.
            self.result.status, self.result.message = -1, f"a step was refused at t = {it.t}: {error}."
        except MemoryError as error:
            if "the record is full" not in str(error):
                raise
            self.result.status = -1
            self.result.message = f"the run ended at t = {it.t}: {error}: give more as gradient=."
        except KeyboardInterrupt:
            self.result.status, self.result.message = -2, f"interrupted at t = {it.t}"
            raise
        finally:
            self._keep(rows if t_eval is not None else None, len(events))

    def _tell(self, rows: list, t: float, q: np.ndarray, p: np.ndarray) -> None:
        rows.append((t, q, p))
        if self.columns is not None:
            self.columns.keep()

    def _went(self, way: Way, recorded: Recorded, functions: dict[str, Any], after_step: Callable | None,
              cuts: dict[str, Any], rows: list) -> bool:
        """Whether the run went to its end. If its system has no columns at once, it is made anew with each alone."""
        try:
            return self.integrator._go(way, recorded, functions, after_step, **cuts)
        except Error as error:
            if self.columns is None or not self.columns.alone(error):
                raise
        rows.clear()
        return self.integrator._go(way, recorded, functions, after_step, **cuts)

    def _call_back(self, events: list, first: int) -> bool:
        """The callbacks of the events that stopped the run, which were told from the first on, change p; whether the
        run ends here."""
        it, is_ended = self.integrator, False
        called = [which for which, *_ in self.told[first:] if events[which].terminal or events[which].callback]
        for which in called:
            is_ended |= events[which].terminal
            if events[which].callback:
                if self.recorder is not None:
                    self.recorder.keep(it.t, it.q, it.p)
                try:
                    p = events[which].callback(it.t, it.q.copy(), it.p.copy())
                except StopIteration:
                    p, is_ended = None, True
                if p is not None:
                    it.p = numbers(f"what the callback of event {which} returned", p, it.system.n)
                if self.recorder is not None:
                    self.recorder.start(it.t, it.q, it.p)
        return is_ended or not called

    def _after_step(self, recorder: Recorder | None, dense: Dense | None) -> Callable | None:
        if recorder is None and dense is None:
            return None
        told = [recorder.after_step] if recorder else []
        if dense:
            n = self.integrator.system.n
            told.append(lambda t, q, p: dense.at_step(0, t, copied(q, n), copied(p, n)))
        progress = self.progress

        def after_step(t: float, q: Any, p: Any) -> None:
            for tell in told:
                tell(t, q, p)
            progress.at(t)

        return after_step

    def _after(self, recorder: Recorder | None) -> Callable:
        it, progress = self.integrator, self.progress

        def after(steps: int) -> None:
            if recorder is not None and steps % recorder.every == 0:
                recorder.keep(it.t, it.q, it.p)
            progress.at(it.t)

        return after

    def _keep(self, rows: list | None, count: int) -> None:
        """Puts what was reached into the result, however the run ended."""
        it, result, n = self.integrator, self.result, self.integrator.system.n
        self.progress.end(it.t)
        if self.recorder is not None:
            self.recorder.keep(it.t, it.q, it.p)
            states = recorded = self.recorder.arrays()
        if rows is not None:
            states = (np.array([row[0] for row in rows], dtype=float),
                      *(np.array([row[i] for row in rows], dtype=float).reshape(-1, n) for i in (1, 2)))
        result.t, result.q, result.p = states
        result.events = found(self.told, n, count)
        result._event_order, result._is_at_times = [told[0] for told in self.told], rows is not None
        result.t_end, result.q_end, result.p_end = it.t, it.q.copy(), it.p.copy()
        result.by = None if self.columns is None else self.columns.end()
        result.stats = it.stats
        if self.recorder is not None:
            result.sol = Solution(it, self.way, recorded, result.t_end)


@answered
def solve(system: System, t_span: Array, q0: Array, p0: Array = None, v0: Array = None, h: float | None = None,
          error: float | None = None, tolerance: float | None = None, largest_step: float | None = None,
          method: "str | Method" = "galerkin", order: int = 16, t_eval: Array = None, events: Any = (),
          dense_output: bool = False, compiled: "bool | str | Compiled" = "auto", progress: "bool | Callable" = False,
          gradient: "bool | int" = False, integrals: Any = (), jacobian: "str | list[str] | None" = None,
          **parameters: Any) -> Result:
    """A run from t_span[0] to t_span[1], either way, from q0 [n], and p0 or v0 [n], one of them; 0: at rest.

    The step: h (of a rescaled system in s); or error, the wanted error of the state at the end, for which h is chosen
    by tvi.suggest_step, whose whole runs cost 3 to 6 times a long run itself (Result.error is what they measured); or
    tolerance, with "taylor", of the order that suits it unless method="taylor" names one. None of them: error=1e-9, or
    the smallest that roundoff allows. largest_step, with error or tolerance, bounds the steps, for what is too short to
    be seen between them, as a push in time. A run with callbacks of events has no error=: give h or a tolerance.

    t_eval [k]: the times of the result, in the order of the run; None: the states after all steps, or in a run of
    more than 10000 steps after every k-th. events: tvi.event, or functions g(q, p) or g(q, p, t), one or a list.
    dense_output: the result has sol(t). compiled: False; True; what tvi.compile made; "auto": compiled where there is
    a compiler and so many steps are made that it gains (steps times n from 1e8 on). progress: True draws a bar on a
    terminal; a function is called with t and the part that is done. gradient: True, or the bytes that its memory may
    take: the result has gradient(), with h and "galerkin" or "stormer-verlet" alone. integrals: functions l(q, p) or
    l(q, p, t) whose integrals over the time the result has as `integrals`, with h and "galerkin". jacobian, with h and
    t_eval: names of parameters, "q0", and "p0" or "v0", whichever was given; the result's by.k [time, 2n, ...] then is
    the derivative of q and p at these times by k, exact for the steps that were made. parameters: values of those of
    the system.

    A step that is refused ends the run: status -1, with the text of tvi_last_error in the message, and what was
    reached. Raises tvi.Error where there is no run at all, as for a method that does not serve the system, an error
    below roundoff, or a start that is not on the constraints; ValueError and TypeError for arguments; on Ctrl-C
    tvi.Interrupted, whose `result` has what was reached.

    >>> import numpy as np, tvi
    >>> kepler = tvi.potential(2, lambda q: -1 / np.sqrt(q @ q))
    >>> orbit = tvi.solve(kepler, (0, 4000), [1, 0], [0, 0.8], error=1e-8, t_eval=[0, 4000])
    >>> print(orbit.status, orbit.q[-1].round(6), orbit.error < 1e-8)
    0 [ 0.256821 -0.685955] True
    """
    t, t_end = span_of(system, t_span)
    is_default = h is None and error is None and tolerance is None
    several = events_of(events, may_call=True)
    has_callbacks = any(one.callback for one in several)
    require_steps(jacobian, h, t_eval)
    if jacobian is not None and has_callbacks:
        raise TypeError("jacobian does not go with callbacks that change p")
    if h is None and tolerance is None and has_callbacks:
        raise TypeError("give h or a tolerance: an error at the end is measured by runs without callbacks")
    h, error, tolerance = steps_of(system, t_end - t, h, error, tolerance, largest_step)
    times = _times(t_eval, t, t_end)
    method = method_to(tolerance, system, method, order)
    integrals = integrands_of(integrals)
    if gradient or integrals:
        check_arguments(system, h is not None, v0, has_callbacks)
    q0, p0, v0 = start_of_one("q0 p0 v0", system, q0, p0, v0)
    it = Integrator(system, q0, p0, v=v0, t=t, method=method, **parameters)
    measured, steps = None, math.nan
    if tolerance is None:
        if h is None:
            h, measured = 1.0, 0.0
            if t != t_end:
                recorded = system.recorded_with(parameters)
                h, measured, refusal = measured_step(recorded, t, it.q, it.p, t_end - t, error, method,
                                                     Recorded(recorded, several), largest_step)
                if refusal and not is_default:
                    raise refusal
        steps = expected_steps(it, h, t_end)
    if code := code_of(compiled, system, method, steps):
        it = Integrator(system, it.q, it.p, t=t, method=method, compiled=code, **parameters)
    columns = None if jacobian is None else Columns(it, jacobian, v0 is not None)
    way = {"h": h} if tolerance is None else {"tolerance": tolerance, "largest_step": largest_step}
    result = Result(it, way, h or math.nan, measured)
    result._callbacks = [one for one in several if one.callback]
    if gradient or integrals:
        it._record = result._record = Record(it, record_size(gradient), integrals)
    run = Run(it, result, way, t_end, progress)
    run.columns = columns
    if times is None or dense_output:
        run.record(1 if math.isnan(steps) or system.is_rescaled else steps)
    try:
        run.go(several, times)
    except Interrupted:
        raise Interrupted(result.message, result) from None
    finally:
        it._record = None
        if not dense_output:
            result.sol = None
    result.message = (result.message or _message(result, several)) + _what_was_measured(result)
    return result


def span_of(system: System, t_span: Array) -> tuple[float, float]:
    """t and t_end."""
    required_system(system)
    t, t_end = numbers("t_span", t_span, 2, hint="it is (t, t_end), and stands before q0")
    return float(t), float(t_end)


def steps_of(system: System, duration: float, h: Any, error: Any, tolerance: Any, largest_step: Any) -> tuple:
    """Of h, error and tolerance the one that is given, as a number; the others are None. None is given: an error of
    1e-9."""
    given = [x is not None for x in (h, error, tolerance)]
    if sum(given) > 1:
        raise TypeError("give h, error or tolerance, one of them")
    if h is not None and largest_step is not None:
        raise TypeError("largest_step is for error= and tolerance=: h is the step itself")
    if h is not None:
        h = step_of(system, duration, h)
    error = fraction("error", error) if error is not None else None if any(given) else 1e-9
    return h, error, None if tolerance is None else fraction("tolerance", tolerance)


def step_of(system: System, duration: float, h: Any) -> float:
    """h as a number, with the sign of the duration. Of a rescaled system h is in s."""
    return math.copysign(step_size("h", h, 0.0 if system.is_rescaled else duration), duration)


def _times(t_eval: Array, t: float, t_end: float) -> np.ndarray | None:
    if t_eval is None:
        return None
    times = numbers("t_eval", t_eval, None)
    along = times if t_end >= t else -times
    first, last = (t, t_end) if t_end >= t else (-t, -t_end)
    if np.any(np.diff(along) < 0) or len(times) and (along[0] < first or along[-1] > last):
        raise ValueError(f"t_eval is not in order from {t} to {t_end}")
    return times


def expected_steps(it: Integrator, h: float, t_end: float) -> float:
    """How many steps lead to t_end; of a rescaled system as a trial of some steps has it, whatever these cost."""
    if not it.system.is_rescaled:
        return abs((t_end - it.t) / h)
    trial = Integrator(it.system, it.q, it.p, t=it.t, method=it.method, **it.parameters)
    try:
        trial.integrate(h, 64)
    except Error:  # The run itself will say so.
        return math.nan
    return 64 * abs((t_end - it.t) / (trial.t - it.t)) if trial.t != it.t else math.nan


def code_of(compiled: Any, system: System, method: Method, steps: float) -> "bool | Compiled":
    """Whether a run of so many steps is compiled. The clock is not asked: runs have the same bits each time."""
    if compiled != "auto":
        return compiled
    compiler = os.environ.get("CC", "").split() or ["cc"]
    gains = steps * system.n * WEIGHT.get(method.name, 10) >= GAINS_FROM  # never where the steps are not known: nan
    if not gains or not shutil.which(compiler[0]):
        return False
    try:
        return compile(system, method)
    except Error:
        return False


def _message(result: Result, events: list) -> str:
    """How the run ended, and what may be doubted."""
    if result.status == 1:
        ending = [i for i, one in enumerate(events) if (one.terminal or one.callback) and len(result.events[i].t)
                  and result.events[i].t[-1] == result.t_end]
        text = f"event {ending[0]} ended the run at t = {result.t_end}."
    else:
        text = f"the end was reached, t = {result.t_end}."
    tail = result.stats.largest_tail
    if tail > 0.01 and not result.error:  # An error that was measured says more.
        doubt = "is" if tail > 0.1 else "may be"
        text += f" The step {doubt} too large: its tail is {tail:.1g}; 0.01 or less is right."
    return text


def _what_was_measured(result: Result) -> str:
    return f" The error at the end was measured: {result.error:.1e}." if result.error else ""
