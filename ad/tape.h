/* tape.h - Declares a recorded function as straight-line code, and the sweeps that run it.
 *
 * A tape works on blocks of numbers that its caller owns. In a block each quantity has a slot, each slot `lanes`
 * independent numbers (the nodes of a quadrature, the directions of a derivative), and the block is repeated for each
 * order of a series:
 *     x[(k * slots + slot) * lanes + lane].
 * Slots 0..inputs-1 are the inputs, which the caller sets; then come constants and computed quantities. Equal
 * operations that do not depend on each other have adjacent slots and run as one loop (a run). */
#ifndef TVI_AD_TAPE_H
#define TVI_AD_TAPE_H

#include "graph.h"

#include <stdint.h>

typedef enum {
    JET_TAPE_VALUES, /* order 0 only: what serves recurrences alone is left out */
    JET_TAPE_SERIES
} jet_tape_kind;

/* A run: operations z + i = op(a + i, b + i), i < count, of adjacent slots, with the partners w + i. LINEAR: the number
 * of z + i is base[first + i], and each operation has its own terms term_coefficient[k] term_slot[k], k = term + i *
 * terms, ... PRODUCTS, SQUARES: the operations share terms, term_coefficient[k] (term_slot[k] + i) (term_operand_b[k] +
 * i), k = term, ... If operands are scattered, which only values have, each operation has its own terms, with
 * term_operand_b[k]. */
typedef struct {
    jet_op op;
    int count, z, a, b, w;
    double c;         /* the number of the node */
    bool has_numbers; /* LINEAR: some constant term is not 0 */
    int first, terms, term;
    bool is_scattered;
    int together; /* how many runs from here on are computed together; otherwise 1 */
    /* Bits of operands whose adjoints are not set before (emit_adjoints.h); otherwise 0. */
    int fresh;
} jet_run;

/* A constant that may be replaced: parameter number `which`. */
typedef struct {
    int which, slot;
} jet_tape_parameter;

/* The most terms of PRODUCTS and SQUARES. A larger sum adds products that stand alone. */
enum { JET_TERMS_MAX = 4 };

/* The instruction sets that the sweeps are compiled for (JET_ISA). */
typedef enum { jet_isa_base, jet_isa_avx2, jet_isa_avx512, JET_ISA_COUNT } jet_isa;

typedef struct jet_sweeps jet_sweeps;

typedef struct {
    /* The sweeps that run the tape: those of the instruction set, or generated code (emit.h). */
    const jet_sweeps *sweeps;
    const jet_sweeps *interpreted; /* those of the instruction set */
    int inputs, constants, parameters, slots, runs, rows, terms, outputs;
    jet_run *run;
    double *constant;                /* [constants] of slots inputs .. inputs + constants - 1 */
    jet_tape_parameter *parameter;   /* [parameters] constants that may be replaced */
    double *base;                    /* [rows] */
    int *term_slot, *term_operand_b; /* [terms] */
    double *term_coefficient;
    int *output;      /* [outputs] slots */
    int *recorded;    /* [slots] 1, 2, ... in the order of recording; copies 0, inputs less */
    const char *part; /* name of the last operations (jet_graph_name_part), or NULL */
    int part_of;      /* the number in `recorded` of the first of these */
} jet_tape;

/* Creates a tape. The outputs are accepted by the graph. The first `inputs` inputs of the graph have slots 0..inputs-1;
 * later ones follow only if an output depends on them. NULL without memory. */
jet_tape *jet_tape_create(const jet_graph *graph, int inputs, int outputs, const jet output[], jet_tape_kind kind);
void jet_tape_free(jet_tape *tape);

/* Tells whether a slot is 0 for all inputs and parameters. */
bool jet_tape_is_zero(const jet_tape *tape, int slot);

/* The FNV-1a hash of these bytes, after what was hashed before. Each step is a bijection of the hash, so that a single
 * changed byte always shows. */
static const uint64_t JET_HASH_OF_NOTHING = UINT64_C(0xcbf29ce484222325);
uint64_t jet_hash(uint64_t so_far, const void *data, size_t bytes);

/* A hash of all that the sweeps read: tapes with equal hashes compute the same from the same inputs, bit for bit on one
 * instruction set. It distinguishes a missing tape, NULL, from any other. */
uint64_t jet_tape_hash(uint64_t so_far, const jet_tape *tape);

/* Sets the constants of a block, once, before the first sweep. Inputs are 0. A slot that a sweep computes is NaN until
 * the sweep has done so, so that no number can be read before it was computed. */
void jet_tape_prepare(const jet_tape *tape, double *x, int orders, int lanes);

/* Sets parameter i in a prepared block to value[i][width], i < count. The values repeat after `width` lanes. Other
 * parameters stay as they are. */
void jet_tape_set_parameters(const jet_tape *tape, double *x, int lanes, int count, int width, const double value[]);

/* Reads value[i] of the parameters in a lane of the block. Other values stay as they are. */
void jet_tape_read_parameters(const jet_tape *tape, const double *x, int lanes, int lane, double value[]);

/* The sweeps, compiled for one instruction set. */
struct jet_sweeps {
    jet_isa isa;
    bool (*values)(const jet_tape *tape, double *x, int lanes);
    bool (*series)(const jet_tape *tape, double *x, int k, int lanes);
    void (*tangents)(const jet_tape *tape, const double *x, double *dx, int k, int lanes);
    void (*tangents_in_lanes)(const jet_tape *tape, const double *x, double *dx, int k, int lanes);
    void (*adjoints)(const jet_tape *tape, const double *x, double *bar, int k, int top);
    /* Computes out[w] = sum_{j < count} c_j table[j][w], c_j = c[j * stride], w < width; the last, smallest terms
     * first. */
    void (*combine)(int count, const double *c, size_t stride, int width, const double *table, double *out);
};

#include "interpreter.h"

#endif
