/* newton.c - the corrector. */
#include "newton.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MAX_PASSES = 50, MAX_REFRESHES = 3 };

/* Corrections that no longer shrink are roundoff when they are this small against the largest unknown. */
static const double STAGNATION = 256 * DBL_EPSILON;
static const double ROUNDOFF = DBL_EPSILON / 2;
/* A pass that does not shrink the correction below this part of the last one does not contract. */
static const double CONTRACTION = 0.5;

void tvi_newton_take(tvi_newton *newton, tvi_arena *arena, int size)
{
    const size_t count = (size_t)size;
    newton->size = size;
    newton->x = tvi_arena_doubles(arena, count);
    newton->correction = tvi_arena_doubles(arena, count);
    newton->scale = tvi_arena_doubles(arena, count);
    newton->trial = tvi_arena_doubles(arena, count);
    newton->difference = tvi_arena_doubles(arena, count);
    tvi_factor_take(&newton->factor, arena, size);
}

typedef struct {
    double relative; /* max_i |correction_i| / scale_i */
    double absolute; /* max_i |correction_i| / max_j scale_j */
} correction_size;

static correction_size measure(const tvi_newton *newton)
{
    correction_size size = {0, 0};
    double largest = 0, scale = 0;
    for (int i = 0; i < newton->size; i++) {
        const double correction = fabs(newton->correction[i]);
        if (correction > 0) size.relative = fmax(size.relative, correction / newton->scale[i]);
        largest = fmax(largest, correction);
        scale = fmax(scale, newton->scale[i]);
    }
    if (largest > 0) size.absolute = largest / scale;
    return size;
}

/* dr/dx by forward differences: the fresh Jacobian for steps so large that the approximate one does not contract.
 * correction holds -r(x). */
static tvi_status difference_jacobian(tvi_newton *newton, const tvi_equations *equations)
{
    const int size = newton->size;
    for (int column = 0; column < size; column++) {
        memcpy(newton->trial, newton->x, (size_t)size * sizeof *newton->x);
        newton->trial[column] += sqrt(DBL_EPSILON) * (newton->scale[column] > 0 ? newton->scale[column] : 1);
        const double step = newton->trial[column] - newton->x[column];
        const tvi_status status = equations->residual(equations->self, newton->trial, newton->difference, newton->scale);
        if (status != TVI_OK) return status;
        for (int row = 0; row < size; row++)
            newton->factor.lu[row * size + column] = (newton->difference[row] + newton->correction[row]) / step;
    }
    return TVI_OK;
}

static tvi_status factor_jacobian(tvi_newton *newton, const tvi_equations *equations, bool fresh, tvi_stats *stats)
{
    if (fresh) {
        const tvi_status status = difference_jacobian(newton, equations);
        if (status != TVI_OK) return status;
    } else {
        equations->jacobian(equations->self, newton->factor.lu);
    }
    stats->factorisations++;
    return tvi_factor_compute(&newton->factor);
}

/* Whether the passes may end with a correction of this size after one of the size `before`. What is left is about the
 * correction times the last contraction. */
static bool is_enough(const tvi_options *options, int pass, correction_size size, correction_size before)
{
    if (options->passes > 0) return pass == options->passes;
    if (options->tolerance > 0) return size.relative <= options->tolerance;
    if (pass == 1) return size.relative <= ROUNDOFF;
    const double contraction = fmin(size.relative / before.relative, 1);
    const bool stagnates = size.relative > CONTRACTION * before.relative && size.absolute <= STAGNATION;
    return contraction * size.relative <= ROUNDOFF || stagnates;
}

/* One pass: correction = -K^-1 r(x), with K the approximate Jacobian or, once it was needed, a fresh one. */
static tvi_status pass(tvi_newton *newton, const tvi_equations *equations, int refreshes, bool refresh, tvi_stats *stats)
{
    tvi_status status = equations->residual(equations->self, newton->x, newton->correction, newton->scale);
    if (status != TVI_OK) return status;
    for (int i = 0; i < newton->size; i++) newton->correction[i] = -newton->correction[i];
    if (refresh || (refreshes == 0 && equations->jacobian)) {
        status = factor_jacobian(newton, equations, refresh, stats);
        /* differencing moved the equations away from x: bring them back */
        if (status == TVI_OK && refresh)
            status = equations->residual(equations->self, newton->x, newton->difference, newton->scale);
        if (status != TVI_OK) return status;
    }
    if (refreshes > 0 || equations->jacobian) tvi_factor_solve(&newton->factor, newton->correction);
    for (int i = 0; i < newton->size; i++)
        if (!isfinite(newton->correction[i])) return TVI_ENONFINITE;
    stats->passes++;
    return TVI_OK;
}

tvi_status tvi_newton_solve(tvi_newton *newton, const tvi_equations *equations, const tvi_options *options, tvi_stats *stats)
{
    const int max_passes = options->max_passes > 0 ? options->max_passes : MAX_PASSES;
    correction_size size = {0, 0}, before = {0, 0};
    int refreshes = 0;
    bool refresh = false;
    for (int count = 1; options->passes > 0 || count <= max_passes; count++, before = size) {
        refreshes += refresh;
        const tvi_status status = pass(newton, equations, refreshes, refresh, stats);
        if (status != TVI_OK) return status;
        size = measure(newton);
        stats->residual = size.relative;
        if (is_enough(options, count, size, before)) return TVI_OK;
        for (int i = 0; i < newton->size; i++) newton->x[i] += newton->correction[i];
        const bool contracts = count == 1 || size.relative <= CONTRACTION * before.relative;
        refresh = !contracts && options->passes == 0;
        if (refresh && refreshes == MAX_REFRESHES) return TVI_ENOCONV;
    }
    return TVI_ENOCONV;
}
