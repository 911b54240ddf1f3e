/* descriptor.h - what a method is, as data: nothing else in the library asks which method it is. A file of its own
 * defines each, and list.h names it. */
#ifndef TVI_SRC_METHOD_DESCRIPTOR_H
#define TVI_SRC_METHOD_DESCRIPTOR_H

#include "method/closing.h"
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

typedef enum {
    TVI_ACTION_LAGRANGE, /* h sum b_i L(q_i, v_i, t_i)                 */
    TVI_ACTION_HAMILTON  /* h sum b_i [p_i . q'_i - H(q_i, p_i, t_i)]  */
} tvi_action_kind;

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
