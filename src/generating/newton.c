/* newton.c - solves the equations of a method by Newton passes with an approximate Jacobian, until the corrections
 * are roundoff (newton.h). The steppers curve_stepper.c and both_ends.c call it. */
#include "generating/newton.h"
#include "algebra/sizes.h"
#include "method/stepper.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The rule for the corrections relative to each unknown's scale: passes end if the next correction is expected to be
 * half a unit of roundoff or less. If each correction is PASSES_STALL_RATIO times the one before it, this takes 53
 * passes. */
static const tvi_stopping_rule per_unknown_correction_rule = {.max_passes = NEWTON_MAX_PASSES,
                                                              .correction_goal = DBL_EPSILON / 2,
                                                              .max_trusted_ratio = 1,
                                                              .stall_ratio = PASSES_STALL_RATIO,
                                                              .stall_comparison_lag = 1};
/* The rule for the largest correction of a group, relative to the largest scale of the group. Passes without a Jacobian
 * are not stuck as long as these corrections shrink. In each pass corrections spread from a body to its neighbours
 * only; the corrections of the bodies that are reached last also shrink last. */
static const tvi_stopping_rule per_group_correction_rule = {.stall_ratio = PASSES_STALL_RATIO,
                                                            .stall_comparison_lag = 2};

/* ---- The corrections of a pass ----------------------------------------------------------------------------------- */

/* The sizes of the corrections of a pass: the largest correction relative to its unknown's scale, and the largest
 * correction of a group relative to the largest scale of the group. */
typedef struct {
    double largest_relative_correction, relative_group_correction;
} tvi_correction_sizes;

/* The passes of a solution so far: passes_measured_per_unknown records largest_relative_correction, and
 * passes_measured_per_group records relative_group_correction. */
typedef struct {
    tvi_convergence_test passes_measured_per_unknown, passes_measured_per_group;
    /* The contraction ratio of a pass is the size of its correction divided by that of the correction before it.
     * ratio_growth is the factor by which this ratio may grow from one pass to the next; the expected size of the next
     * correction allows for it. unconfirmed_ratio_growth is a greater factor that the last correction suggests and that
     * no later correction has confirmed yet. */
    double ratio_growth, unconfirmed_ratio_growth;
    bool must_confirm_convergence; /* whether one more pass must confirm the expected convergence */
} tvi_newton_convergence_record;

/* Begins the passes of a solution. The first contraction is often better than the later ones: first corrections are
 * mostly of the highest orders, on which the part of the Jacobian that the approximation omits has little effect. The
 * first solution therefore makes one pass more than seems needed, and measures the later contraction. */
static void tvi_newton_begin_passes(tvi_newton_convergence_record *record, double max_contraction_ratio_growth,
                                    const tvi_newton_rules *rules, bool confirms_convergence_by_extra_pass)
{
    tvi_convergence_begin(&record->passes_measured_per_unknown, 0);
    tvi_convergence_begin(&record->passes_measured_per_group, 0);
    record->ratio_growth = tvi_larger(max_contraction_ratio_growth, 1);
    record->unconfirmed_ratio_growth = 0;
    record->must_confirm_convergence = rules->per_unknown_correction_rule.exact_passes == 0 &&
                                       rules->per_unknown_correction_rule.max_trusted_ratio > 0 &&
                                       (max_contraction_ratio_growth == 0 || confirms_convergence_by_extra_pass);
}

/* Updates the factor by which the contraction ratio may grow. A greater factor that one correction suggests is accepted
 * only if the next correction contracts again, because roundoff does not contract. */
static void tvi_newton_update_contraction_ratio_growth(tvi_newton_convergence_record *record,
                                                       const tvi_newton_rules *rules, double relative_correction)
{
    const tvi_convergence_test *each = &record->passes_measured_per_unknown;
    const bool shows = relative_correction <= rules->per_unknown_correction_rule.stall_ratio * each->size;
    if (each->count < 2) return;
    if (shows)
        record->ratio_growth =
            tvi_smaller(tvi_larger(record->ratio_growth, record->unconfirmed_ratio_growth), NEWTON_MAX_RATIO_GROWTH);
    const double growth = each->ratio_growth * relative_correction / each->expected_next_size;
    record->unconfirmed_ratio_growth = shows && relative_correction > NEWTON_GROWTH_MIN_CORRECTION ? growth : 0;
}

/* Adds a pass with corrections of these sizes, and judges it. If it returns TVI_PASSES_STUCK, the caller
 * measures whether the correction is roundoff. */
static tvi_passes_verdict tvi_newton_judge_pass(tvi_newton_convergence_record *record, const tvi_newton_rules *rules,
                                                const tvi_correction_sizes *sizes)
{
    const double largest_relative_correction = sizes->largest_relative_correction,
                 relative_group_correction = sizes->relative_group_correction;
    const double expected = record->passes_measured_per_unknown.expected_next_size;
    tvi_newton_update_contraction_ratio_growth(record, rules, largest_relative_correction);
    record->passes_measured_per_unknown.ratio_growth =
        tvi_larger(record->ratio_growth, record->unconfirmed_ratio_growth);
    const tvi_passes_verdict verdict = tvi_convergence_add_pass(
        &record->passes_measured_per_unknown, &rules->per_unknown_correction_rule, largest_relative_correction);
    const tvi_passes_verdict settled = tvi_convergence_add_pass(
        &record->passes_measured_per_group, &rules->per_group_correction_rule, relative_group_correction);
    const bool is_confirmed = expected <= rules->per_unknown_correction_rule.correction_goal &&
                              largest_relative_correction <= NEWTON_CHECK_MAX_CORRECTION;
    if (verdict == TVI_PASSES_MAY_END && record->must_confirm_convergence && largest_relative_correction > 0 &&
        !is_confirmed)
        return TVI_PASSES_GO_ON;
    if (verdict != TVI_PASSES_STUCK) return verdict;
    if (relative_group_correction <= NEWTON_STALLED_CORRECTION) return TVI_PASSES_MAY_END;
    return settled == TVI_PASSES_STUCK ? TVI_PASSES_STUCK : TVI_PASSES_GO_ON;
}

/* Measures the corrections of one subsystem in each group of unknowns, for the entries begin .. end - 1 of the list of
 * components. `scale` is newton->scale or newton->roundoff_scale. A correction that is not finite makes the sizes NaN,
 * since x - x is 0 for finite x only. */
static void newton_measure_subsystem_corrections(const tvi_newton *newton, const double scale[], int begin, int end,
                                                 tvi_correction_sizes *sizes)
{
    for (int first = 0; first < newton->unknown_count; first += newton->unknowns_per_group) {
        double relative = sizes->largest_relative_correction, largest = 0, largest_scale = 0, rest = 0;
        for (int k = begin; k < end; k++) {
            const int i = first + tvi_subsystems_component_at(newton->subsystems, k);
            const double correction = newton->correction[i], size = fabs(correction);
            rest += correction - correction;
            relative = tvi_larger(size / scale[i], relative);
            largest = tvi_larger(size, largest);
            largest_scale = tvi_larger(scale[i], largest_scale);
        }
        sizes->largest_relative_correction = relative + rest;
        sizes->relative_group_correction = tvi_larger(largest / largest_scale, sizes->relative_group_correction) + rest;
    }
}

/* Measures the corrections of the unknowns, relative to `scale`. */
static tvi_correction_sizes newton_measure_corrections(const tvi_newton *newton, const double scale[])
{
    const tvi_subsystems *subsystems = newton->subsystems;
    tvi_correction_sizes sizes = {0, 0};
    for (int k = 0, begin = 0, end; k < subsystems->count; k++, begin = end) {
        end = tvi_subsystems_end(subsystems, k, newton->unknowns_per_group);
        newton_measure_subsystem_corrections(newton, scale, begin, end, &sizes);
    }
    return sizes;
}

/* Raises the scales of the small unknowns in one subsystem, group by group. A scale of 0 becomes the largest scale of
 * the group in the subsystem, or 1 if all are 0. Any other scale is raised to at least NEWTON_MIN_SCALE times the
 * largest one, and to DBL_MIN. An unknown that is much smaller than the others of its group, such as a body that a wave
 * has not reached, is thus measured by these. */
static void newton_raise_small_scales_in_subsystem(const tvi_newton *newton, int begin, int end)
{
    for (int first = 0; first < newton->unknown_count; first += newton->unknowns_per_group) {
        double largest = 0, *scale = newton->scale + first;
        for (int k = begin; k < end; k++)
            largest = tvi_larger(scale[tvi_subsystems_component_at(newton->subsystems, k)], largest);
        for (int k = begin; k < end; k++) {
            const int i = tvi_subsystems_component_at(newton->subsystems, k);
            if (scale[i] == 0) scale[i] = largest > 0 ? largest : 1;
            else scale[i] = tvi_larger(tvi_larger(NEWTON_MIN_SCALE * largest, DBL_MIN), scale[i]);
        }
    }
}

static void newton_raise_scales_of_small_unknowns(const tvi_newton *newton)
{
    const tvi_subsystems *subsystems = newton->subsystems;
    for (int k = 0, begin = 0, end; k < subsystems->count; k++, begin = end) {
        end = tvi_subsystems_end(subsystems, k, newton->unknowns_per_group);
        newton_raise_small_scales_in_subsystem(newton, begin, end);
    }
}

/* ---- The corrector ----------------------------------------------------------------------------------------------- */

void tvi_newton_allocate(tvi_newton *newton, tvi_arena *arena, int group_count, const tvi_system *system,
                         bool allocates_jacobian)
{
    const int size = group_count * system->n;
    const size_t count = (size_t)size;
    newton->is_jacobian_allocated = allocates_jacobian;
    newton->unknown_count = size;
    newton->unknowns_per_group = system->n;
    newton->subsystems = &system->subsystems;
    newton->x = tvi_arena_allocate_doubles(arena, count);
    newton->correction = tvi_arena_allocate_doubles(arena, count);
    newton->scale = tvi_arena_allocate_doubles(arena, count);
    newton->roundoff_scale = tvi_arena_allocate_doubles(arena, count);
    newton->trial_unknowns = tvi_arena_allocate_doubles(arena, count);
    newton->trial_residual = tvi_arena_allocate_doubles(arena, count);
    if (allocates_jacobian) tvi_factor_allocate(&newton->factor, arena, size);
    newton->max_contraction_ratio_growth =
        tvi_arena_allocate_copied(arena, sizeof *newton->max_contraction_ratio_growth);
}

/* Computes dr/dx by forward differences, for steps so large that passes with the approximate Jacobian do not contract.
 * newton->correction holds -r(x). */
static tvi_status compute_jacobian_by_differences(tvi_newton *newton, const tvi_equations *equations)
{
    const int size = newton->unknown_count;
    for (int column = 0; column < size; column++) {
        memcpy(newton->trial_unknowns, newton->x, (size_t)size * sizeof *newton->x);
        newton->trial_unknowns[column] +=
            sqrt(DBL_EPSILON) * fmax(fmax(newton->roundoff_scale[column], TVI_LEAST_SIZE), fabs(newton->x[column]));
        const double step = newton->trial_unknowns[column] - newton->x[column];
        const tvi_status status = equations->residual(equations->self, newton->trial_unknowns, newton->trial_residual);
        if (status != TVI_OK) return status;
        for (int row = 0; row < size; row++)
            newton->factor.lu[row * size + column] = (newton->trial_residual[row] + newton->correction[row]) / step;
    }
    return TVI_OK;
}

static tvi_status factor_jacobian(tvi_newton *newton, const tvi_equations *equations, bool by_differences,
                                  tvi_stats *stats)
{
    if (by_differences) {
        const tvi_status status = compute_jacobian_by_differences(newton, equations);
        if (status != TVI_OK) return status;
    } else if (!equations->jacobian(equations->self, newton->factor.lu)) {
        return TVI_OK;
    }
    stats->factorisations++;
    return tvi_factor_compute(&newton->factor);
}

/* Computes vector <- K^-1 vector, with K the Jacobian by differences, once there is one, otherwise the approximate
 * Jacobian. */
static void solve_with_jacobian(const tvi_newton *newton, const tvi_equations *equations, double vector[])
{
    if (newton->is_jacobian_by_differences || equations->jacobian) tvi_factor_solve(&newton->factor, vector);
    else if (equations->solve) equations->solve(equations->self, vector);
}

/* Adds to roundoff_scale, which holds the natural size of each unknown, a multiple of the change of the unknown that
 * the roundoff of the residual causes. With this multiple, NEWTON_STALLED_CORRECTION times the sum is at least
 * ROUNDOFF_MAX_UNITS times that change. The linear equations are solved for the roundoff of each group of the residual
 * separately, and the magnitudes of the solutions are added, so that the groups cannot cancel each other. */
static void compute_roundoff_scales(tvi_newton *newton, const tvi_equations *equations)
{
    const size_t bytes = (size_t)newton->unknowns_per_group * sizeof(double);
    equations->roundoff(equations->self, newton->trial_residual);
    for (int first = 0; first < newton->unknown_count; first += newton->unknowns_per_group) {
        memset(newton->trial_unknowns, 0, (size_t)newton->unknown_count * sizeof *newton->trial_unknowns);
        memcpy(newton->trial_unknowns + first, newton->trial_residual + first, bytes);
        solve_with_jacobian(newton, equations, newton->trial_unknowns);
        for (int i = 0; i < newton->unknown_count; i++)
            if (isfinite(newton->trial_unknowns[i]))
                newton->roundoff_scale[i] +=
                    ROUNDOFF_MAX_UNITS / NEWTON_STALLED_CORRECTION * fabs(newton->trial_unknowns[i]);
    }
}

void tvi_newton_set_pass_rules(tvi_newton *newton, const tvi_options *options, bool confirms_convergence_by_extra_pass)
{
    tvi_newton_rules *rules = &newton->rules;
    *rules = (tvi_newton_rules){tvi_passes_rule_with_options(&per_unknown_correction_rule, options, options->tolerance),
                                per_group_correction_rule};
    newton->confirms_convergence_by_extra_pass = confirms_convergence_by_extra_pass;
    if (newton->is_jacobian_allocated)
        rules->per_group_correction_rule = (tvi_stopping_rule){.stall_comparison_lag = 1};
    /* In these cases the corrections of q follow from those of p in the pass before, and those of p from those of q. A
     * correction may then be larger than the one before it although the passes converge, and is compared with the two
     * before it. */
    if (!newton->is_jacobian_allocated || confirms_convergence_by_extra_pass)
        rules->per_unknown_correction_rule.stall_comparison_lag = 2;
}

/* Returns whether the last correction, which did not shrink, is as small as the corrections that the residual's
 * roundoff causes. */
static bool is_correction_roundoff(tvi_newton *newton, const tvi_equations *equations,
                                   tvi_newton_convergence_record *record)
{
    memcpy(newton->roundoff_scale, newton->scale, (size_t)newton->unknown_count * sizeof *newton->roundoff_scale);
    compute_roundoff_scales(newton, equations);
    const tvi_correction_sizes sizes = newton_measure_corrections(newton, newton->roundoff_scale);
    if (sizes.relative_group_correction > NEWTON_STALLED_CORRECTION) return false;
    record->ratio_growth = 1; /* the corrections are roundoff, and show no contraction */
    return true;
}

/* Computes the scales of the unknowns: their natural sizes at the prediction. If a correction has moved an unknown by
 * about its scale (NEWTON_SAME_SCALE_MAX_CORRECTION), the prediction said nothing of it, and its size at the new point
 * is its scale, if that is smaller. A larger size is not: where the series diverge, their terms have any size, and each
 * correction would be small beside it. */
static void compute_scales(tvi_newton *newton, const tvi_equations *equations, bool is_first)
{
    double *sizes = is_first ? newton->scale : newton->trial_unknowns;
    equations->scale(equations->self, sizes);
    for (int i = 0; i < newton->unknown_count; i++) newton->scale[i] = tvi_smaller(sizes[i], newton->scale[i]);
    newton_raise_scales_of_small_unknowns(newton);
}

/* Makes one pass: correction = -K^-1 r(x). */
static tvi_status run_newton_pass(tvi_newton *newton, const tvi_equations *equations, int count, bool needs_scales,
                                  bool by_differences, tvi_stats *stats)
{
    tvi_status status = equations->residual(equations->self, newton->x, newton->correction);
    if (status != TVI_OK) return status;
    if (needs_scales) compute_scales(newton, equations, count == 1);
    for (int i = 0; i < newton->unknown_count; i++) newton->correction[i] = -newton->correction[i];
    if (by_differences || (!newton->is_jacobian_by_differences && equations->jacobian)) {
        status = factor_jacobian(newton, equations, by_differences, stats);
        /* The differences have evaluated the equations at other points. A last evaluation makes x the point of the last
         * residual again. */
        if (status == TVI_OK && by_differences)
            status = equations->residual(equations->self, newton->x, newton->trial_residual);
        if (status != TVI_OK) return status;
    }
    solve_with_jacobian(newton, equations, newton->correction);
    for (int i = 0; i < newton->unknown_count; i++)
        if (!isfinite(newton->correction[i])) return TVI_ENONFINITE;
    stats->passes++;
    return TVI_OK;
}

tvi_status tvi_newton_solve(tvi_newton *newton, const tvi_equations *equations, tvi_stats *stats)
{
    const tvi_newton_rules *rules = &newton->rules;
    tvi_newton_convergence_record record;
    tvi_newton_begin_passes(&record, *newton->max_contraction_ratio_growth, &newton->rules,
                            newton->confirms_convergence_by_extra_pass);
    int refreshes = 0;
    bool by_differences = false, needs_scales = true;
    for (int count = 1; count <= rules->per_unknown_correction_rule.max_passes; count++) {
        refreshes += by_differences;
        newton->is_jacobian_by_differences = newton->is_jacobian_allocated && refreshes > 0;
        const tvi_status status = run_newton_pass(newton, equations, count, needs_scales,
                                                  newton->is_jacobian_allocated && by_differences, stats);
        if (status != TVI_OK) return status;
        const tvi_correction_sizes sizes = newton_measure_corrections(newton, newton->scale);
        stats->residual = sizes.largest_relative_correction;
        tvi_passes_verdict verdict = tvi_newton_judge_pass(&record, rules, &sizes);
        if (verdict == TVI_PASSES_STUCK && is_correction_roundoff(newton, equations, &record))
            verdict = TVI_PASSES_MAY_END;
        if (verdict == TVI_PASSES_MAY_END) {
            *newton->max_contraction_ratio_growth =
                tvi_larger(*newton->max_contraction_ratio_growth, record.ratio_growth);
            return TVI_OK;
        }
        for (int i = 0; i < newton->unknown_count; i++) newton->x[i] += newton->correction[i];
        needs_scales = sizes.largest_relative_correction > NEWTON_SAME_SCALE_MAX_CORRECTION;
        by_differences = verdict == TVI_PASSES_STUCK;
        if (by_differences && refreshes == NEWTON_MAX_REFRESHES) return TVI_ENOCONV;
    }
    return TVI_ENOCONV;
}
