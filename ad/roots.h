/* roots.h - Defines vector operations for inverse square roots that start from an estimate; rule_power.c uses them.
 * Processors without AVX-512 have no such estimate in double precision, and roots and quotients are as fast there. */
#ifndef TVI_AD_ROOTS_H
#define TVI_AD_ROOTS_H

#include "devices.h"
#include "vector.h"

#if !(JET_WITHOUT & JET_DEVICE_ROOTS) && (defined(__AVX512VL__) || defined(JET_WIDE))
#include <immintrin.h>
#define HAS_ROOTS
#ifdef JET_WIDE
typedef __m512d roots_vector;
enum { ROOTS = 8 };
#define OF_ROOTS(name)      _mm512_##name
#define ROOTS_AND(a, bits)  _mm512_castsi512_pd(_mm512_and_si512(_mm512_castpd_si512(a), bits))
#define ROOTS_ALL_BITS(one) _mm512_set1_epi64(one)
#else
typedef __m256d roots_vector;
enum { ROOTS = 4 };
#define OF_ROOTS(name)      _mm256_##name
#define ROOTS_AND(a, bits)  _mm256_castsi256_pd(_mm256_and_si256(_mm256_castpd_si256(a), bits))
#define ROOTS_ALL_BITS(one) _mm256_set1_epi64x(one)
#endif
typedef __mmask8 roots_mask;
#define ROOTS_WHERE(a, is, b)    OF_ROOTS(cmp_pd_mask)(a, b, is)
#define ROOTS_CHOOSE(mask, a, b) OF_ROOTS(mask_blend_pd)(mask, b, a)
#define ROOTS_ARE(mask)          (mask)
#define ROOTS_FIRST(count)       ((roots_mask)((1 << (count)) - 1))
#define ROOTS_LOAD(mask, a)      OF_ROOTS(maskz_loadu_pd)(mask, a)
#define ROOTS_STORE(mask, z, a)  OF_ROOTS(mask_storeu_pd)(z, mask, a)
#define ROOTS_BITS(a, bits)      ROOTS_AND(a, ROOTS_ALL_BITS(bits))

/* Returns an estimate of a^(-1/2). */
JET_INLINE roots_vector estimate_inverse_roots(roots_vector a) { return OF_ROOTS(rsqrt14_pd)(a); }

#endif

#endif
