"""Finds and loads libtvi.so, and has what all calls of it share: errors, owned pointers, callbacks."""

from __future__ import annotations

import os
import signal
import threading
from pathlib import Path
from typing import Any, Callable

import cffi

from ._declarations import FUNCTIONS, STRUCTURES

__version__ = "0.2.0"
NAME = "libtvi.so.1"

ffi = cffi.FFI()
ffi.cdef(STRUCTURES + FUNCTIONS)


def _candidates() -> list[str]:
    """Where the library is looked for, in this order: TVI_LIBRARY alone; beside the module; where the loader looks."""
    named = os.environ.get("TVI_LIBRARY")
    if named:
        return [named if os.sep in named else os.path.join(os.curdir, named)]
    beside = Path(__file__).with_name(NAME)
    return [str(beside)] * beside.exists() + [NAME]


def _load() -> Any:
    tried = []
    for path in _candidates():
        try:
            library = ffi.dlopen(path)
        except OSError as error:
            tried.append(str(error))
            continue
        _require_version(library, path)
        return library
    raise ImportError("the library of the module tvi was not found. " + "; ".join(tried) + ". Make and install it "
                      "(make && make install && ldconfig), or let TVI_LIBRARY name the file, such as build/libtvi.so")


def _require_version(library: Any, path: str) -> None:
    """Refuses a library whose version or functions are others than those that are declared here."""
    try:
        version = ffi.string(library.tvi_version()).decode()
    except AttributeError:
        version = "an older one"
    if version != __version__:
        raise ImportError(f"{path} has version {version}, and the module tvi needs {__version__}: install both "
                          "from the same sources, or let TVI_LIBRARY name the library that belongs to the module")


lib = _load()

# ---- Errors ----------------------------------------------------------------------------------------------------------

STATUSES = ("OK", "EINVAL", "ENOMEM", "EDOMAIN", "ENOCONV", "ESINGULAR", "ENONFINITE", "ESTOPPED", "EUNSUPPORTED",
            "ETOOLARGE", "ECOMPILE", "EROUNDOFF")
OK, EINVAL, ENOMEM, ENOCONV, ESTOPPED, ETOOLARGE = 0, 1, 2, 4, 7, 9


class Error(RuntimeError):
    """Carries what the library refused: its text is that of tvi_last_error, and `status` the name of the status.

    >>> import tvi
    >>> try: tvi.Method("galerkin", 7)
    ... except tvi.Error as error: print(error.status, "-", error)
    EINVAL - galerkin has even orders from 2 to 20, not 7
    """

    def __init__(self, text: str, status: str = "EINVAL"):
        super().__init__(text)
        self.status = status

    def __reduce__(self) -> tuple:
        return type(self), (str(self), self.status)


class Interrupted(KeyboardInterrupt):
    """Ends a run in which Ctrl-C was pressed. Its `result` is what was reached: that of `tvi.solve` or of
    `tvi.ensemble`, and the integrator or ensemble itself for their own runs."""

    def __init__(self, text: str = "", result: Any = None):
        super().__init__(text)
        self.result = result


def text_of(status: int) -> str:
    """What was refused; to be asked in the thread of the call, before another one."""
    return ffi.string(lib.tvi_last_error()).decode() or ffi.string(lib.tvi_status_string(status)).decode()


def name_of(status: int) -> str:
    return STATUSES[status] if 0 <= status < len(STATUSES) else str(status)


def check(status: int, advice: str = "") -> None:
    """Raises what a status other than TVI_OK says, and the advice where a step was too large."""
    if status == ENOMEM:
        raise MemoryError(text_of(status))
    if status != OK:
        raise Error(text_of(status) + (advice if status in (ENOCONV, ETOOLARGE) else ""), name_of(status))


# ---- Pointers that are owned -----------------------------------------------------------------------------------------


class Handle:
    """A pointer of the library, which is freed when the last of its owners has let go.

    A system must outlive its integrators, also where the garbage collector takes them together in any order: each
    integrator is an owner of its system's handle. The methods of sets and lists used here are atomic."""

    def __init__(self, pointer: Any, free: Callable):
        self.pointer = pointer
        self._free = [free]
        self._owners: set[int] = set()

    def own(self, owner: object) -> "Handle":
        self._owners.add(id(owner))
        return self

    def release(self, owner: object) -> None:
        self._owners.discard(id(owner))
        if not self._owners and self._free:
            try:
                free = self._free.pop()
            except IndexError:
                return
            free(self.pointer)


def make(kind: str, create: Callable[[Any], int], guard: "Guard | None" = None) -> Any:
    """The pointer that create(out) makes; what a callback has raised comes out, and then nothing was made."""
    out = ffi.new(kind + " **")
    status = create(out)
    if guard and guard.thrown:
        if status == OK:
            getattr(lib, kind + "_free")(out[0])
        guard.reraise()
    check(status)
    return out[0]


# ---- Callbacks -------------------------------------------------------------------------------------------------------


class Guard:
    """Keeps what callbacks raise, as no exception may cross the library, and raises it after the call."""

    def __init__(self) -> None:
        self.thrown: BaseException | None = None

    def callback(self, kind: str, function: Callable, error: Any) -> Any:
        """The function for the library. Where it raises, the library gets the value `error`."""
        if error is None:
            return ffi.callback(kind, function, onerror=self._keep)
        return ffi.callback(kind, function, error=error, onerror=self._keep)

    def keep(self, thrown: BaseException) -> None:
        if self.thrown is None:
            self.thrown = thrown

    def _keep(self, kind: type, value: BaseException, traceback: Any) -> None:
        self.keep(value)

    def reraise(self) -> None:
        """Raises what was kept, once; the traceback is that of the callback."""
        thrown, self.thrown = self.thrown, None
        if thrown is not None:
            try:
                raise thrown
            finally:
                del thrown


def apart(call: Callable[[], Any], guard: "Guard | None" = None) -> Any:
    """The value of a call of the library that may take seconds, made on another thread: so Ctrl-C is heard at once.
    The call then goes on to its end by itself; what it refers to lives as long. With a guard, whose callbacks end the
    call once something is thrown, its end is waited for."""
    done: dict[str, Any] = {}

    def run() -> None:
        try:
            done["value"] = call()
        except BaseException as error:  # It is raised again in the thread that asked.
            done["error"] = error
        finally:
            ended.set()

    ended = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        return call()
    thread = threading.Thread(target=run, name="tvi")
    # A signal while the thread starts would leave the call to itself: it waits until its end is waited for, too.
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, signal.valid_signals())
    thread.start()
    is_ended = False
    while not is_ended:
        try:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
            ended.wait()  # An interrupted Thread.join loses the thread.
            is_ended = True
        except BaseException as error:
            if guard is None:
                raise
            guard.keep(error)
    if guard is not None:
        guard.reraise()
    if "error" in done:
        raise done["error"]
    return done["value"]
