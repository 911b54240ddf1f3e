/* text.h - Appends formatted text to a buffer that grows. */
#ifndef TVI_AD_TEXT_H
#define TVI_AD_TEXT_H

#include "compiler.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

typedef struct {
    char *data; /* ends with 0; NULL: nothing yet. Freed by the caller */
    size_t size, room;
    bool failed; /* memory was lacking, and text is lost */
} jet_text;

void jet_text_add(jet_text *text, const char *format, ...) JET_FORMAT(2, 3);
void jet_text_add_list(jet_text *text, const char *format, va_list values) JET_FORMAT(2, 0);

#endif
