/* test_passes.c - Tests that "galerkin" with second derivatives at the nodes (galerkin/hamiltonian_pass.h) solves the
 * equations that it solves without them, in fewer passes; and has them where they are cheap. */
#include "rescaled.h"
#include "hard.h"
#include "system/system.h"

#include <math.h>
#include <string.h>

/* K of Kepler and of the driven problem, stated as any Hamiltonian: it has no second derivatives. */
static jet kepler_by_hand(const jet q[], const jet p[], jet s, void *ctx)
{
    const jet H = jet_add(jet_mul(0.5, jet_dot(p, p, 2)), kepler(q, s, ctx));
    return jet_mul(kepler_scale(q, p, q[2], ctx), jet_add(H, p[2]));
}

/* With the automatic scale, r^(3/2) / 5^(1/4). */
#define ROOT_5 1.4953487812212205
static jet automatic_by_hand(const jet q[], const jet p[], jet s, void *ctx)
{
    return jet_div(kepler_by_hand(q, p, s, ctx), ROOT_5);
}

static jet driven_by_hand(const jet q[], const jet p[], jet s, void *ctx)
{
    const jet T = jet_add(jet_div(jet_sqr(p[0]), 2 * driven_mass[0]), jet_div(jet_sqr(p[1]), 2 * driven_mass[1]));
    (void)s;
    return jet_mul(driven_scale(q, p, q[2], ctx), jet_add(jet_add(T, driven(q, q[2], ctx)), p[2]));
}

/* Second derivatives with the automatic scale leave out terms that are 0 on the solution. */
typedef struct {
    tvi_potential_fn *potential;
    tvi_rescale_fn *g;
    tvi_hamiltonian_fn *by_hand;
    double e, h;
    int order;
    double most; /* passes a step: half as many again as they take */
    double distance;
} problem;

static const problem problems[] = {
    {kepler, kepler_scale, kepler_by_hand, 0.6, 0.7, 16, 4.6, 1e-13},
    {kepler, kepler_scale, kepler_by_hand, 0.9, 0.83, 16, 4.7, 1e-12},
    {kepler, kepler_scale, kepler_by_hand, 0.99, 1.14, 16, 6, 1e-11},
    {kepler, kepler_scale, kepler_by_hand, 0.6, 0.1, 6, 3.1, 1e-14},
    {kepler, kepler_scale, kepler_by_hand, 0.6, 0.1, 20, 3.1, 1e-14},
    {kepler, NULL, automatic_by_hand, 0.6, 0.7 * ROOT_5, 16, 5.8, 1e-13},
    {kepler, NULL, automatic_by_hand, 0.9, 0.83 * ROOT_5, 16, 5.8, 1e-12},
    {kepler, NULL, automatic_by_hand, 0.6, 0.1 * ROOT_5, 6, 3.6, 1e-14},
    {driven, driven_scale, driven_by_hand, 0, 0.4, 16, 3.4, 1e-13},
    {driven, driven_scale, driven_by_hand, 0, -0.4, 16, 3.4, 1e-13},
    {driven, driven_scale, driven_by_hand, 0, 0.2, 2, 4.7, 1e-14},
};
enum { STEPS = 40 };

static double passes_of(const run *r)
{
    const tvi_stats *stats = tvi_integrator_stats(r->integrator);
    return (double)stats->passes / (double)stats->steps;
}

START_TEST(passes_are_saved)
{
    const problem *a = &problems[_i];
    const state start = a->potential == kepler ? kepler_start(a->e) : driven_start();
    tvi_system *system = rescaled_system(2, a->potential == kepler ? NULL : driven_mass, a->potential, a->g), *plain;
    ck_assert_ptr_nonnull(system->stepped_system->hessian.values);
    ck_assert_int_eq(system->stepped_system->hessian.is_complete, a->g != NULL);
    ck_assert_int_eq(tvi_system_hamiltonian(&plain, 3, a->by_hand, NULL), TVI_OK);
    ck_assert_ptr_null(plain->hessian.values);
    state extended = {0, {start.q[0], start.q[1], start.t}, {start.p[0], start.p[1], 0}};
    ck_assert_int_eq(tvi_energy(system, start.t, start.q, start.p, &extended.p[2]), TVI_OK);
    extended.p[2] = -extended.p[2];
    run r = open_run(system, "galerkin", a->order, &start), by_hand = open_run(plain, "galerkin", a->order, &extended);
    ck_assert_int_eq(run_steps(&r, a->h, STEPS), TVI_OK);
    ck_assert_int_eq(run_steps(&by_hand, a->h, STEPS), TVI_OK);
    by_hand.x.t = by_hand.x.q[2];
    ck_assert_double_le(state_distance(2, &r.x, &by_hand.x), a->distance);
    ck_assert_double_le(passes_of(&r), a->most);
    ck_assert_double_ge(passes_of(&by_hand), 1.75 * passes_of(&r)); /* 2.6 to 6 times */
    close_run(&r);
    close_run(&by_hand);
}
END_TEST

/* Second derivatives of three bodies with a scale of their own cost more than the passes that they would save; with the
 * automatic scale, which itself costs more, they serve. */
START_TEST(dear_ones_are_left)
{
    tvi_system *one_body = rescaled_system(2, NULL, kepler, NULL);
    ck_assert_ptr_nonnull(one_body->stepped_system->hessian.values);
    tvi_system_free(one_body);
    const scene *s = &hard_pythagorean.scene;
    tvi_system *rescaled = rescaled_system(s->n, s->mass, s->potential, hard_pythagorean.scale);
    ck_assert_ptr_null(rescaled->stepped_system->hessian.values);
    tvi_system_free(rescaled);
    rescaled = rescaled_system(s->n, s->mass, s->potential, NULL);
    ck_assert_ptr_nonnull(rescaled->stepped_system->hessian.values);
    tvi_system_free(rescaled);
}
END_TEST

/* A step far too large ends, and leaves the state. */
START_TEST(too_large_a_step_ends)
{
    static const double sizes[] = {5, 30, 1e3, -1e8};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        run r = open_kepler(0.9, kepler_scale, "galerkin", 16);
        const state before = r.x;
        ck_assert_int_ne(run_steps(&r, sizes[i], 1), TVI_OK);
        ck_assert(memcmp(&before, &r.x, sizeof before) == 0);
        ck_assert_int_le(tvi_integrator_stats(r.integrator)->passes, 200);
        close_run(&r);
    }
}
END_TEST

Suite *suite_passes(void)
{
    Suite *suite = suite_create("passes");
    TCase *tcase = tcase_create("second derivatives");
    tcase_add_loop_test(tcase, passes_are_saved, 0, sizeof problems / sizeof *problems);
    tcase_add_test(tcase, dear_ones_are_left);
    tcase_add_test(tcase, too_large_a_step_ends);
    suite_add_tcase(suite, tcase);
    return suite;
}
