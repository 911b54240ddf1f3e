/* action.c - the gradient of the discrete action, as seeds for the gradient of the curve.
 *
 * With w_i the weights in scaled time and e_r = sum_i w_i s_i^r - integral of s^r the error of the quadrature,
 *     D_z = sum_i w_i tau [ (dq_i/dz)^T F(q_i, t_i) - (dg_i/dz)^T M g''_i / tau^2 ]
 *         + 1/tau sum_{j,k} j (j+k-1) e_{j+k-2} (dC_k/dz)^T M C_j .
 * The last sum is what summation by parts of (g'^T M dg)' leaves when the quadrature is not exact to degree 2N - 2 (the
 * paper's rectangle and trapezoid): with it, every quadrature serves every degree. */
#include "action.h"
#include "quadrature.h"

#include <math.h>

/* Whether some term of the kinetic energy, of degree up to 2N - 2, is not integrated exactly. */
static bool has_kinetic_error(const tvi_options *options)
{
    return tvi_quadrature_order(options->quadrature, options->quadrature_points) < 2 * options->degree - 1;
}

void tvi_action_take(tvi_action *action, tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    const size_t orders = (size_t)options->degree + 1, points = (size_t)options->quadrature_points;
    action->degree = options->degree;
    action->points = options->quadrature_points;
    action->s = tvi_arena_doubles(arena, points);
    action->weight = tvi_arena_doubles(arena, points);
    action->power = tvi_arena_doubles(arena, orders * points);
    action->node_power = tvi_arena_doubles(arena, orders * points);
    action->kinetic = has_kinetic_error(options) ? tvi_arena_doubles(arena, orders * orders) : NULL;
    action->x = tvi_arena_doubles(arena, (size_t)system->force_values->slots * points);
    action->defect = tvi_arena_doubles(arena, (size_t)system->n * points);
    action->curvature = tvi_arena_doubles(arena, points);
}

/* The error of the quadrature for s^r on the span; exactly 0 below its order. */
static double quadrature_error(int order, int points, const long double s[], const long double weight[], int r, tvi_span span)
{
    if (r < order) return 0;
    long double error = -(powl(span.to, r + 1) - powl(span.from, r + 1)) / (r + 1);
    for (int i = 0; i < points; i++) error += weight[i] * powl(s[i], r);
    return (double)error;
}

enum { POINTS_MAX = TVI_MAX_DEGREE + 2 };

void tvi_action_prepare(tvi_action *action, const tvi_system *system, const tvi_options *options, tvi_span span)
{
    const int N = action->degree, points = action->points;
    const int order = tvi_quadrature_order(options->quadrature, points);
    long double s[POINTS_MAX], weight[POINTS_MAX];
    tvi_quadrature_nodes(options->quadrature, points, s, weight);
    for (int i = 0; i < points; i++) { /* from [-1, 1] to the span */
        s[i] = span.from + (span.to - span.from) * (1 + s[i]) / 2;
        weight[i] *= (span.to - span.from) / 2;
        action->s[i] = (double)s[i];
        action->weight[i] = (double)weight[i];
        const bool at_end = action->s[i] == span.from || action->s[i] == span.to;
        for (int k = 0; k <= N; k++) {
            const double power = (double)powl(s[i], k);
            const bool left_out = options->nodes == TVI_NODES_TRUNCATED && k == N && !at_end;
            action->power[k * points + i] = power;
            action->node_power[k * points + i] = left_out ? 0 : power;
        }
    }
    for (int j = 0; action->kinetic && j <= N; j++)
        for (int k = 0; k <= N; k++)
            action->kinetic[j * (N + 1) + k] =
                j * k == 0 ? 0 : j * (j + k - 1) * quadrature_error(order, points, s, weight, j + k - 2, span);
    jet_tape_prepare(system->force_values, action->x, 1, points);
}

/* The inputs of the force at all nodes, a lane each. */
static void place_nodes(tvi_action *action, const tvi_curve *curve)
{
    const int points = action->points, n = curve->n;
    for (int i = 0; i < n; i++) {
        double *q = action->x + i * points;
        for (int node = 0; node < points; node++) q[node] = 0;
        for (int k = action->degree; k >= 0; k--) {
            const double C = tvi_curve_coefficient(curve, k)[i];
            const double *power = action->node_power + k * points;
            for (int node = 0; node < points; node++) q[node] += C * power[node];
        }
    }
    if (!curve->system->uses_time) return;
    double *t = action->x + n * points;
    for (int node = 0; node < points; node++) t[node] = curve->centre + curve->tau * action->s[node];
}

/* curvature[node] = g''_i(s), the second derivative in scaled time. */
static void curvature_at_nodes(tvi_action *action, const tvi_curve *curve, int i)
{
    const int points = action->points;
    for (int node = 0; node < points; node++) action->curvature[node] = 0;
    for (int k = action->degree; k >= 2; k--) {
        const double C = k * (k - 1) * tvi_curve_coefficient(curve, k)[i];
        const double *power = action->power + (k - 2) * points;
        for (int node = 0; node < points; node++) action->curvature[node] += C * power[node];
    }
}

/* seed_k of component i from the defect at the nodes. Where a truncated node leaves s^N out of q_i, F does not see C_N. */
static void component_seed(tvi_action *action, const tvi_curve *curve, int i, double seed[])
{
    const jet_tape *tape = curve->system->force_values;
    const int points = action->points, N = action->degree, n = curve->n;
    const double *F = action->x + (size_t)tape->output[i] * (size_t)points;
    const double inertia = curve->system->mass[i] / (curve->tau * curve->tau);
    double *defect = action->defect + i * points;
    curvature_at_nodes(action, curve, i);
    for (int node = 0; node < points; node++)
        defect[node] = action->weight[node] * curve->tau * (F[node] - inertia * action->curvature[node]);
    for (int k = 0; k <= N; k++) {
        double sum = 0;
        for (int node = 0; node < points; node++) sum += action->power[k * points + node] * defect[node];
        seed[k * n + i] = sum;
    }
    for (int node = 0; node < points; node++)
        seed[N * n + i] -= action->weight[node] * curve->tau * F[node] *
                           (action->power[N * points + node] - action->node_power[N * points + node]);
}

static void add_kinetic_error(const tvi_action *action, const tvi_curve *curve, double seed[])
{
    const int N = action->degree, n = curve->n;
    for (int j = 1; j <= N; j++)
        for (int k = 1; k <= N; k++) {
            const double error = action->kinetic[j * (N + 1) + k] / curve->tau;
            const double *C = tvi_curve_coefficient(curve, j);
            for (int i = 0; error != 0 && i < n; i++) seed[k * n + i] += error * curve->system->mass[i] * C[i];
        }
}

tvi_status tvi_action_seed(tvi_action *action, const tvi_curve *curve, double seed[])
{
    place_nodes(action, curve);
    if (!jet_sweep_values(curve->system->force_values, action->x, action->points)) return TVI_EDOMAIN;
    for (int i = 0; i < curve->n; i++) component_seed(action, curve, i, seed);
    if (action->kinetic) add_kinetic_error(action, curve, seed);
    for (int i = 0; i < (action->degree + 1) * curve->n; i++)
        if (!isfinite(seed[i])) return TVI_ENONFINITE;
    return TVI_OK;
}
