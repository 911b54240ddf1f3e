/* event.c - records the user's event functions. */
#include "event.h"
#include "stepper.h"

#include <stdlib.h>

static void use(tvi_event *event, bool is_used[], const struct jet_node *node)
{
    if (!node || node->op != OP_INPUT || is_used[node->index]) return;
    is_used[node->index] = true;
    event->used[event->uses++] = node->index;
}

/* The inputs that the output is, or that operations have as operands. */
static tvi_status find_uses(tvi_event *event, int inputs, jet output)
{
    bool *is_used = calloc((size_t)inputs, sizeof *is_used);
    event->used = calloc((size_t)inputs, sizeof *event->used);
    const tvi_status status = is_used && event->used ? TVI_OK : TVI_ENOMEM;
    for (int i = 0; i < jet_graph_count(event->graph) && status == TVI_OK; i++) {
        const struct jet_node *node = jet_graph_node(event->graph, i);
        use(event, is_used, node->a);
        use(event, is_used, node->b);
        for (int k = 0; k < node->count; k++) use(event, is_used, node->terms[k].node);
    }
    if (status == TVI_OK) use(event, is_used, output.node);
    free(is_used);
    return status;
}

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
        if (status == TVI_OK) status = find_uses(event, inputs, value);
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
    free(event->used);
    jet_tape_free(event->tape);
    jet_graph_free(event->graph);
    free(event);
}

/* The inputs that the tape uses, of all lanes. */
static inline void copy_inputs(const tvi_event *event, double *block, int lanes, const double *x)
{
    for (int i = 0; i < event->uses; i++) {
        const size_t row = (size_t)event->used[i] * (size_t)lanes;
        for (int lane = 0; lane < lanes; lane++) block[row + (size_t)lane] = x[row + (size_t)lane];
    }
}

/* Whether all are finite: 0 g is 0 then. */
static inline tvi_status take_values(const double *value, int lanes, double g[])
{
    double nothing = 0;
    for (int lane = 0; lane < lanes; lane++) {
        g[lane] = value[lane];
        nothing += 0 * value[lane];
    }
    return nothing == 0 ? TVI_OK : TVI_ENONFINITE;
}

tvi_status tvi_event_value(const tvi_event *event, double *block, const double *x, double *g)
{
    copy_inputs(event, block, 1, x);
    if (!jet_sweep_values(event->tape, block, 1)) return TVI_EDOMAIN;
    return take_values(block + event->tape->output[0], 1, g);
}

tvi_status tvi_event_samples(const tvi_event *event, double *block, const double *x, double g[])
{
    if (x != block) copy_inputs(event, block, TVI_SAMPLES, x);
    if (!jet_sweep_values(event->tape, block, TVI_SAMPLES)) return TVI_EDOMAIN;
    return take_values(block + (size_t)event->tape->output[0] * TVI_SAMPLES, TVI_SAMPLES, g);
}
