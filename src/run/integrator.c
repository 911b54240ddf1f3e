/* integrator.c - holds a state between steps, checks what comes in, and adds the increments by compensated
 * summation. */
#include "run/integrator.h"
#include "method/method.h"
#include "algebra/sizes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The integrator and all it needs, in one piece. */
static tvi_integrator *lay_out(tvi_arena *arena, const tvi_system *system, const tvi_options *options,
                               const tvi_stepper *stepper)
{
    tvi_integrator *integrator = tvi_arena_take(arena, sizeof *integrator);
    tvi_integrator laid = {.system = system, .options = *options, .stepper = stepper};
    if (integrator) integrator->options = *options, options = &integrator->options; /* the work refers to them */
    double **const vectors[] = {&laid.dq, &laid.dp, &laid.q_start, &laid.p_start};
    double **const history[] = {&laid.q, &laid.p, &laid.q_low, &laid.p_low};
    for (int i = 0; i < 4; i++) {
        *vectors[i] = tvi_arena_doubles(arena, (size_t)system->n);
        *history[i] = tvi_arena_history(arena, (size_t)system->n * sizeof(double));
    }
    laid.last = tvi_arena_history(arena, sizeof *laid.last);
    laid.of_state = arena->remembered;
    laid.work = stepper->take(arena, system, options);
    laid.history = arena->history;
    laid.before = laid.history ? laid.history + arena->remembered : NULL;
    laid.remembered = arena->remembered;
    laid.stats.bytes = arena->used + 2 * arena->remembered;
    if (integrator) *integrator = laid;
    return integrator;
}

static tvi_status make(tvi_integrator **out, const tvi_system *system, const tvi_options *resolved)
{
    const tvi_stepper *stepper = tvi_method_stepper(resolved);
    tvi_arena arena = {0};
    (void)lay_out(&arena, system, resolved, stepper);
    const size_t bytes = arena.used + 2 * arena.remembered;
    char *memory = aligned_alloc(ARENA_ALIGNMENT, bytes);
    if (!memory) return TVI_ENOMEM;
    memset(memory, 0, bytes);
    arena = (tvi_arena){.base = memory, .history = memory + arena.used};
    *out = lay_out(&arena, system, resolved, stepper);
    stepper->prepare((*out)->work);
    return TVI_OK;
}

tvi_status tvi_integrator_create(tvi_integrator **out, const tvi_system *system, const tvi_options *options)
{
    if (!out) return TVI_EINVAL;
    *out = NULL;
    if (!system) return TVI_EINVAL;
    tvi_options resolved = options ? *options : tvi_options_default();
    const tvi_status status = tvi_method_resolve(&resolved, system, NULL);
    return status == TVI_OK ? make(out, system, &resolved) : status;
}

tvi_status tvi_integrator_twin(tvi_integrator **out, const tvi_integrator *it)
{
    return make(out, it->system, &it->options);
}

void tvi_integrator_free(tvi_integrator *integrator)
{
    if (integrator) tvi_tangent_free(integrator->tangent);
    free(integrator);
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
    if (integrator) integrator->last->continues = false;
}

/* Whether the state is bitwise what the last successful step returned. */
static bool is_continued(const tvi_integrator *it, double t, const double q[], const double p[])
{
    const size_t bytes = (size_t)it->system->n * sizeof *q;
    return it->last->continues && memcmp(&t, &it->last->t, sizeof t) == 0 && memcmp(q, it->q, bytes) == 0 &&
           memcmp(p, it->p, bytes) == 0;
}

/* The new state from the increments; the old one is the start of the dense output. */
static void advance(tvi_integrator *it, double h, double *t, double q[], double p[])
{
    it->h = h;
    it->t_start = *t;
    it->t_start_low = it->last->t_low;
    for (int i = 0; i < it->system->n; i++) {
        it->q_start[i] = q[i];
        it->p_start[i] = p[i];
        q[i] = it->q[i] = tvi_add_compensated(q[i], &it->q_low[i], it->dq[i]);
        p[i] = it->p[i] = tvi_add_compensated(p[i], &it->p_low[i], it->dp[i]);
    }
    *t = it->last->t = tvi_add_compensated(*t, &it->last->t_low, h);
    it->last->continues = true;
    it->has_dense = true;
}

/* q + dq and p + dp are finite. */
static bool increments_are_finite(const tvi_integrator *it, double h, double t, const double q[], const double p[])
{
    for (int i = 0; i < it->system->n; i++)
        if (!isfinite(q[i] + it->dq[i]) || !isfinite(p[i] + it->dp[i])) return false;
    return isfinite(t + h);
}

tvi_status tvi_step(tvi_integrator *it, double h, double *t, double q[], double p[])
{
    if (!it) return TVI_EINVAL;
    it->has_dense = false;
    if (!t || !q || !p || h == 0 || !isfinite(h)) return TVI_EINVAL;
    it->continued = is_continued(it, *t, q, p);
    if (!it->continued) {
        if (!isfinite(*t) || !tvi_all_finite(it->system->n, q) || !tvi_all_finite(it->system->n, p))
            return TVI_ENONFINITE;
        tvi_arena_copy(it->history, NULL, it->remembered);
    }
    tvi_arena_copy(it->before, it->history, it->remembered);
    const tvi_origin origin = {*t, it->last->t_low, q, it->q_low, p, it->p_low};
    tvi_status status = it->stepper->step(it->work, h, &origin, it->dq, it->dp, &it->stats);
    if (status == TVI_OK && !increments_are_finite(it, h, *t, q, p)) status = TVI_ENONFINITE;
    if (status != TVI_OK) {
        tvi_arena_copy(it->history, it->before, it->remembered);
        return status;
    }
    advance(it, h, t, q, p);
    it->stats.steps++;
    return TVI_OK;
}

tvi_status tvi_dense(tvi_integrator *it, double theta, double q[], double p[])
{
    if (!it || !q || !p || !(theta >= 0 && theta <= 1) || !it->has_dense) return TVI_EINVAL;
    const int n = it->system->n;
    const size_t bytes = (size_t)n * sizeof *q;
    if (theta == 1) { /* with the low-order parts */
        memcpy(q, it->q, bytes);
        memcpy(p, it->p, bytes);
        return TVI_OK;
    }
    it->stepper->dense(it->work, theta, it->dq, it->dp);
    for (int i = 0; i < n; i++) {
        it->dq[i] += it->q_start[i];
        it->dp[i] += it->p_start[i];
    }
    if (!tvi_all_finite(n, it->dq) || !tvi_all_finite(n, it->dp)) return TVI_ENONFINITE;
    memcpy(q, it->dq, bytes);
    memcpy(p, it->dp, bytes);
    return TVI_OK;
}

/* ---- Samples ------------------------------------------------------------------------------------------------------
 */

const double tvi_sample_place[TVI_SAMPLES] = {0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1};

double tvi_time_at(const tvi_integrator *it, double theta)
{
    return theta == 1 ? it->last->t : it->t_start + (it->t_start_low + theta * it->h);
}

/* One after the other. */
static void sample_by_dense(tvi_integrator *it, double *q, double *p)
{
    for (int k = 0; k < TVI_SAMPLES; k++) {
        it->stepper->dense(it->work, tvi_sample_place[k], it->dq, it->dp);
        for (int i = 0; i < it->system->n; i++) {
            q[i * TVI_SAMPLES + k] = it->q_start[i] + it->dq[i];
            p[i * TVI_SAMPLES + k] = it->p_start[i] + it->dp[i];
        }
    }
}

void tvi_sample(tvi_integrator *it, double *x)
{
    const int n = it->system->n, end = TVI_SAMPLES - 1;
    double *q = x, *p = q + n * TVI_SAMPLES, *t = p + n * TVI_SAMPLES;
    if (it->stepper->sample) it->stepper->sample(it->work, it->q_start, it->p_start, q, p);
    else sample_by_dense(it, q, p);
    for (int i = 0; i < n; i++) {
        q[i * TVI_SAMPLES + end] = it->q[i];
        p[i * TVI_SAMPLES + end] = it->p[i];
    }
    for (int k = 0; k < end; k++) t[k] = it->t_start + (it->t_start_low + tvi_sample_place[k] * it->h);
    t[end] = it->last->t;
}

tvi_status tvi_integrate(tvi_integrator *it, double h, long steps, double *t, double q[], double p[],
                         tvi_observer *observer, void *ctx)
{
    if (!it || !t || !q || !p || h == 0 || !isfinite(h) || steps < 0) return TVI_EINVAL;
    for (long step = 1; step <= steps; step++) {
        const tvi_status status = tvi_step(it, h, t, q, p);
        if (status != TVI_OK) return status;
        if (observer && observer(step, *t, q, p, ctx) != 0) return TVI_ESTOPPED;
    }
    return TVI_OK;
}
