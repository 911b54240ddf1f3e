/* test_rigid.c - Tests motions of rigid bodies (tvi_rigid.h) against closed forms: Euler's top, Dzhanibekov's wing nut,
 * the heavy top. Each bound has a control beside it: what is almost the same misses it. */
#include "constraints.h"
#include "rigid.h"

#include <math.h>
#include <string.h>

/* ---- Jacobi's elliptic functions --------------------------------------------------------------------------------- */

/* sn, cn and dn of u, and the quarter period K, for the parameter m = k^2 < 1, by the arithmetic-geometric mean. */
static long double jacobi(long double u, long double m, long double *sn, long double *cn, long double *dn)
{
    enum { ROUNDS = 8 };
    long double a[ROUNDS + 1] = {1}, c[ROUNDS + 1] = {sqrtl(m)}, b = sqrtl(1 - m);
    for (int i = 0; i < ROUNDS; i++) {
        a[i + 1] = (a[i] + b) / 2;
        c[i + 1] = (a[i] - b) / 2;
        b = sqrtl(a[i] * b);
    }
    const long double K = acosl(-1) / (2 * a[ROUNDS]);
    long double phi = ldexpl(a[ROUNDS] * u, ROUNDS);
    for (int i = ROUNDS; i > 0; i--) phi = (phi + asinl(c[i] / a[i] * sinl(phi))) / 2;
    *sn = sinl(phi);
    *cn = cosl(phi);
    *dn = sqrtl(1 - m * *sn * *sn);
    return K;
}

/* ---- Euler's top ------------------------------------------------------------------------------------------------- */

/* I_1 < I_2 < I_3, and the angular velocity (omega1, 0, omega3) at t = 0, with L^2 > 2 E I_2. */
typedef struct {
    double I[3], omega1, omega3;
} euler_top;

/* omega at the time t, the period of it, and by what angle the top turns about L in a period. */
static void solve_euler(const euler_top *top, double t, long double omega[3], long double *period, long double *turn)
{
    enum { POINTS = 200 };
    const long double a = top->I[0], b = top->I[1], c = top->I[2], w1 = top->omega1, w3 = top->omega3,
                      twice_E = a * w1 * w1 + c * w3 * w3, L2 = a * a * w1 * w1 + c * c * w3 * w3,
                      small = twice_E * c - L2, large = L2 - twice_E * a, m = (b - a) * small / ((c - b) * large),
                      rate = sqrtl((c - b) * large / (a * b * c));
    long double sn, cn, dn;
    *period = 4 * jacobi(0, m, &sn, &cn, &dn) / rate;
    *turn = 0;
    for (int i = 0; i <= POINTS; i++) {
        (void)jacobi(rate * (i < POINTS ? *period * i / POINTS : t), m, &sn, &cn, &dn);
        omega[0] = sqrtl(small / (a * (c - a))) * cn;
        omega[1] = sqrtl(small / (b * (c - b))) * sn;
        omega[2] = sqrtl(large / (c * (c - a))) * dn;
        const long double across = a * omega[0] * omega[0] + b * omega[1] * omega[1],
                          squares = a * a * omega[0] * omega[0] + b * b * omega[1] * omega[1];
        if (i < POINTS) *turn += sqrtl(L2) * across / squares * *period / POINTS;
    }
}

/* How far the top is from the solution: omega at some times, and the turn about L after a period. */
static double error_of_euler(const euler_top *top, double inertia_off)
{
    const tvi_rigid_body body = {1, {top->I[0], top->I[1], top->I[2] * (1 + inertia_off)}};
    const tvi_rigid r = {.bodies = 1, .axes = 3, .body = &body};
    const tvi_rigid_motion start = {.omega = {top->omega1, 0, top->omega3}};
    rigid_run run = rigid_begin(&r, &start, NULL);
    long double omega[3], period, turn;
    double error = 0, L[3], size, quaternion[4], cosine = 0;
    solve_euler(top, 0, omega, &period, &turn);
    tvi_rigid_angular_momentum(&r, run.q, run.p, L);
    for (int part = 1; part <= 4; part++) {
        rigid_go_on(&run, (double)period / 40, 10, NULL, NULL);
        const tvi_rigid_motion motion = rigid_motion_of(&run, 0);
        solve_euler(top, run.t, omega, &period, &turn);
        for (int k = 0; k < 3; k++) error = fmax(error, fabs(motion.omega[k] - (double)omega[k]));
    }
    const tvi_rigid_motion motion = rigid_motion_of(&run, 0);
    tvi_rigid_turn(L, (double)turn, quaternion);
    for (int k = 0; k < 4; k++) cosine += quaternion[k] * motion.quaternion[k];
    size = cosine < 0 ? -1 : 1;
    for (int k = 0; k < 4; k++) error = fmax(error, fabs(size * quaternion[k] - motion.quaternion[k]));
    rigid_end(&run);
    return error;
}

START_TEST(free_top)
{
    const euler_top tops[] = {{{1, 1.75, 2.5}, 0.5, 1}, {{1, 2, 3}, 0.5, 1}, {{0.5, 2, 2.25}, 0.25, -1}};
    const euler_top *top = &tops[_i];
    euler_top upright = *top;
    upright.omega3 = fabs(top->omega3);
    expect_close("error", error_of_euler(&upright, 0), 0, 2e-14);
    ck_assert_msg(error_of_euler(&upright, _i == 1 ? -1e-9 : 1e-9) > 1e-10, "the control is as good");
}
END_TEST

/* ---- Dzhanibekov's wing nut -------------------------------------------------------------------------------------- */

typedef struct {
    const rigid_run *run;
    double H, L[3], energy_error, momentum_error, last;
    int turns;
} turning_over;

static int watch_turns(long step, double t, const double q[], const double p[], void *ctx)
{
    turning_over *watched = ctx;
    double H, L[3];
    tvi_rigid_motion motion = {0};
    (void)step;
    ck_assert_int_eq(tvi_energy(watched->run->system, t, q, p, &H), TVI_OK);
    ck_assert_int_eq(tvi_rigid_of(watched->run->r, 0, q, p, &motion), TVI_OK);
    tvi_rigid_angular_momentum(watched->run->r, q, p, L);
    watched->energy_error = fmax(watched->energy_error, fabs(H / watched->H - 1));
    for (int k = 0; k < 3; k++) watched->momentum_error = fmax(watched->momentum_error, fabs(L[k] - watched->L[k]));
    watched->turns += motion.omega[1] * watched->last < 0;
    watched->last = motion.omega[1];
    return 0;
}

static turning_over turn_over(const tvi_options *options)
{
    const tvi_rigid_body nut = {1, {1, 2, 2.5}};
    const tvi_rigid r = {.bodies = 1, .axes = 3, .body = &nut};
    const tvi_rigid_motion start = {.omega = {1e-4, 2, 1e-4}};
    rigid_run run = rigid_begin(&r, &start, options);
    turning_over watched = {.run = &run, .H = rigid_energy_of(&run), .last = 2};
    tvi_rigid_angular_momentum(&r, run.q, run.p, watched.L);
    rigid_go_on(&run, 0.125, 2000, watch_turns, &watched);
    rigid_end(&run);
    return watched;
}

/* The intermediate axis turns over every 2 K / rate; energy and angular momentum are kept. */
START_TEST(turns_over)
{
    tvi_options coarse = tvi_options_default();
    coarse.degree = 2; /* one node keeps the energy, too (Moser and Veselov) */
    const turning_over kept = turn_over(NULL), control = turn_over(&coarse);
    /* The same orbit where omega[1] = 0. */
    const euler_top top = {{1, 2, 2.5}, sqrt((4 + 1.5e-8) / 1.5), sqrt((8 + 3.75e-8) / 3.75)};
    long double omega[3], period, turn;
    solve_euler(&top, 0, omega, &period, &turn);
    ck_assert_int_eq(kept.turns, (int)(500 / period + 0.5L)); /* It begins midway. */
    ck_assert_int_ge(kept.turns, 5);
    expect_close("energy", kept.energy_error, 0, 4e-14);
    expect_close("angular momentum", kept.momentum_error, 0, 1e-13);
    ck_assert_msg(control.energy_error > 1e-7, "two nodes are as good: %g", control.energy_error);
}
END_TEST

/* ---- The heavy symmetric top ------------------------------------------------------------------------------------- */

/* A top of spin omega3 about its axis, let go at the angle theta. */
typedef struct {
    double mass, arm, I1, I3, g, theta, spin; /* moments about the centre of mass */
} heavy_top;

/* u = cos theta at the time t, the time from one top of the nutation to the next, and how far it turns about the
 * vertical meanwhile. With a = I3 spin / I, beta = 2 m g l / I: u'^2 = beta (u - u0) (u - u1) (u - u3). */
static double solve_heavy(const heavy_top *top, double t, double *period, double *turn)
{
    enum { POINTS = 200 };
    const long double I = top->I1 + (long double)top->mass * top->arm * top->arm, u0 = cosl(top->theta),
                      a = top->I3 * (long double)top->spin / I,
                      beta = 2 * (long double)top->mass * top->g * top->arm / I, half = a * a / (2 * beta),
                      root = sqrtl(half * half - 2 * half * u0 + 1), u1 = half - root, u3 = half + root,
                      rate = sqrtl(beta * (u3 - u1)) / 2, m = (u0 - u1) / (u3 - u1);
    long double sn, cn, dn, u = 0, sum = 0;
    const long double K = jacobi(0, m, &sn, &cn, &dn);
    for (int i = 0; i <= POINTS; i++) {
        (void)jacobi(K + (i < POINTS ? 2 * K * i / POINTS : rate * t), m, &sn, &cn, &dn);
        u = u1 + (u0 - u1) * sn * sn;
        if (i < POINTS) sum += a * (u0 - u) / (1 - u * u);
    }
    *period = (double)(2 * K / rate);
    *turn = (double)(sum / POINTS * (2 * K / rate));
    return (double)u;
}

static double error_of_heavy(const heavy_top *top, double spin)
{
    const tvi_rigid_body body = {top->mass, {top->I1, top->I1, top->I3}};
    const tvi_joint joint = {.kind = TVI_BALL, .body = 0, .other = TVI_WORLD, .point = {0, 0, -top->arm}};
    const tvi_rigid r = {1, 3, &body, 1, &joint, {0, 0, -top->g}};
    tvi_rigid_motion start = {.omega = {0, 0, spin}, .point = {0, 0, -top->arm}};
    double period, turn, error = 0, x_axis[3] = {1, 0, 0};
    tvi_rigid_turn(x_axis, top->theta, start.quaternion); /* the axis is (0, -sin, cos) of theta */
    rigid_run run = rigid_begin(&r, &start, NULL);
    const double H = rigid_energy_of(&run);
    (void)solve_heavy(top, 0, &period, &turn);
    for (int part = 1; part <= 10; part++) {
        rigid_go_on(&run, period / 20, 10, NULL, NULL);
        const double u = solve_heavy(top, run.t, &period, &turn);
        error = fmax(error, fabs(run.q[2] / top->arm - u));
    }
    const double at = 5 * turn - acos(-1.0) / 2, across = sin(top->theta);
    error =
        fmax(error, fmax(fabs(run.q[0] / top->arm - across * cos(at)), fabs(run.q[1] / top->arm - across * sin(at))));
    expect_close("energy", rigid_energy_of(&run), H, 4e-14 * fabs(H));
    expect_close("spin", rigid_motion_of(&run, 0).omega[2], spin, 1e-13 * spin);
    rigid_end(&run);
    return error;
}

START_TEST(heavy_tops)
{
    const heavy_top tops[] = {{1.5, 0.4, 0.2, 0.1, 9.8, 0.6, 40}, {2, 0.25, 0.05, 0.0625, 9.8, 1.2, 60}};
    expect_close("error", error_of_heavy(&tops[_i], tops[_i].spin), 0, 2e-13);
    ck_assert_msg(error_of_heavy(&tops[_i], tops[_i].spin * (1 + 1e-9)) > 1e-10, "the control is as good");
}
END_TEST

Suite *suite_rigid(void)
{
    Suite *suite = suite_create("rigid bodies");
    TCase *motions = tcase_create("tops");
    tcase_add_loop_test(motions, free_top, 0, 3);
    tcase_add_test(motions, turns_over);
    tcase_add_loop_test(motions, heavy_tops, 0, 2);
    suite_add_tcase(suite, motions);
    return suite;
}
