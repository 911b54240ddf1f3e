/* dispatch.c - a step of order 16 with each instruction set. Writes DIR/dispatch.md.
 *
 *   dispatch DIR */
#include "experiments/experiment.h"
#include "stepping.h"

/* The steps are those of tests/instructions.txt. */
static const struct {
    const scene *scene;
    double h;
} problems[] = {{&scene_pendulum, 0.25}, {&scene_kepler, 0.25}, {&scene_henon_heiles_12, 0.625},
                {&scene_fpu, 0.03125},   {&scene_solar, 400},   {&scene_double_pendulum, 0.0625}};
static const int bodies[] = {20, 40};
enum { PROBLEMS = sizeof problems / sizeof *problems, BODIES = sizeof bodies / sizeof *bodies };

typedef struct {
    tvi_system *system;
    stepping steps;
} pinned;

/* Frees what it measures. */
static void write_row(FILE *table, const char *title, pinned of[ISAS])
{
    turn t[ISAS];
    for (isa i = 0; i < ISAS; i++) t[i] = (turn){.work = stepping_go, .ctx = &of[i].steps};
    turns_time(ISAS, t);
    fprintf(table, "| %s | %d |", title, of[0].steps.n);
    for (isa i = 0; i < ISAS; i++) fprintf(table, " %.3g |", stepping_time(&t[i]));
    for (isa i = ISA_AVX2; i < ISAS; i++) fprintf(table, " %.2f |", t[ISA_BASE].seconds / t[i].seconds);
    fprintf(table, "\n");
    for (isa i = 0; i < ISAS; i++) {
        stepping_close(&of[i].steps);
        tvi_system_free(of[i].system);
    }
    experiment_progress("dispatch: %s", title);
}

/* Where the method serves the scene. */
static void write_scene(FILE *table, const scene *s, double h, const tvi_options *options, const char *method)
{
    char title[64];
    pinned of[ISAS];
    for (isa i = 0; i < ISAS; i++) {
        isa_pin(i);
        of[i].system = experiment_system(s);
        if (tvi_options_check(of[i].system, options, NULL) != TVI_OK) {
            tvi_system_free(of[i].system);
            return;
        }
        of[i].steps = stepping_open(of[i].system, options, s->q, s->p, h);
    }
    snprintf(title, sizeof title, "%s, %s", s->name, method);
    write_row(table, title, of);
}

static void write_bodies(FILE *table, int count, const tvi_options *options, const char *method)
{
    char title[64];
    big_system b[ISAS];
    pinned of[ISAS];
    for (isa i = 0; i < ISAS; i++) {
        isa_pin(i);
        b[i] = bodies_make(count, 3);
        of[i].system = b[i].system;
        of[i].steps = stepping_open(b[i].system, options, b[i].q, b[i].p, b[i].h);
    }
    snprintf(title, sizeof title, "%d bodies, %s", count, method);
    write_row(table, title, of);
}

int main(int argc, char *argv[])
{
    static const char *const methods[] = {"midpoint", "galerkin"};
    const experiment e = experiment_begin(argc, argv);
    FILE *table = experiment_table(&e, "dispatch",
                                   "scene, method|n|base, us (time)|avx2, us (time)|widest, us (time)|"
                                   "base / avx2 (time)|base / widest (time)");
    for (int m = 0; m < 2; m++) {
        tvi_options options;
        if (tvi_options_named(methods[m], 16, &options) != TVI_OK) experiment_fail(methods[m], "no order 16");
        for (int k = 0; k < PROBLEMS; k++) write_scene(table, problems[k].scene, problems[k].h, &options, methods[m]);
        for (int k = 0; k < BODIES; k++) write_bodies(table, bodies[k], &options, methods[m]);
    }
    experiment_close(table);
    return 0;
}
