/* model.h - Prepares the gradient of L or K and its derivatives at the nodes. Passes that know these solve the
 * equations to first order about the points where the gradient was evaluated (docs/method.md section 5). */
#ifndef TVI_SRC_GALERKIN_MODEL_H
#define TVI_SRC_GALERKIN_MODEL_H

#include "galerkin/blocks.h"
#include "galerkin/field.h"

typedef struct {
    galerkin_blocks blocks;
    lanes_model lanes;
    lanes_term *term; /* [2 hessian_entries] terms of the gradient */
    int *end;         /* [2n] ends of its rows */
} galerkin_model;

void tvi_galerkin_model_take(galerkin_model *model, tvi_arena *arena, const galerkin_field *field);
/* Sets the tables for `predict`, also those of the rates. */
void tvi_galerkin_model_prepare(galerkin_model *model, const galerkin_field *field);

/* Runs the tapes of the field in the blocks, with its noise. */
galerkin_sweep tvi_galerkin_sweep;

/* Writes the constants of the model in generated code. */
void tvi_galerkin_model_emit(jet_text *text, const galerkin_model *model);

#endif
