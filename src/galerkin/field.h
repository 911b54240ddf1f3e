/* field.h - what drives the unknowns of the Galerkin curve, where they are: all in which the forms of systems
 * differ, but for the order of the equations (galerkin.c). */
#ifndef TVI_SRC_GALERKIN_FIELD_H
#define TVI_SRC_GALERKIN_FIELD_H

#include "galerkin/loops.h"
#include "method/stepper.h"

#include <string.h>

typedef struct galerkin_form galerkin_form;

/* The unknowns are Q of a separable system, else Q and P; F, or V and F, drives them. */
typedef struct {
    const tvi_system *system;
    const galerkin_form *form;
    const galerkin_loops *loops;
    int points; /* of the lanes; the others repeat the last one */
    galerkin_nodes nodes;
    int rows;       /* of nodes.x that a pass begins with */
    double h;       /* of the nodes' weights and scales; 0: none yet */
    double *b;      /* [lanes] */
    int *slot;      /* [unknowns] where in nodes.x what drives each unknown is */
    double *inputs; /* block of the field's tape, which has the time */
    double *matrix; /* [j][i] a_ij / b_j, or (a a)_ij / b_j of a separable system */
    double *ahead;  /* [j][i] what `predict` wants extrapolations multiplied by */
    int copies;
    int *copied; /* [copies] outputs of the tape that are inputs: they are copied behind its slots */
    void *own;   /* of the form */
} galerkin_field;

struct galerkin_form {
    int force_sign; /* P' is this times what drives P */
    bool is_newton; /* a pass contracts no less than the one before it */
    void (*take)(galerkin_field *field, tvi_arena *arena);
    /* Once the matrix is there. */
    void (*prepare)(galerkin_field *field);
    /* What drives the unknowns at the start of the step, for all nodes. */
    tvi_status (*start)(galerkin_field *field, const tvi_origin *origin);
    /* The unknowns by the impulses of earlier steps: impulses[step][u][j], extrapolation times ahead [steps][j][i]. */
    void (*predict)(galerkin_field *field, int steps, const double *extrapolation, const double *const impulses[]);
    /* See galerkin_pass; NULL: by galerkin_evaluate. */
    tvi_status (*pass)(galerkin_field *field, double *moved, tvi_stats *stats);
};

/* A tape's inputs are the unknowns, and its outputs drive them; and a Lagrangian's. */
extern const galerkin_form tvi_galerkin_form_plain, tvi_galerkin_form_lagrangian;

/* Whether Q'' is driven, by the force, and not Q' and P'. */
static inline bool galerkin_is_second_order(const galerkin_field *field)
{
    return field->system->form == TVI_SEPARABLE;
}

/* Runs the tape at the unknowns, which are its inputs. */
static inline tvi_status galerkin_evaluate(galerkin_field *field)
{
    const jet_tape *tape = field->system->field_values;
    double *x = field->nodes.x;
    if (!jet_sweep_values(tape, x, field->nodes.lanes)) return TVI_EDOMAIN;
    const size_t lanes = (size_t)field->nodes.lanes;
    for (int i = 0; i < field->copies; i++)
        memcpy(x + (size_t)(tape->slots + i) * lanes, x + (size_t)field->copied[i] * lanes, lanes * sizeof *x);
    return TVI_OK;
}

/* What drives the unknowns where they are, and they moved by it, as far as `move` says. Counts factorisations. */
static inline tvi_status galerkin_pass(galerkin_field *field, double *moved, tvi_stats *stats)
{
    if (field->form->pass) return field->form->pass(field, moved, stats);
    const tvi_status status = galerkin_evaluate(field);
    if (status == TVI_OK) *moved = field->loops->move(&field->nodes, field->matrix, field->nodes.x, field->slot);
    return status;
}

#endif
