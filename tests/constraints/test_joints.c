/* test_joints.c - Tests states, points, forces and joints of all kinds of rigid bodies (tvi_rigid.h) against formulas
 * of rotations, and what is refused. */
#include "problems/random.h"
#include "problems/refusals.h"
#include "rigid.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Bodies, plates across each axis, lines along each, points; in space and in the plane. */
static const struct {
    const char *name;
    int axes;
    tvi_rigid_body body;
    int n, m, along; /* `along`: a line's axis */
} kinds[] = {{"body", 3, {2, {1, 1.5, 2}}, 12, 6, -1},       {"plate 0", 3, {2, {3, 1, 2}}, 9, 3, -1},
             {"plate 1", 3, {3, {1, 3, 2}}, 9, 3, -1},       {"plate 2", 3, {0.5, {0.1, 0.2, 0.3}}, 9, 3, -1},
             {"plane body", 2, {2, {9, 9, 0.75}}, 4, 1, -1}, {"line 0", 3, {2, {0, 2, 2}}, 6, 1, 0},
             {"line 1", 3, {2, {2, 0, 2}}, 6, 1, 1},         {"line 2", 3, {2, {2, 2, 0}}, 6, 1, 2},
             {"point", 3, {2, {0, 0, 0}}, 3, 0, 3},          {"plane point", 2, {2, {9, 9, 0}}, 2, 0, 3}};
enum { KINDS = sizeof kinds / sizeof *kinds, EXTENDED = 5, REPEATS = 200 };

/* ---- States ------------------------------------------------------------------------------------------------------ */

static void set_random(uint64_t *bits, int count, double x[])
{
    for (int i = 0; i < count; i++) x[i] = 2 * number_of(bits) - 1;
}

/* A state that the kind can have: no turning about a line, and all in the plane. */
static tvi_rigid_motion random_motion(int kind, uint64_t *bits)
{
    tvi_rigid_motion motion = {0};
    const int axes = kinds[kind].axes, along = kinds[kind].along;
    set_random(bits, axes, motion.place);
    set_random(bits, axes, motion.velocity);
    set_random(bits, 4, motion.quaternion);
    set_random(bits, 3, motion.omega);
    set_random(bits, axes, motion.point);
    if (axes == 2) motion.quaternion[1] = motion.quaternion[2] = motion.omega[0] = motion.omega[1] = 0;
    for (int k = 0; k < 3 && along >= 0; k++) {
        if (k != along) motion.point[k] = 0;
        if (k == along || along == 3) motion.omega[k] = 0;
    }
    return motion;
}

/* The rotation of a quaternion of any length, as textbooks have it. */
void turn_by(const double quaternion[4], const double X[3], double x[3])
{
    const double w = quaternion[0], a = quaternion[1], b = quaternion[2], c = quaternion[3],
                 size = w * w + a * a + b * b + c * c;
    const double R[3][3] = {{w * w + a * a - b * b - c * c, 2 * (a * b - w * c), 2 * (a * c + w * b)},
                            {2 * (a * b + w * c), w * w - a * a + b * b - c * c, 2 * (b * c - w * a)},
                            {2 * (a * c - w * b), 2 * (b * c + w * a), w * w - a * a - b * b + c * c}};
    for (int i = 0; i < 3; i++) x[i] = (R[i][0] * X[0] + R[i][1] * X[1] + R[i][2] * X[2]) / size;
}

static tvi_rigid alone(int kind) { return (tvi_rigid){1, kinds[kind].axes, &kinds[kind].body, 0, NULL, {0, 0, 0}}; }

/* A state becomes q and p and is found again; a line's by its q and p, as nobody knows how it is turned about itself.
 */
START_TEST(round_trips)
{
    const tvi_rigid r = alone(_i);
    uint64_t bits = 7;
    ck_assert_int_eq(tvi_rigid_dimension(&r), kinds[_i].n);
    ck_assert_int_eq(tvi_rigid_constraints(&r), kinds[_i].m);
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        const tvi_rigid_motion motion = random_motion(_i, &bits);
        tvi_rigid_motion found = {.point = {motion.point[0], motion.point[1], motion.point[2]}};
        double q[12], p[12], again_q[12], again_p[12], size = 0, cosine = 0;
        ck_assert_int_eq(tvi_rigid_state(&r, 0, &motion, q, p), TVI_OK);
        ck_assert_int_eq(tvi_rigid_of(&r, 0, q, p, &found), TVI_OK);
        ck_assert(found.quaternion[0] >= 0);
        for (int k = 0; k < 3; k++) {
            expect_close(kinds[_i].name, found.place[k], motion.place[k], 1e-15);
            expect_close(kinds[_i].name, found.velocity[k], motion.velocity[k], 1e-14);
            if (kinds[_i].along < 0) expect_close(kinds[_i].name, found.omega[k], motion.omega[k], 1e-14);
        }
        for (int k = 0; k < 4; k++) {
            cosine += found.quaternion[k] * motion.quaternion[k];
            size += motion.quaternion[k] * motion.quaternion[k];
        }
        if (kinds[_i].along < 0) expect_close(kinds[_i].name, fabs(cosine) / sqrt(size), 1, 1e-15);
        ck_assert_int_eq(tvi_rigid_state(&r, 0, &found, again_q, again_p), TVI_OK);
        for (int i = 0; i < kinds[_i].n; i++) {
            expect_close(kinds[_i].name, again_q[i], q[i], 4e-15);
            expect_close(kinds[_i].name, again_p[i], p[i], 2e-14);
        }
    }
}
END_TEST

/* Half turns, of which three of four numbers are 0, and a line that points against its axis. */
START_TEST(half_turns)
{
    for (int kind = 0; kind < KINDS; kind++)
        for (int k = 0; k < 4; k++) {
            const tvi_rigid r = alone(kind);
            tvi_rigid_motion motion = {0}, found = {0};
            double q[12], p[12], again[12];
            motion.quaternion[k] = -3;
            if (r.axes == 2 && (k == 1 || k == 2)) continue;
            ck_assert_int_eq(tvi_rigid_state(&r, 0, &motion, q, p), TVI_OK);
            ck_assert_int_eq(tvi_rigid_of(&r, 0, q, p, &found), TVI_OK);
            ck_assert_int_eq(tvi_rigid_state(&r, 0, &found, again, p), TVI_OK);
            for (int i = 0; i < kinds[kind].n; i++) expect_close(kinds[kind].name, again[i], q[i], 1e-15);
        }
}
END_TEST

/* Places of points, energy and angular momentum by the formulas of rigid bodies, and the constraints, which hold. */
START_TEST(formulas)
{
    const tvi_rigid r = alone(_i);
    const double *I = kinds[_i].body.inertia, mass = kinds[_i].body.mass;
    uint64_t bits = 11;
    tvi_system *system;
    ck_assert_int_eq(tvi_rigid_system(&system, &r, NULL, NULL), TVI_OK);
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        tvi_rigid_motion motion = random_motion(_i, &bits);
        double q[12], p[12], at[3] = {0}, arm[3], H, L[3], own[3], of_omega[3], value[6], rate[6];
        double centre[3], v[3] = {0}, wanted = 0;
        ck_assert_int_eq(tvi_rigid_state(&r, 0, &motion, q, p), TVI_OK);
        tvi_rigid_place(&r, q, 0, motion.point, at);
        turn_by(motion.quaternion, motion.point, arm);
        for (int k = 0; k < r.axes; k++) {
            expect_close(kinds[_i].name, at[k], motion.place[k], 2e-15);
            expect_close(kinds[_i].name, q[k], motion.place[k] - arm[k], 2e-15);
        }
        if (kinds[_i].m) ck_assert_int_eq(tvi_constraint_values(system, 0, q, p, value, rate), TVI_OK);
        for (int k = 0; k < kinds[_i].m; k++) {
            expect_close(kinds[_i].name, value[k], 0, 1e-15);
            expect_close(kinds[_i].name, rate[k], 0, 2e-15);
        }
        memset(motion.point, 0, sizeof motion.point); /* From here on the place and velocity of the centre. */
        ck_assert_int_eq(tvi_rigid_of(&r, 0, q, p, &motion), TVI_OK);
        memcpy(centre, motion.place, sizeof centre);
        memcpy(v, motion.velocity, sizeof v);
        for (int k = 0; k < 3; k++) {
            own[k] = (r.axes == 2 && k < 2 ? 0 : I[k]) * motion.omega[k];
            wanted += (mass * v[k] * v[k] + own[k] * motion.omega[k]) / 2;
        }
        turn_by(motion.quaternion, own, of_omega);
        ck_assert_int_eq(tvi_energy(system, 0, q, p, &H), TVI_OK);
        expect_close(kinds[_i].name, H, wanted, 4e-14);
        tvi_rigid_angular_momentum(&r, q, p, L);
        for (int k = 0; k < 3; k++) {
            const int a = (k + 1) % 3, b = (k + 2) % 3;
            expect_close(kinds[_i].name, L[k], of_omega[k] + mass * (centre[a] * v[b] - centre[b] * v[a]), 4e-14);
        }
    }
    tvi_system_free(system);
}
END_TEST

/* A force at a point and a torque do the work of the motion. */
START_TEST(work_of_forces)
{
    const tvi_rigid r = alone(_i);
    uint64_t bits = 13;
    double mass[12];
    tvi_rigid_masses(&r, mass);
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        const tvi_rigid_motion motion = random_motion(_i, &bits);
        double q[12], p[12], number[6], omega[3], of_force = 0, of_torque = 0, wanted[2] = {0};
        jet x[12], force[12], by_torque[12], F[3], T[3];
        ck_assert_int_eq(tvi_rigid_state(&r, 0, &motion, q, p), TVI_OK);
        set_random(&bits, 6, number);
        turn_by(motion.quaternion, motion.omega, omega);
        for (int i = 0; i < kinds[_i].n; i++) x[i] = jet_const(q[i]), force[i] = by_torque[i] = jet_const(0);
        for (int k = 0; k < 3; k++) {
            F[k] = jet_const(number[k]), T[k] = jet_const(number[3 + k]);
            wanted[0] += k < r.axes ? number[k] * motion.velocity[k] : 0;
            wanted[1] += number[3 + k] * omega[k];
        }
        tvi_rigid_force(&r, x, 0, motion.point, F, force);
        tvi_rigid_torque(&r, x, 0, T, by_torque);
        for (int i = 0; i < kinds[_i].n; i++) {
            of_force += force[i].number * p[i] / mass[i];
            of_torque += by_torque[i].number * p[i] / mass[i];
        }
        expect_close(kinds[_i].name, of_force, wanted[0], 1e-14);
        expect_close(kinds[_i].name, of_torque, wanted[1], 1e-14);
    }
}
END_TEST

START_TEST(shapes)
{
    const struct {
        tvi_rigid_body body;
        double inertia[3];
    } rows[] = {{tvi_rigid_sphere(3, 2), {4.8, 4.8, 4.8}},
                {tvi_rigid_box(12, 1, 2, 3), {13, 10, 5}},
                {tvi_rigid_cylinder(12, 1, 2), {7, 7, 6}},
                {tvi_rigid_disc(12, 1), {3, 3, 6}},
                {tvi_rigid_rod(12, 2), {0, 4, 4}}};
    for (size_t row = 0; row < sizeof rows / sizeof *rows; row++)
        for (int k = 0; k < 3; k++) expect_close("inertia", rows[row].body.inertia[k], rows[row].inertia[k], 4e-15);
    const double axis[3] = {0, 3, 4}, X[3] = {1, 0, 0};
    double quaternion[4], x[3];
    tvi_rigid_turn(axis, acos(-1.0) / 2, quaternion); /* e_0 turns to axis x e_0 */
    turn_by(quaternion, X, x);
    for (int k = 0; k < 3; k++) expect_close("turned", x[k], (double[]){0, 0.8, -0.6}[k], 1e-15);
}
END_TEST

/* ---- Joints ------------------------------------------------------------------------------------------------------ */

static const struct {
    const char *name;
    int in_space, in_plane;
} joints[] = {{"ball", 3, 2}, {"hinge", 5, 2}, {"guide", 2, 1}, {"slider", 4, 2}, {"rod", 1, 1}, {"cross", 1, 1}};
enum { JOINTS = sizeof joints / sizeof *joints, OTHERS = EXTENDED + 1 };

/* Two bodies, or one and the world, with a joint that their states satisfy: both are turned in the same way. */
typedef struct {
    tvi_rigid_body body[2];
    tvi_joint joint;
    tvi_rigid_motion motion[2];
    tvi_rigid rigid;
} pair_of_bodies;

static void set_pair(pair_of_bodies *pair, tvi_joint_kind joint, int one, int other, uint64_t *bits)
{
    const int axes = kinds[one].axes, is_world = other == EXTENDED;
    const double *quaternion = pair->motion[1].quaternion;
    double across[3], length = 0;
    memset(pair, 0, sizeof *pair);
    pair->body[0] = kinds[one].body;
    pair->body[1] = kinds[is_world ? one : other].body;
    pair->rigid = (tvi_rigid){is_world ? 1 : 2, axes, pair->body, 1, &pair->joint, {0.3, -0.4, axes == 3 ? 0.5 : 0}};
    pair->joint = (tvi_joint){.kind = joint, .body = 0, .other = is_world ? TVI_WORLD : 1};
    for (int k = 0; k < 2; k++) pair->motion[k] = random_motion(k ? (is_world ? one : other) : one, bits);
    memset(pair->motion[1].point, 0, sizeof pair->motion[1].point);
    if (is_world) pair->motion[1] = (tvi_rigid_motion){.quaternion = {1}};
    memcpy(pair->motion[0].quaternion, quaternion, sizeof pair->motion[0].quaternion);
    memcpy(pair->joint.point, pair->motion[0].point, sizeof pair->joint.point);
    set_random(bits, axes, pair->joint.other_point);
    set_random(bits, axes, pair->joint.axis);
    memcpy(pair->joint.other_axis, pair->joint.axis, sizeof pair->joint.axis);
    if (joint == TVI_CROSS) {
        const double *u = pair->joint.axis;
        memcpy(pair->joint.other_axis, (double[]){-3 * u[1], 3 * u[0], 0}, sizeof pair->joint.axis);
    }
    turn_by(quaternion, pair->joint.other_point, pair->motion[0].place);
    turn_by(quaternion, joint == TVI_ROD ? pair->joint.other_point : pair->joint.axis, across);
    for (int k = 0; k < axes; k++) {
        pair->motion[0].place[k] += pair->motion[1].place[k];
        if (joint != TVI_BALL && joint != TVI_HINGE) pair->motion[0].place[k] += 1.5 * across[k];
        length += 2.25 * across[k] * across[k];
    }
    pair->joint.length = sqrt(length);
}

/* The joint has its number of constraints, which hold where they should, do not depend on the others, and are those
 * that a point or an axis elsewhere breaks; and a run keeps the energy. */
static void check_joint(tvi_joint_kind joint, int one, int other)
{
    uint64_t bits = 17 + (uint64_t)one;
    pair_of_bodies pair;
    tvi_system *system, *shifted;
    tvi_integrator *integrator;
    char name[64];
    double q[24], p[24], value[24], rate[24], t = 0, before, after;
    (void)snprintf(name, sizeof name, "%s of %s and %s", joints[joint].name, kinds[one].name,
                   other == EXTENDED ? "the world" : kinds[other].name);
    set_pair(&pair, joint, one, other, &bits);
    const tvi_rigid *r = &pair.rigid;
    const int count = r->axes == 3 ? joints[joint].in_space : joints[joint].in_plane,
              first = kinds[one].m + (other == EXTENDED ? 0 : kinds[other].m), m = first + count;
    ck_assert_int_eq(tvi_rigid_constraints(r), m);
    ck_assert_int_eq(tvi_rigid_joint(r, 0), first);
    ck_assert_int_eq(tvi_rigid_system(&system, r, NULL, NULL), TVI_OK);
    for (int b = 0; b < r->bodies; b++) ck_assert_int_eq(tvi_rigid_state(r, b, &pair.motion[b], q, p), TVI_OK);
    ck_assert_int_eq(tvi_constraint_values(system, 0, q, p, value, rate), TVI_OK);
    for (int k = 0; k < m; k++) expect_close(name, value[k], 0, 4e-15);
    ck_assert_msg(tvi_project(system, 0, q, p) == TVI_OK, "%s: %s", name, tvi_last_error());
    pair.joint.other_point[0] += 0.125;
    pair.joint.other_axis[0] += 0.125;
    ck_assert_int_eq(tvi_rigid_system(&shifted, r, NULL, NULL), TVI_OK);
    ck_assert_int_eq(tvi_constraint_values(shifted, 0, q, p, value, rate), TVI_OK);
    for (int k = 0; k < first; k++) expect_close(name, value[k], 0, 4e-15);
    for (int k = first; k < m; k++) rate[0] = k == first ? fabs(value[k]) : rate[0] + fabs(value[k]);
    ck_assert_msg(rate[0] > 1e-3, "%s: nothing holds it", name);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, NULL), TVI_OK);
    ck_assert_int_eq(tvi_energy(system, 0, q, p, &before), TVI_OK);
    const tvi_status status = tvi_integrate(integrator, 0.02, 20, &t, q, p, NULL, NULL);
    ck_assert_msg(status == TVI_OK, "%s: %s", name, tvi_last_error());
    ck_assert_int_eq(tvi_energy(system, t, q, p, &after), TVI_OK);
    expect_close(name, after, before, 1e-12);
    tvi_integrator_free(integrator);
    tvi_system_free(shifted);
    tvi_system_free(system);
}

START_TEST(each_joint)
{
    const tvi_joint_kind joint = (tvi_joint_kind)_i;
    for (int one = 0; one < EXTENDED; one++)
        for (int other = 0; other < OTHERS; other++)
            if (other == EXTENDED || kinds[one].axes == kinds[other].axes) check_joint(joint, one, other);
}
END_TEST

/* A chain, whose joints stand behind the later of their bodies, and whose points have no directors. */
START_TEST(order_of_constraints)
{
    const tvi_rigid_body body[3] = {{1, {1, 1, 1}}, {1, {0, 0, 0}}, {1, {0, 1, 1}}};
    const tvi_joint chain[4] = {{.kind = TVI_ROD, .body = 2, .other = 1, .length = 1},
                                {.kind = TVI_HINGE, .body = TVI_WORLD, .other = 0, .axis = {1}, .other_axis = {1}},
                                {.kind = TVI_BALL, .body = 1, .other = 0},
                                {.kind = TVI_ROD, .body = 0, .other = 2, .length = 1}};
    const tvi_rigid r = {3, 3, body, 4, chain, {0, 0, 0}};
    ck_assert_int_eq(tvi_rigid_joint(&r, 1), 6);
    ck_assert_int_eq(tvi_rigid_joint(&r, 2), 11);
    ck_assert_int_eq(tvi_rigid_joint(&r, 0), 15);
    ck_assert_int_eq(tvi_rigid_joint(&r, 3), 16);
    ck_assert_int_eq(tvi_rigid_joint(&r, 4), -1);
    ck_assert_int_eq(tvi_rigid_constraints(&r), 17);
    ck_assert_int_eq(tvi_rigid_first(&r, 1), 12);
    ck_assert_int_eq(tvi_rigid_first(&r, 2), 15);
    ck_assert_int_eq(tvi_rigid_first(&r, 3), -1);
    ck_assert_int_eq(tvi_rigid_dimension(&r), 21);
}
END_TEST

/* Far from the origin: places are subtracted before arms are added. */
START_TEST(far_from_origin)
{
    const double far = 0x1p20;
    const tvi_rigid_body plate[2] = {{1, {0, 0, 1}}, {1, {0, 0, 1}}};
    for (int other = TVI_WORLD; other <= 1; other++)
        for (int swapped = 0; swapped < 2; swapped++) {
            const tvi_joint joint = {.body = swapped ? other : 0,
                                     .other = swapped ? 0 : other,
                                     .point = {swapped && other < 0 ? far : 0.1},
                                     .other_point = {!swapped && other < 0 ? far : 0.1}};
            const tvi_rigid r = {2, 2, plate, 1, &joint, {0, 0, 0}};
            const tvi_rigid_motion start[2] = {{.place = {far - 0.1}}, {.place = {far + 0.3}}};
            double q[8], p[8], value[4], rate[4];
            tvi_system *system;
            if (other == 0) continue;
            ck_assert_int_eq(tvi_rigid_system(&system, &r, NULL, NULL), TVI_OK);
            for (int b = 0; b < 2; b++) ck_assert_int_eq(tvi_rigid_state(&r, b, &start[b], q, p), TVI_OK);
            ck_assert_int_eq(tvi_constraint_values(system, 0, q, p, value, rate), TVI_OK);
            const double apart = other < 0 ? q[0] - far + 0.1 : q[0] - q[4];
            expect_close("far", value[tvi_rigid_joint(&r, 0)], swapped ? -apart : apart, 1e-16);
            tvi_system_free(system);
        }
}
END_TEST

/* A spring from a point of a body to a place, beside gravity. */
typedef struct {
    const tvi_rigid *r;
    const double *X;
} spring;

static jet potential_of_spring(const jet q[], jet t, void *ctx)
{
    const spring *s = ctx;
    jet x[3], to[3];
    (void)t;
    tvi_rigid_point(s->r, q, 0, s->X, x);
    tvi_rigid_point(s->r, q, TVI_WORLD, (double[]){0.5, 0.25, -1}, to);
    for (int k = 0; k < s->r->axes; k++) x[k] = jet_sub(x[k], to[k]);
    return jet_mul(1.5, jet_dot(x, x, s->r->axes));
}

START_TEST(springs)
{
    tvi_rigid r = alone(_i);
    uint64_t bits = 19;
    const tvi_rigid_motion motion = random_motion(_i, &bits);
    const spring s = {&r, motion.point};
    double q[12], p[12], H, free_H, wanted = 0;
    tvi_system *system, *free_system;
    ck_assert_int_eq(tvi_rigid_system(&free_system, &r, NULL, NULL), TVI_OK);
    r.gravity[0] = 3, r.gravity[1] = -2, r.gravity[2] = r.axes == 3;
    ck_assert_int_eq(tvi_rigid_system(&system, &r, potential_of_spring, (void *)&s), TVI_OK);
    ck_assert_int_eq(tvi_rigid_state(&r, 0, &motion, q, p), TVI_OK);
    ck_assert_int_eq(tvi_energy(system, 0, q, p, &H), TVI_OK);
    ck_assert_int_eq(tvi_energy(free_system, 0, q, p, &free_H), TVI_OK);
    for (int k = 0; k < r.axes; k++)
        wanted += 1.5 * pow(motion.place[k] - (double[]){0.5, 0.25, -1}[k], 2) - r.body->mass * r.gravity[k] * q[k];
    expect_close(kinds[_i].name, H - free_H, wanted, 4e-14);
    tvi_system_free(free_system);
    tvi_system_free(system);
}
END_TEST

Suite *suite_joints(void)
{
    Suite *suite = suite_create("joints");
    TCase *states = tcase_create("states of bodies");
    tcase_add_loop_test(states, round_trips, 0, KINDS);
    tcase_add_test(states, half_turns);
    tcase_add_loop_test(states, formulas, 0, KINDS);
    tcase_add_loop_test(states, work_of_forces, 0, KINDS);
    tcase_add_test(states, shapes);
    suite_add_tcase(suite, states);
    TCase *of_joints = tcase_create("joints");
    tcase_add_loop_test(of_joints, each_joint, 0, JOINTS);
    tcase_add_test(of_joints, order_of_constraints);
    tcase_add_test(of_joints, far_from_origin);
    tcase_add_loop_test(of_joints, springs, 0, KINDS);
    suite_add_tcase(suite, of_joints);
    return suite;
}
