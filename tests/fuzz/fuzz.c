/* fuzz.c - Makes a program that uses the library from a sequence of bytes (fuzz.h). */
#include "fuzz.h"
#include "world.h"
#include "problems/texts.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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

char *saved_state(const world *w, size_t *size)
{
    *size = 0;
    if (!isfinite(w->x.t) || !finite_all(w->n, w->x.q) || !finite_all(w->n, w->x.p)) return NULL;
    char *saved = text_of_state(w->integrator, w->x.t, w->x.q, w->x.p);
    *size = strlen(saved);
    return saved;
}

/* Whole or damaged. */
static void save_and_load(bytes *b, world *w)
{
    size_t size;
    state at = w->x;
    char *saved = saved_state(w, &size);
    insist(saved || tvi_state_to_text(w->integrator, at.t, at.q, at.p, NULL, &size) == TVI_ENONFINITE, "no text");
    if (!saved) return;
    const bool damaged = below(b, 2);
    char *const one = &saved[(size_t)byte(b) * 7919 % size], before = *one;
    if (damaged) *one = (char)((uint8_t)*one ^ 1 << below(b, 8));
    const bool is_blank =
        *one && strchr(" \t\r\n", *one) && strchr(" \n", before); /* which may stand for another one */
    const size_t cut = below(b, 8) == 0 ? (size_t)byte(b) % size : size;
    double H; /* which a rescaled system needs */
    const tvi_status whole = w->adapts ? tvi_integrator_energy(w->integrator, at.t, at.q, at.p, &H) : TVI_OK;
    const tvi_status status = tvi_state_from_text(w->integrator, saved, cut, &at.t, at.q, at.p);
    const bool is_refused = (damaged && !is_blank && one < saved + cut) || cut < size - 1;
    insist(status == (is_refused ? TVI_EINVAL : whole), "load");
    insist(memcmp(&at, &w->x, sizeof at) == 0, "the state that was loaded");
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
    enum { ROWS_MOST = 2 * N_MAX + PARAMETERS_MOST };
    double D[ROWS_MOST * 3], before_D[ROWS_MOST * 3];
    const int columns = below(b, 4), rows = 2 * w->n + tvi_system_parameters(w->system);
    const int rates = below(b, 2) ? ROWS_MOST : 2 * w->n; /* the rows of parameters are 0 */
    for (int i = 0; i < ROWS_MOST * 3; i++) D[i] = i < rates * columns && i % 7 == 0;
    if (below(b, 8) == 0) D[0] = number(b);
    memcpy(before_D, D, sizeof D);
    const state before = w->x;
    const tvi_status status = tvi_step_tangent(w->integrator, step_size(b), &w->x.t, w->x.q, w->x.p, D, columns);
    expect_state(w, status, &before, &w->x, "step with tangents");
    const int moved = (status == TVI_OK ? 2 * w->n : 0) * columns;
    insist(finite_all(moved, D) && memcmp(D + moved, before_D + moved, sizeof D - (size_t)moved * sizeof *D) == 0,
           "tangents");
    insist(rows <= ROWS_MOST, "parameters");
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

/* The integrator's values: at the recorded values they are the system's. */
static void ask_integrator(bytes *b, world *w)
{
    (void)b;
    const double was = 42;
    double H = was, p[N_MAX] = {was}, v[N_MAX] = {was};
    const tvi_integrator *it = w->integrator;
    tvi_status status = tvi_integrator_energy(it, w->x.t, w->x.q, w->x.p, &H);
    insist(status == TVI_OK ? isfinite(H) : H == was, "energy of an integrator");
    status = tvi_integrator_momentum(it, w->x.t, w->x.q, w->x.p, p);
    insist(status == TVI_OK ? finite_all(w->n, p) : p[0] == was, "momentum of an integrator");
    status = tvi_integrator_velocity(it, w->x.t, w->x.q, w->x.p, v);
    insist(status == TVI_OK ? finite_all(w->n, v) : v[0] == was, "velocity of an integrator");
}

static void set_parameters(bytes *b, world *w)
{
    double value[PARAMETERS_MOST];
    const int count = tvi_system_parameters(w->system);
    for (int i = 0; i < count; i++) value[i] = i < 3 ? number(b) : 0.5;
    const tvi_status status = tvi_integrator_set_parameters(w->integrator, value);
    insist(status == (finite_all(count, value) ? TVI_OK : TVI_ENONFINITE), "parameters");
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

/* A suggested step goes the way of the run, and is not longer. The search is short. */
static void suggest_step(bytes *b, world *w)
{
    const double was = 42, duration = below(b, 16) ? 64 * step_size(b) : number(b);
    const double error = below(b, 16) ? exp(-byte(b) / 8.0) : number(b);
    const tvi_run_plan plan = {.t_end = w->x.t + duration, .steps = 2000};
    double h = was, measured = was;
    const tvi_status status = tvi_measure_step(w->system, tvi_integrator_options(w->integrator), &plan, w->x.t, w->x.q,
                                               w->x.p, error, &h, &measured);
    expect_status(status);
    if (h == was) insist(status != TVI_OK && measured == was, "no step is suggested");
    else insist(h * duration > 0 && (w->adapts || fabs(h) <= fabs(plan.t_end - w->x.t)), "a suggested step");
    if (status == TVI_OK) insist(measured <= error, "a measured error");
}

typedef void call(bytes *b, world *w);
static call *const calls[] = {
    step,           step,        step,  dense,      save_and_load, integrate,    integrate_events,    step_tangent,
    ask_system,     last_state,  reset, make_state, integrate_at,  integrate_to, integrate_tolerance, ask_integrator,
    set_parameters, suggest_step};
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
