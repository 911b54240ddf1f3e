#include "report.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#ifndef BENCH_CFLAGS
#define BENCH_CFLAGS "unknown"
#endif
#if defined(__clang__)
#define COMPILER __VERSION__
#else
#define COMPILER "gcc " __VERSION__
#endif

/* ---- The file ------------------------------------------------------------------------------------------------------ */

static void write_processor(FILE *csv)
{
    char line[512], name[512] = "unknown";
    FILE *cpu = fopen("/proc/cpuinfo", "r");
    while (cpu && fgets(line, sizeof line, cpu))
        if (sscanf(line, "model name : %511[^\n]", name) == 1) break;
    if (cpu) fclose(cpu);
    fprintf(csv, "# processor: %s\n", name);
}

bool report_open(report *r, const char *dir, int argc, char *const argv[])
{
    *r = (report){0};
    char path[4096];
    if (snprintf(path, sizeof path, "%s/work_precision.csv", dir) < (int)sizeof path &&
        (mkdir(dir, 0777) == 0 || errno == EEXIST))
        r->csv = fopen(path, "w");
    if (!r->csv) {
        fprintf(stderr, "bench: cannot write %s/work_precision.csv: %s\n", dir, strerror(errno));
        return false;
    }
    fprintf(r->csv, "# compiler: %s\n# flags: %s\n", COMPILER, BENCH_CFLAGS);
    write_processor(r->csv);
    fprintf(r->csv, "# command:");
    for (int i = 0; i < argc; i++) fprintf(r->csv, " %s", argv[i]);
    fprintf(r->csv,
            "\n# cpu_s: the fastest of several repetitions on one thread, without making the system and the integrator"
            "\n# max_rel_energy_error: over all steps, or over %d or more evenly spaced ones\n", RUN_SAMPLES);
    fprintf(r->csv, "scene,method,order,degree,h,steps,cpu_s,ns_per_step,max_rel_energy_error,end_error,position_error,"
                    "force_evals,passes_per_step\n");
    return true;
}

void report_scene(report *r, const scene *s)
{
    fprintf(r->csv, "# scene %s: %s; time unit: %s\n", s->name, s->title, s->time_unit);
}

static bool keep(report *r, const run *row)
{
    if (r->count == r->capacity) {
        int capacity = 2 * r->capacity + 256;
        run *rows = realloc(r->rows, (size_t)capacity * sizeof *rows);
        if (!rows) return false;
        r->rows = rows;
        r->capacity = capacity;
    }
    r->rows[r->count++] = *row;
    return true;
}

bool report_row(report *r, const run *row)
{
    const double steps = (double)row->steps;
    fprintf(r->csv, "%s,%s,%d,%d,%.10g,%ld,%.4e,%.1f,%.4e,%.4e,%.4e,%ld,%.4g\n", row->scene->name, row->method, row->order,
            row->degree, row->h, row->steps, row->cpu, 1e9 * row->cpu / steps, row->energy_error, row->end_error,
            row->position_error, row->force_evaluations, row->passes_per_step);
    fflush(r->csv);
    return keep(r, row);
}

void report_remark(report *r, const char *format, ...)
{
    va_list arguments;
    char text[512];
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    fprintf(r->csv, "# %s\n", text);
    fprintf(stderr, "      %s\n", text);
}

bool report_close(report *r)
{
    free(r->rows);
    const bool written = !ferror(r->csv);
    if (fclose(r->csv) == 0 && written) return true;
    perror("bench: work_precision.csv");
    return false;
}

/* ---- The table ----------------------------------------------------------------------------------------------------- */

static double position_error(const run *row) { return row->position_error; }
static double energy_error(const run *row) { return row->energy_error; }

/* The columns of the table: midpoint, the other variational methods, and the explicit Taylor method, which is not
 * symplectic. */
enum { MIDPOINT, VARIATIONAL, TAYLOR, GROUPS };
static const struct {
    const char *title;
    int width;
} groups[GROUPS] = {{"fastest midpoint (h)", 31}, {"other variational (h)", 28}, {"taylor (h)", 20}};

static int group_of(const run *row)
{
    if (strncmp(row->method, "midpoint", 8) == 0) return MIDPOINT;
    return strcmp(row->method, "taylor") == 0 ? TAYLOR : VARIATIONAL;
}

/* The fastest run of the scene in the group with an error of at most bound; NULL: there is none. */
static const run *fastest(const report *r, const scene *s, double error(const run *), double bound, int group)
{
    const run *best = NULL;
    for (const run *row = r->rows; row < r->rows + r->count; row++)
        if (row->scene == s && group_of(row) == group && error(row) <= bound && (!best || row->cpu < best->cpu))
            best = row;
    return best;
}

static void print_entry(const run *row, int width)
{
    char text[64] = "-", time[32] = "-";
    if (row) {
        snprintf(text, sizeof text, "%s %d (%.4g)", row->method, row->order, row->h);
        snprintf(time, sizeof time, "%.3f", 1e3 * row->cpu);
    }
    printf("  %-*s%9s", width, text, time);
}

/* One line a bound. ratio: time of the fastest of all others / time of midpoint, so that below 1 midpoint loses. */
static void print_half(const report *r, const scene *s, const char *title, double error(const run *))
{
    static const double bounds[] = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12};
    printf("  %-8s", title);
    for (int g = 0; g < GROUPS; g++) printf("  %-*s%9s", groups[g].width, groups[g].title, "ms");
    printf("   ratio\n");
    for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++) {
        const run *best[GROUPS], *other = NULL;
        printf("  %-8.0e", bounds[i]);
        for (int g = 0; g < GROUPS; g++) {
            best[g] = fastest(r, s, error, bounds[i], g);
            print_entry(best[g], groups[g].width);
            if (g != MIDPOINT && best[g] && (!other || best[g]->cpu < other->cpu)) other = best[g];
        }
        if (best[MIDPOINT] && other) printf("%8.2f", other->cpu / best[MIDPOINT]->cpu);
        printf("\n");
    }
}

void report_table(const report *r, const scene *s)
{
    printf("\n%s: %s\n", s->name, s->title);
    print_half(r, s, "position", position_error);
    print_half(r, s, "energy", energy_error);
    fflush(stdout);
}
