/* galerkin_tables.h - Declares the coefficients of the Galerkin curve, for tests of its loops. */
#ifndef TESTS_PROBLEMS_GALERKIN_TABLES_H
#define TESTS_PROBLEMS_GALERKIN_TABLES_H

#include "galerkin/tables.h"

#include <check.h>
#include <stdlib.h>

typedef struct {
    galerkin_coefficients of;
    galerkin_polynomials dense;
    void *memory;
} galerkin_tables;

static inline void galerkin_tables_take(galerkin_tables *tables, tvi_arena *arena, int points, int lanes)
{
    tvi_galerkin_allocate_tables(&tables->of, &tables->dense, arena, points, lanes);
}

static inline void galerkin_tables_open(galerkin_tables *tables, int points, int lanes, bool is_second_order)
{
    tvi_arena arena = {0};
    *tables = (galerkin_tables){0};
    galerkin_tables_take(tables, &arena, points, lanes);
    tables->memory = tvi_arena_obtain_memory(&arena);
    ck_assert_ptr_nonnull(tables->memory);
    galerkin_tables_take(tables, &arena, points, lanes);
    tvi_galerkin_compute_tables(&tables->of, &tables->dense, is_second_order);
}

static inline void galerkin_tables_close(galerkin_tables *tables) { free(tables->memory); }

#endif
