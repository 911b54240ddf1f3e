/* gradient.c - Goes back through a record (record.h), from the derivatives of a loss by what the runs told to those by
 * their start and by the parameters (docs/method.md section 13). backward.c makes the steps back. */
#include "run/backward.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* ---- What was told ----------------------------------------------------------------------------------------------- */

/* Computes the rates x' [2N] of the stepped system at q and p, where q[N] is the variable of the steps. */
static tvi_status compute_rates(tvi_record *record, const double q[], const double p[], double rates[])
{
    tvi_integrator *again = record->again;
    const tvi_system *stepped = again->stepped;
    const int N = stepped->n, *slot = stepped->field_values->output_slot;
    const bool is_lagrangian = stepped->form == TVI_LAGRANGIAN, is_separable = stepped->form == TVI_SEPARABLE;
    const double *block = again->guard.field_block;
    double *v = record->backward->velocity;
    const tvi_status status = is_lagrangian ? tvi_integrator_velocity(again, q[N], q, p, v) : TVI_OK;
    if (status != TVI_OK) return status;
    if (!tvi_integrator_compute_field(again, q, is_lagrangian ? v : p))
        return jet_refuse(TVI_EDOMAIN, "the field has no value where it was told");
    for (int i = 0; i < N; i++) {
        rates[i] = is_separable ? p[i] / stepped->mass[i] : is_lagrangian ? v[i] : block[slot[N + i]];
        rates[N + i] = is_separable || is_lagrangian ? block[slot[i]] : -block[slot[i]];
    }
    return TVI_OK;
}

/* Makes a full state [state_size] of the stepped system from a state [2n + 1] that was told. */
static tvi_status make_full_state(const tvi_record *record, const double state[], double variable, double full[])
{
    const tvi_integrator *again = record->again;
    const int n = again->system->n, N = again->stepped->n;
    memset(full, 0, record->state_size * sizeof *full);
    memcpy(full, state, (size_t)n * sizeof *full);
    memcpy(full + N + 1, state + n, (size_t)n * sizeof *full);
    full[N] = variable;
    if (N == n) return TVI_OK;
    full[n] = state[2 * n];
    if (!tvi_steps_K(again)) return TVI_OK;
    double H;
    const tvi_status status = tvi_integrator_energy(again, state[2 * n], state, state + n, &H);
    full[N + 1 + n] = -H;
    return status;
}

/* Copies derivatives by q and p, [2n], and by t to a covector. */
static void set_covector(const tvi_record *record, const double by_q_and_p[], double by_t, double covector[])
{
    const int n = record->again->system->n, N = record->again->stepped->n;
    for (int i = 0; i < n; i++) {
        covector[i] = by_q_and_p ? by_q_and_p[i] : 0;
        covector[N + i] = by_q_and_p ? by_q_and_p[n + i] : 0;
    }
    if (N == n) return;
    covector[n] = by_t;
    covector[N + n] = 0;
}

/* Computes g', the derivative along the orbit of a function of the state and the time, from its gradient,
 * to->covector.surface and by_time, at a full state; and x' there, to->rates. */
static tvi_status compute_slope(tvi_record *record, double by_time, const double x[], double *slope)
{
    tvi_backward *to = record->backward;
    const int N = to->N;
    const tvi_status status = compute_rates(record, x, x + N + 1, to->rates);
    *slope = N == record->again->system->n ? by_time : 0;
    for (int i = 0; i < 2 * N && status == TVI_OK; i++) *slope += to->covector.surface[i] * to->rates[i];
    return status;
}

/* Changes a covector at the full state x, and *by_t, for a state that is told where g(q, p, t, c) is 0: a neighbouring
 * orbit tells its state at another time, dt = -dg / g', so that a -= (a.x' + a_t) g_x / g', and likewise for t and the
 * parameters. `g` [2n + 1 + parameters] is the gradient of the function; NULL: it is the time minus a given one.
 * least_slope: a smaller |g'| is a point where g touches 0. by_integrals: the integrals end there; NULL: they do not.
 */
static tvi_status project(tvi_record *record, const double g[], double least_slope, const double by_integrals[],
                          const double x[], double covector[], double *by_t)
{
    tvi_backward *to = record->backward;
    const int n = record->again->system->n, N = to->N, time = 2 * n;
    const double by_time = g ? g[time] : 1;
    double slope, l = 0, change = N == n ? *by_t : 0;
    set_covector(record, g, by_time, to->covector.surface);
    tvi_status status = compute_slope(record, by_time, x, &slope);
    for (int k = 0; k < to->integrals && by_integrals && status == TVI_OK; k++) {
        status = tvi_integrand_at(record, k, x, &l);
        change += by_integrals[k] * l;
    }
    if (status != TVI_OK) return status;
    if (!(fabs(slope) > least_slope))
        return jet_refuse(TVI_ESINGULAR, "an event function touches 0: its time has no derivative");
    for (int i = 0; i < 2 * N; i++) change += covector[i] * to->rates[i];
    const double factor = change / slope;
    for (int i = 0; i < 2 * N; i++) covector[i] -= factor * to->covector.surface[i];
    if (N == n) *by_t -= factor * by_time;
    for (int i = 0; i < to->parameters && g; i++) to->by_parameters[i] -= factor * g[time + 1 + i];
    return TVI_OK;
}

/* Sets *least to the least |g'| of an event that passes through 0. Where g touches 0, it is found within its roundoff,
 * where the slope is about the square root of roundoff times its change over the step. */
static tvi_status find_least_slope(tvi_record *record, const double g[], const double start[], double *least)
{
    tvi_backward *to = record->backward;
    const double by_time = g[2 * record->again->system->n];
    double at_start = 0, at_end = 0;
    set_covector(record, g, by_time, to->covector.surface);
    tvi_status status = compute_slope(record, by_time, start, &at_start);
    if (status == TVI_OK) status = compute_slope(record, by_time, to->x_end, &at_end);
    *least = 64 * sqrt(DBL_EPSILON) * fmax(fabs(at_start), fabs(at_end));
    return status;
}

/* Sets to->covector.told to the loss's derivatives by what was told, with those of `exit` if the record goes on from
 * there, projected onto where it was told. The state there becomes `full`. Adds what belongs to the time to *by_t. */
static tvi_status load_told(tvi_record *record, const tvi_told *told, const tvi_loss *loss, const double exit[],
                            double exit_t, double full[], double *by_t)
{
    tvi_backward *to = record->backward;
    const int n = record->again->system->n, size = told->gradient ? 2 * n + 1 : 2 * n;
    const double *all = told->gradient ? loss->at_events : loss->at_times;
    const double *own = all ? all + (size_t)told->index * (size_t)size : NULL;
    double told_t = (own && told->gradient ? own[2 * n] : 0) + exit_t;
    set_covector(record, own, own && told->gradient ? own[2 * n] : 0, to->covector.told);
    bool any = told_t != 0 || (exit && loss->integrals);
    for (int i = 0; i < 2 * to->N; i++) {
        if (exit) to->covector.told[i] += exit[i];
        any |= to->covector.told[i] != 0;
    }
    if (!any) return TVI_OK;
    const double *start = NULL;
    const bool in_step = told->step < record->step_count;
    double variable = told->state[2 * n], least_slope = 0;
    tvi_status status = in_step ? tvi_record_state(record, told->step, &start) : TVI_OK;
    if (status == TVI_OK && to->N > n && in_step) variable = start[to->N] + told->offset;
    if (status == TVI_OK && told->gradient) status = find_least_slope(record, told->gradient, start, &least_slope);
    if (status == TVI_OK) status = make_full_state(record, told->state, variable, full);
    if (status == TVI_OK)
        status = project(record, told->gradient, least_slope, exit ? loss->integrals : NULL, full, to->covector.told,
                         &told_t);
    *by_t += told_t;
    return status;
}

/* ---- The way through the record ---------------------------------------------------------------------------------- */

/* How far the way back has come. */
typedef struct {
    tvi_record *record;
    const tvi_loss *loss;
    size_t told_count; /* what was told of the steps that are still to be gone through */
    double by_t;       /* the derivative by the time, if it is no coordinate */
    double *full;      /* [state_size] of what was told */
} way_back;

/* Adds a told covector, which stands in to->covector.told, to the multipliers: where it was told at the end of the
 * step, there; else at its start, after a step back of the part that leads there. */
static tvi_status go_back_from_told(way_back *way, const tvi_told *told, bool is_exit)
{
    tvi_record *record = way->record;
    tvi_backward *to = record->backward;
    if (told->offset == 0 || told->step == record->step_count) {
        tvi_backward_add(to, to->lift, to->covector.told);
        return TVI_OK;
    }
    if (to->integrals > 0) tvi_backward_set_parameters(record, to->part, is_exit ? way->loss->integrals : NULL);
    tvi_backward_clear(to->part);
    tvi_backward_set_x(to, to->part, way->full);
    tvi_backward_add(to, to->part, to->covector.told);
    const tvi_status status = tvi_backward_step(record, to->part, told->offset);
    if (to->integrals > 0) tvi_backward_set_parameters(record, to->lift, way->loss->integrals);
    if (status != TVI_OK) return status;
    tvi_backward_get(to, to->part, to->covector.told);
    tvi_backward_add(to, to->lift, to->covector.told);
    return TVI_OK;
}

/* Goes back through a step: from the multipliers at its end, and from what was told inside it, to those at its start.
 * `exit` is the covector of an event that ends the piece in this step; NULL: there is none. */
static tvi_status go_back_through_step(way_back *way, long step, const double exit[], double exit_t)
{
    tvi_record *record = way->record;
    tvi_backward *to = record->backward;
    const double h = tvi_record_size_of_step(record, step), *start;
    size_t last = way->told_count, first = last;
    tvi_status status = TVI_OK;
    while (first > 0 && record->told[first - 1].step == step) first--;
    for (size_t i = first; i < last && status == TVI_OK; i++) { /* at the end of the step */
        const tvi_told *told = &record->told[i];
        if (told->offset != h || exit) continue;
        status = load_told(record, told, way->loss, NULL, 0, way->full, &way->by_t);
        tvi_backward_add(to, to->lift, to->covector.told);
    }
    tvi_backward_set_x(to, to->lift, to->x_end);
    if (status == TVI_OK && !exit) status = tvi_backward_step(record, to->lift, h);
    for (size_t i = last; i > first && status == TVI_OK; i--) {
        const tvi_told *told = &record->told[i - 1];
        const bool is_exit = exit && told->is_exit;
        if (told->offset == h && !exit) continue;
        status = load_told(record, told, way->loss, is_exit ? exit : NULL, is_exit ? exit_t : 0, way->full, &way->by_t);
        if (status == TVI_OK) status = go_back_from_told(way, told, is_exit);
    }
    way->told_count = first;
    if (status == TVI_OK) status = tvi_record_state(record, step, &start);
    if (status == TVI_OK) memcpy(to->x_end, start, record->state_size * sizeof *start);
    return status;
}

/* At the start of a run in steps of K = g (H + e), e is -H there: a_z -= a_e H_z, where K_z = g H_z and K_e = g. */
static tvi_status leave_K(tvi_record *record, const double x[], double covector[])
{
    tvi_backward *to = record->backward;
    const jet_tape *tape = to->adjoint->energy_by_parameters;
    const int N = to->N, e = 2 * N - 1;
    const tvi_status status = compute_rates(record, x, x + N + 1, to->rates); /* (K_p, -K_q) */
    if (status != TVI_OK) return status;
    const double factor = covector[e] / to->rates[N - 1];
    for (int i = 0; i < N; i++) covector[i] += factor * to->rates[N + i];
    for (int i = 0; i < N - 1; i++) covector[N + i] -= factor * to->rates[i];
    covector[e] = 0;
    if (!tape) return TVI_OK;
    memcpy(to->energy_block, x, (size_t)N * sizeof *x);
    memcpy(to->energy_block + N, x + N + 1, (size_t)N * sizeof *x);
    if (!jet_sweep_values(tape, to->energy_block, 1)) return jet_refuse(TVI_EDOMAIN, "the energy has no derivatives");
    for (int i = 0; i < tape->output_count; i++)
        to->by_parameters[i] -= factor * to->energy_block[tape->output_slot[i]];
    return TVI_OK;
}

/* Goes back through a piece, from the covector to->covector.exit at its end to that at its start. */
static tvi_status go_back_through_piece(way_back *way, size_t index)
{
    tvi_record *record = way->record;
    tvi_backward *to = record->backward;
    const tvi_piece *piece = &record->pieces[index];
    const bool is_last = index + 1 == record->counts.pieces.count, at_event = piece->end == TVI_END_AT_EVENT;
    const long end = is_last ? record->step_count : record->pieces[index + 1].first_step;
    double exit_t = way->by_t;
    tvi_status status = TVI_OK;
    way->by_t = 0;
    memcpy(to->x_end, piece->end_state, record->state_size * sizeof *to->x_end);
    if (piece->end == TVI_END_AT_TIME)
        status = project(record, NULL, 0, way->loss->integrals, to->x_end, to->covector.exit, &exit_t);
    if (!at_event) way->by_t = exit_t;
    tvi_backward_clear(to->lift);
    if (!at_event) tvi_backward_add(to, to->lift, to->covector.exit);
    for (long step = end - 1; step >= piece->first_step && status == TVI_OK; step--)
        status = go_back_through_step(way, step, at_event && step == end - 1 ? to->covector.exit : NULL, exit_t);
    tvi_backward_get(to, to->lift, to->covector.exit);
    way->by_t += to->by_parameters[to->parameters];
    to->by_parameters[to->parameters] = 0;
    const bool leaves_K = status == TVI_OK && piece->starts_anew && tvi_steps_K(record->again);
    return leaves_K ? leave_K(record, to->x_end, to->covector.exit) : status;
}

/* Sets to->covector.exit and way->by_t to the derivatives by the end of the record, and by what was told there. */
static tvi_status begin_at_end(way_back *way)
{
    tvi_record *record = way->record;
    tvi_backward *to = record->backward;
    const int n = record->again->system->n;
    const double *end = way->loss->end;
    const double end_t = end ? end[2 * n] : 0;
    set_covector(record, end, end_t, to->covector.exit);
    way->by_t = to->N == n ? end_t : 0;
    way->told_count = record->counts.told.count;
    tvi_status status = TVI_OK;
    for (; way->told_count > 0 && record->told[way->told_count - 1].step == record->step_count; way->told_count--) {
        if (status == TVI_OK)
            status = load_told(record, &record->told[way->told_count - 1], way->loss, NULL, 0, way->full, &way->by_t);
        for (int i = 0; i < 2 * to->N; i++) to->covector.exit[i] += to->covector.told[i];
    }
    return status;
}

static tvi_status go_back(tvi_record *record, const tvi_loss *loss, double by_start[], double by_parameters[])
{
    tvi_backward *to = record->backward;
    const int n = record->again->system->n, N = to->N;
    way_back way = {.record = record, .loss = loss, .full = malloc(record->state_size * sizeof(double))};
    if (!way.full) return TVI_ENOMEM;
    tvi_backward_set_parameters(record, to->part, NULL);
    tvi_backward_set_parameters(record, to->lift, loss->integrals);
    memset(to->by_parameters, 0, ((size_t)to->parameters + 1) * sizeof *to->by_parameters);
    tvi_status status = begin_at_end(&way);
    for (size_t i = record->counts.pieces.count; i > 0 && status == TVI_OK; i--)
        status = go_back_through_piece(&way, i - 1);
    free(way.full);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n && by_start; i++) {
        by_start[i] = to->covector.exit[i];
        by_start[n + i] = to->covector.exit[N + i];
    }
    if (by_start) by_start[2 * n] = N > n ? to->covector.exit[n] : way.by_t;
    if (by_parameters && to->parameters > 0)
        memcpy(by_parameters, to->by_parameters, (size_t)to->parameters * sizeof *by_parameters);
    return TVI_OK;
}

static bool are_finite(int rows, int width, const double x[])
{
    for (int row = 0; x && row < rows; row++)
        if (!tvi_all_finite(width, x + (size_t)row * (size_t)width)) return false;
    return true;
}

tvi_status tvi_gradient(tvi_record *record, const tvi_loss *loss, double by_start[], double by_parameters[])
{
    if (!record || !loss)
        return tvi_refuse_first_null_pointer(2, (const void *const[]){record, loss},
                                             (const char *const[]){"record", "loss"});
    if (loss->size != 0 && loss->size != sizeof *loss)
        return jet_refuse(TVI_EINVAL, "size is not that of a tvi_loss of this version");
    const int width = 2 * record->again->system->n;
    if (!are_finite(1, width + 1, loss->end) || !are_finite(record->time_count, width, loss->at_times) ||
        !are_finite(record->event_count, width + 1, loss->at_events) ||
        !are_finite(1, record->integrals.count, loss->integrals))
        return jet_refuse(TVI_ENONFINITE, "the derivatives of the loss are not finite");
    tvi_status status = record->backward ? TVI_OK : tvi_backward_create(record);
    if (status == TVI_OK) status = go_back(record, loss, by_start, by_parameters);
    return jet_explain_out_of_memory(status);
}
