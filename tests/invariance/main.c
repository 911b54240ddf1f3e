/* main.c - Runs the suites on the same motion in other coordinates, other units, other order, and back. */
#include "invariance.h"
#include "problems/run_suites.h"

static Suite *(*const suites[])(void) = {suite_frames, suite_reversed, suite_numbers,  suite_subsystems, suite_light,
                                         suite_probe,  suite_sizes,    suite_rounding, suite_unguarded};

int main(void) { return RUN_SUITES(suites); }
