/* test_states.c - Tests saved states: a run that goes on from one is bit for bit the run that was not interrupted, and
 * what is damaged or of something else is refused. */
#include "generating.h"
#include "models.h"
#include "problems/thorough.h"
#include "integrator/saved.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    size_t size;
    unsigned char *bytes;
} saved;

static saved save(const tvi_integrator *integrator)
{
    saved s = {0, NULL};
    ck_assert_int_eq(tvi_state_save(integrator, NULL, &s.size), TVI_OK);
    s.bytes = malloc(s.size);
    size_t size = s.size;
    ck_assert_int_eq(tvi_state_save(integrator, s.bytes, &size), TVI_OK);
    ck_assert_uint_eq(size, s.size);
    return s;
}

/* Every generating function and the Galerkin curve, their compositions, the Taylor method and Stormer-Verlet. */
enum { OTHERS = 2 };
static int methods(void) { return 2 * all_kinds + OTHERS; }

static bool method_options(int which, const model *m, tvi_options *options)
{
    if (which < OTHERS) {
        *options = which ? options_verlet() : options_taylor(5);
        return !which || m->problem;
    }
    const kind *k = &kinds[(which - OTHERS) / 2];
    *options = kind_options(k, kind_least_degree(k) + 2);
    options->compose_adjoint = which % 2;
    return kind_serves(k, m);
}

static void expect_same_run(const model *m, const tvi_options *options, const tvi_integrator *a, const test_state *x,
                            const tvi_integrator *b, const test_state *y)
{
    ck_assert_msg(memcmp(x, y, sizeof *x) == 0, "%s, %s", m->name, describe(options));
    const tvi_stats *one = tvi_integrator_stats(a), *two = tvi_integrator_stats(b);
    ck_assert_msg(memcmp(one, two, sizeof *one) == 0, "%s, %s: counts", m->name, describe(options));
}

/* The bytes alone tell the state; before a step only its dimension. */
static void check_peek(const saved *s, const model *m, const test_state *wanted)
{
    int n = 0;
    test_state seen = {0};
    ck_assert_int_eq(tvi_state_peek(s->bytes, s->size, &n, NULL, NULL, NULL), TVI_OK);
    ck_assert_int_eq(n, m->n);
    ck_assert_int_eq(tvi_state_peek(s->bytes, s->size, &n, &seen.t, seen.q, seen.p), wanted ? TVI_OK : TVI_EINVAL);
    ck_assert(!wanted || memcmp(&seen, wanted, sizeof seen) == 0);
    ck_assert_int_eq(tvi_state_peek(s->bytes, s->size - 1, &n, NULL, NULL, NULL), TVI_EINVAL);
}

/* Something else: another start, steps of other sizes, and one that fails or is refused, mostly. */
static void wander(tvi_integrator *it, const model *m)
{
    test_state x = model_start(m);
    for (int i = 0; i < m->n; i++) x.p[i] *= 0.875;
    go(it, m->h, 20, &x);
    go(it, m->h / 8, 3, &x);
    (void)!tvi_step(it, 1e3 * m->h, &x.t, x.q, x.p);
}

/* Cuts after 0, 1, 3, 8 and 21 steps, one after another. A size of step that changes makes what is learnt matter. Steps
 * depend on the state that is loaded and on nothing that the integrator did before: not its bits, nor its counts. */
static void check_cuts(const model *m, const tvi_options *options)
{
    static const long cut[] = {0, 1, 2, 5, 13, 4};
    tvi_system *system = model_system(m), *same = model_system(m);
    tvi_integrator *whole = integrator_of(system, options), *piece = integrator_of(same, options);
    test_state x = model_start(m), y = x;
    for (size_t i = 0; i < sizeof cut / sizeof *cut; i++) {
        const double h = i % 2 ? m->h / 2 : m->h / 3;
        go(whole, h, cut[i], &x);
        go(piece, h, cut[i], &y);
        expect_same_run(m, options, whole, &x, piece, &y);
        const saved s = save(piece);
        tvi_integrator_free(piece);
        piece = integrator_of(same, options);
        if (i % 2) wander(piece, m);
        ck_assert_int_eq(tvi_state_load(piece, s.bytes, s.size), TVI_OK);
        test_state last = {0};
        ck_assert_int_eq(tvi_dense(piece, 0.5, last.q, last.p), TVI_EINVAL);
        ck_assert_int_eq(tvi_state_last(piece, &last.t, last.q, last.p), i ? TVI_OK : TVI_EINVAL);
        ck_assert(i == 0 || memcmp(&last, &y, sizeof y) == 0);
        check_peek(&s, m, i ? &y : NULL);
        free(s.bytes);
    }
    tvi_integrator_free(whole);
    tvi_integrator_free(piece);
    tvi_system_free(system);
    tvi_system_free(same);
}

START_TEST(cut_runs_are_whole_runs)
{
    for (int which = 0; which < methods(); which++) {
        tvi_options options;
        if (method_options(which, models[_i], &options)) check_cuts(models[_i], &options);
    }
}
END_TEST

/* A reset forgets what earlier runs taught: the same state and options give the same bits by as many passes. */
static void check_reset(const model *m, const tvi_options *options)
{
    tvi_system *system = model_system(m);
    tvi_integrator *fresh = integrator_of(system, options), *taught = integrator_of(system, options);
    test_state x = model_start(m), y = x;
    wander(taught, m);
    const tvi_stats before = *tvi_integrator_stats(taught);
    tvi_integrator_reset(taught);
    go(fresh, m->h, 8, &x);
    go(taught, m->h, 8, &y);
    const tvi_stats *one = tvi_integrator_stats(fresh), *two = tvi_integrator_stats(taught);
    ck_assert_msg(memcmp(&x, &y, sizeof x) == 0, "%s, %s", m->name, describe(options));
    ck_assert_int_eq(two->passes - before.passes, one->passes);
    ck_assert_int_eq(two->expansions - before.expansions, one->expansions);
    ck_assert_int_eq(two->force_evaluations - before.force_evaluations, one->force_evaluations);
    ck_assert_int_eq(two->factorisations - before.factorisations, one->factorisations);
    tvi_integrator_free(fresh);
    tvi_integrator_free(taught);
    tvi_system_free(system);
}

START_TEST(a_reset_forgets)
{
    for (int which = 0; which < methods(); which++) {
        tvi_options options;
        if (method_options(which, models[_i], &options)) check_reset(models[_i], &options);
    }
}
END_TEST

/* A fresh integrator that is given the last state alone lacks the history, and steps otherwise: the comparison above is
 * not idle. */
START_TEST(the_state_alone_is_not_enough)
{
    const tvi_options options = kind_options(&kinds[0], 3);
    tvi_system *system = model_system(&model_kepler);
    tvi_integrator *whole = integrator_of(system, &options), *fresh = integrator_of(system, &options);
    test_state x = model_start(&model_kepler), y;
    go(whole, 0.05, 40, &x);
    y = x;
    go(whole, 0.05, 40, &x);
    go(fresh, 0.05, 40, &y);
    ck_assert(memcmp(&x, &y, sizeof x) != 0);
    tvi_integrator_free(whole);
    tvi_integrator_free(fresh);
    tvi_system_free(system);
}
END_TEST

/* ---- Refusals ---------------------------------------------------------------------------------------------------- */

/* The run of both goes on alike: the one that refused was not touched. */
static void expect_untouched(const model *m, tvi_integrator *a, tvi_integrator *b, const test_state *at)
{
    test_state x = *at, y = *at;
    go(a, m->h / 4, 2, &x);
    go(b, m->h / 4, 2, &y);
    ck_assert(memcmp(&x, &y, sizeof x) == 0);
}

/* In make check one bit of each byte; with TVI_TESTS=all eight changes of each. */
START_TEST(every_damaged_byte_is_refused)
{
    const unsigned most = is_thorough() ? 255 : 1;
    const model *m = models[_i];
    tvi_system *system = model_system(m);
    tvi_integrator *whole = integrator_of(system, NULL), *other = integrator_of(system, NULL);
    test_state x = model_start(m), y = x;
    go(whole, m->h / 4, 5, &x);
    go(other, m->h / 4, 5, &y);
    const saved s = save(whole);
    for (size_t i = 0; i < s.size; i++)
        for (unsigned mask = 1; mask <= most; mask += mask + 1) { /* 1, 3, 7, ..., 255 */
            s.bytes[i] ^= (unsigned char)mask;
            ck_assert_msg(tvi_state_load(other, s.bytes, s.size) == TVI_EINVAL, "%s, byte %zu", m->name, i);
            ck_assert(tvi_state_peek(s.bytes, s.size, &(int){0}, NULL, NULL, NULL) == TVI_EINVAL);
            s.bytes[i] ^= (unsigned char)mask;
        }
    for (size_t size = 0; size < s.size; size++) ck_assert_int_eq(tvi_state_load(other, s.bytes, size), TVI_EINVAL);
    expect_untouched(m, whole, other, &x);
    ck_assert_int_eq(tvi_state_load(other, s.bytes, s.size), TVI_OK);
    free(s.bytes);
    tvi_integrator_free(whole);
    tvi_integrator_free(other);
    tvi_system_free(system);
}
END_TEST

/* Sound but for numbers that no integrator writes: the dimension, and how many events were told at a stop. */
START_TEST(forged_numbers_are_refused)
{
    const int64_t numbers[] = {-1, -5, 0, 3, 33, 100000, INT64_MAX, INT64_MIN};
    tvi_system *system = model_system(&model_kepler);
    tvi_integrator *integrator = integrator_of(system, NULL);
    test_state x = model_start(&model_kepler);
    go(integrator, 0.1, 1, &x);
    const saved s = save(integrator);
    const size_t of_n = offsetof(tvi_saved_identity, n);
    const size_t of_count =
        sizeof(tvi_saved_identity) + 5 * sizeof(double) + sizeof(tvi_stats) + offsetof(tvi_event_stop, event_count);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        for (int k = 0; k < 2; k++) {
            unsigned char *bytes = malloc(s.size);
            memcpy(bytes, s.bytes, s.size);
            memcpy(bytes + (k ? of_count : of_n), &numbers[i], sizeof numbers[i]);
            tvi_saved_add_checksum(bytes, s.size);
            int n = 0;
            const tvi_status seen = tvi_state_peek(bytes, s.size, &n, NULL, NULL, NULL);
            const size_t room = (s.size - sizeof(tvi_saved_identity)) / sizeof(double) - 1;
            const bool has_room = numbers[i] >= 1 && numbers[i] <= (int64_t)(room - 1) / 2;
            ck_assert_int_eq(seen, k || has_room ? TVI_OK : TVI_EINVAL); /* nothing is read behind the bytes */
            const bool is_sound = k && (numbers[i] == 0 || numbers[i] == 3);
            ck_assert_int_eq(tvi_state_load(integrator, bytes, s.size), is_sound ? TVI_OK : TVI_EINVAL);
            free(bytes);
        }
    free(s.bytes);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

START_TEST(small_buffers_and_null_are_refused)
{
    tvi_system *system = model_system(&model_kepler);
    tvi_integrator *integrator = integrator_of(system, NULL);
    const saved s = save(integrator);
    unsigned char *bytes = malloc(s.size);
    memset(bytes, 0x5a, s.size);
    for (size_t size = 0; size < s.size; size++) {
        size_t is = size;
        ck_assert_int_eq(tvi_state_save(integrator, bytes, &is), TVI_EINVAL);
        ck_assert_uint_eq(is, size);
    }
    for (size_t i = 0; i < s.size; i++) ck_assert_uint_eq(bytes[i], 0x5a);
    size_t size = s.size + 9;
    test_state x = model_start(&model_kepler);
    ck_assert_int_eq(tvi_state_save(NULL, NULL, &size), TVI_EINVAL);
    ck_assert_int_eq(tvi_state_save(integrator, NULL, NULL), TVI_EINVAL);
    ck_assert_int_eq(tvi_state_save(integrator, bytes, NULL), TVI_EINVAL);
    ck_assert_int_eq(tvi_state_load(NULL, s.bytes, s.size), TVI_EINVAL);
    ck_assert_int_eq(tvi_state_load(integrator, NULL, s.size), TVI_EINVAL);
    ck_assert_int_eq(tvi_state_last(NULL, &x.t, x.q, x.p), TVI_EINVAL);
    go(integrator, 0.1, 1, &x);
    ck_assert_int_eq(tvi_state_last(integrator, NULL, x.q, x.p), TVI_EINVAL);
    ck_assert_int_eq(tvi_state_last(integrator, &x.t, NULL, x.p), TVI_EINVAL);
    ck_assert_int_eq(tvi_state_last(integrator, &x.t, x.q, NULL), TVI_EINVAL);
    ck_assert_int_eq(tvi_state_last(integrator, &x.t, x.q, x.p), TVI_OK);
    tvi_integrator_reset(integrator);
    ck_assert_int_eq(tvi_state_last(integrator, &x.t, x.q, x.p), TVI_EINVAL);
    free(bytes);
    free(s.bytes);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* Options that differ in one field, and systems of the same dimension that differ in one number. */
static jet spring(const jet q[], jet t, void *ctx)
{
    (void)t;
    return jet_mul(*(const double *)ctx, jet_sqr(q[0]));
}

static tvi_status load_into(const saved *s, double mass, double stiffness, const tvi_options *options)
{
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 1, &mass, spring, &stiffness), TVI_OK);
    tvi_integrator *integrator = integrator_of(system, options);
    const tvi_status status = tvi_state_load(integrator, s->bytes, s->size);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return status;
}

START_TEST(other_methods_and_systems_are_refused)
{
    const double mass = 2;
    double stiffness = 3;
    tvi_system *system;
    ck_assert_int_eq(tvi_system_potential(&system, 1, &mass, spring, &stiffness), TVI_OK);
    const tvi_options options = {.expansion = TVI_AT_MIDPOINT, .degree = 3, .quadrature_points = 5, .tolerance = 1e-9};
    tvi_integrator *integrator = integrator_of(system, &options);
    const saved s = save(integrator);
    ck_assert_int_eq(load_into(&s, 2, 3, &options), TVI_OK);
    ck_assert_int_eq(load_into(&s, 2.5, 3, &options), TVI_EINVAL);
    ck_assert_int_eq(load_into(&s, 2, 3.5, &options), TVI_EINVAL);
    tvi_options others[7];
    for (int i = 0; i < 7; i++) others[i] = options;
    others[0].expansion = TVI_AT_START;
    others[1].nodes = TVI_NODES_TRUNCATED;
    others[2].degree = 4;
    others[3].quadrature_points = 6;
    others[4].tolerance = 0;
    others[5].passes = 2;
    others[6].max_passes = 9;
    for (int i = 0; i < 7; i++) ck_assert_msg(load_into(&s, 2, 3, &others[i]) == TVI_EINVAL, "options %d", i);
    free(s.bytes);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

Suite *suite_states(void)
{
    Suite *suite = suite_create("states");
    TCase *tcase = tcase_create("states");
    tcase_add_loop_test(tcase, cut_runs_are_whole_runs, 0, MODELS);
    tcase_add_loop_test(tcase, a_reset_forgets, 0, MODELS);
    tcase_add_test(tcase, the_state_alone_is_not_enough);
    tcase_add_loop_test(tcase, every_damaged_byte_is_refused, 0, MODELS);
    tcase_add_test(tcase, forged_numbers_are_refused);
    tcase_add_test(tcase, small_buffers_and_null_are_refused);
    tcase_add_test(tcase, other_methods_and_systems_are_refused);
    suite_add_tcase(suite, tcase);
    return suite;
}
