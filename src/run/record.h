/* record.h - Declares what runs leave behind for gradients: the states of their steps, and what they told. run.c and
 * times.c write a record, and gradient.c goes back through it. */
#ifndef TVI_SRC_RUN_RECORD_H
#define TVI_SRC_RUN_RECORD_H

#include "integrator/inside_step.h"
#include "system/adjoint.h"
#include "system/event.h"
#include "tvi_gradient.h"

/* How a piece of a record ends: after its last step, at a fixed time, or at an event inside its last step. */
typedef enum { TVI_END_AT_STEP, TVI_END_AT_TIME, TVI_END_AT_EVENT } tvi_piece_end;

/* A row of steps, each of which begins where the one before ended. */
typedef struct {
    long first_step;  /* the index of its first step; the next piece, or the end of the record, ends it */
    bool starts_anew; /* the state at its start is loaded, and e of a rescaled system is -H there */
    tvi_piece_end end;
    double *end_state; /* [state_size] the state after its last step, with its low-order parts */
} tvi_piece;

/* What a run told of a step: the state at a time, or at an event. */
typedef struct {
    long step;        /* the index of the step; at the start of a run, that of the step which follows */
    double offset;    /* the place in the step, from 0 to its size h */
    int index;        /* among the times, or among the events */
    double *state;    /* [2n + 1] q, p and t */
    bool is_exit;     /* the event at which a run ended */
    double *gradient; /* [2n + 1 + parameters] of the event function, by q, p, t and the parameters; NULL: a time */
} tvi_told;

/* From here on a row of steps has the size h. */
typedef struct {
    long first_step;
    double h;
} tvi_row_of_h;

/* A copy of the integrator's history before a step, from which steps are made again. */
typedef struct {
    long step;
    char *history;
} tvi_checkpoint;

/* The tape of the gradient of an event function. */
typedef struct {
    uint64_t hash;
    jet_tape *tape;
    double *block;
} tvi_event_gradient;

/* An array that grows. */
typedef struct {
    size_t count, capacity;
} tvi_grown;

/* A running integral: its value and the low-order part of it, and both before the last step. */
typedef struct {
    tvi_integrand integrand;
    double *block; /* the block of integrand.tape */
    double value, low, value_before, low_before;
} tvi_integral;

struct tvi_record {
    tvi_integrator *again;         /* an integrator as that of the runs: it makes steps again, and has its parameters */
    const tvi_adjoint *adjoint;    /* that of the system; with integrals `backward` has another */
    struct tvi_backward *backward; /* what gradient.c needs; NULL before the first gradient */
    size_t state_size; /* 4N + 2: q and the variable of the steps [N + 1], p [N], and their low-order parts */
    /* The states at the starts of `count` steps, from the one with the index first_step on. */
    struct {
        double *states;
        tvi_grown of;
        long first_step, most;
    } kept;
    long step_count, steps_before_run;
    tvi_checkpoint *checkpoints;
    tvi_piece *pieces;
    tvi_row_of_h *rows;
    tvi_told *told;
    tvi_event_gradient *event_gradients;
    /* [count] The running integrals, and [2N][TVI_MOST_POINTS] a step's q and p at its nodes. */
    struct {
        int count;
        tvi_integral *of;
        double *nodes;
    } integrals;
    struct {
        tvi_grown checkpoints, pieces, rows, told, event_gradients;
    } counts;
    int time_count, event_count;
    double *end;                  /* [2n + 1] q, p and t at the end of the last run */
    bool begins_piece;            /* the next step begins a piece */
    const tvi_integrator *writer; /* the integrator whose run writes the record; NULL: there is none */
    /* The memory that is taken, and what may be taken. */
    struct {
        size_t taken, most;
    } bytes;
};

/* Begins a run at a state, whose step the integrator has begun: goes on with the record, or begins it anew. */
TVI_NODISCARD tvi_status tvi_record_begin_run(tvi_record *record, const tvi_integrator *integrator);
/* Adds the integrator's last step. */
TVI_NODISCARD tvi_status tvi_record_add_step(tvi_record *record, const tvi_integrator *integrator);
/* Takes back the step that was added last. */
void tvi_record_drop_step(tvi_record *record);
/* Adds a state that was told, at the given offset in the step that was added last, or if is_before_step is
 * set, at the start of the step that follows. `event` is NULL for a time. */
TVI_NODISCARD tvi_status tvi_record_tell(tvi_record *record, const tvi_event *event, bool is_before_step, double offset,
                                         double t, const double q[], const double p[]);
/* Marks what was told last as the event at which the run ends. */
void tvi_record_mark_exit(tvi_record *record);
/* Says how and where the integrator's run has ended, which the first call of a run decides. */
TVI_NODISCARD tvi_status tvi_record_end_run(tvi_record *record, const tvi_integrator *integrator, tvi_piece_end end,
                                            double t, const double q[], const double p[]);
/* Ends the writing of a run that an exception leaves. */
void tvi_record_close(tvi_record *const *record);
/* Forgets all that was recorded. */
void tvi_record_begin_anew(tvi_record *record);
/* Returns the size h of a step. */
double tvi_record_size_of_step(const tvi_record *record, long step);
/* Finds the state [state_size] at the start of a step, and makes the steps before it again if it is not kept. */
TVI_NODISCARD tvi_status tvi_record_state(tvi_record *record, long step, const double **state);
/* Copies the state of a run with its low-order parts to a vector [4N + 2], N coordinates. */
static inline void tvi_full_state_get(const tvi_run_state *from, int N, double state[])
{
    const size_t q = (size_t)N + 1, p = (size_t)N;
    memcpy(state, from->q, q * sizeof *state);
    memcpy(state + q, from->p, p * sizeof *state);
    memcpy(state + q + p, from->q_low, q * sizeof *state);
    memcpy(state + 2 * q + p, from->p_low, p * sizeof *state);
}

/* ---- integrals.c ------------------------------------------------------------------------------------------------- */

/* Adds the integrals over the integrator's last step. */
TVI_NODISCARD tvi_status tvi_integrals_add_step(tvi_record *record, const tvi_integrator *integrator);
/* Takes back those that were added last. */
void tvi_integrals_drop_step(tvi_record *record);
/* Takes the integrals over the part of the integrator's last step up to an offset in the place of those over all of
 * it. */
TVI_NODISCARD tvi_status tvi_integrals_cut_step(tvi_record *record, const tvi_integrator *integrator, double offset);
/* Computes the integrand at a full state [state_size]. */
TVI_NODISCARD tvi_status tvi_integrand_at(const tvi_record *record, int index, const double state[], double *value);
void tvi_integrals_free(tvi_record *record);

/* ---- backward.c -------------------------------------------------------------------------------------------------- */

void tvi_backward_free(struct tvi_backward *backward);

#endif
