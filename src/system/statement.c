/* statement.c - Creates systems: calls the user's function on jets, which record its operations, brings the recording
 * into a form of tvi_form, and creates the tapes for the steppers (statement.h). */
#include "system/statement.h"
#include "system/legendre.h"
#include "system/refuse.h"

#include <stdlib.h>

/* Returns the name of the user's function, for texts of refusals. */
static const char *user_function_name(const system_statement *statement)
{
    if (statement->force) return "force";
    if (statement->rates) return "time scale";
    return statement->potential ? "potential" : statement->lagrangian ? "Lagrangian" : "Hamiltonian";
}

/* Opens a recording with the inputs q, v or p, t, r, in this order. A force or a potential has neither v nor r. */
static tvi_status begin_recording(system_recording *recording, int n, const system_statement *statement)
{
    const bool general = statement->lagrangian || statement->hamiltonian || statement->hamiltonian_factors ||
                         statement->rates || statement->has_velocities ||
                         (statement->copied && jet_graph_input_count(statement->copied->record.graph) > n + 1);
    const size_t count = (size_t)n, padded_count = tvi_padded_vector_count(n);
    tvi_system *system = recording->system = calloc(1, sizeof *system);
    if (!system) return TVI_ENOMEM;
    system->n = n;
    system->has_masses = !general;
    system->stepped_system = system;
    system->mass = malloc(count * sizeof *system->mass);
    system->record.graph = jet_graph_create(general ? 3 * n + 1 : n + 1);
    recording->q = malloc((2 * padded_count + count) * sizeof *recording->q);
    recording->field = system->record.field = malloc((count + padded_count) * sizeof *recording->field);
    recording->r_dot_H_p_gradient = malloc(2 * count * sizeof *recording->r_dot_H_p_gradient);
    if (!system->mass || !system->record.graph || !recording->q || !recording->field || !recording->r_dot_H_p_gradient)
        return TVI_ENOMEM;
    jet_graph_set_output_name(system->record.graph, user_function_name(statement));
    recording->v = recording->q + padded_count;
    recording->r = recording->v + padded_count;
    tvi_set_poison_beyond_end(n, recording->q, JET_BEYOND_Q);
    tvi_set_poison_beyond_end(n, recording->v, statement->lagrangian ? JET_BEYOND_V : JET_BEYOND_P);
    for (size_t i = 0; i < padded_count; i++) recording->field[i] = jet_make_unset_poison();
    const int input_count = general ? 2 * n : n;
    recording->t = jet_graph_input(system->record.graph, input_count);
    for (int i = 0; i < n; i++) {
        recording->q[i] = jet_graph_input(system->record.graph, i);
        if (general) recording->v[i] = jet_graph_input(system->record.graph, n + i);
        if (general) recording->r[i] = jet_graph_input(system->record.graph, input_count + 1 + i);
        system->mass[i] = statement->mass ? statement->mass[i] : 1;
    }
    return TVI_OK;
}

/* ---- From each statement to a form ------------------------------------------------------------------------------- */

/* Records gradient [2n], the gradient of *x by q and v, or by q and p. */
static tvi_status record_full_gradient(const system_recording *recording, jet *x, jet gradient[])
{
    tvi_system *system = recording->system;
    tvi_status status = jet_graph_check_outputs(system->record.graph, 1, x);
    if (status != TVI_OK) return status;
    if (!jet_record_gradient(system->record.graph, *x, 2 * system->n, gradient)) return TVI_ENOMEM;
    for (int i = 0; i < 2 * system->n && status == TVI_OK; i++) {
        jet component = gradient[i]; /* A component that is a number stays a number, and needs no node of the graph. */
        status = jet_graph_check_outputs(system->record.graph, 1, &component);
    }
    return status;
}

/* Records the force F = -dV/dq; for a separable Hamiltonian, F = -dH/dq. */
static tvi_status record_force(system_recording *recording)
{
    tvi_system *system = recording->system;
    return jet_record_gradient(system->record.graph, jet_neg(recording->user_function), system->n, recording->field)
               ? TVI_OK
               : TVI_ENOMEM;
}

static tvi_status record_potential(system_recording *recording, const system_statement *statement)
{
    tvi_system *system = recording->system;
    recording->user_function = statement->potential(recording->q, recording->t, statement->ctx);
    const tvi_status status = jet_graph_check_outputs(system->record.graph, 1, &recording->user_function);
    return status == TVI_OK ? record_force(recording) : status;
}

/* Adds driving forces to dp/dt, which is `sign` times the first half of the field. */
static tvi_status add_driving_force(system_recording *recording, const system_statement *statement, const jet v[],
                                    double sign)
{
    tvi_system *system = recording->system;
    const int n = system->n;
    jet *padded_v = tvi_copy_with_poison_beyond_end(n, v, JET_BEYOND_V), *force = tvi_create_unset_outputs(n);
    tvi_status status = padded_v && force ? TVI_OK : TVI_ENOMEM;
    if (status == TVI_OK) {
        statement->drive(recording->q, padded_v, recording->t, force, statement->drive_ctx);
        jet_graph_set_output_name(system->record.graph, "driving force");
        status = jet_graph_check_outputs(system->record.graph, n, force);
        jet_graph_set_output_name(system->record.graph, user_function_name(statement));
    }
    if (status == TVI_OK) status = tvi_refuse_outputs_beyond_end("force", n, force);
    for (int i = 0; i < n && status == TVI_OK; i++)
        recording->field[i] = jet_add(recording->field[i], jet_mul(sign, force[i]));
    free(padded_v);
    free(force);
    system->is_driven = true;
    return status;
}

/* Finds masses in the second half of the field, and tells whether the system is separable. A driven system is not. */
static tvi_status find_masses(const system_recording *recording, const system_statement *statement, bool *is_separable)
{
    const jet *field = recording->field;
    const tvi_status status =
        tvi_system_find_masses(recording->system, field + recording->system->n, field, is_separable);
    *is_separable &= !statement->drive;
    return status;
}

/* Records the field (L_q, L_v). The system is separable if L_v = M v and L_q does not depend on v; then F = L_q and
 * V = -L(q, 0). */
static tvi_status record_lagrangian(system_recording *recording, const system_statement *statement)
{
    tvi_system *system = recording->system;
    recording->user_function = statement->lagrangian(recording->q, recording->v, recording->t, statement->ctx);
    tvi_status status = record_full_gradient(recording, &recording->user_function, recording->field);
    bool separable = false;
    if (status == TVI_OK) status = find_masses(recording, statement, &separable);
    if (status == TVI_OK && statement->drive) status = add_driving_force(recording, statement, recording->v, 1);
    system->energy.sign = -1;
    if (separable || status != TVI_OK) return status;
    system->form = TVI_LAGRANGIAN;
    return tvi_hessian_record(system, &recording->field_and_hessian);
}

tvi_status tvi_record_r_dot_H_p_gradient(system_recording *recording)
{
    tvi_system *system = recording->system;
    const int n = system->n;
    jet along = jet_dot(recording->r, recording->field + n, n);
    const tvi_status status = record_full_gradient(recording, &along, recording->r_dot_H_p_gradient);
    return status == TVI_OK ? jet_graph_check_outputs(system->record.graph, 2 * n, recording->r_dot_H_p_gradient)
                            : status;
}

static tvi_status record_factored_hamiltonian(system_recording *recording, const system_statement *statement)
{
    tvi_system *system = recording->system;
    jet factor[2];
    statement->hamiltonian_factors(recording->q, recording->v, recording->t, statement->ctx, factor);
    recording->user_function = jet_mul(factor[0], factor[1]);
    system->form = TVI_HAMILTONIAN;
    tvi_status status = record_full_gradient(recording, &recording->user_function, recording->field);
    if (status == TVI_OK) status = tvi_record_hessian_of_factored_H(system, factor, &recording->field_and_hessian);
    return status == TVI_OK ? tvi_record_r_dot_H_p_gradient(recording) : status;
}

/* Records the field (H_q, H_p). The system is separable if H_p = M^-1 p and H_q does not depend on p; then F = -H_q
 * and V = H(q, 0). */
static tvi_status record_hamiltonian(system_recording *recording, const system_statement *statement)
{
    tvi_system *system = recording->system;
    const int n = system->n;
    recording->user_function = statement->hamiltonian(recording->q, recording->v, recording->t, statement->ctx);
    tvi_status status = record_full_gradient(recording, &recording->user_function, recording->field);
    bool separable = false;
    if (status == TVI_OK) status = find_masses(recording, statement, &separable);
    if (status == TVI_OK && statement->drive)
        status = add_driving_force(recording, statement, recording->field + n, -1);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n && system->has_masses; i++) system->mass[i] = 1 / system->mass[i];
    if (separable) return record_force(recording);
    system->form = TVI_HAMILTONIAN;
    return tvi_record_r_dot_H_p_gradient(recording);
}

/* Records the rates (q', p') in the order of a Hamiltonian's field, (-p', q'). */
static tvi_status record_rates(system_recording *recording, const system_statement *statement)
{
    tvi_system *system = recording->system;
    const int n = system->n;
    jet *rate = malloc(2 * (size_t)n * sizeof *rate);
    if (!rate) return TVI_ENOMEM;
    statement->rates(recording->q, recording->v, recording->t, statement->ctx, rate);
    system->form = TVI_FIELD;
    for (int i = 0; i < n; i++) {
        recording->field[i] = jet_neg(rate[n + i]);
        recording->field[n + i] = rate[i];
    }
    free(rate);
    return TVI_OK;
}

bool tvi_system_record_again(const tvi_system *base, const jet q[], const jet velocities_or_momenta[], jet t, int count,
                             const jet output[], jet value[])
{
    const int n = base->n, inputs = jet_graph_input_count(base->record.graph), time_index = inputs > n + 1 ? 2 * n : n;
    jet_graph *graph;
    const jet refused = jet_find_common_graph_or_poison(1, q, &graph);
    for (int i = 0; i < count; i++) value[i] = refused;
    if (refused.node) return true;
    jet *input = malloc((size_t)inputs * sizeof *input);
    if (!input) return false;
    for (int i = 0; i < inputs; i++) input[i] = jet_const(0);
    for (int i = 0; i < n; i++) input[i] = q[i];
    for (int i = n; i < time_index && velocities_or_momenta; i++) input[i] = velocities_or_momenta[i - n];
    input[time_index] = t;
    const bool recorded = jet_record_again(base->record.graph, graph, input, count, output, value);
    free(input);
    return recorded;
}

/* Records the field and the user's function of another system once more, whose inputs are the same. */
static tvi_status record_copy(system_recording *recording, const system_statement *statement)
{
    const tvi_system *base = statement->copied;
    tvi_system *system = recording->system;
    if (!tvi_system_record_again(base, recording->q, recording->v, recording->t, tvi_system_output_count(base),
                                 base->record.field, recording->field) ||
        (base->energy.tape && !tvi_system_record_again(base, recording->q, recording->v, recording->t, 1,
                                                       &base->record.user_function, &recording->user_function)))
        return TVI_ENOMEM;
    system->form = base->form;
    system->is_driven = base->is_driven;
    system->has_masses = base->has_masses;
    system->energy.sign = base->energy.sign;
    for (int i = 0; i < system->n; i++) system->mass[i] = base->mass[i];
    if (base->energy.tape && jet_graph_check_outputs(system->record.graph, 1, &recording->user_function) != TVI_OK)
        return TVI_ENOMEM;
    return system->form == TVI_LAGRANGIAN    ? tvi_hessian_record(system, &recording->field_and_hessian)
           : system->form == TVI_HAMILTONIAN ? tvi_record_r_dot_H_p_gradient(recording)
                                             : TVI_OK;
}

static tvi_status record_statement(system_recording *recording, const system_statement *statement)
{
    recording->system->energy.sign = 1;
    if (statement->record) return statement->record(recording, statement);
    if (statement->lagrangian) return record_lagrangian(recording, statement);
    if (statement->hamiltonian_factors) return record_factored_hamiltonian(recording, statement);
    if (statement->hamiltonian) return record_hamiltonian(recording, statement);
    if (statement->rates) return record_rates(recording, statement);
    if (statement->copied) return record_copy(recording, statement);
    if (statement->potential) return record_potential(recording, statement);
    statement->force(recording->q, recording->t, recording->field, statement->ctx);
    return tvi_refuse_outputs_beyond_end("force", recording->system->n, recording->field);
}

static tvi_status create_tapes(system_recording *recording, const system_statement *statement)
{
    tvi_system *system = recording->system;
    const int n = system->n, outputs = system->form == TVI_SEPARABLE ? n : 2 * n;
    const tvi_status status = jet_graph_check_outputs(system->record.graph, outputs, recording->field);
    if (status != TVI_OK) return status;
    const int axes = statement->copied ? statement->copied->axes : jet_graph_axes(system->record.graph);
    if (axes != 0 && n % abs(axes) == 0) system->axes = axes;
    jet_graph_end_recording(system->record.graph);
    system->input_count = outputs;
    system->field_series = jet_tape_create(system->record.graph, outputs, outputs, recording->field, JET_TAPE_SERIES);
    system->field_values = jet_tape_create(system->record.graph, outputs, outputs, recording->field, JET_TAPE_VALUES);
    if (!system->field_series || !system->field_values) return TVI_ENOMEM;
    const bool has_time_coordinate = statement->hamiltonian_factors || statement->rates;
    if (tvi_system_find_subsystems(system, has_time_coordinate) != TVI_OK) return TVI_ENOMEM;
    system->tail.has_shares_without_momenta = system->has_masses;
    system->uses_time = system->field_series->input_count > outputs;
    if (system->form == TVI_HAMILTONIAN) {
        system->r_dot_Hp_values =
            jet_tape_create(system->record.graph, 3 * n + 1, 2 * n, recording->r_dot_H_p_gradient, JET_TAPE_VALUES);
        if (!system->r_dot_Hp_values) return TVI_ENOMEM;
    }
    if (tvi_hessian_create_tape(system, recording->field_and_hessian) != TVI_OK) return TVI_ENOMEM;
    if (!recording->user_function.node) return TVI_OK;
    system->energy.input_count = statement->potential ? n
                                 : statement->copied  ? statement->copied->energy.input_count
                                                      : 2 * n;
    system->record.user_function = recording->user_function;
    system->energy.tape = jet_tape_create(system->record.graph, system->energy.input_count, 1,
                                          &recording->user_function, JET_TAPE_VALUES);
    return system->energy.tape ? TVI_OK : TVI_ENOMEM;
}

tvi_status tvi_system_record(tvi_system **out, int n, const system_statement *statement)
{
    *out = NULL;
    system_recording recording = {0};
    tvi_status status = begin_recording(&recording, n, statement);
    if (status == TVI_OK) status = record_statement(&recording, statement);
    if (status == TVI_OK) status = create_tapes(&recording, statement);
    if (status == TVI_OK && !statement->record && !statement->rates)
        status = tvi_legendre_test_regularity(recording.system);
    free(recording.q);
    free(recording.r_dot_H_p_gradient);
    free(recording.field_and_hessian);
    if (status == TVI_OK) *out = recording.system;
    else tvi_system_free(recording.system);
    return jet_explain_out_of_memory(status);
}

/* Checks the user's statement, and creates the system. */
static tvi_status create_system_from_statement(tvi_system **out, int n, const system_statement *statement)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    if (n < 1 || n > TVI_MAX_DIMENSION) return jet_refuse(TVI_EINVAL, "n = %d is not 1 .. %d", n, TVI_MAX_DIMENSION);
    if (!statement->force && !statement->potential && !statement->lagrangian && !statement->hamiltonian &&
        !statement->hamiltonian_factors && !statement->rates)
        return jet_refuse(TVI_EINVAL, "the function is NULL");
    const tvi_status status = tvi_refuse_masses(n, statement->mass);
    return status == TVI_OK ? tvi_system_record(out, n, statement) : status;
}

tvi_status tvi_system_create_from_rates(tvi_system **out, int n, tvi_rates_fn *rates, void *ctx)
{
    return create_system_from_statement(out, n, &(system_statement){.rates = rates, .ctx = ctx});
}

tvi_status tvi_system_copy(tvi_system **out, const tvi_system *system)
{
    return tvi_system_record(out, system->n, &(system_statement){.copied = system});
}

tvi_status tvi_system_force(tvi_system **out, int n, const double mass[], tvi_force_fn *force, void *ctx)
{
    return create_system_from_statement(out, n, &(system_statement){.force = force, .mass = mass, .ctx = ctx});
}

tvi_status tvi_system_potential(tvi_system **out, int n, const double mass[], tvi_potential_fn *potential, void *ctx)
{
    return create_system_from_statement(out, n, &(system_statement){.potential = potential, .mass = mass, .ctx = ctx});
}

tvi_status tvi_system_lagrangian(tvi_system **out, int n, tvi_lagrangian_fn *lagrangian, void *ctx)
{
    return create_system_from_statement(out, n, &(system_statement){.lagrangian = lagrangian, .ctx = ctx});
}

tvi_status tvi_system_create_from_factors(tvi_system **out, int n, tvi_factors_fn *factors, void *ctx)
{
    return create_system_from_statement(out, n, &(system_statement){.hamiltonian_factors = factors, .ctx = ctx});
}

tvi_status tvi_system_hamiltonian(tvi_system **out, int n, tvi_hamiltonian_fn *hamiltonian, void *ctx)
{
    return create_system_from_statement(out, n, &(system_statement){.hamiltonian = hamiltonian, .ctx = ctx});
}

tvi_status tvi_system_driven(tvi_system **out, const tvi_system *system, tvi_drive_fn *drive, void *ctx)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    if (!system || !drive) return jet_refuse(TVI_EINVAL, "%s is NULL", system ? "drive" : "system");
    const char *const unsupported =
        system->record.is_tangent          ? "a tangent system is not driven: drive the system it is of"
        : !system->energy.tape             ? "a force has no energy: state the potential"
        : system->stepped_system != system ? "the system is rescaled"
        : system->constraints              ? "the system is constrained: drive it first, and then constrain it"
        : system->is_driven                ? "the system is driven already: add the forces in one"
                                           : NULL;
    if (unsupported) return jet_refuse(TVI_EUNSUPPORTED, "%s", unsupported);
    system_statement statement = {.ctx = (void *)system, .drive = drive, .drive_ctx = ctx};
    if (system->form == TVI_LAGRANGIAN) statement.lagrangian = tvi_record_user_lagrangian;
    else statement.hamiltonian = tvi_record_user_hamiltonian;
    const tvi_status status = create_system_from_statement(out, system->n, &statement);
    if (status == TVI_OK) (*out)->axes = system->axes;
    return status;
}
