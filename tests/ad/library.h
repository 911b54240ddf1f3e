/* library.h - Declares generated text as a shared library. */
#ifndef TVI_TESTS_AD_LIBRARY_H
#define TVI_TESTS_AD_LIBRARY_H

#include "text.h"

typedef struct {
    void *handle; /* for dlsym */
    char directory[64];
} library;

/* Compiled with the flags; frees the text. */
library library_make(jet_text *text, const char *flags);
void library_remove(library *loaded);

#endif
