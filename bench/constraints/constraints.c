/* constraints.c - Measures what a step on constraints costs beside one in minimal coordinates, of the same motion by
 * steps of the same size, and what long runs keep. Writes DIR/constraints.md and DIR/kept.md.
 *     constraints DIR */
#include "chain.h"
#include "experiments/experiment.h"
#include "performance/stepping.h"

#include <math.h>
#include <stdlib.h>

enum { ANGLES, PLACES, COMPILED /* places, with generated sweeps */, KINDS };

typedef struct {
    const char *title;
    chain of;
    double h;
    long steps;
} row;

#define OF_TEN(x) .links = 10, .length = 0.1, .g = 9.8, .angle = {x, x, x, x, x, x, x, x, x, x}
static const chain pendulum = {.links = 1, .length = 1, .g = 9.8, .angle = {1.5}},
                   twice = {.links = 2, .length = 1, .g = 9.8, .angle = {1.5, 2}}, ten = {OF_TEN(1.5)},
                   gentle = {OF_TEN(0.3)};

/* The end of a row in both kinds of coordinates: how far apart they are. */
static double apart(const row *r, const stepping s[KINDS])
{
    double q[KINDS][2 * LINKS_MOST], p[KINDS][2 * LINKS_MOST];
    for (int kind = 0; kind <= PLACES; kind++) {
        double t = 0;
        for (int i = 0; i < s[kind].n; i++) q[kind][i] = s[kind].q[i], p[kind][i] = s[kind].p[i];
        tvi_integrator_reset(s[kind].integrator);
        experiment_insist(tvi_integrate(s[kind].integrator, r->h, r->steps, &t, q[kind], p[kind], NULL, NULL),
                          r->title);
    }
    return chain_distance(&r->of, q[ANGLES], q[PLACES]);
}

static void measure(FILE *table, const row *r)
{
    double q[KINDS][2 * LINKS_MOST], p[KINDS][2 * LINKS_MOST];
    tvi_system *systems[] = {chain_of_angles(&r->of, q[ANGLES], p[ANGLES]),
                             chain_of_places(&r->of, q[PLACES], p[PLACES]),
                             chain_of_places(&r->of, q[COMPILED], p[COMPILED])};
    tvi_options options = tvi_options_default();
    tvi_compiled *code = NULL;
    stepping s[KINDS];
    turn turns[KINDS];
    for (int kind = 0; kind < KINDS; kind++) {
        if (kind == COMPILED) experiment_insist(tvi_compile(&code, systems[kind], &options, NULL), r->title);
        options.compiled = code;
        s[kind] = stepping_open(systems[kind], &options, q[kind], p[kind], r->h);
        s[kind].steps = r->steps;
        turns[kind] = (turn){.work = stepping_go, .ctx = &s[kind]};
    }
    const double distance = apart(r, s);
    turns_time(KINDS, turns);
    double us[KINDS];
    for (int kind = 0; kind < KINDS; kind++) us[kind] = stepping_time(&turns[kind]);
    fprintf(table, "| %s | %d, %d | %g | %.1g | %.1f, %.1f | %.3g | %.3g | %.2f | %.2f |\n", r->title, s[ANGLES].n,
            s[PLACES].n, r->h, distance, s[ANGLES].passes, s[PLACES].passes, us[ANGLES], us[PLACES],
            us[PLACES] / us[ANGLES], us[COMPILED] / us[PLACES]);
    tvi_compiled_free(code);
    for (int kind = 0; kind < KINDS; kind++) {
        stepping_close(&s[kind]);
        tvi_system_free(systems[kind]);
    }
}

/* ---- Long runs --------------------------------------------------------------------------------------------------- */

/* What is largest along a run: phi and dphi/dt, in units of length^2 and of length times the largest velocity; errors
 * of the energy, in units of the weights times their distances from the fixed point. */
typedef struct {
    const row *run;
    const tvi_system *system;
    double start, value, rate, velocity, energy;
} kept;

enum { EVERY = 100 };

static int watch(long step, double t, const double q[], const double p[], void *ctx)
{
    kept *k = ctx;
    const chain *c = &k->run->of;
    double value[LINKS_MOST], rate[LINKS_MOST], H, unit = 0;
    if (step % EVERY) return 0;
    experiment_insist(tvi_constraint_values(k->system, t, q, p, value, rate), "a long run");
    experiment_insist(tvi_energy(k->system, t, q, p, &H), "a long run");
    for (int j = 0; j < c->links; j++) {
        unit += c->g * c->length * (j + 1);
        k->value = fmax(k->value, fabs(value[j]) / (c->length * c->length));
        k->rate = fmax(k->rate, fabs(rate[j]) / c->length);
        k->velocity = fmax(k->velocity, fmax(fabs(p[2 * j]), fabs(p[2 * j + 1])));
    }
    k->energy = fmax(k->energy, fabs(H - k->start) / unit);
    return 0;
}

static void run_long(FILE *table, const row *r)
{
    double t = 0, q[2 * LINKS_MOST], p[2 * LINKS_MOST];
    tvi_integrator *integrator;
    tvi_system *system = chain_of_places(&r->of, q, p);
    kept k = {.run = r, .system = system};
    experiment_insist(tvi_energy(system, t, q, p, &k.start), r->title);
    experiment_insist(tvi_integrator_create(&integrator, system, NULL), r->title);
    experiment_insist(tvi_integrate(integrator, r->h, r->steps, &t, q, p, watch, &k), r->title);
    fprintf(table, "| %s | %g | %ld | %.1e | %.1e | %.1e |\n", r->title, r->h, r->steps, k.value, k.rate / k.velocity,
            k.energy);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    FILE *table = experiment_table(&e, "constraints",
                                   "problem|n: angles, places|h|apart after a second|passes: angles, places|angles, us "
                                   "(time)|places, us (time)|ratio (time)|compiled / tape (time)");
    const row rows[] = {{"pendulum", pendulum, 0.0625, 16},       {"pendulum", pendulum, 0.25, 4},
                        {"double pendulum", twice, 0.015625, 64}, {"double pendulum", twice, 0.03125, 32},
                        {"chain of 10", ten, 0.0078125, 128},     {"chain of 10", ten, 0.015625, 64}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) measure(table, &rows[i]);
    experiment_close(table);
    table = experiment_table(&e, "kept", "problem|h|steps|phi / l^2|G v / (l v)|energy");
    const row longer[] = {{"pendulum", pendulum, 0.0625, 1000000},
                          {"double pendulum", twice, 0.015625, 200000},
                          {"chain of 10, from 0.3 rad", gentle, 0.0078125, 50000}};
    for (size_t i = 0; i < sizeof longer / sizeof *longer; i++) run_long(table, &longer[i]);
    experiment_close(table);
    return EXIT_SUCCESS;
}
