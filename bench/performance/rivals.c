/* rivals.c - times the library beside Gauss collocation by hand, GSL, SUNDIALS and the paper's symmetric method. Writes
 * DIR/rivals.md, DIR/paper.md and DIR/work_precision.csv.
 *
 *   rivals DIR */
#include "experiments/experiment.h"
#include "runs/sweep.h"
#include "turns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Times of the sweeps: s for all; for one measurement. */
static const double BUDGET = 150, LONGEST = 10;

static const char *const gauss[] = {"gauss", "gauss-by-hand", NULL};
static const char *const gsl[] = {"gsl-rk8pd", "gsl-rk8pd-adaptive", NULL};
static const char *const sundials[] = {"arkode-erkstep", "arkode-erkstep-adaptive", "cvode-adams", NULL};

/* Scenes, and the integrators of which the fastest is taken. */
static const struct {
    const scene *scene;
    const char *title;
    const char *const *rivals;
} rivalries[] = {
    {&scene_kepler, "Kepler to t = 250, Gauss collocation of order 16", gauss},
    {&scene_kepler, "Kepler to t = 250, GSL rk8pd", gsl},
    {&scene_solar, "Solar System, Gauss collocation of order 16", gauss},
    {&scene_solar, "Solar System, GSL rk8pd", gsl},
    {&scene_solar, "Solar System, the fastest of SUNDIALS", sundials},
    {&scene_double_pendulum, "double pendulum, Gauss collocation of order 12", gauss},
};
enum { RIVALRIES = sizeof rivalries / sizeof *rivalries };
static const double POSITION_ERROR = 1e-10, ENERGY_ERROR = 1e-6;

/* ---- The table ------------------------------------------------------------------------------------------------- */

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

static void write_ratio(FILE *table, double ratio)
{
    if (isnan(ratio)) fprintf(table, " - |\n");
    else fprintf(table, " %.2f |\n", ratio);
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

/* ---- Rivals ---------------------------------------------------------------------------------------------------- */

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

static void write_rivalry(FILE *table, const report *r, int i, const char *ours)
{
    const scene *s = rivalries[i].scene;
    const run *best = report_fastest(r, s, report_position_error, POSITION_ERROR, report_is_named, ours);
    const run *theirs = report_fastest(r, s, report_position_error, POSITION_ERROR, is_among, rivalries[i].rivals);
    fprintf(table, "| %s |", rivalries[i].title);
    const double ratio = write_pair(table, best, theirs);
    write_ratio(table, is_compiled(rivalries[i].rivals[0]) ? ratio : NAN);
}

static void write_rivals(const experiment *e, const report *r)
{
    static const char *const ours[] = {"galerkin", "midpoint"};
    FILE *table = experiment_table(e, "rivals",
                                   "problem and rival|ours: method order (h), position error (time)|ms (time)|"
                                   "theirs (time)|ms (time)|ours / theirs (time)");
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < RIVALRIES; i++) write_rivalry(table, r, i, ours[k]);
    experiment_close(table);
}

/* ---- The paper ------------------------------------------------------------------------------------------------- */

static void write_paper(const experiment *e, const report *r)
{
    FILE *table = experiment_table(e, "paper",
                                   "scene|default (h), position error|ms (time)|symmetric-tvi (h), position error|"
                                   "ms (time)|times faster (time)");
    for (const scene *const *s = scenes; *s; s++) {
        const run *ours = report_fastest(r, *s, report_energy_error, ENERGY_ERROR, report_is_named, "default");
        const run *theirs = report_fastest(r, *s, report_energy_error, ENERGY_ERROR, report_is_named, "symmetric-tvi");
        fprintf(table, "| %s |", (*s)->name);
        write_ratio(table, 1 / write_pair(table, ours, theirs));
    }
    experiment_close(table);
}

/* ---- The sweeps ------------------------------------------------------------------------------------------------ */

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
    write_rivals(&e, &b.report);
    write_paper(&e, &b.report);
    return report_close(&b.report) ? EXIT_SUCCESS : EXIT_FAILURE;
}
