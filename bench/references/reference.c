/* reference.c - Prints scenes/references.h: where each scene is at t_end, to 26 digits, in quadruple precision.
 *
 * Two runs of the Taylor method of different degree and step, chosen from the series at each step, are refined until
 * they agree to DIGITS digits in q and in p, each relative to its largest component. LEAST_DIGITS will do where the
 * motion is chaotic, and of the planets, whose first two runs take a quarter of an hour. The force is the scene's, with
 * the coefficients that the recording rounds to double, from the start as given in double. The values in
 * scenes/references.h are not used. */
#include "scenes/hard.h"
#include "system_quad.h"

#include <quadmath.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DIGITS = 25, LEAST_DIGITS = 17, ROUNDS = 6, COARSE_DEGREE = 30, FINE_DEGREE = 36 };

typedef struct {
    int degree;
    quad part; /* a step is this part of what its series allows, rho */
    long steps;
    quad *q, *p;
    quad energy_error; /* |H(t_end) - H0| / energy_scale */
} taylor_run;

/* rho = (|q| / max(|c_N-1|, |c_N|))^(1/N). */
static quad reach_of(int n, int N, const quad c[])
{
    quad size = 0, last = 0;
    for (int i = 0; i < n; i++) {
        size = fmaxq(size, fabsq(c[i]));
        last = fmaxq(last, fmaxq(fabsq(c[N * n + i]), fabsq(c[(N - 1) * n + i])));
    }
    return powq(size / last, (quad)1 / N);
}

/* To t_end from the start. */
static void integrate(const scene *problem, const quad_system *system, taylor_run *run)
{
    const int n = problem->n, N = run->degree;
    quad t = 0, v[n], c[(N + 1) * n];
    for (int i = 0; i < n; i++) {
        run->q[i] = problem->q[i];
        run->p[i] = problem->p[i];
        v[i] = run->p[i] / (quad)(problem->mass ? problem->mass[i] : 1);
    }
    const quad H0 = quad_energy(system, t, run->q, run->p);
    for (run->steps = 0; t < problem->t_end; run->steps++) {
        quad_expand(system, t, run->q, v, N, c);
        const quad h = fminq(run->part * reach_of(n, N, c), problem->t_end - t);
        quad_position(n, N, c, h, run->q);
        quad_velocity(n, N, c, h, v);
        t += h;
    }
    for (int i = 0; i < n; i++) run->p[i] = v[i] * (quad)(problem->mass ? problem->mass[i] : 1);
    run->energy_error = fabsq(quad_energy(system, t, run->q, run->p) - H0) / problem->energy_scale;
}

/* -log10 (max |a - b| / max |b|), 34 at most. */
static quad agreement(int n, const quad a[], const quad b[])
{
    quad difference = 0, size = 0;
    for (int i = 0; i < n; i++) {
        difference = fmaxq(difference, fabsq(a[i] - b[i]));
        size = fmaxq(size, fabsq(b[i]));
    }
    return -log10q(fmaxq(difference / size, 1e-34));
}

static void print_numbers(int n, const quad x[])
{
    for (int i = 0; i < n; i++) {
        char text[64];
        quadmath_snprintf(text, sizeof text, "%.25Qe", x[i]);
        printf("    %s,\n", text);
    }
}

static void print_reference(const scene *problem, const taylor_run *coarse, const taylor_run *fine, quad digits)
{
    printf("\n/* %.1f digits agree: degree %d, %ld steps and degree %d, %ld steps. */\n", (double)digits,
           coarse->degree, coarse->steps, fine->degree, fine->steps);
    printf("static const double reference_%s[%d] = {\n", problem->name, 2 * problem->n);
    print_numbers(problem->n, fine->q);
    print_numbers(problem->n, fine->p);
    printf("};\n");
    fprintf(stderr, "%-16s %.1f digits, degree %d with %ld steps, energy error %.1e\n", problem->name, (double)digits,
            fine->degree, fine->steps, (double)fine->energy_error);
}

static bool make_reference(const scene *problem)
{
    const int n = problem->n;
    quad_system *system = quad_system_potential(n, problem->mass, problem->potential, NULL);
    if (!system) return false;
    quad a[2 * n], b[2 * n];
    taylor_run coarse = {.degree = COARSE_DEGREE, .q = a, .p = a + n};
    taylor_run fine = {.degree = FINE_DEGREE, .q = b, .p = b + n};
    const int wanted = problem == &scene_planets ? LEAST_DIGITS : DIGITS;
    quad digits = 0, before = -1;
    fine.part = (quad)1 / 10;
    for (int round = 0; round < ROUNDS && !(digits >= wanted) && digits > before; round++) {
        before = digits;
        coarse.part = fine.part;
        fine.part = coarse.part * 2 / 3;
        integrate(problem, system, &coarse);
        integrate(problem, system, &fine);
        digits = fminq(agreement(n, coarse.q, fine.q), agreement(n, coarse.p, fine.p));
    }
    quad_system_free(system);
    if (!(digits >= LEAST_DIGITS)) return false;
    print_reference(problem, &coarse, &fine, digits);
    return true;
}

/* Runs the scene if it is the one that is asked for, or all are. Ends the program where it has no reference. */
static bool print_if_asked(const scene *problem, const char *only)
{
    if (only && strcmp(only, problem->name) != 0) return false;
    if (make_reference(problem)) return true;
    fprintf(stderr, "%s: no reference\n", problem->name);
    exit(EXIT_FAILURE);
}

/* All of them as references.h, or that of one scene alone. */
int main(int count, char **arguments)
{
    const char *only = count > 1 ? arguments[1] : NULL;
    bool made = false;
    if (!only)
        printf("/* references.h - Lists q then p of each scene at its t_end. Printed by bench/references/reference.c: "
               "do not "
               "edit. "
               "*/\n#ifndef REFERENCES_H\n#define REFERENCES_H\n/* clang-format off */\n");
    for (const scene *const *s = scenes; *s; s++) made |= print_if_asked(*s, only);
    for (const hard_scene *const *s = hard_scenes; *s; s++)
        if ((*s)->scene.reference) made |= print_if_asked(&(*s)->scene, only);
    made |= print_if_asked(&scene_planets, only);
    if (only && !made) fprintf(stderr, "%s: no such scene\n", only);
    if (!only) printf("\n#endif\n");
    return made ? EXIT_SUCCESS : EXIT_FAILURE;
}
