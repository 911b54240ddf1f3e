/* lowering.h - Gives the nodes of a graph their slots on a tape. tape.c calls it. */
#ifndef TVI_AD_LOWERING_H
#define TVI_AD_LOWERING_H

#include "rule.h"
#include "tape.h"

/* The placement of a node on the tape. */
typedef struct {
    const struct jet_node *node; /* NULL: a copy of the first operand */
    jet_op op;                   /* of its run */
    int level;                   /* inputs and constants 0; otherwise one more than the highest operand */
    int rank;                    /* see rank_operations */
    int output;                  /* 1 and up in the order of the outputs; 0: none */
    int slot;
    /* The operands of the node and of its neighbours are not adjacent, and are not copied. */
    bool is_scattered;
    int pairs;         /* LINEAR, inputs and constants 0; PRODUCTS and SQUARES the number of terms; otherwise 1 */
    int (*operand)[2]; /* [pairs] slots of the operands that are read at the order being computed */
} placement;

typedef struct {
    const jet_graph *graph;
    jet_tape_kind kind;
    int count;             /* nodes in the graph */
    bool *needed;          /* [count] */
    int *uses;             /* [count] scratch, zeros */
    placement *placements; /* [count] by node index, then the copies */
    placement **levels;    /* [needed_count] the needed nodes by level */
    placement **sorted;    /* [slots] nodes and copies in the order of their slots */
    int (*operands)[2];
    int needed_count, copies, slots, pairs;
} lowering;

/* Finds the nodes that the outputs need, their operations, and their slots. */
void jet_assign_slots(lowering *low, int inputs, int outputs, const jet output[]);

/* Tells whether the recurrence of z is run, which needs its partner. */
static inline bool keeps_partner(const lowering *low, const struct jet_node *z)
{
    return z->w && low->kind == JET_TAPE_SERIES;
}

/* Tells whether the order being computed of z reads the same order of the partner. */
static inline bool reads_partner(const lowering *low, const struct jet_node *z)
{
    return keeps_partner(low, z) && jet_rules[z->op]->partner == W_SAME;
}

static inline bool is_sum_of_products(jet_op op) { return op == OP_PRODUCTS || op == OP_SQUARES; }

/* Term number `term` of a sum of products; a product itself has one term. */
static inline jet_term term_of(const placement *z, int term)
{
    return z->node->op == OP_LINEAR ? z->node->terms[term] : (jet_term){1, (struct jet_node *)z->node};
}

static inline int slot_of(const lowering *low, const struct jet_node *node)
{
    return node ? low->placements[node->index].slot : 0;
}

#endif
