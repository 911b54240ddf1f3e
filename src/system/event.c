/* event.c - Records the user's event functions, creates the tape that evaluates several of them at once, and computes
 * the change of an event function near a state by its Taylor series (event.h). */
#include "system/event.h"
#include "algebra/sizes.h"
#include "system/refuse.h"
#include "system/roundoff.h"
#include "system/system.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* [orders] The degree of the Taylor polynomial of g along a line. */
#define EVENT_LINE_DEGREE 8 /* found: make check-events */

/* Calls the user's function g on jets, and creates the tapes of its values and of its Taylor series. */
static tvi_status record_event_function(tvi_event *event, tvi_event_fn *g, void *ctx)
{
    const int n = event->n, inputs = 2 * n + 1;
    const size_t padded_count = tvi_padded_vector_count(n);
    jet *q = malloc(2 * padded_count * sizeof *q);
    event->graph = jet_graph_create(inputs);
    if (event->graph) jet_graph_set_output_name(event->graph, "event function");
    tvi_status status = q && event->graph ? TVI_OK : TVI_ENOMEM;
    if (status == TVI_OK) {
        jet *p = q + padded_count;
        for (int i = 0; i < n; i++) {
            q[i] = jet_graph_input(event->graph, i);
            p[i] = jet_graph_input(event->graph, n + i);
        }
        tvi_set_poison_beyond_end(n, q, JET_BEYOND_Q);
        tvi_set_poison_beyond_end(n, p, JET_BEYOND_P);
        jet value = g(q, p, jet_graph_input(event->graph, 2 * n), ctx);
        status = jet_graph_check_outputs(event->graph, 1, &value);
        jet_graph_end_recording(event->graph);
        if (status == TVI_OK) event->tape = jet_tape_create(event->graph, inputs, 1, &value, JET_TAPE_VALUES);
        if (status == TVI_OK) event->series = jet_tape_create(event->graph, inputs, 1, &value, JET_TAPE_SERIES);
        if (status == TVI_OK && !(event->tape && event->series)) status = TVI_ENOMEM;
        if (status == TVI_OK) event->hash = jet_tape_continue_hash(JET_HASH_OF_NOTHING, event->tape);
        event->output = value;
    }
    free(q);
    return status;
}

tvi_status tvi_event_create(tvi_event **out, int n, tvi_direction direction, bool terminal, tvi_event_fn *g, void *ctx)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    if (n < 1 || n > TVI_MAX_DIMENSION) return jet_refuse(TVI_EINVAL, "n = %d is not 1 .. %d", n, TVI_MAX_DIMENSION);
    if (direction < TVI_FALLING || direction > TVI_RISING)
        return jet_refuse(TVI_EINVAL, "direction = %d is not a tvi_direction", (int)direction);
    if (!g) return jet_refuse(TVI_EINVAL, "the function is NULL");
    tvi_event *event = calloc(1, sizeof *event);
    if (!event) return jet_explain_out_of_memory(TVI_ENOMEM);
    event->n = n;
    event->direction = direction;
    event->is_terminal = terminal;
    const tvi_status status = record_event_function(event, g, ctx);
    if (status == TVI_OK) *out = event;
    else tvi_event_free(event);
    return jet_explain_out_of_memory(status);
}

void tvi_event_free(tvi_event *event)
{
    if (!event) return;
    jet_tape_free(event->tape);
    jet_tape_free(event->series);
    jet_graph_free(event->graph);
    free(event);
}

bool tvi_events_match_dimension(int n, const tvi_event *const events[], int count)
{
    if (count < 0 || (count > 0 && !events)) {
        (void)jet_refuse(TVI_EINVAL, count < 0 ? "count = %d is negative" : "events is NULL", count);
        return false;
    }
    for (int i = 0; i < count; i++)
        if (!events[i] || events[i]->n != n) {
            (void)jet_refuse(TVI_EINVAL, "events[%d] is %s", i, events[i] ? "of another dimension" : "NULL");
            return false;
        }
    return true;
}

tvi_status tvi_event_evaluate(const tvi_event *event, double *block, const double *x, double *g)
{
    memcpy(block, x, (2 * (size_t)event->n + 1) * sizeof *x);
    if (!jet_sweep_values(event->tape, block, 1)) return tvi_refuse_failed_evaluation("event function", TVI_EDOMAIN);
    *g = block[event->tape->output_slot[0]];
    return isfinite(*g) ? TVI_OK : tvi_refuse_failed_evaluation("event function", TVI_ENONFINITE);
}

/* Records all events once more in one graph, so that expressions that several events contain are computed once. Sets
 * `jets` [input_count + count] to the inputs, and then the values of the events. */
static tvi_status record_events_in_one_graph(const tvi_event *const events[], int count, jet_graph *graph,
                                             int input_count, jet jets[])
{
    jet *input = jets, *value = jets + input_count;
    for (int i = 0; i < input_count; i++) input[i] = jet_graph_input(graph, i);
    for (int i = 0; i < count; i++)
        if (!jet_record_again(events[i]->graph, graph, input, 1, &events[i]->output, &value[i])) return TVI_ENOMEM;
    return jet_graph_check_outputs(graph, count, value);
}

tvi_status tvi_event_create_joint_tape(jet_tape **out, const tvi_event *const events[], int count, bool used[])
{
    const int inputs = 2 * events[0]->n + 1;
    jet_graph *graph = jet_graph_create(inputs);
    jet *jets = calloc((size_t)inputs + (size_t)count, sizeof *jets);
    tvi_status status = graph && jets ? record_events_in_one_graph(events, count, graph, inputs, jets) : TVI_ENOMEM;
    if (graph) jet_graph_end_recording(graph);
    if (status == TVI_OK) status = tvi_system_find_used_inputs(graph, inputs, count, jets + inputs, used);
    *out = status == TVI_OK ? jet_tape_create(graph, inputs, count, jets + inputs, JET_TAPE_VALUES) : NULL;
    if (status == TVI_OK && !*out) status = TVI_ENOMEM;
    free(jets);
    jet_graph_free(graph);
    return status;
}

tvi_status tvi_event_create_gradient_tape(jet_tape **out, const tvi_event *event, int parameter_count)
{
    const int inputs = 2 * event->n + 1, outputs = inputs + parameter_count;
    jet_graph *graph = jet_graph_create(inputs);
    jet *jets = calloc((size_t)inputs + 1 + (size_t)outputs, sizeof *jets);
    *out = NULL;
    if (graph && jets && record_events_in_one_graph(&event, 1, graph, inputs, jets) == TVI_OK) {
        jet *gradient = jets + inputs + 1;
        const bool recorded =
            jet_record_gradient_by(graph, jets[inputs], inputs, gradient, parameter_count, gradient + inputs) &&
            jet_graph_check_outputs(graph, outputs, gradient) == TVI_OK;
        jet_graph_end_recording(graph);
        if (recorded) *out = jet_tape_create(graph, inputs, outputs, gradient, JET_TAPE_VALUES);
    }
    free(jets);
    jet_graph_free(graph);
    return *out ? TVI_OK : TVI_ENOMEM;
}

/* ---- Near a state ------------------------------------------------------------------------------------------------ */

/* The number of tangents that are computed at once. */
enum { SAMPLES = TVI_ROUNDOFF_SAMPLES };

tvi_status tvi_event_expansion_open(tvi_event_expansion *expansion, const tvi_event *event)
{
    const size_t slots = (size_t)event->series->slot_count;
    expansion->series_block = malloc((EVENT_LINE_DEGREE + 1) * slots * sizeof *expansion->series_block);
    expansion->first_order_slot_changes = calloc(slots * SAMPLES, sizeof *expansion->first_order_slot_changes);
    if (!expansion->series_block || !expansion->first_order_slot_changes) return TVI_ENOMEM;
    jet_tape_write_constants(event->series, expansion->series_block, EVENT_LINE_DEGREE + 1, 1);
    return TVI_OK;
}

void tvi_event_expansion_close(tvi_event_expansion *expansion)
{
    free(expansion->series_block);
    free(expansion->first_order_slot_changes);
}

/* Computes the values of all slots of the event's series at the state x. */
static tvi_status compute_event_series_values(const tvi_event *event, const tvi_event_expansion *expansion,
                                              const double x[])
{
    memcpy(expansion->series_block, x, (2 * (size_t)event->n + 1) * sizeof *x);
    return jet_sweep_series(event->series, expansion->series_block, 0, 1)
               ? TVI_OK
               : tvi_refuse_failed_evaluation("event function", TVI_EDOMAIN);
}

/* Returns sum_i |dg/dx_i input_sizes[i]| at the state whose values were computed last. The derivatives by SAMPLES
 * inputs are computed at once. */
static double sum_first_order_magnitudes(const tvi_event *event, const tvi_event_expansion *expansion,
                                         const double input_sizes[])
{
    const int inputs = 2 * event->n + 1;
    double sum = 0;
    for (int first = 0; first < inputs; first += SAMPLES) {
        memset(expansion->first_order_slot_changes, 0,
               (size_t)inputs * SAMPLES * sizeof *expansion->first_order_slot_changes);
        for (int i = first; i < first + SAMPLES && i < inputs; i++)
            expansion->first_order_slot_changes[i * SAMPLES + i - first] = input_sizes[i];
        jet_sweep_tangents(event->series, expansion->series_block, expansion->first_order_slot_changes, 0, SAMPLES);
        for (int s = 0; s < SAMPLES; s++)
            sum += fabs(expansion->first_order_slot_changes[event->series->output_slot[0] * SAMPLES + s]);
    }
    return sum;
}

tvi_status tvi_event_estimate_roundoff(const tvi_event *event, const tvi_event_expansion *expansion, const double x[],
                                       const double input_sizes[], double *roundoff)
{
    const tvi_status status = compute_event_series_values(event, expansion, x);
    if (status != TVI_OK) return status;
    const double of_inputs = DBL_EPSILON * sum_first_order_magnitudes(event, expansion, input_sizes);
    memset(expansion->first_order_slot_changes, 0,
           (2 * (size_t)event->n + 1) * SAMPLES * sizeof *expansion->first_order_slot_changes);
    tvi_roundoff_sweep_tape(event->series, 0, NULL, expansion->series_block, expansion->first_order_slot_changes);
    *roundoff = of_inputs +
                tvi_largest_magnitude(SAMPLES,
                                      expansion->first_order_slot_changes + event->series->output_slot[0] * SAMPLES, 1);
    return TVI_OK;
}

tvi_status tvi_event_compute_change(const tvi_event *event, const tvi_event_expansion *expansion, const double x[],
                                    const double displacement[], double *change, double *first_order_magnitude,
                                    bool *is_exact)
{
    const jet_tape *tape = event->series;
    const size_t inputs = 2 * (size_t)event->n + 1, slots = (size_t)tape->slot_count;
    const tvi_status status = compute_event_series_values(event, expansion, x);
    double last = 0;
    if (status != TVI_OK) return status;
    *change = 0;
    *first_order_magnitude = sum_first_order_magnitudes(event, expansion, displacement);
    for (int k = 1; k <= EVENT_LINE_DEGREE; k++) {
        double *order = expansion->series_block + (size_t)k * slots;
        for (size_t i = 0; i < inputs; i++) order[i] = k == 1 ? displacement[i] : 0;
        (void)jet_sweep_series(tape, expansion->series_block, k, 1);
        last = order[tape->output_slot[0]];
        *change += last;
    }
    *is_exact = fabs(last) <= DBL_EPSILON * fabs(*change);
    return TVI_OK;
}
