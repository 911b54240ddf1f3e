/* hamiltonian.c - the field of a Hamiltonian whose second derivatives cost little beside it, as those of a rescaled
 * system do (statement.c), by Newton's method (docs/method.md section 5).
 *
 * A pass evaluates the gradient (H_q, H_p) at x = (Q, P), and its derivatives, too. A movement as any other pass makes
 * it is d_0; with the gradient to first order it would be followed by
 *
 *     d_{k+1} = h a J H'' d_k,    J (H_q, H_p) = (H_p, -H_q).
 *
 * Such a round costs a small part of an evaluation. The pass ends with a movement by the gradient at x + sum_k d_k. */
#include "galerkin/model.h"

#include <math.h>
#include <string.h>

/* The rows of nodes.x: Q, P, n each, the gradient behind them, and how it changes behind that. */
typedef struct {
    galerkin_model model;
    lanes_rounds rounds;
    int *unknown, *end; /* of the rounds, */
    lanes_term *term;   /* and their terms */
    double moved;       /* by the last pass, as `move` says; infinite before the first one of a step */
} hamiltonian;

enum { MOST_ROUNDS = 32 };
/* Squares of relative movements: after one of 2^-25 the second derivatives serve once more, since what the pass that
 * follows leaves is as its cube. */
static const double SERVES = 0x1p-50, NOTHING = 0x1p-144;

static double *gradient_of(const galerkin_field *field)
{
    return field->nodes.x + field->nodes.unknowns * field->nodes.lanes;
}

static void take(galerkin_field *field, tvi_arena *arena)
{
    const size_t unknowns = (size_t)field->nodes.unknowns, numbers = unknowns * (size_t)field->nodes.lanes;
    hamiltonian *taken = field->own = tvi_arena_take(arena, sizeof *taken);
    hamiltonian w = {0};
    field->rows = field->nodes.unknowns;
    field->nodes.x = tvi_arena_doubles(arena, 3 * numbers);
    tvi_galerkin_model_take(&w.model, arena, field);
    field->inputs = w.model.values;
    field->ahead = field->matrix;
    w.unknown = tvi_arena_take(arena, unknowns * sizeof *w.unknown);
    w.end = tvi_arena_take(arena, unknowns * sizeof *w.end);
    w.term = tvi_arena_take(arena, 2 * (size_t)field->system->seconds * sizeof *w.term);
    w.rounds.change = tvi_arena_doubles(arena, numbers);
    w.rounds.impulse = tvi_arena_doubles(arena, numbers);
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

static void set_rounds(galerkin_field *field, hamiltonian *w)
{
    const galerkin_model *model = &w->model;
    int count = 0, terms = 0;
    for (int u = 0; u < field->nodes.unknowns; u++) {
        if (!takes_part(field, model, u)) continue;
        const int drive = driving(field, u);
        for (int k = begin_of(model, drive); k < model->end[drive]; k++)
            if (takes_part(field, model, model->term[k].column)) w->term[terms++] = model->term[k];
        w->unknown[count] = u;
        w->end[count++] = terms;
    }
    w->rounds.count = count;
    w->rounds.unknown = w->unknown;
    w->rounds.end = w->end;
    w->rounds.term = w->term;
    w->rounds.second = model->second;
    w->rounds.moved = model->lanes.moved;
}

static void prepare(galerkin_field *field)
{
    hamiltonian *w = field->own;
    tvi_galerkin_model_prepare(&w->model, field);
    set_rounds(field, w);
    for (int u = 0; u < field->nodes.unknowns; u++) field->slot[u] = field->nodes.unknowns + driving(field, u);
}

static bool evaluate(galerkin_field *field, bool with_second)
{
    hamiltonian *w = field->own;
    const galerkin_nodes *nodes = &field->nodes;
    const double *momenta = nodes->x + field->system->n * nodes->lanes;
    return tvi_galerkin_model_evaluate(&w->model, field, with_second, nodes->x, momenta, gradient_of(field));
}

static tvi_status start(galerkin_field *field, const tvi_origin *origin)
{
    hamiltonian *w = field->own;
    const galerkin_nodes *nodes = &field->nodes;
    (void)origin;
    for (int u = 0; u < nodes->unknowns; u++)
        for (int i = 0; i < nodes->lanes; i++) nodes->x[u * nodes->lanes + i] = nodes->start[u];
    w->moved = INFINITY;
    return evaluate(field, false) ? TVI_OK : TVI_EDOMAIN;
}

static void predict(galerkin_field *field, int steps, const double *extrapolation, const double *const impulses[])
{
    hamiltonian *w = field->own;
    field->loops->predict(&field->nodes, steps, extrapolation, impulses);
    w->moved = INFINITY;
}

static double move(const galerkin_field *field)
{
    return field->loops->move(&field->nodes, field->matrix, field->nodes.x, field->slot);
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

/* By the gradient where the rounds have led to. */
static double finish(const galerkin_field *field, hamiltonian *w)
{
    const galerkin_nodes *nodes = &field->nodes;
    const double *changes = nodes->x + nodes->unknowns * nodes->lanes;
    w->model.lanes.gradient = NULL;
    field->lagrangian->linearise(&w->model.lanes, gradient_of(field) + nodes->unknowns * nodes->lanes);
    return field->loops->move_both(nodes, field->matrix, nodes->x, changes, field->slot);
}

static tvi_status pass(galerkin_field *field, double *moved, tvi_stats *stats)
{
    hamiltonian *w = field->own;
    const double count = field->nodes.unknowns * field->nodes.lanes;
    const bool serves = w->moved <= SERVES * count;
    (void)stats;
    if (!evaluate(field, !serves)) return TVI_EDOMAIN;
    const double first = move(field), left_out = first * (serves ? w->moved : first) / count;
    go_round(field, w, first, fmax(left_out, NOTHING * count));
    *moved = w->moved = first + finish(field, w);
    return TVI_OK;
}

const galerkin_form tvi_galerkin_form_hamiltonian = {-1, &tvi_galerkin_newton, take, prepare, start, predict, pass};
