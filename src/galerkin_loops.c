/* galerkin_loops.c - see galerkin.h. */
#include "lanes.h"
#include "rule.h"
#include "vector.h"

#include <stddef.h>

#define VECTOR(V, array, index)    (*(V *)((array) + (size_t)(index) * (size_t)lanes + w))
#define OF_VECTOR(V, array, index) (*(const V *)((array) + (size_t)(index) * (size_t)lanes + w))

/* In halves, which wait less for each other. */
INLINE double sum_of(const double x[], size_t count)
{
    double sum[8];
    for (size_t i = 0; i < count; i++) sum[i] = x[i];
    for (size_t half = count / 2; half > 0; half /= 2)
        for (size_t i = 0; i < half; i++) sum[i] += sum[i + half];
    return sum[0];
}

/* The lanes of a block for all unknowns. */
#define MOVE(V, S)                                                                                                     \
    {                                                                                                                  \
        V squares = {0};                                                                                               \
        for (int u = 0; u < nodes->unknowns; u++) {                                                                    \
            const double *drive = drives + (size_t)slot[u] * (size_t)lanes;                                            \
            V even = OF_VECTOR(V, matrix, 0) * drive[0], odd = {0};                                                    \
            if (lanes > 1) odd = OF_VECTOR(V, matrix, 1) * drive[1];                                                   \
            for (int j = 2; j < lanes; j += 2) {                                                                       \
                even += OF_VECTOR(V, matrix, j) * drive[j];                                                            \
                odd += OF_VECTOR(V, matrix, j + 1) * drive[j + 1];                                                     \
            }                                                                                                          \
            const V place = nodes->start[u] + (OF_VECTOR(V, nodes->base, u) + nodes->scale[u] * (even + odd));         \
            const V change = (place - VECTOR(V, x, u)) * nodes->inverse_size[u];                                       \
            squares += change * change;                                                                                \
            VECTOR(V, x, u) = place;                                                                                   \
        }                                                                                                              \
        sum += sum_of((const double *)&squares, sizeof squares / sizeof(double));                                      \
    }

INLINE double move_lanes(const galerkin_nodes *nodes, const double *matrix, const double *drives, const int slot[],
                         int lanes)
{
    double *x = nodes->x, sum = 0;
    JET_BLOCKS(lanes, MOVE, );
    return sum;
}

static double move(const galerkin_nodes *nodes, const double *matrix, const double *drives, const int slot[])
{
    double sum;
#define CALL(lanes) sum = move_lanes(nodes, matrix, drives, slot, lanes)
    FOR_LANES(nodes->lanes, CALL)
#undef CALL
    return sum;
}

#define PREDICT(V, S)                                                                                                  \
    for (int u = 0; u < nodes->unknowns; u++) {                                                                        \
        V even = {0}, odd = {0};                                                                                       \
        for (int step = 0; step < steps; step++) {                                                                     \
            const double *drive = drives[step] + u * lanes, *of_step = matrix + step * lanes * lanes;                  \
            for (int j = 0; j < lanes; j += 2) {                                                                       \
                even += OF_VECTOR(V, of_step, j) * drive[j];                                                           \
                if (lanes > 1) odd += OF_VECTOR(V, of_step, j + 1) * drive[j + 1];                                     \
            }                                                                                                          \
        }                                                                                                              \
        VECTOR(V, nodes->x, u) = nodes->start[u] + (OF_VECTOR(V, nodes->base, u) + nodes->scale[u] * (even + odd));    \
    }

INLINE void predict_lanes(const galerkin_nodes *nodes, int steps, const double *matrix, const double *const drives[],
                          int lanes)
{
    JET_BLOCKS(lanes, PREDICT, );
}

static void predict(const galerkin_nodes *nodes, int steps, const double *matrix, const double *const drives[]){
#define CALL(lanes) predict_lanes(nodes, steps, matrix, drives, lanes)
    FOR_LANES(nodes->lanes, CALL)
#undef CALL
}

#define SUM(V, S)                                                                                                      \
    {                                                                                                                  \
        V total = {0};                                                                                                 \
        for (int j = 0; j < lanes; j++) total += *(const V *)(weight + j * SUMS + w) * drive[j];                       \
        *(V *)(sum + u * SUMS + w) = total;                                                                            \
    }
#define COPY(V, S) VECTOR(V, last, u) = *(const V *)(drive + w);

INLINE void integrate_lanes(const galerkin_nodes *nodes, const double *weight, const int slot[], double *sum,
                            double *last, int lanes)
{
    for (int u = 0; u < nodes->unknowns; u++) {
        const double *drive = nodes->x + (size_t)slot[u] * (size_t)lanes;
        JET_BLOCKS(SUMS, SUM, );
        JET_BLOCKS(lanes, COPY, );
    }
}

static void integrate(const galerkin_nodes *nodes, const double *weight, const int slot[], double *sum, double *last){
#define CALL(lanes) integrate_lanes(nodes, weight, slot, sum, last, lanes)
    FOR_LANES(nodes->lanes, CALL)
#undef CALL
}

#define BASE(V, S) VECTOR(V, nodes->base, u) = OF_VECTOR(V, c, 0) * drift[u] + OF_VECTOR(V, c_rest, 0) * drift[u];

INLINE void set_base_lanes(const galerkin_nodes *nodes, int count, const double *c, const double *c_rest,
                           const double *drift, int lanes)
{
    for (int u = 0; u < count; u++) JET_BLOCKS(lanes, BASE, );
}

static void set_base(const galerkin_nodes *nodes, int count, const double *c, const double *c_rest, const double *drift)
{
#define CALL(lanes) set_base_lanes(nodes, count, c, c_rest, drift, lanes)
    FOR_LANES(nodes->lanes, CALL)
#undef CALL
}

const galerkin_loops JET_FOR_ISA(galerkin_loops) = {move, predict, integrate, set_base, &JET_FOR_ISA(lagrangian_loops)};
