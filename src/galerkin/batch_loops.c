/* batch_loops.c - see batch_loops.h. */
#include "galerkin/batch_vectors.h"

#include <math.h>

/* ---- Nodes in chains --------------------------------------------------------------------------------------------- */

/* BODY(V, count) for nodes first .. first + count - 1: in chains that do not wait for each other. */
#define IN_NODES(BODY, V)                                                                                              \
    int first = 0;                                                                                                     \
    for (; first + 8 <= points; first += 8) BODY(V, 8)                                                                 \
    for (; first + 4 <= points; first += 4) BODY(V, 4)                                                                 \
    for (; first < points; first++) BODY(V, 1)

/* sum[i] += sum_j matrix[j][first + i] (row j of the impulses of the unknown). */
#define ADD_PRODUCT(V, count, sum, matrix, impulses)                                                                   \
    for (int j = 0; j < points; j++) {                                                                                 \
        const V of_node = ROW_OF(V, impulses, u * points + j);                                                         \
        const double *column = (matrix) + j * stride + first;                                                          \
        for (int i = 0; i < (count); i++) sum[i] += column[i] * of_node;                                               \
    }

/* name(parameters) calls name_sized(..., points, stride, width), for the usual ones a function that knows them. */
#define OWN static __attribute__((noinline))
#define BY_SIZE(name, parameters, ...)                                                                                 \
    OWN void name##_8 parameters { name##_sized(__VA_ARGS__, 8, 8, 8); }                                               \
    OWN void name##_16 parameters { name##_sized(__VA_ARGS__, 8, 8, 16); }                                             \
    OWN void name##_32 parameters { name##_sized(__VA_ARGS__, 8, 8, 32); }                                             \
    static void name parameters                                                                                        \
    {                                                                                                                  \
        const int points = nodes->points, stride = nodes->stride, width = nodes->width;                                \
        if (points == 8 && width == 8) name##_8(__VA_ARGS__);                                                          \
        else if (points == 8 && width == 16) name##_16(__VA_ARGS__);                                                   \
        else if (points == 8 && width == 32) name##_32(__VA_ARGS__);                                                   \
        else name##_sized(__VA_ARGS__, points, stride, (size_t)width);                                                 \
    }

/* ---- Passes ------------------------------------------------------------------------------------------------------ */

/* At a node of the unknown at hand, whose arrays begin at the block of members. */
#define NODE_AT(V, array, node) (*(V *)((array) + (size_t)(node)*width))
#define NODE_OF(V, array, node) (*(const V *)((array) + (size_t)(node)*width))

/* By how much the impulse changes: by nothing where a member moves no more. */
#define DRIVE(V, node, change)                                                                                         \
    {                                                                                                                  \
        const V none = {0}, was = is_first ? none : NODE_OF(V, impulse, node),                                         \
                is = weight[node] * NODE_OF(V, drive, node), now = CHOOSE(V, moving, is, was);                         \
        NODE_AT(V, impulse, node) = now;                                                                               \
        change = now - was;                                                                                            \
    }

/* halves.h, of the changes. */
#define FOLD(V, j)                                                                                                     \
    {                                                                                                                  \
        V one, other = {0};                                                                                            \
        DRIVE(V, j, one)                                                                                               \
        if (2 * j + 1 < points) DRIVE(V, points - 1 - j, other)                                                        \
        first[j] = is_crossed ? one - other : one + other;                                                             \
        second[j] = is_crossed ? one + other : one - other;                                                            \
        total += first[j];                                                                                             \
        shift += halves->shift[j] * second[j];                                                                         \
    }

#define ADD_HALF(sum, matrix, part)                                                                                    \
    for (int j = 0; j < pairs; j++)                                                                                    \
        for (int i = 0; i < pairs; i++) sum[i] += halves->matrix[j * MOST_PAIRS + i] * part[j];

/* What is added becomes smaller with each pass. So it is added to the low part: what an unknown, which is larger, loses
 * of it is always on the same side. */
#define MOVE_NODE(V, node, more, squares)                                                                              \
    {                                                                                                                  \
        const V sum = NODE_OF(V, low, node) + scale * (more), place = NODE_OF(V, high, node) + sum,                    \
                change = place - NODE_OF(V, x, node);                                                                  \
        squares += change * change;                                                                                    \
        NODE_AT(V, low, node) = sum;                                                                                   \
        NODE_AT(V, x, node) = place;                                                                                   \
    }

#define MOVE_UNKNOWN(V)                                                                                                \
    {                                                                                                                  \
        const double scale = nodes->scale[u], *drive = drives + (size_t)(slot[u] * points) * width + here;             \
        const V inverse_size = ROW_OF(V, nodes->inverse_size, u);                                                      \
        V first[MOST_PAIRS], second[MOST_PAIRS], even[MOST_PAIRS] = {0}, odd[MOST_PAIRS] = {0};                        \
        V total = {0}, shift = {0}, squares[2] = {0};                                                                  \
        for (int j = 0; j < pairs; j++) FOLD(V, j)                                                                     \
        ADD_HALF(even, even, first)                                                                                    \
        ADD_HALF(odd, odd, second)                                                                                     \
        for (int i = 0; i < pairs; i++) {                                                                              \
            even[i] += shift;                                                                                          \
            odd[i] += halves->slope[i] * total;                                                                        \
            MOVE_NODE(V, i, even[i] + odd[i], squares[0])                                                              \
            if (2 * i + 1 < points) MOVE_NODE(V, points - 1 - i, even[i] - odd[i], squares[1])                         \
        }                                                                                                              \
        size += (squares[0] + squares[1]) * (inverse_size * inverse_size);                                             \
    }

/* Where none of the block moves, all stays as it is. */
#define MOVE(V, S)                                                                                                     \
    {                                                                                                                  \
        const size_t of_unknown = (size_t)points * width;                                                              \
        const WHICH(V) moving = WHICH_OF(V, nodes->is_moving);                                                         \
        const double *high = nodes->high + here;                                                                       \
        double *x = nodes->x + here, *impulse = nodes->impulse + here, *low = nodes->low + here;                       \
        V size = {0};                                                                                                  \
        if (ARE_ALL(V, NOT(V, moving))) continue;                                                                      \
        for (int u = 0; u < unknowns;                                                                                  \
             u++, high += of_unknown, x += of_unknown, impulse += of_unknown, low += of_unknown)                       \
            MOVE_UNKNOWN(V)                                                                                            \
        ROW_AT(V, moved, 0) = size;                                                                                    \
    }

JET_INLINE void move_halves(const galerkin_batch_nodes *nodes, const galerkin_halves *halves, const double *drives,
                            const int slot[], double moved[], int points, size_t width, bool is_crossed, bool is_first)
{
    const int unknowns = nodes->unknowns, pairs = (points + 1) / 2;
    const double *weight = nodes->weight;
    JET_EIGHTS((int)width, MOVE, )
}

JET_INLINE void move_sized(const galerkin_batch_nodes *nodes, const galerkin_halves *halves, const double *drives,
                           const int slot[], double moved[], int points, int stride, size_t width)
{
    (void)stride;
    if (halves->is_crossed && nodes->is_first)
        move_halves(nodes, halves, drives, slot, moved, points, width, true, true);
    else if (halves->is_crossed) move_halves(nodes, halves, drives, slot, moved, points, width, true, false);
    else if (nodes->is_first) move_halves(nodes, halves, drives, slot, moved, points, width, false, true);
    else move_halves(nodes, halves, drives, slot, moved, points, width, false, false);
}

BY_SIZE(move,
        (const galerkin_batch_nodes *nodes, const galerkin_halves *halves, const double *drives, const int slot[],
         double moved[]),
        nodes, halves, drives, slot, moved)

#define PREDICT_NODES(V, count)                                                                                        \
    {                                                                                                                  \
        V sum[count] = {0};                                                                                            \
        ADD_PRODUCT(V, count, sum, matrix, last)                                                                       \
        ADD_PRODUCT(V, count, sum, of_before, before)                                                                  \
        for (int i = 0; i < (count); i++) {                                                                            \
            const int row = u * points + first + i;                                                                    \
            ROW_AT(V, x, row) = ROW_OF(V, high, row) + (ROW_OF(V, low, row) + scale[u] * sum[i]);                      \
        }                                                                                                              \
    }

#define PREDICT(V, S)                                                                                                  \
    for (int u = 0; u < unknowns; u++) {                                                                               \
        IN_NODES(PREDICT_NODES, V)                                                                                     \
    }

JET_INLINE void predict_sized(const galerkin_batch_nodes *nodes, const double *matrix, const double *last,
                              const double *before, int points, int stride, size_t width)
{
    const int unknowns = nodes->unknowns;
    const double *high = nodes->high, *low = nodes->low, *scale = nodes->scale, *of_before = matrix + stride * stride;
    double *x = nodes->x;
    JET_EIGHTS((int)width, PREDICT, )
}

BY_SIZE(predict, (const galerkin_batch_nodes *nodes, const double *matrix, const double *last, const double *before),
        nodes, matrix, last, before)

#define SIZES                                                                                                          \
    const size_t width = (size_t)nodes->width;                                                                         \
    const int points = nodes->points, unknowns = nodes->unknowns

/* ---- The end of a step ------------------------------------------------------------------------------------------- */

/* Two-sums: what each addition loses is collected. */
#define ADD_TWO_SUM(V, total, lost, term)                                                                              \
    {                                                                                                                  \
        const V adds = (term), next = (total) + adds, added = next - (total);                                          \
        (lost) += ((total) - (next - added)) + (adds - added);                                                         \
        (total) = next;                                                                                                \
    }

/* once and twice: nodes in turns make two chains, which do not wait for each other. */
#define ADD_NODE(V)                                                                                                    \
    {                                                                                                                  \
        const V of_node = ROW_OF(V, impulse, u * points + j);                                                          \
        const V of_twice = weights->pair[j * OF_PAIR + 1] * of_node;                                                   \
        sum += weights->last[j] * of_node;                                                                             \
        if (j < 2) {                                                                                                   \
            once[j] = of_node;                                                                                         \
            twice[j] = of_twice;                                                                                       \
        } else {                                                                                                       \
            ADD_TWO_SUM(V, once[j % 2], once_lost[j % 2], of_node)                                                     \
            ADD_TWO_SUM(V, twice[j % 2], twice_lost[j % 2], of_twice)                                                  \
        }                                                                                                              \
    }

#define SUM_UP(V, row, row_low, total, lost)                                                                           \
    {                                                                                                                  \
        ADD_TWO_SUM(V, total[0], lost[0], total[1])                                                                    \
        const V less = lost[0] + lost[1], whole = total[0] + less;                                                     \
        ROW_AT(V, row, u) = whole;                                                                                     \
        ROW_AT(V, row_low, u) = less - (whole - total[0]);                                                             \
    }

#define INTEGRATE(V, S)                                                                                                \
    for (int u = 0; u < unknowns; u++) {                                                                               \
        V sum = {0}, once[2] = {0}, once_lost[2] = {0}, twice[2] = {0}, twice_lost[2] = {0};                           \
        for (int j = 0; j < points; j++) ADD_NODE(V)                                                                   \
        SUM_UP(V, sums->once, sums->once_low, once, once_lost)                                                         \
        SUM_UP(V, sums->twice, sums->twice_low, twice, twice_lost)                                                     \
        ROW_AT(V, sums->last, u) = JET_ABS(V, sum);                                                                    \
        ROW_AT(V, sums->reach, u) =                                                                                    \
            JET_ABS(V, ROW_OF(V, impulse, u * points)) + JET_ABS(V, ROW_OF(V, impulse, (u + 1) * points - 1));         \
    }

JET_INLINE void integrate_sized(const galerkin_batch_nodes *nodes, const galerkin_weights *weights,
                                const galerkin_sums *sums, int points, int stride, size_t width)
{
    const int unknowns = nodes->unknowns;
    const double *impulse = nodes->impulse;
    (void)stride;
    JET_EIGHTS((int)width, INTEGRATE, )
}

BY_SIZE(integrate, (const galerkin_batch_nodes *nodes, const galerkin_weights *weights, const galerkin_sums *sums),
        nodes, weights, sums)

#define CHOOSE_ROWS(V, S)                                                                                              \
    for (int row = 0; row < rows; row++)                                                                               \
        ROW_AT(V, to, row) = CHOOSE(V, WHICH_OF(V, nodes->in_lanes), ROW_OF(V, from, row), ROW_OF(V, to, row));

static void choose(const galerkin_batch_nodes *nodes, int rows, const double *from, double *to)
{
    const size_t width = (size_t)nodes->width;
    JET_EIGHTS(nodes->width, CHOOSE_ROWS, )
}

/* Products with the size of the step are exact, as in loops.c. */
static void end_drifting(const galerkin_batch_nodes *nodes, const galerkin_sums *sums,
                         const galerkin_batch_drift *drift, double *restrict dq, double *restrict dq_low)
{
    const size_t width = (size_t)nodes->width, unknowns = (size_t)nodes->unknowns;
    for (size_t u = 0; u < unknowns; u++) {
        const double scale = nodes->scale[u];
        for (size_t at = u * width; at < (u + 1) * width; at++)
            dq[at] = galerkin_rise(drift->high[at], drift->low[at], scale, sums->twice[at], sums->twice_low[at],
                                   &dq_low[at]);
    }
}

static void end(const galerkin_batch_nodes *nodes, int first, int count, const double *once, double *restrict rise)
{
    const size_t width = (size_t)nodes->width;
    for (int i = 0; i < count; i++, once += width, rise += width)
        for (size_t m = 0; m < width; m++) rise[m] = nodes->scale[first + i] * once[m];
}

/* ---- The start of a step ----------------------------------------------------------------------------------------- */

static void start(const galerkin_batch_nodes *nodes, int first, int count, const double *q, const double *q_low)
{
    const size_t width = (size_t)nodes->width, points = (size_t)nodes->points;
    double *restrict to = nodes->start + (size_t)first * width;
    double *restrict high = nodes->high + (size_t)first * points * width;
    double *restrict low = nodes->low + (size_t)first * points * width;
    for (size_t k = 0; k < (size_t)count * width; k++) to[k] = q[k];
    for (int i = 0; i < count; i++, q += width, q_low += width)
        for (size_t j = 0; j < points; j++, high += width, low += width)
            for (size_t m = 0; m < width; m++) {
                high[m] = q[m];
                low[m] = q_low[m];
            }
}

/* Products with the size of the step are exact, as in loops.c. */
JET_INLINE void set_drift(size_t width, double scale, const double *restrict p, const double *restrict p_low,
                          double *restrict high, double *restrict low)
{
    for (size_t m = 0; m < width; m++) {
        high[m] = scale * p[m];
        low[m] = fma(scale, p[m], -high[m]) + scale * p_low[m];
    }
}

/* As that of loops.c. */
#define DRIFT(V, j)                                                                                                    \
    {                                                                                                                  \
        const V sum = start + c[j] * drifted, added = sum - start;                                                     \
        const V lost = (start - (sum - added)) + (c[j] * drifted - added);                                             \
        ROW_AT(V, nodes->high, u *points + (j)) = sum;                                                                 \
        ROW_AT(V, nodes->low, u *points + (j)) = (q_low + c[j] * drifted_low) + lost;                                  \
    }

#define START_DRIFTING(V, S)                                                                                           \
    {                                                                                                                  \
        const V start = ROW_OF(V, origin->q, u), q_low = ROW_OF(V, origin->q_low, u);                                  \
        const V drifted = ROW_OF(V, drift->high, u), drifted_low = ROW_OF(V, drift->low, u);                           \
        ROW_AT(V, nodes->start, u) = start;                                                                            \
        for (int j = 0; j < points; j++) DRIFT(V, j)                                                                   \
    }

JET_INLINE void start_drifting_sized(const galerkin_batch_nodes *nodes, const double c[],
                                     const tvi_batch_origin *origin, const galerkin_batch_drift *drift, int points,
                                     int stride, size_t width)
{
    (void)stride;
    for (int u = 0; u < nodes->unknowns; u++) {
        const size_t row = (size_t)u * width;
        set_drift(width, nodes->scale[u], origin->p + row, origin->p_low + row, drift->high + row, drift->low + row);
        JET_EIGHTS((int)width, START_DRIFTING, )
    }
}

BY_SIZE(start_drifting,
        (const galerkin_batch_nodes *nodes, const double c[], const tvi_batch_origin *origin,
         const galerkin_batch_drift *drift),
        nodes, c, origin, drift)

/* As galerkin_set_sizes_of, each member alone. */
#define SIZE_OF(V, u)                                                                                                  \
    JET_ABS(V, ROW_OF(V, nodes->start, u)) +                                                                           \
        JET_ABS(V, ROW_OF(V, nodes->x, ((u) + 1) * points - 1) - ROW_OF(V, nodes->start, u))
#define LEAST_OF(V, largest) CHOOSE(V, IS_ABOVE(V, largest, none), TVI_GALERKIN_LEAST_SHARE *largest, none + 1)
#define LARGEST_OF(V, size, largest)                                                                                   \
    largest = CHOOSE(V, IS_ABOVE(V, ROW_OF(V, size, i), largest), ROW_OF(V, size, i), largest);
#define SET_SIZES(V, S)                                                                                                \
    {                                                                                                                  \
        const V none = {0};                                                                                            \
        V largest_q = none, largest_p = none;                                                                          \
        for (const int *at = member; at < end; at++) {                                                                 \
            const int i = *at;                                                                                         \
            ROW_AT(V, of_q, i) = SIZE_OF(V, i);                                                                        \
            LARGEST_OF(V, of_q, largest_q)                                                                             \
            if (!has_momenta) continue;                                                                                \
            ROW_AT(V, of_p, i) = SIZE_OF(V, n + i);                                                                    \
            LARGEST_OF(V, of_p, largest_p)                                                                             \
        }                                                                                                              \
        const V least_q = LEAST_OF(V, largest_q), least_p = LEAST_OF(V, largest_p);                                    \
        for (const int *at = member; at < end; at++) {                                                                 \
            const V q = ROW_OF(V, of_q, *at);                                                                          \
            ROW_AT(V, of_q, *at) = 1 / (q + least_q);                                                                  \
            if (!has_momenta) continue;                                                                                \
            const V own = nodes->per_movement[*at] * least_q;                                                          \
            ROW_AT(V, of_p, *at) = 1 / (ROW_OF(V, of_p, *at) + CHOOSE(V, IS_ABOVE(V, least_p, own), own, least_p));    \
        }                                                                                                              \
    }

static void set_sizes(const galerkin_batch_nodes *nodes, int n)
{
    SIZES;
    const bool has_momenta = unknowns > n;
    double *of_q = nodes->inverse_size, *of_p = of_q + (size_t)n * width;
    const int *member = nodes->parts.member, *const all = member;
    for (int k = 0; k < nodes->parts.count; k++) {
        const int *const end = all + nodes->parts.end[k];
        JET_EIGHTS(nodes->width, SET_SIZES, )
        member = end;
    }
}

/* ---- The tail ---------------------------------------------------------------------------------------------------- */

/* What is in the registers is not looked for in memory after each store. */
JET_INLINE void tails_of(const galerkin_motion *motion, size_t width, bool is_separable, double *restrict share,
                         double *restrict ratio)
{
    const galerkin_motion of = *motion;
    const size_t n = (size_t)of.n, momenta = is_separable ? 0 : n * width;
    for (size_t i = 0; i < n; i++) {
        const double scale = of.scale[i], per_scale = of.per_scale[i];
        for (size_t at = i * width; at < (i + 1) * width; at++) {
            const tvi_tail_part part = galerkin_tail_part(&of, is_separable, scale, per_scale, at, at + momenta);
            share[at] = tvi_tail_share(&part, is_separable || of.has_masses);
            ratio[at] = tvi_tail_ratio(&part);
        }
    }
}

static void tail(const galerkin_motion *of, int width, double *share, double *ratio, double *out)
{
    if (of->is_separable) tails_of(of, (size_t)width, true, share, ratio);
    else tails_of(of, (size_t)width, false, share, ratio);
    tvi_tails_of_members(&of->parts, width, share, ratio, out);
}

const galerkin_batch_loops JET_FOR_ISA(tvi_galerkin_batch_loops) = {
    start,     start_drifting, set_sizes, predict,      move, tvi_galerkin_batch_begin, tvi_galerkin_batch_judge,
    integrate, choose,         end,       end_drifting, tail};
