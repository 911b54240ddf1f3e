/* tape.c - Translates a graph, which records a function, to a tape, which computes it (docs/jets.md, section 2).
 * lowering.c orders the nodes; this file joins adjacent equal operations to runs, each of which is one loop.
 * src/system/ creates its tapes here. */
#include "devices.h"
#include "lowering.h"

#include <stdlib.h>

#ifdef TVI_DEVICES
int jet_without;
#endif

static void append_tape_term(jet_tape *tape, double coefficient, int slot_a, int slot_b)
{
    tape->terms.coefficient[tape->terms.count] = coefficient;
    tape->terms.slot[tape->terms.count] = slot_a;
    tape->terms.slot_b[tape->terms.count++] = slot_b;
}

/* Makes a LINEAR run of one operation, and appends its constant term and its terms to the tape. A copy is a sum of
 * one term. */
static jet_run_of_operations make_linear_run(const graph_lowering *lowering, jet_tape *tape, const tape_placement *z)
{
    const int terms = z->node ? z->node->count : 1;
    const double number = z->node ? z->node->number : 0;
    const jet_run_of_operations run = {OP_LINEAR,
                                       1,
                                       z->slot,
                                       .has_nonzero_constant_terms = number != 0,
                                       .first_constant_term_index = tape->linear_operation_count,
                                       .term_count = terms,
                                       .first_term_index = tape->terms.count};
    tape->constant_terms[tape->linear_operation_count++] = number;
    if (!z->node) {
        append_tape_term(tape, 1, z->operand[0][0], 0);
        return run;
    }
    for (int term = 0; term < terms; term++)
        append_tape_term(tape, z->node->terms[term].coefficient, node_slot(lowering, z->node->terms[term].node), 0);
    return run;
}

static bool try_joining_linear_run(jet_run_of_operations *run, const jet_run_of_operations *next)
{
    if (next->term_count != run->term_count) return false;
    if (next->has_nonzero_constant_terms) run->has_nonzero_constant_terms = 1;
    return true;
}

/* Makes a run of one sum of products, and appends its terms to the tape. try_joining_product_run removes these terms
 * again if the operation joins the last run, whose terms it shares. */
static jet_run_of_operations make_product_run(jet_tape *tape, const tape_placement *z)
{
    const jet_run_of_operations run = {z->op, 1, z->slot, .term_count = z->operand_pair_count,
                                       .first_term_index = tape->terms.count};
    for (int pair = 0; pair < z->operand_pair_count; pair++)
        append_tape_term(tape, sum_term(z, pair).coefficient, z->operand[pair][0],
                         z->operand[pair][z->op == OP_PRODUCTS]);
    return run;
}

static bool try_joining_product_run(jet_tape *tape, const jet_run_of_operations *run, const jet_run_of_operations *next)
{
    if (next->term_count != run->term_count) return false;
    for (int here = run->first_term_index, there = next->first_term_index;
         there < next->first_term_index + next->term_count; here++, there++)
        if (tape->terms.coefficient[there] != tape->terms.coefficient[here] ||
            tape->terms.slot[there] != tape->terms.slot[here] + run->operation_count ||
            tape->terms.slot_b[there] != tape->terms.slot_b[here] + run->operation_count)
            return false;
    tape->terms.count = next->first_term_index;
    return true;
}

/* Makes a run of one operation that has a rule. The member w of the run is the slot of the auxiliary series. Such a
 * series that is read at the order that is being computed is the second operand of the placement. */
static jet_run_of_operations make_elementary_run(const graph_lowering *lowering, const tape_placement *z)
{
    const int *operand = z->operand[0];
    jet_run_of_operations run = {z->op, 1, z->slot, operand[0], operand[1], .exponent = z->node->number};
    if (must_compute_auxiliary_series(lowering, z->node)) run.w = node_slot(lowering, z->node->w);
    if (node_reads_own_w_at_same_order(lowering, z->node)) {
        run.b = 0;
        run.w = operand[1];
    }
    return run;
}

static bool can_join_rule_run(const jet_run_of_operations *run, const jet_run_of_operations *next)
{
    const int count = run->operation_count, of_b = jet_rules[run->op]->operand_count == 2 ? count : 0;
    const bool same_w = (run->w == 0 && next->w == 0) || next->w == run->w + count;
    return next->exponent == run->exponent && next->a == run->a + count && next->b == run->b + of_b && same_w;
}

/* Joins the operation `next` to the last run, and returns true, if it is of the same level and kind, and has adjacent
 * operands. Otherwise returns false. */
static bool try_joining_last_run(const graph_lowering *lowering, jet_tape *tape, const jet_run_of_operations *next)
{
    if (tape->run_count == 0) return false;
    jet_run_of_operations *run = &tape->runs[tape->run_count - 1];
    if (run->op != next->op || lowering->nodes_by_slot[run->z]->level != lowering->nodes_by_slot[next->z]->level)
        return false;
    const bool joins = next->op == OP_LINEAR              ? try_joining_linear_run(run, next)
                       : jet_is_sum_of_products(next->op) ? try_joining_product_run(tape, run, next)
                                                          : can_join_rule_run(run, next);
    run->operation_count += joins;
    return joins;
}

/* Appends an operation to the last run, or as a run of its own. */
static void append_operation(const graph_lowering *lowering, jet_tape *tape, const tape_placement *z)
{
    const jet_run_of_operations next = z->op == OP_LINEAR              ? make_linear_run(lowering, tape, z)
                                       : jet_is_sum_of_products(z->op) ? make_product_run(tape, z)
                                                                       : make_elementary_run(lowering, z);
    if (!try_joining_last_run(lowering, tape, &next)) tape->runs[tape->run_count++] = next;
}

static void append_constant(jet_tape *tape, const tape_placement *z)
{
    tape->constant_values[tape->constant_count++] = z->node->number;
    if (z->op == OP_PARAMETER)
        tape->parameters[tape->parameter_count++] = (jet_tape_parameter){z->node->parameter_index, z->slot};
}

static void lay_out_runs_and_constants(graph_lowering *lowering, jet_tape *tape)
{
    for (int i = 0; i < lowering->slot_count; i++) {
        const tape_placement *z = lowering->nodes_by_slot[i];
        const struct jet_node *named = z->node && z->node->owner ? z->node->owner : z->node;
        tape->refusal.number_of_slot[i] = named ? named->index + 1 - jet_graph_input_count(lowering->graph) : 0;
        tape->refusal.owner_of_slot[i] = named != z->node ? named->op : OP_INPUT;
        if (z->op == OP_INPUT) tape->input_count++;
        else if (z->op == OP_CONST || z->op == OP_PARAMETER) append_constant(tape, z);
        else append_operation(lowering, tape, z);
    }
}

static bool allocate_lowering_and_tape(graph_lowering *lowering, jet_tape *tape, int output_count)
{
    size_t pairs = 1, nodes = (size_t)lowering->node_count + 1;
    for (int i = 0; i < lowering->node_count; i++) pairs += 1 + (size_t)jet_graph_node_at(lowering->graph, i)->count;
    const size_t copies = 2 * pairs; /* Each of the two operands of a pair may have a copy. */
    lowering->is_node_needed = calloc(nodes, sizeof *lowering->is_node_needed);
    lowering->use_counts = calloc(nodes, sizeof *lowering->use_counts);
    lowering->placements = calloc(nodes + copies, sizeof *lowering->placements);
    lowering->nodes_by_level = calloc(nodes, sizeof(tape_placement *));
    lowering->nodes_by_slot = calloc(nodes + copies, sizeof(tape_placement *));
    lowering->operands = calloc(pairs + copies, sizeof *lowering->operands);
    tape->runs = calloc(nodes + copies, sizeof *tape->runs);
    tape->constant_values = calloc(nodes, sizeof *tape->constant_values);
    tape->parameters = calloc(nodes, sizeof *tape->parameters);
    tape->constant_terms = calloc(nodes + copies, sizeof *tape->constant_terms);
    tape->terms.slot = calloc(pairs + copies, sizeof *tape->terms.slot);
    tape->terms.slot_b = calloc(pairs + copies, sizeof *tape->terms.slot_b);
    tape->terms.coefficient = calloc(pairs + copies, sizeof *tape->terms.coefficient);
    tape->output_slot = calloc((size_t)output_count + 1, sizeof *tape->output_slot);
    tape->refusal.number_of_slot = calloc(nodes + copies, sizeof *tape->refusal.number_of_slot);
    tape->refusal.owner_of_slot = calloc(nodes + copies, sizeof *tape->refusal.owner_of_slot);
    return lowering->is_node_needed && lowering->use_counts && lowering->placements && lowering->nodes_by_level &&
           lowering->nodes_by_slot && lowering->operands && tape->runs && tape->constant_values && tape->parameters &&
           tape->constant_terms && tape->terms.slot && tape->terms.slot_b && tape->terms.coefficient &&
           tape->output_slot && tape->refusal.number_of_slot && tape->refusal.owner_of_slot;
}

/* Lowers the graph to the tape, whose arrays are allocated. */
static void lower_graph_to_tape(graph_lowering *lowering, jet_tape *tape, int input_count, int output_count,
                                const jet output[])
{
    jet_assign_slots(lowering, input_count, output_count, output);
    lay_out_runs_and_constants(lowering, tape);
    tape->refusal.library_name = jet_graph_library_nodes_name(lowering->graph, &tape->refusal.first_library_number);
    tape->refusal.first_library_number += 1 - jet_graph_input_count(lowering->graph);
    tape->slot_count = lowering->slot_count;
    tape->output_count = output_count;
    tape->used_node_count = lowering->used_node_count;
    for (int i = 0; i < output_count; i++) tape->output_slot[i] = node_slot(lowering, output[i].node);
}

jet_tape *jet_tape_create(const jet_graph *graph, int input_count, int output_count, const jet output[],
                          jet_tape_kind kind)
{
    jet_tape *tape = calloc(1, sizeof *tape);
    if (!tape) return NULL;
    tape->sweeps = tape->interpreter_sweeps = jet_choose_sweeps_for_processor();
    graph_lowering lowering = {.graph = graph, .tape_kind = kind, .node_count = jet_graph_node_count(graph)};
    const bool is_made = allocate_lowering_and_tape(&lowering, tape, output_count);
    if (is_made) lower_graph_to_tape(&lowering, tape, input_count, output_count, output);
    free(lowering.is_node_needed);
    free(lowering.use_counts);
    free(lowering.placements);
    free(lowering.nodes_by_level);
    free(lowering.nodes_by_slot);
    free(lowering.operands);
    if (is_made) return tape;
    jet_tape_free(tape);
    return NULL;
}
