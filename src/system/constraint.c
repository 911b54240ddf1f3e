/* constraint.c - Creates a constrained system (constraint.h): a copy of the user's system, and the recording of the
 * user's phi with its first and second derivatives. It also has the functions of the public interface, which compute
 * with the constraints in memory of their own. */
#include "system/constraint.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void tvi_constraints_free(tvi_constraints *constraints)
{
    if (!constraints) return;
    jet_tape_free(constraints->values);
    jet_tape_free(constraints->curvature);
    jet_tape_free(constraints->rates);
    jet_graph_free(constraints->graph);
    free(constraints->phi);
    free(constraints->row_end);
    free(constraints->column);
    free(constraints);
}

uint64_t tvi_constraints_continue_hash(uint64_t hash, const tvi_constraints *constraints)
{
    if (!constraints) return hash;
    const size_t row_bytes = (size_t)constraints->count * sizeof *constraints->row_end;
    hash = jet_continue_hash(hash, constraints->row_end, row_bytes);
    hash = jet_continue_hash(hash, constraints->column, (size_t)constraints->entry_count * sizeof(int));
    hash = jet_tape_continue_hash(hash, constraints->values);
    hash = jet_tape_continue_hash(hash, constraints->curvature);
    return jet_tape_continue_hash(hash, constraints->rates);
}

/* ---- The recording ----------------------------------------------------------------------------------------------- */

/* A recording of constraints that is open. All jets belong to its graph. */
typedef struct {
    tvi_constraints *constraints;
    int n;
    int input_count;                     /* of the graph: 2n + m + 1 */
    jet *q, *d, *mu, t;                  /* The inputs of the graph; q is padded with poison. */
    jet *values, *curvature, *rates;     /* The outputs of the tapes; `values` grows with the entries of G. */
    jet *gradient, *gradient_of_product; /* [input_count] The derivatives of phi_k, and of G_k d. */
} constraint_recording;

static tvi_status begin_recording(constraint_recording *recording, int n, int m)
{
    tvi_constraints *constraints = recording->constraints = calloc(1, sizeof *constraints);
    if (!constraints) return TVI_ENOMEM;
    const size_t outputs = (size_t)n + (size_t)m;
    recording->n = n;
    recording->input_count = 2 * n + m + 1;
    constraints->count = m;
    constraints->graph = jet_graph_create(recording->input_count);
    constraints->phi = tvi_create_unset_outputs(m);
    constraints->row_end = calloc((size_t)m, sizeof *constraints->row_end);
    recording->q = malloc((tvi_padded_vector_count(n) + outputs) * sizeof *recording->q);
    recording->values = malloc((outputs + (size_t)m) * sizeof *recording->values);
    recording->curvature = malloc((outputs + 2 * (size_t)m) * sizeof *recording->curvature);
    recording->gradient = malloc(2 * (size_t)recording->input_count * sizeof *recording->gradient);
    if (!constraints->graph || !constraints->phi || !constraints->row_end || !recording->q || !recording->values ||
        !recording->curvature || !recording->gradient)
        return TVI_ENOMEM;
    jet_graph_set_output_name(constraints->graph, "phi");
    recording->d = recording->q + tvi_padded_vector_count(n);
    recording->mu = recording->d + n;
    recording->rates = recording->curvature + outputs;
    recording->gradient_of_product = recording->gradient + recording->input_count;
    for (int i = 0; i < n; i++) {
        recording->q[i] = jet_graph_input(constraints->graph, i);
        recording->d[i] = jet_graph_input(constraints->graph, n + i);
    }
    for (int k = 0; k < m; k++) recording->mu[k] = jet_graph_input(constraints->graph, 2 * n + k);
    recording->t = jet_graph_input(constraints->graph, 2 * n + m);
    tvi_set_poison_beyond_end(n, recording->q, JET_BEYOND_Q);
    return TVI_OK;
}

/* Appends the entries of row k of G to `values` and to the lists of the constraints. Refuses a row without entries. */
static tvi_status append_row(constraint_recording *recording, int k)
{
    tvi_constraints *constraints = recording->constraints;
    const int n = recording->n, m = constraints->count;
    const size_t room = (size_t)constraints->entry_count + (size_t)n;
    int *column = realloc(constraints->column, room * sizeof *column);
    if (column) constraints->column = column;
    jet *values = realloc(recording->values, ((size_t)m + room) * sizeof *values);
    if (values) recording->values = values;
    if (!column || !values) return TVI_ENOMEM;
    const int first = constraints->entry_count;
    for (int i = 0; i < n; i++) {
        if (jet_is_zero(recording->gradient[i])) continue;
        values[m + constraints->entry_count] = recording->gradient[i];
        column[constraints->entry_count++] = i;
    }
    constraints->row_end[k] = constraints->entry_count;
    if (constraints->entry_count > first) return TVI_OK;
    const bool has_time = !jet_is_zero(recording->gradient[recording->input_count - 1]);
    return jet_refuse(TVI_EINVAL, has_time ? "phi[%d] is a function of t alone" : "phi[%d] is a number", k);
}

/* Records G_k d, phi_k' and the second derivatives along d. mu_G_d becomes the sum of mu_k G_k d. */
static tvi_status record_derivatives_of(constraint_recording *recording, int k, jet *mu_G_d)
{
    const tvi_constraints *constraints = recording->constraints;
    const int n = recording->n, m = constraints->count, inputs = recording->input_count, time = inputs - 1;
    jet_graph *graph = constraints->graph;
    jet *gradient = recording->gradient, *of_product = recording->gradient_of_product;
    if (!jet_record_gradient(graph, constraints->phi[k], inputs, gradient)) return TVI_ENOMEM;
    const tvi_status status = append_row(recording, k);
    if (status != TVI_OK) return status;
    const jet G_d = jet_dot(gradient, recording->d, n), phi_t = gradient[time];
    recording->rates[k] = jet_add(G_d, phi_t);
    *mu_G_d = jet_add(*mu_G_d, jet_mul(recording->mu[k], G_d));
    if (!jet_record_gradient(graph, G_d, inputs, of_product)) return TVI_ENOMEM;
    const jet along_d = jet_dot(of_product, recording->d, n), along_d_and_t = of_product[time];
    if (!jet_record_gradient(graph, phi_t, inputs, gradient)) return TVI_ENOMEM;
    recording->curvature[n + k] = jet_mul(0.5, along_d);
    recording->rates[m + k] = jet_add(along_d, jet_add(jet_mul(2, along_d_and_t), gradient[time]));
    return TVI_OK;
}

static tvi_status record_derivatives(constraint_recording *recording)
{
    tvi_constraints *constraints = recording->constraints;
    const int n = recording->n, m = constraints->count;
    jet mu_G_d = jet_const(0);
    tvi_status status = TVI_OK;
    jet_graph_begin_library_nodes(constraints->graph, "derivatives of phi");
    jet_graph_set_output_name(constraints->graph, "derivatives of phi");
    for (int k = 0; k < m && status == TVI_OK; k++) status = record_derivatives_of(recording, k, &mu_G_d);
    if (status != TVI_OK) return status;
    /* (G^T mu)_q d is the gradient of mu G d by q, as phi_qq is symmetric. */
    if (!jet_record_gradient(constraints->graph, mu_G_d, recording->input_count, recording->gradient))
        return TVI_ENOMEM;
    memcpy(recording->curvature, recording->gradient, (size_t)n * sizeof *recording->curvature);
    for (int k = 0; k < m; k++) recording->values[k] = constraints->phi[k];
    status = jet_graph_check_outputs(constraints->graph, m + constraints->entry_count, recording->values);
    if (status == TVI_OK) status = jet_graph_check_outputs(constraints->graph, n + m, recording->curvature);
    return status == TVI_OK ? jet_graph_check_outputs(constraints->graph, 2 * m, recording->rates) : status;
}

static tvi_status create_tapes(const constraint_recording *recording)
{
    tvi_constraints *constraints = recording->constraints;
    const int n = recording->n, m = constraints->count;
    jet_graph *graph = constraints->graph;
    jet_graph_end_recording(graph);
    constraints->values = jet_tape_create(graph, n, m + constraints->entry_count, recording->values, JET_TAPE_VALUES);
    constraints->curvature = jet_tape_create(graph, 2 * n + m, n + m, recording->curvature, JET_TAPE_VALUES);
    constraints->rates = jet_tape_create(graph, 2 * n, 2 * m, recording->rates, JET_TAPE_VALUES);
    return constraints->values && constraints->curvature && constraints->rates ? TVI_OK : TVI_ENOMEM;
}

/* Refuses phi with a parameter that has another value in the system. */
static tvi_status check_parameters(const jet_graph *graph, const tvi_system *system)
{
    const int count = tvi_system_parameters(system);
    double *value = malloc(((size_t)count + 1) * sizeof *value);
    if (!value) return TVI_ENOMEM;
    for (int i = 0; i < count; i++) value[i] = NAN;
    tvi_system_recorded_parameters(system, value);
    tvi_status status = TVI_OK;
    for (int i = 0; i < jet_graph_node_count(graph) && status == TVI_OK; i++) {
        const struct jet_node *node = jet_graph_node_at(graph, i);
        const int index = node->op == OP_PARAMETER ? node->parameter_index : count;
        if (index < count && !isnan(value[index]) && value[index] != node->number)
            status = jet_refuse(TVI_EINVAL, "phi is made of parameter %d = %g, which is %g in the system", index,
                                node->number, value[index]);
    }
    free(value);
    return status;
}

/* Records derivatives and creates the tapes of phi, if `status`, that of its recording, is TVI_OK. */
static tvi_status finish_recording(tvi_constraints **out, constraint_recording *recording, tvi_status status)
{
    if (status == TVI_OK) status = record_derivatives(recording);
    if (status == TVI_OK) status = create_tapes(recording);
    free(recording->q);
    free(recording->values);
    free(recording->curvature);
    free(recording->gradient);
    if (status == TVI_OK) *out = recording->constraints;
    else tvi_constraints_free(recording->constraints);
    return status;
}

static tvi_status record_constraints(tvi_constraints **out, const tvi_system *system, int m,
                                     tvi_constraint_fn *constraint, void *ctx)
{
    constraint_recording recording = {0};
    tvi_status status = begin_recording(&recording, system->n, m);
    if (status == TVI_OK) {
        tvi_constraints *constraints = recording.constraints;
        constraint(recording.q, recording.t, constraints->phi, ctx);
        status = jet_graph_check_outputs(constraints->graph, m, constraints->phi);
        if (status == TVI_OK) status = tvi_refuse_outputs_beyond_end("value", m, constraints->phi);
        if (status == TVI_OK) status = check_parameters(constraints->graph, system);
    }
    return finish_recording(out, &recording, status);
}

/* Records phi and its derivative along dq, of the system that is lifted. Its parameters move along those of the lift
 * that stand behind them. */
static tvi_status record_lifted_phi(constraint_recording *recording, const tvi_system *base)
{
    const tvi_constraints *of_base = base->constraints;
    const int n = base->n, m = of_base->count, inputs = jet_graph_input_count(of_base->graph),
              parameters = tvi_system_parameters(base);
    jet *phi = recording->constraints->phi;
    jet *input = calloc(2 * (size_t)inputs + (size_t)parameters, sizeof *input);
    if (!input) return TVI_ENOMEM;
    jet *direction = input + inputs, *parameter_direction = direction + inputs;
    for (int i = 0; i < n; i++) {
        input[i] = recording->q[i];
        direction[i] = recording->q[n + i];
    }
    input[inputs - 1] = recording->t;
    for (int i = 0; i < parameters; i++)
        parameter_direction[i] = jet_graph_record_parameter(recording->constraints->graph, parameters + i, 0);
    const bool recorded = jet_record_forward_derivatives(of_base->graph, recording->constraints->graph, input,
                                                         direction, parameter_direction, m, of_base->phi, phi, phi + m);
    free(input);
    return recorded ? jet_graph_check_outputs(recording->constraints->graph, 2 * m, phi) : TVI_ENOMEM;
}

tvi_status tvi_constraints_create_lift(tvi_constraints **out, const tvi_system *base, bool is_separable)
{
    constraint_recording recording = {0};
    tvi_status status = begin_recording(&recording, 2 * base->n, 2 * base->constraints->count);
    if (status == TVI_OK) status = record_lifted_phi(&recording, base);
    if (status == TVI_OK) recording.constraints->is_lift = true;
    if (status == TVI_OK) recording.constraints->has_separable_lift = is_separable;
    return finish_recording(out, &recording, status);
}

/* ---- Constrained systems ----------------------------------------------------------------------------------------- */

static tvi_status check_statement(const tvi_system *system, int m, tvi_constraint_fn *constraint)
{
    if (!system || !constraint) return jet_refuse(TVI_EINVAL, "%s is NULL", system ? "the function" : "system");
    if (system->stepped_system != system)
        return jet_refuse(TVI_EUNSUPPORTED, "the system is rescaled: constraints are for fixed steps in t");
    if (system->constraints)
        return jet_refuse(TVI_EUNSUPPORTED, "the system is constrained already: give all constraints in one");
    if (system->record.is_tangent) return jet_refuse(TVI_EUNSUPPORTED, "a tangent system is not constrained");
    if (m < 1) return jet_refuse(TVI_EINVAL, "m = %d: there is no constraint", m);
    if (m > system->n)
        return jet_refuse(TVI_EINVAL, "m = %d constraints are more than n = %d coordinates", m, system->n);
    if (m == system->n) return jet_refuse(TVI_EINVAL, "m = n = %d: so many constraints leave no motion", m);
    return TVI_OK;
}

tvi_status tvi_system_constrained(tvi_system **out, const tvi_system *system, int m, tvi_constraint_fn *constraint,
                                  void *ctx)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    tvi_status status = check_statement(system, m, constraint);
    if (status != TVI_OK) return status;
    tvi_constraints *constraints;
    status = record_constraints(&constraints, system, m, constraint, ctx);
    if (status != TVI_OK) return jet_explain_out_of_memory(status);
    status = tvi_system_copy(out, system);
    if (status != TVI_OK) {
        tvi_constraints_free(constraints);
        return status;
    }
    (*out)->constraints = constraints;
    /* Constraints tie components that do not act on each other. */
    tvi_subsystems *all[2] = {&(*out)->subsystems, &(*out)->tail.subsystems};
    for (int k = 0; k < 2; k++) all[k]->count = 1;
    (*out)->axes = 0; /* The field is not all of the forces on bodies (integrator/defect.c). */
    return TVI_OK;
}

int tvi_system_constraints(const tvi_system *system)
{
    return system && system->constraints ? system->constraints->count : 0;
}

/* ---- States ------------------------------------------------------------------------------------------------------ */

/* Checks the arguments of a function of a state, and creates the memory to compute with its constraints, which the
 * caller frees. `parameters` NULL stands for the values in the recording. output [2] are the pointers to which the
 * function writes: NULL is refused by its name. */
static tvi_status open_work(tvi_constraint_work *work, void **memory, const tvi_system *system,
                            const double parameters[], double t, const double q[], const double p[],
                            const void *const output[2], const char *const output_name[2])
{
    if (!system || !q || !p || !output[0] || !output[1])
        return tvi_refuse_first_null_pointer(5, (const void *const[]){system, q, p, output[0], output[1]},
                                             (const char *const[]){"system", "q", "p", output_name[0], output_name[1]});
    if (!system->constraints) return jet_refuse(TVI_EUNSUPPORTED, "the system has no constraints");
    if (!isfinite(t) || !tvi_all_finite(system->n, q) || !tvi_all_finite(system->n, p))
        return tvi_refuse_nonfinite_state(system->n, t, q, "p", p);
    tvi_arena arena = {0};
    *work = (tvi_constraint_work){0};
    tvi_constraint_allocate(work, &arena, system);
    *memory = tvi_arena_obtain_memory(&arena);
    if (!*memory) return jet_explain_out_of_memory(TVI_ENOMEM);
    tvi_constraint_allocate(work, &arena, system);
    tvi_system_prepare_blocks(system, arena.first_tape_block, parameters);
    return TVI_OK;
}

tvi_status tvi_project_with_parameters(const tvi_system *system, const double parameters[], double t, double q[],
                                       double p[])
{
    tvi_constraint_work work;
    void *memory;
    tvi_status status = open_work(&work, &memory, system, parameters, t, q, p, (const void *const[]){q, p},
                                  (const char *const[]){"q", "p"});
    if (status != TVI_OK) return status;
    status = tvi_constraint_project(&work, t, q, work.start.q_low, p, work.start.p_low, false);
    free(memory);
    return status;
}

tvi_status tvi_phi_with_parameters(const tvi_system *system, const double parameters[], double t, const double q[],
                                   const double p[], double value[], double rate[])
{
    tvi_constraint_work work;
    void *memory;
    tvi_status status = open_work(&work, &memory, system, parameters, t, q, p, (const void *const[]){value, rate},
                                  (const char *const[]){"value", "rate"});
    if (status != TVI_OK) return status;
    status = tvi_constraint_evaluate(&work, t, q, p, value, rate);
    free(memory);
    return status;
}

tvi_status tvi_multipliers_with_parameters(const tvi_system *system, const double parameters[], double t,
                                           const double q[], const double p[], double lambda[], double force[])
{
    tvi_constraint_work work;
    void *memory;
    tvi_status status = open_work(&work, &memory, system, parameters, t, q, p, (const void *const[]){lambda, lambda},
                                  (const char *const[]){"lambda", "lambda"});
    if (status != TVI_OK) return status;
    status = tvi_constraint_multipliers(&work, t, q, p, lambda);
    if (status == TVI_OK && force) tvi_constraint_force(&work, lambda, force);
    free(memory);
    return status;
}

tvi_status tvi_project(const tvi_system *system, double t, double q[], double p[])
{
    return tvi_project_with_parameters(system, NULL, t, q, p);
}

tvi_status tvi_constraint_values(const tvi_system *system, double t, const double q[], const double p[], double value[],
                                 double rate[])
{
    return tvi_phi_with_parameters(system, NULL, t, q, p, value, rate);
}

tvi_status tvi_multipliers(const tvi_system *system, double t, const double q[], const double p[], double lambda[],
                           double force[])
{
    return tvi_multipliers_with_parameters(system, NULL, t, q, p, lambda, force);
}
