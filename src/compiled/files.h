/* files.h - Reads and writes the files of generated code, and starts the compiler. Other files ask
 * the operating system only to load libraries, and for the processor (load.c, attach.c, ad/isa.c). */
#ifndef TVI_SRC_COMPILED_FILES_H
#define TVI_SRC_COMPILED_FILES_H

#include <stdbool.h>
#include <stddef.h>

/* Write a new file, or append to one that is there. */
bool tvi_file_write(const char *path, const void *data, size_t size);
bool tvi_file_append(const char *path, const void *data, size_t size);
/* Reads all of a file that belongs to the user and is no link, with a 0 after it. The text is to be freed. NULL: there
 * is no such file. */
char *tvi_file_read(const char *path, size_t *size);

/* Closes the file to other users, whatever the umask is. */
bool tvi_file_claim(const char *path);

/* Creates the directory and those above it, if they are missing. Returns whether it belongs to the user, and no other
 * user may write to it or replace it. */
bool tvi_directory_make(const char *path);
/* Creates a new directory for this process, from a path that ends with /NAME-XXXXXX. No other user can replace it.
 */
bool tvi_directory_own(char *path);
/* Removes the directory, with the named files in it. NULL ends the names. */
void tvi_directory_remove(const char *path, const char *const file[]);
/* Moves a file in one operation, so that others see the old file or the new one. */
bool tvi_file_move(const char *from, const char *to);

/* Runs argv[0], found as a shell finds it, with its output in a file and no other file of the program open. Returns 0
 * on success, a positive exit status, 128 and more after a signal, or a negative number if it could not be started. */
int tvi_process_run(char *const argv[], const char *output);

/* The value of a variable of the environment; NULL: it is not set. */
const char *tvi_environment(const char *name);

#endif
