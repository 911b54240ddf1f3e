/* roots.h - vectors whose inverse roots are had from an estimate (rule_power.c). Narrower ones have none in double
 * precision, and their roots and quotients take no longer. */
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

#endif

#endif
