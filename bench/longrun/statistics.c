/* statistics.c - Fits the growth of the energy errors of many orbits, with its standard error (longrun.h). */
#include "longrun.h"

#include <math.h>

/* The fit begins where the rms is so many times the scatter of the values; their means over a window scatter less. */
static const double ABOVE_SCATTER = 0.25;

/* The number of standard errors of the mean, for the exponent about 1/2. */
static const double BIAS_MOST = 3, EXPONENT_MOST = 0.15;

/* The 97.5 % point of Student's distribution (Abramowitz and Stegun 26.7.5). */
static double student(int freedom) { return 1.96 + 2.37 / freedom + 2.82 / freedom / freedom; }

/* Over the orbits but one; without = -1: over all. */
static double rms_without(const longrun_series *s, longrun_quantity quantity, int sample, int without)
{
    double squares = 0;
    for (int i = 0; i < s->orbits; i++)
        if (i != without) squares += s->errors[quantity][sample][i] * s->errors[quantity][sample][i];
    return sqrt(squares / (without < 0 ? s->orbits : s->orbits - 1));
}

double longrun_rms(const longrun_series *s, longrun_quantity quantity, int sample)
{
    return rms_without(s, quantity, sample, -1);
}

double longrun_mean(const longrun_series *s, longrun_quantity quantity, int sample)
{
    double sum = 0;
    for (int i = 0; i < s->orbits; i++) sum += s->errors[quantity][sample][i];
    return sum / s->orbits;
}

static double standard_error(const longrun_series *s, longrun_quantity quantity, int sample)
{
    const double mean = longrun_mean(s, quantity, sample);
    double squares = 0;
    for (int i = 0; i < s->orbits; i++) squares += pow(s->errors[quantity][sample][i] - mean, 2);
    return sqrt(squares / (s->orbits - 1) / s->orbits);
}

static double scatter(const longrun_series *s, longrun_quantity quantity)
{
    double squares = 0;
    for (int i = 0; i < s->orbits; i++) squares += s->scatter[quantity][i] * s->scatter[quantity][i];
    return sqrt(squares / s->orbits);
}

/* The sample from which on the rms is above `least`. */
static int fit_start(const longrun_series *s, longrun_quantity quantity, double least)
{
    int k = s->samples;
    while (k > 0 && longrun_rms(s, quantity, k - 1) > least) k--;
    return k;
}

/* The least-squares slope of log rms against log t; NAN where there are not three points. */
static double exponent(const longrun_series *s, longrun_quantity quantity, int from, int without)
{
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (int k = from; k < s->samples; k++) {
        const double u = log((double)s->steps[k]), v = log(rms_without(s, quantity, k, without));
        n++, x += u, y += v, xx += u * u, xy += u * v;
    }
    return n < 3 ? NAN : (n * xy - x * y) / (n * xx - x * x);
}

/* Half the width of the 95 % interval, from the exponents with one orbit left out (jackknife). */
static double exponent_interval(const longrun_series *s, longrun_quantity quantity, int from, double all)
{
    double sum = 0, squares = 0;
    for (int i = 0; i < s->orbits; i++) {
        const double d = exponent(s, quantity, from, i) - all;
        sum += d, squares += d * d;
    }
    return student(s->orbits - 1) * sqrt((squares - sum * sum / s->orbits) * (s->orbits - 1) / s->orbits);
}

longrun_result longrun_judge(const longrun_series *s, longrun_quantity quantity)
{
    const int last = s->samples - 1;
    const double most = quantity == LONGRUN_ENERGY ? s->line->rms_most : 0;
    longrun_result r = {.rms = longrun_rms(s, quantity, last), .mean = longrun_mean(s, quantity, last)};
    r.deviation = standard_error(s, quantity, last);
    r.scatter = scatter(s, quantity);
    const int from = fit_start(s, quantity, ABOVE_SCATTER * r.scatter);
    r.exponent = exponent(s, quantity, from, -1);
    r.interval = exponent_interval(s, quantity, from, r.exponent);
    r.fit_from = from < s->samples ? s->steps[from] : 0;
    r.unbiased = fabs(r.mean) <= BIAS_MOST * r.deviation;
    r.is_walk = fabs(r.exponent - 0.5) <= EXPONENT_MOST;
    r.is_small = most == 0 || r.rms <= most;
    return r;
}
