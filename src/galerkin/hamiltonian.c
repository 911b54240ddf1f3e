/* hamiltonian.c - the field of a Hamiltonian K = g h, with h = 0 on the solution, whose second derivatives cost little
 * beside it, as those of a rescaled system do (system/second.h), by Newton's method (docs/method.md section 5).
 *
 * A pass evaluates the gradient (K_q, K_p) at x = (Q, P), and its derivatives, too. A movement as any other pass makes
 * it is d_0; with the gradient to first order it would be followed by
 *
 *     d_{k+1} = h a J K'' d_k,    J (K_q, K_p) = (K_p, -K_q).
 *
 * Such a round costs a small part of an evaluation. The pass ends with a movement by the gradient at x + sum_k d_k. */
#include "galerkin/model.h"

#include <math.h>
#include <string.h>

/* The rows of nodes.x: Q, P, n each, and the gradient of a start behind them. */
typedef struct {
    galerkin_model model;
    lanes_rounds rounds;
    double *movement, *changes; /* [unknowns][lanes] the first one of a pass, and those of impulses */
    int *slot[2]; /* [unknowns] where what drives each is, in the block of values, and with second derivatives */
    double moved; /* by the last pass, as `move` says; infinite before the first one of a step */
} hamiltonian;

/* Squares of relative movements: after one of 2^-25 the second derivatives serve once more, since what the pass that
 * follows leaves is as its cube. */
static const double SERVES = 0x1p-50, NOTHING = 0x1p-144;
/* The rounds of the first pass of a step end here: another follows, whose movement is no less. */
static const double ROUNDOFF = 0x1p-108;

static int rounded_up(int rows) { return (rows + LANES_ROWS - 1) / LANES_ROWS * LANES_ROWS; }

static void take_rounds(lanes_rounds *rounds, tvi_arena *arena, size_t rows, size_t lanes)
{
    rounds->unknown = tvi_arena_take(arena, rows * sizeof *rounds->unknown);
    rounds->place = tvi_arena_take(arena, rows * rows * sizeof *rounds->place);
    rounds->packed = tvi_arena_take(arena, rows * rows * lanes * sizeof *rounds->packed);
    rounds->size = tvi_arena_doubles(arena, rows);
    rounds->per_size = tvi_arena_doubles(arena, rows);
    float **const vectors[] = {&rounds->change, &rounds->total, &rounds->impulse, &rounds->all};
    for (size_t i = 0; i < 4; i++) *vectors[i] = tvi_arena_take(arena, rows * lanes * sizeof(float));
}

static void take(galerkin_field *field, tvi_arena *arena)
{
    const size_t unknowns = (size_t)field->nodes.unknowns, lanes = (size_t)field->nodes.lanes;
    const size_t rows = (size_t)rounded_up(field->nodes.unknowns) + LANES_ROWS;
    hamiltonian *taken = field->own = tvi_arena_take(arena, sizeof *taken);
    hamiltonian w = {0};
    field->rows = field->nodes.unknowns;
    field->nodes.x = tvi_arena_doubles(arena, 2 * unknowns * lanes);
    tvi_galerkin_model_take(&w.model, arena, field);
    field->inputs = w.model.values;
    field->ahead = field->matrix;
    take_rounds(&w.rounds, arena, rows, lanes);
    w.movement = tvi_arena_doubles(arena, unknowns * lanes);
    w.changes = tvi_arena_doubles(arena, unknowns * lanes);
    for (int i = 0; i < 2; i++) w.slot[i] = tvi_arena_take(arena, unknowns * sizeof(int));
    if (taken) *taken = w;
}

/* The component of the gradient that drives an unknown. */
static int driving(const galerkin_field *field, int unknown)
{
    const int n = field->system->n;
    return unknown < n ? unknown + n : unknown - n;
}

static int begin_of(const galerkin_model *model, int row) { return row > 0 ? model->end[row - 1] : 0; }

static bool depends(const galerkin_model *model, int row) { return begin_of(model, row) < model->end[row]; }

/* Whether something depends on it that moves. A coordinate that H does not have (t of a rescaled system, if its forces
 * do not have it) is a quadrature, and its momentum does not move. */
static bool takes_part(const galerkin_field *field, const galerkin_model *model, int unknown)
{
    return depends(model, unknown) && depends(model, driving(field, unknown));
}

/* Where the second derivative stands in their block: zeros where it is none, or where there is no such row. */
static int place_of(const galerkin_field *field, const galerkin_model *model, int row, int column)
{
    const int begin = row < 0 ? 0 : begin_of(model, row), end = row < 0 ? 0 : model->end[row];
    int slot = field->system->second_values->slots;
    for (int k = begin; k < end; k++)
        if (model->term[k].column == column) slot = model->term[k].slot;
    return slot * field->nodes.lanes;
}

/* Adds those whose drives change and that take part, or not; then rows of none. The number of them all. */
static int add_rows(const galerkin_field *field, const galerkin_model *model, bool part, int rows, int *unknown)
{
    for (int u = 0; u < field->nodes.unknowns; u++)
        if (depends(model, driving(field, u)) && takes_part(field, model, u) == part) unknown[rows++] = u;
    const int end = rounded_up(rows);
    while (rows < end) unknown[rows++] = -1;
    return end;
}

static void set_rounds(const galerkin_field *field, const galerkin_model *model, lanes_rounds *rounds)
{
    for (int u = 0; u < field->nodes.unknowns; u++) rounds->count += takes_part(field, model, u);
    rounds->moving = add_rows(field, model, true, 0, rounds->unknown);
    rounds->rows = add_rows(field, model, false, rounds->moving, rounds->unknown);
    rounds->second = model->second;
    int *place = rounds->place;
    for (int first = 0; first < rounds->rows; first += LANES_ROWS)
        for (int column = 0; column < rounds->count; column++)
            for (int i = first; i < first + LANES_ROWS; i++) {
                const int row = rounds->unknown[i] < 0 ? -1 : driving(field, rounds->unknown[i]);
                *place++ = place_of(field, model, row, rounds->unknown[column]);
            }
}

static void prepare(galerkin_field *field)
{
    hamiltonian *w = field->own;
    tvi_galerkin_model_prepare(&w->model, field);
    set_rounds(field, &w->model, &w->rounds);
    for (int u = 0; u < field->nodes.unknowns; u++) {
        field->slot[u] = field->nodes.unknowns + driving(field, u);
        w->slot[false][u] = field->system->field_values->output[driving(field, u)];
        w->slot[true][u] = field->system->second_values->output[driving(field, u)];
    }
}

static tvi_status start(galerkin_field *field, const tvi_origin *origin)
{
    hamiltonian *w = field->own;
    const galerkin_nodes *nodes = &field->nodes;
    (void)origin;
    for (int u = 0; u < nodes->unknowns; u++)
        for (int i = 0; i < nodes->lanes; i++) nodes->x[u * nodes->lanes + i] = nodes->start[u];
    w->moved = INFINITY;
    double *gradient = nodes->x + nodes->unknowns * nodes->lanes;
    const double *momenta = nodes->x + field->system->n * nodes->lanes;
    return tvi_galerkin_model_evaluate(&w->model, field, false, nodes->x, momenta, gradient) ? TVI_OK : TVI_EDOMAIN;
}

static void predict(galerkin_field *field, int steps, const double *extrapolation, const double *const impulses[])
{
    hamiltonian *w = field->own;
    field->loops->predict(&field->nodes, steps, extrapolation, impulses);
    w->moved = INFINITY;
}

static tvi_status pass(galerkin_field *field, double *moved, tvi_stats *stats)
{
    hamiltonian *w = field->own;
    const galerkin_nodes *nodes = &field->nodes;
    const double count = nodes->unknowns * nodes->lanes, *momenta = nodes->x + field->system->n * nodes->lanes;
    const bool serves = w->moved <= SERVES * count;
    const int *slot = w->slot[!serves];
    (void)stats;
    const double *drives = tvi_galerkin_model_sweep(&w->model, field, !serves, nodes->x, momenta);
    if (!drives) return TVI_EDOMAIN;
    const double first = field->loops->move(nodes, field->matrix, drives, slot);
    const double left_out = first * (serves ? w->moved : first) / count;
    const double least = count * (isinf(w->moved) ? ROUNDOFF : NOTHING);
    for (int i = 0; i < nodes->unknowns * nodes->lanes; i++) w->movement[i] = nodes->x[i] - w->model.values[i];
    field->loops->go_round(nodes, field->matrix, &w->rounds, w->movement, !serves, first, fmax(left_out, least),
                           w->changes);
    *moved = w->moved = first + field->loops->move_both(nodes, field->matrix, drives, w->changes, slot);
    return TVI_OK;
}

const galerkin_form tvi_galerkin_form_hamiltonian = {-1, &tvi_galerkin_newton, take, prepare, start, predict, pass};
/* The part of a movement that h g'' would have made is left, too: no less of one movement than of the one before. */
const galerkin_form tvi_galerkin_form_product = {-1, &tvi_galerkin_quasi_newton, take, prepare, start, predict, pass};
