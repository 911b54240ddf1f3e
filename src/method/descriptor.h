/* descriptor.h - Declares the descriptor of a method, which says as data what the method is. Each method is defined
 * in a file of its own, and listed in list.h. No other code depends on which method it runs. */
#ifndef TVI_SRC_METHOD_DESCRIPTOR_H
#define TVI_SRC_METHOD_DESCRIPTOR_H

#include "method/closing.h"
#include "method/stepper.h"

/* The forms of systems that a method can integrate. */
enum {
    TVI_SERVES_SEPARABLE = 1,
    TVI_SERVES_LAGRANGIAN = 2,
    TVI_SERVES_REGULAR = 4,
    TVI_SERVES_DEGENERATE = 8,
    TVI_SERVES_DRIVEN = 16
};
/* The forms that a method can integrate, as a sum of the values above, and the text that refuses the others. */
typedef struct {
    int forms;
    const char *refusal; /* NULL: no form is refused. */
} tvi_served_forms;

/* The forms for methods that integrate every system; systems with a Lagrangian; systems with a Hamiltonian
 * (method.c). */
extern const tvi_served_forms tvi_serves_all, tvi_serves_type1, tvi_serves_hamilton;

/* A node rule of a method. At degree N the order is slope N + offset, rounded up to an even number if the method is
 * symmetric or composed. slope = offset = 0: the method does not have this rule. */
typedef struct {
    const char *name; /* The name for tvi_options_named; NULL: it has none. */
    int slope, offset;
} tvi_node_rule;

/* The quadratures with which a method works. */
typedef enum {
    TVI_NO_QUADRATURE,
    TVI_ANY_QUADRATURE,
    TVI_GAUSS_OF_DEGREE /* Gauss, with as many nodes as the degree. */
} tvi_quadrature_use;

/* The discrete action of a curve, with the nodes i and weights b_i of the quadrature. */
typedef enum {
    TVI_ACTION_LAGRANGE, /* h sum b_i L(q_i, v_i, t_i)                 */
    TVI_ACTION_HAMILTON  /* h sum b_i [p_i . q'_i - H(q_i, p_i, t_i)]  */
} tvi_action_kind;

/* The definition of a Taylor curve, and of the generating function that corrects it (docs/method.md, section 4). */
typedef struct {
    tvi_scaled_span span;
    tvi_action_kind action;
    /* p is used up to degree N, as q is; otherwise only up to N - 1. */
    bool has_top_momentum;
    tvi_close_fn *close;   /* Computes the corrections; NULL: the curve is not corrected. */
    tvi_mean_closing mean; /* Factors of the corrections, for tvi_close_by_mean_of_ends. */
    /* The first pass reduces the residual much more than the later ones, and does not show how fast they converge. */
    bool is_rough;
} tvi_curve_definition;

typedef struct tvi_descriptor tvi_descriptor;
struct tvi_descriptor {
    tvi_method method;
    tvi_expansion expansion;
    const char *title;                            /* The title in messages. */
    tvi_node_rule nodes[TVI_NODES_TRUNCATED + 1]; /* The node rules, indexed by tvi_nodes. */
    int least_degree, most_degree;
    const tvi_served_forms *serves;
    /* The adjoint (Phi_-h)^-1, with the mirrored quadrature. A symmetric method is its own adjoint. NULL: there is
     * none, and no composition. */
    const tvi_descriptor *adjoint;
    tvi_quadrature_use quadrature;
    /* Momenta are conjugate to coordinates: the tangent map is that of the paired lift (docs/method.md, section 10). */
    bool pairs_momenta;
    const tvi_stepper *stepper;
    const tvi_stepper *predictor; /* The stepper for TVI_PREDICT_ONLY; NULL: `stepper` itself. */
    tvi_curve_definition curve;   /* The curve, if the stepper is tvi_stepper_curve. */
};

static inline bool tvi_is_method_symmetric(const tvi_descriptor *descriptor)
{
    return descriptor->adjoint == descriptor;
}

/* Options that have a name of their own. */
typedef struct {
    const char *name;
    tvi_options options;
} tvi_preset;

#endif
