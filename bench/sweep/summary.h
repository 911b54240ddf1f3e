/* summary.h - Declares the library against the baselines: for each scene and error the fastest of each, and the ratio
 * of their times. */
#ifndef SUMMARY_H
#define SUMMARY_H

#include "runs/report.h"

/* The name of the library's default method with generated code: a column of its own. */
#define COMPILED "compiled"

/* Four tables, printed and written to DIR/summary_*.md: by energy error and by position error, of all methods and of
 * the symplectic ones. The fastest are the cheapest runs of the sweep at or below the error, and are run again in turns
 * (run_in_turns) for the times. `list` ends with NULL; `only` of it, unless that is NULL. false: not written, which is
 * printed. */
bool summary_write(const report *r, const scene *const *list, const scene *only, const char *dir);

#endif
