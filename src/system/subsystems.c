/* subsystems.c - Splits a recorded system into subsystems that do not interact, by a union-find over the slots of
 * its tape. statement.c calls it. */
#include "split.h"
#include "system/system.h"

#include <stdlib.h>
#include <string.h>

/* Finds the first slot of the set that the slot belongs to. set_parent [slots] leads from each slot to an earlier one
 * of its set, and from the first one to itself. */
static int find_first_slot_of_set(int set_parent[], int slot)
{
    while (set_parent[slot] != slot) slot = set_parent[slot] = set_parent[set_parent[slot]];
    return slot;
}

/* Unites the sets of two slots. The first slot of the united set is the smaller one of the two. */
static void unite_sets(int set_parent[], int a, int b)
{
    const int first_of_a = find_first_slot_of_set(set_parent, a), first_of_b = find_first_slot_of_set(set_parent, b);
    if (first_of_a < first_of_b) set_parent[first_of_b] = first_of_a;
    else set_parent[first_of_a] = first_of_b;
}

/* Unites the sets of each operation's result and operands. Operands that do not depend on the state (constants,
 * functions of the time) unite nothing. */
static void unite_results_with_operands(const jet_tape *tape, const bool depends_on_state[], int set_parent[])
{
    for (const jet_run_of_operations *run = tape->runs; run < tape->runs + tape->run_count; run++)
        for (int i = 0; i < run->operation_count; i++)
            for (int k = 0, a; (a = jet_operation_operand_slot(tape, run, i, k)) >= 0; k++)
                if (depends_on_state[a]) unite_sets(set_parent, run->z + i, a);
}

/* Unites the inputs of each component, which are its coordinate and its momentum or velocity, with each other, and with
 * the outputs of the field that belong to the inputs. */
static void unite_components_with_outputs(const tvi_system *system, const bool depends_on_state[], int set_parent[])
{
    const int n = system->n, *output = system->field_values->output_slot;
    for (int u = 0; u < system->input_count; u++) {
        unite_sets(set_parent, u % n, u);
        if (depends_on_state[output[u]]) unite_sets(set_parent, u % n, output[u]);
    }
}

/* Lists the components of each set. The sets are ordered by their first components. `lone_component` becomes a
 * subsystem of its own; it is -1 if there is no such component. counts [n] is scratch. */
static void list_components_of_sets(tvi_subsystems *subsystems, int n, int set_parent[], int lone_component,
                                    int counts[])
{
    int component_count = 0;
    memset(counts, 0, (size_t)n * sizeof *counts);
    for (int i = 0; i < n; i++) counts[i == lone_component ? i : find_first_slot_of_set(set_parent, i)]++;
    for (int i = 0; i < n; i++) {
        if (counts[i] == 0) continue;
        const int begin = component_count;
        subsystems->end_in_component_list[subsystems->count++] = component_count += counts[i];
        counts[i] = begin;
    }
    for (int i = 0; i < n; i++)
        subsystems->component_list[counts[i == lone_component ? i : find_first_slot_of_set(set_parent, i)]++] = i;
}

static bool allocate_subsystem_lists(tvi_subsystems *subsystems, size_t n)
{
    subsystems->component_list = calloc(n, sizeof *subsystems->component_list);
    subsystems->end_in_component_list = calloc(n, sizeof *subsystems->end_in_component_list);
    return subsystems->component_list && subsystems->end_in_component_list;
}

tvi_status tvi_system_find_subsystems(tvi_system *system, bool has_time_coordinate)
{
    const jet_tape *tape = system->field_values;
    const size_t n = (size_t)system->n, slots = (size_t)tape->slot_count;
    const bool has_lists =
        allocate_subsystem_lists(&system->subsystems, n) && allocate_subsystem_lists(&system->tail.subsystems, n);
    int *set_parent = calloc(slots, sizeof *set_parent);
    bool *depends_on_state = calloc(slots, sizeof *depends_on_state);
    int *counts = calloc(n, sizeof *counts);
    const bool has_memory = has_lists && set_parent && depends_on_state && counts;
    if (has_memory) {
        for (int i = 0; i < tape->slot_count; i++) set_parent[i] = i;
        for (int u = 0; u < system->input_count; u++) depends_on_state[u] = true;
        jet_tape_mark_dependents(tape, depends_on_state);
        unite_results_with_operands(tape, depends_on_state, set_parent);
        unite_components_with_outputs(system, depends_on_state, set_parent);
        list_components_of_sets(&system->subsystems, system->n, set_parent, -1, counts);
        list_components_of_sets(&system->tail.subsystems, system->n, set_parent,
                                has_time_coordinate ? system->n - 1 : -1, counts);
    }
    free(set_parent);
    free(depends_on_state);
    free(counts);
    return has_memory ? TVI_OK : TVI_ENOMEM;
}
