/* refine.c - computes the increments of a Taylor curve X(s) more accurately than double precision. It integrates the
 * residual d of the differential equation that roundoff leaves, in long double. curve_stepper.c calls it for small
 * tolerances (docs/method.md section 6):
 *     separable      d = h^2 M^-1 F(Q) - Q'',      dq = Q(1) - q + int (1 - s) d,   h M^-1 dp = Q'(1) - Q'(0) + int d,
 *     Hamiltonian    d = h (H_p, -H_q)(X) - X',    (dq, dp) = X(1) - X(0) + int d,
 * with the state and its low-order part in X(0), and in Q'(0) = h M^-1 p. In a step of the size that step_size.h
 * chooses, coefficient k is e^(-2 k) times the state, and its roundoff is e^(-2 k) times that of the state. High
 * coefficients are therefore summed in double precision, and d is nearly a polynomial of low degree, for which Gauss'
 * two nodes suffice.
 *
 * Without it an orbit of Kepler's to t = 250 with the tolerance DBL_EPSILON has an energy error of 2e-15 in place of at
 * most 2e-16. The tests energy_beyond_roundoff and closed_forms_beyond_roundoff of tests/events/test_tolerance.c then
 * fail, and no other does. */
#include "generating/refine.h"
#include "algebra/weigh.h"

/* The two nodes have equal weights. */
enum { NODES = 2 };
static const long double node[NODES] = {0.211324865405187117745L, 0.788675134594812882255L};

/* The indices of the sums over the coefficients: VALUE + j for the state X at node j; RATE + j for its derivative
 * there, X', or Q'' of a separable system; END for X(1); SLOPE for Q'(1) of a separable system. LOW is the highest
 * order that is summed in long double. */
enum { VALUE, RATE = NODES, END = 2 * NODES, SLOPE, LOW = TVI_REFINE_LOW };

/* The step whose increments are computed. */
typedef struct {
    const tvi_increment_refinement *refinement;
    const tvi_curve *curve;
    const tvi_system *system;
    const tvi_step_origin *origin;
    long double h;
} refinement_step;

bool tvi_needs_refined_increments(const tvi_system *system, double tolerance)
{
    return tolerance < REFINE_MAX_TOLERANCE && system->form != TVI_LAGRANGIAN;
}

/* ---- The tables -------------------------------------------------------------------------------------------------- */

void tvi_allocate_increment_refinement(tvi_increment_refinement *refinement, tvi_arena *arena, const tvi_curve *curve)
{
    const tvi_system *system = curve->system;
    const size_t inputs = (size_t)system->input_count, slots = (size_t)system->field_values->slot_count;
    long double **const vectors[] = {
        &refinement->order_zero_terms, &refinement->order_one_terms,       &refinement->weighted_series_sum,
        &refinement->ode_residual,     &refinement->ode_residual_integral, &refinement->ode_residual_double_integral,
        &refinement->field_slots};
    for (int i = 0; i < 7; i++) *vectors[i] = tvi_arena_allocate(arena, (i < 6 ? inputs : slots) * sizeof **vectors[i]);
    refinement->lowest_summed_order = system->form == TVI_SEPARABLE ? 2 : 1;
    refinement->high_order_weight =
        tvi_arena_allocate_doubles(arena, TVI_REFINE_SUMS * ((size_t)curve->highest_order + 1));
    refinement->high_order_sum = tvi_arena_allocate_doubles(arena, inputs);
    refinement->field_constants_block = tvi_arena_allocate_block(arena, system->field_values, 1, 1, 0);
}

void tvi_prepare_increment_refinement(tvi_increment_refinement *refinement, const tvi_curve *curve)
{
    long double power[NODES] = {1, 1};
    for (int k = 0; k <= curve->highest_order; k++) {
        long double weight[TVI_REFINE_SUMS] = {[END] = 1, [SLOPE] = k};
        for (int j = 0; j < NODES; j++) {
            weight[VALUE + j] = power[j];
            weight[RATE + j] = refinement->lowest_summed_order == 2 ? k * (k - 1) * power[j] / (node[j] * node[j])
                                                                    : k * power[j] / node[j];
            power[j] *= node[j];
        }
        for (int sum = 0; sum < TVI_REFINE_SUMS && k >= refinement->lowest_summed_order; sum++)
            if (k <= LOW) refinement->low_order_weight[sum][k] = weight[sum];
            else refinement->high_order_weight[sum * (curve->highest_order + 1) + k] = (double)weight[sum];
    }
}

/* ---- The residual ------------------------------------------------------------------------------------------------ */

/* Returns the sum, [inputs], of the terms of order lowest_summed_order and higher of one quantity: of X, X' or Q'' at a
 * node, or of X or Q' at the end of the step. weight_set_index is the index of the quantity: VALUE + j, RATE + j, END
 * or SLOPE. The terms above the order LOW are added in double precision. */
static const long double *compute_weighted_series_sum_of_inputs(const refinement_step *step, int weight_set_index)
{
    const tvi_increment_refinement *refinement = step->refinement;
    const tvi_curve *curve = step->curve;
    const size_t orders = (size_t)curve->highest_order + 1, inputs = (size_t)step->system->input_count;
    const int highest_order = curve->highest_order < LOW ? curve->highest_order : LOW;
    memset(refinement->high_order_sum, 0, inputs * sizeof *refinement->high_order_sum);
    tvi_add_weighted_rows(orders, refinement->high_order_weight + (size_t)weight_set_index * orders,
                          tvi_curve_order_stride(curve), inputs, curve->series_block, refinement->high_order_sum);
    for (size_t i = 0; i < inputs; i++) {
        refinement->weighted_series_sum[i] = refinement->high_order_sum[i];
        for (int k = highest_order; k >= refinement->lowest_summed_order; k--)
            refinement->weighted_series_sum[i] +=
                refinement->low_order_weight[weight_set_index][k] * tvi_curve_field_inputs_of_order(curve, k)[i];
    }
    return refinement->weighted_series_sum;
}

static void set_low_order_terms(const refinement_step *step)
{
    const int n = step->system->n;
    const tvi_step_origin *o = step->origin;
    const tvi_increment_refinement *refinement = step->refinement;
    for (int i = 0; i < n; i++) {
        const long double p = o->p[i] + (long double)o->p_low[i];
        refinement->order_zero_terms[i] = o->q[i] + (long double)o->q_low[i];
        if (step->system->form == TVI_SEPARABLE) refinement->order_one_terms[i] = step->h * p / step->system->mass[i];
        else refinement->order_zero_terms[n + i] = p;
    }
}

/* Returns the derivative of input i by s that the equations of motion give, with the last values of the field: the
 * second derivative h^2 M^-1 F for a separable system, otherwise h times the derivative by time. */
static long double compute_derivative_from_field(const refinement_step *step, int i)
{
    const int n = step->system->n, *output = step->system->field_values->output_slot;
    const long double *y = step->refinement->field_slots, h = step->h;
    if (step->system->form == TVI_SEPARABLE) return h * y[output[i]] / step->system->mass[i] * h;
    return i < n ? h * y[output[n + i]] : -h * y[output[i - n]];
}

static void compute_ode_residual_at_node(const refinement_step *step, int j)
{
    const tvi_increment_refinement *refinement = step->refinement;
    const int inputs = step->system->input_count;
    const long double *sum = compute_weighted_series_sum_of_inputs(step, VALUE + j);
    for (int i = 0; i < inputs; i++)
        refinement->field_slots[i] =
            refinement->order_zero_terms[i] + (node[j] * refinement->order_one_terms[i] + sum[i]);
    if (step->system->uses_time)
        refinement->field_slots[inputs] = step->origin->t + (step->origin->t_low + node[j] * step->h);
    jet_sweep_long_double_values(step->system->field_values, refinement->field_constants_block,
                                 refinement->field_slots);
    sum = compute_weighted_series_sum_of_inputs(step, RATE + j);
    for (int i = 0; i < inputs; i++) refinement->ode_residual[i] = compute_derivative_from_field(step, i) - sum[i];
}

static void integrate_ode_residual(const refinement_step *step)
{
    const tvi_increment_refinement *refinement = step->refinement;
    const size_t bytes = (size_t)step->system->input_count * sizeof *refinement->ode_residual_integral;
    memset(refinement->ode_residual_integral, 0, bytes);
    memset(refinement->ode_residual_double_integral, 0, bytes);
    for (int j = 0; j < NODES; j++) {
        compute_ode_residual_at_node(step, j);
        for (int i = 0; i < step->system->input_count; i++) {
            refinement->ode_residual_integral[i] += refinement->ode_residual[i] / NODES;
            refinement->ode_residual_double_integral[i] += (1 - node[j]) * refinement->ode_residual[i] / NODES;
        }
    }
}

/* ---- The increments ---------------------------------------------------------------------------------------------- */

static void split_into_two_doubles(long double x, double *high, double *low)
{
    *high = (double)x;
    *low = (double)(x - *high);
}

void tvi_compute_refined_increments(const tvi_increment_refinement *refinement, const tvi_curve *curve, double h,
                                    const tvi_step_origin *origin, const tvi_increments *increments)
{
    const tvi_system *system = curve->system;
    const refinement_step step = {refinement, curve, system, origin, h};
    const int n = system->n;
    set_low_order_terms(&step);
    integrate_ode_residual(&step);
    const bool separable = system->form == TVI_SEPARABLE;
    const long double *sum = compute_weighted_series_sum_of_inputs(&step, END),
                      *of_q = separable ? refinement->ode_residual_double_integral : refinement->ode_residual_integral;
    for (int i = 0; i < n; i++)
        split_into_two_doubles(refinement->order_one_terms[i] + (sum[i] + of_q[i]), &increments->dq[i],
                               &increments->dq_low[i]);
    if (separable) sum = compute_weighted_series_sum_of_inputs(&step, SLOPE);
    for (int i = 0; i < n; i++) {
        const int at = separable ? i : n + i;
        const long double rise = sum[at] + refinement->ode_residual_integral[at];
        split_into_two_doubles(separable ? system->mass[i] / step.h * rise : rise, &increments->dp[i],
                               &increments->dp_low[i]);
    }
}
