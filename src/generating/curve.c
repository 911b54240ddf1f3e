/* curve.c - expands the curve: it solves the equations of motion by a recurrence for the coefficients (docs/method.md
 * section 2):
 *
 *     separable    (k+1)(k+2) Q_{k+2} = tau^2 M^-1 [s^k] F
 *
 *     Lagrangian   (k+1) [s^{k+1}] L_v = tau [s^k] L_q, solved for the velocity's coefficient k+1 with L_vv at
 *         the centre
 *
 *     Hamiltonian  (k+1) Q_{k+1} = tau [s^k] H_p,  (k+1) P_{k+1} = -tau [s^k] H_q
 *
 * The field is evaluated as a power series along the curve, one order after the other. */
#include "generating/curve.h"
#include "generating/orders.h"
#include "generating/seeds.h"

#include <math.h>
#include <string.h>

/* Returns the system's generated code if it was made for this highest order, otherwise NULL. */
static const tvi_curve_code *code_of(const tvi_system *system, int top)
{
    const tvi_curve_code *code = system->code ? system->code->curve : NULL;
    return code && code->top == top ? code : NULL;
}

void tvi_curve_take(tvi_curve *curve, tvi_arena *arena, const tvi_system *system, int top, tvi_jacobians jacobians,
                    int width)
{
    const size_t orders = (size_t)top + 1, n = (size_t)system->n, numbers = n * (size_t)width,
                 jacobian = orders * n * 2 * numbers, slots = (size_t)system->field_series->slots * (size_t)width;
    memset(curve, 0, sizeof *curve);
    curve->system = system;
    curve->code = width > 1 ? NULL : code_of(system, top);
    curve->jacobians = jacobians;
    curve->n = system->n;
    curve->width = width;
    curve->top = top;
    curve->kappa = tvi_arena_doubles(arena, n);
    curve->movement = tvi_arena_doubles(arena, numbers);
    curve->momentum = tvi_arena_doubles(arena, numbers);
    curve->share = tvi_arena_doubles(arena, width > 1 ? numbers : 0);
    curve->ratio = tvi_arena_doubles(arena, width > 1 ? numbers : 0);
    curve->q_sizes = tvi_combination_take(curve, arena);
    curve->u_sizes = tvi_combination_take(curve, arena);
    curve->per = tvi_arena_doubles(arena, orders + 1);
    curve->log_of = tvi_arena_doubles(arena, orders + 1);
    curve->x = tvi_arena_allocate_block(arena, system->field_series, top + 1, width, 0);
    if (jacobians == TVI_JACOBIAN_PRODUCTS) {
        curve->dx = tvi_arena_doubles(arena, orders * slots);
        curve->bar = tvi_arena_doubles(arena, orders * slots);
    }
    if (jacobians == TVI_JACOBIAN_MATRICES) {
        curve->dx = tvi_arena_doubles(arena, orders * slots * tvi_curve_lanes(curve));
        curve->dz = tvi_arena_doubles(arena, 2 * numbers);
        curve->dQ = tvi_arena_doubles(arena, jacobian);
        curve->by_U = tvi_arena_doubles(arena, 2 * numbers);
        curve->pushed = tvi_arena_doubles(arena, 2 * n * numbers);
        curve->dU = system->form == TVI_SEPARABLE ? NULL : tvi_arena_doubles(arena, jacobian);
    }
    if (system->form != TVI_SEPARABLE) {
        tvi_factor_allocate(&curve->slope, arena, system->n);
        curve->columns = tvi_arena_doubles(arena, slots * n);
        curve->rest = tvi_arena_doubles(arena, n * tvi_curve_lanes(curve));
        curve->column = tvi_arena_doubles(arena, n);
    }
}

void tvi_curve_prepare(tvi_curve *curve)
{
    for (int i = 0; i < curve->n; i++) curve->kappa[i] = 1;
    for (int k = 1; k <= curve->top + 1; k++) {
        curve->per[k] = 1.0 / k;
        curve->log_of[k] = log(k);
    }
}

/* ---- Combinations ------------------------------------------------------------------------------------------------ */

tvi_combination tvi_combination_take(const tvi_curve *curve, tvi_arena *arena)
{
    return (tvi_combination){false, tvi_arena_doubles(arena, (size_t)curve->top + 1)};
}

void tvi_combination_set(tvi_combination *combination, const tvi_curve *curve, bool of_momentum, const double weight[])
{
    const bool shifts = of_momentum && curve->system->form == TVI_SEPARABLE; /* U_k = (k+1) Q_{k+1} */
    combination->of_momentum = of_momentum && !shifts;
    combination->weight[0] = shifts ? 0 : weight[0];
    for (int k = 1; k <= curve->top; k++) combination->weight[k] = shifts ? k * weight[k - 1] : weight[k];
}

void tvi_combination_set_powers(tvi_combination *combination, const tvi_curve *curve, bool of_momentum, int degree,
                                double a, double at, double b, double from)
{
    double weight[TVI_MAX_DEGREE + 2] = {0};
    for (int k = 0; k <= degree; k++) weight[k] = a * pow(at, k) + b * pow(from, k);
    tvi_combination_set(combination, curve, of_momentum, weight);
}

/* ---- The series -------------------------------------------------------------------------------------------------- */

void tvi_curve_set(tvi_curve *curve, double tau, const double z[])
{
    curve_set_step(curve, tau);
    curve_place(curve, z);
}

static tvi_status expand_by_orders(tvi_curve *curve)
{
    tvi_status status = TVI_OK;
    for (int k = 0; k <= curve->top; k++) curve_expand_order(curve, k, &status);
    return status;
}

static tvi_status expand_by_code(tvi_curve *curve)
{
    const tvi_status status = curve->code->expand(curve);
    if (status == TVI_EDOMAIN) (void)jet_explain_failed_sweep(curve->system->field_series, curve->x, 1);
    return status;
}

tvi_status tvi_curve_factor_slope(tvi_curve *curve)
{
    orders_find_columns(curve);
    orders_place_slope(curve);
    return tvi_factor_compute(&curve->slope);
}

tvi_status tvi_curve_expand(tvi_curve *curve, double centre)
{
    static const double none = 0;
    curve_place_time(curve, &centre, &none, 0);
    const bool has_code = curve->code && curve->code->expand;
    const tvi_status status = has_code ? expand_by_code(curve) : expand_by_orders(curve);
    if (has_code || status != TVI_OK) return status;
    return curve_is_finite(curve) ? TVI_OK : TVI_ENONFINITE;
}

/* ---- Sums over the coefficients ---------------------------------------------------------------------------------- */

void tvi_curve_sizes(const tvi_curve *curve, double size[])
{
    if (curve->code) curve->code->sizes(curve, size);
    else curve_sizes(curve, size);
}

void tvi_curve_sum(const tvi_curve *curve, const tvi_combination *combination, double out[])
{
    if (curve->code) curve->code->sum(curve, combination, out);
    else curve_sum(curve, combination, out);
}

void tvi_curve_prepare_tail(tvi_curve *curve, int q_degree, int p_degree)
{
    double weight[TVI_MAX_DEGREE + 2] = {0};
    curve->q_degree = q_degree;
    curve->p_degree = p_degree;
    for (int k = 0; k <= q_degree; k++) weight[k] = k;
    tvi_combination_set(&curve->q_sizes, curve, false, weight);
    for (int k = p_degree + 1; k <= q_degree; k++) weight[k] = 0;
    weight[0] = 1;
    tvi_combination_set(&curve->u_sizes, curve, true, weight);
}

void tvi_curve_measure(const tvi_curve *curve) { curve->code ? curve->code->measure(curve) : curve_measure(curve); }

double tvi_curve_tail(const tvi_curve *curve, int m)
{
    return curve->code ? curve->code->tail(curve, m) : curve_tail(curve, m);
}
