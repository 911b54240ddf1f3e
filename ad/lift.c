/* lift.c - Records functions and their derivatives along a direction into another graph, by forward accumulation. */
#include "graph.h"
#include "rule.h"

#include <stdlib.h>

typedef struct {
    const jet_graph *from;
    jet_graph *to;
    const jet *parameter_direction; /* directions; NULL: zeros */
    bool *needed;                   /* [count] nodes of `from` that an output depends on */
    jet *value, *rate;              /* [count] in the open graph */
    jet *term;                      /* scratch for the terms of one node, and its number */
    double *coefficient;
} lifting;

static void mark_needed(lifting *l, int count, int outputs, const jet output[])
{
    for (int i = 0; i < outputs; i++) l->needed[output[i].node->index] = true;
    for (int i = count - 1; i >= 0; i--) {
        const struct jet_node *z = jet_graph_node(l->from, i);
        if (!l->needed[i]) continue;
        if (z->a) l->needed[z->a->index] = true;
        if (z->b) l->needed[z->b->index] = true;
        for (int term = 0; term < z->count; term++) l->needed[z->terms[term].node->index] = true;
    }
}

/* number + sum_i coefficient_i x_i */
static jet combine(const lifting *l, const struct jet_node *z, const jet x[], double number)
{
    for (int term = 0; term < z->count; term++) {
        l->coefficient[term] = z->terms[term].coefficient;
        l->term[term] = x[z->terms[term].node->index];
    }
    l->coefficient[z->count] = 1;
    l->term[z->count] = jet_const(number);
    return jet_linear(z->count + 1, l->coefficient, l->term);
}

static jet value_of(const lifting *l, const struct jet_node *z)
{
    const jet a = z->a ? l->value[z->a->index] : jet_const(0);
    const jet b = z->b ? l->value[z->b->index] : jet_const(0);
    switch (z->op) {
    case OP_CONST: return jet_const(z->number);
    case OP_PARAMETER: return jet_graph_parameter(l->to, z->which, z->number);
    case OP_LINEAR: return combine(l, z, l->value, z->number);
    case OP_SQR: return jet_sqr(a);
    case OP_MUL: return jet_mul(a, b);
    case OP_DIV: return jet_div(a, b);
    case OP_POW: return jet_pow(a, z->number);
    case OP_SECH2: (void)jet_tanh(a); /* fall through: the series of tanh reads this one, which must stand before it */
    default: return jet_record_op(z->op, a, b);
    }
}

/* dz = z_a da + z_b db. The pull of a rule gives z-bar times z_a or z_b for any z-bar, here da or db. */
static jet rate_of(const lifting *l, const struct jet_node *z, jet value)
{
    if (z->op == OP_CONST) return jet_const(0);
    if (z->op == OP_PARAMETER) return l->parameter_direction ? l->parameter_direction[z->which] : jet_const(0);
    if (z->op == OP_LINEAR) return combine(l, z, l->rate, 0);
    if (!value.node || !value.node->graph) return value;
    const jet_rule *rule = jet_rules[z->op];
    const jet da = l->rate[z->a->index];
    if (!z->b) return rule->pull(value.node, da, 0);
    const jet db = l->rate[z->b->index];
    const bool swapped = z->op == OP_MUL && value.node->a != l->value[z->a->index].node;
    return jet_add(rule->pull(value.node, da, swapped), rule->pull(value.node, db, !swapped));
}

static bool allocate(lifting *l, int count)
{
    int terms = 0;
    for (int i = 0; i < count; i++) {
        const int of_node = jet_graph_node(l->from, i)->count;
        terms = of_node > terms ? of_node : terms;
    }
    const size_t nodes = (size_t)count + 1, most = (size_t)terms + 1;
    l->needed = calloc(nodes, sizeof *l->needed);
    l->value = calloc(nodes, sizeof *l->value);
    l->rate = calloc(nodes, sizeof *l->rate);
    l->term = calloc(most, sizeof *l->term);
    l->coefficient = calloc(most, sizeof *l->coefficient);
    return l->needed && l->value && l->rate && l->term && l->coefficient;
}

static void lift_nodes(lifting *l, int count, const jet input[], const jet direction[])
{
    for (int i = 0; i < count; i++) {
        const struct jet_node *z = jet_graph_node(l->from, i);
        if (!l->needed[i]) continue;
        l->value[i] = z->op == OP_INPUT ? input[i] : value_of(l, z);
        l->rate[i] = z->op == OP_INPUT ? direction[i] : rate_of(l, z, l->value[i]);
    }
}

bool jet_lift(const jet_graph *from, jet_graph *to, const jet input[], const jet direction[],
              const jet parameter_direction[], int outputs, const jet output[], jet value[], jet rate[])
{
    lifting l = {.from = from, .to = to, .parameter_direction = parameter_direction};
    const int count = jet_graph_count(from);
    const bool allocated = allocate(&l, count);
    if (allocated) {
        mark_needed(&l, count, outputs, output);
        lift_nodes(&l, count, input, direction);
        for (int i = 0; i < outputs; i++) {
            value[i] = l.value[output[i].node->index];
            rate[i] = l.rate[output[i].node->index];
        }
    }
    free(l.needed);
    free(l.value);
    free(l.rate);
    free(l.term);
    free(l.coefficient);
    return allocated;
}
