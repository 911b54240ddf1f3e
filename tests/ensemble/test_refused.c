#include "ensemble.h"
Suite *suite_refused(void) { return suite_create("refused"); }
