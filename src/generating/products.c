/* products.c - see products.h. Products with the Jacobians of a curve are had by one tangent or one adjoint sweep, and
 * equations with them are solved by generalised conjugate residuals. */
#include "generating/products.h"
#include "algebra/passes.h"
#include "algebra/sizes.h"
#include "generating/newton.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The n from which a system has products. They are cheaper from about 6 on (docs/performance.md), but stiff systems of
 * few bodies at large steps do better with matrices, which can be made anew by differences. */
enum { PRODUCTS_FROM = 8 };

tvi_jacobians tvi_curve_jacobians_for(const tvi_system *system)
{
    return system->form == TVI_SEPARABLE && system->n >= PRODUCTS_FROM ? TVI_JACOBIAN_PRODUCTS : TVI_JACOBIAN_MATRICES;
}

/* ---- Products with the Jacobians --------------------------------------------------------------------------------- */

/* dx of one lane along dz: Q_k+2 = tau^2 M^-1 dF_k / ((k+1)(k+2)). */
void tvi_products_aim(tvi_curve *curve, const double dz[])
{
    const size_t n = (size_t)curve->n, order = tvi_curve_slots(curve);
    memset(curve->dx, 0, ((size_t)curve->top + 1) * order * sizeof *curve->dx);
    memcpy(curve->dx, dz, n * sizeof *dz);
    memcpy(curve->dx + order, dz + n, n * sizeof *dz);
    for (int k = 0; k + 2 <= curve->top; k++) {
        jet_sweep_tangents(curve->system->field_series, curve->x, curve->dx, k, 1);
        const double factor = curve->tau * curve->tau / ((k + 1) * (k + 2));
        const double *force = curve->dx + (size_t)k * order;
        double *next = curve->dx + (size_t)(k + 2) * order;
        for (size_t i = 0; i < n; i++)
            next[i] = factor / curve->system->mass[i] * force[curve->system->field_series->output[i]];
    }
}

void tvi_products_push(const tvi_curve *curve, const tvi_combination *combination, double out[])
{
    const size_t n = (size_t)curve->n;
    memset(out, 0, n * sizeof *out);
    for (int k = curve->top; k >= 0; k--) {
        const double weight = combination->weight[k], *dQ = curve->dx + (size_t)k * tvi_curve_slots(curve);
        if (weight == 0) continue;
        for (size_t i = 0; i < n; i++) out[i] += weight * dQ[i];
    }
}

static double *adjoint_of_Q(const tvi_curve *curve, int k) { return curve->bar + (size_t)k * tvi_curve_slots(curve); }

static void clear_adjoints(tvi_curve *curve, int orders)
{
    memset(curve->bar, 0, (size_t)orders * tvi_curve_slots(curve) * sizeof *curve->bar);
}

void tvi_curve_clear_seeds(tvi_curve *curve, int last) { clear_adjoints(curve, last + 1); }

void tvi_curve_add_seeds(tvi_curve *curve, int last, const double seed_Q[])
{
    for (int k = 0; k <= last; k++) {
        const double *seed = seed_Q + (size_t)k * (size_t)curve->n;
        double *bar = adjoint_of_Q(curve, k);
        for (int i = 0; i < curve->n; i++) bar[i] += seed[i];
    }
}

void tvi_curve_add_sum(tvi_curve *curve, int last, const tvi_combination *combination, double factor, const double x[])
{
    for (int k = 0; k <= last; k++) {
        const double weight = factor * combination->weight[k];
        double *bar = adjoint_of_Q(curve, k);
        if (weight == 0) continue;
        for (int i = 0; i < curve->n; i++) bar[i] += weight * x[i];
    }
}

/* fbar_k = tau^2 / ((k+1)(k+2)) M^-1 qbar_{k+2}, and on to the operands: the recurrence downward. */
void tvi_curve_pull_seeds(tvi_curve *curve, int last, double out[])
{
    const tvi_system *system = curve->system;
    const size_t n = (size_t)curve->n;
    for (int k = last - 2; k >= 0; k--) {
        const double part = curve->tau / ((k + 1) * (k + 2)), *above = adjoint_of_Q(curve, k + 2);
        double *bar = adjoint_of_Q(curve, k);
        for (size_t i = 0; i < n; i++) bar[system->field_series->output[i]] += part * curve->kappa[i] * above[i];
        jet_sweep_adjoints(system->field_series, curve->x, curve->bar, k, last - 2);
    }
    memcpy(out, adjoint_of_Q(curve, 0), n * sizeof *out);
    memcpy(out + n, adjoint_of_Q(curve, 1), n * sizeof *out);
}

void tvi_products_pull(tvi_curve *curve, const double seed_Q[], double out[])
{
    tvi_curve_clear_seeds(curve, curve->top);
    tvi_curve_add_seeds(curve, curve->top, seed_Q);
    tvi_curve_pull_seeds(curve, curve->top, out);
}

void tvi_curve_add_force(tvi_curve *curve, double factor, const double x[], double out[])
{
    const jet_tape *tape = curve->system->field_series;
    clear_adjoints(curve, 1);
    for (int i = 0; i < curve->n; i++) curve->bar[tape->output[i]] += curve->tau * curve->kappa[i] * x[i];
    jet_sweep_adjoints(tape, curve->x, curve->bar, 0, 0);
    for (int i = 0; i < curve->n; i++) out[i] += factor * curve->bar[i];
}

/* ---- The equations ----------------------------------------------------------------------------------------------- */

enum { MOST_ITERATIONS = 40 };

typedef struct {
    double *x;                      /* [2n] the solution; that of the last pass is the guess of the next */
    double *r;                      /* [2n] D - A^T x, all of it */
    double *s, *v;                  /* [MOST_ITERATIONS][2n] directions, and A^T times them */
    double square[MOST_ITERATIONS]; /* of v */
    double *scratch, *product;      /* [2n] */
    double *unit;                   /* [2n] 1 / what the unknowns' errors are measured by */
    double *largest;                /* [top + 1] max_i |Q_k| */
    bool has_guess;
} iteration;

static iteration *iteration_of(const tvi_closure *c) { return c->solving; }

static void take(tvi_closure *c, tvi_arena *arena)
{
    const size_t both = 2 * (size_t)c->n;
    iteration *taken = tvi_arena_take(arena, sizeof *taken);
    const iteration it = {
        .x = tvi_arena_doubles(arena, both),
        .r = tvi_arena_doubles(arena, both),
        .s = tvi_arena_doubles(arena, MOST_ITERATIONS * both),
        .v = tvi_arena_doubles(arena, MOST_ITERATIONS * both),
        .scratch = tvi_arena_doubles(arena, both),
        .product = tvi_arena_doubles(arena, both),
        .unit = tvi_arena_doubles(arena, both),
        .largest = tvi_arena_doubles(arena, (size_t)c->curve.top + 1),
    };
    if (taken) *taken = it;
    c->solving = taken;
}

static void begin(tvi_closure *c) { iteration_of(c)->has_guess = false; }

static int unknowns(const tvi_closure *c, const tvi_transposed *a) { return a->second ? 2 * c->n : c->n; }

/* Where the equations stand in a product with both halves. */
static int place_of(const tvi_closure *c, const tvi_transposed *a)
{
    return a->second || a->half == TVI_FIRST ? 0 : c->n;
}

static void add_seeds(tvi_closure *c, int last, const tvi_transposed *a, double factor, const double x[])
{
    tvi_curve_add_sum(&c->curve, last, a->first, factor, x);
    if (a->second) tvi_curve_add_sum(&c->curve, last, a->second, factor, x + c->n);
}

/* r = D_z - A^T x, both halves, by one product. */
static void form_remainder(tvi_closure *c, const tvi_transposed *a)
{
    const int top = c->curve.top;
    tvi_curve_clear_seeds(&c->curve, top);
    tvi_curve_add_seeds(&c->curve, top, c->seed_Q);
    if (iteration_of(c)->has_guess) add_seeds(c, top, a, -1, iteration_of(c)->x);
    tvi_curve_pull_seeds(&c->curve, top, iteration_of(c)->r);
}

/* out = A^T x, both halves, as roughly as the iteration needs it. */
static void apply(tvi_closure *c, int last, const tvi_transposed *a, const double x[], double out[])
{
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
static void precondition(tvi_closure *c, const tvi_transposed *a, double r[])
{
    double *x = iteration_of(c)->scratch;
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
static double measure(const tvi_closure *c, const tvi_transposed *a, const double x[])
{
    const double *unit = iteration_of(c)->unit;
    const int count = unknowns(c, a);
    double largest = 0;
    for (int i = 0; i < count; i++) largest = tvi_larger(fabs(x[i]) * unit[i], largest);
    return largest;
}

/* sum_i x_i y_i / size_i^2. */
static double product(const tvi_closure *c, const tvi_transposed *a, const double x[], const double y[])
{
    const double *unit = iteration_of(c)->unit;
    const int count = unknowns(c, a);
    double sum = 0;
    for (int i = 0; i < count; i++) sum += x[i] * unit[i] * (y[i] * unit[i]);
    return sum;
}

static void add(int count, double factor, const double x[], double y[])
{
    for (int i = 0; i < count; i++) y[i] += factor * x[i];
}

/* The direction s of a step and v = A^T s, orthogonal to those before; x and r follow. */
static void minimise(tvi_closure *c, int last, const tvi_transposed *a, int step)
{
    iteration *it = iteration_of(c);
    const int count = unknowns(c, a), both = 2 * c->n, place = place_of(c, a);
    double *s = it->s + step * both, *v = it->v + step * both;
    apply(c, last, a, s, v);
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

/* The order of the curve to which products are made that need be right to about this part only: the first with |Q_k|
 * below a tenth of that part of |Q_0|, or top. */
static int rough_order(const tvi_closure *c, double part)
{
    const double *largest = iteration_of(c)->largest, bound = part / 10 * largest[0];
    int k = 1;
    while (k < c->curve.top && largest[k] > bound) k++;
    return k;
}

/* Solves A^T x = D_z by generalised conjugate residuals; x of the pass before is the guess. TVI_ENOCONV where
 * corrections do not shrink. */
static tvi_status iterate(tvi_closure *c, const tvi_transposed *a)
{
    iteration *it = iteration_of(c);
    const int count = unknowns(c, a);
    int last;
    double goal = ENOUGH;
    tvi_passes passes = TVI_NO_PASSES;
    form_remainder(c, a);
    if (!it->has_guess) memset(it->x, 0, (size_t)count * sizeof *it->x);
    for (int step = 0; step < MOST_ITERATIONS; step++) {
        double *s = it->s + step * 2 * c->n;
        memcpy(s, it->r + place_of(c, a), (size_t)count * sizeof *s);
        precondition(c, a, s);
        const double size = measure(c, a, s);
        if (!isfinite(size)) return TVI_ENONFINITE;
        if (step == 0) goal = fmax(ENOUGH, ROUGH * size);
        last = rough_order(c, goal < size ? goal / size : 1);
        const tvi_passes_rule rule = {.goal = goal,
                                      .memory = 1,
                                      .contraction = 0.5,
                                      .far = INFINITY,
                                      .stuck = 0.5,
                                      .roundoff = STALLED * measure(c, a, it->x)};
        if (tvi_passes_judge(&passes, &rule, size) == TVI_PASSES_MAY_END) {
            if (a->second) add(count, 1, s, it->x); /* nothing else of r is needed */
            else minimise(c, last, a, step);
            it->has_guess = true;
            return TVI_OK;
        }
        minimise(c, last, a, step);
    }
    return TVI_ENOCONV;
}

/* D: x where the equations stand, what is left of the gradient elsewhere. */
static tvi_status solve(tvi_closure *c, const tvi_transposed *a)
{
    const tvi_status status = iterate(c, a);
    memcpy(c->D, iteration_of(c)->r, 2 * (size_t)c->n * sizeof *c->D);
    memcpy(c->D + place_of(c, a), iteration_of(c)->x, (size_t)unknowns(c, a) * sizeof *c->D);
    return status;
}

/* Of a flow that is symplectic but for its truncation, J^T W J = W with W = [0, 1/kappa; -1/kappa, 0] in (q, u), hence
 * J^-1 = W^-1 J^T W. */
static void correct(tvi_closure *c, double correction[])
{
    const int n = c->n, last = rough_order(c, ROUGH);
    const double *kappa = c->curve.kappa;
    double *of_q = iteration_of(c)->scratch, *of_u = iteration_of(c)->scratch + n;
    for (int i = 0; i < n; i++) {
        of_q[i] = correction[n + i] / kappa[i];
        of_u[i] = -correction[i] / kappa[i];
    }
    tvi_curve_clear_seeds(&c->curve, last);
    tvi_curve_add_sum(&c->curve, last, &c->q_from, 1, of_q);
    tvi_curve_add_sum(&c->curve, last, &c->u_from, 1, of_u);
    tvi_curve_pull_seeds(&c->curve, last, iteration_of(c)->product);
    for (int i = 0; i < n; i++) {
        correction[i] = -kappa[i] * iteration_of(c)->product[n + i];
        correction[n + i] = kappa[i] * iteration_of(c)->product[i];
    }
}

/* ---- The corrections --------------------------------------------------------------------------------------------- */

/* The momentum that moves a body by the size of its position in the time of the step; where all is at the origin, 1. */
static double momentum_unit(const tvi_closure *c)
{
    double largest = 0;
    for (int k = 0; k <= c->curve.top; k++)
        for (int i = 0; i < c->n; i++) largest = fmax(largest, fabs(tvi_curve_Q(&c->curve, k)[i] / c->curve.kappa[i]));
    return largest > 0 ? largest : 1;
}

/* The unknowns of the closing are momenta, or u / kappa. A body whose curve has none is measured by the others, and
 * where none has any, as at rest with degree 1, by their positions. */
static tvi_status close_equations(tvi_closure *c, const double z[], const double scale[], tvi_stats *stats)
{
    const int n = c->n;
    double largest = 0, *unit = iteration_of(c)->unit;
    (void)z, (void)scale, (void)stats;
    closure_measure(c);
    for (int k = 0; k <= c->curve.top; k++)
        iteration_of(c)->largest[k] = tvi_largest(n, tvi_curve_input(&c->curve, k), 1);
    for (int i = 0; i < n; i++) largest = tvi_larger(c->p_size[i], largest);
    if (largest == 0) largest = momentum_unit(c);
    for (int i = 0; i < n; i++) {
        const double size = c->p_size[i] > 0 ? tvi_larger(c->p_size[i], TVI_LEAST_SHARE * largest) : largest;
        unit[i] = unit[n + i] = 1 / size;
    }
    return c->close(c);
}

const tvi_solver tvi_by_products = {take, begin, close_equations, solve, NULL, correct};
