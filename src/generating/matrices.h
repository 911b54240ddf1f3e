/* matrices.h - solves equations with the transposed Jacobians of the curve's ends as matrices. It is part of the text
 * of generated code (emit.c), where every size is a constant. */
#ifndef TVI_SRC_GENERATING_MATRICES_H
#define TVI_SRC_GENERATING_MATRICES_H

#include "generating/closure.h"
#include "generating/tangents.h"

/* Reused Jacobians may change the state by this at most, relative to the state: well below the roundoff of a step. */
static const double MATRICES_STALE = DBL_EPSILON / 16;

/* The corrector's Jacobian serves passes that contract this well or nearly so: the passes before had moved z
 * farther. */
static const double MATRICES_NEAR = 1e-4;

/* This holds the Jacobians of the curve and their factors. Jacobians are counted as they are taken, from 0 in each
 * step; a factor is valid if it belongs to the last ones. */
typedef struct {
    double *z;       /* [2n] the z at which the last Jacobians were taken */
    int taken;       /* how often Jacobians were taken in this step */
    int factored;    /* the count of those that the factor belongs to */
    bool is_given;   /* the corrector has a Jacobian */
    double moved;    /* the path of z since that Jacobian, relative to its size, until the last ones were taken */
    double *G;       /* [n][2n] scratch for Jacobians of the ends */
    tvi_factor half; /* n x n; a generating function has this factor */
    tvi_factor full; /* 2n x 2n; or it has this one */
} tvi_matrices;

static inline tvi_matrices *matrices_of(const tvi_closure *c) { return c->solving; }

static inline void matrices_begin(tvi_matrices *m)
{
    m->taken = m->factored = 0;
    m->is_given = false;
}

/* Notes that the Jacobians of the curve were taken at z. */
static inline void matrices_take(const tvi_closure *c, const double z[])
{
    memcpy(matrices_of(c)->z, z, 2 * (size_t)curve_n(&c->curve) * sizeof *z);
    matrices_of(c)->taken++;
}

/* Writes the Jacobians of two combinations, one above the other: [2n][2n]. */
static inline void matrices_join(const tvi_closure *c, const tvi_combination *first, const tvi_combination *second,
                                 double matrix[])
{
    CURVE_CALL(sum_jacobian, &c->curve, first, matrix);
    CURVE_CALL(sum_jacobian, &c->curve, second, matrix + 2 * curve_n(&c->curve) * curve_n(&c->curve));
}

/* Computes J = d(q-, u-)/dz for the corrector, or returns false if the last one still serves. */
static inline bool matrices_jacobian(const tvi_closure *c, double matrix[])
{
    tvi_matrices *m = matrices_of(c);
    if (m->is_given && m->moved <= MATRICES_NEAR) return false;
    m->is_given = true;
    m->moved = 0;
    matrices_join(c, &c->q_from, &c->u_from, matrix);
    return true;
}

/* Returns sum_k |seed_k| of component i. */
static inline double matrices_seed_size(const tvi_closure *c, const double seed[], int i)
{
    double size = 0;
    for (int k = 0; k <= curve_top(&c->curve); k++) size += fabs(seed[k * curve_n(&c->curve) + i]);
    return size;
}

/* Returns how far z is from the point where the Jacobians were taken, relative to its size. */
static inline double matrices_distance(const tvi_closure *c, const double z[], const double scale[])
{
    const double *z_taken = matrices_of(c)->z;
    double distance = 0;
    for (int i = 0; i < 2 * curve_n(&c->curve); i++)
        distance = tvi_larger(tvi_ratio(fabs(z[i] - z_taken[i]), scale[i]), distance);
    return distance;
}

/* Returns a bound of the error of the state, relative to the state, by old Jacobians. Jacobians that were taken at
 * another z are wrong by about the relative distance to it. They multiply the corrections, and the seeds, which need
 * not be as small as the D_z that they add up to. */
static inline double matrices_staleness(const tvi_closure *c, double distance, const double scale[])
{
    const bool has_U = curve_form(&c->curve) != TVI_SEPARABLE;
    double part = 0;
    closure_set_p_size(c);
    for (int i = 0; i < curve_n(&c->curve); i++) {
        const double of_q = has_U ? fabs(c->curve.kappa[i]) * matrices_seed_size(c, c->seed_U, i) : 0,
                     of_p = matrices_seed_size(c, c->seed_Q, i);
        part = tvi_larger(tvi_ratio(fabs(c->from_q[i]) + fabs(c->rise_q[i]) + of_q, scale[i]), part);
        part = tvi_larger(tvi_ratio(fabs(c->from_p[i]) + fabs(c->rise_p[i]) + of_p, c->p_size[i]), part);
    }
    return distance * part;
}

/* Returns whether the Jacobians are to be taken at z: those of the first pass serve the later passes as long as no
 * effect of that shows, by the corrections of the pass before. */
static inline bool matrices_are_due(const tvi_closure *c, const double z[], const double scale[])
{
    tvi_matrices *m = matrices_of(c);
    if (m->taken == 0) return true;
    const double distance = matrices_distance(c, z, scale);
    if (matrices_staleness(c, distance, scale) <= MATRICES_STALE) return false;
    m->moved += distance;
    return true;
}

#endif
