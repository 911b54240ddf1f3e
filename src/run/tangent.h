/* tangent.h - Multiplies tangent vectors by the Jacobian matrix of a step. tvi_step_tangent and runs with columns call
 * it. */
#ifndef TVI_SRC_RUN_TANGENT_H
#define TVI_SRC_RUN_TANGENT_H

#include "run/integrator.h"

/* A step of size h: the state that it starts from, and the parameters that it is made with. */
typedef struct {
    const tvi_run_state *start;
    const double *parameters;
    double h;
} tvi_lifted_step;

/* Tangent vectors D[2n + parameters][columns], whose numbers stand `spacing` apart. */
typedef struct {
    double *D;
    int columns;
    size_t spacing;
} tvi_columns;

struct tvi_tangent {
    int n;       /* of the system that steps are made of */
    bool paired; /* the momenta of (q, dq) are (dp, p), otherwise (p, dp) */
    tvi_system *system;
    tvi_integrator *integrator;
    double *Q, *P;    /* [2n] the lifted state */
    double *column;   /* [2n + parameters] one vector */
    double *gradient; /* [2n] K_q, K_p */
    double *flow;     /* block of the field's tape, of a rescaled system; NULL otherwise */
    double *change;   /* block of the lift's energy, the change of K along a column */
    /* [2 parameters] of the lifted system: the integrator's values, and their rates. */
    double *values;
    /* [2 n of the user + parameters][columns] before the last step, and after it. */
    double *start, *end;
    int columns; /* capacity of `start` and `end` */
    long step;   /* number of the last step of a run that moved them; 0: none */
    int moved;   /* how many columns that step moved */
};

/* Refuses vectors that are not finite. */
TVI_NODISCARD tvi_status tvi_columns_check(const tvi_integrator *integrator, const tvi_columns *columns);
/* Sets out = M columns, with M the Jacobian of the step. The rows of the parameters in `out` are not written. The
 * tangent has to be provided before (tvi_integrator_provide_tangent). On failure `out` is undefined. */
TVI_NODISCARD tvi_status tvi_columns_move(const tvi_integrator *integrator, const tvi_lifted_step *step,
                                          const tvi_columns *columns, const tvi_columns *out);

#endif
