/* rescale.c - rescales the coefficients of a Taylor curve to another unit of time and sums them, in one sweep over the
 * coefficients. It is compiled once for each instruction set; taylor.c calls it through tvi_curve_code. */
#include "fused.h"
#include "generating/curve.h"
#include "rule.h"

#include <math.h>

/* The rows x_k, k = least .. degree, of some components, and the sums over them: value = sum x_k and size = sum k
 * |x_k|. The rows of a separable system, whose momentum is the slope of q, begin with k = 2, but x_1 enters these sums,
 * too. They also have slope = sum k x_k and slope_size = |x_1| + sum (k - 1) k |x_k|. */
typedef struct {
    double *x;
    size_t stride;
    int components, least, degree;
    double *value, *size, *slope, *slope_size;
} taylor_rows;

/* Multiplies row k by power[k], and adds it to the sums number j. There are two sums over every second order, whose
 * additions do not depend on each other, so that a processor makes them at the same time. */
#define ADD_ROW(V, j, k)                                                                                               \
    {                                                                                                                  \
        const V x_k = JET_AT(V, rows->x, k) * power[k], size_k = TVI_ITS_SIZE(V, x_k), order = (double)(k) + none;     \
        JET_AT(V, rows->x, k) = x_k;                                                                                   \
        value[j] += x_k;                                                                                               \
        size[j] = JET_FUSED(V, order, size_k, size[j]);                                                                \
        if (has_slope) slope[j] = JET_FUSED(V, order, x_k, slope[j]);                                                  \
        if (has_slope) slope_size[j] = JET_FUSED(V, order - 1, order * size_k, slope_size[j]);                         \
    }
#define RESCALE(V, S)                                                                                                  \
    {                                                                                                                  \
        const V none = {0};                                                                                            \
        V value[2] = {none, none}, size[2] = {none, none}, slope[2] = {none, none}, slope_size[2] = {none, none};      \
        int k = rows->degree;                                                                                          \
        for (; k > rows->least; k -= 2) {                                                                              \
            ADD_ROW(V, 0, k)                                                                                           \
            ADD_ROW(V, 1, k - 1)                                                                                       \
        }                                                                                                              \
        if (k == rows->least) ADD_ROW(V, 0, k)                                                                         \
        V value_sum = value[0] + value[1], size_sum = size[0] + size[1];                                               \
        if (has_slope) {                                                                                               \
            const V x_1 = JET_AT(V, rows->x, 1) * power[1], size_1 = TVI_ITS_SIZE(V, x_1);                             \
            JET_AT(V, rows->x, 1) = x_1;                                                                               \
            value_sum += x_1;                                                                                          \
            size_sum += size_1;                                                                                        \
            *(V *)(rows->slope + here) = slope[0] + slope[1];                                                          \
            *(V *)(rows->slope_size + here) = slope_size[0] + slope_size[1] + size_1;                                  \
        }                                                                                                              \
        *(V *)(rows->value + here) = value_sum;                                                                        \
        *(V *)(rows->size + here) = size_sum;                                                                          \
    }

/* has_slope is a constant: whether there are sums of the slope. */
JET_INLINE void rescale_rows(const taylor_rows *rows, const double power[], bool has_slope)
{
    const size_t stride = rows->stride;
    JET_BLOCKS(rows->components, RESCALE, );
}

/* Rescales and sums the rows of `components` components of a system that is not separable, from x on; the rows above
 * `degree` do not enter the sums. */
static void rescale_components(const tvi_curve *curve, const double power[], double *x, int components, int degree,
                               double *value, double *size)
{
    const taylor_rows rows = {x, curve_stride(curve), components, 1, degree, value, size, NULL, NULL};
    for (int k = degree + 1; k <= curve->highest_order; k++)
        for (int i = 0; i < components; i++) x[(size_t)k * rows.stride + (size_t)i] *= power[k];
    rescale_rows(&rows, power, false);
}

/* Computes power[k] = factor^k, k = 0 .. highest_order and up to 3 more, in chains that do not wait for each other. */
enum { CHAINS = 4 };
static void compute_powers(double factor, int highest_order, double power[])
{
    const double second = factor * factor, fourth = second * second;
    double next[CHAINS] = {1, factor, second, second * factor};
    for (int k = 0; k <= highest_order; k += CHAINS)
        for (int i = 0; i < CHAINS; i++) {
            power[k + i] = next[i];
            next[i] *= fourth;
        }
}

#define tvi_curve_rescale JET_FOR_ISA(tvi_curve_rescale)
void tvi_curve_rescale(tvi_curve *curve, double factor, double dq[], double du[]);

void tvi_curve_rescale(tvi_curve *curve, double factor, double dq[], double du[])
{
    const int n = curve->n, q_degree = curve->q_degree, p_degree = curve->p_degree;
    const tvi_form form = curve->system->form;
    double power[TVI_MAX_DEGREE + 1 + CHAINS], *x = curve->series;
    compute_powers(factor, curve->highest_order, power);
    curve->tau *= factor;
    if (form == TVI_SEPARABLE) { /* all rows are Q_k; U_0 = Q_1 does not enter the increment of u */
        const taylor_rows rows = {x,  curve_stride(curve), n, 2, curve->highest_order, dq, curve->dq_size,
                                  du, curve->u_size};
        rescale_rows(&rows, power, true);
        for (int i = 0; i < n; i++) curve->kappa[i] *= power[1];
        return;
    }
    rescale_components(curve, power, x, n, q_degree, dq, curve->dq_size);
    if (form == TVI_HAMILTONIAN) rescale_components(curve, power, x + n, n, p_degree, du, curve->u_size);
    for (int i = 0; i < n && form == TVI_LAGRANGIAN; i++)
        rescale_components(curve, power, x + curve->system->field_series->output_slot[n + i], 1, p_degree, du + i,
                           curve->u_size + i);
    for (int i = 0; i < n; i++) curve->u_size[i] += fabs(curve_U(curve, 0, i));
}
