/* rounded.h - Declares the control: Gauss collocation with 8 nodes on M q'' = F(q), compensated sums, and nothing else
 * against a drift. Its coefficients (a a)_ij, b_i and c_i are each rounded for itself, so that the condition of
 * symplecticity holds to roundoff only, and its passes end where the next one is expected to move nothing. */
#ifndef LONGRUN_ROUNDED_H
#define LONGRUN_ROUNDED_H

#include "tvi.h"

typedef struct rounded rounded;

/* Serves a potential or a force without time. NULL: no memory. */
rounded *rounded_create(const tvi_system *system, double h);
void rounded_free(rounded *r);
/* The low-order parts are carried on from call to call. TVI_ENOCONV, TVI_EDOMAIN. */
TVI_NODISCARD tvi_status rounded_run(rounded *r, long steps, double q[], double p[]);

#endif
