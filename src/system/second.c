/* second.c - see second.h. */
#include "system/second.h"

#include <stdlib.h>

/* A Hamiltonian has them for the passes of large steps (galerkin/hamiltonian.c) where the field with them is at most so
 * many times as long as without, as measured: where it is longer, more passes without them take as little time. They
 * are not looked for where so many components times nodes of the recording show that there are too many. */
enum { MOST_COST = 5, MOST_TO_DERIVE = 4096 };

/* Room for the field, one row more of second derivatives, and the gradient that has it. */
static bool grow(tvi_system *system, jet **jets)
{
    const size_t room = (size_t)system->seconds + 6 * (size_t)system->n;
    jet *more = realloc(*jets, room * sizeof *more);
    if (more) *jets = more;
    tvi_second *second = realloc(system->second, room * sizeof *second);
    if (second) system->second = second;
    return more && second;
}

/* Row of the lower triangle: what is not 0 everywhere of the gradient of the field's component. */
static tvi_status record_row(tvi_system *system, int row, jet **jets)
{
    const int rows = 2 * system->n;
    if (!grow(system, jets)) return TVI_ENOMEM;
    jet *gradient = *jets + 2 * rows + system->seconds;
    if (!jet_gradient(system->graph, system->field[row], rows, gradient)) return TVI_ENOMEM;
    (*jets)[row] = system->field[row];
    for (int column = 0; column <= row; column++) {
        const jet x = gradient[column];
        if (!x.node && x.number == 0) continue;
        (*jets)[rows + system->seconds] = x;
        system->second[system->seconds++] = (tvi_second){row, column};
    }
    return TVI_OK;
}

tvi_status tvi_second_record(tvi_system *system, jet **jets)
{
    const int rows = 2 * system->n;
    if (system->form == TVI_HAMILTONIAN && rows > MOST_TO_DERIVE / jet_graph_count(system->graph)) return TVI_OK;
    for (int row = 0; row < rows; row++) {
        const tvi_status status = record_row(system, row, jets);
        if (status != TVI_OK) return status;
    }
    return jet_graph_accept(system->graph, rows + system->seconds, *jets);
}

tvi_status tvi_second_lower(tvi_system *system, const jet jets[])
{
    const int rows = 2 * system->n;
    jet_tape *tape = jet_tape_create(system->graph, rows, rows + system->seconds, jets, JET_TAPE_VALUES);
    if (!tape) return TVI_ENOMEM;
    if (system->form == TVI_HAMILTONIAN && tape->slots > MOST_COST * system->field_values->slots) {
        jet_tape_free(tape);
        system->seconds = 0;
        return TVI_OK;
    }
    system->second_values = tape;
    return TVI_OK;
}
