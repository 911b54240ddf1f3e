/* compare.h - Compares a step of the library against the same step from its definition, in quadruple precision. */
#ifndef TESTS_FUZZ_STEPS_COMPARE_H
#define TESTS_FUZZ_STEPS_COMPARE_H

#include "problem.h"

#include <stdbool.h>

typedef struct {
    tvi_status made;    /* the system */
    bool has_reference; /* else the definition's own equations were not solved at this step, and nothing is known */
    tvi_status status;  /* of the step */
    double q, p; /* the largest errors, in units of what roundoff of every operation does to q and p in this step */
    double h;
    tvi_options options;
} comparison;

comparison compare_step(problem *x, random_source *r);

#endif
