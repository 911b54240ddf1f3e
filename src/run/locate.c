/* locate.c - a run that looks for events: those of each step in order of time, and where one of them ends the run. */
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

/* Times that differ by so many units of their resolution are one. */
static const double SAME_TIME = 2 * DBL_EPSILON;
/* A stop so much later is one with the stop before; and so far from it, in parts of the step, roundoff of g counts. */
static const double SOON = 32 * DBL_EPSILON, NEAR_STOP = 1e-6;
/* Roots of one event, of one direction, that are closer than this are one. */
static const double SAME_ROOT = 1e-12;
/* The states of so many events of a step are kept until they are told; those of more are found again. */
enum { KEPT = 32 };

/* States are [2n + 1]: q, p, t. */
typedef struct tvi_locator {
    const tvi_run_of_one *run;
    tvi_between between;
    tvi_search seen;
    tvi_finder finder;
    int size;      /* of a state */
    double *kept;  /* [KEPT + 1] */
    double *sizes; /* scratch, a state */
} locator;

static double *kept_state(locator *s, int kept)
{
    return s->kept + (size_t)(kept < KEPT ? kept : KEPT) * (size_t)s->size;
}

/* In the order of time, and of the events where that is equal; where a state was not kept, of the places. */
static bool is_before(locator *s, const tvi_root *a, const tvi_root *b)
{
    const int t = s->size - 1;
    const bool are_kept = a->number < KEPT && b->number < KEPT, are_near = fabs(a->theta - b->theta) <= NEAR_STOP;
    if (!are_kept || !are_near) return a->theta < b->theta;
    const double way = (kept_state(s, a->number)[t] - kept_state(s, b->number)[t]) * s->seen.it->covered;
    return way < 0 || (way == 0 && a->which < b->which);
}

static void sort_roots(locator *s)
{
    for (int i = 1; i < s->seen.found; i++)
        for (int j = i; j > 0 && is_before(s, &s->seen.roots[j], &s->seen.roots[j - 1]); j--) {
            const tvi_root later = s->seen.roots[j - 1];
            s->seen.roots[j - 1] = s->seen.roots[j];
            s->seen.roots[j] = later;
        }
}

/* Whether the root was found before, from another place of the curve. */
static bool is_known(const locator *s, int count, const tvi_root *root)
{
    for (int i = 0; i < count; i++) {
        const tvi_root *r = &s->seen.roots[i];
        if (r->which == root->which && r->after == root->after && fabs(r->theta - root->theta) <= SAME_ROOT)
            return true;
    }
    return false;
}

/* Finds the events of the last step, in order: the roots that the method's own solution has. */
static tvi_status locate_events(locator *s)
{
    tvi_status status = tvi_search_step(&s->seen);
    int count = 0;
    for (int i = 0; i < s->seen.found && status == TVI_OK; i++) {
        tvi_root *r = &s->seen.roots[i];
        status = tvi_finder_find(&s->finder, r, kept_state(s, r->number));
        if (!r->is_none && !is_known(s, count, r)) s->seen.roots[count++] = *r;
    }
    s->seen.found = count;
    sort_roots(s);
    return status;
}

/* Tells of an event, with the state x; whether the observer ends the run. */
static bool tell(locator *s, const tvi_root *r, const double x[])
{
    const int n = s->seen.it->system->n;
    const tvi_audience *to = &s->run->audience;
    return tvi_tell_event(s->seen.it, to->on_event, r->which, x[2 * n], x, x + n, to->ctx) != 0;
}

/* Makes the columns those at the root, which is told now, or ends the run. */
static tvi_status show_columns(locator *s, const tvi_root *r)
{
    const bool is_seen = s->run->audience.on_event || s->seen.of[r->which].event->terminal;
    const double part = r->theta * s->seen.it->h;
    return is_seen ? tvi_columns_show(s->seen.it, &s->run->columns, part, s->between.partial->parameters) : TVI_OK;
}

/* Whether the root is at the stop x, at theta: at its time; or so near that g says that it has not come there, or has,
 * where the order of the places says else. */
static tvi_status is_at_stop(locator *s, const tvi_root *r, double theta, const double x[], bool *is_here)
{
    const double t = x[s->size - 1], covered = s->seen.it->covered;
    const double own = r->number < KEPT ? kept_state(s, r->number)[s->size - 1] : t + (r->theta - theta) * covered;
    double g = 0;
    *is_here = fabs(own - t) <= SAME_TIME * fmax(fabs(own), fabs(t));
    if (*is_here || fabs(r->theta - theta) > NEAR_STOP) return TVI_OK;
    const tvi_status status = tvi_search_value(&s->seen, r->which, x, &g);
    *is_here = tvi_is_behind(r, g) == (r->theta > theta);
    return status;
}

/* A crossing the other way than is wanted, at the stop x: no root was looked for, but g is within its roundoff of 0. */
static tvi_status crosses_back(locator *s, int which, const double x[], bool *is_here)
{
    const tvi_watch *w = &s->seen.of[which];
    double g = 0, roundoff = 0;
    tvi_status status = tvi_search_value(&s->seen, which, x, &g);
    for (int i = 0; i < s->size; i++) s->sizes[i] = fabs(x[i]);
    if (status == TVI_OK) status = tvi_event_roundoff(w->event, &w->near, x, s->sizes, &roundoff);
    *is_here = fabs(g) <= roundoff;
    return status;
}

/* An event at the stop x, which is that of the root `last`: *is_here, as itself, or its root before that, or its next
 * one, which then is told now. */
static tvi_status look_at_stop(locator *s, int which, int last, const double x[], bool *is_here)
{
    const tvi_root *told = NULL, *next = NULL;
    const double theta = s->seen.roots[last].theta;
    bool was_here = s->seen.roots[last].which == which, comes = false;
    tvi_status status = TVI_OK;
    for (int i = 0; i < s->seen.found; i++) {
        const tvi_root *r = &s->seen.roots[i];
        if (r->which == which && i < last) told = r;
        else if (r->which == which && i > last && !next) next = r;
    }
    if (next) status = is_at_stop(s, next, theta, x, &comes);
    if (status == TVI_OK && told && !was_here) status = is_at_stop(s, told, theta, x, &was_here);
    const double resolved = SOON * fabs(x[s->size - 1] / s->seen.it->covered); /* the end of the step is later, too */
    const bool has_other_way = s->seen.of[which].event->direction != TVI_EITHER;
    const bool is_other = has_other_way && theta < 1 - fmax(NEAR_STOP, resolved);
    const bool is_ahead = next && next->theta - theta <= tvi_sample_place[0]; /* or here: roundoff of g decides */
    if (status == TVI_OK && !comes && !was_here && is_other && !is_ahead) status = crosses_back(s, which, x, &was_here);
    if (status == TVI_OK && comes) (void)tell(s, next, x);
    *is_here = was_here || comes;
    return status;
}

/* The run ends at the event with the state x: the others of its time are told, too, and all of them are kept, so that
 * the run that goes on has left them; and those of the stop before, if that was hardly sooner. */
static tvi_status stop_at(locator *s, int last, const double x[])
{
    tvi_integrator *it = s->seen.it;
    tvi_stop *stop = it->stop;
    const double t = x[s->size - 1], before = stop->state[s->size - 1];
    const bool is_soon = stop->is_set && fabs(t - before) <= SOON * fmax(fabs(t), fabs(before));
    if (!is_soon) stop->count = 0;
    for (int which = 0; which < s->seen.count; which++) {
        bool is_here;
        const tvi_status status = look_at_stop(s, which, last, x, &is_here);
        if (status != TVI_OK) return status;
        const tvi_event *event = s->seen.of[which].event;
        if (is_here && stop->count < TVI_STOP_TOLD && !tvi_start_is_among(stop, event))
            stop->told[stop->count++] = event->hash;
    }
    memcpy(stop->state, x, (size_t)s->size * sizeof *x);
    stop->is_set = it->parameter_sets == s->between.parameter_sets; /* else they are other events now */
    tvi_integrator_reset(it);
    return TVI_ESTOPPED;
}

/* Parameters that an observer has set are those of the step that was just made. */
static tvi_status take_parameters(locator *s)
{
    const tvi_integrator *it = s->seen.it;
    if (s->between.parameter_sets == it->parameter_sets) return TVI_OK;
    tvi_search_set_parameters(&s->seen);
    tvi_rates_set_parameters(&s->finder.rates, it->parameters);
    return tvi_between_set_parameters(&s->between);
}

/* t, q, p: a state of the user's. */
static void give(const locator *s, const double x[], double *t, double q[], double p[])
{
    const size_t n = (size_t)s->seen.it->system->n;
    *t = x[2 * n];
    memcpy(q, x, n * sizeof *q);
    memcpy(p, x + n, n * sizeof *p);
}

/* Tells the root with the number i, after the times before it; TVI_ESTOPPED: the run ends there. */
static tvi_status tell_root(locator *s, tvi_times *times, int i, double *t, double q[], double p[])
{
    tvi_root *r = &s->seen.roots[i];
    double *x = kept_state(s, r->number);
    tvi_status status = r->number >= KEPT ? tvi_finder_find(&s->finder, r, x) : TVI_OK;
    if (status == TVI_OK && times) status = tvi_times_tell(times, x[s->size - 1]);
    if (status == TVI_OK) status = show_columns(s, r);
    if (status != TVI_OK) return status;
    const bool ends = tell(s, r, x);
    if (!ends && !s->seen.of[r->which].event->terminal) return TVI_OK;
    status = stop_at(s, i, x);
    if (status == TVI_ESTOPPED) give(s, x, t, q, p);
    return status;
}

tvi_status tvi_locator_tell(locator *s, tvi_times *times, double *t, double q[], double p[])
{
    const tvi_columns *columns = &s->run->columns;
    tvi_status status = take_parameters(s);
    if (status == TVI_OK) status = locate_events(s);
    if (s->seen.rests) tvi_integrator_take_back(s->seen.it, t, q, p);
    if (s->seen.rests) tvi_columns_to_start(s->seen.it, columns);
    for (int i = 0; i < s->seen.found && status == TVI_OK; i++) status = tell_root(s, times, i, t, q, p);
    if (status != TVI_ESTOPPED && !s->seen.rests) tvi_columns_to_end(s->seen.it, columns);
    return status;
}

void tvi_locator_close(locator *s)
{
    if (!s) return;
    tvi_finder_close(&s->finder);
    tvi_search_close(&s->seen);
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
    if (status == TVI_OK) status = tvi_search_open(&s->seen, &s->between, plan->events, plan->event_count, t, state);
    if (status == TVI_OK) status = tvi_finder_open(&s->finder, &s->seen);
    if (status != TVI_OK) return status;
    s->kept = calloc((size_t)size * (KEPT + 2), sizeof *s->kept);
    if (!s->kept) return TVI_ENOMEM;
    s->sizes = s->kept + size * (KEPT + 1);
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
