/* loops.h - the loops of the Galerkin curve in which all time but that of the field goes, compiled once for each
 * instruction set (ad/vector.h). Arrays of nodes are [lanes]; where lanes are more than nodes, the last node is
 * repeated, with weight 0. */
#ifndef TVI_SRC_GALERKIN_LOOPS_H
#define TVI_SRC_GALERKIN_LOOPS_H

#include "algebra/subsystems.h"
#include "algebra/tail.h"
#include "galerkin/lagrangian_loops.h"
#include "method/origin.h"

#include <stdbool.h>
#include <stddef.h>

/* The numbers of lanes that there are: 1, 2, 4, 8 and MAX_LANES. */
enum { TVI_GALERKIN_MAX_LANES = 12, GALERKIN_LOOPS = 5 };
/* The steps whose impulses are kept: the last two, and the one that is made; and the most unknowns of which a step
 * leaves how the next one begins, behind these. */
enum { GALERKIN_TURNS = 3, GALERKIN_FEW = 8 };
/* Of so few unknowns at eight nodes each operation waits for the one before it (few.h). */
enum { GALERKIN_FEWEST = 4 };

/* Numbers of a matrix that multiplies what the lanes have; of eight lanes the same, turned, is behind it (few.h). */
static inline int galerkin_matrix_size(int lanes) { return (lanes == 8 ? 2 : 1) * lanes * lanes; }

/* How the passes of a step went, which says how those of the next one will. Sizes as the passes have them; 0: not
 * known. */
typedef struct {
    double slowest; /* how far they contract */
    double first;   /* the size of the first movement, which is what the prediction was off */
    long silent;    /* so many of the next one's are not judged (emitted_passes.h) */
    long blind;     /* so many behind the first one are not measured */
} galerkin_pace;

/* What a step is predicted from: the impulses of the last two, or, where predictions are rough or only the last one is
 * known, of that. */
enum { GALERKIN_FROM_TWO, GALERKIN_FROM_LAST, GALERKIN_FITS };

static inline int galerkin_fit(int known, const galerkin_pace *pace, double rough)
{
    return known < 2 || pace->first > rough ? GALERKIN_FROM_LAST : GALERKIN_FROM_TWO;
}

/* What multiplies the impulses in their sums over the nodes: 1 and 1 - c_j, and these for a second unknown beside the
 * first; and that of the curve's last term. */
enum { OF_PAIR = 4 };
typedef struct {
    int points;
    double *pair;   /* [lanes][OF_PAIR] */
    double *halves; /* [2][8] of eight nodes, 1 and 1 - c_j of the first four, and of the others */
    double *last;   /* [lanes] */
} galerkin_weights;

/* [unknowns] of each, and room for seven more: the sums, the last one without sign, |L| at the first and the last node
 * together, and what the first two sums lack. */
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
    const double *q, *p, *dp;  /* [n] at the start, and the increment */
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

/* Unknown u of node i stands at x[u][i]. What drives it, F_j = drives[slot[u]][j], acts by its impulses
 * L_j = weight_j F_j, which are rounded once and enter all sums alike: what these sums keep does not depend on how L_j
 * was rounded. */
typedef struct {
    int lanes, unknowns;
    int half, moving; /* movements are of all unknowns: moving = unknowns; or of so many of each half */
    double *x;
    double *start;        /* [unknowns] the unknowns at the start of the step */
    double *high, *base;  /* [unknowns][lanes] where they would be without F, in two parts */
    double *weight;       /* [lanes] h b_j */
    double *impulse;      /* [unknowns][lanes] L of the last movement, in the history */
    double *scale;        /* [unknowns] what multiplies the sums of L */
    double *inverse_size; /* [unknowns] */
    double *per_movement; /* [n] the momentum that moves a coordinate by 1 in the step; infinite: not known */
    tvi_subsystems parts;
} galerkin_nodes;

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

struct galerkin_frame;
struct galerkin_outcome;
typedef struct galerkin_loops {
    /* x = high + (base + scale sum_j matrix_ji L_j), the matrix as coefficients.h has it. Returns the sum of the
     * squares of (change of x) inverse_size, a NaN where there is one. */
    double (*move)(const galerkin_nodes *nodes, const double *matrix, const double *drives, const int slot[]);
    /* The same, and ways [unknowns][lanes]: x is high + ways, rounded. */
    double (*move_in_parts)(const galerkin_nodes *nodes, const double *matrix, const double *drives, const int slot[],
                            double *ways);
    /* The same as move with L_j = weight_j F_j + changes[u][j], rounded once. */
    double (*move_both)(const galerkin_nodes *nodes, const double *matrix, const double *drives, const double *changes,
                        const int slot[]);
    /* The same with the impulses of earlier steps: impulses[step][u][j], matrix [steps][j][i]. */
    void (*predict)(const galerkin_nodes *nodes, int steps, const double *matrix, const double *const impulses[]);
    /* The changes of impulses, [unknowns][lanes], by a movement and by the rounds that follow it (rounds.h), until the
     * square of the next one is, as they shrink, at most `least` or what the first order leaves out; 0 where they do
     * not. moved: that of the pass whose second derivatives serve again, unless they are new. */
    void (*go_round)(const galerkin_nodes *nodes, const lanes_rounds *rounds, const double *drives, const int slot[],
                     bool is_new, double moved, double least, double *changes);
    /* Of the last movement. */
    void (*integrate)(const galerkin_nodes *nodes, const galerkin_weights *weights, const galerkin_sums *sums);
    /* start = high = (q, p) and base = (q_low, p_low) of the origin, n of each. */
    void (*start)(const galerkin_nodes *nodes, int n, const tvi_origin *origin);
    /* start = q, drift + drift_low = scale (p + p_low) and high_i + base_i = q + q_low + c_i (drift + drift_low), for
     * all unknowns, c [lanes]. */
    void (*start_drifting)(const galerkin_nodes *nodes, const double *c, const tvi_origin *origin, double *drift,
                           double *drift_low);
    /* dq = drift + drift_low + scale twice, dp = once, from what `integrate` made. */
    void (*end_drifting)(const galerkin_nodes *nodes, const galerkin_sums *sums, const double *drift,
                         const double *drift_low, const tvi_increments *by);
    /* share, ratio [n]: scratch. */
    double (*tail)(const galerkin_motion *of, double *share, double *ratio);
    void (*place)(const galerkin_places *places, const double *table, const double *impulses, double *out);
    /* Steps in one function: steady.h. How many were made, and added to `now`, where the origin is: less than those of
     * the row where the passes of the next one do not end at the goal, the field has no value, or it is not sure or not
     * finite. now NULL: one, which is not added. NULL but in generated code. */
    long (*steady)(const struct galerkin_frame *frame, const tvi_row *row, const tvi_origin *origin,
                   const tvi_run_state *now, struct galerkin_outcome *to);
} galerkin_loops;

/* For each number of lanes. */
extern const galerkin_loops tvi_galerkin_loops_base[GALERKIN_LOOPS], tvi_galerkin_loops_avx2[GALERKIN_LOOPS],
    tvi_galerkin_loops_avx512[GALERKIN_LOOPS];

#endif
