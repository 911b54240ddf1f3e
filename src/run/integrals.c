/* integrals.c - Sums running integrals along the steps of a record (record.h), at the nodes of the steps: the sums
 * whose exact derivatives gradient.c computes. */
#include "method/method.h"
#include "run/record.h"
#include "system/refuse.h"

#include <stdlib.h>

/* Creates the integrand and its block at the end of the array, which has room for it. */
static tvi_status open_integral(tvi_record *record, tvi_event_fn *l, void *ctx)
{
    tvi_integral *made = &record->integrals.of[record->integrals.count];
    *made = (tvi_integral){.block = NULL};
    const tvi_status status = tvi_integrand_create(&made->integrand, record->again->system, l, ctx);
    if (status != TVI_OK) return status;
    made->block = jet_tape_create_block(made->integrand.tape, 1);
    if (!made->block) {
        tvi_integrand_free(&made->integrand);
        return jet_explain_out_of_memory(TVI_ENOMEM);
    }
    record->integrals.count++;
    return TVI_OK;
}

tvi_status tvi_record_integral(tvi_record *record, tvi_event_fn *l, void *ctx)
{
    if (!record) return jet_refuse(TVI_EINVAL, "record is NULL");
    if (!(tvi_find_method(&record->again->options)->supports->form_mask & TVI_SUPPORTS_FIELD))
        return jet_refuse(TVI_EUNSUPPORTED, "running integrals are for galerkin");
    if (record->writer) return jet_refuse(TVI_EINVAL, "a run writes the record");
    const size_t count = (size_t)record->integrals.count, N = (size_t)record->again->stepped->n;
    tvi_integral *grown = realloc(record->integrals.of, (count + 1) * sizeof *grown);
    if (!grown) return jet_explain_out_of_memory(TVI_ENOMEM);
    record->integrals.of = grown;
    if (!record->integrals.nodes) record->integrals.nodes = malloc(2 * N * TVI_MOST_POINTS * sizeof(double));
    if (!record->integrals.nodes) return jet_explain_out_of_memory(TVI_ENOMEM);
    const tvi_status status = open_integral(record, l, ctx);
    if (status != TVI_OK) return status;
    tvi_record_begin_anew(record);
    tvi_backward_free(record->backward);
    record->backward = NULL;
    return TVI_OK;
}

void tvi_record_integrals(const tvi_record *record, double value[])
{
    for (int k = 0; record && k < record->integrals.count; k++) value[k] = record->integrals.of[k].value;
}

void tvi_integrals_free(tvi_record *record)
{
    for (int k = 0; k < record->integrals.count; k++) {
        tvi_integrand_free(&record->integrals.of[k].integrand);
        free(record->integrals.of[k].block);
    }
    free(record->integrals.of);
    free(record->integrals.nodes);
}

/* Computes an integrand at q and p, with the variable of the steps. */
static tvi_status evaluate(const tvi_record *record, const tvi_integral *of, const double q[], const double p[],
                           double variable, double *value)
{
    const jet_tape *tape = of->integrand.tape;
    const size_t N = (size_t)record->again->stepped->n;
    memcpy(of->block, q, N * sizeof *q);
    memcpy(of->block + N, p, N * sizeof *p);
    of->block[2 * N] = variable;
    jet_tape_set_parameters(tape, of->block, 1, tvi_system_parameters(record->again->system), 1,
                            record->again->parameters);
    if (!jet_sweep_values(tape, of->block, 1)) return jet_refuse(TVI_EDOMAIN, "a running integral has no value");
    *value = of->block[tape->output_slot[0]];
    return TVI_OK;
}

tvi_status tvi_integrand_at(const tvi_record *record, int index, const double state[], double *value)
{
    const int N = record->again->stepped->n;
    return evaluate(record, &record->integrals.of[index], state, state + N + 1, state[N], value);
}

/* Adds the integrals over an integrator's last step. at_nodes has no momenta of a separable system; those at the nodes
 * are on its curve. */
static tvi_status add(tvi_record *record, const tvi_integrator *it)
{
    double theta[TVI_MOST_POINTS], b[TVI_MOST_POINTS];
    const int points = it->stepper->quadrature(it->work, theta, b), N = it->stepped->n;
    const tvi_run_state *start = &it->last_step.start;
    double *x = it->last_step.increments.dq, *p = it->last_step.increments.dp;
    const double h = it->last_step.h;
    tvi_status status = TVI_OK;
    it->stepper->at_nodes(it->work, start->q, start->p, record->integrals.nodes,
                          record->integrals.nodes + N * TVI_MOST_POINTS);
    for (int node = 0; node < points && b[node] != 0; node++) {
        it->stepper->interpolate(it->work, theta[node], x, p);
        for (int i = 0; i < N; i++) {
            x[i] = record->integrals.nodes[i * points + node];
            p[i] += start->p[i];
        }
        const double variable = start->q[N] + (start->q_low[N] + theta[node] * h);
        for (int k = 0; k < record->integrals.count && status == TVI_OK; k++) {
            tvi_integral *sum = &record->integrals.of[k];
            double l = 0;
            status = evaluate(record, sum, x, p, variable, &l);
            sum->value = tvi_add_compensated(sum->value, &sum->low, h * b[node] * l, 0);
        }
    }
    if (status != TVI_OK) tvi_integrals_drop_step(record);
    return status;
}

tvi_status tvi_integrals_add_step(tvi_record *record, const tvi_integrator *it)
{
    for (int k = 0; k < record->integrals.count; k++) {
        tvi_integral *sum = &record->integrals.of[k];
        sum->value_before = sum->value;
        sum->low_before = sum->low;
    }
    return add(record, it);
}

void tvi_integrals_drop_step(tvi_record *record)
{
    for (int k = 0; k < record->integrals.count; k++) {
        tvi_integral *sum = &record->integrals.of[k];
        sum->value = sum->value_before;
        sum->low = sum->low_before;
    }
}

tvi_status tvi_integrals_cut_step(tvi_record *record, const tvi_integrator *it, double offset)
{
    tvi_integrator *again = record->again;
    const size_t n = (size_t)it->system->n;
    if (offset == it->last_step.h) return TVI_OK;
    tvi_integrals_drop_step(record);
    double *x = offset != 0 ? malloc((2 * n + 1) * sizeof *x) : NULL;
    if (!x) return offset != 0 ? jet_explain_out_of_memory(TVI_ENOMEM) : TVI_OK;
    tvi_integrator_copy_before(it, again->history.now);
    tvi_integrator_copy_state(again, &x[2 * n], x, x + n);
    tvi_status status = tvi_step(again, offset, &x[2 * n], x, x + n);
    if (status == TVI_OK) status = add(record, again);
    free(x);
    return status;
}
