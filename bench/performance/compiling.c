/* compiling.c - Measures how long the compiler takes for bodies that attract each other, and what that gains. Writes
 * DIR/compiling.md.
 *
 *   compiling DIR */
#include "experiments/experiment.h"
#include "stepping.h"

#include <stdlib.h>

static const int bodies[] = {2, 3, 6, 7, 8, 13, 14, 20, 40};
static const struct {
    const char *name;
    int order;
} methods[] = {{"galerkin", 16}, {"midpoint", 20}};
enum { METHODS = sizeof methods / sizeof *methods };

/* Without a cache; then steps from the tape and by generated code. */
static void write_cells(FILE *table, const big_system *b, const tvi_options *options)
{
    tvi_options compiled = *options;
    tvi_compiled *code;
    stepping s[2];
    turn of[2];
    const double begin = turns_wall();
    experiment_insist(tvi_compile(&code, b->system, options, &(tvi_compiler){.cache = ""}), b->name);
    const double seconds = turns_wall() - begin;
    compiled.compiled = code;
    for (int i = 0; i < 2; i++) {
        s[i] = stepping_open(b->system, i > 0 ? &compiled : options, b->q, b->p, b->h);
        s[i].steps = 100;
        of[i] = (turn){.work = stepping_go, .ctx = &s[i]};
    }
    turns_time(2, of);
    fprintf(table, " %.1f | %.3g | %.3g | %.2f |", seconds, stepping_time(&of[0]), stepping_time(&of[1]),
            of[0].seconds / of[1].seconds);
    for (int i = 0; i < 2; i++) stepping_close(&s[i]);
    tvi_compiled_free(code);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    FILE *table = experiment_table(&e, "compiling",
                                   "bodies|\"galerkin\" 16: s to compile (time)|tape, us a step (time)|compiled (time)|"
                                   "times faster (time)|\"midpoint\" 20: s to compile (time)|tape, us a step (time)|"
                                   "compiled (time)|times faster (time)");
    for (size_t i = 0; i < sizeof bodies / sizeof *bodies; i++) {
        big_system b = bodies_make(bodies[i], 3);
        fprintf(table, "| %d |", bodies[i]);
        for (int k = 0; k < METHODS; k++) {
            tvi_options options;
            experiment_insist(tvi_options_named(methods[k].name, methods[k].order, &options), methods[k].name);
            write_cells(table, &b, &options);
        }
        fprintf(table, "\n");
        tvi_system_free(b.system);
        experiment_progress("compiling: %d bodies", bodies[i]);
    }
    experiment_close(table);
    return EXIT_SUCCESS;
}
