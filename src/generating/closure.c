/* closure.c - the linear algebra that generating functions share: solutions of equations with the transposed
 * Jacobians of the curve's ends. Where the curve has these as matrices they are factored. Where it has only products
 * with them, the equations are solved by iteration, and no matrix is formed at all. */
#include "generating/closure.h"
#include "algebra/sizes.h"

#include <float.h>
#include <math.h>
#include <string.h>

void tvi_close_take(tvi_closure *closure, tvi_arena *arena)
{
    const size_t n = (size_t)closure->n;
    tvi_iteration *it = &closure->iteration;
    closure->D = tvi_arena_doubles(arena, 2 * n);
    if (tvi_curve_has_products(&closure->curve)) {
        closure->G = tvi_arena_doubles(arena, 2 * n);
        it->x = tvi_arena_doubles(arena, 2 * n);
        it->r = tvi_arena_doubles(arena, 2 * n);
        it->s = tvi_arena_doubles(arena, TVI_MOST_ITERATIONS * 2 * n);
        it->v = tvi_arena_doubles(arena, TVI_MOST_ITERATIONS * 2 * n);
        it->scratch = tvi_arena_doubles(arena, 2 * n);
        it->size = tvi_arena_doubles(arena, n);
        return;
    }
    closure->G = tvi_arena_doubles(arena, n * 2 * n);
    tvi_factor_take(&closure->half, arena, closure->n);
    tvi_factor_take(&closure->full, arena, 2 * closure->n);
}

/* ---- By iteration ------------------------------------------------------------------------------------------------ */

/* A^T x = b, x of the combination(s): columns `half` of one Jacobian, or all of two. */
typedef struct {
    const tvi_combination *first, *second; /* second NULL: one */
    tvi_half half;
} transposed;

static int unknowns(const tvi_closure *c, const transposed *a) { return a->second ? 2 * c->n : c->n; }

/* Where the equations stand in a product with both halves. */
static int place_of(const tvi_closure *c, const transposed *a) { return a->second || a->half == TVI_FIRST ? 0 : c->n; }

static void add_seeds(tvi_closure *c, int last, const transposed *a, double factor, const double x[])
{
    tvi_curve_add_sum(&c->curve, last, a->first, factor, x);
    if (a->second) tvi_curve_add_sum(&c->curve, last, a->second, factor, x + c->n);
}

/* r = D_z - A^T x, both halves, by one product. */
static void form_remainder(tvi_closure *c, const transposed *a)
{
    const int top = c->curve.top;
    tvi_curve_clear_seeds(&c->curve, top);
    tvi_curve_add_seeds(&c->curve, top, c->seed_Q);
    if (c->iteration.has_guess) add_seeds(c, top, a, -1, c->iteration.x);
    tvi_curve_pull_seeds(&c->curve, top, c->iteration.r);
}

/* out = A^T x, both halves, as roughly as the iteration needs it. */
static void apply(tvi_closure *c, const transposed *a, const double x[], double out[])
{
    const int last = c->iteration.last;
    tvi_curve_clear_seeds(&c->curve, last);
    add_seeds(c, last, a, 1, x);
    tvi_curve_pull_seeds(&c->curve, last, out);
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
    memcpy(x, r, (size_t)c->n * sizeof *x);
    if (next != 0) tvi_curve_add_force(&c->curve, -next / (w * (l + 1) * (l + 2)), r, x); /* else there may be no K */
    for (int i = 0; i < c->n; i++) x[i] /= w;
}

/* r <- nearly A^-T r. */
static void precondition(tvi_closure *c, const transposed *a, double r[])
{
    double *x = c->iteration.scratch;
    precondition_half(c, a->first, a->second ? TVI_FIRST : a->half, r, x);
    if (a->second) precondition_half(c, a->second, TVI_SECOND, r + c->n, x + c->n);
    memcpy(r, x, (size_t)unknowns(c, a) * sizeof *r);
}

/* The iteration ends when the next correction would be below this part of the momenta: well below roundoff. */
static const double ENOUGH = DBL_EPSILON / 16;
/* Each pass forms what is left of the equations anew and exactly, and need not reduce it by more than this. */
static const double ROUGH = 1e-6;
/* Corrections this much below the solution, that shrink no more, are roundoff. */
static const double STALLED = 1e-12;

/* max_i |x_i| / size_i. */
static double measure(const tvi_closure *c, const transposed *a, const double x[])
{
    double largest = 0;
    for (int i = 0; i < unknowns(c, a); i++)
        largest = fmax(largest, tvi_ratio(fabs(x[i]), c->iteration.size[i % c->n]));
    return largest;
}

/* sum_i x_i y_i / size_i^2. */
static double product(const tvi_closure *c, const transposed *a, const double x[], const double y[])
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

/* The direction s of a step and v = A^T s, orthogonal to those before; x and r follow. */
static void minimise(tvi_closure *c, const transposed *a, int step)
{
    tvi_iteration *it = &c->iteration;
    const int count = unknowns(c, a), both = 2 * c->n, place = place_of(c, a);
    double *s = it->s + step * both, *v = it->v + step * both;
    apply(c, a, s, v);
    for (int i = 0; i < step; i++) {
        const double *v_before = it->v + i * both;
        const double part = tvi_ratio(product(c, a, v + place, v_before + place), it->square[i]);
        add(both, -part, v_before, v);
        add(count, -part, it->s + i * both, s);
    }
    it->square[step] = product(c, a, v + place, v + place);
    const double part = tvi_ratio(product(c, a, it->r + place, v + place), it->square[step]);
    add(count, part, s, it->x);
    add(both, -part, v, it->r);
}

/* Solves A^T x = D_z by generalised conjugate residuals; x of the pass before is the guess. TVI_ENOCONV where
 * corrections do not shrink. */
static tvi_status iterate(tvi_closure *c, const transposed *a)
{
    tvi_iteration *it = &c->iteration;
    const int count = unknowns(c, a);
    double before = INFINITY, goal = ENOUGH;
    form_remainder(c, a);
    if (!it->has_guess) memset(it->x, 0, (size_t)count * sizeof *it->x);
    it->last = tvi_curve_order_below(&c->curve, ROUGH / 10);
    for (int step = 0; step < TVI_MOST_ITERATIONS; step++) {
        double *s = it->s + step * 2 * c->n;
        memcpy(s, it->r + place_of(c, a), (size_t)count * sizeof *s);
        precondition(c, a, s);
        const double size = measure(c, a, s);
        if (!isfinite(size)) return TVI_ENONFINITE;
        if (step == 0) goal = fmax(ENOUGH, ROUGH * size);
        const double contraction = step > 0 ? size / before : 1;
        before = size;
        if (size * fmin(contraction, 1) <= goal || (contraction > 0.5 && size <= STALLED * measure(c, a, it->x))) {
            if (a->second) add(count, 1, s, it->x); /* nothing else of r is needed */
            else minimise(c, a, step);
            it->has_guess = true;
            return TVI_OK;
        }
        minimise(c, a, step);
    }
    return TVI_ENOCONV;
}

/* D: x where the equations stand, what is left of the gradient elsewhere. */
static tvi_status close_by_iteration(tvi_closure *c, const transposed *a)
{
    const tvi_status status = iterate(c, a);
    memcpy(c->D, c->iteration.r, 2 * (size_t)c->n * sizeof *c->D);
    memcpy(c->D + place_of(c, a), c->iteration.x, (size_t)unknowns(c, a) * sizeof *c->D);
    return status;
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
    tvi_curve_clear_seeds(&c->curve, c->iteration.last);
    tvi_curve_add_sum(&c->curve, c->iteration.last, &c->q_from, 1, of_q);
    tvi_curve_add_sum(&c->curve, c->iteration.last, &c->u_from, 1, of_u);
    tvi_curve_pull_seeds(&c->curve, c->iteration.last, c->G);
    for (int i = 0; i < n; i++) {
        correction[i] = -kappa[i] * c->G[n + i];
        correction[n + i] = kappa[i] * c->G[i];
    }
}

/* ---- By factors -------------------------------------------------------------------------------------------------- */

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

/* D_other -= J_other^T x. */
static void take_other_half(tvi_closure *closure, const tvi_combination *combination, tvi_half half)
{
    const size_t n = (size_t)closure->n, solved = half == TVI_FIRST ? 0 : n, other = n - solved;
    tvi_curve_sum_jacobian(&closure->curve, combination, closure->G);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            closure->D[other + j] -= closure->D[solved + i] * closure->G[i * 2 * n + other + j];
}

/* ---- Either ------------------------------------------------------------------------------------------------------ */

tvi_status tvi_close_half(tvi_closure *closure, const tvi_combination *combination, tvi_half half)
{
    if (tvi_curve_has_products(&closure->curve))
        return close_by_iteration(closure, &(transposed){combination, NULL, half});
    tvi_curve_pull(&closure->curve, closure->seed_Q, closure->seed_U, closure->D);
    const tvi_status status = factor_half(closure, combination, half);
    if (status != TVI_OK) return status;
    tvi_factor_solve_transposed(&closure->half, closure->D + (half == TVI_FIRST ? 0 : closure->n));
    take_other_half(closure, combination, half);
    return TVI_OK;
}

tvi_status tvi_close_full(tvi_closure *closure, const tvi_combination *first, const tvi_combination *second)
{
    if (tvi_curve_has_products(&closure->curve))
        return close_by_iteration(closure, &(transposed){first, second, TVI_FIRST});
    tvi_curve_pull(&closure->curve, closure->seed_Q, closure->seed_U, closure->D);
    const tvi_status status = factor_full(closure, first, second);
    if (status == TVI_OK) tvi_factor_solve_transposed(&closure->full, closure->D);
    return status;
}
