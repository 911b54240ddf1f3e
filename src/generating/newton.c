/* newton.c - solves the equations of a method by Newton passes with an approximate Jacobian, until the corrections
 * are roundoff (newton.h). The steppers curve_stepper.c and both_ends.c call it. */
#include "generating/newton.h"
#include "algebra/sizes.h"
#include "method/stepper.h"
#include "system/roundoff.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MAX_REFRESHES = 3 };

/* A pass that does not shrink the correction below this part of the last one does not contract. */
#define CONTRACTION 0.5

/* This rule judges the corrections relative to each unknown: half a unit of roundoff may be left. Passes that just
 * contract get there after 53. */
static const tvi_passes_rule of_each = {.max_passes = 64,
                                        .correction_goal = DBL_EPSILON / 2,
                                        .max_trusted_ratio = 1,
                                        .stall_ratio = CONTRACTION,
                                        .stall_lag = 1};
/* This rule judges the largest correction of a group against the largest unknown. Without a matrix passes are not stuck
 * as long as these corrections settle. In each pass one body moves the next; the corrections of bodies that had none
 * before settle last. */
static const tvi_passes_rule of_largest = {.stall_ratio = CONTRACTION, .stall_lag = 2};

void tvi_newton_allocate(tvi_newton *newton, tvi_arena *arena, int groups, const tvi_system *system, bool has_matrix,
                         int width)
{
    const int size = groups * system->n;
    const size_t count = (size_t)size * (size_t)width;
    newton->has_matrix = has_matrix;
    newton->size = size;
    newton->width = width;
    newton->group = system->n;
    newton->parts = &system->parts;
    newton->x = tvi_arena_allocate_doubles(arena, count);
    newton->correction = tvi_arena_allocate_doubles(arena, count);
    newton->scale = tvi_arena_allocate_doubles(arena, count);
    newton->reach = tvi_arena_allocate_doubles(arena, count);
    newton->trial = tvi_arena_allocate_doubles(arena, count);
    newton->difference = tvi_arena_allocate_doubles(arena, count);
    if (has_matrix) tvi_factor_allocate(&newton->factor, arena, size, width);
    newton->history = tvi_arena_allocate_in_history(arena, (size_t)width * sizeof *newton->history);
}

/* Computes dr/dx by forward differences: the fresh Jacobian for steps so large that the approximate one does not
 * contract. The correction holds -r(x). */
static tvi_status compute_jacobian_by_differences(tvi_newton *newton, const tvi_equations *equations)
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
        const tvi_status status = compute_jacobian_by_differences(newton, equations);
        if (status != TVI_OK) return status;
    } else if (!equations->jacobian(equations->self, newton->factor.lu)) {
        return TVI_OK;
    }
    stats->factorisations++;
    return tvi_factor_compute(&newton->factor);
}

/* Computes vector <- K^-1 vector, with K the approximate Jacobian or, once it was needed, a fresh one. */
static void solve_with_jacobian(const tvi_newton *newton, const tvi_equations *equations, double vector[])
{
    if (newton->is_fresh || equations->jacobian) tvi_factor_solve(&newton->factor, vector);
    else if (equations->solve) equations->solve(equations->self, vector);
}

/* Adds to the reach of each unknown, which holds its scale, the size of which the roundoff of the residual is the part
 * NEWTON_STAGNATION. Groups of the residual are taken alone, so that the parts of a sum do not cancel. */
static void compute_roundoff_scales(tvi_newton *newton, const tvi_equations *equations)
{
    const size_t bytes = (size_t)newton->group * sizeof(double);
    equations->roundoff(equations->self, newton->difference);
    for (int first = 0; first < newton->size; first += newton->group) {
        memset(newton->trial, 0, (size_t)newton->size * sizeof *newton->trial);
        memcpy(newton->trial + first, newton->difference + first, bytes);
        solve_with_jacobian(newton, equations, newton->trial);
        for (int i = 0; i < newton->size; i++)
            if (isfinite(newton->trial[i]))
                newton->reach[i] += TVI_ROUNDOFF_UNITS / NEWTON_STAGNATION * fabs(newton->trial[i]);
    }
}

/* Returns the rules of the passes. Without a matrix, or if the first contraction tells little, corrections are compared
 * over two passes: those of q follow from those of p, and those of p from those of q. */
static tvi_newton_rules rules_from_options(const tvi_options *options, bool has_matrix, bool is_rough)
{
    tvi_newton_rules rules = {tvi_passes_rule_with_options(&of_each, options, options->tolerance), of_largest};
    if (has_matrix) rules.of_largest = (tvi_passes_rule){.stall_lag = 1};
    if (!has_matrix || is_rough) rules.of_each.stall_lag = 2;
    return rules;
}

void tvi_newton_set_rules(tvi_newton *newton, const tvi_options *options, bool is_rough)
{
    newton->is_rough = is_rough;
    newton->rules = rules_from_options(options, newton->has_matrix, is_rough);
}

/* Returns whether corrections that no longer shrink are roundoff, by the roundoff of the residual. */
static bool is_correction_roundoff(tvi_newton *newton, const tvi_equations *equations, tvi_newton_passes *passes)
{
    memcpy(newton->reach, newton->scale, (size_t)newton->size * sizeof *newton->reach);
    compute_roundoff_scales(newton, equations);
    tvi_correction_sizes sizes;
    newton_measure_corrections(newton, newton->reach, &sizes);
    if (sizes.of_group[0] > NEWTON_STAGNATION) return false;
    passes->slack = 1; /* nothing that this step has shown is known to be no roundoff */
    return true;
}

/* Makes one pass: correction = -K^-1 r(x). */
static tvi_status run_newton_pass(tvi_newton *newton, const tvi_equations *equations, bool is_first, bool refresh,
                                  tvi_stats *stats)
{
    tvi_status status = equations->residual(equations->self, newton->x, newton->correction);
    if (status != TVI_OK) return status;
    if (is_first) {
        equations->scale(equations->self, newton->scale);
        newton_fill_missing_scales(newton, 0);
    }
    for (int i = 0; i < newton->size; i++) newton->correction[i] = -newton->correction[i];
    if (refresh || (!newton->is_fresh && equations->jacobian)) {
        status = factor_jacobian(newton, equations, refresh, stats);
        /* differencing moved the equations away from x: bring them back */
        if (status == TVI_OK && refresh) status = equations->residual(equations->self, newton->x, newton->difference);
        if (status != TVI_OK) return status;
    }
    solve_with_jacobian(newton, equations, newton->correction);
    for (int i = 0; i < newton->size; i++)
        if (!isfinite(newton->correction[i])) return TVI_ENONFINITE;
    stats->passes++;
    return TVI_OK;
}

tvi_status tvi_newton_solve(tvi_newton *newton, const tvi_equations *equations, tvi_stats *stats)
{
    const tvi_newton_rules *rules = &newton->rules;
    tvi_newton_passes passes;
    tvi_newton_begin_passes(&passes, newton->history, &newton->rules, newton->is_rough);
    int refreshes = 0;
    bool refresh = false;
    for (int count = 1; count <= rules->of_each.max_passes; count++) {
        refreshes += refresh;
        newton->is_fresh = newton->has_matrix && refreshes > 0;
        const tvi_status status = run_newton_pass(newton, equations, count == 1, newton->has_matrix && refresh, stats);
        if (status != TVI_OK) return status;
        tvi_correction_sizes sizes;
        newton_measure_corrections(newton, newton->scale, &sizes);
        const tvi_correction_size size = {sizes.relative[0], sizes.of_group[0]};
        stats->residual = size.relative;
        tvi_passes_verdict verdict = tvi_newton_judge_pass(&passes, rules, size);
        if (verdict == TVI_PASSES_STUCK && is_correction_roundoff(newton, equations, &passes))
            verdict = TVI_PASSES_MAY_END;
        if (verdict == TVI_PASSES_MAY_END) {
            tvi_newton_store_slack(newton->history, &passes);
            return TVI_OK;
        }
        for (int i = 0; i < newton->size; i++) newton->x[i] += newton->correction[i];
        refresh = verdict == TVI_PASSES_STUCK;
        if (refresh && refreshes == MAX_REFRESHES) return TVI_ENOCONV;
    }
    return TVI_ENOCONV;
}
