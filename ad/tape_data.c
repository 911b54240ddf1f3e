/* tape_data.c - Frees, copies and hashes the arrays of a tape. */
#include "tape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    void *data;
    size_t bytes; /* in use, that the sweeps read */
} array;

/* Lists all arrays except that of the runs, to free and to hash them. An array that is left out leaks. */
enum { ARRAYS = 8 };
static void list_arrays(const jet_tape *tape, array list[ARRAYS])
{
    const size_t terms = (size_t)tape->terms;
    const array all[ARRAYS] = {
        {tape->constant, (size_t)tape->constants * sizeof *tape->constant},
        {tape->parameter, (size_t)tape->parameters * sizeof *tape->parameter},
        {tape->base, (size_t)tape->rows * sizeof *tape->base},
        {tape->term_slot, terms * sizeof *tape->term_slot},
        {tape->term_operand_b, terms * sizeof *tape->term_operand_b},
        {tape->term_coefficient, terms * sizeof *tape->term_coefficient},
        {tape->output, (size_t)tape->outputs * sizeof *tape->output},
        {tape->recorded, 0},
    };
    memcpy(list, all, sizeof all);
}

void jet_tape_prepare(const jet_tape *tape, double *x, int orders, int lanes)
{
    const size_t given = (size_t)(tape->inputs + tape->constants) * (size_t)lanes;
    const size_t all = (size_t)tape->slots * (size_t)lanes;
    for (size_t at = 0; at < (size_t)orders * all; at++) x[at] = at % all < given ? 0 : NAN;
    for (int i = 0; i < tape->constants; i++)
        for (int lane = 0; lane < lanes; lane++) x[(tape->inputs + i) * lanes + lane] = tape->constant[i];
}

void jet_tape_set_parameters(const jet_tape *tape, double *x, int lanes, int count, int width, const double value[])
{
    for (const jet_tape_parameter *it = tape->parameter; it < tape->parameter + tape->parameters; it++)
        for (int lane = 0; it->which < count && lane < lanes; lane++)
            x[it->slot * lanes + lane] = value[it->which * width + lane % width];
}

void jet_tape_read_parameters(const jet_tape *tape, const double *x, int lanes, int lane, double value[])
{
    for (const jet_tape_parameter *it = tape->parameter; it < tape->parameter + tape->parameters; it++)
        value[it->which] = x[it->slot * lanes + lane];
}

bool jet_tape_is_zero(const jet_tape *tape, int slot)
{
    const int which = slot - tape->inputs;
    bool is_zero = which >= 0 && which < tape->constants && tape->constant[which] == 0;
    for (int i = 0; i < tape->parameters; i++) is_zero = is_zero && tape->parameter[i].slot != slot;
    return is_zero;
}

void jet_tape_free(jet_tape *tape)
{
    if (!tape) return;
    array list[ARRAYS];
    list_arrays(tape, list);
    for (int i = 0; i < ARRAYS; i++) free(list[i].data);
    free(tape->run);
    free(tape);
}

uint64_t jet_hash(uint64_t so_far, const void *data, size_t bytes)
{
    const unsigned char *byte = data;
    /* the caller states the bytes. NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult) */
    for (size_t i = 0; i < bytes; i++) so_far = (so_far ^ byte[i]) * UINT64_C(0x100000001b3);
    return so_far;
}

/* Lists the fields of a run in their order, as a run has gaps between them. The compiler reports one that is left out
 * as a missing initialiser. `together` and `fresh` follow from them. */
#define RUN_FIELDS(ROW)                                                                                                \
    ROW(op)                                                                                                            \
    ROW(count)                                                                                                         \
    ROW(z)                                                                                                             \
    ROW(a)                                                                                                             \
    ROW(b)                                                                                                             \
    ROW(w)                                                                                                             \
    ROW(c)                                                                                                             \
    ROW(has_numbers)                                                                                                   \
    ROW(first)                                                                                                         \
    ROW(terms)                                                                                                         \
    ROW(term)                                                                                                          \
    ROW(is_scattered)
#define VALUE(field) run->field,
#define HASH(field)  so_far = jet_hash(so_far, &copy.field, sizeof copy.field);

static uint64_t hash_run(uint64_t so_far, const jet_run *run)
{
    const jet_run copy = {RUN_FIELDS(VALUE) run->together, run->fresh};
    RUN_FIELDS(HASH)
    return so_far;
}

uint64_t jet_tape_hash(uint64_t so_far, const jet_tape *tape)
{
    if (!tape) return jet_hash(so_far, "", 1);
    const int counts[] = {tape->inputs, tape->constants, tape->parameters, tape->slots,
                          tape->runs,   tape->rows,      tape->terms,      tape->outputs};
    so_far = jet_hash(so_far, counts, sizeof counts);
    for (int i = 0; i < tape->runs; i++) so_far = hash_run(so_far, &tape->run[i]);
    array list[ARRAYS];
    list_arrays(tape, list);
    for (int i = 0; i < ARRAYS; i++) so_far = jet_hash(so_far, list[i].data, list[i].bytes);
    return so_far;
}
