/* adjoint.c - Records the adjoint of a system (adjoint.h). With its multipliers the function S is, in each form,
 *     separable     S = w.F                                     the forces (F, S_q), for q and w
 *     Lagrangian    S = w.L_q + w'.L_v + sum_k lambda_k l_k     the Lagrangian S of (q, w)
 *     rates         S = a.f + sum_k lambda_k l_k                x' = f, a' = -S_x, where f = (q', p')
 * with the integrands l_k of running integrals, by which the loss has the derivatives lambda_k. S is recorded once, and
 * its gradient by reverse accumulation gives the equations of the multipliers, and S_c and S_t. */
#include "system/adjoint.h"
#include "system/refuse.h"
#include "system/statement.h"

#include <stdlib.h>

/* What is recorded. */
typedef struct {
    const tvi_system *base;
    int parameters; /* those of the user's system */
    tvi_form form;  /* of the lift */
    int integral_count;
    const tvi_integrand *integrands;
    /* What is recorded beside the lift, jets of its graph: S_c and S_t [parameters + 1], H_c [parameters]. */
    jet *S_c_and_S_t, *H_c;
} adjoint_statement;

/* Records the base once more, whose inputs are now those of the lift: field [2n], in the order of the form of the lift,
 * and its Hamiltonian *H. */
static bool record_base(const system_recording *recording, const adjoint_statement *of, jet field[], jet *H)
{
    const tvi_system *base = of->base;
    const int n = base->n;
    const jet *second = base->form == TVI_LAGRANGIAN ? recording->v : recording->q + n;
    bool recorded =
        tvi_system_record_again(base, recording->q, second, recording->t, base->input_count, base->record.field, field);
    *H = jet_const(0);
    if (recorded && base->form == TVI_HAMILTONIAN)
        recorded = tvi_system_record_again(base, recording->q, second, recording->t, 1, &base->record.user_function, H);
    for (int i = 0; i < n && recorded && base->form == TVI_SEPARABLE && of->form != TVI_SEPARABLE; i++) {
        field[i] = jet_neg(field[i]);
        field[n + i] = jet_div(recording->q[n + i], base->mass[i]);
    }
    return recorded;
}

/* Records lambda_k l_k, where lambda_k is a parameter of the lift, behind those of the base. */
static bool record_integrand(const system_recording *recording, const adjoint_statement *of, int k, const jet field[],
                             jet *term)
{
    const int n = of->base->n;
    jet_graph *graph = recording->system->record.graph;
    jet *input = malloc((2 * (size_t)n + 1) * sizeof *input), value;
    if (!input) return false;
    for (int i = 0; i < n; i++) {
        input[i] = recording->q[i];
        input[n + i] = of->form == TVI_LAGRANGIAN ? field[n + i] : recording->q[n + i];
    }
    input[2 * n] = recording->t;
    const bool recorded = jet_record_again(of->integrands[k].graph, graph, input, 1, &of->integrands[k].output, &value);
    free(input);
    *term = recorded ? jet_mul(jet_graph_record_parameter(graph, of->parameters + k, 0), value) : jet_const(0);
    return recorded;
}

/* Records S from the base's field. `terms` has room for 2n + integral_count jets. */
static bool record_S(const system_recording *recording, const adjoint_statement *of, const jet field[], jet terms[],
                     jet *S)
{
    const int n = of->base->n, count = of->form == TVI_SEPARABLE ? n : 2 * n;
    const jet *w = recording->q + n, *w_rate = recording->v + n, *a_q = recording->v, *a_p = recording->v + n;
    bool recorded = true;
    for (int i = 0; i < n; i++) {
        if (of->form == TVI_FIELD) {
            terms[i] = jet_mul(a_q[i], field[n + i]);
            terms[n + i] = jet_neg(jet_mul(a_p[i], field[i]));
        } else {
            terms[i] = jet_mul(w[i], field[i]);
            if (of->form == TVI_LAGRANGIAN) terms[n + i] = jet_mul(w_rate[i], field[n + i]);
        }
    }
    for (int k = 0; k < of->integral_count && recorded; k++)
        recorded = record_integrand(recording, of, k, field, &terms[count + k]);
    *S = jet_sum(terms, count + of->integral_count);
    return recorded;
}

/* Sets the field of the lift from that of the base and the gradient of S by the inputs of the lift. */
static void set_field(const system_recording *recording, const adjoint_statement *of, const jet field[],
                      const jet gradient[])
{
    const int n = of->base->n, N = 2 * n;
    for (int i = 0; i < n; i++) {
        jet *out = recording->field + i;
        switch (of->form) {
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

/* Records the field of the lift. statement->ctx is the adjoint_statement. */
static tvi_status record_adjoint(system_recording *recording, const system_statement *statement)
{
    const adjoint_statement *of = statement->ctx;
    const tvi_system *base = of->base;
    tvi_system *system = recording->system;
    jet_graph *graph = system->record.graph;
    const int parameters = of->parameters, N = system->n;
    const int inputs = of->form == TVI_SEPARABLE ? N : 2 * N;
    system->form = of->form;
    system->is_regular = base->is_regular;
    system->has_masses = of->form == TVI_SEPARABLE;
    for (int i = 0; i < N; i++) system->mass[i] = base->mass[i % base->n];
    jet *field = malloc((3 * (size_t)N + (size_t)of->integral_count + (size_t)inputs + 1) * sizeof *field), H, S;
    if (!field) return TVI_ENOMEM;
    jet *terms = field + N, *gradient = terms + N + of->integral_count, *energy_gradient = gradient + inputs + 1;
    const bool recorded = record_base(recording, of, field, &H) && record_S(recording, of, field, terms, &S) &&
                          jet_record_gradient_by(graph, S, inputs + 1, gradient, parameters, of->S_c_and_S_t) &&
                          jet_record_gradient_by(graph, H, N, energy_gradient, parameters, of->H_c);
    if (recorded) set_field(recording, of, field, gradient);
    if (recorded) of->S_c_and_S_t[parameters] = gradient[inputs];
    free(field);
    if (!recorded || jet_graph_check_outputs(graph, parameters + 1, of->S_c_and_S_t) != TVI_OK ||
        jet_graph_check_outputs(graph, parameters, of->H_c) != TVI_OK)
        return TVI_ENOMEM;
    return system->form == TVI_LAGRANGIAN ? tvi_hessian_record(system, &recording->field_and_hessian) : TVI_OK;
}

static tvi_status record_with_tapes(tvi_adjoint *adjoint, adjoint_statement *of)
{
    const int N = 2 * of->base->n, parameters = of->parameters;
    const system_statement statement = {
        .record = record_adjoint, .base = of->base, .has_velocities = of->form != TVI_SEPARABLE, .ctx = of};
    const tvi_status status = tvi_system_record(&adjoint->lift, N, &statement);
    if (status != TVI_OK) return status;
    const jet_graph *graph = adjoint->lift->record.graph;
    adjoint->integrands =
        jet_tape_create(graph, of->form == TVI_SEPARABLE ? N : 2 * N, parameters + 1, of->S_c_and_S_t, JET_TAPE_VALUES);
    const bool has_H_c = of->base->form == TVI_HAMILTONIAN && parameters > 0;
    if (has_H_c) adjoint->energy_by_parameters = jet_tape_create(graph, N, parameters, of->H_c, JET_TAPE_VALUES);
    return adjoint->integrands && (!has_H_c || adjoint->energy_by_parameters) ? TVI_OK : TVI_ENOMEM;
}

tvi_status tvi_adjoint_create(tvi_adjoint **out, const tvi_system *system, int integral_count,
                              const tvi_integrand integrands[])
{
    const tvi_system *base = system->stepped_system;
    const size_t parameters = (size_t)tvi_system_parameters(system);
    const bool is_field = base->form == TVI_HAMILTONIAN || (base->form == TVI_SEPARABLE && integral_count > 0);
    adjoint_statement of = {.base = base,
                            .parameters = (int)parameters,
                            .form = is_field ? TVI_FIELD : base->form,
                            .integral_count = integral_count,
                            .integrands = integrands};
    tvi_adjoint *adjoint = calloc(1, sizeof *adjoint);
    of.S_c_and_S_t = malloc((2 * parameters + 1) * sizeof *of.S_c_and_S_t);
    tvi_status status = adjoint && of.S_c_and_S_t ? TVI_OK : TVI_ENOMEM;
    if (status == TVI_OK) of.H_c = of.S_c_and_S_t + parameters + 1;
    if (status == TVI_OK) status = record_with_tapes(adjoint, &of);
    free(of.S_c_and_S_t);
    if (status != TVI_OK) tvi_adjoint_free(adjoint);
    *out = status == TVI_OK ? adjoint : NULL;
    return jet_explain_out_of_memory(status);
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
    tvi_adjoint **kept = &system->stepped_system->record.adjoint, *adjoint, *before = NULL;
    *out = __atomic_load_n(kept, __ATOMIC_ACQUIRE);
    if (*out) return TVI_OK;
    const tvi_status status = tvi_adjoint_create(&adjoint, system, 0, NULL);
    if (status != TVI_OK) return status;
    const bool is_first =
        __atomic_compare_exchange_n(kept, &before, adjoint, false, __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE);
    if (!is_first) tvi_adjoint_free(adjoint);
    *out = is_first ? adjoint : before;
    return TVI_OK;
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
