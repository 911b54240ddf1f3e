/* input_texts.c - Tests what tvi_last_error says of refusals that have no table of their own: the text names the
 * culprit. */
#include "input.h"
#include "problems/texts.h"

#include <float.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

static jet first(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t;
    return ctx ? jet_log(q[0]) : q[0];
}

static void constant(const jet q[], jet t, jet force[], void *ctx)
{
    (void)q, (void)t;
    force[0] = jet_const(ctx ? 1e308 : 0);
}

/* It leaves its domain, or overflows, as t goes on. */
static jet of_time(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)p;
    return ctx ? jet_exp(jet_mul(1e4, t)) : jet_sqrt(jet_sub(0.25, t));
}

static jet minus_one(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)p, (void)t, (void)ctx;
    return jet_const(-1);
}

/* A system, an integrator of the method for it, and a state. */
typedef struct {
    tvi_system *system;
    tvi_integrator *it;
    state s;
} run;

static run open_run(const char *method_name, int order)
{
    run r = {.system = create_scene(&scene_henon_heiles_12), .s = start_of(&scene_henon_heiles_12)};
    r.it = create_integrator(r.system, &(method){method_name, order});
    return r;
}

static void close_run(run *r)
{
    tvi_integrator_free(r->it);
    tvi_system_free(r->system);
}

START_TEST(texts_of_the_version) { ck_assert_str_eq(tvi_version(), TVI_VERSION); }
END_TEST

START_TEST(texts_of_names)
{
    static const char *const names[] = {"tvi",   "start", "midpoint", "both-ends", "htvi-left", "svhd",
                                        "right", "left",  "poincare", "galerkin",  "taylor",    "stormer-verlet"};
    tvi_options options;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        refused(names[i], tvi_options_named("galerkn", 4, &options), TVI_EINVAL);
    refused("\"galerkn\"", tvi_options_named("galerkn", 4, &options), TVI_EINVAL);
    refused("svhd has order 2, not 4", tvi_options_named("svhd", 4, &options), TVI_EINVAL);
    refused("midpoint has even orders from 2 to 200, not 5", tvi_options_named("midpoint", 5, &options), TVI_EINVAL);
    refused("galerkin has even orders from 2 to 20, not 1000", tvi_options_named("galerkin", 1000, &options),
            TVI_EINVAL);
    refused("taylor has orders from 1 to 99, not -1", tvi_options_named("taylor", -1, &options), TVI_EINVAL);
    refused("stormer-verlet has order 2, not 4", tvi_options_named("stormer-verlet", 4, &options), TVI_EINVAL);
    refused("name is NULL", tvi_options_named(NULL, 4, &options), TVI_EINVAL);
    refused("options is NULL", tvi_options_named("galerkin", 4, NULL), TVI_EINVAL);
}
END_TEST

START_TEST(texts_of_events)
{
    run r = open_run("galerkin", 8);
    state *s = &r.s;
    tvi_event *event, *other, *outside, *out;
    refused("n = 0", tvi_event_create(&out, 0, TVI_EITHER, false, first, NULL), TVI_EINVAL);
    refused("direction = 7", tvi_event_create(&out, 2, (tvi_direction)7, false, first, NULL), TVI_EINVAL);
    refused("function is NULL", tvi_event_create(&out, 2, TVI_EITHER, false, NULL, NULL), TVI_EINVAL);
    ck_assert_int_eq(tvi_event_create(&event, 2, TVI_EITHER, false, first, NULL), TVI_OK);
    ck_assert_int_eq(tvi_event_create(&other, 3, TVI_EITHER, false, first, NULL), TVI_OK);
    ck_assert_int_eq(tvi_event_create(&outside, 2, TVI_EITHER, false, first, &r), TVI_OK);
    const tvi_event *const events[] = {event, other}, *const missing[] = {event, NULL}, *const last[] = {outside};
#define RUN(h, steps, list, count)                                                                                     \
    tvi_integrate_events(r.it, h, steps, list, count, &s->t, s->q, s->p, NULL, NULL, NULL)
    refused("events[1] is of another dimension", RUN(0.1, 3, events, 2), TVI_EINVAL);
    refused("events[1] is NULL", RUN(0.1, 3, missing, 2), TVI_EINVAL);
    refused("events is NULL", RUN(0.1, 3, NULL, 1), TVI_EINVAL);
    refused("count = -1", RUN(0.1, 3, events, -1), TVI_EINVAL);
    refused("steps is negative", RUN(0.1, -3, events, 1), TVI_EINVAL);
    s->q[0] = -0.25;
    refused("events[0]: event function: jet_log has no power series at -", RUN(0.1, 3, last, 1), TVI_EDOMAIN);
    s->q[0] = 0.25;
    s->t = 0;
    ck_assert_int_eq(tvi_event_create(&out, 2, TVI_EITHER, false, of_time, NULL), TVI_OK);
    const tvi_event *both[] = {event, out};
    refused("events[1]: event function: jet_sqrt has no power series at", RUN(0.1, 5, both, 2), TVI_EDOMAIN);
    tvi_event_free(out);
    ck_assert_int_eq(tvi_event_create(&out, 2, TVI_EITHER, false, of_time, &r), TVI_OK);
    both[1] = out;
    refused("events[1]: event function: a value is not finite", RUN(0.1, 5, both, 2), TVI_ENONFINITE);
    tvi_event_free(out);
#undef RUN
    tvi_event_free(event);
    tvi_event_free(other);
    tvi_event_free(outside);
    close_run(&r);
}
END_TEST

START_TEST(texts_of_times)
{
    run r = open_run("galerkin", 8), taylor = open_run("taylor", 8);
    state *s = &r.s;
    const double times[] = {1, 0.5}, late[] = {1, NAN};
#define AT(list, count)      tvi_integrate_at(r.it, 0.1, list, count, &s->t, s->q, s->p, NULL, NULL)
#define TO(h, t_end)         tvi_integrate_to(r.it, h, t_end, &s->t, s->q, s->p, NULL, NULL)
#define WITHIN(it, tol, end) tvi_integrate_tolerance(it, tol, end, &s->t, s->q, s->p, NULL, NULL)
    refused("times[1] = 0.5", AT(times, 2), TVI_EINVAL);
    refused("times[1] = nan", AT(late, 2), TVI_EINVAL);
    refused("times is NULL", AT(NULL, 2), TVI_EINVAL);
    refused("count is negative", AT(times, -2), TVI_EINVAL);
    refused("t_end is not finite", TO(0.1, INFINITY), TVI_EINVAL);
    refused("h is 0", TO(0, 1), TVI_EINVAL);
    refused("h = nan is not finite", TO(NAN, 1), TVI_EINVAL);
    refused("h = 0.1 does not go from t = 0 to t_end = -1", TO(0.1, -1), TVI_EINVAL);
    refused("tolerance", WITHIN(taylor.it, 0, 1), TVI_EINVAL);
    refused("t_end", WITHIN(taylor.it, 1e-10, NAN), TVI_EINVAL);
    refused("\"taylor\"", WITHIN(r.it, 1e-10, 1), TVI_EUNSUPPORTED);
    s->q[1] = NAN;
    refused("q[1] = nan", AT(times, 1), TVI_ENONFINITE);
#undef AT
#undef TO
#undef WITHIN
    close_run(&r);
    close_run(&taylor);
}
END_TEST

static const double late[] = {1};

/* The runs, of one step, with these for their integrator, time, coordinates and momenta. */
static tvi_status one_step(tvi_integrator *it, double *t, double *q, double *p) { return tvi_step(it, 0.1, t, q, p); }
static tvi_status many_steps(tvi_integrator *it, double *t, double *q, double *p)
{
    return tvi_integrate(it, 0.1, 1, t, q, p, NULL, NULL);
}
static tvi_status with_events(tvi_integrator *it, double *t, double *q, double *p)
{
    return tvi_integrate_events(it, 0.1, 1, NULL, 0, t, q, p, NULL, NULL, NULL);
}
static tvi_status at_times(tvi_integrator *it, double *t, double *q, double *p)
{
    return tvi_integrate_at(it, 0.1, late, 1, t, q, p, NULL, NULL);
}
static tvi_status to_time(tvi_integrator *it, double *t, double *q, double *p)
{
    return tvi_integrate_to(it, 0.1, 1, t, q, p, NULL, NULL);
}
static tvi_status to_tolerance(tvi_integrator *it, double *t, double *q, double *p)
{
    return tvi_integrate_tolerance(it, 1e-10, 1, t, q, p, NULL, NULL);
}
static tvi_status with_column(tvi_integrator *it, double *t, double *q, double *p)
{
    double D[4] = {1};
    return tvi_step_tangent(it, 0.1, t, q, p, D, 1);
}
static tvi_status last_of(tvi_integrator *it, double *t, double *q, double *p) { return tvi_state_last(it, t, q, p); }
typedef tvi_status a_run(tvi_integrator *, double *, double *, double *);
static a_run *const runs[] = {one_step, many_steps, with_events, at_times, to_time, to_tolerance, with_column, last_of};
enum { RUNS = sizeof runs / sizeof *runs };

START_TEST(texts_of_nulls)
{
    run r = open_run("taylor", 8);
    state *s = &r.s;
    ck_assert_int_eq(tvi_step(r.it, 0.1, &s->t, s->q, s->p), TVI_OK);
    refused("integrator is NULL", runs[_i](NULL, &s->t, s->q, s->p), TVI_EINVAL);
    refused("t is NULL", runs[_i](r.it, NULL, s->q, s->p), TVI_EINVAL);
    refused("q is NULL", runs[_i](r.it, &s->t, NULL, s->p), TVI_EINVAL);
    refused("p is NULL", runs[_i](r.it, &s->t, s->q, NULL), TVI_EINVAL);
    close_run(&r);
}
END_TEST

START_TEST(texts_of_tangents_and_dense)
{
    run r = open_run("galerkin", 8);
    state *s = &r.s;
    double D[4] = {1, 0, NAN, 0}, good[4] = {1};
    refused("row 2 of D", tvi_step_tangent(r.it, 0.1, &s->t, s->q, s->p, D, 1), TVI_ENONFINITE);
    refused("columns", tvi_step_tangent(r.it, 0.1, &s->t, s->q, s->p, D, 0), TVI_EINVAL);
    refused("D is NULL", tvi_step_tangent(r.it, 0.1, &s->t, s->q, s->p, NULL, 1), TVI_EINVAL);
    refused("h is 0", tvi_step_tangent(r.it, 0, &s->t, s->q, s->p, good, 1), TVI_EINVAL);
    double large[4] = {1e308, 1e308, 1e308, 1e308};
    refused("column 0 of D", tvi_step_tangent(r.it, 0.5, &s->t, s->q, s->p, large, 1), TVI_ENONFINITE);
    refused("no last step", tvi_dense(r.it, 0.5, s->q, s->p), TVI_EINVAL);
    refused("integrator is NULL", tvi_dense(NULL, 0.5, s->q, s->p), TVI_EINVAL);
    refused("q is NULL", tvi_dense(r.it, 0.5, NULL, s->p), TVI_EINVAL);
    refused("p is NULL", tvi_dense(r.it, 0.5, s->q, NULL), TVI_EINVAL);
    ck_assert_int_eq(tvi_step(r.it, 0.1, &s->t, s->q, s->p), TVI_OK);
    refused("theta = 2", tvi_dense(r.it, 2, s->q, s->p), TVI_EINVAL);
    refused("theta = nan", tvi_dense(r.it, NAN, s->q, s->p), TVI_EINVAL);
    close_run(&r);
}
END_TEST

START_TEST(texts_of_wrong_steps)
{
    run r = open_run("midpoint", 8);
    state *s = &r.s;
    tvi_integrator *strict;
    tvi_options options = *tvi_integrator_options(r.it);
    options.max_tail = 1e-12;
    ck_assert_int_eq(tvi_integrator_create(&strict, r.system, &options), TVI_OK);
    refused("above max_tail = 1e-12", tvi_step(strict, 0.5, &s->t, s->q, s->p), TVI_ETOOLARGE);
    refused("step of 0.5 from t = 0", tvi_step(strict, 0.5, &s->t, s->q, s->p), TVI_ETOOLARGE);
    options.max_tail = 0;
    options.max_passes = 1;
    tvi_integrator_free(strict);
    ck_assert_int_eq(tvi_integrator_create(&strict, r.system, &options), TVI_OK);
    refused("corrector did not converge", tvi_step(strict, 0.5, &s->t, s->q, s->p), TVI_ENOCONV);
    tvi_integrator_free(strict);
    close_run(&r);
    r = open_run("taylor", 8);
    refused("changes the energy", tvi_step(r.it, 2.5, &s->t, s->q, s->p), TVI_ETOOLARGE);
    close_run(&r);
}
END_TEST

START_TEST(texts_of_overflows)
{
    double t = 0, q[] = {1e308}, p[] = {1.5e308};
    for (int pushed = 0; pushed < 2; pushed++) {
        tvi_system *system;
        ck_assert_int_eq(tvi_system_force(&system, 1, NULL, constant, pushed ? &t : NULL), TVI_OK);
        tvi_integrator *it = create_integrator(system, &(method){"taylor", 4});
        if (pushed) refused("p[0] overflows", tvi_step(it, 0.4, &t, q, p), TVI_ETOOLARGE);
        else refused("q[0] overflows", tvi_step(it, 1, &t, q, p), TVI_ETOOLARGE);
        q[0] = 0;
        tvi_integrator_free(it);
        tvi_system_free(system);
    }
}
END_TEST

START_TEST(texts_of_states)
{
    run r = open_run("galerkin", 8);
    state *const x = &r.s;
    tvi_system *small = create_scene(&scene_pendulum);
    tvi_integrator *of_small = create_integrator(small, &(method){"galerkin", 8});
    char *text = text_of_state(r.it, x->t, x->q, x->p), *const damaged = text_of_state(r.it, x->t, x->q, x->p);
    size_t size = 10;
    int n;
    refused("10 bytes", tvi_state_to_text(r.it, x->t, x->q, x->p, text, &size), TVI_EINVAL);
    size = strlen(text);
    refused("damaged", tvi_state_from_text(r.it, text, size / 2, &x->t, x->q, x->p), TVI_EINVAL);
    damaged[size / 2] ^= 1;
    refused("damaged", tvi_state_from_text(r.it, damaged, size, &x->t, x->q, x->p), TVI_EINVAL);
    refused("damaged", tvi_state_peek(damaged, size, &n, NULL, NULL, NULL), TVI_EINVAL);
    damaged[10] ^= 1;
    refused("format", tvi_state_from_text(r.it, damaged, size, &x->t, x->q, x->p), TVI_EINVAL);
    refused("format", tvi_state_peek(damaged, size, &n, NULL, NULL, NULL), TVI_EINVAL);
    damaged[0] ^= 1;
    refused("no state", tvi_state_from_text(r.it, damaged, size, &x->t, x->q, x->p), TVI_EINVAL);
    refused("no state", tvi_state_peek(damaged, size, &n, NULL, NULL, NULL), TVI_EINVAL);
    refused("another dimension", tvi_state_from_text(of_small, text, size, &x->t, x->q, x->p), TVI_EINVAL);
    static const char bytes[] = "tvistate\20\0\0\0\0\0\0\0"; /* the first of those that version 0.2.0 wrote */
    refused("bytes are no state as text", tvi_state_from_text(r.it, bytes, sizeof bytes, &x->t, x->q, x->p),
            TVI_EINVAL);
    refused("tvi_state_to_text", tvi_state_peek(bytes, sizeof bytes, &n, NULL, NULL, NULL), TVI_EINVAL);
    refused("has made no step", tvi_state_last(r.it, &x->t, x->q, x->p), TVI_EINVAL);
    refused("text is NULL", tvi_state_peek(NULL, size, &n, NULL, NULL, NULL), TVI_EINVAL);
    refused("n is NULL", tvi_state_peek(text, size, NULL, NULL, NULL, NULL), TVI_EINVAL);
    free(damaged);
    free(text);
    tvi_integrator_free(of_small);
    tvi_system_free(small);
    close_run(&r);
}
END_TEST

/* H = log q_0, and a scale that has a value where H has none. */
static jet logarithm(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_log(q[0]);
}

static jet one(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_add(1, jet_sqr(q[0]));
}

/* Texts for an integrator's own values of parameters, and for a state outside of the function's domain. */
START_TEST(texts_of_energies)
{
    tvi_system *system = create_system(1, logarithm), *rescaled;
    ck_assert_int_eq(tvi_system_rescaled(&rescaled, system, one, NULL), TVI_OK);
    tvi_integrator *it = create_integrator(rescaled, &(method){"galerkin", 8});
    double t = 0, q[] = {-1}, p[] = {0}, H;
    refused("energy: jet_log has no power series at -1", tvi_step(it, 0.1, &t, q, p), TVI_EDOMAIN);
    refused("energy: jet_log has no power series at -1", tvi_energy(system, t, q, p, &H), TVI_EDOMAIN);
    refused("energy: jet_log has no power series at -1", tvi_integrator_energy(it, t, q, p, &H), TVI_EDOMAIN);
    refused("integrator is NULL", tvi_integrator_energy(NULL, t, q, p, &H), TVI_EINVAL);
    refused("integrator is NULL", tvi_integrator_momentum(NULL, t, q, p, &H), TVI_EINVAL);
    refused("integrator is NULL", tvi_integrator_velocity(NULL, t, q, p, &H), TVI_EINVAL);
    refused("integrator is NULL", tvi_integrator_set_parameters(NULL, q), TVI_EINVAL);
    refused("value is NULL", tvi_integrator_set_parameters(it, NULL), TVI_EINVAL);
    tvi_integrator_free(it);
    tvi_system_free(rescaled);
    tvi_system_free(system);
}
END_TEST

/* A time scale, and what has none. */
START_TEST(texts_of_rescaled_systems)
{
    tvi_system *force, *out;
    tvi_system *lagrangian, *system = create_system(2, harmonic);
    ck_assert_int_eq(tvi_system_force(&force, 1, NULL, constant, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_lagrangian(&lagrangian, 2, mixed_lagrangian, NULL), TVI_OK);
    refused("force", tvi_system_rescaled(&out, force, NULL, NULL), TVI_EUNSUPPORTED);
    refused("Lagrangian", tvi_system_rescaled(&out, lagrangian, NULL, NULL), TVI_EUNSUPPORTED);
    refused("system is NULL", tvi_system_rescaled(&out, NULL, NULL, NULL), TVI_EINVAL);
    refused("time scale", tvi_system_rescaled(&out, system, minus_one, NULL), TVI_EDOMAIN);
    tvi_system_free(force);
    tvi_system_free(lagrangian);
    tvi_system_free(system);
}
END_TEST

static void *no_text_here(void *text)
{
    tvi_system *system;
    const bool is_none = strcmp(tvi_last_error(), "") == 0;
    const bool refuses = tvi_system_potential(&system, -3, NULL, harmonic, NULL) == TVI_EINVAL;
    return is_none && refuses && strstr(tvi_last_error(), "n = -3") ? text : NULL;
}

/* Each thread has its own, and what succeeds leaves it as it is. */
START_TEST(texts_of_threads)
{
    char text[] = "one";
    void *end = NULL;
    pthread_t thread;
    tvi_system *system;
    refused("n = -2", tvi_system_potential(&system, -2, NULL, harmonic, NULL), TVI_EINVAL);
    ck_assert_int_eq(pthread_create(&thread, NULL, no_text_here, text), 0);
    ck_assert_int_eq(pthread_join(thread, &end), 0);
    ck_assert_ptr_eq(end, text);
    tvi_system_free(create_system(2, harmonic));
    ck_assert_ptr_nonnull(strstr(tvi_last_error(), "n = -2"));
}
END_TEST

TCase *tcase_texts(void)
{
    TCase *tcase = tcase_create("texts");
    tcase_add_test(tcase, texts_of_the_version);
    tcase_add_test(tcase, texts_of_names);
    tcase_add_test(tcase, texts_of_events);
    tcase_add_test(tcase, texts_of_times);
    tcase_add_loop_test(tcase, texts_of_nulls, 0, RUNS);
    tcase_add_test(tcase, texts_of_tangents_and_dense);
    tcase_add_test(tcase, texts_of_wrong_steps);
    tcase_add_test(tcase, texts_of_overflows);
    tcase_add_test(tcase, texts_of_states);
    tcase_add_test(tcase, texts_of_energies);
    tcase_add_test(tcase, texts_of_rescaled_systems);
    tcase_add_test(tcase, texts_of_threads);
    return tcase;
}
