/* suggest.c - Measures what runs reach with the step of tvi_suggest_step, and what it costs to find: one method on
 * every scene, hard ones rescaled with their own time scale. Writes a table of docs/choosing.md, and says of how many
 * of its cells what was wanted holds. Each says so:
 *   held     the error is at most the wanted one, and a step twice as long is refused, or makes more
 *   short    it is that, and a step twice as long keeps the error, too
 *   refused  no step is suggested, with a reason
 *   missed
 *
 *   suggest DIR METHOD ORDER */
#include "run/suggest.h"
#include "scenes/hard.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double wanted[] = {1e-4, 1e-6, 1e-8, 1e-10};
enum { WANTED = sizeof wanted / sizeof *wanted, MOST = 18 };

/* A scene, where its run ends, and the largest coordinate and momentum. */
typedef struct {
    const scene *s;
    const tvi_system *system;
    const tvi_options *options;
    double end[2 * MOST], size[2];
} trip;

/* Counts of cells. */
enum { HELD, SHORT, REFUSED, MISSED, VERDICTS };
static const char *const verdicts[] = {"held", "short", "refused", "missed"};
typedef struct {
    int count[VERDICTS];
} count;

static int take_sizes(long step, double t, const double q[], const double p[], void *ctx)
{
    trip *to = ctx;
    (void)step, (void)t;
    for (int i = 0; i < to->s->n; i++) {
        to->size[0] = fmax(to->size[0], fabs(q[i]));
        to->size[1] = fmax(to->size[1], fabs(p[i]));
    }
    return 0;
}

/* Returns the steps; *status is that of the run. */
static long travel(const trip *to, const tvi_options *options, double h, double end[], tvi_observer *observer,
                   void *ctx, tvi_status *status)
{
    tvi_integrator *it;
    double t = 0, *q = end, *p = end + to->s->n;
    memcpy(q, to->s->q, (size_t)to->s->n * sizeof *q);
    memcpy(p, to->s->p, (size_t)to->s->n * sizeof *p);
    *status = tvi_integrator_create(&it, to->system, options);
    if (*status != TVI_OK) return 0;
    *status = tvi_integrate_to(it, h, to->s->t_end, &t, q, p, observer, ctx);
    const long steps = tvi_integrator_stats(it)->steps;
    tvi_integrator_free(it);
    return steps;
}

static double error_of(const trip *to, const double end[])
{
    double error = 0;
    for (int i = 0; i < 2 * to->s->n; i++) error = fmax(error, fabs(end[i] - to->end[i]) / to->size[i / to->s->n]);
    return error;
}

/* The error of a run with steps of h; infinite where it fails. */
static double reached_with(const trip *to, double h, long *steps, tvi_status *status)
{
    double end[2 * MOST];
    *steps = travel(to, to->options, h, end, NULL, NULL, status);
    return *status == TVI_OK ? error_of(to, end) : INFINITY;
}

static int judge(const trip *to, double h, double error, double reached)
{
    long steps;
    tvi_status status;
    if (reached > error) return MISSED;
    const bool is_whole = 2 * fabs(h) > to->s->t_end; /* of a run of one step or two none is twice as long */
    return is_whole || reached_with(to, 2 * h, &steps, &status) > error ? HELD : SHORT;
}

static void write_cell(const trip *to, double error, count *cells, FILE *out)
{
    tvi_step_suggestion found;
    long steps;
    tvi_status status =
        tvi_compute_step_suggestion(to->system, to->options, 0, to->s->q, to->s->p, to->s->t_end, error, &found);
    if (status != TVI_OK) {
        fprintf(out, " refused: %s |", tvi_last_error());
        cells->count[REFUSED]++;
        return;
    }
    const double reached = reached_with(to, found.h, &steps, &status);
    const int verdict = judge(to, found.h, error, reached);
    cells->count[verdict]++;
    fprintf(out, " %s: ", verdicts[verdict]);
    if (status == TVI_OK) fprintf(out, "%.1e ", reached);
    else fprintf(out, "%s ", tvi_status_string(status));
    fprintf(out, "(%.3g: %ld, %ld) |", found.h, found.step_count_spent_on_search, steps);
}

static void write_row(const trip *to, count *cells, FILE *out)
{
    if (tvi_options_check(to->system, to->options, NULL) != TVI_OK) return;
    fprintf(out, "| %s |", to->s->name);
    for (int i = 0; i < WANTED; i++) write_cell(to, wanted[i], cells, out);
    fprintf(out, "\n");
}

/* fine: a step that makes a run right to roundoff. */
static bool write_scene(const scene *s, tvi_rescale_fn *scale, const tvi_options *options, double fine, count *cells,
                        FILE *out)
{
    tvi_system *base, *rescaled = NULL;
    tvi_status status = scene_system(s, &base);
    if (status == TVI_OK && scale) status = tvi_system_rescaled(&rescaled, base, scale, NULL);
    trip to = {.s = s, .system = rescaled ? rescaled : base, .options = options};
    if (status == TVI_OK) (void)travel(&to, NULL, fine, to.end, take_sizes, &to, &status);
    if (s->reference) memcpy(to.end, s->reference, 2 * (size_t)s->n * sizeof *to.end);
    if (status == TVI_OK) write_row(&to, cells, out);
    tvi_system_free(rescaled);
    tvi_system_free(base);
    return status == TVI_OK;
}

static void print_count(const char *what, const count *cells)
{
    printf("%s:", what);
    for (int i = 0; i < VERDICTS; i++) printf(" %s %d", verdicts[i], cells->count[i]);
    printf("\n");
}

static bool write_table(const tvi_options *options, FILE *out)
{
    count fixed = {0}, hard = {0};
    bool good = true;
    fprintf(out, "| scene |");
    for (int i = 0; i < WANTED; i++) fprintf(out, " %.0e wanted (chaotic) |", wanted[i]);
    fprintf(out, "\n|---|---|---|---|---|\n");
    for (int list = 0; list < 2; list++)
        for (const scene *const *s = list ? general_scenes : scenes; *s; s++)
            good &= write_scene(*s, NULL, options, (*s)->steps[0] / 6, &fixed, out);
    for (const hard_scene *const *s = hard_scenes; *s; s++)
        good &= write_scene(&(*s)->scene, (*s)->scale, options, 0.3, &hard, out);
    print_count("fixed steps", &fixed);
    print_count("rescaled", &hard);
    return good;
}

int main(int argc, char *argv[])
{
    char path[4096];
    tvi_options options;
    if (argc != 4 || tvi_options_named(argv[2], (int)strtol(argv[3], NULL, 10), &options) != TVI_OK ||
        snprintf(path, sizeof path, "%s/suggest.md", argv[1]) >= (int)sizeof path) {
        fprintf(stderr, "usage: suggest DIR METHOD ORDER\n");
        return EXIT_FAILURE;
    }
    FILE *out = fopen(path, "w");
    bool good = out && write_table(&options, out);
    good &= out && fclose(out) == 0;
    if (!good) fprintf(stderr, "suggest: %s: %s\n", path, strerror(errno));
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
