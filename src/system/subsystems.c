/* subsystems.c - which components of what was recorded know nothing of each other. */
#include "split.h"
#include "system/system.h"

#include <stdlib.h>

/* The first slot of the set that the slot belongs to. */
static int first_of(int first[], int slot)
{
    while (first[slot] != slot) slot = first[slot] = first[first[slot]];
    return slot;
}

static void unite(int first[], int a, int b)
{
    const int of_a = first_of(first, a), of_b = first_of(first, b);
    if (of_a < of_b) first[of_b] = of_a;
    else first[of_a] = of_b;
}

/* Sets of slots of which one depends on the other; numbers, and what depends on the time alone, make none. */
static void unite_operations(const jet_tape *tape, const bool follows[], int first[])
{
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++)
        for (int i = 0; i < run->count; i++)
            for (int k = 0, a; (a = jet_read_by(tape, run, i, k)) >= 0; k++)
                if (follows[a]) unite(first, run->z + i, a);
}

/* A component with its momentum, or velocity, and with what drives the two. */
static void unite_components(const tvi_system *system, const bool follows[], int first[])
{
    const int n = system->n, *output = system->field_values->output;
    for (int u = 0; u < system->inputs; u++) {
        unite(first, u % n, u);
        if (follows[output[u]]) unite(first, u % n, output[u]);
    }
}

/* The sets begin with their first component. place: scratch [n], of 0. */
static void list_members(tvi_subsystems *of, int n, int first[], int place[])
{
    int members = 0;
    for (int i = 0; i < n; i++) place[first_of(first, i)]++;
    for (int i = 0; i < n; i++) {
        if (place[i] == 0) continue;
        const int begin = members;
        of->end[of->count++] = members += place[i];
        place[i] = begin;
    }
    for (int i = 0; i < n; i++) of->member[place[first_of(first, i)]++] = i;
}

tvi_status tvi_system_find_subsystems(tvi_system *system)
{
    const jet_tape *tape = system->field_values;
    const size_t n = (size_t)system->n, slots = (size_t)tape->slots;
    tvi_subsystems *of = &system->parts;
    of->member = calloc(n, sizeof *of->member);
    of->end = calloc(n, sizeof *of->end);
    int *first = calloc(slots, sizeof *first);
    bool *follows = calloc(slots, sizeof *follows);
    int *place = calloc(n, sizeof *place);
    const bool has_memory = of->member && of->end && first && follows && place;
    if (has_memory) {
        for (int i = 0; i < tape->slots; i++) first[i] = i;
        for (int u = 0; u < system->inputs; u++) follows[u] = true;
        jet_tape_follow(tape, follows);
        unite_operations(tape, follows, first);
        unite_components(system, follows, first);
        list_members(of, system->n, first, place);
    }
    free(first);
    free(follows);
    free(place);
    return has_memory ? TVI_OK : TVI_ENOMEM;
}
