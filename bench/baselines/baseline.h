/* baseline.h - Declares the integrators that the library is measured against: plain C on hand-written forces, and the
 * libraries that Debian has. For the scenes with a potential: M q'' = F(q), M diagonal; and one for the double
 * pendulum.
 *
 * baselines.mk has the compiler's flags: the times are worth something only with these, and with gcc. */
#ifndef BASELINE_H
#define BASELINE_H

#include "scenes/scene.h"

enum { BASELINE_N_MAX = 18 }; /* degrees of freedom */

#define INLINE inline __attribute__((always_inline))
/* A loop over lanes, which becomes vectors; gcc 12 would rather unroll it first, and then finds less. */
#ifdef __clang__
#define FOR_EACH_LANE(l, lanes) for (int l = 0; l < (lanes); l++)
#else
#define FOR_EACH_LANE(l, lanes) _Pragma("GCC unroll 1") for (int l = 0; l < (lanes); l++)
#endif

typedef struct {
    const scene *scene;
    double h;
    long steps;             /* to t = h steps */
    double tolerance;       /* relative, of a baseline that chooses its own steps to t; the others do not read it */
    tvi_observer *observer; /* after each step, NULL = none; a value other than 0 stops */
    void *ctx;
} baseline_task;

typedef struct {
    long steps;
    long force_evaluations; /* values of the force at one node; 0 where a series is made instead */
    long passes;            /* of the iteration of an implicit method */
} baseline_counts;

typedef struct baseline baseline;
struct baseline {
    const char *name; /* NULL ends a list */
    int order;        /* the highest where it varies */
    bool adaptive;    /* it chooses its own steps: see baseline_task.tolerance */
    bool symplectic;
    const void *data;                                     /* what tells apart the baselines of one function */
    bool (*serves)(const baseline *self, const scene *s); /* NULL = every scene with a force by hand */
    /* From (q, p) at t = 0 to h steps, in place; counts is set. On failure q and p are undefined.
     * TVI_ENOCONV, TVI_ESINGULAR: the step is too large; TVI_ENONFINITE; TVI_ESTOPPED: the observer; TVI_ENOMEM. */
    tvi_status (*run)(const baseline *self, const baseline_task *task, double q[], double p[], baseline_counts *counts);
};

const baseline *baseline_at(int index); /* from 0, all that were compiled; NULL: there are no more */
const baseline *baseline_find(const char *name, int order); /* NULL: no such baseline */
extern const char *const baseline_flags;                    /* of the compiler */
bool baseline_serves(const baseline *b, const scene *s);

extern const baseline baselines_composition[], baselines_gauss[], baselines_shooting[], baselines_taylor[];
extern const baseline baseline_double_pendulum;              /* in no list: of general_scenes */
extern const baseline baselines_gsl[], baselines_sundials[]; /* with BASELINES_GSL, BASELINES_SUNDIALS */

#endif
