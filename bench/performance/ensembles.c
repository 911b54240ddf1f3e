/* ensembles.c - Measures what a step of an orbit costs in an ensemble, beside that of an integrator, for
 * docs/ensembles.md: the same orbits, taken in turns. Writes DIR/ensembles.md; the compiler's cache is DIR/generated.
 *
 *   ensembles DIR */
#include "experiments/experiment.h"
#include "turns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MEMBERS = 256, STEPS = 200, N_MOST = 18, REPETITIONS = 5 };
static const double SPREAD = 1e-3; /* of the starts, relative */

typedef struct {
    const scene *scene;
    const char *title, *method;
    int order;
    double h;
} row;
static const row rows[] = {
    {&scene_kepler, "Kepler", "galerkin", 16, 0.25},
    {&scene_henon_heiles_8, "Henon-Heiles", "galerkin", 16, 0.5},
    {&scene_fpu, "FPU", "galerkin", 16, 0.03906},
    {&scene_solar, "Solar System", "galerkin", 16, 400},
    {&scene_kepler, "Kepler", "taylor", 12, 0.125},
    {&scene_henon_heiles_8, "Henon-Heiles", "taylor", 12, 0.25},
    {&scene_fpu, "FPU", "taylor", 12, 0.02},
    {&scene_solar, "Solar System", "taylor", 12, 100},
    {&scene_kepler, "Kepler", "midpoint", 12, 0.125},
    {&scene_henon_heiles_8, "Henon-Heiles", "midpoint", 12, 0.25},
    {&scene_pendulum, "pendulum", "midpoint", 12, 0.25},
    {&scene_kepler, "Kepler", "poincare", 12, 0.125},
    {&scene_kepler, "Kepler", "stormer-verlet", 2, 0.01},
    {&scene_solar, "Solar System", "stormer-verlet", 2, 20},
};
enum { ROWS = sizeof rows / sizeof *rows };

/* ---- The orbits -------------------------------------------------------------------------------------------------- */

typedef struct {
    const row *entry;
    tvi_integrator *alone;
    tvi_ensemble *together;
    double t[MEMBERS], q[N_MOST * MEMBERS], p[N_MOST * MEMBERS];
    tvi_status status[MEMBERS];
} orbits;

static orbits *open_orbits(const row *entry, const tvi_system *system, const tvi_options *options, int threads)
{
    orbits *o = calloc(1, sizeof *o);
    if (!o) abort();
    o->entry = entry;
    experiment_insist(tvi_integrator_create(&o->alone, system, options), "an integrator");
    experiment_insist(tvi_ensemble_create(&o->together, system, options, MEMBERS, threads), "an ensemble");
    return o;
}

static void close_orbits(orbits *o)
{
    tvi_integrator_free(o->alone);
    tvi_ensemble_free(o->together);
    free(o);
}

/* Start of member m: the scene's, a little apart. */
static double spread(int m) { return 1 + SPREAD * m / MEMBERS; }

static void run_alone(void *ctx)
{
    const orbits *o = ctx;
    const scene *s = o->entry->scene;
    for (int m = 0; m < MEMBERS; m++) {
        double t = 0, q[N_MOST], p[N_MOST];
        for (int i = 0; i < s->n; i++) q[i] = spread(m) * s->q[i], p[i] = s->p[i];
        experiment_insist(tvi_integrate(o->alone, o->entry->h, STEPS, &t, q, p, NULL, NULL), o->entry->method);
    }
}

/* Makes STEPS steps, after which a member may be anywhere. */
static void run_steps(orbits *o, long steps)
{
    const scene *s = o->entry->scene;
    for (int m = 0; m < MEMBERS; m++) {
        o->t[m] = 0;
        for (int i = 0; i < s->n; i++) o->q[i * MEMBERS + m] = spread(m) * s->q[i], o->p[i * MEMBERS + m] = s->p[i];
    }
    experiment_insist(tvi_ensemble_integrate(o->together, o->entry->h, steps, o->t, o->q, o->p, o->status, NULL, NULL),
                      "a run");
}

static void run_together(void *ctx)
{
    orbits *o = ctx;
    run_steps(o, STEPS);
    for (int m = 0; m < MEMBERS; m++) experiment_insist(o->status[m], "a member");
}

/* ns of a step of one orbit. */
static double cost_of(const turn *t) { return 1e9 * t->seconds / ((double)MEMBERS * STEPS); }

/* How many times faster two threads are than one, by the clock on the wall, in runs of a quarter of a second. */
static double speedup(orbits *one, orbits *two, double cost)
{
    const long steps = (long)(0.25e9 / (cost * MEMBERS));
    orbits *const both[] = {one, two};
    double least[] = {INFINITY, INFINITY};
    for (int k = 0; k < 2 * REPETITIONS; k++) {
        const double start = turns_wall();
        run_steps(both[k % 2], steps);
        least[k % 2] = fmin(least[k % 2], turns_wall() - start);
    }
    return least[0] / least[1];
}

static void write_row(FILE *table, const experiment *e, const row *entry)
{
    tvi_options options;
    tvi_system *system = experiment_system(entry->scene);
    experiment_insist(tvi_options_named(entry->method, entry->order, &options), entry->method);
    tvi_options compiled = options;
    tvi_compiled *code = experiment_compile(e, system, &options);
    compiled.compiled = code;
    orbits *plain = open_orbits(entry, system, &options, 1), *own = open_orbits(entry, system, &compiled, 1);
    orbits *two = open_orbits(entry, system, &options, 2);
    turn t[] = {{.work = run_alone, .ctx = plain},
                {.work = run_together, .ctx = plain},
                {.work = run_alone, .ctx = own},
                {.work = run_together, .ctx = own}};
    turns_time(4, t);
    const double ratio = t[0].seconds / t[1].seconds;
    fprintf(table, "| %s | %s %d | %g | %.0f | %.0f | %.2f |", entry->title, entry->method, entry->order, entry->h,
            cost_of(&t[0]), cost_of(&t[1]), ratio);
    fprintf(table, " %.0f | %.0f | %.2f |\n", cost_of(&t[2]), cost_of(&t[3]), speedup(plain, two, cost_of(&t[1])));
    close_orbits(plain);
    close_orbits(own);
    close_orbits(two);
    tvi_compiled_free(code);
    tvi_system_free(system);
    experiment_progress("ensembles: %s, %s", entry->title, entry->method);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    FILE *table = experiment_table(&e, "ensembles",
                                   " orbit | method | h | alone, ns a step (time) | in an ensemble (time) | times "
                                   "faster (time) | compiled, alone (time) | in an ensemble "
                                   "(time) | two threads, times faster (time) ");
    for (int i = 0; i < ROWS; i++) write_row(table, &e, &rows[i]);
    experiment_close(table);
    return EXIT_SUCCESS;
}
