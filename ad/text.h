/* text.h - Appends formatted text to a buffer that grows. The writers of generated code call it: emit.c, src/compiled/,
 * src/galerkin/ and src/generating/. */
#ifndef TVI_AD_TEXT_H
#define TVI_AD_TEXT_H

#include "compiler.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

/* A text that grows; sizes in bytes. */
typedef struct {
    char *data; /* The text, which ends with 0 and is freed by the caller; NULL: the text is empty. */
    size_t length, capacity;
    bool is_incomplete; /* Memory was lacking, and some appended text is missing. */
} jet_text;

void jet_text_append(jet_text *text, const char *format, ...) JET_FORMAT(2, 3);
void jet_text_append_va_list(jet_text *text, const char *format, va_list values) JET_FORMAT(2, 0);

#endif
