/* table_large.c - writes the table of one step that is far too large: how far it ends from the solution. */
#include "tables.h"

#include <math.h>
#include <string.h>

enum { N_MOST = 2 };

typedef struct {
    double q[N_MOST], p[N_MOST], tail;
    tvi_status status;
} result;

/* Makes steps of size h from the start of the case. */
static result run(const hard_case *c, const hard_method *m, double h, long steps)
{
    result x = {.status = TVI_EINVAL};
    tvi_options options;
    tvi_system *system;
    tvi_integrator *integrator;
    double t = 0;
    if (!hard_options(m, &options) || hard_system(c, &system) != TVI_OK) return x;
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

static double distance(const result *x, const double q[], const double p[], double size)
{
    double largest = 0;
    for (int i = 0; i < N_MOST; i++) largest = fmax(largest, fmax(fabs(x->q[i] - q[i]), fabs(x->p[i] - p[i])));
    return largest / size;
}

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
    const result exact = run(c, &taylor, h / (double)pieces, pieces);
    fprintf(md, "| %s | %g |", c->scene.name, h);
    for (int i = 0; i < LARGE_METHODS; i++) {
        const result x = run(c, &large_methods[i], h, 1);
        if (x.status == TVI_OK)
            fprintf(md, " %.0e, %.0e |", distance(&x, exact.q, exact.p, fmax(1, fabs(exact.q[0]))), x.tail);
        else fprintf(md, " %s |", hard_run_cause(&(hard_run){.status = x.status}));
    }
    fprintf(md, "\n");
}

bool table_large(const table_command *at)
{
    static const hard_case *const cases[] = {&kepler_60, &pendulum_unit};
    table_progress("large", "");
    FILE *md = table_open(at, "large.md");
    if (!md) return false;
    fprintf(md, "| case | h |");
    for (int i = 0; i < LARGE_METHODS; i++)
        fprintf(md, " %s %d (chaotic) |", large_methods[i].name, large_methods[i].order);
    fprintf(md, "\n|---|---|---|---|---|---|---|---|\n");
    for (int k = 0; k < 2; k++)
        for (double h = 1; h < 20; h *= 2) large_steps(md, cases[k], h);
    return fclose(md) == 0;
}
