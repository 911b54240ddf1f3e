/* curve_stepper.h - declares the work of a method that expands one curve. It is part of the text of generated code. */
#ifndef TVI_SRC_GENERATING_CURVE_STEPPER_H
#define TVI_SRC_GENERATING_CURVE_STEPPER_H

#include "generating/action.h"
#include "generating/closure.h"
#include "generating/newton.h"
#include "generating/refine.h"
#include "system/legendre.h"
#include "system/roundoff.h"

typedef struct tvi_curve_work {
    tvi_closure closure;
    bool corrects;
    bool is_rough;
    const tvi_options *options;
    int q_degree;
    tvi_action action;
    tvi_newton newton;
    tvi_legendre legendre;
    tvi_combination q_back;             /* q- - Q_0 */
    tvi_combination q_centre, z_centre; /* the centre data, of the curve that starts at (q0, p0) */
    tvi_combination v_end;              /* tau v at the end of the step, of a Lagrangian */
    tvi_combination dense_q, dense_u;   /* for one point of dense output */
    double *z;                          /* [2n] predictor */
    double *dz;                         /* [2n] what z lacks at the end of the passes */
    double *velocity;                   /* [n] the first guess of the next predictor's, Lagrangian; in the history */
    double *chosen;                     /* the size of the last step that adapted, 0: none; in the history */
    double *field;                      /* the field's values at the end of such a step, separable systems */
    tvi_roundoff roundoff;              /* the roundoff of these values */
    double tolerance, log_tolerance;    /* those of the last step that adapted */
    double *shift;                      /* [n] */
    tvi_refinement refinement;
} tvi_curve_work;

/* Returns whether the curve ends with the force there, dp/ds = h F, to the tolerance. Coefficients beside a state that
 * is large may not show what the body will meet. */
bool tvi_curve_ends_right(tvi_curve_work *work, double h, const tvi_origin *origin, const tvi_increments *increments);

#endif
