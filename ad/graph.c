/* graph.c - Keeps the graph of one recording: its nodes, a hash table that finds equal nodes, and jets without a
 * node. */
#include "graph.h"
#include "refusal.h"
#include "rule.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 128 };

struct jet_graph {
    bool open;
    const char *name;      /* of its outputs */
    const char *part_name; /* name of the operations from part_index on, or NULL */
    int part_index;
    bool out_of_memory; /* an operation was lost: no output is accepted any more */
    int inputs, parameters, count, capacity;
    /* Chunks of CHUNK nodes, so that handles stay valid as the graph grows. */
    struct jet_node **nodes;
    int slots; /* of the hash table, a power of two > 2 count */
    struct jet_node **table;
    /* How often the search for a node in the table met another one. */
    long collisions;
};

/* ---- Poison: an operation that could not be recorded, and the reason --------------------------------------------- */

#define POISON(reason, status, text) [reason] = {.op = OP_CONST, .index = status, .count = reason},
#define OUTSIDE(code, name)          POISON(JET_OUTSIDE + code, TVI_EDOMAIN, )
static const struct jet_node poison_nodes[] = {JET_REASON_LIST(POISON) JET_RULE_LIST(OUTSIDE)};

jet jet_poison(jet_reason reason) { return jet_of_node((struct jet_node *)&poison_nodes[reason]); }

jet jet_poison_at(jet_op op, double operand)
{
    return (jet){operand, (struct jet_node *)&poison_nodes[JET_OUTSIDE + (int)op]};
}

bool jet_is_poison(jet x) { return x.node && !x.node->graph; }

jet jet_graph_of(int count, const jet x[], jet_graph **graph)
{
    *graph = NULL;
    for (int i = 0; i < count; i++) {
        if (jet_is_poison(x[i])) return x[i];
        if (!x[i].node) {
            if (!isfinite(x[i].number)) return jet_poison(JET_NOT_FINITE);
            continue;
        }
        if (*graph && x[i].node->graph != *graph) return jet_poison(JET_FOREIGN);
        *graph = x[i].node->graph;
        if (!(*graph)->open) return jet_poison(JET_FOREIGN);
    }
    return jet_const(0);
}

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
void jet_graph_name(jet_graph *graph, const char *name) { graph->name = name; }
void jet_graph_name_part(jet_graph *graph, const char *part)
{
    graph->part_index = graph->count;
    graph->part_name = part;
}

const char *jet_graph_part_name(const jet_graph *graph, int *index)
{
    *index = graph->part_index;
    return graph->part_name;
}

void jet_graph_lose(jet_graph *graph) { graph->out_of_memory = true; }

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

/* The hash of what the node is computed from. Its partner follows from that. */
static uint64_t node_hash(const struct jet_node *node)
{
    uint64_t hash = mix((uint64_t)node->op, bits(node->number));
    if (node->op == OP_INPUT) hash = mix(hash, (uint64_t)node->index);
    if (node->op == OP_PARAMETER) hash = mix(hash, (uint64_t)node->which);
    if (node->a) hash = mix(hash, (uint64_t)node->a->index);
    if (node->b) hash = mix(hash, (uint64_t)node->b->index);
    for (int i = 0; i < node->count; i++)
        hash = mix(mix(hash, bits(node->terms[i].coefficient)), (uint64_t)node->terms[i].node->index);
    return hash;
}

static bool same_node(const struct jet_node *x, const struct jet_node *y)
{
    if (x->op != y->op || bits(x->number) != bits(y->number) || x->count != y->count) return false;
    if (x->op == OP_INPUT) return x->index == y->index;
    if (x->op == OP_PARAMETER) return x->which == y->which;
    if (x->a != y->a || x->b != y->b) return false;
    for (int i = 0; i < x->count; i++)
        if (x->terms[i].node != y->terms[i].node || bits(x->terms[i].coefficient) != bits(y->terms[i].coefficient))
            return false;
    return true;
}

/* The node's place in the table, or the empty place where it belongs. */
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

struct jet_node *jet_graph_record(jet_graph *graph, struct jet_node wanted, bool *is_new)
{
    *is_new = false;
    if (!reserve(graph)) {
        free(wanted.terms);
        jet_graph_lose(graph);
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

jet jet_graph_record_jet(jet_graph *graph, struct jet_node wanted)
{
    bool is_new;
    struct jet_node *node = jet_graph_record(graph, wanted, &is_new);
    return node ? jet_of_node(node) : jet_poison(JET_NO_MEMORY);
}

jet_graph *jet_graph_create(int inputs)
{
    jet_graph *graph = calloc(1, sizeof *graph);
    if (!graph) return NULL;
    graph->open = true;
    graph->name = "output";
    for (int i = 0; i < inputs; i++) (void)jet_graph_record_jet(graph, (struct jet_node){.op = OP_INPUT});
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

jet jet_graph_constant(jet_graph *graph, double value)
{
    return jet_graph_record_jet(graph, (struct jet_node){.op = OP_CONST, .number = value});
}

/* The parameter with this index; NULL: there is none. */
static const struct jet_node *find_parameter(const jet_graph *graph, int which)
{
    for (int i = 0; i < graph->count; i++) {
        const struct jet_node *node = jet_graph_node(graph, i);
        if (node->op == OP_PARAMETER && node->which == which) return node;
    }
    return NULL;
}

jet jet_graph_parameter(jet_graph *graph, int which, double value)
{
    const struct jet_node *same = find_parameter(graph, which);
    if (same && bits(same->number) != bits(value)) return jet_poison(JET_TWO_VALUES);
    if (which >= graph->parameters) graph->parameters = which + 1;
    return jet_graph_record_jet(graph, (struct jet_node){.op = OP_PARAMETER, .which = which, .number = value});
}

int jet_graph_parameters(const jet_graph *graph) { return graph->parameters; }

tvi_status jet_graph_accept(jet_graph *graph, int outputs, jet output[])
{
    for (int i = 0; i < outputs; i++) {
        const bool is_number = !output[i].node && isfinite(output[i].number);
        if (is_number) output[i] = jet_graph_constant(graph, output[i].number);
        if (graph->out_of_memory) return jet_refuse_memory(TVI_ENOMEM);
        if (!output[i].node || output[i].node->graph != graph)
            return jet_refuse_output(graph->name, outputs, i, output[i]);
    }
    return TVI_OK;
}
