/* test_lanes.c - Tests that members whose passes do not converge to the roundoff of the others go by themselves. */
#include "ensemble.h"

#include <math.h>
#include <string.h>

/* ---- Small motions ----------------------------------------------------------------------------------------------- */

/* About (1000, -1000), in momenta of no size of their own. */
static jet far_away(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet x = jet_sub(q[0], 1000), y = jet_add(q[1], 1000), mass = jet_add(1, jet_div(jet_sqr(x), 4));
    return jet_add(jet_div(jet_dot(p, p, N), jet_mul(2, mass)), jet_mul(0.5, jet_add(jet_sqr(x), jet_sqr(y))));
}

static void start_small(group *c, int member, int orbit)
{
    const double size = pow(10, -orbit);
    c->t[member] = 0;
    c->q[member] = 1000 + size;
    c->q[c->members + member] = -1000 - size / 2;
    c->p[member] = c->p[c->members + member] = 0;
}

static void run_small(const tvi_system *system, const tvi_options *options, group *c)
{
    tvi_ensemble *ensemble;
    OK(tvi_ensemble_create(&ensemble, system, options, c->members, 1));
    OK(tvi_ensemble_integrate(ensemble, 0.25, 200, c->t, c->q, c->p, c->status, NULL, NULL));
    for (int m = 0; m < c->members; m++) ck_assert_int_eq(c->status[m], TVI_OK);
    tvi_ensemble_free(ensemble);
}

static const method by_themselves[] = {{"galerkin", 16}, {"poincare", 12}};
enum { BY_THEMSELVES = sizeof by_themselves / sizeof *by_themselves, SMALL = 64, SIZES = 13 }; /* whole blocks */

/* Their passes end at a roundoff that is measured, of one member alone, while the others go on. */
START_TEST(small_motions_go_by_themselves)
{
    static group all, one;
    tvi_system *system;
    tvi_options options;
    OK(tvi_system_hamiltonian(&system, N, far_away, NULL));
    OK(tvi_options_named(by_themselves[_i].name, by_themselves[_i].order, &options));
    all.members = SMALL;
    for (int m = 0; m < all.members; m++) start_small(&all, m, m % SIZES);
    run_small(system, &options, &all);
    for (int m = 0; m < all.members; m++) {
        tvi_integrator *integrator;
        one.members = 1;
        start_small(&one, 0, m % SIZES);
        run_small(system, &options, &one);
        expect_same("small", &all, m, &one, 0);
        start_small(&one, 0, m % SIZES);
        OK(tvi_integrator_create(&integrator, system, &options));
        one.status[0] = tvi_integrate(integrator, 0.25, 200, one.t, one.q, one.p, NULL, NULL);
        expect_same("alone", &all, m, &one, 0);
        tvi_integrator_free(integrator);
    }
    tvi_system_free(system);
}
END_TEST

Suite *suite_lanes(void)
{
    Suite *suite = suite_create("lanes");
    TCase *tests = tcase_create("lanes");
    tcase_add_loop_test(tests, small_motions_go_by_themselves, 0, BY_THEMSELVES);
    suite_add_tcase(suite, tests);
    return suite;
}
