/* products.h - the products path of separable systems of many coordinates: no Jacobian of the curve is formed, and the
 * equations with them are solved by iteration (docs/method.md sections 2 and 5). Who solves them that way is
 * tvi_by_products (closure.h); the rest is for jacobian.c and the tests. */
#ifndef TVI_SRC_GENERATING_PRODUCTS_H
#define TVI_SRC_GENERATING_PRODUCTS_H

#include "generating/action.h"
#include "generating/closure.h"

/* What suits the system: matrices where n is small. Products are for separable systems alone. */
tvi_jacobians tvi_curve_jacobians_for(const tvi_system *system);

/* Of tvi_curve_aim, tvi_curve_push and tvi_curve_pull. */
void tvi_products_aim(tvi_curve *curve, const double dz[]);
void tvi_products_push(const tvi_curve *curve, const tvi_combination *combination, double out[]);
void tvi_products_pull(tvi_curve *curve, const double seed_Q[], double out[]);

/* Products, in three steps: nothing; seeds [top + 1][n], and factor times the transposed Jacobians of combinations
 * times x [n], are added; out[2n] is the sum. Only orders up to last of the curve count, 1 <= last <= top: a rough
 * product costs O(last^2). */
void tvi_curve_clear_seeds(tvi_curve *curve, int last);
void tvi_curve_add_seeds(tvi_curve *curve, int last, const double seed_Q[]);
void tvi_curve_add_sum(tvi_curve *curve, int last, const tvi_combination *combination, double factor, const double x[]);
void tvi_curve_pull_seeds(tvi_curve *curve, int last, double out[]);
/* Products: out[n] += factor K^T x with K = dQ'' / dq = tau^2 M^-1 F_q at the centre, of a curve with top >= 2: one of
 * lower degree has never evaluated its force. */
void tvi_curve_add_force(tvi_curve *curve, double factor, const double x[], double out[]);

#endif
