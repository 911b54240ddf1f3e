/* loops.h - Declares the loops of the Galerkin curve, which take all time except that of the field. They are compiled
 * once for each instruction set (ad/vector.h). Arrays of nodes are [lanes]. If there are more lanes than nodes, the
 * last node is repeated, with weight 0. */
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
/* The number of steps whose impulses are kept: the last two, and the current one. */
enum { GALERKIN_RING = 3 };

/* The shape of arrays. Unknown u of node i stands at x[u][i] for one member, where further lanes repeat the last node
 * with weight 0; for several members that of member m is x[u][i][m]. */
typedef struct {
    /* The number of nodes, the numbers in a row of the tables, and the members. */
    int points, lanes, width;
} galerkin_shape;

/* The convergence of the passes of a step, which predicts that of the next one. Sizes are as the passes measure them;
 * 0: not known. */
typedef struct {
    double slowest; /* the slowest contraction */
    double first;   /* the first movement: the error of the prediction */
} galerkin_convergence;

/* The convergence of the passes of several members (algebra/passes.h). */
enum { GALERKIN_MOST_WIDTH = 32 };
typedef struct {
    double moved[GALERKIN_MOST_WIDTH]; /* by the last pass, as `move` measures it */
    double size[GALERKIN_MOST_WIDTH], before[GALERKIN_MOST_WIDTH], part[GALERKIN_MOST_WIDTH],
        slowest[GALERKIN_MOST_WIDTH], shown[GALERKIN_MOST_WIDTH];  /* as in tvi_passes */
    double first[GALERKIN_MOST_WIDTH], count[GALERKIN_MOST_WIDTH]; /* the first movement; number of passes */
    /* All bits, or none: the member is at its goal, or at roundoff; and it makes passes. */
    long long has_ended[GALERKIN_MOST_WIDTH], is_moving[GALERKIN_MOST_WIDTH];
} galerkin_verdicts;

/* The impulses that predict a step: those of the last two steps, or of the last one for members whose predictions are
 * rough, or that have one step only. Tables are [2][j][i], the second for the step before. */
typedef struct {
    double h;
    const double *from_two, *from_last, *last, *before;
    const long long *is_rough; /* [width] all bits, or none */
} galerkin_extrapolation;

/* The weights of impulses in sums over the nodes, apart from 1: [lanes] 1 - c_j, and that of the curve's last term. */
typedef struct {
    int points;
    double *late, *last;
} galerkin_weights;

/* Sums of impulses, [unknowns][width] each, with room for seven more: with weights 1 and 1 - c_j; the last term,
 * without its sign; |L| at the first and the last node together; and the low-order parts of the first two sums. */
typedef struct {
    double *once, *twice, *last, *reach, *once_low, *twice_low;
} galerkin_sums;

/* The inputs of a step's tail (algebra/tail.h). */
typedef struct {
    int n;
    bool is_separable, has_masses; /* has_masses is also set for a driven system (system/system.h) */
    tvi_subsystems parts;
    galerkin_sums sums;
    double per_weight;         /* 1 / b of the first and the last node */
    double *scale, *per_scale; /* [n] of the nodes, and 1 / |scale| */
    const double *q, *p, *dp;  /* [n][width] at the start, and the increment */
} galerkin_tail_inputs;

/* |p| and its change, for a component; and the movement of Q in a system that is not separable. */
static inline double galerkin_momentum(const galerkin_tail_inputs *inputs, size_t at, size_t momentum_at)
{
    return fabs(inputs->p[at]) + (fabs(inputs->dp[at]) + inputs->sums.reach[momentum_at] * inputs->per_weight);
}

static inline double galerkin_movement(const galerkin_tail_inputs *inputs, size_t at)
{
    return inputs->sums.reach[at] * inputs->per_weight;
}

/* The tail's part for a component, with the indices of its coordinate and of its momentum in the arrays. */
static inline tvi_tail_part galerkin_tail_part(const galerkin_tail_inputs *inputs, bool is_separable, double scale,
                                               double per_scale, size_t at, size_t momentum_at)
{
    const double *last = inputs->sums.last;
    tvi_tail_part part = {.momentum = galerkin_momentum(inputs, at, momentum_at),
                          .last_p = last[momentum_at],
                          .last_q = is_separable ? 0 : last[at],
                          .position = fabs(inputs->q[at])};
    part.per_momentum = 1 / part.momentum;
    part.movement = is_separable ? fabs(scale) * part.momentum : galerkin_movement(inputs, at);
    part.per_movement = is_separable ? per_scale * part.per_momentum : 1 / part.movement;
    return part;
}

/* The rise of a coordinate with a mass, in two parts: drift + drift_low + scale (twice + twice_low). */
static inline double galerkin_rise(double drift, double drift_low, double scale, double twice, double twice_low,
                                   double *low)
{
    const double rise = scale * twice;
    double rest;
    const double sum = tvi_two_sum(drift, rise, &rest);
    *low = rest + (fma(scale, twice, -rise) + fma(scale, twice_low, drift_low));
    return sum;
}

/* A component that is small beside the others of its group has no less roundoff than these. */
#define TVI_GALERKIN_LEAST_SHARE 1e-3

/* The nodes of a step. The rate of an unknown, F_j = rates[slot[u]][j], acts by its impulses L_j = weight_j F_j. These
 * are rounded once and enter all sums alike: what these sums conserve does not depend on the rounding of L_j. */
typedef struct {
    int lanes, unknowns;
    /* Movements are of all unknowns if moving = unknowns, otherwise of `moving` unknowns of each half. */
    int half, moving;
    int points, width;
    double *x;
    double *start;        /* [unknowns][width] the unknowns at the start of the step */
    double *high, *base;  /* as x, without F, in two parts */
    double *weight;       /* [lanes] h b_j */
    double *impulse;      /* as x, L of the last movement, in the history */
    double *scale;        /* [unknowns] factor of the sums of L */
    double *inverse_size; /* [unknowns][width] */
    /* [n] The momentum that moves a coordinate by 1 in the step; infinite: not known. */
    double *per_movement;
    tvi_subsystems parts;
    /* [width] All bits, or none: the impulses of members that do not move stay as they are. */
    const long long *is_moving;
} galerkin_nodes;

/* A copy of the nodes with all unknowns moving. */
static inline galerkin_nodes galerkin_all_moving(const galerkin_nodes *nodes)
{
    galerkin_nodes all = *nodes;
    all.moving = all.unknowns;
    return all;
}

/* Evaluates out[u][k] = start[u] + (theta[k] drift[u] + scale[u] sum_j table_jk impulses[u][j]), u < count, k < places.
 * places is 1, the number of lanes or TVI_SAMPLES; table [lanes][places]. */
typedef struct {
    int lanes, places, count;
    const double *theta, *start, *drift, *scale;
} galerkin_evaluation;

/* A matrix A of n rows at each node. */
typedef struct {
    int n;
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
    const double *hessian;  /* the block of the second derivatives, */
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
    const int *index;        /* group by group [count][group] in the block of the second derivatives: */
    const double *hessian;   /* it has zeros, too */
    float *matrix;           /* of a movement, [lanes][lanes] */
    float *packed;           /* the same, [count][group][lanes] */
    double *size, *per_size; /* [rows] of the unknowns, in this step */
    float *change, *total;   /* [rows][lanes] the last round's, and all with the movement, */
    float *impulse, *all;    /* [rows][lanes] and the impulses by both */
} lanes_rounds;

/* The loops for one member, or for several: see kernel.h. */
typedef struct galerkin_loops {
    /* Set the unknowns at the start: both halves for equations of first order; and those of a separable system, whose
     * drift + drift_low = scale (p + p_low) is also set. */
    void (*start)(const galerkin_nodes *nodes, int n, const tvi_origin *origin);
    void (*start_drifting)(const galerkin_nodes *nodes, const double *c, const tvi_origin *origin, double *drift,
                           double *drift_low);
    void (*predict)(const galerkin_nodes *nodes, const galerkin_extrapolation *by);
    void (*set_sizes)(const galerkin_nodes *nodes, int n);
    /* Moves x = high + (base + scale sum_j matrix_ji L_j), with the matrix of coefficients.h. moved [width] are the
     * sums of the squares of (change of x) inverse_size, a NaN if there is one. */
    void (*move)(const galerkin_nodes *nodes, const double *matrix, const double *rates, const int slot[],
                 double moved[]);
    /* Sums the impulses of the last movement. */
    void (*integrate)(const galerkin_nodes *nodes, const galerkin_weights *weights, const galerkin_sums *sums);
    /* Compute the increments from the results of `integrate`: dq = drift + drift_low + scale twice, dp = once for a
     * separable system; otherwise scale once. */
    void (*end_drifting)(const galerkin_nodes *nodes, const galerkin_sums *sums, const double *drift,
                         const double *drift_low, const tvi_increments *by);
    void (*end)(const galerkin_nodes *nodes, const galerkin_sums *sums, int n, const tvi_increments *by);
    /* Computes tail [width]; share, ratio [n][width] are scratch. */
    void (*tail)(const galerkin_tail_inputs *inputs, int width, double *share, double *ratio, double tail[]);

    /* Only for several members: does what tvi_passes_add_and_judge does, for pass number `count` of the members that
     * move. Returns how many go on. */
    int (*judge)(galerkin_verdicts *verdicts, const tvi_passes_rule *rule, int width, int count);

    /* Only for one member: does what `move` does, and sets displacements [unknowns][lanes], so that x is high +
     * displacements, rounded. */
    double (*move_in_parts)(const galerkin_nodes *nodes, const double *matrix, const double *rates, const int slot[],
                            double *displacements);
    /* Does what `move` does, with L_j = weight_j F_j + changes[u][j], rounded once. */
    double (*move_both)(const galerkin_nodes *nodes, const double *matrix, const double *rates, const double *changes,
                        const int slot[]);
    /* Computes the changes of impulses, [unknowns][lanes], by a movement and by the rounds that follow it
     * (kernel_rounds.h). The rounds end when the square of the next movement is expected to be at most `least`, or the
     * error of the first order. The changes are 0 if the movements do not shrink. `moved` belongs to the pass whose
     * second derivatives serve again, unless they are new. */
    void (*run_rounds)(const galerkin_nodes *nodes, const lanes_rounds *rounds, const double *rates, const int slot[],
                       bool is_new, double moved, double least, double *changes);
    void (*evaluate)(const galerkin_evaluation *places, const double *table, const double *impulses, double *out);

    /* For a Lagrangian: inverts the matrix of each lane. Returns the smallest pivot, relative to rows and columns of
     * size 1, or 1 where all pivots are as large as what stood on the diagonal, or nearly; 0 where there is a NaN. */
    double (*invert)(lanes_inverse *of);
    /* V = from + A^-1 ((P - p) - change), [n][lanes] each. */
    void (*correct)(const lanes_inverse *of, const double *P, const double *p, const double *change, const double *from,
                    double *V);
    /* out = L_q after the movement, [n][lanes], and what that of q alone changes in L_v. */
    void (*linearise)(const lanes_model *model, double *out);
} galerkin_loops;

/* The loops for one member with each number of lanes, and for several members. */
extern const galerkin_loops *const tvi_galerkin_loops_base[GALERKIN_LOOPS],
    *const tvi_galerkin_loops_avx2[GALERKIN_LOOPS], *const tvi_galerkin_loops_avx512[GALERKIN_LOOPS];
extern const galerkin_loops *const tvi_galerkin_members_base, *const tvi_galerkin_members_avx2,
                                                                  *const tvi_galerkin_members_avx512;

#endif
