/* runs.c - Makes in C the runs that test_bits.py makes in Python, and prints every number as its bits: a line for each
 * run, the name first. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <tvi.h>
#include <tvi_bodies.h>
#include <tvi_rigid.h>

enum { MEMBERS = 37 };

static void check(tvi_status status)
{
    if (status == TVI_OK || status == TVI_ESTOPPED) return;
    fprintf(stderr, "%s\n", tvi_last_error());
    exit(1);
}

static void print(const double x[], int count)
{
    for (int i = 0; i < count; i++) printf(" %a", x[i]);
}

static jet kepler(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_neg(jet_pow(jet_dot(q, q, 2), -0.5));
}

static void moving_line(const jet q[], jet t, jet value[], void *ctx)
{
    (void)ctx;
    value[0] = jet_sub(jet_sub(jet_add(q[0], q[1]), 1), jet_mul(0.8, jet_sin(t)));
}

static void pushed(const jet q[], jet t, jet force[], void *ctx)
{
    (void)ctx;
    force[0] = jet_sub(jet_mul(0.3, jet_cos(t)), jet_sin(q[0]));
    force[1] = jet_mul(-2, jet_sub(q[1], q[0]));
}

static jet double_pendulum(const jet q[], const jet v[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet mixed = jet_mul(jet_mul(v[0], v[1]), jet_cos(jet_sub(q[0], q[1])));
    const jet kinetic = jet_add(jet_add(jet_sqr(v[0]), jet_div(jet_sqr(v[1]), 2)), mixed);
    return jet_add(kinetic, jet_mul(9.8, jet_add(jet_mul(2, jet_cos(q[0])), jet_cos(q[1]))));
}

static jet coupled(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)ctx;
    const jet k = jet_parameter(t, 0, 1.5);
    return jet_div(jet_mul(jet_add(jet_mul(k, jet_sqr(q[0])), 1), jet_add(jet_sqr(p[0]), 1)), 2);
}

static jet scale(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return jet_pow(jet_dot(q, q, 2), 0.75);
}

static void friction(const jet q[], const jet v[], jet t, jet force[], void *ctx)
{
    (void)q, (void)t, (void)ctx;
    for (int i = 0; i < 2; i++) force[i] = jet_mul(-0.01, v[i]);
}

static jet radial(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    return jet_dot(q, p, 2);
}

static int tell(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    (void)member, (void)which, (void)ctx;
    print(&t, 1), print(q, 2), print(p, 2);
    return 0;
}

/* A run by the plan from (1, 0), (0, 0.8) or, of one degree of freedom, from 1, 0. */
static void run(const char *name, tvi_system *system, const tvi_options *options, tvi_run_plan plan, double value)
{
    tvi_integrator *it;
    double t = 0, q[2] = {1, 0}, p[2] = {0, 0.8};
    const int n = tvi_system_dimension(system);
    check(tvi_integrator_create(&it, system, options));
    if (value != 0) check(tvi_integrator_set_parameters(it, &value));
    if (n == 1) p[0] = 0;
    printf("%s", name);
    check(tvi_run(it, &plan, &t, q, p));
    print(&t, 1), print(q, n), print(p, n);
    if (plan.D) print(plan.D, 2 * n * plan.columns);
    printf("\n");
    tvi_integrator_free(it);
}

static void run_lagrangian(void)
{
    tvi_system *system;
    tvi_integrator *it;
    double t = 0, q[2] = {1, 0.5}, v[2] = {0.2, 0.1}, p[2];
    check(tvi_system_lagrangian(&system, 2, double_pendulum, NULL));
    check(tvi_momentum(system, t, q, v, p));
    check(tvi_integrator_create(&it, system, NULL));
    check(tvi_integrate(it, 0.02, 500, &t, q, p, NULL, NULL));
    printf("lagrangian");
    print(&t, 1), print(q, 2), print(p, 2);
    printf("\n");
    tvi_integrator_free(it);
    tvi_system_free(system);
}

static void run_ensemble(tvi_system *system)
{
    static double t[MEMBERS], q[2 * MEMBERS], p[2 * MEMBERS];
    static tvi_status status[MEMBERS];
    tvi_ensemble *ensemble;
    for (int m = 0; m < MEMBERS; m++) q[m] = 1 + m / 64.0, p[MEMBERS + m] = 0.8;
    check(tvi_ensemble_create(&ensemble, system, NULL, MEMBERS, 2));
    check(tvi_ensemble_integrate(ensemble, 0.25, 2000, t, q, p, status, NULL, NULL));
    printf("ensemble");
    print(q, 2 * MEMBERS), print(p, 2 * MEMBERS);
    printf("\n");
    tvi_ensemble_free(ensemble);
}

/* From orbital elements, with all that bodies have, by steps that adapt; then what the functions of states say. */
static void run_bodies(void)
{
    static const double mass[] = {3, 0.5, 0, 2e-3};
    tvi_bodies bodies = {.bodies = 4, .axes = 3, .mass = mass, .G = 2, .softening = 0.01, .sharpness = 2};
    tvi_system *system, *rescaled;
    tvi_integrator *it;
    double t = 0, q[12] = {0}, v[12] = {0}, p[12], x[3], L[3];
    bodies.J2 = 1e-3, bodies.radius = 0.5, bodies.pole[1] = 0.2, bodies.pole[2] = 1;
    for (int k = 1; k < 4; k++) {
        const tvi_orbit orbit = {.a = 2 * k, .e = 0.25 * k, .i = 0.5, .node = 1, .pericentre = 2, .time = k};
        check(tvi_orbit_state(&orbit, 2 * (mass[0] + mass[k]), q + 3 * k, v + 3 * k));
    }
    tvi_bodies_momenta(&bodies, v, p);
    tvi_bodies_to_centre(&bodies, q, p);
    check(tvi_bodies_system(&system, &bodies));
    check(tvi_system_rescaled(&rescaled, system, tvi_bodies_scale, &bodies));
    check(tvi_integrator_create(&it, rescaled, NULL));
    check(tvi_integrate(it, 0.1, 200, &t, q, p, NULL, NULL));
    printf("bodies");
    print(&t, 1), print(q, 12), print(p, 12);
    tvi_bodies_angular_momentum(&bodies, q, p, L);
    tvi_bodies_velocities(&bodies, p, v);
    print(L, 3), print(v, 12);
    tvi_bodies_centre(&bodies, q, p, x, L);
    print(x, 3), print(L, 3);
    tvi_orbit found;
    check(tvi_orbit_of(6, q + 6, v + 6, &found));
    print(&found.a, 1), print(&found.q, 1), print(&found.e, 1), print(&found.i, 1), print(&found.node, 1);
    print(&found.pericentre, 1), print(&found.time, 1), print(&found.f, 1), print(&found.M, 1);
    print(&found.mean_longitude, 1), print(&found.longitude_of_pericentre, 1);
    printf("\n");
    tvi_integrator_free(it);
    tvi_system_free(rescaled);
    tvi_system_free(system);
}

static jet spring(const jet q[], jet t, void *ctx)
{
    const double end[] = {0.5, 0, 0};
    jet x[3];
    (void)t;
    tvi_rigid_point(ctx, q, 1, end, x);
    return jet_mul(5, jet_dot(x, x, 3));
}

/* A top on its point, a rod on a hinge of it, and a spring; then what the functions of states say. */
static void run_rigid(void)
{
    const tvi_rigid_body body[] = {tvi_rigid_cylinder(2, 0.5, 0.75), tvi_rigid_rod(0.5, 1)};
    const tvi_joint joint[] = {{.kind = TVI_BALL, .other = TVI_WORLD, .point = {0, 0, -0.5}},
                               {.kind = TVI_BALL, .body = 1, .point = {-0.5, 0, 0}, .other_point = {0.25, 0, 0}},
                               {.kind = TVI_CROSS, .body = 1, .axis = {1, 0, 0}, .other_axis = {0, 0, 1}}};
    const tvi_rigid r = {.bodies = 2, .axes = 3, .body = body, .joints = 3, .joint = joint, .gravity = {0, 0, -9.8}};
    tvi_rigid_motion motion = {.point = {0, 0, -0.5}, .omega = {0.5, 0.25, 20}}, end = {.point = {-0.5, 0, 0}};
    const double axis[] = {1, 2, 0};
    double t = 0, q[18], p[18], L[3];
    tvi_system *system;
    tvi_integrator *it;
    tvi_rigid_turn(axis, 0.5, motion.quaternion);
    tvi_rigid_turn(axis, 0.5, end.quaternion);
    check(tvi_rigid_system(&system, &r, spring, (void *)&r));
    check(tvi_rigid_state(&r, 0, &motion, q, p));
    tvi_rigid_place(&r, q, 0, joint[1].other_point, end.place);
    check(tvi_rigid_state(&r, 1, &end, q, p));
    check(tvi_project(system, t, q, p));
    check(tvi_integrator_create(&it, system, NULL));
    check(tvi_integrate(it, 0.01, 200, &t, q, p, NULL, NULL));
    check(tvi_rigid_of(&r, 0, q, p, &motion));
    tvi_rigid_angular_momentum(&r, q, p, L);
    printf("rigid");
    print(q, 18), print(p, 18), print(L, 3), print(motion.place, 3), print(motion.velocity, 3);
    print(motion.quaternion, 4), print(motion.omega, 3);
    printf("\n");
    tvi_integrator_free(it);
    tvi_system_free(system);
}

int main(void)
{
    tvi_system *system, *other;
    tvi_event *event;
    tvi_options taylor, verlet, compiled = tvi_options_default();
    tvi_compiled *code;
    const double mass[] = {1, 2.5}, times[] = {0, 0.3, 10, 10.01, 10.02, 499.9};
    double D[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, h;
    const double q0[] = {1, 0}, p0[] = {0, 0.8};
    check(tvi_options_named("taylor", tvi_taylor_order(1e-12), &taylor));
    check(tvi_options_named("stormer-verlet", 2, &verlet));
    check(tvi_system_potential(&system, 2, NULL, kepler, NULL));
    check(tvi_event_create(&event, 2, TVI_RISING, false, radial, NULL));
    const tvi_event *const events[] = {event};
    run("steps", system, NULL, (tvi_run_plan){.h = 0.25, .steps = 5000}, 0);
    run("verlet", system, &verlet, (tvi_run_plan){.h = 0.01, .steps = 5000}, 0);
    run("back", system, NULL, (tvi_run_plan){.h = -0.25, .t_end = -500.1, .has_t_end = true}, 0);
    run("to", system, NULL, (tvi_run_plan){.h = 0.25, .t_end = 500.1, .has_t_end = true}, 0);
    run("at", system, NULL, (tvi_run_plan){.h = 0.25, .times = times, .time_count = 6, .at_time = tell}, 0);
    run("at and to", system, NULL,
        (tvi_run_plan){.h = 0.25, .t_end = 500.1, .has_t_end = true, .times = times, .time_count = 6, .at_time = tell},
        0);
    run("events", system, NULL,
        (tvi_run_plan){.h = 0.25, .steps = 2000, .events = events, .event_count = 1, .on_event = tell}, 0);
    run("events to", system, NULL,
        (tvi_run_plan){.h = 0.25, .t_end = 99, .has_t_end = true, .events = events, .event_count = 1, .on_event = tell},
        0);
    run("tolerance", system, &taylor, (tvi_run_plan){.tolerance = 1e-12, .t_end = 30}, 0);
    run("tangent", system, NULL, (tvi_run_plan){.h = 0.25, .t_end = 20.1, .has_t_end = true, .D = D, .columns = 4}, 0);
    check(tvi_suggest_step(system, NULL, 0, q0, p0, 4000, 1e-8, &h));
    printf("suggested %a\n", h);
    check(tvi_compile(&code, system, &compiled, NULL));
    compiled.compiled = code;
    run("compiled", system, &compiled, (tvi_run_plan){.h = 0.25, .t_end = 500.1, .has_t_end = true}, 0);
    tvi_compiled_free(code);
    run_ensemble(system);

    check(tvi_system_rescaled(&other, system, NULL, NULL));
    run("rescaled", other, NULL, (tvi_run_plan){.h = 0.5, .t_end = 100.1, .has_t_end = true}, 0);
    tvi_system_free(other);
    check(tvi_system_rescaled(&other, system, scale, NULL));
    run("rescaled at", other, NULL, (tvi_run_plan){.h = 0.5, .times = times, .time_count = 6, .at_time = tell}, 0);
    tvi_system_free(other);
    check(tvi_system_driven(&other, system, friction, NULL));
    run("driven", other, NULL, (tvi_run_plan){.h = 0.25, .steps = 200}, 0);
    tvi_system_free(other);
    check(tvi_system_constrained(&other, system, 1, moving_line, NULL));
    run("constrained", other, NULL, (tvi_run_plan){.h = 0.02, .steps = 200}, 0);
    tvi_system_free(other);
    check(tvi_system_force(&other, 2, mass, pushed, NULL));
    run("force", other, NULL, (tvi_run_plan){.h = 0.25, .steps = 200}, 0);
    tvi_system_free(other);
    check(tvi_system_hamiltonian(&other, 1, coupled, NULL));
    run("hamiltonian", other, NULL, (tvi_run_plan){.h = 0.1, .steps = 200}, 0);
    run("parameter", other, NULL, (tvi_run_plan){.h = 0.1, .steps = 200}, 2.25);
    tvi_system_free(other);
    run_lagrangian();
    run_bodies();
    run_rigid();
    tvi_event_free(event);
    tvi_system_free(system);
}
