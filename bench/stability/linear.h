/* linear.h - Declares linear stability: the step of the harmonic oscillator (cases.h) as a matrix, and how far it is
 * stable. */
#ifndef STABILITY_LINEAR_H
#define STABILITY_LINEAR_H

#include "cases.h"

/* M = ((a, b), (c, d)) of one step with h w = z, from the steps of the unit vectors. */
typedef struct {
    double a, b, c, d;
} step_matrix;

tvi_status linear_matrix(tvi_integrator *integrator, double z, step_matrix *M);
/* The spectral radius less 1. */
double linear_growth(const step_matrix *M);

typedef struct {
    double onset;  /* the first z where the spectral radius is above 1 + LINEAR_VISIBLE; INFINITY: none up to `most` */
    double growth; /* the largest spectral radius - 1 before it is stable again */
    double one_percent; /* the first z where the spectral radius is above 1.01; INFINITY: none */
    tvi_status status; /* of the first step that was refused, at refused_at: near a pole of the equations of the step */
    double refused_at;
} linear_limit;

/* Spectral radii nearer to 1 than this count as 1: roundoff. */
#define LINEAR_VISIBLE 1e-7

/* For z in (0, most]. */
linear_limit linear_search(tvi_integrator *integrator, double most);

#endif
