/* kernel_matrices.h - Defines the part of kernel.h that inverts L_vv at the nodes and expands the gradient of a
 * Lagrangian to first order. Each lane has its own matrix (lanes_matrix_inverse). */

/* Accesses vector v of element i, in an array that stores LANES numbers for each element. */
#define LANE_AT(x, i, v)        BLOCK_AT(V, (x) + (size_t)(i)*LANES, v)
#define EACH_VECTOR_OF_LANES(v) for (int v = 0; v < LANES / NUMBERS_OF(V); v++)

JET_INLINE V NAME(larger)(V a, V b)
{
#if LANES % 2 == 0
    return JET_CHOOSE(V, a > b, a, b);
#else
    return a > b ? a : b;
#endif
}

/* Returns |x|, and 0 for a NaN. */
JET_INLINE V NAME(size)(V x) { return NAME(larger)(NAME(larger)(x, -x), (V){0}); }

/* ---- The inverse of a matrix ------------------------------------------------------------------------------------- */

/* Implements the kernel `invert` by Gauss-Jordan elimination. */
KERNEL_FUNCTION bool NAME(invert)(const lanes_matrix_inverse *inverses)
{
    const int n = inverses->n;
    double worst[LANES];
    bool is_safe = true;
    memcpy(inverses->inverse, inverses->matrix, (size_t)(n * n * LANES) * sizeof *inverses->matrix);
    for (int w = 0; w < LANES; w++) worst[w] = -INFINITY;
    for (int j = 0; j < n; j++) {
        double *const row = inverses->inverse + j * n * LANES;
        EACH_VECTOR_OF_LANES(v)
        {
            const V inverse = 1 / LANE_AT(row, j, v),
                    part = NAME(size)(LANE_AT(inverses->matrix, j * n + j, v) * inverse);
            const V excess = NAME(larger)(LINEAR_MIN_PIVOT_OF_INVERSE - part, part - 1 / LINEAR_MIN_PIVOT_OF_INVERSE);
            LANE_AT(worst, 0, v) = NAME(larger)(excess, LANE_AT(worst, 0, v));
            for (int k = 0; k < n; k++) LANE_AT(row, k, v) *= inverse;
            LANE_AT(row, j, v) = inverse;
        }
        for (int i = 0; i < n; i++) {
            double *const other = inverses->inverse + i * n * LANES;
            if (i == j) continue;
            EACH_VECTOR_OF_LANES(v)
            {
                const V part = LANE_AT(other, j, v);
                LANE_AT(other, j, v) = (V){0};
                for (int k = 0; k < n; k++) LANE_AT(other, k, v) -= part * LANE_AT(row, k, v);
            }
        }
    }
    for (int w = 0; w < LANES; w++) is_safe &= worst[w] < 0;
    return is_safe;
}

/* ---- Corrections of velocities, and the gradient to first order -------------------------------------------------- */

KERNEL_FUNCTION void NAME(correct_velocities)(const lanes_matrix_inverse *inverse, const double *momenta,
                                              const double *centre_momenta, const double *momentum_change,
                                              const double *centre_velocities, double *velocities)
{
    const int n = inverse->n;
    double *const x = inverse->scratch_column;
    for (int i = 0; i < n * LANES; i += NUMBERS_OF(V)) {
        const V missing = *(const V *)(momenta + i) - *(const V *)(centre_momenta + i);
        *(V *)(x + i) = missing - *(const V *)(momentum_change + i);
    }
    for (int i = 0; i < n; i++) EACH_VECTOR_OF_LANES(v)
        {
            V sum = {0};
            for (int j = 0; j < n; j++) sum += LANE_AT(inverse->inverse, i * n + j, v) * LANE_AT(x, j, v);
            LANE_AT(velocities, i, v) = BLOCK_OF(V, centre_velocities + i * LANES, v) + sum;
        }
}

/* Implements the kernel `linearise`. Each sum adds the products of second derivatives and displacements before the
 * gradient at the centre, which is larger. The outer loop is unrolled: in generated code the expansion is constant, and
 * then all bounds of the inner loops are constants, too. */
KERNEL_FUNCTION void NAME(linearise)(const lanes_linearised_gradient *expansion, double *out)
{
    const int n = expansion->n;
    JET_UNROLL(8) for (int i = 0; i < 2 * n; i++)
    {
        V sum[LANES / NUMBERS_OF(V)];
        NAME(clear)(sum, LANES / NUMBERS_OF(V));
        for (int k = i > 0 ? expansion->row_end[i - 1] : 0; k < expansion->row_end[i]; k++) {
            const int column = expansion->hessian_element[k].column, slot = expansion->hessian_element[k].slot;
            if (i >= n && column >= n) continue;
            EACH_VECTOR_OF_LANES(v)
            sum[v] += LANE_AT(expansion->hessian_block, slot, v) * LANE_AT(expansion->displacement, column, v);
        }
        EACH_VECTOR_OF_LANES(v)
        {
            if (i < n) sum[v] += LANE_AT(expansion->gradient_at_centre, i, v);
            LANE_AT(out, i, v) = sum[v];
        }
    }
}

#undef LANE_AT
#undef EACH_VECTOR_OF_LANES
