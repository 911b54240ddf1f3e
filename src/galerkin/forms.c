/* forms.c - Prepares the three forms of the equations of a Galerkin step (steps.h): memory, and lists of the rows that
 * have the rates and of the second derivatives that are not 0. galerkin.c calls it when a stepper is made. */
#include "galerkin/galerkin.h"

#include <string.h>

static galerkin_form form_of(const tvi_system *system)
{
    return !system->hessian.values          ? GALERKIN_PLAIN
           : system->form == TVI_LAGRANGIAN ? GALERKIN_LAGRANGIAN
                                            : GALERKIN_HAMILTONIAN;
}

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

/* The nodes whose unknowns are the rates, which begin with row `first` of nodes.x. */
static galerkin_nodes allocate_rates(galerkin_work *work, tvi_arena *arena, int first)
{
    galerkin_nodes rates = work->step.nodes;
    const size_t numbers = (size_t)rates.unknown_count * (size_t)rates.lane_count;
    rates.x = rates.x ? rates.x + first * rates.lane_count : NULL;
    rates.free_motion = rates.free_motion_low = tvi_arena_allocate_doubles(arena, numbers);
    rates.scale = work->rate_scale;
    return rates;
}

static lagrangian_pass *allocate_lagrangian(galerkin_work *work, tvi_arena *arena)
{
    const int n = work->n;
    const size_t half = (size_t)n * (size_t)work->step.nodes.lane_count;
    lagrangian_pass *taken = tvi_arena_allocate(arena, sizeof *taken);
    lagrangian_pass pass = {.L_vv.n = n};
    work->probe.row_count = 3 * n;
    work->step.nodes.x = tvi_arena_allocate_doubles(arena, 5 * half);
    tvi_arena_allocate_each(
        arena, half,
        (double **[]){&pass.q_moved, &pass.start_minus_q[0], &pass.start_minus_q[1], &pass.L_vv.scratch_column, NULL});
    pass.gradient = tvi_arena_allocate_doubles(arena, 2 * half);
    pass.displacement = tvi_arena_allocate_doubles(arena, 2 * half);
    pass.L_vv.matrix = tvi_arena_allocate_doubles(arena, (size_t)n * half);
    pass.L_vv.inverse = tvi_arena_allocate_doubles(arena, (size_t)n * half);
    pass.rates = allocate_rates(work, arena, 2 * n);
    work->start_velocity = tvi_arena_allocate_doubles(arena, (size_t)n);
    tvi_legendre_allocate(&work->legendre, arena, work->step.system);
    if (taken) *taken = pass;
    return taken;
}

static hamiltonian_pass *allocate_hamiltonian(galerkin_work *work, tvi_arena *arena)
{
    const size_t unknowns = (size_t)work->step.nodes.unknown_count, lanes = (size_t)work->step.nodes.lane_count,
                 width = SINGLE_LANES(lanes);
    hamiltonian_pass *taken = tvi_arena_allocate(arena, sizeof *taken);
    hamiltonian_pass pass = {.rows = 0};
    work->probe.row_count = work->step.nodes.unknown_count;
    work->step.nodes.x = tvi_arena_allocate_doubles(arena, 2 * unknowns * lanes);
    pass.rates = allocate_rates(work, arena, work->step.nodes.unknown_count);
    pass.nu = tvi_arena_allocate(arena, lanes * width * sizeof *pass.nu);
    pass.packed = tvi_arena_allocate(arena, unknowns * unknowns * width * sizeof *pass.packed);
    pass.size = tvi_arena_allocate_doubles(arena, unknowns);
    pass.inverse_size = tvi_arena_allocate_doubles(arena, unknowns);
    float **const vectors[] = {&pass.dx, &pass.dx_sum, &pass.dL, &pass.dL_sum};
    for (size_t i = 0; i < 4; i++) *vectors[i] = tvi_arena_allocate(arena, unknowns * width * sizeof(float));
    pass.added_impulse = tvi_arena_allocate_doubles(arena, unknowns * lanes);
    work->lists.unknown_of_row = tvi_arena_allocate(arena, unknowns * sizeof(int));
    work->lists.index_in_block = tvi_arena_allocate(arena, unknowns * unknowns * sizeof(int));
    if (taken) *taken = pass;
    return taken;
}

/* The blocks and lists of a field with second derivatives. */
static void allocate_hessian(galerkin_work *work, tvi_arena *arena)
{
    const tvi_system *system = work->step.system;
    galerkin_field_at_nodes *field = &work->step.field;
    const int lanes = work->step.nodes.lane_count;
    const size_t unknowns = (size_t)work->step.nodes.unknown_count;
    field->block[false] = tvi_arena_allocate_block(arena, system->field_values, 1, lanes, 0);
    field->block[true] = tvi_arena_allocate_block(arena, system->hessian.values, 1, lanes, (size_t)lanes);
    work->tape_block = field->block[false];
    work->predicted_by_impulse = tvi_arena_allocate_doubles(arena, (size_t)lanes * (size_t)lanes);
    work->lists.element_column = tvi_arena_allocate(arena, 2 * (size_t)system->hessian.entry_count * sizeof(int));
    work->lists.element_slot = tvi_arena_allocate(arena, 2 * (size_t)system->hessian.entry_count * sizeof(int));
    work->lists.row_end = tvi_arena_allocate(arena, 2 * (size_t)system->n * sizeof *work->lists.row_end);
    for (int i = 0; i < 2; i++) work->lists.slot[i] = tvi_arena_allocate(arena, unknowns * sizeof(int));
}

void tvi_galerkin_allocate_form(galerkin_work *work, tvi_arena *arena)
{
    galerkin_step *step = &work->step;
    const tvi_system *system = step->system;
    step->form = form_of(system);
    step->field = (galerkin_field_at_nodes){.n = system->n,
                                            .lane_count = step->nodes.lane_count,
                                            .input_count = system->hessian.values ? system->hessian.values->input_count
                                                                                  : system->field_values->input_count,
                                            .tape = {system->field_values, system->hessian.values}};
    if (step->form == GALERKIN_LAGRANGIAN) step->lagrangian = allocate_lagrangian(work, arena);
    else if (step->form == GALERKIN_HAMILTONIAN) step->hamiltonian = allocate_hamiltonian(work, arena);
    if (step->form != GALERKIN_PLAIN) {
        allocate_hessian(work, arena);
        return;
    }
    work->probe.row_count = step->nodes.unknown_count;
    step->nodes.x = tvi_arena_allocate_block(arena, system->field_values, 1, step->nodes.lane_count, 0);
    work->tape_block = step->field.block[false] = step->nodes.x;
}

/* ---- Lists ------------------------------------------------------------------------------------------------------- */

/* Lists the elements of each row of the symmetric Hessian. Columns of the second half, derivatives by V, come first: a
 * pass adds their products first, as velocities move before positions. */
static void list_hessian(const tvi_system *system, int *column, int *element_slot, int *row_end)
{
    const int rows = 2 * system->n;
    for (int k = 0; k < system->hessian.entry_count; k++) {
        row_end[system->hessian.entry[k].row]++;
        if (system->hessian.entry[k].row != system->hessian.entry[k].column) row_end[system->hessian.entry[k].column]++;
    }
    /* This loop sets row_end to the beginning of each row. The next loop advances it to the end. */
    for (int i = 0, before = 0; i < rows; i++) {
        const int count = row_end[i];
        row_end[i] = before;
        before += count;
    }
    for (int half = 1; half >= 0; half--)
        for (int k = 0; k < system->hessian.entry_count; k++) {
            const int i = system->hessian.entry[k].row, j = system->hessian.entry[k].column;
            const int slot = system->hessian.values->output_slot[rows + k];
            if (j / system->n == half) {
                column[row_end[i]] = j;
                element_slot[row_end[i]++] = slot;
            }
            if (i != j && i / system->n == half) {
                column[row_end[j]] = i;
                element_slot[row_end[j]++] = slot;
            }
        }
}

/* The component of the gradient (K_q, K_p) that is the rate of an unknown, up to its sign. */
static int rate_of(const galerkin_work *work, int unknown)
{
    return unknown < work->n ? unknown + work->n : unknown - work->n;
}

static int row_begin(const galerkin_work *work, int row) { return row > 0 ? work->lists.row_end[row - 1] : 0; }

static bool has_hessian_row(const galerkin_work *work, int row)
{
    return row_begin(work, row) < work->lists.row_end[row];
}

/* Returns whether an unknown takes part in the inner iterations: its rate depends on unknowns, so that it moves, and
 * some rate depends on it. A cyclic coordinate and its momentum take no part: no rate depends on the coordinate, and
 * the momentum is constant. */
static bool takes_part_in_inner_iterations(const galerkin_work *work, int unknown)
{
    return has_hessian_row(work, unknown) && has_hessian_row(work, rate_of(work, unknown));
}

/* Appends to unknown_of_row, which has `count` elements, the unknowns whose rates depend on unknowns, and that take
 * part in the inner iterations or not. Returns the new length. */
static int append_rows(galerkin_work *work, bool inner, int count)
{
    for (int u = 0; u < work->step.nodes.unknown_count; u++)
        if (has_hessian_row(work, rate_of(work, u)) && takes_part_in_inner_iterations(work, u) == inner)
            work->lists.unknown_of_row[count++] = u;
    return count;
}

/* Returns where the block has the second derivative (row, column), which may be its last row, of zeros. */
static int index_of_element(const galerkin_work *work, int row, int column)
{
    int slot = work->step.field.tape[true]->slot_count;
    for (int k = row_begin(work, row); k < work->lists.row_end[row]; k++)
        if (work->lists.element_column[k] == column) slot = work->lists.element_slot[k];
    return slot * work->step.nodes.lane_count;
}

static void set_hamiltonian(galerkin_work *work)
{
    hamiltonian_pass *pass = work->step.hamiltonian;
    const int lanes = work->step.nodes.lane_count;
    int *index = work->lists.index_in_block;
    for (int u = 0; u < work->step.nodes.unknown_count; u++)
        for (int i = 0; i < 2; i++) work->lists.slot[i][u] = work->step.field.tape[i]->output_slot[rate_of(work, u)];
    pass->columns = append_rows(work, true, 0);
    pass->rows = append_rows(work, false, pass->columns);
    pass->unknown_of_row = work->lists.unknown_of_row;
    pass->index_in_block = work->lists.index_in_block;
    for (int first = 0; first < pass->rows; first += ROWS_PER_GROUP)
        for (int column = 0; column < pass->columns; column++)
            for (int i = first; i < first + hamiltonian_group(pass, first); i++)
                *index++ = index_of_element(work, rate_of(work, pass->unknown_of_row[i]), pass->unknown_of_row[column]);
    for (int j = 0; j < lanes; j++)
        for (int i = 0; i < lanes; i++)
            pass->nu[j * SINGLE_LANES(lanes) + i] = (float)work->step.nodes.nu[j * lanes + i];
}

static void set_lagrangian(galerkin_work *work)
{
    lagrangian_pass *pass = work->step.lagrangian;
    for (int u = 0; u < work->step.nodes.unknown_count; u++)
        for (int i = 0; i < 2; i++) work->lists.slot[i][u] = work->step.field.tape[i]->output_slot[u];
    pass->column = work->lists.element_column;
    pass->slot = work->lists.element_slot;
    pass->row_end = work->lists.row_end;
    pass->invert_by_exchanges = tvi_galerkin_invert_by_exchanges;
    pass->by_exchanges = &pass->L_vv;
    pass->L_vv_factor = &work->legendre.jacobian_factor;
}

void tvi_galerkin_set_form(galerkin_work *work)
{
    galerkin_step *step = &work->step;
    const tvi_system *system = step->system;
    const int unknowns = step->nodes.unknown_count, lanes = step->nodes.lane_count;
    if (step->form == GALERKIN_PLAIN) {
        /* The outputs of the tape are F for a separable system, (H_q, H_p) otherwise. */
        for (int u = 0; u < unknowns; u++)
            work->lists.rate_row[u] = system->field_values->output_slot[step->is_separable ? u : rate_of(work, u)];
        work->predicted_by_impulse = work->coefficients.nu;
        return;
    }
    list_hessian(system, work->lists.element_column, work->lists.element_slot, work->lists.row_end);
    for (int u = 0; u < unknowns; u++) work->lists.rate_row[u] = unknowns + u;
    for (int i = 0; i < lanes; i++) {
        const int node = i < step->nodes.node_count ? i : step->nodes.node_count - 1;
        work->predicted_by_impulse[node * lanes + i] = 1 / work->coefficients.b[node];
    }
    for (int i = 0; i < 2; i++) step->field.slot[i] = work->lists.slot[i];
    if (step->form == GALERKIN_LAGRANGIAN) set_lagrangian(work);
    else set_hamiltonian(work);
    galerkin_nodes *rates = step->lagrangian ? &step->lagrangian->rates : &step->hamiltonian->rates;
    rates->nu = step->nodes.nu;
}

bool tvi_galerkin_invert_by_exchanges(const node_matrix *matrix, int lanes, void *lu_factor)
{
    return tvi_factor_invert_lanes(lu_factor, lanes, matrix->matrix, matrix->inverse, matrix->scratch_column) == TVI_OK;
}
