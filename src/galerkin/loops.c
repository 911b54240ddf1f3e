/* loops.c - see loops.h. */
#include "algebra/sizes.h"
#include "algebra/tail.h"
#include "galerkin/columns.h"
#include "galerkin/few.h"
#include "galerkin/rounds.h"
#include "rule.h"

#include <math.h>

#define VECTOR(V, array, index)    (*(V *)((array) + (size_t)(index) * (size_t)lanes + here))
#define OF_VECTOR(V, array, index) (*(const V *)((array) + (size_t)(index) * (size_t)lanes + here))

/* sum[0][] + ... = sum_j (row j of the matrix) impulse_j for all lanes: chains that do not wait for each other. */
#define CHAINS_OF(blocks) (lanes == 1 ? 1 : lanes == 2 || (blocks) > 1 ? 2 : CHAINS)
/* Where a row is two blocks, two unknowns share what is read of it. */
enum { MOST_UNITS = 2 };
#define UNITS_OF(blocks) ((blocks) == 2 ? MOST_UNITS : 1)

/* Where a row is one block it stays in its register for all unknowns. In loops over any number of them gcc keeps sums
 * with 0, and no copies; where it knows the number, copies, too. */
#ifdef JET_EMITTED
#define KEPT(V, x) (x)
#else
#define KEPT(V, x) ((x) + (V){0})
#endif
#define KEEP_ROWS(V, blocks, row, matrix)                                                                              \
    V row[TVI_GALERKIN_MAX_LANES];                                                                                     \
    for (int j = 0; j < ((blocks) == 1 ? lanes : 0); j++) row[j] = KEPT(V, BLOCK_OF(V, (matrix) + j * lanes, 0));
#define ROW_OF(V, blocks, row, matrix, j, k) ((blocks) == 1 ? row[j] : BLOCK_OF(V, (matrix) + (j)*lanes, k))

/* Of `units` unknowns at a time, impulse [units][lanes]. */
#define SET_PRODUCT(V, blocks, units, row, matrix, impulse)                                                            \
    V sum[MOST_UNITS][CHAINS][MOST_BLOCKS];                                                                            \
    if ((blocks) > 1) LEAVE_REGISTERS(matrix);                                                                         \
    for (int j = 0; j < CHAINS_OF(blocks); j++)                                                                        \
        for (int k = 0; k < (blocks); k++)                                                                             \
            for (int i = 0; i < (units); i++)                                                                          \
                sum[i][j][k] = ROW_OF(V, blocks, row, matrix, j, k) * (impulse)[i * lanes + j];                        \
    ADD_PRODUCT(V, blocks, units, row, matrix, impulse, CHAINS_OF(blocks))

#define ADD_PRODUCT(V, blocks, units, row, matrix, impulse, from)                                                      \
    for (int j = (from); j < lanes; j++)                                                                               \
        for (int k = 0; k < (blocks); k++)                                                                             \
            for (int i = 0; i < (units); i++)                                                                          \
                sum[i][j % CHAINS_OF(blocks)][k] += ROW_OF(V, blocks, row, matrix, j, k) * (impulse)[i * lanes + j];

#define ADD_CHAINS(blocks, units)                                                                                      \
    for (int others = CHAINS_OF(blocks) / 2; others > 0; others /= 2)                                                  \
        for (int j = 0; j < others; j++)                                                                               \
            for (int k = 0; k < (blocks); k++)                                                                         \
                for (int i = 0; i < (units); i++) sum[i][j][k] += sum[i][j + others][k];

#define WEIGH(V, blocks)                                                                                               \
    for (int u = 0; u < unknowns; u++) {                                                                               \
        const double *drive = drives + (size_t)slot[u] * (size_t)lanes;                                                \
        double *of_u = impulse + u * lanes;                                                                            \
        for (int k = 0; k < (blocks); k++) BLOCK_AT(V, of_u, k) = BLOCK_OF(V, weight, k) * BLOCK_OF(V, drive, k);      \
    }

JET_INLINE void weigh_lanes(const galerkin_nodes *nodes, const double *drives, const int slot[], int lanes)
{
    const double *weight = nodes->weight;
    const int unknowns = nodes->unknowns;
    double *impulse = nodes->impulse;
    ALL_LANES(lanes, WEIGH)
}

/* Squares of blocks in turns, of which none waits for the one before it. */
enum { SUMS_OF_SQUARES = 2 };
#define FOLLOW_UNITS(V, blocks, units)                                                                                 \
    {                                                                                                                  \
        SET_PRODUCT(V, blocks, units, row, matrix, impulse)                                                            \
        ADD_CHAINS(blocks, units)                                                                                      \
        for (int i = 0; i < (units); i++, u++, x += lanes, high += lanes, base += lanes, impulse += lanes) {           \
            for (int k = 0; k < (blocks); k++) {                                                                       \
                const V from = BLOCK_OF(V, high, k), way = BLOCK_OF(V, base, k) + scale[u] * sum[i][0][k];             \
                const V place = from + way;                                                                            \
                const V change = (place - BLOCK_OF(V, x, k)) * inverse_size[u];                                        \
                squares[k % SUMS_OF_SQUARES] += change * change;                                                       \
                BLOCK_AT(V, x, k) = place;                                                                             \
                if (ways) BLOCK_AT(V, ways + u * lanes, k) = way;                                                      \
            }                                                                                                          \
        }                                                                                                              \
    }
#define FOLLOW_ROWS(V, blocks, count)                                                                                  \
    {                                                                                                                  \
        int u = 0;                                                                                                     \
        while (UNITS_OF(blocks) > 1 && u + UNITS_OF(blocks) <= (count)) FOLLOW_UNITS(V, blocks, UNITS_OF(blocks))      \
        while (u < (count)) FOLLOW_UNITS(V, blocks, 1)                                                                 \
    }

#define FOLLOW(V, blocks)                                                                                              \
    {                                                                                                                  \
        V squares[SUMS_OF_SQUARES] = {0};                                                                              \
        KEEP_ROWS(V, blocks, row, matrix)                                                                              \
        FOLLOW_ROWS(V, blocks, moving)                                                                                 \
        if (moving < nodes->unknowns) {                                                                                \
            const int half = nodes->half, gap = (half - moving) * lanes;                                               \
            x += gap, high += gap, base += gap, impulse += gap, scale += half, inverse_size += half;                   \
            ways = ways ? ways + half * lanes : NULL;                                                                  \
            FOLLOW_ROWS(V, blocks, moving)                                                                             \
        }                                                                                                              \
        if ((blocks) > 1) squares[0] += squares[1];                                                                    \
        if (left) *(V *)left = squares[0];                                                                             \
        else moved = sum_of_##V(squares[0]);                                                                           \
    }

/* Once all impulses are there, and none waits for the one before it. ways: how far x is from high, or NULL. left:
 * instead of the sum of the squares their sums in the lanes of a vector, of the widest; or NULL. */
JET_INLINE double follow_to(const galerkin_nodes *nodes, const double *matrix, double *ways, double *left, int lanes)
{
    const double *high = nodes->high, *base = nodes->base, *scale = nodes->scale, *inverse_size = nodes->inverse_size;
    const int moving = nodes->moving;
    double *x = nodes->x, *impulse = nodes->impulse, moved = 0;
    LEAVE_REGISTERS(impulse);
    ALL_LANES(lanes, FOLLOW)
    return moved;
}

JET_INLINE double follow_lanes(const galerkin_nodes *nodes, const double *matrix, double *ways, int lanes)
{
    return follow_to(nodes, matrix, ways, NULL, lanes);
}

JET_INLINE double move_lanes(const galerkin_nodes *nodes, const double *matrix, const double *drives, const int slot[],
                             int lanes)
{
#ifdef JET_WIDE
    if (ARE_FEW(nodes, lanes)) return move_few(nodes, matrix, drives, slot);
#endif
    weigh_lanes(nodes, drives, slot, lanes);
    return follow_lanes(nodes, matrix, NULL, lanes);
}

BY_LANES(double, return, move,
         (const galerkin_nodes *nodes, const double *matrix, const double *drives, const int slot[]), nodes, matrix,
         drives, slot)

JET_INLINE double move_in_parts_lanes(const galerkin_nodes *nodes, const double *matrix, const double *drives,
                                      const int slot[], double *ways, int lanes)
{
    weigh_lanes(nodes, drives, slot, lanes);
    return follow_lanes(nodes, matrix, ways, lanes);
}

BY_LANES(double, return, move_in_parts,
         (const galerkin_nodes *nodes, const double *matrix, const double *drives, const int slot[], double *ways),
         nodes, matrix, drives, slot, ways)

/* a b + c, rounded once where c is small beside a b; without fused operations by Dekker's product. */
JET_INLINE double product_and(double a, double b, double c)
{
#ifdef __FMA__
    return __builtin_fma(a, b, c);
#else
    const double split = 0x1p27 + 1, product = a * b, big_a = split * a, big_b = split * b;
    const double high_a = big_a - (big_a - a), high_b = big_b - (big_b - b), low_a = a - high_a, low_b = b - high_b;
    return product + ((((high_a * high_b - product) + high_a * low_b + low_a * high_b) + low_a * low_b) + c);
#endif
}

JET_INLINE void weigh_both(const double *weight, const double *drive, const double *change, double *restrict impulse,
                           int lanes)
{
    JET_IN_VECTORS
    for (int i = 0; i < lanes; i++) impulse[i] = product_and(weight[i], drive[i], change[i]);
}

/* If drives and changes were added first, a change of less than a unit of the drive would be rounded by what repeats
 * itself from step to step (docs/method.md section 6). */
JET_INLINE double move_both_lanes(const galerkin_nodes *nodes, const double *matrix, const double *drives,
                                  const double *changes, const int slot[], int lanes)
{
    for (int u = 0; u < nodes->unknowns; u++)
        weigh_both(nodes->weight, drives + slot[u] * lanes, changes + u * lanes, nodes->impulse + u * lanes, lanes);
    return follow_lanes(nodes, matrix, NULL, lanes);
}

BY_LANES(double, return, move_both,
         (const galerkin_nodes *nodes, const double *matrix, const double *drives, const double *changes,
          const int slot[]),
         nodes, matrix, drives, changes, slot)

/* What is known last is added last. */
#define PREDICT_UNITS(V, blocks, units)                                                                                \
    {                                                                                                                  \
        SET_PRODUCT(V, blocks, units, row_before, of_before, before)                                                   \
        if ((blocks) > 1) LEAVE_REGISTERS(matrix);                                                                     \
        if (steps > 1) ADD_PRODUCT(V, blocks, units, row, matrix, last, 0)                                             \
        ADD_CHAINS(blocks, units)                                                                                      \
        for (int i = 0; i < (units);                                                                                   \
             i++, u++, x += lanes, high += lanes, base += lanes, last += lanes, before += lanes)                       \
            for (int k = 0; k < (blocks); k++) {                                                                       \
                V from = BLOCK_OF(V, base, k);                                                                         \
                if (drift) from = drift[u] - (V){0};                                                                   \
                BLOCK_AT(V, x, k) = BLOCK_OF(V, high, k) + (from + scale[u] * sum[i][0][k]);                           \
            }                                                                                                          \
    }
#define PREDICT(V, blocks)                                                                                             \
    {                                                                                                                  \
        int u = 0;                                                                                                     \
        KEEP_ROWS(V, blocks, row, matrix)                                                                              \
        KEEP_ROWS(V, blocks, row_before, of_before)                                                                    \
        if ((blocks) == 1) LEAVE_REGISTERS(last);                                                                      \
        while (UNITS_OF(blocks) > 1 && u + UNITS_OF(blocks) <= unknowns) PREDICT_UNITS(V, blocks, UNITS_OF(blocks))    \
        while (u < unknowns) PREDICT_UNITS(V, blocks, 1)                                                               \
    }

/* drift: what the step before added beside its impulses, where the nodes are those of that step; else NULL. */
JET_INLINE void predict_steps(const galerkin_nodes *nodes, int steps, const double *matrix,
                              const double *const impulses[], const double *drift, int lanes)
{
    const double *high = nodes->high, *base = nodes->base, *scale = nodes->scale;
    const double *last = impulses[0], *before = impulses[steps - 1], *of_before = matrix + (steps - 1) * lanes * lanes;
    const int unknowns = nodes->unknowns;
    double *x = nodes->x;
    ALL_LANES(lanes, PREDICT)
}

JET_INLINE void predict_lanes(const galerkin_nodes *nodes, int steps, const double *matrix,
                              const double *const impulses[], int lanes)
{
    if (steps == 2) predict_steps(nodes, 2, matrix, impulses, NULL, lanes);
    else predict_steps(nodes, 1, matrix, impulses, NULL, lanes);
}

BY_LANES(void, , predict,
         (const galerkin_nodes *nodes, int steps, const double *matrix, const double *const impulses[]), nodes, steps,
         matrix, impulses)

BY_LANES(void, , go_round,
         (const galerkin_nodes *nodes, const lanes_rounds *rounds, const double *drives, const int slot[], bool is_new,
          double moved, double least, double *changes),
         nodes, rounds, drives, slot, is_new, moved, least, changes)

JET_INLINE void integrate_lanes(const galerkin_nodes *nodes, const galerkin_weights *weights, const galerkin_sums *sums,
                                int lanes)
{
    const double *impulse = nodes->impulse;
    const int unknowns = nodes->unknowns;
#ifdef JET_WIDE
    if (lanes == 8 && unknowns > GALERKIN_FEWEST) {
        for (int u = 0; u < unknowns; u += 8) sum_columns(weights, impulse, u, unknowns, sums);
        return;
    }
#endif
    for (int u = 0; u < unknowns; u += 2) {
        const int v = u + 1 < unknowns ? u + 1 : u;
        pair_sums sum;
        sum_pair(weights, impulse + u * lanes, impulse + v * lanes, unknowns, lanes, &sum);
        for (int i = u; i <= v; i++) put_sums(&sum, 2 * (i - u), sums, i);
    }
}

BY_LANES(void, , integrate, (const galerkin_nodes *nodes, const galerkin_weights *weights, const galerkin_sums *sums),
         nodes, weights, sums)

/* A loop without comparisons that last from one component to the next is one of vectors; a few go one by one. */
JET_INLINE tvi_tail_survey tails_of(galerkin_motion of, bool few, bool is_separable, double *restrict share,
                                    double *restrict ratio)
{
    const size_t n = (size_t)of.n, momenta = is_separable ? 0 : n;
    const bool has_masses = is_separable || of.has_masses;
    tvi_tail_survey survey = {0, 0, 0};
    for (size_t i = 0; i < n; i++) {
        const tvi_tail_part part = galerkin_tail_part(&of, is_separable, of.scale[i], of.per_scale[i], i, i + momenta);
        if (few) tvi_tail_look(&survey, &part, has_masses);
        else share[i] = tvi_tail_share(&part, has_masses), ratio[i] = tvi_tail_ratio(&part);
    }
    return survey;
}

OWN double tail_of_all(const galerkin_motion *of, double *share, double *ratio)
{
    (void)(of->is_separable ? tails_of(*of, false, true, share, ratio) : tails_of(*of, false, false, share, ratio));
    return tvi_tail_of_all(&of->parts, of->n, share, ratio);
}

static double tail(const galerkin_motion *of, double *share, double *ratio)
{
    if (of->n >= 4 || of->parts.count > 1) return tail_of_all(of, share, ratio);
    const tvi_tail_survey survey =
        of->is_separable ? tails_of(*of, true, true, share, ratio) : tails_of(*of, true, false, share, ratio);
    return tvi_tail_is_known(&survey) ? survey.ratio : tail_of_all(of, share, ratio);
}

#define SET_ALL(V, blocks)                                                                                             \
    for (int k = 0; k < (blocks); k++) {                                                                               \
        BLOCK_AT(V, high, k) = q[i] - (V){0};                                                                          \
        BLOCK_AT(V, base, k) = q_low[i] - (V){0};                                                                      \
    }

#define DRIFT(V, blocks)                                                                                               \
    for (int k = 0; k < (blocks); k++) {                                                                               \
        const V sum = start + BLOCK_OF(V, c, k) * drift, added = sum - start;                                          \
        const V lost = (start - (sum - added)) + (BLOCK_OF(V, c, k) * drift - added);                                  \
        BLOCK_AT(V, high, k) = sum;                                                                                    \
        BLOCK_AT(V, base, k) = (low + BLOCK_OF(V, c, k) * drift_low) + lost;                                           \
    }

JET_INLINE void start_half(const galerkin_nodes *nodes, int first, int count, const double q[], const double q_low[],
                           int lanes)
{
    double *high = nodes->high + first * lanes, *base = nodes->base + first * lanes;
    for (int i = 0; i < count; i++, high += lanes, base += lanes) {
        nodes->start[first + i] = q[i];
        ALL_LANES(lanes, SET_ALL)
    }
}

JET_INLINE void start_lanes(const galerkin_nodes *nodes, int n, const tvi_origin *origin, int lanes)
{
    start_half(nodes, 0, n, origin->q, origin->q_low, lanes);
    start_half(nodes, n, n, origin->p, origin->p_low, lanes);
}

BY_LANES(void, , start, (const galerkin_nodes *nodes, int n, const tvi_origin *origin), nodes, n, origin)

/* Rounded products with one and the same h repeat their errors, whose mean many steps show, if h is nearly a ratio of
 * small numbers, such as 0.1. So these are exact; that with sum L is rounded with `base`, with far smaller bits, which
 * is why `base` is not added to the sum: that ends on a grid, and its product with h near the same few places of
 * another. */
JET_INLINE void start_drifting_lanes(const galerkin_nodes *nodes, const double *c, const tvi_origin *origin,
                                     double *drifts, double *drifts_low, int lanes)
{
    double *high = nodes->high, *base = nodes->base;
    for (int u = 0; u < nodes->unknowns; u++, high += lanes, base += lanes) {
        const double scale = nodes->scale[u], start = origin->q[u], low = origin->q_low[u], p = origin->p[u];
        const double drift = scale * p, drift_low = fma(scale, p, -drift) + scale * origin->p_low[u];
        nodes->start[u] = start;
        drifts[u] = drift;
        drifts_low[u] = drift_low;
        ALL_LANES(lanes, DRIFT)
    }
}

BY_LANES(void, , start_drifting,
         (const galerkin_nodes *nodes, const double *c, const tvi_origin *origin, double *drift, double *drift_low),
         nodes, c, origin, drift, drift_low)

static void end_drifting(const galerkin_nodes *nodes, const galerkin_sums *sums, const double *drift,
                         const double *drift_low, const tvi_increments *by)
{
    for (int u = 0, unknowns = nodes->unknowns; u < unknowns; u++) {
        by->dq[u] =
            galerkin_rise(drift[u], drift_low[u], nodes->scale[u], sums->twice[u], sums->twice_low[u], &by->dq_low[u]);
        by->dp[u] = sums->once[u];
        by->dp_low[u] = sums->once_low[u];
    }
}

#define PLACE(V, S)                                                                                                    \
    {                                                                                                                  \
        const V theta = *(const V *)(p->theta + here);                                                                 \
        V row[TVI_GALERKIN_MAX_LANES];                                                                                 \
        for (int j = 0; j < lanes; j++) row[j] = *(const V *)(table + j * places + here);                              \
        for (int u = 0; u < count; u++) {                                                                              \
            V sums[CHAINS] = {0};                                                                                      \
            for (int j = 0; j < lanes; j++)                                                                            \
                sums[j % CHAINS] += row[j] * impulses[(size_t)u * (size_t)lanes + (size_t)j];                          \
            *(V *)(out + u * places + here) =                                                                          \
                start[u] + (theta * drift[u] + scale[u] * ((sums[0] + sums[1]) + (sums[2] + sums[3])));                \
        }                                                                                                              \
    }

JET_INLINE void place_count(const galerkin_places *p, const double *table, const double *impulses, double *restrict out,
                            int lanes, int places)
{
    const double *start = p->start, *drift = p->drift, *scale = p->scale;
    const int count = p->count;
    JET_BLOCKS(places, PLACE, );
}

JET_INLINE void place_lanes(const galerkin_places *p, const double *table, const double *impulses, double *out,
                            int lanes)
{
    if (p->places == TVI_SAMPLES) place_count(p, table, impulses, out, lanes, TVI_SAMPLES);
    else place_count(p, table, impulses, out, lanes, p->places);
}

BY_LANES(void, , place, (const galerkin_places *p, const double *table, const double *impulses, double *out), p, table,
         impulses, out)

#ifndef JET_EMITTED
#define LOOPS_OF(lanes)                                                                                                \
    {                                                                                                                  \
        move_##lanes, move_in_parts_##lanes, move_both_##lanes, predict_##lanes, go_round_##lanes, integrate_##lanes,  \
            start_##lanes, start_drifting_##lanes, end_drifting, tail, place_##lanes, NULL                             \
    }
const galerkin_loops JET_FOR_ISA(tvi_galerkin_loops)[GALERKIN_LOOPS] = {LOOPS_OF(1), LOOPS_OF(2), LOOPS_OF(4),
                                                                        LOOPS_OF(8), LOOPS_OF(most)};
#endif
