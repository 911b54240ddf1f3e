/* statements.c - Implements statements.h. */
#include "statements.h"

#include <math.h>

/* ---- Kepler ------------------------------------------------------------------------------------------------------ */

void kepler_as_force(const jet q[], jet t, jet force[], void *ctx)
{
    (void)t, (void)ctx;
    jet pull = jet_pow(jet_dot(q, q, 2), -1.5);
    for (int i = 0; i < 2; i++) force[i] = jet_neg(jet_mul(q[i], pull));
}

jet kepler_as_potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_dot(q, q, 2), -0.5));
}

jet kepler_as_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return jet_sub(jet_mul(0.5, jet_dot(v, v, 2)), kepler_as_potential(q, t, ctx));
}

jet kepler_as_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    return jet_add(jet_mul(0.5, jet_dot(p, p, 2)), kepler_as_potential(q, t, ctx));
}

/* ---- The chain --------------------------------------------------------------------------------------------------- */

const double chain_masses[CHAIN_N] = {1, 2.5, 0.4};
static const double spring_k = 4, spring_a = 1.5, spring_b = 2, drive = 0.75, drive_frequency = 1.7;

/* V = sum_i (k d_i^2/2 + a d_i^3/3 + b d_i^4/4) - A cos(w t) q_0. */
jet chain_as_potential(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    jet energy[CHAIN_N + 1];
    for (int i = 0; i <= CHAIN_N; i++) {
        jet d = i == 0 ? q[0] : i == CHAIN_N ? jet_neg(q[CHAIN_N - 1]) : jet_sub(q[i], q[i - 1]);
        jet bracket = jet_add(spring_k / 2, jet_mul(d, jet_add(spring_a / 3, jet_mul(spring_b / 4, d))));
        energy[i] = jet_mul(jet_sqr(d), bracket);
    }
    jet driven = jet_mul(drive, jet_mul(jet_cos(jet_mul(drive_frequency, t)), q[0]));
    return jet_sub(jet_sum(energy, CHAIN_N + 1), driven);
}

jet chain_as_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    jet kinetic[CHAIN_N];
    for (int i = 0; i < CHAIN_N; i++) kinetic[i] = jet_mul(chain_masses[i] / 2, jet_sqr(v[i]));
    return jet_sub(jet_sum(kinetic, CHAIN_N), chain_as_potential(q, t, ctx));
}

jet chain_as_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    jet kinetic[CHAIN_N];
    for (int i = 0; i < CHAIN_N; i++) kinetic[i] = jet_div(jet_sqr(p[i]), 2 * chain_masses[i]);
    return jet_add(jet_sum(kinetic, CHAIN_N), chain_as_potential(q, t, ctx));
}

/* ---- Sheared, in another gauge ----------------------------------------------------------------------------------- */

/* q = S x. */
static const double shear[CHAIN_N][CHAIN_N] = {{1, 0, 0}, {0.5, 1, 0}, {-0.25, 0.75, 1}};
static const double gauge_a = 0.5, gauge_b = 0.375, gauge_frequency = 1.25;

static void sheared(const jet x[], jet q[])
{
    for (int i = 0; i < CHAIN_N; i++) {
        q[i] = x[i];
        for (int j = 0; j < i; j++) q[i] = jet_add(q[i], jet_mul(shear[i][j], x[j]));
    }
}

/* f_q. */
static void gauge_gradient(const jet q[], jet t, jet out[])
{
    jet turn = jet_mul(gauge_b, jet_cos(jet_mul(gauge_frequency, t)));
    out[0] = jet_add(jet_mul(gauge_a, jet_sqr(q[1])), jet_mul(turn, q[2]));
    out[1] = jet_mul(2 * gauge_a, jet_mul(q[0], q[1]));
    out[2] = jet_mul(turn, q[0]);
}

/* f_t. */
static jet gauge_rate(const jet q[], jet t)
{
    jet turn = jet_mul(-gauge_b * gauge_frequency, jet_sin(jet_mul(gauge_frequency, t)));
    return jet_mul(turn, jet_mul(q[0], q[2]));
}

jet sheared_lagrangian(const jet x[], const jet v[], jet t, void *ctx)
{
    jet q[CHAIN_N], rate[CHAIN_N], slope[CHAIN_N];
    sheared(x, q);
    sheared(v, rate);
    gauge_gradient(q, t, slope);
    return jet_add(chain_as_lagrangian(q, rate, t, ctx), jet_add(jet_dot(slope, rate, CHAIN_N), gauge_rate(q, t)));
}

/* S^T y = P by back substitution, S unit lower triangular; p = y - f_q. */
jet sheared_hamiltonian(const jet x[], const jet P[], jet t, void *ctx)
{
    jet q[CHAIN_N], p[CHAIN_N], slope[CHAIN_N];
    sheared(x, q);
    gauge_gradient(q, t, slope);
    for (int i = CHAIN_N - 1; i >= 0; i--) {
        p[i] = P[i];
        for (int j = i + 1; j < CHAIN_N; j++) p[i] = jet_sub(p[i], jet_mul(shear[j][i], p[j]));
    }
    for (int i = 0; i < CHAIN_N; i++) p[i] = jet_sub(p[i], slope[i]);
    return jet_sub(chain_as_hamiltonian(q, p, t, ctx), gauge_rate(q, t));
}

exact_state sheared_state(const exact_state *chain)
{
    const long double *q = chain->q, turn = gauge_b * cosl(gauge_frequency * chain->t);
    const long double y[] = {chain->p[0] + gauge_a * q[1] * q[1] + turn * q[2], chain->p[1] + 2 * gauge_a * q[0] * q[1],
                             chain->p[2] + turn * q[0]};
    exact_state x = {.t = chain->t};
    for (int i = 0; i < CHAIN_N; i++) {
        x.q[i] = q[i];
        for (int j = 0; j < i; j++) x.q[i] -= shear[i][j] * x.q[j];
        for (int j = i; j < CHAIN_N; j++) x.p[i] += shear[j][i] * y[j];
    }
    return x;
}
