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
    const char *text; /* how it begins */
} wrong[] = {
    {{.q = 1, .e = -0.1}, 1, TVI_EINVAL, "e = -0.1 is negative"},
    {{.q = 1, .e = -1e-14}, 1, TVI_EINVAL, "e = -1e-14 is negative"},
    {{.q = -1, .e = 0.1}, 1, TVI_EINVAL, "q = -1 is not positive"},
    {{.e = 0.1}, 1, TVI_EINVAL, "neither a nor q is given"},
    {{.a = 1, .e = 1.5}, 1, TVI_EINVAL, "a = 1, e = 1.5: q = a (1 - e) = -0.5 is not positive and finite: a hyperbola"},
    {{.a = -1, .e = 0.5},
     1,
     TVI_EINVAL,
     "a = -1, e = 0.5: q = a (1 - e) = -0.5 is not positive and finite: an ellipse"},
    {{.a = 1, .e = 1}, 1, TVI_EINVAL, "a = 1, e = 1: q = a (1 - e) is not positive: a parabola needs q"},
    {{.a = HUGE_VAL, .e = 1}, 1, TVI_EINVAL, "a = inf, e = 1: q = a (1 - e) is not positive: a parabola needs q"},
    {{.a = 1, .q = 0.5, .e = 0.6}, 1, TVI_EINVAL, "a = 1, q = 0.5 and e = 0.6 disagree: q = a (1 - e) = 0.4."},
    {{.a = 0.5, .q = 3}, 1, TVI_EINVAL, "a = 0.5, q = 3 and e = 0 disagree: q = a (1 - e) = 0.5."},
    {{.a = 0.5, .q = 0.5000001}, 1, TVI_EINVAL, "a = 0.5, q = 0.5000001 and e = 0 disagree"},
    {{.a = 0.5, .q = 0.4999999}, 1, TVI_EINVAL, "a = 0.5, q = 0.4999999 and e = 0 disagree"},
    {{.a = -0.5, .q = 0.5}, 1, TVI_EINVAL, "a = -0.5, q = 0.5 and e = 0 disagree"},
    {{.a = HUGE_VAL, .q = 1, .e = 0.5}, 1, TVI_EINVAL, "a = inf, q = 1 and e = 0.5 disagree"},
    {{.a = HUGE_VAL, .e = 0.5}, 1, TVI_EINVAL, "a = inf, e = 0.5: q = a (1 - e) = inf is not positive and finite"},
    {{.q = 1, .e = 0.5, .i = -0.1}, 1, TVI_EINVAL, "i = -0.1 is not within [0, pi]: angles are in radians"},
    {{.q = 1, .e = 0.5, .i = -1e-17}, 1, TVI_EINVAL, "i = -1e-17 is not within [0, pi]: angles are in radians"},
    {{.q = 1, .e = 0.5, .i = 3.2}, 1, TVI_EINVAL, "i = 3.2 is not within [0, pi]: angles are in radians"},
    {{.q = 1, .e = 0.5}, 0, TVI_EINVAL, "mu = 0 is not positive"},
    {{.q = 1, .e = 0.5}, -1, TVI_EINVAL, "mu = -1 is not positive"},
    {{.a = NAN, .q = 1, .e = 0.5}, 1, TVI_ENONFINITE, "a = "},
    {{.q = NAN, .e = 0.5}, 1, TVI_ENONFINITE, "q = "},
    {{.q = HUGE_VAL, .e = 0.5}, 1, TVI_ENONFINITE, "q = inf is not finite"},
    {{.q = 1, .e = NAN}, 1, TVI_ENONFINITE, "e = "},
    {{.q = 1, .e = HUGE_VAL}, 1, TVI_ENONFINITE, "e = inf is not finite"},
    {{.q = 1, .e = 0.5, .i = NAN}, 1, TVI_ENONFINITE, "i = "},
    {{.q = 1, .e = 0.5, .node = HUGE_VAL}, 1, TVI_ENONFINITE, "node = inf is not finite"},
    {{.q = 1, .e = 0.5, .pericentre = NAN}, 1, TVI_ENONFINITE, "pericentre = "},
    {{.q = 1, .e = 0.5, .time = NAN}, 1, TVI_ENONFINITE, "time = "},
    {{.q = 1, .e = 0.5, .f = NAN}, 1, TVI_ENONFINITE, "f = "},
    {{.q = 1, .e = 0.5, .M = -HUGE_VAL}, 1, TVI_ENONFINITE, "M = -inf is not finite"},
    {{.q = 1, .e = 0.5, .mean_longitude = HUGE_VAL}, 1, TVI_ENONFINITE, "mean_longitude = inf"},
    {{.q = 1, .e = 0.5, .longitude_of_pericentre = NAN}, 1, TVI_ENONFINITE, "longitude_of_pericentre = "},
    {{.q = 1, .e = 0.5}, NAN, TVI_ENONFINITE, "mu = "},
    {{.q = 1, .e = 2, .time = 1e300},
     1e200,
     TVI_ENONFINITE,
     "time = 1e+300 leads to numbers that are too large"}, /* too far */
};
enum { WRONG = sizeof wrong / sizeof *wrong };

static void expect_text(const char *text)
{
    ck_assert_msg(!strncmp(tvi_last_error(), text, strlen(text)), "%s, not %s", tvi_last_error(), text);
}

START_TEST(elements_refused)
{
    double x[] = {1, 2, 3}, v[] = {4, 5, 6};
    ck_assert_int_eq(tvi_orbit_state(&wrong[_i].orbit, wrong[_i].mu, x, v), wrong[_i].status);
    expect_text(wrong[_i].text);
    ck_assert(x[0] == 1 && x[1] == 2 && x[2] == 3 && v[0] == 4 && v[1] == 5 && v[2] == 6);
}
END_TEST

static const struct {
    double mu, x[3], v[3];
    tvi_status status;
    const char *text;
} no_states[] = {
    {1, {0, 0, 0}, {0, 1, 0}, TVI_EDOMAIN, "x is 0"},
    {1, {1, 0, 0}, {0, 0, 0}, TVI_EDOMAIN, "x and v are on one line through the centre"},
    {1, {1, 2, 3}, {-2, -4, -6}, TVI_EDOMAIN, "x and v are on one line through the centre"},
    {0, {1, 0, 0}, {0, 1, 0}, TVI_EINVAL, "mu = 0 is not positive"},
    {-1, {1, 0, 0}, {0, 1, 0}, TVI_EINVAL, "mu = -1 is not positive"},
    {1, {NAN, 0, 0}, {0, 1, 0}, TVI_ENONFINITE, "x[0] = "},
    {1, {1, 0, 0}, {0, 1, HUGE_VAL}, TVI_ENONFINITE, "v[2] = inf is not finite"},
    {NAN, {1, 0, 0}, {0, 1, 0}, TVI_ENONFINITE, "mu = "},
    {1, {1e200, 0, 0}, {0, 1e200, 0}, TVI_ENONFINITE, "q = "},
};
enum { NO_STATES = sizeof no_states / sizeof *no_states };

START_TEST(states_refused)
{
    tvi_orbit o, before;
    memset(&o, 7, sizeof o);
    before = o;
    ck_assert_int_eq(tvi_orbit_of(no_states[_i].mu, no_states[_i].x, no_states[_i].v, &o), no_states[_i].status);
    expect_text(no_states[_i].text);
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
