/* henon_heiles.c - Runs the paper's Henon-Heiles model at H = 1/12 (regular) and 1/8 (chaotic): Poincare sections, and
 * the errors against CPU time. */
#include "experiment.h"

#include <math.h>
#include <string.h>

/* ---- Poincare sections: (y, p_y) where x = 0 and p_x > 0 ------------------------------------------------------ */

static const double section_step = 0.5, section_end = 3000;

/* The orbits start on the section; p_x follows from the energy. The last of each energy are the scenes' own: q, p. */
typedef struct {
    double H, y, p_y;
} start;

static const start starts[] = {{1.0 / 12, -0.3, 0}, {1.0 / 12, -0.2, 0}, {1.0 / 12, -0.1, 0}, {1.0 / 12, 0.02, 0},
                               {1.0 / 12, 0.1, 0},  {1.0 / 12, 0.2, 0},  {1.0 / 12, 0.3, 0},  {1.0 / 12, 0.4, 0},
                               {1.0 / 12, 0, 0.15}, {1.0 / 12, 0, 0.3},  {1.0 / 8, -0.35, 0}, {1.0 / 8, -0.2, 0},
                               {1.0 / 8, -0.1, 0},  {1.0 / 8, 0.1, 0},   {1.0 / 8, 0.22, 0},  {1.0 / 8, 0.3, 0},
                               {1.0 / 8, 0.4, 0},   {1.0 / 8, 0.55, 0},  {1.0 / 8, 0, 0.2},   {1.0 / 8, 0, 0.35}};
enum { STARTS = sizeof starts / sizeof *starts };

/* The three orbits of docs/method.md section 9. */
static const struct {
    double H, q[2], p[2];
} named[] = {{1.0 / 12, {0.25, -0.25}, {0.25, 0}},
             {1.0 / 8, {0, 0.375}, {0.375, 0.0625}},
             {1.0 / 8, {0.25, 0.375}, {0.1875, 0}}};
enum { NAMED = sizeof named / sizeof *named };

/* Finds where x = 0 in the last step, by bisection on the step's own curve; x < 0 before and >= 0 after it. */
static bool cross(tvi_integrator *integrator, double q[2], double p[2])
{
    double low = 0, high = 1;
    for (int i = 0; i < 40; i++) {
        const double theta = (low + high) / 2;
        if (tvi_dense(integrator, theta, q, p) != TVI_OK) return false;
        if (q[0] < 0) low = theta;
        else high = theta;
    }
    return true;
}

/* Draws one orbit, as far as its steps succeed. */
static void draw_section(const experiment_method *method, const tvi_system *system, int orbit, double H, double q[2],
                         double p[2], FILE *csv)
{
    tvi_integrator *integrator;
    if (tvi_integrator_create(&integrator, system, &method->who.options) != TVI_OK)
        experiment_fail(method->label, "refused");
    double t = 0;
    tvi_status status = TVI_OK;
    while (t < section_end && status == TVI_OK) {
        const double x = q[0];
        status = tvi_step(integrator, section_step, &t, q, p);
        if (status != TVI_OK) break;
        double Q[2], P[2];
        if (!(x < 0 && q[0] >= 0) || !cross(integrator, Q, P)) continue;
        fprintf(csv, "%s,%d,%d,%.6f,%.6f\n", method->label, (int)lround(1 / H), orbit, Q[1], P[1]);
    }
    tvi_integrator_free(integrator);
}

static void sections(const experiment *e)
{
    const experiment_method methods[] = {experiment_find("tvi", 6), experiment_find("taylor", 6),
                                         experiment_find("midpoint", 12)};
    tvi_system *system = experiment_system(&scene_henon_heiles_8);
    FILE *csv = experiment_csv(e, "henon_heiles_sections", "method,1/H,orbit,y,p_y");
    for (int m = 0; m < 3; m++) {
        experiment_progress("  sections: %s", methods[m].label);
        for (int k = 0; k < STARTS; k++) {
            const double y = starts[k].y, p_y = starts[k].p_y;
            double q[2] = {0, y}, p[2] = {sqrt(2 * starts[k].H - p_y * p_y - y * y + 2 * y * y * y / 3), p_y};
            draw_section(&methods[m], system, k, starts[k].H, q, p, csv);
        }
        for (int k = 0; k < NAMED; k++) {
            double q[2], p[2];
            memcpy(q, named[k].q, sizeof q);
            memcpy(p, named[k].p, sizeof p);
            draw_section(&methods[m], system, STARTS + k, named[k].H, q, p, csv);
        }
    }
    experiment_close(csv);
    tvi_system_free(system);
}

/* ---- Errors against CPU time ---------------------------------------------------------------------------------- */

/* The scene's state at its end: two methods that must agree. */
static void find_reference(const scene *s, double q[2])
{
    const experiment_method methods[] = {experiment_find("midpoint", 20), experiment_find("taylor", 28)};
    tvi_system *system = experiment_system(s);
    experiment_end ends[2];
    for (int m = 0; m < 2; m++) ends[m] = experiment_run(&methods[m], system, s, 0.25, NULL, NULL, false);
    const double apart = experiment_distance(2, ends[0].q, ends[1].q);
    experiment_progress("  reference at t = %g: two methods are %.1e apart", s->t_end, apart);
    if (!(apart < 1e-11)) experiment_fail("reference", "the methods do not agree");
    memcpy(q, ends[0].q, 2 * sizeof *q);
    tvi_system_free(system);
}

static void work(const experiment *e)
{
    const experiment_method methods[] = {
        experiment_find("tvi", 4),      experiment_find("tvi", 6),           experiment_find("shooting", 4),
        experiment_find("shooting", 6), experiment_find("symmetric-tvi", 4), experiment_find("symmetric-tvi", 6),
        experiment_find("taylor", 6),   experiment_find("both-ends", 6),     experiment_find("midpoint", 6),
        experiment_find("start", 12),   experiment_find("midpoint", 12)};
    enum { METHODS = sizeof methods / sizeof *methods };
    double q[2];
    scene regular = scene_henon_heiles_12;
    regular.t_end = 1000;
    regular.reference = q;
    find_reference(&regular, q);
    experiment_sweep sweep = {.name = "henon_heiles_12",
                              .scene = &regular,
                              .shown = {0.5, 0.25, 0.125},
                              .targets = {1e-1, 1e-3, 1e-5},
                              .longest = 0.2};
    experiment_sweep_run(e, &sweep, METHODS, methods);
    sweep.name = "henon_heiles_8";
    sweep.scene = &scene_henon_heiles_8;
    sweep.longest = 0.05;
    experiment_sweep_run(e, &sweep, METHODS, methods);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    sections(&e);
    work(&e);
}
