/* files.h - Reads and writes the files of generated code, and starts the compiler; load.c and compile.c call it. No
 * other file calls the operating system, except to load libraries and to identify the processor (load.c, attach.c,
 * ad/isa.c). */
#ifndef TVI_SRC_COMPILED_FILES_H
#define TVI_SRC_COMPILED_FILES_H

#include <stdbool.h>
#include <stddef.h>

/* Writes a new file, or appends to an existing one. Returns whether all bytes are written. */
bool tvi_file_write(const char *path, bool appends, const void *data, size_t byte_count);
/* Reads a whole file, and adds a 0 at its end. The file must belong to the user and must not be a link. The caller
 * frees the text. Returns NULL if there is no such file. */
char *tvi_file_read(const char *path, size_t *byte_count);

/* Removes the access of all other users to the file, whatever the umask is. */
bool tvi_file_restrict_to_user(const char *path);

/* Creates the directory with the mode 0700, and its parents if they are missing. Returns whether it is there, is no
 * link, belongs to the user and has this mode. */
bool tvi_directory_create_private(const char *path);
/* Creates a new directory with the mode 0700 from a path that ends with /NAME-XXXXXX, which is replaced by a unique
 * name. */
bool tvi_directory_create_temporary(char *path);
/* Removes the files at the paths of this list, which ends with NULL, and then the directory. */
void tvi_directory_remove(const char *path, const char *const files[]);
/* Renames a file in one operation, so that other processes see the old file or the new one. */
bool tvi_file_move(const char *from, const char *to);

/* Runs the program argv[0], which is searched for as a shell does. The output of the program goes to the file
 * output_path. The program inherits no other open file of this process. Returns the exit status of the program, which
 * is 0 on success, 128 plus the signal if a signal ended the program, and a negative number if the program could not be
 * started. */
int tvi_process_run(char *const argv[], const char *output_path);

/* Returns the value of a variable of the environment. NULL: it is not set, or empty. */
const char *tvi_environment_variable(const char *name);

#endif
