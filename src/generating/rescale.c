/* rescale.c - rescales the coefficients of a Taylor curve to another unit of time and sums them, in one sweep over the
 * coefficients. It is compiled once for each instruction set; taylor.c calls it through tvi_curve_code. */
#include "generating/curve.h"
#include "vector.h"

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

/* The widest block of components: a vector of the instruction set, so that the sums of a block stay in registers. */
enum { BLOCK = sizeof(jet_widest) / sizeof(double) };

/* The sums of a block over every second order. Two such structures have all orders; their additions do not depend on
 * each other, so that a processor makes them at the same time. */
typedef struct {
    double value[BLOCK], size[BLOCK], slope[BLOCK], slope_size[BLOCK];
} block_sums;

/* Multiplies row k, from component `here` on, by power[k], and adds it to the sums. */
JET_INLINE void rescale_row(const taylor_rows *rows, const double power[], int k, int here, int width, bool has_slope,
                            block_sums *sums)
{
    double *x = rows->x + (size_t)k * rows->stride + here;
    JET_UNROLL(1) /* so that gcc makes vectors of the components */
    for (int i = 0; i < width; i++) {
        const double x_k = x[i] * power[k], size = fabs(x_k);
        x[i] = x_k;
        sums->value[i] += x_k;
        sums->size[i] = JET_FUSED(k, size, sums->size[i]);
        if (has_slope) sums->slope[i] = JET_FUSED(k, x_k, sums->slope[i]);
        if (has_slope) sums->slope_size[i] = JET_FUSED(k - 1, k * size, sums->slope_size[i]);
    }
}

/* Rescales and sums `width` components from number `here` on. width and has_slope, whether there are sums of the slope,
 * are constants. */
JET_INLINE void rescale_block(const taylor_rows *rows, const double power[], int here, int width, bool has_slope)
{
    block_sums even = {{0}, {0}, {0}, {0}}, odd = even;
    int k = rows->degree;
    for (; k > rows->least; k -= 2) {
        rescale_row(rows, power, k, here, width, has_slope, &even);
        rescale_row(rows, power, k - 1, here, width, has_slope, &odd);
    }
    if (k == rows->least) rescale_row(rows, power, k, here, width, has_slope, &even);
    double *x_1 = rows->x + rows->stride + here;
    for (int i = 0; i < width; i++) {
        double value = even.value[i] + odd.value[i], size = even.size[i] + odd.size[i];
        if (has_slope) {
            x_1[i] *= power[1];
            value += x_1[i];
            size += fabs(x_1[i]);
            rows->slope[here + i] = even.slope[i] + odd.slope[i];
            rows->slope_size[here + i] = even.slope_size[i] + odd.slope_size[i] + fabs(x_1[i]);
        }
        rows->value[here + i] = value;
        rows->size[here + i] = size;
    }
}

JET_INLINE void rescale_rows(const taylor_rows *rows, const double power[], bool has_slope)
{
    int here = 0;
    for (; here + BLOCK <= rows->components; here += BLOCK) rescale_block(rows, power, here, BLOCK, has_slope);
    for (; here + 2 <= rows->components; here += 2) rescale_block(rows, power, here, 2, has_slope);
    for (; here < rows->components; here++) rescale_block(rows, power, here, 1, has_slope);
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
