/* summary.c - Compares the library with the baselines, for each scene and error (summary.h). */
#include "summary.h"

#include <errno.h>
#include <string.h>

/* The errors of a table, 0 ends. */
static const double energy_errors[] = {1e-4, 1e-8, 1e-12, 0}, position_errors[] = {1e-6, 1e-8, 1e-10, 0};

static const struct {
    const char *file, *title, *head;
    report_error *error;
    const double *bounds;
    bool symplectic_only;
} tables[] = {
    {"summary_energy.md", "energy, all methods", "energy error", report_energy_error, energy_errors, false},
    {"summary_energy_symplectic.md", "energy, symplectic methods", "energy error", report_energy_error, energy_errors,
     true},
    {"summary_position.md", "position, all methods", "position error", report_position_error, position_errors, false},
    {"summary_position_symplectic.md", "position, symplectic methods", "position error", report_position_error,
     position_errors, true},
};
enum { TABLES = sizeof tables / sizeof *tables, PAIRS_MOST = 256 };

typedef struct {
    bool ours, symplectic_only;
} group;

static bool belongs(const run *row, const void *ctx)
{
    const group *g = ctx;
    const bool is_ours = row->who->baseline == NULL;
    return !row->who->is_compiled && is_ours == g->ours && (row->who->symplectic || !g->symplectic_only);
}

/* ---- Pairs ------------------------------------------------------------------------------------------------------- */

/* Two runs and their times in turns. */
typedef struct {
    const run *of[2]; /* ours, baseline */
    double cpu[2];
} pair;

typedef struct {
    const report *report;
    pair pairs[PAIRS_MOST]; /* those known: one is the fastest at many errors */
    int count;
} summary;

static pair time_pair(summary *m, const run *ours, const run *theirs)
{
    for (int i = 0; i < m->count; i++)
        if (m->pairs[i].of[0] == ours && m->pairs[i].of[1] == theirs) return m->pairs[i];
    pair p = {{ours, theirs}, {ours->cpu, theirs->cpu}};
    tvi_system *system;
    if (scene_system(ours->scene, &system) == TVI_OK) run_in_turns(system, ours, theirs, p.cpu);
    tvi_system_free(system);
    if (m->count < PAIRS_MOST) m->pairs[m->count++] = p;
    return p;
}

/* ---- A table ----------------------------------------------------------------------------------------------------- */

typedef struct {
    int wins, losses, alone, beaten; /* lines with a ratio; lines that only one of the two reaches */
} score;

static void print_run(const run *r, double cpu, FILE *out)
{
    char text[64] = "-", time[32] = "-";
    if (r && r->who->baseline && r->who->baseline->adaptive)
        snprintf(text, sizeof text, "%s %.0e", r->method, r->setting);
    else if (r) snprintf(text, sizeof text, "%s %d (%.4g)", r->method, r->order, r->h);
    if (r) snprintf(time, sizeof time, "%.4g", 1e3 * cpu);
    fprintf(out, " %-30s | %9s |", text, time);
}

/* The fastest run of the compiled default. */
static void print_compiled(const run *r, FILE *out)
{
    if (r) fprintf(out, " %13.4g |\n", 1e3 * r->cpu);
    else fprintf(out, " %13s |\n", "-");
}

static void print_line(summary *m, int t, const scene *s, double bound, FILE *out, score *result)
{
    const group groups[] = {{true, tables[t].symplectic_only}, {false, tables[t].symplectic_only}};
    const run *best[2];
    for (int i = 0; i < 2; i++) best[i] = report_fastest(m->report, s, tables[t].error, bound, belongs, &groups[i]);
    double cpu[2] = {best[0] ? best[0]->cpu : 0, best[1] ? best[1]->cpu : 0};
    if (best[0] && best[1]) memcpy(cpu, time_pair(m, best[0], best[1]).cpu, sizeof cpu);
    fprintf(out, "| %-15s | %14.0e |", s->name, bound);
    for (int i = 0; i < 2; i++) print_run(best[i], cpu[i], out);
    const double ratio = cpu[0] / cpu[1];
    if (best[0] && best[1]) fprintf(out, " %15.2f |", ratio);
    else fprintf(out, " %15s |", "-");
    print_compiled(report_fastest(m->report, s, tables[t].error, bound, report_is_named, COMPILED), out);
    if (best[0] && best[1]) *(ratio <= 1 ? &result->wins : &result->losses) += 1;
    else if (best[0]) result->alone++;
    else if (best[1]) result->beaten++;
}

static void print_table(summary *m, int t, const scene *const *list, const scene *only, FILE *out, score *result)
{
    *result = (score){0};
    fprintf(out, "| %-15s | %14s | %-30s | %9s | %-30s | %9s | %15s | %13s |\n|---|---|---|---|---|---|---|---|\n",
            "scene", tables[t].head, "ours", "ms", "baseline", "ms", "ours / baseline", "compiled (ms)");
    for (const scene *const *s = list; *s; s++)
        for (const double *bound = tables[t].bounds; *bound > 0 && (!only || *s == only); bound++)
            print_line(m, t, *s, *bound, out, result);
}

/* ---- The files --------------------------------------------------------------------------------------------------- */

static bool copy_to_output(FILE *file)
{
    char text[512];
    rewind(file);
    while (fgets(text, sizeof text, file)) fputs(text, stdout);
    return !ferror(file);
}

bool summary_write(const report *r, const scene *const *list, const scene *only, const char *dir)
{
    static summary m;
    char path[4096];
    m = (summary){.report = r};
    for (int t = 0; t < TABLES; t++) {
        score result;
        FILE *file = NULL;
        if (snprintf(path, sizeof path, "%s/%s", dir, tables[t].file) < (int)sizeof path) file = fopen(path, "w+");
        if (!file) {
            fprintf(stderr, "bench: cannot write %s/%s: %s\n", dir, tables[t].file, strerror(errno));
            return false;
        }
        print_table(&m, t, list, only, file, &result);
        printf("\nThe fastest by %s: method order (h), CPU time of the run; a ratio above 1 is a loss of ours.\n",
               tables[t].title);
        bool written = copy_to_output(file);
        written &= fclose(file) == 0;
        printf("tvi is faster in %d lines and slower in %d; in %d only tvi reaches the error, in %d only a baseline.\n",
               result.wins, result.losses, result.alone, result.beaten);
        fflush(stdout);
        if (!written) return false;
    }
    printf("\nBaselines are written by hand, each for one force; tvi runs any function that is recorded. A step that "
           "is too\n"
           "large is refused, which the remarks above and work_precision.csv name run by run.\n");
    return true;
}
