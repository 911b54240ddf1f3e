/* expression.h - Declares random formulas, as lists of operations that several interpreters read: one records them in
 * jets, one evaluates them in double while they are made, one (series_quad.h) as power series in quadruple precision.
 * Nothing here is the library's: the derivatives too are made here. */
#ifndef TESTS_FUZZ_STEPS_EXPRESSION_H
#define TESTS_FUZZ_STEPS_EXPRESSION_H

#include "jet.h"

#include <stdint.h>
#include <stdio.h>

typedef enum {
    X_INPUT,
    X_NUMBER,
    X_ADD,
    X_SUB,
    X_MUL,
    X_DIV,
    X_POW,
    X_NEG,
    X_SQR,
    X_SQRT,
    X_EXP,
    X_LOG,
    X_SIN,
    X_COS,
    X_TAN,
    X_ASIN,
    X_ACOS,
    X_ATAN,
    X_SINH,
    X_COSH,
    X_TANH,
    X_COUNT
} operation;

/* z = op(a, b), or of a alone; b is then what the interpreters need beside it: the cosine of a sine and the like
 * (partner), what tan, tanh and the square are equal to, and for z' = +-a'/w of asin, acos and atan the w. number: of a
 * number and a power. parameter: 1 + its index, of a number that is one; it is recorded with another value. */
typedef struct {
    operation op;
    int a, b;
    double number, value; /* the value at the place where the formula was made */
    int parameter;
} formula_node;

enum { NODES_MOST = 6000, INPUTS_MOST = 25 };

typedef struct {
    int inputs, count;
    formula_node *nodes; /* [NODES_MOST]; the inputs come first */
} formula;

/* Evaluates it at these values of the inputs; the caller frees the nodes. */
formula formula_of(int inputs, const double value[]);
int number_of(formula *f, double number);
int apply(formula *f, operation op, int a, int b);
int power(formula *f, int a, double exponent);

/* Appends the nodes of another formula, whose input i is node input[i] of this one; what its node z is then. */
int append_formula(formula *f, const formula *other, const int input[], int z);

/* Random numbers: the generator splitmix64. */
typedef struct {
    uint64_t state;
} random_source;
double uniform(random_source *r, double from, double to);
int choose(random_source *r, int count);

/* A random formula in count of the inputs, from first on, of which it takes any; its value is between -20 and 20 and
 * all that it is made of is away from the edges of its domain. */
int random_term(formula *f, random_source *r, int first, int count, int depth);

/* gradient[i] = d out / d input_i. */
void gradient_of(formula *f, int out, int inputs, int gradient[]);

/* The nodes out[count] in jets of the inputs. */
void record(const formula *f, const jet input[], int count, const int out[], jet value[]);

/* In words; names[i] of the inputs. */
void print_formula(FILE *to, const formula *f, int out, const char *const names[]);

#endif
