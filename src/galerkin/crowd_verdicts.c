/* crowd_verdicts.c - when the passes of several members may end, each by itself. */
#include "galerkin/crowd_vectors.h"

#include <float.h>
#include <math.h>

#define ALL_OF(V, number) ((V){0} + (number))
#define MASK_OF(V, of)    ((JET_MASK(V))(of))

/* The numbers of the rule for one pass: what does not hold in it is beyond all sizes. */
typedef struct {
    double goal, far, noise, contraction, stuck, again, roundoff;
} numbers;

static numbers numbers_of(const tvi_passes_rule *rule, int count)
{
    const bool is_asked = rule->exactly > 0, has_two = rule->turns > 1 && count > 2;
    numbers of = {rule->goal, rule->far, rule->noise, rule->contraction, rule->stuck, -1, rule->roundoff};
    if (is_asked) of.goal = count == rule->exactly ? DBL_MAX : -1;
    if (is_asked || count <= rule->patience) of.stuck = INFINITY;
    if (count == 1) of.far = -1;
    if (has_two) of.again = rule->stuck * rule->stuck;
    return of;
}

#define BEGIN(V, S)                                                                                                    \
    {                                                                                                                  \
        ROW_AT(V, of.size, 0) = ROW_AT(V, of.before, 0) = ALL_OF(V, INFINITY);                                         \
        ROW_AT(V, of.part, 0) = ROW_AT(V, of.shown, 0) = ROW_AT(V, of.count, 0) = ALL_OF(V, 0);                        \
        *(JET_MASK(V) *)(of.is_stuck + here) = (JET_MASK(V)){0};                                                       \
    }

void tvi_galerkin_crowd_begin(const galerkin_crowd_nodes *nodes, const galerkin_crowd_passes *passes)
{
    const size_t width = (size_t)nodes->width;
    const galerkin_crowd_passes of = *passes;
    JET_EIGHTS((int)width, BEGIN, )
}

/* Where sizes are far from all that ends passes, they show nothing but themselves. */
#define IS_FAR(V, size, before)                                                                                        \
    (MASK_OF(V, size > ALL_OF(V, by.far)) & MASK_OF(V, size > ALL_OF(V, by.goal)) &                                    \
     MASK_OF(V, size < ALL_OF(V, INFINITY)) & MASK_OF(V, size <= by.stuck * before))

/* In the words of algebra/passes.h. */
#define JUDGE(V, S)                                                                                                    \
    {                                                                                                                  \
        const JET_MASK(V) moving = *(JET_MASK(V) *)(is_moving + here);                                                 \
        const V none = {0}, one = ALL_OF(V, 1), size = ROW_OF(V, moved, 0), before = ROW_OF(V, of.size, 0),            \
                earlier = ROW_OF(V, of.before, 0), part_before = ROW_OF(V, of.part, 0),                                \
                slowest_before = ROW_OF(V, of.slowest, 0);                                                             \
        const JET_MASK(V) is_far = MASK_OF(V, size > ALL_OF(V, by.far)), goes_on = IS_FAR(V, size, before) | ~moving;  \
        HOLDS_FOR_ALL(V, goes_on, all_go_on)                                                                           \
        if (all_go_on) {                                                                                               \
            ROW_AT(V, of.size, 0) = JET_CHOOSE(V, moving, size, before);                                               \
            ROW_AT(V, of.count, 0) += JET_CHOOSE(V, moving, one, none);                                                \
            ROW_AT(V, of.before, 0) = before;                                                                          \
            ROW_AT(V, of.shown, 0) = size;                                                                             \
            continue;                                                                                                  \
        }                                                                                                              \
        const JET_MASK(V) is_loud = MASK_OF(V, size > ALL_OF(V, by.noise)), shows = ~is_far & is_loud;                 \
        const V part_now = size / JET_CHOOSE(V, before < one, before, one);                                            \
        const V slower = JET_CHOOSE(V, part_now > part_before, part_now, part_before);                                 \
        const V slowest = JET_CHOOSE(V, shows, slower, slowest_before);                                                \
        const JET_MASK(V) is_known = MASK_OF(V, slowest > none) & MASK_OF(V, slowest < ALL_OF(V, by.contraction));     \
        const V part = JET_CHOOSE(V, is_known, slowest, one), expected = part * ROW_OF(V, of.shown, 0);                \
        const V quiet = JET_CHOOSE(V, size < expected, size, expected);                                                \
        const V shown = JET_CHOOSE(V, is_far | is_loud, size, quiet);                                                  \
        const V next = JET_CHOOSE(V, is_far, size, part * shown);                                                      \
        const JET_MASK(V) is_stuck = MASK_OF(V, size > by.stuck * before) & MASK_OF(V, size > by.again * earlier);     \
        const JET_MASK(V) is_large = MASK_OF(V, size > ALL_OF(V, by.roundoff));                                        \
        const JET_MASK(V) is_cycle = MASK_OF(V, size == before) & MASK_OF(V, size == earlier);                         \
        const JET_MASK(V) is_enough = MASK_OF(V, next <= ALL_OF(V, by.goal));                                          \
        const JET_MASK(V) ends = is_enough | (is_stuck & ~is_large & (~is_known | is_cycle));                          \
        const JET_MASK(V) fails = (is_stuck & is_large & ~ends) | ~MASK_OF(V, size < ALL_OF(V, INFINITY));             \
        ROW_AT(V, of.size, 0) = JET_CHOOSE(V, moving, size, before);                                                   \
        ROW_AT(V, of.slowest, 0) = JET_CHOOSE(V, moving, slowest, slowest_before);                                     \
        ROW_AT(V, of.count, 0) += JET_CHOOSE(V, moving, one, none);                                                    \
        ROW_AT(V, of.before, 0) = before;                                                                              \
        ROW_AT(V, of.part, 0) = JET_CHOOSE(V, shows, part_now, part_before);                                           \
        ROW_AT(V, of.shown, 0) = shown;                                                                                \
        *(JET_MASK(V) *)(of.is_stuck + here) |= moving & fails;                                                        \
        *(JET_MASK(V) *)(is_moving + here) = moving & ~(ends | fails);                                                 \
    }

int tvi_galerkin_crowd_judge(const galerkin_crowd_nodes *nodes, const tvi_passes_rule *rule, int count,
                             const double moved[], const galerkin_crowd_passes *passes, bool *any_stuck)
{
    const size_t width = (size_t)nodes->width;
    const galerkin_crowd_passes of = *passes;
    const numbers by = numbers_of(rule, count);
    long long *is_moving = nodes->is_moving, go_on = 0, stuck = 0;
    JET_EIGHTS((int)width, JUDGE, )
    for (size_t m = 0; m < width; m += 8)
        for (size_t k = m; k < m + 8; k++) {
            go_on -= is_moving[k];
            stuck -= of.is_stuck[k];
        }
    *any_stuck = stuck > 0;
    return (int)go_on;
}
