/* judge.h - Applies the rule of passes.h to the corrections of an iteration. The text serves numbers (passes.h) and
 * vectors of lanes (the kernels of src/galerkin/); each includes it with its own macros. REAL is the type of
 * numbers, TRUTH that of comparisons, and JUDGED makes the names. The macros ABOVE, AT_MOST, SAME, NOT and IF
 * compare and choose; they are undefined at the end. */

typedef struct {
    int count;
    REAL size, before, earlier; /* The last three corrections, the newest one first. */
    /* A correction above the roundoff level is significant. `part` is the ratio of the last significant correction
     * to the one before it. `slowest` is the larger one of the last two such ratios; at first it is that of an
     * earlier iteration, or 0 if unknown. */
    REAL part, slowest;
    REAL shown; /* The last correction, or if it is hidden by roundoff, what it would be without roundoff. */
    REAL next;  /* The expected size of the next correction. */
    /* A factor of `next`. It is 1, except for Newton's method (generating/newton.h). */
    REAL slack;
    /* Corrections up to this size are roundoff, by a measurement; 0: nothing was measured. */
    REAL roundoff;
} JUDGED(passes);

/* Adds a pass whose correction has this size. Returns whether the pass may be the last one. *is_stuck tells that it may
 * not, and that the corrections no longer shrink.
 *
 * If the correction before was larger than 1, the ratio is taken to 1, since such a correction shows the size of the
 * unknowns rather than the convergence. Corrections at the roundoff level do not show how fast the passes converge.
 * They are assumed to converge like the significant ones, and their growth does not make the passes stuck. After a
 * single correction the rate is unknown. In a cycle only the last bits change, in turn. */
static inline TRUTH JUDGED(judge)(JUDGED(passes) * passes, const tvi_passes_rule *rule, REAL size, TRUTH *is_stuck)
{
    const REAL none = {0}, one = 1 - none, before = passes->size, earlier = passes->before;
    const REAL part = size / IF(ABOVE(one, before), before, one), part_before = passes->part;
    const int count = ++passes->count;
    const TRUTH no = ABOVE(none, none), all = NOT(no), is_first = count == 1 ? all : no,
                is_asked = rule->exact_passes > 0 ? all : no;
    const TRUTH is_loud = ABOVE(size, rule->roundoff_level - none), shows = NOT(is_asked) & NOT(is_first) & is_loud;
    const REAL square = part * part, larger = IF(ABOVE(part, part_before), part, part_before);
    const REAL slower = rule->is_quadratic ? square : larger;
    const REAL slowest = IF(shows, slower, passes->slowest);
    const TRUTH is_known = ABOVE(slowest, none) & ABOVE(rule->max_contraction - none, slowest);
    const REAL left = IF(is_known, slowest, one), expected = left * passes->shown;
    const REAL shown = IF(is_loud | is_first | ABOVE(expected, size), size, expected);
    passes->earlier = earlier;
    passes->before = before;
    passes->size = size;
    passes->part = IF(shows, part, part_before);
    passes->slowest = slowest;
    passes->shown = shown;
    passes->next = IF(is_loud & is_first, size, passes->slack * left * shown);
    const TRUTH is_cycle = SAME(size, before) & SAME(size, earlier) & NOT(is_loud);
    const TRUTH is_at_goal = AT_MOST(passes->next, rule->correction_goal - none),
                is_roundoff = AT_MOST(size, passes->roundoff);
    const TRUTH grows =
        ABOVE(size, rule->stall_ratio * before) &
        (rule->stall_period < 2 ? all : (TRUTH)ABOVE(size, rule->stall_ratio * rule->stall_ratio * earlier));
    *is_stuck = count > rule->stall_period ? (TRUTH)(NOT(is_asked) & grows & (is_loud | NOT(is_known))) : no;
    if (rule->exact_passes > 0) return count == rule->exact_passes ? all : no;
    return is_at_goal | is_roundoff | is_cycle;
}

#undef JUDGED
#undef REAL
#undef TRUTH
#undef ABOVE
#undef AT_MOST
#undef SAME
#undef NOT
#undef IF
