/* test_elements.c - Tests elements that are known, what is special about angles, and what is no orbit. */
#include "bodies.h"

#include <math.h>
#include <string.h>

static const double DEGREE = 0.017453292519943295;

/* Curtis, Orbital Mechanics for Engineering Students, example 4.3: kilometres and seconds about the Earth. */
START_TEST(a_known_orbit)
{
    const double x[] = {-6045, -3490, 2500}, v[] = {-3.457, 6.618, 2.533};
    tvi_orbit o;
    ck_assert_int_eq(tvi_orbit_of(398600, x, v, &o), TVI_OK);
    ck_assert_double_le(fabs(o.a - 8788), 1);
    ck_assert_double_le(fabs(o.e - 0.1712), 1e-4);
    ck_assert_double_le(fabs(o.i / DEGREE - 153.2), 0.06);
    ck_assert_double_le(fabs(o.node / DEGREE + 360 - 255.3), 0.06);
    ck_assert_double_le(fabs(o.pericentre / DEGREE - 20.07), 0.006);
    ck_assert_double_le(fabs(o.f / DEGREE - 28.45), 0.006);
    ck_assert_double_le(fabs(o.time * sqrt(398600 / (o.a * o.a * o.a)) - o.M), 1e-14);
    ck_assert_double_le(fabs(o.q - o.a * (1 - o.e)), 1e-11);
}
END_TEST

/* The same orbit by a, by q, and by both. */
START_TEST(a_or_q)
{
    const tvi_orbit by_q = {.q = 0.75, .e = 0.25, .time = 2, .i = 1}, by_a = {.a = 1, .e = 0.25, .time = 2, .i = 1};
    tvi_orbit both = by_q;
    double x[3][3], v[3][3];
    both.a = 1;
    ck_assert_int_eq(tvi_orbit_state(&by_q, 1, x[0], v[0]), TVI_OK);
    ck_assert_int_eq(tvi_orbit_state(&by_a, 1, x[1], v[1]), TVI_OK);
    ck_assert_int_eq(tvi_orbit_state(&both, 1, x[2], v[2]), TVI_OK);
    ck_assert(!memcmp(x[0], x[1], sizeof x[0]) && !memcmp(x[0], x[2], sizeof x[0]));
    ck_assert(!memcmp(v[0], v[1], sizeof v[0]) && !memcmp(v[0], v[2], sizeof v[0]));
}
END_TEST

START_TEST(in_a_plane)
{
    const double x[] = {0, 2, 0}, pi = acos(-1);
    for (int way = -1; way <= 1; way += 2) {
        tvi_orbit o;
        ck_assert_int_eq(tvi_orbit_of(1, x, (const double[]){-0.5 * way, 0, 0}, &o), TVI_OK);
        ck_assert(o.i == (way > 0 ? 0 : pi) && o.node == 0);
        ck_assert_double_le(fabs(o.e - 0.5), 1e-15);
        ck_assert_double_le(fabs(fabs(o.f) - pi), 1e-15); /* the apocentre */
        ck_assert_double_le(fabs(o.pericentre + way * pi / 2), 1e-15);
    }
}
END_TEST

/* ---- What is no orbit -------------------------------------------------------------------------------------------- */

static const struct {
    tvi_orbit orbit;
    double mu;
    tvi_status status;
} wrong[] = {
    {{.q = 1, .e = -0.1}, 1, TVI_EINVAL},
    {{.q = 1, .e = -1e-14}, 1, TVI_EINVAL},
    {{.q = -1, .e = 0.1}, 1, TVI_EINVAL},
    {{.e = 0.1}, 1, TVI_EINVAL},         /* neither a nor q */
    {{.a = 1, .e = 1.5}, 1, TVI_EINVAL}, /* an ellipse's a, a hyperbola's e */
    {{.a = -1, .e = 0.5}, 1, TVI_EINVAL},
    {{.a = 1, .e = 1}, 1, TVI_EINVAL},             /* a parabola has no a */
    {{.a = 1, .q = 0.5, .e = 0.6}, 1, TVI_EINVAL}, /* q is not a (1 - e) */
    {{.a = HUGE_VAL, .q = 1, .e = 0.5}, 1, TVI_EINVAL},
    {{.a = HUGE_VAL, .e = 0.5}, 1, TVI_EINVAL},
    {{.q = 1, .e = 0.5, .i = -0.1}, 1, TVI_EINVAL},
    {{.q = 1, .e = 0.5, .i = 3.2}, 1, TVI_EINVAL},
    {{.q = 1, .e = 0.5}, 0, TVI_EINVAL},
    {{.q = 1, .e = 0.5}, -1, TVI_EINVAL},
    {{.a = NAN, .q = 1, .e = 0.5}, 1, TVI_EINVAL},
    {{.q = NAN, .e = 0.5}, 1, TVI_ENONFINITE},
    {{.q = 1, .e = NAN}, 1, TVI_ENONFINITE},
    {{.q = 1, .e = HUGE_VAL}, 1, TVI_ENONFINITE},
    {{.q = 1, .e = 0.5, .i = NAN}, 1, TVI_ENONFINITE},
    {{.q = 1, .e = 0.5, .node = HUGE_VAL}, 1, TVI_ENONFINITE},
    {{.q = 1, .e = 0.5, .pericentre = NAN}, 1, TVI_ENONFINITE},
    {{.q = 1, .e = 0.5, .time = NAN}, 1, TVI_ENONFINITE},
    {{.q = 1, .e = 0.5}, NAN, TVI_ENONFINITE},
    {{.q = 1, .e = 2, .time = 1e300}, 1e200, TVI_ENONFINITE}, /* too far */
};
enum { WRONG = sizeof wrong / sizeof *wrong };

START_TEST(elements_refused)
{
    double x[] = {1, 2, 3}, v[] = {4, 5, 6};
    ck_assert_int_eq(tvi_orbit_state(&wrong[_i].orbit, wrong[_i].mu, x, v), wrong[_i].status);
    ck_assert(x[0] == 1 && x[1] == 2 && x[2] == 3 && v[0] == 4 && v[1] == 5 && v[2] == 6);
}
END_TEST

static const struct {
    double mu, x[3], v[3];
    tvi_status status;
} no_states[] = {
    {1, {0, 0, 0}, {0, 1, 0}, TVI_EDOMAIN},
    {1, {1, 0, 0}, {0, 0, 0}, TVI_EDOMAIN},
    {1, {1, 2, 3}, {-2, -4, -6}, TVI_EDOMAIN},
    {0, {1, 0, 0}, {0, 1, 0}, TVI_EINVAL},
    {-1, {1, 0, 0}, {0, 1, 0}, TVI_EINVAL},
    {1, {NAN, 0, 0}, {0, 1, 0}, TVI_ENONFINITE},
    {1, {1, 0, 0}, {0, 1, HUGE_VAL}, TVI_ENONFINITE},
    {NAN, {1, 0, 0}, {0, 1, 0}, TVI_ENONFINITE},
    {1, {1e200, 0, 0}, {0, 1e200, 0}, TVI_ENONFINITE},
};
enum { NO_STATES = sizeof no_states / sizeof *no_states };

START_TEST(states_refused)
{
    tvi_orbit o, before;
    memset(&o, 7, sizeof o);
    before = o;
    ck_assert_int_eq(tvi_orbit_of(no_states[_i].mu, no_states[_i].x, no_states[_i].v, &o), no_states[_i].status);
    ck_assert(!memcmp(&o, &before, sizeof o));
}
END_TEST

Suite *suite_elements(void)
{
    Suite *suite = suite_create("elements");
    TCase *known = tcase_create("known"), *refused = tcase_create("refused");
    tcase_add_test(known, a_known_orbit);
    tcase_add_test(known, a_or_q);
    tcase_add_test(known, in_a_plane);
    suite_add_tcase(suite, known);
    tcase_add_loop_test(refused, elements_refused, 0, WRONG);
    tcase_add_loop_test(refused, states_refused, 0, NO_STATES);
    suite_add_tcase(suite, refused);
    return suite;
}
