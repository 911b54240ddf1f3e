/* orbit.c - Converts orbital elements to places and velocities, and back (include/tvi_bodies.h, docs/bodies.md). */
#include "tvi_bodies.h"

/* The universal anomaly chi gives the way from the pericentre on every conic, with psi = chi^2 / a:
 *   x = q - chi^2 c2, y = (q (1 + e))^(1/2) chi c1, r = q + e chi^2 c2, mu^(1/2) time = q chi + e chi^3 c3,
 *   c_k(psi) = sum_j (-psi)^j / (2j + k)!. Neither the series nor the closed form cancels. */
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

/* Solves Kepler's equation for chi, s = mu^(1/2) time >= 0, alpha = 1 / a, by Laguerre's iteration (Conway, 1986).
 * From near the parabola's chi, or from e sinh F = M + F, it takes 5 rounds at the most. */
static double solve_kepler(double q, double e, double alpha, double s)
{
    const double w = s / q, root = sqrt(fabs(alpha));
    double c[4], step = w, chi = w / sqrt(1 + pow(e * w * w / (6 * q), 2.0 / 3));
    if (alpha < 0) chi = fmin(chi, asinh((root * root * root * s + root * chi) / e) / root);
    for (int k = 0; k < 8 && fabs(step) > 4e-16 * chi; k++) {
        find_c(alpha * chi * chi, c);
        const double f = chi * (q + e * chi * chi * c[3]) - s, r = q + e * chi * chi * c[2];
        step = 5 * f / (r + sqrt(fabs(16 * r * r - 20 * f * e * chi * c[1])));
        chi -= step;
    }
    return chi;
}

/* Finds the unit vectors to the ascending node, and across it in the plane of the orbit. */
static void find_axes(double i, double node, double n[3], double m[3])
{
    n[0] = cos(node), n[1] = sin(node), n[2] = 0;
    m[0] = -n[1] * cos(i), m[1] = n[0] * cos(i), m[2] = sin(i);
}

/* Returns a b - c d to two units of its last place (Kahan). */
static double cross(double a, double b, double c, double d)
{
    const double cd = c * d;
    return fma(a, b, -cd) - fma(c, d, -cd);
}

tvi_status tvi_orbit_state(const tvi_orbit *orbit, double mu, double x[3], double v[3])
{
    const double pi = acos(-1), q = orbit->q == 0 ? orbit->a * (1 - orbit->e) : orbit->q;
    const double alpha = orbit->a == 0 ? (1 - orbit->e) / q : 1 / orbit->a;
    const double e = fmax(0, 1 - q * alpha), root = sqrt(mu);
    double time = orbit->time, c[4], n[3], m[3], out[6], sum = 0;
    if (!isfinite(orbit->q + orbit->e + orbit->i + orbit->node + orbit->pericentre + time + mu)) return TVI_ENONFINITE;
    if (!(mu > 0 && orbit->e >= 0 && orbit->i >= 0 && orbit->i <= pi && q > 0)) return TVI_EINVAL;
    if (!(fabs(orbit->e - e) <= 1e-12 * (1 + e) && isfinite(q))) return TVI_EINVAL;
    const double half = alpha > 0 ? pi / (root * alpha * sqrt(alpha)) : HUGE_VAL;
    if (fabs(time) > 1.001 * half) time = remainder(time, 2 * half);
    const double chi = copysign(solve_kepler(q, e, alpha, root * fabs(time)), time);
    find_c(alpha * chi * chi, c);
    find_axes(orbit->i, orbit->node, n, m);
    const double across = sqrt(q * (1 + e)), rate = root / (q + e * chi * chi * c[2]);
    const double C = cos(orbit->pericentre), S = sin(orbit->pericentre);
    for (int k = 0; k < 3; k++) {
        const double P = C * n[k] + S * m[k], Q = C * m[k] - S * n[k];
        sum += out[k] = (q - chi * chi * c[2]) * P + across * chi * c[1] * Q;
        sum += out[3 + k] = rate * (across * c[0] * Q - chi * c[1] * P);
    }
    if (!isfinite(sum)) return TVI_ENONFINITE;
    for (int k = 0; k < 3; k++) x[k] = out[k], v[k] = out[3 + k];
    return TVI_OK;
}

tvi_status tvi_orbit_of(double mu, const double x[3], const double v[3], tvi_orbit *orbit)
{
    const double L[] = {cross(x[1], v[2], x[2], v[1]), cross(x[2], v[0], x[0], v[2]), cross(x[0], v[1], x[1], v[0])};
    const double root = sqrt(mu), r = hypot(hypot(x[0], x[1]), x[2]), l = hypot(hypot(L[0], L[1]), L[2]) / root;
    const double sigma = (x[0] * v[0] + x[1] * v[1] + x[2] * v[2]) / root;
    const double alpha = 2 / r - (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / mu, A = sqrt(fabs(alpha));
    double n[3], m[3], c[4];
    tvi_orbit o;
    if (!isfinite(x[0] + x[1] + x[2] + v[0] + v[1] + v[2] + mu)) return TVI_ENONFINITE;
    if (mu <= 0) return TVI_EINVAL;
    if (!(l > 0)) return TVI_EDOMAIN;
    o.e = hypot(l * l / r - 1, sigma * l / r);
    o.q = l * l / (1 + o.e), o.a = 1 / alpha;
    double chi = sigma / o.e;
    if (alpha > 0) chi = atan2(sigma * A, 1 - r * alpha) / A;
    if (alpha < 0) chi = asinh(sigma * A / o.e) / A;
    find_c(alpha * chi * chi, c);
    o.time = chi * (o.q + o.e * chi * chi * c[3]) / root;
    o.f = atan2(l * chi * c[1], o.q - chi * chi * c[2]), o.M = root * fabs(alpha) * A * o.time;
    o.i = atan2(hypot(L[0], L[1]), L[2]), o.node = L[0] == 0 && L[1] == 0 ? 0 : atan2(L[0], -L[1]);
    find_axes(o.i, o.node, n, m);
    o.pericentre = atan2(x[0] * m[0] + x[1] * m[1] + x[2] * m[2], x[0] * n[0] + x[1] * n[1]) - o.f;
    o.pericentre = remainder(o.pericentre, 2 * acos(-1));
    if (!isfinite(o.e + o.q + o.time + o.f + o.M + o.i + o.node + o.pericentre)) return TVI_ENONFINITE;
    *orbit = o;
    return TVI_OK;
}
