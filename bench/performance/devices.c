/* devices.c - what each device for speed gives (ad/devices.h): times of steps without it and with it, in turns, from
 * the tape and by generated code, with AVX2 and with the widest instruction set. Writes DIR/devices.md; generated code
 * is kept in DIR/generated. It is linked with a library that was built with TVI_DEVICES.
 *
 *   devices DIR */
#include "devices.h"
#include "adaptive/adaptive.h"
#include "stepping.h"
#include "turns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

extern int jet_without;

/* A scene; a hard scene with its time scale, steps in s; or many bodies, with a step of their own. */
typedef struct {
    const scene *scene;
    const char *title, *method;
    int order;
    double h;
    const hard_scene *hard;
    int bodies;
} problem;
#define SCENE(id, name, by_method, of_order, step)                                                                     \
    {                                                                                                                  \
        .scene = &scene_##id, .title = name, .method = by_method, .order = of_order, .h = step                         \
    }
static const problem problems[] = {
    SCENE(kepler, "Kepler", "galerkin", 16, 0.25),
    SCENE(henon_heiles_12, "Henon-Heiles", "galerkin", 16, 1),
    SCENE(fpu, "FPU", "galerkin", 16, 0.0390625),
    SCENE(solar, "Solar System", "galerkin", 16, 625),
    SCENE(double_pendulum, "double pendulum", "galerkin", 16, 0.078125),
    SCENE(kepler, "Kepler", "midpoint", 20, 0.25),
    SCENE(fpu, "FPU", "midpoint", 20, 0.0625),
    SCENE(double_pendulum, "double pendulum", "midpoint", 20, 0.0625),
    SCENE(solar, "Solar System", "midpoint", 20, 625),
    SCENE(kepler, "Kepler", "taylor", 26, 0.25),
    SCENE(solar, "Solar System", "taylor", 26, 400),
    {.hard = &hard_kepler_90,
     .title = "Kepler e = 0.9, rescaled",
     .method = "galerkin",
     .order = 16,
     .h = ADAPTIVE_S_90 / 10},
    {.hard = &hard_pythagorean, .title = "Pythagorean, rescaled", .method = "galerkin", .order = 16, .h = 0.9},
    {.bodies = 20, .title = "20 bodies", .method = "galerkin", .order = 16},
};

#define NAMED(device)                                                                                                  \
    {                                                                                                                  \
        JET_DEVICE_##device, #device                                                                                   \
    }
static const struct {
    int mask;
    const char *name;
} devices[] = {NAMED(TERMS), NAMED(SPLIT)};
enum {
    PROBLEMS = sizeof problems / sizeof *problems,
    DEVICES = sizeof devices / sizeof *devices,
    KINDS = 2, /* from the tape, by generated code */
    ROWS = PROBLEMS * KINDS
};

static const isa sets[] = {ISA_AVX2, ISA_WIDEST};
enum { SETS = sizeof sets / sizeof *sets };

/* [device] times without it, in units of that with all. */
typedef struct {
    double of[DEVICES];
} ratios;

/* Steps of a problem, and what they need. */
typedef struct {
    stepping steps;
    big_system system;  /* its q and p are the start */
    tvi_system *stated; /* NULL where the system is not rescaled */
} variant;

static void make_system(variant *v, const problem *p)
{
    if (p->bodies) {
        v->system = bodies_make(p->bodies, 3);
        return;
    }
    const scene *s = p->hard ? &p->hard->scene : p->scene;
    tvi_system *system = experiment_system(s);
    v->system = (big_system){.n = s->n, .system = system, .h = p->h};
    memcpy(v->system.q, s->q, (size_t)s->n * sizeof *s->q);
    memcpy(v->system.p, s->p, (size_t)s->n * sizeof *s->p);
    if (!p->hard) return;
    v->stated = system;
    experiment_insist(tvi_system_rescaled(&v->system.system, system, p->hard->scale, NULL), p->title);
}

static void open_without(variant *v, const experiment *e, const problem *p, int mask, bool compiled)
{
    tvi_options options;
    jet_without = mask;
    *v = (variant){.stated = NULL};
    make_system(v, p);
    experiment_insist(tvi_options_named(p->method, p->order, &options), p->method);
    if (compiled) options.compiled = experiment_compile(e, v->system.system, &options);
    v->steps = stepping_open(v->system.system, &options, v->system.q, v->system.p, v->system.h);
    tvi_compiled_free((tvi_compiled *)options.compiled);
    jet_without = 0;
}

static void close_variant(variant *v)
{
    stepping_close(&v->steps);
    tvi_system_free(v->system.system);
    tvi_system_free(v->stated);
}

static ratios time_row(const experiment *e, const problem *p, bool compiled)
{
    static variant variants[DEVICES + 1];
    turn turns[DEVICES + 1];
    ratios r;
    for (int i = 0; i <= DEVICES; i++) {
        open_without(&variants[i], e, p, i < DEVICES ? devices[i].mask : 0, compiled);
        turns[i] = (turn){.work = stepping_go, .ctx = &variants[i].steps};
    }
    turns_time(DEVICES + 1, turns);
    for (int i = 0; i <= DEVICES; i++) {
        if (i < DEVICES) r.of[i] = turns[i].seconds / turns[DEVICES].seconds;
        close_variant(&variants[i]);
    }
    experiment_progress("devices: %s, %s, %s", p->title, p->method, compiled ? "compiled" : "tape");
    return r;
}

/* A row is touched where it becomes slower or faster by more than times vary. */
static const double VARIES = 0.03;

static void write_device(FILE *table, int device, ratios rows[SETS][ROWS])
{
    fprintf(table, "| %s |", devices[device].name);
    for (int set = 0; set < SETS; set++) {
        double all = 0, touched = 0;
        int count = 0, most = 0;
        for (int row = 0; row < ROWS; row++) {
            const double ratio = rows[set][row].of[device];
            all += log(ratio) / ROWS;
            if (fabs(ratio - 1) > VARIES) touched += log(ratio), count++;
            if (ratio > rows[set][most].of[device]) most = row;
        }
        const problem *p = &problems[most / KINDS];
        fprintf(table, " %.2f: %s, %s, %s | %.2f of %d | %.3f |", rows[set][most].of[device], p->title, p->method,
                most % KINDS ? "compiled" : "tape", exp(touched / (count > 0 ? count : 1)), count, exp(all));
    }
    fprintf(table, "\n");
}

int main(int argc, char *argv[])
{
    static ratios rows[SETS][ROWS];
    const experiment e = experiment_begin(argc, argv);
    for (int set = 0; set < SETS; set++) {
        isa_pin(sets[set]);
        for (int row = 0; row < ROWS; row++) rows[set][row] = time_row(&e, &problems[row / KINDS], row % KINDS);
    }
    isa_pin(ISA_WIDEST);
    FILE *table = experiment_table(&e, "devices",
                                   "without|AVX2, most (time)|rows touched (time)|all rows (time)|"
                                   "widest, most (time)|rows touched (time)|all rows (time)");
    for (int device = 0; device < DEVICES; device++) write_device(table, device, rows);
    experiment_close(table);
    return EXIT_SUCCESS;
}
