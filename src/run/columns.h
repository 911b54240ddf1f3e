/* columns.h - Moves the tangent vectors of a run to the end of each step, and to the times where its observers are
 * called. run.c, times.c and locate.c call it. All functions do nothing if the columns have no D. */
#ifndef TVI_SRC_RUN_COLUMNS_H
#define TVI_SRC_RUN_COLUMNS_H

#include "run/tangent.h"

/* Stores the columns that a run begins with as those at the end of a step. */
void tvi_columns_begin(const tvi_integrator *integrator, const tvi_columns *columns);
/* Moves the columns by the integrator's last step. On failure the columns are as they were. */
TVI_NODISCARD tvi_status tvi_columns_step(const tvi_integrator *integrator, const tvi_columns *columns);
/* Sets the columns to those at `part` after the start of the last step, which was made with these parameters. On
 * failure the columns are those at the end of the step. */
TVI_NODISCARD tvi_status tvi_columns_show(const tvi_integrator *integrator, const tvi_columns *columns, double part,
                                          const double parameters[]);
/* Set the columns to those at the end or at the start of the last step. */
void tvi_columns_to_end(const tvi_integrator *integrator, const tvi_columns *columns);
void tvi_columns_to_start(const tvi_integrator *integrator, const tvi_columns *columns);
/* Tells whether the columns are those that the last step ended with, bit for bit. Then the columns inside of that step
 * can be computed. */
bool tvi_columns_have_last_step(const tvi_integrator *integrator, const tvi_columns *columns);

#endif
