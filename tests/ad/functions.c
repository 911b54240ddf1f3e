/* functions.c - Implements functions.h. */
#include "functions.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define UNARY(name)                                                                                                    \
    static void record_##name(double c, const jet x[], jet z[])                                                        \
    {                                                                                                                  \
        (void)c;                                                                                                       \
        z[0] = jet_##name(x[0]);                                                                                       \
    }
#define BINARY(name)                                                                                                   \
    static void record_##name(double c, const jet x[], jet z[])                                                        \
    {                                                                                                                  \
        (void)c;                                                                                                       \
        z[0] = jet_##name(x[0], x[1]);                                                                                 \
    }

BINARY(add)
BINARY(sub)
BINARY(mul)
BINARY(div)
UNARY(neg)
UNARY(sqr)
UNARY(sqrt)
UNARY(exp)
UNARY(log)
UNARY(sin)
UNARY(cos)
UNARY(tan)
UNARY(asin)
UNARY(acos)
UNARY(atan)
UNARY(sinh)
UNARY(cosh)
UNARY(tanh)
UNARY(asinh)
UNARY(acosh)
UNARY(atanh)
UNARY(erf)
BINARY(atan2)
BINARY(hypot)

static void record_pow(double c, const jet x[], jet z[]) { z[0] = jet_pow(x[0], c); }

static void record_sum(double c, const jet x[], jet z[])
{
    (void)c;
    z[0] = jet_sum(x, 3);
}

static void record_dot(double c, const jet x[], jet z[])
{
    (void)c;
    z[0] = jet_dot(x, x + 3, 3);
}

static void record_linear(double c, const jet x[], jet z[])
{
    (void)c;
    z[0] = jet_sub(jet_add(jet_mul(3, x[0]), 0.5), jet_div(x[1], 4));
}

/* ---- Functions as users write them ------------------------------------------------------------------------------- */

/* -1/r + 0.1 t x y / r^3 + r^0.3, r^2 = x^2 + y^2: a perturbed Kepler potential of (x, y, t). */
static void record_kepler(double c, const jet x[], jet z[])
{
    (void)c;
    const jet r2 = jet_add(jet_sqr(x[0]), jet_sqr(x[1]));
    const jet tide = jet_mul(jet_mul(x[0], x[1]), jet_mul(0.1, x[2]));
    z[0] = jet_add(jet_sub(jet_mul(tide, jet_pow(r2, -1.5)), jet_div(1, jet_sqrt(r2))), jet_pow(r2, 0.15));
}

/* The Lagrangian of the double pendulum with masses 2 and 1, rods 1 and 3/2: inputs (q1, q2, v1, v2). */
static void record_pendulums(double c, const jet x[], jet z[])
{
    (void)c;
    const jet kinetic = jet_add(jet_mul(1.5, jet_sqr(x[2])), jet_mul(1.125, jet_sqr(x[3])));
    const jet coupling = jet_mul(jet_mul(1.5, jet_cos(jet_sub(x[0], x[1]))), jet_mul(x[2], x[3]));
    const jet potential = jet_add(jet_mul(-29.4, jet_cos(x[0])), jet_mul(-14.7, jet_cos(x[1])));
    z[0] = jet_sub(jet_add(kinetic, coupling), potential);
}

/* A lattice of five springs with cubic and quartic terms: displacements of four masses, both ends fixed. */
static void record_lattice(double c, const jet x[], jet z[])
{
    (void)c;
    jet energy[15];
    for (int i = 0; i <= 4; i++) {
        const jet d = jet_sub(i < 4 ? x[i] : jet_const(0), i > 0 ? x[i - 1] : jet_const(0));
        energy[3 * i] = jet_div(jet_sqr(d), 2);
        energy[3 * i + 1] = jet_mul(0.25, jet_pow(d, 3));
        energy[3 * i + 2] = jet_mul(0.1, jet_pow(d, 5));
    }
    z[0] = jet_sum(energy, 15);
}

/* A relativistic Hamiltonian sqrt(1 + p^2) + log cosh x + tanh(x p) exp(-x^2) of (x, p). */
static void record_relativistic(double c, const jet x[], jet z[])
{
    (void)c;
    const jet energy = jet_sqrt(jet_add(1, jet_sqr(x[1])));
    const jet well = jet_log(jet_cosh(x[0]));
    const jet bump = jet_mul(jet_tanh(jet_mul(x[0], x[1])), jet_exp(jet_neg(jet_sqr(x[0]))));
    z[0] = jet_add(jet_add(energy, well), bump);
}

/* Every operation once, nested, with equal parts that are shared: inputs (x, y, t). */
static void record_medley(double c, const jet x[], jet z[])
{
    (void)c;
    const jet u = jet_mul(x[0], x[1]), e = jet_exp(jet_mul(-0.5, x[2]));
    const jet wave = jet_mul(jet_sin(u), jet_cos(u)), arc = jet_asin(jet_div(x[1], 4));
    const jet growth = jet_div(jet_sinh(x[2]), jet_add(2, jet_sqr(jet_cosh(u))));
    const jet turn = jet_add(jet_atan(jet_mul(x[1], e)), jet_acos(jet_mul(0.2, x[0])));
    const jet root = jet_sqrt(jet_add(jet_sqr(u), jet_pow(x[2], 1.5)));
    const jet bend = jet_sub(jet_tan(jet_div(x[0], 3)), jet_mul(jet_tanh(x[2]), jet_log(root)));
    z[0] = jet_sum((const jet[]){wave, arc, growth, turn, bend, jet_mul(e, arc)}, 6);
    z[1] = jet_div(jet_mul(wave, root), jet_sub(3, turn));
}

/* Distances and angles of two points in the plane, (x0, x1) and (x2, x3), in runs of two; and of numbers. */
static void record_polar(double c, const jet x[], jet z[])
{
    (void)c;
    z[0] = jet_add(jet_atan2(x[1], x[0]), jet_mul(2, jet_atan2(x[3], x[2])));
    z[1] = jet_mul(jet_hypot(x[0], x[2]), jet_hypot(x[1], x[3]));
    z[2] = jet_sub(jet_atan2(2, x[0]), jet_hypot(x[1], 3));
    z[3] = jet_mul(jet_erf(x[1]), jet_asinh(jet_mul(x[0], x[3])));
}

/* The forces of gravity among six bodies of masses 1, 2, .. 6 in space: inputs and outputs [body][axis]. */
static void record_gravity(double c, const jet x[], jet z[])
{
    (void)c;
    for (int i = 0; i < 18; i++) z[i] = jet_const(0);
    for (int i = 0; i < 6; i++) {
        for (int j = i + 1; j < 6; j++) {
            jet d[3];
            for (int axis = 0; axis < 3; axis++) d[axis] = jet_sub(x[3 * j + axis], x[3 * i + axis]);
            const jet pull = jet_mul((i + 1) * (j + 1), jet_pow(jet_dot(d, d, 3), -1.5));
            for (int axis = 0; axis < 3; axis++) {
                const jet f = jet_mul(pull, d[axis]);
                z[3 * i + axis] = jet_add(z[3 * i + axis], f);
                z[3 * j + axis] = jet_sub(z[3 * j + axis], f);
            }
        }
    }
}

/* The powers c, c + 1, .. -1/2 of each input. */
static void record_inverse_roots(double c, const jet x[], jet z[])
{
    for (double power = c; power < 0; power++)
        for (int i = 0; i < 3; i++) *z++ = jet_pow(x[i], power);
}

/* Cubes of neighbours, whose squares nothing else needs, and one whose square something does; and an output that
 * another one reads. */
static void record_cubes(double c, const jet x[], jet z[])
{
    (void)c;
    for (int i = 0; i < 3; i++) {
        const jet d = jet_sub(x[i], x[(i + 1) % 3]);
        z[i] = jet_mul(jet_mul(4, d), jet_sqr(d));
    }
    z[3] = jet_add(jet_mul(x[0], jet_sqr(x[0])), jet_mul(x[1], jet_sqr(x[0])));
    z[4] = jet_sqr(z[3]);
}

/* Sums of products: of squares, of one multiple, of both kinds, of as many terms as one operation takes and of one
 * more, and with a product that something else needs, too. */
static void record_products(double c, const jet x[], jet z[])
{
    (void)c;
    const jet shared = jet_mul(x[2], x[5]);
    jet five[5];
    for (int i = 0; i < 5; i++) five[i] = jet_mul(i + 1, jet_mul(x[i], jet_exp(x[i])));
    z[0] = jet_dot(x, x, 3);
    z[1] = jet_mul(-2, jet_mul(x[0], x[1]));
    z[2] = jet_sub(jet_mul(x[0], x[3]), jet_mul(3, jet_mul(x[1], x[2])));
    z[3] = jet_sub(jet_mul(x[3], x[3]), jet_mul(x[4], x[1]));
    z[4] =
        jet_sum((const jet[]){jet_mul(x[0], x[2]), jet_mul(x[1], x[3]), jet_mul(x[2], x[4]), jet_mul(x[3], x[5])}, 4);
    z[5] = jet_sum(five, 5);
    z[6] = jet_add(1, jet_mul(x[5], x[5]));
    z[7] = jet_add(shared, jet_mul(x[3], x[4]));
    z[8] = jet_div(shared, 2);
}

/* Sums of more terms than stay in registers, three in one run. */
static void record_sums(double c, const jet x[], jet z[])
{
    jet term[7];
    (void)c;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 7; j++) term[j] = jet_mul(1 + (3 * i + 2 * j) % 8, x[j]);
        z[i] = jet_sum(term, 7);
    }
}

/* ---- The tables -------------------------------------------------------------------------------------------------- */

const function operations[] = {
    {"add", record_add, 2, 1, 0, {1.25, -0.7}, 1e-14},
    {"sub", record_sub, 2, 1, 0, {1.25, -0.7}, 1e-14},
    {"neg", record_neg, 1, 1, 0, {1.25}, 1e-14},
    {"linear", record_linear, 2, 1, 0, {1.25, -0.7}, 1e-14},
    {"sum", record_sum, 3, 1, 0, {1.25, -0.7, 2}, 1e-14},
    {"dot", record_dot, 6, 1, 0, {1.25, -0.7, 2, 0.3, 1, -3}, 1e-14},
    {"mul", record_mul, 2, 1, 0, {1.25, -0.7}, 1e-14},
    {"div", record_div, 2, 1, 0, {2.25, -0.8}, 4e-14},
    {"div", record_div, 2, 1, 0, {-0.3, 2}, 1e-14},
    {"sqr", record_sqr, 1, 1, 0, {-1.25}, 1e-14},
    {"sqrt", record_sqrt, 1, 1, 0, {0.8}, 1e-14},
    {"sqrt", record_sqrt, 1, 1, 0, {40}, 1e-14},
    {"pow", record_pow, 1, 1, -1, {-0.9}, 1e-14},
    {"pow", record_pow, 1, 1, 3, {-1.3}, 1e-14},
    {"pow", record_pow, 1, 1, 7, {0.5}, 1e-14},
    {"pow", record_pow, 1, 1, 0.5, {1.3}, 1e-14},
    {"pow", record_pow, 1, 1, -3, {-1.3}, 1e-14},
    {"pow", record_pow, 1, 1, 1.5, {0.7}, 1e-14},
    {"pow", record_pow, 1, 1, -2.5, {1.7}, 1e-14},
    {"pow", record_pow, 1, 1, -1.5, {1.7}, 1e-14},
    {"pow", record_pow, 1, 1, 8.5, {1.1}, 1e-14},
    {"pow", record_pow, 1, 1, 1.0 / 3, {0.9}, 1e-14},
    {"pow", record_pow, 1, 1, -9, {-1.6}, 1e-14},
    {"exp", record_exp, 1, 1, 0, {0.6}, 1e-14},
    {"exp", record_exp, 1, 1, 0, {-7}, 1e-14},
    {"log", record_log, 1, 1, 0, {0.6}, 1e-14},
    {"log", record_log, 1, 1, 0, {50}, 1e-14},
    {"sin", record_sin, 1, 1, 0, {0.6}, 1e-14},
    {"sin", record_sin, 1, 1, 0, {-20}, 1e-14},
    {"cos", record_cos, 1, 1, 0, {0.6}, 1e-14},
    {"cos", record_cos, 1, 1, 0, {-20}, 1e-14},
    {"tan", record_tan, 1, 1, 0, {0.6}, 1e-14},
    {"tan", record_tan, 1, 1, 0, {-2.5}, 1e-14},
    {"asin", record_asin, 1, 1, 0, {0.3}, 1e-14},
    {"asin", record_asin, 1, 1, 0, {-0.5}, 1e-14},
    {"acos", record_acos, 1, 1, 0, {0.3}, 1e-14},
    {"acos", record_acos, 1, 1, 0, {-0.5}, 1e-14},
    {"atan", record_atan, 1, 1, 0, {0.3}, 1e-14},
    {"atan", record_atan, 1, 1, 0, {-5}, 1e-14},
    {"sinh", record_sinh, 1, 1, 0, {0.6}, 1e-14},
    {"sinh", record_sinh, 1, 1, 0, {-4}, 1e-14},
    {"cosh", record_cosh, 1, 1, 0, {0.6}, 1e-14},
    {"cosh", record_cosh, 1, 1, 0, {-4}, 1e-14},
    {"tanh", record_tanh, 1, 1, 0, {0.6}, 1e-14},
    {"tanh", record_tanh, 1, 1, 0, {-2}, 1e-14},
    {"asinh", record_asinh, 1, 1, 0, {0.3}, 1e-14},
    {"asinh", record_asinh, 1, 1, 0, {-5}, 1e-14},
    {"acosh", record_acosh, 1, 1, 0, {2.1}, 1e-14},
    {"acosh", record_acosh, 1, 1, 0, {40}, 1e-14},
    {"atanh", record_atanh, 1, 1, 0, {0.3}, 1e-14},
    {"atanh", record_atanh, 1, 1, 0, {-0.5}, 1e-14},
    {"erf", record_erf, 1, 1, 0, {0.6}, 1e-14},
    {"erf", record_erf, 1, 1, 0, {-1.4}, 1e-14},
    {"atan2", record_atan2, 2, 1, 0, {1.3, 2.1}, 1e-14},
    {"atan2", record_atan2, 2, 1, 0, {2.1, -1.3}, 1e-14},
    {"atan2", record_atan2, 2, 1, 0, {-2.3, -0.4}, 1e-14},
    {"hypot", record_hypot, 2, 1, 0, {1.3, 2.1}, 1e-14},
    {"hypot", record_hypot, 2, 1, 0, {-2.3, 0.4}, 1e-14},
};

const function compositions[] = {
    {"kepler", record_kepler, 3, 1, 0, {1.2, -0.9, 0.7}, 1e-13},
    {"pendulums", record_pendulums, 4, 1, 0, {0.4, -1.1, 0.8, 1.7}, 1e-13},
    {"sums", record_sums, 7, 3, 0, {0.7, -0.9, 1.1, 0.4, -1.3, 0.8, 0.6}, 1e-14},
    {"lattice", record_lattice, 4, 1, 0, {0.2, -0.4, 0.5, 0.1}, 1e-13},
    {"relativistic", record_relativistic, 2, 1, 0, {0.3, -0.8}, 1e-13},
    {"medley", record_medley, 3, 2, 0, {0.7, 0.9, 1.1}, 1e-13},
    {"polar", record_polar, 4, 4, 0, {2.1, -1.3, 1.7, 2.2}, 1e-13},
    {"products", record_products, 6, 9, 0, {0.7, -0.9, 1.1, 0.4, -1.3, 0.8}, 1e-13},
    {"inverse_roots", record_inverse_roots, 3, 6, -1.5, {0.7, 1.3, 2.1}, 1e-13},
    {"inverse_roots", record_inverse_roots, 3, 9, -2.5, {0.7, 1.3, 2.1}, 1e-13},
    {"inverse_roots", record_inverse_roots, 3, 12, -3.5, {0.7, 1.3, 2.1}, 1e-13},
    {"cubes", record_cubes, 3, 5, 0, {0.7, -0.9, 1.3}, 1e-13},
    {"gravity",
     record_gravity,
     18,
     18,
     0,
     {3, 0, 0, -3, 0, 0.5, 0, 3, 1, 0, -3, -1, 0.5, 0.2, 4, -0.3, 0.4, -4},
     1e-13},
};

const int operation_count = sizeof operations / sizeof operations[0];
const int composition_count = sizeof compositions / sizeof compositions[0];

const function *any_function(int i)
{
    return i < operation_count ? &operations[i] : &compositions[i - operation_count];
}

record_fn *operation_named(const char *name)
{
    for (int i = 0; i < operation_count; i++)
        if (!strcmp(operations[i].name, name)) return operations[i].record;
    abort();
}

void dense_series(const function *f, int degree, double x[])
{
    for (int i = 0; i < f->inputs; i++) {
        double *xi = x + i * (degree + 1);
        xi[0] = f->centre[i];
        for (int k = 1; k <= degree; k++) xi[k] = 0.25 * pow(0.5, k) * cos(1 + 0.8 * k + 1.3 * i);
    }
}

void dense_direction(const function *f, int number, int degree, double dx[])
{
    for (int i = 0; i < f->inputs; i++)
        for (int k = 0; k <= degree; k++)
            dx[i * (degree + 1) + k] = pow(0.5, k) * cos(0.4 + 1.7 * k + 0.9 * i + 0.6 * number);
}
