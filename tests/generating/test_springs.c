/* test_springs.c - the stiffest springs of a system, which the passes of the Galerkin curve solve exactly
 * (docs/method.md section 5). */
#include "galerkin/step.h"
#include "generating.h"
#include "models.h"
#include "run/integrator.h"

#include <complex.h>
#include <math.h>
#include <string.h>

enum { NODES = 8, CHAIN = 6, MOLECULE = 4 };

/* ---- Systems ----------------------------------------------------------------------------------------------------- */

static const double chain_mass[CHAIN] = {1, 2, 1.5, 1, 0.5, 3}, molecule_mass[MOLECULE] = {1, 1, 2, 2};
static const double oscillator_mass[] = {2, 2};

/* Pairs of masses on springs of frequency w, between quartic ones. */
static jet chain(const jet q[], jet t, void *ctx)
{
    const double w = *(const double *)ctx;
    jet sum = jet_pow(q[0], 4);
    (void)t;
    for (int i = 0; i < CHAIN; i += 2) {
        const double *m = chain_mass + i, k = w * w * m[0] * m[1] / (m[0] + m[1]);
        sum = jet_add(sum, jet_mul(k / 2, jet_sqr(jet_sub(q[i + 1], q[i]))));
        sum = jet_add(sum, jet_pow(i + 2 < CHAIN ? jet_sub(q[i + 2], q[i + 1]) : q[i + 1], 4));
    }
    return sum;
}

/* Two bodies in the plane on a spring of length 1 and frequency w. */
static jet molecule(const jet q[], jet t, void *ctx)
{
    const double w = *(const double *)ctx, k = w * w * 2 / 3;
    const jet x = jet_sub(q[2], q[0]), y = jet_sub(q[3], q[1]);
    (void)t;
    return jet_mul(k / 2, jet_sqr(jet_sub(jet_sqrt(jet_add(jet_sqr(x), jet_sqr(y))), 1)));
}

/* Of frequencies w and w / 10. */
static jet oscillators(const jet q[], jet t, void *ctx)
{
    const double w = *(const double *)ctx, m = oscillator_mass[0];
    (void)t;
    return jet_mul(m * w * w / 2, jet_add(jet_sqr(q[0]), jet_mul(0.01, jet_sqr(q[1]))));
}

typedef struct {
    tvi_system *system;
    tvi_integrator *it;
    galerkin *work;
    test_state x;
} run_of_springs;

/* How the springs are used. All steps are predicted by polynomials, so that what passes save is due to springs. */
typedef enum { NEVER, IF_PASSES_FAIL, IF_THEY_SAVE } springs_use;

static run_of_springs begin(int n, const double mass[], tvi_potential_fn *V, double w, int nodes, springs_use use)
{
    run_of_springs r = {.x = {.t = 0}};
    const tvi_options options = kind_options(&kinds[kind_count], nodes);
    ck_assert_int_eq(tvi_system_potential(&r.system, n, mass, V, &w), TVI_OK);
    r.it = integrator_of(r.system, &options);
    r.work = r.it->work;
    if (use == NEVER) r.work->springs.last = NULL;
    r.work->springs.is_wanted = use == IF_THEY_SAVE;
    return r;
}

static void end(run_of_springs *r)
{
    tvi_integrator_free(r->it);
    tvi_system_free(r->system);
}

static void start_chain(run_of_springs *r, double more)
{
    r->x.q[0] = 0.69 + more;
    r->x.q[1] = 0.73;
    r->x.p[1] = 1.4;
    r->x.p[4] = 0.3 - more;
}

static run_of_springs begin_chain(springs_use use)
{
    run_of_springs r = begin(CHAIN, chain_mass, chain, 50, NODES, use);
    start_chain(&r, 0);
    return r;
}

/* It turns so fast. */
static run_of_springs begin_molecule(double turns, springs_use use)
{
    run_of_springs r = begin(MOLECULE, molecule_mass, molecule, 50, NODES, use);
    r.x.q[0] = -0.7;
    r.x.q[2] = 0.34;
    r.x.p[1] = -turns;
    r.x.p[3] = turns;
    return r;
}

static double passes_of(const run_of_springs *r)
{
    const tvi_stats *stats = tvi_integrator_stats(r->it);
    return (double)stats->passes / (double)stats->steps;
}

/* ---- Passes ------------------------------------------------------------------------------------------------------ */

/* In steps of 4 / w springs take little more than half of the passes, for the same motion. */
START_TEST(springs_that_stay_save_passes)
{
    run_of_springs with = begin_chain(IF_THEY_SAVE), without = begin_chain(NEVER);
    go(with.it, 0.08, 200, &with.x);
    go(without.it, 0.08, 200, &without.x);
    const double few = passes_of(&with), many = passes_of(&without), apart = distance(CHAIN, &with.x, &without.x);
    ck_assert_int_eq(with.work->springs.last->count, CHAIN / 2);
    ck_assert_msg(many > 1.3 * few, "%.2f passes, without springs %.2f", few, many);
    ck_assert_msg(apart > 0 && apart < 1e-11, "%.1e apart", apart);
    const long before = tvi_integrator_stats(with.it)->passes;
    go(with.it, 0.1, 20, &with.x); /* the same modes */
    const double others = (double)(tvi_integrator_stats(with.it)->passes - before) / 20;
    ck_assert_msg(others < 22, "%.2f passes of larger steps", others);
    end(&with);
    end(&without);
}
END_TEST

/* The mean of H over some steps. The method's own error, which comes back with the motion of the springs, cancels in
 * the difference of two of them. */
static double mean_energy(run_of_springs *r)
{
    enum { WINDOW = 64 };
    double sum = 0;
    for (int i = 0; i < WINDOW; i++) {
        go(r->it, 0.078125, 1, &r->x);
        sum += state_energy(r->system, &r->x) / WINDOW;
    }
    return sum;
}

static sample errors_of(bool always)
{
    enum { RUNS = 2 * ORBITS, STEPS = 1000 };
    sample errors = {0};
    for (int k = 0; k < RUNS; k++) {
        run_of_springs r = begin(CHAIN, chain_mass, chain, 50, 10, IF_THEY_SAVE);
        start_chain(&r, 0);
        for (int i = 0; i < CHAIN; i++) r.x.q[i] += start_shift(k), r.x.p[i] += start_shift(k);
        go(r.it, 0.078125, 10, &r.x);
        ck_assert_int_eq(r.work->springs.last->count, CHAIN / 2);
        r.work->springs.of_passes.always |= always;
        const double start = mean_energy(&r);
        go(r.it, 0.078125, STEPS, &r.x);
        sample_add(&errors, mean_energy(&r) - start);
        end(&r);
    }
    return errors;
}

/* The control has springs that add to the last passes of a step, too. Its energy walks farther and drifts. RMS is that
 * of 1024 runs with base and AVX-512, gcc and clang, the largest and a twentieth more. The control has 1.68e-13 or
 * more, and 1.53 RMS is enough to fail with a probability of 0.999. */
START_TEST(energy_does_not_drift)
{
    static const double RMS = 1.08e-13;
    const sample errors = errors_of(false), biased = errors_of(true);
    const double most = rms_factor(errors.count) * RMS;
    ck_assert_double_lt(sample_drift(&errors), NO_DRIFT);
    ck_assert_double_lt(sample_rms(&errors), most);
    ck_assert_double_gt(sample_rms(&biased), most);
}
END_TEST

/* The modes of a molecule that turns are soon others. If they last for long they are sought anew and save passes: the
 * bound has two thirds of the part that they save. If they do not last, passes are not many more than without. */
START_TEST(springs_that_turn)
{
    static const struct {
        double turns, most; /* of the passes without */
    } rows[] = {{1, 1.5}, {0.1, 1.5}, {0.001, 0.8}};
    enum { STEPS = 3000 };
    run_of_springs with = begin_molecule(rows[_i].turns, IF_THEY_SAVE), without = begin_molecule(rows[_i].turns, NEVER);
    go(with.it, 0.08, STEPS, &with.x);
    go(without.it, 0.08, STEPS, &without.x);
    const double part = passes_of(&with) / passes_of(&without);
    ck_assert_msg(part < rows[_i].most, "turns %g: %.2f of the passes", rows[_i].turns, part);
    end(&with);
    end(&without);
}
END_TEST

/* Forces that change along a step have none. */
START_TEST(others_have_no_springs)
{
    static const struct {
        const model *of;
        double h;
    } rows[] = {{&model_kepler, 1.1}, {&model_henon_heiles, 2}, {&model_pendulum, 1}};
    const tvi_options options = kind_options(&kinds[kind_count], NODES);
    tvi_system *system = model_system(rows[_i].of);
    tvi_integrator *it = integrator_of(system, &options);
    const galerkin *work = it->work;
    test_state x = model_start(rows[_i].of);
    for (int k = 0; k < 50; k++) {
        go(it, rows[_i].h, 1, &x);
        ck_assert_int_eq(work->springs.last->count, 0);
    }
    ck_assert_int_ge(tvi_integrator_stats(it)->passes, 100); /* enough for several looks */
    tvi_integrator_free(it);
    tvi_system_free(system);
}
END_TEST

/* ---- Steps too large for a fixed point --------------------------------------------------------------------------- */

/* The diagonal Pade approximation of e^z of degree NODES, which Gauss collocation is. */
static double complex pade(double complex z)
{
    double complex above = 0, below = 0, power = 1;
    double factor = 1;
    for (int k = 0; k <= NODES; k++) {
        above += factor * power;
        below += (k % 2 ? -factor : factor) * power;
        factor *= (double)(NODES - k) / ((2 * NODES - k) * (k + 1));
        power *= z;
    }
    return above / below;
}

/* Oscillators in steps of 20 / w, for which passes without springs diverge, are turned as the method has it; in steps
 * of 150 / w the slow one has to be solved, too. */
START_TEST(large_steps_of_oscillators)
{
    static const struct {
        double hw;
        int modes;
    } rows[] = {{20, 1}, {150, 2}};
    enum { STEPS = 50 };
    const double w[] = {50, 5}, h = rows[_i].hw / w[0], m = oscillator_mass[0];
    for (springs_use use = NEVER; use <= IF_THEY_SAVE; use++) {
        run_of_springs r = begin(2, oscillator_mass, oscillators, w[0], NODES, use);
        for (int i = 0; i < 2; i++) r.x.q[i] = 0.6, r.x.p[i] = 0.8 * m * w[i];
        if (use == NEVER) ck_assert_int_ne(tvi_step(r.it, h, &r.x.t, r.x.q, r.x.p), TVI_OK);
        else go(r.it, h, STEPS, &r.x);
        if (use != NEVER) ck_assert_int_eq(r.work->springs.last->count, rows[_i].modes);
        for (int i = 0; i < 2 && use != NEVER; i++) {
            double complex z = 0.6 - I * 0.8;
            for (int k = 0; k < STEPS; k++) z *= pade(I * w[i] * h);
            const double off = cabs(r.x.q[i] - I * r.x.p[i] / (m * w[i]) - z);
            ck_assert_msg(off < 1e-10, "h w = %g: %.1e off", rows[_i].hw, off);
        }
        end(&r);
    }
}
END_TEST

/* ---- States ------------------------------------------------------------------------------------------------------ */

/* Also where the integrator that goes on has never looked for them, and after a step that failed. */
START_TEST(states_have_the_springs)
{
    run_of_springs r = begin_chain(IF_THEY_SAVE), other = begin_chain(IF_THEY_SAVE);
    char buffer[1 << 15];
    size_t size = sizeof buffer;
    go(r.it, 0.08, 20, &r.x);
    ck_assert_int_eq(tvi_state_save(r.it, buffer, &size), TVI_OK);
    other.x = r.x;
    go(r.it, 0.08, 30, &r.x);
    for (int fails = 0; fails < 2; fails++) {
        test_state y = other.x;
        ck_assert_int_eq(tvi_state_load(other.it, buffer, size), TVI_OK);
        if (fails) ck_assert_int_ne(tvi_step(other.it, 1e4, &y.t, y.q, y.p), TVI_OK);
        go(other.it, 0.08, 30, &y);
        ck_assert_int_eq(other.work->springs.last->count, CHAIN / 2);
        ck_assert_mem_eq(&y, &r.x, sizeof y);
    }
    end(&r);
    end(&other);
}
END_TEST

Suite *suite_springs(void)
{
    Suite *suite = suite_create("springs");
    TCase *tcase = tcase_create("springs");
    tcase_add_test(tcase, springs_that_stay_save_passes);
    tcase_add_test(tcase, energy_does_not_drift);
    tcase_add_loop_test(tcase, springs_that_turn, 0, 3);
    tcase_add_loop_test(tcase, others_have_no_springs, 0, 3);
    tcase_add_loop_test(tcase, large_steps_of_oscillators, 0, 2);
    tcase_add_test(tcase, states_have_the_springs);
    suite_add_tcase(suite, tcase);
    return suite;
}
