/* blocks.h - Defines the blocks of the tapes for passes that know second derivatives (docs/method.md section 5). The
 * library and generated code use it; in generated code all sizes are constants. */
#ifndef TVI_SRC_GALERKIN_BLOCKS_H
#define TVI_SRC_GALERKIN_BLOCKS_H

#include "galerkin/in_library.h"
#include "galerkin/loops.h"

#include <stdbool.h>
#include <string.h>

/* The blocks of L in (q, v), or of a product in (q, p): two halves of n rows each come first, then the time and
 * parameters. */
typedef struct {
    int n, lanes, inputs;
    const void *work; /* belongs to the sweep */
    /* The field, and the field with its derivatives, with zeros after it. */
    double *values, *hessian;
} galerkin_blocks;

/* Evaluates one block or the other. Returns false outside its domain. */
typedef bool galerkin_sweep(const galerkin_blocks *blocks, bool with_hessian);

/* Evaluates the gradient at the points in the block of values. Returns the block that has it; NULL outside its
 * domain. */
static inline const double *galerkin_sweep_there(const galerkin_blocks *blocks, galerkin_sweep *sweep,
                                                 bool with_hessian)
{
    if (with_hessian)
        memcpy(blocks->hessian, blocks->values, (size_t)(blocks->inputs * blocks->lanes) * sizeof(double));
    return !sweep(blocks, with_hessian) ? NULL : with_hessian ? blocks->hessian : blocks->values;
}

/* Evaluates the gradient at the nodes, first and last [n][lanes]. */
static inline const double *galerkin_sweep_at(const galerkin_blocks *blocks, galerkin_sweep *sweep, bool with_hessian,
                                              const double *first, const double *last)
{
    const int half = blocks->n * blocks->lanes;
    memcpy(blocks->values, first, (size_t)half * sizeof *first);
    memcpy(blocks->values + half, last, (size_t)half * sizeof *last);
    return galerkin_sweep_there(blocks, sweep, with_hessian);
}

/* The drives, which are impulses divided by h b, and unknowns that begin at 0. */
static inline void galerkin_predict_rates(const galerkin_loops *loops, const galerkin_nodes *rates,
                                          const galerkin_extrapolation *by)
{
    for (int u = 0; u < rates->unknowns; u++) rates->scale[u] = 1 / by->h;
    GALERKIN_LOOP(loops, predict, rates, by);
}

#endif
