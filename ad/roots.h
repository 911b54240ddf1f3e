/* roots.h - vectors whose inverse roots are had from an estimate (rule_power.c), where multiply-adds are fused: with
 * AVX2 in generated code alone, where gcc makes of roots and quotients no vectors; in a tape they are as fast. */
#ifndef TVI_AD_ROOTS_H
#define TVI_AD_ROOTS_H

#include "vector.h"

#if defined(__AVX512F__)
#include <immintrin.h>
#define HAS_ROOTS
typedef __m512d roots;
typedef __mmask8 roots_mask;
enum { ROOTS = 8 };
#define OF_ROOTS(name)           _mm512_##name
#define ROOTS_WHERE(a, is, b)    _mm512_cmp_pd_mask(a, b, is)
#define ROOTS_CHOOSE(mask, a, b) _mm512_mask_blend_pd(mask, b, a)
#define ROOTS_ARE(mask)          (mask)
#define ROOTS_FIRST(count)       ((roots_mask)((1 << (count)) - 1))
#define ROOTS_LOAD(mask, a)      _mm512_maskz_loadu_pd(mask, a)
#define ROOTS_STORE(mask, z, a)  _mm512_mask_storeu_pd(z, mask, a)
#define ROOTS_BITS(a, bits)      _mm512_castsi512_pd(_mm512_and_epi64(_mm512_castpd_si512(a), _mm512_set1_epi64(bits)))

/* Near a^(-1/2). */
JET_INLINE roots roots_estimate(roots a) { return _mm512_rsqrt14_pd(a); }

#elif defined(__AVX2__) && defined(__FMA__) && defined(JET_EMITTED)
#include <immintrin.h>
#define HAS_ROOTS
typedef __m256d roots;
typedef __m256d roots_mask;
enum { ROOTS = 4 };
#define OF_ROOTS(name)           _mm256_##name
#define ROOTS_WHERE(a, is, b)    _mm256_cmp_pd(a, b, is)
#define ROOTS_CHOOSE(mask, a, b) _mm256_blendv_pd(b, a, mask)
#define ROOTS_ARE(mask)          _mm256_movemask_pd(mask)
#define ROOTS_FIRST(count)                                                                                             \
    _mm256_castsi256_pd(_mm256_cmpgt_epi64(_mm256_set1_epi64x(count), _mm256_set_epi64x(3, 2, 1, 0)))
#define ROOTS_LOAD(mask, a)     _mm256_maskload_pd(a, _mm256_castpd_si256(mask))
#define ROOTS_STORE(mask, z, a) _mm256_maskstore_pd(z, _mm256_castpd_si256(mask), a)
#define ROOTS_BITS(a, bits)     _mm256_and_pd(a, _mm256_castsi256_pd(_mm256_set1_epi64x(bits)))

/* Near a^(-1/2): half of the exponent and of the mantissa make y, |e| < 0.069, and the polynomial of degree 2 that is
 * nearest to (1 - e)^(-1/2) the rest. Not so for subnormal numbers. */
JET_INLINE roots roots_estimate(roots a)
{
    const __m256i half = _mm256_srli_epi64(_mm256_castpd_si256(a), 1);
    const roots y = _mm256_castsi256_pd(_mm256_sub_epi64(_mm256_set1_epi64x(0x5fe6ea50c7b537a9), half));
    const roots e = _mm256_fnmadd_pd(a, y * y, _mm256_set1_pd(1));
    return y * 0.99999924 + (y * e) * (0.5011063 + e * 0.37629);
}
#endif

#endif
