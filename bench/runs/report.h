/* report.h - Declares what the sweeps measured: rows of the CSV file, remarks, and tables of the fastest runs. */
#ifndef REPORT_H
#define REPORT_H

#include "run.h"

#include <stdio.h>

typedef struct {
    FILE *csv;
    run *rows; /* those that ended well */
    int count, capacity;
} report;

/* Compiler, flags, processor and command, in comments. */
void report_head(FILE *csv, int argc, char *const argv[]);
/* Opens DIR/work_precision.csv, making DIR, and writes its head; false where that fails, which is printed. */
bool report_open(report *r, const char *dir, int argc, char *const argv[]);
void report_scene(report *r, const scene *s); /* a comment: name, title, unit of time */
bool report_row(report *r, const run *row);   /* false: out of memory */
/* A comment, also on stderr. */
void report_remark(report *r, const char *format, ...) __attribute__((format(printf, 2, 3)));
bool report_close(report *r); /* false: the file is not written, which is printed */

/* The fastest run of the scene with an error of at most bound among those chosen; NULL: there is none. */
typedef double report_error(const run *row);
typedef bool report_choice(const run *row, const void *ctx);
const run *report_fastest(const report *r, const scene *s, report_error *error, double bound, report_choice *chosen,
                          const void *ctx);
double report_position_error(const run *row);
double report_energy_error(const run *row);
bool report_is_named(const run *row, const void *name);

/* A table of the fastest run of each method: a line for each scene and position error, "order (h) ms" in each cell. */
void report_methods_head(const char *const names[], int count, FILE *out);
void report_methods(const report *r, const scene *s, const char *const names[], int count, FILE *out);

#endif
