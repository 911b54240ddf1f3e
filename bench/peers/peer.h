/* peer.h - runs of a problem from its start to its end by a program: this library, REBOUND or heyoka. */
#ifndef PEER_H
#define PEER_H

#include <stdbool.h>

enum { PEER_BODIES_MAX = 9, PEER_N_MAX = 3 * PEER_BODIES_MAX };

/* Body i has the coordinates q[axes i], ..., q[axes i + axes - 1] and, unless bodies is 0 or 1, its mass. */
typedef struct {
    int n, bodies, axes; /* bodies = 1: it is attracted by a mass of 1 at 0; 0: the force of Henon and Heiles */
    double G, t_end;
    double mass[PEER_BODIES_MAX], q[PEER_N_MAX], v[PEER_N_MAX];
    const double *steps;     /* of this library, in t or in s, falling; 0 ends */
    const double *map_steps; /* of maps that split off Kepler's problem; NULL: they are not for this problem */
    const void *scene;       /* the same as a scene of the bench, */
    const void *hard;        /* and as a hard_scene, where steps have to adapt; otherwise NULL */
} problem;

typedef struct peer peer;
struct peer {
    const char *name; /* of the column of the table; NULL ends a list */
    int variant;      /* what tells apart the peers of one program */
    /* Steps or tolerances, 0 ends; NULL: this problem is not for it. */
    const double *(*settings)(const peer *self, const problem *p);
    void *(*open)(const peer *self, const problem *p, double setting); /* a run at its start; NULL: it is refused */
    bool (*go)(void *run, double q[]); /* to the end, whose positions are q; this alone is timed; false: it failed */
    void (*close)(void *run);
};

typedef struct {
    const char *name;
    const char *(*version)(void);
    const peer *peers;
} peer_program;

/* The last two are NULL pointers where the program was built without them. */
extern const peer_program peers_of_tvi;
extern const peer_program peers_of_rebound __attribute__((weak)), peers_of_heyoka __attribute__((weak));

extern const char *peers_folder; /* where generated code may be kept */

#endif
