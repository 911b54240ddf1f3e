/* tangent.c - the derivative of a step: D <- M D, by the same method on the lifted system (docs/method.md section 10).
 * A column is one lifted step, which forgets the one before it. */
#include "run/integrator.h"
#include "method/method.h"
#include "algebra/sizes.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct tvi_tangent {
    int n;
    bool paired; /* the momenta of (q, dq) are (dp, p), else (p, dp) */
    tvi_system *system;
    tvi_integrator *integrator;
    double *Q, *P; /* [2n] the lifted state */
    double *D;     /* [2n][columns] the result until the whole step is known to succeed */
    int columns;   /* that it has room for */
};

void tvi_tangent_free(tvi_tangent *tangent)
{
    if (!tangent) return;
    tvi_integrator_free(tangent->integrator);
    tvi_system_free(tangent->system);
    free(tangent->Q);
    free(tangent->D);
    free(tangent);
}

static tvi_status create(tvi_tangent **out, const tvi_integrator *it)
{
    const size_t n = (size_t)it->system->n;
    tvi_tangent *tangent = *out = calloc(1, sizeof *tangent);
    if (!tangent) return TVI_ENOMEM;
    tangent->n = it->system->n;
    tangent->Q = malloc(4 * n * sizeof *tangent->Q);
    if (!tangent->Q) return TVI_ENOMEM;
    tangent->P = tangent->Q + 2 * n;
    const tvi_lift lift = tvi_method_of(&it->options)->pairs_momenta ? TVI_LIFT_PAIRED : TVI_LIFT_SEPARABLE;
    const tvi_status status = tvi_system_lift(&tangent->system, it->system, lift);
    if (status != TVI_OK) return status;
    tangent->paired = tangent->system->form != TVI_SEPARABLE;
    return tvi_integrator_create(&tangent->integrator, tangent->system, &it->options);
}

/* Makes the integrator's tangent at its first use, and room for the columns. */
static tvi_status provide(tvi_integrator *it, int columns)
{
    if (!it->tangent) {
        tvi_tangent *tangent;
        const tvi_status status = create(&tangent, it);
        if (status != TVI_OK) {
            tvi_tangent_free(tangent);
            return status;
        }
        it->tangent = tangent;
        it->stats.bytes +=
            sizeof *tangent + 4 * (size_t)tangent->n * sizeof *tangent->Q + tangent->integrator->stats.bytes;
    }
    tvi_tangent *tangent = it->tangent;
    if (columns <= tangent->columns) return TVI_OK;
    const size_t row = 2 * (size_t)tangent->n * sizeof *tangent->D;
    if ((size_t)columns > SIZE_MAX / row) return TVI_ENOMEM;
    double *D = realloc(tangent->D, (size_t)columns * row);
    if (!D) return TVI_ENOMEM;
    it->stats.bytes += (size_t)(columns - tangent->columns) * row;
    tangent->D = D;
    tangent->columns = columns;
    return TVI_OK;
}

/* The power of two that brings a column to the size of the state, so that neither rules the corrector's measure: M is
 * linear, and powers of two are exact. */
static int exponent_of(int n, const double q[], const double p[], const double column[], int columns)
{
    const double size_q = tvi_largest(n, q, 1), size_p = tvi_largest(n, p, 1);
    const double of_q = tvi_largest(n, column, columns) / (size_q > 0 ? size_q : 1);
    const double of_p = tvi_largest(n, column + (size_t)n * (size_t)columns, columns) / (size_p > 0 ? size_p : 1);
    int exponent = 0;
    if (isfinite(of_q) && isfinite(of_p)) (void)frexp(fmax(of_q, of_p), &exponent);
    return exponent;
}

/* One column: out = M column. */
static tvi_status step_column(tvi_tangent *tangent, double h, double t, const double q[], const double p[],
                              const double column[], int columns, double out[])
{
    const int n = tangent->n, exponent = exponent_of(n, q, p, column, columns);
    const size_t stride = (size_t)columns, bytes = (size_t)n * sizeof *q;
    double *dq = tangent->Q + n, *dp = tangent->P + (tangent->paired ? 0 : n);
    memcpy(tangent->Q, q, bytes);
    memcpy(tangent->P + (tangent->paired ? n : 0), p, bytes);
    for (int i = 0; i < n; i++) {
        dq[i] = ldexp(column[(size_t)i * stride], -exponent);
        dp[i] = ldexp(column[(size_t)(n + i) * stride], -exponent);
    }
    tvi_integrator_reset(tangent->integrator);
    const tvi_status status = tvi_step(tangent->integrator, h, &t, tangent->Q, tangent->P);
    if (status != TVI_OK) return status;
    for (int i = 0; i < n; i++) {
        dq[i] = ldexp(dq[i], exponent);
        dp[i] = ldexp(dp[i], exponent);
        out[(size_t)i * stride] = dq[i];
        out[(size_t)(n + i) * stride] = dp[i];
    }
    return tvi_all_finite(n, dq) && tvi_all_finite(n, dp) ? TVI_OK : TVI_ENONFINITE;
}

tvi_status tvi_step_tangent(tvi_integrator *it, double h, double *t, double q[], double p[], double D[], int columns)
{
    if (!it) return TVI_EINVAL;
    it->has_dense = false;
    if (!t || !q || !p || !D || columns < 1 || h == 0 || !isfinite(h)) return TVI_EINVAL;
    const int n = it->system->n;
    for (int row = 0; row < 2 * n; row++)
        if (!tvi_all_finite(columns, D + (size_t)row * (size_t)columns)) return TVI_ENONFINITE;
    tvi_status status = provide(it, columns);
    for (int i = 0; i < columns && status == TVI_OK; i++)
        status = step_column(it->tangent, h, *t, q, p, D + i, columns, it->tangent->D + i);
    if (status == TVI_OK) status = tvi_step(it, h, t, q, p);
    if (status == TVI_OK) memcpy(D, it->tangent->D, 2 * (size_t)n * (size_t)columns * sizeof *D);
    return status;
}
