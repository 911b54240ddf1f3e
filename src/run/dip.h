/* dip.h - whether a function whose size has a least value between places is 0 there. */
#ifndef TVI_SRC_RUN_DIP_H
#define TVI_SRC_RUN_DIP_H

#include <stdbool.h>

/* A value of g, and where. */
typedef struct {
    double at, g;
} tvi_place;

/* Five places, of one sign of g in the three in the middle, x[1] < x[2] < x[3], of which |g| is least at x[2]; x[0] and
 * x[4] lie farther out, or are nowhere, with g a NAN. */
enum { TVI_DIP = 5 };

/* The next place to look at, after so many looks; false where g is known to have no zero between x[1] and x[3]. */
bool tvi_dip_next(const tvi_place x[TVI_DIP], int looks, double *at);
/* Puts what was found there, of the same sign, in the middle of the three, or at an end of them. */
void tvi_dip_take(tvi_place x[TVI_DIP], tvi_place found);

#endif
