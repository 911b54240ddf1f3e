/* integrator.c - makes integrators, in one piece of memory each, and says what they are made of. */
#include "run/integrator.h"
#include "compiled/compiled.h"
#include "method/method.h"
#include "system/refuse.h"

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
    double **const vectors[] = {&laid.by.dp, &laid.by.dq, &laid.by.dp_low, &laid.by.dq_low};
    double **const history[] = {&laid.now.p, &laid.now.q, &laid.now.p_low, &laid.now.q_low};
    for (size_t i = 0; i < 4; i++) *vectors[i] = tvi_arena_doubles(arena, dimension + i % 2);
    for (size_t i = 0; i < 4; i++) *history[i] = tvi_arena_history(arena, (dimension + i % 2) * sizeof(double));
    laid.continues = tvi_arena_history(arena, sizeof *laid.continues);
    laid.begun = tvi_arena_turn(arena, (2 * (size_t)system->n + 1) * sizeof *laid.begun);
    laid.kept = tvi_arena_history(arena, sizeof *laid.kept);
    const bool uses_energy = system->stepped != system || options->max_tail >= 0;
    if (system->energy && uses_energy) tvi_energy_take(&laid.energy, arena, system);
    if (system->stepped != system) tvi_energy_take_precise(&laid.transformed, arena, laid.stepped);
    laid.field = tvi_arena_block(arena, laid.stepped->field_values, 1, 1, 0);
    laid.end = tvi_arena_doubles(arena, 2 * dimension + 1);
    laid.parameters = tvi_arena_doubles(arena, (size_t)tvi_system_parameters(system));
    laid.stop = tvi_arena_take(arena, tvi_stop_bytes(system->n));
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
