/* matrices.c - equations with the transposed Jacobians of the curve's ends where these are matrices: they are factored,
 * and serve as long as that shows nowhere. */
#include "generating/closure.h"
#include "algebra/sizes.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* What reused Jacobians may do to the state, relative to it: well below the roundoff of a step. */
static const double STALE = DBL_EPSILON / 16;

/* The corrector's Jacobian serves passes that contract this well or nearly: those before it have gone farther. */
static const double NEAR = 1e-4;

/* The Jacobians of the curve, and what is made of them. They are counted as they are taken, from 0 in each step: what
 * is of the last ones is valid. */
typedef struct {
    double *z;       /* [2n] where they were taken */
    int taken;       /* how often, in this step */
    int factored;    /* the factor is of these */
    bool is_given;   /* the corrector has one, */
    double moved;    /* from which z has moved so far, relative to its size, before the last ones were taken */
    double *G;       /* [n][2n] scratch for Jacobians of the ends */
    tvi_factor half; /* n x n, or */
    tvi_factor full; /* 2n x 2n: a generating function has one of them */
} matrices;

static matrices *matrices_of(const tvi_closure *c) { return c->solving; }

static void take(tvi_closure *c, tvi_arena *arena)
{
    const size_t n = (size_t)c->n;
    matrices *taken = tvi_arena_take(arena, sizeof *taken), m = {0};
    m.z = tvi_arena_doubles(arena, 2 * n);
    m.G = tvi_arena_doubles(arena, n * 2 * n);
    tvi_factor_take(&m.half, arena, c->n);
    tvi_factor_take(&m.full, arena, 2 * c->n);
    if (taken) *taken = m;
    c->solving = taken;
}

static void begin(tvi_closure *c)
{
    matrices *m = matrices_of(c);
    m->taken = m->factored = 0;
    m->is_given = false;
}

static void differentiate(tvi_closure *c, const double z[])
{
    tvi_curve_differentiate(&c->curve);
    memcpy(matrices_of(c)->z, z, 2 * (size_t)c->n * sizeof *z);
    matrices_of(c)->taken++;
}

/* ---- The equations ----------------------------------------------------------------------------------------------- */

static tvi_status factor_half(tvi_closure *c, const tvi_transposed *a)
{
    const size_t n = (size_t)c->n, first = a->half == TVI_FIRST ? 0 : n;
    matrices *m = matrices_of(c);
    tvi_curve_sum_jacobian(&c->curve, a->first, m->G);
    for (size_t i = 0; i < n; i++) memcpy(m->half.lu + i * n, m->G + i * 2 * n + first, n * sizeof(double));
    return tvi_factor_compute(&m->half);
}

static tvi_status factor_full(tvi_closure *c, const tvi_transposed *a)
{
    const size_t n = (size_t)c->n;
    matrices *m = matrices_of(c);
    tvi_curve_sum_jacobian(&c->curve, a->first, m->full.lu);
    tvi_curve_sum_jacobian(&c->curve, a->second, m->full.lu + 2 * n * n);
    return tvi_factor_compute(&m->full);
}

/* D_other -= J_other^T x. */
static void take_other_half(tvi_closure *c, const tvi_transposed *a)
{
    const size_t n = (size_t)c->n, solved = a->half == TVI_FIRST ? 0 : n, other = n - solved;
    double *G = matrices_of(c)->G;
    tvi_curve_sum_jacobian(&c->curve, a->first, G);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) c->D[other + j] -= c->D[solved + i] * G[i * 2 * n + other + j];
}

static tvi_status solve(tvi_closure *c, const tvi_transposed *a)
{
    matrices *m = matrices_of(c);
    tvi_curve_pull(&c->curve, c->seed_Q, c->seed_U, c->D);
    if (m->factored != m->taken) {
        m->factored = m->taken;
        const tvi_status status = a->second ? factor_full(c, a) : factor_half(c, a);
        if (status != TVI_OK) return status;
    }
    if (a->second) {
        tvi_factor_solve_transposed(&m->full, c->D);
    } else {
        tvi_factor_solve_transposed(&m->half, c->D + (a->half == TVI_FIRST ? 0 : c->n));
        take_other_half(c, a);
    }
    return TVI_OK;
}

static bool jacobian(tvi_closure *c, double matrix[])
{
    matrices *m = matrices_of(c);
    if (m->is_given && m->moved <= NEAR) return false;
    m->is_given = true;
    m->moved = 0;
    tvi_curve_sum_jacobian(&c->curve, &c->q_from, matrix);
    tvi_curve_sum_jacobian(&c->curve, &c->u_from, matrix + 2 * (size_t)c->n * (size_t)c->n);
    return true;
}

/* ---- The corrections --------------------------------------------------------------------------------------------- */

/* sum_k |seed_k| of component i. */
static double seed_size(const tvi_closure *c, const double seed[], int i)
{
    double size = 0;
    for (int k = 0; k <= c->curve.top; k++) size += fabs(seed[k * c->n + i]);
    return size;
}

/* How far z is from where the Jacobians were taken, relative to its size. */
static double distance_of(const tvi_closure *c, const double z[], const double scale[])
{
    const double *z_taken = matrices_of(c)->z;
    double distance = 0;
    for (int i = 0; i < 2 * c->n; i++) distance = tvi_larger(tvi_ratio(fabs(z[i] - z_taken[i]), scale[i]), distance);
    return distance;
}

/* Jacobians that were taken at another z are wrong by about the relative distance to it. They multiply the seeds, which
 * need not be as small as the D_z that they add up to, and the corrections: this bounds what that does to the state,
 * relative to the state. */
static double staleness(tvi_closure *c, double distance, const double scale[])
{
    double part = 0;
    tvi_close_measure(c);
    for (int i = 0; i < c->n; i++) {
        const double of_q = fabs(c->curve.kappa[i]) * seed_size(c, c->seed_U, i), of_p = seed_size(c, c->seed_Q, i);
        part = tvi_larger(tvi_ratio(fabs(c->from_q[i]) + fabs(c->rise_q[i]) + of_q, scale[i]), part);
        part = tvi_larger(tvi_ratio(fabs(c->from_p[i]) + fabs(c->rise_p[i]) + of_p, c->p_size[i]), part);
    }
    return distance * part;
}

static tvi_status close_at(tvi_closure *c, const double z[], bool anew, tvi_stats *stats)
{
    if (anew) {
        differentiate(c, z);
        stats->factorisations++;
    }
    return c->close(c);
}

/* The Jacobians of the first pass serve the later ones as long as that shows nowhere. */
static tvi_status close_equations(tvi_closure *c, const double z[], const double scale[], tvi_stats *stats)
{
    matrices *m = matrices_of(c);
    const bool reuses = m->taken > 0;
    const tvi_status status = close_at(c, z, !reuses, stats);
    if (!reuses) return status;
    const double distance = distance_of(c, z, scale);
    if (status == TVI_OK && !(staleness(c, distance, scale) > STALE)) return status;
    m->moved += distance;
    return close_at(c, z, true, stats);
}

const tvi_solver tvi_by_matrices = {take, begin, close_equations, solve, jacobian, NULL};
