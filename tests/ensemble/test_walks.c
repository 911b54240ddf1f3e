/* test_walks.c - what steps in lanes, and those of integrators, must not lose: energy and momentum for long. */
#include "ensemble.h"

#include <math.h>
#include <string.h>

enum { LONG = 50000, QUANTITIES = 2 };

static jet attraction(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_div(-1, jet_hypot(q[0], q[1]));
}

static const struct {
    method by;
    bool in_lanes; /* or by integrators */
    int members;
    double first, last, h, tolerance;         /* speeds; at which they drift */
    double rms[QUANTITIES], mean[QUANTITIES]; /* of the walk, at most */
} drifts[] = {{{"galerkin", 16}, true, 16, 0.8, 0.76, 0.125, 1e-9, {6e-15, 1.5e-15}, {5e-15, 1.5e-15}},
              {{"galerkin", 16}, true, 64, 0.9, 0.96, 0.25, 1e-9, {4e-15, 1.7e-15}, {2e-15, 9e-16}},
              {{"galerkin", 16}, false, 64, 0.9, 0.96, 0.25, 1e-9, {4e-15, 1.7e-15}, {2e-15, 9e-16}},
              {{"midpoint", 16}, true, 16, 0.8, 0.76, 0.125, 1e-3, {1.7e-14, 8e-15}, {7e-15, 2e-15}}};
enum { DRIFTS = sizeof drifts / sizeof *drifts };

/* The energy and the angular momentum of a member. */
static void find_quantities(const tvi_system *system, const crowd *c, int m, double out[QUANTITIES])
{
    const double q[] = {c->q[m], c->q[c->members + m]}, p[] = {c->p[m], c->p[c->members + m]};
    OK(tvi_energy(system, 0, q, p, &out[0]));
    out[1] = q[0] * p[1] - q[1] * p[0];
}

typedef struct {
    double mean, rms; /* over the members */
} errors;

static void run_in_lanes(const tvi_system *system, const tvi_options *options, double h, crowd *c)
{
    tvi_ensemble *ensemble;
    OK(tvi_ensemble_create(&ensemble, system, options, c->members, 1));
    ck_assert(has_lanes(ensemble));
    OK(tvi_ensemble_integrate(ensemble, h, LONG, c->t, c->q, c->p, c->status, NULL, NULL));
    tvi_ensemble_free(ensemble);
}

static void run_by_integrators(const tvi_system *system, const tvi_options *options, double h, crowd *c)
{
    for (int m = 0; m < c->members; m++) {
        tvi_integrator *integrator;
        double q[N] = {c->q[m], c->q[c->members + m]}, p[N] = {c->p[m], c->p[c->members + m]};
        OK(tvi_integrator_create(&integrator, system, options));
        OK(tvi_integrate(integrator, h, LONG, &c->t[m], q, p, NULL, NULL));
        tvi_integrator_free(integrator);
        for (int i = 0; i < N; i++) c->q[i * c->members + m] = q[i], c->p[i * c->members + m] = p[i];
    }
}

/* Relative errors of Kepler orbits, from apocentre: e = 0.36 to 0.42, or 0.19 to 0.08. */
static void find_errors(const tvi_system *system, const tvi_options *options, int row, crowd *c, errors e[QUANTITIES])
{
    static double starts[MOST][QUANTITIES];
    for (int m = 0; m < c->members; m++) {
        c->t[m] = c->q[c->members + m] = c->p[m] = 0;
        c->q[m] = 1;
        c->p[c->members + m] = drifts[row].first + (drifts[row].last - drifts[row].first) * m / c->members;
        find_quantities(system, c, m, starts[m]);
    }
    (drifts[row].in_lanes ? run_in_lanes : run_by_integrators)(system, options, drifts[row].h, c);
    memset(e, 0, QUANTITIES * sizeof *e);
    for (int m = 0; m < c->members; m++) {
        double end[QUANTITIES];
        find_quantities(system, c, m, end);
        for (int i = 0; i < QUANTITIES; i++) {
            const double error = (end[i] - starts[m][i]) / starts[m][i];
            e[i].mean += error / c->members;
            e[i].rms += error * error / c->members;
        }
    }
    for (int i = 0; i < QUANTITIES; i++) e[i].rms = sqrt(e[i].rms);
}

/* They walk at random, to both sides, and twice as far where increments are rounded to one number. One that solves its
 * equations to a tolerance only drifts, which is seen so. */
START_TEST(energies_and_momenta_do_not_drift)
{
    static crowd c;
    tvi_system *system;
    tvi_options options;
    errors e[QUANTITIES], drifting[QUANTITIES];
    c.members = drifts[_i].members;
    OK(tvi_system_potential(&system, N, NULL, attraction, NULL));
    OK(tvi_options_named(drifts[_i].by.name, drifts[_i].by.order, &options));
    find_errors(system, &options, _i, &c, e);
    options.tolerance = drifts[_i].tolerance;
    find_errors(system, &options, _i, &c, drifting);
    for (int i = 0; i < QUANTITIES; i++) {
        ck_assert_double_lt(e[i].rms, drifts[_i].rms[i]);
        ck_assert_double_gt(e[i].rms, 5e-16);
        ck_assert_double_lt(fabs(e[i].mean), drifts[_i].mean[i]);
        ck_assert_double_gt(fabs(drifting[i].mean), 1e-12);
    }
    tvi_system_free(system);
}
END_TEST

Suite *suite_walks(void)
{
    Suite *suite = suite_create("walks");
    TCase *tests = tcase_create("walks");
    tcase_add_loop_test(tests, energies_and_momenta_do_not_drift, 0, DRIFTS);
    suite_add_tcase(suite, tests);
    return suite;
}
