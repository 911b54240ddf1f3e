/* functions.h - Declares the functions that the tests record: each operation on its own, and some functions as users
 * write them. Each has a counterpart of the same name in quad_series.c, written again in complex quadruple precision.
 */
#ifndef TVI_TESTS_AD_FUNCTIONS_H
#define TVI_TESTS_AD_FUNCTIONS_H

#include "jet.h"

enum { INPUTS_MAX = 18, OUTPUTS_MAX = 18, DEGREE_MAX = 40, ORDERS = DEGREE_MAX + 1 };

/* z = f(x); c is the exponent of pow and otherwise ignored. */
typedef void record_fn(double c, const jet x[], jet z[]);

typedef struct {
    const char *name;
    record_fn *record;
    int inputs, outputs;
    double c;
    double centre[INPUTS_MAX]; /* order 0 of the inputs, at least 0.5 away from every singularity */
    double bound;              /* of the roundoff, relative to the natural scale of a coefficient (see record.h) */
} function;

extern const function operations[], compositions[];
extern const int operation_count, composition_count;

/* Operation i, or composition i - operation_count. */
const function *any_function(int i);
/* Returns the function that records the operation; aborts if there is none of that name. */
record_fn *operation_named(const char *name);

/* A series of full length in every input, x[input * (degree + 1) + k]: order 0 is the centre, the others have the size
 * 0.25 / 2^k, so that f(x(s)) is analytic for |s| < 4/3 at least. */
void dense_series(const function *f, int degree, double x[]);
/* Another, as the direction of a tangent; each number gives a different one. */
void dense_direction(const function *f, int number, int degree, double dx[]);

#endif
