/* judge.h - Applies the rule of passes.h to the corrections of an iteration. It is one text for numbers and for
 * vectors, and is included for each kind of REAL, whose comparisons are a TRUTH. JUDGED names what it defines. The
 * macros ABOVE, AT_MOST, SAME, NOT and IF come from the including file, and are undefined at the end. */

typedef struct {
    int count;
    REAL size, before, earlier; /* the corrections of the last three passes */
    /* `part` is the fraction that the last loud pass left of the correction before. `slowest` is the larger of the last
     * two fractions, at first that of an earlier iteration. 0: not known. A correction above roundoff is loud. */
    REAL part, slowest;
    REAL shown; /* the last correction without its roundoff */
    REAL next;  /* the expected next correction */
    /* The factor of `next`: 1, but for Newton's method (generating/newton.h). */
    REAL slack;
    /* Corrections up to this are roundoff, as was measured; 0: not measured. */
    REAL roundoff;
} JUDGED(passes);

/* Adds a pass with a correction of this size. Returns whether it may be the last pass. *is_stuck: it may not, and the
 * corrections no longer shrink.
 *
 * A previous correction larger than 1 counts as 1: it says more of the unknown's size than of the passes. Corrections
 * at the level of roundoff do not show how passes contract. They are assumed to contract as the loud ones did, and
 * their growth does not mean that the passes are stuck. The contraction of a first loud correction is unknown. In a
 * cycle the last bits alternate, and nothing else changes. */
static inline TRUTH JUDGED(judge)(JUDGED(passes) * passes, const tvi_passes_rule *rule, REAL size, TRUTH *is_stuck)
{
    const REAL none = {0}, one = 1 - none, before = passes->size, earlier = passes->before;
    const REAL part = size / IF(ABOVE(one, before), before, one), part_before = passes->part;
    const int count = ++passes->count;
    const TRUTH no = ABOVE(none, none), all = NOT(no), is_first = count == 1 ? all : no,
                is_asked = rule->exactly > 0 ? all : no;
    const TRUTH is_loud = ABOVE(size, rule->noise - none), shows = NOT(is_asked) & NOT(is_first) & is_loud;
    const REAL square = part * part, larger = IF(ABOVE(part, part_before), part, part_before);
    const REAL slower = rule->is_quadratic ? square : larger;
    const REAL slowest = IF(shows, slower, passes->slowest);
    const TRUTH is_known = ABOVE(slowest, none) & ABOVE(rule->contraction - none, slowest);
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
    const TRUTH is_at_goal = AT_MOST(passes->next, rule->goal - none), is_roundoff = AT_MOST(size, passes->roundoff);
    const TRUTH grows = ABOVE(size, rule->stuck * before) &
                        (rule->period < 2 ? all : (TRUTH)ABOVE(size, rule->stuck * rule->stuck * earlier));
    *is_stuck = count > rule->period ? (TRUTH)(NOT(is_asked) & grows & (is_loud | NOT(is_known))) : no;
    if (rule->exactly > 0) return count == rule->exactly ? all : no;
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
