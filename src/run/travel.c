/* travel.c - Writes the state of an integrator, or of a member of an ensemble, as text, and loads such a text
 * (tvi_state_to_text, tvi_state_from_text, tvi_ensemble_member_to_text, tvi_ensemble_member_from_text). The text
 * (state_text.h) contains the low-order parts of the state and the e of a rescaled system, but not the history of the
 * steps. */
#include "run/ensemble.h"
#include "integrator/saved.h"
#include "integrator/state_text.h"
#include "system/refuse.h"

#include <stdlib.h>
#include <string.h>

/* ---- States and texts -------------------------------------------------------------------------------------------- */

/* The text lists the numbers t, q[n], p[n], e in this order. Returns the index of number number_index of this list in
 * the integrator's array of q (for t and q) or of p (for p and e). */
static int index_in_state_arrays(int n, int number_index)
{
    return number_index == 0 ? n : number_index <= n ? number_index - 1 : number_index - n - 1;
}

/* Copies the user's state to state_text. If the integrator has just computed this state, its low-order parts are
 * copied, too. */
static void fill_state_text(tvi_state_text *state_text, const tvi_integrator *it, double t, const double q[],
                            const double p[])
{
    const int n = state_text->n;
    const tvi_run_state *state = &it->state;
    for (int i = 0; i < n; i++) {
        state_text->state_values[2 * (1 + i)] = q[i];
        state_text->state_values[2 * (1 + n + i)] = p[i];
    }
    state_text->state_values[0] = t;
    if (!*it->is_state_from_step || !tvi_integrator_state_equals(it, t, q, p)) return;
    state_text->has_energy_offset = tvi_is_rescaled(it);
    for (int k = 0; k <= 2 * n + state_text->has_energy_offset; k++) {
        const int at = index_in_state_arrays(n, k);
        state_text->state_values[2 * k] = k <= n ? state->q[at] : state->p[at];
        state_text->state_values[2 * k + 1] = k <= n ? state->q_low[at] : state->p_low[at];
    }
}

/* Writes the text to the buffer of *size characters, or only sets *size if the buffer is NULL, as tvi_state_save
 * does. */
static tvi_status write_state_text(const tvi_state_text *state_text, char *text, size_t *size)
{
    const size_t needed = tvi_state_text_write(state_text, NULL);
    if (!tvi_numbers_are_finite(state_text->state_values,
                                4 * ((size_t)state_text->n + 1) * sizeof *state_text->state_values))
        return jet_refuse(TVI_ENONFINITE, "the state is not finite");
    if (text && *size < needed) return jet_refuse(TVI_EINVAL, "the buffer has %zu bytes, the text %zu", *size, needed);
    *size = needed;
    if (text) (void)tvi_state_text_write(state_text, text);
    return TVI_OK;
}

static tvi_status read_state_text(tvi_state_text *state_text, const tvi_system *system, const char *text, size_t size)
{
    if (!tvi_state_text_open(state_text, system->n, tvi_system_parameters(system)))
        return jet_explain_out_of_memory(TVI_ENOMEM);
    const char *const fault = tvi_state_text_read(state_text, text, size);
    if (!fault) return TVI_OK;
    free(state_text->parameter_values);
    return jet_refuse(TVI_EINVAL, "%s", fault);
}

/* Sets the integrator's state to that of the text. The parameters of the text have been set before. A text without
 * low-order parts is loaded like a state given by the user: the next run tests anew whether the state lies on an
 * event. */
static tvi_status set_state_from_text(tvi_integrator *it, const tvi_state_text *state_text)
{
    const int n = state_text->n;
    const tvi_run_state *state = &it->state;
    for (int i = 0; i < n; i++) {
        it->end.q[i] = state_text->state_values[2 * (1 + i)];
        it->end.p[i] = state_text->state_values[2 * (1 + n + i)];
    }
    *it->is_state_from_step = false;
    const tvi_status status = tvi_integrator_begin_step(it, state_text->state_values[0], it->end.q, it->end.p);
    if (status != TVI_OK) return status;
    for (int k = 0; k <= 2 * n + (state_text->has_energy_offset && tvi_is_rescaled(it)); k++) {
        const int at = index_in_state_arrays(n, k);
        const double low = state_text->state_values[2 * k + 1];
        *(k <= n ? &state->q[at] : &state->p[at]) = state_text->state_values[2 * k];
        *(k <= n ? &state->q_low[at] : &state->p_low[at]) = low;
        if (k <= 2 * n && low != 0) *it->is_state_from_step = true;
    }
    return TVI_OK;
}

/* ---- Texts of an integrator -------------------------------------------------------------------------------------- */

tvi_status tvi_state_to_text(const tvi_integrator *it, double t, const double q[], const double p[], char *text,
                             size_t *size)
{
    if (!it || !q || !p || !size)
        return tvi_refuse_first_null_pointer(4, (const void *const[]){it, q, p, size},
                                             (const char *const[]){"integrator", "q", "p", "size"});
    tvi_state_text state_text;
    const int parameters = tvi_system_parameters(it->system);
    if (!tvi_state_text_open(&state_text, it->system->n, parameters)) return jet_explain_out_of_memory(TVI_ENOMEM);
    memcpy(state_text.parameter_values, it->parameters, (size_t)parameters * sizeof *state_text.parameter_values);
    fill_state_text(&state_text, it, t, q, p);
    const tvi_status status = write_state_text(&state_text, text, size);
    free(state_text.parameter_values);
    return status;
}

/* Sets the integrator's parameters and its state to those of the text. On failure the integrator is left as it was. */
static tvi_status set_integrator_from_text(tvi_integrator *it, const tvi_state_text *state_text)
{
    const size_t bytes = (size_t)state_text->parameter_count * sizeof *state_text->parameter_values;
    char *scratch = malloc(it->history_bytes + bytes + 1);
    if (!scratch) return jet_explain_out_of_memory(TVI_ENOMEM);
    double *const values = (double *)(scratch + it->history_bytes);
    tvi_arena_copy_history(scratch, it->history, it->history_bytes);
    memcpy(values, it->parameters, bytes);
    memcpy(it->parameters, state_text->parameter_values, bytes);
    tvi_integrator_apply_parameters(it);
    const tvi_status status = set_state_from_text(it, state_text);
    if (status == TVI_OK) {
        it->has_dense_output = false;
        tvi_event_stop_clear(it->stop, it->system->n);
    } else {
        tvi_arena_copy_history(it->history, scratch, it->history_bytes);
        memcpy(it->parameters, values, bytes);
        tvi_integrator_apply_parameters(it);
    }
    free(scratch);
    return status;
}

tvi_status tvi_state_from_text(tvi_integrator *it, const char *text, size_t size, double *t, double q[], double p[])
{
    if (!it || !text || !t || !q || !p)
        return tvi_refuse_first_null_pointer(5, (const void *const[]){it, text, t, q, p},
                                             (const char *const[]){"integrator", "text", "t", "q", "p"});
    if (it->is_in_observer)
        return jet_refuse(TVI_EINVAL, "the integrator is in a run, whose observer may not load a state");
    tvi_state_text state_text;
    tvi_status status = read_state_text(&state_text, it->system, text, size);
    if (status != TVI_OK) return status;
    status = set_integrator_from_text(it, &state_text);
    if (status == TVI_OK) tvi_integrator_copy_state(it, t, q, p);
    free(state_text.parameter_values);
    return status;
}

/* ---- Texts of a member of an ensemble ---------------------------------------------------------------------------- */

static tvi_status check_member_arguments(const tvi_ensemble *ensemble, int member, const void *const pointers[4],
                                         const char *last_pointer_name)
{
    const void *const all[] = {ensemble, pointers[0], pointers[1], pointers[2], pointers[3]};
    for (int i = 0; i < 5; i++)
        if (!all[i])
            return tvi_refuse_first_null_pointer(5, all,
                                                 (const char *const[]){"ensemble", "t", "q", "p", last_pointer_name});
    if (member < 0 || member >= ensemble->member_count)
        return jet_refuse(TVI_EINVAL, "member = %d is not from 0 to %d", member, ensemble->member_count - 1);
    return tvi_ensemble_refuse_if_running(ensemble);
}

tvi_status tvi_ensemble_member_to_text(const tvi_ensemble *ensemble, int member, const double t[], const double q[],
                                       const double p[], char *text, size_t *size)
{
    tvi_status status = check_member_arguments(ensemble, member, (const void *const[]){t, q, p, size}, "size");
    if (status != TVI_OK) return status;
    tvi_ensemble_worker *worker = ensemble->workers;
    tvi_worker_load_member(worker, (tvi_ensemble *)ensemble, member);
    tvi_gather_member(ensemble->n, ensemble->member_count, q, member, worker->member_q);
    tvi_gather_member(ensemble->n, ensemble->member_count, p, member, worker->member_p);
    status = tvi_state_to_text(worker->integrator, t[member], worker->member_q, worker->member_p, text, size);
    tvi_worker_store_member(worker, (tvi_ensemble *)ensemble, member);
    return status;
}

tvi_status tvi_ensemble_member_from_text(tvi_ensemble *ensemble, int member, const char *text, size_t size, double t[],
                                         double q[], double p[])
{
    tvi_status status = check_member_arguments(ensemble, member, (const void *const[]){t, q, p, text}, "text");
    if (status != TVI_OK) return status;
    tvi_ensemble_worker *worker = ensemble->workers;
    tvi_worker_load_member(worker, ensemble, member);
    status = tvi_state_from_text(worker->integrator, text, size, &t[member], worker->member_q, worker->member_p);
    if (status == TVI_OK) {
        tvi_scatter_member(ensemble->n, ensemble->member_count, worker->member_q, member, q);
        tvi_scatter_member(ensemble->n, ensemble->member_count, worker->member_p, member, p);
        ensemble->failure_status[member] = TVI_OK;
    }
    tvi_worker_store_member(worker, ensemble, member);
    return status;
}
