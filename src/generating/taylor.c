/* taylor.c - makes plain Taylor steps of adapted size, the largest that meet a tolerance; step.c offers them to the
 * integrator. The size is estimated from the last coefficients of the curve, to which the curve is then rescaled. The
 * estimate is that of Jorba and Zou (A software package for the numerical integration of ODEs by means of high-order
 * Taylor methods, Experimental Mathematics 14 (2005), section 3): the step at which the last term, of degree M, is
 * tolerance / e^5 times the state. With M = 1 - ln(tolerance) / 2 it is e^(-3/M) times their step, which is the radius
 * of convergence over e^2. They take the state as one vector, use an absolute tolerance if the state's size is below 1,
 * and use the last two coefficients. Here q and p are measured separately, each by its size or by its movement in the
 * step, so that units have no effect and a body may start at rest or at 0. */
#include "generating/step.h"

#include <math.h>

/* [1] The last term of the series is e to minus this, times the tolerance. Jorba and Zou have e to
 * minus 2; the other 3 allow for the growth of errors in tens of revolutions. */
#define STEP_SIZE_SAFETY 5.0 /* found: make adaptive */
/* [1] A step is at most this part of the radius of convergence. */
#define STEP_SIZE_MAX_PART_OF_RADIUS 0.7 /* found: make adaptive */
/* [1] A curve serves for a step if the size of the step and the tau of the curve differ by at most this factor, a power
 * of 2. */
#define STEP_SIZE_MAX_TAU_RATIO 16.0 /* found: make adaptive */
/* [expansions] At most this many curves, each with another tau, are tried for a step. */
#define STEP_SIZE_MAX_EXPANSIONS 64 /* found: make adaptive */
/* [1] For smaller tolerances generating/refine.c reduces the roundoff of a step; for larger ones errors exceed it. */
#define REFINE_MAX_TOLERANCE 1e-13 /* found: make adaptive */
/* [1] The omitted terms of a curve change the energy by at most this many times as much as the last two terms. */
#define CURVE_ENERGY_BOUND_FACTOR 8 /* found: make guard */

/* The estimate compares the last LAST nonzero coefficients of a series, of which two in a row may happen to be small,
 * with its first SIZED_BY nonzero ones, which show its size. FIRST of the first coefficients of q are found, since
 * those of p in a separable system, p_k = (k + 1) q_{k+1}, follow from them. */
enum { SIZED_BY = 2, FIRST = SIZED_BY + 1, LAST = 3 };
/* The ratios of the last coefficients show the radius of convergence. Each coefficient is compared with the one APART
 * orders before it, which has the same phase if a pair of singularities makes the coefficients swing. The radius also
 * limits the step if the state is so large that its coefficients, relative to it, would allow any step. */
enum { APART = 4 };
static const double LOG_LEAST_SIZE = -672.35; /* log TVI_LEAST_SIZE */

/* A term of a series: its order k, and log max_i |x_k| over the components i, which is -INFINITY if there is no such
 * term. */
typedef struct {
    int order;
    double log_size;
} term;

/* The first and the last terms of a series that are not 0. */
typedef struct {
    term first[FIRST], last[LAST];
} end_terms;

/* Returns max_i of the absolute values of Q_k, or of U_k, in which masses do not show. */
static double coefficient_size(const tvi_curve *curve, bool of_U, int k)
{
    double size = 0;
    for (int i = 0; i < curve->n; i++)
        size = tvi_larger(fabs(of_U ? curve_U(curve, k, i) : curve_Q(curve, k)[i]), size);
    return size;
}

/* Returns the first term that is not 0 among the orders k, k + step, ... before the order `end`. */
static term find_term(const tvi_curve *curve, bool of_U, int k, int step, int end)
{
    double size = 0;
    while (step * (end - k) > 0 && (size = coefficient_size(curve, of_U, k)) == 0) k += step;
    return (term){k, size == 0 ? -INFINITY : log(size)};
}

static void find_terms(const tvi_curve *curve, bool of_U, int degree, end_terms *terms)
{
    for (int i = 0, k = 0; i < FIRST; i++, k++) {
        terms->first[i] = find_term(curve, of_U, k, 1, degree);
        k = terms->first[i].order;
    }
    for (int i = 0, k = degree; i < LAST; i++, k--) {
        terms->last[i] = find_term(curve, of_U, k, -1, 1);
        k = terms->last[i].order;
    }
}

/* Returns the term of order q.order - 1 of the derivative of q by s, k |q_k|. If there is no term q, log_of is not
 * read, since q.order may be beyond its end. */
static term differentiate_term_by_s(const tvi_curve *curve, term q)
{
    return (term){q.order - 1, q.log_size > -INFINITY ? q.log_size + curve->log_of[q.order] : q.log_size};
}

/* Sets the terms of p of a separable system to those of the derivative of q by s. */
static void differentiate_terms_by_s(const tvi_curve *curve, const end_terms *q, end_terms *p)
{
    const int from = q->first[0].order == 0 ? 1 : 0;
    for (int i = 0; i < SIZED_BY; i++) p->first[i] = differentiate_term_by_s(curve, q->first[i + from]);
    for (int i = 0; i < LAST; i++) p->last[i] = differentiate_term_by_s(curve, q->last[i]);
}

/* Returns the logarithm of the largest s at which the term x_k is at most a fraction of the size of the series: s^k
 * |x_k| <= fraction * max_j |x_j| s^j over the first terms j, of which the sum counts as TVI_LEAST_SIZE at least: a
 * motion that has come to rest needs no digits. It has no branches, since these would be mispredicted. */
static double log_s_of_term(const tvi_curve *curve, const term first[], term x, double log_fraction)
{
    double farthest = -INFINITY;
    const double at_rest = (log_fraction + LOG_LEAST_SIZE - x.log_size) * curve->one_over[x.order];
    for (int i = 0; i < SIZED_BY; i++) {
        const int apart = x.order - first[i].order;
        const double log_s =
            apart > 0 ? (log_fraction + first[i].log_size - x.log_size) * curve->one_over[apart] : -INFINITY;
        farthest = tvi_larger(log_s, farthest);
    }
    return farthest > -INFINITY ? tvi_larger(farthest, at_rest) : INFINITY;
}

/* Returns the logarithm of the largest s at which each of the last terms is small enough. */
static double log_s_of_terms(const tvi_curve *curve, const end_terms *terms, int degree, double log_fraction)
{
    double least = INFINITY;
    for (int i = 0; i < LAST; i++) {
        const term x = terms->last[i];
        const double log_s =
            x.order > 1 ? log_s_of_term(curve, terms->first, x, log_fraction * x.order * curve->one_over[degree])
                        : INFINITY;
        least = tvi_smaller(log_s, least);
    }
    return least;
}

/* Returns max_i |Q_{k - APART}| / max_i |Q_k|. The ratio is INFINITY, which bounds no radius, if k - APART is less than
 * 2 or if one of the two is 0: the series of a polynomial, or of a function that is flat to roundoff, may begin
 * later. */
static double coefficient_ratio(const tvi_curve *curve, int k)
{
    const double last = k - APART > 1 ? coefficient_size(curve, false, k) : 0;
    const double lower = last > 0 ? coefficient_size(curve, false, k - APART) : 0;
    return lower > 0 ? lower / last : INFINITY;
}

/* Returns the largest s for which the curve, truncated to its degrees, meets the tolerance with this logarithm, but at
 * most STEP_SIZE_MAX_PART_OF_RADIUS of the radius of convergence, which follows from the second largest of the last
 * three ratios of coefficients. Returns INFINITY if the last coefficients of q and of p are 0, so that the curve is
 * exact. */
static double estimate_usable_s(const tvi_curve *curve, double log_tolerance)
{
    const int q_degree = curve->q_degree, p_degree = curve->p_degree;
    const double log_fraction = log_tolerance - STEP_SIZE_SAFETY;
    end_terms q, p;
    find_terms(curve, false, q_degree, &q);
    if (curve->system->form == TVI_SEPARABLE) differentiate_terms_by_s(curve, &q, &p);
    else find_terms(curve, true, p_degree, &p);
    const double s = exp(tvi_smaller(log_s_of_terms(curve, &q, q_degree, log_fraction),
                                     log_s_of_terms(curve, &p, p_degree, log_fraction)));
    const double part = s / STEP_SIZE_MAX_PART_OF_RADIUS, fourth = (part * part) * (part * part);
    const double first = coefficient_ratio(curve, q_degree), second = coefficient_ratio(curve, q_degree - 1),
                 smaller = tvi_smaller(first, second);
    if (smaller >= fourth) return s;
    const double third = coefficient_ratio(curve, q_degree - 2),
                 middle = tvi_larger(smaller, tvi_smaller(tvi_larger(first, second), third));
    return middle >= fourth ? s : STEP_SIZE_MAX_PART_OF_RADIUS * sqrt(sqrt(middle));
}

/* ---- The step ---------------------------------------------------------------------------------------------------- */

void tvi_taylor_allocate(tvi_curve_work *w, tvi_arena *arena)
{
    w->adapted.last_size = tvi_arena_allocate_copied(arena, sizeof(double));
    tvi_defect_allocate(&w->adapted.defect, arena, &w->c.curve);
    tvi_refine_allocate(&w->adapted.refinement, arena, &w->c.curve);
}

/* Expands the curve with a time unit tau that is a power of 2 near the usable step, or near the largest step if that is
 * less. *usable becomes the size of the step that meets the tolerance. If `guess` is near that size, one expansion is
 * enough. */
static tvi_status expand_with_suitable_tau(tvi_curve_work *w, double guess, double largest_step, double *usable)
{
    int exponent, highest;
    /* The least usable step that expansions with a too large tau have shown. A large tau shows terms that underflow
     * with a smaller one, so that the last expansion may not show them. */
    double least = INFINITY;
    tvi_status status = TVI_OK;
    (void)frexp(guess, &exponent);
    (void)frexp(largest_step, &highest);
    for (int count = 0; count < STEP_SIZE_MAX_EXPANSIONS; count++) {
        w->step.tau = copysign(ldexp(1, exponent), largest_step);
        status = tvi_step_predict(w);
        if (status == TVI_OK) status = tvi_step_expand(w, w->predictor.z);
        if (status != TVI_OK && status != TVI_ENONFINITE) return status;
        double s = 0; /* the usable step in units of tau; 0 if the coefficients overflow */
        if (status == TVI_OK) s = estimate_usable_s(&w->c.curve, w->adapted.log_tolerance);
        *usable = fmin(s * fabs(w->step.tau), least);
        s = *usable / fabs(w->step.tau);
        const bool is_tau_small = s >= 1 / STEP_SIZE_MAX_TAU_RATIO;
        if (is_tau_small && (s <= STEP_SIZE_MAX_TAU_RATIO || exponent >= highest)) return TVI_OK;
        if (s < 1 / STEP_SIZE_MAX_TAU_RATIO && s > 0) {
            highest = exponent - 1;
            least = *usable;
        }
        const int wanted = s == 0 ? -4 * ilogb(STEP_SIZE_MAX_TAU_RATIO) : isfinite(s) ? ilogb(s) : highest - exponent;
        exponent = exponent + wanted < highest ? exponent + wanted : highest;
    }
    return status == TVI_OK ? TVI_ENOCONV : status;
}

tvi_status tvi_taylor_step_to_tolerance(void *self, double tolerance, double *h, const tvi_step_origin *origin,
                                        const tvi_increments *increments, tvi_stats *stats)
{
    tvi_curve_work *w = self;
    tvi_curve *curve = &w->c.curve;
    const double before = *w->adapted.last_size;
    double usable;
    w->step.origin = origin;
    w->step.stats = stats;
    if (tolerance != w->adapted.tolerance) {
        w->adapted.tolerance = tolerance;
        w->adapted.log_tolerance = log(tolerance);
    }
    const tvi_status status = expand_with_suitable_tau(w, before != 0 ? before : *h, *h, &usable);
    if (status != TVI_OK) { /* the curve could not be expanded with this tau */
        *h = w->step.tau;
        return status;
    }
    const double largest = *h;
    if (usable < fabs(*h)) *h = copysign(usable, *h);
    tvi_step_taylor_increments(w, *h, increments);
    while (!tvi_defect_is_small(w, *h, increments) && origin->t + *h != origin->t) {
        *h /= 2;
        tvi_step_taylor_increments(w, *h, increments);
    }
    const bool is_chosen = *h != largest;
    if (is_chosen) *w->adapted.last_size = fabs(*h);
    if (is_chosen && origin->t + *h == origin->t) return TVI_ENOCONV;
    stats->tail = tvi_curve_tail(curve);
    if (tolerance < REFINE_MAX_TOLERANCE && curve->system->form != TVI_LAGRANGIAN)
        tvi_refine_increments(&w->adapted.refinement, curve, *h, origin, increments);
    return TVI_OK;
}

/* Bounds the energy change |q'| |dp| + |p'| |dq| by the omitted terms dq and dp: a multiple of the energy change by the
 * last two terms, since one of the two may be small by chance. If each term is at most three quarters of the one before
 * it, all omitted terms add up to three times the last. */
double tvi_taylor_bound_energy_change(const void *self)
{
    const tvi_curve *curve = &((const tvi_curve_work *)self)->c.curve;
    const int q_degree = curve->q_degree, p_degree = curve->p_degree;
    double sum = 0;
    if (p_degree < 2) return INFINITY;
    for (int i = 0; i < curve->n; i++) {
        const double of_q = fabs(curve_Q(curve, q_degree)[i]) + fabs(curve_Q(curve, q_degree - 1)[i]),
                     of_u = fabs(curve_U(curve, p_degree, i)) + fabs(curve_U(curve, p_degree - 1, i));
        sum += (curve->sizes.dq[i] * of_u + curve->sizes.u[i] * of_q) / fabs(curve->kappa[i]);
    }
    return CURVE_ENERGY_BOUND_FACTOR * sum / fabs(curve->tau);
}
