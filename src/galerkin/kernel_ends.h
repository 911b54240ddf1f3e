/* kernel_ends.h - Sums the impulses of a step, h b_j F_j at node j with the force F_j, over the nodes, with compensated
 * sums. The increments of the step and its tail follow from the sums. It is a part of kernel.h. */

/* ---- The sums of the impulses at the end of a step --------------------------------------------------------------- */

/* A column is a vector of unknowns at one node. The sums over nodes are compensated: the rounding errors of the
 * additions are summed separately, and the low-order part of the result is the rounding error of adding the two sums.
 * Odd and even nodes have separate partial sums, which the processor computes in parallel. */
typedef struct {
    COLUMN total[2], loss[2];
} NAME(compensated_sums);

/* Adds weight (*term) to *total, and the rounding error of this addition to *rounding_error. */
JET_INLINE void NAME(add_compensated)(COLUMN *total, COLUMN *rounding_error, double weight, const COLUMN *term)
{
    const COLUMN factor = weight - (COLUMN){0}, next = FUSED(COLUMN, factor, *term, *total), added = next - *total;
    *rounding_error += (*total - (next - added)) + FUSED(COLUMN, factor, *term, -added);
    *total = next;
}

JET_INLINE void NAME(join_compensated_sums)(NAME(compensated_sums) *sums, double *whole, double *low)
{
    NAME(add_compensated)(&sums->total[0], &sums->loss[0], 1, &sums->total[1]);
    const COLUMN less = sums->loss[0] + sums->loss[1], both = sums->total[0] + less;
    *(COLUMN *)whole = both;
    *(COLUMN *)low = less - (both - sums->total[0]);
}

/* NAME(rows) is the number of unknowns in a column. NAME(set_rows) sets row[k] to the impulses of unknown u + k, or of
 * the last unknown if there are fewer. */
enum { NAME(rows) = NUMBERS_OF(COLUMN) };
JET_INLINE void NAME(set_rows)(const galerkin_nodes *nodes, int u, const double *row[])
{
    for (int k = 0; k < NAME(rows); k++)
        row[k] = ROW(nodes->impulses, u + k < nodes->unknown_count ? u + k : nodes->unknown_count - 1);
}

/* Returns the impulses of node j in the rows row[0], row[1], .. as a vector. */
JET_INLINE COLUMN NAME(column)(const double *const row[], int j)
{
#if defined(__AVX__)
    return (COLUMN){row[0][j], row[1][j], row[2][j], row[3][j]};
#else
    return (COLUMN){row[0][j], row[1][j]};
#endif
}

JET_INLINE void NAME(sum_all_impulses)(const galerkin_nodes *nodes,
                                       const galerkin_double_integral_and_tail_weights *weights,
                                       const galerkin_impulse_sums *sums)
{
    for (int u = 0; u < nodes->unknown_count; u += NAME(rows)) {
        const COLUMN none = {0};
        const double *row[NAME(rows)];
        NAME(compensated_sums) once = {{none, none}, {none, none}}, twice = once;
        COLUMN last = none;
        NAME(set_rows)(nodes, u, row);
        for (int j = 0; j < LANES; j++) {
            const COLUMN impulse = NAME(column)(row, j);
            NAME(add_compensated)(&once.total[j % 2], &once.loss[j % 2], 1, &impulse);
            NAME(add_compensated)(&twice.total[j % 2], &twice.loss[j % 2], weights->one_minus_abscissa[j], &impulse);
            last = FUSED(COLUMN, weights->last_term_weight[j] - none, impulse, last);
        }
        const COLUMN first = NAME(column)(row, 0);
        const COLUMN final = NAME(column)(row, NODE_COUNT_OF(nodes) - 1);
        NAME(join_compensated_sums)(&once, sums->rate_integral + u, sums->rate_integral_low + u);
        NAME(join_compensated_sums)(&twice, sums->rate_double_integral + u, sums->rate_double_integral_low + u);
        *(COLUMN *)(sums->last_term + u) = JET_ABS(COLUMN, last);
        *(COLUMN *)(sums->end_impulse_size + u) = JET_ABS(COLUMN, first) + JET_ABS(COLUMN, final);
    }
}
