/* work.c - Measures errors against CPU times on constraints: "galerkin" of the library, RATTLE and its compositions by
 * hand, IDA and CVODE. Writes DIR/work.csv and DIR/work.md.
 *     work DIR */
#include "work.h"

#include "experiments/experiment.h"
#include "longrun/longrun.h"
#include "performance/turns.h"
#include "tvi_rigid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS_MOST = 40, TARGETS = 4 };
static const double targets[TARGETS] = {1e-3, 1e-6, 1e-9, 1e-12};

/* A ladder begins with so many steps, or so large a tolerance. It ends at an error near roundoff, at a run that takes
 * LONGEST, s, or before a step or a tolerance below LEAST_SETTING. */
static const double FEWEST = 4, LOOSEST = 1e-2;
static const double MOST_ERROR = 0.3, LEAST_ERROR = 3e-14, LONGEST = 0.1, LEAST_SETTING = 9e-14;

/* ---- Problems ---------------------------------------------------------------------------------------------------- */

/* The coordinates of the library from `first` on are those by hand. */
typedef struct {
    const char *title;
    chain of; /* of chains */
    double duration;
    int n, first;
    tvi_system *system;
    double q[12 + WORK_NUMBERS], p[12 + WORK_NUMBERS], v[WORK_NUMBERS], end[WORK_NUMBERS];
} problem;

static problem problems[] = {
    [WORK_PENDULUM] = {.title = "pendulum", .n = 2, .duration = 5, .of = {1, 1, WORK_GRAVITY, {1.5}, {0}}},
    [WORK_DOUBLE] = {.title = "double pendulum", .n = 4, .duration = 2, .of = {2, 1, WORK_GRAVITY, {1.5, 2}, {0}}},
    [WORK_CHAIN] = {.title = "chain of 10", .n = 20, .duration = 1, .of = {10, 0.1, WORK_GRAVITY, {0}, {0}}},
    [WORK_WATER] = {.title = "water", .n = 9, .duration = 10},
    [WORK_TOP] = {.title = "heavy top", .n = 9, .first = 3, .duration = 10},
};

static tvi_system *make_top(double q[], double p[], double v[])
{
    static const tvi_rigid_body body = {.mass = 1, .inertia = TOP_INERTIA};
    static const tvi_joint pivot = {.kind = TVI_BALL, .other = TVI_WORLD, .point = {0, 0, -TOP_ARM}};
    static const tvi_rigid top = {
        .bodies = 1, .axes = 3, .body = &body, .joints = 1, .joint = &pivot, .gravity = {0, 0, -TOP_GRAVITY}};
    const double sideways[] = {1, 0, 0};
    double mass[12];
    tvi_rigid_motion motion = {.point = {0, 0, -TOP_ARM}, .omega = {0.3, 0.2, 5}};
    tvi_system *system;
    tvi_rigid_turn(sideways, 0.5, motion.quaternion);
    experiment_insist(tvi_rigid_system(&system, &top, NULL, NULL), "a top");
    experiment_insist(tvi_rigid_state(&top, 0, &motion, q, p), "a top");
    experiment_insist(tvi_project(system, 0, q, p), "a top");
    tvi_rigid_masses(&top, mass);
    for (int i = 0; i < 9; i++) v[i] = p[3 + i] / mass[3 + i];
    return system;
}

static tvi_system *make_water(double q[], double p[], double v[])
{
    const scene *s = &longrun_water.scene;
    tvi_system *system, *base = experiment_system(s);
    experiment_insist(tvi_system_constrained(&system, base, longrun_water.m, longrun_water.phi, NULL), "water");
    memcpy(q, s->q, (size_t)s->n * sizeof *q), memcpy(p, s->p, (size_t)s->n * sizeof *p);
    experiment_insist(tvi_project(system, 0, q, p), "water");
    for (int i = 0; i < s->n; i++) v[i] = p[i] / s->mass[i];
    tvi_system_free(base);
    return system;
}

static tvi_system *make_chain(problem *s)
{
    if (s->of.links == LINKS_MOST)
        for (int j = 0; j < LINKS_MOST; j++) s->of.angle[j] = 1.5 - 0.1 * j;
    tvi_system *system = chain_of_places(&s->of, s->q, s->p);
    experiment_insist(tvi_project(system, 0, s->q, s->p), s->title);
    memcpy(s->v, s->p, sizeof s->v);
    return system;
}

/* The end is that of steps of order 20 of which the last halving moves nothing but roundoff. */
static void open_problem(problem *s)
{
    s->system = s == &problems[WORK_TOP]     ? make_top(s->q, s->p, s->v)
                : s == &problems[WORK_WATER] ? make_water(s->q, s->p, s->v)
                                             : make_chain(s);
    tvi_options options;
    double before[WORK_NUMBERS], moved = INFINITY;
    experiment_insist(tvi_options_named("galerkin", 20, &options), s->title);
    for (long steps = 64; moved > 1e-13 && steps < 100000; steps *= 2) {
        double t = 0, q[12 + WORK_NUMBERS], p[12 + WORK_NUMBERS];
        tvi_integrator *integrator;
        memcpy(q, s->q, sizeof q), memcpy(p, s->p, sizeof p), memcpy(before, s->end, sizeof before);
        experiment_insist(tvi_integrator_create(&integrator, s->system, &options), s->title);
        const tvi_status status = tvi_integrate(integrator, s->duration / (double)steps, steps, &t, q, p, NULL, NULL);
        tvi_integrator_free(integrator);
        if (status != TVI_OK) continue;
        memcpy(s->end, q + s->first, sizeof s->end);
        moved = 0;
        for (int i = 0; i < s->n; i++) moved = fmax(moved, fabs(s->end[i] - before[i]));
    }
}

/* ---- Contenders -------------------------------------------------------------------------------------------------- */

typedef enum { GALERKIN, RATTLE, SUNDIALS } family;
typedef struct {
    const char *label;
    family of;
    int order;     /* or a sundials_kind */
    double growth; /* of the steps, or of 1 / tolerance, from point to point */
} competitor;

static const competitor contenders[] = {
    {"galerkin 16", GALERKIN, 16, 1.1892},
    {"RATTLE 2", RATTLE, 2, 2},
    {"RATTLE 4", RATTLE, 4, 2},
    {"RATTLE 6", RATTLE, 6, 1.4142},
    {"RATTLE 8", RATTLE, 8, 1.4142},
    {"RATTLE 10", RATTLE, 10, 1.4142},
    {"IDA index 1", SUNDIALS, SUNDIALS_IDA_1, 3.1623},
    {"IDA index 2", SUNDIALS, SUNDIALS_IDA_2, 3.1623},
    {"CVODE Adams", SUNDIALS, SUNDIALS_ADAMS, 3.1623},
};
enum { CONTENDERS = sizeof contenders / sizeof *contenders };

/* A run of a contender with steps, or a tolerance: a turn of turns.h. */
typedef struct {
    const problem *from;
    const competitor *who;
    work_task task;
    tvi_integrator *integrator;
    double q[12 + WORK_NUMBERS];
    bool is_over;
} attempt;

static void attempt_go(void *ctx)
{
    attempt *a = ctx;
    double t = 0, p[12 + WORK_NUMBERS], v[WORK_NUMBERS];
    const int first = a->who->of == GALERKIN ? 0 : a->from->first;
    memcpy(a->q, a->from->q + first, sizeof a->q - (size_t)first * sizeof *a->q);
    memcpy(p, a->from->p, sizeof p), memcpy(v, a->from->v, sizeof v);
    if (a->who->of == GALERKIN) {
        tvi_integrator_reset(a->integrator);
        const double h = a->task.duration / (double)a->task.steps;
        a->is_over = tvi_integrate(a->integrator, h, a->task.steps, &t, a->q, p, NULL, NULL) == TVI_OK;
    } else if (a->who->of == RATTLE) a->is_over = rattle_run(&a->task, a->who->order, a->q, v);
    else a->is_over = sundials_run(&a->task, (sundials_kind)a->who->order, a->q, v);
}

/* The largest error of a coordinate at the end; infinite where a run failed. */
static double error_of(const attempt *a)
{
    const int first = a->who->of == GALERKIN ? a->from->first : 0;
    double worst = 0;
    for (int i = 0; i < a->from->n; i++) worst = fmax(worst, fabs(a->q[first + i] - a->from->end[i]));
    return a->is_over && isfinite(worst) ? worst : INFINITY;
}

typedef struct {
    double setting, cpu, error;
} point;

static attempt attempt_open(const problem *from, const competitor *who)
{
    attempt a = {.from = from, .who = who, .task = {.duration = from->duration}};
    tvi_options options;
    a.task.problem = (work_problem)(from - problems);
    if (who->of != GALERKIN) return a;
    experiment_insist(tvi_options_named("galerkin", who->order, &options), who->label);
    options.max_tail = -1; /* no step is refused for being too large */
    experiment_insist(tvi_integrator_create(&a.integrator, from->system, &options), who->label);
    return a;
}

/* Sets the steps or the tolerance of point k, and returns h or the tolerance. */
static double attempt_set(attempt *a, int k)
{
    const double by = pow(a->who->growth, k);
    if (a->who->of == SUNDIALS) return a->task.tolerance = LOOSEST / by;
    a->task.steps = (long)ceil(FEWEST * by);
    return a->task.duration / (double)a->task.steps;
}

/* The points whose errors are below MOST_ERROR, from large to small steps or tolerances. */
static int descend(const problem *from, const competitor *who, point points[POINTS_MOST])
{
    attempt a = attempt_open(from, who);
    turn t = {.work = attempt_go, .ctx = &a};
    int count = 0;
    for (int k = 0; count < POINTS_MOST; k++) {
        const double setting = attempt_set(&a, k);
        if (setting < LEAST_SETTING) break;
        attempt_go(&a);
        const double error = error_of(&a);
        if (error > MOST_ERROR) continue;
        turns_time(1, &t);
        points[count++] = (point){setting, t.seconds, error};
        if (error < LEAST_ERROR || t.seconds > LONGEST) break;
    }
    tvi_integrator_free(a.integrator);
    return count;
}

/* The time at which the error comes to be `target`, on the line between two points in logarithms; infinite: never. */
static double time_at(double target, int count, const point points[])
{
    for (int i = 0; i < count; i++) {
        if (points[i].error > target) continue;
        if (i == 0) return points[0].cpu;
        const double x = log(target / points[i - 1].error) / log(points[i].error / points[i - 1].error);
        return points[i - 1].cpu * pow(points[i].cpu / points[i - 1].cpu, x);
    }
    return INFINITY;
}

static void measure(FILE *csv, FILE *table, const problem *from)
{
    double ms[CONTENDERS][TARGETS];
    for (int c = 0; c < CONTENDERS; c++) {
        point points[POINTS_MOST];
        if (contenders[c].of == SUNDIALS && !has_sundials) {
            for (int k = 0; k < TARGETS; k++) ms[c][k] = INFINITY;
            continue;
        }
        experiment_progress("  %s: %s", from->title, contenders[c].label);
        const int count = descend(from, &contenders[c], points);
        for (int i = 0; i < count; i++)
            fprintf(csv, "%s,%s,%.6g,%.4e,%.4e\n", from->title, contenders[c].label, points[i].setting, points[i].cpu,
                    points[i].error);
        for (int k = 0; k < TARGETS; k++) ms[c][k] = 1e3 * time_at(targets[k], count, points);
    }
    for (int k = 0; k < TARGETS; k++) {
        fprintf(table, "| %s | %.0e |", from->title, targets[k]);
        for (int c = 0; c < CONTENDERS; c++)
            if (isfinite(ms[c][k])) fprintf(table, " %.3g |", ms[c][k]);
            else fprintf(table, " - |");
        fprintf(table, "\n");
    }
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    FILE *csv = experiment_csv(&e, "work", "problem,method,setting,cpu_s,error");
    char titles[512] = "problem|error";
    for (int c = 0; c < CONTENDERS; c++) {
        const size_t used = strlen(titles);
        snprintf(titles + used, sizeof titles - used, "|%s (time)", contenders[c].label);
    }
    FILE *table = experiment_table(&e, "work", titles);
    if (!has_sundials) experiment_progress("IDA and CVODE are left out: apt-get install libsundials-dev");
    for (int i = 0; i < WORK_PROBLEMS; i++) {
        open_problem(&problems[i]);
        measure(csv, table, &problems[i]);
        tvi_system_free(problems[i].system);
    }
    experiment_close(csv);
    experiment_close(table);
    return EXIT_SUCCESS;
}
