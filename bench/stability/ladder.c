/* ladder.c - Makes steps from far too large to small, with and without the guard (ladder.h). */
#include "ladder.h"
#include "baselines/baseline.h"
#include "scenes/hard.h"

#include <math.h>
#include <string.h>

#define REVOLUTION 6.2831853071795865

const ladder_case ladder_cases[] = {
    {"Kepler, e = 0.36", &scene_kepler, 3.9616},
    {"Kepler, e = 0.6", &kepler_60.scene, REVOLUTION},
    {"Kepler, e = 0.9", &kepler_90.scene, REVOLUTION},
    {"Kepler, e = 0.99", &kepler_99.scene, REVOLUTION},
    {"Henon-Heiles, H = 1/6", &henon_heiles_6.scene, REVOLUTION},
    {"Double pendulum", &scene_double_pendulum, 2.5},
    {"Fermi-Pasta-Ulam", &scene_fpu, 10},
    {"Stiff spring pendulum", &spring_pendulum.scene, 2},
    {"Three planets, an encounter", &hard_three_planets.scene, REVOLUTION},
    {"Pythagorean, first encounter", &hard_pythagorean.scene, 2},
    {.problem = NULL},
};

typedef struct {
    double t, q[BASELINE_N_MAX], p[BASELINE_N_MAX];
} state;

typedef struct {
    tvi_system *system;
    tvi_integrator *looks, *blind, *exact; /* exact: Taylor's method to a tolerance */
    const scene *problem;
    double scale; /* of the energy */
    ladder_counts counts;
} climber;

hard_method ladder_method(const char *name, int place)
{
    static const int orders[LADDER_ORDERS] = {8, 16};
    hard_method m = {.name = name, .order = orders[place]};
    tvi_options options;
    if (tvi_options_named(name, m.order, &options) == TVI_OK) return m;
    m.order = place == 0 && tvi_options_named(name, 2, &options) == TVI_OK ? 2 : 0;
    return m;
}

bool ladder_is_explicit(const hard_method *m) { return strcmp(m->name, "stormer-verlet") == 0; }

void ladder_add(ladder_counts *sum, const ladder_counts *more)
{
    sum->accepted += more->accepted;
    sum->wrong += more->wrong;
    sum->refused += more->refused;
    sum->right += more->right;
    sum->near += more->near;
    sum->unread += more->unread;
    sum->failed += more->failed;
    sum->most = fmax(sum->most, more->most);
}

static double energy_of(const climber *c, const state *x)
{
    double H;
    return tvi_energy(c->system, x->t, x->q, x->p, &H) == TVI_OK ? H : INFINITY;
}

static void begin(climber *c, const state *x) { c->scale = fmax(fabs(energy_of(c, x)), c->problem->energy_scale); }

static double relative(int n, const double a[], const double b[])
{
    double apart = 0, size = 0;
    for (int i = 0; i < n; i++) {
        apart = fmax(apart, fabs(a[i] - b[i]));
        size = fmax(size, fabs(b[i]));
    }
    return apart / size;
}

static tvi_status step(tvi_integrator *it, double h, state *x) { return tvi_step(it, h, &x->t, x->q, x->p); }

/* From x to where the solution is h later. */
static bool follow(const climber *c, double h, state *x)
{
    static const double tolerance = 1e-12;
    return tvi_integrate_tolerance(c->exact, tolerance, x->t + h, &x->t, x->q, x->p, NULL, NULL) == TVI_OK;
}

/* One that was refused, beside the solution: NULL where there is none. */
static void judge(climber *c, const state *made, const state *solution, double change)
{
    c->counts.refused++;
    if (!solution || !made) {
        c->counts.unread += made != NULL;
        return;
    }
    const bool is_near = relative(c->problem->n, made->q, solution->q) < LADDER_RIGHT &&
                         relative(c->problem->n, made->p, solution->p) < LADDER_RIGHT;
    const bool keeps_energy = change < LADDER_RIGHT;
    c->counts.right += is_near && keeps_energy;
    c->counts.near += is_near && !keeps_energy;
}

/* A step of both; false where there is nothing to go on from. */
static bool climb_step(climber *c, double h, state *x)
{
    const double before = energy_of(c, x);
    state seen = *x, made = *x, solution = *x;
    const tvi_status status = step(c->looks, h, &seen), blind = step(c->blind, h, &made);
    const double after =
        energy_of(c, status == TVI_OK ? &seen : &made); /* the blind one's passes may have another past */
    const double change = fabs(after - before) / fmax(fabs(before), c->scale);
    if (status == TVI_OK) {
        c->counts.accepted++;
        c->counts.wrong += !(change <= LADDER_WRONG);
        c->counts.most = fmax(c->counts.most, change);
        *x = seen;
        return true;
    }
    const bool goes_on = follow(c, h, &solution);
    if (status == TVI_ETOOLARGE) judge(c, blind == TVI_OK ? &made : NULL, goes_on ? &solution : NULL, change);
    else c->counts.failed++;
    *x = solution;
    begin(c, x);
    return goes_on;
}

static bool open_integrator(const climber *c, const hard_method *m, double max_tail, tvi_integrator **out)
{
    tvi_options options;
    if (!hard_options(m, &options)) return false;
    options.max_tail = max_tail;
    return tvi_integrator_create(out, c->system, &options) == TVI_OK;
}

/* An integrator that is not made is NULL, which may be freed. */
static bool open_climber(climber *c, const scene *s, const hard_method *m)
{
    static const hard_method taylor = {"taylor", 16, false};
    return scene_system(s, &c->system) == TVI_OK && open_integrator(c, m, 0, &c->looks) &&
           open_integrator(c, m, -1, &c->blind) && open_integrator(c, &taylor, -1, &c->exact);
}

ladder_counts ladder_climb(const ladder_case *problem, const hard_method *m, double h, int steps)
{
    const scene *s = problem->problem;
    climber c = {.problem = s};
    state x = {0};
    memcpy(x.q, s->q, (size_t)s->n * sizeof *x.q);
    memcpy(x.p, s->p, (size_t)s->n * sizeof *x.p);
    if (open_climber(&c, s, m)) {
        begin(&c, &x);
        for (int i = 0; i < steps && climb_step(&c, h, &x); i++) continue;
    }
    tvi_integrator_free(c.looks);
    tvi_integrator_free(c.blind);
    tvi_integrator_free(c.exact);
    tvi_system_free(c.system);
    return c.counts;
}
