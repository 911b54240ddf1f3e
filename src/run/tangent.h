/* tangent.h - moves tangent vectors by the Jacobian of a step. */
#ifndef TVI_SRC_RUN_TANGENT_H
#define TVI_SRC_RUN_TANGENT_H

#include "run/integrator.h"

/* A step of size h: the state that it starts from, the parameters that it is made with. */
typedef struct {
    const tvi_run_state *from;
    const double *parameters;
    double h;
} tvi_lifted_step;

/* Tangent vectors, D[2n + parameters][columns], each number `apart` from the next one. */
typedef struct {
    double *D;
    int columns;
    size_t apart;
} tvi_columns;

struct tvi_tangent {
    int n;       /* of the system that steps are made of */
    bool paired; /* the momenta of (q, dq) are (dp, p), else (p, dp) */
    tvi_system *system;
    tvi_integrator *integrator;
    double *Q, *P;       /* [2n] the lifted state */
    double *column;      /* [2n + parameters] one vector, */
    double *gradient;    /* [2n] K_q, K_p */
    double *flow;        /* of a rescaled system: a block of the field's tape, else NULL, */
    double *change;      /* and one of the lift's energy, the change of K along a column */
    double *values;      /* [2 parameters] of the lifted system: the integrator's, and the rates of those */
    double *start, *end; /* [2 n of the user + parameters][columns] before the last step, and after it */
    int columns;         /* that these have room for */
    long step;           /* the last step that a run moved them by, as the integrator counts; 0: none; */
    int moved;           /* and how many they were */
};

/* Refuses vectors that are not finite. */
TVI_NODISCARD tvi_status tvi_columns_check(const tvi_integrator *integrator, const tvi_columns *columns);
/* out = M columns, with M the Jacobian of the step; the parameters' rows of `out` are left alone. Needs
 * tvi_integrator_provide_tangent. On failure `out` is undefined. */
TVI_NODISCARD tvi_status tvi_columns_move(const tvi_integrator *integrator, const tvi_lifted_step *step,
                                          const tvi_columns *columns, const tvi_columns *out);

#endif
