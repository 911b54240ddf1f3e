/* solar.c - many bodies with masses: the Sun, Jupiter, Saturn, Uranus, Neptune and Pluto for 200,000 days.
 *   cc solar.c $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.h>

#include <math.h>
#include <stdio.h>

/* AU, days, solar masses; 5 September 1994 (Hairer, Lubich and Wanner, Geometric Numerical Integration, I.2.4) */
enum { BODIES = 6, N = 3 * BODIES };
static const double G = 2.95912208286e-4;
static const double mass[BODIES] = {1.00000597682,      0.000954786104043,  0.000285583733151,
                                    0.0000437273164546, 0.0000517759138449, 1 / 1.3e8};
static const double place[N] = {0,          0,           0,           -3.5023653,  -3.8169847,  -1.5507963,
                                9.0755314,  -3.0458353,  -1.6483708,  8.3101420,   -16.2901086, -7.2521278,
                                11.4707666, -25.7294829, -10.8169456, -15.5387357, -25.2225594, -3.1902382};
static const double speed[N] = {0,          0,          0,          0.00565429, -0.00412490, -0.00190589,
                                0.00168318, 0.00483525, 0.00192462, 0.00354178, 0.00137102,  0.00055029,
                                0.00288930, 0.00114527, 0.00039677, 0.00276725, -0.00170702, -0.00136504};

/* V = -G sum_{i<j} m_i m_j / |q_i - q_j| */
static jet potential(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    jet V = jet_const(0);
    for (int i = 1; i < BODIES; i++)
        for (int j = 0; j < i; j++) {
            jet d[3];
            for (int k = 0; k < 3; k++) d[k] = jet_sub(q[3 * i + k], q[3 * j + k]);
            V = jet_sub(V, jet_mul(G * mass[i] * mass[j], jet_pow(jet_dot(d, d, 3), -0.5)));
        }
    return V;
}

int main(void)
{
    double t = 0, m[N], q[N], p[N], H0 = 0, H = 0;
    for (int i = 0; i < N; i++) m[i] = mass[i / 3], q[i] = place[i], p[i] = m[i] * speed[i];
    tvi_system *system;
    tvi_integrator *integrator = NULL;
    tvi_status status = tvi_system_potential(&system, N, m, potential, NULL);
    if (status == TVI_OK) status = tvi_energy(system, t, q, p, &H0);
    if (status == TVI_OK) status = tvi_integrator_create(&integrator, system, NULL);
    for (int part = 1; part <= 4 && status == TVI_OK; part++) {
        status =
            tvi_integrate(integrator, 500, 100, &t, q, p, NULL, NULL); /* observer and events have their place here */
        if (status == TVI_OK) status = tvi_energy(system, t, q, p, &H);
        if (status == TVI_OK)
            printf("%6.0f days: Pluto at %8.4f AU, energy error %.0e\n", t,
                   hypot(hypot(q[15] - q[0], q[16] - q[1]), q[17] - q[2]), fabs(H / H0 - 1));
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return status != TVI_OK;
}
