/* linear_prediction.h - extrapolation that is fitted to the motion (docs/method.md section 5).
 *
 * Polynomials through the impulses of two steps say little of the next ones where a step is long. Of a motion of few
 * frequencies what drives the unknowns at the nodes of a step is linear in what did so in the two before, by
 * coefficients that are the same in all steps of one size: those of least squares, from the steps that were made. */
#ifndef TVI_SRC_GALERKIN_LINEAR_PREDICTION_H
#define TVI_SRC_GALERKIN_LINEAR_PREDICTION_H

#include "galerkin/predictor.h"
#include "galerkin/regression.h"

/* How steps are going; in the arena's history. */
typedef struct {
    double h, steps;   /* of this size were so many, one behind the other */
    double from, wait; /* coefficients were fitted after so many of these, and are so after so many, */
    double passes;     /* of the steps since then; */
    double plain;      /* those of a step by polynomials */
    double next;       /* and the next window of steps is kept after so many, */
    int windows;       /* behind those that are kept */
    double fitted;     /* the coefficients in use are of steps of this size; 0: there are none */
    int turn;          /* where their table is */
} galerkin_fitting;

typedef struct {
    galerkin_fitting *last; /* NULL: there are none */
    double first_wait;
    /* In the history, where a step leaves the table of the one before, that it may fail. */
    double *windows;   /* as regression.h has them */
    double *tables[2]; /* of predictor.h */
    galerkin_regression regression;
    galerkin_regress *regress;
} galerkin_linear_prediction;

/* Of predictor.h. */
int tvi_galerkin_linear_prediction_turns(const galerkin_field *field, const tvi_options *options);
void tvi_galerkin_linear_prediction_take(galerkin_linear_prediction *w, tvi_arena *arena, const galerkin_field *field,
                                         const tvi_options *options);
/* Once the coefficients are there. */
void tvi_galerkin_linear_prediction_prepare(galerkin_linear_prediction *w, const galerkin_coefficients *a,
                                            const galerkin_field *field);
/* Steps of another size, or from another place. */
void tvi_galerkin_linear_prediction_start(galerkin_linear_prediction *w, double h);
/* Where it is time to: keeps the steps that the predictor has, and once there are enough fits what the next ones are
 * predicted by. */
void tvi_galerkin_linear_prediction_look(galerkin_linear_prediction *w, const galerkin_predictor *predictor,
                                         const galerkin_coefficients *a, const galerkin_field *field);

#endif
