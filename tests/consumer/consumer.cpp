// consumer.cpp - consumer.c as a user of C++ writes it.
#include <tvi.h>

#include <cmath>
#include <cstdio>

static jet potential(const jet q[], jet, void *ctx) { return *static_cast<double *>(ctx) * (1 - cos(q[0])); }

static tvi_status swing(const tvi_system *system, double *t, double q[], double p[], double energy[])
{
    tvi_integrator *integrator = nullptr;
    tvi_status status = tvi_integrator_create(&integrator, system, nullptr);
    if (status == TVI_OK) status = tvi_energy(system, *t, q, p, &energy[0]);
    if (status == TVI_OK) status = tvi_integrate(integrator, 0.02, 500, t, q, p, nullptr, nullptr);
    if (status == TVI_OK) status = tvi_energy(system, *t, q, p, &energy[1]);
    tvi_integrator_free(integrator);
    return status;
}

int main()
{
    double gravity = 9.8, t = 0, q[] = {1}, p[] = {0}, energy[] = {0, 1};
    tvi_system *system = nullptr;
    tvi_status status = tvi_system_potential(&system, 1, nullptr, potential, &gravity);
    if (status == TVI_OK) status = swing(system, &t, q, p, energy);
    tvi_system_free(system);
    std::printf("%s: t = %g, q = %.15f, p = %.15f, energy error %.1e\n", tvi_status_string(status), t, q[0], p[0],
                energy[1] - energy[0]);
    return !(status == TVI_OK && std::fabs(energy[1] - energy[0]) < 1e-12);
}
