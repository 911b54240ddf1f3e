/* step.c - Makes steps of an integrator (tvi_step). The stepper of the method computes the increments of the state, and
 * the guard (guard.h) refuses a step that is too large. The increments of an accepted step are added to the state by
 * compensated summation (method/stepper.h). */
#include "integrator/guard.h"
#include "integrator/integrator.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <math.h>
#include <string.h>

void tvi_integrator_reset(tvi_integrator *integrator)
{
    if (!integrator) return;
    *integrator->is_state_from_step = false;
    integrator->is_in_observer = false; /* which longjmp may have left */
    integrator->stats.largest_tail = integrator->stats.largest_defect = 0;
}

/* ---- The start of a step or a run -------------------------------------------------------------------------------- */

bool tvi_integrator_state_equals(const tvi_integrator *it, double t, const double q[], const double p[])
{
    const size_t n = (size_t)it->system->n, bytes = n * sizeof *q;
    return memcmp(&t, &it->state.q[n], sizeof t) == 0 && memcmp(q, it->state.q, bytes) == 0 &&
           memcmp(p, it->state.p, bytes) == 0;
}

void tvi_integrator_copy_state(const tvi_integrator *it, double *t, double q[], double p[])
{
    const size_t n = (size_t)it->system->n;
    memcpy(q, it->state.q, n * sizeof *q);
    memcpy(p, it->state.p, n * sizeof *p);
    *t = it->state.q[n];
}

tvi_status tvi_state_last(const tvi_integrator *it, double *t, double q[], double p[])
{
    if (!it || !t || !q || !p || !*it->is_state_from_step)
        return tvi_refuse_invalid_run_arguments((tvi_run_arguments){it, t, q, p, 1},
                                                "the integrator has made no step, or was reset");
    tvi_integrator_copy_state(it, t, q, p);
    return TVI_OK;
}

/* Computes the Hamiltonian K = g (H + e) of a rescaled system at the current state with the given e, in long double. */
static long double compute_rescaled_hamiltonian(tvi_integrator *it, double e)
{
    it->state.p[it->system->n] = e;
    return tvi_energy_compute_long_double(&it->guard.K_work, 0, it->state.q, it->state.p);
}

/* Sets e = -H(q, p, t) at the start of a run of a rescaled system, so that K = g (H + e) is 0 (docs/method.md,
 * system/rescaled.c). Near a pericentre the terms of H nearly cancel, and their roundoff would change the period of the
 * orbit. Therefore e is computed as the root of K in long double; K is a linear function of e. */
static tvi_status set_energy_offset_e(tvi_integrator *it)
{
    const int n = it->system->n;
    double H;
    const tvi_status status = tvi_energy_compute(&it->guard.energy_work, it->state.q[n], it->state.q, it->state.p, &H);
    if (status != TVI_OK) return tvi_refuse_failed_evaluation("energy", status);
    const double apart = H != 0 ? H : 1;
    const long double there = compute_rescaled_hamiltonian(it, apart - H), here = compute_rescaled_hamiltonian(it, -H);
    const long double correction = apart * (here / (here - there)), e = isfinite(correction) ? correction - H : -H;
    it->state.p[n] = (double)e;
    it->state.p_low[n] = (double)(e - (double)e);
    return TVI_OK;
}

/* Puts a state, which must be near the constraints, onto them: constraint_work.start.q and so on. */
static tvi_status put_onto_constraints(tvi_integrator *it, double t, const double q[], const double p[])
{
    tvi_constraint_work *work = &it->constraint_work;
    const size_t bytes = (size_t)it->system->n * sizeof *q;
    memcpy(work->start.q, q, bytes);
    memcpy(work->start.p, p, bytes);
    memset(work->start.q_low, 0, bytes);
    memset(work->start.p_low, 0, bytes);
    return tvi_constraint_project(work, t, work->start.q, work->start.q_low, work->start.p, work->start.p_low, true);
}

tvi_status tvi_integrator_begin_step(tvi_integrator *it, double t, const double q[], const double p[])
{
    const size_t n = (size_t)it->system->n;
    if (it->is_in_observer) return jet_refuse(TVI_EINVAL, "the integrator is in a run, whose observer may not step it");
    if (*it->is_state_from_step && tvi_integrator_state_equals(it, t, q, p)) return TVI_OK;
    if (!isfinite(t) || !tvi_all_finite((int)n, q) || !tvi_all_finite((int)n, p))
        return tvi_refuse_nonfinite_state((int)n, t, q, "p", p);
    /* The state of a lift is on its constraints (tangent.c). */
    const bool is_put = it->system->constraints && !it->system->constraints->is_lift;
    const tvi_constraint_work *onto = is_put ? &it->constraint_work : NULL;
    const tvi_status status = onto ? put_onto_constraints(it, t, q, p) : TVI_OK;
    if (status != TVI_OK) return status;
    tvi_arena_copy_history(it->history.now, NULL, it->history.bytes);
    memcpy(it->state.q, onto ? onto->start.q : q, n * sizeof *q);
    memcpy(it->state.p, onto ? onto->start.p : p, n * sizeof *p);
    if (onto) memcpy(it->state.q_low, onto->start.q_low, n * sizeof *q);
    if (onto) memcpy(it->state.p_low, onto->start.p_low, n * sizeof *p);
    it->state.q[n] = t;
    memcpy(it->run_start, it->state.q, (n + 1) * sizeof *q);
    memcpy(it->run_start + n + 1, it->state.p, n * sizeof *p);
    if (tvi_steps_K(it)) return set_energy_offset_e(it);
    if (tvi_is_rescaled(it)) it->state.p[n] = 0;
    return TVI_OK;
}

/* ---- The increments ---------------------------------------------------------------------------------------------- */

/* Computes the increments of a step of the size it->last_step.h. With a tolerance > 0 the stepper chooses the step
 * size, at most it->last_step.h, and it->last_step.h becomes that size. */
static tvi_status compute_increments(tvi_integrator *it, double tolerance)
{
    const tvi_stepper *stepper = it->stepper;
    const tvi_run_state *state = &it->state;
    const tvi_increments *increments = &it->last_step.increments;
    const int dimension = it->stepped->n;
    const size_t bytes = (size_t)dimension * sizeof *increments->dq_low;
    const tvi_step_origin origin = {state->q[dimension], state->q_low[dimension], state->q, state->q_low, state->p,
                                    state->p_low};
    memset(increments->dq_low, 0, bytes);
    memset(increments->dp_low, 0, bytes);
    const tvi_status status = tolerance > 0 ? stepper->step_within_tolerance(it->work, tolerance, &it->last_step.h,
                                                                             &origin, increments, &it->stats)
                                            : stepper->step(it->work, it->last_step.h, &origin, increments, &it->stats);
    it->last_step.increments.dq[dimension] =
        it->last_step.h; /* the independent variable of the steps, which add_increments adds */
    return status;
}

void tvi_integrator_compute_curve(tvi_integrator *it, double h)
{
    it->last_step.h = h;
    (void)compute_increments(it, 0);
}

/* ---- Checks of the new state ------------------------------------------------------------------------------------- */

bool tvi_integrator_compute_field(tvi_integrator *it, const double *q, const double *velocities_or_momenta)
{
    const tvi_system *system = it->stepped;
    const jet_tape *tape = system->field_values;
    double *block = it->guard.field_block;
    const int n = system->n;
    memcpy(block, q, (size_t)n * sizeof *block);
    for (int i = n; i < system->input_count; i++) block[i] = 0;
    if (system->form != TVI_SEPARABLE && velocities_or_momenta)
        memcpy(block + n, velocities_or_momenta, (size_t)n * sizeof *block);
    tvi_system_write_time(system, block, 1, &q[n]);
    bool is_finite = tape->interpreter_sweeps->values(tape, block, 1);
    for (int i = 0; i < tape->output_count; i++) is_finite = is_finite && isfinite(block[tape->output_slot[i]]);
    return is_finite;
}

/* Returns the status of a step whose result is not finite: TVI_ETOOLARGE if the field is finite at the start of the
 * step, so that the step is too large, and otherwise TVI_ENONFINITE. */
static tvi_status status_of_nonfinite_result(tvi_integrator *it)
{
    const double *p = it->stepped->form == TVI_LAGRANGIAN ? NULL : it->state.p;
    return tvi_integrator_compute_field(it, it->state.q, p) ? TVI_ETOOLARGE : TVI_ENONFINITE;
}

/* Completes the error text after the stepper has failed with this status, and returns the status of the step. */
static tvi_status explain_stepper_failure(tvi_integrator *it, tvi_status status)
{
    if (status == TVI_ENONFINITE && status_of_nonfinite_result(it) == TVI_ETOOLARGE)
        return jet_refuse(TVI_ETOOLARGE, "its passes overflow: the step is too large");
    /* The steppers on constraints say which constraint makes the matrix singular. */
    if (status == TVI_ESINGULAR && it->system->constraints)
        return jet_refuse(status, "its equations: %s", jet_last_refusal_text());
    return tvi_refuse_failed_evaluation("its equations", status);
}

/* Returns a number other than 0 if a sum x + (x_low + dx) is not finite. */
static double find_overflows(int count, const double *x, const double *x_low, const double *dx)
{
    double flag = 0;
    for (int i = 0; i < count; i++) {
        const double sum = x[i] + (x_low[i] + dx[i]);
        flag += sum - sum;
    }
    return flag;
}

/* Refuses a step whose new state is not finite, with an error text that names the component. */
static tvi_status check_new_state_is_finite(tvi_integrator *it)
{
    const tvi_run_state *state = &it->state;
    const tvi_increments *increments = &it->last_step.increments;
    const int n = it->stepped->n;
    if (find_overflows(n + 1, state->q, state->q_low, increments->dq) == 0 &&
        find_overflows(n, state->p, state->p_low, increments->dp) == 0)
        return TVI_OK;
    const tvi_status status = status_of_nonfinite_result(it);
    for (int i = 0; i <= n; i++)
        if (!isfinite(state->q[i] + (state->q_low[i] + increments->dq[i])))
            return jet_refuse(status, "q[%d] overflows", i);
    for (int i = 0; i < n; i++)
        if (!isfinite(state->p[i] + (state->p_low[i] + increments->dp[i])))
            return jet_refuse(status, "p[%d] overflows", i);
    return TVI_OK;
}

/* Refuses the step of a rescaled system if its time, which is one of the coordinates, does not move in the direction of
 * h. */
static tvi_status check_time_moves_with_h(const tvi_integrator *it)
{
    const double dt = it->last_step.increments.dq[it->system->n], t = it->state.q[it->system->n];
    if (fabs(dt) <= tvi_least_time_change(t))
        return jet_refuse(TVI_ENOCONV, "the time does not move, as before a collision");
    return (dt > 0) == (it->last_step.h > 0) ? TVI_OK : jet_refuse(TVI_ETOOLARGE, "the time goes the other way");
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

static void add_increments(tvi_integrator *it)
{
    const tvi_run_state *state = &it->state;
    const tvi_increments *increments = &it->last_step.increments;
    const int n = it->stepped->n;
    (void)tvi_add_all_compensated(n, state->q, state->q_low, increments->dq, increments->dq_low);
    (void)tvi_add_all_compensated(n, state->p, state->p_low, increments->dp, increments->dp_low);
    state->q[n] = tvi_add_compensated(state->q[n], &state->q_low[n], increments->dq[n], 0);
}

/* Makes a step of the size h; with a tolerance > 0 the step chooses its size, at most h. A step that fails leaves the
 * state and the history as they were. */
static tvi_status make_step(tvi_integrator *it, double tolerance, double h)
{
    const long expansions = it->stats.expansions, passes = it->stats.passes;
    it->last_step.has_curve = false;
    it->last_step.h = h;
    tvi_arena_copy_history(it->history.before, it->history.now, it->history.copied_bytes);
    tvi_status status = compute_increments(it, tolerance);
    if (status != TVI_OK) status = explain_stepper_failure(it, status);
    else status = check_new_state_is_finite(it);
    if (status == TVI_OK && tvi_is_rescaled(it)) status = check_time_moves_with_h(it);
    /* The guard reads stats.tail, too, which the stepper has set. */
    if (status == TVI_OK)
        status = tvi_refuse_too_large_step(it, it->stats.expansions != expansions, it->stats.passes - passes);
    it->last_step.covered_time = it->last_step.increments.dq[it->system->n]; /* h, or of a rescaled system dt */
    if (status != TVI_OK) {
        tvi_arena_copy_history(it->history.now, it->history.before, it->history.copied_bytes);
        return status;
    }
    add_increments(it);
    *it->is_state_from_step = true;
    it->stats.steps++;
    it->last_step.has_curve = true;
    return TVI_OK;
}

/* Makes up to most_steps steps in one call of the stepper, as long as the guard (guard.h) accepts each step by its tail
 * and its number of passes, without computing the energy. Returns the number of steps that were made. */
static long make_unchecked_steps(tvi_integrator *it, long most_steps, double h, double t_end)
{
    if (!it->stepper->run || most_steps < 1 || it->guard.reference_energy->is_H_known) return 0;
    const tvi_unchecked_step_limits limits = tvi_guard_unchecked_limits(it);
    if (!(it->stats.tail <= limits.max_tail)) return 0;
    const tvi_run_request run = {
        h, most_steps, limits, tvi_is_rescaled(it) ? it->system->n : -1, t_end, it->last_step.increments};
    it->last_step.increments.dq[it->stepped->n] = h;
    const long made = it->stepper->run(it->work, &run, &it->state, &it->stats);
    it->stats.steps += made;
    *it->is_state_from_step |= made > 0;
    return made;
}

/* Adds the size and the start of a failed step to the error text, and returns its status. */
static tvi_status add_step_to_error_text(const tvi_integrator *it, tvi_status status)
{
    const char *const of = tvi_steps_K(it) ? " in s, of K = g (H + e)," : tvi_is_rescaled(it) ? " in s" : "";
    return jet_refuse(status, "step of %g%s from t = %g: %s", it->last_step.h, of, it->state.q[it->system->n],
                      jet_last_refusal_text());
}

tvi_status tvi_make_steps(tvi_integrator *it, long most_steps, double tolerance, double h, double t_end, double *t,
                          double q[], double p[])
{
    const tvi_run_arguments given = {it, t, q, p, h};
    if (!it) return tvi_refuse_invalid_run_arguments(given, "");
    if (!it->is_in_observer) it->last_step.has_curve = false;
    if (!t || !q || !p || h == 0 || !isfinite(h)) return tvi_refuse_invalid_run_arguments(given, "");
    tvi_status status = tvi_integrator_begin_step(it, *t, q, p);
    if (status != TVI_OK) return status;
    const double *state = &it->state.q[it->system->n], way = copysign(1, h);
    for (long k = 0; status == TVI_OK && k < most_steps && (k == 0 || way * (t_end - *state) > 0); k++) {
        /* The last step is made alone, and so is the only step of tvi_step. */
        if (tolerance == 0) k += make_unchecked_steps(it, most_steps - 1 - k, h, t_end);
        status = make_step(it, tolerance, h);
        if (status != TVI_OK) status = add_step_to_error_text(it, status);
    }
    /* The start of a run stays what the user gave, though it was put onto constraints. */
    if (*it->is_state_from_step) tvi_integrator_copy_state(it, t, q, p);
    return status;
}

tvi_status tvi_step(tvi_integrator *it, double h, double *t, double q[], double p[])
{
    return tvi_make_steps(it, 1, 0, h, tvi_infinite_end_time(h), t, q, p);
}

void tvi_integrator_copy_before(const tvi_integrator *it, char *history)
{
    const size_t copied = it->history.copied_bytes;
    tvi_arena_copy_history(history, it->history.before, copied);
    tvi_arena_copy_history(history + copied, it->history.now + copied, it->history.bytes - copied);
}

void tvi_integrator_undo_step(tvi_integrator *it, double *t, double q[], double p[])
{
    tvi_arena_copy_history(it->history.now, it->history.before, it->history.copied_bytes);
    it->last_step.has_curve = false;
    it->stats.steps--;
    tvi_integrator_copy_state(it, t, q, p);
}
