/* tvi_bodies.h - bodies that attract each other, and orbits of two of them: potential, time scale, masses, orbital
 * elements (docs/bodies.md). tvi.h does not include it. All of it is inline, allocates nothing and may be called by
 * several threads; for other languages the library exports the same functions. Names that begin with tvi_own_ are not
 * for users. tvi_last_error has no text for tvi_orbit_*. */
#ifndef TVI_BODIES_H
#define TVI_BODIES_H

#include "tvi.h"

#include <math.h>

#ifndef TVI_INLINE
#define TVI_INLINE static inline
#endif

/* ---- Bodies that attract each other ------------------------------------------------------------------------------ */

/* These are in tvi_bodies.h. Body i has the coordinates q[axes i], ..., q[axes i + axes - 1], n = bodies * axes. All
 * but the first three members may be 0. A body of mass 0 is a test particle: it moves as if it had 1e-30 of the largest
 * mass, attracts no other test particle, and g does not see it where two bodies have masses (docs/limits.md). */
typedef struct {
    int bodies, axes;           /* n at most TVI_MAX_DIMENSION; 1 to 3 axes */
    const double *mass;         /* [bodies], one a body */
    double G;                   /* 0 stands for 1 */
    double softening;           /* r^2 + softening^2 stands for r^2 */
    double J2, radius, pole[3]; /* of the oblate body; of the pole the length does not matter, 0 is the third axis */
    int oblate;                 /* its number, from 0 to bodies - 1 */
    double sharpness;           /* k of g; 0: 3 where one mass is ten times all others together, 1 elsewhere */
} tvi_bodies;

static inline double tvi_own_G(const tvi_bodies *b) { return b->G == 0 ? 1 : b->G; }

/* This is the mass of body i, or what stands for 0. */
static inline double tvi_own_mass(const tvi_bodies *b, int i)
{
    double most = 0;
    for (int j = 0; j < b->bodies && b->mass[i] == 0; j++) most = fmax(most, b->mass[j]);
    return b->mass[i] == 0 ? 1e-30 * most : b->mass[i];
}

/* For k = 0 it records the potential of two bodies, strength = G m_i m_j; otherwise their term of g, strength =
 * G (m_i + m_j). */
static inline jet tvi_own_pair(const tvi_bodies *b, double k, double strength, bool bulges, const jet x[],
                               const jet y[])
{
    const double *n = b->pole, length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    jet d[3], z = jet_const(0);
    for (int i = 0; i < b->axes; i++) d[i] = jet_sub(x[i], y[i]);
    const jet square = jet_add(jet_dot(d, d, b->axes), b->softening * b->softening);
    if (k != 0) return jet_mul(pow(strength, k / 3), jet_pow(square, -k / 2));
    const jet V = jet_mul(-strength, jet_pow(square, -0.5));
    if (!bulges || b->J2 == 0) return V;
    for (int i = 0; i < b->axes; i++) z = jet_add(z, jet_mul(length > 0 ? n[i] / length : i == 2, d[i]));
    const jet bulge = jet_sub(jet_mul(3, jet_mul(jet_sqr(z), jet_pow(square, -2.5))), jet_pow(square, -1.5));
    return jet_add(V, jet_mul(0.5 * strength * b->J2 * b->radius * b->radius, bulge));
}

/* Sums over pairs, i = 1, 2, ..., j < i, that have so many masses (1 or 2), in parts that the stack has room for. */
static inline jet tvi_own_sum(const tvi_bodies *b, double k, int masses, const jet q[])
{
    enum { PART = 1024 };
    const double G = tvi_own_G(b);
    jet term[PART], sum = jet_const(0);
    int count = 0;
    for (int i = 1; i < b->bodies; i++)
        for (int j = 0; j < i; j++) {
            const double one = b->mass[i], other = b->mass[j];
            if ((one != 0) + (other != 0) < masses) continue;
            const double strength = k != 0 ? G * (one + other) : G * tvi_own_mass(b, i) * tvi_own_mass(b, j);
            if (count == PART) sum = jet_add(sum, jet_sum(term, count)), count = 0;
            term[count++] =
                tvi_own_pair(b, k, strength, i == b->oblate || j == b->oblate, q + i * b->axes, q + j * b->axes);
        }
    return jet_add(sum, jet_sum(term, count));
}

/* This is a tvi_potential_fn, whose ctx is a tvi_bodies: V = -sum_{i<j} G m_i m_j / r_ij, and each pair with the oblate
 * body adds G m_i m_j J2 radius^2 (3 z^2 / r^2 - 1) / (2 r^3), z along the pole. */
TVI_INLINE jet tvi_bodies_potential(const jet q[], jet t, void *ctx)
{
    const tvi_bodies *b = (const tvi_bodies *)ctx;
    (void)t;
    return tvi_own_sum(b, 0, 1, q);
}

/* This is a tvi_rescale_fn, the g for tvi_system_rescaled (docs/adaptive.md), whose ctx is a tvi_bodies:
 *   g = (sum_{i<j} ((G (m_i + m_j))^(1/3) / r_ij)^k)^(-3/(2k)), of a single pair (r^3 / (G (m_i + m_j)))^(1/2).
 * Beside two or more masses it does not see test particles: an eccentric one needs tvi_bodies_field_scale. */
TVI_INLINE jet tvi_bodies_scale(const jet q[], const jet p[], jet t, void *ctx)
{
    const tvi_bodies *b = (const tvi_bodies *)ctx;
    double most = 0, sum = 0;
    int heavy = 0;
    (void)p, (void)t;
    for (int i = 0; i < b->bodies; i++) most = fmax(most, b->mass[i]), sum += b->mass[i], heavy += b->mass[i] > 0;
    const double k = b->sharpness > 0 ? b->sharpness : most > 10 * (sum - most) ? 3 : 1;
    return jet_pow(tvi_own_sum(b, k, heavy < 2 ? 1 : 2, q), -1.5 / k);
}

/* Records the potential of a mass of 1 at x[axes] that moves nobody. The bodies are at[n], numbers or jets of t. */
TVI_INLINE jet tvi_bodies_field(const tvi_bodies *b, const jet at[], const jet x[])
{
    jet V = jet_const(0);
    for (int i = 0; i < b->bodies; i++)
        V = jet_add(V, tvi_own_pair(b, 0, tvi_own_G(b) * b->mass[i], i == b->oblate, x, at + i * b->axes));
    return V;
}

/* Records the g of this motion, which is that of tvi_bodies_scale; a sharpness of 0 stands for 3. */
TVI_INLINE jet tvi_bodies_field_scale(const tvi_bodies *b, const jet at[], const jet x[])
{
    const double k = b->sharpness > 0 ? b->sharpness : 3;
    jet sum = jet_const(0);
    for (int i = 0; i < b->bodies; i++)
        if (b->mass[i] != 0)
            sum = jet_add(sum, tvi_own_pair(b, k, tvi_own_G(b) * b->mass[i], false, x, at + i * b->axes));
    return jet_pow(sum, -1.5 / k);
}

/* Sets mass[n] to the masses of the coordinates. */
TVI_INLINE void tvi_bodies_masses(const tvi_bodies *b, double mass[])
{
    for (int i = 0; i < b->bodies * b->axes; i++) mass[i] = tvi_own_mass(b, i / b->axes);
}

/* Makes the system of tvi_bodies_potential, and returns what tvi_system_potential returns. */
TVI_NODISCARD TVI_INLINE tvi_status tvi_bodies_system(tvi_system **out, const tvi_bodies *b)
{
    double mass[TVI_MAX_DIMENSION];
    const bool fits = b && b->mass && b->axes >= 1 && b->axes <= 3 && b->bodies <= TVI_MAX_DIMENSION / b->axes &&
                      (b->J2 == 0 || (b->oblate >= 0 && b->oblate < b->bodies));
    if (fits) tvi_bodies_masses(b, mass);
    return tvi_system_potential(out, fits ? b->bodies * b->axes : 0, mass, tvi_bodies_potential, (void *)b);
}

/* Sets p = M v, [n] each; they may be the same array. */
TVI_INLINE void tvi_bodies_momenta(const tvi_bodies *b, const double v[], double p[])
{
    for (int i = 0; i < b->bodies * b->axes; i++) p[i] = tvi_own_mass(b, i / b->axes) * v[i];
}

/* Sets v = M^-1 p. */
TVI_INLINE void tvi_bodies_velocities(const tvi_bodies *b, const double p[], double v[])
{
    for (int i = 0; i < b->bodies * b->axes; i++) v[i] = p[i] / tvi_own_mass(b, i / b->axes);
}

/* Finds the centre of mass, x[axes], and its velocity, v[axes]. */
TVI_INLINE void tvi_bodies_centre(const tvi_bodies *b, const double q[], const double p[], double x[], double v[])
{
    double mass = 0;
    for (int i = 0; i < b->bodies; i++) mass += tvi_own_mass(b, i);
    for (int k = 0; k < b->axes; k++) {
        x[k] = v[k] = 0;
        for (int i = 0; i < b->bodies; i++)
            x[k] += tvi_own_mass(b, i) / mass * q[i * b->axes + k], v[k] += p[i * b->axes + k] / mass;
    }
}

/* Moves q[n] and p[n] to the frame in which both are 0. */
TVI_INLINE void tvi_bodies_to_centre(const tvi_bodies *b, double q[], double p[])
{
    double x[3], v[3];
    tvi_bodies_centre(b, q, p, x, v);
    for (int i = 0; i < b->bodies * b->axes; i++)
        q[i] -= x[i % b->axes], p[i] -= tvi_own_mass(b, i / b->axes) * v[i % b->axes];
}

/* Finds L = sum q_i x p_i about the origin. Axes that the bodies do not have count as 0. */
TVI_INLINE void tvi_bodies_angular_momentum(const tvi_bodies *b, const double q[], const double p[], double L[3])
{
    L[0] = L[1] = L[2] = 0;
    for (int i = 0; i < b->bodies; i++)
        for (int k = 0; k < 3; k++) {
            const int u = (k + 1) % 3, w = (k + 2) % 3, at = i * b->axes;
            if (u < b->axes && w < b->axes) L[k] += q[at + u] * p[at + w] - q[at + w] * p[at + u];
        }
}

/* ---- Orbits of two bodies ---------------------------------------------------------------------------------------- */

/* Orbital elements, with angles in radians. An ellipse has e < 1 and a > 0, a parabola e = 1 and an infinite a, a
 * hyperbola e > 1 and a < 0. */
typedef struct {
    double a, q, e;             /* semimajor axis, distance of the pericentre q = a (1 - e), eccentricity */
    double i, node, pericentre; /* inclination, 0 to pi; longitude of the node; argument of the pericentre */
    double time;                /* since the pericentre, M (|a|^3 / mu)^(1/2) */
    double f, M;                /* true and mean anomaly, which are not read; M = 0 of a parabola */
} tvi_orbit;

/* The universal anomaly chi gives the way from the pericentre on every conic, with psi = chi^2 / a:
 *   x = q - chi^2 c2, y = (q (1 + e))^(1/2) chi c1, r = q + e chi^2 c2, mu^(1/2) time = q chi + e chi^3 c3,
 *   c_k(psi) = sum_j (-psi)^j / (2j + k)!. Neither the series nor the closed form cancels. */
static inline void tvi_own_c(double psi, double c[4])
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
static inline double tvi_own_chi(double q, double e, double alpha, double s)
{
    const double w = s / q, root = sqrt(fabs(alpha));
    double c[4], step = w, chi = w / sqrt(1 + pow(e * w * w / (6 * q), 2.0 / 3));
    if (alpha < 0) chi = fmin(chi, asinh((root * root * root * s + root * chi) / e) / root);
    for (int k = 0; k < 8 && fabs(step) > 4e-16 * chi; k++) {
        tvi_own_c(alpha * chi * chi, c);
        const double f = chi * (q + e * chi * chi * c[3]) - s, r = q + e * chi * chi * c[2];
        step = 5 * f / (r + sqrt(fabs(16 * r * r - 20 * f * e * chi * c[1])));
        chi -= step;
    }
    return chi;
}

/* Finds the unit vectors to the ascending node, and across it in the plane of the orbit. */
static inline void tvi_own_axes(double i, double node, double n[3], double m[3])
{
    n[0] = cos(node), n[1] = sin(node), n[2] = 0;
    m[0] = -n[1] * cos(i), m[1] = n[0] * cos(i), m[2] = sin(i);
}

/* Returns a b - c d to two units of its last place (Kahan). */
static inline double tvi_own_cross(double a, double b, double c, double d)
{
    const double cd = c * d;
    return fma(a, b, -cd) - fma(c, d, -cd);
}

/* Finds the place and the velocity of a body relative to another, mu = G (m_1 + m_2). One of q and a may be 0.
 *   TVI_EINVAL      mu <= 0, e < 0, i outside [0, pi], no q = a (1 - e) > 0; a, q and e that disagree
 *   TVI_ENONFINITE  an element but a, or what it leads to, is not finite */
TVI_NODISCARD TVI_INLINE tvi_status tvi_orbit_state(const tvi_orbit *orbit, double mu, double x[3], double v[3])
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
    const double chi = copysign(tvi_own_chi(q, e, alpha, root * fabs(time)), time);
    tvi_own_c(alpha * chi * chi, c);
    tvi_own_axes(orbit->i, orbit->node, n, m);
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

/* Finds all elements of a state, angles and M from -pi to pi. The node is 0 where i is 0 or pi.
 *   TVI_EINVAL      mu <= 0
 *   TVI_EDOMAIN     x and v on one line through the centre: no pericentre
 *   TVI_ENONFINITE  a number, or an element, is not finite */
TVI_NODISCARD TVI_INLINE tvi_status tvi_orbit_of(double mu, const double x[3], const double v[3], tvi_orbit *orbit)
{
    const double L[] = {tvi_own_cross(x[1], v[2], x[2], v[1]), tvi_own_cross(x[2], v[0], x[0], v[2]),
                        tvi_own_cross(x[0], v[1], x[1], v[0])};
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
    tvi_own_c(alpha * chi * chi, c);
    o.time = chi * (o.q + o.e * chi * chi * c[3]) / root;
    o.f = atan2(l * chi * c[1], o.q - chi * chi * c[2]), o.M = root * fabs(alpha) * A * o.time;
    o.i = atan2(hypot(L[0], L[1]), L[2]), o.node = L[0] == 0 && L[1] == 0 ? 0 : atan2(L[0], -L[1]);
    tvi_own_axes(o.i, o.node, n, m);
    o.pericentre = atan2(x[0] * m[0] + x[1] * m[1] + x[2] * m[2], x[0] * n[0] + x[1] * n[1]) - o.f;
    o.pericentre = remainder(o.pericentre, 2 * acos(-1));
    if (!isfinite(o.e + o.q + o.time + o.f + o.M + o.i + o.node + o.pericentre)) return TVI_ENONFINITE;
    *orbit = o;
    return TVI_OK;
}

#endif
