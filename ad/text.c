/* text.c - Appends formatted text to a buffer that grows (text.h). */
#include "text.h"

#include <stdio.h>
#include <stdlib.h>

static bool has_room(jet_text *text, size_t more)
{
    if (text->failed) return false;
    if (text->size + more < text->room) return true;
    const size_t room = 2 * (text->size + more) + 4096;
    char *data = realloc(text->data, room);
    text->failed = !data;
    if (!data) return false;
    text->data = data;
    text->room = room;
    return true;
}

void jet_text_add_list(jet_text *text, const char *format, va_list values)
{
    va_list again;
    va_copy(again, values);
    const int length = vsnprintf(NULL, 0, format, values);
    if (length < 0) text->failed = true;
    else if (has_room(text, (size_t)length + 1))
        text->size += (size_t)vsnprintf(text->data + text->size, (size_t)length + 1, format, again);
    va_end(again);
}

void jet_text_add(jet_text *text, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    jet_text_add_list(text, format, values);
    va_end(values);
}
