/* passes.h - Decides when the passes of an iteration may end (docs/method.md, section 5). A pass evaluates the
 * residual and corrects the unknowns. Newton's method, the Galerkin passes, the Legendre transforms and the
 * iterations inside a step use this rule with different numbers. */
#ifndef TVI_SRC_ALGEBRA_PASSES_H
#define TVI_SRC_ALGEBRA_PASSES_H

#include "algebra/sizes.h"

#include <float.h>

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
    double max_trusted_contraction_ratio;
    /* The passes are stuck, that is, their corrections no longer shrink, if the ratio of corrections is above this. */
    double stall_contraction_ratio;
    /* The number of earlier corrections with which a correction is compared, to tell whether the passes are stuck: 1,
     * or 2 if small and large corrections may alternate. With 2, the passes are stuck only if the correction also
     * exceeds stall_contraction_ratio^2 times the correction two passes before. */
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

/* Defines the structure tvi_convergence_test, which holds the sizes of the corrections so far, and the function
 * tvi_add_correction_and_check_convergence, which adds a pass to it. */
#define JUDGED(name)       tvi_##name
#define REAL               double
#define TRUTH              int
#define ABOVE(a, b)        ((a) > (b))
#define AT_MOST(a, b)      ((a) <= (b))
#define NOT(a)             (!(a))
#define AND(a, b)          ((a) && (b))
#define OR(a, b)           ((a) || (b))
#define IF(which, yes, no) ((which) ? (yes) : (no))
#include "algebra/judge.h"

/* Begins an iteration. `earlier_slowest_contraction_ratio` is the slowest ratio of successive corrections in an earlier
 * iteration, or 0 if it is unknown. The fields are set one by one, since compilers would clear the structure by an
 * instruction that starts slowly. */
static inline void tvi_convergence_test_begin_iteration(tvi_convergence_test *test,
                                                        double earlier_slowest_contraction_ratio)
{
    test->count = 0;
    test->size = test->previous_size = test->size_two_passes_before = INFINITY;
    test->ratio = test->expected_next_size = test->roundoff = 0;
    test->size_without_roundoff = INFINITY;
    test->contraction_ratio_growth = 1;
    test->slowest_ratio = earlier_slowest_contraction_ratio;
}

/* Adds a pass whose correction has this size, and returns the outcome of the pass. */
static inline tvi_passes_verdict tvi_convergence_test_add_pass(tvi_convergence_test *test,
                                                               const tvi_stopping_rule *rule, double correction_size)
{
    int is_stalled;
    if (tvi_add_correction_and_check_convergence(test, rule, correction_size, &is_stalled)) return TVI_PASSES_MAY_END;
    return is_stalled ? TVI_PASSES_STUCK : TVI_PASSES_GO_ON;
}

/* Sets the roundoff that was measured after the passes were stuck, for this and all later passes. Returns whether the
 * last correction is roundoff, that is, at most this. */
static inline bool tvi_convergence_test_set_measured_roundoff(tvi_convergence_test *test, double measured_roundoff)
{
    test->roundoff = measured_roundoff;
    return test->size <= measured_roundoff;
}

#endif
