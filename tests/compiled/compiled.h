/* compiled.h - Declares the suites of this program, and what they share: systems with generated code beside the same
 * systems without. */
#ifndef TESTS_COMPILED_H
#define TESTS_COMPILED_H

#include "problems/problems.h"
#include "problems/refusals.h"
#include "scene.h"

#include <check.h>

Suite *suite_same(void);
Suite *suite_rows(void);
Suite *suite_cache(void);
Suite *suite_owners(void);
Suite *suite_ahead(void);
Suite *suite_alone(void);
Suite *suite_names(void);
Suite *suite_locales(void);

enum { COORDINATES_MOST = 18 };

typedef struct {
    double t, q[COORDINATES_MOST + 1], p[COORDINATES_MOST + 1];
} motion;

motion motion_start(const scene *s);
/* The largest difference of q and p, as a part of the largest of each. */
double motion_difference(int n, const motion *a, const motion *b);

/* Makes steps with an integrator of its own. */
tvi_status motion_go(const tvi_system *system, const tvi_options *options, double h, long steps, motion *m,
                     tvi_stats *stats);

/* A system and a size of steps that suits it: a scene, as it is or in a time that it chooses; or a problem, which may
 * have a force that knows the time. */
typedef struct {
    const scene *scene;
    double h;
    bool is_rescaled;
    const test_problem *problem; /* NULL: the scene */
} whose;
typedef struct {
    tvi_system *stated, *rescaled;
} systems;
const scene *scene_of(const whose *subject);
/* Reads the code of a run, to be freed. Returns the run. */
const tvi_system *systems_open(const whose *subject, systems *its);
void systems_free(const systems *its);

/* The cache lies below the build's directory, where the next run finds it again. USUAL is the compiler of the
 * environment with the library's own flags. WIDE compiles the same text without optimization and without inlining, in a
 * fifth of the time, to the instructions of the tape: it serves where the text is tested, and not what a compiler makes
 * of it. QUICK does so by clang, which takes half of the time, and to the base instructions. */
typedef enum { USUAL, WIDE, QUICK } how_compiled;
tvi_compiler compiler_of(how_compiled how);
#define QUICK_COMPILER "clang"
#define QUICK_FLAGS    "-O0 -D__always_inline__=unused"
/* The flag for all instructions that the library may use here; "" where it may use none but those of the base. */
const char *instructions_flag(void);
/* Whether the environment variable TVI_COMPILED asks for every scene with every method. */
bool runs_all(void);
/* An empty directory of the test's own, for ten calls; and without all in it. */
const char *directory_make(void);
void directory_remove(const char *path);
int directory_count(const char *path, const char *ending); /* of the files whose names end so */

#endif
