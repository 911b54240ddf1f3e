/* curve.h - prolongation: the Taylor curve at a centre, and its Jacobians with respect to the centre data.
 *
 * Time is scaled: t = centre + tau s, and
 *     q(t) = sum_k Q_k s^k,        p(t) = sum_k U_k s^k / kappa,
 * so that all Q_k are of one size. For a separable system kappa = tau/m, U_k = (k+1) Q_{k+1} and all is in the unit of
 * q (kappa has the sign of tau); for the others kappa = 1. The centre data z (2n numbers) are (q, tau v) for a
 * Lagrangian, else (q, kappa p). */
#ifndef TVI_SRC_GENERATING_CURVE_H
#define TVI_SRC_GENERATING_CURVE_H

#include "algebra/linear.h"
#include "compiled/code.h"
#include "generating/advance.h"
#include "method/stepper.h"

/* How the Jacobians are had: not at all; as matrices, by tangents in all 2n directions; or only their products with
 * vectors, each by one adjoint or one tangent sweep, whose cost is a small multiple of the expansion's whatever n is.
 */
typedef enum { TVI_NO_JACOBIANS, TVI_JACOBIAN_MATRICES, TVI_JACOBIAN_PRODUCTS } tvi_jacobians;

/* A combination of the curve's coefficients, sum_k weight_k Q_k or sum_k weight_k U_k. Made once for a method. */
typedef struct {
    bool of_momentum;
    double *weight; /* [top + 1] */
} tvi_combination;

typedef struct {
    const tvi_system *system;
    tvi_jacobians jacobians;
    int n, top; /* the highest order of Q that is computed */
    double centre, tau;
    double *kappa;          /* [n] */
    double *x;              /* block of the field's series, orders 0 .. top */
    double *dx;             /* the same for CURVE_LANES directions; products: for one */
    double *bar;            /* products: the same for adjoints */
    double *dQ, *dU;        /* matrices: [top + 1][n][2n] dQ_k/dz and dU_k/dz; dU NULL for a separable system */
    double *dz;             /* [2n] the direction of pushes */
    double *by_U;           /* [2n] a pull's part by dU */
    int q_degree, p_degree; /* of the tail, */
    tvi_combination q_sizes, u_sizes;
    double *movement, *momentum; /* [n] and what these sums are */
    tvi_factor slope;            /* not separable: L_vv or H_pp at the centre, see tvi_curve_factor_slope */
    double *columns;             /* scratch of the slope: its directions, and right sides */
} tvi_curve;

void tvi_curve_take(tvi_curve *curve, tvi_arena *arena, const tvi_system *system, int top, tvi_jacobians jacobians);
static inline bool tvi_curve_has_products(const tvi_curve *curve) { return curve->jacobians == TVI_JACOBIAN_PRODUCTS; }
void tvi_curve_prepare(tvi_curve *curve); /* once, when the memory is there */

tvi_combination tvi_combination_take(const tvi_curve *curve, tvi_arena *arena);
/* From weights of Q, or weights of U (which a separable system turns into weights of Q). */
void tvi_combination_set(tvi_combination *combination, const tvi_curve *curve, bool of_momentum, const double weight[]);

/* weight_k = a at^k + b from^k for k <= degree, 0 above. */
void tvi_combination_set_powers(tvi_combination *combination, const tvi_curve *curve, bool of_momentum, int degree,
                                double a, double at, double b, double from);

/* Sets tau and z. */
void tvi_curve_set(tvi_curve *curve, double tau, const double z[]);

/* Expands from z. TVI_EDOMAIN, TVI_ENONFINITE, TVI_ESINGULAR (L_vv). */
TVI_NODISCARD tvi_status tvi_curve_expand(tvi_curve *curve, double centre);

/* Factors L_vv or H_pp at the centre of the curve last expanded; a Lagrangian's expansion has done so.
 * TVI_ESINGULAR. */
TVI_NODISCARD tvi_status tvi_curve_factor_slope(tvi_curve *curve);

/* The Jacobian matrices of the curve last expanded. */
void tvi_curve_differentiate(tvi_curve *curve);

/* What a stepper runs whose curves have such Jacobians. */
tvi_uses tvi_curve_uses(const tvi_system *system, const tvi_options *options, int top, tvi_jacobians jacobians);

/* tvi_uses.emit_loops: tvi_curve_code (advance.h), without and with tangents. */
void tvi_curve_emit_series(jet_text *text, const tvi_system *system, const tvi_options *options, const char *name);
void tvi_curve_emit_matrices(jet_text *text, const tvi_system *system, const tvi_options *options, const char *name);

/* ---- The block of the series ------------------------------------------------------------------------------------- */

enum { TVI_CURVE_LANES = 8 }; /* directions of one tangent sweep: few enough to stay in the cache */

static inline size_t tvi_curve_slots(const tvi_curve *curve) { return (size_t)curve->system->field_series->slots; }

static inline int tvi_curve_lanes_of(const tvi_system *system)
{
    return 2 * system->n < TVI_CURVE_LANES ? 2 * system->n : TVI_CURVE_LANES;
}

static inline size_t tvi_curve_lanes(const tvi_curve *curve) { return (size_t)tvi_curve_lanes_of(curve->system); }

/* The generated code that has all its orders; NULL: none has. */
static inline const tvi_curve_code *tvi_curve_code_of(const tvi_curve *curve)
{
    const tvi_curve_code *code = curve->system->code ? curve->system->code->curve : NULL;
    return code && code->top == curve->top ? code : NULL;
}

/* Order k: q, then velocity or momentum of a Lagrangian or a Hamiltonian. */
static inline double *tvi_curve_input(const tvi_curve *curve, int k)
{
    return curve->x + (size_t)k * tvi_curve_slots(curve);
}

/* Output i of the field at order k. */
static inline double tvi_curve_field(const tvi_curve *curve, int k, int i)
{
    return tvi_curve_input(curve, k)[curve->system->field_series->output[i]];
}

/* ---- Sums -------------------------------------------------------------------------------------------------------- */

/* U_k = kappa P_k of component i. */
static inline double tvi_curve_U(const tvi_curve *curve, int k, int i)
{
    switch (curve->system->form) {
    case TVI_SEPARABLE: return k < curve->top ? (k + 1) * tvi_curve_input(curve, k + 1)[i] : 0;
    case TVI_LAGRANGIAN: return tvi_curve_field(curve, k, curve->n + i);
    default: return (tvi_curve_input(curve, k) + curve->n)[i];
    }
}

/* P_k of all orders k, [degree + 1][n]. */
void tvi_curve_momenta(const tvi_curve *curve, int degree, double out[]);
/* Q_k where it stands. */
static inline const double *tvi_curve_Q(const tvi_curve *curve, int k) { return tvi_curve_input(curve, k); }

/* out[n], or matrix[n][2n], of a combination and of its Jacobian; the small terms first. */
void tvi_curve_sum(const tvi_curve *curve, const tvi_combination *combination, double out[]);
/* out[n] = sum_k weight_k |Q_k| or weight_k |U_k|; weight [top + 1]. */
void tvi_curve_sum_sizes(const tvi_curve *curve, bool of_momentum, const double weight[], double out[]);
void tvi_curve_sum_jacobian(const tvi_curve *curve, const tvi_combination *combination, double matrix[]);
/* Sets the direction dz of the pushes that follow; then out[n] = Jacobian of the combination times dz. */
void tvi_curve_aim(tvi_curve *curve, const double dz[]);
void tvi_curve_push(const tvi_curve *curve, const tvi_combination *combination, double out[]);

/* out[2n] = sum_k (dQ_k/dz)^T seed_Q[k] + (dU_k/dz)^T seed_U[k]; seeds [top + 1][n]. seed_U may be NULL, and is
 * not read for a separable system, whose U_k = (k+1) Q_{k+1}. */
void tvi_curve_pull(tvi_curve *curve, const double seed_Q[], const double seed_U[], double out[]);

/* Once: Q and P are summed to these degrees. Then, of each curve, the sizes of movement and momentum, and of these
 * tvi_stats.tail, see tail.h; 0 where p' has one term only. */
void tvi_curve_prepare_tail(tvi_curve *curve, int q_degree, int p_degree);
void tvi_curve_measure(const tvi_curve *curve);
double tvi_curve_tail(const tvi_curve *curve);

/* More than the terms left out change the energy by, after the tail, of a step that is the curve; INFINITY where they
 * are not known. */
double tvi_curve_change(const tvi_curve *curve);

/* ---- Steps that adapt (reach.c) ---------------------------------------------------------------------------------- */

/* The largest s at which the curve, of Q and P to these degrees, serves a tolerance; INFINITY where it is exact. */
double tvi_curve_reach(const tvi_curve *curve, int q_degree, int p_degree, double tolerance);

/* The same curve in s / factor: tau and its coefficients, of q and p; and in the same sweep its rise from 0 to 1, of q
 * and kappa p, [n], and what tvi_curve_measure measures. */
void tvi_curve_end_at(tvi_curve *curve, double factor, double q[], double u[]);

#endif
