/* step.h - declares the workspace of a method that expands one Taylor curve, for step.c, and what a plain Taylor step
 * of adapted size adds to it (taylor.c, refine.c). */
#ifndef TVI_SRC_GENERATING_STEP_H
#define TVI_SRC_GENERATING_STEP_H

#include "generating/corrected.h"
#include "generating/newton.h"
#include "system/legendre.h"
#include "system/roundoff.h"

/* The increments of a Taylor step in long double (refine.c), for tolerances near roundoff. A sum over the coefficients
 * adds the orders up to TVI_REFINE_LOW in long double, and the higher orders in double. There are TVI_REFINE_SUMS sums:
 * the state X and its derivative (X', or Q'' of a separable system) at each of two nodes, and the increments of
 * position and of momentum. */
enum { TVI_REFINE_LOW = 4, TVI_REFINE_SUMS = 6 };
typedef struct {
    int lowest;             /* the lowest order in the sums */
    long double *X_0, *X_1; /* [inputs] the terms of order 0, and of order 1 in a separable system */
    long double low_weight[TVI_REFINE_SUMS][TVI_REFINE_LOW + 1]; /* the weights of the orders up to TVI_REFINE_LOW */
    double *high_weight, *high_sum; /* [sums][highest_order + 1] those above, and [inputs] the sum of their terms */
    long double *sum, *d; /* [inputs] the sum of all orders, and the residual d of the differential equation */
    long double *int_d, *int_int_d; /* [inputs] the integral of d over the step, and that of (1 - s) d */
    long double *slots;             /* [slots] the slots of the field's tape in long double */
    double *constants;              /* the block of the field's tape, which contains its constants */
} tvi_refinement;

/* The defect of a Taylor step at some places, the last of which is its end (defect.c). */
enum { TVI_DEFECT_PLACES = 4 };
typedef struct {
    double *power, *slope, *second; /* [highest_order + 1][places] s^k and its derivatives */
    double *field;                  /* the block of the field's tape, with a lane for each place */
    tvi_roundoff_estimator roundoff;
    /* The blocks of the energy's tape, with lanes for the start and the end, and with one lane; NULL: no energy is
     * conserved. And the roundoff of its slots. */
    double *energy, *energy_at_point, *energy_roundoff;
} tvi_defect;

typedef struct {
    tvi_corrected_curve c;
    bool has_corrections; /* whether the method corrects the ends of the curve by a generating function */
    const tvi_options *options;
    tvi_action action;
    tvi_newton newton;
    tvi_series_sum q_start_minus_Q0; /* q- - Q_0 */
    tvi_series_sum dense_q, dense_u; /* the increments to one point of dense output */
    double *scratch;                 /* [n] */
    /* The predictor. Its transform and its guess of the velocity are used for a Lagrangian only. */
    struct {
        tvi_legendre_transform legendre;
        /* q, and tau v (p for a Hamiltonian), of the curve from (q0, p0) at the centre of the step, which predict z. */
        tvi_series_sum q_at_centre, v_at_centre;
        tvi_series_sum v_at_end; /* tau v at the end of a Lagrangian's step */
        double *z;               /* [2n] the predicted state at the centre */
        double *velocity_guess;  /* [n] the first guess of the velocity in the next predictor; history */
    } predictor;
    /* The step that is being made: valid until the function that makes it returns. */
    struct {
        const tvi_step_origin *origin;
        tvi_stats *stats;
        double tau;
    } step;
    /* Steps of adapted size (taylor.c): unused by methods that correct the ends of the curve. */
    struct {
        double *last_size;               /* the size of the last such step, or 0; history */
        double tolerance, log_tolerance; /* the tolerance of the last such step, and its logarithm */
        tvi_defect defect;
        tvi_refinement refinement; /* the memory of refine.c, which refines the increments of a step */
    } adapted;
} tvi_curve_work;

/* Predicts z at the centre, by the curve that starts at (q0, p0). */
TVI_NODISCARD tvi_status tvi_step_predict(tvi_curve_work *w);
/* Expands the curve from z, at the centre of the step. */
TVI_NODISCARD tvi_status tvi_step_expand(tvi_curve_work *w, const double z[]);
/* Rescales the curve of the plain Taylor method to tau = h, and computes the increments of its step. */
void tvi_step_taylor_increments(tvi_curve_work *w, double h, const tvi_increments *increments);

void tvi_taylor_allocate(tvi_curve_work *w, tvi_arena *arena);
tvi_status tvi_taylor_step_to_tolerance(void *work, double tolerance, double *h, const tvi_step_origin *origin,
                                        const tvi_increments *increments, tvi_stats *stats);
/* Returns an upper bound of the energy change by the terms that a plain Taylor step omits, or INFINITY if the curve has
 * too few terms for a bound. */
double tvi_taylor_bound_energy_change(const void *work);

void tvi_defect_allocate(tvi_defect *defect, tvi_arena *arena, const tvi_curve *curve);
void tvi_defect_set_tables(const tvi_defect *defect, const tvi_curve *curve);
/* Tells whether the curve of a step of size h = tau, whose increments are given, meets the tolerance in its defect and
 * in the change of the energy. */
bool tvi_defect_is_small(tvi_curve_work *w, double h, const tvi_increments *increments);

void tvi_refine_allocate(tvi_refinement *refinement, tvi_arena *arena, const tvi_curve *curve);
void tvi_refine_set_tables(tvi_refinement *refinement, const tvi_curve *curve);
/* Computes the increments of the curve's step of size h = tau from the origin. */
void tvi_refine_increments(const tvi_refinement *refinement, const tvi_curve *curve, double h,
                           const tvi_step_origin *origin, const tvi_increments *increments);

#endif
