/* kernel_rounds.h - Defines the part of kernel.h that makes the inner rounds of a pass with second derivatives
 * (hamiltonian.c). The rounds are in single precision, in half the time: the error that a pass leaves is larger than
 * 2^-24 of its movement, except in the last pass, whose movement is roundoff. Movements are relative to the sizes of
 * the unknowns, so that the rounds do not depend on units. The first round starts from the difference between the
 * new impulses and those from which the unknowns were computed, which is rounded to single precision after it is
 * taken. */

/* SINGLE is the single-precision vector with as many elements as V. ROW_VECTOR is the widest single-precision vector
 * that divides a row of LANES numbers. SINGLE_AT and PART_AT access such vectors in a row. */
#define SINGLE KERNEL_NAME(single, V)
#if LANES % 8 == 0
#define ROW_VECTOR single_jet_v8
#elif LANES % 4 == 0
#define ROW_VECTOR single_jet_v4
#elif LANES % 2 == 0
#define ROW_VECTOR single_jet_v2
#else
#define ROW_VECTOR single_jet_v1
#endif
#define SINGLE_AT(row, v) (*(SINGLE *)((row) + (size_t)(v)*NUMBERS_OF(V)))
#define PART_AT(row, b)   (*(ROW_VECTOR *)((row) + (size_t)(b) * (sizeof(ROW_VECTOR) / sizeof(float))))
enum { NAME(vectors) = LANES / NUMBERS_OF(V), NAME(parts) = LANES * (int)sizeof(float) / (int)sizeof(ROW_VECTOR) };

/* ---- What drives the rows ---------------------------------------------------------------------------------------- */

/* Copies the second derivatives into packed_hessian, in single precision and relative to the sizes of the unknowns,
 * group by group. Element (row, column) is the change of the row's impulse by a change of the column's unknown.
 * impulse_scale is 1 or -1 here. */
JET_INLINE void NAME(pack)(const galerkin_nodes *nodes, const lanes_inner_rounds *rounds)
{
    const int *index = rounds->hessian_index;
    float *packed = rounds->packed_hessian;
    for (int first = 0, group; first < rounds->row_count; first += group) {
        group = lanes_row_group_size(rounds, first);
        for (int column = 0; column < rounds->column_count; column++, index += group, packed += group * LANES)
            for (int v = 0; v < NAME(vectors); v++) {
                const V by_column =
                    (nodes->impulse_scale[rounds->unknown_of_row[column]] * rounds->unknown_size[column]) *
                    BLOCK_OF(V, nodes->impulse_weight, v);
                for (int i = 0; i < group; i++) {
                    const V factor = rounds->inverse_unknown_size[first + i] * by_column;
                    SINGLE_AT(packed + i * LANES, v) =
                        KERNEL_NAME(NARROW, V)(factor * BLOCK_OF(V, rounds->hessian_block + index[i], v));
                }
            }
    }
}

/* Sets `group` rows of `out` from `first` on to the impulses that follow from `change`. */
JET_INLINE void NAME(compute_group)(const lanes_inner_rounds *rounds, const float *change, int first, int group,
                                    float *out)
{
    const float *packed = rounds->packed_hessian + first * rounds->column_count * LANES;
    ROW_VECTOR sum[LANES_ROWS][NAME(parts)];
    for (int i = 0; i < group; i++)
        for (int b = 0; b < NAME(parts); b++) sum[i][b] = (ROW_VECTOR){0};
    for (int column = 0; column < rounds->column_count; column++)
        for (int i = 0; i < group; i++, packed += LANES)
            for (int b = 0; b < NAME(parts); b++) sum[i][b] += PART_AT(packed, b) * PART_AT(change + column * LANES, b);
    for (int i = 0; i < group; i++)
        for (int b = 0; b < NAME(parts); b++) PART_AT(out + (first + i) * LANES, b) = sum[i][b];
}

/* Sets the rows of `out` up to end_row, and to the end of its group, to the impulses that follow from `change`. The
 * size of a full group is a constant in the call. */
JET_INLINE void NAME(compute_impulses)(const lanes_inner_rounds *rounds, const float *change, int end_row, float *out)
{
    for (int first = 0; first < end_row; first += LANES_ROWS) {
        const int group = lanes_row_group_size(rounds, first);
        if (group == LANES_ROWS) NAME(compute_group)(rounds, change, first, LANES_ROWS, out);
        else NAME(compute_group)(rounds, change, first, group, out);
    }
}

/* ---- What they move ---------------------------------------------------------------------------------------------- */

/* Computes round_change from round_impulse, and adds it to total_change. Returns the sum of the squares of
 * round_change. */
JET_INLINE double NAME(change_by_impulses)(const lanes_inner_rounds *rounds)
{
    enum { IS_ONE = NAME(parts) == 1 };
    const float *impulse = rounds->round_impulse, *matrix = rounds->impulse_matrix;
    float *change = rounds->round_change, *total = rounds->total_change;
    ROW_VECTOR squares = {0}, column[LANES];
    float parts[sizeof squares / sizeof(float)];
    for (int j = 0; j < (IS_ONE ? LANES : 0); j++) column[j] = PART_AT(matrix + j * LANES, 0) + (ROW_VECTOR){0};
    for (int i = 0; i < rounds->column_count; i++, impulse += LANES, change += LANES, total += LANES)
        for (int b = 0; b < NAME(parts); b++) {
            ROW_VECTOR sum[CHAINS] = {0};
            for (int j = 0; j < LANES; j++)
                sum[j % CHAINS] += (IS_ONE ? column[j] : PART_AT(matrix + j * LANES, b)) * impulse[j];
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

/* Sets round_impulse to the impulses of the current rates minus the impulses of the last movement, relative to the
 * sizes of the unknowns and in units of ROUNDS_UNIT. Sets total_change to 0. */
JET_INLINE void NAME(begin_rounds)(const galerkin_nodes *nodes, const lanes_inner_rounds *rounds, const double *rates,
                                   const int slot[])
{
    for (int i = 0; i < rounds->column_count; i++) {
        const int u = rounds->unknown_of_row[i];
        const double *solver = rates + slot[u] * LANES, *old = nodes->impulses + u * LANES;
        const double factor = rounds->inverse_unknown_size[i] / ROUNDS_UNIT;
        for (int v = 0; v < NAME(vectors); v++) {
            const V impulse = BLOCK_OF(V, nodes->impulse_weight, v) * BLOCK_OF(V, solver, v);
            SINGLE_AT(rounds->round_impulse + i * LANES, v) =
                KERNEL_NAME(NARROW, V)(factor * (impulse - BLOCK_OF(V, old, v)));
            SINGLE_AT(rounds->total_change + i * LANES, v) = (SINGLE){0};
        }
    }
}

/* Converts total_impulse to the units of the unknowns, and stores it in `changes`. */
JET_INLINE void NAME(end_rounds)(const lanes_inner_rounds *rounds, double *changes)
{
    for (int i = 0; i < rounds->row_count; i++)
        for (int v = 0; v < NAME(vectors); v++)
            BLOCK_AT(V, changes + rounds->unknown_of_row[i] * LANES, v) =
                ROUNDS_UNIT * rounds->unknown_size[i] *
                KERNEL_NAME(WIDEN, V)(SINGLE_AT(rounds->total_impulse + i * LANES, v));
}

OWN void NAME(run_rounds)(const galerkin_nodes *nodes, const lanes_inner_rounds *rounds, const double *rates,
                          const int slot[], bool is_new, double movement, double least, double *changes)
{
    double before = INFINITY, earlier;
    int count = 0;
    if (is_new) NAME(pack)(nodes, rounds);
    NAME(begin_rounds)(nodes, rounds, rates, slot);
    const double first = ROUNDS_UNIT * ROUNDS_UNIT * NAME(change_by_impulses)(rounds);
    const double left_out = GALERKIN_ROUNDS_GOAL * first * (is_new ? first : movement) / (nodes->unknowns * LANES);
    const double last = tvi_larger(left_out, least);
    double now = first;
    do {
        earlier = before;
        before = now;
        NAME(compute_impulses)(rounds, rounds->round_change, rounds->column_count, rounds->round_impulse);
        now = ROUNDS_UNIT * ROUNDS_UNIT * NAME(change_by_impulses)(rounds);
    } while (++count < GALERKIN_MAX_ROUNDS && (now * now > last * before || now * before > last * earlier) &&
             (now < before || now < earlier));
    NAME(compute_impulses)(rounds, rounds->total_change, rounds->row_count, rounds->total_impulse);
    if (now <= first) NAME(end_rounds)(rounds, changes);
    else memset(changes, 0, (size_t)(nodes->unknowns * LANES) * sizeof *changes);
}

#undef SINGLE
#undef SINGLE_AT
#undef ROW_VECTOR
#undef PART_AT
