/* solar.c - Runs the paper's outer Solar System: 200,000 days at h = 400, orders 4 and 6; the planets
 * relative to the Sun. */
#include "experiment.h"

#include <math.h>

enum { PLANETS = 5, JUPITER = 1 };
static const double step = 400;

typedef struct {
    experiment_energy energy;
    FILE *csv;
    const char *method;
    double nearest, farthest; /* Jupiter's distance from the Sun */
} orbit;

static int watch(long k, double t, const double q[], const double p[], void *ctx)
{
    orbit *o = ctx;
    (void)k;
    const double e = experiment_energy_note(&o->energy, t, q, p);
    for (int i = 1; i <= PLANETS; i++) {
        const double *planet = q + 3 * i, x = planet[0] - q[0], y = planet[1] - q[1], z = planet[2] - q[2];
        fprintf(o->csv, "%s,%d,%.0f,%.5f,%.5f,%.5f,%.4e\n", o->method, i, t, x, y, z, e);
        if (i != JUPITER) continue;
        o->nearest = fmin(o->nearest, sqrt(x * x + y * y + z * z));
        o->farthest = fmax(o->farthest, sqrt(x * x + y * y + z * z));
    }
    return 0;
}

static void run_method(const experiment_method *method, const tvi_system *system, FILE *csv, FILE *table)
{
    const scene *s = &scene_solar;
    orbit o = {experiment_energy_begin(system, s), csv, method->label, INFINITY, 0};
    experiment_progress("  %s", method->label);
    const experiment_end end = experiment_run(method, system, s, step, watch, &o, true);
    fprintf(table, "| %s | ", method->label);
    const int degree = experiment_degree(method, system);
    fprintf(table, degree >= 0 ? "%d |" : "- |", degree);
    if (end.status != TVI_OK) {
        fprintf(table, " step %ld of %ld: %s | - | - | - | - | - |\n", end.steps + 1, lround(s->t_end / step),
                tvi_status_string(end.status));
        return;
    }
    experiment_cell(table, experiment_energy_mean(&o.energy), 10);
    experiment_cell(table, o.energy.worst, 10);
    fprintf(table, " %.1f |", end.passes_per_step);
    experiment_cell(table, experiment_distance(s->n, end.q, s->reference), 50);
    if (o.energy.worst > 10) fprintf(table, " lost |");
    else fprintf(table, " %.2f to %.2f |", o.nearest, o.farthest);
    fprintf(table, " %.0f |\n", 1e3 * end.cpu);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    const experiment_method methods[] = {
        experiment_find("taylor", 4),   experiment_find("tvi", 4),    experiment_find("symmetric-tvi", 4),
        experiment_find("shooting", 4), experiment_find("start", 8),  experiment_find("midpoint", 8),
        experiment_find("taylor", 6),   experiment_find("tvi", 6),    experiment_find("symmetric-tvi", 6),
        experiment_find("shooting", 6), experiment_find("start", 12), experiment_find("midpoint", 12)};
    FILE *csv = experiment_csv(&e, "solar", "method,planet,t,x,y,z,energy_error");
    FILE *table = experiment_table(
        &e, "solar",
        " method | derivatives | mean energy error | largest | passes a step | positions at the end, AU "
        "| Jupiter's distance, AU | ms (time) ");
    tvi_system *system = experiment_system(&scene_solar);
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) run_method(&methods[m], system, csv, table);
    tvi_system_free(system);
    experiment_close(csv);
    experiment_close(table);
}
