/* end.c - Ends a run at a time (end.h). A run in the time t makes its last step as long as the remaining time. A run in
 * s, whose steps have a known end only when they are made, replaces the step that passed the time. */
#include "run/end.h"
#include "integrator/inside_step.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

double tvi_remaining_time(const tvi_integrator *it, double t_end)
{
    const int n = it->system->n;
    return (t_end - it->state.q[n]) - it->state.q_low[n];
}

/* The roundoff is two units of the larger time, since the user has rounded both. Far from t = 0 these may be many
 * steps, and the low-order part of the time still counts steps exactly: a remaining time is roundoff only if it is also
 * a small part of h, which the state is then not moved by. */
double tvi_time_roundoff(double t, double t_end, double h)
{
    return fmin(2 * DBL_EPSILON * fmax(fabs(t_end), fabs(t)), 0x1p-10 * fabs(h));
}

void tvi_set_time(tvi_integrator *it, double t_end, double *t)
{
    const int n = it->system->n;
    it->state.q_low[n] += it->state.q[n] - t_end;
    it->state.q[n] = *t = t_end;
}

tvi_status tvi_shorten_step_to_time(tvi_integrator *it, double t_end, double *t, double q[], double p[])
{
    tvi_partial_step partial_step;
    const tvi_status opened = tvi_partial_step_open(&partial_step, it, false);
    tvi_status status = opened == TVI_OK ? tvi_partial_step_to_time(&partial_step, t_end) : opened;
    tvi_integrator_undo_step(it, t, q, p);
    if (status == TVI_OK && partial_step.stored_state_offset != 0)
        status = tvi_step(it, partial_step.stored_state_offset, t, q, p);
    if (opened == TVI_OK) tvi_partial_step_close(&partial_step);
    return status;
}

/* ---- The parts of a step in s ------------------------------------------------------------------------------------ */

/* Along an orbit that escapes, t is infinite at a finite s, so that the step that would pass t_end has no solution, and
 * parts of it have one. Parts shrink as the distance from where t is infinite does: if so many of one size lead no
 * nearer, there is another reason for the failure. */
enum { MOST_PARTS = 16 };

/* Makes a part of a step, if its error, the square of the tail (tvi_stepper.is_superconvergent), is roundoff. */
static bool make_right_part(tvi_integrator *trial, double h, double *t, double q[], double p[])
{
    if (tvi_step(trial, h, t, q, p) != TVI_OK) return false;
    if (trial->stats.tail * trial->stats.tail <= DBL_EPSILON) return true;
    tvi_integrator_undo_step(trial, t, q, p);
    return false;
}

/* Counts the parts h/2, ..., h/4, ... that the trial makes one after the other. Returns whether they pass t_end. */
static bool count_parts(tvi_step_parts *parts, tvi_integrator *trial, double h, double t_end, double q[], double p[])
{
    double t, part = 0;
    tvi_integrator_copy_state(trial, &t, q, p);
    for (int k = 1; k < DBL_MANT_DIG && part < 1;) {
        if (!make_right_part(trial, ldexp(h, -k), &t, q, p)) {
            k++;
            continue;
        }
        if (++parts->count[k] > MOST_PARTS) return false;
        part += ldexp(1, -k);
        if ((tvi_remaining_time(trial, t_end) > 0) != (h > 0)) return true;
    }
    return false;
}

tvi_status tvi_parts_find(tvi_step_parts *parts, const tvi_integrator *it, double h, double t_end, bool *is_found)
{
    const size_t n = (size_t)it->system->n;
    tvi_integrator *trial = NULL;
    double *q = malloc(2 * n * sizeof *q), *p = q + n;
    const tvi_status status = q ? tvi_integrator_create_like(&trial, it) : TVI_ENOMEM;
    memset(parts, 0, sizeof *parts);
    if (status == TVI_OK) tvi_arena_copy_history(trial->history.now, it->history.now, it->history.bytes);
    *is_found = status == TVI_OK && count_parts(parts, trial, h, t_end, q, p);
    tvi_integrator_free(trial);
    free(q);
    return status;
}

double tvi_parts_take(tvi_step_parts *parts, double h)
{
    for (int k = 1; k < DBL_MANT_DIG; k++)
        if (parts->count[k] > 0) {
            parts->count[k]--;
            return ldexp(h, -k);
        }
    return 0;
}
