/* locate.c - Locates the events in each step of a run, reports them in order of time, and ends the run at a terminal
 * one. */
#include "run/locate.h"
#include "run/finder.h"
#include "run/run.h"
#include "run/start.h"
#include "run/times.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Two times that differ by at most this relative amount are the same time. */
static const double SAME_TIME = 2 * DBL_EPSILON;
/* A stop within SOON of the time of the stop before counts as the same stop. A root within NEAR_STOP of a stop, in
 * parts of the step, is judged by the roundoff of g. */
static const double SOON = 32 * DBL_EPSILON, NEAR_STOP = 1e-6;
/* Two roots of one event in one direction that are closer than this are one root. */
static const double SAME_ROOT = 1e-12;
/* The states of up to KEPT events of a step are kept until they are reported. The states of further events are computed
 * again. */
enum { KEPT = 32 };

/* The work of a run with events. States are [2n + 1]: q, p, t. */
typedef struct tvi_locator {
    const tvi_run_of_one *run;
    tvi_between between;
    tvi_search search;
    tvi_finder finder;
    int size; /* of a state */
    /* [KEPT + 1] states of the roots; the last one is scratch. */
    double *kept;
    double *state_sizes; /* [size] scratch */
} locator;

static double *kept_state(locator *s, int kept)
{
    return s->kept + (size_t)(kept < KEPT ? kept : KEPT) * (size_t)s->size;
}

/* Tells whether root a comes before root b, by their times and then by their events. Two roots whose states are not
 * kept, or that are far apart, are compared by theta. */
static bool is_before(locator *s, const tvi_root *a, const tvi_root *b)
{
    const int t = s->size - 1;
    const bool are_kept = a->number < KEPT && b->number < KEPT, are_near = fabs(a->theta - b->theta) <= NEAR_STOP;
    if (!are_kept || !are_near) return a->theta < b->theta;
    const double way = (kept_state(s, a->number)[t] - kept_state(s, b->number)[t]) * s->search.it->covered;
    return way < 0 || (way == 0 && a->which < b->which);
}

static void sort_roots(locator *s)
{
    for (int i = 1; i < s->search.found; i++)
        for (int j = i; j > 0 && is_before(s, &s->search.roots[j], &s->search.roots[j - 1]); j--) {
            const tvi_root later = s->search.roots[j - 1];
            s->search.roots[j - 1] = s->search.roots[j];
            s->search.roots[j] = later;
        }
}

/* Tells whether the root was found before, from another bracket. */
static bool is_known(const locator *s, int count, const tvi_root *root)
{
    for (int i = 0; i < count; i++) {
        const tvi_root *r = &s->search.roots[i];
        if (r->which == root->which && r->sign_after == root->sign_after && fabs(r->theta - root->theta) <= SAME_ROOT)
            return true;
    }
    return false;
}

/* Finds the events of the last step, in order: the roots that the method's own solution has. */
static tvi_status locate_events(locator *s)
{
    tvi_status status = tvi_search_step(&s->search);
    int count = 0;
    for (int i = 0; i < s->search.found && status == TVI_OK; i++) {
        tvi_root *r = &s->search.roots[i];
        status = tvi_finder_find(&s->finder, r, kept_state(s, r->number));
        if (!r->is_none && !is_known(s, count, r)) s->search.roots[count++] = *r;
    }
    s->search.found = count;
    sort_roots(s);
    return status;
}

/* Reports an event with the state x. Returns whether the observer ends the run. */
static bool report_event(locator *s, const tvi_root *r, const double x[])
{
    const int n = s->search.it->system->n;
    const tvi_observers *observers = &s->run->observers;
    return tvi_call_event_observer(s->search.it, observers->on_event, r->which, x[2 * n], x, x + n, observers->ctx) !=
           0;
}

/* Sets the columns to those at the root, if the root is reported to an observer or ends the run. */
static tvi_status show_columns(locator *s, const tvi_root *r)
{
    const bool is_seen = s->run->observers.on_event || s->search.watch[r->which].event->terminal;
    const double part = r->theta * s->search.it->h;
    return is_seen ? tvi_columns_show(s->search.it, &s->run->columns, part, s->between.partial_integrator->parameters)
                   : TVI_OK;
}

/* Tells whether the root is at the stop x, at theta. It is if the times are equal. It is also if both are near and the
 * sign of g at x contradicts the order of the thetas. */
static tvi_status is_at_stop(locator *s, const tvi_root *r, double theta, const double x[], bool *is_here)
{
    const double t = x[s->size - 1], covered = s->search.it->covered;
    const double own = r->number < KEPT ? kept_state(s, r->number)[s->size - 1] : t + (r->theta - theta) * covered;
    double g = 0;
    *is_here = fabs(own - t) <= SAME_TIME * fmax(fabs(own), fabs(t));
    if (*is_here || fabs(r->theta - theta) > NEAR_STOP) return TVI_OK;
    const tvi_status status = tvi_search_value(&s->search, r->which, x, &g);
    *is_here = tvi_is_behind(r, g) == (r->theta > theta);
    return status;
}

/* Tells whether g is within its roundoff of 0 at the stop x, in the direction that is not wanted. The search has
 * skipped such a root. */
static tvi_status crosses_back(locator *s, int which, const double x[], bool *is_here)
{
    const tvi_watch *w = &s->search.watch[which];
    double g = 0, roundoff = 0;
    tvi_status status = tvi_search_value(&s->search, which, x, &g);
    for (int i = 0; i < s->size; i++) s->state_sizes[i] = fabs(x[i]);
    if (status == TVI_OK) status = tvi_event_roundoff(w->event, &w->near, x, s->state_sizes, &roundoff);
    *is_here = fabs(g) <= roundoff;
    return status;
}

/* Tells whether an event is at the stop x of the root `last`: as this root, or as its own root just before. If its next
 * root is at the stop, too, that root is reported now. */
static tvi_status check_stop(locator *s, int which, int last, const double x[], bool *is_here)
{
    const tvi_root *told = NULL, *next = NULL;
    const double theta = s->search.roots[last].theta;
    bool was_here = s->search.roots[last].which == which, comes = false;
    tvi_status status = TVI_OK;
    for (int i = 0; i < s->search.found; i++) {
        const tvi_root *r = &s->search.roots[i];
        if (r->which == which && i < last) told = r;
        else if (r->which == which && i > last && !next) next = r;
    }
    if (next) status = is_at_stop(s, next, theta, x, &comes);
    if (status == TVI_OK && told && !was_here) status = is_at_stop(s, told, theta, x, &was_here);
    const double resolved = SOON * fabs(x[s->size - 1] / s->search.it->covered); /* the end of the step is later, too */
    const bool has_other_way = s->search.watch[which].event->direction != TVI_EITHER;
    const bool is_other = has_other_way && theta < 1 - fmax(NEAR_STOP, resolved);
    /* also a root at the stop: roundoff of g decides */
    const bool is_ahead = next && next->theta - theta <= tvi_sample_theta[0];
    if (status == TVI_OK && !comes && !was_here && is_other && !is_ahead) status = crosses_back(s, which, x, &was_here);
    if (status == TVI_OK && comes) (void)report_event(s, next, x);
    *is_here = was_here || comes;
    return status;
}

/* Ends the run at the event with the state x. Other events at the same time are reported, too. The stop keeps all of
 * them, so that the run that goes on has left them; it also keeps those of the stop before if that was hardly
 * sooner. */
static tvi_status stop_at(locator *s, int last, const double x[])
{
    tvi_integrator *it = s->search.it;
    tvi_stop *stop = it->stop;
    const double t = x[s->size - 1], before = stop->state[s->size - 1];
    const bool is_soon = stop->is_set && fabs(t - before) <= SOON * fmax(fabs(t), fabs(before));
    if (!is_soon) stop->count = 0;
    for (int which = 0; which < s->search.count; which++) {
        bool is_here;
        const tvi_status status = check_stop(s, which, last, x, &is_here);
        if (status != TVI_OK) return status;
        const tvi_event *event = s->search.watch[which].event;
        if (is_here && stop->count < TVI_STOP_EVENTS && !tvi_start_is_among(stop, event))
            stop->events[stop->count++] = event->hash;
    }
    memcpy(stop->state, x, (size_t)s->size * sizeof *x);
    stop->is_set = it->parameter_sets == s->between.parameter_sets; /* otherwise the events have new parameters */
    tvi_integrator_reset(it);
    return TVI_ESTOPPED;
}

/* Copies parameters that an observer has set to the search. They are those of the step that was just made. */
static tvi_status update_parameters(locator *s)
{
    const tvi_integrator *it = s->search.it;
    if (s->between.parameter_sets == it->parameter_sets) return TVI_OK;
    tvi_search_set_parameters(&s->search);
    tvi_rates_set_parameters(&s->finder.rates, it->parameters);
    return tvi_between_set_parameters(&s->between);
}

/* Copies a state to t, q and p of the user. */
static void copy_state(const locator *s, const double x[], double *t, double q[], double p[])
{
    const size_t n = (size_t)s->search.it->system->n;
    *t = x[2 * n];
    memcpy(q, x, n * sizeof *q);
    memcpy(p, x + n, n * sizeof *p);
}

/* Reports root number i, after the times before it. Returns TVI_ESTOPPED if the run ends there. */
static tvi_status report_root(locator *s, tvi_times *times, int i, double *t, double q[], double p[])
{
    tvi_root *r = &s->search.roots[i];
    double *x = kept_state(s, r->number);
    tvi_status status = r->number >= KEPT ? tvi_finder_find(&s->finder, r, x) : TVI_OK;
    if (status == TVI_OK && times) status = tvi_times_report(times, x[s->size - 1]);
    if (status == TVI_OK) status = show_columns(s, r);
    if (status != TVI_OK) return status;
    const bool ends = report_event(s, r, x);
    if (!ends && !s->search.watch[r->which].event->terminal) return TVI_OK;
    status = stop_at(s, i, x);
    if (status == TVI_ESTOPPED) copy_state(s, x, t, q, p);
    return status;
}

tvi_status tvi_locator_report(locator *s, tvi_times *times, double *t, double q[], double p[])
{
    const tvi_columns *columns = &s->run->columns;
    tvi_status status = update_parameters(s);
    if (status == TVI_OK) status = locate_events(s);
    if (s->search.rests) tvi_integrator_undo(s->search.it, t, q, p);
    if (s->search.rests) tvi_columns_to_start(s->search.it, columns);
    for (int i = 0; i < s->search.found && status == TVI_OK; i++) status = report_root(s, times, i, t, q, p);
    if (status != TVI_ESTOPPED && !s->search.rests) tvi_columns_to_end(s->search.it, columns);
    return status;
}

void tvi_locator_close(locator *s)
{
    if (!s) return;
    tvi_finder_close(&s->finder);
    tvi_search_close(&s->search);
    free(s->kept);
    tvi_between_close(&s->between);
    free(s);
}

static tvi_status open_locator(locator *s, tvi_integrator *it, const tvi_run_of_one *run, double t,
                               const double *const state[2])
{
    const int size = 2 * it->system->n + 1;
    const tvi_run_plan *plan = run->plan;
    *s = (locator){.run = run, .size = size};
    tvi_status status = tvi_between_open(&s->between, it, true);
    if (status == TVI_OK) status = tvi_search_open(&s->search, &s->between, plan->events, plan->event_count, t, state);
    if (status == TVI_OK) status = tvi_finder_open(&s->finder, &s->search);
    if (status != TVI_OK) return status;
    s->kept = calloc((size_t)size * (KEPT + 2), sizeof *s->kept);
    if (!s->kept) return TVI_ENOMEM;
    s->state_sizes = s->kept + size * (KEPT + 1);
    return TVI_OK;
}

tvi_status tvi_locator_open(locator **out, tvi_integrator *it, const tvi_run_of_one *run, double t,
                            const double *const state[2])
{
    *out = malloc(sizeof **out);
    if (!*out) return jet_refuse_memory(TVI_ENOMEM);
    const tvi_status status = open_locator(*out, it, run, t, state);
    if (status == TVI_OK) return status;
    tvi_locator_close(*out);
    *out = NULL;
    return jet_refuse_memory(status);
}

bool tvi_events_fit(const tvi_integrator *it, const tvi_event *const events[], int count)
{
    if (count >= 0 && (count == 0 || events)) {
        int which = 0;
        while (which < count && events[which] && events[which]->n == it->system->n) which++;
        if (which == count) return true;
        (void)jet_refuse(TVI_EINVAL, "events[%d] is %s", which, events[which] ? "of another dimension" : "NULL");
    } else {
        (void)jet_refuse(TVI_EINVAL, count < 0 ? "count = %d is negative" : "events is NULL", count);
    }
    return false;
}
