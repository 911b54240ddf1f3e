/* nearest.c - Implements nearest.h. */
#include "nearest.h"

_Thread_local bool coefficients_are_nearest;
