/* adjoint.c - Records the adjoint of a system (adjoint.h). With its multipliers the function S is, in each form,
 *     separable     S = w.F                         the forces (F, S_q), for q and w
 *     Lagrangian    S = w.L_q + w'.L_v              the Lagrangian S of (q, w)
 *     all others    S = a.f, f = (q', p')           x' = f, a' = -S_x
 * S is recorded once, and its gradient by reverse accumulation gives the equations of the multipliers, and S_c and S_t.
 */
#include "system/adjoint.h"
#include "system/refuse.h"
#include "system/statement.h"

#include <stdlib.h>

/* What is recorded beside the lift: jets of its graph. */
typedef struct {
    jet *integrand; /* [parameters + 1] S_c and S_t */
    jet *H_c;       /* [parameters] */
} adjoint_jets;

/* Records the base once more, whose inputs are now those of the lift: field [outputs], and its Hamiltonian *H. */
static bool record_base(const system_recording *recording, const tvi_system *base, jet field[], jet *H)
{
    const int n = base->n, inputs = jet_graph_input_count(base->record.graph), time = inputs == n + 1 ? n : 2 * n;
    jet *input = malloc((2 * (size_t)inputs + (size_t)base->input_count) * sizeof *input), rate;
    if (!input) return false;
    jet *no_direction = input + inputs, *no_rate = no_direction + inputs;
    for (int i = 0; i < inputs; i++) input[i] = jet_make_unset_poison(), no_direction[i] = jet_const(0);
    for (int i = 0; i < n; i++) {
        input[i] = recording->q[i];
        if (base->form != TVI_SEPARABLE)
            input[n + i] = base->form == TVI_LAGRANGIAN ? recording->v[i] : recording->q[n + i];
    }
    input[time] = recording->t;
    jet_graph *graph = recording->system->record.graph;
    bool recorded = jet_record_forward_derivatives(base->record.graph, graph, input, no_direction, NULL,
                                                   base->input_count, base->record.field, field, no_rate);
    *H = jet_const(0);
    if (recorded && base->form == TVI_HAMILTONIAN)
        recorded = jet_record_forward_derivatives(base->record.graph, graph, input, no_direction, NULL, 1,
                                                  &base->record.user_function, H, &rate);
    free(input);
    return recorded;
}

/* Records S from the base's field. */
static jet record_S(const system_recording *recording, const tvi_system *base, const jet field[], jet terms[])
{
    const int n = base->n;
    const jet *w = recording->q + n, *w_rate = recording->v + n, *a_q = recording->v, *a_p = recording->v + n;
    for (int i = 0; i < n; i++) {
        switch (base->form) {
        case TVI_SEPARABLE: terms[i] = jet_mul(w[i], field[i]); break;
        case TVI_LAGRANGIAN:
            terms[i] = jet_mul(w[i], field[i]);
            terms[n + i] = jet_mul(w_rate[i], field[n + i]);
            break;
        default: terms[i] = jet_mul(a_q[i], field[n + i]); terms[n + i] = jet_neg(jet_mul(a_p[i], field[i]));
        }
    }
    return jet_sum(terms, base->input_count);
}

/* Sets the field of the lift from that of the base and the gradient of S by the inputs of the lift. */
static void set_field(const system_recording *recording, const tvi_system *base, const jet field[],
                      const jet gradient[])
{
    const int n = base->n, N = 2 * n;
    for (int i = 0; i < n; i++) {
        jet *out = recording->field + i;
        switch (base->form) {
        case TVI_SEPARABLE:
            out[0] = field[i];
            out[n] = gradient[i];
            break;
        case TVI_LAGRANGIAN:
            for (int k = 0; k < 4; k++) out[k * n] = gradient[k * n + i];
            break;
        default: /* rates in the order (-a', x') */
            out[0] = gradient[i];
            out[n] = gradient[n + i];
            out[N] = field[n + i];
            out[N + n] = jet_neg(field[i]);
        }
    }
}

/* Records the field of the lift, and statement->ctx, the jets beside it. */
static tvi_status record_adjoint(system_recording *recording, const system_statement *statement)
{
    const tvi_system *base = statement->base;
    const adjoint_jets *beside = statement->ctx;
    tvi_system *system = recording->system;
    jet_graph *graph = system->record.graph;
    const int parameters = tvi_system_parameters(base), outputs = base->input_count;
    const int inputs = (base->form == TVI_SEPARABLE ? 1 : 2) * system->n, energy_inputs = 2 * base->n;
    system->form = base->form == TVI_HAMILTONIAN ? TVI_FIELD : base->form;
    system->is_regular = base->is_regular;
    system->has_masses = base->form == TVI_SEPARABLE;
    for (int i = 0; i < system->n; i++) system->mass[i] = base->mass[i % base->n];
    jet *field = malloc((2 * (size_t)outputs + (size_t)inputs + 1 + (size_t)energy_inputs) * sizeof *field), H;
    if (!field) return TVI_ENOMEM;
    jet *terms = field + outputs, *gradient = terms + outputs, *energy_gradient = gradient + inputs + 1;
    bool recorded = record_base(recording, base, field, &H);
    if (recorded)
        recorded = jet_record_gradient_by(graph, record_S(recording, base, field, terms), inputs + 1, gradient,
                                          parameters, beside->integrand);
    if (recorded) recorded = jet_record_gradient_by(graph, H, energy_inputs, energy_gradient, parameters, beside->H_c);
    if (recorded) set_field(recording, base, field, gradient);
    if (recorded) beside->integrand[parameters] = gradient[inputs];
    free(field);
    if (!recorded || jet_graph_check_outputs(graph, parameters + 1, beside->integrand) != TVI_OK ||
        jet_graph_check_outputs(graph, parameters, beside->H_c) != TVI_OK)
        return TVI_ENOMEM;
    return system->form == TVI_LAGRANGIAN ? tvi_hessian_record(system, &recording->field_and_hessian) : TVI_OK;
}

static tvi_status create_adjoint(tvi_adjoint *adjoint, const tvi_system *system)
{
    const int parameters = tvi_system_parameters(system), inputs = (system->form == TVI_SEPARABLE ? 2 : 4) * system->n;
    jet *jets = malloc((2 * (size_t)parameters + 1) * sizeof *jets);
    if (!jets) return TVI_ENOMEM;
    adjoint_jets beside = {jets, jets + parameters + 1};
    const system_statement statement = {
        .record = record_adjoint, .base = system, .has_velocities = system->form != TVI_SEPARABLE, .ctx = &beside};
    tvi_status status = tvi_system_record(&adjoint->lift, 2 * system->n, &statement);
    const jet_graph *graph = status == TVI_OK ? adjoint->lift->record.graph : NULL;
    if (graph) {
        adjoint->integrands = jet_tape_create(graph, inputs, parameters + 1, beside.integrand, JET_TAPE_VALUES);
        const bool has_H = system->form == TVI_HAMILTONIAN && parameters > 0;
        if (has_H)
            adjoint->energy_by_parameters =
                jet_tape_create(graph, 2 * system->n, parameters, beside.H_c, JET_TAPE_VALUES);
        if (!adjoint->integrands || (has_H && !adjoint->energy_by_parameters)) status = TVI_ENOMEM;
    }
    free(jets);
    return status;
}

void tvi_adjoint_free(tvi_adjoint *adjoint)
{
    if (!adjoint) return;
    tvi_system_free(adjoint->lift);
    jet_tape_free(adjoint->integrands);
    jet_tape_free(adjoint->energy_by_parameters);
    free(adjoint);
}

/* Of several threads that record it at once, the first one keeps it. */
tvi_status tvi_adjoint_of(const tvi_system *system, const tvi_adjoint **out)
{
    tvi_adjoint **kept = &((tvi_system *)system)->record.adjoint;
    *out = __atomic_load_n(kept, __ATOMIC_ACQUIRE);
    if (*out) return TVI_OK;
    tvi_adjoint *adjoint = calloc(1, sizeof *adjoint), *before = NULL;
    const tvi_status status = adjoint ? create_adjoint(adjoint, system) : TVI_ENOMEM;
    if (status == TVI_OK &&
        __atomic_compare_exchange_n(kept, &before, adjoint, false, __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE)) {
        *out = adjoint;
        return TVI_OK;
    }
    tvi_adjoint_free(adjoint);
    *out = before;
    return jet_explain_out_of_memory(status);
}

tvi_adjoint_layout tvi_adjoint_layout_of(const tvi_adjoint *adjoint)
{
    const int n = adjoint->lift->n / 2, momenta = 2 * n;
    switch (adjoint->lift->form) {
    case TVI_SEPARABLE: return (tvi_adjoint_layout){.p = momenta, .a_q = momenta + n, .a_p = n, .sign_of_a_q = -1};
    case TVI_LAGRANGIAN: return (tvi_adjoint_layout){.p = momenta + n, .a_q = momenta, .a_p = n, .sign_of_a_q = -1};
    default: return (tvi_adjoint_layout){.p = n, .a_q = momenta, .a_p = momenta + n, .sign_of_a_q = 1};
    }
}
