/* devices.c - what each device for speed gives (ad/devices.h): times of steps without it and with it, in turns, from
 * the tape and by generated code, with AVX2 and with the widest instruction set. Writes DIR/devices.md; generated code
 * is kept in DIR/generated. It is linked with a library that was built with TVI_DEVICES.
 *
 *   devices DIR */
#include "devices.h"
#include "experiments/experiment.h"
#include "stepping.h"
#include "turns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

extern int jet_without;

typedef struct {
    const scene *scene;
    const char *title, *method;
    int order;
    double h;
} problem;
static const problem problems[] = {
    {&scene_kepler, "Kepler", "galerkin", 16, 0.25},
    {&scene_henon_heiles_12, "Henon-Heiles", "galerkin", 16, 1},
    {&scene_fpu, "FPU", "galerkin", 16, 0.0390625},
    {&scene_solar, "Solar System", "galerkin", 16, 625},
    {&scene_double_pendulum, "double pendulum", "galerkin", 16, 0.078125},
    {&scene_kepler, "Kepler", "midpoint", 20, 0.25},
    {&scene_fpu, "FPU", "midpoint", 20, 0.0625},
    {&scene_double_pendulum, "double pendulum", "midpoint", 20, 0.0625},
    {&scene_solar, "Solar System", "midpoint", 20, 625},
    {&scene_kepler, "Kepler", "taylor", 26, 0.25},
    {&scene_solar, "Solar System", "taylor", 26, 400},
};

#define NAMED(device)                                                                                                  \
    {                                                                                                                  \
        JET_DEVICE_##device, #device                                                                                   \
    }
static const struct {
    int mask;
    const char *name;
} devices[] = {NAMED(PAD), NAMED(TERMS), NAMED(SCATTERED), NAMED(SPLIT)};
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

/* The system is to be freed behind the steps. */
static stepping open_without(const experiment *e, const problem *p, int mask, bool compiled, tvi_system **system)
{
    tvi_options options;
    jet_without = mask;
    *system = experiment_system(p->scene);
    experiment_insist(tvi_options_named(p->method, p->order, &options), p->method);
    if (compiled) options.compiled = experiment_compile(e, *system, &options);
    const stepping s = stepping_open(*system, &options, p->scene->q, p->scene->p, p->h);
    tvi_compiled_free((tvi_compiled *)options.compiled);
    jet_without = 0;
    return s;
}

static ratios time_row(const experiment *e, const problem *p, bool compiled)
{
    stepping steps[DEVICES + 1];
    turn turns[DEVICES + 1];
    tvi_system *systems[DEVICES + 1];
    ratios r;
    for (int i = 0; i <= DEVICES; i++) {
        steps[i] = open_without(e, p, i < DEVICES ? devices[i].mask : 0, compiled, &systems[i]);
        turns[i] = (turn){.work = stepping_go, .ctx = &steps[i]};
    }
    turns_time(DEVICES + 1, turns);
    for (int i = 0; i <= DEVICES; i++) {
        if (i < DEVICES) r.of[i] = turns[i].seconds / turns[DEVICES].seconds;
        stepping_close(&steps[i]);
        tvi_system_free(systems[i]);
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
