/* chaos.c - Measures order and chaos of the three Henon-Heiles orbits of docs/method.md section 9, by the tangent map:
 * the largest Lyapunov exponent and MEGNO, for docs/chaos.md; and what they and a column cost.
 *
 *   chaos DIR */
#include "experiments/experiment.h"
#include "scenes/hard.h"
#include "tvi_bodies.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 2 };
static const double H_STEP = 0.5;

static const struct {
    const char *label;
    double q[N], p[N];
} orbits[] = {
    {"1/12", {0.25, -0.25}, {0.25, 0}},
    {"1/8 (regular)", {0, 0.375}, {0.375, 0.0625}},
    {"1/8 (chaotic)", {0.25, 0.375}, {0.1875, 0}},
};
enum { ORBITS = sizeof orbits / sizeof *orbits };

enum { DECADES = 4, FIRST = 200, LAST = 200000 }; /* rows of the tables at FIRST 10^k steps */
static const double CSV_RATIO = 1.08;             /* of the times in the CSV file */

typedef struct {
    double exponent, megno;
} chaos_row;

/* What an observer of steps makes of a run: rows of the table in at[], the CSV file, and the largest relative energy
 * error. */
typedef struct {
    const tvi_system *system;
    const tvi_chaos *chaos;
    int orbit, row;
    FILE *csv;
    chaos_row *at;
    double H0, worst, next;
    long row_step;
} orbit_diary;

static int note_step(int member, int step, double t, const double q[], const double p[], void *ctx)
{
    orbit_diary *d = ctx;
    double H;
    (void)member;
    experiment_insist(tvi_energy(d->system, t, q, p, &H), "the energy");
    d->worst = fmax(d->worst, fabs((H - d->H0) / d->H0));
    if ((double)step >= d->next) {
        fprintf(d->csv, "%s,%.10g,%.6e,%.6e\n", orbits[d->orbit].label, t, d->chaos->lyapunov, d->chaos->megno);
        d->next *= CSV_RATIO;
    }
    if (step != d->row_step) return 0;
    d->at[d->row++] = (chaos_row){d->chaos->lyapunov, d->chaos->megno};
    d->row_step *= 10;
    return 0;
}

/* Returns the largest relative energy error. */
static double measure(const tvi_system *system, int orbit, FILE *csv, chaos_row at[DECADES])
{
    tvi_integrator *integrator;
    tvi_chaos chaos = {0};
    double t = 0, q[N], p[N];
    orbit_diary diary = {
        .system = system, .chaos = &chaos, .orbit = orbit, .csv = csv, .at = at, .next = 20, .row_step = FIRST};
    const tvi_run_plan plan = {.h = H_STEP, .steps = LAST, .at_step = note_step, .ctx = &diary};
    memcpy(q, orbits[orbit].q, sizeof q);
    memcpy(p, orbits[orbit].p, sizeof p);
    experiment_insist(tvi_integrator_create(&integrator, system, NULL), "the integrator");
    experiment_insist(tvi_energy(system, t, q, p, &diary.H0), "the energy");
    experiment_insist(tvi_run_chaos(integrator, &plan, &chaos, &t, q, p), "a run");
    tvi_integrator_free(integrator);
    return diary.worst;
}

static void write_exponents(const experiment *e, const tvi_system *system)
{
    chaos_row at[ORBITS][DECADES];
    double worst = 0;
    FILE *csv = experiment_csv(e, "chaos", "H,t,exponent,megno");
    for (int orbit = 0; orbit < ORBITS; orbit++) {
        worst = fmax(worst, measure(system, orbit, csv, at[orbit]));
        experiment_progress("H = %s", orbits[orbit].label);
    }
    experiment_close(csv);
    FILE *table = experiment_table(
        e, "chaos",
        " t | exponent, H = 1/12 | exponent, H = 1/8 | exponent, H = 1/8 (chaotic) | MEGNO, H = 1/12 | "
        "MEGNO, H = 1/8 | MEGNO, H = 1/8 (chaotic) ");
    long step = FIRST;
    for (int row = 0; row < DECADES; row++, step *= 10) {
        fprintf(table, "| %g |", (double)step * H_STEP);
        for (int orbit = 0; orbit < ORBITS; orbit++) fprintf(table, " %.2g |", at[orbit][row].exponent);
        for (int orbit = 0; orbit < ORBITS; orbit++) fprintf(table, " %.4g |", at[orbit][row].megno);
        fprintf(table, "\n");
    }
    experiment_close(table);
    experiment_progress("largest relative energy error: %.1e", worst);
}

/* ---- Steps that adapt -------------------------------------------------------------------------------------------- */

static const struct {
    const hard_scene *problem;
    const char *label;
    double q0; /* in the place of the scene's q[0]; 0: not */
    double h, t_end;
} adapted[] = {
    {&hard_kepler_90, "Kepler, e = 0.9", 0, 0.8, 1e4},
    {&hard_sitnikov, "Sitnikov, e = 0.6, from q = 0.5", 0.5, 0.5, 1e4},
    {&hard_sitnikov, "Sitnikov, e = 0.6, from q = 0.8", 0.8, 0.5, 2e3},
};
enum { ADAPTED = sizeof adapted / sizeof *adapted, ADAPTED_N = 2 };

typedef struct {
    double t, shortest, longest;
} step_sizes;

static int note_size(int member, int step, double t, const double q[], const double p[], void *ctx)
{
    step_sizes *sizes = ctx;
    (void)member, (void)step, (void)q, (void)p;
    sizes->shortest = fmin(sizes->shortest, t - sizes->t);
    sizes->longest = fmax(sizes->longest, t - sizes->t);
    sizes->t = t;
    return 0;
}

/* A row of the table. Its last step is that to the next whole step of s. */
static void write_orbit(FILE *table, int i)
{
    const scene *s = &adapted[i].problem->scene;
    tvi_system *system = experiment_system(s), *rescaled;
    tvi_integrator *integrator;
    tvi_chaos chaos = {0};
    double t = 0, q[ADAPTED_N], p[ADAPTED_N];
    step_sizes sizes = {0, INFINITY, 0};
    memcpy(q, s->q, (size_t)s->n * sizeof *q);
    memcpy(p, s->p, (size_t)s->n * sizeof *p);
    if (adapted[i].q0 > 0) q[0] = adapted[i].q0;
    const tvi_run_plan plan = {
        .h = adapted[i].h, .times = &adapted[i].t_end, .time_count = 1, .at_step = note_size, .ctx = &sizes};
    experiment_insist(tvi_system_rescaled(&rescaled, system, adapted[i].problem->scale, NULL), s->name);
    experiment_insist(tvi_integrator_create(&integrator, rescaled, NULL), s->name);
    experiment_insist(tvi_run_chaos(integrator, &plan, &chaos, &t, q, p), s->name);
    fprintf(table, "| %s | %.0f | %ld | %.2g | %.2g | %.2g | %.4g |\n", adapted[i].label, adapted[i].t_end,
            tvi_integrator_stats(integrator)->steps, sizes.shortest, sizes.longest, chaos.lyapunov, chaos.megno);
    tvi_integrator_free(integrator);
    tvi_system_free(rescaled);
    tvi_system_free(system);
}

static void write_adapted(const experiment *e)
{
    FILE *table =
        experiment_table(e, "chaos_adapted",
                         " orbit | to t | steps (chaotic) | shortest (chaotic) | longest (chaotic) | exponent "
                         "(chaotic) | MEGNO (chaotic) ");
    for (int i = 0; i < ADAPTED; i++) write_orbit(table, i);
    experiment_close(table);
}

/* ---- What a column costs --------------------------------------------------------------------------------------- */

/* Times n/2 planets of mass 1/1000 on circles in a plane, about a Sun of mass 1 that stands still. */
enum { COLUMNS = 4, TIMED_STEPS = 24000, REPETITIONS = 3, MOST = 24 };
static const int dimensions[] = {2, 6, MOST};
enum { DIMENSIONS = sizeof dimensions / sizeof *dimensions };
static const double PLANET = 0.001, PLANETS_STEP = 0.5;

static jet inverse_distance(const jet a[], const jet b[])
{
    const jet d[] = {jet_sub(a[0], b[0]), jet_sub(a[1], b[1])};
    return jet_pow(jet_dot(d, d, 2), -0.5);
}

static jet planets(const jet q[], jet t, void *ctx)
{
    const int n = *(const int *)ctx;
    const jet sun[] = {jet_const(0), jet_const(0)};
    jet V = jet_const(0);
    (void)t;
    for (int i = 0; i < n; i += 2) {
        V = jet_sub(V, jet_mul(PLANET, inverse_distance(q + i, sun)));
        for (int j = 0; j < i; j += 2) V = jet_sub(V, jet_mul(PLANET * PLANET, inverse_distance(q + i, q + j)));
    }
    return V;
}

static void start_planets(int n, double q[], double p[])
{
    for (int i = 0; i < n; i += 2) {
        const double radius = 1 + 0.5 * i, angle = i, speed = 1 / sqrt(radius);
        q[i] = radius * cos(angle), q[i + 1] = radius * sin(angle);
        p[i] = -PLANET * speed * sin(angle), p[i + 1] = PLANET * speed * cos(angle);
    }
}

/* us a step; columns 0: tvi_step. */
static double time_run(const tvi_system *system, const tvi_options *options, int columns)
{
    const int n = tvi_system_dimension(system), steps = TIMED_STEPS / (n * n);
    double t = 0, q[MOST], p[MOST], D[2 * MOST * COLUMNS] = {1}, before = 0;
    tvi_integrator *integrator;
    experiment_insist(tvi_integrator_create(&integrator, system, options), "the integrator");
    start_planets(n, q, p);
    for (int step = -1; step < steps; step++) { /* the first one makes what is kept */
        if (step == 0) before = run_clock();
        experiment_insist(columns == 0 ? tvi_step(integrator, PLANETS_STEP, &t, q, p)
                                       : tvi_step_tangent(integrator, PLANETS_STEP, &t, q, p, D, columns),
                          "a step");
    }
    tvi_integrator_free(integrator);
    return (run_clock() - before) / steps * 1e6;
}

/* us of a plain step, and a column in such steps: the fastest of runs that take turns. */
static void time_columns(int n, const tvi_options *options, double *step, double *column)
{
    tvi_system *system;
    double with = *step = INFINITY, mass[MOST];
    for (int i = 0; i < n; i++) mass[i] = PLANET;
    experiment_insist(tvi_system_potential(&system, n, mass, planets, &n), "the planets");
    for (int repetition = 0; repetition < REPETITIONS; repetition++) {
        *step = fmin(*step, time_run(system, options, 0));
        with = fmin(with, time_run(system, options, COLUMNS));
    }
    *column = (with - *step) / (COLUMNS * *step);
    tvi_system_free(system);
}

static void write_costs(const experiment *e)
{
    static const struct {
        const char *name;
        int order;
    } methods[] = {{"galerkin", 16}, {"galerkin", 8}, {"midpoint", 20},     {"poincare", 20},
                   {"right", 12},    {"taylor", 12},  {"stormer-verlet", 2}};
    FILE *table = experiment_table(e, "chaos_cost",
                                   " method | us a step, n = 2 (time) | n = 6 (time) | n = 24 (time) | a column in "
                                   "steps, n = 2 (time) | n = 6 (time) | n = 24 (time) ");
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        tvi_options options;
        double step[DIMENSIONS], column[DIMENSIONS];
        experiment_insist(tvi_options_named(methods[i].name, methods[i].order, &options), methods[i].name);
        for (int k = 0; k < DIMENSIONS; k++) time_columns(dimensions[k], &options, &step[k], &column[k]);
        fprintf(table, "| %s %d |", methods[i].name, methods[i].order);
        for (int k = 0; k < DIMENSIONS; k++) fprintf(table, " %.2g |", step[k]);
        for (int k = 0; k < DIMENSIONS; k++) fprintf(table, " %.1f |", column[k]);
        fprintf(table, "\n");
    }
    experiment_close(table);
}

/* ---- What it costs beside a run ---------------------------------------------------------------------------------- */

/* The Sun, Jupiter, Saturn and an asteroid without mass, in AU, years and masses of the Sun; angles in radians. */
enum { BODIES = 4, AXES = 3, BODIES_N = BODIES * AXES };
static const double BODY_MASSES[BODIES] = {1, 9.548e-4, 2.859e-4, 0}, BODIES_STEP = 0.4, YEARS = 1e5;
static const tvi_orbit JUPITER = {.a = 5.203, .e = 0.048, .i = 0.0228},
                       SATURN = {.a = 9.55, .e = 0.054, .i = 0.0434, .M = 2};
static const struct {
    const char *label;
    tvi_orbit orbit;
} asteroids[] = {
    {"a = 2.76, e = 0.08", {.a = 2.76, .e = 0.08, .i = 0.1, .M = 1}},
    {"a = 3.8, e = 0.2", {.a = 3.8, .e = 0.2, .i = 0.1, .M = 1}},
};

static void start_bodies(const tvi_bodies *b, const tvi_orbit *asteroid, double q[], double p[])
{
    const tvi_orbit *const orbit[] = {&JUPITER, &SATURN, asteroid};
    double v[BODIES_N] = {0};
    memset(q, 0, AXES * sizeof *q);
    for (int i = 1; i < BODIES; i++) {
        const tvi_status status = tvi_orbit_state(orbit[i - 1], b->G * (1 + b->mass[i]), q + AXES * i, v + AXES * i);
        experiment_insist(status, "an orbit");
    }
    tvi_bodies_momenta(b, v, p);
    tvi_bodies_to_centre(b, q, p);
}

typedef enum { PLAIN, AT_ONCE, ALONE, CHAOS, WAYS } way;

/* Returns s of a run of so many years. */
static double time_bodies(const tvi_bodies *b, const tvi_orbit *asteroid, way which, tvi_chaos *chaos)
{
    double t = 0, q[BODIES_N], p[BODIES_N], D[2 * BODIES_N] = {0};
    tvi_system *system;
    tvi_integrator *integrator;
    const bool has_D = which == AT_ONCE || which == ALONE;
    const tvi_run_plan plan = {.h = BODIES_STEP,
                               .t_end = YEARS,
                               .has_t_end = true,
                               .D = has_D ? D : NULL,
                               .columns = has_D,
                               .columns_at_once = which == AT_ONCE};
    D[BODIES_N - 1] = 1; /* dq of the asteroid; its momentum is of 1e-30 */
    experiment_insist(tvi_bodies_system(&system, b), "the bodies");
    experiment_insist(tvi_integrator_create(&integrator, system, NULL), "the integrator");
    start_bodies(b, asteroid, q, p);
    const double before = run_clock();
    experiment_insist(which == CHAOS ? tvi_run_chaos(integrator, &plan, chaos, &t, q, p)
                                     : tvi_run(integrator, &plan, &t, q, p),
                      "a run");
    const double seconds = run_clock() - before;
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return seconds;
}

static void write_asteroids(const experiment *e)
{
    const tvi_bodies b = {.bodies = BODIES, .axes = AXES, .mass = BODY_MASSES, .G = 4 * acos(-1) * acos(-1)};
    FILE *table = experiment_table(e, "chaos_asteroid",
                                   " asteroid | run, s (time) | with tvi_run_chaos, runs (time) | with a column at "
                                   "once, runs (time) | with one alone, runs (time) | exponent (chaotic) | MEGNO "
                                   "(chaotic) ");
    for (size_t i = 0; i < sizeof asteroids / sizeof *asteroids; i++) {
        tvi_chaos chaos;
        double seconds[WAYS] = {INFINITY, INFINITY, INFINITY, INFINITY};
        for (int repetition = 0; repetition < REPETITIONS; repetition++)
            for (int which = 0; which < WAYS; which++) {
                chaos = (tvi_chaos){0};
                seconds[which] = fmin(seconds[which], time_bodies(&b, &asteroids[i].orbit, (way)which, &chaos));
            }
        fprintf(table, "| %s | %.2f | %.2f | %.2f | %.2f | %.2g | %.4g |\n", asteroids[i].label, seconds[PLAIN],
                seconds[CHAOS] / seconds[PLAIN], seconds[AT_ONCE] / seconds[PLAIN], seconds[ALONE] / seconds[PLAIN],
                chaos.lyapunov, chaos.megno);
        experiment_progress("asteroid, %s", asteroids[i].label);
    }
    experiment_close(table);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    tvi_system *system = experiment_system(&scene_henon_heiles_8);
    write_exponents(&e, system);
    write_adapted(&e);
    write_asteroids(&e);
    write_costs(&e);
    tvi_system_free(system);
    return EXIT_SUCCESS;
}
