/* rounds.h - the rounds of a pass that knows second derivatives (hamiltonian.c), in the lanes of a block; read by
 * loops.c. They are in single precision, which takes half the time: a pass leaves more than that of its movement, but
 * for the last one, whose movement is roundoff. So that nothing depends on units, movements are relative to the sizes
 * of the unknowns. The first one is by how far the impulses are from those that made the unknowns: so it has the digits
 * of a difference, without the unknowns. */
#ifndef TVI_SRC_GALERKIN_ROUNDS_H
#define TVI_SRC_GALERKIN_ROUNDS_H

#include "algebra/sizes.h"
#include "galerkin/lanes.h"

#include <math.h>
#include <string.h>

enum { MOST_ROUNDS = 32 };
/* They end where the next movement is as small as twice what the first order leaves out; a square, as sizes are. Half
 * of that takes more time, and twice as much more passes. */
#define LEFT_OUT 4
/* That of relative movements, whose squares, from 2^-144 on, are single numbers in it. */
#define UNIT 0x1p-40

typedef float single_jet_v8 __attribute__((vector_size(32), aligned(4), may_alias));
typedef float single_jet_v4 __attribute__((vector_size(16), aligned(4), may_alias));
typedef float single_jet_v2 __attribute__((vector_size(8), aligned(4), may_alias));
typedef float single_jet_v1;
#define SINGLE(V)              single_##V
#define SINGLE_AT(V, array, k) (*(SINGLE(V) *)((array) + (size_t)(k) * (sizeof(SINGLE(V)) / sizeof(float))))
#define SINGLE_OF(V, array, k) (*(const SINGLE(V) *)((array) + (size_t)(k) * (sizeof(SINGLE(V)) / sizeof(float))))

/* From the one precision to the other. */
#define NARROW_jet_v8(x) __builtin_convertvector(x, single_jet_v8)
#define NARROW_jet_v4(x) __builtin_convertvector(x, single_jet_v4)
#define NARROW_jet_v2(x) __builtin_convertvector(x, single_jet_v2)
#define NARROW_jet_v1(x) ((float)(x))
#define WIDEN_jet_v8(x)  __builtin_convertvector(x, jet_v8)
#define WIDEN_jet_v4(x)  __builtin_convertvector(x, jet_v4)
#define WIDEN_jet_v2(x)  __builtin_convertvector(x, jet_v2)
#define WIDEN_jet_v1(x)  ((double)(x))

/* All lanes, in vectors of as many numbers of half the width. */
#define ALL_SINGLE(lanes, BODY)                                                                                        \
    if (lanes % 8 == 0) BODY(jet_v8, (lanes / 8))                                                                      \
    else if (lanes % 4 == 0) BODY(jet_v4, (lanes / 4))                                                                 \
    else if (lanes % 2 == 0) BODY(jet_v2, (lanes / 2))                                                                 \
    else BODY(jet_v1, lanes)

/* BODY(V, blocks, rows) of the groups of rows from `first` on (lanes_group). */
#define GROUPS_OF(V, blocks, BODY, end, group)                                                                         \
    for (; first + (group) <= (end); first += (group)) BODY(V, blocks, group)
#define IN_GROUPS(V, blocks, BODY, end)                                                                                \
    GROUPS_OF(V, blocks, BODY, end, LANES_ROWS)                                                                        \
    GROUPS_OF(V, blocks, BODY, end, 2)                                                                                 \
    GROUPS_OF(V, blocks, BODY, end, 1)

#define PACK_ROWS(V, blocks, group)                                                                                    \
    for (int column = 0; column < count; column++, place += (group), packed += (group)*lanes)                          \
        for (int b = 0; b < (blocks); b++) {                                                                           \
            const V of_column = (scale[unknown[column]] * size[column]) * BLOCK_OF(V, weight, b);                      \
            for (int i = 0; i < (group); i++) {                                                                        \
                const V by = per_size[first + i] * of_column;                                                          \
                SINGLE_AT(V, packed + i * lanes, b) = NARROW_##V(by * BLOCK_OF(V, second + place[i], b));              \
            }                                                                                                          \
        }
#define PACK(V, blocks)                                                                                                \
    {                                                                                                                  \
        int first = 0;                                                                                                 \
        IN_GROUPS(V, blocks, PACK_ROWS, rounds->moving)                                                                \
        IN_GROUPS(V, blocks, PACK_ROWS, rounds->rows)                                                                  \
    }

/* What drives a row by the movement of a column, from the second derivatives. The scale of an unknown is a sign, which
 * the movements of the rounds have in their unit. */
JET_INLINE void pack_second(const galerkin_nodes *nodes, const lanes_rounds *rounds, int lanes)
{
    const double *second = rounds->second, *weight = nodes->weight, *scale = nodes->scale;
    const double *size = rounds->size, *per_size = rounds->per_size;
    const int *unknown = rounds->unknown, *place = rounds->place;
    float *packed = rounds->packed;
    const int count = rounds->count;
    ALL_LANES(lanes, PACK)
}

#define DRIVE_ROWS(V, blocks, group)                                                                                   \
    {                                                                                                                  \
        SINGLE(V) sum[group][MOST_BLOCKS];                                                                             \
        for (int i = 0; i < (group); i++)                                                                              \
            for (int b = 0; b < (blocks); b++) sum[i][b] = (SINGLE(V)){0};                                             \
        for (int column = 0; column < count; column++)                                                                 \
            for (int i = 0; i < (group); i++, packed += lanes)                                                         \
                for (int b = 0; b < (blocks); b++)                                                                     \
                    sum[i][b] += SINGLE_OF(V, packed, b) * SINGLE_OF(V, change + column * lanes, b);                   \
        for (int i = 0; i < (group); i++, out += lanes)                                                                \
            for (int b = 0; b < (blocks); b++) SINGLE_AT(V, out, b) = sum[i][b];                                       \
    }
#define DRIVE_SINGLE(V, blocks)                                                                                        \
    {                                                                                                                  \
        int first = 0;                                                                                                 \
        IN_GROUPS(V, blocks, DRIVE_ROWS, rounds->moving)                                                               \
        const int end = all ? rounds->rows : first;                                                                    \
        IN_GROUPS(V, blocks, DRIVE_ROWS, end)                                                                          \
    }

/* The impulses by a change, of all rows or of those that move. */
JET_INLINE void drive_rows(const lanes_rounds *rounds, const float *change, bool all, float *out, int lanes)
{
    const int count = rounds->count;
    const float *packed = rounds->packed;
    ALL_SINGLE(lanes, DRIVE_SINGLE)
}

#define CHANGE(V, blocks)                                                                                              \
    {                                                                                                                  \
        SINGLE(V) squares = {0}, row[TVI_GALERKIN_MAX_LANES];                                                          \
        float parts[sizeof squares / sizeof(float)];                                                                   \
        for (int j = 0; j < ((blocks) == 1 ? lanes : 0); j++)                                                          \
            row[j] = SINGLE_OF(V, a + j * lanes, 0) + (SINGLE(V)){0};                                                  \
        for (int i = 0; i < rounds->count; i++, impulse += lanes, change += lanes, total += lanes) {                   \
            for (int b = 0; b < (blocks); b++) {                                                                       \
                SINGLE(V) sum[CHAINS] = {0};                                                                           \
                for (int j = 0; j < lanes; j++)                                                                        \
                    sum[j % CHAINS] += ((blocks) == 1 ? row[j] : SINGLE_OF(V, a + j * lanes, b)) * impulse[j];         \
                sum[0] = (sum[0] + sum[1]) + (sum[2] + sum[3]);                                                        \
                squares += sum[0] * sum[0];                                                                            \
                SINGLE_AT(V, change, b) = sum[0];                                                                      \
                SINGLE_AT(V, total, b) += sum[0];                                                                      \
            }                                                                                                          \
        }                                                                                                              \
        SINGLE_AT(V, parts, 0) = squares;                                                                              \
        for (size_t half = sizeof parts / sizeof *parts / 2; half > 0; half /= 2)                                      \
            for (size_t i = 0; i < half; i++) parts[i] += parts[i + half];                                             \
        moved = (double)parts[0];                                                                                      \
    }

/* The change by the impulses, and `total` += it; the sum of its squares. */
JET_INLINE double change_by_impulses(const lanes_rounds *rounds, int lanes)
{
    const float *impulse = rounds->impulse, *a = rounds->matrix;
    float *change = rounds->change, *total = rounds->total;
    double moved = 0;
    LEAVE_REGISTERS(impulse);
    ALL_SINGLE(lanes, CHANGE)
    return moved;
}

#define NARROW(V, blocks)                                                                                              \
    for (int i = 0; i < rounds->count; i++) {                                                                          \
        const int u = rounds->unknown[i];                                                                              \
        const double *drive = drives + slot[u] * lanes, *old = nodes->impulse + u * lanes;                             \
        const double by = rounds->per_size[i] / UNIT;                                                                  \
        for (int b = 0; b < (blocks); b++) {                                                                           \
            const V impulse = BLOCK_OF(V, nodes->weight, b) * BLOCK_OF(V, drive, b);                                   \
            SINGLE_AT(V, rounds->impulse + i * lanes, b) = NARROW_##V(by * (impulse - BLOCK_OF(V, old, b)));           \
            SINGLE_AT(V, rounds->total + i * lanes, b) = (SINGLE(V)){0};                                               \
        }                                                                                                              \
    }

#define WIDEN(V, blocks)                                                                                               \
    for (int i = 0; i < rounds->rows; i++)                                                                             \
        for (int b = 0; b < (blocks); b++)                                                                             \
            BLOCK_AT(V, changes + rounds->unknown[i] * lanes, b) =                                                     \
                UNIT * rounds->size[i] * WIDEN_##V(SINGLE_OF(V, rounds->all + i * lanes, b));

JET_INLINE void go_round_lanes(const galerkin_nodes *nodes, const lanes_rounds *rounds, const double *drives,
                               const int slot[], bool is_new, double moved, double least, double *changes, int lanes)
{
    double before = INFINITY, earlier;
    int turn = 0;
    if (is_new) pack_second(nodes, rounds, lanes);
    ALL_LANES(lanes, NARROW)
    const double first = UNIT * UNIT * change_by_impulses(rounds, lanes);
    const double left_out = LEFT_OUT * first * (is_new ? first : moved) / (nodes->unknowns * lanes);
    const double last = tvi_larger(left_out, least);
    double now = first;
    do {
        earlier = before;
        before = now;
        drive_rows(rounds, rounds->change, false, rounds->impulse, lanes);
        now = UNIT * UNIT * change_by_impulses(rounds, lanes);
    } while (++turn < MOST_ROUNDS && (now * now > last * before || now * before > last * earlier) &&
             (now < before || now < earlier));
    drive_rows(rounds, rounds->total, true, rounds->all, lanes);
    if (now <= first) ALL_LANES(lanes, WIDEN)
    else memset(changes, 0, (size_t)(nodes->unknowns * lanes) * sizeof *changes);
}

#endif
