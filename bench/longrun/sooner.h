/* sooner.h - the control of the rule that ends the passes: steps of this thread whose passes end as soon as one moves
 * nothing, or is small and moves no less than the one before it. */
#ifndef SOONER_H
#define SOONER_H

#include <stdbool.h>

extern _Thread_local bool passes_end_sooner;

#endif
