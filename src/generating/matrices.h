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
    double *z;          /* [2n] the z at which the last Jacobians were taken */
    int taken;          /* how often Jacobians were taken in this step */
    int factored;       /* the count of those that the factor belongs to */
    bool is_given;      /* the corrector has a Jacobian */
    double *moved;      /* [width] the path of z since that Jacobian, relative to its size, until the last were taken */
    double *G;          /* [n][2n] scratch for Jacobians of the ends */
    double *given;      /* several members: [2n][2n] the corrector's Jacobian, which serves some of them longer */
    tvi_lu_factor half; /* n x n; a generating function has this factor */
    tvi_lu_factor full; /* 2n x 2n; or it has this one */
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
    const tvi_curve *curve = &c->curve;
    double *z_taken = matrices_of(c)->z;
    if (curve_width(curve) == 1) memcpy(z_taken, z, 2 * (size_t)curve_n(curve) * sizeof *z);
    for (int i = 0; i < 2 * curve_n(curve) && curve_width(curve) > 1; i++)
        curve_store_taken(curve, z + i * curve_width(curve), z_taken + i * curve_width(curve));
    matrices_of(c)->taken++;
}

/* Writes the Jacobians of two combinations, one above the other: [2n][2n]. */
static inline void matrices_join(const tvi_closure *c, const tvi_combination *first, const tvi_combination *second,
                                 double matrix[])
{
    CURVE_CALL(sum_jacobian, &c->curve, first, matrix);
    CURVE_CALL(sum_jacobian, &c->curve, second, matrix + 2 * curve_n(&c->curve) * curve_numbers(&c->curve));
}

/* Returns whether the corrector's Jacobian no longer serves member m. */
static inline bool matrices_are_far(const tvi_matrices *matrices, int m)
{
    return !matrices->is_given || matrices->moved[m] > MATRICES_NEAR;
}

/* Keeps the Jacobians that still serve, and replaces the others: given <- matrix, or matrix <- given. */
static inline void matrices_keep(const tvi_closure *c, int m, double matrix[])
{
    const int n = curve_n(&c->curve), width = curve_width(&c->curve);
    double *given = matrices_of(c)->given;
    const bool is_far = matrices_are_far(matrices_of(c), m);
    const double *from = is_far ? matrix : given;
    double *to = is_far ? given : matrix;
    for (int at = m; at < 4 * n * n * width; at += width) to[at] = from[at];
}

/* Computes J = d(q-, u-)/dz for the corrector, or returns false if the last one still serves. */
static inline bool matrices_jacobian(const tvi_closure *c, double matrix[])
{
    tvi_matrices *matrices = matrices_of(c);
    const int width = curve_width(&c->curve);
    bool any = false;
    for (int m = 0; m < width; m++) any |= matrices_are_far(matrices, m);
    if (!any) return false;
    matrices_join(c, &c->q_from, &c->u_from, matrix);
    for (int m = 0; m < width && width > 1; m++) matrices_keep(c, m, matrix);
    for (int m = 0; m < width; m++)
        if (matrices_are_far(matrices, m)) matrices->moved[m] = 0;
    matrices->is_given = true;
    return true;
}

/* Computes how far z is from the point where the Jacobians were taken, relative to its size, of each member. */
static inline void matrices_distance(const tvi_closure *c, const double z[], const double scale[], double distance[])
{
    const double *z_taken = matrices_of(c)->z;
    const int width = curve_width(&c->curve);
    for (int m = 0; m < width; m++) distance[m] = 0;
    for (int i = 0; i < 2 * curve_numbers(&c->curve); i += width)
        for (int m = 0; m < width; m++)
            distance[m] = tvi_larger(tvi_ratio_or_zero(fabs(z[i + m] - z_taken[i + m]), scale[i + m]), distance[m]);
}

/* Enlarges part [width] to the sizes of the corrections of component i and factor times its seeds, relative to
 * `unit`. */
static inline void matrices_measure(const tvi_curve *curve, int i, const double from[], const double rise[],
                                    double factor, const double seed[], const double unit[], double part[])
{
    const int width = curve_width(curve), at = i * width;
    double size[CURVE_MOST_WIDTH] = {0};
    for (int k = 0; seed && k <= curve_top(curve); k++)
        for (int m = 0; m < width; m++) size[m] += fabs(seed[k * curve_numbers(curve) + at + m]);
    for (int m = 0; m < width; m++) {
        const double all = fabs(from[at + m]) + fabs(rise[at + m]) + factor * size[m];
        part[m] = tvi_larger(tvi_ratio_or_zero(all, unit[at + m]), part[m]);
    }
}

/* Computes bounds of the errors of the states, relative to the states, by old Jacobians, per distance. Jacobians that
 * were taken at another z are wrong by about the relative distance to it. They multiply the corrections, and the seeds,
 * which need not be as small as the D_z that they add up to. */
static inline void matrices_staleness(const tvi_closure *c, const double scale[], double part[])
{
    const tvi_curve *curve = &c->curve;
    const double *seed_U = curve_form(curve) != TVI_SEPARABLE ? c->seed_U : NULL;
    for (int m = 0; m < curve_width(curve); m++) part[m] = 0;
    closure_set_p_size(c);
    for (int i = 0; i < curve_n(curve); i++) {
        matrices_measure(curve, i, c->from_q, c->rise_q, fabs(curve->kappa[i]), seed_U, scale, part);
        matrices_measure(curve, i, c->from_p, c->rise_p, 1, c->seed_Q, c->p_size, part);
    }
}

/* Finds the members whose Jacobians are to be taken at z, of those that move: Jacobians of the first pass, which are
 * those of all, serve the later passes as long as no effect of that shows, by the corrections of the pass before. */
static inline void matrices_find_due(const tvi_closure *c, const double z[], const double scale[],
                                     const long long moves[], long long is_due[])
{
    tvi_matrices *matrices = matrices_of(c);
    double distance[CURVE_MOST_WIDTH], part[CURVE_MOST_WIDTH];
    const bool is_first = matrices->taken == 0;
    if (!is_first) matrices_distance(c, z, scale, distance);
    if (!is_first) matrices_staleness(c, scale, part);
    for (int m = 0; m < curve_width(&c->curve); m++) {
        is_due[m] = is_first || (moves[m] && !(distance[m] * part[m] <= MATRICES_STALE)) ? -1 : 0;
        if (is_due[m] && !is_first) matrices->moved[m] += distance[m];
    }
}

#endif
