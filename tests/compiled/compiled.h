/* compiled.h - the suites of this program, and what they share: systems with generated code beside the same systems
 * without. */
#ifndef TESTS_COMPILED_H
#define TESTS_COMPILED_H

#include "problems/refusals.h"
#include "scene.h"

#include <check.h>

Suite *suite_same(void);
Suite *suite_rows(void);
Suite *suite_cache(void);
Suite *suite_owners(void);
Suite *suite_ahead(void);
Suite *suite_names(void);

enum { COORDINATES_MOST = 18 };

typedef struct {
    double t, q[COORDINATES_MOST + 1], p[COORDINATES_MOST + 1];
} motion;

motion motion_start(const scene *s);
/* The largest difference of q and p, as a part of the largest of each. */
double motion_difference(int n, const motion *a, const motion *b);

/* So many steps of an integrator of its own. */
tvi_status motion_go(const tvi_system *system, const tvi_options *options, double h, long steps, motion *m,
                     tvi_stats *stats);

/* Steps of a size that suits the scene, of it or in a time that it chooses. */
typedef struct {
    const scene *scene;
    double h;
    bool is_rescaled;
} whose;
typedef struct {
    tvi_system *stated, *rescaled;
} systems;
/* Those of a run, to be freed; returns the one that it is of. */
const tvi_system *systems_open(const whose *of, systems *its);
void systems_free(const systems *its);

/* A cache below the build's directory, which the next run finds again. */
extern const tvi_compiler usual, quick; /* that optimizes less */
/* An empty directory of the test's own, for ten calls; and without all in it. */
const char *directory_make(void);
void directory_remove(const char *path);
int directory_count(const char *path, const char *ending); /* of the files whose names end so */

#endif
