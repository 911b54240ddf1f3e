/* linear.c - Measures the linear stability of methods (linear.h). */
#include "linear.h"

#include <math.h>

tvi_status linear_matrix(tvi_integrator *integrator, double z, step_matrix *M)
{
    double q[2] = {1, 0}, p[2] = {0, 1};
    for (int column = 0; column < 2; column++) {
        double t = 0;
        tvi_integrator_reset(integrator);
        const tvi_status status = tvi_step(integrator, z, &t, &q[column], &p[column]);
        if (status != TVI_OK) return status;
    }
    *M = (step_matrix){q[0], q[1], p[0], p[1]};
    return TVI_OK;
}

/* Eigenvalues tr/2 +- sqrt D with D = tr^2/4 - det = ((a - d)/2)^2 + b c. */
double linear_growth(const step_matrix *M)
{
    const double half = (M->a - M->d) / 2, D = half * half + M->b * M->c;
    return D > 0 ? fabs((M->a + M->d) / 2) + sqrt(D) - 1 : sqrt(fmax(M->a * M->d - M->b * M->c, 0)) - 1;
}

/* ---- The search -------------------------------------------------------------------------------------------------- */

static const double CELL = 0.01;

typedef struct {
    tvi_integrator *integrator;
    linear_limit *limit;
} search;

static double growth_at(search *s, double z, step_matrix *M)
{
    const tvi_status status = linear_matrix(s->integrator, z, M);
    if (status == TVI_OK) return linear_growth(M);
    if (s->limit->status == TVI_OK) {
        s->limit->status = status;
        s->limit->refused_at = z;
    }
    return NAN;
}

/* The zero of b, or c, if it changes its sign between z and z + CELL; otherwise z. */
static double zero_between(search *s, double z, bool of_c)
{
    step_matrix M;
    double left = z, right = z + CELL;
    if (isnan(growth_at(s, right, &M))) return z;
    const bool end = (of_c ? M.c : M.b) > 0;
    if (isnan(growth_at(s, left, &M)) || ((of_c ? M.c : M.b) > 0) == end) return z;
    for (int i = 0; i < 60; i++) {
        const double middle = (left + right) / 2;
        if (isnan(growth_at(s, middle, &M))) return z;
        if (((of_c ? M.c : M.b) > 0) == end) right = middle;
        else left = middle;
    }
    return right;
}

/* Between a stable z and an unstable one. */
static double onset_between(search *s, double stable, double unstable, double visible)
{
    step_matrix M;
    for (int i = 0; i < 60; i++) {
        const double middle = (stable + unstable) / 2;
        if (growth_at(s, middle, &M) > visible) unstable = middle;
        else stable = middle;
    }
    return unstable;
}

/* Takes one point into account; false: it is unstable. */
static bool look(search *s, double stable, double z)
{
    linear_limit *limit = s->limit;
    step_matrix M;
    const double growth = growth_at(s, z, &M);
    if (growth > LINEAR_VISIBLE && isinf(limit->onset)) limit->onset = onset_between(s, stable, z, LINEAR_VISIBLE);
    if (growth > 0.01 && isinf(limit->one_percent)) limit->one_percent = onset_between(s, stable, z, 0.01);
    return !(growth > LINEAR_VISIBLE);
}

/* The largest growth between z and z + CELL. */
static double largest_growth(search *s, double z)
{
    enum { SAMPLES = 200 };
    step_matrix M;
    double most = 0;
    for (int i = 0; i <= SAMPLES; i++) most = fmax(most, growth_at(s, z + i * CELL / SAMPLES, &M));
    return most;
}

/* An interval of instability at z = k pi may be much narrower than a cell: it lies between a zero of b and one of c. */
linear_limit linear_search(tvi_integrator *integrator, double most)
{
    linear_limit limit = {.onset = INFINITY, .one_percent = INFINITY};
    search s = {integrator, &limit};
    bool first_interval = true;
    step_matrix M;
    for (int i = 1; i * CELL < most && isinf(limit.one_percent); i++) {
        const double z = i * CELL, zero[2] = {zero_between(&s, z, false), zero_between(&s, z, true)};
        const double between[] = {(zero[0] + zero[1]) / 2, zero[0], zero[1], z + CELL};
        bool stable = true;
        for (int k = 0; k < 4; k++) {
            stable = look(&s, z, between[k]);
            if (first_interval && !isinf(limit.onset)) limit.growth = fmax(limit.growth, growth_at(&s, between[k], &M));
        }
        if (first_interval && !isinf(limit.onset)) limit.growth = fmax(limit.growth, largest_growth(&s, z));
        if (stable && !isinf(limit.onset)) first_interval = false;
    }
    return limit;
}
