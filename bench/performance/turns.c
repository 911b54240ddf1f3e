/* turns.c - Times pieces of work in turns (turns.h). */
#include "turns.h"

#include "runs/run.h"
#include "system/system.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

/* Turns of at least 0.5 ms; of each piece 100, or as many as fit in 0.1 s, but three. */
static const double shortest = 5e-4, longest = 0.1;
enum { TURNS = 100, LEAST_TURNS = 3 };

static double time_calls(const turn *t)
{
    for (double begin = run_clock(); run_clock() - begin < run_before_timing;) t->work(t->ctx);
    const double begin = run_clock();
    for (long i = 0; i < t->calls; i++) t->work(t->ctx);
    return run_clock() - begin;
}

/* Doubles the calls until a turn is long enough. */
static void calibrate(turn *t)
{
    t->calls = 1;
    while (time_calls(t) < shortest) t->calls *= 2;
}

double turns_wall(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void turns_time(int count, turn of[])
{
    double total = 0;
    for (int i = 0; i < count; i++) calibrate(&of[i]), of[i].seconds = INFINITY;
    for (int done = 0; done < LEAST_TURNS || (done < TURNS && total < longest * count); done++)
        for (int i = 0; i < count; i++) {
            const double once = time_calls(&of[i]);
            of[i].seconds = fmin(of[i].seconds, once / (double)of[i].calls);
            total += once;
        }
}

void isa_pin(isa which)
{
    static const char *const wishes[] = {"base", "avx2"};
    const int failed = which == ISA_WIDEST ? unsetenv("TVI_ISA") : setenv("TVI_ISA", wishes[which], 1);
    if (failed) abort();
}

/* The sweeps that a tape made under `which` gets. */
static const jet_sweeps *sweeps_of(isa which)
{
    isa_pin(which);
    return jet_choose_sweeps_for_processor();
}

const char *isa_name(isa which)
{
    const jet_sweeps *of[ISAS];
    for (isa i = 0; i < ISAS; i++) of[i] = sweeps_of(i);
    isa_pin(ISA_WIDEST);
    return of[which] == of[ISA_BASE] ? "base" : of[which] == of[ISA_AVX2] ? "avx2" : "avx512";
}
