/* test_sums.c - Tests the centre of mass, and angular momentum in space and in the plane. */
#include "bodies.h"

#include <math.h>

static const double mass[] = {2, 3, 0.5};
static const double q[] = {1, -2, 0.5, 4, 1, 3, -1, 2, 2}, v[] = {0.1, 0.2, -0.3, 0, 0.5, 0.4, 1, -1, 0.25};

START_TEST(centre)
{
    const tvi_bodies b = {.bodies = 3, .axes = _i, .mass = mass};
    double place[9], p[9], x[3], u[3];
    for (int i = 0; i < 3 * _i; i++) place[i] = q[i];
    tvi_bodies_momenta(&b, v, p);
    for (int i = 0; i < 3 * _i; i++) ck_assert(p[i] == mass[i / _i] * v[i]);
    tvi_bodies_centre(&b, place, p, x, u);
    for (int k = 0; k < _i; k++) {
        double sum = 0, total = 0;
        for (int i = 0; i < 3; i++) sum += mass[i] * q[_i * i + k], total += mass[i] * v[_i * i + k];
        ck_assert_double_le(fabs(x[k] - sum / 5.5), 1e-15);
        ck_assert_double_le(fabs(u[k] - total / 5.5), 1e-15);
    }
    tvi_bodies_to_centre(&b, place, p);
    for (int i = _i; i < 3 * _i; i++) ck_assert_double_le(fabs(place[i] - place[i % _i] - q[i] + q[i % _i]), 1e-15);
    tvi_bodies_centre(&b, place, p, x, u);
    for (int k = 0; k < _i; k++) ck_assert_double_le(fmax(fabs(x[k]), fabs(u[k])), 1e-15);
    tvi_bodies_velocities(&b, p, p);
    for (int i = _i; i < 3 * _i; i++) ck_assert_double_le(fabs(p[i] - p[i % _i] - v[i] + v[i % _i]), 1e-15);
}
END_TEST

START_TEST(angular_momentum)
{
    static const double x[] = {1, 2, 3}, y[] = {-2, 5, 1}, one = 1;
    tvi_bodies b = {.bodies = 1, .axes = 3, .mass = &one};
    double L[3];
    tvi_bodies_angular_momentum(&b, x, y, L);
    ck_assert(L[0] == -13 && L[1] == -7 && L[2] == 9);
    b.axes = 2;
    tvi_bodies_angular_momentum(&b, x, y, L);
    ck_assert(L[0] == 0 && L[1] == 0 && L[2] == 9);
    b.axes = 1;
    tvi_bodies_angular_momentum(&b, x, y, L);
    ck_assert(L[0] == 0 && L[1] == 0 && L[2] == 0);
    b = (tvi_bodies){.bodies = 3, .axes = 1, .mass = mass};
    tvi_bodies_angular_momentum(&b, q, v, L);
    ck_assert(L[2] == 0);
}
END_TEST

Suite *suite_sums(void)
{
    Suite *suite = suite_create("sums");
    TCase *tests = tcase_create("sums");
    tcase_add_loop_test(tests, centre, 1, 4);
    tcase_add_test(tests, angular_momentum);
    suite_add_tcase(suite, tests);
    return suite;
}
