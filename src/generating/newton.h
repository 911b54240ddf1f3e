/* newton.h - declares the corrector, which solves a method's equations r(x) = 0 by passes x <- x - K^-1 r(x) with an
 * approximate Jacobian K, until the corrections are roundoff (docs/method.md section 5). The steppers
 * curve_stepper.c and both_ends.c call it. */
#ifndef TVI_SRC_GENERATING_NEWTON_H
#define TVI_SRC_GENERATING_NEWTON_H

#include "algebra/linear.h"
#include "algebra/passes.h"
#include "generating/series.h"

/* The equations r(x) = 0 of a method. Its functions are called with `self`. */
typedef struct {
    void *self;
    /* Computes the residual r(x); x and r have as many numbers as there are unknowns. */
    tvi_status (*residual)(void *self, const double x[], double r[]);
    /* Computes the natural size of each unknown. A correction below the roundoff of this size counts as 0. The function
     * is called once, after the residual of the predictor. */
    void (*scale)(void *self, double scale[]);
    /* Computes an approximate dr/dx at the x of the last residual; NULL: the Jacobian is the identity, or `solve` is
     * used. The function returns false, and leaves `matrix` alone, if the matrix of the last call can be reused. */
    bool (*jacobian)(void *self, double matrix[]);
    /* Computes correction <- (dr/dx)^-1 correction, approximately, without a matrix; NULL: `jacobian` is used, or the
     * Jacobian is the identity. */
    void (*solve)(void *self, double correction[]);
    /* Estimates an upper bound of the roundoff of each component of the last residual: a unit of roundoff times the
     * size of the numbers from which it was computed, which may be larger than the unknowns. The function is called if
     * passes no longer contract. */
    void (*roundoff)(void *self, double r[]);
} tvi_equations;

/* The sizes of the corrections of a pass: the largest correction relative to its unknown's scale, and the largest
 * correction of a group relative to the largest scale of the group. */
typedef struct {
    double largest_relative_correction, relative_group_correction;
} tvi_correction_sizes;

/* The rules by which passes end: per_unknown_correction_rule judges largest_relative_correction, and
 * per_group_correction_rule judges
 * relative_group_correction. */
typedef struct {
    tvi_stopping_rule per_unknown_correction_rule, per_group_correction_rule;
} tvi_newton_rules;
/* The passes of a solution so far: passes_measured_per_unknown records largest_relative_correction, and
 * passes_measured_per_group records
 * relative_group_correction. */
typedef struct {
    tvi_convergence_test passes_measured_per_unknown, passes_measured_per_group;
    /* The contraction ratio of a pass is the size of its correction divided by that of the correction before it.
     * contraction_ratio_growth is the factor by which this ratio may grow from one pass to the next; the expected size
     * of the next correction allows for it. unconfirmed_ratio_growth is a greater factor that the last correction
     * suggests and that no later correction has confirmed yet. */
    double contraction_ratio_growth, unconfirmed_ratio_growth;
    bool must_confirm_convergence; /* whether one more pass must confirm the expected convergence */
} tvi_newton_convergence_record;

/* Begins the passes of a solution. The first contraction is often better than the later ones: first corrections are
 * mostly of the highest orders, on which the part of the Jacobian that the approximation omits has little effect. The
 * first solution therefore makes one pass more than seems needed, and measures the later contraction. */
static inline void tvi_newton_begin_passes(tvi_newton_convergence_record *record, double max_contraction_ratio_growth,
                                           const tvi_newton_rules *rules, bool confirms_convergence_by_extra_pass)
{
    tvi_convergence_test_begin_iteration(&record->passes_measured_per_unknown, 0);
    tvi_convergence_test_begin_iteration(&record->passes_measured_per_group, 0);
    record->contraction_ratio_growth = tvi_larger(max_contraction_ratio_growth, 1);
    record->unconfirmed_ratio_growth = 0;
    record->must_confirm_convergence = rules->per_unknown_correction_rule.exact_passes == 0 &&
                                       rules->per_unknown_correction_rule.max_trusted_contraction_ratio > 0 &&
                                       (max_contraction_ratio_growth == 0 || confirms_convergence_by_extra_pass);
}

/* Updates the factor by which the contraction ratio may grow. A greater factor that one correction suggests is accepted
 * only if the next correction contracts again, because roundoff does not contract. */
static inline void tvi_newton_update_contraction_ratio_growth(tvi_newton_convergence_record *record,
                                                              const tvi_newton_rules *rules, double relative_correction)
{
    const tvi_convergence_test *each = &record->passes_measured_per_unknown;
    const bool shows = relative_correction <= rules->per_unknown_correction_rule.stall_contraction_ratio * each->size;
    if (each->count < 2) return;
    if (shows)
        record->contraction_ratio_growth = tvi_smaller(
            tvi_larger(record->contraction_ratio_growth, record->unconfirmed_ratio_growth), NEWTON_MAX_RATIO_GROWTH);
    const double growth = each->contraction_ratio_growth * relative_correction / each->expected_next_size;
    record->unconfirmed_ratio_growth = shows && relative_correction > NEWTON_GROWTH_MIN_CORRECTION ? growth : 0;
}

/* Adds a pass with corrections of these sizes, and judges it. If it returns TVI_PASSES_STUCK, the caller
 * measures whether the correction is roundoff. */
static inline tvi_passes_verdict tvi_newton_judge_pass(tvi_newton_convergence_record *record,
                                                       const tvi_newton_rules *rules, const tvi_correction_sizes *sizes)
{
    const double largest_relative_correction = sizes->largest_relative_correction,
                 relative_group_correction = sizes->relative_group_correction;
    const double expected = record->passes_measured_per_unknown.expected_next_size;
    tvi_newton_update_contraction_ratio_growth(record, rules, largest_relative_correction);
    record->passes_measured_per_unknown.contraction_ratio_growth =
        tvi_larger(record->contraction_ratio_growth, record->unconfirmed_ratio_growth);
    const tvi_passes_verdict verdict = tvi_convergence_test_add_pass(
        &record->passes_measured_per_unknown, &rules->per_unknown_correction_rule, largest_relative_correction);
    const tvi_passes_verdict settled = tvi_convergence_test_add_pass(
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

typedef struct {
    bool is_jacobian_allocated;              /* whether memory for a Jacobian matrix was allocated */
    bool is_jacobian_by_differences;         /* whether the Jacobian in that memory was computed by differences */
    bool confirms_convergence_by_extra_pass; /* whether each solution makes one pass more than seems needed */
    tvi_newton_rules rules;
    int unknown_count;                /* the number of unknowns */
    int unknowns_per_group;           /* the number of unknowns in one group; all unknowns of a group have one unit */
    const tvi_subsystems *subsystems; /* the subsystems of the components */
    double *x, *correction, *scale;   /* [unknown_count] the unknowns, their last corrections and natural sizes */
    double *roundoff_scale;           /* the scale plus a multiple of the unknown's change by the residual's roundoff */
    /* Scratch for the Jacobian by differences: the unknowns with one of them shifted, and the residual there. */
    double *trial_unknowns, *trial_residual;
    tvi_lu_factor factor;
    /* The largest factor by which the contraction ratio grew from one pass to the next in earlier solutions, or 0 if
     * there was none; part of the history. */
    double *max_contraction_ratio_growth;
} tvi_newton;

/* Measures the corrections of one subsystem in each group of unknowns, for the entries begin .. end - 1 of the list of
 * components. `scale` is newton->scale or newton->roundoff_scale. A correction that is not finite makes the sizes NaN,
 * since x - x is 0 for finite x only. */
static inline void newton_measure_subsystem_corrections(const tvi_newton *newton, const double scale[], int begin,
                                                        int end, tvi_correction_sizes *sizes)
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
static inline tvi_correction_sizes newton_measure_corrections(const tvi_newton *newton, const double scale[])
{
    const tvi_subsystems *subsystems = newton->subsystems;
    tvi_correction_sizes sizes = {0, 0};
    for (int k = 0, begin = 0, end; k < subsystems->count; k++, begin = end) {
        end = tvi_subsystems_end_in_component_list(subsystems, k, newton->unknowns_per_group);
        newton_measure_subsystem_corrections(newton, scale, begin, end, &sizes);
    }
    return sizes;
}

/* Raises the scales of the small unknowns in one subsystem, group by group. A scale of 0 becomes the largest scale of
 * the group in the subsystem, or 1 if all are 0. Any other scale is raised to at least NEWTON_MIN_SCALE times the
 * largest one, and to DBL_MIN. An unknown that is much smaller than the others of its group, such as a body that a wave
 * has not reached, is thus measured by these. */
static inline void newton_raise_small_scales_in_subsystem(const tvi_newton *newton, int begin, int end)
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

static inline void newton_raise_scales_of_small_unknowns(const tvi_newton *newton)
{
    const tvi_subsystems *subsystems = newton->subsystems;
    for (int k = 0, begin = 0, end; k < subsystems->count; k++, begin = end) {
        end = tvi_subsystems_end_in_component_list(subsystems, k, newton->unknowns_per_group);
        newton_raise_small_scales_in_subsystem(newton, begin, end);
    }
}

/* Allocates the corrector of equations with group_count groups of n unknowns. allocates_jacobian says whether it gets
 * memory for a Jacobian matrix; equations with a `solve` need none. */
void tvi_newton_allocate(tvi_newton *newton, tvi_arena *arena, int group_count, const tvi_system *system,
                         bool allocates_jacobian);

/* Sets the rules, once. confirms_convergence_by_extra_pass says that the first contraction is no measure of the later
 * ones, so that there is always one more pass than seems needed. */
void tvi_newton_set_pass_rules(tvi_newton *newton, const tvi_options *options, bool confirms_convergence_by_extra_pass);

/* Solves the equations from the predictor in newton->x. On success newton->x is the point of the last residual, and
 * newton->correction is the last correction, which has not been added. The caller applies it to first order, which
 * leaves an error of second order in the correction and saves one evaluation. Returns TVI_ENOCONV if passes do not
 * contract, even with a Jacobian by differences, otherwise the status of the equations or of the factorisation. Counts
 * passes and factorisations, and sets stats->residual. */
TVI_NODISCARD tvi_status tvi_newton_solve(tvi_newton *newton, const tvi_equations *equations, tvi_stats *stats);

#endif
