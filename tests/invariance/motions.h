/* motions.h - Declares motions in their own coordinates x, about an equilibrium at x = 0 and in units in which they are
 * of size 1, and the frames that they are seen in. */
#ifndef TESTS_INVARIANCE_MOTIONS_H
#define TESTS_INVARIANCE_MOTIONS_H

#include "tvi.h"

enum { N_MOST = 40 };

/* q_i = move + length x_i, or of i mirrored where they are exchanged; times and masses in other units. */
typedef struct {
    const char *name;
    double move, length, time, mass;
    bool exchanged;
} frame;

extern const frame as_it_is;

typedef struct motion motion;

/* A motion of n coordinates, of this size, in a frame. */
typedef struct {
    const motion *motion;
    const frame *frame;
    int n;
    double amplitude;
} setting;

/* One of the functions of the energy is set. */
struct motion {
    const char *name;
    jet (*potential)(const setting *s, const jet x[], jet t);
    void (*force)(const setting *s, const jet x[], jet t, jet F[]);
    jet (*lagrangian)(const setting *s, const jet x[], const jet v[], jet t);
    jet (*hamiltonian)(const setting *s, const jet x[], const jet p[], jet t);
    const double *start; /* [2n] x, p where the amplitude is 1; NULL: start_of's */
    int n;               /* its smallest */
    double most;         /* amplitude */
    double cancels;      /* the size of what cancels in the force at the equilibrium */
    double h;
    bool raw; /* the function is given q and t as they are, and states its own constants in the units of the frame */
};

enum { MOTIONS = 13 };
extern const motion motions[MOTIONS];
const motion *motion_named(const char *name);

typedef struct {
    tvi_status status;
    long steps; /* that succeeded */
    double t, x[N_MOST], p[N_MOST];
} outcome;

/* In the motion's own coordinates and units; numbers of a few bits, so that the frame's are exact unless the move is
 * large. */
outcome start_of(const setting *s);

/* Ends the test where it cannot be made. */
tvi_system *system_of(setting *s);
/* From `from` in the motion's own coordinates: what tvi_integrate makes of it with steps of factor times the motion's
 * h. */
outcome run_from(const setting *s, const tvi_system *system, const tvi_options *options, double factor, long steps,
                 const outcome *from);

/* The largest difference of a component, and the largest component; of p_i / m_i. */
double distance(const setting *s, const outcome *a, const outcome *b);
double size_of(const setting *s, const outcome *a);
/* By how much the motion's own orbit enlarges a small distance in so many steps, at least 1: that of Taylor's method.
 */
double growth_of(const setting *s, long steps);

#endif
