/* fpu.c - Runs the paper's Fermi-Pasta-Ulam chain, w = 50: the energies I_1, I_2, I_3 of the stiff springs and their
 * sum I at h = 0.03 and 0.01 to t = 200. */
#include "experiment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double w = 50, t_end = 200, accurate_step = 0.01;
/* t_early: an error of the start has grown twentyfold; a multiple of all steps */
static const double t_early = 9.99;
enum { SPRINGS = 3, SAMPLES = 2000, N = 6 };

/* I_j = (y_{1,j}^2 + w^2 x_{1,j}^2)/2, x_{1,j} = (q_{2j} - q_{2j-1})/sqrt 2, likewise y from p. */
static double spring(int j, const double q[], const double p[])
{
    const double x = (q[2 * j + 1] - q[2 * j]) / sqrt(2), y = (p[2 * j + 1] - p[2 * j]) / sqrt(2);
    return (y * y + w * w * x * x) / 2;
}

/* I_j at SAMPLES times up to t_end, and q at t_early. */
typedef struct {
    double spring[SAMPLES + 1][SPRINGS], early[N];
} record;

typedef struct {
    experiment_energy energy;
    FILE *csv;
    const char *method;
    double h, worst; /* max |I - I(0)| */
    record *now;
} watcher;

static int watch(long step, double t, const double q[], const double p[], void *ctx)
{
    watcher *x = ctx;
    double I[SPRINGS], sum = 0;
    experiment_energy_note(&x->energy, t, q, p);
    for (int j = 0; j < SPRINGS; j++) sum += I[j] = spring(j, q, p);
    x->worst = fmax(x->worst, fabs(sum - 1));
    if (step == lround(t_early / x->h)) memcpy(x->now->early, q, sizeof x->now->early);
    const long sample = (long)floor(t * SAMPLES / t_end + 1e-9);
    if (sample == (long)floor((t - x->h) * SAMPLES / t_end + 1e-9)) return 0;
    memcpy(x->now->spring[sample], I, sizeof I);
    fprintf(x->csv, "%s,%g,%.6g,%.5f,%.5f,%.5f,%.5f\n", x->method, x->h, t, I[0], I[1], I[2], sum);
    return 0;
}

/* Mean |I_j - exact I_j| over springs and times, each averaged over a time of 5, more than the beats of w. */
static double difference(const record *now, const record *exact)
{
    enum { WINDOW = 50 };
    double sum = 0;
    long count = 0;
    for (int first = 1; first + WINDOW <= SAMPLES + 1; first += WINDOW)
        for (int j = 0; j < SPRINGS; j++, count++) {
            double mean = 0;
            for (int i = first; i < first + WINDOW; i++) mean += now->spring[i][j] - exact->spring[i][j];
            sum += fabs(mean) / WINDOW;
        }
    return sum / (double)count;
}

static void run_method(const experiment_method *method, const tvi_system *system, double h, const record *exact,
                       record *now, FILE *csv, FILE *table)
{
    scene s = scene_fpu;
    s.t_end = t_end;
    watcher x = {experiment_energy_begin(system, &s), csv, method->label, h, 0, now};
    memset(now, 0, sizeof *now);
    experiment_progress("  h = %g: %s", h, method->label);
    const experiment_end end = experiment_run(method, system, &s, h, watch, &x, false);
    fprintf(table, "| %s | %d | %g |", method->label, experiment_degree(method, system), h);
    if (end.status != TVI_OK) {
        fprintf(table, " t = %.4g: %s | - | - | - | - | - |\n", (double)end.steps * h, tvi_status_string(end.status));
        return;
    }
    experiment_cell(table, experiment_energy_mean(&x.energy), 1e2);
    experiment_cell(table, x.energy.worst, 1e2);
    fprintf(table, " %.1f |", end.passes_per_step);
    const bool is_exact = now == exact;
    experiment_cell(table, is_exact ? INFINITY : experiment_distance(N, now->early, exact->early), 1);
    experiment_cell(table, x.worst, 1e2);
    experiment_cell(table, is_exact ? INFINITY : difference(now, exact), 1e2);
    fprintf(table, "\n");
}

int main(int argc, char *argv[])
{
    static const double steps[] = {0.03, 0.01};
    const experiment e = experiment_begin(argc, argv);
    const experiment_method reference = experiment_find("midpoint", 20);
    experiment_method methods[] = {experiment_find("stormer-verlet", 2), experiment_find("svhd", 2),
                                   experiment_find("right", 2),          experiment_find("midpoint", 2),
                                   experiment_find("taylor", 8),         experiment_find("tvi", 8),
                                   experiment_find("start", 16),         experiment_find("midpoint", 16)};
    enum { METHODS = sizeof methods / sizeof *methods };
    for (int m = 0; m < METHODS; m++) methods[m].who.options.max_tail = -1; /* large steps are what is looked at */
    record *exact = malloc(sizeof *exact), *now = malloc(sizeof *now);
    if (!exact || !now) experiment_fail("fpu", "no memory");
    FILE *csv = experiment_csv(&e, "fpu", "method,h,t,I1,I2,I3,I");
    FILE *table = experiment_table(
        &e, "fpu",
        " method | derivatives | h | mean energy error | largest (chaotic) | passes a step "
        "| position at t = 9.99 | largest change of I (chaotic) | I_j, distance from exact (chaotic) ");
    tvi_system *system = experiment_system(&scene_fpu);
    run_method(&reference, system, accurate_step, exact, exact, csv, table);
    for (int k = 0; k < 2; k++)
        for (int m = 0; m < METHODS; m++) run_method(&methods[m], system, steps[k], exact, now, csv, table);
    tvi_system_free(system);
    experiment_close(csv);
    experiment_close(table);
    free(exact);
    free(now);
}
