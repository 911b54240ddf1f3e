/* type1_quad.c - Computes Gauss quadrature, and the type I step from its definition (quad.h). */
#include "system_quad.h"

#include <math.h>
#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

/* ---- Quadrature ------------------------------------------------------------------------------------------------- */

/* P = P_m(x) and its derivative: (j+1) P_{j+1} = (2j+1) x P_j - j P_{j-1}, (x^2 - 1) P_m' = m (x P_m - P_{m-1}). */
static quad legendre(int m, quad x, quad *derivative)
{
    quad previous = 0, P = 1;
    for (int j = 0; j < m; j++) {
        const quad next = ((2 * j + 1) * x * P - j * previous) / (j + 1);
        previous = P;
        P = next;
    }
    *derivative = m * (x * P - previous) / (x * x - 1);
    return P;
}

/* c_i = (1 + x_i) / 2, b_i = 1 / ((1 - x_i^2) P_m'(x_i)^2), x_i the zeros of P_m in increasing order. */
quad_method quad_method_gauss(tvi_expansion expansion, tvi_nodes nodes, int degree, int points)
{
    quad_method method = {.expansion = expansion, .nodes = nodes, .degree = degree, .points = points};
    for (int i = 0; i < points; i++) {
        quad x = -cosq(M_PIq * (i + (quad)0.75) / (points + (quad)0.5)), derivative;
        for (int pass = 0; pass < 10; pass++) {
            const quad P = legendre(points, x, &derivative);
            x -= P / derivative;
        }
        (void)legendre(points, x, &derivative);
        method.c[i] = (1 + x) / 2;
        method.b[i] = 1 / ((1 - x * x) * derivative * derivative);
    }
    return method;
}

quad quad_method_integral(const quad_method *method, int j, quad s)
{
    quad sum = 0;
    for (int k = 0; k < method->points; k++) {
        quad value = 1;
        for (int i = 0; i < method->points; i++)
            if (i != j) value *= (s * method->c[k] - method->c[i]) / (method->c[j] - method->c[i]);
        sum += s * method->b[k] * value;
    }
    return sum;
}

/* ---- The type I step -------------------------------------------------------------------------------------------- */

/* y(z) = (q-, q+, q_1..q_m, v_1..v_m) has `size` numbers; dy[j * size] is dy/dz_j. unit[j] is the scale of z_j. */
typedef struct {
    const quad_system *system;
    const quad_method *method;
    quad t, h, centre; /* the centre is at t + centre * h */
    int n, size;
    quad *z, *unit, *c, *y, *dy;
    quad *p1, *p0; /* one array: what (I) gives at z */
} step;

/* The ends and the nodes of the curve from z (method.md section 3). A node at an end takes the end's value. */
static void shape(const step *x, const quad z[], quad y[])
{
    const int n = x->n, N = x->method->degree, m = x->method->points;
    const int node_degree = x->method->nodes == TVI_NODES_TRUNCATED ? N - 1 : N;
    quad_expand(x->system, x->t + x->centre * x->h, z, z + n, N, x->c);
    quad_position(n, N, x->c, -x->centre * x->h, y);
    quad_position(n, N, x->c, (1 - x->centre) * x->h, y + n);
    for (int i = 0; i < m; i++) {
        const quad c = x->method->c[i], s = (c - x->centre) * x->h;
        quad_position(n, c == 0 || c == 1 ? N : node_degree, x->c, s, y + (2 + i) * n);
        quad_velocity(n, N, x->c, s, y + (2 + m + i) * n);
    }
}

/* dy/dz_j = sum_{s=1}^3 w_s (y(z + s d e_j) - y(z - s d e_j)) / d + O(d^6). */
static void differentiate(const step *x)
{
    const quad w[] = {(quad)3 / 4, -(quad)3 / 20, (quad)1 / 60};
    quad *z = quad_vector(2 * x->n), *y = quad_vector(x->size);
    memset(x->dy, 0, (size_t)(2 * x->n * x->size) * sizeof *x->dy);
    memcpy(z, x->z, (size_t)(2 * x->n) * sizeof *z);
    for (int j = 0; j < 2 * x->n; j++) {
        const quad d = x->unit[j] * 2e-6;
        for (int s = -3; s <= 3; s++) {
            if (s == 0) continue;
            z[j] = x->z[j] + s * d;
            shape(x, z, y);
            const quad factor = s > 0 ? w[s - 1] / d : -w[-s - 1] / d;
            for (int i = 0; i < x->size; i++) x->dy[j * x->size + i] += factor * y[i];
        }
        z[j] = x->z[j];
    }
    free(z);
    free(y);
}

/* S_z = h sum_i b_i [(dq_i/dz)^T F(q_i, t_i) + (dv_i/dz)^T M v_i] (method.md section 4, type I). */
static void action_gradient(const step *x, quad S_z[])
{
    const int n = x->n, m = x->method->points;
    quad *F = quad_vector(n);
    memset(S_z, 0, (size_t)(2 * n) * sizeof *S_z);
    for (int i = 0; i < m; i++) {
        const int at_q = (2 + i) * n, at_v = (2 + m + i) * n;
        quad_force(x->system, x->t + x->method->c[i] * x->h, x->y + at_q, F);
        for (int j = 0; j < 2 * n; j++) {
            const quad *dy = x->dy + j * x->size;
            quad sum = 0;
            for (int k = 0; k < n; k++) sum += dy[at_q + k] * F[k] + dy[at_v + k] * x->system->mass[k] * x->y[at_v + k];
            S_z[j] += x->h * x->method->b[i] * sum;
        }
    }
    free(F);
}

/* At x->z: the curve, then p1 and p0 from S_z = G+^T p1 - G-^T p0, then R = (q- - q0, p0 - p0 wanted). */
static void residual(const step *x, const quad q0[], const quad p0[], quad R[])
{
    const int n = x->n;
    quad *G = quad_vector(4 * n * n);
    shape(x, x->z, x->y);
    differentiate(x);
    action_gradient(x, x->p1);
    for (int j = 0; j < 2 * n; j++)
        for (int i = 0; i < n; i++) {
            G[j * 2 * n + i] = x->dy[j * x->size + n + i];
            G[j * 2 * n + n + i] = -x->dy[j * x->size + i];
        }
    if (!quad_solve(2 * n, G, x->p1)) x->p0[0] = NAN;
    for (int i = 0; i < n; i++) {
        R[i] = x->y[i] - q0[i];
        R[n + i] = x->p0[i] - p0[i];
    }
    free(G);
}

/* J[i * 2n + j] = dR_i/dz_j by forward differences; R is the residual at x->z. */
static void residual_jacobian(const step *x, const quad q0[], const quad p0[], const quad R[], quad J[])
{
    const int n2 = 2 * x->n;
    quad *moved = quad_vector(n2);
    for (int j = 0; j < n2; j++) {
        const quad kept = x->z[j], d = x->unit[j] * 1e-12;
        x->z[j] += d;
        residual(x, q0, p0, moved);
        for (int i = 0; i < n2; i++) J[i * n2 + j] = (moved[i] - R[i]) / d;
        x->z[j] = kept;
    }
    free(moved);
}

/* Newton's method for R(z) = 0; the Jacobian is kept while a pass gains six digits. The corrections, in units of z,
 * must fall below 1e-24 and end when they stop shrinking there. */
static bool correct(const step *x, const quad q0[], const quad p0[])
{
    const int n2 = 2 * x->n;
    quad *R = quad_vector(n2), *J = quad_vector(n2 * n2), *a = quad_vector(n2 * n2);
    quad last = 1, size = 1;
    bool done = false, stale = true;
    residual(x, q0, p0, R);
    for (int pass = 0; pass < 60 && !done; pass++) {
        if (stale) residual_jacobian(x, q0, p0, R, J);
        memcpy(a, J, (size_t)(n2 * n2) * sizeof *a);
        if (!quad_solve(n2, a, R)) break;
        size = 0;
        for (int j = 0; j < n2; j++) {
            x->z[j] -= R[j];
            size = fmaxq(size, fabsq(R[j] / x->unit[j]));
        }
        if (!finiteq(size)) break;
        residual(x, q0, p0, R);
        stale = size > 1e-6 * last && size > 1e-22;
        done = size < 1e-24 && (size < 1e-30 || size > last / 8);
        last = size;
    }
    free(R);
    free(J);
    free(a);
    return done;
}

/* z from the curve of degree N from (q, p), and its units: the curve's extent for q, the same over h for v. */
static void predict(const step *x, const quad q[], const quad p[])
{
    const int n = x->n, N = x->method->degree;
    quad extent = 0, *v = quad_vector(n);
    for (int i = 0; i < n; i++) v[i] = p[i] / x->system->mass[i];
    quad_expand(x->system, x->t, q, v, N, x->c);
    quad_position(n, N, x->c, x->centre * x->h, x->z);
    quad_velocity(n, N, x->c, x->centre * x->h, x->z + n);
    for (int i = 0; i < n; i++) extent = fmaxq(extent, fmaxq(fabsq(q[i]), fabsq(x->h * v[i])));
    if (extent == 0) extent = 1;
    for (int i = 0; i < n; i++) {
        x->unit[i] = extent;
        x->unit[n + i] = extent / fabsq(x->h);
    }
    free(v);
}

bool quad_tvi_step(const quad_system *system, const quad_method *method, quad h, quad *t, quad q[], quad p[])
{
    const int n = system->n, size = (2 + 2 * method->points) * n;
    const quad centre = method->expansion == TVI_AT_START ? 0 : method->expansion == TVI_AT_END ? 1 : (quad)0.5;
    step x = {.system = system, .method = method, .t = *t, .h = h, .centre = centre, .n = n, .size = size};
    quad *all = quad_vector(6 * n + (method->degree + 1) * n + size + 2 * n * size);
    x.z = all;
    x.unit = x.z + 2 * n;
    x.p1 = x.unit + 2 * n;
    x.p0 = x.p1 + n;
    x.c = x.p0 + n;
    x.y = x.c + (method->degree + 1) * n;
    x.dy = x.y + size;
    predict(&x, q, p);
    const bool converged = correct(&x, q, p);
    if (converged) {
        memcpy(q, x.y + n, (size_t)n * sizeof *q);
        memcpy(p, x.p1, (size_t)n * sizeof *p);
        *t += h;
    }
    free(all);
    return converged;
}
