/* passes.h - Decides when the passes of an iteration may end (docs/method.md, section 5). A pass evaluates the
 * residual and corrects the unknowns. Newton's method, the Galerkin passes, the Legendre transforms and the
 * iterations inside a step use this rule with different numbers. */
#ifndef TVI_SRC_ALGEBRA_PASSES_H
#define TVI_SRC_ALGEBRA_PASSES_H

#include "algebra/sizes.h"

#include <float.h>
#include <stdbool.h>

/* [1] If a correction is at least this part of the one before, the next one is expected to be as large. Newton's method
 * trusts any decrease of corrections, but allows for a slower one (NEWTON_MAX_RATIO_GROWTH). */
#define PASSES_MAX_CONTRACTION 0.5 /* found: make check-generating */
/* [1] Newton's method, and generalised conjugate residuals, are stuck if a correction is more than this part of the one
 * before. */
#define PASSES_STALL_RATIO 0.5 /* found: make check-generating */
/* [1] Corrections that no longer shrink are roundoff if they are at most this many times the estimated roundoff. Near
 * equilibria (suite equilibria of build/check/stability) one in a hundred was larger, which costs a pass or a Jacobian.
 * A correction below the limit does no harm even if it is not roundoff. */
#define ROUNDOFF_MAX_UNITS 32.0 /* found: make check-stability */

/* The stall ratio of a rule whose passes are stuck only if the correction does not shrink at all. */
#define TVI_STALL_WITHOUT_DECREASE (1 - DBL_EPSILON)

/* The rule by which the passes of an iteration end, from the sizes of their corrections. The iteration measures these
 * sizes, absolutely or relative to its unknowns. The ratio of a correction is its size over that of the correction
 * before it. A member that is 0 switches its part of the rule off. */
typedef struct {
    /* The largest number of passes, and the exact number of passes if the user asked for one. */
    int max_passes, exact_passes;
    double correction_goal; /* Passes end if the next correction is expected to be at most this. */
    /* Corrections up to this size may be roundoff, and do not show how fast the passes converge. */
    double roundoff_level;
    /* If the ratio of corrections is at least this, it is not trusted: the next correction is expected to be as large
     * as the last one. */
    double max_trusted_ratio;
    /* The passes are stuck, that is, their corrections no longer shrink, if the ratio of corrections is above this. */
    double stall_ratio;
    /* The number of earlier corrections with which a correction is compared, to tell whether the passes are stuck: 1,
     * or 2 if small and large corrections may alternate. With 2, the passes are stuck only if the correction also
     * exceeds stall_ratio^2 times the correction two passes before. */
    int stall_comparison_lag;
    /* The next ratio is expected to be the square of the last one, as in Newton's method. */
    bool is_convergence_quadratic;
} tvi_stopping_rule;

/* The outcome of a pass of an iteration. */
typedef enum {
    TVI_PASSES_GO_ON,
    TVI_PASSES_MAY_END, /* The next correction is expected to reach the goal, or the last one is roundoff. */
    TVI_PASSES_STUCK    /* The passes are at roundoff, or they do not converge; the caller measures the roundoff. */
} tvi_passes_verdict;

/* The sizes of the corrections so far. */
typedef struct {
    int count;
    /* The sizes of the last three corrections. A pass moves each size to the next field. */
    double size, previous_size, size_two_passes_before;
    /* A correction above the roundoff level is significant. `ratio` is the ratio of the last significant correction
     * to the one before it. `slowest_ratio` is the larger one of the last two such ratios; at first it is the ratio
     * of an earlier iteration, or 0 if that is unknown. */
    double ratio, slowest_ratio;
    /* The size of the last correction; if roundoff hides it, an estimate of the size without roundoff. */
    double size_without_roundoff;
    double expected_next_size; /* The size that the next correction is expected to have. */
    /* The factor by which `ratio` may grow from this pass to the next. expected_next_size contains this factor. It is
     * more than 1 only for Newton's method (generating/newton.h). */
    double ratio_growth;
    double roundoff; /* Corrections up to this size are measured to be roundoff; 0: nothing was measured. */
} tvi_convergence_test;

/* Adds a pass whose correction has this size. Returns true if the pass may be the last one. *is_stalled tells whether
 * the corrections no longer shrink, and counts only if the pass may not be the last one.
 *
 * The ratio of a correction is its size over that of the correction before it. If the correction before was larger than
 * 1, the ratio is the size over 1, since such a correction shows the size of the unknowns rather than the convergence.
 * Corrections at the roundoff level do not show how fast the passes converge. They are assumed to converge like the
 * significant ones, and their growth does not make the passes stuck. After a single correction the rate is unknown. If
 * three corrections at the roundoff level have the same size, the unknowns alternate between values that differ in
 * their last bits, and the pass may be the last one. */
static inline bool tvi_convergence_add_correction(tvi_convergence_test *test, const tvi_stopping_rule *rule,
                                                  double correction_size, bool *is_stalled)
{
    const double before = test->size, earlier = test->previous_size;
    const int count = ++test->count;
    const bool is_significant = correction_size > rule->roundoff_level;
    if (count > 1 && rule->exact_passes == 0) {
        const double ratio = correction_size / tvi_smaller(before, 1),
                     slower = rule->is_convergence_quadratic ? ratio * ratio : tvi_larger(ratio, test->ratio);
        test->ratio = is_significant ? ratio : test->ratio;
        test->slowest_ratio = is_significant ? slower : test->slowest_ratio;
    }
    const double slowest_ratio = test->slowest_ratio;
    const bool is_ratio_trusted = slowest_ratio > 0 && rule->max_trusted_ratio > slowest_ratio;
    const double expected_ratio = is_ratio_trusted ? slowest_ratio : 1,
                 expected_size = expected_ratio * test->size_without_roundoff;
    const double without_roundoff = is_significant ? correction_size : tvi_smaller(correction_size, expected_size),
                 expected_next_size = test->ratio_growth * expected_ratio * without_roundoff;
    test->size_two_passes_before = earlier;
    test->previous_size = before;
    test->size = correction_size;
    test->size_without_roundoff = without_roundoff;
    test->expected_next_size = count > 1 || !is_significant ? expected_next_size : correction_size;
    *is_stalled = false;
    if (rule->exact_passes > 0) return count == rule->exact_passes;
    if (count > rule->stall_comparison_lag) {
        const double least = rule->stall_ratio * before, least_of_two = rule->stall_ratio * rule->stall_ratio * earlier;
        const bool grows = correction_size > (rule->stall_comparison_lag > 1 ? tvi_larger(least, least_of_two) : least);
        *is_stalled = grows && (is_significant || !is_ratio_trusted);
    }
    const bool is_cycle = !is_significant && tvi_larger(before, earlier) <= correction_size &&
                          correction_size <= tvi_smaller(before, earlier);
    return test->expected_next_size <= rule->correction_goal || correction_size <= test->roundoff || is_cycle;
}

/* Begins an iteration. `earlier_slowest_ratio` is the slowest ratio of successive corrections in an earlier iteration,
 * or 0 if it is unknown. The fields are set one by one, since compilers would clear the structure by an instruction
 * that starts slowly. */
static inline void tvi_convergence_begin(tvi_convergence_test *test, double earlier_slowest_ratio)
{
    test->count = 0;
    test->size = test->previous_size = test->size_two_passes_before = INFINITY;
    test->ratio = test->expected_next_size = test->roundoff = 0;
    test->size_without_roundoff = INFINITY;
    test->ratio_growth = 1;
    test->slowest_ratio = earlier_slowest_ratio;
}

/* Adds a pass whose correction has this size, and returns the outcome of the pass. */
static inline tvi_passes_verdict tvi_convergence_add_pass(tvi_convergence_test *test, const tvi_stopping_rule *rule,
                                                          double correction_size)
{
    bool is_stalled;
    if (tvi_convergence_add_correction(test, rule, correction_size, &is_stalled)) return TVI_PASSES_MAY_END;
    return is_stalled ? TVI_PASSES_STUCK : TVI_PASSES_GO_ON;
}

/* Sets the roundoff that was measured after the passes were stuck, for this and all later passes. Returns whether the
 * last correction is roundoff, that is, at most this. */
static inline bool tvi_convergence_set_roundoff(tvi_convergence_test *test, double measured_roundoff)
{
    test->roundoff = measured_roundoff;
    return test->size <= measured_roundoff;
}

#endif
