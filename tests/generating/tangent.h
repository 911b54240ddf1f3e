/* tangent.h - Declares what the tests of the tangent map share: matrices, a model with an integrator, a step with
 * columns. */
#ifndef TESTS_GENERATING_TANGENT_H
#define TESTS_GENERATING_TANGENT_H

#include "models.h"

#include <check.h>

enum { MOST = 2 * N_MAX };
typedef double matrix[MOST * MOST]; /* [2n][2n], row after row */

void set_identity(int n, matrix a);
void multiply(int n, const matrix a, const matrix b, matrix c); /* c = a b */
/* max |a - b| relative to the largest element of b, or 1. */
double matrix_distance(int n, const matrix a, const matrix b);

/* A system and an integrator of it. */
typedef struct {
    const model *m;
    tvi_system *system;
    tvi_integrator *integrator;
} runs;

runs open_runs(const model *m, const tvi_options *options);
void close_runs(runs *r);
/* tvi_step_tangent, which must go well. */
void tangent_step(const runs *r, double h, test_state *x, double D[], int columns);
bool same_bits(int n, const test_state *a, const test_state *b);

TCase *tcase_tangent_algebra(void); /* in tangent_algebra.c */
TCase *tcase_tangent_steps(void);   /* in tangent_steps.c */

#endif
