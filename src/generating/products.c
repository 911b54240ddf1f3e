/* products.c - allocates the memory of the conjugate-residual iteration of products.h, and lists its functions as a
 * solver of the equations of the generating functions. It is compiled once for each instruction set. */
#define CURVE_ONE_SET
#include "sums.h"

#include "generating/products.h"

static void allocate_conjugate_residuals(tvi_corrected_curve *corrected, tvi_arena *arena)
{
    const size_t width = (size_t)products_get_padded_row_count(corrected);
    tvi_conjugate_residuals *allocated = tvi_arena_allocate(arena, sizeof *allocated);
    const tvi_conjugate_residuals iteration = {
        .solution = tvi_arena_allocate_doubles(arena, width),
        .residual = tvi_arena_allocate_doubles(arena, width),
        .search_direction = tvi_arena_allocate_doubles(arena, PRODUCTS_MAX_ITERATIONS * width),
        .direction_image = tvi_arena_allocate_doubles(arena, PRODUCTS_MAX_ITERATIONS * width),
        .inverse_unknown_size = tvi_arena_allocate_doubles(arena, width),
        .scratch = tvi_arena_allocate_doubles(arena, width),
        .product = tvi_arena_allocate_doubles(arena, width),
        .max_norm_of_coefficient_Q_by_order =
            tvi_arena_allocate_doubles(arena, (size_t)corrected->curve.highest_order + 1),
    };
    if (allocated) *allocated = iteration;
    corrected->solver_data = allocated;
}

const tvi_end_correction_solver JET_FOR_ISA(tvi_solver_by_products) = {
    allocate_conjugate_residuals, products_discard_guess, products_solve_correction_equations, NULL,
    products_apply_inverse_flow_jacobian};
