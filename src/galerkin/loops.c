/* loops.c - see galerkin.h. */
#include "galerkin/lanes.h"
#include "rule.h"
#include "method/stepper.h"
#include "vector.h"

#include <stddef.h>

#define VECTOR(V, array, index)    (*(V *)((array) + (size_t)(index) * (size_t)lanes + here))
#define OF_VECTOR(V, array, index) (*(const V *)((array) + (size_t)(index) * (size_t)lanes + here))

/* In halves, which wait less for each other. */
JET_INLINE double sum_of(const double x[], size_t count)
{
    double sum[8];
    for (size_t i = 0; i < count; i++) sum[i] = x[i];
    for (size_t half = count / 2; half > 0; half /= 2)
        for (size_t i = 0; i < half; i++) sum[i] += sum[i + half];
    return sum[0];
}

/* even + odd = sum_j (row j of the matrix) impulse_j for all lanes: chains that do not wait for each other. */
#define SET_PRODUCT(V, blocks, matrix, impulse)                                                                        \
    V even[MOST_BLOCKS], odd[MOST_BLOCKS] = {0};                                                                       \
    for (int k = 0; k < (blocks); k++) even[k] = BLOCK_OF(V, matrix, k) * (impulse)[0];                                \
    for (int k = 0; k < (blocks) && lanes > 1; k++) odd[k] = BLOCK_OF(V, (matrix) + lanes, k) * (impulse)[1];          \
    ADD_PRODUCT(V, blocks, matrix, impulse, 2)

#define ADD_PRODUCT(V, blocks, matrix, impulse, from)                                                                  \
    for (int j = (from); j < lanes; j++)                                                                               \
        for (int k = 0; k < (blocks); k++)                                                                             \
            (j % 2 ? odd : even)[k] += BLOCK_OF(V, (matrix) + j * lanes, k) * (impulse)[j];

#define MOVE(V, blocks)                                                                                                \
    {                                                                                                                  \
        V squares = {0};                                                                                               \
        for (int u = 0; u < unknowns; u++, x += lanes, base += lanes, impulse += lanes) {                              \
            const double *drive = drives + (size_t)slot[u] * (size_t)lanes;                                            \
            for (int k = 0; k < (blocks); k++)                                                                         \
                BLOCK_AT(V, impulse, k) = BLOCK_OF(V, weight, k) * BLOCK_OF(V, drive, k);                              \
            SET_PRODUCT(V, blocks, matrix, impulse)                                                                    \
            for (int k = 0; k < (blocks); k++) {                                                                       \
                const V place = start[u] + (BLOCK_OF(V, base, k) + scale[u] * (even[k] + odd[k]));                     \
                const V change = (place - BLOCK_OF(V, x, k)) * inverse_size[u];                                        \
                squares += change * change;                                                                            \
                BLOCK_AT(V, x, k) = place;                                                                             \
            }                                                                                                          \
        }                                                                                                              \
        sum = sum_of((const double *)&squares, sizeof squares / sizeof(double));                                       \
    }

JET_INLINE double move_lanes(const galerkin_nodes *nodes, const double *matrix, const double *drives, const int slot[],
                             int lanes)
{
    const double *start = nodes->start, *base = nodes->base, *scale = nodes->scale, *inverse_size = nodes->inverse_size,
                 *weight = nodes->weight;
    const int unknowns = nodes->unknowns;
    double *x = nodes->x, *impulse = nodes->impulse, sum = 0;
    ALL_LANES(lanes, MOVE)
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

#define PREDICT(V, blocks)                                                                                             \
    for (int u = 0; u < unknowns; u++, x += lanes, base += lanes, last += lanes, before += lanes) {                    \
        SET_PRODUCT(V, blocks, matrix, last)                                                                           \
        if (steps > 1) ADD_PRODUCT(V, blocks, matrix + lanes * lanes, before, 0)                                       \
        for (int k = 0; k < (blocks); k++)                                                                             \
            BLOCK_AT(V, x, k) = start[u] + (BLOCK_OF(V, base, k) + scale[u] * (even[k] + odd[k]));                     \
    }

JET_INLINE void predict_lanes(const galerkin_nodes *nodes, int steps, const double *matrix,
                              const double *const impulses[], int lanes)
{
    const double *start = nodes->start, *base = nodes->base, *scale = nodes->scale;
    const double *last = impulses[0], *before = impulses[steps - 1];
    const int unknowns = nodes->unknowns;
    double *x = nodes->x;
    ALL_LANES(lanes, PREDICT)
}

static void predict(const galerkin_nodes *nodes, int steps, const double *matrix, const double *const impulses[]){
#define CALL(lanes)                                                                                                    \
    steps == 2 ? predict_lanes(nodes, 2, matrix, impulses, lanes) : predict_lanes(nodes, 1, matrix, impulses, lanes)
    FOR_LANES(nodes->lanes, CALL)
#undef CALL
}

/* Two-sums: what each addition loses is collected. */
#define SUM(V, S)                                                                                                      \
    {                                                                                                                  \
        V total = {0}, lost = {0};                                                                                     \
        for (int j = 0; j < lanes; j++) {                                                                              \
            const V term = *(const V *)(factor + j * SUMS + here) * impulse[j];                                        \
            const V next = total + term, added = next - total;                                                         \
            lost += (total - (next - added)) + (term - added);                                                         \
            total = next;                                                                                              \
        }                                                                                                              \
        *(V *)(sum + u * SUMS + here) = total + lost;                                                                  \
    }

JET_INLINE void integrate_lanes(const galerkin_nodes *nodes, const double *factor, double *sum, int lanes)
{
    for (int u = 0; u < nodes->unknowns; u++) {
        const double *impulse = nodes->impulse + u * lanes;
        JET_BLOCKS(SUMS, SUM, );
    }
}

static void integrate(const galerkin_nodes *nodes, const double *factor, double *sum){
#define CALL(lanes) integrate_lanes(nodes, factor, sum, lanes)
    FOR_LANES(nodes->lanes, CALL)
#undef CALL
}

#define BASE(V, S)                                                                                                     \
    VECTOR(V, nodes->base, u) = (low[u] + OF_VECTOR(V, c, 0) * drift_low[u]) + OF_VECTOR(V, c, 0) * drift[u];

JET_INLINE void set_base_lanes(const galerkin_nodes *nodes, const double *c, const double *low, const double *drift,
                               const double *drift_low, int lanes)
{
    for (int u = 0; u < nodes->unknowns; u++) JET_BLOCKS(lanes, BASE, );
}

static void set_base(const galerkin_nodes *nodes, const double *c, const double *low, const double *drift,
                     const double *drift_low)
{
#define CALL(lanes) set_base_lanes(nodes, c, low, drift, drift_low, lanes)
    FOR_LANES(nodes->lanes, CALL)
#undef CALL
}

#define PLACE(V, S)                                                                                                    \
    {                                                                                                                  \
        const V theta = *(const V *)(p->theta + here);                                                                 \
        V row[TVI_GALERKIN_MAX_LANES];                                                                                 \
        for (int j = 0; j < lanes; j++) row[j] = *(const V *)(table + j * places + here);                              \
        for (int u = 0; u < count; u++) {                                                                              \
            V sums[CHAINS] = {0};                                                                                      \
            for (int j = 0; j < lanes; j++)                                                                            \
                sums[j % CHAINS] += row[j] * impulses[(size_t)u * (size_t)lanes + (size_t)j];                          \
            *(V *)(out + u * places + here) = start[u] + (theta * drift[u] + scale[u] * TOTAL(sums));                  \
        }                                                                                                              \
    }

enum { CHAINS = 4 };
#define TOTAL(sum) ((sum[0] + sum[1]) + (sum[2] + sum[3]))

JET_INLINE void place_lanes(const galerkin_places *p, const double *table, const double *impulses, double *restrict out,
                            int lanes, int places)
{
    const double *start = p->start, *drift = p->drift, *scale = p->scale;
    const int count = p->count;
    JET_BLOCKS(places, PLACE, );
}

static void place(const galerkin_places *p, const double *table, const double *impulses, double *out)
{
#define CALL(lanes)                                                                                                    \
    p->places == TVI_SAMPLES ? place_lanes(p, table, impulses, out, lanes, TVI_SAMPLES)                                \
                             : place_lanes(p, table, impulses, out, lanes, p->places)
    FOR_LANES(p->lanes, CALL)
#undef CALL
}

const galerkin_loops JET_FOR_ISA(tvi_galerkin_loops) = {move,     predict, integrate,
                                                        set_base, place,   &JET_FOR_ISA(tvi_lagrangian_loops)};
