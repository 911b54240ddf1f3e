/* finder.c - Finds the time and the state of an event to roundoff, for locate.c.
 *
 * The search (search.h) gives a root on the curve of the step. Near it a step over a part of h (between.h) gives a
 * state of the method's own solution, and the slope there gives a line that agrees with this solution to roundoff over
 * a short distance. The event is the sign change of g on that line: its state is as accurate as that of a step,
 * whatever slope g has. */
#include "run/finder.h"
#include "run/start.h"
#include "algebra/sizes.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Half the distance of the two points that give the slopes of the curve and of g. */
static const double CHORD = 1e-5;
enum { MOST_LINES = 5 };
/* A guess is good if the slope leads at most LEAST_WAY further, in parts of the step, and at most NEAR of the distance
 * from the ends of the bracket. */
static const double LEAST_WAY = 1e-6, NEAR = 1e-3;
/* REACH bounds how far the slope of the curve leads from a state of the method. STEEPER is how much larger the relative
 * error of the slope may be than that of the curve. */
static const double REACH = 2e-9, STEEPER = 32;
/* A sign change within SURE on both sides of a point is the event. Otherwise the bracket grows by the factor WIDER, up
 * to FARTHEST. SURE and FARTHEST are parts of the step. */
static const double SURE = 0x1p-50, WIDER = 16, FARTHEST = 1.0 / 16;

tvi_status tvi_finder_open(tvi_finder *s, tvi_search *search)
{
    const tvi_integrator *it = search->it;
    const int size = 2 * it->system->n + 1;
    *s = (tvi_finder){.search = search, .size = size, .base = calloc((size_t)size * 4, sizeof *s->base)};
    if (!s->base) return TVI_ENOMEM;
    s->rate = s->base + size;
    s->middle = s->rate + size;
    s->trial = s->middle + size;
    return tvi_rates_open(&s->rates, it->system, it->parameters);
}

void tvi_finder_close(tvi_finder *s)
{
    tvi_rates_close(&s->rates);
    free(s->base);
}

/* Sets s->rate to the slope of the curve at theta, and s->middle to the state in the middle of the chord there. *slope
 * is that of g along the curve, and *ahead the distance to the zero of g. */
static tvi_status set_slopes(tvi_finder *s, int which, double theta, double *slope, double *ahead)
{
    const double a = fmax(theta - CHORD, 0), b = fmin(theta + CHORD, 1);
    double ga = 0, gb = 0;
    tvi_status status = tvi_search_state(s->search, a, s->rate);
    if (status == TVI_OK) status = tvi_search_value(s->search, which, s->rate, &ga);
    if (status == TVI_OK) status = tvi_search_state(s->search, b, s->middle);
    if (status == TVI_OK) status = tvi_search_value(s->search, which, s->middle, &gb);
    *slope = (gb - ga) / (b - a);
    *ahead = -(ga + gb) / (2 * *slope);
    for (int i = 0; i < s->size; i++) {
        const double low = s->rate[i], high = s->middle[i];
        s->rate[i] = (high - low) / (b - a);
        s->middle[i] = (low + high) / 2;
    }
    s->is_inside = a > 0 && b < 1; /* the error of the slope is the square of the chord */
    return status;
}

/* Tells whether the root has a guess that lies inside the bracket, clear of its ends. */
static bool has_guess(const tvi_root *r) { return r->guess > r->a + CHORD && r->guess < r->b - CHORD; }

/* Tells whether the distance `way` from a point is short, also relative to the distance from a and b. */
static bool is_short(const tvi_root *r, double from, double way)
{
    return fabs(way) <= fmin(LEAST_WAY, NEAR * fmin(from + way - r->a, r->b - (from + way)));
}

/* The distance of the curve from s->base in these components, relative to the largest of them. */
static double distance_of(const tvi_finder *s, int from, int count)
{
    double apart = 0, size = 0;
    for (int i = from; i < from + count; i++) {
        apart = fmax(apart, fabs(s->base[i] - s->middle[i]));
        size = fmax(size, fabs(s->base[i]));
    }
    return tvi_ratio(apart, size);
}

/* The relative distance in the time, which may be 0 at s->base. */
static double time_distance(const tvi_finder *s)
{
    const int t = s->size - 1;
    return tvi_ratio(fabs(s->base[t] - s->middle[t]), fabs(s->base[t]) + fabs(s->rate[t]));
}

/* Copies the last state of s->search->between, at theta, to s->base. */
static void copy_between(tvi_finder *s, double theta)
{
    tvi_between_copy(s->search->between, s->base);
    s->base_at = theta;
}

/* ---- On a line --------------------------------------------------------------------------------------------------- */

/* Sets x [2n + 1] = s->base + way s->rate, and *g to the value there. */
static tvi_status value_ahead(tvi_finder *s, int which, double way, double x[], double *g)
{
    for (int i = 0; i < s->size; i++) x[i] = s->base[i] + way * s->rate[i];
    return tvi_search_value(s->search, which, x, g);
}

typedef struct {
    tvi_finder *s;
    int which;
} on_line;

static tvi_status value_on_line(void *ctx, double way, double *g)
{
    const on_line *line = ctx;
    return value_ahead(line->s, line->which, way, line->s->trial, g);
}

/* Brackets the sign change of g around `way`, within the step and no farther than FARTHEST. The bracket has one sign
 * only if g does not change there. */
static tvi_status enclose(tvi_finder *s, const tvi_root *r, double way, tvi_bracket *z)
{
    const double low = fmax(-s->base_at, -FARTHEST), high = fmin(1 - s->base_at, FARTHEST);
    double width = SURE;
    z->a = fmin(fmax(way - width, low), high), z->b = fmin(fmax(way + width, low), high);
    tvi_status status = value_ahead(s, r->which, z->a, s->trial, &z->ga);
    while (status == TVI_OK && tvi_is_behind(r, z->ga) && z->a > low) {
        z->b = z->a, z->gb = z->ga;
        z->a = fmax(z->a - (width *= WIDER), low);
        status = value_ahead(s, r->which, z->a, s->trial, &z->ga);
    }
    if (status != TVI_OK || width > SURE) return status;
    status = value_ahead(s, r->which, z->b, s->trial, &z->gb);
    while (status == TVI_OK && !tvi_is_behind(r, z->gb) && z->b < high) {
        z->a = z->b, z->ga = z->gb;
        z->b = fmin(z->b + (width *= WIDER), high);
        status = value_ahead(s, r->which, z->b, s->trial, &z->gb);
    }
    return status;
}

/* Sets *way to the distance from s->base to the root on the line, if s->is_enclosed. g is the value at s->base, and
 * slope that of g along the line, which may be any number. */
static tvi_status root_on_line(tvi_finder *s, const tvi_root *r, double g, double slope, double *way)
{
    double next;
    tvi_bracket z = {0};
    const double first = -g / slope;
    *way = fabs(first) <= FARTHEST ? first : 0;
    tvi_status status = value_ahead(s, r->which, *way, s->trial, &next);
    const double second = *way - next / slope;
    if (fabs(next) < fabs(g) && fabs(second) <= FARTHEST) *way = second;
    if (status == TVI_OK) status = enclose(s, r, *way, &z);
    s->is_enclosed = status == TVI_OK && !tvi_is_behind(r, z.ga) && tvi_is_behind(r, z.gb);
    if (!s->is_enclosed || z.b - z.a <= 2 * SURE) return status;
    status = tvi_narrow(&z, DBL_EPSILON / 4, value_on_line, &(on_line){s, r->which});
    *way = z.b;
    return status;
}

/* Sets the event to the point at this distance on the line. */
static void settle(const tvi_finder *s, tvi_root *r, double way, double x[])
{
    r->theta = s->base_at + way;
    for (int i = 0; i < s->size; i++) x[i] = s->base[i] + way * s->rate[i];
}

/* Sets the event to theta, by a step over a part of h. */
static tvi_status settle_at(tvi_finder *s, tvi_root *r, double theta, double x[])
{
    const tvi_status status = tvi_between_state(s->search->between, theta * s->search->it->h);
    copy_between(s, theta);
    if (status == TVI_OK) settle(s, r, 0, x);
    return status;
}

/* Sets s->base to the state at theta, by a step over a part of h, and s->reach to the distance over which the slope of
 * the curve makes no error that shows. */
static tvi_status set_base(tvi_finder *s, double theta)
{
    const int n = s->search->it->system->n;
    const tvi_status status = tvi_between_state(s->search->between, theta * s->search->it->h);
    if (status != TVI_OK) return status;
    copy_between(s, theta);
    const double apart = fmax(fmax(distance_of(s, 0, n), distance_of(s, n, n)), time_distance(s));
    s->reach = s->is_inside ? fmin(REACH, DBL_EPSILON / (8 * STEEPER) / apart) : 0;
    return TVI_OK;
}

static tvi_status value_of_step(void *ctx, double theta, double *g)
{
    const on_line *at = ctx;
    tvi_finder *s = at->s;
    const tvi_status status = set_base(s, theta);
    return status == TVI_OK ? tvi_search_value(s->search, at->which, s->base, g) : status;
}

/* Finds the root by steps over parts of h in the bracket that the curve gives, or beside it. It is used if no line has
 * the root, or if lines converge slowly. */
static tvi_status find_by_steps(tvi_finder *s, tvi_root *r, double x[])
{
    on_line at = {s, r->which};
    tvi_bracket z = {r->a, 0, r->b, 0};
    tvi_status status = value_of_step(&at, z.a, &z.ga);
    if (status == TVI_OK) status = value_of_step(&at, z.b, &z.gb);
    while (status == TVI_OK && tvi_is_behind(r, z.ga) && z.a > 0) {
        z.b = z.a, z.gb = z.ga;
        z.a = fmax(z.a - tvi_sample_theta[0], 0);
        status = value_of_step(&at, z.a, &z.ga);
    }
    while (status == TVI_OK && !tvi_is_behind(r, z.gb) && z.b < 1) {
        z.a = z.b, z.ga = z.gb;
        z.b = fmin(z.b + tvi_sample_theta[0], 1);
        status = value_of_step(&at, z.b, &z.gb);
    }
    if (status != TVI_OK) return status;
    r->is_none = tvi_is_behind(r, z.ga) || !tvi_is_behind(r, z.gb);
    if (r->is_none) return TVI_OK;
    status = tvi_narrow(&z, DBL_EPSILON / 4, value_of_step, &at);
    return status == TVI_OK ? settle_at(s, r, z.b, x) : status;
}

/* Finds the root on the curve, and then on lines. Each line starts at the root on the line before, until two roots are
 * near. */
static tvi_status polish(tvi_finder *s, tvi_root *r, double x[])
{
    double theta = r->guess, g = 0, slope, way = 0, ahead = 0;
    tvi_status status = TVI_OK;
    if (has_guess(r)) status = set_slopes(s, r->which, theta, &slope, &ahead);
    if (status == TVI_OK && has_guess(r) && is_short(r, theta, ahead)) theta += ahead;
    else if (status == TVI_OK) status = tvi_search_zero(s->search, r, &theta);
    for (int k = 0; k < MOST_LINES && status == TVI_OK; k++) {
        status = set_slopes(s, r->which, theta, &slope, &ahead);
        if (status == TVI_OK) status = value_of_step(&(on_line){s, r->which}, theta, &g);
        if (status == TVI_OK) status = root_on_line(s, r, g, slope, &way);
        if (status != TVI_OK) return status;
        if (!s->is_enclosed) break;
        if (fabs(way) <= fmax(s->reach, DBL_EPSILON)) {
            settle(s, r, way, x);
            return TVI_OK;
        }
        theta = fmin(fmax(theta + way, 0), 1);
    }
    return status == TVI_OK ? find_by_steps(s, r, x) : status;
}

/* ---- By rates ---------------------------------------------------------------------------------------------------- */

/* Sets s->rate to the rates of the field at a state, for a unit of theta. */
static tvi_status rates_at(tvi_finder *s, const double x[])
{
    const int last = s->size - 1;
    const double h = s->search->it->h;
    const tvi_status status = tvi_rates_at(&s->rates, x, s->rate);
    for (int i = 0; i < last; i++) s->rate[i] *= h;
    s->rate[last] = h;
    return status;
}

/* Finds the event from a good guess by one step over a part of h, if the field's rates are accurate enough for the rest
 * of the way. For a way longer than 0 the rates are taken in its middle. */
static tvi_status polish_by_rates(tvi_finder *s, tvi_root *r, double x[], bool *is_done)
{
    double g = 0, before = 0, after = 0, found = 0;
    const double h = s->search->it->h;
    tvi_status status = tvi_between_state(s->search->between, r->guess * h);
    if (status != TVI_OK) return status;
    copy_between(s, r->guess);
    status = rates_at(s, s->base);
    if (status == TVI_OK) status = tvi_search_value(s->search, r->which, s->base, &g);
    if (status == TVI_OK) status = value_ahead(s, r->which, -CHORD, s->trial, &before);
    if (status == TVI_OK) status = value_ahead(s, r->which, CHORD, s->trial, &after);
    const double slope = (after - before) / (2 * CHORD), way = -g / slope;
    const double tail = fmax(s->search->it->stats.tail, s->search->between->partial_integrator->stats.tail),
                 error = tail * tail;
    if (status != TVI_OK || !(fabs(way) * error <= DBL_EPSILON / 8 && is_short(r, r->guess, way))) return status;
    if (fabs(way) > REACH) {
        for (int i = 0; i < s->size; i++) s->trial[i] = s->base[i] + way / 2 * s->rate[i];
        status = rates_at(s, s->trial);
    }
    if (status == TVI_OK) status = root_on_line(s, r, g, slope, &found);
    if (status == TVI_OK) settle(s, r, found, x);
    *is_done = status == TVI_OK && s->is_enclosed && fabs(found - way) <= REACH && tvi_all_finite(s->size, x);
    return status;
}

/* Tells whether the method's solution follows the field up to the square of the tail. */
static bool knows_rates(const tvi_finder *s)
{
    const tvi_integrator *it = s->search->it;
    return s->rates.block && !tvi_is_rescaled(it) && it->stepper->is_superconvergent && it->options.degree > 1;
}

/* ---- Events ------------------------------------------------------------------------------------------------------ */

/* Sets *g to the rise of g since the event that the step began on, divided by theta. The quotient is nearly linear if
 * theta is small. */
static tvi_status rise_over_way(void *ctx, double theta, double *g)
{
    const on_line *at = ctx;
    double rise = 0;
    bool known;
    const tvi_status status = tvi_start_rise(at->s->search, at->which, theta, &rise, &known);
    *g = rise / theta;
    return status;
}

/* Finds a return to the event that the step began on. The curve may return sooner than the method's own solution
 * does. */
static tvi_status find_return(tvi_finder *s, tvi_root *r, double x[])
{
    on_line at = {s, r->which};
    const double first = s->search->watch[r->which].left_at;
    tvi_bracket z = {.a = first, .b = fmax(r->b, first)};
    tvi_status status = rise_over_way(&at, z.a, &z.ga);
    if (status == TVI_OK) status = rise_over_way(&at, z.b, &z.gb);
    while (status == TVI_OK && !tvi_is_behind(r, z.gb) && z.b < 1) {
        z.b = fmin(z.b + tvi_sample_theta[0], 1);
        status = rise_over_way(&at, z.b, &z.gb);
    }
    if (status != TVI_OK) return status;
    r->is_none = !tvi_is_behind(r, z.gb);
    if (r->is_none) return TVI_OK;
    status = tvi_narrow(&z, DBL_EPSILON / 4 * first, rise_over_way, &at);
    return status == TVI_OK ? settle_at(s, r, z.b, x) : status;
}

tvi_status tvi_finder_find(tvi_finder *s, tvi_root *r, double x[])
{
    bool is_done = false;
    tvi_status status = TVI_OK;
    if (r->is_return) return find_return(s, r, x);
    if (r->b == 1 && r->gb == 0) return settle_at(s, r, 1, x);
    if (has_guess(r) && knows_rates(s)) status = polish_by_rates(s, r, x, &is_done);
    return is_done || status != TVI_OK ? status : polish(s, r, x);
}
