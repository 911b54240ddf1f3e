/* legendre.c - Transforms velocities to momenta and back at a point (legendre.h), by a damped Newton's method. */
#include "system/legendre.h"
#include "algebra/passes.h"
#include "algebra/sizes.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Constants found by trials ----------------------------------------------------------------------------------- */

/* [1] A solution x has |y - f(x)| at most this part of |y|, or of |f(x)| at the start if that is larger. If the
 * iteration runs off to infinity, the residual is large. */
#define LEGENDRE_MAX_RESIDUAL 1e-6 /* found: make check-generating */
/* [iterations] Newton's method for x in y = f(x) makes at most this many. */
#define LEGENDRE_MAX_ITERATIONS 100 /* found: make check-generating */
/* [halvings] A correction of x is halved at most this many times. */
#define LEGENDRE_MAX_HALVINGS 40 /* found: make check-generating */
/* [halvings] From this many on, f(x) may be farther from y than before. */
#define LEGENDRE_MAX_GROWTH_HALVINGS 12 /* found: make check-generating */
/* [1] The matrix dy/dx is reused if the residual is below this part of the residual for which the matrix was
 * computed. */
#define LEGENDRE_REUSE_MAX_RATIO 1e-3 /* found: make check-generating */
/* [1] Corrections that no longer shrink are roundoff if they are below this part of x. */
#define LEGENDRE_STALLED_CORRECTION 1e-12 /* found: make check-stability, suite equilibria */
/* [points] L_vv is tested for regularity at up to this many random points; it is regular if it is so at one of them. */
#define LEGENDRE_PROBES 8 /* found: make check-generating */
/* [1] L_vv is regular at a point if its least pivot is larger. The pivots of a singular matrix are roundoff, which may
 * not be exactly 0. */
#define LEGENDRE_REGULAR_MIN_PIVOT 1e-9 /* found: make check-generating */

void tvi_legendre_allocate(tvi_legendre_transform *legendre, tvi_arena *arena, const tvi_system *system)
{
    const size_t slots = (size_t)system->field_series->slot_count, n = (size_t)system->n;
    legendre->system = system;
    legendre->field_block = tvi_arena_allocate_block(arena, system->field_series, 1, 1, 0);
    legendre->tangents = tvi_arena_allocate_doubles(arena, slots * n);
    legendre->correction = tvi_arena_allocate_doubles(arena, n);
    legendre->trial = tvi_arena_allocate_doubles(arena, n);
    legendre->transform_of_x = tvi_arena_allocate_doubles(arena, n);
    tvi_factor_allocate(&legendre->jacobian_factor, arena, system->n);
    tvi_roundoff_allocate(&legendre->roundoff, arena, system);
}

tvi_status tvi_legendre_evaluate(tvi_legendre_transform *legendre, double t, const double q[], const double x[],
                                 double y[])
{
    const tvi_system *system = legendre->system;
    const jet_tape *tape = system->field_series;
    const int n = system->n;
    if (system->form == TVI_SEPARABLE) {
        for (int i = 0; i < n; i++) y[i] = system->mass[i] * x[i];
        return TVI_OK;
    }
    memcpy(legendre->field_block, q, (size_t)n * sizeof *q);
    memcpy(legendre->field_block + n, x, (size_t)n * sizeof *x);
    tvi_system_write_time(system, legendre->field_block, 1, &t);
    if (!jet_sweep_values(tape, legendre->field_block, 1)) return TVI_EDOMAIN;
    for (int i = 0; i < n; i++) {
        y[i] = legendre->field_block[tape->output_slot[n + i]];
        if (!isfinite(y[i])) return TVI_ENONFINITE;
    }
    return TVI_OK;
}

/* Computes and factors the Jacobian matrix dy/dx at the point where the transform was evaluated last. */
static tvi_status factor_jacobian(tvi_legendre_transform *legendre)
{
    const jet_tape *tape = legendre->system->field_series;
    const int n = legendre->system->n;
    for (int i = 0; i < n; i++) legendre->tangents[(n + i) * n + i] = 1;
    jet_sweep_tangents(tape, legendre->field_block, legendre->tangents, 0, n);
    for (int i = 0; i < n; i++)
        memcpy(legendre->jacobian_factor.lu + (size_t)i * (size_t)n,
               legendre->tangents + (size_t)tape->output_slot[n + i] * (size_t)n, (size_t)n * sizeof(double));
    return tvi_factor_compute(&legendre->jacobian_factor);
}

/* Returns |y - f(x)| in the maximum norm. legendre->transform_of_x is f(x). */
static double compute_residual_norm(const tvi_legendre_transform *legendre, const double y[])
{
    double largest = 0;
    for (int i = 0; i < legendre->system->n; i++) largest = fmax(largest, fabs(y[i] - legendre->transform_of_x[i]));
    return largest;
}

/* Adds the correction to x, halved until f(x) exists and is nearer to y than before. After
 * LEGENDRE_MAX_GROWTH_HALVINGS halvings it need not be nearer, since roundoff may prevent that. */
static tvi_status apply_damped_correction(tvi_legendre_transform *legendre, double t, const double q[],
                                          const double y[], double old_residual, double x[])
{
    const int n = legendre->system->n;
    tvi_status status = TVI_OK;
    for (int halving = 0; halving < LEGENDRE_MAX_HALVINGS; halving++) {
        for (int i = 0; i < n; i++) legendre->trial[i] = x[i] + legendre->correction[i];
        status = tvi_legendre_evaluate(legendre, t, q, legendre->trial, legendre->transform_of_x);
        if (status == TVI_OK &&
            (compute_residual_norm(legendre, y) < old_residual || halving >= LEGENDRE_MAX_GROWTH_HALVINGS))
            break;
        for (int i = 0; i < n; i++) legendre->correction[i] /= 2;
    }
    if (status == TVI_OK) memcpy(x, legendre->trial, (size_t)n * sizeof *x);
    return status;
}

/* Computes the Newton correction at x, with a new Jacobian matrix dy/dx if needs_new_jacobian is true, and otherwise
 * with the last one. If the new matrix is singular, as that of L = v^4 at rest, the correction is y - f(x) itself. */
static tvi_status compute_newton_correction(tvi_legendre_transform *legendre, const double y[], bool needs_new_jacobian)
{
    const int n = legendre->system->n;
    for (int i = 0; i < n; i++) legendre->correction[i] = y[i] - legendre->transform_of_x[i];
    const tvi_status status = needs_new_jacobian ? factor_jacobian(legendre) : TVI_OK;
    if (status == TVI_OK) tvi_factor_solve(&legendre->jacobian_factor, legendre->correction);
    return status;
}

/* Returns ROUNDOFF_MAX_UNITS times the size of a correction that the roundoff of y and f(x) causes. */
static double estimate_correction_roundoff(tvi_legendre_transform *legendre, const double y[])
{
    const tvi_system *system = legendre->system;
    tvi_roundoff_estimator *roundoff = &legendre->roundoff;
    (void)tvi_roundoff_estimate_field(roundoff, system, legendre->field_block, 1, 1);
    for (int i = 0; i < system->n; i++)
        legendre->trial[i] =
            tvi_roundoff_sign_randomly(roundoff, roundoff->output_roundoff[system->n + i] + DBL_EPSILON * fabs(y[i]));
    tvi_factor_solve(&legendre->jacobian_factor, legendre->trial);
    return ROUNDOFF_MAX_UNITS * tvi_largest_magnitude(system->n, legendre->trial, 1);
}

/* Tells whether the correction that was just computed is the last one. */
static bool is_last_correction(tvi_legendre_transform *legendre, const double x[], const double y[],
                               tvi_convergence_test *passes)
{
    const double size = tvi_largest_magnitude(legendre->system->n, x, 1);
    const tvi_stopping_rule rule = {.correction_goal = DBL_EPSILON * size,
                                    .max_trusted_ratio = PASSES_MAX_CONTRACTION,
                                    .stall_ratio = TVI_STALL_WITHOUT_DECREASE,
                                    .stall_comparison_lag = 1};
    const double largest = tvi_largest_magnitude(legendre->system->n, legendre->correction, 1);
    const tvi_passes_verdict verdict = tvi_convergence_add_pass(passes, &rule, largest);
    if (verdict != TVI_PASSES_STUCK) return verdict == TVI_PASSES_MAY_END;
    return largest <= LEGENDRE_STALLED_CORRECTION * size ||
           tvi_convergence_set_roundoff(passes, estimate_correction_roundoff(legendre, y));
}

tvi_status tvi_legendre_solve(tvi_legendre_transform *legendre, double t, const double q[], const double y[],
                              double x[])
{
    const int n = legendre->system->n;
    if (legendre->system->form == TVI_SEPARABLE) {
        for (int i = 0; i < n; i++) x[i] = y[i] / legendre->system->mass[i];
        return TVI_OK;
    }
    /* `scale` is the larger of |y| and |f(x)| at the start. `reuse_limit` is the largest residual for which the last
     * Jacobian matrix is used again; it is negative if there is no matrix. */
    double scale = tvi_largest_magnitude(n, y, 1), reuse_limit = -1;
    tvi_convergence_test passes;
    bool was_singular = false;
    tvi_convergence_begin(&passes, 0);
    tvi_status status = tvi_legendre_evaluate(legendre, t, q, x, legendre->transform_of_x);
    if (status == TVI_OK) scale = fmax(scale, tvi_largest_magnitude(n, legendre->transform_of_x, 1));
    for (int step = 0; step < LEGENDRE_MAX_ITERATIONS && status == TVI_OK; step++) {
        const double residual = compute_residual_norm(legendre, y);
        status = compute_newton_correction(legendre, y, !(residual <= reuse_limit));
        const bool is_singular = status == TVI_ESINGULAR && !was_singular && residual > 0;
        if (status != TVI_OK && !is_singular) return status;
        was_singular |= is_singular;
        reuse_limit = is_singular ? -1 : LEGENDRE_REUSE_MAX_RATIO * residual;
        if (!is_singular && is_last_correction(legendre, x, y, &passes)) {
            for (int i = 0; i < n; i++) x[i] += legendre->correction[i];
            if (!tvi_all_finite(n, x)) return TVI_ENONFINITE;
            return residual <= LEGENDRE_MAX_RESIDUAL * scale ? TVI_OK : TVI_ENOCONV;
        }
        status = apply_damped_correction(legendre, t, q, y, residual, x);
    }
    return status == TVI_OK ? TVI_ENOCONV : status;
}

tvi_status tvi_legendre_compute_start(tvi_legendre_transform *legendre, const tvi_system *system, double time_unit,
                                      double t, const double q[], const double p[], double velocity[],
                                      double initial_coefficients[])
{
    const int n = system->n;
    double *second_half = initial_coefficients + n;
    memcpy(initial_coefficients, q, (size_t)n * sizeof *initial_coefficients);
    switch (system->form) {
    case TVI_SEPARABLE:
        for (int i = 0; i < n; i++) second_half[i] = time_unit / system->mass[i] * p[i];
        return TVI_OK;
    case TVI_HAMILTONIAN: memcpy(second_half, p, (size_t)n * sizeof *second_half); return TVI_OK;
    default: break;
    }
    const bool is_at_rest = tvi_largest_magnitude(n, velocity, 1) == 0;
    tvi_status status = tvi_legendre_solve(legendre, t, q, p, velocity);
    if (status != TVI_OK && !is_at_rest) { /* The Lagrangian may have no value at the velocity of the step before. */
        memset(velocity, 0, (size_t)n * sizeof *velocity);
        status = tvi_legendre_solve(legendre, t, q, p, velocity);
    }
    for (int i = 0; i < n; i++) {
        second_half[i] = time_unit * velocity[i];
        if (status != TVI_OK) velocity[i] = 0; /* The next solution must not start from this velocity. */
    }
    return status;
}

tvi_status tvi_legendre_create(tvi_legendre_transform *legendre, const tvi_system *system, const double parameters[],
                               void **memory)
{
    tvi_arena arena = {0};
    tvi_legendre_allocate(legendre, &arena, system);
    *memory = tvi_arena_obtain_memory(&arena);
    if (!*memory) return TVI_ENOMEM;
    tvi_legendre_allocate(legendre, &arena, system);
    tvi_system_prepare_blocks(system, arena.first_tape_block, parameters);
    return TVI_OK;
}

/* Computes dy/dx at pseudo-random points (q, x) with components in (-1, 1), which are the same in each call. Points at
 * which the field has no value are left out. */
tvi_status tvi_legendre_test_regularity(tvi_system *system)
{
    system->is_regular = true;
    if (system->form == TVI_SEPARABLE) return TVI_OK;
    tvi_legendre_transform legendre;
    void *memory;
    const tvi_status status = tvi_legendre_create(&legendre, system, NULL, &memory);
    double *point = malloc(3 * (size_t)system->n * sizeof *point);
    if (status == TVI_OK && point) {
        unsigned random = 1;
        bool has_tested_point = false, regular = false;
        for (int probe = 0; probe < LEGENDRE_PROBES && !regular; probe++) {
            for (int i = 0; i < 2 * system->n; i++) {
                random = random * 1664525u + 1013904223u;
                point[i] = (random >> 8) * (2.0 / (1 << 24)) - 1;
            }
            if (tvi_legendre_evaluate(&legendre, 0.5, point, point + system->n, point + 2 * system->n) != TVI_OK)
                continue;
            has_tested_point = true;
            regular = factor_jacobian(&legendre) == TVI_OK &&
                      tvi_factor_least_pivot(&legendre.jacobian_factor) > LEGENDRE_REGULAR_MIN_PIVOT;
        }
        system->is_regular = regular || !has_tested_point;
    }
    if (status == TVI_OK) free(memory);
    free(point);
    if (status != TVI_OK || !point) return TVI_ENOMEM;
    if (system->is_regular || system->form != TVI_LAGRANGIAN) return TVI_OK;
    return jet_refuse(TVI_ESINGULAR, "L_vv of the Lagrangian is singular at all of %d points", LEGENDRE_PROBES);
}
