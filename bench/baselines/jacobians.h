/* jacobians.h - Computes derivatives of the accelerations of force_kernels.h, row-major: J[i n + k] = d a_i / d q_k. */
#ifndef JACOBIANS_H
#define JACOBIANS_H

#include "forces.h"

static INLINE void pendulum_jacobian(const double *q, double *J) { J[0] = -PENDULUM_G * cos(q[0]); }

/* -1/r^3 + 3 q q^T / r^5. */
static INLINE void kepler_jacobian(const double *q, double *J)
{
    const double x = q[0], y = q[1], r2 = x * x + y * y, w = 1 / (r2 * sqrt(r2)), u = 3 * w / r2;
    J[0] = u * x * x - w;
    J[1] = J[2] = u * x * y;
    J[3] = u * y * y - w;
}

static INLINE void henon_heiles_jacobian(const double *q, double *J)
{
    J[0] = -1 - 2 * q[1];
    J[1] = J[2] = -2 * q[0];
    J[3] = -1 + 2 * q[1];
}

/* Stiffness k of spring d_i = q_{i+1} - q_i, q_0 = q_7 = 0: 12 d^2 for even i, w^2/2 for odd i. */
static INLINE void fpu_jacobian(const double *q, double *J)
{
    for (int i = 0; i < 36; i++) J[i] = 0;
    for (int i = 0; i <= 6; i++) {
        const double d = (i < 6 ? q[i] : 0) - (i > 0 ? q[i - 1] : 0), k = i % 2 == 0 ? 12 * d * d : FPU_W * FPU_W / 2;
        if (i > 0) J[7 * (i - 1)] -= k;
        if (i < 6) J[7 * i] -= k;
        if (i > 0 && i < 6) J[6 * (i - 1) + i] = J[6 * i + i - 1] = k;
    }
}

/* For each pair, with d = q_i - q_j and H = (1 - 3 d d^T / r^2) / r^3: d a_i / d q_i -= G m_j H, d a_i / d q_j += G m_j
 * H, and so with i and j exchanged. */
static INLINE void solar_jacobian(const double *q, double *J)
{
    for (int i = 0; i < 18 * 18; i++) J[i] = 0;
    for (int i = 1; i < 6; i++)
        for (int j = 0; j < i; j++) {
            double d[3], r2 = 0;
            for (int k = 0; k < 3; k++) {
                d[k] = q[3 * i + k] - q[3 * j + k];
                r2 += d[k] * d[k];
            }
            const double w = 1 / (r2 * sqrt(r2)), gmi = SOLAR_G * SOLAR_MASS[i], gmj = SOLAR_G * SOLAR_MASS[j];
            for (int k = 0; k < 3; k++)
                for (int m = 0; m < 3; m++) {
                    const double H = w * ((k == m) - 3 * d[k] * d[m] / r2);
                    double *row_i = J + 18 * (3 * i + k), *row_j = J + 18 * (3 * j + k);
                    row_i[3 * i + m] -= gmj * H, row_i[3 * j + m] += gmj * H;
                    row_j[3 * i + m] += gmi * H, row_j[3 * j + m] -= gmi * H;
                }
        }
}

#endif
