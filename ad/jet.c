/* jet.c - Records the operations that the user's function calls on jets, the numbers of the library's automatic
 * differentiation. Each operation becomes a node of a graph. Operations on constants are computed at once, and a node
 * that equals an earlier one is not recorded again (docs/jets.md, section 1). */
#include "graph.h"
#include "rule.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

enum { INTEGER_POWER_MAX = INT_MAX };

/* ---- Linear combinations ----------------------------------------------------------------------------------------- */

/* Adds the term coefficient * node to a sum. If the sum already has a term with this node, the coefficients are
 * added. */
static void add_term_to_sum(struct jet_node *sum, double coefficient, struct jet_node *node)
{
    if (node->op == OP_LINEAR && node->count == 1 && node->number == 0) {
        /* The node is a multiple of another node. The term refers to the other node, with the product of the
         * factors. */
        coefficient *= node->terms[0].coefficient;
        node = node->terms[0].node;
    }
    if (node->scratch >= 0 && node->scratch < sum->count && sum->terms[node->scratch].node == node) {
        sum->terms[node->scratch].coefficient += coefficient;
        return;
    }
    node->scratch = sum->count;
    /* The caller has allocated sum->terms for all terms. NOLINTNEXTLINE(clang-analyzer-core.NullDereference) */
    sum->terms[sum->count++] = (jet_term){coefficient, node};
}

static void drop_zero_terms(struct jet_node *sum)
{
    int kept = 0;
    for (int i = 0; i < sum->count; i++)
        if (sum->terms[i].coefficient != 0) sum->terms[kept++] = sum->terms[i];
    sum->count = kept;
}

static bool are_sum_coefficients_finite(const struct jet_node *sum)
{
    bool finite = isfinite(sum->number);
    for (int i = 0; i < sum->count; i++) finite = finite && isfinite(sum->terms[i].coefficient);
    return finite;
}

jet jet_record_linear_combination(int count, const double coefficient[], const jet x[])
{
    jet_graph *graph;
    const jet refused = jet_find_common_graph_or_poison(count, x, &graph);
    if (refused.node) return refused;
    struct jet_node sum = {.op = OP_LINEAR};
    if (graph && !(sum.terms = calloc((size_t)count, sizeof *sum.terms))) {
        jet_graph_mark_out_of_memory(graph);
        return jet_make_poison(JET_NO_MEMORY);
    }
    for (int i = 0; i < count; i++) {
        if (x[i].node) add_term_to_sum(&sum, coefficient[i], x[i].node);
        else sum.number += coefficient[i] * x[i].number;
    }
    drop_zero_terms(&sum);
    const bool finite = are_sum_coefficients_finite(&sum);
    const bool is_number = sum.count == 0;
    const bool is_one_node = sum.count == 1 && sum.terms[0].coefficient == 1 && sum.number == 0;
    if (finite && !is_number && !is_one_node) return jet_graph_record_node(graph, sum);
    const jet result = !finite     ? jet_make_poison(JET_NOT_FINITE)
                       : is_number ? jet_const(sum.number)
                                   : jet_from_node(sum.terms[0].node);
    free(sum.terms);
    return result;
}

jet jet_record_add(jet a, jet b)
{
    return jet_record_linear_combination(2, (const double[]){1, 1}, (const jet[]){a, b});
}
jet jet_record_sub(jet a, jet b)
{
    return jet_record_linear_combination(2, (const double[]){1, -1}, (const jet[]){a, b});
}

/* Returns the poison of an operation for which memory is lacking. Marks the graph of the operands x, so that all its
 * outputs are refused. */
static jet make_out_of_memory_poison(int count, const jet x[])
{
    jet_graph *graph;
    if (!jet_find_common_graph_or_poison(count, x, &graph).node && graph) jet_graph_mark_out_of_memory(graph);
    return jet_make_poison(JET_NO_MEMORY);
}

jet jet_sum(const jet x[], int count)
{
    if (count <= 0) return jet_const(0);
    double *ones = calloc((size_t)count, sizeof *ones);
    if (!ones) return make_out_of_memory_poison(count, x);
    for (int i = 0; i < count; i++) ones[i] = 1;
    const jet sum = jet_record_linear_combination(count, ones, x);
    free(ones);
    return sum;
}

jet jet_dot(const jet x[], const jet y[], int count)
{
    if (count <= 0) return jet_const(0);
    jet *products = calloc((size_t)count, sizeof *products);
    if (!products) return make_out_of_memory_poison(count, x);
    for (int i = 0; i < count; i++) products[i] = jet_mul(x[i], y[i]);
    const jet sum = jet_sum(products, count);
    free(products);
    return sum;
}

/* ---- Products, quotients, powers, functions ---------------------------------------------------------------------- */

static jet make_finite_constant_or_poison(double value)
{
    return isfinite(value) ? jet_const(value) : jet_make_poison(JET_NOT_FINITE);
}

/* Computes an operation whose operands are numbers, instead of recording it. It calls the value rule that tapes use. */
static jet fold_constant_operation(jet_op op, double exponent, double a, double b)
{
    double z;
    if (!jet_rules[op]->compute_values(exponent, 1, &a, &b, &z))
        return jet_make_domain_poison(op, op == OP_DIV ? b : a);
    return make_finite_constant_or_poison(z);
}

enum { PARAMETERS_MAX = 1000 };

jet jet_parameter(jet any_jet, int index, double value)
{
    jet_graph *graph;
    const jet refused = jet_find_common_graph_or_poison(1, &any_jet, &graph);
    if (refused.node) return refused;
    if (!graph || index < 0 || index >= PARAMETERS_MAX) return jet_make_poison(JET_NO_PARAMETER);
    if (!isfinite(value)) return jet_make_poison(JET_NOT_FINITE);
    return jet_graph_record_parameter(graph, index, value);
}

jet jet_record_mul(jet a, jet b)
{
    jet_graph *graph;
    const jet refused = jet_find_common_graph_or_poison(2, (const jet[]){a, b}, &graph);
    if (refused.node) return refused;
    if (!graph) return fold_constant_operation(OP_MUL, 0, a.number, b.number);
    if (!a.node) return jet_record_linear_combination(1, &a.number, &b);
    if (!b.node) return jet_record_linear_combination(1, &b.number, &a);
    if (a.node == b.node) return jet_graph_record_node(graph, (struct jet_node){.op = OP_SQR, .a = a.node});
    if (a.node->index > b.node->index) return jet_record_mul(b, a);
    return jet_graph_record_node(graph, (struct jet_node){.op = OP_MUL, .a = a.node, .b = b.node});
}

jet jet_record_div(jet a, jet b)
{
    jet_graph *graph;
    const jet refused = jet_find_common_graph_or_poison(2, (const jet[]){a, b}, &graph);
    if (refused.node) return refused;
    if (!b.node && b.number == 0) return jet_make_domain_poison(OP_DIV, b.number);
    if (!graph) return fold_constant_operation(OP_DIV, 0, a.number, b.number);
    if (!b.node) {
        const double reciprocal = 1 / b.number;
        return jet_record_linear_combination(1, &reciprocal, &a);
    }
    if (!a.node && a.number == 0) return a;
    if (!a.node) a = jet_graph_record_constant(graph, a.number);
    if (jet_is_poison(a)) return a;
    return jet_graph_record_node(graph, (struct jet_node){.op = OP_DIV, .a = a.node, .b = b.node});
}

/* Records a^exponent for exponent >= 1 by repeated squaring. The result exists for every a, unlike that of OP_POW. */
static jet record_integer_power(jet a, int exponent)
{
    if (exponent == 1) return a;
    const jet half = record_integer_power(a, exponent / 2);
    const jet square = jet_mul(half, half);
    return exponent % 2 ? jet_mul(square, a) : square;
}

jet jet_record_pow(jet a, double c)
{
    jet_graph *graph;
    const jet refused = jet_find_common_graph_or_poison(1, &a, &graph);
    if (refused.node) return refused;
    if (!isfinite(c)) return jet_make_poison(JET_NOT_FINITE);
    const bool natural = c >= 0 && c == floor(c);
    if (!graph && natural) return make_finite_constant_or_poison(pow(a.number, c));
    if (!graph) return fold_constant_operation(OP_POW, c, a.number, 0);
    if (c == 0) return jet_const(1);
    if (c == 0.5) return jet_sqrt(a);
    if (c == -1) return jet_div(1, a);
    if (natural && c <= INTEGER_POWER_MAX) return record_integer_power(a, (int)c);
    return jet_graph_record_node(graph, (struct jet_node){.op = OP_POW, .a = a.node, .number = c});
}

static jet record_with_auxiliary(jet_graph *graph, jet_op op, struct jet_node *a, struct jet_node *b);

static const double TWO_BY_ROOT_PI = 1.1283791670955126;

/* Records the auxiliary node w, whose series the recurrence of z needs (jet_op in graph.h). */
static jet record_auxiliary_node(jet_graph *graph, struct jet_node *z)
{
    const jet a = jet_from_node(z->a);
    switch (z->op) {
    case OP_EXP: return jet_from_node(z);
    case OP_SIN: return record_with_auxiliary(graph, OP_COS, z->a, NULL);
    case OP_COS: return record_with_auxiliary(graph, OP_SIN, z->a, NULL);
    case OP_SINH: return record_with_auxiliary(graph, OP_COSH, z->a, NULL);
    case OP_COSH: return record_with_auxiliary(graph, OP_SINH, z->a, NULL);
    case OP_TAN: return jet_add(1, jet_sqr(jet_from_node(z)));
    case OP_TANH: return record_with_auxiliary(graph, OP_SECH2, z->a, NULL);
    case OP_SECH2: return record_with_auxiliary(graph, OP_TANH, z->a, NULL);
    case OP_ERF: return jet_mul(TWO_BY_ROOT_PI, jet_exp(jet_neg(jet_sqr(a))));
    case OP_LOG: return a;
    case OP_ASIN:
    case OP_ACOS: return jet_sqrt(jet_mul(jet_sub(1, a), jet_add(1, a)));
    case OP_ATAN: return jet_add(1, jet_sqr(a));
    case OP_ASINH: return jet_sqrt(jet_add(1, jet_sqr(a)));
    case OP_ACOSH: return jet_sqrt(jet_mul(jet_sub(a, 1), jet_add(a, 1)));
    case OP_ATANH: return jet_mul(jet_sub(1, a), jet_add(1, a));
    case OP_ATAN2: return record_with_auxiliary(graph, OP_RADIUS, z->a, z->b);
    default: return jet_const(0); /* The recurrence has no auxiliary series. */
    }
}

static jet record_with_auxiliary(jet_graph *graph, jet_op op, struct jet_node *a, struct jet_node *b)
{
    bool is_new;
    struct jet_node *z = jet_graph_find_or_record(graph, (struct jet_node){.op = op, .a = a, .b = b}, &is_new);
    if (!z) return jet_make_poison(JET_NO_MEMORY);
    if (is_new) {
        const jet w = record_auxiliary_node(graph, z);
        if (jet_is_poison(w)) return w;
        z->w = w.node;
        for (int i = z->index + 1; i < jet_graph_node_count(graph); i++) jet_graph_node_at(graph, i)->owner = z;
    }
    return jet_from_node(z);
}

jet jet_record_operation(jet_op op, jet a, jet b)
{
    const int operands = jet_rules[op]->operand_count;
    jet_graph *graph;
    const jet refused = jet_find_common_graph_or_poison(operands, (const jet[]){a, b}, &graph);
    if (refused.node) return refused;
    if (!graph) return fold_constant_operation(op, 0, a.number, b.number);
    if (operands == 1) return record_with_auxiliary(graph, op, a.node, NULL);
    if (!a.node) a = jet_graph_record_constant(graph, a.number);
    if (!b.node) b = jet_graph_record_constant(graph, b.number);
    if (jet_is_poison(a) || jet_is_poison(b)) return jet_make_poison(JET_NO_MEMORY);
    return record_with_auxiliary(graph, op, a.node, b.node);
}

jet jet_record_function(jet_function f, jet a)
{
    static const jet_op ops[JET_FUNCTION_COUNT] = {
        [JET_SQRT] = OP_SQRT,   [JET_EXP] = OP_EXP,     [JET_LOG] = OP_LOG,     [JET_SIN] = OP_SIN,
        [JET_COS] = OP_COS,     [JET_TAN] = OP_TAN,     [JET_ASIN] = OP_ASIN,   [JET_ACOS] = OP_ACOS,
        [JET_ATAN] = OP_ATAN,   [JET_SINH] = OP_SINH,   [JET_COSH] = OP_COSH,   [JET_TANH] = OP_TANH,
        [JET_ASINH] = OP_ASINH, [JET_ACOSH] = OP_ACOSH, [JET_ATANH] = OP_ATANH, [JET_ERF] = OP_ERF,
    };
    if ((unsigned)f >= JET_FUNCTION_COUNT) return jet_make_poison(JET_NO_FUNCTION);
    if (f == JET_NEG) return jet_mul(-1, a);
    if (f == JET_SQR) return jet_mul(a, a);
    return jet_record_operation(ops[f], a, jet_const(0));
}

jet jet_record_function2(jet_function2 f, jet a, jet b)
{
    static const jet_op ops[JET_FUNCTION2_COUNT] = {[JET_ATAN2] = OP_ATAN2, [JET_HYPOT] = OP_HYPOT};
    if ((unsigned)f >= JET_FUNCTION2_COUNT) return jet_make_poison(JET_NO_FUNCTION);
    return jet_record_operation(ops[f], a, b);
}
