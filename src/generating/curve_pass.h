/* curve_pass.h - declares a pass of several members of an ensemble that each correct a curve (curve_batch.c): lane m of
 * a sweep is member m; at the nodes it is lane node * width + m. */
#ifndef TVI_SRC_GENERATING_CURVE_PASS_H
#define TVI_SRC_GENERATING_CURVE_PASS_H

#include "generating/curve_loops.h"
#include "generating/curve_stepper.h"
#include "generating/taylor_loops.h"
#include "method/single.h"

typedef enum { TVI_LEFT_ALONE, TVI_MOVING, TVI_DONE, TVI_BY_ITSELF } tvi_curve_progress;

/* These are the weights of sums over the orders of coefficients of q, or of a Hamiltonian's p, which stand after those
 * of q. */
typedef struct {
    bool of_momentum;
    tvi_weights weights;
} tvi_curve_sums;

/* These sums over q and u give the defects of one component: [points][width]. */
enum { TVI_SUM_Q, TVI_SUM_U, TVI_SUM_Q_SLOPE, TVI_SUM_U_SLOPE, TVI_SUMS };

typedef struct {
    tvi_single by_itself;
    tvi_curve_work *single; /* the work of a single step, which has the tables of the curve */
    tvi_action action;      /* the tables of the nodes, each node once */
    const tvi_system *system;
    const tvi_mean_closing *closing;
    const tvi_taylor_loops *series;
    const tvi_curve_loops *loops;
    tvi_taylor_lanes curve, tangent; /* tangent: one direction after the other */
    tvi_curve_members members;
    double *J;                       /* [2n][top + 1][inputs][width] dQ_k/dz, and dP_k/dz of a Hamiltonian */
    double *full, *back;             /* [2n][2n][width] transposed: of D and of the corrector; then their factors */
    double *seed;                    /* [top + 1][inputs][width]; then what the last correction changes of them */
    double *values, *change;         /* [2n][width] sums of the curve, and what the last correction changes of them */
    double *x;                       /* block of the field's values, node * width + m */
    double *at_nodes[TVI_SUMS];      /* [points][width] of one component */
    double *defect;                  /* [2][points][width] of one component: what multiplies dq_i, dp_i / kappa */
    double *dq, *dp, *share, *ratio; /* [n][width] the increments; share, ratio: scratch */
    tvi_taylor_sums sizes;           /* the sums of sizes: size and bend, [n][width] */
    double *tail;                    /* [width] */
    tvi_curve_sums node_sums[TVI_SUMS]; /* at all nodes */
    tvi_weights seeds_q, seeds_p;       /* from the defects */
    double *q_sizes, *z_sizes;          /* [top + 1] weights of the natural sizes */
    long long *is_moving;               /* [width] */
    tvi_curve_progress *progress;       /* [width] */
    tvi_newton_rules rules;
    tvi_newton_passes *passes;   /* [width] */
    tvi_newton_history *history; /* [width] */
} tvi_curve_batch_work;

/* Leaves a member out: it makes its step by itself. */
static inline void tvi_curve_leave(tvi_curve_batch_work *w, int m)
{
    w->progress[m] = TVI_BY_ITSELF;
    w->is_moving[m] = 0;
}

/* Predicts z at the centre, by the curves from the starts (q0, kappa p0) that z holds. */
void tvi_curve_predict_members(tvi_curve_batch_work *w, const tvi_batch_origin *origin);
/* Computes all that follows from z: curves, Jacobians, corrections of the ends, and the correction of z with its sizes;
 * the first pass also computes the natural sizes of z. */
void tvi_curve_pass(tvi_curve_batch_work *w, const tvi_batch_origin *origin, bool is_first);
/* Computes dq, dp and the tails [width] of the steps, with the last correction to first order. */
void tvi_curve_finish_members(tvi_curve_batch_work *w);

#endif
