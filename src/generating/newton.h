/* newton.h - declares the corrector, which solves a method's equations r(x) = 0 by passes x <- x - K^-1 r(x) with an
 * approximate Jacobian K, until the corrections are roundoff (docs/method.md section 5). The steppers
 * curve_stepper.c and both_ends.c call it. Generated code includes this text. */
#ifndef TVI_SRC_GENERATING_NEWTON_H
#define TVI_SRC_GENERATING_NEWTON_H

#include "algebra/linear.h"
#include "algebra/passes.h"
#include "generating/series.h"

/* An unknown smaller than this part of the largest of its group in its subsystem is measured as if it had this size. */
static const double TVI_LEAST_RELATIVE_SCALE = 1e-20;

/* These are the equations r(x) = 0 of a method. The functions are called with `self`. */
typedef struct {
    void *self;
    /* Computes r(x) [size]. */
    tvi_status (*residual)(void *self, const double x[], double r[]);
    /* Computes the natural size of each unknown [size], after the residual of the predictor: a correction below the
     * roundoff of this size counts as none. */
    void (*scale)(void *self, double scale[]);
    /* Computes an approximate dr/dx [size][size] at the x of the last residual; NULL: the identity serves. It returns
     * false if the matrix last computed still serves, and then leaves `matrix` alone. */
    bool (*jacobian)(void *self, double matrix[]);
    /* Computes correction <- (dr/dx)^-1 correction, approximately, in place of a matrix; NULL: `jacobian` says what
     * serves. */
    void (*solve)(void *self, double correction[]);
    /* Estimates an upper bound of the roundoff of each component of the residual last formed: the size of what it is
     * computed from, times a unit of roundoff. The size of the unknowns need not show that. It is called if passes no
     * longer contract. */
    void (*roundoff)(void *self, double r[]);
} tvi_equations;

/* The corrector keeps these results of earlier solutions. */
typedef struct {
    double slack; /* the largest ratio of a pass's contraction factor to that of the pass before; 0: not yet measured */
} tvi_newton_history;

/* These are the sizes of the corrections of a pass: the largest relative to its unknown's scale; and the largest of a
 * group relative to the largest scale of the group. */
typedef struct {
    double relative, of_group;
} tvi_correction_size;
/* These are the same sizes of all members. */
typedef struct {
    double relative[CURVE_MOST_WIDTH], of_group[CURVE_MOST_WIDTH];
} tvi_correction_sizes;

/* The rules say when passes may end, by the one and by the other size. */
typedef struct {
    tvi_passes_rule of_each, of_largest;
} tvi_newton_rules;
/* The passes hold what has been seen so far of each size. */
typedef struct {
    tvi_passes of_each, of_largest;
    double slack, seen; /* the slack in use, and the slack that the last correction showed */
    bool checks;        /* whether one more pass must confirm the expected convergence */
} tvi_newton_passes;

/* Corrections that no longer shrink are roundoff if they are this small against the largest unknowns, or against the
 * numbers that the residual is computed from. */
#define NEWTON_STAGNATION (256 * DBL_EPSILON)

/* Corrections above this are no roundoff, and show slack; a pass that checks an expectation moves no more than this. */
#define NEWTON_SHOWS_SLACK 1e-13
#define NEWTON_CONFIRMS    (8 * DBL_EPSILON)
#define NEWTON_MOST_SLACK  1e6

/* Begins the passes of a solution. A first correction is mostly of the highest orders, and may have little of what the
 * matrix leaves out; then the later passes contract much less. The first solution shows this, since it makes a pass
 * more than seems needed. */
static inline void tvi_newton_begin_passes(tvi_newton_passes *passes, const tvi_newton_history *history,
                                           const tvi_newton_rules *rules, bool is_rough)
{
    tvi_passes_begin(&passes->of_each, 0);
    tvi_passes_begin(&passes->of_largest, 0);
    passes->slack = tvi_larger(history->slack, 1);
    passes->seen = 0;
    passes->checks =
        rules->of_each.exact_passes == 0 && rules->of_each.max_trusted_ratio > 0 && (history->slack == 0 || is_rough);
}

static inline void tvi_newton_store_slack(tvi_newton_history *history, const tvi_newton_passes *passes)
{
    history->slack = tvi_larger(history->slack, passes->slack);
}

/* Believes the slack that one correction showed if the next one contracts again: a correction that was roundoff has no
 * such successor. */
static inline void tvi_newton_update_slack(tvi_newton_passes *passes, const tvi_newton_rules *rules, double size)
{
    const tvi_passes *each = &passes->of_each;
    const bool shows = size <= rules->of_each.stall_ratio * each->size;
    if (each->count < 2) return;
    if (shows) passes->slack = tvi_smaller(tvi_larger(passes->slack, passes->seen), NEWTON_MOST_SLACK);
    const double slack = each->slack * size / each->next;
    passes->seen = shows && size > NEWTON_SHOWS_SLACK ? slack : 0;
}

/* Adds a pass with a correction of this size. If it returns TVI_PASSES_STUCK, the caller measures whether that is
 * roundoff. */
static inline tvi_passes_verdict tvi_newton_judge_pass(tvi_newton_passes *passes, const tvi_newton_rules *rules,
                                                       tvi_correction_size size)
{
    const double expected = passes->of_each.next;
    tvi_newton_update_slack(passes, rules, size.relative);
    passes->of_each.slack = tvi_larger(passes->slack, passes->seen);
    const tvi_passes_verdict verdict = tvi_passes_add_and_judge(&passes->of_each, &rules->of_each, size.relative);
    const tvi_passes_verdict settled = tvi_passes_add_and_judge(&passes->of_largest, &rules->of_largest, size.of_group);
    const bool is_confirmed = expected <= rules->of_each.correction_goal && size.relative <= NEWTON_CONFIRMS;
    if (verdict == TVI_PASSES_MAY_END && passes->checks && size.relative > 0 && !is_confirmed) return TVI_PASSES_GO_ON;
    if (verdict != TVI_PASSES_STUCK) return verdict;
    if (size.of_group <= NEWTON_STAGNATION) return TVI_PASSES_MAY_END;
    return settled == TVI_PASSES_STUCK ? TVI_PASSES_STUCK : TVI_PASSES_GO_ON;
}

typedef struct {
    bool has_matrix, is_fresh; /* is_fresh: the matrix was computed by finite differences */
    bool is_rough;
    tvi_newton_rules rules;
    int size, group;                /* the number of unknowns, and of those in a group, which share a unit */
    int width;                      /* the number of members; the member is the fastest index */
    const tvi_subsystems *parts;    /* the subsystems of the components */
    double *x, *correction, *scale; /* [size][width] */
    double *reach;                  /* [size] the scale, enlarged by the residual's roundoff */
    double *trial, *difference;     /* [size] scratch */
    tvi_lu_factor factor;
    tvi_newton_history *history; /* [width] */
} tvi_newton;

/* These sizes are constants in generated code, as those of series.h are. */
static inline int newton_count_unknowns(const tvi_newton *newton)
{
    (void)newton;
    return CURVE_SIZE(2 * CURVE_N, newton->size);
}

static inline int newton_count_group_unknowns(const tvi_newton *newton)
{
    (void)newton;
    return CURVE_SIZE(CURVE_N, newton->group);
}

/* Returns the index of unknown i of member m in arrays [size][width]. */
static inline int newton_index_of_unknown(const tvi_newton *newton, int i, int m)
{
    (void)newton;
    return i * CURVE_WIDTH(newton) + m;
}

/* Measures the corrections of one group in one subsystem. The unknowns of the group begin at `first`; member: the
 * components of the subsystem, or NULL: all. unit: the scales of the unknowns, or their reach. A correction that is no
 * number makes the sizes NaN: x - x is 0 for all other x. */
static inline void newton_measure_subsystem(const tvi_newton *newton, const double unit[], const int *member, int begin,
                                            int end, tvi_correction_sizes *sizes)
{
    const int width = CURVE_WIDTH(newton);
    double *restrict relative = sizes->relative, *restrict of_group = sizes->of_group;
    for (int first = 0; first < newton_count_unknowns(newton); first += newton_count_group_unknowns(newton)) {
        double largest[CURVE_MOST_WIDTH] = {0}, scale[CURVE_MOST_WIDTH] = {0}, rest[CURVE_MOST_WIDTH] = {0};
        for (int k = begin; k < end; k++) {
            const int at = newton_index_of_unknown(newton, first + (member ? member[k] : k), 0);
            for (int m = 0; m < width; m++) {
                const double correction = newton->correction[at + m], size = fabs(correction);
                rest[m] += correction - correction;
                relative[m] = tvi_larger(size / unit[at + m], relative[m]);
                largest[m] = tvi_larger(size, largest[m]);
                scale[m] = tvi_larger(unit[at + m], scale[m]);
            }
        }
        for (int m = 0; m < width; m++) {
            relative[m] += rest[m];
            of_group[m] = tvi_larger(largest[m] / scale[m], of_group[m]) + rest[m];
        }
    }
}

/* Measures the corrections of all members. */
static inline void newton_measure_corrections(const tvi_newton *newton, const double unit[],
                                              tvi_correction_sizes *sizes)
{
    const tvi_subsystems *parts = newton->parts;
    for (int m = 0; m < CURVE_WIDTH(newton); m++) sizes->relative[m] = sizes->of_group[m] = 0;
    if (parts->count == 1) newton_measure_subsystem(newton, unit, NULL, 0, newton_count_group_unknowns(newton), sizes);
    for (int k = 0, first = 0; parts->count > 1 && k < parts->count; first = parts->end[k++])
        newton_measure_subsystem(newton, unit, parts->component, first, parts->end[k], sizes);
}

/* Fills in the scale of unknowns that have none: the largest of the group in the subsystem, or 1. An unknown that is
 * much smaller than others there, such as a body that a wave has not reached, has no accuracy of its own. */
static inline void newton_fill_subsystem_scales(const tvi_newton *newton, int m, const int *member, int begin, int end)
{
    for (int first = 0; first < newton_count_unknowns(newton); first += newton_count_group_unknowns(newton)) {
        double largest = 0, *scale = newton->scale + newton_index_of_unknown(newton, first, m);
        for (int k = begin; k < end; k++)
            largest = tvi_larger(scale[newton_index_of_unknown(newton, member ? member[k] : k, 0)], largest);
        for (int k = begin; k < end; k++) {
            const int i = newton_index_of_unknown(newton, member ? member[k] : k, 0);
            if (scale[i] == 0) scale[i] = largest > 0 ? largest : 1;
            else scale[i] = tvi_larger(TVI_LEAST_RELATIVE_SCALE * largest, scale[i]);
        }
    }
}

static inline void newton_fill_missing_scales(const tvi_newton *newton, int m)
{
    const tvi_subsystems *parts = newton->parts;
    if (parts->count == 1) newton_fill_subsystem_scales(newton, m, NULL, 0, newton_count_group_unknowns(newton));
    for (int k = 0, first = 0; parts->count > 1 && k < parts->count; first = parts->end[k++])
        newton_fill_subsystem_scales(newton, m, parts->component, first, parts->end[k]);
}

/* Allocates the corrector. has_matrix: there is room for a Jacobian; equations that bring `solve` need none. */
void tvi_newton_allocate(tvi_newton *newton, tvi_arena *arena, int groups, const tvi_system *system, bool has_matrix,
                         int width);

/* Sets the rules, once. is_rough: the first contraction tells little of the later ones, so that there is always one
 * more pass than seems needed. */
void tvi_newton_set_rules(tvi_newton *newton, const tvi_options *options, bool is_rough);

/* Solves the equations from the predictor in newton->x. On success newton->x is the point of the last residual, and
 * newton->correction is what the last pass found to be missing from it. The caller applies the correction to first
 * order, which leaves an error of second order in the correction and saves the evaluation that would confirm it.
 * Returns TVI_ENOCONV if passes do not contract, even with a fresh Jacobian by differences, otherwise the status of the
 * equations or of the factorisation. Counts passes and factorisations, and sets stats->residual. */
TVI_NODISCARD tvi_status tvi_newton_solve(tvi_newton *newton, const tvi_equations *equations, tvi_stats *stats);

#endif
