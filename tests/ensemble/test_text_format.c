/* test_text_format.c - the format of states as text: one that every version reads, and which words are numbers. */
#include "ensemble.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
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

START_TEST(the_format_stays)
{
    tvi_system *system = system_of(&forms[0]);
    alone a = start_alone(system, NULL, 3);
    char again[sizeof known] = "";
    size_t size = sizeof again;
    OK(tvi_state_from_text(a.integrator, known, sizeof known - 1, &a.t, a.q, a.p));
    OK(tvi_state_to_text(a.integrator, a.t, a.q, a.p, again, &size));
    ck_assert_str_eq(again, known);
    ck_assert(a.t == acos(-1) && a.q[0] == 0 && signbit(a.q[0]) && a.q[1] == 0.1);
    ck_assert(a.p[0] == DBL_TRUE_MIN && a.p[1] == -DBL_MAX);
    double H_there;
    OK(tvi_integrator_energy(a.integrator, 0, (const double[]){1, 1}, (const double[]){0, 0}, &H_there));
    ck_assert_double_le(fabs(H_there - (1 + 1.5 - 1.0 / 3)), 1e-15); /* by the value of the parameter */
    char loose[2 * sizeof known], *to = loose;                       /* with the lines of another machine */
    for (const char *at = known; *at; *to++ = *at++)
        if (*at == '\n') *to++ = '\r';
    *to = '\0';
    OK(tvi_state_from_text(a.integrator, loose, strlen(loose), &a.t, a.q, a.p));
    end_alone(&a);
    tvi_system_free(system);
}
END_TEST

/* The known text with this in the place of the value, and the right last word. */
static char *with_value(const char *value)
{
    const char *at = strstr(known, "0x1.8p+0"), *behind = at + 8;
    const int first = (int)(at - known), rest = (int)(strstr(behind, "end ") + 4 - behind);
    char *text = calloc(2 * sizeof known, 1);
    const int size = sprintf(text, "%.*s%s%.*s", first, known, value, rest, behind);
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (const char *c = text; *c; c++)
        hash = (hash ^ (unsigned char)(*c == '\n' ? ' ' : *c)) * UINT64_C(0x100000001b3);
    sprintf(text + size, "%016llx\n", (unsigned long long)hash);
    return text;
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
        char *text = with_value(value);
        const tvi_status status = tvi_state_from_text(a.integrator, text, strlen(text), &a.t, a.q, a.p);
        ck_assert_msg(status == (is_good ? TVI_OK : TVI_EINVAL), "%s: %s", value, tvi_status_string(status));
        free(text);
    }
    end_alone(&a);
    tvi_system_free(system);
}
END_TEST

void add_text_format(Suite *suite)
{
    TCase *tests = tcase_create("format");
    tcase_add_test(tests, the_format_stays);
    tcase_add_test(tests, numbers_are_finite_and_exact);
    suite_add_tcase(suite, tests);
}
