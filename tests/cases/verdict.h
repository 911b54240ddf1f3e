/* verdict.h - Counts the rows of a case. Each row prints a line, and the last line says how many of them are right. */
#ifndef VERDICT_H
#define VERDICT_H

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>

static int row_count, right_count;

/* Prints a row: whether it is right, and what it is. */
#ifdef __GNUC__
__attribute__((format(printf, 2, 3)))
#endif
static void
row(bool is_right, const char *format, ...)
{
    va_list what;
    row_count++, right_count += is_right;
    printf("%s: ", is_right ? "right" : "wrong");
    va_start(what, format), vprintf(format, what), va_end(what);
    putchar('\n'), fflush(stdout);
}

/* Prints the last line, and returns the status of the program. */
static int verdict(void) { return printf("%d of %d right\n", right_count, row_count) < 0; }

#endif
