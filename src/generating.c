/* generating.c - the linear algebra that generating functions share: solutions of equations with the transposed Jacobians
 * of the curve's ends. Where the curve has these as matrices they are factored. Where it has only products with them,
 * the equations are solved by iteration, and no matrix is formed at all. */
#include "generating.h"

#include <float.h>
#include <math.h>
#include <string.h>

static bool has_products(const tvi_closure *closure) { return closure->curve.jacobians == TVI_JACOBIAN_PRODUCTS; }

void tvi_close_take(tvi_closure *closure, tvi_arena *arena)
{
    const size_t n = (size_t)closure->n;
    tvi_iteration *it = &closure->iteration;
    closure->D = tvi_arena_doubles(arena, 2 * n);
    if (has_products(closure)) {
        closure->G = tvi_arena_doubles(arena, 2 * n);
        it->x = tvi_arena_doubles(arena, 2 * n);
        it->r = tvi_arena_doubles(arena, 2 * n);
        it->s = tvi_arena_doubles(arena, TVI_MOST_ITERATIONS * 2 * n);
        it->v = tvi_arena_doubles(arena, TVI_MOST_ITERATIONS * 2 * n);
        it->scratch = tvi_arena_doubles(arena, 3 * n);
        it->size = tvi_arena_doubles(arena, n);
        return;
    }
    closure->G = tvi_arena_doubles(arena, n * 2 * n);
    tvi_factor_take(&closure->half, arena, closure->n);
    tvi_factor_take(&closure->full, arena, 2 * closure->n);
}

/* ---- By iteration --------------------------------------------------------------------------------------------------- */

/* A^T x = b, x of the combination(s): columns `half` of one Jacobian, or all of two. */
typedef struct {
    const tvi_combination *first, *second; /* second NULL: one */
    tvi_half half;
} operator;

static int unknowns(const tvi_closure *c, const operator *a) { return a->second ? 2 * c->n : c->n; }

/* out[2n] = A^T x, both halves. */
static void apply(tvi_closure *c, const operator *a, const double x[], double out[])
{
    tvi_curve_pull_sums(&c->curve, a->first, x, a->second, a->second ? x + c->n : NULL, out);
}

/* The part of a product that the equations speak of. */
static const double *part_of(const tvi_closure *c, const operator *a, const double product[])
{
    return a->second || a->half == TVI_FIRST ? product : product + c->n;
}

/* The weight of the centre datum that leads: Q_0 or Q_1. */
static double lead(const tvi_combination *combination, tvi_half half)
{
    return combination->weight[half == TVI_FIRST ? 0 : 1];
}

/* x = (2 P - P A0 P) r for one combination and half: the inverse to first order in K, where
 *     A0 = w_l + w_{l+2} K^T l! / (l+2)!,   P = 1 / w_l,   l = 0 or 1,
 * is what a force linear in q with the Jacobian of the centre makes of the curve. */
static void precondition_half(tvi_closure *c, const tvi_combination *combination, tvi_half half, const double r[],
                              double x[])
{
    const int l = half == TVI_FIRST ? 0 : 1;
    const double w = lead(combination, half), next = l + 2 <= c->curve.top ? combination->weight[l + 2] : 0;
    double *Kr = c->iteration.scratch;
    tvi_curve_pull_force(&c->curve, r, Kr);
    for (int i = 0; i < c->n; i++) x[i] = (r[i] - next / (w * (l + 1) * (l + 2)) * Kr[i]) / w;
}

/* r <- nearly A^-T r. */
static void precondition(tvi_closure *c, const operator *a, double r[])
{
    double *x = c->iteration.scratch + c->n;
    precondition_half(c, a->first, a->second ? TVI_FIRST : a->half, r, x);
    if (a->second) precondition_half(c, a->second, TVI_SECOND, r + c->n, x + c->n);
    memcpy(r, x, (size_t)unknowns(c, a) * sizeof *r);
}

/* The iteration ends when the next correction would be below this part of the momenta: well below roundoff. */
static const double ENOUGH = DBL_EPSILON / 16;
/* Corrections this much below the solution, that shrink no more, are roundoff. */
static const double STALLED = 1e-12;

static double ratio(double part, double whole) { return part == 0 ? 0 : part / whole; }

/* max_i |x_i| / size_i. */
static double measure(const tvi_closure *c, const operator *a, const double x[])
{
    double largest = 0;
    for (int i = 0; i < unknowns(c, a); i++) largest = fmax(largest, ratio(fabs(x[i]), c->iteration.size[i % c->n]));
    return largest;
}

/* sum_i x_i y_i / size_i^2. */
static double product(const tvi_closure *c, const operator *a, const double x[], const double y[])
{
    double sum = 0;
    for (int i = 0; i < unknowns(c, a); i++) {
        const double size = c->iteration.size[i % c->n];
        if (size > 0) sum += x[i] / size * (y[i] / size);
    }
    return sum;
}

static void add(int count, double factor, const double x[], double y[])
{
    for (int i = 0; i < count; i++) y[i] += factor * x[i];
}

/* Direction s = P r of step `step`, and v = A^T s, orthogonal to those before; x and r follow. */
static void minimise(tvi_closure *c, const operator *a, int step)
{
    tvi_iteration *it = &c->iteration;
    const int count = unknowns(c, a);
    double *s = it->s + (size_t)step * 2 * (size_t)c->n, *v = it->v + (size_t)step * 2 * (size_t)c->n;
    apply(c, a, s, c->G);
    memcpy(v, part_of(c, a, c->G), (size_t)count * sizeof *v);
    for (int i = 0; i < step; i++) {
        const double *s_before = it->s + (size_t)i * 2 * (size_t)c->n, *v_before = it->v + (size_t)i * 2 * (size_t)c->n;
        const double part = ratio(product(c, a, v, v_before), it->square[i]);
        add(count, -part, v_before, v);
        add(count, -part, s_before, s);
    }
    it->square[step] = product(c, a, v, v);
    const double part = ratio(product(c, a, it->r, v), it->square[step]);
    add(count, part, s, it->x);
    add(count, -part, v, it->r);
}

/* Solves A^T x = b in place by generalised conjugate residuals; x of the pass before is the guess. TVI_ENOCONV where
 * corrections do not shrink. */
static tvi_status iterate(tvi_closure *c, const operator *a, double b[])
{
    tvi_iteration *it = &c->iteration;
    const int count = unknowns(c, a);
    const size_t bytes = (size_t)count * sizeof *b;
    double before = INFINITY;
    memcpy(it->r, b, bytes);
    if (it->has_guess) {
        apply(c, a, it->x, c->G);
        add(count, -1, part_of(c, a, c->G), it->r);
    } else {
        memset(it->x, 0, bytes);
        it->slowest = 0;
    }
    for (int step = 0; step < TVI_MOST_ITERATIONS; step++) {
        double *s = it->s + (size_t)step * 2 * (size_t)c->n;
        memcpy(s, it->r, bytes);
        precondition(c, a, s);
        const double size = measure(c, a, s);
        if (!isfinite(size)) return TVI_ENONFINITE;
        const double contraction = size / before;
        if (step > 0) it->slowest = fmax(it->slowest, contraction);
        before = size;
        if (size * (it->slowest > 0 ? fmin(it->slowest, 1) : 1) <= ENOUGH ||
            (contraction > 0.5 && size <= STALLED * measure(c, a, it->x))) {
            add(count, 1, s, it->x);
            it->has_guess = true;
            memcpy(b, it->x, bytes);
            return TVI_OK;
        }
        minimise(c, a, step);
    }
    return TVI_ENOCONV;
}

/* Of a flow that is symplectic but for its truncation, J^T W J = W with W = [0, 1/kappa; -1/kappa, 0] in (q, u), hence
 * J^-1 = W^-1 J^T W. */
void tvi_close_correct(tvi_closure *c, double correction[])
{
    const int n = c->n;
    const double *kappa = c->curve.kappa;
    double *of_q = c->iteration.scratch, *of_u = c->iteration.scratch + n;
    for (int i = 0; i < n; i++) {
        of_q[i] = correction[n + i] / kappa[i];
        of_u[i] = -correction[i] / kappa[i];
    }
    tvi_curve_pull_sums(&c->curve, &c->q_from, of_q, &c->u_from, of_u, c->G);
    for (int i = 0; i < n; i++) {
        correction[i] = -kappa[i] * c->G[n + i];
        correction[n + i] = kappa[i] * c->G[i];
    }
}

/* ---- By factors ------------------------------------------------------------------------------------------------------ */

static tvi_status factor_half(tvi_closure *closure, const tvi_combination *combination, tvi_half half)
{
    const size_t n = (size_t)closure->n;
    if (!closure->is_fresh) return TVI_OK;
    tvi_curve_sum_jacobian(&closure->curve, combination, closure->G);
    for (size_t i = 0; i < n; i++)
        memcpy(closure->half.lu + i * n, closure->G + i * 2 * n + (half == TVI_FIRST ? 0 : n), n * sizeof(double));
    return tvi_factor_compute(&closure->half);
}

static tvi_status factor_full(tvi_closure *closure, const tvi_combination *first, const tvi_combination *second)
{
    const size_t n = (size_t)closure->n;
    if (!closure->is_fresh) return TVI_OK;
    tvi_curve_sum_jacobian(&closure->curve, first, closure->full.lu);
    tvi_curve_sum_jacobian(&closure->curve, second, closure->full.lu + 2 * n * n);
    return tvi_factor_compute(&closure->full);
}

/* ---- Either ---------------------------------------------------------------------------------------------------------- */

tvi_status tvi_close_solve(tvi_closure *closure, const tvi_combination *combination, tvi_half half, double b[])
{
    if (has_products(closure)) return iterate(closure, &(operator){combination, NULL, half}, b);
    const tvi_status status = factor_half(closure, combination, half);
    if (status == TVI_OK) tvi_factor_solve_transposed(&closure->half, b);
    return status;
}

tvi_status tvi_close_solve_full(tvi_closure *closure, const tvi_combination *first, const tvi_combination *second)
{
    if (has_products(closure)) return iterate(closure, &(operator){first, second, TVI_FIRST}, closure->D);
    const tvi_status status = factor_full(closure, first, second);
    if (status == TVI_OK) tvi_factor_solve_transposed(&closure->full, closure->D);
    return status;
}

void tvi_close_add(tvi_closure *closure, const tvi_combination *combination, tvi_half half, double factor,
                   const double x[], double out[])
{
    const size_t n = (size_t)closure->n;
    if (has_products(closure)) {
        apply(closure, &(operator){combination, NULL, half}, x, closure->G);
        for (size_t j = 0; j < n; j++) out[j] += factor * closure->G[(half == TVI_FIRST ? 0 : n) + j];
        return;
    }
    tvi_curve_sum_jacobian(&closure->curve, combination, closure->G);
    for (size_t i = 0; i < n; i++) {
        const double *row = closure->G + i * 2 * n + (half == TVI_FIRST ? 0 : n);
        for (size_t j = 0; j < n; j++) out[j] += factor * x[i] * row[j];
    }
}
