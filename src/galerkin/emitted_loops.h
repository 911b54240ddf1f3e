/* emitted_loops.h - the loops of generated code (emit.c), which alone reads this, after the text of loops.c:
 * UNKNOWNS and LANES are constants there. Nodes of another size, as halves of the unknowns, take the loops as they
 * are. */
#ifndef TVI_SRC_GALERKIN_EMITTED_LOOPS_H
#define TVI_SRC_GALERKIN_EMITTED_LOOPS_H

#include "galerkin/loops.h"

#define GALERKIN_EMITTED_LOOPS(NAME, N, PARTS, MOVING, UNKNOWNS, LANES)                                                \
    JET_INLINE bool NAME##_fits(const galerkin_nodes *nodes)                                                           \
    {                                                                                                                  \
        return nodes->lanes == (LANES) && nodes->unknowns == (UNKNOWNS) && nodes->moving == (MOVING);                  \
    }                                                                                                                  \
    JET_INLINE galerkin_nodes NAME##_sized(const galerkin_nodes *nodes)                                                \
    {                                                                                                                  \
        galerkin_nodes sized = *nodes;                                                                                 \
        sized.lanes = (LANES);                                                                                         \
        sized.unknowns = (UNKNOWNS);                                                                                   \
        sized.half = (N);                                                                                              \
        sized.parts.count = (PARTS);                                                                                   \
        sized.moving = (MOVING);                                                                                       \
        return sized;                                                                                                  \
    }                                                                                                                  \
    static double NAME##_move(const galerkin_nodes *nodes, const double *matrix, const double *drives,                 \
                              const int slot[])                                                                        \
    {                                                                                                                  \
        if (!NAME##_fits(nodes)) return move_lanes(nodes, matrix, drives, slot, (LANES));                              \
        const galerkin_nodes sized = NAME##_sized(nodes);                                                              \
        return move_lanes(&sized, matrix, drives, slot, (LANES));                                                      \
    }                                                                                                                  \
    static double NAME##_move_in_parts(const galerkin_nodes *nodes, const double *matrix, const double *drives,        \
                                       const int slot[], double *ways)                                                 \
    {                                                                                                                  \
        return move_in_parts_lanes(nodes, matrix, drives, slot, ways, (LANES));                                        \
    }                                                                                                                  \
    static double NAME##_move_both(const galerkin_nodes *nodes, const double *matrix, const double *drives,            \
                                   const double *changes, const int slot[])                                            \
    {                                                                                                                  \
        const galerkin_nodes sized = NAME##_sized(nodes);                                                              \
        return move_both_lanes(&sized, matrix, drives, changes, slot, (LANES));                                        \
    }                                                                                                                  \
    static void NAME##_predict(const galerkin_nodes *nodes, int steps, const double *matrix,                           \
                               const double *const impulses[])                                                         \
    {                                                                                                                  \
        const galerkin_nodes sized = NAME##_sized(nodes);                                                              \
        predict_lanes(&sized, steps, matrix, impulses, (LANES));                                                       \
    }                                                                                                                  \
    static void NAME##_go_round(const galerkin_nodes *nodes, const lanes_rounds *rounds, const double *drives,         \
                                const int slot[], bool is_new, double moved, double least, double *changes)            \
    {                                                                                                                  \
        const galerkin_nodes sized = NAME##_sized(nodes);                                                              \
        go_round_lanes(&sized, rounds, drives, slot, is_new, moved, least, changes, (LANES));                          \
    }                                                                                                                  \
    static void NAME##_integrate(const galerkin_nodes *nodes, const galerkin_weights *weights,                         \
                                 const galerkin_sums *sums)                                                            \
    {                                                                                                                  \
        const galerkin_nodes sized = NAME##_sized(nodes);                                                              \
        integrate_lanes(&sized, weights, sums, (LANES));                                                               \
    }                                                                                                                  \
    static void NAME##_start(const galerkin_nodes *nodes, int n, const tvi_origin *origin)                             \
    {                                                                                                                  \
        start_lanes(nodes, n, origin, (LANES));                                                                        \
    }                                                                                                                  \
    static void NAME##_start_drifting(const galerkin_nodes *nodes, const double *c, const tvi_origin *origin,          \
                                      double *drift, double *drift_low)                                                \
    {                                                                                                                  \
        const galerkin_nodes sized = NAME##_sized(nodes);                                                              \
        start_drifting_lanes(&sized, c, origin, drift, drift_low, (LANES));                                            \
    }                                                                                                                  \
    static void NAME##_end_drifting(const galerkin_nodes *nodes, const galerkin_sums *sums, const double *drift,       \
                                    const double *drift_low, const tvi_increments *by)                                 \
    {                                                                                                                  \
        const galerkin_nodes sized = NAME##_sized(nodes);                                                              \
        end_drifting(&sized, sums, drift, drift_low, by);                                                              \
    }                                                                                                                  \
    JET_INLINE galerkin_motion NAME##_motion(const galerkin_motion *of)                                                \
    {                                                                                                                  \
        galerkin_motion sized = *of;                                                                                   \
        sized.n = (N);                                                                                                 \
        sized.is_separable = (N) == (UNKNOWNS);                                                                        \
        sized.parts.count = (PARTS);                                                                                   \
        return sized;                                                                                                  \
    }                                                                                                                  \
    static double NAME##_tail(const galerkin_motion *of, double *share, double *ratio)                                 \
    {                                                                                                                  \
        const galerkin_motion sized = NAME##_motion(of);                                                               \
        return tail(&sized, share, ratio);                                                                             \
    }                                                                                                                  \
    static void NAME##_place(const galerkin_places *p, const double *table, const double *impulses, double *out)       \
    {                                                                                                                  \
        place_lanes(p, table, impulses, out, (LANES));                                                                 \
    }

#define GALERKIN_EMITTED_TABLE(NAME)                                                                                   \
    NAME##_move, NAME##_move_in_parts, NAME##_move_both, NAME##_predict, NAME##_go_round, NAME##_integrate,            \
        NAME##_start, NAME##_start_drifting, NAME##_end_drifting, NAME##_tail, NAME##_place, NAME##_steady

#endif
