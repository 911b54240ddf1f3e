/* choose.c - Finds which method for which problem: the fastest of each method and order over the steps of every scene,
 * for given position errors. Writes the tables of docs/choosing.md and README.md to a folder.
 *
 *   choose DIR [BUDGET in seconds] */
#include "runs/sweep.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const method_range methods[] = {
    {"midpoint", 2, 20, 2, true}, {"poincare", 2, 20, 2, true}, {"both-ends", 2, 20, 2, true},
    {"galerkin", 2, 20, 2, true}, {"start", 2, 20, 2, true},    {"symmetric-tvi", 2, 20, 2, true},
    {"taylor", 2, 20, 2, false},
};
static const double targets[] = {1e-4, 1e-6, 1e-8, 1e-10};
enum {
    METHODS = sizeof methods / sizeof *methods,
    TARGETS = sizeof targets / sizeof *targets,
    ORDERS = 10 /* 2, 4, ..., 20 */
};

static const scene *const *const lists[] = {scenes, general_scenes};
enum { LISTS = 2 };

/* s for the fastest run of a method and order; infinite where there is none. */
static double time_of(const report *r, const scene *s, const char *method, int order, double target)
{
    double best = INFINITY;
    for (const run *row = r->rows; row < r->rows + r->count; row++)
        if (row->scene == s && row->order == order && row->position_error <= target && strcmp(row->method, method) == 0)
            best = fmin(best, row->cpu);
    return best;
}

/* ---- Orders ------------------------------------------------------------------------------------------------------ */

/* How much dearer than the fastest order of the same method each order is: ln, summed over the scenes and targets that
 * both reach, and their number. */
typedef struct {
    double sum[ORDERS];
    int count[ORDERS], asked;
} penalty;

static void add_penalty(penalty *p, const report *r, const scene *s, const char *method, double target)
{
    double cpu[ORDERS], best = INFINITY;
    for (int i = 0; i < ORDERS; i++) best = fmin(best, cpu[i] = time_of(r, s, method, 2 * i + 2, target));
    if (!(best < INFINITY)) return;
    p->asked++;
    for (int i = 0; i < ORDERS; i++) {
        if (!(cpu[i] < INFINITY)) continue;
        p->sum[i] += log(cpu[i] / best);
        p->count[i]++;
    }
}

static void write_orders(const report *r, FILE *out)
{
    fprintf(out, "| method |");
    for (int i = 0; i < ORDERS; i++) fprintf(out, " %d |", 2 * i + 2);
    fprintf(out, "\n|---|");
    for (int i = 0; i < ORDERS; i++) fprintf(out, "---|");
    for (int k = 0; k < METHODS; k++) {
        penalty p = {0};
        for (int list = 0; list < LISTS; list++)
            for (const scene *const *s = lists[list]; *s; s++)
                for (int t = 0; t < TARGETS; t++) add_penalty(&p, r, *s, methods[k].name, targets[t]);
        fprintf(out, "\n| %s |", methods[k].name);
        for (int i = 0; i < ORDERS; i++)
            if (p.count[i] == 0) fprintf(out, " - |");
            else fprintf(out, " %.2f (%d/%d) |", exp(p.sum[i] / p.count[i]), p.count[i], p.asked);
    }
    fprintf(out, "\n");
}

/* ---- Methods ----------------------------------------------------------------------------------------------------- */

static void write_methods(const report *r, FILE *out)
{
    const char *names[METHODS];
    for (int k = 0; k < METHODS; k++) names[k] = methods[k].name;
    report_methods_head(names, METHODS, out);
    for (int list = 0; list < LISTS; list++)
        for (const scene *const *s = lists[list]; *s; s++) report_methods(r, *s, names, METHODS, out);
}

/* The table of README.md. */
static void write_advice(const report *r, FILE *out)
{
    static const struct {
        const char *have, *take, *method;
    } rows[] = {
        {"any system, and long times", "the default: \"galerkin\", order 16", "galerkin"},
        {"a Taylor curve of each step wanted, and long times", "\"midpoint\", order 18 or 20", "midpoint"},
        {"a short orbit, energy may drift", "\"taylor\", order 8 to 18", "taylor"},
        {"the paper's symmetric method, to compare with", "\"symmetric-tvi\", its best order", "symmetric-tvi"},
    };
    static const scene *const shown[] = {&scene_kepler, &scene_solar, &scene_double_pendulum};
    fprintf(out, "| you have | take |");
    for (int i = 0; i < 3; i++) fprintf(out, " %s |", shown[i]->title);
    fprintf(out, "\n|---|---|---|---|---|\n");
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        fprintf(out, "| %s | %s |", rows[k].have, rows[k].take);
        for (int i = 0; i < 3; i++) {
            const run *best = report_fastest(r, shown[i], report_position_error, 1e-8, report_is_named, rows[k].method);
            if (best) fprintf(out, " %.2g ms, order %d, h = %.3g |", 1e3 * best->cpu, best->order, best->h);
            else fprintf(out, " - |");
        }
        fprintf(out, "\n");
    }
}

/* ---- The command ------------------------------------------------------------------------------------------------- */

static const struct {
    const char *file;
    void (*write)(const report *r, FILE *out);
} tables[] = {{"methods.md", write_methods}, {"orders.md", write_orders}, {"advice.md", write_advice}};

static bool write_tables(const report *r, const char *dir)
{
    bool good = true;
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
        char path[4096];
        FILE *out = NULL;
        if (snprintf(path, sizeof path, "%s/%s", dir, tables[i].file) < (int)sizeof path) out = fopen(path, "w");
        if (out) tables[i].write(r, out);
        const bool written = out && fclose(out) == 0;
        if (!written) fprintf(stderr, "choose: cannot write %s: %s\n", path, strerror(errno));
        good &= written;
    }
    return good;
}

int main(int argc, char *argv[])
{
    static contenders list;
    sweep_insist_on_one_thread(argv);
    const double budget = argc > 2 ? strtod(argv[2], NULL) : 280;
    if (argc < 2 || !(budget > 0)) {
        fprintf(stderr, "usage: choose DIR [BUDGET]\n");
        return EXIT_FAILURE;
    }
    contenders_add_methods(&list, methods, METHODS);
    contenders_sort(&list);
    sweep b = {.begin = run_clock(), .longest = 0.6, .enough = targets[TARGETS - 1]};
    b.end = b.begin + budget;
    if (!report_open(&b.report, argv[1], argc, argv)) return EXIT_FAILURE;
    bool good = true;
    double left = 0;
    for (int i = 0; i < LISTS; i++)
        for (const scene *const *s = lists[i]; *s; s++) left += (*s)->n;
    for (int i = LISTS - 1; i >= 0; i--) /* the dearest scenes last: what the others leave is theirs */
        for (const scene *const *s = lists[i]; *s; s++) {
            good &= sweep_scene(&b, *s, &list, sweep_share(b.end, (*s)->n / left));
            left -= (*s)->n;
        }
    good &= write_tables(&b.report, argv[1]);
    return report_close(&b.report) && good ? EXIT_SUCCESS : EXIT_FAILURE;
}
