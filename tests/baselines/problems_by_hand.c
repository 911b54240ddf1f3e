/* problems_by_hand.c - Creates the problems, and runs of baselines on them. */
#include "baselines.h"

#include <math.h>

/* ---- Forces in long double, which share nothing with bench/baselines --------------------------------------------- */

static void fpu_force(long double t, const long double q[], long double F[])
{
    (void)t;
    const long double stiff = 50.0L * 50 / 2;
    F[0] = stiff * (q[1] - q[0]) - 4 * powl(q[0], 3);
    F[1] = 4 * powl(q[2] - q[1], 3) - stiff * (q[1] - q[0]);
    F[2] = stiff * (q[3] - q[2]) - 4 * powl(q[2] - q[1], 3);
    F[3] = 4 * powl(q[4] - q[3], 3) - stiff * (q[3] - q[2]);
    F[4] = stiff * (q[5] - q[4]) - 4 * powl(q[4] - q[3], 3);
    F[5] = -4 * powl(q[5], 3) - stiff * (q[5] - q[4]);
}

static void solar_force(long double t, const long double q[], long double F[])
{
    (void)t;
    for (int i = 0; i < 18; i++) F[i] = 0;
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) {
            if (i == j) continue;
            long double r2 = 0;
            for (int k = 0; k < 3; k++) r2 += powl(q[3 * j + k] - q[3 * i + k], 2);
            const double *m = scene_solar.mass;
            const long double size = 2.95912208286e-4 * (long double)m[3 * i] * m[3 * j] / (r2 * sqrtl(r2));
            for (int k = 0; k < 3; k++) F[3 * i + k] += size * (q[3 * j + k] - q[3 * i + k]);
        }
}

static const test_problem fpu = {&scene_fpu, NULL, fpu_force, 0, 2};
static const test_problem solar = {&scene_solar, NULL, solar_force, 0, 4000};

const test_problem *const baseline_problems[BASELINE_PROBLEMS] = {&problem_pendulum, &problem_kepler,
                                                                  &problem_henon_heiles, &fpu, &solar};

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

tvi_status baseline_run(const baseline *b, const test_problem *problem, double h, long steps, test_state *state)
{
    const baseline_task task = {.scene = problem->scene, .h = h, .steps = steps};
    baseline_counts counts;
    *state = problem_start(problem);
    state->t = h * (double)steps;
    return b->run(b, &task, state->q, state->p, &counts);
}
