/* columns.h - the tangent vectors of a run: those at the end of each step, and those where its observers are called.
 * Everything here does nothing where the columns have no D. */
#ifndef TVI_SRC_RUN_COLUMNS_H
#define TVI_SRC_RUN_COLUMNS_H

#include "run/tangent.h"

/* Keeps the columns that a run begins with, as those at the end of a step. */
void tvi_columns_begin(const tvi_integrator *integrator, const tvi_columns *columns);
/* Moves the columns by the integrator's last step. On failure the columns are as they were. */
TVI_NODISCARD tvi_status tvi_columns_step(const tvi_integrator *integrator, const tvi_columns *columns);
/* Makes the columns those at `part` after the start of the last step, which was made with these parameters. On failure
 * the columns are those at its end. */
TVI_NODISCARD tvi_status tvi_columns_show(const tvi_integrator *integrator, const tvi_columns *columns, double part,
                                          const double parameters[]);
/* Makes the columns those at the end of the last step, and at its start. */
void tvi_columns_to_end(const tvi_integrator *integrator, const tvi_columns *columns);
void tvi_columns_to_start(const tvi_integrator *integrator, const tvi_columns *columns);
/* Whether the columns are those that the last step ended with, bit for bit, so that the columns inside of it are
 * known, too. */
bool tvi_columns_have_last_step(const tvi_integrator *integrator, const tvi_columns *columns);

#endif
