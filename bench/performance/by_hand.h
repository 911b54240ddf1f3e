/* by_hand.h - Declares the series of baselines/series_by_hand.h compiled with the library's own flags, once for each of
 * its instruction sets. */
#ifndef BY_HAND_H
#define BY_HAND_H

#include "baselines/series_by_hand.h"

/* From the coefficients 0 and 1 of q in the unit tau: (k+1)(k+2) q_{k+2} = tau^2 a_k, k = 0..N-2. */
typedef struct {
    void (*kepler)(int N, double tau, const power_weights *weights, kepler_series *c);
    void (*solar)(int N, double tau, const power_weights *weights, solar_series *c);
} by_hand;

/* The build gives those of an instruction set its suffix. */
extern const by_hand series_by_hand;
#ifdef JET_ISA_X86
extern const by_hand series_by_hand_avx2, series_by_hand_avx512;
#endif

#endif
