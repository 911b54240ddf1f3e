/* regression.c - see regression.h. */
#include "galerkin/regression.h"

#include "algebra/sizes.h"
#include "galerkin/lanes.h"
#include "rule.h"

#include <math.h>

enum { ROWS = 4, MAX_LANES = TVI_GALERKIN_MAX_LANES };
#define RIDGE 1e-14 /* of polynomials that are scaled to size 1 */

/* ---- Samples ----------------------------------------------------------------------------------------------------- */

#define TAKE_PART(V, blocks)                                                                                           \
    {                                                                                                                  \
        V sum[2 * MOST_BLOCKS] = {0};                                                                                  \
        for (int i = 0; i < 2 * lanes; i++)                                                                            \
            for (int b = 0; b < 2 * (blocks); b++) sum[b] += drive[i] * BLOCK_OF(V, of->basis + 2 * i * lanes, b);     \
        for (int b = 0; b < 2 * (blocks); b++) BLOCK_AT(V, part, b) = sum[b];                                          \
    }

#define TAKE_LACK(V, blocks)                                                                                           \
    for (int b = 0; b < (blocks); b++) {                                                                               \
        V two[2] = {weight * BLOCK_OF(V, now, b) * BLOCK_OF(V, of->per_weight, b)}, one = two[0];                      \
        for (int k = 0; k < 2 * lanes; k++) two[k % 2] -= part[k] * BLOCK_OF(V, of->ahead + k * lanes, b);             \
        for (int i = 0; i < lanes; i++) one -= drive[i] * BLOCK_OF(V, of->of_last + i * lanes, b);                     \
        two[0] += two[1];                                                                                              \
        BLOCK_AT(V, part + 2 * lanes, b) = two[0];                                                                     \
        BLOCK_AT(V, by_two, b) += two[0] * two[0];                                                                     \
        BLOCK_AT(V, by_last, b) += one * one;                                                                          \
    }

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
    double by_two[MAX_LANES] = {0}, by_last[MAX_LANES] = {0}, square[2] = {0};
    for (int u = 0; u < count; u++) {
        const double *now = impulses + u * lanes;
        double *part = sample + 3 * u * lanes, drives[2 * MAX_LANES], *drive = drives;
        const double weight = of->weight[u];
        for (int i = 0; i < lanes; i++) {
            drive[i] = weight * of->per_weight[i] * last[u * lanes + i];
            drive[lanes + i] = weight * of->per_weight[i] * before[u * lanes + i];
        }
        LEAVE_REGISTERS(drive);
        ALL_LANES(lanes, TAKE_PART)
        LEAVE_REGISTERS(part);
        ALL_LANES(lanes, TAKE_LACK)
    }
    for (int i = 0; i < lanes; i++) square[0] += by_two[i], square[1] += by_last[i];
    const double size = tvi_smaller(square[0], square[1]), scale = size > 0 ? 1 / sqrt(size) : 0;
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

#define ADD_LEFT(V, blocks)                                                                                            \
    for (int b = 0; b < (blocks); b++) {                                                                               \
        V rest[2] = {BLOCK_OF(V, part + 2 * lanes, b)};                                                                \
        for (int k = 0; k < 2 * lanes; k++) rest[k % 2] -= part[k] * BLOCK_OF(V, of->factor + k * lanes, b);           \
        rest[0] += rest[1];                                                                                            \
        BLOCK_AT(V, left, b) += rest[0] * rest[0];                                                                     \
    }

JET_INLINE bool are_better(const galerkin_regression *of, int lanes)
{
    const double *part = of->sample + 3 * (REGRESSION_WINDOWS - 1) * of->samples * of->unknowns * lanes;
    double gain = 0;
    for (int s = 0; s < of->samples; s++) {
        double left[MAX_LANES] = {0}, sum = 0;
        for (int u = 0; u < of->unknowns; u++, part += 3 * lanes) ALL_LANES(lanes, ADD_LEFT)
        for (int i = 0; i < lanes; i++) sum += left[i];
        if (!(sum > 0)) return false; /* nothing is lacking */
        gain -= log(sum) / 2;
    }
    return gain >= of->samples * log(of->gain);
}

/* ---- The table --------------------------------------------------------------------------------------------------- */

#define SET_RISE(V, blocks)                                                                                            \
    for (int k = 0; k < 2 * lanes; k++) {                                                                              \
        V sum[MOST_BLOCKS] = {0};                                                                                      \
        for (int i = 0; i < lanes; i++)                                                                                \
            for (int b = 0; b < (blocks); b++)                                                                         \
                sum[b] +=                                                                                              \
                    (of->ahead[k * lanes + i] + of->factor[k * lanes + i]) * BLOCK_OF(V, of->rise + i * lanes, b);     \
        for (int b = 0; b < (blocks); b++) BLOCK_AT(V, rise + k * lanes, b) = sum[b];                                  \
    }

#define SET_TABLE(V, blocks)                                                                                           \
    for (int j = 0; j < 2 * lanes; j++) {                                                                              \
        V sum[MOST_BLOCKS] = {0};                                                                                      \
        for (int k = 0; k < 2 * lanes; k++)                                                                            \
            for (int b = 0; b < (blocks); b++)                                                                         \
                sum[b] += of->basis[2 * j * lanes + k] * BLOCK_OF(V, rise + k * lanes, b);                             \
        for (int b = 0; b < (blocks); b++) BLOCK_AT(V, table + j * lanes, b) = of->per_weight[j % lanes] * sum[b];     \
    }

JET_INLINE void set_table(const galerkin_regression *of, double *table, int lanes)
{
    double rise[2 * MAX_LANES * MAX_LANES];
    ALL_LANES(lanes, SET_RISE)
    ALL_LANES(lanes, SET_TABLE)
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
