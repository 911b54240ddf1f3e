/* constraint.h - Declares the constraints phi(q, t) = 0 of a system: their recording, their tapes, and what is computed
 * with them at one state. The force of constraint is -G^T lambda, with the multipliers lambda and G = phi_q
 * (docs/method.md). constraint.c records the constraints, and project.c computes with them. */
#ifndef TVI_SRC_SYSTEM_CONSTRAINT_H
#define TVI_SRC_SYSTEM_CONSTRAINT_H

#include "system/legendre.h"

#include <float.h>

/* The constraints of a system. */
typedef struct tvi_constraints {
    int count; /* m */
    /* The constraints are those of a lift (tvi_system_create_lift): phi(q, t) = 0 and phi_q dq = 0, which have impulses
     * -G^T lambda on p, and -(G^T dlambda + (phi_q dq)_q^T lambda) on dp. The multipliers are (lambda, dlambda), so
     * that those of the first half move the state alone; momenta of a separable lift are (p, dp), of others (dp, p). */
    bool is_lift, has_separable_lift;
    jet_graph *graph; /* The recording, with the inputs q [n], d [n], mu [m] and t in this order; finished. */
    jet *phi;         /* [m] */
    /* The entries of G that are not 0 everywhere, row by row: those of row k are row_end[k - 1] .. row_end[k] - 1. */
    int entry_count, *row_end, *column;
    jet_tape *values; /* Inputs q, then t if it is used. Outputs phi [m], and then the entries of G [entry_count]. */
    /* Inputs q, d, mu, then t if it is used. Outputs (G^T mu)_q d [n], and then d phi_k,qq d / 2 [m]. */
    jet_tape *curvature;
    /* Inputs q, d, then t if it is used. Outputs, along a motion with q' = d: phi' = G d + phi_t [m], and phi'' without
     * its term G q'': d phi_qq d + 2 phi_qt d + phi_tt [m]. */
    jet_tape *rates;
} tvi_constraints;

/* Returns the first entry of row k of G. */
static inline int constraint_row_begin(const tvi_constraints *c, int k) { return k > 0 ? c->row_end[k - 1] : 0; }

/* The multiplier of constraint k, and the momentum that a force along coordinate i changes: k and i, but in a lift phi
 * has dlambda for its multiplier, and a force along q changes dp. */
static inline int tvi_constraint_multiplier(const tvi_constraints *c, int k)
{
    return c->is_lift ? (k + c->count / 2) % c->count : k;
}
static inline int tvi_constraint_momentum(const tvi_constraints *c, int n, int i)
{
    return c->has_separable_lift ? (i + n / 2) % n : i;
}

/* Tells whether an entry of G, of n columns, ties the tangent vector of a lift to the state. S is made without them:
 * the multipliers of the state do not depend on those of the vector, so that it finds both in two turns. */
static inline bool tvi_constraint_ties_halves(const tvi_constraints *c, int n, int row, int column)
{
    return c->is_lift && 2 * row >= c->count && 2 * column < n;
}

/* What a force along coordinate j moves in S, where W has all n columns: the rows first .. end - 1 of this column, all
 * of column j. In a lift they are those of the half of j, and dv/dp of the state stands there in the columns of the
 * other half, since momenta are (dp, p). */
typedef struct {
    int column, first, end;
} tvi_W_column;
static inline tvi_W_column tvi_constraint_W_column(const tvi_constraints *c, int n, int j)
{
    const int half = n / 2, first = j < half ? 0 : half;
    return c->is_lift ? (tvi_W_column){(j + half) % n, first, first + half} : (tvi_W_column){j, 0, n};
}

void tvi_constraints_free(tvi_constraints *constraints);

/* Creates the constraints of a lift, whose coordinates are (q, dq), from those of the system that is lifted. */
TVI_NODISCARD tvi_status tvi_constraints_create_lift(tvi_constraints **out, const tvi_system *base, bool is_separable);

/* Tells whether the system has constraints that depend on the time, and so do work. */
static inline bool tvi_constraints_use_time(const tvi_system *system)
{
    return system->constraints && system->constraints->values->input_count > system->n;
}

/* Continues the hash of a system (method/fingerprint.h) with its constraints; NULL: there are none. */
uint64_t tvi_constraints_continue_hash(uint64_t hash, const tvi_constraints *constraints);

/* The memory in which the constraints of one state are computed. */
typedef struct tvi_constraint_work {
    const tvi_system *system;
    double *W; /* The inverse masses dv/dp at the state: [n] where they are constant, or [n][n]. */
    double *values_block, *rates_block;   /* The blocks of the tapes. */
    double *field_block, *field_tangents; /* The field at the state, and its derivatives along some directions. */
    tvi_legendre_transform legendre;      /* Computes velocities from momenta, for a Lagrangian with L_vv(q, v). */
    double *velocity;                     /* [n] The velocity of the state. */
    double *product;                      /* [n] W G_k^T, or G^T y. */
    double *S;                            /* [m][m] G W G^T, and then its scaled factor (factor_S in project.c). */
    double *scale;                        /* [m] Makes the diagonal of S 1. */
    double *residual;                     /* [m] The right-hand side, and then the solution, of an equation with S. */
    double *correction;                   /* [n] */
    /* [n] The state that is projected, and the state at the start of a run (integrator/step.c). */
    struct {
        double *q, *p, *q_low, *p_low;
    } moved, start;
} tvi_constraint_work;

/* A constraint of m depends on others if the pivot of its row of S, scaled to the diagonal 1, is at most this:
 * roundoff. */
static inline double tvi_dependent_pivot(int m) { return 64 * m * DBL_EPSILON; }
/* Refuses such a constraint with TVI_ESINGULAR. */
tvi_status tvi_refuse_dependent(int k, double pivot);

/* Allocates the memory for a system that has constraints, in an arena (algebra/arena.h). The blocks get the parameters
 * of the arena. */
void tvi_constraint_allocate(tvi_constraint_work *work, tvi_arena *arena, const tvi_system *system);

/* Computes W at a state: diag(1/m), [n], of a system with masses, and otherwise H_pp or L_vv^-1. */
TVI_NODISCARD tvi_status tvi_constraint_set_W(tvi_constraint_work *work, double t, const double q[], const double p[]);

/* Computes v = dq/dt of a state. */
TVI_NODISCARD tvi_status tvi_constraint_velocity(tvi_constraint_work *work, double t, const double q[],
                                                 const double p[], double v[]);

/* Computes phi [m] and dphi/dt = G v + phi_t [m] of a state. */
TVI_NODISCARD tvi_status tvi_constraint_evaluate(tvi_constraint_work *work, double t, const double q[],
                                                 const double p[], double value[], double rate[]);

/* Computes the multipliers lambda [m] of a state, for which phi'' = 0 along the motion: S lambda = G a + (phi'' without
 * G q''), where a is the acceleration without forces of constraint. */
TVI_NODISCARD tvi_status tvi_constraint_multipliers(tvi_constraint_work *work, double t, const double q[],
                                                    const double p[], double lambda[]);

/* Sets force [n] to the force of constraint -G^T lambda where phi was evaluated last. */
void tvi_constraint_force(const tvi_constraint_work *work, const double lambda[], double force[]);

/* Sets move [n] to -W G^T y, along which coordinates are moved, with the W that was set last. */
void tvi_constraint_move(tvi_constraint_work *work, const double y[], double move[]);

/* Sets W and the factor of S at a state. */
TVI_NODISCARD tvi_status tvi_constraint_factor(tvi_constraint_work *work, double t, const double q[], const double p[]);
/* Computes y <- S^-1 y, [m], with the S that was factored last. */
void tvi_constraint_solve(const tvi_constraint_work *work, double y[]);
/* Computes phi [m] at q. */
TVI_NODISCARD tvi_status tvi_constraint_phi(tvi_constraint_work *work, double t, const double q[], double value[]);
/* Copies the entries of G where phi was evaluated last. */
void tvi_constraint_get_G(const tvi_constraint_work *work, double G[]);

/* Moves (q + q_low, p + p_low) onto phi = 0 along W G^T, and then onto phi' = 0 along G^T, by Newton's method to
 * roundoff; the low-order parts are set, too. With is_near, it refuses a state whose correction is more than 2^-26 of
 * its coordinates or its velocity, with TVI_EINVAL. Returns TVI_ESINGULAR, with a text that names the constraint, if
 * one depends on the others there: a pivot of S, scaled to the diagonal 1, is at most 64 m times the unit of roundoff.
 * On failure the state is as it was. */
TVI_NODISCARD tvi_status tvi_constraint_project(tvi_constraint_work *work, double t, double q[], double q_low[],
                                                double p[], double p_low[], bool is_near);

/* Do what tvi_project, tvi_constraint_values and tvi_multipliers do, with the given parameters instead of the recorded
 * ones. NULL stands for the recorded parameters. */
TVI_NODISCARD tvi_status tvi_project_with_parameters(const tvi_system *system, const double parameters[], double t,
                                                     double q[], double p[]);
TVI_NODISCARD tvi_status tvi_phi_with_parameters(const tvi_system *system, const double parameters[], double t,
                                                 const double q[], const double p[], double value[], double rate[]);
TVI_NODISCARD tvi_status tvi_multipliers_with_parameters(const tvi_system *system, const double parameters[], double t,
                                                         const double q[], const double p[], double lambda[],
                                                         double force[]);

#endif
