/* system.c - the end of a system, and what users ask of one. statement.c makes them. */
#include "system/system.h"

#include <stdlib.h>

void tvi_system_free(tvi_system *system)
{
    if (!system) return;
    if (system->stepped != system) tvi_system_free(system->stepped);
    jet_tape_free(system->field_series);
    jet_tape_free(system->field_values);
    jet_tape_free(system->bend_values);
    jet_tape_free(system->second_values);
    free(system->second);
    jet_tape_free(system->energy);
    jet_graph_free(system->graph);
    free(system->field);
    free(system->mass);
    free(system);
}

int tvi_system_dimension(const tvi_system *system) { return system ? system->n : 0; }
