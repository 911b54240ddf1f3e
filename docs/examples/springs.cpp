/* springs.cpp - C++: lambdas that capture, states in vectors, exceptions; a sweep over the stiffness of a chain.
 *   c++ -std=c++11 springs.cpp $(pkg-config --cflags --libs tvi) -lm */
#include <tvi.hpp>

#include <cstdio>

/* A chain of n masses between two walls, each spring with the potential d^2/2 + stiffness d^4/4. */
static tvi::system chain(int n, double stiffness)
{
    return tvi::potential(n, [=](const jet *q, jet) {
        jet V = 0;
        for (int i = 0; i <= n; i++) {
            const jet d2 = sqr((i < n ? q[i] : jet(0)) - (i > 0 ? q[i - 1] : jet(0)));
            V += d2 / 2 + stiffness / 4 * sqr(d2);
        }
        return V;
    });
}

int main()
{
    const int n = 8;
    try {
        for (double stiffness : {0.0, 1.0, 10.0}) {
            const tvi::system system = chain(n, stiffness);
            tvi::integrator integrator(system); /* keeps the system */
            double t = 0, farthest = 0;
            std::vector<double> q(n), p(n);
            p[0] = 1; /* a kick at the end */
            const double H = system.energy(t, q, p);
            integrator.integrate(0.25, 400, t, q, p, [&](long, double, const double *x, const double *) {
                farthest = std::fmax(farthest, std::fabs(x[n - 1]));
            });
            std::printf("stiffness %4.1f: the other end moves by %.4f, energy error %.0e\n", stiffness, farthest,
                        std::fabs(system.energy(t, q, p) / H - 1));
        }
    } catch (const tvi::error &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
