/* plans.h - Declares what a run by a plan tells, with D as it was then; for the suites of plans and of columns. */
#ifndef TESTS_EVENTS_PLANS_H
#define TESTS_EVENTS_PLANS_H

#include "runs.h"

#include <check.h>

enum { MOST_COLUMNS_OF = 5, MOST_NUMBERS = (2 * MOST_N + 1) * MOST_COLUMNS_OF, MOST_SEEN = 256 };

typedef enum { STEP, TIME, EVENT, KINDS } told_kind;
typedef struct {
    told_kind kind;
    int which;
    point x;
    double h; /* of the last step */
    double D[MOST_NUMBERS];
} told;
typedef struct {
    tvi_integrator *it;
    int n, numbers;         /* of D, */
    double D[MOST_NUMBERS]; /* which is that of the plan */
    int count, of_kind[KINDS];
    told_kind stops; /* the call of this kind, from 1, that stops the run; 0: none */
    int stop_at;
    int times_before; /* told by earlier calls */
    bool scrawls;     /* writes to D at times and events */
    told told[MOST_SEEN];
} plan_diary;

/* Observers, whose ctx is the diary. */
int see_step(int member, int which, double t, const double q[], const double p[], void *ctx);
int see_time(int member, int which, double t, const double q[], const double p[], void *ctx);
int see_event(int member, int which, double t, const double q[], const double p[], void *ctx);

/* The last one of a kind that was told, and the first one after i (i = -1: of all); NULL: none. */
const told *last_told(const plan_diary *d, told_kind kind);
const told *next_told(const plan_diary *d, told_kind kind, int i);

/* Events where the first coordinate, and the first momentum, are at a level. */
tvi_event *event_at_place(int n, bool is_terminal, const double *level);
tvi_event *event_at_momentum(int n, bool is_terminal, const double *level);

/* The run of a pairing, in the time or in s; false: the method has no such steps. */
bool open_pairing(run *r, const pairing *pair, bool is_rescaled, tvi_system **base);
void close_pairing(run *r, tvi_system *base);
/* A scale of time, 1 + q^2 / 10. */
jet wider_scale(const jet q[], const jet p[], jet t, void *ctx);

/* The reports of a run beside its steps, added up. */
enum { WITH_EVENTS = 1, WITH_D = 2, WITH_STEPS = 4, ALL = 8, COLUMNS = 2 };
/* An empty diary of the run, with so many columns of D. */
void start_diary(plan_diary *d, const run *r, int columns);
/* The run by the plan with these, too. */
tvi_status run_with(run *r, tvi_run_plan plan, int with, tvi_event *const events[2], plan_diary *d);
/* All of one kind in both are the same, and as many. */
void expect_same_told(const plan_diary *a, const plan_diary *b, told_kind kind, bool has_columns);

#endif
