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

/* Computes galerkin_kernels.invert by Gauss-Jordan elimination. */
OWN bool NAME(invert)(const lanes_matrix_inverse *f)
{
    const int n = f->n;
    double worst[LANES];
    bool is_safe = true;
    memcpy(f->inverse, f->matrix, (size_t)(n * n * LANES) * sizeof *f->matrix);
    for (int w = 0; w < LANES; w++) worst[w] = -INFINITY;
    for (int j = 0; j < n; j++) {
        double *const row = f->inverse + j * n * LANES;
        EACH_VECTOR_OF_LANES(v)
        {
            const V inverse = 1 / LANE_AT(row, j, v), part = NAME(size)(LANE_AT(f->matrix, j * n + j, v) * inverse);
            const V excess = NAME(larger)(LINEAR_MIN_PIVOT_OF_INVERSE - part, part - 1 / LINEAR_MIN_PIVOT_OF_INVERSE);
            LANE_AT(worst, 0, v) = NAME(larger)(excess, LANE_AT(worst, 0, v));
            for (int k = 0; k < n; k++) LANE_AT(row, k, v) *= inverse;
            LANE_AT(row, j, v) = inverse;
        }
        for (int i = 0; i < n; i++) {
            double *const other = f->inverse + i * n * LANES;
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

OWN void NAME(correct)(const lanes_matrix_inverse *f, const double *P, const double *p, const double *change,
                       const double *from, double *velocity)
{
    const int n = f->n;
    double *const x = f->scratch_column;
    for (int i = 0; i < n * LANES; i += NUMBERS_OF(V)) {
        const V missing = *(const V *)(P + i) - *(const V *)(p + i);
        *(V *)(x + i) = missing - *(const V *)(change + i);
    }
    for (int i = 0; i < n; i++) EACH_VECTOR_OF_LANES(v)
        {
            V sum = {0};
            for (int j = 0; j < n; j++) sum += LANE_AT(f->inverse, i * n + j, v) * LANE_AT(x, j, v);
            LANE_AT(velocity, i, v) = BLOCK_OF(V, from + i * LANES, v) + sum;
        }
}

/* Computes galerkin_kernels.linearise. Each sum adds the products of second derivatives and displacements before the
 * gradient at the centre, which is larger. The outer loop is unrolled: in generated code the expansion is constant,
 * and then all bounds of the inner loops are constants, too. */
OWN void NAME(linearise)(const lanes_gradient_expansion *m, double *out)
{
    JET_UNROLL(8) for (int i = 0; i < 2 * m->n; i++) EACH_VECTOR_OF_LANES(v)
    {
        V sum = {0};
        for (int k = i > 0 ? m->row_end[i - 1] : 0; k < m->row_end[i]; k++)
            if (i < m->n || m->hessian_element[k].column < m->n)
                sum += BLOCK_OF(V, m->hessian_block + m->hessian_element[k].slot * LANES, v) *
                       LANE_AT(m->displacement, m->hessian_element[k].column, v);
        if (i < m->n) sum += BLOCK_OF(V, m->gradient_at_centre + i * LANES, v);
        LANE_AT(out, i, v) = sum;
    }
}

#undef LANE_AT
#undef EACH_VECTOR_OF_LANES
