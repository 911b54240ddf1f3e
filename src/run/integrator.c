/* integrator.c - holds a state between steps, checks what comes in, and adds the increments by compensated
 * summation. */
#include "run/integrator.h"
#include "compiled/compiled.h"
#include "method/method.h"
#include "algebra/sizes.h"
#include "run/guard.h"
#include "system/refuse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The same of what was before. */
static void *before(const tvi_integrator *it, const void *in_history)
{
    return it->before + ((const char *)in_history - it->history);
}

/* The integrator and all it needs, in one piece. */
static tvi_integrator *lay_out(tvi_arena *arena, const tvi_system *system, const tvi_options *options,
                               const tvi_stepper *stepper)
{
    tvi_integrator *integrator = tvi_arena_take(arena, sizeof *integrator);
    tvi_integrator laid = {.system = system, .options = *options, .stepper = stepper};
    laid.stepped = tvi_compiled_system(arena, system->stepped, options->compiled);
    if (integrator) integrator->options = *options, options = &integrator->options; /* the work refers to them */
    const size_t dimension = (size_t)laid.stepped->n;
    double **const vectors[] = {&laid.dp, &laid.dq};
    double **const history[] = {&laid.now.p, &laid.now.q, &laid.now.p_low, &laid.now.q_low};
    for (size_t i = 0; i < 2; i++) *vectors[i] = tvi_arena_doubles(arena, dimension + i);
    for (size_t i = 0; i < 4; i++) *history[i] = tvi_arena_history(arena, (dimension + i % 2) * sizeof(double));
    laid.continues = tvi_arena_history(arena, sizeof *laid.continues);
    laid.kept = tvi_arena_history(arena, sizeof *laid.kept);
    const bool uses_energy = system->stepped != system || options->max_tail >= 0;
    if (system->energy && uses_energy) tvi_energy_take(&laid.energy, arena, system);
    if (system->stepped != system) tvi_energy_take_precise(&laid.transformed, arena, laid.stepped);
    laid.end = tvi_arena_doubles(arena, 2 * dimension + 1);
    laid.parameters = tvi_arena_doubles(arena, (size_t)tvi_system_parameters(system));
    laid.of_state = arena->marked;
    laid.work = stepper->take(arena, laid.stepped, options);
    laid.blocks = arena->blocks;
    laid.history = arena->history;
    laid.marked = arena->marked;
    laid.remembered = tvi_arena_remembered(arena);
    laid.before = laid.history ? laid.history + laid.remembered : NULL;
    laid.stats.is_compiled = options->compiled != NULL;
    laid.stats.bytes = tvi_arena_bytes(arena);
    if (!integrator) return NULL;
    const tvi_run_state *now = &laid.now;
    laid.start = (tvi_run_state){before(&laid, now->q), before(&laid, now->q_low), before(&laid, now->p),
                                 before(&laid, now->p_low)};
    laid.continued = before(&laid, laid.continues);
    *integrator = laid;
    return integrator;
}

static tvi_status make(tvi_integrator **out, const tvi_system *system, const tvi_options *resolved)
{
    const tvi_stepper *stepper = tvi_method_stepper(resolved);
    tvi_arena arena = {0};
    (void)lay_out(&arena, system, resolved, stepper);
    if (!tvi_arena_open(&arena)) return jet_refuse_memory(TVI_ENOMEM);
    tvi_integrator *it = *out = lay_out(&arena, system, resolved, stepper);
    tvi_compiled_hold(resolved->compiled);
    tvi_system_prepare(system, it->blocks, NULL);
    tvi_system_recorded_parameters(system, it->parameters);
    if (stepper->prepare) stepper->prepare(it->work);
    if (it->energy.block) tvi_energy_prepare(&it->energy);
    return TVI_OK;
}

/* Completes the options, or says why they make no integrator. */
static tvi_status check(const tvi_system *system, tvi_options *options, const char **why)
{
    const tvi_status status = tvi_method_resolve(options, system->stepped, why);
    const char *misfit = status == TVI_OK ? tvi_compiled_misfit(options->compiled, system->stepped, options) : NULL;
    if (!misfit) return status;
    if (why) *why = misfit;
    return jet_refuse(TVI_EINVAL, "%s", misfit);
}

tvi_status tvi_options_check(const tvi_system *system, const tvi_options *options, const char **why)
{
    if (!system || !options) {
        if (why) *why = "system or options is NULL";
        return jet_refuse(TVI_EINVAL, "%s is NULL", system ? "options" : "system");
    }
    tvi_options resolved = *options;
    return check(system, &resolved, why);
}

tvi_status tvi_integrator_create(tvi_integrator **out, const tvi_system *system, const tvi_options *options)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    if (!system) return jet_refuse(TVI_EINVAL, "system is NULL");
    tvi_options resolved = options ? *options : tvi_options_default();
    const tvi_status status = check(system, &resolved, NULL);
    return status == TVI_OK ? make(out, system, &resolved) : status;
}

tvi_status tvi_integrator_twin(tvi_integrator **out, const tvi_integrator *it)
{
    const tvi_status status = make(out, it->system, &it->options);
    return status == TVI_OK ? tvi_integrator_set_parameters(*out, it->parameters) : status;
}

void tvi_integrator_free(tvi_integrator *integrator)
{
    if (!integrator) return;
    if (integrator->tangent) integrator->free_tangent(integrator->tangent);
    const tvi_compiled *compiled = integrator->options.compiled;
    free(integrator);
    tvi_compiled_release(compiled);
}

const tvi_options *tvi_integrator_options(const tvi_integrator *integrator)
{
    return integrator ? &integrator->options : NULL;
}

const tvi_stats *tvi_integrator_stats(const tvi_integrator *integrator)
{
    return integrator ? &integrator->stats : NULL;
}

void tvi_integrator_reset(tvi_integrator *integrator)
{
    if (!integrator) return;
    *integrator->continues = false;
    integrator->stats.largest_tail = 0;
}

bool tvi_integrator_has(const tvi_integrator *it, double t, const double q[], const double p[])
{
    const size_t n = (size_t)it->system->n, bytes = n * sizeof *q;
    return memcmp(&t, &it->now.q[n], sizeof t) == 0 && memcmp(q, it->now.q, bytes) == 0 &&
           memcmp(p, it->now.p, bytes) == 0;
}

/* K as it is with another e, in long double. */
static long double transformed_with(tvi_integrator *it, double e)
{
    it->now.p[it->system->n] = e;
    return tvi_energy_precise(&it->transformed, 0, it->now.q, it->now.p);
}

/* e = -H(q, p, t), where K = g (H + e) is 0 (rescaled.c). The roundoff of H at a pericentre, whose terms cancel, would
 * shift the period of the orbit: e is the root of K in long double, of which K is a linear function. */
static tvi_status set_energy(tvi_integrator *it)
{
    const int n = it->system->n;
    double H;
    const tvi_status status = tvi_energy_of(&it->energy, it->now.q[n], it->now.q, it->now.p, &H);
    if (status != TVI_OK) return tvi_refuse_as("energy", status);
    const double apart = H != 0 ? H : 1;
    const long double there = transformed_with(it, apart - H), here = transformed_with(it, -H);
    const long double correction = apart * (here / (here - there)), e = isfinite(correction) ? correction - H : -H;
    it->now.p[n] = (double)e;
    it->now.p_low[n] = (double)(e - it->now.p[n]);
    return TVI_OK;
}

tvi_status tvi_integrator_begin(tvi_integrator *it, double t, const double q[], const double p[])
{
    const int n = it->system->n;
    if (*it->continues && tvi_integrator_has(it, t, q, p)) return TVI_OK;
    if (!isfinite(t) || !tvi_all_finite(n, q) || !tvi_all_finite(n, p)) return tvi_refuse_state(n, t, q, "p", p);
    tvi_arena_copy(it->history, NULL, it->remembered);
    memcpy(it->now.q, q, (size_t)n * sizeof *q);
    memcpy(it->now.p, p, (size_t)n * sizeof *p);
    it->now.q[n] = t;
    tvi_guard_begin(it);
    return tvi_is_rescaled(it) ? set_energy(it) : TVI_OK;
}

/* The state of the steps, as the user has it. */
static void copy_out(const tvi_integrator *it, double *t, double q[], double p[])
{
    const size_t n = (size_t)it->system->n;
    memcpy(q, it->now.q, n * sizeof *q);
    memcpy(p, it->now.p, n * sizeof *p);
    *t = it->now.q[n];
}

/* The new state from the increments. */
static void advance(tvi_integrator *it, double h)
{
    const tvi_run_state *now = &it->now;
    const int dimension = it->stepped->n;
    it->h = h;
    it->covered = it->dq[it->system->n];
    for (int i = 0; i <= dimension; i++) now->q[i] = tvi_add_compensated(now->q[i], &now->q_low[i], it->dq[i]);
    for (int i = 0; i < dimension; i++) now->p[i] = tvi_add_compensated(now->p[i], &now->p_low[i], it->dp[i]);
    *it->continues = true;
    it->has_dense = true;
}

/* Of a rescaled system the time goes the way of h, and moves: below the roundoff of its low-order part no run would
 * ever end. */
static tvi_status check_time(const tvi_integrator *it, double h)
{
    const double dt = it->dq[it->system->n], t = it->now.q[it->system->n];
    if (fabs(dt) <= DBL_EPSILON * DBL_EPSILON * fabs(t))
        return jet_refuse(TVI_ENOCONV, "the time does not move, as before a collision");
    return (dt > 0) == (h > 0) ? TVI_OK : jet_refuse(TVI_ETOOLARGE, "the time goes the other way");
}

/* q + dq and p + dp are finite. */
static tvi_status check_increments(const tvi_integrator *it, double h)
{
    const int dimension = it->stepped->n;
    for (int i = 0; i <= dimension; i++)
        if (!isfinite(it->now.q[i] + it->dq[i])) return jet_refuse(TVI_ENONFINITE, "q[%d] overflows", i);
    for (int i = 0; i < dimension; i++)
        if (!isfinite(it->now.p[i] + it->dp[i])) return jet_refuse(TVI_ENONFINITE, "p[%d] overflows", i);
    return it->stepped == it->system ? TVI_OK : check_time(it, h);
}

/* The step from the integrator's own state; with a tolerance its size is chosen, and h is the farthest it may go. */
static tvi_status step(tvi_integrator *it, double tolerance, double h)
{
    const tvi_stepper *stepper = it->stepper;
    const tvi_run_state *now = &it->now;
    const int dimension = it->stepped->n;
    const tvi_stats stats = it->stats;
    it->has_dense = false;
    tvi_arena_copy(it->before, it->history, it->marked);
    const tvi_origin origin = {now->q[dimension], now->q_low[dimension], now->q, now->q_low, now->p, now->p_low};
    tvi_status status = tolerance > 0
                            ? stepper->step_within(it->work, tolerance, &h, &origin, it->dq, it->dp, &it->stats)
                            : stepper->step(it->work, h, &origin, it->dq, it->dp, &it->stats);
    it->dq[dimension] = h;
    if (status != TVI_OK) status = tvi_refuse_as("corrector", status);
    if (status == TVI_OK) status = check_increments(it, h);
    if (status == TVI_OK) status = tvi_guard_step(it, &stats);
    if (status == TVI_OK) advance(it, h);
    else tvi_arena_copy(it->history, it->before, it->marked);
    it->stats.steps += status == TVI_OK;
    if (status == TVI_OK) return status;
    const char *const of = it->stepped == it->system ? "" : " in s, of K = g (H + e),";
    return jet_refuse(status, "step of %g%s from t = %g: %s", h, of, now->q[it->system->n], jet_refusal());
}

/* Steps, up to the first that fails. */
static tvi_status go(tvi_integrator *it, long steps, double tolerance, double h, double *t, double q[], double p[])
{
    const tvi_run_arguments given = {it, t, q, p, h};
    if (!it) return tvi_refuse_run(given, "");
    it->has_dense = false;
    if (!t || !q || !p || h == 0 || !isfinite(h)) return tvi_refuse_run(given, "");
    tvi_status status = tvi_integrator_begin(it, *t, q, p);
    if (status != TVI_OK) return status;
    for (long k = 0; k < steps && status == TVI_OK; k++) status = step(it, tolerance, h);
    copy_out(it, t, q, p);
    return status;
}

tvi_status tvi_step(tvi_integrator *it, double h, double *t, double q[], double p[])
{
    return go(it, 1, 0, h, t, q, p);
}

tvi_status tvi_steps(tvi_integrator *it, long steps, double h, double *t, double q[], double p[])
{
    return go(it, steps, 0, h, t, q, p);
}

tvi_status tvi_step_within(tvi_integrator *it, double tolerance, double h, double *t, double q[], double p[])
{
    return go(it, 1, tolerance, h, t, q, p);
}

void tvi_integrator_take_back(tvi_integrator *it, double *t, double q[], double p[])
{
    tvi_arena_copy(it->history, it->before, it->marked);
    it->has_dense = false;
    it->stats.steps--;
    copy_out(it, t, q, p);
}

tvi_status tvi_state_at(tvi_integrator *it, double theta, double *t, double q[], double p[])
{
    const int n = it->system->n;
    if (theta == 1) { /* with the low-order parts */
        copy_out(it, t, q, p);
        return TVI_OK;
    }
    it->stepper->dense(it->work, theta, it->dq, it->dp);
    it->dq[it->stepped->n] = theta * it->h;
    for (int i = 0; i < n; i++) {
        it->dq[i] += it->start.q[i];
        it->dp[i] += it->start.p[i];
    }
    if (!tvi_all_finite(n, it->dq) || !tvi_all_finite(n, it->dp))
        return jet_refuse(TVI_ENONFINITE, "the curve of the step overflows at theta = %g", theta);
    memcpy(q, it->dq, (size_t)n * sizeof *q);
    memcpy(p, it->dp, (size_t)n * sizeof *p);
    *t = it->start.q[n] + (it->start.q_low[n] + it->dq[n]);
    return TVI_OK;
}

tvi_status tvi_dense(tvi_integrator *it, double theta, double q[], double p[])
{
    double t;
    if (!it || !q || !p) return tvi_refuse_run((tvi_run_arguments){it, &t, q, p, 1}, "");
    if (!(theta >= 0 && theta <= 1)) return jet_refuse(TVI_EINVAL, "theta = %g is not in [0, 1]", theta);
    if (!it->has_dense) return jet_refuse(TVI_EINVAL, "there is no last step, or it failed");
    return tvi_state_at(it, theta, &t, q, p);
}

/* ---- Samples ------------------------------------------------------------------------------------------------------
 */

const double tvi_sample_place[TVI_SAMPLES] = {0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1};

/* One after the other. */
static void sample_by_dense(tvi_integrator *it, double *q, double *p, double *t)
{
    const int n = it->system->n;
    for (int k = 0; k < TVI_SAMPLES; k++) {
        it->stepper->dense(it->work, tvi_sample_place[k], it->dq, it->dp);
        it->dq[it->stepped->n] = tvi_sample_place[k] * it->h;
        for (int i = 0; i < n; i++) {
            q[i * TVI_SAMPLES + k] = it->start.q[i] + it->dq[i];
            p[i * TVI_SAMPLES + k] = it->start.p[i] + it->dp[i];
        }
        t[k] = it->start.q[n] + (it->start.q_low[n] + it->dq[n]);
    }
}

void tvi_sample(tvi_integrator *it, const tvi_range of[2], double *x)
{
    const int n = it->system->n, end = TVI_SAMPLES - 1;
    double *q = x, *p = q + n * TVI_SAMPLES, *t = p + n * TVI_SAMPLES;
    if (it->stepper->sample && !tvi_is_rescaled(it)) {
        it->stepper->sample(it->work, of, it->start.q, it->start.p, q, p);
        for (int k = 0; k < end; k++) t[k] = it->start.q[n] + (it->start.q_low[n] + tvi_sample_place[k] * it->h);
    } else {
        sample_by_dense(it, q, p, t);
    }
    for (int i = of[0].first; i < of[0].end; i++) q[i * TVI_SAMPLES + end] = it->now.q[i];
    for (int i = of[1].first; i < of[1].end; i++) p[i * TVI_SAMPLES + end] = it->now.p[i];
    t[end] = it->now.q[n];
}
