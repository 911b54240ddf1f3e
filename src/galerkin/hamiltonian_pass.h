/* hamiltonian_pass.h - Makes passes for a Hamiltonian K(q, p) whose second derivatives are used, by an approximate
 * Newton iteration (docs/method.md section 5). For a rescaled system K is g (H + e), where H + e is 0 on the solution.
 * A pass evaluates the gradient (K_q, K_p) at the unknowns x = (Q, P), and the matrix K'' of its derivatives, too. One
 * fixed-point iteration with this gradient would move x by d_0. If the gradient were its expansion to first order, the
 * next iterations would move x by
 *     d_{k+1} = h a J K'' d_k,    J (K_q, K_p) = (K_p, -K_q),
 *
 * with the matrix a of Gauss collocation. The computation of one d_k is an inner iteration, which takes a small part of
 * the time of an evaluation. The pass ends with a movement by the gradient, expanded to first order, at x + sum_k d_k.
 * Inner iterations have single precision, which takes half the time of double precision: the error that a pass leaves
 * is larger than 2^-24 of its movement, except in the last pass, whose movement is roundoff. Changes are relative to
 * the sizes of the unknowns, so that they do not depend on units. */
#ifndef TVI_GALERKIN_HAMILTONIAN_PASS_H
#define TVI_GALERKIN_HAMILTONIAN_PASS_H

#include "galerkin/nodes.h"

/* [1] Passes with second derivatives end when the next pass is expected to move the unknowns by at most this number
 * times their sizes. The number is larger than GALERKIN_GOAL, that of other passes, since these passes cost more. */
#define GALERKIN_HESSIAN_GOAL 0x1p-72 /* found: make longrun */
/* [1] Inner iterations end when the square of the next movement is expected to be at most this many times the square of
 * the error of the expansion to first order. With half of this number steps take more time, with twice this number more
 * passes. */
#define GALERKIN_INNER_GOAL 4 /* found: make longrun */
/* [iterations] A pass has at most this many inner iterations. */
#define GALERKIN_MAX_INNER_ITERATIONS 32 /* found: make longrun */
/* [1] H'' is reused if (relative movement)^2 is at most this. The error that a pass with reused second derivatives
 * leaves is the cube of the movement. */
#define HAMILTONIAN_HESSIAN_MAX_MOVEMENT 0x1p-50 /* found: make longrun */

/* The rows of K'' that inner iterations multiply by are those of the unknowns whose rates depend on any unknown; the
 * columns, which are also the first rows, those of them on which some rate depends. Rows are stored in groups of
 * ROWS_PER_GROUP, whose sums are computed in parallel; the last group may have fewer. Rows of single precision have
 * SINGLE_LANES(lanes) numbers, of which those after the last lane are 0. */
enum { ROWS_PER_GROUP = 4 };
#ifdef __AVX__
typedef float single_vec JET_VECTOR(float, 8);
#else
typedef float single_vec JET_VECTOR(float, 4);
#endif
enum { SINGLE_VEC = sizeof(single_vec) / sizeof(float) };
#define SINGLE_LANES(lanes) (((lanes) + 7) / 8 * 8)

/* Inner iterations store relative changes in this unit. The square of the least change that matters, 2^-72
 * (GALERKIN_HESSIAN_GOAL), would underflow in single precision; in this unit it is 2^-64. */
#define INNER_UNIT 0x1p-40

typedef struct {
    /* The nodes with the rates V and F as unknowns: the prediction extrapolates them from the impulses of earlier
     * steps, with scale = 1 / h, and no free motion. Their rows follow those of the unknowns. */
    galerkin_nodes rates;
    int columns, rows;
    const int *unknown_of_row;   /* [rows] the unknown of each row */
    const int *index_in_block;   /* [columns][rows of the group] for each group: where the block has the element */
    float *nu;                   /* [lanes][single lanes] the matrix nu_ij (nodes.h) */
    float *packed;               /* [columns][rows of the group][single lanes] for each group: the elements */
    double *size, *inverse_size; /* [rows] the size of each unknown in this step, and its reciprocal */
    float *dx, *dx_sum;          /* [rows][single lanes] d_k, and the sum of all d_k */
    float *dL, *dL_sum;          /* [rows][single lanes] the changes of the impulses by dx and by dx_sum */
    double *added_impulse; /* [unknowns][lanes] dL_sum in the unit of the impulses, for the movement of the pass */
    /* The movement of the last pass, a sum of squares; INFINITY before the first pass of a step. */
    double last_movement;
} hamiltonian_pass;

/* The number of rows in the group that begins with row `first`. */
static inline int hamiltonian_group(const hamiltonian_pass *pass, int first)
{
    return pass->rows - first < ROWS_PER_GROUP ? pass->rows - first : ROWS_PER_GROUP;
}

JET_INLINE single_vec single_load(const float *row, int v) { return *(const single_vec *)(row + v * SINGLE_VEC); }
JET_INLINE void single_store(float *row, int v, single_vec x) { *(single_vec *)(row + v * SINGLE_VEC) = x; }
JET_INLINE void node_store_single(float *row, int v, node_vec x)
{
    *(node_single *)(row + v * NODE_VEC) = JET_CONVERT(node_single, x);
}
JET_INLINE node_vec node_load_single(const float *row, int v)
{
    return JET_CONVERT(node_vec, *(const node_single *)(row + v * NODE_VEC));
}

/* ---- The changes of the impulses --------------------------------------------------------------------------------- */

/* Copies the second derivatives into `packed`, relative to the sizes of the unknowns, group by group. Element (row,
 * column) is the change of the row's impulse by a change of the column's unknown. nodes.scale, 1 for coordinates and -1
 * for momenta, is the sign of the rate in J K''. */
JET_INLINE void pack_hessian(const galerkin_nodes *nodes, const hamiltonian_pass *pass, const double *block,
                             const int lanes)
{
    const int *index = pass->index_in_block;
    float *packed = pass->packed;
    for (int first = 0, group; first < pass->rows; first += group) {
        group = hamiltonian_group(pass, first);
        for (int column = 0; column < pass->columns; column++, index += group, packed += group * SINGLE_LANES(lanes))
            for (int v = 0; v < lanes / NODE_VEC; v++) {
                const node_vec by_column =
                    (nodes->scale[pass->unknown_of_row[column]] * pass->size[column]) * node_load(nodes->hb, v);
                for (int i = 0; i < group; i++)
                    node_store_single(packed + i * SINGLE_LANES(lanes), v,
                                      pass->inverse_size[first + i] * by_column * node_load(block + index[i], v));
            }
    }
}

/* Sets `group` rows of `out`, from row `first` on, to the changes of the impulses by the changes dx of the unknowns. */
JET_INLINE void set_dL_group(const hamiltonian_pass *pass, const float *dx, int first, const int group, float *out,
                             const int lanes)
{
    enum { MOST = SINGLE_LANES(GALERKIN_MAX_LANES) / SINGLE_VEC };
    const int width = SINGLE_LANES(lanes), vectors = width / SINGLE_VEC;
    const float *packed = pass->packed + first * pass->columns * width;
    single_vec sum[ROWS_PER_GROUP][MOST];
    for (int i = 0; i < group; i++)
        for (int v = 0; v < vectors; v++) sum[i][v] = (single_vec){0};
    for (int column = 0; column < pass->columns; column++)
        for (int i = 0; i < group; i++, packed += width)
            for (int v = 0; v < vectors; v++) sum[i][v] += single_load(packed, v) * single_load(dx + column * width, v);
    for (int i = 0; i < group; i++)
        for (int v = 0; v < vectors; v++) single_store(out + (first + i) * width, v, sum[i][v]);
}

/* Sets the rows of `out` up to the end of the group that contains row end_row - 1 to the changes of the impulses by
 * the changes dx of the unknowns. The size of a full group is a constant in the call. */
JET_INLINE void set_dL(const hamiltonian_pass *pass, const float *dx, int end_row, float *out, const int lanes)
{
    for (int first = 0; first < end_row; first += ROWS_PER_GROUP) {
        const int group = hamiltonian_group(pass, first);
        if (group == ROWS_PER_GROUP) set_dL_group(pass, dx, first, ROWS_PER_GROUP, out, lanes);
        else set_dL_group(pass, dx, first, group, out, lanes);
    }
}

/* ---- The changes of the unknowns --------------------------------------------------------------------------------- */

/* Computes dx from dL, and adds it to dx_sum. Returns the sum of the squares of dx, in the
 * unit of the unknowns. */
JET_INLINE double set_dx(const hamiltonian_pass *pass, const int lanes)
{
    const int width = SINGLE_LANES(lanes), vectors = width / SINGLE_VEC;
    const float *L = pass->dL;
    float *dx = pass->dx, *sum_of_dx = pass->dx_sum;
    single_vec squares = {0}, nu[SINGLE_VEC];
    float part[SINGLE_VEC];
    for (int j = 0; j < (vectors == 1 ? lanes : 0); j++) nu[j] = single_load(pass->nu + j * width, 0);
    for (int i = 0; i < pass->columns; i++, L += width, dx += width, sum_of_dx += width)
        for (int v = 0; v < vectors; v++) {
            single_vec sum[PARTIAL_SUMS] = {0};
            for (int j = 0; j < lanes; j++)
                sum[j % PARTIAL_SUMS] += (vectors == 1 ? nu[j] : single_load(pass->nu + j * width, v)) * L[j];
            sum[0] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
            squares += sum[0] * sum[0];
            single_store(dx, v, sum[0]);
            single_store(sum_of_dx, v, single_load(sum_of_dx, v) + sum[0]);
        }
    single_store(part, 0, squares);
    for (int half = SINGLE_VEC / 2; half > 0; half /= 2)
        for (int i = 0; i < half; i++) part[i] += part[i + half];
    return INNER_UNIT * INNER_UNIT * (double)part[0];
}

/* Sets dL to the impulses of the current rates minus those of the last movement, and dx_sum to 0. */
JET_INLINE void set_first_changes_of_impulses(const galerkin_nodes *nodes, const hamiltonian_pass *pass,
                                              const double *rates, const int slot[], const int lanes)
{
    const int width = SINGLE_LANES(lanes);
    for (int i = 0; i < pass->columns; i++) {
        const int u = pass->unknown_of_row[i];
        const double factor = pass->inverse_size[i] / INNER_UNIT;
        for (int v = 0; v < lanes / NODE_VEC; v++) {
            const node_vec L = node_load(nodes->hb, v) * node_load(rates + slot[u] * lanes, v);
            node_store_single(pass->dL + i * width, v, factor * (L - node_load(nodes->impulse + u * lanes, v)));
            node_store_single(pass->dx_sum + i * width, v, (node_vec){0});
        }
    }
}

/* Makes the inner iterations of a pass. They end when the square of the next change is expected to be at most the
 * larger of least_goal and GALERKIN_INNER_GOAL times the square of the error of the expansion to first order. If the
 * second derivatives are used again (is_new is false), last_movement shows how far the unknowns are from their point.
 * added_impulse becomes the sum of the changes of the impulses, or 0 if the changes of the unknowns do not shrink. */
JET_INLINE void run_inner_iterations(const galerkin_nodes *nodes, const hamiltonian_pass *pass, const double *block,
                                     const double *rates, const int slot[], bool is_new, double least_goal,
                                     const int lanes)
{
    double before = INFINITY, earlier;
    int count = 0;
    if (is_new) pack_hessian(nodes, pass, block, lanes);
    set_first_changes_of_impulses(nodes, pass, rates, slot, lanes);
    const double first = set_dx(pass, lanes);
    const double second_order =
        GALERKIN_INNER_GOAL * first * (is_new ? first : pass->last_movement) / (nodes->unknown_count * lanes);
    const double goal = tvi_larger(second_order, least_goal);
    double now = first;
    do {
        earlier = before;
        before = now;
        set_dL(pass, pass->dx, pass->columns, pass->dL, lanes);
        now = set_dx(pass, lanes);
    } while (++count < GALERKIN_MAX_INNER_ITERATIONS && (now * now > goal * before || now * before > goal * earlier) &&
             (now < before || now < earlier));
    set_dL(pass, pass->dx_sum, pass->rows, pass->dL_sum, lanes);
    if (!(now <= first))
        memset(pass->added_impulse, 0, (size_t)(nodes->unknown_count * lanes) * sizeof *pass->added_impulse);
    for (int i = 0; i < (now <= first ? pass->rows : 0); i++)
        for (int v = 0; v < lanes / NODE_VEC; v++)
            node_store(pass->added_impulse + pass->unknown_of_row[i] * lanes, v,
                       INNER_UNIT * pass->size[i] * node_load_single(pass->dL_sum + i * SINGLE_LANES(lanes), v));
}

NODE_LOOP void hamiltonian_iterate(const galerkin_nodes *nodes, const hamiltonian_pass *pass, const double *block,
                                   const double *rates, const int slot[], bool is_new, double least_goal)
{
    BY_LANES(lanes, nodes->lane_count,
             run_inner_iterations(nodes, pass, block, rates, slot, is_new, least_goal, lanes));
}

/* ---- A pass ------------------------------------------------------------------------------------------------------ */

/* In the first pass of a step the inner iterations end when the square of a relative movement is below this number,
 * since a second pass follows in any case. */
#define HAMILTONIAN_FIRST_GOAL_SQUARE 0x1p-108

/* Predicts the rates from the impulses of earlier steps, and moves all unknowns by them. */
static inline void hamiltonian_predict(hamiltonian_pass *pass, const galerkin_nodes *nodes, const int rate_row[],
                                       const galerkin_extrapolation *by)
{
    galerkin_nodes all = *nodes;
    all.moving_count = all.unknown_count;
    nodes_predict(&pass->rates, by);
    (void)nodes_move_by_rates(&all, nodes->x, rate_row, NULL);
    pass->last_movement = INFINITY;
}

/* Makes a pass. Returns false if an unknown is outside the field's domain. */
static inline bool hamiltonian_make_pass(hamiltonian_pass *pass, const galerkin_nodes *nodes,
                                         const galerkin_field_at_nodes *field)
{
    const int numbers = nodes->unknown_count * nodes->lane_count;
    const bool is_first = isinf(pass->last_movement),
               is_new = !(pass->last_movement <= HAMILTONIAN_HESSIAN_MAX_MOVEMENT * numbers);
    const int *slot = field->slot[is_new];
    const double least =
        numbers * (is_first ? HAMILTONIAN_FIRST_GOAL_SQUARE : GALERKIN_HESSIAN_GOAL * GALERKIN_HESSIAN_GOAL);
    const double *rates = galerkin_evaluate_gradient_at(field, is_new, nodes->x, nodes->x + numbers / 2);
    if (!rates) return false;
    for (int i = 0; i < (is_first ? pass->rows : 0); i++) {
        pass->inverse_size[i] = nodes->inverse_size[pass->unknown_of_row[i]];
        pass->size[i] = 1 / pass->inverse_size[i];
    }
    hamiltonian_iterate(nodes, pass, field->block[true], rates, slot, is_new, least);
    pass->last_movement = nodes_move_by_changed_impulses(nodes, rates, pass->added_impulse, slot);
    return true;
}

#endif
