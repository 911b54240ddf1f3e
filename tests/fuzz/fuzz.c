#include "fuzz.h"
#include "world.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- Bytes ------------------------------------------------------------------------------------------------------- */

int byte(bytes *b)
{
    if (b->left == 0) return 0;
    b->left--;
    return *b->data++;
}

int below(bytes *b, int count) { return byte(b) % count; }

double number(bytes *b)
{
    static const double extreme[] = {0,     1,    -1,       2,         0.5,         -0.5,   1e-300,   1e300,
                                     1e-12, 1e12, INFINITY, -INFINITY, (double)NAN, 5e-324, -1.7e308, 1e-8};
    const int first = byte(b);
    if (first % 16 == 15) return extreme[first / 16];
    return (first - 128) / 32.0 + byte(b) / 8192.0;
}

int integer(bytes *b, int usual)
{
    static const int odd[] = {-1, -2, INT_MIN, INT_MAX, 1000, 101};
    const int first = byte(b);
    return first >= 248 ? odd[first % 6] : first % usual;
}

/* ---- Functions --------------------------------------------------------------------------------------------------- */

enum { OPERATIONS = 24, POOL = 2 * N_MAX + 1 + OPERATIONS };

static jet operation(bytes *b, const jet pool[], int count)
{
    enum { FUNCTIONS = JET_FUNCTION_COUNT, ALL = FUNCTIONS + JET_FUNCTION2_COUNT, OTHERS = 10 };
    const int op = below(b, ALL + OTHERS);
    const jet x = pool[below(b, count)], y = pool[below(b, count)];
    if (op < FUNCTIONS) return jet_record_function((jet_function)op, x);
    if (op < ALL) return jet_record_function2((jet_function2)(op - FUNCTIONS), x, y);
    switch (op - ALL) {
    case 0: return jet_add(x, y);
    case 1: return jet_sub(x, y);
    case 2: return jet_div(x, y);
    case 3: return jet_pow(x, number(b));
    case 4: return jet_const(number(b));
    case 5: return jet_sum(pool, count);
    case 6: return jet_dot(pool, pool + count / 2, count / 2);
    case 7: return jet_mul(number(b), x);
    case 8: return jet_add(number(b), x);
    default: return jet_mul(x, y);
    }
}

/* Operations on q, r (NULL: none) and t. */
static int record(const recorder *f, const jet q[], const jet r[], jet t, jet pool[POOL])
{
    int count = 0;
    for (int i = 0; i < f->n; i++) pool[count++] = q[i];
    for (int i = 0; r && i < f->n; i++) pool[count++] = r[i];
    pool[count++] = t;
    for (int left = below(f->b, OPERATIONS); left > 0; left--) {
        pool[count] = operation(f->b, pool, count);
        count++;
    }
    return count;
}

static void force(const jet q[], jet t, jet F[], void *ctx)
{
    const recorder *f = ctx;
    jet pool[POOL];
    const int count = record(f, q, NULL, t, pool);
    for (int i = 0; i < f->n; i++) F[i] = pool[below(f->b, count)];
}

static jet potential(const jet q[], jet t, void *ctx) { return scalar_of(ctx, q, NULL, t); }

jet scalar_of(const recorder *f, const jet q[], const jet r[], jet t)
{
    jet pool[POOL];
    const int count = record(f, q, r, t, pool);
    return pool[count - 1];
}

/* r^2 / 2 is added mostly, so that many of them are regular. */
static jet two_arguments(const jet q[], const jet r[], jet t, void *ctx)
{
    const recorder *f = ctx;
    const jet scalar = scalar_of(f, q, r, t);
    return below(f->b, 8) == 0 ? scalar : jet_add(scalar, jet_mul(0.5, jet_dot(r, r, f->n)));
}

static jet time_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    const recorder *f = ctx;
    const jet scalar = scalar_of(f, q, p, t);
    return below(f->b, 4) ? jet_exp(jet_mul(0.25, scalar)) : scalar;
}

static tvi_status make_base(recorder f, tvi_system **system)
{
    bytes *b = f.b;
    double mass[N_MAX];
    const int form = below(b, 4), own = below(b, 4);
    for (int i = 0; i < N_MAX; i++) mass[i] = own ? 1 + i / 3.0 : number(b);
    switch (form) {
    case 0: return tvi_system_force(system, f.n, own == 1 ? NULL : mass, force, &f);
    case 1: return tvi_system_potential(system, f.n, own == 1 ? NULL : mass, potential, &f);
    case 2: return tvi_system_lagrangian(system, f.n, two_arguments, &f);
    default: return tvi_system_hamiltonian(system, f.n, two_arguments, &f);
    }
}

/* One in four with steps that adapt. */
static tvi_status make_system(bytes *b, tvi_system **system, world *w)
{
    tvi_system *base;
    recorder f = {b, w->n = 1 + below(b, N_MAX)};
    tvi_status status = make_base(f, &base);
    *system = base;
    w->adapts = base && below(b, 4) == 0;
    if (!w->adapts) return status;
    status = tvi_system_rescaled(system, base, below(b, 2) ? time_scale : NULL, &f);
    tvi_system_free(base);
    return status;
}

/* ---- Options ----------------------------------------------------------------------------------------------------- */

static tvi_options make_options(bytes *b)
{
    static const char *const names[] = {"tvi",    "htvi-right", "htvi-left", "svhd",      "symmetric-tvi",
                                        "start",  "end",        "midpoint",  "both-ends", "right",
                                        "left",   "poincare",   "galerkin",  "taylor",    "stormer-verlet",
                                        "nothing"};
    tvi_options o = tvi_options_default();
    if (below(b, 4)) {
        const char *name = names[below(b, 16)];
        if (tvi_options_named(name, integer(b, 13), &o) != TVI_OK) o.degree = integer(b, 7);
    } else {
        o = (tvi_options){.method = (tvi_method)integer(b, 7),
                          .expansion = (tvi_expansion)integer(b, 6),
                          .nodes = (tvi_nodes)integer(b, 3),
                          .order = integer(b, 13),
                          .degree = integer(b, 9),
                          .quadrature = (tvi_quadrature)integer(b, 7),
                          .quadrature_points = integer(b, 12)};
        o.compose_adjoint = below(b, 2);
    }
    if (below(b, 4) == 0) {
        static const int passes[] = {0, 1, 3, TVI_PREDICT_ONLY, -2, INT_MIN}, most[] = {0, 1, 5, 50, -1};
        o.tolerance = below(b, 2) ? number(b) : 1e-8;
        o.passes = passes[below(b, 6)];
        o.max_passes = most[below(b, 5)];
    }
    if (below(b, 4) == 0) o.max_tail = number(b);
    return o;
}

/* ---- Calls ------------------------------------------------------------------------------------------------------- */

void insist(bool good, const char *what)
{
    if (good) return;
    fprintf(stderr, "fuzz: %s\n", what);
    abort();
}

bool finite_all(int count, const double x[])
{
    for (int i = 0; i < count; i++)
        if (!isfinite(x[i])) return false;
    return true;
}

void expect_status(tvi_status status) { insist(status >= TVI_OK && status < TVI_STATUS_COUNT, "no such status"); }

static bool finite_state(const world *w, const state *x)
{
    return isfinite(x->t) && finite_all(w->n, x->q) && finite_all(w->n, x->p);
}

/* After a call that changes before into after: unchanged, or finite. */
static void expect_state(const world *w, tvi_status status, const state *before, const state *after, const char *what)
{
    expect_status(status);
    insist(status == TVI_OK || memcmp(before, after, sizeof *before) == 0, what);
    insist(status != TVI_OK || finite_state(w, after), what);
}

void expect_end(const world *w, tvi_status status, const state *before, const char *what)
{
    expect_status(status);
    insist(memcmp(before, &w->x, sizeof *before) == 0 || (status != TVI_EINVAL && finite_state(w, &w->x)), what);
}

double step_size(bytes *b)
{
    static const double odd[] = {1e-300, 1e300, 0, (double)NAN, INFINITY, 1e-17, 100, -1e6};
    const int first = byte(b);
    return first < 64 ? odd[first % 8] : (first - 160) / 256.0;
}

static void make_state(bytes *b, world *w)
{
    memset(&w->x, 0, sizeof w->x);
    w->x.t = number(b);
    for (int i = 0; i < w->n; i++) w->x.q[i] = number(b), w->x.p[i] = number(b);
}

static void step(bytes *b, world *w)
{
    const state before = w->x;
    const tvi_status status = tvi_step(w->integrator, step_size(b), &w->x.t, w->x.q, w->x.p);
    expect_state(w, status, &before, &w->x, "step");
    w->steps += status == TVI_OK;
}

static void dense(bytes *b, world *w)
{
    const state before = {0};
    state at = before;
    expect_state(w, tvi_dense(w->integrator, byte(b) / 255.0, at.q, at.p), &before, &at, "dense");
    at = before;
    expect_state(w, tvi_dense(w->integrator, number(b), at.q, at.p), &before, &at, "dense anywhere");
}

uint8_t *saved_state(const world *w, size_t *size)
{
    insist(tvi_state_save(w->integrator, NULL, size) == TVI_OK, "size of a saved state");
    uint8_t *saved = malloc(*size);
    insist(saved && tvi_state_save(w->integrator, saved, size) == TVI_OK, "save");
    return saved;
}

/* Whole or damaged. */
static void save_and_load(bytes *b, world *w)
{
    size_t size;
    uint8_t *saved = saved_state(w, &size);
    const bool damaged = below(b, 2);
    if (damaged) saved[(size_t)byte(b) * 7919 % size] ^= (uint8_t)(1 << below(b, 8));
    const size_t cut = below(b, 8) == 0 ? (size_t)byte(b) % size : size;
    const tvi_status status = tvi_state_load(w->integrator, saved, cut);
    insist(status == (damaged || cut < size ? TVI_EINVAL : TVI_OK), "load");
    free(saved);
}

static int stop_at(long number_of_step, double t, const double q[], const double p[], void *ctx)
{
    const world *w = ctx;
    insist(isfinite(t) && finite_all(w->n, q) && finite_all(w->n, p), "what an observer sees");
    return number_of_step == 5;
}

static void integrate(bytes *b, world *w)
{
    const state before = w->x;
    const int steps = below(b, 8) - 1;
    const double h = step_size(b);
    tvi_progress_bar bar = {.steps = integer(b, 8), .observer = stop_at, .ctx = w};
    const bool shown = below(b, 2) && !isatty(STDERR_FILENO);
    const tvi_status status = tvi_integrate(w->integrator, h, steps, &w->x.t, w->x.q, w->x.p,
                                            shown ? tvi_progress : stop_at, shown ? (void *)&bar : w);
    expect_end(w, status, &before, "integrate");
}

static void integrate_to(bytes *b, world *w)
{
    const state before = w->x;
    const double h = step_size(b), t_end = w->x.t + (below(b, 8) ? h * number(b) : number(b));
    expect_end(w, tvi_integrate_to(w->integrator, h, t_end, &w->x.t, w->x.q, w->x.p, stop_at, w), &before,
               "integrate to");
}

static void integrate_tolerance(bytes *b, world *w)
{
    const state before = w->x;
    const double tolerance = below(b, 4) ? exp(-byte(b) / 8.0) : number(b), t_end = w->x.t + number(b);
    const tvi_status status =
        tvi_integrate_tolerance(w->integrator, tolerance, t_end, &w->x.t, w->x.q, w->x.p, stop_at, w);
    expect_end(w, status, &before, "integrate to a tolerance");
    insist(status != TVI_OK || w->x.t == t_end, "the end of a run to a tolerance");
}

static void step_tangent(bytes *b, world *w)
{
    double D[2 * N_MAX * 3], before_D[2 * N_MAX * 3];
    const int columns = below(b, 4);
    for (int i = 0; i < 2 * N_MAX * 3; i++) D[i] = i % 7 == 0;
    if (below(b, 8) == 0) D[0] = number(b);
    memcpy(before_D, D, sizeof D);
    const state before = w->x;
    const tvi_status status = tvi_step_tangent(w->integrator, step_size(b), &w->x.t, w->x.q, w->x.p, D, columns);
    expect_state(w, status, &before, &w->x, "step with tangents");
    insist(status == TVI_OK ? finite_all(2 * w->n * columns, D) : memcmp(D, before_D, sizeof D) == 0, "tangents");
}

static void ask_system(bytes *b, world *w)
{
    (void)b;
    state before = w->x, out = before;
    double H = 42;
    tvi_status status = tvi_energy(w->system, w->x.t, w->x.q, w->x.p, &H);
    expect_status(status);
    insist(status == TVI_OK ? isfinite(H) : H == 42, "energy");
    status = tvi_momentum(w->system, w->x.t, w->x.q, w->x.p, out.p);
    insist(status == TVI_OK ? finite_all(w->n, out.p) : memcmp(&before, &out, sizeof out) == 0, "momentum");
    out = before;
    status = tvi_velocity(w->system, w->x.t, w->x.q, w->x.p, out.p);
    insist(status == TVI_OK ? finite_all(w->n, out.p) : memcmp(&before, &out, sizeof out) == 0, "velocity");
}

static void last_state(bytes *b, world *w)
{
    (void)b;
    const state before = w->x;
    state at = before;
    expect_state(w, tvi_state_last(w->integrator, &at.t, at.q, at.p), &before, &at, "last state");
}

static void reset(bytes *b, world *w)
{
    (void)b;
    tvi_integrator_reset(w->integrator);
}

typedef void call(bytes *b, world *w);
static call *const calls[] = {
    step,       step,       step,  dense,      save_and_load, integrate,    integrate_events,   step_tangent,
    ask_system, last_state, reset, make_state, integrate_at,  integrate_to, integrate_tolerance};
enum { CALLS = sizeof calls / sizeof *calls, CALLS_MOST = 16 };

long fuzz_one(const uint8_t data[], size_t size)
{
    bytes b = {data, size};
    tvi_system *system = NULL;
    world w = {0};
    const tvi_status made = make_system(&b, &system, &w);
    expect_status(made);
    insist((made == TVI_OK) == (system != NULL), "a system and its status");
    if (!system) return 0;
    const tvi_options options = make_options(&b);
    const char *why = NULL;
    const tvi_status fits = tvi_options_check(system, &options, &why);
    insist(fits == TVI_OK || (why && *why), "a refusal says why");
    const tvi_status status = tvi_integrator_create(&w.integrator, system, &options);
    insist(status == fits && (status == TVI_OK) == (w.integrator != NULL), "an integrator and its status");
    w.system = system;
    if (w.integrator) make_state(&b, &w);
    for (int left = w.integrator ? CALLS_MOST : 0; left > 0 && b.left > 0; left--) calls[below(&b, CALLS)](&b, &w);
    tvi_integrator_free(w.integrator);
    tvi_system_free(system);
    return w.steps;
}
