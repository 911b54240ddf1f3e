/* chain.h - Declares chains of pendulums in the plane, once with the angles of their links as coordinates, and once
 * with the places of their masses, on constraints. */
#ifndef CHAIN_H
#define CHAIN_H

#include "tvi.h"

enum { LINKS_MOST = 10 };

/* Masses of 1, each at the end of a link, below a fixed point. Link j hangs at angle[j] from the vertical, and turns at
 * turning[j]. */
typedef struct {
    int links;
    double length, g; /* of each link */
    double angle[LINKS_MOST], turning[LINKS_MOST];
} chain;

/* A system, with the state of the chain: q[n], p[n]. A failure ends the program. */
tvi_system *chain_of_angles(const chain *c, double q[], double p[]);
tvi_system *chain_of_places(const chain *c, double q[], double p[]);
/* The largest distance of a mass in the two states, in lengths of the chain. */
double chain_distance(const chain *c, const double angle[], const double place[]);

#endif
