"""The library from Python by ctypes, which is part of Python: jets with operators, systems of a force, integrators."""
import ctypes as C

lib = C.CDLL("libtvi.so.0")


class Jet(C.Structure):
    """As in jet.h: a number (node NULL), or a node of a recording. It is passed by value."""
    _fields_ = [("number", C.c_double), ("node", C.c_void_p)]

    __add__ = __radd__ = lambda a, b: record("add", a, b)
    __sub__ = lambda a, b: record("sub", a, b)
    __rsub__ = lambda a, b: record("sub", b, a)
    __mul__ = __rmul__ = lambda a, b: record("mul", a, b)
    __truediv__ = lambda a, b: record("div", a, b)
    __rtruediv__ = lambda a, b: record("div", b, a)
    __neg__ = lambda a: record("sub", 0, a)
    __pow__ = lambda a, c: lib.jet_record_pow(a, c)


def jet(x):
    return x if isinstance(x, Jet) else Jet(x, None)


def record(name, a, b):
    return getattr(lib, "jet_record_" + name)(jet(a), jet(b))


def function(code):  # of the list in jet.h, from 0: neg, sqr, sqrt, exp, log, sin, cos, ...
    return lambda x: lib.jet_record_function(code, jet(x))


sqrt, exp, log, sin, cos = map(function, range(2, 7))

doubles = C.POINTER(C.c_double)
FORCE = C.CFUNCTYPE(None, C.POINTER(Jet), Jet, C.POINTER(Jet), C.c_void_p)
for name in "add", "sub", "mul", "div":
    getattr(lib, "jet_record_" + name).argtypes = [Jet, Jet]
    getattr(lib, "jet_record_" + name).restype = Jet
lib.jet_record_pow.argtypes, lib.jet_record_pow.restype = [Jet, C.c_double], Jet
lib.jet_record_function.argtypes, lib.jet_record_function.restype = [C.c_int, Jet], Jet
lib.tvi_last_error.restype = C.c_char_p
lib.tvi_system_force.argtypes = [C.POINTER(C.c_void_p), C.c_int, doubles, FORCE, C.c_void_p]
lib.tvi_integrator_create.argtypes = [C.POINTER(C.c_void_p), C.c_void_p, C.c_void_p]
lib.tvi_integrate.argtypes = [C.c_void_p, C.c_double, C.c_long, doubles, doubles, doubles, C.c_void_p, C.c_void_p]
lib.tvi_integrator_free.argtypes = lib.tvi_system_free.argtypes = [C.c_void_p]


def check(status):
    if status != 0:
        raise RuntimeError(lib.tvi_last_error().decode())


class Run:
    """A system of a force, force(q, t) -> [n] jets, and its integrator; the masses are 1 unless they are given."""

    def __init__(self, n, force, mass=None):
        self.system, self.integrator, thrown = C.c_void_p(), C.c_void_p(), []

        def call(q, t, out, ctx):  # an exception must not cross the library: the outputs that are not set refuse
            try:
                for i, component in enumerate(force(q[:n], t)):
                    out[i] = jet(component)
            except Exception as error:
                thrown.append(error)
        status = lib.tvi_system_force(self.system, n, (C.c_double * n)(*mass) if mass else None, FORCE(call), None)
        if thrown:
            raise thrown[0]
        check(status)
        check(lib.tvi_integrator_create(self.integrator, self.system, None))

    def integrate(self, h, steps, t, q, p):
        """The state after so many steps."""
        t, q, p = C.c_double(t), (C.c_double * len(q))(*q), (C.c_double * len(p))(*p)
        check(lib.tvi_integrate(self.integrator, h, steps, t, q, p, None, None))
        return t.value, list(q), list(p)

    def __del__(self):
        lib.tvi_integrator_free(self.integrator)
        lib.tvi_system_free(self.system)
