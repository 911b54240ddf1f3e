/* step.c - makes steps: the stepper finds the increments of all members, and those whose new state is one to return are
 * added to them by compensated summation. */
#include "run/advance.h"
#include "run/guard.h"
#include "run/integrator.h"
#include "method/single.h"
#include "algebra/sizes.h"
#include "system/refuse.h"
#include "vector.h"

#include <math.h>
#include <string.h>

static const tvi_advance_loops *const loops_of[JET_ISA_COUNT] = {
    [jet_isa_base] = &tvi_advance_loops_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = &tvi_advance_loops_avx2,
    [jet_isa_avx512] = &tvi_advance_loops_avx512,
#endif
};

void tvi_integrator_reset(tvi_integrator *integrator)
{
    if (!integrator) return;
    for (int m = 0; m < integrator->width; m++) integrator->continues[m] = false;
    integrator->stats.largest_tail = 0;
}

/* Loops over the members stand in functions that are told the width, so that they are compiled for one member, and for
 * any number. */

/* ---- The increments ---------------------------------------------------------------------------------------------- */

/* By the stepper's own step; with a tolerance its size is chosen, and *h is the farthest it may go. */
static void find_increments_alone(tvi_integrator *it, double tolerance, double *h)
{
    const tvi_stepper *stepper = it->stepper;
    const tvi_run_state *now = &it->now;
    const tvi_increments *by = &it->by;
    const int dimension = it->stepped->n;
    const long passes = it->stats.passes;
    const size_t bytes = (size_t)dimension * sizeof *by->dq_low;
    const tvi_origin origin = {now->q[dimension], now->q_low[dimension], now->q, now->q_low, now->p, now->p_low};
    memset(by->dq_low, 0, bytes);
    memset(by->dp_low, 0, bytes);
    it->status[0] = tolerance > 0 ? stepper->step_within(it->work, tolerance, h, &origin, by, &it->stats)
                                  : stepper->step(it->work, *h, &origin, by, &it->stats);
    it->tail[0] = it->stats.tail;
    it->passes[0] = (int)(it->stats.passes - passes);
}

/* Of all members that move; their statuses are those of the stepper. */
JET_INLINE void find_increments(tvi_integrator *it, int width, double tolerance, double *h)
{
    const tvi_run_state *now = &it->now;
    const int time = it->stepped->n * width;
    if (width > 1) {
        const tvi_batch_origin origin = {now->q + time, now->q_low + time, now->q, now->q_low, now->p, now->p_low};
        const tvi_batch_end end = {it->by, it->status, it->tail, it->passes};
        it->stepper->batch->step(it->work, *h, &origin, &end, &it->stats);
    } else {
        find_increments_alone(it, tolerance, h);
    }
    for (int m = 0; m < width; m++) it->by.dq[time + m] = *h;
}

/* ---- Whether they are to be added -------------------------------------------------------------------------------- */

/* Whether the field has finite values where the member's step starts; that of a Lagrangian at rest there. */
static bool starts_finite(tvi_integrator *it, int m)
{
    const tvi_system *system = it->stepped;
    const jet_tape *tape = system->field_values;
    const int n = system->n;
    const double t = it->now.q[n * it->width + m];
    tvi_member_lend_parameters(it, m);
    tvi_gather(n, it->width, it->now.q, m, it->field);
    for (int i = n; i < system->inputs; i++) it->field[i] = 0;
    if (system->form == TVI_HAMILTONIAN) tvi_gather(n, it->width, it->now.p, m, it->field + n);
    tvi_system_set_time(system, it->field, 1, &t);
    bool is_finite = tape->interpreted->values(tape, it->field, 1);
    for (int i = 0; i < tape->outputs; i++) is_finite = is_finite && isfinite(it->field[tape->output[i]]);
    return is_finite;
}

/* A step that overflows is too large, or what the user computes is not finite where it starts. */
static tvi_status overflow_status(tvi_integrator *it, int m)
{
    return starts_finite(it, m) ? TVI_ETOOLARGE : TVI_ENONFINITE;
}

/* Why the stepper's step has failed. */
static tvi_status explain(tvi_integrator *it, int m)
{
    const tvi_status status = it->status[m];
    if (status == TVI_ENONFINITE && overflow_status(it, m) == TVI_ETOOLARGE)
        return jet_refuse(TVI_ETOOLARGE, "its passes overflow: the step is too large");
    return tvi_refuse_as("its equations", status);
}

/* Which component of the member's new state is not finite. */
static tvi_status refuse_overflow(tvi_integrator *it, int m)
{
    const int width = it->width, rows = it->stepped->n;
    const tvi_status status = overflow_status(it, m);
    for (int i = 0, at = m; i <= rows; i++, at += width)
        if (!isfinite(it->now.q[at] + (it->now.q_low[at] + it->by.dq[at])))
            return jet_refuse(status, "q[%d] overflows", i);
    for (int i = 0, at = m; i < rows; i++, at += width)
        if (!isfinite(it->now.p[at] + (it->now.p_low[at] + it->by.dp[at])))
            return jet_refuse(status, "p[%d] overflows", i);
    return TVI_OK;
}

/* In a rescaled system the time is a coordinate, which has to move in the direction of h. */
static tvi_status check_time(const tvi_integrator *it, int m, double h)
{
    const int time = it->system->n * it->width + m;
    const double dt = it->by.dq[time], t = it->now.q[time];
    if (fabs(dt) <= tvi_least_time(t)) return jet_refuse(TVI_ENOCONV, "the time does not move, as before a collision");
    return (dt > 0) == (h > 0) ? TVI_OK : jet_refuse(TVI_ETOOLARGE, "the time goes the other way");
}

JET_INLINE void find_overflows(tvi_integrator *it, int width)
{
    const tvi_run_state *now = &it->now;
    const tvi_increments *by = &it->by;
    const int rows = it->stepped->n;
    for (int m = 0; m < width; m++) it->overflows[m] = 0;
    if (width == 1) {
        tvi_find_overflows(rows + 1, 1, now->q, now->q_low, by->dq, it->overflows);
        tvi_find_overflows(rows, 1, now->p, now->p_low, by->dp, it->overflows);
    } else {
        const tvi_advance_loops *loops = loops_of[it->stepped->field_values->sweeps->isa];
        loops->find_overflows(rows + 1, width, now->q, now->q_low, by->dq, it->overflows);
        loops->find_overflows(rows, width, now->p, now->p_low, by->dp, it->overflows);
    }
}

/* Sets the status of the members whose step of size h is not to be returned. */
JET_INLINE void check_members(tvi_integrator *it, int width, double h, bool took_series)
{
    find_overflows(it, width);
    for (int m = 0; m < width; m++) {
        if (!it->moves[m]) continue;
        tvi_status *status = &it->status[m];
        if (*status != TVI_OK) *status = explain(it, m);
        else if (it->overflows[m] != 0) *status = refuse_overflow(it, m);
        else if (tvi_is_rescaled(it)) *status = check_time(it, m, h);
    }
    tvi_guard_step(it, took_series);
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

/* The new states of the members whose step is made. */
JET_INLINE void advance(tvi_integrator *it, int width)
{
    const tvi_run_state *now = &it->now;
    const tvi_increments *by = &it->by;
    const int rows = it->stepped->n;
    if (width == 1 && it->status[0] == TVI_OK) {
        tvi_advance(rows + 1, 1, now->q, now->q_low, by->dq, by->dq_low, it->status);
        tvi_advance(rows, 1, now->p, now->p_low, by->dp, by->dp_low, it->status);
    } else if (width > 1) {
        const tvi_advance_loops *loops = loops_of[it->stepped->field_values->sweeps->isa];
        loops->advance(rows + 1, width, now->q, now->q_low, by->dq, by->dq_low, it->status);
        loops->advance(rows, width, now->p, now->p_low, by->dp, by->dp_low, it->status);
    }
}

/* A step of the members that are TVI_OK from their own states; with a tolerance its size is chosen, and h is the
 * farthest it may go. Members that fail keep their state, and get a status. Returns how many have made it. */
JET_INLINE int step_members(tvi_integrator *it, int width, double tolerance, double h)
{
    const long expansions = it->stats.expansions;
    int made = 0;
    it->has_dense = false;
    for (int m = 0; m < width; m++) it->moves[m] = it->status[m] == TVI_OK;
    tvi_arena_copy(it->before, it->history, it->marked);
    find_increments(it, width, tolerance, &h);
    check_members(it, width, h, it->stats.expansions != expansions);
    advance(it, width);
    for (int m = 0; m < width; m++) {
        if (it->status[m] != TVI_OK) continue;
        it->continues[m] = true;
        made++;
    }
    if (made == 0) tvi_arena_copy(it->history, it->before, it->marked);
    it->stats.steps += made;
    it->has_dense = made > 0;
    it->h = h;
    it->covered = it->by.dq[it->system->n * width];
    return made;
}

static int step(tvi_integrator *it, double tolerance, double h)
{
    return it->width == 1 ? step_members(it, 1, tolerance, h) : step_members(it, it->width, tolerance, h);
}

void tvi_members_step(tvi_integrator *it, long steps, double h)
{
    for (long k = 0, made = 1; k < steps && made > 0; k++) made = step(it, 0, h);
}

/* Steps of which nothing is asked, all but the last one of a run. */
static long make_row(tvi_integrator *it, long steps, double h, double t_end)
{
    const int n = it->system->n;
    const tvi_sure sure = tvi_guard_sure(it);
    const bool is_sure = !it->kept->is_known && it->stats.tail <= sure.tail;
    if (!it->stepper->run || !is_sure || steps < 1) return 0;
    const tvi_row row = {h, steps, sure, tvi_is_rescaled(it) ? n : -1, t_end, it->by};
    const long made = it->stepper->run(it->work, &row, &it->now, &it->stats);
    it->stats.steps += made;
    *it->continues |= made > 0;
    return made;
}

/* Says of an integrator's step that failed which one it was. */
static tvi_status refuse_step(const tvi_integrator *it)
{
    const char *const of = tvi_is_rescaled(it) ? " in s, of K = g (H + e)," : "";
    return jet_refuse(it->status[0], "step of %g%s from t = %g: %s", it->h, of, it->now.q[it->system->n],
                      jet_refusal());
}

/* At least one step; up to the first that fails or comes to t_end. */
static tvi_status go(tvi_integrator *it, long steps, double tolerance, double h, double t_end, double *t, double q[],
                     double p[])
{
    const tvi_run_arguments given = {it, t, q, p, h};
    if (!it) return tvi_refuse_run(given, "");
    if (!it->is_telling) it->has_dense = false;
    if (!t || !q || !p || h == 0 || !isfinite(h)) return tvi_refuse_run(given, "");
    tvi_status status = tvi_integrator_begin(it, *t, q, p);
    if (status != TVI_OK) return status;
    const bool in_rows = tolerance == 0;
    const double *now = &it->now.q[it->system->n], way = copysign(1, h);
    for (long k = 0; status == TVI_OK && k < steps && (k == 0 || way * (t_end - *now) > 0); k++) {
        if (in_rows) k += make_row(it, steps - 1 - k, h, t_end);
        it->status[0] = TVI_OK;
        if (step(it, tolerance, h) == 0) status = refuse_step(it);
    }
    tvi_state_now(it, t, q, p);
    return status;
}

tvi_status tvi_step(tvi_integrator *it, double h, double *t, double q[], double p[])
{
    return go(it, 1, 0, h, tvi_no_end(h), t, q, p);
}

tvi_status tvi_steps(tvi_integrator *it, long steps, double h, double t_end, double *t, double q[], double p[])
{
    return go(it, steps, 0, h, t_end, t, q, p);
}

tvi_status tvi_step_within(tvi_integrator *it, double tolerance, double h, double *t, double q[], double p[])
{
    return go(it, 1, tolerance, h, tvi_no_end(h), t, q, p);
}

void tvi_integrator_take_back(tvi_integrator *it, double *t, double q[], double p[])
{
    tvi_arena_copy(it->history, it->before, it->marked);
    it->has_dense = false;
    it->stats.steps--;
    tvi_state_now(it, t, q, p);
}
