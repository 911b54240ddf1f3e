/* place.h - where the nodes of a graph stand on its tape. */
#ifndef TVI_AD_PLACE_H
#define TVI_AD_PLACE_H

#include "rule.h"
#include "tape.h"

/* What the lowering knows of a node. */
typedef struct {
    const struct jet_node *node; /* NULL: a copy of the first operand */
    jet_op op;                   /* of its run */
    int level;                   /* inputs and constants 0; else one more than the highest operand */
    int turn;                    /* see find_turns */
    int output;                  /* 1 and up in their order; 0: it is none */
    int slot;
    bool is_scattered; /* its operands and those of its neighbours are not adjacent, nor are they gathered */
    int pairs;         /* LINEAR, inputs and constants 0; PRODUCTS and SQUARES as many as terms; else 1 */
    int (*operand)[2]; /* [pairs] slots of the operands that are read at the order being computed */
} place;

typedef struct {
    const jet_graph *graph;
    jet_tape_kind kind;
    int count;      /* of nodes in the graph */
    bool *needed;   /* [count] */
    int *uses;      /* [count] scratch, zeros */
    place *places;  /* [count] by node index, then the copies */
    place **levels; /* [needed_count] the needed nodes by level */
    place **sorted; /* [slots] nodes and copies in the order of their slots */
    int (*operands)[2];
    int needed_count, copies, slots, pairs;
} lowering;

/* Finds what the outputs need, the operation of each such node, and the slots in their order. */
void jet_place_nodes(lowering *low, int inputs, int outputs, const jet output[]);

/* Whether the recurrence of z is run, and its partner needed. */
static inline bool keeps_partner(const lowering *low, const struct jet_node *z)
{
    return z->w && low->kind == JET_TAPE_SERIES;
}

/* Whether the order being computed of z reads the same order of the partner. */
static inline bool reads_partner(const lowering *low, const struct jet_node *z)
{
    return keeps_partner(low, z) && jet_rules[z->op]->partner == W_SAME;
}

static inline bool is_sum_of_products(jet_op op) { return op == OP_PRODUCTS || op == OP_SQUARES; }

/* The terms of sums of products: of a product itself, one. */
static inline jet_term term_of(const place *z, int term)
{
    return z->node->op == OP_LINEAR ? z->node->terms[term] : (jet_term){1, (struct jet_node *)z->node};
}

static inline int slot_of(const lowering *low, const struct jet_node *node)
{
    return node ? low->places[node->index].slot : 0;
}

#endif
