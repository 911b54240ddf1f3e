/* diary.h - Declares what the observers of a run were told. */
#ifndef TESTS_EVENTS_DIARY_H
#define TESTS_EVENTS_DIARY_H

#include "runs.h"

enum { MOST_TOLD = 4096 };

typedef struct {
    int count, which[MOST_TOLD], stop_at; /* stop_at: the event, from 1, that ends the run; 0: none */
    point at[MOST_TOLD];
    int n;
    long steps, last_step[MOST_TOLD]; /* the step told before each event */
} diary;

/* The test fails where it cannot be made. */
tvi_event *event_of(int n, tvi_direction direction, bool terminal, tvi_event_fn *g, void *ctx);
/* An observer, whose ctx is the diary. */
int note_event(int which, double t, const double q[], const double p[], void *ctx);
/* A run of `steps` steps with the events, which are freed. */
tvi_status watch(run *r, double h, long steps, tvi_event *events[], int count, diary *d);

#endif
