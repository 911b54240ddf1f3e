/* kernel_inner.h - Defines the part of kernel.h that solves the linear equations of a pass with second derivatives by
 * inner iterations (hamiltonian.c). An inner iteration multiplies the last change of the unknowns by the second
 * derivatives, which gives the change of the rates. From the change of the rates follow the change of the impulses at
 * the nodes, and the next change of the unknowns. Single precision is enough, and takes half the time of double
 * precision: the error that a pass leaves is larger than 2^-24 of its movement, except in the last pass, whose movement
 * is roundoff. Changes are relative to the sizes of the unknowns, so that the iterations do not depend on units. */

/* SINGLE is the single-precision vector with as many elements as V. ROW_VECTOR is the widest single-precision vector
 * that divides a row of LANES numbers. SINGLE_AT and PART_AT access such vectors in a row. */
#define SINGLE KERNEL_NAME(jet_single, V)
#if LANES % 8 == 0
#define ROW_VECTOR jet_single_jet_v8
#elif LANES % 4 == 0
#define ROW_VECTOR jet_single_jet_v4
#elif LANES % 2 == 0
#define ROW_VECTOR jet_single_jet_v2
#else
#define ROW_VECTOR jet_single_jet_v1
#endif
#define SINGLE_AT(row, v) (*(SINGLE *)((row) + (size_t)(v)*NUMBERS_OF(V)))
#define PART_AT(row, b)   (*(ROW_VECTOR *)((row) + (size_t)(b) * (sizeof(ROW_VECTOR) / sizeof(float))))
enum { NAME(vectors) = LANES / NUMBERS_OF(V), NAME(parts) = LANES * (int)sizeof(float) / (int)sizeof(ROW_VECTOR) };

/* ---- The changes of the impulses --------------------------------------------------------------------------------- */

/* Copies the second derivatives into packed_hessian, in single precision and relative to the sizes of the unknowns,
 * group by group. Element (row, column) is the change of the row's impulse by a change of the column's unknown.
 * unknown_change_per_impulse is 1 or -1 here. */
JET_INLINE void NAME(pack)(const galerkin_nodes *nodes, const lanes_inner_iterations *inner)
{
    const int *index = inner->index_in_hessian_block;
    float *packed = inner->packed_hessian;
    for (int first = 0, group; first < inner->hessian_row_count; first += group) {
        group = lanes_count_rows_summed_in_parallel(inner, first);
        for (int column = 0; column < inner->hessian_column_count; column++, index += group, packed += group * LANES)
            for (int v = 0; v < NAME(vectors); v++) {
                const V by_column =
                    (nodes->unknown_change_per_impulse[inner->unknown_of_row[column]] * inner->unknown_size[column]) *
                    BLOCK_OF(V, nodes->impulse_weight, v);
                for (int i = 0; i < group; i++) {
                    const V factor = inner->inverse_unknown_size[first + i] * by_column;
                    SINGLE_AT(packed + i * LANES, v) =
                        KERNEL_NAME(JET_NARROW, V)(factor * BLOCK_OF(V, inner->hessian_block + index[i], v));
                }
            }
    }
}

/* Sets `group` rows of `out`, from row `first` on, to the changes of the impulses that `change` of the unknowns
 * causes. */
JET_INLINE void NAME(compute_group)(const lanes_inner_iterations *inner, const float *change, int first, int group,
                                    float *out)
{
    const float *packed = inner->packed_hessian + first * inner->hessian_column_count * LANES;
    ROW_VECTOR sum[LANES_ROWS_PER_GROUP][NAME(parts)];
    for (int i = 0; i < group; i++)
        for (int b = 0; b < NAME(parts); b++) sum[i][b] = (ROW_VECTOR){0};
    for (int column = 0; column < inner->hessian_column_count; column++)
        for (int i = 0; i < group; i++, packed += LANES)
            for (int b = 0; b < NAME(parts); b++) sum[i][b] += PART_AT(packed, b) * PART_AT(change + column * LANES, b);
    for (int i = 0; i < group; i++)
        for (int b = 0; b < NAME(parts); b++) PART_AT(out + (first + i) * LANES, b) = sum[i][b];
}

/* Sets the rows of `out` up to the end of the group that contains row end_row - 1. They become the changes of the
 * impulses that `change` of the unknowns causes. The size of a full group is a constant in the call. */
JET_INLINE void NAME(compute_impulses)(const lanes_inner_iterations *inner, const float *change, int end_row,
                                       float *out)
{
    for (int first = 0; first < end_row; first += LANES_ROWS_PER_GROUP) {
        const int group = lanes_count_rows_summed_in_parallel(inner, first);
        if (group == LANES_ROWS_PER_GROUP) NAME(compute_group)(inner, change, first, LANES_ROWS_PER_GROUP, out);
        else NAME(compute_group)(inner, change, first, group, out);
    }
}

/* ---- The changes of the unknowns --------------------------------------------------------------------------------- */

/* Computes last_unknown_change from last_impulse_change, and adds it to total_unknown_change. Returns the sum of the
 * squares of last_unknown_change. */
JET_INLINE double NAME(change_by_impulses)(const lanes_inner_iterations *inner)
{
    enum { IS_ONE = NAME(parts) == 1 };
    const float *impulse = inner->last_impulse_change, *matrix = inner->impulse_to_unknown_change_matrix;
    float *change = inner->last_unknown_change, *total = inner->total_unknown_change;
    ROW_VECTOR squares = {0}, column[LANES];
    float parts[sizeof squares / sizeof(float)];
    for (int j = 0; j < (IS_ONE ? LANES : 0); j++) column[j] = PART_AT(matrix + j * LANES, 0) + (ROW_VECTOR){0};
    for (int i = 0; i < inner->hessian_column_count; i++, impulse += LANES, change += LANES, total += LANES)
        for (int b = 0; b < NAME(parts); b++) {
            ROW_VECTOR sum[PARTIAL_SUM_COUNT] = {0};
            for (int j = 0; j < LANES; j++)
                sum[j % PARTIAL_SUM_COUNT] += (IS_ONE ? column[j] : PART_AT(matrix + j * LANES, b)) * impulse[j];
            sum[0] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
            squares += sum[0] * sum[0];
            PART_AT(change, b) = sum[0];
            PART_AT(total, b) += sum[0];
        }
    PART_AT(parts, 0) = squares;
    for (size_t half = sizeof parts / sizeof *parts / 2; half > 0; half /= 2)
        for (size_t i = 0; i < half; i++) parts[i] += parts[i + half];
    return (double)parts[0];
}

/* Sets last_impulse_change to the impulses of the current rates minus the impulses of the last movement, relative to
 * the sizes of the unknowns and in units of INNER_MOVEMENT_UNIT. Sets total_unknown_change to 0. */
JET_INLINE void NAME(begin_inner_iterations)(const galerkin_nodes *nodes, const lanes_inner_iterations *inner,
                                             const double *rates, const int slot[])
{
    for (int i = 0; i < inner->hessian_column_count; i++) {
        const int u = inner->unknown_of_row[i];
        const double *solver = rates + slot[u] * LANES, *old = nodes->impulses + u * LANES;
        const double factor = inner->inverse_unknown_size[i] / INNER_MOVEMENT_UNIT;
        for (int v = 0; v < NAME(vectors); v++) {
            const V impulse = BLOCK_OF(V, nodes->impulse_weight, v) * BLOCK_OF(V, solver, v);
            SINGLE_AT(inner->last_impulse_change + i * LANES, v) =
                KERNEL_NAME(JET_NARROW, V)(factor * (impulse - BLOCK_OF(V, old, v)));
            SINGLE_AT(inner->total_unknown_change + i * LANES, v) = (SINGLE){0};
        }
    }
}

/* Converts total_impulse_change to the units of the impulses, and stores it in `changes`. */
JET_INLINE void NAME(end_inner_iterations)(const lanes_inner_iterations *inner, double *changes)
{
    for (int i = 0; i < inner->hessian_row_count; i++)
        for (int v = 0; v < NAME(vectors); v++)
            BLOCK_AT(V, changes + inner->unknown_of_row[i] * LANES, v) =
                INNER_MOVEMENT_UNIT * inner->unknown_size[i] *
                KERNEL_NAME(JET_WIDEN, V)(SINGLE_AT(inner->total_impulse_change + i * LANES, v));
}

KERNEL_FUNCTION void NAME(run_inner_iterations)(const galerkin_nodes *nodes, const lanes_inner_iterations *inner,
                                                const double *rates, const int slot[], bool is_hessian_new,
                                                double last_movement, double smallest_goal, double *changes)
{
    double before = INFINITY, earlier;
    int count = 0;
    if (is_hessian_new) NAME(pack)(nodes, inner);
    NAME(begin_inner_iterations)(nodes, inner, rates, slot);
    const double first = INNER_MOVEMENT_UNIT * INNER_MOVEMENT_UNIT * NAME(change_by_impulses)(inner);
    const double second_order_goal =
        GALERKIN_INNER_GOAL * first * (is_hessian_new ? first : last_movement) / (nodes->unknown_count * LANES);
    const double goal = tvi_larger(second_order_goal, smallest_goal);
    double now = first;
    do {
        earlier = before;
        before = now;
        NAME(compute_impulses)(inner, inner->last_unknown_change, inner->hessian_column_count,
                               inner->last_impulse_change);
        now = INNER_MOVEMENT_UNIT * INNER_MOVEMENT_UNIT * NAME(change_by_impulses)(inner);
    } while (++count < GALERKIN_MAX_INNER_ITERATIONS && (now * now > goal * before || now * before > goal * earlier) &&
             (now < before || now < earlier));
    NAME(compute_impulses)(inner, inner->total_unknown_change, inner->hessian_row_count, inner->total_impulse_change);
    if (now <= first) NAME(end_inner_iterations)(inner, changes);
    else memset(changes, 0, (size_t)(nodes->unknown_count * LANES) * sizeof *changes);
}

#undef SINGLE
#undef SINGLE_AT
#undef ROW_VECTOR
#undef PART_AT
