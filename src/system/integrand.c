/* integrand.c - Records the functions of running integrals (integrand.h). */
#include "system/integrand.h"
#include "system/event.h"
#include "system/refuse.h"

#include <stdlib.h>

/* Gives the parameters of l the values with which the system has recorded them. */
static tvi_status take_parameters(const jet_graph *l, const tvi_system *system)
{
    const int count = tvi_system_parameters(system);
    double *value = calloc((size_t)count + 1, sizeof *value);
    if (!value) return TVI_ENOMEM;
    tvi_system_recorded_parameters(system, value);
    for (int i = 0; i < jet_graph_node_count(l); i++) {
        struct jet_node *node = jet_graph_node_at(l, i);
        if (node->op == OP_PARAMETER && node->parameter_index < count) node->number = value[node->parameter_index];
    }
    free(value);
    return jet_graph_parameter_count(l) <= count
               ? TVI_OK
               : jet_refuse(TVI_EINVAL, "a running integral has a parameter that the system has not");
}

/* Records l, which has been recorded as an event function, and dt/ds of a rescaled system. */
static tvi_status record_integrand(tvi_integrand *out, const tvi_system *system, const tvi_event *l, jet jets[])
{
    const tvi_system *stepped = system->stepped_system;
    const int n = system->n, N = stepped->n;
    jet *q = jets, *p = q + N, *input = p + N, *rates = input + 2 * n + 1, t = jet_graph_input(out->graph, 2 * N);
    for (int i = 0; i < N; i++) q[i] = jet_graph_input(out->graph, i), p[i] = jet_graph_input(out->graph, N + i);
    for (int i = 0; i < n; i++) input[i] = q[i], input[n + i] = p[i];
    input[2 * n] = N > n ? q[n] : t;
    if (!jet_record_again(l->graph, out->graph, input, 1, &l->output, &out->output)) return TVI_ENOMEM;
    if (N > n) {
        if (!tvi_system_record_again(stepped, q, p, t, 2 * N, stepped->record.field, rates)) return TVI_ENOMEM;
        out->output = jet_mul(out->output, rates[N + n]);
    }
    return jet_graph_check_outputs(out->graph, 1, &out->output);
}

tvi_status tvi_integrand_create(tvi_integrand *out, const tvi_system *system, tvi_event_fn *l, void *ctx)
{
    const int N = system->stepped_system->n, inputs = 2 * N + 1;
    tvi_event *event;
    *out = (tvi_integrand){.graph = NULL};
    tvi_status status = tvi_event_create(&event, system->n, TVI_EITHER, false, l, ctx);
    if (status != TVI_OK) return status;
    jet *jets = malloc((6 * (size_t)N + 1) * sizeof *jets);
    out->graph = jet_graph_create(inputs);
    status = jets && out->graph ? take_parameters(event->graph, system) : TVI_ENOMEM;
    if (status == TVI_OK) status = record_integrand(out, system, event, jets);
    if (out->graph) jet_graph_end_recording(out->graph);
    if (status == TVI_OK) out->tape = jet_tape_create(out->graph, inputs, 1, &out->output, JET_TAPE_VALUES);
    if (status == TVI_OK && !out->tape) status = TVI_ENOMEM;
    tvi_event_free(event);
    free(jets);
    if (status != TVI_OK) tvi_integrand_free(out);
    return jet_explain_out_of_memory(status);
}

void tvi_integrand_free(tvi_integrand *integrand)
{
    jet_tape_free(integrand->tape);
    jet_graph_free(integrand->graph);
    *integrand = (tvi_integrand){.graph = NULL};
}
