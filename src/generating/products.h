/* products.h - solves equations by products with Jacobians, for separable systems of many coordinates. No Jacobian of
 * the curve is formed. One tangent or one adjoint sweep computes a product with a Jacobian, and generalised conjugate
 * residuals solve the equations (docs/method.md sections 2 and 5). This file is part of the text of generated code
 * (emit.c), where every size is a constant. */
#ifndef TVI_SRC_GENERATING_PRODUCTS_H
#define TVI_SRC_GENERATING_PRODUCTS_H

#include "generating/closure.h"
#include "generating/newton.h"

/* ---- Products with the Jacobians --------------------------------------------------------------------------------- */

#define PRODUCTS_AIM(V, S) JET_AT(V, next, 0) = factor * JET_OF(V, kappa, 0) * JET_GATHER(V, force, slot + here);

/* Computes dx of one lane along dz: dQ_{k+2} = tau^2 M^-1 dF_k / ((k+1)(k+2)). Inputs other than coordinates, such as
 * the time, have no tangents: their rows stay 0. */
static inline void products_aim(tvi_curve *curve, const double dz[])
{
    enum { stride = 0 };
    const size_t n = (size_t)curve_n(curve), order = tvi_curve_slots(curve);
    const double *kappa = curve->kappa;
    const int *slot = curve_output(curve);
    memcpy(curve->dx, dz, n * sizeof *dz);
    memcpy(curve->dx + order, dz + n, n * sizeof *dz);
    for (int k = 0; k + 2 <= curve_top(curve); k++) {
        PRODUCTS_TANGENTS(curve->system->field_series, curve->x, curve->dx, k, 1);
        const double factor = curve->tau / ((k + 1) * (k + 2)), *force = curve->dx + (size_t)k * order;
        double *next = curve->dx + (size_t)(k + 2) * order;
        JET_BLOCKS((int)n, PRODUCTS_AIM, );
    }
}

/* Computes the product of a combination's Jacobian and the direction of the last products_aim. */
static inline void products_push(const tvi_curve *curve, const tvi_combination *combination, double out[])
{
    const size_t n = (size_t)curve_n(curve);
    memset(out, 0, n * sizeof *out);
    tvi_add_weighted_rows((size_t)curve_top(curve) + 1, combination->weight, tvi_curve_slots(curve), n, curve->dx, out);
}

static inline double *products_adjoint_of_Q(const tvi_curve *curve, int k)
{
    return curve->bar + (size_t)k * tvi_curve_slots(curve);
}

/* These are the terms of a transposed product: seeds [top + 1][n], and factor times the transposed Jacobians of
 * combinations times x and y [n]. Seeds or combinations that are NULL are left out. */
typedef struct {
    const double *seed_Q;
    double factor;
    const tvi_combination *of_x, *of_y;
    const double *x, *y;
} tvi_pulled;

#define PRODUCTS_SEED(V, S)                                                                                            \
    {                                                                                                                  \
        V sum = {0};                                                                                                   \
        if (terms->seed_Q) sum += JET_OF(V, terms->seed_Q + k * n, 0);                                                 \
        if (terms->of_x) sum += terms->factor * terms->of_x->weight[k] * JET_OF(V, terms->x, 0);                       \
        if (terms->of_y) sum += terms->factor * terms->of_y->weight[k] * JET_OF(V, terms->y, 0);                       \
        JET_AT(V, bar, 0) = sum;                                                                                       \
    }

/* Sets the adjoints of Q_k that the product begins with, and 0 elsewhere: operations of one order may add to those of
 * all lower orders. The last two orders do not need the field. */
static inline void products_seed(tvi_curve *curve, int last, const tvi_pulled *terms)
{
    enum { stride = 0 };
    const int n = curve_n(curve);
    for (int k = 0; k <= last; k++) {
        double *bar = products_adjoint_of_Q(curve, k);
        JET_BLOCKS(n, PRODUCTS_SEED, );
        if (k + 2 <= last) PRODUCTS_CLEAR(curve, bar);
    }
}

#define PRODUCTS_HAND_ON(V, S)                                                                                         \
    if (JET_IN_A_ROW(V, slot + here)) {                                                                                \
        *(V *)(bar + slot[here]) += part * JET_OF(V, kappa, 0) * JET_OF(V, above, 0);                                  \
    } else {                                                                                                           \
        for (int i = here; i < here + (int)(sizeof(V) / sizeof(double)); i++)                                          \
            bar[slot[i]] += part * kappa[i] * above[i];                                                                \
    }

/* Computes out[2n] by the recurrence downward: fbar_k = tau^2 / ((k+1)(k+2)) M^-1 qbar_{k+2}, then the adjoints of the
 * operands. Only orders up to `last` of the curve count, 1 <= last <= top: a rough product costs O(last^2). */
static inline void products_pull(tvi_curve *curve, int last, const tvi_pulled *terms, double out[])
{
    enum { stride = 0 };
    products_seed(curve, last, terms);
    const size_t n = (size_t)curve_n(curve);
    const double *kappa = curve->kappa;
    const int *slot = curve_output(curve);
    for (int k = last - 2; k >= 0; k--) {
        const double part = curve->tau / ((k + 1) * (k + 2)), *above = products_adjoint_of_Q(curve, k + 2);
        double *bar = products_adjoint_of_Q(curve, k);
        JET_BLOCKS((int)n, PRODUCTS_HAND_ON, );
        PRODUCTS_ADJOINTS(curve->system->field_series, curve->x, curve->bar, k, last - 2);
    }
    memcpy(out, products_adjoint_of_Q(curve, 0), n * sizeof *out);
    memcpy(out + n, products_adjoint_of_Q(curve, 1), n * sizeof *out);
}

/* ---- The equations ----------------------------------------------------------------------------------------------- */

/* This iteration solves A^T x = D_z. Arrays of all 2n rows have room for whole vectors, and are 0 there and in rows
 * that are not solved for: if `unit` is 0, the row does not count. */
enum { PRODUCTS_MOST = 40, PRODUCTS_VECTOR = 8 };
typedef struct {
    double *x;                    /* the solution; that of the last pass is the guess of the next */
    double *r;                    /* D - A^T x, all of it */
    double *s, *v;                /* [PRODUCTS_MOST] directions, and A^T times them */
    double square[PRODUCTS_MOST]; /* the square of each v */
    double *unit;                 /* 1 / what the unknowns' errors are measured by */
    double *scratch, *product;    /* [2n] */
    double *largest;              /* [top + 1] max_i |Q_k| */
    bool has_guess;
} tvi_iteration;

static inline tvi_iteration *products_of(const tvi_closure *c) { return c->solving; }

static inline int products_width(const tvi_closure *c)
{
    return (2 * curve_n(&c->curve) + PRODUCTS_VECTOR - 1) / PRODUCTS_VECTOR * PRODUCTS_VECTOR;
}

static inline void products_begin(tvi_closure *c) { products_of(c)->has_guess = false; }

/* Returns the number of rows that are solved for. */
static inline int products_unknowns(const tvi_closure *c, const tvi_transposed *a)
{
    return a->second ? 2 * curve_n(&c->curve) : curve_n(&c->curve);
}

static inline int products_place(const tvi_closure *c, const tvi_transposed *a)
{
    return a->second || a->half == TVI_FIRST ? 0 : curve_n(&c->curve);
}

/* Returns the terms of a product that the equations have. */
static inline tvi_pulled products_pull_unknown(const tvi_closure *c, const tvi_transposed *a, double factor,
                                               const double x[])
{
    return (tvi_pulled){.factor = factor,
                        .of_x = a->first,
                        .of_y = a->second,
                        .x = x + products_place(c, a),
                        .y = x + curve_n(&c->curve)};
}

/* Computes r = D_z - A^T x, both halves, by one product. */
static inline void products_form_remainder(tvi_closure *c, const tvi_transposed *a)
{
    const tvi_iteration *it = products_of(c);
    tvi_pulled left = products_pull_unknown(c, a, -1, it->x);
    left.seed_Q = c->seed_Q;
    products_pull(&c->curve, curve_top(&c->curve), &left, it->r);
}

/* Computes out = A^T x, both halves, as roughly as the iteration needs it. */
static inline void products_apply(tvi_closure *c, int last, const tvi_transposed *a, const double x[], double out[])
{
    const tvi_pulled product = products_pull_unknown(c, a, 1, x);
    products_pull(&c->curve, last, &product, out);
}

/* Computes x = P r from the weights of Q_0 and of Q_1, which lead in their halves. */
static inline void products_divide(const tvi_closure *c, const tvi_transposed *a, const double r[], double x[])
{
    const int n = curve_n(&c->curve), place = products_place(c, a);
    const double first = 1 / a->first->weight[place > 0], second = a->second ? 1 / a->second->weight[1] : 0;
    for (int i = 0; i < n; i++) x[place + i] = first * r[place + i];
    if (second == 0) return;
    for (int i = 0; i < n; i++) x[n + i] = second * r[n + i];
}

/* Computes s = (2 P - P A^T P) r, nearly A^-T r, from the first orders alone: those of a force linear in q whose
 * Jacobian is linear in the time. */
enum { PRODUCTS_NEAR = 3 };
static inline void products_precondition(tvi_closure *c, const tvi_transposed *a, const double r[], double s[])
{
    double *twice = products_of(c)->scratch, *v = products_of(c)->product;
    memset(s, 0, (size_t)products_width(c) * sizeof *s);
    products_divide(c, a, r, s);
    products_apply(c, curve_top(&c->curve) < PRODUCTS_NEAR ? curve_top(&c->curve) : PRODUCTS_NEAR, a, s, v);
    for (int i = 0; i < 2 * curve_n(&c->curve); i++) twice[i] = 2 * r[i] - v[i];
    products_divide(c, a, twice, s);
}

/* The iteration ends when the next correction would be below this part of the momenta: well below roundoff. */
static const double PRODUCTS_ENOUGH = DBL_EPSILON / 16;
/* Each pass forms what is left of the equations anew and exactly, and need not reduce it by more than this. */
static const double PRODUCTS_ROUGH = 1e-6;
/* Corrections that no longer shrink are roundoff if they are this much below the solution. */
static const double PRODUCTS_STALLED = 1e-12;

/* Returns max_i |x_i| / size_i. */
static inline double products_measure(const tvi_closure *c, const double x[])
{
    const double *unit = products_of(c)->unit;
    double most[PRODUCTS_VECTOR] = {0};
    for (int here = 0; here < products_width(c); here += PRODUCTS_VECTOR)
        for (int lane = 0; lane < PRODUCTS_VECTOR; lane++)
            most[lane] = tvi_larger(fabs(x[here + lane]) * unit[here + lane], most[lane]);
    return tvi_largest_magnitude(PRODUCTS_VECTOR, most, 1);
}

/* Returns sum_i x_i y_i / size_i^2. */
static inline double products_product(const tvi_closure *c, const double x[], const double y[])
{
    const double *unit = products_of(c)->unit;
    double sum[PRODUCTS_VECTOR] = {0};
    for (int here = 0; here < products_width(c); here += PRODUCTS_VECTOR)
        for (int lane = 0; lane < PRODUCTS_VECTOR; lane++)
            sum[lane] += x[here + lane] * unit[here + lane] * (y[here + lane] * unit[here + lane]);
    return ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
}

static inline void products_add(const tvi_closure *c, double factor, const double x[], double *restrict y)
{
    for (int i = 0; i < products_width(c); i++) y[i] += factor * x[i];
}

/* Makes the direction s of a step and v = A^T s orthogonal to those before, and updates x and r. */
static inline void products_minimise(tvi_closure *c, int last, const tvi_transposed *a, int step)
{
    tvi_iteration *it = products_of(c);
    double *s = it->s + step * products_width(c), *v = it->v + step * products_width(c);
    products_apply(c, last, a, s, v);
    for (int i = 0; i < step; i++) {
        const double *v_before = it->v + i * products_width(c);
        const double part = tvi_ratio_or_zero(products_product(c, v, v_before), it->square[i]);
        products_add(c, -part, v_before, v);
        products_add(c, -part, it->s + i * products_width(c), s);
    }
    it->square[step] = products_product(c, v, v);
    const double part = tvi_ratio_or_zero(products_product(c, it->r, v), it->square[step]);
    products_add(c, part, s, it->x);
    products_add(c, -part, v, it->r);
}

/* Returns the order of the curve up to which a product is summed that need be right to about this part only: the first
 * order from which on |Q_k| is below a tenth of that part of |Q_0|, or top. */
static inline int products_rough_order(const tvi_closure *c, double part)
{
    const double *largest = products_of(c)->largest, bound = part / 10 * largest[0];
    int k = curve_top(&c->curve);
    while (k > 1 && !(largest[k - 1] > bound)) k--;
    return k;
}

/* Solves A^T x = D_z by generalised conjugate residuals, from the guess x of the pass before. Returns TVI_ENOCONV if
 * corrections do not shrink. */
static inline tvi_status products_iterate(tvi_closure *c, const tvi_transposed *a)
{
    tvi_iteration *it = products_of(c);
    double goal = PRODUCTS_ENOUGH;
    tvi_passes passes;
    tvi_passes_begin(&passes, 0);
    if (!it->has_guess) memset(it->x, 0, (size_t)products_width(c) * sizeof *it->x);
    products_form_remainder(c, a);
    for (int step = 0; step < PRODUCTS_MOST; step++) {
        double *s = it->s + step * products_width(c);
        products_precondition(c, a, it->r, s);
        const double size = products_measure(c, s);
        if (!isfinite(size)) return TVI_ENONFINITE;
        if (step == 0) goal = tvi_larger(PRODUCTS_ENOUGH, PRODUCTS_ROUGH * size);
        const tvi_passes_rule rule = {
            .correction_goal = goal, .max_contraction = 0.5, .stall_ratio = 0.5, .stall_period = 1};
        const tvi_passes_verdict verdict = tvi_passes_add_and_judge(&passes, &rule, size);
        const bool may_end = verdict == TVI_PASSES_MAY_END ||
                             (verdict == TVI_PASSES_STUCK && size <= PRODUCTS_STALLED * products_measure(c, it->x));
        if (may_end && a->second) products_add(c, 1, s, it->x); /* nothing else of r is needed */
        else products_minimise(c, products_rough_order(c, goal < size ? goal / size : 1), a, step);
        it->has_guess = may_end;
        if (may_end) return TVI_OK;
    }
    return TVI_ENOCONV;
}

/* Replaces D by x where the equations stand, and elsewhere by what is left of the gradient. */
static inline tvi_status products_solve(tvi_closure *c, const tvi_transposed *a)
{
    const tvi_iteration *it = products_of(c);
    const int n = curve_n(&c->curve), place = products_place(c, a);
    if (!a->second) memset(it->unit + n - place, 0, (size_t)n * sizeof *it->unit);
    const tvi_status status = products_iterate(c, a);
    memcpy(c->D, it->r, 2 * (size_t)n * sizeof *c->D);
    memcpy(c->D + place, it->x + place, (size_t)products_unknowns(c, a) * sizeof *c->D);
    return status;
}

/* If a flow is symplectic except for its truncation, J^T W J = W with W = [0, 1/kappa; -1/kappa, 0] in (q, u). This
 * computes J^-1 = W^-1 J^T W times the correction. */
static inline void products_correct(tvi_closure *c, double correction[])
{
    const int n = curve_n(&c->curve), last = products_rough_order(c, PRODUCTS_ROUGH);
    const double *kappa = c->curve.kappa, *product = products_of(c)->product;
    double *of_q = products_of(c)->scratch, *of_u = of_q + n;
    for (int i = 0; i < n; i++) {
        of_q[i] = correction[n + i] / kappa[i];
        of_u[i] = -correction[i] / kappa[i];
    }
    const tvi_pulled ends = {.factor = 1, .of_x = &c->q_from, .of_y = &c->u_from, .x = of_q, .y = of_u};
    products_pull(&c->curve, last, &ends, products_of(c)->product);
    for (int i = 0; i < n; i++) {
        correction[i] = -kappa[i] * product[n + i];
        correction[n + i] = kappa[i] * product[i];
    }
}

/* ---- The corrections --------------------------------------------------------------------------------------------- */

/* Sets the units of the unknowns of a subsystem; member: its components. The unknowns of the closing are momenta, or u
 * / kappa. An unknown that is much smaller than others, as displacements are, is measured by the others; so is a body
 * whose curve has no momentum. If no body has one, as at rest with degree 1, the positions measure them; if all
 * positions are 0, the unit is 1. */
static inline void products_set_units_of(const tvi_closure *c, const int *member, int first, int end)
{
    const int n = curve_n(&c->curve);
    const double *kappa = c->curve.kappa;
    double largest = 0, place = 0, *unit = products_of(c)->unit;
    for (int k = first; k < end; k++) largest = tvi_larger(fabs(kappa[member[k]]) * c->p_size[member[k]], largest);
    for (int order = 0; order <= curve_top(&c->curve) && largest == 0; order++)
        for (int k = first; k < end; k++) place = tvi_larger(fabs(tvi_curve_Q(&c->curve, order)[member[k]]), place);
    const double least = largest > 0 ? TVI_LEAST_SHARE * largest : place, none = largest > 0 ? largest : place;
    for (int k = first; k < end; k++) {
        const int i = member[k];
        const double per = none > 0 ? 1 / fabs(kappa[i]) : 1, size = c->p_size[i];
        unit[i] = unit[n + i] = 1 / (size > 0 ? tvi_larger(size, least * per) : none > 0 ? none * per : 1);
    }
}

static inline void products_set_units(tvi_closure *c)
{
    const tvi_subsystems *parts = &c->curve.system->parts;
    closure_set_p_size(c);
    for (int k = 0; k <= curve_top(&c->curve); k++)
        products_of(c)->largest[k] = tvi_largest_magnitude(curve_n(&c->curve), tvi_curve_input(&c->curve, k), 1);
    for (int k = 0, first = 0; k < parts->count; first = parts->end[k++])
        products_set_units_of(c, parts->component, first, parts->end[k]);
}

/* Computes the corrections; the units are those of the first pass. */
static inline tvi_status products_close(tvi_closure *c, const double z[], const double scale[], tvi_stats *stats)
{
    (void)z, (void)scale, (void)stats;
    if (!products_of(c)->has_guess) products_set_units(c);
    return c->close(c);
}

#endif
