/* gauss_recorded.h - Declares the Gauss collocation of bench/baselines on the force that the library has recorded, so
 * that every system with a force has it. Its times are worth nothing. */
#ifndef STABILITY_GAUSS_RECORDED_H
#define STABILITY_GAUSS_RECORDED_H

#include "baselines/baseline.h"

/* Does what baseline.run does, with order 4, 6, ... 16. It is not for several threads. */
tvi_status gauss_recorded(const tvi_system *system, int order, const baseline_task *task, double q[], double p[],
                          baseline_counts *counts);

#endif
