#include "tables.h"

#include <math.h>
#include <string.h>

static const hard_method methods[] = {
    {"stormer-verlet", 2, false}, {"svhd", 2, false},      {"tvi", 8, false},       {"symmetric-tvi", 8, false},
    {"htvi-right", 8, false},     {"htvi-left", 8, false}, {"start", 8, false},     {"end", 8, false},
    {"right", 8, false},          {"left", 8, false},      {"midpoint", 8, false},  {"both-ends", 8, false},
    {"poincare", 8, false},       {"midpoint", 20, false}, {"poincare", 20, false}, {"galerkin", 8, false},
    {"galerkin", 16, false},      {"galerkin", 20, false}, {"taylor", 8, false},
};
enum { METHODS = sizeof methods / sizeof *methods, N_MOST = 2 };

typedef struct {
    double q[N_MOST], p[N_MOST], tail;
    tvi_status status;
} result;

/* From the case's start, steps of h; degree 0: the method's. */
static result run(const hard_case *c, const hard_method *m, int degree, double h, long steps)
{
    result x = {.status = TVI_EINVAL};
    tvi_options options;
    tvi_system *system;
    tvi_integrator *integrator;
    double t = 0;
    if (!hard_options(m, &options) || hard_system(c, &system) != TVI_OK) return x;
    if (degree > 0) options.degree = degree;
    memcpy(x.q, c->scene.q, (size_t)c->scene.n * sizeof *x.q);
    memcpy(x.p, c->scene.p, (size_t)c->scene.n * sizeof *x.p);
    x.status = tvi_integrator_create(&integrator, system, &options);
    if (x.status == TVI_OK) {
        x.status = tvi_integrate(integrator, h, steps, &t, x.q, x.p, NULL, NULL);
        x.tail = tvi_integrator_stats(integrator)->tail;
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return x;
}

/* " error |", or what went wrong. */
static void write_error(FILE *md, const result *x, double error)
{
    if (x->status == TVI_OK) fprintf(md, " %.0e |", error);
    else fprintf(md, " %s |", hard_run_cause(&(hard_run){.status = x->status}));
}

static double distance(const result *x, const double q[], const double p[], double size)
{
    double largest = 0;
    for (int i = 0; i < N_MOST; i++) largest = fmax(largest, fmax(fabs(x->q[i] - q[i]), fabs(x->p[i] - p[i])));
    return largest / size;
}

/* A thousand steps of 1e-8 against one of 1e-5 of the Taylor method. */
static void tiny_steps(FILE *md, const hard_method *m)
{
    static const hard_method taylor = {"taylor", 19, false};
    const result exact = run(&kepler_60, &taylor, 0, 1e-5, 1), x = run(&kepler_60, m, 0, 1e-8, 1000);
    write_error(md, &x, distance(&x, exact.q, exact.p, 1));
}

static void degree_forty(FILE *md, const hard_method *m)
{
    if (m->order == 2) {
        fprintf(md, " - |");
        return;
    }
    const result x = run(&kepler_60, m, 40, kepler_60.period / 64, 64);
    write_error(md, &x, distance(&x, kepler_60.scene.q, kepler_60.scene.p, 1));
}

static void other_size(FILE *md, const hard_case *c, const hard_method *m)
{
    const double length = *(const double *)c->ctx;
    const result unit = run(&pendulum_unit, m, 0, 0.1, 200), x = run(c, m, 0, 0.1, 200);
    const double q[N_MOST] = {unit.q[0] * length, 0}, p[N_MOST] = {unit.p[0] * length, 0};
    write_error(md, &x, distance(&x, q, p, length));
}

/* Against the free particle. */
static void kepler_of_size(FILE *md, const hard_case *c, const hard_method *m)
{
    const double size = c->scene.q[0], q[N_MOST] = {size, size}, p[N_MOST] = {0, size};
    const result x = run(c, m, 0, 0.125, 8);
    write_error(md, &x, distance(&x, q, p, size));
}

/* ---- Steps that are far too large -------------------------------------------------------------------------------- */

static const hard_method large_methods[] = {
    {"tvi", 8, false},       {"start", 8, false},    {"midpoint", 8, false},
    {"midpoint", 20, false}, {"poincare", 8, false}, {"galerkin", 16, false},
};
enum { LARGE_METHODS = sizeof large_methods / sizeof *large_methods };

/* One step from the start of a case against many of the Taylor method. */
static void large_steps(FILE *md, const hard_case *c, double h)
{
    static const hard_method taylor = {"taylor", 19, false};
    const long pieces = 100 + (long)(200 * h);
    const result exact = run(c, &taylor, 0, h / (double)pieces, pieces);
    fprintf(md, "| %s | %g |", c->scene.name, h);
    for (int i = 0; i < LARGE_METHODS; i++) {
        const result x = run(c, &large_methods[i], 0, h, 1);
        if (x.status == TVI_OK)
            fprintf(md, " %.0e, %.0e |", distance(&x, exact.q, exact.p, fmax(1, fabs(exact.q[0]))), x.tail);
        else write_error(md, &x, 0);
    }
    fprintf(md, "\n");
}

static bool table_large(const table_command *at)
{
    static const hard_case *const cases[] = {&kepler_60, &pendulum_unit, &henon_heiles_6};
    FILE *md = table_open(at, "large.md");
    if (!md) return false;
    fprintf(md, "| case | h |");
    for (int i = 0; i < LARGE_METHODS; i++)
        fprintf(md, " %s %d (chaotic) |", large_methods[i].name, large_methods[i].order);
    fprintf(md, "\n|---|---|---|---|---|---|---|---|\n");
    for (int k = 0; k < 3; k++)
        for (double h = 0.5; h < 100; h *= 2) large_steps(md, cases[k], h);
    return fclose(md) == 0;
}

/* ---- The tables -------------------------------------------------------------------------------------------------- */

static bool table_sizes(const table_command *at)
{
    FILE *md = table_open(at, "extremes.md");
    if (!md) return false;
    fprintf(
        md,
        "| method | order | 1,000 steps of 1e-8 | degree 40 | pendulum, 2^-498 | pendulum, 2^498 | Kepler, 1e-150 | "
        "Kepler, 1e150 |\n|---|---|---|---|---|---|---|---|\n");
    for (int i = 0; i < METHODS; i++) {
        const hard_method *m = &methods[i];
        fprintf(md, "| %s | %d |", m->name, m->order);
        tiny_steps(md, m);
        degree_forty(md, m);
        other_size(md, &pendulum_tiny, m);
        other_size(md, &pendulum_huge, m);
        kepler_of_size(md, &kepler_tiny, m);
        kepler_of_size(md, &kepler_huge, m);
        fprintf(md, "\n");
    }
    return fclose(md) == 0;
}

bool table_extremes(const table_command *at)
{
    table_progress("extremes", "");
    return table_sizes(at) && table_large(at);
}
