/* test_orbits.c - Tests states from elements and elements from states at random: both ways, and against the textbook's
 * formulas in long double. */
#include "bodies.h"
#include "problems/random.h"
#include "problems/thorough.h"

#include <float.h>
#include <math.h>

static uint64_t bits;

static double between(double low, double high) { return low + (high - low) * number_of(&bits); }
static double power_of_ten(double low, double high) { return pow(10, between(low, high)); }
static double a_sign(void) { return number_of(&bits) < 0.5 ? -1 : 1; }

/* The ranges of e and i: all of both, and near what is special. */
typedef enum { ALL, ELLIPSES, NEAR_PARABOLAS, PARABOLAS, NEAR_CIRCLES, CIRCLES, FLAT, KINDS } kind_of_orbit;

static double eccentricity(kind_of_orbit kind)
{
    if (kind == NEAR_PARABOLAS) return 1 + a_sign() * power_of_ten(-16, -1);
    if (kind == NEAR_CIRCLES) return power_of_ten(-17, -1);
    return kind == PARABOLAS ? 1 : kind == CIRCLES ? 0 : between(0, kind == ELLIPSES ? 1 : 10);
}

static tvi_orbit orbit_of_kind(kind_of_orbit kind, double *mu)
{
    const double pi = acos(-1);
    tvi_orbit o = {.q = power_of_ten(-2, 2), .e = eccentricity(kind), .i = between(0, pi)};
    *mu = power_of_ten(-2, 2);
    if (kind == FLAT) o.i = a_sign() < 0 ? power_of_ten(-18, -1) : pi - power_of_ten(-18, -1);
    o.node = between(-pi, pi), o.pericentre = between(-pi, pi);
    o.time = a_sign() * o.q * sqrt(o.q / *mu) * power_of_ten(-3, 3);
    if (o.e < 1 && a_sign() > 0) o.time = between(-pi, pi) * sqrt(pow(o.q / (1 - o.e), 3) / *mu);
    return o;
}

static double distance(const double x[3], const double y[3])
{
    return sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) + (x[2] - y[2]) * (x[2] - y[2]));
}
static double length(const double x[3]) { return distance(x, (const double[3]){0}); }

/* The condition of x and v, to which a change of one part in one of an element adds |d x / d element| |element|: angles
 * turn; the time moves along the orbit, and so does a, half as much again; q and a scale. The first of the two units is
 * the rounding of x and v themselves. */
static void conditions(const tvi_orbit *o, double mu, const double x[3], const double v[3], double of[2])
{
    const double own = 2 + fabs(o->i) + fabs(o->node) + fabs(o->pericentre), way = 2.5 * fabs(o->time), r = length(x);
    of[0] = own * r + way * length(v);
    of[1] = own * length(v) + way * mu / (r * r);
}

/* The state of the elements of a state is the state. */
START_TEST(there_and_back)
{
    static const double BOUND = 4 * DBL_EPSILON;
    const long count = (is_thorough() ? 1000000 : 100000) / KINDS;
    double worst = 0;
    bits = 54 + (uint64_t)_i;
    for (long k = 0; k < count; k++) {
        double mu, x[3], v[3], y[3], w[3], condition[2];
        const tvi_orbit o = orbit_of_kind((kind_of_orbit)_i, &mu);
        tvi_orbit found;
        ck_assert_int_eq(tvi_orbit_state(&o, mu, x, v), TVI_OK);
        ck_assert_int_eq(tvi_orbit_of(mu, x, v, &found), TVI_OK);
        ck_assert_int_eq(tvi_orbit_state(&found, mu, y, w), TVI_OK);
        conditions(&found, mu, x, v, condition);
        const double far[] = {distance(x, y), distance(v, w)};
        for (int i = 0; i < 2; i++) {
            ck_assert(isfinite(far[i]) && condition[i] > 0); /* fmax drops NaN */
            worst = fmax(worst, far[i] / condition[i]);
        }
        ck_assert(fabs(found.e - o.e) <= 1e-9 * (1 + o.e) && found.i >= 0 && found.i <= acos(-1));
    }
    ck_assert_msg(worst <= BOUND, "%.2f units", worst / DBL_EPSILON);
}
END_TEST

/* The elements of a state that differ from those of another one, angles by less than half a turn. */
enum { ELEMENTS = 6 };
static void differences(const tvi_orbit *one, const tvi_orbit *other, double mu, double d[ELEMENTS])
{
    const double turn = 2 * acos(-1), period = one->e < 1 ? turn * sqrt(pow(one->q / (1 - one->e), 3) / mu) : INFINITY;
    d[0] = fabs(one->q - other->q), d[1] = fabs(one->e - other->e), d[2] = fabs(one->i - other->i);
    d[3] = fabs(remainder(one->node - other->node, turn));
    d[4] = fabs(remainder(one->pericentre - other->pericentre, turn));
    d[5] = fabs(one->time - other->time);
    if (isfinite(period)) d[5] = fabs(remainder(d[5], period));
}

/* Finds by differences what a change of one part in one of x, and of v, adds to each element. */
static void sensitivities(const tvi_orbit *o, double mu, const double x[3], const double v[3], double of[2][ELEMENTS])
{
    static const double PART = 0x1p-26;
    for (int i = 0; i < ELEMENTS; i++) of[0][i] = of[1][i] = 0;
    for (int k = 0; k < 12; k++) {
        double y[2][3] = {{x[0], x[1], x[2]}, {v[0], v[1], v[2]}}, d[ELEMENTS];
        tvi_orbit beside;
        y[k / 6][k % 3] += (k / 3 % 2 ? PART : -PART) * length(y[k / 6]);
        if (tvi_orbit_of(mu, y[0], y[1], &beside) != TVI_OK) continue;
        differences(o, &beside, mu, d);
        for (int i = 0; i < ELEMENTS; i++) of[k / 6][i] = fmax(of[k / 6][i], d[i] / PART);
    }
}

/* The elements of the state of elements are the elements, to what roundoff of the state makes of them: 3.8 units were
 * seen of a million. */
START_TEST(back_and_there)
{
    static const double BOUND = 6 * DBL_EPSILON;
    const long count = (is_thorough() ? 1000000 : 20000) / KINDS;
    const int known = _i == CIRCLES || _i == NEAR_CIRCLES ? 4 : ELEMENTS; /* their pericentre is noise */
    double worst = 0;
    bits = 5400 + (uint64_t)_i;
    for (long k = 0; k < count; k++) {
        double mu, x[3], v[3], condition[2], d[ELEMENTS], of[2][ELEMENTS];
        const tvi_orbit o = orbit_of_kind((kind_of_orbit)_i, &mu);
        const double own[] = {o.q, o.e, o.i, fabs(o.node), fabs(o.pericentre), fabs(o.time)};
        tvi_orbit found;
        ck_assert_int_eq(tvi_orbit_state(&o, mu, x, v), TVI_OK);
        ck_assert_int_eq(tvi_orbit_of(mu, x, v, &found), TVI_OK);
        conditions(&o, mu, x, v, condition);
        sensitivities(&found, mu, x, v, of);
        differences(&o, &found, mu, d);
        const double parts[] = {condition[0] / length(x) / 2, condition[1] / length(v) / 2};
        for (int i = 0; i < known; i++) {
            const double unit = own[i] + parts[0] * of[0][i] + parts[1] * of[1][i];
            ck_assert(isfinite(d[i]) && isfinite(unit)); /* fmax drops NaN */
            worst = fmax(worst, d[i] == 0 ? 0 : d[i] / unit);
        }
    }
    ck_assert_msg(worst <= BOUND, "%.2f units", worst / DBL_EPSILON);
}
END_TEST

/* ---- The textbook ------------------------------------------------------------------------------------------------ */

/* The root of a function that grows, between 0 and high, by bisection. */
typedef long double equation(long double e, long double anomaly);
static long double elliptic(long double e, long double E) { return E - e * sinl(E); }
static long double hyperbolic(long double e, long double F) { return e * sinhl(F) - F; }
static long double parabolic(long double e, long double D) { return (void)e, D + D * D * D / 3; }

static long double solve(equation *of, long double e, long double M, long double high)
{
    long double low = 0;
    for (int i = 0; i < 200; i++) {
        const long double middle = (low + high) / 2;
        if (of(e, middle) < M) low = middle;
        else high = middle;
    }
    return low;
}

/* tan (f/2) of the true anomaly, of E, F, or Barker's D = tan (f/2). */
static long double half_tangent(const tvi_orbit *o, double mu)
{
    const long double e = o->e, q = o->q, time = fabsl(o->time), s = sqrtl(mu) * time, pi = acosl(-1);
    if (o->e == 1) return solve(parabolic, 1, s / sqrtl(2 * q * q * q), 1e4L);
    const long double a = q / fabsl(1 - e), M = s / (a * sqrtl(a));
    if (o->e > 1) return sqrtl((e + 1) / (e - 1)) * tanhl(solve(hyperbolic, e, M, 60) / 2);
    return sqrtl((1 + e) / (1 - e)) * tanl(solve(elliptic, e, fabsl(remainderl(M, 2 * pi)), pi) / 2);
}

/* r = p / (1 + e cos f), in the directions of the node and across, turned by argument + f. */
static void textbook(const tvi_orbit *o, double mu, double x[3], double v[3])
{
    const long double a = o->e < 1 ? o->q / (1 - (long double)o->e) : 0, turn = 2 * acosl(-1) * sqrtl(a * a * a / mu);
    const long double sign = o->e < 1 ? remainderl(o->time, turn) : o->time, e = o->e, p = o->q * (1 + e);
    const long double f = copysignl(2 * atanl(half_tangent(o, mu)), sign), u = f + o->pericentre, node = o->node;
    const long double r = p / (1 + e * cosl(f)), rate = sqrtl(mu / p), radial = rate * e * sinl(f), i = o->i;
    const long double n[] = {cosl(node), sinl(node), 0}, m[] = {-sinl(node) * cosl(i), cosl(node) * cosl(i), sinl(i)};
    for (int k = 0; k < 3; k++) {
        const long double out = cosl(u) * n[k] + sinl(u) * m[k], across = cosl(u) * m[k] - sinl(u) * n[k];
        x[k] = (double)(r * out);
        v[k] = (double)(radial * out + rate * (1 + e * cosl(f)) * across);
    }
}

/* e is away from 1, where the formulas with a are well conditioned, and the time is one at which 1 + e cos f is: within
 * five half revolutions. */
START_TEST(as_in_the_textbook)
{
    bits = 7 + (uint64_t)_i;
    for (int k = 0; k < 1000; k++) {
        double mu, x[3], v[3], y[3], w[3], condition[2];
        tvi_orbit o = orbit_of_kind((kind_of_orbit)_i, &mu);
        o.time = between(-3, 3) * sqrt(pow(o.q, 3) / mu);
        if (o.e < 1) o.time *= 5 / pow(1 - o.e, 1.5);
        if (_i != PARABOLAS && fabs(o.e - 1) < 0.05) continue;
        ck_assert_int_eq(tvi_orbit_state(&o, mu, x, v), TVI_OK);
        textbook(&o, mu, y, w);
        conditions(&o, mu, x, v, condition);
        ck_assert_double_le(distance(x, y), 2 * DBL_EPSILON * condition[0]);
        ck_assert_double_le(distance(v, w), 2 * DBL_EPSILON * condition[1]);
    }
}
END_TEST

/* Many revolutions, and the far ends of all scales: the energy and the pericentre stay what they were. */
START_TEST(far_times)
{
    const tvi_orbit ends[] = {{.q = 1, .e = 0.5, .time = 1e6},          {.q = 1, .e = 1, .time = 1e30},
                              {.q = 1, .e = 2, .time = 1e10},           {.q = 1e-8, .e = 1 - 1e-12, .time = 1e3},
                              {.q = 1e-8, .e = 1 + 1e-12, .time = 1e9}, {.q = 1e40, .e = 0, .time = 1e59},
                              {.q = 1, .e = 1e-300, .time = 2},         {.q = 1, .e = 1e5, .time = -1e3},
                              {.q = 1e-30, .e = 0.999, .time = 1e-40}};
    for (size_t k = 0; k < sizeof ends / sizeof *ends; k++) {
        double x[3], v[3];
        tvi_orbit found;
        ck_assert_int_eq(tvi_orbit_state(&ends[k], 1, x, v), TVI_OK);
        ck_assert_int_eq(tvi_orbit_of(1, x, v, &found), TVI_OK);
        const double r = length(x), u = length(v), q = ends[k].q, wanted = (ends[k].e - 1) / q / 2;
        ck_assert_double_le(fabs(u * u / 2 - 1 / r - wanted), 1e-15 * (1 / r + u * u));
        /* L is known to roundoff of r v */
        ck_assert_double_le(fabs(found.q / q - 1), 1e-14 * (1 + r * u / sqrt(q * (1 + ends[k].e))));
    }
}
END_TEST

/* Other units, powers of 2, change no bit of a state and of its elements: no square and no cube overflows. */
START_TEST(units)
{
    static const int lengths[] = {-900, -600, -350, -90, 0, 90, 350, 600, 900}, masses[] = {-600, -120, 0, 240, 600};
    enum { LENGTHS = sizeof lengths / sizeof *lengths, MASSES = sizeof masses / sizeof *masses };
    bits = 97 + (uint64_t)_i;
    for (int k = 0; k < 40 * LENGTHS * MASSES; k++) {
        double mu, x[3], v[3], y[3], w[3];
        const tvi_orbit o = orbit_of_kind((kind_of_orbit)_i, &mu);
        const int unit = lengths[k % LENGTHS], mass = masses[k / LENGTHS % MASSES], time = (3 * unit - mass) / 2;
        tvi_orbit scaled = o, found, again;
        scaled.q = ldexp(o.q, unit), scaled.time = ldexp(o.time, time);
        if (abs(time) > 950 || abs(unit - time) > 950) continue; /* no double has such a time or velocity */
        ck_assert_int_eq(tvi_orbit_state(&o, mu, x, v), TVI_OK);
        ck_assert_int_eq(tvi_orbit_state(&scaled, ldexp(mu, mass), y, w), TVI_OK);
        ck_assert_int_eq(tvi_orbit_of(mu, x, v, &found), TVI_OK);
        ck_assert_int_eq(tvi_orbit_of(ldexp(mu, mass), y, w, &again), TVI_OK);
        for (int i = 0; i < 3; i++) ck_assert(y[i] == ldexp(x[i], unit) && w[i] == ldexp(v[i], unit - time));
        ck_assert(again.e == found.e && again.i == found.i && again.node == found.node && again.f == found.f);
        ck_assert(again.q == ldexp(found.q, unit) && again.time == ldexp(found.time, time) && again.M == found.M);
        ck_assert(again.a == ldexp(found.a, unit) && again.pericentre == found.pericentre);
    }
}
END_TEST

Suite *suite_orbits(void)
{
    Suite *suite = suite_create("orbits");
    TCase *tests = tcase_create("random");
    tcase_add_loop_test(tests, there_and_back, 0, KINDS);
    tcase_add_loop_test(tests, back_and_there, 0, KINDS);
    tcase_add_loop_test(tests, as_in_the_textbook, 0, KINDS);
    tcase_add_test(tests, far_times);
    tcase_add_loop_test(tests, units, 0, KINDS);
    suite_add_tcase(suite, tests);
    return suite;
}
