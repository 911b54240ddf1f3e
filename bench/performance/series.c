/* series.c - the plain series of the library against a recurrence by hand that is compiled with the same flags, for
 * Kepler and six bodies. Writes DIR/series.md and DIR/series.csv.
 *
 *   series DIR */
#include "by_hand.h"
#include "curves.h"
#include "experiments/experiment.h"
#include "turns.h"

#include <math.h>
#include <string.h>

static const int degrees[] = {6, 10, 14, 20};
enum { COUNT = sizeof degrees / sizeof *degrees };

/* Steps that have all coefficients of about one size. */
static const struct {
    const scene *scene;
    const char *title;
    double h;
} problems[] = {{&scene_kepler, "Kepler", 0.5}, {&scene_solar, "6 bodies", 800}};
enum { PROBLEMS = sizeof problems / sizeof *problems };

static const by_hand *by_hand_of(isa which)
{
#ifdef JET_ISA_X86
    const char *name = isa_name(which);
    return strcmp(name, "avx512") == 0 ? &by_hand_avx512 : strcmp(name, "avx2") == 0 ? &by_hand_avx2 : &by_hand_base;
#else
    (void)which;
    return &by_hand_base;
#endif
}

typedef struct {
    const by_hand *code;
    int N;
    double tau;
    power_weights weights;
    kepler_series kepler;
    solar_series solar;
} hand;

static void expand_kepler(void *ctx)
{
    hand *x = ctx;
    x->code->kepler(x->N, x->tau, &x->weights, &x->kepler);
}

static void expand_solar(void *ctx)
{
    hand *x = ctx;
    x->code->solar(x->N, x->tau, &x->weights, &x->solar);
}

/* From the centre data of the library's curve. */
static void start_by_hand(hand *x, bool is_kepler, const tvi_curve *curve)
{
    x->N = curve->top;
    x->tau = curve->tau;
    set_power_weights(x->N, &x->weights);
    for (int k = 0; k < 2; k++) {
        const double *Q = tvi_curve_Q(curve, k);
        if (is_kepler) x->kepler.x[k] = Q[0], x->kepler.y[k] = Q[1];
        else memcpy(x->solar.q[k], Q, 18 * sizeof *Q);
    }
}

/* Both make the same series, or the comparison is none. */
static void check(const hand *x, bool is_kepler, const tvi_curve *curve)
{
    for (int k = 0; k <= x->N; k++) {
        double size = 0, distance = 0;
        for (int i = 0; i < curve->n; i++) {
            const double theirs = !is_kepler ? x->solar.q[k][i] : i == 0 ? x->kepler.x[k] : x->kepler.y[k];
            size = fmax(size, fabs(theirs));
            distance = fmax(distance, fabs(tvi_curve_Q(curve, k)[i] - theirs));
        }
        if (!(distance <= 1e-11 * size)) experiment_fail("series", "the two differ");
    }
}

/* Ours over theirs. */
static void compare(int problem, int N, isa which, turn result[2])
{
    static hand x;
    const bool is_kepler = problems[problem].scene == &scene_kepler;
    const scene *s = problems[problem].scene;
    isa_pin(which);
    tvi_system *system = experiment_system(s);
    open_curve *ours = curve_open(system, N, s->q, s->p, problems[problem].h);
    x.code = by_hand_of(which);
    start_by_hand(&x, is_kepler, &ours->curve);
    result[0] = (turn){.work = curve_expand, .ctx = ours};
    result[1] = (turn){.work = is_kepler ? expand_kepler : expand_solar, .ctx = &x};
    turns_time(2, result);
    check(&x, is_kepler, &ours->curve);
    curve_close(ours);
    tvi_system_free(system);
}

int main(int argc, char *argv[])
{
    static const isa sets[] = {ISA_BASE, ISA_WIDEST};
    const experiment e = experiment_begin(argc, argv);
    FILE *csv = experiment_csv(&e, "series", "problem,N,instruction set,library ns,by hand ns,ratio");
    FILE *table = experiment_table(&e, "series",
                                   "problem|N|base: library, ns (time)|by hand, ns (time)|ratio (time)|"
                                   "widest: library, ns (time)|by hand, ns (time)|ratio (time)");
    for (int problem = 0; problem < PROBLEMS; problem++)
        for (int i = 0; i < COUNT; i++) {
            fprintf(table, "| %s | %d |", problems[problem].title, degrees[i]);
            for (int set = 0; set < 2; set++) {
                turn t[2];
                compare(problem, degrees[i], sets[set], t);
                const double ratio = t[0].seconds / t[1].seconds;
                fprintf(table, " %.0f | %.0f | %.2f |", 1e9 * t[0].seconds, 1e9 * t[1].seconds, ratio);
                fprintf(csv, "%s,%d,%s,%.1f,%.1f,%.4f\n", problems[problem].title, degrees[i], isa_name(sets[set]),
                        1e9 * t[0].seconds, 1e9 * t[1].seconds, ratio);
            }
            fprintf(table, "\n");
            experiment_progress("series: %s, N = %d", problems[problem].title, degrees[i]);
        }
    experiment_close(csv);
    experiment_close(table);
    return 0;
}
