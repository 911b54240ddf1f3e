/* descriptor.h - Declares the descriptor of a method, which says as data what the method is. All methods are listed
 * in list.h. No other code depends on which method it runs. */
#ifndef TVI_SRC_METHOD_DESCRIPTOR_H
#define TVI_SRC_METHOD_DESCRIPTOR_H

#include "method/stepper.h"
#include "system/system.h"

/* ---- Taylor curves: ends, equations of the generating function, factors (docs/method.md section 4) --------------- */

/* The ends of a step in the scaled time s, in which a Taylor curve is a polynomial: s- (start_s) and s+ (end_s). One
 * unit of s is the time tau_over_h h. */
typedef struct {
    double start_s, end_s, tau_over_h;
} tvi_step_span;

/* Sums of the curve's coefficients that give q, or the scaled momentum u = kappa p, at the ends of the step: x- at s-
 * (START) and x+ at s+ (END). STEP is the difference x+ - x-, and MEAN is (s+ x- - s- x+)/(s+ - s-), which has no term
 * of order 1; it is the mean of the ends if the curve is expanded at the midpoint. */
typedef enum {
    TVI_NO_SUM,
    TVI_Q_START,
    TVI_Q_END,
    TVI_Q_STEP,
    TVI_Q_MEAN,
    TVI_U_START,
    TVI_U_END,
    TVI_U_STEP,
    TVI_U_MEAN,
    TVI_END_SUMS
} tvi_end_sum;

/* The linear equations A^T x = D_z for the corrections of the ends, with D_z the gradient of the discrete action by the
 * state z at the curve's centre, in defect form. If lower_sum is not TVI_NO_SUM, the 2n x 2n matrix A has the n rows of
 * the Jacobian by z of upper_sum above the n rows of the Jacobian of lower_sum, and (x, y) is the solution. Otherwise A
 * is n x n: either the first n columns of the Jacobian J of upper_sum, its derivatives by the coordinates in z, or its
 * last n columns. The solution takes the place of this half of (x, y), and the other half of (x, y) is that half of
 * D_z - J^T x. */
typedef struct {
    tvi_end_sum upper_sum;        /* TVI_NO_SUM: there are no equations, and the ends are not corrected. */
    tvi_end_sum lower_sum;        /* TVI_NO_SUM: A is n x n. */
    bool takes_last_columns_of_J; /* Tells which half of J an n x n matrix A is. */
} tvi_end_equations;

/* The factors by which the solution (x, y) of the equations enters the corrections of both ends. The corrections of the
 * start are
 *     start_correction_q = start_q_correction_factor kappa y,
 *     start_correction_p = start_p_correction_factor[0] x + start_p_correction_factor[1] y,
 * and those of the increments are
 *     increment_correction_q = increment_q_correction_factor kappa y,
 *     increment_correction_p = increment_p_correction_factor[0] x + increment_p_correction_factor[1] y,
 * with kappa = 1 unless the system is separable. */
typedef struct {
    double start_q_correction_factor, increment_q_correction_factor;
    double start_p_correction_factor[2], increment_p_correction_factor[2];
} tvi_curve_end_correction_factors;

/* ---- Methods ----------------------------------------------------------------------------------------------------- */

/* The forms of systems, as bits: separable, with a Lagrangian, with a Hamiltonian whose H_pp is regular, with one
 * whose H_pp is singular everywhere, driven, and a field of rates. */
enum {
    TVI_SUPPORTS_SEPARABLE = 1,
    TVI_SUPPORTS_LAGRANGIAN = 2,
    TVI_SUPPORTS_REGULAR = 4,
    TVI_SUPPORTS_DEGENERATE = 8,
    TVI_SUPPORTS_DRIVEN = 16,
    TVI_SUPPORTS_FIELD = 32
};
/* The forms of systems that a method can integrate, as a sum of the values above, and the error message for other
 * forms. */
typedef struct {
    int form_mask;
    const char *refusal_text; /* The error message for a form that is not in form_mask; NULL: no form is refused. */
} tvi_supported_forms;

/* All forms (tvi_supports_all), all but fields of rates (tvi_supports_all_but_field), the forms of methods that need a
 * Lagrangian (tvi_supports_type1), and the forms of methods that need a Hamiltonian (tvi_supports_hamilton). */
extern const tvi_supported_forms tvi_supports_all, tvi_supports_all_but_field, tvi_supports_type1,
    tvi_supports_hamilton;

/* A node rule of a method. At degree N the order is order_per_degree N + order_offset, rounded up to an even number if
 * the method is symmetric or composed. If both numbers are 0, the method does not have this rule. */
typedef struct {
    const char *name; /* The name for tvi_options_named; NULL: the rule has no name. */
    int order_per_degree, order_offset;
} tvi_order_with_node_rule;

/* The choice of a method's quadrature. */
typedef enum {
    TVI_NO_QUADRATURE,     /* The method uses no quadrature. */
    TVI_CHOSEN_QUADRATURE, /* The user chooses the quadrature. */
    TVI_GAUSS_OF_DEGREE    /* The quadrature is Gauss, with as many nodes as the degree. */
} tvi_quadrature_use;

/* The discrete action of a curve, with the weights b_i of the quadrature and the values q_i, v_i, p_i, t_i at its
 * nodes. */
typedef enum {
    TVI_ACTION_LAGRANGE, /* h sum b_i L(q_i, v_i, t_i)                 */
    TVI_ACTION_HAMILTON  /* h sum b_i [p_i . q'_i - H(q_i, p_i, t_i)]  */
} tvi_action_kind;

/* The definition of a Taylor curve, and of the generating function that corrects it (docs/method.md, section 4). */
typedef struct {
    tvi_step_span step_span;
    tvi_action_kind action;
    /* true: the polynomial of p has the degree N, as that of q; false: it has the degree N - 1. */
    bool uses_highest_momentum_term;
    tvi_end_equations equations; /* The equations whose solution (x, y) gives the corrections of the ends. */
    tvi_curve_end_correction_factors end_correction_factors; /* The factors of x and y in the corrections. */
    /* A step needs one more pass of Newton's method than the first two corrections suggest. The first pass reduces the
     * residual much more than later passes do, and does not show how fast the later passes converge. */
    bool needs_extra_newton_pass;
} tvi_curve_definition;

typedef struct tvi_descriptor tvi_descriptor;
struct tvi_descriptor {
    tvi_method method;
    tvi_expansion expansion;
    const char *title;                                       /* The title of the method in error messages. */
    tvi_order_with_node_rule nodes[TVI_NODES_TRUNCATED + 1]; /* The node rules, indexed by tvi_nodes. */
    int least_degree, most_degree;
    const tvi_supported_forms *supports;
    /* The adjoint (Phi_-h)^-1, with the mirrored quadrature. A symmetric method is its own adjoint. NULL: there is no
     * adjoint, and the method cannot be composed. */
    const tvi_descriptor *adjoint;
    tvi_quadrature_use quadrature;
    /* The equations of the method need momenta that are conjugate to the coordinates. The tangent map is therefore
     * computed by the lift with conjugate momenta (TVI_LIFT_PAIRED; docs/method.md, section 10). */
    bool needs_conjugate_momenta;
    const tvi_stepper *stepper;     /* for the base instruction set */
    const tvi_stepper *constrained; /* the stepper for systems with constraints; NULL: they are refused */
    /* The degrees for which the stepper is compiled for AVX-512, where a processor has it; for others AVX2 is taken.
     * Not given: all. */
    struct {
        int least, most;
    } avx512_degrees;
    const tvi_stepper *predictor; /* The stepper for TVI_PREDICT_ONLY; NULL: `stepper` itself. */
    tvi_curve_definition curve;   /* The curve, if the method expands Taylor curves. */
};

static inline bool tvi_is_method_symmetric(const tvi_descriptor *descriptor)
{
    return descriptor->adjoint == descriptor;
}

/* Options that users can request by a name (tvi_options_named). */
typedef struct {
    const char *name;
    tvi_options options;
} tvi_preset;

#endif
