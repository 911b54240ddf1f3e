/* An exception leaves an observer of the functions in C: the integrator refuses every later step, and so does an
 * ensemble, also after a reset. Right: an integrator steps again after tvi_integrator_reset, and an ensemble runs
 * again after the exception. */
#include <cstdlib>
#include <tvi.h>
#include "verdict.h"

static jet V(const jet q[], jet, void *) { return jet_mul(0.5, jet_sqr(q[0])); }
static int leave(long, double, const double[], const double[], void *) { throw 1; }
static int leave_member(int, int, double, const double[], const double[], void *) { throw 1; }

static void test_integrator(const tvi_system *system)
{
    tvi_integrator *it;
    double t = 0, q = 1, p = 0;
    bool has_thrown = false;
    TVI_OR_EXIT(tvi_integrator_create(&it, system, NULL));
    try {
        const tvi_status status = tvi_integrate(it, 0.1, 3, &t, &q, &p, leave, NULL);
        row(false, "the run returned %d", status);
    } catch (int) {
        has_thrown = true;
    }
    tvi_integrator_reset(it);
    const tvi_status status = tvi_step(it, 0.1, &t, &q, &p);
    row(has_thrown && status == TVI_OK, "integrator: %d %s", status, tvi_last_error());
    tvi_integrator_free(it);
}

static void test_ensemble(const tvi_system *system)
{
    tvi_ensemble *ensemble;
    double t = 0, q = 1, p = 0;
    bool has_thrown = false;
    tvi_status status = TVI_OK;
    tvi_run_plan plan = tvi_run_plan();
    plan.h = 0.1, plan.steps = 3, plan.at_step = leave_member;
    TVI_OR_EXIT(tvi_ensemble_create(&ensemble, system, NULL, 1, 1));
    try {
        status = tvi_ensemble_run(ensemble, &plan, &t, &q, &p, &status);
        row(false, "the run of the ensemble returned %d", status);
    } catch (int) {
        has_thrown = true;
    }
    tvi_ensemble_reset(ensemble);
    plan.at_step = NULL;
    const tvi_status again = tvi_ensemble_run(ensemble, &plan, &t, &q, &p, &status);
    row(has_thrown && again == TVI_OK, "ensemble: %d %s", again, tvi_last_error());
    tvi_ensemble_free(ensemble);
}

int main()
{
    tvi_system *system;
    TVI_OR_EXIT(tvi_system_potential(&system, 1, NULL, V, NULL));
    test_integrator(system);
    test_ensemble(system);
    tvi_system_free(system);
    return verdict();
}
