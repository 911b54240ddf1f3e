/* models.c - Implements models.h. */
#include "generating.h"
#include "models.h"
#include "method/list.h"
#include "method/method.h"
#include "statements.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const model model_pendulum = {
    .name = "pendulum",
    .n = 1,
    .with = WITH_ALL,
    .problem = &problem_pendulum,
    .t_end = 2,
    .h = 0.1,
    .steps = 100,
};
const model model_kepler = {
    .name = "kepler",
    .n = 2,
    .with = WITH_ALL,
    .problem = &problem_kepler,
    .t_end = 3,
    .h = 0.1,
    .steps = 100,
};
const model model_henon_heiles = {
    .name = "henon-heiles",
    .n = 2,
    .with = WITH_ALL,
    .problem = &problem_henon_heiles,
    .t_end = 6,
    .h = 0.25,
    .steps = 100,
};
const model model_chain = {
    .name = "chain",
    .n = 3,
    .with = WITH_ALL,
    .problem = &problem_chain,
    .t0 = 0.3,
    .t_end = 2.3,
    .h = 0.05,
    .steps = 100,
};
const model model_double_pendulum = {
    .name = "double pendulum",
    .n = 2,
    .with = WITH_TYPE1,
    .scene = &scene_double_pendulum,
    .t_end = 1.25,
    .h = 0.04,
    .steps = 60,
    .most_order = 6,
};
const model model_magnetic = {
    .name = "magnetic",
    .n = 3,
    .with = WITH_TYPE1,
    .scene = &scene_magnetic,
    .t_end = 5,
    .h = 0.1,
    .steps = 40,
};
const model model_nonseparable = {
    .name = "nonseparable",
    .n = 1,
    .with = WITH_ALL,
    .scene = &scene_nonseparable,
    .t_end = 2,
    .h = 0.1,
    .steps = 100,
};
const model model_vortices = {
    .name = "vortices",
    .n = 4,
    .with = WITH_HAMILTON,
    .scene = &scene_vortices,
    .t_end = 0.625,
    .h = 0.01,
    .steps = 50,
    .most_order = 8,
};
const model model_degenerate = {
    .name = "degenerate",
    .n = 1,
    .with = WITH_HAMILTON,
    .scene = &scene_degenerate,
    .t_end = 1.5,
    .h = 0.1,
    .steps = 20,
    .most_order = 8,
};
const model model_sheared_lagrangian = {
    .name = "sheared Lagrangian",
    .n = CHAIN_N,
    .with = WITH_TYPE1,
    .lagrangian = sheared_lagrangian,
    .t0 = 0.3,
    .t_end = 2.3,
    .h = 0.05,
    .steps = 100,
};
const model model_sheared_hamiltonian = {
    .name = "sheared Hamiltonian",
    .n = CHAIN_N,
    .with = WITH_ALL,
    .hamiltonian = sheared_hamiltonian,
    .t0 = 0.3,
    .t_end = 2.3,
    .h = 0.05,
    .steps = 100,
};

const model *const models[MODELS_OF_ORDERS] = {
    &model_pendulum,     &model_kepler,   &model_chain,      &model_double_pendulum,    &model_magnetic,
    &model_nonseparable, &model_vortices, &model_degenerate, &model_sheared_lagrangian, &model_sheared_hamiltonian,
    &model_henon_heiles,
};

tvi_system *model_system(const model *m)
{
    if (m->problem) return problem_system(m->problem);
    tvi_system *system = NULL;
    const tvi_status status = m->scene        ? scene_system(m->scene, &system)
                              : m->lagrangian ? tvi_system_lagrangian(&system, m->n, m->lagrangian, NULL)
                                              : tvi_system_hamiltonian(&system, m->n, m->hamiltonian, NULL);
    ck_assert_msg(status == TVI_OK, "%s: %s", m->name, tvi_status_string(status));
    return system;
}

static exact_state exact_of(int n, const test_state *x)
{
    exact_state exact = {.t = x->t};
    for (int i = 0; i < n; i++) exact.q[i] = x->q[i], exact.p[i] = x->p[i];
    return exact;
}

test_state model_start(const model *m)
{
    if (m->problem) return problem_start(m->problem);
    test_state x = {.t = m->t0};
    if (m->scene) {
        memcpy(x.q, m->scene->q, (size_t)m->n * sizeof *x.q);
        memcpy(x.p, m->scene->p, (size_t)m->n * sizeof *x.p);
        return x;
    }
    const test_state chain = problem_start(&problem_chain);
    const exact_state exact = exact_of(CHAIN_N, &chain), moved = sheared_state(&exact);
    for (int i = 0; i < m->n; i++) x.q[i] = (double)moved.q[i], x.p[i] = (double)moved.p[i];
    return x;
}

test_state model_place(const model *m)
{
    test_state x = model_start(m);
    x.q[0] += 0.1;
    x.p[0] += 0.05;
    return x;
}

/* At the scene's end, or that of the problem. */
static exact_state exact_end(const model *m)
{
    if (!m->scene) {
        const exact_state end = problem_exact(m->problem ? m->problem : &problem_chain, NULL, m->t_end);
        return m->problem ? end : sheared_state(&end);
    }
    exact_state end = {.t = m->scene->t_end};
    for (int i = 0; i < m->n; i++) {
        end.q[i] = m->scene->reference[i];
        end.p[i] = m->scene->reference[m->n + i];
    }
    return end;
}

enum { FINE_DEGREE = 8, FINE_STEPS = 120 }; /* a part */

static tvi_integrator *fine_integrator(const model *m, const tvi_system *system)
{
    const tvi_options lagrange = options_type1(TVI_AT_MIDPOINT, TVI_NODES_ON_CURVE, FINE_DEGREE);
    const tvi_options poincare = {.method = TVI_POINCARE, .expansion = TVI_AT_MIDPOINT, .degree = FINE_DEGREE - 1};
    return integrator_of(system, m->with & WITH_HAMILTON ? &poincare : &lagrange);
}

/* From x to the end of the solution's parts, and to the end where the exact solution is known. */
static test_state fine_run(const model *m, test_state x, test_state at[PARTS], double t_exact)
{
    tvi_system *system = model_system(m);
    tvi_integrator *integrator = fine_integrator(m, system);
    const double part = (m->t_end - m->t0) / PARTS;
    for (int k = 0; k < PARTS; k++) {
        go(integrator, part / FINE_STEPS, FINE_STEPS, &x);
        at[k] = x;
    }
    if (t_exact > m->t_end) go(integrator, (t_exact - m->t_end) / (PARTS * FINE_STEPS), PARTS * FINE_STEPS, &x);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    return x;
}

model_path model_solution(const model *m)
{
    const double change = 1e-7;
    model_path path = {.roundoff = {0, 0}};
    const exact_state exact = exact_end(m);
    const double t_exact = (double)exact.t;
    const test_state start = model_start(m), end = fine_run(m, start, path.at, t_exact), zero = {0};
    ck_assert_msg(larger(state_error(m->n, &end, &exact)) < 1e-12, "%s: the solution is wrong", m->name);
    test_state moved = start, at[PARTS];
    for (int i = 0; i < m->n; i++) moved.q[i] *= 1 + change, moved.p[i] *= 1 + change;
    (void)fine_run(m, moved, at, m->t_end);
    for (int k = 0; k < PARTS; k++) {
        const two_errors moves = state_difference(m->n, &at[k], &path.at[k]),
                         size = state_difference(m->n, &path.at[k], &zero);
        path.roundoff.q = fmax(path.roundoff.q, DBL_EPSILON * fmax(size.q, moves.q / change));
        path.roundoff.p = fmax(path.roundoff.p, DBL_EPSILON * fmax(size.p, moves.p / change));
    }
    return path;
}

/* ---- Generating functions ---------------------------------------------------------------------------------------- */

kind kinds[KINDS_MOST];
int kind_count, all_kinds;

static void add_kinds(const tvi_descriptor *d)
{
    for (int nodes = TVI_NODES_ON_CURVE; nodes <= TVI_NODES_TRUNCATED; nodes++) {
        const tvi_options options = {.method = d->method, .expansion = d->expansion, .nodes = (tvi_nodes)nodes};
        if (tvi_find_method(&options) != d) continue;
        if (all_kinds == KINDS_MOST) abort();
        kinds[all_kinds++] = (kind){d->method, d->expansion, options.nodes, tvi_is_method_symmetric(d)};
    }
}

void find_kinds(void)
{
    for (const tvi_descriptor *const *d = tvi_methods; *d; d++)
        if ((*d)->adjoint && *d != &tvi_galerkin) add_kinds(*d);
    kind_count = all_kinds;
    add_kinds(&tvi_galerkin);
}

tvi_options kind_options(const kind *k, int degree)
{
    tvi_options options = {.method = k->method, .expansion = k->expansion, .nodes = k->nodes, .degree = degree};
    if (degree == 0) options.order = 2;
    return options;
}

tvi_options kind_options_with(const kind *k, int degree, tvi_quadrature quadrature, int points)
{
    tvi_options options = kind_options(k, degree);
    options.quadrature = quadrature;
    options.quadrature_points = points;
    return options;
}

bool kind_serves(const kind *k, const model *m)
{
    return k->expansion == TVI_AT_NODES || m->with & (k->method == TVI_TYPE1 ? WITH_TYPE1 : WITH_HAMILTON);
}

int kind_least_degree(const kind *k) { return k->method == TVI_POINCARE ? 0 : 1; }

const char *describe(const tvi_options *options)
{
    static const char *const quadrature[] = {"auto",      "Gauss",           "Lobatto",
                                             "trapezoid", "rectangle start", "rectangle end"};
    enum { TEXTS = 8 };
    static char text[TEXTS][160];
    static int next;
    char *out = text[next++ % TEXTS];
    snprintf(out, sizeof text[0], "%s, %s, degree %d, %s %d%s", tvi_find_method(options)->title,
             options->nodes == TVI_NODES_TRUNCATED ? "truncated" : "on-curve", options->degree,
             quadrature[options->quadrature], options->quadrature_points, options->compose_adjoint ? ", composed" : "");
    return out;
}

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

tvi_integrator *integrator_of(const tvi_system *system, const tvi_options *options)
{
    tvi_integrator *integrator;
    const char *why = "";
    tvi_options as_defined = options ? *options : tvi_options_default();
    as_defined.max_tail = -1; /* no step is refused as too large */
    (void)!tvi_options_check(system, options, &why);
    ck_assert_msg(tvi_integrator_create(&integrator, system, &as_defined) == TVI_OK, "%s: %s", describe(options), why);
    return integrator;
}

void go(tvi_integrator *integrator, double h, long steps, test_state *x)
{
    const tvi_status status = tvi_integrate(integrator, h, steps, &x->t, x->q, x->p, NULL, NULL);
    ck_assert_msg(status == TVI_OK, "%s, h = %g, t = %g: %s", describe(tvi_integrator_options(integrator)), h, x->t,
                  tvi_status_string(status));
}

sample energy_errors(const model *m, const test_state *x, const tvi_options *options, double h, long steps)
{
    tvi_system *system = model_system(m);
    sample errors = {0};
    for (int k = 0; k < ORBITS; k++) {
        tvi_integrator *it = integrator_of(system, options);
        test_state now = *x;
        for (int i = 0; i < m->n; i++) now.q[i] += start_shift(k), now.p[i] += start_shift(k);
        const double start = state_energy(system, &now);
        go(it, h, steps, &now);
        sample_add(&errors, state_energy(system, &now) - start);
        tvi_integrator_free(it);
    }
    tvi_system_free(system);
    return errors;
}

void go_tangent(int n, tvi_integrator *integrator, double h, test_state *x, double M[])
{
    const tvi_options *options = tvi_integrator_options(integrator);
    const int rows = 2 * n;
    for (int i = 0; i < rows * rows; i++) M[i] = i % (rows + 1) == 0;
    tvi_integrator_reset(integrator);
    const tvi_status status = tvi_step_tangent(integrator, h, &x->t, x->q, x->p, M, rows);
    ck_assert_msg(status == TVI_OK, "%s, h = %g, t = %g: %s", describe(options), h, x->t, tvi_status_string(status));
}

double symplectic_defect(int n, const double M[])
{
    double largest = 0;
    for (int a = 0; a < 2 * n; a++)
        for (int b = 0; b < 2 * n; b++) {
            double sum = b == a + n ? -1 : a == b + n ? 1 : 0;
            for (int i = 0; i < n; i++)
                sum += M[i * 2 * n + a] * M[(n + i) * 2 * n + b] - M[(n + i) * 2 * n + a] * M[i * 2 * n + b];
            ck_assert(isfinite(sum));
            largest = fmax(largest, fabs(sum));
        }
    return largest;
}

double distance(int n, const test_state *a, const test_state *b)
{
    const test_state zero = {0};
    const two_errors difference = state_difference(n, a, b), size = state_difference(n, b, &zero);
    return fmax(difference.q / fmax(1, size.q), difference.p / fmax(1, size.p));
}
