/* legendre.c - Transforms velocities to momenta and back at a point, by Newton's method. */
#include "system/legendre.h"
#include "algebra/passes.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void tvi_legendre_take(tvi_legendre *legendre, tvi_arena *arena, const tvi_system *system)
{
    const size_t slots = (size_t)system->field_series->slots, n = (size_t)system->n;
    legendre->system = system;
    legendre->x = tvi_arena_block(arena, system->field_series, 1, 1, 0);
    legendre->dx = tvi_arena_doubles(arena, slots * n);
    legendre->correction = tvi_arena_doubles(arena, n);
    legendre->moved = tvi_arena_doubles(arena, n);
    legendre->value = tvi_arena_doubles(arena, n);
    tvi_factor_take(&legendre->slope, arena, system->n);
    tvi_roundoff_take(&legendre->roundoff, arena, system);
}

void tvi_legendre_prepare(tvi_legendre *legendre)
{
    const int n = legendre->system->n;
    for (int i = 0; i < n; i++) legendre->dx[(n + i) * n + i] = 1;
}

tvi_status tvi_legendre_state(tvi_legendre *legendre, double t, const double q[], const double x[], double y[])
{
    const tvi_system *system = legendre->system;
    const jet_tape *tape = system->field_series;
    const int n = system->n;
    if (system->form == TVI_SEPARABLE) {
        for (int i = 0; i < n; i++) y[i] = system->mass[i] * x[i];
        return TVI_OK;
    }
    memcpy(legendre->x, q, (size_t)n * sizeof *q);
    memcpy(legendre->x + n, x, (size_t)n * sizeof *x);
    tvi_system_set_time(system, legendre->x, 1, &t);
    if (!jet_sweep_values(tape, legendre->x, 1)) return TVI_EDOMAIN;
    for (int i = 0; i < n; i++) {
        y[i] = legendre->x[tape->output[n + i]];
        if (!isfinite(y[i])) return TVI_ENONFINITE;
    }
    return TVI_OK;
}

/* Factors dy/dx at the point where the transform was evaluated last. */
static tvi_status factor_slope(tvi_legendre *legendre)
{
    const jet_tape *tape = legendre->system->field_series;
    const int n = legendre->system->n;
    jet_sweep_tangents(tape, legendre->x, legendre->dx, 0, n);
    for (int i = 0; i < n; i++)
        memcpy(legendre->slope.lu + (size_t)i * (size_t)n, legendre->dx + (size_t)tape->output[n + i] * (size_t)n,
               (size_t)n * sizeof(double));
    return tvi_factor_compute(&legendre->slope);
}

/* A solution leaves at most this part of y - f(x). One that runs off to infinity leaves much. */
static const double SOLVED = 1e-6;
enum { NEWTON_STEPS = 100, HALVINGS = 40, GROWTH_HALVINGS = 12 };

/* y - f(x)| in the maximum norm, with f(x) in legendre->value. */
static double distance(const tvi_legendre *legendre, const double y[])
{
    double largest = 0;
    for (int i = 0; i < legendre->system->n; i++) largest = fmax(largest, fabs(y[i] - legendre->value[i]));
    return largest;
}

/* Adds the correction to x, halved until f(x) has a value that is nearer to y than `from`. At the level of roundoff it
 * may not be nearer. */
static tvi_status move(tvi_legendre *legendre, double t, const double q[], const double y[], double from, double x[])
{
    const int n = legendre->system->n;
    tvi_status status = TVI_OK;
    for (int halving = 0; halving < HALVINGS; halving++) {
        for (int i = 0; i < n; i++) legendre->moved[i] = x[i] + legendre->correction[i];
        status = tvi_legendre_state(legendre, t, q, legendre->moved, legendre->value);
        if (status == TVI_OK && (distance(legendre, y) < from || halving >= GROWTH_HALVINGS)) break;
        for (int i = 0; i < n; i++) legendre->correction[i] /= 2;
    }
    if (status == TVI_OK) memcpy(x, legendre->moved, (size_t)n * sizeof *x);
    return status;
}

/* Computes the Newton correction at x, with a new slope or with the last one. A singular slope, as of v^4 at rest, is
 * replaced by the identity. */
static tvi_status find_correction(tvi_legendre *legendre, const double y[], bool is_new)
{
    const int n = legendre->system->n;
    for (int i = 0; i < n; i++) legendre->correction[i] = y[i] - legendre->value[i];
    const tvi_status status = is_new ? factor_slope(legendre) : TVI_OK;
    if (status == TVI_OK) tvi_factor_solve(&legendre->slope, legendre->correction);
    return status;
}

/* The slope is kept after corrections that leave less than this part. */
static const double SERVES = 1e-3;

/* Corrections that no longer shrink are roundoff if they are below this part of x, or below TVI_ROUNDOFF_UNITS units of
 * what the roundoff of y and f(x) makes of them. */
static const double STALLED = 1e-12;

/* Estimates the roundoff of the corrections. */
static double measure_roundoff(tvi_legendre *legendre, const double y[])
{
    const tvi_system *system = legendre->system;
    tvi_roundoff *roundoff = &legendre->roundoff;
    (void)tvi_roundoff_of_field(roundoff, system, legendre->x, 1, 1);
    for (int i = 0; i < system->n; i++)
        legendre->moved[i] = tvi_roundoff_sign(roundoff, roundoff->change[system->n + i] + DBL_EPSILON * fabs(y[i]));
    tvi_factor_solve(&legendre->slope, legendre->moved);
    return TVI_ROUNDOFF_UNITS * tvi_largest(system->n, legendre->moved, 1);
}

/* Tells whether this correction is the last one. */
static bool is_last(tvi_legendre *legendre, const double x[], const double y[], tvi_passes *passes)
{
    const double size = tvi_largest(legendre->system->n, x, 1);
    const tvi_passes_rule rule = {.goal = DBL_EPSILON * size, .contraction = 0.5, .stuck = TVI_PASSES_ALL, .period = 1};
    const double largest = tvi_largest(legendre->system->n, legendre->correction, 1);
    const tvi_passes_verdict verdict = tvi_passes_judge(passes, &rule, largest);
    if (verdict != TVI_PASSES_STUCK) return verdict == TVI_PASSES_MAY_END;
    return largest <= STALLED * size || tvi_passes_are_roundoff(passes, measure_roundoff(legendre, y));
}

tvi_status tvi_legendre_solve(tvi_legendre *legendre, double t, const double q[], const double y[], double x[])
{
    const int n = legendre->system->n;
    if (legendre->system->form == TVI_SEPARABLE) {
        for (int i = 0; i < n; i++) x[i] = y[i] / legendre->system->mass[i];
        return TVI_OK;
    }
    /* |y| at first. `served` is the distance at which the last slope is still good enough; below 0: there is none. */
    double reach = tvi_largest(n, y, 1), served = -1;
    tvi_passes passes;
    bool was_singular = false;
    tvi_passes_begin(&passes, 0);
    tvi_status status = tvi_legendre_state(legendre, t, q, x, legendre->value);
    if (status == TVI_OK) reach = fmax(reach, tvi_largest(n, legendre->value, 1));
    for (int step = 0; step < NEWTON_STEPS && status == TVI_OK; step++) {
        const double left = distance(legendre, y);
        status = find_correction(legendre, y, !(left <= served));
        const bool is_singular = status == TVI_ESINGULAR && !was_singular && left > 0;
        if (status != TVI_OK && !is_singular) return status;
        was_singular |= is_singular;
        served = is_singular ? -1 : SERVES * left;
        if (!is_singular && is_last(legendre, x, y, &passes)) {
            for (int i = 0; i < n; i++) x[i] += legendre->correction[i];
            if (!tvi_all_finite(n, x)) return TVI_ENONFINITE;
            return left <= SOLVED * reach ? TVI_OK : TVI_ENOCONV;
        }
        status = move(legendre, t, q, y, left, x);
    }
    return status == TVI_OK ? TVI_ENOCONV : status;
}

tvi_status tvi_legendre_start(tvi_legendre *legendre, const tvi_system *system, double tau, double t, const double q[],
                              const double p[], double velocity[], double z[])
{
    const int n = system->n;
    double *z_v = z + n;
    memcpy(z, q, (size_t)n * sizeof *z);
    switch (system->form) {
    case TVI_SEPARABLE:
        for (int i = 0; i < n; i++) z_v[i] = tau / system->mass[i] * p[i];
        return TVI_OK;
    case TVI_HAMILTONIAN: memcpy(z_v, p, (size_t)n * sizeof *z_v); return TVI_OK;
    default: break;
    }
    const bool is_at_rest = tvi_largest(n, velocity, 1) == 0;
    tvi_status status = tvi_legendre_solve(legendre, t, q, p, velocity);
    if (status != TVI_OK && !is_at_rest) { /* the Lagrangian may have no value at the end of a curve */
        memset(velocity, 0, (size_t)n * sizeof *velocity);
        status = tvi_legendre_solve(legendre, t, q, p, velocity);
    }
    for (int i = 0; i < n; i++) {
        z_v[i] = tau * velocity[i];
        if (status != TVI_OK) velocity[i] = 0; /* the next solution does not start from this velocity */
    }
    return status;
}

tvi_status tvi_legendre_create(tvi_legendre *legendre, const tvi_system *system, const double parameters[],
                               void **memory)
{
    tvi_arena arena = {0};
    tvi_legendre_take(legendre, &arena, system);
    *memory = tvi_arena_open(&arena);
    if (!*memory) return TVI_ENOMEM;
    tvi_legendre_take(legendre, &arena, system);
    tvi_system_prepare(system, arena.blocks, parameters);
    if (system->form != TVI_SEPARABLE) tvi_legendre_prepare(legendre);
    return TVI_OK;
}

enum { PROBES = 8 };
/* A pivot of a singular matrix is roundoff, which may not be exactly 0. */
static const double CLEARLY_REGULAR = 1e-9;

/* Evaluates the slope at pseudo-random points in (-1, 1), the same in each call. A point without a value tells
 * nothing. */
tvi_status tvi_legendre_probe(tvi_system *system)
{
    system->regular = true;
    if (system->form == TVI_SEPARABLE) return TVI_OK;
    tvi_legendre legendre;
    void *memory;
    const tvi_status status = tvi_legendre_create(&legendre, system, NULL, &memory);
    double *point = malloc(3 * (size_t)system->n * sizeof *point);
    if (status == TVI_OK && point) {
        unsigned random = 1;
        bool stated = false, regular = false;
        for (int probe = 0; probe < PROBES && !regular; probe++) {
            for (int i = 0; i < 2 * system->n; i++) {
                random = random * 1664525u + 1013904223u;
                point[i] = (random >> 8) * (2.0 / (1 << 24)) - 1;
            }
            if (tvi_legendre_state(&legendre, 0.5, point, point + system->n, point + 2 * system->n) != TVI_OK) continue;
            stated = true;
            regular = factor_slope(&legendre) == TVI_OK && tvi_factor_least_pivot(&legendre.slope) > CLEARLY_REGULAR;
        }
        system->regular = regular || !stated;
    }
    if (status == TVI_OK) free(memory);
    free(point);
    if (status != TVI_OK || !point) return TVI_ENOMEM;
    if (system->regular || system->form != TVI_LAGRANGIAN) return TVI_OK;
    return jet_refuse(TVI_ESINGULAR, "L_vv of the Lagrangian is singular at all of %d points", PROBES);
}
