/* suggest.c - Measures what runs reach with the step of tvi_measure_step, and what it costs to find. Writes a table of
 * docs/choosing.md, and fails where a run has more than the wanted error, or more than twice the measured one where
 * that is far above roundoff, or where an error is refused and a smaller one is not. The right end is that of a run
 * with a sixth of the step.
 *
 * suggest DIR METHOD ORDER */
#include "scenes/hard.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 32, WANTED = 10, WITNESS = 64 }; /* the witness has 64 steps at least: shorter runs are cheap */
/* Twice the measured error is a bound where it is above ten times this. */
static const double ROUNDOFF = 1e-11;

typedef struct {
    const char *name;
    const tvi_system *system;
    const tvi_options *options;
    int n;
    double q[MOST], p[MOST], t, duration;
} problem;

typedef struct {
    int cells, refused, missed, under, priced;
    double price; /* in runs with the final step, of runs of WITNESS steps or more */
} count;

/* ---- One problem ------------------------------------------------------------------------------------------------- */

typedef struct {
    double end[2 * MOST], size[2];
    int n;
    long steps;
} run;

static int take_sizes(long step, double t, const double q[], const double p[], void *ctx)
{
    run *to = ctx;
    (void)t;
    to->steps = step;
    for (int i = 0; i < to->n; i++) {
        to->size[0] = fmax(to->size[0], fabs(q[i]));
        to->size[1] = fmax(to->size[1], fabs(p[i]));
    }
    return 0;
}

static tvi_status travel(const problem *of, double h, run *made)
{
    tvi_integrator *it;
    double t = of->t, *q = made->end, *p = made->end + of->n;
    *made = (run){.n = of->n};
    memcpy(q, of->q, (size_t)of->n * sizeof *q);
    memcpy(p, of->p, (size_t)of->n * sizeof *p);
    tvi_status status = tvi_integrator_create(&it, of->system, of->options);
    if (status == TVI_OK) status = tvi_integrate_to(it, h, of->t + of->duration, &t, q, p, take_sizes, made);
    tvi_integrator_free(it);
    return status;
}

static double distance(const run *a, const run *b)
{
    double most = 0;
    for (int i = 0; i < 2 * a->n; i++) most = fmax(most, fabs(a->end[i] - b->end[i]) / b->size[i / a->n]);
    return most;
}

static int count_steps(int member, int steps, double t, const double q[], const double p[], void *ctx)
{
    (void)member, (void)t, (void)q, (void)p;
    *(int *)ctx = steps;
    return 0;
}

/* Writes a cell of the table: the measured error and the right one, the step, and the price. */
static void write_cell(const problem *of, double wanted, bool *is_refused, count *counts, FILE *out)
{
    static run made, right;
    int spent = 0;
    double h = 0, measured = 0;
    const tvi_run_plan plan = {.t_end = of->t + of->duration, .at_step = count_steps, .ctx = &spent};
    const tvi_status status =
        tvi_measure_step(of->system, of->options, &plan, of->t, of->q, of->p, wanted, &h, &measured);
    const bool is_known = h != 0 && travel(of, h, &made) == TVI_OK && travel(of, h / 6, &right) == TVI_OK;
    const double error = is_known ? distance(&made, &right) : INFINITY;
    counts->cells++;
    if (status != TVI_OK) {
        counts->refused++;
        *is_refused = true;
        const char *why = status == TVI_EROUNDOFF ? "refused" : status == TVI_ESTOPPED ? "out of steps" : NULL;
        if (out) fprintf(out, " %s", why ? why : tvi_status_string(status));
        if (out && measured > 0) fprintf(out, ": %.1e", measured); /* 0: no error was measured */
        if (out) fprintf(out, " |");
        return;
    }
    const bool missed = !(error <= wanted) || *is_refused, under = error > 2 * measured && measured > 10 * ROUNDOFF;
    counts->missed += missed;
    counts->under += under;
    counts->price += made.steps < WITNESS ? 0 : (double)spent / (double)made.steps;
    counts->priced += made.steps >= WITNESS;
    if (missed || under)
        printf("%s, %.0e: h = %g, %g measured, %g%s\n", of->name, wanted, h, measured, error,
               *is_refused ? ", and a larger one was refused" : "");
    if (out) fprintf(out, " %.1e, %.1e (%.3g: %.1f) |", measured, error, h, (double)spent / (double)made.steps);
}

static void write_row(const problem *of, count *counts, FILE *out)
{
    bool is_refused = false;
    if (tvi_options_check(of->system, of->options, NULL) != TVI_OK) return;
    fprintf(out, "| %s |", of->name);
    for (int k = 3; k < 3 + WANTED; k += 3) write_cell(of, pow(10, -k), &is_refused, counts, out);
    fprintf(out, "\n");
    is_refused = false;
    if (of->duration > 5e5) return; /* whose runs take ten seconds each */
    for (int k = 3; k < 3 + WANTED; k++)
        if (k % 3 != 0) write_cell(of, pow(10, -k), &is_refused, counts, NULL);
}

/* ---- The problems ------------------------------------------------------------------------------------------------ */

static jet kepler(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_dot(q, q, 2), -0.5));
}

/* Fermi, Pasta, Ulam and Tsingou: 32 masses, alpha = 1/4. */
static jet chain(const jet q[], jet t, void *ctx)
{
    jet V = jet_div(jet_sqr(q[0]), 2);
    (void)t, (void)ctx;
    V = jet_add(V, jet_mul(0.25 / 3, jet_pow(q[0], 3)));
    for (int i = 1; i <= MOST; i++) {
        const jet d = i < MOST ? jet_sub(q[i], q[i - 1]) : jet_neg(q[MOST - 1]);
        V = jet_add(V, jet_add(jet_div(jet_sqr(d), 2), jet_mul(0.25 / 3, jet_mul(d, jet_sqr(d)))));
    }
    return V;
}

static jet toda(const jet q[], jet t, void *ctx)
{
    jet V = jet_mul(0, q[0]);
    (void)t, (void)ctx;
    for (int i = 0; i < 3; i++) V = jet_add(V, jet_exp(jet_sub(q[i], q[(i + 1) % 3])));
    return V;
}

static jet logarithmic(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_div(jet_log(jet_add(0.04, jet_add(jet_sqr(q[0]), jet_mul(1.5, jet_sqr(q[1]))))), 2);
}

static jet pendulum(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_cos(q[0]));
}

static void push(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)ctx;
    force[0] = jet_sub(jet_mul(0.9, jet_cos(jet_mul(2.0 / 3, t))), jet_div(v[0], 2));
}

/* A star of mass 1, a planet of 0.001 at 1, a star of 1/2 at 12, inclined by 75 degrees: Kozai's cycles. */
static const double triple_masses[] = {1, 1e-3, 0.5};
static jet triple(const jet q[], jet t, void *ctx)
{
    jet V = jet_mul(0, q[0]);
    (void)t, (void)ctx;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < i; j++) {
            jet d[3];
            for (int k = 0; k < 3; k++) d[k] = jet_sub(q[3 * i + k], q[3 * j + k]);
            V = jet_sub(V, jet_mul(triple_masses[i] * triple_masses[j], jet_pow(jet_dot(d, d, 3), -0.5)));
        }
    return V;
}

static jet scale_of_kepler(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_pow(jet_dot(q, q, 2), 0.75);
}

static tvi_system *stated(int n, const double mass[], tvi_potential_fn *V)
{
    tvi_system *system;
    if (tvi_system_potential(&system, n, mass, V, NULL) != TVI_OK) exit(EXIT_FAILURE);
    return system;
}

/* A hyperbola past a centre of mu = 1 with the pericentre distance 1, from t = -T to T, mirrored at the pericentre. */
static problem hyperbola(const tvi_system *system, const tvi_options *options, double e, double T)
{
    problem of = {"", system, options, 2, {0}, {0}, 0, 2 * T};
    const double a = 1 / (e - 1), M = T * pow(a, -1.5), b = a * sqrt(e * e - 1);
    double F = asinh(M / e);
    for (int k = 0; k < 60; k++) F -= (e * sinh(F) - F - M) / (e * cosh(F) - 1);
    const double rate = pow(a, -1.5) / (e * cosh(F) - 1);
    of.q[0] = a * (e - cosh(F)), of.q[1] = -b * sinh(F);
    of.p[0] = a * sinh(F) * rate, of.p[1] = b * cosh(F) * rate;
    return of;
}

static void write_own(const tvi_options *options, count *counts, FILE *out)
{
    tvi_system *k = stated(2, NULL, kepler), *c = stated(MOST, NULL, chain), *to = stated(3, NULL, toda),
               *l = stated(2, NULL, logarithmic), *base = stated(1, NULL, pendulum), *driven, *rescaled, *inner;
    const double m[] = {1, 1, 1, 1e-3, 1e-3, 1e-3, 0.5, 0.5, 0.5};
    tvi_system *tr = stated(9, m, triple);
    if (tvi_system_driven(&driven, base, push, NULL) != TVI_OK ||
        tvi_system_rescaled(&rescaled, k, scale_of_kepler, NULL) != TVI_OK ||
        tvi_system_rescaled(&inner, tr, NULL, NULL) != TVI_OK)
        exit(EXIT_FAILURE);
    problem fput = {"FPUT, 32 masses, first mode", c, options, MOST, {0}, {0}, 0, 2000};
    for (int i = 0; i < MOST; i++) fput.q[i] = sin(acos(-1) * (i + 1) / (MOST + 1));
    const double s = sin(75 * acos(-1) / 180), cs = cos(75 * acos(-1) / 180), v = sqrt(1.001), w = sqrt(1.501 / 12);
    const problem rows[] = {
        {"Kepler, README", k, options, 2, {1, 0}, {0, 0.8}, 0, 4000},
        {"Kepler, to 1e5", k, options, 2, {1, 0}, {0, 0.8}, 0, 1e5},
        {"Kepler, to 1e6", k, options, 2, {1, 0}, {0, 0.8}, 0, 1e6},
        {"Kepler, e = 0.9, fixed", k, options, 2, {1, 0}, {0, 0.31622776601683794}, 0, 200},
        {"Kepler, e = 0.9, rescaled", rescaled, options, 2, {1, 0}, {0, 0.31622776601683794}, 0, 200},
        {"Toda", to, options, 3, {0.3, 0.1, -0.2}, {0.2, 0.1, -0.3}, 0, 200},
        {"logarithmic", l, options, 2, {0.5, 0.1}, {0.2, 0.6}, 0, 200},
        {"driven pendulum", driven, options, 1, {0.1}, {0}, 0, 100},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) write_row(&rows[i], counts, out);
    problem kozai = {"Kozai triple, fixed",
                     tr,
                     options,
                     9,
                     {0, 0, 0, 1, 0, 0, 12, 0, 0},
                     {0, -1e-3 * v * cs - 0.5 * w, -1e-3 * v * s, 0, 1e-3 * v * cs, 1e-3 * v * s, 0, 0.5 * w, 0},
                     0,
                     600};
    write_row(&kozai, counts, out);
    kozai.name = "Kozai triple, rescaled";
    kozai.system = inner;
    write_row(&kozai, counts, out);
    write_row(&fput, counts, out);
    for (int i = 0; i < 9; i++) {
        char name[64];
        problem of = hyperbola(k, options, (double[]){1.5, 5, 50}[i / 3], (double[]){30, 300, 3000}[i % 3]);
        (void)snprintf(name, sizeof name, "hyperbola, e = %g, to t = %g", (double[]){1.5, 5, 50}[i / 3],
                       of.duration / 2);
        of.name = name;
        write_row(&of, counts, out);
    }
    tvi_system *const all[] = {inner, rescaled, driven, tr, base, l, to, c, k};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) tvi_system_free(all[i]);
}

static void write_scenes(const tvi_options *options, count *counts, FILE *out)
{
    for (int list = 0; list < 2; list++)
        for (const scene *const *s = list ? general_scenes : scenes; *s; s++) {
            tvi_system *system;
            if (scene_system(*s, &system) != TVI_OK) exit(EXIT_FAILURE);
            problem of = {(*s)->name, system, options, (*s)->n, {0}, {0}, 0, (*s)->t_end};
            memcpy(of.q, (*s)->q, (size_t)of.n * sizeof *of.q);
            memcpy(of.p, (*s)->p, (size_t)of.n * sizeof *of.p);
            write_row(&of, counts, out);
            tvi_system_free(system);
        }
}

/* ---- Random motions of one degree of freedom --------------------------------------------------------------------- */

/* V = a q^2 / 2 and up to six smooth terms of size 1. */
typedef struct {
    double a;
    int terms, kind[6];
    double size[6], rate[6], shift[6];
} landscape;

static jet land(const jet q[], jet t, void *ctx)
{
    const landscape *of = ctx;
    jet V = jet_mul(of->a / 2, jet_sqr(q[0]));
    (void)t;
    for (int i = 0; i < of->terms; i++) {
        const jet x = jet_add(of->shift[i], jet_mul(of->rate[i], q[0])),
                  term = of->kind[i] == 0   ? jet_tanh(x)
                         : of->kind[i] == 1 ? jet_sin(x)
                         : of->kind[i] == 2 ? jet_exp(jet_neg(jet_sqr(x)))
                                            : jet_div(1, jet_add(1, jet_sqr(x)));
        V = jet_add(V, jet_mul(of->size[i], term));
    }
    return V;
}

static double number_of(unsigned long long *bits)
{
    *bits = *bits * 6364136223846793005ULL + 1442695040888963407ULL;
    return (double)(*bits >> 11) / 9007199254740992.0;
}

static void try_random(const tvi_options *options, count *counts)
{
    unsigned long long bits = 1;
    for (int k = 0; k < 480; k++) {
        landscape of = {.a = 0.05 + 0.5 * number_of(&bits), .terms = 3 + (int)(4 * number_of(&bits))};
        for (int i = 0; i < of.terms; i++) {
            of.kind[i] = (int)(4 * number_of(&bits));
            of.size[i] = 2 * number_of(&bits) - 1;
            of.rate[i] = 0.5 + 4 * number_of(&bits);
            of.shift[i] = 2 * number_of(&bits) - 1;
        }
        tvi_system *system;
        if (tvi_system_potential(&system, 1, NULL, land, &of) != TVI_OK) exit(EXIT_FAILURE);
        problem one = {"random", system, options, 1, {3 * number_of(&bits) - 1.5}, {2 * number_of(&bits) - 1}, 0, 20};
        bool is_refused = false;
        write_cell(&one, pow(10, -4 - 8 * number_of(&bits)), &is_refused, counts, NULL);
        tvi_system_free(system);
    }
}

/* ---- Flybys of the Earth ----------------------------------------------------------------------------------------- */

/* The Sun, and the Earth on a circle about it: units of 1 AU, and of a year / (2 pi). */
static jet sun_and_earth(const jet q[], jet t, void *ctx)
{
    const jet d[] = {jet_sub(q[0], jet_cos(t)), jet_sub(q[1], jet_sin(t)), q[2]};
    (void)ctx;
    return jet_neg(jet_add(jet_pow(jet_dot(q, q, 3), -0.5), jet_mul(3.003e-6, jet_pow(jet_dot(d, d, 3), -0.5))));
}

/* Sixty bodies pass the Earth at 1e-4 to 1e-2 AU, at 4 to 20 km/s, from 58 days before to 58 days after. The start is
 * where the motion back from the passage leads. */
static void try_flybys(const tvi_options *options, count *counts)
{
    unsigned long long bits = 2;
    tvi_system *system = stated(3, NULL, sun_and_earth);
    for (int k = 0; k < 60; k++) {
        const double b = 1e-4 * pow(100, number_of(&bits)), v = 0.13 + 0.54 * number_of(&bits),
                     at = 6.283185307179586 * number_of(&bits), tilt = 2 * number_of(&bits) - 1;
        problem one = {"flyby of the Earth", system, options, 3, {1 + b * cos(at), b * sin(at), 0}, {0}, -1, 2};
        one.p[0] = -v * sin(at) * cos(tilt), one.p[1] = 1 + v * cos(at) * cos(tilt), one.p[2] = v * sin(tilt);
        tvi_options taylor;
        tvi_integrator *it;
        double t = 0;
        bool is_refused = false;
        if (tvi_options_named("taylor", 20, &taylor) != TVI_OK ||
            tvi_integrator_create(&it, system, &taylor) != TVI_OK ||
            tvi_integrate_tolerance(it, 1e-13, one.t, &t, one.q, one.p, NULL, NULL) != TVI_OK)
            exit(EXIT_FAILURE);
        tvi_integrator_free(it);
        write_cell(&one, pow(10, -3 - 7 * number_of(&bits)), &is_refused, counts, NULL);
    }
    tvi_system_free(system);
}

static void print_count(const char *what, const count *of)
{
    printf(
        "%s: %d cells, %d refused, %d missed, %d measured too small; mean price %.1f runs, where they have 64 steps\n",
        what, of->cells, of->refused, of->missed, of->under, of->price / fmax(1, of->priced));
}

int main(int argc, char *argv[])
{
    char path[4096];
    tvi_options options;
    count shown = {0}, random = {0}, flybys = {0};
    if (argc < 4 || snprintf(path, sizeof path, "%s/suggest.md", argv[1]) >= (int)sizeof path) return EXIT_FAILURE;
    if (tvi_options_named(argv[2], atoi(argv[3]), &options) != TVI_OK) return EXIT_FAILURE;
    FILE *out = fopen(path, "w");
    if (!out) {
        fprintf(stderr, "%s: %s\n", path, strerror(errno));
        return EXIT_FAILURE;
    }
    fprintf(out, "| motion | 1e-03 wanted (chaotic) | 1e-06 wanted (chaotic) | 1e-09 wanted (chaotic) | 1e-12 wanted "
                 "(chaotic) |\n"
                 "|---|---|---|---|---|\n");
    write_own(&options, &shown, out);
    write_scenes(&options, &shown, out);
    try_random(&options, &random);
    try_flybys(&options, &flybys);
    const bool is_written = fclose(out) == 0;
    print_count("the table, and errors between", &shown);
    print_count("random motions", &random);
    print_count("flybys of the Earth", &flybys);
    const int wrong = shown.missed + shown.under + random.missed + random.under + flybys.missed + flybys.under;
    return is_written && wrong == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
