/* system.c - Frees systems, returns how many coordinates and parameters they have, and sets the parameters in the
 * blocks of their tapes. statement.c creates systems. */
#include "system/system.h"
#include "system/adjoint.h"
#include "system/constraint.h"

#include <stdlib.h>

void tvi_system_free(tvi_system *system)
{
    if (!system) return;
    if (system->stepped_system != system) tvi_system_free(system->stepped_system);
    jet_tape_free(system->field_series);
    jet_tape_free(system->field_values);
    jet_tape_free(system->r_dot_Hp_values);
    jet_tape_free(system->hessian.values);
    free(system->hessian.entry);
    jet_tape_free(system->energy.tape);
    jet_graph_free(system->record.graph);
    tvi_adjoint_free(system->record.adjoint);
    tvi_constraints_free(system->constraints);
    free(system->record.field);
    free(system->mass);
    free(system->subsystems.component_list);
    free(system->subsystems.end_in_component_list);
    free(system->tail.subsystems.component_list);
    free(system->tail.subsystems.end_in_component_list);
    free(system);
}

int tvi_system_parameters(const tvi_system *system)
{
    if (!system) return 0;
    const jet_graph *const graphs[] = {system->record.graph, system->stepped_system->record.graph,
                                       system->constraints ? system->constraints->graph : NULL};
    int most = 0;
    for (int i = 0; i < 3; i++) {
        const int count = graphs[i] ? jet_graph_parameter_count(graphs[i]) : 0;
        if (count > most) most = count;
    }
    return most;
}

void tvi_system_prepare_blocks(const tvi_system *system, const tvi_tape_block *blocks, const double parameters[])
{
    tvi_blocks_set_constants(blocks);
    if (parameters) tvi_blocks_set_parameters(blocks, tvi_system_parameters(system), parameters);
}

/* Reads the values of the parameters in one recording. */
static void read_parameters(const jet_graph *graph, double value[])
{
    for (int i = 0; i < jet_graph_node_count(graph); i++) {
        const struct jet_node *node = jet_graph_node_at(graph, i);
        if (node->op == OP_PARAMETER) value[node->parameter_index] = node->number;
    }
}

void tvi_system_recorded_parameters(const tvi_system *system, double value[])
{
    read_parameters(system->record.graph, value);
    read_parameters(system->stepped_system->record.graph, value);
    if (system->constraints) read_parameters(system->constraints->graph, value);
}

int tvi_system_dimension(const tvi_system *system) { return system ? system->n : 0; }
