/* gradient.c - Measures what the gradient of a run costs beside the run, and beside the full Jacobian by tangent
 * columns; and that a long run's gradient needs little memory. Writes DIR/gradient.md and DIR/memory.md.
 *     gradient DIR */
#include "experiments/experiment.h"
#include "performance/turns.h"
#include "systems.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 4 };

/* A row of the table: one system, run in four ways. */
typedef struct {
    const gradient_system *of;
    tvi_system *system;
    tvi_integrator *it;
    tvi_record *record;
    long steps;
    double loss[2 * GRADIENT_MOST + 1];
    double D[COLUMNS * (2 * GRADIENT_MOST + GRADIENT_MOST_PARAMETERS)];
    double by_start[2 * GRADIENT_MOST + 1], by_parameters[GRADIENT_MOST_PARAMETERS];
} row;

static void go(row *r, tvi_record *record, bool has_columns)
{
    double t = 0, q[GRADIENT_MOST], p[GRADIENT_MOST];
    memcpy(q, r->of->q, sizeof q);
    memcpy(p, r->of->p, sizeof p);
    tvi_run_plan plan = {.h = r->of->h, .steps = r->steps, .record = record};
    if (has_columns) plan.D = r->D, plan.columns = COLUMNS;
    tvi_integrator_reset(r->it);
    experiment_insist(tvi_run(r->it, &plan, &t, q, p), r->of->title);
}

static void go_plain(void *ctx) { go(ctx, NULL, false); }
static void go_recorded(void *ctx) { go(ctx, ((row *)ctx)->record, false); }
static void go_with_columns(void *ctx)
{
    row *r = ctx;
    const int rows = 2 * r->of->n + tvi_system_parameters(r->system);
    memset(r->D, 0, sizeof r->D);
    for (int j = 0; j < COLUMNS; j++) r->D[(j < rows ? j : 0) * COLUMNS + j] = 1;
    go(r, NULL, true);
}
static void go_back(void *ctx)
{
    row *r = ctx;
    const tvi_loss loss = {.end = r->loss};
    experiment_insist(tvi_gradient(r->record, &loss, r->by_start, r->by_parameters), r->of->title);
}

static void open_row(row *r, const gradient_system *of, long steps, size_t bytes)
{
    memset(r, 0, sizeof *r);
    r->of = of;
    r->steps = steps;
    r->system = of->make(of->n);
    experiment_insist(tvi_integrator_create(&r->it, r->system, NULL), of->title);
    experiment_insist(tvi_record_create(&r->record, r->it, bytes), of->title);
    for (int i = 0; i < 2 * of->n; i++) r->loss[i] = 1 + 0.1 * i;
}

static void close_row(const row *r)
{
    tvi_record_free(r->record);
    tvi_integrator_free(r->it);
    tvi_system_free(r->system);
}

static void measure(FILE *table, const gradient_system *of, long steps)
{
    row r;
    open_row(&r, of, steps, 0);
    turn turns[] = {{.work = go_plain, .ctx = &r},
                    {.work = go_recorded, .ctx = &r},
                    {.work = go_back, .ctx = &r},
                    {.work = go_with_columns, .ctx = &r}};
    go_recorded(&r);
    turns_time(4, turns);
    const double plain = turns[0].seconds, column = (turns[3].seconds - plain) / COLUMNS / plain;
    const int parameters = tvi_system_parameters(r.system), values = 2 * of->n + parameters;
    fprintf(table, "| %s | %d, %d | %.3g | %.2f | %.2f | %.1f | %.0f |\n", of->title, of->n, parameters,
            1e6 * plain / (double)steps, turns[1].seconds / plain, turns[2].seconds / plain, column, column * values);
    close_row(&r);
}

/* A run of 1e6 steps whose record has 9 MB, and one with all steps. */
static void measure_memory(FILE *table, const gradient_system *of, long steps)
{
    static row r[2];
    double largest = 0, apart = 0;
    for (int k = 0; k < 2; k++) {
        open_row(&r[k], of, steps, k == 0 ? (size_t)9000000 : (size_t)3000000000);
        go_recorded(&r[k]);
        go_back(&r[k]);
        for (int i = 0; i < 2 * of->n; i++) {
            largest = fmax(largest, fabs(r[k].by_start[i]));
            apart = fmax(apart, k == 0 ? 0 : fabs(r[0].by_start[i] - r[1].by_start[i]));
        }
    }
    fprintf(table, "| %s | %ld | %.3g | %.3g | %.2g |\n", of->title, steps,
            1e-6 * (double)tvi_record_bytes(r[0].record), 1e-6 * (double)tvi_record_bytes(r[1].record),
            apart / largest);
    for (int k = 0; k < 2; k++) close_row(&r[k]);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    gradient_systems_begin();
    FILE *table = experiment_table(&e, "gradient",
                                   "system|n, parameters|step, us (time)|with a record (time)|gradient (time)|a column "
                                   "(time)|Jacobian by columns (time)");
    for (int i = 0; i < GRADIENT_SYSTEMS; i++) measure(table, &gradient_systems[i], 1000);
    experiment_close(table);
    table = experiment_table(&e, "memory", "system|steps|MB|MB, all steps kept|apart");
    measure_memory(table, &gradient_systems[GRADIENT_FIVE_BODIES], 1000000);
    experiment_close(table);
    return EXIT_SUCCESS;
}
