/* text.h - Formats all text that the library writes, in the same way in every locale: numbers have a decimal point,
 * even if the program's locale has a comma. Writers of generated code append text to a buffer that grows. */
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

/* These do what snprintf and vsnprintf do in the locale "C". No other file calls the printf functions. */
int jet_format(char *text, size_t capacity, const char *format, ...) JET_FORMAT(3, 4);
int jet_format_va_list(char *text, size_t capacity, const char *format, va_list values) JET_FORMAT(3, 0);

void jet_text_append(jet_text *text, const char *format, ...) JET_FORMAT(2, 3);
void jet_text_append_va_list(jet_text *text, const char *format, va_list values) JET_FORMAT(2, 0);

#endif
