/* graph.c - Keeps the graph of one recording: its nodes, the hash table that finds equal nodes, and the poison
 * nodes, which stand for operations that could not be recorded (docs/jets.md, section 1). */
#include "graph.h"
#include "refusal.h"
#include "rule.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 128 };

struct jet_graph {
    bool is_open;
    const char *output_name; /* Name of the outputs, for the texts of refusals. */
    /* Name of the operations that the library records itself; NULL: there are none. */
    const char *library_nodes_name;
    int first_library_node; /* Index of the first operation that the library records itself. */
    bool is_out_of_memory;  /* An operation could not be stored. All outputs are refused from then on. */
    int input_count, parameter_count, count, capacity;
    int axes; /* The inputs come in vectors of so many components, as places of bodies do; 0: unknown. */
    /* Pointers to chunks of CHUNK nodes each. Nodes never move, so that jets may point to them. */
    struct jet_node **nodes;
    int table_size; /* Size of the hash table: a power of two greater than twice the number of nodes. */
    struct jet_node **table;
    /* Number of times that the search for a node in the hash table met a different node. */
    long collision_count;
};

/* ---- Poison: an operation that could not be recorded, and the reason --------------------------------------------- */

#define POISON(reason, status, text) [reason] = {.op = OP_CONST, .index = status},
#define OUTSIDE(code, name)          POISON(JET_OUTSIDE + code, TVI_EDOMAIN, )
static const struct jet_node poison_nodes[] = {JET_REASON_LIST(POISON) JET_RULE_LIST(OUTSIDE)};

jet jet_make_poison(jet_reason reason) { return jet_from_node((struct jet_node *)&poison_nodes[reason]); }

jet jet_make_domain_poison(jet_op op, double operand)
{
    return (jet){operand, (struct jet_node *)&poison_nodes[JET_OUTSIDE + (int)op]};
}

jet jet_make_poison_beyond_end(jet_reason reason, int index)
{
    return (jet){index, (struct jet_node *)&poison_nodes[reason]};
}

bool jet_is_poison(jet x) { return x.node && !x.node->graph; }

jet_reason jet_poison_reason(jet x)
{
    const uintptr_t offset = (uintptr_t)x.node - (uintptr_t)poison_nodes;
    return offset < sizeof poison_nodes ? (jet_reason)(offset / sizeof *poison_nodes) : JET_UNSET;
}

tvi_status jet_reason_status(jet_reason reason) { return (tvi_status)poison_nodes[reason].index; }

jet jet_find_common_graph_or_poison(int count, const jet x[], jet_graph **graph)
{
    *graph = NULL;
    for (int i = 0; i < count; i++) {
        if (jet_is_poison(x[i])) return x[i];
        if (!x[i].node) {
            if (!isfinite(x[i].number)) return jet_make_poison(JET_NOT_FINITE);
            continue;
        }
        if (*graph && x[i].node->graph != *graph) return jet_make_poison(JET_FOREIGN);
        *graph = x[i].node->graph;
        if (!(*graph)->is_open) return jet_make_poison(JET_FOREIGN);
    }
    return jet_const(0);
}

/* ---- The graph --------------------------------------------------------------------------------------------------- */

struct jet_node *jet_graph_node_at(const jet_graph *graph, int index)
{
    return &graph->nodes[index / CHUNK][index % CHUNK];
}

int jet_graph_input_count(const jet_graph *graph) { return graph->input_count; }
int jet_graph_node_count(const jet_graph *graph) { return graph->count; }
jet jet_graph_input(const jet_graph *graph, int i) { return jet_from_node(jet_graph_node_at(graph, i)); }
long jet_graph_hash_collision_count(const jet_graph *graph) { return graph->collision_count; }
void jet_graph_end_recording(jet_graph *graph) { graph->is_open = false; }
void jet_graph_set_output_name(jet_graph *graph, const char *name) { graph->output_name = name; }
void jet_graph_set_axes(jet_graph *graph, int axes) { graph->axes = axes; }
int jet_graph_axes(const jet_graph *graph) { return graph->axes; }
void jet_graph_begin_library_nodes(jet_graph *graph, const char *name_for_messages)
{
    graph->first_library_node = graph->count;
    graph->library_nodes_name = name_for_messages;
}

const char *jet_graph_library_nodes_name(const jet_graph *graph, int *first_node_index)
{
    *first_node_index = graph->first_library_node;
    return graph->library_nodes_name;
}

void jet_graph_mark_out_of_memory(jet_graph *graph) { graph->is_out_of_memory = true; }

static uint64_t mix_into_hash(uint64_t hash, uint64_t word)
{
    hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
    return hash ^ (hash >> 29);
}

static uint64_t double_bits(double value)
{
    uint64_t word;
    memcpy(&word, &value, sizeof word);
    return word;
}

/* Computes the hash of a node's operation, number and operands. The auxiliary node is left out, since the operation and
 * the operands determine it. */
static uint64_t hash_node(const struct jet_node *node)
{
    uint64_t hash = mix_into_hash((uint64_t)node->op, double_bits(node->number));
    if (node->op == OP_INPUT) hash = mix_into_hash(hash, (uint64_t)node->index);
    if (node->op == OP_PARAMETER) hash = mix_into_hash(hash, (uint64_t)node->parameter_index);
    if (node->a) hash = mix_into_hash(hash, (uint64_t)node->a->index);
    if (node->b) hash = mix_into_hash(hash, (uint64_t)node->b->index);
    for (int i = 0; i < node->count; i++)
        hash = mix_into_hash(mix_into_hash(hash, double_bits(node->terms[i].coefficient)),
                             (uint64_t)node->terms[i].node->index);
    return hash;
}

static bool are_nodes_equal(const struct jet_node *x, const struct jet_node *y)
{
    if (x->op != y->op || double_bits(x->number) != double_bits(y->number) || x->count != y->count) return false;
    if (x->op == OP_INPUT) return x->index == y->index;
    if (x->op == OP_PARAMETER) return x->parameter_index == y->parameter_index;
    if (x->a != y->a || x->b != y->b) return false;
    for (int i = 0; i < x->count; i++)
        if (x->terms[i].node != y->terms[i].node ||
            double_bits(x->terms[i].coefficient) != double_bits(y->terms[i].coefficient))
            return false;
    return true;
}

/* Returns the hash table's entry for an equal node, or the empty entry where the node belongs. */
static struct jet_node **find_hash_table_entry(jet_graph *graph, const struct jet_node *node)
{
    const uint64_t mask = (uint64_t)graph->table_size - 1;
    uint64_t i = hash_node(node) & mask;
    for (; graph->table[i] && !are_nodes_equal(graph->table[i], node); i = (i + 1) & mask) graph->collision_count++;
    return &graph->table[i];
}

static bool grow_hash_table(jet_graph *graph)
{
    const int table_size = graph->table_size ? 2 * graph->table_size : 4 * CHUNK;
    struct jet_node **table = calloc((size_t)table_size, sizeof *table);
    if (!table) return false;
    free(graph->table);
    graph->table = table;
    graph->table_size = table_size;
    for (int i = 0; i < graph->count; i++) {
        struct jet_node *node = jet_graph_node_at(graph, i);
        *find_hash_table_entry(graph, node) = node;
    }
    return true;
}

static bool reserve_memory_for_node(jet_graph *graph)
{
    if (graph->count == graph->capacity) {
        struct jet_node **nodes = realloc(graph->nodes, (size_t)(graph->capacity / CHUNK + 1) * sizeof *nodes);
        if (!nodes) return false;
        graph->nodes = nodes;
        nodes[graph->capacity / CHUNK] = calloc(CHUNK, sizeof **nodes);
        if (!nodes[graph->capacity / CHUNK]) return false;
        graph->capacity += CHUNK;
    }
    return graph->table_size > 2 * graph->count + 2 || grow_hash_table(graph);
}

struct jet_node *jet_graph_find_or_record(jet_graph *graph, struct jet_node wanted, bool *is_new)
{
    *is_new = false;
    if (!reserve_memory_for_node(graph)) {
        free(wanted.terms);
        jet_graph_mark_out_of_memory(graph);
        return NULL;
    }
    wanted.graph = graph;
    wanted.index = graph->count;
    struct jet_node **slot = find_hash_table_entry(graph, &wanted);
    if (*slot) {
        free(wanted.terms);
        return *slot;
    }
    *is_new = true;
    *slot = jet_graph_node_at(graph, graph->count++);
    **slot = wanted;
    return *slot;
}

jet jet_graph_record_node(jet_graph *graph, struct jet_node wanted)
{
    bool is_new;
    struct jet_node *node = jet_graph_find_or_record(graph, wanted, &is_new);
    return node ? jet_from_node(node) : jet_make_poison(JET_NO_MEMORY);
}

jet_graph *jet_graph_create(int input_count)
{
    jet_graph *graph = calloc(1, sizeof *graph);
    if (!graph) return NULL;
    graph->is_open = true;
    graph->output_name = "output";
    for (int i = 0; i < input_count; i++) (void)jet_graph_record_node(graph, (struct jet_node){.op = OP_INPUT});
    graph->input_count = input_count;
    if (graph->is_out_of_memory) {
        jet_graph_free(graph);
        return NULL;
    }
    return graph;
}

void jet_graph_free(jet_graph *graph)
{
    if (!graph) return;
    for (int i = 0; i < graph->count; i++) free(jet_graph_node_at(graph, i)->terms);
    for (int i = 0; i < graph->capacity / CHUNK; i++) free(graph->nodes[i]);
    free(graph->nodes);
    free(graph->table);
    free(graph);
}

jet jet_graph_record_constant(jet_graph *graph, double value)
{
    return jet_graph_record_node(graph, (struct jet_node){.op = OP_CONST, .number = value});
}

/* Finds the node of the parameter with this index. Returns NULL if there is none. */
static const struct jet_node *find_parameter_node(const jet_graph *graph, int parameter_index)
{
    for (int i = 0; i < graph->count; i++) {
        const struct jet_node *node = jet_graph_node_at(graph, i);
        if (node->op == OP_PARAMETER && node->parameter_index == parameter_index) return node;
    }
    return NULL;
}

jet jet_graph_record_parameter(jet_graph *graph, int parameter_index, double value)
{
    const struct jet_node *same = find_parameter_node(graph, parameter_index);
    if (same && double_bits(same->number) != double_bits(value)) return jet_make_poison(JET_TWO_VALUES);
    if (parameter_index >= graph->parameter_count) graph->parameter_count = parameter_index + 1;
    return jet_graph_record_node(
        graph, (struct jet_node){.op = OP_PARAMETER, .parameter_index = parameter_index, .number = value});
}

int jet_graph_parameter_count(const jet_graph *graph) { return graph->parameter_count; }

tvi_status jet_graph_check_outputs(jet_graph *graph, int output_count, jet output[])
{
    for (int i = 0; i < output_count; i++) {
        const bool is_number = !output[i].node && isfinite(output[i].number);
        if (is_number) output[i] = jet_graph_record_constant(graph, output[i].number);
        if (graph->is_out_of_memory) return jet_explain_out_of_memory(TVI_ENOMEM);
        if (!output[i].node || output[i].node->graph != graph)
            return jet_explain_refused_output(graph->output_name, output_count, i, output[i]);
    }
    return TVI_OK;
}
