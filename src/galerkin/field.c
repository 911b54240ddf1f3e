/* field.c - Evaluates the field of a separable system and of a Hamiltonian: F, or (H_p, -H_q), whose sign is in the
 * nodes' scale. The unknowns are the inputs of the tape. */
#include "galerkin/field.h"

static void take(galerkin_field *field, tvi_arena *arena)
{
    field->rows = field->nodes.unknowns;
    field->nodes.x = tvi_arena_allocate_block(arena, field->system->field_values, 1, field->nodes.lanes, 0);
    field->inputs = field->nodes.x;
    field->ahead = field->matrix;
}

/* The output slot with the rate of an unknown: F; or H_p, then H_q. */
static int rate_slot(const tvi_system *system, int unknown)
{
    const int n = system->n, output = system->form == TVI_SEPARABLE ? unknown : unknown < n ? unknown + n : unknown - n;
    return system->field_values->output[output];
}

static void prepare(galerkin_field *field)
{
    for (int u = 0; u < field->nodes.unknowns; u++) field->slot[u] = rate_slot(field->system, u);
}

void tvi_galerkin_displace(const galerkin_field *field, const jet_tape *tape, double *x)
{
    const int lanes = field->nodes.lanes;
    for (int i = 0; i < tvi_system_output_count(field->system); i++)
        for (int lane = 0; lane < lanes; lane++)
            x[tape->output[i] * lanes + lane] += tvi_roundoff_random_sign(field->noise, field->noise->change[i]);
}

static tvi_status start(galerkin_field *field, const tvi_origin *origin)
{
    const galerkin_nodes *nodes = &field->nodes;
    (void)origin;
    for (int u = 0; u < nodes->unknowns; u++)
        for (int i = 0; i < nodes->lanes; i++) nodes->x[u * nodes->lanes + i] = nodes->start[u];
    const tvi_status status = galerkin_evaluate(field);
    if (status == TVI_OK) (void)galerkin_move(field);
    return status;
}

static void predict(galerkin_field *field, const galerkin_extrapolation *by)
{
    field->loops->predict(&field->nodes, by);
}

static void emit(jet_text *text, const galerkin_field *field)
{
    tvi_galerkin_emit_ints(text, "slot", field->nodes.unknowns, field->slot);
}

const galerkin_form tvi_galerkin_form_plain = {-1,   &tvi_galerkin_fixed_point,  take, prepare, start, predict, NULL,
                                               emit, tvi_embedded_galerkin_plain};
