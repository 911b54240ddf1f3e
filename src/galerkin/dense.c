/* dense.c - Evaluates the curve of the last step at other points: at one fraction of the step, or at the samples of a
 * search for events, from the impulses of the step (docs/method.md section 4). The prediction from a step of another
 * size uses the same sums. The table tvi_stepper_galerkin has these functions. */
#include "galerkin/galerkin.h"

/* ---- Sums at points of the curve --------------------------------------------------------------------------------- */

JET_INLINE void evaluate_vectors(const galerkin_curve_points *at, const double *table, const double *L,
                                 double *restrict out, const int lanes, const int points)
{
    for (int v = 0; v < points / NODE_VEC; v++) {
        const node_vec theta = node_load(at->theta, v);
        node_vec row[GALERKIN_MAX_LANES];
        for (int j = 0; j < lanes; j++) row[j] = node_load(table + j * points, v);
        for (int u = 0; u < at->count; u++) {
            node_vec sum[PARTIAL_SUMS] = {0};
            for (int j = 0; j < lanes; j++) sum[j % PARTIAL_SUMS] += row[j] * L[u * lanes + j];
            node_store(out + u * points, v,
                       at->start[u] + (theta * at->move[u] + at->scale[u] * ((sum[0] + sum[1]) + (sum[2] + sum[3]))));
        }
    }
}

JET_INLINE void evaluate_one(const galerkin_curve_points *at, const double *table, const double *L,
                             double *restrict out, const int lanes)
{
    for (int u = 0; u < at->count; u++) {
        double sum[PARTIAL_SUMS] = {0};
        for (int j = 0; j < lanes; j++) sum[j % PARTIAL_SUMS] += table[j] * L[u * lanes + j];
        out[u] = at->start[u] + (at->theta[0] * at->move[u] + at->scale[u] * ((sum[0] + sum[1]) + (sum[2] + sum[3])));
    }
}

void tvi_galerkin_evaluate(const galerkin_curve_points *at, const double *table, const double *L, double *out)
{
    BY_LANES(lanes, at->lane_count, if (at->points == 1) evaluate_one(at, table, L, out, lanes);
             else if (at->points == TVI_SAMPLES) evaluate_vectors(at, table, L, out, lanes, TVI_SAMPLES);
             else evaluate_vectors(at, table, L, out, lanes, lanes));
}

/* ---- The curve of the last step ---------------------------------------------------------------------------------- */

/* Computes x [components][points], the components of the range at the fractions theta of the step: the polynomial of
 * degree m - 1 through the rates, integrated. `integral` [lanes][points] has the integrals of l_j / b_j from 0 to theta
 * (tables.h), or the double integrals for the positions of a separable system. */
static void integrate_impulses(const galerkin_work *work, tvi_component_range range, int points, const double theta[],
                               const double *integral, const double *L, const double *start, const double *move,
                               const double *scale, double *x)
{
    const int lanes = work->step.nodes.lane_count, from = range.first;
    const galerkin_curve_points at = {lanes, points, range.end - from, theta, start + from, move + from, scale + from};
    if (at.count > 0) tvi_galerkin_evaluate(&at, integral, L + from * lanes, x + from * points);
}

/* Computes the components used[0] of q and used[1] of p at the fractions theta of the step, [n][points] each. */
static void evaluate_curve(const galerkin_work *work, const tvi_component_range used[2], int points,
                           const double theta[], const double *single, const double *twice, const double q_start[],
                           const double p_start[], double *q, double *p)
{
    const galerkin_step *step = &work->step;
    const double *L = galerkin_ring_at(step, (int)work->predictor.history->ring_index);
    const double *of_p = L + (step->is_separable ? 0 : work->n * step->nodes.lane_count);
    integrate_impulses(work, used[0], points, theta, step->is_separable ? twice : single, L, q_start, step->move,
                       work->increment_scale, q);
    integrate_impulses(work, used[1], points, theta, single, of_p, p_start, work->predictor.zeros,
                       work->increment_scale + work->n, p);
}

void tvi_galerkin_interpolate(void *self, double theta, double dq[], double dp[])
{
    const galerkin_work *work = self;
    const tvi_component_range all[] = {{0, work->n}, {0, work->n}};
    double single[GALERKIN_MAX_LANES] = {0}, twice[GALERKIN_MAX_LANES] = {0};
    tvi_galerkin_integrate(&work->polynomials, theta, single, twice);
    evaluate_curve(work, all, 1, &theta, single, twice, work->predictor.zeros, work->predictor.zeros, dq, dp);
}

void tvi_galerkin_sample(void *self, const tvi_component_range used[2], const double q_start[], const double p_start[],
                         double *q, double *p)
{
    const galerkin_work *work = self;
    evaluate_curve(work, used, TVI_SAMPLES, tvi_sample_theta, work->polynomials.to_samples,
                   work->polynomials.twice_to_samples, q_start, p_start, q, p);
}

int tvi_galerkin_quadrature(const void *self, double theta[], double b[])
{
    const galerkin_coefficients *coefficients = &((const galerkin_work *)self)->coefficients;
    const size_t bytes = (size_t)coefficients->lane_count * sizeof *theta;
    _Static_assert((int)GALERKIN_MAX_LANES <= (int)TVI_MOST_POINTS, "the nodes have room");
    memcpy(theta, coefficients->c, bytes);
    memcpy(b, coefficients->b, bytes);
    return coefficients->lane_count;
}

/* The table of the integrals up to the nodes is nu, that of the passes. */
void tvi_galerkin_at_nodes(void *self, const double q_start[], const double p_start[], double *q, double *p)
{
    const galerkin_work *work = self;
    const galerkin_coefficients *at = &work->coefficients;
    const tvi_component_range used[] = {{0, work->n}, {0, work->step.is_separable ? 0 : work->n}};
    evaluate_curve(work, used, at->lane_count, at->c, at->nu, at->nu, q_start, p_start, q, p);
}

/* The polynomial through the forces is sum_j l_j F_j, with h b_j F_j = L_j. Legendre's polynomials are 1 at the end of
 * a step, and 1 or -1 at its start. */
int tvi_galerkin_curve_forces(const void *self, double *forces)
{
    const galerkin_work *work = self;
    const galerkin_step *step = &work->step;
    const int nodes = step->nodes.node_count, lanes = step->nodes.lane_count, n = work->n;
    const double *L = galerkin_ring_at(step, (int)work->predictor.history->ring_index);
    for (int i = 0; i < n; i++) {
        const double *row = L + (step->is_separable ? i : n + i) * lanes,
                     sign = step->is_separable ? 1 : step->nodes.scale[n + i];
        double *force = forces + i * TVI_FORCE_POINTS;
        force[0] = force[1] = 0;
        for (int j = 0; j < nodes; j++) {
            double at_start = 0, at_end = 0;
            for (int k = 0; k < nodes; k++) {
                const double factor = work->polynomials.legendre_factor[k * nodes + j];
                at_end += factor;
                at_start += k % 2 ? -factor : factor;
            }
            force[0] += sign * at_start * row[j] / step->h;
            force[1] += sign * at_end * row[j] / step->h;
            force[2 + j] = sign * row[j] / step->nodes.hb[j];
        }
    }
    return 2 + nodes;
}
