/* graph.h - Declares the graph that records a function: a directed graph whose nodes are operations on jets
 * (docs/jets.md, section 1). The systems record the user's functions with it.
 *
 * A graph is open while the user's function runs, and closed afterwards; a closed graph never changes. Operations on
 * constants are folded, and equal nodes are recorded once, so that an expression that the user wrote twice is
 * computed once. */
#ifndef TVI_AD_GRAPH_H
#define TVI_AD_GRAPH_H

#include "jet.h"

#include <stdbool.h>
#include <stddef.h>

/* The operations that remain after folding. All sums, differences, multiples and added numbers become LINEAR nodes. In
 * the formulas, z is the result, a and b are the operands, and a prime is the derivative by the variable of the power
 * series. The auxiliary series w is another series that the recurrence of z needs (rule.h); `number` is the member of
 * jet_node. */
typedef enum {
    OP_INPUT,
    OP_CONST,
    OP_PARAMETER, /* A constant that may be changed before a sweep. */
    OP_LINEAR,    /* z = number + sum_i coefficient_i node_i        */
    OP_MUL,       /* z = a b                                        */
    OP_SQR,       /* z = a^2                                        */
    OP_DIV,       /* z = a / b                                      */
    OP_SQRT,      /* z = sqrt a                                     */
    OP_POW,       /* z = a^number                                   */
    OP_HYPOT,     /* z = sqrt(a^2 + b^2)                            */
    OP_ATAN2,     /* z' = (b a' - a b') / (w_0 w), w = radius       */
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
    OP_RADIUS,    /* z = (a^2 + b^2) / (a_0^2 + b_0^2)^(1/2)        */
    /* The following operations exist only on tapes. */
    OP_PRODUCTS, /* z = sum_i coefficient_i a_i b_i */
    OP_SQUARES,  /* z = sum_i coefficient_i a_i^2   */
    OP_COUNT
} jet_op;

typedef struct jet_graph jet_graph;

/* Lists the reasons why a jet has no value, each with its status and text. The reason JET_OUTSIDE + op means that the
 * operand of the operation op is outside the domain, where the operation has no power series. */
#define JET_REASON_LIST(ROW)                                                                                           \
    ROW(JET_UNSET, TVI_EINVAL, "was not set, or is made of a jet that was not set")                                    \
    ROW(JET_FOREIGN, TVI_EINVAL, "is made of jets of another recording, or of one that has ended")                     \
    ROW(JET_NO_FUNCTION, TVI_EINVAL, "is made by a function that does not exist")                                      \
    ROW(JET_NO_PARAMETER, TVI_EINVAL,                                                                                  \
        "is made of a parameter whose index is out of range, or that names no recording")                              \
    ROW(JET_TWO_VALUES, TVI_EINVAL, "is made of a parameter that was recorded with another value")                     \
    ROW(JET_NO_MEMORY, TVI_ENOMEM, "is made by an operation that found no memory")                                     \
    ROW(JET_NOT_FINITE, TVI_ENONFINITE, "is made of a number that is not finite")                                      \
    ROW(JET_NOT_POSITIVE, TVI_EDOMAIN, "is made of a time scale that is not positive")                                 \
    ROW(JET_BEYOND_Q, TVI_EINVAL, "is made of a component beyond the last one: q")                                     \
    ROW(JET_BEYOND_V, TVI_EINVAL, "is made of a component beyond the last one: v")                                     \
    ROW(JET_BEYOND_P, TVI_EINVAL, "is made of a component beyond the last one: p")
#define JET_REASON_NAME(reason, status, text) reason,
typedef enum { JET_REASON_LIST(JET_REASON_NAME) JET_OUTSIDE } jet_reason;
#undef JET_REASON_NAME

/* One term of a sum. */
typedef struct jet_term {
    double coefficient;
    struct jet_node *node;
} jet_term;

struct jet_node {
    jet_graph *graph; /* The graph that the node belongs to; NULL: the node is poison. */
    jet_op op;
    /* Number of the node in the order of recording. Its operands have smaller numbers; its auxiliary node may have a
     * larger one. */
    int index;
    double number;      /* CONST and PARAMETER: the value. POW: the exponent. LINEAR: the constant term. */
    struct jet_node *a; /* The first operand; NULL: there is none. */
    struct jet_node *b; /* The second operand; NULL: there is none. */
    struct jet_node *w; /* The auxiliary node, whose series the recurrence needs; NULL: there is none. */
    /* The node for whose auxiliary series this node was recorded, with which a refusal names it; NULL: none. */
    const struct jet_node *owner;
    jet_term *terms; /* LINEAR: the terms of the sum, [count]. */
    int count;       /* Number of terms. */
    int scratch;     /* Scratch of the function that runs: the index of a term, or a flag. */
    /* PARAMETER: the index of the parameter. This member must be the last one, since test_sharing.c compares all
     * members before it. */
    int parameter_index;
};

/* Creates an open graph, whose first nodes are its inputs. Returns NULL if memory is lacking. */
jet_graph *jet_graph_create(int input_count);
/* Closes the graph. */
void jet_graph_end_recording(jet_graph *graph);
/* Sets the name of the outputs in texts of refusals. The name must be static. */
void jet_graph_set_output_name(jet_graph *graph, const char *name);
/* Set and return the number of components of the vectors that the inputs come in, as places of bodies do; 0:
 * unknown. */
void jet_graph_set_axes(jet_graph *graph, int axes);
int jet_graph_axes(const jet_graph *graph);
/* Begins the operations that the library records itself, such as the energy of a Lagrangian, after those of the user.
 * Texts of refusals call them name_for_messages, which must be static. */
void jet_graph_begin_library_nodes(jet_graph *graph, const char *name_for_messages);
/* Returns the name of the operations that the library records itself, and in *first_node_index the index of the first
 * of them. Returns NULL if there are none. */
const char *jet_graph_library_nodes_name(const jet_graph *graph, int *first_node_index);
void jet_graph_free(jet_graph *graph);

/* Returns the node that equals `wanted`, and records it if there is none. The graph then owns the terms of `wanted`.
 * Returns NULL if memory is lacking. */
struct jet_node *jet_graph_find_or_record(jet_graph *graph, struct jet_node wanted, bool *is_new);
/* Does the same as jet_graph_find_or_record, but returns the node as a jet, which is poison if memory is lacking. */
jet jet_graph_record_node(jet_graph *graph, struct jet_node wanted);
jet jet_graph_record_constant(jet_graph *graph, double value);
/* Records the parameter with this index, a number that may be replaced before later sweeps (jet_parameter). The result
 * is poison with the status TVI_EINVAL if the parameter was recorded with another value before. */
jet jet_graph_record_parameter(jet_graph *graph, int parameter_index, double value);
/* Returns 1 + the largest index of a parameter, or 0 if the graph has no parameters. */
int jet_graph_parameter_count(const jet_graph *graph);
/* Notes that an operation could not be recorded, for want of memory. All outputs are refused from then on. */
void jet_graph_mark_out_of_memory(jet_graph *graph);

int jet_graph_input_count(const jet_graph *graph);
jet jet_graph_input(const jet_graph *graph, int i);
int jet_graph_node_count(const jet_graph *graph);
/* Returns the number of times that a search for a node in the hash table met a different node. */
long jet_graph_hash_collision_count(const jet_graph *graph);
struct jet_node *jet_graph_node_at(const jet_graph *graph, int index);

static inline jet jet_from_node(struct jet_node *node) { return (jet){0, node}; }

/* Sets *graph to the open graph to which all nodes among x belong, or to NULL if all x are numbers. Returns poison if
 * no operation on x can be recorded, since one of them is poison, or two belong to different graphs. Otherwise it
 * returns the number 0, a jet without a node. */
jet jet_find_common_graph_or_poison(int count, const jet x[], jet_graph **graph);
/* Returns a poison jet, which belongs to no graph and holds the reason. All jets made from it are the same poison.
 * Its node has the status (tvi_status) as its index. */
jet jet_make_poison(jet_reason reason);
/* Returns the poison of an operation whose operand is outside its domain. The member `number` of this jet is the
 * operand. */
jet jet_make_domain_poison(jet_op op, double operand);
/* Returns the poison that stands for the component x[index] beyond the end of a vector x that the user's function gets.
 * The reason is JET_BEYOND_Q, JET_BEYOND_V or JET_BEYOND_P. The member `number` of this jet is the index. */
jet jet_make_poison_beyond_end(jet_reason reason, int index);
bool jet_is_poison(jet x);
/* Returns the reason of a poison jet. A jet that looks like poison and was made by no operation, such as one that was
 * never set, has the reason JET_UNSET. */
jet_reason jet_poison_reason(jet x);
/* Returns the status of a reason. */
tvi_status jet_reason_status(jet_reason reason);
/* Tells whether x is the number 0, which needs no node. */
static inline bool jet_is_zero(jet x) { return !x.node && x.number == 0; }
/* Returns the poison with which outputs are filled before the user's function runs, for outputs that it does not
 * set. */
static inline jet jet_make_unset_poison(void) { return jet_make_poison(JET_UNSET); }
/* Checks that all outputs are nodes of the open graph, and records the finite numbers among them as constant nodes.
 * Refuses any other jet, with a text (jet_last_refusal_text). */
tvi_status jet_graph_check_outputs(jet_graph *graph, int output_count, jet output[]);

/* Records one of the operations from OP_SQRT on, except OP_POW. b is ignored if the operation has one operand. */
jet jet_record_operation(jet_op op, jet a, jet b);

/* Records the sum of coefficient[i] x[i]. Terms with equal nodes are merged, and numbers are added up. */
jet jet_record_linear_combination(int count, const double coefficient[], const jet x[]);
/* Records gradient[i] = d output / d input_i, i < input_count, and by_parameter[i] = d output / d parameter i, i <
 * parameter_count, into the open graph of the output, by reverse accumulation. The gradients are poison if the output
 * is no jet of the graph. Returns false if memory is lacking. */
bool jet_record_gradient_by(jet_graph *graph, jet output, int input_count, jet gradient[], int parameter_count,
                            jet by_parameter[]);
/* Records the gradient by the inputs alone. */
bool jet_record_gradient(jet_graph *graph, jet output, int input_count, jet gradient[]);

/* Records outputs of the closed graph `source` once more into the open graph `target`. The jets `input`, which are all
 * different, take the place of the inputs. value[i] is output i. derivative[i] is its derivative by forward
 * accumulation, as the inputs move along `direction` and the parameters along `parameter_direction`; NULL: the
 * parameters do not move. Results are poison if one of their inputs is. Returns false if memory is lacking. */
bool jet_record_forward_derivatives(const jet_graph *source, jet_graph *target, const jet input[],
                                    const jet direction[], const jet parameter_direction[], int output_count,
                                    const jet output[], jet value[], jet derivative[]);
/* Records outputs once more, without derivatives. */
bool jet_record_again(const jet_graph *source, jet_graph *target, const jet input[], int output_count,
                      const jet output[], jet value[]);

#endif
