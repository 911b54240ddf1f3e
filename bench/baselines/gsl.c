/* gsl.c - Runs rk8pd, Runge-Kutta-Prince-Dormand of order 8, of the GNU Scientific Library (libgsl-dev). Not
 * symplectic. */
#include "baseline.h"

#ifdef BASELINES_GSL
#include "first_order.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

static int slope(double t, const double y[], double out[], void *params)
{
    (void)t;
    first_order_slope(params, y, out);
    return GSL_SUCCESS;
}

static gsl_odeiv2_system system_of(first_order *f)
{
    return (gsl_odeiv2_system){.function = slope, .dimension = (size_t)(2 * f->n), .params = f};
}

static tvi_status fixed_steps(first_order *f, gsl_odeiv2_step *stepper, double y[])
{
    const gsl_odeiv2_system system = system_of(f);
    const double h = f->task->h;
    double error[FIRST_ORDER_MAX];
    for (long step = 0; step < f->task->steps; step++) {
        if (gsl_odeiv2_step_apply(stepper, (double)step * h, h, y, error, NULL, NULL, &system) != GSL_SUCCESS)
            return TVI_ENONFINITE;
        if (!first_order_goes_on(f, (double)(step + 1) * h, y)) return TVI_ESTOPPED;
    }
    return TVI_OK;
}

static tvi_status own_steps(first_order *f, gsl_odeiv2_step *stepper, double y[])
{
    const gsl_odeiv2_system system = system_of(f);
    const double t_end = f->task->h * (double)f->task->steps;
    double t = 0, h = 1e-4 * t_end;
    gsl_odeiv2_control *control = gsl_odeiv2_control_y_new(first_order_absolute(f, y), f->task->tolerance);
    gsl_odeiv2_evolve *evolve = gsl_odeiv2_evolve_alloc(system.dimension);
    tvi_status status = control && evolve ? TVI_OK : TVI_ENOMEM;
    while (status == TVI_OK && t < t_end) {
        if (gsl_odeiv2_evolve_apply(evolve, control, stepper, &system, &t, t_end, &h, y) != GSL_SUCCESS)
            status = TVI_ENOCONV;
        else if (!first_order_goes_on(f, t, y)) status = TVI_ESTOPPED;
    }
    if (evolve) gsl_odeiv2_evolve_free(evolve);
    if (control) gsl_odeiv2_control_free(control);
    return status;
}

static tvi_status run(const baseline *self, const baseline_task *task, double q[], double p[], baseline_counts *counts)
{
    first_order f = first_order_of(task);
    double y[FIRST_ORDER_MAX];
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    gsl_odeiv2_step *stepper = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, (size_t)(2 * f.n));
    first_order_start(&f, q, p, y);
    tvi_status status = TVI_ENOMEM;
    if (stepper) {
        status = self->adaptive ? own_steps(&f, stepper, y) : fixed_steps(&f, stepper, y);
        gsl_odeiv2_step_free(stepper);
    }
    gsl_set_error_handler(handler);
    const tvi_status end = first_order_end(&f, y, q, p, counts);
    return status == TVI_OK ? end : status;
}

const baseline baselines_gsl[] = {
    {.name = "gsl-rk8pd", .order = 8, .run = run},
    {.name = "gsl-rk8pd-adaptive", .order = 8, .adaptive = true, .run = run},
    {.name = NULL},
};

#endif
