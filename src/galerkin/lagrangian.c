/* lagrangian.c - Evaluates the field of a Lagrangian L(q, v, t): the rate of the positions Q is V, with L_v(Q, V) = P,
 * and the rate of the momenta P is F = L_q(Q, V) (docs/method.md sections 4 and 5).
 *
 * A pass evaluates the gradient (L_q, L_v) at points (Q*, V*) near the nodes. It also evaluates the second derivatives
 * there, unless the last movement was small enough to use the old ones again. Then it iterates, with F expanded to
 * first order about (Q*, V*),
 *
 *     P = p0 + h a F,    V = V* + L_vv^-1 ((P - L_v) - L_vq (Q - Q*)),    Q = q0 + h a V,
 *
 * where L_v and its derivatives are those at (Q*, V*), h is the step size, a the matrix of Gauss collocation and (q0,
 * p0) the state at the start of the step. */
#include "galerkin/lagrangian_passes.h"
#include "galerkin/model.h"
#include "system/legendre.h"

typedef struct {
    lagrangian_pass_context pass_context;
    galerkin_sparse_hessian sparse_hessian;
    tvi_legendre_transform legendre_transform;
    double *start_velocity; /* [n] the velocity at the start of the step */
} lagrangian_work;

static void allocate_velocity_hessian_inverse(lanes_matrix_inverse *inverse, tvi_arena *arena, int n, int lanes)
{
    const size_t numbers = (size_t)n * (size_t)lanes;
    *inverse = (lanes_matrix_inverse){.n = n};
    inverse->matrix = tvi_arena_allocate_doubles(arena, (size_t)n * numbers);
    inverse->inverse = tvi_arena_allocate_doubles(arena, (size_t)n * numbers);
    inverse->scratch_column = tvi_arena_allocate_doubles(arena, numbers);
}

static void allocate_lagrangian_equations(galerkin_equations *equations, tvi_arena *arena)
{
    const tvi_system *system = equations->system;
    const int n = system->n, unknowns = 2 * n;
    const size_t lanes = (size_t)equations->nodes.lane_count, half_size = (size_t)n * lanes;
    lagrangian_work *taken = equations->lagrangian_or_hamiltonian_pass_workspace =
        tvi_arena_allocate(arena, sizeof *taken);
    lagrangian_work work = {.pass_context = {.kernels = equations->kernels}};
    equations->node_value_row_count_read_by_pass = 3 * n;
    equations->nodes.values = tvi_arena_allocate_doubles(arena, 5 * half_size);
    tvi_galerkin_allocate_sparse_hessian(&work.sparse_hessian, arena, equations);
    equations->tape_block = work.sparse_hessian.derivative_tapes.gradient_block;
    equations->impulse_to_predicted_unknown_or_rate_matrix = tvi_arena_allocate_doubles(arena, lanes * lanes);
    double **const rows[] = {&work.pass_context.q_minus_start_q, &work.pass_context.start_q_minus_expansion_point[0],
                             &work.pass_context.start_q_minus_expansion_point[1]};
    for (size_t i = 0; i < 3; i++) *rows[i] = tvi_arena_allocate_doubles(arena, half_size);
    work.pass_context.gradient_at_centre = tvi_arena_allocate_doubles(arena, 2 * half_size);
    work.pass_context.gradient_linearised_in_q_and_v.displacement = tvi_arena_allocate_doubles(arena, 2 * half_size);
    work.start_velocity = tvi_arena_allocate_doubles(arena, (size_t)n);
    tvi_legendre_allocate(&work.legendre_transform, arena, system);
    allocate_velocity_hessian_inverse(&work.pass_context.velocity_hessian_inverse, arena, n,
                                      equations->nodes.lane_count);
    work.pass_context.nodes_with_rates_as_unknowns = equations->nodes;
    work.pass_context.nodes_with_rates_as_unknowns.values =
        equations->nodes.values ? lagrangian_find_values_row(&equations->nodes, unknowns) : NULL;
    work.pass_context.nodes_with_rates_as_unknowns.drift_values =
        tvi_arena_allocate_doubles(arena, (size_t)unknowns * lanes);
    work.pass_context.nodes_with_rates_as_unknowns.unknown_change_per_impulse = equations->rate_per_impulse;
    if (taken) *taken = work;
}

bool tvi_galerkin_invert_with_row_exchanges(const lanes_matrix_inverse *inverse, int lanes, void *lu_factor)
{
    tvi_lu_factor *factor = lu_factor;
    const int n = inverse->n;
    double *x = inverse->scratch_column;
    for (int lane = 0; lane < lanes; lane++) {
        for (int i = 0; i < n * n; i++) factor->lu[i] = inverse->matrix[i * lanes + lane];
        if (tvi_factor_compute(factor) != TVI_OK) return false;
        for (int column = 0; column < n; column++) {
            for (int i = 0; i < n; i++) x[i] = i == column;
            tvi_factor_solve(factor, x);
            for (int i = 0; i < n; i++) inverse->inverse[(i * n + column) * lanes + lane] = x[i];
        }
    }
    return true;
}

static void set_pointers_of_lagrangian_pass_context(lagrangian_pass_context *context,
                                                    const galerkin_equations *equations,
                                                    const galerkin_sparse_hessian *sparse_hessian)
{
    const tvi_system *system = equations->system;
    context->nodes = &equations->nodes;
    context->node_impulse_to_node_unknown_matrix = equations->node_impulse_to_node_unknown_matrix;
    context->rate_row_of_unknown = equations->rate_row_of_unknown;
    context->derivative_tapes = sparse_hessian->derivative_tapes;
    context->tape_slot_of_gradient_component[false] = system->field_values->output_slot;
    context->tape_slot_of_gradient_component[true] = system->hessian_values->output_slot;
    context->gradient_linearised_in_q_and_v =
        (lanes_linearised_gradient){system->n,
                                    equations->nodes.lane_count,
                                    context->gradient_linearised_in_q_and_v.displacement,
                                    context->gradient_at_centre,
                                    sparse_hessian->derivative_tapes.hessian_block,
                                    sparse_hessian->hessian_element,
                                    sparse_hessian->row_end};
}

static void set_tables_of_lagrangian_equations(galerkin_equations *equations)
{
    lagrangian_work *work = equations->lagrangian_or_hamiltonian_pass_workspace;
    tvi_galerkin_set_sparse_hessian_tables(&work->sparse_hessian, equations);
    set_pointers_of_lagrangian_pass_context(&work->pass_context, equations, &work->sparse_hessian);
    work->pass_context.invert_with_row_exchanges = tvi_galerkin_invert_with_row_exchanges;
    work->pass_context.velocity_hessian_inverse_with_row_exchanges = &work->pass_context.velocity_hessian_inverse;
    work->pass_context.velocity_hessian_lu_factor = &work->legendre_transform.jacobian_factor;
    for (int u = 0; u < equations->nodes.unknown_count; u++)
        equations->rate_row_of_unknown[u] = equations->nodes.unknown_count + u;
}

/* ---- The predictor ----------------------------------------------------------------------------------------------- */

static void fill_rows_with_vector(const galerkin_nodes *nodes, int n, int first_row, const double value[])
{
    for (int i = 0; i < n; i++)
        for (int lane = 0; lane < nodes->lane_count; lane++)
            lagrangian_find_values_row(nodes, first_row + i)[lane] = value[i];
}

/* Predicts that Q and P stay as they are at the start of the step, and computes V there by the Legendre transform,
 * whose iteration begins with V = 0. Then moves Q and P by the rates at this point. */
static tvi_status predict_lagrangian_unknowns_from_start(galerkin_equations *equations, const tvi_step_origin *origin)
{
    lagrangian_work *work = equations->lagrangian_or_hamiltonian_pass_workspace;
    const tvi_system *system = equations->system;
    const galerkin_nodes *nodes = &equations->nodes;
    const int n = system->n, lanes = nodes->lane_count,
              *output = work->pass_context.tape_slot_of_gradient_component[false];
    double *velocity = work->start_velocity;
    memset(velocity, 0, (size_t)n * sizeof *velocity);
    const tvi_status status = tvi_legendre_solve(&work->legendre_transform, origin->t, origin->q, origin->p, velocity);
    if (status != TVI_OK) return status;
    fill_rows_with_vector(nodes, n, 0, origin->q);
    fill_rows_with_vector(nodes, n, n, origin->p);
    fill_rows_with_vector(nodes, n, 2 * n, velocity);
    const double *gradient =
        galerkin_evaluate_gradient_at_nodes(&work->pass_context.derivative_tapes, tvi_galerkin_sweep_tape, false,
                                            nodes->values, lagrangian_find_values_row(nodes, 2 * n));
    if (!gradient) return TVI_EDOMAIN;
    for (int i = 0; i < 2 * n; i++)
        memcpy(lagrangian_find_values_row(nodes, 3 * n + i), gradient + output[i] * lanes,
               (size_t)lanes * sizeof *gradient);
    lagrangian_move_q_and_p(&work->pass_context);
    return TVI_OK;
}

/* ---- A pass ------------------------------------------------------------------------------------------------------ */

static tvi_status make_lagrangian_pass(galerkin_equations *equations, double *movement, tvi_stats *stats)
{
    static const tvi_status status[] = {[LAGRANGIAN_PASSED] = TVI_OK,
                                        [LAGRANGIAN_OUTSIDE_DOMAIN] = TVI_EDOMAIN,
                                        [LAGRANGIAN_NONFINITE] = TVI_ENONFINITE,
                                        [LAGRANGIAN_SINGULAR] = TVI_ESINGULAR};
    lagrangian_work *work = equations->lagrangian_or_hamiltonian_pass_workspace;
    const int factors = work->pass_context.velocity_hessian_inversions_made;
    const lagrangian_pass_result passed = lagrangian_make_pass(&work->pass_context, tvi_galerkin_sweep_tape);
    stats->factorisations += (work->pass_context.velocity_hessian_inversions_made - factors) * equations->node_count;
    *movement = work->pass_context.last_pass_movement_square;
    return status[passed];
}

static void emit_lagrangian_equations(jet_text *text, const galerkin_equations *equations)
{
    const lagrangian_work *work = equations->lagrangian_or_hamiltonian_pass_workspace;
    const int unknowns = equations->nodes.unknown_count;
    tvi_galerkin_emit_sparse_hessian(text, &work->sparse_hessian);
    tvi_galerkin_emit_int_array(text, "value_slot", unknowns,
                                work->pass_context.tape_slot_of_gradient_component[false]);
    tvi_galerkin_emit_int_array(text, "hessian_slot", unknowns,
                                work->pass_context.tape_slot_of_gradient_component[true]);
    tvi_galerkin_emit_int_array(text, "rate_row_of_unknown", unknowns, equations->rate_row_of_unknown);
}

const galerkin_field_form tvi_galerkin_form_lagrangian = {allocate_lagrangian_equations,
                                                          set_tables_of_lagrangian_equations,
                                                          predict_lagrangian_unknowns_from_start,
                                                          lagrangian_predict_unknowns,
                                                          make_lagrangian_pass,
                                                          emit_lagrangian_equations,
                                                          tvi_embedded_galerkin_lagrangian};
