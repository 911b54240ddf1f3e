/* generated_plain.h - Defines the generated step of a system whose passes evaluate the force alone, and no second
 * derivatives (field.c). */
#ifndef TVI_SRC_GALERKIN_GENERATED_PLAIN_H
#define TVI_SRC_GALERKIN_GENERATED_PLAIN_H

#include "galerkin/generated.h"

/* A tape whose operations stand alone runs at the nodes of one register after the other. Only the impulses are kept. */
enum { GALERKIN_WIDTH = GALERKIN_LANES % WIDEST == 0 ? WIDEST : 4 };

#define TAKE(V, blocks) BLOCK_AT(V, y, 0) = BLOCK_OF(V, x, 0);
JET_INLINE void galerkin_take_rows(double *y, const double *x)
{
    JET_UNROLL(256)
    for (int i = 0; i < GALERKIN_KEPT; i++, y += GALERKIN_WIDTH, x += GALERKIN_LANES) ALL_LANES(GALERKIN_WIDTH, TAKE)
}

#define GIVE(V, blocks)                                                                                                \
    BLOCK_AT(V, impulse, 0) = BLOCK_OF(V, weight, 0) * BLOCK_OF(V, y + galerkin_slot[u] * GALERKIN_WIDTH, 0);
JET_INLINE void galerkin_give_impulses(double *impulse, const double *weight, const double *y)
{
    JET_UNROLL(256)
    for (int u = 0; u < GALERKIN_UNKNOWNS; u++, impulse += GALERKIN_LANES) ALL_LANES(GALERKIN_WIDTH, GIVE)
}

/* Sets the impulses. Returns false outside the field's domain. */
JET_INLINE bool galerkin_sweep_nodes(const galerkin_nodes *nodes)
{
    bool is_inside = true;
    if (!tvi_values_is_split) {
        const galerkin_shape s = {GALERKIN_POINTS, GALERKIN_LANES, 1};
        is_inside = GALERKIN_VALUES(nodes->x);
        NAME(set_impulses)(nodes, nodes->x, galerkin_slot, s, 0);
    }
    for (int first = 0; tvi_values_is_split && first < GALERKIN_LANES; first += GALERKIN_WIDTH) {
        _Alignas(64) double y[tvi_values_slots * GALERKIN_WIDTH];
        galerkin_take_rows(y, nodes->x + first);
        is_inside &= VALUES_OF(tvi_values, y, GALERKIN_WIDTH);
        galerkin_give_impulses(nodes->impulse + first, nodes->weight + first, y);
    }
    return is_inside;
}

/* Makes a pass. The library measures the roundoff of passes that are stuck. */
JET_INLINE tvi_status galerkin_pass_plain(void *work, const galerkin_nodes *nodes, double *moved, double *roundoff)
{
    const galerkin_frame *frame = work;
    const galerkin_shape s = {GALERKIN_POINTS, GALERKIN_LANES, 1};
    if (roundoff) return TVI_ENOCONV;
    if (!galerkin_sweep_nodes(nodes)) return TVI_EDOMAIN;
    *moved = NAME(move_unknowns)(nodes, frame->matrix, NULL, s, 0);
    return TVI_OK;
}

JET_INLINE void galerkin_predict_plain(void *work, const galerkin_nodes *nodes, const galerkin_extrapolation *by)
{
    (void)work;
    NAME(predict)(nodes, by);
}

static void galerkin_steps(const galerkin_frame *given, const tvi_step_run *row, const tvi_origin *origin,
                           const tvi_run_state *now, galerkin_outcome *to)
{
    enum { IS_OWN = tvi_values_is_split && GALERKIN_KEPT * GALERKIN_LANES <= GALERKIN_MOST_OWN };
    _Alignas(64) double x[IS_OWN ? GALERKIN_KEPT * GALERKIN_LANES : 1];
    const galerkin_tail_inputs inputs = galerkin_sized_tail_inputs(given->tail_inputs);
    galerkin_frame frame = *given;
    galerkin_nodes nodes = galerkin_sized(given->nodes);
    frame.tail_inputs = &inputs;
    frame.rule = &galerkin_rule;
    if (IS_OWN) {
        nodes.x = x;
        galerkin_keep_rows(x, given->nodes->x, to->known > 0 ? GALERKIN_UNKNOWNS : 0, GALERKIN_KEPT);
    }
    const galerkin_solver solver = {galerkin_pass_plain, galerkin_predict_plain, NULL, &frame};
    galerkin_make_steps(&frame, &nodes, &solver, row, origin, now, to);
}

#endif
