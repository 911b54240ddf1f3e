/* orbit.c - Converts orbital elements to places and velocities, and back (include/tvi_bodies.h, docs/bodies.md).
 *
 * The universal anomaly chi gives the way from the pericentre on every conic, with alpha = 1 / a, psi = alpha chi^2:
 *   x = q - chi^2 c2, y = l chi c1, r = q + e chi^2 c2, mu^(1/2) time = q chi + e chi^3 c3, l = (q (1 + e))^(1/2),
 *   c_k(psi) = sum_j (-psi)^j / (2j + k)!. Neither the series nor the closed form cancels.
 * Conway, An improved algorithm due to Laguerre for the solution of Kepler's equation (1986). */
#include "refusal.h"
#include "tvi_bodies.h"

#include <float.h>
#include <string.h>

static const double PI = 3.14159265358979323846;
/* Elements that are given twice agree if a change of each by this part of itself makes both the same. */
static const double AGREEMENT = 1e-12;

/* Units of length, time and mu, length^3 = mu time^2, which are powers of 2: in these units no number overflows, and
 * the conversion rounds nothing. */
typedef struct {
    int length, time, mu; /* the exponents */
} units;

/* A conic in its units, in which q or the distance is from 1 to 2, and mu from 1 to 4. */
typedef struct {
    units unit;
    double q, e, alpha;
    double root; /* mu^(1/2) */
} conic;

/* A place on a conic: chi, the time since the pericentre, and the change of this time per relative change of a and of
 * the element that says the place. */
typedef struct {
    const char *name; /* The name of the element that says it. */
    double value;     /* The value of that element. */
    double chi, time, time_per_part;
} place;

/* ---- Conics ------------------------------------------------------------------------------------------------------ */

static units find_units(double length, double mu)
{
    const int k = ilogb(length), m = ilogb(mu), odd = (3 * k - m) & 1;
    return (units){.length = k, .time = (3 * k - m + odd) / 2, .mu = m - odd};
}

static void find_c(double psi, double c[4])
{
    const double E = sqrt(fabs(psi));
    c[2] = 0.5, c[3] = 1.0 / 6;
    if (fabs(psi) < 4) {
        double one = 1, other = 1;
        for (int j = 26; j > 2; j -= 2) one = 1 - psi / (j * (j - 1)) * one, other = 1 - psi / (j * (j + 1)) * other;
        c[2] *= one, c[3] *= other, c[0] = 1 - psi * c[2], c[1] = 1 - psi * c[3];
    } else {
        c[0] = psi > 0 ? cos(E) : cosh(E), c[1] = (psi > 0 ? sin(E) : sinh(E)) / E;
        c[2] = (1 - c[0]) / psi, c[3] = (1 - c[1]) / psi;
    }
}

/* M = n time. */
static double mean_motion(const conic *c) { return c->root * fabs(c->alpha) * sqrt(fabs(c->alpha)); }

static double time_at(const conic *o, double chi)
{
    double c[4];
    find_c(o->alpha * chi * chi, c);
    return chi * (o->q + o->e * chi * chi * c[3]) / o->root;
}

static double true_anomaly_at(const conic *o, double chi)
{
    double c[4];
    find_c(o->alpha * chi * chi, c);
    return atan2(sqrt(o->q * (1 + o->e)) * chi * c[1], o->q - chi * chi * c[2]);
}

/* Solves Kepler's equation for chi, s = mu^(1/2) time >= 0, by Laguerre's iteration. From near the parabola's chi, or
 * from e sinh F = M + F, it takes 5 rounds at the most. NaN: numbers are too large or too small for it. */
static double solve_kepler(const conic *o, double s)
{
    const double q = o->q, e = o->e, alpha = o->alpha, w = s / q, root = sqrt(fabs(alpha));
    double c[4], step = w, left = 0, chi = w / sqrt(1 + pow(e * w * w / (6 * q), 2.0 / 3));
    if (alpha < 0) chi = fmin(chi, asinh((root * root * root * s + root * chi) / e) / root);
    for (int k = 0; k < 8 && fabs(step) > 4e-16 * chi; k++) {
        find_c(alpha * chi * chi, c);
        const double r = q + e * chi * chi * c[2];
        left = chi * (q + e * chi * chi * c[3]) - s;
        step = 5 * left / (r + sqrt(fabs(16 * r * r - 20 * left * e * chi * c[1])));
        chi -= step;
    }
    return fabs(left) <= AGREEMENT * s ? chi : NAN;
}

static double chi_at_time(const conic *c, double time)
{
    const double half = c->alpha > 0 ? PI / mean_motion(c) : HUGE_VAL;
    if (fabs(time) > 1.001 * half) time = remainder(time, 2 * half);
    return copysign(solve_kepler(c, c->root * fabs(time)), time);
}

/* tan(f/2) (q / (1 + e))^(1/2) = tan(alpha^(1/2) chi / 2) / alpha^(1/2). It is not finite outside of the asymptotes. */
static double chi_at_true_anomaly(const conic *c, double f)
{
    const double root = sqrt(fabs(c->alpha)), inside = remainder(f, 2 * PI);
    const double w = tan(inside / 2) * sqrt(c->q / (1 + c->e));
    if (c->alpha == 0) return fabs(inside) < PI ? 2 * w : NAN;
    return 2 * (c->alpha > 0 ? atan(root * w) : atanh(root * w)) / root;
}

/* ---- Which elements are refused ---------------------------------------------------------------------------------- */

/* -0.0 is given: it stands for 0, and -0.0 + 0.0 = 0.0. */
static bool is_given(double element) { return element != 0 || signbit(element); }

static bool agree(double difference, double tolerance) { return fabs(difference) <= tolerance; }

static tvi_status refuse_nonfinite(const tvi_orbit *o, double mu)
{
    static const char *const names[] = {
        "a", "q", "e", "i", "node", "pericentre", "time", "f", "M", "mean_longitude", "longitude_of_pericentre"};
    enum { ELEMENTS = sizeof names / sizeof *names };
    double value[ELEMENTS];
    _Static_assert(sizeof value == sizeof *o, "each element has a name");
    memcpy(value, o, sizeof value);
    if (!isfinite(mu)) return jet_refuse(TVI_ENONFINITE, "mu = %g is not finite", mu);
    for (int k = 0; k < ELEMENTS; k++)
        if (isnan(value[k]) || (k > 0 && isinf(value[k])))
            return jet_refuse(TVI_ENONFINITE, "%s = %g is not finite", names[k], value[k]);
    return TVI_OK;
}

static tvi_status refuse_size(const tvi_orbit *o, double q)
{
    if (o->q == 0 && o->a == 0) return jet_refuse(TVI_EINVAL, "neither a nor q is given: one of them is needed");
    if (o->q == 0 && o->e == 1)
        return jet_refuse(TVI_EINVAL, "a = %g, e = 1: q = a (1 - e) is not positive: a parabola needs q", o->a);
    if (o->q == 0)
        return jet_refuse(TVI_EINVAL,
                          "a = %.15g, e = %.15g: q = a (1 - e) = %g is not positive and finite: %s has a finite a %s 0",
                          o->a, o->e, q, o->e < 1 ? "an ellipse, e < 1," : "a hyperbola, e > 1,", o->e < 1 ? ">" : "<");
    return jet_refuse(TVI_EINVAL, "q = %g is not positive", o->q);
}

static tvi_status find_conic(const tvi_orbit *o, double mu, conic *c)
{
    const double q = o->q == 0 ? o->a * (1 - o->e) : o->q;
    const double alpha = o->a == 0 ? (1 - o->e) / q : 1 / o->a, e = 1 - q * alpha;
    if (!(mu > 0)) return jet_refuse(TVI_EINVAL, "mu = %g is not positive", mu);
    if (!(o->e >= 0)) return jet_refuse(TVI_EINVAL, "e = %g is negative", o->e);
    if (!(o->i >= 0 && o->i <= PI))
        return jet_refuse(TVI_EINVAL, "i = %.16g is not within [0, pi]: angles are in radians", o->i);
    if (!(q > 0 && isfinite(q))) return refuse_size(o, q);
    if (!isfinite(alpha)) return jet_refuse(TVI_ENONFINITE, "1 / a = %g is not finite", alpha);
    if (!agree(o->e - e, AGREEMENT * (1 + fabs(e))))
        return jet_refuse(TVI_EINVAL, "a = %.15g, q = %.15g and e = %.15g disagree: q = a (1 - e) = %.15g. Give a or q",
                          o->a, o->q, o->e, o->a * (1 - o->e));
    const units u = find_units(q, mu);
    *c = (conic){u, ldexp(q, -u.length), fmax(0, e), ldexp(alpha, u.length), sqrt(ldexp(mu, -u.mu))};
    return TVI_OK;
}

/* Finds the argument of the pericentre. */
static tvi_status find_pericentre(const tvi_orbit *o, double *pericentre)
{
    const double longitude = o->longitude_of_pericentre, sum = o->node + o->pericentre;
    *pericentre = is_given(longitude) && !is_given(o->pericentre) ? longitude - o->node : o->pericentre;
    if (!is_given(longitude) || !is_given(o->pericentre) ||
        agree(remainder(longitude - sum, 2 * PI), AGREEMENT * (fabs(longitude) + fabs(o->node) + fabs(o->pericentre))))
        return TVI_OK;
    return jet_refuse(TVI_EINVAL,
                      "pericentre = %.15g and longitude_of_pericentre = %.15g disagree: node + pericentre = %.15g. "
                      "Give one of them",
                      o->pericentre + 0.0, longitude + 0.0, remainder(sum, 2 * PI));
}

/* ---- Places on a conic ------------------------------------------------------------------------------------------- */

/* dt/df = r^2 / (mu^(1/2) l). */
static double time_per_radian(const conic *o, double chi)
{
    double c[4];
    find_c(o->alpha * chi * chi, c);
    const double r = o->q + o->e * chi * chi * c[2];
    return r * (r / sqrt(o->q * (1 + o->e))) / o->root;
}

static tvi_status find_Xof_true_anomaly(const conic *c, double f, place *at)
{
    const double chi = chi_at_true_anomaly(c, f);
    if (!isfinite(chi))
        return jet_refuse(TVI_EINVAL, "f = %g is not within the asymptotes of e = %.15g, +-%g", f, c->e,
                          acos(-1 / fmax(1, c->e)));
    *at = (place){.name = "f", .value = f, .chi = chi, .time = time_at(c, chi)};
    at->time_per_part = fabs(f) * time_per_radian(c, chi) + 2.5 * fabs(at->time);
    return TVI_OK;
}

/* Returns M = mean_longitude - (node + pericentre), which is 0 where tvi_orbit_of has found an M of 0. */
static double mean_anomaly_of_longitude(const tvi_orbit *o, const conic *c, double pericentre)
{
    const double M = o->mean_longitude - (o->node + pericentre);
    return c->alpha > 0 ? remainder(M, 2 * PI) : M;
}

/* Finds the place that the first given one of time, f, M and mean_longitude says. The last two say nothing about a
 * parabola, whose n is 0. */
static tvi_status find_place(const tvi_orbit *o, const conic *c, double pericentre, place *at)
{
    const double n = mean_motion(c), M_of_longitude = mean_anomaly_of_longitude(o, c, pericentre);
    if (!is_given(o->time) && is_given(o->f)) return find_Xof_true_anomaly(c, o->f + 0.0, at);
    *at = (place){.name = "time", .value = o->time, .time = ldexp(o->time, -c->unit.time)};
    if (!is_given(o->time) && is_given(o->M)) *at = (place){.name = "M", .value = o->M, .time = n > 0 ? o->M / n : 0};
    else if (!is_given(o->time) && is_given(o->mean_longitude))
        *at = (place){.name = "mean_longitude", .value = o->mean_longitude, .time = n > 0 ? M_of_longitude / n : 0};
    at->chi = chi_at_time(c, at->time + 0.0);
    at->time_per_part = 2.5 * fabs(at->time);
    if (isfinite(at->chi) && isfinite(at->time)) return TVI_OK;
    return jet_refuse(TVI_ENONFINITE, "%s = %g leads to numbers that are too large or too small", at->name, at->value);
}

/* Compares those of f, M and mean_longitude that are given with the place. */
static tvi_status refuse_other_places(const tvi_orbit *o, const conic *c, double pericentre, const place *at)
{
    static const char *const name[] = {"f", "M", "mean_longitude"};
    const double n = mean_motion(c), turn = 2 * PI, M = c->alpha > 0 ? remainder(n * at->time, turn) : n * at->time;
    const double given[] = {o->f, o->M, o->mean_longitude};
    const double found[] = {true_anomaly_at(c, at->chi), M, o->node + pericentre + M};
    const double change_of_M = n * at->time_per_part, angles = fabs(o->node) + fabs(pericentre);
    const double change[] = {at->time_per_part / time_per_radian(c, at->chi), change_of_M, change_of_M + angles};
    for (int k = 0; k < 3; k++) {
        const bool is_periodic = k == 0 || c->alpha > 0;
        const double difference = is_periodic ? remainder(given[k] - found[k], turn) : given[k] - found[k];
        if (!is_given(given[k]) || agree(difference, AGREEMENT * (change[k] + fabs(given[k])))) continue;
        if (k > 0 && n == 0)
            return jet_refuse(TVI_EINVAL, "%s = %.15g, e = 1: M of a parabola is 0. Give time or f", name[k], given[k]);
        return jet_refuse(TVI_EINVAL, "%s = %.15g and %s = %.15g disagree: there %s = %.15g. Give one of them",
                          at->name, at->value + 0.0, name[k], given[k] + 0.0, name[k], found[k] + 0.0);
    }
    return TVI_OK;
}

/* ---- States ------------------------------------------------------------------------------------------------------ */

/* Finds the unit vectors to the ascending node, and across it in the plane of the orbit. */
static void find_axes(double i, double node, double n[3], double m[3])
{
    n[0] = cos(node), n[1] = sin(node), n[2] = 0;
    m[0] = -n[1] * cos(i), m[1] = n[0] * cos(i), m[2] = sin(i);
}

/* Finds the state at chi, x and v. P and Q are the unit vectors to the pericentre, and across it. */
static void find_state(const conic *o, double chi, const double P[3], const double Q[3], double state[6])
{
    const units u = o->unit;
    double c[4];
    find_c(o->alpha * chi * chi, c);
    const double across = sqrt(o->q * (1 + o->e)), rate = o->root / (o->q + o->e * chi * chi * c[2]);
    for (int k = 0; k < 3; k++) {
        state[k] = ldexp((o->q - chi * chi * c[2]) * P[k] + across * chi * c[1] * Q[k], u.length);
        state[3 + k] = ldexp(rate * (across * c[0] * Q[k] - chi * c[1] * P[k]), u.length - u.time);
    }
}

/* Tells whether a vector other than 0 has kept its digits. */
static bool is_exact(const double x[3])
{
    const double most = fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
    return isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]) && most >= DBL_MIN;
}

tvi_status tvi_orbit_state(const tvi_orbit *orbit, double mu, double x[3], double v[3])
{
    double pericentre, n[3], m[3], P[3], Q[3], state[6];
    conic c = {0};
    place at = {0};
    if (!orbit || !x || !v) return jet_refuse(TVI_EINVAL, "%s is NULL", !orbit ? "orbit" : !x ? "x" : "v");
    tvi_status status = refuse_nonfinite(orbit, mu);
    if (status == TVI_OK) status = find_conic(orbit, mu, &c);
    if (status == TVI_OK) status = find_pericentre(orbit, &pericentre);
    if (status == TVI_OK) status = find_place(orbit, &c, pericentre, &at);
    if (status == TVI_OK) status = refuse_other_places(orbit, &c, pericentre, &at);
    if (status != TVI_OK) return status;
    find_axes(orbit->i, orbit->node, n, m);
    const double C = cos(pericentre), S = sin(pericentre);
    for (int k = 0; k < 3; k++) P[k] = C * n[k] + S * m[k], Q[k] = C * m[k] - S * n[k];
    find_state(&c, at.chi, P, Q, state);
    if (!is_exact(state) || !is_exact(state + 3))
        return jet_refuse(TVI_ENONFINITE, "x or v is too large or too small for a double");
    memcpy(x, state, 3 * sizeof *x);
    memcpy(v, state + 3, 3 * sizeof *v);
    return TVI_OK;
}

/* Returns a b - c d to two units of its last place (Kahan). */
static double cross(double a, double b, double c, double d)
{
    const double cd = c * d;
    return fma(a, b, -cd) - fma(c, d, -cd);
}

static tvi_status refuse_state(double mu, const double x[3], const double v[3], const tvi_orbit *orbit)
{
    if (!x || !v || !orbit) return jet_refuse(TVI_EINVAL, "%s is NULL", !x ? "x" : !v ? "v" : "orbit");
    if (!isfinite(mu)) return jet_refuse(TVI_ENONFINITE, "mu = %g is not finite", mu);
    for (int k = 0; k < 6; k++) {
        const double value = k < 3 ? x[k] : v[k - 3];
        if (!isfinite(value))
            return jet_refuse(TVI_ENONFINITE, "%c[%d] = %g is not finite", k < 3 ? 'x' : 'v', k % 3, value);
    }
    return mu > 0 ? TVI_OK : jet_refuse(TVI_EINVAL, "mu = %g is not positive", mu);
}

/* Refuses elements that have lost digits since they are too small for a double. At the pericentre the last three are
 * 0, and so is M of a parabola. */
static tvi_status refuse_inexact(const tvi_orbit *o)
{
    static const char *const name[] = {"q", "f", "time", "M"};
    const double value[] = {o->q, o->f, o->time, o->M};
    const int count = o->f == 0 ? 1 : isinf(o->a) ? 3 : 4;
    for (int k = 0; k < count; k++)
        if (fabs(value[k]) < DBL_MIN)
            return jet_refuse(TVI_ENONFINITE, "%s = %g is too small for a double", name[k], value[k]);
    return TVI_OK;
}

/* Finds the elements in units in which |x| and mu are about 1. */
static tvi_status find_elements(double mu, const double x[3], const double v[3], tvi_orbit *o)
{
    const double L[] = {cross(x[1], v[2], x[2], v[1]), cross(x[2], v[0], x[0], v[2]), cross(x[0], v[1], x[1], v[0])};
    const double root = sqrt(mu), r = hypot(hypot(x[0], x[1]), x[2]), l = hypot(hypot(L[0], L[1]), L[2]) / root;
    const double sigma = (x[0] * v[0] + x[1] * v[1] + x[2] * v[2]) / root;
    const double alpha = 2 / r - (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / mu, A = sqrt(fabs(alpha));
    double n[3], m[3];
    if (l == 0) return jet_refuse(TVI_EDOMAIN, "x and v are on one line through the centre: no pericentre");
    o->e = hypot(l * l / r - 1, sigma * l / r);
    o->q = l * l / (1 + o->e), o->a = 1 / alpha;
    const conic c = {.q = o->q, .e = o->e, .alpha = alpha, .root = root};
    double chi = sigma / o->e;
    if (alpha > 0) chi = atan2(sigma * A, 1 - r * alpha) / A;
    if (alpha < 0) chi = asinh(sigma * A / o->e) / A;
    o->time = time_at(&c, chi), o->f = true_anomaly_at(&c, chi), o->M = mean_motion(&c) * o->time;
    o->i = atan2(hypot(L[0], L[1]), L[2]), o->node = L[0] == 0 && L[1] == 0 ? 0 : atan2(L[0], -L[1]);
    find_axes(o->i, o->node, n, m);
    o->pericentre = atan2(x[0] * m[0] + x[1] * m[1] + x[2] * m[2], x[0] * n[0] + x[1] * n[1]) - o->f;
    o->pericentre = remainder(o->pericentre, 2 * PI);
    o->longitude_of_pericentre = o->node + o->pericentre, o->mean_longitude = o->longitude_of_pericentre + o->M;
    if (!(alpha > 0)) return TVI_OK;
    o->longitude_of_pericentre = remainder(o->longitude_of_pericentre, 2 * PI);
    o->mean_longitude = remainder(o->mean_longitude, 2 * PI);
    return TVI_OK;
}

tvi_status tvi_orbit_of(double mu, const double x[3], const double v[3], tvi_orbit *orbit)
{
    double X[3], V[3];
    tvi_orbit o;
    tvi_status status = refuse_state(mu, x, v, orbit);
    if (status != TVI_OK) return status;
    const double most = fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
    if (most == 0) return jet_refuse(TVI_EDOMAIN, "x is 0");
    const units u = find_units(most, mu);
    for (int k = 0; k < 3; k++) X[k] = ldexp(x[k], -u.length), V[k] = ldexp(v[k], u.time - u.length);
    status = find_elements(ldexp(mu, -u.mu), X, V, &o);
    if (status == TVI_OK) status = refuse_inexact(&o);
    if (status != TVI_OK) return status;
    if (isfinite(o.a) && !isfinite(ldexp(o.a, u.length)))
        return jet_refuse(TVI_ENONFINITE, "a is too large for a double");
    o.a = ldexp(o.a, u.length), o.q = ldexp(o.q, u.length), o.time = ldexp(o.time, u.time);
    status = refuse_nonfinite(&o, mu);
    if (status == TVI_OK) status = refuse_inexact(&o);
    if (status == TVI_OK) *orbit = o;
    return status;
}
