/* nodes.h - Computes with the unknowns of a Galerkin step at its nodes (docs/method.md sections 4 and 6): their
 * prediction from earlier steps, the movement of a pass, and the sweep of the field's tape. These loops take nearly all
 * the time of a step. ends.h has those at the start and at the end of a step.
 *
 * Letters: h is the size of the step, c_i the nodes and b_i the weights of Gauss quadrature on [0, 1], a_ij the matrix
 * of collocation. The rate F_j of an unknown at node j acts only through the impulse L_j = h b_j F_j, which is rounded
 * once. All sums use the rounded number, so that conservation laws of these sums do not depend on rounding. An impulse
 * of node j moves the unknown at node i by nu_ij L_j (times its scale), where nu_ij is a_ij / b_j, or in a separable
 * system sum_k a_ik a_kj / b_j.
 *
 * An array of an unknown has a lane for each node: 4, 8 or 12 lanes, of which those after the last node repeat it with
 * weight 0. Loops go over vectors of nodes, as wide as the instruction set has them. The number of lanes is a constant
 * in each loop (BY_LANES), in generated code that of its system. */
#ifndef TVI_SRC_GALERKIN_NODES_H
#define TVI_SRC_GALERKIN_NODES_H

#include "algebra/sizes.h"
#include "algebra/subsystems.h"
#include "tape.h"
#include "vector.h"

enum { GALERKIN_MAX_LANES = 12 };
/* The number of steps whose impulses are stored: the last two steps and the current step. */
enum { GALERKIN_RING_LENGTH = 3 };

/* ---- Vectors of nodes -------------------------------------------------------------------------------------------- */

/* Vectors of successive nodes, in double and in single precision. */
#if defined(JET_WIDE) && (!defined(GALERKIN_LANES) || GALERKIN_LANES == 8)
typedef jet_v8 node_vec;
typedef float node_single JET_VECTOR(float, 8);
typedef jet_mask_of_jet_v8 jet_mask_of_node_vec;
#elif defined(__AVX__)
typedef jet_v4 node_vec;
typedef float node_single JET_VECTOR(float, 4);
typedef jet_mask_of_jet_v4 jet_mask_of_node_vec;
#else
typedef jet_v2 node_vec;
typedef float node_single JET_VECTOR(float, 2);
typedef jet_mask_of_jet_v2 jet_mask_of_node_vec;
#endif
enum { NODE_VEC = sizeof(node_vec) / sizeof(double), MAX_VECTORS = GALERKIN_MAX_LANES / NODE_VEC };

/* Vector v of a row of nodes. */
JET_INLINE node_vec node_load(const double *row, int v) { return *(const node_vec *)(row + v * NODE_VEC); }
JET_INLINE void node_store(double *row, int v, node_vec x) { *(node_vec *)(row + v * NODE_VEC) = x; }
JET_INLINE node_vec node_all(double x) { return x - (node_vec){0}; }
JET_INLINE node_vec node_larger(node_vec a, node_vec b) { return JET_CHOOSE(node_vec, a > b, a, b); }

/* In the library a loop is a function of its own, which can use all registers. In generated code, where all sizes are
 * constants, it is inlined. GALERKIN_LANES, the number of lanes of its system, is defined in generated code alone
 * (emit_steps.c), as JET_EMITTED is (ad/emit.c): each of the two means "inside generated code".
 * BY_LANES(lanes, number, call) declares the constant `lanes`, whose value is `number`, and executes the call, which
 * reads it. An instruction set with vectors of 8 nodes is used with 8 lanes alone (method/method.c). */
#define WITH_LANES(lanes, count, call)                                                                                 \
    {                                                                                                                  \
        enum { lanes = count };                                                                                        \
        call;                                                                                                          \
    }
#ifdef GALERKIN_LANES
#define NODE_LOOP            JET_INLINE
#define NODE_COUNT_OF(nodes) ((void)(nodes), GALERKIN_NODE_COUNT)
#define BY_LANES(lanes, number, call)                                                                                  \
    (void)(number);                                                                                                    \
    WITH_LANES(lanes, GALERKIN_LANES, call)
#else
#define NODE_LOOP            JET_APART
#define NODE_COUNT_OF(nodes) ((nodes)->node_count)
#define BY_LANES(lanes, number, call)                                                                                  \
    if (NODE_VEC == 8 || (number) == 8) WITH_LANES(lanes, 8, call)                                                     \
    else if ((number) == 4) WITH_LANES(lanes, 4, call)                                                                 \
    else WITH_LANES(lanes, 12, call)
#endif

/* ---- The unknowns at the nodes ----------------------------------------------------------------------------------- */

/* The unknowns x of a step at its nodes: x = free_motion + free_motion_low + scale sum_j nu_ij L_j. They are (q, p), or
 * in a separable system the coordinates alone. Arrays are [unknown_count][lane_count] unless noted otherwise. A `const
 * galerkin_nodes *` says that a function changes no count and no pointer; it does change the arrays. */
typedef struct {
    int lane_count, node_count, unknown_count;
    int n; /* the number of coordinates */
    /* A pass moves all unknowns if moving_count is their number, and otherwise the first moving_count coordinates and
     * the first moving_count momenta: the last coordinates are cyclic, and their momenta constant. */
    int moving_count;
    double *x; /* the unknowns. With GALERKIN_PLAIN (steps.h) it is the block of the tape, which begins with them. */
    double *free_motion, *free_motion_low; /* the unknowns in a motion without forces, in two parts */
    double *impulse;                       /* the impulses L_j of the last movement, stored in the history */
    double *start;                         /* [unknown_count] the unknowns at the start of the step */
    /* [unknown_count] The factor of the impulses' sum in the change of an unknown; in a separable system h / m. */
    double *scale;
    double *inverse_size; /* [unknown_count] 1 / size of each unknown, by which movements are measured */
    double *hb;           /* [lane_count] h b_j */
    double *m_over_h;     /* [n] the momentum that moves a coordinate by 1 in the step; INFINITY without masses */
    const double *nu;     /* [j][i] the matrix nu_ij: how impulse L_j moves the unknown at node i */
    tvi_subsystems subsystems;
} galerkin_nodes;

/* ---- Sums over the nodes ----------------------------------------------------------------------------------------- */

/* A sum is split into this many partial sums, which the processor computes in parallel. */
enum { PARTIAL_SUMS = 4 };
/* The most vectors of a row whose sums are computed together: each L_j is loaded once for all of them. */
enum { MAX_BLOCK = 2 };

/* A table [j][lanes] of factors in sums over the nodes j: a local copy, which stays in registers, if a row is one
 * vector. The rows are read without a loop, which gcc would take for a copy in memory. */
typedef struct {
    const double *factor;
    node_vec row[NODE_VEC];
} node_table;

JET_INLINE node_table node_table_of(const double *factor, const int lanes)
{
    node_table table;
    table.factor = factor;
#define ROW(j) (table.row[(j) % NODE_VEC] = node_load(factor, (j) % NODE_VEC))
    if (lanes == NODE_VEC) (void)(ROW(0), ROW(1), ROW(2), ROW(3), ROW(4), ROW(5), ROW(6), ROW(7));
#undef ROW
    return table;
}

/* Adds sum_j table_jv L_j to the partial sums of the vectors v of a block that begins with vector `first`. */
JET_INLINE void add_products(node_vec sum[][PARTIAL_SUMS], const node_table *table, const double L[], int first,
                             const int block, const int lanes)
{
    for (int j = 0; j < lanes; j++)
        for (int b = 0; b < block; b++)
            sum[b][j % PARTIAL_SUMS] +=
                (lanes == NODE_VEC ? table->row[j] : node_load(table->factor + j * lanes, first + b)) * L[j];
}

JET_INLINE node_vec join_partial_sums(const node_vec sum[]) { return (sum[0] + sum[2]) + (sum[1] + sum[3]); }

/* The sum over the elements of a vector, by halves. */
JET_INLINE double node_sum(node_vec x)
{
    double part[NODE_VEC];
    node_store(part, 0, x);
    for (int half = NODE_VEC / 2; half > 0; half /= 2)
        for (int i = 0; i < half; i++) part[i] += part[i + half];
    return part[0];
}

/* ---- The prediction ---------------------------------------------------------------------------------------------- */

/* The impulses of earlier steps, and the tables of factors that predict the unknowns of a step from them: both of the
 * last two steps, with two_step_prediction_table [2][j][i], whose second half belongs to the earlier step; or, if no
 * earlier step has the same size or the prediction of the last step was rough, the last step alone, with
 * last_step_prediction_table [j][i]. */
typedef struct {
    const double *two_step_prediction_table, *last_step_prediction_table, *last_impulse, *impulse_before;
    bool uses_last_step_only;
} galerkin_extrapolation;

/* Predicts the unknowns. The impulses of the latest step, which have the largest factors, are added last. The function
 * works on a copy of the structure, as others below do, so that compilers know that no store to an array changes it. */
JET_INLINE void predict_rows(const galerkin_nodes *given, const galerkin_extrapolation *by, const int lanes)
{
    const int block = lanes / NODE_VEC % MAX_BLOCK == 0 ? MAX_BLOCK : 1;
    const galerkin_nodes copy = *given, *const nodes = &copy;
    const galerkin_extrapolation from = *by;
    const bool only_last = from.uses_last_step_only;
    const node_table last =
        node_table_of(only_last ? from.last_step_prediction_table : from.two_step_prediction_table, lanes);
    const node_table before = node_table_of(from.two_step_prediction_table + (only_last ? 0 : lanes * lanes), lanes);
    for (int u = 0; u < nodes->unknown_count; u++) {
        const double *high = nodes->free_motion + u * lanes, *low = nodes->free_motion_low + u * lanes;
        for (int first = 0; first < lanes / NODE_VEC; first += block) {
            node_vec sum[MAX_BLOCK][PARTIAL_SUMS] = {0};
            if (!only_last) add_products(sum, &before, from.impulse_before + u * lanes, first, block, lanes);
            add_products(sum, &last, from.last_impulse + u * lanes, first, block, lanes);
            for (int v = first; v < first + block; v++)
                node_store(nodes->x + u * lanes, v,
                           node_load(high, v) +
                               (join_partial_sums(sum[v - first]) * nodes->scale[u] + node_load(low, v)));
        }
    }
}

NODE_LOOP void nodes_predict(const galerkin_nodes *nodes, const galerkin_extrapolation *by)
{
    BY_LANES(lanes, nodes->lane_count, predict_rows(nodes, by, lanes));
}

/* ---- The movement of a pass -------------------------------------------------------------------------------------- */

/* Sets the impulses L_j = h b_j F_j from the rates: row rate_row[u] of `rates` has those of unknown u. */
JET_INLINE void set_impulse_rows(const galerkin_nodes *given, const double *rates, const int rate_row[],
                                 const int lanes)
{
    const galerkin_nodes copy = *given, *const nodes = &copy;
    for (int u = 0; u < nodes->unknown_count; u++)
        for (int v = 0; v < lanes / NODE_VEC; v++)
            node_store(nodes->impulse + u * lanes, v,
                       node_load(nodes->hb, v) * node_load(rates + rate_row[u] * lanes, v));
}

/* Returns a b + c, rounded once if c is small compared with a b. Without a fused operation it uses Dekker's product. */
JET_INLINE double multiply_add_once(double a, double b, double c)
{
#ifdef __FMA__
    return JET_FMA_OF_NUMBERS(a, b, c);
#else
    const double split = 0x1p27 + 1, product = a * b, big_a = split * a, big_b = split * b;
    const double high_a = big_a - (big_a - a), high_b = big_b - (big_b - b), low_a = a - high_a, low_b = b - high_b;
    return product + ((((high_a * high_b - product) + high_a * low_b + low_a * high_b) + low_a * low_b) + c);
#endif
}

/* Sets the impulses L_j = h b_j F_j + change_j. If the change were added to the rate before the multiplication, a
 * change below the roundoff of the rate would be lost or rounded up in the same way in each step (docs/method.md
 * section 6). */
JET_INLINE void set_changed_impulse_rows(const galerkin_nodes *nodes, const double *rates, const double *change,
                                         const int rate_row[], const int lanes)
{
    for (int u = 0; u < nodes->unknown_count; u++) {
        const double *restrict hb = nodes->hb, *restrict rate = rates + rate_row[u] * lanes;
        double *restrict L = nodes->impulse + u * lanes;
        JET_IN_VECTORS
        for (int i = 0; i < lanes; i++) L[i] = multiply_add_once(hb[i], rate[i], change[u * lanes + i]);
    }
}

/* Moves the unknowns by the impulses: x = free_motion + y with y = free_motion_low + scale sum_j nu_ij L_j. If
 * displacement [unknowns][lanes] is not NULL, it gets y. Returns the movement: the sum of the squares of (change of x)
 * inverse_size, which is a NaN if any change is a NaN. */
JET_INLINE double move_unknowns_by_impulses(const galerkin_nodes *given, double *displacement, const int lanes)
{
    const int block = lanes / NODE_VEC % MAX_BLOCK == 0 ? MAX_BLOCK : 1;
    const galerkin_nodes copy = *given, *const nodes = &copy;
    const int moving = nodes->moving_count, all = moving < nodes->unknown_count ? 2 * moving : nodes->unknown_count;
    const node_table nu = node_table_of(nodes->nu, lanes);
    node_vec squares[MAX_VECTORS] = {0}, total = {0};
    for (int k = 0; k < all; k++) {
        const int u = k < moving ? k : k - moving + nodes->n;
        const double *high = nodes->free_motion + u * lanes, *low = nodes->free_motion_low + u * lanes;
        double *x = nodes->x + u * lanes;
        for (int first = 0; first < lanes / NODE_VEC; first += block) {
            node_vec sum[MAX_BLOCK][PARTIAL_SUMS] = {0};
            add_products(sum, &nu, nodes->impulse + u * lanes, first, block, lanes);
            for (int v = first; v < first + block; v++) {
                const node_vec y = join_partial_sums(sum[v - first]) * nodes->scale[u] + node_load(low, v),
                               next = node_load(high, v) + y;
                const node_vec change = (next - node_load(x, v)) * nodes->inverse_size[u];
                squares[v] += change * change;
                node_store(x, v, next);
                if (displacement) node_store(displacement + u * lanes, v, y);
            }
        }
    }
    for (int v = 0; v < lanes / NODE_VEC; v++) total += squares[v];
    return node_sum(total);
}

/* Sets the impulses from the rates, and moves the unknowns by them. Returns the movement. */
NODE_LOOP double nodes_move_by_rates(const galerkin_nodes *nodes, const double *rates, const int rate_row[],
                                     double *displacement)
{
    double movement;
    BY_LANES(lanes, nodes->lane_count, set_impulse_rows(nodes, rates, rate_row, lanes);
             movement = move_unknowns_by_impulses(nodes, displacement, lanes));
    return movement;
}

/* Sets the impulses L_j = h b_j F_j + change_j, and moves the unknowns by them. Returns the movement. */
NODE_LOOP double nodes_move_by_changed_impulses(const galerkin_nodes *nodes, const double *rates, const double *change,
                                                const int rate_row[])
{
    double movement;
    BY_LANES(lanes, nodes->lane_count, set_changed_impulse_rows(nodes, rates, change, rate_row, lanes);
             movement = move_unknowns_by_impulses(nodes, NULL, lanes));
    return movement;
}

/* ---- The field at the nodes -------------------------------------------------------------------------------------- */

struct tvi_roundoff_estimator;

/* The tapes that compute the field at all nodes, and their blocks. A block begins with the inputs of the tape, a row of
 * lane_count numbers each: n rows of q, in equations of first order n rows of v or p, then the time and the parameters.
 * Index false is for the values alone, in a separable system the forces and otherwise the gradient of L or K; index
 * true is for the tape that has the second derivatives, too, whose block ends with a row of zeros. */
typedef struct {
    int n, lane_count, input_count;
    const jet_tape *tape[2];
    double *block[2];
    const int *slot[2]; /* [unknowns] the rows of a block with the rates, in a Lagrangian's with L_q and L_v */
    /* The sizes of random numbers that are added to the outputs while the roundoff of a pass is measured (probe.c).
     * NULL: nothing is added. */
    struct tvi_roundoff_estimator *added_roundoff;
} galerkin_field_at_nodes;

#ifdef GALERKIN_LANES
/* Evaluates a tape in its block. Returns false if an operand is outside its domain. In generated code the tapes are
 * functions of the text: emit_steps.c writes the macros GALERKIN_VALUES, GALERKIN_HESSIAN_VALUES,
 * GALERKIN_VALUES_OF_VECTOR and GALERKIN_IS_SPLIT with their names. */
JET_INLINE bool galerkin_sweep(const galerkin_field_at_nodes *field, bool with_hessian)
{
    return with_hessian ? GALERKIN_HESSIAN_VALUES(field->block[true]) : GALERKIN_VALUES(field->block[false]);
}

/* Evaluates the tape for one vector of nodes after the other, if each of its runs is a single operation
 * (GALERKIN_IS_SPLIT): all numbers stay in registers, and the impulses alone are stored. Returns false if an operand
 * is outside its domain. */
JET_INLINE bool galerkin_impulses_by_registers(const galerkin_nodes *nodes)
{
    bool is_inside = true;
    for (int v = 0; v < (GALERKIN_IS_SPLIT ? GALERKIN_LANES / NODE_VEC : 0); v++) {
        _Alignas(64) double block[GALERKIN_VALUE_SLOTS * NODE_VEC];
        JET_UNROLL(256)
        for (int i = 0; i < GALERKIN_READ_ONLY_ROWS; i++)
            node_store(block, i, node_load(nodes->x + i * GALERKIN_LANES, v));
        is_inside &= GALERKIN_VALUES_OF_VECTOR(block);
        JET_UNROLL(256)
        for (int u = 0; u < GALERKIN_UNKNOWNS; u++)
            node_store(nodes->impulse + u * GALERKIN_LANES, v,
                       node_load(nodes->hb, v) * node_load(block, galerkin_rate_row[u]));
    }
    return is_inside;
}
#else
/* Adds numbers of the size of field->added_roundoff, with random signs, to the outputs in the block (probe.c). */
void tvi_galerkin_add_roundoff(const galerkin_field_at_nodes *field, bool with_hessian);

/* Evaluates a tape in its block. Returns false if an operand is outside its domain. jet_sweep_values calls the sweep of
 * the tape: sweep_values in ad/sweep.c if the tape is interpreted. */
JET_INLINE bool galerkin_sweep(const galerkin_field_at_nodes *field, bool with_hessian)
{
    if (!jet_sweep_values(field->tape[with_hessian], field->block[with_hessian], field->lane_count)) return false;
    if (field->added_roundoff) tvi_galerkin_add_roundoff(field, with_hessian);
    return true;
}
#endif

/* Evaluates the gradient, with or without second derivatives, at the points of block[false]. Returns the block with the
 * result, or NULL if an operand is outside its domain. */
static inline const double *galerkin_evaluate_gradient(const galerkin_field_at_nodes *field, bool with_hessian)
{
    if (with_hessian)
        memcpy(field->block[true], field->block[false],
               (size_t)(field->input_count * field->lane_count) * sizeof(double));
    return galerkin_sweep(field, with_hessian) ? field->block[with_hessian] : NULL;
}

/* Evaluates the gradient at q and v or p, [n][lanes] each. */
static inline const double *galerkin_evaluate_gradient_at(const galerkin_field_at_nodes *field, bool with_hessian,
                                                          const double *q, const double *v_or_p)
{
    const int half = field->n * field->lane_count;
    memcpy(field->block[false], q, (size_t)half * sizeof *q);
    memcpy(field->block[false] + half, v_or_p, (size_t)half * sizeof *v_or_p);
    return galerkin_evaluate_gradient(field, with_hessian);
}

#endif
