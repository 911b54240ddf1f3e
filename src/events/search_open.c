/* search_open.c - Allocates and frees the memory of the search for events (search.h). */
#include "events/search.h"

#include <stdlib.h>

/* The most roots of one event in a step. Each sample and each dip between samples has two at most. */
enum { MOST_ROOTS = 4 * TVI_SAMPLES + 4 };

/* Allocates the memory in which a tape is evaluated, and writes the tape's constants to it. Returns NULL if memory is
 * exhausted. */
static double *allocate_tape_block(const jet_tape *tape, int lanes)
{
    double *block = malloc((size_t)tape->slot_count * (size_t)lanes * sizeof *block);
    if (block) jet_tape_prepare_block(tape, block, 1, lanes);
    return block;
}

void tvi_search_set_parameters(tvi_event_search *search)
{
    const int count = tvi_system_parameters(search->integrator->system);
    const double *value = search->integrator->parameters;
    for (int event_index = 0; event_index < search->event_count; event_index++) {
        const tvi_watched_event *w = &search->watched_events[event_index];
        jet_tape_set_parameters(w->event->tape, w->tape_block, 1, count, 1, value);
        jet_tape_set_parameters(w->event->series, w->local_series.series_block, 1, count, 1, value);
    }
    jet_tape_set_parameters(search->joint_tape, search->joint_tape_block, TVI_SAMPLES, count, 1, value);
}

/* Returns the range from the first component that is used to the last one. */
static tvi_component_range find_used_component_range(const bool used[], int n)
{
    tvi_component_range range = {0, n};
    while (range.end > 0 && !used[range.end - 1]) range.end--;
    while (range.first < range.end && !used[range.first]) range.first++;
    return range;
}

/* Creates the tape that evaluates all events together, and finds the components of q and p that it depends on. */
static tvi_status create_joint_tape(tvi_event_search *search, const tvi_event *const events[])
{
    bool used[2 * TVI_MAX_DIMENSION + 1];
    const int n = search->integrator->system->n;
    const tvi_status status = tvi_event_create_joint_tape(&search->joint_tape, events, search->event_count, used);
    if (status != TVI_OK) return status;
    search->used_components[0] = find_used_component_range(used, n);
    search->used_components[1] = find_used_component_range(used + n, n);
    return TVI_OK;
}

tvi_status tvi_search_open(tvi_event_search *search, tvi_partial_step *partial_step, const tvi_event *const events[],
                           int count, double t, const double *const state[2])
{
    const size_t some = (size_t)count;
    tvi_integrator *it = partial_step->full_step_integrator;
    const size_t size = 2 * (size_t)it->system->n + 1;
    *search = (tvi_event_search){.integrator = it,
                                 .partial_step = partial_step,
                                 .event_count = count,
                                 .start_state_source = tvi_find_start_state_source(it, t, state[0], state[1])};
    search->watched_events = calloc(some, sizeof *search->watched_events);
    search->roots = calloc(some * MOST_ROOTS, sizeof *search->roots);
    search->scratch_state = calloc(2 * size, sizeof *search->scratch_state);
    if (!search->watched_events || !search->roots || !search->scratch_state) return TVI_ENOMEM;
    search->scratch_increment = search->scratch_state + size;
    for (int event_index = 0; event_index < count; event_index++) {
        tvi_watched_event *w = &search->watched_events[event_index];
        *w = (tvi_watched_event){.event = events[event_index],
                                 .tape_block = allocate_tape_block(events[event_index]->tape, 1)};
        if (!w->tape_block || tvi_event_expansion_open(&w->local_series, w->event) != TVI_OK) return TVI_ENOMEM;
    }
    const tvi_status status = create_joint_tape(search, events);
    if (status != TVI_OK) return status;
    search->joint_tape_block = allocate_tape_block(search->joint_tape, TVI_SAMPLES);
    if (!search->joint_tape_block) return TVI_ENOMEM;
    tvi_search_set_parameters(search);
    return TVI_OK;
}

void tvi_search_close(tvi_event_search *search)
{
    for (int event_index = 0; search->watched_events && event_index < search->event_count; event_index++) {
        free(search->watched_events[event_index].tape_block);
        tvi_event_expansion_close(&search->watched_events[event_index].local_series);
    }
    free(search->watched_events);
    free(search->joint_tape_block);
    jet_tape_free(search->joint_tape);
    free(search->roots);
    free(search->scratch_state);
}
