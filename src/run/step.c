/* step.c - a step: checks what comes in, holds the state between steps, and adds the increments by compensated
 * summation. */
#include "run/integrator.h"
#include "algebra/sizes.h"
#include "run/guard.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <string.h>

void tvi_integrator_reset(tvi_integrator *integrator)
{
    if (!integrator) return;
    *integrator->continues = false;
    integrator->stats.largest_tail = 0;
}

/* All bits in which the components differ, of a vector that steps have left in parts. */
static uint64_t difference(int n, const double a[], const double b[])
{
    uint64_t any = 0;
    for (int i = 0; i < n; i++) {
        any |= tvi_bits(a[i]) ^ tvi_bits(b[i]);
        if (n < 8) __asm__("" : "+r"(any));
    }
    return any;
}

bool tvi_integrator_has(const tvi_integrator *it, double t, const double q[], const double p[])
{
    const int n = it->system->n;
    return (difference(n, q, it->now.q) | difference(n, p, it->now.p) | difference(1, &t, &it->now.q[n])) == 0;
}

/* K as it is with another e, in long double. */
static long double transformed_with(tvi_integrator *it, double e)
{
    it->now.p[it->system->n] = e;
    return tvi_energy_precise(&it->transformed, 0, it->now.q, it->now.p);
}

/* e = -H(q, p, t), where K = g (H + e) is 0 (rescaled.c). The roundoff of H at a pericentre, whose terms cancel, would
 * shift the period of the orbit: e is the root of K in long double, of which K is a linear function. */
static tvi_status set_energy(tvi_integrator *it)
{
    const int n = it->system->n;
    double H;
    const tvi_status status = tvi_energy_of(&it->energy, it->now.q[n], it->now.q, it->now.p, &H);
    if (status != TVI_OK) return tvi_refuse_as("energy", status);
    const double apart = H != 0 ? H : 1;
    const long double there = transformed_with(it, apart - H), here = transformed_with(it, -H);
    const long double correction = apart * (here / (here - there)), e = isfinite(correction) ? correction - H : -H;
    it->now.p[n] = (double)e;
    it->now.p_low[n] = (double)(e - it->now.p[n]);
    return TVI_OK;
}

tvi_status tvi_integrator_begin(tvi_integrator *it, double t, const double q[], const double p[])
{
    const int n = it->system->n;
    if (it->is_telling) return jet_refuse(TVI_EINVAL, "the integrator is in a run, whose observer may not step it");
    if (*it->continues && tvi_integrator_has(it, t, q, p)) return TVI_OK;
    if (!isfinite(t) || !tvi_all_finite(n, q) || !tvi_all_finite(n, p)) return tvi_refuse_state(n, t, q, "p", p);
    tvi_arena_copy(it->history, NULL, it->remembered);
    memcpy(it->now.q, q, (size_t)n * sizeof *q);
    memcpy(it->now.p, p, (size_t)n * sizeof *p);
    it->now.q[n] = t;
    tvi_guard_begin(it);
    return tvi_is_rescaled(it) ? set_energy(it) : TVI_OK;
}

void tvi_state_now(const tvi_integrator *it, double *t, double q[], double p[])
{
    const int n = it->system->n;
    for (int i = 0; i < n; i++) {
        q[i] = it->now.q[i];
        p[i] = it->now.p[i];
        TVI_ONE_BY_ONE(n, p[i]);
    }
    *t = it->now.q[n];
}

/* Of a rescaled system the time goes the way of h, and moves. */
static tvi_status check_time(const tvi_integrator *it, double h)
{
    const double dt = it->by.dq[it->system->n], t = it->now.q[it->system->n];
    if (fabs(dt) <= tvi_least_time(t)) return jet_refuse(TVI_ENOCONV, "the time does not move, as before a collision");
    return (dt > 0) == (h > 0) ? TVI_OK : jet_refuse(TVI_ETOOLARGE, "the time goes the other way");
}

/* Whether the field has finite values where the step starts; that of a Lagrangian at rest there. */
static bool starts_finite(const tvi_integrator *it)
{
    const tvi_system *system = it->stepped;
    const jet_tape *tape = system->field_values;
    const int n = system->n;
    memcpy(it->field, it->start.q, (size_t)n * sizeof *it->field);
    for (int i = n; i < system->inputs; i++) it->field[i] = system->form == TVI_HAMILTONIAN ? it->start.p[i - n] : 0;
    tvi_system_set_time(system, it->field, 1, &it->start.q[n]);
    bool is_finite = tape->interpreted->values(tape, it->field, 1);
    for (int i = 0; i < tape->outputs; i++) is_finite = is_finite && isfinite(it->field[tape->output[i]]);
    return is_finite;
}

tvi_status tvi_step_overflow(const tvi_integrator *it) { return starts_finite(it) ? TVI_ETOOLARGE : TVI_ENONFINITE; }

static tvi_status check_sums(const tvi_integrator *it)
{
    const tvi_run_state *now = &it->now;
    for (int i = 0; i <= it->stepped->n; i++)
        if (!isfinite(now->q[i])) return jet_refuse(tvi_step_overflow(it), "q[%d] overflows", i);
    for (int i = 0; i < it->stepped->n; i++)
        if (!isfinite(now->p[i])) return jet_refuse(tvi_step_overflow(it), "p[%d] overflows", i);
    return TVI_OK;
}

/* The new state from the increments; it is finite. */
static tvi_status advance(tvi_integrator *it, double h)
{
    const tvi_run_state *now = &it->now;
    const int dimension = it->stepped->n;
    const tvi_increments *by = &it->by;
    const uint64_t q = tvi_add_all_compensated(dimension + 1, now->q, now->q_low, by->dq, by->dq_low),
                   p = tvi_add_all_compensated(dimension, now->p, now->p_low, by->dp, by->dp_low);
    const tvi_status status = (q | p) == 0 ? TVI_OK : check_sums(it);
    if (status != TVI_OK) return status;
    return tvi_is_rescaled(it) ? check_time(it, h) : TVI_OK;
}

/* The increments of a step; with a tolerance its size is chosen, and *h is the farthest it may go. */
static tvi_status find_increments(tvi_integrator *it, double tolerance, double *h)
{
    const tvi_stepper *stepper = it->stepper;
    const tvi_run_state *now = &it->now;
    const tvi_increments *by = &it->by;
    const int dimension = it->stepped->n;
    const size_t bytes = (size_t)dimension * sizeof *by->dq_low;
    const tvi_origin origin = {now->q[dimension], now->q_low[dimension], now->q, now->q_low, now->p, now->p_low};
    memset(by->dq_low, 0, bytes);
    memset(by->dp_low, 0, bytes);
    const tvi_status status = tolerance > 0 ? stepper->step_within(it->work, tolerance, h, &origin, by, &it->stats)
                                            : stepper->step(it->work, *h, &origin, by, &it->stats);
    by->dq[dimension] = *h;
    return status;
}

/* The step from the integrator's own state; with a tolerance its size is chosen, and h is the farthest it may go. */
static tvi_status step(tvi_integrator *it, double tolerance, double h)
{
    const long passes = it->stats.passes, expansions = it->stats.expansions;
    it->has_dense = false;
    tvi_arena_copy(it->before, it->history, it->marked);
    tvi_status status = find_increments(it, tolerance, &h);
    if (status == TVI_ENONFINITE && tvi_step_overflow(it) == TVI_ETOOLARGE)
        status = jet_refuse(TVI_ETOOLARGE, "its passes overflow: the step is too large");
    else if (status != TVI_OK) status = tvi_refuse_as("its equations", status);
    if (status == TVI_OK) status = advance(it, h);
    if (status == TVI_OK) status = tvi_guard_step(it, passes, expansions);
    if (status == TVI_OK) {
        it->h = h;
        it->covered = it->by.dq[it->system->n];
        *it->continues = true;
        it->has_dense = true;
        it->stats.steps++;
        return TVI_OK;
    }
    tvi_arena_copy(it->history, it->before, it->marked);
    const char *const of = tvi_is_rescaled(it) ? " in s, of K = g (H + e)," : "";
    return jet_refuse(status, "step of %g%s from t = %g: %s", h, of, it->now.q[it->system->n], jet_refusal());
}

/* Steps of generated code of which nothing is asked, all but the last one of a run. */
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
    const bool in_rows = tolerance == 0 && it->stats.is_compiled;
    const double *now = &it->now.q[it->system->n], way = copysign(1, h);
    for (long k = 0; status == TVI_OK && k < steps && (k == 0 || way * (t_end - *now) > 0); k++) {
        if (in_rows) k += make_row(it, steps - 1 - k, h, t_end);
        status = step(it, tolerance, h);
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
