/* descriptor.h - Declares what a method is, as data. Each method is defined in a file of its own, and listed in list.h;
 * no other code asks which method it runs. */
#ifndef TVI_SRC_METHOD_DESCRIPTOR_H
#define TVI_SRC_METHOD_DESCRIPTOR_H

#include "method/closing.h"
#include "method/stepper.h"

/* The forms of systems that a method serves. */
enum {
    TVI_SERVES_SEPARABLE = 1,
    TVI_SERVES_LAGRANGIAN = 2,
    TVI_SERVES_REGULAR = 4,
    TVI_SERVES_DEGENERATE = 8,
    TVI_SERVES_DRIVEN = 16
};
/* The forms that a method serves, and the text that refuses the others. */
typedef struct {
    int forms;
    const char *refusal; /* NULL if all forms are served */
} tvi_service;

/* Serves every system; systems with an L; systems with an H (method.c). */
extern const tvi_service tvi_serves_all, tvi_serves_type1, tvi_serves_hamilton;

/* One node rule of a method. The order of degree N is slope N + offset, rounded up to an even number if the method is
 * symmetric or composed. slope = offset = 0: the method does not have this rule. */
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

/* A Taylor curve, and the generating function that corrects it. */
typedef struct {
    tvi_span span;
    tvi_action_kind action;
    /* p is used up to degree N, as q is; otherwise up to N - 1. */
    bool has_top_momentum;
    tvi_close_fn *close;   /* NULL: the curve is not corrected */
    tvi_mean_closing mean; /* of tvi_close_mean */
    /* The first pass gains much more than the others, and tells little about them. */
    bool is_rough;
} tvi_expanded;

typedef struct tvi_descriptor tvi_descriptor;
struct tvi_descriptor {
    tvi_method method;
    tvi_expansion expansion;
    const char *title;                            /* for messages */
    tvi_node_rule nodes[TVI_NODES_TRUNCATED + 1]; /* by tvi_nodes */
    int least_degree, most_degree;
    const tvi_service *serves;
    /* The adjoint (Phi_-h)^-1, with the mirrored quadrature. The method itself: it is symmetric. NULL: there is none,
     * and no composition. */
    const tvi_descriptor *adjoint;
    tvi_quadrature_use quadrature;
    /* Momenta are paired with coordinates: the tangent map is that of the paired lift (docs/method.md section 10). */
    bool pairs_momenta;
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
