/* cases.h - Declares problems on which methods break: close encounters, separatrices, stiffness, chaos, sizes at the
 * ends of the range of doubles. The bench and the tests take them from here. */
#ifndef STABILITY_CASES_H
#define STABILITY_CASES_H

#include "scenes/scene.h"

typedef struct {
    scene scene; /* without a reference and without steps; the potential may need the context */
    void *ctx;
    double period; /* the exact solution is at its start again after it, and after t_end; 0: nobody knows */
    double
        bound; /* of the energy error, relative to max(|H0|, energy_scale): a run that is above it has not survived */
    double h_most, h_least, ladder; /* a search goes from h_most, too large for nearly all, down by this ratio */
    int least_order;                /* of the methods that it tries */
    bool long_run;                  /* so long that only the default method and Gauss collocation are tried */
} hard_case;

extern const hard_case kepler_60, kepler_90, kepler_99, separatrix, pythagorean, fpu_50, fpu_100, fpu_200,
    spring_pendulum, henon_heiles_6, figure_eight, unequal_masses;
extern const hard_case *const hard_cases[]; /* those for a search of the largest step, without fpu_*; NULL ends */

/* V = w^2 q^2 / 2 with w = 1: h is h w. */
extern const hard_case oscillator;
/* A pendulum of length L in units that make q = L x, p = L y and H = L^2 E, L a power of 2: bit for bit L times the
 * pendulum of length 1, as long as nothing overflows or underflows. L^2 is about 1e-300 and 1e300. */
extern const hard_case pendulum_tiny, pendulum_unit, pendulum_huge;
/* Kepler's problem at |q| = 1e-150, where r^-3 is infinite, and at 1e150, where it is 0. */
extern const hard_case kepler_tiny, kepler_huge;

/* The case's system; *out is NULL on failure. */
TVI_NODISCARD tvi_status hard_system(const hard_case *c, tvi_system **out);

#endif
