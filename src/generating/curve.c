/* curve.c - expands a Taylor curve: it solves the equations of motion by a recurrence for the coefficients, and for
 * their tangents, and sums them. Steppers call it in each pass (docs/method.md section 2):
 *
 *     separable    (k+1)(k+2) Q_{k+2} = tau^2 M^-1 [s^k] F
 *     Lagrangian   (k+1) [s^{k+1}] L_v = tau [s^k] L_q, solved for V_{k+1} with L_vv at the centre
 *     Hamiltonian  (k+1) Q_{k+1} = tau [s^k] H_p,  (k+1) P_{k+1} = -tau [s^k] H_q
 *
 * Here [s^k] x is the coefficient of s^k in the series of x, and V_k that of the velocity. The field is evaluated as a
 * power series along the curve, one order after the other. Coefficients are divided by k, and not multiplied by tau /
 * k, which would have the same roundoff in every step, so that the energy would drift (docs/method.md section 6). With
 * kappa = tau / m, which scales momenta, tau^2 / m is kappa tau. */
#include "generating/curve.h"
#include "algebra/tail.h"
#include "vector.h"

#include <math.h>
#include <string.h>

void tvi_curve_allocate(tvi_curve *curve, tvi_arena *arena, const tvi_system *system, int highest_order,
                        tvi_jacobians jacobians)
{
    const size_t orders = (size_t)highest_order + 1, n = (size_t)system->n,
                 slots = (size_t)system->field_series->slot_count,
                 lanes = 2 * n < CURVE_TANGENT_DIRECTIONS ? 2 * n : CURVE_TANGENT_DIRECTIONS;
    *curve = (tvi_curve){.system = system, .jacobians.use = jacobians, .n = system->n, .highest_order = highest_order};
    tvi_arena_allocate_each(arena, n,
                            (double **[]){&curve->kappa, &curve->sizes.dq, &curve->sizes.u, &curve->sizes.share,
                                          &curve->sizes.ratio, NULL});
    tvi_arena_allocate_each(arena, orders + 1, (double **[]){&curve->one_over, &curve->log_of, NULL});
    curve->sizes.q_sum = tvi_series_sum_allocate(curve, arena);
    curve->sizes.u_sum = tvi_series_sum_allocate(curve, arena);
    curve->series = tvi_arena_allocate_block(arena, system->field_series, highest_order + 1, 1, 0);
    if (jacobians == TVI_JACOBIAN_PRODUCTS)
        tvi_arena_allocate_each(arena, orders * slots,
                                (double **[]){&curve->jacobians.tangents, &curve->jacobians.adjoints, NULL});
    if (jacobians == TVI_JACOBIAN_MATRICES) {
        curve->jacobians.tangents = tvi_arena_allocate_doubles(arena, orders * slots * lanes);
        tvi_arena_allocate_each(arena, 2 * n, (double **[]){&curve->jacobians.dz, &curve->jacobians.U_product, NULL});
        curve->jacobians.of_sum = tvi_arena_allocate_doubles(arena, 2 * n * n);
        curve->jacobians.dQ_dz = tvi_arena_allocate_doubles(arena, orders * n * 2 * n);
        if (system->form != TVI_SEPARABLE)
            curve->jacobians.dU_dz = tvi_arena_allocate_doubles(arena, orders * n * 2 * n);
    }
    if (system->form == TVI_SEPARABLE) return;
    tvi_factor_allocate(&curve->centre.L_vv, arena, system->n);
    curve->centre.dslots_dv = tvi_arena_allocate_doubles(arena, slots * n);
    curve->centre.right_sides = tvi_arena_allocate_doubles(arena, n * lanes);
    curve->centre.column = tvi_arena_allocate_doubles(arena, n);
}

void tvi_curve_fill_tables(tvi_curve *curve)
{
    for (int i = 0; i < curve->n; i++) curve->kappa[i] = 1;
    for (int k = 1; k <= curve->highest_order + 1; k++) {
        curve->one_over[k] = 1.0 / k;
        curve->log_of[k] = log(k);
    }
}

/* ---- Lagrangians: order k in three steps ------------------------------------------------------------------------- */

/* First the field is computed with V_k = 0, which omits the term L_vv V_k of [s^k] L_v. Then the equations are solved
 * for V_k. Last, each slot of the order gets its missing term: its derivatives by the velocity at the centre, which are
 * the same for all orders, times V_k. Tangents have the same recurrence, in `lanes` directions. */

/* Returns the first slot that the tape computes; before it are the inputs, the time and the constants. */
static int first_computed_slot(const tvi_system *system)
{
    return system->input_count + system->uses_time + system->field_series->constant_count;
}

tvi_status tvi_curve_factor_L_vv(tvi_curve *curve)
{
    const tvi_system *system = curve->system;
    const int n = curve->n, *output = system->field_series->output_slot;
    double *by_v = curve->centre.dslots_dv;
    memset(by_v, 0, (size_t)(first_computed_slot(system) * n) * sizeof *by_v);
    for (int i = 0; i < n; i++) by_v[(n + i) * n + i] = 1;
    jet_sweep_tangents(system->field_series, curve->series, by_v, 0, n);
    for (int i = 0; i < n; i++)
        memcpy(curve->centre.L_vv.lu + i * n, by_v + output[n + i] * n, (size_t)n * sizeof *by_v);
    return tvi_factor_compute(&curve->centre.L_vv);
}

/* Sets Q_k = tau V_{k-1} / k, and V_k = 0. Vectors are of lanes, not of components: V_{k-1} was stored number by
 * number, and a load that covers several short stores has to wait for the cache. */
static void set_lagrangian_Q(const tvi_curve *curve, int k, int lanes, const double *previous, double *restrict order)
{
    const int n = curve->n;
    for (int i = 0; i < n; i++)
        for (int lane = 0; lane < lanes; lane++) {
            order[i * lanes + lane] = curve->tau * previous[(n + i) * lanes + lane] / k;
            order[(n + i) * lanes + lane] = 0;
        }
}

#define ADD_VELOCITY(V, S)                                                                                             \
    {                                                                                                                  \
        V sum = JET_OF(V, row, 0);                                                                                     \
        for (int i = 0; i < n; i++) sum += by_v[i] * JET_OF(V, V_k, i);                                                \
        JET_AT(V, row, 0) = sum;                                                                                       \
    }

/* Solves L_vv V_k = tau [s^{k-1}] L_q / k - [s^k] L_v, and adds to all slots of the order their terms with V_k. */
static void solve_for_velocity(const tvi_curve *curve, int k, int lanes, const double *previous, double *order)
{
    const int n = curve->n, slots = (int)curve_stride(curve), *output = curve->system->field_series->output_slot;
    const size_t stride = (size_t)lanes;
    double *V_k = order + n * lanes, *column = curve->centre.column;
    for (int i = 0; i < n; i++) {
        const double *L_q = previous + output[i] * lanes, *L_v = order + output[n + i] * lanes;
        for (int lane = 0; lane < lanes; lane++)
            curve->centre.right_sides[i * lanes + lane] = curve->tau * L_q[lane] / k - L_v[lane];
    }
    for (int lane = 0; lane < lanes; lane++) {
        for (int i = 0; i < n; i++) column[i] = curve->centre.right_sides[i * lanes + lane];
        tvi_factor_solve(&curve->centre.L_vv, column);
        for (int i = 0; i < n; i++) V_k[i * lanes + lane] = column[i];
    }
    if (k == curve->highest_order) return;
    for (int slot = first_computed_slot(curve->system); slot < slots; slot++) {
        const double *by_v = curve->centre.dslots_dv + slot * n;
        double *row = order + slot * lanes;
        JET_BLOCKS(lanes, ADD_VELOCITY, );
    }
}

static tvi_status expand_lagrangian(tvi_curve *curve)
{
    const size_t stride = curve_stride(curve);
    const jet_tape *tape = curve->system->field_series;
    double *order = curve->series;
    if (!jet_sweep_series(tape, curve->series, 0, 1)) return TVI_EDOMAIN;
    const tvi_status status = tvi_curve_factor_L_vv(curve);
    for (int k = 1; k <= curve->highest_order && status == TVI_OK; k++) {
        order += stride;
        set_lagrangian_Q(curve, k, 1, order - stride, order);
        (void)jet_sweep_series(tape, curve->series, k, 1);
        solve_for_velocity(curve, k, 1, order - stride, order);
    }
    return status;
}

/* ---- Separable systems and Hamiltonians -------------------------------------------------------------------------- */

/* SET_SEPARABLE and SET_HAMILTONIAN store whole vectors, since the next orders load whole vectors: a load that covers
 * several short stores has to wait for the cache. */
#define SET_SEPARABLE(V, S) JET_AT(V, q, 0) = JET_OF(V, kappa, 0) * JET_GATHER(V, field, output + here) * tau / divisor;
#define SET_HAMILTONIAN(V, S)                                                                                          \
    {                                                                                                                  \
        JET_AT(V, q, 0) = JET_GATHER(V, field, output + n + here) * tau / divisor;                                     \
        JET_AT(V, p, 0) = JET_GATHER(V, field, output + here) * -tau / divisor;                                        \
    }

tvi_status tvi_curve_expand(tvi_curve *curve, double centre)
{
    enum { stride = 0 };
    const tvi_system *system = curve->system;
    const tvi_form form = system->form;
    const int n = curve->n, orders_ahead = form == TVI_SEPARABLE ? 2 : 1, *output = system->field_series->output_slot;
    const double tau = curve->tau, *kappa = curve->kappa;
    tvi_status status = TVI_OK;
    if (system->uses_time) {
        curve_Q(curve, 0)[system->input_count] = centre;
        if (curve->highest_order > 0) curve_Q(curve, 1)[system->input_count] = tau;
    }
    if (form == TVI_LAGRANGIAN) status = expand_lagrangian(curve);
    for (int k = 0; k + orders_ahead <= curve->highest_order && form != TVI_LAGRANGIAN; k++) {
        const double divisor = form == TVI_SEPARABLE ? (k + 1) * (k + 2) : k + 1, *field = curve_Q(curve, k);
        double *q = curve_Q(curve, k + orders_ahead), *p = q + n;
        if (!jet_sweep_series(system->field_series, curve->series, k, 1)) status = TVI_EDOMAIN;
        if (form == TVI_SEPARABLE) JET_BLOCKS(n, SET_SEPARABLE, );
        else JET_BLOCKS(n, SET_HAMILTONIAN, );
    }
    if (status != TVI_OK) return status;
    return tvi_rows_are_finite(curve->highest_order + 1, curve_stride(curve), system->input_count, curve->series)
               ? TVI_OK
               : TVI_ENONFINITE;
}

/* ---- Tangents ---------------------------------------------------------------------------------------------------- */

#define SET_TANGENT(V, S) JET_AT(V, next, 0) = factor * JET_OF(V, field, 0);

/* Sets next = factor field, of one component's tangents. */
static void set_tangent_row(int lanes, double factor, const double *field, double *next)
{
    enum { stride = 0 };
    JET_BLOCKS(lanes, SET_TANGENT, );
}

void tvi_curve_expand_tangents(tvi_curve *curve, int lanes)
{
    const tvi_system *system = curve->system;
    const tvi_form form = system->form;
    const int n = curve->n, *output = system->field_series->output_slot;
    const int orders_ahead = form == TVI_SEPARABLE ? 2 : form == TVI_HAMILTONIAN ? 1 : 0;
    const size_t stride = curve_stride(curve) * (size_t)lanes;
    for (int k = 0; k + orders_ahead <= curve->highest_order; k++) {
        double *order = curve->jacobians.tangents + (size_t)k * stride, *next = order + (size_t)orders_ahead * stride;
        if (form == TVI_LAGRANGIAN && k > 0) set_lagrangian_Q(curve, k, lanes, order - stride, order);
        jet_sweep_tangents(system->field_series, curve->series, curve->jacobians.tangents, k, lanes);
        if (form == TVI_LAGRANGIAN && k > 0) solve_for_velocity(curve, k, lanes, order - stride, order);
        for (int i = 0; i < n && form == TVI_SEPARABLE; i++)
            set_tangent_row(lanes, curve->kappa[i] * (curve->tau / ((k + 1) * (k + 2))), order + output[i] * lanes,
                            next + i * lanes);
        for (int i = 0; i < n && form == TVI_HAMILTONIAN; i++) {
            set_tangent_row(lanes, curve->tau / (k + 1), order + output[n + i] * lanes, next + i * lanes);
            set_tangent_row(lanes, -(curve->tau / (k + 1)), order + output[i] * lanes, next + (n + i) * lanes);
        }
    }
}

/* ---- Sums of the coefficients ------------------------------------------------------------------------------------ */

tvi_series_sum tvi_series_sum_allocate(const tvi_curve *curve, tvi_arena *arena)
{
    return (tvi_series_sum){false, tvi_arena_allocate_doubles(arena, (size_t)curve->highest_order + 1)};
}

void tvi_series_sum_set(tvi_series_sum *sum, const tvi_curve *curve, bool of_U, const double weight[])
{
    /* Of a separable system U_{k-1} = k Q_k. */
    const bool shifts = of_U && curve->system->form == TVI_SEPARABLE;
    sum->is_of_U = of_U && !shifts;
    sum->weight[0] = shifts ? 0 : weight[0];
    for (int k = 1; k <= curve->highest_order; k++) sum->weight[k] = shifts ? k * weight[k - 1] : weight[k];
}

void tvi_series_sum_set_powers(tvi_series_sum *sum, const tvi_curve *curve, bool of_U, int degree, double a, double s_a,
                               double b, double s_b)
{
    double weight[TVI_MAX_DEGREE + 2] = {0};
    for (int k = 0; k <= degree; k++) weight[k] = a * pow(s_a, k) + b * pow(s_b, k);
    tvi_series_sum_set(sum, curve, of_U, weight);
}

void tvi_series_sum_compute(const tvi_curve *curve, const tvi_series_sum *sum, double out[])
{
    series_sum_add_up(curve, sum, false, out);
}

void tvi_curve_z_sizes(const tvi_curve *curve, double size[])
{
    const int n = curve->n;
    const bool hamiltonian = curve->system->form == TVI_HAMILTONIAN;
    memset(size, 0, 2 * (size_t)n * sizeof *size);
    for (int k = curve->highest_order; k >= 0; k--) {
        const double *Q = curve_Q(curve, k), *second = hamiltonian ? Q + n : Q;
        for (int i = 0; i < n; i++) {
            size[i] += fabs(Q[i]);
            if (k > 0 || hamiltonian) size[n + i] += fabs(second[i]);
        }
    }
}

/* ---- The tail ---------------------------------------------------------------------------------------------------- */

void tvi_curve_set_degrees(tvi_curve *curve, int q_degree, int p_degree)
{
    double weight[TVI_MAX_DEGREE + 2] = {0};
    curve->q_degree = q_degree;
    curve->p_degree = p_degree;
    for (int k = 0; k <= q_degree; k++) weight[k] = k;
    tvi_series_sum_set(&curve->sizes.q_sum, curve, false, weight);
    for (int k = p_degree + 1; k <= q_degree; k++) weight[k] = 0;
    weight[0] = 1;
    tvi_series_sum_set(&curve->sizes.u_sum, curve, true, weight);
}

void tvi_curve_compute_sizes(const tvi_curve *curve)
{
    series_sum_add_up(curve, &curve->sizes.q_sum, true, curve->sizes.dq);
    series_sum_add_up(curve, &curve->sizes.u_sum, true, curve->sizes.u);
}

double tvi_curve_tail(const tvi_curve *curve)
{
    const tvi_system *system = curve->system;
    const int q_degree = curve->q_degree, p_degree = curve->p_degree;
    if (p_degree < 2) return 0;
    for (int i = 0; i < curve->n; i++) {
        /* The last terms of u and q; that of q counts where no masses give it. */
        const double u_last = p_degree * fabs(curve_U(curve, p_degree, i)),
                     q_last = system->form == TVI_SEPARABLE ? 0 : q_degree * fabs(curve_Q(curve, q_degree)[i]);
        const tvi_component_sizes_in_step component = {
            .momentum_size = curve->sizes.u[i],
            .q_change_size = curve->sizes.dq[i],
            .p_change_by_last_term = u_last,
            .q_change_by_last_term = q_last,
            .coordinate_size = fabs(curve_Q(curve, 0)[i]),
            .one_over_momentum_size = 1 / tvi_larger(curve->sizes.u[i], TVI_LEAST_SIZE),
            .one_over_q_change_size = 1 / tvi_larger(curve->sizes.dq[i], TVI_LEAST_SIZE)};
        curve->sizes.share[i] = tvi_component_motion_share(&component, system->tail.has_shares_without_momenta);
        curve->sizes.ratio[i] = tvi_component_last_term_ratio(&component);
    }
    return tvi_compute_tail(&system->tail.subsystems, curve->n, curve->sizes.share, curve->sizes.ratio);
}

/* ---- Another unit of time ---------------------------------------------------------------------------------------- */

/* The coefficients are rescaled and summed in one sweep over them. */

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

/* The sums of a block of components of one series, q or u: its value, its size, and both of its slope, over every
 * second order. Two such structures have all orders; their additions do not depend on each other, so that a processor
 * makes them at the same time. */
typedef struct {
    double value[BLOCK], size[BLOCK], slope[BLOCK], slope_size[BLOCK];
} block_sums;

/* Multiplies `width` components of row k, from first_component on, by power[k], and adds them to the sums. */
JET_INLINE void rescale_row(const taylor_rows *rows, const double power[], int k, int first_component, int width,
                            bool sums_slope, block_sums *sums)
{
    double *x = rows->x + (size_t)k * rows->stride + first_component;
    JET_UNROLL(1) /* so that gcc makes vectors of the components */
    for (int i = 0; i < width; i++) {
        const double x_k = x[i] * power[k], size = fabs(x_k);
        x[i] = x_k;
        sums->value[i] += x_k;
        sums->size[i] = JET_FUSED(k, size, sums->size[i]);
        if (sums_slope) sums->slope[i] = JET_FUSED(k, x_k, sums->slope[i]);
        if (sums_slope) sums->slope_size[i] = JET_FUSED(k - 1, k * size, sums->slope_size[i]);
    }
}

/* Rescales `width` components in all rows, from first_component on, and computes their sums: value and size, and if
 * sums_slope is set also slope and slope_size. The width and sums_slope are constants in each call. */
JET_INLINE void rescale_block(const taylor_rows *rows, const double power[], int first_component, int width,
                              bool sums_slope)
{
    block_sums even = {{0}, {0}, {0}, {0}}, odd = even;
    int k = rows->degree;
    for (; k > rows->least; k -= 2) {
        rescale_row(rows, power, k, first_component, width, sums_slope, &even);
        rescale_row(rows, power, k - 1, first_component, width, sums_slope, &odd);
    }
    if (k == rows->least) rescale_row(rows, power, k, first_component, width, sums_slope, &even);
    double *x_1 = rows->x + rows->stride + first_component;
    for (int i = 0; i < width; i++) {
        double value = even.value[i] + odd.value[i], size = even.size[i] + odd.size[i];
        if (sums_slope) {
            x_1[i] *= power[1];
            value += x_1[i];
            size += fabs(x_1[i]);
            rows->slope[first_component + i] = even.slope[i] + odd.slope[i];
            rows->slope_size[first_component + i] = even.slope_size[i] + odd.slope_size[i] + fabs(x_1[i]);
        }
        rows->value[first_component + i] = value;
        rows->size[first_component + i] = size;
    }
}

JET_INLINE void rescale_rows(const taylor_rows *rows, const double power[], bool sums_slope)
{
    int here = 0;
    for (; here + BLOCK <= rows->components; here += BLOCK) rescale_block(rows, power, here, BLOCK, sums_slope);
    for (; here + 2 <= rows->components; here += 2) rescale_block(rows, power, here, 2, sums_slope);
    for (; here < rows->components; here++) rescale_block(rows, power, here, 1, sums_slope);
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
        const taylor_rows rows = {x,  curve_stride(curve), n, 2, curve->highest_order, dq, curve->sizes.dq,
                                  du, curve->sizes.u};
        rescale_rows(&rows, power, true);
        for (int i = 0; i < n; i++) curve->kappa[i] *= power[1];
        return;
    }
    rescale_components(curve, power, x, n, q_degree, dq, curve->sizes.dq);
    if (form == TVI_HAMILTONIAN) rescale_components(curve, power, x + n, n, p_degree, du, curve->sizes.u);
    for (int i = 0; i < n && form == TVI_LAGRANGIAN; i++)
        rescale_components(curve, power, x + curve->system->field_series->output_slot[n + i], 1, p_degree, du + i,
                           curve->sizes.u + i);
    for (int i = 0; i < n; i++) curve->sizes.u[i] += fabs(curve_U(curve, 0, i));
}
