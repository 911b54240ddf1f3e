/* emit_cubes.h - products of something with its square, in generated code: the force of a quartic potential. Their
 * tangents need none of the square, and a third of the products. */
#ifndef TVI_AD_EMIT_CUBES_H
#define TVI_AD_EMIT_CUBES_H

#include "tape.h"

/* Products of multiples of something with squares of multiples of it: which factors are the squares. */
typedef enum { JET_NO_CUBES, JET_SQUARES_FIRST, JET_SQUARES_SECOND } jet_cubes;
jet_cubes jet_are_cubes(const jet_tape *tape, const jet_run *run);

/* Squares that nothing else reads, and that are no outputs. */
bool jet_are_bases(const jet_tape *tape, const jet_run *run);

#endif
