/* systems.h - Declares systems with parameters, whose gradients and tangent columns are measured. */
#ifndef BENCH_GRADIENT_SYSTEMS_H
#define BENCH_GRADIENT_SYSTEMS_H

#include "tvi.h"

enum { GRADIENT_MOST = 64, GRADIENT_MOST_PARAMETERS = 67 };

typedef struct {
    const char *title;
    int n;
    double h;
    tvi_system *(*make)(int n);
    double q[GRADIENT_MOST], p[GRADIENT_MOST];
} gradient_system;

enum {
    GRADIENT_KEPLER,
    GRADIENT_MAGNETIC,
    GRADIENT_FRICTION,
    GRADIENT_FIVE_BODIES,
    GRADIENT_EIGHT_BODIES,
    GRADIENT_TWELVE_BODIES,
    GRADIENT_FPUT,
    GRADIENT_DOUBLE_PENDULUM,
    GRADIENT_SYSTEMS
};
/* Their starts are set by gradient_systems_begin. */
extern gradient_system gradient_systems[GRADIENT_SYSTEMS];
void gradient_systems_begin(void);

#endif
