/* stability.c - Finds where methods break: the tables of docs/stability.md and the data of its pictures, in DIR.
 *
 *   stability --out DIR [--only linear|survive|fpu|guard|large] [--case NAME] */
#include "linear.h"
#include "tables.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- Linear stability -------------------------------------------------------------------------------------------- */

enum { LINEAR_MOST = 40 };
static const char *const linear_names[] = {
    "stormer-verlet", "svhd", "tvi",      "htvi-right", "htvi-left", "symmetric-tvi", "start",  "end",
    "right",          "left", "midpoint", "both-ends",  "poincare",  "galerkin",      "taylor",
};
static const int linear_orders[] = {2, 4, 8, 16, 20};
enum {
    LINEAR_NAMES = sizeof linear_names / sizeof *linear_names,
    LINEAR_ORDERS = sizeof linear_orders / sizeof *linear_orders
};

/* Searches with one order of a method. Returns false where the method does not have the order. */
static bool find_limit(const tvi_system *system, const char *name, int order, linear_limit *limit)
{
    tvi_options options;
    tvi_integrator *integrator;
    if (tvi_options_named(name, order, &options) != TVI_OK) return false;
    options.max_tail = -1; /* No step is refused for being too large. */
    if (tvi_integrator_create(&integrator, system, &options) != TVI_OK) return false;
    *limit = linear_search(integrator, LINEAR_MOST);
    tvi_integrator_free(integrator);
    return true;
}

/* Writes a row: where each order becomes unstable, then where it first refuses a step. */
static void write_limits(FILE *md, FILE *csv, const tvi_system *system, const char *name)
{
    char onset[32], refused[LINEAR_ORDERS][32], text[32];
    fprintf(md, "| %s |", name);
    for (int i = 0; i < LINEAR_ORDERS; i++) {
        linear_limit limit;
        strcpy(refused[i], "");
        if (!find_limit(system, name, linear_orders[i], &limit)) {
            fprintf(md, " |");
            continue;
        }
        table_number(isinf(limit.onset) ? NAN : limit.onset, "%.4f", onset);
        table_number(limit.status == TVI_OK ? NAN : limit.refused_at, "%.2f", refused[i]);
        fprintf(md, " %s |", onset);
        fprintf(csv, "%s,%d,%s,%s,%s,%s\n", name, linear_orders[i], onset,
                table_number(isinf(limit.onset) ? NAN : limit.growth, "%.1e", text), refused[i],
                hard_run_cause(&(hard_run){.status = limit.status}));
    }
    for (int i = 0; i < LINEAR_ORDERS; i++) fprintf(md, " %s |", refused[i]);
    fprintf(md, "\n");
}

static bool linear_table(const table_command *at)
{
    tvi_system *system;
    FILE *md = table_open(at, "linear.md"), *csv = table_open(at, "linear.csv");
    if (!md || !csv || hard_system(&oscillator, &system) != TVI_OK) return false;
    fprintf(md, "| method |");
    for (int i = 0; i < LINEAR_ORDERS; i++) fprintf(md, " order %d: stable below |", linear_orders[i]);
    for (int i = 0; i < LINEAR_ORDERS; i++) fprintf(md, " order %d: refused from (chaotic) |", linear_orders[i]);
    fprintf(md, "\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    fprintf(csv, "method,order,onset,growth,refused,status\n");
    for (int i = 0; i < LINEAR_NAMES; i++) {
        table_progress("linear", linear_names[i]);
        write_limits(md, csv, system, linear_names[i]);
    }
    tvi_system_free(system);
    return fclose(md) == 0 && fclose(csv) == 0;
}

/* Spectral radius less 1 over h w, for the picture. */
static bool linear_curves(const table_command *at)
{
    static const hard_method curves[] = {{"stormer-verlet", 2, false}, {"svhd", 2, false},      {"tvi", 4, false},
                                         {"symmetric-tvi", 4, false},  {"start", 4, false},     {"midpoint", 4, false},
                                         {"midpoint", 8, false},       {"both-ends", 8, false}, {"poincare", 8, false},
                                         {"galerkin", 8, false}};
    FILE *csv = table_open(at, "linear_curves.csv");
    tvi_system *system;
    if (!csv || hard_system(&oscillator, &system) != TVI_OK) return false;
    for (size_t i = 0; i < sizeof curves / sizeof *curves; i++) {
        tvi_options options;
        tvi_integrator *integrator;
        if (!hard_options(&curves[i], &options)) return false;
        options.max_tail = -1;
        if (tvi_integrator_create(&integrator, system, &options) != TVI_OK) return false;
        fprintf(csv, "%s\"%s %d\"\n", i ? "\n\n" : "", curves[i].name, curves[i].order);
        for (double z = 0.005; z < 8; z += 0.005) {
            step_matrix M;
            if (linear_matrix(integrator, z, &M) == TVI_OK) fprintf(csv, "%.3f %.6e\n", z, 1 + linear_growth(&M));
        }
        tvi_integrator_free(integrator);
    }
    tvi_system_free(system);
    return fclose(csv) == 0;
}

static bool linear(const table_command *at) { return linear_table(at) && linear_curves(at); }

/* ---- The largest step that survives ------------------------------------------------------------------------------ */

static const hard_method survivors[] = {
    {"stormer-verlet", 2, false}, {"svhd", 2, false},      {"poincare", 2, false},
    {"gauss", 4, false},          {"tvi", 4, false},       {"symmetric-tvi", 4, false},
    {"start", 4, false},          {"midpoint", 4, false},  {"poincare", 4, false},
    {"galerkin", 4, false},       {"gauss", 8, false},     {"tvi", 8, false},
    {"htvi-right", 8, false},     {"htvi-left", 8, false}, {"symmetric-tvi", 8, false},
    {"start", 8, false},          {"start", 8, true},      {"right", 8, false},
    {"left", 8, false},           {"midpoint", 8, false},  {"both-ends", 8, false},
    {"poincare", 8, false},       {"galerkin", 8, false},  {"gauss", 16, false},
    {"start", 16, false},         {"midpoint", 16, false}, {"both-ends", 16, false},
    {"poincare", 16, false},      {"galerkin", 16, false}, {"midpoint", 20, false},
    {"galerkin", 20, false},
};
enum { SURVIVORS = sizeof survivors / sizeof *survivors };

/* How the steps above the largest that survives ended. */
typedef struct {
    int energy, count[TVI_STATUS_COUNT];
} tally;

static void add(tally *ends, const hard_run *run)
{
    if (run->status == TVI_ESTOPPED) ends->energy++;
    else ends->count[run->status]++;
}

/* "energy 2, TVI_ENOCONV 5". */
static void describe(const tally *ends, char text[128])
{
    int length = 0;
    text[0] = '\0';
    if (ends->energy) length = snprintf(text, 128, "energy %d", ends->energy);
    for (int status = 1; status < TVI_STATUS_COUNT && length < 100; status++)
        if (ends->count[status])
            length += snprintf(text + length, 128 - (size_t)length, "%s%s %d", length ? ", " : "",
                               hard_run_cause(&(hard_run){.status = (tvi_status)status}), ends->count[status]);
}

typedef struct {
    hard_run largest, above; /* that survives; the next larger one */
    tally ends;              /* of all larger ones */
    bool found;
} survival;

/* Down the ladder, until a step and the next smaller one survive; of a long run, until one does. */
static survival search(const hard_case *c, const tvi_system *system, const hard_method *m)
{
    survival found = {.above = {.status = TVI_OK}};
    hard_run candidate = {.status = TVI_ESTOPPED};
    bool last_survived = false;
    for (double h = c->h_most; h > c->h_least; h /= c->ladder) {
        const hard_run run = hard_run_make(c, system, m, (long)ceil(c->scene.t_end / h));
        const bool survives = hard_run_survives(&run);
        if (survives && (last_survived || c->long_run)) {
            found.largest = last_survived ? candidate : run;
            found.found = true;
            return found;
        }
        if (survives) candidate = run;
        else found.above = run, add(&found.ends, &run);
        last_survived = survives;
    }
    return found;
}

static void write_survival(FILE *csv, const hard_case *c, const hard_method *m, const survival *s)
{
    char name[32], h[32], energy[32], position[32], passes[32], ends[128];
    table_method(m, name);
    describe(&s->ends, ends);
    table_number(s->found ? s->largest.h : NAN, "%.3g", h);
    table_number(s->found ? s->largest.energy_error : NAN, "%.1e", energy);
    table_number(s->found ? s->largest.position_error : NAN, "%.1e", position);
    table_number(s->found ? s->largest.passes : NAN, "%.1f", passes);
    fprintf(csv, "%s,%s,%d,%s,%s,%s,%s,%s,%ld,\"%s\"\n", c->scene.name, name, m->order, h, energy, position, passes,
            hard_run_cause(&s->above), s->above.steps, ends);
    fflush(csv);
}

/* Whether the case tries the method. */
static bool is_tried(const hard_case *c, const hard_method *m)
{
    const bool is_best = strcmp(m->name, "gauss") == 0 || strcmp(m->name, "galerkin") == 0 || m->order == 20;
    return m->order >= c->least_order && (is_best || !c->long_run);
}

enum { HARD_CASES_MOST = 16 };
typedef char survival_cell[16];

/* Searches with every method; cell[i] is the largest step of the i-th, empty where it is not tried. */
static bool survive_case(const hard_case *c, FILE *csv, survival_cell cell[SURVIVORS])
{
    char h[32];
    tvi_system *system;
    if (hard_system(c, &system) != TVI_OK) return false;
    table_progress("survive", c->scene.name);
    for (int i = 0; i < SURVIVORS; i++) {
        strcpy(cell[i], "");
        if (!is_tried(c, &survivors[i])) continue;
        const survival s = search(c, system, &survivors[i]);
        write_survival(csv, c, &survivors[i], &s);
        snprintf(cell[i], sizeof cell[i], "%s", table_number(s.found ? s.largest.h : NAN, "%.2g", h));
    }
    tvi_system_free(system);
    return true;
}

static bool survive(const table_command *at)
{
    static survival_cell cell[HARD_CASES_MOST][SURVIVORS];
    int cases = 0;
    FILE *md = table_open(at, "survive.md"), *csv = table_open(at, "survive.csv");
    if (!md || !csv) return false;
    fprintf(csv,
            "case,method,order,h,energy_error,position_error,passes_per_step,next_ends_by,after_steps,all_larger\n");
    fprintf(md, "| method | order |");
    for (const hard_case *const *c = hard_cases; *c; c++) {
        if (at->only_case && strcmp(at->only_case, (*c)->scene.name) != 0) continue;
        if (!survive_case(*c, csv, cell[cases++])) return false;
        fprintf(md, " %s (chaotic) |", (*c)->scene.name);
    }
    fprintf(md, "\n|---|---|");
    for (int c = 0; c < cases; c++) fprintf(md, "---|");
    for (int i = 0; i < SURVIVORS; i++) {
        char name[32];
        table_method(&survivors[i], name);
        fprintf(md, "\n| %s | %d |", name, survivors[i].order);
        for (int c = 0; c < cases; c++) fprintf(md, " %s |", cell[c][i]);
    }
    fprintf(md, "\n");
    return fclose(md) == 0 && fclose(csv) == 0;
}

/* ---- Fermi-Pasta-Ulam over h w ----------------------------------------------------------------------------------- */

static const double ratios[] = {0.1, 0.2, 0.3, 0.5, 0.75, 1, 1.25, 1.5, 1.75, 2, 2.25, 2.5, 2.75, 3};
enum { RATIOS = sizeof ratios / sizeof *ratios };
static const hard_method chains[] = {
    {"stormer-verlet", 2, false}, {"svhd", 2, false},     {"gauss", 4, false},    {"tvi", 4, false},
    {"midpoint", 4, false},       {"poincare", 4, false}, {"galerkin", 4, false}, {"gauss", 8, false},
    {"symmetric-tvi", 8, false},  {"start", 8, false},    {"midpoint", 8, false}, {"both-ends", 8, false},
    {"poincare", 8, false},       {"galerkin", 8, false}, {"gauss", 16, false},   {"midpoint", 16, false},
    {"galerkin", 16, false},
};
enum { CHAINS = sizeof chains / sizeof *chains };

/* Writes the energy error and the passes of the runs that survive, a block of lines for each method. */
static bool fpu(const table_command *at)
{
    const hard_case *c = &fpu_100;
    const double w = *(const double *)c->ctx;
    FILE *data = table_open(at, "fpu_100.dat");
    tvi_system *system;
    if (!data || hard_system(c, &system) != TVI_OK) return false;
    table_progress("fpu", c->scene.name);
    for (int i = 0; i < CHAINS; i++) {
        fprintf(data, "\n\n\"%s %d\"\n", chains[i].name, chains[i].order);
        for (int k = 0; k < RATIOS; k++) {
            const hard_run run = hard_run_make(c, system, &chains[i], (long)ceil(c->scene.t_end * w / ratios[k]));
            if (hard_run_survives(&run)) fprintf(data, "%g %g %g\n", ratios[k], run.energy_error, run.passes);
        }
    }
    tvi_system_free(system);
    return fclose(data) == 0;
}

/* ---- The command ------------------------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    bool (*make)(const table_command *at);
} parts[] = {{"linear", linear}, {"large", table_large}, {"guard", table_guard}, {"fpu", fpu}, {"survive", survive}};
enum { PARTS = sizeof parts / sizeof *parts };

static int usage(void)
{
    fprintf(stderr, "usage: stability --out DIR [--only PART] [--case NAME]\nparts:");
    for (int i = 0; i < PARTS; i++) fprintf(stderr, " %s", parts[i].name);
    fprintf(stderr, "\n");
    return EXIT_FAILURE;
}

int main(int argc, char *argv[])
{
    const char *only = NULL;
    table_command at = {.dir = "."};
    for (int i = 1; i < argc; i += 2) {
        if (i + 1 == argc) return usage();
        if (strcmp(argv[i], "--out") == 0 && (at.dir = argv[i + 1])) continue;
        if (strcmp(argv[i], "--only") == 0 && (only = argv[i + 1])) continue;
        if (strcmp(argv[i], "--case") == 0 && (at.only_case = argv[i + 1])) continue;
        return usage();
    }
    if (mkdir(at.dir, 0777) != 0 && errno != EEXIST) return usage();
    for (int i = 0; i < PARTS; i++)
        if ((!only || strcmp(only, parts[i].name) == 0) && !parts[i].make(&at)) return EXIT_FAILURE;
    table_progress("done", "");
    return EXIT_SUCCESS;
}
