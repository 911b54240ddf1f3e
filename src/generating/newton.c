/* newton.c - the corrector. */
#include "generating/newton.h"
#include "algebra/passes.h"
#include "system/roundoff.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Passes that just contract, by a half, are at roundoff after 53. */
enum { MAX_PASSES = 64, MAX_REFRESHES = 3, CHECK_EVERY = 16 };

/* Corrections that no longer shrink are roundoff when they are this small against the largest unknowns, or against what
 * the residual is computed from. */
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
    newton->reach = tvi_arena_doubles(arena, count);
    newton->trial = tvi_arena_doubles(arena, count);
    newton->difference = tvi_arena_doubles(arena, count);
    if (has_matrix) tvi_factor_take(&newton->factor, arena, size);
    newton->history = tvi_arena_history(arena, sizeof *newton->history);
}

typedef struct {
    double relative; /* max_i |correction_i| / scale_i */
    double of_group; /* the largest correction of a group against the largest scale of the group */
} correction_size;

/* unit: the scales of the unknowns, or their reach. */
static correction_size measure(const tvi_newton *newton, const double unit[])
{
    correction_size size = {0, 0};
    for (int first = 0; first < newton->size; first += newton->group) {
        double largest = 0, scale = 0;
        for (int i = first; i < first + newton->group; i++) {
            const double correction = fabs(newton->correction[i]);
            if (correction > 0) size.relative = fmax(size.relative, correction / unit[i]);
            largest = fmax(largest, correction);
            scale = fmax(scale, unit[i]);
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
        newton->trial[column] += sqrt(DBL_EPSILON) * fmax(newton->reach[column], fabs(newton->x[column]));
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

/* vector <- K^-1 vector, with K the approximate Jacobian or, once it was needed, a fresh one. */
static void solve(const tvi_newton *newton, const tvi_equations *equations, double vector[])
{
    if (newton->is_fresh || equations->jacobian) tvi_factor_solve(&newton->factor, vector);
    else if (equations->solve) equations->solve(equations->self, vector);
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
    tvi_passes relative, of_group; /* of the corrections, as correction_size has them */
    double contraction;            /* of the last correction, 0: none yet */
    double expected;               /* what the next correction should be; INFINITY: nobody knows */
    double slack, seen;            /* in this step: believed, and of the last correction */
    bool checks;                   /* one more pass than seems needed, to see how far the expectation can be trusted */
} progress;

/* The correction times the slower of the last two contractions, and the slack: passes that gain little in the
 * directions where the first correction was small make later contractions slower than the first one. */
static void expect(progress *at)
{
    const double contraction = fmin(at->relative.size / fmin(at->relative.before, 1), 1);
    at->expected = fmax(at->slack, at->seen) * fmax(contraction, at->contraction) * at->relative.size;
    at->contraction = contraction;
}

/* The slack that one correction shows is believed when the next one contracts again: one that was roundoff does not. */
static void learn(progress *at)
{
    const bool contracts = tvi_passes_contract(&at->relative, CONTRACTION);
    if (contracts) at->slack = fmin(fmax(at->slack, at->seen), MOST_SLACK);
    const double slack = fmax(at->slack, at->seen) * at->relative.size / at->expected; /* 0: nothing was expected */
    at->seen = contracts && at->relative.size > NOISE ? slack : 0;
}

/* The reach of the unknowns: their scales, and that of which the roundoff of the residual is the part STAGNATION.
 * Groups of the residual are taken alone, so that the parts of a sum do not cancel. */
static void find_reach(tvi_newton *newton, const tvi_equations *equations)
{
    const size_t bytes = (size_t)newton->group * sizeof(double);
    equations->roundoff(equations->self, newton->difference);
    for (int first = 0; first < newton->size; first += newton->group) {
        memset(newton->trial, 0, (size_t)newton->size * sizeof *newton->trial);
        memcpy(newton->trial + first, newton->difference + first, bytes);
        solve(newton, equations, newton->trial);
        for (int i = 0; i < newton->size; i++)
            if (isfinite(newton->trial[i]))
                newton->reach[i] += TVI_ROUNDOFF_UNITS / STAGNATION * fabs(newton->trial[i]);
    }
}

/* Whether corrections that no longer shrink are roundoff. */
static bool is_roundoff(tvi_newton *newton, const tvi_equations *equations, progress *at)
{
    if (at->of_group.size <= STAGNATION) return true;
    memcpy(newton->reach, newton->scale, (size_t)newton->size * sizeof *newton->reach);
    find_reach(newton, equations);
    if (measure(newton, newton->reach).of_group > STAGNATION) return false;
    at->slack = at->seen = 0; /* nothing that this step has shown is known to be no roundoff */
    return true;
}

/* Whether the passes get nearer. Two passes count, too, where corrections of q follow from those of p and these from
 * those of q, which are small and large in turns. Without a matrix to make anew passes go on as long as the largest
 * unknowns do: what one body hands on to the next in each pass, to bodies that had nothing before, is the last to
 * settle. */
static bool contracts(const tvi_newton *newton, const tvi_equations *equations, const progress *at)
{
    const double twice = CONTRACTION * CONTRACTION;
    const bool in_turns = equations->is_rough || !newton->has_matrix;
    if (tvi_passes_contract(&at->relative, CONTRACTION)) return true;
    if (in_turns && tvi_passes_contract_in_two(&at->relative, twice)) return true;
    return !newton->has_matrix &&
           (tvi_passes_contract(&at->of_group, CONTRACTION) || tvi_passes_contract_in_two(&at->of_group, twice));
}

/* Whether the passes may end here. */
static bool is_enough(tvi_newton *newton, const tvi_equations *equations, const tvi_options *options, int count,
                      progress *at)
{
    if (options->passes > 0) return count == options->passes;
    const double goal = options->tolerance > 0 ? options->tolerance : ROUNDOFF;
    if (count == 1) return at->relative.size <= goal;
    if (!contracts(newton, equations, at) && is_roundoff(newton, equations, at)) return true;
    if (options->tolerance > 0) return at->relative.size <= goal;
    learn(at);
    const bool was_expected = at->expected <= ROUNDOFF;
    expect(at);
    return at->expected <= ROUNDOFF && (!at->checks || was_expected);
}

/* One pass: correction = -K^-1 r(x). */
static tvi_status pass(tvi_newton *newton, const tvi_equations *equations, bool is_first, bool refresh,
                       tvi_stats *stats)
{
    tvi_status status = equations->residual(equations->self, newton->x, newton->correction);
    if (status != TVI_OK) return status;
    if (is_first) {
        equations->scale(equations->self, newton->scale);
        fill_scale(newton);
    }
    for (int i = 0; i < newton->size; i++) newton->correction[i] = -newton->correction[i];
    if (refresh || (!newton->is_fresh && equations->jacobian)) {
        status = factor_jacobian(newton, equations, refresh, stats);
        /* differencing moved the equations away from x: bring them back */
        if (status == TVI_OK && refresh) status = equations->residual(equations->self, newton->x, newton->difference);
        if (status != TVI_OK) return status;
    }
    solve(newton, equations, newton->correction);
    for (int i = 0; i < newton->size; i++)
        if (!isfinite(newton->correction[i])) return TVI_ENONFINITE;
    stats->passes++;
    return TVI_OK;
}

tvi_status tvi_newton_solve(tvi_newton *newton, const tvi_equations *equations, const tvi_options *options,
                            tvi_stats *stats)
{
    tvi_newton_history *history = newton->history;
    const int max_passes = options->max_passes > 0 ? options->max_passes : MAX_PASSES;
    progress at = {.relative = TVI_NO_PASSES,
                   .of_group = TVI_NO_PASSES,
                   .expected = INFINITY,
                   .slack = fmax(history->slack, 1),
                   .checks = history->solves++ % CHECK_EVERY == 0 || equations->is_rough};
    int refreshes = 0;
    bool refresh = false;
    for (int count = 1; options->passes > 0 || count <= max_passes; count++) {
        refreshes += refresh;
        newton->is_fresh = newton->has_matrix && refreshes > 0;
        const tvi_status status = pass(newton, equations, count == 1, newton->has_matrix && refresh, stats);
        if (status != TVI_OK) return status;
        const correction_size size = measure(newton, newton->scale);
        tvi_passes_add(&at.relative, size.relative);
        tvi_passes_add(&at.of_group, size.of_group);
        stats->residual = size.relative;
        if (is_enough(newton, equations, options, count, &at)) {
            history->slack = fmax(history->slack, at.slack);
            return TVI_OK;
        }
        for (int i = 0; i < newton->size; i++) newton->x[i] += newton->correction[i];
        refresh = count > 1 && options->passes == 0 && !contracts(newton, equations, &at);
        if (refresh && refreshes == MAX_REFRESHES) return TVI_ENOCONV;
    }
    return TVI_ENOCONV;
}
