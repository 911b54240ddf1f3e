/* chaos.c - Measures order and chaos of the three Henon-Heiles orbits of docs/method.md section 9, by the tangent map:
 * the largest Lyapunov exponent and MEGNO, for docs/chaos.md; and what a column costs.
 *
 *   chaos DIR */
#include "experiments/experiment.h"
#include "scenes/hard.h"

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

/* With d_k the length of the tangent vector after k steps, at t_k (Cincotta, Giordano and Simo, Physica D 182 (2003),
 * for maps, where t_k = k): lambda = ln(d_k/d_0) / t_k,   Y_k = (2/t_k) sum_{j <= k} t_j ln(d_j/d_{j-1}),
 * MEGNO = (1/t_k) sum_{j <= k} (t_j - t_{j-1}) Y_j. */
typedef struct {
    double t, logarithm, weighted, area; /* t_k, and the sums */
} growth;

static double note_growth(growth *g, double t, double ratio)
{
    g->logarithm += log(ratio);
    g->weighted += t * log(ratio);
    g->area += 2 / t * g->weighted * (t - g->t);
    g->t = t;
    return g->area / t;
}

/* D of 2 n rows is brought back to length 1; returns what its length was. */
static double normalize(int n, double D[])
{
    double sum = 0;
    for (int i = 0; i < 2 * n; i++) sum += D[i] * D[i];
    for (int i = 0; i < 2 * n; i++) D[i] /= sqrt(sum);
    return sqrt(sum);
}

typedef struct {
    double exponent, megno;
} chaos;

/* Rows of the table in at[], the CSV file, and the largest relative energy error. */
static double measure(const tvi_system *system, int orbit, FILE *csv, chaos at[DECADES])
{
    tvi_integrator *integrator;
    double t = 0, q[N], p[N], D[2 * N] = {0.5, 0.5, 0.5, 0.5}, H0, H, worst = 0, next = 20;
    growth g = {0};
    int row = 0;
    long row_step = FIRST;
    memcpy(q, orbits[orbit].q, sizeof q);
    memcpy(p, orbits[orbit].p, sizeof p);
    experiment_insist(tvi_integrator_create(&integrator, system, NULL), "the integrator");
    experiment_insist(tvi_energy(system, t, q, p, &H0), "the energy");
    for (long step = 1; step <= LAST; step++) {
        experiment_insist(tvi_step_tangent(integrator, H_STEP, &t, q, p, D, 1), "a step");
        experiment_insist(tvi_energy(system, t, q, p, &H), "the energy");
        worst = fmax(worst, fabs((H - H0) / H0));
        const double megno = note_growth(&g, t, normalize(N, D));
        if ((double)step >= next) {
            fprintf(csv, "%s,%.10g,%.6e,%.6e\n", orbits[orbit].label, t, g.logarithm / t, megno);
            next *= CSV_RATIO;
        }
        if (step != row_step) continue;
        at[row++] = (chaos){g.logarithm / t, megno};
        row_step *= 10;
    }
    tvi_integrator_free(integrator);
    return worst;
}

static void write_exponents(const experiment *e, const tvi_system *system)
{
    chaos at[ORBITS][DECADES];
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

/* D starts as in measure; a row of the table. */
static void write_orbit(FILE *table, int i)
{
    const scene *s = &adapted[i].problem->scene;
    tvi_system *system = experiment_system(s), *rescaled;
    tvi_integrator *integrator;
    double t = 0, q[ADAPTED_N], p[ADAPTED_N], D[2 * ADAPTED_N] = {0.5, 0.5, 0.5, 0.5};
    double megno = 0, shortest = INFINITY, longest = 0;
    growth g = {0};
    memcpy(q, s->q, (size_t)s->n * sizeof *q);
    memcpy(p, s->p, (size_t)s->n * sizeof *p);
    if (adapted[i].q0 > 0) q[0] = adapted[i].q0;
    experiment_insist(tvi_system_rescaled(&rescaled, system, adapted[i].problem->scale, NULL), s->name);
    experiment_insist(tvi_integrator_create(&integrator, rescaled, NULL), s->name);
    while (t < adapted[i].t_end) {
        experiment_insist(tvi_step_tangent(integrator, adapted[i].h, &t, q, p, D, 1), s->name);
        shortest = fmin(shortest, t - g.t);
        longest = fmax(longest, t - g.t);
        megno = note_growth(&g, t, normalize(s->n, D));
    }
    fprintf(table, "| %s | %.0f | %ld | %.2g | %.2g | %.2g | %.4g |\n", adapted[i].label, adapted[i].t_end,
            tvi_integrator_stats(integrator)->steps, shortest, longest, g.logarithm / t, megno);
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

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    tvi_system *system = experiment_system(&scene_henon_heiles_8);
    write_exponents(&e, system);
    write_adapted(&e);
    write_costs(&e);
    tvi_system_free(system);
    return EXIT_SUCCESS;
}
