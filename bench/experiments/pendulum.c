/* pendulum.c - Runs the paper's pendulum: level sets of the energy and the orbits of TVI2 (example 2: degree 2,
 * trapezoid), TVI6 and Taylor 6 at h = 0.5, energy error against CPU time. */
#include "experiment.h"

#include <math.h>

#define PI 3.14159265358979323846

/* ---- Level sets: h = 0.1 to t = 20 ---------------------------------------------------------------------------- */

static const double starts[][2] = {{PI / 8, 0}, {PI / 4, 0}, {PI / 2, 0}, {3 * PI / 4, 0}, {0.95 * PI, 0},
                                   {-PI, 4},    {-PI, 6},    {PI, -4},    {PI, -6}};
enum { STARTS = sizeof starts / sizeof *starts };

typedef struct {
    experiment_energy energy;
    FILE *csv;
    const char *method;
    int orbit;
} drawer;

static int draw(long step, double t, const double q[], const double p[], void *ctx)
{
    (void)step;
    drawer *d = ctx;
    const double e = experiment_energy_note(&d->energy, t, q, p);
    fprintf(d->csv, "%s,%d,%.10g,%.10g,%.10g,%.4e\n", d->method, d->orbit, t, q[0], p[0], e);
    return 0;
}

/* One orbit into the CSV file, to its end or to the step that fails: energy.count steps. */
static experiment_energy draw_orbit(const experiment_method *method, const tvi_system *system, const scene *s, double h,
                                    int orbit, FILE *csv)
{
    drawer d = {experiment_energy_begin(system, s), csv, method->label, orbit};
    const experiment_end end = experiment_run(method, system, s, h, draw, &d, false);
    if (end.status != TVI_OK) experiment_progress("  %s, h = %g: %s", method->label, h, tvi_status_string(end.status));
    return d.energy;
}

static void level_sets(const experiment *e, const tvi_system *system)
{
    const experiment_method methods[] = {experiment_find_with("tvi", 2, TVI_TRAPEZOID, 0, "trapezoid"),
                                         experiment_find("midpoint", 4)};
    FILE *csv = experiment_csv(e, "pendulum_levels", "method,orbit,t,q,p,energy_error");
    for (int k = 0; k < STARTS; k++) {
        const double *q = &starts[k][0], *p = &starts[k][1];
        scene s = scene_pendulum;
        s.q = q, s.p = p, s.t_end = 20;
        for (int m = 0; m < 2; m++) draw_orbit(&methods[m], system, &s, 0.1, k, csv);
    }
    experiment_close(csv);
}

/* ---- Order 6 at h = 0.5 --------------------------------------------------------------------------------------- */

/* The paper does not name its quadrature: the one with the fewest points of order 6, one more, and Lobatto's. */
static void large_step(const experiment *e, const tvi_system *system)
{
    enum { METHODS = 7, STEPS = 3 };
    static const double steps[STEPS] = {0.5, 0.25, 0.125};
    scene s = scene_pendulum;
    s.t_end = 200;
    const experiment_method methods[METHODS] = {experiment_find_with("tvi", 6, TVI_GAUSS, 3, "Gauss 3"),
                                                experiment_find_with("tvi", 6, TVI_GAUSS, 4, "Gauss 4"),
                                                experiment_find_with("tvi", 6, TVI_LOBATTO, 4, "Lobatto 4"),
                                                experiment_find("symmetric-tvi", 6),
                                                experiment_find("taylor", 6),
                                                experiment_find("start", 12),
                                                experiment_find("midpoint", 12)};
    FILE *csv = experiment_csv(e, "pendulum_large_step", "method,1000 h,t,q,p,energy_error");
    FILE *table =
        experiment_table(e, "pendulum_large_step",
                         " method | derivatives | h = 0.5: steps of 400 (chaotic) | mean energy error (chaotic) "
                         "| largest (chaotic) | at the end (chaotic) | h = 0.25: mean | h = 0.125: mean ");
    for (int m = 0; m < METHODS; m++) {
        fprintf(table, "| %s | %d |", methods[m].label, experiment_degree(&methods[m], system));
        for (int k = 0; k < STEPS; k++) {
            const int orbit = (int)lround(1000 * steps[k]);
            const experiment_energy energy = draw_orbit(&methods[m], system, &s, steps[k], orbit, csv);
            if (k == 0) fprintf(table, " %ld |", energy.count);
            experiment_cell(table, experiment_energy_mean(&energy), 10);
            if (k > 0) continue;
            experiment_cell(table, energy.worst, 10);
            fprintf(table, " %+.1e |", energy.last);
        }
        fprintf(table, "\n");
    }
    experiment_close(csv);
    experiment_close(table);
}

/* ---- Energy error against CPU time ---------------------------------------------------------------------------- */

static void work(const experiment *e)
{
    const experiment_method methods[] = {
        experiment_find("tvi", 4),           experiment_find("tvi", 6),
        experiment_find("htvi-right", 4),    experiment_find("htvi-right", 6),
        experiment_find("shooting", 4),      experiment_find("shooting", 6),
        experiment_find("symmetric-tvi", 4), experiment_find_with("symmetric-tvi", 4, TVI_LOBATTO, 3, "Simpson"),
        experiment_find("both-ends", 6),     experiment_find("midpoint", 6),
        experiment_find("start", 8),         experiment_find("right", 8),
        experiment_find("midpoint", 8),      experiment_find("start", 12),
        experiment_find("right", 12),        experiment_find("midpoint", 12)};
    const experiment_sweep sweep = {.name = "pendulum_work",
                                    .scene = &scene_pendulum,
                                    .by_energy = true,
                                    .shown = {0.25, 0.125, 0.0625},
                                    .targets = {1e-4, 1e-6, 1e-8},
                                    .longest = 0.1};
    experiment_sweep_run(e, &sweep, sizeof methods / sizeof *methods, methods);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    tvi_system *system = experiment_system(&scene_pendulum);
    level_sets(&e, system);
    large_step(&e, system);
    work(&e);
    tvi_system_free(system);
}
