/* cost.c - Measures what a step of type I at the midpoint costs: against n, with Jacobians as matrices and as products,
 * and against N. Linked with --wrap=tvi_curve_choose_jacobians, so that both can be had at every n. Writes
 * DIR/cost_n.md, cost_n.csv and cost_degree.csv.
 *     cost DIR */
#include "curves.h"
#include "experiments/experiment.h"
#include "stepping.h"

static const int bodies[] = {3, 4, 5, 6, 8, 10, 15, 20, 30, 40};
static const int degrees[] = {2, 3, 4, 6, 8, 10, 12, 16, 20, 25, 30};
enum { BODIES = sizeof bodies / sizeof *bodies, DEGREES = sizeof degrees / sizeof *degrees, DEGREE = 8 };

/* ---- The choice of the Jacobians --------------------------------------------------------------------------------- */

static tvi_jacobians forced = TVI_NO_JACOBIANS; /* TVI_NO_JACOBIANS: the library chooses. */

tvi_jacobians __real_tvi_curve_choose_jacobians(const tvi_system *system);
tvi_jacobians __wrap_tvi_curve_choose_jacobians(const tvi_system *system);
tvi_jacobians __wrap_tvi_curve_choose_jacobians(const tvi_system *system)
{
    return forced == TVI_NO_JACOBIANS ? __real_tvi_curve_choose_jacobians(system) : forced;
}

/* ---- Measurements ------------------------------------------------------------------------------------------------ */

typedef struct {
    double matrices, products, expansion; /* us of a step; of one plain expansion */
    double passes[2];
} cost;

static stepping open_with(tvi_jacobians jacobians, const big_system *b, int N)
{
    const tvi_options options = {.method = TVI_TYPE1, .expansion = TVI_AT_MIDPOINT, .degree = N};
    forced = jacobians;
    stepping s = stepping_open(b->system, &options, b->q, b->p, b->h);
    forced = TVI_NO_JACOBIANS;
    return s;
}

static cost measure(const big_system *b, int N)
{
    static const tvi_jacobians ways[] = {TVI_JACOBIAN_MATRICES, TVI_JACOBIAN_PRODUCTS};
    stepping s[2];
    turn t[3];
    for (int i = 0; i < 2; i++) {
        s[i] = open_with(ways[i], b, N);
        t[i] = (turn){.work = stepping_go, .ctx = &s[i]};
    }
    open_curve *c = curve_open(b->system, N, b->q, b->p, b->h);
    t[2] = (turn){.work = curve_expand, .ctx = c};
    turns_time(3, t);
    const cost found = {stepping_time(&t[0]), stepping_time(&t[1]), 1e6 * t[2].seconds, {s[0].passes, s[1].passes}};
    for (int i = 0; i < 2; i++) stepping_close(&s[i]);
    curve_close(c);
    return found;
}

/* ---- Tables ------------------------------------------------------------------------------------------------------ */

static void write_row(FILE *table, const cost *c)
{
    fprintf(table, " %.1f | %.1f | %.3g | %.3g | %.3g | %.2f | %.1f |\n", c->passes[0], c->passes[1], c->expansion,
            c->matrices, c->products, c->products / c->matrices, c->products / c->expansion);
}

static void write_csv(FILE *csv, int x, const cost *c)
{
    fprintf(csv, "%d,%.4g,%.4g,%.4g\n", x, c->expansion, c->matrices, c->products);
}

#define COSTS                                                                                                          \
    "passes, matrices|passes, products|expansion, us (time)|step with matrices, us (time)|step with products, us "     \
    "(time)|"                                                                                                          \
    "products / matrices (time)|products / expansion (time)"
#define CSV_COSTS ",expansion us,matrices us,products us"

static void against_n(const experiment *e)
{
    FILE *table = experiment_table(e, "cost_n", "bodies|n|" COSTS);
    FILE *csv = experiment_csv(e, "cost_n", "n" CSV_COSTS);
    for (int i = 0; i < BODIES; i++) {
        big_system b = bodies_make(bodies[i], 3);
        const cost c = measure(&b, DEGREE);
        fprintf(table, "| %d | %d |", bodies[i], b.n);
        write_row(table, &c);
        write_csv(csv, b.n, &c);
        tvi_system_free(b.system);
        experiment_progress("cost: %d bodies", bodies[i]);
    }
    experiment_close(table);
    experiment_close(csv);
}

static void against_degree(const experiment *e)
{
    FILE *csv = experiment_csv(e, "cost_degree", "N" CSV_COSTS);
    big_system b = bodies_make(6, 3);
    b.h = 0.1; /* low orders converge, too */
    for (int i = 0; i < DEGREES; i++) {
        const cost c = measure(&b, degrees[i]);
        write_csv(csv, degrees[i], &c);
        experiment_progress("cost: N = %d", degrees[i]);
    }
    tvi_system_free(b.system);
    experiment_close(csv);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    against_n(&e);
    against_degree(&e);
    return 0;
}
