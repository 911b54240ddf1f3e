/* legendre.c - velocities, momenta and the energy at a point. */
#include "legendre.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void tvi_legendre_take(tvi_legendre *legendre, tvi_arena *arena, const tvi_system *system)
{
    const size_t slots = (size_t)system->field_series->slots, n = (size_t)system->n;
    legendre->system = system;
    legendre->x = tvi_arena_doubles(arena, slots);
    legendre->dx = tvi_arena_doubles(arena, slots * n);
    legendre->correction = tvi_arena_doubles(arena, n);
    legendre->moved = tvi_arena_doubles(arena, n);
    legendre->value = tvi_arena_doubles(arena, n);
    tvi_factor_take(&legendre->slope, arena, system->n);
}

void tvi_legendre_prepare(tvi_legendre *legendre)
{
    const jet_tape *tape = legendre->system->field_series;
    const int n = legendre->system->n;
    jet_tape_prepare(tape, legendre->x, 1, 1);
    memset(legendre->dx, 0, (size_t)tape->slots * (size_t)n * sizeof *legendre->dx);
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

/* Factors dy/dx where the transform was last stated. */
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

enum { NEWTON_STEPS = 50, HALVINGS = 40 };

/* x += correction, halved until the transform has a value there. */
static tvi_status move(tvi_legendre *legendre, double t, const double q[], double x[])
{
    const int n = legendre->system->n;
    tvi_status status = TVI_OK;
    for (int halving = 0; halving < HALVINGS; halving++) {
        for (int i = 0; i < n; i++) legendre->moved[i] = x[i] + legendre->correction[i];
        status = tvi_legendre_state(legendre, t, q, legendre->moved, legendre->value);
        if (status == TVI_OK) break;
        for (int i = 0; i < n; i++) legendre->correction[i] /= 2;
    }
    if (status == TVI_OK) memcpy(x, legendre->moved, (size_t)n * sizeof *x);
    return status;
}

tvi_status tvi_legendre_solve(tvi_legendre *legendre, double t, const double q[], const double y[], double x[])
{
    const int n = legendre->system->n;
    if (legendre->system->form == TVI_SEPARABLE) {
        for (int i = 0; i < n; i++) x[i] = y[i] / legendre->system->mass[i];
        return TVI_OK;
    }
    double before = INFINITY;
    tvi_status status = tvi_legendre_state(legendre, t, q, x, legendre->value);
    for (int step = 0; step < NEWTON_STEPS && status == TVI_OK; step++) {
        for (int i = 0; i < n; i++) legendre->correction[i] = y[i] - legendre->value[i];
        status = factor_slope(legendre);
        if (status != TVI_OK) return status;
        tvi_factor_solve(&legendre->slope, legendre->correction);
        status = move(legendre, t, q, x);
        double size = 0, correction = 0;
        for (int i = 0; i < n; i++) {
            size = fmax(size, fabs(x[i]));
            correction = fmax(correction, fabs(legendre->correction[i]));
        }
        if (correction <= DBL_EPSILON * size || (correction >= before && correction <= 1e-12 * size)) return status;
        before = correction;
    }
    return status == TVI_OK ? TVI_ENOCONV : status;
}

tvi_status tvi_legendre_start(tvi_legendre *legendre, const tvi_system *system, double tau, const tvi_origin *origin,
                              double velocity[], double z[])
{
    const int n = system->n;
    double *second = z + n;
    memcpy(z, origin->q, (size_t)n * sizeof *z);
    switch (system->form) {
    case TVI_SEPARABLE:
        for (int i = 0; i < n; i++) second[i] = tau / system->mass[i] * origin->p[i];
        return TVI_OK;
    case TVI_HAMILTONIAN:
        memcpy(second, origin->p, (size_t)n * sizeof *second);
        return TVI_OK;
    default: break;
    }
    const tvi_status status = tvi_legendre_solve(legendre, origin->t, origin->q, origin->p, velocity);
    for (int i = 0; i < n; i++) {
        second[i] = tau * velocity[i];
        if (status != TVI_OK) velocity[i] = 0; /* do not start from there again */
    }
    return status;
}

/* ---- What is asked of a system, outside of steps -------------------------------------------------------------------- */

static tvi_status legendre_create(tvi_legendre *legendre, const tvi_system *system, void **memory)
{
    tvi_arena arena = {NULL, 0};
    tvi_legendre_take(legendre, &arena, system);
    arena = (tvi_arena){malloc(arena.used), 0};
    if (!arena.base) return TVI_ENOMEM;
    tvi_legendre_take(legendre, &arena, system);
    if (system->form != TVI_SEPARABLE) tvi_legendre_prepare(legendre);
    *memory = arena.base;
    return TVI_OK;
}

enum { PROBES = 8 };

/* At points from a fixed pseudo-random sequence in (-1, 1); a point where the function has no value tells nothing. */
tvi_status tvi_legendre_probe(tvi_system *system)
{
    system->regular = true;
    if (system->form == TVI_SEPARABLE) return TVI_OK;
    tvi_legendre legendre;
    void *memory;
    const tvi_status status = legendre_create(&legendre, system, &memory);
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
            regular = factor_slope(&legendre) == TVI_OK;
        }
        system->regular = regular || !stated;
    }
    if (status == TVI_OK) free(memory);
    free(point);
    if (status != TVI_OK || !point) return TVI_ENOMEM;
    return system->form == TVI_LAGRANGIAN && !system->regular ? TVI_ESINGULAR : TVI_OK;
}

static bool all_finite(int n, const double x[])
{
    for (int i = 0; i < n; i++)
        if (!isfinite(x[i])) return false;
    return true;
}

/* out = momenta of velocities, or velocities of momenta. */
static tvi_status transform(const tvi_system *system, double t, const double q[], const double in[], double out[],
                            bool to_momenta)
{
    if (!system || !q || !in || !out) return TVI_EINVAL;
    const int n = system->n;
    if (!isfinite(t) || !all_finite(n, q) || !all_finite(n, in)) return TVI_ENONFINITE;
    tvi_legendre legendre;
    void *memory;
    tvi_status status = legendre_create(&legendre, system, &memory);
    if (status != TVI_OK) return status;
    double *result = calloc((size_t)n, sizeof *result);
    if (!result) status = TVI_ENOMEM;
    else if (to_momenta == (system->form != TVI_HAMILTONIAN)) status = tvi_legendre_state(&legendre, t, q, in, result);
    else status = tvi_legendre_solve(&legendre, t, q, in, result);
    if (status == TVI_OK && !all_finite(n, result)) status = TVI_ENONFINITE;
    if (status == TVI_OK) memcpy(out, result, (size_t)n * sizeof *out);
    free(result);
    free(memory);
    return status;
}

tvi_status tvi_momentum(const tvi_system *system, double t, const double q[], const double v[], double p[])
{
    return transform(system, t, q, v, p, true);
}

tvi_status tvi_velocity(const tvi_system *system, double t, const double q[], const double p[], double v[])
{
    return transform(system, t, q, p, v, false);
}

/* The value of the energy tape at (q, second, t); second NULL: zeros. */
static tvi_status energy_value(const tvi_system *system, double t, const double q[], const double second[], double *value)
{
    const jet_tape *tape = system->energy;
    const size_t n = (size_t)system->n;
    double *x = malloc((size_t)tape->slots * sizeof *x);
    if (!x) return TVI_ENOMEM;
    jet_tape_prepare(tape, x, 1, 1);
    memcpy(x, q, n * sizeof *x);
    if (second) memcpy(x + n, second, n * sizeof *x);
    if (tape->inputs > system->energy_inputs) x[system->energy_inputs] = t;
    const bool inside = jet_sweep_values(tape, x, 1);
    *value = x[tape->output[0]];
    free(x);
    return inside ? TVI_OK : TVI_EDOMAIN;
}

/* V is the energy tape at v = 0 or p = 0, up to the sign. */
static tvi_status separable_energy(const tvi_system *system, double t, const double q[], const double p[], double *H)
{
    const tvi_status status = energy_value(system, t, q, NULL, H);
    *H *= system->energy_sign;
    for (int i = 0; i < system->n; i++) *H += p[i] * p[i] / (2 * system->mass[i]);
    return status;
}

/* H = p.v - L(q, v). */
static tvi_status lagrangian_energy(const tvi_system *system, double t, const double q[], const double p[], double *H)
{
    double *v = malloc((size_t)system->n * sizeof *v);
    if (!v) return TVI_ENOMEM;
    tvi_status status = tvi_velocity(system, t, q, p, v);
    if (status == TVI_OK) status = energy_value(system, t, q, v, H);
    *H = -*H;
    for (int i = 0; status == TVI_OK && i < system->n; i++) *H += p[i] * v[i];
    free(v);
    return status;
}

tvi_status tvi_energy(const tvi_system *system, double t, const double q[], const double p[], double *H)
{
    if (!system || !q || !p || !H) return TVI_EINVAL;
    if (!system->energy) return TVI_EUNSUPPORTED;
    if (!isfinite(t) || !all_finite(system->n, q) || !all_finite(system->n, p)) return TVI_ENONFINITE;
    double energy = 0;
    tvi_status status;
    switch (system->form) {
    case TVI_SEPARABLE: status = separable_energy(system, t, q, p, &energy); break;
    case TVI_LAGRANGIAN: status = lagrangian_energy(system, t, q, p, &energy); break;
    default: status = energy_value(system, t, q, p, &energy);
    }
    if (status == TVI_OK && !isfinite(energy)) status = TVI_ENONFINITE;
    if (status == TVI_OK) *H = energy;
    return status;
}
