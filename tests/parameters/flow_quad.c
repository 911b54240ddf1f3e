/* flow_quad.c - Implements flow_quad.h: the classical Runge-Kutta method with very small steps. */
#include "flow_quad.h"

#include <quadmath.h>

typedef __float128 quad;
enum { D = 4, STEPS = 20000 };

/* V = r^4 / 8 - k / r + m x^2 y, with T = (a^2 + b^2) / 2, times 1 + m y^2 of the Hamiltonian. */
static void field(int is_hamiltonian, const quad parameter[], const quad x[D], quad out[D])
{
    const quad k = parameter[0], m = parameter[1], r = sqrtq(x[0] * x[0] + x[1] * x[1]), r3 = r * r * r;
    const quad factor = is_hamiltonian ? 1 + m * x[1] * x[1] : 1, T = (x[2] * x[2] + x[3] * x[3]) / 2;
    out[0] = factor * x[2];
    out[1] = factor * x[3];
    out[2] = -(k / r3 + r * r / 2) * x[0] - 2 * m * x[0] * x[1];
    out[3] = -(k / r3 + r * r / 2) * x[1] - m * x[0] * x[0] - (is_hamiltonian ? 2 * m * x[1] * T : 0);
}

static void flow(int is_hamiltonian, const quad parameter[], double t, quad x[D])
{
    const quad h = (quad)t / STEPS, part[] = {0, h / 2, h / 2, h}, weight[] = {h / 6, h / 3, h / 3, h / 6};
    for (int step = 0; step < STEPS; step++) {
        quad sum[D], slope[D] = {0}, stage[D];
        for (int i = 0; i < D; i++) sum[i] = x[i];
        for (int s = 0; s < 4; s++) {
            for (int i = 0; i < D; i++) stage[i] = x[i] + part[s] * slope[i];
            field(is_hamiltonian, parameter, stage, slope);
            for (int i = 0; i < D; i++) sum[i] += weight[s] * slope[i];
        }
        for (int i = 0; i < D; i++) x[i] = sum[i];
    }
}

void exact_sensitivity(int is_hamiltonian, const double parameter[], int which, const double from[], double t,
                       double rate[])
{
    const quad e = 1e-8Q;
    quad x[2][D];
    for (int side = 0; side < 2; side++) {
        quad value[] = {parameter[0], parameter[1]};
        value[which] += side ? e : -e;
        for (int i = 0; i < D; i++) x[side][i] = from[i];
        flow(is_hamiltonian, value, t, x[side]);
    }
    for (int i = 0; i < D; i++) rate[i] = (double)((x[1][i] - x[0][i]) / (2 * e));
}
