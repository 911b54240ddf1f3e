/* loops.c - Compiles the loops of a Galerkin step for tests, once for each instruction set (loops.h). */
#include "loops.h"

const galerkin_loops loops = {nodes_invert,       nodes_correct_velocities,       nodes_move_by_rates,
                              nodes_sum_impulses, nodes_set_separable_increments, galerkin_compute_tail};
