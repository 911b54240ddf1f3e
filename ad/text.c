/* text.c - Appends formatted text to a buffer that grows (text.h). */
#include "text.h"

#include <stdio.h>
#include <stdlib.h>

static bool reserve_text(jet_text *text, size_t extra_length)
{
    if (text->is_incomplete) return false;
    if (text->length + extra_length < text->capacity) return true;
    const size_t capacity = 2 * (text->length + extra_length) + 4096;
    char *data = realloc(text->data, capacity);
    text->is_incomplete = !data;
    if (!data) return false;
    text->data = data;
    text->capacity = capacity;
    return true;
}

void jet_text_append_va_list(jet_text *text, const char *format, va_list values)
{
    va_list values_copy;
    va_copy(values_copy, values);
    const int length = vsnprintf(NULL, 0, format, values);
    if (length < 0) text->is_incomplete = true;
    else if (reserve_text(text, (size_t)length + 1))
        text->length += (size_t)vsnprintf(text->data + text->length, (size_t)length + 1, format, values_copy);
    va_end(values_copy);
}

void jet_text_append(jet_text *text, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    jet_text_append_va_list(text, format, values);
    va_end(values);
}
