/* products.c - solves the equations of the products path (products.h), compiled once for each instruction set. */
#define CURVE_ONE_SET
#include "sums.h"

#include "generating/products.h"

static void take(tvi_closure *c, tvi_arena *arena)
{
    const size_t width = (size_t)products_width(c);
    tvi_iteration *taken = tvi_arena_allocate(arena, sizeof *taken);
    const tvi_iteration it = {
        .x = tvi_arena_doubles(arena, width),
        .r = tvi_arena_doubles(arena, width),
        .s = tvi_arena_doubles(arena, PRODUCTS_MOST * width),
        .v = tvi_arena_doubles(arena, PRODUCTS_MOST * width),
        .unit = tvi_arena_doubles(arena, width),
        .scratch = tvi_arena_doubles(arena, width),
        .product = tvi_arena_doubles(arena, width),
        .largest = tvi_arena_doubles(arena, (size_t)c->curve.top + 1),
    };
    if (taken) *taken = it;
    c->solving = taken;
}

const tvi_solver JET_FOR_ISA(tvi_by_products) = {take,           products_begin, products_close,
                                                 products_solve, NULL,           products_correct};
