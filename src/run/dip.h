/* dip.h - Decides whether a function whose size has a dip between two points becomes 0 there. search.c calls it. */
#ifndef TVI_SRC_RUN_DIP_H
#define TVI_SRC_RUN_DIP_H

#include <stdbool.h>

/* A value of g, and the theta where g has it. */
typedef struct {
    double at, g;
} tvi_dip_point;

/* Five points. The three in the middle have one sign of g, x[1] < x[2] < x[3], and |g| is least at x[2]. x[0] and x[4]
 * lie farther out, or are missing, with NAN for g. */
enum { TVI_DIP = 5 };

/* Sets *at to the next abscissa to sample, after `looks` samples. Returns false if g is known to have no zero between
 * x[1] and x[3]. */
bool tvi_dip_next(const tvi_dip_point x[TVI_DIP], int looks, double *at);
/* Inserts a point with the same sign of g, in the middle of the three or at an end of them. */
void tvi_dip_insert(tvi_dip_point x[TVI_DIP], tvi_dip_point found);

#endif
