/* second.c - see second.h. */
#include "system/second.h"

#include <stdlib.h>

/* A product has them for the passes of large steps (galerkin/hamiltonian.c) where the field with them is at most
 * MOST_COST / 4 times as long as without, as measured: where it is longer, more passes without them take as little
 * time. They are not looked for where the recording, or it times the components, shows that there are too many. */
enum { MOST_COST = 13, MOST_OF_WHOLE = 4096, MOST_NODES = 800 };

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

/* Behind the second derivatives so far; NULL without memory. */
static jet *gradient_of(tvi_system *system, jet x, jet **jets)
{
    const int rows = 2 * system->n;
    if (!grow(system, jets)) return NULL;
    jet *gradient = *jets + 2 * rows + system->seconds;
    return jet_gradient(system->graph, x, rows, gradient) ? gradient : NULL;
}

/* What is not 0 everywhere. */
static void add(tvi_system *system, jet jets[], int row, int column, jet x)
{
    if (!x.node && x.number == 0) return;
    jets[2 * system->n + system->seconds] = x;
    system->second[system->seconds++] = (tvi_second){row, column};
}

tvi_status tvi_second_record(tvi_system *system, jet **jets)
{
    const int rows = 2 * system->n;
    system->seconds = 0;
    for (int row = 0; row < rows; row++) {
        const jet *of_row = gradient_of(system, system->field[row], jets);
        if (!of_row) return TVI_ENOMEM;
        (*jets)[row] = system->field[row];
        for (int column = 0; column <= row; column++) add(system, *jets, row, column, of_row[column]);
    }
    return jet_graph_accept(system->graph, rows + system->seconds, *jets);
}

/* The row of g h'' + g' h'^T + h' g'^T; and g h' + h g', which shares with it. */
static tvi_status record_row(tvi_system *system, int row, const jet factor[2], const jet of_g[], const jet of_h[],
                             jet **jets)
{
    const jet *of_row = gradient_of(system, of_h[row], jets);
    if (!of_row) return TVI_ENOMEM;
    (*jets)[row] = jet_add(jet_mul(factor[0], of_h[row]), jet_mul(factor[1], of_g[row]));
    for (int column = 0; column <= row; column++) {
        const jet both = jet_add(jet_mul(of_g[row], of_h[column]), jet_mul(of_h[row], of_g[column]));
        add(system, *jets, row, column, jet_add(jet_mul(factor[0], of_row[column]), both));
    }
    return TVI_OK;
}

static tvi_status record_where_h_is_0(tvi_system *system, const jet factor[2], jet **jets)
{
    const int rows = 2 * system->n;
    jet *of_g = malloc(2 * (size_t)rows * sizeof *of_g), *of_h = of_g + rows;
    if (!of_g) return TVI_ENOMEM;
    const bool derived =
        jet_gradient(system->graph, factor[0], rows, of_g) && jet_gradient(system->graph, factor[1], rows, of_h);
    tvi_status status = derived ? TVI_OK : TVI_ENOMEM;
    system->seconds = 0;
    for (int row = 0; row < rows && status == TVI_OK; row++) status = record_row(system, row, factor, of_g, of_h, jets);
    free(of_g);
    return status == TVI_OK ? jet_graph_accept(system->graph, rows + system->seconds, *jets) : status;
}

/* Leaves those recorded only where they are cheap. */
static tvi_status keep_cheap(tvi_system *system, const jet jets[])
{
    const int rows = 2 * system->n;
    jet_tape *field = jet_tape_create(system->graph, rows, rows, system->field, JET_TAPE_VALUES);
    jet_tape *with_second = jet_tape_create(system->graph, rows, rows + system->seconds, jets, JET_TAPE_VALUES);
    const bool created = field && with_second;
    if (!created || 4 * with_second->slots > MOST_COST * field->slots) system->seconds = 0;
    jet_tape_free(field);
    jet_tape_free(with_second);
    return created ? TVI_OK : TVI_ENOMEM;
}

tvi_status tvi_second_record_product(tvi_system *system, const jet factor[2], jet **jets)
{
    const int rows = 2 * system->n, nodes = jet_graph_count(system->graph);
    tvi_status status = jet_graph_accept(system->graph, rows, system->field);
    if (status != TVI_OK) return status;
    if (rows <= MOST_OF_WHOLE / nodes) {
        status = tvi_second_record(system, jets);
        if (status == TVI_OK) status = keep_cheap(system, *jets);
    }
    system->second_is_whole = system->seconds > 0;
    if (status != TVI_OK || system->second_is_whole || nodes > MOST_NODES) return status;
    status = record_where_h_is_0(system, factor, jets);
    return status == TVI_OK ? keep_cheap(system, *jets) : status;
}

tvi_status tvi_second_lower(tvi_system *system, const jet jets[])
{
    const int rows = 2 * system->n;
    if (system->seconds == 0) return TVI_OK;
    system->second_values = jet_tape_create(system->graph, rows, rows + system->seconds, jets, JET_TAPE_VALUES);
    return system->second_values ? TVI_OK : TVI_ENOMEM;
}
