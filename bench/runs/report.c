/* report.c - Writes the results of sweeps (report.h). */
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

/* ---- The file ---------------------------------------------------------------------------------------------------- */

static void write_processor(FILE *csv)
{
    char line[512], name[512] = "unknown";
    FILE *cpu = fopen("/proc/cpuinfo", "r");
    while (cpu && fgets(line, sizeof line, cpu))
        if (sscanf(line, "model name : %511[^\n]", name) == 1) break;
    if (cpu) fclose(cpu);
    fprintf(csv, "# processor: %s\n", name);
}

void report_head(FILE *csv, int argc, char *const argv[])
{
    fprintf(csv, "# compiler: %s\n# flags: %s\n", COMPILER, BENCH_CFLAGS);
    write_processor(csv);
    fprintf(csv, "# command:");
    for (int i = 0; i < argc; i++) fprintf(csv, " %s", argv[i]);
    fprintf(csv, "\n");
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
    report_head(r->csv, argc, argv);
    fprintf(r->csv,
            "# cpu_s: the fastest of several repetitions on one thread, without making the system and the integrator"
            "\n# max_rel_energy_error: over all steps, or over %d or more evenly spaced ones\n",
            RUN_SAMPLES);
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
    fprintf(r->csv, "%s,%s,%d,%d,%.10g,%ld,%.4e,%.1f,%.4e,%.4e,%.4e,%ld,%.4g\n", row->scene->name, row->method,
            row->order, row->degree, row->h, row->steps, row->cpu, 1e9 * row->cpu / steps, row->energy_error,
            row->end_error, row->position_error, row->force_evaluations, row->passes_per_step);
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

/* ---- Tables ------------------------------------------------------------------------------------------------------ */

const run *report_fastest(const report *r, const scene *s, report_error *error, double bound, report_choice *chosen,
                          const void *ctx)
{
    const run *best = NULL;
    for (const run *row = r->rows; row < r->rows + r->count; row++)
        if (row->scene == s && error(row) <= bound && (!best || row->cpu < best->cpu) && chosen(row, ctx)) best = row;
    return best;
}

double report_position_error(const run *row) { return row->position_error; }
double report_energy_error(const run *row) { return row->energy_error; }

bool report_is_named(const run *row, const void *name) { return strcmp(row->method, name) == 0; }

void report_methods(const report *r, const scene *s, const char *const names[], int count, FILE *out)
{
    static const double bounds[] = {1e-4, 1e-8};
    for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++) {
        fprintf(out, "| %s | %.0e |", s->name, bounds[i]);
        for (int k = 0; k < count; k++) {
            const run *row = report_fastest(r, s, report_position_error, bounds[i], report_is_named, names[k]);
            if (row) fprintf(out, " %d (%.4g) %.3g |", row->order, row->h, 1e3 * row->cpu);
            else fprintf(out, " - |");
        }
        fprintf(out, "\n");
    }
}

void report_methods_head(const char *const names[], int count, FILE *out)
{
    fprintf(out, "| scene | position error |");
    for (int k = 0; k < count; k++) fprintf(out, " %s |", names[k]);
    fprintf(out, "\n|---|---|");
    for (int k = 0; k < count; k++) fprintf(out, "---|");
    fprintf(out, "\n");
}
