/* library.c - Compiles generated text to a shared library, and loads it (library.h). */
#define _XOPEN_SOURCE 700
#include "library.h"

#include <check.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The elementary functions of the library. */
#ifdef JET_SLEEF
#define ELEMENTARY "-DJET_SLEEF -lsleef"
#else
#define ELEMENTARY ""
#endif

static void write_to(const char *path, const jet_text *text)
{
    FILE *file = fopen(path, "w");
    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(fwrite(text->data, 1, text->length, file), text->length);
    ck_assert_int_eq(fclose(file), 0);
}

library library_make(jet_text *text, const char *flags)
{
    library made;
    char source[80], binary[80], command[400];
    ck_assert(!text->is_incomplete);
    strcpy(made.directory, "/tmp/tvi-emit-XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(made.directory));
    snprintf(source, sizeof source, "%s/emit.c", made.directory);
    snprintf(binary, sizeof binary, "%s/emit.so", made.directory);
    write_to(source, text);
    free(text->data);
    snprintf(command, sizeof command, "cc -w %s -fno-math-errno -shared -fPIC -o %s %s " ELEMENTARY " -lm", flags,
             binary, source);
    ck_assert_int_eq(system(command), 0);
    made.handle = dlopen(binary, RTLD_NOW);
    ck_assert_msg(made.handle != NULL, "%s", dlerror());
    return made;
}

void library_remove(library *loaded)
{
    char command[100];
    dlclose(loaded->handle);
    snprintf(command, sizeof command, "rm -r %s", loaded->directory);
    ck_assert_int_eq(system(command), 0);
}
