/* model.h - the gradient that drives the unknowns, with its derivatives at the nodes: passes that know them solve the
 * equations to first order about where the gradient was evaluated (docs/method.md section 5). */
#ifndef TVI_SRC_GALERKIN_MODEL_H
#define TVI_SRC_GALERKIN_MODEL_H

#include "galerkin/blocks.h"
#include "galerkin/field.h"

typedef struct {
    galerkin_blocks blocks;
    lanes_model lanes;
    lanes_term *term; /* [2 seconds] its terms, */
    int *end;         /* [2n] and rows */
} galerkin_model;

void tvi_galerkin_model_take(galerkin_model *model, tvi_arena *arena, const galerkin_field *field);
/* Sets what `predict` wants, drives, too. */
void tvi_galerkin_model_prepare(galerkin_model *model, const galerkin_field *field);

/* The tapes of the field that the blocks are of, with its noise. */
galerkin_sweep tvi_galerkin_sweep;

/* Defines what of the model is constant in generated code. */
void tvi_galerkin_model_emit(jet_text *text, const galerkin_model *model);

#endif
