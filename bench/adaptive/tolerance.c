/* tolerance.c - Runs "taylor" to a tolerance on the smooth scenes: its error at the end. */
#include "adaptive.h"

#include <math.h>
#include <string.h>

static const double tolerances[] = {1e-6, 1e-8, 1e-10, 1e-12, 1e-13, 1e-14, 1e-15};
enum { TOLERANCES = sizeof tolerances / sizeof *tolerances };

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
    const scene *s = &l->problem->scene;
    adaptive_motion r = adaptive_begin(l);
    const tvi_status status = adaptive_go(&r, l, l->problem->scene.t_end, NULL, NULL);
    const double of_q = relative(s->n, r.q, s->reference), of_p = relative(s->n, r.p, s->reference + s->n);
    adaptive_end(&r);
    return status == TVI_OK ? fmax(of_q, of_p) : INFINITY;
}

static adaptive_line to(const hard_scene *problem, double tolerance, int order)
{
    return (adaptive_line){problem, "taylor", order, .g = ADAPTIVE_TOLERANCE, .h = tolerance};
}

static void write_errors(FILE *table, const hard_scene *problem)
{
    fprintf(table, "| %s |", problem->scene.title);
    for (int i = 0; i < TOLERANCES; i++) {
        const adaptive_line l = to(problem, tolerances[i], tvi_taylor_order(tolerances[i]));
        fprintf(table, " %.1e |", error_of(&l));
    }
    fprintf(table, "\n");
    fflush(table);
}

void adaptive_tolerances(const experiment *e)
{
    static const scene *const problem[] = {&scene_pendulum,        &scene_kepler,    &scene_henon_heiles_12,
                                           &scene_henon_heiles_8,  &scene_fpu,       &scene_solar,
                                           &scene_double_pendulum, &scene_magnetic,  &scene_nonseparable,
                                           &scene_vortices,        &scene_degenerate};
    enum { SCENES = sizeof problem / sizeof *problem };
    FILE *table = experiment_table(e, "tolerance",
                                   " scene | error at 1e-6 | 1e-8 | 1e-10 | 1e-12 (chaotic) | 1e-13 (chaotic) | "
                                   "1e-14 (chaotic) | 1e-15 (chaotic) ");
    for (int i = 0; i < SCENES; i++) write_errors(table, &(hard_scene){.scene = *problem[i]});
    experiment_close(table);
}
