/* quad.c - the reference of quad.h. */
#include "quad.h"

#include "graph.h"

#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

static void *allocate(size_t count, size_t size)
{
    void *memory = calloc(count ? count : 1, size);
    if (!memory) abort();
    return memory;
}

static quad *quads(int count) { return allocate((size_t)count, sizeof(quad)); }

/* ---- The recorded function as a list of instructions ------------------------------------------------------------ */

typedef struct {
    int series;
    quad coefficient;
} term;

/* Series z from series a and b; the auxiliary series of z follow it. */
typedef struct {
    jet_op op;
    quad number;
    int z, a, b, count;
    term *terms;
} instruction;

typedef struct {
    int count, series, outputs;
    instruction *code;
    int *output; /* [outputs] series */
} quad_program;

/* Series that an operation computes beside its result (see evaluate). */
static const int auxiliary[OP_COUNT] = {
    [OP_POW] = 1,   [OP_SIN] = 1,   [OP_COS] = 1,   [OP_SINH] = 1,  [OP_COSH] = 1,  [OP_TAN] = 2,
    [OP_TANH] = 2,  [OP_SECH2] = 3, [OP_ASIN] = 2,  [OP_ACOS] = 2,  [OP_ATAN] = 1,  [OP_HYPOT] = 1,
    [OP_ATAN2] = 3, [OP_ERF] = 2,   [OP_ASINH] = 2, [OP_ACOSH] = 2, [OP_ATANH] = 1,
};

/* needed[i]: some output depends on node i by value. An operand has a smaller index than its node. */
static bool *find_needed(const jet_graph *graph, int outputs, const jet output[])
{
    const int count = jet_graph_count(graph);
    bool *needed = allocate((size_t)count, sizeof *needed);
    for (int i = 0; i < outputs; i++) needed[output[i].node->index] = true;
    for (int i = count - 1; i >= 0; i--) {
        const struct jet_node *node = jet_graph_node(graph, i);
        if (!needed[i]) continue;
        if (node->a) needed[node->a->index] = true;
        if (node->b) needed[node->b->index] = true;
        for (int j = 0; j < node->count; j++) needed[node->terms[j].node->index] = true;
    }
    return needed;
}

static instruction translate(const struct jet_node *node, const int series_of[])
{
    instruction x = {.op = node->op, .number = node->number, .z = series_of[node->index], .count = node->count};
    if (node->a) x.a = series_of[node->a->index];
    if (node->b) x.b = series_of[node->b->index];
    x.terms = allocate((size_t)node->count, sizeof *x.terms);
    for (int j = 0; j < node->count; j++)
        x.terms[j] = (term){series_of[node->terms[j].node->index], node->terms[j].coefficient};
    return x;
}

/* The instructions for the outputs; series 0..inputs-1 are the inputs. */
static quad_program compile(const jet_graph *graph, int outputs, const jet output[])
{
    const int count = jet_graph_count(graph), inputs = jet_graph_inputs(graph);
    bool *needed = find_needed(graph, outputs, output);
    int *series_of = allocate((size_t)count, sizeof *series_of);
    quad_program program = {.series = inputs, .outputs = outputs};
    program.code = allocate((size_t)count, sizeof *program.code);
    program.output = allocate((size_t)outputs, sizeof *program.output);
    for (int i = 0; i < inputs; i++) series_of[i] = i;
    for (int i = inputs; i < count; i++) {
        if (!needed[i]) continue;
        const struct jet_node *node = jet_graph_node(graph, i);
        series_of[i] = program.series;
        program.series += 1 + auxiliary[node->op];
        program.code[program.count++] = translate(node, series_of);
    }
    for (int i = 0; i < outputs; i++) program.output[i] = series_of[output[i].node->index];
    free(needed);
    free(series_of);
    return program;
}

static void release(quad_program *program)
{
    for (int i = 0; i < program->count; i++) free(program->code[i].terms);
    free(program->code);
    free(program->output);
}

/* ---- Coefficient k of a power series, by comparing coefficients ------------------------------------------------- */

/* z = a b: z_k = sum_{j=0}^k a_j b_{k-j}. */
static quad product(const quad *a, const quad *b, int k)
{
    quad sum = 0;
    for (int j = 0; j <= k; j++) sum += a[j] * b[k - j];
    return sum;
}

/* z b = a: sum_{j=0}^k z_j b_{k-j} = a_k. */
static quad quotient(const quad *a, const quad *b, const quad *z, int k)
{
    quad sum = a[k];
    for (int j = 0; j < k; j++) sum -= z[j] * b[k - j];
    return sum / b[0];
}

/* z z = a: 2 z_0 z_k + sum_{j=1}^{k-1} z_j z_{k-j} = a_k. */
static quad root(const quad *a, const quad *z, int k)
{
    if (k == 0) return sqrtq(a[0]);
    quad sum = a[k];
    for (int j = 1; j < k; j++) sum -= z[j] * z[k - j];
    return sum / (2 * z[0]);
}

/* z' = w a': k z_k = sum_{j=1}^k j a_j w_{k-j}, k >= 1. */
static quad chain(const quad *a, const quad *w, int k)
{
    quad sum = 0;
    for (int j = 1; j <= k; j++) sum += j * a[j] * w[k - j];
    return sum / k;
}

/* w z' = a': sum_{j=1}^k j z_j w_{k-j} = k a_k, k >= 1. */
static quad inverse_chain(const quad *a, const quad *w, const quad *z, int k)
{
    quad sum = k * a[k];
    for (int j = 1; j < k; j++) sum -= j * z[j] * w[k - j];
    return sum / (k * w[0]);
}

static void sine_cosine(const quad *a, quad *s, quad *c, int k)
{
    s[k] = k ? chain(a, c, k) : sinq(a[0]);
    c[k] = k ? -chain(a, s, k) : cosq(a[0]);
}

static void hyperbolic(const quad *a, quad *s, quad *c, int k)
{
    s[k] = k ? chain(a, c, k) : sinhq(a[0]);
    c[k] = k ? chain(a, s, k) : coshq(a[0]);
}

/* r = c + s a^2, w = sqrt r. */
static void root_of_quadratic(int c, int s, const quad *a, quad *r, quad *w, int k)
{
    r[k] = (k == 0) * c + s * product(a, a, k);
    w[k] = root(r, w, k);
}

/* z = a^c = (+-1)^c exp(c l), l = log |a|, for a != 0: a l' = a', z' = c z l'; a^c itself at order 0. */
static quad power(const quad *a, quad *l, const quad *z, quad c, int k)
{
    l[k] = k ? inverse_chain(a, a, l, k) : logq(fabsq(a[0]));
    return k ? c * chain(l, z, k) : powq(a[0], c);
}

static quad combination(const instruction *x, const quad *all, int length, int k)
{
    quad sum = k ? 0 : x->number;
    for (int j = 0; j < x->count; j++) sum += x->terms[j].coefficient * all[x->terms[j].series * length + k];
    return sum;
}

/* Coefficient k of the instruction's series from coefficients 0..k of its operands; each series has `length` places. */
static void evaluate(const instruction *x, quad *all, int length, int k)
{
    const quad *a = all + x->a * length, *b = all + x->b * length;
    quad *z = all + x->z * length, *u = z + length, *w = u + length, *r = w + length;
    switch (x->op) {
    case OP_CONST: z[k] = k ? 0 : x->number; break;
    case OP_LINEAR: z[k] = combination(x, all, length, k); break;
    case OP_MUL: z[k] = product(a, b, k); break;
    case OP_SQR: z[k] = product(a, a, k); break;
    case OP_DIV: z[k] = quotient(a, b, z, k); break;
    case OP_SQRT: z[k] = root(a, z, k); break;
    case OP_POW: z[k] = power(a, u, z, x->number, k); break;
    case OP_EXP: z[k] = k ? chain(a, z, k) : expq(a[0]); break;
    case OP_LOG: z[k] = k ? inverse_chain(a, a, z, k) : logq(a[0]); break;
    case OP_SIN: sine_cosine(a, z, u, k); break;
    case OP_COS: sine_cosine(a, u, z, k); break;
    case OP_SINH: hyperbolic(a, z, u, k); break;
    case OP_COSH: hyperbolic(a, u, z, k); break;
    case OP_TAN: /* sin a / cos a */
        sine_cosine(a, u, w, k);
        z[k] = quotient(u, w, z, k);
        break;
    case OP_TANH: /* sinh a / cosh a */
        hyperbolic(a, u, w, k);
        z[k] = quotient(u, w, z, k);
        break;
    case OP_SECH2: /* z cosh^2 a = 1 */
        hyperbolic(a, u, w, k);
        r[k] = product(w, w, k);
        z[k] = k ? 0 : 1;
        z[k] = quotient(z, r, z, k);
        break;
    case OP_ASIN: /* w z' = a' */
        root_of_quadratic(1, -1, a, u, w, k);
        z[k] = k ? inverse_chain(a, w, z, k) : asinq(a[0]);
        break;
    case OP_ACOS: /* w z' = -a' */
        root_of_quadratic(1, -1, a, u, w, k);
        z[k] = k ? -k * a[k] : 0;
        for (int j = 1; j < k; j++) z[k] -= j * z[j] * w[k - j];
        z[k] = k ? z[k] / (k * w[0]) : acosq(a[0]);
        break;
    case OP_ATAN: /* (1 + a^2) z' = a' */
        u[k] = (k == 0) + product(a, a, k);
        z[k] = k ? inverse_chain(a, u, z, k) : atanq(a[0]);
        break;
    case OP_ASINH: /* w z' = a' */
        root_of_quadratic(1, 1, a, u, w, k);
        z[k] = k ? inverse_chain(a, w, z, k) : asinhq(a[0]);
        break;
    case OP_ACOSH: /* w z' = a' */
        root_of_quadratic(-1, 1, a, u, w, k);
        z[k] = k ? inverse_chain(a, w, z, k) : acoshq(a[0]);
        break;
    case OP_ATANH: /* (1 - a^2) z' = a' */
        u[k] = (k == 0) - product(a, a, k);
        z[k] = k ? inverse_chain(a, u, z, k) : atanhq(a[0]);
        break;
    case OP_ERF: /* z' = 2 / sqrt(pi) exp(-a^2) a' */
        u[k] = -product(a, a, k);
        w[k] = k ? chain(u, w, k) : expq(u[0]);
        z[k] = k ? M_2_SQRTPIq * chain(a, w, k) : erfq(a[0]);
        break;
    case OP_HYPOT: /* z^2 = a^2 + b^2 */
        u[k] = product(a, a, k) + product(b, b, k);
        z[k] = root(u, z, k);
        break;
    case OP_ATAN2: /* z' = (b / u) a' - (a / u) b', u = a^2 + b^2 */
        u[k] = product(a, a, k) + product(b, b, k);
        w[k] = quotient(b, u, w, k);
        r[k] = quotient(a, u, r, k);
        z[k] = k ? chain(a, w, k) - chain(b, r, k) : atan2q(a[0], b[0]);
        break;
    default: break; /* inputs are set by the caller */
    }
}

static void run(const quad_program *program, quad *all, int length, int k)
{
    for (int i = 0; i < program->count; i++) evaluate(&program->code[i], all, length, k);
}

/* ---- Systems ---------------------------------------------------------------------------------------------------- */

struct quad_system {
    int n;
    quad *mass;
    quad_program force, potential; /* potential.outputs is 0 where there is none */
};

static quad_system *system_of(jet_graph *graph, int n, const double mass[], jet force[])
{
    if (jet_graph_accept(graph, n, force) != TVI_OK) return NULL;
    quad_system *system = allocate(1, sizeof *system);
    system->n = n;
    system->mass = quads(n);
    for (int i = 0; i < n; i++) system->mass[i] = mass ? mass[i] : 1;
    system->force = compile(graph, n, force);
    return system;
}

/* An open graph and its n + 1 inputs q, t. */
static jet_graph *open_graph(int n, jet **inputs)
{
    jet_graph *graph = jet_graph_create(n + 1);
    if (!graph) abort();
    *inputs = allocate((size_t)n + 1, sizeof **inputs);
    for (int i = 0; i <= n; i++) (*inputs)[i] = jet_graph_input(graph, i);
    return graph;
}

quad_system *quad_system_force(int n, const double mass[], tvi_force_fn *force, void *ctx)
{
    jet *inputs, *F = allocate((size_t)n, sizeof *F);
    jet_graph *graph = open_graph(n, &inputs);
    for (int i = 0; i < n; i++) F[i] = jet_unset();
    force(inputs, inputs[n], F, ctx);
    quad_system *system = system_of(graph, n, mass, F);
    jet_graph_free(graph);
    free(inputs);
    free(F);
    return system;
}

/* F = -dV/dq. */
quad_system *quad_system_potential(int n, const double mass[], tvi_potential_fn *potential, void *ctx)
{
    jet *inputs, *F = allocate((size_t)n, sizeof *F);
    jet_graph *graph = open_graph(n, &inputs);
    jet V = potential(inputs, inputs[n], ctx);
    quad_system *system = NULL;
    if (jet_graph_accept(graph, 1, &V) == TVI_OK) {
        if (!jet_gradient(graph, V, n, F)) abort();
        for (int i = 0; i < n; i++) F[i] = jet_neg(F[i]);
        system = system_of(graph, n, mass, F);
        if (system) system->potential = compile(graph, 1, &V);
    }
    jet_graph_free(graph);
    free(inputs);
    free(F);
    return system;
}

void quad_system_free(quad_system *system)
{
    if (!system) return;
    release(&system->force);
    release(&system->potential);
    free(system->mass);
    free(system);
}

/* The outputs of the program at numbers. */
static void values(const quad_program *program, int n, quad t, const quad q[], quad output[])
{
    quad *all = quads(program->series);
    memcpy(all, q, (size_t)n * sizeof *q);
    all[n] = t;
    run(program, all, 1, 0);
    for (int i = 0; i < program->outputs; i++) output[i] = all[program->output[i]];
    free(all);
}

void quad_force(const quad_system *system, quad t, const quad q[], quad F[])
{
    values(&system->force, system->n, t, q, F);
}

quad quad_energy(const quad_system *system, quad t, const quad q[], const quad p[])
{
    if (!system->potential.outputs) return nanq("");
    quad H;
    values(&system->potential, system->n, t, q, &H);
    for (int i = 0; i < system->n; i++) H += p[i] * p[i] / (2 * system->mass[i]);
    return H;
}

/* ---- The curve -------------------------------------------------------------------------------------------------- */

/* m (k+1)(k+2) c_{k+2} = [s^k] F(g(s), t + s), one order at a time (method.md section 2). */
void quad_expand(const quad_system *system, quad t, const quad q[], const quad v[], int degree, quad c[])
{
    const int n = system->n, length = degree + 1;
    const quad_program *force = &system->force;
    quad *all = quads(force->series * length);
    memcpy(c, q, (size_t)n * sizeof *c);
    memcpy(c + n, v, (size_t)n * sizeof *c);
    for (int k = 0; k + 2 <= degree; k++) {
        for (int i = 0; i < n; i++) all[i * length + k] = c[k * n + i];
        all[n * length + k] = k == 0 ? t : k == 1;
        run(force, all, length, k);
        for (int i = 0; i < n; i++)
            c[(k + 2) * n + i] = all[force->output[i] * length + k] / (system->mass[i] * (k + 1) * (k + 2));
    }
    free(all);
}

/* x = sum_{k <= degree} c_k s^k. */
static void position(int n, int degree, const quad c[], quad s, quad x[])
{
    for (int i = 0; i < n; i++) {
        x[i] = 0;
        for (int k = degree; k >= 0; k--) x[i] = x[i] * s + c[k * n + i];
    }
}

/* x = sum_{1 <= k <= degree} k c_k s^(k-1). */
static void velocity(int n, int degree, const quad c[], quad s, quad x[])
{
    for (int i = 0; i < n; i++) {
        x[i] = 0;
        for (int k = degree; k >= 1; k--) x[i] = x[i] * s + k * c[k * n + i];
    }
}

void quad_taylor(const quad_system *system, int degree, quad h, long steps, quad *t, quad q[], quad p[])
{
    const int n = system->n;
    const quad t0 = *t;
    quad *v = quads(n), *c = quads((degree + 1) * n);
    for (int i = 0; i < n; i++) v[i] = p[i] / system->mass[i];
    for (long step = 0; step < steps; step++) {
        quad_expand(system, t0 + step * h, q, v, degree, c);
        position(n, degree, c, h, q);
        velocity(n, degree, c, h, v);
    }
    for (int i = 0; i < n; i++) p[i] = v[i] * system->mass[i];
    *t = t0 + steps * h;
    free(v);
    free(c);
}

/* ---- Quadrature and linear equations ---------------------------------------------------------------------------- */

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

static void swap_rows(int n, quad a[], quad x[], int i, int j)
{
    for (int k = 0; k < n; k++) {
        const quad kept = a[i * n + k];
        a[i * n + k] = a[j * n + k];
        a[j * n + k] = kept;
    }
    const quad kept = x[i];
    x[i] = x[j];
    x[j] = kept;
}

/* x <- a^-1 x by Gaussian elimination with row exchanges; a is destroyed, a[i * n + j] is row i. */
static void solve(int n, quad a[], quad x[])
{
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++)
            if (fabsq(a[i * n + k]) > fabsq(a[pivot * n + k])) pivot = i;
        swap_rows(n, a, x, k, pivot);
        for (int i = k + 1; i < n; i++) {
            const quad factor = a[i * n + k] / a[k * n + k];
            for (int j = k; j < n; j++) a[i * n + j] -= factor * a[k * n + j];
            x[i] -= factor * x[k];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int j = i + 1; j < n; j++) x[i] -= a[i * n + j] * x[j];
        x[i] /= a[i * n + i];
    }
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
    position(n, N, x->c, -x->centre * x->h, y);
    position(n, N, x->c, (1 - x->centre) * x->h, y + n);
    for (int i = 0; i < m; i++) {
        const quad c = x->method->c[i], s = (c - x->centre) * x->h;
        position(n, c == 0 || c == 1 ? N : node_degree, x->c, s, y + (2 + i) * n);
        velocity(n, N, x->c, s, y + (2 + m + i) * n);
    }
}

/* dy/dz_j = sum_{s=1}^3 w_s (y(z + s d e_j) - y(z - s d e_j)) / d + O(d^6). */
static void differentiate(const step *x)
{
    const quad w[] = {(quad)3 / 4, -(quad)3 / 20, (quad)1 / 60};
    quad *z = quads(2 * x->n), *y = quads(x->size);
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
    quad *F = quads(n);
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
    quad *G = quads(4 * n * n);
    shape(x, x->z, x->y);
    differentiate(x);
    action_gradient(x, x->p1);
    for (int j = 0; j < 2 * n; j++)
        for (int i = 0; i < n; i++) {
            G[j * 2 * n + i] = x->dy[j * x->size + n + i];
            G[j * 2 * n + n + i] = -x->dy[j * x->size + i];
        }
    solve(2 * n, G, x->p1);
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
    quad *moved = quads(n2);
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
    quad *R = quads(n2), *J = quads(n2 * n2), *a = quads(n2 * n2);
    quad last = 1, size = 1;
    bool done = false, stale = true;
    residual(x, q0, p0, R);
    for (int pass = 0; pass < 60 && !done; pass++) {
        if (stale) residual_jacobian(x, q0, p0, R, J);
        memcpy(a, J, (size_t)(n2 * n2) * sizeof *a);
        solve(n2, a, R);
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
    quad extent = 0, *v = quads(n);
    for (int i = 0; i < n; i++) v[i] = p[i] / x->system->mass[i];
    quad_expand(x->system, x->t, q, v, N, x->c);
    position(n, N, x->c, x->centre * x->h, x->z);
    velocity(n, N, x->c, x->centre * x->h, x->z + n);
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
    quad *all = quads(6 * n + (method->degree + 1) * n + size + 2 * n * size);
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
