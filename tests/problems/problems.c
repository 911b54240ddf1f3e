/* problems.c - Implements problems.h. */
#include "problems.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- Forces by hand ---------------------------------------------------------------------------------------------- */

static void pendulum_force(long double t, const long double q[], long double F[])
{
    (void)t;
    F[0] = -(long double)9.8 * sinl(q[0]);
}

static void kepler_force(long double t, const long double q[], long double F[])
{
    (void)t;
    const long double r2 = q[0] * q[0] + q[1] * q[1], r3 = r2 * sqrtl(r2);
    F[0] = -q[0] / r3;
    F[1] = -q[1] / r3;
}

static void henon_heiles_force(long double t, const long double q[], long double F[])
{
    (void)t;
    F[0] = -q[0] - 2 * q[0] * q[1];
    F[1] = -q[1] - q[0] * q[0] + q[1] * q[1];
}

/* ---- The driven chain -------------------------------------------------------------------------------------------- */

enum { CHAIN = 3 };
static const double spring_k = 4, spring_a = 1.5, spring_b = 2, drive = 0.75, drive_frequency = 1.7;
static const double chain_mass[CHAIN] = {1, 2.5, 0.4}, chain_q0[CHAIN] = {0.3, -0.2, 0.4},
                    chain_p0[CHAIN] = {0.5, 1, -0.25};

/* F_i = T(d_{i+1}) - T(d_i) + A cos(w t) on the first, T(d) = k d + a d^2 + b d^3, d_i = q_i - q_{i-1}, walls at 0. */
static void chain_record(const jet q[], jet t, jet force[], void *ctx)
{
    (void)ctx;
    jet tension[CHAIN + 1];
    for (int i = 0; i <= CHAIN; i++) {
        jet d = i == 0 ? q[0] : i == CHAIN ? jet_neg(q[CHAIN - 1]) : jet_sub(q[i], q[i - 1]);
        tension[i] = jet_mul(d, jet_add(spring_k, jet_mul(d, jet_add(spring_a, jet_mul(spring_b, d)))));
    }
    for (int i = 0; i < CHAIN; i++) force[i] = jet_sub(tension[i + 1], tension[i]);
    force[0] = jet_add(force[0], jet_mul(drive, jet_cos(jet_mul(drive_frequency, t))));
}

static long double chain_extension(const long double q[], int i)
{
    return (i < CHAIN ? q[i] : 0) - (i > 0 ? q[i - 1] : 0);
}

static void chain_force(long double t, const long double q[], long double F[])
{
    for (int i = 0; i < CHAIN; i++) F[i] = 0;
    for (int i = 0; i <= CHAIN; i++) {
        const long double d = chain_extension(q, i), tension = spring_k * d + spring_a * d * d + spring_b * d * d * d;
        if (i < CHAIN) F[i] -= tension;
        if (i > 0) F[i - 1] += tension;
    }
    F[0] += drive * cosl(drive_frequency * t);
}

void chain_hessian(const long double q[], long double H[])
{
    for (int i = 0; i < CHAIN * CHAIN; i++) H[i] = 0;
    for (int i = 0; i <= CHAIN; i++) {
        const long double d = chain_extension(q, i), slope = spring_k + 2 * spring_a * d + 3 * spring_b * d * d;
        if (i < CHAIN) H[i * CHAIN + i] += slope;
        if (i > 0) H[(i - 1) * CHAIN + i - 1] += slope;
        if (i > 0 && i < CHAIN) {
            H[i * CHAIN + i - 1] -= slope;
            H[(i - 1) * CHAIN + i] -= slope;
        }
    }
}

static const scene scene_chain = {
    .name = "chain",
    .title = "Driven chain",
    .n = CHAIN,
    .mass = chain_mass,
    .q = chain_q0,
    .p = chain_p0,
};

/* ---- The ring ---------------------------------------------------------------------------------------------------- */

enum { RING = 8 };
static const double ring_q0[RING] = {0.4, -0.3, 0.1, 0.7, -0.6, 0.2, 0.5, -0.2};
static const double ring_p0[RING] = {0.3, 0.1, -0.8, 0.2, 0.6, -0.4, -0.1, 0.5};

/* V = sum of exp d - d + cos(q_i)/4 + d/(4 + d^2), d to the next one. */
static jet ring_potential(const jet q[], jet t, void *ctx)
{
    jet sum = jet_const(0);
    (void)t, (void)ctx;
    for (int i = 0; i < RING; i++) {
        const jet d = jet_sub(q[(i + 1) % RING], q[i]);
        sum = jet_add(sum, jet_sub(jet_exp(d), d));
        sum = jet_add(sum, jet_add(jet_mul(0.25, jet_cos(q[i])), jet_div(d, jet_add(4, jet_sqr(d)))));
    }
    return sum;
}

const scene scene_ring = {
    .name = "ring",
    .title = "Ring of eight particles",
    .n = RING,
    .potential = ring_potential,
    .q = ring_q0,
    .p = ring_p0,
};

/* ---- Problems and their states ----------------------------------------------------------------------------------- */

const test_problem problem_pendulum = {&scene_pendulum, NULL, pendulum_force, 0, 2};
const test_problem problem_kepler = {&scene_kepler, NULL, kepler_force, 0, 3};
const test_problem problem_henon_heiles = {&scene_henon_heiles_12, NULL, henon_heiles_force, 0, 6};
const test_problem problem_chain = {&scene_chain, chain_record, chain_force, 0.3, 2.3};
const test_problem problem_solar = {&scene_solar, NULL, NULL, 0, 200000};
const test_problem problem_fpu = {&scene_fpu, NULL, NULL, 0, 1};
const test_problem problem_ring = {&scene_ring, NULL, NULL, 0, 5};

tvi_system *problem_system(const test_problem *problem)
{
    const scene *s = problem->scene;
    tvi_system *system = NULL;
    const tvi_status status = problem->force ? tvi_system_force(&system, s->n, s->mass, problem->force, NULL)
                                             : tvi_system_potential(&system, s->n, s->mass, s->potential, NULL);
    ck_assert_int_eq(status, TVI_OK);
    return system;
}

double problem_mass(const test_problem *problem, int i) { return problem->scene->mass ? problem->scene->mass[i] : 1; }

test_state problem_start(const test_problem *problem)
{
    test_state start = {.t = problem->t0};
    memcpy(start.q, problem->scene->q, (size_t)problem->scene->n * sizeof(double));
    memcpy(start.p, problem->scene->p, (size_t)problem->scene->n * sizeof(double));
    return start;
}

tvi_options options_type1(tvi_expansion expansion, tvi_nodes nodes, int degree)
{
    return (tvi_options){.method = TVI_TYPE1, .expansion = expansion, .nodes = nodes, .degree = degree, .max_tail = -1};
}

tvi_options options_taylor(int degree) { return (tvi_options){.method = TVI_TAYLOR, .degree = degree, .max_tail = -1}; }

tvi_options options_verlet(void) { return (tvi_options){.method = TVI_STORMER_VERLET, .order = 2, .max_tail = -1}; }

runner runner_open(const test_problem *problem, const tvi_options *options)
{
    runner run = {.problem = problem, .system = problem_system(problem)};
    ck_assert_int_eq(tvi_integrator_create(&run.integrator, run.system, options), TVI_OK);
    return run;
}

void runner_close(runner *run)
{
    tvi_integrator_free(run->integrator);
    tvi_system_free(run->system);
}

void runner_steps(const runner *run, double h, long steps, test_state *state)
{
    const tvi_status status = tvi_integrate(run->integrator, h, steps, &state->t, state->q, state->p, NULL, NULL);
    ck_assert_msg(status == TVI_OK, "%s, h = %g, t = %g: %s", run->problem->scene->name, h, state->t,
                  tvi_status_string(status));
}

test_state problem_run(const test_problem *problem, const tvi_options *options, long steps)
{
    runner run = runner_open(problem, options);
    test_state end = problem_start(problem);
    runner_steps(&run, (problem->t_end - problem->t0) / (double)steps, steps, &end);
    runner_close(&run);
    return end;
}

double state_energy(const tvi_system *system, const test_state *state)
{
    double H = 0;
    ck_assert_int_eq(tvi_energy(system, state->t, state->q, state->p, &H), TVI_OK);
    return H;
}

two_errors state_difference(int n, const test_state *a, const test_state *b)
{
    two_errors errors = {0, 0};
    for (int i = 0; i < n; i++) {
        errors.q = fmax(errors.q, fabs(a->q[i] - b->q[i]));
        errors.p = fmax(errors.p, fabs(a->p[i] - b->p[i]));
    }
    return errors;
}

two_errors state_error(int n, const test_state *a, const exact_state *exact)
{
    two_errors errors = {0, 0};
    for (int i = 0; i < n; i++) {
        errors.q = fmax(errors.q, (double)fabsl(a->q[i] - exact->q[i]));
        errors.p = fmax(errors.p, (double)fabsl(a->p[i] - exact->p[i]));
    }
    return errors;
}

double larger(two_errors errors) { return fmax(errors.q, errors.p); }

/* ---- Integrators that share nothing with the library ------------------------------------------------------------- */

/* The increments over `steps` steps of Stormer-Verlet: small, so that their roundoff is. */
static exact_state exact_verlet(const test_problem *problem, const exact_state *x, long double h, int steps)
{
    const int n = problem->scene->n;
    long double q[N_MAX], F[N_MAX];
    exact_state d = {0};
    problem->plain(x->t, x->q, F);
    for (int step = 0; step < steps; step++) {
        for (int i = 0; i < n; i++) {
            d.p[i] += h / 2 * F[i];
            d.q[i] += h / problem_mass(problem, i) * (x->p[i] + d.p[i]);
            q[i] = x->q[i] + d.q[i];
        }
        d.t += h;
        problem->plain(x->t + d.t, q, F);
        for (int i = 0; i < n; i++) d.p[i] += h / 2 * F[i];
    }
    return d;
}

/* T_{j,k+1} = T_{j,k} + (T_{j,k} - T_{j-1,k}) / ((m_j/m_{j-k})^2 - 1) with T_{j,1} from m_j = 2 j substeps. */
static void extrapolated_step(const test_problem *problem, long double h, exact_state *x)
{
    enum { ROWS = 8 };
    const int n = problem->scene->n;
    exact_state table[ROWS];
    for (int row = 0; row < ROWS; row++) {
        exact_state next = exact_verlet(problem, x, h / (2 * (row + 1)), 2 * (row + 1));
        for (int column = 0; column < row; column++) { /* table[column] is T of the row before */
            const exact_state before = table[column];
            const long double ratio = (long double)(row + 1) / (row - column), factor = 1 / (ratio * ratio - 1);
            table[column] = next;
            for (int i = 0; i < n; i++) {
                next.q[i] += factor * (next.q[i] - before.q[i]);
                next.p[i] += factor * (next.p[i] - before.p[i]);
            }
        }
        table[row] = next;
    }
    for (int i = 0; i < n; i++) {
        x->q[i] += table[ROWS - 1].q[i];
        x->p[i] += table[ROWS - 1].p[i];
    }
    x->t += h;
}

exact_state problem_exact(const test_problem *problem, const test_state *start, double t_end)
{
    enum { STEPS = 80 };
    const test_state usual = problem_start(problem), *from = start ? start : &usual;
    exact_state x = {.t = from->t};
    for (int i = 0; i < problem->scene->n; i++) {
        x.q[i] = from->q[i];
        x.p[i] = from->p[i];
    }
    const long double h = ((long double)t_end - x.t) / STEPS;
    for (int step = 0; step < STEPS; step++) extrapolated_step(problem, h, &x);
    return x;
}

two_errors problem_roundoff(const test_problem *problem)
{
    const double change = 1e-8;
    const int n = problem->scene->n;
    test_state start = problem_start(problem), moved = start, zero = {0};
    for (int i = 0; i < n; i++) {
        moved.q[i] *= 1 + change;
        moved.p[i] *= 1 + change;
    }
    const exact_state end = problem_exact(problem, &start, problem->t_end);
    const exact_state other = problem_exact(problem, &moved, problem->t_end);
    two_errors size = state_error(n, &zero, &end), moves = {0, 0};
    const two_errors first = state_difference(n, &start, &zero);
    for (int i = 0; i < n; i++) {
        moves.q = fmax(moves.q, (double)fabsl(end.q[i] - other.q[i]) / change);
        moves.p = fmax(moves.p, (double)fabsl(end.p[i] - other.p[i]) / change);
    }
    return (two_errors){DBL_EPSILON * fmax(fmax(size.q, first.q), moves.q),
                        DBL_EPSILON * fmax(fmax(size.p, first.p), moves.p)};
}
