/* tangent.c - Computes what the tests of the tangent map share. */
#include "tangent.h"

#include <math.h>
#include <string.h>

double matrix_distance(int n, const matrix a, const matrix b)
{
    double largest = 0, size = 1;
    for (int i = 0; i < 4 * n * n; i++) {
        ck_assert(isfinite(a[i]) && isfinite(b[i]));
        largest = fmax(largest, fabs(a[i] - b[i]));
        size = fmax(size, fabs(b[i]));
    }
    return largest / size;
}

void set_identity(int n, matrix a)
{
    for (int i = 0; i < 4 * n * n; i++) a[i] = i % (2 * n + 1) == 0;
}

void multiply(int n, const matrix a, const matrix b, matrix c)
{
    const int rows = 2 * n;
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < rows; j++) {
            c[i * rows + j] = 0;
            for (int k = 0; k < rows; k++) c[i * rows + j] += a[i * rows + k] * b[k * rows + j];
        }
}

runs open_runs(const model *m, const tvi_options *options)
{
    runs r = {.m = m, .system = model_system(m)};
    r.integrator = integrator_of(r.system, options);
    return r;
}

void close_runs(runs *r)
{
    tvi_integrator_free(r->integrator);
    tvi_system_free(r->system);
}

void tangent_step(const runs *r, double h, test_state *x, double D[], int columns)
{
    const tvi_status status = tvi_step_tangent(r->integrator, h, &x->t, x->q, x->p, D, columns);
    ck_assert_msg(status == TVI_OK, "%s: %s", r->m->name, tvi_status_string(status));
}

bool same_bits(int n, const test_state *a, const test_state *b)
{
    const size_t bytes = (size_t)n * sizeof *a->q;
    return memcmp(&a->t, &b->t, sizeof a->t) == 0 && memcmp(a->q, b->q, bytes) == 0 && memcmp(a->p, b->p, bytes) == 0;
}
