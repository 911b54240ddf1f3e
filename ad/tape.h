/* tape.h - Declares the tape, which is a recorded function as a straight-line program, and the sweeps that run it
 * (docs/jets.md, section 2).
 *
 * A tape works on blocks of numbers, which its caller owns. In a block each quantity has a slot, each slot has `lanes`
 * independent numbers (such as the nodes of a quadrature or the directions of a derivative), and the block is repeated
 * for each order of a series:
 *     x[(k * slot_count + slot) * lanes + lane].
 * The slots 0..input_count-1 are the inputs, which the caller sets. Constants and computed quantities follow. Equal
 * operations that do not depend on each other have adjacent slots and are computed in one loop; they are a run. */
#ifndef TVI_AD_TAPE_H
#define TVI_AD_TAPE_H

#include "graph.h"

#include <stdint.h>

typedef enum {
    JET_TAPE_VALUES, /* Values only; no auxiliary series, such as the cosine that a sine needs. */
    JET_TAPE_SERIES
} jet_tape_kind;

/* A run: the operations z + i = op(a + i, b + i), i < operation_count, of adjacent slots z + i. Slots w + i are the
 * auxiliary series.
 * LINEAR: z + i has the constant term constant_terms[first_constant_term_index + i], and terms of its own:
 * terms.coefficient[k] times slot terms.slot[k], for `term_count` values k from first_term_index + i * term_count on.
 * PRODUCTS, SQUARES: the operations share coefficients. The terms are terms.coefficient[k] times the slots
 * terms.slot[k] + i and terms.slot_b[k] + i, for `term_count` values k from first_term_index on. */
typedef struct {
    jet_op op;
    int operation_count, z, a, b, w;
    double exponent;                /* POW: the exponent. Otherwise 0. */
    int has_nonzero_constant_terms; /* LINEAR: 1 if some constant term is not 0. Otherwise 0. */
    int first_constant_term_index, term_count, first_term_index;
} jet_run_of_operations;

/* Tells whether the operation is a sum of products. On a tape every product and square is such a sum, of one term or
 * more. */
static inline bool jet_is_sum_of_products(jet_op op) { return op == OP_PRODUCTS || op == OP_SQUARES; }

/* A parameter of the recorded function: a number whose value the caller may change before a sweep
 * (jet_tape_set_parameters). The tape keeps it in a slot. */
typedef struct {
    int parameter_index, slot;
} jet_tape_parameter;

/* The greatest number of terms of PRODUCTS and SQUARES. The products of a longer sum are operations of their own. */
enum { JET_TERMS_MAX = 4 };

/* The instruction sets for which the sweeps are compiled (JET_ISA). */
typedef enum { jet_isa_base, jet_isa_avx2, jet_isa_avx512, JET_ISA_COUNT } jet_isa;

typedef struct jet_sweeps jet_sweeps;

/* A recorded function as a straight-line program. The counts are the lengths of the arrays below. */
typedef struct {
    /* The sweeps that run the tape. jet_tape_create sets those of the interpreter (sweep.c). A copy of the tape in a
     * compiled system has those that jet_merge_sweeps has set (compiled/attach.c, emit.h). */
    const jet_sweeps *sweeps;
    const jet_sweeps *interpreter_sweeps; /* The sweeps of the interpreter. */
    int input_count, constant_count, parameter_count, slot_count, run_count, linear_operation_count, output_count;
    int used_node_count; /* The number of nodes of the graph on which the outputs depend, inputs included. */
    jet_run_of_operations *runs;
    double *constant_values;        /* [constant_count] Values of the constants, whose slots follow the inputs. */
    jet_tape_parameter *parameters; /* [parameter_count] The parameters, whose values the caller may change. */
    double *constant_terms;         /* [linear_operation_count] The constant term of each sum (LINEAR). */
    int *output_slot;               /* [output_count] The slot of each output of the tape. */
    /* The terms of the runs that are sums or sums of products. A split tape (tape_split.c) has its own. */
    struct {
        int count;
        int *slot, *slot_b;  /* [count] The slots that terms of sums, or factors a and b of products, read. */
        double *coefficient; /* [count] The coefficient of each term. */
    } terms;
    /* What a refusal (refusal.h) says of an operation. No sweep reads it; the tapes in generated code leave it 0. */
    struct {
        /* [slot_count] Number of the operation in the order of recording, from 1 on; 0 for copies, negative for
         * inputs. */
        int *number_of_slot;
        /* [slot_count] For an operation that another one needs (jet_node.owner), the operation of the user's that needs
         * it, whose number the slot then has; OP_INPUT for all others. */
        jet_op *owner_of_slot;
        /* Name of the operations that the library recorded itself (jet_graph_begin_library_nodes); NULL: there are
         * none. */
        const char *library_name;
        /* The number, as in number_of_slot, of the first operation that this library and not the user's function
         * recorded. A refusal names this operation and all later ones by library_name. */
        int first_library_number;
    } refusal;
} jet_tape;

/* Creates a tape that computes the outputs, which have passed jet_graph_check_outputs. The first `input_count` inputs
 * of the graph have the slots 0..input_count-1; other inputs follow only if an output depends on them. Returns NULL if
 * memory is lacking. */
jet_tape *jet_tape_create(const jet_graph *graph, int input_count, int output_count, const jet output[],
                          jet_tape_kind kind);
void jet_tape_free(jet_tape *tape);

/* Tells whether a slot is 0 for all inputs and parameters. */
bool jet_tape_is_slot_always_zero(const jet_tape *tape, int slot);

/* Continues an FNV-1a hash with the bytes of `data`. The hash of no data is JET_HASH_OF_NOTHING. Each step is a
 * bijection of the hash, so that a single changed byte always changes the result. */
static const uint64_t JET_HASH_OF_NOTHING = UINT64_C(0xcbf29ce484222325);
uint64_t jet_continue_hash(uint64_t hash, const void *data, size_t byte_count);

/* Continues a hash with everything that the sweeps read. Tapes with equal hashes compute the same results from the
 * same inputs, bit for bit on one instruction set. A missing tape, NULL, has a hash of its own. */
uint64_t jet_tape_continue_hash(uint64_t hash, const jet_tape *tape);

/* Prepares a block, once, before its first sweep: sets the constants, and the inputs to 0. All other slots are NaN
 * until a sweep computes them, so that a number that was read too early shows. */
void jet_tape_write_constants(const jet_tape *tape, double *block, int order_count, int lanes);

/* Allocates a block for values and prepares it; free() frees it. Returns NULL if memory is lacking. */
double *jet_tape_create_block(const jet_tape *tape, int lanes);

/* Sets parameter i in a prepared block to the row value[i][values_per_parameter], for i < parameter_count. A row with
 * fewer values than lanes is repeated over the lanes. Other parameters stay as they are. */
void jet_tape_set_parameters(const jet_tape *tape, double *block, int lanes, int parameter_count,
                             int values_per_parameter, const double value[]);

/* Reads value[i] of each parameter i of the tape from one lane of a block. Other elements of `value` stay as they
 * are. */
void jet_tape_read_parameters(const jet_tape *tape, const double *block, int lanes, int lane, double value[]);

/* The sweeps of a tape, compiled for one instruction set. An interpreted tape has the functions of sweep.c:
 * sweep_values, sweep_series and so on. A compiled one has generated functions in place of some of them
 * (jet_merge_sweeps in emit.c). The functions below, which call them, say what each computes. */
struct jet_sweeps {
    jet_isa isa;
    bool (*values)(const jet_tape *tape, double *x, int lanes);
    bool (*series)(const jet_tape *tape, double *x, int k, int lanes);
    void (*tangents)(const jet_tape *tape, const double *x, double *dx, int k, int lanes);
    void (*one_tangent_per_lane)(const jet_tape *tape, const double *x, double *dx, int k, int lanes);
    void (*adjoints)(const jet_tape *tape, const double *x, double *bar, int k, int top);
};

/* ---- Functions that run the sweeps. Generated code, which has no interpreter, has none of them. ------------------ */
#ifndef JET_EMITTED

/* Returns the sweeps for the widest instruction set that the processor has. The environment variable TVI_ISA = base
 * or avx2 chooses a narrower one. */
const jet_sweeps *jet_choose_sweeps_for_processor(void);

/* Computes the values of a block, for which a sweep has failed, once more. Sets the text of the refusal (refusal.h): it
 * names the first operation that is outside its domain. Returns false. */
bool jet_explain_failed_sweep(const jet_tape *tape, double *block, int lanes);

/* Computes the values of all slots, which are their coefficients of order 0, from those of the inputs. Returns false
 * if an operation is outside its domain. */
static inline bool jet_sweep_values(const jet_tape *tape, double *block, int lanes)
{
    return tape->sweeps->values(tape, block, lanes) || jet_explain_failed_sweep(tape, block, lanes);
}

/* Computes values[slot_count] at one point in long double from the inputs and the constants of a block. They are NaN if
 * an operation is outside its domain. */
void jet_sweep_long_double_values(const jet_tape *tape, const double *block, long double *values);

/* Computes the coefficients of one order, for all slots, from this order of the inputs and all lower orders. The
 * caller goes through the orders 0, 1, 2, ... in turn. One order k costs O(k) per operation, a series to degree N
 * thus O(N^2). Returns false if an operation is outside its domain, at order 0. */
static inline bool jet_sweep_series(const jet_tape *tape, double *series, int order, int lanes)
{
    return tape->sweeps->series(tape, series, order, lanes) || jet_explain_failed_sweep(tape, series, lanes);
}

/* Computes the tangents of one order along a series of one lane, with one direction for each lane of `tangents`,
 * from the tangents of the inputs. The caller goes through the orders 0, 1, 2, ... in turn. */
static inline void jet_sweep_tangents(const jet_tape *tape, const double *series, double *tangents, int order,
                                      int direction_count)
{
    tape->sweeps->tangents(tape, series, tangents, order, direction_count);
}

/* Computes the tangents of one order along a series of several lanes, with one direction for each of these lanes. */
static inline void jet_sweep_one_tangent_per_lane(const jet_tape *tape, const double *series, double *tangents,
                                                  int order, int lanes)
{
    tape->sweeps->one_tangent_per_lane(tape, series, tangents, order, lanes);
}

/* Computes the adjoints of one order along a series of one lane; the caller goes through the orders top_order, ...,
 * 1, 0 in turn. `adjoints` is a block of the form of the series. The caller first adds to it the derivatives of a
 * scalar by those coefficients of inputs and outputs on which it depends directly. In the end it holds, for each
 * input, the derivatives of the scalar by all coefficients; the other slots are scratch. The cost is about that of
 * one and a half series, for any number of inputs. */
static inline void jet_sweep_adjoints(const jet_tape *tape, const double *series, double *adjoints, int order,
                                      int top_order)
{
    tape->sweeps->adjoints(tape, series, adjoints, order, top_order);
}

#endif
#endif
