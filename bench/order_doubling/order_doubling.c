/* order_doubling.c - Compares on-curve nodes against the paper's truncated ones at the same number of derivatives.
 * Writes the tables of docs/order-doubling.md to a folder, and errors.csv for its picture.
 *
 *   order_doubling DIR */
#include "runs/run.h"
#include "runs/sweep.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* From the scenes' starts, over times of a few large steps. */
static const struct {
    const scene *scene;
    double t_end;
} problems[] = {
    {&scene_pendulum, 2},        {&scene_kepler, 3},       {&scene_henon_heiles_12, 10}, {&scene_fpu, 0.5},
    {&scene_double_pendulum, 1}, {&scene_nonseparable, 2}, {&scene_degenerate, 1.5},
};

/* The paper's forms, and ours beside each. least: the least degree. */
static const struct {
    const char *name, *title;
    tvi_options options;
    int least;
} methods[] = {
    {"tvi", "tvi (paper)", {.method = TVI_TYPE1, .expansion = TVI_AT_START, .nodes = TVI_NODES_TRUNCATED}, 1},
    {"start", "start", {.method = TVI_TYPE1, .expansion = TVI_AT_START}, 1},
    {"midpoint", "midpoint", {.method = TVI_TYPE1, .expansion = TVI_AT_MIDPOINT}, 1},
    {"symmetric-tvi",
     "symmetric-tvi (paper)",
     {.method = TVI_TYPE1, .expansion = TVI_AT_BOTH_ENDS, .nodes = TVI_NODES_TRUNCATED},
     1},
    {"both-ends", "both-ends", {.method = TVI_TYPE1, .expansion = TVI_AT_BOTH_ENDS}, 1},
    {"htvi-right",
     "htvi-right (paper)",
     {.method = TVI_TYPE2, .expansion = TVI_AT_START, .nodes = TVI_NODES_TRUNCATED},
     1},
    {"right", "right", {.method = TVI_TYPE2, .expansion = TVI_AT_START}, 1},
    {"left", "left", {.method = TVI_TYPE3, .expansion = TVI_AT_START}, 1},
    {"poincare", "poincare", {.method = TVI_POINCARE, .expansion = TVI_AT_MIDPOINT}, 1},
};
enum {
    PROBLEMS = sizeof problems / sizeof *problems,
    METHODS = sizeof methods / sizeof *methods,
    DEGREES = 4,
    DOUBLINGS = 10, /* of the number of steps, from STEPS_FIRST on */
    STEPS_FIRST = 4,
    SHOWN = 4, /* STEPS_FIRST 2^SHOWN steps, the run whose error the table shows */
    DIMENSION_MOST = 8
};
static const double FLOOR = 1e-12; /* errors above it are free of roundoff */

/* ---- Errors ------------------------------------------------------------------------------------------------------ */

typedef struct {
    double q[DIMENSION_MOST], p[DIMENSION_MOST];
} state_at_end;

static tvi_status integrate(const tvi_system *system, int problem, const tvi_options *options, long steps,
                            state_at_end *x)
{
    const scene *s = problems[problem].scene;
    tvi_integrator *integrator;
    double t = 0;
    memcpy(x->q, s->q, (size_t)s->n * sizeof *x->q);
    memcpy(x->p, s->p, (size_t)s->n * sizeof *x->p);
    tvi_status status = tvi_integrator_create(&integrator, system, options);
    if (status != TVI_OK) return status;
    status = tvi_integrate(integrator, problems[problem].t_end / (double)steps, steps, &t, x->q, x->p, NULL, NULL);
    tvi_integrator_free(integrator);
    return status;
}

/* The Taylor method of order 30 with short steps: to roundoff. */
static tvi_status solve(const tvi_system *system, int problem, state_at_end *x)
{
    const tvi_options options = {.method = TVI_TAYLOR, .expansion = TVI_AT_START, .order = 30};
    return integrate(system, problem, &options, 64, x);
}

/* error[k]: the largest component at the end with STEPS_FIRST 2^k steps, NAN where the run failed or was not made. */
typedef struct {
    double error[DOUBLINGS];
    double order; /* observed: of the two last errors above the floor; NAN where there are none */
} convergence;

static convergence no_convergence(void)
{
    convergence c = {.order = NAN};
    for (int k = 0; k < DOUBLINGS; k++) c.error[k] = NAN;
    return c;
}

static double distance(int n, const state_at_end *x, const state_at_end *y)
{
    double largest = 0;
    for (int i = 0; i < n; i++) largest = fmax(largest, fmax(fabs(x->q[i] - y->q[i]), fabs(x->p[i] - y->p[i])));
    return largest;
}

static convergence converge(const tvi_system *system, int problem, const tvi_options *options,
                            const state_at_end *exact)
{
    convergence c = no_convergence();
    for (int k = 0; k < DOUBLINGS; k++) {
        state_at_end x;
        const tvi_status status = integrate(system, problem, options, (long)STEPS_FIRST << k, &x);
        c.error[k] = status == TVI_OK ? distance(problems[problem].scene->n, &x, exact) : NAN;
        if (k > 0 && c.error[k] > FLOOR && c.error[k - 1] > 0) c.order = log2(c.error[k - 1] / c.error[k]);
        if (k > SHOWN && c.error[k] < FLOOR) break;
    }
    return c;
}

/* ---- The tables of errors ---------------------------------------------------------------------------------------- */

typedef struct {
    FILE *orders, *csv, *price;
} files;

static tvi_options options_of(int method, int degree)
{
    tvi_options options = methods[method].options;
    options.degree = degree;
    return options;
}

static void write_errors(const files *f, int problem, int method, int degree, const convergence *c)
{
    const scene *s = problems[problem].scene;
    for (int k = 0; k < DOUBLINGS; k++)
        if (c->error[k] > 0)
            fprintf(f->csv, "%s,%s,%d,%d,%.10g,%.4e\n", s->name, methods[method].name, degree, STEPS_FIRST << k,
                    problems[problem].t_end / (STEPS_FIRST << k), c->error[k]);
}

/* "order (error)", or what is known of it. */
static void write_cell(const files *f, const convergence *c)
{
    if (isnan(c->error[SHOWN])) fprintf(f->orders, " - |");
    else if (isnan(c->order)) fprintf(f->orders, " - (%.1e) |", c->error[SHOWN]);
    else fprintf(f->orders, " %.1f (%.1e) |", c->order, c->error[SHOWN]);
}

static bool measure_problem(const files *f, int problem)
{
    const scene *s = problems[problem].scene;
    tvi_system *system;
    state_at_end exact;
    if (scene_system(s, &system) != TVI_OK) return false;
    bool good = solve(system, problem, &exact) == TVI_OK;
    for (int degree = 2; degree <= DEGREES && good; degree++) {
        fprintf(f->orders, "| %s | %d |", s->name, degree);
        for (int method = 0; method < METHODS; method++) {
            const tvi_options options = options_of(method, degree);
            convergence c = no_convergence();
            const bool serves = tvi_options_check(system, &options, NULL) == TVI_OK;
            if (serves) c = converge(system, problem, &options, &exact);
            if (serves) write_errors(f, problem, method, degree, &c);
            write_cell(f, &c);
        }
        fprintf(f->orders, "\n");
        fprintf(stderr, "%s, N = %d\n", s->name, degree);
    }
    tvi_system_free(system);
    return good;
}

/* ---- The price --------------------------------------------------------------------------------------------------- */

/* Whole scenes, at steps that every method can make. */
static const struct {
    const scene *scene;
    double h;
} priced[] = {
    {&scene_pendulum, 0.0625}, {&scene_kepler, 0.0625}, {&scene_henon_heiles_12, 0.25}, {&scene_fpu, 0.015625}};
enum { PRICED = sizeof priced / sizeof *priced };

static void write_price_cell(const files *f, const tvi_system *system, const scene *s, double h, int degree, int method)
{
    contender who[2];
    run runs[2];
    double cpu[2];
    const int pair[2] = {0, method};
    for (int i = 0; i < 2; i++) {
        who[i] = (contender){.name = methods[pair[i]].name, .options = options_of(pair[i], degree)};
        runs[i] = (run){.scene = s, .who = &who[i], .setting = h};
    }
    run_in_turns(system, &runs[0], &runs[1], cpu);
    if (cpu[0] < INFINITY && cpu[1] < INFINITY) fprintf(f->price, " %.2f |", cpu[1] / cpu[0]);
    else fprintf(f->price, " - |");
}

static bool measure_price(const files *f, const scene *s, double h)
{
    tvi_system *system;
    if (scene_system(s, &system) != TVI_OK) return false;
    for (int degree = 2; degree <= 10; degree += 8) {
        fprintf(f->price, "| %s | %d |", s->name, degree);
        for (int method = 1; method < METHODS; method++) write_price_cell(f, system, s, h, degree, method);
        fprintf(f->price, "\n");
    }
    tvi_system_free(system);
    return true;
}

/* ---- The command ------------------------------------------------------------------------------------------------- */

static void write_heads(const files *f)
{
    fprintf(f->orders, "| scene | N |");
    for (int method = 0; method < METHODS; method++) fprintf(f->orders, " %s |", methods[method].title);
    fprintf(f->orders, "\n|---|---|");
    for (int method = 0; method < METHODS; method++) fprintf(f->orders, "---|");
    fprintf(f->orders, "\n");
    fprintf(f->csv, "scene,method,degree,steps,h,error\n");
    fprintf(f->price, "| scene | N |");
    for (int method = 1; method < METHODS; method++) fprintf(f->price, " %s (time) |", methods[method].title);
    fprintf(f->price, "\n|---|---|");
    for (int method = 1; method < METHODS; method++) fprintf(f->price, "---|");
    fprintf(f->price, "\n");
}

static FILE *open_in(const char *dir, const char *name)
{
    char path[4096];
    FILE *file = NULL;
    if (snprintf(path, sizeof path, "%s/%s", dir, name) < (int)sizeof path) file = fopen(path, "w");
    if (!file) {
        fprintf(stderr, "order_doubling: cannot write %s/%s: %s\n", dir, name, strerror(errno));
        exit(EXIT_FAILURE);
    }
    return file;
}

int main(int argc, char *argv[])
{
    sweep_insist_on_one_thread(argv);
    if (argc != 2) {
        fprintf(stderr, "usage: order_doubling DIR\n");
        return EXIT_FAILURE;
    }
    mkdir(argv[1], 0777);
    const files f = {open_in(argv[1], "orders.md"), open_in(argv[1], "errors.csv"), open_in(argv[1], "price.md")};
    write_heads(&f);
    bool good = true;
    for (int problem = 0; problem < PROBLEMS; problem++) good &= measure_problem(&f, problem);
    for (int i = 0; i < PRICED; i++) good &= measure_price(&f, priced[i].scene, priced[i].h);
    FILE *const all[] = {f.orders, f.csv, f.price};
    for (int i = 0; i < 3; i++) good &= fclose(all[i]) == 0;
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
