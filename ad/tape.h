/* tape.h - the recorded function as straight-line code, and the sweeps that run it.
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

/* Operations z + i = op(a + i, b + i), i < count, of adjacent slots, with the partners w + i. LINEAR: the number of z +
 * i is base[first + i], ..., and each has terms of its own, term_coefficient[k] term_slot[k], k = term + i * terms, ...
 * PRODUCTS, SQUARES: one set of terms, term_coefficient[k] (term_slot[k] + i) (term_second[k] + i), k = term, ...; or,
 * of values only, where operands are scattered, terms of their own as of LINEAR, with term_second[k]. */
typedef struct {
    jet_op op;
    int count, z, a, b, w;
    double c;         /* the number of the node */
    bool has_numbers; /* LINEAR: not all numbers are 0 */
    int first, terms, term;
    bool is_scattered;
    int together; /* the values of so many runs from here on share what they begin with; else 1 */
    int fresh;    /* bits of operands whose adjoints have nothing in them before (emit_adjoints.h); else 0 */
} jet_run;

/* A constant that may be replaced: number `which` of the values. */
typedef struct {
    int which, slot;
} jet_tape_parameter;

/* Of PRODUCTS and SQUARES; what has more is a sum of products that stand alone. */
enum { JET_TERMS_MAX = 4 };

/* The instruction sets that the sweeps are compiled for (JET_ISA). */
typedef enum { jet_isa_base, jet_isa_avx2, jet_isa_avx512, JET_ISA_COUNT } jet_isa;

typedef struct jet_sweeps jet_sweeps;

typedef struct {
    const jet_sweeps *sweeps;      /* what runs it: those of the instruction set, or generated code (emit.h), */
    const jet_sweeps *interpreted; /* and those of the instruction set */
    int inputs, constants, parameters, slots, runs, rows, terms, outputs;
    jet_run *run;
    double *constant;              /* [constants], slots inputs .. inputs + constants - 1 */
    jet_tape_parameter *parameter; /* [parameters] which of the constants may be replaced */
    double *base;                  /* [rows] */
    int *term_slot, *term_second;  /* [terms] */
    double *term_coefficient;
    int *output;      /* [outputs] slots */
    int *recorded;    /* [slots] 1, 2, ... in the order of recording; copies 0, inputs less */
    const char *part; /* what the last operations belong to (jet_graph_name_part), or NULL, */
    int part_of;      /* and the number in `recorded` of the first of them */
} jet_tape;

/* The outputs are accepted by the graph. The first `inputs` inputs of the graph have slots 0..inputs-1; later ones
 * follow only where an output depends on them. NULL without memory. */
jet_tape *jet_tape_create(const jet_graph *graph, int inputs, int outputs, const jet output[], jet_tape_kind kind);
void jet_tape_free(jet_tape *tape);

/* A slot that is 0 whatever the inputs and parameters are. */
bool jet_tape_is_zero(const jet_tape *tape, int slot);

/* FNV-1a of so many bytes, after what was hashed before. Each step is a bijection of the hash, so that one changed byte
 * always shows. */
static const uint64_t JET_HASH_OF_NOTHING = UINT64_C(0xcbf29ce484222325);
uint64_t jet_hash(uint64_t so_far, const void *data, size_t bytes);

/* Of all that the sweeps read: tapes of equal hashes compute the same from the same inputs, bit for bit on one
 * instruction set. Tells a missing tape, NULL, from any other. */
uint64_t jet_tape_hash(uint64_t so_far, const jet_tape *tape);

/* Sets the constants of a block, once, before the first sweep. Inputs are 0; what a sweep computes is no number until
 * it has done so, so that nothing can be read unseen that was not evaluated. */
void jet_tape_prepare(const jet_tape *tape, double *x, int orders, int lanes);

/* Sets value[i][width], i < count, in the lanes of parameter i of a block that is prepared, every width lanes again;
 * others stay as they are. */
void jet_tape_place_parameters(const jet_tape *tape, double *x, int lanes, int count, int width, const double value[]);

/* value[i] of the parameters that stand in a lane of the block; others stay as they are. */
void jet_tape_read_parameters(const jet_tape *tape, const double *x, int lanes, int lane, double value[]);

/* The sweeps, compiled for one instruction set. */
struct jet_sweeps {
    jet_isa isa;
    bool (*values)(const jet_tape *tape, double *x, int lanes);
    bool (*series)(const jet_tape *tape, double *x, int k, int lanes);
    void (*tangents)(const jet_tape *tape, const double *x, double *dx, int k, int lanes);
    void (*tangents_in_lanes)(const jet_tape *tape, const double *x, double *dx, int k, int lanes);
    void (*adjoints)(const jet_tape *tape, const double *x, double *bar, int k, int top);
    /* out[w] = sum_{j < count} c_j table[j][w], c_j = c[j * stride], w < width; the last, smallest terms first. */
    void (*combine)(int count, const double *c, size_t stride, int width, const double *table, double *out);
};

#ifndef JET_EMITTED /* generated code has no interpreter */

/* The widest that the machine has; the environment variable TVI_ISA = base or avx2 asks for less. */
const jet_sweeps *jet_sweeps_choose(void);

/* Sets the text of the refusal (refusal.h): the first operation of a block of values that is outside its domain,
 * whose values are computed again. Returns false. */
bool jet_refuse_sweep(const jet_tape *tape, double *x, int lanes);

/* Values of all slots from the inputs, order 0. false where an operation is outside its domain. */
static inline bool jet_sweep_values(const jet_tape *tape, double *x, int lanes)
{
    return tape->sweeps->values(tape, x, lanes) || jet_refuse_sweep(tape, x, lanes);
}

/* The same at one point in long double: y [slots], from its inputs and the constants of a block. NaN where an operation
 * is outside its domain. */
void jet_sweep_precisely(const jet_tape *tape, const double *x, long double *y);

/* Coefficient k of all slots from orders 0..k of the inputs and 0..k-1 of all, k = 0, 1, 2, ... in turn: one order
 * costs O(k) an operation, so a series to degree N costs O(N^2). false at k = 0 as above. */
static inline bool jet_sweep_series(const jet_tape *tape, double *x, int k, int lanes)
{
    return tape->sweeps->series(tape, x, k, lanes) || jet_refuse_sweep(tape, x, lanes);
}

/* Tangents dx (lanes directions) of coefficient k along the one-lane series x, from dx of the inputs, k = 0, 1, 2,
 * ... */
static inline void jet_sweep_tangents(const jet_tape *tape, const double *x, double *dx, int k, int lanes)
{
    tape->sweeps->tangents(tape, x, dx, k, lanes);
}

/* The same of one direction along each lane of the series x, which has as many. */
static inline void jet_sweep_tangents_in_lanes(const jet_tape *tape, const double *x, double *dx, int k, int lanes)
{
    tape->sweeps->tangents_in_lanes(tape, x, dx, k, lanes);
}

/* Adjoints along the one-lane series x: bar, a block like x, comes to hold the derivatives of a scalar with respect to
 * the coefficients of each input, and works for the rules elsewhere. Completes those of order k, k = top, top - 1, ...,
 * 0 in turn; what the scalar itself depends on, inputs and outputs, is added by the caller beforehand. Costs about one
 * and a half series, whatever the number of inputs. */
static inline void jet_sweep_adjoints(const jet_tape *tape, const double *x, double *bar, int k, int top)
{
    tape->sweeps->adjoints(tape, x, bar, k, top);
}

#endif
#endif
