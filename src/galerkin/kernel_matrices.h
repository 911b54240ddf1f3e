/* kernel_matrices.h - Defines the part of kernel.h that inverts L_vv at the nodes and expands the gradient of a
 * Lagrangian to first order. Each lane has its own matrix (lanes_matrix_inverse). */

/* The least ratio of a pivot to the diagonal element of A in its place, and of that element to the pivot, in a
 * matrix that is factored without row exchanges. It is equal to LINEAR_LEAST_INVERTED of linear_small.h, which this
 * file does not include. */
#define LEAST_PIVOT (1.0 / 16)
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

/* ---- Factors ----------------------------------------------------------------------------------------------------- */

/* Divides `count` elements of x, which are `apart` elements from each other, by the largest of them. Sets `scale` to
 * the reciprocal of the divisor. */
JET_INLINE void NAME(set_scale)(int count, int apart, double *x, double *scale)
{
    EACH_VECTOR_OF_LANES(v)
    {
        V size = {0};
        for (int i = 0; i < count; i++) size = NAME(larger)(NAME(size)(LANE_AT(x, i * apart, v)), size);
        LANE_AT(scale, 0, v) = 1 / size;
        for (int i = 0; i < count; i++) LANE_AT(x, i * apart, v) *= LANE_AT(scale, 0, v);
    }
}

/* Exchanges `count` elements of x and y in one lane; elements are LANES numbers apart. */
JET_INLINE void NAME(exchange)(int count, double *x, double *y)
{
    for (int k = 0; k < count * LANES; k += LANES) {
        const double kept = x[k];
        x[k] = y[k];
        y[k] = kept;
    }
}

/* Returns whether an element below the diagonal of column j is larger than the diagonal element, in any lane. */
JET_INLINE bool NAME(wants_exchange)(const lanes_matrix_inverse *f, int j)
{
    const double *diagonal = f->matrix + (j * f->n + j) * LANES;
    int larger = 0;
    for (int i = j + 1; i < f->n; i++) {
        const double *below = f->matrix + (i * f->n + j) * LANES;
        JET_IN_VECTORS
        for (int w = 0; w < LANES; w++) larger |= fabs(below[w]) > fabs(diagonal[w]);
    }
    return larger;
}

/* Exchanges row j with the row that has the largest element on or below the diagonal of column j, in each lane. */
JET_INLINE void NAME(pivot)(lanes_matrix_inverse *f, int j)
{
    const int row = f->n * LANES;
    const double *column = f->matrix + j * LANES;
    int *pivot = f->pivot_row + j * LANES;
    for (int w = 0; w < LANES; w++) pivot[w] = j;
    if (!NAME(wants_exchange)(f, j)) return;
    f->has_row_exchanges = true;
    for (int w = 0; w < LANES; w++) {
        for (int i = j + 1; i < f->n; i++)
            if (fabs(column[i * row + w]) > fabs(column[pivot[w] * row + w])) pivot[w] = i;
        if (pivot[w] != j) NAME(exchange)(f->n, f->matrix + j * row + w, f->matrix + pivot[w] * row + w);
    }
}

/* Computes column j of L and U: it subtracts multiples of row j from the rows below, and stores 1 / U_jj on the
 * diagonal. */
JET_INLINE void NAME(eliminate)(lanes_matrix_inverse *f, int j, double *least)
{
    const int n = f->n;
    double *const upper = f->matrix + j * n * LANES;
    EACH_VECTOR_OF_LANES(v)
    {
        const V pivot = LANE_AT(upper, j, v);
        LANE_AT(least, 0, v) = -NAME(larger)(-NAME(size)(pivot), -LANE_AT(least, 0, v));
        LANE_AT(upper, j, v) = 1 / pivot;
    }
    for (int i = j + 1; i < n; i++) {
        double *const lower = f->matrix + i * n * LANES;
        EACH_VECTOR_OF_LANES(v)
        {
            const V part = LANE_AT(lower, j, v) * LANE_AT(upper, j, v);
            LANE_AT(lower, j, v) = part;
            for (int k = j + 1; k < n; k++) LANE_AT(lower, k, v) -= part * LANE_AT(upper, k, v);
        }
    }
}

/* Scales A to R A C, with rows and then columns of size 1, and replaces it by L and U, with 1 / U_jj on the
 * diagonal. Returns the smallest pivot of all lanes. */
JET_INLINE double NAME(factor)(lanes_matrix_inverse *f)
{
    const int n = f->n;
    double least[LANES], smallest = 1;
    for (int w = 0; w < LANES; w++) least[w] = 1;
    for (int i = 0; i < n; i++) NAME(set_scale)(n, 1, f->matrix + i * n * LANES, f->row_scale + i * LANES);
    for (int j = 0; j < n; j++) NAME(set_scale)(n, n, f->matrix + j * LANES, f->column_scale + j * LANES);
    f->has_row_exchanges = false;
    for (int j = 0; j < n; j++) {
        NAME(pivot)(f, j);
        NAME(eliminate)(f, j, least);
    }
    for (int w = 0; w < LANES; w++) smallest = tvi_smaller(least[w], smallest);
    return smallest;
}

/* ---- The inverse: A^-1 = C (R A C)^-1 R -------------------------------------------------------------------------- */

JET_INLINE void NAME(invert_column)(lanes_matrix_inverse *f, int column)
{
    const int n = f->n;
    double *const x = f->scratch_column;
    memset(x, 0, (size_t)(n * LANES) * sizeof *x);
    memcpy(x + column * LANES, f->row_scale + column * LANES, LANES * sizeof *x);
    for (int j = 0; j < (f->has_row_exchanges ? n : 0); j++)
        for (int w = 0; w < LANES; w++)
            NAME(exchange)(1, x + j * LANES + w, x + f->pivot_row[j * LANES + w] * LANES + w);
    EACH_VECTOR_OF_LANES(v)
    {
        for (int i = 0; i < n; i++) {
            V sum = LANE_AT(x, i, v);
            for (int j = 0; j < i; j++) sum -= LANE_AT(f->matrix, i * n + j, v) * LANE_AT(x, j, v);
            LANE_AT(x, i, v) = sum;
        }
        for (int i = n - 1; i >= 0; i--) {
            V sum = LANE_AT(x, i, v);
            for (int j = i + 1; j < n; j++) sum -= LANE_AT(f->matrix, i * n + j, v) * LANE_AT(x, j, v);
            sum *= LANE_AT(f->matrix, i * n + i, v);
            LANE_AT(x, i, v) = sum;
            LANE_AT(f->inverse, i * n + column, v) = sum * LANE_AT(f->column_scale, i, v);
        }
    }
}

/* ---- Without scales and exchanges, of matrices that are plain ---------------------------------------------------- */

/* Inverts the matrix by Gauss-Jordan elimination without row exchanges, and stores the result in `inverse`. Returns
 * false, with `inverse` undefined, if the ratio of some pivot to the diagonal element is not between LEAST_PIVOT and
 * 1 / LEAST_PIVOT. */
JET_INLINE bool NAME(invert_unpivoted)(lanes_matrix_inverse *f)
{
    const int n = f->n;
    double worst[LANES];
    bool is_plain = true;
    memcpy(f->inverse, f->matrix, (size_t)(n * n * LANES) * sizeof *f->matrix);
    for (int w = 0; w < LANES; w++) worst[w] = -INFINITY;
    for (int j = 0; j < n; j++) {
        double *const row = f->inverse + j * n * LANES;
        EACH_VECTOR_OF_LANES(v)
        {
            const V inverse = 1 / LANE_AT(row, j, v), part = NAME(size)(LANE_AT(f->matrix, j * n + j, v) * inverse);
            const V excess = NAME(larger)(LEAST_PIVOT - part, part - 1 / LEAST_PIVOT);
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
    for (int w = 0; w < LANES; w++) is_plain &= worst[w] < 0;
    return is_plain;
}

OWN double NAME(invert)(lanes_matrix_inverse *f)
{
    if (NAME(invert_unpivoted)(f)) return 1;
    const double smallest = NAME(factor)(f);
    for (int column = 0; column < f->n; column++) NAME(invert_column)(f, column);
    return smallest;
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
        if (i < m->n) sum += BLOCK_OF(V, m->centre_gradient + i * LANES, v);
        LANE_AT(out, i, v) = sum;
    }
}

#undef LANE_AT
#undef EACH_VECTOR_OF_LANES
#undef LEAST_PIVOT
