/* action.h - Declares the gradient of the discrete action S of a curve by the state z at its centre, which steppers
 * compute in each pass (docs/method.md section 4): S_z = G+^T p+ - G-^T p- + D_z. Here p- and p+ are the curve's
 * momenta at the start and the end of the step, and G- and G+ are the Jacobians, by z, of its coordinates there. The
 * defect form D_z of the gradient is small: it is a sum over the quadrature nodes in which the residuals of the
 * equations of motion are factors, and these nearly vanish on the curve. seeds.c computes its derivatives by the
 * coefficients of the curve, of which D_z is the product with the Jacobians by z. action.c, which makes the tables of
 * the powers s_i^k of the nodes, is compiled once, so that they have the same bits for all instruction sets. */
#ifndef TVI_SRC_GENERATING_ACTION_H
#define TVI_SRC_GENERATING_ACTION_H

#include "generating/curve.h"
#include "method/descriptor.h"
#include "system/roundoff.h"

/* The powers s_i^k of the nodes s_i, or their derivatives, or these times the weights. `all` is [order_count][nodes].
 * If nodes mirror each other, `even` and `odd` have the even and the odd k at the first half of the nodes,
 * [(order_count + 1)/2][half]; at the other half the rows of even k are multiplied by mirror_sign, those of odd k by
 * -mirror_sign. Weighted tables are for sums over the nodes; they are transposed, [nodes][order_count] and
 * [half][TVI_WHOLE_VECTORS((order_count + 1)/2)]. */
typedef struct {
    double *all, *even, *odd;
    double mirror_sign; /* 1 for powers and second derivatives, -1 for first derivatives */
} tvi_node_table;
#define TVI_WHOLE_VECTORS(count) (((count) + 3) / 4 * 4)

typedef struct tvi_action {
    bool is_hamilton;        /* the action is an integral of p.q' - H by t; otherwise of L */
    bool is_truncated;       /* the positions at the nodes omit the highest order */
    bool has_by_v, has_by_p; /* by_v and by_p can differ from 0 */
    int q_degree, p_degree;  /* the degrees to which position and momentum are summed */
    int nodes;               /* the number of nodes, with those that fill a mirrored half to whole vectors */
    int order_count;         /* the number of orders of the curve, highest_order + 1 */
    /* The number of nodes in a mirrored half, padded to whole vectors, or 0 if the nodes do not mirror each other or if
     * the seeds need second derivatives. The nodes of the first half are first, and their mirror images follow. A node
     * at the centre is in both halves, with half its weight in each; nodes that pad a half repeat its first node with
     * weight 0. */
    int half;
    /* The tables, which are valid after tvi_action_set_tables and do not change. */
    struct {
        double *s, *weight; /* [nodes] the nodes s_i in scaled time, and their weights, whose sum is s+ - s- */
        /* s_i^k and its derivatives, 0 for k > q_degree; the second derivatives, for all orders; s_i^k as the positions
         * q_i sum them, without the highest order at truncated nodes; and the first two times the weights. */
        tvi_node_table power, slope, second, node_power, weighted_power, weighted_slope;
        /* [order_count][order_count] (j + k) e_{j+k-1} of the summation by parts, for the orders k of the position and
         * j of the momentum; NULL if all of them are 0 */
        double *by_parts;
    } tables;
    double *node_sums;    /* [order_count] scratch: sums over the nodes for each order */
    const jet_tape *tape; /* the field's tape at the nodes, with tangents if momenta must be found from velocities */
    double *slots;        /* the block of the tape, with one lane for each node */
    double *Hp_slots;     /* the block of H_qp p and H_pp p; for truncated nodes of a Hamiltonian */
    double *P;            /* [p_degree + 1][n] the coefficients of the momentum */
    /* What is found at the nodes, [n][nodes] each, valid from one call of tvi_action_seeds or
     * tvi_action_evaluate_lagrangian to the next: the curve's momentum and its derivative by s, and the derivatives of
     * the action by q_i, tau v_i and p_i at node i, without the weight of the node. */
    struct {
        double *p, *dp_ds, *by_q, *by_v, *by_p;
    } at_nodes;
    /* Memory of momenta.c, unused unless the momenta at the nodes must be found from velocities. */
    struct {
        double *dp;       /* [n][nodes] the last correction of the momenta p_i that belong to velocities */
        double *H_pp;     /* [n][n][nodes] H_pp at the nodes, or its inverse */
        double *tangents; /* the block of the field's tangents in one direction, with one lane for each node */
    } momenta;
    tvi_roundoff_estimator roundoff; /* an estimator of the roundoff of the field at the nodes */
} tvi_action;

/* The largest number of even orders or of odd orders of a curve, and of the nodes in a half, in whole vectors. */
enum { HALF = (TVI_MAX_DEGREE + 2) / 2 + 4 };

/* Evaluates the field at the nodes. */
TVI_NODISCARD static inline tvi_status action_evaluate_field(const tvi_action *action)
{
    return jet_sweep_values(action->tape, action->slots, action->nodes) ? TVI_OK : TVI_EDOMAIN;
}

/* Returns output i of the tape in its block x at the nodes. */
static inline const double *action_output(const tvi_action *action, const jet_tape *tape, const double *x, int i)
{
    return x + (size_t)tape->output_slot[i] * (size_t)action->nodes;
}

/* Returns an action without memory: its sizes and switches, for the method that the resolved options choose. */
tvi_action tvi_action_shape(const tvi_system *system, const tvi_options *options);
void tvi_action_allocate(tvi_action *action, tvi_arena *arena, const tvi_system *system, const tvi_options *options);
void tvi_action_set_tables(tvi_action *action, const tvi_options *options, tvi_step_span span);

/* Computes the seeds seed_Q and seed_U, [highest_order + 1][n], with which D_z = sum_k (dQ_k/dz)^T seed_Q[k] +
 * (dU_k/dz)^T seed_U[k]. Returns TVI_EDOMAIN, TVI_ENONFINITE, TVI_ESINGULAR, or TVI_ENOCONV if the momenta that belong
 * to a Hamiltonian's velocities were not found. */
TVI_NODISCARD tvi_status tvi_action_seeds(tvi_action *action, tvi_curve *curve, double seed_Q[], double seed_U[]);

/* Finds the momenta p_i at the nodes that belong to the velocities in at_nodes.by_v: H_p(q_i, p_i) = v_i (momenta.c).
 * The iteration begins with the momenta of the curve. It leaves the solution in the second input of the field, which is
 * evaluated with it. Returns TVI_EDOMAIN, TVI_ENONFINITE, TVI_ESINGULAR or TVI_ENOCONV. */
TVI_NODISCARD tvi_status tvi_action_find_node_momenta(tvi_action *action, tvi_curve *curve);

/* Evaluates the Lagrangian at nodes that lie on no single curve, at the action's times. From positions q, velocities v
 * and momenta p, [n][nodes] each, it computes at_nodes.by_q = tau L_q and by_v = L_v - p. */
TVI_NODISCARD tvi_status tvi_action_evaluate_lagrangian(tvi_action *action, tvi_curve *curve, const double q[],
                                                        const double v[], const double p[]);

/* Estimates the roundoff of q and p [n] at the ends of a step of size h from (q, p), which stems from the field, as
 * last evaluated at the nodes, and from p itself. Both are 0 if the increments of the step are larger than q and p.
 * Returns the number of force evaluations that it made. */
int tvi_action_end_roundoff(tvi_action *action, const tvi_curve *curve, double h, const double q[], const double p[],
                            double q_roundoff[], double p_roundoff[]);

#endif
