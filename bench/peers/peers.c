/* peers.c - measures error against time of this library, REBOUND and heyoka on the same problems: peers DIR. Writes
 * DIR/peers.csv, and the table DIR/peers.md of docs/performance.md. */
#include "adaptive/adaptive.h"
#include "peer.h"

#include <math.h>
#include <stdlib.h>

const char *peers_folder;

/* ---- Problems ---------------------------------------------------------------------------------------------------- */

#define LIST(...)                                                                                                      \
    (const double[]) { __VA_ARGS__, 0 }

typedef struct {
    const char *name, *title;
    const scene *scene;
    const hard_scene *hard;
    int bodies, axes;
    double G;
    const double *steps, *map_steps; /* as in problem */
    double units;                    /* of time in the run; times are given per unit */
    const char *unit;
    const double *bounds; /* errors of the rows */
} question;

static const question questions[] = {
    {"planets", "Sun and eight planets, 250 years", &scene_planets, NULL, 9, 3, 1,
     LIST(24, 20, 15, 12, 10, 8, 7.5, 6, 5, 4, 3, 2), LIST(16, 12, 10, 8, 7.5, 6, 5, 4, 3, 2.5, 2, 1.5, 1, 0.5),
     91320 / 365.25, "a year", LIST(1e-4, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)},
    {"outer", "Outer Solar System, 548 years", &scene_solar, NULL, 6, 3, 2.95912208286e-4,
     LIST(1250, 1000, 800, 625, 500, 400, 320, 250, 200, 125), LIST(800, 500, 400, 250, 200, 125, 100, 50, 25, 10, 5),
     200000 / 365.25, "a year", LIST(1e-4, 1e-6, 1e-8, 1e-10)},
    {"eccentric", "Kepler, e = 0.9, 100 revolutions", &hard_kepler_90.scene, &hard_kepler_90, 1, 2, 1,
     LIST(ADAPTIVE_S_90 / 6, ADAPTIVE_S_90 / 8, ADAPTIVE_S_90 / 10, ADAPTIVE_S_90 / 12, ADAPTIVE_S_90 / 15,
          ADAPTIVE_S_90 / 20),
     LIST(ADAPTIVE_REVOLUTION, ADAPTIVE_REVOLUTION / 10, ADAPTIVE_REVOLUTION / 100), 100, "a revolution",
     LIST(1e-6, 1e-8, 1e-10)},
    {"pythagorean", "Pythagorean three bodies, to t = 70", &hard_pythagorean.scene, &hard_pythagorean, 3, 2, 1,
     LIST(1.4, 1.2, 1, 0.9, 0.8, 0.6, 0.4, 0.3, 0.2), NULL, 1, "a run", LIST(1e-2, 1e-4)},
    {"henon_heiles", "Henon-Heiles, H = 1/8, to t = 100", &scene_henon_heiles_8, NULL, 0, 2, 1,
     LIST(2, 1.5625, 1.25, 1, 0.78125, 0.625, 0.5, 0.390625, 0.25), NULL, 1, "a run", LIST(1e-4, 1e-6, 1e-8, 1e-10)},
};
enum { QUESTIONS = sizeof questions / sizeof *questions };

/* In the words of programs for bodies, with v = p/m. */
static problem problem_of(const question *of)
{
    const scene *s = of->scene;
    problem p = {.n = s->n,
                 .bodies = of->bodies,
                 .axes = of->axes,
                 .G = of->G,
                 .t_end = s->t_end,
                 .steps = of->steps,
                 .map_steps = of->map_steps,
                 .scene = s,
                 .hard = of->hard};
    for (int i = 0; i < s->n; i++) {
        const double m = s->mass ? s->mass[i] : 1;
        p.q[i] = s->q[i], p.v[i] = s->p[i] / m;
        p.mass[i / of->axes] = of->bodies == 1 ? 0 : m;
    }
    return p;
}

static double error_of(const question *of, const double q[])
{
    return of->hard ? adaptive_error(of->hard, of->scene->t_end, q)
                    : experiment_distance(of->scene->n, q, of->scene->reference);
}

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

/* Turns of all runs of a problem; in a turn each has at least so long, s, and runs at least once. */
enum { TURNS = 5, RUNS_MAX = 256 };
static const double TURN = 0.01;
static const double USELESS = 0.1; /* a run with a larger error is left out */

typedef struct {
    const question *question;
    const problem *problem;
    const peer *peer;
    double setting, seconds, error; /* seconds: the least; infinite where it fails */
} measured;

static bool run_once(measured *m)
{
    double q[PEER_N_MAX];
    void *one = m->peer->open(m->peer, m->problem, m->setting);
    if (!one) return false;
    const double begin = run_clock();
    const bool good = m->peer->go(one, q);
    const double seconds = run_clock() - begin;
    m->peer->close(one);
    if (!good) return false;
    m->error = error_of(m->question, q);
    if (!(m->error < USELESS)) return false;
    m->seconds = fmin(m->seconds, seconds);
    return true;
}

static int add_peer(measured runs[], int count, const question *of, const problem *p, const peer *who)
{
    const double *setting = who->settings(who, p);
    for (; setting && *setting > 0; setting++) {
        measured m = {of, p, who, *setting, INFINITY, NAN};
        if (!run_once(&m)) continue;
        if (count == RUNS_MAX) experiment_fail(of->title, "more runs than RUNS_MAX");
        runs[count++] = m;
    }
    return count;
}

/* ---- The table --------------------------------------------------------------------------------------------------- */

static const peer_program *programs[3];

static const measured *fastest(const measured runs[], int count, const peer *who, double bound)
{
    const measured *best = NULL;
    for (const measured *m = runs; m < runs + count; m++)
        if ((!who || m->peer == who) && m->error <= bound && (!best || m->seconds < best->seconds)) best = m;
    return best;
}

/* Time of the fastest run of each with at most this error; the fastest of all is bold. */
static void write_row(FILE *table, const measured runs[], int count, double bound)
{
    const question *of = runs->question;
    const measured *first = fastest(runs, count, NULL, bound);
    fprintf(table, "| %s, us %s | %.0e |", of->title, of->unit, bound);
    for (int i = 0; i < 3; i++)
        for (const peer *who = programs[i] ? programs[i]->peers : NULL; who && who->name; who++) {
            const measured *best = fastest(runs, count, who, bound);
            const char *mark = best == first ? "**" : "";
            if (best) fprintf(table, " %s%.3g%s (%.4g) |", mark, 1e6 * best->seconds / of->units, mark, best->setting);
            else fprintf(table, " - |");
        }
    fprintf(table, "\n");
}

static FILE *open_table(const experiment *e)
{
    char titles[1024];
    int length = snprintf(titles, sizeof titles, "problem|error");
    for (int i = 0; i < 3; i++)
        for (const peer *who = programs[i] ? programs[i]->peers : NULL; who && who->name; who++)
            length += snprintf(titles + length, sizeof titles - (size_t)length, "|%s (time)", who->name);
    return experiment_table(e, "peers", titles);
}

static void write_versions(FILE *table)
{
    static const char *const names[] = {"tvi", "REBOUND", "heyoka"};
    fprintf(table, "\nMeasured:");
    for (int i = 0; i < 3; i++)
        if (programs[i]) fprintf(table, " %s %s;", names[i], programs[i]->version());
        else fprintf(table, " without %s, which was not there;", names[i]);
    fprintf(table, " gcc %s.\n", __VERSION__);
}

/* ---- All of it --------------------------------------------------------------------------------------------------- */

static void measure(const question *of, const problem *p, FILE *table, FILE *csv)
{
    static measured runs[RUNS_MAX];
    int count = 0;
    for (int i = 0; i < 3; i++)
        for (const peer *who = programs[i] ? programs[i]->peers : NULL; who && who->name; who++)
            count = add_peer(runs, count, of, p, who);
    for (int turn = 0; turn < TURNS; turn++)
        for (measured *m = runs; m < runs + count; m++)
            for (const double begin = run_clock(); run_once(m) && run_clock() - begin < TURN;) continue;
    for (const measured *m = runs; m < runs + count; m++)
        fprintf(csv, "%s,\"%s\",%.6g,%.4e,%.4e,%.4e\n", of->name, m->peer->name, m->setting, m->seconds,
                1e6 * m->seconds / of->units, m->error);
    for (const double *bound = of->bounds; *bound > 0 && count > 0; bound++) write_row(table, runs, count, *bound);
    experiment_progress("%s: %d runs", of->title, count);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    peers_folder = e.dir;
    programs[0] = &peers_of_tvi;
    programs[1] = &peers_of_rebound;
    programs[2] = &peers_of_heyoka;
    FILE *table = open_table(&e), *csv = experiment_csv(&e, "peers", "problem,peer,setting,seconds,us_a_unit,error");
    static problem problems[QUESTIONS];
    for (int i = 0; i < QUESTIONS; i++) {
        problems[i] = problem_of(&questions[i]);
        measure(&questions[i], &problems[i], table, csv);
    }
    write_versions(table);
    experiment_close(table);
    experiment_close(csv);
    return EXIT_SUCCESS;
}
