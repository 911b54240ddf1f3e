/* test_reversible.c - Tests the reversible form of rescaled systems: that every kind of system moves in it as in fixed
 * steps, with results, events, columns, states, members and generated code; that it is symmetric; and what is
 * refused. */
#include "problems/refusals.h"
#include "rescaled.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- The systems ------------------------------------------------------------------------------------------------- */

static void kepler_force(const jet q[], jet t, jet out[], void *ctx)
{
    const jet k = jet_neg(jet_pow(jet_dot(q, q, 2), -1.5));
    (void)t, (void)ctx;
    out[0] = jet_mul(k, q[0]);
    out[1] = jet_mul(k, q[1]);
}

/* Friction, and a push in time. */
static void friction(const jet q[], const jet v[], jet t, jet out[], void *ctx)
{
    (void)q, (void)ctx;
    out[0] = jet_add(jet_mul(-0.05, v[0]), jet_mul(0.1, jet_cos(t)));
    out[1] = jet_mul(-0.1, jet_mul(v[1], jet_sqrt(jet_add(1, jet_sqr(v[0])))));
}

/* A charge in a field across the plane, in the potential of `driven` without the time: p = v + A(q). */
static jet magnetic(const jet q[], const jet p[], jet t, void *ctx)
{
    const jet x = jet_add(p[0], jet_mul(0.4, q[1])), y = jet_sub(p[1], jet_mul(0.4, q[0]));
    (void)t;
    return jet_add(jet_mul(0.5, jet_add(jet_sqr(x), jet_div(jet_sqr(y), 2.5))), driven(q, jet_const(0), ctx));
}

/* The same motion by its Lagrangian, whose momenta are p = M v + f(q). */
static jet turning(const jet q[], const jet v[], jet t, void *ctx)
{
    const jet T = jet_mul(0.5, jet_add(jet_sqr(v[0]), jet_mul(2.5, jet_sqr(v[1]))));
    const jet A = jet_mul(0.4, jet_sub(jet_mul(q[0], v[1]), jet_mul(q[1], v[0])));
    (void)t;
    return jet_sub(jet_add(T, A), driven(q, jet_const(0), ctx));
}

/* Velocities that are coupled, in a moving frame: L_vv depends on q and t. */
static jet coupled(const jet q[], const jet v[], jet t, void *ctx)
{
    const jet a = jet_mul(jet_add(1, jet_mul(0.2, jet_sqr(q[1]))), jet_sqr(v[0])),
              b = jet_mul(jet_mul(0.8, jet_cos(jet_sub(q[0], jet_mul(0.3, t)))), jet_mul(v[0], v[1])),
              c = jet_mul(2.5, jet_sqr(v[1]));
    const jet A = jet_mul(0.4, jet_sub(jet_mul(q[0], v[1]), jet_mul(q[1], v[0])));
    return jet_sub(jet_add(jet_mul(0.5, jet_add(jet_add(a, b), c)), A), driven(q, jet_const(0), ctx));
}

/* H_p is not linear in p: relativistic. */
static jet fast(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t;
    return jet_add(jet_sqrt(jet_add(1, jet_dot(p, p, 2))), driven(q, jet_const(0), ctx));
}

typedef enum { POTENTIAL, FORCE, TIMED, DRIVEN, HAMILTONIAN, LAGRANGIAN, COUPLED, RELATIVISTIC, KINDS } kind_of_system;

static tvi_system *stated(kind_of_system kind)
{
    tvi_system *system = NULL, *base;
    tvi_status status = TVI_EINVAL;
    if (kind == POTENTIAL) status = tvi_system_potential(&system, 2, NULL, kepler, NULL);
    if (kind == FORCE) status = tvi_system_force(&system, 2, NULL, kepler_force, NULL);
    if (kind == TIMED) status = tvi_system_potential(&system, 2, driven_mass, driven, NULL);
    if (kind == HAMILTONIAN) status = tvi_system_hamiltonian(&system, 2, magnetic, NULL);
    if (kind == LAGRANGIAN) status = tvi_system_lagrangian(&system, 2, turning, NULL);
    if (kind == COUPLED) status = tvi_system_lagrangian(&system, 2, coupled, NULL);
    if (kind == RELATIVISTIC) status = tvi_system_hamiltonian(&system, 2, fast, NULL);
    if (kind == DRIVEN) {
        ck_assert_int_eq(tvi_system_potential(&base, 2, driven_mass, driven, NULL), TVI_OK);
        status = tvi_system_driven(&system, base, friction, NULL);
        tvi_system_free(base);
    }
    ck_assert_msg(status == TVI_OK, "%s", tvi_last_error());
    return system;
}

static bool is_kepler(kind_of_system kind) { return kind == POTENTIAL || kind == FORCE; }
static state start_of(kind_of_system kind) { return is_kepler(kind) ? kepler_start(0.9) : driven_start(); }

static tvi_system *reversible(kind_of_system kind)
{
    tvi_system *base = stated(kind), *rescaled;
    const tvi_status status =
        tvi_system_rescaled_reversible(&rescaled, base, is_kepler(kind) ? kepler_scale : driven_scale, NULL);
    ck_assert_msg(status == TVI_OK, "%s", tvi_last_error());
    tvi_system_free(base);
    return rescaled;
}

static run open_reversible(kind_of_system kind, int order)
{
    const state start = start_of(kind);
    return open_run(reversible(kind), "galerkin", order, &start);
}

/* The state at t by fixed steps of the system itself, small enough for roundoff. */
static state exact_at(kind_of_system kind, double t)
{
    const state start = start_of(kind);
    if (is_kepler(kind)) return kepler_at(0.9, t);
    run r = open_run(stated(kind), "galerkin", 16, &start);
    ck_assert_int_eq(tvi_integrate_to(r.integrator, t > r.x.t ? 0.02 : -0.02, t, &r.x.t, r.x.q, r.x.p, NULL, NULL),
                     TVI_OK);
    const state end = r.x;
    close_run(&r);
    return end;
}

/* ---- Motions ----------------------------------------------------------------------------------------------------- */

static const double T_END = 7;

/* Forward and back, to a time exactly. */
START_TEST(reaches_a_time)
{
    const kind_of_system kind = (kind_of_system)(_i / 2);
    const double t = _i % 2 ? -T_END : T_END;
    run r = open_reversible(kind, 16);
    const state exact = exact_at(kind, t);
    ck_assert_int_eq(tvi_integrate_to(r.integrator, t > 0 ? 0.2 : -0.2, t, &r.x.t, r.x.q, r.x.p, NULL, NULL), TVI_OK);
    ck_assert(r.x.t == t);
    ck_assert_double_le(state_distance(2, &r.x, &exact), 2e-12);
    close_run(&r);
}
END_TEST

/* The order in the time is that of the method: of two sizes the errors are as h^order, to a third of one order. */
START_TEST(has_its_order)
{
    const kind_of_system kind = (kind_of_system)(_i / 2);
    const int order = _i % 2 ? 4 : 2;
    const state exact = exact_at(kind, T_END);
    double error[2];
    for (int k = 0; k < 2; k++) {
        const double h = (order == 2 ? 0.008 : 0.04) / (1 + k);
        run r = open_reversible(kind, order);
        ck_assert_int_eq(tvi_integrate_to(r.integrator, h, T_END, &r.x.t, r.x.q, r.x.p, NULL, NULL), TVI_OK);
        error[k] = state_distance(2, &r.x, &exact);
        close_run(&r);
    }
    ck_assert_double_eq_tol(log2(error[0] / error[1]), order, 0.34);
}
END_TEST

/* Forward and back by steps so large that their errors are seen: it returns to roundoff, as a symmetric method does. */
START_TEST(returns)
{
    const kind_of_system kind = (kind_of_system)_i;
    const state start = start_of(kind);
    run r = open_reversible(kind, 4);
    ck_assert_int_eq(run_steps(&r, 0.1, 60), TVI_OK);
    const state there = exact_at(kind, r.x.t);
    ck_assert_double_ge(state_distance(2, &r.x, &there), 1e-7);
    ck_assert_int_eq(run_steps(&r, -0.1, 60), TVI_OK);
    ck_assert_double_le(state_distance(2, &r.x, &start), 2e-12);
    close_run(&r);
}
END_TEST

/* ---- What lies in steps ------------------------------------------------------------------------------------------ */

typedef struct {
    kind_of_system kind;
    int times, events;
    double error;
} seen;

static int see_time(long which, double t, const double q[], const double p[], void *ctx)
{
    seen *s = ctx;
    const state x = {t, {q[0], q[1]}, {p[0], p[1]}}, exact = exact_at(s->kind, t);
    (void)which;
    s->times++;
    s->error = fmax(s->error, state_distance(2, &x, &exact));
    return 0;
}

static int see_event(int which, double t, const double q[], const double p[], void *ctx)
{
    ((seen *)ctx)->events++;
    ck_assert_double_eq_tol(q[0], 0.05, 1e-15);
    return see_time(which, t, q, p, ctx);
}

static jet at_level(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_sub(q[0], 0.05);
}

START_TEST(results_and_events)
{
    seen s = {.kind = (kind_of_system)_i};
    const double start = start_of(s.kind).t, times[] = {start, start + 0.01, 1, 3.7, T_END};
    tvi_event *event;
    ck_assert_int_eq(tvi_event_create(&event, 2, TVI_EITHER, false, at_level, NULL), TVI_OK);
    run r = open_reversible(s.kind, 16), other = open_reversible(s.kind, 16);
    ck_assert_int_eq(tvi_integrate_at(r.integrator, 0.2, times, 5, &r.x.t, r.x.q, r.x.p, see_time, &s), TVI_OK);
    ck_assert_int_eq(s.times, 5);
    ck_assert_int_eq(tvi_integrate_events(other.integrator, 0.2, 30, (const tvi_event *const[]){event}, 1, &other.x.t,
                                          other.x.q, other.x.p, NULL, see_event, &s),
                     TVI_OK);
    ck_assert_int_ge(s.events, 1);
    ck_assert_double_le(s.error, 2e-12);
    tvi_event_free(event);
    close_run(&r);
    close_run(&other);
}
END_TEST

/* The columns at a fixed time are those of fixed steps, and nothing is projected on an energy. */
START_TEST(columns_at_fixed_time)
{
    const kind_of_system kind = (kind_of_system)_i;
    const state start = start_of(kind);
    double D[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, exact[16], size = 0, error = 0;
    memcpy(exact, D, sizeof D);
    run r = open_reversible(kind, 16), fixed = open_run(stated(kind), "galerkin", 16, &start);
    for (int k = 0; k < 20; k++)
        ck_assert_int_eq(tvi_step_tangent(r.integrator, 0.1, &r.x.t, r.x.q, r.x.p, D, 4), TVI_OK);
    const double h = (r.x.t - start.t) / 1000;
    for (int k = 0; k < 1000; k++)
        ck_assert_int_eq(tvi_step_tangent(fixed.integrator, h, &fixed.x.t, fixed.x.q, fixed.x.p, exact, 4), TVI_OK);
    for (int i = 0; i < 16; i++) {
        size = fmax(size, fabs(exact[i]));
        error = fmax(error, fabs(D[i] - exact[i]));
    }
    ck_assert_double_le(error, 1e-11 * size);
    close_run(&r);
    close_run(&fixed);
}
END_TEST

/* ---- States, members, code --------------------------------------------------------------------------------------- */

START_TEST(members_and_states)
{
    const kind_of_system kind = (kind_of_system)_i;
    char text[8192];
    size_t size = sizeof text;
    run r = open_reversible(kind, 16), other = open_reversible(kind, 16);
    state member = r.x;
    tvi_status status;
    tvi_ensemble *one;
    double energy[2];
    ck_assert_int_eq(tvi_ensemble_create(&one, r.system, NULL, 1, 1), TVI_OK);
    ck_assert_int_eq(run_steps(&r, 0.2, 20), TVI_OK);
    ck_assert_int_eq(tvi_ensemble_integrate(one, 0.2, 20, &member.t, member.q, member.p, &status, NULL, NULL), TVI_OK);
    ck_assert(status == TVI_OK && memcmp(&member, &r.x, sizeof member) == 0);
    ck_assert_msg(tvi_state_to_text(r.integrator, r.x.t, r.x.q, r.x.p, text, &size) == TVI_OK, "%s", tvi_last_error());
    ck_assert_msg(tvi_state_from_text(other.integrator, text, size, &other.x.t, other.x.q, other.x.p) == TVI_OK, "%s",
                  tvi_last_error());
    ck_assert(memcmp(&other.x, &r.x, sizeof other.x) == 0);
    ck_assert_int_eq(run_steps(&r, 0.2, 20), TVI_OK);
    ck_assert_int_eq(run_steps(&other, 0.2, 20), TVI_OK);
    ck_assert_double_le(state_distance(2, &other.x, &r.x), 1e-13);
    const tvi_status has_energy = tvi_energy(r.system, r.x.t, r.x.q, r.x.p, &energy[0]);
    tvi_system *base = stated(kind);
    ck_assert_int_eq(has_energy, kind == FORCE ? TVI_EUNSUPPORTED : TVI_OK);
    ck_assert_int_eq(tvi_energy(base, r.x.t, r.x.q, r.x.p, &energy[1]), has_energy);
    ck_assert(kind == FORCE || energy[0] == energy[1]);
    tvi_system_free(base);
    tvi_ensemble_free(one);
    close_run(&r);
    close_run(&other);
}
END_TEST

/* A text of one form is read by the other: K has an e, which is its own and not the other's 0. */
START_TEST(texts_between_forms)
{
    char text[8192];
    size_t size = sizeof text;
    const bool to_K = _i == 0;
    const state start = kepler_start(0.5);
    tvi_system *base, *forms[2];
    ck_assert_int_eq(tvi_system_potential(&base, 2, NULL, kepler, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_rescaled_reversible(&forms[0], base, kepler_scale, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_rescaled(&forms[1], base, kepler_scale, NULL), TVI_OK);
    tvi_system_free(base);
    run from = open_run(forms[!to_K], NULL, 0, &start), to = open_run(forms[to_K], NULL, 0, &start);
    ck_assert_int_eq(run_steps(&from, 0.2, 5), TVI_OK);
    ck_assert_int_eq(tvi_state_to_text(from.integrator, from.x.t, from.x.q, from.x.p, text, &size), TVI_OK);
    ck_assert_msg(tvi_state_from_text(to.integrator, text, size, &to.x.t, to.x.q, to.x.p) == TVI_OK, "%s",
                  tvi_last_error());
    ck_assert_int_eq(tvi_integrate_to(to.integrator, 0.2, 20, &to.x.t, to.x.q, to.x.p, NULL, NULL), TVI_OK);
    const state exact = kepler_at(0.5, 20);
    ck_assert_double_le(state_distance(2, &to.x, &exact), 1e-12);
    close_run(&from);
    close_run(&to);
}
END_TEST

START_TEST(generated_code)
{
    run r = open_reversible(DRIVEN, 16);
    tvi_options options = tvi_options_default();
    tvi_compiled *code;
    tvi_integrator *compiled;
    state x = r.x;
    ck_assert_msg(tvi_compile(&code, r.system, &options, NULL) == TVI_OK, "%s", tvi_last_error());
    options.compiled = code;
    ck_assert_int_eq(tvi_integrator_create(&compiled, r.system, &options), TVI_OK);
    ck_assert_int_eq(tvi_integrate(compiled, 0.2, 50, &x.t, x.q, x.p, NULL, NULL), TVI_OK);
    ck_assert_int_eq(run_steps(&r, 0.2, 50), TVI_OK);
    ck_assert_double_le(state_distance(2, &x, &r.x), 1e-13);
    tvi_integrator_free(compiled);
    tvi_compiled_free(code);
    close_run(&r);
}
END_TEST

/* A step for an error is found, and the error is met. */
START_TEST(steps_for_an_error)
{
    const kind_of_system kind = _i ? DRIVEN : FORCE;
    run r = open_reversible(kind, 16);
    const state exact = exact_at(kind, T_END);
    double h = 0;
    ck_assert_msg(tvi_suggest_step(r.system, NULL, r.x.t, r.x.q, r.x.p, T_END - r.x.t, 1e-9, &h) == TVI_OK, "%s",
                  tvi_last_error());
    ck_assert_int_eq(tvi_integrate_to(r.integrator, h, T_END, &r.x.t, r.x.q, r.x.p, NULL, NULL), TVI_OK);
    ck_assert_double_le(state_distance(2, &r.x, &exact), 4e-9); /* relative to sizes up to 4 */
    close_run(&r);
}
END_TEST

/* ---- Refused ----------------------------------------------------------------------------------------------------- */

static jet number_of(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)p, (void)t;
    return jet_const(*(const double *)ctx);
}

static jet falling(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return q[0];
}

static jet curved(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_mul(jet_add(1, jet_sqr(q[0])), jet_add(jet_sqr(v[0]), jet_pow(v[0], 4)));
}

START_TEST(what_is_refused)
{
    tvi_system *base = stated(POTENTIAL), *force = stated(FORCE), *pushed = stated(DRIVEN), *lagrangian, *out = base;
    const double none = 0, nan = NAN;
    ck_assert_int_eq(tvi_system_lagrangian(&lagrangian, 1, curved, NULL), TVI_OK);
    refused("out is NULL", tvi_system_rescaled_reversible(NULL, base, kepler_scale, NULL), TVI_EINVAL);
    refused("system is NULL", tvi_system_rescaled_reversible(&out, NULL, kepler_scale, NULL), TVI_EINVAL);
    ck_assert_ptr_null(out);
    refused("state the Hamiltonian", tvi_system_rescaled_reversible(&out, lagrangian, falling, NULL), TVI_EUNSUPPORTED);
    refused("give a g of your own", tvi_system_rescaled_reversible(&out, force, NULL, NULL), TVI_EUNSUPPORTED);
    refused("give a g of your own", tvi_system_rescaled_reversible(&out, pushed, NULL, NULL), TVI_EUNSUPPORTED);
    refused("the reversible form", tvi_system_rescaled_reversible(&out, base, number_of, (void *)&none), TVI_EDOMAIN);
    refused("the reversible form", tvi_system_rescaled_reversible(&out, base, number_of, (void *)&nan), TVI_ENONFINITE);
    ck_assert_ptr_null(out);
    tvi_system_free(base), tvi_system_free(force), tvi_system_free(pushed), tvi_system_free(lagrangian);
    run r = open_reversible(FORCE, 16);
    refused("rescaled already", tvi_system_rescaled_reversible(&out, r.system, kepler_scale, NULL), TVI_EUNSUPPORTED);
    refused("rescaled already", tvi_system_rescaled(&out, r.system, kepler_scale, NULL), TVI_EUNSUPPORTED);
    static const char *const others[] = {"taylor", "midpoint", "poincare", "right", "both-ends", "stormer-verlet"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        tvi_options options;
        tvi_integrator *it;
        ck_assert_int_eq(tvi_options_named(others[i], 2, &options), TVI_OK);
        refused("the reversible form", tvi_integrator_create(&it, r.system, &options), TVI_EUNSUPPORTED);
    }
    close_run(&r);
}
END_TEST

/* g of the place, and of the momentum, of the second coordinate of `driven`. */
static jet of_place(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_div(1, jet_add(1, jet_sqr(q[1])));
}

static jet of_momentum(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)q, (void)t;
    return jet_div(1, jet_add(1, jet_sqr(jet_div(p[1], *(const double *)ctx))));
}

static jet of_the_other(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_div(1, jet_add(1, jet_sqr(q[0])));
}

/* A chain of pendulums: L_vv is 2 where i = j, and else 0.4 cos (q_i - q_j) / (1 + |i - j|). *ctx is their number. */
static jet chain(const jet q[], const jet v[], jet t, void *ctx)
{
    const int n = *(const int *)ctx;
    jet L = jet_const(0);
    (void)t;
    for (int i = 0; i < n; i++) {
        L = jet_add(L, jet_add(jet_sqr(v[i]), jet_mul(1 + 0.1 * i, jet_cos(q[i]))));
        for (int j = 0; j < i; j++)
            L = jet_add(L, jet_mul(0.4 / (1 + i - j), jet_mul(jet_cos(jet_sub(q[i], q[j])), jet_mul(v[i], v[j]))));
    }
    return L;
}

/* Up to eight velocities may be coupled, and move as in fixed steps. */
START_TEST(chains_of_pendulums)
{
    enum { MOST = 9 };
    int n = _i;
    double t[2] = {0}, q[2][MOST], p[2][MOST];
    tvi_system *system[2];
    ck_assert_int_eq(tvi_system_lagrangian(&system[0], n, chain, &n), TVI_OK);
    const tvi_status status = tvi_system_rescaled_reversible(&system[1], system[0], of_place, NULL);
    ck_assert_int_eq(status, n < MOST ? TVI_OK : TVI_EUNSUPPORTED);
    for (int k = 0; k < 2 && status == TVI_OK; k++) {
        tvi_integrator *it;
        for (int i = 0; i < n; i++) q[k][i] = 0.3 + 0.2 * i, p[k][i] = 1 - 0.3 * i;
        ck_assert_int_eq(tvi_integrator_create(&it, system[k], NULL), TVI_OK);
        ck_assert_int_eq(tvi_integrate_to(it, k ? 0.3 : 0.1, 3, &t[k], q[k], p[k], NULL, NULL), TVI_OK);
        tvi_integrator_free(it);
    }
    for (int i = 0; i < n && status == TVI_OK; i++) {
        ck_assert_double_le(fabs(q[1][i] - q[0][i]), 1e-12);
        ck_assert_double_le(fabs(p[1][i] - p[0][i]), 1e-12);
    }
    tvi_system_free(system[0]), tvi_system_free(system[1]);
}
END_TEST

/* K refuses a mass of at most 1e-8 of the largest where g depends on its coordinate or its momentum, and no other. */
START_TEST(light_masses)
{
    static tvi_rescale_fn *const scales[] = {of_place, of_momentum, of_the_other};
    for (int k = 0; k < 3; k++)
        for (int light = 0; light < 2; light++) {
            const double mass[] = {2, light ? 1e-8 * 2 : 3e-8 * 2};
            tvi_system *base, *out;
            ck_assert_int_eq(tvi_system_potential(&base, 2, mass, driven, NULL), TVI_OK);
            const tvi_status status = tvi_system_rescaled(&out, base, scales[k], (void *)&mass[1]);
            ck_assert_int_eq(status, light && k < 2 ? TVI_EUNSUPPORTED : TVI_OK);
            ck_assert(status == TVI_OK || (strstr(tvi_last_error(), "reversible form") && !out));
            tvi_system_free(out);
            ck_assert_int_eq(tvi_system_rescaled_reversible(&out, base, scales[k], (void *)&mass[1]), TVI_OK);
            tvi_system_free(out);
            tvi_system_free(base);
        }
}
END_TEST

/* Where g is not positive a step is refused, and the state is as it was. */
START_TEST(scale_that_is_not_positive)
{
    tvi_system *base = stated(POTENTIAL), *rescaled;
    const state start = kepler_start(0.5);
    ck_assert_int_eq(tvi_system_rescaled_reversible(&rescaled, base, falling, NULL), TVI_OK);
    tvi_system_free(base);
    run r = open_run(rescaled, NULL, 0, &start);
    r.x.q[0] = -r.x.q[0];
    const state before = r.x;
    ck_assert_int_eq(run_steps(&r, 0.1, 1), TVI_EDOMAIN);
    ck_assert(memcmp(&before, &r.x, sizeof before) == 0);
    close_run(&r);
}
END_TEST

Suite *suite_reversible(void)
{
    Suite *suite = suite_create("reversible");
    TCase *tcase = tcase_create("reversible");
    tcase_set_timeout(tcase, 120);
    tcase_add_loop_test(tcase, reaches_a_time, 0, 2 * KINDS);
    tcase_add_loop_test(tcase, has_its_order, 0, 2 * KINDS);
    tcase_add_loop_test(tcase, returns, 0, KINDS);
    tcase_add_loop_test(tcase, results_and_events, 0, KINDS);
    tcase_add_loop_test(tcase, columns_at_fixed_time, 0, KINDS);
    tcase_add_loop_test(tcase, members_and_states, 0, KINDS);
    tcase_add_loop_test(tcase, texts_between_forms, 0, 2);
    tcase_add_test(tcase, light_masses);
    tcase_add_test(tcase, generated_code);
    tcase_add_loop_test(tcase, steps_for_an_error, 0, 2);
    tcase_add_loop_test(tcase, chains_of_pendulums, 2, 10);
    tcase_add_test(tcase, what_is_refused);
    tcase_add_test(tcase, scale_that_is_not_positive);
    suite_add_tcase(suite, tcase);
    return suite;
}
