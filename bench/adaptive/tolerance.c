/* tolerance.c - "taylor" to a tolerance on the smooth scenes: its error, and its time beside fixed steps. */
#include "adaptive.h"

#include <math.h>
#include <string.h>

static const double tolerances[] = {1e-6, 1e-8, 1e-10, 1e-12, 1e-13, 1e-14, 1e-15};
enum { TOLERANCES = sizeof tolerances / sizeof *tolerances, REPEATED = 3, MOST_STEPS = 1 << 20 };
static const double TIMED = 1e-10;

static double relative(int n, const double x[], const double y[])
{
    double apart = 0, size = 0;
    for (int i = 0; i < n; i++) {
        apart = fmax(apart, fabs(x[i] - y[i]));
        size = fmax(size, fabs(y[i]));
    }
    return apart / size;
}

/* At the end, relative to the largest coordinate and momentum; infinite where the run fails. */
static double error_of(const adaptive_line *l)
{
    const scene *s = &l->of->scene;
    adaptive_motion r = adaptive_begin(l);
    const tvi_status status = adaptive_go(&r, l, l->of->scene.t_end, NULL, NULL);
    const double of_q = relative(s->n, r.q, s->reference), of_p = relative(s->n, r.p, s->reference + s->n);
    adaptive_end(&r);
    return status == TVI_OK ? fmax(of_q, of_p) : INFINITY;
}

static adaptive_line to(const hard_scene *of, double tolerance, int order)
{
    return (adaptive_line){of, "taylor", order, .g = ADAPTIVE_TOLERANCE, .h = tolerance};
}

static void write_errors(FILE *table, const hard_scene *of)
{
    fprintf(table, "| %s |", of->scene.title);
    for (int i = 0; i < TOLERANCES; i++) {
        const adaptive_line l = to(of, tolerances[i], tvi_taylor_order(tolerances[i]));
        fprintf(table, " %.1e |", error_of(&l));
    }
    fprintf(table, "\n");
    fflush(table);
}

/* Fixed steps of the same order, the fewest of a ladder whose error is not above this; 0: none. */
static adaptive_line fixed_steps(const hard_scene *of, int order, double error)
{
    adaptive_line l = {.of = of, .method = "taylor", .order = order, .g = ADAPTIVE_FIXED};
    for (double steps = 8; steps < MOST_STEPS; steps *= 1.1) {
        l.h = of->scene.t_end / ceil(steps);
        if (error_of(&l) <= error) return l;
    }
    l.h = 0;
    return l;
}

static void write_times(FILE *table, const hard_scene *of)
{
    const adaptive_line l = to(of, TIMED, tvi_taylor_order(TIMED));
    const double error = error_of(&l), unit = adaptive_time_of_unit();
    const double cpu = adaptive_time_of(&l, REPEATED);
    fprintf(table, "| %s | %.1e | %.3g | %.3g |", of->scene.title, error, 1e3 * cpu,
            cpu / fmin(unit, adaptive_time_of_unit()));
    const adaptive_line fixed = fixed_steps(of, l.order, error);
    if (fixed.h > 0) fprintf(table, " %.2f |\n", cpu / adaptive_time_of(&fixed, REPEATED));
    else fprintf(table, " - |\n");
    fflush(table);
}

void adaptive_tolerances(const experiment *e)
{
    static const scene *const of[] = {&scene_pendulum,        &scene_kepler,    &scene_henon_heiles_12,
                                      &scene_henon_heiles_8,  &scene_fpu,       &scene_solar,
                                      &scene_double_pendulum, &scene_magnetic,  &scene_nonseparable,
                                      &scene_vortices,        &scene_degenerate};
    enum { SCENES = sizeof of / sizeof *of };
    FILE *table = experiment_table(e, "tolerance",
                                   " scene | error at 1e-6 | 1e-8 | 1e-10 | 1e-12 (chaotic) | 1e-13 (chaotic) | "
                                   "1e-14 (chaotic) | 1e-15 (chaotic) ");
    for (int i = 0; i < SCENES; i++) write_errors(table, &(hard_scene){.scene = *of[i]});
    experiment_close(table);
    table = experiment_table(e, "tolerance_times", " scene | error | ms (time) | u (time) | to fixed steps (time) ");
    for (int i = 0; i < SCENES; i++) write_times(table, &(hard_scene){.scene = *of[i]});
    write_times(table, &hard_comet);
    write_times(table, &hard_three_planets);
    experiment_close(table);
}
