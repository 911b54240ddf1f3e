/* test_passes.c - Tests the rule that ends the passes of every iteration, number by number: what it says of corrections
 * of made-up sizes. */
#include "method/stepper.h"
#include "suites.h"

#include <string.h>

enum { MOST = 8 };

typedef struct {
    const char *name;
    tvi_stopping_rule rule;
    double known;    /* the part that passes leave, of an earlier iteration */
    double measured; /* the roundoff */
    double sizes[MOST];
    const char *verdicts; /* of as many passes: '.' go on, 'E' may end, 'S' stuck */
} passes_case;

/* Rules by which passes that do not contract by a half are stuck; by which the next correction is predicted; by which
 * passes are stuck if two alternating corrections do not shrink; and by which small corrections show nothing. */
#define HALVES       .correction_goal = 1e-16, .stall_ratio = 0.5, .stall_comparison_lag = 1
#define EXPECTS      HALVES, .max_trusted_ratio = 0.5
#define TURNS(STUCK) .correction_goal = 1e-24, .max_trusted_ratio = 0.5, .stall_ratio = STUCK, .stall_comparison_lag = 2
#define NOISE        TURNS(TVI_STALL_WITHOUT_DECREASE), .roundoff_level = 1e-14

static const passes_case cases[] = {
    {.name = "nothing moves", .rule = {EXPECTS}, .sizes = {1e-3, 0}, .verdicts = ".E"},
    {.name = "the goal", .rule = {HALVES}, .sizes = {1e-3, 1e-8, 2e-16, 1e-16}, .verdicts = "...E"},
    {.name = "the first one", .rule = {EXPECTS}, .sizes = {1e-16}, .verdicts = "E"},
    {.name = "the next one", .rule = {EXPECTS}, .sizes = {1e-2, 1e-10}, .verdicts = ".E"},
    {.name = "two parts", .rule = {EXPECTS}, .sizes = {1e-2, 1e-4, 1e-11, 1e-15}, .verdicts = "...E"},
    {.name = "the slower one is the last", .rule = {EXPECTS}, .sizes = {1e-2, 1e-9, 1e-12, 1e-14}, .verdicts = "...E"},
    {.name = "no part", .rule = {HALVES}, .sizes = {1e-2, 1e-4, 1e-11, 1e-17}, .verdicts = "...E"},
    {.name = "not squared", .rule = {EXPECTS}, .sizes = {1e-2, 1e-4, 9e-9}, .verdicts = "..."},
    {.name = "squared",
     .rule = {EXPECTS, .is_convergence_quadratic = true},
     .sizes = {1e-2, 1e-4, 9e-9},
     .verdicts = "..E"},
    {.name = "above 1", .rule = {EXPECTS}, .sizes = {1e6, 1e-9, 1e-13}, .verdicts = ".E"},
    {.name = "no noise",
     .rule = {TURNS(TVI_STALL_WITHOUT_DECREASE)},
     .sizes = {1e-6, 1e-10, 1e-15, 1e-20},
     .verdicts = "...E"},
    {.name = "noise", .rule = {NOISE}, .sizes = {1e-6, 1e-10, 1.3e-15, 1.2e-15, 1.1e-15}, .verdicts = "....E"},
    {.name = "noise grows",
     .rule = {NOISE},
     .sizes = {1e-6, 1e-9, 1.1e-15, 1.2e-15, 1.3e-15, 1.4e-15},
     .verdicts = ".....E"},
    {.name = "the slower one above noise",
     .rule = {NOISE},
     .sizes = {1e-4, 1e-9, 1e-12, 2e-15, 2.1e-15, 2.2e-15, 2.3e-15},
     .verdicts = "......E"},
    {.name = "nothing known", .rule = {EXPECTS, .roundoff_level = 1e-13}, .sizes = {2e-14, 1e-14}, .verdicts = ".."},
    {.name = "known before",
     .rule = {EXPECTS, .roundoff_level = 1e-13},
     .known = 1e-3,
     .sizes = {3e-14},
     .verdicts = "E"},
    {.name = "known, but slow",
     .rule = {EXPECTS, .roundoff_level = 1e-13},
     .known = 0.5,
     .sizes = {3e-14, 1.3e-16},
     .verdicts = ".."},
    {.name = "of a first one nothing is known",
     .rule = {EXPECTS, .roundoff_level = 1e-13},
     .known = 1e-8,
     .sizes = {2e-9, 1e-15},
     .verdicts = ".E"},
    {.name = "known by this one",
     .rule = {NOISE},
     .known = 1e-8,
     .sizes = {1e-6, 1e-9, 1e-12, 1e-15, 1e-15, 1e-15},
     .verdicts = ".....E"},
    {.name = "stuck", .rule = {HALVES}, .sizes = {1e-3, 5e-4, 2.6e-4}, .verdicts = "..S"},
    {.name = "all is left",
     .rule = {.stall_ratio = TVI_STALL_WITHOUT_DECREASE, .stall_comparison_lag = 1},
     .sizes = {1, 0.999, 0.999},
     .verdicts = "..S"},
    {.name = "not in turns", .rule = {HALVES}, .sizes = {1e-3, 1e-5, 9e-6}, .verdicts = "..S"},
    {.name = "in turns", .rule = {TURNS(0.5)}, .sizes = {1e-3, 1e-5, 9e-6, 2.6e-6, 2.3e-6}, .verdicts = "....S"},
    {.name = "the second", .rule = {TURNS(0.5)}, .sizes = {1e-3, 9e-4, 8e-4}, .verdicts = "..S"},
    {.name = "noise that does not contract", .rule = {NOISE}, .sizes = {1e-15, 2e-15, 3e-15}, .verdicts = "..S"},
    {.name = "measured", .rule = {HALVES}, .measured = 1e-6, .sizes = {1e-3, 1e-6}, .verdicts = ".E"},
    {.name = "a cycle", .rule = {NOISE}, .known = 0.4, .sizes = {2e-15, 2e-15, 2e-15}, .verdicts = "..E"},
    {.name = "nearly a cycle", .rule = {NOISE}, .known = 0.4, .sizes = {2e-15, 2e-15, 2.1e-15}, .verdicts = "..."},
    {.name = "a large cycle", .rule = {NOISE}, .sizes = {2e-14, 2e-14, 2e-14}, .verdicts = "..S"},
    {.name = "exactly", .rule = {EXPECTS, .exact_passes = 3}, .sizes = {0, 1, 1}, .verdicts = "..E"},
};
enum { CASES = sizeof cases / sizeof *cases };

START_TEST(each_number)
{
    static const char letters[] = {[TVI_PASSES_GO_ON] = '.', [TVI_PASSES_MAY_END] = 'E', [TVI_PASSES_STUCK] = 'S'};
    const passes_case *c = &cases[_i];
    tvi_convergence_test passes;
    char verdicts[MOST + 1] = "";
    memset(&passes, 0xff, sizeof passes);
    tvi_convergence_begin(&passes, c->known);
    passes.roundoff = c->measured;
    for (size_t i = 0; i < strlen(c->verdicts); i++)
        verdicts[i] = letters[tvi_convergence_add_pass(&passes, &c->rule, c->sizes[i])];
    ck_assert_msg(strcmp(verdicts, c->verdicts) == 0, "%s: %s, not %s", c->name, verdicts, c->verdicts);
}
END_TEST

/* A tolerance is a goal for the correction itself, and passes are as many as are asked for. */
START_TEST(the_options)
{
    const tvi_stopping_rule rule = {.max_passes = 10, .correction_goal = 1, .max_trusted_ratio = 2};
    const tvi_stopping_rule plain = tvi_passes_rule_with_options(&rule, &(tvi_options){0}, 0),
                            less = tvi_passes_rule_with_options(&rule, &(tvi_options){.max_passes = 20}, 0.5),
                            exact =
                                tvi_passes_rule_with_options(&rule, &(tvi_options){.max_passes = 20, .passes = 3}, 0);
    ck_assert(plain.max_passes == 10 && plain.exact_passes == 0 && plain.correction_goal == 1 &&
              plain.max_trusted_ratio == 2);
    ck_assert(less.max_passes == 20 && less.exact_passes == 0 && less.correction_goal == 0.5 &&
              less.max_trusted_ratio == 0);
    ck_assert(exact.max_passes == 3 && exact.exact_passes == 3);
}
END_TEST

/* Corrections that were stuck are roundoff if it is measured to be as large, and from then on. */
START_TEST(measured_later)
{
    const tvi_stopping_rule rule = {HALVES};
    tvi_convergence_test passes;
    tvi_convergence_begin(&passes, 0);
    ck_assert(tvi_convergence_add_pass(&passes, &rule, 1e-9) == TVI_PASSES_GO_ON);
    ck_assert(tvi_convergence_add_pass(&passes, &rule, 1e-9) == TVI_PASSES_STUCK);
    ck_assert(!tvi_convergence_set_roundoff(&passes, 1e-10));
    ck_assert(tvi_convergence_add_pass(&passes, &rule, 1e-10) == TVI_PASSES_MAY_END);
    ck_assert(tvi_convergence_set_roundoff(&passes, 1e-10));
}
END_TEST

Suite *suite_passes(void)
{
    Suite *suite = suite_create("passes");
    TCase *tcase = tcase_create("passes");
    tcase_add_loop_test(tcase, each_number, 0, CASES);
    tcase_add_test(tcase, the_options);
    tcase_add_test(tcase, measured_later);
    suite_add_tcase(suite, tcase);
    return suite;
}
