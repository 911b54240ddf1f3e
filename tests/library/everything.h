/* everything.h - Declares what the tests of memory share: systems with every operation, in every form, and the ways to
 * make a step. */
#ifndef TVI_TESTS_EVERYTHING_H
#define TVI_TESTS_EVERYTHING_H

#include "tvi.h"

#include <check.h>

enum { N = 3 }; /* degrees of freedom */

/* The ways to state a problem. */
typedef enum {
    FORCE,
    POTENTIAL,
    LAGRANGIAN,
    HAMILTONIAN,
    SEPARABLE_L,
    SEPARABLE_H,
    RESCALED,
    REVERSIBLE,
    CONSTRAINED,
    STATEMENTS
} statement;

/* A light one has fewer operations, for steps that shall not take long. */
tvi_status state_everything(statement by, tvi_system **out, void *light);
tvi_system *create_everything(statement by, bool light);

typedef struct {
    const char *name;
    int order;
    tvi_quadrature quadrature;
    int passes;
    bool compose_adjoint;
    statement by;
} way;
extern const way ways[];
extern const int way_count;

tvi_options options_of_way(int which); /* of a way */

/* in faults_steps.c */
TCase *tcase_hooks(void);
TCase *tcase_allocations(void);
TCase *tcase_generated(void);

#endif
