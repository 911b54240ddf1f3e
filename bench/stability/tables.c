/* tables.c - Formats numbers and names for the tables of docs/stability.md (tables.h). */
#include "tables.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <time.h>

FILE *table_open(const table_command *at, const char *name)
{
    char path[4096];
    FILE *file = NULL;
    if (snprintf(path, sizeof path, "%s/%s", at->dir, name) < (int)sizeof path) file = fopen(path, "w");
    if (!file) fprintf(stderr, "stability: cannot write %s/%s: %s\n", at->dir, name, strerror(errno));
    return file;
}

void table_progress(const char *what, const char *which)
{
    fprintf(stderr, "%6.1f s  %s %s\n", (double)clock() / CLOCKS_PER_SEC, what, which);
}

/* A number of a table: a dash where there is none. */
const char *table_number(double x, const char *format, char text[32])
{
    if (isnan(x)) strcpy(text, "-");
    else snprintf(text, 32, format, x);
    return text;
}

void table_method(const hard_method *m, char text[32])
{
    snprintf(text, 32, "%s%s", m->name, m->composed ? " composed" : "");
}
