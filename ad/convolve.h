/* convolve.h - the two loops in which all time of a series goes. Every rule is a sum over them.
 *
 * The innermost index is contiguous and independent. It is worked off in blocks of several vectors, then pairs, then
 * single numbers, each block with its sums in registers over all orders j. Vector types are an extension of gcc and clang. */
#ifndef TVI_AD_CONVOLVE_H
#define TVI_AD_CONVOLVE_H

#include <stddef.h>

#define JET_INLINE static inline __attribute__((always_inline))

/* The machine's vector, of JET_WIDTH numbers, and a short one. */
#if defined(__AVX512F__)
#define JET_WIDTH 8
#elif defined(__AVX__)
#define JET_WIDTH 4
#else
#define JET_WIDTH 2
#endif
typedef double jet_vector __attribute__((vector_size(8 * JET_WIDTH), aligned(8), may_alias));
typedef double jet_pair __attribute__((vector_size(16), aligned(8), may_alias));

/* The weight of order j in a convolution: alpha j + beta. */
typedef struct {
    double alpha, beta;
} jet_weight;

static const jet_weight WEIGHT_ONE = {0, 1}; /* 1 */
static const jet_weight WEIGHT_J = {1, 0};   /* j */

/* One block: sum += sum_{j=first}^{last} factor_j x_j y_{k-j} for `count` vectors of a type, count 1 or 4. The sums have
 * names because compilers keep arrays of vectors in memory. */
#define JET_BLOCK_1(type, factor, at_j)                                                                                \
    do {                                                                                                               \
        type s0 = *(type *)(sum + w);                                                                                  \
        for (int j = first; j <= last; j++) {                                                                          \
            const double c = factor;                                                                                   \
            s0 += c * at_j(type, 0);                                                                                   \
        }                                                                                                              \
        *(type *)(sum + w) = s0;                                                                                       \
    } while (0)
#define JET_BLOCK_4(type, factor, at_j)                                                                                \
    do {                                                                                                               \
        type *s = (type *)(sum + w);                                                                                   \
        type s0 = s[0], s1 = s[1], s2 = s[2], s3 = s[3];                                                               \
        for (int j = first; j <= last; j++) {                                                                          \
            const double c = factor;                                                                                   \
            s0 += c * at_j(type, 0);                                                                                   \
            s1 += c * at_j(type, 1);                                                                                   \
            s2 += c * at_j(type, 2);                                                                                   \
            s3 += c * at_j(type, 3);                                                                                   \
        }                                                                                                              \
        s[0] = s0, s[1] = s1, s[2] = s2, s[3] = s3;                                                                    \
    } while (0)
#define JET_BLOCKS(width, factor, at_j)                                                                                \
    do {                                                                                                               \
        int w = 0;                                                                                                     \
        for (; w + 4 * JET_WIDTH <= width; w += 4 * JET_WIDTH) JET_BLOCK_4(jet_vector, factor, at_j);                  \
        for (; w + JET_WIDTH <= width; w += JET_WIDTH) JET_BLOCK_1(jet_vector, factor, at_j);                          \
        for (; w + 2 <= width; w += 2) JET_BLOCK_1(jet_pair, factor, at_j);                                            \
        for (; w < width; w++) JET_BLOCK_1(double, factor, at_j);                                                      \
    } while (0)

#define JET_VECTOR_OF(type, series, stride, order, i) (((const type *)((series) + (size_t)(order) * (stride) + w))[i])
#define JET_BOTH_AT_J(type, i) (JET_VECTOR_OF(type, x, stride, j, i) * JET_VECTOR_OF(type, y, stride, k - j, i))
#define JET_Y_AT_J(type, i) JET_VECTOR_OF(type, y, ystride, k - j, i)

/* sum[w] += sum_{j=first}^{last} weight(j) x_j[w] y_{k-j}[w],  w < width.   2 (last - first + 1) multiply-adds a lane. */
JET_INLINE void convolve(double *sum, jet_weight weight, int first, int last, int k, size_t stride, int width,
                         const double *x, const double *y)
{
    JET_BLOCKS(width, weight.alpha * j + weight.beta, JET_BOTH_AT_J);
}

/* sum[w] += scale sum_{j=first}^{last} weight(j) x_j y_{k-j}[w]: a scalar series times the lanes of a tangent. */
JET_INLINE void broadcast(double *sum, double scale, jet_weight weight, int first, int last, int k, size_t stride,
                          const double *x, size_t ystride, const double *y, int lanes)
{
    JET_BLOCKS(lanes, scale * (weight.alpha * j + weight.beta) * x[(size_t)j * stride], JET_Y_AT_J);
}

#endif
