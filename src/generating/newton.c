/* newton.c - solves the equations of a method by Newton passes with an approximate Jacobian, until the corrections are
 * roundoff (newton.h). The steppers step.c and both_ends.c call it. The contraction ratio of a pass is the size of its
 * correction divided by that of the correction before it, and its growth the factor by which the ratio grows from one
 * pass to the next. */
#include "generating/newton.h"
#include "method/stepper.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* [passes] Newton's method fails after this many passes. */
#define NEWTON_MAX_PASSES 64 /* found: make check-generating */
/* [Jacobians] The most that a step renews, after passes that did not contract; and how often its tests of convergence
 * begin anew. */
#define NEWTON_MAX_REFRESHES 3 /* found: make check-generating */
/* [1] Scales are computed again after a correction larger than this part of one. */
#define NEWTON_SAME_SCALE 0.5 /* found: make check-generating */
/* [1] Corrections that no longer shrink are roundoff if they are at most this part of the largest unknowns, or of the
 * numbers from which the residual is computed. */
#define NEWTON_STALLED_CORRECTION (256 * DBL_EPSILON) /* found: make check-generating */
/* [1] Larger corrections are no roundoff, and show the growth of the contraction ratio. */
#define NEWTON_GROWTH_MIN_CORRECTION 1e-13 /* found: make check-generating */
/* [1] An extra pass confirms that the unknowns were converged if its correction is at most this. */
#define NEWTON_CHECK_MAX_CORRECTION (8 * DBL_EPSILON) /* found: make check-generating */
/* [1] The expected size of a correction allows for growth of the contraction ratio by at most this factor. */
#define NEWTON_MAX_RATIO_GROWTH 1e6 /* found: make check-generating */

/* The sizes of the corrections of a pass: the largest correction relative to its unknown's scale, and the largest
 * correction of a group relative to the largest scale of the group. */
typedef struct {
    double largest_of_unknowns, largest_of_groups;
} correction_sizes;

/* The passes of a solution so far. */
typedef struct {
    tvi_convergence_test unknowns, groups; /* the tests of the two sizes of a correction */
    double growth;                         /* the growth for which the expected size of the next correction allows */
    double unconfirmed; /* a greater growth that the last correction suggests and that no later one has confirmed */
    bool must_confirm;  /* whether one more pass must confirm the expected convergence */
} newton_progress;

/* ---- Scales and sizes -------------------------------------------------------------------------------------------- */

/* Raises the scales of the small unknowns in the entries begin .. end - 1 of the list of components, a subsystem, group
 * by group. A scale of 0 becomes the largest scale of the group in the subsystem, or 1 if all are 0. Any other scale is
 * raised to at least NEWTON_MIN_SCALE times the largest one, and to DBL_MIN. An unknown that is much smaller than the
 * others of its group, such as a body that a wave has not reached, is thus measured by these. */
static void raise_small_scales(const tvi_newton *newton, int begin, int end)
{
    for (int first = 0; first < newton->size; first += newton->group) {
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

/* Computes the scales of the unknowns. The first call sets them to the natural sizes at the prediction. A later call
 * follows a correction that has moved an unknown by about its scale (NEWTON_SAME_SCALE), so that the size at the
 * prediction was a poor guess of the size of the solution. Such a call replaces a scale by the natural size at the new
 * point if that is smaller, and sets *scale_fell. It does not replace a scale by a larger size: if the series
 * diverge, their terms can have any size, and corrections relative to that size would seem small. The function fails if
 * a size is not finite, because each correction relative to it would be 0. */
static tvi_status compute_scales(tvi_newton *newton, const tvi_equations *equations, bool is_first, bool *scale_fell)
{
    const tvi_subsystems *subsystems = newton->subsystems;
    double *sizes = is_first ? newton->scale : newton->trial_x;
    equations->scale(equations->self, sizes);
    if (!tvi_all_finite(newton->size, sizes)) return TVI_ENONFINITE;
    for (int i = 0; i < newton->size; i++)
        if (sizes[i] > 0 && sizes[i] < newton->scale[i]) {
            newton->scale[i] = sizes[i];
            *scale_fell = true;
        }
    for (int k = 0, begin = 0, end; k < subsystems->count; k++, begin = end) {
        end = tvi_subsystems_end(subsystems, k, newton->group);
        raise_small_scales(newton, begin, end);
    }
    return TVI_OK;
}

/* Measures the corrections of one subsystem, for the entries begin .. end - 1 of the list of components. `scale` is
 * newton->scale or newton->roundoff_scale. */
static void measure_subsystem(const tvi_newton *newton, const double scale[], int begin, int end,
                              correction_sizes *sizes)
{
    for (int first = 0; first < newton->size; first += newton->group) {
        double largest = 0, largest_scale = 0;
        for (int k = begin; k < end; k++) {
            const int i = first + tvi_subsystems_component_at(newton->subsystems, k);
            const double size = fabs(newton->correction[i]);
            sizes->largest_of_unknowns = tvi_larger(size / scale[i], sizes->largest_of_unknowns);
            largest = tvi_larger(size, largest);
            largest_scale = tvi_larger(scale[i], largest_scale);
        }
        sizes->largest_of_groups = tvi_larger(largest / largest_scale, sizes->largest_of_groups);
    }
}

static correction_sizes measure_corrections(const tvi_newton *newton, const double scale[])
{
    const tvi_subsystems *subsystems = newton->subsystems;
    correction_sizes sizes = {0, 0};
    for (int k = 0, begin = 0, end; k < subsystems->count; k++, begin = end) {
        end = tvi_subsystems_end(subsystems, k, newton->group);
        measure_subsystem(newton, scale, begin, end, &sizes);
    }
    return sizes;
}

/* ---- The end of the passes --------------------------------------------------------------------------------------- */

void tvi_newton_set_rules(tvi_newton *newton, const tvi_options *options, bool makes_extra_pass)
{
    /* Passes end if the next correction is expected to be half a unit of roundoff or less. If each correction is
     * PASSES_STALL_RATIO times the one before it, this takes 53 passes. */
    const tvi_stopping_rule unknown_rule = {.max_passes = NEWTON_MAX_PASSES,
                                            .correction_goal = DBL_EPSILON / 2,
                                            .max_trusted_ratio = 1,
                                            .stall_ratio = PASSES_STALL_RATIO,
                                            .stall_comparison_lag = 1};
    newton->makes_extra_pass = makes_extra_pass;
    newton->unknown_rule = tvi_passes_rule_with_options(&unknown_rule, options, options->tolerance);
    /* Passes without a Jacobian are not stuck as long as the corrections of the groups shrink. In each pass corrections
     * spread from a body to its neighbours only; those of the bodies that are reached last also shrink last. */
    newton->group_rule = newton->has_jacobian
                             ? (tvi_stopping_rule){.stall_comparison_lag = 1}
                             : (tvi_stopping_rule){.stall_ratio = PASSES_STALL_RATIO, .stall_comparison_lag = 2};
    /* In these cases the corrections of q follow from those of p in the pass before, and those of p from those of q. A
     * correction may then be larger than the one before it although the passes converge, and is compared with the two
     * before it. */
    if (!newton->has_jacobian || makes_extra_pass) newton->unknown_rule.stall_comparison_lag = 2;
}

/* Begins the passes of a solution. The first contraction is often better than the later ones: first corrections are
 * mostly of the highest orders, on which the part of the Jacobian that the approximation omits has little effect. The
 * first solution therefore makes one pass more than seems needed, and measures the later contraction. */
static newton_progress begin_passes(const tvi_newton *newton)
{
    const double known_growth = *newton->known_growth;
    newton_progress record = {.growth = tvi_larger(known_growth, 1),
                              .must_confirm = newton->unknown_rule.exact_passes == 0 &&
                                              newton->unknown_rule.max_trusted_ratio > 0 &&
                                              (known_growth == 0 || newton->makes_extra_pass)};
    tvi_convergence_begin(&record.unknowns, 0);
    tvi_convergence_begin(&record.groups, 0);
    return record;
}

/* Updates the growth of the contraction ratio, after a correction of this size. A greater growth that one correction
 * suggests is accepted only if the next correction contracts again, because roundoff does not contract. */
static void update_ratio_growth(newton_progress *record, const tvi_stopping_rule *rule, double size)
{
    const tvi_convergence_test *test = &record->unknowns;
    const bool contracts = size <= rule->stall_ratio * test->size;
    if (test->count < 2) return;
    if (contracts)
        record->growth = tvi_smaller(tvi_larger(record->growth, record->unconfirmed), NEWTON_MAX_RATIO_GROWTH);
    const double growth = test->ratio_growth * size / test->expected_next_size;
    record->unconfirmed = contracts && size > NEWTON_GROWTH_MIN_CORRECTION ? growth : 0;
}

/* Adds a pass with corrections of these sizes, and judges it. If it returns TVI_PASSES_STUCK, the caller measures
 * whether the correction is roundoff. */
static tvi_passes_verdict judge_pass(newton_progress *record, const tvi_newton *newton, const correction_sizes *sizes)
{
    const tvi_stopping_rule *rule = &newton->unknown_rule;
    const double expected = record->unknowns.expected_next_size;
    update_ratio_growth(record, rule, sizes->largest_of_unknowns);
    record->unknowns.ratio_growth = tvi_larger(record->growth, record->unconfirmed);
    const tvi_passes_verdict verdict = tvi_convergence_add_pass(&record->unknowns, rule, sizes->largest_of_unknowns);
    const tvi_passes_verdict of_groups =
        tvi_convergence_add_pass(&record->groups, &newton->group_rule, sizes->largest_of_groups);
    const bool is_confirmed =
        expected <= rule->correction_goal && sizes->largest_of_unknowns <= NEWTON_CHECK_MAX_CORRECTION;
    if (verdict == TVI_PASSES_MAY_END && record->must_confirm && sizes->largest_of_unknowns > 0 && !is_confirmed)
        return TVI_PASSES_GO_ON;
    if (verdict != TVI_PASSES_STUCK) return verdict;
    if (sizes->largest_of_groups <= NEWTON_STALLED_CORRECTION) return TVI_PASSES_MAY_END;
    return of_groups == TVI_PASSES_STUCK ? TVI_PASSES_STUCK : TVI_PASSES_GO_ON;
}

/* ---- The corrections --------------------------------------------------------------------------------------------- */

void tvi_newton_allocate(tvi_newton *newton, tvi_arena *arena, int groups, const tvi_system *system, bool has_jacobian)
{
    *newton = (tvi_newton){.has_jacobian = has_jacobian,
                           .size = groups * system->n,
                           .group = system->n,
                           .subsystems = &system->subsystems};
    tvi_arena_allocate_each(arena, (size_t)newton->size,
                            (double **[]){&newton->x, &newton->correction, &newton->scale, &newton->roundoff_scale,
                                          &newton->trial_x, &newton->trial_r, NULL});
    if (has_jacobian) tvi_factor_allocate(&newton->factor, arena, newton->size);
    newton->known_growth = tvi_arena_allocate_copied(arena, sizeof *newton->known_growth);
}

/* Computes dr/dx by forward differences, for steps so large that passes with the approximate Jacobian do not contract.
 * newton->correction holds -r(x). */
static tvi_status differentiate_residual(tvi_newton *newton, const tvi_equations *equations)
{
    const int size = newton->size;
    double *x = newton->trial_x, *r = newton->trial_r;
    for (int column = 0; column < size; column++) {
        memcpy(x, newton->x, (size_t)size * sizeof *x);
        x[column] +=
            sqrt(DBL_EPSILON) * fmax(fmax(newton->roundoff_scale[column], TVI_LEAST_SIZE), fabs(newton->x[column]));
        const double step = x[column] - newton->x[column];
        const tvi_status status = equations->residual(equations->self, x, r);
        if (status != TVI_OK) return status;
        for (int row = 0; row < size; row++)
            newton->factor.lu[row * size + column] = (r[row] + newton->correction[row]) / step;
    }
    return TVI_OK;
}

/* Computes vector <- K^-1 vector, with K the Jacobian by differences, once there is one, otherwise the approximate
 * Jacobian. */
static void solve_with_jacobian(const tvi_newton *newton, const tvi_equations *equations, double vector[])
{
    if (newton->is_by_differences || equations->jacobian) tvi_factor_solve(&newton->factor, vector);
    else if (equations->solve) equations->solve(equations->self, vector);
}

/* Returns whether the last correction, which did not shrink, is as small as the corrections that the residual's
 * roundoff causes, and that of the unknowns themselves, which may be much larger than they were at the prediction. To
 * each scale is added a multiple of the change of the unknown by that roundoff, so that NEWTON_STALLED_CORRECTION times
 * the sum is at least ROUNDOFF_MAX_UNITS times the change. The linear equations are solved for the roundoff of each
 * group of the residual separately, and the magnitudes of the solutions are added, so that the groups cannot cancel
 * each other. */
static bool is_correction_roundoff(tvi_newton *newton, const tvi_equations *equations, newton_progress *record)
{
    const size_t bytes = (size_t)newton->size * sizeof(double);
    double *change = newton->trial_x, *roundoff = newton->trial_r;
    memcpy(newton->roundoff_scale, newton->scale, bytes);
    equations->roundoff(equations->self, roundoff);
    for (int first = 0; first < newton->size; first += newton->group) {
        memset(change, 0, bytes);
        memcpy(change + first, roundoff + first, (size_t)newton->group * sizeof *change);
        solve_with_jacobian(newton, equations, change);
        for (int i = 0; i < newton->size; i++)
            if (isfinite(change[i]))
                newton->roundoff_scale[i] += ROUNDOFF_MAX_UNITS / NEWTON_STALLED_CORRECTION * fabs(change[i]);
    }
    for (int i = 0; i < newton->size; i++)
        newton->roundoff_scale[i] += DBL_EPSILON / NEWTON_STALLED_CORRECTION * fabs(newton->x[i]);
    if (measure_corrections(newton, newton->roundoff_scale).largest_of_groups > NEWTON_STALLED_CORRECTION) return false;
    record->growth = 1; /* the corrections are roundoff, and show no contraction */
    return true;
}

/* Begins the tests of convergence anew, since corrections relative to smaller scales are no larger for that. */
static void forget_sizes(newton_progress *record, const tvi_stopping_rule *rule)
{
    if (rule->exact_passes > 0) return;
    tvi_convergence_begin(&record->unknowns, 0);
    tvi_convergence_begin(&record->groups, 0);
    record->unconfirmed = 0;
}

/* Computes the correction of a pass, -K^-1 r(x), from the residual in newton->correction. */
static tvi_status compute_correction(tvi_newton *newton, const tvi_equations *equations, bool by_differences,
                                     tvi_stats *stats)
{
    tvi_status status = TVI_OK;
    for (int i = 0; i < newton->size; i++) newton->correction[i] = -newton->correction[i];
    if (by_differences) {
        status = differentiate_residual(newton, equations);
        if (status == TVI_OK) stats->factorisations++;
        if (status == TVI_OK) status = tvi_factor_compute(&newton->factor);
        /* The differences have evaluated the equations at other points. A last evaluation makes x the point of the last
         * residual again. */
        if (status == TVI_OK) status = equations->residual(equations->self, newton->x, newton->trial_r);
    } else if (!newton->is_by_differences && equations->jacobian &&
               equations->jacobian(equations->self, newton->factor.lu)) {
        stats->factorisations++;
        status = tvi_factor_compute(&newton->factor);
    }
    if (status != TVI_OK) return status;
    solve_with_jacobian(newton, equations, newton->correction);
    if (!tvi_all_finite(newton->size, newton->correction)) return TVI_ENONFINITE;
    stats->passes++;
    return TVI_OK;
}

tvi_status tvi_newton_solve(tvi_newton *newton, const tvi_equations *equations, tvi_stats *stats)
{
    newton_progress record = begin_passes(newton);
    int refreshes = 0, restarts = 0;
    bool is_stuck = false, needs_scales = true;
    for (int count = 1; count <= newton->unknown_rule.max_passes; count++) {
        refreshes += is_stuck;
        newton->is_by_differences = newton->has_jacobian && refreshes > 0;
        bool scale_fell = false;
        tvi_status status = equations->residual(equations->self, newton->x, newton->correction);
        if (status == TVI_OK && needs_scales) status = compute_scales(newton, equations, count == 1, &scale_fell);
        if (status == TVI_OK) status = compute_correction(newton, equations, newton->has_jacobian && is_stuck, stats);
        if (status != TVI_OK) return status;
        /* A correction of roundoff may be as large as a small scale, and make it fall for ever. */
        if (scale_fell && restarts++ < NEWTON_MAX_REFRESHES) forget_sizes(&record, &newton->unknown_rule);
        const correction_sizes sizes = measure_corrections(newton, newton->scale);
        stats->residual = sizes.largest_of_unknowns;
        tvi_passes_verdict verdict = judge_pass(&record, newton, &sizes);
        if (verdict == TVI_PASSES_STUCK && is_correction_roundoff(newton, equations, &record))
            verdict = TVI_PASSES_MAY_END;
        if (verdict == TVI_PASSES_MAY_END) {
            *newton->known_growth = tvi_larger(*newton->known_growth, record.growth);
            return TVI_OK;
        }
        for (int i = 0; i < newton->size; i++) newton->x[i] += newton->correction[i];
        needs_scales = sizes.largest_of_unknowns > NEWTON_SAME_SCALE;
        is_stuck = verdict == TVI_PASSES_STUCK;
        if (is_stuck && refreshes == NEWTON_MAX_REFRESHES) return TVI_ENOCONV;
    }
    return TVI_ENOCONV;
}
