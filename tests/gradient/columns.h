/* columns.h - Declares the systems with parameters whose tangent vectors the suite of columns moves. */
#ifndef TESTS_GRADIENT_COLUMNS_H
#define TESTS_GRADIENT_COLUMNS_H

#include "tvi.h"

#include <check.h>

Suite *suite_columns(void);

enum { COLUMNS_MOST_N = 16, COLUMNS_MOST_PARAMETERS = 19, COLUMNS_MOST_ROWS = 51, COLUMNS_MOST = 51 * 51 };

typedef struct {
    const char *name;
    int n;
    double h;
    /* The system that is run, and the one that it is made of, or NULL. */
    tvi_system *(*make)(tvi_system **base);
    void (*start)(double q[], double p[]);
} columns_problem;

/* Kepler's problem, five bodies, a chain, a magnetic field, a driven pendulum, a reversible rescaled one, and a chaotic
 * orbit. */
extern const columns_problem columns_problems[];
enum {
    COLUMNS_KEPLER,
    COLUMNS_BODIES,
    COLUMNS_CHAIN,
    COLUMNS_MAGNETIC,
    COLUMNS_DRIVEN,
    COLUMNS_REVERSIBLE,
    COLUMNS_CHAOTIC
};
enum { COLUMNS_PROBLEMS = 7 };

/* A run that is at hand. D [rows][rows] begins as the identity. */
typedef struct {
    const columns_problem *problem;
    tvi_system *system, *base;
    tvi_integrator *it;
    int n, rows;
    double t, q[COLUMNS_MOST_N], p[COLUMNS_MOST_N], D[COLUMNS_MOST];
} columns_run;
void columns_open(columns_run *run, const columns_problem *problem, const char *method, int order);
void columns_close(columns_run *run);
/* The plan of so many steps of its h, with D. */
tvi_run_plan columns_plan(columns_run *run, bool at_once, long steps);

/* The largest difference of two matrices D in a column, relative to the largest element of that column of b. */
double columns_distance(int rows, int columns, const double a[], const double b[]);

/* L(q, v) whose momenta are not masses times velocities. */
jet columns_lagrangian(const jet q[], const jet v[], jet t, void *ctx);

#endif
