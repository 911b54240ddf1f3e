/* test_refused.c - Tests bodies that are refused: the text names what is wrong, and nothing is made or written. */
#include "bodies.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double good[] = {1, 2, 3, 4}, second_negative[] = {1, -1e-3, 1}, third_negative[] = {1, 1e-3, -1e-9},
                    none[] = {0, 0}, no_number[] = {1, NAN}, no_limit[] = {-INFINITY, 1}, tiny[] = {1e-300, 0};

#define MEMBERS(count, masses) .bodies = count, .axes = 3, .mass = masses
static const struct {
    tvi_bodies bodies;
    tvi_status status;
    const char *text; /* how it begins */
} rows[] = {
    {{.bodies = 2, .axes = 0, .mass = good}, TVI_EINVAL, "axes = 0 is not from 1 to 3"},
    {{.bodies = 2, .axes = 4, .mass = good}, TVI_EINVAL, "axes = 4 is not"},
    {{.bodies = 2, .axes = -3, .mass = good}, TVI_EINVAL, "axes = -3 is not"},
    {{.bodies = 2, .axes = INT_MIN, .mass = good}, TVI_EINVAL, "axes = -2147483648 is not"},
    {{MEMBERS(2, NULL)}, TVI_EINVAL, "mass is NULL"},
    {{MEMBERS(3, second_negative)}, TVI_EINVAL, "mass[1] = -0.001 is negative"},
    {{MEMBERS(3, third_negative)}, TVI_EINVAL, "mass[2] = -1e-09 is negative"},
    {{MEMBERS(2, none)}, TVI_EINVAL, "all masses are 0"},
    {{MEMBERS(2, tiny)}, TVI_EINVAL, "mass[1] = 0 stands for 1e-30 of the largest mass, 1e-300"},
    {{MEMBERS(2, no_number)}, TVI_ENONFINITE, "mass[1] = "},
    {{MEMBERS(2, no_limit)}, TVI_ENONFINITE, "mass[0] = -inf is not finite"},
    {{MEMBERS(2, good), .G = INFINITY}, TVI_ENONFINITE, "G = inf is not finite"},
    {{MEMBERS(2, good), .softening = NAN}, TVI_ENONFINITE, "softening = "},
    {{MEMBERS(2, good), .J2 = NAN}, TVI_ENONFINITE, "J2 = "},
    {{MEMBERS(2, good), .J2 = 1e-3, .radius = INFINITY}, TVI_ENONFINITE, "radius = inf"},
    {{MEMBERS(2, good), .pole = {0, NAN, 1}}, TVI_ENONFINITE, "pole[1] = "},
    {{MEMBERS(2, good), .sharpness = INFINITY}, TVI_ENONFINITE, "sharpness = inf"},
    {{MEMBERS(2, good), .sharpness = -1}, TVI_EINVAL, "sharpness = -1 is negative"},
    {{MEMBERS(2, good), .J2 = 1e-3}, TVI_EINVAL, "J2 = 0.001 needs the radius of the oblate body, and radius = 0"},
    {{MEMBERS(2, good), .J2 = -1e-3, .radius = -1}, TVI_EINVAL, "J2 = -0.001 needs the radius"},
    {{MEMBERS(2, good), .J2 = 1e-3, .radius = 1, .oblate = 2}, TVI_EINVAL, "oblate = 2 is not from 0 to 1"},
    {{MEMBERS(2, good), .J2 = 1e-3, .radius = 1, .oblate = -1}, TVI_EINVAL, "oblate = -1 is not"},
};
enum { ROWS = sizeof rows / sizeof *rows };

static void expect_refused(const tvi_bodies *b, tvi_status status, const char *text)
{
    tvi_system *system = (tvi_system *)-1;
    ck_assert_int_eq(tvi_bodies_system(&system, b), status);
    ck_assert(!system);
    ck_assert_msg(!strncmp(tvi_last_error(), text, strlen(text)), "%s, not %s", tvi_last_error(), text);
    ck_assert_int_eq(tvi_bodies_check(b), status);
    ck_assert_msg(!strncmp(tvi_last_error(), text, strlen(text)), "%s, not %s", tvi_last_error(), text);
}

START_TEST(members) { expect_refused(&rows[_i].bodies, rows[_i].status, rows[_i].text); }
END_TEST

/* Counts out of range, among them those whose product with the axes is a good number modulo 2^32; and no bodies. */
START_TEST(counts_out_of_range)
{
    static const int bad[] = {0,       -1,         -1431655765, -1431655760, -1431652500,
                              INT_MIN, 1431655766, -2147483647, INT_MAX,     TVI_MAX_DIMENSION + 1};
    for (int axes = 1; axes <= 3; axes++)
        for (size_t k = 0; k <= sizeof bad / sizeof *bad; k++) {
            const int count = k < sizeof bad / sizeof *bad ? bad[k] : TVI_MAX_DIMENSION / axes + 1;
            char text[64];
            (void)snprintf(text, sizeof text, "bodies = %d is not from 1 to %d", count, TVI_MAX_DIMENSION / axes);
            expect_refused(&(tvi_bodies){.bodies = count, .axes = axes, .mass = good}, TVI_EINVAL, text);
        }
    expect_refused(NULL, TVI_EINVAL, "b is NULL");
}
END_TEST

/* A potential, a g or a field of the user's own, which calls those of bodies that are wrong. */
static jet own_potential(const jet q[], jet t, void *ctx) { return jet_add(tvi_bodies_potential(q, t, ctx), q[0]); }
static jet own_field(const jet q[], jet t, void *ctx)
{
    const jet at[6] = {{0, NULL}};
    (void)t;
    return tvi_bodies_field(ctx, at, q);
}
static jet plain(const jet q[], jet t, void *ctx) { return (void)t, (void)ctx, jet_dot(q, q, 6); }
static jet own_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    const jet at[6] = {{0, NULL}};
    return (void)p, (void)t, tvi_bodies_field_scale(ctx, at, q);
}

START_TEST(functions_of_jets)
{
    tvi_bodies b = rows[_i].bodies;
    tvi_system *system, *rescaled;
    ck_assert_int_eq(tvi_system_potential(&system, 6, NULL, own_potential, &b), TVI_ENONFINITE);
    ck_assert_int_eq(tvi_system_potential(&system, 6, NULL, own_field, &b), TVI_ENONFINITE);
    ck_assert_int_eq(tvi_system_potential(&system, 6, NULL, plain, NULL), TVI_OK);
    ck_assert_int_ne(tvi_system_rescaled(&rescaled, system, tvi_bodies_scale, &b), TVI_OK);
    ck_assert(!rescaled);
    ck_assert_int_ne(tvi_system_rescaled(&rescaled, system, own_scale, &b), TVI_OK);
    ck_assert(!rescaled);
    tvi_system_free(system);
}
END_TEST

/* Functions of states write nothing where counts are out of range. */
START_TEST(functions_of_states)
{
    static const int counts[][2] = {{-1, 3}, {-1431655765, 3}, {2, 4}, {2, -1}, {INT_MAX, 2}, {0, 3}, {INT_MIN, 1}};
    const tvi_bodies b = {.bodies = counts[_i][0], .axes = counts[_i][1], .mass = good};
    double x[12], y[12], before[12];
    for (int i = 0; i < 12; i++) x[i] = y[i] = before[i] = 7;
    tvi_bodies_masses(&b, x);
    tvi_bodies_momenta(&b, x, y);
    tvi_bodies_velocities(&b, x, y);
    tvi_bodies_centre(&b, before, before, x, y);
    tvi_bodies_to_centre(&b, x, y);
    tvi_bodies_angular_momentum(&b, before, before, x);
    ck_assert(!memcmp(x, before, sizeof x) && !memcmp(y, before, sizeof y));
}
END_TEST

/* The length of the pole does not matter, whatever it is. */
START_TEST(poles)
{
    static const double lengths[] = {1, 7, 1e-200, 1e200, 5e-324};
    const double q[] = {0.3, -0.5, 0.2, 1.5, 0.75, -1}, still[6] = {0};
    double V[2];
    for (size_t k = 0; k < sizeof lengths / sizeof *lengths; k++) {
        const tvi_bodies b = {MEMBERS(2, good), .J2 = 0.01, .radius = 0.4, .pole = {0, lengths[k]}};
        tvi_system *system;
        ck_assert_int_eq(tvi_bodies_system(&system, &b), TVI_OK);
        ck_assert_int_eq(tvi_energy(system, 0, q, still, &V[k > 0]), TVI_OK);
        ck_assert(V[k > 0] == V[0]);
        tvi_system_free(system);
    }
}
END_TEST

Suite *suite_refused(void)
{
    Suite *suite = suite_create("refused");
    TCase *tests = tcase_create("bodies");
    tcase_add_loop_test(tests, members, 0, ROWS);
    tcase_add_test(tests, counts_out_of_range);
    tcase_add_loop_test(tests, functions_of_jets, 0, ROWS);
    tcase_add_loop_test(tests, functions_of_states, 0, 7);
    tcase_add_test(tests, poles);
    suite_add_tcase(suite, tests);
    return suite;
}
