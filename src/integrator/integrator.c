/* integrator.c - Creates and frees integrators, and returns their options and counts of steps. All memory of an
 * integrator is one block, which an arena lays out (algebra/arena.h). */
#include "integrator/integrator.h"
#include "compiled/compiled.h"
#include "method/method.h"
#include "system/refuse.h"

#include <stdlib.h>

/* Returns the address in history_before, the copy of the history, that corresponds to an address in the history
 * itself. */
static void *address_in_history_before(const tvi_integrator *it, const void *address_in_history)
{
    return it->history.before + ((const char *)address_in_history - it->history.now);
}

/* Allocates the four arrays of a state or of increments (p, q, p_low, q_low) with this number of coordinates.
 * `allocate` is the function of the arena that allocates an array. */
static void allocate_state_arrays(tvi_arena *arena, void *(*allocate)(tvi_arena *, size_t), int dimension,
                                  double **const arrays[4])
{
    /* i is odd for the arrays of q and q_low, which have one more component: the time, or the s of a rescaled
     * system. */
    for (size_t i = 0; i < 4; i++) *arrays[i] = allocate(arena, ((size_t)dimension + i % 2) * sizeof(double));
}

/* Allocates the state, the increments and the parameters. The stepper's work is allocated separately. */
static void allocate_state(tvi_integrator *integrator, tvi_arena *arena)
{
    const int n = integrator->system->n, dimension = integrator->stepped->n;
    tvi_run_state *state = &integrator->state, *end = &integrator->guard.end;
    tvi_increments *increments = &integrator->last_step.increments;
    allocate_state_arrays(arena, tvi_arena_allocate, dimension,
                          (double **[]){&increments->dp, &increments->dq, &increments->dp_low, &increments->dq_low});
    allocate_state_arrays(arena, tvi_arena_allocate_copied, dimension,
                          (double **[]){&state->p, &state->q, &state->p_low, &state->q_low});
    integrator->is_state_from_step = tvi_arena_allocate_copied(arena, sizeof *integrator->is_state_from_step);
    integrator->run_start = tvi_arena_allocate_uncopied(arena, (2 * (size_t)n + 1) * sizeof(double));
    integrator->guard.reference_energy = tvi_arena_allocate_copied(arena, sizeof *integrator->guard.reference_energy);
    end->q = tvi_arena_allocate_doubles(arena, (size_t)dimension + 1);
    end->p = tvi_arena_allocate_doubles(arena, (size_t)dimension);
    integrator->parameters = tvi_arena_allocate_doubles(arena, (size_t)tvi_system_parameters(integrator->system));
    integrator->stop = tvi_arena_allocate(arena, tvi_stop_bytes(n));
}

/* Allocates the memory in which energies, the field and the constraints are evaluated. */
static void allocate_energy_memory(tvi_integrator *integrator, tvi_arena *arena)
{
    const tvi_system *system = integrator->system;
    if (system->energy.tape && (tvi_is_rescaled(integrator) || integrator->options.max_tail >= 0))
        tvi_energy_allocate(&integrator->guard.energy_work, arena, system);
    if (tvi_steps_K(integrator)) tvi_energy_allocate_long_double(&integrator->guard.K_work, arena, integrator->stepped);
    const bool has_forces = integrator->stepped->form != TVI_LAGRANGIAN; /* p' as a function of q and p */
    if (system->axes != 0 && has_forces && integrator->stepper->compute_curve_forces &&
        integrator->options.max_tail >= 0)
        integrator->guard.curve_forces =
            tvi_arena_allocate_doubles(arena, (size_t)integrator->stepped->n * (TVI_FORCE_POINTS + 1));
    if (system->constraints) tvi_constraint_allocate(&integrator->constraint_work, arena, system);
    integrator->guard.field_block = tvi_arena_allocate_block(arena, integrator->stepped->field_values, 1, 1, 0);
}

/* Lays out an integrator with all its memory in the arena. In a first call the arena only measures
 * the size of the memory, and the result is NULL. In a second call the arena has the memory. */
static tvi_integrator *lay_out_integrator(tvi_arena *arena, const tvi_system *system, const tvi_options *options)
{
    tvi_integrator *integrator = tvi_arena_allocate(arena, sizeof *integrator);
    const tvi_stepper *stepper = tvi_choose_stepper(options, system);
    tvi_integrator laid = {.system = system, .options = *options, .stepper = stepper};
    laid.stepped = tvi_compiled_attach_to_copy(arena, system->stepped_system, options->compiled);
    /* The stepper's work keeps a pointer to the options, so they must be those of the integrator. */
    if (integrator) integrator->options = *options, options = &integrator->options;
    allocate_state(&laid, arena);
    allocate_energy_memory(&laid, arena);
    laid.history.state_bytes = arena->copied_history_bytes;
    laid.work = stepper->allocate(arena, laid.stepped, options);
    laid.blocks = arena->first_tape_block;
    laid.history.now = arena->history;
    laid.history.copied_bytes = arena->copied_history_bytes;
    laid.history.bytes = tvi_arena_history_bytes(arena);
    laid.history.before = laid.history.now ? laid.history.now + laid.history.bytes : NULL;
    laid.stats.is_compiled = options->compiled != NULL;
    laid.stats.bytes = tvi_arena_total_bytes(arena);
    if (!integrator) return NULL;
    const tvi_run_state *state = &laid.state;
    laid.last_step.start =
        (tvi_run_state){address_in_history_before(&laid, state->q), address_in_history_before(&laid, state->q_low),
                        address_in_history_before(&laid, state->p), address_in_history_before(&laid, state->p_low)};
    laid.last_step.was_state_from_step = address_in_history_before(&laid, laid.is_state_from_step);
    *integrator = laid;
    return integrator;
}

static tvi_status create_resolved_integrator(tvi_integrator **out, const tvi_system *system,
                                             const tvi_options *resolved_options)
{
    tvi_arena arena = {0};
    (void)lay_out_integrator(&arena, system, resolved_options);
    if (!tvi_arena_obtain_memory(&arena)) return jet_explain_out_of_memory(TVI_ENOMEM);
    tvi_integrator *it = *out = lay_out_integrator(&arena, system, resolved_options);
    tvi_compiled_add_user(resolved_options->compiled);
    tvi_blocks_set_constants(it->blocks);
    tvi_system_recorded_parameters(system, it->parameters);
    tvi_integrator_apply_parameters(it);
    if (it->stepper->set_tables) it->stepper->set_tables(it->work);
    return TVI_OK;
}

/* Completes the options of an integrator with their default values. If the options contradict one another or the
 * system, it returns a failure and sets *why to the reason. */
static tvi_status resolve_options(const tvi_system *system, tvi_options *options, const char **why)
{
    const tvi_status status = tvi_options_resolve(options, system->stepped_system, why);
    const char *mismatch =
        status == TVI_OK ? tvi_compiled_why_unusable(options->compiled, system->stepped_system, options) : NULL;
    if (!mismatch) return status;
    if (why) *why = mismatch;
    return jet_refuse(TVI_EINVAL, "%s", mismatch);
}

tvi_status tvi_options_check(const tvi_system *system, const tvi_options *options, const char **why)
{
    if (!system || !options) {
        if (why) *why = "system or options is NULL";
        return jet_refuse(TVI_EINVAL, "%s is NULL", system ? "options" : "system");
    }
    tvi_options resolved = *options;
    return resolve_options(system, &resolved, why);
}

tvi_status tvi_integrator_create(tvi_integrator **out, const tvi_system *system, const tvi_options *options)
{
    if (!out) return jet_refuse(TVI_EINVAL, "out is NULL");
    *out = NULL;
    if (!system) return jet_refuse(TVI_EINVAL, "system is NULL");
    tvi_options resolved = options ? *options : tvi_options_default();
    const tvi_status status = resolve_options(system, &resolved, NULL);
    return status == TVI_OK ? create_resolved_integrator(out, system, &resolved) : status;
}

tvi_status tvi_integrator_create_like(tvi_integrator **out, const tvi_integrator *it)
{
    const tvi_status status = create_resolved_integrator(out, it->system, &it->options);
    if (status == TVI_OK) tvi_integrator_load_parameters(*out, it->parameters, 1);
    return status;
}

void tvi_integrator_free(tvi_integrator *integrator)
{
    if (!integrator) return;
    if (integrator->tangent) integrator->free_tangent(integrator->tangent);
    const tvi_compiled *compiled = integrator->options.compiled;
    free(integrator);
    tvi_compiled_remove_user(compiled);
}

const tvi_options *tvi_integrator_options(const tvi_integrator *integrator)
{
    return integrator ? &integrator->options : NULL;
}

const tvi_stats *tvi_integrator_stats(const tvi_integrator *integrator)
{
    return integrator ? &integrator->stats : NULL;
}
