/* test_probe.c - Tests a star, a planet and a probe of mass 1e-30 that the planet holds, in a form with masses and in
 * others: the same motion with the same tail. */
#include "invariance.h"
#include "methods.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { BODIES = 3, N = 2 * BODIES, STEPS = 40 };
static const double masses[BODIES] = {1, 3e-6, 1e-30};
#define DISTANCE 5e-5 /* of the probe from the planet: that of a satellite, where the planet is the Earth */

static jet potential(const jet q[], jet t, void *ctx)
{
    jet sum = jet_const(0), d[2];
    (void)t, (void)ctx;
    for (int i = 0; i < BODIES; i++)
        for (int j = i + 1; j < BODIES; j++) {
            for (int k = 0; k < 2; k++) d[k] = jet_sub(q[2 * i + k], q[2 * j + k]);
            sum = jet_sub(sum, jet_mul(masses[i] * masses[j], jet_pow(jet_dot(d, d, 2), -0.5)));
        }
    return sum;
}

/* In a frame that turns at the rate 1, as the planet does about the star. */
static jet hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    jet sum = potential(q, t, ctx);
    for (int i = 0; i < BODIES; i++) {
        const jet *x = q + 2 * i, *of = p + 2 * i;
        sum = jet_add(sum, jet_div(jet_dot(of, of, 2), 2 * masses[i]));
        sum = jet_sub(sum, jet_sub(jet_mul(x[0], of[1]), jet_mul(x[1], of[0])));
    }
    return sum;
}

static jet lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    jet sum = jet_neg(potential(q, t, ctx));
    for (int i = 0; i < N; i += 2) {
        const jet u[] = {jet_sub(v[i], q[i + 1]), jet_add(v[i + 1], q[i])};
        sum = jet_add(sum, jet_mul(masses[i / 2] / 2, jet_dot(u, u, 2)));
    }
    return sum;
}

static void no_drag(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)t, (void)ctx;
    for (int i = 0; i < N; i++) force[i] = i < 4 ? jet_const(0) : jet_mul(0x1p-200, v[i]);
}

static tvi_status make_potential(tvi_system **system)
{
    double mass[N];
    for (int i = 0; i < N; i++) mass[i] = masses[i / 2];
    return tvi_system_potential(system, N, mass, potential, NULL);
}

static tvi_status make_hamiltonian(tvi_system **system) { return tvi_system_hamiltonian(system, N, hamiltonian, NULL); }
static tvi_status make_lagrangian(tvi_system **system) { return tvi_system_lagrangian(system, N, lagrangian, NULL); }

static tvi_status make_driven(tvi_system **system)
{
    tvi_system *base;
    tvi_status status = make_potential(&base);
    if (status != TVI_OK) return status;
    status = tvi_system_driven(system, base, no_drag, NULL);
    tvi_system_free(base);
    return status;
}

static const struct {
    const char *name;
    tvi_status (*make)(tvi_system **system);
    bool turns;
} forms[] = {{"potential", make_potential, false},
             {"driven", make_driven, false},
             {"Hamiltonian", make_hamiltonian, true},
             {"Lagrangian", make_lagrangian, true}};
enum { FORMS = sizeof forms / sizeof *forms };

/* The position of the probe relative to the planet, and the largest tail. */
typedef struct {
    double x[2], tail;
} orbit;

/* In so many steps of parts of the probe's period. */
static orbit follow(int form, const char *method, int order, double part, int steps)
{
    const double v = sqrt(masses[1] / DISTANCE), h = part * 2 * acos(-1) * DISTANCE / v;
    double t = 0, q[N] = {0, 0, 1, 0, 1 + DISTANCE, 0}, p[N] = {0, 0, 0, masses[1], 0, masses[2] * (1 + v)};
    tvi_options options;
    tvi_system *system;
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_options_named(method, order, &options), TVI_OK);
    ck_assert_int_eq(forms[form].make(&system), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
    ck_assert_int_eq(tvi_integrate(integrator, h, steps, &t, q, p, NULL, NULL), TVI_OK);
    const double angle = forms[form].turns ? t : 0, x = q[4] - q[2], y = q[5] - q[3];
    const orbit end = {{x * cos(angle) - y * sin(angle), x * sin(angle) + y * cos(angle)},
                       tvi_integrator_stats(integrator)->largest_tail};
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return end;
}

static double error_of(const orbit *end, const orbit *exact)
{
    return hypot(end->x[0] - exact->x[0], end->x[1] - exact->x[1]);
}

/* A place has the roundoff of the star's distance, which the orbit about the planet enlarges. */
START_TEST(probe_is_solved)
{
    static const char *const methods[] = {"galerkin", "taylor"};
    complaints c = complaints_of("%s", forms[_i].name);
    const orbit exact = follow(0, "galerkin", 20, 1.0 / 64, STEPS * 8);
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        const orbit of_masses = follow(0, methods[i], 16, 0.125, STEPS), end = follow(_i, methods[i], 16, 0.125, STEPS);
        const double error = error_of(&end, &exact) / DBL_EPSILON, own = error_of(&of_masses, &exact) / DBL_EPSILON;
        if (!(error <= 2 * own + 4)) complain(&c, "%s: %.3g units, of a potential %.3g\n", methods[i], error, own);
        if (!(end.tail <= 8 * of_masses.tail && end.tail >= of_masses.tail / 8))
            complain(&c, "%s: the tail is %.3g, of a potential %.3g\n", methods[i], end.tail, of_masses.tail);
    }
    expect_none(&c);
}
END_TEST

Suite *suite_probe(void)
{
    Suite *suite = suite_create("probe");
    TCase *tcase = tcase_create("probe");
    tcase_add_loop_test(tcase, probe_is_solved, 0, FORMS);
    suite_add_tcase(suite, tcase);
    return suite;
}
