/* test_points.c - Tests energy and Legendre transforms of systems of every form. */
#include "generating.h"
#include "models.h"
#include "statements.h"

#include <math.h>

/* ---- Velocities and momenta -------------------------------------------------------------------------------------- */

/* v -> p -> v and p -> v -> p. */
static void check_round_trip(const tvi_system *system, const char *name, double t, const double q[], const double v[])
{
    const int n = tvi_system_dimension(system);
    double p[N_MAX], back[N_MAX], again[N_MAX];
    ck_assert_int_eq(tvi_momentum(system, t, q, v, p), TVI_OK);
    ck_assert_int_eq(tvi_velocity(system, t, q, p, back), TVI_OK);
    ck_assert_int_eq(tvi_momentum(system, t, q, back, again), TVI_OK);
    for (int i = 0; i < n; i++) {
        ck_assert_msg(fabs(back[i] - v[i]) < 4e-15 * fmax(1, fabs(v[i])), "%s: v %d is %.17g, not %.17g", name, i,
                      back[i], v[i]);
        ck_assert_msg(fabs(again[i] - p[i]) < 4e-15 * fmax(1, fabs(p[i])), "%s: p %d is %.17g, not %.17g", name, i,
                      again[i], p[i]);
    }
}

START_TEST(transforms_undo_each_other)
{
    const model *m = models[_i];
    if (!(m->with & WITH_TYPE1)) return;
    tvi_system *system = model_system(m);
    const test_state x = model_start(m);
    double v[N_MAX];
    ck_assert_int_eq(tvi_velocity(system, x.t, x.q, x.p, v), TVI_OK);
    check_round_trip(system, m->name, x.t, x.q, v);
    for (int i = 0; i < m->n; i++) v[i] = 2 - 1.5 * i;
    check_round_trip(system, m->name, x.t + 0.7, x.q, v);
    tvi_system_free(system);
}
END_TEST

/* p = L_v by hand: the charge of bench/scenes/magnetic.c, and the double pendulum. */
START_TEST(momenta_are_those_by_hand)
{
    tvi_system *charge = model_system(&model_magnetic), *pendulum = model_system(&model_double_pendulum);
    const double q[] = {0.3, -0.7, 0.5}, v[] = {0.2, 1.1, -0.4}, A = 1.25 * (1 + 0.25) / 2;
    double p[3];
    ck_assert_int_eq(tvi_momentum(charge, 0, q, v, p), TVI_OK);
    ck_assert_double_eq_tol(p[0], 0.75 * v[0] - A * q[1], 1e-15);
    ck_assert_double_eq_tol(p[1], 0.75 * v[1] + A * q[0], 1e-15);
    ck_assert_double_eq_tol(p[2], 0.75 * v[2], 1e-15);
    const double mixed = 0.625 * 0.75 * cos(q[0] - q[1]);
    ck_assert_int_eq(tvi_momentum(pendulum, 0, q, v, p), TVI_OK);
    ck_assert_double_eq_tol(p[0], 1.625 * v[0] + mixed * v[1], 1e-15);
    ck_assert_double_eq_tol(p[1], 0.625 * 0.5625 * v[1] + mixed * v[0], 1e-15);
    tvi_system_free(charge);
    tvi_system_free(pendulum);
}
END_TEST

/* v = H_p of a degenerate H is what it is; the way back does not exist. */
START_TEST(degenerate_has_velocities_only)
{
    tvi_system *system = model_system(&model_degenerate);
    const double q = 0.7, p = 0.4;
    double v, back = 3;
    ck_assert_int_eq(tvi_velocity(system, 0, &q, &p, &v), TVI_OK);
    ck_assert_double_eq_tol(v, sin(0.7), 1e-15);
    ck_assert_int_eq(tvi_momentum(system, 0, &q, &v, &back), TVI_ESINGULAR);
    ck_assert_double_eq(back, 3);
    tvi_system_free(system);
}
END_TEST

/* ---- A Lagrangian that is not quadratic -------------------------------------------------------------------------- */

/* L = -sqrt(1 - |v|^2) - q0^2/2: p = v / sqrt(1 - v^2), H = sqrt(1 + p^2) + q0^2/2. */
static jet relativistic(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(jet_neg(jet_sqrt(jet_sub(1, jet_dot(v, v, 2)))), jet_mul(0.5, jet_sqr(q[0])));
}

static jet relativistic_energy(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_sqrt(jet_add(1, jet_dot(p, p, 2))), jet_mul(0.5, jet_sqr(q[0])));
}

START_TEST(relativistic_mechanics)
{
    static const double speeds[] = {0, 0.1, 0.6, 0.95, 0.999};
    tvi_system *L, *H;
    ck_assert_int_eq(tvi_system_lagrangian(&L, 2, relativistic, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_hamiltonian(&H, 2, relativistic_energy, NULL), TVI_OK);
    const double q[] = {0.5, -1}, v[] = {0.6 * speeds[_i], -0.8 * speeds[_i]},
                 gamma = 1 / sqrt(1 - speeds[_i] * speeds[_i]);
    double p[2], back[2], energy[2];
    ck_assert_int_eq(tvi_momentum(L, 0, q, v, p), TVI_OK);
    ck_assert_int_eq(tvi_velocity(L, 0, q, p, back), TVI_OK);
    for (int i = 0; i < 2; i++) {
        ck_assert_double_eq_tol(p[i], gamma * v[i], 1e-13 * gamma * gamma);
        ck_assert_double_eq_tol(back[i], v[i], 4e-15);
    }
    ck_assert_int_eq(tvi_velocity(H, 0, q, p, back), TVI_OK);
    ck_assert_double_eq_tol(back[0], v[0], 4e-15);
    ck_assert_int_eq(tvi_momentum(H, 0, q, v, back), TVI_OK);
    ck_assert_double_eq_tol(back[1], p[1], 1e-13 * gamma * gamma);
    ck_assert_int_eq(tvi_energy(L, 0, q, p, &energy[0]), TVI_OK);
    ck_assert_int_eq(tvi_energy(H, 0, q, p, &energy[1]), TVI_OK);
    ck_assert_double_eq_tol(energy[0], energy[1], 4e-15 * gamma);
    ck_assert_double_eq_tol(energy[0], gamma + 0.125, 1e-13 * gamma * gamma);
    tvi_system_free(L);
    tvi_system_free(H);
}
END_TEST

/* Both move alike, by what each can be run with; faster than light there is no momentum. */
START_TEST(relativistic_motion)
{
    tvi_system *L, *H;
    ck_assert_int_eq(tvi_system_lagrangian(&L, 2, relativistic, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_hamiltonian(&H, 2, relativistic_energy, NULL), TVI_OK);
    const tvi_options lagrange = options_type1(TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, 6);
    const tvi_options poincare = {.method = TVI_POINCARE, .expansion = TVI_AT_MIDPOINT, .degree = 5};
    const tvi_options of[] = {lagrange, lagrange, poincare};
    test_state end[3];
    for (int i = 0; i < 3; i++) {
        tvi_integrator *integrator = integrator_of(i == 0 ? L : H, &of[i]);
        end[i] = (test_state){.q = {1, 0}, .p = {2, -1}};
        go(integrator, 0.03125, 64, &end[i]);
        tvi_integrator_free(integrator);
    }
    ck_assert_double_lt(distance(2, &end[1], &end[0]), 1e-13);
    ck_assert_double_lt(distance(2, &end[2], &end[0]), 1e-11);
    ck_assert_double_gt(fabs(end[0].q[0] - 1), 0.5);
    const double q[] = {0, 0}, v[] = {1, 1};
    double p[] = {5, 5};
    ck_assert_int_eq(tvi_momentum(L, 0, q, v, p), TVI_EDOMAIN);
    ck_assert_double_eq(p[0], 5);
    tvi_system_free(L);
    tvi_system_free(H);
}
END_TEST

/* ---- Energies ---------------------------------------------------------------------------------------------------- */

/* Kepler, the chain, and the chain sheared in another gauge. */
START_TEST(statements_have_one_energy)
{
    static const struct {
        int n;
        tvi_potential_fn *V;
        tvi_lagrangian_fn *L;
        tvi_hamiltonian_fn *H;
        const double *mass;
        const model *m;
    } rows[] = {
        {2, kepler_as_potential, kepler_as_lagrangian, kepler_as_hamiltonian, NULL, &model_kepler},
        {3, chain_as_potential, chain_as_lagrangian, chain_as_hamiltonian, chain_masses, &model_chain},
        {3, NULL, sheared_lagrangian, sheared_hamiltonian, NULL, &model_sheared_lagrangian},
    };
    tvi_system *V = NULL, *L, *H;
    const test_state x = model_start(rows[_i].m);
    ck_assert_int_eq(tvi_system_lagrangian(&L, rows[_i].n, rows[_i].L, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_hamiltonian(&H, rows[_i].n, rows[_i].H, NULL), TVI_OK);
    const double energy = state_energy(H, &x);
    ck_assert_double_eq_tol(state_energy(L, &x), energy, 4e-15);
    if (rows[_i].V) {
        ck_assert_int_eq(tvi_system_potential(&V, rows[_i].n, rows[_i].mass, rows[_i].V, NULL), TVI_OK);
        ck_assert_double_eq_tol(state_energy(V, &x), energy, 4e-15);
    }
    tvi_system_free(V);
    tvi_system_free(L);
    tvi_system_free(H);
}
END_TEST

START_TEST(energies_are_those_by_hand)
{
    const double log_distances[] = {1.0625, 4.25, 1.5625, 1.5625, 1.625, 1.8125}, strength[] = {4, 1, 4, 0.25, 1, 0.25};
    double expected = 0; /* of the vortices, r^2 of the pairs 10 20 21 30 31 32 */
    for (int i = 0; i < 6; i++) expected -= strength[i] * log(log_distances[i]);
    const struct {
        const model *m;
        double energy;
    } rows[] = {
        {&model_nonseparable, (0.09 + 1) * (0.25 + 1) / 2},
        {&model_degenerate, 0.4 * sin(0.7) + cos(0.7)},
        {&model_vortices, expected},
        {&model_magnetic, 0.375 * (0.0625 + 1 + 0.25)},
    };
    tvi_system *system = model_system(rows[_i].m);
    const test_state x = model_start(rows[_i].m);
    ck_assert_double_eq_tol(state_energy(system, &x), rows[_i].energy, 4e-15);
    tvi_system_free(system);
}
END_TEST

/* L = -sqrt(1 - v^2) + q, so that p grows by h: the curve of a step ends faster than light, where no velocity is looked
 * for; the next step begins from rest. */
static jet pushed(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(q[0], jet_sqrt(jet_sub(1, jet_sqr(v[0]))));
}

START_TEST(velocities_are_not_looked_for_beyond_light)
{
    tvi_system *system;
    tvi_integrator *integrator;
    tvi_options options;
    double q = 0, p = 2, t = 0;
    ck_assert_int_eq(tvi_system_lagrangian(&system, 1, pushed, NULL), TVI_OK);
    ck_assert_int_eq(tvi_options_named("taylor", 1, &options), TVI_OK);
    options.max_tail = -1;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    for (int i = 1; i <= 3; i++) {
        ck_assert_int_eq(tvi_step(integrator, 1.3, &t, &q, &p), TVI_OK);
        ck_assert_double_eq_tol(p, 2 + 1.3 * i, 1e-14);
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

Suite *suite_points(void)
{
    Suite *suite = suite_create("points");
    TCase *tcase = tcase_create("points");
    tcase_add_loop_test(tcase, transforms_undo_each_other, 0, MODELS);
    tcase_add_test(tcase, momenta_are_those_by_hand);
    tcase_add_test(tcase, degenerate_has_velocities_only);
    tcase_add_loop_test(tcase, relativistic_mechanics, 0, 5);
    tcase_add_test(tcase, relativistic_motion);
    tcase_add_test(tcase, velocities_are_not_looked_for_beyond_light);
    tcase_add_loop_test(tcase, statements_have_one_energy, 0, 3);
    tcase_add_loop_test(tcase, energies_are_those_by_hand, 0, 4);
    suite_add_tcase(suite, tcase);
    return suite;
}
