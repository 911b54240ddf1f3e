/* choose.c - which method for which problem: the fastest of each method and order over the steps of every scene, for given
 * position errors. Prints the tables of docs/choosing.md. */
#include "run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static const char *const methods[] = {"midpoint", "poincare", "both-ends", "start", "symmetric-tvi", "taylor"};
static const double targets[] = {1e-4, 1e-6, 1e-8, 1e-10};
enum {
    METHODS = sizeof methods / sizeof *methods,
    TARGETS = sizeof targets / sizeof *targets,
    ORDERS = 10, /* 2, 4, ..., 20 */
    MOST_STEPS = 32
};
static const double longest_run = 0.6; /* s */

/* The fastest run that reaches a target; cpu INFINITY: none. */
typedef struct {
    double cpu, h;
} fastest;

typedef struct {
    fastest best[METHODS][ORDERS][TARGETS];
} measured;

static void note(fastest best[TARGETS], const run *r)
{
    for (int i = 0; i < TARGETS; i++)
        if (r->status == TVI_OK && r->position_error <= targets[i] && r->cpu < best[i].cpu)
            best[i] = (fastest){r->cpu, r->h};
}

/* Down the ladder until the last target is met or a run would take too long. */
static void measure_order(const tvi_system *system, const scene *s, const tvi_options *options, fastest best[TARGETS])
{
    for (const double *h = s->steps; *h > 0; h++) {
        if (run_predict(system, s, options, *h) > longest_run) return;
        run r = {0};
        run_measure(system, s, options, *h, &r);
        note(best, &r);
        if (best[TARGETS - 1].cpu < INFINITY) return;
    }
}

static void measure_scene(const scene *s, measured *m)
{
    tvi_system *system;
    if (scene_system(s, &system) != TVI_OK) exit(1);
    for (int method = 0; method < METHODS; method++)
        for (int i = 0; i < ORDERS; i++) {
            tvi_options options;
            for (int t = 0; t < TARGETS; t++) m->best[method][i][t] = (fastest){INFINITY, 0};
            if (tvi_options_named(methods[method], 2 * i + 2, &options) != TVI_OK) continue;
            if (tvi_options_check(system, &options, NULL) != TVI_OK) continue;
            fprintf(stderr, "%s: %s %d          \r", s->name, methods[method], 2 * i + 2);
            measure_order(system, s, &options, m->best[method][i]);
        }
    tvi_system_free(system);
}

/* The best order of a method for a target. */
static int best_order(const measured *m, int method, int target)
{
    int best = 0;
    for (int i = 1; i < ORDERS; i++)
        if (m->best[method][i][target].cpu < m->best[method][best][target].cpu) best = i;
    return best;
}

static void print_cell(const measured *m, int method, int target)
{
    const int i = best_order(m, method, target);
    const fastest *f = &m->best[method][i][target];
    if (f->cpu < INFINITY) printf(" %d (%.4g) %.3g |", 2 * i + 2, f->h, 1e3 * f->cpu);
    else printf(" - |");
}

static void print_scene(const scene *s, const measured *m)
{
    for (int target = 0; target < TARGETS; target++) {
        printf("| %s | %.0e |", s->name, targets[target]);
        for (int method = 0; method < METHODS; method++) print_cell(m, method, target);
        printf("\n");
    }
    fflush(stdout);
}

/* How much dearer than the fastest order of the same method each order is: ln, summed over the scenes and targets that
 * both reach, and their number. */
typedef struct {
    double sum[METHODS][ORDERS];
    int count[METHODS][ORDERS], asked[METHODS];
} penalty;

static void add_penalty(penalty *p, const measured *m)
{
    for (int method = 0; method < METHODS; method++)
        for (int target = 0; target < TARGETS; target++) {
            const double best = m->best[method][best_order(m, method, target)][target].cpu;
            if (!(best < INFINITY)) continue;
            p->asked[method]++;
            for (int i = 0; i < ORDERS; i++) {
                const double cpu = m->best[method][i][target].cpu;
                if (!(cpu < INFINITY)) continue;
                p->sum[method][i] += log(cpu / best);
                p->count[method][i]++;
            }
        }
}

static void print_penalty(const penalty *p)
{
    printf("\n| method |");
    for (int i = 0; i < ORDERS; i++) printf(" %d |", 2 * i + 2);
    printf("\n|---|");
    for (int i = 0; i < ORDERS; i++) printf("---|");
    for (int method = 0; method < METHODS; method++) {
        printf("\n| %s |", methods[method]);
        for (int i = 0; i < ORDERS; i++) {
            const int count = p->count[method][i];
            if (count == 0) printf(" - |");
            else printf(" %.2f (%d/%d) |", exp(p->sum[method][i] / count), count, p->asked[method]);
        }
    }
    printf("\n");
}

int main(int argc, char *argv[])
{
    (void)argc;
    if (!getenv("OPENBLAS_NUM_THREADS")) { /* read when the library is loaded */
        setenv("OPENBLAS_NUM_THREADS", "1", 1);
        execv("/proc/self/exe", argv);
    }
    static measured m;
    penalty p = {0};
    printf("| scene | position error |");
    for (int method = 0; method < METHODS; method++) printf(" %s |", methods[method]);
    printf("\n|---|---|");
    for (int method = 0; method < METHODS; method++) printf("---|");
    printf("\n");
    const scene *const *const lists[] = {scenes, general_scenes};
    for (int list = 0; list < 2; list++)
        for (const scene *const *s = lists[list]; *s; s++) {
            measure_scene(*s, &m);
            print_scene(*s, &m);
            add_penalty(&p, &m);
        }
    print_penalty(&p);
    return 0;
}
