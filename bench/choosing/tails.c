/* tails.c - Measures how well tvi_stats.tail tells wrong runs from right ones: each method over eccentric Kepler
 * orbits, the Pythagorean three bodies, a pendulum near its separatrix and the scenes of the bench, at many steps.
 * Writes a table of docs/choosing.md.
 *
 *   tails DIR */
#include "stability/cases.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 64, STEPS = 5000 }; /* coordinates; steps of a run */
static const double WRONG = 1e-3, RIGHT = 1e-6;

static const struct {
    const char *name;
    int order;
} methods[] = {{"galerkin", 16}, {"galerkin", 8},  {"midpoint", 20}, {"midpoint", 12},
               {"poincare", 20}, {"both-ends", 8}, {"start", 8},     {"right", 12},
               {"right", 8},     {"tvi", 8},       {"taylor", 10}};
enum { METHODS = sizeof methods / sizeof *methods };

/* Runs above an error and runs below another one. */
typedef struct {
    int wrong, right;
    double least_wrong, most_right;
} count;

static jet pendulum(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(1, jet_cos(q[0]));
}

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

/* The largest energy error, infinite where there is no energy, and the largest tail of the steps that were made.
 * Returns their number. */
static int run(const tvi_system *system, const tvi_options *options, const scene *s, double h, double *error,
               double *tail)
{
    tvi_integrator *it;
    double t = 0, q[MOST], p[MOST], start, now;
    int step = 0;
    memcpy(q, s->q, (size_t)s->n * sizeof *q);
    memcpy(p, s->p, (size_t)s->n * sizeof *p);
    *error = *tail = 0;
    if (tvi_energy(system, t, q, p, &start) != TVI_OK || tvi_integrator_create(&it, system, options) != TVI_OK)
        return 0;
    while (step < STEPS && t < s->t_end && *error < 1 && tvi_step(it, h, &t, q, p) == TVI_OK) {
        const double scale = fmax(fabs(start), s->energy_scale);
        const bool has_energy = tvi_energy(system, t, q, p, &now) == TVI_OK && isfinite(now);
        *error = has_energy ? fmax(*error, fabs(now - start) / scale) : INFINITY;
        *tail = fmax(*tail, tvi_integrator_stats(it)->tail);
        step++;
    }
    tvi_integrator_free(it);
    return step;
}

/* At h, h/2, ..., steps of them. */
static void add_runs(count counts[], const tvi_system *system, const scene *s, double h, int steps)
{
    for (int k = 0; k < METHODS; k++) {
        tvi_options options;
        if (tvi_options_named(methods[k].name, methods[k].order, &options) != TVI_OK) continue;
        for (int i = 0; i < steps; i++) {
            double error, tail;
            if (run(system, &options, s, ldexp(h, -i), &error, &tail) == 0) continue;
            if (error > WRONG) counts[k].wrong++, counts[k].least_wrong = fmin(counts[k].least_wrong, tail);
            if (error <= RIGHT) counts[k].right++, counts[k].most_right = fmax(counts[k].most_right, tail);
        }
    }
}

static bool add_potential(count counts[], int n, tvi_potential_fn *V, const double *q, const double *p, double t_end,
                          double h, int steps)
{
    const scene s = {.n = n, .q = q, .p = p, .t_end = t_end};
    tvi_system *system;
    if (tvi_system_potential(&system, n, NULL, V, NULL) != TVI_OK) return false;
    add_runs(counts, system, &s, h, steps);
    tvi_system_free(system);
    return true;
}

/* The Pythagorean bodies, beyond their first encounter. */
static bool add_bodies(count counts[])
{
    scene s = pythagorean.scene;
    tvi_system *system;
    s.t_end = 70;
    s.energy_scale = 0;
    if (hard_system(&pythagorean, &system) != TVI_OK) return false;
    add_runs(counts, system, &s, 0.064, 7);
    tvi_system_free(system);
    return true;
}

static bool add_all(count counts[])
{
    static const double e[] = {0.36, 0.6, 0.9, 0.99}, momenta[] = {1.9, 1.998, 2.002, 2.5}, origin = 0;
    bool good = add_bodies(counts);
    for (int i = 0; i < 4; i++) {
        const double q[] = {1 + e[i], 0}, p[] = {0, sqrt((1 - e[i]) / (1 + e[i]))};
        good &= add_potential(counts, 2, scene_kepler.potential, q, p, 18, 0.5, 9);
        good &= add_potential(counts, 1, pendulum, &origin, &momenta[i], 100, 4, 7);
    }
    for (int list = 0; list < 2; list++)
        for (const scene *const *s = list ? general_scenes : scenes; *s; s++) {
            tvi_system *system;
            good &= scene_system(*s, &system) == TVI_OK;
            if (system) add_runs(counts, system, *s, 4 * (*s)->steps[0], 6);
            tvi_system_free(system);
        }
    return good;
}

/* ---- The table --------------------------------------------------------------------------------------------------- */

static void write_table(const count counts[], FILE *out)
{
    fprintf(out, "| method | right (chaotic) | their largest tail (chaotic) | wrong (chaotic) | their smallest tail "
                 "(chaotic) |\n");
    fprintf(out, "|---|---|---|---|---|\n");
    for (int k = 0; k < METHODS; k++)
        fprintf(out, "| %s %d | %d | %.1g | %d | %.1g |\n", methods[k].name, methods[k].order, counts[k].right,
                counts[k].most_right, counts[k].wrong, counts[k].least_wrong);
}

int main(int argc, char *argv[])
{
    static count counts[METHODS];
    char path[4096];
    if (argc != 2 || snprintf(path, sizeof path, "%s/tails.md", argv[1]) >= (int)sizeof path) {
        fprintf(stderr, "usage: tails DIR\n");
        return EXIT_FAILURE;
    }
    for (int k = 0; k < METHODS; k++) counts[k].least_wrong = INFINITY;
    bool good = add_all(counts);
    FILE *out = fopen(path, "w");
    if (out) write_table(counts, out);
    good &= out && fclose(out) == 0;
    if (!good) fprintf(stderr, "tails: %s: %s\n", path, strerror(errno));
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
