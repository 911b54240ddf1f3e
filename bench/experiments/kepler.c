/* kepler.c - Runs the paper's Kepler problem: orbits at h = 0.25 to t = 250 by variational and Taylor methods of one
 * order, and Stormer-Verlet against SVHd. */
#include "experiment.h"

#include <math.h>

/* ---- Orbits --------------------------------------------------------------------------------------------------- */

typedef struct {
    experiment_energy energy;
    FILE *csv;
    const char *method;
    double nearest, farthest; /* distances from the centre */
    double momentum;          /* max |L - 0.8| / 0.8 */
} orbit;

static int watch(long step, double t, const double q[], const double p[], void *ctx)
{
    orbit *o = ctx;
    (void)step;
    const double e = experiment_energy_note(&o->energy, t, q, p), r = hypot(q[0], q[1]);
    fprintf(o->csv, "%s,%.10g,%.6e,%.6e,%.6e\n", o->method, t, q[0], q[1], e);
    o->nearest = fmin(o->nearest, r);
    o->farthest = fmax(o->farthest, r);
    o->momentum = fmax(o->momentum, fabs((q[0] * p[1] - q[1] * p[0]) / 0.8 - 1));
    return 0;
}

static const char titles[] =
    " method | derivatives | mean energy error | largest | angular momentum | position at t = 250 "
    "| nearest | farthest ";

/* Draws the orbit; table NULL: writes no row. */
static void run_orbit(const experiment_method *method, const tvi_system *system, FILE *csv, FILE *table)
{
    orbit o = {experiment_energy_begin(system, &scene_kepler), csv, method->label, INFINITY, 0, 0};
    const experiment_end end = experiment_run(method, system, &scene_kepler, 0.25, watch, &o, false);
    if (!table) return;
    fprintf(table, "| %s | %d |", method->label, experiment_degree(method, system));
    if (end.status != TVI_OK) {
        fprintf(table, " step %ld of 1000: %s | - | - | - | - | - |\n", end.steps + 1, tvi_status_string(end.status));
        return;
    }
    experiment_cell(table, experiment_energy_mean(&o.energy), 10);
    experiment_cell(table, o.energy.worst, 10);
    experiment_cell(table, o.momentum, 10);
    experiment_cell(table, experiment_distance(2, end.q, scene_kepler.reference), 1);
    if (o.energy.worst > 10) fprintf(table, " lost | lost |\n");
    else fprintf(table, " %.3g | %.3g |\n", o.nearest, o.farthest);
}

static void orbits(const experiment *e, const tvi_system *system)
{
    static const int orders[] = {4, 6, 8};
    FILE *csv = experiment_csv(e, "kepler_orbits", "method,t,q1,q2,energy_error");
    FILE *table = experiment_table(e, "kepler_orbits", titles);
    for (int i = 0; i < 3; i++) {
        const experiment_method taylor = experiment_find("taylor", orders[i]);
        const experiment_method methods[] = {
            experiment_find("tvi", orders[i]), experiment_find("htvi-right", orders[i]),
            experiment_find("symmetric-tvi", orders[i]), experiment_find("start", 2 * orders[i]),
            experiment_find("midpoint", 2 * orders[i])};
        run_orbit(&taylor, system, csv, NULL);
        for (int m = 0; m < 5; m++) run_orbit(&methods[m], system, csv, table);
    }
    experiment_close(csv);
    experiment_close(table);
}

/* ---- Stormer-Verlet and SVHd ---------------------------------------------------------------------------------- */

static void verlet(const experiment *e, const tvi_system *system)
{
    const experiment_method methods[] = {experiment_find("stormer-verlet", 2), experiment_find("svhd", 2),
                                         experiment_find("right", 2), experiment_find("midpoint", 2)};
    const experiment_sweep sweep = {.name = "kepler_verlet",
                                    .scene = &scene_kepler,
                                    .by_energy = true,
                                    .shown = {0.25, 0.125, 0.03125},
                                    .targets = {1e-2, 1e-3, 1e-4},
                                    .longest = 0.3};
    experiment_sweep_run(e, &sweep, sizeof methods / sizeof *methods, methods);
    FILE *csv = experiment_csv(e, "kepler_verlet_energy", "method,t,q1,q2,energy_error");
    for (int m = 0; m < 4; m++) run_orbit(&methods[m], system, csv, NULL);
    experiment_close(csv);
}

/* An H that does not separate: ((q^2 + 1)(p^2 + 1))/2, on which Stormer-Verlet is no method of the library. */
static void nonseparable(const experiment *e)
{
    const experiment_method methods[] = {experiment_find("svhd", 2), experiment_find("right", 2),
                                         experiment_find("midpoint", 2), experiment_find("poincare", 2)};
    const experiment_sweep sweep = {.name = "verlet_nonseparable",
                                    .scene = &scene_nonseparable,
                                    .by_energy = true,
                                    .shown = {0.25, 0.125, 0.03125},
                                    .targets = {1e-2, 1e-3, 1e-4},
                                    .longest = 0.1};
    experiment_sweep_run(e, &sweep, sizeof methods / sizeof *methods, methods);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    tvi_system *system = experiment_system(&scene_kepler);
    orbits(&e, system);
    verlet(&e, system);
    nonseparable(&e);
    tvi_system_free(system);
}
