/* locate.c - Locates the events in each step of a run, reports them in the order of time, and ends the run at an event
 * that is terminal or whose observer asks for it (locate.h). */
#include "run/locate.h"
#include "events/finder.h"
#include "run/run.h"
#include "run/times.h"
#include "system/refuse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Constants found by trials ----------------------------------------------------------------------------------- */

/* [1] Times are the same if they differ by at most this part. */
#define EVENT_SAME_TIME (2 * DBL_EPSILON) /* found: make check-events */
/* [1] Two stops are one if their times differ by less. */
#define EVENT_SAME_STOP (32 * DBL_EPSILON) /* found: make check-events */
/* [h] A root this near to a stop may be that stop, by the roundoff of g. */
#define EVENT_NEAR_STOP 1e-6 /* found: make check-events */
/* [h] Two roots of an event this near, in one direction, are one root. */
#define EVENT_SAME_ROOT 1e-12 /* found: make check-events */

/* The memory of a run with events. States are vectors [2n + 1], in the order q, p, t. */
struct tvi_locator {
    const tvi_single_run *run;
    tvi_partial_step partial_step;
    tvi_event_search search;
    tvi_event_finder finder;
    int state_size;        /* 2n + 1, the number of components of a state */
    double *root_states;   /* [root_capacity][state_size] the computed states of the step's roots */
    int root_capacity;     /* the number of roots for which root_states has memory */
    double *scratch_sizes; /* [state_size] the sizes |x_i| of a state's components */
};

static double *state_of_root(const tvi_locator *locator, const tvi_event_root *root)
{
    return locator->root_states + (size_t)root->index_in_order_found * (size_t)locator->state_size;
}

/* Tells whether root a comes before root b. Roots that are near each other are compared by their computed times, and at
 * equal times by the index of the event. Other roots are compared by theta. */
static bool is_root_before(tvi_locator *locator, const tvi_event_root *a, const tvi_event_root *b)
{
    const int t = locator->state_size - 1;
    if (fabs(a->theta - b->theta) > EVENT_NEAR_STOP) return a->theta < b->theta;
    const double way =
        (state_of_root(locator, a)[t] - state_of_root(locator, b)[t]) * locator->search.integrator->covered_time;
    return way < 0 || (way == 0 && a->event_index < b->event_index);
}

static void sort_roots_by_time(tvi_locator *locator)
{
    for (int i = 1; i < locator->search.root_count; i++)
        for (int j = i; j > 0 && is_root_before(locator, &locator->search.roots[j], &locator->search.roots[j - 1]);
             j--) {
            const tvi_event_root later = locator->search.roots[j - 1];
            locator->search.roots[j - 1] = locator->search.roots[j];
            locator->search.roots[j] = later;
        }
}

/* Tells whether the root is one of the first root_count roots, since the search may find one root from two brackets. */
static bool is_duplicate_root(const tvi_locator *locator, int root_count, const tvi_event_root *root)
{
    for (int i = 0; i < root_count; i++) {
        const tvi_event_root *earlier = &locator->search.roots[i];
        if (earlier->event_index == root->event_index && earlier->g_sign_after == root->g_sign_after &&
            fabs(earlier->theta - root->theta) <= EVENT_SAME_ROOT)
            return true;
    }
    return false;
}

/* Allocates memory for the states of all roots of the step. */
static tvi_status reserve_root_states(tvi_locator *locator)
{
    if (locator->search.root_count <= locator->root_capacity) return TVI_OK;
    const size_t count = (size_t)locator->search.root_count * (size_t)locator->state_size;
    double *states = realloc(locator->root_states, count * sizeof *states);
    if (!states) return jet_explain_out_of_memory(TVI_ENOMEM);
    locator->root_states = states;
    locator->root_capacity = locator->search.root_count;
    return TVI_OK;
}

/* Finds all events of the last step, and sorts them by time. Roots that only the curve has, and that the more accurate
 * partial steps lack, are dropped. */
static tvi_status locate_events_of_step(tvi_locator *locator)
{
    tvi_status status = tvi_search_last_step_for_roots(&locator->search);
    int count = 0;
    if (status == TVI_OK) status = reserve_root_states(locator);
    for (int i = 0; i < locator->search.root_count && status == TVI_OK; i++) {
        tvi_event_root *root = &locator->search.roots[i];
        status = tvi_finder_find_event(&locator->finder, root, state_of_root(locator, root));
        if (!root->is_absent_from_accurate_solution && !is_duplicate_root(locator, count, root))
            locator->search.roots[count++] = *root;
    }
    locator->search.root_count = count;
    sort_roots_by_time(locator);
    return status;
}

/* Calls the observer of events with the state of a root. Returns true if the observer stops the run at the root. */
static bool report_event_of_root(tvi_locator *locator, const tvi_event_root *root, const double state[])
{
    const int n = locator->search.integrator->system->n;
    const tvi_observers *observers = &locator->run->observers;
    if (!observers->on_event) return false;
    __attribute__((cleanup(tvi_end_observer_call))) tvi_integrator *called = locator->search.integrator;
    called->is_in_observer = true;
    return observers->on_event(root->event_index, state[2 * n], state, state + n, observers->ctx) != 0;
}

/* Computes the tangent vectors at the root, if the observer of events may read them, or the user after a terminal
 * event. */
static tvi_status propagate_columns_to_root(tvi_locator *locator, const tvi_event_root *root)
{
    const bool is_seen =
        locator->run->observers.on_event || locator->search.watched_events[root->event_index].event->is_terminal;
    const double part = root->theta * locator->search.integrator->h;
    return is_seen ? tvi_columns_propagate_to_offset(locator->search.integrator, &locator->run->columns, part,
                                                     locator->partial_step.partial_step_integrator->parameters)
                   : TVI_OK;
}

/* Sets *is_at_stop: true if the root lies at `state`, where the run stops at theta. This is so if the times are
 * equal. It is also so if the two theta differ by less than EVENT_NEAR_STOP and the sign of g at `state` contradicts
 * their order. */
static tvi_status check_root_at_stop(tvi_locator *locator, const tvi_event_root *root, double theta,
                                     const double state[], bool *is_at_stop)
{
    const int time = locator->state_size - 1;
    const double t = state[time], own = state_of_root(locator, root)[time];
    double g = 0;
    *is_at_stop = fabs(own - t) <= EVENT_SAME_TIME * fmax(fabs(own), fabs(t));
    if (*is_at_stop || fabs(root->theta - theta) > EVENT_NEAR_STOP) return TVI_OK;
    const tvi_status status = tvi_search_evaluate_event(&locator->search, root->event_index, state, &g);
    *is_at_stop = tvi_has_sign_after_root(root, g) == (root->theta > theta);
    return status;
}

/* Sets *is_at_stop: true if the event crosses 0 at `state`, where the run stops, in the direction that the user has not
 * asked for. The search has skipped such crossings, so this function only tests whether |g| is at most its roundoff at
 * `state`. */
static tvi_status check_skipped_root_at_stop(tvi_locator *locator, int event_index, const double state[],
                                             bool *is_at_stop)
{
    const tvi_watched_event *w = &locator->search.watched_events[event_index];
    double g = 0, roundoff = 0;
    tvi_status status = tvi_search_evaluate_event(&locator->search, event_index, state, &g);
    for (int i = 0; i < locator->state_size; i++) locator->scratch_sizes[i] = fabs(state[i]);
    if (status == TVI_OK)
        status = tvi_event_estimate_roundoff(w->event, &w->local_series, state, locator->scratch_sizes, &roundoff);
    *is_at_stop = fabs(g) <= roundoff;
    return status;
}

/* Finds, of all roots of the event, the last one before root number stop_root_index, and the first one after root
 * number stop_root_index. NULL stands for none. */
static void find_neighbouring_roots(const tvi_locator *locator, int event_index, int stop_root_index,
                                    const tvi_event_root **earlier, const tvi_event_root **later)
{
    *earlier = *later = NULL;
    for (int i = 0; i < locator->search.root_count; i++) {
        const tvi_event_root *root = &locator->search.roots[i];
        if (root->event_index != event_index || i == stop_root_index) continue;
        if (i < stop_root_index) *earlier = root;
        else if (!*later) *later = root;
    }
}

/* Tells whether the event may cross 0 at the stop, at theta and the time t, in the direction that the user has not
 * asked for. Returns false if the stop is at the end of the step up to roundoff. Returns false also if later_root, the
 * event's next root, lies within one sample interval after the stop: g is small then because of that root. */
static bool may_have_skipped_root_at_stop(const tvi_locator *locator, int event_index, const tvi_event_root *later_root,
                                          double theta, double t)
{
    const double resolved = EVENT_SAME_STOP * fabs(t / locator->search.integrator->covered_time);
    return tvi_event_skips_a_direction(locator->search.watched_events[event_index].event) &&
           theta < 1 - fmax(EVENT_NEAR_STOP, resolved) &&
           !(later_root && later_root->theta - theta <= tvi_sample_theta[0]);
}

/* Sets *is_at_stop: true if the event lies at `state`, where the run stops because of root number stop_root_index. The
 * event may have this root, or an earlier or a later root that also lies at `state`. *unreported becomes this later
 * root, or NULL if there is none. */
static tvi_status check_event_at_stop(tvi_locator *locator, int event_index, int stop_root_index, const double state[],
                                      bool *is_at_stop, const tvi_event_root **unreported)
{
    const double theta = locator->search.roots[stop_root_index].theta;
    const tvi_event_root *earlier, *later;
    bool has_later = false, was_reported = locator->search.roots[stop_root_index].event_index == event_index;
    tvi_status status = TVI_OK;
    find_neighbouring_roots(locator, event_index, stop_root_index, &earlier, &later);
    if (later) status = check_root_at_stop(locator, later, theta, state, &has_later);
    if (status == TVI_OK && earlier && !was_reported)
        status = check_root_at_stop(locator, earlier, theta, state, &was_reported);
    *is_at_stop = was_reported || has_later;
    *unreported = has_later ? later : NULL;
    if (status == TVI_OK && !*is_at_stop &&
        may_have_skipped_root_at_stop(locator, event_index, later, theta, state[locator->state_size - 1]))
        status = check_skipped_root_at_stop(locator, event_index, state, is_at_stop);
    return status;
}

/* Ends the run at the root number stop_root_index with the given state, and reports other events at the same time. The
 * integrator's tvi_event_stop stores all these events, so that a run that goes on from `state` does not report them
 * again. It keeps the events of the previous stop if the times of both stops differ by less than EVENT_SAME_STOP. */
static tvi_status stop_run_at_event(tvi_locator *locator, int stop_root_index, const double state[])
{
    tvi_integrator *it = locator->search.integrator;
    tvi_event_stop *stop = it->stop;
    const double t = state[locator->state_size - 1], before = stop->state[locator->state_size - 1];
    const bool is_soon = stop->is_set && fabs(t - before) <= EVENT_SAME_STOP * fmax(fabs(t), fabs(before));
    if (!is_soon) tvi_event_stop_clear(stop, it->system->n);
    for (int event_index = 0; event_index < locator->search.event_count; event_index++) {
        bool is_at_stop;
        const tvi_event_root *unreported;
        const tvi_status status =
            check_event_at_stop(locator, event_index, stop_root_index, state, &is_at_stop, &unreported);
        if (status != TVI_OK) return status;
        if (unreported) (void)report_event_of_root(locator, unreported, state);
        const tvi_event *event = locator->search.watched_events[event_index].event;
        if (is_at_stop && stop->event_count < TVI_STOP_EVENTS && !tvi_stop_has_event(stop, event))
            stop->event_hashes[stop->event_count++] = event->hash;
    }
    memcpy(stop->state, state, (size_t)locator->state_size * sizeof *state);
    /* The stop is not valid if an observer has just set parameters, since the events' functions change with them. */
    stop->is_set = it->parameter_version == locator->partial_step.copied_parameter_version;
    tvi_integrator_reset(it);
    return TVI_ESTOPPED;
}

/* Copies the parameters of the last step to the tapes of the events and to the partial steps, if an observer has set
 * new ones before that step. */
static tvi_status update_event_parameters(tvi_locator *locator)
{
    const tvi_integrator *it = locator->search.integrator;
    if (locator->partial_step.copied_parameter_version == it->parameter_version) return TVI_OK;
    tvi_search_set_parameters(&locator->search);
    tvi_state_rates_set_parameters(&locator->finder.rates_evaluator, it->parameters);
    return tvi_partial_step_set_parameters(&locator->partial_step);
}

/* Copies a state [2n + 1] to the user's t, q and p. */
static void copy_state_to_user(const tvi_locator *locator, const double state[], double *t, double q[], double p[])
{
    const size_t n = (size_t)locator->search.integrator->system->n;
    *t = state[2 * n];
    memcpy(q, state, n * sizeof *q);
    memcpy(p, state + n, n * sizeof *p);
}

/* Reports one root, and before it the given times that come first. Returns TVI_ESTOPPED if the run ends at this
 * root. */
static tvi_status report_root(tvi_locator *locator, tvi_times_progress *times, int root_index, double *t, double q[],
                              double p[])
{
    const tvi_event_root *root = &locator->search.roots[root_index];
    const double *state = state_of_root(locator, root);
    tvi_status status = times ? tvi_times_report_until(times, state[locator->state_size - 1]) : TVI_OK;
    if (status == TVI_OK) status = propagate_columns_to_root(locator, root);
    if (status != TVI_OK) return status;
    const bool ends = report_event_of_root(locator, root, state);
    if (!ends && !locator->search.watched_events[root->event_index].event->is_terminal) return TVI_OK;
    status = stop_run_at_event(locator, root_index, state);
    if (status == TVI_ESTOPPED) copy_state_to_user(locator, state, t, q, p);
    return status;
}

tvi_status tvi_locator_report_events(tvi_locator *locator, tvi_times_progress *times, double *t, double q[], double p[])
{
    const tvi_tangent_columns *columns = &locator->run->columns;
    tvi_status status = update_event_parameters(locator);
    if (status == TVI_OK) status = locate_events_of_step(locator);
    if (locator->search.repeats_stop_at_same_time) {
        tvi_integrator_undo_step(locator->search.integrator, t, q, p);
        tvi_columns_restore_step_start(locator->search.integrator, columns);
    }
    for (int i = 0; i < locator->search.root_count && status == TVI_OK; i++)
        status = report_root(locator, times, i, t, q, p);
    if (status != TVI_ESTOPPED && !locator->search.repeats_stop_at_same_time)
        tvi_columns_restore_step_end(locator->search.integrator, columns);
    return status;
}

void tvi_locator_close(tvi_locator *locator)
{
    if (!locator) return;
    tvi_finder_close(&locator->finder);
    tvi_search_close(&locator->search);
    free(locator->root_states);
    free(locator->scratch_sizes);
    tvi_partial_step_close(&locator->partial_step);
    free(locator);
}

static tvi_status initialize_locator(tvi_locator *locator, tvi_integrator *it, const tvi_single_run *run, double t,
                                     const double *const state[2])
{
    const int size = 2 * it->system->n + 1;
    const tvi_run_plan *plan = run->plan;
    *locator = (tvi_locator){.run = run, .state_size = size};
    tvi_status status = tvi_partial_step_open(&locator->partial_step, it, true);
    if (status == TVI_OK)
        status = tvi_search_open(&locator->search, &locator->partial_step, plan->events, plan->event_count, t, state);
    if (status == TVI_OK) status = tvi_finder_open(&locator->finder, &locator->search);
    if (status != TVI_OK) return status;
    locator->scratch_sizes = calloc((size_t)size, sizeof *locator->scratch_sizes);
    return locator->scratch_sizes ? TVI_OK : TVI_ENOMEM;
}

tvi_status tvi_locator_open(tvi_locator **out, tvi_integrator *it, const tvi_single_run *run, double t,
                            const double *const state[2])
{
    *out = malloc(sizeof **out);
    if (!*out) return jet_explain_out_of_memory(TVI_ENOMEM);
    const tvi_status status = initialize_locator(*out, it, run, t, state);
    if (status == TVI_OK) return status;
    tvi_locator_close(*out);
    *out = NULL;
    return jet_explain_out_of_memory(status);
}

bool tvi_events_match_dimension(const tvi_integrator *it, const tvi_event *const events[], int count)
{
    if (count >= 0 && (count == 0 || events)) {
        int event_index = 0;
        while (event_index < count && events[event_index] && events[event_index]->n == it->system->n) event_index++;
        if (event_index == count) return true;
        (void)jet_refuse(TVI_EINVAL, "events[%d] is %s", event_index,
                         events[event_index] ? "of another dimension" : "NULL");
    } else {
        (void)jet_refuse(TVI_EINVAL, count < 0 ? "count = %d is negative" : "events is NULL", count);
    }
    return false;
}
