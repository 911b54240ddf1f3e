/* test_places.c - Tests what says the place of a body on its orbit: time, true and mean anomaly and mean longitude, one
 * of them or several that agree, and the two angles that say the pericentre. */
#include "bodies.h"
#include "problems/random.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static uint64_t bits;

static double between(double low, double high) { return low + (high - low) * number_of(&bits); }

static double length(const double x[3]) { return sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]); }

static double distance(const double x[3], const double y[3])
{
    return length((const double[3]){x[0] - y[0], x[1] - y[1], x[2] - y[2]});
}

/* The orbits are ellipses, hyperbolas, and both near parabolas, at times that are some units of their pericentres. */
typedef enum { ELLIPSES, HYPERBOLAS, NEAR_PARABOLAS, KINDS } kind_of_orbit;

/* All elements of an orbit at random, and its state. */
static tvi_orbit random_orbit(kind_of_orbit kind, double mu, double x[3], double v[3])
{
    const double e = kind == ELLIPSES ? between(0.1, 0.9) : between(1.1, 5), size = pow(10, between(-2, 2));
    tvi_orbit o = {.q = size, .e = e, .i = between(0, 3), .node = between(-3, 3), .pericentre = between(-3, 3)};
    if (kind == NEAR_PARABOLAS) o.e = 1 + (whole(&bits, 2) ? 1 : -1) * pow(10, between(-9, -2));
    o.time = between(-5, 5) * sqrt(size * size * size / mu);
    ck_assert_int_eq(tvi_orbit_state(&o, mu, x, v), TVI_OK);
    ck_assert_int_eq(tvi_orbit_of(mu, x, v, &o), TVI_OK);
    return o;
}

/* ---- One of them ------------------------------------------------------------------------------------------------- */

/* The place that f says is that of r = q (1 + e) / (1 + e cos f), and the velocity that of its derivative. */
START_TEST(true_anomalies)
{
    bits = 11;
    for (int k = 0; k < 2000; k++) {
        const double e = k % 3 == 0 ? 1 : between(0, k % 3), q = between(0.1, 3), mu = between(0.1, 3);
        const double asymptote = e < 1 ? acos(-1) : acos(-1 / e), f = between(-0.95, 0.95) * asymptote;
        const double turns = 2 * acos(-1) * (k % 5 - 2), r = q * (1 + e) / (1 + e * cos(f)), h = sqrt(mu / q / (1 + e));
        const tvi_orbit o = {.q = q, .e = e, .f = f + turns};
        double x[3], v[3];
        ck_assert_int_eq(tvi_orbit_state(&o, mu, x, v), TVI_OK);
        const double unit = 40 * DBL_EPSILON / (1 + e * cos(f)) * (1 + fabs(turns)); /* cancels at the asymptote */
        ck_assert_double_le(distance(x, (const double[3]){r * cos(f), r * sin(f), 0}), unit * r);
        ck_assert_double_le(distance(v, (const double[3]){-h * sin(f), h * (e + cos(f)), 0}), unit * h * (1 + e));
    }
}
END_TEST

/* The state is the same by whichever element says the place, and by whichever angle says the pericentre. */
START_TEST(one_alone)
{
    static const char *const names[] = {"time", "f", "M", "mean_longitude"};
    bits = 23 + (uint64_t)_i;
    for (int k = 0; k < 3000; k++) {
        const double mu = pow(10, between(-2, 2));
        double x[3], v[3], y[3], w[3];
        const tvi_orbit all = random_orbit((kind_of_orbit)_i, mu, x, v);
        const double radian[] = {fabs(all.time), fabs(all.f) * length(x) * length(x) / sqrt(mu * all.q * (1 + all.e)),
                                 fabs(all.time), (fabs(all.mean_longitude) + 6) * fabs(all.time / all.M)};
        for (int which = 0; which < 8; which++) {
            tvi_orbit o = all;
            double *const places[] = {&o.time, &o.f, &o.M, &o.mean_longitude};
            for (int other = 0; other < 4; other++)
                if (other != which / 2) *places[other] = 0;
            *(which % 2 ? &o.pericentre : &o.longitude_of_pericentre) = 0;
            ck_assert_int_eq(tvi_orbit_state(&o, mu, y, w), TVI_OK);
            /* what a unit of roundoff in the angles, in a and in this element does */
            const double unit = 8 * DBL_EPSILON, along = 2.5 * fabs(all.time) + radian[which / 2];
            ck_assert_msg(distance(x, y) <= unit * (12 * length(x) + along * length(v)), "%s", names[which / 2]);
            ck_assert_msg(distance(v, w) <= unit * (12 * length(v) + along * mu / (length(x) * length(x))), "%s",
                          names[which / 2]);
        }
    }
}
END_TEST

/* Without any of them a body is at its pericentre; and angles of several turns are those without. */
START_TEST(pericentre_and_turns)
{
    const double turn = 2 * acos(-1);
    const tvi_orbit still = {.a = 2, .e = 0.5, .node = 0.3, .pericentre = 0.4};
    tvi_orbit rows[5], one = still;
    double x[2][3], v[2][3];
    ck_assert_int_eq(tvi_orbit_state(&still, 1, x[0], v[0]), TVI_OK);
    ck_assert_double_le(fabs(length(x[0]) - 1), 1e-15);
    one.M = 0.7;
    ck_assert_int_eq(tvi_orbit_state(&one, 1, x[0], v[0]), TVI_OK);
    for (int k = 0; k < 5; k++) rows[k] = still;
    rows[0].M = 0.7 - 3 * turn, rows[1].mean_longitude = 1.4, rows[2].mean_longitude = 1.4 + 2 * turn;
    rows[3].time = (0.7 + turn) * sqrt(8), rows[4].M = 0.7, rows[4].mean_longitude = 1.4 - turn;
    rows[4].longitude_of_pericentre = 0.7 + 4 * turn, rows[4].time = (0.7 - 2 * turn) * sqrt(8);
    for (int k = 0; k < 5; k++) {
        ck_assert_int_eq(tvi_orbit_state(&rows[k], 1, x[1], v[1]), TVI_OK);
        ck_assert_double_le(distance(x[0], x[1]) + distance(v[0], v[1]), 1e-13);
    }
}
END_TEST

/* ---- Several of them --------------------------------------------------------------------------------------------- */

/* The elements of a state are accepted, also with one of them changed by 1e-14 of itself. A change by 1e-9 is refused:
 * the text names the element and another one, and the user's vectors stay. */
START_TEST(one_changed)
{
    static const char *const names[] = {
        "time = ", "f = ", "M = ", "mean_longitude = ", "pericentre = ", "longitude_of_pericentre = "};
    bits = 31 + (uint64_t)_i;
    for (int k = 0; k < 1000; k++) {
        const double mu = pow(10, between(-2, 2)), part = 1e-9;
        double x[3], v[3], y[3] = {7, 7, 7}, w[3] = {7, 7, 7};
        const tvi_orbit all = random_orbit((kind_of_orbit)_i, mu, x, v);
        for (int which = 0; which < 6; which++) {
            tvi_orbit o = all;
            double *const members[] = {&o.time,           &o.f,          &o.M,
                                       &o.mean_longitude, &o.pericentre, &o.longitude_of_pericentre};
            const double before = *members[which], scale = which < 3 ? fabs(before) : fabs(before) + 6;
            *members[which] = before + 1e-5 * part * scale;
            double near_x[3], near_v[3];
            ck_assert_int_eq(tvi_orbit_state(&o, mu, near_x, near_v), TVI_OK);
            *members[which] = before + part * scale;
            ck_assert_int_eq(tvi_orbit_state(&o, mu, y, w), TVI_EINVAL);
            ck_assert_msg(strstr(tvi_last_error(), names[which]) && strstr(tvi_last_error(), "disagree"), "%s: %s",
                          names[which], tvi_last_error());
            ck_assert(y[0] == 7 && y[2] == 7 && w[0] == 7 && w[2] == 7);
        }
    }
}
END_TEST

static const struct {
    tvi_orbit orbit;
    tvi_status status;
    const char *text; /* how it begins, of what is refused */
} rows[] = {
    {{.a = 1, .M = 1, .f = 1}, TVI_OK, ""}, /* on a circle */
    {{.a = 1, .M = 1, .time = 1, .mean_longitude = 1, .f = 1}, TVI_OK, ""},
    {{.a = 1, .e = 0.1, .M = 1, .f = 1}, TVI_EINVAL, "f = 1 and M = 1 disagree: there M = 0.83"},
    {{.a = 1, .e = 0.1, .M = 1, .time = 2}, TVI_EINVAL, "time = 2 and M = 1 disagree: there M = 2. Give one of them"},
    {{.a = 1, .e = 0.1, .M = 1, .time = 1}, TVI_OK, ""},
    {{.a = 1, .e = 0.1, .M = -0.0, .time = 1}, TVI_EINVAL, "time = 1 and M = 0 disagree: there M = 1."},
    {{.a = 1, .e = 0.1, .M = 1, .time = -0.0}, TVI_EINVAL, "time = 0 and M = 1 disagree: there M = 0."},
    {{.a = 1, .e = 0.1, .M = 1, .f = -0.0}, TVI_EINVAL, "f = 0 and M = 1 disagree"},
    {{.a = 1, .e = 0.1, .M = -0.0, .f = -0.0, .time = -0.0}, TVI_OK, ""},
    {{.a = 1, .node = 1, .M = 1, .mean_longitude = 1},
     TVI_EINVAL,
     "M = 1 and mean_longitude = 1 disagree: there mean_longitude = 2."},
    {{.a = 1, .node = 1, .M = 1, .mean_longitude = 2}, TVI_OK, ""},
    {{.a = 1, .node = 1, .pericentre = 2, .longitude_of_pericentre = 2},
     TVI_EINVAL,
     "pericentre = 2 and longitude_of_pericentre = 2 disagree: node + pericentre = 3. Give one of them"},
    {{.a = 1, .node = 1, .pericentre = -0.0, .longitude_of_pericentre = 2}, TVI_EINVAL, "pericentre = 0 and longitude"},
    {{.a = 1, .node = 1, .pericentre = 2, .longitude_of_pericentre = -0.0}, TVI_EINVAL, "pericentre = 2 and longitude"},
    {{.q = 1, .e = 1, .M = 0.5}, TVI_EINVAL, "M = 0.5, e = 1: M of a parabola is 0. Give time or f"},
    {{.q = 1, .e = 1, .M = 0.5, .f = 1}, TVI_EINVAL, "M = 0.5, e = 1: M of a parabola is 0."},
    {{.q = 1, .e = 1, .mean_longitude = 0.5}, TVI_EINVAL, "mean_longitude = 0.5, e = 1: M of a parabola is 0."},
    {{.q = 1, .e = 1, .M = -0.0, .f = 1}, TVI_OK, ""},
    {{.q = 1, .e = 1, .node = 0.5, .mean_longitude = 0.5, .f = 1}, TVI_OK, ""},
    {{.q = 1, .e = 1, .f = 3.141592653589793}, TVI_EINVAL, "f = 3.14159 is not within the asymptotes of e = 1"},
    {{.q = 1, .e = 2, .f = 2.1}, TVI_EINVAL, "f = 2.1 is not within the asymptotes of e = 2, +-2.0944"},
    {{.q = 1, .e = 2, .f = -2.1}, TVI_EINVAL, "f = -2.1 is not"},
    {{.q = 1, .e = 2, .f = 3.5}, TVI_EINVAL, "f = 3.5 is not"},
    {{.q = 1, .e = 2, .f = 2}, TVI_OK, ""},
    {{.q = 1, .e = 2, .f = 6}, TVI_OK, ""}, /* beside the pericentre */
    {{.q = 1, .e = 0.9, .f = 3.141592653589793}, TVI_OK, ""},
    {{.q = 1, .e = 2, .time = 100, .f = 2.2}, TVI_EINVAL, "time = 100 and f = 2.2 disagree"},
    {{.q = 1, .e = 2, .M = 1, .mean_longitude = 1 + 6.283185307179586}, TVI_EINVAL, "M = 1 and mean_longitude"},
    {{.a = 1e300, .M = 1}, TVI_OK, ""},
    {{.q = 1e-300, .e = 1e8, .M = 1e300}, TVI_ENONFINITE, "M = 1e+300 leads to numbers"},
    {{.q = 1.7157, .e = 8.2e247, .time = 1.71e-120}, TVI_ENONFINITE, "time = 1.71e-120 leads to numbers"},
};
enum { ROWS = sizeof rows / sizeof *rows };

START_TEST(agreement)
{
    double x[3] = {7, 7, 7}, v[3] = {7, 7, 7};
    const tvi_status status = tvi_orbit_state(&rows[_i].orbit, 1, x, v);
    ck_assert_msg(status == rows[_i].status, "status %d: %s", status, tvi_last_error());
    ck_assert((status == TVI_OK) == (x[0] != 7));
    if (status == TVI_OK) return;
    ck_assert_msg(!strncmp(tvi_last_error(), rows[_i].text, strlen(rows[_i].text)), "%s", tvi_last_error());
}
END_TEST

/* A state at the pericentre goes there and back, where time, f and M are 0 and the mean longitude is not. */
START_TEST(at_the_pericentre)
{
    bits = 71;
    for (int k = 0; k < 5000; k++) {
        const double a = between(0.1, 1), b = between(0.1, 1), e = between(0, 1.2);
        const double x[] = {a, b, 0}, v[] = {-b, a, between(-1, 1)}, mu = length(v) * length(v) * length(x) / (1 + e);
        double y[3], w[3];
        tvi_orbit o;
        ck_assert_int_eq(tvi_orbit_of(mu, x, v, &o), TVI_OK);
        if (o.f != 0) continue; /* it is the apocentre of a circle */
        ck_assert(o.time == 0 && o.M == 0);
        ck_assert_int_eq(tvi_orbit_state(&o, mu, y, w), TVI_OK);
        ck_assert_double_le(distance(x, y), 16 * DBL_EPSILON * length(x));
        ck_assert_double_le(distance(v, w), 16 * DBL_EPSILON * length(v));
    }
}
END_TEST

/* An orbit of a state at another place, as the header says. */
START_TEST(another_place)
{
    const double x[] = {1, 0.2, 0.1}, v[] = {-0.1, 0.9, 0.2};
    double y[3], w[3];
    tvi_orbit o, later;
    ck_assert_int_eq(tvi_orbit_of(1, x, v, &o), TVI_OK);
    later = o, later.time += 3;
    ck_assert_int_eq(tvi_orbit_state(&later, 1, y, w), TVI_EINVAL);
    later.f = later.M = later.mean_longitude = 0;
    ck_assert_int_eq(tvi_orbit_state(&later, 1, y, w), TVI_OK);
    ck_assert_int_eq(tvi_orbit_of(1, y, w, &later), TVI_OK);
    const double turn = 2 * acos(-1) * pow(o.a, 1.5);
    ck_assert_double_le(fabs(remainder(later.time - o.time - 3, turn)), 1e-13);
}
END_TEST

Suite *suite_places(void)
{
    Suite *suite = suite_create("places");
    TCase *one = tcase_create("one"), *several = tcase_create("several");
    tcase_add_test(one, true_anomalies);
    tcase_add_loop_test(one, one_alone, 0, KINDS);
    tcase_add_test(one, pericentre_and_turns);
    suite_add_tcase(suite, one);
    tcase_add_loop_test(several, one_changed, 0, KINDS);
    tcase_add_loop_test(several, agreement, 0, ROWS);
    tcase_add_test(several, at_the_pericentre);
    tcase_add_test(several, another_place);
    suite_add_tcase(suite, several);
    return suite;
}
