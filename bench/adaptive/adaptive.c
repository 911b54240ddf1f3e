/* adaptive.c - the table and the picture of docs/adaptive.md: adaptive DIR. */
#include "adaptive.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { REPETITIONS = 10, UNIT_REPETITIONS = 40, REVOLUTIONS = 100 };
static const double TWO_PI = 6.2831853071795864769;
static const char *const g_names[] = {"fixed steps", "own", "automatic", "tolerance"};

static void insist(tvi_status status, const char *what)
{
    if (status != TVI_OK) experiment_fail(what, tvi_status_string(status));
}

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

typedef struct {
    tvi_system *system, *rescaled; /* rescaled: NULL where the steps are not */
    tvi_integrator *integrator;
    double t, q[BASELINE_N_MAX], p[BASELINE_N_MAX];
} motion;

static motion begin(const adaptive_line *l)
{
    const scene *s = &l->of->scene;
    motion r = {.system = experiment_system(s)};
    tvi_options options;
    insist(tvi_options_named(l->method, l->order, &options), l->method);
    if (l->g == ADAPTIVE_OWN || l->g == ADAPTIVE_AUTOMATIC)
        insist(tvi_system_rescaled(&r.rescaled, r.system, l->g == ADAPTIVE_OWN ? l->of->scale : NULL, NULL), s->name);
    insist(tvi_integrator_create(&r.integrator, r.rescaled ? r.rescaled : r.system, &options), l->method);
    memcpy(r.q, s->q, (size_t)s->n * sizeof *r.q);
    memcpy(r.p, s->p, (size_t)s->n * sizeof *r.p);
    return r;
}

static void end(motion *r)
{
    tvi_integrator_free(r->integrator);
    tvi_system_free(r->rescaled);
    tvi_system_free(r->system);
}

static double end_of(const adaptive_line *l) { return l->of->scene.t_end * fmax(l->lengths, 1); }

static tvi_status go(motion *r, const adaptive_line *l, double t_end, tvi_observer *observer, void *ctx)
{
    if (l->g == ADAPTIVE_TOLERANCE)
        return tvi_integrate_tolerance(r->integrator, l->h, t_end, &r->t, r->q, r->p, observer, ctx);
    return tvi_integrate_to(r->integrator, l->h, t_end, &r->t, r->q, r->p, observer, ctx);
}

/* CPU time of a run, s: the fastest of some. */
static double time_of(const adaptive_line *l, int repetitions)
{
    double fastest = INFINITY;
    for (int i = 0; i < repetitions; i++) {
        motion r = begin(l);
        const double before = run_clock();
        insist(go(&r, l, end_of(l), NULL, NULL), l->method);
        fastest = fmin(fastest, run_clock() - before);
        end(&r);
    }
    return fastest;
}

/* The unit of the times: "galerkin" 16, fixed steps of 0.25, Kepler e = 0.36 to t = 250. */
static double time_of_unit(void)
{
    const hard_scene of = {.scene = scene_kepler};
    return time_of(&(adaptive_line){&of, "galerkin", 16, ADAPTIVE_FIXED, .h = 0.25}, UNIT_REPETITIONS);
}

/* ---- The table --------------------------------------------------------------------------------------------------- */

static double energy_error(const motion *r, const scene *s)
{
    double H0, H;
    insist(tvi_energy(r->system, 0, s->q, s->p, &H0), s->name);
    insist(tvi_energy(r->system, r->t, r->q, r->p, &H), s->name);
    return fabs(H - H0) / s->energy_scale;
}

/* The unit is measured beside each row: the speed of a shared machine changes. */
static void write_row(FILE *table, const adaptive_line *l)
{
    const double unit = time_of_unit();
    motion r = begin(l);
    const tvi_status status = go(&r, l, end_of(l), NULL, NULL);
    const tvi_stats *stats = tvi_integrator_stats(r.integrator);
    fprintf(table, "| %s, to t = %.5g | %s %d | %s | %.6g | %ld |", l->of->scene.title, end_of(l), l->method, l->order,
            g_names[l->g], l->h, stats->steps);
    if (status != TVI_OK) fprintf(table, " at t = %.3g: %s | - | - | - | - |\n", r.t, tvi_status_string(status));
    else {
        fprintf(table, " %.1e | %.1e | %.1f |", energy_error(&r, &l->of->scene), adaptive_error(l->of, r.t, r.q),
                (double)stats->passes / (double)stats->steps);
        const double cpu = l->is_timed ? time_of(l, REPETITIONS) : NAN;
        if (l->is_timed) fprintf(table, " %.3g | %.3g |\n", 1e3 * cpu, cpu / fmin(unit, time_of_unit()));
        else fprintf(table, " - | - |\n");
    }
    fflush(table);
    end(&r);
}

static void write_table(const experiment *e)
{
    FILE *table = experiment_table(e, "adaptive",
                                   " problem | method | g | h, tolerance | steps | energy error (chaotic) | "
                                   "position error (chaotic) | passes a step | ms (time) | u (time) ");
    for (const adaptive_line *l = adaptive_lines; l->of; l++) write_row(table, l);
    experiment_close(table);
}

/* ---- The picture ------------------------------------------------------------------------------------------------- */

static void write_label(FILE *csv, const adaptive_line *l)
{
    fprintf(csv, "%s %s %.3g", l->of->scene.name, g_names[l->g], l->h);
}

/* The error at each pericentre. */
static void write_errors(FILE *csv, const adaptive_line *l)
{
    motion r = begin(l);
    for (int k = 1; k <= REVOLUTIONS; k++) {
        if (go(&r, l, k * TWO_PI, NULL, NULL) != TVI_OK) break;
        write_label(csv, l);
        fprintf(csv, ",%d,%.4e\n", k, adaptive_error(l->of, r.t, r.q));
    }
    end(&r);
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
    FILE *errors = experiment_csv(&e, "errors", "line,revolution,error");
    for (const adaptive_line *l = adaptive_errors; l->of; l++) write_errors(errors, l);
    experiment_close(errors);
    FILE *steps = experiment_csv(&e, "steps", "line,t,step");
    for (const adaptive_line *l = adaptive_steps; l->of; l++) {
        motion r = begin(l);
        insist(go(&r, l, end_of(l), write_step, &(steps_written){steps, l, 0}), l->of->scene.name);
        end(&r);
    }
    experiment_close(steps);
    return EXIT_SUCCESS;
}
