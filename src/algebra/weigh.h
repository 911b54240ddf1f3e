/* weigh.h - Adds weighted rows, or the sizes of rows. The sums of series use it. */
#ifndef TVI_SRC_ALGEBRA_WEIGH_H
#define TVI_SRC_ALGEBRA_WEIGH_H

#include <math.h>
#include <stddef.h>

/* Sums a block of components in registers. Small blocks use several chains of rows that do not wait for each other. */
#define TVI_WEIGH_BLOCK(width, chains, OF)                                                                             \
    for (; first + (width) <= components; first += (width)) {                                                          \
        double sum[chains][width] = {{0}};                                                                             \
        size_t r = count;                                                                                              \
        for (; r >= (chains); r -= (chains))                                                                           \
            for (size_t c = 0; c < (chains); c++) TVI_WEIGH_ROW(width, r - 1 - c, sum[c], OF)                          \
        for (; r > 0; r--) TVI_WEIGH_ROW(width, r - 1, sum[0], OF)                                                     \
        for (size_t c = 1; c < (chains); c++)                                                                          \
            for (size_t i = 0; i < (width); i++) sum[0][i] += sum[c][i];                                               \
        for (size_t i = 0; i < (width); i++) out[first + i] += sum[0][i];                                              \
    }
#define TVI_WEIGH_ROW(width, r, sum, OF)                                                                               \
    for (size_t i = 0; weight[r] != 0 && i < (width); i++) sum[i] += weight[r] * OF(row[(r)*stride + first + i]);
#define TVI_WEIGH(OF)                                                                                                  \
    size_t first = 0;                                                                                                  \
    TVI_WEIGH_BLOCK(8, 1, OF)                                                                                          \
    TVI_WEIGH_BLOCK(4, 2, OF)                                                                                          \
    TVI_WEIGH_BLOCK(2, 2, OF)                                                                                          \
    TVI_WEIGH_BLOCK(1, 4, OF)

/* out[components] += sum_r weight[r] row[r * stride ..], from the last row to the first, so that the small terms of a
 * series come first. Rows without weight are not read. */
static inline void tvi_add_rows(size_t count, const double weight[], size_t stride, size_t components,
                                const double row[], double out[])
{
    TVI_WEIGH()
}

/* The sum of |row|. */
static inline void tvi_add_sizes(size_t count, const double weight[], size_t stride, size_t components,
                                 const double row[], double out[])
{
    TVI_WEIGH(fabs)
}

#endif
