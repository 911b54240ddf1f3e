/* test_linkages.c - Tests rigid bodies with joints (tvi_rigid.h) against minimal coordinates and each other. Where
 * there is a bound, what is almost the same misses it. */
#include "constraints.h"
#include "rigid.h"

#include <math.h>
#include <string.h>

/* ---- The double pendulum ----------------------------------------------------------------------------------------- */

typedef struct {
    double mass[2], length[2], inertia_off;
} two_rods;

static const double DOWN = 9.75;

/* The angles from the vertical are q, and the velocities v. */
static jet lagrangian_of_rods(const jet q[], const jet v[], jet t, void *ctx)
{
    const two_rods *rods = ctx;
    const double m1 = rods->mass[0], m2 = rods->mass[1], l1 = rods->length[0], l2 = rods->length[1],
                 first = m1 * l1 * l1 / 3 + m2 * l1 * l1, second = m2 * l2 * l2 / 3 * (1 + rods->inertia_off);
    (void)t;
    const jet T = jet_add(jet_mul(0.5, jet_add(jet_mul(first, jet_sqr(v[0])), jet_mul(second, jet_sqr(v[1])))),
                          jet_mul(0.5 * m2 * l1 * l2, jet_mul(jet_mul(v[0], v[1]), jet_cos(jet_sub(q[0], q[1])))));
    return jet_add(
        T, jet_add(jet_mul((m1 / 2 + m2) * DOWN * l1, jet_cos(q[0])), jet_mul(m2 / 2 * DOWN * l2, jet_cos(q[1]))));
}

/* The end of the second rod at t = 2 by the angles. */
static void end_by_angles(const two_rods *rods, const double angle[2], const double speed[2], double x[2])
{
    tvi_system *system;
    tvi_integrator *integrator;
    double t = 0, q[2] = {angle[0], angle[1]}, p[2];
    ck_assert_int_eq(tvi_system_lagrangian(&system, 2, lagrangian_of_rods, (void *)rods), TVI_OK);
    ck_assert_int_eq(tvi_momentum(system, 0, q, speed, p), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, NULL), TVI_OK);
    ck_assert_int_eq(tvi_integrate(integrator, 0.01, 200, &t, q, p, NULL, NULL), TVI_OK);
    x[0] = rods->length[0] * sin(q[0]) + rods->length[1] * sin(q[1]);
    x[1] = -rods->length[0] * cos(q[0]) - rods->length[1] * cos(q[1]);
    tvi_integrator_free(integrator);
    tvi_system_free(system);
}

START_TEST(double_pendulum)
{
    two_rods rods = {{2, 0.75}, {1.25, 0.5}, 0};
    const double angle[2] = {1.5, 2}, speed[2] = {0.5, -1}, quarter = acos(-1.0) / 2, axis[3] = {0, 0, 1};
    const tvi_rigid_body body[2] = {tvi_rigid_rod(2, 1.25), tvi_rigid_rod(0.75, 0.5)};
    const tvi_joint joint[2] = {{.kind = TVI_BALL, .body = 0, .other = TVI_WORLD, .point = {-0.625}},
                                {.kind = TVI_HINGE, .body = 1, .other = 0, .point = {-0.25}, .other_point = {0.625}}};
    const tvi_rigid r = {2, 2, body, 2, joint, {0, -DOWN}};
    tvi_rigid_motion start[2] = {{.point = {-0.625}, .omega = {0, 0, 0.5}}, {.point = {-0.25}, .omega = {0, 0, -1}}};
    double wanted[2], x[2];
    tvi_rigid_turn(axis, angle[0] - quarter, start[0].quaternion);
    tvi_rigid_turn(axis, angle[1] - quarter, start[1].quaternion);
    start[1].place[0] = 1.25 * sin(1.5), start[1].place[1] = -1.25 * cos(1.5);
    start[1].velocity[0] = 0.5 * 1.25 * cos(1.5), start[1].velocity[1] = 0.5 * 1.25 * sin(1.5);
    rigid_run run = rigid_begin(&r, start, NULL);
    rigid_go_on(&run, 0.01, 200, NULL, NULL);
    tvi_rigid_place(&r, run.q, 1, (double[]){0.25, 0}, x);
    end_by_angles(&rods, angle, speed, wanted);
    expect_close("x", x[0], wanted[0], 2e-13);
    expect_close("y", x[1], wanted[1], 2e-13);
    rods.inertia_off = 1e-9;
    end_by_angles(&rods, angle, speed, wanted);
    ck_assert_msg(hypot(x[0] - wanted[0], x[1] - wanted[1]) > 1e-10, "the control is as good");
    rigid_end(&run);
}
END_TEST

/* ---- A hinge ----------------------------------------------------------------------------------------------------- */

/* A box on a hinge along no axis of it or of space: V = -m g . (along + cos across + sin (axis x across)). */
typedef struct {
    double cosine, sine; /* the parts of V */
} physical_pendulum;

static jet potential_of_pendulum(const jet q[], jet t, void *ctx)
{
    const physical_pendulum *V = ctx;
    (void)t;
    return jet_add(jet_mul(V->cosine, jet_cos(q[0])), jet_mul(V->sine, jet_sin(q[0])));
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

START_TEST(hinge_is_pendulum)
{
    const tvi_rigid_body box = tvi_rigid_box(2, 1, 0.5, 0.25);
    const double unit[3] = {2.0 / 7, 3.0 / 7, 6.0 / 7}, X[3] = {0.5, -0.25, 0.125}, speed = 1.5;
    tvi_joint joint = {.kind = TVI_HINGE, .body = 0, .other = TVI_WORLD, .other_point = {1, 2, 3}};
    const tvi_rigid r = {1, 3, &box, 1, &joint, {1, -9.75, 2}};
    tvi_rigid_motion start = {.place = {1, 2, 3}, .quaternion = {0.5, -0.25, 1, 0.75}};
    double arm[3], axis[3], back[3], side[3], inertia = 0, mass, q, p, t = 0;
    for (int k = 0; k < 3; k++) {
        back[k] = -X[k];
        joint.axis[k] = unit[k];
        joint.point[k] = start.point[k] = X[k];
        start.omega[k] = speed * unit[k];
        inertia += box.inertia[k] * unit[k] * unit[k];
    }
    turn_by(start.quaternion, unit, axis);
    turn_by(start.quaternion, back, arm);
    memcpy(joint.other_axis, axis, sizeof axis);
    const double along = dot(arm, axis);
    mass = inertia + box.mass * (dot(arm, arm) - along * along);
    for (int k = 0; k < 3; k++) side[k] = axis[(k + 1) % 3] * arm[(k + 2) % 3] - axis[(k + 2) % 3] * arm[(k + 1) % 3];
    for (int k = 0; k < 3; k++) arm[k] -= along * axis[k];
    for (int control = 0; control < 2; control++) {
        physical_pendulum V = {-box.mass * dot(r.gravity, arm), -box.mass * dot(r.gravity, side)};
        tvi_system *system;
        tvi_integrator *integrator;
        double error = 0;
        mass *= 1 + control * 1e-9;
        rigid_run run = rigid_begin(&r, &start, NULL);
        ck_assert_int_eq(tvi_system_potential(&system, 1, &mass, potential_of_pendulum, &V), TVI_OK);
        ck_assert_int_eq(tvi_integrator_create(&integrator, system, NULL), TVI_OK);
        q = 0, p = mass * speed, t = 0;
        for (int part = 0; part < 4; part++) {
            rigid_go_on(&run, 0.0625, 16, NULL, NULL);
            ck_assert_int_eq(tvi_integrate(integrator, 0.0625, 16, &t, &q, &p, NULL, NULL), TVI_OK);
            for (int k = 0; k < 3; k++)
                error = fmax(error, fabs(run.q[k] - (k + 1) - along * axis[k] - cos(q) * arm[k] - sin(q) * side[k]));
        }
        ck_assert_msg(control ? error > 1e-10 : error < 1e-13, "error %g", error);
        tvi_integrator_free(integrator);
        tvi_system_free(system);
        rigid_end(&run);
    }
}
END_TEST

/* A rod that is let go as it lies: the pin bears a quarter of its weight. */
START_TEST(force_of_joint)
{
    const tvi_rigid_body rod = tvi_rigid_rod(3, 2);
    const tvi_joint pin = {.kind = TVI_BALL, .body = 0, .other = TVI_WORLD, .point = {-1}};
    const tvi_rigid r = {1, 2, &rod, 1, &pin, {0, -8}};
    const tvi_rigid_motion start = {.point = {-1}};
    rigid_run run = rigid_begin(&r, &start, NULL);
    double lambda[3];
    ck_assert_int_eq(tvi_multipliers(run.system, 0, run.q, run.p, lambda, NULL), TVI_OK);
    expect_close("across", -lambda[tvi_rigid_joint(&r, 0)], 0, 1e-14);
    expect_close("a quarter", -lambda[tvi_rigid_joint(&r, 0) + 1], 6, 1e-14);
    rigid_end(&run);
}
END_TEST

/* ---- A linkage, and a torque ------------------------------------------------------------------------------------- */

/* A crank, a coupler and a rocker, in the plane with four hinges, and in space, where the last is a guide along the
 * axis of the others: four hinges would hold three freedoms twice. */
static rigid_run four_bar(int axes)
{
    static const double length[3] = {0.5, 1.5, 1}, turn[3] = {1.2, 0.4, 1.7}, z[3] = {0, 0, 1};
    static tvi_rigid_body bars[2][3];
    static tvi_joint joints[2][4];
    static tvi_rigid both[2];
    tvi_rigid_body *bar = bars[axes - 2];
    tvi_joint *joint = joints[axes - 2];
    tvi_rigid_motion start[3] = {{.omega = {0, 0, 2}}};
    double end_of[2] = {0, 0};
    for (int k = 0; k < 4; k++) {
        const double half = length[k < 3 ? k : 2] / 2;
        joint[k] =
            (tvi_joint){.kind = k < 3 ? TVI_HINGE : TVI_GUIDE, .body = k < 3 ? k : 2, .other = k % 3 ? k - 1 : -1};
        joint[k].axis[2] = joint[k].other_axis[2] = 1;
        joint[k].point[0] = k < 3 ? -half : half;
        joint[k].other_point[0] = k % 3 ? length[k - 1] / 2 : k ? 1.25 : 0;
        if (k == 3) break;
        bar[k] = tvi_rigid_box(k + 1, length[k], 0.125, 0.0625);
        start[k].point[0] = -half;
        memcpy(start[k].place, end_of, sizeof end_of);
        tvi_rigid_turn(z, turn[k], start[k].quaternion);
        end_of[0] += length[k] * cos(turn[k]), end_of[1] += length[k] * sin(turn[k]);
    }
    memcpy(joint[3].other_point, end_of, sizeof end_of);
    if (axes == 2) joint[3].kind = TVI_BALL;
    both[axes - 2] = (tvi_rigid){3, axes, bar, 4, joint, {0, -9.75, 0}};
    rigid_run run = {.r = &both[axes - 2]};
    ck_assert_int_eq(tvi_rigid_system(&run.system, run.r, NULL, NULL), TVI_OK);
    for (int b = 0; b < 3; b++) ck_assert_int_eq(tvi_rigid_state(run.r, b, &start[b], run.q, run.p), TVI_OK);
    const tvi_status status = tvi_project(run.system, 0, run.q, run.p); /* the crank turns all */
    ck_assert_msg(status == TVI_OK, "%s", tvi_last_error());
    ck_assert_int_eq(tvi_integrator_create(&run.integrator, run.system, NULL), TVI_OK);
    return run;
}

START_TEST(four_bar_linkage)
{
    rigid_run plane = four_bar(2), space = four_bar(3);
    const double X[3] = {0.25, 0.5, 0};
    double x[3], y[3], far = 0;
    const double H = rigid_energy_of(&plane);
    expect_close("energy", rigid_energy_of(&space), H, 4e-14 * H);
    for (int part = 0; part < 5; part++) {
        rigid_go_on(&plane, 0.02, 20, NULL, NULL);
        rigid_go_on(&space, 0.02, 20, NULL, NULL);
        tvi_rigid_place(plane.r, plane.q, 1, X, x);
        tvi_rigid_place(space.r, space.q, 1, X, y);
        for (int k = 0; k < 2; k++) expect_close("place", y[k], x[k], 4e-13);
        far = fmax(far, hypot(x[0] - 0.5, x[1] - 0.5));
    }
    ck_assert_msg(far > 0.25, "it hardly moves: %g", far);
    expect_close("energy", rigid_energy_of(&plane), H, 4e-14 * fabs(H));
    expect_close("energy", rigid_energy_of(&space), H, 4e-14 * fabs(H));
    rigid_end(&plane);
    rigid_end(&space);
}
END_TEST

/* A torque about the body's axis 2, and a force at its centre that bears it up, in a system made from a force. */
static void torque_and_force(const jet q[], jet t, jet force[], void *ctx)
{
    const double centre[3] = {0, 0, 0};
    jet torque[3], weight[3] = {jet_const(0), jet_const(0), jet_const(-6)};
    (void)t;
    for (int i = 0; i < 12; i++) force[i] = jet_const(0);
    for (int k = 0; k < 3; k++) torque[k] = jet_mul(3, q[9 + k]);
    tvi_rigid_torque(ctx, q, 0, torque, force);
    tvi_rigid_force(ctx, q, 0, centre, weight, force);
}

START_TEST(torque_in_system)
{
    const tvi_rigid_body body = {2, {1, 1.75, 2}};
    const tvi_rigid r = {.bodies = 1, .axes = 3, .body = &body};
    const tvi_rigid_motion start = {.quaternion = {1, 2, 3, 4}, .omega = {0, 0, 1}};
    rigid_run run = rigid_begin(&r, &start, NULL);
    tvi_system *free_system;
    double mass[12];
    rigid_end(&run);
    tvi_rigid_masses(&r, mass);
    ck_assert_int_eq(tvi_system_force(&free_system, 12, mass, torque_and_force, (void *)&r), TVI_OK);
    ck_assert_int_eq(tvi_system_constrained(&run.system, free_system, 6, tvi_rigid_constraint, (void *)&r), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&run.integrator, run.system, NULL), TVI_OK);
    rigid_go_on(&run, 0.125, 16, NULL, NULL);
    expect_close("omega", rigid_motion_of(&run, 0).omega[2], 1 + 3.0 / 2 * 2, 1e-13);
    expect_close("fall", rigid_motion_of(&run, 0).place[2], -3 * 2, 1e-14);
    tvi_system_free(free_system);
    rigid_end(&run);
}
END_TEST

Suite *suite_linkages(void)
{
    Suite *suite = suite_create("linkages");
    TCase *motions = tcase_create("linkages");
    tcase_add_test(motions, double_pendulum);
    tcase_add_test(motions, hinge_is_pendulum);
    tcase_add_test(motions, force_of_joint);
    tcase_add_test(motions, four_bar_linkage);
    tcase_add_test(motions, torque_in_system);
    suite_add_tcase(suite, motions);
    return suite;
}
