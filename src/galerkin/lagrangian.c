/* lagrangian.c - Evaluates the field of a Lagrangian L(q, v, t): the rate of Q is V, with L_v(Q, V) = P, and the rate
 * of P is F = L_q(Q, V) (docs/method.md sections 4 and 5).
 *
 * A pass evaluates the gradient (L_q, L_v) at points (Q*, V*) near the nodes, and its derivatives, too, if the last
 * ones were computed too far away. Then it iterates, with F to first order from there,
 *
 *    P = p0 + h a F,    V = V* + L_vv^-1 ((P - L_v) - L_vq (Q - Q*)),    Q = q0 + h a V. */
#include "galerkin/lagrangian_passes.h"
#include "galerkin/model.h"
#include "system/legendre.h"

typedef struct {
    lagrangian_passes passes;
    galerkin_model model;
    tvi_legendre legendre;
    double *velocity; /* [n] at the start */
} lagrangian;

static void take_inverse(lanes_inverse *matrix, tvi_arena *arena, int n, int lanes)
{
    const size_t numbers = (size_t)n * (size_t)lanes;
    *matrix = (lanes_inverse){.n = n};
    matrix->lu = tvi_arena_doubles(arena, (size_t)n * numbers);
    matrix->inverse = tvi_arena_doubles(arena, (size_t)n * numbers);
    matrix->row_scale = tvi_arena_doubles(arena, numbers);
    matrix->column_scale = tvi_arena_doubles(arena, numbers);
    matrix->pivot = tvi_arena_allocate(arena, numbers * sizeof(int));
    matrix->x = tvi_arena_doubles(arena, numbers);
}

static void take(galerkin_field *field, tvi_arena *arena)
{
    const tvi_system *system = field->system;
    const int n = system->n, unknowns = 2 * n;
    const size_t lanes = (size_t)field->nodes.lanes, half_size = (size_t)n * lanes;
    lagrangian *taken = field->own = tvi_arena_allocate(arena, sizeof *taken);
    lagrangian w = {.passes = {.loops = field->loops}};
    field->rows = 3 * n;
    field->nodes.x = tvi_arena_doubles(arena, 5 * half_size);
    tvi_galerkin_model_take(&w.model, arena, field);
    field->inputs = w.model.blocks.values;
    field->ahead = tvi_arena_doubles(arena, lanes * lanes);
    double **const rows[] = {&w.passes.displacements, &w.passes.rise[0], &w.passes.rise[1]};
    for (size_t i = 0; i < 3; i++) *rows[i] = tvi_arena_doubles(arena, half_size);
    w.passes.gradient = tvi_arena_doubles(arena, 2 * half_size);
    w.velocity = tvi_arena_doubles(arena, (size_t)n);
    tvi_legendre_allocate(&w.legendre, arena, system);
    take_inverse(&w.passes.mass, arena, n, field->nodes.lanes);
    w.passes.rates = field->nodes;
    w.passes.rates.x = field->nodes.x ? lagrangian_row(&field->nodes, unknowns) : NULL;
    w.passes.rates.high = tvi_arena_doubles(arena, (size_t)unknowns * lanes);
    w.passes.rates.scale = tvi_arena_doubles(arena, (size_t)unknowns);
    if (taken) *taken = w;
}

static void prepare_passes(lagrangian_passes *w, const galerkin_field *field, const galerkin_model *model)
{
    const tvi_system *system = field->system;
    w->nodes = &field->nodes;
    w->matrix = field->matrix;
    w->slot = field->slot;
    w->blocks = model->blocks;
    w->output[false] = system->field_values->output;
    w->output[true] = system->hessian_values->output;
    w->model = model->lanes;
    w->model.gradient = w->gradient;
}

static void prepare(galerkin_field *field)
{
    lagrangian *w = field->own;
    tvi_galerkin_model_prepare(&w->model, field);
    tvi_legendre_prepare(&w->legendre);
    prepare_passes(&w->passes, field, &w->model);
    for (int u = 0; u < field->nodes.unknowns; u++) field->slot[u] = field->nodes.unknowns + u;
}

/* ---- The predictor ----------------------------------------------------------------------------------------------- */

static void fill(const galerkin_nodes *nodes, int n, int first, const double value[])
{
    for (int i = 0; i < n; i++)
        for (int lane = 0; lane < nodes->lanes; lane++) lagrangian_row(nodes, first + i)[lane] = value[i];
}

/* Sets V by the Legendre transform, from rest. */
static tvi_status start(galerkin_field *field, const tvi_origin *origin)
{
    lagrangian *w = field->own;
    const tvi_system *system = field->system;
    const galerkin_nodes *nodes = &field->nodes;
    const int n = system->n, lanes = nodes->lanes, *output = w->passes.output[false];
    double *velocity = w->velocity;
    memset(velocity, 0, (size_t)n * sizeof *velocity);
    const tvi_status status = tvi_legendre_solve(&w->legendre, origin->t, origin->q, origin->p, velocity);
    if (status != TVI_OK) return status;
    fill(nodes, n, 0, origin->q);
    fill(nodes, n, n, origin->p);
    fill(nodes, n, 2 * n, velocity);
    const double *gradient =
        galerkin_sweep_at(&w->passes.blocks, tvi_galerkin_sweep, false, nodes->x, lagrangian_row(nodes, 2 * n));
    if (!gradient) return TVI_EDOMAIN;
    for (int i = 0; i < 2 * n; i++)
        memcpy(lagrangian_row(nodes, 3 * n + i), gradient + output[i] * lanes, (size_t)lanes * sizeof *gradient);
    lagrangian_place(&w->passes);
    return TVI_OK;
}

static void predict(galerkin_field *field, const galerkin_extrapolation *by)
{
    lagrangian *w = field->own;
    lagrangian_predict(&w->passes, by);
}

/* ---- A pass ------------------------------------------------------------------------------------------------------ */

static tvi_status pass(galerkin_field *field, double *moved, tvi_stats *stats)
{
    static const tvi_status status[] = {[LAGRANGIAN_PASSED] = TVI_OK,
                                        [LAGRANGIAN_OUTSIDE] = TVI_EDOMAIN,
                                        [LAGRANGIAN_NO_NUMBER] = TVI_ENONFINITE,
                                        [LAGRANGIAN_SINGULAR] = TVI_ESINGULAR};
    lagrangian *w = field->own;
    const int factors = w->passes.factors;
    const lagrangian_passed passed = lagrangian_pass(&w->passes, tvi_galerkin_sweep);
    stats->factorisations += (w->passes.factors - factors) * field->points;
    *moved = w->passes.moved;
    return status[passed];
}

static void emit(jet_text *text, const galerkin_field *field)
{
    const lagrangian *w = field->own;
    const int unknowns = field->nodes.unknowns;
    tvi_galerkin_model_emit(text, &w->model);
    tvi_galerkin_emit_ints(text, "value_slot", unknowns, w->passes.output[false]);
    tvi_galerkin_emit_ints(text, "hessian_slot", unknowns, w->passes.output[true]);
    tvi_galerkin_emit_ints(text, "slot", unknowns, field->slot);
}

const galerkin_form tvi_galerkin_form_lagrangian = {
    1, &tvi_galerkin_quasi_newton, take, prepare, start, predict, pass, emit, tvi_embedded_galerkin_lagrangian};
