/* integrand.h - Declares functions l(q, p, t) whose integral over the time is told along a run, and differentiated. */
#ifndef TVI_SRC_SYSTEM_INTEGRAND_H
#define TVI_SRC_SYSTEM_INTEGRAND_H

#include "system/system.h"

/* A function of the state of the stepped system, in N coordinates: l, or in a rescaled system l dt/ds. Its inputs are q
 * [N] and p [N], and then the time, which is no input of its own if it is one of the coordinates. */
typedef struct {
    jet_graph *graph;
    jet output;
    jet_tape *tape;
} tvi_integrand;

/* Records the user's function. On failure all members are NULL. */
TVI_NODISCARD tvi_status tvi_integrand_create(tvi_integrand *out, const tvi_system *system, tvi_event_fn *l, void *ctx);
void tvi_integrand_free(tvi_integrand *integrand);

#endif
