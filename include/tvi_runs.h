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

/* Both give states between steps. Such a state is that of a step of the method, of the part of h that leads there from
 * the start of the step at hand, in an integrator of its own: its invariants are as good as those of the steps, and the
 * steps are bit for bit those of tvi_integrate. A state at a given time costs one step. Events cost each step a search,
 * of which the states are shared, and each event that is found costs one to three steps (docs/performance.md). */

/* A function g of the state. It is written in jets, like a force.
 *
 * An event is where g reaches 0 or changes its sign, at a time in (t0, t_end] of the run; where it leaves 0 is none.
 * However a run is cut into calls, each event is told once, in order of time, and of the events where times are equal:
 *   - A call that goes on from the integrator's own state, whatever was saved and loaded between, takes the sign that g
 *     has there, by the evaluation that ended the step before.
 *   - Where events have stopped a run, the integrator keeps t and q, and which functions were told there. As long as t
 *     and q are these, whatever p was made, these events are left and not told again. All events at the time of one
 *     that ends the run, to the resolution of t, are told before TVI_ESTOPPED.
 *   - Any other state is on an event where |g| is at most the roundoff of its inputs and operations. A run that begins
 *     on an event does not tell it.
 * What leaves an event has from then on the sign of the first Taylor coefficient of g along the motion that is above
 * its own roundoff. Returns to it, as flights of a ball that bounces, are told as long as they are longer than t
 * resolves (DBL_EPSILON |t|); a shorter one after a stop is refused: TVI_ENOCONV, with the state as it was. Such a ball
 * is at rest. (One that is given p = 0 there falls on: g leaves 0.) A g that stays within its roundoff over a whole
 * step has no event in it. Parameters that an observer sets hold from the next step on, as from a new state. */
typedef jet tvi_event_fn(const jet q[], const jet p[], jet t, void *ctx);
/* Of g along the run, whatever the sign of h. */
typedef enum { TVI_FALLING = -1, TVI_EITHER = 0, TVI_RISING = 1 } tvi_direction;

typedef struct tvi_event tvi_event;
/* g is called once, during the call, with n coordinates and momenta; a terminal event ends the run. The event serves
 * every system of dimension n, is read-only once made and may be shared. *out is NULL on failure; statuses as of
 * tvi_system_force.
 *   TVI_EINVAL  also what is no direction */
TVI_NODISCARD tvi_status tvi_event_create(tvi_event **out, int n, tvi_direction direction, bool terminal,
                                          tvi_event_fn *g, void *ctx);
void tvi_event_free(tvi_event *event); /* NULL is allowed */

/* Called at events[which], with its time and state; a value other than 0 ends the run there. */
typedef int tvi_event_observer(int which, double t, const double q[], const double p[], void *ctx);
/* tvi_integrate with events[count]. on_event is called for each in time order, before the observer is called for the
 * step that they are in. g is looked at along the step's curve (tvi_dense), between 8 equal parts, and where |g| has a
 * least value between these, with a kink or without (docs/limits.md says what that can miss). The time and the state
 * are those of the change of sign on the method's own solution, to roundoff of the orbit, whatever slope g has there.
 * Either observer may be NULL; both are given ctx. Observers may set the integrator's parameters, reset it, save its
 * state and ask it; stepping it or loading a state is refused (TVI_EINVAL) while it calls them.
 *   TVI_ESTOPPED   an observer or a terminal event ended the run: t, q, p are those of the step, or of the event. An
 *                  event is no step: from it the run goes on as from any new state.
 *   TVI_ENOCONV    also an event that is reached again before the time moves: t, q, p are where it was left
 *   TVI_EDOMAIN, TVI_ENONFINITE   also where g has no value: t, q, p are then those at the end of the step
 *   TVI_EINVAL     also an event of another dimension or NULL, count < 0
 *   TVI_ENOMEM     no memory */
TVI_NODISCARD tvi_status tvi_integrate_events(tvi_integrator *integrator, double h, long steps,
                                              const tvi_event *const events[], int count, double *t, double q[],
                                              double p[], tvi_observer *observer, tvi_event_observer *on_event,
                                              void *ctx);

/* Steps of size h until the last of times[count] is reached or passed. The observer is called at each of the times,
 * with 1..count as its step. They go the way of h, none before *t; or, where t, q and p are what the integrator's last
 * step returned and it has made or loaded nothing since, none before the start of that step, so that a list may be
 * given in several calls. The state is that after the last step, not that at the last time; where the observer stopped
 * the run (TVI_ESTOPPED), after the step that holds that time. Of a rescaled system the place of a time is found by
 * dt/ds = g, to roundoff of t, also where a step covers little of it.
 *   TVI_EINVAL     NULL, count < 0, times that are not finite or not in order
 *   TVI_ENOCONV    also a run that would never end: 65,536 steps in a row, of which each covered less than 1.1e-16 of
 *                  the time that was left, as where the scale g of a rescaled system goes to 0
 *   TVI_ENOMEM     no memory
 *   others         as of tvi_integrate */
TVI_NODISCARD tvi_status tvi_integrate_at(tvi_integrator *integrator, double h, const double times[], int count,
                                          double *t, double q[], double p[], tvi_observer *observer, void *ctx);

/* Steps of size h to t_end exactly, by a last shorter step; h goes the way to t_end. Of a rescaled system h is in s:
 * the step that passes t_end is taken back, and the part of it found that ends there to roundoff. Each step is the
 * method's, but the last one has another size: a run that goes on from t_end is not the one without a stop there.
 *   TVI_EINVAL     NULL, h = 0, values that are not finite, t_end on the other side of *t
 *   TVI_ENOCONV    also a run that would never end, as in tvi_integrate_at
 *   TVI_ENOMEM     no memory
 *   others         as of tvi_integrate, also where the step that would pass t_end fails */
TVI_NODISCARD tvi_status tvi_integrate_to(tvi_integrator *integrator, double h, double t_end, double *t, double q[],
                                          double p[], tvi_observer *observer, void *ctx);

/* Steps to t_end exactly, either way, each as large as a relative tolerance allows. "taylor" only, for short accurate
 * runs: it is not symplectic, and its energy drifts. Of the last coefficients x_k of the curve of order N, rho is the
 * least (|x_0| / |x_k|)^(1/k), the largest component each, of q and p apart; h = rho (tolerance / e^5)^(1/N). The order
 * that suits a tolerance is N = ceil(1 - ln(tolerance) / 2), where h = rho e^(-2 - 3/N): 8 for 1e-6, 13 for 1e-10, 19
 * for 1e-15 (Jorba and Zou, Experimental Mathematics 14 (2005)); one half as large again is a little faster where the
 * system is small. A step's error is some hundredths of the tolerance, and the error of a run over tens of revolutions
 * at most 100 times the tolerance (docs/adaptive.md): below 1e-13 steps are refined in long double, which takes 1.4 to
 * 2 times as long, and of a Lagrangian that is not separable the error is that of roundoff. The size is chosen before
 * the step is summed: a step costs one expansion. It is at most 0.7 of the radius of convergence that the last
 * coefficients show by themselves and at most four times the size of the step before; and where the coefficients allow
 * more than 1.5 times that, or before a first step, a separable system's force is looked at where the step ends, and
 * the step halved until it is right there. So bodies from afar feel what they meet, unless the force is 0 in doubles
 * both where a step begins and where it ends, as a narrow wall's far away: then tvi_run_plan.largest_step says how far
 * a step may look. The observer is called after each step, and may ask tvi_dense.
 *   TVI_EINVAL       NULL, a tolerance below DBL_EPSILON or not below 1, t_end that is not finite
 *   TVI_EUNSUPPORTED another method, a rescaled system
 *   TVI_ENOCONV      also a step below roundoff of t, as before a collision
 *   others           as of tvi_integrate */
TVI_NODISCARD tvi_status tvi_integrate_tolerance(tvi_integrator *integrator, double tolerance, double t_end, double *t,
                                                 double q[], double p[], tvi_observer *observer, void *ctx);
/* The same steps, with events as in tvi_integrate_events. */
TVI_NODISCARD tvi_status tvi_integrate_tolerance_events(tvi_integrator *integrator, double tolerance, double t_end,
                                                        const tvi_event *const events[], int count, double *t,
                                                        double q[], double p[], tvi_observer *observer,
                                                        tvi_event_observer *on_event, void *ctx);
/* The order of "taylor" that suits a tolerance, N = ceil(1 - ln(tolerance) / 2), but at least 2, for
 * tvi_options_named; 0 for a tolerance that tvi_integrate_tolerance refuses. */
int tvi_taylor_order(double tolerance);

/* ---- Any run, by a plan ------------------------------------------------------------------------------------------ */

/* Called for one member, with q[n] and p[n]; an integrator is an ensemble of one, member 0. For members of an ensemble
 * it is called on any thread, one call at a time; for one member in order of time, for several in any order. A value
 * other than 0 ends the run of the member (TVI_ESTOPPED). */
typedef int tvi_member_observer(int member, int which, double t, const double q[], const double p[], void *ctx);
/* Called after each step, 1..steps, with the states of all members, t[members], q[n][members], p[n][members],
 * status[members], on the thread that called the run; a value other than 0 stops. */
typedef int tvi_ensemble_observer(long step, int members, const double t[], const double q[], const double p[],
                                  const tvi_status status[], void *ctx);

/* How far a run goes, and what it tells: by tvi_run for an integrator, by tvi_ensemble_run for an ensemble. 0 or NULL:
 * nothing of that kind. The ways to go are h and steps; h and t_end; h and times; tolerance and t_end. Each goes with
 * events, with D and with the observers of members. */
typedef struct {
    double h;            /* the step, or 0 and */
    double tolerance;    /* steps as those of tvi_integrate_tolerance, to t_end */
    long steps;          /* so many steps of h; 0: */
    double t_end;        /* to this time exactly, as tvi_integrate_to; */
    const double *times; /* or steps of h as tvi_integrate_at, */
    int time_count;      /* and at_time is called at each of the times, with 1..time_count */
    const tvi_event *const *events;
    int event_count;                 /* on_event is called at each event, with its index, as by tvi_integrate_events */
    double *D;                       /* [2n + parameters][columns], of an ensemble [..][columns][members]: tangent */
    int columns;                     /* vectors, moved on as by tvi_step_tangent */
    tvi_ensemble_observer *observer; /* called after each of the steps of all members, with steps alone */
    tvi_member_observer *at_time, *on_event;
    void *ctx;                    /* of all observers */
    double largest_step;          /* no step to a tolerance is larger; 0: none is too large */
    tvi_member_observer *at_step; /* called after each step of a member, with 1.. (INT_MAX from there on) */
    size_t size;                  /* sizeof(tvi_run_plan), or 0: that of the first version that had it */
} tvi_run_plan;

/* The run that the plan says, from (t, q, p) in place. Within a step the times and the events are told in order of
 * time, a time before an event at the same time; then at_step is called, then observer. The steps, and all that is told
 * of them, are bit for bit those of the functions above, and D after a step is bit for bit that of tvi_step_tangent.
 * While at_time or on_event is called, D is that at the state told, at this fixed time: D at the start of the step,
 * moved by the part of the step that leads there. What is written to it there has no effect on the steps that follow;
 * at_step and observer may change D. With a tolerance D is moved by a step of the size that was chosen, without the
 * refinement of the state in long double.
 * The run ends, as those of the functions above,
 *   - where on_event returned a value other than 0, or at a terminal event: at the event, with D there;
 *   - where at_time did: after the step that holds the time, with D after that step. With events in the plan, all
 *     events and times of that step are told before; without, its other times may be given in the next call, and D, if
 *     there is one, has to be what this run left.
 * Where a step or a column of D fails, t, q, p and D are those after the last step that did not.
 *   TVI_EINVAL        NULL; a plan of two ways to go, or whose members contradict each other, which tvi_last_error
 *                     names; another size; what the function above for its way refuses
 *   TVI_EUNSUPPORTED  a tolerance with another method than "taylor", or a rescaled system
 *   TVI_ENONFINITE    also D that is not finite, before or after a step
 *   TVI_ESTOPPED      an observer or a terminal event ended the run
 *   TVI_ENOMEM        no memory
 *   others            as of the function above for its way, and of tvi_step_tangent */
TVI_NODISCARD tvi_status tvi_run(tvi_integrator *integrator, const tvi_run_plan *plan, double *t, double q[],
                                 double p[]);

/* ---- Which step -------------------------------------------------------------------------------------------------- */

/* The step h of a run of that duration, from (t, q, p), whose error at its end is the wanted one: the largest error of
 * a coordinate relative to the largest coordinate, or of a momentum relative to the largest momentum. Large steps look
 * along the orbit for its hardest part; trial steps there, beside pairs of half the size, are aimed at less than a
 * tenth of the error: on a regular orbit the error is then at most the wanted one, and a step twice as long does not
 * keep it or is refused. On eccentric orbits of fixed steps, e up to 0.9, so it was in all but 1 run of 2000
 * (docs/choosing.md has what was reached). What is not seen, as chaos and close encounters later on, makes it larger.
 * At most 60 steps are made, those of 20 trial steps, or in a run of more than 1200 steps about 5 % of it, and never
 * more than 6000. Make the run by tvi_integrate_to. q[n], p[n], options as for tvi_integrator_create; h is in the unit
 * of t, has the sign of the duration, and is not larger. Of a rescaled system it is in s.
 *   TVI_EINVAL  NULL, a duration that is 0, not finite or roundoff of t, an error below DBL_EPSILON or not below 1, or
 *               below what roundoff is seen to make of the run, or what that of t may make of one whose equations
 *               depend on it
 *   TVI_ENOMEM  no memory
 *   others      as of tvi_integrator_create, and of tvi_step where no size of it is accepted; *h stays as it was */
TVI_NODISCARD tvi_status tvi_suggest_step(const tvi_system *system, const tvi_options *options, double t,
                                          const double q[], const double p[], double duration, double error, double *h);
/* The same, with the part of the duration, in time, whose orbit was looked at, from above 0 to 1: *seen is 1 where that
 * was all of it, and 0.09 says that encounters may follow in the other 91 %, of which h knows nothing. Methods without
 * a tail (tvi_stats) have trial steps alone to look with. On failure *seen stays as it was, too. */
TVI_NODISCARD tvi_status tvi_suggest_step_seen(const tvi_system *system, const tvi_options *options, double t,
                                               const double q[], const double p[], double duration, double error,
                                               double *h, double *seen);

#ifdef __cplusplus
}
#endif
#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#include "tvi_ensemble.h"

#endif
