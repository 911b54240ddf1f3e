/* kernel_nodes.h - Defines the part of kernel.h that computes the drift values, which the unknowns at the nodes would
 * have without impulses. It also predicts and moves the unknowns, and computes their sizes. */

/* ---- The start of a step ----------------------------------------------------------------------------------------- */

/* Sets drift_values and drift_values_low of unknowns first .. first + count - 1 to q and q_low. */
JET_INLINE void NAME(set_constant_drift_of_half)(const galerkin_nodes *nodes, int first, int count, const double *q,
                                                 const double *q_low, galerkin_array_shape shape, size_t here)
{
    for (int u = 0; u < count; u++) {
        double *high = ROW(nodes->drift_values, first + u);
        double *base = ROW(nodes->drift_values_low, first + u);
        const V start = MEMBER_AT(q, u) - (V){0}, low = MEMBER_AT(q_low, u) - (V){0};
        MEMBER_AT(nodes->start_values, first + u) = MEMBER_AT(q, u);
        for (int v = 0; v < VECTORS; v++) {
            AT(high, v) = start;
            AT(base, v) = low;
        }
    }
}

/* Sets the drift values of unknown u to high + base = q + q_low + c (drift + drift_low), with a small `base`. The
 * products with the drift are exact: if h is near a ratio of small integers, such as 1/10, rounded products would
 * have the same error in each step, and the errors would add up. The sum of the impulses is first added to `base`,
 * whose rounding errors are far smaller than those of `high`. The parts are not added here: their rounded sum would
 * have the last bits of `high`, and those errors would add up, too. */
JET_INLINE void NAME(set_linear_drift_of_unknown)(const galerkin_nodes *nodes, int u, const double *c,
                                                  const tvi_step_origin *origin, const double *drifts,
                                                  const double *drifts_low, galerkin_array_shape shape, size_t here)
{
    double *high = ROW(nodes->drift_values, u);
    double *base = ROW(nodes->drift_values_low, u);
    const V start = MEMBER_AT(origin->q, u) - (V){0}, low = MEMBER_AT(origin->q_low, u) - (V){0};
    const V drift = MEMBER_AT(drifts, u) - (V){0}, drift_low = MEMBER_AT(drifts_low, u) - (V){0};
    MEMBER_AT(nodes->start_values, u) = MEMBER_AT(origin->q, u);
    for (int v = 0; v < VECTORS; v++) {
        const V part = OF_NODE(c, v), sum = FUSED(V, part, drift, start), added = sum - start;
        const V lost = (start - (sum - added)) + FUSED(V, part, drift, -added);
        AT(high, v) = sum;
        AT(base, v) = FUSED(V, part, drift_low, low) + lost;
    }
}

/* ---- Sums over the nodes ----------------------------------------------------------------------------------------- */

/* A table [j][lanes] of factors in sums over the nodes j. The compiler keeps it in registers if a row fits into one
 * vector. */
typedef struct {
#if ONE_VECTOR
    V row[LANES];
#else
    const double *number;
#endif
} NAME(table);

JET_INLINE NAME(table) NAME(table_of)(const double *number)
{
#if ONE_VECTOR
    NAME(table) table;
    for (int j = 0; j < LANES; j++) table.row[j] = OF_NODE(number + j * LANES, 0);
    return table;
#else
    return (NAME(table)){number};
#endif
}

/* The number of vectors of a row whose sums are computed together: each x_j is loaded once for all of them. */
enum { NAME(block) = !MEMBERS && LANES / NUMBERS_OF(V) % 2 == 0 ? 2 : 1 };

/* Adds sum_j table_jv x_j to the partial sums of the vectors v of a block, which begins with vector `first`; table_jv
 * is vector v of row j. */
JET_INLINE void NAME(add_product)(V sum[][PARTIAL_SUM_COUNT], const NAME(table) *table, const MEMBER x[], int first,
                                  galerkin_array_shape shape)
{
    const int nodes = MEMBERS ? shape.node_count : shape.lane_count;
    (void)first;
    for (int j = 0; j < nodes; j++)
        for (int b = 0; b < NAME(block); b++)
            sum[b][j % PARTIAL_SUM_COUNT] =
                FUSED(V, OF_TABLE(table, j, first + b), x[j] - (V){0}, sum[b][j % PARTIAL_SUM_COUNT]);
}

/* Defines `name` as an array of the numbers of a row, one for each node. For several members its elements are vectors
 * of members, which are loaded into local variables and stay in registers. */
#if MEMBERS
#define NUMBERS_IN(name, row)                                                                                          \
    V name[LANES];                                                                                                     \
    for (int j = 0; j < shape.node_count; j++) name[j] = AT(row, j);
#else
#define NUMBERS_IN(name, row) const double *const name = row;
#endif

JET_INLINE V NAME(add_partial_sums)(const V sum[]) { return (sum[0] + sum[2]) + (sum[1] + sum[3]); }

JET_INLINE void NAME(clear)(V *x, int count)
{
    for (int i = 0; i < count; i++) x[i] = (V){0};
}

/* Returns the sum of x over the lanes of one member: four partial sums, which are added by halves. For one member the
 * sum includes the lanes after the last node, which repeat that node. For several members there are no such lanes, and
 * the last node is added once for each of them, so that both sums are equal. */
JET_INLINE MEMBER NAME(sum_of)(const V x[LANES], galerkin_array_shape shape)
{
#if MEMBERS
    enum { GROUPS = 4 };
    V sum[GROUPS];
    NAME(clear)(sum, GROUPS);
    for (int i = 0; i < shape.lane_count; i++) sum[i % GROUPS] += x[i < shape.node_count ? i : shape.node_count - 1];
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
#else
    enum { GROUPS = NUMBERS_OF(V) < 4 && LANES >= 4 ? 4 / NUMBERS_OF(V) : 1 };
    V sum[GROUPS];
    NAME(clear)(sum, GROUPS);
    for (int v = 0; v < VECTORS; v++) sum[v % GROUPS] += x[v];
    for (int half = GROUPS / 2; half > 0; half /= 2)
        for (int k = 0; k < half; k++) sum[k] += sum[k + half];
    return KERNEL_NAME(add_lanes_of, V)(sum[0]);
#endif
}

/* ---- Movements --------------------------------------------------------------------------------------------------- */

/* Sets the impulses L_j = impulse_weight_j F_j from the rates F_j; row slot[u] of `rates` contains those of unknown
 * u. */
JET_INLINE void NAME(set_impulses)(const galerkin_nodes *caller_nodes, const double *rates, const int slot[],
                                   galerkin_array_shape shape, size_t here)
{
    const galerkin_nodes copy = *caller_nodes, *const nodes = &copy;
    for (int u = 0; u < nodes->unknown_count; u++) {
        const double *rate = ROW(rates, slot[u]);
        double *impulse = ROW(nodes->impulses, u);
        for (int v = 0; v < VECTORS; v++)
            AT(impulse, v) = KEPT(OF_NODE(nodes->impulse_weight, v) * AT(rate, v), AT(impulse, v));
    }
}

/* Moves the unknowns to x = drift_values + displacement, with displacement = drift_values_low +
 * unknown_change_per_impulse sum_j matrix_ji L_j, by the impulses L_j of all nodes. If `displacements`
 * [unknowns][lanes] is not NULL, it gets the displacements. Returns the sum of the squares of (change of x)
 * inverse_unknown_size. */
JET_INLINE MEMBER NAME(move_unknowns)(const galerkin_nodes *caller_nodes, const double *matrix, double *displacements,
                                      galerkin_array_shape shape, size_t here)
{
    const galerkin_nodes copy = *caller_nodes, *const nodes = &copy;
    const int moving = nodes->moving_unknown_count,
              all = moving < nodes->unknown_count ? 2 * moving : nodes->unknown_count;
    const NAME(table) table = NAME(table_of)(matrix);
    V squares[LANES];
    NAME(clear)(squares, VECTORS);
    for (int k = 0; k < all; k++) {
        const int u = k < moving ? k : k - moving + nodes->coordinate_unknown_count;
        const double *high = ROW(nodes->drift_values, u);
        const double *base = ROW(nodes->drift_values_low, u);
        const V scale = nodes->unknown_change_per_impulse[u] - (V){0},
                inverse_size = MEMBER_AT(nodes->inverse_unknown_size, u) - (V){0};
        double *x = ROW(nodes->values, u);
        NUMBERS_IN(impulse, ROW(nodes->impulses, u))
        for (int first = 0; first < VECTORS; first += NAME(block)) {
            V sum[NAME(block)][PARTIAL_SUM_COUNT];
            NAME(clear)(sum[0], NAME(block) *PARTIAL_SUM_COUNT);
            NAME(add_product)(sum, &table, impulse, first, shape);
            for (int v = first; v < first + NAME(block); v++) {
                const V displacement = FUSED(V, scale, NAME(add_partial_sums)(sum[v - first]), AT(base, v)),
                        moved_to = AT(high, v) + displacement;
                const V change = (moved_to - AT(x, v)) * inverse_size;
                squares[v] = FUSED(V, change, change, squares[v]);
                AT(x, v) = moved_to;
                if (displacements) AT(ROW(displacements, u), v) = displacement;
            }
        }
    }
    return NAME(sum_of)(squares, shape);
}

JET_INLINE void NAME(move_all)(const galerkin_nodes *nodes, const double *matrix, const double *rates, const int slot[],
                               double movement[], galerkin_array_shape shape, size_t here)
{
    NAME(set_impulses)(nodes, rates, slot, shape, here);
    MEMBER_AT(movement, 0) = NAME(move_unknowns)(nodes, matrix, NULL, shape, here);
}

#if MEMBERS
/* Adds to `sum` the extrapolation of unknown u to node v from earlier steps. Each member uses the tables that its
 * mask selects. */
JET_INLINE void NAME(extrapolate)(V sum[], const galerkin_extrapolation *extrapolation, int u, int v,
                                  galerkin_array_shape shape, size_t here)
{
    const double *last = ROW(extrapolation->last_impulses, u);
    const double *before = ROW(extrapolation->impulses_before, u);
    const double *table_of_step_before = extrapolation->two_step_extrapolation + shape.lane_count * shape.lane_count;
    const JET_MASK(jet_widest) uses_last_step =
        *(const JET_MASK(jet_widest) *)(extrapolation->last_step_only_mask + here);
    const V none = {0};
    for (int j = 0; j < shape.node_count; j++)
        sum[j % PARTIAL_SUM_COUNT] =
            FUSED(V, JET_CHOOSE(V, uses_last_step, none, OF_NODE(table_of_step_before + j * shape.lane_count, v)),
                  AT(before, j), sum[j % PARTIAL_SUM_COUNT]);
    for (int j = 0; j < shape.node_count; j++)
        sum[j % PARTIAL_SUM_COUNT] = FUSED(
            V,
            JET_CHOOSE(V, uses_last_step, OF_NODE(extrapolation->last_step_extrapolation + j * shape.lane_count, v),
                       OF_NODE(extrapolation->two_step_extrapolation + j * shape.lane_count, v)),
            AT(last, j), sum[j % PARTIAL_SUM_COUNT]);
}
#endif

/* Predicts the unknowns of all nodes from the impulses of earlier steps. The impulses of the latest step, which have
 * the largest factors, are added last. */
JET_INLINE void NAME(predict_all)(const galerkin_nodes *caller_nodes,
                                  const galerkin_extrapolation *caller_extrapolation, galerkin_array_shape shape,
                                  size_t here)
{
    const galerkin_nodes copy = *caller_nodes, *const nodes = &copy;
    const galerkin_extrapolation extrapolation = *caller_extrapolation;
#if !MEMBERS
    const bool uses_last_step = *extrapolation.last_step_only_mask;
    const NAME(table) table_of_last_step =
        NAME(table_of)(uses_last_step ? extrapolation.last_step_extrapolation : extrapolation.two_step_extrapolation);
    /* If the last step alone is used, table_of_step_before is not used, and any valid address will do. */
    const NAME(table) table_of_step_before =
        NAME(table_of)(extrapolation.two_step_extrapolation + (uses_last_step ? 0 : LANES * LANES));
#endif
    for (int u = 0; u < nodes->unknown_count; u++) {
        const double *high = ROW(nodes->drift_values, u);
        const double *base = ROW(nodes->drift_values_low, u);
        const V scale = nodes->unknown_change_per_impulse[u] - (V){0};
        double *x = ROW(nodes->values, u);
        for (int first = 0; first < VECTORS; first += NAME(block)) {
            V sum[NAME(block)][PARTIAL_SUM_COUNT];
            NAME(clear)(sum[0], NAME(block) *PARTIAL_SUM_COUNT);
#if MEMBERS
            NAME(extrapolate)(sum[0], &extrapolation, u, first, shape, here);
#else
            if (!uses_last_step)
                NAME(add_product)(sum, &table_of_step_before, ROW(extrapolation.impulses_before, u), first, shape);
            NAME(add_product)(sum, &table_of_last_step, ROW(extrapolation.last_impulses, u), first, shape);
#endif
            for (int v = first; v < first + NAME(block); v++)
                AT(x, v) = AT(high, v) + FUSED(V, scale, NAME(add_partial_sums)(sum[v - first]), AT(base, v));
        }
    }
}

/* Returns the size of an unknown: |value at the start of the step| + |value at the last node - value at the start|. */
JET_INLINE MEMBER NAME(size_of)(const galerkin_nodes *nodes, int u, galerkin_array_shape shape, size_t here)
{
    const MEMBER start = MEMBER_AT(nodes->start_values, u);
    const MEMBER movement =
        NUMBER(ROW(nodes->values, u), MEMBERS ? shape.node_count - 1 : shape.lane_count - 1) - start;
    return MAGNITUDE(start) + MAGNITUDE(movement);
}

/* Returns what is added to the sizes of unknowns, of which this is the largest one. */
JET_INLINE MEMBER NAME(least_of)(MEMBER largest)
{
    const MEMBER none = {0};
    return IF_ABOVE(largest, none, GALERKIN_MIN_SHARE * largest + DBL_MIN, 1 - none);
}

/* Sets inverse_unknown_size for the unknowns of one subsystem. To the size of each unknown it adds a small part of the
 * largest size in its subsystem (GALERKIN_MIN_SHARE). If masses are known, the size of a momentum is at least
 * momentum_that_moves_coordinate_by_1_in_step times the part that is added to its coordinate. There are no branches,
 * because the processor could not predict which number is larger. */
JET_INLINE void NAME(set_sizes_of)(const galerkin_nodes *nodes, int n, int first, int end, galerkin_array_shape shape,
                                   size_t here)
{
    const bool has_momenta = nodes->unknown_count > n;
    MEMBER largest_q = {0}, largest_p = {0};
    for (int k = first; k < end; k++) {
        const int i = tvi_subsystems_component_at(&nodes->subsystems, k);
        const MEMBER size = NAME(size_of)(nodes, i, shape, here);
        MEMBER_AT(nodes->inverse_unknown_size, i) = size;
        largest_q = IF_ABOVE(size, largest_q, size, largest_q);
        if (!has_momenta) continue;
        const MEMBER of_p = NAME(size_of)(nodes, n + i, shape, here);
        MEMBER_AT(nodes->inverse_unknown_size, n + i) = of_p;
        largest_p = IF_ABOVE(of_p, largest_p, of_p, largest_p);
    }
    const MEMBER least_q = NAME(least_of)(largest_q), least_p = NAME(least_of)(largest_p);
    for (int k = first; k < end; k++) {
        const int i = tvi_subsystems_component_at(&nodes->subsystems, k);
        MEMBER_AT(nodes->inverse_unknown_size, i) = 1 / (MEMBER_AT(nodes->inverse_unknown_size, i) + least_q);
        if (!has_momenta) continue;
        const MEMBER own = nodes->momentum_that_moves_coordinate_by_1_in_step[i] * least_q,
                     least = IF_ABOVE(least_p, own, own, least_p);
        MEMBER_AT(nodes->inverse_unknown_size, n + i) = 1 / (MEMBER_AT(nodes->inverse_unknown_size, n + i) + least);
    }
}
