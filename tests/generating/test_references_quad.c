/* test_references_quad.c - Tests where the general scenes are at their ends, from Hamilton's equations derived by hand,
 * in quadruple precision (gcc only): shares nothing with the library. A scene's reference that is not this is printed
 * as it should be. */
#include "equations_quad.h"
#include "generating.h"

#include <quadmath.h>
#include <stdio.h>

/* ---- The equations ----------------------------------------------------------------------------------------------- */

/* M v = p, M = ((m1 + m2) l1^2, c; c, m2 l2^2), c = m2 l1 l2 cos(q1 - q2); p' = L_q. */
static void double_pendulum(const quad_point *x, quad_point *dx)
{
    const quad m1 = 1, m2 = (quad)5 / 8, l1 = 1, l2 = (quad)3 / 4, g = (quad)157 / 16, angle = x->q[0] - x->q[1];
    const quad a = (m1 + m2) * l1 * l1, b = m2 * l2 * l2, k = m2 * l1 * l2, c = k * cosq(angle), det = a * b - c * c;
    dx->q[0] = (b * x->p[0] - c * x->p[1]) / det;
    dx->q[1] = (a * x->p[1] - c * x->p[0]) / det;
    const quad torque = k * dx->q[0] * dx->q[1] * sinq(angle);
    dx->p[0] = -torque - (m1 + m2) * g * l1 * sinq(x->q[0]);
    dx->p[1] = torque - m2 * g * l2 * sinq(x->q[1]);
}

/* m v = p - e A, p' = e (dA/dq)^T v, A = s (-y, x, 0) with s = (1 + z^2)/2. */
static void magnetic(const quad_point *x, quad_point *dx)
{
    const quad m = (quad)3 / 4, e = (quad)5 / 4, s = (1 + x->q[2] * x->q[2]) / 2;
    dx->q[0] = (x->p[0] + e * s * x->q[1]) / m;
    dx->q[1] = (x->p[1] - e * s * x->q[0]) / m;
    dx->q[2] = x->p[2] / m;
    dx->p[0] = e * s * dx->q[1];
    dx->p[1] = -e * s * dx->q[0];
    dx->p[2] = e * x->q[2] * (x->q[0] * dx->q[1] - x->q[1] * dx->q[0]);
}

static void nonseparable(const quad_point *x, quad_point *dx)
{
    const quad q = x->q[0], p = x->p[0];
    dx->q[0] = (q * q + 1) * p;
    dx->p[0] = -q * (p * p + 1);
}

/* x_i' = -2 sum_j G_j (y_i - y_j)/r^2, y_i' = 2 sum_j G_j (x_i - x_j)/r^2. */
static void vortices(const quad_point *x, quad_point *dx)
{
    static const quad root[] = {1, 2, 1, 0.5};
    for (int i = 0; i < 4; i++) {
        dx->q[i] = dx->p[i] = 0;
        for (int j = 0; j < 4; j++) {
            if (j == i) continue;
            const quad across = x->q[i] / root[i] - x->q[j] / root[j], up = x->p[i] / root[i] - x->p[j] / root[j];
            const quad turn = 2 * root[i] * root[j] * root[j] / (across * across + up * up);
            dx->q[i] -= turn * up;
            dx->p[i] += turn * across;
        }
    }
}

static void degenerate(const quad_point *x, quad_point *dx)
{
    dx->q[0] = sinq(x->q[0]);
    dx->p[0] = sinq(x->q[0]) - x->p[0] * cosq(x->q[0]);
}

const quad_equations equations[EQUATIONS] = {
    {&scene_double_pendulum, double_pendulum}, {&scene_magnetic, magnetic},
    {&scene_nonseparable, nonseparable},       {&scene_vortices, vortices},
    {&scene_degenerate, degenerate},
};

typedef void quad_field(const quad_point *x, quad_point *dx);

/* ---- Gragg's method, extrapolated -------------------------------------------------------------------------------- */

static void move(int n, const quad_point *x, quad h, const quad_point *slope, quad_point *out)
{
    for (int i = 0; i < n; i++) {
        out->q[i] = x->q[i] + h * slope->q[i];
        out->p[i] = x->p[i] + h * slope->p[i];
    }
}

/* The explicit midpoint rule over `steps` (even) steps in H: its error has an expansion in (H/steps)^2. */
static quad_point gragg(int n, quad_field *field, const quad_point *x, quad H, int steps)
{
    quad_point before = *x, now, slope;
    field(x, &slope);
    move(n, x, H / steps, &slope, &now);
    for (int step = 1; step < steps; step++) {
        const quad_point kept = now;
        field(&now, &slope);
        move(n, &before, 2 * H / steps, &slope, &now);
        before = kept;
    }
    return now;
}

/* From 2, 4, ..., 2 rows steps, by Aitken and Neville. */
static void extrapolated_step(int n, quad_field *field, int rows, quad H, quad_point *x)
{
    quad_point table[rows];
    for (int row = 0; row < rows; row++) {
        quad_point next = gragg(n, field, x, H, 2 * (row + 1));
        for (int column = 0; column < row; column++) {
            const quad_point before = table[column];
            const quad ratio = (quad)(row + 1) / (row - column), factor = 1 / (ratio * ratio - 1);
            quad_point change;
            move(n, &next, -1, &before, &change);
            table[column] = next;
            move(n, &next, factor, &change, &next);
        }
        table[row] = next;
    }
    *x = table[rows - 1];
}

static quad_point integrate(const scene *s, quad_field *field, int rows, int steps)
{
    quad_point x = {{0}, {0}};
    for (int i = 0; i < s->n; i++) {
        x.q[i] = s->q[i];
        x.p[i] = s->p[i];
    }
    for (int step = 0; step < steps; step++) extrapolated_step(s->n, field, rows, s->t_end / (quad)steps, &x);
    return x;
}

/* ---- The references ---------------------------------------------------------------------------------------------- */

static void print(const scene *s, const quad_point *x)
{
    fprintf(stderr, "%s:\n", s->name);
    for (int i = 0; i < 2 * s->n; i++) {
        char text[64];
        quadmath_snprintf(text, sizeof text, "%.25Qe", i < s->n ? x->q[i] : x->p[i - s->n]);
        fprintf(stderr, "    %s,\n", text);
    }
}

/* Two runs of different order and step agree to 25 digits, and the reference is their rounding. */
START_TEST(reference_is_the_solution)
{
    const scene *s = equations[_i].scene;
    const quad_point x = integrate(s, equations[_i].field, 12, 120), other = integrate(s, equations[_i].field, 10, 250);
    quad size = 0;
    bool good = true;
    for (int i = 0; i < s->n; i++) size = fmaxq(size, fmaxq(fabsq(x.q[i]), fabsq(x.p[i])));
    for (int i = 0; i < s->n; i++) {
        ck_assert_double_lt((double)(fabsq(x.q[i] - other.q[i]) / size), 1e-25);
        ck_assert_double_lt((double)(fabsq(x.p[i] - other.p[i]) / size), 1e-25);
        good = good && (double)x.q[i] == s->reference[i] && (double)x.p[i] == s->reference[s->n + i];
    }
    if (!good) print(s, &x);
    ck_assert_msg(good, "%s: the reference is another", s->name);
}
END_TEST

Suite *suite_references(void)
{
    Suite *suite = suite_create("references");
    TCase *tcase = tcase_create("references");
    tcase_add_loop_test(tcase, reference_is_the_solution, 0, EQUATIONS);
    suite_add_tcase(suite, tcase);
    return suite;
}
