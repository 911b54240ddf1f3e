/* convolve.h - the two loops in which all time of a series goes. Every rule is a sum over them.
 *
 * The innermost index is contiguous and independent, so that the compiler vectorises it; blocks of fixed width keep the
 * sums in registers over all orders j. */
#ifndef TVI_AD_CONVOLVE_H
#define TVI_AD_CONVOLVE_H

#include <stddef.h>

#if defined(__GNUC__)
#define JET_INLINE static inline __attribute__((always_inline))
#else
#define JET_INLINE static inline
#endif

/* The weight of order j in a convolution: alpha j + beta. */
typedef struct {
    double alpha, beta;
} jet_weight;

static const jet_weight WEIGHT_ONE = {0, 1}; /* 1 */
static const jet_weight WEIGHT_J = {1, 0};   /* j */

/* sum[w] += sum_{j=first}^{last} weight(j) x_j[w] y_{k-j}[w],  w < block.  2 (last - first + 1) multiply-adds each. */
JET_INLINE void convolve_block(int block, double *sum, jet_weight weight, int first, int last, int k, size_t stride,
                               const double *x, const double *y)
{
    double partial[8] = {0};
    for (int j = first; j <= last; j++) {
        const double *xj = x + (size_t)j * stride;
        const double *yj = y + (size_t)(k - j) * stride;
        const double factor = weight.alpha * j + weight.beta;
        for (int w = 0; w < block; w++) partial[w] += factor * (xj[w] * yj[w]);
    }
    for (int w = 0; w < block; w++) sum[w] += partial[w];
}

/* The same over any width. */
JET_INLINE void convolve(double *sum, jet_weight weight, int first, int last, int k, size_t stride, int width,
                         const double *x, const double *y)
{
    int w = 0;
    for (; w + 8 <= width; w += 8) convolve_block(8, sum + w, weight, first, last, k, stride, x + w, y + w);
    for (; w + 2 <= width; w += 2) convolve_block(2, sum + w, weight, first, last, k, stride, x + w, y + w);
    for (; w < width; w++) convolve_block(1, sum + w, weight, first, last, k, stride, x + w, y + w);
}

/* sum[w] += scale sum_{j=first}^{last} weight(j) x_j dy_{k-j}[w]: a scalar series times the lanes of a tangent. */
JET_INLINE void broadcast_block(int block, double *sum, double scale, jet_weight weight, int first, int last, int k,
                                size_t stride, const double *x, size_t dstride, const double *dy)
{
    double partial[8] = {0};
    for (int j = first; j <= last; j++) {
        const double factor = (weight.alpha * j + weight.beta) * x[(size_t)j * stride];
        const double *dyj = dy + (size_t)(k - j) * dstride;
        for (int w = 0; w < block; w++) partial[w] += factor * dyj[w];
    }
    for (int w = 0; w < block; w++) sum[w] += scale * partial[w];
}

JET_INLINE void broadcast(double *sum, double scale, jet_weight weight, int first, int last, int k, size_t stride,
                          const double *x, size_t dstride, const double *dy, int lanes)
{
    int w = 0;
    for (; w + 8 <= lanes; w += 8)
        broadcast_block(8, sum + w, scale, weight, first, last, k, stride, x, dstride, dy + w);
    for (; w + 2 <= lanes; w += 2)
        broadcast_block(2, sum + w, scale, weight, first, last, k, stride, x, dstride, dy + w);
    for (; w < lanes; w++) broadcast_block(1, sum + w, scale, weight, first, last, k, stride, x, dstride, dy + w);
}

#endif
