/* test_states.c - Tests saved states: a run that goes on from one is bit for bit the run that was not interrupted, and
 * what is damaged is refused. The history of something else is dropped. */
#include "generating.h"
#include "models.h"
#include "problems/thorough.h"
#include "problems/texts.h"

#include <stdlib.h>
#include <string.h>

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

/* The text alone tells the state. */
static void check_peek(const char *text, const model *m, const test_state *wanted)
{
    int n = 0;
    test_state seen = {0};
    const size_t size = strlen(text);
    ck_assert_int_eq(tvi_state_peek(text, size, &n, NULL, NULL, NULL), TVI_OK);
    ck_assert_int_eq(n, m->n);
    ck_assert_int_eq(tvi_state_peek(text, size, &n, &seen.t, seen.q, seen.p), TVI_OK);
    ck_assert(memcmp(&seen, wanted, sizeof seen) == 0);
    ck_assert_int_eq(tvi_state_peek(text, size - 2, &n, NULL, NULL, NULL), TVI_EINVAL);
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
    size_t size;
    ck_assert_int_eq(tvi_state_to_text(piece, y.t, y.q, y.p, NULL, &size), TVI_OK); /* before a run */
    for (size_t i = 0; i < sizeof cut / sizeof *cut; i++) {
        const double h = i % 2 ? m->h / 2 : m->h / 3;
        go(whole, h, cut[i], &x);
        go(piece, h, cut[i], &y);
        expect_same_run(m, options, whole, &x, piece, &y);
        char *const text = text_of_state(piece, y.t, y.q, y.p);
        ck_assert_uint_eq(strlen(text), size);
        tvi_integrator_free(piece);
        piece = integrator_of(same, options);
        if (i % 2) wander(piece, m);
        test_state loaded = {0}, last = {0};
        ck_assert_msg(tvi_state_from_text(piece, text, size, &loaded.t, loaded.q, loaded.p) == TVI_OK, "%s: %s",
                      m->name, tvi_last_error());
        ck_assert_str_eq(tvi_last_error(), "");
        ck_assert(memcmp(&loaded, &y, sizeof y) == 0);
        char *const again = text_of_state(piece, y.t, y.q, y.p);
        ck_assert_str_eq(again, text);
        ck_assert_int_eq(tvi_dense(piece, 0.5, last.q, last.p), TVI_EINVAL);
        ck_assert_int_eq(tvi_state_last(piece, &last.t, last.q, last.p), i ? TVI_OK : TVI_EINVAL);
        ck_assert(i == 0 || memcmp(&last, &y, sizeof y) == 0);
        check_peek(text, m, &y);
        free(text);
        free(again);
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

static tvi_status read_text(tvi_integrator *it, const char *text, size_t size)
{
    test_state x;
    return tvi_state_from_text(it, text, size, &x.t, x.q, x.p);
}

/* In make check one bit of each character; with TVI_TESTS=all eight changes of each. A blank may become another one. */
START_TEST(damage_is_refused)
{
    const unsigned most = is_thorough() ? 255 : 1;
    const model *m = models[_i];
    tvi_system *system = model_system(m);
    tvi_integrator *whole = integrator_of(system, NULL), *other = integrator_of(system, NULL);
    test_state x = model_start(m), y = x;
    go(whole, m->h / 4, 5, &x);
    go(other, m->h / 4, 5, &y);
    char *const text = text_of_state(whole, x.t, x.q, x.p);
    const size_t size = strlen(text), step = is_thorough() ? 1 : 7;
    for (size_t i = 0; i < size - 1; i += step)
        for (unsigned mask = 1; mask <= most; mask += mask + 1) { /* 1, 3, 7, ..., 255 */
            text[i] = (char)((unsigned char)text[i] ^ mask);
            if (!text[i] || !strchr(" \t\r\n", text[i])) {
                ck_assert_msg(read_text(other, text, size) == TVI_EINVAL, "%s, character %zu", m->name, i);
                ck_assert(tvi_state_peek(text, size, &(int){0}, NULL, NULL, NULL) == TVI_EINVAL);
            }
            text[i] = (char)((unsigned char)text[i] ^ mask);
        }
    for (size_t k = 0; k < size - 1; k += step) ck_assert_int_eq(read_text(other, text, k), TVI_EINVAL);
    expect_untouched(m, whole, other, &x);
    ck_assert_int_eq(read_text(other, text, size), TVI_OK);
    free(text);
    tvi_integrator_free(whole);
    tvi_integrator_free(other);
    tvi_system_free(system);
}
END_TEST

/* Writes a word of the same length over the one that stands `words` words after a label, with the right hash. */
static void forge(char *text, const char *label, int words, const char *word)
{
    char *at = strstr(text, label) + 1;
    while (words-- > 0) at = strpbrk(at, " \n") + 1;
    memcpy(at, word, strlen(word));
    sign_text(text);
}

/* Sound but for numbers that no integrator writes. */
START_TEST(forged_numbers_are_refused)
{
    static const struct {
        const char *label, *word;
        int words;
        bool is_good, is_peeked;
    } rows[] = {
        {"\nn ", "0", 1, false, false},
        {"\nn ", "3", 1, false, false},
        {"\nfrom_step ", "2", 1, false, false},
        {"\nq ", "+0x1.0000000000000p-0001", 2, false, false}, /* low-order parts */
        {"\nt ", "+0x1.0000000000000p-0056", 2, true, true},   /* t = 0.1 */
        {"\nt ", "-0x1.0000000000000p-0020", 2, false, false},
        {"\nstop ", "0000000000000021", 2, false, false}, /* the number of events at the stop */
        {"\nstop ", "ffffffffffffffff", 2, false, false},
        {"\nstop ", "0000000000000003", 2, true, true},
        {"\nhistory ", "0000000000000000", 1, true, true}, /* of another system: dropped */
        {"\nh ", "ffffffffffffffff", 1, false, true},      /* counts of steps: negative, and near overflow */
        {"\nh ", "7fffffffffffffff", 2, false, true},
        {"\nh ", "7fffffffffffffff", 3, false, true},
        {"\nh ", "7fffffffffffffff", 4, false, true},
        {"\nh ", "7fffffffffffffff", 6, false, true},
        {"\nh ", "0000000000000007", 2, true, true},
    };
    tvi_system *system = model_system(&model_kepler);
    tvi_integrator *integrator = integrator_of(system, NULL);
    test_state x = model_start(&model_kepler);
    go(integrator, 0.1, 1, &x);
    char *const text = text_of_state(integrator, x.t, x.q, x.p);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char *const forged = text_of_state(integrator, x.t, x.q, x.p);
        forge(forged, rows[i].label, rows[i].words, rows[i].word);
        const tvi_status peeked = tvi_state_peek(forged, strlen(forged), &(int){0}, NULL, NULL, NULL);
        ck_assert_msg(peeked == (rows[i].is_peeked ? TVI_OK : TVI_EINVAL), "row %zu is peeked at: %d", i, peeked);
        const tvi_status status = read_text(integrator, forged, strlen(forged));
        ck_assert_msg(status == (rows[i].is_good ? TVI_OK : TVI_EINVAL), "row %zu: %d", i, status);
        ck_assert_int_eq(read_text(integrator, text, strlen(text)), TVI_OK);
        free(forged);
    }
    free(text);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

START_TEST(small_buffers_and_null_are_refused)
{
    tvi_system *system = model_system(&model_kepler);
    tvi_integrator *integrator = integrator_of(system, NULL);
    test_state x = model_start(&model_kepler);
    char *const whole = text_of_state(integrator, x.t, x.q, x.p);
    const size_t needed = strlen(whole);
    unsigned char *bytes = malloc(needed);
    memset(bytes, 0x5a, needed);
    for (size_t size = 0; size < needed; size++) {
        size_t is = size;
        ck_assert_int_eq(tvi_state_to_text(integrator, x.t, x.q, x.p, (char *)bytes, &is), TVI_EINVAL);
        ck_assert_uint_eq(is, size);
    }
    for (size_t i = 0; i < needed; i++) ck_assert_uint_eq(bytes[i], 0x5a);
    size_t size = needed;
    ck_assert_int_eq(tvi_state_to_text(integrator, x.t, x.q, x.p, (char *)bytes, &size), TVI_OK);
    ck_assert(size == needed && memcmp(bytes, whole, size) == 0);
    ck_assert_int_eq(tvi_state_peek(NULL, needed, &(int){0}, NULL, NULL, NULL), TVI_EINVAL);
    ck_assert_int_eq(tvi_state_peek(whole, needed, NULL, NULL, NULL, NULL), TVI_EINVAL);
    ck_assert_int_eq(tvi_state_last(NULL, &x.t, x.q, x.p), TVI_EINVAL);
    go(integrator, 0.1, 1, &x);
    ck_assert_int_eq(tvi_state_last(integrator, NULL, x.q, x.p), TVI_EINVAL);
    ck_assert_int_eq(tvi_state_last(integrator, &x.t, NULL, x.p), TVI_EINVAL);
    ck_assert_int_eq(tvi_state_last(integrator, &x.t, x.q, NULL), TVI_EINVAL);
    ck_assert_int_eq(tvi_state_last(integrator, &x.t, x.q, x.p), TVI_OK);
    tvi_integrator_reset(integrator);
    ck_assert_int_eq(tvi_state_last(integrator, &x.t, x.q, x.p), TVI_EINVAL);
    free(bytes);
    free(whole);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* ---- Histories of others ----------------------------------------------------------------------------------------- */

/* Options that differ in one field, and systems of the same dimension that differ in one number. */
static jet spring(const jet q[], jet t, void *ctx)
{
    (void)t;
    return jet_mul(*(const double *)ctx, jet_sqr(q[0]));
}

static const char was_dropped[] = "and was dropped";

/* Whether the history of the text is loaded. The state is loaded in any case, and steps go on from it. */
static bool keeps_history(const char *text, const test_state *wanted, double mass, double stiffness,
                          const tvi_options *options)
{
    tvi_system *system;
    test_state x = {0}, last = {0};
    ck_assert_int_eq(tvi_system_potential(&system, 1, &mass, spring, &stiffness), TVI_OK);
    tvi_integrator *integrator = integrator_of(system, options);
    ck_assert_int_eq(tvi_state_from_text(integrator, text, strlen(text), &x.t, x.q, x.p), TVI_OK);
    const bool is_kept = strcmp(tvi_last_error(), "") == 0;
    ck_assert(is_kept || strstr(tvi_last_error(), was_dropped));
    ck_assert_int_eq(tvi_integrator_stats(integrator)->steps, is_kept ? 5 : 0);
    ck_assert_int_eq(tvi_state_last(integrator, &last.t, last.q, last.p), TVI_OK);
    ck_assert(memcmp(&x, wanted, sizeof x) == 0 && memcmp(&last, wanted, sizeof last) == 0);
    go(integrator, 0.1, 3, &x);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return is_kept;
}

START_TEST(histories_of_others_are_dropped)
{
    const double mass = 2;
    double stiffness = 3;
    tvi_system *system;
    test_state x = {.q = {1}};
    ck_assert_int_eq(tvi_system_potential(&system, 1, &mass, spring, &stiffness), TVI_OK);
    const tvi_options options = {.expansion = TVI_AT_MIDPOINT, .degree = 3, .quadrature_points = 5, .tolerance = 1e-9};
    tvi_integrator *integrator = integrator_of(system, &options);
    go(integrator, 0.1, 5, &x);
    char *text = text_of_state(integrator, x.t, x.q, x.p);
    ck_assert(keeps_history(text, &x, 2, 3, &options));
    ck_assert(!keeps_history(text, &x, 2.5, 3, &options));
    ck_assert(!keeps_history(text, &x, 2, 3.5, &options));
    tvi_options others[7];
    for (int i = 0; i < 7; i++) others[i] = options;
    others[0].expansion = TVI_AT_START;
    others[1].nodes = TVI_NODES_TRUNCATED;
    others[2].degree = 4;
    others[3].quadrature_points = 6;
    others[4].tolerance = 0;
    others[5].passes = 2;
    others[6].max_passes = 9;
    for (int i = 0; i < 7; i++) ck_assert_msg(!keeps_history(text, &x, 2, 3, &others[i]), "options %d", i);
    /* another version has another hash, and a history of another size */
    memcpy(history_hash_in(text), "0123456789abcdef", 16);
    sign_text(text);
    ck_assert(!keeps_history(text, &x, 2, 3, &options));
    char *shorter = strstr(text, "\nh "), *end = strstr(text, "\nend ");
    memmove(shorter, end, strlen(end) + 1);
    char *count = history_hash_in(text) + 17;
    memmove(count + 1, strchr(count, '\n'), strlen(strchr(count, '\n')) + 1);
    *count = '0';
    memcpy(history_hash_in(text), "0000000000000000", 16);
    sign_text(text);
    ck_assert_int_eq(tvi_state_peek(text, strlen(text), &(int){0}, NULL, NULL, NULL), TVI_OK);
    ck_assert(!keeps_history(text, &x, 2, 3, &options));
    free(text);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}
END_TEST

/* The instruction set is chosen when a system is made. Another one drops the history, and goes on to roundoff. */
START_TEST(instruction_sets_have_histories_of_their_own)
{
    const model *m = &model_kepler;
    tvi_system *wide = model_system(m);
    setenv("TVI_ISA", "base", 1);
    tvi_system *base = model_system(m);
    unsetenv("TVI_ISA");
    tvi_integrator *one = integrator_of(wide, NULL), *other = integrator_of(base, NULL);
    test_state x = model_start(m), y = x;
    go(one, m->h / 4, 5, &x);
    char *text = text_of_state(one, x.t, x.q, x.p), *own = text_of_state(other, y.t, y.q, y.p);
    const bool is_same = strncmp(history_hash_in(text), history_hash_in(own), 16) == 0; /* a machine with one set */
    ck_assert_int_eq(tvi_state_from_text(other, text, strlen(text), &y.t, y.q, y.p), TVI_OK);
    ck_assert((strstr(tvi_last_error(), was_dropped) == NULL) == is_same);
    go(one, m->h / 4, 5, &x);
    go(other, m->h / 4, 5, &y);
    for (int i = 0; i < m->n; i++) ck_assert_double_eq_tol(x.q[i], y.q[i], 1e-14);
    free(own);
    free(text);
    tvi_integrator_free(one);
    tvi_integrator_free(other);
    tvi_system_free(base);
    tvi_system_free(wide);
}
END_TEST

Suite *suite_states(void)
{
    Suite *suite = suite_create("states");
    TCase *tcase = tcase_create("states");
    tcase_add_loop_test(tcase, cut_runs_are_whole_runs, 0, MODELS);
    tcase_add_loop_test(tcase, a_reset_forgets, 0, MODELS);
    tcase_add_test(tcase, the_state_alone_is_not_enough);
    tcase_add_loop_test(tcase, damage_is_refused, 0, MODELS);
    tcase_add_test(tcase, forged_numbers_are_refused);
    tcase_add_test(tcase, small_buffers_and_null_are_refused);
    tcase_add_test(tcase, histories_of_others_are_dropped);
    tcase_add_test(tcase, instruction_sets_have_histories_of_their_own);
    suite_add_tcase(suite, tcase);
    return suite;
}
