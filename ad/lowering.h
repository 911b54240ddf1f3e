/* lowering.h - Declares the first step of the translation of a graph, which records a function, to a tape, which
 * computes it (docs/jets.md, section 2): it gives each node a slot, its place in the numbers on which the tape works.
 * tape.c calls it. */
#ifndef TVI_AD_LOWERING_H
#define TVI_AD_LOWERING_H

#include "rule.h"
#include "tape.h"

/* The position of a node, or of a copy of one, on the tape. */
typedef struct {
    const struct jet_node *node; /* The node; NULL: a copy of the slot operand[0][0]. */
    jet_op op;                   /* The operation that computes the node on the tape. */
    int level; /* 0 for inputs and constants, otherwise one more than the highest level of an operand. */
    /* The class of operations that have to get adjacent slots (assign_adjacency_classes). A class is a part of a group,
     * which are the operations of a level that can be one run. */
    int adjacency_class;
    int one_based_output_index; /* 1, 2, ... in the order of the outputs; 0: the node is no output. */
    int slot;
    /* Number of operand pairs: the number of terms of PRODUCTS and SQUARES, 0 for LINEAR, inputs and constants,
     * otherwise 1. */
    int operand_pair_count;
    /* [operand_pair_count] Slots of the operands, without auxiliary series of which only lower orders are read. */
    int (*operand)[2];
} tape_placement;

/* The state of the lowering of one graph. */
typedef struct {
    const jet_graph *graph;
    jet_tape_kind tape_kind;
    int node_count;                  /* Number of nodes in the graph. */
    bool *is_node_needed;            /* [node_count] Tells whether an output depends on the node. */
    int *use_counts;                 /* [node_count] How many operations read the node; later scratch. */
    tape_placement *placements;      /* Placements of all nodes by their index, followed by those of the copies. */
    tape_placement **nodes_by_level; /* [needed_node_count] The needed nodes, sorted by level. */
    tape_placement **nodes_by_slot;  /* [slot_count] Nodes and copies, sorted by slot. */
    int (*operands)[2];              /* Memory for tape_placement.operand of all placements. */
    /* The number of nodes that the outputs depend on, and of those that are still needed after products have become
     * terms of sums; copies are counted apart. */
    int used_node_count, needed_node_count, copy_count, slot_count, operand_pair_count;
} graph_lowering;

/* Chooses the nodes that the outputs depend on, the operations that compute them, and their slots. The first
 * `input_count` inputs of the graph get slots even if no output depends on them. */
void jet_assign_slots(graph_lowering *lowering, int input_count, int output_count, const jet output[]);

/* Tells whether the tape needs the auxiliary series of z, as all tapes of series do. */
static inline bool must_compute_auxiliary_series(const graph_lowering *lowering, const struct jet_node *z)
{
    return z->w && lowering->tape_kind == JET_TAPE_SERIES;
}

/* Tells whether the coefficient of order k of the node z is computed from the coefficient of the same order of w, the
 * auxiliary series of z itself (W_SAME in rule.h). */
static inline bool node_reads_own_w_at_same_order(const graph_lowering *lowering, const struct jet_node *z)
{
    return must_compute_auxiliary_series(lowering, z) && jet_rules[z->op]->auxiliary_series_orders_read == W_SAME;
}

/* Returns the term number `term`, from 0 on, of a sum of products. A product that stands alone is a sum of one term. */
static inline jet_term sum_term(const tape_placement *z, int term)
{
    return z->node->op == OP_LINEAR ? z->node->terms[term] : (jet_term){1, (struct jet_node *)z->node};
}

static inline int node_slot(const graph_lowering *lowering, const struct jet_node *node)
{
    return node ? lowering->placements[node->index].slot : 0;
}

#endif
