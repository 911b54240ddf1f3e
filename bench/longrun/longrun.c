/* longrun.c - Writes the table and the picture of docs/roundoff.md: longrun DIR MINUTES [SCENE]. Status 1 where a row
 * does not do what it must.
 *
 * Brouwer's law: errors of random sign add up to an energy error that grows as t^(1/2); errors with a sign of their own
 * make it grow as t. Fitted is log rms = log c + a log t, the rms over the orbits of e_i = (H - H0_i) / |H0_i|, at
 * times in equal ratios; H and H0 are means over a window of steps. */
#include "longrun.h"
#include "baselines/gauss_tableau.h"
#include "runs/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FULL_MINUTES = 23, ORBITS_LEAST = 8 };
static const double WHOLE_FROM = 0.1;

typedef struct {
    FILE *csv, *table;
    int rows, wrong;
} output;

static const char *const quantities[] = {"energy", "angular momentum"};
static const char *const sums[] = {"", " plain sums", " rounded coefficients", " no less than before",
                                   " nearest coefficients"};
static const char *const verdicts[][2] = {{"fails", "holds"}, {"does not fail", "fails, as it must"}, {"", "-"}};
static const char *const answers[] = {"no", "yes"};

static void write_samples(FILE *csv, const longrun_series *s, longrun_quantity quantity)
{
    const longrun_line *l = s->line;
    for (int k = 0; k < s->samples; k++)
        fprintf(csv, "%s %g %s%s,%s,%ld,%.4e,%.4e\n", l->title, l->h, l->method, sums[l->sums], quantities[quantity],
                s->steps[k], longrun_rms(s, quantity, k), longrun_mean(s, quantity, k));
}

static void write_row(output *out, const longrun_series *s, longrun_quantity quantity)
{
    const longrun_line *l = s->line;
    const longrun_result r = longrun_judge(s, quantity);
    const bool meets = r.unbiased && r.is_walk && r.is_small;
    const longrun_duty duty = l->duty[quantity];
    const bool right = duty == LONGRUN_SHOWN || meets == (duty == LONGRUN_HOLDS);
    fprintf(out->table, "| %s | %s | %s %d%s | %s | %g |", l->title, l->form, l->method, l->order, sums[l->sums],
            quantities[quantity], l->h);
    fprintf(out->table, " %d | %.3g | %.1e | %.1e |", s->orbits, (double)s->steps[s->samples - 1] / 1e6, r.scatter,
            r.rms);
    if (isfinite(r.interval)) fprintf(out->table, " %.2f ± %.2f |", r.exponent, r.interval);
    else fprintf(out->table, " - |"); /* too short */
    fprintf(out->table, " %.1e ± %.1e | %.1f |", r.mean, r.deviation, r.mean / r.deviation);
    fprintf(out->table, " %s | %s | %s | %s |\n", answers[r.unbiased], answers[r.is_walk],
            quantity == LONGRUN_ENERGY && l->rms_most > 0 ? answers[r.is_small] : "-", verdicts[duty][right]);
    fflush(out->csv);
    fflush(out->table);
    out->rows++;
    out->wrong += !right;
}

static void tell(const longrun_series *s, longrun_quantity quantity)
{
    const longrun_line *l = s->line;
    const longrun_result r = longrun_judge(s, quantity);
    experiment_progress("%s, h = %g, %s%s, %s: rms %.1e, exponent %.2f +- %.2f, mean %+.1e +- %.1e%s%s%s", l->title,
                        l->h, l->method, sums[l->sums], quantities[quantity], r.rms, r.exponent, r.interval, r.mean,
                        r.deviation, r.unbiased ? "" : ", mean is not 0", r.is_walk ? "" : ", exponent is not 1/2",
                        r.is_small ? "" : ", rms is too large");
}

/* More or fewer orbits, and below WHOLE_FROM of the time fewer steps. */
static void run_line(output *out, longrun_series *series, const longrun_line *l, double part)
{
    const double orbits = fmin(fmax(part * l->orbits, ORBITS_LEAST), LONGRUN_ORBITS_MAX);
    longrun_run(series, l, (int)orbits, l->steps * fmin(1, part / WHOLE_FROM));
    for (int quantity = 0; quantity < (l->has_momentum ? LONGRUN_QUANTITIES : 1); quantity++) {
        write_samples(out->csv, series, (longrun_quantity)quantity);
        write_row(out, series, (longrun_quantity)quantity);
        tell(series, (longrun_quantity)quantity);
    }
    experiment_progress("    %d orbits, %.0f s of CPU time", series->orbits, series->cpu);
}

int main(int argc, char *argv[])
{
    sweep_insist_on_one_thread(argv);
    const double minutes = argc == 3 || argc == 4 ? strtod(argv[2], NULL) : 0;
    if (!(minutes > 0)) experiment_fail("longrun", "usage: longrun DIR MINUTES [SCENE]");
    const experiment e = {argv[1], argc, argv};
    output out = {.csv = experiment_csv(&e, "longrun", "line,quantity,steps,rms,mean")};
    out.table =
        experiment_table(&e, "longrun",
                         " scene | form | method | quantity | h | orbits | million steps | scatter of its values | "
                         "rms at the end | exponent, 95% | mean at the end, standard error | their ratio | "
                         "mean is 0 | exponent is 1/2 | rms is small | bounds ");
    longrun_series *series = malloc(sizeof *series);
    if (!series) experiment_fail("longrun", "no memory");
    (void)gauss_tableau_of(8); /* before there are threads */
    for (const longrun_line *l = longrun_lines; l->scene; l++)
        if (argc == 3 || strcmp(argv[3], l->scene->name) == 0) run_line(&out, series, l, minutes / FULL_MINUTES);
    free(series);
    experiment_close(out.csv);
    experiment_close(out.table);
    experiment_progress("%d of %d rows do what they must", out.rows - out.wrong, out.rows);
    return out.wrong == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
