/* tape.c - graph -> tape: drops what no output needs, orders the rest by levels, lays equal operations side by side. */
#include "tape.h"
#include "rule.h"

#include <stdlib.h>

/* What the lowering knows of a node. */
typedef struct {
    struct jet_node *node;
    int level; /* inputs and constants 0; else one more than the highest operand */
    int slot;
    int a, b; /* slots of the operands that are read at the order being computed */
} place;

typedef struct {
    const jet_graph *graph;
    jet_tape_kind kind;
    int count;      /* of nodes in the graph */
    bool *needed;   /* [count] */
    place *places;  /* [count] by node index */
    place **sorted; /* the needed nodes in the order of their slots */
    int needed_count;
} lowering;

/* Whether the order being computed of z reads the same order of z->b. */
static bool reads_b(const lowering *low, const struct jet_node *z)
{
    const jet_b_role role = jet_rules[z->op].b;
    return role == B_OPERAND || (role == B_PARTNER_SERIES && low->kind == JET_TAPE_SERIES);
}

static bool keeps_b(const lowering *low, const struct jet_node *z)
{
    return jet_rules[z->op].b == B_OPERAND || (z->b && low->kind == JET_TAPE_SERIES);
}

/* Marks all that the outputs depend on; partners may have been recorded after the nodes that need them, so repeat until
 * nothing new is found. */
static void mark_needed(lowering *low, int inputs, int outputs, const jet output[])
{
    for (int i = 0; i < inputs; i++) low->needed[i] = true;
    for (int i = 0; i < outputs; i++) low->needed[output[i].node->index] = true;
    for (bool again = true; again;) {
        again = false;
        for (int i = low->count - 1; i >= 0; i--) {
            if (!low->needed[i]) continue;
            const struct jet_node *z = jet_graph_node(low->graph, i);
            if (z->a) low->needed[z->a->index] = true;
            for (int term = 0; term < z->count; term++) low->needed[z->terms[term].node->index] = true;
            if (!keeps_b(low, z) || low->needed[z->b->index]) continue;
            low->needed[z->b->index] = true;
            again = again || z->b->index > i;
        }
    }
}

static int max(int a, int b) { return a > b ? a : b; }

static void find_levels(lowering *low)
{
    for (int i = 0; i < low->count; i++) {
        if (!low->needed[i]) continue;
        struct jet_node *z = jet_graph_node(low->graph, i);
        int level = 0;
        if (z->a) level = max(level, low->places[z->a->index].level + 1);
        if (reads_b(low, z)) level = max(level, low->places[z->b->index].level + 1);
        for (int term = 0; term < z->count; term++)
            level = max(level, low->places[z->terms[term].node->index].level + 1);
        low->places[i] = (place){.node = z, .level = level, .slot = -1};
        low->sorted[low->needed_count++] = &low->places[i];
    }
}

static int by_level(const void *first, const void *second)
{
    const place *x = *(place *const *)first, *y = *(place *const *)second;
    return x->level != y->level ? x->level - y->level : x->node->index - y->node->index;
}

static int compare(double a, double b) { return (a > b) - (a < b); }

/* Within a level: by operation, number, and slots of the operands, so that adjacent results have adjacent operands. */
static int by_run(const void *first, const void *second)
{
    const place *x = *(place *const *)first, *y = *(place *const *)second;
    if (x->node->op != y->node->op) return (int)x->node->op - (int)y->node->op;
    if (x->level > 0 && x->node->op != OP_LINEAR) {
        const int number = compare(x->node->number, y->node->number);
        if (number) return number;
        if (x->a != y->a) return x->a - y->a;
        if (x->b != y->b) return x->b - y->b;
    }
    return x->node->index - y->node->index;
}

static int slot_of(const lowering *low, const struct jet_node *node)
{
    return node ? low->places[node->index].slot : 0;
}

/* Level by level, since the order within one depends on the slots of those below. */
static void assign_slots(lowering *low)
{
    qsort(low->sorted, (size_t)low->needed_count, sizeof *low->sorted, by_level);
    for (int begin = 0, end = 0; begin < low->needed_count; begin = end) {
        for (; end < low->needed_count && low->sorted[end]->level == low->sorted[begin]->level; end++) {
            place *z = low->sorted[end];
            z->a = slot_of(low, z->node->a);
            z->b = reads_b(low, z->node) ? slot_of(low, z->node->b) : 0;
        }
        qsort(low->sorted + begin, (size_t)(end - begin), sizeof *low->sorted, by_run);
        for (int i = begin; i < end; i++) low->sorted[i]->slot = i;
    }
}

/* Whether z can join the run as its next member. */
static bool continues(const lowering *low, const jet_run *run, const place *z)
{
    if (z->node->op != run->op) return false;
    if (run->op == OP_LINEAR) return low->places[z->node->index].level == low->sorted[run->z]->level;
    const bool same_number = z->node->number == run->c && z->level == low->sorted[run->z]->level;
    const int b = keeps_b(low, z->node) ? slot_of(low, z->node->b) - run->count : run->b;
    return same_number && slot_of(low, z->node->a) == run->a + run->count && b == run->b;
}

static void add_row(const lowering *low, jet_tape *tape, const struct jet_node *z)
{
    int end = tape->row[tape->rows];
    for (int term = 0; term < z->count; term++, end++) {
        tape->term_slot[end] = slot_of(low, z->terms[term].node);
        tape->term_coefficient[end] = z->terms[term].coefficient;
    }
    tape->base[tape->rows] = z->number;
    tape->row[++tape->rows] = end;
}

static void lay_out(lowering *low, jet_tape *tape)
{
    for (int i = 0; i < low->needed_count; i++) {
        const struct jet_node *z = low->sorted[i]->node;
        if (z->op == OP_INPUT) {
            tape->inputs++;
            continue;
        }
        if (z->op == OP_CONST) {
            tape->constant[tape->constants++] = z->number;
            continue;
        }
        jet_run *run = tape->runs > 0 ? &tape->run[tape->runs - 1] : NULL;
        if (run && continues(low, run, low->sorted[i])) {
            run->count++;
        } else {
            const int b = keeps_b(low, z) ? slot_of(low, z->b) : 0;
            tape->run[tape->runs++] = (jet_run){z->op, 1, i, slot_of(low, z->a), b, z->number, tape->rows};
        }
        if (z->op == OP_LINEAR) add_row(low, tape, z);
    }
}

static bool allocate(lowering *low, jet_tape *tape, int outputs)
{
    int terms = 0;
    for (int i = 0; i < low->count; i++) terms += jet_graph_node(low->graph, i)->count;
    const size_t nodes = (size_t)low->count + 1;
    low->needed = calloc(nodes, sizeof *low->needed);
    low->places = calloc(nodes, sizeof *low->places);
    low->sorted = calloc(nodes, sizeof(place *));
    tape->run = calloc(nodes, sizeof *tape->run);
    tape->constant = calloc(nodes, sizeof *tape->constant);
    tape->row = calloc(nodes + 1, sizeof *tape->row);
    tape->base = calloc(nodes, sizeof *tape->base);
    tape->term_slot = calloc((size_t)terms + 1, sizeof *tape->term_slot);
    tape->term_coefficient = calloc((size_t)terms + 1, sizeof *tape->term_coefficient);
    tape->output = calloc((size_t)outputs + 1, sizeof *tape->output);
    return low->needed && low->places && low->sorted && tape->run && tape->constant && tape->row && tape->base &&
           tape->term_slot && tape->term_coefficient && tape->output;
}

jet_tape *jet_tape_create(const jet_graph *graph, int inputs, int outputs, const jet output[], jet_tape_kind kind)
{
    jet_tape *tape = calloc(1, sizeof *tape);
    if (!tape) return NULL;
    lowering low = {.graph = graph, .kind = kind, .count = jet_graph_count(graph)};
    const bool allocated = allocate(&low, tape, outputs);
    if (allocated) {
        mark_needed(&low, inputs, outputs, output);
        find_levels(&low);
        assign_slots(&low);
        lay_out(&low, tape);
        tape->slots = low.needed_count;
        tape->outputs = outputs;
        for (int i = 0; i < outputs; i++) tape->output[i] = slot_of(&low, output[i].node);
    }
    free(low.needed);
    free(low.places);
    free(low.sorted);
    if (allocated) return tape;
    jet_tape_free(tape);
    return NULL;
}

void jet_tape_free(jet_tape *tape)
{
    if (!tape) return;
    free(tape->run);
    free(tape->constant);
    free(tape->row);
    free(tape->base);
    free(tape->term_slot);
    free(tape->term_coefficient);
    free(tape->output);
    free(tape);
}
