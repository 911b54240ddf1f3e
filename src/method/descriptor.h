/* descriptor.h - what a method is, as data: nothing else in the library asks which method it is. A file of its own
 * defines each, and list.h names it. */
#ifndef TVI_SRC_METHOD_DESCRIPTOR_H
#define TVI_SRC_METHOD_DESCRIPTOR_H

#include "method/stepper.h"

/* The forms of systems that a method serves, and what it says to the others. */
enum {
    TVI_SERVES_SEPARABLE = 1,
    TVI_SERVES_LAGRANGIAN = 2,
    TVI_SERVES_REGULAR = 4,
    TVI_SERVES_DEGENERATE = 8,
    TVI_SERVES_DRIVEN = 16
};
typedef struct {
    int forms;
    const char *refusal; /* static text; NULL where all forms are served */
} tvi_service;

/* Every system; those with an L; those with an H. (method.c) */
extern const tvi_service tvi_serves_all, tvi_serves_type1, tvi_serves_hamilton;

/* A method with one node rule. The order of degree N is slope N + offset, rounded up to an even number where the method
 * is symmetric or composed. slope = offset = 0: there is no such method. */
typedef struct {
    const char *name; /* for tvi_options_named; NULL: none */
    int slope, offset;
} tvi_node_rule;

typedef enum {
    TVI_NO_QUADRATURE,
    TVI_ANY_QUADRATURE,
    TVI_GAUSS_OF_DEGREE /* the degree is the number of its nodes */
} tvi_quadrature_use;

/* Where the step's ends lie in the scaled time of a curve, and tau as a multiple of h. */
typedef struct {
    double from, to, tau;
} tvi_span;

typedef enum {
    TVI_ACTION_LAGRANGE, /* h sum b_i L(q_i, v_i, t_i)                 */
    TVI_ACTION_HAMILTON  /* h sum b_i [p_i . q'_i - H(q_i, p_i, t_i)]  */
} tvi_action_kind;

/* Solves a generating function's equations for the corrections of the curve's ends: generating/closure.h. */
struct tvi_closure;
typedef tvi_status tvi_close_fn(struct tvi_closure *closure);

/* The corrections of both ends from the solution (x, y) of [J1; J2]^T (x, y) = D_z (generating/closure.h), J1 the
 * Jacobian of the mean of the ends' coordinates: the coordinates' are these parts of kappa y, the momenta's these of x
 * and y. */
typedef struct {
    bool has_momenta; /* J2 is that of the mean of the scaled momenta, else of the rise of the coordinates */
    double from_q, rise_q;
    double from_p[2], rise_p[2];
} tvi_mean_closing;

/* A Taylor curve, and what a generating function adds to it. */
typedef struct {
    tvi_span span;
    tvi_action_kind action;
    bool has_top_momentum; /* p is used to degree N, as q is, else to N - 1 */
    tvi_close_fn *close;   /* NULL: nothing is added */
    tvi_mean_closing mean; /* of tvi_close_mean */
    bool is_rough;         /* the first pass gains by much the most, and tells little of the others */
} tvi_expanded;

typedef struct tvi_descriptor tvi_descriptor;
struct tvi_descriptor {
    tvi_method method;
    tvi_expansion expansion;
    const char *title;                            /* for messages */
    tvi_node_rule nodes[TVI_NODES_TRUNCATED + 1]; /* by tvi_nodes */
    int least_degree, most_degree;
    const tvi_service *serves;
    const tvi_descriptor *adjoint; /* (Phi_-h)^-1, but for the quadrature, which is mirrored; itself: symmetric; NULL:
                                      no generating function, and nothing to compose it with */
    tvi_quadrature_use quadrature;
    bool pairs_momenta; /* with coordinates: its tangent map is that of the paired lift (docs/method.md section 10) */
    const tvi_stepper *stepper;
    const tvi_stepper *predictor; /* with TVI_PREDICT_ONLY; NULL: the stepper itself */
    tvi_expanded curve;           /* of tvi_stepper_curve */
};

static inline bool tvi_is_symmetric(const tvi_descriptor *descriptor) { return descriptor->adjoint == descriptor; }

/* Options under a name of their own. */
typedef struct {
    const char *name;
    tvi_options options;
} tvi_preset;

#endif
