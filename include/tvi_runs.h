/* tvi_runs.h - runs with events, results at given times, to a given time, to a tolerance, any of them by a plan; the
 * step for an error. Included by tvi.h. */
#ifndef TVI_RUNS_H
#define TVI_RUNS_H

#include "tvi.h"

#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif
#ifdef __cplusplus
extern "C" {
#endif

/* ---- Events, and results at given times -------------------------------------------------------------------------- */

/* Events and results at given times are states between steps. Such a state is that of a step of the method, over the
 * part of h that leads there from the start of the current step, in an integrator of its own. Its invariants are as
 * good as those of the steps, and the steps are bit for bit those of tvi_integrate. A state at a given time costs one
 * step. Events cost each step a search, which shares its states, and each event that is found costs one to three steps
 * (docs/performance.md). */

/* A function g of the state. It is written in jets, like a force.
 *
 * An event is where g reaches 0 or changes its sign, at a time in (t0, t_end] of the run; a point where g leaves 0 is
 * none. A touch of 0 that the search sees is one event, in the direction towards 0. However a run is cut into calls,
 * each event is reported once, in order of time, and in order of the events if times are equal:
 *   - A call that goes on from the state that the integrator's last step returned, whatever texts were written and
 *     read between, uses the sign that g has there, by the evaluation that ended the step before. If this was a step
 *     without events (tvi_step), the events in it are not reported later.
 *   - If events have stopped a run, the integrator keeps t and q, and which functions were reported there. As long as t
 *     and q are the same, whatever p is, these events are left and not reported again. All events at the time of one
 *     that ends the run, to the resolution of t, are reported before TVI_ESTOPPED.
 *   - Any other state is on an event if |g| is at most the roundoff of its inputs and operations. A run that begins
 *     on an event does not report it.
 * A g that leaves 0 has from then on the sign of its first Taylor coefficient along the motion that is above its own
 * roundoff. Returns to 0, such as flights of a ball that bounces, are reported as long as they are longer than t
 * resolves (DBL_EPSILON |t|). A shorter one after a stop is refused with TVI_ENOCONV, and the state is as it was: such
 * a ball is at rest. (A ball that is given p = 0 there falls on: g leaves 0.) A g that stays within its roundoff over a
 * whole step has no event in it. Parameters that an observer sets hold from the next step on, as from a new state. */
typedef jet tvi_event_fn(const jet q[], const jet p[], jet t, void *ctx);
/* The direction in which g changes its sign along the run, whatever the sign of h. */
typedef enum { TVI_FALLING = -1, TVI_EITHER = 0, TVI_RISING = 1 } tvi_direction;

typedef struct tvi_event tvi_event;
/* Creates an event. g is called once, during the call, with n coordinates and momenta. A terminal event ends the run.
 * The event serves every system of dimension n, is read-only once created and may be shared. *out is NULL on failure;
 * statuses are those of tvi_system_force.
 *   TVI_EINVAL  also a value that is no direction */
TVI_NODISCARD tvi_status tvi_event_create(tvi_event **out, int n, tvi_direction direction, bool terminal,
                                          tvi_event_fn *g, void *ctx);
void tvi_event_free(tvi_event *event); /* NULL is allowed */

/* An observer of events is called at events[which], with its time and state; a value other than 0 ends the run
 * there. */
typedef int tvi_event_observer(int which, double t, const double q[], const double p[], void *ctx);
/* Does what tvi_integrate does, with events[count]. on_event is called for each event in order of time, before the
 * observer is called for the step that contains them. The search samples g along the step's curve (tvi_dense), between
 * 8 equal parts, and at dips of |g| between these, with a kink or without (docs/limits.md says what that can miss). The
 * time and the state are those of the change of sign on the method's own solution, to roundoff of the orbit, whatever
 * slope g has there. Either observer may be NULL; both are given ctx. Observers may set the integrator's parameters,
 * reset it, write texts of states and ask it; stepping it or reading a state is refused (TVI_EINVAL) while it calls
 * them. In on_event tvi_state_last returns the end of the step: a run from it does not report the step's later events.
 *   TVI_ESTOPPED   an observer or a terminal event ended the run: t, q, p are those of the step, or of the event. An
 *                  event is no step: observer is not called for the step that contains it, and from it the run goes on
 *                  as from any new state.
 *   TVI_ENOCONV    also an event that is reached again before the time moves: t, q, p are those where it was left
 *   TVI_EDOMAIN, TVI_ENONFINITE   also where g has no value: t, q, p are then those at the end of the step
 *   TVI_EINVAL     also an event of another dimension or NULL, count < 0
 *   TVI_ENOMEM     no memory */
TVI_NODISCARD tvi_status tvi_integrate_events(tvi_integrator *integrator, double h, long steps,
                                              const tvi_event *const events[], int count, double *t, double q[],
                                              double p[], tvi_observer *observer, tvi_event_observer *on_event,
                                              void *ctx);

/* Makes steps of size h until the last of times[count] is reached or passed. The observer is called at each of the
 * times, with 1..count as its step. The times are in the direction of h, none before *t. If t, q and p are what the
 * integrator's last step returned, and it has made or loaded nothing since, the times may begin at the start of that
 * step, so that a list may be given in several calls. The state is that after the last step, not that at the last time;
 * if the observer stopped the run (TVI_ESTOPPED), it is that after the step that contains the time. In a rescaled
 * system the place of a time is found by dt/ds = g, to roundoff of t, also if a step covers little of it.
 *   TVI_EINVAL     NULL, count < 0, times that are not finite or not in order
 *   TVI_ENOCONV    also a run that would never end: 65,536 steps in a row, of which each covered less than 1.1e-16 of
 *                  the time that was left, as where the scale g of a rescaled system goes to 0
 *   TVI_ENOMEM     no memory
 *   others         as of tvi_integrate */
TVI_NODISCARD tvi_status tvi_integrate_at(tvi_integrator *integrator, double h, const double times[], int count,
                                          double *t, double q[], double p[], tvi_observer *observer, void *ctx);

/* Makes steps of size h to t_end exactly, with a last step that is not longer; h has the direction of t_end. A time
 * that is left after a step is roundoff, and no step, if it is below 2 DBL_EPSILON |t| and below h / 1024. In a
 * rescaled system h is in s: the step that passes t_end is undone, and replaced by the part of it that ends there to
 * roundoff. Each step is the method's, but the last one has another size: a run that goes on from t_end is not the one
 * without a stop there.
 *   TVI_EINVAL     NULL, h = 0, values that are not finite, t_end on the other side of *t
 *   TVI_ENOCONV    also a run that would never end, as in tvi_integrate_at
 *   TVI_ENOMEM     no memory
 *   others         as of tvi_integrate, also where the step that would pass t_end fails */
TVI_NODISCARD tvi_status tvi_integrate_to(tvi_integrator *integrator, double h, double t_end, double *t, double q[],
                                          double p[], tvi_observer *observer, void *ctx);

/* Makes steps to t_end exactly, either way, each as large as a relative tolerance allows. It serves "taylor" only, for
 * short accurate runs: the method is not symplectic, and its energy drifts. rho is the least (|x_0| / |x_k|)^(1/k) over
 * the last coefficients x_k of the curve of order N, by the largest component each, for q and p apart; h = rho
 * (tolerance / e^5)^(1/N). The order that suits a tolerance is N = ceil(1 - ln(tolerance) / 2), with h = rho e^(-2 -
 * 3/N): 8 for 1e-6, 13 for 1e-10, 19 for 1e-15 (Jorba and Zou, Experimental Mathematics 14 (2005)); one half as large
 * again is a little faster for small systems. A step's error is some hundredths of the tolerance, and the error of a
 * run over tens of revolutions at most 100 times the tolerance (docs/adaptive.md). Below 1e-13 steps are refined in
 * long double, which takes 1.4 to 2 times as long; for a Lagrangian that is not separable the error is that of
 * roundoff. The size is chosen before the step is summed: a step costs one expansion. It is at most 0.7 of the radius
 * of convergence that the last coefficients show by themselves. Then the step is checked, and halved until it is right:
 * at each quarter of it the field differs from the derivative of the curve by at most the tolerance (times the largest
 * q or p), and so does the energy at its end, if it is conserved (Enright, Applied Mathematics and Computation 31
 * (1989)). In this way bodies feel what they meet within a step. A bump of a force that lies between the quarters and
 * leaves the energy as it was is not seen, nor a pulse in time there: tvi_run_plan.largest_step limits how far a step
 * may reach. The observer is called after each step, and may ask tvi_dense.
 *   TVI_EINVAL       NULL, a tolerance below DBL_EPSILON or not below 1, t_end that is not finite
 *   TVI_EUNSUPPORTED another method, a rescaled system
 *   TVI_ENOCONV      also a step below roundoff of t, as before a collision
 *   others           as of tvi_integrate */
TVI_NODISCARD tvi_status tvi_integrate_tolerance(tvi_integrator *integrator, double tolerance, double t_end, double *t,
                                                 double q[], double p[], tvi_observer *observer, void *ctx);
/* Makes the same steps, with events as in tvi_integrate_events. */
TVI_NODISCARD tvi_status tvi_integrate_tolerance_events(tvi_integrator *integrator, double tolerance, double t_end,
                                                        const tvi_event *const events[], int count, double *t,
                                                        double q[], double p[], tvi_observer *observer,
                                                        tvi_event_observer *on_event, void *ctx);
/* The order of "taylor" that suits a tolerance, N = ceil(1 - ln(tolerance) / 2), but at least 2, for tvi_options_named;
 * 0 for a tolerance that tvi_integrate_tolerance refuses. */
int tvi_taylor_order(double tolerance);

/* ---- Any run, by a plan ------------------------------------------------------------------------------------------ */

/* An observer of members is called for one member, with q[n] and p[n]; an integrator is an ensemble of one, member 0.
 * For members of an ensemble it is called on any thread, one call at a time; for one member in order of time, for
 * several in any order. A value other than 0 ends the run of the member (TVI_ESTOPPED). */
typedef int tvi_member_observer(int member, int which, double t, const double q[], const double p[], void *ctx);
/* An observer of an ensemble is called after each step, 1..steps, with the states of all members, t[members],
 * q[n][members], p[n][members], status[members], on the thread that called the run; a value other than 0 stops. */
typedef int tvi_ensemble_observer(long step, int members, const double t[], const double q[], const double p[],
                                  const tvi_status status[], void *ctx);

/* A plan says how far a run goes, and what it reports: by tvi_run for an integrator, by tvi_ensemble_run for an
 * ensemble. 0 or NULL: nothing of that kind. A run makes `steps` steps of size h, none if that is 0; or it goes to
 * t_end, in steps of size h or to a tolerance, if has_t_end says so; or to the last of its times. Times and t_end may
 * be given together. Each goes with events, with D and with the observers of members. */
typedef struct {
    double h;            /* the step, or 0 with a tolerance */
    double tolerance;    /* steps to t_end as those of tvi_integrate_tolerance, also without has_t_end */
    long steps;          /* number of steps of size h */
    double t_end;        /* to this time exactly, as tvi_integrate_to */
    bool has_t_end;      /* the run ends at t_end */
    const double *times; /* [time_count] steps of size h as tvi_integrate_at, none of them beyond t_end */
    int time_count;      /* at_time is called at each of the times, with 1..time_count */
    const tvi_event *const *events;
    int event_count; /* on_event is called at each event, with its index, as by tvi_integrate_events */
    /* Tangent vectors [2n + parameters][columns], in an ensemble [..][columns][members]; moved as by
     * tvi_step_tangent. */
    double *D;
    int columns;                     /* of D */
    tvi_ensemble_observer *observer; /* called after each step of all members, with `steps` alone */
    tvi_member_observer *at_time, *on_event;
    void *ctx;                    /* of all observers */
    double largest_step;          /* no step to a tolerance is larger; 0: no limit */
    tvi_member_observer *at_step; /* called after each step of a member, with 1.. (INT_MAX from there on) */
    struct tvi_record *record;    /* what the run leaves behind for gradients (tvi_gradient.h); not in an ensemble */
    /* Columns of D are moved several at once, by systems that keep the history of their steps, which is cheaper than
     * each by itself (docs/chaos.md). D is then the same to roundoff, and not bit for bit. It serves tvi_run with
     * "galerkin" and, for constant masses, "stormer-verlet" and "taylor"; but no constrained system, no K = g (H + e),
     * and no Lagrangian that is not separable (TVI_EUNSUPPORTED). */
    bool columns_at_once;
    size_t size; /* sizeof(tvi_run_plan), or 0: that of the first version that had it */
} tvi_run_plan;

/* Makes the run that the plan describes, from (t, q, p) in place. Within a step the times and the events are reported
 * in order of time, a time before an event at the same time; then at_step is called, then observer. The steps, and all
 * that is reported of them, are bit for bit those of the functions above, and without columns_at_once D after a step is
 * bit for bit that of tvi_step_tangent. While at_time or on_event is called, D belongs to the state that is reported,
 * at this fixed time: it is D at the start of the step, moved by the part of the step that leads there. Numbers written
 * to D there have no effect on the steps that follow; at_step and observer may change D. With a tolerance D is moved by
 * a step of the size that was chosen, without the refinement of the state in long double. The run ends, as those of the
 * functions above,
 *   - when on_event returns a value other than 0, or at a terminal event: at the event, with D there;
 *   - when at_time does: after the step that contains the time, with D after that step. With events in the plan, all
 *     events and times of that step are reported before. Without, its other times may be given in the next call, and
 *     D, if there is one, has to be what this run left.
 * If a step or a column of D fails, t, q, p and D are those after the last step that did not.
 *   TVI_EINVAL        NULL; a plan of two modes, or whose members contradict each other, which tvi_last_error names;
 *                     another size; what the function above for its mode refuses; a record of another system or
 *                     other options, or that another run writes
 *   TVI_EUNSUPPORTED  a tolerance with another method than "taylor", or a rescaled system; columns_at_once where it
 *                     does not serve, and in an ensemble; a record in a run to a tolerance, or with other parameters
 *                     than those with which it began
 *   TVI_ENONFINITE    also D that is not finite, before or after a step
 *   TVI_ESTOPPED      an observer or a terminal event ended the run
 *   TVI_ENOMEM        no memory; also a record that is full
 *   others            as of the function above for its mode, and of tvi_step_tangent */
TVI_NODISCARD tvi_status tvi_run(tvi_integrator *integrator, const tvi_run_plan *plan, double *t, double q[],
                                 double p[]);

/* ---- Which step -------------------------------------------------------------------------------------------------- */

/* Finds the step h of a run from (t, q, p) to plan->t_end, either way, whose error at the end is at most the wanted
 * one, and measures that error. The error is the largest difference of a coordinate from the right one, relative to the
 * largest coordinate of the orbit, or of a momentum, relative to the largest momentum; with events in the plan, of
 * which the terminal ones end the runs, also that of the time of the end, relative to the duration. q[n], p[n] and the
 * options are those for tvi_integrator_create; the run is then made by tvi_integrate_to or a plan with this h, which
 * has the sign of the duration and, but for a rescaled system, is not longer.
 *
 * The whole run is made several times: once by "taylor" to a tolerance of 1e-6, whose steps see what is short and
 * narrow, and in pairs with h and h / 1.5, the distance of whose ends is the error of h. Where roundoff may make more,
 * *measured is what the random walk of the rounded impulses makes (docs/roundoff.md), to a factor of 3 or so. h is made
 * smaller by the order of the method until the error is at most the wanted one, by half where a step is refused or a
 * step takes more than 20 passes in the mean, and larger while the error is below a hundredth of it. That costs about 4
 * runs with the final h (docs/choosing.md). For runs of hours give a shorter one: errors of regular orbits grow as t,
 * roundoff as t^(3/2).
 *
 * Of the plan are read t_end; events; largest_step, which h does not exceed, for pushes in time that fall between the
 * steps of all runs; steps, the most that all runs may make, 0: 10^7; at_step and ctx: at_step is called once in 1024
 * steps and after each run, with member 0, the number of steps of all runs and the state, and a value other than 0 ends
 * the search. Its other observers are not called.
 *   TVI_EROUNDOFF  roundoff makes more of the run: *h and *measured are those of the smallest error that was found
 *   TVI_ESTOPPED   at_step ended the search, or the steps are used up: *h and *measured are those of the smallest error
 *                  that was found, if there is one, and as they were if not
 *   TVI_EINVAL     NULL, a plan with h, tolerance, times or D, a duration that is 0, not finite or roundoff of t, an
 *                  error below DBL_EPSILON or not below 1
 *   TVI_ENOMEM     no memory
 *   others         as of tvi_integrator_create, and of tvi_step if no size of it is accepted */
TVI_NODISCARD tvi_status tvi_measure_step(const tvi_system *system, const tvi_options *options,
                                          const tvi_run_plan *plan, double t, const double q[], const double p[],
                                          double error, double *h, double *measured);
/* Does the same for a run of that duration without events, and does not tell the error. */
TVI_NODISCARD tvi_status tvi_suggest_step(const tvi_system *system, const tvi_options *options, double t,
                                          const double q[], const double p[], double duration, double error, double *h);

#ifdef __cplusplus
}
#endif
#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#include "tvi_chaos.h"
#include "tvi_ensemble.h"
#include "tvi_gradient.h"

#endif
