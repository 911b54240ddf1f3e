/* event_near.c - Estimates the roundoff of an event function at a state, and its change near that state, by the
 * function's Taylor series (event.h). */
#include "system/event.h"
#include "algebra/sizes.h"
#include "system/refuse.h"
#include "system/roundoff.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The degree of the Taylor polynomial along a line, and the number of tangents that are computed at once. */
enum { ORDER = 8, SAMPLES = TVI_ROUNDOFF_SAMPLES };

tvi_status tvi_event_expansion_open(tvi_event_expansion *expansion, const tvi_event *event)
{
    const size_t slots = (size_t)event->series->slots;
    expansion->series_block = malloc((ORDER + 1) * slots * sizeof *expansion->series_block);
    expansion->tangents = calloc(slots * SAMPLES, sizeof *expansion->tangents);
    if (!expansion->series_block || !expansion->tangents) return TVI_ENOMEM;
    jet_tape_prepare_block(event->series, expansion->series_block, ORDER + 1, 1);
    return TVI_OK;
}

void tvi_event_expansion_close(tvi_event_expansion *expansion)
{
    free(expansion->series_block);
    free(expansion->tangents);
}

/* Computes the values of all slots of the event's series at the state x. */
static tvi_status compute_series_values(const tvi_event *event, const tvi_event_expansion *expansion, const double x[])
{
    memcpy(expansion->series_block, x, (2 * (size_t)event->n + 1) * sizeof *x);
    return jet_sweep_series(event->series, expansion->series_block, 0, 1)
               ? TVI_OK
               : tvi_refuse_failed_evaluation("event function", TVI_EDOMAIN);
}

/* Returns sum_i |dg/dx_i| size_i at the state whose values were computed last. The derivatives by SAMPLES inputs are
 * computed at once. */
static double sum_first_order_terms(const tvi_event *event, const tvi_event_expansion *expansion, const double sizes[])
{
    const int inputs = 2 * event->n + 1;
    double sum = 0;
    for (int first = 0; first < inputs; first += SAMPLES) {
        memset(expansion->tangents, 0, (size_t)inputs * SAMPLES * sizeof *expansion->tangents);
        for (int i = first; i < first + SAMPLES && i < inputs; i++)
            expansion->tangents[i * SAMPLES + i - first] = sizes[i];
        jet_sweep_tangents(event->series, expansion->series_block, expansion->tangents, 0, SAMPLES);
        for (int s = 0; s < SAMPLES; s++) sum += fabs(expansion->tangents[event->series->output_slot[0] * SAMPLES + s]);
    }
    return sum;
}

tvi_status tvi_event_estimate_roundoff(const tvi_event *event, const tvi_event_expansion *expansion, const double x[],
                                       const double sizes[], double *roundoff)
{
    const tvi_status status = compute_series_values(event, expansion, x);
    if (status != TVI_OK) return status;
    const double of_inputs = DBL_EPSILON * sum_first_order_terms(event, expansion, sizes);
    memset(expansion->tangents, 0, (2 * (size_t)event->n + 1) * SAMPLES * sizeof *expansion->tangents);
    tvi_roundoff_sweep_tape(event->series, 0, NULL, expansion->series_block, expansion->tangents);
    *roundoff =
        of_inputs + tvi_largest_magnitude(SAMPLES, expansion->tangents + event->series->output_slot[0] * SAMPLES, 1);
    return TVI_OK;
}

tvi_status tvi_event_compute_change(const tvi_event *event, const tvi_event_expansion *expansion, const double x[],
                                    const double displacement[], double *change, double *term_sum, bool *is_exact)
{
    const jet_tape *tape = event->series;
    const size_t inputs = 2 * (size_t)event->n + 1, slots = (size_t)tape->slots;
    const tvi_status status = compute_series_values(event, expansion, x);
    double last = 0;
    if (status != TVI_OK) return status;
    *change = 0;
    *term_sum = sum_first_order_terms(event, expansion, displacement);
    for (int k = 1; k <= ORDER; k++) {
        double *order = expansion->series_block + (size_t)k * slots;
        for (size_t i = 0; i < inputs; i++) order[i] = k == 1 ? displacement[i] : 0;
        (void)jet_sweep_series(tape, expansion->series_block, k, 1);
        last = order[tape->output_slot[0]];
        *change += last;
    }
    *is_exact = fabs(last) <= DBL_EPSILON * fabs(*change);
    return TVI_OK;
}
