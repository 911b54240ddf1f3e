/* rows.h - Declares the rows of make compare-with: the same steps from the same start, by public calls alone, so that
 * the library of an older commit can be linked, too. */
#ifndef ROWS_H
#define ROWS_H

#include "tvi.h"

typedef struct work work; /* what a row needs to run */

int rows_count(void);
const char *row_group(int row);
const char *row_title(int row);
/* The ensembles of one system and method, and the integrators that they stand beside, have the same set; others have
 * one of their own. */
int row_set(int row);

/* Opens the row; generated code is kept in the folder "generated". Statuses are those of the calls of the library, and
 * *out is NULL on failure. */
TVI_NODISCARD tvi_status row_open(work **out, int row);
/* Makes the row's steps from its start. The status is that of the first member that failed. */
TVI_NODISCARD tvi_status row_run(work *w);
long row_steps(const work *w); /* of all members in one run */
void row_close(work *w);

#endif
