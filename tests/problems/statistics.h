/* statistics.h - Decides whether the errors of many runs have a mean, and whether they are larger than roundoff makes
 * them. The starts of the runs differ by some 2^-30. Their roundoff is then independent, and the drift of a faulty step
 * is nearly the same in all of them. */
#ifndef TESTS_PROBLEMS_STATISTICS_H
#define TESTS_PROBLEMS_STATISTICS_H

#include <math.h>

enum { ORBITS = 128 };

/* This is added to the coordinates of the k-th start. It is 2^22 units in the last place of 1, or more. */
static inline double start_shift(int k) { return k * 0x1p-30; }

typedef struct {
    int count;
    double sum, squares;
} sample;

static inline void sample_add(sample *s, double error)
{
    s->count++;
    s->sum += error;
    s->squares += error * error;
}

static inline double sample_rms(const sample *s) { return sqrt(s->squares / s->count); }

/* |sum x_k| / (sum x_k^2)^(1/2), which is at most count^(1/2). Without a drift the x_k are independent, and x_k is as
 * likely as -x_k. The sum of given |x_k| then has random signs. Hoeffding's inequality says that the ratio is above z
 * with a probability of at most 2 exp(-z^2 / 2), for every count and all sizes. This is 1e-6 for z = NO_DRIFT.
 * Student's quantile for 127 degrees of freedom, which supposes normal errors of one size, is a ratio of 4.7.
 *   A drift of d in all runs, with walks of rms s, is t = count^(1/2) d / s standard errors. The ratio of 128 runs is
 * above NO_DRIFT from t = 6.1 on. It is so with a probability of 0.999 if t is 10, which is a ratio of 7.5. Samples of
 * many thousands need a ratio of 8.5. */
static inline double sample_drift(const sample *s) { return fabs(s->sum) / sqrt(s->squares); }
static const double NO_DRIFT = 5.387;

/* The rms of `count` independent walks of rms 1 is above this with a probability of at most 1e-6. The sum of their
 * squares has a chi-square distribution. It is above count + 2 (count x)^(1/2) + 2 x with a probability of at most
 * exp(-x), and as rarely below count - 2 (count x)^(1/2) (Laurent and Massart, Annals of Statistics 28, 2000). The
 * factor is 1.37 for 128 runs. With a probability of 0.999 walks of 1.87 times the length are above it. The numbers for
 * 256 runs are 1.25 and 1.53. */
static inline double rms_factor(int count)
{
    const double x = 13.816;
    return sqrt(1 + 2 * sqrt(x / count) + 2 * x / count);
}

#endif
