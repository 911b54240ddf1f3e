/* graph.h - Declares the graph that records a function: a directed graph of operations on jets. It is internal to the
 * library.
 *
 * A graph is open while the user's function runs, and closed afterwards; a closed graph is never written to. Constants
 * are folded and equal nodes shared as they are recorded, so that what the user wrote twice is computed once. */
#ifndef TVI_AD_GRAPH_H
#define TVI_AD_GRAPH_H

#include "jet.h"

#include <stdbool.h>
#include <stddef.h>

/* The operations that are left after folding. A sum of multiples is one LINEAR node: add, sub, neg, sum, scaling by a
 * number and adding a number. A partner w is another series that the recurrence of z needs (see rule.h). */
typedef enum {
    OP_INPUT,
    OP_CONST,
    OP_PARAMETER, /* a constant that may be changed when the recording is run */
    OP_LINEAR,    /* z = number + sum_i coefficient_i node_i        */
    OP_MUL,       /* z = a b                                        */
    OP_SQR,       /* z = a^2                                        */
    OP_DIV,       /* z = a / b                                      */
    OP_SQRT,      /* z = sqrt a                                     */
    OP_POW,       /* z = a^number                                   */
    OP_HYPOT,     /* z = sqrt(a^2 + b^2)                            */
    OP_ATAN2,     /* z' = (b a' - a b') / w, w = a^2 + b^2          */
    OP_EXP,       /* z' =  w a', w = z                              */
    OP_SIN,       /* z' =  w a', w = cos a                          */
    OP_COS,       /* z' = -w a', w = sin a                          */
    OP_SINH,      /* z' =  w a', w = cosh a                         */
    OP_COSH,      /* z' =  w a', w = sinh a                         */
    OP_TAN,       /* z' =  w a', w = 1 + z^2                        */
    OP_TANH,      /* z' =  w a', w = sech2 a                        */
    OP_SECH2,     /* z = 1 - w^2 = 1 / cosh^2 a, w = tanh a         */
    OP_ERF,       /* z' =  w a', w = 2 exp(-a^2) / sqrt(pi)         */
    OP_LOG,       /* z' =  a' / w, w = a                            */
    OP_ASIN,      /* z' =  a' / w, w = sqrt((1-a)(1+a))             */
    OP_ACOS,      /* z' = -a' / w, w = sqrt((1-a)(1+a))             */
    OP_ATAN,      /* z' =  a' / w, w = 1 + a^2                      */
    OP_ASINH,     /* z' =  a' / w, w = sqrt(1 + a^2)                */
    OP_ACOSH,     /* z' =  a' / w, w = sqrt((a-1)(a+1))             */
    OP_ATANH,     /* z' =  a' / w, w = (1-a)(1+a)                   */
    /* only on a tape: */
    OP_PRODUCTS, /* z = sum_i coefficient_i a_i b_i */
    OP_SQUARES,  /* z = sum_i coefficient_i a_i^2   */
    OP_COUNT
} jet_op;

typedef struct jet_graph jet_graph;

/* The reasons why a jet has no value. JET_OUTSIDE + op: the operation has no power series there. */
#define JET_REASON_LIST(ROW)                                                                                           \
    ROW(JET_UNSET, TVI_EINVAL, "was not set")                                                                          \
    ROW(JET_FOREIGN, TVI_EINVAL, "is made of jets of another recording, or of one that has ended")                     \
    ROW(JET_NO_FUNCTION, TVI_EINVAL, "is made by a function that does not exist")                                      \
    ROW(JET_NO_PARAMETER, TVI_EINVAL,                                                                                  \
        "is made of a parameter whose index is out of range, or that names no recording")                              \
    ROW(JET_TWO_VALUES, TVI_EINVAL, "is made of a parameter that was recorded with another value")                     \
    ROW(JET_NO_MEMORY, TVI_ENOMEM, "is made by an operation that found no memory")                                     \
    ROW(JET_NOT_FINITE, TVI_ENONFINITE, "is made of a number that is not finite")                                      \
    ROW(JET_NOT_POSITIVE, TVI_EDOMAIN, "is made of a time scale that is not positive")
#define JET_REASON_NAME(reason, status, text) reason,
typedef enum { JET_REASON_LIST(JET_REASON_NAME) JET_OUTSIDE } jet_reason;
#undef JET_REASON_NAME

typedef struct jet_term {
    double coefficient;
    struct jet_node *node;
} jet_term;

struct jet_node {
    jet_graph *graph; /* NULL: a poison node */
    jet_op op;
    int index;          /* order of recording: operands come first, partners may come later */
    double number;      /* CONST, PARAMETER: the value; POW: the exponent; LINEAR: the number added */
    struct jet_node *a; /* the operand */
    struct jet_node *b; /* the second operand, or NULL */
    struct jet_node *w; /* the partner, or NULL */
    jet_term *terms;    /* LINEAR                                                           */
    int count;          /* number of terms; of a poison node its jet_reason */
    int mark;           /* scratch of walks through the graph */
    int which;          /* PARAMETER: its index; the last member (tests/ad/test_sharing.c) */
};

/* Creates an open graph, whose first nodes are its inputs. NULL without memory. */
jet_graph *jet_graph_create(int inputs);
void jet_graph_close(jet_graph *graph);
/* Sets the name of the outputs for refusals, in static text. */
void jet_graph_name(jet_graph *graph, const char *name);
/* Sets the name for refusals of the operations from here on, which are not the user's own, in static text. */
void jet_graph_name_part(jet_graph *graph, const char *part);
/* The name that was set, and the index of the first of these operations; NULL if there are none. */
const char *jet_graph_part_name(const jet_graph *graph, int *index);
void jet_graph_free(jet_graph *graph);

/* The node equal to `wanted`, recorded now if it is new. The graph owns the terms of `wanted` then. NULL without
 * memory. */
struct jet_node *jet_graph_record(jet_graph *graph, struct jet_node wanted, bool *is_new);
/* The jet of this node; poison without memory. */
jet jet_graph_record_jet(jet_graph *graph, struct jet_node wanted);
jet jet_graph_constant(jet_graph *graph, double value);
/* A number that may be replaced in later runs (jet_parameter). TVI_EINVAL: it was recorded with another value. */
jet jet_graph_parameter(jet_graph *graph, int which, double value);
/* 1 + the largest index of a parameter. */
int jet_graph_parameters(const jet_graph *graph);
/* Records that an operation was lost for want of memory. No output is accepted any more. */
void jet_graph_lose(jet_graph *graph);

int jet_graph_inputs(const jet_graph *graph);
jet jet_graph_input(const jet_graph *graph, int i);
int jet_graph_count(const jet_graph *graph);
/* How often the search for a node met another one that was recorded before. */
long jet_graph_collisions(const jet_graph *graph);
struct jet_node *jet_graph_node(const jet_graph *graph, int index);

static inline jet jet_of_node(struct jet_node *node) { return (jet){0, node}; }

/* Finds the open graph that all nodes among x belong to; NULL if all are numbers. Returns the poison that an operation
 * on x is to return, otherwise a number. */
jet jet_graph_of(int count, const jet x[], jet_graph **graph);
/* A jet without a graph that stands for the reason, as do all jets made of it. Its node's index is the status. */
jet jet_poison(jet_reason reason);
/* The poison of an operation outside its domain, with its operand. */
jet jet_poison_at(jet_op op, double operand);
bool jet_is_poison(jet x);
/* A jet that no operation has set. Outputs are filled with it before the user's function runs. */
static inline jet jet_unset(void) { return jet_poison(JET_UNSET); }
/* Makes the jets outputs of the open graph: its nodes stay, finite numbers become constant nodes. Any other jet is
 * refused, and jet_refusal gives the reason. */
tvi_status jet_graph_accept(jet_graph *graph, int outputs, jet output[]);

/* Records an operation from OP_SQRT on, except OP_POW. b is ignored if the operation has one operand. */
jet jet_record_op(jet_op op, jet a, jet b);

/* Records sum_i coefficient[i] x[i]. Equal nodes are collected, numbers folded. */
jet jet_linear(int count, const double coefficient[], const jet x[]);
/* Records gradient[i] = d output / d input_i, i < inputs, into the same open graph, by reverse accumulation. The
 * gradient is poison if the output is not a jet of the graph. Returns false without memory. */
bool jet_gradient(jet_graph *graph, jet output, int inputs, jet gradient[]);

/* Records outputs of a closed graph once more into the open graph `to`, with the jets of `input`, all different, in the
 * place of the inputs: value[i] = output_i. rate[i] is its derivative as the inputs move along `direction` and the
 * parameters along `parameter_direction`, NULL: not at all (forward accumulation). Results are poison if one of their
 * inputs is. The closed graph is only read. Returns false without memory. */
bool jet_lift(const jet_graph *from, jet_graph *to, const jet input[], const jet direction[],
              const jet parameter_direction[], int outputs, const jet output[], jet value[], jet rate[]);

#endif
