/* tvi_gradient.h - gradients: derivatives of whatever is made of the results of runs, by the state at their start and
 * by the parameters. tvi_runs.h includes it. */
#ifndef TVI_GRADIENT_H
#define TVI_GRADIENT_H

#include "tvi.h"

#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif
#ifdef __cplusplus
extern "C" {
#endif

/* What runs leave behind for gradients: a run with `record` in its plan (tvi_runs.h) writes it. A run that begins where
 * the one before ended goes on with the record, if it has the same parameters (with others it is refused); any other
 * one begins it anew. One thread uses a record at a time, and the system outlives it. The integrator may run compiled
 * code; the way back does not. */
typedef struct tvi_record tvi_record;

/* Creates a record for runs of this integrator, or of others with its system and options. It keeps the state of each
 * step, with its low-order parts, in half of so many bytes (0: 64 MiB), and in the other half copies of the
 * integrator's history, from which steps that found no room are made again, with the same bits. Such a copy, of some
 * kilobytes, is also made where a run begins that does not go on from the end of a step. *out is NULL on failure.
 *   TVI_EINVAL       NULL, bytes for fewer than 16 steps
 *   TVI_EUNSUPPORTED methods other than "galerkin" and "stormer-verlet"; constrained systems
 *   TVI_ENOMEM       no memory */
TVI_NODISCARD tvi_status tvi_record_create(tvi_record **out, const tvi_integrator *integrator, size_t bytes);
void tvi_record_free(tvi_record *record); /* NULL is allowed */
/* Returns how many steps, times and events have been told since the record began. Pointers may be NULL. */
long tvi_record_counts(const tvi_record *record, int *times, int *events);
/* Returns the memory that runs have taken of it, and its integrator, in bytes. */
size_t tvi_record_bytes(const tvi_record *record);

/* Adds a running integral, of l(q, p, t) over the time, to a record, which begins anew; it is the next one from 0 on.
 * It is summed at the nodes of the steps, and is as accurate as these. For "galerkin".
 *   TVI_EINVAL       NULL, a run that writes the record, a parameter that the system has not
 *   TVI_EUNSUPPORTED "stormer-verlet"
 *   others           as of tvi_event_create */
TVI_NODISCARD tvi_status tvi_record_integral(tvi_record *record, tvi_event_fn *l, void *ctx);
/* Sets value [integrals] to the running integrals from the start of the record to the end of its last run. */
void tvi_record_integrals(const tvi_record *record, double value[]);

/* The derivatives of a function of the results, the loss, by what the runs of a record have told: NULL stands for
 * zeros. The end of a run to t_end is at a fixed time, so that a derivative by that time is not used. */
typedef struct {
    const double *end;       /* [2n + 1] by q, p and t at the end of the last run */
    const double *at_times;  /* [times][2n] by q and p at each of the times */
    const double *at_events; /* [events][2n + 1] by q, p and t of each event that was reported */
    const double *integrals; /* [integrals] by each running integral */
    size_t size;             /* sizeof(tvi_loss), or 0: that of the first version */
} tvi_loss;

/* Computes the derivatives of the loss: by_start [2n + 1], by q, p and t at the start of the first run, and
 * by_parameters [tvi_system_parameters]. Either may be NULL. Multipliers a, the derivatives by the state, start at the
 * end and move back through all steps, by steps of -h of the adjoint system; these are the exact derivatives of the
 * steps, to roundoff (docs/method.md section 13): of the map that was computed, with h given; with `passes` or
 * `tolerance` in the options to what the passes of the run have left. Derivatives by times, of events or t_end, are
 * those of the flow, to the error of a step. It may be called again, with other losses, and takes about as long as 2 to
 * 5 runs.
 *   TVI_EINVAL       NULL, a loss of another size
 *   TVI_ENONFINITE   a loss that is not finite
 *   TVI_EDOMAIN      a derivative that has no value
 *   TVI_ESINGULAR    an event whose function touches 0 and does not pass through it: its time has no derivative
 *   TVI_ENOCONV ...  a step back that fails, which the text names: with a smaller h it does not
 *   TVI_ENOMEM       no memory */
TVI_NODISCARD tvi_status tvi_gradient(tvi_record *record, const tvi_loss *loss, double by_start[],
                                      double by_parameters[]);

/* Creates the tangent system, which moves a state and a tangent vector of it: coordinates (q, dq), momenta (p, dp), of
 * a Lagrangian that is not separable (dp, p), and parameters (c, dc), of which dc is recorded as rates [parameters], or
 * as 0 for NULL. Its steps of "galerkin", and of "stormer-verlet" and "taylor" where it is separable, move the vector
 * by the derivatives of the steps. A gradient of its runs therefore gives second derivatives times a vector: that of m
 * = l_x.dx by the state at the start is l'' times the vector, where l is a loss with the derivatives l_x by what was
 * told. To tvi_gradient m has the derivative l_x by dx, and l_xx dx by x. It has no energy, and shares nothing with the
 * system.
 *   TVI_EINVAL       NULL, rates that are not finite, n above TVI_MAX_DIMENSION / 2
 *   TVI_EUNSUPPORTED rescaled and constrained systems; and of it no system is made but its tangent system
 *   TVI_ENOMEM       no memory */
TVI_NODISCARD tvi_status tvi_system_tangent(tvi_system **out, const tvi_system *system, const double rates[]);

#ifdef __cplusplus
}
#endif
#if defined(__GNUC__)
#pragma GCC visibility pop
#endif

#endif
