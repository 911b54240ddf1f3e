/* action.h - declares the gradient of the discrete action S of a curve by the curve's centre state z, which steppers
 * compute in each pass (docs/method.md section 4): S_z = G+^T p+ - G-^T p- + D_z. Here p- and p+ are the curve's
 * momenta at the start and the end of the step, and G- and G+ are the Jacobians, by z, of its coordinates there. The
 * defect form D_z of the gradient is small: it is a sum over the quadrature nodes in which the residuals of the
 * equations of motion are factors, and these nearly vanish on the curve. */
#ifndef TVI_SRC_GENERATING_ACTION_H
#define TVI_SRC_GENERATING_ACTION_H

#include "generating/curve.h"
#include "generating/seeds.h"
#include "method/descriptor.h"

/* Returns an action that has no memory yet: only its sizes and switches are set. They follow from the method that the
 * resolved options choose. */
tvi_action tvi_create_unallocated_action(const tvi_system *system, const tvi_options *options);
/* Returns the tape that evaluates the field at the nodes. */
const jet_tape *tvi_select_node_tape(const tvi_system *system, const tvi_action *action);
void tvi_allocate_action(tvi_action *action, tvi_arena *arena, const tvi_system *system, const tvi_options *options);
void tvi_prepare_action_tables(tvi_action *action, const tvi_options *options, tvi_step_span span);

/* Computes the seeds seed_Q and seed_U, [highest_order + 1][n], by which the action's gradient in defect form is D_z =
 * sum_k (dQ_k/dz)^T seed_Q[k] + (dU_k/dz)^T seed_U[k], with the coefficients Q_k of the position and U_k of the scaled
 * momentum. Returns TVI_EDOMAIN, TVI_ENONFINITE, TVI_ESINGULAR, or TVI_ENOCONV if the momenta that belong to a
 * Hamiltonian's velocities were not found. */
TVI_NODISCARD tvi_status tvi_compute_action_seeds(tvi_action *action, tvi_curve *curve, double seed_Q[],
                                                  double seed_U[]);

/* Evaluates the Lagrangian at nodes that lie on no single curve, at the action's times. From positions q, velocities
 * v and momenta p, [n][points] each, it computes gradient_by_q = tau L_q and gradient_by_v = L_v - p. */
TVI_NODISCARD tvi_status tvi_evaluate_lagrangian_at_nodes(tvi_action *action, tvi_curve *curve, const double q[],
                                                          const double v[], const double p[]);

/* Estimates q_roundoff and p_roundoff, [n] each: the roundoff of q and p at the ends of a step of size h from (q, p).
 * The roundoff stems from the field, as last evaluated at the nodes, and from p itself. Both roundoffs are 0 if the
 * increments of the step are larger than q and p. Returns the number of force evaluations that it made. */
int tvi_estimate_end_state_roundoff(tvi_action *action, const tvi_curve *curve, double h, const double q[],
                                    const double p[], double q_roundoff[], double p_roundoff[]);

#endif
