/* columns.h - Multiplies all columns of D by the Jacobian matrix of a step at once, by steps of lifted systems that
 * keep the history of their steps (docs/method.md section 10). tangent.c calls it. */
#ifndef TVI_INTEGRATOR_COLUMNS_H
#define TVI_INTEGRATOR_COLUMNS_H

#include "integrator/integrator.h"

typedef struct tvi_columns_at_once tvi_columns_at_once;

/* Tells whether columns of this system and method can be moved at once. */
bool tvi_at_once_serves(const tvi_integrator *integrator);
/* Refuses a system or a method whose columns cannot. */
TVI_NODISCARD tvi_status tvi_at_once_check(const tvi_integrator *integrator);
/* Gives *at_once memory for D [2n + parameters][count], and counts it in the integrator's. Columns of the same number
 * that move no other parameters keep their memory and their history. On failure *at_once is NULL. */
TVI_NODISCARD tvi_status tvi_at_once_provide(tvi_columns_at_once **at_once, tvi_integrator *integrator, int count,
                                             const double D[]);
void tvi_at_once_free(tvi_columns_at_once *at_once);

/* Multiplies the matrix start [2n + parameters][count] by the Jacobian matrix of the integrator's last step. Rows of
 * the parameters are not written. goes_on says that `start` is what the step before was multiplied to; the history of
 * the lifted steps then goes on. On failure `product` is undefined. */
TVI_NODISCARD tvi_status tvi_at_once_multiply(tvi_columns_at_once *at_once, const tvi_integrator *integrator,
                                              const double start[], bool goes_on, double product[]);
/* Does so for the part of the last step up to the offset from its start. The step was made with these parameters. */
TVI_NODISCARD tvi_status tvi_at_once_multiply_by_part(tvi_columns_at_once *at_once, const tvi_integrator *integrator,
                                                      const double start[], const double parameters[], double offset,
                                                      double product[]);

#endif
