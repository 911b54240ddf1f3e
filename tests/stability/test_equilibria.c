/* test_equilibria.c - Tests small motions about equilibria, at the origin and away from it: the corrections of a step
 * are small beside roundoff of the positions, which the force is computed from, and no step is refused for that. */
#include "problems/thorough.h"
#include "stability.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- A spring ---------------------------------------------------------------------------------------------------- */

/* x = q - a, with a the context; 1 + x/10 makes the kinetic energy depend on it. */
static jet away(const jet q[], const void *a) { return jet_sub(q[0], *(const double *)a); }
static jet stretch(const jet q[], const void *a) { return jet_add(1, jet_mul(0.1, away(q, a))); }

static jet spring(const jet q[], jet t, void *a)
{
    (void)t;
    return jet_mul(0.5, jet_sqr(away(q, a)));
}

static jet spring_hamiltonian(const jet q[], const jet p[], jet t, void *a)
{
    return jet_add(jet_mul(0.5, jet_sqr(p[0])), spring(q, t, a));
}

static jet stretched_hamiltonian(const jet q[], const jet p[], jet t, void *a)
{
    return jet_add(jet_mul(stretch(q, a), jet_mul(0.5, jet_sqr(p[0]))), spring(q, t, a));
}

static jet stretched_lagrangian(const jet q[], const jet v[], jet t, void *a)
{
    return jet_sub(jet_mul(stretch(q, a), jet_mul(0.5, jet_sqr(v[0]))), spring(q, t, a));
}

typedef enum { POTENTIAL, SEPARABLE_HAMILTONIAN, HAMILTONIAN, LAGRANGIAN, SPRINGS } spring_form;

static tvi_system *spring_system(spring_form form, double *a)
{
    tvi_system *system = NULL;
    const tvi_status status = form == POTENTIAL ? tvi_system_potential(&system, 1, NULL, spring, a)
                              : form == SEPARABLE_HAMILTONIAN
                                  ? tvi_system_hamiltonian(&system, 1, spring_hamiltonian, a)
                              : form == HAMILTONIAN ? tvi_system_hamiltonian(&system, 1, stretched_hamiltonian, a)
                                                    : tvi_system_lagrangian(&system, 1, stretched_lagrangian, a);
    ck_assert_int_eq(status, TVI_OK);
    return system;
}

/* Exact but for the last digits: q - a is. */
static double spring_energy(spring_form form, double a, double q, double p)
{
    const double x = q - a, bend = 1 + 0.1 * x;
    const double factor = form == HAMILTONIAN ? bend : form == LAGRANGIAN ? 1 / bend : 1;
    return (factor * p * p + x * x) / 2;
}

typedef struct {
    spring_form form;
    double a, amplitude;
    long steps;
} spring_run;

/* max |H - H0| over steps of h w = 0.2; negative where the method does not serve the form. */
static double spring_error(const spring_run *run, const hard_method *m)
{
    tvi_options options;
    tvi_integrator *integrator;
    double a = run->a, t = 0, q = a + run->amplitude, p = 0, error = 0;
    const double start = spring_energy(run->form, a, q, p);
    tvi_system *system = spring_system(run->form, &a);
    ck_assert(hard_options(m, &options));
    if (tvi_integrator_create(&integrator, system, &options) == TVI_EUNSUPPORTED) {
        tvi_system_free(system);
        return -1;
    }
    for (long step = 0; step < run->steps; step++) {
        const tvi_status status = tvi_step(integrator, 0.2, &t, &q, &p);
        ck_assert_msg(status == TVI_OK, "%s %d%s, form %d, about %g, amplitude %g, step %ld: %s", m->name, m->order,
                      m->composed ? " composed" : "", (int)run->form, a, run->amplitude, step,
                      tvi_status_string(status));
        error = fmax(error, fabs(spring_energy(run->form, a, q, p) - start));
    }
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return error;
}

static const double places[] = {0, 1, 100}, amplitudes[] = {1e-3, 1e-5, 1e-8, 1e-11};
enum { PLACES = sizeof places / sizeof *places, AMPLITUDES = sizeof amplitudes / sizeof *amplitudes };
enum { FEW = 100, MANY = 20000, ROWS = SPRINGS * PLACES * AMPLITUDES };

/* Besides all_methods: the highest orders, with few steps. */
static const hard_method high_methods[] = {
    {"tvi", 30, false},       {"start", 60, false},      {"end", 60, false},    {"midpoint", 60, false},
    {"both-ends", 40, false}, {"htvi-right", 30, false}, {"right", 60, false},  {"left", 60, false},
    {"htvi-left", 30, false}, {"poincare", 60, false},   {"taylor", 60, false}, {"symmetric-tvi", 30, false},
};
enum { HIGH_METHODS = sizeof high_methods / sizeof *high_methods };

/* The energy error is that of the same run about the origin, but for roundoff: a unit of q moves the energy by unit *
 * amplitude. Both ends has more of it (docs/roundoff.md), and so have the many passes of the lowest orders. */
static void check_spring(const spring_run *run, const hard_method *m)
{
    spring_run about_origin = *run;
    about_origin.a = 0;
    about_origin.steps = FEW;
    const double error = spring_error(run, m), own = spring_error(&about_origin, m);
    if (error < 0) return;
    const double drift = strcmp(m->name, "taylor") == 0 ? (double)run->steps / FEW : 1.02;
    const double unit = DBL_EPSILON * (fabs(run->a) + run->amplitude);
    const bool has_more = strcmp(m->name, "both-ends") == 0 || strcmp(m->name, "symmetric-tvi") == 0 || m->order <= 2;
    const double units = has_more ? 150 : 40;
    const double roundoff = units * (unit * run->amplitude + unit * unit / 2);
    ck_assert_msg(error <= drift * own + roundoff, "%s %d, form %d, about %g, amplitude %g: energy %g, %g + %g",
                  m->name, m->order, (int)run->form, run->a, run->amplitude, error, drift * own, roundoff);
    ck_assert_msg(error >= 0.98 * own - roundoff, "%s %d, form %d, about %g, amplitude %g: energy %g, %g", m->name,
                  m->order, (int)run->form, run->a, run->amplitude, error, own);
}

/* All forms, places and amplitudes, one of them for 20,000 steps: which one, is another choice for each method. With
 * TVI_TESTS=all two of them, and with TVI_EQUILIBRIA=all (make check-all) all of them away from the origin, but the
 * separable Hamiltonian, which is a potential. */
static bool has_many_steps(int method, int row)
{
    const char *which = getenv("TVI_EQUILIBRIA");
    if (method >= method_count) return false;
    if (which && strcmp(which, "all") == 0) return row % SPRINGS != SEPARABLE_HAMILTONIAN && row / SPRINGS % PLACES > 0;
    return (row + 5 * method) % (is_thorough() ? ROWS / 2 : ROWS) == 0;
}

START_TEST(springs_swing)
{
    const hard_method *m = _i < method_count ? &all_methods[_i] : &high_methods[_i - method_count];
    for (int row = 0; row < ROWS; row++) {
        const spring_run run = {(spring_form)(row % SPRINGS), places[row / SPRINGS % PLACES],
                                amplitudes[row / SPRINGS / PLACES], has_many_steps(_i, row) ? MANY : FEW};
        check_spring(&run, m);
    }
}
END_TEST

/* ---- Other equilibria -------------------------------------------------------------------------------------------- */

static jet morse(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sqr(jet_sub(1, jet_exp(jet_sub(1, q[0]))));
}

/* Four atoms in space, 4 (r^-12 - r^-6) of each pair. */
static jet cluster(const jet q[], jet t, void *ctx)
{
    jet V = jet_const(0);
    (void)t, (void)ctx;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < i; j++) {
            jet r2 = jet_const(0);
            for (int k = 0; k < 3; k++) r2 = jet_add(r2, jet_sqr(jet_sub(q[3 * i + k], q[3 * j + k])));
            const jet r6 = jet_pow(r2, -3);
            V = jet_add(V, jet_mul(4, jet_mul(r6, jet_sub(r6, 1))));
        }
    return V;
}

/* The restricted problem of three bodies in the rotating frame, mu = 1/100: attraction of the two at (-mu, 0), (1 - mu,
 * 0). */
static jet attraction(const jet q[])
{
    const double mu = 0.01;
    const jet y2 = jet_sqr(q[1]), far = jet_add(jet_sqr(jet_add(q[0], mu)), y2);
    const jet near = jet_add(jet_sqr(jet_add(q[0], mu - 1)), y2);
    return jet_add(jet_mul(1 - mu, jet_pow(far, -0.5)), jet_mul(mu, jet_pow(near, -0.5)));
}

static jet three_bodies(const jet q[], const jet p[], jet t, void *ctx)
{
    const jet turning = jet_sub(jet_mul(q[1], p[0]), jet_mul(q[0], p[1]));
    (void)t, (void)ctx;
    return jet_sub(jet_add(jet_mul(0.5, jet_dot(p, p, 2)), turning), attraction(q));
}

static jet three_bodies_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    const jet turning = jet_sub(jet_mul(q[0], v[1]), jet_mul(q[1], v[0]));
    const jet squares = jet_add(jet_dot(v, v, 2), jet_dot(q, q, 2));
    (void)t, (void)ctx;
    return jet_add(jet_add(jet_mul(0.5, squares), turning), attraction(q));
}

static jet unit_pendulum(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_sub(1, jet_cos(q[0]));
}

/* Frequencies 50 and 1. */
static jet stiff_spring(const jet q[], jet t, void *ctx)
{
    const jet x = jet_sub(q[0], 1), y = jet_sub(q[1], 1);
    (void)t, (void)ctx;
    return jet_add(jet_mul(1250, jet_sqr(x)), jet_add(jet_mul(0.5, jet_sqr(y)), jet_mul(x, jet_sqr(y))));
}

/* A spring in other momenta: v = p - 10 (q - 1), a difference that is small beside the roundoff of q. */
static jet gauged(const jet q[], const jet p[], jet t, void *ctx)
{
    const jet x = jet_sub(q[0], 1), v = jet_sub(p[0], jet_mul(10, x));
    (void)t, (void)ctx;
    return jet_mul(0.5, jet_add(jet_sqr(v), jet_sqr(x)));
}

static jet gauged_lagrangian(const jet q[], const jet v[], jet t, void *ctx)
{
    const jet x = jet_sub(q[0], 1);
    (void)t, (void)ctx;
    return jet_add(jet_mul(0.5, jet_sub(jet_sqr(v[0]), jet_sqr(x))), jet_mul(10, jet_mul(x, v[0])));
}

enum { MOST = 12 };
#define PI     3.14159265358979323846
#define ROOT_3 1.73205080756887729353
/* Edge 2^(1/6): the corners of a cube with it as the diagonal of a face. */
#define CORNER 0.79370052598409973738

typedef struct {
    const char *name;
    int n;
    tvi_potential_fn *potential;
    tvi_hamiltonian_fn *hamiltonian;
    tvi_lagrangian_fn *lagrangian;
    double q[MOST], p[MOST]; /* the equilibrium */
    double h;
    double bend; /* the energy of the motion is at most about this times amplitude^2 */
    double most; /* energy error of methods of order 8 in a motion that does not stay small */
} equilibrium;

static const equilibrium equilibria[] = {
    {.name = "Morse", .n = 1, .potential = morse, .q = {1}, .h = 0.14, .bend = 1},
    {.name = "Lennard-Jones",
     .n = 12,
     .potential = cluster,
     .h = 0.01,
     .bend = 500,
     .q = {0, 0, 0, CORNER, CORNER, 0, CORNER, 0, CORNER, 0, CORNER, CORNER}},
    {.name = "L4",
     .n = 2,
     .hamiltonian = three_bodies,
     .q = {0.49, ROOT_3 / 2},
     .p = {-ROOT_3 / 2, 0.49},
     .h = 0.2,
     .bend = 2},
    {.name = "L4, Lagrangian",
     .n = 2,
     .lagrangian = three_bodies_lagrangian,
     .q = {0.49, ROOT_3 / 2},
     .p = {-ROOT_3 / 2, 0.49},
     .h = 0.2,
     .bend = 2},
    {.name = "pendulum", .n = 1, .potential = unit_pendulum, .q = {PI}, .h = 0.2, .bend = 0, .most = 2e-7},
    {.name = "stiff spring", .n = 2, .potential = stiff_spring, .q = {1, 1}, .h = 0.02, .bend = 5000},
    {.name = "gauge", .n = 1, .hamiltonian = gauged, .q = {1}, .h = 0.2, .bend = 60},
    {.name = "gauge, Lagrangian", .n = 1, .lagrangian = gauged_lagrangian, .q = {1}, .h = 0.2, .bend = 60},
};
enum { EQUILIBRIA = sizeof equilibria / sizeof *equilibria };

static tvi_system *equilibrium_system(const equilibrium *e)
{
    tvi_system *system = NULL;
    const tvi_status status = e->potential     ? tvi_system_potential(&system, e->n, NULL, e->potential, NULL)
                              : e->hamiltonian ? tvi_system_hamiltonian(&system, e->n, e->hamiltonian, NULL)
                                               : tvi_system_lagrangian(&system, e->n, e->lagrangian, NULL);
    ck_assert_int_eq(status, TVI_OK);
    return system;
}

/* Displaced, all coordinates differently. */
static void displace(const equilibrium *e, double amplitude, double q[], double p[])
{
    memcpy(q, e->q, sizeof e->q);
    memcpy(p, e->p, sizeof e->p);
    for (int i = 0; i < e->n; i++) q[i] -= amplitude * (1 - 0.3 * (i % 5));
}

/* Methods of order 8 or more: their energy error is below 1e-4 of the energy of the motion. */
static const hard_method other_methods[] = {
    {"tvi", 8, false},        {"start", 8, true},       {"end", 12, false},      {"midpoint", 8, false},
    {"midpoint", 20, false},  {"both-ends", 16, false}, {"both-ends", 8, false}, {"symmetric-tvi", 8, false},
    {"htvi-right", 8, false}, {"htvi-left", 8, false},  {"right", 8, false},     {"left", 16, false},
    {"poincare", 8, false},   {"poincare", 20, false},  {"galerkin", 16, false},
};
enum { OTHER_METHODS = sizeof other_methods / sizeof *other_methods, OTHER_STEPS = 500 };

static void check_equilibrium(const equilibrium *e, const tvi_system *system, const hard_method *m, double amplitude)
{
    tvi_options options;
    tvi_integrator *integrator;
    double t = 0, q[MOST], p[MOST], start, end;
    ck_assert(hard_options(m, &options));
    if (tvi_integrator_create(&integrator, system, &options) == TVI_EUNSUPPORTED) return;
    displace(e, amplitude, q, p);
    ck_assert_int_eq(tvi_energy(system, t, q, p, &start), TVI_OK);
    const tvi_status status = tvi_integrate(integrator, e->h, OTHER_STEPS, &t, q, p, NULL, NULL);
    ck_assert_msg(status == TVI_OK, "%s, %s %d, amplitude %g, step %ld: %s", e->name, m->name, m->order, amplitude,
                  tvi_integrator_stats(integrator)->steps, tvi_status_string(status));
    ck_assert_int_eq(tvi_energy(system, t, q, p, &end), TVI_OK);
    const double most =
        (m->order < 16 ? e->most : 0) + 1e-4 * e->bend * amplitude * amplitude + 1e-14 * fmax(1, fabs(start));
    ck_assert_msg(fabs(end - start) <= most, "%s, %s %d, amplitude %g: energy %g, at most %g", e->name, m->name,
                  m->order, amplitude, end - start, most);
    tvi_integrator_free(integrator);
}

START_TEST(small_motions_go_on)
{
    const equilibrium *e = &equilibria[_i / OTHER_METHODS];
    tvi_system *system = equilibrium_system(e);
    for (int k = 0; k < AMPLITUDES; k++)
        check_equilibrium(e, system, &other_methods[_i % OTHER_METHODS], amplitudes[k]);
    tvi_system_free(system);
}
END_TEST

/* Control: passes that do not contract fail however small the motion is, as long as it is not roundoff itself. The
 * frequencies of the cluster go to 21; its passes have no Jacobian that could be made anew. */
START_TEST(too_large_steps_fail)
{
    static const hard_method methods[] = {
        {"midpoint", 8, false}, {"end", 8, false}, {"right", 8, false}, {"poincare", 8, false}};
    const equilibrium *e = &equilibria[1];
    tvi_system *system = equilibrium_system(e);
    for (int k = 0; k < 3; k++) {
        tvi_options options;
        tvi_integrator *integrator;
        double t = 0, q[MOST], p[MOST], start[MOST];
        displace(e, amplitudes[k], q, p);
        memcpy(start, q, sizeof q);
        ck_assert(hard_options(&methods[_i], &options));
        ck_assert_int_eq(tvi_integrator_create(&integrator, system, &options), TVI_OK);
        const tvi_status status = tvi_step(integrator, 1, &t, q, p);
        ck_assert_msg(status == TVI_ENOCONV || status == TVI_EDOMAIN || status == TVI_ETOOLARGE, "%s, amplitude %g: %s",
                      methods[_i].name, amplitudes[k], tvi_status_string(status));
        ck_assert(t == 0 && memcmp(q, start, sizeof q) == 0);
        tvi_integrator_free(integrator);
    }
    tvi_system_free(system);
}
END_TEST

/* L_v = sin q (1000 + v) - 841.4: a difference of large numbers. */
static jet large_differences(const jet q[], const jet v[], jet t, void *ctx)
{
    const jet kinetic = jet_mul(0.5, jet_mul(jet_sin(q[0]), jet_sqr(jet_add(1000, v[0]))));
    (void)t, (void)ctx;
    return jet_sub(kinetic, jet_mul(841.4, v[0]));
}

/* v from p where f(v) takes only values of a grid that p is not on. */
START_TEST(legendre_transforms_of_small_velocities)
{
    tvi_system *system;
    ck_assert_int_eq(tvi_system_lagrangian(&system, 1, large_differences, NULL), TVI_OK);
    for (int k = 0; k < AMPLITUDES; k++)
        for (double q = 1; q < 1.001; q += 1e-5) {
            const double v = amplitudes[k], p = sin(q) * v + (1000 * sin(q) - 841.4);
            double back;
            ck_assert_int_eq(tvi_velocity(system, 0, &q, &p, &back), TVI_OK);
            ck_assert_double_eq_tol(back, v, 2000 * DBL_EPSILON);
        }
    tvi_system_free(system);
}
END_TEST

Suite *suite_equilibria(void)
{
    Suite *suite = suite_create("equilibria");
    TCase *tcase = tcase_create("equilibria");
    TCase *springs = tcase_create("springs");
    tcase_add_loop_test(springs, springs_swing, 0, method_count + HIGH_METHODS);
    suite_add_tcase(suite, springs);
    tcase_add_loop_test(tcase, small_motions_go_on, 0, EQUILIBRIA * OTHER_METHODS);
    tcase_add_loop_test(tcase, too_large_steps_fail, 0, 4);
    suite_add_tcase(suite, tcase);
    TCase *transforms = tcase_create("transforms");
    tcase_add_test(transforms, legendre_transforms_of_small_velocities);
    suite_add_tcase(suite, transforms);
    return suite;
}
