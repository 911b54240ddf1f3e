/* emitted_loops.h - the loops of generated code (emit.c), which alone reads this, after the text of loops.c:
 * UNKNOWNS and LANES are constants there. Nodes of another size, as halves of the unknowns, take the loops as they
 * are. */
#ifndef TVI_SRC_GALERKIN_EMITTED_LOOPS_H
#define TVI_SRC_GALERKIN_EMITTED_LOOPS_H

#include "galerkin/lagrangian_passes.h"
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
    static void NAME##_go_round(const galerkin_nodes *nodes, const double *matrix, const lanes_rounds *rounds,         \
                                const double *moved, bool is_new, double first, double last, double *changes)          \
    {                                                                                                                  \
        const galerkin_nodes sized = NAME##_sized(nodes);                                                              \
        go_round_lanes(&sized, matrix, rounds, moved, is_new, first, last, changes, (LANES));                          \
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

/* What a pass is made by: the field and the rows of it that drive the unknowns, or a Lagrangian. */
typedef struct {
    steady_field *run;
    const int *slot;
    lagrangian_passes *lagrangian;
    lagrangian_sweep *sweep;
} steady_form;

/* A pass in two parts, between which its impulses are stored. */
JET_INLINE bool steady_begin(const galerkin_nodes *nodes, const steady_form *form, int lanes)
{
    if (form->lagrangian) return true;
    if (!form->run(nodes->x, lanes)) return false;
    weigh_lanes(nodes, nodes->x, form->slot, lanes);
    return true;
}

JET_INLINE bool steady_end(const galerkin_frame *frame, const galerkin_nodes *nodes, const steady_form *form,
                           double *moved, int lanes)
{
    if (form->lagrangian) {
        const lagrangian_passed passed = lagrangian_pass(form->lagrangian, form->sweep);
        *moved = form->lagrangian->moved;
        return passed == LAGRANGIAN_PASSED;
    }
    *moved = follow_lanes(nodes, frame->matrix, lanes);
    return true;
}

/* A few unknowns stay in registers from the end of a pass to the beginning of the next one, which follows directly. */
enum { STEADY_FEW = 8 };
JET_INLINE bool steady_passes(const galerkin_frame *frame, const galerkin_nodes *nodes, const steady_form *form,
                              tvi_passes *shown, int lanes)
{
    const bool few = nodes->unknowns <= STEADY_FEW;
    tvi_passes passes = *shown;
    tvi_passes_verdict verdict = TVI_PASSES_GO_ON;
    if (few && !steady_begin(nodes, form, lanes)) return false;
    while (verdict == TVI_PASSES_GO_ON && passes.count < frame->rule->most) {
        double moved;
        if (!few && !steady_begin(nodes, form, lanes)) return false;
        if (!steady_end(frame, nodes, form, &moved, lanes) || !isfinite(moved)) return false;
        verdict = tvi_passes_judge(&passes, frame->rule, moved);
        if (few && verdict == TVI_PASSES_GO_ON && !steady_begin(nodes, form, lanes)) return false;
    }
    *shown = passes;
    return verdict == TVI_PASSES_MAY_END;
}

JET_INLINE bool steady_lanes(const galerkin_frame *frame, const galerkin_nodes *nodes, galerkin_motion motion,
                             const steady_form *form, const tvi_origin *origin, galerkin_outcome *to, int lanes)
{
    const int n = motion.n;
    if (motion.has_masses) start_drifting_lanes(nodes, frame->c, origin, frame->drift, frame->drift_low, lanes);
    else start_lanes(nodes, n, origin, lanes);
    if (form->lagrangian) lagrangian_predict(form->lagrangian, *frame->h, 2, frame->extrapolation, to->impulses);
    else predict_lanes(nodes, 2, frame->extrapolation, to->impulses, lanes);
    galerkin_set_sizes(nodes, n);
    if (!steady_passes(frame, nodes, form, &to->passes, lanes)) return false;
    integrate_lanes(nodes, frame->weights, &motion.sums, lanes);
    if (motion.has_masses) end_drifting(nodes, &motion.sums, frame->drift, frame->drift_low, to->dq, to->dp);
    else galerkin_end(nodes, &motion.sums, n, to->dq, to->dp);
    motion.q = origin->q;
    motion.p = origin->p;
    motion.dp = to->dp;
    to->tail = lanes < 2 ? 0 : tail(&motion, frame->share, frame->ratio);
    return true;
}

/* The rows of a block between its first ones, which are set anew, and `kept`. */
JET_INLINE void keep_rows(double *own, const double *block, int first, int kept, int lanes)
{
    for (int i = first * lanes; i < kept * lanes; i++) own[i] = block[i];
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
        const steady_form form = {NAME##_values, NAME##_slot, NULL, NULL};                                             \
        if (IS_SMALL) {                                                                                                \
            keep_rows(x, nodes.x, (UNKNOWNS), (KEPT), (LANES));                                                        \
            nodes.x = x;                                                                                               \
        }                                                                                                              \
        return steady_lanes(frame, &nodes, NAME##_motion(frame->motion), &form, origin, to, (LANES));                  \
    }

/* Of a Lagrangian: INPUTS, and the KEPT and all rows of the blocks of its tapes. */
#define GALERKIN_EMITTED_LAGRANGIAN(NAME, N, LANES, INPUTS, VALUES_KEPT, VALUES_SLOTS, SECOND_KEPT, SECOND_SLOTS)      \
    JET_INLINE bool NAME##_sweep(const lagrangian_passes *w, bool with_second)                                         \
    {                                                                                                                  \
        return with_second ? tvi_second_values_of(w->second, (LANES)) : tvi_values_values_of(w->values, (LANES));      \
    }                                                                                                                  \
    JET_INLINE lagrangian_passes NAME##_passes(const lagrangian_passes *of, const galerkin_nodes *nodes)               \
    {                                                                                                                  \
        lagrangian_passes w = *of;                                                                                     \
        w.nodes = nodes;                                                                                               \
        w.drives = NAME##_sized(&of->drives);                                                                          \
        w.slot = NAME##_slot;                                                                                          \
        w.inputs = (INPUTS);                                                                                           \
        w.output[false] = NAME##_of_values;                                                                            \
        w.output[true] = NAME##_of_second;                                                                             \
        w.model.n = w.mass.n = (N);                                                                                    \
        w.model.lanes = w.mass.lanes = (LANES);                                                                        \
        w.model.term = NAME##_term;                                                                                    \
        w.model.end = NAME##_end;                                                                                      \
        w.factors = 0;                                                                                                 \
        return w;                                                                                                      \
    }                                                                                                                  \
    static bool NAME##_steady(const galerkin_frame *frame, const tvi_origin *origin, galerkin_outcome *to)             \
    {                                                                                                                  \
        enum { IS_SMALL = ((VALUES_SLOTS) + (SECOND_SLOTS)) * (LANES) <= STEADY_MOST, HALF = (N) * (LANES) };          \
        _Alignas(64) double of_values[IS_SMALL ? (VALUES_SLOTS) * (LANES) : 1],                                        \
            of_second[IS_SMALL ? (SECOND_SLOTS) * (LANES) : 1];                                                        \
        _Alignas(64) double x[IS_SMALL ? 5 * HALF : 1];                                                                \
        galerkin_nodes nodes = NAME##_sized(frame->nodes);                                                             \
        lagrangian_passes w = NAME##_passes(frame->own, &nodes);                                                       \
        if (IS_SMALL) {                                                                                                \
            keep_rows(of_values, w.values, 2 * (N), (VALUES_KEPT), (LANES));                                           \
            keep_rows(of_second, w.second, (INPUTS), (SECOND_KEPT), (LANES));                                          \
            nodes.x = x;                                                                                               \
            w.drives.x = x + 2 * HALF;                                                                                 \
            w.values = of_values;                                                                                      \
            w.second = of_second;                                                                                      \
            w.model.second = of_second;                                                                                \
        }                                                                                                              \
        const steady_form form = {NULL, NULL, &w, NAME##_sweep};                                                       \
        const bool is_made = steady_lanes(frame, &nodes, NAME##_motion(frame->motion), &form, origin, to, (LANES));    \
        to->factors = w.factors;                                                                                       \
        return is_made;                                                                                                \
    }

#define GALERKIN_EMITTED_TABLE(NAME)                                                                                   \
    NAME##_move, NAME##_move_both, NAME##_predict, NAME##_go_round, NAME##_integrate, NAME##_start,                    \
        NAME##_start_drifting, NAME##_end_drifting, NAME##_tail, NAME##_place

#endif
