/* orbits.c - Runs many orbits of one scene in threads, and samples their energies (longrun.h). */
#include "longrun.h"
#include "nearest.h"
#include "rounded.h"
#include "sooner.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Samples begin after FIRST_SAMPLE windows; from there they do not overlap. */
enum { THREADS = 2, SAMPLES_A_DECADE = 10, FIRST_SAMPLE = 5 };
static const double PI = 3.14159265358979323846;
/* The relative size of the perturbation of the starts. The roundoff of starts that differ by 1e-12 is not independent:
 * the mean of 240 such orbits may be four standard errors without any drift. */
static const double PERTURBATION = 1e-4;

typedef struct {
    const tvi_system *system; /* as stated */
    tvi_integrator *integrator;
    rounded *control; /* of LONGRUN_ROUNDED */
    double t, q[LONGRUN_N_MAX], p[LONGRUN_N_MAX];
} orbit;

/* The data that the threads share. */
typedef struct {
    longrun_series *series;
    const tvi_system *system, *stepped;
    tvi_options options;
    atomic_int next; /* orbit to run */
} ensemble;

/* ---- Starts ------------------------------------------------------------------------------------------------------ */

/* -1 to 1: xorshift64*. */
static double random_number(uint64_t *state)
{
    *state ^= *state >> 12, *state ^= *state << 25, *state ^= *state >> 27;
    return (double)(*state * UINT64_C(2685821657736338717) >> 11) * 0x1p-52 - 1;
}

/* The centre of mass is put at rest at the origin: far from it the roundoff of positions would grow with them. */
static void centre(orbit *o, const scene *s)
{
    for (int axis = 0; axis < 3; axis++) {
        double mass = 0, q = 0, p = 0;
        for (int i = axis; i < s->n; i += 3) mass += s->mass[i], q += s->mass[i] * o->q[i], p += o->p[i];
        for (int i = axis; i < s->n; i += 3) o->q[i] -= q / mass, o->p[i] -= s->mass[i] * p / mass;
    }
}

/* Orbit number k of a scene has the same start in every line. */
static void orbit_begin(orbit *o, const longrun_line *line, const ensemble *all, int k)
{
    const scene *s = line->scene;
    uint64_t seed = UINT64_C(0x9e3779b97f4a7c15) * (uint64_t)(k + 1);
    *o = (orbit){.system = all->system};
    for (int i = 0; i < 8; i++) random_number(&seed);
    for (int i = 0; i < s->n; i++) {
        o->q[i] = s->q[i] * (1 + PERTURBATION * random_number(&seed));
        o->p[i] = s->p[i] * (1 + PERTURBATION * random_number(&seed));
    }
    if (s == &scene_solar) centre(o, s);
    if (line->constraints) experiment_insist(tvi_project(all->stepped, 0, o->q, o->p), line->title);
    if (line->sums == LONGRUN_ROUNDED) {
        if (!(o->control = rounded_create(all->system, line->h))) experiment_fail(s->name, "no memory");
        return;
    }
    const tvi_status status = tvi_integrator_create(&o->integrator, all->stepped, &all->options);
    if (status != TVI_OK) experiment_fail(s->name, tvi_status_string(status));
}

static void orbit_end(orbit *o)
{
    tvi_integrator_free(o->integrator);
    rounded_free(o->control);
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

/* Without its low-order parts a step is the plain sum of state and increment. Everything else that it has learnt is
 * forgotten, too. */
static tvi_status without_low_parts(orbit *o, double h, long steps)
{
    tvi_status status = TVI_OK;
    for (long i = 0; i < steps && status == TVI_OK; i++) {
        tvi_integrator_reset(o->integrator);
        status = tvi_step(o->integrator, h, &o->t, o->q, o->p);
    }
    return status;
}

static void orbit_advance(orbit *o, const longrun_line *line, long steps)
{
    tvi_status status;
    if (line->sums == LONGRUN_ROUNDED) status = rounded_run(o->control, steps, o->q, o->p);
    else if (line->sums == LONGRUN_PLAIN) status = without_low_parts(o, line->h, steps);
    else status = tvi_integrate(o->integrator, line->h, steps, &o->t, o->q, o->p, NULL, NULL);
    if (status != TVI_OK) experiment_fail(line->scene->name, tvi_status_string(status));
}

static void measure(const orbit *o, int n, double value[LONGRUN_QUANTITIES])
{
    const tvi_status status = tvi_energy(o->system, o->t, o->q, o->p, &value[LONGRUN_ENERGY]);
    if (status != TVI_OK) experiment_fail("energy", tvi_status_string(status));
    long double momentum = 0;
    for (int i = 0; i + 1 < n; i += 3)
        momentum += (long double)o->q[i] * o->p[i + 1] - (long double)o->q[i + 1] * o->p[i];
    value[LONGRUN_MOMENTUM] = (double)momentum;
}

/* A step and its values. */
static void step_and_measure(orbit *o, const longrun_line *line, double value[LONGRUN_QUANTITIES])
{
    orbit_advance(o, line, 1);
    measure(o, line->scene->n, value);
}

/* The means of the values less `start` over the steps of a window, with weights 1 - cos(2 pi i / W); what repeats
 * itself several times in a window is not in them. scatter: the root mean square about that mean, or NULL. */
static void observe(orbit *o, const longrun_line *line, const double start[], double mean[], double scatter[])
{
    double squares[LONGRUN_QUANTITIES] = {0}, value[LONGRUN_QUANTITIES];
    for (int i = 0; i < LONGRUN_QUANTITIES; i++) mean[i] = 0;
    for (int step = 1; step <= LONGRUN_WINDOW; step++) {
        const double weight = (1 - cos(2 * PI * (step - 0.5) / LONGRUN_WINDOW)) / LONGRUN_WINDOW;
        step_and_measure(o, line, value);
        for (int i = 0; i < LONGRUN_QUANTITIES; i++) {
            const double d = value[i] - start[i];
            mean[i] += weight * d, squares[i] += weight * d * d;
        }
    }
    for (int i = 0; i < LONGRUN_QUANTITIES && scatter; i++) scatter[i] = sqrt(fmax(0, squares[i] - mean[i] * mean[i]));
}

static void orbit_run(const ensemble *all, int k)
{
    longrun_series *series = all->series;
    const longrun_line *line = series->line;
    orbit o;
    double start[LONGRUN_QUANTITIES], first[LONGRUN_QUANTITIES], now[LONGRUN_QUANTITIES], scatter[LONGRUN_QUANTITIES];
    passes_end_sooner = line->sums == LONGRUN_SOONER;
    coefficients_are_nearest = line->sums == LONGRUN_NEAREST;
    orbit_begin(&o, line, all, k);
    measure(&o, line->scene->n, start);
    const double scale[LONGRUN_QUANTITIES] = {fmax(fabs(start[0]), line->scene->energy_scale), fabs(start[1])};
    observe(&o, line, start, first, scatter);
    for (int i = 0; i < LONGRUN_QUANTITIES; i++) series->scatter[i][k] = scatter[i] / scale[i];
    for (int sample = 0; sample < series->samples; sample++) {
        const long before = sample > 0 ? series->steps[sample - 1] : 0;
        orbit_advance(&o, line, series->steps[sample] - before - LONGRUN_WINDOW);
        observe(&o, line, start, now, NULL);
        for (int i = 0; i < LONGRUN_QUANTITIES; i++) series->errors[i][sample][k] = (now[i] - first[i]) / scale[i];
    }
    orbit_end(&o);
}

static void *run_some(void *ctx)
{
    ensemble *all = ctx;
    for (int k; (k = atomic_fetch_add(&all->next, 1)) < all->series->orbits;) orbit_run(all, k);
    return NULL;
}

void longrun_run(longrun_series *series, const longrun_line *line, int orbits, double steps)
{
    pthread_t thread[THREADS];
    tvi_system *system = experiment_system(line->scene), *stepped = NULL;
    const longrun_constraints *on = line->constraints;
    if (line->scale) experiment_insist(tvi_system_rescaled(&stepped, system, line->scale, NULL), line->title);
    if (on) experiment_insist(tvi_system_constrained(&stepped, system, on->m, on->phi, NULL), line->title);
    experiment_method method = experiment_find(line->method, line->order);
    method.who.options.max_tail = 0;
    tvi_compiled *code = NULL;
    ensemble all = {
        .series = series, .system = system, .stepped = stepped ? stepped : system, .options = method.who.options};
    /* Generated code ends its passes itself, and has no constraints. */
    if (getenv("LONGRUN_COMPILED") && line->sums != LONGRUN_SOONER && !on)
        experiment_insist(tvi_compile(&code, all.stepped, &all.options, NULL), "a compilation");
    all.options.compiled = code;
    const double begin = run_clock();
    const int last = (int)floor(SAMPLES_A_DECADE * log10(steps / (FIRST_SAMPLE * LONGRUN_WINDOW)));
    if (last < 0) experiment_fail(line->title, "too few steps");
    series->line = line, series->orbits = orbits, series->samples = last + 1;
    for (int k = 0; k <= last; k++) series->steps[k] = lround(steps * pow(10, (double)(k - last) / SAMPLES_A_DECADE));
    for (int i = 0; i < THREADS; i++)
        if (pthread_create(&thread[i], NULL, run_some, &all) != 0) experiment_fail("threads", "cannot be made");
    for (int i = 0; i < THREADS; i++) pthread_join(thread[i], NULL);
    tvi_compiled_free(code);
    tvi_system_free(stepped);
    tvi_system_free(system);
    series->cpu = run_clock() - begin;
}
