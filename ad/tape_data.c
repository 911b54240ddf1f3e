/* tape_data.c - Frees and hashes the arrays of a tape, and sets the constants and parameters in its blocks, the arrays
 * of numbers on which it works (tape.h). */
#include "tape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One array of a tape. */
typedef struct {
    void *data;
    size_t hashed_byte_count; /* Number of bytes that the sweeps read, and that are hashed. */
} tape_array;

/* The number of arrays of a tape. */
enum { TAPE_ARRAYS = 10 };
_Static_assert(sizeof(jet_run_of_operations) == 9 * sizeof(int) + 2 * sizeof(short) + sizeof(double),
               "A run, whose bytes are hashed, has no gaps.");
/* Lists all arrays of a tape. jet_tape_free frees them, and jet_tape_continue_hash hashes them. */
static void list_tape_arrays(const jet_tape *tape, tape_array list[TAPE_ARRAYS])
{
    const size_t terms = (size_t)tape->terms.count;
    const tape_array all[TAPE_ARRAYS] = {
        {tape->runs, (size_t)tape->run_count * sizeof *tape->runs},
        {tape->constant_values, (size_t)tape->constant_count * sizeof *tape->constant_values},
        {tape->parameters, (size_t)tape->parameter_count * sizeof *tape->parameters},
        {tape->constant_terms, (size_t)tape->linear_operation_count * sizeof *tape->constant_terms},
        {tape->terms.slot, terms * sizeof *tape->terms.slot},
        {tape->terms.slot_b, terms * sizeof *tape->terms.slot_b},
        {tape->terms.coefficient, terms * sizeof *tape->terms.coefficient},
        {tape->output_slot, (size_t)tape->output_count * sizeof *tape->output_slot},
        {tape->refusal.number_of_slot, 0},
        {tape->refusal.owner_of_slot, 0},
    };
    memcpy(list, all, sizeof all);
}

void jet_tape_write_constants(const jet_tape *tape, double *block, int order_count, int lanes)
{
    const size_t given = (size_t)(tape->input_count + tape->constant_count) * (size_t)lanes;
    const size_t all = (size_t)tape->slot_count * (size_t)lanes;
    for (size_t at = 0; at < (size_t)order_count * all; at++) block[at] = at % all < given ? 0 : NAN;
    for (int i = 0; i < tape->constant_count; i++)
        for (int lane = 0; lane < lanes; lane++)
            block[(tape->input_count + i) * lanes + lane] = tape->constant_values[i];
}

double *jet_tape_create_block(const jet_tape *tape, int lanes)
{
    double *block = malloc((size_t)tape->slot_count * (size_t)lanes * sizeof *block);
    if (block) jet_tape_write_constants(tape, block, 1, lanes);
    return block;
}

void jet_tape_set_parameters(const jet_tape *tape, double *block, int lanes, int parameter_count,
                             int values_per_parameter, const double value[])
{
    for (const jet_tape_parameter *it = tape->parameters; it < tape->parameters + tape->parameter_count; it++)
        for (int lane = 0; it->parameter_index < parameter_count && lane < lanes; lane++)
            block[it->slot * lanes + lane] =
                value[it->parameter_index * values_per_parameter + lane % values_per_parameter];
}

void jet_tape_read_parameters(const jet_tape *tape, const double *block, int lanes, int lane, double value[])
{
    for (const jet_tape_parameter *it = tape->parameters; it < tape->parameters + tape->parameter_count; it++)
        value[it->parameter_index] = block[it->slot * lanes + lane];
}

bool jet_tape_is_slot_always_zero(const jet_tape *tape, int slot)
{
    const int which = slot - tape->input_count;
    bool is_zero = which >= 0 && which < tape->constant_count && tape->constant_values[which] == 0;
    for (int i = 0; i < tape->parameter_count; i++) is_zero = is_zero && tape->parameters[i].slot != slot;
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

uint64_t jet_continue_hash(uint64_t hash, const void *data, size_t byte_count)
{
    const unsigned char *byte = data;
    /* The caller has set all bytes of the data. NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult) */
    for (size_t i = 0; i < byte_count; i++) hash = (hash ^ byte[i]) * UINT64_C(0x100000001b3);
    return hash;
}

uint64_t jet_tape_continue_hash(uint64_t hash, const jet_tape *tape)
{
    if (!tape) return jet_continue_hash(hash, "", 1);
    const int counts[] = {tape->input_count, tape->constant_count,         tape->parameter_count, tape->slot_count,
                          tape->run_count,   tape->linear_operation_count, tape->terms.count,     tape->output_count};
    hash = jet_continue_hash(hash, counts, sizeof counts);
    tape_array list[TAPE_ARRAYS];
    list_tape_arrays(tape, list);
    for (int i = 0; i < TAPE_ARRAYS; i++) hash = jet_continue_hash(hash, list[i].data, list[i].hashed_byte_count);
    return hash;
}
