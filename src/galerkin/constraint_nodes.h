/* constraint_nodes.h - Computes with the constraints phi(q, t) = 0 of a Galerkin step at its Lobatto nodes, all nodes
 * in the lanes of a row (docs/method.md, section 12; lobatto.h has sources and targets).
 *
 * Letters: X_j are the positions at the targets d_j, G = phi_q, mu_j the multiplier of source j times h w_j, and K_j =
 * -G^T mu_j its impulse on the momenta. W = dv/dp is 1 / m with masses, and S = G W G^T = R^T R. A pass evaluates phi
 * and G at centres C_j, which are X_j without their last bits, and then repeats, with dx_j = X_j - C_j to first order
 * in the impulses,
 *     r_j = phi + G dx_j + dx_j phi_qq dx_j / 2 at each target,    mu += S^-1 G (N^-1 W G^T S^-1 r) / h at the sources,
 * where N is the matrix nu(d_i, d_j) between targets and sources: a correction of each node alone by S^-1, distributed
 * to the impulses that bring it about. It contracts as h^2. Second derivatives of phi keep the roundoff of the centres
 * out of what is solved. */
#ifndef TVI_GALERKIN_CONSTRAINT_NODES_H
#define TVI_GALERKIN_CONSTRAINT_NODES_H

#include "galerkin/lobatto.h"
#include "system/constraint.h"

/* [bits] The last bits of the positions that centres do not have. More than for a Lagrangian's gradient, since second
 * derivatives of phi are used: (2^-33)^3 is below roundoff. */
#define CONSTRAINT_ROUNDED_BITS 20 /* found: make constraints */
/* [iterations] The corrections of the multipliers in a pass. */
#define CONSTRAINT_ITERATIONS 3 /* found: make constraints */

/* S = G W G^T, by rows, from the first constraint that shares a coordinate on, so that parts that share none, and
 * chains, cost no more than they need. A factor R has the reciprocal of its diagonal in the place of the diagonal. */
typedef struct {
    int *first, *row_begin;    /* [count] the first constraint of a row, and the index of its element */
    int size;                  /* the number of elements */
    double *targets, *sources; /* [size][lanes] the factors at the nodes */
    double *start;             /* [size] that of source 0, the start of the step */
} constraint_factors;

/* The entries of G. */
typedef struct {
    double *targets, *sources; /* [entries][lanes] at the nodes of the last pass */
    double *start;             /* [entries] at source 0 */
} constraint_normals;

/* The positions at the targets, [n][lanes]: now = free + free_low + moved. */
typedef struct {
    double *now;
    double *free, *free_low; /* the positions without impulses, in two parts */
    double *moved;           /* what the impulses do */
    double *by_forces;       /* the part of `moved` that does not depend on K */
    double *end_roundoff;    /* [n] what the last row of `moved`, that of q at the end of the step, lacks to its sum */
} constraint_positions;

/* What a pass computes. */
typedef struct {
    double *values, *curvature;    /* the blocks of the tapes at the targets */
    double *rest;                  /* [n][lanes] the positions before the pass, minus their centres */
    double *phi, *residual;        /* [count][lanes] phi at the centres, and r */
    double *bent, *turn, *scratch; /* [n][lanes] (G^T mu)_q dx at the targets; scratch */
} constraint_pass_memory;

typedef struct {
    int n, count; /* the numbers of coordinates and constraints */
    bool has_masses;
    const tvi_constraints *constraints;
    const galerkin_lobatto *tables;
    /* [entries] The multiplier of each entry of G, and the momentum that the impulse changes. */
    int *multiplier_of_entry, *momentum_of_entry;
    double h, *W, *hW; /* the step, W, which is [n] with masses and [n][n] without, and h W */
    double *mu;        /* [count][lanes] the multipliers of the sources */
    double *K;         /* [n][lanes] their impulses */
    constraint_factors S;
    constraint_normals G;
    constraint_positions X;
    constraint_pass_memory pass;
} constraint_nodes;

/* ---- Matrices ---------------------------------------------------------------------------------------------------- */

/* to += sign a b for rows of lanes; of one state there is one lane. */
JET_INLINE void lanes_add_product(double *to, const double *a, const double *b, const double sign, const int lanes)
{
    if (lanes == 1) *to += sign * *a * *b;
    for (int v = 0; v < lanes / NODE_VEC; v++)
        node_store(to, v, node_load(to, v) + sign * node_load(a, v) * node_load(b, v));
}

/* to += factor a. */
JET_INLINE void lanes_add_multiple(double *to, double factor, const double *a, const int lanes)
{
    if (lanes == 1) *to += factor * *a;
    for (int v = 0; v < lanes / NODE_VEC; v++) node_store(to, v, node_load(to, v) + factor * node_load(a, v));
}

/* to *= a. */
JET_INLINE void lanes_multiply(double *to, const double *a, const int lanes)
{
    if (lanes == 1) *to *= *a;
    for (int v = 0; v < lanes / NODE_VEC; v++) node_store(to, v, node_load(to, v) * node_load(a, v));
}

/* out = W x, or h W x; [n][lanes]. */
JET_INLINE void constraint_apply_W(const constraint_nodes *at, const double *W, const double *x, double *out,
                                   const int lanes)
{
    memset(out, 0, (size_t)(at->n * lanes) * sizeof *out);
    for (int i = 0; i < at->n; i++) {
        if (at->has_masses) lanes_add_multiple(out + i * lanes, W[i], x + i * lanes, lanes);
        for (int j = 0; j < (at->has_masses ? 0 : at->n); j++)
            lanes_add_multiple(out + i * lanes, W[i * at->n + j], x + j * lanes, lanes);
    }
}

/* out = G^T x, [n][lanes] from [count][lanes]; entry e of G is at G[e * lanes]. Those of a lift change places. */
JET_INLINE void constraint_apply_GT(const constraint_nodes *at, const double *G, const double *x, double *out,
                                    const int lanes)
{
    const tvi_constraints *c = at->constraints;
    memset(out, 0, (size_t)(at->n * lanes) * sizeof *out);
    for (int e = 0; e < c->entry_count; e++)
        lanes_add_product(out + at->momentum_of_entry[e] * lanes, G + e * lanes, x + at->multiplier_of_entry[e] * lanes,
                          1, lanes);
}

/* out += G x, [count][lanes] from [n][lanes]. */
JET_INLINE void constraint_add_G(const constraint_nodes *at, const double *G, const double *x, double *out,
                                 const int lanes)
{
    const tvi_constraints *c = at->constraints;
    for (int k = 0, e = 0; k < at->count; k++)
        for (; e < c->row_end[k]; e++)
            lanes_add_product(out + k * lanes, G + e * lanes, x + c->column[e] * lanes, 1, lanes);
}

/* row += W g, where g is an entry of G in column j (tvi_constraint_W_column). */
JET_INLINE void constraint_add_W_column(const constraint_nodes *at, int j, const double *g, double *row,
                                        const int lanes)
{
    const tvi_W_column of = tvi_constraint_W_column(at->constraints, at->n, j);
    if (at->has_masses) lanes_add_multiple(row + j * lanes, at->W[j], g, lanes);
    for (int i = of.first; i < (at->has_masses ? 0 : of.end); i++)
        lanes_add_multiple(row + i * lanes, at->W[i * at->n + of.column], g, lanes);
}

/* Sets S = G W G^T, and for a lift S of both halves without what ties them (tvi_constraint_ties_halves). */
JET_INLINE void constraint_set_S(const constraint_nodes *at, const double *G, double *S, const int lanes)
{
    const tvi_constraints *c = at->constraints;
    for (int l = 0; l < at->count; l++) {
        double *const row = at->pass.scratch;
        memset(row, 0, (size_t)(at->n * lanes) * sizeof *row);
        for (int e = constraint_row_begin(c, l); e < c->row_end[l]; e++)
            if (!tvi_constraint_ties_halves(c, at->n, l, c->column[e]))
                constraint_add_W_column(at, c->column[e], G + e * lanes, row, lanes);
        for (int k = l; k < at->count; k++) {
            if (at->S.first[k] > l) continue;
            double *const to = S + (at->S.row_begin[k] + l - at->S.first[k]) * lanes;
            memset(to, 0, (size_t)lanes * sizeof *to);
            for (int e = constraint_row_begin(c, k); e < c->row_end[k]; e++)
                if (!tvi_constraint_ties_halves(c, at->n, k, c->column[e]))
                    lanes_add_product(to, G + e * lanes, row + c->column[e] * lanes, 1, lanes);
        }
    }
}

/* Sets S = G W G^T, and factors it. The diagonal of the factor is stored as its reciprocal. Returns the least pivot as
 * a part of the diagonal of S, at any lane, or NAN if one is no number; *least is its constraint. */
JET_INLINE double constraint_factor_S(const constraint_nodes *at, const double *G, double *S, int *least,
                                      const int lanes)
{
    double worst = INFINITY;
    constraint_set_S(at, G, S, lanes);
    for (int k = 0; k < at->count; k++) {
        double *const of_k = S + (at->S.row_begin[k] - at->S.first[k]) * lanes, *const pivot = of_k + k * lanes;
        double before[GALERKIN_MAX_LANES];
        memcpy(before, pivot, (size_t)lanes * sizeof *pivot);
        for (int l = at->S.first[k]; l <= k; l++) {
            const double *const of_l = S + (at->S.row_begin[l] - at->S.first[l]) * lanes;
            for (int j = at->S.first[k] > at->S.first[l] ? at->S.first[k] : at->S.first[l]; j < l; j++)
                lanes_add_product(of_k + l * lanes, of_k + j * lanes, of_l + j * lanes, -1, lanes);
            if (l < k) lanes_multiply(of_k + l * lanes, of_l + l * lanes, lanes);
        }
        for (int lane = 0; lane < lanes; lane++) {
            if (!(pivot[lane] / before[lane] >= worst) && !isnan(worst)) worst = pivot[lane] / before[lane], *least = k;
            pivot[lane] = 1 / sqrt(pivot[lane]);
        }
    }
    return worst;
}

/* x = S^-1 x, [count][lanes]. */
JET_INLINE void constraint_solve(const constraint_nodes *at, const double *S, double *x, const int lanes)
{
    for (int k = 0; k < at->count; k++) {
        const double *const row = S + (at->S.row_begin[k] - at->S.first[k]) * lanes;
        for (int j = at->S.first[k]; j < k; j++)
            lanes_add_product(x + k * lanes, row + j * lanes, x + j * lanes, -1, lanes);
        lanes_multiply(x + k * lanes, row + k * lanes, lanes);
    }
    for (int k = at->count - 1; k >= 0; k--) {
        const double *const row = S + (at->S.row_begin[k] - at->S.first[k]) * lanes;
        lanes_multiply(x + k * lanes, row + k * lanes, lanes);
        for (int j = at->S.first[k]; j < k; j++)
            lanes_add_product(x + j * lanes, row + j * lanes, x + k * lanes, -1, lanes);
    }
}

/* ---- Nodes ------------------------------------------------------------------------------------------------------- */

/* Moves `count` rows from targets d_1 .. to sources d_0 ..; row r of source 0 is start[r], or 0. */
JET_INLINE void constraint_to_sources(int count, const double *targets, const double *start, double *sources,
                                      const int lanes)
{
    for (int r = 0; r < count; r++) {
        memcpy(sources + r * lanes + 1, targets + r * lanes, (size_t)(lanes - 1) * sizeof *sources);
        sources[r * lanes] = start ? start[r] : 0;
    }
}

/* out = sum_j table_j x_j over the nodes j of x, [count][lanes]. */
JET_INLINE void constraint_sum(int count, const double *table, const double *x, double *out, const int lanes)
{
    const node_table factors = node_table_of(table, lanes);
    for (int u = 0; u < count; u++)
        for (int v = 0; v < lanes / NODE_VEC; v++) {
            node_vec sum[1][PARTIAL_SUMS] = {{{0}}};
            add_products(sum, &factors, x + u * lanes, v, 1, lanes);
            node_store(out + u * lanes, v, join_partial_sums(sum[0]));
        }
}

/* Sets K = -(G^T mu + (G^T mu)_q dx), where `bent` [n][lanes] has the second term at the targets. */
JET_INLINE void constraint_set_impulses(const constraint_nodes *at, const double *bent, const int lanes)
{
    double *const K = at->K, *const at_sources = at->pass.turn;
    constraint_apply_GT(at, at->G.sources, at->mu, K, lanes);
    if (bent) constraint_to_sources(at->n, bent, NULL, at_sources, lanes);
    else memset(at_sources, 0, (size_t)(at->n * lanes) * sizeof *K);
    for (int v = 0; v < at->n * lanes / NODE_VEC; v++) node_store(K, v, -(node_load(K, v) + node_load(at_sources, v)));
}

/* Sets `moved` from the impulses. */
JET_INLINE void constraint_set_moved(const constraint_nodes *at, double *moved, const int lanes)
{
    double *const sum = at->pass.scratch;
    constraint_sum(at->n, at->tables->source_to_target, at->K, sum, lanes);
    constraint_apply_W(at, at->hW, sum, moved, lanes);
    for (int v = 0; v < at->n * lanes / NODE_VEC; v++)
        node_store(moved, v, node_load(moved, v) + node_load(at->X.by_forces, v));
}

/* Rounds the last bits off the positions. */
JET_INLINE void constraint_round(int count, const double *x, double *rounded)
{
    const uint64_t unit = UINT64_C(1) << CONSTRAINT_ROUNDED_BITS;
    for (int i = 0; i < count; i++) {
        const uint64_t bits = (tvi_double_bits(x[i]) + unit / 2) & ~(unit - 1);
        memcpy(&rounded[i], &bits, sizeof bits);
    }
}

/* Evaluates phi and G at the centres, and sets `rest`. Returns false if an operand is outside its domain. */
JET_INLINE bool constraint_evaluate(const constraint_nodes *at, const int lanes)
{
    const tvi_constraints *c = at->constraints;
    const int *const slot = c->values->output_slot, numbers = at->n * lanes;
    double *const C = at->pass.values;
    constraint_round(numbers, at->X.now, C);
    for (int v = 0; v < numbers / NODE_VEC; v++)
        node_store(at->pass.rest, v,
                   (node_load(at->X.free, v) - node_load(C, v)) +
                       (node_load(at->X.moved, v) + node_load(at->X.free_low, v)));
    for (int i = 0; i < at->n; i++)
        for (int lane = at->tables->node_count - 1; lane < lanes; lane++)
            at->pass.rest[i * lanes + lane] += at->X.end_roundoff[i];
    if (!jet_sweep_values(c->values, at->pass.values, lanes)) return false;
    for (int k = 0; k < at->count; k++)
        memcpy(at->pass.phi + k * lanes, at->pass.values + slot[k] * lanes, (size_t)lanes * sizeof *C);
    for (int e = 0; e < c->entry_count; e++)
        memcpy(at->G.targets + e * lanes, at->pass.values + slot[at->count + e] * lanes, (size_t)lanes * sizeof *C);
    constraint_to_sources(c->entry_count, at->G.targets, at->G.start, at->G.sources, lanes);
    memcpy(at->pass.curvature, C, (size_t)numbers * sizeof *C);
    return true;
}

/* Evaluates the second derivatives of phi along dx, which the block of curvature has, for these multipliers: sets the
 * rows (G^T mu)_q dx in `bent`, and dx phi_qq dx / 2. Returns false if an operand is outside its domain. */
JET_INLINE bool constraint_bend(const constraint_nodes *at, double *bent, double *half_square, const int lanes)
{
    const tvi_constraints *c = at->constraints;
    const int *const slot = c->curvature->output_slot;
    double *const mu = at->pass.curvature + 2 * at->n * lanes;
    for (int k = 0; k < at->count; k++) {
        double *const to = mu + tvi_constraint_multiplier(c, k) * lanes;
        memcpy(to, at->mu + k * lanes + 1, (size_t)(lanes - 1) * sizeof *mu);
        to[lanes - 1] = 0;
    }
    if (!jet_sweep_values(c->curvature, at->pass.curvature, lanes)) return false;
    for (int i = 0; i < at->n; i++)
        memcpy(bent + tvi_constraint_momentum(c, at->n, i) * lanes, at->pass.curvature + slot[i] * lanes,
               (size_t)lanes * sizeof *mu);
    for (int k = 0; k < at->count; k++)
        memcpy(half_square + k * lanes, at->pass.curvature + slot[at->n + k] * lanes, (size_t)lanes * sizeof *mu);
    return true;
}

/* Corrects the multipliers from the residual r, which is overwritten. dx is scratch. */
JET_INLINE void constraint_correct_mu(const constraint_nodes *at, double *r, double *dx, const int lanes)
{
    constraint_solve(at, at->S.targets, r, lanes);
    constraint_apply_GT(at, at->G.targets, r, dx, lanes);
    constraint_apply_W(at, at->W, dx, at->pass.scratch, lanes);
    constraint_sum(at->n, at->tables->target_to_source, at->pass.scratch, dx, lanes);
    memset(r, 0, (size_t)(at->count * lanes) * sizeof *r);
    constraint_add_G(at, at->G.sources, dx, r, lanes);
    constraint_solve(at, at->S.sources, r, lanes);
    for (int k = 0; k < at->count; k++) lanes_add_multiple(at->mu + k * lanes, 1 / at->h, r + k * lanes, lanes);
}

/* Moves the positions X. Returns the movement, the sum of the squares of their changes relative to their sizes. */
JET_INLINE double constraint_move(const constraint_nodes *at, const double inverse_size[], const int lanes)
{
    node_vec squares = {0};
    constraint_set_moved(at, at->X.moved, lanes);
    for (int i = 0; i < at->n; i++)
        for (int v = i * lanes / NODE_VEC; v < (i + 1) * lanes / NODE_VEC; v++) {
            const node_vec low = node_load(at->X.moved, v) + node_load(at->X.free_low, v),
                           next = node_load(at->X.free, v) + low,
                           change = (next - node_load(at->X.now, v)) * inverse_size[i];
            squares += change * change;
            node_store(at->X.now, v, next);
        }
    return node_sum(squares);
}

/* What a pass over the constraints finds. */
typedef struct {
    bool is_inside; /* all operands were inside their domains */
    double pivot;   /* the least one of S, if it was factored, and its constraint */
    int least;
    double movement;
} constraint_outcome;

/* Makes a pass over the constraints: finds the multipliers for the impulses of the forces, whose part of `moved` is in
 * by_forces, and moves X. */
JET_INLINE constraint_outcome constraint_pass_rows(const constraint_nodes *at, bool is_factor_new,
                                                   const double inverse_size[], const int lanes)
{
    constraint_outcome outcome = {.pivot = INFINITY};
    const int numbers = at->n * lanes;
    double *const dx = at->pass.curvature + numbers;
    if (!constraint_evaluate(at, lanes)) return outcome;
    if (is_factor_new) {
        outcome.pivot = constraint_factor_S(at, at->G.targets, at->S.targets, &outcome.least, lanes);
        constraint_to_sources(at->S.size, at->S.targets, at->S.start, at->S.sources, lanes);
    }
    memcpy(dx, at->pass.rest, (size_t)numbers * sizeof *dx);
    for (int i = 0; i < CONSTRAINT_ITERATIONS; i++) {
        if (!constraint_bend(at, at->pass.bent, at->pass.residual, lanes)) return outcome;
        constraint_set_impulses(at, at->pass.bent, lanes);
        constraint_set_moved(at, dx, lanes);
        for (int v = 0; v < numbers / NODE_VEC; v++)
            node_store(dx, v, node_load(at->pass.rest, v) + (node_load(dx, v) - node_load(at->X.moved, v)));
        for (int v = 0; v < at->count * lanes / NODE_VEC; v++)
            node_store(at->pass.residual, v, node_load(at->pass.residual, v) + node_load(at->pass.phi, v));
        constraint_add_G(at, at->G.targets, dx, at->pass.residual, lanes);
        constraint_correct_mu(at, at->pass.residual, at->pass.turn, lanes);
    }
    constraint_set_impulses(at, at->pass.bent, lanes);
    outcome.movement = constraint_move(at, inverse_size, lanes);
    outcome.is_inside = true;
    return outcome;
}

NODE_LOOP constraint_outcome constraint_pass(const constraint_nodes *at, int lane_count, bool is_factor_new,
                                             const double inverse_size[])
{
    constraint_outcome outcome;
    BY_LANES(lanes, lane_count, outcome = constraint_pass_rows(at, is_factor_new, inverse_size, lanes));
    return outcome;
}

#endif
