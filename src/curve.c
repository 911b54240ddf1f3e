/* curve.c - the Euler-Lagrange equations M q'' = F(q, t) as a recurrence for the coefficients of the curve
 * (docs/method.md section 2):  (k+1)(k+2) C_{k+2} = tau^2 M^-1 [s^k] F(g(s), centre + tau s). */
#include "curve.h"

#include <math.h>
#include <string.h>

enum { CURVE_LANES = 8 }; /* directions of one tangent sweep: few enough to stay in the cache */

static size_t slots(const tvi_curve *curve) { return (size_t)curve->system->force_series->slots; }

static int block_lanes(const tvi_curve *curve) { return 2 * curve->n < CURVE_LANES ? 2 * curve->n : CURVE_LANES; }

void tvi_curve_take(tvi_curve *curve, tvi_arena *arena, const tvi_system *system, int degree, bool with_jacobians)
{
    const size_t orders = (size_t)degree + 1, n = (size_t)system->n;
    curve->system = system;
    curve->n = system->n;
    curve->degree = degree;
    curve->x = tvi_arena_doubles(arena, orders * slots(curve));
    curve->dx = with_jacobians ? tvi_arena_doubles(arena, orders * slots(curve) * (size_t)block_lanes(curve)) : NULL;
    curve->dC = with_jacobians ? tvi_arena_doubles(arena, orders * n * 2 * n) : NULL;
}

void tvi_curve_prepare(tvi_curve *curve)
{
    jet_tape_prepare(curve->system->force_series, curve->x, curve->degree + 1, 1);
}

tvi_status tvi_curve_expand(tvi_curve *curve, double centre, double tau)
{
    const tvi_system *system = curve->system;
    const jet_tape *tape = system->force_series;
    const int n = curve->n;
    curve->centre = centre;
    curve->tau = tau;
    if (system->uses_time) {
        curve->x[n] = centre;
        if (curve->degree > 0) tvi_curve_coefficient(curve, 1)[n] = tau;
    }
    for (int k = 0; k + 2 <= curve->degree; k++) {
        if (!jet_sweep_series(tape, curve->x, k, 1)) return TVI_EDOMAIN;
        const double *force = tvi_curve_coefficient(curve, k);
        double *next = tvi_curve_coefficient(curve, k + 2);
        const double factor = tau * tau / ((k + 1) * (k + 2));
        for (int i = 0; i < n; i++) next[i] = factor / system->mass[i] * force[tape->output[i]];
    }
    for (int k = 0; k <= curve->degree; k++)
        for (int i = 0; i < n; i++)
            if (!isfinite(tvi_curve_coefficient(curve, k)[i])) return TVI_ENONFINITE;
    return TVI_OK;
}

/* dC_k along the directions first .. first + lanes - 1 of z. */
static void differentiate_block(tvi_curve *curve, int first, int lanes)
{
    const tvi_system *system = curve->system;
    const jet_tape *tape = system->force_series;
    const int n = curve->n;
    const size_t width = (size_t)lanes, order = slots(curve) * width;
    memset(curve->dx, 0, 2 * order * sizeof *curve->dx);
    for (int lane = 0; lane < lanes; lane++) {
        const int direction = first + lane;
        double *unit = direction < n ? curve->dx : curve->dx + order;
        unit[(size_t)(direction % n) * width + (size_t)lane] = 1;
    }
    for (int k = 0; k + 2 <= curve->degree; k++) {
        jet_sweep_tangents(tape, curve->x, curve->dx, k, lanes);
        const double *dF = curve->dx + (size_t)k * order;
        double *next = curve->dx + (size_t)(k + 2) * order;
        const double factor = curve->tau * curve->tau / ((k + 1) * (k + 2));
        for (int i = 0; i < n; i++)
            for (size_t lane = 0; lane < width; lane++)
                next[(size_t)i * width + lane] =
                    factor / system->mass[i] * dF[(size_t)tape->output[i] * width + lane];
        if (system->uses_time) memset(next + (size_t)n * width, 0, width * sizeof *next);
    }
    for (int k = 0; k <= curve->degree; k++)
        for (int i = 0; i < n; i++)
            memcpy(curve->dC + (size_t)((k * n + i) * 2 * n + first), curve->dx + (size_t)k * order + (size_t)i * width,
                   width * sizeof *curve->dC);
}

void tvi_curve_differentiate(tvi_curve *curve)
{
    const int directions = 2 * curve->n;
    for (int first = 0; first < directions; first += CURVE_LANES) {
        const int left = directions - first;
        differentiate_block(curve, first, left < CURVE_LANES ? left : CURVE_LANES);
    }
}

void tvi_curve_sum(const tvi_curve *curve, const double weight[], double out[])
{
    memset(out, 0, (size_t)curve->n * sizeof *out);
    for (int k = curve->degree; k >= 0; k--) {
        if (weight[k] == 0) continue;
        const double *C = tvi_curve_coefficient(curve, k);
        for (int i = 0; i < curve->n; i++) out[i] += weight[k] * C[i];
    }
}

void tvi_curve_sum_jacobian(const tvi_curve *curve, const double weight[], double matrix[])
{
    const size_t size = 2 * (size_t)curve->n * (size_t)curve->n;
    memset(matrix, 0, size * sizeof *matrix);
    for (int k = curve->degree; k >= 0; k--) {
        if (weight[k] == 0) continue;
        const double *dC = curve->dC + (size_t)k * size;
        for (size_t i = 0; i < size; i++) matrix[i] += weight[k] * dC[i];
    }
}

void tvi_curve_push(const tvi_curve *curve, const double weight[], const double dz[], double out[])
{
    const int n = curve->n, directions = 2 * n;
    memset(out, 0, (size_t)n * sizeof *out);
    for (int k = curve->degree; k >= 0; k--) {
        if (weight[k] == 0) continue;
        const double *dC = curve->dC + (size_t)(k * n * directions);
        for (int i = 0; i < n; i++) {
            double sum = 0;
            for (int d = 0; d < directions; d++) sum += dC[i * directions + d] * dz[d];
            out[i] += weight[k] * sum;
        }
    }
}

void tvi_curve_pull(const tvi_curve *curve, const double seed[], double out[])
{
    const int directions = 2 * curve->n, rows = (curve->degree + 1) * curve->n;
    memset(out, 0, (size_t)directions * sizeof *out);
    for (int row = rows - 1; row >= 0; row--)
        for (int d = 0; d < directions; d++) out[d] += seed[row] * curve->dC[(size_t)row * (size_t)directions + (size_t)d];
}
