/* stability.h - Declares what the suites of the hard cases share. */
#ifndef TESTS_STABILITY_H
#define TESTS_STABILITY_H

#include "stability/hard_run.h"

#include <check.h>

Suite *suite_failing(void);
Suite *suite_limits(void);
Suite *suite_extremes(void);
Suite *suite_lowest(void);
Suite *suite_equilibria(void);
Suite *suite_guard(void);
Suite *suite_zero(void);

extern const hard_case *const all_cases[]; /* those of the search, the chains, and the largest and smallest states */
extern const hard_method all_methods[];    /* every named method at orders that it has */
extern const int case_count, method_count;

enum { STATE_MOST = 6 };
typedef struct {
    double t, q[STATE_MOST], p[STATE_MOST];
} hard_state;

hard_state start_of(const hard_case *c);
bool is_finite(const hard_state *x);

/* The case's system and an integrator for it; ends the test where one cannot be made. max_passes 0 = the library's. */
typedef struct {
    const hard_case *problem;
    tvi_system *system;
    tvi_integrator *integrator;
    char name[80];
} hard_pair;

hard_pair pair_open(const hard_case *c, const hard_method *m, int max_passes);
void pair_close(hard_pair *pair);
tvi_status pair_step(const hard_pair *pair, double h, hard_state *x);

#endif
