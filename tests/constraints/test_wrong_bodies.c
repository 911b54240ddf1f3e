/* test_wrong_bodies.c - Tests rigid bodies, joints and states that are refused: the text names what is wrong, and
 * nothing is made or written. */
#include "constraints.h"
#include "problems/refusals.h"
#include "rigid.h"

#include <limits.h>
#include <math.h>
#include <string.h>

static const tvi_rigid_body good[] = {{1, {1, 1, 1}}, {1, {0, 1, 1}}, {1, {0, 0, 0}}};
#define BODIES .bodies = 3, .axes = 3, .body = good
#define ONE(...)                                                                                                       \
    .bodies = 1, .axes = 3, .body = (const tvi_rigid_body[])                                                           \
    {                                                                                                                  \
        {                                                                                                              \
            __VA_ARGS__                                                                                                \
        }                                                                                                              \
    }
#define JOINT(...)                                                                                                     \
    BODIES, .joints = 1, .joint = (const tvi_joint[])                                                                  \
    {                                                                                                                  \
        {                                                                                                              \
            __VA_ARGS__                                                                                                \
        }                                                                                                              \
    }

static const struct {
    tvi_rigid rigid;
    tvi_status status;
    const char *text;
} rows[] = {
    {{.bodies = 1, .body = good}, TVI_EINVAL, "axes = 0 is not 2 or 3"},
    {{.bodies = 1, .axes = 1, .body = good}, TVI_EINVAL, "axes = 1 is not 2 or 3"},
    {{.axes = 3, .body = good}, TVI_EINVAL, "bodies = 0 is not from 1 to 3333"},
    {{.bodies = INT_MIN, .axes = 2, .body = good}, TVI_EINVAL, "bodies = -2147483648 is not"},
    {{.bodies = INT_MAX, .axes = 2, .body = good}, TVI_EINVAL, "bodies = 2147483647 is not"},
    {{.bodies = 1, .axes = 3}, TVI_EINVAL, "body is NULL"},
    {{BODIES, .joints = -1}, TVI_EINVAL, "joints = -1 is negative"},
    {{BODIES, .joints = 1}, TVI_EINVAL, "joint is NULL"},
    {{BODIES, .gravity = {0, NAN, 0}}, TVI_ENONFINITE, "gravity[1] = "},
    {{ONE(0, {1, 1, 1})}, TVI_EINVAL, "body[0].mass = 0 is not positive"},
    {{ONE(-2, {1, 1, 1})}, TVI_EINVAL, "body[0].mass = -2 is not positive"},
    {{ONE(NAN, {1, 1, 1})}, TVI_ENONFINITE, "body[0].mass = "},
    {{ONE(INFINITY, {1, 1, 1})}, TVI_ENONFINITE, "body[0].mass = inf is not finite"},
    {{ONE(1, {1, NAN, 1})}, TVI_ENONFINITE, "body[0].inertia[1] = "},
    {{ONE(1, {1, 1, INFINITY})}, TVI_ENONFINITE, "body[0].inertia[2] = inf"},
    {{ONE(1, {-1, 1, 1})}, TVI_EINVAL, "body[0].inertia[0] = -1 is negative"},
    {{ONE(1, {1, 1, 2.001})}, TVI_EINVAL, "body[0].inertia[2] = 2.001 is more than the sum of the other two, 2"},
    {{ONE(1, {1, 2 + 1e-13, 1})}, TVI_EINVAL, "body[0].inertia[1] = 2 is more than"},
    {{.bodies = 1, .axes = 2, .body = (const tvi_rigid_body[]){{1, {0, 0, -1}}}},
     TVI_EINVAL,
     "body[0].inertia[2] = -1"},
    {{JOINT(.kind = (tvi_joint_kind)6, .other = TVI_WORLD)}, TVI_EINVAL, "joint[0].kind = 6 is not a kind of joint"},
    {{JOINT(.kind = (tvi_joint_kind)-1, .other = TVI_WORLD)}, TVI_EINVAL, "joint[0].kind = -1 is not"},
    {{JOINT(.body = 3, .other = TVI_WORLD)}, TVI_EINVAL, "joint[0].body = 3 is not from 0 to 2, or TVI_WORLD"},
    {{JOINT(.body = 0, .other = -2)}, TVI_EINVAL, "joint[0].other = -2 is not"},
    {{JOINT(.body = 1, .other = 1)}, TVI_EINVAL, "joint[0] is of body 1 with itself"},
    {{JOINT(.body = -1, .other = -1)}, TVI_EINVAL, "joint[0] is of body -1 with itself"},
    {{JOINT(.other = -1, .point = {0, NAN})}, TVI_ENONFINITE, "joint[0].point[1] = "},
    {{JOINT(.other = -1, .other_point = {INFINITY})}, TVI_ENONFINITE, "joint[0].other_point[0] = inf"},
    {{JOINT(.kind = TVI_HINGE, .other = -1, .other_axis = {1})}, TVI_EINVAL, "joint[0].axis has the length 0"},
    {{JOINT(.kind = TVI_GUIDE, .other = -1)}, TVI_EINVAL, "joint[0].other_axis has the length 0"},
    {{JOINT(.kind = TVI_CROSS, .other = -1, .axis = {1}, .other_axis = {0, 0, NAN})},
     TVI_ENONFINITE,
     "joint[0].other_ax"},
    {{JOINT(.body = 1, .other = -1, .point = {0, 1})}, TVI_EINVAL, "joint[0].point[1] = 1 is off body 1, a line or a"},
    {{JOINT(.body = 0, .other = 2, .other_point = {1})},
     TVI_EINVAL,
     "joint[0].other_point[0] = 1 is off body 2, a line"},
    {{JOINT(.kind = TVI_HINGE, .body = 1, .other = -1, .axis = {0, 0, 1}, .other_axis = {0, 0, 1})},
     TVI_EINVAL,
     "joint[0].axis[2] = 1 is off body 1"},
    {{JOINT(.kind = TVI_GUIDE, .other = 1, .other_axis = {1})},
     TVI_EINVAL,
     "joint[0].other = 1, a line or a point, kn"},
    {{JOINT(.kind = TVI_ROD, .other = -1)}, TVI_EINVAL, "joint[0].length = 0 is not positive"},
    {{JOINT(.kind = TVI_ROD, .other = -1, .length = NAN)}, TVI_ENONFINITE, "joint[0].length = "},
};
enum { ROWS = sizeof rows / sizeof *rows };

static jet own_potential(const jet q[], jet t, void *ctx) { return jet_add(tvi_rigid_potential(q, t, ctx), q[0]); }
static jet plain(const jet q[], jet t, void *ctx) { return (void)t, (void)ctx, q[0]; }

START_TEST(bodies_and_joints)
{
    const tvi_rigid *r = &rows[_i].rigid;
    const tvi_rigid_motion motion = {0};
    tvi_system *system = (tvi_system *)-1, *constrained;
    double q[] = {7}, p[] = {7}, x[3] = {7};
    expect_refusal(rows[_i].text, tvi_rigid_check(r), rows[_i].status, rows[_i].text);
    expect_refusal(rows[_i].text, tvi_rigid_system(&system, r, NULL, NULL), rows[_i].status, rows[_i].text);
    ck_assert(!system);
    expect_refusal(rows[_i].text, tvi_rigid_state(r, 0, &motion, q, p), rows[_i].status, rows[_i].text);
    ck_assert_int_eq(tvi_rigid_dimension(r) + tvi_rigid_constraints(r), 0);
    ck_assert_int_eq(tvi_rigid_first(r, 0) + tvi_rigid_joint(r, 0), -2);
    tvi_rigid_masses(r, x);
    tvi_rigid_place(r, q, 0, motion.point, x);
    tvi_rigid_angular_momentum(r, q, p, x);
    ck_assert(q[0] == 7 && p[0] == 7 && x[0] == 7);
    ck_assert_int_eq(tvi_system_potential(&system, 6, NULL, own_potential, (void *)r), TVI_ENONFINITE);
    ck_assert_int_eq(tvi_system_potential(&system, 6, NULL, plain, NULL), TVI_OK);
    ck_assert_int_ne(tvi_system_constrained(&constrained, system, 1, tvi_rigid_constraint, (void *)r), TVI_OK);
    ck_assert(!constrained);
    tvi_system_free(system);
}
END_TEST

START_TEST(null_and_plates)
{
    tvi_system *system;
    expect_refusal("NULL", tvi_rigid_check(NULL), TVI_EINVAL, "r is NULL");
    expect_refusal("NULL", tvi_rigid_system(&system, NULL, NULL, NULL), TVI_EINVAL, "r is NULL");
    /* The sum of the other two, to roundoff: it is a plate, and what is a little less, too. */
    for (int sign = -1; sign <= 1; sign++) {
        const tvi_rigid_body plate = {1, {0.1, 0.2, 0.1 + 0.2 + sign * 1e-15}};
        const tvi_rigid r = {.bodies = 1, .axes = 3, .body = &plate};
        ck_assert_int_eq(tvi_rigid_dimension(&r), 9);
    }
}
END_TEST

/* Of body 0, of the line, and in the plane. */
START_TEST(states)
{
    const tvi_rigid space = {BODIES}, plane = {.bodies = 3, .axes = 2, .body = good};
    const struct {
        const tvi_rigid *r;
        int body;
        tvi_rigid_motion motion;
        tvi_status status;
        const char *text;
    } wrong[] = {{&space, 3, {.place = {0}}, TVI_EINVAL, "body = 3 is not from 0 to 2"},
                 {&space, -1, {.place = {0}}, TVI_EINVAL, "body = -1 is not"},
                 {&space, 0, {.place = {0, 0, NAN}}, TVI_ENONFINITE, "place[2] = "},
                 {&space, 0, {.velocity = {INFINITY}}, TVI_ENONFINITE, "velocity[0] = inf"},
                 {&space, 0, {.quaternion = {0, NAN}}, TVI_ENONFINITE, "quaternion[1] = "},
                 {&space, 0, {.omega = {0, NAN}}, TVI_ENONFINITE, "omega[1] = "},
                 {&space, 0, {.point = {0, NAN}}, TVI_ENONFINITE, "point[1] = "},
                 {&space, 1, {.point = {1, 0, 2}}, TVI_EINVAL, "point[2] = 2 is off body 1, a line"},
                 {&space, 2, {.point = {1}}, TVI_EINVAL, "point[0] = 1 is off body 2"},
                 {&plane, 0, {.place = {0, 0, 1}}, TVI_EINVAL, "place[2] = 1 is not in the plane"},
                 {&plane, 0, {.velocity = {0, 0, 1}}, TVI_EINVAL, "velocity[2] = 1 is not in the plane"},
                 {&plane, 0, {.quaternion = {1, 0.5}}, TVI_EINVAL, "quaternion[1] = 0.5 is not in the plane"},
                 {&plane, 0, {.quaternion = {1, 0, 0.5}}, TVI_EINVAL, "quaternion[2] = 0.5 is not in the plane"},
                 {&plane, 0, {.omega = {0, 2}}, TVI_EINVAL, "omega[1] = 2 is not in the plane"},
                 {&plane, 0, {.point = {0, 0, 1}}, TVI_EINVAL, "point[2] = 1 is not in the plane"}};
    for (size_t row = 0; row < sizeof wrong / sizeof *wrong; row++) {
        double q[21], p[21];
        for (int i = 0; i < 21; i++) q[i] = p[i] = 7;
        expect_refusal(wrong[row].text, tvi_rigid_state(wrong[row].r, wrong[row].body, &wrong[row].motion, q, p),
                       wrong[row].status, wrong[row].text);
        for (int i = 0; i < 21; i++) ck_assert(q[i] == 7 && p[i] == 7);
    }
    tvi_rigid_motion motion = {0}, before;
    double q[21] = {0}, p[21] = {0};
    expect_refusal("NULL", tvi_rigid_state(&space, 0, NULL, q, p), TVI_EINVAL, "motion is NULL");
    expect_refusal("NULL", tvi_rigid_of(&space, 0, q, NULL, &motion), TVI_EINVAL, "p is NULL");
    ck_assert_int_eq(tvi_rigid_state(&space, 0, &motion, q, p), TVI_OK);
    memset(&motion, 7, sizeof motion);
    memset(motion.point, 0, sizeof motion.point);
    before = motion;
    q[3] = 1.01;
    expect_refusal("long", tvi_rigid_of(&space, 0, q, p, &motion), TVI_EINVAL, "the directors 0 and 0 of body 0 have");
    q[3] = -1;
    expect_refusal("left", tvi_rigid_of(&space, 0, q, p, &motion), TVI_EINVAL, "the directors of body 0 are left-han");
    q[3] = 1, p[5] = NAN;
    expect_refusal("NaN", tvi_rigid_of(&space, 0, q, p, &motion), TVI_ENONFINITE, "p[5] is not finite");
    q[0] = INFINITY;
    expect_refusal("inf", tvi_rigid_of(&space, 0, q, p, &motion), TVI_ENONFINITE, "q[0] is not finite");
    ck_assert(!memcmp(&before, &motion, sizeof motion));
}
END_TEST

/* Two boxes on hinges whose axes are parallel, and a joint that says once more that one of them is: the projection, and
 * the start of a run, name its constraint. */
START_TEST(redundant_joint)
{
    const tvi_rigid_body box = tvi_rigid_box(1, 1, 0.1, 0.1), boxes[2] = {box, box};
    const tvi_joint joints[3] = {
        {TVI_HINGE, 0, TVI_WORLD, {-0.5}, {0}, {0, 0, 1}, {0, 0, 1}, 0},
        {TVI_HINGE, 1, 0, {-0.5}, {0.5}, {0, 0, 1}, {0, 0, 1}, 0},
        {.kind = TVI_CROSS, .body = 1, .other = TVI_WORLD, .axis = {0, 0, 1}, .other_axis = {1}}};
    for (int count = 2; count <= 3; count++) {
        const tvi_rigid r = {2, 3, boxes, count, joints, {0, -9.8, 0}};
        const tvi_rigid_motion start[2] = {{.point = {-0.5}}, {.place = {1}, .point = {-0.5}}};
        tvi_system *system;
        tvi_integrator *integrator;
        double q[24], p[24], t = 0;
        ck_assert_int_eq(tvi_rigid_system(&system, &r, NULL, NULL), TVI_OK);
        ck_assert_int_eq(tvi_integrator_create(&integrator, system, NULL), TVI_OK);
        for (int b = 0; b < 2; b++) ck_assert_int_eq(tvi_rigid_state(&r, b, &start[b], q, p), TVI_OK);
        const tvi_status wanted = count == 2 ? TVI_OK : TVI_ESINGULAR;
        expect_refusal("redundant", tvi_project(system, 0, q, p), wanted, "phi[22]");
        for (int b = 0; b < 2; b++) ck_assert_int_eq(tvi_rigid_state(&r, b, &start[b], q, p), TVI_OK);
        ck_assert_int_eq(tvi_rigid_joint(&r, 2), count == 2 ? -1 : 22);
        expect_refusal("redundant", tvi_step(integrator, 0.01, &t, q, p), wanted, "phi[22]");
        tvi_integrator_free(integrator);
        tvi_system_free(system);
    }
}
END_TEST

Suite *suite_wrong_bodies(void)
{
    Suite *suite = suite_create("wrong bodies");
    TCase *refusals = tcase_create("wrong bodies");
    tcase_add_loop_test(refusals, bodies_and_joints, 0, ROWS);
    tcase_add_test(refusals, null_and_plates);
    tcase_add_test(refusals, states);
    tcase_add_test(refusals, redundant_joint);
    suite_add_tcase(suite, refusals);
    return suite;
}
