/* precise.c - Computes the values of a tape in long double, for energies in which large terms cancel.
 * src/system/energy.c calls jet_sweep_long_double_values. */
#include "rule.h"

#include <math.h>
#include <stdlib.h>

/* Computes a^c. If 2 c is a small integer, the function multiplies and takes a square root, since powl costs as much as
 * twenty products. */
static long double compute_long_double_power(long double a, double c)
{
    int k = (int)fmax(-2 * TAPE_POWER_MAX_EXPONENT, fmin(2 * c, 2 * TAPE_POWER_MAX_EXPONENT));
    if (k != 2 * c || k == 0) return powl(a, c);
    long double product = 1, factor = k % 2 ? sqrtl(a) : a;
    if (k % 2 == 0) k /= 2;
    for (int left = abs(k); left > 0; left /= 2, factor *= factor)
        if (left % 2) product *= factor;
    return k < 0 ? 1 / product : product;
}

static long double evaluate_operation(const jet_run_of_operations *run, long double a, long double b)
{
    switch (run->op) {
    case OP_DIV: return a / b;
    case OP_SQRT: return sqrtl(a);
    case OP_POW: return compute_long_double_power(a, run->exponent);
    case OP_HYPOT:
    case OP_RADIUS: return hypotl(a, b);
    case OP_ATAN2: return atan2l(a, b);
    case OP_EXP: return expl(a);
    case OP_SIN: return sinl(a);
    case OP_COS: return cosl(a);
    case OP_SINH: return sinhl(a);
    case OP_COSH: return coshl(a);
    case OP_TAN: return tanl(a);
    case OP_TANH: return tanhl(a);
    case OP_SECH2: return 1 / (coshl(a) * coshl(a));
    case OP_ERF: return erfl(a);
    case OP_LOG: return logl(a);
    case OP_ASIN: return asinl(a);
    case OP_ACOS: return acosl(a);
    case OP_ATAN: return atanl(a);
    case OP_ASINH: return asinhl(a);
    case OP_ACOSH: return acoshl(a);
    case OP_ATANH: return atanhl(a);
    default: return NAN;
    }
}

static long double evaluate_linear_sum(const jet_tape *tape, const jet_run_of_operations *run, int operation_index,
                                       const long double *values)
{
    long double sum = tape->constant_terms[run->first_constant_term_index + operation_index];
    for (int k = run->first_term_index + operation_index * run->term_count, end = k + run->term_count; k < end; k++)
        sum += tape->terms.coefficient[k] * values[tape->terms.slot[k]];
    return sum;
}

static long double evaluate_product_sum(const jet_tape *tape, const jet_run_of_operations *run, int operation_index,
                                        const long double *values)
{
    const int *second = run->op == OP_SQUARES ? tape->terms.slot : tape->terms.slot_b;
    long double sum = 0;
    for (int k = run->first_term_index; k < run->first_term_index + run->term_count; k++)
        sum += tape->terms.coefficient[k] * values[tape->terms.slot[k] + operation_index] *
               values[second[k] + operation_index];
    return sum;
}

void jet_sweep_long_double_values(const jet_tape *tape, const double *block, long double *values)
{
    for (int i = tape->input_count; i < tape->input_count + tape->constant_count; i++) values[i] = block[i];
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++)
        for (int i = 0; i < run->operation_count; i++)
            values[run->z + i] = run->op == OP_LINEAR ? evaluate_linear_sum(tape, run, i, values)
                                 : jet_is_sum_of_products(run->op)
                                     ? evaluate_product_sum(tape, run, i, values)
                                     : evaluate_operation(run, values[run->a + i], values[run->b + i]);
}
