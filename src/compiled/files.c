/* files.c - Reads and writes the files of generated code, and starts the compiler (files.h). */
#define _GNU_SOURCE /* This makes spawn.h declare posix_spawn_file_actions_addclosefrom_np. */
#include "compiled/files.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

const char *tvi_environment_variable(const char *name)
{
    const char *value = getenv(name);
    return value && *value ? value : NULL;
}

/* ---- Files ------------------------------------------------------------------------------------------------------- */

static bool write_all(int file, const char *data, size_t byte_count)
{
    while (byte_count > 0) {
        const ssize_t written = write(file, data, byte_count);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        data += written;
        byte_count -= (size_t)written;
    }
    return true;
}

bool tvi_file_write(const char *path, bool appends, const void *data, size_t byte_count)
{
    const int file = open(path, O_WRONLY | O_CLOEXEC | (appends ? O_APPEND : O_CREAT | O_TRUNC), 0644);
    if (file < 0) return false;
    const bool is_written = write_all(file, data, byte_count);
    return close(file) == 0 && is_written;
}

/* Tells whether the file belongs to the user, and no other user may write to it. */
static bool is_file_safe_from_other_users(const struct stat *s)
{
    return s->st_uid == geteuid() && !(s->st_mode & (S_IWGRP | S_IWOTH));
}

static char *read_all(int file, size_t *byte_count)
{
    struct stat s;
    if (fstat(file, &s) != 0 || !S_ISREG(s.st_mode) || !is_file_safe_from_other_users(&s)) return NULL;
    char *data = malloc((size_t)s.st_size + 1);
    for (*byte_count = 0; data && *byte_count < (size_t)s.st_size;) {
        const ssize_t got = read(file, data + *byte_count, (size_t)s.st_size - *byte_count);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        *byte_count += (size_t)got;
    }
    if (data) data[*byte_count] = 0;
    return data;
}

char *tvi_file_read(const char *path, size_t *byte_count)
{
    /* O_NONBLOCK keeps the call from waiting for a pipe. */
    const int file = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (file < 0) return NULL;
    char *data = read_all(file, byte_count);
    close(file);
    return data;
}

bool tvi_file_restrict_to_user(const char *path) { return chmod(path, 0700) == 0; }

bool tvi_file_move(const char *from, const char *to) { return rename(from, to) == 0; }

/* ---- Directories ------------------------------------------------------------------------------------------------- */

static bool make_directory(const char *path)
{
    return mkdir(path, 0700) == 0 || errno == EEXIST || access(path, X_OK) == 0;
}

/* Makes the directory and its missing parents. The path is modified meanwhile. */
static bool make_directory_and_parents(char *path)
{
    for (char *at = path + 1; (at = strchr(at, '/')); at++) {
        *at = 0;
        const bool is_there = make_directory(path);
        *at = '/';
        if (!is_there) return false;
    }
    return make_directory(path);
}

bool tvi_directory_create_private(const char *path)
{
    struct stat s;
    size_t length = strlen(path);
    char *copy = malloc(length + 1);
    if (!copy) return false;
    memcpy(copy, path, length + 1);
    while (length > 1 && copy[length - 1] == '/') copy[--length] = 0; /* Otherwise lstat would follow a link. */
    const bool is_private = make_directory_and_parents(copy) && lstat(copy, &s) == 0 && S_ISDIR(s.st_mode) &&
                            s.st_uid == geteuid() && (s.st_mode & 0777) == 0700;
    free(copy);
    return is_private;
}

bool tvi_directory_create_temporary(char *path) { return mkdtemp(path) != NULL; }

void tvi_directory_remove(const char *path, const char *const files[])
{
    for (; *files; files++) unlink(*files);
    rmdir(path);
}

/* ---- The compiler ------------------------------------------------------------------------------------------------ */

static int wait_for_exit(pid_t child)
{
    int status;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR) return 0; /* The exit status is unknown; an incomplete library is found later (load.c). */
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

#ifdef __GLIBC__
#if __GLIBC_PREREQ(2, 34)
#define HAS_CLOSEFROM
#endif
#endif

/* Adds to the actions that start the compiler one that closes all files but 0, 1 and 2, if the C library has such an
 * action. Neither the compiler nor a server that it leaves behind then keeps files of this process open. */
static bool add_action_to_close_other_files(posix_spawn_file_actions_t *actions)
{
#ifdef HAS_CLOSEFROM
    return posix_spawn_file_actions_addclosefrom_np(actions, 3) == 0;
#else
    return actions != NULL;
#endif
}

int tvi_process_run(char *const argv[], const char *output_path)
{
    posix_spawn_file_actions_t actions;
    pid_t child;
    if (posix_spawn_file_actions_init(&actions) != 0) return -1;
    const bool is_set =
        posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0) == 0 &&
        posix_spawn_file_actions_addopen(&actions, 1, output_path, O_WRONLY | O_CREAT | O_TRUNC, 0600) == 0 &&
        posix_spawn_file_actions_adddup2(&actions, 1, 2) == 0 && add_action_to_close_other_files(&actions);
    const bool is_started = is_set && posix_spawnp(&child, argv[0], &actions, NULL, argv, environ) == 0;
    posix_spawn_file_actions_destroy(&actions);
    return is_started ? wait_for_exit(child) : -1;
}
