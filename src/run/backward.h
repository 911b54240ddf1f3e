/* backward.h - Declares the adjoint system on its way back through a record, and its steps. gradient.c says which.
 *
 * A covector has the 2N derivatives of the loss by the state x = (q, p) of the stepped system, in N coordinates; the
 * time of a rescaled system is one of them, and e = -H one of the momenta. */
#ifndef TVI_SRC_RUN_BACKWARD_H
#define TVI_SRC_RUN_BACKWARD_H

#include "run/record.h"

/* The adjoint system on its way back. */
typedef struct tvi_backward {
    tvi_integrator *lift, *part; /* make steps back: one after the other, and from a state inside a step */
    tvi_adjoint_layout layout;
    int N, parameters, integrals;
    tvi_adjoint *own; /* the adjoint with integrals; NULL: that of the system is taken */
    const tvi_adjoint *adjoint;
    /* The quadrature of the steps: nodes theta and weights b of `points` nodes, of which `count` differ. */
    struct {
        int count, points;
        double theta[TVI_MOST_POINTS], b[TVI_MOST_POINTS];
        /* [i][j] The derivative at node i of the polynomial that is 1 at node j, and 0 at the others and at the
         * start. */
        double difference[TVI_MAX_NODES * TVI_MAX_NODES];
    } nodes;
    double *integrand_block; /* [slots][points] */
    double *energy_block;    /* of H_c; NULL: the steps are not those of K */
    double *curve;           /* [4N][points] the coordinates and the momenta of the lift at the nodes */
    double *z;               /* [4N] the coordinates and the momenta of the lift, for tvi_step */
    double *x_end;           /* [state_size] the state at the end of a step */
    /* Covectors [2N]: at the end of a piece; of what was told; and the gradient of the function that is 0 where it was
     * told. */
    struct {
        double *exit, *told, *surface;
    } covector;
    double *rates;         /* [2N] x' */
    double *velocity;      /* [N] of a Lagrangian */
    double *values;        /* [parameters + integrals] the parameters of the lift */
    double *by_parameters; /* [parameters + 1] the integrals so far: by the parameters, and by the time */
} tvi_backward;

/* Creates record->backward. */
TVI_NODISCARD tvi_status tvi_backward_create(tvi_record *record);
/* Sets the parameters to those of the record, and the derivatives of the loss by the integrals; NULL: all are 0. */
void tvi_backward_set_parameters(tvi_record *record, tvi_integrator *lift, const double by_integrals[]);
/* Clears the state of the lift, one of the two of tvi_backward, and its history. */
void tvi_backward_clear(tvi_integrator *lift);
/* Puts a full state [state_size] of the run into the lift. */
void tvi_backward_set_x(const tvi_backward *backward, tvi_integrator *lift, const double state[]);
/* Adds a covector to the multipliers of the lift, and reads them. */
void tvi_backward_add(const tvi_backward *backward, tvi_integrator *lift, const double covector[]);
void tvi_backward_get(const tvi_backward *backward, const tvi_integrator *lift, double covector[]);
/* Makes a step of -h of the lift from its present state, and adds the integrals over it to by_parameters. If the step
 * fails, it is made once more without predictions. Does nothing if all multipliers are 0. */
TVI_NODISCARD tvi_status tvi_backward_step(tvi_record *record, tvi_integrator *lift, double h);

#endif
