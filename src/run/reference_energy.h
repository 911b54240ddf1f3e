/* reference_energy.h - Declares the search for the zero from which the guard counts the energy of a member. The zero of
 * a potential is arbitrary, so |H| is no measure of the size of a motion. guard.c calls it. */
#ifndef TVI_SRC_RUN_REFERENCE_ENERGY_H
#define TVI_SRC_RUN_REFERENCE_ENERGY_H

#include "run/integrator.h"

/* Returns the energy of the member at q and p, arrays [components][width] of all members as in a tvi_run_state. It is
 * INFINITY if the energy overflows, and NAN if it is undefined. */
double tvi_member_energy_value(tvi_integrator *integrator, int member, const double *q, const double *p);

/* Sets the member's reference zero and scale at the state where its step starts. The state has the energy H, whose
 * roundoff is `roundoff`. */
void tvi_reference_energy_find(tvi_integrator *integrator, int member, double H, double roundoff);

/* Lowers the zero to the energy of the member at rest at the start of its step, if that is lower. A zero that is the
 * limit of the energy far away is kept. */
void tvi_reference_energy_lower(tvi_integrator *integrator, int member);

#endif
