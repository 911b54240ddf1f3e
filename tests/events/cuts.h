/* cuts.h - Makes runs at random, with events, times, tangent vectors and several members, and the same runs cut into
 * calls. */
#ifndef TESTS_EVENTS_CUTS_H
#define TESTS_EVENTS_CUTS_H

#include "runs.h"

#include <stdint.h>

enum {
    MOST_EVENTS = 6,
    MOST_MEMBERS = 5,
    MOST_RESULTS = 40,
    MOST_COLUMNS = 2,
    MOST_D = 2 * MOST_N * MOST_COLUMNS,
    MOST_NOTES = 4096
};

/* How a run goes. */
typedef enum { BY_STEPS, BY_TOLERANCE, TO_TIME, AT_TIMES, RUN_KINDS } run_kind;

/* A run: a system and a method, its steps, and events; numbers[i] is what event i is made with. */
typedef struct {
    const pairing *pair;
    run_kind kind;
    bool is_rescaled;
    double h, t0, t_end, tolerance, largest_step;
    long steps;
    int members; /* of an ensemble; 0: an integrator */
    int columns; /* of D; 0: none */
    int count, time_count;
    double times[MOST_RESULTS];
    bool turns; /* at a stop p becomes -p */
    bool has_terminal;
    tvi_system *base, *system;
    tvi_options options;
    tvi_event *events[MOST_EVENTS];
    double numbers[MOST_EVENTS][4];
} random_run;

/* One report on a member: an event, or a time, which is MOST_EVENTS and more; with the state, and D. */
typedef struct {
    int member, which;
    point x;
    double D[MOST_D];
} event_note;
typedef struct {
    int count, n, columns, members;
    int times_told;   /* of all calls before */
    long steps;       /* of this call, that an observer was told, */
    long stop_after;  /* and where it stops; 0: nowhere */
    int stop_at_time; /* the call at a time that stops; 0: none */
    bool by_observer; /* it did, or that of times */
    int stops;        /* of all calls */
    bool by_event;    /* the observer of events stops the run at each of them */
    event_note note[MOST_NOTES];
    tvi_status status; /* of the last call */
    point end[MOST_MEMBERS];
    double D[MOST_D * MOST_MEMBERS];
} notes;

/* The same run for the same seed; without events that touch 0, or that end the run, where these are not wanted. false:
 * the method does not serve that. */
bool make_run(random_run *r, uint64_t *bits, bool wants_touching, bool wants_terminal);
bool make_run_of(random_run *r, const pairing *pair, uint64_t *bits, bool wants_touching, bool wants_terminal);
void free_run(random_run *r);
/* For the notes of a run that begins. */
void start_notes(const random_run *r, notes *to);

/* The run in one call, or, with bits, in calls that are cut at random between steps: calls of some steps or of some
 * times, observers that stop, states that are saved and loaded into another integrator. */
void make_notes(const random_run *r, uint64_t *bits, notes *to);

/* The start of a member. */
point start_of_member(const random_run *r, int member);
/* The plan of a run, with the observers of the notes. */
tvi_run_plan plan_of(const random_run *r, notes *to);

/* Event i of the run, of some kind, or the one before it once more, to be told at the same time. */
void make_random_event(random_run *r, int i, uint64_t *bits, bool wants_touching, bool wants_terminal);

#endif
