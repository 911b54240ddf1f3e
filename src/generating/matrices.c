/* matrices.c - solves A^T x = D_z for the corrections of the curve's ends, with D_z the gradient of the discrete action
 * in defect form (action.h) and A made of Jacobian matrices of the ends. It factors them, and reuses the factors as
 * long as the resulting error is below roundoff. step.c calls it through tvi_solver_by_matrices. */
#include "generating/corrected.h"

#include <string.h>

/* [1] The corrector's Jacobian serves until z has moved by this part: passes then contract by about this factor. */
#define MATRICES_MAX_MOVEMENT 1e-4 /* found: make check-generating */

typedef struct {
    double *z;          /* [2n] the state z at which the Jacobians of the curve were last computed */
    bool has_jacobians; /* whether they were computed in this step, and A factored */
    bool has_J;         /* whether the corrector's Jacobian J = d(q-, u-)/dz was computed in this step */
    double moved;       /* how far z has moved since J was computed, relative to the size of z */
    double *G;          /* [n][2n] the Jacobian J of equations.upper_sum, if there is no lower_sum */
    tvi_lu_factor A;    /* the factors of A: n x n, or 2n x 2n */
} tvi_matrices;

static void allocate(tvi_corrected_curve *c, tvi_arena *arena)
{
    const int n = c->curve.n;
    tvi_matrices *allocated = tvi_arena_allocate(arena, sizeof *allocated), m = {0};
    m.z = tvi_arena_allocate_doubles(arena, 2 * (size_t)n);
    m.G = tvi_arena_allocate_doubles(arena, (size_t)n * 2 * (size_t)n);
    tvi_factor_allocate(&m.A, arena, c->definition->equations.lower_sum ? 2 * n : n);
    if (allocated) *allocated = m;
    c->solver_memory = allocated;
}

static void begin(tvi_corrected_curve *c)
{
    tvi_matrices *m = c->solver_memory;
    m->has_jacobians = m->has_J = false;
}

/* Writes the Jacobians of two sums, one above the other: [2n][2n]. */
static void stack_jacobians(const tvi_corrected_curve *c, tvi_end_sum upper, tvi_end_sum lower, double matrix[])
{
    const int n = c->curve.n;
    tvi_series_sum_compute_jacobian(&c->curve, &c->ends[upper], matrix);
    tvi_series_sum_compute_jacobian(&c->curve, &c->ends[lower], matrix + 2 * n * n);
}

/* Computes J for the corrector. Returns false, and computes nothing, if it can reuse that of an earlier pass of this
 * step: z has not moved far since. */
static bool compute_J(const tvi_corrected_curve *c, double J[])
{
    tvi_matrices *m = c->solver_memory;
    if (m->has_J && !(m->moved > MATRICES_MAX_MOVEMENT)) return false;
    stack_jacobians(c, TVI_Q_START, TVI_U_START, J);
    m->moved = 0;
    m->has_J = true;
    return true;
}

/* ---- When the Jacobians are due ---------------------------------------------------------------------------------- */

/* Returns how far z is from the point where the Jacobians were computed, relative to the size of z. */
static double distance_from_jacobians(const tvi_corrected_curve *c, const double z[], const double scale[])
{
    const tvi_matrices *m = c->solver_memory;
    double distance = 0;
    for (int i = 0; i < 2 * c->curve.n; i++)
        distance = tvi_larger(tvi_ratio_or_zero(fabs(z[i] - m->z[i]), scale[i]), distance);
    return distance;
}

/* Returns a bound of the relative error that old Jacobians cause in the state, divided by the relative distance of z
 * from the point where they were computed. The relative error of an old Jacobian is about this distance. It multiplies
 * the corrections of the ends and the seeds, which may be much larger than the D_z that they add up to. */
static double error_per_distance(const tvi_corrected_curve *c, const double scale[])
{
    const tvi_curve *curve = &c->curve;
    const int n = curve->n;
    const bool has_U = curve->system->form != TVI_SEPARABLE;
    double error = 0;
    corrected_compute_p_size(c);
    for (int i = 0; i < n; i++) {
        double seeds_Q = 0, seeds_U = 0;
        for (int k = 0; k <= curve->highest_order; k++) {
            seeds_Q += fabs(c->seed_Q[k * n + i]);
            if (has_U) seeds_U += fabs(c->seed_U[k * n + i]);
        }
        const double of_q = fabs(c->start_correction_q[i]) + fabs(c->increment_correction_q[i]) +
                            fabs(curve->kappa[i]) * seeds_U,
                     of_p = fabs(c->start_correction_p[i]) + fabs(c->increment_correction_p[i]) + seeds_Q;
        error = tvi_larger(tvi_ratio_or_zero(of_q, scale[i]), error);
        error = tvi_larger(tvi_ratio_or_zero(of_p, c->p_size[i]), error);
    }
    return error;
}

/* Tells whether the Jacobians must be computed anew at z. The first pass computes them. Later passes reuse them as long
 * as the bound of the resulting error, estimated from the corrections of the last pass, is below roundoff. */
static bool are_jacobians_due(const tvi_corrected_curve *c, const double z[], const double scale[])
{
    tvi_matrices *m = c->solver_memory;
    if (!m->has_jacobians) return true;
    const double distance = distance_from_jacobians(c, z, scale);
    if (distance * error_per_distance(c, scale) <= CURVE_NEGLIGIBLE_ERROR) return false;
    m->moved += distance;
    return true;
}

/* ---- The equations ----------------------------------------------------------------------------------------------- */

static tvi_status factor_A(const tvi_corrected_curve *c)
{
    const tvi_end_equations *equations = &c->definition->equations;
    const size_t n = (size_t)c->curve.n, first = equations->takes_last_columns_of_J ? n : 0;
    tvi_matrices *m = c->solver_memory;
    if (equations->lower_sum) {
        stack_jacobians(c, equations->upper_sum, equations->lower_sum, m->A.lu);
    } else {
        tvi_series_sum_compute_jacobian(&c->curve, &c->ends[equations->upper_sum], m->G);
        for (size_t i = 0; i < n; i++) memcpy(m->A.lu + i * n, m->G + i * 2 * n + first, n * sizeof(double));
    }
    return tvi_factor_compute(&m->A);
}

static tvi_status solve_end_equations(tvi_corrected_curve *c, const double z[], const double scale[], tvi_stats *stats)
{
    const tvi_end_equations *equations = &c->definition->equations;
    const size_t n = (size_t)c->curve.n, solved = equations->takes_last_columns_of_J ? n : 0, other = n - solved;
    tvi_matrices *m = c->solver_memory;
    if (are_jacobians_due(c, z, scale)) {
        tvi_curve_compute_jacobians(&c->curve);
        memcpy(m->z, z, 2 * n * sizeof *z);
        m->has_jacobians = true;
        stats->factorisations++;
        const tvi_status status = factor_A(c);
        if (status != TVI_OK) return status;
    }
    tvi_curve_multiply_seeds(&c->curve, c->seed_Q, c->seed_U, c->D_z);
    tvi_factor_solve_transposed(&m->A, c->D_z + solved);
    if (equations->lower_sum) return TVI_OK;
    /* The other half of D_z becomes D_z - K^T x, with K the other half of the Jacobian. */
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) c->D_z[other + j] -= c->D_z[solved + i] * m->G[i * 2 * n + other + j];
    return TVI_OK;
}

const tvi_end_solver tvi_solver_by_matrices = {allocate, begin, solve_end_equations, compute_J, NULL};
