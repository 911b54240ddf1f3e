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

/* The arrays of a state, or of increments, of so many components. */
static void take_rows(tvi_arena *arena, void *(*take)(tvi_arena *, size_t), int dimension, int width,
                      double **const of[4])
{
    for (size_t i = 0; i < 4; i++) /* p, q, p_low, q_low, where q has one row more */
        *of[i] = take(arena, ((size_t)dimension + i % 2) * (size_t)width * sizeof(double));
}

/* All that is of the members, but the stepper's work. */
static void take_members(tvi_integrator *laid, tvi_arena *arena)
{
    const int n = laid->system->n, dimension = laid->stepped->n, width = laid->width;
    const size_t members = (size_t)width, row = members * sizeof(double);
    tvi_run_state *now = &laid->now, *end = &laid->end, *alone = &laid->alone;
    tvi_increments *by = &laid->by;
    take_rows(arena, tvi_arena_take, dimension, width, (double **[]){&by->dp, &by->dq, &by->dp_low, &by->dq_low});
    take_rows(arena, tvi_arena_history, dimension, width, (double **[]){&now->p, &now->q, &now->p_low, &now->q_low});
    laid->continues = tvi_arena_history(arena, members * sizeof *laid->continues);
    laid->begun = tvi_arena_turn(arena, (2 * (size_t)n + 1) * row);
    laid->kept = tvi_arena_history(arena, members * sizeof *laid->kept);
    laid->status = tvi_arena_take(arena, members * sizeof *laid->status);
    laid->moves = tvi_arena_take(arena, members * sizeof *laid->moves);
    laid->passes = tvi_arena_take(arena, members * sizeof *laid->passes);
    laid->doubts = tvi_arena_take(arena, members * sizeof *laid->doubts);
    double **const numbers[] = {&laid->tail, &laid->overflows, &laid->change, &laid->energy_before,
                                &laid->energy_after};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) *numbers[i] = tvi_arena_take(arena, row);
    end->q = tvi_arena_take(arena, ((size_t)dimension + 1) * row);
    end->p = tvi_arena_take(arena, (size_t)dimension * row);
    alone->q = tvi_arena_doubles(arena, (size_t)dimension + 1);
    alone->p = tvi_arena_doubles(arena, (size_t)dimension);
    laid->parameters = tvi_arena_take(arena, (size_t)tvi_system_parameters(laid->system) * row);
    laid->lent = tvi_arena_doubles(arena, (size_t)tvi_system_parameters(laid->system));
    laid->stop = tvi_arena_take(arena, tvi_stop_bytes(n));
}

/* The blocks of one lane, and that of the energies of all members. */
static void take_energies(tvi_integrator *laid, tvi_arena *arena)
{
    const tvi_system *system = laid->system;
    const bool uses_energy = system->energy && (tvi_is_rescaled(laid) || laid->options.max_tail >= 0);
    if (uses_energy) tvi_energy_take(&laid->energy, arena, system);
    if (tvi_is_rescaled(laid)) tvi_energy_take_precise(&laid->transformed, arena, laid->stepped);
    laid->field = tvi_arena_block(arena, laid->stepped->field_values, 1, 1, 0);
    laid->lone = arena->blocks;
    arena->blocks = NULL;
    if (uses_energy && laid->width > 1 && system->form != TVI_LAGRANGIAN)
        tvi_energy_lanes_take(&laid->energies, arena, system, laid->width);
}

/* The integrator of so many members and all it needs, in one piece. */
static tvi_integrator *lay_out(tvi_arena *arena, const tvi_system *system, const tvi_options *options, int width)
{
    tvi_integrator *integrator = tvi_arena_take(arena, sizeof *integrator);
    const tvi_stepper *stepper = tvi_method_stepper(options);
    tvi_integrator laid = {.width = width, .system = system, .options = *options, .stepper = stepper};
    laid.stepped = tvi_compiled_system(arena, system->stepped, options->compiled);
    if (integrator) integrator->options = *options, options = &integrator->options; /* the work refers to them */
    take_members(&laid, arena);
    take_energies(&laid, arena);
    laid.of_state = arena->marked;
    laid.work = width > 1 ? stepper->batch->take(arena, laid.stepped, options, width)
                          : stepper->take(arena, laid.stepped, options);
    laid.blocks = arena->blocks;
    laid.history = arena->history;
    laid.marked = width > 1 ? 0 : arena->marked;
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

static tvi_status make(tvi_integrator **out, const tvi_system *system, const tvi_options *resolved, int width)
{
    tvi_arena arena = {0};
    (void)lay_out(&arena, system, resolved, width);
    if (!tvi_arena_open(&arena)) return jet_refuse_memory(TVI_ENOMEM);
    tvi_integrator *it = *out = lay_out(&arena, system, resolved, width);
    tvi_compiled_hold(resolved->compiled);
    tvi_blocks_prepare(it->lone);
    tvi_blocks_prepare(it->blocks);
    tvi_system_recorded_parameters(system, it->lent);
    tvi_integrator_lend_parameters(it, it->lent, 1, 1);
    const tvi_batch_stepper *batch = tvi_batch_of(it);
    void (*prepare)(void *) = batch ? batch->prepare : it->stepper->prepare;
    if (prepare) prepare(it->work);
    if (it->energy.block) tvi_energy_prepare(&it->energy);
    return TVI_OK;
}

int tvi_integrator_width(const tvi_integrator *it)
{
    const tvi_batch_stepper *batch = it->stepper->batch;
    return batch ? batch->width(it->stepped, &it->options) : 1;
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
    return status == TVI_OK ? make(out, system, &resolved, 1) : status;
}

tvi_status tvi_integrator_twin(tvi_integrator **out, const tvi_integrator *it, int width)
{
    const tvi_status status = make(out, it->system, &it->options, width);
    if (status == TVI_OK) tvi_integrator_lend_parameters(*out, it->parameters, (size_t)it->width, 1);
    return status;
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
