/* world.h - Declares what the calls of a random program share: its bytes, its system and its state. */
#ifndef TESTS_FUZZ_WORLD_H
#define TESTS_FUZZ_WORLD_H

#include "tvi.h"

#include <stdint.h>

/* ---- Bytes ------------------------------------------------------------------------------------------------------- */

typedef struct {
    const uint8_t *data;
    size_t left;
} bytes;

int byte(bytes *b);             /* 0 when there are no more */
int below(bytes *b, int count); /* 0..count-1 */
double number(bytes *b);        /* mostly -4 to 4; one in sixteen of the extremes */
int integer(bytes *b, int usual);
double step_size(bytes *b);

/* ---- Functions --------------------------------------------------------------------------------------------------- */

enum { N_MAX = 10, PARAMETERS_MOST = 1000 };

typedef struct {
    bytes *b;
    int n;
} recorder;

/* Random operations on q, r (NULL: none) and t. */
jet scalar_of(const recorder *f, const jet q[], const jet r[], jet t);

/* ---- The world --------------------------------------------------------------------------------------------------- */

typedef struct {
    double t, q[N_MAX], p[N_MAX];
} state;

typedef struct {
    const tvi_system *system;
    tvi_integrator *integrator;
    int n;
    bool adapts; /* steps are in s: what time they cover, the system says */
    state x;
    long steps; /* that succeeded */
} world;

/* out is NULL where it is not TVI_OK. */
tvi_status make_system(bytes *b, tvi_system **out, world *w);

void insist(bool good, const char *what);
bool finite_all(int count, const double x[]);
void expect_status(tvi_status status);
/* After several steps from before: at none or at the last that succeeded, finite; not moved by TVI_EINVAL. */
void expect_end(const world *w, tvi_status status, const state *before, const char *what);
char *saved_state(const world *w, size_t *size); /* to be freed; NULL if the state is not finite */

/* ---- Calls in files of their own --------------------------------------------------------------------------------- */

void integrate_events(bytes *b, world *w);
void integrate_at(bytes *b, world *w);

#endif
