/* bench.c - the order sweep: every scene, method and order over the scene's ladder of steps, within a budget of time.
 *
 *   bench [--scene NAME] [--out DIR] [--budget SECONDS]
 */
#include "report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* "midpoint-truncated" is no named method of the library: it shows what the on-curve nodes of "midpoint" are worth. */
static const struct {
    const char *name;
    int last_order;
} methods[] = {{"midpoint", 20}, {"midpoint-truncated", 20}, {"start", 20},
             {"tvi", 20},      {"taylor", 20},             {"stormer-verlet", 2}};
enum { METHODS = sizeof methods / sizeof *methods, HIGHEST_ORDER = 20 };

static tvi_status method_options(const char *name, int order, tvi_options *options)
{
    if (strcmp(name, "midpoint-truncated") != 0) return tvi_options_named(name, order, options);
    *options = (tvi_options){
        .method = TVI_TYPE1, .expansion = TVI_AT_MIDPOINT, .nodes = TVI_NODES_TRUNCATED, .order = order};
    return TVI_OK;
}

/* ---- The budget ---------------------------------------------------------------------------------------------------- */

typedef struct {
    report report;
    double begin, budget; /* wall-clock seconds */
    double scene_end;     /* when the scene must be over */
    long failed, skipped; /* runs of the scene */
} bench;

static double wall_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* One of `left` equal shares of the time until `end`; what one does not use goes to those after it. */
static double share(double end, int left) { return (end - wall_clock()) / left; }

/* ---- One method and order ------------------------------------------------------------------------------------------ */

/* Whether a ladder has reached roundoff: the error is small and did not fall as h^order says, even to the square root. */
static bool at_roundoff(const run *before, const run *row)
{
    double size = 0;
    for (int i = 0; i < 2 * row->scene->n; i++) size = fmax(size, fabs(row->scene->reference[i]));
    return row->end_error < 1e-9 * size && row->end_error > before->end_error * pow(row->h / before->h, row->order / 2.0);
}

static void remark_skip(bench *b, const scene *s, const char *method, int order, const double *h, double cost, double left)
{
    report_remark(&b->report, "skipped: %s %s %d from h = %.4g down: %.2f s expected, %.2f s left", s->name, method, order,
                  *h, cost, fmax(left, 0));
    for (; *h > 0; h++) b->skipped++;
}

/* The ladder of one method until its end, roundoff, or `end`; returns why it ended. */
static const char *descend(bench *b, const tvi_system *system, const scene *s, const char *method,
                           const tvi_options *options, double end)
{
    const int first = b->report.count;
    for (const double *h = s->steps; *h > 0; h++) {
        run row;
        const double cost = run_predict(system, s, options, *h), left = end - wall_clock();
        if (cost > left) {
            remark_skip(b, s, method, options->order, h, cost, left);
            return "budget";
        }
        run_measure(system, s, options, *h, &row);
        row.method = method;
        if (row.status != TVI_OK) {
            b->failed++;
            report_remark(&b->report, "failed: %s %s %d h = %.4g in step %ld of %ld: %s", s->name, method, options->order,
                          *h, row.failed_step, row.steps, tvi_status_string(row.status));
            continue;
        }
        if (!report_row(&b->report, &row)) return "out of memory";
        if (b->report.count > first + 1 && at_roundoff(b->report.rows + b->report.count - 2, &row)) return "roundoff";
    }
    return "end of the ladder";
}

static void sweep_order(bench *b, const tvi_system *system, const scene *s, const char *method, int order, double end)
{
    tvi_options options;
    const char *why = "no such order";
    const int first = b->report.count;
    if (method_options(method, order, &options) != TVI_OK || tvi_options_check(system, &options, &why) != TVI_OK) {
        report_remark(&b->report, "refused: %s %s %d: %s", s->name, method, order, why);
        return;
    }
    why = descend(b, system, s, method, &options, end);
    fprintf(stderr, "%3.0f%%  %-16s%-19s%2d", 100 * (wall_clock() - b->begin) / b->budget, s->name, method, order);
    if (b->report.count > first) {
        const run *from = b->report.rows + first, *to = b->report.rows + b->report.count - 1;
        fprintf(stderr, "  h %-8.4g to %-9.4g error %-8.1e to %-8.1e", from->h, to->h, from->end_error, to->end_error);
    }
    fprintf(stderr, "  (%s)\n", why);
}

/* ---- One scene ----------------------------------------------------------------------------------------------------- */

/* High orders first: they end at roundoff, and what they leave of their shares goes to the low ones with many steps. */
static void sweep_scene(bench *b, const tvi_system *system, const scene *s)
{
    int left = 0;
    for (int i = 0; i < METHODS; i++) left += methods[i].last_order / 2;
    for (int order = HIGHEST_ORDER; order >= 2; order -= 2)
        for (int i = 0; i < METHODS; i++)
            if (order <= methods[i].last_order)
                sweep_order(b, system, s, methods[i].name, order, wall_clock() + share(b->scene_end, left--));
}

static bool bench_scene(bench *b, const scene *s, int scenes_left)
{
    tvi_system *system;
    const tvi_status status = tvi_system_potential(&system, s->n, s->mass, s->potential, NULL);
    if (status != TVI_OK) {
        report_remark(&b->report, "failed: %s: %s", s->name, tvi_status_string(status));
        return false;
    }
    b->failed = b->skipped = 0;
    b->scene_end = wall_clock() + share(b->begin + b->budget, scenes_left);
    report_scene(&b->report, s);
    sweep_scene(b, system, s);
    report_remark(&b->report, "%s: %ld runs failed, %ld were skipped", s->name, b->failed, b->skipped);
    tvi_system_free(system);
    return true;
}

/* ---- The command --------------------------------------------------------------------------------------------------- */

/* OpenBLAS reads its number of threads when it is loaded: start again with one. */
static void insist_on_one_thread(char *const argv[])
{
    const char *threads = getenv("OPENBLAS_NUM_THREADS");
    if (threads && strcmp(threads, "1") == 0) return;
    if (setenv("OPENBLAS_NUM_THREADS", "1", 1) == 0) execv("/proc/self/exe", argv);
    perror("bench: cannot restart with OPENBLAS_NUM_THREADS=1");
    exit(EXIT_FAILURE);
}

static int usage(void)
{
    fprintf(stderr, "usage: bench [--scene NAME] [--out DIR] [--budget SECONDS]\nscenes:");
    for (const scene *const *s = scenes; *s; s++) fprintf(stderr, " %s", (*s)->name);
    fprintf(stderr, "\n");
    return EXIT_FAILURE;
}

int main(int argc, char *argv[])
{
    insist_on_one_thread(argv);
    const scene *only = NULL;
    const char *dir = ".";
    bench b = {.begin = wall_clock(), .budget = 270};
    for (int i = 1; i < argc; i += 2) {
        if (i + 1 == argc) return usage();
        if (strcmp(argv[i], "--scene") == 0 && (only = scene_find(argv[i + 1]))) continue;
        if (strcmp(argv[i], "--out") == 0 && (dir = argv[i + 1])) continue;
        if (strcmp(argv[i], "--budget") == 0 && (b.budget = strtod(argv[i + 1], NULL)) > 0) continue;
        return usage();
    }
    if (!report_open(&b.report, dir, argc, argv)) return EXIT_FAILURE;
    bool good = true;
    int left = 0;
    for (const scene *const *s = scenes; *s; s++) left++;
    for (const scene *const *s = scenes; *s; s++, left--)
        if (!only || *s == only) good &= bench_scene(&b, *s, only ? 1 : left);
    for (const scene *const *s = scenes; *s; s++)
        if (!only || *s == only) report_table(&b.report, *s);
    return report_close(&b.report) && good ? EXIT_SUCCESS : EXIT_FAILURE;
}
