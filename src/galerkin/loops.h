/* loops.h - the loops of the Galerkin curve in which all time but that of the field goes, compiled once for each
 * instruction set (ad/vector.h). Arrays of nodes are [lanes]; where lanes are more than nodes, the last node is
 * repeated, with weight 0. */
#ifndef TVI_SRC_GALERKIN_LOOPS_H
#define TVI_SRC_GALERKIN_LOOPS_H

#include "algebra/passes.h"
#include "algebra/subsystems.h"
#include "algebra/tail.h"
#include "method/origin.h"

#include <stdbool.h>
#include <stddef.h>

/* The numbers of lanes that there are: 1, 2, 4, 8 and MAX_LANES. */
enum { TVI_GALERKIN_MAX_LANES = 12, GALERKIN_LOOPS = 5 };
/* The steps whose impulses are kept: the last two, and the one that is made. */
enum { GALERKIN_TURNS = 3 };

/* Unknown u of node i stands at x[u][i] of one member, where lanes behind the nodes repeat the last one with weight 0;
 * of several, member m's at x[u][i][m]. */
typedef struct {
    int points, lanes, width; /* nodes, numbers of a row of the tables, members */
} galerkin_shape;

/* How the passes of a step went, which says how those of the next one will. Sizes as the passes have them; 0: not
 * known. */
typedef struct {
    double slowest; /* how far they contract */
    double first;   /* the size of the first movement, which is what the prediction was off */
} galerkin_pace;

/* How the passes of several members go (algebra/passes.h). */
enum { GALERKIN_MOST_WIDTH = 32 };
typedef struct {
    double moved[GALERKIN_MOST_WIDTH]; /* by the last pass, as `move` says */
    double size[GALERKIN_MOST_WIDTH], before[GALERKIN_MOST_WIDTH], part[GALERKIN_MOST_WIDTH],
        slowest[GALERKIN_MOST_WIDTH], shown[GALERKIN_MOST_WIDTH];             /* as in tvi_passes */
    double first[GALERKIN_MOST_WIDTH], count[GALERKIN_MOST_WIDTH];            /* of the first movement; passes */
    long long has_ended[GALERKIN_MOST_WIDTH], is_moving[GALERKIN_MOST_WIDTH]; /* all bits, or none: at the goal, or at
                                                                              roundoff; and who makes passes */
} galerkin_verdicts;

/* What a step is predicted from: the impulses of the last two, or, of members whose predictions are rough or of whom
 * only the last one is known, of that. Tables are [2][j][i], the second of the step before. */
typedef struct {
    double h;
    const double *from_two, *from_last, *last, *before;
    const long long *is_rough; /* [width] all bits, or none */
} galerkin_extrapolation;

/* What multiplies the impulses in their sums over the nodes, which once is 1: [lanes] 1 - c_j, and that of the curve's
 * last term. */
typedef struct {
    int points;
    double *late, *last;
} galerkin_weights;

/* [unknowns][width] of each, and room for seven more: the sums, the last one without sign, |L| at the first and the
 * last node together, and what the first two sums lack. */
typedef struct {
    double *once, *twice, *last, *reach, *once_low, *twice_low;
} galerkin_sums;

/* A step, as its tail sees it (algebra/tail.h). */
typedef struct {
    int n;
    bool is_separable, has_masses; /* has_masses also of a driven system (system/system.h) */
    tvi_subsystems parts;
    galerkin_sums sums;
    double per_weight;         /* 1 / b of the first and the last node */
    double *scale, *per_scale; /* [n] of the nodes, and 1 / |scale| */
    const double *q, *p, *dp;  /* [n][width] at the start, and the increment */
} galerkin_motion;

/* Of a component: |p| and its change, and how far Q moves of a system that is not separable. */
static inline double galerkin_momentum(const galerkin_motion *of, size_t at, size_t of_momentum)
{
    return fabs(of->p[at]) + (fabs(of->dp[at]) + of->sums.reach[of_momentum] * of->per_weight);
}

static inline double galerkin_movement(const galerkin_motion *of, size_t at)
{
    return of->sums.reach[at] * of->per_weight;
}

/* Of a component of the motion, where the arrays have what is of its coordinate and of its momentum. */
static inline tvi_tail_part galerkin_tail_part(const galerkin_motion *of, bool is_separable, double scale,
                                               double per_scale, size_t at, size_t of_momentum)
{
    const double *last = of->sums.last;
    tvi_tail_part part = {.momentum = galerkin_momentum(of, at, of_momentum),
                          .last_p = last[of_momentum],
                          .last_q = is_separable ? 0 : last[at],
                          .place = fabs(of->q[at])};
    part.per_momentum = 1 / part.momentum;
    part.movement = is_separable ? fabs(scale) * part.momentum : galerkin_movement(of, at);
    part.per_movement = is_separable ? per_scale * part.per_momentum : 1 / part.movement;
    return part;
}

/* What a coordinate with a mass rises by, in two parts: drift + drift_low + scale (twice + twice_low). */
static inline double galerkin_rise(double drift, double drift_low, double scale, double twice, double twice_low,
                                   double *low)
{
    const double rise = scale * twice;
    double rest;
    const double sum = tvi_two_sum(drift, rise, &rest);
    *low = rest + (fma(scale, twice, -rise) + fma(scale, twice_low, drift_low));
    return sum;
}

/* A component that is small beside the others of its group has no better roundoff than they. */
#define TVI_GALERKIN_LEAST_SHARE 1e-3

/* What drives an unknown, F_j = drives[slot[u]][j], acts by its impulses L_j = weight_j F_j, which are rounded once
 * and enter all sums alike: what these sums keep does not depend on how L_j was rounded. */
typedef struct {
    int lanes, unknowns;
    int half, moving; /* movements are of all unknowns: moving = unknowns; or of so many of each half */
    int points, width;
    double *x;
    double *start;        /* [unknowns][width] the unknowns at the start of the step */
    double *high, *base;  /* as x, where they would be without F, in two parts */
    double *weight;       /* [lanes] h b_j */
    double *impulse;      /* as x, L of the last movement, in the history */
    double *scale;        /* [unknowns] what multiplies the sums of L */
    double *inverse_size; /* [unknowns][width] */
    double *per_movement; /* [n] the momentum that moves a coordinate by 1 in the step; infinite: not known */
    tvi_subsystems parts;
    const long long *is_moving; /* [width] all bits, or none: the impulses of other members stay as they are */
} galerkin_nodes;

static inline galerkin_shape galerkin_shape_of(const galerkin_nodes *nodes)
{
    return (galerkin_shape){nodes->points, nodes->lanes, nodes->width};
}

/* The same, of whom all move. */
static inline galerkin_nodes galerkin_all_moving(const galerkin_nodes *nodes)
{
    galerkin_nodes all = *nodes;
    all.moving = all.unknowns;
    return all;
}

/* out[u][k] = start[u] + (theta[k] drift[u] + scale[u] sum_j table_jk impulses[u][j]), u < count, k < places: 1, all
 * lanes or TVI_SAMPLES; table [lanes][places]. */
typedef struct {
    int lanes, places, count;
    const double *theta, *start, *drift, *scale;
} galerkin_places;

/* A matrix A of n rows at each node. */
typedef struct {
    int n, lanes;
    double *lu;                       /* [n][n][lanes] A: fill it, then invert, which may leave its factors there */
    double *inverse;                  /* [n][n][lanes] */
    double *row_scale, *column_scale; /* [n][lanes] */
    int *pivot;                       /* [n][lanes] */
    bool exchanges;                   /* there is a row that is not its own pivot */
    double *x;                        /* [n][lanes] scratch */
} lanes_inverse;

/* Element (i, column) of a matrix, in a slot of a block. */
typedef struct {
    int column, slot;
} lanes_term;

/* The gradient of L(q, v) to first order about where it was evaluated, at each node. */
typedef struct {
    int n, lanes;
    double *moved;          /* [2n][lanes] how far from where it was evaluated; */
    const double *gradient; /* [2n][lanes] there */
    const double *second;   /* the block of the second derivatives, */
    const lanes_term *term; /* those that are not 0, row after row, */
    const int *end;         /* [2n] and where the row ends */
} lanes_model;

/* Second derivatives at each node: what drives unknowns, the rows, by the movement of those that move and that
 * something else depends on, the columns. The rows are those of the columns, then those that nothing depends on: both
 * in groups of LANES_ROWS, whose sums do not wait for each other, then of half as many, and so on. */
enum { LANES_ROWS = 4 };
static inline int lanes_group(int rows) { return rows >= LANES_ROWS ? LANES_ROWS : rows >= 2 ? 2 : 1; }
typedef struct {
    int count, moving, rows; /* columns, their rows, all rows */
    const int *unknown;      /* [rows] */
    const int *place;        /* group by group [count][group] in the block of the second derivatives: */
    const double *second;    /* it has zeros, too */
    float *matrix;           /* of a movement, [lanes][lanes] */
    float *packed;           /* the same, [count][group][lanes] */
    double *size, *per_size; /* [rows] of the unknowns, in this step */
    float *change, *total;   /* [rows][lanes] the last round's, and all with the movement, */
    float *impulse, *all;    /* [rows][lanes] and the impulses by both */
} lanes_rounds;

/* Of one member, or of several: see kernel.h. */
typedef struct galerkin_loops {
    /* Both halves of unknowns of equations of first order begin at those of the origin; and those of a separable
     * system, whose drift + drift_low = scale (p + p_low) are set. */
    void (*start)(const galerkin_nodes *nodes, int n, const tvi_origin *origin);
    void (*start_drifting)(const galerkin_nodes *nodes, const double *c, const tvi_origin *origin, double *drift,
                           double *drift_low);
    void (*predict)(const galerkin_nodes *nodes, const galerkin_extrapolation *by);
    void (*set_sizes)(const galerkin_nodes *nodes, int n);
    /* x = high + (base + scale sum_j matrix_ji L_j), the matrix as coefficients.h has it. moved [width]: the sums of
     * the squares of (change of x) inverse_size, a NaN where there is one. */
    void (*move)(const galerkin_nodes *nodes, const double *matrix, const double *drives, const int slot[],
                 double moved[]);
    /* Of the last movement. */
    void (*integrate)(const galerkin_nodes *nodes, const galerkin_weights *weights, const galerkin_sums *sums);
    /* The increments, from what `integrate` made: dq = drift + drift_low + scale twice, dp = once of a separable
     * system; else scale once. */
    void (*end_drifting)(const galerkin_nodes *nodes, const galerkin_sums *sums, const double *drift,
                         const double *drift_low, const tvi_increments *by);
    void (*end)(const galerkin_nodes *nodes, const galerkin_sums *sums, int n, const tvi_increments *by);
    /* tail [width]; share, ratio [n][width]: scratch. */
    void (*tail)(const galerkin_motion *of, int width, double *share, double *ratio, double tail[]);

    /* Of several only: tvi_passes_judge of pass number `count` of those that move. How many go on. */
    int (*judge)(galerkin_verdicts *of, const tvi_passes_rule *rule, int width, int count);

    /* Of one member only. The same as move, and ways [unknowns][lanes]: x is high + ways, rounded. */
    double (*move_in_parts)(const galerkin_nodes *nodes, const double *matrix, const double *drives, const int slot[],
                            double *ways);
    /* The same with L_j = weight_j F_j + changes[u][j], rounded once. */
    double (*move_both)(const galerkin_nodes *nodes, const double *matrix, const double *drives, const double *changes,
                        const int slot[]);
    /* The changes of impulses, [unknowns][lanes], by a movement and by the rounds that follow it (rounds.h), until the
     * square of the next one is, as they shrink, at most `least` or what the first order leaves out; 0 where they do
     * not. moved: that of the pass whose second derivatives serve again, unless they are new. */
    void (*go_round)(const galerkin_nodes *nodes, const lanes_rounds *rounds, const double *drives, const int slot[],
                     bool is_new, double moved, double least, double *changes);
    void (*place)(const galerkin_places *places, const double *table, const double *impulses, double *out);

    /* Of a Lagrangian: inverts the matrix of each lane. Returns the smallest pivot, relative to rows and columns of
     * size 1, or 1 where all pivots are as large as what stood on the diagonal, or nearly; 0 where there is a NaN. */
    double (*invert)(lanes_inverse *of);
    /* V = from + A^-1 ((P - p) - change), [n][lanes] each. */
    void (*correct)(const lanes_inverse *of, const double *P, const double *p, const double *change, const double *from,
                    double *V);
    /* out = L_q after the movement, [n][lanes], and what that of q alone changes in L_v. */
    void (*linearise)(const lanes_model *model, double *out);
} galerkin_loops;

/* Of one member for each number of lanes, and of several. */
extern const galerkin_loops *const tvi_galerkin_loops_base[GALERKIN_LOOPS],
    *const tvi_galerkin_loops_avx2[GALERKIN_LOOPS], *const tvi_galerkin_loops_avx512[GALERKIN_LOOPS];
extern const galerkin_loops *const tvi_galerkin_members_base, *const tvi_galerkin_members_avx2,
                                                                  *const tvi_galerkin_members_avx512;

#endif
