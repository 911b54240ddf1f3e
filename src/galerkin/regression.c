/* regression.c - see regression.h. */
#include "galerkin/regression.h"

#include "algebra/sizes.h"
#include "galerkin/lanes.h"
#include "rule.h"

#include <math.h>

enum { ROWS = 4, MAX_LANES = TVI_GALERKIN_MAX_LANES };
#define RIDGE 1e-14 /* of polynomials that are scaled to size 1 */

#define COMBINE(V, blocks)                                                                                             \
    for (int b = 0; b < (blocks); b++) {                                                                               \
        V sum[2] = {0};                                                                                                \
        for (int i = 0; i < count; i++) sum[i % 2] += factor[i] * BLOCK_OF(V, rows + i * lanes, b);                    \
        BLOCK_AT(V, out, b) = sum[0] + sum[1];                                                                         \
    }

/* out = sum_i factor_i rows_i, [lanes] each. */
JET_INLINE void combine(int count, const double *factor, const double *rows, double *out, int lanes)
{
    LEAVE_REGISTERS(factor);
    ALL_LANES(lanes, COMBINE)
}

/* squares += (x - of)^2, which replaces x. */
JET_INLINE void leave(double *x, const double *of, double *squares, int lanes)
{
    for (int i = 0; i < lanes; i++) {
        x[i] -= of[i];
        squares[i] += x[i] * x[i];
    }
}

JET_INLINE double sum_of(const double *x, int lanes)
{
    double sum = 0;
    for (int i = 0; i < lanes; i++) sum += x[i];
    return sum;
}

/* ---- Samples ----------------------------------------------------------------------------------------------------- */

/* The impulses of all steps say how large each unknown's are. */
JET_INLINE void set_weights(const galerkin_regression *of, const double *impulses, int lanes)
{
    const int count = of->unknowns, half = count / of->halves;
    const int steps = REGRESSION_WINDOWS * (of->samples + 2);
    for (int first = 0; first < count; first += half) {
        double largest = 0;
        for (int u = first; u < first + half; u++) {
            double square = 0;
            for (int k = 0; k < steps; k++)
                for (int i = 0; i < lanes; i++) {
                    const double impulse = impulses[(k * count + u) * lanes + i];
                    square += impulse * impulse;
                }
            of->weight[u] = fabs(of->scale[u]) * sqrt(square);
            largest = tvi_larger(of->weight[u], largest);
        }
        const double share = TVI_GALERKIN_LEAST_SHARE * largest, least = share > 0 ? share : 1;
        for (int u = first; u < first + half; u++) of->weight[u] = fabs(of->scale[u]) / (of->weight[u] + least);
    }
}

/* A step, whose impulses these are, and the two before it. */
JET_INLINE void take_sample(const galerkin_regression *of, const double *impulses, double *sample, int lanes)
{
    const int count = of->unknowns;
    const double *last = impulses + count * lanes, *before = last + count * lanes;
    double by_two[MAX_LANES] = {0}, by_last[MAX_LANES] = {0};
    for (int u = 0; u < count; u++) {
        double *part = sample + 3 * u * lanes, *lack = part + 2 * lanes;
        double drive[2 * MAX_LANES], sum[MAX_LANES], of_last[MAX_LANES];
        for (int i = 0; i < lanes; i++) {
            const double factor = of->weight[u] * of->per_weight[i];
            drive[i] = factor * last[u * lanes + i];
            drive[lanes + i] = factor * before[u * lanes + i];
            lack[i] = of_last[i] = factor * impulses[u * lanes + i];
        }
        combine(2 * lanes, drive, of->basis, part, 2 * lanes);
        combine(2 * lanes, part, of->ahead, sum, lanes);
        leave(lack, sum, by_two, lanes);
        combine(lanes, drive, of->of_last, sum, lanes);
        leave(of_last, sum, by_last, lanes);
    }
    const double size = tvi_smaller(sum_of(by_two, lanes), sum_of(by_last, lanes));
    const double scale = size > 0 ? 1 / sqrt(size) : 0;
    for (int k = 0; k < 3 * count * lanes; k++) sample[k] *= scale;
}

/* ---- Equations --------------------------------------------------------------------------------------------------- */

/* Some rows of the samples, from the diagonal block on. */
#define SET_ROWS(V, blocks)                                                                                            \
    {                                                                                                                  \
        V of_gram[ROWS][2 * MOST_BLOCKS] = {0}, of_right[ROWS][MOST_BLOCKS] = {0};                                     \
        const double *part = of->sample;                                                                               \
        for (int s = 0; s < count; s++, part += 3 * lanes)                                                             \
            for (int k = 0; k < rows; k++) {                                                                           \
                for (int b = half * (blocks); b < 2 * (blocks); b++)                                                   \
                    of_gram[k][b] += part[row + k] * BLOCK_OF(V, part, b);                                             \
                for (int b = 0; b < (blocks); b++) of_right[k][b] += part[row + k] * BLOCK_OF(V, part + 2 * lanes, b); \
            }                                                                                                          \
        for (int k = 0; k < rows; k++) {                                                                               \
            double *to_gram = of->gram + 2 * (row + k) * lanes, *to_right = of->factor + (row + k) * lanes;            \
            for (int b = half * (blocks); b < 2 * (blocks); b++) BLOCK_AT(V, to_gram, b) = of_gram[k][b];              \
            for (int b = 0; b < (blocks); b++) BLOCK_AT(V, to_right, b) = of_right[k][b];                              \
        }                                                                                                              \
    }

JET_INLINE void set_rows(const galerkin_regression *of, int half, int lanes)
{
    const int rows = lanes < ROWS ? lanes : ROWS, count = (REGRESSION_WINDOWS - 1) * of->samples * of->unknowns;
    for (int row = half * lanes; row < (half + 1) * lanes; row += rows) {
        ALL_LANES(lanes, SET_ROWS)
    }
}

/* Polynomials scaled to size 1; what no sample has stays out. */
JET_INLINE void scale_equations(const galerkin_regression *of, double *scale, int lanes)
{
    const int both = 2 * lanes;
    for (int k = 0; k < both; k++) {
        const double square = of->gram[k * both + k];
        scale[k] = square > 0 ? 1 / sqrt(square) : 0;
    }
    for (int k = 0; k < both; k++) {
        double *row = of->gram + k * both;
        for (int l = 0; l < both; l++) row[l] *= scale[k] * scale[l];
        for (int i = 0; i < lanes; i++) of->factor[k * lanes + i] *= scale[k];
        row[k] = scale[k] > 0 ? row[k] + RIDGE : 1;
    }
}

#define SUBTRACT(V, blocks)                                                                                            \
    for (int b = 0; b < (blocks); b++) BLOCK_AT(V, to, b) -= factor * BLOCK_OF(V, from, b);

/* to -= factor from. */
JET_INLINE void subtract(double factor, const double *from, double *to, int lanes){ALL_LANES(lanes, SUBTRACT)}

/* By elimination: the matrix is positive definite, and so small that LAPACK takes several times as long. */
JET_INLINE bool solve(const galerkin_regression *of, int lanes)
{
    const int both = 2 * lanes;
    double scale[2 * MAX_LANES], inverse[2 * MAX_LANES];
    scale_equations(of, scale, lanes);
    for (int k = 0; k < both; k++) {
        const double *row = of->gram + k * both;
        if (!(row[k] > 0)) return false;
        inverse[k] = 1 / row[k];
        for (int l = k + 1; l < both; l++) {
            const double factor = row[l] * inverse[k];
            double *below = of->gram + l * both;
            if (l < lanes) subtract(factor, row, below, lanes);
            subtract(factor, row + lanes, below + lanes, lanes);
            subtract(factor, of->factor + k * lanes, of->factor + l * lanes, lanes);
        }
    }
    for (int k = both - 1; k >= 0; k--) {
        double *x = of->factor + k * lanes;
        for (int i = 0; i < lanes; i++) x[i] *= inverse[k];
        for (int l = 0; l < k; l++) subtract(of->gram[l * both + k], x, of->factor + l * lanes, lanes);
    }
    for (int k = 0; k < both; k++)
        for (int i = 0; i < lanes; i++) of->factor[k * lanes + i] *= scale[k];
    return true;
}

/* ---- What they leave --------------------------------------------------------------------------------------------- */

JET_INLINE bool are_better(const galerkin_regression *of, int lanes)
{
    double *part = of->sample + 3 * (REGRESSION_WINDOWS - 1) * of->samples * of->unknowns * lanes;
    double gain = 0;
    for (int s = 0; s < of->samples; s++) {
        double sum[MAX_LANES], left[MAX_LANES] = {0};
        for (int u = 0; u < of->unknowns; u++, part += 3 * lanes) {
            combine(2 * lanes, part, of->factor, sum, lanes);
            leave(part + 2 * lanes, sum, left, lanes);
        }
        const double size = sum_of(left, lanes);
        if (!(size > 0)) return false; /* nothing is lacking */
        gain -= log(size) / 2;
    }
    return gain >= of->samples * log(of->gain);
}

JET_INLINE void set_table(const galerkin_regression *of, double *table, int lanes)
{
    double rise[2 * MAX_LANES * MAX_LANES];
    for (int k = 0; k < 2 * lanes; k++) {
        double *row = of->factor + k * lanes;
        for (int i = 0; i < lanes; i++) row[i] += of->ahead[k * lanes + i];
        combine(lanes, row, of->rise, rise + k * lanes, lanes);
    }
    for (int j = 0; j < 2 * lanes; j++) {
        combine(2 * lanes, of->basis + 2 * j * lanes, rise, table + j * lanes, lanes);
        for (int i = 0; i < lanes; i++) table[j * lanes + i] *= of->per_weight[j % lanes];
    }
}

JET_INLINE bool regress_lanes(const galerkin_regression *w, const double *impulses, double *table, int lanes)
{
    const galerkin_regression of = *w;
    const int numbers = of.unknowns * lanes;
    double *sample = of.sample;
    set_weights(&of, impulses, lanes);
    for (int window = 0; window < REGRESSION_WINDOWS; window++, impulses += 2 * numbers)
        for (int s = 0; s < of.samples; s++, impulses += numbers, sample += 3 * numbers)
            take_sample(&of, impulses, sample, lanes);
    set_rows(&of, 0, lanes);
    set_rows(&of, 1, lanes);
    if (!solve(&of, lanes) || !are_better(&of, lanes)) return false;
    set_table(&of, table, lanes);
    return true;
}

BY_LANES(bool, return, regress, (const galerkin_regression *w, const double *impulses, double *table), w, impulses,
         table)

bool JET_FOR_ISA(tvi_galerkin_regress)(const galerkin_regression *w, const double *impulses, double *table)
{
    switch (w->lanes) {
    case 1: return regress_1(w, impulses, table);
    case 2: return regress_2(w, impulses, table);
    case 4: return regress_4(w, impulses, table);
    case 8: return regress_8(w, impulses, table);
    default: return regress_most(w, impulses, table);
    }
}
