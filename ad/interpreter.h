/* interpreter.h - Declares the functions that run the sweeps of a tape. tape.h includes this file at its end. Generated
 * code, which has no interpreter, is compiled without it. */
#ifndef TVI_AD_INTERPRETER_H
#define TVI_AD_INTERPRETER_H

/* Returns the sweeps for the widest instruction set that the processor has. The environment variable TVI_ISA = base
 * or avx2 chooses a narrower one. */
const jet_sweeps *jet_choose_sweeps_for_processor(void);

/* Sets the text of the refusal (refusal.h) to the first operation that is outside its domain, in a block whose sweep
 * of values has failed. The values are computed again. Returns false. */
bool jet_explain_failed_sweep(const jet_tape *tape, double *block, int lanes);

/* Computes the values of all slots, which are their coefficients of order 0, from those of the inputs. Returns false
 * if an operation is outside its domain. */
static inline bool jet_sweep_values(const jet_tape *tape, double *block, int lanes)
{
    return tape->sweeps->values(tape, block, lanes) || jet_explain_failed_sweep(tape, block, lanes);
}

/* Computes values[slots] at one point in long double from the inputs and the constants of a block. They are NaN if
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
                                      int lanes)
{
    tape->sweeps->tangents(tape, series, tangents, order, lanes);
}

/* Computes the tangents of one order along a series of several lanes, with one direction for each of these lanes. */
static inline void jet_sweep_tangents_per_lane(const jet_tape *tape, const double *series, double *tangents, int order,
                                               int lanes)
{
    tape->sweeps->tangents_per_lane(tape, series, tangents, order, lanes);
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
