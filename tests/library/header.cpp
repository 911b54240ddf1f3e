/* header.cpp - Tests the headers from C++: every slot takes a jet, a double or an int, C and C++ agree on what a jet
 * is, and operators record what the functions record. */
#include "tvi.h"

/* before <cmath>: nothing but a jet argument finds them */
static jet without_cmath(jet x) { return sin(x) + pow(x, 2); }

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <type_traits>
#include <utility>

/* C passes two plain words; C++ passes the same where copying is trivial. */
static_assert(std::is_trivially_copyable<jet>::value, "a jet is passed in registers");
static_assert(std::is_trivially_destructible<jet>::value, "a jet is passed in registers");
static_assert(std::is_standard_layout<jet>::value, "a jet is laid out as in C");
static_assert(sizeof(jet) == sizeof(double) + sizeof(void *), "a jet is laid out as in C");
static_assert(offsetof(jet, number) == 0 && offsetof(jet, node) == sizeof(double), "a jet is laid out as in C");
/* The codes that docs/bindings.md promises. */
static_assert(JET_NEG == 0 && JET_SQR == 1 && JET_SQRT == 2 && JET_EXP == 3 && JET_LOG == 4 && JET_SIN == 5,
              "codes stay");
static_assert(JET_COS == 6 && JET_TAN == 7 && JET_ASIN == 8 && JET_ACOS == 9 && JET_ATAN == 10, "codes stay");
static_assert(JET_SINH == 11 && JET_COSH == 12 && JET_TANH == 13 && JET_ASINH == 14 && JET_ACOSH == 15, "codes stay");
static_assert(JET_ATANH == 16 && JET_ERF == 17 && JET_ATAN2 == 0 && JET_HYPOT == 1, "codes stay");
static_assert(TVI_OK == 0 && TVI_ESTOPPED == 7 && sizeof(tvi_options) <= 256, "statuses stay");

static int failures;

static void expect(const char *what, bool holds)
{
    if (holds) return;
    failures++;
    std::printf("failed: %s\n", what);
}

static void expect_number(const char *what, jet x, double value)
{
    expect(what, x.node == nullptr && std::fabs(x.number - value) <= 1e-15 * std::fabs(value));
}

/* Numbers through the library, which is C: both arguments and the result arrive. */
static void call_through()
{
    expect_number("double, int", jet_sub(1.5, 2), -0.5);
    expect_number("int, jet", jet_div(3, jet(4)), 0.75);
    expect_number("jet, float", jet_add(jet_const(1), 0.25f), 1.25);
    expect_number("unsigned", jet_mul(2u, 3L), 6);
    expect_number("pow", jet_pow(2, 10), 1024);
    expect_number("default", jet(), 0);
    const jet x[] = {1, 2.5, jet_const(4)}, y[] = {2, 2, 3};
    expect_number("sum", jet_sum(x, 3), 7.5);
    expect_number("dot", jet_dot(x, y, 3), 19);
    expect_number("neg, sqr, sqrt", jet_neg(jet_sqr(jet_sqrt(2.25))), -2.25);
    expect_number("exp, log", jet_exp(jet_log(3)), 3);
    expect_number("sin, asin", jet_sin(jet_asin(0.5)), 0.5);
    expect_number("cos, acos", jet_cos(jet_acos(0.5)), 0.5);
    expect_number("tan, atan", jet_tan(jet_atan(2)), 2);
    expect_number("sinh, asinh", jet_sinh(jet_asinh(2)), 2);
    expect_number("cosh, acosh", jet_cosh(jet_acosh(2)), 2);
    expect_number("tanh, atanh", jet_tanh(jet_atanh(0.5)), 0.5);
    expect_number("erf", jet_erf(0.5), std::erf(0.5));
    expect_number("hypot, atan2", jet_mul(jet_hypot(3, 4.0), jet_sin(jet_atan2(3, jet(4)))), 3);
    expect_number("sinh, cosh, tanh", jet_div(jet_sinh(2), jet_cosh(2)), jet_tanh(2).number);
}

/* ---- Operators --------------------------------------------------------------------------------------------------- */

/* Numbers keep their own functions and operators, with or without `using namespace std`. */
static_assert(std::is_same<decltype(sin(1.0)), double>::value, "sin of a number is a number");
static_assert(std::is_same<decltype(std::pow(2.0, 3.0)), double>::value, "pow of numbers is a number");
static_assert(std::is_same<decltype(2 * std::declval<jet>()), jet>::value, "a number times a jet is a jet");
static_assert(std::is_same<decltype(std::declval<jet &>() += 1), jet &>::value, "+= gives the jet itself");

static void operators_on_numbers()
{
    using std::pow; /* as generic code does; the jet's own are found all the same */
    using std::sin;
    const jet x = 3, y = 0.5;
    expect_number("x + y, x - y", (x + y) / (x - y), 1.4);
    expect_number("number first", 1 - 2 * x / 4.0f, -0.5);
    expect_number("signs", -x + +y, -2.5);
    expect_number("pow", pow(x, 2) + pow(x + 1, 0.5), 11);
    expect_number("sin", sin(y) - std::sin(0.5) + without_cmath(0), 0);
    jet z = x;
    z += y, z *= 2, z -= 1, z /= x;
    expect_number("+= *= -= /=", z, 2);
}

/* The same force in operators and in names: every operator and every function once. */
static void in_operators(const jet q[], jet t, jet F[], void *)
{
    const jet x = 0.25 * q[0] + t / 8;
    jet sum = sqr(x) - 1;
    sum += sqrt(2 + x), sum -= exp(x), sum *= log(x + 3.0), sum /= 2;
    sum += sin(x) * cos(x) / (1 + tan(x) * tan(x)) + asin(x) - acos(x) + atan(x);
    sum += hypot(x, 2) * atan2(1, x) - erf(x) + asinh(x) * acosh(x + 3) * atanh(x / 9);
    F[0] = -sum + sinh(x) * cosh(x) - tanh(x) * pow(2 + x, -1.5);
}

static void in_names(const jet q[], jet t, jet F[], void *)
{
    const jet x = jet_add(jet_mul(0.25, q[0]), jet_div(t, 8));
    jet sum = jet_sub(jet_sqr(x), 1);
    sum = jet_div(jet_mul(jet_sub(jet_add(sum, jet_sqrt(jet_add(2, x))), jet_exp(x)), jet_log(jet_add(x, 3.0))), 2);
    const jet slope = jet_div(jet_mul(jet_sin(x), jet_cos(x)), jet_add(1, jet_mul(jet_tan(x), jet_tan(x))));
    sum = jet_add(sum, jet_add(jet_sub(jet_add(slope, jet_asin(x)), jet_acos(x)), jet_atan(x)));
    const jet area = jet_mul(jet_mul(jet_asinh(x), jet_acosh(jet_add(x, 3))), jet_atanh(jet_div(x, 9)));
    sum = jet_add(jet_add(sum, jet_sub(jet_mul(jet_hypot(x, 2), jet_atan2(1, x)), jet_erf(x))), area);
    F[0] = jet_sub(jet_add(jet_neg(sum), jet_mul(jet_sinh(x), jet_cosh(x))),
                   jet_mul(jet_tanh(x), jet_pow(jet_add(2, x), -1.5)));
}

static double steps_of(const char *what, tvi_force_fn *force)
{
    tvi_system *system = nullptr;
    tvi_integrator *integrator = nullptr;
    expect(what, tvi_system_force(&system, 1, nullptr, force, nullptr) == TVI_OK);
    expect(what, tvi_integrator_create(&integrator, system, nullptr) == TVI_OK);
    double t = 0, q[] = {0.5}, p[] = {0.25};
    expect(what, tvi_integrate(integrator, 0.125, 8, &t, q, p, nullptr, nullptr) == TVI_OK);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return q[0];
}

static void operators_on_jets()
{
    const double names = steps_of("names", in_names), operators = steps_of("operators", in_operators);
    expect("operators record what names record", std::fabs(names - operators) < 1e-14 && std::fabs(names - 0.5) > 0.1);
}

/* ---- Systems ----------------------------------------------------------------------------------------------------- */

struct pendulum {
    double gravity;
    int calls;
};

/* V = g (1 - cos q) + 0 t, in slots of every kind, through the library and back. */
static jet potential(const jet q[], jet t, void *ctx)
{
    pendulum *self = static_cast<pendulum *>(ctx);
    self->calls++;
    const jet height = jet_sub(1, jet_cos(q[0]));
    return jet_add(jet_mul(self->gravity, height), jet_mul(0, jet_sin(jet_mul(2, t))));
}

static void force(const jet q[], jet, jet F[], void *ctx)
{
    F[0] = jet_mul(-static_cast<pendulum *>(ctx)->gravity, jet_sin(q[0]));
}

static void swing(const char *what, const tvi_system *system, double q_end[1], double p_end[1])
{
    tvi_options options = tvi_options_default();
    const char *why = "no reason";
    expect(why, tvi_options_check(system, &options, &why) == TVI_OK);
    tvi_integrator *integrator = nullptr;
    expect(what, tvi_integrator_create(&integrator, system, &options) == TVI_OK);
    double t = 0, q[] = {1}, p[] = {0};
    expect(what, tvi_step(integrator, 0.01, &t, q, p) == TVI_OK);
    expect(what, tvi_integrate(integrator, 0.01, 99, &t, q, p, nullptr, nullptr) == TVI_OK);
    expect(what, tvi_integrator_stats(integrator)->steps == 100 && std::fabs(t - 1) < 1e-15);
    q_end[0] = q[0], p_end[0] = p[0];
    tvi_integrator_free(integrator);
}

static void pendulums()
{
    pendulum ctx = {9.8, 0};
    tvi_system *of_potential = nullptr, *of_force = nullptr;
    double q[1], p[1], q_force[1], p_force[1], start = 0, end = 0;
    const double q0[] = {1}, p0[] = {0};
    expect("potential", tvi_system_potential(&of_potential, 1, nullptr, potential, &ctx) == TVI_OK && ctx.calls == 1);
    expect("force", tvi_system_force(&of_force, 1, nullptr, force, &ctx) == TVI_OK);
    swing("potential", of_potential, q, p);
    swing("force", of_force, q_force, p_force);
    expect("q", std::fabs(q[0] - q_force[0]) < 1e-14 && q[0] < 0.9);
    expect("p", std::fabs(p[0] - p_force[0]) < 1e-14);
    expect("H at the start", tvi_energy(of_potential, 0, q0, p0, &start) == TVI_OK);
    expect("H at the end", tvi_energy(of_potential, 1, q, p, &end) == TVI_OK);
    expect("H", std::fabs(start - 9.8 * (1 - std::cos(1.0))) < 1e-14 && std::fabs(end - start) < 1e-13);
    tvi_system_free(of_potential);
    tvi_system_free(of_force);
}

int main()
{
    call_through();
    operators_on_numbers();
    operators_on_jets();
    pendulums();
    std::printf("%s\n", failures ? "failed" : tvi_status_string(TVI_OK));
    return failures != 0;
}
