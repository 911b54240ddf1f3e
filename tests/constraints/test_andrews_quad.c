/* test_andrews_quad.c - Tests Andrews' squeezing mechanism, seven bodies with ten hinges in the plane (Hairer and
 * Wanner, Solving Ordinary Differential Equations II, VII.7; Test Set for IVP Solvers, "andrews"), as rigid bodies of
 * the library, and in the angles of the bodies in quadruple precision (gcc only). */
#include "constraints.h"
#include "references/quad.h"
#include "tvi_rigid.h"

#include <float.h>
#include <math.h>
#include <quadmath.h>
#include <string.h>

/* ---- The mechanism ----------------------------------------------------------------------------------------------- */

/* In units of 10 um, as decimal numbers; letters of the test set. */
#define LENGTH(digits) ((quad)(digits) / 1e5)
static const quad ra = LENGTH(92), rr = LENGTH(700), da = LENGTH(1150), d = LENGTH(2800), ss = LENGTH(3500),
                  sa = LENGTH(1874), sb = LENGTH(1043), sc = LENGTH(1800), sd = LENGTH(2000), e = LENGTH(2000),
                  ea = LENGTH(1421), zt = LENGTH(4000), ta = LENGTH(2308), tb = LENGTH(916), u = LENGTH(4000),
                  ua = LENGTH(1228), ub = LENGTH(449), zf = LENGTH(2000), fa = LENGTH(1421), l0 = LENGTH(7785);
static const quad A[] = {LENGTH(-6934), LENGTH(-227)}, B[] = {LENGTH(-3635), LENGTH(3273)},
                  C[] = {LENGTH(1400), LENGTH(7200)}, O[] = {0, 0};
static const quad torque = (quad)33 / 1000, stiffness = 4530;

/* Bodies 1 to 7 have the numbers 0 to 6. Their directions are at the angles beta, beta + Theta, gamma, Phi + delta,
 * delta, Omega + epsilon, epsilon. */
enum { BODIES = 7 };
static const quad mass[BODIES] = {LENGTH(4325), LENGTH(365), LENGTH(2373), LENGTH(706),
                                  LENGTH(7050), LENGTH(706), LENGTH(5498)};
static const quad inertia[BODIES] = {(quad)21940 / 1e10,  (quad)4410 / 1e10, (quad)52550 / 1e10, (quad)5667 / 1e10,
                                     (quad)116900 / 1e10, (quad)5667 / 1e10, (quad)191200 / 1e10};

/* A point: the fixed one and the arms of two bodies, X along the direction and Y across. */
typedef struct {
    const quad *from;
    struct {
        int body;
        quad X, Y;
    } arm[2];
} point;

/* The centres of mass, E as the end of bodies 2, 3, 4, 6, and the end D of the spring to C. */
enum { E_OF_2 = BODIES, E_OF_3, E_OF_4, E_OF_6, END_OF_SPRING, POINTS };
#define NO_ARM                                                                                                         \
    {                                                                                                                  \
        0, 0, 0                                                                                                        \
    }
static point points[POINTS];

static void set_points(void)
{
    const point of[] = {
        {O, {{0, ra, 0}, NO_ARM}},         {O, {{0, rr, 0}, {1, -da, 0}}}, {B, {{2, sb, -sa}, NO_ARM}},
        {A, {{4, zt, 0}, {3, 0, ea - e}}}, {A, {{4, ta, tb}, NO_ARM}},     {A, {{6, 0, -u}, {5, zf - fa, 0}}},
        {A, {{6, -ub, -ua}, NO_ARM}},      {O, {{0, rr, 0}, {1, -d, 0}}},  {B, {{2, 0, -ss}, NO_ARM}},
        {A, {{4, zt, 0}, {3, 0, -e}}},     {A, {{6, 0, -u}, {5, zf, 0}}},  {B, {{2, sd, -sc}, NO_ARM}},
    };
    memcpy(points, of, sizeof points);
}

/* ---- In angles --------------------------------------------------------------------------------------------------- */

enum { HINGES = 6, EQUATIONS = BODIES + HINGES, STATES = 2 * BODIES };

/* Where a point is, its derivatives by the angles, and its acceleration where none of the angles has one. */
typedef struct {
    quad x[2], by[2][BODIES], bias[2];
} place;

static place place_of(const point *p, const quad angle[], const quad rate[])
{
    place is = {.x = {p->from[0], p->from[1]}};
    for (int k = 0; k < 2; k++) {
        const int b = p->arm[k].body;
        const quad c = cosq(angle[b]), s = sinq(angle[b]);
        const quad arm[] = {p->arm[k].X * c - p->arm[k].Y * s, p->arm[k].X * s + p->arm[k].Y * c};
        is.by[0][b] -= arm[1], is.by[1][b] += arm[0];
        for (int i = 0; i < 2; i++) is.x[i] += arm[i], is.bias[i] -= arm[i] * rate[b] * rate[b];
    }
    return is;
}

/* E of body 2 is that of the bodies 3, 4 and 6. */
static void hinges(const quad angle[], const quad rate[], quad value[], quad G[][BODIES], quad bias[])
{
    const place of_2 = place_of(&points[E_OF_2], angle, rate);
    for (int k = 0; k < HINGES; k++) {
        const place other = place_of(&points[E_OF_3 + k / 2], angle, rate);
        value[k] = of_2.x[k % 2] - other.x[k % 2];
        bias[k] = of_2.bias[k % 2] - other.bias[k % 2];
        for (int b = 0; b < BODIES; b++) G[k][b] = of_2.by[k % 2][b] - other.by[k % 2][b];
    }
}

/* Adds the inertia of the centres of mass, and what they need to follow the bias. */
static void add_bodies(const quad angle[], const quad rate[], quad M[][EQUATIONS], quad force[])
{
    for (int b = 0; b < BODIES; b++) {
        const place centre = place_of(&points[b], angle, rate);
        M[b][b] += inertia[b];
        for (int x = 0; x < 2; x++)
            for (int i = 0; i < BODIES; i++) {
                force[i] -= mass[b] * centre.by[x][i] * centre.bias[x];
                for (int j = 0; j < BODIES; j++) M[i][j] += mass[b] * centre.by[x][i] * centre.by[x][j];
            }
    }
}

/* The rates of the angles and of their rates. */
static void slope(const quad y[], quad dy[])
{
    quad M[EQUATIONS][EQUATIONS] = {{0}}, right[EQUATIONS] = {torque}, G[HINGES][BODIES], value[HINGES], bias[HINGES];
    const quad *angle = y, *rate = y + BODIES;
    const place end = place_of(&points[END_OF_SPRING], angle, rate);
    const quad X = end.x[0] - C[0], Y = end.x[1] - C[1], length = sqrtq(X * X + Y * Y);
    for (int b = 0; b < BODIES; b++)
        right[b] -= stiffness * (length - l0) / length * (X * end.by[0][b] + Y * end.by[1][b]);
    add_bodies(angle, rate, M, right);
    hinges(angle, rate, value, G, bias);
    for (int k = 0; k < HINGES; k++) {
        right[BODIES + k] = -bias[k];
        for (int b = 0; b < BODIES; b++) M[BODIES + k][b] = M[b][BODIES + k] = G[k][b];
    }
    ck_assert(quad_solve(EQUATIONS, M[0], right));
    for (int b = 0; b < BODIES; b++) dy[b] = rate[b], dy[BODIES + b] = right[b];
}

/* The start, at rest: beta + Theta is beta, and the others follow from the hinges, beside the published digits. */
static void start_of_angles(quad y[])
{
    static const double near[] = {-0.0617138900142764, -0.0617138900142764, 0.455279819163070, 0.710033369709728,
                                  0.487364979543843,   1.00787905437893,    1.23054744454982};
    for (int b = 0; b < BODIES; b++) y[b] = near[b], y[BODIES + b] = 0;
    for (int round = 0; round < 4; round++) {
        quad J[BODIES * BODIES] = {0}, r[BODIES], G[HINGES][BODIES], bias[HINGES];
        hinges(y, y + BODIES, r, G, bias);
        memcpy(J, G, sizeof G);
        J[HINGES * BODIES] = 1, J[HINGES * BODIES + 1] = -1, r[HINGES] = y[0] - y[1];
        ck_assert(quad_solve(BODIES, J, r));
        for (int b = 0; b < BODIES; b++) y[b] -= r[b];
    }
}

/* A step of Gragg's midpoint rule, extrapolated from 2, 4, ... parts. */
enum { ROWS = 9 };
static void extrapolate(quad H, quad y[])
{
    quad T[ROWS][STATES], first[STATES], now[STATES], next[STATES], f[STATES];
    slope(y, first);
    for (int row = 0; row < ROWS; row++) {
        const int parts = 2 * (row + 1);
        const quad h = H / parts;
        for (int i = 0; i < STATES; i++) T[row][i] = y[i], now[i] = y[i] + h * first[i];
        for (int part = 1; part < parts; part++) {
            slope(now, f);
            for (int i = 0; i < STATES; i++) next[i] = T[row][i] + 2 * h * f[i];
            memcpy(T[row], now, sizeof now);
            memcpy(now, next, sizeof now);
        }
        slope(now, f);
        for (int i = 0; i < STATES; i++) T[row][i] = (T[row][i] + now[i] + h * f[i]) / 2;
        for (int j = row - 1; j >= 0; j--) {
            const quad ratio = (quad)(row + 1) / (j + 1), factor = ratio * ratio - 1;
            for (int i = 0; i < STATES; i++) T[j][i] = T[j + 1][i] + (T[j + 1][i] - T[j][i]) / factor;
        }
    }
    memcpy(y, T[0], sizeof T[0]);
}

/* ---- The end ----------------------------------------------------------------------------------------------------- */

/* beta, Theta, gamma, Phi, delta, Omega, epsilon at the end, and as they are published. */
static const double reference[BODIES] = {15.810771195153707097,   -15.756371058411839469, 0.040822240119645804858,
                                         -0.53473011634207959377, 0.52440996587995406935, 0.53473011634207959377,
                                         1.0480807410419378731};
static const double published[BODIES] = {15.81077119629904,   -15.75637105984298, 0.04082224013073101,
                                         -0.5347301163226948, 0.5244099658805304, 0.5347301163226948,
                                         1.048080741042263};

/* The angles of the test set from those of the bodies. */
static void relative(const quad absolute[], quad angle[])
{
    static const int base[] = {-1, 0, -1, 4, -1, 6, -1};
    for (int b = 0; b < BODIES; b++) angle[b] = absolute[b] - (base[b] < 0 ? 0 : absolute[base[b]]);
}

/* The reference is the double that is nearest to these angles. The published ones, which many compare with, are off
 * from the tenth digit on. */
START_TEST(angles)
{
    enum { STEPS = 150 };
    quad y[STATES], angle[BODIES];
    set_points();
    start_of_angles(y);
    for (int step = 0; step < STEPS; step++) extrapolate((quad)3 / 100 / STEPS, y);
    relative(y, angle);
    for (int b = 0; b < BODIES; b++)
        ck_assert_msg(fabsq(angle[b] - reference[b]) <= (quad)DBL_EPSILON / 2 * fabsq(angle[b]),
                      "angle %d: off by %.2e", b, (double)(angle[b] - reference[b]));
    ck_assert_double_gt(fabs(published[0] - reference[0]), 1e-9);
    ck_assert_double_gt(fabs(published[1] - reference[1]), 1e-9);
}
END_TEST

/* ---- Rigid bodies ------------------------------------------------------------------------------------------------ */

static tvi_rigid mechanism;

/* The torque on body 1, and the spring on body 3. */
static void forces(const jet q[], jet t, jet force[], void *ctx)
{
    const double X[2] = {(double)(sd - sb), (double)(sa - sc)};
    const jet turn[3] = {jet_const(0), jet_const(0), jet_const((double)torque)};
    jet x[2], F[2];
    (void)t, (void)ctx;
    for (int i = 0; i < tvi_rigid_dimension(&mechanism); i++) force[i] = jet_const(0);
    tvi_rigid_torque(&mechanism, q, 0, turn, force);
    tvi_rigid_point(&mechanism, q, 2, X, x);
    for (int i = 0; i < 2; i++) x[i] = jet_sub(x[i], (double)C[i]);
    const jet length = jet_sqrt(jet_dot(x, x, 2)),
              pull = jet_mul((double)-stiffness, jet_sub(1, jet_div((double)l0, length)));
    for (int i = 0; i < 2; i++) F[i] = jet_mul(pull, x[i]);
    tvi_rigid_force(&mechanism, q, 2, X, F, force);
}

#define AT(x, y)                                                                                                       \
    {                                                                                                                  \
        (double)(x), (double)(y)                                                                                       \
    }
static void set_mechanism(tvi_rigid_body body[], tvi_joint joint[])
{
    const struct {
        int body, other;
        double point[2], other_point[2];
    } hinge[] = {{0, TVI_WORLD, AT(-ra, 0), AT(0, 0)},
                 {1, 0, AT(da, 0), AT(rr - ra, 0)},
                 {2, TVI_WORLD, AT(-sb, sa), AT(B[0], B[1])},
                 {2, 1, AT(-sb, sa - ss), AT(da - d, 0)},
                 {4, TVI_WORLD, AT(-ta, -tb), AT(A[0], A[1])},
                 {3, 4, AT(0, e - ea), AT(zt - ta, -tb)},
                 {3, 1, AT(0, -ea), AT(da - d, 0)},
                 {6, TVI_WORLD, AT(ub, ua), AT(A[0], A[1])},
                 {5, 6, AT(fa - zf, 0), AT(ub, ua - u)},
                 {5, 1, AT(fa, 0), AT(da - d, 0)}};
    enum { JOINTS = sizeof hinge / sizeof *hinge };
    for (int b = 0; b < BODIES; b++) body[b] = (tvi_rigid_body){(double)mass[b], {0, 0, (double)inertia[b]}};
    for (int k = 0; k < JOINTS; k++) {
        joint[k] = (tvi_joint){.kind = TVI_BALL, .body = hinge[k].body, .other = hinge[k].other};
        memcpy(joint[k].point, hinge[k].point, sizeof hinge[k].point);
        memcpy(joint[k].other_point, hinge[k].other_point, sizeof hinge[k].other_point);
    }
    mechanism = (tvi_rigid){.bodies = BODIES, .axes = 2, .body = body, .joints = JOINTS, .joint = joint};
}

/* The largest error of an angle after these steps of order 16. */
static double error_of_steps(int steps)
{
    enum { N = 4 * BODIES, JOINTS = 10 };
    tvi_rigid_body body[BODIES];
    tvi_joint joint[JOINTS];
    tvi_system *base, *system;
    tvi_integrator *integrator;
    double t = 0, q[N], p[N], M[N], worst = 0;
    const double across[] = {0, 0, 1}, turn = 2 * acos(-1.0);
    quad y[STATES], absolute[BODIES], angle[BODIES];
    set_points();
    set_mechanism(body, joint);
    start_of_angles(y);
    for (int b = 0; b < BODIES; b++) {
        const place centre = place_of(&points[b], y, y + BODIES);
        tvi_rigid_motion motion = {.place = {(double)centre.x[0], (double)centre.x[1]}};
        tvi_rigid_turn(across, (double)y[b], motion.quaternion);
        ck_assert_int_eq(tvi_rigid_state(&mechanism, b, &motion, q, p), TVI_OK);
    }
    tvi_rigid_masses(&mechanism, M);
    ck_assert_int_eq(tvi_rigid_constraints(&mechanism), N - 1);
    ck_assert_int_eq(tvi_system_force(&base, N, M, forces, NULL), TVI_OK);
    ck_assert_int_eq(tvi_system_constrained(&system, base, N - 1, tvi_rigid_constraint, &mechanism), TVI_OK);
    ck_assert_int_eq(tvi_integrator_create(&integrator, system, NULL), TVI_OK);
    const tvi_status status = tvi_integrate(integrator, 0.03 / steps, steps, &t, q, p, NULL, NULL);
    ck_assert_msg(status == TVI_OK, "%s", tvi_last_error());
    for (int b = 0; b < BODIES; b++) absolute[b] = atan2(q[4 * b + 3], q[4 * b + 2]);
    relative(absolute, angle);
    for (int b = 0; b < BODIES; b++) worst = fmax(worst, fabs(remainder((double)angle[b] - reference[b], turn)));
    tvi_integrator_free(integrator);
    tvi_system_free(system);
    tvi_system_free(base);
    return worst;
}

/* Some units of roundoff of beta with 100 steps; 40 and 50 are too large by what the order says: (5/4)^16 = 36. */
START_TEST(rigid_bodies)
{
    const double errors[] = {error_of_steps(40), error_of_steps(50), error_of_steps(100)};
    ck_assert_double_le(errors[2], 16 * DBL_EPSILON * reference[0]);
    ck_assert_double_gt(errors[1], 1e-12);
    ck_assert_double_gt(errors[0] / errors[1], 36 / 1.5);
    ck_assert_double_le(errors[0], 1e-8);
}
END_TEST

Suite *suite_andrews_quad(void)
{
    Suite *suite = suite_create("andrews");
    TCase *tcase = tcase_create("end");
    tcase_add_test(tcase, angles);
    tcase_add_test(tcase, rigid_bodies);
    suite_add_tcase(suite, tcase);
    return suite;
}
