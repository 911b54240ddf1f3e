/* jet.c - from handles to graph nodes: records the user's operations, folds constants, shares equal nodes. */
#include "graph.h"
#include "rule.h"

#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 128, INTEGER_POWER_MAX = INT_MAX };

struct jet_graph {
    bool open;
    bool out_of_memory; /* some operation was lost: no output is accepted any more */
    int inputs, count, capacity;
    struct jet_node **nodes; /* chunks of CHUNK nodes, so that handles stay valid while the graph grows */
    int slots;               /* of the hash table, a power of two > 2 count */
    struct jet_node **table;
    long collisions; /* other nodes met where one was looked for in the table */
};

/* ---- Poison: an operation that could not be recorded, and the reason --------------------------------------------- */

#define POISON(code, text) {.graph = NULL, .op = OP_CONST, .index = code},
static const struct jet_node poison_nodes[TVI_STATUS_COUNT] = {TVI_STATUS_LIST(POISON)};

static jet poison(tvi_status reason) { return jet_of_node((struct jet_node *)&poison_nodes[reason]); }

static bool is_poison(jet x) { return x.node && !x.node->graph; }

jet jet_unset(void) { return poison(TVI_EINVAL); }

/* The open graph that all nodes among x belong to, NULL where all are numbers. */
static tvi_status find_graph(int count, const jet x[], jet_graph **graph)
{
    *graph = NULL;
    for (int i = 0; i < count; i++) {
        if (is_poison(x[i])) return (tvi_status)x[i].node->index; /* NOLINT(clang-analyzer-core.NullDereference) */
        if (!x[i].node) {
            if (!isfinite(x[i].number)) return TVI_ENONFINITE;
            continue;
        }
        if (*graph && x[i].node->graph != *graph) return TVI_EINVAL;
        *graph = x[i].node->graph;
        if (!(*graph)->open) return TVI_EINVAL;
    }
    return TVI_OK;
}

static jet number_or_poison(double value) { return isfinite(value) ? jet_const(value) : poison(TVI_ENONFINITE); }

/* ---- The graph --------------------------------------------------------------------------------------------------- */

struct jet_node *jet_graph_node(const jet_graph *graph, int index)
{
    return &graph->nodes[index / CHUNK][index % CHUNK];
}

int jet_graph_inputs(const jet_graph *graph) { return graph->inputs; }
int jet_graph_count(const jet_graph *graph) { return graph->count; }
jet jet_graph_input(const jet_graph *graph, int i) { return jet_of_node(jet_graph_node(graph, i)); }
long jet_graph_collisions(const jet_graph *graph) { return graph->collisions; }
void jet_graph_close(jet_graph *graph) { graph->open = false; }

static bool has_second_operand(jet_op op) { return jet_role_of_b(op) == B_OPERAND; }

static uint64_t mix(uint64_t hash, uint64_t word)
{
    hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
    return hash ^ (hash >> 29);
}

static uint64_t bits(double value)
{
    uint64_t word;
    memcpy(&word, &value, sizeof word);
    return word;
}

static uint64_t node_hash(const struct jet_node *node)
{
    uint64_t hash = mix((uint64_t)node->op, bits(node->number));
    if (node->op == OP_INPUT) hash = mix(hash, (uint64_t)node->index);
    if (node->a) hash = mix(hash, (uint64_t)node->a->index);
    /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): the operation has a second operand */
    if (has_second_operand(node->op)) hash = mix(hash, (uint64_t)node->b->index);
    for (int i = 0; i < node->count; i++)
        hash = mix(mix(hash, bits(node->terms[i].coefficient)), (uint64_t)node->terms[i].node->index);
    return hash;
}

static bool same_node(const struct jet_node *x, const struct jet_node *y)
{
    if (x->op != y->op || bits(x->number) != bits(y->number) || x->a != y->a || x->count != y->count) return false;
    if (x->op == OP_INPUT) return x->index == y->index;
    if (has_second_operand(x->op) && x->b != y->b) return false;
    for (int i = 0; i < x->count; i++)
        if (x->terms[i].node != y->terms[i].node || bits(x->terms[i].coefficient) != bits(y->terms[i].coefficient))
            return false;
    return true;
}

/* Where the node is in the table, or the empty slot where it belongs. */
static struct jet_node **table_slot(jet_graph *graph, const struct jet_node *node)
{
    const uint64_t mask = (uint64_t)graph->slots - 1;
    uint64_t i = node_hash(node) & mask;
    for (; graph->table[i] && !same_node(graph->table[i], node); i = (i + 1) & mask) graph->collisions++;
    return &graph->table[i];
}

static bool grow_table(jet_graph *graph)
{
    const int slots = graph->slots ? 2 * graph->slots : 4 * CHUNK;
    struct jet_node **table = calloc((size_t)slots, sizeof *table);
    if (!table) return false;
    free(graph->table);
    graph->table = table;
    graph->slots = slots;
    for (int i = 0; i < graph->count; i++) {
        struct jet_node *node = jet_graph_node(graph, i);
        *table_slot(graph, node) = node;
    }
    return true;
}

static bool reserve(jet_graph *graph)
{
    if (graph->count == graph->capacity) {
        struct jet_node **nodes = realloc(graph->nodes, (size_t)(graph->capacity / CHUNK + 1) * sizeof *nodes);
        if (!nodes) return false;
        graph->nodes = nodes;
        nodes[graph->capacity / CHUNK] = calloc(CHUNK, sizeof **nodes);
        if (!nodes[graph->capacity / CHUNK]) return false;
        graph->capacity += CHUNK;
    }
    return graph->slots > 2 * graph->count + 2 || grow_table(graph);
}

/* The node equal to `wanted`, recorded now if it is new. Takes the terms of `wanted`. NULL without memory. */
static struct jet_node *record(jet_graph *graph, struct jet_node wanted, bool *is_new)
{
    *is_new = false;
    if (!reserve(graph)) {
        free(wanted.terms);
        graph->out_of_memory = true;
        return NULL;
    }
    wanted.graph = graph;
    wanted.index = graph->count;
    struct jet_node **slot = table_slot(graph, &wanted);
    if (*slot) {
        free(wanted.terms);
        return *slot;
    }
    *is_new = true;
    *slot = jet_graph_node(graph, graph->count++);
    **slot = wanted;
    return *slot;
}

static jet record_jet(jet_graph *graph, struct jet_node wanted)
{
    bool is_new;
    struct jet_node *node = record(graph, wanted, &is_new);
    return node ? jet_of_node(node) : poison(TVI_ENOMEM);
}

jet_graph *jet_graph_create(int inputs)
{
    jet_graph *graph = calloc(1, sizeof *graph);
    if (!graph) return NULL;
    graph->open = true;
    for (int i = 0; i < inputs; i++) (void)record_jet(graph, (struct jet_node){.op = OP_INPUT});
    graph->inputs = inputs;
    if (graph->out_of_memory) {
        jet_graph_free(graph);
        return NULL;
    }
    return graph;
}

void jet_graph_free(jet_graph *graph)
{
    if (!graph) return;
    for (int i = 0; i < graph->count; i++) free(jet_graph_node(graph, i)->terms);
    for (int i = 0; i < graph->capacity / CHUNK; i++) free(graph->nodes[i]);
    free(graph->nodes);
    free(graph->table);
    free(graph);
}

static jet constant_node(jet_graph *graph, double value)
{
    return record_jet(graph, (struct jet_node){.op = OP_CONST, .number = value});
}

tvi_status jet_graph_accept(jet_graph *graph, int outputs, jet output[])
{
    for (int i = 0; i < outputs; i++) {
        if (!output[i].node && !isfinite(output[i].number)) return TVI_ENONFINITE;
        if (!output[i].node) output[i] = constant_node(graph, output[i].number);
        if (graph->out_of_memory) return TVI_ENOMEM;
        /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): no node means out of memory, above */
        if (is_poison(output[i])) return (tvi_status)output[i].node->index;
        /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): no node means out of memory, above */
        if (output[i].node->graph != graph) return TVI_EINVAL;
    }
    return TVI_OK;
}

/* ---- Linear combinations ----------------------------------------------------------------------------------------- */

/* Adds coefficient * node to the terms, to an equal node's term where there is one. */
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
    const tvi_status status = find_graph(count, x, &graph);
    if (status != TVI_OK) return poison(status);
    struct jet_node sum = {.op = OP_LINEAR};
    if (graph && !(sum.terms = calloc((size_t)count, sizeof *sum.terms))) {
        graph->out_of_memory = true;
        return poison(TVI_ENOMEM);
    }
    for (int i = 0; i < count; i++) {
        if (x[i].node) collect(&sum, coefficient[i], x[i].node);
        else sum.number += coefficient[i] * x[i].number;
    }
    drop_zero_terms(&sum);
    const bool finite = terms_are_finite(&sum);
    const bool is_number = sum.count == 0;
    const bool is_one_node = sum.count == 1 && sum.terms[0].coefficient == 1 && sum.number == 0;
    if (finite && !is_number && !is_one_node) return record_jet(graph, sum);
    const jet result = !finite     ? poison(TVI_ENONFINITE)
                       : is_number ? jet_const(sum.number)
                                   : jet_of_node(sum.terms[0].node);
    free(sum.terms);
    return result;
}

jet jet_record_add(jet a, jet b) { return jet_linear(2, (const double[]){1, 1}, (const jet[]){a, b}); }
jet jet_record_sub(jet a, jet b) { return jet_linear(2, (const double[]){1, -1}, (const jet[]){a, b}); }

/* An operation on x that there is no memory for: no output of their graph is accepted any more. */
static jet out_of_memory(int count, const jet x[])
{
    jet_graph *graph;
    if (find_graph(count, x, &graph) == TVI_OK && graph) graph->out_of_memory = true;
    return poison(TVI_ENOMEM);
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

/* The operation on numbers alone, by the rule's own value. */
static jet fold(jet_op op, double c, double a, double b)
{
    double z;
    if (!jet_rules[op]->value(c, 1, &a, &b, &z)) return poison(TVI_EDOMAIN);
    return number_or_poison(z);
}

jet jet_record_mul(jet a, jet b)
{
    jet_graph *graph;
    const tvi_status status = find_graph(2, (const jet[]){a, b}, &graph);
    if (status != TVI_OK) return poison(status);
    if (!graph) return fold(OP_MUL, 0, a.number, b.number);
    if (!a.node) return jet_linear(1, &a.number, &b);
    if (!b.node) return jet_linear(1, &b.number, &a);
    if (a.node == b.node) return record_jet(graph, (struct jet_node){.op = OP_SQR, .a = a.node});
    if (a.node->index > b.node->index) return jet_record_mul(b, a);
    return record_jet(graph, (struct jet_node){.op = OP_MUL, .a = a.node, .b = b.node});
}

jet jet_record_div(jet a, jet b)
{
    jet_graph *graph;
    const tvi_status status = find_graph(2, (const jet[]){a, b}, &graph);
    if (status != TVI_OK) return poison(status);
    if (!b.node && b.number == 0) return poison(TVI_EDOMAIN);
    if (!graph) return fold(OP_DIV, 0, a.number, b.number);
    if (!b.node) {
        const double reciprocal = 1 / b.number;
        return jet_linear(1, &reciprocal, &a);
    }
    if (!a.node && a.number == 0) return a;
    if (!a.node) a = constant_node(graph, a.number);
    if (is_poison(a)) return a;
    return record_jet(graph, (struct jet_node){.op = OP_DIV, .a = a.node, .b = b.node});
}

/* a^count by repeated squaring, count >= 1: exists for every a. */
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
    const tvi_status status = find_graph(1, &a, &graph);
    if (status != TVI_OK) return poison(status);
    if (!isfinite(c)) return poison(TVI_ENONFINITE);
    const bool natural = c >= 0 && c == floor(c);
    if (!graph && natural) return number_or_poison(pow(a.number, c));
    if (!graph) return fold(OP_POW, c, a.number, 0);
    if (c == 0) return jet_const(1);
    if (c == 0.5) return jet_sqrt(a);
    if (c == -1) return jet_div(1, a);
    if (natural && c <= INTEGER_POWER_MAX) return integer_power(a, (int)c);
    return record_jet(graph, (struct jet_node){.op = OP_POW, .a = a.node, .number = c});
}

static jet record_function(jet_graph *graph, jet_op op, struct jet_node *a);

/* The partner series that the recurrence of z needs, recorded beside it (see jet_op). */
static jet partner(jet_graph *graph, struct jet_node *z)
{
    const jet a = jet_of_node(z->a);
    switch (z->op) {
    case OP_EXP: return jet_of_node(z);
    case OP_SIN: return record_function(graph, OP_COS, z->a);
    case OP_COS: return record_function(graph, OP_SIN, z->a);
    case OP_SINH: return record_function(graph, OP_COSH, z->a);
    case OP_COSH: return record_function(graph, OP_SINH, z->a);
    case OP_TAN: return jet_add(1, jet_sqr(jet_of_node(z)));
    case OP_TANH: return record_function(graph, OP_SECH2, z->a);
    case OP_SECH2: return record_function(graph, OP_TANH, z->a);
    case OP_LOG: return a;
    case OP_ASIN:
    case OP_ACOS: return jet_sqrt(jet_mul(jet_sub(1, a), jet_add(1, a)));
    case OP_ATAN: return jet_add(1, jet_sqr(a));
    default: return jet_const(0); /* needs none */
    }
}

static jet record_function(jet_graph *graph, jet_op op, struct jet_node *a)
{
    bool is_new;
    struct jet_node *z = record(graph, (struct jet_node){.op = op, .a = a}, &is_new);
    if (!z) return poison(TVI_ENOMEM);
    if (is_new) {
        const jet w = partner(graph, z);
        if (is_poison(w)) return w;
        z->b = w.node;
    }
    return jet_of_node(z);
}

jet jet_record_op(jet_op op, jet a)
{
    jet_graph *graph;
    const tvi_status status = find_graph(1, &a, &graph);
    if (status != TVI_OK) return poison(status);
    return graph ? record_function(graph, op, a.node) : fold(op, 0, a.number, 0);
}

jet jet_record_function(jet_function f, jet a)
{
    static const jet_op ops[] = {
        [JET_SQRT] = OP_SQRT, [JET_EXP] = OP_EXP,   [JET_LOG] = OP_LOG,   [JET_SIN] = OP_SIN,
        [JET_COS] = OP_COS,   [JET_TAN] = OP_TAN,   [JET_ASIN] = OP_ASIN, [JET_ACOS] = OP_ACOS,
        [JET_ATAN] = OP_ATAN, [JET_SINH] = OP_SINH, [JET_COSH] = OP_COSH, [JET_TANH] = OP_TANH,
    };
    if (f == JET_NEG) return jet_mul(-1, a);
    if (f == JET_SQR) return jet_mul(a, a);
    return jet_record_op(ops[f], a);
}
