/* test_compiled.c - Tests that steps on constraints run the generated sweeps of their tapes, those of the forces and of
 * the constraints, and give what the interpreter gives, to roundoff. */
#include "constraints.h"
#include "integrator/integrator.h"

#include <float.h>
#include <math.h>

/* Not optimized: the text is tested, not what a compiler makes of it. */
static const tvi_compiler quick = {"cc", "-O0 -D__always_inline__=unused", ""};

static bool is_generated(const jet_tape *tape) { return tape->sweeps != tape->interpreter_sweeps; }

/* Runs 20 steps of 0.05, with the tapes of the interpreter or with generated sweeps. *passes is their mean number. */
static state run(const problem *of, const tvi_system *system, tvi_options options, bool compiles, double *passes)
{
    state x = start_of(of, system);
    tvi_integrator *it;
    tvi_compiled *code = NULL;
    if (compiles) ck_assert_msg(tvi_compile(&code, system, &options, &quick) == TVI_OK, "%s", tvi_last_error());
    options.compiled = code;
    ck_assert_int_eq(tvi_integrator_create(&it, system, &options), TVI_OK);
    tvi_compiled_free(code);
    const tvi_constraints *constraints = it->stepped->constraints;
    ck_assert_int_eq(is_generated(it->stepped->field_values), compiles);
    ck_assert_int_eq(is_generated(constraints->values), compiles);
    ck_assert_int_eq(is_generated(constraints->curvature), compiles && options.method != TVI_STORMER_VERLET);
    ck_assert_int_eq(tvi_integrate(it, 0.05, 20, &x.t, x.q, x.p, NULL, NULL), TVI_OK);
    *passes = (double)tvi_integrator_stats(it)->passes / 20;
    tvi_integrator_free(it);
    return x;
}

static void runs_agree(const problem *of, const char *method, int order)
{
    tvi_system *system = system_of(of);
    tvi_options options;
    double passes[2];
    ck_assert_int_eq(tvi_options_named(method, order, &options), TVI_OK);
    const state interpreted = run(of, system, options, false, &passes[0]),
                compiled = run(of, system, options, true, &passes[1]);
    /* Roundoff of 20 steps, each of at most twenty units; a pass more or less in some steps. */
    ck_assert_msg(distance(of, &interpreted, &compiled) <= 400 * DBL_EPSILON, "%s: %.2g", of->name,
                  distance(of, &interpreted, &compiled));
    ck_assert_double_le(fabs(passes[0] - passes[1]), 1);
    tvi_system_free(system);
}

START_TEST(galerkin_agrees) { runs_agree(&problems[_i], "galerkin", _i % 2 ? 6 : 16); }
END_TEST

START_TEST(rattle_agrees) { runs_agree(&problems[_i], "stormer-verlet", 2); }
END_TEST

Suite *suite_compiled(void)
{
    Suite *suite = suite_create("compiled");
    TCase *tcase = tcase_create("as interpreted");
    tcase_set_timeout(tcase, 120);
    tcase_add_loop_test(tcase, galerkin_agrees, 0, problem_count);
    tcase_add_loop_test(tcase, rattle_agrees, 0, OF_A_FORCE + 1);
    suite_add_tcase(suite, tcase);
    return suite;
}
