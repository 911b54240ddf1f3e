/* test_texts.c - states as text: all that travels is read as it was written, by every form, method and instruction set,
 * by integrators and members of ensembles, and a run goes on from it; what is no such text is refused. */
#include "ensemble.h"
#include "problems/refusals.h"
#include "problems/texts.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MEMBERS = 11, STEPS = 24, BAD = 5 };

static group whole, other, last;

static char *text_of(const alone *a) { return text_of_state(a->integrator, a->t, a->q, a->p); }

static char *text_of_one(const tvi_ensemble *ensemble, const group *c, int member)
{
    return text_of_member(ensemble, member, c->t, c->q, c->p);
}

static void read_alone(alone *a, const char *text)
{
    OK(tvi_state_from_text(a->integrator, text, strlen(text), &a->t, a->q, a->p));
}

/* Has an integrator of its own read the text and go on from there. The integrator writes the text that it read: all of
 * it if its history is alike, and otherwise the part before the history. */
static alone read_by(const tvi_system *system, const tvi_options *options, const char *text)
{
    alone a = start_alone(system, options, 99);
    read_alone(&a, text);
    const bool is_dropped = strstr(tvi_last_error(), "and was dropped") != NULL;
    char *again = text_of(&a);
    ck_assert(strncmp(again, text, is_dropped ? (size_t)(history_hash_in(again) - again) : strlen(text)) == 0);
    free(again);
    return a;
}

static void go(alone *a) { OK(tvi_integrate(a->integrator, H, STEPS, &a->t, a->q, a->p, NULL, NULL)); }

/* ---- What is read goes on ---------------------------------------------------------------------------------------- */

/* There are low-order parts, and a state that is not its own has none. */
static void expect_low_parts(const alone *a, const char *text)
{
    static const char zero[] = " +0x0.0000000000000p+0000\n";
    const double q[N] = {a->q[0], nextafter(a->q[1], 1)};
    int parts = 0, rows = 0;
    for (const char *at = strstr(text, "\nq "); strncmp(at, "\nstop ", 6) != 0; at = strchr(at + 1, '\n'), rows++)
        parts += strstr(at + 3, zero) != strchr(at + 3, ' ');
    ck_assert_int_ge(rows, 2 * N);
    ck_assert_int_ge(parts, 1);
    char *bare = text_of_state(a->integrator, a->t, q, a->p);
    ck_assert_uint_eq(strlen(bare), strlen(text));
    const bool has_e = strstr(bare, "\ne ") != NULL;
    rows = 0;
    for (const char *at = strstr(bare, zero); at; at = strstr(at + 1, zero)) rows++;
    ck_assert_int_eq(rows, 2 * N + 1 + has_e);
    ck_assert_ptr_nonnull(strstr(bare, "\nfrom_step 0\n"));
    free(bare);
}

START_TEST(runs_go_on)
{
    const form *as = &forms[_i / method_count];
    tvi_system *system = system_of(as);
    tvi_options options;
    if (has_options(system, &methods[_i % method_count], &options)) {
        alone a = start_alone(system, &options, 3);
        go(&a);
        char *text = text_of(&a);
        ck_assert((strstr(text, "\ne ") != NULL) == (strcmp(as->name, "rescaled") == 0));
        expect_low_parts(&a, text);
        alone b = read_by(system, &options, text), c = start_alone(system, &options, 3);
        expect_same("as it was read", group_of(&a, &whole), 0, group_of(&b, &other), 0);
        go(&c);
        read_alone(&c, text);
        ck_assert_int_eq(tvi_dense(c.integrator, 0.5, c.q, c.p), TVI_EINVAL);
        go(&a), go(&b), go(&c);
        expect_same("its own history is forgotten", group_of(&c, &whole), 0, group_of(&b, &other), 0);
        expect_same("not interrupted", group_of(&a, &whole), 0, group_of(&b, &other), 0);
        /* without the history it is another run, to roundoff */
        memcpy(history_hash_in(text), "0123456789abcdef", 16);
        sign_text(text);
        alone d = read_by(system, &options, text);
        go(&d);
        const double apart = distance(group_of(&a, &whole), 0, group_of(&d, &other), 0);
        ck_assert_msg(apart <= 64 * DBL_EPSILON, "%s, %s: apart by %g", as->name, methods[_i % method_count].name,
                      apart);
        end_alone(&a), end_alone(&b), end_alone(&c), end_alone(&d);
        for (int k = 0; k < method_count; k++)
            if (has_options(system, &methods[k], &options)) {
                d = read_by(system, &options, text);
                end_alone(&d);
            }
        free(text);
    }
    tvi_system_free(system);
}
END_TEST

/* The instruction set is chosen when a system is made. */
START_TEST(instruction_sets)
{
    tvi_system *system[2];
    for (int k = 0; k < 2; k++) {
        if (k == 0) setenv("TVI_ISA", "base", 1);
        system[k] = system_of(&forms[_i]);
        unsetenv("TVI_ISA");
    }
    for (int k = 0; k < 2; k++) {
        alone a = start_alone(system[k], NULL, 3);
        go(&a);
        char *text = text_of(&a);
        alone b = read_by(system[1 - k], NULL, text);
        go(&a), go(&b);
        ck_assert_double_le(distance(group_of(&a, &whole), 0, group_of(&b, &other), 0), 64 * DBL_EPSILON);
        end_alone(&a), end_alone(&b);
        free(text);
    }
    for (int k = 0; k < 2; k++) tvi_system_free(system[k]);
}
END_TEST

static jet sum(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_add(q[0], q[1]);
}

/* A state of a user that is on an event but for roundoff leaves it, as where it is given by itself. */
START_TEST(a_start_on_an_event)
{
    tvi_system *system = system_of(&forms[0]);
    tvi_event *event;
    OK(tvi_event_create(&event, N, TVI_EITHER, true, sum, NULL));
    const tvi_event *const events[] = {event};
    alone a = start_alone(system, NULL, 3), b = start_alone(system, NULL, 3);
    a.q[0] = 0.1, a.q[1] = nextafter(-0.1, -1), a.p[0] = 0.1, a.p[1] = 0.2;
    char *text = text_of(&a);
    read_alone(&b, text);
    for (int k = 0; k < 2; k++) {
        alone *it = k ? &b : &a;
        ck_assert_int_eq(
            tvi_integrate_events(it->integrator, H, 1000, events, 1, &it->t, it->q, it->p, NULL, NULL, NULL),
            TVI_ESTOPPED);
        ck_assert_double_ge(it->t, 0.5);
    }
    expect_same("from an event", group_of(&a, &whole), 0, group_of(&b, &other), 0);
    free(text);
    tvi_event_free(event);
    end_alone(&a), end_alone(&b);
    tvi_system_free(system);
}
END_TEST

/* ---- Members ----------------------------------------------------------------------------------------------------- */

static void run(tvi_ensemble *ensemble, group *c)
{
    OK(tvi_ensemble_integrate(ensemble, H, STEPS, c->t, c->q, c->p, c->status, NULL, NULL));
}

/* Each member to an integrator, and from there to another place of another ensemble, whose other members stay. */
START_TEST(members_travel)
{
    tvi_system *system = system_of(&forms[_i / method_count]);
    tvi_options options;
    if (has_options(system, &methods[_i % method_count], &options)) {
        tvi_ensemble *from, *to;
        OK(tvi_ensemble_create(&from, system, &options, MEMBERS, 1));
        OK(tvi_ensemble_create(&to, system, &options, MEMBERS + 1, 1));
        start_group(&whole, MEMBERS, 0);
        set_values(from, MEMBERS, 0);
        run(from, &whole);
        start_group(&other, MEMBERS + 1, 30);
        other.q[MEMBERS + 1 + BAD] = 1e9; /* a member that fails, mostly, and goes on from the text */
        run(to, &other);
        ck_assert(_i > 0 || other.status[BAD] != TVI_OK);
        for (int m = 0; m < MEMBERS; m += m < 9 ? 3 : 1) {
            char *text = text_of_one(from, &whole, m), *stays = text_of_one(to, &other, 0);
            alone a = read_by(system, &options, text);
            end_alone(&a);
            const int place = m == 3 ? BAD : m + 1;
            OK(tvi_ensemble_member_from_text(to, place, text, strlen(text), other.t, other.q, other.p));
            char *again = text_of_one(to, &other, place), *is = text_of_one(to, &other, 0);
            ck_assert_str_eq(again, text);
            ck_assert_str_eq(is, stays);
            free(again), free(is), free(stays), free(text);
        }
        run(from, &whole), run(to, &other);
        for (int m = 0; m < MEMBERS; m += m < 9 ? 3 : 1) {
            const int place = m == 3 ? BAD : m + 1;
            ck_assert_int_eq(other.status[place], TVI_OK);
            expect_same("a member that has moved", &other, place, &whole, m);
        }
        tvi_ensemble_free(from);
        tvi_ensemble_free(to);
    }
    tvi_system_free(system);
}
END_TEST

/* ---- Refusals ---------------------------------------------------------------------------------------------------- */

static void expect_bad_text(alone *a, const char *text, size_t size, const char *reason)
{
    const alone before = *a;
    ck_assert_int_eq(tvi_state_from_text(a->integrator, text, size, &a->t, a->q, a->p), TVI_EINVAL);
    ck_assert_msg(strstr(tvi_last_error(), reason), "\"%s\" in the place of \"%s\"", tvi_last_error(), reason);
    ck_assert(memcmp(&before, a, sizeof before) == 0);
}

/* All that is cut short or differs in one character, but for blanks. */
START_TEST(damage_is_refused)
{
    tvi_system *system = system_of(&forms[_i]);
    alone a = start_alone(system, NULL, 3);
    go(&a);
    char *text = text_of(&a);
    const size_t size = strlen(text), history = (size_t)(history_hash_in(text) - text);
    for (size_t k = 0; k + 1 < size; k += k > history + 40 && k + 50 < size ? 23 : 1) {
        char *cut = malloc(k + 1); /* what is read behind its end is seen by the sanitizer */
        memcpy(cut, text, k);
        expect_bad_text(&a, cut, k, "");
        free(cut);
        for (int bit = 0; bit < 8; bit++) {
            text[k] = (char)(text[k] ^ 1 << bit);
            if (!strchr(" \n\t\r", text[k]) || !text[k]) expect_bad_text(&a, text, size, "");
            text[k] = (char)(text[k] ^ 1 << bit);
        }
    }
    char *same = text_of(&a);
    ck_assert_str_eq(same, text);
    free(same);
    char *longer = calloc(size + 3, 1);
    expect_bad_text(&a, strcat(strcpy(longer, text), "e"), size + 1, "follows");
    expect_bad_text(&a, text, size + 1, "follows"); /* the 0 */
    free(longer);
    free(text);
    end_alone(&a);
    tvi_system_free(system);
}
END_TEST

static jet attraction(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_mul(jet_parameter(q[0], 0, 1), jet_pow(jet_dot(q, q, 3), -0.5)));
}

/* A rescaled system refuses a state at which H has no value, and keeps its own state and parameters. */
START_TEST(others_are_refused)
{
    tvi_system *system = system_of(&forms[0]), *base, *rescaled;
    alone a = start_alone(system, NULL, 3), b = {0}, c = {0};
    double x[3] = {1, 0.5, 0}, y[3] = {0, 0.6, 0}, t = 0, strength = 0.9;
    size_t size = 100;
    go(&a);
    OK(tvi_system_potential(&base, 3, NULL, attraction, NULL));
    OK(tvi_system_rescaled(&rescaled, base, NULL, NULL));
    OK(tvi_integrator_create(&b.integrator, rescaled, NULL));
    OK(tvi_integrate(b.integrator, 0.2, 5, &t, x, y, NULL, NULL));
    char *own = text_of_state(b.integrator, t, x, y), *bad;
    OK(tvi_integrator_create(&c.integrator, rescaled, NULL));
    OK(tvi_integrator_set_parameters(c.integrator, &strength));
    bad = text_of_state(c.integrator, 0, (double[3]){0}, y);
    const double before[] = {t, x[0], y[0]};
    ck_assert_int_eq(tvi_state_from_text(b.integrator, bad, strlen(bad), &t, x, y), TVI_EDOMAIN);
    ck_assert(t == before[0] && x[0] == before[1] && y[0] == before[2]);
    char *same = text_of_state(b.integrator, t, x, y);
    ck_assert_str_eq(same, own);
    expect_bad_text(&a, own, strlen(own), "another dimension");
    expect_bad_text(&a, "tvi state 3\n", 12, "format");
    expect_bad_text(&a, "tvi state 0\n", 12, "format");
    expect_bad_text(&a, "tvistate\20\0\0", 11, "write them with tvi_state_to_text");
    expect_bad_text(&a, "tvistate", 8, "no state");
    expect_bad_text(&a, "tvi state 1\nn 2\nparameters 0\n", 29, "other parameters");
    ck_assert_int_eq(tvi_state_to_text(a.integrator, a.t, a.q, a.p, same, &size), TVI_EINVAL);
    ck_assert_ptr_nonnull(strstr(tvi_last_error(), "the buffer has 100 bytes"));
    ck_assert_uint_eq(size, 100);
    a.q[0] = NAN;
    ck_assert_int_eq(tvi_state_to_text(a.integrator, a.t, a.q, a.p, NULL, &size), TVI_ENONFINITE);
    free(own), free(bad), free(same);
    end_alone(&a), end_alone(&b), end_alone(&c);
    tvi_system_free(rescaled);
    tvi_system_free(base);
    tvi_system_free(system);
}
END_TEST

static int read_within(long step, double t, const double q[], const double p[], void *ctx)
{
    double s, x[N], y[N];
    (void)step;
    char *text = text_of_state(ctx, t, q, p);
    ck_assert_int_eq(tvi_state_from_text(ctx, text, strlen(text), &s, x, y), TVI_EINVAL);
    ck_assert_ptr_nonnull(strstr(tvi_last_error(), "in a run, whose observer"));
    free(text);
    return 0;
}

/* The text is whole, so that nothing but what is named is wrong. */
START_TEST(calls_are_refused)
{
    tvi_system *system = system_of(&forms[0]);
    tvi_ensemble *e;
    alone a = start_alone(system, NULL, 3);
    size_t size;
    OK(tvi_ensemble_create(&e, system, NULL, MEMBERS, 1));
    start_group(&last, MEMBERS, 0);
    double *const t = last.t, *const q = last.q, *const p = last.p;
    char *text = text_of(&a);
    const size_t all = strlen(text);
    const group before = last;
    refused("integrator is NULL", tvi_state_to_text(NULL, 0, q, p, NULL, &size), TVI_EINVAL);
    refused("q is NULL", tvi_state_to_text(a.integrator, 0, NULL, p, NULL, &size), TVI_EINVAL);
    refused("p is NULL", tvi_state_to_text(a.integrator, 0, q, NULL, NULL, &size), TVI_EINVAL);
    refused("size is NULL", tvi_state_to_text(a.integrator, 0, q, p, NULL, NULL), TVI_EINVAL);
    refused("integrator is NULL", tvi_state_from_text(NULL, text, all, t, q, p), TVI_EINVAL);
    refused("text is NULL", tvi_state_from_text(a.integrator, NULL, all, t, q, p), TVI_EINVAL);
    refused("t is NULL", tvi_state_from_text(a.integrator, text, all, NULL, q, p), TVI_EINVAL);
    refused("q is NULL", tvi_state_from_text(a.integrator, text, all, t, NULL, p), TVI_EINVAL);
    refused("p is NULL", tvi_state_from_text(a.integrator, text, all, t, q, NULL), TVI_EINVAL);
    refused("ensemble is NULL", tvi_ensemble_member_to_text(NULL, 0, t, q, p, NULL, &size), TVI_EINVAL);
    refused("member = -1", tvi_ensemble_member_to_text(e, -1, t, q, p, NULL, &size), TVI_EINVAL);
    refused("member = 11", tvi_ensemble_member_to_text(e, MEMBERS, t, q, p, NULL, &size), TVI_EINVAL);
    refused("t is NULL", tvi_ensemble_member_to_text(e, 0, NULL, q, p, NULL, &size), TVI_EINVAL);
    refused("q is NULL", tvi_ensemble_member_to_text(e, 0, t, NULL, p, NULL, &size), TVI_EINVAL);
    refused("p is NULL", tvi_ensemble_member_to_text(e, 0, t, q, NULL, NULL, &size), TVI_EINVAL);
    refused("size is NULL", tvi_ensemble_member_to_text(e, 0, t, q, p, NULL, NULL), TVI_EINVAL);
    refused("ensemble is NULL", tvi_ensemble_member_from_text(NULL, 0, text, all, t, q, p), TVI_EINVAL);
    refused("member = -1", tvi_ensemble_member_from_text(e, -1, text, all, t, q, p), TVI_EINVAL);
    refused("member = 11", tvi_ensemble_member_from_text(e, MEMBERS, text, all, t, q, p), TVI_EINVAL);
    refused("text is NULL", tvi_ensemble_member_from_text(e, 0, NULL, all, t, q, p), TVI_EINVAL);
    refused("t is NULL", tvi_ensemble_member_from_text(e, 0, text, all, NULL, q, p), TVI_EINVAL);
    refused("q is NULL", tvi_ensemble_member_from_text(e, 0, text, all, t, NULL, p), TVI_EINVAL);
    refused("p is NULL", tvi_ensemble_member_from_text(e, 0, text, all, t, q, NULL), TVI_EINVAL);
    expect_same("what is refused changes nothing", &before, 0, &last, 0);
    OK(tvi_ensemble_member_from_text(e, 0, text, all, t, q, p));
    OK(tvi_state_from_text(a.integrator, text, all, t, q, p));
    OK(tvi_integrate(a.integrator, H, 1, &a.t, a.q, a.p, read_within, a.integrator));
    free(text);
    tvi_ensemble_free(e);
    end_alone(&a);
    tvi_system_free(system);
}
END_TEST

Suite *suite_texts(void)
{
    Suite *suite = suite_create("texts");
    TCase *tests = tcase_create("texts");
    tcase_add_loop_test(tests, runs_go_on, 0, form_count * method_count);
    tcase_add_loop_test(tests, instruction_sets, 0, form_count);
    tcase_add_test(tests, a_start_on_an_event);
    tcase_add_loop_test(tests, members_travel, 0, form_count * method_count);
    tcase_add_loop_test(tests, damage_is_refused, 0, form_count);
    tcase_add_test(tests, others_are_refused);
    tcase_add_test(tests, calls_are_refused);
    suite_add_tcase(suite, tests);
    add_text_format(suite);
    return suite;
}
