/* curve.h - declares a Taylor curve about a centre, the sums of its coefficients, and their Jacobians by the state z at
 * the centre. Steppers and solvers call these functions (docs/method.md section 2).
 *
 * Time is scaled: t = centre + tau s, and
 *     q(t) = sum_k Q_k s^k,        p(t) = sum_k P_k s^k,        U_k = kappa P_k,
 * so that all Q_k are of one size. For a separable system kappa = tau/m, U_k = (k+1) Q_{k+1} and all coefficients are
 * in the unit of q (kappa has the sign of tau); for other systems kappa = 1. The state z (2n numbers) consists of the
 * coordinates q at the centre, and of tau v for a Lagrangian, otherwise of kappa p. */
#ifndef TVI_SRC_GENERATING_CURVE_H
#define TVI_SRC_GENERATING_CURVE_H

#include "algebra/linear.h"
#include "algebra/sizes.h"
#include "method/stepper.h"
#include "system/system.h"
#include "vector.h"

#include <float.h>
#include <math.h>

/* [directions] One sweep of tangents has at most this many directions. A block of more would not fit into the cache. */
#define CURVE_TANGENT_DIRECTIONS 8 /* found: make performance ONE=cost */
/* [1] An old Jacobian leaves at most this relative error in the state, and so does a last correction that is computed
 * from products of the Jacobian with vectors. The roundoff of a step is much larger. */
#define CURVE_NEGLIGIBLE_ERROR (DBL_EPSILON / 16) /* found: make check-generating */

/* How the Jacobians of a curve are used: not at all; as matrices, from tangents in all 2n directions; or only in
 * products with vectors, each by one adjoint or one tangent sweep, whose cost is a small multiple of the expansion's
 * for any n. */
typedef enum { TVI_NO_JACOBIANS, TVI_JACOBIAN_MATRICES, TVI_JACOBIAN_PRODUCTS } tvi_jacobians;

/* Adds sum_r weight[r] row[r * stride + i] to out[i], i < components, or the sum of the magnitudes, from the last row
 * to the first, so that the small terms of a series come first: as two sums, which the processor adds at the same time.
 * The sum of a component does not depend on how many components there are. */
JET_INLINE void add_weighted(size_t count, const double weight[], size_t stride, size_t components, const double row[],
                             double out[], const bool of_sizes)
{
    enum { WIDE = sizeof(jet_widest) / sizeof(double) };
    size_t i = 0;
    for (; i + WIDE <= components; i += WIDE) {
        jet_widest sum[2] = {{0}, {0}};
        for (size_t r = count; r-- > 0;) {
            const jet_widest x = *(const jet_widest *)(row + r * stride + i);
            if (of_sizes) sum[(count - 1 - r) % 2] += weight[r] * JET_ABS(jet_widest, x);
            else sum[(count - 1 - r) % 2] += weight[r] * x;
        }
        *(jet_widest *)(out + i) += sum[0] + sum[1];
    }
    for (; i < components; i++) {
        double sum[2] = {0, 0};
        for (size_t r = count; r-- > 0;) {
            const double x = row[r * stride + i];
            sum[(count - 1 - r) % 2] += weight[r] * (of_sizes ? fabs(x) : x);
        }
        out[i] += sum[0] + sum[1];
    }
}
static inline void tvi_add_weighted_rows(size_t count, const double weight[], size_t stride, size_t components,
                                         const double row[], double out[])
{
    add_weighted(count, weight, stride, components, row, out, false);
}

/* A weighted sum of the coefficients of one series: sum_k weight_k Q_k, or sum_k weight_k U_k. With weight_k = s^k it
 * is q or u at s. */
typedef struct {
    bool is_of_U;   /* The sum is over U_k. In a separable system it is never set: U_k is (k+1) Q_{k+1} there. */
    double *weight; /* [highest_order + 1] The weights. */
} tvi_series_sum;

typedef struct {
    const tvi_system *system;
    int n, highest_order;      /* the number of coordinates, and the highest order of Q that is computed */
    int q_degree, p_degree;    /* the degrees to which q and p are summed */
    double tau;                /* the unit of time */
    double *kappa;             /* [n] the factor that scales the momentum */
    double *series;            /* the block of the field's series, orders 0 .. highest_order */
    double *one_over, *log_of; /* [highest_order + 2] 1 / k and log k */
    /* The Jacobians by z: those of the curve for which they were last computed, and NULL where `use` needs none. */
    struct {
        tvi_jacobians use;
        double *dQ_dz, *dU_dz; /* [highest_order + 1][n][2n] dQ_k/dz and dU_k/dz; dU_dz is NULL if separable */
        double *tangents;      /* the tangents of all slots in up to CURVE_TANGENT_DIRECTIONS directions of z */
        int cleared_lanes;     /* the number of lanes with which the tangents were last cleared; 0: never */
        double *adjoints;      /* the adjoints of all slots in all orders; only for products */
        double *dz;            /* [2n] the direction of tvi_curve_set_dz */
        double *U_product;     /* [2n] scratch: sum_k (dU_k/dz)^T seed_k */
        double *of_sum;        /* [n][2n] scratch: the Jacobian of a sum */
    } jacobians;
    /* The sizes of the coefficients, valid after tvi_curve_compute_sizes or tvi_curve_rescale. */
    struct {
        tvi_series_sum q_sum, u_sum; /* the sums that give dq and u, valid after tvi_curve_set_degrees */
        double *dq, *u;              /* [n] sum_k k |Q_k|, and |U_0| + sum_k k |U_k| */
        double *share, *ratio;       /* [n] scratch of the tail: shares of the motion, and ratios of the last term */
    } sizes;
    /* The matrix L_vv, or H_pp, and solving with it: unused if separable, valid after tvi_curve_factor_L_vv. */
    struct {
        tvi_lu_factor L_vv;           /* L_vv or H_pp at the centre */
        double *dslots_dv;            /* [slots][n] the derivatives of all slots by v, or p, at the centre */
        double *right_sides, *column; /* scratch for solving with L_vv: [n][lanes], and one column [n] */
    } centre;
} tvi_curve;

/* ---- The coefficients -------------------------------------------------------------------------------------------- */

/* Returns the distance, in numbers, from one order of the series' block to the next: its slots. */
static inline size_t curve_stride(const tvi_curve *curve) { return (size_t)curve->system->field_series->slot_count; }

/* Returns the inputs of the field at order k: Q_k, then the velocity of a Lagrangian or the momentum of a
 * Hamiltonian, and the time. */
static inline double *curve_Q(const tvi_curve *curve, int k) { return curve->series + (size_t)k * curve_stride(curve); }

/* Returns U_k of component i. */
static inline double curve_U(const tvi_curve *curve, int k, int i)
{
    const int n = curve->n;
    switch (curve->system->form) {
    case TVI_SEPARABLE: return k < curve->highest_order ? (k + 1) * curve_Q(curve, k + 1)[i] : 0;
    case TVI_LAGRANGIAN: return curve_Q(curve, k)[curve->system->field_series->output_slot[n + i]];
    default: return curve_Q(curve, k)[n + i];
    }
}

/* Computes P_k of all orders k, [degree + 1][n]. */
static inline void curve_compute_P(const tvi_curve *curve, int degree, double P[])
{
    const int n = curve->n;
    for (int k = 0; k <= degree; k++)
        for (int i = 0; i < n; i++) P[k * n + i] = curve_U(curve, k, i) / curve->kappa[i];
}

/* ---- Where the curve starts -------------------------------------------------------------------------------------- */

void tvi_curve_allocate(tvi_curve *curve, tvi_arena *arena, const tvi_system *system, int highest_order,
                        tvi_jacobians jacobians);
void tvi_curve_fill_tables(tvi_curve *curve);                             /* called once, after allocation */
void tvi_curve_set_degrees(tvi_curve *curve, int q_degree, int p_degree); /* called once */

/* Sets tau, and the scale kappa of the momenta, which is tau/m for a separable system. */
static inline void curve_set_tau(tvi_curve *curve, double tau)
{
    curve->tau = tau;
    for (int i = 0; i < curve->n && curve->system->form == TVI_SEPARABLE; i++)
        curve->kappa[i] = tau / curve->system->mass[i];
}

/* Writes z into the block of the series. */
static inline void curve_set_z(const tvi_curve *curve, const double z[])
{
    const int n = curve->n;
    double *q = curve_Q(curve, 0), *second = curve->system->form == TVI_SEPARABLE ? curve_Q(curve, 1) : q + n;
    const double unit = curve->system->form == TVI_LAGRANGIAN ? curve->tau : 1;
    for (int i = 0; i < n; i++) {
        q[i] = z[i];
        second[i] = z[n + i] / unit;
    }
}

/* Computes the coefficients from z; `centre` is the time at the centre. Returns TVI_EDOMAIN, TVI_ENONFINITE, or
 * TVI_ESINGULAR if L_vv is singular. */
TVI_NODISCARD tvi_status tvi_curve_expand(tvi_curve *curve, double centre);

/* Factors L_vv or H_pp at the centre of the curve last expanded; the expansion of a Lagrangian's has done so. Returns
 * TVI_ESINGULAR. */
TVI_NODISCARD tvi_status tvi_curve_factor_L_vv(tvi_curve *curve);

/* ---- Sums of the coefficients ------------------------------------------------------------------------------------ */

tvi_series_sum tvi_series_sum_allocate(const tvi_curve *curve, tvi_arena *arena);
/* Sets a sum to sum_k weight_k Q_k, or to sum_k weight_k U_k. */
void tvi_series_sum_set(tvi_series_sum *sum, const tvi_curve *curve, bool of_U, const double weight[]);
/* Sets the weights to a s_a^k + b s_b^k for k <= degree, and to 0 above. */
void tvi_series_sum_set_powers(tvi_series_sum *sum, const tvi_curve *curve, bool of_U, int degree, double a, double s_a,
                               double b, double s_b);

/* Computes out[n], the sum, or the sum of the coefficients' magnitudes if of_sizes is set. Small terms are added
 * first. */
static inline void series_sum_add_up(const tvi_curve *curve, const tvi_series_sum *sum, const bool of_sizes,
                                     double out[])
{
    const size_t orders = (size_t)curve->highest_order + 1, stride = curve_stride(curve), n = (size_t)curve->n;
    memset(out, 0, n * sizeof *out);
    if (!sum->is_of_U || curve->system->form == TVI_HAMILTONIAN)
        add_weighted(orders, sum->weight, stride, n, curve->series + (sum->is_of_U ? n : 0), out, of_sizes);
    else
        for (size_t i = 0; i < n; i++)
            add_weighted(orders, sum->weight, stride, 1,
                         curve->series + curve->system->field_series->output_slot[n + i], out + i, of_sizes);
}

/* Computes out[n], the value of the sum. */
void tvi_series_sum_compute(const tvi_curve *curve, const tvi_series_sum *sum, double out[]);
/* Computes matrix[n][2n], the Jacobian of the sum by z. */
void tvi_series_sum_compute_jacobian(const tvi_curve *curve, const tvi_series_sum *sum, double matrix[]);
/* Sets the change dz [2n] of z, for which tvi_series_sum_compute_change computes what it makes of sums. */
void tvi_curve_set_dz(tvi_curve *curve, const double dz[]);
/* Computes out[n], the change of the sum to first order if z changes by dz: its Jacobian times dz. */
void tvi_series_sum_compute_change(const tvi_curve *curve, const tvi_series_sum *sum, double out[]);

/* Computes the natural sizes of the numbers of z [2n], relative to which their corrections are measured: sum_k |Q_k|,
 * and sum_{k>=1} |Q_k| for tau v or sum_k |P_k| for p. */
void tvi_curve_z_sizes(const tvi_curve *curve, double size[]);

/* Computes sizes.dq and sizes.u, the sums that bound dq/ds and du/ds in the step. */
void tvi_curve_compute_sizes(const tvi_curve *curve);
/* Returns tvi_stats.tail (algebra/tail.h) from these sizes; it is 0 if p' has one term only. */
double tvi_curve_tail(const tvi_curve *curve);

/* ---- Jacobians by z ---------------------------------------------------------------------------------------------- */

/* Returns how a stepper uses Jacobians: as products for separable systems of many coordinates, and as matrices for all
 * others. */
tvi_jacobians tvi_curve_choose_jacobians(const tvi_system *system);

/* Computes all orders of the tangents, [highest_order + 1][slots][lanes], from those of z in the block. */
void tvi_curve_expand_tangents(tvi_curve *curve, int lanes);

/* Computes jacobians.dQ_dz and dU_dz of the curve last expanded. */
void tvi_curve_compute_jacobians(tvi_curve *curve);

/* Computes out[2n] = sum_k (dQ_k/dz)^T seed_Q[k] + (dU_k/dz)^T seed_U[k], with seeds [highest_order + 1][n]. seed_U may
 * be NULL, and is not read for a separable system. */
void tvi_curve_multiply_seeds(tvi_curve *curve, const double seed_Q[], const double seed_U[], double out[]);

/* Returns the tapes that the steps of a stepper run, and which sweeps of each generated code is to contain. The curves
 * of the stepper use their Jacobians as `jacobians` says: not at all, as matrices or in products. Its action has
 * `points` nodes. */
tvi_tapes_of_steps tvi_curve_list_tapes(const tvi_system *system, const tvi_options *options, int points,
                                        tvi_jacobians jacobians);

/* ---- Another unit of time ---------------------------------------------------------------------------------------- */

/* Rescales tau and the coefficients to the unit of time factor * tau. In the same sweep it computes the increments dq =
 * q(1) - q(0) and du = u(1) - u(0), [n], and the sizes of tvi_curve_compute_sizes. */
void tvi_curve_rescale(tvi_curve *curve, double factor, double dq[], double du[]);

/* ---- Products with transposed Jacobians (products.c) ------------------------------------------------------------- */

/* The operands of a product with transposed Jacobians, which the equations of a step need where no matrix is formed:
 * sum_k (dQ_k/dz)^T seed_Q[k] + factor (J_upper^T x + J_lower^T y), with J_upper and J_lower the Jacobians by z of two
 * sums of the series, `upper` and `lower`, and x and y [n]. Seeds and sums that are NULL are omitted. */
typedef struct {
    const double *seed_Q;
    double factor;
    const tvi_series_sum *upper, *lower;
    const double *x, *y;
} tvi_transposed_product;

/* Computes the product out[2n] of a separable system by an adjoint sweep, from the orders of the curve up to
 * last_order, 1 <= last_order <= highest_order; the cost grows as its square. */
void tvi_multiply_transposed(tvi_curve *curve, int last_order, const tvi_transposed_product *product, double out[]);

#endif
