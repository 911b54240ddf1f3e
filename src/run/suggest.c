/* suggest.c - Chooses the step of a run by whole runs. Runs with the steps h and h/1.5 end a distance apart, which is
 * the error of h: that of h/1.5 is smaller by 1.5^order. A run of "taylor" to a tolerance goes before them: its steps
 * follow the radius of convergence, so that it does not fly over what is short or narrow. Its smallest step is the
 * scale of the first h, and its end a witness, which tells where both runs are wrong alike.
 *
 * The norm of a distance is the largest difference of a coordinate, relative to the largest coordinate of the orbit, or
 * of a momentum, relative to the largest momentum; and of the time at which a terminal event ended the run, relative to
 * its duration. */
#include "run/run.h"
#include "system/refuse.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>

/* [1] The tolerance of the witness, and that of a second one, which measures the error of the first. */
#define WITNESS_TOLERANCE 1e-6 /* found: make suggest */
#define WITNESS_CHECKING  1e-9 /* found: make suggest */
/* [orders] The order of the witness, more than suits the tolerance, so that it has fewer steps. */
#define WITNESS_ORDER 16 /* found: make suggest */
/* [1] The finer run of a pair has this part of the step. */
#define FINER (1 / 1.5) /* found: make suggest */
/* [runs] What a pair costs. */
#define PAIR (1 + 1 / FINER)
/* [1] The next step aims at this part of the wanted error. */
#define AIM 0.25 /* found: make suggest */
/* [1] Distances above this are no measure of an error: they do not grow as a power of h. */
#define LARGEST_DISTANCE 0.05 /* found: make suggest */
/* [passes] A run with more passes a step is refused. */
#define MOST_PASSES 20 /* found: make suggest */
/* [1] Distances up to this many times the model of roundoff may be roundoff. */
#define ROUNDOFF_DOUBT 300 /* found: make suggest */
/* [pairs] The search ends after this many pairs in a row whose error has not shrunk, against that of the pair before,
 * at least by the power order/2 of the ratio of their steps. */
#define MOST_STALLS 8 /* found: make suggest */
/* [steps] The witness, which is the run by "taylor" to a tolerance, has at least this many, and so has the first run of
 * a search without a witness. */
#define LEAST_STEPS 64 /* found: make suggest */
/* [steps] All runs make at most this many, if the plan names no other number. */
#define MOST_STEPS 10000000
/* [steps] The plan's at_step is called once in this many, and after each run. */
enum { STEPS_BETWEEN_CALLS = 1024, MOST_PAIRS = 1000 };

/* The results of a run to t_end, or to the terminal event that ended it. */
typedef struct {
    double h;             /* the step of the run; 0: the run has not been made, or it was made to a tolerance */
    double *end;          /* [2n + 1] the state at the end: q, p, t */
    long steps;           /* the number of steps */
    double smallest_step; /* the least change of the time in a step but the last one */
    double size[2];       /* the largest |q_i| and |p_i| */
    double largest_rate;  /* the largest change of a coordinate in a step, divided by the time that the step takes */
    double largest_kick;  /* the largest change of a momentum in a step */
    tvi_status status;    /* the status with which the run ended */
} run_result;

typedef struct {
    const tvi_run_plan *plan;
    int n, order;
    const double *start; /* [2n + 1] */
    double duration, wanted;
    tvi_integrator *it;
    long steps, most_steps; /* of all runs */
    bool is_stopped;        /* by the budget or by the plan's at_step */
    bool is_told_to_stop;   /* by the plan's at_step */
    /* Of the run that is made. */
    run_result *run;
    double last_t, last_dt, *last; /* the time and the state [2n] before the step, and the step before it */
    long passes, evaluations;      /* before the run */
    bool has_many_passes;
} search;

/* ---- Runs -------------------------------------------------------------------------------------------------------- */

/* Calls the plan's at_step. */
static bool at_step_stops(const search *s, double t, const double q[], const double p[])
{
    const int steps = s->steps < INT_MAX ? (int)s->steps : INT_MAX;
    return s->plan->at_step && s->plan->at_step(0, steps, t, q, p, s->plan->ctx) != 0;
}

static int after_step(long step, double t, const double q[], const double p[], void *ctx)
{
    search *s = ctx;
    run_result *run = s->run;
    const int n = s->n;
    const long passes = s->it->stats.passes;
    const double dt = fabs(t - s->last_t);
    double moved = 0, kick = 0;
    for (int i = 0; i < n; i++) {
        moved = fmax(moved, fabs(q[i] - s->last[i]));
        kick = fmax(kick, fabs(p[i] - s->last[n + i]));
        run->size[0] = fmax(run->size[0], fabs(q[i]));
        run->size[1] = fmax(run->size[1], fabs(p[i]));
    }
    memcpy(s->last, q, (size_t)n * sizeof *q);
    memcpy(s->last + n, p, (size_t)n * sizeof *p);
    s->last_t = t;
    const long evaluations = s->it->stats.force_evaluations - s->evaluations, most = MOST_PASSES * (step + LEAST_STEPS);
    s->has_many_passes =
        run->h != 0 && (passes - s->passes > most || evaluations > most * (1 + s->it->options.quadrature_points));
    run->steps = step;
    run->smallest_step = fmin(run->smallest_step, s->last_dt); /* not that of the last one, which ends the run */
    s->last_dt = dt;
    run->largest_kick = fmax(run->largest_kick, kick);
    if (dt > 0) run->largest_rate = fmax(run->largest_rate, moved / dt);
    s->steps++;
    if (s->steps % STEPS_BETWEEN_CALLS == 0) s->is_told_to_stop |= at_step_stops(s, t, q, p);
    if (s->steps >= s->most_steps || s->is_told_to_stop) s->is_stopped = true;
    return s->is_stopped || s->has_many_passes;
}

/* Returns the largest step of the witness. */
static double witness_limit(const search *s)
{
    const double most = fabs(s->duration) / LEAST_STEPS;
    return s->plan->largest_step > 0 ? fmin(s->plan->largest_step, most) : most;
}

/* Makes a run with steps of h, or for h = 0 to a tolerance, to t_end or to a terminal event. */
static void make_run(search *s, tvi_integrator *it, double h, double tolerance, run_result *run)
{
    const size_t n = (size_t)s->n;
    const tvi_run_plan plan = {.h = h,
                               .tolerance = tolerance,
                               .t_end = s->plan->t_end,
                               .has_t_end = true,
                               .largest_step = tolerance > 0 ? witness_limit(s) : 0,
                               .events = s->plan->events,
                               .event_count = s->plan->event_count};
    *run = (run_result){.h = h, .end = run->end, .smallest_step = INFINITY};
    s->run = run;
    s->it = it;
    s->passes = it->stats.passes;
    s->evaluations = it->stats.force_evaluations;
    s->has_many_passes = false;
    s->last_t = s->start[2 * n];
    s->last_dt = fabs(s->duration);
    memcpy(s->last, s->start, 2 * n * sizeof *s->last);
    memcpy(run->end, s->start, (2 * n + 1) * sizeof *run->end);
    tvi_integrator_reset(it);
    run->status = tvi_run_observed(it, &plan, (tvi_observers){.at_step = after_step, .ctx = s}, run->end + 2 * n,
                                   run->end, run->end + n);
    if (!s->is_stopped) s->is_stopped = s->is_told_to_stop = at_step_stops(s, run->end[2 * n], run->end, run->end + n);
    if (run->status == TVI_ESTOPPED && !s->is_stopped)
        run->status =
            s->has_many_passes ? jet_refuse(TVI_ENOCONV, "its steps take more than %d passes", MOST_PASSES) : TVI_OK;
}

static double distance(const search *s, const run_result *a, const run_result *b)
{
    const double *x = a->end, *y = b->end;
    double largest = fabs(x[2 * s->n] - y[2 * s->n]) / fabs(s->duration);
    for (int i = 0; i < 2 * s->n; i++)
        if (x[i] != y[i]) largest = fmax(largest, fabs(x[i] - y[i]) / fmin(a->size[i / s->n], b->size[i / s->n]));
    return largest;
}

/* The error that roundoff makes of a run (docs/roundoff.md): each step rounds its impulse once, with an error that is
 * evenly distributed and adds up to a walk of the velocity, and so to a distance that grows as t^(3/2). It is the path
 * relative to the orbit, times the rounded part of the momentum, times the walk sqrt(steps / 3). */
static double roundoff_of(const search *s, const run_result *run)
{
    const double of_step = DBL_EPSILON / sqrt(12) * run->largest_kick / fmax(run->size[1], DBL_MIN),
                 path = run->largest_rate * fabs(run->end[2 * s->n] - s->start[2 * s->n]) / fmax(run->size[0], DBL_MIN);
    const double walk = of_step * sqrt((double)run->steps / 3) * fmax(path, 1);
    if (!s->it->system->uses_time) return fmax(walk, DBL_EPSILON);
    const double last = fmax(fabs(s->plan->t_end), fabs(s->start[2 * s->n])); /* the field is that of a rounded time */
    return fmax(walk, DBL_EPSILON * fmax(last * run->largest_rate / fmax(run->size[0], DBL_MIN), 1));
}

/* ---- The witness ------------------------------------------------------------------------------------------------- */

/* Makes a run of "taylor" to the tolerance. Its status is that of the run: without it there is no witness. The steps of
 * a rescaled system see encounters by themselves, and are far fewer than those of a run in time: it has none. */
static void make_witness(search *s, const tvi_system *system, double tolerance, run_result *witness)
{
    tvi_options options;
    tvi_integrator *it = NULL, *const of_search = s->it;
    witness->status = tvi_options_named("taylor", WITNESS_ORDER, &options);
    if (witness->status == TVI_OK) witness->status = tvi_integrator_create(&it, system, &options);
    if (witness->status == TVI_OK) make_run(s, it, 0, tolerance, witness);
    tvi_integrator_free(it);
    s->it = of_search;
}

/* Returns the error of the run with h: the distance of the pair, and what is left of the error of the finer run if it
 * is smaller by 1.5^(order/2), half of what the order says; or the distance from the witness, where it is larger than
 * the witness's own error explains. A step of the witness is wrong by its last term, e^-5 of the tolerance; errors of
 * the energy add up, and those along the orbit as their sum. Where that does not explain the distance, as in chaos, a
 * second witness measures the error of the first. */
static double error_of_pair(search *s, const tvi_system *system, const run_result run[], run_result witness[])
{
    const double ratio = pow(FINER, s->order / 2.0), apart = distance(s, &run[0], &run[1]) / (1 - ratio),
                 steps = (double)witness[0].steps,
                 explained = fmax(WITNESS_TOLERANCE * exp(-5) * steps * steps / 2, fmax(10 * apart, s->wanted));
    if (witness[0].status != TVI_OK) { /* distances that do not shrink with the order are no errors of it */
        const double next = distance(s, &run[1], &run[2]);
        return next <= fmax(apart * ratio, ROUNDOFF_DOUBT * roundoff_of(s, &run[0])) ? apart : 1;
    }
    if (distance(s, &run[0], &witness[0]) <= explained) return apart;
    if (witness[1].steps == 0) make_witness(s, system, WITNESS_CHECKING, &witness[1]);
    if (witness[1].status != TVI_OK) return apart;
    const double from_witness = distance(s, &run[0], &witness[1]);
    return from_witness > 3 * distance(s, &witness[0], &witness[1]) ? fmax(from_witness, apart) : apart;
}

/* ---- The search -------------------------------------------------------------------------------------------------- */

/* Returns the first h. Gauss' quadrature of m nodes has the error rho^(-2m), where 4 radius / h = rho - 1/rho, with the
 * distance `radius` of the nearest singularity in time; other methods of order 2m are no better. The steps of the
 * witness are (tolerance / e^5)^(1/N) of the radius. */
static double first_step(const search *s, const run_result *witness)
{
    const double radius = witness->smallest_step * pow(exp(5) / WITNESS_TOLERANCE, 1.0 / WITNESS_ORDER),
                 rho = pow(fmax((double)witness->steps, 1) / (AIM * s->wanted), 1.0 / s->order),
                 h = fmin(4 * radius / (rho - 1 / rho), fabs(s->duration));
    return copysign(h, s->duration);
}

/* Returns a first h in s, or without a witness: one that the first step allows, and that does not pass t_end. */
static double first_step_by_trials(search *s)
{
    const size_t n = (size_t)s->n;
    for (double h = s->duration; fabs(h) > DBL_EPSILON * fabs(s->duration); h /= 2) {
        double t = s->start[2 * n];
        memcpy(s->last, s->start, 2 * n * sizeof *s->last);
        tvi_integrator_reset(s->it);
        if (tvi_step(s->it, h, &t, s->last, s->last + n) != TVI_OK) continue;
        const double covered = fabs(t - s->start[2 * n]);
        if (covered * (double)s->most_steps < fabs(s->duration)) s->is_stopped = true;
        if (covered < fabs(s->duration)) return h;
    }
    return s->duration; /* which is refused, too */
}

/* Returns a step that is no longer than the plan allows. */
static double limit_step(const search *s, double h)
{
    double most = s->plan->largest_step > 0 ? s->plan->largest_step : INFINITY;
    if (!tvi_is_rescaled(s->it)) most = fmin(most, fabs(s->duration));
    return copysign(fmin(fabs(h), most), h);
}

/* Makes the pair of runs with h and h/1.5, and without a witness one with h/2.25. */
static tvi_status make_runs(search *s, double h, bool has_witness, run_result run[])
{
    for (int k = 0; k < (has_witness ? 2 : 3); k++, h *= FINER) {
        if (run[k].h != h) make_run(s, s->it, h, 0, &run[k]);
        if (run[k].status != TVI_OK) return run[k].status;
        if (!has_witness && run[k].steps < LEAST_STEPS) return jet_refuse(TVI_ETOOLARGE, "the run has too few steps");
    }
    return TVI_OK;
}

/* Returns the next step after one whose error is too large. */
static double next_smaller_step(const search *s, double h, double measured, run_result run[])
{
    const double factor = measured > LARGEST_DISTANCE ? FINER : pow(AIM * s->wanted / measured, 1.0 / s->order);
    if (fabs(factor / FINER - 1) > 0.1) return h * fmax(factor, 1.0 / 4);
    const run_result coarse = run[0]; /* the finer runs are the next coarse ones */
    run[0] = run[1];
    run[1] = run[2];
    run[2] = coarse;
    return run[0].h;
}

/* Refuses a search that has spent its steps, or was told to stop. h is the step of its last runs, and `least` the least
 * error of a run; infinite: none was made. */
static tvi_status refuse_stopped(const search *s, double h, double least)
{
    if (s->is_told_to_stop)
        return jet_refuse(TVI_ESTOPPED, "the search for a step was stopped by at_step, after %ld steps", s->steps);
    return jet_refuse(
        TVI_ESTOPPED, "the search for a step was stopped after %ld steps, at h = %g: %s", s->steps, h,
        isinf(least) ? "the runs were refused, as in a near approach or a collision, or with p that is not M v: take "
                       "rescaled steps"
        : least > LARGEST_DISTANCE
            ? "no h gives that error, as neighbouring orbits part (chaos): give h, or a shorter run"
            : "that error takes more steps than these: give h, or a larger error");
}

static tvi_status search_step(search *s, const tvi_system *system, run_result run[], run_result witness[], double *h,
                              double *error)
{
    tvi_integrator *const it = s->it;
    if (tvi_is_rescaled(it)) witness[0].status = TVI_EUNSUPPORTED;
    else make_witness(s, system, WITNESS_TOLERANCE, &witness[0]);
    if (witness[0].status == TVI_ENOMEM) return jet_explain_out_of_memory(TVI_ENOMEM);
    const bool has_witness = witness[0].status == TVI_OK;
    bool is_found = false;
    int stalls = 0;
    long refused_steps = 0;
    double least = INFINITY, before = INFINITY, h_before = 1;
    double next = has_witness ? first_step(s, &witness[0]) : first_step_by_trials(s);
    tvi_status status = TVI_OK;
    for (int k = 0; k < MOST_PAIRS && !s->is_stopped; k++) {
        next = limit_step(s, next);
        s->is_stopped =
            !tvi_is_rescaled(it) && PAIR * fabs(s->duration) / fabs(next) > (double)(s->most_steps - s->steps);
        if (s->is_stopped) break;
        const long begin = s->steps;
        status = make_runs(s, next, has_witness, run);
        if (s->is_stopped) status = TVI_OK;
        if (s->is_stopped || (status != TVI_OK && !tvi_is_failure_of_member(status))) break;
        if (status != TVI_OK) {
            refused_steps += s->steps - begin; /* a tenth of all may be lost */
            if (is_found || refused_steps > s->most_steps / 10) break;
            if (fabs(next) <= DBL_EPSILON * fabs(s->duration)) break;
            next /= 2;
            continue;
        }
        const double measured = error_of_pair(s, system, run, witness), roundoff = roundoff_of(s, &run[0]),
                     of_run = fmax(measured, roundoff);
        if (witness[1].status == TVI_ENOMEM) return jet_explain_out_of_memory(TVI_ENOMEM);
        if (is_found && of_run > s->wanted) return TVI_OK;
        if (of_run <= s->wanted || of_run < least) *h = next, *error = least = of_run;
        if (of_run <= s->wanted) {
            const double larger = limit_step(s, next * fmin(pow(AIM * s->wanted / of_run, 1.0 / s->order), 3));
            if (of_run >= s->wanted / 100 || larger == next) return TVI_OK;
            is_found = true; /* far too small: a larger step is tried */
            next = larger;
        } else {
            const bool shrinks = measured <= before * pow(fabs(next / h_before), s->order / 2.0);
            stalls = shrinks || measured > LARGEST_DISTANCE ? 0 : stalls + 1;
            if (roundoff > s->wanted || (!shrinks && measured <= ROUNDOFF_DOUBT * roundoff)) break;
            if (stalls == MOST_STALLS)
                return jet_refuse(TVI_ENOCONV, "the error does not shrink with the step: about %.1e at h = %g",
                                  measured, next);
            before = measured;
            h_before = next;
            next = next_smaller_step(s, next, measured, run);
        }
    }
    if (is_found && status != TVI_ENOMEM) return TVI_OK;
    if (s->is_stopped && status == TVI_OK) return refuse_stopped(s, next, least);
    if (status != TVI_OK) return status;
    return jet_refuse(TVI_EROUNDOFF, "error = %g is below roundoff: the smallest error is about %.1e", s->wanted,
                      least);
}

/* ---- The functions ----------------------------------------------------------------------------------------------- */

static tvi_status refuse_arguments(const tvi_system *system, const tvi_run_plan *plan, double t, const double q[],
                                   const double p[], double error, const double *h, const double *measured)
{
    static const char *const name[] = {"system", "plan", "q", "p", "h", "measured"};
    const void *const pointer[] = {system, plan, q, p, h, measured};
    if (!system || !plan || !q || !p || !h || !measured) return tvi_refuse_first_null_pointer(6, pointer, name);
    if (plan->h != 0 || plan->tolerance != 0 || plan->time_count != 0 || plan->D)
        return jet_refuse(TVI_EINVAL, "the plan has an h, a tolerance, times or D: a step is searched for t_end");
    if (plan->steps < 0 || !(plan->largest_step >= 0 && isfinite(plan->largest_step)))
        return jet_refuse(TVI_EINVAL, "steps or largest_step is negative");
    if (!isfinite(t)) return tvi_refuse_nonfinite_state(system->n, t, q, "p", p);
    if (!isfinite(plan->t_end) || plan->t_end == t)
        return jet_refuse(TVI_EINVAL, "duration = %g is 0 or not finite", plan->t_end - t);
    if (!(fabs(plan->t_end - t) > LEAST_STEPS * DBL_EPSILON * fabs(t)))
        return jet_refuse(TVI_EINVAL, "duration = %g is roundoff of t = %g", plan->t_end - t, t);
    if (!(error >= DBL_EPSILON && error < 1))
        return jet_refuse(TVI_EINVAL, "error = %g is below DBL_EPSILON or not below 1", error);
    return tvi_refuse_nonfinite_state(system->n, t, q, "p", p);
}

tvi_status tvi_measure_step(const tvi_system *system, const tvi_options *options, const tvi_run_plan *plan, double t,
                            const double q[], const double p[], double error, double *h, double *measured)
{
    tvi_integrator *it;
    tvi_status status = refuse_arguments(system, plan, t, q, p, error, h, measured);
    if (status == TVI_OK) status = tvi_integrator_create(&it, system, options);
    if (status != TVI_OK) return status;
    const size_t n = (size_t)system->n, state = 2 * n + 1;
    double *memory = calloc(7 * state, sizeof *memory), found_h = 0, found_error = 0;
    if (memory) {
        run_result run[] = {{.end = memory}, {.end = memory + state}, {.end = memory + 6 * state}},
                   witness[] = {{.end = memory + 2 * state}, {.end = memory + 3 * state}};
        search s = {.plan = plan,
                    .n = system->n,
                    .order = it->options.order,
                    .most_steps = plan->steps > 0 ? plan->steps : MOST_STEPS,
                    .start = memory + 4 * state,
                    .duration = plan->t_end - t,
                    .wanted = error,
                    .it = it,
                    .last = memory + 5 * state};
        memcpy(memory + 4 * state, q, n * sizeof *q);
        memcpy(memory + 4 * state + n, p, n * sizeof *p);
        memory[4 * state + 2 * n] = t;
        status = search_step(&s, system, run, witness, &found_h, &found_error);
    } else status = jet_explain_out_of_memory(TVI_ENOMEM);
    free(memory);
    tvi_integrator_free(it);
    if (found_h != 0 && status != TVI_ENOMEM) *h = found_h, *measured = found_error;
    return status;
}

tvi_status tvi_suggest_step(const tvi_system *system, const tvi_options *options, double t, const double q[],
                            const double p[], double duration, double error, double *h)
{
    double found = 0, measured;
    const tvi_run_plan plan = {.t_end = t + duration};
    if (!h) return jet_refuse(TVI_EINVAL, "h is NULL");
    const tvi_status status = tvi_measure_step(system, options, &plan, t, q, p, error, &found, &measured);
    if (found != 0) *h = found;
    return status;
}
