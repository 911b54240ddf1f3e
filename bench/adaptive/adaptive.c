/* adaptive.c - Writes the table and the picture of docs/adaptive.md: adaptive DIR. */
#include "adaptive.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { REPETITIONS = 10, REVOLUTIONS = 100 };
static const char *const g_names[] = {"fixed steps", "own", "automatic", "tolerance"};

/* ---- The table --------------------------------------------------------------------------------------------------- */

/* A dash where it is not kept. */
static void write_energy_error(FILE *table, double error)
{
    if (isnan(error)) fprintf(table, " - |");
    else fprintf(table, " %.1e |", error);
}

/* The unit is measured beside each row: the speed of a shared machine changes. */
static void write_row(FILE *table, const adaptive_line *l)
{
    const double unit = adaptive_time_of_unit();
    adaptive_motion r = adaptive_begin(l);
    const tvi_status status = adaptive_go(&r, l, l->problem->scene.t_end, NULL, NULL);
    const tvi_stats *stats = tvi_integrator_stats(r.integrator);
    fprintf(table, "| %s, to t = %.5g | %s %d | %s | %.6g | %ld |", l->problem->scene.title, l->problem->scene.t_end,
            l->method, l->order, g_names[l->g], l->h, stats->steps);
    if (status != TVI_OK) fprintf(table, " at t = %.3g: %s | - | - | - | - |\n", r.t, tvi_status_string(status));
    else {
        write_energy_error(table, adaptive_energy_error(&r, &l->problem->scene));
        fprintf(table, " %.1e | %.1f |", adaptive_error(l->problem, r.t, r.q),
                (double)stats->passes / (double)stats->steps);
        const double cpu = adaptive_time_of(l, REPETITIONS);
        fprintf(table, " %.3g | %.3g |\n", 1e3 * cpu, cpu / fmin(unit, adaptive_time_of_unit()));
    }
    fflush(table);
    adaptive_end(&r);
}

static void write_table(const experiment *e)
{
    FILE *table = experiment_table(e, "adaptive",
                                   " problem | method | g | h, tolerance | steps | energy error (chaotic) | "
                                   "position error (chaotic) | passes a step | ms (time) | u (time) ");
    for (const adaptive_line *l = adaptive_lines; l->problem; l++) write_row(table, l);
    experiment_close(table);
}

/* ---- The picture ------------------------------------------------------------------------------------------------- */

static void write_label(FILE *csv, const adaptive_line *l)
{
    fprintf(csv, "%s %s %.3g", l->problem->scene.name, g_names[l->g], l->h);
}

/* The error at each pericentre. */
static void write_errors(FILE *csv, const adaptive_line *l)
{
    adaptive_motion r = adaptive_begin(l);
    for (int k = 1; k <= REVOLUTIONS; k++) {
        if (adaptive_go(&r, l, k * ADAPTIVE_REVOLUTION, NULL, NULL) != TVI_OK) break;
        write_label(csv, l);
        fprintf(csv, ",%d,%.4e\n", k, adaptive_error(l->problem, r.t, r.q));
    }
    adaptive_end(&r);
}

typedef struct {
    FILE *csv;
    const adaptive_line *line;
    double t;
} steps_written;

static int write_step(long step, double t, const double q[], const double p[], void *ctx)
{
    steps_written *w = ctx;
    (void)step, (void)q, (void)p;
    write_label(w->csv, w->line);
    fprintf(w->csv, ",%.8g,%.4e\n", t, t - w->t);
    w->t = t;
    return 0;
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    write_table(&e);
    adaptive_tolerances(&e);
    FILE *errors = experiment_csv(&e, "errors", "line,revolution,error");
    for (const adaptive_line *l = adaptive_errors; l->problem; l++) write_errors(errors, l);
    experiment_close(errors);
    FILE *steps = experiment_csv(&e, "steps", "line,t,step");
    for (const adaptive_line *l = adaptive_steps; l->problem; l++) {
        adaptive_motion r = adaptive_begin(l);
        experiment_insist(adaptive_go(&r, l, l->problem->scene.t_end, write_step, &(steps_written){steps, l, 0}),
                          l->problem->scene.name);
        adaptive_end(&r);
    }
    experiment_close(steps);
    return EXIT_SUCCESS;
}
