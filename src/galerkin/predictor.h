/* predictor.h - the unknowns of a step by the impulses of the steps before (docs/method.md section 5). */
#ifndef TVI_SRC_GALERKIN_PREDICTOR_H
#define TVI_SRC_GALERKIN_PREDICTOR_H

#include "galerkin/coefficients.h"
#include "galerkin/field.h"

/* The last two steps; in the arena's history. */
typedef struct {
    double h, h_before; /* 0: none */
    double t;           /* where the last one began */
    galerkin_pace pace; /* of its passes; or, what they do not show, of those before it */
    long turn;          /* where its impulses are */
} galerkin_history;

/* Whether one that came from elsewhere has its index within the turns. */
static inline bool galerkin_is_sound(const galerkin_history *last)
{
    return last->turn >= 0 && last->turn < GALERKIN_TURNS;
}

typedef struct {
    galerkin_history *last;
    double *impulses[GALERKIN_TURNS]; /* in the history, filled in turns: [unknowns][lanes] of a step */
    double *from_two, *from_last;     /* galerkin_extrapolation, where the steps before have the size of this one */
    double rough;       /* the size of a first movement, of all unknowns together: where predictions are off by a
                           hundredth of them, what the last step has is nearer */
    double *from_one;   /* [j][lanes] from a step of size h / ratio to one that begins after `part` of it */
    double ratio, part; /* ratio 0: none yet */
    double *led;        /* [unknowns][lanes] what it leads to */
    double *none, *one; /* [unknowns + lanes] 0 and 1 */
} galerkin_predictor;

void tvi_galerkin_predictor_take(galerkin_predictor *w, tvi_arena *arena, const galerkin_field *field);
void tvi_galerkin_predictor_prepare(galerkin_predictor *w, const galerkin_coefficients *a, const galerkin_field *field);
/* Whether a step of size h from t begins where the last one ended. */
static inline bool galerkin_is_next(const galerkin_history *last, double h, double t)
{
    return fabs(t - (last->t + last->h)) < 0.25 * fabs(h);
}

/* Whether the step of the field's size from t begins where the last one ended, or began, after `part` of it, and its
 * nodes are near those of that one. */
bool tvi_galerkin_can_extrapolate(const galerkin_predictor *w, const galerkin_field *field, double t, double *part);
/* How many of the last two steps have the size of this one, which begins where the last one ended. */
int tvi_galerkin_known(const galerkin_predictor *w, const galerkin_field *field, double part);
/* Sets the field's unknowns by the last step, where none is known so. */
void tvi_galerkin_extrapolate(galerkin_predictor *w, const galerkin_coefficients *a, const galerkin_dense *dense,
                              galerkin_field *field, double part);
/* Those of the last step, of steps before it, and where the next one puts its own: after_last <= 1. */
static inline double *tvi_galerkin_impulses(const galerkin_predictor *w, int after_last)
{
    return w->impulses[(w->last->turn + after_last + GALERKIN_TURNS) % GALERKIN_TURNS];
}

#endif
