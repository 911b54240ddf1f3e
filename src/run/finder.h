/* finder.h - Finds the time and the state of an event, from a root that the search has bracketed. locate.c calls it. */
#ifndef TVI_SRC_RUN_FINDER_H
#define TVI_SRC_RUN_FINDER_H

#include "run/search.h"
#include "system/rates.h"

/* The work of a finder. States are [2n + 1]: q, p, t. */
typedef struct {
    tvi_search *search;
    tvi_rates rates;       /* of the field */
    int size;              /* of a state */
    double *base, base_at; /* state of the last partial step, and its theta */
    /* The slope of the line from `base`, and the distance over which the line is accurate. */
    double *rate, reach;
    double *middle;   /* the state on the curve where `rate` was measured */
    bool is_inside;   /* `rate` was measured clear of the ends of the step */
    bool is_enclosed; /* the root is on the last line */
    double *trial;
} tvi_finder;

TVI_NODISCARD tvi_status tvi_finder_open(tvi_finder *finder, tvi_search *search);
void tvi_finder_close(tvi_finder *finder);

/* Finds an event of the last step to roundoff: root->theta, and its state x [2n + 1]. Sets root->is_none if g changes
 * its sign on the curve alone, as where it nearly touches 0. */
TVI_NODISCARD tvi_status tvi_finder_find(tvi_finder *finder, tvi_root *root, double x[]);

/* Tells whether g has the sign after the root, or is 0. */
static inline bool tvi_is_behind(const tvi_root *root, double g) { return root->sign_after > 0 ? g >= 0 : g <= 0; }

#endif
