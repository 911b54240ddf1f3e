/* step.h - what a step of the Galerkin curve is made with (galerkin.c), for those of several members, too (batch.c). */
#ifndef TVI_SRC_GALERKIN_STEP_H
#define TVI_SRC_GALERKIN_STEP_H

#include "galerkin/passes.h"
#include "galerkin/predictor.h"
#include "galerkin/steady.h"

typedef struct {
    const tvi_options *options;
    int n;
    galerkin_field field;
    galerkin_coefficients coefficients;
    galerkin_predictor predictor;
    galerkin_probe probe;
    tvi_passes_rule rule;
    galerkin_dense dense;
    double *drift, *drift_low; /* [unknowns] h M^-1 p0 of a separable system, in two parts; else 0 */
    double *share, *ratio;     /* [n] of the tail */
    double *begun;             /* [2n] q and p where the last step of a row began */
    double *folded;            /* of few unknowns: folded.h; else NULL */
    double folded_h;           /* of steps of this size; 0: none yet */
    double *rise;              /* [2n] what multiplies the integrals of the impulses in q and p */
    galerkin_motion motion;
    galerkin_frame frame; /* of what stands above */
} galerkin;

/* What depends on the size of the step alone: the weights and scales of the nodes. */
void tvi_galerkin_set_size(galerkin *w, double h);

/* Whether generated code makes the steps. */
static inline bool tvi_galerkin_is_steady(const galerkin *w)
{
    return w->field.loops->steady && w->options->passes != TVI_PREDICT_ONLY;
}

/* What the passes of the step of the field's size have from the steps before. */
static inline galerkin_pace galerkin_pace_before(const galerkin *w)
{
    const galerkin_history *last = w->predictor.last;
    return w->field.h == last->h ? last->pace : (galerkin_pace){.slowest = 0};
}

/* Of the step whose sums are there, from the origin. */
double tvi_galerkin_tail(galerkin *w, const tvi_origin *origin, const double dp[]);
/* What generated code begins a step of the field's size with: how many before it are known and, where none is, the
 * unknowns. */
tvi_status tvi_galerkin_begin(galerkin *w, const tvi_origin *origin, int *known, tvi_stats *stats);
/* Steps by generated code, of the history, which remembers them; how many. */
long tvi_galerkin_make_steadily(galerkin *w, const tvi_row *row, const tvi_origin *origin, const tvi_run_state *now,
                                galerkin_outcome *to);
void tvi_galerkin_count(const galerkin *w, const galerkin_outcome *to, tvi_stats *stats);
/* Steps by generated code in a row: stepper.h. */
long tvi_galerkin_run(void *work, const tvi_row *row, const tvi_run_state *now, tvi_stats *stats);

/* Whether its passes know no second derivatives. */
bool tvi_galerkin_is_plain(const tvi_system *system);

#endif
