/* judge.h - Decides from the sizes of its corrections whether an iteration may end, by the rule of passes.h. The
 * functions below are compiled for numbers (passes.h) and for vectors of lanes (the kernels of src/galerkin/): each of
 * these files defines the macros and includes this one. JUDGED(x) is the name of x in that file, REAL the type of
 * numbers, and TRUTH that of comparisons. The macros ABOVE, AT_MOST, NOT, AND, OR and IF compare and choose; they are
 * undefined at the end. */

#define SMALLER(a, b) IF(ABOVE(b, a), a, b)
#define LARGER(a, b)  IF(ABOVE(a, b), a, b)

typedef struct {
    int count;
    /* The sizes of the last three corrections. A pass moves each size to the next field. */
    REAL size, previous_size, size_two_passes_before;
    /* A correction above the roundoff level is significant. `ratio` is the ratio of the last significant correction
     * to the one before it. `slowest_ratio` is the larger one of the last two such ratios; at first it is the ratio
     * of an earlier iteration, or 0 if that is unknown. */
    REAL ratio, slowest_ratio;
    /* The size of the last correction; if roundoff hides it, an estimate of the size without roundoff. */
    REAL size_without_roundoff;
    REAL expected_next_size; /* The size that the next correction is expected to have. */
    /* The factor by which `ratio` may grow from this pass to the next. expected_next_size contains this factor. It is
     * more than 1 only for Newton's method (generating/newton.h). */
    REAL contraction_ratio_growth;
    REAL roundoff; /* Corrections up to this size are measured to be roundoff; 0: nothing was measured. */
} JUDGED(convergence_test);

/* Adds a pass whose correction has this size. Returns true if the pass may be the last one. *is_stalled tells whether
 * the corrections no longer shrink, and counts only if the pass may not be the last one.
 *
 * The ratio of a correction is its size over that of the correction before it. If the correction before was larger than
 * 1, the ratio is the size over 1, since such a correction shows the size of the unknowns rather than the convergence.
 * Corrections at the roundoff level do not show how fast the passes converge. They are assumed to converge like the
 * significant ones, and their growth does not make the passes stuck. After a single correction the rate is unknown. If
 * three corrections at the roundoff level have the same size, the unknowns alternate between values that differ in
 * their last bits, and the pass may be the last one. */
static inline TRUTH JUDGED(add_correction_and_check_convergence)(JUDGED(convergence_test) * test,
                                                                 const tvi_stopping_rule *rule, REAL correction_size,
                                                                 TRUTH *is_stalled)
{
    const REAL none = {0}, one = 1 - none, before = test->size, earlier = test->previous_size;
    const int count = ++test->count;
    const TRUTH no = ABOVE(none, none), all = NOT(no);
    const TRUTH is_significant = ABOVE(correction_size, rule->roundoff_level - none);
    if (count > 1 && rule->exact_passes == 0) {
        const REAL ratio = correction_size / SMALLER(before, one), square = ratio * ratio,
                   slower = rule->is_convergence_quadratic ? square : LARGER(ratio, test->ratio);
        test->ratio = IF(is_significant, ratio, test->ratio);
        test->slowest_ratio = IF(is_significant, slower, test->slowest_ratio);
    }
    const REAL slowest_ratio = test->slowest_ratio;
    const TRUTH is_ratio_trusted =
        AND(ABOVE(slowest_ratio, none), ABOVE(rule->max_trusted_contraction_ratio - none, slowest_ratio));
    const REAL expected_ratio = IF(is_ratio_trusted, slowest_ratio, one),
               expected_size = expected_ratio * test->size_without_roundoff;
    const REAL without_roundoff = IF(is_significant, correction_size, SMALLER(correction_size, expected_size)),
               expected_next_size = test->contraction_ratio_growth * expected_ratio * without_roundoff;
    test->size_two_passes_before = earlier;
    test->previous_size = before;
    test->size = correction_size;
    test->size_without_roundoff = without_roundoff;
    test->expected_next_size = count > 1 ? expected_next_size : IF(is_significant, correction_size, expected_next_size);
    *is_stalled = no;
    if (rule->exact_passes > 0) return count == rule->exact_passes ? all : no;
    if (count > rule->stall_comparison_lag) {
        const REAL least = rule->stall_contraction_ratio * before,
                   least_of_two = rule->stall_contraction_ratio * rule->stall_contraction_ratio * earlier;
        const TRUTH grows =
            ABOVE(correction_size, rule->stall_comparison_lag > 1 ? LARGER(least, least_of_two) : least);
        *is_stalled = AND(grows, OR(is_significant, NOT(is_ratio_trusted)));
    }
    const TRUTH is_at_goal = AT_MOST(test->expected_next_size, rule->correction_goal - none),
                is_roundoff = AT_MOST(correction_size, test->roundoff);
    const TRUTH is_cycle = AND(AND(NOT(is_significant), AT_MOST(LARGER(before, earlier), correction_size)),
                               AT_MOST(correction_size, SMALLER(before, earlier)));
    return OR(OR(is_at_goal, is_roundoff), is_cycle);
}

#undef SMALLER
#undef LARGER
#undef JUDGED
#undef REAL
#undef TRUTH
#undef ABOVE
#undef AT_MOST
#undef NOT
#undef AND
#undef OR
#undef IF
