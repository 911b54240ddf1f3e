/* quad_series.c - Implements quad_series.h. The only file of quadruple precision: gcc, -std=gnu11, -lquadmath. */
#include "quad_series.h"

#ifndef TESTS_WITHOUT_QUAD

#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 256 };

typedef __float128 real;
typedef __complex128 quad;
typedef void quad_fn(double c, const quad x[], quad z[]);

/* ---- The functions ----------------------------------------------------------------------------------------------- */

#define QUAD(name, value)                                                                                              \
    static void quad_##name(double c, const quad x[], quad z[])                                                        \
    {                                                                                                                  \
        (void)c;                                                                                                       \
        z[0] = value;                                                                                                  \
    }

QUAD(add, x[0] + x[1])
QUAD(sub, x[0] - x[1])
QUAD(neg, -x[0])
QUAD(linear, 3 * x[0] + 0.5 - x[1] / 4)
QUAD(sum, x[0] + x[1] + x[2])
QUAD(dot, x[0] * x[3] + x[1] * x[4] + x[2] * x[5])
QUAD(mul, x[0] * x[1])
QUAD(div, x[0] / x[1])
QUAD(sqr, x[0] * x[0])
QUAD(sqrt, csqrtq(x[0]))
QUAD(pow, cpowq(x[0], c))
QUAD(exp, cexpq(x[0]))
QUAD(log, clogq(x[0]))
QUAD(sin, csinq(x[0]))
QUAD(cos, ccosq(x[0]))
QUAD(tan, ctanq(x[0]))
QUAD(asin, casinq(x[0]))
QUAD(acos, cacosq(x[0]))
QUAD(atan, catanq(x[0]))
QUAD(sinh, csinhq(x[0]))
QUAD(cosh, ccoshq(x[0]))
QUAD(tanh, ctanhq(x[0]))
QUAD(asinh, casinhq(x[0]))
QUAD(acosh, cacoshq(x[0]))
QUAD(atanh, catanhq(x[0]))

static quad radius_of(quad a, quad b) { return csqrtq(a * a + b * b); }

/* atan2(a, b), but on the cut a = 0, b < 0: the half of an angle is that of a right-angled triangle. */
static quad angle_of(quad a, quad b) { return 2 * catanq(a / (radius_of(a, b) + b)); }

/* 2 / sqrt(pi) sum_n (-1)^n z^(2n+1) / (n! (2n+1)), |z| < 3. */
static quad erf_of(quad z)
{
    quad power = z, sum = 0;
    for (int n = 0; n < 90; n++) {
        sum += power / (2 * n + 1);
        power *= -z * z / (n + 1);
    }
    return M_2_SQRTPIq * sum;
}

QUAD(erf, erf_of(x[0]))
QUAD(atan2, angle_of(x[0], x[1]))
QUAD(hypot, radius_of(x[0], x[1]))

static void quad_kepler(double c, const quad x[], quad z[])
{
    (void)c;
    const quad r2 = x[0] * x[0] + x[1] * x[1], r = csqrtq(r2);
    z[0] = -1 / r + (real)0.1 * x[2] * x[0] * x[1] / (r2 * r) + cexpq((real)0.15 * clogq(r2));
}

static void quad_pendulums(double c, const quad x[], quad z[])
{
    (void)c;
    z[0] = (real)1.5 * x[2] * x[2] + (real)1.125 * x[3] * x[3] + (real)1.5 * x[2] * x[3] * ccosq(x[0] - x[1]) +
           (real)29.4 * ccosq(x[0]) + (real)14.7 * ccosq(x[1]);
}

static void quad_lattice(double c, const quad x[], quad z[])
{
    (void)c;
    const quad end[6] = {0, x[0], x[1], x[2], x[3], 0};
    z[0] = 0;
    for (int i = 0; i < 5; i++) {
        const quad d = end[i + 1] - end[i];
        z[0] += d * d / 2 + (real)0.25 * d * d * d + (real)0.1 * d * d * d * d * d;
    }
}

static void quad_relativistic(double c, const quad x[], quad z[])
{
    (void)c;
    z[0] = csqrtq(1 + x[1] * x[1]) + clogq(ccoshq(x[0])) + ctanhq(x[0] * x[1]) * cexpq(-x[0] * x[0]);
}

static void quad_medley(double c, const quad x[], quad z[])
{
    (void)c;
    const quad u = x[0] * x[1], e = cexpq(-x[2] / 2), wave = csinq(2 * u) / 2, arc = casinq(x[1] / 4);
    const quad root = csqrtq(u * u + x[2] * csqrtq(x[2]));
    const quad turn = catanq(x[1] * e) + cacosq((real)0.2 * x[0]);
    z[0] = wave + arc * (1 + e) + csinhq(x[2]) / (2 + ccoshq(u) * ccoshq(u)) + turn + ctanq(x[0] / 3) -
           ctanhq(x[2]) * clogq(root);
    z[1] = wave * root / (3 - turn);
}

static void quad_polar(double c, const quad x[], quad z[])
{
    (void)c;
    z[0] = angle_of(x[1], x[0]) + 2 * angle_of(x[3], x[2]);
    z[1] = radius_of(x[0], x[2]) * radius_of(x[1], x[3]);
    z[2] = angle_of(2, x[0]) - radius_of(x[1], 3);
    z[3] = erf_of(x[1]) * casinhq(x[0] * x[3]);
}

static void quad_cubes(double c, const quad x[], quad z[])
{
    (void)c;
    for (int i = 0; i < 3; i++) {
        const quad d = x[i] - x[(i + 1) % 3];
        z[i] = 4 * d * d * d;
    }
    z[3] = x[0] * x[0] * (x[0] + x[1]);
    z[4] = z[3] * z[3];
}

/* The force on body i: sum over the others of m_i m_j (x_j - x_i) / r^3. */
static void quad_gravity(double c, const quad x[], quad z[])
{
    (void)c;
    for (int i = 0; i < 6; i++) {
        for (int axis = 0; axis < 3; axis++) z[3 * i + axis] = 0;
        for (int j = 0; j < 6; j++) {
            if (j == i) continue;
            const quad d[3] = {x[3 * j] - x[3 * i], x[3 * j + 1] - x[3 * i + 1], x[3 * j + 2] - x[3 * i + 2]};
            const quad r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            for (int axis = 0; axis < 3; axis++) z[3 * i + axis] += (i + 1) * (j + 1) * d[axis] / (r2 * csqrtq(r2));
        }
    }
}

static void quad_inverse_roots(double c, const quad x[], quad z[])
{
    for (double power = c; power < 0; power++)
        for (int i = 0; i < 3; i++) *z++ = cpowq(x[i], power);
}

static void quad_products(double c, const quad x[], quad z[])
{
    (void)c;
    z[0] = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
    z[1] = -2 * x[0] * x[1];
    z[2] = x[0] * x[3] - 3 * x[1] * x[2];
    z[3] = x[3] * x[3] - x[4] * x[1];
    z[4] = x[0] * x[2] + x[1] * x[3] + x[2] * x[4] + x[3] * x[5];
    z[5] = 0;
    for (int i = 0; i < 5; i++) z[5] += (i + 1) * x[i] * cexpq(x[i]);
    z[6] = 1 + x[5] * x[5];
    z[7] = x[2] * x[5] + x[3] * x[4];
    z[8] = x[2] * x[5] / 2;
}

static void quad_sums(double c, const quad x[], quad z[])
{
    (void)c;
    for (int i = 0; i < 3; i++) {
        z[i] = 0;
        for (int j = 0; j < 7; j++) z[i] += (1 + (3 * i + 2 * j) % 8) * x[j];
    }
}

#define NAMED(name)                                                                                                    \
    {                                                                                                                  \
#name, quad_##name                                                                                             \
    }
static const struct {
    const char *name;
    quad_fn *value;
} quad_functions[] = {
    NAMED(add),       NAMED(sub),           NAMED(neg),          NAMED(linear), NAMED(sum),      NAMED(dot),
    NAMED(mul),       NAMED(div),           NAMED(sqr),          NAMED(sqrt),   NAMED(pow),      NAMED(exp),
    NAMED(log),       NAMED(sin),           NAMED(cos),          NAMED(tan),    NAMED(asin),     NAMED(acos),
    NAMED(atan),      NAMED(sinh),          NAMED(cosh),         NAMED(tanh),   NAMED(asinh),    NAMED(acosh),
    NAMED(atanh),     NAMED(erf),           NAMED(atan2),        NAMED(hypot),  NAMED(polar),    NAMED(kepler),
    NAMED(pendulums), NAMED(lattice),       NAMED(relativistic), NAMED(medley), NAMED(products), NAMED(gravity),
    NAMED(sums),      NAMED(inverse_roots), NAMED(cubes),
};

static quad_fn *find_function(const char *name)
{
    for (size_t i = 0; i < sizeof quad_functions / sizeof quad_functions[0]; i++)
        if (!strcmp(quad_functions[i].name, name)) return quad_functions[i].value;
    abort();
}

/* ---- Cauchy's integral ------------------------------------------------------------------------------------------- */

/* w^j, j < M. */
static void unit_roots(quad root[])
{
    const real angle = 2 * acosq(-1) / POINTS;
    for (int j = 0; j < POINTS; j++) root[j] = cexpiq(angle * j);
}

/* The values of f(x + e dx) at radius * w^j, j <= M/2: the others are their conjugates. */
static void values_on_circle(const function *f, int degree, double radius, const quad root[], real e, const double x[],
                             const double dx[], quad value[][OUTPUTS_MAX])
{
    quad_fn *evaluate = find_function(f->name);
    for (int j = 0; j <= POINTS / 2; j++) {
        const quad s = radius * root[j];
        quad at[INPUTS_MAX];
        for (int i = 0; i < f->inputs; i++) {
            at[i] = 0;
            for (int k = degree; k >= 0; k--)
                at[i] = at[i] * s + ((real)x[i * (degree + 1) + k] + e * dx[i * (degree + 1) + k]);
        }
        evaluate(f->c, at, value[j]);
    }
}

/* z += weight times the coefficients of f(x + e dx). */
static void add_coefficients(const function *f, int degree, double radius, real e, const double x[], const double dx[],
                             real weight, real z[])
{
    quad value[POINTS / 2 + 1][OUTPUTS_MAX], root[POINTS];
    unit_roots(root);
    values_on_circle(f, degree, radius, root, e, x, dx, value);
    for (int i = 0; i < f->outputs; i++) {
        for (int k = 0; k <= degree; k++) {
            real sum = 0;
            for (int j = 0; j <= POINTS / 2; j++) {
                const int twice = j == 0 || j == POINTS / 2 ? 1 : 2;
                const quad v = value[j][i], w = root[j * k % POINTS];
                sum += twice * (crealq(v) * crealq(w) + cimagq(v) * cimagq(w)); /* the real part of v / w */
            }
            z[i * (degree + 1) + k] += weight * sum / (POINTS * powq(radius, k));
        }
    }
}

static void round_to_double(const function *f, int degree, const real from[], double to[])
{
    for (int i = 0; i < f->outputs * (degree + 1); i++) to[i] = (double)from[i];
}

void quad_series(const function *f, int degree, double radius, const double x[], double z[])
{
    real exact[OUTPUTS_MAX * ORDERS] = {0};
    add_coefficients(f, degree, radius, 0, x, x, 1, exact);
    round_to_double(f, degree, exact, z);
}

void quad_tangent(const function *f, int degree, double radius, const double x[], const double dx[], double dz[])
{
    static const int at[] = {-2, -1, 1, 2}, weight[] = {1, -8, 8, -1};
    const real e = (real)1e-5;
    real exact[OUTPUTS_MAX * ORDERS] = {0};
    for (int i = 0; i < 4; i++) add_coefficients(f, degree, radius, at[i] * e, x, dx, weight[i] / (12 * e), exact);
    round_to_double(f, degree, exact, dz);
}

#endif
