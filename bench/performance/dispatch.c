/* dispatch.c - Times a step of the default method with each instruction set. Writes DIR/dispatch.md.
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

static void write_scene(FILE *table, const scene *s, double h)
{
    const tvi_options options = tvi_options_default();
    pinned of[ISAS];
    for (isa i = 0; i < ISAS; i++) {
        isa_pin(i);
        of[i].system = experiment_system(s);
        of[i].steps = stepping_open(of[i].system, &options, s->q, s->p, h);
    }
    write_row(table, s->name, of);
}

static void write_bodies(FILE *table, int count)
{
    const tvi_options options = tvi_options_default();
    char title[64];
    pinned of[ISAS];
    for (isa i = 0; i < ISAS; i++) {
        isa_pin(i);
        const big_system b = bodies_make(count, 3);
        of[i].system = b.system;
        of[i].steps = stepping_open(b.system, &options, b.q, b.p, b.h);
    }
    snprintf(title, sizeof title, "%d bodies", count);
    write_row(table, title, of);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    FILE *table = experiment_table(&e, "dispatch",
                                   "scene|n|base, us (time)|avx2, us (time)|widest, us (time)|"
                                   "base / avx2 (time)|base / widest (time)");
    for (int k = 0; k < PROBLEMS; k++) write_scene(table, problems[k].scene, problems[k].h);
    for (int k = 0; k < BODIES; k++) write_bodies(table, bodies[k]);
    experiment_close(table);
    return 0;
}
