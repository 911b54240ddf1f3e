/* differences.c - Takes the derivatives of losses of runs by central differences, beside which gradients are held. */
#include "gradient.h"

#include "system/system.h"

#include <math.h>
#include <string.h>

void gradient_open(columns_run *run, int problem, const char *method, int order)
{
    columns_open(run, gradient_problem(problem), method, order);
    ck_assert_int_eq(tvi_record_create(&run->record, run->it, 0), TVI_OK);
}

long double gradient_slope(gradient_value *value, void *ctx, long double d)
{
    static const long double factor[] = {4.0L / 5, -1.0L / 5, 4.0L / 105, -1.0L / 280};
    long double slope = 0;
    for (int k = 1; k <= 4; k++) slope += factor[k - 1] * (value(k * d, ctx) - value(-k * d, ctx)) / d;
    return slope;
}

gradient_start gradient_start_of(const columns_run *run)
{
    gradient_start x = {.t = 0.3};
    memcpy(x.q, run->q, sizeof x.q);
    memcpy(x.p, run->p, sizeof x.p);
    tvi_system_recorded_parameters(run->system, x.c);
    return x;
}

gradient_start gradient_begin(const columns_run *run, const gradient_start *x)
{
    if (tvi_system_parameters(run->system) > 0) ck_assert_int_eq(tvi_integrator_set_parameters(run->it, x->c), TVI_OK);
    return *x;
}

/* A number of the start that moves. */
typedef struct {
    gradient_start x;
    double *number, kept;
    gradient_loss *loss;
    void *ctx;
} moved;

static long double loss_beside(long double d, void *ctx)
{
    moved *to = ctx;
    *to->number = to->kept + (double)d;
    const double loss = to->loss(&to->x, to->ctx);
    *to->number = to->kept;
    return loss;
}

void gradient_expect(const columns_run *run, const tvi_loss *by, gradient_loss *loss, void *ctx)
{
    enum { MOST = 2 * COLUMNS_MOST_N + 1 + COLUMNS_MOST_PARAMETERS };
    const int n = run->n, count = run->rows + 1; /* and the time */
    double is[MOST], largest = 0;
    moved to = {.x = gradient_start_of(run), .loss = loss, .ctx = ctx};
    ck_assert_msg(tvi_gradient(run->record, by, is, is + 2 * n + 1) == TVI_OK, "%s", tvi_last_error());
    for (int i = 0; i < count; i++) largest = fmax(largest, fabs(is[i]));
    for (int i = 0; i < count; i++) {
        to.number = i < n ? &to.x.q[i] : i < 2 * n ? &to.x.p[i - n] : i == 2 * n ? &to.x.t : &to.x.c[i - 2 * n - 1];
        to.kept = *to.number;
        const long double d = 3e-4L * (i > 2 * n ? fabs(to.kept) : 1);
        const double slope = (double)gradient_slope(loss_beside, &to, d);
        ck_assert_msg(fabs(is[i] - slope) <= 1e-8 * largest, "%s, %d: %.12g, and %.12g by differences, of %g",
                      run->problem->name, i, is[i], slope, largest);
    }
}
