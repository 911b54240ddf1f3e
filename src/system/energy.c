/* energy.c - what is asked of a system outside of steps: energy, momenta, velocities. */
#include "system/legendre.h"
#include "algebra/sizes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* out = momenta of velocities, or velocities of momenta. */
static tvi_status transform(const tvi_system *system, double t, const double q[], const double in[], double out[],
                            bool to_momenta)
{
    if (!system || !q || !in || !out) return TVI_EINVAL;
    const int n = system->n;
    if (!isfinite(t) || !tvi_all_finite(n, q) || !tvi_all_finite(n, in)) return TVI_ENONFINITE;
    tvi_legendre legendre;
    void *memory;
    tvi_status status = tvi_legendre_create(&legendre, system, &memory);
    if (status != TVI_OK) return status;
    double *result = calloc((size_t)n, sizeof *result);
    if (!result) status = TVI_ENOMEM;
    else if (to_momenta == (system->form != TVI_HAMILTONIAN)) status = tvi_legendre_state(&legendre, t, q, in, result);
    else status = tvi_legendre_solve(&legendre, t, q, in, result);
    if (status == TVI_OK && !tvi_all_finite(n, result)) status = TVI_ENONFINITE;
    if (status == TVI_OK) memcpy(out, result, (size_t)n * sizeof *out);
    free(result);
    free(memory);
    return status;
}

tvi_status tvi_momentum(const tvi_system *system, double t, const double q[], const double v[], double p[])
{
    return transform(system, t, q, v, p, true);
}

tvi_status tvi_velocity(const tvi_system *system, double t, const double q[], const double p[], double v[])
{
    return transform(system, t, q, p, v, false);
}

/* The value of the energy tape at (q, second, t), in a block of it; second NULL: zeros. */
static tvi_status energy_value(const tvi_system *system, double *block, double t, const double q[],
                               const double second[], double *value)
{
    const jet_tape *tape = system->energy;
    const size_t n = (size_t)system->n;
    memcpy(block, q, n * sizeof *q);
    if (second) memcpy(block + n, second, n * sizeof *q);
    if (tape->inputs > system->energy_inputs) block[system->energy_inputs] = t;
    const bool inside = jet_sweep_values(tape, block, 1);
    *value = block[tape->output[0]];
    return inside ? TVI_OK : TVI_EDOMAIN;
}

/* V is the energy tape at v = 0 or p = 0, up to the sign. */
static tvi_status separable_energy(const tvi_system *system, double *block, double t, const double q[],
                                   const double p[], double *H)
{
    const tvi_status status = energy_value(system, block, t, q, NULL, H);
    *H *= system->energy_sign;
    for (int i = 0; i < system->n; i++) *H += p[i] * p[i] / (2 * system->mass[i]);
    return status;
}

/* H = p.v - L(q, v). */
static tvi_status lagrangian_energy(const tvi_system *system, double *block, double t, const double q[],
                                    const double p[], double *H)
{
    double *v = malloc((size_t)system->n * sizeof *v);
    if (!v) return TVI_ENOMEM;
    tvi_status status = tvi_velocity(system, t, q, p, v);
    if (status == TVI_OK) status = energy_value(system, block, t, q, v, H);
    *H = -*H;
    for (int i = 0; status == TVI_OK && i < system->n; i++) *H += p[i] * v[i];
    free(v);
    return status;
}

tvi_status tvi_energy_in(const tvi_system *system, double *block, double t, const double q[], const double p[],
                         double *H)
{
    tvi_status status;
    switch (system->form) {
    case TVI_SEPARABLE: status = separable_energy(system, block, t, q, p, H); break;
    case TVI_LAGRANGIAN: status = lagrangian_energy(system, block, t, q, p, H); break;
    default: status = energy_value(system, block, t, q, p, H);
    }
    return status == TVI_OK && !isfinite(*H) ? TVI_ENONFINITE : status;
}

tvi_status tvi_energy(const tvi_system *system, double t, const double q[], const double p[], double *H)
{
    if (!system || !q || !p || !H) return TVI_EINVAL;
    if (!system->energy) return TVI_EUNSUPPORTED;
    if (!isfinite(t) || !tvi_all_finite(system->n, q) || !tvi_all_finite(system->n, p)) return TVI_ENONFINITE;
    double energy = 0, *block = malloc((size_t)system->energy->slots * sizeof *block);
    if (!block) return TVI_ENOMEM;
    jet_tape_prepare(system->energy, block, 1, 1);
    const tvi_status status = tvi_energy_in(system, block, t, q, p, &energy);
    free(block);
    if (status == TVI_OK) *H = energy;
    return status;
}
