/* emitted_forms.h - the function that makes whole steps of generated code (emit.c), which alone reads this, after the
 * text of emitted_loops.h, by the form of the field. */
#ifndef TVI_SRC_GALERKIN_EMITTED_FORMS_H
#define TVI_SRC_GALERKIN_EMITTED_FORMS_H

#include "galerkin/emitted_steps.h"

/* gcc leaves less of a long field in memory where it orders instructions by the registers that they take. */
#if defined(__GNUC__) && !defined(__clang__)
#define STEADY_ORDER __attribute__((optimize("schedule-insns", "sched-pressure")))
#else
#define STEADY_ORDER
#endif

/* Of `kept` rows at so many lanes, and back into impulses. */
#define TAKE(V, blocks) BLOCK_AT(V, y, 0) = BLOCK_OF(V, x, 0);
JET_INLINE void take_rows(double *y, const double *x, int kept, int width, int lanes)
{
    _Pragma("GCC unroll 256") for (int i = 0; i < kept; i++, y += width, x += lanes) ALL_LANES(width, TAKE)
}

#define GIVE(V, blocks)                                                                                                \
    {                                                                                                                  \
        if (weighs) BLOCK_AT(V, impulse, 0) = BLOCK_OF(V, weight, 0) * BLOCK_OF(V, y + slot[u] * width, 0);            \
        else BLOCK_AT(V, impulse, 0) = BLOCK_OF(V, y + slot[u] * width, 0);                                            \
    }
JET_INLINE void give_impulses(double *impulse, const double *weight, const double *y, const int slot[], int unknowns,
                              bool weighs, int width, int lanes)
{
    _Pragma("GCC unroll 256") for (int u = 0; u < unknowns; u++, impulse += lanes) ALL_LANES(width, GIVE)
}

/* The first KEPT rows of x are not of the operations of T. A tape whose operations stand alone is run at one register's
 * lanes after the other, and nothing of it is kept but the impulses. */
#define GALERKIN_EMITTED_STEADY(NAME, T, UNKNOWNS, KEPT, LANES)                                                        \
    enum { NAME##_width = (LANES) % WIDEST == 0 ? WIDEST : 4 };                                                        \
    JET_INLINE bool NAME##_drive(const galerkin_nodes *nodes, bool weighs, int lanes)                                  \
    {                                                                                                                  \
        bool inside = true;                                                                                            \
        if (!T##_is_split) {                                                                                           \
            inside = T##_values_##LANES(nodes->x);                                                                     \
            weigh_lanes(nodes, nodes->x, NAME##_slot, lanes);                                                          \
        }                                                                                                              \
        for (int first = 0; T##_is_split && first < lanes; first += NAME##_width) {                                    \
            _Alignas(64) double y[T##_slots * NAME##_width];                                                           \
            take_rows(y, nodes->x + first, (KEPT), NAME##_width, lanes);                                               \
            inside &= VALUES_OF(T, y, NAME##_width);                                                                   \
            give_impulses(nodes->impulse + first, nodes->weight + first, y, NAME##_slot, (UNKNOWNS), weighs,           \
                          NAME##_width, lanes);                                                                        \
        }                                                                                                              \
        return inside;                                                                                                 \
    }                                                                                                                  \
    STEADY_ORDER static long NAME##_go(const galerkin_frame *frame, const tvi_row *row, const tvi_origin *origin,      \
                                       const tvi_run_state *now, galerkin_outcome *to)                                 \
    {                                                                                                                  \
        enum { IS_SMALL = T##_is_split && (KEPT) * (LANES) <= STEADY_MOST };                                           \
        const galerkin_motion motion = NAME##_motion(frame->motion);                                                   \
        galerkin_nodes nodes = NAME##_sized(frame->nodes);                                                             \
        const steady_form form = {.rows = (UNKNOWNS),                                                                  \
                                  .rule = (UNKNOWNS) <= GALERKIN_FEW ? &NAME##_rule : frame->rule,                     \
                                  .drive = NAME##_drive,                                                               \
                                  .folds = T##_is_split && motion.is_separable && ARE_FEW(&nodes, LANES)};             \
        _Alignas(64) double x[IS_SMALL ? (KEPT) * (LANES) : 1];                                                        \
        if (IS_SMALL) {                                                                                                \
            keep_rows(x, nodes.x, (UNKNOWNS), (KEPT), (LANES));                                                        \
            nodes.x = x;                                                                                               \
        }                                                                                                              \
        if (STEADY_LEADS(UNKNOWNS, LANES))                                                                             \
            return steady_few(frame, &nodes, motion, &form, row, origin, now, to, (LANES));                            \
        return steady_lanes(frame, &nodes, &motion, &form, row, origin, now, to, (LANES));                             \
    }

/* The blocks of the tapes of passes that know second derivatives, of which KEPT rows are not of their operations; small
 * ones are the function's own, too. */
#define GALERKIN_EMITTED_BLOCKS(NAME, N, LANES, INPUTS, VALUES_KEPT, VALUES_SLOTS, SECOND_KEPT, SECOND_SLOTS)          \
    JET_INLINE bool NAME##_sweep(const galerkin_blocks *blocks, bool with_second)                                      \
    {                                                                                                                  \
        return with_second ? tvi_second_values_##LANES(blocks->second) : tvi_values_values_##LANES(blocks->values);    \
    }                                                                                                                  \
    enum { NAME##_is_small = ((VALUES_SLOTS) + (SECOND_SLOTS)) * (LANES) <= STEADY_MOST };                             \
    typedef struct {                                                                                                   \
        _Alignas(64) double values[NAME##_is_small ? (VALUES_SLOTS) * (LANES) : 1];                                    \
        _Alignas(64) double second[NAME##_is_small ? ((SECOND_SLOTS) + 1) * (LANES) : 1];                              \
        _Alignas(64) double x[NAME##_is_small ? 5 * (N) * (LANES) : 1];                                                \
    } NAME##_room;                                                                                                     \
    JET_INLINE galerkin_blocks NAME##_blocks(const galerkin_blocks *of, galerkin_nodes *nodes, NAME##_room *own)       \
    {                                                                                                                  \
        galerkin_blocks blocks = *of;                                                                                  \
        blocks.n = (N);                                                                                                \
        blocks.lanes = (LANES);                                                                                        \
        blocks.inputs = (INPUTS);                                                                                      \
        if (!NAME##_is_small) return blocks;                                                                           \
        keep_rows(own->values, of->values, 2 * (N), (VALUES_KEPT), (LANES));                                           \
        keep_rows(own->second, of->second, (INPUTS), (SECOND_KEPT), (LANES));                                          \
        keep_rows(own->second, of->second, (SECOND_SLOTS), (SECOND_SLOTS) + 1, (LANES));                               \
        blocks.values = own->values;                                                                                   \
        blocks.second = own->second;                                                                                   \
        nodes->x = own->x;                                                                                             \
        return blocks;                                                                                                 \
    }

/* So are the model and the factors. */
#define GALERKIN_EMITTED_LAGRANGIAN(NAME, N, LANES)                                                                    \
    static long NAME##_go(const galerkin_frame *frame, const tvi_row *row, const tvi_origin *origin,                   \
                          const tvi_run_state *now, galerkin_outcome *to)                                              \
    {                                                                                                                  \
        enum { ALL = NAME##_is_small ? (N) * (LANES) : 1 };                                                            \
        NAME##_room own;                                                                                               \
        _Alignas(64) double ways[ALL], rise[2 * ALL], gradient[2 * ALL], moved[2 * ALL];                               \
        _Alignas(64) double lu[(N)*ALL], inverse[(N)*ALL];                                                             \
        _Alignas(64) double scale[2 * ALL], x[ALL];                                                                    \
        int pivot[ALL];                                                                                                \
        galerkin_nodes nodes = NAME##_sized(frame->nodes);                                                             \
        lagrangian_passes w = *(const lagrangian_passes *)frame->own;                                                  \
        w.nodes = &nodes;                                                                                              \
        w.blocks = NAME##_blocks(&w.blocks, &nodes, &own);                                                             \
        w.drives = NAME##_sized(&w.drives);                                                                            \
        w.drives.x = nodes.x + 2 * (N) * (LANES);                                                                      \
        w.slot = NAME##_slot;                                                                                          \
        w.output[false] = NAME##_of_values;                                                                            \
        w.output[true] = NAME##_of_second;                                                                             \
        w.model.n = w.mass.n = (N);                                                                                    \
        w.model.lanes = w.mass.lanes = (LANES);                                                                        \
        w.model.second = w.blocks.second;                                                                              \
        w.model.term = NAME##_term;                                                                                    \
        w.model.end = NAME##_end;                                                                                      \
        if (NAME##_is_small) {                                                                                         \
            keep_rows(ways, w.ways, 0, to->known < 1 ? (N) : 0, (LANES));                                              \
            w.ways = ways;                                                                                             \
            w.rise[0] = rise;                                                                                          \
            w.rise[1] = rise + ALL;                                                                                    \
            w.model.gradient = w.gradient = gradient;                                                                  \
            w.model.moved = moved;                                                                                     \
            w.mass.lu = lu;                                                                                            \
            w.mass.inverse = inverse;                                                                                  \
            w.mass.row_scale = scale;                                                                                  \
            w.mass.column_scale = scale + ALL;                                                                         \
            w.mass.pivot = pivot;                                                                                      \
            w.mass.x = x;                                                                                              \
        }                                                                                                              \
        w.factors = 0;                                                                                                 \
        const steady_form form = {3 * (N), .rule = frame->rule, .sweep = NAME##_sweep, .lagrangian = &w};              \
        const galerkin_motion motion = NAME##_motion(frame->motion);                                                   \
        return steady_lanes(frame, &nodes, &motion, &form, row, origin, now, to, (LANES));                             \
    }

/* The rounds have so many columns, rows that move, and rows. */
#define GALERKIN_EMITTED_HAMILTONIAN(NAME, UNKNOWNS, COUNT, MOVING, ROWS, LANES)                                       \
    enum { NAME##_is_packed = (ROWS) * (COUNT) * (LANES) <= 2 * STEADY_MOST };                                         \
    static long NAME##_go(const galerkin_frame *frame, const tvi_row *row, const tvi_origin *origin,                   \
                          const tvi_run_state *now, galerkin_outcome *to)                                              \
    {                                                                                                                  \
        enum { ALL = NAME##_is_packed ? (ROWS) * (LANES) : 1 };                                                        \
        NAME##_room own;                                                                                               \
        _Alignas(64) float packed[NAME##_is_packed ? (ROWS) * (COUNT) * (LANES) : 1];                                  \
        _Alignas(64) float change[ALL], total[ALL], impulse[ALL], all[ALL];                                            \
        double size[NAME##_is_packed ? (ROWS) : 1], per_size[NAME##_is_packed ? (ROWS) : 1];                           \
        galerkin_nodes nodes = NAME##_sized(frame->nodes);                                                             \
        hamiltonian_passes w = *(const hamiltonian_passes *)frame->own;                                                \
        w.nodes = &nodes;                                                                                              \
        w.blocks = NAME##_blocks(&w.blocks, &nodes, &own);                                                             \
        w.drives = NAME##_sized(&w.drives);                                                                            \
        w.drives.x = nodes.x + (UNKNOWNS) * (LANES);                                                                   \
        w.of_drives = NAME##_slot;                                                                                     \
        w.slot[false] = NAME##_of_values;                                                                              \
        w.slot[true] = NAME##_of_second;                                                                               \
        w.rounds.count = (COUNT);                                                                                      \
        w.rounds.moving = (MOVING);                                                                                    \
        w.rounds.rows = (ROWS);                                                                                        \
        w.rounds.unknown = NAME##_unknown;                                                                             \
        w.rounds.place = NAME##_place_of;                                                                              \
        w.rounds.second = w.blocks.second;                                                                             \
        if (NAME##_is_packed) {                                                                                        \
            w.rounds.packed = packed;                                                                                  \
            w.rounds.size = size;                                                                                      \
            w.rounds.per_size = per_size;                                                                              \
            w.rounds.change = change;                                                                                  \
            w.rounds.total = total;                                                                                    \
            w.rounds.impulse = impulse;                                                                                \
            w.rounds.all = all;                                                                                        \
        }                                                                                                              \
        const steady_form form = {UNKNOWNS, .rule = frame->rule, .sweep = NAME##_sweep, .hamiltonian = &w};            \
        const galerkin_motion motion = NAME##_motion(frame->motion);                                                   \
        return steady_lanes(frame, &nodes, &motion, &form, row, origin, now, to, (LANES));                             \
    }

/* All steps of a row; those of many unknowns are made one by one. */
#define GALERKIN_EMITTED_ROW(NAME)                                                                                     \
    static long NAME##_steady(const galerkin_frame *frame, const tvi_row *row, const tvi_origin *origin,               \
                              const tvi_run_state *now, galerkin_outcome *to)                                          \
    {                                                                                                                  \
        long made = 0, more = 1;                                                                                       \
        while (more > 0 && made < row->steps) made += more = NAME##_go(frame, row, origin, now, to);                   \
        return made;                                                                                                   \
    }

#endif
