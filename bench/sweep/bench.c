/* bench.c - Runs the order sweep: every scene with a potential, every method of the library and every baseline, over
 * the scene's ladder of steps, within a budget of time.
 *
 *   sweep [--scene NAME] [--method NAME] [--baselines] [--out DIR] [--budget SECONDS]
 *
 * --method, --baselines: only these. */
#include "summary.h"
#include "runs/sweep.h"

#include <stdlib.h>
#include <string.h>

/* A line here is all that a new method of the library takes. */
static const method_range methods[] = {
    {"midpoint", 2, 20, 2, true},      {"poincare", 2, 20, 2, true},
    {"start", 4, 20, 4, true},         {"galerkin", 2, 20, 2, true},
    {"end", 4, 20, 8, true},           {"both-ends", 4, 20, 4, true},
    {"right", 4, 20, 4, true},         {"left", 4, 20, 8, true},
    {"stormer-verlet", 2, 2, 1, true}, {"midpoint-truncated", 4, 20, 4, true},
    {"tvi", 4, 20, 4, true},           {"symmetric-tvi", 4, 20, 4, true},
    {"htvi-right", 4, 12, 4, true},    {"htvi-left", 4, 12, 8, true},
    {"svhd", 2, 2, 1, true},           {"taylor", 4, 20, 2, false},
};
enum { METHODS = sizeof methods / sizeof *methods };

/* The share of the time that the sweeps may take: the rest is for the runs in turns of the summary. */
static const double SWEEPS = 0.94;

/* Share of the time: a step costs more the more bodies there are. */
static double weight(const scene *s) { return s->n + 2; }

typedef struct {
    const scene *scene; /* NULL: all */
    const char *method; /* NULL: all */
    bool baselines;
    const char *dir;
    double budget;
} command;

static int usage(void)
{
    fprintf(stderr,
            "usage: sweep [--scene NAME] [--method NAME] [--baselines] [--out DIR] [--budget SECONDS]\nscenes:");
    for (const scene *const *s = scenes; *s; s++) fprintf(stderr, " %s", (*s)->name);
    fprintf(stderr, "\n");
    return EXIT_FAILURE;
}

static bool parse(command *c, int argc, char *argv[])
{
    for (int i = 1; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : "";
        if (strcmp(argv[i], "--baselines") == 0) {
            c->baselines = true;
            continue;
        }
        i++;
        if (strcmp(argv[i - 1], "--scene") == 0 && (c->scene = scene_find(value))) continue;
        if (strcmp(argv[i - 1], "--method") == 0 && *(c->method = value)) continue;
        if (strcmp(argv[i - 1], "--out") == 0 && *(c->dir = value)) continue;
        if (strcmp(argv[i - 1], "--budget") == 0 && (c->budget = strtod(value, NULL)) > 0) continue;
        return false;
    }
    return true;
}

/* The fastest run of each baseline. */
static void print_baselines(const report *r, const scene *only)
{
    const char *names[CONTENDERS_MOST];
    const baseline *b;
    int count = 0;
    for (int i = 0; (b = baseline_at(i)) && count < CONTENDERS_MOST; i++)
        if (count == 0 || strcmp(names[count - 1], b->name) != 0) names[count++] = b->name;
    printf("\n");
    report_methods_head(names, count, stdout);
    for (const scene *const *s = scenes; *s; s++)
        if (!only || *s == only) report_methods(r, *s, names, count, stdout);
}

int main(int argc, char *argv[])
{
    static contenders list;
    command c = {.dir = ".", .budget = 235};
    sweep_insist_on_one_thread(argv);
    if (!parse(&c, argc, argv)) return usage();
    if (!c.baselines) contenders_add_methods(&list, methods, METHODS);
    if (!c.baselines) contenders_add_compiled(&list, COMPILED, "galerkin", 16);
    contenders_add_baselines(&list);
    contenders_sort(&list);
    sweep b = {.begin = run_clock(), .dearest = 10, .only = c.method};
    b.end = b.begin + SWEEPS * c.budget;
    if (!report_open(&b.report, c.dir, argc, argv)) return EXIT_FAILURE;
    report_remark(&b.report, "flags of the baselines: %s", baseline_flags);
    bool good = true;
    double left = 0;
    for (const scene *const *s = scenes; *s; s++)
        if (!c.scene || *s == c.scene) left += weight(*s);
    for (const scene *const *s = scenes; *s; s++) {
        if (c.scene && *s != c.scene) continue;
        good &= sweep_scene(&b, *s, &list, sweep_share(b.end, weight(*s) / left));
        left -= weight(*s);
    }
    if (c.baselines) print_baselines(&b.report, c.scene);
    else good &= summary_write(&b.report, scenes, c.scene, c.dir);
    sweep_close(&b);
    return report_close(&b.report) && good ? EXIT_SUCCESS : EXIT_FAILURE;
}
