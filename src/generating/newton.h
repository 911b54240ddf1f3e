/* newton.h - the one corrector: preconditioned passes that end at roundoff (docs/method.md section 5). */
#ifndef TVI_SRC_GENERATING_NEWTON_H
#define TVI_SRC_GENERATING_NEWTON_H

#include "algebra/linear.h"
#include "algebra/passes.h"

/* What is smaller than this part of the largest of its kind is measured as if it had this size. */
static const double TVI_LEAST_SHARE = 1e-20;

/* The equations r(x) = 0 of a method. The functions are called with `self`. */
typedef struct {
    void *self;
    /* r(x) [size]. */
    tvi_status (*residual)(void *self, const double x[], double r[]);
    /* The natural size of each unknown [size], asked after the residual of the predictor: a correction below roundoff
     * of it is none. */
    void (*scale)(void *self, double scale[]);
    /* An approximate dr/dx [size][size] at the x of the last residual; NULL where the identity serves. false: the one
     * last given still serves, and the matrix is left alone. */
    bool (*jacobian)(void *self, double matrix[]);
    /* Instead of a matrix, correction <- (dr/dx)^-1 correction, approximately; NULL: see jacobian. */
    void (*solve)(void *self, double correction[]);
    /* How large the roundoff of each component of the residual last formed is at most, nearly: |what it is computed
     * from| times a unit of roundoff, which the size of the unknowns need not tell. Asked where passes no longer
     * contract. */
    void (*roundoff)(void *self, double r[]);
} tvi_equations;

/* What earlier solutions taught; in the arena's history. */
typedef struct {
    long solves;
    double slack; /* how much slower a later pass was seen to contract than the one before it; below 1 it is none */
} tvi_newton_history;

/* How large the corrections of a pass are: the largest relative to its unknown's scale; and the largest of a group
 * relative to the largest scale of the group. */
typedef struct {
    double relative, of_group;
} tvi_newton_size;

/* When passes may end, by the one and by the other size, and what they have shown so far of each. */
typedef struct {
    tvi_passes_rule of_each, of_largest;
} tvi_newton_rules;
typedef struct {
    tvi_passes of_each, of_largest;
} tvi_newton_passes;

tvi_newton_rules tvi_newton_rules_asked(const tvi_options *options, bool has_matrix, bool is_rough);
void tvi_newton_begin(tvi_newton_passes *passes, tvi_newton_history *history, const tvi_options *options,
                      bool is_rough);
/* Adds a pass with a correction of this size. TVI_PASSES_STUCK: the caller measures whether it is roundoff. */
tvi_passes_verdict tvi_newton_judge(tvi_newton_passes *passes, const tvi_newton_rules *rules, tvi_newton_size size);

typedef struct {
    bool has_matrix, is_fresh; /* is_fresh: the matrix is one by differences */
    bool is_rough;
    tvi_newton_rules rules;
    int size, group;                /* unknowns come in groups that share a unit */
    double *x, *correction, *scale; /* [size] */
    double *reach;              /* [size] the scale, and more where the roundoff of the corrections is that of more */
    double *trial, *difference; /* [size] scratch */
    tvi_factor factor;
    tvi_newton_history *history;
} tvi_newton;

/* has_matrix: whether there is room for a Jacobian, which equations that bring `solve` do without. */
void tvi_newton_take(tvi_newton *newton, tvi_arena *arena, int size, int group, bool has_matrix);

/* Once. is_rough: the first contraction tells little of the later ones: one more pass than seems needed, always. */
void tvi_newton_prepare(tvi_newton *newton, const tvi_options *options, bool is_rough);

/* From the predictor in newton->x. On success newton->x is the point of the last residual and newton->correction what
 * the last pass found to be missing from it: the caller applies it to first order, which leaves an error of
 * second order in the correction and saves the evaluation that would confirm it.
 * TVI_ENOCONV where passes do not contract, even with a fresh Jacobian by differences; else the status of the equations
 * or of the factorisation. Counts passes and factorisations, and sets stats->residual. */
TVI_NODISCARD tvi_status tvi_newton_solve(tvi_newton *newton, const tvi_equations *equations,
                                          const tvi_options *options, tvi_stats *stats);

#endif
