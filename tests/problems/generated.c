/* generated.c - Makes a test program that is linked with --wrap=tvi_integrator_create and --wrap=tvi_integrator_free
 * run generated code (tests/generated.sh). TVI_GENERATED="rows others" chooses: of the tests, which are processes of
 * their own, the first and every `rows`th after it (the others end where they make an integrator); in a test all
 * integrators that are made like the first one, and one of `others` of what else it makes, by the fingerprints of
 * system and options. The flags of the compiler are TVI_GENERATED_FLAGS. A test that makes steps but none by generated
 * code fails. Each test adds what it did to the file TVI_GENERATED_COUNTS. */
#define _XOPEN_SOURCE 700
#include "compiled/code.h"
#include "method/fingerprint.h"
#include "system/system.h"
#include "tvi.h"

#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

tvi_status __real_tvi_integrator_create(tvi_integrator **out, const tvi_system *system, const tvi_options *options);
tvi_status __wrap_tvi_integrator_create(tvi_integrator **out, const tvi_system *system, const tvi_options *options);
void __real_tvi_integrator_free(tvi_integrator *integrator);
void __wrap_tvi_integrator_free(tvi_integrator *integrator);

/* Counts of this process; index 1: with generated code. */
static struct {
    pid_t process, program;
    uint64_t first, others;
    long forks, rows;
    long integrators[2], steps[2];
} done;

static void count_fork(void) { done.forks++; }

static void prove(void)
{
    if (done.process != getpid()) return;
    const char *path = getenv("TVI_GENERATED_COUNTS");
    FILE *file = path ? fopen(path, "a") : NULL;
    const long *made = done.integrators, *steps = done.steps;
    if (file) fprintf(file, "%ld %ld %ld %ld\n", made[0], made[1], steps[0], steps[1]);
    if (file) fclose(file);
    if (done.steps[0] == 0 || done.steps[1] > 0) return;
    fprintf(stderr, "no step of %ld by generated code\n", done.steps[0]);
    _exit(EXIT_FAILURE);
}

__attribute__((constructor)) static void begin(void)
{
    const char *chosen = getenv("TVI_GENERATED");
    done.program = getpid(), done.rows = 1, done.others = 1;
    if (chosen && sscanf(chosen, "%ld %" SCNu64, &done.rows, &done.others) != 2) abort();
    atexit(prove);
    pthread_atfork(count_fork, NULL, NULL);
}

static bool is_chosen(const tvi_system *system, const tvi_options *options)
{
    const uint64_t kind = tvi_system_fingerprint(system) ^ tvi_options_fingerprint(options);
    if (done.process != getpid()) {
        memset(done.integrators, 0, sizeof done.integrators);
        memset(done.steps, 0, sizeof done.steps);
        done.process = getpid(), done.first = 0;
        if (done.process != done.program && (done.forks - 1) % done.rows != 0) _exit(EXIT_SUCCESS);
    }
    if (!done.first) done.first = kind;
    return kind == done.first || kind % done.others == 0;
}

/* The time of the compiler is not that of the test. */
static tvi_compiled *compiled(const tvi_system *system, const tvi_options *options)
{
    const tvi_compiler quick = {.flags = getenv("TVI_GENERATED_FLAGS"), .cache = "build/check/generated"};
    tvi_compiled *code = NULL;
    const unsigned left = alarm(0);
    if (tvi_compile(&code, system, options, &quick) != TVI_OK) {
        fprintf(stderr, "no code: %s\n", tvi_last_error());
        abort();
    }
    alarm(left);
    return code;
}

tvi_status __wrap_tvi_integrator_create(tvi_integrator **out, const tvi_system *system, const tvi_options *options)
{
    tvi_options with = options ? *options : tvi_options_default();
    if (!out || !system || with.compiled || tvi_options_check(system, &with, NULL) != TVI_OK)
        return __real_tvi_integrator_create(out, system, options);
    tvi_compiled *code = is_chosen(system, &with) ? compiled(system, &with) : NULL;
    with.compiled = code;
    const tvi_status status = __real_tvi_integrator_create(out, system, &with);
    done.integrators[code != NULL] += status == TVI_OK;
    tvi_compiled_free(code);
    return status;
}

void __wrap_tvi_integrator_free(tvi_integrator *integrator)
{
    const tvi_stats *stats = tvi_integrator_stats(integrator);
    if (stats) done.steps[stats->is_compiled] += stats->steps;
    if (done.steps[0] + done.steps[1] == 0) done.first = 0; /* was made for its options alone */
    __real_tvi_integrator_free(integrator);
}
