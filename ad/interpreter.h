/* interpreter.h - Runs the sweeps of a tape by the loops of its instruction set. tape.h ends with this file; generated
 * code, which has no interpreter, goes without. */
#ifndef TVI_AD_INTERPRETER_H
#define TVI_AD_INTERPRETER_H

/* The sweeps of the widest instruction set that the machine has. The environment variable TVI_ISA = base or avx2 asks
 * for less. */
const jet_sweeps *jet_sweeps_choose(void);

/* Sets the text of the refusal (refusal.h) to the first operation of a block of values that is outside its domain. The
 * values are computed again. Returns false. */
bool jet_refuse_sweep(const jet_tape *tape, double *x, int lanes);

/* Computes the values of all slots from the inputs, order 0. Returns false if an operation is outside its domain. */
static inline bool jet_sweep_values(const jet_tape *tape, double *x, int lanes)
{
    return tape->sweeps->values(tape, x, lanes) || jet_refuse_sweep(tape, x, lanes);
}

/* Computes the values at one point in long double: y [slots] from the inputs and the constants of a block. They are NaN
 * if an operation is outside its domain. */
void jet_sweep_precisely(const jet_tape *tape, const double *x, long double *y);

/* Computes coefficient k of all slots from orders 0..k of the inputs and 0..k-1 of all slots, for k = 0, 1, 2, ... in
 * turn. One order costs O(k) per operation, so a series to degree N costs O(N^2). Returns false at k = 0 as above. */
static inline bool jet_sweep_series(const jet_tape *tape, double *x, int k, int lanes)
{
    return tape->sweeps->series(tape, x, k, lanes) || jet_refuse_sweep(tape, x, lanes);
}

/* Computes the tangents dx (lanes directions) of coefficient k along the one-lane series x, from dx of the inputs, for
 * k = 0, 1, 2, ... in turn. */
static inline void jet_sweep_tangents(const jet_tape *tape, const double *x, double *dx, int k, int lanes)
{
    tape->sweeps->tangents(tape, x, dx, k, lanes);
}

/* Computes the tangents with one direction along each lane of the series x, which has as many lanes as dx. */
static inline void jet_sweep_tangents_in_lanes(const jet_tape *tape, const double *x, double *dx, int k, int lanes)
{
    tape->sweeps->tangents_in_lanes(tape, x, dx, k, lanes);
}

/* Computes the adjoints of order k along the one-lane series x, for k = top, top - 1, ..., 0 in turn. bar is a block
 * like x. It ends with the derivatives of a scalar with respect to the coefficients of each input; the rules use its
 * other slots. The caller first adds the derivatives of the scalar by the inputs and outputs that it depends on
 * directly. The cost is about that of one and a half series, for any number of inputs. */
static inline void jet_sweep_adjoints(const jet_tape *tape, const double *x, double *bar, int k, int top)
{
    tape->sweeps->adjoints(tape, x, bar, k, top);
}

#endif
