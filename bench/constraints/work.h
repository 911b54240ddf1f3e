/* work.h - Declares the problems of the comparison of methods on constraints, and the rivals. */
#ifndef CONSTRAINTS_WORK_H
#define CONSTRAINTS_WORK_H

#include "chain.h"

#include <stdbool.h>

/* Chains of 1, 2 and 10 links, together of the length 1, 2 and 1; water, a molecule in a field; a heavy top. */
typedef enum { WORK_PENDULUM, WORK_DOUBLE, WORK_CHAIN, WORK_WATER, WORK_TOP, WORK_PROBLEMS } work_problem;

enum { WORK_NUMBERS = 2 * LINKS_MOST }; /* of coordinates, at most */
#define WORK_GRAVITY 9.8

/* The top of mass 1: moments of inertia about the centre of mass, which is TOP_ARM above the fixed point along axis 2,
 * and 1, 1, 0.5 about the fixed point. The masses of its directors there are 0.25, 0.25, 0.75. */
#define TOP_INERTIA                                                                                                    \
    {                                                                                                                  \
        0.75, 0.75, 0.5                                                                                                \
    }
#define TOP_ARM     0.5
#define TOP_GRAVITY 4.0
#define TOP_WEIGHT  (TOP_GRAVITY * TOP_ARM)
#define TOP_INVERSE_MASSES                                                                                             \
    {                                                                                                                  \
        4, 4, 4.0 / 3                                                                                                  \
    }

/* Each runs from q, v to their values after `duration`. false: it failed. */
typedef struct {
    work_problem problem;
    double duration;
    long steps;       /* of RATTLE */
    double tolerance; /* relative and absolute, of SUNDIALS */
} work_task;

/* RATTLE (order 2) and its symmetric compositions of orders 4, 6, 8, 10. */
bool rattle_run(const work_task *task, int order, double q[], double v[]);

/* IDA on the equations with phi'' = 0 (index 1), or with phi = phi' = 0 (Gear, Gupta and Leimkuhler), and CVODE's Adams
 * methods on v' = W (F - G^T lambda(q, v)). */
typedef enum { SUNDIALS_IDA_1, SUNDIALS_IDA_2, SUNDIALS_ADAMS, SUNDIALS_KINDS } sundials_kind;
extern const bool has_sundials;
bool sundials_run(const work_task *task, sundials_kind kind, double q[], double v[]);

#endif
