/* rows.c - Defines the rows of make compare-with, and runs them (rows.h). */
#include "rows.h"

#include "performance/bodies.h"
#include "scenes/hard.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- The rows ---------------------------------------------------------------------------------------------------- */

typedef enum { STATED, OWN_SCALE, AUTOMATIC_SCALE } time_scale;

/* A scene, a hard scene, or many bodies. The step suits order 16. */
typedef struct {
    const char *title;
    const scene *scene;
    const hard_scene *hard;
    int bodies;
    time_scale scale;
    double h;
    int steps; /* of a run */
} problem;

/* The last one starts from a Lagrangian. */
static const problem problems[] = {
    {.title = "pendulum", .scene = &scene_pendulum, .h = 0.25, .steps = 50},
    {.title = "Kepler", .scene = &scene_kepler, .h = 0.25, .steps = 50},
    {.title = "Henon-Heiles", .scene = &scene_henon_heiles_12, .h = 0.625, .steps = 50},
    {.title = "FPU", .scene = &scene_fpu, .h = 0.03125, .steps = 50},
    {.title = "Solar System", .scene = &scene_solar, .h = 400, .steps = 30},
    {.title = "20 bodies", .bodies = 20, .h = 0.5, .steps = 10},
    {.title = "double pendulum", .scene = &scene_double_pendulum, .h = 0.0625, .steps = 50},
};
enum { PROBLEMS = sizeof problems / sizeof *problems, KEPLER = 1, HENON_HEILES = 2 };

/* How steps are made, with the step of a problem times `part`, of the first so many problems. */
typedef struct {
    const char *group, *method;
    int order;
    double part;
    bool compiled;
    int problems;
    double tolerance; /* other than 0: steps that adapt, over the same time */
} way;
enum {
    GALERKIN,
    COMPILED,
    MIDPOINT_12,
    MIDPOINT_20,
    POINCARE,
    TAYLOR,
    COMPILED_MIDPOINT,
    COMPILED_TAYLOR,
    TOLERANCE_6,
    TOLERANCE_12,
    WAYS
};
static const way ways[WAYS] = {
    [GALERKIN] = {"galerkin on the tape", "galerkin", 16, 1, false, PROBLEMS, 0},
    [COMPILED] = {"compiled", "galerkin", 16, 1, true, PROBLEMS, 0},
    [MIDPOINT_12] = {"midpoint 12", "midpoint", 12, 0.5, false, PROBLEMS, 0},
    [MIDPOINT_20] = {"midpoint 20", "midpoint", 20, 1, false, PROBLEMS, 0},
    [POINCARE] = {"poincare 20", "poincare", 20, 1, false, PROBLEMS - 1, 0},
    [TAYLOR] = {"taylor", "taylor", 12, 0.25, false, PROBLEMS, 0},
    [COMPILED_MIDPOINT] = {"compiled midpoint", "midpoint", 12, 0.5, true, PROBLEMS, 0},
    [COMPILED_TAYLOR] = {"compiled taylor", "taylor", 12, 0.25, true, PROBLEMS, 0},
    [TOLERANCE_6] = {"tolerance 1e-6", "taylor", 8, 1, false, PROBLEMS, 1e-6},
    [TOLERANCE_12] = {"tolerance 1e-12", "taylor", 15, 1, false, PROBLEMS, 1e-12},
};

/* An orbit of Kepler's problem with e = 0.9 takes 8.37 in s of r^(3/2). The automatic g is that divided by 5^(1/4).
 * Second derivatives are taken of both, of the former whole, but not of three bodies (docs/method.md section 5). */
static const problem own_kepler = {.hard = &hard_kepler_90, .scale = OWN_SCALE, .h = 0.8, .steps = 50};
static const problem automatic_kepler = {.hard = &hard_kepler_90, .scale = AUTOMATIC_SCALE, .h = 1.2, .steps = 50};
static const problem pythagorean = {.hard = &hard_pythagorean, .scale = OWN_SCALE, .h = 0.9, .steps = 30};
static const struct {
    const char *title;
    const problem *problem;
    int way;
} rescaled[] = {
    {"Kepler, e = 0.9", &own_kepler, GALERKIN},
    {"Kepler, e = 0.9, automatic g", &automatic_kepler, GALERKIN},
    {"Pythagorean", &pythagorean, GALERKIN},
    {"Kepler, e = 0.9, compiled", &own_kepler, COMPILED},
    {"Kepler, e = 0.9, automatic g, compiled", &automatic_kepler, COMPILED},
    {"Kepler, e = 0.9, poincare 20", &own_kepler, POINCARE},
    {"Kepler, e = 0.9, taylor", &own_kepler, TAYLOR},
};
enum { RESCALED = sizeof rescaled / sizeof *rescaled };

/* The members of a run have an integrator each, or are an ensemble in one thread, without an observer or with one that
 * is called after each step. */
typedef enum { INTEGRATORS, ENSEMBLE, ENSEMBLE_OBSERVED, KINDS } kind;
static const char *const kinds[] = {"integrators", "ensemble", "observed"};
enum { MEMBERS = 1000, MEMBER_STEPS = 10 };
static const struct {
    int problem, way;
} ensembles[] = {
    {KEPLER, GALERKIN},       {KEPLER, MIDPOINT_12},       {KEPLER, TAYLOR},
    {HENON_HEILES, GALERKIN}, {HENON_HEILES, MIDPOINT_12}, {HENON_HEILES, TAYLOR},
};
enum { SETS = sizeof ensembles / sizeof *ensembles };

typedef struct {
    const char *group;
    char title[64];
    const problem *problem;
    const way *way;
    kind kind;
    int members, set;
} description;

/* Describes row i of the groups; false: there are fewer. */
static bool describe_plain(int i, description *d)
{
    for (int w = 0; w < WAYS; i -= ways[w++].problems) {
        if (i >= ways[w].problems) continue;
        d->way = &ways[w], d->problem = &problems[i], d->group = ways[w].group;
        snprintf(d->title, sizeof d->title, "%s", d->problem->title);
        return true;
    }
    if (i >= RESCALED) return false;
    d->way = &ways[rescaled[i].way], d->problem = rescaled[i].problem, d->group = "rescaled";
    snprintf(d->title, sizeof d->title, "%s", rescaled[i].title);
    return true;
}

static int count_plain(void)
{
    int count = RESCALED;
    for (int w = 0; w < WAYS; w++) count += ways[w].problems;
    return count;
}

int rows_count(void) { return count_plain() + SETS * KINDS; }

static description describe(int row)
{
    description d = {.kind = INTEGRATORS, .members = 1, .set = row};
    if (describe_plain(row, &d)) return d;
    const int i = row - count_plain(), set = i / KINDS;
    d.way = &ways[ensembles[set].way], d.problem = &problems[ensembles[set].problem], d.group = "ensembles";
    d.kind = (kind)(i % KINDS), d.members = MEMBERS, d.set = count_plain() + set;
    snprintf(d.title, sizeof d.title, "%s, %s %d: %s", d.problem->title, d.way->method, d.way->order, kinds[d.kind]);
    return d;
}

const char *row_group(int row) { return describe(row).group; }
int row_set(int row) { return describe(row).set; }

const char *row_title(int row)
{
    static char title[sizeof((description *)0)->title];
    memcpy(title, describe(row).title, sizeof title);
    return title;
}

/* ---- Their steps ------------------------------------------------------------------------------------------------- */

struct work {
    description of;
    int n;
    double h;
    long steps;
    tvi_system *stated, *rescaled;
    tvi_integrator *integrators[MEMBERS]; /* as many as members, or none */
    tvi_ensemble *ensemble;
    double start_q[COORDINATES_MOST], start_p[COORDINATES_MOST];
    double *t, *q, *p; /* of an ensemble: [members], [n][members] */
    tvi_status *status;
};

static tvi_status make_system(work *w)
{
    const problem *p = w->of.problem;
    if (p->bodies) {
        const big_system b = bodies_make(p->bodies, 3);
        w->n = b.n, w->stated = b.system;
        memcpy(w->start_q, b.q, sizeof b.q);
        memcpy(w->start_p, b.p, sizeof b.p);
        return TVI_OK;
    }
    const scene *s = p->hard ? &p->hard->scene : p->scene;
    w->n = s->n;
    memcpy(w->start_q, s->q, (size_t)s->n * sizeof *s->q);
    memcpy(w->start_p, s->p, (size_t)s->n * sizeof *s->p);
    const tvi_status status = scene_system(s, &w->stated);
    if (status != TVI_OK || p->scale == STATED) return status;
    return tvi_system_rescaled(&w->rescaled, w->stated, p->scale == OWN_SCALE ? p->hard->scale : NULL, NULL);
}

static tvi_status make_members(work *w, const tvi_system *system, const tvi_options *options)
{
    const int members = w->of.members;
    tvi_status status = TVI_OK;
    if (w->of.kind == INTEGRATORS) {
        for (int m = 0; m < members && status == TVI_OK; m++)
            status = tvi_integrator_create(&w->integrators[m], system, options);
        return status;
    }
    const size_t numbers = (size_t)w->n * (size_t)members * sizeof(double);
    w->t = malloc((size_t)members * sizeof *w->t);
    w->q = malloc(numbers);
    w->p = malloc(numbers);
    w->status = malloc((size_t)members * sizeof *w->status);
    if (!w->t || !w->q || !w->p || !w->status) return TVI_ENOMEM;
    return tvi_ensemble_create(&w->ensemble, system, options, members, 1);
}

static tvi_status open_steps(work *w)
{
    const way *by = w->of.way;
    tvi_options options;
    tvi_compiled *code = NULL;
    tvi_status status = make_system(w);
    const tvi_system *system = w->rescaled ? w->rescaled : w->stated;
    if (status == TVI_OK) status = tvi_options_named(by->method, by->order, &options);
    if (status == TVI_OK && by->compiled)
        status = tvi_compile(&code, system, &options, &(tvi_compiler){.cache = "generated"});
    if (status != TVI_OK) return status;
    options.compiled = code;
    status = make_members(w, system, &options);
    tvi_compiled_free(code);
    return status;
}

tvi_status row_open(work **out, int row)
{
    work *w = calloc(1, sizeof *w);
    *out = NULL;
    if (!w) return TVI_ENOMEM;
    w->of = describe(row);
    w->h = w->of.way->part * w->of.problem->h;
    w->steps = w->of.members > 1 ? MEMBER_STEPS : w->of.problem->steps;
    const tvi_status status = open_steps(w);
    if (status == TVI_OK) *out = w;
    else row_close(w);
    return status;
}

void row_close(work *w)
{
    if (!w) return;
    for (int m = 0; m < MEMBERS; m++) tvi_integrator_free(w->integrators[m]);
    tvi_ensemble_free(w->ensemble);
    tvi_system_free(w->rescaled);
    tvi_system_free(w->stated);
    free(w->t);
    free(w->q);
    free(w->p);
    free(w->status);
    free(w);
}

long row_steps(const work *w) { return w->steps * w->of.members; }

/* Members start a little apart. */
static double spread(int m) { return 1 + 1e-3 * m / MEMBERS; }

static tvi_status run_integrators(work *w)
{
    tvi_status status = TVI_OK;
    for (int m = 0; m < w->of.members && status == TVI_OK; m++) {
        double t = 0, q[COORDINATES_MOST], p[COORDINATES_MOST];
        for (int i = 0; i < w->n; i++) q[i] = spread(m) * w->start_q[i], p[i] = w->start_p[i];
        tvi_integrator_reset(w->integrators[m]);
        const double tolerance = w->of.way->tolerance, end = w->h * (double)w->steps;
        status = tolerance > 0 ? tvi_integrate_tolerance(w->integrators[m], tolerance, end, &t, q, p, NULL, NULL)
                               : tvi_integrate(w->integrators[m], w->h, w->steps, &t, q, p, NULL, NULL);
    }
    return status;
}

static int observe(long step, int members, const double t[], const double q[], const double p[],
                   const tvi_status status[], void *ctx)
{
    (void)step, (void)members, (void)t, (void)q, (void)p, (void)status, (void)ctx;
    return 0;
}

static tvi_status run_ensemble(work *w)
{
    const int members = w->of.members;
    for (int m = 0; m < members; m++) {
        w->t[m] = 0;
        for (int i = 0; i < w->n; i++) {
            w->q[i * members + m] = spread(m) * w->start_q[i];
            w->p[i * members + m] = w->start_p[i];
        }
    }
    tvi_ensemble_reset(w->ensemble);
    tvi_status status = tvi_ensemble_integrate(w->ensemble, w->h, w->steps, w->t, w->q, w->p, w->status,
                                               w->of.kind == ENSEMBLE_OBSERVED ? observe : NULL, NULL);
    for (int m = 0; m < members && status == TVI_OK; m++) status = w->status[m];
    return status;
}

tvi_status row_run(work *w) { return w->ensemble ? run_ensemble(w) : run_integrators(w); }
