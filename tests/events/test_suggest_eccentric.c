/* test_suggest_eccentric.c - Tests suggested steps of fixed size on eccentric orbits. Each passage of the pericentre
 * adds a random error, and there are many runs. */
#include "events.h"
#include "problems/random.h"
#include "problems/thorough.h"
#include "scenes/scene.h"

#include <math.h>
#include <string.h>

static const double TURN = 6.283185307179586;

/* A run of Kepler's problem with the semi-major axis 1. */
typedef struct {
    double e, anomaly; /* the mean one, at the start */
    double duration, wanted;
} trip;

/* Eccentricities to 0.9, phases, durations from 0.16 to 48 revolutions, and errors. */
static trip draw(uint64_t *bits)
{
    const double e = 0.9 * number_of(bits), anomaly = TURN * number_of(bits);
    const double duration = pow(300, number_of(bits)), wanted = pow(10, -4 - 6 * number_of(bits));
    return (trip){e, anomaly, duration, wanted};
}

/* q and p: of the eccentric anomaly E, E - e sin E is the mean one. */
static void state_at(double e, double mean, double x[4])
{
    double E = remainder(mean, TURN);
    mean = E;
    E += copysign(0.85 * e, mean);
    for (int k = 0; k < 60; k++) E -= fmax(fmin((E - e * sin(E) - mean) / (1 - e * cos(E)), 0.5), -0.5);
    const double b = sqrt(1 - e * e), rate = 1 / (1 - e * cos(E));
    x[0] = cos(E) - e, x[1] = b * sin(E);
    x[2] = -sin(E) * rate, x[3] = b * cos(E) * rate;
}

/* The largest coordinate and momentum of the run. */
static void find_sizes(const trip *to, double size[2])
{
    enum { PLACES = 400 };
    size[0] = size[1] = 0;
    for (int k = 0; k <= PLACES; k++) {
        double x[4];
        state_at(to->e, to->anomaly + fmin(to->duration, TURN) * k / PLACES, x);
        for (int i = 0; i < 4; i++) size[i / 2] = fmax(size[i / 2], fabs(x[i]));
    }
}

/* Ends in x. Whether it is not refused. */
static bool travel(const tvi_system *system, const trip *to, double h, double x[4])
{
    tvi_integrator *it;
    double t = 0;
    state_at(to->e, to->anomaly, x);
    ck_assert_int_eq(tvi_integrator_create(&it, system, NULL), TVI_OK);
    const tvi_status status = tvi_integrate_to(it, h, to->duration, &t, x, x + 2, NULL, NULL);
    tvi_integrator_free(it);
    return status == TVI_OK;
}

static double distance(const trip *to, const double x[4], const double y[4])
{
    double size[2], most = 0;
    find_sizes(to, size);
    for (int i = 0; i < 4; i++) most = fmax(most, fabs(x[i] - y[i]) / size[i / 2]);
    return most;
}

/* The error at the end relative to the wanted one, of a run with steps of h. */
static double error_with(const tvi_system *system, const trip *to, double h)
{
    double x[4], end[4];
    state_at(to->e, to->anomaly + to->duration, end);
    return travel(system, to, h, x) ? distance(to, x, end) / to->wanted : INFINITY;
}

static double suggested(const tvi_system *system, const trip *to)
{
    double x[4], h;
    state_at(to->e, to->anomaly, x);
    const tvi_status status = tvi_suggest_step(system, NULL, 0, x, x + 2, to->duration, to->wanted, &h);
    ck_assert_msg(status == TVI_OK, "e = %g, duration %g, %g: %s", to->e, to->duration, to->wanted, tvi_last_error());
    return h;
}

/* At most the wanted error in every run. */
START_TEST(eccentric_runs_keep_the_error)
{
    const int runs = is_thorough() ? 5000 : 300;
    uint64_t bits = 1;
    tvi_system *system;
    ck_assert_int_eq(scene_system(&scene_kepler, &system), TVI_OK);
    for (int k = 0; k < runs; k++) {
        const trip to = draw(&bits);
        const double h = suggested(system, &to), error = error_with(system, &to, h);
        ck_assert_msg(error <= 1, "run %d, e = %g, duration %g, %g: h = %g, %g", k, to.e, to.duration, to.wanted, h,
                      error);
    }
    tvi_system_free(system);
}
END_TEST

/* The recipe of docs/choosing.md: how far the end is from that of half the step. Errors of order 16 are those of h but
 * for a few percent, unless the orbit is too hard for h, or they are roundoff. */
START_TEST(half_the_step_shows_the_error)
{
    uint64_t bits = 3;
    tvi_system *system;
    ck_assert_int_eq(scene_system(&scene_kepler, &system), TVI_OK);
    for (int k = 0; k < 100; k++) {
        double x[4], y[4], end[4];
        const trip to = draw(&bits);
        const double h = suggested(system, &to);
        state_at(to.e, to.anomaly + to.duration, end);
        ck_assert(travel(system, &to, h, x) && travel(system, &to, h / 2, y));
        const double error = distance(&to, x, end), shown = distance(&to, x, y), roundoff = 1e-11;
        ck_assert_msg(fabs(error - shown) <= 0.5 * error + roundoff, "e = %g, duration %g, h = %g: %g, shown %g", to.e,
                      to.duration, h, error, shown);
    }
    tvi_system_free(system);
}
END_TEST

Suite *suite_suggest_eccentric(void)
{
    Suite *suite = suite_create("suggested steps of eccentric orbits");
    TCase *eccentric = tcase_create("eccentric");
    tcase_set_timeout(eccentric, 600);
    tcase_add_test(eccentric, eccentric_runs_keep_the_error);
    tcase_add_test(eccentric, half_the_step_shows_the_error);
    suite_add_tcase(suite, eccentric);
    return suite;
}
