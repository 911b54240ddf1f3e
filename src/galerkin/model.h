/* model.h - the gradient that drives the unknowns, with its derivatives at the nodes: passes that know them solve the
 * equations to first order about where the gradient was evaluated (docs/method.md section 5). */
#ifndef TVI_SRC_GALERKIN_MODEL_H
#define TVI_SRC_GALERKIN_MODEL_H

#include "galerkin/field.h"

/* Of L in (q, v), or of a product in (q, p): the inputs of the tapes, two halves of n rows each. */
typedef struct {
    double *values, *second; /* blocks of the tapes of the field, and of it with its derivatives: zeros behind it */
    lanes_model lanes;
    lanes_term *term; /* [2 seconds] its terms, */
    int *end;         /* [2n] and rows */
} galerkin_model;

/* term [2 seconds], end [2n]. */
void tvi_galerkin_model_terms(const tvi_system *system, lanes_term *term, int *end);

void tvi_galerkin_model_take(galerkin_model *model, tvi_arena *arena, const galerkin_field *field);
void tvi_galerkin_model_prepare(galerkin_model *model, const galerkin_field *field);

/* The block in which the gradient is, at the nodes, first and last [n][lanes], and its derivatives, too; NULL outside
 * its domain. */
const double *tvi_galerkin_model_sweep(galerkin_model *model, const galerkin_field *field, bool with_second,
                                       const double *first, const double *last);
/* gradient [2n][lanes]; false outside its domain. */
bool tvi_galerkin_model_evaluate(galerkin_model *model, const galerkin_field *field, bool with_second,
                                 const double *first, const double *last, double *gradient);

#endif
