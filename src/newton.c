/* newton.c - the corrector. */
#include "newton.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Passes that just contract, by a half, are at roundoff after 53. */
enum { MAX_PASSES = 64, MAX_REFRESHES = 3, CHECK_EVERY = 16 };

/* Corrections that no longer shrink are roundoff when they are this small against the largest unknowns. */
static const double STAGNATION = 256 * DBL_EPSILON;
static const double ROUNDOFF = DBL_EPSILON / 2;
static const double MOST_SLACK = 1e6;
/* Corrections above this are no roundoff. */
static const double NOISE = 1e-13;
/* A pass that does not shrink the correction below this part of the last one does not contract. */
static const double CONTRACTION = 0.5;

void tvi_newton_take(tvi_newton *newton, tvi_arena *arena, int size, int group, bool has_matrix)
{
    const size_t count = (size_t)size;
    newton->has_matrix = has_matrix;
    newton->size = size;
    newton->group = group;
    newton->x = tvi_arena_doubles(arena, count);
    newton->correction = tvi_arena_doubles(arena, count);
    newton->scale = tvi_arena_doubles(arena, count);
    if (has_matrix) {
        newton->trial = tvi_arena_doubles(arena, count);
        newton->difference = tvi_arena_doubles(arena, count);
        tvi_factor_take(&newton->factor, arena, size);
    }
    newton->history = tvi_arena_history(arena, sizeof *newton->history);
}

typedef struct {
    double relative; /* max_i |correction_i| / scale_i */
    double of_group; /* the largest correction of a group against the largest scale of the group */
} correction_size;

static correction_size measure(const tvi_newton *newton)
{
    correction_size size = {0, 0};
    for (int first = 0; first < newton->size; first += newton->group) {
        double largest = 0, scale = 0;
        for (int i = first; i < first + newton->group; i++) {
            const double correction = fabs(newton->correction[i]);
            if (correction > 0) size.relative = fmax(size.relative, correction / newton->scale[i]);
            largest = fmax(largest, correction);
            scale = fmax(scale, newton->scale[i]);
        }
        if (largest > 0) size.of_group = fmax(size.of_group, largest / scale);
    }
    return size;
}

/* dr/dx by forward differences: the fresh Jacobian for steps so large that the approximate one does not contract.
 * correction holds -r(x). */
static tvi_status difference_jacobian(tvi_newton *newton, const tvi_equations *equations)
{
    const int size = newton->size;
    for (int column = 0; column < size; column++) {
        memcpy(newton->trial, newton->x, (size_t)size * sizeof *newton->x);
        newton->trial[column] += sqrt(DBL_EPSILON) * fmax(newton->scale[column], fabs(newton->x[column]));
        const double step = newton->trial[column] - newton->x[column];
        const tvi_status status = equations->residual(equations->self, newton->trial, newton->difference);
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
    } else if (!equations->jacobian(equations->self, newton->factor.lu)) {
        return TVI_OK;
    }
    stats->factorisations++;
    return tvi_factor_compute(&newton->factor);
}

/* An unknown without a size has the largest of its group, or 1; one that is much smaller than others, such as a body
 * that a wave has not reached, has no accuracy of its own. */
static void fill_scale(tvi_newton *newton)
{
    for (int first = 0; first < newton->size; first += newton->group) {
        double largest = 0;
        for (int i = first; i < first + newton->group; i++) largest = fmax(largest, newton->scale[i]);
        for (int i = first; i < first + newton->group; i++)
            if (newton->scale[i] == 0) newton->scale[i] = largest > 0 ? largest : 1;
            else newton->scale[i] = fmax(newton->scale[i], TVI_LEAST_SHARE * largest);
    }
}

/* What the passes have shown so far. */
typedef struct {
    correction_size size, before; /* of the last two corrections */
    correction_size earlier;      /* of the one before them */
    double contraction;           /* of the last correction, 0: none yet */
    double expected;              /* what the next correction should be; INFINITY: nobody knows */
    bool checks;                  /* one more pass than seems needed, to see how far the expectation can be trusted */
} progress;

/* The correction times the slower of the last two contractions, and the slack: passes that gain little in the
 * directions where the first correction was small make later contractions slower than the first one. */
static void expect(progress *at, double slack)
{
    const double contraction = fmin(at->size.relative / fmin(at->before.relative, 1), 1);
    at->expected = slack * fmax(contraction, at->contraction) * at->size.relative;
    at->contraction = contraction;
}

static double slack_of(const tvi_newton *newton) { return fmax(newton->history->slack, 1); }

static void learn(tvi_newton *newton, const progress *at)
{
    const double slack = slack_of(newton) * at->size.relative / at->expected; /* 0 where nothing was expected */
    if (at->size.relative > NOISE && at->size.relative <= CONTRACTION * at->before.relative && slack > slack_of(newton))
        newton->history->slack = fmin(slack, MOST_SLACK);
}

/* Whether the passes may end here. */
static bool is_enough(tvi_newton *newton, const tvi_options *options, int count, progress *at)
{
    if (options->passes > 0) return count == options->passes;
    const double goal = options->tolerance > 0 ? options->tolerance : ROUNDOFF;
    if (count == 1) return at->size.relative <= goal;
    const bool contracts = at->size.relative <= CONTRACTION * at->before.relative;
    if (!contracts && at->size.of_group <= STAGNATION) return true;
    if (options->tolerance > 0) return at->size.relative <= goal;
    learn(newton, at);
    const bool was_expected = at->expected <= ROUNDOFF;
    expect(at, slack_of(newton));
    return at->expected <= ROUNDOFF && (!at->checks || was_expected);
}

/* Whether the passes get nearer. Without a matrix to make anew they go on as long as the largest unknowns do: what one
 * body hands on to the next in each pass, to bodies that had nothing before, is the last to settle. There two passes
 * count, too: where curves of the lowest degrees leave all to the corrections, those of q follow from those of p and
 * these from those of q, which are small and large in turns. */
static bool contracts(const tvi_newton *newton, const progress *at)
{
    const double twice = CONTRACTION * CONTRACTION;
    if (at->size.relative <= CONTRACTION * at->before.relative) return true;
    return !newton->has_matrix &&
           (at->size.of_group <= CONTRACTION * at->before.of_group ||
            at->size.of_group <= twice * at->earlier.of_group || at->size.relative <= twice * at->earlier.relative);
}

/* One pass: correction = -K^-1 r(x), with K the approximate Jacobian or, once it was needed, a fresh one. */
static tvi_status pass(tvi_newton *newton, const tvi_equations *equations, bool is_first, int refreshes, bool refresh,
                       tvi_stats *stats)
{
    tvi_status status = equations->residual(equations->self, newton->x, newton->correction);
    if (status != TVI_OK) return status;
    if (is_first) {
        equations->scale(equations->self, newton->scale);
        fill_scale(newton);
    }
    for (int i = 0; i < newton->size; i++) newton->correction[i] = -newton->correction[i];
    if (refresh || (refreshes == 0 && equations->jacobian)) {
        status = factor_jacobian(newton, equations, refresh, stats);
        /* differencing moved the equations away from x: bring them back */
        if (status == TVI_OK && refresh) status = equations->residual(equations->self, newton->x, newton->difference);
        if (status != TVI_OK) return status;
    }
    if (refreshes > 0 || equations->jacobian) tvi_factor_solve(&newton->factor, newton->correction);
    else if (equations->solve) equations->solve(equations->self, newton->correction);
    for (int i = 0; i < newton->size; i++)
        if (!isfinite(newton->correction[i])) return TVI_ENONFINITE;
    stats->passes++;
    return TVI_OK;
}

tvi_status tvi_newton_solve(tvi_newton *newton, const tvi_equations *equations, const tvi_options *options,
                            tvi_stats *stats)
{
    const int max_passes = options->max_passes > 0 ? options->max_passes : MAX_PASSES;
    progress at = {.expected = INFINITY, .checks = newton->history->solves++ % CHECK_EVERY == 0 || equations->is_rough};
    int refreshes = 0;
    bool refresh = false;
    for (int count = 1; options->passes > 0 || count <= max_passes; count++) {
        refreshes += refresh;
        const tvi_status status = pass(newton, equations, count == 1, newton->has_matrix ? refreshes : 0,
                                       newton->has_matrix && refresh, stats);
        if (status != TVI_OK) return status;
        at.earlier = at.before;
        at.before = at.size;
        at.size = measure(newton);
        stats->residual = at.size.relative;
        if (is_enough(newton, options, count, &at)) return TVI_OK;
        for (int i = 0; i < newton->size; i++) newton->x[i] += newton->correction[i];
        refresh = count > 1 && options->passes == 0 && !contracts(newton, &at);
        if (refresh && refreshes == MAX_REFRESHES) return TVI_ENOCONV;
    }
    return TVI_ENOCONV;
}
