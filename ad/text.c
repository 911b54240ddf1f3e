/* text.c - Formats text in the same way in every locale, and appends it to a buffer that grows (text.h). */
#define _POSIX_C_SOURCE 200809L /* This makes locale.h declare newlocale and uselocale. */
#include "text.h"

#include <locale.h>
#include <stdio.h>
#include <stdlib.h>

/* Only this thread's locale changes, and only during the call. The C library has the locale "C" as a constant, so that
 * newlocale and freelocale allocate and free nothing. */
int jet_format_va_list(char *text, size_t capacity, const char *format, va_list values)
{
    const locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0), callers = uselocale(c);
    const int length = vsnprintf(text, capacity, format, values);
    (void)uselocale(callers);
    if (c) freelocale(c);
    return length;
}

int jet_format(char *text, size_t capacity, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    const int length = jet_format_va_list(text, capacity, format, values);
    va_end(values);
    return length;
}

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
    const int length = jet_format_va_list(NULL, 0, format, values);
    if (length < 0) text->is_incomplete = true;
    else if (reserve_text(text, (size_t)length + 1))
        text->length += (size_t)jet_format_va_list(text->data + text->length, (size_t)length + 1, format, values_copy);
    va_end(values_copy);
}

void jet_text_append(jet_text *text, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    jet_text_append_va_list(text, format, values);
    va_end(values);
}
