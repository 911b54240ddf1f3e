/* experiment.c - Opens files, creates methods and makes runs for the programs of the paper's figures (experiment.h). */
#include "experiment.h"
#include "runs/report.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

void experiment_fail(const char *what, const char *why)
{
    fprintf(stderr, "experiments: %s: %s\n", what, why);
    exit(EXIT_FAILURE);
}

void experiment_insist(tvi_status status, const char *what)
{
    if (status != TVI_OK) experiment_fail(what, tvi_last_error());
}

tvi_compiled *experiment_compile(const experiment *e, const tvi_system *system, const tvi_options *options)
{
    char cache[4096];
    tvi_compiled *code;
    snprintf(cache, sizeof cache, "%s/generated", e->dir);
    experiment_insist(tvi_compile(&code, system, options, &(tvi_compiler){.cache = cache}), "a compilation");
    return code;
}

/* ---- Files ---------------------------------------------------------------------------------------------------- */

experiment experiment_begin(int argc, char *argv[])
{
    if (argc != 2) experiment_fail(argv[0], "one argument, the folder to write to");
    if (mkdir(argv[1], 0777) != 0 && errno != EEXIST) experiment_fail(argv[1], strerror(errno));
    return (experiment){argv[1], argc, argv};
}

static FILE *open_file(const experiment *e, const char *name, const char *ending)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.%s", e->dir, name, ending);
    FILE *file = fopen(path, "w");
    if (!file) experiment_fail(path, strerror(errno));
    return file;
}

FILE *experiment_csv(const experiment *e, const char *name, const char *columns)
{
    FILE *csv = open_file(e, name, "csv");
    report_head(csv, e->argc, e->argv);
    fprintf(csv, "# flags of the baselines: %s\n%s\n", baseline_flags, columns);
    return csv;
}

FILE *experiment_table(const experiment *e, const char *name, const char *titles)
{
    FILE *table = open_file(e, name, "md");
    fprintf(table, "|%s|\n|", titles);
    int columns = 1;
    for (const char *c = titles; *c; c++) columns += *c == '|';
    for (int i = 0; i < columns; i++) fprintf(table, "---|");
    fprintf(table, "\n");
    return table;
}

void experiment_close(FILE *file)
{
    const bool written = !ferror(file);
    if (fclose(file) != 0 || !written) experiment_fail("a file", "cannot be written");
}

void experiment_progress(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fprintf(stderr, "\n");
}

void experiment_cell(FILE *table, double error, double lost)
{
    if (!isfinite(error)) fprintf(table, " - |");
    else if (error > lost) fprintf(table, " lost |");
    else fprintf(table, " %.1e |", error);
}

/* ---- Methods -------------------------------------------------------------------------------------------------- */

experiment_method experiment_find(const char *name, int order)
{
    experiment_method m = {.who = {.name = name, .order = order}};
    snprintf(m.label, sizeof m.label, "%s %d", name, order);
    if (tvi_options_named(name, order, &m.who.options) == TVI_OK) {
        m.who.options.max_tail = -1;
        return m;
    }
    m.who.baseline = baseline_find(name, order);
    if (!m.who.baseline) experiment_fail(m.label, "no such method");
    return m;
}

experiment_method experiment_find_with(const char *name, int order, tvi_quadrature quadrature, int points,
                                       const char *said)
{
    experiment_method m = experiment_find(name, order);
    m.who.options.quadrature = quadrature;
    m.who.options.quadrature_points = points;
    snprintf(m.label, sizeof m.label, "%s %d (%s)", name, order, said);
    return m;
}

static runner open_runner(const experiment_method *method, const tvi_system *system, const scene *s, double h)
{
    runner r;
    const tvi_status status = runner_open(&r, system, s, &method->who, h);
    experiment_insist(status, method->label);
    return r;
}

int experiment_degree(const experiment_method *method, const tvi_system *system)
{
    tvi_integrator *integrator;
    if (method->who.baseline) return -1;
    const tvi_status status = tvi_integrator_create(&integrator, system, &method->who.options);
    experiment_insist(status, method->label);
    const int degree = tvi_integrator_options(integrator)->degree;
    tvi_integrator_free(integrator);
    return degree;
}

tvi_system *experiment_system(const scene *s)
{
    tvi_system *system;
    const tvi_status status = scene_system(s, &system);
    experiment_insist(status, s->name);
    return system;
}

/* ---- Runs ----------------------------------------------------------------------------------------------------- */

experiment_end experiment_run(const experiment_method *method, const tvi_system *system, const scene *s, double h,
                              tvi_observer *observer, void *ctx, bool timed)
{
    runner r = open_runner(method, system, s, h);
    experiment_end end = {.cpu = NAN};
    end.status = runner_go(&r, end.q, end.p, observer, ctx);
    end.steps = r.counts.steps;
    end.passes_per_step = (double)r.counts.passes / (double)(end.steps > 0 ? end.steps : 1);
    if (timed && end.status == TVI_OK) end.cpu = runner_time(&r);
    runner_close(&r);
    return end;
}

double experiment_distance(int n, const double q[], const double q_exact[])
{
    double squares = 0;
    for (int i = 0; i < n; i++) squares += (q[i] - q_exact[i]) * (q[i] - q_exact[i]);
    return sqrt(squares);
}

/* ---- The energy along a run ----------------------------------------------------------------------------------- */

experiment_energy experiment_energy_begin(const tvi_system *system, const scene *s)
{
    experiment_energy energy = {.system = system};
    const tvi_status status = tvi_energy(system, 0, s->q, s->p, &energy.start);
    experiment_insist(status, s->name);
    energy.scale = fmax(fabs(energy.start), s->energy_scale);
    return energy;
}

double experiment_energy_note(experiment_energy *energy, double t, const double q[], const double p[])
{
    double H = INFINITY;
    if (tvi_energy(energy->system, t, q, p, &H) != TVI_OK || isnan(H)) H = INFINITY;
    const double e = (H - energy->start) / energy->scale;
    energy->last = e;
    energy->worst = fmax(energy->worst, fabs(e));
    energy->sum += fabs(e);
    energy->count++;
    energy->t += t;
    energy->tt += t * t;
    energy->e += e;
    energy->te += t * e;
    return e;
}

int experiment_energy_watch(long step, double t, const double q[], const double p[], void *energy)
{
    (void)step;
    experiment_energy_note(energy, t, q, p);
    return 0;
}

double experiment_energy_mean(const experiment_energy *energy) { return energy->sum / (double)energy->count; }

double experiment_energy_slope(const experiment_energy *energy)
{
    const double n = (double)energy->count;
    return (n * energy->te - energy->t * energy->e) / (n * energy->tt - energy->t * energy->t);
}

/* ---- Work and precision --------------------------------------------------------------------------------------- */

enum { STEPS_MAX = 32, COLUMNS = 3 };

static experiment_point measure(const experiment_method *method, const scene *s, const tvi_system *system, double h)
{
    experiment_point point = {h, INFINITY, 0, INFINITY, INFINITY, INFINITY};
    experiment_energy energy = experiment_energy_begin(system, s);
    const experiment_end end = experiment_run(method, system, s, h, experiment_energy_watch, &energy, true);
    const double error = experiment_distance(s->n, end.q, s->reference);
    if (end.status != TVI_OK || !isfinite(error) || !isfinite(energy.worst)) return point;
    return (experiment_point){h, end.cpu, end.passes_per_step, experiment_energy_mean(&energy), energy.worst, error};
}

/* The errors no longer fall. */
static bool at_roundoff(const experiment_point *before, const experiment_point *now)
{
    return now->mean_energy < 1e-13 && now->mean_energy > before->mean_energy / 2;
}

/* Returns how many steps of the ladder were run. */
static int descend(const experiment_method *method, const experiment_sweep *sweep, const tvi_system *system,
                   experiment_point points[STEPS_MAX])
{
    int count = 0;
    for (const double *h = sweep->scene->steps; *h > 0 && count < STEPS_MAX; h++) {
        if (count > 1 && *h < sweep->shown[COLUMNS - 1]) {
            const experiment_point *last = &points[count - 1];
            if (last->cpu * last->h / *h > sweep->longest || at_roundoff(last - 1, last)) break;
        }
        points[count++] = measure(method, sweep->scene, system, *h);
    }
    return count;
}

static double error_of(const experiment_sweep *sweep, const experiment_point *point)
{
    return sweep->by_energy ? point->mean_energy : point->error;
}

/* The time at which the error is `target`, on the line between two points in logarithms; infinite: never. */
static double time_at(const experiment_sweep *sweep, double target, int count, const experiment_point points[])
{
    for (int i = 0; i < count; i++) {
        const double error = error_of(sweep, &points[i]);
        if (!(error <= target)) continue;
        if (i == 0 || !isfinite(error_of(sweep, &points[i - 1]))) return points[i].cpu;
        const double before = error_of(sweep, &points[i - 1]), x = log(target / before) / log(error / before);
        return points[i - 1].cpu * pow(points[i].cpu / points[i - 1].cpu, x);
    }
    return INFINITY;
}

/* The point of step h; NULL: none, or its run failed. */
static const experiment_point *find_point(int count, const experiment_point points[], double h)
{
    for (int k = 0; k < count; k++)
        if (points[k].h == h && isfinite(points[k].error)) return &points[k];
    return NULL;
}

static void write_number(FILE *table, const char *format, double x)
{
    fprintf(table, " ");
    if (x > 0 && isfinite(x)) fprintf(table, format, x);
    else fprintf(table, "-");
    fprintf(table, " |");
}

static void write_row(FILE *table, const experiment_sweep *sweep, const experiment_method *method, int degree,
                      int count, const experiment_point points[])
{
    fprintf(table, "| %s |", method->label);
    fprintf(table, degree >= 0 ? " %d |" : " - |", degree);
    for (int i = 0; i < COLUMNS; i++) {
        const experiment_point *point = find_point(count, points, sweep->shown[i]);
        experiment_cell(table, point ? error_of(sweep, point) : INFINITY, 1);
    }
    const experiment_point *middle = find_point(count, points, sweep->shown[1]);
    write_number(table, "%.2g", middle ? middle->passes : 0);
    for (int i = 0; i < COLUMNS; i++)
        write_number(table, "%.2g", 1e3 * time_at(sweep, sweep->targets[i], count, points));
    fprintf(table, "\n");
}

static FILE *open_sweep_table(const experiment *e, const experiment_sweep *sweep)
{
    char titles[512];
    int used = snprintf(titles, sizeof titles, " method | derivatives |");
    for (int i = 0; i < COLUMNS; i++)
        used += snprintf(titles + used, sizeof titles - (size_t)used, " error at h = %.4g |", sweep->shown[i]);
    used += snprintf(titles + used, sizeof titles - (size_t)used, " passes a step |");
    for (int i = 0; i < COLUMNS; i++)
        used += snprintf(titles + used, sizeof titles - (size_t)used, " ms to %.0e (time) %s", sweep->targets[i],
                         i + 1 < COLUMNS ? "|" : "");
    return experiment_table(e, sweep->name, titles);
}

void experiment_sweep_run(const experiment *e, const experiment_sweep *sweep, int count,
                          const experiment_method methods[])
{
    FILE *csv =
        experiment_csv(e, sweep->name, "method,order,degree,h,cpu_s,mean_energy_error,max_energy_error,position_error");
    FILE *table = open_sweep_table(e, sweep);
    tvi_system *system = experiment_system(sweep->scene);
    for (int i = 0; i < count; i++) {
        experiment_point points[STEPS_MAX];
        experiment_progress("  %s: %s", sweep->name, methods[i].label);
        const int degree = experiment_degree(&methods[i], system), done = descend(&methods[i], sweep, system, points);
        for (int k = 0; k < done; k++)
            if (isfinite(points[k].error))
                fprintf(csv, "%s,%d,%d,%.10g,%.4e,%.4e,%.4e,%.4e\n", methods[i].label, methods[i].who.order, degree,
                        points[k].h, points[k].cpu, points[k].mean_energy, points[k].max_energy, points[k].error);
        write_row(table, sweep, &methods[i], degree, done, points);
    }
    tvi_system_free(system);
    experiment_close(csv);
    experiment_close(table);
}
