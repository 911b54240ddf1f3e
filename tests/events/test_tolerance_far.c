/* test_tolerance_far.c - Tests runs to a tolerance of bodies that come from afar, where the force is next to nothing
 * beside the state: they feel what they meet. A constant in V changes nothing. The order that suits a tolerance. */
#include "events.h"
#include "problems/random.h"
#include "tolerance.h"

#include <float.h>
#include <math.h>

static double width, shift;

static jet lennard_jones(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet r6 = jet_pow(q[0], -6);
    return jet_add(shift, jet_mul(4, jet_sub(jet_sqr(r6), r6)));
}

static jet yukawa(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(shift, jet_div(jet_exp(jet_neg(q[0])), q[0]));
}

static jet gaussian_wall(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(shift, jet_exp(jet_neg(jet_sqr(q[0]))));
}

static jet smooth_wall(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(shift, jet_tanh(q[0]));
}

static jet morse(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(shift, jet_sqr(jet_sub(1, jet_exp(jet_neg(q[0])))));
}

/* A spring that is switched on at t = 5. */
static jet switched(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    const jet on = jet_add(1, jet_erf(jet_div(jet_sub(t, 5), width)));
    return jet_add(shift, jet_mul(jet_div(on, 4), jet_sqr(q[0])));
}

/* largest: the largest step; 0: none is needed, as the series is not 0 in doubles where the run starts, or the end of
 * a step shows what it missed. */
static const struct {
    const char *name;
    tvi_potential_fn *V;
    double q, p, t_end, largest, width;
} cases[] = {{"Lennard-Jones", lennard_jones, 30, -1, 80, 0, 0},
             {"Lennard-Jones", lennard_jones, 100, -1, 220, 0, 0},
             {"Lennard-Jones", lennard_jones, 1000, -1, 2200, 0, 0},
             {"Lennard-Jones", lennard_jones, 1e4, -1, 22000, 0, 0},
             {"Yukawa", yukawa, 30, -1, 80, 0, 0},
             {"Yukawa", yukawa, 300, -1, 800, 0, 0},
             {"Yukawa", yukawa, 1e3, -1, 2200, 2, 0},
             {"Yukawa", yukawa, 1e4, -1, 22000, 2, 0},
             {"Gaussian wall", gaussian_wall, -5, 1, 12, 0, 0},
             {"Gaussian wall", gaussian_wall, -10, 1, 22, 0, 0},
             {"Gaussian wall", gaussian_wall, -20, 1, 42, 0, 0},
             {"Gaussian wall", gaussian_wall, -100, 1, 202, 1, 0},
             {"tanh wall", smooth_wall, -5, 1, 12, 0, 0},
             {"tanh wall", smooth_wall, -15, 1, 32, 0, 0},
             {"tanh wall", smooth_wall, -100, 1, 202, 1, 0},
             {"Morse", morse, 50, -0.5, 200, 0, 0},
             {"switch", switched, 1, 0, 20, 0, 0.05},
             {"switch", switched, 1, 0, 20, 0, 0.2},
             {"switch", switched, 1, 0, 20, 0, 1},
             {"switch", switched, 1, 0, 20, 0.5, 0.05}};
enum { CASES = sizeof cases / sizeof *cases };

static void run(int i, double tolerance, double largest, double D[4], orbit *o)
{
    const tvi_run_plan plan = {.tolerance = tolerance,
                               .t_end = cases[i].t_end,
                               .largest_step = largest,
                               .D = D,
                               .columns = D ? 2 : 0,
                               .size = sizeof plan};
    width = cases[i].width;
    *o = open_potential(cases[i].V, tvi_taylor_order(tolerance), cases[i].q, cases[i].p);
    ck_assert_msg(tvi_run(o->integrator, &plan, &o->t, o->q, o->p) == TVI_OK, "%s: %s", cases[i].name,
                  tvi_last_error());
}

START_TEST(bodies_feel_what_they_meet)
{
    double D[] = {1, 0, 0, 1};
    orbit right;
    shift = 0;
    const double largest = cases[_i].largest > 0 ? cases[_i].largest : INFINITY;
    run(_i, 1e-14, fmin(cases[_i].t_end / 400, largest), D, &right);
    ck_assert(cases[_i].V == switched || right.p[0] * cases[_i].p < 0); /* it bounces */
    for (int k = 0; k < 3; k++) {
        const double tolerance = (const double[]){1e-6, 1e-9, 1e-12}[k];
        uint64_t bits = (uint64_t)(100 * _i + k);
        orbit o, shifted;
        shift = 0;
        run(_i, tolerance, cases[_i].largest, NULL, &o);
        const double growth = fmax(fmax(fabs(D[0]) * fabs(cases[_i].q), fabs(D[1])), 1);
        ck_assert_msg(fabs(o.q[0] - right.q[0]) <= 100 * tolerance * growth, "%s from %g: %g, %.9g instead of %.9g",
                      cases[_i].name, cases[_i].q, tolerance, o.q[0], right.q[0]);
        shift = 1000 * number_of(&bits);
        run(_i, tolerance, cases[_i].largest, NULL, &shifted);
        ck_assert_double_eq(shifted.q[0], o.q[0]);
        ck_assert_int_eq(steps_of(&shifted), steps_of(&o));
        close_orbit(&o);
        close_orbit(&shifted);
    }
    close_orbit(&right);
}
END_TEST

/* A hill beside a weak force, which every form of a system feels at places inside of its steps alone: the coefficients
 * at the start do not show the hill, and where a step ends beyond it the weak force is what it should be. */
static jet hill(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_exp(jet_neg(jet_sqr(q[0]))), jet_mul(1e-8, jet_sqr(q[0])));
}

static void hill_force(const jet q[], jet t, jet out[], void *ctx)
{
    (void)t, (void)ctx;
    out[0] = jet_mul(jet_mul(2, q[0]), jet_sub(jet_exp(jet_neg(jet_sqr(q[0]))), 1e-8));
}

static void rest_of_drive(const jet q[], const jet v[], jet t, jet out[], void *ctx)
{
    (void)v, (void)t, (void)ctx;
    out[0] = jet_mul(1e-12, q[0]);
}

/* The kinetic energy depends on q, too. */
static jet hill_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    return jet_add(jet_div(jet_sqr(p[0]), jet_add(2, jet_mul(1e-6, jet_sqr(q[0])))), hill(q, t, ctx));
}

static jet hill_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return jet_sub(jet_mul(jet_sqr(v[0]), jet_add(0.5, jet_mul(1e-6, jet_sqr(q[0])))), hill(q, t, ctx));
}

START_TEST(every_form_meets_the_hill)
{
    static const double tolerance[] = {1e-4, 1e-7, 1e-10, 1e-13};
    tvi_system *potential, *system;
    ck_assert_int_eq(tvi_system_potential(&potential, 1, NULL, hill, NULL), TVI_OK);
    switch (_i) {
    case 0: ck_assert_int_eq(tvi_system_potential(&system, 1, NULL, hill, NULL), TVI_OK); break;
    case 1: ck_assert_int_eq(tvi_system_force(&system, 1, NULL, hill_force, NULL), TVI_OK); break;
    case 2: ck_assert_int_eq(tvi_system_driven(&system, potential, rest_of_drive, NULL), TVI_OK); break;
    case 3: ck_assert_int_eq(tvi_system_hamiltonian(&system, 1, hill_hamiltonian, NULL), TVI_OK); break;
    default: ck_assert_int_eq(tvi_system_lagrangian(&system, 1, hill_lagrangian, NULL), TVI_OK);
    }
    orbit right = {.system = system, .n = 1, .q = {-20}, .p = {1}};
    open_integrator(&right, "galerkin", 16);
    ck_assert_int_eq(tvi_integrate_to(right.integrator, 0.02, 43, &right.t, right.q, right.p, NULL, NULL), TVI_OK);
    ck_assert_double_lt(right.q[0], -20);
    for (size_t i = 0; i < sizeof tolerance / sizeof *tolerance; i++) {
        orbit o = {.system = system, .n = 1, .q = {-20}, .p = {1}};
        open_integrator(&o, "taylor", tvi_taylor_order(tolerance[i]));
        ck_assert_int_eq(go(&o, tolerance[i], 43, NULL, NULL), TVI_OK);
        ck_assert_double_lt(error_of(&o, right.q, right.p), 100 * tolerance[i] + 1e-11);
        ck_assert_int_lt(steps_of(&o), 150);
        tvi_integrator_free(o.integrator);
    }
    close_orbit(&right);
    tvi_system_free(potential);
}
END_TEST

/* A step of the potential so narrow that its force is felt between the places where the field is compared. The energy
 * shows it, of each form that has one. */
static jet narrow_step(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_add(jet_div(jet_sqr(q[0]), 2), jet_mul(0.1, jet_tanh(jet_mul(1000, jet_sub(q[0], 0.31)))));
}

static jet narrow_hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    return jet_add(jet_div(jet_sqr(p[0]), jet_add(2, jet_mul(1e-6, jet_sqr(q[0])))), narrow_step(q, t, ctx));
}

static jet narrow_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    return jet_sub(jet_mul(jet_sqr(v[0]), jet_add(0.5, jet_mul(1e-6, jet_sqr(q[0])))), narrow_step(q, t, ctx));
}

START_TEST(the_energy_shows_what_lies_between)
{
    static const double tolerance[] = {1e-4, 1e-6, 1e-8, 1e-10, 1e-12};
    tvi_system *system;
    if (_i == 0) ck_assert_int_eq(tvi_system_potential(&system, 1, NULL, narrow_step, NULL), TVI_OK);
    else if (_i == 1) ck_assert_int_eq(tvi_system_hamiltonian(&system, 1, narrow_hamiltonian, NULL), TVI_OK);
    else ck_assert_int_eq(tvi_system_lagrangian(&system, 1, narrow_lagrangian, NULL), TVI_OK);
    orbit right = {.system = system, .n = 1, .q = {-1}, .p = {0}};
    open_integrator(&right, "galerkin", 16);
    ck_assert_int_eq(tvi_integrate_to(right.integrator, 1e-4, 20, &right.t, right.q, right.p, NULL, NULL), TVI_OK);
    for (size_t i = 0; i < sizeof tolerance / sizeof *tolerance; i++) {
        orbit o = {.system = system, .n = 1, .q = {-1}, .p = {0}};
        open_integrator(&o, "taylor", tvi_taylor_order(tolerance[i]));
        ck_assert_int_eq(go(&o, tolerance[i], 20, NULL, NULL), TVI_OK);
        ck_assert_double_lt(error_of(&o, right.q, right.p), 100 * tolerance[i] + 1e-10);
        tvi_integrator_free(o.integrator);
    }
    close_orbit(&right);
}
END_TEST

/* N is the least order with e^(2 - 2N) <= tolerance, and at least 2, which "taylor" needs. */
START_TEST(orders_of_tolerances)
{
    static const struct {
        double tolerance;
        int order;
    } known[] = {{1e-6, 8}, {1e-10, 13}, {1e-15, 19}, {DBL_EPSILON, 20}, {0.5, 2}, {1 - DBL_EPSILON / 2, 2}};
    static const double refused_ones[] = {0, -1e-10, 1, 2, 1e-16, NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        ck_assert_int_eq(tvi_taylor_order(known[i].tolerance), known[i].order);
    for (size_t i = 0; i < sizeof refused_ones / sizeof *refused_ones; i++)
        ck_assert_int_eq(tvi_taylor_order(refused_ones[i]), 0);
    for (double tolerance = 0.9; tolerance > DBL_EPSILON; tolerance *= 0.977) {
        const int N = tvi_taylor_order(tolerance);
        tvi_options options;
        ck_assert_double_le(exp(2 - 2 * N), tolerance * (1 + 1e-12));
        ck_assert(N == 2 || exp(4 - 2 * N) > tolerance * (1 - 1e-12));
        ck_assert_int_eq(tvi_options_named("taylor", N, &options), TVI_OK);
    }
}
END_TEST

Suite *suite_tolerance_far(void)
{
    Suite *suite = suite_create("tolerance far");
    TCase *tcase = tcase_create("tolerance far");
    tcase_add_loop_test(tcase, bodies_feel_what_they_meet, 0, CASES);
    tcase_add_loop_test(tcase, every_form_meets_the_hill, 0, 5);
    tcase_add_loop_test(tcase, the_energy_shows_what_lies_between, 0, 3);
    tcase_add_test(tcase, orders_of_tolerances);
    suite_add_tcase(suite, tcase);
    return suite;
}
