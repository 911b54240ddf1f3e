/* test_identity.c - Tests identities between operations, and pairs of inverses: both sides have the same series and the
 * same tangents to degree 40. */
#include "record.h"
#include "suites.h"

#include <string.h>

/* row(name, centre of x, centre of y, left, right, witness): left = right, with roundoff of the size of the witness. */
#define IDENTITIES(ROW)                                                                                                \
    ROW(pythagoras, 0.7, 0, jet_add(jet_sqr(jet_sin(x)), jet_sqr(jet_cos(x))), jet_const(1), jet_sqr(jet_sin(x)))      \
    ROW(hyperbola, 0.7, 0, jet_sub(jet_sqr(jet_cosh(x)), jet_sqr(jet_sinh(x))), jet_const(1), jet_sqr(jet_cosh(x)))    \
    ROW(exp_of_log, 0.7, 0, jet_exp(jet_log(x)), x, jet_log(x))                                                        \
    ROW(log_of_exp, -0.7, 0, jet_log(jet_exp(x)), x, jet_exp(x))                                                       \
    ROW(chain_of_logs, 0, -0.3, jet_log(jet_log(jet_exp(jet_exp(y)))), y, jet_exp(jet_exp(y)))                         \
    ROW(chain_of_roots, 0, 0.8, jet_sqrt(jet_sqrt(jet_sqr(jet_sqr(y)))), y, jet_sqr(jet_sqr(y)))                       \
    ROW(root_of_square, 0.7, 0, jet_sqrt(jet_sqr(x)), x, jet_sqr(x))                                                   \
    ROW(square_of_root, 0.7, 0, jet_sqr(jet_sqrt(x)), x, jet_sqrt(x))                                                  \
    ROW(root_times_root, 0.7, 1.1, jet_mul(jet_sqrt(x), jet_sqrt(y)), jet_sqrt(jet_mul(x, y)), jet_sqrt(y))            \
    ROW(sin_of_asin, 0.4, 0, jet_sin(jet_asin(x)), x, jet_asin(x))                                                     \
    ROW(asin_of_sin, -0.8, 0, jet_asin(jet_sin(x)), x, jet_tan(x))                                                     \
    ROW(cos_of_acos, 0.4, 0, jet_cos(jet_acos(x)), x, jet_acos(x))                                                     \
    ROW(acos_of_cos, 0.8, 0, jet_acos(jet_cos(x)), x, jet_tan(x))                                                      \
    ROW(tan_of_atan, 0.4, 0, jet_tan(jet_atan(x)), x, jet_atan(x))                                                     \
    ROW(atan_of_tan, 0.8, 0, jet_atan(jet_tan(x)), x, jet_tan(x))                                                      \
    ROW(asin_plus_acos, 0.4, 0, jet_add(jet_asin(x), jet_acos(x)), jet_const(1.5707963267948966), jet_asin(x))         \
    ROW(tan_is_quotient, 0.8, 0, jet_tan(x), jet_div(jet_sin(x), jet_cos(x)), jet_tan(x))                              \
    ROW(tanh_is_quotient, -0.8, 0, jet_tanh(x), jet_div(jet_sinh(x), jet_cosh(x)), jet_tanh(x))                        \
    ROW(tanh_by_exp, 0.8, 0, jet_tanh(x), jet_sub(1, jet_div(2, jet_add(1, jet_exp(jet_mul(2, x))))), jet_tanh(x))     \
    ROW(sinh_by_exp, 0.8, 0, jet_sinh(x), jet_div(jet_sub(jet_exp(x), jet_exp(jet_neg(x))), 2), jet_exp(x))            \
    ROW(cosh_by_exp, 0.8, 0, jet_cosh(x), jet_div(jet_add(jet_exp(x), jet_exp(jet_neg(x))), 2), jet_exp(x))            \
    ROW(quotient_times, 0.8, -1.3, jet_mul(jet_div(x, y), y), x, jet_div(x, y))                                        \
    ROW(times_reciprocal, 0.8, -1.3, jet_div(x, y), jet_mul(x, jet_div(1, y)), jet_div(1, y))                          \
    ROW(reciprocal_twice, 0.8, 0, jet_div(1, jet_div(1, x)), x, jet_div(1, x))                                         \
    ROW(power_times_inverse, 0.8, 0, jet_mul(jet_pow(x, 1.3), jet_pow(x, -1.3)), jet_const(1), jet_pow(x, -1.3))       \
    ROW(power_of_power, 0.8, 0, jet_pow(jet_pow(x, 1.7), 1 / 1.7), x, jet_pow(x, 1.7))                                 \
    ROW(powers_add, 0.8, 0, jet_mul(jet_pow(x, 0.4), jet_pow(x, 1.8)), jet_pow(x, 2.2), jet_pow(x, 0.4))               \
    ROW(cube_of_cube_root, 0.8, 0, jet_pow(jet_pow(x, 1.0 / 3), 3), x, jet_pow(x, 1.0 / 3))                            \
    ROW(power_by_root, 0.8, 0, jet_pow(x, 2.5), jet_mul(jet_sqr(x), jet_sqrt(x)), jet_sqrt(x))                         \
    ROW(power_by_product, -0.8, 0, jet_pow(x, 5), jet_mul(x, jet_mul(jet_mul(x, x), jet_mul(x, x))), jet_sqr(x))       \
    ROW(power_by_quotient, -0.8, 0, jet_pow(x, -3), jet_div(1, jet_mul(x, jet_sqr(x))), jet_pow(x, -3))                \
    ROW(power_by_exp, 0.8, 0, jet_pow(x, -0.7), jet_exp(jet_mul(-0.7, jet_log(x))), jet_pow(x, -0.7))                  \
    ROW(binomial, 0.8, 1.3, jet_sqr(jet_add(x, y)),                                                                    \
        jet_add(jet_add(jet_sqr(x), jet_mul(2, jet_mul(x, y))), jet_sqr(y)), jet_sqr(y))                               \
    ROW(third_binomial, 0.8, 1.3, jet_mul(jet_add(x, y), jet_sub(x, y)), jet_sub(jet_sqr(x), jet_sqr(y)), jet_sqr(y))  \
    ROW(double_angle, 0.8, 0, jet_sin(jet_add(x, x)), jet_mul(2, jet_mul(jet_sin(x), jet_cos(x))), jet_sin(x))         \
    ROW(sin_of_sum, 0.8, 1.3, jet_sin(jet_add(x, y)),                                                                  \
        jet_add(jet_mul(jet_sin(x), jet_cos(y)), jet_mul(jet_cos(x), jet_sin(y))), jet_sin(y))                         \
    ROW(cos_of_sum, 0.8, 1.3, jet_cos(jet_add(x, y)),                                                                  \
        jet_sub(jet_mul(jet_cos(x), jet_cos(y)), jet_mul(jet_sin(x), jet_sin(y))), jet_sin(y))                         \
    ROW(cosh_of_sum, 0.8, -1.3, jet_cosh(jet_add(x, y)),                                                               \
        jet_add(jet_mul(jet_cosh(x), jet_cosh(y)), jet_mul(jet_sinh(x), jet_sinh(y))), jet_cosh(y))                    \
    ROW(tan_of_sum, 0.3, -0.6, jet_tan(jet_add(x, y)),                                                                 \
        jet_div(jet_add(jet_tan(x), jet_tan(y)), jet_sub(1, jet_mul(jet_tan(x), jet_tan(y)))), jet_tan(y))             \
    ROW(log_of_product, 0.8, 1.3, jet_log(jet_mul(x, y)), jet_add(jet_log(x), jet_log(y)), jet_log(x))                 \
    ROW(exp_of_sum, 0.8, 1.3, jet_exp(jet_add(x, y)), jet_mul(jet_exp(x), jet_exp(y)), jet_exp(y))                     \
    ROW(log_of_root, 0.8, 0, jet_log(jet_sqrt(x)), jet_div(jet_log(x), 2), jet_log(x))                                 \
    ROW(atan_by_asin, 0.8, 0, jet_asin(jet_div(x, jet_sqrt(jet_add(1, jet_sqr(x))))), jet_atan(x), jet_atan(x))        \
    ROW(sinh_of_arsinh, 0.8, 0, jet_sinh(jet_log(jet_add(x, jet_sqrt(jet_add(1, jet_sqr(x)))))), x,                    \
        jet_sqrt(jet_add(1, jet_sqr(x))))                                                                              \
    ROW(cosh_of_arcosh, 1.9, 0, jet_cosh(jet_log(jet_add(x, jet_sqrt(jet_sub(jet_sqr(x), 1))))), x,                    \
        jet_sqrt(jet_sub(jet_sqr(x), 1)))                                                                              \
    ROW(tanh_of_artanh, 0.3, 0, jet_tanh(jet_mul(0.5, jet_log(jet_div(jet_add(1, x), jet_sub(1, x))))), x,             \
        jet_div(jet_add(1, x), jet_sub(1, x)))                                                                         \
    ROW(sinh_of_asinh, 0.4, 0, jet_sinh(jet_asinh(x)), x, jet_asinh(x))                                                \
    ROW(asinh_of_sinh, -0.8, 0, jet_asinh(jet_sinh(x)), x, jet_sinh(x))                                                \
    ROW(cosh_of_acosh, 1.9, 0, jet_cosh(jet_acosh(x)), x, jet_acosh(x))                                                \
    ROW(acosh_of_cosh, 1.2, 0, jet_acosh(jet_cosh(x)), x, jet_cosh(x))                                                 \
    ROW(tanh_of_atanh, 0.3, 0, jet_tanh(jet_atanh(x)), x, jet_atanh(x))                                                \
    ROW(atanh_of_tanh, -0.8, 0, jet_atanh(jet_tanh(x)), x, jet_tanh(x))                                                \
    ROW(erf_is_odd, 0.8, 0, jet_erf(jet_neg(x)), jet_neg(jet_erf(x)), jet_erf(x))                                      \
    ROW(hypot_by_root, 0.8, -1.9, jet_hypot(x, y), jet_sqrt(jet_add(jet_sqr(x), jet_sqr(y))), jet_sqr(y))              \
    ROW(radius_and_angle, 1.8, -1.3, jet_mul(jet_hypot(x, y), jet_cos(jet_atan2(y, x))), x, jet_atan2(y, x))           \
    ROW(angle_and_radius, -1.8, -1.3, jet_mul(jet_hypot(x, y), jet_sin(jet_atan2(y, x))), y, jet_atan2(y, x))          \
    ROW(angle_by_tangent, 1.8, -1.3, jet_atan2(x, y), jet_sub(1.5707963267948966, jet_atan2(y, x)), jet_atan2(y, x))   \
    ROW(sum_is_additions, 0.8, 1.3, jet_sum((const jet[]){x, y, jet_sin(x), x}, 4),                                    \
        jet_add(jet_add(jet_add(x, x), jet_sin(x)), y), x)                                                             \
    ROW(dot_is_products, 0.8, 1.3, jet_dot((const jet[]){x, y, x}, (const jet[]){y, y, jet_const(3)}, 3),              \
        jet_add(jet_mul(y, jet_add(x, y)), jet_mul(3, x)), jet_sqr(y))

#define RECORD(name, centre_x, centre_y, left, right, witness)                                                         \
    static void record_##name(double c, const jet input[], jet z[])                                                    \
    {                                                                                                                  \
        const jet x = input[0], y = input[1];                                                                          \
        (void)c, (void)x, (void)y;                                                                                     \
        z[0] = left;                                                                                                   \
        z[1] = right;                                                                                                  \
        z[2] = witness;                                                                                                \
    }
IDENTITIES(RECORD)

#define ROW(name, centre_x, centre_y, left, right, witness)                                                            \
    {#name, record_##name, 2, 3, 0, {centre_x, centre_y}, 3e-13},
static const function identities[] = {IDENTITIES(ROW)};

enum { IDENTITY_COUNT = sizeof identities / sizeof identities[0] };

static double x[2 * ORDERS], dx[2 * ORDERS], z[3 * ORDERS];

static void check_sides(const function *f, const char *what)
{
    const double error = series_error(DEGREE_MAX, z, z + ORDERS, z + 2 * ORDERS);
    ck_assert_msg(error <= f->bound, "%s of %s differ by %.2g > %.2g", what, f->name, error, f->bound);
}

START_TEST(both_sides_agree)
{
    const function *f = &identities[_i];
    recording r = record_outputs(f, JET_TAPE_SERIES);
    dense_series(f, DEGREE_MAX, x);
    ck_assert(run_series(&r, DEGREE_MAX, 1, x, z));
    check_sides(f, "series");
    dense_direction(f, 0, DEGREE_MAX, dx);
    run_tangents(&r, DEGREE_MAX, 1, 1, x, dx, z);
    check_sides(f, "tangents");
    recording_free(&r);
}
END_TEST

Suite *identity_suite(void)
{
    Suite *suite = suite_create("identity");
    tcase_add_loop_test(add_case(suite, "identities"), both_sides_agree, 0, IDENTITY_COUNT);
    return suite;
}
