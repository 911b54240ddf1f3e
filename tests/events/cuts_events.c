/* cuts_events.c - Creates the events of runs at random. */
#include "cuts.h"
#include "problems/random.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static jet place(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *c = ctx;
    (void)p, (void)t;
    return jet_mul(c[1], jet_sub(q[0], c[0]));
}

static jet momentum(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *c = ctx;
    (void)q, (void)t;
    return jet_sub(p[0], c[2]);
}

static jet strobe(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *c = ctx; /* c[3] is the period */
    (void)q, (void)p;
    return jet_sin(jet_mul(2 * PI / c[3], t));
}

static jet radial(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(q[0], p[0]);
}

static jet kinked(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *c = ctx;
    (void)t;
    return jet_sub(jet_hypot(jet_sub(q[0], c[0]), jet_mul(0.1, jet_sub(p[0], c[2]))), 0.01);
}

static jet touching(const jet q[], const jet p[], jet t, void *ctx)
{
    const double *c = ctx;
    (void)p, (void)t;
    return jet_sqr(jet_sub(q[0], c[0]));
}

/* An event of some kind, or the one before it once more, to be told at the same time. */
void make_random_event(random_run *r, int i, uint64_t *bits, bool wants_touching, bool wants_terminal)
{
    static tvi_event_fn *const kinds[] = {place, momentum, strobe, radial, kinked, touching};
    const scene *s = r->pair->scene;
    double *c = r->numbers[i];
    const int kind = whole(bits, 5 + wants_touching);
    const bool is_same = i > 0 && number_of(bits) < 0.2, is_terminal = number_of(bits) < 0.15 && wants_terminal;
    c[0] = s->q[0] + (number_of(bits) - 0.5) * (0.1 + fabs(s->q[0]));
    c[1] = number_of(bits) < 0.5 ? 1 : 3;
    c[2] = s->p[0] + (number_of(bits) - 0.5) * (0.1 + fabs(s->p[0]));
    c[3] = fabs(r->h) * (number_of(bits) < 0.5 ? 1 + whole(bits, 20) : 0.7 + 20 * number_of(bits));
    if (r->kind == BY_TOLERANCE) c[3] *= 20; /* steps are so much larger, and a strobe has to be seen */
    if (is_same) memcpy(c, r->numbers[i - 1], sizeof r->numbers[i]), c[1] = 3;
    r->has_terminal |= is_terminal;
    const tvi_direction direction = (tvi_direction)(whole(bits, 3) - 1);
    tvi_event_fn *g = is_same ? place : kinds[kind];
    ck_assert_int_eq(tvi_event_create(&r->events[i], s->n, direction, is_terminal, g, c), TVI_OK);
}
