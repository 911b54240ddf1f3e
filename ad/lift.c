/* lift.c - Records a closed graph once more into another graph, alone or together with its derivative along a
 * direction, by forward accumulation (docs/jets.md, section 1). src/system/ calls it for tangent maps, rescaled and
 * adjoint systems and the functions of events. */
#include "graph.h"
#include "rule.h"

#include <stdlib.h>

typedef struct {
    const jet_graph *source;
    jet_graph *target;
    const jet *parameter_direction;    /* Direction of each parameter; NULL: all are 0. */
    bool *is_node_needed;              /* [nodes] Tells whether an output depends on the node of `source`. */
    jet *value, *derivative;           /* [nodes] Value and derivative of each node of `source`, as jets of `target`. */
    jet *scratch_term_jets;            /* Scratch: the operands of a sum, then its constant term. */
    double *scratch_term_coefficients; /* Scratch: the coefficients of a sum, then 1 for its constant term. */
} forward_recording;

static void mark_needed_nodes(forward_recording *recording, int node_count, int output_count, const jet output[])
{
    for (int i = 0; i < output_count; i++) recording->is_node_needed[output[i].node->index] = true;
    for (int i = node_count - 1; i >= 0; i--) {
        const struct jet_node *z = jet_graph_node_at(recording->source, i);
        if (!recording->is_node_needed[i]) continue;
        if (z->a) recording->is_node_needed[z->a->index] = true;
        if (z->b) recording->is_node_needed[z->b->index] = true;
        for (int term = 0; term < z->count; term++) recording->is_node_needed[z->terms[term].node->index] = true;
    }
}

/* Records constant_term + sum_i coefficient_i operand_i, with the coefficients of the sum z. operand_jets has a jet for
 * each node of the source. */
static jet record_sum_with_given_operands(const forward_recording *recording, const struct jet_node *z,
                                          const jet operand_jets[], double constant_term)
{
    for (int term = 0; term < z->count; term++) {
        recording->scratch_term_coefficients[term] = z->terms[term].coefficient;
        recording->scratch_term_jets[term] = operand_jets[z->terms[term].node->index];
    }
    recording->scratch_term_coefficients[z->count] = 1;
    recording->scratch_term_jets[z->count] = jet_const(constant_term);
    return jet_record_linear_combination(z->count + 1, recording->scratch_term_coefficients,
                                         recording->scratch_term_jets);
}

static jet record_primal_node(const forward_recording *recording, const struct jet_node *z)
{
    const jet a = z->a ? recording->value[z->a->index] : jet_const(0);
    const jet b = z->b ? recording->value[z->b->index] : jet_const(0);
    switch (z->op) {
    case OP_CONST: return jet_const(z->number);
    case OP_PARAMETER: return jet_graph_record_parameter(recording->target, z->parameter_index, z->number);
    case OP_LINEAR: return record_sum_with_given_operands(recording, z, recording->value, z->number);
    case OP_SQR: return jet_sqr(a);
    case OP_MUL: return jet_mul(a, b);
    case OP_DIV: return jet_div(a, b);
    case OP_POW: return jet_pow(a, z->number);
    case OP_SECH2:
        /* Each order of sech^2 is computed from the same order of tanh, which must therefore be recorded before it. */
        (void)jet_tanh(a);
    default: return jet_record_operation(z->op, a, b);
    }
}

/* Records the derivative of z, dz = z_a da + z_b db, from those of its operands a and b; z_a and z_b are the partial
 * derivatives of z by a and b. A rule's pullback multiplies any jet zbar by z_a or z_b; here da or db takes the place
 * of zbar. */
static jet record_derivative(const forward_recording *recording, const struct jet_node *z, jet value)
{
    if (z->op == OP_CONST) return jet_const(0);
    if (z->op == OP_PARAMETER)
        return recording->parameter_direction ? recording->parameter_direction[z->parameter_index] : jet_const(0);
    if (z->op == OP_LINEAR) return record_sum_with_given_operands(recording, z, recording->derivative, 0);
    if (!value.node || !value.node->graph) return value;
    const jet_rule *rule = jet_rules[z->op];
    const jet da = recording->derivative[z->a->index];
    if (!z->b) return rule->record_pullback(value.node, da, 0);
    const jet db = recording->derivative[z->b->index];
    const bool swapped = z->op == OP_MUL && value.node->a != recording->value[z->a->index].node;
    return jet_add(rule->record_pullback(value.node, da, swapped), rule->record_pullback(value.node, db, !swapped));
}

static bool allocate_forward_recording(forward_recording *recording, int node_count)
{
    int terms = 0;
    for (int i = 0; i < node_count; i++) {
        const int term_count = jet_graph_node_at(recording->source, i)->count;
        terms = term_count > terms ? term_count : terms;
    }
    const size_t nodes = (size_t)node_count + 1, most_terms = (size_t)terms + 1;
    recording->is_node_needed = calloc(nodes, sizeof *recording->is_node_needed);
    recording->value = calloc(nodes, sizeof *recording->value);
    recording->derivative = calloc(nodes, sizeof *recording->derivative);
    recording->scratch_term_jets = calloc(most_terms, sizeof *recording->scratch_term_jets);
    recording->scratch_term_coefficients = calloc(most_terms, sizeof *recording->scratch_term_coefficients);
    return recording->is_node_needed && recording->value && recording->derivative && recording->scratch_term_jets &&
           recording->scratch_term_coefficients;
}

static void record_values_and_derivatives(forward_recording *recording, int node_count, const jet input[],
                                          const jet direction[])
{
    for (int i = 0; i < node_count; i++) {
        const struct jet_node *z = jet_graph_node_at(recording->source, i);
        if (!recording->is_node_needed[i]) continue;
        recording->value[i] = z->op == OP_INPUT ? input[i] : record_primal_node(recording, z);
        if (direction)
            recording->derivative[i] =
                z->op == OP_INPUT ? direction[i] : record_derivative(recording, z, recording->value[i]);
    }
}

bool jet_record_forward_derivatives(const jet_graph *source, jet_graph *target, const jet input[],
                                    const jet direction[], const jet parameter_direction[], int output_count,
                                    const jet output[], jet value[], jet derivative[])
{
    forward_recording recording = {.source = source, .target = target, .parameter_direction = parameter_direction};
    const int node_count = jet_graph_node_count(source);
    const bool allocated = allocate_forward_recording(&recording, node_count);
    if (allocated) {
        mark_needed_nodes(&recording, node_count, output_count, output);
        record_values_and_derivatives(&recording, node_count, input, direction);
        for (int i = 0; i < output_count; i++) {
            value[i] = recording.value[output[i].node->index];
            if (derivative) derivative[i] = recording.derivative[output[i].node->index];
        }
    }
    free(recording.is_node_needed);
    free(recording.value);
    free(recording.derivative);
    free(recording.scratch_term_jets);
    free(recording.scratch_term_coefficients);
    return allocated;
}

bool jet_record_again(const jet_graph *source, jet_graph *target, const jet input[], int output_count,
                      const jet output[], jet value[])
{
    return jet_record_forward_derivatives(source, target, input, NULL, NULL, output_count, output, value, NULL);
}
