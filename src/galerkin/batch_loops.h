/* batch_loops.h - the loops of the Galerkin curves of several members at once (batch.c), compiled once for each
 * instruction set: those of loops.h with the members as the fastest lanes, so that no sum runs across lanes. */
#ifndef TVI_SRC_GALERKIN_BATCH_LOOPS_H
#define TVI_SRC_GALERKIN_BATCH_LOOPS_H

#include "algebra/passes.h"
#include "galerkin/halves.h"
#include "galerkin/loops.h"

/* Unknown u of node i of member m stands at x[u][i][m]; tables of the nodes are those of one curve, whose rows are
 * `stride` numbers apart. The rest as in galerkin_nodes. */
typedef struct {
    int width, points, unknowns, stride;
    bool is_first; /* the pass: before it, impulses are none */
    double *x;
    double *start;        /* [unknowns][width] */
    double *high, *low;   /* [unknowns][points][width]; x = high + low: where they would be without F, in two parts,
                           * of which passes add to low */
    double *weight;       /* [points] */
    double *impulse;      /* [unknowns][points][width] */
    double *scale;        /* [unknowns] */
    double *inverse_size; /* [unknowns][width] */
    double *per_movement; /* [n] */
    tvi_subsystems parts;
    long long *is_moving; /* [width] all bits, or none: the impulses of the others stay, and so do their unknowns */
    long long *in_lanes;  /* [width] alike: what their steps leave behind stays */
} galerkin_batch_nodes;

/* Where the drift h M^-1 p0 of a separable system is, [unknowns][width] each; NULL of other systems. */
typedef struct {
    double *high, *low;
} galerkin_batch_drift;

/* The last two steps of each member, as in galerkin_history, [width] each. */
typedef struct {
    double *h, *h_before, *t, *slowest;
} galerkin_batch_history;

/* What the passes of each member have shown (algebra/passes.h), [width] each. */
typedef struct {
    double *size, *before, *part, *slowest, *shown, *count;
    long long *is_stuck;
} galerkin_batch_passes;

typedef struct {
    void (*start)(const galerkin_batch_nodes *nodes, int first, int count, const double *q, const double *q_low);
    void (*start_drifting)(const galerkin_batch_nodes *nodes, const double c[], const tvi_batch_origin *origin,
                           const galerkin_batch_drift *drift);
    /* inverse_size, as galerkin_set_sizes has it. */
    void (*set_sizes)(const galerkin_batch_nodes *nodes, int n);
    /* From the impulses of the last two steps, matrix [2][j][i]. */
    void (*predict)(const galerkin_batch_nodes *nodes, const double *matrix, const double *last, const double *before);
    /* As that of loops.h, by what the impulses have changed since the pass before; drives are none of the unknowns.
     * moved [width]. */
    void (*move)(const galerkin_batch_nodes *nodes, const galerkin_halves *halves, const double *drives,
                 const int slot[], double moved[]);
    /* In lanes, and moving, are those that are TVI_OK and whose last two steps have the size h, and end where this one
     * begins, and their passes begin as slow as the last ones were. Returns how many. */
    int (*begin)(const galerkin_batch_nodes *nodes, const galerkin_batch_history *last, double h, const double t[],
                 const tvi_status status[], const galerkin_batch_passes *passes);
    /* tvi_passes_judge of the pass number `count` for all members that move: those that may end, or
     * are stuck, move no more. Returns how many go on; *any_stuck: some have become stuck. */
    int (*judge)(const galerkin_batch_nodes *nodes, const tvi_passes_rule *rule, int count, const double moved[],
                 const galerkin_batch_passes *passes, bool *any_stuck);
    /* sums [unknowns][width] */
    void (*integrate)(const galerkin_batch_nodes *nodes, const galerkin_weights *weights, const galerkin_sums *sums);
    /* Of the members in lanes: to = from, of so many rows. */
    void (*choose)(const galerkin_batch_nodes *nodes, int rows, const double *from, double *to);
    void (*end)(const galerkin_batch_nodes *nodes, int first, int count, const double *once, double *rise);
    void (*end_drifting)(const galerkin_batch_nodes *nodes, const galerkin_sums *sums,
                         const galerkin_batch_drift *drift, double *dq, double *dq_low);
    /* q, p, dp, tail: [n][width]; share, ratio: scratch. */
    void (*tail)(const galerkin_motion *of, int width, double *share, double *ratio, double tail[]);
} galerkin_batch_loops;

extern const galerkin_batch_loops tvi_galerkin_batch_loops_base, tvi_galerkin_batch_loops_avx2,
    tvi_galerkin_batch_loops_avx512;

#endif
