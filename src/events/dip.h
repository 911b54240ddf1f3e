/* dip.h - Decides whether a function g of one variable has a zero near a dip, that is a local minimum of |g| between
 * samples of one sign. search.c calls it with event functions g(theta), where theta is the part of a step. */
#ifndef TVI_EVENTS_DIP_H
#define TVI_EVENTS_DIP_H

#include <stdbool.h>

/* [eps] A change of g by fewer units of roundoff of its terms has no certain sign, and ends the search of a dip. */
#define EVENT_ROUNDOFF_UNITS 64.0 /* found: make check-events */

/* A sample of an event function: the value g at the abscissa theta. */
typedef struct {
    double theta, g;
} tvi_event_sample;

/* A dip is described by an array of five samples, in the order of theta. At dip[1], dip[2] and dip[3] g has one sign,
 * and |g| is smallest at dip[2]. The outer samples dip[0] and dip[4] may be missing; their g is NAN then. */
enum { TVI_DIP_SAMPLES = 5 };

/* Tells whether the search needs another sample of g after sample_count samples, and sets *theta to the abscissa of
 * that sample. The result is false if the search ends: g has no zero between dip[1] and dip[3], or only one that
 * roundoff would hide. */
bool tvi_dip_needs_another_sample(const tvi_event_sample dip[TVI_DIP_SAMPLES], int sample_count, double *theta);
/* Inserts a new sample, whose g has the sign of dip[2].g. It becomes dip[2] or one of its neighbours. */
void tvi_dip_insert_sample(tvi_event_sample dip[TVI_DIP_SAMPLES], tvi_event_sample sample);

#endif
