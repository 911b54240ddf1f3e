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
    lanes_matrix all; /* of all unknowns, in order */
    double *changes;  /* [rows of all][lanes] of impulses */
    int *slot[2];     /* [unknowns] where what drives each is, in the block of values, and with second derivatives */
    double moved;     /* by the last pass, as `move` says; infinite before the first one of a step */
} hamiltonian;

enum { MOST_ROUNDS = 32 };
/* Squares of relative movements: after one of 2^-25 the second derivatives serve once more, since what the pass that
 * follows leaves is as its cube. */
static const double SERVES = 0x1p-50, NOTHING = 0x1p-144;

static size_t rounded_up(int rows) { return (size_t)(rows + LANES_ROWS - 1) / LANES_ROWS * LANES_ROWS; }

static void take_matrix(lanes_matrix *matrix, tvi_arena *arena, size_t rows)
{
    matrix->unknown = tvi_arena_take(arena, rows * sizeof *matrix->unknown);
    matrix->place = tvi_arena_take(arena, rows * rows * sizeof *matrix->place);
}

static void take(galerkin_field *field, tvi_arena *arena)
{
    const size_t unknowns = (size_t)field->nodes.unknowns, lanes = (size_t)field->nodes.lanes;
    const size_t rows = rounded_up(field->nodes.unknowns);
    hamiltonian *taken = field->own = tvi_arena_take(arena, sizeof *taken);
    hamiltonian w = {0};
    field->rows = field->nodes.unknowns;
    field->nodes.x = tvi_arena_doubles(arena, 2 * unknowns * lanes);
    tvi_galerkin_model_take(&w.model, arena, field);
    field->inputs = w.model.values;
    field->ahead = field->matrix;
    take_matrix(&w.all, arena, rows);
    take_matrix(&w.rounds.matrix, arena, rows);
    w.rounds.change = tvi_arena_doubles(arena, unknowns * lanes);
    w.rounds.moved = tvi_arena_doubles(arena, unknowns * lanes);
    w.rounds.impulse = tvi_arena_doubles(arena, rows * lanes);
    w.changes = tvi_arena_doubles(arena, rows * lanes);
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

/* Whether it moves, and something depends on it. A coordinate that H does not have (t of a rescaled system, if its
 * forces do not have it) is a quadrature, and its momentum does not move. */
static bool takes_part(const galerkin_field *field, const galerkin_model *model, int unknown)
{
    const int drive = driving(field, unknown);
    return begin_of(model, unknown) < model->end[unknown] && begin_of(model, drive) < model->end[drive];
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

/* Of all unknowns, or of those that take part. */
static void set_matrix(const galerkin_field *field, const galerkin_model *model, bool all, lanes_matrix *matrix)
{
    for (int u = 0; u < field->nodes.unknowns; u++)
        if (all || takes_part(field, model, u)) matrix->unknown[matrix->count++] = u;
    int *place = matrix->place;
    for (int first = 0; first < matrix->count; first += LANES_ROWS)
        for (int column = 0; column < matrix->count; column++)
            for (int i = first; i < first + LANES_ROWS; i++) {
                const int row = i < matrix->count ? driving(field, matrix->unknown[i]) : -1;
                *place++ = place_of(field, model, row, matrix->unknown[column]);
            }
    matrix->second = model->second;
}

static void prepare(galerkin_field *field)
{
    hamiltonian *w = field->own;
    tvi_galerkin_model_prepare(&w->model, field);
    set_matrix(field, &w->model, true, &w->all);
    set_matrix(field, &w->model, false, &w->rounds.matrix);
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

/* The rounds that follow a movement, whose square is `first`, until one is at most `last`. Where they do not shrink,
 * they are left out. */
static void go_round(const galerkin_field *field, const hamiltonian *w, double first, double last)
{
    const galerkin_nodes *nodes = &field->nodes;
    const lanes_rounds *rounds = &w->rounds;
    const size_t numbers = (size_t)nodes->unknowns * (size_t)nodes->lanes;
    double now = first, before = INFINITY, earlier = INFINITY;
    for (size_t i = 0; i < numbers; i++) rounds->change[i] = rounds->moved[i] = nodes->x[i] - w->model.values[i];
    for (int i = 0; i < MOST_ROUNDS && now > last && (now < before || now < earlier); i++) {
        earlier = before;
        before = now;
        now = field->loops->round(nodes, field->matrix, rounds);
    }
    if (now > first) memset(rounds->moved, 0, numbers * sizeof *rounds->moved);
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
    go_round(field, w, first, fmax(left_out, NOTHING * count));
    field->loops->drive(nodes, &w->all, w->rounds.moved, w->changes);
    *moved = w->moved = first + field->loops->move_both(nodes, field->matrix, drives, w->changes, slot);
    return TVI_OK;
}

const galerkin_form tvi_galerkin_form_hamiltonian = {-1, &tvi_galerkin_newton, take, prepare, start, predict, pass};
/* The part of a movement that h g'' would have made is left, too: no less of one movement than of the one before. */
const galerkin_form tvi_galerkin_form_product = {-1, &tvi_galerkin_quasi_newton, take, prepare, start, predict, pass};
