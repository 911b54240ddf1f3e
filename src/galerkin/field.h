/* field.h - Declares the field at the nodes of the Galerkin curve: the rates of its unknowns. It contains all
 * differences between the forms of systems except the order of the equations (galerkin.c). */
#ifndef TVI_SRC_GALERKIN_FIELD_H
#define TVI_SRC_GALERKIN_FIELD_H

#include "algebra/passes.h"
#include "galerkin/blocks.h"
#include "method/stepper.h"
#include "system/roundoff.h"

#include <math.h>
#include <string.h>

typedef struct galerkin_form galerkin_form;

/* The field at the nodes. The unknowns are Q of a separable system, otherwise Q and P; their rates are F, or V and
 * F. */
typedef struct {
    const tvi_system *system;
    const galerkin_form *form;
    const galerkin_loops *loops;
    int points; /* of the lanes; the others repeat the last one */
    galerkin_nodes nodes;
    int rows;       /* of nodes.x at the start of a pass */
    double h;       /* of the nodes' weights and scales; 0: none yet */
    double *b;      /* [lanes] */
    int *slot;      /* [unknowns] the row of nodes.x with the rate of each unknown */
    double *inputs; /* block of the field's tape, which has the time */
    /* Matrix of coefficients.h: [j][i] a_ij / b_j, or (a a)_ij / b_j of a separable system. */
    double *matrix;
    /* [j][i] The matrix that extrapolations are multiplied by for `predict`. */
    double *ahead;
    /* The displacements of the field's values when roundoff is measured; NULL otherwise. */
    tvi_roundoff *noise;
    void *own; /* of the form */
} galerkin_field;

struct galerkin_form {
    int force_sign;              /* 1 or -1: what the tape gives for P is multiplied by it to get P' */
    const tvi_passes_rule *rule; /* for a movement's part in one unknown at one node */
    void (*take)(galerkin_field *field, tvi_arena *arena);
    /* Prepares the form, once the matrix is there. */
    void (*prepare)(galerkin_field *field);
    /* Sets the unknowns of all nodes by the rates at the start of the step. */
    tvi_status (*start)(galerkin_field *field, const tvi_origin *origin);
    /* Predicts the unknowns from the impulses of earlier steps, by tables times `ahead`. */
    void (*predict)(galerkin_field *field, const galerkin_extrapolation *by);
    /* Does what tvi_galerkin_pass does, without counting; NULL: galerkin_evaluate is called. */
    tvi_status (*pass)(galerkin_field *field, double *moved, tvi_stats *stats);
    /* Writes the form's constants in generated code; `text` is that of its steps (generated_*.h). */
    void (*emit)(jet_text *text, const galerkin_field *field);
    const char *const *text;
};

/* The rules for the end of passes: of a fixed point, of a method whose Jacobian is kept, and of Newton's (probe.c). */
extern const tvi_passes_rule tvi_galerkin_fixed_point, tvi_galerkin_quasi_newton, tvi_galerkin_newton;

/* The forms of the field: with the tape's outputs as rates, and with second derivatives. */
extern const galerkin_form tvi_galerkin_form_plain, tvi_galerkin_form_lagrangian, tvi_galerkin_form_hamiltonian,
    tvi_galerkin_form_product;

/* Tells whether the equations are Q'' = F, and not Q' = V and P' = F. */
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
/* The rows of a block of the tape that a sweep does not set. */
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

/* Moves the unknowns by their rates. Returns the movement, as `move` measures it. */
static inline double galerkin_move(const galerkin_field *field)
{
    double moved;
    field->loops->move(&field->nodes, field->matrix, field->nodes.x, field->slot, &moved);
    return moved;
}

/* Makes a pass: it evaluates the rates of the unknowns, moves the unknowns by them, and counts. *moved is the movement,
 * as `move` measures it. */
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
