/* predictor.h - Predicts the unknowns of a step from the impulses of earlier steps (docs/method.md section 5). */
#ifndef TVI_SRC_GALERKIN_PREDICTOR_H
#define TVI_SRC_GALERKIN_PREDICTOR_H

#include "galerkin/coefficients.h"
#include "galerkin/field.h"

/* The last two steps, in the arena's history. */
typedef struct {
    double h, h_before; /* 0: none */
    double t;           /* the time where the last one began */
    /* The convergence of its passes, or of those before it if its passes do not show it. */
    galerkin_convergence convergence;
    long ring_index; /* of its impulses in the ring */
} galerkin_history;

/* Tells whether the index of a loaded history is within the ring. */
static inline bool galerkin_is_sound(const galerkin_history *last)
{
    return last->ring_index >= 0 && last->ring_index < GALERKIN_RING;
}

typedef struct {
    galerkin_history *last;
    /* The ring of impulses in the history: [unknowns][lanes] of a step. */
    double *impulses[GALERKIN_RING];
    /* Tables of galerkin_extrapolation, for earlier steps of the size of this one. */
    double *from_two, *from_last;
    /* A first movement of this size, of all unknowns together, makes predictions rough: if these are off by a
     * hundredth, the last step alone predicts better. */
    double rough_limit;
    /* [j][lanes] The table from a step of size h / ratio to one that begins after `part` of it. */
    double *from_one;
    double ratio, part;   /* ratio 0: none yet */
    double *extrapolated; /* [unknowns][lanes] the extrapolated rates */
    double *none, *one;   /* [unknowns + lanes] 0 and 1 */
} galerkin_predictor;

void tvi_galerkin_predictor_take(galerkin_predictor *w, tvi_arena *arena, const galerkin_field *field);
void tvi_galerkin_predictor_prepare(galerkin_predictor *w, const galerkin_coefficients *a, const galerkin_field *field);
/* Tells whether a step of size h from t begins where the last one ended. */
static inline bool galerkin_is_next(const galerkin_history *last, double h, double t)
{
    return fabs(t - (last->t + last->h)) < 0.25 * fabs(h);
}

/* Tells whether the step of the field's size from t begins after `part` of the last one, which it sets, and its nodes
 * are near those of that step. */
bool tvi_galerkin_can_extrapolate(const galerkin_predictor *w, const galerkin_field *field, double t, double *part);
/* How many of the last two steps have the size of this one, which begins where the last one ended. */
int tvi_galerkin_known(const galerkin_predictor *w, const galerkin_field *field, double part);
/* Sets the field's unknowns by the last step, if no step of the same size precedes. */
void tvi_galerkin_extrapolate(galerkin_predictor *w, const galerkin_coefficients *a, const galerkin_dense *dense,
                              galerkin_field *field, double part);
/* The impulses of the last step, of steps before it, and of the next one: after_last <= 1. */
static inline double *tvi_galerkin_impulses(const galerkin_predictor *w, int after_last)
{
    return w->impulses[(w->last->ring_index + after_last + GALERKIN_RING) % GALERKIN_RING];
}

#endif
