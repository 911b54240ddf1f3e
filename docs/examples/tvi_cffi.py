"""The library from Python by cffi (python3-cffi), whose callbacks may return jets: potentials, and so the energy."""
import cffi

ffi = cffi.FFI()
ffi.cdef("""
    typedef struct { double number; void *node; } jet;
    jet jet_record_add(jet a, jet b);
    jet jet_record_sub(jet a, jet b);
    jet jet_record_mul(jet a, jet b);
    jet jet_record_div(jet a, jet b);
    jet jet_record_pow(jet a, double c);
    jet jet_record_function(int f, jet a);
    typedef struct tvi_system tvi_system;
    typedef struct tvi_integrator tvi_integrator;
    int tvi_system_potential(tvi_system **out, int n, const double mass[],
                             jet (*potential)(const jet q[], jet t, void *ctx), void *ctx);
    int tvi_energy(const tvi_system *system, double t, const double q[], const double p[], double *H);
    int tvi_integrator_create(tvi_integrator **out, const tvi_system *system, const void *options);
    int tvi_integrate(tvi_integrator *integrator, double h, long steps, double *t, double q[], double p[],
                      void *observer, void *ctx);
    void tvi_integrator_free(tvi_integrator *integrator);
    void tvi_system_free(tvi_system *system);
    const char *tvi_last_error(void);
""")
lib = ffi.dlopen("libtvi.so.0")


class Jet:
    """A jet of jet.h with operators."""

    def __init__(self, value):
        self.value = value if isinstance(value, ffi.CData) else ffi.new("jet *", [value, ffi.NULL])[0]

    __add__ = __radd__ = lambda a, b: record(lib.jet_record_add, a, b)
    __sub__ = lambda a, b: record(lib.jet_record_sub, a, b)
    __rsub__ = lambda a, b: record(lib.jet_record_sub, b, a)
    __mul__ = __rmul__ = lambda a, b: record(lib.jet_record_mul, a, b)
    __truediv__ = lambda a, b: record(lib.jet_record_div, a, b)
    __rtruediv__ = lambda a, b: record(lib.jet_record_div, b, a)
    __neg__ = lambda a: 0 - a
    __pow__ = lambda a, c: Jet(lib.jet_record_pow(a.value, c))


def jet(x):
    return x if isinstance(x, Jet) else Jet(x)


def record(operation, a, b):
    return Jet(operation(jet(a).value, jet(b).value))


def function(code):  # of the list in jet.h, from 0: neg, sqr, sqrt, exp, log, sin, cos, ...
    return lambda x: Jet(lib.jet_record_function(code, jet(x).value))


sqrt, exp, log, sin, cos = map(function, range(2, 7))


def check(status):
    if status != 0:
        raise RuntimeError(ffi.string(lib.tvi_last_error()).decode())


class Run:
    """A system of a potential, potential(q, t) -> jet, and its integrator; the masses are 1 unless they are given."""

    def __init__(self, n, potential, mass=None):
        made, thrown = ffi.new("tvi_system **"), []

        @ffi.callback("jet(const jet *, jet, void *)")
        def call(q, t, ctx):  # an exception must not cross the library: 1/0 is refused
            try:
                return jet(potential([Jet(q[i]) for i in range(n)], Jet(t))).value
            except Exception as error:
                thrown.append(error)
                return (jet(1) / 0).value
        status = lib.tvi_system_potential(made, n, mass or ffi.NULL, call, ffi.NULL)
        if thrown:
            raise thrown[0]
        check(status)
        self.system = ffi.gc(made[0], lib.tvi_system_free)
        made = ffi.new("tvi_integrator **")
        check(lib.tvi_integrator_create(made, self.system, ffi.NULL))
        self.integrator = ffi.gc(made[0], lib.tvi_integrator_free)

    def integrate(self, h, steps, t, q, p):
        """The state after so many steps."""
        t, q, p = ffi.new("double *", t), ffi.new("double[]", q), ffi.new("double[]", p)
        check(lib.tvi_integrate(self.integrator, h, steps, t, q, p, ffi.NULL, ffi.NULL))
        return t[0], list(q), list(p)

    def energy(self, t, q, p):
        H = ffi.new("double *")
        check(lib.tvi_energy(self.system, t, q, p, H))
        return H[0]
