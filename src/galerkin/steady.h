/* steady.h - steps in one function, with every size a constant, which generated code has (emitted_loops.h): those whose
 * passes end at the goal. It predicts those that begin where the last one of their size ended; galerkin.c predicts the
 * others, and makes all that are not made here. */
#ifndef TVI_SRC_GALERKIN_STEADY_H
#define TVI_SRC_GALERKIN_STEADY_H

#include "algebra/passes.h"
#include "galerkin/loops.h"
#include "vector.h"

/* Of so many components the state is in registers from one step of a row to the next. */
enum { GALERKIN_OWN = 3 };

/* What all steps of an integrator share. */
typedef struct galerkin_frame {
    const galerkin_nodes *nodes;
    const galerkin_motion *motion;
    const galerkin_weights *weights;
    const tvi_passes_rule *rule;
    const double *matrix, *c;
    double *const *extrapolation; /* [GALERKIN_FITS] the tables of predictor.h */
    const double *rough;
    double *drift, *drift_low, *share, *ratio;
    const double *h;
    void *own;            /* of the form of the field: lagrangian_passes of a Lagrangian */
    const double *folded; /* folded.h */
} galerkin_frame;

/* The last step, and the size of its last movement. */
typedef struct {
    int count;   /* of passes */
    int factors; /* so often were second derivatives at the nodes taken */
    double size, tail;
    galerkin_pace pace;
} galerkin_trial;

/* What steps made, but for what they added to the state. */
typedef struct galerkin_outcome {
    double *const *impulses; /* [GALERKIN_TURNS] of the last step here, and of the next one behind it */
    int turn;
    int known;                  /* of this size were the last one, 1, and the one before it, 2; or none, 0, and
                                         the first one's unknowns are those of the frame's nodes; else: */
    bool leads;                 /* behind those of the last one is what the next one begins with */
    double t;                   /* where the last one began */
    galerkin_trial last, tried; /* the last one, and the one after it where that was not made */
    long count, factors;        /* of all steps */
    double largest_tail;        /* of these, and of those before */
} galerkin_outcome;

/* |start| + |predicted end - start|. */
static inline double galerkin_size(const galerkin_nodes *nodes, int u)
{
    const double start = nodes->start[u], end = nodes->x[(u + 1) * nodes->lanes - 1];
    return fabs(start) + fabs(end - start);
}

static inline double galerkin_least(double largest)
{
    const double share = TVI_GALERKIN_LEAST_SHARE * largest;
    return share > 0 ? share : 1;
}

/* Sizes in a subsystem; member: its components, or NULL: all that there are. Where masses are known, a momentum that
 * is small as its body is light is not small beside the others: it is measured by how far it moves its coordinate. No
 * branches: which is the larger changes from step to step. */
static inline void galerkin_set_sizes_of(const galerkin_nodes *nodes, int n, const int *member, int first, int end)
{
    const bool has_momenta = nodes->unknowns > n;
    double *of_q = nodes->inverse_size, *of_p = of_q + n, largest_q = 0, largest_p = 0;
    for (int k = first; k < end; k++) {
        const int i = member ? member[k] : k;
        of_q[i] = galerkin_size(nodes, i);
        largest_q = tvi_larger(of_q[i], largest_q);
    }
    for (int k = first; k < end && has_momenta; k++) {
        const int i = member ? member[k] : k;
        of_p[i] = galerkin_size(nodes, n + i);
        largest_p = tvi_larger(of_p[i], largest_p);
    }
    const double least_q = galerkin_least(largest_q), least_p = galerkin_least(largest_p);
    for (int k = first; k < end && has_momenta; k++) {
        const int i = member ? member[k] : k;
        of_p[i] = 1 / (of_p[i] + tvi_smaller(nodes->per_movement[i] * least_q, least_p));
    }
    for (int k = first; k < end; k++) {
        const int i = member ? member[k] : k;
        of_q[i] = 1 / (of_q[i] + least_q);
    }
}

/* What movements are measured by. */
static inline void galerkin_set_sizes(const galerkin_nodes *nodes, int n)
{
    const tvi_subsystems parts = nodes->parts;
    if (parts.count == 1) galerkin_set_sizes_of(nodes, n, NULL, 0, n);
    for (int k = 0, first = 0; parts.count > 1 && k < parts.count; first = parts.end[k++])
        galerkin_set_sizes_of(nodes, n, parts.member, first, parts.end[k]);
}

/* The tail of a step in a row need be known only where it is larger than this; the roundoff of the comparison is on the
 * safe side. */
static inline double galerkin_known_tail(const tvi_row *row, const galerkin_outcome *to)
{
    return (1 - 8 * DBL_EPSILON) * tvi_smaller(to->largest_tail, row->sure.tail);
}

/* Whether the tail is at most so large, as no component's ratio is larger: without divisions; false where it is not
 * known. No branches: vectors. */
static inline bool galerkin_tail_is_at_most(const galerkin_motion *of, double most)
{
    const size_t n = (size_t)of->n, momenta = of->is_separable ? 0 : n;
    const double *last = of->sums.last;
    int holds = most > 0;
    for (size_t i = 0; i < n; i++) {
        holds &= last[i + momenta] <= most * galerkin_momentum(of, i, i + momenta);
        if (!of->is_separable) holds &= last[i] <= most * galerkin_movement(of, i);
    }
    return holds;
}

/* Of equations of first order. */
static inline void galerkin_end(const galerkin_nodes *nodes, const galerkin_sums *sums, int n, const tvi_increments *by)
{
    for (int i = 0; i < n; i++) {
        by->dq[i] = nodes->scale[i] * sums->once[i];
        by->dq_low[i] = nodes->scale[i] * sums->once_low[i];
        by->dp[i] = nodes->scale[n + i] * sums->once[n + i];
        by->dp_low[i] = nodes->scale[n + i] * sums->once_low[n + i];
    }
}

static inline bool galerkin_sums_are_finite(int count, const double *x, const double *dx)
{
    uint64_t any = 0;
    for (int i = 0; i < count; i++) any |= tvi_bits_of_infinite(x[i] + dx[i]);
    return any == 0;
}

/* What tvi_add_compensated does, of two. */
static inline void galerkin_add_two(double *x, double *low, const double *d, const double *d_low)
{
    const jet_v2 a = *(const jet_v2 *)x, l = *(const jet_v2 *)low, e = *(const jet_v2 *)d;
    const jet_v2 small = l + e, of_e = small - l, rest = (l - (small - of_e)) + (e - of_e);
    const jet_v2 sum = a + small, of_small = sum - a;
    *(jet_v2 *)low = ((a - (sum - of_small)) + (small - of_small)) + (rest + *(const jet_v2 *)d_low);
    *(jet_v2 *)x = sum;
}

/* Numbers that are in registers stay there. */
static inline void galerkin_add(int count, double *x, double *low, const double *d, const double *d_low)
{
    if (count > GALERKIN_OWN + 1) {
        (void)tvi_add_all_compensated(count, x, low, d, d_low);
        return;
    }
    int i = 0;
    for (; i + 2 <= count; i += 2) galerkin_add_two(x + i, low + i, d + i, d_low + i);
    if (i < count) x[i] = tvi_add_compensated(x[i], &low[i], d[i], d_low[i]);
}

/* Adds the step to the state; false where it is not sure, or not finite. */
static inline bool galerkin_advance(int n, const tvi_row *row, const tvi_run_state *now, const galerkin_trial *tried)
{
    if (!(tried->tail <= row->sure.tail && tried->count <= row->sure.passes)) return false;
    if (!tvi_row_is_in_time(row, now->q)) return false;
    if (!galerkin_sums_are_finite(n + 1, now->q, row->by.dq)) return false;
    if (!galerkin_sums_are_finite(n, now->p, row->by.dp)) return false;
    galerkin_add(n + 1, now->q, now->q_low, row->by.dq, row->by.dq_low);
    galerkin_add(n, now->p, now->p_low, row->by.dp, row->by.dp_low);
    return true;
}

#endif
