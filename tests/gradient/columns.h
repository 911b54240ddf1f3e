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

/* A run that is at hand. D [rows][rows] begins as the identity; the record is NULL, or that of gradient_open. */
typedef struct {
    const columns_problem *problem;
    tvi_system *system, *base;
    tvi_integrator *it;
    tvi_record *record;
    int n, rows;
    double t, q[COLUMNS_MOST_N], p[COLUMNS_MOST_N], D[COLUMNS_MOST];
} columns_run;
void columns_open(columns_run *run, const columns_problem *problem, const char *method, int order);
void columns_close(columns_run *run);
/* Two runs from one start, which a test then compares. */
void columns_open_pair(columns_run pair[2], const columns_problem *problem, const char *method, int order);
void columns_close_pair(columns_run pair[2]);
/* Ends the test where t, q and p are not the same bits. */
void columns_same_state(const columns_run pair[2]);
/* The plan of so many steps of its h, with D. */
tvi_run_plan columns_plan(columns_run *run, bool at_once, long steps);

/* The largest difference of two matrices in a column, relative to the largest element of that column of b; NAN where
 * elements are. */
double columns_distance(int rows, int columns, const double a[], const double b[]);

/* L(q, v) whose momenta are not masses times velocities. */
jet columns_lagrangian(const jet q[], const jet v[], jet t, void *ctx);

#endif
