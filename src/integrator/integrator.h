/* integrator.h - Declares the memory of an integrator, and the functions on it that the files of this folder, of
 * events/ and of run/ share. */
#ifndef TVI_INTEGRATOR_INTEGRATOR_H
#define TVI_INTEGRATOR_INTEGRATOR_H

#include "method/stepper.h"
#include "system/constraint.h"
#include "system/energy.h"

#include <math.h>
#include <string.h>

/* The zero level and the scale of the energy, with which the guard (guard.c) judges the change of the energy in
 * a step. */
typedef struct {
    double zero_level; /* the guard measures energies from this value of H, as H - zero_level */
    /* The size with which changes of the energy are compared: |H - zero_level| when this level was set. When guard.c
     * finds a lower level, the difference of the levels is added. */
    double energy_scale;
    double H; /* the energy at the current state */
    /* True if guard.c has tried to find zero_level and energy_scale. */
    long was_zero_level_searched;
    long has_energy_scale; /* true if zero_level and energy_scale are set; otherwise both are 0 */
    /* True if zero_level is an upper estimate, which guard.c may lower. */
    long can_zero_level_be_lowered;
    long is_H_known; /* true if H is the energy at the current state; false if H is unset */
} tvi_reference_energy;

/* The memory for tangent vectors, which is allocated when they are first used (tangent.c). */
typedef struct tvi_tangent tvi_tangent;

/* A state at which events have stopped a run, and the events that were reported there. A run that goes on from the same
 * t and q, with any p, does not report these events again. Events beyond the first TVI_STOP_EVENTS are recognized by
 * |g|, which is at most its roundoff. Each member of an ensemble has a stop. Texts of states have its words, so
 * that another layout is another format (state.c). */
enum { TVI_STOP_EVENTS = 32 };
typedef struct {
    int64_t is_set, event_count; /* 1 if events stopped a run, else 0; the number of events reported at the stop */
    uint64_t event_hashes[TVI_STOP_EVENTS]; /* [event_count] the hashes of these events (tvi_event.hash) */
    double state[];                         /* [2n + 1] q, p and t of the stop */
} tvi_event_stop;
/* Returns the size of a tvi_event_stop, in bytes, for n coordinates. */
static inline size_t tvi_stop_bytes(int n) { return sizeof(tvi_event_stop) + (2 * (size_t)n + 1) * sizeof(double); }
/* Clears a stop, so that the next run reports the events at its first state. The function is called when the user sets
 * parameters, and before a new stop is stored. */
static inline void tvi_event_stop_clear(tvi_event_stop *stop, int n) { memset(stop, 0, tvi_stop_bytes(n)); }

/* All numbers that one step leaves to the next one: states, predictions. It is all zeros before the first step of a
 * run. */
typedef struct {
    char *now; /* [bytes] */
    /* [copied_bytes] A copy of the first part, as it was before the last step was tried. */
    char *before;
    size_t bytes, copied_bytes;
    /* The bytes at the beginning that belong to the state; all further ones are run_start and the stepper's. */
    size_t state_bytes;
} tvi_step_history;

/* The last step that was tried. It is valid until the state is set by the user. */
typedef struct {
    tvi_run_state start;       /* the state at the start of the step; its memory is history.before */
    double h, covered_time;    /* the size of the step, and its increment of the time */
    tvi_increments increments; /* the increments of the state; dense output writes its own there later */
    bool has_curve;            /* the stepper's memory holds its curve, for tvi_dense: it succeeded */
    /* is_state_from_step in history.before: tells whether the step began at the result of the step before it. */
    const long *was_state_from_step;
} tvi_last_step;

/* What the guard judges a step with. All but the reference energy is scratch. */
typedef struct {
    tvi_reference_energy *reference_energy; /* in the history */
    tvi_run_state end;                      /* the state at the end of the step, without low-order parts */
    tvi_energy_work energy_work;            /* memory to compute the energy; tape_block = NULL if unused */
    tvi_energy_work K_work;                 /* memory to compute the Hamiltonian K of a rescaled system */
    double *curve_forces; /* [n][TVI_FORCE_POINTS + 1] memory of defect.c; NULL if the system is not of bodies */
    double *field_block;  /* memory to evaluate the forces, or the derivatives of L or H, at one point */
} tvi_guard_memory;

struct tvi_integrator {
    const tvi_system *system; /* the user's system, with n coordinates */
    /* The system that is stepped: the user's, or its rescaled form; with generated code if there is any. */
    const tvi_system *stepped;
    double *parameters;           /* [tvi_system_parameters] the values of the parameters */
    long parameter_version;       /* the number of times that the parameters were set */
    const tvi_tape_block *blocks; /* the memory in which tapes are evaluated */
    tvi_options options;          /* the user's options, completed by default values */
    tvi_stats stats;              /* the counts of steps */
    const tvi_stepper *stepper;   /* makes the steps (tvi_choose_stepper) */
    void *work;                   /* the memory of the stepper */
    tvi_step_history history;
    tvi_run_state state; /* the current state, in the history; state.q[stepped->n] is the time, or s */
    /* 1 if `state` is the result of the last successful step, so that the history belongs to it. It is part of the
     * history. */
    long *is_state_from_step;
    double *run_start;    /* [2n + 1] q, t and p at the start of the run, in the history */
    tvi_event_stop *stop; /* the last state at which events stopped a run */
    tvi_last_step last_step;
    tvi_guard_memory guard;
    tvi_constraint_work constraint_work; /* puts the start of a run onto the constraints, if there are any */
    bool is_in_observer;                 /* true while an observer is called, during which steps are refused */
    tvi_tangent *tangent;                /* memory for tangent vectors; NULL if they have not been used */
    void (*free_tangent)(tvi_tangent *tangent);
};

/* Tells whether the system is rescaled, so that its steps are steps in s and not in the time. */
static inline bool tvi_is_rescaled(const tvi_integrator *integrator)
{
    return integrator->system->stepped_system != integrator->system;
}

/* Tells whether the steps are those of the Hamiltonian K = g (H + e), and not of the reversible form. */
static inline bool tvi_steps_K(const tvi_integrator *integrator)
{
    return tvi_is_rescaled(integrator) && integrator->stepped->form == TVI_HAMILTONIAN;
}

/* Prepares a step from the given state. If the state differs from the result of the last step, a new run begins: the
 * state is loaded, and the history is cleared. */
TVI_NODISCARD tvi_status tvi_integrator_begin_step(tvi_integrator *integrator, double t, const double q[],
                                                   const double p[]);
/* Tells whether the current state equals the given one, bit for bit. A failed step does not change the current
 * state. */
bool tvi_integrator_state_equals(const tvi_integrator *integrator, double t, const double q[], const double p[]);
/* Copies the current state to the user's arrays. */
void tvi_integrator_copy_state(const tvi_integrator *integrator, double *t, double q[], double p[]);
/* Evaluates the forces, or the derivatives of the Lagrangian or Hamiltonian, to guard.field_block, at q, an array as in
 * a tvi_run_state, and the velocities of a Lagrangian or the momenta, which forces do not need; NULL: these are 0.
 * Returns whether they are finite. */
bool tvi_integrator_compute_field(tvi_integrator *integrator, const double *q, const double *velocities_or_momenta);
/* Copies the history from which the integrator made its last step, [history.bytes]. */
void tvi_integrator_copy_before(const tvi_integrator *integrator, char *history);

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

/* Creates an integrator for the system, the options and the parameters of another one. It has made no step. */
TVI_NODISCARD tvi_status tvi_integrator_create_like(tvi_integrator **out, const tvi_integrator *integrator);

/* Copies integrator->parameters to the memory in which tapes are evaluated. */
void tvi_integrator_apply_parameters(tvi_integrator *integrator);

/* Sets the parameters to value[tvi_system_parameters][stride]. Unlike tvi_integrator_set_parameters it clears neither
 * the history nor the last stop. */
void tvi_integrator_load_parameters(tvi_integrator *integrator, const double value[], size_t stride);

/* Allocates the memory for this number of tangent vectors (tangent.c). */
TVI_NODISCARD tvi_status tvi_integrator_allocate_tangents(tvi_integrator *integrator, int column_count);

/* Tells whether the status is a failure that concerns one member alone, such as TVI_ENOCONV. All other failures concern
 * the whole run or the arguments of a call. */
static inline bool tvi_is_failure_of_member(tvi_status status)
{
    return status == TVI_ENONFINITE || status == TVI_EDOMAIN || status == TVI_ENOCONV || status == TVI_ESINGULAR ||
           status == TVI_ETOOLARGE;
}

/* Returns the end time of a run that goes in the direction of h without an end: plus or minus infinity. */
static inline double tvi_infinite_end_time(double h) { return copysign(INFINITY, h); }

/* Makes up to most_steps steps of size h, and ends when the time reaches t_end or a step fails; at least one step is
 * made. If the tolerance is > 0, the stepper chooses the size of each step, at most h (stepper.h), and
 * integrator->last_step.h is the size that it chose. t, q and p are written once, after the last step or after the step
 * before the first failure. */
TVI_NODISCARD tvi_status tvi_make_steps(tvi_integrator *integrator, long most_steps, double tolerance, double h,
                                        double t_end, double *t, double q[], double p[]);
/* Computes the increments of a step of size h from the current state, and so the curve of the step, without making it.
 * The stepper succeeds, as it has made this step before. */
void tvi_integrator_compute_curve(tvi_integrator *integrator, double h);
/* Undoes the last step. t, q and p become the state at the start of that step. */
void tvi_integrator_undo_step(tvi_integrator *integrator, double *t, double q[], double p[]);

#endif
