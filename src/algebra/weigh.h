/* weigh.h - sums of rows, and of their sizes. */
#ifndef TVI_SRC_ALGEBRA_WEIGH_H
#define TVI_SRC_ALGEBRA_WEIGH_H

#include <math.h>
#include <stddef.h>

/* A block of components, in registers. */
#define TVI_WEIGH_BLOCK(width, OF)                                                                                     \
    for (; first + (width) <= components; first += (width)) {                                                          \
        double sum[width];                                                                                             \
        for (size_t i = 0; i < (width); i++) sum[i] = out[first + i];                                                  \
        for (size_t r = count; r-- > 0;)                                                                               \
            for (size_t i = 0; weight[r] != 0 && i < (width); i++)                                                     \
                sum[i] += weight[r] * OF(row[r * stride + first + i]);                                                 \
        for (size_t i = 0; i < (width); i++) out[first + i] = sum[i];                                                  \
    }
#define TVI_WEIGH(OF)                                                                                                  \
    size_t first = 0;                                                                                                  \
    TVI_WEIGH_BLOCK(8, OF)                                                                                             \
    TVI_WEIGH_BLOCK(4, OF)                                                                                             \
    TVI_WEIGH_BLOCK(2, OF)                                                                                             \
    TVI_WEIGH_BLOCK(1, OF)

/* out[components] += sum_r weight[r] row[r * stride ..], from the last row to the first: the small terms of a series
 * come first. What has no weight is not read. */
static inline void tvi_add_rows(size_t count, const double weight[], size_t stride, size_t components,
                                const double row[], double out[])
{
    TVI_WEIGH()
}

/* The same of |row|. */
static inline void tvi_add_sizes(size_t count, const double weight[], size_t stride, size_t components,
                                 const double row[], double out[])
{
    TVI_WEIGH(fabs)
}

#endif
