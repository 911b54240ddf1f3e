/* tape.c - graph -> tape: drops what no output needs, orders the rest by levels, lays equal operations side by side. */
#include "tape.h"
#include "rule.h"

#include <stdlib.h>
#include <string.h>

/* What the lowering knows of a node. */
typedef struct {
    const struct jet_node *node;
    const struct jet_node *does; /* the operation: of the node itself, or the product that it is a multiple of */
    double c;                    /* the number of the operation; the multiple */
    int level; /* inputs and constants 0; else one more than the highest operand */
    int turn;  /* see find_turns */
    int slot;
    int a, b; /* slots of the operands that are read at the order being computed */
} place;      /* node and does NULL: a copy of slot a */

typedef struct {
    const jet_graph *graph;
    jet_tape_kind kind;
    int count;      /* of nodes in the graph */
    bool *needed;   /* [count] */
    int *uses;      /* [count] scratch, zeros */
    place *places;  /* [count] by node index, then the copies */
    place **levels; /* [needed_count] the needed nodes by level */
    place **sorted; /* [slots] nodes and copies in the order of their slots */
    int needed_count, copies, slots;
} lowering;

/* Whether the order being computed of z reads the same order of z->b. */
static bool reads_b(const lowering *low, const struct jet_node *z)
{
    const jet_b_role role = jet_role_of_b(z->op);
    return role == B_OPERAND || (role == B_PARTNER_SERIES && low->kind == JET_TAPE_SERIES);
}

static bool keeps_b(const lowering *low, const struct jet_node *z)
{
    return jet_role_of_b(z->op) == B_OPERAND || (z->b && low->kind == JET_TAPE_SERIES);
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

static void count_uses(const lowering *low, int outputs, const jet output[], int uses[])
{
    for (int i = 0; i < outputs; i++) uses[output[i].node->index]++;
    for (int i = 0; i < low->count; i++) {
        if (!low->needed[i]) continue;
        const struct jet_node *z = jet_graph_node(low->graph, i);
        if (z->a) uses[z->a->index]++;
        if (keeps_b(low, z)) uses[z->b->index]++;
        for (int term = 0; term < z->count; term++) uses[z->terms[term].node->index]++;
    }
}

/* A multiple of a product that nothing else needs is one operation. */
static void fold_multiples(lowering *low, int outputs, const jet output[])
{
    count_uses(low, outputs, output, low->uses);
    for (int i = 0; i < low->count; i++) {
        const struct jet_node *z = jet_graph_node(low->graph, i);
        if (!low->needed[i] || z->count != 1 || z->number != 0) continue;
        const struct jet_node *product = z->terms[0].node;
        if (product->op != OP_MUL || low->uses[product->index] != 1) continue;
        low->places[i].does = product;
        low->needed[product->index] = false;
    }
    memset(low->uses, 0, (size_t)low->count * sizeof *low->uses);
}

static void find_levels(lowering *low)
{
    for (int i = 0; i < low->count; i++) {
        if (!low->needed[i]) continue;
        place *at = &low->places[i];
        const struct jet_node *z = at->does ? at->does : jet_graph_node(low->graph, i);
        int level = 0;
        if (z->a) level = max(level, low->places[z->a->index].level + 1);
        if (reads_b(low, z)) level = max(level, low->places[z->b->index].level + 1);
        for (int term = 0; term < z->count; term++)
            level = max(level, low->places[z->terms[term].node->index].level + 1);
        at->node = jet_graph_node(low->graph, i);
        at->c = at->does ? at->node->terms[0].coefficient : z->number;
        at->does = z;
        at->level = level;
        at->turn = at->slot = -1;
        low->levels[low->needed_count++] = at;
    }
}

static int by_level(const void *first, const void *second)
{
    const place *x = *(place *const *)first, *y = *(place *const *)second;
    return x->level != y->level ? x->level - y->level : x->node->index - y->node->index;
}

/* Of operations on two operands: how often one of these was read before at the level; else that of the first reader. As
 * where x, y and z of the distances of many pairs are each multiplied by one function of the pair: the x come first, then
 * the y, and each turn reads adjacent slots. */
static void find_turns(lowering *low, place *level[], int count)
{
    int *const uses = low->uses;
    for (int i = 0; i < count; i++) {
        const struct jet_node *z = level[i]->does;
        if (!reads_b(low, z)) continue;
        const int operand[] = {z->a->index, z->b->index};
        level[i]->turn = max(uses[operand[0]]++, uses[operand[1]]++);
        for (int k = 0; k < 2; k++)
            if (low->places[operand[k]].turn < 0) low->places[operand[k]].turn = level[i]->turn;
    }
    for (int i = 0; i < count; i++)
        if (reads_b(low, level[i]->does)) uses[level[i]->does->a->index] = uses[level[i]->does->b->index] = 0;
}

static int compare(double a, double b) { return (a > b) - (a < b); }

static bool is_summed(const place *z) { return !jet_rules[z->does->op]; }

/* Sums of equally many terms stand together. */
static int compare_sums(const place *x, const place *y) { return x->does->count - y->does->count; }

/* Whether two nodes of a level can be members of one run. */
static int by_group(const place *x, const place *y)
{
    if (x->does->op != y->does->op) return (int)x->does->op - (int)y->does->op;
    return is_summed(x) ? compare_sums(x, y) : compare(x->c, y->c);
}

/* Within a level by group, and within that by the slots of the operands, so that adjacent results have adjacent
 * operands: by a first, or by b first. */
static int by_first_operand(const void *first, const void *second)
{
    const place *x = *(place *const *)first, *y = *(place *const *)second;
    const int group = by_group(x, y);
    if (group) return group;
    if (x->level > 0 && x->turn != y->turn) return x->turn - y->turn;
    if (!is_summed(x) && x->a != y->a) return x->a - y->a;
    if (!is_summed(x) && x->b != y->b) return x->b - y->b;
    return x->node->index - y->node->index;
}

static int by_second_operand(const void *first, const void *second)
{
    const place *x = *(place *const *)first, *y = *(place *const *)second;
    return x->b != y->b ? x->b - y->b : by_first_operand(first, second);
}

static int slot_of(const lowering *low, const struct jet_node *node)
{
    return node ? low->places[node->index].slot : 0;
}

static void emit(lowering *low, place *z)
{
    z->slot = low->slots;
    low->sorted[low->slots++] = z;
}

static bool is_contiguous(place *const group[], int count, bool second)
{
    for (int i = 1; i < count; i++)
        if ((second ? group[i]->b : group[i]->a) != (second ? group[0]->b : group[0]->a) + i) return false;
    return true;
}

/* Copies an operand that the members read at scattered slots to adjacent ones, so that they run as one. */
static void gather(lowering *low, place *group[], int count, bool second)
{
    if (is_contiguous(group, count, second)) return;
    for (int i = 0; i < count; i++) {
        int *operand = second ? &group[i]->b : &group[i]->a;
        place *copy = &low->places[low->count + low->copies++];
        *copy = (place){.level = group[i]->level, .a = *operand};
        emit(low, copy);
        *operand = copy->slot;
    }
}

static bool is_contiguous_in_turns(place *const group[], int count)
{
    for (int begin = 0, end = 0; begin < count; begin = end) {
        while (end < count && group[end]->turn == group[begin]->turn) end++;
        if (!is_contiguous(group + begin, end - begin, false) || !is_contiguous(group + begin, end - begin, true))
            return false;
    }
    return true;
}

/* The operands of a group: turn by turn where that will do, else sorted by the one that is then contiguous, the other
 * gathered. */
static void gather_operands(lowering *low, place *group[], int count)
{
    if (!reads_b(low, group[0]->does)) {
        gather(low, group, count, false);
        return;
    }
    if (is_contiguous_in_turns(group, count)) return;
    if (!is_contiguous(group, count, false) && !is_contiguous(group, count, true))
        qsort(group, (size_t)count, sizeof *group, by_second_operand);
    gather(low, group, count, false);
    gather(low, group, count, true);
}

static int group_end(place *const level[], int begin, int end)
{
    int last = begin + 1;
    while (last < end && by_group(level[begin], level[last]) == 0) last++;
    return last;
}

/* Slots of a level: sums and copies first, then the other operations group by group. */
static void emit_level(lowering *low, place *level[], int count)
{
    for (int i = 0; i < count; i++) {
        level[i]->a = slot_of(low, level[i]->does->a);
        level[i]->b = reads_b(low, level[i]->does) ? slot_of(low, level[i]->does->b) : 0;
    }
    qsort(level, (size_t)count, sizeof *level, by_first_operand);
    for (int i = 0; i < count; i++)
        if (is_summed(level[i])) emit(low, level[i]);
    for (int begin = 0, end = 0; begin < count; begin = end) {
        end = group_end(level, begin, count);
        if (!is_summed(level[begin])) gather_operands(low, level + begin, end - begin);
    }
    for (int i = 0; i < count; i++)
        if (!is_summed(level[i])) emit(low, level[i]);
}

static void for_levels(lowering *low, void (*function)(lowering *low, place *level[], int count))
{
    for (int begin = 0, end = 0; begin < low->needed_count; begin = end) {
        while (end < low->needed_count && low->levels[end]->level == low->levels[begin]->level) end++;
        function(low, low->levels + begin, end - begin);
    }
}

/* Level by level, since the order within one depends on the slots of those below. */
static void assign_slots(lowering *low)
{
    qsort(low->levels, (size_t)low->needed_count, sizeof *low->levels, by_level);
    for_levels(low, find_turns);
    for_levels(low, emit_level);
}

/* A copy is a sum of one term. */
static int terms_of(const place *z) { return z->does ? z->does->count : 1; }

/* The run of z alone. */
static jet_run run_of(const lowering *low, const jet_tape *tape, const place *z)
{
    if (!z->does || z->does->op == OP_LINEAR)
        return (jet_run){OP_LINEAR, 1, z->slot, .first = tape->rows, .terms = terms_of(z), .term = tape->terms};
    const bool partner = keeps_b(low, z->does) && !reads_b(low, z->does);
    const int b = partner ? slot_of(low, z->does->b) : z->b;
    return (jet_run){z->does->op, 1, z->slot, z->a, b, .c = z->c};
}

/* Whether the run can grow by the next one. */
static bool joins(const lowering *low, const jet_run *run, const jet_run *next)
{
    if (next->op != run->op || low->sorted[next->z]->level != low->sorted[run->z]->level) return false;
    if (run->op == OP_LINEAR) return next->terms == run->terms;
    const bool same_b = run->b == 0 && next->b == 0 && jet_role_of_b(run->op) != B_OPERAND;
    return next->c == run->c && next->a == run->a + run->count && (same_b || next->b == run->b + run->count);
}

static void add_row(const lowering *low, jet_tape *tape, const place *z)
{
    const struct jet_node *node = z->node;
    if (!node) { /* a copy */
        tape->term_slot[tape->terms] = z->a;
        tape->term_coefficient[tape->terms++] = 1;
    }
    for (int term = 0; node && term < node->count; term++, tape->terms++) {
        tape->term_slot[tape->terms] = slot_of(low, node->terms[term].node);
        tape->term_coefficient[tape->terms] = node->terms[term].coefficient;
    }
    tape->base[tape->rows++] = node ? node->number : 0;
}

static void lay_out(lowering *low, jet_tape *tape)
{
    for (int i = 0; i < low->slots; i++) {
        const place *z = low->sorted[i];
        if (z->node && z->node->op == OP_INPUT) {
            tape->inputs++;
            continue;
        }
        if (z->node && z->node->op == OP_CONST) {
            tape->constant[tape->constants++] = z->node->number;
            continue;
        }
        const jet_run next = run_of(low, tape, z);
        if (tape->runs > 0 && joins(low, &tape->run[tape->runs - 1], &next)) tape->run[tape->runs - 1].count++;
        else tape->run[tape->runs++] = next;
        if (next.op != OP_LINEAR) continue;
        add_row(low, tape, z);
        if (tape->base[tape->rows - 1] != 0) tape->run[tape->runs - 1].has_numbers = true;
    }
}

static bool allocate(lowering *low, jet_tape *tape, int outputs)
{
    int terms = 0;
    for (int i = 0; i < low->count; i++) terms += jet_graph_node(low->graph, i)->count;
    const size_t nodes = 3 * (size_t)low->count + 1; /* each may have copies of two operands */
    terms += 2 * low->count;
    low->needed = calloc(nodes, sizeof *low->needed);
    low->uses = calloc(nodes, sizeof *low->uses);
    low->places = calloc(nodes, sizeof *low->places);
    low->levels = calloc(nodes, sizeof(place *));
    low->sorted = calloc(nodes, sizeof(place *));
    tape->run = calloc(nodes, sizeof *tape->run);
    tape->constant = calloc(nodes, sizeof *tape->constant);
    tape->base = calloc(nodes, sizeof *tape->base);
    tape->term_slot = calloc((size_t)terms + 1, sizeof *tape->term_slot);
    tape->term_coefficient = calloc((size_t)terms + 1, sizeof *tape->term_coefficient);
    tape->output = calloc((size_t)outputs + 1, sizeof *tape->output);
    return low->needed && low->uses && low->places && low->levels && low->sorted && tape->run && tape->constant && tape->base &&
           tape->term_slot && tape->term_coefficient && tape->output;
}

jet_tape *jet_tape_create(const jet_graph *graph, int inputs, int outputs, const jet output[], jet_tape_kind kind)
{
    jet_tape *tape = calloc(1, sizeof *tape);
    if (!tape) return NULL;
    tape->sweeps = jet_sweeps_choose();
    lowering low = {.graph = graph, .kind = kind, .count = jet_graph_count(graph)};
    const bool allocated = allocate(&low, tape, outputs);
    if (allocated) {
        mark_needed(&low, inputs, outputs, output);
        fold_multiples(&low, outputs, output);
        find_levels(&low);
        assign_slots(&low);
        lay_out(&low, tape);
        tape->slots = low.slots;
        tape->outputs = outputs;
        for (int i = 0; i < outputs; i++) tape->output[i] = slot_of(&low, output[i].node);
    }
    free(low.needed);
    free(low.uses);
    free(low.places);
    free(low.levels);
    free(low.sorted);
    if (allocated) return tape;
    jet_tape_free(tape);
    return NULL;
}

void jet_tape_prepare(const jet_tape *tape, double *x, int orders, int lanes)
{
    memset(x, 0, (size_t)orders * (size_t)tape->slots * (size_t)lanes * sizeof *x);
    for (int i = 0; i < tape->constants; i++)
        for (int lane = 0; lane < lanes; lane++) x[(tape->inputs + i) * lanes + lane] = tape->constant[i];
}

void jet_tape_free(jet_tape *tape)
{
    if (!tape) return;
    free(tape->run);
    free(tape->constant);
    free(tape->base);
    free(tape->term_slot);
    free(tape->term_coefficient);
    free(tape->output);
    free(tape);
}
