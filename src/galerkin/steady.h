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

/* 1 / (|start| + |predicted end - start|). No branches: which is the larger changes from step to step. */
static inline void galerkin_set_sizes(const galerkin_nodes *nodes, int n)
{
    const double *last = nodes->x + nodes->lanes - 1;
    for (int first = 0; first < nodes->unknowns; first += n) {
        double largest = 0;
        for (int u = first; u < first + n; u++) {
            const double start = nodes->start[u], size = fabs(start) + fabs(last[u * nodes->lanes] - start);
            nodes->inverse_size[u] = size;
            largest = tvi_larger(size, largest);
        }
        const double share = TVI_GALERKIN_LEAST_SHARE * largest, least = share > 0 ? share : 1;
        for (int u = first; u < first + n; u++) nodes->inverse_size[u] = 1 / (nodes->inverse_size[u] + least);
    }
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
    const size_t n = (size_t)of->n, momenta = of->has_masses ? 0 : n;
    const double *last = of->sums.last;
    int holds = most > 0;
    for (size_t i = 0; i < n; i++) {
        holds &= last[i + momenta] <= most * galerkin_momentum(of, i, i + momenta);
        if (!of->has_masses) holds &= last[i] <= most * galerkin_movement(of, i);
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
