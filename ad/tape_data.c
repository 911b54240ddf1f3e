/* tape_data.c - Frees and hashes the arrays of a tape, and sets constants and parameters in its blocks (tape.h). */
#include "tape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One array of a tape. */
typedef struct {
    void *data;
    size_t hashed_bytes; /* Number of bytes that the sweeps read, and that are hashed. */
} tape_array;

/* Lists all arrays of a tape, to free and to hash them. An array that is left out would never be freed. */
enum { TAPE_ARRAYS = 9 };
_Static_assert(sizeof(jet_run) == 9 * sizeof(int) + 2 * sizeof(short) + sizeof(double),
               "A run, whose bytes are hashed, has no gaps.");
static void list_tape_arrays(const jet_tape *tape, tape_array list[TAPE_ARRAYS])
{
    const size_t terms = (size_t)tape->terms;
    const tape_array all[TAPE_ARRAYS] = {
        {tape->run, (size_t)tape->runs * sizeof *tape->run},
        {tape->constant_values, (size_t)tape->constants * sizeof *tape->constant_values},
        {tape->parameter, (size_t)tape->parameters * sizeof *tape->parameter},
        {tape->constant_terms, (size_t)tape->linear_operations * sizeof *tape->constant_terms},
        {tape->term_slot, terms * sizeof *tape->term_slot},
        {tape->term_operand_b, terms * sizeof *tape->term_operand_b},
        {tape->term_coefficient, terms * sizeof *tape->term_coefficient},
        {tape->output_slot, (size_t)tape->outputs * sizeof *tape->output_slot},
        {tape->recording_index, 0},
    };
    memcpy(list, all, sizeof all);
}

void jet_tape_prepare_block(const jet_tape *tape, double *x, int orders, int lanes)
{
    const size_t given = (size_t)(tape->inputs + tape->constants) * (size_t)lanes;
    const size_t all = (size_t)tape->slots * (size_t)lanes;
    for (size_t at = 0; at < (size_t)orders * all; at++) x[at] = at % all < given ? 0 : NAN;
    for (int i = 0; i < tape->constants; i++)
        for (int lane = 0; lane < lanes; lane++) x[(tape->inputs + i) * lanes + lane] = tape->constant_values[i];
}

void jet_tape_set_parameters(const jet_tape *tape, double *x, int lanes, int parameter_count, int values_each,
                             const double value[])
{
    for (const jet_tape_parameter *it = tape->parameter; it < tape->parameter + tape->parameters; it++)
        for (int lane = 0; it->parameter_index < parameter_count && lane < lanes; lane++)
            x[it->slot * lanes + lane] = value[it->parameter_index * values_each + lane % values_each];
}

void jet_tape_read_parameters(const jet_tape *tape, const double *x, int lanes, int lane, double value[])
{
    for (const jet_tape_parameter *it = tape->parameter; it < tape->parameter + tape->parameters; it++)
        value[it->parameter_index] = x[it->slot * lanes + lane];
}

bool jet_tape_is_slot_always_zero(const jet_tape *tape, int slot)
{
    const int which = slot - tape->inputs;
    bool is_zero = which >= 0 && which < tape->constants && tape->constant_values[which] == 0;
    for (int i = 0; i < tape->parameters; i++) is_zero = is_zero && tape->parameter[i].slot != slot;
    return is_zero;
}

void jet_tape_free(jet_tape *tape)
{
    if (!tape) return;
    tape_array list[TAPE_ARRAYS];
    list_tape_arrays(tape, list);
    for (int i = 0; i < TAPE_ARRAYS; i++) free(list[i].data);
    free(tape);
}

uint64_t jet_hash(uint64_t hash, const void *data, size_t bytes)
{
    const unsigned char *byte = data;
    /* The caller states the number of bytes. NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult) */
    for (size_t i = 0; i < bytes; i++) hash = (hash ^ byte[i]) * UINT64_C(0x100000001b3);
    return hash;
}

uint64_t jet_tape_hash(uint64_t hash, const jet_tape *tape)
{
    if (!tape) return jet_hash(hash, "", 1);
    const int counts[] = {tape->inputs, tape->constants,         tape->parameters, tape->slots,
                          tape->runs,   tape->linear_operations, tape->terms,      tape->outputs};
    hash = jet_hash(hash, counts, sizeof counts);
    tape_array list[TAPE_ARRAYS];
    list_tape_arrays(tape, list);
    for (int i = 0; i < TAPE_ARRAYS; i++) hash = jet_hash(hash, list[i].data, list[i].hashed_bytes);
    return hash;
}
