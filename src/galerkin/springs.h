/* springs.h - the stiffest springs of a separable system (docs/method.md section 5).
 *
 * A movement r of a pass, by the force where the unknowns are, leaves of an error e the part h^2 a a M^-1 F' e: most
 * where the force grows fastest with the coordinates. Where F' changes little from step to step its stiffest modes,
 *     F' v_k = -w_k^2 M v_k,  v_k . M v_l = 1 or 0,
 * are solved exactly in each pass: it moves by
 *     r + sum_k v_k (D_k - 1) (v_k . M r),  D_k = (1 + w_k^2 h^2 a a)^-1,
 * which is 0 where r is. Whether that pays is seen: some steps are made without it and some with it, and their passes
 * are counted. */
#ifndef TVI_SRC_GALERKIN_SPRINGS_H
#define TVI_SRC_GALERKIN_SPRINGS_H

#include "algebra/linear.h"
#include "galerkin/coefficients.h"
#include "galerkin/field.h"
#include "system/stiffness.h"

/* How steps are going; in the arena's history. */
typedef struct {
    int count;            /* of the modes in use, */
    int turn;             /* and where they are */
    double h;             /* of the steps */
    double steps, passes; /* since the last look, */
    double wait;          /* after so many of which is the next one */
    double plain;         /* passes of a step without modes */
    double used;          /* so many steps had those in use, */
    double first;         /* and so many passes each of the first ones; 0: not known yet */
} galerkin_springs_history;

typedef struct {
    galerkin_springs_history *last; /* NULL: this system has no modes, or its passes are counted */
    bool is_wanted;                 /* not only where passes fail */
    int most;                       /* modes */
    galerkin_springs of_passes;
    double *modes[GALERKIN_TURNS]; /* [n] w^2 and [n][n] v, 0 behind those that there are; in the history, where a step
                                      leaves those of the one before, that it may fail */
    double radius;                 /* the spectral radius of a a */
    double *dual, *table;          /* of the passes, */
    double h, *of_tables;          /* for these */
    tvi_stiffness stiffness;
    double *K, *along, *scratch; /* [n][n] each, and more */
    tvi_factor factor;           /* of a mode's equations */
} galerkin_springs_work;

void tvi_galerkin_springs_take(galerkin_springs_work *w, tvi_arena *arena, const galerkin_field *field,
                               const tvi_options *options);
/* Once the coefficients are there. */
void tvi_galerkin_springs_ready(galerkin_springs_work *w, const galerkin_coefficients *coefficients,
                                const galerkin_field *field);

#endif
