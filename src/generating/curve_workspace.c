/* curve_workspace.c - allocates the workspace of a method that expands one Taylor curve, and fills the tables of
 * weights that depend on the method alone (docs/method.md section 3). curve_stepper.c calls it. */
#include "generating/curve.h"
#include "generating/curve_stepper.h"
#include "method/method.h"

#include <math.h>

typedef tvi_curve_workspace work;

static void allocate_corrected_curve(tvi_corrected_curve *c, tvi_arena *arena, const tvi_system *system,
                                     const tvi_options *options, bool has_symplectic_end_corrections)
{
    const tvi_curve_definition *definition = &tvi_find_method(options)->curve;
    const tvi_action sizes = tvi_create_unallocated_action(system, options);
    const size_t n = (size_t)system->n;
    const tvi_jacobians jacobians =
        has_symplectic_end_corrections ? tvi_curve_choose_jacobian_method(system) : TVI_NO_JACOBIANS;
    c->system = system;
    c->n = system->n;
    c->span = definition->step_span;
    c->p_degree = sizes.p_degree;
    c->definition = definition;
    const bool has_products = jacobians == TVI_JACOBIAN_PRODUCTS;
    c->solver = has_products ? tvi_choose_curve_isa_functions(system->field_series)->matrix_free_solver
                             : &tvi_solver_by_matrices;
    tvi_curve_allocate(&c->curve, arena, system, sizes.order_count - 1, jacobians);
    for (int i = 0; i < TVI_END_SUMS; i++) c->ends[i] = tvi_combination_allocate(&c->curve, arena);
    c->momentum_term_abs_sum_weights = tvi_combination_allocate(&c->curve, arena);
    double **const corrections[] = {&c->start_correction_q, &c->start_correction_p, &c->increment_correction_q,
                                    &c->increment_correction_p};
    for (size_t i = 0; i < sizeof corrections / sizeof *corrections; i++)
        *corrections[i] = tvi_arena_allocate_doubles(arena, n);
    if (!has_symplectic_end_corrections) return;
    const size_t seeds = ((size_t)c->curve.highest_order + 1) * n;
    c->momentum_term_abs_sum = tvi_arena_allocate_doubles(arena, n);
    c->gradient_then_solution = tvi_arena_allocate_doubles(arena, 2 * n);
    c->solver->allocate(c, arena);
    c->action_gradient_by_coefficients_Q = tvi_arena_allocate_doubles(arena, seeds);
    c->action_gradient_by_coefficients_U = tvi_arena_allocate_doubles(arena, seeds);
}

/* Allocates what the method "taylor" has: a curve without corrections, whose steps may adapt to a tolerance. */
static void allocate_plain_taylor_step(work *w, tvi_arena *arena)
{
    const tvi_curve *curve = &w->corrected_curve.curve;
    const tvi_system *system = curve->system;
    w->last_adapted_step_size = tvi_arena_allocate_copied(arena, sizeof(double));
    tvi_allocate_increment_refinement(&w->refinement, arena, curve);
    if (system->form != TVI_SEPARABLE) return;
    w->field_tape_values_at_step_end = tvi_arena_allocate_block(arena, system->field_values, 1, 1, 0);
    tvi_roundoff_allocate(&w->end_field_roundoff, arena, system);
}

void *tvi_curve_workspace_allocate(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    work *workspace = tvi_arena_allocate(arena, sizeof *workspace);
    const tvi_curve_definition *definition = &tvi_find_method(options)->curve;
    const bool has_symplectic_end_corrections = definition->equations.upper && options->passes != TVI_PREDICT_ONLY;
    const size_t n = (size_t)system->n;
    work w = {.has_symplectic_end_corrections = has_symplectic_end_corrections,
              .confirms_convergence_by_extra_pass = definition->needs_extra_newton_pass,
              .options = options,
              .q_degree = options->degree};
    allocate_corrected_curve(&w.corrected_curve, arena, system, options, has_symplectic_end_corrections);
    const tvi_curve *curve = &w.corrected_curve.curve;
    tvi_coefficient_combination *const combinations[] = {
        &w.q_start_minus_centre_weights, &w.q_at_centre_weights,    &w.velocity_at_centre_weights,
        &w.scaled_end_velocity_weights,  &w.dense_output_q_weights, &w.dense_output_scaled_p_weights};
    for (size_t i = 0; i < sizeof combinations / sizeof *combinations; i++)
        *combinations[i] = tvi_combination_allocate(curve, arena);
    if (system->form == TVI_LAGRANGIAN) {
        tvi_legendre_allocate(&w.legendre_transform, arena, system);
        w.velocity_guess = tvi_arena_allocate_copied(arena, n * sizeof *w.velocity_guess);
    }
    if (!definition->equations.upper) allocate_plain_taylor_step(&w, arena);
    w.scratch = tvi_arena_allocate_doubles(arena, n);
    w.predicted_state = tvi_arena_allocate_doubles(arena, 2 * n);
    if (has_symplectic_end_corrections) {
        tvi_allocate_action(&w.action, arena, system, options);
        tvi_newton_allocate(&w.newton, arena, 2, system, w.corrected_curve.solver->jacobian != NULL);
    }
    if (workspace) *workspace = w;
    return workspace;
}

/* ---- The weights of the ends ------------------------------------------------------------------------------------- */

/* Sets the combinations that predict a state from a curve: position and velocity (or momentum) at the centre, and a
 * Lagrangian's velocity at the end of the step. */
static void set_predictor_combinations(work *w)
{
    const tvi_curve *curve = &w->corrected_curve.curve;
    const bool hamiltonian = w->corrected_curve.system->form == TVI_HAMILTONIAN;
    const double s = -w->corrected_curve.span.start_s;
    double weight[TVI_MAX_DEGREE + 2];
    for (int k = 0; k <= curve->highest_order; k++) weight[k] = hamiltonian ? pow(s, k) : k > 0 ? k * pow(s, k - 1) : 0;
    tvi_combination_set_weights(&w->velocity_at_centre_weights, curve, hamiltonian, weight);
    tvi_combination_set_power_weights(&w->q_at_centre_weights, curve, false, curve->highest_order, 1, s, 0, 0);
    for (int k = 0; k <= curve->highest_order; k++)
        weight[k] = k > 0 ? k * pow(w->corrected_curve.span.end_s, k - 1) : 0;
    tvi_combination_set_weights(&w->scaled_end_velocity_weights, curve, false, weight);
}

void tvi_curve_workspace_compute_constant_tables(void *workspace)
{
    work *w = workspace;
    tvi_corrected_curve *c = &w->corrected_curve;
    const double from = c->span.start_s, to = c->span.end_s;
    const double factor[4][2] = {{0, 1}, {1, 0}, {1, -1}, {-from / (to - from), to / (to - from)}};
    tvi_curve_fill_constant_tables(&c->curve);
    tvi_curve_set_summed_degrees(&c->curve, w->q_degree, c->p_degree);
    if (w->refinement.high_order_weight) tvi_prepare_increment_refinement(&w->refinement, &c->curve);
    for (int of_momentum = 0; of_momentum < 2; of_momentum++)
        for (int i = 0; i < 4; i++)
            tvi_combination_set_power_weights(&c->ends[(of_momentum ? TVI_U_START : TVI_Q_START) + i], &c->curve,
                                              of_momentum, of_momentum ? c->p_degree : w->q_degree, factor[i][0], to,
                                              factor[i][1], from);
    tvi_combination_set_power_weights(&c->momentum_term_abs_sum_weights, &c->curve, true, c->p_degree, 1, 1, 0, 0);
    tvi_combination_set_power_weights(&w->q_start_minus_centre_weights, &c->curve, false, w->q_degree, 1, from, -1, 0);
    set_predictor_combinations(w);
    if (!w->has_symplectic_end_corrections) return;
    tvi_prepare_action_tables(&w->action, w->options, c->span);
    /* A curve of degree 0 is constant, so that passes correct q and p alternately. The contraction of the first pass
     * then does not show that of the later ones. */
    tvi_newton_set_pass_rules(&w->newton, w->options, w->confirms_convergence_by_extra_pass || w->q_degree == 0);
}
