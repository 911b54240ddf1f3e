/* growth.c - how the errors of Kepler's problem, rescaled, e = 0.9, grow with the revolutions. Roundoff makes them, so
 * that one run says little: over steps of many sizes, which are no simple parts of a revolution, where it would repeat
 * itself. */
#include "adaptive.h"

#include <math.h>

enum { SIZES = 48, TIMES = 3, OF_ENERGY = 0, OF_POSITION, ERRORS };
static const int revolutions[TIMES] = {100, 1000, 10000};

typedef struct {
    double squares, most;
} errors;

static void add_error(double error, errors *to)
{
    to->squares += error * error;
    to->most = fmax(to->most, error);
}

static void add_run(double steps_a_revolution, errors to[TIMES][ERRORS])
{
    const adaptive_line line = {&hard_kepler_90, "galerkin", 16, ADAPTIVE_OWN, .h = ADAPTIVE_S_90 / steps_a_revolution};
    adaptive_motion r = adaptive_begin(&line);
    for (int k = 0; k < TIMES; k++) {
        experiment_insist(adaptive_go(&r, &line, revolutions[k] * ADAPTIVE_REVOLUTION, NULL, NULL), line.method);
        add_error(adaptive_energy_error(&r, &line.of->scene), &to[k][OF_ENERGY]);
        add_error(adaptive_error(line.of, r.t, r.q), &to[k][OF_POSITION]);
    }
    adaptive_end(&r);
}

void adaptive_growth(const experiment *e)
{
    errors found[TIMES][ERRORS] = {0};
    for (int i = 0; i < SIZES; i++) add_run(10.503 + 0.0501 * i, found);
    FILE *table = experiment_table(e, "growth",
                                   " revolutions | energy error (chaotic) | its largest (chaotic) | position error "
                                   "(chaotic) | its largest (chaotic) ");
    for (int k = 0; k < TIMES; k++) {
        fprintf(table, "| %d |", revolutions[k]);
        for (int i = 0; i < ERRORS; i++)
            fprintf(table, " %.1e | %.1e |", sqrt(found[k][i].squares / SIZES), found[k][i].most);
        fprintf(table, "\n");
    }
    experiment_close(table);
}
