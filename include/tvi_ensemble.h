/* tvi_ensemble.h - ensembles: many orbits of one system, on all cores. tvi_runs.h includes it. */
#ifndef TVI_ENSEMBLE_H
#define TVI_ENSEMBLE_H

#include "tvi.h"

#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif
#ifdef __cplusplus
extern "C" {
#endif

/* ---- Ensembles --------------------------------------------------------------------------------------------------- */

/* Members are orbits of one system, each with a state and parameters of its own. Arrays have the member fastest:
 * q[n][members], p[n][members], t[members], status[members]. A member does not depend on the others: its bits are
 * those of an integrator of its own, in every ensemble and for every number of threads. A member that fails keeps its
 * last good state and its status, and the others go on. Later runs leave it as it is, until its state is another one or
 * tvi_ensemble_reset is called. An ensemble is used by one thread at a time. */
typedef struct tvi_ensemble tvi_ensemble;

/* Creates an ensemble. options NULL: tvi_options_default. threads: the most threads of a run, the caller's among them;
 * 0: as many as this process has processors. Each run starts threads and ends them. Where they cannot be started, it
 * runs on those that it has. *out is NULL on failure.
 *   TVI_EINVAL  also members < 1, threads < 0
 *   others      as of tvi_integrator_create */
TVI_NODISCARD tvi_status tvi_ensemble_create(tvi_ensemble **out, const tvi_system *system, const tvi_options *options,
                                             int members, int threads);
void tvi_ensemble_free(tvi_ensemble *ensemble); /* NULL is allowed */

/* Does what tvi_integrator_set_parameters does, for each member: value[tvi_system_parameters][members]. */
TVI_NODISCARD tvi_status tvi_ensemble_set_parameters(tvi_ensemble *ensemble, const double value[]);
/* Does what tvi_integrator_reset does, for each member. Members that have failed are tried again. Does nothing if an
 * observer of a member calls it. */
void tvi_ensemble_reset(tvi_ensemble *ensemble);

/* Makes `steps` steps of size h of each member. status[m] is TVI_OK, or the status of the step at which member m
 * failed, as of tvi_step. The observer may be NULL, and members then need not wait for each other.
 *   TVI_OK        also if members have failed
 *   TVI_ESTOPPED  the observer stopped it
 *   TVI_EINVAL    NULL, h = 0 or not finite, steps < 0
 *   TVI_ENOMEM    no memory */
TVI_NODISCARD tvi_status tvi_ensemble_integrate(tvi_ensemble *ensemble, double h, long steps, double t[], double q[],
                                                double p[], tvi_status status[], tvi_ensemble_observer *observer,
                                                void *ctx);

/* A plan for all members (tvi_runs.h). Where an exception of C++ leaves an observer in the caller's thread, the run
 * ends once the other threads have ended the runs of their members, and the exception comes out of it; in another
 * thread it ends the program. Where longjmp leaves an observer, the ensemble can be freed alone. */
typedef tvi_run_plan tvi_ensemble_plan;
/* Runs all members by a plan. Members are then as after tvi_run by integrators of their own, and status[m] is its
 * status. It is TVI_ESTOPPED if an event or an observer ended the run of the member; its next run goes on from there. D
 * is [2n + parameters][columns][members].
 *   TVI_EINVAL       as of these runs, NULL
 *   TVI_EUNSUPPORTED as of these runs
 *   others           as of tvi_ensemble_integrate */
TVI_NODISCARD tvi_status tvi_ensemble_run(tvi_ensemble *ensemble, const tvi_ensemble_plan *plan, double t[], double q[],
                                          double p[], tvi_status status[]);

/* Counts of all members together, since the ensemble was created; largest_tail is that of any, tail and residual are 0.
 *   TVI_EINVAL  NULL, an observer of a member calls it */
TVI_NODISCARD tvi_status tvi_ensemble_stats(const tvi_ensemble *ensemble, tvi_stats *stats);

/* These do for one member what tvi_state_to_text and tvi_state_from_text do: t[member], column `member` of q and p, and
 * its parameters. The text is that of an integrator, and either reads it; all members have texts of one size. A member
 * that has failed goes on from it.
 *   TVI_EINVAL  also no such member, and a call from an observer of a member, during which the ensemble holds none */
TVI_NODISCARD tvi_status tvi_ensemble_member_to_text(const tvi_ensemble *ensemble, int member, const double t[],
                                                     const double q[], const double p[], char *text, size_t *size);
TVI_NODISCARD tvi_status tvi_ensemble_member_from_text(tvi_ensemble *ensemble, int member, const char *text,
                                                       size_t size, double t[], double q[], double p[]);
/* Returns the states that the runs go on from, also after texts were read, and the status of each member. Members that
 * have neither run nor been read have zeros.
 *   TVI_EINVAL  NULL, before the first run or text */
TVI_NODISCARD tvi_status tvi_ensemble_last(const tvi_ensemble *ensemble, double t[], double q[], double p[],
                                           tvi_status status[]);

#ifdef __cplusplus
}
#endif
#if defined(__GNUC__)
#pragma GCC visibility pop
#endif

#endif
