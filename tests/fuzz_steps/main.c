/* main.c - Runs `fuzz_steps [SEED [COUNT]]`: random problems from SEED on, a random step of each against its
 * definition. Without arguments the number that make check has time for. One problem alone is printed whatever comes of
 * it. */
#include "compare.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { FIRST = 1, COUNT = 100 };

/* In units of roundoff: no step above the first, and the median below the second. */
static const double MOST = 16, MEDIAN = 0.5;

typedef struct {
    long tried, unknown, refused, wrong;
    double *errors; /* of those that were made */
} tally;

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_case(long seed, const problem *x, const comparison *c, const char *what)
{
    printf("seed %ld: %s\n  %s, h = %.17g\n  errors of q %.3g, of p %.3g units of roundoff\n", seed, what,
           describe(&c->options), c->h, c->q, c->p);
    print_problem(stdout, x);
    fflush(stdout);
}

static void try_seed(long seed, bool prints, tally *sum)
{
    problem x = problem_of((uint64_t)seed);
    random_source r = {(uint64_t)seed * UINT64_C(0xaf251af3b0f025b5)};
    const comparison c = compare_step(&x, &r);
    const double error = fmax(c.q, c.p);
    sum->tried++;
    if (c.made != TVI_OK || (c.has_reference && c.status != TVI_OK)) {
        print_case(seed, &x, &c, tvi_status_string(c.made != TVI_OK ? c.made : c.status));
        sum->refused++;
    } else if (!c.has_reference) {
        sum->unknown++;
        if (prints) print_case(seed, &x, &c, "no reference");
    } else {
        sum->errors[sum->tried - sum->unknown - sum->refused - 1] = error;
        sum->wrong += !(error <= MOST);
        if (prints || !(error <= MOST)) print_case(seed, &x, &c, error <= MOST ? "as it should be" : "wrong");
    }
    problem_free(&x);
}

int main(int argc, char *argv[])
{
    const long first = argc > 1 ? strtol(argv[1], NULL, 10) : FIRST, count = argc > 2   ? strtol(argv[2], NULL, 10)
                                                                             : argc > 1 ? 1
                                                                                        : COUNT;
    tally sum = {.errors = calloc((size_t)(count > 0 ? count : 1), sizeof(double))};
    if (!sum.errors || count < 1) return EXIT_FAILURE;
    for (long seed = first; seed < first + count; seed++) try_seed(seed, count == 1, &sum);
    const long made = sum.tried - sum.unknown - sum.refused;
    qsort(sum.errors, (size_t)made, sizeof *sum.errors, ascending);
    const double median = made ? sum.errors[made / 2] : 0;
    printf("%ld problems: %ld refused, %ld wrong, %ld without a reference; errors in units of roundoff: median %.2f, "
           "99 %% below %.2f, largest %.2f\n",
           sum.tried, sum.refused, sum.wrong, sum.unknown, median, made ? sum.errors[made * 99 / 100] : 0,
           made ? sum.errors[made - 1] : 0);
    free(sum.errors);
    return sum.refused || sum.wrong || (count >= 100 && (median > MEDIAN || sum.unknown > count / 10));
}
