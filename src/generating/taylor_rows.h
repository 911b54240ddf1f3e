/* taylor_rows.h - rescales the coefficients of a Taylor curve and sums them, for one vector of components.
 * taylor_sweep.h includes this text once for each vector type V. The including file defines V, SIZE(x), which is
 * |x|, and SWEPT(f), which gives function f its name for V; this file undefines them. */

/* The sums over every second order. Two such structures have all orders; their additions do not depend on each
 * other, so that a processor makes them at the same time. */
typedef struct {
    V value, size, slope, slope_size;
} SWEPT(partial_sums);

/* Multiplies the row x_k by `factor`, and adds it to the partial sums; `order` is k. With has_slope_sums it also
 * adds to slope and slope_size. */
JET_INLINE void SWEPT(scale_row_and_add)(SWEPT(partial_sums) * sums, V *row, double factor, double order,
                                         bool has_slope_sums)
{
    const V none = {0}, now = *row * factor, size = SIZE(now);
    *row = now;
    sums->value += now;
    sums->size = JET_FUSED(V, order + none, size, sums->size);
    if (has_slope_sums) sums->slope = JET_FUSED(V, order + none, now, sums->slope);
    if (has_slope_sums) sums->slope_size = JET_FUSED(V, order - 1 + none, order * size, sums->slope_size);
}

JET_INLINE void SWEPT(rescale_and_sum_rows)(const tvi_taylor_rows *rows, const double *power, double *x,
                                            const tvi_taylor_sums *sums, bool has_slope_sums, int here)
{
    const V none = {0};
    SWEPT(partial_sums) a = {none, none, none, none}, b = a;
    const size_t stride = rows->order_stride;
    int k = rows->degree;
    for (; k > rows->least; k -= 2) {
        SWEPT(scale_row_and_add)(&a, (V *)(x + (size_t)k * stride + here), power[k], k, has_slope_sums);
        SWEPT(scale_row_and_add)(&b, (V *)(x + (size_t)(k - 1) * stride + here), power[k - 1], k - 1, has_slope_sums);
    }
    if (k == rows->least)
        SWEPT(scale_row_and_add)(&a, (V *)(x + (size_t)k * stride + here), power[k], k, has_slope_sums);
    V value = a.value + b.value, size = a.size + b.size;
    if (has_slope_sums) {
        V *const row = (V *)(x + stride + here);
        const V now = *row * power[1], size_of_now = SIZE(now);
        *row = now;
        value += now;
        size += size_of_now;
        *(V *)(sums->slope_sum + here) = a.slope + b.slope;
        *(V *)(sums->slope_size_sum + here) = a.slope_size + b.slope_size + size_of_now;
    }
    *(V *)(sums->value_sum + here) = value;
    *(V *)(sums->size_sum + here) = size;
}

#undef V
#undef SIZE
#undef SWEPT
