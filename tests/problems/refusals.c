/* refusals.c - Implements refusals.h. */
#include "refusals.h"

#include <check.h>
#include <string.h>

void expect_status(const char *what, tvi_status is, tvi_status wanted)
{
    ck_assert_msg(is == wanted, "%s: %s instead of %s", what, tvi_status_string(is), tvi_status_string(wanted));
}

/* The text is then that of a refusal before. */
enum { BEFORE = -12345 };
void begin_refusal(void)
{
    tvi_event *event;
    ck_assert_int_eq(tvi_event_create(&event, BEFORE, TVI_EITHER, false, NULL, NULL), TVI_EINVAL);
    ck_assert_ptr_nonnull(strstr(tvi_last_error(), "n = -12345"));
}

void end_refusal(const char *what, tvi_status wanted, const char *culprit)
{
    const char *const text = tvi_last_error();
    if (wanted == TVI_OK || wanted == TVI_ESTOPPED) return;
    ck_assert_msg(*text && !strstr(text, "n = -12345"), "%s: no text", what);
    ck_assert_msg(strstr(text, culprit), "%s: \"%s\" does not name %s", what, text, culprit);
}
