/* matrices.c - solves equations with the transposed Jacobians of the curve's ends as matrices. They are factored, and
 * reused as long as no effect of that shows. */
#include "generating/curve.h"
#include "generating/matrices.h"
#include "algebra/sizes.h"

#include <math.h>
#include <string.h>

static void take(tvi_closure *c, tvi_arena *arena)
{
    const size_t n = (size_t)c->n, width = (size_t)c->curve.width;
    tvi_matrices *taken = tvi_arena_allocate(arena, sizeof *taken), m = {0};
    m.z = tvi_arena_doubles(arena, 2 * n * width);
    m.moved = tvi_arena_doubles(arena, width);
    if (width > 1) m.given = tvi_arena_doubles(arena, 2 * n * 2 * n * width);
    m.G = tvi_arena_doubles(arena, n * 2 * n);
    tvi_factor_allocate(&m.half, arena, c->n);
    tvi_factor_take_several(&m.full, arena, 2 * c->n, c->curve.width);
    if (taken) *taken = m;
    c->solving = taken;
}

static void begin(tvi_closure *c) { matrices_begin(matrices_of(c)); }

static void differentiate(tvi_closure *c, const double z[])
{
    tvi_curve_differentiate(&c->curve);
    matrices_take(c, z);
}

/* ---- The equations ----------------------------------------------------------------------------------------------- */

static tvi_status factor_half(tvi_closure *c, const tvi_transposed *a)
{
    const size_t n = (size_t)c->n, first = a->half == TVI_FIRST ? 0 : n;
    tvi_matrices *m = matrices_of(c);
    tvi_curve_sum_jacobian(&c->curve, a->first, m->G);
    for (size_t i = 0; i < n; i++) memcpy(m->half.lu + i * n, m->G + i * 2 * n + first, n * sizeof(double));
    return tvi_factor_compute(&m->half);
}

static tvi_status factor_full(tvi_closure *c, const tvi_transposed *a)
{
    tvi_matrices *m = matrices_of(c);
    matrices_join(c, a->first, a->second, m->full.lu);
    return tvi_factor_compute(&m->full);
}

/* Computes D_other -= J_other^T x. */
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
    tvi_matrices *m = matrices_of(c);
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

static bool jacobian(tvi_closure *c, double matrix[]) { return matrices_jacobian(c, matrix); }

/* ---- The corrections --------------------------------------------------------------------------------------------- */

static tvi_status close_equations(tvi_closure *c, const double z[], const double scale[], tvi_stats *stats)
{
    const long long moves = -1;
    long long is_due;
    matrices_find_due(c, z, scale, &moves, &is_due);
    if (is_due) {
        differentiate(c, z);
        stats->factorisations++;
    }
    return c->close(c);
}

const tvi_solver tvi_by_matrices = {take, begin, close_equations, solve, jacobian, NULL};
