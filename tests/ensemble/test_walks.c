/* test_walks.c - Shows that the steps of members keep energy and momentum for long. */
#include "ensemble.h"
#include "problems/statistics.h"

enum { QUANTITIES = 2, STEPS = 6250 };

static jet attraction(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_div(-1, jet_hypot(q[0], q[1]));
}

/* Kepler orbits of e = 0.36 and 0.19. The rms are those of 1000 members with base, AVX2 and AVX-512, gcc and clang: the
 * largest and a twentieth more. */
static const struct {
    method by;
    double speed, h; /* at apocentre */
    double rms[QUANTITIES];
    double tolerance; /* with which members drift */
} walks[] = {{{"galerkin", 16}, 0.8, 0.125, {1.3e-15, 3.4e-16}, 1e-9},
             {{"galerkin", 16}, 0.9, 0.25, {1.35e-15, 5.4e-16}, 1e-9},
             {{"midpoint", 16}, 0.8, 0.125, {3.35e-15, 1.2e-15}, 1e-3}};
enum { WALKS = sizeof walks / sizeof *walks };

/* The energy and the angular momentum of a member. */
static void find_quantities(const tvi_system *system, const group *c, int m, double out[QUANTITIES])
{
    const double q[] = {c->q[m], c->q[c->members + m]}, p[] = {c->p[m], c->p[c->members + m]};
    OK(tvi_energy(system, 0, q, p, &out[0]));
    out[1] = q[0] * p[1] - q[1] * p[0];
}

/* With a reset before every step nothing is carried on from one step to the next. */
static void run_members(const tvi_system *system, const tvi_options *options, int row, bool resets, group *c)
{
    const long calls = resets ? STEPS : 1;
    tvi_ensemble *ensemble;
    OK(tvi_ensemble_create(&ensemble, system, options, c->members, 1));
    for (long call = 0; call < calls; call++) {
        if (resets) tvi_ensemble_reset(ensemble);
        OK(tvi_ensemble_integrate(ensemble, walks[row].h, STEPS / calls, c->t, c->q, c->p, c->status, NULL, NULL));
    }
    tvi_ensemble_free(ensemble);
}

/* The relative errors at the end. */
static void find_errors(const tvi_system *system, const tvi_options *options, int row, bool resets,
                        sample errors[QUANTITIES])
{
    static group c;
    static double starts[ORBITS][QUANTITIES];
    c.members = ORBITS;
    for (int m = 0; m < ORBITS; m++) {
        c.t[m] = c.q[ORBITS + m] = c.p[m] = 0;
        c.q[m] = 1;
        c.p[ORBITS + m] = walks[row].speed + start_shift(m);
        find_quantities(system, &c, m, starts[m]);
    }
    run_members(system, options, row, resets, &c);
    for (int i = 0; i < QUANTITIES; i++) errors[i] = (sample){0};
    for (int m = 0; m < ORBITS; m++) {
        double end[QUANTITIES];
        find_quantities(system, &c, m, end);
        for (int i = 0; i < QUANTITIES; i++) sample_add(&errors[i], (end[i] - starts[m][i]) / starts[m][i]);
    }
}

/* Errors are on both sides, and as large as they were measured to be. The controls are steps that solve their equations
 * to a tolerance, which drift with a ratio above 11.2, and steps without the low-order parts of the state. The latter
 * have errors that are at least 7 times as large, for "midpoint" 2.8 times. */
START_TEST(energies_and_momenta_do_not_drift)
{
    tvi_system *system;
    tvi_options options;
    sample errors[QUANTITIES], of_plain_sums[QUANTITIES], drifting[QUANTITIES];
    OK(tvi_system_potential(&system, N, NULL, attraction, NULL));
    OK(tvi_options_named(walks[_i].by.name, walks[_i].by.order, &options));
    find_errors(system, &options, _i, false, errors);
    find_errors(system, &options, _i, true, of_plain_sums);
    options.tolerance = walks[_i].tolerance;
    find_errors(system, &options, _i, false, drifting);
    for (int i = 0; i < QUANTITIES; i++) {
        const double most = rms_factor(ORBITS) * walks[_i].rms[i];
        ck_assert_double_lt(sample_drift(&errors[i]), NO_DRIFT);
        ck_assert_double_gt(sample_drift(&drifting[i]), NO_DRIFT);
        ck_assert_double_lt(sample_rms(&errors[i]), most);
        ck_assert_double_gt(sample_rms(&of_plain_sums[i]), most);
    }
    tvi_system_free(system);
}
END_TEST

Suite *suite_walks(void)
{
    Suite *suite = suite_create("walks");
    TCase *tests = tcase_create("walks");
    tcase_add_loop_test(tests, energies_and_momenta_do_not_drift, 0, WALKS);
    suite_add_tcase(suite, tests);
    return suite;
}
