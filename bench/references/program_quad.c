/* program_quad.c - Implements program_quad.h. */
#include "program_quad.h"

#include <quadmath.h>
#include <stdlib.h>

void *quad_allocate(size_t count, size_t size)
{
    void *memory = calloc(count ? count : 1, size);
    if (!memory) abort();
    return memory;
}

quad *quad_vector(int count) { return quad_allocate((size_t)count, sizeof(quad)); }

/* Series that an operation computes beside its result (see evaluate). */
static const int auxiliary[OP_COUNT] = {
    [OP_POW] = 1,   [OP_SIN] = 1,   [OP_COS] = 1,   [OP_SINH] = 1,  [OP_COSH] = 1,  [OP_TAN] = 2,
    [OP_TANH] = 2,  [OP_SECH2] = 3, [OP_ASIN] = 2,  [OP_ACOS] = 2,  [OP_ATAN] = 1,  [OP_HYPOT] = 1,
    [OP_ATAN2] = 3, [OP_ERF] = 2,   [OP_ASINH] = 2, [OP_ACOSH] = 2, [OP_ATANH] = 1,
};

/* needed[i]: some output depends on node i by value. An operand has a smaller index than its node. */
static bool *find_needed(const jet_graph *graph, int outputs, const jet output[])
{
    const int count = jet_graph_node_count(graph);
    bool *needed = quad_allocate((size_t)count, sizeof *needed);
    for (int i = 0; i < outputs; i++) needed[output[i].node->index] = true;
    for (int i = count - 1; i >= 0; i--) {
        const struct jet_node *node = jet_graph_node_at(graph, i);
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
    x.terms = quad_allocate((size_t)node->count, sizeof *x.terms);
    for (int j = 0; j < node->count; j++)
        x.terms[j] = (term){series_of[node->terms[j].node->index], node->terms[j].coefficient};
    return x;
}

/* The instructions for the outputs; series 0..inputs-1 are the inputs. */
quad_program quad_compile(const jet_graph *graph, int outputs, const jet output[])
{
    const int count = jet_graph_node_count(graph), inputs = jet_graph_input_count(graph);
    bool *needed = find_needed(graph, outputs, output);
    int *series_of = quad_allocate((size_t)count, sizeof *series_of);
    quad_program program = {.series = inputs, .outputs = outputs};
    program.code = quad_allocate((size_t)count, sizeof *program.code);
    program.output = quad_allocate((size_t)outputs, sizeof *program.output);
    for (int i = 0; i < inputs; i++) series_of[i] = i;
    for (int i = inputs; i < count; i++) {
        if (!needed[i]) continue;
        const struct jet_node *node = jet_graph_node_at(graph, i);
        series_of[i] = program.series;
        program.series += 1 + auxiliary[node->op];
        program.code[program.count++] = translate(node, series_of);
    }
    for (int i = 0; i < outputs; i++) program.output[i] = series_of[output[i].node->index];
    free(needed);
    free(series_of);
    return program;
}

void quad_release(quad_program *program)
{
    for (int i = 0; i < program->count; i++) free(program->code[i].terms);
    free(program->code);
    free(program->output);
}

/* ---- The operations --------------------------------------------------------------------------------------------- */

static void sine_cosine(const quad *a, quad *s, quad *c, int k)
{
    s[k] = k ? quad_chain(a, c, k) : sinq(a[0]);
    c[k] = k ? -quad_chain(a, s, k) : cosq(a[0]);
}

static void hyperbolic(const quad *a, quad *s, quad *c, int k)
{
    s[k] = k ? quad_chain(a, c, k) : sinhq(a[0]);
    c[k] = k ? quad_chain(a, s, k) : coshq(a[0]);
}

/* r = c + s a^2, w = sqrt r. */
static void root_of_quadratic(int c, int s, const quad *a, quad *r, quad *w, int k)
{
    r[k] = (k == 0) * c + s * quad_product(a, a, k);
    w[k] = quad_root(r, w, k);
}

/* z = a^c = (+-1)^c exp(c l), l = log |a|, for a != 0: a l' = a', z' = c z l'; a^c itself at order 0. */
static quad power(const quad *a, quad *l, const quad *z, quad c, int k)
{
    l[k] = k ? quad_inverse_chain(a, a, l, k) : logq(fabsq(a[0]));
    return k ? c * quad_chain(l, z, k) : powq(a[0], c);
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
    case OP_MUL: z[k] = quad_product(a, b, k); break;
    case OP_SQR: z[k] = quad_product(a, a, k); break;
    case OP_DIV: z[k] = quad_quotient(a, b, z, k); break;
    case OP_SQRT: z[k] = quad_root(a, z, k); break;
    case OP_POW: z[k] = power(a, u, z, x->number, k); break;
    case OP_EXP: z[k] = k ? quad_chain(a, z, k) : expq(a[0]); break;
    case OP_LOG: z[k] = k ? quad_inverse_chain(a, a, z, k) : logq(a[0]); break;
    case OP_SIN: sine_cosine(a, z, u, k); break;
    case OP_COS: sine_cosine(a, u, z, k); break;
    case OP_SINH: hyperbolic(a, z, u, k); break;
    case OP_COSH: hyperbolic(a, u, z, k); break;
    case OP_TAN: /* sin a / cos a */
        sine_cosine(a, u, w, k);
        z[k] = quad_quotient(u, w, z, k);
        break;
    case OP_TANH: /* sinh a / cosh a */
        hyperbolic(a, u, w, k);
        z[k] = quad_quotient(u, w, z, k);
        break;
    case OP_SECH2: /* z cosh^2 a = 1 */
        hyperbolic(a, u, w, k);
        r[k] = quad_product(w, w, k);
        z[k] = k ? 0 : 1;
        z[k] = quad_quotient(z, r, z, k);
        break;
    case OP_ASIN: /* w z' = a' */
        root_of_quadratic(1, -1, a, u, w, k);
        z[k] = k ? quad_inverse_chain(a, w, z, k) : asinq(a[0]);
        break;
    case OP_ACOS: /* w z' = -a' */
        root_of_quadratic(1, -1, a, u, w, k);
        z[k] = k ? -k * a[k] : 0;
        for (int j = 1; j < k; j++) z[k] -= j * z[j] * w[k - j];
        z[k] = k ? z[k] / (k * w[0]) : acosq(a[0]);
        break;
    case OP_ATAN: /* (1 + a^2) z' = a' */
        u[k] = (k == 0) + quad_product(a, a, k);
        z[k] = k ? quad_inverse_chain(a, u, z, k) : atanq(a[0]);
        break;
    case OP_ASINH: /* w z' = a' */
        root_of_quadratic(1, 1, a, u, w, k);
        z[k] = k ? quad_inverse_chain(a, w, z, k) : asinhq(a[0]);
        break;
    case OP_ACOSH: /* w z' = a' */
        root_of_quadratic(-1, 1, a, u, w, k);
        z[k] = k ? quad_inverse_chain(a, w, z, k) : acoshq(a[0]);
        break;
    case OP_ATANH: /* (1 - a^2) z' = a' */
        u[k] = (k == 0) - quad_product(a, a, k);
        z[k] = k ? quad_inverse_chain(a, u, z, k) : atanhq(a[0]);
        break;
    case OP_ERF: /* z' = 2 / sqrt(pi) exp(-a^2) a' */
        u[k] = -quad_product(a, a, k);
        w[k] = k ? quad_chain(u, w, k) : expq(u[0]);
        z[k] = k ? M_2_SQRTPIq * quad_chain(a, w, k) : erfq(a[0]);
        break;
    case OP_HYPOT: /* z^2 = a^2 + b^2 */
        u[k] = quad_product(a, a, k) + quad_product(b, b, k);
        z[k] = quad_root(u, z, k);
        break;
    case OP_ATAN2: /* z' = (b / u) a' - (a / u) b', u = a^2 + b^2 */
        u[k] = quad_product(a, a, k) + quad_product(b, b, k);
        w[k] = quad_quotient(b, u, w, k);
        r[k] = quad_quotient(a, u, r, k);
        z[k] = k ? quad_chain(a, w, k) - quad_chain(b, r, k) : atan2q(a[0], b[0]);
        break;
    default: break; /* inputs are set by the caller */
    }
}

void quad_run_program(const quad_program *program, quad *all, int length, int k)
{
    for (int i = 0; i < program->count; i++) evaluate(&program->code[i], all, length, k);
}
