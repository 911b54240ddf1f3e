/* cuts.h - runs with events that are made at random, and the same runs cut into calls. */
#ifndef TESTS_EVENTS_CUTS_H
#define TESTS_EVENTS_CUTS_H

#include "runs.h"

#include <stdint.h>

enum { MOST_EVENTS = 6, MOST_MEMBERS = 5, MOST_NOTES = 4096 };

/* How a run goes. */
typedef enum { BY_STEPS, BY_TOLERANCE, OF_MEMBERS, RUN_KINDS } run_kind;

/* A run: a system and a method, its steps, and events; numbers[i] is what event i is made with. */
typedef struct {
    const pairing *of;
    run_kind kind;
    bool is_rescaled;
    double h, t0, tolerance;
    long steps;
    int members, count;
    bool turns; /* at a stop p becomes -p */
    tvi_system *base, *system;
    tvi_options options;
    tvi_event *events[MOST_EVENTS];
    double numbers[MOST_EVENTS][4];
} random_run;

/* What was told: member, event, time and state. */
typedef struct {
    int member, which;
    point x;
} event_note;
typedef struct {
    int count, n;
    long steps;       /* of this call, that an observer was told, */
    long stop_after;  /* and where it stops; 0: nowhere */
    bool by_observer; /* it did */
    int stops;        /* of all calls */
    bool by_event;    /* the observer of events stops the run at each of them */
    event_note note[MOST_NOTES];
    tvi_status status; /* of the last call */
    point end[MOST_MEMBERS];
} notes;

/* The same run for the same seed; without events that touch 0, or that end the run, where these are not wanted. false:
 * the method does not serve that. */
bool make_run(random_run *r, uint64_t *bits, bool wants_touching, bool wants_terminal);
bool make_run_of(random_run *r, const pairing *of, uint64_t *bits, bool wants_touching, bool wants_terminal);
void free_run(random_run *r);

/* The run in one call, or, with bits, in calls that are cut at random between steps: calls of some steps, observers
 * that stop, states that are saved and loaded into another integrator. */
void make_notes(const random_run *r, uint64_t *bits, notes *to);

/* The start of a member. */
point start_of_member(const random_run *r, int member);
/* An observer of events of members, whose ctx are the notes. */
int take_member_note(int member, int which, double t, const double q[], const double p[], void *ctx);

#endif
