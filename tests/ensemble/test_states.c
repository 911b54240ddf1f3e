#include "ensemble.h"
Suite *suite_states(void) { return suite_create("states"); }
