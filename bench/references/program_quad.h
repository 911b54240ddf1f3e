/* program_quad.h - Declares a recorded function as a list of instructions, each of which computes a power series. */
#ifndef TVI_BENCH_PROGRAM_QUAD_H
#define TVI_BENCH_PROGRAM_QUAD_H

#include "graph.h"
#include "references/recurrences_quad.h"

#include <stddef.h>

typedef struct {
    int series;
    quad coefficient;
} term;

/* Series z from series a and b; the auxiliary series of z follow it. */
typedef struct {
    jet_op op;
    quad number;
    int z, a, b, count;
    term *terms;
} instruction;

typedef struct {
    int count, series, outputs;
    instruction *code;
    int *output; /* [outputs] series */
} quad_program;

/* Allocates zeros; ends the program without memory. */
void *quad_allocate(size_t count, size_t size);
quad *quad_vector(int count);

quad_program quad_compile(const jet_graph *graph, int outputs, const jet output[]);
void quad_release(quad_program *program);
/* Coefficient k of all series, from coefficients 0..k of the inputs; each series has `length` places. */
void quad_run_program(const quad_program *program, quad *all, int length, int k);

#endif
