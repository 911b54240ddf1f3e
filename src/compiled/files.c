/* files.c - Reads and writes the files of generated code, and starts the compiler (files.h). */
#define _GNU_SOURCE /* posix_spawn_file_actions_addclosefrom_np */
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

const char *tvi_environment(const char *name)
{
    const char *value = getenv(name);
    return value && *value ? value : NULL;
}

/* ---- Files ------------------------------------------------------------------------------------------------------- */

static bool write_all(int file, const char *data, size_t size)
{
    while (size > 0) {
        const ssize_t written = write(file, data, size);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        data += written;
        size -= (size_t)written;
    }
    return true;
}

static bool write_to(const char *path, int flags, const void *data, size_t size)
{
    const int file = open(path, O_WRONLY | O_CLOEXEC | flags, 0644);
    if (file < 0) return false;
    const bool is_written = write_all(file, data, size);
    return close(file) == 0 && is_written;
}

bool tvi_file_write(const char *path, const void *data, size_t size)
{
    return write_to(path, O_CREAT | O_TRUNC, data, size);
}

bool tvi_file_append(const char *path, const void *data, size_t size) { return write_to(path, O_APPEND, data, size); }

static bool is_own(const struct stat *s) { return s->st_uid == geteuid() && !(s->st_mode & (S_IWGRP | S_IWOTH)); }

static char *read_all(int file, size_t *size)
{
    struct stat s;
    if (fstat(file, &s) != 0 || !S_ISREG(s.st_mode) || !is_own(&s)) return NULL;
    char *data = malloc((size_t)s.st_size + 1);
    for (*size = 0; data && *size < (size_t)s.st_size;) {
        const ssize_t got = read(file, data + *size, (size_t)s.st_size - *size);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        *size += (size_t)got;
    }
    if (data) data[*size] = 0;
    return data;
}

char *tvi_file_read(const char *path, size_t *size)
{
    const int file = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK); /* does not wait for a pipe */
    if (file < 0) return NULL;
    char *data = read_all(file, size);
    close(file);
    return data;
}

bool tvi_file_claim(const char *path) { return chmod(path, 0700) == 0; }

bool tvi_file_move(const char *from, const char *to) { return rename(from, to) == 0; }

/* ---- Directories ------------------------------------------------------------------------------------------------- */

typedef bool directory_fn(const char *path);

/* Tells whether all directories above this one pass the check, from the top. The path is written to for a while. */
static bool is_true_above(char *path, directory_fn *check)
{
    for (char *at = path + 1; (at = strchr(at, '/')); at++) {
        *at = 0;
        const bool is_true = check(path);
        *at = '/';
        if (!is_true) return false;
    }
    return true;
}

static bool make(const char *path) { return mkdir(path, 0700) == 0 || errno == EEXIST || access(path, X_OK) == 0; }

/* Who owns a directory, or may write to it, may put another one in the place of one that it has. The sticky bit keeps
 * a group and all others from that, and not the owner, who is the user, or root. */
static bool keeps_what_it_has(const char *path)
{
    struct stat s;
    if (stat(path, &s) != 0 || (s.st_uid != geteuid() && s.st_uid != 0)) return false;
    return !(s.st_mode & (S_IWGRP | S_IWOTH)) || (s.st_mode & S_ISVTX);
}

/* All directories above this one, also above the working directory and where links lead. */
static bool is_kept(const char *path)
{
    char *real = realpath(path, NULL);
    const bool is_true = real && keeps_what_it_has("/") && is_true_above(real, keeps_what_it_has);
    free(real);
    return is_true;
}

bool tvi_directory_make(const char *path)
{
    struct stat s;
    const size_t size = strlen(path) + 1;
    char *copy = malloc(size);
    if (!copy) return false;
    memcpy(copy, path, size);
    const bool is_made = is_true_above(copy, make) && make(copy);
    free(copy);
    return is_made && is_kept(path) && lstat(path, &s) == 0 && S_ISDIR(s.st_mode) && is_own(&s);
}

bool tvi_directory_own(char *path)
{
    char *const name = strrchr(path, '/');
    *name = 0;
    const bool is_safe = is_kept(path) && keeps_what_it_has(path);
    *name = '/';
    return is_safe && mkdtemp(path) != NULL;
}

void tvi_directory_remove(const char *path, const char *const file[])
{
    for (; *file; file++) unlink(*file);
    rmdir(path);
}

/* ---- The compiler ------------------------------------------------------------------------------------------------ */

static int wait_for(pid_t child)
{
    int status;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR) return 0; /* the caller judges the compiler by its output */
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

#ifdef __GLIBC__
#if __GLIBC_PREREQ(2, 34)
#define HAS_CLOSEFROM
#endif
#endif

/* Closes the program's own files for the compiler, and for a server that the compiler may leave behind. */
static bool closes_others(posix_spawn_file_actions_t *actions)
{
#ifdef HAS_CLOSEFROM
    return posix_spawn_file_actions_addclosefrom_np(actions, 3) == 0;
#else
    return actions != NULL;
#endif
}

int tvi_process_run(char *const argv[], const char *output)
{
    posix_spawn_file_actions_t actions;
    pid_t child;
    if (posix_spawn_file_actions_init(&actions) != 0) return -1;
    const bool is_set =
        posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0) == 0 &&
        posix_spawn_file_actions_addopen(&actions, 1, output, O_WRONLY | O_CREAT | O_TRUNC, 0600) == 0 &&
        posix_spawn_file_actions_adddup2(&actions, 1, 2) == 0 && closes_others(&actions);
    const bool is_started = is_set && posix_spawnp(&child, argv[0], &actions, NULL, argv, environ) == 0;
    posix_spawn_file_actions_destroy(&actions);
    return is_started ? wait_for(child) : -1;
}
