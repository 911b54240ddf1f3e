/* judge.h - the rule of passes.h: one text over numbers, of one iteration, or over vectors, of several. Read for each
 * kind of REAL, whose comparisons are a TRUTH; JUDGED names what it
 * defines. These macros, ABOVE, AT_MOST, SAME, NOT and IF are the reader's, and end here. */

typedef struct {
    int count;
    REAL size, before, earlier; /* of the corrections of the last three passes */
    REAL part, slowest; /* what the last loud pass left of the correction before, and the larger of the last two such
                           parts, at first that of an earlier iteration; 0: not known. Loud is what is above roundoff */
    REAL shown;         /* the last correction without its roundoff, */
    REAL next;          /* what the next one should be, */
    REAL slack;         /* and how much more it is taken to be: 1, but for Newton's method (generating/newton.h) */
    REAL roundoff;      /* a correction of at most this is roundoff, as measured; 0: not measured */
} JUDGED(passes);

/* Adds a pass, whose correction is so large: whether it may be the last; *is_stuck: otherwise, whether it is one of
 * those that no longer shrink.
 *
 * A correction before that is larger than 1 counts as 1: it says more of the unknown's size than of the passes. Once
 * corrections are roundoff, they no longer show how passes contract: then they are taken to go on as the loud ones did,
 * and that they grow does not mean that they are stuck. Of a first correction that is loud nothing is known. In a cycle
 * the last bits go to and fro, and nothing else moves. */
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
                        (rule->turns < 2 ? all : (TRUTH)ABOVE(size, rule->stuck * rule->stuck * earlier));
    *is_stuck = count > rule->turns ? (TRUTH)(NOT(is_asked) & grows & (is_loud | NOT(is_known))) : no;
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
