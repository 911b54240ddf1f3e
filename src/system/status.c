/* status.c - Returns the text of a status, the library's version, and the text of the last error (tvi_status_string,
 * tvi_version, tvi_last_error). */
#include "system/refuse.h"

#define STATUS_TEXT(code, text) [code] = text,

const char *tvi_status_string(tvi_status status)
{
    static const char *const texts[] = {TVI_STATUS_LIST(STATUS_TEXT)};
    return (unsigned)status < TVI_STATUS_COUNT ? texts[status] : "unknown status";
}

const char *tvi_version(void) { return TVI_VERSION; }

const char *tvi_last_error(void) { return jet_last_refusal_text(); }
