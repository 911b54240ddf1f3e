/* rounded.c - Makes steps of Gauss collocation with coefficients that are rounded one by one (rounded.h). */
#include "rounded.h"
#include "baselines/gauss_tableau.h"
#include "system/system.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* With F_j the force at node j,
 *   Q_i = q0 + (c_i h/m p0 + h^2/m sum_j (a a)_ij F_j),
 *   q1 = q0 + h/m (p0 + h sum_j b_j (1 - c_j) F_j),   p1 = p0 + h sum_j b_j F_j.
 * Arrays of nodes are [n][NODES]. */
enum { NODES = 8, MOST_PASSES = 100, N_MAX = 18 };

struct rounded {
    const tvi_system *system;
    double h;
    double node[2][NODES], weight[2][NODES], position_weight[2][NODES]; /* in two parts, the first short */
    double matrix[NODES][NODES];                                        /* [j][i] (a a)_ij */
    double ahead[2][2][NODES][NODES];                                   /* [steps - 1][step back][j][i] */
    double Q[N_MAX * NODES], force[N_MAX * NODES], before[N_MAX * NODES], guess[N_MAX * NODES];
    double q_low[N_MAX], p_low[N_MAX], size[N_MAX];
    long made;     /* steps: force and before are those of the last two */
    double *block; /* of the force's tape */
};

static void split(long double x, double *part, double *rest)
{
    *part = (float)x;
    *rest = (double)(x - *part);
}

/* pi_0(s), ... at the nodes of the step before the last, of the last and of the next one: polynomials that are
 * orthonormal on the first two thirds. */
enum { DEGREE = 3 * NODES / 2, PLACES = 3 * NODES };

static void set_basis(const gauss_tableau *t, long double basis[DEGREE + 1][PLACES])
{
    for (int k = 0; k <= DEGREE; k++) {
        for (int i = 0; i < PLACES; i++)
            basis[k][i] = k > 0 ? basis[k - 1][i] * (t->node[i % NODES] + (long double)(i / NODES) - 1) : 1;
        for (int l = 0; l <= k; l++) { /* at last its own length */
            long double product = 0;
            for (int i = 0; i < 2 * NODES; i++) product += basis[k][i] * basis[l][i];
            for (int i = 0; i < PLACES; i++)
                basis[k][i] = l < k ? basis[k][i] - product * basis[l][i] : basis[k][i] / sqrtl(product);
        }
    }
}

/* The next step from one by its polynomial, from two by least squares, sum_k pi_k(1 + c_i) pi_k(s_j). */
static void set_predictor(rounded *r, const gauss_tableau *t)
{
    long double basis[DEGREE + 1][PLACES];
    set_basis(t, basis);
    for (int i = 0; i < NODES; i++)
        for (int j = 0; j < NODES; j++) {
            r->ahead[0][0][j][i] = (double)t->extrapolation[i][j];
            for (int back = 0; back < 2; back++) {
                long double sum = 0;
                for (int k = 0; k <= DEGREE; k++) sum += basis[k][2 * NODES + i] * basis[k][(1 - back) * NODES + j];
                r->ahead[1][back][j][i] = (double)sum;
            }
        }
}

rounded *rounded_create(const tvi_system *system, double h)
{
    rounded *r = calloc(1, sizeof *r);
    if (!r) return NULL;
    r->block = malloc((size_t)(system->field_values->slot_count * NODES) * sizeof *r->block);
    if (!r->block) return free(r), NULL;
    jet_tape_write_constants(system->field_values, r->block, 1, NODES);
    r->system = system, r->h = h;
    const gauss_tableau *t = gauss_tableau_of(NODES);
    for (int i = 0; i < NODES; i++) {
        split(t->node[i], &r->node[0][i], &r->node[1][i]);
        split(t->weight[i], &r->weight[0][i], &r->weight[1][i]);
        split(t->position_weight[i], &r->position_weight[0][i], &r->position_weight[1][i]);
        for (int j = 0; j < NODES; j++) r->matrix[j][i] = (double)t->matrix[i][j];
    }
    set_predictor(r, t);
    return r;
}

void rounded_free(rounded *r)
{
    if (r) free(r->block);
    free(r);
}

/* out_i += sum_j row_ji x_j */
static void add_product(double row[NODES][NODES], const double x[NODES], double out[NODES])
{
    for (int j = 0; j < NODES; j++)
        for (int i = 0; i < NODES; i++) out[i] += row[j][i] * x[j];
}

static tvi_status evaluate(rounded *r)
{
    const jet_tape *tape = r->system->field_values;
    const size_t size = NODES * sizeof(double);
    memcpy(r->block, r->Q, (size_t)r->system->n * size);
    if (!jet_sweep_values(tape, r->block, NODES)) return TVI_EDOMAIN;
    for (int u = 0; u < r->system->n; u++) memcpy(r->force + u * NODES, r->block + tape->output_slot[u] * NODES, size);
    return TVI_OK;
}

/* Q of the forces; the sum of the squares of the movements, relative to the sizes. */
static double place(rounded *r, const double force[], const double q[], const double p[])
{
    double squares = 0;
    for (int u = 0; u < r->system->n; u++) {
        const double rate = r->h / r->system->mass[u], drift = rate * p[u], scale = r->h * rate;
        double sum[NODES] = {0};
        add_product(r->matrix, force + u * NODES, sum);
        for (int i = 0; i < NODES; i++) {
            const double now = q[u] + (r->node[0][i] * drift + r->node[1][i] * drift + scale * sum[i]);
            const double change = (now - r->Q[u * NODES + i]) / r->size[u];
            squares += change * change;
            r->Q[u * NODES + i] = now;
        }
    }
    return squares;
}

/* The forces from those of the last steps, or as at the start. */
static tvi_status guess(rounded *r, const double q[])
{
    const int n = r->system->n;
    const size_t size = (size_t)(n * NODES) * sizeof(double);
    if (r->made == 0) {
        for (int k = 0; k < n * NODES; k++) r->Q[k] = q[k / NODES];
        const tvi_status status = evaluate(r);
        memcpy(r->guess, r->force, size);
        return status;
    }
    memset(r->guess, 0, size);
    for (int u = 0; u < n * NODES; u += NODES) {
        add_product(r->ahead[r->made > 1][0], r->force + u, r->guess + u);
        if (r->made > 1) add_product(r->ahead[1][1], r->before + u, r->guess + u);
    }
    memcpy(r->before, r->force, size);
    return TVI_OK;
}

/* Q of the guess, and the sizes of the unknowns: |q0| + |Q_8 - q0|, with a share of the largest. */
static tvi_status predict(rounded *r, const double q[], const double p[])
{
    double largest = 0;
    const tvi_status status = guess(r, q);
    if (status != TVI_OK) return status;
    for (int u = 0; u < r->system->n; u++) r->size[u] = 1;
    (void)place(r, r->guess, q, p);
    for (int u = 0; u < r->system->n; u++) {
        r->size[u] = fabs(q[u]) + fabs(r->Q[u * NODES + NODES - 1] - q[u]);
        largest = fmax(largest, r->size[u]);
    }
    for (int u = 0; u < r->system->n; u++) r->size[u] += 1e-3 * largest;
    return TVI_OK;
}

/* Squares of movements. */
typedef struct {
    double moved, before, slowest, expected;
} progress;

/* The movement that is left is that of the last pass times the slowest contraction that was seen above roundoff. */
static bool is_enough(progress *at, double moved, double count)
{
    const double roundoff = 1024 * DBL_EPSILON * DBL_EPSILON * count, nothing = pow(DBL_EPSILON / 4096, 2) * count;
    bool enough = moved == 0 || (at->before > 0 && moved >= at->moved && moved >= at->before && moved <= 1e-24 * count);
    if (at->moved > 0 && moved <= 1e-18 * count) {
        if (moved > roundoff) {
            at->slowest = fmax(moved / at->moved, at->before > 0 ? at->moved / at->before : 0);
            at->expected = moved;
        } else at->expected = at->slowest > 0 ? fmin(moved, at->slowest * at->expected) : moved;
        enough |= at->slowest > 0 && at->slowest < 0.25 && at->slowest * at->expected <= nothing;
    }
    at->before = at->moved, at->moved = moved;
    return enough;
}

static tvi_status iterate(rounded *r, const double q[], const double p[])
{
    progress at = {0};
    for (int pass = 1; pass <= MOST_PASSES; pass++) {
        const tvi_status status = evaluate(r);
        if (status != TVI_OK) return status;
        if (is_enough(&at, place(r, r->force, q, p), r->system->n * NODES)) return TVI_OK;
    }
    return TVI_ENOCONV;
}

/* x + low <- x + low + d (Kahan). */
static void add(double *x, double *low, double d)
{
    const double y = d + *low, sum = *x + y;
    *low = (*x - sum) + y;
    *x = sum;
}

static double integral(double weight[2][NODES], const double force[NODES])
{
    double sum[2] = {0};
    for (int j = 0; j < NODES; j++) sum[0] += weight[0][j] * force[j], sum[1] += weight[1][j] * force[j];
    return sum[0] + sum[1];
}

tvi_status rounded_run(rounded *r, long steps, double q[], double p[])
{
    for (long step = 0; step < steps; step++) {
        tvi_status status = predict(r, q, p);
        if (status == TVI_OK) status = iterate(r, q, p);
        if (status != TVI_OK) return status;
        r->made++;
        for (int u = 0; u < r->system->n; u++) {
            const double *force = r->force + u * NODES, rate = r->h / r->system->mass[u];
            add(&q[u], &r->q_low[u], rate * (p[u] + (r->p_low[u] + r->h * integral(r->position_weight, force))));
            add(&p[u], &r->p_low[u], r->h * integral(r->weight, force));
        }
    }
    return TVI_OK;
}
