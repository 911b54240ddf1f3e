/* loops.c - Compiles the loops of loops.h from kernel.h, once for each number of lanes. */
#include "algebra/sizes.h"
#include "algebra/tail.h"
#include "galerkin/lanes.h"

#include <math.h>

#define LANES 1
#include "galerkin/kernel.h"
#include "galerkin/kernel_table.h"
#undef LANES
#define LANES 2
#include "galerkin/kernel.h"
#include "galerkin/kernel_table.h"
#undef LANES
#define LANES 4
#include "galerkin/kernel.h"
#include "galerkin/kernel_table.h"
#undef LANES
#define LANES 8
#include "galerkin/kernel.h"
#include "galerkin/kernel_table.h"
#undef LANES
#define LANES 12
#include "galerkin/kernel.h"
#include "galerkin/kernel_table.h"
#undef LANES

const galerkin_kernels *const JET_FOR_ISA(tvi_galerkin_kernels)[GALERKIN_KERNEL_TABLE_COUNT] = {
    &kernels_1, &kernels_2, &kernels_4, &kernels_8, &kernels_12};
