/* event_near.c - Estimates the roundoff of an event function at a state, and its change near that state. */
#include "system/event.h"
#include "algebra/sizes.h"
#include "system/refuse.h"
#include "system/roundoff.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The order of the Taylor polynomial along a line, and the number of signs at once. */
enum { ORDER = 8, SAMPLES = TVI_ROUNDOFF_SAMPLES };

tvi_status tvi_event_near_open(tvi_event_near *near, const tvi_event *event)
{
    const size_t slots = (size_t)event->series->slots;
    near->x = malloc((ORDER + 1) * slots * sizeof *near->x);
    near->dx = calloc(slots * SAMPLES, sizeof *near->dx);
    if (!near->x || !near->dx) return TVI_ENOMEM;
    jet_tape_prepare(event->series, near->x, ORDER + 1, 1);
    return TVI_OK;
}

void tvi_event_near_close(tvi_event_near *near)
{
    free(near->x);
    free(near->dx);
}

/* Computes the values of all slots at the state x. */
static tvi_status set_values(const tvi_event *event, const tvi_event_near *near, const double x[])
{
    memcpy(near->x, x, (2 * (size_t)event->n + 1) * sizeof *x);
    return jet_sweep_series(event->series, near->x, 0, 1) ? TVI_OK : tvi_refuse_as("event function", TVI_EDOMAIN);
}

/* sum_i |dg/dx_i| size_i at the state of the values. The derivatives of SAMPLES inputs are computed at once. */
static double first_order(const tvi_event *event, const tvi_event_near *near, const double size[])
{
    const int inputs = 2 * event->n + 1;
    double sum = 0;
    for (int first = 0; first < inputs; first += SAMPLES) {
        memset(near->dx, 0, (size_t)inputs * SAMPLES * sizeof *near->dx);
        for (int i = first; i < first + SAMPLES && i < inputs; i++) near->dx[i * SAMPLES + i - first] = size[i];
        jet_sweep_tangents(event->series, near->x, near->dx, 0, SAMPLES);
        for (int s = 0; s < SAMPLES; s++) sum += fabs(near->dx[event->series->output[0] * SAMPLES + s]);
    }
    return sum;
}

tvi_status tvi_event_roundoff(const tvi_event *event, const tvi_event_near *near, const double x[], const double size[],
                              double *roundoff)
{
    const tvi_status status = set_values(event, near, x);
    if (status != TVI_OK) return status;
    const double of_inputs = DBL_EPSILON * first_order(event, near, size);
    memset(near->dx, 0, (2 * (size_t)event->n + 1) * SAMPLES * sizeof *near->dx);
    tvi_roundoff_sweep(event->series, 0, NULL, near->x, near->dx);
    *roundoff = of_inputs + tvi_largest(SAMPLES, near->dx + event->series->output[0] * SAMPLES, 1);
    return TVI_OK;
}

tvi_status tvi_event_rise(const tvi_event *event, const tvi_event_near *near, const double x[], const double d[],
                          double *rise, double *scale, bool *is_exact)
{
    const jet_tape *tape = event->series;
    const size_t inputs = 2 * (size_t)event->n + 1, slots = (size_t)tape->slots;
    const tvi_status status = set_values(event, near, x);
    double last = 0;
    if (status != TVI_OK) return status;
    *rise = 0;
    *scale = first_order(event, near, d);
    for (int k = 1; k <= ORDER; k++) {
        double *order = near->x + (size_t)k * slots;
        for (size_t i = 0; i < inputs; i++) order[i] = k == 1 ? d[i] : 0;
        (void)jet_sweep_series(tape, near->x, k, 1);
        last = order[tape->output[0]];
        *rise += last;
    }
    *is_exact = fabs(last) <= DBL_EPSILON * fabs(*rise);
    return TVI_OK;
}
