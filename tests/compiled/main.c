/* main.c - Runs the suites on generated code: the same results as the tape's, what may go wrong on the way to it, and
 * who owns it. The environment variable TVI_COMPILED=all runs every scene with every method, with the library's own
 * flags. */
#define _XOPEN_SOURCE 700
#include "compiled.h"
#include "problems/run_suites.h"

#include <dirent.h>
#include <ftw.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool runs_all(void)
{
    const char *all = getenv("TVI_COMPILED");
    return all && strcmp(all, "all") == 0;
}

const char *instructions_flag(void)
{
#if defined(__x86_64__)
    const char *const wish = getenv("TVI_ISA");
    if (wish && strcmp(wish, "base") == 0) return "";
    return wish && strcmp(wish, "avx2") == 0 ? "-march=x86-64-v3" : "-march=native";
#else
    return "";
#endif
}

tvi_compiler compiler_of(how_compiled how)
{
    static char wide[100];
    snprintf(wide, sizeof wide, QUICK_FLAGS " %s", instructions_flag());
    const char *const flags[] = {[USUAL] = NULL, [WIDE] = wide, [QUICK] = QUICK_FLAGS};
    return (tvi_compiler){how == QUICK ? QUICK_COMPILER : NULL, flags[how], "build/check/generated"};
}

const scene *scene_of(const whose *subject) { return subject->problem ? subject->problem->scene : subject->scene; }

motion motion_start(const scene *s)
{
    motion m = {0};
    memcpy(m.q, s->q, (size_t)s->n * sizeof *m.q);
    memcpy(m.p, s->p, (size_t)s->n * sizeof *m.p);
    return m;
}

static double part(int n, const double a[], const double b[])
{
    double size = 0, difference = 0;
    for (int i = 0; i < n; i++) {
        size = fmax(size, fabs(a[i]));
        difference = fmax(difference, fabs(a[i] - b[i]));
    }
    return difference == 0 ? 0 : difference / size;
}

double motion_difference(int n, const motion *a, const motion *b)
{
    return fmax(part(n, a->q, b->q), part(n, a->p, b->p));
}

const tvi_system *systems_open(const whose *subject, systems *its)
{
    *its = (systems){NULL, NULL};
    if (subject->problem) its->stated = problem_system(subject->problem);
    else ck_assert_int_eq(scene_system(subject->scene, &its->stated), TVI_OK);
    if (!subject->is_rescaled) return its->stated;
    ck_assert_int_eq(tvi_system_rescaled(&its->rescaled, its->stated, NULL, NULL), TVI_OK);
    return its->rescaled;
}

void systems_free(const systems *its)
{
    tvi_system_free(its->rescaled);
    tvi_system_free(its->stated);
}

tvi_status motion_go(const tvi_system *system, const tvi_options *options, double h, long steps, motion *m,
                     tvi_stats *stats)
{
    tvi_integrator *integrator;
    tvi_status status = tvi_integrator_create(&integrator, system, options);
    ck_assert_int_eq(status, TVI_OK);
    status = tvi_integrate(integrator, h, steps, &m->t, m->q, m->p, NULL, NULL);
    *stats = *tvi_integrator_stats(integrator);
    tvi_integrator_free(integrator);
    return status;
}

/* ---- Directories ------------------------------------------------------------------------------------------------- */

const char *directory_make(void)
{
    static char paths[10][64];
    static int count;
    char *path = paths[count++ % 10];
    strcpy(path, "/tmp/tvi-test-XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(path));
    return path;
}

static int remove_one(const char *path, const struct stat *s, int type, struct FTW *at)
{
    (void)s, (void)type, (void)at;
    return remove(path);
}

void directory_remove(const char *path) { nftw(path, remove_one, 16, FTW_DEPTH | FTW_PHYS); }

int directory_count(const char *path, const char *ending)
{
    int count = 0;
    DIR *directory = opendir(path);
    if (!directory) return 0;
    for (const struct dirent *e; (e = readdir(directory));) {
        const size_t size = strlen(e->d_name), end = strlen(ending);
        count += e->d_name[0] != '.' && size >= end && strcmp(e->d_name + size - end, ending) == 0;
    }
    closedir(directory);
    return count;
}

static Suite *(*const suites[])(void) = {suite_same,  suite_rows,  suite_cache, suite_owners,
                                         suite_ahead, suite_alone, suite_names, suite_locales};

int main(void) { return RUN_SUITES(suites); }
