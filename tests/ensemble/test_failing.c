#include "ensemble.h"
Suite *suite_failing(void) { return suite_create("failing"); }
