/* columns.c - Measures what a column of D costs in plain steps, alone and at once with others, and how far the two are
 * apart. Writes DIR/columns.md and DIR/jacobian.md.
 *     columns DIR */
#include "experiments/experiment.h"
#include "performance/turns.h"
#include "systems.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COUNTS = 4, STEPS = 400 };
static const int counts[COUNTS] = {1, 2, 4, 16};

/* A run of a system without columns, or with the first of the identity, alone or at once. */
typedef struct {
    const gradient_system *of;
    tvi_integrator *it;
    double *D;
    int rows, columns;
    bool at_once;
} job;

static void go(void *ctx)
{
    const job *j = ctx;
    double t = 0, q[GRADIENT_MOST], p[GRADIENT_MOST];
    memcpy(q, j->of->q, sizeof q);
    memcpy(p, j->of->p, sizeof p);
    const tvi_run_plan plan = {.h = j->of->h,
                               .steps = STEPS,
                               .D = j->columns > 0 ? j->D : NULL,
                               .columns = j->columns,
                               .columns_at_once = j->at_once};
    for (int i = 0; i < j->rows * j->columns; i++) j->D[i] = i / j->columns == i % j->columns;
    tvi_integrator_reset(j->it);
    experiment_insist(tvi_run(j->it, &plan, &t, q, p), j->of->title);
}

static job new_job(const gradient_system *of, const tvi_system *system, int columns, bool at_once)
{
    job j = {.of = of, .rows = 2 * of->n + tvi_system_parameters(system), .columns = columns, .at_once = at_once};
    j.D = calloc((size_t)(j.rows * (columns + 1)), sizeof *j.D);
    experiment_insist(j.D ? TVI_OK : TVI_ENOMEM, "a matrix");
    experiment_insist(tvi_integrator_create(&j.it, system, NULL), of->title);
    return j;
}

static void free_job(const job *j)
{
    tvi_integrator_free(j->it);
    free(j->D);
}

/* [plain steps] The price of a column. */
static double price(const turn *with, const turn *plain, int columns)
{
    return (with->seconds / plain->seconds - 1) / columns;
}

static void measure_counts(FILE *table, const gradient_system *of)
{
    tvi_system *system = of->make(of->n);
    job jobs[COUNTS + 2] = {new_job(of, system, 0, false), new_job(of, system, 1, false)};
    turn turns[COUNTS + 2];
    int count = 2;
    for (int k = 0; k < COUNTS && counts[k] <= jobs[0].rows; k++) jobs[count++] = new_job(of, system, counts[k], true);
    for (int k = 0; k < count; k++) turns[k] = (turn){.work = go, .ctx = &jobs[k]};
    turns_time(count, turns);
    fprintf(table, "| %s | %d, %d | %.3g | %.2f |", of->title, of->n, tvi_system_parameters(system),
            1e6 * turns[0].seconds / STEPS, price(&turns[1], &turns[0], 1));
    for (int k = 0; k < COUNTS; k++)
        if (k + 2 < count) fprintf(table, " %.2f |", price(&turns[k + 2], &turns[0], counts[k]));
        else fprintf(table, " - |");
    fprintf(table, "\n");
    for (int k = 0; k < count; k++) free_job(&jobs[k]);
    tvi_system_free(system);
}

/* The derivatives by the start and all parameters. */
static void measure_jacobian(FILE *table, const gradient_system *of)
{
    tvi_system *system = of->make(of->n);
    const int rows = 2 * of->n + tvi_system_parameters(system);
    job jobs[] = {new_job(of, system, 0, false), new_job(of, system, rows, false), new_job(of, system, rows, true)};
    turn turns[3];
    double largest = 0, apart = 0;
    for (int k = 0; k < 3; k++) turns[k] = (turn){.work = go, .ctx = &jobs[k]};
    turns_time(3, turns);
    for (int i = 0; i < rows * rows; i++) {
        largest = fmax(largest, fabs(jobs[1].D[i]));
        apart = fmax(apart, fabs(jobs[1].D[i] - jobs[2].D[i]));
    }
    fprintf(table, "| %s | %d | %.0f | %.0f | %.2f | %.1e |\n", of->title, rows,
            turns[1].seconds / turns[0].seconds - 1, turns[2].seconds / turns[0].seconds - 1,
            price(&turns[2], &turns[0], rows), apart / largest);
    for (int k = 0; k < 3; k++) free_job(&jobs[k]);
    tvi_system_free(system);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    gradient_systems_begin();
    FILE *table = experiment_table(&e, "columns",
                                   " system | n, parameters | step, us (time) | a column alone (time) | 1 at once "
                                   "(time) | 2 (time) | 4 (time) | 16 (time) ");
    for (int i = 0; i < GRADIENT_DOUBLE_PENDULUM; i++) measure_counts(table, &gradient_systems[i]);
    experiment_close(table);
    table =
        experiment_table(&e, "jacobian",
                         " system | columns | alone, runs (time) | at once, runs (time) | a column at once (time) | "
                         "apart (chaotic) ");
    for (int i = 0; i < GRADIENT_DOUBLE_PENDULUM; i++) measure_jacobian(table, &gradient_systems[i]);
    experiment_close(table);
    return EXIT_SUCCESS;
}
