/* emitted_loops.h - the loops of generated code (emit.c), which alone reads this, after the text of loops.c:
 * UNKNOWNS and LANES are constants there. Nodes of another size, as halves of the unknowns, take the loops as they
 * are. */
#ifndef TVI_SRC_GALERKIN_EMITTED_LOOPS_H
#define TVI_SRC_GALERKIN_EMITTED_LOOPS_H

#include "galerkin/steady.h"

#define GALERKIN_EMITTED_LOOPS(NAME, N, UNKNOWNS, LANES)                                                               \
    JET_INLINE bool NAME##_fits(const galerkin_nodes *nodes)                                                           \
    {                                                                                                                  \
        return nodes->lanes == (LANES) && nodes->unknowns == (UNKNOWNS);                                               \
    }                                                                                                                  \
    JET_INLINE galerkin_nodes NAME##_sized(const galerkin_nodes *nodes)                                                \
    {                                                                                                                  \
        galerkin_nodes sized = *nodes;                                                                                 \
        sized.lanes = (LANES);                                                                                         \
        sized.unknowns = (UNKNOWNS);                                                                                   \
        return sized;                                                                                                  \
    }                                                                                                                  \
    static double NAME##_move(const galerkin_nodes *nodes, const double *matrix, const double *drives,                 \
                              const int slot[])                                                                        \
    {                                                                                                                  \
        if (!NAME##_fits(nodes)) return move_lanes(nodes, matrix, drives, slot, (LANES));                              \
        const galerkin_nodes sized = NAME##_sized(nodes);                                                              \
        return move_lanes(&sized, matrix, drives, slot, (LANES));                                                      \
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
    static void NAME##_drive(const galerkin_nodes *nodes, const lanes_matrix *of, const double *change,                \
                             double *impulse)                                                                          \
    {                                                                                                                  \
        drive_lanes(nodes, of, change, impulse, (LANES));                                                              \
    }                                                                                                                  \
    static double NAME##_round(const galerkin_nodes *nodes, const double *matrix, const lanes_rounds *rounds)          \
    {                                                                                                                  \
        return go_round_lanes(nodes, matrix, rounds, (LANES));                                                         \
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
                                    const double *drift_low, double dq[], double dp[])                                 \
    {                                                                                                                  \
        const galerkin_nodes sized = NAME##_sized(nodes);                                                              \
        end_drifting(&sized, sums, drift, drift_low, dq, dp);                                                          \
    }                                                                                                                  \
    JET_INLINE galerkin_motion NAME##_motion(const galerkin_motion *of)                                                \
    {                                                                                                                  \
        galerkin_motion sized = *of;                                                                                   \
        sized.n = (N);                                                                                                 \
        sized.has_masses = (N) == (UNKNOWNS);                                                                          \
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

/* The step of steady.h. Small nodes are the function's own, where the compiler keeps them in registers. */
typedef bool steady_field(double *x, int lanes);
enum { STEADY_MOST = 4096 };

JET_INLINE bool steady_passes(const galerkin_frame *frame, const galerkin_nodes *nodes, steady_field *run_field,
                              const int slot[], tvi_passes *shown, int lanes)
{
    tvi_passes passes = *shown;
    tvi_passes_verdict verdict = TVI_PASSES_GO_ON;
    while (verdict == TVI_PASSES_GO_ON && passes.count < frame->rule->most) {
        if (!run_field(nodes->x, lanes)) return false;
        const double moved = move_lanes(nodes, frame->matrix, nodes->x, slot, lanes);
        if (!isfinite(moved)) return false;
        verdict = tvi_passes_judge(&passes, frame->rule, moved);
    }
    *shown = passes;
    return verdict == TVI_PASSES_MAY_END;
}

JET_INLINE bool steady_lanes(const galerkin_frame *frame, const galerkin_nodes *nodes, galerkin_motion motion,
                             steady_field *run_field, const int slot[], const tvi_origin *origin, galerkin_outcome *to,
                             int lanes)
{
    const int n = motion.n;
    if (motion.has_masses) start_drifting_lanes(nodes, frame->c, origin, frame->drift, frame->drift_low, lanes);
    else start_lanes(nodes, n, origin, lanes);
    predict_lanes(nodes, 2, frame->extrapolation, to->impulses, lanes);
    galerkin_set_sizes(nodes, n);
    if (!steady_passes(frame, nodes, run_field, slot, &to->passes, lanes)) return false;
    integrate_lanes(nodes, frame->weights, &motion.sums, lanes);
    if (motion.has_masses) end_drifting(nodes, &motion.sums, frame->drift, frame->drift_low, to->dq, to->dp);
    else galerkin_end(nodes, &motion.sums, n, to->dq, to->dp);
    motion.q = origin->q;
    motion.p = origin->p;
    motion.dp = to->dp;
    to->tail = lanes < 2 ? 0 : tail(&motion, frame->share, frame->ratio);
    return true;
}

/* KEPT rows of x are not of the tape's operations. Outputs that are inputs are copied behind the tape's slots, as by
 * galerkin_evaluate. */
#define GALERKIN_EMITTED_STEADY(NAME, VALUES, UNKNOWNS, KEPT, SLOTS, LANES)                                            \
    JET_INLINE bool NAME##_values(double *x, int lanes)                                                                \
    {                                                                                                                  \
        const bool inside = VALUES(x, lanes);                                                                          \
        for (int i = 0; i < NAME##_copies; i++)                                                                        \
            for (int lane = 0; lane < lanes; lane++)                                                                   \
                x[((SLOTS) + i) * lanes + lane] = x[NAME##_copied[i] * lanes + lane];                                  \
        return inside;                                                                                                 \
    }                                                                                                                  \
    static bool NAME##_steady(const galerkin_frame *frame, const tvi_origin *origin, galerkin_outcome *to)             \
    {                                                                                                                  \
        enum { ROWS = (SLOTS) + NAME##_copies, IS_SMALL = ROWS * (LANES) <= STEADY_MOST };                             \
        _Alignas(64) double x[IS_SMALL ? ROWS * (LANES) : 1];                                                          \
        galerkin_nodes nodes = NAME##_sized(frame->nodes);                                                             \
        for (int i = (UNKNOWNS) * (LANES); i < (KEPT) * (LANES) && IS_SMALL; i++) x[i] = nodes.x[i];                   \
        if (IS_SMALL) nodes.x = x;                                                                                     \
        return steady_lanes(frame, &nodes, NAME##_motion(frame->motion), NAME##_values, NAME##_slot, origin, to,       \
                            (LANES));                                                                                  \
    }

#define GALERKIN_EMITTED_TABLE(NAME)                                                                                   \
    NAME##_move, NAME##_move_both, NAME##_predict, NAME##_drive, NAME##_round, NAME##_integrate, NAME##_start,         \
        NAME##_start_drifting, NAME##_end_drifting, NAME##_tail, NAME##_place

#endif
