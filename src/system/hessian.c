/* hessian.c - Records the second derivatives of a Lagrangian or of a Hamiltonian, if they are cheap to evaluate
 * (system.h). The Hamiltonian is that of a system whose time is rescaled by a function g: K = g (H + e), with a
 * constant e (rescaled.c). statement.c calls it. */
#include "system/system.h"

#include <stdlib.h>

/* [quarters] The second derivatives of K = g f, with f = H + e, save passes of large steps. They are used if the field
 * with them depends on at most HESSIAN_MAX_COST / 4 times as many nodes of the graph as the field alone. If they cost
 * more, the additional passes without them take as little time. */
#define HESSIAN_MAX_COST 14 /* found: make stability */
/* [numbers] The whole matrix K'' is recorded if the nodes of the graph times the rows of K'' are at most this many. */
#define HESSIAN_WHOLE_MAX_NUMBERS 4096 /* found: make performance ONE=compiling */
/* [nodes] If the whole K'' is too costly, the simpler K'' at f = 0 is recorded for graphs of up to this many nodes. */
#define HESSIAN_SHORT_MAX_NODES 800 /* found: make performance ONE=compiling */

/* Makes room for one more row of second derivatives: in *jets, which contains the field, all second derivatives so far
 * and then a gradient of which the new row is taken, and in system->hessian, which has the place of each of them. */
static bool grow_hessian_arrays(tvi_system *system, jet **jets)
{
    const size_t room = (size_t)system->hessian.entry_count + 6 * (size_t)system->n;
    jet *more = realloc(*jets, room * sizeof *more);
    if (more) *jets = more;
    tvi_hessian_entry *hessian = realloc(system->hessian.entry, room * sizeof *hessian);
    if (hessian) system->hessian.entry = hessian;
    return more && hessian;
}

/* Records the gradient of x in *jets, after the room for one more row of second derivatives. Returns the gradient, or
 * NULL if memory is lacking. */
static jet *append_gradient(tvi_system *system, jet x, jet **jets)
{
    const int rows = 2 * system->n;
    if (!grow_hessian_arrays(system, jets)) return NULL;
    jet *gradient = *jets + 2 * rows + system->hessian.entry_count;
    return jet_record_gradient(system->record.graph, x, rows, gradient) ? gradient : NULL;
}

/* Appends the second derivative x to jets, and its row and column to system->hessian, unless it is 0 everywhere. */
static void append_hessian_entry(tvi_system *system, jet jets[], int row, int column, jet x)
{
    if (jet_is_zero(x)) return;
    jets[2 * system->n + system->hessian.entry_count] = x;
    system->hessian.entry[system->hessian.entry_count++] = (tvi_hessian_entry){row, column};
}

tvi_status tvi_hessian_record(tvi_system *system, jet **jets)
{
    const int rows = 2 * system->n;
    system->hessian.entry_count = 0;
    for (int row = 0; row < rows; row++) {
        const jet *hessian_row = append_gradient(system, system->record.field[row], jets);
        if (!hessian_row) return TVI_ENOMEM;
        (*jets)[row] = system->record.field[row];
        for (int column = 0; column <= row; column++)
            append_hessian_entry(system, *jets, row, column, hessian_row[column]);
    }
    return jet_graph_check_outputs(system->record.graph, rows + system->hessian.entry_count, *jets);
}

/* Records a row of g f'' + g' f'^T + f' g'^T, which is the row of K'' at f = 0, since the term f g'' vanishes there,
 * and the component g f' + f g' of the field in the same row, which must hold also near f = 0. The row and the
 * component are recorded one after the other, since they share operations. */
static tvi_status record_second_derivatives_row(tvi_system *system, int row, const jet factor[2],
                                                const jet gradient_g[], const jet gradient_f[], jet **jets)
{
    const jet *hessian_row = append_gradient(system, gradient_f[row], jets);
    if (!hessian_row) return TVI_ENOMEM;
    (*jets)[row] = jet_add(jet_mul(factor[0], gradient_f[row]), jet_mul(factor[1], gradient_g[row]));
    for (int column = 0; column <= row; column++) {
        const jet both =
            jet_add(jet_mul(gradient_g[row], gradient_f[column]), jet_mul(gradient_f[row], gradient_g[column]));
        append_hessian_entry(system, *jets, row, column, jet_add(jet_mul(factor[0], hessian_row[column]), both));
    }
    return TVI_OK;
}

/* Records all rows of g f'' + g' f'^T + f' g'^T, with (g, f) = factor: at states with f = 0 this is the matrix K'' of
 * second derivatives of the product K = g f. The recorded rows follow the components of the field in *jets. */
static tvi_status record_product_hessian(tvi_system *system, const jet factor[2], jet **jets)
{
    const int rows = 2 * system->n;
    jet *gradient_g = malloc(2 * (size_t)rows * sizeof *gradient_g), *gradient_f = gradient_g + rows;
    if (!gradient_g) return TVI_ENOMEM;
    const bool derived = jet_record_gradient(system->record.graph, factor[0], rows, gradient_g) &&
                         jet_record_gradient(system->record.graph, factor[1], rows, gradient_f);
    tvi_status status = derived ? TVI_OK : TVI_ENOMEM;
    system->hessian.entry_count = 0;
    for (int row = 0; row < rows && status == TVI_OK; row++)
        status = record_second_derivatives_row(system, row, factor, gradient_g, gradient_f, jets);
    free(gradient_g);
    return status == TVI_OK ? jet_graph_check_outputs(system->record.graph, rows + system->hessian.entry_count, *jets)
                            : status;
}

/* Drops the second derivatives if they and the field depend on more than HESSIAN_MAX_COST / 4 times as many nodes of
 * the graph as the field alone. Slots of tapes are not counted, since their number depends on devices for speed. */
static tvi_status drop_hessian_if_expensive(tvi_system *system, const jet jets[])
{
    const int rows = 2 * system->n;
    jet_tape *field = jet_tape_create(system->record.graph, rows, rows, system->record.field, JET_TAPE_VALUES);
    jet_tape *with_hessian =
        jet_tape_create(system->record.graph, rows, rows + system->hessian.entry_count, jets, JET_TAPE_VALUES);
    const bool created = field && with_hessian;
    if (!created || 4 * with_hessian->used_node_count > HESSIAN_MAX_COST * field->used_node_count)
        system->hessian.entry_count = 0;
    jet_tape_free(field);
    jet_tape_free(with_hessian);
    return created ? TVI_OK : TVI_ENOMEM;
}

tvi_status tvi_record_hessian_of_factored_H(tvi_system *system, const jet hamiltonian_factor[2],
                                            jet **field_and_hessian)
{
    const int rows = 2 * system->n, nodes = jet_graph_node_count(system->record.graph);
    tvi_status status = jet_graph_check_outputs(system->record.graph, rows, system->record.field);
    if (status != TVI_OK) return status;
    if (rows <= HESSIAN_WHOLE_MAX_NUMBERS / nodes) {
        status = tvi_hessian_record(system, field_and_hessian);
        if (status == TVI_OK) status = drop_hessian_if_expensive(system, *field_and_hessian);
    }
    system->hessian.is_complete = system->hessian.entry_count > 0;
    if (status != TVI_OK || system->hessian.is_complete || nodes > HESSIAN_SHORT_MAX_NODES) return status;
    status = record_product_hessian(system, hamiltonian_factor, field_and_hessian);
    return status == TVI_OK ? drop_hessian_if_expensive(system, *field_and_hessian) : status;
}

tvi_status tvi_hessian_create_tape(tvi_system *system, const jet jets[])
{
    const int rows = 2 * system->n;
    if (system->hessian.entry_count == 0) return TVI_OK;
    system->hessian.values =
        jet_tape_create(system->record.graph, rows, rows + system->hessian.entry_count, jets, JET_TAPE_VALUES);
    return system->hessian.values ? TVI_OK : TVI_ENOMEM;
}
