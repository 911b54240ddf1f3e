/* probe.c - the roundoff of a pass, measured. Where the force is that at a position of size 1, for instance, the
 * momenta of a small motion have no more digits than the force. */
#include "galerkin/passes.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/* A movement is roundoff if unknowns and values of the field that are displaced by so many units of theirs move as far.
 */
enum { UNITS = 16 };

static size_t numbers(const galerkin_field *field, int rows) { return (size_t)rows * (size_t)field->nodes.lanes; }

void tvi_galerkin_probe_take(galerkin_probe *probe, tvi_arena *arena, const galerkin_field *field)
{
    tvi_roundoff_take(&probe->of_field, arena, field->system);
    probe->before = tvi_arena_doubles(arena, numbers(field, field->rows));
    probe->displaced = tvi_arena_doubles(arena, numbers(field, field->rows));
    probe->base = tvi_arena_doubles(arena, numbers(field, field->nodes.unknowns));
    probe->impulse = tvi_arena_doubles(arena, numbers(field, field->nodes.unknowns));
}

/* Moves the unknowns, and what the passes bring them back to, by some units of the roundoff that a pass leaves in them,
 * up or down as the bits of a sequence have it. */
static void displace(galerkin_nodes *nodes)
{
    uint64_t bits = UINT64_C(0x9e3779b97f4a7c15);
    for (int u = 0; u < nodes->unknowns; u++)
        for (int k = u * nodes->lanes; k < (u + 1) * nodes->lanes && u % nodes->half < nodes->moving; k++) {
            const double size = UNITS * DBL_EPSILON * (fabs(nodes->start[u]) + fabs(nodes->x[k] - nodes->start[u]));
            bits = bits * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
            nodes->x[k] += bits >> 63 ? size : -size;
            nodes->base[k] += bits >> 63 ? size : -size;
        }
}

/* The square of the relative distance from x to the unknowns. */
static double distance(const galerkin_nodes *nodes, const double *x)
{
    double sum = 0;
    for (int u = 0; u < nodes->unknowns; u++)
        for (int k = u * nodes->lanes; k < (u + 1) * nodes->lanes; k++) {
            const double part = (nodes->x[k] - x[k]) * nodes->inverse_size[u];
            sum += part * part;
        }
    return sum;
}

/* A pass from displaced unknowns; then all is as it was. */
static tvi_status pass_displaced(galerkin_field *field, galerkin_probe *probe, double *moved, tvi_stats *stats)
{
    galerkin_nodes *nodes = &field->nodes;
    const size_t bytes = numbers(field, field->rows) * sizeof(double);
    const size_t base_bytes = numbers(field, nodes->unknowns) * sizeof(double);
    memcpy(probe->base, nodes->base, base_bytes);
    memcpy(probe->impulse, nodes->impulse, base_bytes);
    displace(nodes);
    field->noise = &probe->of_field;
    const tvi_status status = tvi_galerkin_pass(field, moved, stats);
    field->noise = NULL;
    memcpy(probe->displaced, nodes->x, bytes);
    memcpy(nodes->x, probe->before, bytes);
    memcpy(nodes->base, probe->base, base_bytes);
    memcpy(nodes->impulse, probe->impulse, base_bytes);
    return status;
}

/* The rounds of a pass may move the unknowns to and fro: what counts is how far they have moved from where they were to
 * where they are. */
tvi_status tvi_galerkin_measure(galerkin_field *field, galerkin_probe *probe, double *moved, double *roundoff,
                                tvi_stats *stats)
{
    const galerkin_nodes *nodes = &field->nodes;
    memcpy(probe->before, nodes->x, numbers(field, field->rows) * sizeof(double));
    stats->force_evaluations +=
        tvi_roundoff_of_field(&probe->of_field, field->system, field->inputs, nodes->lanes, field->points);
    for (int i = 0; i < tvi_system_outputs(field->system); i++) probe->of_field.change[i] *= UNITS;
    tvi_status status = pass_displaced(field, probe, moved, stats);
    if (status == TVI_OK) status = tvi_galerkin_pass(field, moved, stats);
    *roundoff = distance(nodes, probe->displaced);
    *moved = distance(nodes, probe->before);
    return status;
}

bool tvi_galerkin_is_near(const galerkin_field *field, const tvi_origin *origin)
{
    const galerkin_nodes *nodes = &field->nodes;
    return tvi_roundoff_is_near(field->system, field->h, origin->q, origin->p, nodes->x,
                                nodes->x + field->system->n * nodes->lanes, nodes->lanes, field->points);
}
