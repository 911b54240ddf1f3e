/* refusals.h - Declares a call that is refused: its status, and the text of tvi_last_error. */
#ifndef TESTS_PROBLEMS_REFUSALS_H
#define TESTS_PROBLEMS_REFUSALS_H

#include "tvi.h"

void expect_status(const char *what, tvi_status is, tvi_status wanted);
/* The call has the status, and where that is a refusal tvi_last_error is of this call, and names the culprit. */
#define expect_refusal(what, call, wanted, culprit)                                                                    \
    (begin_refusal(), expect_status(what, call, wanted), end_refusal(what, wanted, culprit))
#define expect(what, call, wanted) expect_refusal(what, call, wanted, "")
/* The culprit is what the case is called by. */
#define refused(culprit, call, wanted) expect_refusal(culprit, call, wanted, culprit)
void begin_refusal(void);
void end_refusal(const char *what, tvi_status wanted, const char *culprit);

#endif
