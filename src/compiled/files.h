/* files.h - the files of generated code, and the compiler: all that asks the operating system for anything. */
#ifndef TVI_SRC_COMPILED_FILES_H
#define TVI_SRC_COMPILED_FILES_H

#include <stdbool.h>
#include <stddef.h>

/* A new file, or what is there anew. */
bool tvi_file_write(const char *path, const void *data, size_t size);
bool tvi_file_append(const char *path, const void *data, size_t size);
/* All of a file that is the user's own, and no link; to be freed, and ends with 0. NULL: there is none. */
char *tvi_file_read(const char *path, size_t *size);

/* Closed to others, whatever the umask has made of it. */
bool tvi_file_claim(const char *path);

/* Makes the directory where there is none, and those above it. Whether it belongs to the user, no other may write to
 * it, and none may put another one in its place. */
bool tvi_directory_make(const char *path);
/* A new directory for one process alone, from a path that ends with /NAME-XXXXXX, in whose place none may put another.
 */
bool tvi_directory_own(char *path);
/* With the files in it that are named: NULL ends them. */
void tvi_directory_remove(const char *path, const char *const file[]);
/* In one go, so that others see the old file or the new one. */
bool tvi_file_move(const char *from, const char *to);

/* Runs argv[0], found as a shell finds it, with what it prints in a file, and no other file of the program's open. 0:
 * it went well; > 0: its exit status, or 128 and more for a signal; < 0: it could not be started. */
int tvi_process_run(char *const argv[], const char *output);

/* NULL: not set. */
const char *tvi_environment(const char *name);

#endif
