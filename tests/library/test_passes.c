/* test_passes.c - the rule that ends the passes of every iteration, number by number: what it says of corrections of
 * made-up sizes. */
#include "method/asked.h"
#include "suites.h"

#include <string.h>

enum { MOST = 8 };

typedef struct {
    const char *name;
    tvi_passes_rule rule;
    double known;    /* the part that passes leave, of an earlier iteration */
    double measured; /* the roundoff */
    double curvature, typical;
    bool checks;
    double sizes[MOST];
    const char *verdicts; /* of as many passes: '.' go on, 'E' may end, 'S' stuck */
} passes_case;

/* Those that do not contract by a half are stuck; those that expect the next correction; and those that are stuck where
 * two in turn do not shrink. */
#define HALVES       .goal = 1e-16, .stuck = 0.5
#define EXPECTS      HALVES, .contraction = 0.5, .far = INFINITY
#define TURNS(STUCK) .goal = 1e-24, .contraction = 0.5, .far = INFINITY, .memory = 1, .stuck = STUCK, .turns = 2
#define SLOW                                                                                                           \
    {                                                                                                                  \
        1e-2, 1e-4, 1e-5, 1e-6, 5e-12, 1e-17                                                                           \
    } /* by 100, then by 10 */

static const passes_case cases[] = {
    {.name = "the goal", .rule = {HALVES}, .sizes = {1e-3, 1e-8, 2e-16, 1e-16}, .verdicts = "...E"},
    {.name = "the first one", .rule = {EXPECTS, .memory = 1}, .sizes = {1e-16}, .verdicts = "E"},
    {.name = "the next one", .rule = {EXPECTS, .memory = 1}, .sizes = {1e-2, 1e-4, 1e-11}, .verdicts = "..E"},
    {.name = "two parts", .rule = {EXPECTS, .memory = 2}, .sizes = {1e-2, 1e-4, 1e-11, 1e-15}, .verdicts = "...E"},
    {.name = "no part", .rule = {HALVES, .far = INFINITY}, .sizes = {1e-2, 1e-4, 1e-11, 1e-17}, .verdicts = "...E"},
    {.name = "not squared", .rule = {EXPECTS, .memory = 1}, .sizes = {1e-2, 1e-4, 9e-9}, .verdicts = "..."},
    {.name = "squared",
     .rule = {EXPECTS, .memory = 1, .is_quadratic = true},
     .sizes = {1e-2, 1e-4, 9e-9},
     .verdicts = "..E"},
    {.name = "above 1", .rule = {EXPECTS, .memory = 1}, .sizes = {1e6, 1e-6, 1e-13}, .verdicts = "..E"},
    {.name = "from far",
     .rule = {HALVES, .contraction = 0.5, .far = 1e-9, .memory = 1},
     .sizes = {1e-1, 2e-9, 1e-14},
     .verdicts = "..E"},
    {.name = "from near",
     .rule = {HALVES, .contraction = 0.5, .far = 1e-8, .memory = 1},
     .sizes = {1e-1, 2e-9},
     .verdicts = ".E"},
    {.name = "no noise", .rule = {TURNS(TVI_PASSES_ALL)}, .sizes = {1e-6, 1e-10, 1e-15, 1e-20}, .verdicts = "...E"},
    {.name = "noise",
     .rule = {TURNS(TVI_PASSES_ALL), .noise = 1e-14, .first_noise = 1e-14},
     .sizes = {1e-6, 1e-10, 1.3e-15, 1.2e-15, 1.1e-15},
     .verdicts = "....E"},
    {.name = "noise, stuck",
     .rule = {TURNS(TVI_PASSES_ALL), .noise = 1e-14, .first_noise = 1e-14, .roundoff = 1e-12},
     .sizes = {1e-6, 1e-9, 1.1e-15, 1.2e-15, 1.3e-15, 1.4e-15},
     .verdicts = ".....E"},
    {.name = "first noise", .rule = {EXPECTS, .memory = 1, .noise = 1e-13}, .sizes = {1e-8, 1e-14}, .verdicts = ".E"},
    {.name = "no first noise",
     .rule = {EXPECTS, .memory = 1, .noise = 1e-13, .first_noise = 1e-13},
     .sizes = {1e-8, 1e-14},
     .verdicts = ".."},
    {.name = "known before",
     .rule = {EXPECTS, .memory = 1, .noise = 1e-13, .first_noise = 1e-13},
     .known = 1e-3,
     .sizes = {1e-8, 1e-14},
     .verdicts = ".E"},
    {.name = "known, but slow",
     .rule = {EXPECTS, .memory = 1, .noise = 1e-13, .first_noise = 1e-13},
     .known = 0.5,
     .sizes = {1e-8, 1.5e-16},
     .verdicts = ".."},
    {.name = "stuck", .rule = {HALVES}, .sizes = {1e-3, 5e-4, 2.6e-4}, .verdicts = "..S"},
    {.name = "patience", .rule = {HALVES, .patience = 3}, .sizes = {1, 1, 1, 1}, .verdicts = "...S"},
    {.name = "all is left", .rule = {.stuck = TVI_PASSES_ALL}, .sizes = {1, 0.999, 0.999}, .verdicts = "..S"},
    {.name = "not in turns", .rule = {HALVES}, .sizes = {1e-3, 1e-5, 9e-6}, .verdicts = "..S"},
    {.name = "in turns", .rule = {TURNS(0.5)}, .sizes = {1e-3, 1e-5, 9e-6, 2.6e-6, 2.3e-6}, .verdicts = "....S"},
    {.name = "the second", .rule = {TURNS(0.5)}, .sizes = {1e-3, 9e-4}, .verdicts = ".S"},
    {.name = "roundoff", .rule = {HALVES, .roundoff = 1e-12}, .sizes = {1e-3, 1e-12, 1e-12}, .verdicts = "..E"},
    {.name = "no roundoff", .rule = {HALVES, .roundoff = 1e-12}, .sizes = {1e-3, 2e-12, 2e-12}, .verdicts = "..S"},
    {.name = "measured", .rule = {HALVES}, .measured = 1e-6, .sizes = {1e-3, 1e-6}, .verdicts = ".E"},
    {.name = "a cycle",
     .rule = {TURNS(TVI_PASSES_ALL), .noise = 1e-14, .roundoff = 1e-12},
     .known = 0.4,
     .sizes = {2e-15, 2e-15, 2e-15},
     .verdicts = "..E"},
    {.name = "nearly a cycle",
     .rule = {TURNS(TVI_PASSES_ALL), .noise = 1e-14, .roundoff = 1e-12},
     .known = 0.4,
     .sizes = {2e-15, 2e-15, 2.1e-15},
     .verdicts = "..."},
    {.name = "a check",
     .rule = {EXPECTS, .memory = 1, .confirmed = 1e-15},
     .checks = true,
     .sizes = {1e-3, 1e-10, 1e-15},
     .verdicts = "..E"},
    {.name = "a check that confirms nothing",
     .rule = {EXPECTS, .memory = 1, .confirmed = 1e-15},
     .checks = true,
     .sizes = {1e-3, 1e-10, 2e-15, 1e-17},
     .verdicts = "...E"},
    {.name = "no check", .rule = {EXPECTS, .memory = 1}, .sizes = {1e-3, 1e-10}, .verdicts = ".E"},
    {.name = "one pass", .rule = {EXPECTS, .memory = 1}, .curvature = 10, .sizes = {3e-9}, .verdicts = "E"},
    {.name = "not one pass", .rule = {EXPECTS, .memory = 1}, .curvature = 10, .sizes = {4e-9, 1e-15}, .verdicts = ".E"},
    {.name = "smaller by chance",
     .rule = {EXPECTS, .memory = 1},
     .curvature = 10,
     .typical = 1e-6,
     .sizes = {3e-9, 1e-17},
     .verdicts = ".E"},
    {.name = "far from one pass",
     .rule = {HALVES, .far = INFINITY},
     .curvature = 1e6,
     .sizes = {1, 1e-16},
     .verdicts = ".E"},
    {.name = "one pass, but a tolerance", .rule = {HALVES}, .curvature = 10, .sizes = {3e-9, 1e-17}, .verdicts = ".E"},
    {.name = "one pass, checked",
     .rule = {EXPECTS, .memory = 1, .confirmed = 1e-15},
     .curvature = 10,
     .checks = true,
     .sizes = {3e-9, 1e-15},
     .verdicts = ".E"},
    {.name = "exactly", .rule = {EXPECTS, .memory = 1, .exactly = 3}, .sizes = {0, 1, 1}, .verdicts = "..E"},
    {.name = "slack", .rule = {EXPECTS, .memory = 1, .most_slack = 1e6}, .sizes = SLOW, .verdicts = ".....E"},
    {.name = "no slack", .rule = {EXPECTS, .memory = 1}, .sizes = SLOW, .verdicts = "....E"},
    {.name = "most slack", .rule = {EXPECTS, .memory = 1, .most_slack = 1}, .sizes = SLOW, .verdicts = "....E"},
    {.name = "no slack of the stuck",
     .rule = {EXPECTS, .memory = 1, .most_slack = 1e6},
     .sizes = {1e-2, 1e-4, 9e-5, 1e-7, 1e-12},
     .verdicts = "..S.E"},
    {.name = "slack not believed",
     .rule = {EXPECTS, .memory = 1, .most_slack = 1e6},
     .sizes = {1e-2, 1e-4, 1e-5, 9e-6, 1e-8, 7e-13},
     .verdicts = "...S.E"},
    {.name = "slack of roundoff",
     .rule = {EXPECTS, .memory = 1, .most_slack = 1e6, .slack_above = 1e-4},
     .sizes = SLOW,
     .verdicts = "....E"},
};
enum { CASES = sizeof cases / sizeof *cases };

START_TEST(each_number)
{
    static const char letters[] = {[TVI_PASSES_GO_ON] = '.', [TVI_PASSES_MAY_END] = 'E', [TVI_PASSES_STUCK] = 'S'};
    const passes_case *c = &cases[_i];
    tvi_passes passes;
    char verdicts[MOST + 1] = "";
    memset(&passes, 0xff, sizeof passes);
    tvi_passes_begin(&passes);
    passes.slowest = c->known;
    passes.roundoff = c->measured;
    passes.checks = c->checks;
    passes.curvature = c->curvature;
    passes.typical = c->typical;
    for (size_t i = 0; i < strlen(c->verdicts); i++)
        verdicts[i] = letters[tvi_passes_judge(&passes, &c->rule, c->sizes[i])];
    ck_assert_msg(strcmp(verdicts, c->verdicts) == 0, "%s: %s, not %s", c->name, verdicts, c->verdicts);
}
END_TEST

/* A tolerance is a goal for the correction itself, and passes are as many as are asked for. */
START_TEST(the_options)
{
    const tvi_passes_rule rule = {.most = 10, .goal = 1, .far = 2};
    const tvi_passes_rule plain = tvi_passes_rule_asked(&rule, &(tvi_options){0}, 0),
                          less = tvi_passes_rule_asked(&rule, &(tvi_options){.max_passes = 20}, 0.5),
                          exact = tvi_passes_rule_asked(&rule, &(tvi_options){.max_passes = 20, .passes = 3}, 0);
    ck_assert(plain.most == 10 && plain.exactly == 0 && plain.goal == 1 && plain.far == 2);
    ck_assert(less.most == 20 && less.exactly == 0 && less.goal == 0.5 && less.far == 0);
    ck_assert(exact.most == 3 && exact.exactly == 3);
}
END_TEST

/* Those that were stuck are roundoff where it is measured to be as large, and from then on. */
START_TEST(measured_later)
{
    const tvi_passes_rule rule = {HALVES};
    tvi_passes passes = TVI_NO_PASSES;
    ck_assert(tvi_passes_judge(&passes, &rule, 1e-9) == TVI_PASSES_GO_ON);
    ck_assert(tvi_passes_judge(&passes, &rule, 1e-9) == TVI_PASSES_STUCK);
    ck_assert(!tvi_passes_are_roundoff(&passes, 1e-10));
    ck_assert(tvi_passes_judge(&passes, &rule, 1e-10) == TVI_PASSES_MAY_END);
    ck_assert(tvi_passes_are_roundoff(&passes, 1e-10));
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
