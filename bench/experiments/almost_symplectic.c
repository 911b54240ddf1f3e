/* almost_symplectic.c - Makes the paper's "almost symplectic" figure: the energy of the pendulum, h = 0.1, when the
 * corrector stops early: at a tolerance, or after a fixed number of passes. And the same for the on-curve forms with as
 * many derivatives. */
#include "experiment.h"

#include <math.h>

static const double step = 0.1, t_end = 10000;
enum { SAMPLE_EACH = 1000, SAMPLE_EVERY = 97 }; /* the first steps, and later steps between two points of the picture */

typedef struct {
    const char *label;
    double tolerance;
    int passes;
} stop;

static const stop stops[] = {{"no pass", 0, TVI_PREDICT_ONLY},
                             {"1 pass", 0, 1},
                             {"2 passes", 0, 2},
                             {"3 passes", 0, 3},
                             {"1e-4", 1e-4, 0},
                             {"1e-5", 1e-5, 0},
                             {"1e-6", 1e-6, 0},
                             {"1e-7", 1e-7, 0},
                             {"1e-8", 1e-8, 0},
                             {"1e-9", 1e-9, 0},
                             {"roundoff", 0, 0}};
enum { STOPS = sizeof stops / sizeof *stops };

static const struct {
    const char *name;
    int order, step_over; /* only every so many-th stop from the fifth on */
} methods[] = {{"tvi", 4, 1}, {"symmetric-tvi", 4, 6}, {"start", 8, 6}, {"midpoint", 8, 6}};
enum { METHODS = sizeof methods / sizeof *methods, FIXED = 4 };

typedef struct {
    experiment_energy energy;
    FILE *csv;
    const char *method, *stop;
} sampler;

static int watch(long k, double t, const double q[], const double p[], void *ctx)
{
    sampler *s = ctx;
    const double e = experiment_energy_note(&s->energy, t, q, p);
    if (k % SAMPLE_EVERY == 0 || k <= SAMPLE_EACH) fprintf(s->csv, "%s,%s,%.10g,%.6e\n", s->method, s->stop, t, e);
    return 0;
}

/* The drift of a run that goes on forever; of one that oscillates, what the line through it happens to have. */
static double drift(const experiment_energy *energy) { return fabs(experiment_energy_slope(energy)) * t_end; }

static void run_stop(experiment_method method, const stop *s, const tvi_system *system, FILE *csv, FILE *table)
{
    method.who.options.tolerance = s->tolerance;
    method.who.options.passes = s->passes;
    scene long_run = scene_pendulum;
    long_run.t_end = t_end;
    sampler sample = {experiment_energy_begin(system, &long_run), csv, method.label, s->label};
    const experiment_end end = experiment_run(&method, system, &long_run, step, watch, &sample, false);
    fprintf(table, "| %s | %s |", method.label, s->label);
    if (end.status != TVI_OK) {
        fprintf(table, " - | - | - | %s |\n", tvi_status_string(end.status));
        return;
    }
    fprintf(table, " %.3g |", end.passes_per_step);
    experiment_cell(table, experiment_energy_mean(&sample.energy), 1e3);
    experiment_cell(table, sample.energy.worst, 1e3);
    const double moved = drift(&sample.energy), noise = sample.energy.worst / 100;
    if (moved > noise) experiment_cell(table, moved, 1e3);
    else fprintf(table, " none |");
    fprintf(table, "\n");
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    FILE *csv = experiment_csv(&e, "almost_symplectic", "method,stop,t,energy_error");
    FILE *table =
        experiment_table(&e, "almost_symplectic",
                         " method | tolerance or passes | passes a step | mean energy error | largest | drift ");
    tvi_system *system = experiment_system(&scene_pendulum);
    for (int m = 0; m < METHODS; m++) {
        const experiment_method method = experiment_find(methods[m].name, methods[m].order);
        experiment_progress("  %s", method.label);
        for (int i = 0; i < STOPS; i += i < FIXED ? 1 : methods[m].step_over)
            run_stop(method, &stops[i], system, csv, table);
    }
    tvi_system_free(system);
    experiment_close(csv);
    experiment_close(table);
}
