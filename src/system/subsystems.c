/* subsystems.c - Splits a recorded system into subsystems that do not interact. */
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

/* Unites the slots of which one depends on the other. Constants, and slots that depend on the time alone, unite
 * nothing. */
static void unite_operations(const jet_tape *tape, const bool follows[], int first[])
{
    for (const jet_run *run = tape->run; run < tape->run + tape->runs; run++)
        for (int i = 0; i < run->count; i++)
            for (int k = 0, a; (a = jet_operand_slot(tape, run, i, k)) >= 0; k++)
                if (follows[a]) unite(first, run->z + i, a);
}

/* Unites a component with its momentum or velocity, and with the outputs of the field for both. */
static void unite_components(const tvi_system *system, const bool follows[], int first[])
{
    const int n = system->n, *output = system->field_values->output;
    for (int u = 0; u < system->inputs; u++) {
        unite(first, u % n, u);
        if (follows[output[u]]) unite(first, u % n, output[u]);
    }
}

/* Lists the members of the sets. Each set begins with its first component. counts [n] is scratch, of zeros. */
static void list_members(tvi_subsystems *parts, int n, int first[], int counts[])
{
    int members = 0;
    for (int i = 0; i < n; i++) counts[first_of(first, i)]++;
    for (int i = 0; i < n; i++) {
        if (counts[i] == 0) continue;
        const int begin = members;
        parts->end[parts->count++] = members += counts[i];
        counts[i] = begin;
    }
    for (int i = 0; i < n; i++) parts->member[counts[first_of(first, i)]++] = i;
}

tvi_status tvi_system_find_subsystems(tvi_system *system)
{
    const jet_tape *tape = system->field_values;
    const size_t n = (size_t)system->n, slots = (size_t)tape->slots;
    tvi_subsystems *parts = &system->parts;
    parts->member = calloc(n, sizeof *parts->member);
    parts->end = calloc(n, sizeof *parts->end);
    int *first = calloc(slots, sizeof *first);
    bool *follows = calloc(slots, sizeof *follows);
    int *counts = calloc(n, sizeof *counts);
    const bool has_memory = parts->member && parts->end && first && follows && counts;
    if (has_memory) {
        for (int i = 0; i < tape->slots; i++) first[i] = i;
        for (int u = 0; u < system->inputs; u++) follows[u] = true;
        jet_tape_mark_dependents(tape, follows);
        unite_operations(tape, follows, first);
        unite_components(system, follows, first);
        list_members(parts, system->n, first, counts);
    }
    free(first);
    free(follows);
    free(counts);
    return has_memory ? TVI_OK : TVI_ENOMEM;
}

void tvi_system_split_time(tvi_system *system)
{
    tvi_subsystems *parts = &system->parts;
    const int n = system->n;
    int kept = 0, k = 0;
    for (int part = 0, at = 0; part < parts->count; part++) {
        for (; at < parts->end[part]; at++)
            if (parts->member[at] != n - 1) parts->member[k++] = parts->member[at];
        if (k > (kept ? parts->end[kept - 1] : 0)) parts->end[kept++] = k;
    }
    parts->member[k] = n - 1;
    parts->end[kept++] = n;
    parts->count = kept;
}
