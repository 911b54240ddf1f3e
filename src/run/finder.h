/* finder.h - the time and the state of an event, of which the search knows about where it is. */
#ifndef TVI_SRC_RUN_FINDER_H
#define TVI_SRC_RUN_FINDER_H

#include "run/search.h"
#include "system/rates.h"

/* States are [2n + 1]: q, p, t. */
typedef struct {
    tvi_search *search;
    tvi_rates rates;       /* of the field */
    int size;              /* of a state */
    double *base, base_at; /* the last step of a part of h, and where */
    double *rate, reach;   /* the slope that leads on from it, and how far */
    double *middle;        /* the state on the curve where it was taken: */
    bool is_inside;        /* clear of the ends of the step */
    bool is_enclosed;      /* the last line has the root */
    double *trial;
} tvi_finder;

TVI_NODISCARD tvi_status tvi_finder_open(tvi_finder *finder, tvi_search *search);
void tvi_finder_close(tvi_finder *finder);

/* An event of the last step: root->theta, and its state x [2n + 1], to roundoff; or root->is_none, where g changes its
 * sign on the curve alone, as where it nearly touches 0. */
TVI_NODISCARD tvi_status tvi_finder_find(tvi_finder *finder, tvi_root *root, double x[]);

/* Whether g has the sign behind the root, or is 0. */
static inline bool tvi_is_behind(const tvi_root *root, double g) { return root->after > 0 ? g >= 0 : g <= 0; }

#endif
