/* maps.c - Makes two maps of order and chaos, by ensembles: Henon and Heiles' problem at H = 1/8, on the surface x = 0,
 * and a small planet inside of a giant's orbit, over its semimajor axis and eccentricity. For docs/ensembles.md: writes
 * DIR/section.csv, DIR/henon_heiles.csv, DIR/planet.csv and DIR/maps.md.
 *
 *   maps DIR */
#include "experiments/experiment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { N = 2, ROWS = 2 * N };

typedef struct {
    const char *name, *title, *columns; /* of the file */
    tvi_potential_fn *potential;
    double h;
    long steps;
    int side; /* starts along each axis, */
    double from[2], to[2];
    bool (*start)(const double at[2], double q[], double p[]); /* false: there is no such orbit */
} map;

/* A member: where it is in the map, and with d_k the length of its tangent vector at t_k the sums of MEGNO: Y_k =
 * (2/t_k) sum_{j <= k} t_j ln(d_j/d_{j-1}), MEGNO = (1/t_k) sum_{j <= k} (t_j - t_{j-1}) Y_j (docs/chaos.md). */
typedef struct {
    double at[2], t, weighted, area;
} place;

typedef struct {
    int members;
    double *t, *q, *p, *D; /* D: a column */
    tvi_status *status;
    place *places;
    tvi_progress_bar bar;
} orbits;

static double seconds(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double *doubles(size_t count)
{
    double *x = calloc(count, sizeof *x);
    if (!x) abort();
    return x;
}

/* ---- The two problems -------------------------------------------------------------------------------------------- */

static const double ENERGY = 0.125;

static jet henon_heiles(const jet q[], jet t, void *ctx)
{
    (void)t, (void)ctx;
    const jet cubic = jet_sub(jet_mul(jet_sqr(q[0]), q[1]), jet_div(jet_pow(q[1], 3), 3));
    return jet_add(jet_mul(0.5, jet_dot(q, q, N)), cubic);
}

/* On x = 0 at (y, p_y), p_x > 0. */
static bool start_on_surface(const double at[2], double q[], double p[])
{
    const double y = at[0], square = 2 * ENERGY - at[1] * at[1] - y * y + 2 * y * y * y / 3;
    q[0] = 0, q[1] = y;
    p[0] = sqrt(fmax(square, 0)), p[1] = at[1];
    return square > 0;
}

/* The giant: a thousandth of the sun, on a circle of radius 1. */
static const double GIANT = 1e-3;

static jet restricted(const jet q[], jet t, void *ctx)
{
    (void)ctx;
    const jet X = jet_cos(jet_mul(sqrt(1 + GIANT), t)), Y = jet_sin(jet_mul(sqrt(1 + GIANT), t));
    const jet apart = jet_add(jet_sqr(jet_sub(q[0], X)), jet_sqr(jet_sub(q[1], Y)));
    const jet indirect = jet_add(jet_mul(q[0], X), jet_mul(q[1], Y));
    const jet of_giant = jet_mul(GIANT, jet_sub(indirect, jet_pow(apart, -0.5)));
    return jet_sub(of_giant, jet_pow(jet_dot(q, q, N), -0.5));
}

/* At its aphelion, in line with the giant, of semimajor axis a and eccentricity e. */
static bool start_planet(const double at[2], double q[], double p[])
{
    const double a = at[0], e = at[1];
    q[0] = -a * (1 + e), q[1] = 0;
    p[0] = 0, p[1] = -sqrt((1 - e) / (a * (1 + e)));
    return true;
}

static const map maps[] = {
    {"henon_heiles",
     "Henon and Heiles, (y, p_y)",
     "y,p_y,megno",
     henon_heiles,
     0.5,
     600,
     200,
     {-0.5, -0.5},
     {0.7, 0.5},
     start_on_surface},
    {"planet", "planet, (a, e)", "a,e,megno", restricted, 0.25, 5000, 100, {0.55, 0}, {0.8, 0.4}, start_planet},
};

/* ---- MEGNO ------------------------------------------------------------------------------------------------------- */

/* After each step: the sums, and the vector of each member back to length 1. */
static int note(long step, int members, const double t[], const double q[], const double p[], const tvi_status status[],
                void *ctx)
{
    orbits *o = ctx;
    for (int m = 0; m < members; m++) {
        place *at = &o->places[m];
        double square = 0;
        if (status[m] != TVI_OK) continue;
        for (int row = 0; row < ROWS; row++) square += o->D[row * members + m] * o->D[row * members + m];
        for (int row = 0; row < ROWS; row++) o->D[row * members + m] /= sqrt(square);
        at->weighted += t[m] * log(square) / 2;
        at->area += 2 / t[m] * at->weighted * (t[m] - at->t);
        at->t = t[m];
    }
    return tvi_progress(step, t[0], q, p, &o->bar);
}

static orbits start_orbits(const map *drawn)
{
    const int most = drawn->side * drawn->side;
    const size_t room = (size_t)most;
    orbits o = {.t = doubles(room),
                .q = doubles(N * room),
                .p = doubles(N * room),
                .D = doubles(ROWS * room),
                .status = calloc(room, sizeof *o.status),
                .places = calloc(room, sizeof *o.places),
                .bar = {.steps = drawn->steps}};
    double *start = doubles(ROWS * room);
    if (!o.status || !o.places) abort();
    for (int k = 0; k < most; k++) {
        place *at = &o.places[o.members];
        double *x = start + ROWS * o.members;
        for (int axis = 0; axis < 2; axis++) {
            const double part = (axis == 0 ? k % drawn->side : k / drawn->side) + 0.5;
            at->at[axis] = drawn->from[axis] + (drawn->to[axis] - drawn->from[axis]) * part / drawn->side;
        }
        if (drawn->start(at->at, x, x + N)) o.members++;
    }
    for (int k = 0; k < ROWS * o.members; k++) {
        const int row = k / o.members, m = k % o.members;
        *(row < N ? &o.q[k] : &o.p[k - N * o.members]) = start[ROWS * m + row];
        o.D[k] = 0.5;
    }
    free(start);
    return o;
}

static void end_orbits(orbits *o) { free(o->t), free(o->q), free(o->p), free(o->D), free(o->status), free(o->places); }

/* A row of the table: members, of which failed and chaotic, and the time on the wall. */
static void write_map(FILE *table, const experiment *e, const map *drawn)
{
    tvi_system *system;
    tvi_ensemble *ensemble;
    orbits o = start_orbits(drawn);
    int failed = 0, chaotic = 0;
    experiment_insist(tvi_system_potential(&system, N, NULL, drawn->potential, NULL), drawn->name);
    experiment_insist(tvi_ensemble_create(&ensemble, system, NULL, o.members, 0), drawn->name);
    const tvi_ensemble_plan plan = {
        .h = drawn->h, .steps = drawn->steps, .D = o.D, .columns = 1, .observer = note, .ctx = &o};
    const double begin = seconds();
    experiment_insist(tvi_ensemble_run(ensemble, &plan, o.t, o.q, o.p, o.status), drawn->name);
    const double taken = seconds() - begin;
    FILE *csv = experiment_csv(e, drawn->name, drawn->columns);
    for (int m = 0; m < o.members; m++) {
        const place *at = &o.places[m];
        const double megno = o.status[m] == TVI_OK ? at->area / at->t : NAN;
        fprintf(csv, "%.6g,%.6g,%.4g\n", at->at[0], at->at[1], megno);
        failed += o.status[m] != TVI_OK;
        chaotic += megno > 3;
    }
    experiment_close(csv);
    fprintf(table, "| %s | %d | %ld | %d | %d | %.0f |\n", drawn->title, o.members, drawn->steps, chaotic, failed,
            taken);
    experiment_progress("maps: %s, %.0f s", drawn->name, taken);
    tvi_ensemble_free(ensemble);
    tvi_system_free(system);
    end_orbits(&o);
}

/* ---- The section ------------------------------------------------------------------------------------------------- */

enum { ORBITS = 96, PASSAGES_STEPS = 2000 };

static jet surface(const jet q[], const jet p[], jet t, void *ctx)
{
    (void)p, (void)t, (void)ctx;
    return q[0];
}

static int pass(int member, int which, double t, const double q[], const double p[], void *ctx)
{
    (void)which, (void)t;
    fprintf(ctx, "%d,%.6f,%.6f\n", member, q[1], p[1]);
    return 0;
}

static void write_section(const experiment *e)
{
    static double t[ORBITS], q[N * ORBITS], p[N * ORBITS];
    tvi_status status[ORBITS];
    tvi_system *system;
    tvi_ensemble *ensemble;
    tvi_event *event;
    FILE *csv = experiment_csv(e, "section", "orbit,y,p_y");
    int members = 0;
    for (int k = 0; k < ORBITS; k++) {
        double x[N], y[N];
        const double at[] = {k % 2 ? 0.1 : -0.45 + 1.1 * k / ORBITS, k % 2 ? 0.48 * k / ORBITS : 0};
        if (!start_on_surface(at, x, y)) continue;
        for (int i = 0; i < N; i++) q[i * ORBITS + members] = x[i], p[i * ORBITS + members] = y[i];
        members++;
    }
    for (int row = 1; row < N; row++) { /* without the gaps */
        memmove(q + row * members, q + row * ORBITS, (size_t)members * sizeof *q);
        memmove(p + row * members, p + row * ORBITS, (size_t)members * sizeof *p);
    }
    experiment_insist(tvi_system_potential(&system, N, NULL, henon_heiles, NULL), "the section");
    experiment_insist(tvi_event_create(&event, N, TVI_RISING, false, surface, NULL), "the section");
    experiment_insist(tvi_ensemble_create(&ensemble, system, NULL, members, 0), "the section");
    const tvi_event *const events[] = {event};
    const tvi_ensemble_plan plan = {
        .h = 0.5, .steps = PASSAGES_STEPS, .events = events, .event_count = 1, .on_event = pass, .ctx = csv};
    experiment_insist(tvi_ensemble_run(ensemble, &plan, t, q, p, status), "the section");
    experiment_close(csv);
    tvi_ensemble_free(ensemble);
    tvi_event_free(event);
    tvi_system_free(system);
}

int main(int argc, char *argv[])
{
    const experiment e = experiment_begin(argc, argv);
    write_section(&e);
    FILE *table = experiment_table(&e, "maps",
                                   " map | orbits | steps | MEGNO above 3 (chaotic) | ended by a close "
                                   "encounter (chaotic) | s (time) ");
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++) write_map(table, &e, &maps[i]);
    experiment_close(table);
    return EXIT_SUCCESS;
}
