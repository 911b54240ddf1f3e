/* derivatives.c - Makes the paper's figure of the cost of derivatives: the curve to its j-th coefficient, which makes
 * all lower ones too, and the Jacobians of them all with respect to the 2n numbers at the centre. */
#include "generating/curve.h"
#include "experiment.h"
#include "runs/run.h"

#include <math.h>
#include <stdlib.h>

enum { ORDERS = 20 };

static const scene *const by_dimension[] = {&scene_pendulum, &scene_kepler, &scene_fpu, &scene_solar};
enum { SCENES = sizeof by_dimension / sizeof *by_dimension };

/* ---- Measuring ------------------------------------------------------------------------------------------------ */

typedef struct {
    tvi_curve curve;
    void *memory;
} prolongation;

static prolongation prolong(const tvi_system *system, const scene *s, int top)
{
    prolongation x;
    tvi_arena arena = {0};
    tvi_curve_allocate(&x.curve, &arena, system, top, true);
    x.memory = tvi_arena_obtain_memory(&arena);
    if (!x.memory) exit(EXIT_FAILURE);
    tvi_curve_allocate(&x.curve, &arena, system, top, true);
    tvi_blocks_set_constants(arena.first_tape_block);
    tvi_curve_fill_tables(&x.curve);
    double z[2 * BASELINE_N_MAX];
    const double tau = s->steps[3];
    for (int i = 0; i < s->n; i++) {
        z[i] = s->q[i];
        z[s->n + i] = tau * s->p[i] / (s->mass ? s->mass[i] : 1);
    }
    curve_set_tau(&x.curve, tau);
    curve_set_z(&x.curve, z);
    return x;
}

static void work(prolongation *x, bool jacobians)
{
    if (jacobians) tvi_curve_compute_jacobians(&x->curve);
    else if (tvi_curve_expand(&x->curve, 0) != TVI_OK) exit(EXIT_FAILURE);
}

/* Seconds of one evaluation: the least of some batches of a millisecond. */
static double time_of(prolongation *x, bool jacobians)
{
    enum { BATCHES = 7 };
    const double batch = 1e-3;
    double best = INFINITY;
    long count = 1;
    for (int i = 0; i < BATCHES;) {
        const double begin = run_clock();
        for (long k = 0; k < count; k++) work(x, jacobians);
        const double took = run_clock() - begin;
        if (took < batch) {
            count *= 2;
            continue;
        }
        best = fmin(best, took / (double)count);
        i++;
    }
    return best;
}

/* ---- Growth --------------------------------------------------------------------------------------------------- */

/* Least squares: y_j = a + b j + c j^2, j = 1..ORDERS; returns the largest |residual| relative to the largest y. */
static double fit_parabola(const double y[], double coefficient[3])
{
    double A[3][4] = {{0}}, worst = 0;
    for (int j = 1; j <= ORDERS; j++) {
        const double power[3] = {1, j, j * j};
        for (int r = 0; r < 3; r++) {
            for (int c = 0; c < 3; c++) A[r][c] += power[r] * power[c];
            A[r][3] += power[r] * y[j];
        }
    }
    for (int k = 0; k < 3; k++) /* positive definite: no exchanges */
        for (int r = 0; r < 3; r++)
            for (int c = 3; r != k && c >= k; c--) A[r][c] -= A[r][k] / A[k][k] * A[k][c];
    for (int k = 0; k < 3; k++) coefficient[k] = A[k][3] / A[k][k];
    for (int j = 1; j <= ORDERS; j++)
        worst = fmax(worst, fabs(coefficient[0] + coefficient[1] * j + coefficient[2] * j * j - y[j]));
    return worst / y[ORDERS];
}

/* Recorded operations whose recurrence is a convolution, O(k) at order k. */
static int count_products(const jet_tape *tape)
{
    int count = 0;
    for (int i = 0; i < tape->run_count; i++)
        count += tape->runs[i].op == OP_LINEAR ? 0 : tape->runs[i].operation_count;
    return count;
}

static void write_row(FILE *table, const scene *s, const tvi_system *system, const char *what, const double y[])
{
    double c[3];
    const double misfit = fit_parabola(y, c);
    fprintf(table, "| %s | %d | %d | %s | %.3g | %.3g | %.3g | %.2f | %.2f | %.3g + %.3g j + %.3g j^2 | %.0f%% |\n",
            s->name, s->n, count_products(system->field_series), what, 1e6 * y[5], 1e6 * y[10], 1e6 * y[20],
            y[20] / y[10], pow(y[20] / y[10], 0.1), 1e6 * c[0], 1e6 * c[1], 1e6 * c[2], 100 * misfit);
}

static void measure_scene(const scene *s, FILE *csv, FILE *table)
{
    double series[ORDERS + 1] = {0}, jacobians[ORDERS + 1] = {0};
    tvi_system *system = experiment_system(s);
    experiment_progress("  %s", s->name);
    for (int j = 1; j <= ORDERS; j++) {
        prolongation x = prolong(system, s, j);
        series[j] = time_of(&x, false);
        jacobians[j] = time_of(&x, true);
        free(x.memory);
        fprintf(csv, "%s,%d,%d,%.4e,%.4e\n", s->name, s->n, j, series[j], jacobians[j]);
    }
    write_row(table, s, system, "series", series);
    write_row(table, s, system, "Jacobians", jacobians);
    tvi_system_free(system);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    FILE *csv = experiment_csv(&e, "derivatives", "scene,n,j,series_s,jacobians_s");
    FILE *table =
        experiment_table(&e, "derivatives",
                         " scene | n | convolutions | of | us, j = 5 (time) | us, j = 10 (time) | us, j = 20 (time) "
                         "| 20 to 10 (time) | growth a derivative (time) | fit, us (time) | misfit (time) ");
    for (int i = 0; i < SCENES; i++) measure_scene(by_dimension[i], csv, table);
    experiment_close(csv);
    experiment_close(table);
}
