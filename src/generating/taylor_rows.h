/* taylor_rows.h - rescales the coefficients of a Taylor curve and sums them, for one vector of components.
 * taylor_sweep.h includes this text once for each vector type V. The including file defines V, SIZE(x), which is
 * |x|, and SWEPT(f), which gives function f its name for V; this file undefines them. */

/* The partial sums over the even or over the odd orders. The additions of the two chains do not depend on each other,
 * so that a processor makes them at the same time. */
typedef struct {
    V rise, size, slope, bend;
} SWEPT(chain);

/* Multiplies a row by `power`, and adds it to the sums of the chain; weight is its order k. */
JET_INLINE void SWEPT(add_row)(SWEPT(chain) * chain, V *row, double power, double weight, bool has_slope)
{
    const V none = {0}, now = *row * power, size = SIZE(now);
    *row = now;
    chain->rise += now;
    chain->size = JET_FUSED(V, weight + none, size, chain->size);
    if (has_slope) chain->slope = JET_FUSED(V, weight + none, now, chain->slope);
    if (has_slope) chain->bend = JET_FUSED(V, weight - 1 + none, weight * size, chain->bend);
}

JET_INLINE void SWEPT(rows)(const tvi_taylor_rows *rows, const double *power, double *x, const tvi_taylor_sums *sums,
                            bool has_slope, int here)
{
    const V none = {0};
    SWEPT(chain) a = {none, none, none, none}, b = a;
    int k = rows->degree;
    for (; k > rows->least; k -= 2) {
        SWEPT(add_row)(&a, (V *)(x + (size_t)k * rows->order_stride + here), power[k], k, has_slope);
        SWEPT(add_row)(&b, (V *)(x + (size_t)(k - 1) * rows->order_stride + here), power[k - 1], k - 1, has_slope);
    }
    if (k == rows->least) SWEPT(add_row)(&a, (V *)(x + (size_t)k * rows->order_stride + here), power[k], k, has_slope);
    V rise = a.rise + b.rise, size = a.size + b.size;
    if (has_slope) {
        V *const row = (V *)(x + rows->order_stride + here);
        const V now = *row * power[1], size_of_now = SIZE(now);
        *row = now;
        rise += now;
        size += size_of_now;
        *(V *)(sums->slope_sum + here) = a.slope + b.slope;
        *(V *)(sums->slope_size_sum + here) = a.bend + b.bend + size_of_now;
    }
    *(V *)(sums->value_sum + here) = rise;
    *(V *)(sums->size_sum + here) = size;
}

#undef V
#undef SIZE
#undef SWEPT
