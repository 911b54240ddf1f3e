/* test_subsystems.c - Tests two motions that know nothing of each other, as one system: each has the error that it has
 * alone, whatever the masses, the frequencies and the sizes of the two are. */
#include "invariance.h"
#include "methods.h"
#include "tvi_ensemble.h"

#include <complex.h>
#include <float.h>
#include <math.h>

/* y'' = -w^2 y - 2 friction w y', y = size cos(w t + turns phase) without friction; x is y or asinh y. */
typedef struct {
    double mass, w, size, friction;
    int turns;
} oscillator;

typedef struct {
    int n;
    oscillator part[2];
} pair;

/* ---- The statements ---------------------------------------------------------------------------------------------- */

static jet potential(const jet q[], jet t, void *ctx)
{
    const pair *p = ctx;
    jet sum = jet_const(0);
    (void)t;
    for (int i = 0; i < p->n; i++)
        sum = jet_add(sum, jet_mul(p->part[i].mass * p->part[i].w * p->part[i].w / 2, jet_sqr(q[i])));
    return sum;
}

static jet potential_of_sinh(const pair *p, const jet q[], int i)
{
    return jet_mul(p->part[i].mass * p->part[i].w * p->part[i].w / 2, jet_sqr(jet_sinh(q[i])));
}

static jet hamiltonian(const jet q[], const jet p[], jet t, void *ctx)
{
    const pair *both = ctx;
    jet sum = jet_const(0);
    (void)t;
    for (int i = 0; i < both->n; i++) {
        const jet kinetic = jet_div(jet_sqr(jet_div(p[i], jet_cosh(q[i]))), 2 * both->part[i].mass);
        sum = jet_add(sum, jet_add(kinetic, potential_of_sinh(both, q, i)));
    }
    return sum;
}

static jet lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    const pair *both = ctx;
    jet sum = jet_const(0);
    (void)t;
    for (int i = 0; i < both->n; i++) {
        const jet kinetic = jet_mul(both->part[i].mass / 2, jet_sqr(jet_mul(v[i], jet_cosh(q[i]))));
        sum = jet_add(sum, jet_sub(kinetic, potential_of_sinh(both, q, i)));
    }
    return sum;
}

static void drag(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    const pair *p = ctx;
    (void)q, (void)t;
    for (int i = 0; i < p->n; i++) force[i] = jet_mul(-2 * p->part[i].friction * p->part[i].w * p->part[i].mass, v[i]);
}

static tvi_status make_potential(tvi_system **system, pair *p)
{
    double mass[2];
    for (int i = 0; i < p->n; i++) mass[i] = p->part[i].mass;
    return tvi_system_potential(system, p->n, mass, potential, p);
}

static tvi_status make_hamiltonian(tvi_system **system, pair *p)
{
    return tvi_system_hamiltonian(system, p->n, hamiltonian, p);
}

static tvi_status make_lagrangian(tvi_system **system, pair *p)
{
    return tvi_system_lagrangian(system, p->n, lagrangian, p);
}

static tvi_status make_driven(tvi_system **system, pair *p)
{
    tvi_system *base;
    const tvi_status status = make_potential(&base, p);
    if (status != TVI_OK) return status;
    const tvi_status driven = tvi_system_driven(system, base, drag, p);
    tvi_system_free(base);
    return driven;
}

static const struct {
    const char *name;
    tvi_status (*make)(tvi_system **system, pair *p);
    bool is_curved, has_friction;
} forms[] = {{"potential", make_potential, false, false},
             {"driven", make_driven, false, true},
             {"Hamiltonian", make_hamiltonian, true, false},
             {"Lagrangian", make_lagrangian, true, false}};
enum { FORMS = sizeof forms / sizeof *forms };

/* ---- The motion -------------------------------------------------------------------------------------------------- */

enum { PHASES = 20, STEPS = 5 };

/* From rest where the phase is 0; the phases of two that move together are not the same. */
static void set_state(int form, const oscillator *o, int phase, double t, double *q, double *p)
{
    const double turn = 2 * acos(-1) / PHASES;
    const double friction = forms[form].has_friction ? o->friction * o->w : 0, angle = o->turns * phase * turn;
    const double complex lambda = I * sqrt(o->w * o->w - friction * friction) - friction;
    const double complex z = o->size * (I * o->w / lambda) * cexp(lambda * t + I * angle);
    const double y = creal(z), rate = creal(lambda * z);
    *q = forms[form].is_curved ? asinh(y) : y;
    *p = o->mass * rate * (forms[form].is_curved ? cosh(*q) : 1);
}

/* How far the oscillators are at most from where they should be, of all phases, in units of roundoff of their sizes;
 * INFINITY: a step was refused. */
typedef struct {
    double part[2];
} errors;

static void compare(int form, const pair *both, int phase, double t, const double q[], const double p[],
                    tvi_status status, errors *worst)
{
    for (int i = 0; i < both->n; i++) {
        double q_exact, p_exact;
        const oscillator *o = &both->part[i];
        set_state(form, o, phase, t, &q_exact, &p_exact);
        const double error = fmax(fabs(q[i] - q_exact), fabs(p[i] - p_exact) / (o->mass * o->w));
        worst->part[i] = fmax(worst->part[i], status == TVI_OK ? error / (DBL_EPSILON * o->size) : INFINITY);
    }
}

/* All phases in lanes. */
static void run_together(int form, const tvi_system *system, const tvi_options *options, const pair *both, double h,
                         errors *worst)
{
    tvi_ensemble *ensemble;
    double t[PHASES] = {0}, q[2 * PHASES], p[2 * PHASES];
    tvi_status status[PHASES];
    ck_assert_int_eq(tvi_ensemble_create(&ensemble, system, options, PHASES, 1), TVI_OK);
    for (int i = 0; i < both->n; i++)
        for (int m = 0; m < PHASES; m++) set_state(form, &both->part[i], m, 0, &q[i * PHASES + m], &p[i * PHASES + m]);
    ck_assert_int_ne(tvi_ensemble_integrate(ensemble, h, STEPS, t, q, p, status, NULL, NULL), TVI_EINVAL);
    for (int m = 0; m < PHASES; m++) {
        const double its_q[] = {q[m], q[PHASES * (both->n - 1) + m]}, its_p[] = {p[m], p[PHASES * (both->n - 1) + m]};
        compare(form, both, m, t[m], its_q, its_p, status[m], worst);
    }
    tvi_ensemble_free(ensemble);
}

static void run_one_by_one(int form, const tvi_system *system, const tvi_options *options, const pair *both, double h,
                           errors *worst)
{
    tvi_integrator *integrator;
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, options), TVI_OK);
    for (int m = 0; m < PHASES; m += 3) {
        double t = 0, q[2], p[2];
        for (int i = 0; i < both->n; i++) set_state(form, &both->part[i], m, t, &q[i], &p[i]);
        const tvi_status status = tvi_integrate(integrator, h, STEPS, &t, q, p, NULL, NULL);
        compare(form, both, m, t, q, p, status, worst);
    }
    tvi_integrator_free(integrator);
}

static errors run(int form, const tvi_options *options, pair both, double h)
{
    errors worst = {{0, 0}};
    tvi_system *system;
    ck_assert_int_eq(forms[form].make(&system, &both), TVI_OK);
    run_one_by_one(form, system, options, &both, h, &worst);
    run_together(form, system, options, &both, h, &worst);
    tvi_system_free(system);
    return worst;
}

/* ------------------------------------------------------------------------------------------------------------------ */

/* Beside an oscillator of mass 1 and size 1, which has a friction where there is one; powers of two, with which nothing
 * else is rounded. */
static const struct {
    double mass, size;
} others[] = {{0x1p-50, 1}, {0x1p-100, 1}, {1, 0x1p-30}, {0x1p-100, 0x1p-90}};
enum { OTHERS = sizeof others / sizeof *others };
static const double frequencies[][2] = {{1, 100}, {100, 1}};
enum { FREQUENCIES = sizeof frequencies / sizeof *frequencies };

static void expect_as_alone(int form, const tvi_options *options, const double w[2], complaints *c)
{
    const double h = 0.5 / fmax(w[0], w[1]);
    const oscillator heavy = {1, w[0], 1, 0.01, 3};
    const errors of_heavy = run(form, options, (pair){1, {heavy}}, h);
    for (int i = 0; i < OTHERS; i++) {
        const oscillator light = {others[i].mass, w[1], others[i].size, 0, 1};
        const errors of_light = run(form, options, (pair){1, {light}}, h),
                     both = run(form, options, (pair){2, {heavy, light}}, h);
        const double bound[] = {2 * of_heavy.part[0] + 4, 2 * of_light.part[0] + 4};
        for (int k = 0; k < 2 && isfinite(bound[0] + bound[1]); k++)
            if (!(both.part[k] <= bound[k]))
                complain(c, "%s, w = %g and %g, mass %.0e, size %.0e: the %s one has %.3g, alone %.3g\n",
                         describe(options), w[0], w[1], light.mass, light.size, k == 0 ? "first" : "second",
                         both.part[k], (k == 0 ? of_heavy : of_light).part[0]);
    }
}

START_TEST(each_has_the_error_that_it_has_alone)
{
    static const int degrees[] = {LEAST, 4}, highest[] = {8};
    pair both = {2, {{1, 1, 1, 0.01, 0}, {1, 1, 1, 0, 0}}};
    complaints c = complaints_of("%s", forms[_i].name);
    method_list list = {0};
    tvi_system *system;
    ck_assert_int_eq(forms[_i].make(&system, &both), TVI_OK);
    add_methods(system, 2, degrees, false, &list);
    add_methods(system, 1, degrees, true, &list);
    tvi_options galerkin;
    ck_assert_int_eq(tvi_options_named("galerkin", 2 * highest[0], &galerkin), TVI_OK);
    list.options[list.count++] = galerkin;
    tvi_system_free(system);
    for (int m = 0; m < list.count; m++)
        for (int k = 0; k < FREQUENCIES; k++) expect_as_alone(_i, &list.options[m], frequencies[k], &c);
    expect_none(&c);
}
END_TEST

Suite *suite_subsystems(void)
{
    Suite *suite = suite_create("subsystems");
    TCase *tcase = tcase_create("subsystems");
    tcase_add_loop_test(tcase, each_has_the_error_that_it_has_alone, 0, FORMS);
    suite_add_tcase(suite, tcase);
    return suite;
}
