/* consumer.cpp - Writes consumer.c as a user of C++ does. */
#include <tvi.hpp>

#include <cstdio>

int main()
{
    const double gravity = 9.8;
    double t = 0;
    std::vector<double> q = {1}, p = {0};
    try {
        const tvi::potential system(1, [=](const jet *x, jet) { return gravity * (1 - cos(x[0])); });
        const double before = system.energy(t, q, p);
        tvi::integrator(system).integrate(0.02, 500, t, q, p);
        const double error = system.energy(t, q, p) - before;
        std::printf("t = %g, q = %.15f, p = %.15f, energy error %.1e\n", t, q[0], p[0], error);
        return std::fabs(error) < 1e-12 ? 0 : 1;
    } catch (const tvi::error &error) {
        std::printf("%s\n", error.what());
        return 1;
    }
}
