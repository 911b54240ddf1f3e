/* tables.h - Declares what the tables of docs/stability.md are written with. */
#ifndef STABILITY_TABLES_H
#define STABILITY_TABLES_H

#include "hard_run.h"

#include <stdio.h>

typedef struct {
    const char *dir, *only_case; /* NULL: all cases */
} table_command;

/* DIR/name for writing; NULL where that fails, which is printed. */
FILE *table_open(const table_command *at, const char *name);
void table_progress(const char *what, const char *which);
/* A number of a table, a dash for NAN; returns text. */
const char *table_number(double x, const char *format, char text[32]);
void table_method(const hard_method *m, char text[32]);

/* large.md: one step that is far too large, against the solution. */
bool table_large(const table_command *at);
/* guard.md: which steps are refused, and which of them were right (ladder.h). */
bool table_guard(const table_command *at);

#endif
