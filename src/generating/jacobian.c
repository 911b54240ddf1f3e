/* jacobian.c - computes the Jacobians of a Taylor curve by the state z at its centre, as matrices, from tangents in all
 * directions. It also computes the Jacobians of sums of coefficients, and multiplies Jacobians by vectors. Steppers and
 * solvers call it through curve.h. */
#include "generating/curve.h"
#include "sums.h"

#include <string.h>

/* [coordinates] Separable systems with at least this many coordinates use products of Jacobians with vectors instead of
 * matrices. Products cost less from 6 coordinates or so on, but stiff systems of few bodies at large steps do better
 * with matrices, which can be made anew by differences. */
#define PRODUCTS_MIN_COORDINATES 8 /* found: make performance ONE=cost */

tvi_jacobians tvi_curve_choose_jacobians(const tvi_system *system)
{
    return system->form == TVI_SEPARABLE && system->n >= PRODUCTS_MIN_COORDINATES ? TVI_JACOBIAN_PRODUCTS
                                                                                  : TVI_JACOBIAN_MATRICES;
}

tvi_tapes_of_steps tvi_curve_list_tapes(const tvi_system *system, const tvi_options *options, int points,
                                        tvi_jacobians jacobians)
{
    tvi_tapes_of_steps used = {
        .series_tape_emission = {.name_prefix = "tvi_series", .value_lane_counts = {1}, .needs_series_sweep = true}};
    if (jacobians == TVI_NO_JACOBIANS) return used;
    if (system->form == TVI_HAMILTONIAN)
        used.series_tape_emission.value_lane_counts[1] = points; /* for H_pp at the nodes, one lane for each node */
    used.value_tape_emission = (jet_emission_request){.name_prefix = "tvi_values", .value_lane_counts = {points}};
    if (system->r_dot_Hp_values && options->nodes == TVI_NODES_TRUNCATED)
        used.r_dot_Hp_tape_emission =
            (jet_emission_request){.name_prefix = "tvi_r_dot_Hp", .value_lane_counts = {points}};
    return used;
}

/* ---- Matrices ---------------------------------------------------------------------------------------------------- */

/* The tangents of slot i at order k, in `lanes` directions. */
static double *tangent_row(const tvi_curve *curve, int lanes, int k, int i)
{
    return curve->jacobians.tangents + ((size_t)k * curve_stride(curve) + (size_t)i) * (size_t)lanes;
}

/* Sets the tangents of z to unit vectors, the directions first .. first + lanes - 1. The tangents of the time and of
 * constants are 0 in all orders; they are cleared when the number of lanes changes, which moves them. */
static void set_directions(tvi_curve *curve, int first, int lanes)
{
    const tvi_system *system = curve->system;
    const int n = curve->n, inputs = system->input_count, z_orders = system->form == TVI_SEPARABLE ? 2 : 1;
    const size_t width = (size_t)lanes * sizeof(double);
    const size_t others = (size_t)(system->uses_time + system->field_series->constant_count) * width;
    for (int k = 0; k < z_orders && k <= curve->highest_order; k++)
        memset(tangent_row(curve, lanes, k, 0), 0, (size_t)inputs * width);
    for (int k = 0; k <= curve->highest_order && curve->jacobians.cleared_lanes != lanes; k++)
        memset(tangent_row(curve, lanes, k, inputs), 0, others);
    curve->jacobians.cleared_lanes = lanes;
    for (int d = first; d < first + lanes; d++) {
        const bool in_order_1 = d >= n && system->form == TVI_SEPARABLE;
        double *row = in_order_1 ? tangent_row(curve, lanes, 1, d - n) : tangent_row(curve, lanes, 0, d);
        row[d - first] = d >= n && system->form == TVI_LAGRANGIAN ? 1 / curve->tau : 1;
    }
}

/* Copies the tangents to the columns first .. first + lanes - 1 of a Jacobian. Component i has the slot slot[i], or
 * first_slot + i if slot is NULL. */
static void store_columns(const tvi_curve *curve, int first, int lanes, const int slot[], int first_slot,
                          double *jacobian)
{
    const int n = curve->n;
    for (int k = 0; k <= curve->highest_order; k++)
        for (int i = 0; i < n; i++) {
            const double *tangent = tangent_row(curve, lanes, k, slot ? slot[i] : first_slot + i);
            double *restrict out = jacobian + (k * n + i) * 2 * n + first;
            for (int lane = 0; lane < lanes; lane++) out[lane] = tangent[lane];
        }
}

void tvi_curve_compute_jacobians(tvi_curve *curve)
{
    const int n = curve->n, *output = curve->system->field_series->output_slot;
    const tvi_form form = curve->system->form;
    for (int first = 0; first < 2 * n; first += CURVE_TANGENT_DIRECTIONS) {
        const int left = 2 * n - first, lanes = left < CURVE_TANGENT_DIRECTIONS ? left : CURVE_TANGENT_DIRECTIONS;
        set_directions(curve, first, lanes);
        tvi_curve_expand_tangents(curve, lanes);
        store_columns(curve, first, lanes, NULL, 0, curve->jacobians.dQ_dz);
        if (form == TVI_LAGRANGIAN) store_columns(curve, first, lanes, output + n, 0, curve->jacobians.dU_dz);
        if (form == TVI_HAMILTONIAN) store_columns(curve, first, lanes, NULL, n, curve->jacobians.dU_dz);
    }
}

void tvi_series_sum_compute_jacobian(const tvi_curve *curve, const tvi_series_sum *sum, double matrix[])
{
    jet_combine_rows(curve->highest_order + 1, sum->weight, 1, 2 * curve->n * curve->n,
                     sum->is_of_U ? curve->jacobians.dU_dz : curve->jacobians.dQ_dz, matrix);
}

void tvi_curve_multiply_seeds(tvi_curve *curve, const double seed_Q[], const double seed_U[], double out[])
{
    const int n = curve->n, rows = (curve->highest_order + 1) * n;
    jet_combine_rows(rows, seed_Q, 1, 2 * n, curve->jacobians.dQ_dz, out);
    if (curve->system->form == TVI_SEPARABLE || !seed_U) return;
    jet_combine_rows(rows, seed_U, 1, 2 * n, curve->jacobians.dU_dz, curve->jacobians.U_product);
    for (int d = 0; d < 2 * n; d++) out[d] += curve->jacobians.U_product[d];
}

/* ---- Products with one direction --------------------------------------------------------------------------------- */

void tvi_curve_set_dz(tvi_curve *curve, const double dz[])
{
    const size_t n = (size_t)curve->n;
    if (curve->jacobians.use == TVI_JACOBIAN_MATRICES) {
        memcpy(curve->jacobians.dz, dz, 2 * n * sizeof *dz);
        return;
    }
    memcpy(curve->jacobians.tangents, dz, n * sizeof *dz);
    memcpy(curve->jacobians.tangents + curve_stride(curve), dz + n, n * sizeof *dz);
    tvi_curve_expand_tangents(curve, 1);
}

void tvi_series_sum_compute_change(const tvi_curve *curve, const tvi_series_sum *sum, double out[])
{
    const int n = curve->n;
    memset(out, 0, (size_t)n * sizeof *out);
    if (curve->jacobians.use == TVI_JACOBIAN_PRODUCTS) {
        tvi_add_weighted_rows((size_t)curve->highest_order + 1, sum->weight, curve_stride(curve), (size_t)n,
                              curve->jacobians.tangents, out);
        return;
    }
    tvi_series_sum_compute_jacobian(curve, sum, curve->jacobians.of_sum);
    for (int i = 0; i < n; i++)
        for (int d = 0; d < 2 * n; d++) out[i] += curve->jacobians.of_sum[i * 2 * n + d] * curve->jacobians.dz[d];
}
