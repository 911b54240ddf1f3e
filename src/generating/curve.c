/* curve.c - the equations of motion as a recurrence for the coefficients of the curve (docs/method.md section 2):
 *
 *     separable    (k+1)(k+2) Q_{k+2} = tau^2 M^-1 [s^k] F
 *
 *     Lagrangian   (k+1) [s^{k+1}] L_v = tau [s^k] L_q, solved for the velocity's coefficient k+1 with L_vv at
 *         the centre
 *
 *     Hamiltonian  (k+1) Q_{k+1} = tau [s^k] H_p,  (k+1) P_{k+1} = -tau [s^k] H_q
 *
 * each with the field evaluated as a power series along the curve, one order after the other. */
#include "generating/curve.h"
#include "algebra/tail.h"
#include "algebra/weigh.h"

#include <math.h>
#include <string.h>

void tvi_curve_take(tvi_curve *curve, tvi_arena *arena, const tvi_system *system, int top, tvi_jacobians jacobians)
{
    const size_t orders = (size_t)top + 1, n = (size_t)system->n, jacobian = orders * n * 2 * n;
    memset(curve, 0, sizeof *curve);
    curve->system = system;
    curve->jacobians = jacobians;
    curve->n = system->n;
    curve->top = top;
    curve->kappa = tvi_arena_doubles(arena, n);
    curve->movement = tvi_arena_doubles(arena, n);
    curve->momentum = tvi_arena_doubles(arena, n);
    curve->q_sizes = tvi_combination_take(curve, arena);
    curve->u_sizes = tvi_combination_take(curve, arena);
    curve->x = tvi_arena_block(arena, system->field_series, top + 1, 1, 0);
    if (jacobians == TVI_JACOBIAN_PRODUCTS) {
        curve->dx = tvi_arena_doubles(arena, orders * tvi_curve_slots(curve));
        curve->bar = tvi_arena_doubles(arena, orders * tvi_curve_slots(curve));
    }
    if (jacobians == TVI_JACOBIAN_MATRICES) {
        curve->dx = tvi_arena_doubles(arena, orders * tvi_curve_slots(curve) * tvi_curve_lanes(curve));
        curve->dz = tvi_arena_doubles(arena, 2 * n);
        curve->dQ = tvi_arena_doubles(arena, jacobian);
        curve->by_U = tvi_arena_doubles(arena, 2 * n);
        curve->dU = system->form == TVI_SEPARABLE ? NULL : tvi_arena_doubles(arena, jacobian);
    }
    if (system->form != TVI_SEPARABLE) {
        tvi_factor_take(&curve->slope, arena, system->n);
        curve->columns = tvi_arena_doubles(arena, tvi_curve_slots(curve) * n);
    }
}

void tvi_curve_prepare(tvi_curve *curve)
{
    for (int i = 0; i < curve->n; i++) curve->kappa[i] = 1;
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
    const int n = curve->n;
    curve->tau = tau;
    memcpy(tvi_curve_input(curve, 0), z, (size_t)n * sizeof *z);
    switch (curve->system->form) {
    case TVI_SEPARABLE:
        memcpy(tvi_curve_input(curve, 1), z + n, (size_t)n * sizeof *z);
        for (int i = 0; i < n; i++) curve->kappa[i] = tau / curve->system->mass[i];
        break;
    case TVI_LAGRANGIAN:
        for (int i = 0; i < n; i++) (tvi_curve_input(curve, 0) + curve->n)[i] = z[n + i] / tau;
        break;
    case TVI_HAMILTONIAN: memcpy((tvi_curve_input(curve, 0) + curve->n), z + n, (size_t)n * sizeof *z); break;
    }
}

static tvi_status expand_by_orders(tvi_curve *curve)
{
    const jet_tape *tape = curve->system->field_series;
    const bool is_separable = curve->system->form == TVI_SEPARABLE;
    const tvi_recurrence of = {curve->n, tvi_curve_slots(curve), tape->output, curve->x, curve->kappa, curve->tau};
    for (int k = 0; k + 1 + is_separable <= curve->top; k++) {
        if (!jet_sweep_series(tape, curve->x, k, 1)) return TVI_EDOMAIN;
        if (is_separable) tvi_advance_separable(&of, k);
        else tvi_advance_hamiltonian(&of, k);
    }
    return TVI_OK;
}

/* All orders at once, where there is generated code. */
static tvi_status expand_at_once(tvi_curve *curve)
{
    const tvi_curve_code *code = tvi_curve_code_of(curve);
    if (!code) return expand_by_orders(curve);
    const bool inside = code->expand(curve->x, curve->kappa, curve->tau);
    return inside || jet_refuse_sweep(curve->system->field_series, curve->x, 1) ? TVI_OK : TVI_EDOMAIN;
}

/* By tangents of order 0 along the second input. */
tvi_status tvi_curve_factor_slope(tvi_curve *curve)
{
    const jet_tape *tape = curve->system->field_series;
    const size_t n = (size_t)curve->n;
    memset(curve->columns, 0, 2 * n * n * sizeof *curve->columns);
    for (size_t i = 0; i < n; i++) curve->columns[(n + i) * n + i] = 1;
    if (curve->system->uses_time) memset(curve->columns + 2 * n * n, 0, n * sizeof *curve->columns);
    jet_sweep_tangents(tape, curve->x, curve->columns, 0, curve->n);
    for (size_t i = 0; i < n; i++)
        memcpy(curve->slope.lu + i * n, curve->columns + (size_t)tape->output[n + i] * n, n * sizeof(double));
    return tvi_factor_compute(&curve->slope);
}

/* Velocity V = (1/tau) dQ/ds. Order k of the field is run with V_k = 0, which leaves L_vv V_k out of [s^k] L_v; the
 * missing part is solved for and the order run again. */
static tvi_status expand_lagrangian(tvi_curve *curve)
{
    const jet_tape *tape = curve->system->field_series;
    const int n = curve->n;
    double *rest = curve->columns;
    if (!jet_sweep_series(tape, curve->x, 0, 1)) return TVI_EDOMAIN;
    const tvi_status status = tvi_curve_factor_slope(curve);
    if (status != TVI_OK) return status;
    for (int k = 1; k <= curve->top; k++) {
        for (int i = 0; i < n; i++) {
            tvi_curve_input(curve, k)[i] = curve->tau * (tvi_curve_input(curve, k - 1) + curve->n)[i] / k;
            (tvi_curve_input(curve, k) + curve->n)[i] = 0;
        }
        (void)jet_sweep_series(tape, curve->x, k, 1);
        for (int i = 0; i < n; i++)
            rest[i] = curve->tau * tvi_curve_field(curve, k - 1, i) / k - tvi_curve_field(curve, k, n + i);
        tvi_factor_solve(&curve->slope, rest);
        memcpy((tvi_curve_input(curve, k) + curve->n), rest, (size_t)n * sizeof *rest);
        if (k < curve->top) (void)jet_sweep_series(tape, curve->x, k, 1);
    }
    return TVI_OK;
}

/* What is infinite or no number makes a sum that is so. */
static bool is_finite(const tvi_curve *curve)
{
    const size_t stride = tvi_curve_slots(curve);
    bool finite = true;
    for (int i = 0; i < curve->system->inputs; i++) {
        const double *x = curve->x + i;
        double sum = 0;
        for (int k = 0; k <= curve->top; k++, x += stride) sum += *x;
        finite &= isfinite(sum);
    }
    return finite;
}

tvi_status tvi_curve_expand(tvi_curve *curve, double centre)
{
    const tvi_system *system = curve->system;
    curve->centre = centre;
    if (system->uses_time) {
        curve->x[system->inputs] = centre;
        if (curve->top > 0) tvi_curve_input(curve, 1)[system->inputs] = curve->tau;
    }
    const tvi_status status = system->form == TVI_LAGRANGIAN ? expand_lagrangian(curve) : expand_at_once(curve);
    if (status != TVI_OK) return status;
    return is_finite(curve) ? TVI_OK : TVI_ENONFINITE;
}

/* ---- Sums over the coefficients ---------------------------------------------------------------------------------- */

void tvi_curve_momenta(const tvi_curve *curve, int degree, double out[])
{
    const int n = curve->n;
    const bool is_separable = curve->system->form == TVI_SEPARABLE;
    for (int k = 0; k <= degree; k++, out += n) {
        const bool is_next = is_separable && k < curve->top;
        const double *next = is_next ? tvi_curve_input(curve, k + 1) : NULL;
        for (int i = 0; i < n; i++) out[i] = is_next ? (k + 1) * next[i] / curve->kappa[i] : tvi_curve_U(curve, k, i);
    }
}

typedef void adder(size_t, const double[], size_t, size_t, const double[], double[]);

static inline void sum_by(adder *add, const tvi_curve *curve, const tvi_combination *combination, double out[])
{
    const int n = curve->n;
    const int *slot = curve->system->field_series->output + n;
    memset(out, 0, (size_t)n * sizeof *out);
    const size_t orders = (size_t)curve->top + 1, stride = tvi_curve_slots(curve);
    if (combination->of_momentum && curve->system->form == TVI_LAGRANGIAN)
        for (int i = 0; i < n; i++) add(orders, combination->weight, stride, 1, curve->x + slot[i], out + i);
    else add(orders, combination->weight, stride, (size_t)n, curve->x + (combination->of_momentum ? n : 0), out);
}

void tvi_curve_sum(const tvi_curve *curve, const tvi_combination *combination, double out[])
{
    sum_by(tvi_add_rows, curve, combination, out);
}

void tvi_curve_sum_sizes(const tvi_curve *curve, bool of_momentum, const double weight[], double out[])
{
    double of_rows[TVI_MAX_DEGREE + 2];
    tvi_combination sizes = {.weight = of_rows};
    tvi_combination_set(&sizes, curve, of_momentum, weight);
    sum_by(tvi_add_sizes, curve, &sizes, out);
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

/* p = |U_0| + sum k |U_k|, q = sum k |Q_k|: the terms of p' and q' at the ends, in a unit of scaled time. */
static tvi_tail_part tail_part(const tvi_curve *curve, int i)
{
    const int q_degree = curve->q_degree, p_degree = curve->p_degree;
    const bool has_masses = curve->system->form == TVI_SEPARABLE;
    const double momentum = curve->momentum[i], movement = curve->movement[i];
    return (tvi_tail_part){.momentum = momentum,
                           .movement = movement,
                           .last_p = p_degree * fabs(tvi_curve_U(curve, p_degree, i)),
                           .last_q = has_masses ? 0 : q_degree * fabs(tvi_curve_Q(curve, q_degree)[i]),
                           .place = fabs(tvi_curve_Q(curve, 0)[i]),
                           .per_momentum = 1 / momentum,
                           .per_movement = 1 / movement};
}

void tvi_curve_measure(const tvi_curve *curve)
{
    sum_by(tvi_add_sizes, curve, &curve->q_sizes, curve->movement);
    sum_by(tvi_add_sizes, curve, &curve->u_sizes, curve->momentum);
}

double tvi_curve_tail(const tvi_curve *curve)
{
    const bool has_masses = curve->system->form == TVI_SEPARABLE;
    tvi_tail_survey survey = {0, 0, 0};
    if (curve->p_degree < 2) return 0;
    for (int i = 0; i < curve->n; i++) {
        const tvi_tail_part part = tail_part(curve, i);
        tvi_tail_look(&survey, &part, has_masses);
    }
    if (tvi_tail_is_known(&survey)) return survey.ratio;
    double tail = 0;
    for (int i = 0; i < curve->n; i++) {
        const tvi_tail_part part = tail_part(curve, i);
        tail = fmax(tail, tvi_tail_of(tvi_tail_ratio(&part), tvi_tail_share(&part, has_masses), survey.largest));
    }
    return tail;
}

/* |q'| |dp| + |p'| |dq| with what the last two terms are, of which one may happen to be small: terms of which each is
 * three quarters of the one before it add up to three times the last. */
double tvi_curve_change(const tvi_curve *curve)
{
    enum { OFTEN = 8 };
    double sum = 0;
    if (curve->p_degree < 2) return INFINITY;
    for (int i = 0; i < curve->n; i++) {
        double of_q = 0, of_p = 0;
        for (int last = 0; last < 2; last++) {
            of_q += fabs(tvi_curve_Q(curve, curve->q_degree - last)[i]);
            of_p += fabs(tvi_curve_U(curve, curve->p_degree - last, i));
        }
        sum += (curve->movement[i] * of_p + curve->momentum[i] * of_q) / fabs(curve->kappa[i]);
    }
    return OFTEN * sum / fabs(curve->tau);
}
