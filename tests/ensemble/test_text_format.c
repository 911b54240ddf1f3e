/* test_text_format.c - the formats of states as text: texts that every version reads, and which words are numbers. */
#include "ensemble.h"
#include "problems/texts.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One that every later version has to read: a normal, a least and a largest number, and -0. */
static const char known[] = "tvi state 1\n"
                            "n 2\n"
                            "parameters 1\n"
                            "value 0x1.8p+0\n"
                            "t 0x1.921fb54442d18p+1 0x1.1a62633145c07p-53\n"
                            "q -0x0p+0 0x0p+0\n"
                            "q 0x1.999999999999ap-4 -0x1.999999999999ap-59\n"
                            "p 0x0.0000000000001p-1022 0x0p+0\n"
                            "p -0x1.fffffffffffffp+1023 0x0p+0\n"
                            "end 54f24d22b5663b80\n";

/* The same state in the next format, with a stop, and a history of another version. */
static const char known_2[] = "tvi state 2\n"
                              "n 2\n"
                              "parameters 1\n"
                              "from_step 1\n"
                              "value +0x1.8000000000000p+0000\n"
                              "t +0x1.921fb54442d18p+0001 +0x1.1a62633145c07p-0053\n"
                              "q -0x0.0000000000000p+0000 +0x0.0000000000000p+0000\n"
                              "q +0x1.999999999999ap-0004 -0x1.999999999999ap-0059\n"
                              "p +0x0.0000000000001p-1022 +0x0.0000000000000p+0000\n"
                              "p -0x1.fffffffffffffp+1023 +0x0.0000000000000p+0000\n"
                              "stop 0000000000000001 0000000000000002 0123456789abcdef fedcba9876543210\n"
                              "stop 0000000000000000 0000000000000000 0000000000000000 0000000000000000\n"
                              "stop 0000000000000000 0000000000000000 0000000000000000 0000000000000000\n"
                              "stop 0000000000000000 0000000000000000 0000000000000000 0000000000000000\n"
                              "stop 0000000000000000 0000000000000000 0000000000000000 0000000000000000\n"
                              "stop 0000000000000000 0000000000000000 0000000000000000 0000000000000000\n"
                              "stop 0000000000000000 0000000000000000 0000000000000000 0000000000000000\n"
                              "stop 0000000000000000 0000000000000000 0000000000000000 0000000000000000\n"
                              "stop 0000000000000000 0000000000000000 8000000000000000 3fb999999999999a\n"
                              "stop 0000000000000000 0000000000000000 400921fb54442d18\n"
                              "history 0123456789abcdef 3\n"
                              "h 0000000000000001 0000000000000002 0000000000000003\n"
                              "end 6aa7b38fc2d83131\n";

/* The text without its history, whose words depend on the machine. */
static char *without_history(char *text)
{
    strstr(text, "\nhistory ")[1] = '\0';
    return text;
}

START_TEST(formats_stay)
{
    const char *const text = _i ? known_2 : known;
    tvi_system *system = system_of(&forms[0]);
    alone a = start_alone(system, NULL, 3);
    char expected[sizeof known_2] = "";
    OK(tvi_state_from_text(a.integrator, text, strlen(text), &a.t, a.q, a.p));
    ck_assert((strstr(tvi_last_error(), "and was dropped") != NULL) == (_i == 1));
    char *again = without_history(text_of_state(a.integrator, a.t, a.q, a.p));
    without_history(strcpy(expected, known_2));
    if (_i == 0) *strstr(again, "stop ") = *strstr(expected, "stop ") = '\0'; /* format 1 has none */
    ck_assert_str_eq(again, expected);
    free(again);
    ck_assert(a.t == acos(-1) && a.q[0] == 0 && signbit(a.q[0]) && a.q[1] == 0.1);
    ck_assert(a.p[0] == DBL_TRUE_MIN && a.p[1] == -DBL_MAX);
    int n;
    double t, q[N], p[N];
    OK(tvi_state_peek(text, strlen(text), &n, &t, q, p));
    ck_assert(n == N && t == a.t && memcmp(q, a.q, sizeof q) == 0 && memcmp(p, a.p, sizeof p) == 0);
    double H_there;
    OK(tvi_integrator_energy(a.integrator, 0, (const double[]){1, 1}, (const double[]){0, 0}, &H_there));
    ck_assert_double_le(fabs(H_there - (1 + 1.5 - 1.0 / 3)), 1e-15); /* by the value of the parameter */
    char loose[2 * sizeof known_2], *to = loose;                     /* with the lines of another machine */
    for (const char *at = text; *at; *to++ = *at++)
        if (*at == '\n') *to++ = '\r';
    *to = '\0';
    OK(tvi_state_from_text(a.integrator, loose, strlen(loose), &a.t, a.q, a.p));
    end_alone(&a);
    tvi_system_free(system);
}
END_TEST

/* Texts that version 0.2.0 wrote after 5 steps of size 1/8, with the states that it found after 40 further steps. */
static const struct {
    const char *text;
    double end[1 + 2 * N];
} earlier[] = {
    {"tvi state 1\n"
     "n 2\n"
     "parameters 0\n"
     "t 0x1.4p-1 0x0p+0\n"
     "q 0x1.9bd353e5c0a07p-1 0x1.31716fb1766d4p-59\n"
     "q 0x1.dd242ce0a3326p-2 -0x1.d11a85f83209ap-56\n"
     "p -0x1.40cf4258b6ff5p-1 0x1.08p-55\n"
     "p 0x1.436356ca06d9p-1 0x1.cc6p-57\n"
     "end f1353ab48802f353\n",
     {0x1.68p+2, -0x1.18affd332d357p-2, 0x1.ddfe1a5fd249ep-2, -0x1.13f0eeb689712p+0, -0x1.153d1070e2dd5p+0}},
    {"tvi state 1\n"
     "n 2\n"
     "parameters 1\n"
     "value 0x1.8p-1\n"
     "t 0x1.4p-1 0x0p+0\n"
     "q 0x1.a951ba930f76ap-3 0x1.84af38d383318p-59\n"
     "q 0x1.3535dab6d86dep-5 -0x1.0578127e920e1p-57\n"
     "p -0x1.19301422da956p-3 0x1.7p-57\n"
     "p 0x1.03db6df4f84bap-2 -0x1.83f4p-56\n"
     "end 71bf9bd16589ffa1\n",
     {0x1.68p+2, 0x1.fe2474bb3c3bep-3, -0x1.f4041533a9f73p-3, 0x1.f7c4002e36ae7p-4, 0x1.48e1d42090171p-4}},
    {"tvi state 1\n"
     "n 2\n"
     "parameters 1\n"
     "value 0x1.8p-1\n"
     "t 0x1.026b22abf21ccp-1 0x1.c8p-55\n"
     "q 0x1.c7db22008c204p-3 -0x1.f55p-59\n"
     "q 0x1.bc9cd150f7d98p-8 0x0p+0\n"
     "p -0x1.c4bb7db281c3dp-4 -0x1.ep-59\n"
     "p 0x1.0ad2efc4ab9fp-2 0x1.3p-65\n"
     "e -0x1.0aaaaaaaaaaabp-4 0x1.58p-58\n"
     "end 2dd9dee94635758f\n",
     {0x1.27ba37923ec41p+2, 0x1.047ccb5ff40e7p-4, -0x1.791133c3d1cd8p-3, 0x1.d38361124e95cp-3, -0x1.8a87fd79e3704p-3}}};
enum { EARLIER = sizeof earlier / sizeof *earlier, PLAIN = 0, RESCALED = 2 };

static jet kepler(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_dot(q, q, N), -0.5));
}

START_TEST(earlier_texts_are_read)
{
    const double *const end = earlier[_i].end;
    tvi_system *system;
    if (_i == PLAIN) OK(tvi_system_potential(&system, N, NULL, kepler, NULL));
    else system = system_of(&forms[_i == RESCALED ? 4 : 0]);
    alone a = {0}, again = {0};
    OK(tvi_integrator_create(&a.integrator, system, NULL));
    OK(tvi_integrator_create(&again.integrator, system, NULL));
    OK(tvi_state_from_text(a.integrator, earlier[_i].text, strlen(earlier[_i].text), &a.t, a.q, a.p));
    ck_assert_str_eq(tvi_last_error(), "");
    char *text = text_of_state(a.integrator, a.t, a.q, a.p); /* in the present format */
    ck_assert((strstr(text, "\ne -0x1.0aaaaaaaaaaabp-0004 +0x1.5800000000000p-0058\n") != NULL) == (_i == RESCALED));
    OK(tvi_state_from_text(again.integrator, text, strlen(text), &again.t, again.q, again.p));
    free(text);
    for (int k = 0; k < 2; k++) {
        alone *it = k ? &again : &a;
        OK(tvi_integrate(it->integrator, 0.125, 40, &it->t, it->q, it->p, NULL, NULL));
        ck_assert_double_eq_tol(it->t, end[0], 1e-14);
        for (int i = 0; i < N; i++) {
            ck_assert_double_eq_tol(it->q[i], end[1 + i], 1e-14);
            ck_assert_double_eq_tol(it->p[i], end[1 + N + i], 1e-14);
        }
        end_alone(it);
    }
    tvi_system_free(system);
}
END_TEST

/* A rescaled system reads the text of one that is not, and computes e; the other way it skips e. */
START_TEST(e_may_be_there_or_not)
{
    for (int k = 0; k < 2; k++) {
        tvi_system *from = system_of(&forms[k ? 4 : 0]), *to = system_of(&forms[k ? 0 : 4]);
        alone a = start_alone(from, NULL, 3), b = start_alone(to, NULL, 5);
        double before, after;
        OK(tvi_integrate(a.integrator, H, 5, &a.t, a.q, a.p, NULL, NULL));
        char *text = text_of_state(a.integrator, a.t, a.q, a.p);
        OK(tvi_state_from_text(b.integrator, text, strlen(text), &b.t, b.q, b.p));
        ck_assert(a.t == b.t && memcmp(a.q, b.q, sizeof a.q) == 0 && memcmp(a.p, b.p, sizeof a.p) == 0);
        OK(tvi_integrator_energy(b.integrator, b.t, b.q, b.p, &before));
        OK(tvi_integrate(b.integrator, H, 50, &b.t, b.q, b.p, NULL, NULL));
        OK(tvi_integrator_energy(b.integrator, b.t, b.q, b.p, &after));
        ck_assert_double_eq_tol(before, after, 1e-14);
        free(text);
        end_alone(&a), end_alone(&b);
        tvi_system_free(from);
        tvi_system_free(to);
    }
}
END_TEST

/* A known text with this in the place of the value, and the right last word. */
static char *with_value(const char *whole, const char *value)
{
    const char *at = strstr(whole, "value ") + 6;
    char *text = calloc(2 * sizeof known_2, 1);
    sprintf(text, "%.*s%s%s", (int)(at - whole), whole, value, strchr(at, '\n'));
    sign_text(text);
    return text;
}

static tvi_status read_value(alone *a, const char *whole, const char *value)
{
    char *text = with_value(whole, value);
    const tvi_status status = tvi_state_from_text(a->integrator, text, strlen(text), &a->t, a->q, a->p);
    free(text);
    return status;
}

START_TEST(numbers_are_finite_and_exact)
{
    static const char *const good[] = {"0x1.8p+0", "0x1.8000000000000p+0", "0x1.8p+000"};
    static const char *const bad[] = {
        "0x1p+1024", "0x1p-1023",  "0x0.8p+0", "0x1.p+0",  "0x1p+",   "inf",     "nan",       "1.5",
        "0X1.8p+0",  "0x1.8P+0",   "0x3p-1",   "0x1.8",    "+0x1p+0", "0x1.8p0", "0x1.8p+0x", "0x1.80000000000000p+0",
        "0x1.Ap+0",  "0x1p+00000", "0x1,8p+0", "--0x1p+0", ""};
    tvi_system *system = system_of(&forms[0]);
    alone a = start_alone(system, NULL, 3);
    for (size_t k = 0; k < sizeof good / sizeof *good + sizeof bad / sizeof *bad; k++) {
        const bool is_good = k < sizeof good / sizeof *good;
        const char *const value = is_good ? good[k] : bad[k - sizeof good / sizeof *good];
        const tvi_status status = read_value(&a, known, value);
        ck_assert_msg(status == (is_good ? TVI_OK : TVI_EINVAL), "%s: %s", value, tvi_status_string(status));
        if (strcmp(value, "+0x1p+0") == 0) continue;
        const tvi_status now = read_value(&a, known_2, value);
        ck_assert_msg(now == (is_good ? TVI_OK : TVI_EINVAL), "%s: %s", value, tvi_status_string(now));
    }
    ck_assert_int_eq(read_value(&a, known_2, "+0x1.8000000000000p-0003"), TVI_OK);
    ck_assert_int_eq(read_value(&a, known_2, "+-0x1p+0"), TVI_EINVAL);
    ck_assert_int_eq(read_value(&a, known_2, "-+0x1p+0"), TVI_EINVAL);
    end_alone(&a);
    tvi_system_free(system);
}
END_TEST

void add_text_format(Suite *suite)
{
    TCase *tests = tcase_create("format");
    tcase_add_loop_test(tests, formats_stay, 0, 2);
    tcase_add_loop_test(tests, earlier_texts_are_read, 0, EARLIER);
    tcase_add_test(tests, e_may_be_there_or_not);
    tcase_add_test(tests, numbers_are_finite_and_exact);
    suite_add_tcase(suite, tests);
}
