/* batch_verdicts.c - when the passes of several members may end, each by itself. */
#include "galerkin/batch_vectors.h"

#include <float.h>
#include <math.h>

#define ALL_OF(V, number) ((V){0} + (number))

/* The numbers of the rule for one pass: what does not hold in it is beyond all sizes. */
typedef struct {
    double goal, noise, contraction, stuck, again, before;
} numbers;

static numbers numbers_of(const tvi_passes_rule *rule, int count)
{
    const bool is_asked = rule->exactly > 0;
    numbers of = {rule->goal, rule->noise, rule->contraction, rule->stuck, -1, count == 1 ? INFINITY : 0};
    if (is_asked) of.goal = count == rule->exactly ? DBL_MAX : -1, of.noise = -1;
    if (is_asked || count <= rule->turns) of.stuck = INFINITY;
    if (rule->turns > 1) of.again = rule->stuck * rule->stuck;
    return of;
}

/* As galerkin_is_next. */
#define IS_NEXT(V, last_h)                                                                                             \
    IS_ABOVE(V, ALL_OF(V, quarter), JET_ABS(V, ROW_OF(V, t, 0) - (ROW_OF(V, last->t, 0) + last_h)))

#define BEGIN(V, S)                                                                                                    \
    {                                                                                                                  \
        const V of_h = ALL_OF(V, h), last_h = ROW_OF(V, last->h, 0);                                                   \
        const WHICH(V) is_steady = IS_SAME(V, last_h, of_h) & IS_SAME(V, ROW_OF(V, last->h_before, 0), of_h);          \
        const WHICH(V) moving = WHICH_OF(V, nodes->in_lanes) & is_steady & IS_NEXT(V, last_h);                         \
        SET_WHICH(V, nodes->in_lanes, moving);                                                                         \
        SET_WHICH(V, nodes->is_moving, moving);                                                                        \
        count += COUNT(V, moving);                                                                                     \
        ROW_AT(V, of.slowest, 0) = ROW_OF(V, last->slowest, 0);                                                        \
        ROW_AT(V, of.size, 0) = ROW_AT(V, of.before, 0) = ALL_OF(V, INFINITY);                                         \
        ROW_AT(V, of.part, 0) = ROW_AT(V, of.shown, 0) = ROW_AT(V, of.count, 0) = ALL_OF(V, 0);                        \
        SET_WHICH(V, of.is_stuck, (WHICH(V)){0});                                                                      \
    }

int tvi_galerkin_batch_begin(const galerkin_batch_nodes *nodes, const galerkin_batch_history *last, double h,
                             const double t[], const tvi_status status[], const galerkin_batch_passes *passes)
{
    const size_t width = (size_t)nodes->width;
    const galerkin_batch_passes of = *passes;
    const double quarter = 0.25 * fabs(h);
    int count = 0;
    for (size_t m = 0; m < width; m++) nodes->in_lanes[m] = status[m] == TVI_OK ? -1 : 0;
    JET_EIGHTS((int)width, BEGIN, )
    return count;
}

/* In the words of algebra/passes.h. */
#define JUDGE(V, S)                                                                                                    \
    {                                                                                                                  \
        const WHICH(V) moving = WHICH_OF(V, is_moving);                                                                \
        const V none = {0}, one = ALL_OF(V, 1), size = ROW_OF(V, moved, 0), before = ROW_OF(V, of.size, 0),            \
                earlier = ROW_OF(V, of.before, 0), part_before = ROW_OF(V, of.part, 0),                                \
                slowest_before = ROW_OF(V, of.slowest, 0);                                                             \
        const WHICH(V) is_new = IS_ABOVE(V, ALL_OF(V, by.before), one),                                                \
                       is_loud = IS_ABOVE(V, size, ALL_OF(V, by.noise));                                               \
        const V part_now = size / CHOOSE(V, IS_ABOVE(V, one, before), before, one);                                    \
        const V slower = CHOOSE(V, IS_ABOVE(V, part_now, part_before), part_now, part_before);                         \
        const WHICH(V) shows = NOT(V, is_new) & is_loud;                                                               \
        const V slowest = CHOOSE(V, shows, slower, slowest_before);                                                    \
        const WHICH(V) is_known = IS_ABOVE(V, slowest, none) & IS_ABOVE(V, ALL_OF(V, by.contraction), slowest);        \
        const V part = CHOOSE(V, is_known, slowest, one), expected = part * ROW_OF(V, of.shown, 0);                    \
        const V quiet = CHOOSE(V, is_new | IS_ABOVE(V, expected, size), size, expected);                               \
        const V shown = CHOOSE(V, is_loud, size, quiet);                                                               \
        const V next = CHOOSE(V, is_new & is_loud, size, part * shown);                                                \
        const WHICH(V) grows = IS_ABOVE(V, size, by.stuck * before) & IS_ABOVE(V, size, by.again * earlier);           \
        const WHICH(V) is_cycle = IS_SAME(V, size, before) & IS_SAME(V, size, earlier) & NOT(V, is_loud);              \
        const WHICH(V) ends = IS_AT_MOST(V, next, ALL_OF(V, by.goal)) | is_cycle;                                      \
        const WHICH(V) is_finite = IS_ABOVE(V, ALL_OF(V, INFINITY), size);                                             \
        const WHICH(V) fails = (grows & (is_loud | NOT(V, is_known)) & NOT(V, ends)) | NOT(V, is_finite);              \
        ROW_AT(V, of.size, 0) = CHOOSE(V, moving, size, before);                                                       \
        ROW_AT(V, of.count, 0) += CHOOSE(V, moving, one, none);                                                        \
        ROW_AT(V, of.before, 0) = before;                                                                              \
        ROW_AT(V, of.slowest, 0) = CHOOSE(V, moving, slowest, slowest_before);                                         \
        ROW_AT(V, of.part, 0) = CHOOSE(V, shows, part_now, part_before);                                               \
        ROW_AT(V, of.shown, 0) = shown;                                                                                \
        const WHICH(V) stuck = moving & fails, still = moving & NOT(V, ends | fails);                                  \
        SET_WHICH(V, of.is_stuck, WHICH_OF(V, of.is_stuck) | stuck);                                                   \
        SET_WHICH(V, is_moving, still);                                                                                \
        go_on += COUNT(V, still);                                                                                      \
        stuck_now += COUNT(V, stuck);                                                                                  \
    }

int tvi_galerkin_batch_judge(const galerkin_batch_nodes *nodes, const tvi_passes_rule *rule, int count,
                             const double moved[], const galerkin_batch_passes *passes, bool *any_stuck)
{
    const size_t width = (size_t)nodes->width;
    const galerkin_batch_passes of = *passes;
    const numbers by = numbers_of(rule, count);
    long long *is_moving = nodes->is_moving;
    int go_on = 0, stuck_now = 0;
    JET_EIGHTS((int)width, JUDGE, )
    *any_stuck = stuck_now > 0;
    return go_on;
}
