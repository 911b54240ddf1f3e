/* kernel_ends.h - the part of kernel.h's text with which passes and steps end. */

/* ---- The sums that a step ends with ------------------------------------------------------------------------------ */

/* A column has members of one unknown, or unknowns of one member. Sums are compensated by two-sums: what an addition
 * loses is added up by itself, and what the sum of both loses is its second part. Nodes in turns make two chains,
 * which do not wait for each other. */
typedef struct {
    COLUMN total[2], lost[2];
} NAME(two_chains);

/* *total += weight *term; *lost += what that loses. */
JET_INLINE void NAME(add_two_sum)(COLUMN *total, COLUMN *lost, double weight, const COLUMN *term)
{
    const COLUMN by = weight - (COLUMN){0}, next = FUSED(COLUMN, by, *term, *total), added = next - *total;
    *lost += (*total - (next - added)) + FUSED(COLUMN, by, *term, -added);
    *total = next;
}

JET_INLINE void NAME(end_chains)(NAME(two_chains) *of, double *whole, double *low)
{
    NAME(add_two_sum)(&of->total[0], &of->lost[0], 1, &of->total[1]);
    const COLUMN less = of->lost[0] + of->lost[1], both = of->total[0] + less;
    *(COLUMN *)whole = both;
    *(COLUMN *)low = less - (both - of->total[0]);
}

/* The rows of a column from unknown u on; behind the last unknown there are its own. */
enum { NAME(rows) = MEMBERS ? 1 : NUMBERS_OF(COLUMN) };
JET_INLINE void NAME(set_rows)(const galerkin_nodes *nodes, int u, const double *row[], galerkin_shape s, size_t here)
{
    (void)here;
    for (int k = 0; k < NAME(rows); k++)
        row[k] = ROW(nodes->impulse, u + k < nodes->unknowns ? u + k : nodes->unknowns - 1);
}

/* The impulses of node j. */
JET_INLINE COLUMN NAME(column)(const double *const row[], int j, galerkin_shape s)
{
    (void)s;
#if MEMBERS
    return NUMBER(row[0], j);
#elif defined(__AVX__)
    return (COLUMN){row[0][j], row[1][j], row[2][j], row[3][j]};
#else
    return (COLUMN){row[0][j], row[1][j]};
#endif
}

JET_INLINE void NAME(integrate_all)(const galerkin_nodes *of, const galerkin_weights *weights,
                                    const galerkin_sums *sums, galerkin_shape s, size_t here)
{
    const galerkin_nodes copy = *of, *const nodes = &copy;
    (void)here;
    const int count = MEMBERS ? s.points : s.lanes;
    for (int u = 0; u < nodes->unknowns; u += NAME(rows)) {
        const size_t at = (size_t)u * (size_t)s.width + here;
        const COLUMN none = {0};
        const double *row[NAME(rows)];
        NAME(two_chains) once = {{none, none}, {none, none}}, twice = once;
        COLUMN last = none;
        NAME(set_rows)(nodes, u, row, s, here);
        for (int j = 0; j < count; j++) {
            const COLUMN impulse = NAME(column)(row, j, s);
            NAME(add_two_sum)(&once.total[j % 2], &once.lost[j % 2], 1, &impulse);
            NAME(add_two_sum)(&twice.total[j % 2], &twice.lost[j % 2], weights->late[j], &impulse);
            last = FUSED(COLUMN, weights->last[j] - none, impulse, last);
        }
        const COLUMN first = NAME(column)(row, 0, s);
        const COLUMN final = NAME(column)(row, s.points - 1, s);
        NAME(end_chains)(&once, sums->once + at, sums->once_low + at);
        NAME(end_chains)(&twice, sums->twice + at, sums->twice_low + at);
        *(COLUMN *)(sums->last + at) = JET_ABS(COLUMN, last);
        *(COLUMN *)(sums->reach + at) = JET_ABS(COLUMN, first) + JET_ABS(COLUMN, final);
    }
}

/* ---- When passes may end ----------------------------------------------------------------------------------------- */

#if MEMBERS
#define JUDGED(name)       members_##name
#define REAL               V
#define TRUTH              JET_MASK(jet_widest)
#define ABOVE(a, b)        ((a) > (b))
#define AT_MOST(a, b)      ((a) <= (b))
#define SAME(a, b)         ((a) == (b))
#define NOT(a)             (~(a))
#define IF(which, yes, no) JET_CHOOSE(V, which, yes, no)
#include "algebra/judge.h"
#endif
