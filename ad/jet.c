/* jet.c - Records the user's operations on jets as nodes of a graph. It folds constants, and shares equal nodes. */
#include "graph.h"
#include "rule.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

enum { INTEGER_POWER_MAX = INT_MAX };

/* ---- Linear combinations ----------------------------------------------------------------------------------------- */

/* Adds coefficient * node to the terms of a sum, if possible to an equal node's term. */
static void collect(struct jet_node *sum, double coefficient, struct jet_node *node)
{
    if (node->op == OP_LINEAR && node->count == 1 && node->number == 0) { /* a multiple of one node */
        coefficient *= node->terms[0].coefficient;
        node = node->terms[0].node;
    }
    if (node->mark >= 0 && node->mark < sum->count && sum->terms[node->mark].node == node) {
        sum->terms[node->mark].coefficient += coefficient;
        return;
    }
    node->mark = sum->count;
    /* there is room for terms wherever there is a node. NOLINTNEXTLINE(clang-analyzer-core.NullDereference) */
    sum->terms[sum->count++] = (jet_term){coefficient, node};
}

static void drop_zero_terms(struct jet_node *sum)
{
    int kept = 0;
    for (int i = 0; i < sum->count; i++)
        if (sum->terms[i].coefficient != 0) sum->terms[kept++] = sum->terms[i];
    sum->count = kept;
}

static bool terms_are_finite(const struct jet_node *sum)
{
    bool finite = isfinite(sum->number);
    for (int i = 0; i < sum->count; i++) finite = finite && isfinite(sum->terms[i].coefficient);
    return finite;
}

jet jet_linear(int count, const double coefficient[], const jet x[])
{
    jet_graph *graph;
    const jet refused = jet_graph_of(count, x, &graph);
    if (refused.node) return refused;
    struct jet_node sum = {.op = OP_LINEAR};
    if (graph && !(sum.terms = calloc((size_t)count, sizeof *sum.terms))) {
        jet_graph_lose(graph);
        return jet_poison(JET_NO_MEMORY);
    }
    for (int i = 0; i < count; i++) {
        if (x[i].node) collect(&sum, coefficient[i], x[i].node);
        else sum.number += coefficient[i] * x[i].number;
    }
    drop_zero_terms(&sum);
    const bool finite = terms_are_finite(&sum);
    const bool is_number = sum.count == 0;
    const bool is_one_node = sum.count == 1 && sum.terms[0].coefficient == 1 && sum.number == 0;
    if (finite && !is_number && !is_one_node) return jet_graph_record_jet(graph, sum);
    const jet result = !finite     ? jet_poison(JET_NOT_FINITE)
                       : is_number ? jet_const(sum.number)
                                   : jet_of_node(sum.terms[0].node);
    free(sum.terms);
    return result;
}

jet jet_record_add(jet a, jet b) { return jet_linear(2, (const double[]){1, 1}, (const jet[]){a, b}); }
jet jet_record_sub(jet a, jet b) { return jet_linear(2, (const double[]){1, -1}, (const jet[]){a, b}); }

/* The poison of an operation on x that there is no memory for. No output of the graph is accepted any more. */
static jet out_of_memory(int count, const jet x[])
{
    jet_graph *graph;
    if (!jet_graph_of(count, x, &graph).node && graph) jet_graph_lose(graph);
    return jet_poison(JET_NO_MEMORY);
}

jet jet_sum(const jet x[], int count)
{
    if (count <= 0) return jet_const(0);
    double *ones = calloc((size_t)count, sizeof *ones);
    if (!ones) return out_of_memory(count, x);
    for (int i = 0; i < count; i++) ones[i] = 1;
    const jet sum = jet_linear(count, ones, x);
    free(ones);
    return sum;
}

jet jet_dot(const jet x[], const jet y[], int count)
{
    if (count <= 0) return jet_const(0);
    jet *products = calloc((size_t)count, sizeof *products);
    if (!products) return out_of_memory(count, x);
    for (int i = 0; i < count; i++) products[i] = jet_mul(x[i], y[i]);
    const jet sum = jet_sum(products, count);
    free(products);
    return sum;
}

/* ---- Products, quotients, powers, functions ---------------------------------------------------------------------- */

static jet number_or_poison(double value) { return isfinite(value) ? jet_const(value) : jet_poison(JET_NOT_FINITE); }

/* Folds an operation on numbers, by the rule's own value. */
static jet fold(jet_op op, double c, double a, double b)
{
    double z;
    if (!jet_rules[op]->value(c, 1, &a, &b, &z)) return jet_poison_at(op, op == OP_DIV ? b : a);
    return number_or_poison(z);
}

enum { PARAMETERS_MAX = 1000 };

jet jet_parameter(jet of_recording, int index, double value)
{
    jet_graph *graph;
    const jet refused = jet_graph_of(1, &of_recording, &graph);
    if (refused.node) return refused;
    if (!graph || index < 0 || index >= PARAMETERS_MAX) return jet_poison(JET_NO_PARAMETER);
    if (!isfinite(value)) return jet_poison(JET_NOT_FINITE);
    return jet_graph_parameter(graph, index, value);
}

jet jet_record_mul(jet a, jet b)
{
    jet_graph *graph;
    const jet refused = jet_graph_of(2, (const jet[]){a, b}, &graph);
    if (refused.node) return refused;
    if (!graph) return fold(OP_MUL, 0, a.number, b.number);
    if (!a.node) return jet_linear(1, &a.number, &b);
    if (!b.node) return jet_linear(1, &b.number, &a);
    if (a.node == b.node) return jet_graph_record_jet(graph, (struct jet_node){.op = OP_SQR, .a = a.node});
    if (a.node->index > b.node->index) return jet_record_mul(b, a);
    return jet_graph_record_jet(graph, (struct jet_node){.op = OP_MUL, .a = a.node, .b = b.node});
}

jet jet_record_div(jet a, jet b)
{
    jet_graph *graph;
    const jet refused = jet_graph_of(2, (const jet[]){a, b}, &graph);
    if (refused.node) return refused;
    if (!b.node && b.number == 0) return jet_poison_at(OP_DIV, b.number);
    if (!graph) return fold(OP_DIV, 0, a.number, b.number);
    if (!b.node) {
        const double reciprocal = 1 / b.number;
        return jet_linear(1, &reciprocal, &a);
    }
    if (!a.node && a.number == 0) return a;
    if (!a.node) a = jet_graph_constant(graph, a.number);
    if (jet_is_poison(a)) return a;
    return jet_graph_record_jet(graph, (struct jet_node){.op = OP_DIV, .a = a.node, .b = b.node});
}

/* a^count by repeated squaring, count >= 1, which exists for every a. */
static jet integer_power(jet a, int count)
{
    if (count == 1) return a;
    const jet half = integer_power(a, count / 2);
    const jet square = jet_mul(half, half);
    return count % 2 ? jet_mul(square, a) : square;
}

jet jet_record_pow(jet a, double c)
{
    jet_graph *graph;
    const jet refused = jet_graph_of(1, &a, &graph);
    if (refused.node) return refused;
    if (!isfinite(c)) return jet_poison(JET_NOT_FINITE);
    const bool natural = c >= 0 && c == floor(c);
    if (!graph && natural) return number_or_poison(pow(a.number, c));
    if (!graph) return fold(OP_POW, c, a.number, 0);
    if (c == 0) return jet_const(1);
    if (c == 0.5) return jet_sqrt(a);
    if (c == -1) return jet_div(1, a);
    if (natural && c <= INTEGER_POWER_MAX) return integer_power(a, (int)c);
    return jet_graph_record_jet(graph, (struct jet_node){.op = OP_POW, .a = a.node, .number = c});
}

static jet record_with_partner(jet_graph *graph, jet_op op, struct jet_node *a, struct jet_node *b);

static const double TWO_BY_ROOT_PI = 1.1283791670955126;

/* Records the partner series that the recurrence of z needs (see jet_op). */
static jet partner(jet_graph *graph, struct jet_node *z)
{
    const jet a = jet_of_node(z->a);
    switch (z->op) {
    case OP_EXP: return jet_of_node(z);
    case OP_SIN: return record_with_partner(graph, OP_COS, z->a, NULL);
    case OP_COS: return record_with_partner(graph, OP_SIN, z->a, NULL);
    case OP_SINH: return record_with_partner(graph, OP_COSH, z->a, NULL);
    case OP_COSH: return record_with_partner(graph, OP_SINH, z->a, NULL);
    case OP_TAN: return jet_add(1, jet_sqr(jet_of_node(z)));
    case OP_TANH: return record_with_partner(graph, OP_SECH2, z->a, NULL);
    case OP_SECH2: return record_with_partner(graph, OP_TANH, z->a, NULL);
    case OP_ERF: return jet_mul(TWO_BY_ROOT_PI, jet_exp(jet_neg(jet_sqr(a))));
    case OP_LOG: return a;
    case OP_ASIN:
    case OP_ACOS: return jet_sqrt(jet_mul(jet_sub(1, a), jet_add(1, a)));
    case OP_ATAN: return jet_add(1, jet_sqr(a));
    case OP_ASINH: return jet_sqrt(jet_add(1, jet_sqr(a)));
    case OP_ACOSH: return jet_sqrt(jet_mul(jet_sub(a, 1), jet_add(a, 1)));
    case OP_ATANH: return jet_mul(jet_sub(1, a), jet_add(1, a));
    case OP_ATAN2: return jet_add(jet_sqr(a), jet_sqr(jet_of_node(z->b)));
    default: return jet_const(0); /* needs none */
    }
}

static jet record_with_partner(jet_graph *graph, jet_op op, struct jet_node *a, struct jet_node *b)
{
    bool is_new;
    struct jet_node *z = jet_graph_record(graph, (struct jet_node){.op = op, .a = a, .b = b}, &is_new);
    if (!z) return jet_poison(JET_NO_MEMORY);
    if (is_new) {
        const jet w = partner(graph, z);
        if (jet_is_poison(w)) return w;
        z->w = w.node;
    }
    return jet_of_node(z);
}

jet jet_record_op(jet_op op, jet a, jet b)
{
    const int operands = jet_rules[op]->operands;
    jet_graph *graph;
    const jet refused = jet_graph_of(operands, (const jet[]){a, b}, &graph);
    if (refused.node) return refused;
    if (!graph) return fold(op, 0, a.number, b.number);
    if (operands == 1) return record_with_partner(graph, op, a.node, NULL);
    if (!a.node) a = jet_graph_constant(graph, a.number);
    if (!b.node) b = jet_graph_constant(graph, b.number);
    if (jet_is_poison(a) || jet_is_poison(b)) return jet_poison(JET_NO_MEMORY);
    return record_with_partner(graph, op, a.node, b.node);
}

jet jet_record_function(jet_function f, jet a)
{
    static const jet_op ops[JET_FUNCTION_COUNT] = {
        [JET_SQRT] = OP_SQRT,   [JET_EXP] = OP_EXP,     [JET_LOG] = OP_LOG,     [JET_SIN] = OP_SIN,
        [JET_COS] = OP_COS,     [JET_TAN] = OP_TAN,     [JET_ASIN] = OP_ASIN,   [JET_ACOS] = OP_ACOS,
        [JET_ATAN] = OP_ATAN,   [JET_SINH] = OP_SINH,   [JET_COSH] = OP_COSH,   [JET_TANH] = OP_TANH,
        [JET_ASINH] = OP_ASINH, [JET_ACOSH] = OP_ACOSH, [JET_ATANH] = OP_ATANH, [JET_ERF] = OP_ERF,
    };
    if ((unsigned)f >= JET_FUNCTION_COUNT) return jet_poison(JET_NO_FUNCTION);
    if (f == JET_NEG) return jet_mul(-1, a);
    if (f == JET_SQR) return jet_mul(a, a);
    return jet_record_op(ops[f], a, jet_const(0));
}

jet jet_record_function2(jet_function2 f, jet a, jet b)
{
    static const jet_op ops[JET_FUNCTION2_COUNT] = {[JET_ATAN2] = OP_ATAN2, [JET_HYPOT] = OP_HYPOT};
    if ((unsigned)f >= JET_FUNCTION2_COUNT) return jet_poison(JET_NO_FUNCTION);
    return jet_record_op(ops[f], a, b);
}
