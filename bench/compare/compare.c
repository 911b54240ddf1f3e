/* compare.c - Runs the rows of rows.h with the library that it is linked with. compare.py starts it, once for each of
 * two libraries, in a folder for each.
 *
 *   compare list PATTERN  lists the rows that an extended regular expression matches: number, set, group, title
 *   compare count ROW     runs the row once, and then in measured_run, which callgrind counts; prints how many steps
 *                         that are, or why the row is refused
 *   compare serve         answers lines of the input: "open ROW", and "time ROW" of a row that is open */
#include "rows.h"

#include <regex.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static int list(const char *pattern)
{
    regex_t compiled;
    if (regcomp(&compiled, pattern, REG_EXTENDED | REG_ICASE | REG_NOSUB) != 0) {
        fprintf(stderr, "ROWS is no extended regular expression: %s\n", pattern);
        return EXIT_FAILURE;
    }
    for (int row = 0; row < rows_count(); row++) {
        char name[128];
        snprintf(name, sizeof name, "%s: %s", row_group(row), row_title(row));
        if (regexec(&compiled, name, 0, NULL, 0) == 0)
            printf("%d\t%d\t%s\t%s\n", row, row_set(row), row_group(row), row_title(row));
    }
    regfree(&compiled);
    return EXIT_SUCCESS;
}

static void print_refusal(tvi_status status)
{
    const char *text = tvi_last_error();
    printf("refused %s%s%s\n", tvi_status_string(status), *text ? ": " : "", text);
}

/* The function that callgrind --toggle-collect counts. */
__attribute__((noinline)) tvi_status measured_run(work *w);
tvi_status measured_run(work *w) { return row_run(w); }

static void count(int row)
{
    work *w;
    tvi_status status = row_open(&w, row);
    if (status == TVI_OK) status = row_run(w);
    if (status == TVI_OK) status = measured_run(w);
    if (status == TVI_OK) printf("%ld\n", row_steps(w));
    else print_refusal(status);
    row_close(w);
}

/* ---- Times ------------------------------------------------------------------------------------------------------- */

/* A turn is long beside the resolution of the clock, and what went before it leaves nothing in the caches. */
static const double WARMING = 2e-4, TURN = 1e-3;

static double cpu_time(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Returns s of a run: the mean over at least so many seconds. */
static double time_for(work *w, double seconds)
{
    const double begin = cpu_time();
    double now;
    long runs = 0;
    do {
        if (row_run(w) != TVI_OK) abort(); /* the same run succeeded when the row was opened */
        runs++;
        now = cpu_time();
    } while (now - begin < seconds);
    return (now - begin) / (double)runs;
}

static void open(int row, work **w)
{
    tvi_status status = row_open(w, row);
    if (status == TVI_OK) status = row_run(*w);
    if (status == TVI_OK) printf("ok\n");
    else print_refusal(status);
}

/* Answers ns of a step. */
static void answer_time(work *w)
{
    (void)time_for(w, WARMING);
    printf("%.9g\n", 1e9 * time_for(w, TURN) / (double)row_steps(w));
}

static int serve(void)
{
    work **opened = calloc((size_t)rows_count(), sizeof *opened);
    char verb[8];
    int row;
    if (!opened) return EXIT_FAILURE;
    while (scanf("%7s %d", verb, &row) == 2 && row >= 0 && row < rows_count()) {
        if (strcmp(verb, "open") == 0) open(row, &opened[row]);
        if (strcmp(verb, "time") == 0 && opened[row]) answer_time(opened[row]);
        fflush(stdout);
    }
    for (row = 0; row < rows_count(); row++) row_close(opened[row]);
    free(opened);
    return EXIT_SUCCESS;
}

int main(int argc, char *argv[])
{
    if (argc == 3 && strcmp(argv[1], "list") == 0) return list(argv[2]);
    if (argc == 2 && strcmp(argv[1], "serve") == 0) return serve();
    const int row = argc == 3 && strcmp(argv[1], "count") == 0 ? atoi(argv[2]) : -1;
    if (row >= 0 && row < rows_count()) return count(row), EXIT_SUCCESS;
    fprintf(stderr, "usage: compare list PATTERN | count ROW | serve\n");
    return EXIT_FAILURE;
}
