/* places.c - Evaluates the curve of the last step at any fraction of the step, for dense output, and at the samples in
 * which events are searched. Its functions are `interpolate` and `sample` of the stepper (galerkin.c). */
#include "galerkin/step.h"

enum { MAX_LANES = TVI_GALERKIN_MAX_LANES };

/* Computes x [components][point_count]: the components of the curve at the fractions theta of the step. integral_table
 * [lanes][point_count] contains the integrals of l_j / b_j from 0 to theta (coefficients.h), or the double integrals
 * for the positions of a separable system. */
static void integrate_impulses(const galerkin_stepper *stepper, tvi_component_range range, int point_count,
                               const double theta[], const double *integral_table, const double *impulses,
                               const double *start, const double *drift, const double *change_per_impulse, double *x)
{
    const int lanes = stepper->equations.nodes.lane_count, from = range.first, count = range.end - from;
    const galerkin_curve_at_points_inputs to = {
        lanes, point_count, count, theta, start + from, drift + from, change_per_impulse + from};
    if (count > 0)
        stepper->equations.kernels->evaluate(&to, integral_table, impulses + from * lanes, x + from * point_count);
}

/* Computes the components used_range[0] of q and the components used_range[1] of p at the fractions theta of the step,
 * in q and p [n][point_count]. Integrates the polynomial of degree m - 1 through the rates. */
static void evaluate_curve(const galerkin_stepper *stepper, const tvi_component_range used_range[2], int point_count,
                           const double theta[], const double *single_integral, const double *double_integral,
                           const double q_start[], const double p_start[], double *q, double *p)
{
    const double *impulses = galerkin_find_impulses_of_step(&stepper->predictor, 0), *of_p = impulses;
    const bool separable = galerkin_is_second_order(&stepper->equations);
    if (!separable) of_p += stepper->n * stepper->equations.nodes.lane_count;
    integrate_impulses(stepper, used_range[0], point_count, theta, separable ? double_integral : single_integral,
                       impulses, q_start, stepper->step_inputs.coordinate_drift_over_step,
                       stepper->increment_per_impulse, q);
    integrate_impulses(stepper, used_range[1], point_count, theta, single_integral, of_p, p_start,
                       stepper->predictor.zeros, stepper->increment_per_impulse + stepper->n, p);
}

void tvi_galerkin_compute_dense_output(void *work, double theta, double dq[], double dp[])
{
    const galerkin_stepper *stepper = work;
    const tvi_component_range all[] = {{0, stepper->n}, {0, stepper->n}};
    double single_integral[MAX_LANES] = {0}, double_integral[MAX_LANES] = {0};
    tvi_galerkin_integrate_node_polynomials(&stepper->node_polynomials, theta, single_integral, double_integral);
    evaluate_curve(stepper, all, 1, &theta, single_integral, double_integral, stepper->predictor.zeros,
                   stepper->predictor.zeros, dq, dp);
}

void tvi_galerkin_compute_curve_samples(void *work, const tvi_component_range used_range[2], const double q_start[],
                                        const double p_start[], double *q, double *p)
{
    const galerkin_stepper *stepper = work;
    evaluate_curve(stepper, used_range, TVI_SAMPLES, tvi_sample_theta,
                   stepper->node_polynomials.integral_from_0_to_sample_theta,
                   stepper->node_polynomials.double_integral_from_0_to_sample_theta, q_start, p_start, q, p);
}
