/* input_texts.c - what tvi_last_error says of refusals that have no table of their own: the text names the culprit. */
#include "input.h"

#include <float.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

static jet first(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t;
    return ctx ? jet_log(q[0]) : q[0];
}

static void no_force(const jet q[], jet t, jet force[], void *ctx)
{
    (void)q, (void)t, (void)ctx;
    force[0] = jet_const(0);
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

START_TEST(texts_of_names)
{
    static const char *const names[] = {"tvi",   "start", "midpoint", "both-ends", "htvi-left", "svhd",
                                        "right", "left",  "poincare", "galerkin",  "taylor",    "stormer-verlet"};
    tvi_options options;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        refused(names[i], tvi_options_named("galerkn", 4, &options), TVI_EINVAL);
    refused("\"galerkn\"", tvi_options_named("galerkn", 4, &options), TVI_EINVAL);
    refused("svhd has order 2, not 4", tvi_options_named("svhd", 4, &options), TVI_EINVAL);
    refused("order = 5", tvi_options_named("midpoint", 5, &options), TVI_EINVAL);
    refused("orders of the method are even", tvi_options_named("galerkin", 7, &options), TVI_EINVAL);
    refused("no degree gives the method this order", tvi_options_named("galerkin", 1000, &options), TVI_EINVAL);
    refused("name is NULL", tvi_options_named(NULL, 4, &options), TVI_EINVAL);
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
    refused("event function: jet_log has no power series at -", RUN(0.1, 3, last, 1), TVI_EDOMAIN);
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

START_TEST(texts_of_tangents_and_dense)
{
    run r = open_run("galerkin", 8);
    state *s = &r.s;
    double D[4] = {1, 0, NAN, 0}, good[4] = {1};
    refused("row 2 of D", tvi_step_tangent(r.it, 0.1, &s->t, s->q, s->p, D, 1), TVI_ENONFINITE);
    refused("columns", tvi_step_tangent(r.it, 0.1, &s->t, s->q, s->p, D, 0), TVI_EINVAL);
    refused("D is NULL", tvi_step_tangent(r.it, 0.1, &s->t, s->q, s->p, NULL, 1), TVI_EINVAL);
    refused("h is 0", tvi_step_tangent(r.it, 0, &s->t, s->q, s->p, good, 1), TVI_EINVAL);
    refused("no last step", tvi_dense(r.it, 0.5, s->q, s->p), TVI_EINVAL);
    ck_assert_int_eq(tvi_step(r.it, 0.1, &s->t, s->q, s->p), TVI_OK);
    refused("theta = 2", tvi_dense(r.it, 2, s->q, s->p), TVI_EINVAL);
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
}
END_TEST

START_TEST(texts_of_states)
{
    enum { BYTES = 1 << 14 };
    static char bytes[BYTES], damaged[BYTES];
    run r = open_run("galerkin", 8), other = open_run("galerkin", 6);
    tvi_system *system = create_system(2, harmonic), *small = create_scene(&scene_pendulum);
    tvi_integrator *of_system = create_integrator(system, &(method){"galerkin", 8});
    tvi_integrator *of_small = create_integrator(small, &(method){"galerkin", 8});
    size_t size = 10;
    refused("10 bytes", tvi_state_save(r.it, bytes, &size), TVI_EINVAL);
    size = BYTES;
    ck_assert_int_eq(tvi_state_save(r.it, bytes, &size), TVI_OK);
    for (size_t i = 0; i < size; i++) damaged[i] = bytes[i];
    damaged[size / 2] ^= 1;
    refused("too few", tvi_state_load(r.it, bytes, 10), TVI_EINVAL);
    refused("damaged", tvi_state_load(r.it, damaged, size), TVI_EINVAL);
    damaged[8] ^= 1;
    refused("another version", tvi_state_load(r.it, damaged, size), TVI_EINVAL);
    damaged[0] ^= 1;
    refused("are no state", tvi_state_load(r.it, damaged, size), TVI_EINVAL);
    refused("another system", tvi_state_load(of_system, bytes, size), TVI_EINVAL);
    refused("another dimension", tvi_state_load(of_small, bytes, size), TVI_EINVAL);
    refused("other options", tvi_state_load(other.it, bytes, size), TVI_EINVAL);
    refused("has made no step", tvi_state_last(r.it, &r.s.t, r.s.q, r.s.p), TVI_EINVAL);
    tvi_integrator_free(of_system);
    tvi_integrator_free(of_small);
    tvi_system_free(system);
    tvi_system_free(small);
    close_run(&other);
    close_run(&r);
}
END_TEST

/* A time scale, and what has none. */
START_TEST(texts_of_rescaled_systems)
{
    tvi_system *force, *out;
    tvi_system *lagrangian, *system = create_system(2, harmonic);
    ck_assert_int_eq(tvi_system_force(&force, 1, NULL, no_force, NULL), TVI_OK);
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
    tcase_add_test(tcase, texts_of_names);
    tcase_add_test(tcase, texts_of_events);
    tcase_add_test(tcase, texts_of_times);
    tcase_add_test(tcase, texts_of_tangents_and_dense);
    tcase_add_test(tcase, texts_of_wrong_steps);
    tcase_add_test(tcase, texts_of_states);
    tcase_add_test(tcase, texts_of_rescaled_systems);
    tcase_add_test(tcase, texts_of_threads);
    return tcase;
}
