/* step.c - Makes steps of one member or of a batch of members (tvi_step). The stepper of the method computes the
 * increments of the states, and the guard (guard.h) refuses the steps that are too large. The increments of the
 * accepted steps are added to the states by compensated summation (advance.h). */
#include "run/advance.h"
#include "run/guard.h"
#include "run/integrator.h"
#include "method/single.h"
#include "system/refuse.h"
#include "vector.h"

#include <math.h>
#include <string.h>

static const tvi_increment_kernels_of_instruction_set *const loops_of[JET_ISA_COUNT] = {
    [jet_isa_base] = &tvi_increment_kernels_of_instruction_set_base,
#ifdef JET_ISA_X86
    [jet_isa_avx2] = &tvi_increment_kernels_of_instruction_set_avx2,
    [jet_isa_avx512] = &tvi_increment_kernels_of_instruction_set_avx512,
#endif
};

void tvi_integrator_reset(tvi_integrator *integrator)
{
    if (!integrator) return;
    for (int member = 0; member < integrator->width; member++) integrator->is_state_from_step[member] = false;
    integrator->stats.largest_tail = 0;
}

/* The functions below that loop over the members have the number of members as the argument `width`. The compiler makes
 * one version of each function for width = 1, and one for any width. */

/* ---- The increments ---------------------------------------------------------------------------------------------- */

/* Computes the increments of one member by the stepper's function for a single member. With a tolerance > 0 that
 * function chooses the step size, at most it->h, and it->h becomes that size. */
static void compute_increments_of_one_member(tvi_integrator *it, double tolerance)
{
    const tvi_stepper *stepper = it->stepper;
    const tvi_run_state *state = &it->state;
    const tvi_increments *increments = &it->increments;
    const int dimension = it->stepped->n;
    const long passes = it->stats.passes;
    const size_t bytes = (size_t)dimension * sizeof *increments->dq_low;
    const tvi_step_origin origin = {state->q[dimension], state->q_low[dimension], state->q, state->q_low, state->p,
                                    state->p_low};
    memset(increments->dq_low, 0, bytes);
    memset(increments->dp_low, 0, bytes);
    it->status[0] = tolerance > 0
                        ? stepper->step_within_tolerance(it->work, tolerance, &it->h, &origin, increments, &it->stats)
                        : stepper->step(it->work, it->h, &origin, increments, &it->stats);
    it->tail[0] = it->stats.tail;
    it->pass_counts[0] = (int)(it->stats.passes - passes);
}

/* Computes the increments of all members that are being stepped. The stepper sets the status of each member. */
JET_INLINE void compute_increments(tvi_integrator *it, int width, double tolerance)
{
    const tvi_run_state *state = &it->state;
    const int time = it->stepped->n * width;
    if (width > 1) {
        const tvi_batch_origin origin = {state->q + time, state->q_low + time, state->q, state->q_low,
                                         state->p,        state->p_low};
        const tvi_batch_results end = {it->increments, it->status, it->tail, it->pass_counts};
        it->stepper->batch->step(it->work, it->h, &origin, &end, &it->stats);
    } else {
        compute_increments_of_one_member(it, tolerance);
    }
    for (int member = 0; member < width; member++) it->increments.dq[time + member] = it->h;
}

void tvi_integrator_compute_curve(tvi_integrator *it, double h)
{
    it->h = h;
    compute_increments(it, 1, 0);
}

/* ---- Checks of new states ---------------------------------------------------------------------------------------- */

/* Tells whether the forces, or the derivatives of the Lagrangian or Hamiltonian, are finite at the start of the
 * member's step. A Lagrangian is evaluated at velocity 0. */
static bool is_field_finite_at_start(tvi_integrator *it, int member)
{
    const tvi_system *system = it->stepped;
    const jet_tape *tape = system->field_values;
    const int n = system->n;
    const double t = it->state.q[n * it->width + member];
    tvi_member_copy_parameters_to_one_lane_blocks(it, member);
    tvi_gather_member(n, it->width, it->state.q, member, it->field_block);
    for (int i = n; i < system->input_count; i++) it->field_block[i] = 0;
    if (system->form == TVI_HAMILTONIAN) tvi_gather_member(n, it->width, it->state.p, member, it->field_block + n);
    tvi_system_write_time(system, it->field_block, 1, &t);
    bool is_finite = tape->interpreter_sweeps->values(tape, it->field_block, 1);
    for (int i = 0; i < tape->output_count; i++)
        is_finite = is_finite && isfinite(it->field_block[tape->output_slot[i]]);
    return is_finite;
}

/* Returns the status of a step whose result is not finite: TVI_ETOOLARGE if the field is finite at the start of the
 * step, so that the step is too large, and otherwise TVI_ENONFINITE. */
static tvi_status status_of_nonfinite_result(tvi_integrator *it, int member)
{
    return is_field_finite_at_start(it, member) ? TVI_ETOOLARGE : TVI_ENONFINITE;
}

/* Completes the error text after the stepper has failed to make the member's step, and returns the status. */
static tvi_status explain_stepper_failure(tvi_integrator *it, int member)
{
    const tvi_status status = it->status[member];
    if (status == TVI_ENONFINITE && status_of_nonfinite_result(it, member) == TVI_ETOOLARGE)
        return jet_refuse(TVI_ETOOLARGE, "its passes overflow: the step is too large");
    return tvi_refuse_failed_evaluation("its equations", status);
}

/* Returns the status of a member whose new state is not finite, with an error text that names the component. */
static tvi_status refuse_overflowing_component(tvi_integrator *it, int member)
{
    const int width = it->width, rows = it->stepped->n;
    const tvi_status status = status_of_nonfinite_result(it, member);
    for (int i = 0, at = member; i <= rows; i++, at += width)
        if (!isfinite(it->state.q[at] + (it->state.q_low[at] + it->increments.dq[at])))
            return jet_refuse(status, "q[%d] overflows", i);
    for (int i = 0, at = member; i < rows; i++, at += width)
        if (!isfinite(it->state.p[at] + (it->state.p_low[at] + it->increments.dp[at])))
            return jet_refuse(status, "p[%d] overflows", i);
    return TVI_OK;
}

/* Refuses the step of a rescaled system if its time, which is one of the coordinates, does not move in the direction of
 * h. */
static tvi_status check_time_moves_with_h(const tvi_integrator *it, int member)
{
    const int time = it->system->n * it->width + member;
    const double dt = it->increments.dq[time], t = it->state.q[time];
    if (fabs(dt) <= tvi_least_time_change(t))
        return jet_refuse(TVI_ENOCONV, "the time does not move, as before a collision");
    return (dt > 0) == (it->h > 0) ? TVI_OK : jet_refuse(TVI_ETOOLARGE, "the time goes the other way");
}

JET_INLINE void find_overflows(tvi_integrator *it, int width)
{
    const tvi_run_state *state = &it->state;
    const tvi_increments *increments = &it->increments;
    const int rows = it->stepped->n;
    for (int member = 0; member < width; member++) it->overflow_flags[member] = 0;
    if (width == 1) {
        tvi_find_overflows(rows + 1, 1, state->q, state->q_low, increments->dq, it->overflow_flags);
        tvi_find_overflows(rows, 1, state->p, state->p_low, increments->dp, it->overflow_flags);
    } else {
        const tvi_increment_kernels_of_instruction_set *loops = loops_of[it->stepped->field_values->sweeps->isa];
        loops->find_overflows(rows + 1, width, state->q, state->q_low, increments->dq, it->overflow_flags);
        loops->find_overflows(rows, width, state->p, state->p_low, increments->dp, it->overflow_flags);
    }
}

/* Checks the new state of each member, and sets the status of those members whose step is refused. */
JET_INLINE void check_new_states(tvi_integrator *it, int width, bool step_used_series)
{
    find_overflows(it, width);
    for (int member = 0; member < width; member++) {
        if (!it->is_stepped[member]) continue;
        tvi_status *status = &it->status[member];
        if (*status != TVI_OK) *status = explain_stepper_failure(it, member);
        else if (it->overflow_flags[member] != 0) *status = refuse_overflowing_component(it, member);
        else if (tvi_is_rescaled(it)) *status = check_time_moves_with_h(it, member);
    }
    tvi_refuse_too_large_steps(it, step_used_series);
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

/* Adds the increments to the states of all members whose step is accepted. */
JET_INLINE void add_increments(tvi_integrator *it, int width)
{
    const tvi_run_state *state = &it->state;
    const tvi_increments *increments = &it->increments;
    const int rows = it->stepped->n;
    if (width == 1 && it->status[0] == TVI_OK) {
        tvi_add_increments(rows + 1, 1, state->q, state->q_low, increments->dq, increments->dq_low, it->status);
        tvi_add_increments(rows, 1, state->p, state->p_low, increments->dp, increments->dp_low, it->status);
    } else if (width > 1) {
        const tvi_increment_kernels_of_instruction_set *loops = loops_of[it->stepped->field_values->sweeps->isa];
        loops->add_increments(rows + 1, width, state->q, state->q_low, increments->dq, increments->dq_low, it->status);
        loops->add_increments(rows, width, state->p, state->p_low, increments->dp, increments->dp_low, it->status);
    }
}

/* Makes a step of all members whose status is TVI_OK. With a tolerance > 0 the step chooses its size, at most h. A
 * member that fails keeps its state, and its status tells why. Returns the number of members that have made the
 * step. */
JET_INLINE int step_members(tvi_integrator *it, int width, double tolerance, double h)
{
    const long expansions = it->stats.expansions;
    int made = 0;
    it->has_dense_output = false;
    it->h = h;
    for (int member = 0; member < width; member++) it->is_stepped[member] = it->status[member] == TVI_OK;
    tvi_arena_copy_or_clear_with_sanitizer_gaps(it->history_before, it->history, it->copied_history_bytes);
    compute_increments(it, width, tolerance);
    check_new_states(it, width, it->stats.expansions != expansions);
    add_increments(it, width);
    for (int member = 0; member < width; member++) {
        if (it->status[member] != TVI_OK) continue;
        it->is_state_from_step[member] = true;
        made++;
    }
    if (made == 0)
        tvi_arena_copy_or_clear_with_sanitizer_gaps(it->history, it->history_before, it->copied_history_bytes);
    it->stats.steps += made;
    it->has_dense_output = made > 0;
    it->covered_time = it->increments.dq[it->system->n * width];
    return made;
}

static int step_all_members(tvi_integrator *it, double tolerance, double h)
{
    return it->width == 1 ? step_members(it, 1, tolerance, h) : step_members(it, it->width, tolerance, h);
}

void tvi_make_steps_of_batch(tvi_integrator *it, long most_steps, double h)
{
    for (long k = 0, made = 1; k < most_steps && made > 0; k++) made = step_all_members(it, 0, h);
}

/* Makes up to most_steps steps in one call of the stepper, as long as the guard (guard.h) accepts each step by its tail
 * and its number of passes, without computing the energy. Returns the number of steps that were made. */
static long make_steps_without_energy_check(tvi_integrator *it, long most_steps, double h, double t_end)
{
    if (!it->stepper->run || most_steps < 1 || it->reference_energy->is_H_known) return 0;
    const tvi_limits_for_skipping_energy_check limits = tvi_max_tail_and_passes_without_energy_check(it);
    if (!(it->stats.tail <= limits.max_tail)) return 0;
    const tvi_run_request run = {h,     most_steps,    limits, tvi_is_rescaled(it) ? it->system->n : -1,
                                 t_end, it->increments};
    it->increments.dq[it->stepped->n] = h;
    const long made = it->stepper->run(it->work, &run, &it->state, &it->stats);
    it->stats.steps += made;
    *it->is_state_from_step |= made > 0;
    return made;
}

/* Adds the size and the start of a failed step to the error text, and returns its status. */
static tvi_status add_step_to_error_text(const tvi_integrator *it)
{
    const char *const of = tvi_is_rescaled(it) ? " in s, of K = g (H + e)," : "";
    return jet_refuse(it->status[0], "step of %g%s from t = %g: %s", it->h, of, it->state.q[it->system->n],
                      jet_last_refusal_text());
}

tvi_status tvi_make_steps(tvi_integrator *it, long most_steps, double tolerance, double h, double t_end, double *t,
                          double q[], double p[])
{
    const tvi_run_arguments given = {it, t, q, p, h};
    if (!it) return tvi_refuse_invalid_run_arguments(given, "");
    if (!it->is_in_observer) it->has_dense_output = false;
    if (!t || !q || !p || h == 0 || !isfinite(h)) return tvi_refuse_invalid_run_arguments(given, "");
    tvi_status status = tvi_integrator_begin_step(it, *t, q, p);
    if (status != TVI_OK) return status;
    const bool in_rows = tolerance == 0;
    const double *state = &it->state.q[it->system->n], way = copysign(1, h);
    for (long k = 0; status == TVI_OK && k < most_steps && (k == 0 || way * (t_end - *state) > 0); k++) {
        if (in_rows) k += make_steps_without_energy_check(it, most_steps - 1 - k, h, t_end);
        it->status[0] = TVI_OK;
        if (step_all_members(it, tolerance, h) == 0) status = add_step_to_error_text(it);
    }
    tvi_integrator_copy_state(it, t, q, p);
    return status;
}

tvi_status tvi_step(tvi_integrator *it, double h, double *t, double q[], double p[])
{
    return tvi_make_steps(it, 1, 0, h, tvi_infinite_end_time(h), t, q, p);
}

void tvi_integrator_undo_step(tvi_integrator *it, double *t, double q[], double p[])
{
    tvi_arena_copy_or_clear_with_sanitizer_gaps(it->history, it->history_before, it->copied_history_bytes);
    it->has_dense_output = false;
    it->stats.steps--;
    tvi_integrator_copy_state(it, t, q, p);
}
