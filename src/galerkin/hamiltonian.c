/* hamiltonian.c - Evaluates the field of a Hamiltonian K = g h, with h = 0 on the solution, whose second derivatives
 * cost little beside it, as those of a rescaled system do (system/hessian.h). It uses Newton's method (docs/method.md
 * section 5).
 *
 * A pass evaluates the gradient (K_q, K_p) at x = (Q, P), and its derivatives, too. The movement of an ordinary pass is
 * d_0. With the gradient to first order it would be followed by
 *
 *    d_{k+1} = h a J K'' d_k,    J (K_q, K_p) = (K_p, -K_q).
 *
 * Such a round costs a small part of an evaluation. The pass ends with a movement by the gradient at x + sum_k d_k. */
#include "galerkin/hamiltonian_passes.h"
#include "galerkin/model.h"

typedef struct {
    hamiltonian_passes passes;
    galerkin_model model;
    int *slot[2], *unknown, *index; /* as those of the passes */
} hamiltonian;

static void take_rounds(lanes_rounds *rounds, tvi_arena *arena, size_t rows, size_t lanes)
{
    rounds->matrix = tvi_arena_allocate(arena, lanes * lanes * sizeof *rounds->matrix);
    rounds->packed = tvi_arena_allocate(arena, rows * rows * lanes * sizeof *rounds->packed);
    rounds->size = tvi_arena_doubles(arena, rows);
    rounds->per_size = tvi_arena_doubles(arena, rows);
    float **const vectors[] = {&rounds->change, &rounds->total, &rounds->impulse, &rounds->all};
    for (size_t i = 0; i < 4; i++) *vectors[i] = tvi_arena_allocate(arena, rows * lanes * sizeof(float));
}

static void take(galerkin_field *field, tvi_arena *arena)
{
    const size_t unknowns = (size_t)field->nodes.unknowns, lanes = (size_t)field->nodes.lanes;
    hamiltonian *taken = field->own = tvi_arena_allocate(arena, sizeof *taken);
    hamiltonian w = {.passes = {.loops = field->loops}};
    field->rows = field->nodes.unknowns;
    field->nodes.x = tvi_arena_doubles(arena, 2 * unknowns * lanes);
    tvi_galerkin_model_take(&w.model, arena, field);
    field->inputs = w.model.blocks.values;
    field->ahead = tvi_arena_doubles(arena, lanes * lanes);
    w.passes.rates = field->nodes;
    w.passes.rates.x = field->nodes.x ? field->nodes.x + unknowns * lanes : NULL;
    w.passes.rates.high = w.passes.rates.base = tvi_arena_doubles(arena, unknowns * lanes);
    w.passes.rates.scale = tvi_arena_doubles(arena, unknowns);
    w.passes.rounds.unknown = w.unknown = tvi_arena_allocate(arena, unknowns * sizeof(int));
    w.passes.rounds.index = w.index = tvi_arena_allocate(arena, unknowns * unknowns * sizeof(int));
    take_rounds(&w.passes.rounds, arena, unknowns, lanes);
    w.passes.changes = tvi_arena_doubles(arena, unknowns * lanes);
    for (int i = 0; i < 2; i++) w.passes.slot[i] = w.slot[i] = tvi_arena_allocate(arena, unknowns * sizeof(int));
    if (taken) *taken = w;
}

/* The component of the gradient that is the rate of an unknown, up to the sign. */
static int rate_component(const galerkin_field *field, int unknown)
{
    const int n = field->system->n;
    return unknown < n ? unknown + n : unknown - n;
}

static int begin_of(const galerkin_model *model, int row) { return row > 0 ? model->end[row - 1] : 0; }

static bool depends(const galerkin_model *model, int row) { return begin_of(model, row) < model->end[row]; }

/* Tells whether a moving rate depends on the unknown. A coordinate that H does not depend on (t of a rescaled system,
 * if its forces do not depend on it) is a quadrature, and its momentum does not move. */
static bool takes_part(const galerkin_field *field, const galerkin_model *model, int unknown)
{
    return depends(model, unknown) && depends(model, rate_component(field, unknown));
}

/* The index of the second derivative in its block: zeros if there is none. */
static int index_of(const galerkin_field *field, const galerkin_model *model, int row, int column)
{
    int slot = field->system->hessian_values->slots;
    for (int k = begin_of(model, row); k < model->end[row]; k++)
        if (model->term[k].column == column) slot = model->term[k].slot;
    return slot * field->nodes.lanes;
}

/* Adds the unknowns whose rates change, with or without those that take part. Returns the number of all. */
static int add_rows(const galerkin_field *field, const galerkin_model *model, bool part, int rows, int *unknown)
{
    for (int u = 0; u < field->nodes.unknowns; u++)
        if (depends(model, rate_component(field, u)) && takes_part(field, model, u) == part) unknown[rows++] = u;
    return rows;
}

/* Adds the indices for the groups of rows from `first` to `end`. Returns the end of the list. */
static int *append_indices(const galerkin_field *field, const galerkin_model *model, const lanes_rounds *rounds,
                           int first, int end, int *index)
{
    for (int group; first < end; first += group) {
        group = lanes_group(end - first);
        for (int column = 0; column < rounds->count; column++)
            for (int i = first; i < first + group; i++)
                *index++ = index_of(field, model, rate_component(field, rounds->unknown[i]), rounds->unknown[column]);
    }
    return index;
}

static void set_rounds(const galerkin_field *field, const hamiltonian *w, lanes_rounds *rounds)
{
    const galerkin_model *model = &w->model;
    for (int u = 0; u < field->nodes.unknowns; u++) rounds->count += takes_part(field, model, u);
    rounds->moving = add_rows(field, model, true, 0, w->unknown);
    rounds->rows = add_rows(field, model, false, rounds->moving, w->unknown);
    rounds->hessian = model->blocks.hessian;
    for (int i = 0; i < field->nodes.lanes * field->nodes.lanes; i++) rounds->matrix[i] = (float)field->matrix[i];
    int *index = append_indices(field, model, rounds, 0, rounds->moving, w->index);
    (void)append_indices(field, model, rounds, rounds->moving, rounds->rows, index);
}

static void prepare(galerkin_field *field)
{
    hamiltonian *w = field->own;
    hamiltonian_passes *passes = &w->passes;
    tvi_galerkin_model_prepare(&w->model, field);
    set_rounds(field, w, &passes->rounds);
    for (int u = 0; u < field->nodes.unknowns; u++) {
        field->slot[u] = field->nodes.unknowns + u;
        w->slot[false][u] = field->system->field_values->output[rate_component(field, u)];
        w->slot[true][u] = field->system->hessian_values->output[rate_component(field, u)];
    }
    passes->nodes = &field->nodes;
    passes->matrix = field->matrix;
    passes->rate_row = field->slot;
    passes->blocks = w->model.blocks;
}

static tvi_status start(galerkin_field *field, const tvi_origin *origin)
{
    hamiltonian *w = field->own;
    const galerkin_nodes *nodes = &field->nodes;
    const int lanes = nodes->lanes, *slot = w->slot[false];
    (void)origin;
    for (int u = 0; u < nodes->unknowns; u++)
        for (int i = 0; i < lanes; i++) nodes->x[u * lanes + i] = nodes->start[u];
    w->passes.moved = INFINITY;
    const double *momenta = nodes->x + field->system->n * lanes;
    const double *rates = galerkin_sweep_at(&w->passes.blocks, tvi_galerkin_sweep, false, nodes->x, momenta);
    if (!rates) return TVI_EDOMAIN;
    for (int u = 0; u < nodes->unknowns; u++)
        memcpy(nodes->x + field->slot[u] * lanes, rates + slot[u] * lanes, (size_t)lanes * sizeof *rates);
    (void)galerkin_move(field);
    return TVI_OK;
}

static void predict(galerkin_field *field, const galerkin_extrapolation *by)
{
    hamiltonian *w = field->own;
    hamiltonian_predict(&w->passes, by);
}

static tvi_status pass(galerkin_field *field, double *moved, tvi_stats *stats)
{
    hamiltonian *w = field->own;
    (void)stats;
    if (!hamiltonian_pass(&w->passes, tvi_galerkin_sweep)) return TVI_EDOMAIN;
    *moved = w->passes.moved;
    return TVI_OK;
}

static void emit(jet_text *text, const galerkin_field *field)
{
    const hamiltonian *w = field->own;
    const lanes_rounds *rounds = &w->passes.rounds;
    const int unknowns = field->nodes.unknowns;
    tvi_galerkin_model_emit(text, &w->model);
    jet_text_append(text, "enum { GALERKIN_COLUMNS = %d, GALERKIN_ROUND = %d, GALERKIN_ROWS = %d };\n", rounds->count,
                    rounds->moving, rounds->rows);
    tvi_galerkin_emit_ints(text, "value_slot", unknowns, w->slot[false]);
    tvi_galerkin_emit_ints(text, "hessian_slot", unknowns, w->slot[true]);
    tvi_galerkin_emit_ints(text, "unknown", rounds->rows, rounds->unknown);
    tvi_galerkin_emit_ints(text, "index_of", rounds->rows * rounds->count, rounds->index);
    tvi_galerkin_emit_ints(text, "slot", unknowns, field->slot);
}

const galerkin_form tvi_galerkin_form_hamiltonian = {
    -1, &tvi_galerkin_newton, take, prepare, start, predict, pass, emit, tvi_embedded_galerkin_hamiltonian};
/* A pass leaves the part of a movement that h g'' would have made. This part does not shrink from one movement to the
 * next. */
const galerkin_form tvi_galerkin_form_product = {
    -1, &tvi_galerkin_quasi_newton, take, prepare, start, predict, pass, emit, tvi_embedded_galerkin_hamiltonian};
