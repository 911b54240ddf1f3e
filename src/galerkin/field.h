/* field.h - what drives the unknowns of the Galerkin curve, where they are: all in which the forms of systems
 * differ, but for the order of the equations (galerkin.c). */
#ifndef TVI_SRC_GALERKIN_FIELD_H
#define TVI_SRC_GALERKIN_FIELD_H

#include "algebra/passes.h"
#include "galerkin/blocks.h"
#include "method/stepper.h"
#include "system/roundoff.h"

#include <math.h>
#include <string.h>

typedef struct galerkin_form galerkin_form;

/* The unknowns are Q of a separable system, else Q and P; F, or V and F, drives them. */
typedef struct {
    const tvi_system *system;
    const galerkin_form *form;
    const galerkin_loops *loops;
    int points; /* of the lanes; the others repeat the last one */
    galerkin_nodes nodes;
    int rows;            /* of nodes.x that a pass begins with */
    double h;            /* of the nodes' weights and scales; 0: none yet */
    double *b;           /* [lanes] */
    int *slot;           /* [unknowns] where in nodes.x what drives each unknown is */
    double *inputs;      /* block of the field's tape, which has the time */
    double *matrix;      /* of coefficients.h: [j][i] a_ij / b_j, or (a a)_ij / b_j of a separable system */
    double *ahead;       /* [j][i] what `predict` wants extrapolations multiplied by */
    tvi_roundoff *noise; /* what the values of the field are displaced by; NULL: they are not */
    void *own;           /* of the form */
} galerkin_field;

struct galerkin_form {
    int force_sign;              /* P' is this times what drives P */
    const tvi_passes_rule *rule; /* of a movement's part in one unknown at one node */
    void (*take)(galerkin_field *field, tvi_arena *arena);
    /* Once the matrix is there. */
    void (*prepare)(galerkin_field *field);
    /* The unknowns by what drives them at the start of the step, for all nodes. */
    tvi_status (*start)(galerkin_field *field, const tvi_origin *origin);
    /* The unknowns by the impulses of earlier steps: tables times ahead. */
    void (*predict)(galerkin_field *field, const galerkin_extrapolation *by);
    /* See tvi_galerkin_pass; NULL: by galerkin_evaluate. Not counted. */
    tvi_status (*pass)(galerkin_field *field, double *moved, tvi_stats *stats);
    /* Defines its constants in generated code; and the text of its steps (generated_*.h). */
    void (*emit)(jet_text *text, const galerkin_field *field);
    const char *const *text;
};

/* When the passes of a fixed point, of a method whose Jacobian stays and of Newton's may end: probe.c. */
extern const tvi_passes_rule tvi_galerkin_fixed_point, tvi_galerkin_quasi_newton, tvi_galerkin_newton;

/* A tape's inputs are the unknowns, and its outputs drive them; those that know second derivatives. */
extern const galerkin_form tvi_galerkin_form_plain, tvi_galerkin_form_lagrangian, tvi_galerkin_form_hamiltonian,
    tvi_galerkin_form_product;

/* Whether Q'' is driven, by the force, and not Q' and P'. */
static inline bool galerkin_is_second_order(const galerkin_field *field)
{
    return field->system->form == TVI_SEPARABLE;
}

/* Defines `static const galerkin_code NAME` of generated code that has the sweeps (emit.c), of a field that is
 * prepared, whose passes have this rule. */
void tvi_galerkin_emit(jet_text *text, const galerkin_field *field, const tvi_passes_rule *rule);
/* Defines `static const int galerkin_what[]`, with a 0 behind it. */
void tvi_galerkin_emit_ints(jet_text *text, const char *what, int count, const int value[]);
extern const char *const tvi_embedded_galerkin_plain[], *const tvi_embedded_galerkin_lagrangian[];
extern const char *const tvi_embedded_galerkin_hamiltonian[];
/* Of a block of the tape the rows that a sweep of it does not set. */
static inline int galerkin_rows_kept(const jet_tape *tape) { return tape->inputs + tape->constants; }

/* Displaces the outputs of a tape of the field in its block. */
void tvi_galerkin_displace(const galerkin_field *field, const jet_tape *tape, double *x);

/* Runs the tape at the unknowns, which are its inputs. */
static inline tvi_status galerkin_evaluate(galerkin_field *field)
{
    const jet_tape *tape = field->system->field_values;
    double *x = field->nodes.x;
    if (!jet_sweep_values(tape, x, field->nodes.lanes)) return TVI_EDOMAIN;
    if (field->noise) tvi_galerkin_displace(field, tape, x);
    return TVI_OK;
}

/* The unknowns moved by what drives them, as far as `move` says. */
static inline double galerkin_move(const galerkin_field *field)
{
    double moved;
    field->loops->move(&field->nodes, field->matrix, field->nodes.x, field->slot, &moved);
    return moved;
}

/* A pass: what drives the unknowns where they are, and they moved by it, as far as `move` says. Counts. */
static inline tvi_status tvi_galerkin_pass(galerkin_field *field, double *moved, tvi_stats *stats)
{
    stats->force_evaluations += field->points;
    if (field->form->pass) {
        const tvi_status status = field->form->pass(field, moved, stats);
        if (status != TVI_OK) return status;
    } else {
        if (galerkin_evaluate(field) != TVI_OK) return TVI_EDOMAIN;
        *moved = galerkin_move(field);
    }
    stats->passes++;
    return isfinite(*moved) ? TVI_OK : TVI_ENONFINITE;
}

#endif
