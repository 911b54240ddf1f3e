/* loops.h - Declares the loops of a Galerkin step over its nodes for tests, compiled for each instruction set. */
#ifndef TESTS_LIBRARY_LOOPS_H
#define TESTS_LIBRARY_LOOPS_H

#include "galerkin/ends.h"
#include "galerkin/lagrangian_pass.h"

typedef struct {
    bool (*invert)(const node_matrix *matrix, int lane_count);
    void (*correct_velocities)(const node_matrix *L_vv, int lane_count, const double *P, const double *L_v,
                               const double *L_v_change, const double *centre_V, double *V);
    double (*move)(const galerkin_nodes *nodes, const double *rates, const int slot[], double *moved);
    void (*sum_impulses)(const galerkin_nodes *nodes, const galerkin_sum_weights *weights, const galerkin_sums *sums);
    void (*set_separable_increments)(const galerkin_nodes *nodes, const galerkin_sums *sums, const double *move,
                                     const double *move_low, const tvi_increments *to);
    double (*compute_tail)(const galerkin_tail *tail);
} galerkin_loops;

/* The suffix of an instruction set is given by tests.mk. */
extern const galerkin_loops loops;
#ifdef JET_ISA_X86
extern const galerkin_loops loops_avx2, loops_avx512;
#endif

/* The numbers of lanes, and the loops of set number isa for the one at this index. NULL: the processor has no such set,
 * or the set is not used with so many lanes. */
enum { LANE_COUNTS = 3 };
static const int lane_counts[LANE_COUNTS] = {4, 8, GALERKIN_MAX_LANES};
static inline const galerkin_loops *loops_of(int isa, int index)
{
#ifdef JET_ISA_X86
    if (isa == jet_isa_avx2 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return &loops_avx2;
    if (isa == jet_isa_avx512 && lane_counts[index] == 8 && __builtin_cpu_supports("avx512f") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
        return &loops_avx512;
#endif
    return isa == jet_isa_base && index < LANE_COUNTS ? &loops : NULL;
}

#endif
