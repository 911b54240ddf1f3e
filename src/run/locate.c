/* locate.c - a run that looks for events: those of each step in order of time, and where one of them ends the run. */
#include "run/locate.h"
#include "run/finder.h"
#include "run/start.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Times that differ by so many units of their resolution are one. */
static const double SAME_TIME = 2 * DBL_EPSILON;
/* The states of so many events of a step are kept until they are told; those of more are found again. */
enum { KEPT = 32 };

/* States are [2n + 1]: q, p, t. */
typedef struct tvi_locator {
    tvi_between between;
    tvi_search seen;
    tvi_finder finder;
    long parameter_sets; /* of the integrator, when the parameters here were its own */
    int size;            /* of a state */
    double *kept;        /* [KEPT + 1] */
} locator;

/* In the order of time, and of the events where that is equal. */
static void sort_roots(locator *s)
{
    for (int i = 1; i < s->seen.found; i++)
        for (int j = i; j > 0 && s->seen.roots[j].theta < s->seen.roots[j - 1].theta; j--) {
            const tvi_root later = s->seen.roots[j - 1];
            s->seen.roots[j - 1] = s->seen.roots[j];
            s->seen.roots[j] = later;
        }
}

static double *kept_state(locator *s, int kept)
{
    return s->kept + (size_t)(kept < KEPT ? kept : KEPT) * (size_t)s->size;
}

/* Finds the events of the last step, in order. */
static tvi_status locate_events(locator *s)
{
    tvi_status status = tvi_search_step(&s->seen);
    for (int i = 0; i < s->seen.found && status == TVI_OK; i++)
        status = tvi_finder_find(&s->finder, &s->seen.roots[i], kept_state(s, s->seen.roots[i].number));
    sort_roots(s);
    return status;
}

/* Who is told of events. */
typedef struct {
    tvi_event_observer *on_event;
    void *ctx;
} telling;

/* What the observer says of an event, with the state x. */
static bool tell(locator *s, const tvi_root *r, const double x[], const telling *to)
{
    const int n = s->seen.it->system->n;
    return tvi_tell_event(s->seen.it, to->on_event, r->which, x[2 * n], x, x + n, to->ctx) != 0;
}

/* Whether the root lies before the stop x at theta, or at it: by what g is there, where nothing else is between. */
static tvi_status has_come(locator *s, const tvi_root *r, double theta, const double x[], bool *has)
{
    double g = 0;
    *has = theta >= r->b;
    if (theta <= r->a || theta >= r->b) return TVI_OK;
    const tvi_status status = tvi_search_value(&s->seen, r->which, x, &g);
    *has = tvi_is_behind(r, g);
    return status;
}

static bool is_at(locator *s, const tvi_root *r, const double x[])
{
    const double t = x[s->size - 1], own = r->number < KEPT ? kept_state(s, r->number)[s->size - 1] : t;
    return fabs(own - t) <= SAME_TIME * fmax(fabs(own), fabs(t));
}

/* An event at the stop x, which is that of the root `last`: *is_here, as itself, or its root before that, or its next
 * one, which then is told now. */
static tvi_status look_at_stop(locator *s, int which, int last, const double x[], const telling *to, bool *is_here)
{
    tvi_root *told = NULL, *next = NULL;
    bool has = true, comes = false;
    tvi_status status = TVI_OK;
    *is_here = s->seen.roots[last].which == which;
    if (*is_here) return TVI_OK;
    for (int i = 0; i < s->seen.found; i++) {
        tvi_root *r = &s->seen.roots[i];
        if (r->which != which) continue;
        if (i < last) told = r;
        else if (!next) next = r;
    }
    const double theta = s->seen.roots[last].theta;
    if (next) status = has_come(s, next, theta, x, &comes);
    if (status == TVI_OK && told) status = has_come(s, told, theta, x, &has);
    comes = comes || (next && is_at(s, next, x));
    *is_here = comes || !has || (told && is_at(s, told, x));
    if (status == TVI_OK && comes) (void)tell(s, next, x, to);
    return status;
}

/* The run ends at the event with the state x: the others of its time are told, too, and all of them are kept, so that
 * the run that goes on has left them. */
static tvi_status stop_at(locator *s, int last, const double x[], const telling *to)
{
    tvi_integrator *it = s->seen.it;
    tvi_stop *stop = it->stop;
    *stop = (tvi_stop){.is_set = true};
    memcpy(stop->state, x, (size_t)s->size * sizeof *x);
    for (int which = 0; which < s->seen.count; which++) {
        bool is_here;
        const tvi_status status = look_at_stop(s, which, last, x, to, &is_here);
        if (status != TVI_OK) return status;
        if (is_here && stop->count < TVI_STOP_TOLD) stop->told[stop->count++] = s->seen.of[which].event->hash;
    }
    stop->is_set = it->parameter_sets == s->parameter_sets; /* else they are other events now */
    tvi_integrator_reset(it);
    return TVI_ESTOPPED;
}

/* Parameters that an observer has set are those of the step that was just made. */
static tvi_status take_parameters(locator *s)
{
    const tvi_integrator *it = s->seen.it;
    if (s->parameter_sets == it->parameter_sets) return TVI_OK;
    s->parameter_sets = it->parameter_sets;
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

tvi_status tvi_locator_tell(locator *s, double *t, double q[], double p[], tvi_event_observer *on_event, void *ctx)
{
    const telling to = {on_event, ctx};
    tvi_status status = take_parameters(s);
    if (status == TVI_OK) status = locate_events(s);
    if (s->seen.rests) tvi_integrator_take_back(s->seen.it, t, q, p);
    for (int i = 0; i < s->seen.found && status == TVI_OK; i++) {
        tvi_root *r = &s->seen.roots[i];
        double *x = kept_state(s, r->number);
        if (r->number >= KEPT) status = tvi_finder_find(&s->finder, r, x);
        if (status != TVI_OK) return status;
        const bool ends = tell(s, r, x, &to);
        if (!ends && !s->seen.of[r->which].event->terminal) continue;
        status = stop_at(s, i, x, &to);
        if (status == TVI_ESTOPPED) give(s, x, t, q, p);
    }
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

static tvi_status open_locator(locator *s, tvi_integrator *it, const tvi_event *const events[], int count, double t,
                               const double *const state[2])
{
    const int size = 2 * it->system->n + 1;
    *s = (locator){.size = size, .parameter_sets = it->parameter_sets};
    tvi_status status = tvi_between_open(&s->between, it, true);
    if (status == TVI_OK) status = tvi_search_open(&s->seen, &s->between, events, count, t, state);
    if (status == TVI_OK) status = tvi_finder_open(&s->finder, &s->seen);
    if (status != TVI_OK) return status;
    s->kept = calloc((size_t)size * (KEPT + 1), sizeof *s->kept);
    return s->kept ? TVI_OK : TVI_ENOMEM;
}

tvi_status tvi_locator_open(locator **out, tvi_integrator *it, const tvi_event *const events[], int count, double t,
                            const double *const state[2])
{
    *out = malloc(sizeof **out);
    if (!*out) return jet_refuse_memory(TVI_ENOMEM);
    const tvi_status status = open_locator(*out, it, events, count, t, state);
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
