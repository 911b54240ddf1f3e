/* refine.c - computes the increments of a Taylor curve X(s) more accurately than double precision. It integrates the
 * residual d of the differential equation that roundoff leaves, in long double. taylor.c calls it for small
 * tolerances (docs/method.md section 6):
 *     separable      d = h^2 M^-1 F(Q) - Q'',      dq = Q(1) - q + int (1 - s) d,   h M^-1 dp = Q'(1) - Q'(0) + int d,
 *     Hamiltonian    d = h (H_p, -H_q)(X) - X',    (dq, dp) = X(1) - X(0) + int d,
 * with the state and its low-order part in X(0), and in Q'(0) = h M^-1 p. In a step of the size that taylor.c
 * chooses, coefficient k is e^(-2 k) times the state, and its roundoff is e^(-2 k) times that of the state. High
 * coefficients are therefore summed in double precision, and d is nearly a polynomial of low degree, for which Gauss'
 * two nodes suffice.
 *
 * Without it an orbit of Kepler's to t = 250 with the tolerance DBL_EPSILON has an energy error of 2e-15 in place of at
 * most 2e-16. The tests energy_beyond_roundoff and closed_forms_beyond_roundoff of tests/events/test_tolerance.c then
 * fail, and no other does. */
#include "generating/step.h"

/* The two nodes have equal weights. */
enum { NODES = 2 };
static const long double node[NODES] = {0.211324865405187117745L, 0.788675134594812882255L};

/* The indices of the sums over the coefficients: VALUE + j for the state X at node j; RATE + j for its derivative
 * there, X', or Q'' of a separable system; END for X(1); SLOPE for Q'(1) of a separable system. LOW is the highest
 * order that is summed in long double. */
enum { VALUE, RATE = NODES, END = 2 * NODES, SLOPE, LOW = TVI_REFINE_LOW };

void tvi_refine_allocate(tvi_refinement *refinement, tvi_arena *arena, const tvi_curve *curve)
{
    tvi_refinement *f = refinement;
    const tvi_system *system = curve->system;
    const size_t inputs = (size_t)system->input_count, slots = (size_t)system->field_values->slot_count;
    long double **const vectors[] = {&f->X_0, &f->X_1, &f->sum, &f->d, &f->int_d, &f->int_int_d, &f->slots};
    for (int i = 0; i < 7; i++) *vectors[i] = tvi_arena_allocate(arena, (i < 6 ? inputs : slots) * sizeof **vectors[i]);
    f->lowest = system->form == TVI_SEPARABLE ? 2 : 1;
    f->high_weight = tvi_arena_allocate_doubles(arena, TVI_REFINE_SUMS * ((size_t)curve->highest_order + 1));
    f->high_sum = tvi_arena_allocate_doubles(arena, inputs);
    f->constants = tvi_arena_allocate_block(arena, system->field_values, 1, 1, 0);
}

void tvi_refine_set_tables(tvi_refinement *refinement, const tvi_curve *curve)
{
    const int lowest = refinement->lowest, orders = curve->highest_order + 1;
    long double power[NODES] = {1, 1};
    for (int k = 0; k < orders; k++) {
        long double weight[TVI_REFINE_SUMS] = {[END] = 1, [SLOPE] = k};
        for (int j = 0; j < NODES; j++) {
            weight[VALUE + j] = power[j];
            weight[RATE + j] = lowest == 2 ? k * (k - 1) * power[j] / (node[j] * node[j]) : k * power[j] / node[j];
            power[j] *= node[j];
        }
        for (int sum = 0; sum < TVI_REFINE_SUMS && k >= lowest; sum++)
            if (k <= LOW) refinement->low_weight[sum][k] = weight[sum];
            else refinement->high_weight[sum * orders + k] = (double)weight[sum];
    }
}

/* Returns the sum number `which`, [inputs], of the terms from the lowest order on. The terms above the order LOW are
 * added in double precision. */
static const long double *compute_sum(const tvi_refinement *f, const tvi_curve *curve, int which)
{
    const size_t orders = (size_t)curve->highest_order + 1, inputs = (size_t)curve->system->input_count;
    const int low = curve->highest_order < LOW ? curve->highest_order : LOW;
    memset(f->high_sum, 0, inputs * sizeof *f->high_sum);
    tvi_add_weighted_rows(orders, f->high_weight + (size_t)which * orders, curve_stride(curve), inputs, curve->series,
                          f->high_sum);
    for (size_t i = 0; i < inputs; i++) {
        f->sum[i] = f->high_sum[i];
        for (int k = low; k >= f->lowest; k--) f->sum[i] += f->low_weight[which][k] * curve_Q(curve, k)[i];
    }
    return f->sum;
}

/* Computes the integrals of d over the step, and of (1 - s) d. */
static void integrate_d(const tvi_refinement *f, const tvi_curve *curve, long double h, const tvi_step_origin *origin)
{
    const tvi_system *system = curve->system;
    const jet_tape *tape = system->field_values;
    const int n = system->n, inputs = system->input_count, *output = tape->output_slot;
    const long double *y = f->slots, *sum;
    memset(f->int_d, 0, (size_t)inputs * sizeof *f->int_d);
    memset(f->int_int_d, 0, (size_t)inputs * sizeof *f->int_int_d);
    for (int j = 0; j < NODES; j++) {
        sum = compute_sum(f, curve, VALUE + j);
        for (int i = 0; i < inputs; i++) f->slots[i] = f->X_0[i] + (node[j] * f->X_1[i] + sum[i]);
        if (system->uses_time) f->slots[inputs] = origin->t + (origin->t_low + node[j] * h);
        jet_sweep_long_double_values(tape, f->constants, f->slots);
        sum = compute_sum(f, curve, RATE + j);
        for (int i = 0; i < inputs; i++) {
            const long double rate = system->form == TVI_SEPARABLE ? h * y[output[i]] / system->mass[i] * h
                                     : i < n                       ? h * y[output[n + i]]
                                                                   : -h * y[output[i - n]];
            f->d[i] = rate - sum[i];
            f->int_d[i] += f->d[i] / NODES;
            f->int_int_d[i] += (1 - node[j]) * f->d[i] / NODES;
        }
    }
}

static void split_into_two_doubles(long double x, double *high, double *low)
{
    *high = (double)x;
    *low = (double)(x - *high);
}

void tvi_refine_increments(const tvi_refinement *refinement, const tvi_curve *curve, double step,
                           const tvi_step_origin *origin, const tvi_increments *increments)
{
    const tvi_refinement *f = refinement;
    const tvi_system *system = curve->system;
    const bool separable = system->form == TVI_SEPARABLE;
    const long double h = step, *sum;
    const int n = system->n;
    for (int i = 0; i < n; i++) {
        const long double p = origin->p[i] + (long double)origin->p_low[i];
        f->X_0[i] = origin->q[i] + (long double)origin->q_low[i];
        if (separable) f->X_1[i] = h * p / system->mass[i];
        else f->X_0[n + i] = p;
    }
    integrate_d(f, curve, h, origin);
    sum = compute_sum(f, curve, END);
    for (int i = 0; i < n; i++)
        split_into_two_doubles(f->X_1[i] + (sum[i] + (separable ? f->int_int_d : f->int_d)[i]), &increments->dq[i],
                               &increments->dq_low[i]);
    if (separable) sum = compute_sum(f, curve, SLOPE);
    for (int i = 0; i < n; i++) {
        const int at = separable ? i : n + i;
        const long double rise = sum[at] + f->int_d[at];
        split_into_two_doubles(separable ? system->mass[i] / h * rise : rise, &increments->dp[i],
                               &increments->dp_low[i]);
    }
}
