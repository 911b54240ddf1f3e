/* targets.c - what the library is to be as fast as, and whether it is. Writes DIR/targets.md, DIR/galerkin.md,
 * DIR/paper.md and DIR/work_precision.csv; reads DIR/series.csv and DIR/gradient.csv, where they are.
 *
 *   targets DIR */
#include "experiments/experiment.h"
#include "runs/sweep.h"
#include "turns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the sweeps: s for all; for one measurement. */
static const double BUDGET = 150, LONGEST = 10;

static const char *const gauss[] = {"gauss", "gauss-by-hand", NULL};
static const char *const gsl[] = {"gsl-rk8pd", "gsl-rk8pd-adaptive", NULL};
static const char *const any[] = {"galerkin", "midpoint", NULL}, *const midpoint[] = {"midpoint", NULL};
static const char *const sundials[] = {"arkode-erkstep", "arkode-erkstep-adaptive", "cvode-adams", NULL};

/* Ours, its best order and step, at a position error of 1e-10. */
static const struct {
    const scene *scene;
    const char *title;
    const char *const *rivals; /* the fastest of them */
    double most;               /* of the ratio of the times */
    const char *const *ours;   /* the fastest of them, where it is not the method that the table is of */
} rivalries[] = {
    {&scene_kepler, "Kepler to t = 250, Gauss collocation of order 16", gauss, 5, NULL},
    {&scene_kepler, "Kepler to t = 250, GSL rk8pd", gsl, 0.7, NULL},
    {&scene_solar, "Solar System, Gauss collocation of order 16", gauss, 4, NULL},
    {&scene_solar, "Solar System, GSL rk8pd", gsl, 1, NULL},
    {&scene_solar, "Solar System, the fastest of SUNDIALS", sundials, 1, NULL},
    {&scene_double_pendulum, "double pendulum, Gauss collocation of order 12", gauss, 1, any},
    {&scene_double_pendulum, "the same, midpoint", gauss, 1, midpoint},
};
static const struct {
    const scene *scene;
    const char *title;
    double h;
} collocations[] = {{&scene_kepler, "Kepler, galerkin 16 against Gauss 16, h = 0.25", 0.25},
                    {&scene_solar, "Solar System, galerkin 16 against Gauss 16, h = 400", 400}};
enum { RIVALRIES = sizeof rivalries / sizeof *rivalries, COLLOCATIONS = sizeof collocations / sizeof *collocations };
static const double POSITION_ERROR = 1e-10, ENERGY_ERROR = 1e-6, COLLOCATION_MOST = 1.6, PAPER_LEAST = 10;

/* ---- The table ------------------------------------------------------------------------------------------------------
 */

static void write_run(FILE *table, const run *r, double cpu)
{
    if (!r) {
        fprintf(table, " not reached | - |");
        return;
    }
    const bool adaptive = r->who->baseline && r->who->baseline->adaptive;
    fprintf(table, " %s %d (%s%.4g), %.1e | %.3g |", r->method, r->order, adaptive ? "tolerance " : "", r->setting,
            r->position_error, 1e3 * cpu);
}

static void write_verdict(FILE *table, double ratio, double most)
{
    if (isnan(ratio)) fprintf(table, " - | %.4g | - |\n", most);
    else fprintf(table, " %.2f | %.4g | %s |\n", ratio, most, ratio <= most ? "yes" : "no");
}

/* Runs both again, in turns. Returns the ratio of their times: 0 or infinite where only ours or theirs gets there. */
static double write_pair(FILE *table, const run *ours, const run *theirs)
{
    double cpu[2] = {ours ? ours->cpu : NAN, theirs ? theirs->cpu : NAN};
    if (ours && theirs) {
        tvi_system *system = experiment_system(ours->scene);
        run_in_turns(system, ours, theirs, cpu);
        tvi_system_free(system);
    }
    write_run(table, ours, cpu[0]);
    write_run(table, theirs, cpu[1]);
    return ours && theirs ? cpu[0] / cpu[1] : ours ? 0 : theirs ? INFINITY : NAN;
}

/* ---- Costs that the other programs have measured
 * ----------------------------------------------------------------------
 */

/* Field `column` of the line of DIR/NAME.csv that begins with `key`; NAN where there is none. */
static double field_of(const experiment *e, const char *name, const char *key, int column)
{
    char path[4096], line[512];
    double value = NAN;
    snprintf(path, sizeof path, "%s/%s.csv", e->dir, name);
    FILE *csv = fopen(path, "r");
    while (csv && fgets(line, sizeof line, csv)) {
        if (strncmp(line, key, strlen(key)) != 0) continue;
        const char *field = line;
        for (int i = 0; i < column && field; i++) field = strchr(field, ',') ? strchr(field, ',') + 1 : NULL;
        if (field) value = strtod(field, NULL);
    }
    if (csv) fclose(csv);
    return value;
}

static void write_cost(FILE *table, const char *what, double ratio, double most)
{
    fprintf(table, "| %s | - | - | - | - |", what);
    write_verdict(table, ratio, most);
}

static double gradient_ratio(const experiment *e, const char *key)
{
    return field_of(e, "gradient", key, 4) / field_of(e, "gradient", key, 3);
}

/* Of the widest instruction set, which comes first in gradient.csv but second in series.csv. */
static void write_costs(FILE *table, const experiment *e)
{
    static const struct {
        const char *key, *what;
        double most;
    } series[] = {{"6 bodies,10,base", "series by hand, 6 bodies, N = 10, base", 1.5},
                  {"6 bodies,10,avx", "series by hand, 6 bodies, N = 10, widest", 1.5},
                  {"Kepler,10,base", "series by hand, Kepler, N = 10, base", 2.5},
                  {"Kepler,10,avx", "series by hand, Kepler, N = 10, widest", 2.5}};
    write_cost(table, "gradient / expansion, Solar System, N = 8", gradient_ratio(e, "outer Solar System,18,avx"), 5);
    write_cost(table, "the same of 30 bodies / of 6 bodies",
               gradient_ratio(e, "30 bodies,90,avx") / gradient_ratio(e, "6 bodies,18,avx"), 1);
    for (int i = 0; i < 4; i++)
        write_cost(table, series[i].what, field_of(e, "series", series[i].key, 5), series[i].most);
}

/* ---- Rivals
 * -----------------------------------------------------------------------------------------------------------
 */

static bool is_among(const run *row, const void *names)
{
    for (const char *const *name = names; *name; name++)
        if (report_is_named(row, *name)) return true;
    return false;
}

/* GSL and SUNDIALS may be missing. */
static bool is_compiled(const char *name)
{
    const baseline *b;
    for (int i = 0; (b = baseline_at(i)); i++)
        if (strcmp(b->name, name) == 0) return true;
    return false;
}

static void write_rivalry(FILE *table, const report *r, int i, const char *const *ours)
{
    const scene *s = rivalries[i].scene;
    const run *best = report_fastest(r, s, report_position_error, POSITION_ERROR, is_among, ours);
    const run *theirs = report_fastest(r, s, report_position_error, POSITION_ERROR, is_among, rivalries[i].rivals);
    fprintf(table, "| %s |", rivalries[i].title);
    const double ratio = write_pair(table, best, theirs);
    write_verdict(table, is_compiled(rivalries[i].rivals[0]) ? ratio : NAN, rivalries[i].most);
}

/* Those of the method; and, in the first table, those of methods of their own. */
static void write_rivalries(FILE *table, const report *r, const char *const method[], bool with_others)
{
    for (int i = 0; i < RIVALRIES; i++)
        if (!rivalries[i].ours || with_others)
            write_rivalry(table, r, i, rivalries[i].ours ? rivalries[i].ours : method);
}

static void write_collocations(FILE *table)
{
    contender who[] = {{.name = "galerkin", .order = 16, .symplectic = true},
                       {.name = "gauss", .order = 16, .symplectic = true, .baseline = baseline_find("gauss", 16)}};
    if (tvi_options_named("galerkin", 16, &who[0].options) != TVI_OK) experiment_fail("galerkin", "no such method");
    for (int i = 0; i < COLLOCATIONS; i++) {
        run runs[2];
        tvi_system *system = experiment_system(collocations[i].scene);
        for (int k = 0; k < 2; k++)
            run_contender(system, collocations[i].scene, &who[k], collocations[i].h, INFINITY, &runs[k]);
        tvi_system_free(system);
        fprintf(table, "| %s |", collocations[i].title);
        write_verdict(table, write_pair(table, &runs[0], &runs[1]), COLLOCATION_MOST);
    }
}

/* ---- The paper
 * ----------------------------------------------------------------------------------------------------------
 */

static void write_paper(const experiment *e, const report *r)
{
    FILE *table = experiment_table(e, "paper",
                                   "scene|default (h), position error|ms (time)|symmetric-tvi (h), position error|"
                                   "ms (time)|times faster (time)|at least|met (time)");
    for (const scene *const *s = scenes; *s; s++) {
        const run *ours = report_fastest(r, *s, report_energy_error, ENERGY_ERROR, report_is_named, "default");
        const run *theirs = report_fastest(r, *s, report_energy_error, ENERGY_ERROR, report_is_named, "symmetric-tvi");
        fprintf(table, "| %s |", (*s)->name);
        const double faster = 1 / write_pair(table, ours, theirs);
        fprintf(table, " %.1f | %.4g | %s |\n", faster, PAPER_LEAST, faster >= PAPER_LEAST ? "yes" : "no");
    }
    experiment_close(table);
}

/* ---- The sweeps
 * ---------------------------------------------------------------------------------------------------------
 */

static void sweep_rivals(sweep *b)
{
    static const method_range methods[] = {{"midpoint", 12, 28, 2, true}, {"galerkin", 12, 20, 2, true}};
    static const scene *const swept[] = {&scene_kepler, &scene_solar, &scene_double_pendulum};
    static contenders list;
    contenders_add_baselines(&list);
    int kept = 0;
    for (int i = 0; i < list.count; i++) { /* of Gauss collocation the highest order */
        const bool is_gauss = strcmp(list.of[i].name, "gauss") == 0 && list.of[i].order == 16;
        const run row = {.method = list.of[i].name};
        if (is_gauss || is_among(&row, gsl) || is_among(&row, sundials)) list.of[kept++] = list.of[i];
    }
    list.count = kept;
    list.of[list.count++] = (contender){.name = baseline_double_pendulum.name,
                                        .order = baseline_double_pendulum.order,
                                        .symplectic = true,
                                        .baseline = &baseline_double_pendulum};
    contenders_add_methods(&list, methods, 2);
    b->enough = POSITION_ERROR;
    for (int i = 0; i < 3; i++)
        if (!sweep_scene(b, swept[i], &list, sweep_share(b->begin + BUDGET / 2, 3 - i)))
            experiment_fail("a sweep", swept[i]->name);
}

static void sweep_paper(sweep *b)
{
    static const method_range paper = {"symmetric-tvi", 4, 4, 1, true};
    static contenders list;
    list.of[list.count++] = (contender){
        .name = "default", .order = tvi_options_default().order, .symplectic = true, .options = tvi_options_default()};
    contenders_add_methods(&list, &paper, 1);
    b->enough = ENERGY_ERROR;
    b->enough_of = report_energy_error;
    int left = 0;
    for (const scene *const *s = scenes; *s; s++) left++;
    for (const scene *const *s = scenes; *s; s++)
        if (!sweep_scene(b, *s, &list, sweep_share(b->begin + BUDGET, left--))) experiment_fail("a sweep", (*s)->name);
}

#define COLUMNS                                                                                                        \
    "target|ours: method order (h), position error (time)|ms (time)|theirs (time)|ms (time)|ratio (time)|at most|met " \
    "(time)"

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    sweep b = {.begin = run_clock(), .longest = LONGEST};
    b.end = b.begin + BUDGET;
    if (!report_open(&b.report, e.dir, argc, argv)) return EXIT_FAILURE;
    report_remark(&b.report, "flags of the baselines: %s", baseline_flags);
    report_remark(&b.report, "widest instruction set: %s", isa_name(ISA_WIDEST));
    sweep_rivals(&b);
    sweep_paper(&b);
    FILE *table = experiment_table(&e, "targets", COLUMNS);
    write_costs(table, &e);
    write_rivalries(table, &b.report, midpoint, true);
    write_collocations(table);
    experiment_close(table);
    table = experiment_table(&e, "galerkin", COLUMNS);
    write_rivalries(table, &b.report, (const char *const[]){"galerkin", NULL}, false);
    experiment_close(table);
    write_paper(&e, &b.report);
    return report_close(&b.report) ? EXIT_SUCCESS : EXIT_FAILURE;
}
