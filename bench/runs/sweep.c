/* sweep.c - Runs a contender over a scene's ladder of steps (sweep.h). */
#include "sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The settings of a baseline that chooses its own steps. */
static const double tolerances[] = {1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 0};

enum { LADDER_MOST = 32 };

/* One contender on one scene. rung[i] is the run at ladder[i], from the coarsest on; rung[i].scene is NULL
 * before it. */
typedef struct {
    sweep *sweep;
    const tvi_system *system;
    const scene *scene;
    const contender *who;
    const double *ladder;
    int rungs;
    double end; /* of its share of the time */
    run rung[LADDER_MOST];
    const char *why; /* it ended */
} line;

static bool good(const run *r) { return r->scene && r->status == TVI_OK; }

/* ---- When a line ends -------------------------------------------------------------------------------------------- */

static double size_of(const scene *s)
{
    double size = 0;
    for (int i = 0; i < 2 * s->n; i++) size = fmax(size, fabs(s->reference[i]));
    return size;
}

/* The error is small and did not fall as h^order says, even to the square root; of a tolerance, to a half. */
static bool at_roundoff(const run *before, const run *row)
{
    const bool adaptive = row->who->baseline && row->who->baseline->adaptive;
    const double fall = adaptive ? 0.5 : pow(row->h / before->h, row->order / 2.0);
    return row->end_error < 1e-9 * size_of(row->scene) && row->end_error > before->end_error * fall;
}

/* Nothing right in it: a longer step has no use. */
static bool useless(const run *r) { return !(r->end_error < size_of(r->scene)); }

/* Whether another run was better: of the same side, symplectic if this one is, with smaller errors, and in a
 * `dearest`th of the time. */
static bool outdone(const sweep *b, const run *r)
{
    const report *all = &b->report;
    if (!(b->dearest > 0)) return false;
    for (const run *row = all->rows; row < all->rows + all->count; row++)
        if (row->scene == r->scene && !row->who->baseline == !r->who->baseline &&
            row->who->symplectic >= r->who->symplectic && row->energy_error <= r->energy_error &&
            row->position_error <= r->position_error && row->cpu * b->dearest < r->cpu)
            return true;
    return false;
}

/* The time the next rung will take, from the last one that ended well: the time is proportional to the steps, or half
 * as much again for a tenth of the tolerance. */
static double expected(const run *last, double setting)
{
    const bool adaptive = last->who->baseline && last->who->baseline->adaptive;
    return last->whole * (adaptive ? 1.5 : last->setting / setting);
}

/* ---- A line ------------------------------------------------------------------------------------------------------ */

static void remark(line *l, int i, const char *what, const char *why)
{
    report_remark(&l->sweep->report, "%s: %s %s %d %s %.4g%s", what, l->scene->name, l->who->name, l->who->order,
                  l->who->baseline && l->who->baseline->adaptive ? "tolerance" : "h =", l->ladder[i], why);
}

static void skip_from(line *l, int i, double cost, double left)
{
    char why[128];
    snprintf(why, sizeof why, " and on: %.2f s expected, %.2f s left", cost, fmax(left, 0));
    remark(l, i, "skipped", why);
    l->sweep->skipped += l->rungs - i;
    l->why = "budget";
}

/* Time left for one run. */
static double left_for(const line *l)
{
    const double left = l->end - run_clock();
    return l->sweep->longest > 0 ? fmin(left, l->sweep->longest) : left;
}

static tvi_status climb_to(line *l, int i)
{
    run *r = &l->rung[i];
    char why[128];
    run_contender(l->system, l->scene, l->who, l->ladder[i], run_clock() + left_for(l), r);
    if (r->status == TVI_OK) return TVI_OK;
    if (r->status == TVI_ESTOPPED) {
        l->sweep->skipped += l->rungs - i;
        remark(l, i, "skipped", " and on: not over in its time");
        return r->status;
    }
    l->sweep->failed++;
    snprintf(why, sizeof why, " in step %ld of %ld: %s", r->failed_step, r->steps, tvi_status_string(r->status));
    remark(l, i, l->who->baseline ? "failed" : "refused", why);
    return r->status;
}

/* From rung i to finer ones, until one succeeds, or one is stopped. Returns it. */
static int first_good(line *l, int i)
{
    for (; i < l->rungs; i++) {
        const tvi_status status = climb_to(l, i);
        if (status == TVI_OK || status == TVI_ESTOPPED) break;
    }
    return i;
}

/* To finer rungs than `from` until the end, roundoff, or no time is left. */
static void refine(line *l, int from)
{
    for (int i = from + 1; i < l->rungs; i++) {
        const run *before = &l->rung[i - 1];
        const double cost = expected(before, l->ladder[i]), left = left_for(l);
        report_error *const error = l->sweep->enough_of ? l->sweep->enough_of : report_position_error;
        if (error(before) < l->sweep->enough) {
            l->why = "accurate enough";
            return;
        }
        if (outdone(l->sweep, before)) {
            remark(l, i, "skipped", " and on: a more accurate run is far cheaper");
            l->sweep->skipped += l->rungs - i;
            l->why = "outdone";
            return;
        }
        if (cost > left) {
            skip_from(l, i, cost, left);
            return;
        }
        i = first_good(l, i);
        if (i == l->rungs) break;
        if (l->rung[i].status == TVI_ESTOPPED || at_roundoff(before, &l->rung[i])) {
            l->why = l->rung[i].status == TVI_ESTOPPED ? "budget" : "roundoff";
            return;
        }
    }
    l->why = "end of the ladder";
}

/* To coarser rungs than `from` until the first failure, which says that the rest would fail too, or no digit
 * is right. */
static void coarsen(line *l, int from)
{
    for (int i = from - 1; i >= 0 && !useless(&l->rung[i + 1]); i--)
        if (climb_to(l, i) != TVI_OK) return;
}

/* From rung `start`, down to the first that succeeds, or else up to the first that fails; then down. Returns the
 * coarsest that was of use: where the next line had best start. */
static int walk(line *l, int start)
{
    const int first = first_good(l, start);
    if (first == l->rungs || l->rung[first].status != TVI_OK) {
        l->why = "no step succeeded";
        return start;
    }
    if (first == start) coarsen(l, first);
    refine(l, first);
    for (int i = 0; i < l->rungs; i++)
        if (good(&l->rung[i]) && !useless(&l->rung[i])) return i;
    return start;
}

static bool report_line(line *l, double begin, double end)
{
    const run *from = NULL, *to = NULL;
    for (const run *r = l->rung; r < l->rung + l->rungs; r++) {
        if (!good(r)) continue;
        if (!report_row(&l->sweep->report, r)) return false;
        from = from ? from : r;
        to = r;
    }
    fprintf(stderr, "%3.0f%%  %-16s%-24s%2d", 100 * (run_clock() - begin) / (end - begin), l->scene->name, l->who->name,
            l->who->order);
    if (to)
        fprintf(stderr, "  h %-8.4g to %-9.4g error %-8.1e to %-8.1e", from->h, to->h, from->end_error, to->end_error);
    fprintf(stderr, "  (%s)\n", l->why);
    return true;
}

/* ---- A scene ----------------------------------------------------------------------------------------------------- */

static bool serves(sweep *b, const tvi_system *system, const scene *s, const contender *who)
{
    const char *why = NULL;
    if (b->only && strcmp(b->only, who->name) != 0) return false;
    if (who->baseline) return baseline_serves(who->baseline, s);
    if (tvi_options_check(system, &who->options, &why) == TVI_OK) return true;
    report_remark(&b->report, "refused: %s %s %d: %s", s->name, who->name, who->order, why);
    return false;
}

/* The contender with code for the scene; NULL where none can be made. */
static const contender *compile(sweep *b, const tvi_system *system, const scene *s, const contender *who)
{
    tvi_compiled *code;
    if (b->compiled_count == SWEEP_COMPILED_MOST) return NULL;
    const tvi_status status = tvi_compile(&code, system, &who->options, &(tvi_compiler){.cache = ""});
    if (status != TVI_OK) report_remark(&b->report, "not compiled: %s %s: %s", s->name, who->name, tvi_last_error());
    if (status != TVI_OK) return NULL;
    contender *dressed = &b->compiled[b->compiled_count++];
    *dressed = *who;
    dressed->options.compiled = code;
    return dressed;
}

void sweep_close(sweep *b)
{
    while (b->compiled_count > 0) tvi_compiled_free((tvi_compiled *)b->compiled[--b->compiled_count].options.compiled);
}

double sweep_share(double end, double part)
{
    const double now = run_clock();
    return now + (end - now) * part;
}

static bool sweep_system(sweep *b, const tvi_system *system, const scene *s, const contenders *list, double end)
{
    int start = 0;
    for (int i = 0; i < list->count; i++) {
        const contender *who = &list->of[i];
        if (!serves(b, system, s, who)) continue;
        if (who->is_compiled && !(who = compile(b, system, s, who))) continue;
        const bool adaptive = who->baseline && who->baseline->adaptive;
        line l = {.sweep = b, .system = system, .scene = s, .who = who, .ladder = adaptive ? tolerances : s->steps};
        while (l.rungs < LADDER_MOST && l.ladder[l.rungs] > 0) l.rungs++;
        l.end = sweep_share(end, fmin(1, 2.0 / (list->count - i)));
        const int coarsest = walk(&l, adaptive ? 0 : start);
        if (!adaptive) start = coarsest;
        if (!report_line(&l, b->begin, b->end)) return false;
    }
    return true;
}

bool sweep_scene(sweep *b, const scene *s, const contenders *list, double end)
{
    tvi_system *system;
    const tvi_status status = scene_system(s, &system);
    if (status != TVI_OK) {
        report_remark(&b->report, "failed: %s: %s", s->name, tvi_status_string(status));
        return false;
    }
    b->failed = b->skipped = 0;
    report_scene(&b->report, s);
    const bool done = sweep_system(b, system, s, list, end);
    report_remark(&b->report, "%s: %ld runs were refused or failed, %ld were skipped", s->name, b->failed, b->skipped);
    tvi_system_free(system);
    return done;
}

void sweep_insist_on_one_thread(char *const argv[])
{
    const char *threads = getenv("OPENBLAS_NUM_THREADS");
    if (threads && strcmp(threads, "1") == 0) return;
    if (setenv("OPENBLAS_NUM_THREADS", "1", 1) == 0) execv("/proc/self/exe", argv);
    perror("cannot restart with OPENBLAS_NUM_THREADS=1");
    exit(EXIT_FAILURE);
}
