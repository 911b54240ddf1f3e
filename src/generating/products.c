/* products.c - solves the equations A^T x = D_z for the corrections of the curve's ends without forming Jacobians, for
 * separable systems of many coordinates. One adjoint sweep computes a product with a transposed Jacobian, and
 * generalised conjugate residuals solve the equations (docs/method.md sections 2 and 5). step.c chooses this solver.
 * The letters: x is the solution, r = D_z - A^T x, s a direction, v = A^T s its image, P the preconditioner, and (x, y)
 * = sum_i x_i y_i / size_i^2 over the rows that are solved, with size_i that of the unknowns. */
#include "algebra/passes.h"
#include "generating/corrected.h"
#include "generating/newton.h"
#include "vector.h"

#include <float.h>

/* [iterations] Generalised conjugate residuals make at most this many iterations, each with one search direction. */
#define PRODUCTS_MAX_ITERATIONS 40 /* found: make check-generating */
/* [orders] The preconditioner includes only the orders of the curve up to this one. */
#define PRODUCTS_NEAR_ORDER 3 /* found: make check-generating */
/* [1] A pass need not reduce the residual by more than this factor, since the next pass computes the residual anew. */
#define PRODUCTS_REDUCTION 1e-6 /* found: make check-generating */
/* [1] Corrections of conjugate residuals that no longer shrink are roundoff if they are this part of the solution. */
#define PRODUCTS_STALLED_CORRECTION 1e-12 /* found: make check-generating */
/* [1] A product of the Jacobian with a vector, to the relative accuracy r, leaves out the last coefficients of the
 * curve, with |Q_k| below r / PRODUCTS_TRUNCATION_SAFETY |Q_0|. */
#define PRODUCTS_TRUNCATION_SAFETY 10 /* found: make check-generating */

/* ---- Products with transposed Jacobians -------------------------------------------------------------------------- */

static double *adjoint_of_Q(const tvi_curve *curve, int k)
{
    return curve->jacobians.adjoints + (size_t)k * curve_stride(curve);
}

/* Sets the adjoints of Q_k to the seeds, and all other adjoints to 0, since operations of an order may add to the
 * adjoints of all lower orders. The sweep does not use other adjoints of the last two orders, since no Q_k follows from
 * these orders of the field. */
static void set_adjoint_seeds(const tvi_curve *curve, int last_order, const tvi_transposed_product *product)
{
    const int n = curve->n;
    for (int k = 0; k <= last_order; k++) {
        const double upper = product->upper ? product->factor * product->upper->weight[k] : 0,
                     lower = product->lower ? product->factor * product->lower->weight[k] : 0;
        double *restrict bar = adjoint_of_Q(curve, k);
        if (product->seed_Q) memcpy(bar, product->seed_Q + k * n, (size_t)n * sizeof *bar);
        else memset(bar, 0, (size_t)n * sizeof *bar);
        for (int i = 0; i < n && product->upper; i++) bar[i] += upper * product->x[i];
        for (int i = 0; i < n && product->lower; i++) bar[i] += lower * product->y[i];
        if (k + 2 <= last_order) memset(bar + n, 0, (curve_stride(curve) - (size_t)n) * sizeof *bar);
    }
}

#define ADD_TO_FORCE(V, S)                                                                                             \
    if (JET_IN_A_ROW(V, slot + here)) {                                                                                \
        *(V *)(bar + slot[here]) += part * JET_OF(V, kappa, 0) * JET_OF(V, above, 0);                                  \
    } else {                                                                                                           \
        for (int i = here; i < here + (int)(sizeof(V) / sizeof(double)); i++)                                          \
            bar[slot[i]] += part * kappa[i] * above[i];                                                                \
    }

/* Computes the product from high to low orders: the adjoint of order k of the force is Fbar_k = tau^2 / ((k+1)(k+2))
 * M^-1 Qbar_{k+2}; then follow the adjoints of the operations of that order. */
void tvi_multiply_transposed(tvi_curve *curve, int last_order, const tvi_transposed_product *product, double out[])
{
    enum { stride = 0 };
    const size_t n = (size_t)curve->n;
    const double *kappa = curve->kappa;
    const int *slot = curve->system->field_series->output_slot;
    set_adjoint_seeds(curve, last_order, product);
    for (int k = last_order - 2; k >= 0; k--) {
        const double part = curve->tau / ((k + 1) * (k + 2)), *above = adjoint_of_Q(curve, k + 2);
        double *bar = adjoint_of_Q(curve, k);
        JET_BLOCKS((int)n, ADD_TO_FORCE, );
        jet_sweep_adjoints(curve->system->field_series, curve->series, curve->jacobians.adjoints, k, last_order - 2);
    }
    memcpy(out, adjoint_of_Q(curve, 0), n * sizeof *out);
    memcpy(out + n, adjoint_of_Q(curve, 1), n * sizeof *out);
}

/* ---- The equations ----------------------------------------------------------------------------------------------- */

/* Arrays of 2n rows are padded with zeros to whole vectors. Rows that are not solved for are 0, and have a
 * one_over_size of 0. */
enum { VECTOR = 8 };
typedef struct {
    int rows;                             /* 2n, padded */
    int first;                            /* the first row that is solved for */
    double *x;                            /* the solution, which is the guess of the next pass */
    double *r;                            /* D_z - A^T x */
    double *s, *v;                        /* [PRODUCTS_MAX_ITERATIONS][rows] the directions, and their images */
    double norm[PRODUCTS_MAX_ITERATIONS]; /* (v, v) of each image */
    double *one_over_size;                /* the reciprocal of each unknown's size, by which its error is measured */
    double *scratch, *product;            /* scratch; the second for products of Jacobians with vectors */
    double *Q_size;                       /* [highest_order + 1] max_i |Q_k| of each k */
    bool has_guess;
} tvi_residuals;

static void allocate(tvi_corrected_curve *c, tvi_arena *arena)
{
    const int n = c->curve.n, rows = (2 * n + VECTOR - 1) / VECTOR * VECTOR;
    const size_t width = (size_t)rows;
    tvi_residuals *allocated = tvi_arena_allocate(arena, sizeof *allocated),
                  it = {.rows = rows, .first = c->definition->equations.takes_last_columns_of_J ? n : 0};
    tvi_arena_allocate_each(arena, width,
                            (double **[]){&it.x, &it.r, &it.one_over_size, &it.scratch, &it.product, NULL});
    tvi_arena_allocate_each(arena, PRODUCTS_MAX_ITERATIONS * width, (double **[]){&it.s, &it.v, NULL});
    it.Q_size = tvi_arena_allocate_doubles(arena, (size_t)c->curve.highest_order + 1);
    if (allocated) *allocated = it;
    c->solver_memory = allocated;
}

static void begin(tvi_corrected_curve *c) { ((tvi_residuals *)c->solver_memory)->has_guess = false; }

/* Returns the second sum of the equations, or NULL. */
static const tvi_series_sum *lower_sum(const tvi_corrected_curve *c)
{
    const tvi_end_sum lower = c->definition->equations.lower_sum;
    return lower ? &c->ends[lower] : NULL;
}

/* Returns the operands of the product factor A^T vector, with the matrix A of the equations. */
static tvi_transposed_product transposed_A_times(const tvi_corrected_curve *c, double factor, const double vector[])
{
    const tvi_residuals *it = c->solver_memory;
    return (tvi_transposed_product){NULL,
                                    factor,
                                    &c->ends[c->definition->equations.upper_sum],
                                    lower_sum(c),
                                    vector + it->first,
                                    vector + c->curve.n};
}

/* Computes vector = W^-1 r, with the weights W of Q_0 and Q_1 in A. */
static void divide_by_weights(const tvi_corrected_curve *c, const double r[], double vector[])
{
    const tvi_residuals *it = c->solver_memory;
    const tvi_series_sum *lower = lower_sum(c);
    const int n = c->curve.n, first = it->first;
    const double upper_part = 1 / c->ends[c->definition->equations.upper_sum].weight[first > 0],
                 lower_part = lower ? 1 / lower->weight[1] : 0;
    for (int i = 0; i < n; i++) vector[first + i] = upper_part * r[first + i];
    for (int i = 0; i < n && lower_part != 0; i++) vector[n + i] = lower_part * r[n + i];
}

/* Computes s = P r = W^-1 (2 r - A^T W^-1 r), an approximation of A^-T r. A is computed from the first
 * PRODUCTS_NEAR_ORDER orders only, which are exact for a force that is linear in q with a Jacobian that is linear in
 * the time. */
static void precondition(tvi_corrected_curve *c, const double r[], double s[])
{
    tvi_residuals *it = c->solver_memory;
    const int highest = c->curve.highest_order,
              last_order = highest < PRODUCTS_NEAR_ORDER ? highest : PRODUCTS_NEAR_ORDER;
    memset(s, 0, (size_t)it->rows * sizeof *s);
    divide_by_weights(c, r, s);
    const tvi_transposed_product product = transposed_A_times(c, 1, s);
    tvi_multiply_transposed(&c->curve, last_order, &product, it->product);
    for (int i = 0; i < 2 * c->curve.n; i++) it->scratch[i] = 2 * r[i] - it->product[i];
    divide_by_weights(c, it->scratch, s);
}

/* Returns max_i |vector_i| / size_i. */
static double scaled_norm(const tvi_residuals *it, const double vector[])
{
    double most = 0;
    for (int i = 0; i < it->rows; i++) most = tvi_larger(fabs(vector[i]) * it->one_over_size[i], most);
    return most;
}

/* Returns (x, y). */
static double scaled_dot(const tvi_residuals *it, const double x[], const double y[])
{
    const double *unit = it->one_over_size;
    double sum[VECTOR] = {0};
    for (int here = 0; here < it->rows; here += VECTOR)
        for (int lane = 0; lane < VECTOR; lane++)
            sum[lane] += x[here + lane] * unit[here + lane] * (y[here + lane] * unit[here + lane]);
    return ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
}

static void add_multiple(int rows, double factor, const double x[], double *restrict y)
{
    for (int i = 0; i < rows; i++) y[i] += factor * x[i];
}

/* Makes the image v of direction number `index` orthogonal to the earlier images, changes s with it, and sets
 * x += s (r, v)/(v, v), r -= v (r, v)/(v, v). */
static void minimise_along_direction(tvi_corrected_curve *c, int last_order, int index)
{
    tvi_residuals *it = c->solver_memory;
    const int rows = it->rows;
    double *s = it->s + index * rows, *v = it->v + index * rows;
    const tvi_transposed_product product = transposed_A_times(c, 1, s);
    tvi_multiply_transposed(&c->curve, last_order, &product, v);
    for (int i = 0; i < index; i++) {
        const double part = tvi_ratio_or_zero(scaled_dot(it, v, it->v + i * rows), it->norm[i]);
        add_multiple(rows, -part, it->v + i * rows, v);
        add_multiple(rows, -part, it->s + i * rows, s);
    }
    it->norm[index] = scaled_dot(it, v, v);
    const double part = tvi_ratio_or_zero(scaled_dot(it, it->r, v), it->norm[index]);
    add_multiple(rows, part, s, it->x);
    add_multiple(rows, -part, v, it->r);
}

/* Returns the highest order of the curve that a product with this relative accuracy needs: the first order from which
 * on |Q_k| is below accuracy / PRODUCTS_TRUNCATION_SAFETY |Q_0|, or the highest order. */
static int order_for_accuracy(const tvi_corrected_curve *c, double accuracy)
{
    const double *Q_size = ((const tvi_residuals *)c->solver_memory)->Q_size,
                 bound = accuracy / PRODUCTS_TRUNCATION_SAFETY * Q_size[0];
    int k = c->curve.highest_order;
    while (k > 1 && !(Q_size[k - 1] > bound)) k--;
    return k;
}

/* Solves A^T x = D_z from the x of the last pass. Fails if corrections do not shrink. */
static tvi_status solve_for_x(tvi_corrected_curve *c)
{
    tvi_residuals *it = c->solver_memory;
    double goal = CURVE_NEGLIGIBLE_ERROR;
    tvi_convergence_test passes;
    tvi_convergence_begin(&passes, 0);
    if (!it->has_guess) memset(it->x, 0, (size_t)it->rows * sizeof *it->x);
    tvi_transposed_product residual = transposed_A_times(c, -1, it->x);
    residual.seed_Q = c->seed_Q;
    tvi_multiply_transposed(&c->curve, c->curve.highest_order, &residual, it->r);
    for (int index = 0; index < PRODUCTS_MAX_ITERATIONS; index++) {
        double *s = it->s + index * it->rows;
        precondition(c, it->r, s);
        const double size = scaled_norm(it, s);
        if (!isfinite(size)) return TVI_ENONFINITE;
        if (index == 0) goal = tvi_larger(CURVE_NEGLIGIBLE_ERROR, PRODUCTS_REDUCTION * size);
        const tvi_stopping_rule rule = {.correction_goal = goal,
                                        .max_trusted_ratio = PASSES_MAX_CONTRACTION,
                                        .stall_ratio = PASSES_STALL_RATIO,
                                        .stall_comparison_lag = 1};
        const tvi_passes_verdict verdict = tvi_convergence_add_pass(&passes, &rule, size);
        const bool may_end =
            verdict == TVI_PASSES_MAY_END ||
            (verdict == TVI_PASSES_STUCK && size <= PRODUCTS_STALLED_CORRECTION * scaled_norm(it, it->x));
        /* With a second sum all rows are solved for, and no residual is needed. */
        if (may_end && lower_sum(c)) add_multiple(it->rows, 1, s, it->x);
        else minimise_along_direction(c, order_for_accuracy(c, goal < size ? goal / size : 1), index);
        it->has_guess = may_end;
        if (may_end) return TVI_OK;
    }
    return TVI_ENOCONV;
}

/* ---- The corrections --------------------------------------------------------------------------------------------- */

/* Sets the sizes of the unknowns of a subsystem, its components `component[first .. end - 1]`: the sum of the
 * magnitudes of all terms of the momentum. A size that is 0 or much smaller than the largest one is raised, to
 * NEWTON_MIN_SCALE times it or more. If all momenta are 0, the sizes are those of the positions; if these are 0, too,
 * they are 1. */
static void set_subsystem_sizes(const tvi_corrected_curve *c, const int *component, int first, int end)
{
    const int n = c->curve.n;
    const double *kappa = c->curve.kappa;
    double largest = 0, place = 0, *unit = ((tvi_residuals *)c->solver_memory)->one_over_size;
    for (int k = first; k < end; k++)
        largest = tvi_larger(fabs(kappa[component[k]]) * c->p_size[component[k]], largest);
    for (int order = 0; order <= c->curve.highest_order && largest == 0; order++)
        for (int k = first; k < end; k++) place = tvi_larger(fabs(curve_Q(&c->curve, order)[component[k]]), place);
    const double least = largest > 0 ? NEWTON_MIN_SCALE * largest : place, none = largest > 0 ? largest : place;
    for (int k = first; k < end; k++) {
        const int i = component[k];
        const double per = none > 0 ? 1 / fabs(kappa[i]) : 1, size = c->p_size[i];
        const double counted = size > 0 ? tvi_larger(size, least * per) : none > 0 ? none * per : 1;
        unit[i] = unit[n + i] = 1 / tvi_larger(counted, DBL_MIN);
    }
}

/* The first pass of a step sets the sizes for all passes of the step. */
static tvi_status solve(tvi_corrected_curve *c, const double z[], const double scale[], tvi_stats *stats)
{
    const tvi_subsystems *parts = &c->curve.system->subsystems;
    const size_t n = (size_t)c->curve.n, solved = lower_sum(c) ? 2 * n : n;
    const tvi_residuals *it = c->solver_memory;
    (void)z, (void)scale, (void)stats;
    if (!it->has_guess) {
        corrected_compute_p_size(c);
        for (int k = 0; k <= c->curve.highest_order; k++)
            it->Q_size[k] = tvi_largest_magnitude(c->curve.n, curve_Q(&c->curve, k), 1);
        for (int k = 0, first = 0; k < parts->count; first = parts->end_in_component_list[k++])
            set_subsystem_sizes(c, parts->component_list, first, parts->end_in_component_list[k]);
        if (!lower_sum(c)) memset(it->one_over_size + n - (size_t)it->first, 0, n * sizeof *it->one_over_size);
    }
    const tvi_status status = solve_for_x(c);
    memcpy(c->D_z, it->r, 2 * n * sizeof *c->D_z);
    memcpy(c->D_z + it->first, it->x + it->first, solved * sizeof *c->D_z);
    return status;
}

/* Computes J^-1 times the correction, with J = d(q-, u-)/dz. A curve is symplectic up to its truncation, J^T W J = W
 * with W = [0, 1/kappa; -1/kappa, 0] in (q, u); thus J^-1 = W^-1 J^T W. */
static void correct(tvi_corrected_curve *c, double correction[])
{
    const int n = c->curve.n, last_order = order_for_accuracy(c, PRODUCTS_REDUCTION);
    const tvi_residuals *it = c->solver_memory;
    const double *kappa = c->curve.kappa, *product = it->product;
    double *of_q = it->scratch, *of_u = of_q + n;
    for (int i = 0; i < n; i++) {
        of_q[i] = correction[n + i] / kappa[i];
        of_u[i] = -correction[i] / kappa[i];
    }
    const tvi_transposed_product ends = {NULL, 1, &c->ends[TVI_Q_START], &c->ends[TVI_U_START], of_q, of_u};
    tvi_multiply_transposed(&c->curve, last_order, &ends, it->product);
    for (int i = 0; i < n; i++) {
        correction[i] = -kappa[i] * product[n + i];
        correction[n + i] = kappa[i] * product[i];
    }
}

const tvi_end_solver tvi_solver_by_products = {allocate, begin, solve, NULL, correct};
