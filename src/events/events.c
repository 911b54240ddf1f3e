/* events.c - Opens the search for the events of a run, finds the events of each step in the order of time, and ends the
 * run at one of them (events.h). */
#include "events/events.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Constants found by trials ----------------------------------------------------------------------------------- */

/* [1] Two stops are one if their times differ by less. */
#define EVENT_SAME_STOP (32 * DBL_EPSILON) /* found: make check-events */
/* [h] A root this near to a stop may be that stop, by the roundoff of g. */
#define EVENT_NEAR_STOP 1e-6 /* found: make check-events */
/* [h] Two roots of an event this near, in one direction, are one root. */
#define EVENT_SAME_ROOT 1e-12 /* found: make check-events */

/* The most roots of one event in a step. Each sample and each dip between samples has two at most. */
enum { MOST_ROOTS = 4 * TVI_SAMPLES + 4 };

/* ---- Opening and closing ----------------------------------------------------------------------------------------- */

/* Tells which kind of state the run begins with, before the first step changes the integrator. */
static tvi_start_state_source find_start_state_source(const tvi_integrator *it, double t, const double q[],
                                                      const double p[])
{
    const size_t n = (size_t)it->system->n;
    const double *stop = it->stop->state;
    if (*it->is_state_from_step && tvi_integrator_state_equals(it, t, q, p)) return TVI_FROM_LAST_STEP;
    if (!it->stop->is_set || memcmp(q, stop, n * sizeof *q) != 0) return TVI_FROM_ANY;
    return memcmp(&t, &stop[2 * n], sizeof t) == 0 ? TVI_FROM_STOP : TVI_FROM_ANY;
}

/* Copies the integrator's parameters to the tapes of all events. */
static void set_parameters_of_tapes(tvi_event_search *search)
{
    const int count = tvi_system_parameters(search->integrator->system);
    const double *value = search->integrator->parameters;
    for (int event_index = 0; event_index < search->event_count; event_index++) {
        const tvi_watched_event *w = &search->watched_events[event_index];
        jet_tape_set_parameters(w->event->tape, w->tape_block, 1, count, 1, value);
        jet_tape_set_parameters(w->event->series, w->local_series.series_block, 1, count, 1, value);
    }
    jet_tape_set_parameters(search->joint_tape, search->joint_tape_block, TVI_SAMPLES, count, 1, value);
}

/* Opens the tapes of the events, each alone and all together. */
static tvi_status open_tapes(tvi_event_search *search, const tvi_event *const events[])
{
    bool used[2 * TVI_MAX_DIMENSION + 1];
    const int n = search->integrator->system->n;
    for (int event_index = 0; event_index < search->event_count; event_index++) {
        tvi_watched_event *w = &search->watched_events[event_index];
        *w = (tvi_watched_event){.search = search,
                                 .index = event_index,
                                 .event = events[event_index],
                                 .tape_block = jet_tape_create_block(events[event_index]->tape, 1)};
        if (!w->tape_block || tvi_event_expansion_open(&w->local_series, w->event) != TVI_OK) return TVI_ENOMEM;
    }
    const tvi_status status = tvi_event_create_joint_tape(&search->joint_tape, events, search->event_count, used);
    if (status != TVI_OK) return status;
    for (int i = 0; i < 2 * n; i++) { /* ranges from the first component that is used to the last one */
        tvi_component_range *range = &search->used_components[i / n];
        if (used[i] && range->end == 0) range->first = i % n;
        if (used[i]) range->end = i % n + 1;
    }
    search->joint_tape_block = jet_tape_create_block(search->joint_tape, TVI_SAMPLES);
    return search->joint_tape_block ? TVI_OK : TVI_ENOMEM;
}

static tvi_status initialize_search(tvi_event_search *search, const tvi_event *const events[])
{
    const size_t size = (size_t)search->state_size, count = (size_t)search->event_count;
    tvi_status status = tvi_partial_step_open(&search->partial_step, search->integrator, true);
    if (status != TVI_OK) return status;
    search->watched_events = calloc(count, sizeof *search->watched_events);
    search->roots = calloc(count * MOST_ROOTS, sizeof *search->roots);
    search->scratch_state = calloc(4 * size, sizeof *search->scratch_state);
    if (!search->watched_events || !search->roots || !search->scratch_state) return TVI_ENOMEM;
    search->scratch_sizes = search->scratch_state + size;
    search->line.before.x = search->scratch_sizes + size;
    search->line.last.x = search->line.before.x + size;
    status = open_tapes(search, events);
    if (status == TVI_OK) set_parameters_of_tapes(search);
    return status;
}

tvi_status tvi_events_open(tvi_event_search **out, tvi_integrator *it, const tvi_event *const events[], int count,
                           double t, const double *const start_state[2])
{
    tvi_event_search *search = malloc(sizeof *search);
    *out = NULL;
    if (!search) return jet_explain_out_of_memory(TVI_ENOMEM);
    *search = (tvi_event_search){.integrator = it,
                                 .state_size = 2 * it->system->n + 1,
                                 .event_count = count,
                                 .start_state_source = find_start_state_source(it, t, start_state[0], start_state[1])};
    const tvi_status status = initialize_search(search, events);
    if (status == TVI_OK) *out = search;
    else tvi_events_close(search);
    return jet_explain_out_of_memory(status);
}

void tvi_events_close(tvi_event_search *search)
{
    if (!search) return;
    for (int event_index = 0; search->watched_events && event_index < search->event_count; event_index++) {
        free(search->watched_events[event_index].tape_block);
        tvi_event_expansion_close(&search->watched_events[event_index].local_series);
    }
    free(search->watched_events);
    free(search->joint_tape_block);
    jet_tape_free(search->joint_tape);
    free(search->roots);
    free(search->scratch_state);
    free(search->root_states);
    tvi_partial_step_close(&search->partial_step);
    free(search);
}

/* ---- The events of a step ---------------------------------------------------------------------------------------- */

/* Tells whether root a comes before root b. Roots that are near each other are compared by their computed times, and at
 * equal times by the index of the event. Other roots are compared by theta. */
static bool is_root_before(const tvi_event_search *search, const tvi_event_root *a, const tvi_event_root *b)
{
    const int t = search->state_size - 1;
    if (fabs(a->theta - b->theta) > EVENT_NEAR_STOP) return a->theta < b->theta;
    const double way = (a->state[t] - b->state[t]) * search->integrator->last_step.covered_time;
    return way < 0 || (way == 0 && a->watched->index < b->watched->index);
}

/* Tells whether the root is one of the first root_count roots, since the search may find one root from two brackets. */
static bool is_duplicate_root(const tvi_event_search *search, int root_count, const tvi_event_root *root)
{
    for (int i = 0; i < root_count; i++) {
        const tvi_event_root *earlier = &search->roots[i];
        if (earlier->watched == root->watched && earlier->g_sign_after == root->g_sign_after &&
            fabs(earlier->theta - root->theta) <= EVENT_SAME_ROOT)
            return true;
    }
    return false;
}

/* Moves a root to its place among the first root_count roots, which are in the order of time. */
static void insert_root_by_time(tvi_event_search *search, int root_count, tvi_event_root root)
{
    int i = root_count;
    for (; i > 0 && is_root_before(search, &root, &search->roots[i - 1]); i--) search->roots[i] = search->roots[i - 1];
    search->roots[i] = root;
}

/* Searches the last step, finishes each root, and sorts them by time. The parameters of the step are copied first, if
 * an observer has set new ones before it. Roots that only the curve has, and that the more accurate partial steps lack,
 * are dropped. */
tvi_status tvi_events_find(tvi_event_search *search)
{
    int found = 0;
    tvi_status status = TVI_OK;
    search->line.before.theta = search->line.last.theta = NAN;
    if (search->partial_step.copied_parameter_version != search->integrator->parameter_version) {
        set_parameters_of_tapes(search);
        status = tvi_partial_step_set_parameters(&search->partial_step);
    }
    if (status == TVI_OK) status = tvi_search_last_step(search);
    if (status == TVI_OK && search->root_count > search->root_capacity) {
        free(search->root_states);
        search->root_states = calloc((size_t)search->root_count, (size_t)search->state_size * sizeof(double));
        search->root_capacity = search->root_states ? search->root_count : 0;
        if (!search->root_states) status = jet_explain_out_of_memory(TVI_ENOMEM);
    }
    for (int i = 0; status == TVI_OK && i < search->root_count; i++) {
        tvi_event_root root = search->roots[i];
        root.state = search->root_states + (size_t)i * (size_t)search->state_size;
        status = tvi_finish_root(search, &root);
        if (!isnan(root.theta) && !is_duplicate_root(search, found, &root)) insert_root_by_time(search, found++, root);
    }
    search->root_count = found;
    return status;
}

/* ---- The end of a run -------------------------------------------------------------------------------------------- */

bool tvi_stop_has_event(const tvi_event_stop *stop, const tvi_event *event)
{
    for (int64_t i = 0; i < stop->event_count; i++)
        if (stop->event_hashes[i] == event->hash) return true;
    return false;
}

tvi_status tvi_watched_is_zero(tvi_watched_event *w, double g, const double state[], bool *is_zero)
{
    const tvi_event_search *search = w->search;
    double roundoff;
    for (int i = 0; i < search->state_size; i++) search->scratch_sizes[i] = fabs(state[i]);
    const tvi_status status =
        tvi_event_estimate_roundoff(w->event, &w->local_series, state, search->scratch_sizes, &roundoff);
    *is_zero = status == TVI_OK && fabs(g) <= roundoff;
    return status;
}

/* Sets *is_at_stop: true if the root lies at the root `stop`, where the run stops. This is so if the times are equal
 * up to the roundoff of both, or if the two theta differ by less than EVENT_NEAR_STOP and the sign of g at the stop
 * contradicts their order. */
static tvi_status check_root_at_stop(const tvi_event_root *root, const tvi_event_root *stop, bool *is_at_stop)
{
    const int time = root->watched->search->state_size - 1;
    const double t = stop->state[time], own = root->state[time];
    double g = 0;
    *is_at_stop = fabs(own - t) <= 2 * DBL_EPSILON * fmax(fabs(own), fabs(t));
    if (*is_at_stop || fabs(root->theta - stop->theta) > EVENT_NEAR_STOP) return TVI_OK;
    const tvi_status status = tvi_watched_evaluate(root->watched, stop->state, &g);
    *is_at_stop = tvi_has_sign_after_root(root, g) == (root->theta > stop->theta);
    return status;
}

/* Sets *is_at_stop: true if the event crosses 0 at the stop in the direction that the user has not asked for. The
 * search has skipped such crossings, so this function only tests whether |g| is at most its roundoff there. The
 * result is false if the stop is at the end of the step up to roundoff. It is false also if later_root, the event's
 * next root, lies within one sample interval after the stop: g is small then because of that root. */
static tvi_status check_skipped_root_at_stop(tvi_watched_event *w, const tvi_event_root *later_root,
                                             const tvi_event_root *stop, bool *is_at_stop)
{
    const tvi_event_search *search = w->search;
    const double t = stop->state[search->state_size - 1];
    const double resolved = EVENT_SAME_STOP * fabs(t / search->integrator->last_step.covered_time);
    double g = 0;
    if (!tvi_event_skips_a_direction(w->event) || !(stop->theta < 1 - fmax(EVENT_NEAR_STOP, resolved)) ||
        (later_root && later_root->theta - stop->theta <= tvi_sample_theta[0]))
        return TVI_OK;
    const tvi_status status = tvi_watched_evaluate(w, stop->state, &g);
    return status == TVI_OK ? tvi_watched_is_zero(w, g, stop->state, is_at_stop) : status;
}

/* Sets *is_at_stop: true if the event lies at the stop. The event may have the root at which the run stops, or its last
 * root before or its first root after also lies there. This later root is still unreported. */
static tvi_status check_event_at_stop(tvi_watched_event *w, const tvi_event_root *stop, bool *is_at_stop)
{
    const tvi_event_search *search = w->search;
    const tvi_event_root *earlier = NULL, *later = NULL, *end = search->roots + search->root_count;
    tvi_status status = TVI_OK;
    for (const tvi_event_root *root = search->roots; root < end && !later; root++)
        if (root->watched == w && root != stop) *(root < stop ? &earlier : &later) = root;
    w->is_unreported_at_stop = false;
    *is_at_stop = stop->watched == w;
    if (later) status = check_root_at_stop(later, stop, &w->is_unreported_at_stop);
    if (status == TVI_OK && earlier && !*is_at_stop) status = check_root_at_stop(earlier, stop, is_at_stop);
    *is_at_stop = *is_at_stop || w->is_unreported_at_stop;
    return status != TVI_OK || *is_at_stop ? status : check_skipped_root_at_stop(w, later, stop, is_at_stop);
}

/* The tvi_event_stop keeps the events of the previous stop if the times of both stops differ by less than
 * EVENT_SAME_STOP. */
tvi_status tvi_events_stop_run(tvi_event_search *search, const tvi_event_root *root)
{
    const tvi_integrator *it = search->integrator;
    tvi_event_stop *stop = it->stop;
    const double t = root->state[search->state_size - 1], before = stop->state[search->state_size - 1];
    const bool is_soon = stop->is_set && fabs(t - before) <= EVENT_SAME_STOP * fmax(fabs(t), fabs(before));
    if (!is_soon) tvi_event_stop_clear(stop, it->system->n);
    for (int event_index = 0; event_index < search->event_count; event_index++) {
        tvi_watched_event *w = &search->watched_events[event_index];
        bool is_at_stop;
        const tvi_status status = check_event_at_stop(w, root, &is_at_stop);
        if (status != TVI_OK) return status;
        if (is_at_stop && stop->event_count < TVI_STOP_EVENTS && !tvi_stop_has_event(stop, w->event))
            stop->event_hashes[stop->event_count++] = w->event->hash;
    }
    memcpy(stop->state, root->state, (size_t)search->state_size * sizeof *stop->state);
    /* The stop is not valid if an observer has just set parameters, since the events' functions change with them. */
    stop->is_set = it->parameter_version == search->partial_step.copied_parameter_version;
    return TVI_OK;
}
