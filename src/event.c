/* event.c - records the user's event functions. */
#include "event.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static tvi_status record(tvi_event *event, tvi_event_fn *g, void *ctx)
{
    const int n = event->n, inputs = 2 * n + 1;
    jet *state = calloc((size_t)inputs, sizeof *state);
    event->graph = jet_graph_create(inputs);
    tvi_status status = state && event->graph ? TVI_OK : TVI_ENOMEM;
    for (int i = 0; i < inputs && status == TVI_OK; i++) state[i] = jet_graph_input(event->graph, i);
    if (status == TVI_OK) {
        jet value = g(state, state + n, state[2 * n], ctx);
        status = jet_graph_accept(event->graph, 1, &value);
        jet_graph_close(event->graph);
        if (status == TVI_OK) event->tape = jet_tape_create(event->graph, inputs, 1, &value, JET_TAPE_VALUES);
        if (status == TVI_OK && !event->tape) status = TVI_ENOMEM;
    }
    free(state);
    return status;
}

tvi_status tvi_event_create(tvi_event **out, int n, tvi_direction direction, bool terminal, tvi_event_fn *g, void *ctx)
{
    if (!out) return TVI_EINVAL;
    *out = NULL;
    if (n < 1 || n > TVI_MAX_DIMENSION || direction < TVI_FALLING || direction > TVI_RISING || !g) return TVI_EINVAL;
    tvi_event *event = calloc(1, sizeof *event);
    if (!event) return TVI_ENOMEM;
    event->n = n;
    event->direction = direction;
    event->terminal = terminal;
    const tvi_status status = record(event, g, ctx);
    if (status == TVI_OK) *out = event;
    else tvi_event_free(event);
    return status;
}

void tvi_event_free(tvi_event *event)
{
    if (!event) return;
    jet_tape_free(event->tape);
    jet_graph_free(event->graph);
    free(event);
}

tvi_status tvi_event_value(const tvi_event *event, double *x, double t, const double q[], const double p[], double *g)
{
    const size_t n = (size_t)event->n;
    memcpy(x, q, n * sizeof *x);
    memcpy(x + n, p, n * sizeof *x);
    x[2 * n] = t;
    if (!jet_sweep_values(event->tape, x, 1)) return TVI_EDOMAIN;
    *g = x[event->tape->output[0]];
    return isfinite(*g) ? TVI_OK : TVI_ENONFINITE;
}
