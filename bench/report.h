/* report.h - what the sweep measured: rows of the CSV file, remarks, and the table of the fastest runs. */
#ifndef REPORT_H
#define REPORT_H

#include "run.h"

#include <stdio.h>

typedef struct {
    FILE *csv;
    run *rows; /* those that ended well */
    int count, capacity;
} report;

/* Opens DIR/work_precision.csv, making DIR, and writes its head; false where that fails, which is printed. */
bool report_open(report *r, const char *dir, int argc, char *const argv[]);
void report_scene(report *r, const scene *s);   /* a comment: name, title, unit of time */
bool report_row(report *r, const run *row);     /* false: out of memory */
/* A comment, also on stderr. */
void report_remark(report *r, const char *format, ...) __attribute__((format(printf, 2, 3)));
void report_table(const report *r, const scene *s);
bool report_close(report *r);                   /* false: the file is not written, which is printed */

#endif
