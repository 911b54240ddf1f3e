/* compiled.c - Times generated code beside the tape and beside what is written by hand. Writes DIR/compiled.md,
 * for which it compiles some dozens of systems: the cache is DIR/generated.
 *
 *   compiled DIR */
#include "adaptive/adaptive.h"
#include "by_hand.h"
#include "compiled/compiled.h"
#include "curves.h"
#include "experiments/experiment.h"
#include "turns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef double error_of(const run *row);
static double energy_error(const run *row) { return row->energy_error; }
static double position_error(const run *row) { return row->position_error; }

/* A method of the library at the largest step that reaches the error, against a rival that does so too, or that has a
 * step of its own, as u and U: Gauss collocation of order 16 over
 * Kepler to t = 250 with h = 0.25, and over the Solar System with h = 400. */
typedef struct {
    const scene *scene;
    const char *title, *method;
    int order;
    error_of *error;
    double target;
    const char *rival;
    int rival_order;
    double rival_h; /* 0: the largest that reaches the error */
} race;
#define AGAINST_GAUSS(id, title, target)                                                                               \
    {                                                                                                                  \
        &scene_##id, title, "galerkin", 16, energy_error, target, "gauss", 16, 0                                       \
    }
static const race races[] = {
    AGAINST_GAUSS(pendulum, "pendulum, energy, 1e-8", 1e-8),
    AGAINST_GAUSS(kepler, "Kepler, 1e-8", 1e-8),
    AGAINST_GAUSS(henon_heiles_12, "Henon-Heiles 1/12, 1e-8", 1e-8),
    AGAINST_GAUSS(henon_heiles_8, "Henon-Heiles 1/8, 1e-8", 1e-8),
    AGAINST_GAUSS(fpu, "FPU, 1e-8", 1e-8),
    AGAINST_GAUSS(solar, "Solar System, 1e-8", 1e-8),
    {&scene_kepler, "Kepler, position to 1e-10, in u", "midpoint", 20, position_error, 1e-10, "gauss", 16, 0.25},
    {&scene_solar, "Solar System, 1e-10, in U", "midpoint", 20, position_error, 1e-10, "gauss", 16, 400},
    {&scene_double_pendulum, "double pendulum, 1e-10", "galerkin", 16, position_error, 1e-10, "gauss-by-hand", 12, 0},
};
enum { RACES = sizeof races / sizeof *races };

/* The run with the largest step of the scene that reaches the error; status is not TVI_OK where none does. */
static run fastest(const tvi_system *system, const race *r, const contender *who, double h)
{
    run found = {.status = TVI_ENOCONV};
    for (const double *step = r->scene->steps; *step > 0 && found.status != TVI_OK; step++) {
        run_contender(system, r->scene, who, h > 0 ? h : *step, INFINITY, &found);
        if (found.status == TVI_OK && h == 0 && !(r->error(&found) <= r->target)) found.status = TVI_ENOCONV;
    }
    return found;
}

static const baseline *rival_of(const race *r)
{
    if (r->scene == &scene_double_pendulum) return &baseline_double_pendulum;
    return baseline_find(r->rival, r->rival_order);
}

/* The least times over several rounds of both in turns. */
static void time_pair(const tvi_system *system, const run *a, const run *b, double least[2])
{
    double cpu[2];
    least[0] = least[1] = INFINITY;
    for (int round = 0; round < 3; round++) {
        run_in_turns(system, a, b, cpu);
        for (int i = 0; i < 2; i++) least[i] = fmin(least[i], cpu[i]);
    }
}

/* The same steps from the tape and by generated code. */
typedef struct {
    tvi_system *system;
    tvi_compiled *code;
    contender who[2];
    run of[2];
    double seconds[2];
} both;

static void open_both(both *b, const experiment *e, const race *r)
{
    b->system = experiment_system(r->scene);
    b->who[0] = (contender){.name = r->method, .order = r->order, .symplectic = true};
    experiment_insist(tvi_options_named(r->method, r->order, &b->who[0].options), r->method);
    b->who[1] = b->who[0];
    b->who[1].options.compiled = b->code = experiment_compile(e, b->system, &b->who[0].options);
    b->of[0] = b->of[1] = fastest(b->system, r, &b->who[0], 0);
    if (b->of[0].status != TVI_OK) experiment_fail(r->title, "no step reaches the error");
    b->of[1].who = &b->who[1];
    time_pair(b->system, &b->of[0], &b->of[1], b->seconds);
}

static void close_both(both *b)
{
    tvi_compiled_free(b->code);
    tvi_system_free(b->system);
}

static void write_race(FILE *table, const experiment *e, const race *r)
{
    both ours;
    open_both(&ours, e, r);
    const contender who = {.name = r->rival, .order = r->rival_order, .symplectic = true, .baseline = rival_of(r)};
    const run rival = fastest(ours.system, r, &who, r->rival_h);
    if (rival.status != TVI_OK) experiment_fail(r->title, "no step of the rival reaches the error");
    double theirs[2];
    time_pair(ours.system, &ours.of[1], &rival, theirs);
    const double ratio = theirs[0] / theirs[1];
    fprintf(table, "| %s | %s %d (%.4g), %.1e | %.3g | %.3g | %.2f | %s %d (%.4g) | %.3g | %.2f |\n", r->title,
            r->method, r->order, ours.of[0].setting, r->error(&ours.of[0]), 1e3 * ours.seconds[0],
            1e3 * ours.seconds[1], ours.seconds[0] / ours.seconds[1], r->rival, r->rival_order, rival.setting,
            1e3 * theirs[1], ratio);
    close_both(&ours);
    experiment_progress("compiled: %s", r->title);
}

/* ---- Steps that adapt ------------------------------------------------------------------------------------------- */

/* "taylor" to a tolerance, whose errors are those of heyoka at its tolerance of DBL_EPSILON, 2.3e-13 and 5.5e-12: below
 * 1e-13 steps are refined. Or "galerkin" 16 with a time scale. Against u or U. */
typedef struct {
    const hard_scene *of; /* scale NULL: to a tolerance */
    const char *title, *method;
    int order;
    double setting; /* the tolerance, or h in s */
    const scene *unit;
    double unit_h;
} adaptive_race;
#define TO_A_TOLERANCE(id, title, h)                                                                                   \
    {                                                                                                                  \
        &(const hard_scene){.scene = id}, title, "taylor", 26, 1e-13, &id, h                                           \
    }
#define RESCALED(id, title, h)                                                                                         \
    {                                                                                                                  \
        &hard_##id, title ", rescaled, in u", "galerkin", 16, h, &scene_kepler, 0.25                                   \
    }

/* A run to the scene's end, from its start. */
typedef struct {
    const adaptive_race *race;
    tvi_integrator *integrator;
    double t, q[BASELINE_N_MAX], p[BASELINE_N_MAX];
} free_run;

static void run_freely(void *ctx)
{
    free_run *r = ctx;
    const scene *s = &r->race->of->scene;
    tvi_integrator *w = r->integrator;
    const double setting = r->race->setting;
    r->t = 0;
    memcpy(r->q, s->q, (size_t)s->n * sizeof *r->q);
    memcpy(r->p, s->p, (size_t)s->n * sizeof *r->p);
    tvi_integrator_reset(w);
    experiment_insist(r->race->of->scale ? tvi_integrate_to(w, setting, s->t_end, &r->t, r->q, r->p, NULL, NULL)
                                         : tvi_integrate_tolerance(w, setting, s->t_end, &r->t, r->q, r->p, NULL, NULL),
                      r->race->title);
}

typedef struct {
    const scene *scene;
    double h;
} rival_run;

static void run_rival(void *ctx)
{
    const rival_run *r = ctx;
    const baseline *gauss = baseline_find("gauss", 16);
    const baseline_task task = {.scene = r->scene, .h = r->h, .steps = lround(r->scene->t_end / r->h)};
    double q[BASELINE_N_MAX], p[BASELINE_N_MAX];
    baseline_counts counts;
    memcpy(q, r->scene->q, (size_t)r->scene->n * sizeof *q);
    memcpy(p, r->scene->p, (size_t)r->scene->n * sizeof *p);
    experiment_insist(gauss->run(gauss, &task, q, p, &counts), "gauss");
}

static void write_adaptive(FILE *table, const experiment *e, const adaptive_race *r)
{
    tvi_system *stated = experiment_system(&r->of->scene), *rescaled = NULL;
    if (r->of->scale) experiment_insist(tvi_system_rescaled(&rescaled, stated, r->of->scale, NULL), r->title);
    tvi_system *system = rescaled ? rescaled : stated;
    tvi_options options;
    experiment_insist(tvi_options_named(r->method, r->order, &options), r->method);
    tvi_compiled *code = experiment_compile(e, system, &options);
    free_run runs[2] = {{.race = r}, {.race = r}};
    rival_run rival = {r->unit, r->unit_h};
    for (int i = 0; i < 2; i++) {
        options.compiled = i > 0 ? code : NULL;
        experiment_insist(tvi_integrator_create(&runs[i].integrator, system, &options), r->method);
    }
    turn of[] = {{.work = run_freely, .ctx = &runs[0]},
                 {.work = run_freely, .ctx = &runs[1]},
                 {.work = run_rival, .ctx = &rival}};
    turns_time(3, of);
    const double ratio = of[1].seconds / of[2].seconds;
    fprintf(table, "| %s | %s %d, %.1e | %.3g | %.3g | %.2f | gauss 16 (%.4g) | %.3g | %.2f |\n", r->title, r->method,
            r->order, adaptive_error(r->of, runs[1].t, runs[1].q), 1e3 * of[0].seconds, 1e3 * of[1].seconds,
            of[0].seconds / of[1].seconds, r->unit_h, 1e3 * of[2].seconds, ratio);
    for (int i = 0; i < 2; i++) tvi_integrator_free(runs[i].integrator);
    tvi_compiled_free(code);
    tvi_system_free(rescaled);
    tvi_system_free(stated);
    experiment_progress("compiled: %s", r->title);
}

static void write_adaptives(FILE *table, const experiment *e)
{
    const adaptive_race adaptive[] = {
        RESCALED(kepler_90, "Kepler e = 0.9", ADAPTIVE_S_90 / 10),
        RESCALED(kepler_99, "Kepler e = 0.99", ADAPTIVE_S_99 / 10),
        RESCALED(kepler_999, "Kepler e = 0.999", ADAPTIVE_S_999 / 15),
        RESCALED(pythagorean, "Pythagorean", 0.9),
        TO_A_TOLERANCE(scene_kepler, "Kepler, tolerance 1e-13, in u", 0.25),
        TO_A_TOLERANCE(scene_solar, "Solar System, tolerance 1e-13, in U", 400),
    };
    for (size_t i = 0; i < sizeof adaptive / sizeof *adaptive; i++) write_adaptive(table, e, &adaptive[i]);
}

/* ---- Series ------------------------------------------------------------------------------------------------------ */

static const by_hand *widest_by_hand(void)
{
#ifdef JET_ISA_X86
    const char *name = isa_name(ISA_WIDEST);
    return strcmp(name, "avx512") == 0 ? &series_by_hand_avx512
           : strcmp(name, "avx2") == 0 ? &series_by_hand_avx2
                                       : &series_by_hand;
#else
    return &series_by_hand;
#endif
}

enum { DEGREE = 10 };

typedef struct {
    const by_hand *code;
    bool is_kepler;
    double tau;
    power_weights weights;
    kepler_series kepler;
    solar_series solar;
} hand;

static void expand_by_hand(void *ctx)
{
    hand *x = ctx;
    if (x->is_kepler) x->code->kepler(DEGREE, x->tau, &x->weights, &x->kepler);
    else x->code->solar(DEGREE, x->tau, &x->weights, &x->solar);
}

static void write_series(FILE *table, const experiment *e, const scene *s, const char *title, double h)
{
    static hand x;
    tvi_system *system = experiment_system(s);
    tvi_options options;
    experiment_insist(tvi_options_named("midpoint", 2 * DEGREE, &options), "midpoint");
    tvi_compiled *code = experiment_compile(e, system, &options);
    tvi_arena arena = {0};
    (void)tvi_compiled_attach_to_copy(&arena, system, code);
    char *memory = arena.memory = aligned_alloc(ARENA_ALIGNMENT, arena.bytes_outside_history);
    if (!memory) abort();
    arena.bytes_outside_history = 0;
    const tvi_system *clothed = tvi_compiled_attach_to_copy(&arena, system, code);
    open_curve *tape = curve_open(system, DEGREE, s->q, s->p, h), *own = curve_open(clothed, DEGREE, s->q, s->p, h);
    x = (hand){.code = widest_by_hand(), .is_kepler = s == &scene_kepler, .tau = tape->tau};
    set_power_weights(DEGREE, &x.weights);
    for (int k = 0; k < 2; k++) {
        const double *Q = curve_Q(&tape->curve, k);
        if (x.is_kepler) x.kepler.x[k] = Q[0], x.kepler.y[k] = Q[1];
        else memcpy(x.solar.q[k], Q, 18 * sizeof *Q);
    }
    turn of[] = {
        {.work = curve_expand, .ctx = tape}, {.work = curve_expand, .ctx = own}, {.work = expand_by_hand, .ctx = &x}};
    turns_time(3, of);
    const double ratio = of[1].seconds / of[2].seconds;
    fprintf(table, "| series of %s | N = %d | %.3g | %.3g | %.2f | recurrence | %.3g | %.2f |\n", title, DEGREE,
            1e3 * of[0].seconds, 1e3 * of[1].seconds, of[0].seconds / of[1].seconds, 1e3 * of[2].seconds, ratio);
    curve_close(tape);
    curve_close(own);
    free(memory);
    tvi_compiled_free(code);
    tvi_system_free(system);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    FILE *table = experiment_table(&e, "compiled",
                                   "problem|method (h), error|tape, ms (time)|compiled, ms (time)|times faster (time)|"
                                   "by hand (h)|ms (time)|compiled / by hand (time)");
    for (int i = 0; i < RACES; i++) write_race(table, &e, &races[i]);
    write_adaptives(table, &e);
    write_series(table, &e, &scene_kepler, "Kepler", 0.5);
    write_series(table, &e, &scene_solar, "6 bodies", 800);
    experiment_close(table);
    return EXIT_SUCCESS;
}
