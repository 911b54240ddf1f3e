/* A plan of 0 steps runs to t = 0: integrate_events of an ensemble in C++, or a plan whose steps were counted and
 * came out as 0. Right: t and q stay as they are, or the plan is refused. */
#include <tvi.hpp>
#include <vector>
#include "verdict.h"

static void test_ensemble(const tvi::system &spring)
{
    tvi::event zero(1, [](const jet *q, const jet *, jet) { return q[0]; });
    tvi::ensemble all(spring, 1);
    std::vector<double> t = {-2}, q = {1}, p = {0};
    std::vector<tvi_status> status;
    all.integrate_events(0.1, 0, {zero}, t, q, p, status, [](int, int, double, const double *, const double *) {});
    row(t[0] == -2 && q[0] == 1, "ensemble.integrate_events, 0 steps: t = %g, q = %g", t[0], q[0]);
}

static void test_plan(const tvi::system &spring)
{
    tvi::integrator one(spring);
    tvi_run_plan plan = tvi_run_plan();
    double t = 2;
    std::vector<double> q = {1}, p = {0};
    plan.h = -0.1, plan.steps = 0;
    try {
        one.run(plan, t, q, p);
    } catch (const tvi::error &error) {
        std::printf("%s\n", error.what());
    }
    row(t == 2 && q[0] == 1, "plan of h = -0.1 and 0 steps: t = %g, q = %g", t, q[0]);
}

int main()
{
    tvi::potential spring(1, [](const jet *q, jet) { return 0.5 * sqr(q[0]); });
    test_ensemble(spring);
    test_plan(spring);
    return verdict();
}
