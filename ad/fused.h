/* fused.h - Multiplies and adds vectors with one rounding, if the processor has such an instruction. The inner loops of
 * the methods (src/galerkin/, src/generating/) call it. It is no part of vector.h, since the compiler takes 0.3 s to
 * read the header of the vector instructions. */
#ifndef TVI_AD_FUSED_H
#define TVI_AD_FUSED_H

#include "vector.h"

/* Computes a b + c, rounded once. */
#ifdef __FMA__
#include <immintrin.h>
#define JET_FMA(V, a, b, c)    JET_FMA_OF(V, a, b, c)
#define JET_FMA_OF(V, a, b, c) jet_fma_##V(a, b, c)
JET_INLINE jet_v1 jet_fma_jet_v1(jet_v1 a, jet_v1 b, jet_v1 c) { return JET_FMA_OF_NUMBERS(a, b, c); }
JET_INLINE jet_v2 jet_fma_jet_v2(jet_v2 a, jet_v2 b, jet_v2 c)
{
    return (jet_v2)_mm_fmadd_pd((__m128d)a, (__m128d)b, (__m128d)c);
}
JET_INLINE jet_v4 jet_fma_jet_v4(jet_v4 a, jet_v4 b, jet_v4 c)
{
    return (jet_v4)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
}
#ifdef JET_WIDE
#define jet_fma_jet_widest jet_fma_jet_v8
JET_INLINE jet_v8 jet_fma_jet_v8(jet_v8 a, jet_v8 b, jet_v8 c)
{
    return (jet_v8)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
}
#elif defined(__AVX__)
#define jet_fma_jet_widest jet_fma_jet_v4
#endif
#endif

/* Computes a b + c, rounded once if the processor has such an instruction. The result for a number has the same bits in
 * vectors of every length. */
#ifdef __FMA__
#define JET_FUSED(V, a, b, c) JET_FMA(V, a, b, c)
#else
#define JET_FUSED(V, a, b, c) ((a) * (b) + (c))
#endif

#endif
