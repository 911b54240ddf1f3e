/* tvi_bodies.h - declares bodies that attract each other, and orbits of two of them: potential, time scale, masses,
 * orbital elements (docs/bodies.md). tvi.h does not include it. The functions allocate nothing but systems, and may be
 * called by several threads. */
#ifndef TVI_BODIES_H
#define TVI_BODIES_H

#include "tvi.h"

#include <math.h> /* INFINITY, the semimajor axis of a parabola */

#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif
#ifdef __cplusplus
#if defined(__clang__)
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wreturn-type-c-linkage" /* a jet is passed as in C (docs/bindings.md) */
#endif
extern "C" {
#endif

/* ---- Bodies that attract each other ------------------------------------------------------------------------------ */

/* These are in tvi_bodies.h. Body i has the coordinates q[axes i], ..., q[axes i + axes - 1], n = bodies * axes. All
 * but the first three members may be 0. A body of mass 0 is a test particle: it moves as if it had 1e-30 of the largest
 * mass, and attracts no other test particle (docs/limits.md). */
typedef struct {
    int bodies, axes;           /* n at most TVI_MAX_DIMENSION; 1 to 3 axes */
    const double *mass;         /* [bodies], one a body, not all of them 0 */
    double G;                   /* 0 stands for 1 */
    double softening;           /* r^2 + softening^2 stands for r^2 */
    double J2, radius, pole[3]; /* of the oblate body; of the pole the length does not matter, 0 is the third axis */
    int oblate;                 /* its number, from 0 to bodies - 1 */
    double sharpness;           /* k of g; 0: 3 where one mass is ten times all others together, 1 elsewhere */
} tvi_bodies;

/* Tells whether these are bodies; tvi_last_error names the member that is wrong. The functions below that record jets
 * return a number that is not finite for bodies that it refuses, so that the system is refused, too; those of states do
 * nothing where bodies or axes are out of range.
 *   TVI_EINVAL      a count out of range, a negative mass or masses that are all 0, a test particle whose mass is less
 *                   than the least double, J2 without radius > 0 or without an oblate body, sharpness < 0
 *   TVI_ENONFINITE  a number is not finite */
TVI_NODISCARD tvi_status tvi_bodies_check(const tvi_bodies *b);

/* Makes the system of tvi_bodies_potential, and returns what tvi_bodies_check or tvi_system_potential return. */
TVI_NODISCARD tvi_status tvi_bodies_system(tvi_system **out, const tvi_bodies *b);

/* This is a tvi_potential_fn, whose ctx is a tvi_bodies: V = -sum_{i<j} G m_i m_j / r_ij, and each pair with the oblate
 * body adds G m_i m_j J2 radius^2 (3 z^2 / r^2 - 1) / (2 r^3), z along the pole. */
jet tvi_bodies_potential(const jet q[], jet t, void *ctx);

/* This is a tvi_rescale_fn, the g for tvi_system_rescaled (docs/adaptive.md), whose ctx is a tvi_bodies:
 *   g = (sum_{i<j} ((G (m_i + m_j))^(1/3) / r_ij)^k)^(-3/(2k)), of a single pair (r^3 / (G (m_i + m_j)))^(1/2),
 * over all pairs of which one has a mass. With test particles tvi_system_rescaled makes the reversible form of it. */
jet tvi_bodies_scale(const jet q[], const jet p[], jet t, void *ctx);

/* Records the potential of a mass of 1 at x[axes] that moves nobody. The bodies are at[n], numbers or jets of t. */
jet tvi_bodies_field(const tvi_bodies *b, const jet at[], const jet x[]);

/* Records the g of this motion, which is that of tvi_bodies_scale; a sharpness of 0 stands for 3. */
jet tvi_bodies_field_scale(const tvi_bodies *b, const jet at[], const jet x[]);

/* Sets mass[n] to the masses of the coordinates. */
void tvi_bodies_masses(const tvi_bodies *b, double mass[]);

/* Sets p = M v, [n] each; they may be the same array. */
void tvi_bodies_momenta(const tvi_bodies *b, const double v[], double p[]);

/* Sets v = M^-1 p. */
void tvi_bodies_velocities(const tvi_bodies *b, const double p[], double v[]);

/* Finds the centre of mass, x[axes], and its velocity, v[axes]. */
void tvi_bodies_centre(const tvi_bodies *b, const double q[], const double p[], double x[], double v[]);

/* Moves q[n] and p[n] to the frame in which both are 0. */
void tvi_bodies_to_centre(const tvi_bodies *b, double q[], double p[]);

/* Finds L = sum q_i x p_i about the origin. Axes that the bodies do not have count as 0. */
void tvi_bodies_angular_momentum(const tvi_bodies *b, const double q[], const double p[], double L[3]);

/* ---- Orbits of two bodies ---------------------------------------------------------------------------------------- */

/* Orbital elements, with angles in radians. An ellipse has e < 1 and a > 0, a parabola e = 1 and an infinite a, a
 * hyperbola e > 1 and a < 0. e, i and node are always read; others that are 0 are not given. Give a or q; pericentre or
 * longitude_of_pericentre, which are 0 where neither is given; and one of time, f, M and mean_longitude, without which
 * the body is at the pericentre. Elements that are given twice must agree. tvi_orbit_of sets all members: for another
 * place on its orbit, set the other three to 0,
 *     orbit.time += 3, orbit.f = orbit.M = orbit.mean_longitude = 0;
 * A given angle or time of 0 beside others is written -0.0. */
typedef struct {
    double a, q, e;                 /* semimajor axis, distance of the pericentre q = a (1 - e), eccentricity */
    double i, node, pericentre;     /* inclination, 0 to pi; longitude of the node; argument of the pericentre */
    double time;                    /* since the pericentre, M (|a|^3 / mu)^(1/2) */
    double f, M;                    /* true and mean anomaly; M of a parabola is 0 */
    double mean_longitude;          /* node + pericentre + M */
    double longitude_of_pericentre; /* node + pericentre */
} tvi_orbit;

/* Finds the place and the velocity of a body relative to another, mu = G (m_1 + m_2). tvi_last_error names what is
 * wrong. Two elements agree if a change of each by 1e-12 of itself makes them the same, angles and ellipses apart from
 * whole revolutions.
 *   TVI_EINVAL      mu <= 0, e < 0, i outside [0, pi], no q = a (1 - e) > 0; a, q and e, angles of the pericentre, or
 *                   places on the orbit that disagree; f outside of the asymptotes; M of a parabola other than 0
 *   TVI_ENONFINITE  an element but a, or what it leads to, is not finite */
TVI_NODISCARD tvi_status tvi_orbit_state(const tvi_orbit *orbit, double mu, double x[3], double v[3]);

/* Finds all elements of a state: angles from -pi to pi, M and both longitudes so on ellipses only. The node is 0 where
 * i is 0 or pi.
 *   TVI_EINVAL      mu <= 0
 *   TVI_EDOMAIN     x and v on one line through the centre: no pericentre
 *   TVI_ENONFINITE  a number, or an element, is not finite, or too small for a double */
TVI_NODISCARD tvi_status tvi_orbit_of(double mu, const double x[3], const double v[3], tvi_orbit *orbit);

#ifdef __cplusplus
}
#if defined(__clang__)
#pragma clang diagnostic pop
#endif
#endif
#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#endif
