/* longrun.c - how roundoff grows: the energy of the outer Solar System over ORBITS orbits that differ by 1e-12, with
 * the compensated sums and without them. The table and the picture of docs/roundoff.md.
 *
 * Brouwer's law: errors of random sign add up to an energy error that grows as t^(1/2); errors with a sign of their own
 * make it grow as t. Fitted is log rms = log c + a log t, the rms over the orbits of e_i = (H - H0_i) / |H0_i|, at
 * times in equal ratios. */
#include "experiments/experiment.h"
#include "sweep.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { ORBITS = 32, THREADS = 2, SAMPLES_A_DECADE = 10, SAMPLES_MAX = 120, DIMENSION_MAX = 18 };
/* Below FIT_FROM steps the roundoff of H itself shows. The steps are so small that increments are well below the state,
 * else the sums are not what counts. */
static const double PERTURBATION = 1e-12, FIT_FROM = 1e4, DAYS_A_YEAR = 365.25;
static const double STUDENT = 2.04; /* of 31 degrees of freedom, 95% */

typedef struct {
    const char *name;
    int order;
    double h; /* days */
    bool compensated;
    double share; /* of the time */
} line;

static const line lines[] = {
    {"galerkin", 16, 100, true, 0.2},
    {"galerkin", 16, 100, false, 0.25},
    {"midpoint", 16, 100, true, 0.3},
    {"midpoint", 16, 100, false, 0.25},
};
enum { LINES = sizeof lines / sizeof *lines };

/* ---- Orbits ------------------------------------------------------------------------------------------------------ */

typedef struct {
    tvi_integrator *integrator;
    double t, q[DIMENSION_MAX], p[DIMENSION_MAX], start; /* H0 */
    double error[SAMPLES_MAX];
} orbit;

typedef struct {
    const line *line;
    const tvi_system *system;
    orbit orbit[ORBITS];
    int samples;
    long steps[SAMPLES_MAX]; /* of a sample, from the start */
    atomic_int next;         /* orbit to advance */
} ensemble;

/* -1 to 1: xorshift64*. */
static double random_number(uint64_t *state)
{
    *state ^= *state >> 12, *state ^= *state << 25, *state ^= *state >> 27;
    return (double)(*state * UINT64_C(2685821657736338717) >> 11) * 0x1p-52 - 1;
}

static double energy(const tvi_system *system, const orbit *o)
{
    double H;
    const tvi_status status = tvi_energy(system, o->t, o->q, o->p, &H);
    if (status != TVI_OK) experiment_fail("energy", tvi_status_string(status));
    return H;
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

static void orbit_begin(orbit *o, const scene *s, const tvi_system *system, const tvi_options *options, uint64_t *seed)
{
    memset(o, 0, sizeof *o);
    const tvi_status status = tvi_integrator_create(&o->integrator, system, options);
    if (status != TVI_OK) experiment_fail("integrator", tvi_status_string(status));
    for (int i = 0; i < s->n; i++) {
        o->q[i] = s->q[i] * (1 + PERTURBATION * random_number(seed));
        o->p[i] = s->p[i] * (1 + PERTURBATION * random_number(seed));
    }
    centre(o, s);
    o->start = energy(system, o);
}

/* Without its low-order parts a step is the plain sum of state and increment. What else it has learnt
 * is forgotten too. */
static tvi_status uncompensated(orbit *o, double h, long steps)
{
    tvi_status status = TVI_OK;
    for (long i = 0; i < steps && status == TVI_OK; i++) {
        tvi_integrator_reset(o->integrator);
        status = tvi_step(o->integrator, h, &o->t, o->q, o->p);
    }
    return status;
}

static void *advance_some(void *ctx)
{
    ensemble *all = ctx;
    const int k = all->samples;
    const long steps = all->steps[k] - (k > 0 ? all->steps[k - 1] : 0);
    for (int i; (i = atomic_fetch_add(&all->next, 1)) < ORBITS;) {
        orbit *o = &all->orbit[i];
        const double h = all->line->h;
        const tvi_status status = all->line->compensated
                                      ? tvi_integrate(o->integrator, h, steps, &o->t, o->q, o->p, NULL, NULL)
                                      : uncompensated(o, h, steps);
        if (status != TVI_OK) experiment_fail("step", tvi_status_string(status));
        o->error[k] = (energy(all->system, o) - o->start) / fabs(o->start);
    }
    return NULL;
}

static void advance(ensemble *all)
{
    pthread_t thread[THREADS];
    atomic_store(&all->next, 0);
    for (int i = 0; i < THREADS; i++)
        if (pthread_create(&thread[i], NULL, advance_some, all) != 0) experiment_fail("threads", "cannot be made");
    for (int i = 0; i < THREADS; i++) pthread_join(thread[i], NULL);
    all->samples++;
}

/* Sample after sample, as long as the next one is expected to be over in time. */
static void run_line(ensemble *all, const line *l, const tvi_system *system, double seconds)
{
    const scene *s = &scene_solar;
    const experiment_method method = experiment_find(l->name, l->order);
    const double begin = run_wall_clock();
    uint64_t seed = 1;
    all->line = l, all->system = system, all->samples = 0;
    for (int i = 0; i < ORBITS; i++) orbit_begin(&all->orbit[i], s, system, &method.who.options, &seed);
    while (all->samples < SAMPLES_MAX) {
        const int k = all->samples;
        all->steps[k] = lround(pow(10, 1 + (double)k / SAMPLES_A_DECADE));
        const double spent = run_wall_clock() - begin;
        if (k > 0 && spent * (double)all->steps[k] > seconds * (double)all->steps[k - 1]) break;
        advance(all);
    }
    for (int i = 0; i < ORBITS; i++) tvi_integrator_free(all->orbit[i].integrator);
}

/* ---- Statistics -------------------------------------------------------------------------------------------------- */

static double years(const ensemble *all, int k) { return (double)all->steps[k] * all->line->h / DAYS_A_YEAR; }

/* Of sample k over the orbits but one; without = -1: over all. */
static double rms(const ensemble *all, int k, int without)
{
    double squares = 0;
    for (int i = 0; i < ORBITS; i++)
        if (i != without) squares += all->orbit[i].error[k] * all->orbit[i].error[k];
    return sqrt(squares / (without < 0 ? ORBITS : ORBITS - 1));
}

/* The least-squares slope of log rms against log t; NAN where there are not three points. */
static double exponent(const ensemble *all, int without)
{
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (int k = 0; k < all->samples; k++) {
        if ((double)all->steps[k] < FIT_FROM) continue;
        const double u = log((double)all->steps[k]), v = log(rms(all, k, without));
        n++, x += u, y += v, xx += u * u, xy += u * v;
    }
    return n < 3 ? NAN : (n * xy - x * y) / (n * xx - x * x);
}

/* Half the width of the 95% interval, from the exponents with one orbit left out (jackknife). */
static double exponent_interval(const ensemble *all)
{
    double sum = 0, squares = 0;
    for (int i = 0; i < ORBITS; i++) {
        const double d = exponent(all, i) - exponent(all, -1);
        sum += d, squares += d * d;
    }
    return STUDENT * sqrt((squares - sum * sum / ORBITS) * (ORBITS - 1) / ORBITS);
}

typedef struct {
    double mean, interval; /* half the width, 95% */
} estimate;

/* The energy error with its sign at sample k: what all orbits have in common. */
static estimate drift(const ensemble *all, int k)
{
    double sum = 0, squares = 0;
    for (int i = 0; i < ORBITS; i++) sum += all->orbit[i].error[k];
    const double mean = sum / ORBITS;
    for (int i = 0; i < ORBITS; i++) squares += pow(all->orbit[i].error[k] - mean, 2);
    return (estimate){mean, STUDENT * sqrt(squares / (ORBITS - 1) / ORBITS)};
}

/* ---- Files ------------------------------------------------------------------------------------------------------- */

static void write_line(const ensemble *all, FILE *csv, FILE *table)
{
    const line *l = all->line;
    const char *sums = l->compensated ? "compensated" : "plain";
    for (int k = 0; k < all->samples; k++)
        fprintf(csv, "%s %s,%ld,%.6g,%.4e,%.4e\n", l->name, sums, all->steps[k], years(all, k), rms(all, k, -1),
                drift(all, k).mean);
    const int last = all->samples - 1;
    const double a = exponent(all, -1), interval = exponent_interval(all);
    const estimate common = drift(all, last);
    const bool brouwer = fabs(a - 0.5) + interval <= 0.15;
    fprintf(table, "| %s, order %d | %s | %g | %.3g | %.3g | %.1e |", l->name, l->order, sums, l->h,
            (double)all->steps[last] / 1e6, years(all, last) / 1e6, rms(all, last, -1));
    if (isfinite(interval)) fprintf(table, " %.2f ± %.2f | %s |", a, interval, brouwer ? "yes" : "no");
    else fprintf(table, " - | - |"); /* too short */
    fprintf(table, " %.1e ± %.1e | %s |\n", common.mean, common.interval,
            fabs(common.mean) <= common.interval ? "no" : "yes");
    experiment_progress("%s %s: %.3g years, rms %.1e, exponent %.2f +- %.2f, drift %.1e +- %.1e", l->name, sums,
                        years(all, last), rms(all, last, -1), a, interval, common.mean, common.interval);
}

int main(int argc, char *argv[])
{
    sweep_insist_on_one_thread(argv);
    const double minutes = argc == 3 ? strtod(argv[2], NULL) : 0;
    if (!(minutes > 0)) experiment_fail("longrun", "usage: longrun DIR MINUTES");
    const experiment e = {argv[1], argc, argv};
    FILE *csv = experiment_csv(&e, "longrun", "line,steps,years,rms,mean");
    FILE *table = experiment_table(
        &e, "longrun",
        " method | sums | h, days | million steps | million years | rms at the end | exponent and 95% | "
        "Brouwer | mean at the end and 95% | drift ");
    tvi_system *system = experiment_system(&scene_solar);
    ensemble *all = malloc(sizeof *all);
    if (!all) experiment_fail("longrun", "no memory");
    for (int i = 0; i < LINES; i++) {
        run_line(all, &lines[i], system, 60 * minutes * lines[i].share);
        write_line(all, csv, table);
    }
    free(all);
    tvi_system_free(system);
    experiment_close(csv);
    experiment_close(table);
}
