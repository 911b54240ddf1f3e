/* lift.c - Records the lifts of a system, whose tangents move with the motion (docs/method.md section 10): its field,
 * and the derivatives of the field along one tangent vector or several, by forward accumulation (ad/lift.c). */
#include "system/statement.h"
#include "system/constraint.h"
#include "system/refuse.h"
#include "tvi_gradient.h"

#include <math.h>
#include <stdlib.h>

/* For each input i of the base (the system that is lifted), sets the jet of the lift's graph that stands for the input,
 * input[i], and the jet for the input's component of the tangent vector, direction[i]. */
static void set_lift_inputs(const system_recording *recording, const tvi_system *base, jet input[], jet direction[])
{
    const int n = base->n, inputs = jet_graph_input_count(base->record.graph), time = inputs == n + 1 ? n : 2 * n;
    const bool momenta = recording->system->form != TVI_SEPARABLE && recording->system->form != TVI_LAGRANGIAN;
    for (int i = 0; i < inputs; i++) input[i] = direction[i] = jet_make_unset_poison();
    for (int i = 0; i < n; i++) {
        input[i] = recording->q[i];
        direction[i] = recording->q[n + i];
        if (base->form == TVI_SEPARABLE) continue;
        input[n + i] = recording->v[momenta ? n + i : i];
        direction[n + i] = recording->v[momenta ? i : n + i];
    }
    input[time] = recording->t;
    direction[time] = jet_const(0);
}

/* Sets the field of the lift from the field of the base (`value`) and its derivative along the tangent vector (`rate`),
 * here written '. The field of the lift is ((H_q)', H_q) and (H_p, (H_p)') for a Hamiltonian, and ((L_q)', L_q) and
 * ((L_v)', L_v) for a Lagrangian. A separable base has H_q = -F and H_p = M^-1 p. A separable lift has F and F'. */
static void set_lift_field(system_recording *recording, const tvi_system *base, const jet value[], const jet rate[])
{
    const int n = base->n;
    const bool separable = base->form == TVI_SEPARABLE, swaps = base->form == TVI_LAGRANGIAN;
    jet *field = recording->field;
    for (int i = 0; i < n; i++) {
        const bool paired = recording->system->form != TVI_SEPARABLE;
        field[i] = !paired ? value[i] : separable ? jet_neg(rate[i]) : rate[i];
        field[n + i] = !paired ? rate[i] : separable ? jet_neg(value[i]) : value[i];
        if (!paired) continue;
        const jet first = separable ? jet_div(recording->v[n + i], base->mass[i]) : value[n + i];
        const jet second = separable ? jet_div(recording->v[i], base->mass[i]) : rate[n + i];
        field[2 * n + i] = swaps ? second : first;
        field[3 * n + i] = swaps ? first : second;
    }
}

/* Records the lift's own parameters, the components of the tangent vector that belong to the base's parameters. */
static void record_lift_parameter_directions(const system_recording *recording, const double rates[],
                                             int parameter_count, jet direction[])
{
    for (int i = 0; i < parameter_count; i++)
        direction[i] =
            jet_graph_record_parameter(recording->system->record.graph, parameter_count + i, rates ? rates[i] : 0);
}

static tvi_status record_lift(system_recording *recording, const system_statement *statement)
{
    const tvi_system *base = statement->base;
    tvi_system *system = recording->system;
    jet_graph *graph = system->record.graph;
    const int parameters = tvi_system_parameters(base);
    system->is_regular = base->is_regular;
    system->has_masses = !statement->has_velocities;
    if (!system->has_masses) system->form = base->form == TVI_SEPARABLE ? TVI_HAMILTONIAN : base->form;
    for (int i = 0; i < system->n; i++) system->mass[i] = base->mass[i % base->n];
    const size_t inputs = (size_t)jet_graph_input_count(base->record.graph), outputs = (size_t)base->input_count;
    jet *jets = malloc((2 * (inputs + outputs) + (size_t)parameters) * sizeof *jets);
    if (!jets) return TVI_ENOMEM;
    jet *input = jets, *direction = input + inputs, *value = direction + inputs, *rate = value + outputs;
    jet *parameter_direction = rate + outputs;
    set_lift_inputs(recording, base, input, direction);
    record_lift_parameter_directions(recording, statement->parameter_rates, parameters, parameter_direction);
    bool lifted = jet_record_forward_derivatives(base->record.graph, graph, input, direction, parameter_direction,
                                                 base->input_count, base->record.field, value, rate);
    if (lifted) set_lift_field(recording, base, value, rate);
    /* The Hamiltonian of the lift is the derivative of the base's H along the tangent vector. */
    if (lifted && base->form == TVI_HAMILTONIAN)
        lifted = jet_record_forward_derivatives(base->record.graph, graph, input, direction, parameter_direction, 1,
                                                &base->record.user_function, value, &recording->user_function);
    free(jets);
    if (!lifted) return TVI_ENOMEM;
    if (base->form == TVI_HAMILTONIAN && jet_graph_check_outputs(graph, 1, &recording->user_function) != TVI_OK)
        return TVI_ENOMEM;
    return system->form == TVI_HAMILTONIAN  ? tvi_record_r_dot_H_p_gradient(recording)
           : system->form == TVI_LAGRANGIAN ? tvi_hessian_record(system, &recording->field_and_hessian)
                                            : TVI_OK;
}

static tvi_status create_lift(tvi_system **out, const tvi_system *system, tvi_lift lift, const double rates[])
{
    const bool is_paired = system->form != TVI_SEPARABLE || lift == TVI_LIFT_PAIRED;
    tvi_status status = tvi_system_record(
        out, 2 * system->n,
        &(system_statement){
            .record = record_lift, .base = system, .has_velocities = is_paired, .parameter_rates = rates});
    if (status != TVI_OK || !system->constraints) return status;
    status = tvi_constraints_create_lift(&(*out)->constraints, system, !is_paired);
    (*out)->subsystems.count = (*out)->tail.subsystems.count = 1;
    if (status == TVI_OK) return TVI_OK;
    tvi_system_free(*out);
    *out = NULL;
    return jet_explain_out_of_memory(status);
}

tvi_status tvi_system_create_lift(tvi_system **out, const tvi_system *system, tvi_lift lift)
{
    return create_lift(out, system, lift, NULL);
}

/* ---- Several tangent vectors ------------------------------------------------------------------------------------- */

/* Records the derivative of the base's field along column c, whose components are those of coordinate (1 + c) n on and
 * whose parameters are those from (1 + c) P on; for the first column also the field itself. The column moves the
 * parameters i with moves[i] alone. The jets are scratch. */
static bool record_column(system_recording *recording, const system_statement *statement, int c, const bool moves[],
                          jet jets[])
{
    const tvi_system *base = statement->base;
    const double *rates = c == 0 ? statement->parameter_rates : NULL;
    const int n = base->n, N = recording->system->n, P = tvi_system_parameters(base);
    const int inputs = jet_graph_input_count(base->record.graph), outputs = base->input_count;
    const int time = inputs == n + 1 ? n : 2 * n, first = (1 + c) * n;
    jet *input = jets, *direction = input + inputs, *value = direction + inputs, *rate = value + outputs;
    jet *parameter_direction = rate + outputs;
    for (int i = 0; i < inputs; i++) input[i] = direction[i] = jet_make_unset_poison();
    for (int i = 0; i < time; i++) {
        const jet *from = i < n ? recording->q : recording->v;
        input[i] = from[i % n];
        direction[i] = from[first + i % n];
    }
    input[time] = recording->t;
    direction[time] = jet_const(0);
    for (int i = 0; i < P; i++)
        parameter_direction[i] = moves[i] ? jet_graph_record_parameter(recording->system->record.graph, (1 + c) * P + i,
                                                                       rates ? rates[i] : 0)
                                          : jet_const(0);
    if (!jet_record_forward_derivatives(base->record.graph, recording->system->record.graph, input, direction,
                                        parameter_direction, outputs, base->record.field, value, rate))
        return false;
    for (int i = 0; i < outputs; i++) {
        const int half = i < n ? 0 : N;
        if (c == 0) recording->field[half + i % n] = value[i];
        recording->field[half + first + i % n] = rate[i];
    }
    return true;
}

static tvi_status record_columns(system_recording *recording, const system_statement *statement)
{
    const tvi_system *base = statement->base;
    tvi_system *system = recording->system;
    const bool *moves = statement->ctx;
    const int parameters = tvi_system_parameters(base);
    const size_t inputs = (size_t)jet_graph_input_count(base->record.graph), outputs = (size_t)base->input_count;
    if (base->form != TVI_SEPARABLE) system->form = TVI_FIELD;
    system->has_masses = base->has_masses;
    for (int i = 0; i < system->n; i++) system->mass[i] = base->mass[i % base->n];
    jet *jets = malloc((2 * (inputs + outputs) + (size_t)parameters) * sizeof *jets);
    bool recorded = jets != NULL;
    for (int c = 0; c < system->n / base->n - 1 && recorded; c++)
        recorded = record_column(recording, statement, c, moves + c * parameters, jets);
    free(jets);
    return recorded ? TVI_OK : TVI_ENOMEM;
}

/* Makes the subsystems of the state and of each column parts of their own, `copies` in all: linear equations have no
 * size, and that of one column says nothing of another. So each column converges by itself, whatever its scale. */
static void set_subsystems_of_copies(tvi_subsystems *subsystems, const tvi_subsystems *of_base, int n, int copies)
{
    subsystems->count = copies * of_base->count;
    for (int c = 0; c < copies; c++) {
        for (int k = 0; k < of_base->count; k++)
            subsystems->end_in_component_list[c * of_base->count + k] = c * n + tvi_subsystems_end(of_base, k, n);
        for (int i = 0; i < n; i++)
            subsystems->component_list[c * n + i] = c * n + tvi_subsystems_component_at(of_base, i);
    }
}

static tvi_status create_columns_lift(tvi_system **out, const tvi_system *system, int columns, const bool moves[],
                                      const double rates[])
{
    const system_statement statement = {.record = record_columns,
                                        .base = system,
                                        .ctx = (void *)moves,
                                        .has_velocities = system->form != TVI_SEPARABLE,
                                        .parameter_rates = rates};
    const tvi_status status = tvi_system_record(out, (1 + columns) * system->n, &statement);
    if (status != TVI_OK) return status;
    set_subsystems_of_copies(&(*out)->subsystems, &system->subsystems, system->n, 1 + columns);
    set_subsystems_of_copies(&(*out)->tail.subsystems, &system->tail.subsystems, system->n, 1 + columns);
    return TVI_OK;
}

tvi_status tvi_system_create_columns_lift(tvi_system **out, const tvi_system *system, int columns, const bool moves[])
{
    return create_columns_lift(out, system, columns, moves, NULL);
}

/* ---- A tangent vector as part of a system ------------------------------------------------------------------------ */

static tvi_status check_tangent(const tvi_system *system, const double rates[])
{
    const char *const unsupported = system->stepped_system != system
                                        ? "a rescaled system has no tangent system: make that of the system in t"
                                    : system->constraints ? "a constrained system has no tangent system"
                                                          : NULL;
    if (unsupported) return jet_refuse(TVI_EUNSUPPORTED, "%s", unsupported);
    if (2 * system->n > TVI_MAX_DIMENSION)
        return jet_refuse(TVI_EINVAL, "the tangent system has n = %d, above %d", 2 * system->n, TVI_MAX_DIMENSION);
    for (int i = 0; i < (rates ? tvi_system_parameters(system) : 0); i++)
        if (!isfinite(rates[i])) return jet_refuse(TVI_EINVAL, "rates[%d] = %g", i, rates[i]);
    return TVI_OK;
}

tvi_status tvi_system_tangent(tvi_system **out, const tvi_system *system, const double rates[])
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    if (!system) return jet_refuse(TVI_EINVAL, "system is NULL");
    tvi_status status = check_tangent(system, rates);
    if (status != TVI_OK) return status;
    const size_t parameters = (size_t)tvi_system_parameters(system);
    bool *moves = malloc((parameters + 1) * sizeof *moves);
    if (!moves) return jet_explain_out_of_memory(TVI_ENOMEM);
    for (size_t i = 0; i < parameters; i++) moves[i] = true;
    if (system->form == TVI_LAGRANGIAN) {
        status = create_lift(out, system, TVI_LIFT_PAIRED, rates);
        if (status == TVI_OK) (*out)->is_driven = system->is_driven;
    } else status = create_columns_lift(out, system, 1, moves, rates);
    free(moves);
    if (status == TVI_OK) (*out)->record.is_tangent = true;
    return jet_explain_out_of_memory(status);
}
