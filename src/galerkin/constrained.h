/* constrained.h - Declares the memory of the stepper on constraints (constrained.c), and what its two files share:
 * constrained_ends.c has what a step computes at its ends. */
#ifndef TVI_SRC_GALERKIN_CONSTRAINED_H
#define TVI_SRC_GALERKIN_CONSTRAINED_H

#include "galerkin/constraint_nodes.h"
#include "galerkin/galerkin.h"

/* What a step leaves for the prediction of the next one and for dense output: multipliers at all m + 1 nodes, and
 * impulses. */
typedef struct {
    double *lambda; /* [count][m + 1] the multipliers lambda_j = mu_j / (h w_j) */
    double *K;      /* [n][m + 1] */
} constraint_record;

typedef struct {
    galerkin_work *galerkin; /* the memory of the same step without constraints */
    galerkin_lobatto tables;
    constraint_nodes nodes;
    constraint_record ring[GALERKIN_RING_LENGTH]; /* those of the last steps, by the index of galerkin_step.ring */
    /* [unknowns][lanes] the low-order part of the free motion without the impulses of the constraints */
    double *low_without_impulses;
    double *sum;    /* [n][lanes] scratch */
    double *fit[2]; /* [m][lanes][lanes] the factors of impulses of the last two steps in those of the next */
    /* One state: the start of the step, and then its end. */
    tvi_constraint_work one;
    double *values, *bend;                          /* blocks of the tapes: values, and second derivatives in lanes */
    double *G, *S;                                  /* [entries], [factor_size] */
    double *q, *q_low, *p, *p_low, *v, *K, *lambda; /* [n] each; lambda [count] */
} constrained_work;

/* ---- constrained_ends.c ------------------------------------------------------------------------------------------ */

/* Sets the scales of the constraints for a step of size h. */
tvi_status tvi_constrained_set_scales(constrained_work *work, double h, const tvi_step_origin *origin);

/* Predicts a step: impulses of the forces and multipliers, and from them the unknowns and positions. The normals G are
 * those at the start of the step. */
tvi_status tvi_constrained_predict(constrained_work *work, const tvi_step_origin *origin, int equal_step_count,
                                   tvi_stats *stats);

/* Adds what the impulses of the constraints do to the unknowns at the Gauss nodes to the free motion. */
void tvi_constrained_add_impulses(const constrained_work *work);

/* Sets by_forces: what the impulses of the forces do to the positions at the targets. In equations of first order they
 * have acted on the positions by velocities that know the present K, whose part is taken off to first order. */
void tvi_constrained_set_by_forces(const constrained_work *work);

/* Computes the increments and the tail of a step from its impulses, and records these. The tail has the last term of
 * the forces of constraint, as it has that of the forces. */
tvi_status tvi_constrained_set_increments(constrained_work *work, const tvi_step_origin *origin,
                                          const tvi_increments *to, const constraint_record *record, double *tail);

/* The functions `interpolate` and `sample` of the stepper (method/stepper.h). */
void tvi_constrained_interpolate(void *self, double theta, double dq[], double dp[]);
void tvi_constrained_sample(void *self, const tvi_component_range used[2], const double q_start[],
                            const double p_start[], double *q, double *p);

/* ---- Functions of both files ------------------------------------------------------------------------------------- */

/* Writes the times t0 + h d_j of the targets, or of one place, to a block of a tape whose inputs without the time are
 * `inputs`. */
static inline void constrained_set_times(const jet_tape *tape, double *block, int inputs, int lanes, const double t[])
{
    if (tape->input_count > inputs) memcpy(block + inputs * lanes, t, (size_t)lanes * sizeof *t);
}

/* Moves the unknowns at the Gauss nodes by the impulses. */
static inline double constrained_move_unknowns(const galerkin_step *step)
{
    double movement;
    BY_LANES(lanes, step->nodes.lane_count, movement = move_unknowns_by_impulses(&step->nodes, NULL, lanes));
    return movement;
}

/* Adds weight x to the sum (*whole, *low). */
static inline void constrained_add_product(double weight, double x, double *whole, double *low)
{
    double rest;
    const double product = weight * x;
    *whole = tvi_two_sum(*whole, product, &rest);
    *low += rest + fma(weight, x, -product);
}

#endif
