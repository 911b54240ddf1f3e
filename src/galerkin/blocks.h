/* blocks.h - the blocks of the tapes in which passes that know second derivatives have the gradient that drives the
 * unknowns (docs/method.md section 5), of the library and of generated code, where all sizes are constants. */
#ifndef TVI_SRC_GALERKIN_BLOCKS_H
#define TVI_SRC_GALERKIN_BLOCKS_H

#include "galerkin/in_library.h"
#include "galerkin/loops.h"

#include <stdbool.h>
#include <string.h>

/* Of L in (q, v), or of a product in (q, p): two halves of n rows each, the time and parameters come first. */
typedef struct {
    int n, lanes, inputs;
    const void *of;          /* the sweep's own */
    double *values, *second; /* of the field, and of it with its derivatives: zeros behind it */
} galerkin_blocks;

/* Of the one block or the other; false outside its domain. */
typedef bool galerkin_sweep(const galerkin_blocks *blocks, bool with_second);

/* The block that has the gradient at the places in that of values; NULL outside its domain. */
static inline const double *galerkin_sweep_there(const galerkin_blocks *blocks, galerkin_sweep *sweep, bool with_second)
{
    if (with_second) memcpy(blocks->second, blocks->values, (size_t)(blocks->inputs * blocks->lanes) * sizeof(double));
    return !sweep(blocks, with_second) ? NULL : with_second ? blocks->second : blocks->values;
}

/* The same at the nodes, first and last [n][lanes]. */
static inline const double *galerkin_sweep_at(const galerkin_blocks *blocks, galerkin_sweep *sweep, bool with_second,
                                              const double *first, const double *last)
{
    const int half = blocks->n * blocks->lanes;
    memcpy(blocks->values, first, (size_t)half * sizeof *first);
    memcpy(blocks->values + half, last, (size_t)half * sizeof *last);
    return galerkin_sweep_there(blocks, sweep, with_second);
}

/* The drives, which are impulses divided by h b, and unknowns that begin at 0. */
static inline void galerkin_predict_drives(const galerkin_loops *loops, const galerkin_nodes *drives,
                                           const galerkin_extrapolation *by)
{
    for (int u = 0; u < drives->unknowns; u++) drives->scale[u] = 1 / by->h;
    GALERKIN_LOOP(loops, predict, drives, by);
}

#endif
