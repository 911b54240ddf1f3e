/* compare.c - every baseline over each scene's ladder of steps: DIR/work_precision.csv with the columns of bench.c, and a
 * table of the fastest run of each.
 *
 *   compare [--scene NAME] [--out DIR] [--longest SECONDS] [--peers DIR]
 *
 * --longest: of one run (0.1 s); a ladder ends there, or at roundoff. --peers: only compare Gauss collocation of order 16
 * with another program of it, DIR/gauss, in turns. */
#include "baseline.h"
#include "report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifndef BASELINE_FLAGS
#define BASELINE_FLAGS "unknown"
#endif

/* ---- One run ------------------------------------------------------------------------------------------------------ */

typedef struct {
    const tvi_system *system;
    long steps, every; /* every this many steps, and after the last one */
    double start, scale, worst;
} monitor;

/* worst = max |H - H0| / scale; infinite from the first H that has no value on. */
static int watch(long step, double t, const double q[], const double p[], void *ctx)
{
    monitor *m = ctx;
    if (step % m->every != 0 && step != m->steps) return 0;
    double energy, error = INFINITY;
    if (tvi_energy(m->system, t, q, p, &energy) == TVI_OK) error = fabs(energy - m->start) / m->scale;
    m->worst = error <= m->worst ? m->worst : isnan(error) ? INFINITY : error;
    return 0;
}

static void compare_with_reference(const scene *s, const double q[], const double p[], run *result)
{
    double squares = 0;
    result->end_error = 0;
    for (int i = 0; i < s->n; i++) {
        const double dq = q[i] - s->reference[i], dp = p[i] - s->reference[s->n + i];
        result->end_error = fmax(result->end_error, fmax(fabs(dq), fabs(dp)));
        squares += dq * dq;
    }
    result->position_error = sqrt(squares);
}

/* From the scene's start to q[n], p[n] at its end; cpu is the time that it took. */
static tvi_status go(const baseline *b, const baseline_task *task, double q[], double p[], baseline_counts *counts,
                     double *cpu)
{
    const scene *s = task->scene;
    memcpy(q, s->q, (size_t)s->n * sizeof *q);
    memcpy(p, s->p, (size_t)s->n * sizeof *p);
    const double begin = run_clock();
    const tvi_status status = b->run(b, task, q, p, counts);
    *cpu = run_clock() - begin;
    return status;
}

/* The fastest of three runs and 20 ms at least, unless they are long. */
static double fastest_time(const baseline *b, const baseline_task *task)
{
    double q[BASELINE_N_MAX], p[BASELINE_N_MAX], once, best = INFINITY, total = 0;
    baseline_counts counts;
    for (int done = 0; total < 0.25 && (done < 3 || total < 0.02); done++) {
        if (go(b, task, q, p, &counts, &once) != TVI_OK) return INFINITY;
        best = fmin(best, once);
        total += once;
    }
    return best;
}

/* A run with an observer for the energy, and some without one for the errors and the time. */
static void measure(const baseline *b, const tvi_system *system, baseline_task task, run *result)
{
    const scene *s = task.scene;
    double q[BASELINE_N_MAX], p[BASELINE_N_MAX], cpu;
    baseline_counts counts;
    *result = (run){.scene = s, .method = b->name, .order = b->order};
    result->status = go(b, &task, q, p, &counts, &cpu);
    if (result->status != TVI_OK) return;
    compare_with_reference(s, q, p, result);
    result->steps = counts.steps;
    result->h = s->t_end / (double)counts.steps;
    result->force_evaluations = counts.force_evaluations;
    result->passes_per_step = (double)counts.passes / (double)counts.steps;
    result->cpu = fastest_time(b, &task);
    monitor m = {.system = system, .steps = counts.steps};
    m.every = m.steps < RUN_SAMPLES ? 1 : m.steps / RUN_SAMPLES;
    result->status = tvi_energy(system, 0, s->q, s->p, &m.start);
    if (result->status != TVI_OK) return;
    m.scale = fmax(fabs(m.start), s->energy_scale);
    task.observer = watch, task.ctx = &m;
    result->status = go(b, &task, q, p, &counts, &cpu);
    result->energy_error = m.worst;
}

/* ---- Ladders ------------------------------------------------------------------------------------------------------ */

static const double tolerances[] = {1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 0};

static baseline_task task_of(const baseline *b, const scene *s, double setting)
{
    if (b->adaptive) return (baseline_task){.scene = s, .h = s->t_end, .steps = 1, .tolerance = setting};
    return (baseline_task){.scene = s, .h = setting, .steps = lround(s->t_end / setting)};
}

/* The error is small and did not fall to a half. */
static bool at_roundoff(const run *before, const run *now)
{
    double size = 0;
    for (int i = 0; i < now->scene->n; i++) size = fmax(size, fabs(now->scene->reference[i]));
    return now->position_error < 1e-10 * size && now->position_error > before->position_error / 2;
}

/* false: out of memory. */
static bool descend(report *r, const baseline *b, const tvi_system *system, const scene *s, double longest)
{
    run row, before = {.cpu = 0, .position_error = INFINITY};
    double last = 1;
    for (const double *setting = b->adaptive ? tolerances : s->steps; *setting > 0; setting++) {
        const double growth = b->adaptive ? 1.5 : last / *setting; /* of the time */
        if (before.cpu * growth > longest) break;
        measure(b, system, task_of(b, s, *setting), &row);
        if (row.status != TVI_OK) {
            report_remark(r, "failed: %s %s %d at %.4g: %s", s->name, b->name, b->order, *setting,
                          tvi_status_string(row.status));
            continue;
        }
        if (b->adaptive) report_remark(r, "%s tolerance %.0e: h is the mean", b->name, *setting);
        if (!report_row(r, &row)) return false;
        if (at_roundoff(&before, &row)) break;
        before = row;
        last = *setting;
    }
    return true;
}

/* ---- The table ---------------------------------------------------------------------------------------------------- */

static const double bounds[] = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12};
enum { BOUNDS = sizeof bounds / sizeof *bounds };

static const run *fastest(const report *r, const scene *s, const baseline *b, double bound)
{
    const run *best = NULL;
    for (const run *row = r->rows; row < r->rows + r->count; row++)
        if (row->scene == s && strcmp(row->method, b->name) == 0 && row->order == b->order &&
            row->position_error <= bound && (!best || row->cpu < best->cpu))
            best = row;
    return best;
}

static void print_table(const report *r, const scene *s)
{
    const baseline *b;
    printf("\n%s: ms (h) of the fastest run with a position error of at most\n%-26s", s->title, "");
    for (int i = 0; i < BOUNDS; i++) printf("%19.0e", bounds[i]);
    printf("\n");
    for (int i = 0; (b = baseline_at(i)); i++) {
        if (!baseline_serves(b, s)) continue;
        printf("%-23s %2d", b->name, b->order);
        for (int k = 0; k < BOUNDS; k++) {
            const run *row = fastest(r, s, b, bounds[k]);
            char text[32] = "-";
            if (row) snprintf(text, sizeof text, "%.3f (%.4g)", 1e3 * row->cpu, row->h);
            printf("%19s", text);
        }
        printf("\n");
    }
    fflush(stdout);
}

static bool compare_scene(report *r, const scene *s, double longest)
{
    const baseline *b;
    tvi_system *system;
    bool good = scene_system(s, &system) == TVI_OK;
    report_scene(r, s);
    for (int i = 0; good && (b = baseline_at(i)); i++) {
        if (!baseline_serves(b, s)) continue;
        fprintf(stderr, "%-16s%s %d\n", s->name, b->name, b->order);
        good = descend(r, b, system, s, longest);
    }
    tvi_system_free(system);
    print_table(r, s);
    return good;
}

/* ---- The peers ---------------------------------------------------------------------------------------------------- */

/* The least time that `dir`/gauss prints, in s; infinite where it cannot be run. */
static double peers_time(const char *dir, const char *problem, double h)
{
    char command[4096], line[1024];
    double least = INFINITY;
    snprintf(command, sizeof command, "'%s/gauss' %s 8 %g", dir, problem, h);
    FILE *pipe = popen(command, "r");
    if (!pipe) return INFINITY;
    if (!fgets(line, sizeof line, pipe) || sscanf(line, "%*[^,],%*[^,],%*[^,],%*[^,],%lf", &least) != 1) least = INFINITY;
    return pclose(pipe) == 0 ? least : INFINITY;
}

static void compare_with_peers(const char *dir, const scene *s, const char *problem, double h)
{
    const baseline *gauss = baseline_find("gauss", 16);
    const baseline_task task = task_of(gauss, s, h);
    double ours = INFINITY, theirs = INFINITY;
    for (int turn = 0; turn < 5; turn++) {
        ours = fmin(ours, fastest_time(gauss, &task));
        theirs = fmin(theirs, peers_time(dir, problem, h));
    }
    printf("%s, gauss 16, h = %g: %.4f ms, the peers' %.4f ms, ratio %.3f\n", s->name, h, 1e3 * ours, 1e3 * theirs,
           ours / theirs);
}

/* ---- The command -------------------------------------------------------------------------------------------------- */

static int usage(void)
{
    fprintf(stderr, "usage: compare [--scene NAME] [--out DIR] [--longest SECONDS] [--peers DIR]\nscenes:");
    for (const scene *const *s = scenes; *s; s++) fprintf(stderr, " %s", (*s)->name);
    fprintf(stderr, "\n");
    return EXIT_FAILURE;
}

int main(int argc, char *argv[])
{
    const scene *only = NULL;
    const char *dir = ".", *peers = NULL;
    double longest = 0.1;
    for (int i = 1; i < argc; i += 2) {
        if (i + 1 == argc) return usage();
        if (strcmp(argv[i], "--scene") == 0 && (only = scene_find(argv[i + 1]))) continue;
        if (strcmp(argv[i], "--out") == 0 && (dir = argv[i + 1])) continue;
        if (strcmp(argv[i], "--peers") == 0 && (peers = argv[i + 1])) continue;
        if (strcmp(argv[i], "--longest") == 0 && (longest = strtod(argv[i + 1], NULL)) > 0) continue;
        return usage();
    }
    if (peers) {
        compare_with_peers(peers, &scene_kepler, "kep250", 0.25);
        compare_with_peers(peers, &scene_solar, "oss", 400);
        return EXIT_SUCCESS;
    }
    report r;
    if (!report_open(&r, dir, argc, argv)) return EXIT_FAILURE;
    report_remark(&r, "flags of the baselines: %s", BASELINE_FLAGS);
    bool good = true;
    for (const scene *const *s = scenes; *s; s++)
        if (!only || *s == only) good &= compare_scene(&r, *s, longest);
    return report_close(&r) && good ? EXIT_SUCCESS : EXIT_FAILURE;
}
