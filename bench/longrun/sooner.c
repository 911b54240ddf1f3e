/* sooner.c - Implements sooner.h. */
#include "sooner.h"

_Thread_local bool passes_end_sooner;
