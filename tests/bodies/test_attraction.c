/* test_attraction.c - Tests the potential: tapes as of what is written by hand, softening, an oblate body, test
 * particles. */
#include "bodies.h"
#include "method/fingerprint.h"
#include "scenes/hard.h"
#include "tape.h"

#include <math.h>
#include <string.h>

/* ---- By hand ----------------------------------------------------------------------------------------------------- */

enum { MANY = 13, MOST_PAIRS = MANY * (MANY - 1) / 2, CROWD = 50 };

/* The loop that users write, with softening. */
static jet by_hand(const jet q[], jet t, void *ctx)
{
    const tvi_bodies *b = ctx;
    jet term[MOST_PAIRS];
    int pairs = 0;
    (void)t;
    for (int i = 1; i < b->bodies; i++)
        for (int j = 0; j < i; j++) {
            jet d[3];
            for (int k = 0; k < b->axes; k++) d[k] = jet_sub(q[b->axes * i + k], q[b->axes * j + k]);
            const jet square = jet_add(jet_dot(d, d, b->axes), b->softening * b->softening);
            term[pairs++] = jet_mul(-b->G * b->mass[i] * b->mass[j], jet_pow(square, -0.5));
        }
    return jet_sum(term, pairs);
}

static void expect_same_tapes(const tvi_system *one, const tvi_system *other)
{
    ck_assert(tvi_system_fingerprint(one) == tvi_system_fingerprint(other));
    ck_assert(jet_tape_continue_hash(JET_HASH_OF_NOTHING, one->energy.tape) ==
              jet_tape_continue_hash(JET_HASH_OF_NOTHING, other->energy.tape));
}

/* In 1, 2 and 3 axes. */
START_TEST(tapes_by_hand)
{
    double mass[MANY], of_coordinates[3 * MANY];
    for (int i = 0; i < MANY; i++) mass[i] = 1.0 / (i + 3);
    for (int softened = 0; softened < 2; softened++) {
        tvi_bodies b = {.bodies = MANY, .axes = _i, .mass = mass, .G = 2.95912208286e-4, .softening = 0.1 * softened};
        tvi_system *made, *wanted;
        tvi_bodies_masses(&b, of_coordinates);
        for (int i = 0; i < MANY * _i; i++) ck_assert(of_coordinates[i] == mass[i / _i]);
        ck_assert_int_eq(tvi_bodies_system(&made, &b), TVI_OK);
        ck_assert_int_eq(tvi_system_potential(&wanted, MANY * _i, of_coordinates, by_hand, &b), TVI_OK);
        expect_same_tapes(made, wanted);
        tvi_system_free(made);
        b.G *= 1 + 1e-15; /* a control: another constant is another tape */
        ck_assert_int_eq(tvi_bodies_system(&made, &b), TVI_OK);
        ck_assert(tvi_system_fingerprint(made) != tvi_system_fingerprint(wanted));
        tvi_system_free(made);
        tvi_system_free(wanted);
    }
}
END_TEST

/* The scenes of the bench. */
START_TEST(tapes_of_scenes)
{
    static const double pythagorean[] = {3, 4, 5}, planets[] = {1, 1e-3, 1e-3, 1e-3};
    double sun[6];
    for (int i = 0; i < 6; i++) sun[i] = scene_solar.mass[3 * i];
    const struct {
        tvi_bodies bodies;
        const scene *by_hand;
    } rows[] = {{{.bodies = 3, .axes = 2, .mass = pythagorean}, &hard_pythagorean.scene},
                {{.bodies = 4, .axes = 2, .mass = planets}, &hard_three_planets.scene},
                {{.bodies = 6, .axes = 3, .mass = sun, .G = 2.95912208286e-4}, &scene_solar}};
    tvi_system *made, *wanted;
    ck_assert_int_eq(tvi_bodies_system(&made, &rows[_i].bodies), TVI_OK);
    ck_assert_int_eq(scene_system(rows[_i].by_hand, &wanted), TVI_OK);
    expect_same_tapes(made, wanted);
    tvi_system_free(made);
    tvi_system_free(wanted);
}
END_TEST

/* ---- Values ------------------------------------------------------------------------------------------------------ */

static double potential_at(const tvi_bodies *b, const double q[])
{
    const double still[CROWD] = {0};
    double V = 0;
    tvi_system *system;
    ck_assert_int_eq(tvi_bodies_system(&system, b), TVI_OK);
    ck_assert_int_eq(tvi_energy(system, 0, q, still, &V), TVI_OK);
    tvi_system_free(system);
    return V;
}

/* More pairs than one part of the sum has, among which two test particles have none. */
START_TEST(a_crowd)
{
    double mass[CROWD], q[CROWD], V = 0;
    const tvi_bodies b = {.bodies = CROWD, .axes = 1, .mass = mass};
    for (int i = 0; i < CROWD; i++) mass[i] = i < CROWD - 2 ? 1 + 0.1 * i : 0, q[i] = i + 0.3 * sin(i);
    for (int i = 0; i < CROWD; i++)
        for (int j = 0; j < i; j++) V -= mass[i] * mass[j] / fabs(q[i] - q[j]);
    ck_assert_double_le(fabs(potential_at(&b, q) / V - 1), 1e-14);
}
END_TEST

/* -G m_1 m_2 / r (1 - J2 (R/r)^2 P2(z/r)), whatever body is oblate and whatever the pole's length. */
START_TEST(an_oblate_body)
{
    static const double mass[] = {2, 3}, q[] = {0.3, -0.5, 0.2, 1.5, 0.75, -1}, pole[] = {2, -3, 6};
    tvi_bodies b = {.bodies = 2, .axes = 3, .mass = mass, .G = 1.5, .J2 = 0.01, .radius = 0.4, .oblate = _i};
    const double d[] = {q[3] - q[0], q[4] - q[1], q[5] - q[2]}, r = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (int tilted = 0; tilted < 2; tilted++) {
        const double z = tilted ? (2 * d[0] - 3 * d[1] + 6 * d[2]) / 7 : d[2], P2 = 1.5 * z * z / (r * r) - 0.5;
        if (tilted) memcpy(b.pole, pole, sizeof pole);
        ck_assert_double_le(fabs(potential_at(&b, q) + 9 / r * (1 - 0.01 * 0.16 / (r * r) * P2)), 1e-15);
    }
    b.axes = 2, memset(b.pole, 0, sizeof b.pole); /* in the plane of the equator */
    const double s = hypot(q[2] - q[0], q[3] - q[1]);
    ck_assert_double_le(fabs(potential_at(&b, q) + 9 / s * (1 + 0.005 * 0.16 / (s * s))), 5e-15);
}
END_TEST

/* The node of a satellite goes back by 3 pi J2 (R/p)^2 cos i a revolution, and L along the pole stays. */
START_TEST(the_node_of_a_satellite)
{
    static const double mass[] = {1, 0};
    const double pi = acos(-1), J2 = 1e-4;
    const tvi_bodies b = {.bodies = 2, .axes = 3, .mass = mass, .J2 = J2, .radius = 1};
    tvi_orbit o = {.a = 2, .e = 0.1, .i = 1, .node = 0.5, .pericentre = 0.3};
    double t = 0, q[6] = {0}, v[6] = {0}, p[6], L[2][3];
    tvi_system *system;
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_orbit_state(&o, 1, q + 3, v + 3), TVI_OK);
    tvi_bodies_momenta(&b, v, p);
    tvi_bodies_angular_momentum(&b, q, p, L[0]);
    ck_assert_int_eq(tvi_bodies_system(&system, &b), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrate_to(integrator, 1, 20 * pi * sqrt(8), &t, q, p, NULL, NULL), TVI_OK);
    tvi_bodies_velocities(&b, p, v);
    tvi_bodies_angular_momentum(&b, q, p, L[1]);
    for (int k = 0; k < 3; k++) q[k] = q[3 + k] - q[k], v[k] = v[3 + k] - v[k];
    ck_assert_int_eq(tvi_orbit_of(1, q, v, &o), TVI_OK);
    const double wanted = -10 * 3 * pi * J2 * cos(1) / pow(2 * (1 - 0.01), 2);
    ck_assert_double_le(fabs(o.node - 0.5 - wanted), 0.02 * fabs(wanted));
    ck_assert_double_le(fabs(L[1][2] / L[0][2] - 1), 1e-14);
    ck_assert_double_ge(fabs(L[1][0] / L[0][0] - 1), 1e-4);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* ---- Test particles ---------------------------------------------------------------------------------------------- */

static void run_bodies(const tvi_bodies *b, double q[], double v[])
{
    double t = 0;
    tvi_system *system;
    tvi_integrator *integrator;
    tvi_bodies_momenta(b, v, v);
    ck_assert_int_eq(tvi_bodies_system(&system, b), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrate(integrator, 0.25, 100, &t, q, v, NULL, NULL), TVI_OK);
    tvi_bodies_velocities(b, v, v);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}

/* Two of them on the orbit of one that is alone, while heavy bodies move as without any. */
START_TEST(test_particles)
{
    static const double mass[] = {1, 0.5, 0, 0};
    static const double q0[] = {-0.5, 0, 1, 0, 3, 0, 3, 0}, v0[] = {0, -0.3, 0, 0.6, 0, 0.7, 0, 0.7};
    double q[3][8], v[3][8];
    for (int count = 2; count <= 4; count++) {
        const tvi_bodies b = {.bodies = count, .axes = 2, .mass = mass};
        memcpy(q[count - 2], q0, sizeof q0);
        memcpy(v[count - 2], v0, sizeof v0);
        run_bodies(&b, q[count - 2], v[count - 2]);
    }
    for (int i = 0; i < 4; i++) ck_assert_double_le(fabs(q[0][i] - q[2][i]), 1e-13);
    for (int i = 4; i < 6; i++) {
        ck_assert_double_le(fabs(q[1][i] - q[2][i]), 1e-12);
        ck_assert_double_le(fabs(q[2][i] - q[2][i + 2]), 1e-12); /* nothing pulls them apart, though r is 0 */
    }
    ck_assert_double_ge(fabs(q[2][4] - 3), 0.1);
}
END_TEST

Suite *suite_attraction(void)
{
    Suite *suite = suite_create("attraction");
    TCase *tapes = tcase_create("tapes"), *values = tcase_create("values");
    tcase_add_loop_test(tapes, tapes_by_hand, 1, 4);
    tcase_add_loop_test(tapes, tapes_of_scenes, 0, 3);
    suite_add_tcase(suite, tapes);
    tcase_add_test(values, a_crowd);
    tcase_add_loop_test(values, an_oblate_body, 0, 2);
    tcase_add_test(values, the_node_of_a_satellite);
    tcase_add_test(values, test_particles);
    suite_add_tcase(suite, values);
    return suite;
}
