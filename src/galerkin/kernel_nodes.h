/* kernel_nodes.h - Defines the part of kernel.h that computes the drift values, which the unknowns at the nodes would
 * have without impulses. It also predicts and moves the unknowns, and computes their sizes. */

/* ---- The start of a step ----------------------------------------------------------------------------------------- */

/* Sets drift_values and drift_values_low of unknowns first .. first + count - 1 to q and q_low. */
JET_INLINE void NAME(set_constant_drift_of_half)(const galerkin_nodes *nodes, int first, int count, const double *q,
                                                 const double *q_low)
{
    for (int u = 0; u < count; u++) {
        double *high = ROW(nodes->drift_values, first + u);
        double *base = ROW(nodes->drift_values_low, first + u);
        const V start = q[u] - (V){0}, low = q_low[u] - (V){0};
        nodes->start_values[first + u] = q[u];
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
                                                  const double *drifts_low)
{
    double *high = ROW(nodes->drift_values, u);
    double *base = ROW(nodes->drift_values_low, u);
    const V start = origin->q[u] - (V){0}, low = origin->q_low[u] - (V){0};
    const V drift = drifts[u] - (V){0}, drift_low = drifts_low[u] - (V){0};
    nodes->start_values[u] = origin->q[u];
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
enum { NAME(block) = LANES / NUMBERS_OF(V) % 2 == 0 ? 2 : 1 };

/* Adds sum_j table_jv x_j to the partial sums of the vectors v of a block, which begins with vector `first`; table_jv
 * is vector v of row j. */
JET_INLINE void NAME(add_product)(V sum[][PARTIAL_SUM_COUNT], const NAME(table) *table, const double x[], int first)
{
    (void)first;
    for (int j = 0; j < LANES; j++)
        for (int b = 0; b < NAME(block); b++)
            sum[b][j % PARTIAL_SUM_COUNT] =
                FUSED(V, OF_TABLE(table, j, first + b), x[j] - (V){0}, sum[b][j % PARTIAL_SUM_COUNT]);
}

JET_INLINE V NAME(add_partial_sums)(const V sum[]) { return (sum[0] + sum[2]) + (sum[1] + sum[3]); }

JET_INLINE void NAME(clear)(V *x, int count)
{
    for (int i = 0; i < count; i++) x[i] = (V){0};
}

/* Returns the sum of x over the lanes, also those after the last node: four partial sums, which are added by halves. */
JET_INLINE double NAME(sum_of)(const V x[LANES])
{
    enum { GROUPS = NUMBERS_OF(V) < 4 && LANES >= 4 ? 4 / NUMBERS_OF(V) : 1 };
    V sum[GROUPS];
    NAME(clear)(sum, GROUPS);
    for (int v = 0; v < VECTORS; v++) sum[v % GROUPS] += x[v];
    for (int half = GROUPS / 2; half > 0; half /= 2)
        for (int k = 0; k < half; k++) sum[k] += sum[k + half];
    return KERNEL_NAME(jet_add_lanes_of, V)(sum[0]);
}

/* ---- Movements --------------------------------------------------------------------------------------------------- */

/* Sets the impulses L_j = impulse_weight_j F_j from the rates F_j; row slot[u] of `rates` contains those of unknown
 * u. */
JET_INLINE void NAME(set_impulses)(const galerkin_nodes *caller_nodes, const double *rates, const int slot[])
{
    const galerkin_nodes copy = *caller_nodes, *const nodes = &copy;
    for (int u = 0; u < nodes->unknown_count; u++) {
        const double *rate = ROW(rates, slot[u]);
        double *impulse = ROW(nodes->impulses, u);
        for (int v = 0; v < VECTORS; v++) AT(impulse, v) = OF_NODE(nodes->impulse_weight, v) * AT(rate, v);
    }
}

/* Moves the unknowns to x = drift_values + displacement, with displacement = drift_values_low +
 * unknown_change_per_impulse sum_j matrix_ji L_j, by the impulses L_j of all nodes. If `displacements`
 * [unknowns][lanes] is not NULL, it gets the displacements. Returns the sum of the squares of (change of x)
 * inverse_unknown_size. */
JET_INLINE double NAME(move_unknowns)(const galerkin_nodes *caller_nodes, const double *matrix, double *displacements)
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
                inverse_size = nodes->inverse_unknown_size[u] - (V){0};
        double *x = ROW(nodes->values, u);
        const double *const impulse = ROW(nodes->impulses, u);
        for (int first = 0; first < VECTORS; first += NAME(block)) {
            V sum[NAME(block)][PARTIAL_SUM_COUNT];
            NAME(clear)(sum[0], NAME(block) *PARTIAL_SUM_COUNT);
            NAME(add_product)(sum, &table, impulse, first);
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
    return NAME(sum_of)(squares);
}

/* Predicts the unknowns of all nodes from the impulses of earlier steps. The impulses of the latest step, which have
 * the largest factors, are added last. */
JET_INLINE void NAME(predict_all)(const galerkin_nodes *caller_nodes,
                                  const galerkin_extrapolation *caller_extrapolation)
{
    const galerkin_nodes copy = *caller_nodes, *const nodes = &copy;
    const galerkin_extrapolation extrapolation = *caller_extrapolation;
    const bool uses_last_step = extrapolation.uses_last_step_only;
    const NAME(table) table_of_last_step =
        NAME(table_of)(uses_last_step ? extrapolation.last_step_extrapolation : extrapolation.two_step_extrapolation);
    /* If the last step alone is used, table_of_step_before is not used, and any valid address will do. */
    const NAME(table) table_of_step_before =
        NAME(table_of)(extrapolation.two_step_extrapolation + (uses_last_step ? 0 : LANES * LANES));
    for (int u = 0; u < nodes->unknown_count; u++) {
        const double *high = ROW(nodes->drift_values, u);
        const double *base = ROW(nodes->drift_values_low, u);
        const V scale = nodes->unknown_change_per_impulse[u] - (V){0};
        double *x = ROW(nodes->values, u);
        for (int first = 0; first < VECTORS; first += NAME(block)) {
            V sum[NAME(block)][PARTIAL_SUM_COUNT];
            NAME(clear)(sum[0], NAME(block) *PARTIAL_SUM_COUNT);
            if (!uses_last_step)
                NAME(add_product)(sum, &table_of_step_before, ROW(extrapolation.impulses_before, u), first);
            NAME(add_product)(sum, &table_of_last_step, ROW(extrapolation.last_impulses, u), first);
            for (int v = first; v < first + NAME(block); v++)
                AT(x, v) = AT(high, v) + FUSED(V, scale, NAME(add_partial_sums)(sum[v - first]), AT(base, v));
        }
    }
}

/* Returns the size of an unknown: |value at the start of the step| + |value at the last node - value at the start|. */
JET_INLINE double NAME(size_of)(const galerkin_nodes *nodes, int u)
{
    const double start = nodes->start_values[u];
    const double movement = ROW(nodes->values, u)
    [LANES - 1] - start;
    return fabs(start) + fabs(movement);
}

/* Returns what is added to the sizes of unknowns, of which this is the largest one. */
JET_INLINE double NAME(least_of)(double largest) { return largest > 0 ? GALERKIN_MIN_SHARE * largest + DBL_MIN : 1; }

/* Sets inverse_unknown_size for the unknowns of one subsystem. To the size of each unknown it adds a small part of the
 * largest size in its subsystem (GALERKIN_MIN_SHARE). If masses are known, the size of a momentum is at least
 * momentum_that_moves_coordinate_by_1_in_step times the part that is added to its coordinate. There are no branches,
 * because the processor could not predict which number is larger. */
JET_INLINE void NAME(set_sizes_of)(const galerkin_nodes *nodes, int n, int first, int end)
{
    const bool has_momenta = nodes->unknown_count > n;
    double largest_q = 0, largest_p = 0;
    for (int k = first; k < end; k++) {
        const int i = tvi_subsystems_component_at(&nodes->subsystems, k);
        const double size = NAME(size_of)(nodes, i);
        nodes->inverse_unknown_size[i] = size;
        largest_q = tvi_larger(size, largest_q);
        if (!has_momenta) continue;
        const double of_p = NAME(size_of)(nodes, n + i);
        nodes->inverse_unknown_size[n + i] = of_p;
        largest_p = tvi_larger(of_p, largest_p);
    }
    const double least_q = NAME(least_of)(largest_q), least_p = NAME(least_of)(largest_p);
    for (int k = first; k < end; k++) {
        const int i = tvi_subsystems_component_at(&nodes->subsystems, k);
        nodes->inverse_unknown_size[i] = 1 / (nodes->inverse_unknown_size[i] + least_q);
        if (!has_momenta) continue;
        const double own = nodes->momentum_that_moves_coordinate_by_1_in_step[i] * least_q,
                     least = least_p > own ? own : least_p;
        nodes->inverse_unknown_size[n + i] = 1 / (nodes->inverse_unknown_size[n + i] + least);
    }
}
