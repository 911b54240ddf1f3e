/* steady.h - a step in one function, with every size a constant, which generated code has (emitted_loops.h): one that
 * begins where the last two ended, all of one size, and whose passes end at the goal. All others are galerkin.c's. */
#ifndef TVI_SRC_GALERKIN_STEADY_H
#define TVI_SRC_GALERKIN_STEADY_H

#include "algebra/passes.h"
#include "galerkin/loops.h"

/* What all steps of an integrator share. */
typedef struct galerkin_frame {
    const galerkin_nodes *nodes;
    const galerkin_motion *motion;
    const galerkin_weights *weights;
    const tvi_passes_rule *rule;
    const double *matrix, *extrapolation, *c;
    double *drift, *drift_low, *share, *ratio;
    const double *h;
    void *own; /* of the form of the field: lagrangian_passes of a Lagrangian */
} galerkin_frame;

/* One step: the impulses of the last one and of the one before; what it does, but for its impulses, which are in the
 * nodes. */
typedef struct galerkin_outcome {
    const double *impulses[2];
    double *dq, *dp;
    tvi_passes passes; /* their count, the last size, and the slowest; of the steps before: that, and `early` */
    double tail;
    int factors; /* of second derivatives at the nodes, so often were they taken */
} galerkin_outcome;

/* 1 / (|start| + |predicted end - start|). No branches: which is the larger changes from step to step. */
static inline void galerkin_set_sizes(const galerkin_nodes *nodes, int n)
{
    const double *last = nodes->x + nodes->lanes - 1;
    for (int first = 0; first < nodes->unknowns; first += n) {
        double largest = 0;
        for (int u = first; u < first + n; u++) {
            const double start = nodes->start[u], size = fabs(start) + fabs(last[u * nodes->lanes] - start);
            nodes->inverse_size[u] = size;
            largest = tvi_larger(size, largest);
        }
        const double share = TVI_GALERKIN_LEAST_SHARE * largest, least = share > 0 ? share : 1;
        for (int u = first; u < first + n; u++) nodes->inverse_size[u] = 1 / (nodes->inverse_size[u] + least);
    }
}

/* Of equations of first order. */
static inline void galerkin_end(const galerkin_nodes *nodes, const galerkin_sums *sums, int n, double dq[], double dp[])
{
    for (int i = 0; i < n; i++) {
        dq[i] = nodes->scale[i] * sums->once[i];
        dp[i] = nodes->scale[n + i] * sums->once[n + i];
    }
}

#endif
